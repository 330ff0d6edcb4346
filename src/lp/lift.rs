//! Exact solutions of sparse integer systems by p-adic lifting, known by their signs.
//!
//! G·x = b with G non-singular modulo p is solved digit by digit (Dixon): x₀ = G⁻¹r modulo p,
//! r ← (r − G·x₀)/p, and so on. The residue stays as small as a row of G, so its exact division
//! is one multiplication modulo 2⁶⁴ a limb; b enters digit by digit too.
//!
//! **The denominator.** Euclid's algorithm on random combinations of the components gives D with
//! N = D·x integral. **The proof.** Let M = p^K. If the residues Nⱼ of D·xⱼ nearest to zero all
//! satisfy |G|·|N| + D·|b| < M, then G·N ≡ D·b (mod M) is an equality, whatever D's origin: x is
//! N/D. To see that |Nⱼ| is so small takes only the *top* digits of the product D·xⱼ mod M, a
//! window of a few base-p digits whose carry from below is bounded. The same window encloses Nⱼ
//! to 150 bits and more. So all components are known, with proof, at a few multiplications a
//! digit each: signs, not millions of digits. **Zero tests.** Σ aⱼNⱼ − D·c is an integer below M
//! in size, hence zero exactly where Σ aⱼxⱼ ≡ c modulo M; most non-zeros show in the first digit.

use super::budget::{Budget, Exhausted};
use super::field::{Double, Prime};
use super::lu::{Lu, Singular, factorise};
use super::problem::{Matrix, Problem};
use super::reconstruct::reconstruct;
use crate::number::Int;

/// Digits of precision kept below the largest component.
const PRECISION: usize = 4;
/// Random combinations whose denominators are joined.
const COMBINATIONS: usize = 6;
/// Components of a solution that are worked on together.
const BLOCK: usize = 64;
/// Factors that are added to a denominator before it is given up.
const COMPLETIONS: usize = 4;
/// Rows of a kernel below which it is not worth while to foresee the denominator's length.
const SMALL: usize = 50;

/// A square part of the program's matrix, factorised modulo a prime.
#[derive(Clone, Debug)]
pub(crate) struct Kernel {
    /// The program's rows and columns, in the order of the kernel's own numbering.
    pub(crate) rows: Vec<u32>,
    pub(crate) columns: Vec<u32>,
    by_rows: Matrix,
    by_columns: Matrix,
    field: Prime,
    lu: Lu<u64>,
    norm_bits: u64,
}

/// Which of the two systems of a kernel is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// G·x = b: b by rows, x by columns.
    Columns,
    /// Gᵀ·y = d: d by columns, y by rows.
    Rows,
}

impl Kernel {
    /// Factorises the given rows and columns. The error names local indices left over.
    pub(crate) fn new(
        problem: &Problem,
        rows: Vec<u32>,
        columns: Vec<u32>,
        prime: usize,
    ) -> Result<Kernel, Singular> {
        let field = Prime::nth(prime);
        let limbs = problem.columns.limbs;
        let mut local = vec![u32::MAX; problem.m];
        for (k, &i) in rows.iter().enumerate() {
            local[i as usize] = k as u32;
        }
        let mut by_columns = Matrix {
            start: vec![0],
            limbs,
            ..Matrix::default()
        };
        let mut residues: Vec<Vec<(u32, u64)>> = Vec::with_capacity(columns.len());
        for &j in &columns {
            let mut column = Vec::new();
            for e in problem.columns.span(j as usize) {
                let i = local[problem.columns.index[e] as usize];
                if i != u32::MAX {
                    let words = &problem.columns.words[e * limbs..(e + 1) * limbs];
                    by_columns.index.push(i);
                    by_columns.words.extend_from_slice(words);
                    column.push((i, field.enter(residue(&field, words))));
                }
            }
            by_columns.start.push(by_columns.index.len());
            residues.push(column);
        }
        let mut lu = factorise(&field, &residues, 0.0, 0.0)?;
        lu.prepare(&field);
        Ok(Kernel {
            by_rows: by_columns.transposed(rows.len()),
            by_columns,
            rows,
            columns,
            field,
            lu,
            norm_bits: problem.norm_bits,
        })
    }

