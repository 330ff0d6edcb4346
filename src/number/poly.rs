//! Univariate integer polynomials: the equations of the engine, content and sign in plain sight.
//!
//! The idea: work without fractions. A polynomial over the rationals has the same roots and, scaled
//! by a positive number, the same signs as one over the integers, so coefficients are `Int` and no step
//! reduces a fraction. Every expensive question (gcd, divisibility) is put to a word-size prime first.

use super::algebraic::Algebraic;
use super::filter::{self, Stage};
use super::isolate::isolate;
use super::ops::ops;
use super::quadratic::quadratic_roots;
use super::{Int, Interval, Rat, factor, gcd};
use std::fmt;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A univariate polynomial with integer coefficients, constant first, no trailing zeros.
///
/// # Example
/// ```
/// use snapfit::number::{Int, Poly};
/// // x² − 2
/// let p = Poly::new(vec![Int::from(-2i64), Int::zero(), Int::one()]);
/// let roots = p.real_roots();
/// assert_eq!(roots.len(), 2);
/// assert_eq!(roots[1].nearest_f64(), Some(std::f64::consts::SQRT_2));
/// ```
#[derive(Clone, PartialEq, Eq, Hash, Default, PartialOrd, Ord)]
pub struct Poly {
    coeffs: Vec<Int>,
}

