//! The program in integers: what the exact engine computes with.
//!
//! Row i is multiplied by a rational that clears its denominators, column j divided by the
//! content that is left, then the rows by theirs. Bounds are integers over one common
//! denominator L, costs over another, M; the objective is minimised. So with
//!
//! x = L·x' / Cⱼ, s = L·Rᵢ·s', c = M·Cⱼ·c'
//!
//! everything below is integral: A·x − s = 0, l ≤ (x, s) ≤ u, minimise c·x. Variables are
//! numbered columns first, then the rows' activities ("logicals", whose column is −eᵢ).
//!
//! Matrix entries are kept as two's-complement numbers of a fixed count of 64-bit limbs, enough
//! for any row or column sum of sizes, because lifting needs only their residues modulo 2⁶⁴ᵂ.

use super::model::Model;
use crate::number::{Int, Rat};

/// Largest number of bits an integer of the scaled program may have before it is refused.
pub(crate) const MAX_BITS: u64 = 8_000_000;

/// A bound, integral over the common denominator.
pub(crate) type Bound = Option<Int>;

/// Compressed lines of (index, limbs).
#[derive(Clone, Debug, Default)]
pub(crate) struct Matrix {
    pub(crate) start: Vec<usize>,
    pub(crate) index: Vec<u32>,
    /// `limbs` words an entry, least first, two's complement.
    pub(crate) words: Vec<u64>,
    pub(crate) limbs: usize,
}

impl Matrix {
    pub(crate) fn span(&self, line: usize) -> std::ops::Range<usize> {
        self.start[line]..self.start[line + 1]
    }

    /// The entry at a position as an integer.
    pub(crate) fn int(&self, at: usize) -> Int {
        if self.limbs == 1 {
            return Int::from(self.words[at] as i64);
        }
        let words = &self.words[at * self.limbs..(at + 1) * self.limbs];
        let (top, rest) = (words[self.limbs - 1] as i64, &words[..self.limbs - 1]);
        rest.iter()
            .rev()
            .fold(Int::from(top), |v, &w| v.shl(64) + Int::from(w))
    }

    pub(crate) fn transposed(&self, lines: usize) -> Matrix {
        let mut start = vec![0usize; lines + 1];
        for &i in &self.index {
            start[i as usize + 1] += 1;
        }
        for k in 0..lines {
            start[k + 1] += start[k];
        }
        let mut at = start.clone();
        let w = self.limbs;
        let mut index = vec![0u32; self.index.len()];
        let mut words = vec![0u64; self.words.len()];
        for k in 0..self.start.len() - 1 {
            for e in self.span(k) {
                let slot = &mut at[self.index[e] as usize];
                index[*slot] = k as u32;
                words[*slot * w..(*slot + 1) * w].copy_from_slice(&self.words[e * w..(e + 1) * w]);
                *slot += 1;
            }
        }
        Matrix {
            start,
            index,
            words,
            limbs: w,
        }
    }
}

/// The integral program.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    /// Columns of the model.
    pub(crate) n: usize,
    /// Rows of the model.
    pub(crate) m: usize,
    /// By columns.
    pub(crate) columns: Matrix,
    /// By rows.
    pub(crate) rows: Matrix,
    /// Costs of the columns.
    pub(crate) cost: Vec<Int>,
    /// Bounds of columns, then logicals.
    pub(crate) lower: Vec<Bound>,
    pub(crate) upper: Vec<Bound>,
    /// Cⱼ.
    pub(crate) column_scale: Vec<Rat>,
    /// Rᵢ.
    pub(crate) row_scale: Vec<Rat>,
    /// L and M; M is negative when the model maximises.
    pub(crate) bound_scale: Int,
    pub(crate) cost_scale: Int,
    /// Bits of the largest row or column sum of |entries|, of any bound, of the sum of |costs|.
    pub(crate) norm_bits: u64,
    /// Bits of the largest row or column sum of |entries| before contents are taken out.
    pub(crate) sum_bits: u64,
}

/// Two's-complement words of an integer.
pub(crate) fn to_words(v: &Int, limbs: usize, out: &mut Vec<u64>) {
    if let Some(small) = v.to_i64() {
        out.push(small as u64);
        let fill = if small < 0 { u64::MAX } else { 0 };
        out.extend(std::iter::repeat_n(fill, limbs - 1));
        return;
    }
    let base = Int::one().shl(32);
    let mut rest = v.clone();
    for _ in 0..limbs {
        let mut word = 0u64;
        for half in 0..2 {
            let (q, r) = rest.div_rem_floor(&base);
            word |= (r.to_i64().unwrap_or(0) as u64) << (32 * half);
            rest = q;
        }
        out.push(word);
    }
}

