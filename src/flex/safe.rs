//! Safe steps: no constraint is ever violated, and the whole motion is proven free of collision.
//!
//! The linear program knows distances to the first order; along its direction the true ones fall
//! short by a second-order term. So a safe step solves, looks by how much each constraint falls
//! short at the end, and solves again with just that much held back (a second-order correction).
//! If a row holds back κ at the full step, then at a part s of it the first order leaves at least
//! sκ ≥ s²κ, so the way there is safe as well, up to third order; what is left is for the proof
//! (`motion`) to say. Where a proof fails the two bodies that meet get constraints of their own,
//! or the step is shortened.

use super::branch::{self, Solved};
use super::model::Row;
use super::motion::{Motion, ProofSize};
use super::pairs::Pair;
use super::shape::{Placed, Pose, double};
use super::step::Run;
use crate::number::{Int, Rat};

/// Corrections of one step.
const CORRECTIONS: usize = 6;
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
}

impl Run<'_> {
    /// One safe step from a configuration without violations. Bodies that turn out to meet
    /// without being joined are added to `extra`, to be kept apart from now on.
    pub(crate) fn safe_step(&mut self, poses: &[Pose], placed: &[Placed], moved: bool) -> SafeStep {
        let mut selection = self.selection(placed, moved);
        let (mut pairs, mut rows) = self.rows(&selection, placed);
        // What rounding takes is held back from the first, but no more than half of what there is,
        // so that standing still stays allowed.
        let grain = self.grain();
        let first = 4.0 * grain.distance();
        let start = vec![[0.0; 3]; poses.len()];
        let keep = |row: &Row| first.min(linear(row, &start) / 2.0).max(0.0);
        let mut held: Vec<f64> = rows.iter().map(keep).collect();
        let mut programs = 0;
        let mut last: Option<(Solved, Vec<Row>)> = None;
        for attempt in 0..CORRECTIONS {
            let tight: Vec<Row> = rows.iter().zip(&held).map(|(r, h)| hold(r, *h)).collect();
            let solved = branch::solve(self, &tight, &selection, placed, poses);
            programs += solved.programs;
            let Some(direction) = solved.direction.clone() else {
                if attempt == 0 || last.is_none() {
                    return SafeStep {
                        solved,
                        rows,
                        scale: Rat::zero(),
                        next: None,
                        proof: None,
                        programs,
                    };
                }
                // Too much was held back: shorten the step that is known.
                break;
            };
            let trial = grain.moved(poses, &self.scaffold.forms, &direction, 1.0);
            let there = self.scaffold.place(&trial);
            let pad = 4.0 * grain.distance();
            let mut short = false;
            for ((row, pair), held) in rows.iter().zip(&pairs).zip(&mut held) {
                let (d, error) = self.scaffold.near(pair, &there);
                if d - error < 0.0 {
                    short = true;
                }
                let promised = linear(row, &direction);
                let lack = (promised - d).max(0.0) + pad;
                *held = held.max(lack);
            }
            if !short {
                match Motion::new(&self.scaffold, poses, &trial).prove() {
                    Ok(proof) => {
                        return SafeStep {
                            solved,
                            rows,
                            scale: Rat::one(),
                            next: Some(trial),
                            proof: Some(proof),
                            programs,
                        };
                    }
                    Err(contacts) => {
                        let known = self.scaffold.extra.len();
                        for c in &contacts {
                            let (a, b) = (c.edge.0, c.vertex.0);
                            let two = (a.min(b), a.max(b));
                            if !self.scaffold.extra.contains(&two) {
                                self.scaffold.extra.push(two);
                            }
                        }
                        if self.scaffold.extra.len() > known {
                            let kept: std::collections::HashMap<Pair, f64> =
                                pairs.iter().copied().zip(held.iter().copied()).collect();
                            selection = self.selection(placed, moved);
                            (pairs, rows) = self.rows(&selection, placed);
                            held = pairs
                                .iter()
                                .map(|p| kept.get(p).copied().unwrap_or(pad))
                                .collect();
                        }
                    }
                }
            }
            last = Some((solved, rows.clone()));
        }
        let (solved, rows) = match last {
            Some(known) => known,
            None => (branch::solve(self, &rows, &selection, placed, poses), rows),
        };
        let direction = solved.direction.clone().unwrap_or_default();
        let mut scale = 1.0;
        for _ in 0..HALVINGS {
            scale /= 2.0;
            let trial = grain.moved(poses, &self.scaffold.forms, &direction, scale);
            let there = self.scaffold.place(&trial);
            if self.exceeds(&pairs, &there, &Rat::zero()) {
                continue;
            }
            if let Ok(proof) = Motion::new(&self.scaffold, poses, &trial).prove() {
                return SafeStep {
                    solved,
                    rows,
                    scale: Rat::from_f64(scale),
                    next: Some(trial),
                    proof: Some(proof),
                    programs,
                };
            }
        }
        SafeStep {
            solved,
            rows,
            scale: Rat::zero(),
            next: Some(poses.to_vec()),
            proof: None,
            programs,
        }
    }
}

/// The length of a row's normal, from above.
fn length(row: &Row) -> Int {
    let [x, y] = &row.normal;
    let square = x * x + y * y;
    square.sqrt().unwrap_or_else(Int::zero) + Int::one()
}

/// The row with a distance held back.
fn hold(row: &Row, distance: f64) -> Row {
    if distance <= 0.0 {
        return row.clone();
    }
    let back = Rat::from_f64(distance) * Rat::from(length(row));
    Row {
        d0: &row.d0 - &back.ceil(),
        ..row.clone()
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
