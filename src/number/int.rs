//! `Int`: integers of any size behind one seam.
//!
//! The idea: almost every integer of a real scene fits a machine word, and the few that do not must
//! cost no more than a big-number library asks. So an `Int` is an `i128` held inline, and only what
//! does not fit lives on the heap. The form is canonical (a value that fits is always inline), which
//! makes equality and hashing a plain comparison of representations. The heap is
//! [`Long`]'s, the only file that names a big-number library; all else goes through the methods here.

use super::long::Long;
use super::ops::ops;
use super::words::{gcd_u64, gcd_u128};
use num_bigint::BigInt;
use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// An integer of any size; no allocation while it fits an `i128`.
///
/// # Example
/// ```
/// use snapfit::number::Int;
/// let big = Int::from(10i64).pow(40);
/// assert_eq!(big.to_string(), format!("1{}", "0".repeat(40)));
/// assert_eq!(big.div_exact(&Int::from(10i64).pow(39)), Int::from(10i64));
/// ```
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Int(Repr);

/// Invariant: `Big` holds only values outside the range of `i128`.
#[derive(Clone, PartialEq, Eq, Hash)]
enum Repr {
    Small(i128),
    Big(Long),
}
use Repr::{Big, Small};

/// Restores the canonical form.
fn canonical(b: Long) -> Int {
    if b.bits() <= 128
        && let Some(v) = b.to_i128()
    {
        return Int(Small(v));
    }
    Int(Big(b))
}

/// Whether a value fits an `i64`: decides between one multiplication instruction and several.
#[inline]
fn narrow(v: i128) -> bool {
    v as i64 as i128 == v
}

/// The squares modulo m < 128, a bit each.
const fn squares(m: u64) -> u128 {
    let (mut set, mut x) = (0, 0);
    while x < m {
        set |= 1 << (x * x % m);
        x += 1;
    }
    set
}

