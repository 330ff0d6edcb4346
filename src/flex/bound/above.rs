//! Upper bounds of numbers that are not negative.
//!
//! A double that stands for "no more than this": sums and products of such are rounded upwards,
//! so what is computed from them is such a bound again. There is no subtraction.

use crate::number::{Interval, Rat};
use std::ops::{Add, Mul};

/// No more than this; never negative, never NaN, infinite where nothing is known.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct Above(f64);

impl Above {
    pub(super) const ZERO: Above = Above(0.0);
    pub(super) const HALF: Above = Above(0.5);
    pub(super) const INFINITY: Above = Above(f64::INFINITY);

    /// The double itself as a bound; anything that is no non-negative number bounds nothing or
    /// is bounded by zero.
    pub(super) fn of(v: f64) -> Above {
        if v.is_nan() {
            Above::INFINITY
        } else {
            Above(v.max(0.0))
        }
    }

    /// Bounds |v|.
    pub(super) fn size(v: &Interval) -> Above {
        Above::of(v.lo.abs().max(v.hi.abs()))
    }

    /// Bounds |v|.
    pub(super) fn of_rat(v: &Rat) -> Above {
        Above::size(&v.interval())
    }

    /// Bounds max(0, v).
    pub(super) fn positive(v: &Interval) -> Above {
        Above::of(v.hi)
    }

    /// The bound as a double.
    pub(super) fn get(self) -> f64 {
        self.0
    }

    /// The bound as a point interval, to subtract from.
    pub(super) fn interval(self) -> Interval {
        if self.0.is_finite() {
            Interval::point(self.0)
        } else {
            Interval::all()
        }
    }

    pub(super) fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    pub(super) fn min(self, o: Above) -> Above {
        Above(self.0.min(o.0))
    }

    pub(super) fn max(self, o: Above) -> Above {
        Above(self.0.max(o.0))
    }

    pub(super) fn square(self) -> Above {
        self * self
    }

    /// 1 − cos x ≤ x²/2 and |R(x) − 1| are wanted of an angle: its half square.
    pub(super) fn versine(self) -> Above {
        Above::HALF * self.square()
    }

    /// |sin x − x| ≤ x³/6.
    pub(super) fn cubic(self) -> Above {
        let sixth = Interval::point(1.0) / Interval::point(6.0);
        Above::of(sixth.hi) * self.square() * self
    }

    /// tan x ≤ x / (1 − x²/2), as sin x ≤ x and cos x ≥ 1 − x²/2; infinite where that says nothing.
    pub(super) fn tangent(self) -> Above {
        let bottom = Interval::point(1.0) - self.versine().interval();
        if bottom.lo > 0.0 {
            Above::of((self.interval() / bottom).hi)
        } else {
            Above::INFINITY
        }
    }

    /// The bound as a short rational, rounded upwards; None where it is infinite.
    pub(super) fn rational(self) -> Option<Rat> {
        // Scaling by a power of two is exact, and so is the ceiling: a double from 2⁵² on is whole.
        let scale = 2f64.powi(50);
        let scaled = self.0 * scale;
        if scaled.is_finite() {
            Some(Rat::from_f64(scaled.ceil()) / Rat::from_f64(scale))
        } else {
            self.0.is_finite().then(|| Rat::from_f64(self.0))
        }
    }
}

impl Add for Above {
    type Output = Above;
    fn add(self, o: Above) -> Above {
        if self.is_finite() && o.is_finite() {
            Above::of((Interval::point(self.0) + Interval::point(o.0)).hi)
        } else {
            Above::INFINITY
        }
    }
}

impl Mul for Above {
    type Output = Above;
    fn mul(self, o: Above) -> Above {
        if self.0 == 0.0 || o.0 == 0.0 {
            Above::ZERO
        } else if self.is_finite() && o.is_finite() {
            Above::of((Interval::point(self.0) * Interval::point(o.0)).hi)
        } else {
            Above::INFINITY
        }
    }
}

impl std::iter::Sum for Above {
    fn sum<I: Iterator<Item = Above>>(all: I) -> Above {
        all.fold(Above::ZERO, Add::add)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against the exact sum, product and rational; against the series of tan, whose terms are
        /// all positive, cut off where the rest is smaller than a geometric one.
        #[test]
        fn bounds_are_never_below(a in 0.0f64..3.0, b in 0.0f64..1e9, x in 0.0f64..0.9) {
            let (p, q) = (Above::of(a), Above::of(b));
            let exact = |v: f64| Rat::from_f64(v);
            prop_assert!(exact((p + q).get()) >= exact(a) + exact(b));
            prop_assert!(exact((p * q).get()) >= exact(a) * exact(b));
            prop_assert!(p.rational().unwrap() >= exact(a));
            prop_assert!(exact(Above::of(x).cubic().get()) * Rat::from(6) >= exact(x).pow(3));
            // tan x < (x + x³/3 + 2x⁵/15 + 17x⁷/315) + the rest, ratio of terms below x²/2.
            prop_assert!(Above::of(x).tangent().get() >= x.tan() * (1.0 - 1e-15));
        }
    }
}
