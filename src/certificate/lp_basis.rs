//! Checking an optimal basis whose point and prices are too long to write out.
//!
//! The scaling: row i is multiplied by Rᵢ, the least common denominator of its entries, which
//! gives integers A; columns stay. With a common denominator L of all bounds (the rows' times
//! Rᵢ) the unknowns are X = L·x; with a common denominator M of the costs the prices are
//! Y = M·y/Rᵢ. The certificate offers denominators D, E with D·X and E·Y integral in the kernel:
//! the columns that are basic, the rows whose activity is not. Elimination in the given order
//! modulo a prime q, no search, shows the kernel regular and yields X modulo qᴷ digit by digit.
//! If all N ≡ D·X nearest to zero are so small that the kernel's equations hold as integers below
//! qᴷ, they hold (the module `lp_digits`). Signs come from the leading digits, zeros from the
//! residues.
//!
//! Every step is plain arithmetic on machine words modulo a 31-bit prime fixed at compile time. A
//! bad order, place or denominator can only lead to rejection.

use super::lp::{Rejection, reject};
use super::lp_digits::{Digits, Line, Trouble, no};
use crate::lp::{Model, Place};
use crate::number::{Int, Rat};

/// The parts of a basis certificate.
pub(super) struct Evidence<'a> {
    pub(super) columns: &'a [Place],
    pub(super) rows: &'a [Place],
    pub(super) order: &'a [(u32, u32)],
    pub(super) primal_denominator: &'a Int,
    pub(super) dual_denominator: &'a Int,
}

const FIRST: u64 = 2_147_483_647; // 2³¹ − 1
const SECOND: u64 = 2_147_483_629;
const NONE: u32 = u32::MAX;
/// Bits that the largest row or column sum of sizes may have.
const NORM: u64 = 2000;

/// The exact objective at the basis, once it is shown to be optimal.
pub(super) fn objective(model: &Model, evidence: &Evidence<'_>) -> Result<Rat, Rejection> {
    let check = Check::new(model, evidence)?;
    match check.run::<FIRST>() {
        Err(Trouble::Unlucky) => {}
        Err(Trouble::No(r)) => return Err(r),
        Ok(v) => return Ok(v),
    }
    match check.run::<SECOND>() {
        Ok(v) => Ok(v),
        Err(Trouble::No(r)) => Err(r),
        Err(Trouble::Unlucky) => reject("the basis is singular, or its order is wrong"),
    }
}

/// The scaled program and the kernel's shape.
struct Check<'a> {
    model: &'a Model,
    evidence: &'a Evidence<'a>,
    rows: Vec<Line>,
    columns: Vec<Line>,
    bound_scale: Int,
    cost_scale: Int,
    row_scale: Vec<Int>,
    /// Step at which a row or column is eliminated.
    row_step: Vec<u32>,
    column_step: Vec<u32>,
    /// Bits that any |A| row or column sum, bound or cost stays below.
    norm: u64,
}

