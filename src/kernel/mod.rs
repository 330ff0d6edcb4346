//! The kernels: which arithmetic answers the questions of the slice and the motion.
//!
//! The algorithms to the right of this module are written once, over a [`Kernel`]. They know
//! coordinates ([`Scalar`]), polynomials, positions and instants only by what they can be asked:
//! isolate the roots of this, compare those two, what is the sign of this polynomial there.
//! Speed against accuracy is then the choice of a type:
//!
//! | kernel | numbers | answers |
//! | --- | --- | --- |
//! | [`Filtered`] | rationals and real algebraic numbers, asked by double enclosures first | exact |
//! | [`Exact`] | the same numbers, with every double switched off | exact: the reference |
//! | [`Float`] | doubles, with zeros identified within a tolerance (DP §8.4.2) | may be wrong |
//!
//! # Why types and not a flag
//!
//! A float that could stand wherever a rational does would put the word *exact* at the mercy of
//! every call; as types, a double cannot reach an exact answer at all, and the float code pays
//! for no branch and no heap that it does not need. Everything generic has [`Filtered`] as its
//! default, so whoever wants exact answers (analysis, reports, certificates) names no kernel.
//! `Exact` differs from `Filtered` in nothing but the filter ([`crate::number::filter`]), and is
//! one type with it but for a constant: what it proves about the filter is then not clouded by a
//! second implementation.

mod certified;
mod float;
mod time;

pub use certified::{Certified, Exact, Filtered};
pub use float::{COEFFICIENT_BITS, Double, Float, FloatOptions, Identify, with_float};
pub use time::Time;

use crate::number::{Algebraic, Int, Interval, Scalar};
use std::cmp::Ordering;
use std::fmt::Debug;
use std::hash::Hash;

/// An arithmetic: its types, and the few questions that are not asked of one value alone.
pub trait Kernel: Copy + Debug + Default + 'static {
    /// Coordinates and coefficients.
    type Num: Scalar;
    /// Coefficients of a curve, content removed.
    type Coef: Clone + Debug + PartialEq;
    /// Equal keys are equal lines or curves.
    type Key: Clone + Debug + Eq + Hash;
    /// Polynomials in a chart's x, or in t.
    type Poly: Polynomial<Self>;
    /// Positions in a chart.
    type Root: Position<Self>;
    /// Instants of a phase.
    type Time: Instant<Self>;

    /// Whether its answers are exact.
    const CERTIFIED: bool;
    /// Whether interval tests before the numbers themselves save work.
    const ENCLOSES: bool;

    /// A phase begins: nothing identified in an earlier one concerns it.
    fn begin() {}
    /// Whether points that share a name are one point without any arithmetic.
    fn names() -> bool {
        true
    }
    /// The numbers without their common factor, the last non-zero one positive, and the sign that
    /// was taken out. None if all are zero.
    fn primitive(c: &[Self::Num]) -> Option<(Vec<Self::Coef>, i32)>;
    /// What equal lines or curves have in common.
    fn key(c: &[Self::Coef]) -> Self::Key;
    /// The coefficients of −n + d·u for a rational u = n/d, and zero.
    fn stop(u: &Self::Num) -> [Self::Coef; 3];
    /// The coefficient zero.
    fn zero_coef() -> Self::Coef;

    /// A coefficient as an integer: for doubles, times 2 to the [`COEFFICIENT_BITS`].
    fn publish(c: &Self::Coef) -> Int;

    /// The upper (true) or the lower end of a chart: 1 or −1.
    fn side(upper: bool) -> Self::Num {
        let one = Self::Num::one();
        if upper { one } else { one.negated() }
    }
}