impl Poly {
    /// From coefficients, constant first; trailing zeros are dropped.
    pub fn new(mut coeffs: Vec<Int>) -> Poly {
        while coeffs.last().is_some_and(Int::is_zero) {
            coeffs.pop();
        }
        Poly { coeffs }
    }
    /// From machine integers, constant first.
    pub fn from_i64(coeffs: &[i64]) -> Poly {
        Poly::new(coeffs.iter().map(|&c| Int::from(c)).collect())
    }
    /// Clears denominators by their (positive) lcm: the same signs and roots as the rational polynomial.
    pub fn from_rats(coeffs: &[Rat]) -> Poly {
        let mut lcm = Int::one();
        for c in coeffs {
            if !c.is_integer() {
                let g = lcm.gcd(c.denom());
                lcm *= c.denom().div_exact(&g);
            }
        }
        if lcm.is_one() {
            return Poly::new(coeffs.iter().map(|c| c.numer().clone()).collect());
        }
        Poly::new(
            coeffs
                .iter()
                .map(|c| c.numer() * lcm.div_exact(c.denom()))
                .collect(),
        )
    }
    /// The zero polynomial.
    pub fn zero() -> Poly {
        Poly { coeffs: Vec::new() }
    }
    /// A constant.
    pub fn constant(c: Int) -> Poly {
        Poly::new(vec![c])
    }
    /// None for the zero polynomial.
    #[inline]
    pub fn degree(&self) -> Option<usize> {
        self.coeffs.len().checked_sub(1)
    }
    /// Whether zero.
    #[inline]
    pub fn is_zero(&self) -> bool {
        self.coeffs.is_empty()
    }
    /// All coefficients, constant first.
    #[inline]
    pub fn coeffs(&self) -> &[Int] {
        &self.coeffs
    }
    /// Coefficient of x^i (zero past the degree).
    pub fn coeff(&self, i: usize) -> Int {
        self.coeffs.get(i).cloned().unwrap_or_default()
    }
    /// The leading coefficient; None for the zero polynomial.
    pub fn leading(&self) -> Option<&Int> {
        self.coeffs.last()
    }
    /// Exact value.
    pub fn eval(&self, x: &Rat) -> Rat {
        let Some(n) = self.degree() else {
            return Rat::zero();
        };
        if x.is_integer() {
            return Rat::from(self.eval_homogeneous(x));
        }
        Rat::new(self.eval_homogeneous(x), x.denom().pow(n as u32))
    }
    /// Exact value at an integer.
    pub fn eval_int(&self, x: &Int) -> Int {
        self.coeffs
            .iter()
            .rev()
            .fold(Int::zero(), |acc, c| acc * x + c)
    }
    /// The value at num/den, times den^degree: no fraction on the way.
    fn eval_homogeneous(&self, x: &Rat) -> Int {
        let (num, den) = (x.numer(), x.denom());
        if den.is_one() {
            return self.eval_int(num);
        }
        let mut weight = Int::one();
        let mut terms = self.coeffs.iter().rev();
        let mut acc = terms.next().cloned().unwrap_or_default();
        for c in terms {
            weight *= den;
            acc = acc * num + c * &weight;
        }
        acc
    }
    /// The value at m/2^e, times 2^(e·degree).
    pub(crate) fn eval_dyadic(&self, m: &Int, e: u64) -> Int {
        let mut terms = self.coeffs.iter().rev();
        let mut acc = terms.next().cloned().unwrap_or_default();
        let mut shift = 0;
        for c in terms {
            shift += e;
            acc = acc * m + c.shl(shift);
        }
        acc
    }
    pub(crate) fn sign_at_dyadic(&self, m: &Int, e: u64) -> i32 {
        self.eval_dyadic(m, e).sign()
    }
    /// Sign of the value at a rational (f64 filter first).
    pub fn sign_at(&self, x: &Rat) -> i32 {
        if let Some(s) = self.sign_over(x.interval()) {
            filter::settled(Stage::Double);
            return s;
        }
        let s = self.eval_homogeneous(x).sign();
        filter::settled_exactly(s == 0, self.most_bits());
        s
    }
    /// Enclosure of the range over an interval.
    pub fn eval_interval(&self, x: Interval) -> Interval {
        self.eval_scaled(x, 0)
    }
    /// Enclosure of the range over an interval, times 2^shift.
    fn eval_scaled(&self, x: Interval, shift: i64) -> Interval {
        if !filter::on() {
            return Interval::all();
        }
        let of = |c: &Int| match shift {
            0 => c.interval(),
            _ => c.interval_shifted(shift),
        };
        let mut terms = self.coeffs.iter().rev();
        let Some(first) = terms.next() else {
            return Interval::point(0.0);
        };
        terms.fold(of(first), |acc, c| acc * x + of(c))
    }
    /// The sign that the values over an interval are proven to have. Coefficients past the range of doubles
    /// are scaled into it together.
    pub(crate) fn sign_over(&self, x: Interval) -> Option<i32> {
        self.eval_scaled(x, into_range(self.most_bits())).sign()
    }
    /// Enclosure of num/den over an interval; both are scaled together where doubles do not hold
    /// their coefficients.
    pub(crate) fn quotient_over(num: &Poly, den: &Poly, x: Interval) -> Interval {
        let shift = into_range(num.most_bits().max(den.most_bits()));
        num.eval_scaled(x, shift) / den.eval_scaled(x, shift)
    }
    /// The bits of the largest coefficient.
    pub(crate) fn most_bits(&self) -> u64 {
        self.coeffs.iter().map(Int::bits).max().unwrap_or(0)
    }
    /// Derivative.
    pub fn derivative(&self) -> Poly {
        Poly {
            coeffs: self
                .coeffs
                .iter()
                .enumerate()
                .skip(1)
                .map(|(i, c)| c * Int::from(i as i64))
                .collect(),
        }
    }
    /// Non-negative gcd of the coefficients.
    pub fn content(&self) -> Int {
        let mut g = Int::zero();
        for c in &self.coeffs {
            g = g.gcd(c);
            if g.is_one() {
                break;
            }
        }
        g
    }
    /// Content removed, leading coefficient positive.
    pub fn primitive(&self) -> Poly {
        let g = self.content();
        let negative = self.leading().is_some_and(|l| l.sign() < 0);
        match (g.is_zero() || g.is_one(), negative) {
            (true, false) => self.clone(),
            (true, true) => self.negated(),
            (false, _) => self.unscale(&if negative { -g } else { g }),
        }
    }
    /// Every coefficient divided by a common divisor.
    fn unscale(&self, g: &Int) -> Poly {
        Poly {
            coeffs: self.coeffs.iter().map(|c| c.div_exact(g)).collect(),
        }
    }
    /// Multiplied by an integer.
    pub fn scale(&self, c: &Int) -> Poly {
        if c.is_zero() {
            return Poly::zero();
        }
        Poly {
            coeffs: self.coeffs.iter().map(|x| x * c).collect(),
        }
    }
    /// Exact quotient, None if `d` does not divide self over the rationals (or is zero); the quotient is
    /// returned up to a positive rational factor that makes it integral.
    pub fn div_exact(&self, d: &Poly) -> Option<Poly> {
        let m = d.degree()?;
        if self.is_zero() {
            return Some(Poly::zero());
        }
        let n = self.degree()?;
        if n < m {
            return None;
        }
        // Gauss: the quotient of primitive polynomials, if there is one, is integral.
        let mut r = self.unscale(&self.content()).coeffs;
        let d = d.unscale(&d.content());
        let lead = d.leading()?;
        let mut q = vec![Int::zero(); n - m + 1];
        for k in (0..q.len()).rev() {
            let (c, rest) = r[k + m].div_rem_floor(lead);
            if !rest.is_zero() {
                return None;
            }
            if !c.is_zero() {
                for (i, y) in d.coeffs.iter().enumerate() {
                    r[k + i] -= &c * y;
                }
            }
            q[k] = c;
        }
        r.iter().all(Int::is_zero).then(|| Poly::new(q))
    }
    /// Primitive greatest common divisor; gcd(0, 0) = 0.
    pub fn gcd(&self, other: &Poly) -> Poly {
        self.common(other, false)
    }
    /// The same where this polynomial is known to be primitive, which saves looking for contents.
    pub(crate) fn gcd_of_primitive(&self, other: &Poly) -> Poly {
        self.common(other, true)
    }
    fn common(&self, other: &Poly, primitive: bool) -> Poly {
        if self.is_zero() {
            return other.primitive();
        }
        if other.is_zero() {
            return self.primitive();
        }
        if self.coeffs.len() == 1 || other.coeffs.len() == 1 {
            return Poly::constant(Int::one());
        }
        if let Some(g) = gcd::gcd(self, other, primitive) {
            return g;
        }
        let (a, b) = if self.coeffs.len() >= other.coeffs.len() {
            (self, other)
        } else {
            (other, self)
        };
        subresultant_gcd(a.primitive(), b.primitive())
    }
    /// Remainder of lc(d)^(n−m+1)·self by d, for n ≥ m.
    fn pseudo_rem(&self, d: &Poly) -> Poly {
        let (Some(n), Some(m), Some(lead)) = (self.degree(), d.degree(), d.leading()) else {
            return self.clone();
        };
        let mut r = self.coeffs.clone();
        for k in (0..=n - m).rev() {
            let c = r[k + m].clone();
            for x in &mut r[..k + m] {
                *x = &*x * lead;
            }
            for i in 0..m {
                r[k + i] -= &c * &d.coeffs[i];
            }
            r.truncate(k + m);
        }
        Poly::new(r)
    }
    /// Primitive square-free part: the same roots, each once. A constant gives 1, zero gives zero.
    pub fn squarefree(&self) -> Poly {
        let p = self.primitive();
        if p.coeffs.len() <= 2 {
            return p;
        }
        let d = p.derivative();
        let g = p.gcd(&d);
        if g.coeffs.len() <= 1 {
            return p;
        }
        // Over the rationals, and `div_exact` asks no more.
        p.div_exact(&g).expect("a gcd divides").primitive()
    }
    /// Resultant: lc(self)^deg(other) · Π other(root of self). Zero if either is zero.
    pub(crate) fn resultant(&self, other: &Poly) -> Int {
        let (Some(n), Some(m)) = (self.degree(), other.degree()) else {
            return Int::zero();
        };
        let (mut a, mut b, mut sign) = (self.clone(), other.clone(), 1);
        if n < m {
            std::mem::swap(&mut a, &mut b);
            if n % 2 == 1 && m % 2 == 1 {
                sign = -1;
            }
        }
        // Subresultant chain (Cohen, A Course in Computational Algebraic Number Theory, algorithm 3.3.7).
        let (mut g, mut h) = (Int::one(), Int::one());
        loop {
            let (da, db) = (a.coeffs.len() - 1, b.coeffs.len() - 1);
            let lead = b.coeffs[db].clone();
            if db == 0 {
                // h^(1−da)·lead^da
                let p = lead.pow(da as u32);
                let r = if da == 0 {
                    p * h
                } else {
                    p.div_exact(&h.pow(da as u32 - 1))
                };
                return if sign < 0 { -r } else { r };
            }
            if da % 2 == 1 && db % 2 == 1 {
                sign = -sign;
            }
            let delta = (da - db) as u32;
            let r = a.pseudo_rem(&b);
            if r.is_zero() {
                return Int::zero();
            }
            let divisor = &g * h.pow(delta);
            a = b;
            b = r.unscale(&divisor);
            g = lead;
            h = if delta == 0 {
                h
            } else {
                g.pow(delta).div_exact(&h.pow(delta - 1))
            };
        }
    }
    /// Irreducible primitive factors over the rationals (without multiplicity), ascending by degree and
    /// coefficients. Constants and zero have none.
    pub fn irreducible_factors(&self) -> Vec<Poly> {
        if self.is_zero() {
            return Vec::new();
        }
        let mut f = factor::squarefree(&self.squarefree());
        f.sort_by(|a, b| a.degree().cmp(&b.degree()).then_with(|| a.cmp(b)));
        f
    }
    /// Distinct real roots, ascending. Closed form up to degree 2.
    ///
    /// # Panics
    /// On the zero polynomial, which every number is a root of.
    pub fn real_roots(&self) -> Vec<Algebraic> {
        assert!(
            !self.is_zero(),
            "every number is a root of the zero polynomial"
        );
        match &self.coeffs[..] {
            [_] => Vec::new(),
            [c, b] => vec![Algebraic::from(Rat::new(-c, b.clone()))],
            [c, b, a] => quadratic_roots(a, b, c),
            _ => {
                let p = self.squarefree();
                if p.coeffs.len() <= 3 {
                    return p.real_roots();
                }
                let found = isolate(&p);
                Algebraic::from_isolated(p, found)
            }
        }
    }
    /// Distinct real roots in the closed interval, ascending.
    ///
    /// # Panics
    /// On the zero polynomial.
    pub fn real_roots_in(&self, lo: &Rat, hi: &Rat) -> Vec<Algebraic> {
        let mut roots = self.real_roots();
        roots.retain(|r| r.cmp_rat(lo).is_ge() && r.cmp_rat(hi).is_le());
        roots
    }
    fn plus(&self, o: &Poly) -> Poly {
        let (long, short) = if self.coeffs.len() >= o.coeffs.len() {
            (self, o)
        } else {
            (o, self)
        };
        let mut c = long.coeffs.clone();
        for (x, y) in c.iter_mut().zip(&short.coeffs) {
            *x += y;
        }
        Poly::new(c)
    }
    fn minus(&self, o: &Poly) -> Poly {
        let mut c = self.coeffs.clone();
        if c.len() < o.coeffs.len() {
            c.resize(o.coeffs.len(), Int::zero());
        }
        for (x, y) in c.iter_mut().zip(&o.coeffs) {
            *x -= y;
        }
        Poly::new(c)
    }
    fn times(&self, o: &Poly) -> Poly {
        if self.is_zero() || o.is_zero() {
            return Poly::zero();
        }
        let mut c = vec![Int::zero(); self.coeffs.len() + o.coeffs.len() - 1];
        for (i, x) in self.coeffs.iter().enumerate() {
            for (j, y) in o.coeffs.iter().enumerate() {
                c[i + j] += x * y;
            }
        }
        Poly::new(c)
    }
    fn negated(&self) -> Poly {
        Poly {
            coeffs: self.coeffs.iter().map(|c| -c).collect(),
        }
    }
}

