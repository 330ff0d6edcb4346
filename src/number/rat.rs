//! `Rat`: rationals in lowest terms.
//!
//! The idea: a rational is worth its cost only while it stays short, so every operation reduces at once, with
//! the smallest gcds that do (Knuth, TAOCP 2, §4.5.1: a sum needs one gcd of the denominators and mostly no
//! other; a product needs two small ones instead of a large one). While the parts fit machine words all of
//! it happens in registers.

use super::int::{gcd_u64, ops};
use super::interval::pow2;
use super::{Int, Interval, filter};
use num_rational::BigRational;
use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A rational number in lowest terms with a positive denominator.
///
/// # Example
/// ```
/// use snapfit::number::Rat;
/// let third = Rat::frac(1, 3);
/// assert_eq!(&third + &Rat::frac(1, 6), Rat::frac(1, 2));
/// assert_eq!(third.nearest_f64(), Some(1.0 / 3.0));
/// ```
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Rat {
    num: Int,
    den: Int,
}

/// |a| and |b| where both stay below 2^62: products and sums of two products then fit an i128.
#[inline]
fn words(a: &Int, b: &Int) -> Option<(i64, i64)> {
    const LIMIT: i64 = 1 << 62;
    match (a.to_i64(), b.to_i64()) {
        (Some(a), Some(b)) if -LIMIT < a && a < LIMIT && b < LIMIT => Some((a, b)),
        _ => None,
    }
}

/// n/d in lowest terms from gcd-free parts.
#[inline]
fn raw(num: Int, den: Int) -> Rat {
    Rat { num, den }
}

