//! A basis, and the exact vectors that belong to it.
//!
//! A basis names m of the n + m variables; the others rest at a bound (or at zero where they are
//! free). Only the rows whose logical is *not* basic and the columns that are make a system to be
//! solved, the [`Kernel`]; everything else follows from its solution by one row or column of the
//! program. [`ColumnVector`] is B⁻¹ times something (values, directions), [`RowVector`] costs
//! priced through a basis (duals and reduced costs). Both answer questions about signs.

use super::budget::{Budget, Exhausted};
use super::lift::{Kernel, Side};
use super::problem::Problem;
use super::solution::Solution;
use crate::number::Int;

/// Where a variable is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Status {
    Basic,
    Lower,
    Upper,
    /// Free and at zero.
    Zero,
}

/// The status of every variable, columns first, then logicals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Basis {
    pub(crate) status: Vec<Status>,
}

impl Basis {
    /// All logicals basic, every column at the bound nearer to zero.
    pub(crate) fn slack(problem: &Problem) -> Basis {
        let mut status: Vec<Status> = (0..problem.n).map(|j| resting(problem, j)).collect();
        status.resize(problem.n + problem.m, Status::Basic);
        Basis { status }
    }

    /// Rows and columns of the kernel.
    fn kernel_lines(&self, problem: &Problem) -> (Vec<u32>, Vec<u32>) {
        let basic = |j: usize| self.status[j] == Status::Basic;
        (
            (0..problem.m as u32)
                .filter(|&i| !basic(problem.n + i as usize))
                .collect(),
            (0..problem.n as u32)
                .filter(|&j| basic(j as usize))
                .collect(),
        )
    }

    /// Makes every resting place one that the bounds offer.
    pub(crate) fn tidy(&mut self, problem: &Problem) {
        for j in 0..self.status.len() {
            let good = match self.status[j] {
                Status::Basic => true,
                Status::Lower => problem.lower[j].is_some(),
                Status::Upper => problem.upper[j].is_some(),
                Status::Zero => problem.lower[j].is_none() && problem.upper[j].is_none(),
            };
            if !good {
                self.status[j] = resting(problem, j);
            }
        }
    }
}

/// A resting place for a variable that is not basic.
pub(crate) fn resting(problem: &Problem, j: usize) -> Status {
    match (&problem.lower[j], &problem.upper[j]) {
        (Some(l), Some(u)) if u.abs() < l.abs() => Status::Upper,
        (Some(_), _) => Status::Lower,
        (None, Some(_)) => Status::Upper,
        (None, None) => Status::Zero,
    }
}

/// A basis with its factorised kernel.
pub(crate) struct Frame<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) basis: Basis,
    pub(crate) kernel: Kernel,
    /// Local index of a column (of the kernel), of a row.
    column_place: Vec<u32>,
    row_place: Vec<u32>,
}

const NONE: u32 = u32::MAX;
/// Primes tried beyond the first before a proposed basis is taken for singular.
const PRIMES: usize = 2;

