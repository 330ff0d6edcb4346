//! The program in doubles, scaled by powers of two, possibly turned into its dual.
//!
//! Scaling alternates the geometric mean of rows and of columns, in exponents, so numbers far
//! outside the range of doubles come in as well. A program with far more rows than columns whose
//! rows and columns are all one-sided, free or equations is dualised: its basis has the size of
//! the smaller side, and a basis of the one is the complement of a basis of the other.

use crate::lp::basis::{Basis, Status};
use crate::lp::digits::{ldexp, mantissa};
use crate::lp::problem::Problem;

/// Compressed lines of doubles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sparse {
    pub(crate) start: Vec<usize>,
    pub(crate) index: Vec<u32>,
    pub(crate) value: Vec<f64>,
}

impl Sparse {
    pub(crate) fn line(&self, k: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let span = self.start[k]..self.start[k + 1];
        self.index[span.clone()]
            .iter()
            .map(|&i| i as usize)
            .zip(self.value[span].iter().copied())
    }

    pub(crate) fn transposed(&self, lines: usize) -> Sparse {
        let mut start = vec![0usize; lines + 1];
        for &i in &self.index {
            start[i as usize + 1] += 1;
        }
        for k in 0..lines {
            start[k + 1] += start[k];
        }
        let mut at = start.clone();
        let mut index = vec![0; self.index.len()];
        let mut value = vec![0.0; self.index.len()];
        for k in 0..self.start.len() - 1 {
            for (i, v) in self.line(k) {
                index[at[i]] = k as u32;
                value[at[i]] = v;
                at[i] += 1;
            }
        }
        Sparse {
            start,
            index,
            value,
        }
    }
}

/// Minimise cost·x subject to A·x − s = 0 and bounds on (x, s); logicals after the columns.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(crate) n: usize,
    pub(crate) m: usize,
    pub(crate) columns: Sparse,
    pub(crate) rows: Sparse,
    /// Of the columns; where there are more, of the logicals too.
    pub(crate) cost: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    /// Powers of two by which columns and rows are scaled; those of the problem it is the dual of.
    pub(crate) exponents: Vec<i64>,
    /// Powers of two by which all bounds are multiplied, and all costs, so that their sizes are
    /// about 1, which the tolerances take for granted; those of the problem it is the dual of.
    pub(crate) bound_shift: i64,
    pub(crate) cost_shift: i64,
    /// Whether this is the dual of the problem it was made from.
    pub(crate) dualised: bool,
}

impl Program {
    /// The problem itself, scaled.
    pub(crate) fn new(p: &Problem) -> Program {
        let parts: Vec<(f64, i64)> = (0..p.columns.index.len())
            .map(|e| mantissa(&p.columns.int(e)))
            .collect();
        let mut exponents = vec![0i64; p.n + p.m];
        for _ in 0..4 {
            for (lines, matrix, other) in [(p.m, &p.rows, 0), (p.n, &p.columns, p.n)] {
                let own = if other == 0 { p.n } else { 0 };
                // Entries of a row lie elsewhere in `parts`, so their exponent is taken anew.
                for k in 0..lines {
                    let (mut low, mut high) = (i64::MAX, i64::MIN);
                    for e in matrix.span(k) {
                        let size = if other == 0 {
                            mantissa_exponent(matrix, e)
                        } else {
                            parts[e].1
                        };
                        let size = size + exponents[other + matrix.index[e] as usize];
                        low = low.min(size);
                        high = high.max(size);
                    }
                    if low <= high {
                        exponents[own + k] = -(low + high).div_euclid(2);
                    }
                }
            }
        }
        let mut columns = Sparse {
            start: p.columns.start.clone(),
            index: p.columns.index.clone(),
            value: Vec::with_capacity(parts.len()),
        };
        for j in 0..p.n {
            for e in p.columns.span(j) {
                let (v, x) = parts[e];
                let row = p.columns.index[e] as usize;
                columns
                    .value
                    .push(ldexp(v, x + exponents[j] + exponents[p.n + row]));
            }
        }
        let (bound, bound_exponent) = mantissa(&p.bound_scale);
        let (scale, scale_exponent) = mantissa(&p.cost_scale.abs());
        let place = |k: usize| if k < p.n { -exponents[k] } else { exponents[k] };
        let both = || (0..p.n + p.m).flat_map(|k| [(k, &p.lower[k]), (k, &p.upper[k])]);
        let bound_shift = centre(
            both().filter_map(|(k, v)| {
                let v = v.as_ref().filter(|v| !v.is_zero())?;
                Some(v.bits() as i64 - bound_exponent + place(k))
            }),
            NEAR,
        );
        let cost_shift = centre(
            (0..p.n).filter_map(|j| {
                let c = Some(&p.cost[j]).filter(|c| !c.is_zero())?;
                Some(c.bits() as i64 - scale_exponent + exponents[j])
            }),
            NEAR,
        );
        let limit = |v: &Option<crate::number::Int>, k: usize, infinite: f64| match v {
            None => infinite,
            Some(v) => {
                let (a, x) = mantissa(v);
                ldexp(a / bound, x - bound_exponent + place(k) + bound_shift)
            }
        };
        let lower = (0..p.n + p.m).map(|k| limit(&p.lower[k], k, f64::NEG_INFINITY));
        let upper = (0..p.n + p.m).map(|k| limit(&p.upper[k], k, f64::INFINITY));
        let (lower, upper) = (lower.collect(), upper.collect());
        let cost = (0..p.n).map(|j| {
            let (a, x) = mantissa(&p.cost[j]);
            ldexp(a / scale, x - scale_exponent + exponents[j] + cost_shift)
        });
        let cost: Vec<f64> = cost.collect();
        Program {
            n: p.n,
            m: p.m,
            rows: columns.transposed(p.m),
            columns,
            cost,
            lower,
            upper,
            exponents,
            bound_shift,
            cost_shift,
            dualised: false,
        }
    }

