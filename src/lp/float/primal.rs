//! The bounded primal simplex method in doubles from a feasible basis: reference-framework
//! pricing, Harris's two-pass ratio test, widened bounds when it stalls.

use super::engine::{Ending, Engine, PIVOT};
use crate::lp::basis::Status;
use crate::lp::budget::{Budget, Exhausted, Stage};

/// Infeasibility at which the method has lost its way.
const LOST: f64 = 1e-2;
/// Factor by which the weight of a column may fall short of its true length squared.
const UNDERRATED: f64 = 100.0;

impl Engine<'_> {
    /// Runs until no reduced cost is attractive.
    pub(crate) fn primal(&mut self, budget: &Budget) -> Result<Ending, Exhausted> {
        let p = self.program;
        let total = p.n + p.m;
        let mut weights = vec![1.0f64; total];
        let mut alpha = vec![0.0; total];
        let mut touched: Vec<u32> = Vec::new();
        let mut banned = vec![false; total];
        let mut any_banned = false;
        let mut count = 0u64;
        let (mut stalled, mut perturbed) = (0, false);
        loop {
            if self.stale() {
                self.refactor();
                self.compute_values();
                self.compute_reduced();
                budget.check()?;
                budget.report(Stage::Simplex, self.iterations);
                if self.infeasibility() > LOST {
                    return Ok(Ending::Optimal); // the dual method's turn
                }
            }
            if stalled > 20 && !perturbed {
                self.perturb_bounds();
                perturbed = true;
            }
            count += 1;
            if count > 20 * (total as u64 + 1000) || self.iterations > self.most {
                return Ok(Ending::Stuck);
            }
            let mut best = 0.0;
            let mut entering = None;
            for v in 0..total {
                if self.attractive(v) && !banned[v] {
                    let score = self.d[v] * self.d[v] / weights[v];
                    if score > best {
                        best = score;
                        entering = Some(v);
                    }
                }
            }
            let Some(q) = entering else {
                if self.fresh() {
                    return Ok(if any_banned {
                        Ending::Stuck
                    } else {
                        Ending::Optimal
                    });
                }
                self.refactor();
                self.compute_values();
                self.compute_reduced();
                banned.iter_mut().for_each(|b| *b = false);
                any_banned = false;
                if (0..total).any(|v| self.attractive(v)) {
                    continue;
                }
                return Ok(Ending::Optimal);
            };
            let sign = if self.d[q] < 0.0 { 1.0 } else { -1.0 };
            let column = self.column(q);
            // A weight that turns out far too small would let an ill-conditioned column in.
            let length = 1.0 + column.iter().map(|a| a * a).sum::<f64>();
            if length > UNDERRATED * weights[q] {
                weights[q] = length;
                continue;
            }
            // First pass: the longest step that stays within the tolerance.
            let slack = |v: usize, rate: f64| {
                let room = if rate > 0.0 {
                    self.upper[v] - self.x[v]
                } else {
                    self.x[v] - self.lower[v]
                };
                room.max(-self.tolerance)
            };
            let mut limit = f64::INFINITY;
            for (k, &v) in self.head.iter().enumerate() {
                let rate = -sign * column[k];
                if rate.abs() > PIVOT * 1e-1 {
                    limit = limit.min((slack(v, rate) + self.tolerance) / rate.abs());
                }
            }
            // Second pass: the largest pivot among those that block before that.
            let mut chosen: Option<(usize, f64)> = None;
            if limit < f64::INFINITY {
                let mut size = 0.0;
                for (k, &v) in self.head.iter().enumerate() {
                    let rate = -sign * column[k];
                    if rate.abs() > PIVOT * 1e-1 && rate.abs() > size {
                        let t = slack(v, rate).max(0.0) / rate.abs();
                        if t <= limit {
                            size = rate.abs();
                            chosen = Some((k, t));
                        }
                    }
                }
            }
            let width = self.upper[q] - self.lower[q];
            let step = chosen.map_or(f64::INFINITY, |c| c.1);
            if width <= step && width < f64::INFINITY {
                for (k, &v) in self.head.iter().enumerate() {
                    self.x[v] -= sign * width * column[k];
                }
                (self.status[q], self.x[q]) = if sign > 0.0 {
                    (Status::Upper, self.upper[q])
                } else {
                    (Status::Lower, self.lower[q])
                };
                self.iterations += 1;
                continue;
            }
            let Some((r, step)) = chosen else {
                if self.fresh() {
                    return Ok(Ending::Unbounded);
                }
                self.refactor();
                self.compute_values();
                self.compute_reduced();
                continue;
            };
            let largest = column.iter().fold(0.0f64, |m, a| m.max(a.abs()));
            if column[r].abs() < PIVOT.max(largest * 1e-9) {
                if self.fresh() {
                    banned[q] = true;
                    any_banned = true;
                } else {
                    self.refactor();
                    self.compute_values();
                    self.compute_reduced();
                }
                continue;
            }
            let rho = self.inverse_row(r);
            self.pivot_row(&rho, &mut alpha, &mut touched);
            let out = self.head[r];
            let pivot = column[r];
            if (pivot - alpha[q]).abs() > 1e-6 * (1.0 + pivot.abs()) && !self.fresh() {
                self.refactor();
                self.compute_values();
                self.compute_reduced();
                continue;
            }
            let dual_step = self.d[q] / pivot;
            let reference = weights[q].max(1.0);
            for &v in &touched {
                let j = v as usize;
                if self.status[j] == Status::Basic {
                    continue;
                }
                self.d[j] -= dual_step * alpha[j];
                let ratio = alpha[j] / pivot;
                weights[j] = weights[j].max(ratio * ratio * reference);
            }
            weights[out] = (reference / (pivot * pivot)).max(1.0);
            self.d[q] = 0.0;
            self.d[out] = -dual_step;
            for (k, &v) in self.head.iter().enumerate() {
                self.x[v] -= sign * step * column[k];
            }
            self.x[q] += sign * step;
            stalled = if step < 1e-12 { stalled + 1 } else { 0 };
            let rate = -sign * column[r];
            (self.status[out], self.x[out]) = if rate > 0.0 {
                (Status::Upper, self.upper[out])
            } else {
                (Status::Lower, self.lower[out])
            };
            self.exchange(r, q, &column);
        }
    }
}
