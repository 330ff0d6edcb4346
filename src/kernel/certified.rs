//! The certified kernels: rationals, integer polynomials and real algebraic numbers.

use super::{Instant, Kernel, Polynomial, Position, Time};
use crate::number::{Algebraic, Int, Interval, Poly, Rat};
use std::cmp::Ordering;

/// Exact numbers, asked through their double enclosures first (`FILTER`) or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Certified<const FILTER: bool>;

/// The default kernel: double enclosures, then a wider fixed precision, then exact arithmetic.
/// Its answers are those of [`Exact`], always.
pub type Filtered = Certified<true>;

/// The reference: no double decides anything or even shortens the way.
pub type Exact = Certified<false>;

impl<const FILTER: bool> Kernel for Certified<FILTER> {
    type Num = Rat;
    type Coef = Int;
    type Key = Vec<Int>;
    type Poly = Poly;
    type Root = Algebraic;
    type Time = Time;

    const CERTIFIED: bool = true;
    const ENCLOSES: bool = FILTER;

    fn primitive(c: &[Rat]) -> Option<(Vec<Int>, i32)> {
        // A trailing one keeps zeros at the end and fixes no sign.
        let all: Vec<Rat> = c.iter().cloned().chain([Rat::one()]).collect();
        let raw = Poly::new(Poly::from_rats(&all).coeffs()[..c.len()].to_vec());
        let sign = raw.coeffs().last()?.sign();
        let prim = raw.primitive();
        Some(((0..c.len()).map(|i| prim.coeff(i)).collect(), sign))
    }
    fn key(c: &[Int]) -> Vec<Int> {
        c.to_vec()
    }
    fn stop(u: &Rat) -> [Int; 3] {
        [-u.numer(), u.denom().clone(), Int::zero()]
    }
    fn zero_coef() -> Int {
        Int::zero()
    }
    fn publish(c: &Int) -> Int {
        c.clone()
    }
}

impl<const FILTER: bool> Polynomial<Certified<FILTER>> for Poly {
    fn of(c: &[Rat]) -> Poly {
        Poly::from_rats(c)
    }
    fn pair(a: &[Rat; 3], b: &[Rat; 3]) -> (Poly, Poly) {
        let all: Vec<Rat> = a.iter().chain(b).cloned().chain([Rat::one()]).collect();
        let p = Poly::from_rats(&all);
        let c = |r: std::ops::Range<usize>| Poly::new(r.map(|i| p.coeff(i)).collect());
        (c(0..3), c(3..6))
    }
    fn of_curve(c: &[Int; 3], mirrored: bool) -> Poly {
        if mirrored {
            Poly::new(vec![c[2].clone(), -&c[1], c[0].clone()])
        } else {
            Poly::new(c.to_vec())
        }
    }
    fn zero() -> Poly {
        Poly::zero()
    }
    fn one() -> Poly {
        Poly::constant(Int::one())
    }
    fn is_zero(&self) -> bool {
        Poly::is_zero(self)
    }
    fn degree(&self) -> Option<usize> {
        Poly::degree(self)
    }
    fn negated(&self) -> Poly {
        -self
    }
    fn plus(&self, o: &Poly) -> Poly {
        self + o
    }
    fn minus(&self, o: &Poly) -> Poly {
        self - o
    }
    fn times(&self, o: &Poly) -> Poly {
        self * o
    }
    fn derivative(&self) -> Poly {
        Poly::derivative(self)
    }
    fn common(&self, o: &Poly) -> Poly {
        self.gcd(o)
    }
    /// Long division: a primitive divisor divides over the integers (Gauss).
    fn quotient(&self, g: &Poly) -> Poly {
        let (Some(dp), Some(dg)) = (self.degree(), g.degree()) else {
            return Poly::zero();
        };
        let mut rest = self.coeffs().to_vec();
        let lead = g.coeff(dg);
        let mut out = vec![Int::zero(); (dp + 1).saturating_sub(dg)];
        for k in (0..out.len()).rev() {
            let c = rest[k + dg].div_exact(&lead);
            for i in 0..=dg {
                rest[k + i] -= &(&c * &g.coeff(i));
            }
            out[k] = c;
        }
        Poly::new(out)
    }
    fn at_time(p: &Poly, q: &Poly, t: &Rat) -> Poly {
        p.scale(t.denom()) + q.scale(t.numer())
    }
    fn crossing(p1: &Poly, q1: &Poly, p2: &Poly, q2: &Poly) -> Poly {
        match proportional(q1, q2) {
            Some((c1, c2)) => p1.scale(&c2) - p2.scale(&c1),
            None => p1 * q2 - p2 * q1,
        }
    }
    fn constant_ratio(p: &Poly, q: &Poly) -> Rat {
        -Rat::new(p.coeff(0), q.coeff(0))
    }
    fn sign_at(&self, x: &Rat) -> i32 {
        Poly::sign_at(self, x)
    }
    fn eval_interval(&self, x: Interval) -> Interval {
        Poly::eval_interval(self, x)
    }
    fn chart_roots(&self) -> Vec<Algebraic> {
        if Poly::is_zero(self) {
            return Vec::new();
        }
        self.real_roots_in(&Rat::from(-1), &Rat::one())
    }
    fn roots(&self) -> Vec<Algebraic> {
        if Poly::is_zero(self) {
            return Vec::new();
        }
        self.real_roots()
    }
}

