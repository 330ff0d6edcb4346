//! Prices that miss the costs of free columns by next to nothing, and what they still prove.
//!
//! A bound needs prices y with Aᵀy = c in every free column, exactly. Prices of many rows that
//! satisfy this have denominators as long as a determinant, so a certificate may carry short ones
//! instead, for which r = c − Aᵀy is tiny in the free columns F, and leave it to this module to
//! prove that exact ones are near.
//!
//! Let S be the rows whose price is not zero (or that are bounded from both sides), scaled by
//! powers of two, and N = A_{S,F}ᵀ·A_{S,F}. If N ≥ λ > 0 then Δ = A_{S,F}·N⁻¹·r exists, A_{S,F}ᵀΔ = r,
//! so y + Δ is exact and rational, and |Δᵢ| ≤ ‖aᵢ‖·‖r‖/λ. Where that is at most |yᵢ| no price changes
//! its sign, and the bound that y + Δ proves differs from that of y by no more than Σ|Δᵢ| times the
//! rows' bounds (and the like in the columns that are not free).
//!
//! λ comes from a Cholesky factor in doubles: if that of N̂ − σ runs to its end, N̂ ≥ σ − e with e
//! the bound on its rounding errors, γ·trace (S. M. Rump, Verification of positive
//! definiteness, BIT 46, 2006; it holds for any order of elimination and any sparse pattern).
//! Everything else is exact, or a sum of positive doubles rounded up. The order of elimination
//! and σ are hints of the certificate; whatever they are, a completed factor proves its λ.

use super::lp::{Prices, Rejection, reject};
use crate::lp::Model;
use crate::number::Rat;

/// Unit roundoff.
const UNIT: f64 = 1.110_223_024_625_156_5e-16;
/// Raises any sum or product of non-negative doubles with fewer than 2²⁰ operations above the
/// true one.
const ABOVE: f64 = 1.0 + 1.0 / 1_073_741_824.0;
/// Added to what might have vanished below the double range.
const TINY: f64 = 1e-290;
/// Operations up to which ABOVE holds.
const LONGEST: usize = 1 << 19;

/// A double that is not below |v|.
fn above(v: &Rat) -> Result<f64, Rejection> {
    match v.abs().nearest_f64() {
        Some(v) => Ok(v * ABOVE + TINY),
        None => reject("a number is out of the range of doubles"),
    }
}

/// The power of two at or just below |v|, as an exponent; v is neither zero nor subnormal.
fn exponent(v: f64) -> i32 {
    (v.to_bits() >> 52 & 0x7ff) as i32 - 1023
}

/// 2ᵏ.
fn power(k: i32) -> f64 {
    f64::from_bits(((1023 + k.clamp(-1000, 1000)) as u64) << 52)
}

/// Rows and prices made ready: what does not depend on the hints.
pub(crate) struct Near<'a> {
    model: &'a Model,
    prices: Prices,
    /// Index among the free columns.
    free: Vec<Option<u32>>,
    /// r of each free column, rounded up.
    missing: Vec<f64>,
    /// Rows of S with the power of two that scales each, and its entries in free columns, scaled.
    rows: Vec<(usize, f64)>,
    entries: Vec<Vec<(u32, f64)>>,
}

/// The matrix N̂ and what it was made of, columns numbered in the order of elimination.
pub(crate) struct Matrix {
    /// Upper triangle by columns, sorted, the diagonal last.
    columns: Vec<Vec<(u32, f64)>>,
    trace: f64,
    /// Operations of the longest sum.
    longest: usize,
    /// Rows of S and powers of two of the free columns, both scaled.
    lines: Vec<Vec<(u32, f64)>>,
    scale: Vec<f64>,
}