    /// The dual, where it is worth while and simple: rows and columns one-sided, free or fixed
    /// at zero activity's right-hand side.
    pub(crate) fn dual(&self) -> Option<Program> {
        let simple = |k: usize| {
            let (l, u) = (self.lower[k], self.upper[k]);
            l == u || l == f64::NEG_INFINITY || u == f64::INFINITY
        };
        if self.m < 2 * self.n || !(0..self.n + self.m).all(simple) {
            return None;
        }
        // A column with a finite bound would need a shift; only 0 and free are taken.
        let zero_or_free = |j: usize| {
            let (l, u) = (self.lower[j], self.upper[j]);
            (l == f64::NEG_INFINITY || l == 0.0) && (u == f64::INFINITY || u == 0.0)
        };
        if !(0..self.n).all(zero_or_free) {
            return None;
        }
        // Minimise −b·y subject to Aᵀy = c − d: y free on equations, signed on inequalities.
        let sign = |l: f64, u: f64| {
            if l == u {
                (f64::NEG_INFINITY, f64::INFINITY)
            } else if l > f64::NEG_INFINITY {
                (0.0, f64::INFINITY)
            } else if u < f64::INFINITY {
                (f64::NEG_INFINITY, 0.0)
            } else {
                (0.0, 0.0)
            }
        };
        let (n, m) = (self.m, self.n);
        let mut lower = Vec::with_capacity(n + m);
        let mut upper = Vec::with_capacity(n + m);
        let mut cost = Vec::with_capacity(n);
        for i in 0..n {
            let (l, u) = (self.lower[self.n + i], self.upper[self.n + i]);
            let (a, b) = sign(l, u);
            lower.push(a);
            upper.push(b);
            let rhs = if l > f64::NEG_INFINITY { l } else { u };
            cost.push(if rhs.is_finite() { -rhs } else { 0.0 });
        }
        for j in 0..m {
            // aⱼ·y = cⱼ − dⱼ with dⱼ ≥ 0 at a lower bound.
            let (a, b) = sign(self.lower[j], self.upper[j]);
            lower.push(self.cost[j] - b);
            upper.push(self.cost[j] - a);
        }
        Some(Program {
            n,
            m,
            columns: self.rows.clone(),
            rows: self.columns.clone(),
            cost,
            lower,
            upper,
            exponents: self.exponents.clone(),
            bound_shift: self.bound_shift,
            cost_shift: self.cost_shift,
            dualised: true,
        })
    }

    /// A basis of the problem from one of this program.
    pub(crate) fn basis(&self, p: &Problem, status: &[Status]) -> Basis {
        if !self.dualised {
            return Basis {
                status: status.to_vec(),
            };
        }
        // Complement: row i is our column i, column j our logical j.
        let mut out = Vec::with_capacity(p.n + p.m);
        let flip = |s: Status, v: usize| match s {
            Status::Basic => crate::lp::basis::resting(p, v),
            _ => Status::Basic,
        };
        for j in 0..p.n {
            out.push(flip(status[self.n + j], j));
        }
        for (i, s) in status[..p.m].iter().enumerate() {
            out.push(flip(*s, p.n + i));
        }
        Basis { status: out }
    }

    /// The reverse of [`Program::basis`]: statuses of this program for a basis of the problem.
    pub(crate) fn statuses(&self, p: &Problem, basis: &Basis) -> Vec<Status> {
        if !self.dualised {
            return basis.status.clone();
        }
        let flip = |v: usize, own: usize| match basis.status[v] {
            Status::Basic => super::engine::rest(self.lower[own], self.upper[own]),
            _ => Status::Basic,
        };
        let rows = (0..p.m).map(|i| flip(p.n + i, i));
        rows.chain((0..p.n).map(|j| flip(j, self.n + j))).collect()
    }

