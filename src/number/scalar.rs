//! `Scalar`: what the geometry asks of a coordinate, whichever arithmetic is behind it.
//!
//! Methods, not operators: a bound on `&R: Add<&R>` would have to be repeated at every use.

use super::{Interval, Rat};
use std::fmt::Debug;
use std::hash::Hash;

/// A coordinate or a coefficient: an exact rational, or a double that may have been rounded.
pub trait Scalar: Clone + Debug + Default + Ord + Hash + 'static {
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
