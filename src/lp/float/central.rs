//! An interior-point method of our own, for programs of inequalities: it ends with a point and
//! prices strictly inside what is allowed, which is what bounds without a vertex are made of.
//!
//! With every finite bound of a column or a row's activity as a side, g·x − h = s ≥ 0 with price
//! z ≥ 0 and Σ z·g = c, each step of Mehrotra's predictor-corrector method solves with the one
//! matrix Σ (z/s)·g·gᵀ over the columns. It is positive definite, so it takes a Cholesky factor
//! and nothing else; no noise is added to the program and no basis is sought. Programs with
//! equations have no interior and are left to others.

use super::cholesky::Cholesky;
use super::program::Program;
use crate::lp::budget::{Budget, Stage};

/// Steps after which it gives up; 15 to 30 are usual.
const STEPS: u64 = 80;
/// Share of the way to the boundary that a step goes.
const NEARLY: f64 = 0.9995;
/// How much wider than usual the start is: programs whose sides nearly contradict each other take
/// twice the steps from near the boundary, the others lose two or three.
const WIDE: f64 = 300.0;
/// Corrections of a direction for products s·z that would stray (Gondzio 1996), how far they may,
/// and what a correction must add to the lengths of the steps to be kept.
const CORRECTIONS: usize = 2;
const STRAY: f64 = 10.0;
const LONGER: f64 = 0.01;
/// Entries that the factor may have for each of the program.
const FILL: usize = 20;
/// Products for one matrix, for each entry of the program.
const PRODUCTS: usize = 60;
/// Residuals, relative to the sizes of the data, that count as none.
const EXACT: f64 = 1e-9;

/// One finite bound.
struct Side {
    variable: usize,
    /// 1 for a lower bound, −1 for an upper one.
    sign: f64,
    h: f64,
}

/// A program in the form above, with its factor.
pub(crate) struct Central<'a> {
    program: &'a Program,
    sides: Vec<Side>,
    factor: Cholesky,
    /// By rows, positions and products of each pair of entries.
    pair_start: Vec<usize>,
    pairs: Vec<(u32, f64)>,
    diagonal: Vec<u32>,
    pub(crate) steps: u64,
    s: Vec<f64>,
    z: Vec<f64>,
    pub(crate) x: Vec<f64>,
}