/// The leading coefficients of two proportional polynomials.
fn proportional(a: &Poly, b: &Poly) -> Option<(Int, Int)> {
    let d = a.degree()?;
    if b.degree() != Some(d) {
        return None;
    }
    let (ca, cb) = (a.coeff(d), b.coeff(d));
    (0..d)
        .all(|i| a.coeff(i) * &cb == b.coeff(i) * &ca)
        .then_some((ca, cb))
}

impl<const FILTER: bool> Position<Certified<FILTER>> for Algebraic {
    fn of(x: Rat) -> Algebraic {
        Algebraic::from(x)
    }
    fn same(&self, o: &Algebraic) -> bool {
        self.same_handle(o)
    }
    fn renew(&self) -> Algebraic {
        self.clone()
    }
    fn interval(&self) -> Interval {
        Algebraic::interval(self)
    }
    fn sign(&self) -> i32 {
        Algebraic::sign(self)
    }
    fn cmp_num(&self, x: &Rat) -> Ordering {
        self.cmp_rat(x)
    }
    fn sign_of(&self, p: &Poly) -> i32 {
        Algebraic::sign_of(self, p)
    }
    fn between(a: &Algebraic, b: &Algebraic) -> Rat {
        Algebraic::between(a, b)
    }
    fn ratio(&self, num: &Poly, den: &Poly) -> Algebraic {
        Algebraic::ratio(self, num, den)
    }
    fn publish(&self) -> Algebraic {
        self.clone()
    }
}

impl<const FILTER: bool> Instant<Certified<FILTER>> for Time {
    fn of(t: Rat) -> Time {
        Time::from(t)
    }
    fn same(&self, o: &Time) -> bool {
        self.same_handle(o)
    }
    fn ratio(x: &Algebraic, num: Poly, den: Poly) -> Time {
        Time::ratio(x, num, den)
    }
    fn at(x: Algebraic) -> Time {
        Time::at(x)
    }
    fn shift(&self, by: &Rat) -> Time {
        Time::shift(self, by)
    }
    fn interval(&self) -> Interval {
        Time::interval(self)
    }
    fn known(&self) -> Option<Rat> {
        self.as_rat().cloned()
    }
    fn decided(&self) -> Option<Rat> {
        match self.as_rat() {
            Some(r) => Some(r.clone()),
            None => self.exact().to_rat(),
        }
    }
    fn parts(&self) -> (Poly, Poly) {
        Time::parts(self)
    }
    fn cmp_num(&self, t: &Rat) -> Ordering {
        self.cmp_rat(t)
    }
    fn between(a: &Time, b: &Time) -> Rat {
        Time::between(a, b)
    }
    fn height(
        &self,
        p: &Poly,
        q: &Poly,
        about: Option<Interval>,
        near: &mut dyn FnMut(&Rat) -> Algebraic,
    ) -> Algebraic {
        let exact = self.exact();
        exact.root_over_about(p, q, about, &mut |bits| {
            let (lo, hi) = exact.enclosure(bits);
            let (a, b) = (near(&lo), near(&hi));
            let (a, b) = if a <= b { (a, b) } else { (b, a) };
            (a.enclosure(bits).0, b.enclosure(bits).1)
        })
    }
    fn publish(&self) -> Time {
        if FILTER { self.clone() } else { self.renewed() }
    }
}
