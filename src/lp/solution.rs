//! Proven solutions of integer systems and what can be asked about them: signs, sizes, zeros.
//!
//! A window of the top digits of D·xⱼ modulo M = p^K proves |Nⱼ| small (see the module `lift`) and
//! encloses it; the digits below settle what the window leaves open.

use super::digits::{compose, digits_of, from_u128, ldexp, mantissa, nearest};
use super::field::Prime;
use crate::number::Int;

/// Components of a solution that are worked on together.
const BLOCK: usize = 64;

/// The digits of D·xⱼ from a place on, carries not yet taken.
pub(super) struct Window {
    denominator: Vec<u64>,
    /// Digits below.
    pub(super) low: usize,
    /// By digit, then component.
    sums: Vec<Vec<u128>>,
    /// What overflowed from the sums, where there can be such.
    carries: Vec<Vec<u32>>,
}

impl Window {
    pub(super) fn new(p: &Int, d: &Int, low: usize) -> Window {
        Window {
            denominator: digits_of(d, p).into_iter().map(|v| v as u64).collect(),
            low,
            sums: Vec::new(),
            carries: Vec::new(),
        }
    }

    /// Widens to a number of digits.
    pub(super) fn extend(&mut self, digits: &[Vec<u64>], width: usize) {
        let n = digits.first().map_or(0, Vec::len);
        let long = self.denominator.len() > 8000;
        let done = self.sums.len();
        for _ in done..width {
            self.sums.push(vec![0; n]);
            if long {
                self.carries.push(vec![0; n]);
            }
        }
        // Block by block, so that the digits of a block stay in the cache.
        for start in (0..n).step_by(BLOCK) {
            let block = start..(start + BLOCK).min(n);
            for t in done..width {
                let top = self.low + t;
                let sum = &mut self.sums[t][block.clone()];
                for (i, &d) in self.denominator.iter().enumerate().take(top + 1) {
                    let x = &digits[top - i][block.clone()];
                    if long {
                        let carry = &mut self.carries[t][block.clone()];
                        for ((s, &x), c) in sum.iter_mut().zip(x).zip(carry) {
                            let (v, over) = s.overflowing_add(u128::from(d) * u128::from(x));
                            *s = v;
                            *c += u32::from(over);
                        }
                    } else {
                        for (s, &x) in sum.iter_mut().zip(x) {
                            *s += u128::from(d) * u128::from(x);
                        }
                    }
                }
            }
        }
    }

    /// The solution, if the window proves |Nⱼ| small enough; its digits are still to be given.
    /// The error names a component for which it does not.
    pub(super) fn proves(&mut self, p: &Int, d: &Int, norm: u64) -> Result<Solution, usize> {
        let (width, low) = (self.sums.len(), self.low);
        let size = p.pow(width as u32);
        // Below the window lie at most low·(p−1)² at each digit: a carry of at most low·p.
        let error = p * &Int::from(low as u64);
        let limit = size.bits().saturating_sub(norm + 6);
        let n = self.sums.first().map_or(0, Vec::len);
        let mut window = Vec::with_capacity(n);
        for j in 0..n {
            let mut v = Int::zero();
            for t in (0..width).rev() {
                v = &v * p + from_u128(self.sums[t][j]);
                if let Some(c) = self.carries.get(t) {
                    v += &Int::from(u64::from(c[j])).shl(128);
                }
            }
            let v = nearest(&v, &size);
            if v.bits().max(error.bits()) + 1 > limit {
                return Err(j);
            }
            window.push(v);
        }
        let below = p.pow(low as u32);
        let denominator_high = d.div_rem_floor(&below).0;
        let ((a, e), (b, f)) = (mantissa(&below), mantissa(d));
        Ok(Solution {
            prime: p.to_i64().unwrap_or(0) as u64,
            p: p.clone(),
            digits: Vec::new(),
            denominator: d.clone(),
            denominator_digits: std::mem::take(&mut self.denominator),
            low,
            window,
            error,
            denominator_high,
            unit: (a / b, e - f),
            norm,
        })
    }
}

/// A proven solution N/D, by digits and windows.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    p: Int,
    prime: u64,
    /// By digit, then component; as many as the proof took.
    pub(super) digits: Vec<Vec<u64>>,
    /// D > 0.
    pub(crate) denominator: Int,
    denominator_digits: Vec<u64>,
    /// Digits below the window.
    low: usize,
    /// ⌊Nⱼ/p^low⌋ less at most `error`.
    window: Vec<Int>,
    error: Int,
    /// ⌊D/p^low⌋.
    denominator_high: Int,
    /// p^low/D as a double and an exponent: D/p^low itself may be less than one.
    unit: (f64, i64),
    /// Bits of any Σ|a| or constant that the tests below may be asked about.
    norm: u64,
}

impl Solution {
    /// The solution of an empty system.
    pub(crate) fn empty() -> Solution {
        let p = Prime::nth(0).p;
        Solution {
            p: Int::from(p),
            prime: p,
            digits: Vec::new(),
            denominator: Int::one(),
            denominator_digits: vec![1],
            low: 0,
            window: Vec::new(),
            error: Int::zero(),
            denominator_high: Int::one(),
            unit: (1.0, 0),
            norm: 0,
        }
    }