/// A polynomial of low degree.
pub trait Polynomial<K: Kernel>: Clone + Debug {
    /// From coefficients, constant first, up to a positive factor.
    fn of(c: &[K::Num]) -> Self;
    /// Two quadratics by one common positive factor.
    fn pair(a: &[K::Num; 3], b: &[K::Num; 3]) -> (Self, Self);
    /// c₀ + c₁u + c₂u², or that as a polynomial of x = −1/u (times x²).
    fn of_curve(c: &[K::Coef; 3], mirrored: bool) -> Self;
    /// The zero polynomial.
    fn zero() -> Self;
    /// The constant one.
    fn one() -> Self;
    /// Whether it is zero.
    fn is_zero(&self) -> bool;
    /// None for the zero polynomial.
    fn degree(&self) -> Option<usize>;
    /// −self.
    fn negated(&self) -> Self;
    /// self + o.
    fn plus(&self, o: &Self) -> Self;
    /// self − o.
    fn minus(&self, o: &Self) -> Self;
    /// self·o.
    fn times(&self, o: &Self) -> Self;
    /// The derivative.
    fn derivative(&self) -> Self;
    /// The common divisor of the highest degree.
    fn common(&self, o: &Self) -> Self;
    /// self/g, where g divides it.
    fn quotient(&self, g: &Self) -> Self;
    /// P + t·Q, up to a positive factor.
    fn at_time(p: &Self, q: &Self, t: &K::Num) -> Self;
    /// The polynomial whose roots are where −P₁/Q₁ = −P₂/Q₂: of low degree where Q₁ and Q₂ are
    /// proportional.
    fn crossing(p1: &Self, q1: &Self, p2: &Self, q2: &Self) -> Self;
    /// −P/Q for constants.
    fn constant_ratio(p: &Self, q: &Self) -> K::Num;
    /// The sign at a number.
    fn sign_at(&self, x: &K::Num) -> i32;
    /// An enclosure of its values.
    fn eval_interval(&self, x: Interval) -> Interval;
    /// The roots in [−1, 1], ascending; none of the zero polynomial.
    fn chart_roots(&self) -> Vec<K::Root>;
    /// All real roots, ascending; none of the zero polynomial.
    fn roots(&self) -> Vec<K::Root>;
}

/// A position in a chart; the order is that of the numbers.
pub trait Position<K: Kernel>: Clone + Debug + Ord {
    /// A number.
    fn of(x: K::Num) -> Self;
    /// Whether both are handles of one position; no arithmetic, false proves nothing.
    fn same(&self, o: &Self) -> bool;
    /// The position among those of a phase that begins.
    fn renew(&self) -> Self;
    /// An enclosure.
    fn interval(&self) -> Interval;
    /// −1, 0 or 1.
    fn sign(&self) -> i32;
    /// Comparison with a number.
    fn cmp_num(&self, x: &K::Num) -> Ordering;
    /// The sign of a polynomial there.
    fn sign_of(&self, p: &K::Poly) -> i32;
    /// A number strictly between two different positions.
    fn between(a: &Self, b: &Self) -> K::Num;
    /// num/den there, as a position.
    fn ratio(&self, num: &K::Poly, den: &K::Poly) -> Self;
    /// The exact number that stands for it in a result.
    fn publish(&self) -> Algebraic;
}

/// An instant of a phase, counted from its start.
pub trait Instant<K: Kernel>: Clone + Debug + Ord {
    /// A number.
    fn of(t: K::Num) -> Self;
    /// Whether both are handles of one instant; no arithmetic, false proves nothing.
    fn same(&self, o: &Self) -> bool;
    /// num(x)/den(x), where den does not vanish.
    fn ratio(x: &K::Root, num: K::Poly, den: K::Poly) -> Self;
    /// The instant that is the root itself.
    fn at(x: K::Root) -> Self;
    /// This instant on a clock that started `by` earlier.
    fn shift(&self, by: &K::Num) -> Self;
    /// An enclosure.
    fn interval(&self) -> Interval;
    /// The number, where it is known to be one without work.
    fn known(&self) -> Option<K::Num>;
    /// The number, where it is one.
    fn decided(&self) -> Option<K::Num>;
    /// Numerator and denominator as polynomials of the position that it was made at.
    fn parts(&self) -> (K::Poly, K::Poly);
    /// Comparison with a number.
    fn cmp_num(&self, t: &K::Num) -> Ordering;
    /// A number strictly between two different instants.
    fn between(a: &Self, b: &Self) -> K::Num;
    /// The root of p + self·q in the enclosure `about`, if that is given and holds no other; else that which `near`
    /// points at: at a number near this instant it gives the position to look at.
    fn height(
        &self,
        p: &K::Poly,
        q: &K::Poly,
        about: Option<Interval>,
        near: &mut dyn FnMut(&K::Num) -> K::Root,
    ) -> K::Root;
    /// The exact instant that stands for it in a result.
    fn publish(&self) -> Time;
}