impl Rat {
    /// num/den in lowest terms.
    ///
    /// # Panics
    /// If `den` is zero.
    pub fn new(num: Int, den: Int) -> Rat {
        assert!(!den.is_zero(), "a rational with denominator zero");
        let (num, den) = if den.sign() < 0 {
            (-num, -den)
        } else {
            (num, den)
        };
        if den.is_one() {
            return raw(num, den);
        }
        let g = num.gcd(&den);
        if g.is_one() {
            raw(num, den)
        } else {
            raw(num.div_exact(&g), den.div_exact(&g))
        }
    }
    /// m·2^e in lowest terms.
    pub(crate) fn dyadic(m: Int, e: i64) -> Rat {
        if e >= 0 {
            return Rat::from(m.shl(e as u64));
        }
        let Some(z) = m.trailing_zeros() else {
            return Rat::zero();
        };
        let k = z.min(e.unsigned_abs());
        raw(m.shr(k), Int::one().shl(e.unsigned_abs() - k))
    }
    /// Zero.
    #[inline]
    pub fn zero() -> Rat {
        raw(Int::zero(), Int::one())
    }
    /// One.
    #[inline]
    pub fn one() -> Rat {
        raw(Int::one(), Int::one())
    }
    /// num/den of machine integers.
    ///
    /// # Panics
    /// If `den` is zero.
    pub fn frac(num: i64, den: i64) -> Rat {
        Rat::new(Int::from(num), Int::from(den))
    }
    /// Numerator.
    #[inline]
    pub fn numer(&self) -> &Int {
        &self.num
    }
    /// Denominator, positive.
    #[inline]
    pub fn denom(&self) -> &Int {
        &self.den
    }
    /// -1, 0 or 1.
    #[inline]
    pub fn sign(&self) -> i32 {
        self.num.sign()
    }
    /// Whether zero.
    #[inline]
    pub fn is_zero(&self) -> bool {
        self.num.is_zero()
    }
    /// Whether an integer.
    #[inline]
    pub fn is_integer(&self) -> bool {
        self.den.is_one()
    }
    /// 1/self.
    ///
    /// # Panics
    /// If self is zero.
    pub fn recip(&self) -> Rat {
        assert!(!self.is_zero(), "the reciprocal of zero");
        if self.sign() < 0 {
            raw(-&self.den, -&self.num)
        } else {
            raw(self.den.clone(), self.num.clone())
        }
    }
    /// Absolute value.
    pub fn abs(&self) -> Rat {
        raw(self.num.abs(), self.den.clone())
    }
    /// self². Needs no gcd.
    pub fn square(&self) -> Rat {
        raw(&self.num * &self.num, &self.den * &self.den)
    }
    /// self^k for k ≥ 0. Needs no gcd.
    pub fn pow(&self, k: u32) -> Rat {
        raw(self.num.pow(k), self.den.pow(k))
    }
    /// Largest integer ≤ self.
    pub fn floor(&self) -> Int {
        if self.is_integer() {
            self.num.clone()
        } else {
            self.num.div_rem_floor(&self.den).0
        }
    }
    /// Smallest integer ≥ self.
    pub fn ceil(&self) -> Int {
        if self.is_integer() {
            self.num.clone()
        } else {
            self.num.div_rem_floor(&self.den).0 + Int::one()
        }
    }
    /// (a+b)/2.
    pub fn midpoint(a: &Rat, b: &Rat) -> Rat {
        (a + b) * raw(Int::one(), Int::from(2i64))
    }
    /// A dyadic rational k/2^j strictly between a < b with the least j ≥ 0, and the k least in size among
    /// those. Linear in the bits of b − a.
    ///
    /// # Panics
    /// Unless a < b.
    pub fn short_between(a: &Rat, b: &Rat) -> Rat {
        assert!(a < b, "no number lies between {a} and {b}");
        if a.sign() < 0 && b.sign() > 0 {
            return Rat::zero();
        }
        // The least j lies near −log2(b − a): start where a grid point cannot be sure to be missed.
        let width = b - a;
        let guess = width.den.bits() as i64 - width.num.bits() as i64 - 2;
        let mut j = guess.max(0) as u64;
        let fits = |j: u64| {
            let k = raw_floor_shifted(a, j) + Int::one();
            (Rat::dyadic(k.clone(), -(j as i64)) < *b).then_some(k)
        };
        // A grid of step < b − a always hits; a coarser one may, by luck: the coarsest is found by
        // ever longer steps down, and by halving the last one (finer grids hold the points of coarser ones).
        while fits(j).is_none() {
            j += 1;
        }
        let (mut misses, mut step) = (None, 1);
        while misses.is_none() && j > 0 {
            let down = j.saturating_sub(step);
            if fits(down).is_some() {
                (j, step) = (down, 2 * step);
            } else {
                misses = Some(down);
            }
        }
        while let Some(m) = misses.filter(|m| j - m > 1) {
            let middle = m.midpoint(j);
            if fits(middle).is_some() {
                j = middle;
            } else {
                misses = Some(middle);
            }
        }
        let first = fits(j).expect("the loops above end at a grid that hits");
        // Of the hits on this grid the one nearest zero.
        let last = {
            let c = raw_ceil_shifted(b, j) - Int::one();
            if c < first { first.clone() } else { c }
        };
        let k = if first.sign() > 0 {
            first
        } else if last.sign() < 0 {
            last
        } else {
            Int::zero()
        };
        Rat::dyadic(k, -(j as i64))
    }
    /// [`short_between`](Self::short_between) of two finite doubles, mostly in doubles: scaling by powers of two
    /// is exact.
    ///
    /// # Panics
    /// Unless x < y, both finite.
    pub(crate) fn short_between_doubles(x: f64, y: f64) -> Rat {
        const EXACT: f64 = (1u64 << 52) as f64;
        if x < 0.0 && y > 0.0 {
            return Rat::zero();
        }
        let negative = x < 0.0;
        let (a, b) = if negative { (-y, -x) } else { (x, y) };
        // The step of the grid is at first less than the width, which the difference shows to within a factor of two.
        let width = (b - a).to_bits() >> 52;
        let mut j = (1023 - width as i64 + 2).max(0);
        if !(0.0 <= a && a < b && b < EXACT) || width == 0 || j > 1000 {
            return Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
        }
        // floor(a·2^j) + 1, where doubles hold it and it lies below b·2^j.
        let fits = |j: i64| {
            let s = pow2(j as i32);
            let k = (a * s).floor() + 1.0;
            (k < b * s).then_some(k)
        };
        if b * pow2(j as i32) >= EXACT {
            return Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
        }
        let Some(mut k) = fits(j) else {
            return Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
        };
        while j > 0
            && let Some(coarser) = fits(j - 1)
        {
            (j, k) = (j - 1, coarser);
        }
        let k = if negative { -k } else { k };
        Rat::dyadic(Int::from(k as i64), -j)
    }
    /// The exact value of a finite double.
    ///
    /// # Panics
    /// On NaN and infinities.
    pub fn from_f64(x: f64) -> Rat {
        let (m, e) = decompose(x);
        Rat::dyadic(Int::from(m), e)
    }
    /// Nearest double, ties to even; None past the double range. Never −0.
    pub fn nearest_f64(&self) -> Option<f64> {
        if let Some((q, r)) = self.quotient() {
            // IEEE division of exactly representable operands is correctly rounded.
            let _ = r;
            return Some(q + 0.0);
        }
        if self.is_zero() {
            return Some(0.0);
        }
        let (q, sticky, e) = self.leading();
        let x = Rounded::new(q, sticky, e).nearest()?;
        Some(if self.sign() < 0 { -x + 0.0 } else { x })
    }
    /// Tightest double enclosure (a point where exact); the whole line where the filter is off.
    #[inline]
    pub fn interval(&self) -> Interval {
        if filter::on() {
            self.tight()
        } else {
            Interval::all()
        }
    }
    /// The bits of the longer part.
    pub(crate) fn bits(&self) -> u64 {
        self.num.bits().max(self.den.bits())
    }
    /// Tightest double enclosure.
    pub(crate) fn tight(&self) -> Interval {
        if let Some((q, r)) = self.quotient() {
            return match r.partial_cmp(&0.0) {
                Some(Ordering::Greater) => Interval {
                    lo: q,
                    hi: q.next_up(),
                },
                Some(Ordering::Less) => Interval {
                    lo: q.next_down(),
                    hi: q,
                },
                _ => Interval::point(q + 0.0),
            };
        }
        if self.is_zero() {
            return Interval::point(0.0);
        }
        let (q, sticky, e) = self.leading();
        signed(self.sign(), Rounded::new(q, sticky, e).enclosure())
    }
    /// For parts below 2^53: the nearest double q, and a double with the sign of self − q.
    #[inline]
    fn quotient(&self) -> Option<(f64, f64)> {
        const LIMIT: u64 = 1 << 53;
        let (n, d) = (self.num.to_i64()?, self.den.to_i64()?);
        if n.unsigned_abs() >= LIMIT || d.unsigned_abs() >= LIMIT {
            return None;
        }
        let (n, d) = (n as f64, d as f64);
        let q = n / d;
        // n − q·d without rounding: the product in two parts (Dekker, Veltkamp); no part can overflow or
        // underflow at these sizes, and n − p is exact since p is near n (Sterbenz).
        let (qh, ql) = split(q);
        let (dh, dl) = split(d);
        let p = q * d;
        let e = ql * dl - (((p - qh * dh) - ql * dh) - qh * dl);
        Some((q, (n - p) - e))
    }
    /// |self| = (q + fraction)·2^e, q of 63 or 64 bits; whether the fraction is not zero. Not for zero.
    fn leading(&self) -> (u64, bool, i64) {
        if self.is_integer() {
            let (q, s, sticky) = self.num.top64();
            return (q, sticky, s as i64);
        }
        let s = 63 - (self.num.bits() as i64 - self.den.bits() as i64);
        let n = self.num.abs();
        let (n, d) = if s >= 0 {
            (n.shl(s as u64), self.den.clone())
        } else {
            (n, self.den.shl(s.unsigned_abs()))
        };
        let (q, r) = n.div_rem_floor(&d);
        let (top, shift, _) = q.top64();
        debug_assert!(shift == 0);
        (top, !r.is_zero(), -s)
    }
    #[inline]
    fn plus(&self, o: &Rat) -> Rat {
        if let (Some((a, b)), Some((c, d))) = (words(&self.num, &self.den), words(&o.num, &o.den)) {
            return sum_words(a, b, c, d);
        }
        self.plus_big(o, false)
    }
    #[inline]
    fn minus(&self, o: &Rat) -> Rat {
        if let (Some((a, b)), Some((c, d))) = (words(&self.num, &self.den), words(&o.num, &o.den)) {
            return sum_words(a, b, -c, d);
        }
        self.plus_big(o, true)
    }
    fn plus_big(&self, o: &Rat, subtract: bool) -> Rat {
        let join = |x: Int, y: Int| if subtract { x - y } else { x + y };
        let g = self.den.gcd(&o.den);
        if g.is_one() {
            return raw(
                join(&self.num * &o.den, &o.num * &self.den),
                &self.den * &o.den,
            );
        }
        let (b, d) = (self.den.div_exact(&g), o.den.div_exact(&g));
        let t = join(&self.num * &d, &o.num * &b);
        // Only a divisor of g can be common to the numerator and the denominator.
        let h = t.gcd(&g);
        if h.is_one() {
            return raw(t, b * &o.den);
        }
        raw(t.div_exact(&h), b * o.den.div_exact(&h))
    }
    #[inline]
    fn times(&self, o: &Rat) -> Rat {
        if let (Some((a, b)), Some((c, d))) = (words(&self.num, &self.den), words(&o.num, &o.den)) {
            return product_words(a, b, c, d);
        }
        let reduce = |n: &Int, d: &Int| {
            let g = n.gcd(d);
            if g.is_one() {
                (n.clone(), d.clone())
            } else {
                (n.div_exact(&g), d.div_exact(&g))
            }
        };
        let (a, d) = reduce(&self.num, &o.den);
        let (c, b) = reduce(&o.num, &self.den);
        raw(a * c, b * d)
    }
    fn over(&self, o: &Rat) -> Rat {
        assert!(!o.is_zero(), "division by zero");
        self.times(&o.recip())
    }
    #[inline]
    fn negated(&self) -> Rat {
        raw(-&self.num, self.den.clone())
    }
}

