//! `Rat`: rationals in lowest terms. STUB.
use super::int::ops;
use super::{Int, Interval};
use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A rational number in lowest terms with a positive denominator.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default, PartialOrd, Ord)]
pub struct Rat {
    num: Int,
    den: Int,
}

impl Rat {
    /// num/den in lowest terms. Panics if den is zero.
    pub fn new(_num: Int, _den: Int) -> Rat {
        todo!()
    }
    /// Zero.
    pub fn zero() -> Rat {
        todo!()
    }
    /// One.
    pub fn one() -> Rat {
        todo!()
    }
    /// num/den of machine integers. Panics if den is zero.
    pub fn frac(_num: i64, _den: i64) -> Rat {
        todo!()
    }
    /// Numerator.
    pub fn numer(&self) -> &Int {
        &self.num
    }
    /// Denominator, positive.
    pub fn denom(&self) -> &Int {
        &self.den
    }
    /// -1, 0 or 1.
    pub fn sign(&self) -> i32 {
        self.num.sign()
    }
    /// Whether zero.
    pub fn is_zero(&self) -> bool {
        self.num.is_zero()
    }
    /// Whether an integer.
    pub fn is_integer(&self) -> bool {
        todo!()
    }
    /// 1/self. Panics on zero.
    pub fn recip(&self) -> Rat {
        todo!()
    }
    /// Absolute value.
    pub fn abs(&self) -> Rat {
        todo!()
    }
    /// self².
    pub fn square(&self) -> Rat {
        self * self
    }
    /// Largest integer ≤ self.
    pub fn floor(&self) -> Int {
        todo!()
    }
    /// Smallest integer ≥ self.
    pub fn ceil(&self) -> Int {
        todo!()
    }
    /// (a+b)/2.
    pub fn midpoint(_a: &Rat, _b: &Rat) -> Rat {
        todo!()
    }
    /// A dyadic rational of few bits strictly between a < b. Panics unless a < b.
    pub fn short_between(_a: &Rat, _b: &Rat) -> Rat {
        todo!()
    }
    /// The exact value of a finite double. Panics on NaN and infinities.
    pub fn from_f64(_x: f64) -> Rat {
        todo!()
    }
    /// Nearest double, ties to even; None past the double range.
    pub fn nearest_f64(&self) -> Option<f64> {
        todo!()
    }
    /// Tightest double enclosure (a point where exact).
    pub fn interval(&self) -> Interval {
        todo!()
    }
}
impl From<Int> for Rat {
    fn from(_v: Int) -> Rat {
        todo!()
    }
}
impl From<i64> for Rat {
    fn from(_v: i64) -> Rat {
        todo!()
    }
}
impl std::str::FromStr for Rat {
    type Err = String;
    fn from_str(_s: &str) -> Result<Rat, String> {
        todo!()
    }
}
impl fmt::Display for Rat {
    fn fmt(&self, _f: &mut fmt::Formatter<'_>) -> fmt::Result {
        todo!()
    }
}
ops!(Rat);
impl Div<&Rat> for &Rat {
    type Output = Rat;
    fn div(self, _o: &Rat) -> Rat {
        todo!()
    }
}
impl Div<Rat> for Rat {
    type Output = Rat;
    fn div(self, _o: Rat) -> Rat {
        todo!()
    }
}
impl Div<&Rat> for Rat {
    type Output = Rat;
    fn div(self, _o: &Rat) -> Rat {
        todo!()
    }
}
impl Div<Rat> for &Rat {
    type Output = Rat;
    fn div(self, _o: Rat) -> Rat {
        todo!()
    }
}