    /// Rows (or columns) of the kernel.
    pub(crate) fn size(&self) -> usize {
        self.rows.len()
    }

    /// The order in which rows and columns were eliminated, local indices.
    pub(crate) fn order(&self) -> (&[u32], &[u32]) {
        (&self.lu.row_of, &self.lu.column_of)
    }

    /// Solves one of the two systems exactly. `guess` is a denominator to try first.
    pub(crate) fn solve(
        &self,
        side: Side,
        rhs: &[Int],
        guess: Option<&Int>,
        budget: &Budget,
    ) -> Result<Solution, Exhausted> {
        let mut lift = Lifting::new(self, side, rhs);
        let rhs_bits = rhs.iter().map(Int::bits).max().unwrap_or(0);
        if let Some(d) = guess {
            let extra = (self.norm_bits.max(rhs_bits) / 57) as usize;
            let digits = (d.bits() / 56) as usize + 2 * extra + PRECISION + 2;
            // Often it lacks but a small factor, which shows a little later.
            for more in [0, digits / 32 + 2, digits / 8 + 2] {
                lift.extend(digits + more, budget)?;
                if more == 0 {
                    if let Ok(s) = lift.prove(d) {
                        return Ok(s);
                    }
                } else if let Some(d) = lift.denominator(more as u64, d.clone())
                    && let Some(s) = lift.prove_or_complete(d)
                {
                    return Ok(s);
                }
            }
        }
        let target = self.expected_digits(rhs_bits);
        let mut digits = lift.digits.len().max(2);
        let mut salt = 0;
        loop {
            lift.extend(digits, budget)?;
            if let Some(d) = lift.denominator(salt, Int::one())
                && let Some(s) = lift.prove_or_complete(d)
            {
                return Ok(s);
            }
            budget.check()?;
            salt += 1;
            // Denominators far below the determinant are looked for on the way to it.
            digits += match target {
                Some(t) if digits < t && 4 * digits > 3 * t => t - digits,
                Some(t) if digits < t => 1 + (3 * digits / 10).min(t - digits),
                _ => 1 + digits / 6,
            };
        }
    }

    /// Digits that show a solution whose denominator is the whole determinant, by floats.
    fn expected_digits(&self, rhs_bits: u64) -> Option<usize> {
        if self.size() < SMALL {
            return None;
        }
        let n = self.size();
        let entry = |e: usize| mantissa(&self.by_columns.int(e));
        let mut high = vec![i64::MIN; n];
        for e in 0..self.by_columns.index.len() {
            let place = &mut high[self.by_columns.index[e] as usize];
            *place = (*place).max(entry(e).1);
        }
        let columns: Vec<Vec<(u32, f64)>> = (0..n)
            .map(|j| {
                let span = self.by_columns.span(j);
                span.map(|e| {
                    let (i, (a, x)) = (self.by_columns.index[e], entry(e));
                    (i, ldexp(a, x - high[i as usize]))
                })
                .collect()
            })
            .collect();
        let lu = factorise(&Double, &columns, 0.1, 1e-13).ok()?;
        let bits = lu.log2_determinant() + high.iter().sum::<i64>() as f64;
        let bits = 2.0 * bits.clamp(0.0, 1e12) + 2.0 * (rhs_bits + 64) as f64;
        Some((bits / 56.0) as usize + PRECISION)
    }
}

/// Residue of a two's-complement number.
fn residue(field: &Prime, words: &[u64]) -> u64 {
    let Some((&top, rest)) = words.split_last() else {
        return 0;
    };
    rest.iter()
        .rev()
        .fold(field.residue(top as i64), |r, &w| field.append(r, w))
}