impl Problem {
    /// Scales a model to integers; None where they would grow past [`MAX_BITS`].
    pub(crate) fn new(model: &Model) -> Option<Problem> {
        let (n, m) = (model.columns.len(), model.rows.len());
        let one = Int::one();
        let mut clear = vec![one.clone(); m];
        for c in &model.columns {
            for (i, v) in &c.entries {
                let d = v.denom();
                if *d != one {
                    let slot = &mut clear[*i as usize];
                    *slot = slot.lcm(d);
                    if slot.bits() > MAX_BITS {
                        return None;
                    }
                }
            }
        }
        let mut ints: Vec<Vec<(u32, Int)>> = Vec::with_capacity(n);
        let mut column_scale = Vec::with_capacity(n);
        let mut content = vec![Int::zero(); m];
        let mut sum_bits = 0;
        let mut row_sum = vec![Int::zero(); m];
        for c in &model.columns {
            let mut column: Vec<(u32, Int)> = c
                .entries
                .iter()
                .map(|(i, v)| {
                    let k = &clear[*i as usize];
                    let factor = if v.denom() == &one {
                        k.clone()
                    } else {
                        k.div_exact(v.denom())
                    };
                    (*i, v.numer() * &factor)
                })
                .collect();
            let mut sum = Int::zero();
            for (i, v) in &column {
                let size = v.abs();
                row_sum[*i as usize] += &size;
                sum += &size;
            }
            sum_bits = sum_bits.max(sum.bits());
            let mut g = Int::zero();
            for (_, v) in &column {
                g = g.gcd(v);
                if g == one {
                    break;
                }
            }
            if g.is_zero() || g == one {
                g = one.clone();
            } else {
                for (_, v) in &mut column {
                    *v = v.div_exact(&g);
                }
            }
            for (i, v) in &column {
                let slot = &mut content[*i as usize];
                if *slot != one {
                    *slot = slot.gcd(v);
                }
            }
            column_scale.push(Rat::new(one.clone(), g));
            ints.push(column);
        }
        let mut columns = Matrix {
            start: vec![0],
            limbs: 1,
            ..Matrix::default()
        };
        sum_bits = row_sum.iter().fold(sum_bits, |b, s| b.max(s.bits()));
        let mut row_sum = vec![Int::zero(); m];
        let mut norm_bits = 1;
        for column in &mut ints {
            let mut sum = Int::zero();
            for (i, v) in column.iter_mut() {
                let g = &content[*i as usize];
                if *g != one {
                    *v = v.div_exact(g);
                }
                let size = v.abs();
                row_sum[*i as usize] += &size;
                sum += &size;
            }
            norm_bits = norm_bits.max(sum.bits());
        }
        norm_bits = row_sum.iter().fold(norm_bits, |b, s| b.max(s.bits()));
        if norm_bits > MAX_BITS {
            return None;
        }
        columns.limbs = (norm_bits as usize + 3).div_ceil(64);
        for column in &ints {
            for (i, v) in column {
                columns.index.push(*i);
                to_words(v, columns.limbs, &mut columns.words);
            }
            columns.start.push(columns.index.len());
        }
        let row_scale: Vec<Rat> = clear
            .into_iter()
            .zip(content)
            .map(|(k, g)| Rat::new(k, if g.is_zero() { one.clone() } else { g }))
            .collect();

        let scaled = |v: &Option<Rat>, by: &Rat| v.as_ref().map(|v| v * by);
        let mut lower: Vec<Option<Rat>> = Vec::with_capacity(n + m);
        let mut upper = Vec::with_capacity(n + m);
        for (c, s) in model.columns.iter().zip(&column_scale) {
            let inverse = s.recip();
            lower.push(scaled(&c.range.lower, &inverse));
            upper.push(scaled(&c.range.upper, &inverse));
        }
        for (r, s) in model.rows.iter().zip(&row_scale) {
            lower.push(scaled(&r.range.lower, s));
            upper.push(scaled(&r.range.upper, s));
        }
        let mut bound_scale = one.clone();
        for v in lower.iter().chain(&upper).flatten() {
            bound_scale = bound_scale.lcm(v.denom());
            if bound_scale.bits() > MAX_BITS {
                return None;
            }
        }
        let costs: Vec<Rat> = model
            .columns
            .iter()
            .zip(&column_scale)
            .map(|(c, s)| {
                if c.cost.is_zero() {
                    Rat::zero()
                } else {
                    &c.cost * s
                }
            })
            .collect();
        let mut cost_scale = one.clone();
        for v in &costs {
            cost_scale = cost_scale.lcm(v.denom());
            if cost_scale.bits() > MAX_BITS {
                return None;
            }
        }
        if model.maximise {
            cost_scale = -cost_scale;
        }
        let integral = |v: &Rat, scale: &Int| {
            if v.is_zero() {
                Int::zero()
            } else {
                v.numer() * &scale.div_exact(v.denom())
            }
        };
        let bound = |v: Option<Rat>| v.map(|v| integral(&v, &bound_scale));
        let lower: Vec<Bound> = lower.into_iter().map(bound).collect();
        let upper: Vec<Bound> = upper.into_iter().map(bound).collect();
        let cost: Vec<Int> = costs.iter().map(|v| integral(v, &cost_scale)).collect();
        let numbers = lower.iter().chain(&upper).flatten().chain(&cost);
        let norm_bits = numbers.fold(norm_bits, |b, v| b.max(v.bits()));
        // The objective is asked for like a row.
        let total = cost.iter().fold(Int::zero(), |s, v| s + v.abs());
        let norm_bits = norm_bits.max(total.bits());
        if norm_bits > MAX_BITS {
            return None;
        }
        Some(Problem {
            n,
            m,
            rows: columns.transposed(m),
            columns,
            cost,
            lower,
            upper,
            column_scale,
            row_scale,
            bound_scale,
            cost_scale,
            norm_bits,
            sum_bits,
        })
    }

    /// Whether a variable has equal bounds.
    pub(crate) fn is_fixed(&self, j: usize) -> bool {
        matches!((&self.lower[j], &self.upper[j]), (Some(l), Some(u)) if l == u)
    }

    /// A variable whose bounds cross, if there is one: the program is infeasible by it alone.
    pub(crate) fn crossed(&self) -> Option<usize> {
        (0..self.n + self.m)
            .find(|&j| matches!((&self.lower[j], &self.upper[j]), (Some(l), Some(u)) if l > u))
    }
}