/// Primitive gcd of primitive polynomials, deg a ≥ deg b (Brown & Traub; Cohen, algorithm 3.3.1).
pub(super) fn subresultant_gcd(mut a: Poly, mut b: Poly) -> Poly {
    let (mut g, mut h) = (Int::one(), Int::one());
    loop {
        let delta = (a.coeffs.len() - b.coeffs.len()) as u32;
        let r = a.pseudo_rem(&b);
        if r.is_zero() {
            return b.primitive();
        }
        if r.coeffs.len() == 1 {
            return Poly::constant(Int::one());
        }
        let divisor = &g * h.pow(delta);
        g = b.coeffs[b.coeffs.len() - 1].clone();
        a = b;
        b = r.unscale(&divisor);
        h = if delta == 0 {
            h
        } else {
            g.pow(delta).div_exact(&h.pow(delta - 1))
        };
    }
}

/// The shift that brings integers of so many bits well into the range of doubles, 0 where they are already.
fn into_range(bits: u64) -> i64 {
    const LIMIT: i64 = 400;
    let bits = bits as i64;
    if bits > LIMIT { LIMIT - bits } else { 0 }
}

/// Human form, highest power first.
impl fmt::Display for Poly {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_zero() {
            return f.write_str("0");
        }
        let mut first = true;
        for (i, c) in self
            .coeffs
            .iter()
            .enumerate()
            .rev()
            .filter(|(_, c)| !c.is_zero())
        {
            match (first, c.sign() < 0) {
                (true, true) => f.write_str("-")?,
                (true, false) => {}
                (false, true) => f.write_str(" - ")?,
                (false, false) => f.write_str(" + ")?,
            }
            first = false;
            let a = c.abs();
            match (i, a.is_one()) {
                (0, _) => write!(f, "{a}")?,
                (1, true) => f.write_str("x")?,
                (1, false) => write!(f, "{a}x")?,
                (_, true) => write!(f, "x^{i}")?,
                (_, false) => write!(f, "{a}x^{i}")?,
            }
        }
        Ok(())
    }
}
impl fmt::Debug for Poly {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
ops!(Poly);

#[cfg(test)]
mod tests {
    use super::*;