impl<'a> Check<'a> {
    fn new(model: &'a Model, evidence: &'a Evidence<'a>) -> Result<Check<'a>, Rejection> {
        let (n, m) = (model.columns.len(), model.rows.len());
        if evidence.columns.len() != n || evidence.rows.len() != m {
            return reject("the basis has the wrong size");
        }
        if evidence.primal_denominator.sign() <= 0 || evidence.dual_denominator.sign() <= 0 {
            return reject("a denominator is not positive");
        }
        let mut row_scale = vec![Int::one(); m];
        for c in &model.columns {
            for (i, a) in &c.entries {
                let r = &mut row_scale[*i as usize];
                *r = r.lcm(a.denom());
            }
        }
        let mut rows: Vec<Line> = vec![Vec::new(); m];
        let mut columns: Vec<Line> = Vec::with_capacity(n);
        let mut row_sum = vec![Int::zero(); m];
        let mut norm = 1;
        for (j, c) in model.columns.iter().enumerate() {
            let mut column = Vec::with_capacity(c.entries.len());
            let mut sum = Int::zero();
            for (i, a) in &c.entries {
                let v = a.numer() * &row_scale[*i as usize].div_exact(a.denom());
                row_sum[*i as usize] += &v.abs();
                sum += &v.abs();
                rows[*i as usize].push((j as u32, v.clone()));
                column.push((*i, v));
            }
            norm = norm.max(sum.bits());
            columns.push(column);
        }
        norm = row_sum.iter().fold(norm, |b, s| b.max(s.bits()));
        if norm > NORM {
            return reject("coefficients are too long for this kind of certificate");
        }
        let mut bound_scale = Int::one();
        let ends = |r: &'a crate::lp::Range| [&r.lower, &r.upper].into_iter().flatten();
        for b in model.columns.iter().flat_map(|c| ends(&c.range)) {
            bound_scale = bound_scale.lcm(b.denom());
        }
        for (r, k) in model.rows.iter().zip(&row_scale) {
            for b in ends(&r.range) {
                bound_scale = bound_scale.lcm((b * &Rat::from(k.clone())).denom());
            }
        }
        let costs = model.columns.iter().map(|c| &c.cost);
        let cost_scale = costs.fold(Int::one(), |l, c| l.lcm(c.denom()));
        let mut check = Check {
            model,
            evidence,
            rows,
            columns,
            bound_scale,
            cost_scale,
            row_scale,
            row_step: vec![NONE; m],
            column_step: vec![NONE; n],
            norm,
        };
        let mut total = Int::zero();
        for j in 0..n {
            total += &check.cost(j).abs();
            for b in [check.bound(j, false), check.bound(j, true)]
                .into_iter()
                .flatten()
            {
                check.norm = check.norm.max(b.bits());
            }
        }
        for i in 0..m {
            for b in [check.bound(n + i, false), check.bound(n + i, true)]
                .into_iter()
                .flatten()
            {
                check.norm = check.norm.max(b.bits());
            }
        }
        check.norm = check.norm.max(total.bits());
        for (step, &(i, j)) in evidence.order.iter().enumerate() {
            let (i, j) = (i as usize, j as usize);
            if i >= m
                || j >= n
                || check.row_step[i] != NONE
                || check.column_step[j] != NONE
                || evidence.rows[i] == Place::Basic
                || evidence.columns[j] != Place::Basic
            {
                return reject("the order does not fit the basis");
            }
            check.row_step[i] = step as u32;
            check.column_step[j] = step as u32;
        }
        let count = |places: &[Place], basic: bool| {
            let chosen = places.iter().filter(|&&p| (p == Place::Basic) == basic);
            chosen.count()
        };
        if count(evidence.columns, true) != evidence.order.len()
            || count(evidence.rows, false) != evidence.order.len()
        {
            return reject("the order does not fit the basis");
        }
        Ok(check)
    }

    fn cost(&self, j: usize) -> Int {
        let c = &self.model.columns[j].cost;
        c.numer() * &self.cost_scale.div_exact(c.denom())
    }

    /// A bound, scaled; rows after columns.
    fn bound(&self, v: usize, upper: bool) -> Option<Int> {
        let n = self.model.columns.len();
        let (range, factor) = if v < n {
            (&self.model.columns[v].range, None)
        } else {
            let i = v - n;
            (&self.model.rows[i].range, Some(&self.row_scale[i]))
        };
        let b = if upper { &range.upper } else { &range.lower };
        let scaled = b.as_ref()?.numer() * &self.bound_scale;
        let scaled = match factor {
            Some(f) => scaled * f.clone(),
            None => scaled,
        };
        Some(scaled.div_exact(b.as_ref()?.denom()))
    }

    fn place(&self, v: usize) -> Place {
        let n = self.model.columns.len();
        if v < n {
            self.evidence.columns[v]
        } else {
            self.evidence.rows[v - n]
        }
    }

    fn resting(&self, v: usize) -> Result<Int, Trouble> {
        let value = match self.place(v) {
            Place::Lower => self.bound(v, false),
            Place::Upper => self.bound(v, true),
            Place::Zero | Place::Basic => Some(Int::zero()),
        };
        match value {
            Some(v) => Ok(v),
            None => no("something rests at a bound that it does not have"),
        }
    }

    fn run<const Q: u64>(&self) -> Result<Rat, Trouble> {
        let (n, m) = (self.model.columns.len(), self.model.rows.len());
        let factors = self.eliminate::<Q>()?;
        // Point.
        let mut known = vec![Int::zero(); m];
        for j in 0..n {
            if self.place(j) != Place::Basic {
                let v = self.resting(j)?;
                if !v.is_zero() {
                    for (i, a) in &self.columns[j] {
                        known[*i as usize] += &(&v * a);
                    }
                }
            }
        }
        let mut rhs = Vec::new();
        for &(i, _) in self.evidence.order {
            let i = i as usize;
            rhs.push(self.resting(n + i)? - known[i].clone());
        }
        let lines = |steps: &[u32], line: &Line| -> Line {
            let inside = line.iter().filter(|e| steps[e.0 as usize] != NONE);
            inside
                .map(|(k, a)| (steps[*k as usize], a.clone()))
                .collect()
        };
        let order = self.evidence.order;
        let row_lines = order
            .iter()
            .map(|&(i, _)| lines(&self.column_step, &self.rows[i as usize]));
        let by_rows: Vec<Line> = row_lines.collect();
        let point = Digits::lift::<Q>(
            |r| factors.solve::<Q>(r),
            &by_rows,
            rhs,
            self.evidence.primal_denominator,
            self.norm,
        )?;
        let mut top = Vec::new();
        let mut rest = Int::zero();
        for v in 0..n + m {
            if self.place(v) != Place::Basic {
                continue;
            }
            let (terms, constant) = if v < n {
                (vec![(self.column_step[v], Int::one())], Int::zero())
            } else {
                let i = v - n;
                (lines(&self.column_step, &self.rows[i]), -known[i].clone())
            };
            for upper in [false, true] {
                if let Some(b) = self.bound(v, upper) {
                    let sign = point.sign::<Q>(&terms, &(&constant + &b));
                    if if upper { sign > 0 } else { sign < 0 } {
                        return no("the basis is not feasible");
                    }
                }
            }
        }
        for j in 0..n {
            let c = self.cost(j);
            if c.is_zero() {
                continue;
            }
            if self.place(j) == Place::Basic {
                top.push((self.column_step[j], c));
            } else {
                rest += &(&c * &self.resting(j)?);
            }
        }
        // Prices.
        let column_lines = order
            .iter()
            .map(|&(_, j)| lines(&self.row_step, &self.columns[j as usize]));
        let by_columns: Vec<Line> = column_lines.collect();
        let costs = order.iter().map(|&(_, j)| self.cost(j as usize)).collect();
        let prices = Digits::lift::<Q>(
            |r| factors.solve_transposed::<Q>(r),
            &by_columns,
            costs,
            self.evidence.dual_denominator,
            self.norm,
        )?;
        let turn = if self.model.maximise { -1 } else { 1 };
        for v in 0..n + m {
            if self.place(v) == Place::Basic {
                continue;
            }
            if let (Some(l), Some(u)) = (self.bound(v, false), self.bound(v, true))
                && l == u
            {
                continue;
            }
            let sign = if v < n {
                // c − a·Y, asked as −(a·Y − c)
                -prices.sign::<Q>(&lines(&self.row_step, &self.columns[v]), &self.cost(v))
            } else {
                prices.sign::<Q>(&[(self.row_step[v - n], Int::one())], &Int::zero())
            };
            let good = match self.place(v) {
                Place::Lower => sign * turn >= 0,
                Place::Upper => sign * turn <= 0,
                _ => sign == 0,
            };
            if !good {
                return no("a reduced cost has the wrong sign");
            }
            if self.place(v) == Place::Zero
                && (self.bound(v, false).is_some() || self.bound(v, true).is_some())
            {
                return no("something bounded rests away from its bounds");
            }
        }
        let slope = point.value::<Q>(&top);
        let scale = &self.bound_scale * &self.cost_scale;
        let slope = slope + Rat::from(rest);
        Ok(&self.model.constant + &(slope / Rat::from(scale)))
    }

    /// Elimination in the given order: row by row, against the rows before.
    fn eliminate<const Q: u64>(&self) -> Result<Factors, Trouble> {
        let size = self.evidence.order.len();
        let mut factors = Factors::default();
        let mut value = vec![0u64; size];
        let mut seen = vec![false; size];
        let mut heap = std::collections::BinaryHeap::new();
        for (k, &(i, _)) in self.evidence.order.iter().enumerate() {
            for (j, a) in &self.rows[i as usize] {
                let s = self.column_step[*j as usize];
                if s != NONE {
                    value[s as usize] = a.mod_u64(Q);
                    seen[s as usize] = true;
                    heap.push(std::cmp::Reverse(s));
                }
            }
            let (mut lower, mut upper, mut pivot) = (Vec::new(), Vec::new(), 0);
            while let Some(std::cmp::Reverse(s)) = heap.pop() {
                let at = s as usize;
                let v = std::mem::take(&mut value[at]);
                seen[at] = false;
                if v == 0 {
                    continue;
                }
                if at > k {
                    upper.push((s, v));
                } else if at == k {
                    pivot = v;
                } else {
                    let f = v * factors.inverse[at] % Q;
                    lower.push((s, f));
                    for &(t, u) in &factors.upper[at] {
                        let t = t as usize;
                        if !seen[t] {
                            seen[t] = true;
                            heap.push(std::cmp::Reverse(t as u32));
                        }
                        value[t] = (value[t] + (Q - f) * u) % Q;
                    }
                }
            }
            if pivot == 0 {
                return Err(Trouble::Unlucky);
            }
            factors.lower.push(lower);
            factors.upper.push(upper);
            factors.inverse.push(power::<Q>(pivot, Q - 2));
        }
        Ok(factors)
    }
}

fn power<const Q: u64>(mut b: u64, mut e: u64) -> u64 {
    let mut out = 1;
    while e > 0 {
        if e & 1 == 1 {
            out = out * b % Q;
        }
        b = b * b % Q;
        e >>= 1;
    }
    out
}

/// L and U by rows, in elimination steps.
#[derive(Default)]
struct Factors {
    lower: Vec<Vec<(u32, u64)>>,
    upper: Vec<Vec<(u32, u64)>>,
    inverse: Vec<u64>,
}

impl Factors {
    fn solve<const Q: u64>(&self, b: &mut [u64]) {
        for k in 0..b.len() {
            let mut t = b[k];
            for &(s, f) in &self.lower[k] {
                t = (t + (Q - f) * b[s as usize]) % Q;
            }
            b[k] = t;
        }
        for k in (0..b.len()).rev() {
            let mut t = b[k];
            for &(s, u) in &self.upper[k] {
                t = (t + (Q - u) * b[s as usize]) % Q;
            }
            b[k] = t * self.inverse[k] % Q;
        }
    }

    fn solve_transposed<const Q: u64>(&self, b: &mut [u64]) {
        for k in 0..b.len() {
            let t = b[k] * self.inverse[k] % Q;
            b[k] = t;
            for &(s, u) in &self.upper[k] {
                let slot = &mut b[s as usize];
                *slot = (*slot + (Q - u) * t) % Q;
            }
        }
        for k in (0..b.len()).rev() {
            let t = b[k];
            for &(s, f) in &self.lower[k] {
                let slot = &mut b[s as usize];
                *slot = (*slot + (Q - f) * t) % Q;
            }
        }
    }
}
