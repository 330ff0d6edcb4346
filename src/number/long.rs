//! `Long`: what an integer becomes when it outgrows a machine word.
//!
//! The only file that names a big-number library. Without the feature `rug` a `Long` is a
//! num-bigint and nothing else, and every `match` here is none. With it, new numbers are made
//! with the library that [`backend`] names; the two mix, at the price of a copy.

#[cfg(feature = "rug")]
use super::backend::{Backend, backend};
use super::words::gcd_u128;
use num_bigint::{BigInt, BigUint, Sign};
use num_integer::Integer as _;
use num_traits::ToPrimitive;
use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

/// An integer in a big-number library.
#[derive(Clone)]
pub(super) enum Long {
    Num(BigInt),
    #[cfg(feature = "rug")]
    Gmp(rug::Integer),
}
#[cfg(feature = "rug")]
use Long::Gmp;
use Long::Num;

/// Applies an operation to two operands in the library of the first.
macro_rules! both {
    ($a:expr, $b:expr, $num:expr, $gmp:expr) => {
        match ($a, $b) {
            (Num(a), Num(b)) => {
                let f: fn(&BigInt, &BigInt) -> _ = $num;
                f(a, b)
            }
            #[cfg(feature = "rug")]
            (Gmp(a), Gmp(b)) => {
                let f: fn(&rug::Integer, &rug::Integer) -> _ = $gmp;
                f(a, b)
            }
            #[cfg(feature = "rug")]
            (Gmp(a), b) => {
                let f: fn(&rug::Integer, &rug::Integer) -> _ = $gmp;
                f(a, &b.to_gmp())
            }
            #[cfg(feature = "rug")]
            (a, Gmp(b)) => {
                let f: fn(&rug::Integer, &rug::Integer) -> _ = $gmp;
                f(&a.to_gmp(), b)
            }
        }
    };
}
macro_rules! one {
    ($a:expr, $num:expr, $gmp:expr) => {
        match $a {
            Num(a) => $num(a),
            #[cfg(feature = "rug")]
            Gmp(a) => $gmp(a),
        }
    };
}