    /// Σ a·x − c times D over p^low, and how far that may be off (upwards or downwards).
    fn estimate(&self, terms: &[(u32, Int)], constant: &Int) -> (Int, Int) {
        let mut sum = Int::zero();
        let mut slack = Int::zero();
        for (j, a) in terms {
            sum += &(&self.window[*j as usize] * a);
            slack += &a.abs();
        }
        if self.low == 0 {
            return (sum - &self.denominator * constant, Int::zero());
        }
        if !constant.is_zero() {
            sum -= &(&self.denominator_high * constant);
        }
        (
            sum,
            slack * (&self.error + &Int::one()) + constant.abs() + Int::one(),
        )
    }

    /// Bounds on |Σ a·x − c|, in a unit common to all questions to this solution.
    pub(crate) fn size(&self, terms: &[(u32, Int)], constant: &Int) -> (Int, Int) {
        let (value, off) = self.estimate(terms, constant);
        let size = value.abs();
        let low = &size - &off;
        let low = if low.sign() < 0 { Int::zero() } else { low };
        (low, size + off)
    }

    /// The sign of Σ a·x − c.
    pub(crate) fn sign(&self, terms: &[(u32, Int)], constant: &Int) -> i32 {
        if terms.is_empty() {
            return -constant.sign();
        }
        let (value, off) = self.estimate(terms, constant);
        if value.abs() > off || self.low == 0 {
            return value.sign();
        }
        if self.is_zero(terms, constant) {
            return 0;
        }
        self.sign_by_wider_windows(terms, constant)
    }

    /// The sign of a non-zero Σ a·x − c that is too small for the stored windows: the digits of
    /// that one number, and windows of its product with D that reach down until they tell.
    fn sign_by_wider_windows(&self, terms: &[(u32, Int)], constant: &Int) -> i32 {
        let count = self.digits.len();
        let d = &self.denominator_digits;
        if d.len() > 8000 {
            return self.numerator(terms, constant).sign();
        }
        let constants = digits_of(constant, &self.p);
        let mut carry = Int::zero();
        let mut digits = Vec::with_capacity(count);
        for (k, x) in self.digits.iter().enumerate() {
            carry -= &Int::from(constants.get(k).copied().unwrap_or(0));
            for (j, a) in terms {
                carry += &(a * &Int::from(x[*j as usize]));
            }
            let (q, r) = carry.div_rem_floor(&self.p);
            digits.push(r.to_i64().unwrap_or(0) as u64);
            carry = q;
        }
        let mut width = 2 * (count - self.low);
        loop {
            let low = count.saturating_sub(width);
            let sums: Vec<Int> = (low..count)
                .map(|t| {
                    let pairs = d.iter().enumerate().take(t + 1);
                    let products = pairs.map(|(i, &d)| u128::from(d) * u128::from(digits[t - i]));
                    from_u128(products.sum())
                })
                .collect();
            let v = nearest(&compose(&sums, &self.p), &self.p.pow((count - low) as u32));
            if low == 0 || v.bits() > 57 + 64 {
                return v.sign();
            }
            width *= 2;
        }
    }

    /// Whether Σ a·x = c: the residue modulo pᴷ is zero, digit by digit.
    fn is_zero(&self, terms: &[(u32, Int)], constant: &Int) -> bool {
        let small: Option<Vec<(u32, i64)>> = terms
            .iter()
            .map(|(j, a)| a.to_i64().map(|a| (*j, a)))
            .collect();
        let constants = digits_of(constant, &self.p);
        if let (Some(terms), true) = (small, self.norm < 62) {
            let p = i128::from(self.prime);
            let mut carry = 0i128;
            for (k, x) in self.digits.iter().enumerate() {
                carry -= i128::from(constants.get(k).copied().unwrap_or(0));
                for &(j, a) in &terms {
                    carry += i128::from(a) * i128::from(x[j as usize]);
                }
                if carry % p != 0 {
                    return false;
                }
                carry /= p;
            }
            return true;
        }
        let mut carry = Int::zero();
        for (k, x) in self.digits.iter().enumerate() {
            carry -= &Int::from(constants.get(k).copied().unwrap_or(0));
            for (j, a) in terms {
                carry += &(a * &Int::from(x[*j as usize]));
            }
            let (q, r) = carry.div_rem_floor(&self.p);
            if !r.is_zero() {
                return false;
            }
            carry = q;
        }
        true
    }

    /// D·(Σ a·x − c), an integer, in full.
    pub(crate) fn numerator(&self, terms: &[(u32, Int)], constant: &Int) -> Int {
        if self.low == 0 {
            return self.estimate(terms, constant).0;
        }
        let parts: Vec<Int> = self
            .digits
            .iter()
            .map(|x| {
                terms
                    .iter()
                    .fold(Int::zero(), |s, (j, a)| s + a * &Int::from(x[*j as usize]))
            })
            .collect();
        let modulus = self.p.pow(self.digits.len() as u32);
        let u = compose(&parts, &self.p) - constant.clone();
        nearest(&(&u * &self.denominator), &modulus)
    }

    /// Σ a·x − c as a double, for proposals.
    pub(crate) fn approximate(&self, terms: &[(u32, Int)], constant: &Int) -> f64 {
        let (value, e) = self.scaled(terms, constant);
        ldexp(value, e)
    }

    /// The same as a double and an exponent of two, which may lie past the double range.
    pub(crate) fn scaled(&self, terms: &[(u32, Int)], constant: &Int) -> (f64, i64) {
        let (value, _) = self.estimate(terms, constant);
        let value = if value.is_zero() || self.low == 0 {
            value
        } else {
            value.shl(64)
        };
        let (v, e) = mantissa(&value);
        let (unit, f) = self.unit;
        let shift = if self.low == 0 { 0 } else { 64 };
        (v * unit, e + f - shift)
    }
}
