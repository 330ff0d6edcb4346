//! Where the gradients of a step are taken, and how far they are rounded.
//!
//! A program says J q̇ + d₀ ≥ 0. What must be accurate is d₀, or errors would add up; J may be taken
//! nearby, since it multiplies a motion that gets shorter from step to step (Newton's method with
//! a held derivative). The first step is exact in both. After it
//!
//! - J is taken where every body has its *station*: its pose of some steps ago, kept until any
//!   body has moved away from its own. So the last programs of a run, in which hardly anything
//!   moves, share one matrix, and the basis of one solves the next.
//! - Unit normals, vertices and reference points there are rounded to some ten bits, and J is
//!   computed from them exactly. Its numbers are short, and with them all of the exact work; and
//!   what depends on each other because bodies are rigid still does.
//! - d₀ is rounded to a multiple of a small grain, far below what a step must gain: constraints
//!   that a configuration meets up to its own rounding are met exactly, and the vertex of the
//!   program that it stands on is one vertex, not hundreds within 10⁻⁹ of each other.
//!
//! J is off by about 2⁻¹⁰, relatively, so a step of length q̇ is left with a violation of 2⁻¹⁰ |q̇|
//! beside the second-order one that every linear step has. The exact test judges both.

use super::model::{Row, Scaffold};
use super::pairs::Pair;
use super::shape::{Placed, Pose, double};
use crate::number::{Int, Rat};

/// Bits of a unit normal's parts, and of a length as long as the largest body.
const BITS: i32 = 10;

/// The stations of all bodies.
pub(crate) struct Stations {
    pub(crate) poses: Vec<Pose>,
    placed: Vec<Placed>,
    /// Lengths are multiples of 2 to minus this.
    length_bits: i32,
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
    /// Downwards: what keeps the rounded distance keeps the true one.
    Down,
}

impl Stations {
    /// Every body at its own start.
    pub(crate) fn new(scaffold: &Scaffold, reach: f64, grain: f64) -> Stations {
        let size = reach.max(f64::MIN_POSITIVE).log2().floor();
        Stations {
            placed: scaffold.place(&scaffold.start),
            poses: scaffold.start.clone(),
            length_bits: (BITS - size.clamp(-900.0, 900.0) as i32).clamp(-900, 900),
            grain,
            start: true,
        }
    }

    /// Bits of the geometry that gradients are taken from; None where that is exact.
    pub(crate) fn bits(&self) -> Option<u32> {
        (!self.start).then_some(BITS.unsigned_abs())
    }

    /// Lets the stations follow the bodies, if any has moved away from its own.
    pub(crate) fn follow(&mut self, scaffold: &Scaffold, poses: &[Pose], placed: &[Placed]) {
        self.start &= poses == scaffold.start;
        let length = 2f64.powi(-self.length_bits);
        let meets = |p: &Placed, s: &Placed| {
            let apart = |a: f64, b: f64, by: f64| (a - b).abs() <= by;
            let turn = 2f64.powi(-BITS);
            apart(p.centre[0], s.centre[0], length)
                && apart(p.centre[1], s.centre[1], length)
                && apart(p.cos, s.cos, turn)
                && apart(p.sin, s.sin, turn)
        };
        let stays = placed.iter().zip(&self.placed).all(|(p, s)| meets(p, s));
        if !self.start && !stays {
            self.poses = poses.to_vec();
            self.placed = placed.to_vec();
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
        let rounded = if self.start {
            None
        } else {
            self.rounded(scaffold, pair, placed, rounding)
        };
        rounded.unwrap_or_else(|| scaffold.row(pair, placed))
    }

    /// The rounded row; None where doubles are no good for it.
    fn rounded(
        &self,
        scaffold: &Scaffold,
        pair: &Pair,
        placed: &[Placed],
        rounding: Rounding,
    ) -> Option<Row> {
        let (one, two) = (pair.line_body as usize, pair.point_body as usize);
        let (n, _, to) = scaffold.seen(pair, &self.placed);
        let whole = |v: f64, bits: i32| {
            let scaled = (v * 2f64.powi(bits)).round();
            (scaled.abs() < 9e15).then_some(scaled as i64)
        };
        let point = |p: [f64; 2]| -> Option<[Int; 2]> {
            let at = |k: usize| whole(p[k], self.length_bits).map(Int::from);
            Some([at(0)?, at(1)?])
        };
        let normal = [Int::from(whole(n[0], BITS)?), Int::from(whole(n[1], BITS)?)];
        let (at, x1, x2) = (
            point(to)?,
            point(self.placed[one].centre)?,
            point(self.placed[two].centre)?,
        );
        let from = |x: &[Int; 2]| [&at[0] - &x[0], &at[1] - &x[1]];
        let (arm1, arm2) = (from(&x1), from(&x2));
        let cross = super::shape::cross;
        // Everything times 2^(BITS + length_bits), and the true normal times 2^BITS is rounded.
        let (mut theta1, mut theta2) = (cross(&normal, &arm1), cross(&arm2, &normal));
        // d₀ is a multiple of 2ᵏ in these units, which is the grain or a little less; for k < 0
        // the row is multiplied by 2⁻ᵏ. What the row is multiplied by must not be below one for
        // the normal either.
        let scale = self.length_bits + BITS;
        let k = self.grain.log2().floor() as i32 + scale;
        let up = (-k).max(0).max(-self.length_bits).unsigned_abs().into();
        let k = k + up as i32;
        (theta1, theta2) = (theta1.shl(up), theta2.shl(up));
        let stretch = (self.length_bits + up as i32).unsigned_abs().into();
        let normal = normal.map(|v| v.shl(stretch));
        let (mut d, mut error) = scaffold.near(pair, placed);
        if error > self.grain / 8.0 {
            let row = scaffold.row(pair, placed);
            let size = double(&super::step::violation(&row)).sqrt();
            (d, error) = (size * f64::from(row.d0.sign()), size * 1e-15);
        }
        let units = d * 2f64.powi(scale + up as i32 - k);
        let units = match rounding {
            Rounding::Down => (units - error / self.grain).floor(),
            Rounding::Nearest => units.round(),
        };
        // What was not negative stays so.
        let units = if d >= 0.0 { units.max(0.0) } else { units };
        let d0 = Rat::from_f64(units.is_finite().then_some(units)?).floor();
        Some(Row {
            pair: *pair,
            normal,
            theta1,
            theta2,
            d0: d0.shl(k.unsigned_abs().into()),
        })
    }
}