    fn from_roots(lead: i64, roots: &[i64]) -> Poly {
        roots
            .iter()
            .fold(Poly::from_i64(&[lead]), |p, r| p * Poly::from_i64(&[-r, 1]))
    }

    #[test]
    fn resultants_are_products_over_roots() {
        let lists: [&[i64]; 6] = [
            &[],
            &[2],
            &[-1, 4],
            &[0, 3, -5],
            &[1, 1, 2, -7],
            &[9, -9, 8, 3, 0],
        ];
        for a in lists {
            for b in lists {
                for (la, lb) in [(1i64, 1i64), (-2, 3), (5, -7)] {
                    let (p, q) = (from_roots(la, a), from_roots(lb, b));
                    // lc(p)^deg q · Π q(root of p)
                    let want = a.iter().fold(Int::from(la).pow(b.len() as u32), |acc, &r| {
                        acc * q.eval_int(&Int::from(r))
                    });
                    assert_eq!(p.resultant(&q), want, "{p}; {q}");
                }
            }
        }
        assert_eq!(
            Poly::zero().resultant(&Poly::from_i64(&[1, 1])),
            Int::zero()
        );
        // Multiplicative in each argument, and of no matter to the order but for the sign.
        let (p, q, r) = (
            Poly::from_i64(&[3, -1, 0, 2]),
            Poly::from_i64(&[-5, 0, 7]),
            Poly::from_i64(&[1, 2, 3, 4, 5]),
        );
        assert_eq!((&p * &q).resultant(&r), p.resultant(&r) * q.resultant(&r));
        assert_eq!(p.resultant(&(&q * &r)), p.resultant(&q) * p.resultant(&r));
        assert_eq!(p.resultant(&q), q.resultant(&p));
        let odd = Poly::from_i64(&[4, 1, 1, 1]);
        assert_eq!(p.resultant(&odd), -odd.resultant(&p));
    }

