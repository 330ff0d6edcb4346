//! `Scalar`: what the geometry asks of a coordinate, whichever arithmetic is behind it.
//!
//! Methods, not operators: a bound on `&R: Add<&R>` would have to be repeated at every use.

use super::{Interval, Rat};
use std::fmt::Debug;
use std::hash::Hash;

/// A coordinate or a coefficient: an exact rational, or a double that may have been rounded.
pub trait Scalar: Clone + Debug + Default + Ord + Hash + 'static {
    /// Whether arithmetic is exact.
    const EXACT: bool;
    /// Whether a value is no number but an enclosure of one.
    const ROUGH: bool = false;
    /// The number nearest to a rational; the rational itself where numbers are exact.
    fn from_rat(r: &Rat) -> Self;
    /// The number itself as a rational.
    fn to_rat(&self) -> Rat;
    /// self + o.
    fn plus(&self, o: &Self) -> Self;
    /// self − o.
    fn minus(&self, o: &Self) -> Self;
    /// self·o.
    fn times(&self, o: &Self) -> Self;
    /// self/o, for o ≠ 0.
    fn over(&self, o: &Self) -> Self;
    /// −self.
    fn negated(&self) -> Self;
    /// −1, 0 or 1.
    fn sign(&self) -> i32;
    /// A certified enclosure where numbers are exact, the double itself where they are not.
    fn interval(&self) -> Interval;
    /// Whether it is zero, or nothing beside `size` as far as the arithmetic can tell.
    fn vanishes_beside(&self, size: &Self) -> bool;

    /// 0.
    fn zero() -> Self {
        Self::default()
    }
    /// 1.
    fn one() -> Self {
        Self::from_rat(&Rat::one())
    }
    /// Whether it is zero.
    fn is_zero(&self) -> bool {
        self.sign() == 0
    }
    /// The absolute value.
    fn abs(&self) -> Self {
        if self.sign() < 0 {
            self.negated()
        } else {
            self.clone()
        }
    }
    /// self².
    fn square(&self) -> Self {
        self.times(self)
    }
}

impl Scalar for Rat {
    const EXACT: bool = true;
    fn from_rat(r: &Rat) -> Rat {
        r.clone()
    }
    fn to_rat(&self) -> Rat {
        self.clone()
    }
    fn plus(&self, o: &Rat) -> Rat {
        self + o
    }
    fn minus(&self, o: &Rat) -> Rat {
        self - o
    }
    fn times(&self, o: &Rat) -> Rat {
        self * o
    }
    fn over(&self, o: &Rat) -> Rat {
        self / o
    }
    fn negated(&self) -> Rat {
        -self
    }
    fn sign(&self) -> i32 {
        Rat::sign(self)
    }
    fn interval(&self) -> Interval {
        Rat::interval(self)
    }
    fn vanishes_beside(&self, _size: &Rat) -> bool {
        Rat::is_zero(self)
    }
    fn zero() -> Rat {
        Rat::zero()
    }
    fn one() -> Rat {
        Rat::one()
    }
    fn is_zero(&self) -> bool {
        Rat::is_zero(self)
    }
}

/// A number known by a certified enclosure only: what geometry computes with it encloses what the
/// number itself would give. It has no sign of its own, so only questions of the form *certainly
/// so* may be asked of what comes out; the order serves containers.
#[derive(Clone, Copy, Debug)]
pub struct Enclosed(Interval);

impl Enclosed {
    /// What lies in an interval.
    pub fn new(i: Interval) -> Enclosed {
        Enclosed(i)
    }
    fn bits(&self) -> [u64; 2] {
        [self.0.lo.to_bits(), self.0.hi.to_bits()]
    }
}

impl Default for Enclosed {
    fn default() -> Enclosed {
        Enclosed(Interval::point(0.0))
    }
}
impl PartialEq for Enclosed {
    fn eq(&self, o: &Enclosed) -> bool {
        self.bits() == o.bits()
    }
}
impl Eq for Enclosed {}
impl PartialOrd for Enclosed {
    fn partial_cmp(&self, o: &Enclosed) -> Option<std::cmp::Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Enclosed {
    fn cmp(&self, o: &Enclosed) -> std::cmp::Ordering {
        self.bits().cmp(&o.bits())
    }
}
impl Hash for Enclosed {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.bits().hash(state);
    }
}

impl Scalar for Enclosed {
    const EXACT: bool = false;
    const ROUGH: bool = true;
    fn from_rat(r: &Rat) -> Enclosed {
        Enclosed(r.interval())
    }
    /// The middle; of no use but to print.
    fn to_rat(&self) -> Rat {
        let m = self.0.lo.midpoint(self.0.hi);
        Rat::from_f64(if m.is_finite() { m } else { 0.0 })
    }
    #[inline]
    fn plus(&self, o: &Enclosed) -> Enclosed {
        Enclosed(self.0 + o.0)
    }
    #[inline]
    fn minus(&self, o: &Enclosed) -> Enclosed {
        Enclosed(self.0 - o.0)
    }
    #[inline]
    fn times(&self, o: &Enclosed) -> Enclosed {
        Enclosed(self.0 * o.0)
    }
    fn over(&self, o: &Enclosed) -> Enclosed {
        Enclosed(self.0 / o.0)
    }
    #[inline]
    fn negated(&self) -> Enclosed {
        Enclosed(-self.0)
    }
    /// The sign that holds throughout, 0 where there is none.
    fn sign(&self) -> i32 {
        self.0.sign().unwrap_or(0)
    }
    #[inline]
    fn interval(&self) -> Interval {
        self.0
    }
    fn vanishes_beside(&self, _size: &Enclosed) -> bool {
        self.0.contains(0.0)
    }
    fn one() -> Enclosed {
        Enclosed(Interval::point(1.0))
    }
}
