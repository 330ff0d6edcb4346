//! Univariate integer polynomials. STUB.
use super::int::ops;
use super::{Algebraic, Int, Interval, Rat};
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A univariate polynomial with integer coefficients, constant first, no trailing zeros.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default, PartialOrd, Ord)]
pub struct Poly {
    coeffs: Vec<Int>,
}
impl Poly {
    /// From coefficients, constant first; trailing zeros are dropped.
    pub fn new(_coeffs: Vec<Int>) -> Poly {
        todo!()
    }
    /// Clears denominators by their (positive) lcm: the same signs and roots as the rational polynomial.
    pub fn from_rats(_coeffs: &[Rat]) -> Poly {
        todo!()
    }
    /// The zero polynomial.
    pub fn zero() -> Poly {
        todo!()
    }
    /// A constant.
    pub fn constant(_c: Int) -> Poly {
        todo!()
    }
    /// None for the zero polynomial.
    pub fn degree(&self) -> Option<usize> {
        self.coeffs.len().checked_sub(1)
    }
    /// Whether zero.
    pub fn is_zero(&self) -> bool {
        self.coeffs.is_empty()
    }
    /// All coefficients, constant first.
    pub fn coeffs(&self) -> &[Int] {
        &self.coeffs
    }
    /// Coefficient of x^i (zero past the degree).
    pub fn coeff(&self, _i: usize) -> Int {
        todo!()
    }
    /// Exact value.
    pub fn eval(&self, _x: &Rat) -> Rat {
        todo!()
    }
    /// Sign of the value at a rational (f64 filter first).
    pub fn sign_at(&self, _x: &Rat) -> i32 {
        todo!()
    }
    /// Enclosure of the range over an interval.
    pub fn eval_interval(&self, _x: Interval) -> Interval {
        todo!()
    }
    /// Derivative.
    pub fn derivative(&self) -> Poly {
        todo!()
    }
    /// Non-negative gcd of the coefficients.
    pub fn content(&self) -> Int {
        todo!()
    }
    /// Content removed, leading coefficient positive.
    pub fn primitive(&self) -> Poly {
        todo!()
    }
    /// Multiplied by an integer.
    pub fn scale(&self, _c: &Int) -> Poly {
        todo!()
    }
    /// Exact quotient, None if d does not divide self over the rationals; the quotient is returned up to a positive rational factor that makes it integral.
    pub fn div_exact(&self, _d: &Poly) -> Option<Poly> {
        todo!()
    }
    /// Primitive greatest common divisor.
    pub fn gcd(&self, _other: &Poly) -> Poly {
        todo!()
    }
    /// Primitive square-free part.
    pub fn squarefree(&self) -> Poly {
        todo!()
    }
    /// Irreducible primitive factors over the rationals (without multiplicity), any order.
    pub fn irreducible_factors(&self) -> Vec<Poly> {
        todo!()
    }
    /// Distinct real roots, ascending. Panics on the zero polynomial.
    pub fn real_roots(&self) -> Vec<Algebraic> {
        todo!()
    }
    /// Distinct real roots in the closed interval, ascending. Panics on the zero polynomial.
    pub fn real_roots_in(&self, _lo: &Rat, _hi: &Rat) -> Vec<Algebraic> {
        todo!()
    }
}
ops!(Poly);
