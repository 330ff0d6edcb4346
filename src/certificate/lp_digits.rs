//! Solutions of integer systems by their digits, with the proof that they are solutions.
//!
//! For the check of a basis certificate: G·X = b is lifted modulo Qᴷ, digit by digit. With a
//! denominator D on offer, the residues N of D·X nearest to zero are the solution N/D if they are
//! so small that G·N = D·b cannot wrap round modulo Qᴷ, which their leading digits show. What is
//! asked about the solution afterwards, signs and zeros, comes from the same digits.

use super::lp::Rejection;
use crate::number::{Int, Rat};

/// Bits of a digit, rounded down.
const DIGIT: u64 = 30;
/// Components of a solution that are worked on together.
const BLOCK: usize = 64;

/// Why a check came to nothing.
pub(super) enum Trouble {
    /// A pivot vanished modulo this prime.
    Unlucky,
    No(Rejection),
}

pub(super) fn no<T>(why: &str) -> Result<T, Trouble> {
    Err(Trouble::No(Rejection(why.to_string())))
}

/// The entries of a row or column, by index.
pub(super) type Line = Vec<(u32, Int)>;

/// Integers N with N/D the solution, by digits of N/D modulo Qᴷ and leading parts of N.
pub(super) struct Digits {
    digits: Vec<Vec<u32>>,
    denominator: Int,
    denominator_digits: Vec<u64>,
    /// N/Q^low, off by at most `error` downwards.
    leading: Vec<Int>,
    low: usize,
    error: Int,
    /// ⌊D/Q^low⌋.
    high: Int,
}

fn base<const Q: u64>(v: &Int) -> Vec<u64> {
    let q = Int::from(Q);
    let mut rest = v.abs();
    let mut out = Vec::new();
    while !rest.is_zero() {
        let (a, r) = rest.div_rem_floor(&q);
        out.push(r.to_i64().unwrap_or(0) as u64);
        rest = a;
    }
    out
}

/// Σ vₜ Qᵗ.
fn join<const Q: u64>(parts: &[Int]) -> Int {
    if parts.len() <= 16 {
        let q = Int::from(Q);
        return parts
            .iter()
            .rev()
            .fold(Int::zero(), |s, v| &s * &q + v.clone());
    }
    let (low, high) = parts.split_at(parts.len() / 2);
    join::<Q>(low) + join::<Q>(high) * Int::from(Q).pow(low.len() as u32)
}

fn centred(v: &Int, modulus: &Int) -> Int {
    let r = v.div_rem_floor(modulus).1;
    if r.shl(1) > *modulus { r - modulus } else { r }
}

/// Lines of integers in two's complement, each in as many words as all residues need.
struct Wide {
    limbs: usize,
    start: Vec<usize>,
    index: Vec<u32>,
    words: Vec<u64>,
}

impl Wide {
    fn new(lines: &[Line]) -> Wide {
        let sum = |l: &Line| l.iter().fold(Int::zero(), |s, (_, a)| s + a.abs()).bits();
        let norm = lines.iter().map(sum).max().unwrap_or(0);
        // A residue is below the line's sum; with a digit's multiple subtracted, 32 bits longer.
        let limbs = (norm as usize + 36).div_ceil(64);
        let mut wide = Wide {
            limbs,
            start: vec![0],
            index: Vec::new(),
            words: Vec::new(),
        };
        let modulus = Int::one().shl(64 * limbs as u64);
        for line in lines {
            for (j, a) in line {
                wide.index.push(*j);
                let mut rest = a.div_rem_floor(&modulus).1;
                for _ in 0..limbs {
                    wide.words
                        .push(rest.mod_u64(1 << 32) | rest.shr(32).mod_u64(1 << 32) << 32);
                    rest = rest.shr(64);
                }
            }
            wide.start.push(wide.index.len());
        }
        wide
    }

    /// r −= Σ a·x over line i.
    fn subtract(&self, r: &mut [u64], i: usize, x: &[u64]) {
        for e in self.start[i]..self.start[i + 1] {
            let x = x[self.index[e] as usize];
            let words = &self.words[e * self.limbs..(e + 1) * self.limbs];
            let (mut carry, mut borrow) = (0u64, false);
            for (t, &a) in r.iter_mut().zip(words) {
                let product = u128::from(a) * u128::from(x) + u128::from(carry);
                carry = (product >> 64) as u64;
                let (s, first) = t.overflowing_sub(product as u64);
                let (s, second) = s.overflowing_sub(u64::from(borrow));
                (*t, borrow) = (s, first | second);
            }
        }
    }
}