/// Digits base p of an integer, all of its sign.
fn digits_of(v: &Int, p: &Int) -> Vec<i64> {
    let mut rest = v.abs();
    let sign = i64::from(v.sign());
    let mut out = Vec::new();
    while !rest.is_zero() {
        let (q, r) = rest.div_rem_floor(p);
        out.push(sign * r.to_i64().unwrap_or(0));
        rest = q;
    }
    out
}

fn from_u128(v: u128) -> Int {
    match i128::try_from(v) {
        Ok(v) => Int::from(v),
        Err(_) => Int::from((v >> 64) as u64).shl(64) + Int::from(v as u64),
    }
}

/// Σ cₖ pᵏ by halves, so that large values cost what multiplication costs.
fn compose(parts: &[Int], p: &Int) -> Int {
    match parts {
        [] => Int::zero(),
        [a] => a.clone(),
        _ if parts.len() <= 8 => parts
            .iter()
            .rev()
            .fold(Int::zero(), |v, c| &v * p + c.clone()),
        _ => {
            let half = parts.len().next_power_of_two() / 2;
            let (low, high) = parts.split_at(half);
            compose(low, p) + compose(high, p) * p.pow(half as u32)
        }
    }
}

/// v reduced to the interval [−M/2, M/2).
fn nearest(v: &Int, modulus: &Int) -> Int {
    let r = v.div_rem_floor(modulus).1;
    if r.shl(1) >= *modulus { r - modulus } else { r }
}

/// A lifting under way.
struct Lifting<'a> {
    kernel: &'a Kernel,
    side: Side,
    /// Digits of the right-hand sides, by digit: (component, digit).
    stream: Vec<Vec<(u32, i64)>>,
    rhs_bits: u64,
    residue: Vec<u64>,
    digits: Vec<Vec<u64>>,
    p: Int,
}

