//! Checking an optimal basis whose point and prices are too long to write out.
//!
//! The scaling: row i is multiplied by Rᵢ, the least common denominator of its entries, which
//! gives integers A; columns stay. With a common denominator L of all bounds (the rows' times
//! Rᵢ) the unknowns are X = L·x; with a common denominator M of the costs the prices are
//! Y = M·y/Rᵢ. The certificate offers denominators D, E with D·X and E·Y integral in the kernel:
//! the columns that are basic, the rows whose activity is not. Elimination in the given order
//! modulo a prime q, no search, shows the kernel regular and yields X modulo qᴷ digit by digit.
//! If all N ≡ D·X nearest to zero are so small that the kernel's equations hold as integers below
//! qᴷ, they hold. Signs come from the leading digits, zeros from the residues.
//!
//! Every step is plain arithmetic on machine words modulo a 31-bit prime fixed at compile time. A
//! bad order, place or denominator can only lead to rejection.

use super::lp::{Rejection, lcm, reject};
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
/// Bits of a digit, rounded down.
const DIGIT: u64 = 30;
/// Components of a solution that are worked on together.
const BLOCK: usize = 64;
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

enum Trouble {
    /// A pivot vanished modulo this prime.
    Unlucky,
    No(Rejection),
}

fn no<T>(why: &str) -> Result<T, Trouble> {
    Err(Trouble::No(Rejection(why.to_string())))
}

type Line = Vec<(u32, Int)>;

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
                *r = lcm(r, a.denom());
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
            bound_scale = lcm(&bound_scale, b.denom());
        }
        for (r, k) in model.rows.iter().zip(&row_scale) {
            for b in ends(&r.range) {
                bound_scale = lcm(&bound_scale, (b * &Rat::from(k.clone())).denom());
            }
        }
        let costs = model.columns.iter().map(|c| &c.cost);
        let cost_scale = costs.fold(Int::one(), |l, c| lcm(&l, c.denom()));
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

/// Integers N with N/D the solution, by digits of N/D modulo Qᴷ and leading parts of N.
struct Digits {
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
    fn lift<const Q: u64>(
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
    fn sign<const Q: u64>(&self, terms: &[(u32, Int)], constant: &Int) -> i32 {
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
    fn value<const Q: u64>(&self, terms: &[(u32, Int)]) -> Rat {
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