#[cfg(test)]
mod between_tests {
    use super::*;

    #[test]
    fn doubles_find_the_same_short_numbers() {
        let mut seed = 9u64;
        let mut next = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            seed >> 11
        };
        let mut ends = vec![
            0.0, 1.0, 0.5, -0.5, 1e300, 5e-324, -1e-310, 3.0, 4.0, 0.1, 0.25,
        ];
        for i in 0..60 {
            let x = next() as f64 * 2f64.powi(-(next() as i32 % 80));
            ends.extend([x, -x, x.next_up(), x + 2f64.powi(-i), x.round()]);
        }
        for &x in &ends {
            for &y in ends.iter().filter(|y| x < **y) {
                let slow = Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
                assert_eq!(Rat::short_between_doubles(x, y), slow, "{x:?} {y:?}");
            }
        }
    }
}

/// floor(a·2^j).
fn raw_floor_shifted(a: &Rat, j: u64) -> Int {
    match a.den.log2() {
        Some(k) if k <= j => a.num.shl(j - k),
        Some(k) => a.num.shr(k - j),
        None => a.num.shl(j).div_rem_floor(&a.den).0,
    }
}
/// ceil(a·2^j).
fn raw_ceil_shifted(a: &Rat, j: u64) -> Int {
    -raw_floor_shifted(&-a, j)
}