impl<'a> Lifting<'a> {
    fn new(kernel: &'a Kernel, side: Side, rhs: &[Int]) -> Lifting<'a> {
        let p = Int::from(kernel.field.p);
        let mut stream: Vec<Vec<(u32, i64)>> = Vec::new();
        for (i, b) in rhs.iter().enumerate() {
            for (k, d) in digits_of(b, &p).into_iter().enumerate() {
                if stream.len() <= k {
                    stream.push(Vec::new());
                }
                if d != 0 {
                    stream[k].push((i as u32, d));
                }
            }
        }
        Lifting {
            kernel,
            side,
            stream,
            rhs_bits: rhs.iter().map(Int::bits).max().unwrap_or(0),
            residue: vec![0; kernel.size() * kernel.by_rows.limbs],
            digits: Vec::new(),
            p,
        }
    }

    /// Lifts until there are `count` digits.
    fn extend(&mut self, count: usize, budget: &Budget) -> Result<(), Exhausted> {
        let n = self.kernel.size();
        let field = &self.kernel.field;
        let limbs = self.kernel.by_rows.limbs;
        let matrix = match self.side {
            Side::Columns => &self.kernel.by_rows,
            Side::Rows => &self.kernel.by_columns,
        };
        budget.allow((count as u64) * (n as u64) * 8)?;
        let mut right = vec![0u64; n];
        let mut work = Vec::with_capacity(n);
        let mut wide = vec![0u64; limbs];
        while self.digits.len() < count {
            if self.digits.len().is_multiple_of(16) {
                budget.check()?;
            }
            if let Some(arrivals) = self.stream.get(self.digits.len()) {
                for &(i, d) in arrivals {
                    add_small(&mut self.residue[i as usize * limbs..][..limbs], d);
                }
            }
            for (r, words) in right.iter_mut().zip(self.residue.chunks_exact(limbs)) {
                *r = residue(field, words);
            }
            let mut x = vec![0u64; n];
            match self.side {
                Side::Columns => self.kernel.lu.solve_mod(field, &right, &mut x, &mut work),
                Side::Rows => self
                    .kernel
                    .lu
                    .solve_transposed_mod(field, &right, &mut x, &mut work),
            }
            if limbs == 1 {
                for (i, r) in self.residue.iter_mut().enumerate() {
                    let span = matrix.span(i);
                    let mut t = *r;
                    for (&j, &a) in matrix.index[span.clone()].iter().zip(&matrix.words[span]) {
                        t = t.wrapping_sub(a.wrapping_mul(x[j as usize]));
                    }
                    *r = t.wrapping_mul(field.inverse);
                }
            } else {
                for (i, r) in self.residue.chunks_exact_mut(limbs).enumerate() {
                    wide.copy_from_slice(r);
                    for e in matrix.span(i) {
                        let words = &matrix.words[e * limbs..(e + 1) * limbs];
                        sub_product(&mut wide, words, x[matrix.index[e] as usize]);
                    }
                    divide_exactly(&mut wide, field);
                    r.copy_from_slice(&wide);
                }
            }
            self.digits.push(x);
        }
        Ok(())
    }

    /// A common denominator of all components, likely but not certain: a multiple of `d`.
    fn denominator(&self, salt: u64, mut d: Int) -> Option<Int> {
        let modulus = self.p.pow(self.digits.len() as u32);
        for c in 0..COMBINATIONS {
            let combined = self.combination(salt * COMBINATIONS as u64 + c as u64);
            let u = (&combined * &d).div_rem_floor(&modulus).1;
            if nearest(&u, &modulus).bits() + 44 < modulus.bits() {
                continue; // already integral
            }
            d = &d * &reconstruct(&u, &modulus)?.1;
            if d.bits() >= modulus.bits() {
                return None;
            }
        }
        Some(d)
    }

    /// Σ cⱼ xⱼ with pseudo-random cⱼ < 2²⁰, modulo p to the number of digits.
    fn combination(&self, seed: u64) -> Int {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x2545_f491_4f6c_dd1d;
        let coefficients: Vec<u64> = (0..self.kernel.size())
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                state >> 44
            })
            .collect();
        let parts: Vec<Int> = self
            .digits
            .iter()
            .map(|x| {
                let dot = x.iter().zip(&coefficients);
                from_u128(dot.map(|(&x, &c)| u128::from(x) * u128::from(c)).sum())
            })
            .collect();
        compose(&parts, &self.p)
    }

    /// The solution if `d`, or a multiple of it that shows, is a denominator and there are digits
    /// enough to prove it.
    fn prove_or_complete(&mut self, mut d: Int) -> Option<Solution> {
        for _ in 0..COMPLETIONS {
            match self.prove(&d) {
                Ok(s) => return Some(s),
                Err(missing) => d = &d * &missing?,
            }
        }
        None
    }

    /// The solution if `d` is a denominator and there are digits enough to prove it; else perhaps
    /// a factor that it lacks, greater than one.
    fn prove(&mut self, d: &Int) -> Result<Solution, Option<Int>> {
        let bits = 56; // of a digit, rounded down
        // What Σ aN and D·c can reach in the tests of `Solution`, as bits below those of M.
        let norm = self.kernel.norm_bits.max(self.rhs_bits);
        let margin = (norm as usize + 8).div_ceil(bits) + 1;
        let base = ((d.bits() + 2 * norm + 8) as usize).div_ceil(bits);
        let base = base.max((d.bits() as usize).div_ceil(bits) + margin);
        // Long denominators come with values that fall off far: look deeper.
        let precision = PRECISION + d.bits() as usize / (24 * bits);
        let mut window = Window::new(&self.p, d, base.saturating_sub(margin + precision));
        let mut extra = 0;
        loop {
            let count = base + extra;
            if count > self.digits.len() {
                return Err(None);
            }
            window.extend(&self.digits, count - window.low);
            let large = match window.proves(&self.p, d, norm) {
                Ok(mut s) => {
                    self.digits.truncate(count);
                    s.digits = std::mem::take(&mut self.digits);
                    return Ok(s);
                }
                Err(j) => j,
            };
            // Either this component is large, or its denominator is another.
            let modulus = self.p.pow(self.digits.len() as u32);
            let parts: Vec<Int> = self.digits.iter().map(|x| Int::from(x[large])).collect();
            let u = nearest(&(&compose(&parts, &self.p) * d), &modulus);
            let needed = ((u.bits() + norm + 8) as usize).div_ceil(bits) + 1;
            if needed > self.digits.len() {
                let factor = reconstruct(&u, &modulus).map(|r| r.1);
                let room = modulus.bits().saturating_sub(d.bits());
                return Err(factor.filter(|t| *t > Int::one() && t.bits() < room));
            }
            extra = (extra + 1).max(needed.saturating_sub(base));
        }
    }
}

