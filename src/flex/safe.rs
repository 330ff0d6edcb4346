//! Safe steps: no constraint is ever violated, and the whole motion is proven free of collision.
//!
//! The linear program knows distances to the first order; along its direction the true ones fall
//! short by a second-order term. So a safe step solves, looks by how much each constraint falls
//! short at the end, and puts the end right (`settle`), as far as the rows that the program stands on
//! fall short. Where that does not do, it solves again with just that much held back.
//! If a row holds back κ at the full step, then at a part s of it the first order leaves at least
//! sκ ≥ s²κ, so the way there is safe as well, up to third order; what is left is for the proof
//! (`motion`) to say. Where a constraint still falls short by a little, by κ′ where κ is held, the
//! part κ/κ′ of the step is safe by the same reckoning, and costs no program. Where a proof fails
//! the two bodies that meet get constraints of their own, or the step is shortened. Where clearances
//! are wide (a third of a tab, say) the second order may take all that a program promises; then
//! bodies are allowed to turn less, and the program is solved anew.

use super::branch::{self, Solved};
use super::fit::finite;
use super::model::Row;
use super::motion::{Contact, Motion, ProofSize};
use super::pairs::Pair;
use super::shape::{Placed, Pose, double};
use super::step::{KEEPS, Run};
use crate::number::{Int, Rat};
use std::collections::HashMap;

/// The parts of a step that are good enough, correction by correction.
const ENOUGH: [f64; 6] = [0.95, 0.8, 0.7, 0.6, 0.5, 0.4];
/// What is held back beyond what was found lacking: another direction lacks a little more.
const SPARE: f64 = 1.0 / 32.0;
/// The least part of a step that is taken where its end has been put right.
const HALF: f64 = 0.5;
/// Halvings of a step that corrections do not save.
const HALVINGS: usize = 6;
/// How often a step is tried with less rotation.
const NARROWINGS: usize = 8;
/// Limits of rotation that return are wider by this factor.
const WIDER: f64 = 4.0;

/// A limit of rotation, shorter: a quarter at most, with few bits.
fn narrower(turn: f64) -> f64 {
    2f64.powi((turn.max(1e-9) / 4.0).log2().floor() as i32)
}

/// A step that is proven, or none.
pub(crate) struct SafeStep {
    pub(crate) solved: Solved,
    pub(crate) rows: Vec<Row>,
    pub(crate) scale: Rat,
    /// Where the step leads; None if nothing was proven.
    pub(crate) next: Option<Vec<Pose>>,
    pub(crate) proof: Option<ProofSize>,
    /// Programs solved in all.
    pub(crate) programs: usize,
    /// What the first of them promised, before more was held back than rounding takes; of a step
    /// that does not gain, what the program without limits of rotation promised.
    pub(crate) promise: f64,
    /// Whether it gains a part of its promise, or there was nothing to gain.
    gains: bool,
}

/// A program's optimum: its direction, and its rows as distances, now and promised at its end.
struct Vertex {
    direction: Vec<[f64; 3]>,
    solved: Solved,
    rows: Vec<Row>,
    pairs: Vec<Pair>,
    now: Vec<f64>,
    promised: Vec<f64>,
}

/// Where a step may end: a part of a direction, proven.
struct End {
    part: f64,
    next: Vec<Pose>,
    proof: ProofSize,
}

/// What became of a part of a direction.
enum Tried {
    Proven(Vec<Pose>, ProofSize),
    /// A constraint is violated at its end.
    Short,
    /// Bodies meet on the way.
    Met(Vec<Contact>),
}