impl Int {
    /// Zero.
    #[inline]
    pub fn zero() -> Int {
        Int(Small(0))
    }
    /// One.
    #[inline]
    pub fn one() -> Int {
        Int(Small(1))
    }
    /// -1, 0 or 1.
    #[inline]
    pub fn sign(&self) -> i32 {
        match &self.0 {
            Small(v) => v.signum() as i32,
            Big(b) => b.sign(),
        }
    }
    /// Whether zero.
    #[inline]
    pub fn is_zero(&self) -> bool {
        matches!(self.0, Small(0))
    }
    /// Whether one.
    #[inline]
    pub fn is_one(&self) -> bool {
        matches!(self.0, Small(1))
    }
    /// Whether divisible by two.
    pub fn is_even(&self) -> bool {
        match &self.0 {
            Small(v) => v & 1 == 0,
            Big(b) => b.is_even(),
        }
    }
    /// Absolute value.
    pub fn abs(&self) -> Int {
        if self.sign() < 0 {
            self.negated()
        } else {
            self.clone()
        }
    }
    /// Greatest common divisor, non-negative; gcd(0, 0) = 0. Quadratic in the number of words.
    pub fn gcd(&self, other: &Int) -> Int {
        match (&self.0, &other.0) {
            (Small(a), Small(b)) => {
                let (a, b) = (a.unsigned_abs(), b.unsigned_abs());
                if a == 1 || b == 1 {
                    return Int::one();
                }
                if (a | b) >> 64 == 0 {
                    return Int(Small(gcd_u64(a as u64, b as u64) as i128));
                }
                Int::from_u128(gcd_u128(a, b))
            }
            (Small(a), Big(b)) | (Big(b), Small(a)) => {
                if *a == 0 {
                    return Int(Big(b.clone())).abs();
                }
                let a = a.unsigned_abs();
                if a == 1 {
                    return Int::one();
                }
                Int::from_u128(gcd_u128(a, b.rem(a)))
            }
            (Big(a), Big(b)) => {
                // Doubles and dyadic gaps have powers of two for denominators.
                let power = |v: &Long, zeros: u64| v.sign() > 0 && v.bits() == zeros + 1;
                let zeros = |v: &Long| v.trailing_zeros().unwrap_or(0);
                let (s, t) = (zeros(a), zeros(b));
                if power(a, s) || power(b, t) {
                    return Int::one().shl(s.min(t));
                }
                canonical(a.gcd(b))
            }
        }
    }
    /// k where self is 2^k.
    pub(super) fn log2(&self) -> Option<u64> {
        let z = self.trailing_zeros()?;
        (self.sign() > 0 && self.bits() == z + 1).then_some(z)
    }
    /// From an unsigned 128-bit value.
    pub(crate) fn from_u128(v: u128) -> Int {
        match i128::try_from(v) {
            Ok(v) => Int(Small(v)),
            Err(_) => Int(Big(Long::of_unsigned(v))),
        }
    }
    /// From the words of the absolute value, least significant first.
    pub(crate) fn from_words(minus: bool, words: &[u64]) -> Int {
        let n = words.iter().rposition(|&w| w != 0).map_or(0, |i| i + 1);
        let at = |i: usize| words.get(i).copied().unwrap_or(0);
        if n <= 2 && at(1) >> 63 == 0 {
            let v = (i128::from(at(1)) << 64) | i128::from(at(0));
            return Int(Small(if minus { -v } else { v }));
        }
        canonical(Long::of_words(minus, &words[..n]))
    }
    /// Least common multiple of positive integers; where one divides the other, as denominators mostly
    /// do, a division tells.
    pub(crate) fn lcm(&self, other: &Int) -> Int {
        match (&self.0, &other.0) {
            (_, Small(1)) => self.clone(),
            (Small(1), _) => other.clone(),
            (Small(a), Small(b)) if narrow(*a) && narrow(*b) => {
                let (a, b) = (a.unsigned_abs() as u64, b.unsigned_abs() as u64);
                if b != 0 && a % b == 0 {
                    return Int(Small(a.into()));
                }
                let g = gcd_u64(a, b).max(1);
                Int::from_u128(u128::from(a) * u128::from(b / g))
            }
            _ if self == other => self.clone(),
            _ => self * &other.div_exact(&self.gcd(other)),
        }
    }
    /// Exact quotient; the caller knows that `d` divides `self` (the result means nothing otherwise).
    ///
    /// # Panics
    /// If `d` is zero.
    pub fn div_exact(&self, d: &Int) -> Int {
        assert!(!d.is_zero(), "division by zero");
        match (&self.0, &d.0) {
            (_, Small(1)) => self.clone(),
            (Small(a), Small(b)) => {
                if narrow(*a) && narrow(*b) {
                    return Int(Small(match (*a as i64).checked_div(*b as i64) {
                        Some(q) => q as i128,
                        None => -*a,
                    }));
                }
                match a.checked_div(*b) {
                    Some(q) => Int(Small(q)),
                    None => self.negated(),
                }
            }
            (Big(a), Small(b)) => match d.log2() {
                Some(k) => canonical(a.shr(k)),
                None => canonical(a.div_small(*b)),
            },
            (Small(a), Big(b)) => canonical(Long::of(*a).div_exact(b)),
            (Big(a), Big(b)) => match d.log2() {
                Some(k) => canonical(a.shr(k)),
                None => canonical(a.div_exact(b)),
            },
        }
    }
    /// Floor division: `self = q·d + r` with 0 ≤ r < d for d > 0 (and d < r ≤ 0 for d < 0).
    ///
    /// # Panics
    /// If `d` is zero.
    pub fn div_rem_floor(&self, d: &Int) -> (Int, Int) {
        assert!(!d.is_zero(), "division by zero");
        match (&self.0, &d.0) {
            (Small(a), Small(b)) if *a != i128::MIN => {
                let (q, r) = if narrow(*a) && narrow(*b) && *a != i64::MIN as i128 {
                    let (a, b) = (*a as i64, *b as i64);
                    ((a / b) as i128, (a % b) as i128)
                } else {
                    (a / b, a % b)
                };
                if r != 0 && (r < 0) != (*b < 0) {
                    (Int(Small(q - 1)), Int(Small(r + b)))
                } else {
                    (Int(Small(q)), Int(Small(r)))
                }
            }
            _ => {
                if let Some(k) = d.log2() {
                    let q = self.shr(k);
                    let r = self - q.shl(k);
                    return (q, r);
                }
                if let (Big(a), Big(b)) = (&self.0, &d.0) {
                    let (q, r) = a.div_mod_floor(b);
                    return (canonical(q), canonical(r));
                }
                let (q, r) = self.to_big().div_mod_floor(&d.to_big());
                (canonical(q), canonical(r))
            }
        }
    }
    /// Bits of |self|; 0 for zero.
    #[inline]
    pub fn bits(&self) -> u64 {
        match &self.0 {
            Small(v) => (128 - v.unsigned_abs().leading_zeros()) as u64,
            Big(b) => b.bits(),
        }
    }
    /// The number of times two divides |self|; None for zero.
    pub fn trailing_zeros(&self) -> Option<u64> {
        match &self.0 {
            Small(0) => None,
            Small(v) => Some(v.trailing_zeros() as u64),
            Big(b) => b.trailing_zeros(),
        }
    }
    /// self * 2^k.
    pub fn shl(&self, k: u64) -> Int {
        match &self.0 {
            Small(0) => Int::zero(),
            _ if k == 0 => self.clone(),
            Small(v) if k < v.unsigned_abs().leading_zeros() as u64 => Int(Small(v << k)),
            Small(v) => canonical(Long::of(*v).shl(k)),
            Big(b) => Int(Big(b.shl(k))),
        }
    }
    /// floor(self / 2^k).
    pub fn shr(&self, k: u64) -> Int {
        match &self.0 {
            Small(v) => Int(Small(v >> k.min(127))),
            Big(b) => canonical(b.shr(k)),
        }
    }
    /// self^k.
    pub fn pow(&self, k: u32) -> Int {
        if let Small(v) = self.0
            && let Some(r) = v.checked_pow(k)
        {
            return Int(Small(r));
        }
        canonical(self.to_big().pow(k))
    }
    /// floor(√self); None for negative numbers.
    pub fn sqrt(&self) -> Option<Int> {
        match &self.0 {
            Small(v) if *v < 0 => None,
            Small(v) => Some(Int(Small(if *v >> 64 == 0 {
                (*v as u64).isqrt() as i128
            } else {
                v.isqrt()
            }))),
            Big(b) if b.sign() < 0 => None,
            Big(b) => Some(canonical(b.sqrt())),
        }
    }
    /// √self where self is a perfect square.
    pub fn sqrt_exact(&self) -> Option<Int> {
        // Squares are 0, 1, 4, 9, 16, 17, 25, 33, 36, 41, 49, 57 modulo 64: most others stop here.
        const SQUARES: u64 = 0x0202_0212_0203_0213;
        if self.sign() < 0 {
            return None;
        }
        let low = match &self.0 {
            Small(v) => (v & 63) as u64,
            Big(b) => b.low_word() & 63,
        };
        if SQUARES >> low & 1 == 0 {
            return None;
        }
        if let Big(b) = &self.0 {
            // Modulo 63, 65, 11 and 17 squares are so few that hardly another number passes.
            const MODULI: [u64; 4] = [63, 65, 11, 17];
            const SQUARES: [u128; 4] = [squares(63), squares(65), squares(11), squares(17)];
            let r = b.rem(63 * 65 * 11 * 17) as u64;
            if (0..4).any(|i| SQUARES[i] >> (r % MODULI[i]) & 1 == 0) {
                return None;
            }
        }
        let r = self.sqrt()?;
        (&r * &r == *self).then_some(r)
    }
    /// The value as i64 where it fits.
    #[inline]
    pub fn to_i64(&self) -> Option<i64> {
        match &self.0 {
            Small(v) if narrow(*v) => Some(*v as i64),
            _ => None,
        }
    }
    /// The value as i128 where it fits.
    #[inline]
    pub fn to_i128(&self) -> Option<i128> {
        match &self.0 {
            Small(v) => Some(*v),
            Big(_) => None,
        }
    }
    /// The non-negative remainder modulo `m`.
    ///
    /// # Panics
    /// If `m` is zero.
    pub fn mod_u64(&self, m: u64) -> u64 {
        match &self.0 {
            Small(v) if narrow(*v) && m >> 63 == 0 => (*v as i64).rem_euclid(m as i64) as u64,
            Small(v) => v.rem_euclid(m as i128) as u64,
            Big(b) => {
                let r = b.rem(u128::from(m)) as u64;
                if b.sign() < 0 && r != 0 { m - r } else { r }
            }
        }
    }
    /// The words of |self|, least significant first.
    pub(crate) fn for_each_word(&self, mut f: impl FnMut(u64)) {
        match &self.0 {
            Small(v) => {
                let v = v.unsigned_abs();
                f(v as u64);
                f((v >> 64) as u64);
            }
            Big(b) => b.for_each_word(f),
        }
    }
    /// |self| = (top + fraction)·2^shift with 0 ≤ fraction < 1, `top` of at most 64 bits and the
    /// flag telling whether the fraction is not zero.
    pub(crate) fn top64(&self) -> (u64, u64, bool) {
        match &self.0 {
            Small(v) => {
                let a = v.unsigned_abs();
                let shift = 64u32.saturating_sub(a.leading_zeros());
                let top = a >> shift;
                (top as u64, shift as u64, top << shift != a)
            }
            Big(b) => {
                let (h, l) = b.top_words();
                let s = h.leading_zeros();
                let two = (((h as u128) << 64 | l as u128) << s >> 64) as u64;
                let shift = b.bits() - 64;
                (two, shift, b.trailing_zeros().unwrap_or(0) < shift)
            }
        }
    }
    fn to_big(&self) -> Long {
        match &self.0 {
            Small(v) => Long::of(*v),
            Big(b) => b.clone(),
        }
    }
    #[inline]
    fn plus(&self, o: &Int) -> Int {
        match (&self.0, &o.0) {
            (Small(a), Small(b)) => match a.checked_add(*b) {
                Some(v) => Int(Small(v)),
                None => Int(Big(Long::of(*a).plus_small(*b))),
            },
            (Big(a), Small(b)) | (Small(b), Big(a)) => canonical(a.plus_small(*b)),
            (Big(a), Big(b)) => canonical(a.plus(b)),
        }
    }
    #[inline]
    fn minus(&self, o: &Int) -> Int {
        match (&self.0, &o.0) {
            (Small(a), Small(b)) => match a.checked_sub(*b) {
                Some(v) => Int(Small(v)),
                None => Int(Big(Long::of(*a).minus(&Long::of(*b)))),
            },
            (Big(a), Small(b)) => canonical(a.minus(&Long::of(*b))),
            (Small(a), Big(b)) => canonical(b.negated().plus_small(*a)),
            (Big(a), Big(b)) => canonical(a.minus(b)),
        }
    }
    #[inline]
    fn times(&self, o: &Int) -> Int {
        match (&self.0, &o.0) {
            (Small(a), Small(b)) => {
                if narrow(*a) && narrow(*b) {
                    return Int(Small(*a as i64 as i128 * *b as i64 as i128));
                }
                match a.checked_mul(*b) {
                    Some(v) => Int(Small(v)),
                    None => canonical(Long::of(*a).times_small(*b)),
                }
            }
            (Big(a), Small(b)) | (Small(b), Big(a)) => {
                if *b == 0 {
                    Int::zero()
                } else {
                    canonical(a.times_small(*b))
                }
            }
            (Big(a), Big(b)) => Int(Big(a.times(b))),
        }
    }
    #[inline]
    fn negated(&self) -> Int {
        match &self.0 {
            Small(v) => match v.checked_neg() {
                Some(v) => Int(Small(v)),
                None => Int(Big(Long::of(*v).negated())),
            },
            Big(b) => canonical(b.negated()),
        }
    }
}

