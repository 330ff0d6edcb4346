//! Where the gradients of a step are taken.
//!
//! A program says J q̇ + d₀ ≥ 0. What must be exact is d₀, or errors would add up; J may be taken
//! at a configuration nearby, since it multiplies a motion that gets shorter from step to step
//! (Newton's method with a held derivative). So after the first step, whose J is exact, every body
//! has a *station*: its pose rounded to few digits, kept until some body has moved away from its
//! own. Three things follow. The numbers of J are short, and with them all of the exact work.
//! Bodies that stand nearly parallel have one rotation there, so rows that depend on each other do
//! so exactly. And the last programs of a run, in which hardly anything moves, share one matrix,
//! so that the basis of one solves the next.
//!
//! A station is within 2⁻¹² of its body, as an angle and as a part of the largest body: J is off
//! by about as much, relatively, and a step of length q̇ is left with a violation of 2⁻¹² |q̇|
//! beside the second-order one that every linear step has. The exact test sees both.
//!
//! d₀ is rounded to a multiple of a small grain, far below what a step must gain: constraints that
//! a configuration meets up to its own rounding are met exactly, and the vertex of the program
//! that it stands on is one vertex, not hundreds within 10⁻⁹ of each other.

use super::grain::Grain;
use super::model::{Row, Scaffold};
use super::pairs::Pair;
use super::shape::{Placed, Pose, double};
use crate::number::{Int, Rat};

/// A station's distance from its body, as a part of the largest body.
const NEAR: f64 = 1.0 / 2048.0;

/// The stations of all bodies.
pub(crate) struct Stations {
    pub(crate) poses: Vec<Pose>,
    placed: Vec<Placed>,
    coarse: Grain,
    /// The grain of distances.
    grain: f64,
    /// Whether the bodies are still at the start, where everything is exact.
    start: bool,
}

/// Which way a distance is rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rounding {
    /// To the nearest.
    Nearest,
    /// Never upwards: what keeps the rounded distance keeps the true one.
    Down,
}

impl Stations {
    /// Every body at its own start.
    pub(crate) fn new(scaffold: &Scaffold, reach: f64, grain: f64) -> Stations {
        Stations {
            placed: scaffold.place(&scaffold.start),
            poses: scaffold.start.clone(),
            coarse: Grain::of(reach * NEAR, reach),
            grain,
            start: true,
        }
    }

    /// Lets the stations follow the bodies, if any has moved away from its own.
    pub(crate) fn follow(&mut self, scaffold: &Scaffold, poses: &[Pose]) {
        self.start &= poses == scaffold.start;
        let each = poses.iter().zip(&self.poses);
        if !self.start && !each.clone().all(|(p, s)| self.coarse.meets(p, s)) {
            self.poses = self.coarse.rounded(poses);
            self.placed = scaffold.place(&self.poses);
        }
    }

    /// The row of a pair: its gradient at the stations, its distance where the bodies are.
    pub(crate) fn row(
        &self,
        scaffold: &Scaffold,
        pair: &Pair,
        placed: &[Placed],
        rounding: Rounding,
    ) -> Row {
        let (there, true_scale) = scaffold.scaled_row(pair, placed);
        if self.start {
            return there;
        }
        let (mut row, scale) = scaffold.scaled_row(pair, &self.placed);
        // Coefficients without common factor, so that what is left of the distances is dyadic.
        let content = content(scaffold, &row);
        // A part that has no column need not be divisible, and is not read.
        let part = |v: &Int| v.div_rem_floor(&content).0;
        row.normal = [part(&row.normal[0]), part(&row.normal[1])];
        (row.theta1, row.theta2) = (part(&row.theta1), part(&row.theta2));
        // d₀ is to be a multiple of 2ᵏ, which is the grain or a little less; for k < 0 the row is
        // multiplied by 2⁻ᵏ.
        let k = (self.grain * length(&row)).log2().floor();
        let k = k.clamp(-200.0, 1000.0) as i64;
        let up = k.min(0).unsigned_abs();
        row.normal = row.normal.map(|v| v.shl(up));
        (row.theta1, row.theta2) = (row.theta1.shl(up), row.theta2.shl(up));
        let k = k.max(0) as u64;
        let top = (&there.d0 * &scale).shl(up);
        let bottom = (&true_scale * &content).shl(k);
        let top = match rounding {
            Rounding::Down => top,
            Rounding::Nearest => top + bottom.shr(1),
        };
        row.d0 = top.div_rem_floor(&bottom).0.shl(k);
        row
    }
}

/// The greatest common divisor of what a row has in the program's columns; 1 where that is nothing.
fn content(scaffold: &Scaffold, row: &Row) -> Int {
    let entries = scaffold.entries(row);
    let g = entries.iter().fold(Int::zero(), |g, (_, v)| g.gcd(v));
    if g.is_zero() { Int::one() } else { g }
}

/// |n| of a row, roughly.
fn length(row: &Row) -> f64 {
    let [x, y] = row.normal.each_ref().map(|v| double(&Rat::from(v.clone())));
    x.hypot(y).max(f64::MIN_POSITIVE)
}