impl Run<'_> {
    /// One safe step from a configuration without violations. Bodies that turn out to meet
    /// without being joined are added to `extra`, to be kept apart from now on.
    ///
    /// A step is to gain a part of what its program promised. Where no part of the direction
    /// does, bodies may turn less and the program is solved again: what the second order takes
    /// shrinks by the square. The limit widens again where steps are taken whole, and what is too
    /// little under it must be too little without.
    pub(crate) fn safe_step(&mut self, poses: &[Pose], placed: &[Placed], moved: bool) -> SafeStep {
        let mut trust = self.trust;
        let mut programs = 0;
        // What the program without limits promises, where it was solved.
        let mut free = None;
        let mut best: Option<SafeStep> = None;
        let mut tries = 0;
        let step = loop {
            let bodies = poses.len();
            self.scaffold.turn_limits = trust.map(|t| vec![Rat::from_f64(t); bodies]);
            let (step, turn) = self.step_within(poses, placed, moved);
            programs += step.programs;
            tries += 1;
            let worth = self.worth(step.promise);
            let limited = trust.is_some();
            if !limited {
                free = Some(step.promise);
            }
            if (step.gains && (worth || !limited)) || (step.next.is_none() && !limited) {
                self.trust = trust.map(|t| t * WIDER).filter(|t| *t < 1.0);
                return SafeStep { programs, ..step };
            }
            // What is proven is better than nothing, though it gains little.
            let kept = match best.take() {
                Some(before) if step.proof.is_none() => before,
                _ => step,
            };
            let known = limited && !worth && free.is_some();
            if known || tries > NARROWINGS || self.late() {
                break kept;
            }
            best = Some(kept);
            trust = if limited && !worth {
                None
            } else {
                Some(narrower(trust.map_or(turn, |t| t.min(turn))))
            };
        };
        self.trust = trust;
        SafeStep {
            promise: free.unwrap_or(step.promise),
            programs,
            ..step
        }
    }

    /// One safe step with the rotations that are allowed now, and the largest turn in it.
    fn step_within(&mut self, poses: &[Pose], placed: &[Placed], moved: bool) -> (SafeStep, f64) {
        let mut selection = self.selection(placed, moved);
        let (mut pairs, mut rows) = self.rows(&selection, placed);
        let pad = 4.0 * self.grain().distance();
        let start = vec![[0.0; 3]; poses.len()];
        // What rounding takes is held back from the first, but no more than half of what there is,
        // so that standing still stays allowed.
        let keep = |row: &Row| pad.min(linear(row, &start) / 2.0).max(0.0);
        let mut held: Vec<f64> = rows.iter().map(keep).collect();
        let mut programs = 0;
        // The first optimum, and the last.
        let mut known: Vec<Vertex> = Vec::new();
        // What is proven but gains little, and of which optimum.
        let mut little: Option<End> = None;
        let mut promise = 0.0;
        let mut turn = 0.0;
        for enough in ENOUGH {
            let tight: Vec<Row> = rows.iter().zip(&held).map(|(r, h)| hold(r, *h)).collect();
            let solved = branch::solve(self, &tight, &selection, placed, poses);
            programs += solved.programs;
            let Some(direction) = solved.direction.clone() else {
                if known.is_empty() {
                    return (SafeStep::none(solved, rows, programs), turn);
                }
                // Too much was held back: shorten the step that is known.
                break;
            };
            if known.is_empty() {
                promise = double(&solved.objective);
                turn = direction.iter().fold(0.0, |t, d| d[2].abs().max(t));
            }
            let said = |row: &Row| linear(row, &direction).max(pad);
            let vertex = Vertex {
                now: rows.iter().map(|row| linear(row, &start)).collect(),
                promised: rows.iter().map(said).collect(),
                direction,
                solved,
                rows: rows.clone(),
                pairs: pairs.clone(),
            };
            let met = self.scaffold.extra.len();
            let ends = self.ends(poses, &vertex, &mut held, enough);
            let found = self.first_proven(poses, &vertex, ends, promise);
            match found {
                Ok(end) => return (SafeStep::done(vertex, end, programs, promise), turn),
                Err(proven) => little = proven,
            }
            known.truncate(1);
            known.push(vertex);
            if little.is_some() {
                // Holding back more would gain less still.
                break;
            }
            if self.scaffold.extra.len() > met {
                let kept: HashMap<Pair, f64> =
                    pairs.iter().copied().zip(held.iter().copied()).collect();
                selection = self.selection(placed, moved);
                (pairs, rows) = self.rows(&selection, placed);
                held = pairs
                    .iter()
                    .zip(&rows)
                    .map(|(p, r)| kept.get(p).copied().unwrap_or_else(|| keep(r)))
                    .collect();
            }
        }
        for k in 0..known.len() {
            let mut part = 1.0;
            for _ in 0..HALVINGS {
                part /= 2.0;
                let vertex = &known[k];
                let less = scaled(&vertex.direction, part);
                let plain = self.grain().moved(poses, &self.scaffold.forms, &less, 1.0);
                let right = self.put_right(poses, vertex, part);
                let ends = right.into_iter().chain([plain]).map(|end| (part, end));
                let ends: Vec<_> = ends.collect();
                if let Ok(end) = self.first_proven(poses, vertex, ends, promise) {
                    let vertex = known.swap_remove(k);
                    return (SafeStep::done(vertex, end, programs, promise), turn);
                }
            }
        }
        let Some(vertex) = known.pop() else {
            // ENOUGH is not empty, so some program was solved, or the step ended there.
            let solved = branch::solve(self, &rows, &selection, placed, poses);
            return (SafeStep::none(solved, rows, programs + 1), turn);
        };
        let step = match little {
            Some(end) => SafeStep {
                gains: false,
                ..SafeStep::done(vertex, end, programs, promise)
            },
            None => SafeStep {
                next: Some(poses.to_vec()),
                promise,
                ..SafeStep::none(vertex.solved, vertex.rows, programs)
            },
        };
        (step, turn)
    }

    /// The first of some ends that is proven and gains enough of a promise; else, where one is
    /// proven, that one. Notes bodies that meet.
    fn first_proven(
        &mut self,
        poses: &[Pose],
        vertex: &Vertex,
        ends: Vec<(f64, Vec<Pose>)>,
        promise: f64,
    ) -> Result<End, Option<End>> {
        let before = self.scaffold.displacement(poses);
        let mut little = None;
        for (part, end) in ends {
            match self.attempt(poses, &vertex.pairs, end) {
                Tried::Proven(next, proof) => {
                    let gain = self.scaffold.displacement(&next) - &before;
                    let end = End { part, next, proof };
                    if !self.worth(promise) || gain >= finite(KEEPS * promise * part) {
                        return Ok(end);
                    }
                    little.get_or_insert(end);
                }
                Tried::Short => {}
                Tried::Met(contacts) => {
                    for c in &contacts {
                        let (a, b) = (c.edge.0, c.vertex.0);
                        let two = (a.min(b), a.max(b));
                        if !self.scaffold.extra.contains(&two) {
                            self.scaffold.extra.push(two);
                        }
                    }
                }
            }
        }
        Err(little)
    }

    /// Where a direction may be followed to: parts of it, with the configurations there, best
    /// first. What each row falls short of its promise by is held back from now on; a part less
    /// than `enough` is not offered as it is.
    fn ends(
        &self,
        poses: &[Pose],
        vertex: &Vertex,
        held: &mut [f64],
        enough: f64,
    ) -> Vec<(f64, Vec<Pose>)> {
        let grain = self.grain();
        let pad = 4.0 * grain.distance();
        let forms = &self.scaffold.forms;
        let trial = grain.moved(poses, forms, &vertex.direction, 1.0);
        let there = self.scaffold.place(&trial);
        let mut part = 1.0f64;
        for ((row, pair), held) in vertex.rows.iter().zip(&vertex.pairs).zip(held) {
            let (d, error) = self.scaffold.near(pair, &there);
            let said = linear(row, &vertex.direction);
            let lack = (said - d + error).max(0.0) + pad;
            if d - error < 0.0 {
                part = part.min((said / lack).max(0.0) * (1.0 - 1e-3));
            }
            *held = held.max(lack * (1.0 + SPARE));
        }
        if part == 1.0 {
            return vec![(1.0, trial)];
        }
        let mut ends: Vec<_> = self.corrected(poses, vertex).into_iter().collect();
        if part >= enough {
            ends.push((part, grain.moved(poses, forms, &vertex.direction, part)));
        }
        ends
    }

    /// The end of a part of a step, with the rows that its program stands on put where they were
    /// promised; None where that cannot be done.
    fn put_right(&self, poses: &[Pose], vertex: &Vertex, part: f64) -> Option<Vec<Pose>> {
        let tight = self.tight(&vertex.pairs, poses, &vertex.solved)?;
        let less = scaled(&vertex.direction, part);
        // Where the second order opens a gap the end must be open by as much, or the first order
        // would have to close it on the way.
        let bonus = tight.curvature(&less);
        let target = |(&k, c): (&usize, &f64)| {
            vertex.now[k] * (1.0 - part) + vertex.promised[k] * part + c.max(0.0)
        };
        let targets: Vec<f64> = tight.rows.iter().zip(&bonus).map(target).collect();
        let grain = self.grain();
        let there = tight.settle(&less, &targets, grain.distance() / 4.0)?;
        Some(grain.moved(poses, &self.scaffold.forms, &there, 1.0))
    }

    /// The end of a step, put right, and the part of the step that it is: where rows that the
    /// program does not stand on are broken by less than half of the step, what these leave. None
    /// where that cannot be done.
    fn corrected(&self, poses: &[Pose], vertex: &Vertex) -> Option<(f64, Vec<Pose>)> {
        let whole = self.put_right(poses, vertex, 1.0)?;
        let there = self.scaffold.place(&whole);
        let mut part = 1.0f64;
        let rows = vertex.pairs.iter().zip(&vertex.now).zip(&vertex.promised);
        for ((pair, now), promised) in rows {
            let (d, error) = self.scaffold.near(pair, &there);
            let lack = promised - d + error;
            if d - error < 0.0 && lack > 0.0 {
                // Where (1 − s)·now + s·promised − s²·lack is zero.
                let slope = promised - now;
                let root = (slope * slope + 4.0 * lack * now.max(0.0)).sqrt();
                part = part.min((slope + root) / (2.0 * lack) * (1.0 - SPARE));
            }
        }
        if part == 1.0 {
            return Some((1.0, whole));
        }
        let end = |part| self.put_right(poses, vertex, part).map(|end| (part, end));
        (part >= HALF).then(|| end(part))?
    }

    /// Proves the way to an end.
    fn attempt(&self, poses: &[Pose], pairs: &[Pair], end: Vec<Pose>) -> Tried {
        let there = self.scaffold.place(&end);
        if self.exceeds(pairs, &there, &Rat::zero()) {
            return Tried::Short;
        }
        match Motion::new(&self.scaffold, poses, &end).prove() {
            Ok(proof) => Tried::Proven(end, proof),
            Err(contacts) => Tried::Met(contacts),
        }
    }
}