/// a/b + c/d with |a|, b, |c|, d < 2^62, both in lowest terms.
fn sum_words(a: i64, b: i64, c: i64, d: i64) -> Rat {
    if b == 1 && d == 1 {
        return raw(Int::from(a + c), Int::one());
    }
    let g = if b == d {
        b as u64
    } else {
        gcd_u64(b as u64, d as u64)
    };
    if g == 1 {
        return raw(
            Int::from(a as i128 * d as i128 + c as i128 * b as i128),
            Int::from(b as i128 * d as i128),
        );
    }
    let (b, e) = (b / g as i64, d / g as i64);
    let t = a as i128 * e as i128 + c as i128 * b as i128;
    let rest = if t as i64 as i128 == t {
        (t as i64).unsigned_abs() % g
    } else {
        (t.unsigned_abs() % g as u128) as u64
    };
    let h = gcd_u64(rest, g);
    if h == 1 {
        return raw(Int::from(t), Int::from(b as i128 * d as i128));
    }
    let t = if t as i64 as i128 == t {
        (t as i64 / h as i64) as i128
    } else {
        t / h as i128
    };
    raw(Int::from(t), Int::from(b as i128 * (d / h as i64) as i128))
}

/// a/b · c/d with |a|, b, |c|, d < 2^62, both in lowest terms.
#[inline]
fn product_words(a: i64, b: i64, c: i64, d: i64) -> Rat {
    if b == 1 && d == 1 {
        return raw(Int::from(a as i128 * c as i128), Int::one());
    }
    let g = gcd_u64(a.unsigned_abs(), d as u64) as i64;
    let h = gcd_u64(c.unsigned_abs(), b as u64) as i64;
    let (a, d) = if g == 1 { (a, d) } else { (a / g, d / g) };
    let (c, b) = if h == 1 { (c, b) } else { (c / h, b / h) };
    raw(
        Int::from(a as i128 * c as i128),
        Int::from(b as i128 * d as i128),
    )
}