impl Long {
    pub(super) fn of(v: i128) -> Long {
        #[cfg(feature = "rug")]
        if backend() == Backend::Rug {
            return Gmp(rug::Integer::from(v));
        }
        Num(BigInt::from(v))
    }
    pub(super) fn of_unsigned(v: u128) -> Long {
        #[cfg(feature = "rug")]
        if backend() == Backend::Rug {
            return Gmp(rug::Integer::from(v));
        }
        Num(BigInt::from(v))
    }
    /// From the words of the absolute value, least significant first.
    pub(super) fn of_words(minus: bool, words: &[u64]) -> Long {
        #[cfg(feature = "rug")]
        if backend() == Backend::Rug {
            let v = rug::Integer::from_digits(words, rug::integer::Order::Lsf);
            return Gmp(if minus { -v } else { v });
        }
        let sign = if minus { Sign::Minus } else { Sign::Plus };
        Num(BigInt::from_biguint(sign, from_limbs(words)))
    }
    /// A decimal number without a sign.
    pub(super) fn parse(digits: &str) -> Option<Long> {
        #[cfg(feature = "rug")]
        if backend() == Backend::Rug {
            return rug::Integer::from_str_radix(digits, 10).ok().map(Gmp);
        }
        BigUint::parse_bytes(digits.as_bytes(), 10).map(|v| Num(BigInt::from(v)))
    }
    #[cfg(feature = "rug")]
    fn to_gmp(&self) -> rug::Integer {
        match self {
            Gmp(a) => a.clone(),
            Num(a) => {
                let words: Vec<u64> = a.iter_u64_digits().collect();
                let v = rug::Integer::from_digits(&words, rug::integer::Order::Lsf);
                if a.sign() == Sign::Minus { -v } else { v }
            }
        }
    }
    pub(super) fn to_i128(&self) -> Option<i128> {
        one!(self, |a: &BigInt| a.to_i128(), |a: &rug::Integer| a
            .to_i128())
    }
    pub(super) fn sign(&self) -> i32 {
        one!(
            self,
            |a: &BigInt| match a.sign() {
                Sign::Minus => -1,
                Sign::NoSign => 0,
                Sign::Plus => 1,
            },
            |a: &rug::Integer| a.cmp0() as i32
        )
    }
    pub(super) fn is_even(&self) -> bool {
        one!(self, |a: &BigInt| !a.bit(0), |a: &rug::Integer| a.is_even())
    }
    pub(super) fn bits(&self) -> u64 {
        one!(self, |a: &BigInt| a.bits(), |a: &rug::Integer| u64::from(
            a.significant_bits()
        ))
    }
    pub(super) fn trailing_zeros(&self) -> Option<u64> {
        one!(self, |a: &BigInt| a.trailing_zeros(), |a: &rug::Integer| a
            .find_one(0)
            .map(u64::from))
    }
    /// The words of the absolute value, least significant first.
    pub(super) fn words(&self) -> Vec<u64> {
        one!(
            self,
            |a: &BigInt| a.iter_u64_digits().collect(),
            |a: &rug::Integer| a.to_digits(rug::integer::Order::Lsf)
        )
    }
    /// The same without a list.
    pub(super) fn for_each_word(&self, #[allow(unused_mut)] mut f: impl FnMut(u64)) {
        match self {
            Num(a) => a.iter_u64_digits().for_each(f),
            #[cfg(feature = "rug")]
            Gmp(a) => {
                for w in a.as_limbs() {
                    f(*w as u64);
                }
            }
        }
    }
    /// The lowest word of the absolute value.
    pub(super) fn low_word(&self) -> u64 {
        one!(
            self,
            |a: &BigInt| a.iter_u64_digits().next().unwrap_or(0),
            |a: &rug::Integer| a.as_abs().to_u64_wrapping()
        )
    }
    /// The two highest words of the absolute value, the highest first.
    pub(super) fn top_words(&self) -> (u64, u64) {
        one!(
            self,
            |a: &BigInt| {
                let mut w = a.iter_u64_digits().rev();
                (w.next().unwrap_or(0), w.next().unwrap_or(0))
            },
            |a: &rug::Integer| {
                let w: Vec<u64> = a.to_digits(rug::integer::Order::Msf);
                (
                    w.first().copied().unwrap_or(0),
                    w.get(1).copied().unwrap_or(0),
                )
            }
        )
    }
    pub(super) fn plus(&self, o: &Long) -> Long {
        both!(self, o, |a, b| Num(a + b), |a, b| Gmp(rug::Integer::from(
            a + b
        )))
    }
    pub(super) fn minus(&self, o: &Long) -> Long {
        both!(self, o, |a, b| Num(a - b), |a, b| Gmp(rug::Integer::from(
            a - b
        )))
    }
    pub(super) fn times(&self, o: &Long) -> Long {
        both!(self, o, |a, b| Num(a * b), |a, b| Gmp(rug::Integer::from(
            a * b
        )))
    }
    pub(super) fn plus_small(&self, v: i128) -> Long {
        one!(self, |a: &BigInt| Num(a + v), |a: &rug::Integer| Gmp(
            rug::Integer::from(a + v)
        ))
    }
    pub(super) fn times_small(&self, v: i128) -> Long {
        one!(
            self,
            |a: &BigInt| Num(match i64::try_from(v) {
                Ok(v) => a * v,
                Err(_) => a * v,
            }),
            |a: &rug::Integer| Gmp(rug::Integer::from(a * v))
        )
    }
    pub(super) fn negated(&self) -> Long {
        one!(self, |a: &BigInt| Num(-a), |a: &rug::Integer| Gmp(
            rug::Integer::from(-a)
        ))
    }
    /// Quotient where the divisor divides.
    pub(super) fn div_exact(&self, o: &Long) -> Long {
        both!(self, o, |a, b| Num(a / b), |a, b| Gmp(rug::Integer::from(
            a.div_exact_ref(b)
        )))
    }
    pub(super) fn div_small(&self, v: i128) -> Long {
        one!(
            self,
            |a: &BigInt| Num(match i64::try_from(v) {
                Ok(v) => a / v,
                Err(_) => a / v,
            }),
            |a: &rug::Integer| Gmp(rug::Integer::from(a / v))
        )
    }
    pub(super) fn div_mod_floor(&self, o: &Long) -> (Long, Long) {
        both!(
            self,
            o,
            |a, b| {
                let (q, r) = a.div_mod_floor(b);
                (Num(q), Num(r))
            },
            |a, b| {
                let (q, r) = <(rug::Integer, rug::Integer)>::from(a.div_rem_floor_ref(b));
                (Gmp(q), Gmp(r))
            }
        )
    }
    /// |self| mod m.
    pub(super) fn rem(&self, m: u128) -> u128 {
        let r = one!(
            self,
            |a: &BigInt| match u64::try_from(m) {
                Ok(m) => (a.magnitude() % m).to_u128(),
                Err(_) => (a.magnitude() % m).to_u128(),
            },
            |a: &rug::Integer| rug::Integer::from(&*a.as_abs() % m).to_u128()
        );
        // Less than m, which is a u128.
        r.expect("a remainder is less than the divisor")
    }
    pub(super) fn gcd(&self, o: &Long) -> Long {
        both!(
            self,
            o,
            |a, b| Num(BigInt::from(gcd_limbs(
                a.iter_u64_digits().collect(),
                b.iter_u64_digits().collect()
            ))),
            |a, b| Gmp(rug::Integer::from(a.gcd_ref(b)))
        )
    }
    pub(super) fn shl(&self, k: u64) -> Long {
        one!(self, |a: &BigInt| Num(a << k), |a: &rug::Integer| Gmp(
            rug::Integer::from(a << k as usize)
        ))
    }
    /// Rounded down.
    pub(super) fn shr(&self, k: u64) -> Long {
        one!(self, |a: &BigInt| Num(a >> k), |a: &rug::Integer| Gmp(
            rug::Integer::from(a >> k as usize)
        ))
    }
    pub(super) fn pow(&self, k: u32) -> Long {
        one!(self, |a: &BigInt| Num(a.pow(k)), |a: &rug::Integer| Gmp(
            rug::Integer::from(rug::ops::Pow::pow(a, k))
        ))
    }
    pub(super) fn sqrt(&self) -> Long {
        one!(self, |a: &BigInt| Num(a.sqrt()), |a: &rug::Integer| Gmp(
            rug::Integer::from(a.sqrt_ref())
        ))
    }
    pub(super) fn from_num(v: BigInt) -> Long {
        Num(v)
    }
    pub(super) fn into_num(self) -> BigInt {
        match self {
            Num(a) => a,
            #[cfg(feature = "rug")]
            Gmp(a) => {
                let sign = if a.cmp0().is_lt() {
                    Sign::Minus
                } else {
                    Sign::Plus
                };
                let words: Vec<u64> = a.to_digits(rug::integer::Order::Lsf);
                BigInt::from_biguint(sign, from_limbs(&words))
            }
        }
    }
}