impl<'a> Frame<'a> {
    /// Factorises a basis. One that is singular modulo a few primes is repaired with logicals
    /// where it is deficient, so that the result's basis may differ; but one that is `regular`,
    /// as after an exact pivot, is tried modulo one prime after the other, of which only
    /// finitely many divide its determinant.
    pub(crate) fn new(problem: &'a Problem, mut basis: Basis, regular: bool) -> Frame<'a> {
        basis.tidy(problem);
        let mut prime = 0;
        loop {
            let (rows, columns) = basis.kernel_lines(problem);
            if rows.len() != columns.len() {
                basis = Basis::slack(problem);
                continue;
            }
            match Kernel::new(problem, rows.clone(), columns.clone(), prime) {
                Ok(kernel) => {
                    let mut column_place = vec![NONE; problem.n];
                    let mut row_place = vec![NONE; problem.m];
                    for (k, &j) in kernel.columns.iter().enumerate() {
                        column_place[j as usize] = k as u32;
                    }
                    for (k, &i) in kernel.rows.iter().enumerate() {
                        row_place[i as usize] = k as u32;
                    }
                    return Frame {
                        problem,
                        basis,
                        kernel,
                        column_place,
                        row_place,
                    };
                }
                Err(_) if regular || prime < PRIMES => prime += 1,
                Err(left) => {
                    prime = 0;
                    for k in left.columns {
                        let j = columns[k as usize] as usize;
                        basis.status[j] = resting(problem, j);
                    }
                    for k in left.rows {
                        basis.status[problem.n + rows[k as usize] as usize] = Status::Basic;
                    }
                }
            }
        }
    }

    /// The value of a variable that is not basic.
    pub(crate) fn resting_value(&self, j: usize) -> Int {
        let value = match self.basis.status[j] {
            Status::Lower => self.problem.lower[j].clone(),
            Status::Upper => self.problem.upper[j].clone(),
            _ => None,
        };
        value.unwrap_or_else(Int::zero)
    }

    /// All basic variables in order.
    pub(crate) fn basics(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.basis.status.len()).filter(|&j| self.basis.status[j] == Status::Basic)
    }

    fn solve(
        &self,
        side: Side,
        rhs: &[Int],
        guess: Option<&Int>,
        budget: &Budget,
    ) -> Result<Solution, Exhausted> {
        if self.kernel.size() == 0 {
            return Ok(Solution::empty());
        }
        self.kernel.solve(side, rhs, guess, budget)
    }

    /// The values of the basic variables.
    pub(crate) fn values(
        &self,
        guess: Option<&Int>,
        budget: &Budget,
    ) -> Result<ColumnVector, Exhausted> {
        let p = self.problem;
        let mut known = vec![Int::zero(); p.m];
        for j in 0..p.n {
            if self.basis.status[j] != Status::Basic {
                let v = self.resting_value(j);
                if !v.is_zero() {
                    for e in p.columns.span(j) {
                        known[p.columns.index[e] as usize] -= &(p.columns.int(e) * &v);
                    }
                }
            }
        }
        let rhs: Vec<Int> = self
            .kernel
            .rows
            .iter()
            .map(|&i| &self.resting_value(p.n + i as usize) + &known[i as usize])
            .collect();
        Ok(ColumnVector {
            solution: self.solve(Side::Columns, &rhs, guess, budget)?,
            constants: known,
        })
    }

    /// B⁻¹ a_q: how fast the basic variables fall as variable q rises.
    pub(crate) fn direction(
        &self,
        q: usize,
        guess: Option<&Int>,
        budget: &Budget,
    ) -> Result<ColumnVector, Exhausted> {
        let p = self.problem;
        let mut constants = vec![Int::zero(); p.m];
        if q < p.n {
            for e in p.columns.span(q) {
                constants[p.columns.index[e] as usize] = p.columns.int(e);
            }
        } else {
            constants[q - p.n] = Int::from(-1i64);
        }
        let rhs: Vec<Int> = self
            .kernel
            .rows
            .iter()
            .map(|&i| constants[i as usize].clone())
            .collect();
        Ok(ColumnVector {
            solution: self.solve(Side::Columns, &rhs, guess, budget)?,
            constants,
        })
    }

    /// Prices the given costs of the basic variables (and of all columns).
    pub(crate) fn price(
        &self,
        cost: impl Fn(usize) -> Int,
        guess: Option<&Int>,
        budget: &Budget,
    ) -> Result<RowVector, Exhausted> {
        let p = self.problem;
        let mut costs: Vec<Int> = (0..p.n).map(&cost).collect();
        let mut fixed = vec![Int::zero(); p.m];
        for (i, price) in fixed.iter_mut().enumerate() {
            if self.row_place[i] == NONE {
                let y = -cost(p.n + i);
                if !y.is_zero() {
                    for e in p.rows.span(i) {
                        costs[p.rows.index[e] as usize] -= &(p.rows.int(e) * &y);
                    }
                }
                *price = y;
            }
        }
        let rhs: Vec<Int> = self
            .kernel
            .columns
            .iter()
            .map(|&j| costs[j as usize].clone())
            .collect();
        Ok(RowVector {
            solution: self.solve(Side::Rows, &rhs, guess, budget)?,
            costs,
            fixed,
        })
    }