    #[test]
    fn printed_as_people_write() {
        assert_eq!(Poly::from_i64(&[-1, 1, 0, -2]).to_string(), "-2x^3 + x - 1");
        assert_eq!(Poly::from_i64(&[0, -1, 1]).to_string(), "x^2 - x");
        assert_eq!(Poly::zero().to_string(), "0");
    }

    #[test]
    fn exact_quotients_keep_the_sign() {
        let (p, d) = (Poly::from_i64(&[-6, 0, 6]), Poly::from_i64(&[2, -2]));
        // (6x² − 6)/(−2x + 2) = −3x − 3, up to a positive factor.
        assert_eq!(p.div_exact(&d), Some(Poly::from_i64(&[-1, -1])));
        assert_eq!(
            p.div_exact(&Poly::from_i64(&[-4])),
            Some(Poly::from_i64(&[1, 0, -1]))
        );
        assert_eq!(p.div_exact(&Poly::from_i64(&[1, 2])), None);
        assert_eq!(p.div_exact(&Poly::zero()), None);
        assert_eq!(Poly::zero().div_exact(&p), Some(Poly::zero()));
        assert_eq!(d.div_exact(&p), None);
        assert_eq!(
            Poly::from_rats(&[Rat::frac(-1, 6), Rat::frac(1, 4)]),
            Poly::from_i64(&[-2, 3])
        );
    }
}