impl<'a> Near<'a> {
    /// Rejects prices whose sign a row does not allow, and numbers that doubles cannot hold.
    pub(crate) fn new(model: &'a Model, prices: Prices) -> Result<Near<'a>, Rejection> {
        let mut free = vec![None; model.columns.len()];
        let mut missing = Vec::new();
        for (j, c) in model.columns.iter().enumerate() {
            if c.range.lower.is_none() && c.range.upper.is_none() {
                free[j] = Some(missing.len() as u32);
                let (top, bottom) = prices.reduced(model, j, true);
                missing.push(if top.is_zero() {
                    0.0
                } else {
                    above(&Rat::new(top, bottom))?
                });
            }
        }
        let turn = if model.maximise { -1 } else { 1 };
        let mut place = vec![None; model.rows.len()];
        let mut rows = Vec::new();
        for (i, r) in model.rows.iter().enumerate() {
            let needed = match prices.y[i].sign() * turn {
                1 => r.range.lower.is_some(),
                -1 => r.range.upper.is_some(),
                _ => true,
            };
            if !needed {
                return reject(format!("the price of `{}` has the wrong sign", r.name));
            }
            let both = r.range.lower.is_some() && r.range.upper.is_some();
            if !prices.y[i].is_zero() || both {
                place[i] = Some(rows.len());
                rows.push((i, 1.0));
            }
        }
        let mut entries = vec![Vec::new(); rows.len()];
        for (c, f) in model.columns.iter().zip(&free) {
            let Some(f) = f else { continue };
            for (i, a) in &c.entries {
                if let Some(k) = place[*i as usize] {
                    match a.nearest_f64() {
                        Some(a) if a.abs() > 1e-280 && a.abs() < 1e280 => entries[k].push((*f, a)),
                        _ => return reject("a coefficient is out of the range of doubles"),
                    }
                }
            }
        }
        for ((_, scale), line) in rows.iter_mut().zip(&mut entries) {
            let largest = line.iter().fold(0.0f64, |m, e| m.max(e.1.abs()));
            if largest > 0.0 {
                *scale = power(-exponent(largest));
                line.iter_mut().for_each(|e| e.1 *= *scale);
            }
        }
        Ok(Near {
            model,
            prices,
            free,
            missing,
            rows,
            entries,
        })
    }

    /// Whether the prices meet the costs of the free columns exactly.
    pub(crate) fn exact(&self) -> bool {
        self.missing.iter().all(|r| *r == 0.0)
    }

    /// The bound that exact prices near these prove, which lies a little on the safe side.
    ///
    /// `order` is the order in which columns are eliminated, `margin` gives σ = 2⁻ᵐᵃʳᵍⁱⁿ.
    pub(crate) fn bound(&self, order: &[u32], margin: u32) -> Result<Rat, Rejection> {
        self.bound_with(&self.matrix(order)?, margin)
    }

    /// The same with the matrix made before.
    pub(crate) fn bound_with(&self, matrix: &Matrix, margin: u32) -> Result<Rat, Rejection> {
        let change = if self.exact() {
            vec![0.0; self.rows.len()]
        } else {
            self.changes(matrix, margin)?
        };
        let mut loss = 0.0f64;
        for (&(i, _), t) in self.rows.iter().zip(&change) {
            let range = &self.model.rows[i].range;
            if range.lower.is_none() || range.upper.is_none() {
                let y = Rat::new(self.prices.y[i].abs(), self.prices.denominator.clone());
                if y < Rat::from_f64(*t) {
                    let name = &self.model.rows[i].name;
                    return reject(format!("the price of `{name}` is too near to zero"));
                }
            }
            for end in [&range.lower, &range.upper].into_iter().flatten() {
                loss += t * above(end)?;
            }
        }
        // The columns that are not free have reduced costs that change with the prices.
        let mut by_row = vec![0.0; self.model.rows.len()];
        for (&(i, _), t) in self.rows.iter().zip(&change) {
            by_row[i] = *t;
        }
        let turn = if self.model.maximise { -1 } else { 1 };
        for (j, c) in self.model.columns.iter().enumerate() {
            if self.free[j].is_some() {
                continue;
            }
            let mut t = 0.0f64;
            for (i, a) in &c.entries {
                if by_row[*i as usize] > 0.0 {
                    t += by_row[*i as usize] * above(a)?;
                }
            }
            let t = if t > 0.0 { t * ABOVE + TINY } else { 0.0 };
            if !t.is_finite() {
                return reject("a column is out of the range of doubles");
            }
            if t > 0.0 && (c.range.lower.is_none() || c.range.upper.is_none()) {
                let (top, bottom) = self.prices.reduced(self.model, j, true);
                let sign = if c.range.lower.is_some() { 1 } else { -1 };
                let d = Rat::new(top, bottom);
                if d.sign() != sign * turn || d.abs() < Rat::from_f64(t) {
                    return reject(format!("the reduced cost of `{}` is too small", c.name));
                }
            }
            for end in [&c.range.lower, &c.range.upper].into_iter().flatten() {
                loss += t * above(end)?;
            }
        }
        let loss = loss * ABOVE;
        if !loss.is_finite() {
            return reject("the prices bound nothing");
        }
        let bound = self
            .prices
            .bound_but(self.model, |j| self.free[j].is_some())?;
        let loss = Rat::from_f64(loss);
        Ok(if self.model.maximise {
            bound + &loss
        } else {
            bound - &loss
        })
    }

    /// N̂ in an order of elimination.
    pub(crate) fn matrix(&self, order: &[u32]) -> Result<Matrix, Rejection> {
        let n = self.missing.len();
        if self.rows.len() > LONGEST || self.model.columns.len() > LONGEST {
            return reject("too many rows for prices that are not exact");
        }
        let mut place = vec![u32::MAX; n];
        let mut count = 0;
        for &j in order {
            match self.free.get(j as usize) {
                Some(Some(f)) if place[*f as usize] == u32::MAX => {
                    place[*f as usize] = count;
                    count += 1;
                }
                _ => return reject("the order of elimination is none of the free columns"),
            }
        }
        if count as usize != n {
            return reject("the order of elimination leaves columns out");
        }
        // Columns are scaled so that the diagonal of N is between 1/2 and 2.
        let mut square = vec![0.0f64; n];
        let mut length = vec![0usize; n];
        for line in &self.entries {
            for &(f, a) in line {
                square[f as usize] += a * a;
                length[f as usize] += 1;
            }
        }
        if square.iter().any(|v| *v < 1e-250) {
            return reject("a free column has no priced row");
        }
        let scale: Vec<f64> = square
            .iter()
            .map(|v| power(-(exponent(*v) + 1).div_euclid(2)))
            .collect();
        let lines: Vec<Vec<(u32, f64)>> = self
            .entries
            .iter()
            .map(|line| {
                let scaled = line.iter();
                let scaled = scaled.map(|&(f, a)| (place[f as usize], a * scale[f as usize]));
                let mut scaled: Vec<(u32, f64)> = scaled.collect();
                scaled.sort_unstable_by_key(|e| e.0);
                scaled
            })
            .collect();
        let columns = gram(n, &lines);
        let trace: f64 = columns.iter().filter_map(|c| c.last()).map(|e| e.1).sum();
        Ok(Matrix {
            columns,
            trace: trace * ABOVE,
            longest: length.iter().copied().max().unwrap_or(0) + 4,
            lines,
            scale,
        })
    }

    /// Bounds on |Δᵢ| for the rows of S, in the model's terms.
    fn changes(&self, matrix: &Matrix, margin: u32) -> Result<Vec<f64>, Rejection> {
        let sigma = power(-(margin.min(900) as i32));
        let row = factor(&matrix.columns, sigma).ok_or_else(|| {
            Rejection("the matrix of prices that are not exact may be singular".into())
        })? + 4;
        // γ of the sums that made N̂, and γ/(1 − γ) of the factor.
        let (a, b) = (matrix.longest as f64 * UNIT, row as f64 * UNIT);
        let error = (a / (1.0 - a) + b / (1.0 - 2.0 * b)) * matrix.trace * ABOVE * ABOVE + TINY;
        let lambda = (sigma - error) / ABOVE;
        if lambda.is_nan() || lambda <= 0.0 {
            return reject("the matrix of prices that are not exact is too ill-conditioned");
        }
        let residual = self.missing.iter().zip(&matrix.scale);
        let residual: f64 = residual.map(|(r, d)| (r * d) * (r * d) + TINY).sum();
        let size = (residual * ABOVE).sqrt() * ABOVE / lambda * ABOVE;
        // Far beyond anything of use, and far within the double range.
        if size.is_nan() || size > 1e100 {
            return reject("the prices miss the costs of free columns by too much");
        }
        let rows = self
            .rows
            .iter()
            .zip(&matrix.lines)
            .map(|(&(_, scale), line)| {
                if line.is_empty() {
                    return 0.0;
                }
                let norm: f64 = line.iter().map(|e| e.1 * e.1).sum();
                scale * ((norm * ABOVE + TINY).sqrt() * ABOVE * size) * ABOVE + TINY
            });
        let rows: Vec<f64> = rows.collect();
        if rows.iter().any(|t| !t.is_finite()) {
            return reject("a row is out of the range of doubles");
        }
        Ok(rows)
    }
}

/// The matrix Σ lineᵀ·line: upper triangle by columns, sorted, the diagonal last.
fn gram(n: usize, lines: &[Vec<(u32, f64)>]) -> Vec<Vec<(u32, f64)>> {
    // Which lines a column is in, and where.
    let mut by_column: Vec<Vec<(u32, u32)>> = vec![Vec::new(); n];
    for (k, line) in lines.iter().enumerate() {
        for (e, (f, _)) in line.iter().enumerate() {
            by_column[*f as usize].push((k as u32, e as u32));
        }
    }
    let mut sum = vec![0.0f64; n];
    let mut seen = vec![u32::MAX; n];
    let mut out = Vec::with_capacity(n);
    for (j, places) in by_column.iter().enumerate() {
        let mut met = Vec::new();
        for &(k, e) in places {
            let line = &lines[k as usize];
            let v = line[e as usize].1;
            for &(f, a) in &line[..=e as usize] {
                if seen[f as usize] != j as u32 {
                    seen[f as usize] = j as u32;
                    sum[f as usize] = 0.0;
                    met.push(f);
                }
                sum[f as usize] += a * v;
            }
        }
        met.sort_unstable();
        out.push(met.iter().map(|&f| (f, sum[f as usize])).collect());
    }
    out
}

/// Whether the Cholesky factor of N̂ − σ exists in doubles: the entries of its longest row if so.
fn factor(matrix: &[Vec<(u32, f64)>], sigma: f64) -> Option<usize> {
    let n = matrix.len();
    let mut parent = vec![usize::MAX; n];
    let mut mark = vec![usize::MAX; n];
    let mut columns: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n];
    let mut pivots = vec![0.0f64; n];
    let mut work = vec![0.0f64; n];
    let mut longest = 0;
    let mut row = Vec::new();
    for k in 0..n {
        row.clear();
        mark[k] = k;
        for &(i, v) in &matrix[k] {
            work[i as usize] = v;
            // Up the tree of eliminations from each entry.
            let mut i = i as usize;
            while mark[i] != k {
                mark[i] = k;
                row.push(i);
                if parent[i] == usize::MAX {
                    parent[i] = k;
                }
                i = parent[i];
            }
        }
        row.sort_unstable();
        longest = longest.max(row.len() + 1);
        let mut pivot = work[k] - sigma;
        work[k] = 0.0;
        for &i in &row {
            let v = work[i] / pivots[i];
            work[i] = 0.0;
            for &(r, l) in &columns[i] {
                work[r as usize] -= l * v;
            }
            pivot -= v * v;
            columns[i].push((k as u32, v));
        }
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        pivots[k] = pivot.sqrt();
    }
    Some(longest)
}