    /// The part of row i that lies in the kernel's columns.
    fn row_terms(&self, i: usize) -> Vec<(u32, Int)> {
        let rows = &self.problem.rows;
        rows.span(i)
            .filter_map(|e| {
                let k = self.column_place[rows.index[e] as usize];
                (k != NONE).then(|| (k, rows.int(e)))
            })
            .collect()
    }
}

/// A vector over the basic variables: component v is Σ a·x − constant over one row.
pub(crate) struct ColumnVector {
    pub(crate) solution: Solution,
    constants: Vec<Int>,
}

/// A linear question to a solution: Σ a·x − c.
pub(crate) struct Query {
    pub(crate) terms: Vec<(u32, Int)>,
    pub(crate) constant: Int,
}

impl Query {
    /// The same less a constant.
    pub(crate) fn minus(mut self, c: &Int) -> Query {
        self.constant += c;
        self
    }
}

impl ColumnVector {
    /// The component of a basic variable.
    pub(crate) fn component(&self, frame: &Frame<'_>, v: usize) -> Query {
        let n = frame.problem.n;
        if v < n {
            Query {
                terms: vec![(frame.column_place[v], Int::one())],
                constant: Int::zero(),
            }
        } else {
            Query {
                terms: frame.row_terms(v - n),
                constant: self.constants[v - n].clone(),
            }
        }
    }

    pub(crate) fn sign(&self, q: &Query) -> i32 {
        self.solution.sign(&q.terms, &q.constant)
    }

    pub(crate) fn approximate(&self, q: &Query) -> f64 {
        self.solution.approximate(&q.terms, &q.constant)
    }

    /// The same as a double and an exponent of two.
    pub(crate) fn scaled(&self, q: &Query) -> (f64, i64) {
        self.solution.scaled(&q.terms, &q.constant)
    }

    /// The exact value times the solution's denominator.
    pub(crate) fn numerator(&self, q: &Query) -> Int {
        self.solution.numerator(&q.terms, &q.constant)
    }
}

/// Duals y and reduced costs d of a basis.
pub(crate) struct RowVector {
    pub(crate) solution: Solution,
    /// Costs of the columns less what the basic logicals' rows contribute.
    costs: Vec<Int>,
    /// y in the rows whose logical is basic.
    fixed: Vec<Int>,
}

impl RowVector {
    /// The reduced cost of a variable that is not basic; for a logical that is its row's dual.
    pub(crate) fn reduced(&self, frame: &Frame<'_>, v: usize) -> Query {
        let p = frame.problem;
        if v >= p.n {
            return Query {
                terms: vec![(frame.row_place[v - p.n], Int::one())],
                constant: Int::zero(),
            };
        }
        let terms = p
            .columns
            .span(v)
            .filter_map(|e| {
                let k = frame.row_place[p.columns.index[e] as usize];
                (k != NONE).then(|| (k, -p.columns.int(e)))
            })
            .collect();
        Query {
            terms,
            constant: -&self.costs[v],
        }
    }

    pub(crate) fn sign(&self, q: &Query) -> i32 {
        self.solution.sign(&q.terms, &q.constant)
    }

    pub(crate) fn approximate(&self, q: &Query) -> f64 {
        self.solution.approximate(&q.terms, &q.constant)
    }

    pub(crate) fn numerator(&self, q: &Query) -> Int {
        self.solution.numerator(&q.terms, &q.constant)
    }

    /// y of every row times the solution's denominator.
    pub(crate) fn duals(&self, frame: &Frame<'_>) -> Vec<Int> {
        (0..frame.problem.m)
            .map(|i| match frame.row_place[i] {
                NONE => &self.fixed[i] * &self.solution.denominator,
                k => self.solution.numerator(&[(k, Int::one())], &Int::zero()),
            })
            .collect()
    }
}