impl SafeStep {
    /// A step to a proven end that gains what it should.
    fn done(vertex: Vertex, end: End, programs: usize, promise: f64) -> SafeStep {
        SafeStep {
            solved: vertex.solved,
            rows: vertex.rows,
            scale: Rat::from_f64(end.part),
            next: Some(end.next),
            proof: Some(end.proof),
            programs,
            promise,
            gains: true,
        }
    }

    /// A step that does not come about.
    fn none(solved: Solved, rows: Vec<Row>, programs: usize) -> SafeStep {
        SafeStep {
            promise: double(&solved.objective),
            solved,
            rows,
            scale: Rat::zero(),
            next: None,
            proof: None,
            programs,
            gains: false,
        }
    }
}

/// A part of a direction.
fn scaled(direction: &[[f64; 3]], part: f64) -> Vec<[f64; 3]> {
    direction.iter().map(|d| d.map(|v| v * part)).collect()
}

/// The length of a row's normal, from above.
fn length(row: &Row) -> Int {
    let [x, y] = &row.normal;
    let square = x * x + y * y;
    square.sqrt().unwrap_or_else(Int::zero) + Int::one()
}

/// Bits of what is held back: as many as make it no more than a 500th too much.
const HELD_BITS: u64 = 10;

/// The row with a distance held back, or a little more; one that is negative is given.
pub(crate) fn hold(row: &Row, distance: f64) -> Row {
    let back = finite(distance) * Rat::from(length(row));
    if back.is_zero() {
        return row.clone();
    }
    // The units of a row may be coarse (a distance of 3, say): in finer ones, then.
    let bits = back.numer().bits() as i64 - back.denom().bits() as i64;
    let up = (HELD_BITS as i64 - bits).max(0).unsigned_abs();
    let down = (bits - HELD_BITS as i64).max(0).unsigned_abs();
    let back = (back * Rat::new(Int::one().shl(up), Int::one().shl(down))).ceil();
    Row {
        pair: row.pair,
        normal: row.normal.each_ref().map(|v| v.shl(up)),
        theta1: row.theta1.shl(up),
        theta2: row.theta2.shl(up),
        d0: row.d0.shl(up) - back.shl(down),
    }
}

/// J q̇ + d₀ as a distance, in doubles.
pub(crate) fn linear(row: &Row, direction: &[[f64; 3]]) -> f64 {
    let (one, two) = (row.pair.line_body as usize, row.pair.point_body as usize);
    let scale = length(row);
    let part = |v: &Int| double(&Rat::new(v.clone(), scale.clone()));
    let (a, b) = (direction[one], direction[two]);
    part(&row.normal[0]) * (b[0] - a[0])
        + part(&row.normal[1]) * (b[1] - a[1])
        + part(&row.theta1) * a[2]
        + part(&row.theta2) * b[2]
        + part(&row.d0)
}
