//! The bounded dual simplex method in doubles: steepest edge, a long-step ratio test that flips
//! boxed variables, Harris's tolerance, perturbed and shifted costs.
//!
//! Costs that make the start dual infeasible are shifted away; what that spoils the primal
//! method puts right afterwards. An "infeasible" found here does not depend on costs at all.

use super::engine::{Ending, Engine, PIVOT};
use crate::lp::basis::Status;
use crate::lp::budget::{Budget, Exhausted, Stage};

/// Infeasibility that is no accident of rounding.
const CLEAR: f64 = 1e-6;

impl Engine<'_> {
    /// Makes the working costs dual feasible: boxed variables move to their other bound, the
    /// costs of the others are shifted, and all are perturbed if asked.
    fn make_dual_feasible(&mut self, perturb: bool) {
        for v in 0..self.status.len() {
            let boxed = self.lower[v] > f64::NEG_INFINITY && self.upper[v] < f64::INFINITY;
            if self.status[v] == Status::Basic || self.lower[v] == self.upper[v] {
                continue;
            }
            if boxed {
                if self.d[v] > self.tolerance {
                    self.status[v] = Status::Lower;
                } else if self.d[v] < -self.tolerance {
                    self.status[v] = Status::Upper;
                }
            }
            let size = if perturb {
                let random = 0.5 + self.next_random() * 0.5;
                (1.0 + self.cost[v].abs()) * random * 1e-6
            } else {
                0.0
            };
            let shift = match self.status[v] {
                Status::Lower => (-self.d[v]).max(0.0) + size,
                Status::Upper => (-self.d[v]).min(0.0) - size,
                _ => -self.d[v],
            };
            self.cost[v] += shift;
            self.d[v] += shift;
        }
    }

    /// Runs until primal feasible (`Optimal` for the working costs) or shown infeasible.
    pub(crate) fn dual(&mut self, budget: &Budget, perturb: bool) -> Result<Ending, Exhausted> {
        let p = self.program;
        let total = p.n + p.m;
        self.make_dual_feasible(perturb);
        self.compute_values();
        let mut weights = vec![1.0f64; p.m];
        let mut alpha = vec![0.0; total];
        let mut touched: Vec<u32> = Vec::new();
        let mut candidates: Vec<u32> = Vec::new();
        let mut flips: Vec<u32> = Vec::new();
        let mut troubles = 0;
        let mut skipped: Vec<bool> = vec![false; p.m];
        let mut count = 0u64;
        loop {
            if self.stale() {
                self.refactor();
                self.compute_values();
                self.compute_reduced();
                budget.check()?;
                budget.report(Stage::Simplex, self.iterations);
            }
            count += 1;
            if count > 50 * (total as u64 + 1000) || self.iterations > self.most {
                return Ok(Ending::Stuck);
            }
            // Leaving: largest infeasibility by steepest edge.
            let mut best = 0.0;
            let mut leaving = None;
            for (k, &v) in self.head.iter().enumerate() {
                let e = self.excess(v);
                if e.abs() > self.tolerance && !skipped[k] {
                    let score = e * e / weights[k];
                    if score > best {
                        best = score;
                        leaving = Some((k, e));
                    }
                }
            }
            let Some((r, mut excess)) = leaving else {
                if self.fresh() {
                    return Ok(Ending::Optimal);
                }
                self.refactor();
                self.compute_values();
                self.compute_reduced();
                if self.infeasibility() == 0.0 || skipped.contains(&true) {
                    return Ok(Ending::Optimal);
                }
                continue;
            };
            let out = self.head[r];
            let rho = self.inverse_row(r);
            self.pivot_row(&rho, &mut alpha, &mut touched);
            let side = excess.signum();
            // Entering: breakpoints in order, boxed ones flipped while the slope lasts.
            candidates.clear();
            for &v in &touched {
                let j = v as usize;
                if self.status[j] == Status::Basic || self.lower[j] == self.upper[j] {
                    continue;
                }
                let a = side * alpha[j];
                let blocks = match self.status[j] {
                    Status::Lower => a > PIVOT * 1e-2,
                    Status::Upper => a < -PIVOT * 1e-2,
                    _ => a.abs() > PIVOT * 1e-2,
                };
                if blocks {
                    candidates.push(v);
                }
            }
            flips.clear();
            let mut slope = excess.abs();
            let mut entering: Option<usize> = None;
            while !candidates.is_empty() {
                let limit = candidates.iter().fold(f64::INFINITY, |t, &v| {
                    let j = v as usize;
                    t.min((self.d[j].abs() + self.tolerance) / alpha[j].abs())
                });
                let mut group_slope = 0.0;
                let mut pick: Option<usize> = None;
                for &v in &candidates {
                    let j = v as usize;
                    if self.ratio(j, alpha[j], side) <= limit {
                        group_slope += alpha[j].abs() * (self.upper[j] - self.lower[j]);
                        if pick.is_none_or(|b| alpha[j].abs() > alpha[b].abs()) {
                            pick = Some(j);
                        }
                    }
                }
                if pick.is_some() {
                    entering = pick;
                }
                if slope - group_slope < 0.0 || pick.is_none() {
                    break;
                }
                slope -= group_slope;
                let before = candidates.len();
                let engine = &*self;
                candidates.retain(|&v| {
                    let j = v as usize;
                    let keep = engine.ratio(j, alpha[j], side) > limit;
                    if !keep {
                        flips.push(v);
                    }
                    keep
                });
                if candidates.len() == before {
                    break;
                }
            }
            let Some(q) = entering else {
                if !self.fresh() {
                    self.refactor();
                    self.compute_values();
                    self.compute_reduced();
                    continue;
                }
                if excess.abs() > CLEAR {
                    self.blame = Some(out);
                    return Ok(Ending::Infeasible);
                }
                skipped[r] = true; // too little to tell: exact arithmetic will
                continue;
            };
            // If everything could be flipped without ending the slope, the row is infeasible.
            if candidates.is_empty() && slope > self.tolerance && flips.contains(&(q as u32)) {
                if !self.fresh() {
                    self.refactor();
                    self.compute_values();
                    self.compute_reduced();
                    continue;
                }
                if slope > CLEAR {
                    self.blame = Some(out);
                    return Ok(Ending::Infeasible);
                }
                skipped[r] = true;
                continue;
            }
            flips.retain(|&v| v as usize != q);
            let column = self.column(q);
            let pivot = column[r];
            let off = (pivot - alpha[q]).abs() / (1.0 + pivot.abs());
            if pivot.abs() < PIVOT || off > 1e-6 {
                troubles += 1;
                if troubles > 200 {
                    return Ok(Ending::Stuck);
                }
                if !self.fresh() {
                    self.refactor();
                    self.compute_values();
                    self.compute_reduced();
                    continue;
                }
                // Unreliable even with fresh factors: leave this row alone for a while.
                skipped[r] = true;
                continue;
            }
            if !flips.is_empty() {
                let mut b = vec![0.0; p.m];
                for &v in &flips {
                    let j = v as usize;
                    let (to, place) = match self.status[j] {
                        Status::Lower => (self.upper[j], Status::Upper),
                        _ => (self.lower[j], Status::Lower),
                    };
                    let change = to - self.x[j];
                    self.x[j] = to;
                    self.status[j] = place;
                    p.each(j, |i, a| b[i] += a * change);
                }
                self.ftran(&mut b);
                for (k, &v) in self.head.iter().enumerate() {
                    self.x[v] -= b[k];
                }
                excess = self.x[out]
                    - if side > 0.0 {
                        self.upper[out]
                    } else {
                        self.lower[out]
                    };
            }
            // Dual step; a wrong sign left by the tolerance is shifted into the costs.
            let mut step = self.d[q] / alpha[q];
            if step * side < 0.0 {
                self.cost[q] -= self.d[q];
                self.d[q] = 0.0;
                step = 0.0;
            }
            for &v in &touched {
                let j = v as usize;
                if self.status[j] == Status::Basic {
                    continue;
                }
                self.d[j] -= step * alpha[j];
                let wrong = match self.status[j] {
                    _ if self.lower[j] == self.upper[j] => false,
                    Status::Lower => self.d[j] < -self.tolerance,
                    Status::Upper => self.d[j] > self.tolerance,
                    _ => false,
                };
                if wrong {
                    self.cost[j] -= self.d[j];
                    self.d[j] = 0.0;
                }
            }
            self.d[q] = 0.0;
            self.d[out] = -step;
            // Weights.
            let mut tau = rho;
            let own = tau.iter().map(|v| v * v).sum::<f64>();
            self.ftran(&mut tau);
            for k in 0..p.m {
                if k != r && column[k] != 0.0 {
                    let ratio = column[k] / pivot;
                    let w = weights[k] - 2.0 * ratio * tau[k] + ratio * ratio * own;
                    weights[k] = w.max(1e-4 + ratio * ratio);
                }
            }
            weights[r] = (own / (pivot * pivot)).max(1e-4);
            skipped[r] = false;
            // Primal step.
            let move_by = excess / pivot;
            for (k, &v) in self.head.iter().enumerate() {
                self.x[v] -= move_by * column[k];
            }
            self.x[q] += move_by;
            if side > 0.0 {
                self.status[out] = Status::Upper;
                self.x[out] = self.upper[out];
            } else {
                self.status[out] = Status::Lower;
                self.x[out] = self.lower[out];
            }
            self.exchange(r, q, &column);
        }
    }

    /// Length of the dual step at which a candidate's reduced cost vanishes.
    fn ratio(&self, j: usize, alpha: f64, side: f64) -> f64 {
        let a = side * alpha;
        let d = match self.status[j] {
            Status::Zero => 0.0,
            _ => self.d[j],
        };
        (d / a).max(0.0)
    }
}
