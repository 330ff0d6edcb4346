//! Limits of rotation, where a program promises what its direction does not keep.
//!
//! The displacement of a long chain is curved: past the turn at which it is largest it falls. A
//! linear program knows no such turn. It leads from one extreme of every joint to the other, the
//! line search stops half way, and the next program leads back: steps that gain less and less, a
//! hundred of them. The classical cure (move limits of sequential linear programming) is to bound
//! every body's rotation by what it last turned, half as much where it turns back, twice as much
//! where it goes on as far as it may. Whoever is at its best turn is held there ever more closely,
//! while the rest moves on.
//!
//! Limits come up only when a step must be shortened, or gains less than half of what was
//! promised. Every program is still exact: they are bounds of its columns. And a run does not end
//! with them: what gains too little under limits must gain too little without.

use crate::number::Rat;

/// A step that gains less than this part of its promise calls for limits.
const KEPT: f64 = 0.5;
/// A body whose turn is this part of its limit would have gone on.
const FULL: f64 = 0.99;
/// Limits that return are wider by this factor.
const WIDER: f64 = 4.0;
/// Smallest limit, in radians.
const LEAST: f64 = 1e-9;
/// Largest limit.
const MOST: f64 = 1.0;

/// The limits of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Limits {
    each: Option<Vec<f64>>,
    /// Limits that were lifted.
    before: Option<Vec<f64>>,
    last: Vec<f64>,
}

impl Limits {
    /// Whether the next program has limits.
    pub(crate) fn active(&self) -> bool {
        self.each.is_some()
    }

    /// The bound of each body's rotation in the next program, short.
    pub(crate) fn bounds(&self) -> Option<Vec<Rat>> {
        let short = |v: &f64| {
            let unit = 2f64.powi(v.log2().floor() as i32 - 3);
            Rat::from_f64((v / unit).ceil() * unit)
        };
        Some(self.each.as_ref()?.iter().map(short).collect())
    }

    /// Takes the limits away, for one step or for good.
    pub(crate) fn lift(&mut self) {
        self.before = self.each.take().or(self.before.take());
    }

    /// Learns from a step: how every body turned, the part of its direction that was followed,
    /// what it was to gain in all, and what it gained.
    pub(crate) fn learn(&mut self, turned: &[f64], scale: f64, promise: f64, gain: f64) {
        let trusted = promise <= 0.0 || (scale >= 1.0 && gain >= KEPT * promise);
        let old = std::mem::replace(&mut self.last, turned.to_vec());
        match &mut self.each {
            None if trusted => {}
            None => {
                let before = self.before.take();
                let first = |(b, t): (usize, &f64)| {
                    let known = before.as_ref().map_or(MOST, |all| WIDER * all[b]);
                    t.abs().min(known).clamp(LEAST, MOST)
                };
                self.each = Some(turned.iter().enumerate().map(first).collect());
            }
            Some(all) => {
                for ((limit, now), old) in all.iter_mut().zip(turned).zip(old) {
                    let factor = if now * old < 0.0 {
                        0.5
                    } else if now.abs() >= FULL * *limit {
                        2.0
                    } else {
                        1.0
                    };
                    *limit = (*limit * factor).clamp(LEAST, MOST);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body that turns back is held more closely; one that goes on as far as it may, less.
    #[test]
    fn limits_follow_what_bodies_do() {
        let mut limits = Limits::default();
        limits.learn(&[0.5, 0.5, 0.5], 1.0, 1.0, 0.9);
        assert!(!limits.active());
        limits.learn(&[0.25, 0.25, 0.125], 0.25, 1.0, 0.1);
        let half = |n| Rat::frac(n, 16);
        assert_eq!(limits.bounds(), Some(vec![half(4), half(4), half(2)]));
        limits.learn(&[-0.125, 0.25, 0.0625], 1.0, 1.0, 0.9);
        assert_eq!(limits.bounds(), Some(vec![half(2), half(8), half(2)]));
        limits.lift();
        assert_eq!(limits.bounds(), None);
    }
}