impl Default for Int {
    fn default() -> Int {
        Int::zero()
    }
}
impl PartialOrd for Int {
    fn partial_cmp(&self, o: &Int) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Int {
    fn cmp(&self, o: &Int) -> Ordering {
        match (&self.0, &o.0) {
            (Small(a), Small(b)) => a.cmp(b),
            (Big(a), Big(b)) => a.cmp(b),
            // A big value lies outside the range of every small one.
            (Big(a), Small(_)) => a.sign().cmp(&0),
            (Small(_), Big(b)) => 0.cmp(&b.sign()),
        }
    }
}
impl fmt::Debug for Int {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
impl fmt::Display for Int {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Small(v) => fmt::Display::fmt(v, f),
            Big(b) => fmt::Display::fmt(b, f),
        }
    }
}
impl From<i32> for Int {
    fn from(v: i32) -> Int {
        Int(Small(v as i128))
    }
}
impl From<i64> for Int {
    #[inline]
    fn from(v: i64) -> Int {
        Int(Small(v as i128))
    }
}
impl From<i128> for Int {
    #[inline]
    fn from(v: i128) -> Int {
        Int(Small(v))
    }
}
impl From<u64> for Int {
    #[inline]
    fn from(v: u64) -> Int {
        Int(Small(v as i128))
    }
}
impl From<BigInt> for Int {
    fn from(v: BigInt) -> Int {
        canonical(Long::from_num(v))
    }
}
impl From<Int> for BigInt {
    fn from(v: Int) -> BigInt {
        match v.0 {
            Small(v) => BigInt::from(v),
            Big(b) => b.into_num(),
        }
    }
}
impl std::str::FromStr for Int {
    type Err = String;
    /// Reads `[+-]digits`; nothing else (no spaces, no underscores).
    fn from_str(s: &str) -> Result<Int, String> {
        let digits = s.strip_prefix(['+', '-']).unwrap_or(s);
        if digits.is_empty() || !digits.bytes().all(|c| c.is_ascii_digit()) {
            return Err(format!("not an integer: {s:?}"));
        }
        if s.len() <= 38 {
            return s
                .parse::<i128>()
                .map(|v| Int(Small(v)))
                .map_err(|e| e.to_string());
        }
        let v = Long::parse(digits).ok_or_else(|| format!("not an integer: {s:?}"))?;
        Ok(canonical(if s.starts_with('-') { v.negated() } else { v }))
    }
}

