//! `Rat`: rationals in lowest terms.
//!
//! The idea: a rational is worth its cost only while it stays short, so every operation reduces at once, with
//! the smallest gcds that do (Knuth, TAOCP 2, §4.5.1: a sum needs one gcd of the denominators and mostly no
//! other; a product needs two small ones instead of a large one). While the parts fit machine words all of
//! it happens in registers.

mod doubles;
mod short;

pub(crate) use self::doubles::decompose;
use super::Int;
use super::ops::ops;
use super::words::gcd_u64;
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
    /// m/10^k in lowest terms, for k up to 18: only 2 and 5 can be common.
    pub(crate) fn decimal(m: i64, k: u32) -> Rat {
        if m == 0 {
            return Rat::zero();
        }
        let twos = m.trailing_zeros().min(k);
        let (mut m, mut fives) = (m >> twos, 0);
        while fives < k && m % 5 == 0 {
            (m, fives) = (m / 5, fives + 1);
        }
        raw(Int::from(m), Int::from(5i64.pow(k - fives) << (k - twos)))
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
    /// The exact value of a finite double.
    ///
    /// # Panics
    /// On NaN and infinities.
    pub fn from_f64(x: f64) -> Rat {
        let (m, e) = decompose(x);
        Rat::dyadic(Int::from(m), e)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the fraction reduced by its gcd.
    #[test]
    fn decimals_are_in_lowest_terms() {
        let digits = [
            0i64,
            1,
            5,
            10,
            32,
            125,
            375,
            1 << 50,
            999_999_999_999_999_999,
        ];
        for m in digits.into_iter().flat_map(|m| [m, -m]) {
            for k in 0..=18 {
                let slow = Rat::new(Int::from(m), Int::from(10i64.pow(k)));
                let fast = Rat::decimal(m, k);
                assert_eq!((fast.numer(), fast.denom()), (slow.numer(), slow.denom()));
            }
        }
    }
}