/// Veltkamp's split into two halves of 26 bits.
#[inline]
fn split(x: f64) -> (f64, f64) {
    let t = 134_217_729.0 * x;
    let h = t - (t - x);
    (h, x - h)
}

/// x = m·2^e exactly.
///
/// # Panics
/// On NaN and infinities.
pub(crate) fn decompose(x: f64) -> (i64, i64) {
    assert!(x.is_finite(), "{x} is no rational number");
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i64;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (m, e) = if exponent == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, exponent - 1075)
    };
    (if x < 0.0 { -m } else { m }, e)
}

/// A positive real number between two neighbouring doubles, `m`·2^`u` and (`m`+1)·2^`u`.
struct Rounded {
    m: u64,
    u: i64,
    exact: bool,
    /// Whether the nearest one, ties to even, is the upper.
    up: bool,
}

impl Rounded {
    /// From (q + fraction)·2^e with q > 0; `sticky` tells whether the fraction is not zero.
    fn new(q: u64, sticky: bool, e: i64) -> Rounded {
        let msb = 63 - q.leading_zeros() as i64 + e;
        let u = (msb - 52).max(-1074);
        let drop = u - e;
        if drop > 64 {
            // Below half of the least subnormal double.
            return Rounded {
                m: 0,
                u,
                exact: false,
                up: false,
            };
        }
        if drop <= 0 {
            // Fewer bits than a double holds; the fraction then lies wholly below the last one.
            debug_assert!(!sticky || drop == 0);
            return Rounded {
                m: q << -drop,
                u,
                exact: !sticky,
                up: false,
            };
        }
        let wide = q as u128;
        let (low, half) = (wide & ((1 << drop) - 1), 1u128 << (drop - 1));
        let m = (wide >> drop) as u64;
        Rounded {
            m,
            u,
            exact: low == 0 && !sticky,
            up: low > half || low == half && (sticky || m & 1 == 1),
        }
    }
    fn value(&self, m: u64) -> f64 {
        if self.u > 971 || self.u == 971 && m >> 53 != 0 {
            f64::INFINITY
        } else {
            m as f64 * pow2(self.u as i32)
        }
    }
    fn nearest(&self) -> Option<f64> {
        let x = self.value(self.m + self.up as u64);
        x.is_finite().then_some(x)
    }
    fn enclosure(&self) -> Interval {
        let lo = self.value(self.m).min(f64::MAX);
        if self.exact && self.u <= 971 {
            Interval::point(lo)
        } else {
            Interval {
                lo,
                hi: self.value(self.m + 1),
            }
        }
    }
}