impl<'a> Central<'a> {
    /// None for programs with equations, or where the factor would be dense.
    pub(crate) fn new(program: &'a Program) -> Option<Central<'a>> {
        let p = program;
        let total = p.n + p.m;
        if p.dualised || p.n == 0 || (0..total).any(|v| p.lower[v] == p.upper[v]) {
            return None;
        }
        let entries = p.rows.index.len() + p.n;
        let lengths = || p.rows.start.windows(2).map(|w| w[1] - w[0]);
        if lengths().map(|k| k * (k + 1) / 2).sum::<usize>() > PRODUCTS * entries {
            return None;
        }
        let mut sides = Vec::new();
        for v in 0..total {
            if p.lower[v] > f64::NEG_INFINITY {
                sides.push(Side {
                    variable: v,
                    sign: 1.0,
                    h: p.lower[v],
                });
            }
            if p.upper[v] < f64::INFINITY {
                sides.push(Side {
                    variable: v,
                    sign: -1.0,
                    h: -p.upper[v],
                });
            }
        }
        let cliques = p.rows.start.windows(2).map(|w| &p.rows.index[w[0]..w[1]]);
        let factor = Cholesky::new(p.n, cliques, FILL * entries)?;
        let (mut pair_start, mut pairs) = (vec![0], Vec::new());
        for i in 0..p.m {
            let line: Vec<(usize, f64)> = p.rows.line(i).collect();
            for (k, &(a, u)) in line.iter().enumerate() {
                for &(b, v) in &line[..=k] {
                    pairs.push((factor.position(a as u32, b as u32), u * v));
                }
            }
            pair_start.push(pairs.len());
        }
        let diagonal = (0..p.n as u32).map(|j| factor.position(j, j)).collect();
        let count = sides.len();
        Some(Central {
            program,
            sides,
            factor,
            pair_start,
            pairs,
            diagonal,
            steps: 0,
            s: vec![1.0; count],
            z: vec![1.0; count],
            x: vec![0.0; p.n],
        })
    }

    /// g·x on every side.
    fn along(&self, x: &[f64]) -> Vec<f64> {
        let rows = &self.program.rows;
        // The hot loops are plain ones.
        let mut value = Vec::with_capacity(x.len() + self.program.m);
        value.extend_from_slice(x);
        for w in rows.start.windows(2) {
            let (indices, entries) = (&rows.index[w[0]..w[1]], &rows.value[w[0]..w[1]]);
            let mut sum = 0.0;
            for k in 0..indices.len().min(entries.len()) {
                sum += entries[k] * x[indices[k] as usize];
            }
            value.push(sum);
        }
        let sides = self.sides.iter();
        sides.map(|k| k.sign * value[k.variable]).collect()
    }

    /// Σ t·g over the sides.
    fn against(&self, t: &[f64]) -> Vec<f64> {
        let rows = &self.program.rows;
        let mut price = vec![0.0; self.program.n + self.program.m];
        for (k, t) in self.sides.iter().zip(t) {
            price[k.variable] += k.sign * t;
        }
        let price_rows = price.split_off(self.program.n);
        let mut out = price;
        for (w, y) in rows.start.windows(2).zip(&price_rows) {
            let (indices, entries) = (&rows.index[w[0]..w[1]], &rows.value[w[0]..w[1]]);
            for k in 0..indices.len().min(entries.len()) {
                out[indices[k] as usize] += entries[k] * y;
            }
        }
        out
    }

    /// Factorises Σ w·g·gᵀ over the sides.
    fn factorise(&mut self, weights: &[f64]) {
        let p = self.program;
        let mut weight = vec![0.0; p.n + p.m];
        for (k, w) in self.sides.iter().zip(weights) {
            weight[k.variable] += w;
        }
        self.factor.value.fill(0.0);
        for (&at, w) in self.diagonal.iter().zip(&weight) {
            self.factor.value[at as usize] += w;
        }
        for (i, w) in weight[p.n..].iter().enumerate() {
            if *w != 0.0 {
                for &(at, v) in &self.pairs[self.pair_start[i]..self.pair_start[i + 1]] {
                    self.factor.value[at as usize] += w * v;
                }
            }
        }
        self.factor.factorise();
    }

    /// Mehrotra's start: the least squares of both sides, moved inside.
    fn begin(&mut self) {
        let ones = vec![1.0; self.sides.len()];
        self.factorise(&ones);
        let h: Vec<f64> = self.sides.iter().map(|k| k.h).collect();
        let mut x = self.against(&h);
        self.factor.solve(&mut x);
        self.s = self.along(&x);
        for (s, h) in self.s.iter_mut().zip(&h) {
            *s -= h;
        }
        let mut y = self.program.cost.clone();
        self.factor.solve(&mut y);
        self.z = self.along(&y);
        self.x = x;
        let lift = |v: &mut [f64]| {
            let least = v.iter().copied().fold(f64::INFINITY, f64::min);
            let by = (-1.5 * least).max(0.0);
            v.iter_mut().for_each(|v| *v += by);
        };
        lift(&mut self.s);
        lift(&mut self.z);
        let dot = dot(&self.s, &self.z);
        let (sums, sumz): (f64, f64) = (self.s.iter().sum(), self.z.iter().sum());
        let (a, b) = (WIDE * 0.5 * dot / sumz, WIDE * 0.5 * dot / sums);
        // Something is needed even where all of one kind is zero.
        let some = |v: f64| if v > 1e-12 && v < 1e30 { v } else { 1e-2 };
        self.s.iter_mut().for_each(|v| *v += some(a));
        self.z.iter_mut().for_each(|v| *v += some(b));
    }

    /// Runs until the gap is at most `gap` and both residuals are nothing. True where it got so far.
    pub(crate) fn run(&mut self, gap: impl Fn(f64) -> f64, budget: &Budget) -> bool {
        let p = self.program;
        let count = self.sides.len() as f64;
        if self.sides.is_empty() {
            return false;
        }
        let norm = |v: &[f64]| v.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let h: Vec<f64> = self.sides.iter().map(|k| k.h).collect();
        let (size_h, size_c) = (1.0 + norm(&h), 1.0 + norm(&p.cost));
        self.begin();
        while self.steps < STEPS && budget.check().is_ok() {
            budget.report(Stage::Interior, self.steps);
            let along = self.along(&self.x);
            let rp: Vec<f64> = (0..h.len()).map(|k| h[k] - along[k] + self.s[k]).collect();
            let mut rd = self.against(&self.z);
            for (r, c) in rd.iter_mut().zip(&p.cost) {
                *r = c - *r;
            }
            let product = dot(&self.s, &self.z);
            let objective = dot(&p.cost, &self.x);
            if !product.is_finite() || !objective.is_finite() {
                return false;
            }
            let met = norm(&rp) <= EXACT * size_h && norm(&rd) <= EXACT * size_c;
            if met && product <= gap(objective) {
                return true;
            }
            self.steps += 1;
            let mu = product / count;
            let weights = self.weights();
            self.factorise(&weights);
            let affine: Vec<f64> = self.s.iter().zip(&self.z).map(|(s, z)| -s * z).collect();
            let (_, ds, dz) = self.step(&weights, &affine, &rp, &rd);
            let (a, b) = (reach(&self.s, &ds), reach(&self.z, &dz));
            let ahead: f64 = (0..h.len())
                .map(|k| (self.s[k] + a * ds[k]) * (self.z[k] + b * dz[k]))
                .sum();
            // Not far below what is wanted: there is no room left there.
            let aim = ((ahead / product).powi(3) * mu).max(0.4 * gap(objective) / count);
            let mut products: Vec<f64> = (0..h.len())
                .map(|k| aim - self.s[k] * self.z[k] - ds[k] * dz[k])
                .collect();
            let (mut dx, mut ds, mut dz) = self.step(&weights, &products, &rp, &rd);
            let (mut a, mut b) = (reach(&self.s, &ds).min(1.0), reach(&self.z, &dz).min(1.0));
            for _ in 0..CORRECTIONS {
                if a.min(b) > 0.95 {
                    break;
                }
                let farther = |v: f64| (1.08 * v + 0.18).min(1.0);
                let (c, d) = (farther(a), farther(b));
                for (k, v) in products.iter_mut().enumerate() {
                    let there = (self.s[k] + c * ds[k]) * (self.z[k] + d * dz[k]);
                    *v += (there.clamp(aim / STRAY, aim * STRAY) - there).max(-aim * STRAY);
                }
                let other = self.step(&weights, &products, &rp, &rd);
                let (c, d) = (
                    reach(&self.s, &other.1).min(1.0),
                    reach(&self.z, &other.2).min(1.0),
                );
                if c + d < a + b + LONGER {
                    break;
                }
                (a, b) = (c, d);
                (dx, ds, dz) = other;
            }
            let (a, b) = ((NEARLY * a).min(1.0), (NEARLY * b).min(1.0));
            if a < 1e-10 && b < 1e-10 {
                return false;
            }
            add(&mut self.x, a, &dx);
            add(&mut self.s, a, &ds);
            add(&mut self.z, b, &dz);
        }
        false
    }

    /// The directions of x, s and z for given products s·z and residuals.
    fn step(
        &self,
        weights: &[f64],
        products: &[f64],
        rp: &[f64],
        rd: &[f64],
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let t: Vec<f64> = (0..rp.len())
            .map(|k| products[k] / self.s[k] + weights[k] * rp[k])
            .collect();
        let mut dx = self.against(&t);
        for (x, r) in dx.iter_mut().zip(rd) {
            *x -= r;
        }
        self.factor.solve(&mut dx);
        let mut ds = self.along(&dx);
        let mut dz = t;
        for k in 0..rp.len() {
            dz[k] -= weights[k] * ds[k];
            ds[k] -= rp[k];
        }
        (dx, ds, dz)
    }

    fn weights(&self) -> Vec<f64> {
        self.z.iter().zip(&self.s).map(|(z, s)| z / s).collect()
    }

    /// Prices of the rows, signed.
    pub(crate) fn prices(&self) -> Vec<f64> {
        self.signed(&self.z)
    }

    fn signed(&self, t: &[f64]) -> Vec<f64> {
        let p = self.program;
        let mut y = vec![0.0; p.m];
        for (k, t) in self.sides.iter().zip(t) {
            if k.variable >= p.n {
                y[k.variable - p.n] += k.sign * t;
            }
        }
        y
    }

    /// Makes ready for [`Central::mend`], with prices as weights: the method's own, prices over
    /// slacks, differ so much that factors in doubles lose what is small among them.
    pub(crate) fn weigh_prices(&mut self) {
        let weights = self.z.clone();
        self.factorise(&weights);
    }

    /// A change of the rows' prices, small where the prices are, that lowers the columns' reduced
    /// costs by r, as well as doubles can.
    pub(crate) fn mend(&self, r: &[f64]) -> Vec<f64> {
        let mut u = r.to_vec();
        self.factor.solve(&mut u);
        let along = self.along(&u);
        let t: Vec<f64> = along.iter().zip(&self.z).map(|(a, z)| a * z).collect();
        self.signed(&t)
    }

    /// A change of the point that brings its slacks to those of the method, as nearly as can be
    /// where slacks are small. `room` is how far columns and rows truly are from
    /// their lower and upper bounds.
    pub(crate) fn mend_point(&mut self, room: &[[f64; 2]]) -> Vec<f64> {
        let weights = self.weights();
        self.factorise(&weights);
        let short = self
            .sides
            .iter()
            .zip(&self.s)
            .map(|(k, s)| s - room[k.variable][usize::from(k.sign < 0.0)]);
        let t: Vec<f64> = short.zip(&weights).map(|(d, w)| d * w).collect();
        let mut u = self.against(&t);
        self.factor.solve(&mut u);
        u
    }

    /// Memory taken.
    pub(crate) fn bytes(&self) -> u64 {
        (16 * self.pairs.len() + 64 * self.sides.len()) as u64 + self.factor.bytes()
    }

    /// The order of elimination, which the proof can use too.
    pub(crate) fn order(&self) -> &[u32] {
        self.factor.order()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(v: &mut [f64], by: f64, d: &[f64]) {
    for (v, d) in v.iter_mut().zip(d) {
        *v += by * d;
    }
}

/// How far a direction can be followed before a component is zero; at most a very long way.
fn reach(v: &[f64], d: &[f64]) -> f64 {
    let ends = v.iter().zip(d).filter(|(_, d)| **d < 0.0);
    ends.map(|(v, d)| -v / d).fold(1e10, f64::min)
}