    /// Values of the model's columns and prices of its rows, from those of this program's columns
    /// and rows.
    pub(crate) fn unscaled(&self, p: &Problem, x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (x, y): (Vec<f64>, Vec<f64>) = if self.dualised {
            (y.iter().map(|v| -v).collect(), x.to_vec())
        } else {
            (x.to_vec(), y.to_vec())
        };
        let size = |v: &crate::number::Rat| v.nearest_f64().unwrap_or(f64::NAN);
        let turn = f64::from(p.cost_scale.sign());
        let columns = x.iter().enumerate();
        let rows = y.iter().enumerate();
        (
            columns
                .map(|(j, v)| {
                    let shift = self.exponents[j] - self.bound_shift;
                    ldexp(v * size(&p.column_scale[j]), shift)
                })
                .collect(),
            rows.map(|(i, v)| {
                let shift = self.exponents[p.n + i] - self.cost_shift;
                ldexp(turn * v * size(&p.row_scale[i]), shift)
            })
            .collect(),
        )
    }

    /// Lengths on the axes of the model's columns and rows in this program's units.
    pub(crate) fn scaled_rooms(&self, p: &Problem, rooms: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let scaled = rooms.iter().enumerate().map(|(v, room)| {
            let (size, shift) = if v < p.n {
                (p.column_scale[v].recip(), -self.exponents[v])
            } else {
                (p.row_scale[v - p.n].clone(), self.exponents[v])
            };
            let size = size.nearest_f64().unwrap_or(f64::NAN);
            room.map(|r| ldexp(r * size, shift + self.bound_shift))
        });
        scaled.collect()
    }

    /// Costs of the model's columns in this program's units, and the largest of them.
    pub(crate) fn scaled_costs(&self, p: &Problem, c: &[f64]) -> (Vec<f64>, f64) {
        let turn = f64::from(p.cost_scale.sign());
        let columns = c.iter().enumerate().map(|(j, v)| {
            let size = p.column_scale[j].nearest_f64().unwrap_or(f64::NAN);
            ldexp(turn * v * size, self.exponents[j] + self.cost_shift)
        });
        let out: Vec<f64> = columns.collect();
        let size = out.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        (out, size)
    }

    /// The objective in the units of the problem, from that of this program.
    pub(crate) fn unscaled_objective(&self, value: f64) -> f64 {
        let value = if self.dualised { -value } else { value };
        ldexp(value, -self.bound_shift - self.cost_shift)
    }

    /// The column of a variable: entries of a column, or −1 for a logical.
    pub(crate) fn each(&self, v: usize, mut f: impl FnMut(usize, f64)) {
        if v < self.n {
            for (i, a) in self.columns.line(v) {
                f(i, a);
            }
        } else {
            f(v - self.n, -1.0);
        }
    }
}

/// Exponents are shifted no farther up than to this one.
const HIGHEST: i64 = 20;

/// Within this distance of 1 sizes are left as the model has them, which serves floating point
/// better than any norm.
const NEAR: i64 = 16;

/// The shift that brings numbers of these binary exponents to about 1 in the geometric mean,
/// where they are farther from there than `near`.
pub(super) fn centre(exponents: impl Iterator<Item = i64>, near: i64) -> i64 {
    let (mut sum, mut count, mut high) = (0i128, 0i128, i64::MIN);
    for e in exponents {
        sum += i128::from(e);
        count += 1;
        high = high.max(e);
    }
    if count == 0 {
        return 0;
    }
    let mean = sum.div_euclid(count) as i64;
    if mean.abs() <= near {
        return 0;
    }
    (-mean).min(HIGHEST - high)
}

fn mantissa_exponent(matrix: &crate::lp::problem::Matrix, e: usize) -> i64 {
    if matrix.limbs == 1 {
        return 64 - i64::from((matrix.words[e] as i64).unsigned_abs().leading_zeros());
    }
    matrix.int(e).bits() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lp::{Model, Range};
    use crate::number::{Int, Rat};

    /// Two rows and columns, with costs and right-hand sides in small units.
    fn program(cost_unit: u64, bound_unit: u64) -> Program {
        let small = |v: i64, k: u64| Rat::new(Int::from(v), Int::one().shl(k));
        let mut model = Model::new("small");
        for (cost, side) in [(3, 5), (-7, 11)] {
            let range = Range::at_least(small(-side, bound_unit));
            let j = model.add_column(&format!("x{side}"), small(cost, cost_unit), range);
            let i = model.add_row(&format!("r{side}"), Range::at_most(small(side, bound_unit)));
            model.set(i, j, Rat::from(cost + 10));
        }
        Program::new(&Problem::new(&model).expect("a small model"))
    }

    /// What tolerances are measured against must not depend on the units of the model, but for
    /// those that are near 1 as they are.
    #[test]
    fn units_do_not_matter() {
        let near = program(3, 5);
        assert_eq!((near.cost_shift, near.bound_shift), (0, 0));
        let plain = program(30, 30);
        for (cost, bound) in [(60, 30), (30, 90), (300, 40)] {
            let other = program(cost, bound);
            assert_eq!(plain.cost, other.cost);
            assert_eq!(plain.lower, other.lower);
            assert_eq!(plain.upper, other.upper);
            let (a, b) = (plain.unscaled_objective(1.0), other.unscaled_objective(1.0));
            assert_eq!(a, b * 2f64.powi((cost + bound - 60) as i32));
        }
    }
}