/// r += v.
fn add_signed(r: &mut [u64], v: i64) {
    let fill = (v >> 63) as u64;
    let mut carry = false;
    for (k, t) in r.iter_mut().enumerate() {
        let (s, first) = t.overflowing_add(if k == 0 { v as u64 } else { fill });
        let (s, second) = s.overflowing_add(u64::from(carry));
        (*t, carry) = (s, first | second);
    }
}

/// r modulo Q, of two's complement.
fn remainder<const Q: u64>(r: &[u64]) -> u64 {
    let Some((&top, rest)) = r.split_last() else {
        return 0;
    };
    let base = ((1u128 << 64) % u128::from(Q)) as u64;
    let mut v = (top as i64).rem_euclid(Q as i64) as u64;
    for &w in rest.iter().rev() {
        v = (v * base + w % Q) % Q;
    }
    v
}

/// r /= Q, of two's complement, for a multiple of Q.
fn divide<const Q: u64>(r: &mut [u64]) {
    let mut inverse = Q; // Newton: right bits 3, 6, 12, 24, 48, 96
    for _ in 0..5 {
        inverse = inverse.wrapping_mul(2u64.wrapping_sub(Q.wrapping_mul(inverse)));
    }
    let mut borrow = 0u64;
    for w in r {
        let (t, under) = w.overflowing_sub(borrow);
        *w = t.wrapping_mul(inverse);
        borrow = ((u128::from(*w) * u128::from(Q)) >> 64) as u64 + u64::from(under);
    }
}

/// The digits of D·X from a place on, carries not yet taken.
struct Window {
    denominator: Vec<u64>,
    low: usize,
    sums: Vec<Vec<u128>>,
}

/// What lies below a window can carry into it at most this.
fn error<const Q: u64>(low: usize) -> Int {
    Int::from(Q) * Int::from(low as u64)
}

impl Window {
    /// Widens to all digits there are.
    fn extend(&mut self, digits: &[Vec<u32>]) {
        let size = digits.first().map_or(0, Vec::len);
        let done = self.low + self.sums.len();
        self.sums.resize(digits.len() - self.low, vec![0; size]);
        // Block by block, so that the digits of a block stay in the cache.
        for start in (0..size).step_by(BLOCK) {
            let block = start..(start + BLOCK).min(size);
            for top in done..digits.len() {
                let sum = &mut self.sums[top - self.low][block.clone()];
                let x = |at: usize| &digits[at][block.clone()];
                // Four products of two digits fit a word.
                let take = self.denominator.len().min(top + 1);
                for (group, d) in self.denominator[..take].chunks(4).enumerate() {
                    let at = top - 4 * group;
                    if let [a, b, c, e] = *d {
                        let (w, x, y, z) = (x(at), x(at - 1), x(at - 2), x(at - 3));
                        for (j, s) in sum.iter_mut().enumerate() {
                            let first = a * u64::from(w[j]) + b * u64::from(x[j]);
                            let second = c * u64::from(y[j]) + e * u64::from(z[j]);
                            *s += u128::from(first + second);
                        }
                    } else {
                        for (i, &d) in d.iter().enumerate() {
                            for (s, &x) in sum.iter_mut().zip(x(at - i)) {
                                *s += u128::from(d * u64::from(x));
                            }
                        }
                    }
                }
            }
        }
    }

    /// The leading digits of D·X modulo Qᴷ, if they show every |N| small enough.
    fn leading<const Q: u64>(&self, norm: u64) -> Option<Vec<Int>> {
        let modulus = Int::from(Q).pow(self.sums.len() as u32);
        let limit = modulus.bits().checked_sub(norm + 6)?;
        let error = error::<Q>(self.low).bits();
        let size = self.sums.first().map_or(0, Vec::len);
        let mut leading = Vec::with_capacity(size);
        for j in 0..size {
            let parts: Vec<Int> = self.sums.iter().map(|s| Int::from(s[j] as i128)).collect();
            let v = centred(&join::<Q>(&parts), &modulus);
            if v.bits().max(error) + 1 > limit {
                return None;
            }
            leading.push(v);
        }
        Some(leading)
    }
}