fn signed(sign: i32, x: Interval) -> Interval {
    if sign < 0 { -x } else { x }
}

impl Int {
    /// Tightest double enclosure (a point where exact); the whole line where the filter is off.
    #[inline]
    pub fn interval(&self) -> Interval {
        if !filter::on() {
            return Interval::all();
        }
        if let Some(v) = self.to_i64()
            && v.unsigned_abs() >> 53 == 0
        {
            return Interval::point(v as f64);
        }
        self.interval_shifted(0)
    }
    /// Tightest double enclosure of self·2^k.
    pub(crate) fn interval_shifted(&self, k: i64) -> Interval {
        if self.is_zero() {
            return Interval::point(0.0);
        }
        let (q, shift, sticky) = self.top64();
        signed(
            self.sign(),
            Rounded::new(q, sticky, shift as i64 + k).enclosure(),
        )
    }
}

impl Default for Rat {
    fn default() -> Rat {
        Rat::zero()
    }
}
impl PartialOrd for Rat {
    fn partial_cmp(&self, o: &Rat) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Rat {
    fn cmp(&self, o: &Rat) -> Ordering {
        let by_sign = self.sign().cmp(&o.sign());
        if by_sign != Ordering::Equal {
            return by_sign;
        }
        if self.den == o.den {
            return self.num.cmp(&o.num);
        }
        if let (Some(a), Some(b), Some(c), Some(d)) = (
            self.num.to_i64(),
            self.den.to_i64(),
            o.num.to_i64(),
            o.den.to_i64(),
        ) {
            return (a as i128 * d as i128).cmp(&(c as i128 * b as i128));
        }
        // |n|/d lies in (2^(k−1), 2^(k+1)) for k the difference of the bit counts.
        let k = |r: &Rat| r.num.bits() as i64 - r.den.bits() as i64;
        let (ka, kb) = (k(self), k(o));
        if (ka - kb).abs() >= 2 {
            return if (ka < kb) == (self.sign() > 0) {
                Ordering::Less
            } else {
                Ordering::Greater
            };
        }
        (&self.num * &o.den).cmp(&(&o.num * &self.den))
    }
}
impl From<Int> for Rat {
    #[inline]
    fn from(v: Int) -> Rat {
        raw(v, Int::one())
    }
}
impl From<i64> for Rat {
    #[inline]
    fn from(v: i64) -> Rat {
        raw(Int::from(v), Int::one())
    }
}
impl From<BigRational> for Rat {
    fn from(v: BigRational) -> Rat {
        let (n, d) = v.into_raw();
        // Raw construction may leave a ratio unreduced.
        Rat::new(Int::from(n), Int::from(d))
    }
}
impl From<Rat> for BigRational {
    fn from(v: Rat) -> BigRational {
        BigRational::new_raw(v.num.into(), v.den.into())
    }
}
impl std::str::FromStr for Rat {
    type Err = String;
    /// Reads the grammar of [`super::literal`].
    fn from_str(s: &str) -> Result<Rat, String> {
        super::literal::parse(s).map_err(|e| e.to_string())
    }
}
/// `n` or `n/d`.
impl fmt::Display for Rat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_integer() {
            write!(f, "{}", self.num)
        } else {
            write!(f, "{}/{}", self.num, self.den)
        }
    }
}
impl fmt::Debug for Rat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
ops!(Rat);
impl Div<&Rat> for &Rat {
    type Output = Rat;
    fn div(self, o: &Rat) -> Rat {
        self.over(o)
    }
}
impl Div<Rat> for Rat {
    type Output = Rat;
    fn div(self, o: Rat) -> Rat {
        self.over(&o)
    }
}
impl Div<&Rat> for Rat {
    type Output = Rat;
    fn div(self, o: &Rat) -> Rat {
        self.over(o)
    }
}
impl Div<Rat> for &Rat {
    type Output = Rat;
    fn div(self, o: Rat) -> Rat {
        self.over(&o)
    }
}