impl PartialEq for Long {
    fn eq(&self, o: &Long) -> bool {
        both!(self, o, |a, b| a == b, |a, b| a == b)
    }
}
impl Eq for Long {}
impl PartialOrd for Long {
    fn partial_cmp(&self, o: &Long) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Long {
    fn cmp(&self, o: &Long) -> Ordering {
        both!(self, o, |a, b| a.cmp(b), |a, b| a.cmp(b))
    }
}
/// By sign and words: the same for both libraries.
impl Hash for Long {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.sign().hash(state);
        self.words().hash(state);
    }
}
impl fmt::Display for Long {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        one!(
            self,
            |a: &BigInt| fmt::Display::fmt(a, f),
            |a: &rug::Integer| { fmt::Display::fmt(a, f) }
        )
    }
}

fn from_limbs(l: &[u64]) -> BigUint {
    let mut digits = Vec::with_capacity(2 * l.len());
    for &d in l {
        digits.push(d as u32);
        digits.push((d >> 32) as u32);
    }
    BigUint::new(digits)
}

fn trim(l: &mut Vec<u64>) {
    while l.last() == Some(&0) {
        l.pop();
    }
}

/// Whether a < b, both trimmed.
fn limbs_less(a: &[u64], b: &[u64]) -> bool {
    a.len()
        .cmp(&b.len())
        .then_with(|| a.iter().rev().cmp(b.iter().rev()))
        == Ordering::Less
}

/// Lehmer's gcd (Knuth, TAOCP 2, algorithm 4.5.2 L): Euclid's quotients are found on the leading 62
/// bits and applied to the whole numbers some thirty bits at a time.
fn gcd_limbs(mut a: Vec<u64>, mut b: Vec<u64>) -> BigUint {
    trim(&mut a);
    trim(&mut b);
    if limbs_less(&a, &b) {
        std::mem::swap(&mut a, &mut b);
    }
    loop {
        if b.is_empty() {
            return from_limbs(&a);
        }
        if a.len() <= 2 {
            let word = |l: &[u64]| {
                l.iter()
                    .rev()
                    .fold(0u128, |acc, &d| (acc << 64) | d as u128)
            };
            return BigUint::from(gcd_u128(word(&a), word(&b)));
        }
        let n = a.len();
        let s = a[n - 1].leading_zeros();
        let top = |l: &[u64]| {
            let at = |i: usize| l.get(i).copied().unwrap_or(0) as u128;
            let two = (at(n - 1) << 64) | at(n - 2);
            ((two << s) >> 66) as i64
        };
        let (mut x, mut y) = (top(&a), top(&b));
        let (mut ca, mut cb, mut cc, mut cd) = (1i64, 0i64, 0i64, 1i64);
        while y + cc != 0 && y + cd != 0 {
            let q = (x + ca) / (y + cc);
            if q != (x + cb) / (y + cd) {
                break;
            }
            let t = ca - q * cc;
            ca = cc;
            cc = t;
            let t = cb - q * cd;
            cb = cd;
            cd = t;
            let t = x - q * y;
            x = y;
            y = t;
        }
        if cb == 0 {
            // The leading bits settle no quotient: one true division.
            let (ba, bb) = (from_limbs(&a), from_limbs(&b));
            let r = ba % &bb;
            a = b;
            b = r.iter_u64_digits().collect();
        } else {
            b.resize(n, 0);
            let (mut carry_a, mut carry_b) = (0i128, 0i128);
            for (pa, pb) in a.iter_mut().zip(b.iter_mut()) {
                let (va, vb) = (*pa as i128, *pb as i128);
                // |cofactor| < 2^62 and a limb < 2^64; the two products differ in sign.
                carry_a += ca as i128 * va + cb as i128 * vb;
                carry_b += cc as i128 * va + cd as i128 * vb;
                *pa = carry_a as u64;
                *pb = carry_b as u64;
                carry_a >>= 64;
                carry_b >>= 64;
            }
            debug_assert!(carry_a == 0 && carry_b == 0);
            trim(&mut a);
            trim(&mut b);
        }
    }
}
