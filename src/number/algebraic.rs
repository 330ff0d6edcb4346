//! Real algebraic numbers. STUB.
use super::{Interval, Poly, Rat};
use std::cmp::Ordering;

/// A real algebraic number: a rational, or the one root of a square-free integer polynomial in an isolating interval. Immutable, Send + Sync, cheap to clone.
#[derive(Clone, Debug)]
pub struct Algebraic {
    _x: (),
}
impl Algebraic {
    /// The exact rational value where the number is rational (decided, not guessed).
    pub fn to_rat(&self) -> Option<Rat> {
        todo!()
    }
    /// The rational value where the representation is rational already (no work; None proves nothing).
    pub fn known_rat(&self) -> Option<Rat> {
        todo!()
    }
    /// Certified double enclosure, a few ulps wide, made once.
    pub fn interval(&self) -> Interval {
        todo!()
    }
    /// Rationals lo ≤ self ≤ hi with hi − lo ≤ 2^-bits; lo = hi only where self is rational and equal to it; otherwise lo < self < hi.
    pub fn enclosure(&self, _bits: u32) -> (Rat, Rat) {
        todo!()
    }
    /// Nearest double, ties to even; None past the range.
    pub fn nearest_f64(&self) -> Option<f64> {
        todo!()
    }
    /// -1, 0, 1.
    pub fn sign(&self) -> i32 {
        todo!()
    }
    /// Exact comparison with a rational.
    pub fn cmp_rat(&self, _r: &Rat) -> Ordering {
        todo!()
    }
    /// Exact sign of a polynomial at this number.
    pub fn sign_of(&self, _p: &Poly) -> i32 {
        todo!()
    }
    /// Primitive irreducible polynomial with positive leading coefficient.
    pub fn minimal_polynomial(&self) -> Poly {
        todo!()
    }
    /// The contract's interval: [k/2^j, (k+1)/2^j] with the least j ≥ 0 that isolates the root of `minimal_polynomial`.
    pub fn isolating_interval(&self) -> (Rat, Rat) {
        todo!()
    }
    /// num(self)/den(self). Panics if den vanishes there.
    pub fn ratio(&self, _num: &Poly, _den: &Poly) -> Algebraic {
        todo!()
    }
    /// A rational strictly between two different numbers, of few bits. Panics if equal.
    pub fn between(_a: &Algebraic, _b: &Algebraic) -> Rat {
        todo!()
    }
    /// The root x of p(x) + self·q(x) that lies in the enclosures delivered by `locate` (rational lo ≤ x ≤ hi, shrinking to the root as bits grow).
    pub fn root_over(
        &self,
        _p: &Poly,
        _q: &Poly,
        _locate: &mut dyn FnMut(u32) -> (Rat, Rat),
    ) -> Algebraic {
        todo!()
    }
}
impl From<Rat> for Algebraic {
    fn from(_r: Rat) -> Algebraic {
        todo!()
    }
}
impl PartialEq for Algebraic {
    fn eq(&self, _o: &Algebraic) -> bool {
        todo!()
    }
}
impl Eq for Algebraic {}
impl PartialOrd for Algebraic {
    fn partial_cmp(&self, o: &Algebraic) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Algebraic {
    fn cmp(&self, _o: &Algebraic) -> Ordering {
        todo!()
    }
}
