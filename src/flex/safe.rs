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
//! the two bodies that meet get constraints of their own, or the step is shortened.

use super::branch::{self, Solved};
use super::model::Row;
use super::motion::{Contact, Motion, ProofSize};
use super::pairs::Pair;
use super::shape::{Placed, Pose, double};
use super::step::Run;
use crate::number::{Int, Rat};
use std::collections::HashMap;

/// The parts of a step that are good enough, correction by correction.
const ENOUGH: [f64; 6] = [0.95, 0.8, 0.7, 0.6, 0.5, 0.4];
/// What is held back beyond what was found lacking: another direction lacks a little more.
const SPARE: f64 = 1.0 / 32.0;
/// The least part of a step that is taken where its end has been put right.
const HALF: f64 = 0.5;
/// Halvings of a step that corrections do not save.
const HALVINGS: usize = 10;

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
    /// What the first of them promised, before more was held back than rounding takes.
    pub(crate) promise: f64,
}

/// A direction from a configuration, and its program's rows as distances: now, and promised at
/// its end.
struct Vertex<'a> {
    poses: &'a [Pose],
    pairs: &'a [Pair],
    direction: &'a [[f64; 3]],
    solved: &'a Solved,
    now: &'a [f64],
    promised: &'a [f64],
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
    pub(crate) fn safe_step(&mut self, poses: &[Pose], placed: &[Placed], moved: bool) -> SafeStep {
        let mut selection = self.selection(placed, moved);
        let (mut pairs, mut rows) = self.rows(&selection, placed);
        let grain = self.grain();
        let pad = 4.0 * grain.distance();
        let start = vec![[0.0; 3]; poses.len()];
        // What rounding takes is held back from the first, but no more than half of what there is,
        // so that standing still stays allowed.
        let keep = |row: &Row| pad.min(linear(row, &start) / 2.0).max(0.0);
        let mut held: Vec<f64> = rows.iter().map(keep).collect();
        let mut programs = 0;
        let mut promise = 0.0;
        let mut last: Option<Solved> = None;
        for enough in ENOUGH {
            let tight: Vec<Row> = rows.iter().zip(&held).map(|(r, h)| hold(r, *h)).collect();
            let solved = branch::solve(self, &tight, &selection, placed, poses);
            programs += solved.programs;
            if last.is_none() {
                promise = double(&solved.objective);
            }
            let Some(direction) = solved.direction.clone() else {
                if last.is_none() {
                    return SafeStep {
                        solved,
                        rows,
                        scale: Rat::zero(),
                        next: None,
                        proof: None,
                        programs,
                        promise,
                    };
                }
                // Too much was held back: shorten the step that is known.
                break;
            };
            // By how much each row falls short of its promise, and how much of the step the rows
            // that break theirs leave.
            let trial = grain.moved(poses, &self.scaffold.forms, &direction, 1.0);
            let there = self.scaffold.place(&trial);
            let mut part = 1.0f64;
            let now: Vec<f64> = rows.iter().map(|row| linear(row, &start)).collect();
            let mut promised = Vec::with_capacity(rows.len());
            for ((row, pair), held) in rows.iter().zip(&pairs).zip(&mut held) {
                let (d, error) = self.scaffold.near(pair, &there);
                let said = linear(row, &direction);
                let lack = (said - d + error).max(0.0) + pad;
                if d - error < 0.0 {
                    part = part.min((said / lack).max(0.0) * (1.0 - 1e-3));
                }
                *held = held.max(lack * (1.0 + SPARE));
                promised.push(said.max(pad));
            }
            let mut ends = Vec::new();
            if part < 1.0 {
                let vertex = Vertex {
                    poses,
                    pairs: &pairs,
                    direction: &direction,
                    solved: &solved,
                    now: &now,
                    promised: &promised,
                };
                if let Some((safe, end)) = self.corrected(&vertex) {
                    ends.push((safe, end));
                }
                if part >= enough {
                    let less = grain.moved(poses, &self.scaffold.forms, &direction, part);
                    ends.push((part, less));
                }
            } else {
                ends.push((1.0, trial));
            }
            let known = self.scaffold.extra.len();
            for (part, end) in ends {
                match self.attempt(poses, &pairs, end) {
                    Tried::Proven(next, proof) => {
                        return SafeStep {
                            solved,
                            rows,
                            scale: Rat::from_f64(part),
                            next: Some(next),
                            proof: Some(proof),
                            programs,
                            promise,
                        };
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
            if self.scaffold.extra.len() > known {
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
            last = Some(solved);
        }
        let solved = match last {
            Some(known) => known,
            None => branch::solve(self, &rows, &selection, placed, poses),
        };
        let direction = solved.direction.clone().unwrap_or_default();
        let now: Vec<f64> = rows.iter().map(|row| linear(row, &start)).collect();
        let said = |row: &Row| linear(row, &direction).max(pad);
        let promised: Vec<f64> = if direction.len() == start.len() {
            rows.iter().map(said).collect()
        } else {
            now.clone()
        };
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            part /= 2.0;
            let vertex = Vertex {
                poses,
                pairs: &pairs,
                direction: &direction,
                solved: &solved,
                now: &now,
                promised: &promised,
            };
            let plain = grain.moved(poses, &self.scaffold.forms, &direction, part);
            let right = self.put_right(&vertex, part);
            for end in right.into_iter().chain([plain]) {
                if let Tried::Proven(next, proof) = self.attempt(poses, &pairs, end) {
                    return SafeStep {
                        solved,
                        rows,
                        scale: Rat::from_f64(part),
                        next: Some(next),
                        proof: Some(proof),
                        programs,
                        promise,
                    };
                }
            }
        }
        SafeStep {
            solved,
            rows,
            scale: Rat::zero(),
            next: Some(poses.to_vec()),
            proof: None,
            programs,
            promise,
        }
    }

    /// The end of a part of a step, with the rows that its program stands on put where they were
    /// promised; None where that cannot be done.
    fn put_right(&self, vertex: &Vertex<'_>, part: f64) -> Option<Vec<Pose>> {
        let tight = self.tight(vertex.pairs, vertex.poses, vertex.solved)?;
        let less: Vec<[f64; 3]> = vertex
            .direction
            .iter()
            .map(|d| d.map(|v| v * part))
            .collect();
        // Where the second order opens a gap the end must be open by as much, or the first order
        // would have to close it on the way.
        let bonus = tight.curvature(&less);
        let target = |(&k, c): (&usize, &f64)| {
            vertex.now[k] * (1.0 - part) + vertex.promised[k] * part + c.max(0.0)
        };
        let targets: Vec<f64> = tight.rows.iter().zip(&bonus).map(target).collect();
        let grain = self.grain();
        let there = tight.settle(&less, &targets, grain.distance() / 4.0)?;
        Some(grain.moved(vertex.poses, &self.scaffold.forms, &there, 1.0))
    }

    /// The end of a step, put right, and the part of the step that it is: where rows that the
    /// program does not stand on are broken by less than half of the step, what these leave. None
    /// where that cannot be done.
    fn corrected(&self, vertex: &Vertex<'_>) -> Option<(f64, Vec<Pose>)> {
        let whole = self.put_right(vertex, 1.0)?;
        let there = self.scaffold.place(&whole);
        let mut part = 1.0f64;
        let rows = vertex.pairs.iter().zip(vertex.now).zip(vertex.promised);
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
        (part >= HALF).then(|| self.put_right(vertex, part).map(|end| (part, end)))?
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
    let back = Rat::from_f64(distance) * Rat::from(length(row));
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
