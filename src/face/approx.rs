//! Reals known as a double and an error bound.
//!
//! The idea: an interval costs two directed roundings an operation, a running error bound costs a few
//! ordinary instructions (Higham, Accuracy and Stability, §3.3). `v ± e` encloses the real number; every
//! operation adds its own rounding error to `e` and rounds the bound itself up. Overflow and NaN
//! make comparisons fail, so they certify nothing.

use crate::number::Interval;
use std::ops::{Add, Mul, Neg, Sub};

/// The real number lies in [v − e, v + e].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Approx {
    /// The value computed.
    pub(crate) v: f64,
    /// Its error bound; infinite or NaN where nothing is known.
    pub(crate) e: f64,
}

/// The unit roundoff 2⁻⁵³.
const U: f64 = f64::EPSILON / 2.0;
/// Covers the roundings made while the bound itself is computed (fewer than eight).
const SLACK: f64 = 1.0 + 8.0 * f64::EPSILON;
/// Covers underflow: every product of a bound may lose a few times the least double.
const TINY: f64 = f64::MIN_POSITIVE;

impl Approx {
    /// A double, exactly.
    #[inline]
    pub(crate) fn exact(v: f64) -> Approx {
        Approx { v, e: 0.0 }
    }
    /// An integer.
    #[inline]
    pub(crate) fn from_int(x: i128) -> Approx {
        match i64::try_from(x) {
            Ok(x) => Approx::from_word(x),
            Err(_) => {
                let v = x as f64;
                let e = v.abs() * f64::EPSILON;
                Approx { v, e }
            }
        }
    }
    /// A machine integer.
    #[inline]
    pub(crate) fn from_word(x: i64) -> Approx {
        let v = x as f64;
        let exact = x.unsigned_abs() < 1 << 53;
        Approx {
            v,
            e: if exact { 0.0 } else { v.abs() * f64::EPSILON },
        }
    }
    /// Anything between the ends.
    #[inline]
    pub(crate) fn between(lo: f64, hi: f64) -> Approx {
        if lo == hi {
            return Approx::exact(lo);
        }
        let v = lo + (hi - lo) * 0.5;
        Approx {
            v,
            e: (hi - v).max(v - lo) * SLACK + TINY,
        }
    }
    /// From an outward-rounded interval.
    #[inline]
    pub(crate) fn from_interval(i: Interval) -> Approx {
        Approx::between(i.lo, i.hi)
    }
    /// The sign where it is certain; `Some(0)` only for an exact zero.
    #[inline]
    pub(crate) fn sign(self) -> Option<i32> {
        if self.v > self.e {
            Some(1)
        } else if -self.v > self.e {
            Some(-1)
        } else if self.v == 0.0 && self.e == 0.0 {
            Some(0)
        } else {
            None
        }
    }
    /// Lower end, rounded down.
    #[inline]
    pub(crate) fn lo(self) -> f64 {
        if self.e == 0.0 {
            self.v
        } else {
            (self.v - self.e).next_down()
        }
    }
    /// Upper end, rounded up.
    #[inline]
    pub(crate) fn hi(self) -> f64 {
        if self.e == 0.0 {
            self.v
        } else {
            (self.v + self.e).next_up()
        }
    }
    /// Half of it; exact but for underflow.
    #[inline]
    pub(crate) fn half(self) -> Approx {
        Approx {
            v: self.v * 0.5,
            e: self.e * 0.5 + if self.v == 0.0 { 0.0 } else { TINY },
        }
    }
    /// Quotient; nothing is known where the divisor may be zero.
    #[inline]
    pub(crate) fn over(self, d: Approx) -> Approx {
        let room = d.v.abs() - d.e;
        // Not a number fails this test too.
        if room > 0.0 {
            let v = self.v / d.v;
            Approx {
                v,
                e: ((self.e + v.abs() * d.e) / room + v.abs() * U) * SLACK + TINY,
            }
        } else {
            Approx {
                v: 0.0,
                e: f64::INFINITY,
            }
        }
    }
    /// Square root of a number known to be positive; nothing is known otherwise.
    #[inline]
    pub(crate) fn sqrt(self) -> Approx {
        if self.v > self.e {
            let s = self.v.sqrt();
            // |√(v+d) − √v| ≤ |d|/√v
            Approx {
                v: s,
                e: (self.e / s + s * U) * SLACK + TINY,
            }
        } else {
            Approx {
                v: 0.0,
                e: f64::INFINITY,
            }
        }
    }
}

impl Add for Approx {
    type Output = Approx;
    #[inline]
    fn add(self, o: Approx) -> Approx {
        let v = self.v + o.v;
        Approx {
            v,
            e: (self.e + o.e + v.abs() * U) * SLACK,
        }
    }
}
impl Sub for Approx {
    type Output = Approx;
    #[inline]
    fn sub(self, o: Approx) -> Approx {
        let v = self.v - o.v;
        Approx {
            v,
            e: (self.e + o.e + v.abs() * U) * SLACK,
        }
    }
}
impl Mul for Approx {
    type Output = Approx;
    #[inline]
    fn mul(self, o: Approx) -> Approx {
        let v = self.v * o.v;
        Approx {
            v,
            e: (self.v.abs() * o.e + (o.v.abs() + o.e) * self.e + v.abs() * U) * SLACK + TINY,
        }
    }
}
impl Neg for Approx {
    type Output = Approx;
    #[inline]
    fn neg(self) -> Approx {
        Approx {
            v: -self.v,
            e: self.e,
        }
    }
}

/// c₀ + c₁x + c₂x² + …
#[inline]
pub(crate) fn horner(c: &[Approx], x: Approx) -> Approx {
    let mut terms = c.iter().rev();
    let Some(&first) = terms.next() else {
        return Approx::exact(0.0);
    };
    terms.fold(first, |acc, &k| acc * x + k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Rat;

    /// Random expressions, recomputed with rationals: the enclosure holds the truth.
    #[test]
    fn encloses_the_rational_result() {
        let mut seed = 0x9e37_79b9_7f4a_7c15u64;
        let mut next = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            seed
        };
        for _ in 0..2000 {
            let mut draw = || {
                let m = (next() >> 12) as f64 - 2f64.powi(51);
                m * 2f64.powi((next() >> 60) as i32 * 6 - 90)
            };
            let (a, b) = (draw(), draw());
            let (mut x, mut exact) = (Approx::exact(a), Rat::from_f64(a));
            let (y, other) = (Approx::exact(b), Rat::from_f64(b));
            for k in 0..4 {
                (x, exact) = match (k, b != 0.0) {
                    (0, _) => (x + y, &exact + &other),
                    (1, _) => (x * y, &exact * &other),
                    (2, true) => (
                        x.over(y + Approx::exact(1.0)),
                        &exact / &(&other + Rat::one()),
                    ),
                    _ => (x - y * x, &exact - &(&other * &exact)),
                };
                if x.lo().is_finite() && x.hi().is_finite() {
                    assert!(
                        Rat::from_f64(x.lo()) <= exact && exact <= Rat::from_f64(x.hi()),
                        "{x:?} {exact}"
                    );
                }
            }
        }
    }
}