impl Digits {
    /// Lifts G·X = b until the residues of D·X prove themselves.
    pub(super) fn lift<const Q: u64>(
        solve: impl Fn(&mut [u64]),
        lines: &[Line],
        rhs: Vec<Int>,
        d: &Int,
        norm: u64,
    ) -> Result<Digits, Trouble> {
        let size = lines.len();
        let rhs_bits = rhs.iter().map(Int::bits).max().unwrap_or(0);
        // Room for Σ|a|·|N| and D·|constant| in every question asked.
        let room = 2 * norm.max(rhs_bits) + 40;
        let precision = 8 + d.bits() / (DIGIT * 32);
        let mut count = ((d.bits() + room) / DIGIT + 2) as usize;
        let signs: Vec<i64> = rhs.iter().map(|b| i64::from(b.sign())).collect();
        let feed: Vec<Vec<u64>> = rhs.iter().map(base::<Q>).collect();
        let wide = Wide::new(lines);
        let limbs = wide.limbs;
        let mut residue = vec![0u64; size * limbs];
        let mut digits: Vec<Vec<u32>> = Vec::new();
        let mut work = vec![0u64; size];
        let width = (room / DIGIT + precision) as usize + 3;
        let mut window = Window {
            denominator: base::<Q>(d),
            low: count.saturating_sub(width),
            sums: Vec::new(),
        };
        for attempt in 0.. {
            while digits.len() < count {
                let k = digits.len();
                for (i, r) in residue.chunks_exact_mut(limbs).enumerate() {
                    if let Some(&f) = feed[i].get(k) {
                        add_signed(r, signs[i] * f as i64);
                    }
                    work[i] = remainder::<Q>(r);
                }
                solve(&mut work);
                for (i, r) in residue.chunks_exact_mut(limbs).enumerate() {
                    wide.subtract(r, i, &work);
                    divide::<Q>(r);
                }
                digits.push(work.iter().map(|&v| v as u32).collect());
            }
            window.extend(&digits);
            if let Some(leading) = window.leading::<Q>(norm.max(rhs_bits)) {
                let low = window.low;
                let top = window.denominator.get(low..).unwrap_or(&[]);
                let top: Vec<Int> = top.iter().map(|&v| Int::from(v)).collect();
                return Ok(Digits {
                    high: join::<Q>(&top),
                    digits,
                    denominator: d.clone(),
                    denominator_digits: window.denominator,
                    leading,
                    low,
                    error: if low == 0 {
                        Int::zero()
                    } else {
                        error::<Q>(low)
                    },
                });
            }
            if attempt == 6 {
                return no("a denominator is wrong");
            }
            count += 4 << attempt;
        }
        no("a denominator is wrong")
    }

    /// The sign of Σ a·X − c.
    pub(super) fn sign<const Q: u64>(&self, terms: &[(u32, Int)], constant: &Int) -> i32 {
        if terms.is_empty() {
            return -constant.sign();
        }
        let mut sum = Int::zero();
        let mut spread = Int::zero();
        for (k, a) in terms {
            sum += &(&self.leading[*k as usize] * a);
            spread += &a.abs();
        }
        let mut off = spread * self.error.clone();
        if !constant.is_zero() {
            sum -= &(&self.high * constant);
            if self.low > 0 {
                off += &constant.abs();
            }
        }
        if sum.abs() > off {
            return sum.sign();
        }
        // Σ a·X − c modulo Qᴷ, digit by digit.
        let sign = i64::from(constant.sign());
        let feed = base::<Q>(constant);
        let q = Int::from(Q);
        let mut carry = Int::zero();
        let mut zero = true;
        let mut residue = Vec::with_capacity(self.digits.len());
        for (k, x) in self.digits.iter().enumerate() {
            if let Some(&f) = feed.get(k) {
                carry -= &Int::from(sign * f as i64);
            }
            for (j, a) in terms {
                carry += &(a * &Int::from(i64::from(x[*j as usize])));
            }
            let (rest, r) = carry.div_rem_floor(&q);
            let r = r.to_i64().unwrap_or(0) as u64;
            zero &= r == 0;
            residue.push(r);
            carry = rest;
        }
        if zero {
            return 0;
        }
        // Leading digits of D times that, more and more of them.
        let count = residue.len();
        let mut width = (count - self.low) * 2;
        loop {
            let low = count.saturating_sub(width);
            let parts: Vec<Int> = (low..count)
                .map(|t| {
                    let pairs = self.denominator_digits.iter().enumerate().take(t + 1);
                    let sum: u128 = pairs.map(|(i, &d)| u128::from(d * residue[t - i])).sum();
                    Int::from(sum as i128)
                })
                .collect();
            let v = centred(&join::<Q>(&parts), &Int::from(Q).pow((count - low) as u32));
            if low == 0 || v.bits() > 31 + 64 {
                return v.sign();
            }
            width *= 2;
        }
    }

    /// Σ a·X exactly.
    pub(super) fn value<const Q: u64>(&self, terms: &[(u32, Int)]) -> Rat {
        let parts: Vec<Int> = self
            .digits
            .iter()
            .map(|x| {
                terms.iter().fold(Int::zero(), |s, (k, a)| {
                    s + a * &Int::from(i64::from(x[*k as usize]))
                })
            })
            .collect();
        let modulus = Int::from(Q).pow(self.digits.len() as u32);
        let n = centred(&(join::<Q>(&parts) * self.denominator.clone()), &modulus);
        Rat::new(n, self.denominator.clone())
    }
}