ops!(Int);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_stays_two_registers_and_a_tag() {
        assert!(
            std::mem::size_of::<Int>() <= 48,
            "{}",
            std::mem::size_of::<Int>()
        );
    }

    /// Against a·b/gcd, for words, their border and integers past it.
    #[test]
    fn common_multiples() {
        let big = Int::one().shl(130);
        let small = [1i64, 2, 3, 10, 12, 1 << 40, i64::MAX].map(Int::from);
        let all: Vec<Int> = small
            .iter()
            .flat_map(|v| [v.clone(), v * &big, v.shl(63)])
            .collect();
        for a in &all {
            for b in &all {
                let slow = (a * b).div_exact(&a.gcd(b));
                assert_eq!(a.lcm(b), slow, "{a} and {b}");
            }
        }
    }

    #[test]
    fn canonical_at_the_border() {
        let max = Int::from(i128::MAX);
        let over = &max + &Int::one();
        assert_eq!(over.to_i128(), None);
        assert_eq!(&over - &Int::one(), max);
        assert_eq!(-&over, Int::from(i128::MIN));
        assert_eq!(-&Int::from(i128::MIN), over);
        assert_eq!(Int::from(i128::MIN).abs(), over);
        assert_eq!(Int::from(i128::MIN).div_exact(&Int::from(-1i64)), over);
        assert_eq!(
            Int::from(i128::MIN).div_rem_floor(&Int::from(-1i64)),
            (over.clone(), Int::zero())
        );
        assert_eq!(
            Int::from(i64::MIN).div_exact(&Int::from(-1i64)),
            -Int::from(i64::MIN)
        );
        assert_eq!(
            Int::from(i64::MIN).div_rem_floor(&Int::from(-1i64)).0,
            -Int::from(i64::MIN)
        );
        assert_eq!(Int::from(i128::MIN).bits(), 128);
        assert_eq!(Int::one().shl(127), over);
        assert_eq!((-Int::one()).shl(127), Int::from(i128::MIN));
        assert_eq!((-Int::one()).shl(200).shr(201), -Int::one());
        assert_eq!(
            (-(Int::one().shl(200) + Int::one())).shr(200),
            Int::from(-2i64)
        );
        assert!(Int::from(i128::MIN) < max && max < over && -&over.shl(1) < Int::from(i128::MIN));
    }

    #[test]
    fn gcds_of_all_sizes() {
        let g = Int::from(600_851_475_143i64);
        for k in [1u32, 3, 8, 20] {
            let (a, b) = (
                &g.pow(k) * &Int::from(7i64).pow(90),
                &g.pow(k) * &Int::from(-5i64).pow(81),
            );
            assert_eq!(a.gcd(&b), g.pow(k), "{k}");
        }
        assert_eq!(Int::zero().gcd(&Int::from(i128::MIN)), Int::one().shl(127));
        assert_eq!(Int::one().shl(300).gcd(&Int::from(96i64)), Int::from(32i64));
        assert_eq!(Int::zero().gcd(&Int::zero()), Int::zero());
    }

    #[test]
    fn squares() {
        for v in 0i64..5000 {
            let r = Int::from(v).sqrt_exact();
            assert_eq!(r.is_some(), (v as f64).sqrt().fract() == 0.0, "{v}");
        }
        let big = Int::from(12345i64).pow(30);
        assert_eq!((&big * &big).sqrt_exact(), Some(big.clone()));
        assert_eq!((&big * &big + Int::one()).sqrt_exact(), None);
        assert_eq!(Int::from(-4i64).sqrt(), None);
    }

    #[test]
    fn reading_is_strict() {
        for bad in ["", "+", "-", "1_0", " 1", "1 ", "0x1", "+-1", "--1", "1.0"] {
            assert!(bad.parse::<Int>().is_err(), "{bad:?}");
        }
        let nines = "9".repeat(60);
        assert_eq!(
            format!("-{nines}").parse::<Int>().map(|v| v.to_string()),
            Ok(format!("-{nines}"))
        );
        assert_eq!("+07".parse::<Int>(), Ok(Int::from(7i64)));
    }
}
