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
use super::digits::{
    add_small, compose, digits_of, divide_exactly, from_u128, ldexp, mantissa, nearest, residue,
    sub_product,
};
use super::field::{Double, Prime};
use super::lu::{Lu, Singular, factorise};
use super::problem::{Matrix, Problem};
use super::reconstruct::reconstruct;
use super::solution::{Solution, Window};
use crate::number::Int;

/// Digits of precision kept below the largest component.
const PRECISION: usize = 4;
/// Random combinations whose denominators are joined.
const COMBINATIONS: usize = 6;
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
