//! Rounding of configurations: short rationals near a pose.
//!
//! Positions become multiples of a power of two, tan(θ/2) a simple fraction, the same one for as
//! many bodies as may share it. Exactness is untouched: whatever rounding does to the constraints
//! is seen by the exact test, which judges the rounded configuration.

use super::model::Form;
use super::shape::{Pose, double};
use crate::geometry::Vec2;
use crate::number::{Int, Rat};

/// Radii of rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grain {
    /// Positions are multiples of 2⁻ᵏ for this k.
    place_bits: u32,
    /// tan(θ/2) may move by this much times (1 + tan²).
    turn: f64,
}

impl Grain {
    /// A grain for poses that are to be kept within a distance.
    pub(crate) fn of(distance: f64, reach: f64) -> Grain {
        let bits = (-distance.log2()).ceil().clamp(0.0, 50.0) as u32 + 1;
        Grain {
            place_bits: bits,
            turn: (distance / (4.0 * reach.max(1e-9))).clamp(1e-15, 1e-3),
        }
    }

    /// The distance that rounding may move a vertex by, roughly.
    pub(crate) fn distance(&self) -> f64 {
        2f64.powi(1 - self.place_bits as i32)
    }

    /// The range for tan(θ/2) of a pose turned by dθ; None where it does not turn. Doubles are
    /// good enough for what is rounded anyway.
    fn turned(&self, pose: &Pose, by: f64) -> Option<(f64, f64)> {
        let half = by / 2.0;
        let u = double(&pose.tan_half);
        let turned = (u + half) / (1.0 - u * half);
        let radius = self.turn * (1.0 + turned * turned);
        (half != 0.0 && turned.is_finite()).then_some((turned - radius, turned + radius))
    }

    /// The configuration after a direction at a scale, rounded. Bodies that are fixed stay.
    pub(crate) fn moved(
        &self,
        poses: &[Pose],
        forms: &[Form],
        direction: &[[f64; 3]],
        scale: f64,
    ) -> Vec<Pose> {
        let turns = |k: usize| match forms[k] {
            Form::Fixed => None,
            _ => self.turned(&poses[k], direction[k][2] * scale),
        };
        let turns: Vec<Option<(f64, f64)>> = (0..poses.len()).map(turns).collect();
        let turned = shared(&turns);
        let each = poses.iter().zip(direction).zip(forms);
        each.zip(turned)
            .map(|(((pose, d), form), turned)| match form {
                Form::Fixed => pose.clone(),
                _ => self.advance(pose, d.map(|v| v * scale), turned),
            })
            .collect()
    }

    /// The nearest multiple of the grain.
    fn at(&self, v: &Rat) -> Rat {
        let scale = Int::one().shl(u64::from(self.place_bits));
        let scaled = v * &Rat::from(scale.clone());
        Rat::new((scaled + Rat::frac(1, 2)).floor(), scale)
    }

    /// A pose moved by (dx, dy), rounded, and turned to a given tan(θ/2). A motion that is no
    /// number leaves the pose as it is.
    fn advance(&self, pose: &Pose, by: [f64; 3], turned: Option<Rat>) -> Pose {
        if by.iter().any(|v| !v.is_finite()) {
            return pose.clone();
        }
        let tan_half = turned.unwrap_or_else(|| pose.tan_half.clone());
        let shift = |at: &Rat, d: f64| {
            if d == 0.0 {
                return at.clone();
            }
            self.at(&(at + &Rat::from_f64(d)))
        };
        Pose {
            place: Vec2::new(shift(&pose.place.x, by[0]), shift(&pose.place.y, by[1])),
            tan_half,
        }
    }
}

/// A simple fraction in each range, as few different ones as there can be: bodies that round alike
/// stand exactly parallel, and their rows become dependent rather than nearly so.
fn shared(ranges: &[Option<(f64, f64)>]) -> Vec<Option<Rat>> {
    let mut order: Vec<(f64, f64, usize)> = ranges
        .iter()
        .enumerate()
        .filter_map(|(k, r)| r.map(|(lo, hi)| (lo, hi, k)))
        .collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.cmp(&b.2)));
    let mut out = vec![None; ranges.len()];
    let mut begin = 0;
    while begin < order.len() {
        // All ranges that hold the end of the first one meet.
        let hi = order[begin].1;
        let mut end = begin;
        let mut lo = f64::NEG_INFINITY;
        while end < order.len() && order[end].0 <= hi {
            lo = lo.max(order[end].0);
            end += 1;
        }
        let one = simplest(&Rat::from_f64(lo), &Rat::from_f64(hi));
        for (_, _, k) in &order[begin..end] {
            out[*k] = Some(one.clone());
        }
        begin = end;
    }
    out
}

/// The fraction of least denominator in [lo, hi] (lo ≤ hi), by continued fractions.
fn simplest(lo: &Rat, hi: &Rat) -> Rat {
    if lo.sign() <= 0 && hi.sign() >= 0 {
        return Rat::zero();
    }
    if hi.sign() < 0 {
        return -simplest(&-hi, &-lo);
    }
    let whole = lo.ceil();
    if Rat::from(whole.clone()) <= *hi {
        return Rat::from(whole);
    }
    // Both share their whole part, and neither is whole.
    let whole = Rat::from(lo.floor());
    let rest = simplest(&(hi - &whole).recip(), &(lo - &whole).recip());
    whole + rest.recip()
}