/// The digits of D·xⱼ from a place on, carries not yet taken.
struct Window {
    denominator: Vec<u64>,
    /// Digits below.
    low: usize,
    /// By digit, then component.
    sums: Vec<Vec<u128>>,
    /// What overflowed from the sums, where there can be such.
    carries: Vec<Vec<u32>>,
}

impl Window {
    fn new(p: &Int, d: &Int, low: usize) -> Window {
        Window {
            denominator: digits_of(d, p).into_iter().map(|v| v as u64).collect(),
            low,
            sums: Vec::new(),
            carries: Vec::new(),
        }
    }

    /// Widens to a number of digits.
    fn extend(&mut self, digits: &[Vec<u64>], width: usize) {
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
    fn proves(&mut self, p: &Int, d: &Int, norm: u64) -> Result<Solution, usize> {
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

fn add_small(words: &mut [u64], v: i64) {
    let (first, carry) = words[0].overflowing_add(v as u64);
    words[0] = first;
    let fill = if v < 0 { u64::MAX } else { 0 };
    let mut carry = u64::from(carry);
    for w in &mut words[1..] {
        let (a, c1) = w.overflowing_add(fill);
        let (b, c2) = a.overflowing_add(carry);
        *w = b;
        carry = u64::from(c1 | c2);
    }
}

/// acc −= a·x modulo 2⁶⁴ᵂ, for signed a and unsigned x.
fn sub_product(acc: &mut [u64], a: &[u64], x: u64) {
    let (mut carry, mut borrow) = (0u64, false);
    for (t, &a) in acc.iter_mut().zip(a) {
        let product = u128::from(a) * u128::from(x) + u128::from(carry);
        carry = (product >> 64) as u64;
        let (s, b1) = t.overflowing_sub(product as u64);
        let (s, b2) = s.overflowing_sub(u64::from(borrow));
        *t = s;
        borrow = b1 | b2;
    }
}

/// acc /= p modulo 2⁶⁴ᵂ, for a multiple of p.
fn divide_exactly(acc: &mut [u64], field: &Prime) {
    let mut borrow = 0u64;
    for w in acc {
        let (t, under) = w.overflowing_sub(borrow);
        let q = t.wrapping_mul(field.inverse);
        *w = q;
        borrow = ((u128::from(q) * u128::from(field.p)) >> 64) as u64 + u64::from(under);
    }
}

/// A proven solution N/D, by digits and windows.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    p: Int,
    prime: u64,
    /// By digit, then component; as many as the proof took.
    digits: Vec<Vec<u64>>,
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

/// A double in [½, 1) in size and an exponent.
pub(crate) fn mantissa(v: &Int) -> (f64, i64) {
    let bits = v.bits() as i64;
    let shift = (bits - 62).max(0);
    let top = v.shr(shift as u64).to_i64().unwrap_or(0) as f64;
    (ldexp(top, shift - bits), bits)
}

/// x·2ᵉ, saturating.
pub(crate) fn ldexp(x: f64, e: i64) -> f64 {
    let mut e = e.clamp(-4000, 4000);
    let mut x = x;
    while e > 1000 {
        x *= 2f64.powi(1000);
        e -= 1000;
    }
    while e < -1000 {
        x *= 2f64.powi(-1000);
        e += 1000;
    }
    x * 2f64.powi(e as i32)
}
