//! A basis from an interior point, for programs where simplex methods take too long.
//!
//! The interior-point method is run on the program with its costs and bounds perturbed at random,
//! so that optimum and prices are unique and each variable is clearly at a bound or clearly not:
//! the ratio of its distance from the bound to its reduced cost tells. The m variables of largest
//! ratio are (nearly) the optimal basis of the perturbed program, and a good start for the true one.

use super::engine::{Engine, rest};
use super::program::Program;
use crate::lp::basis::Status;
use crate::lp::budget::{Budget, Stage};
use crate::lp::digits::ldexp;
use crate::lp::field::Double;
use crate::lp::lu::factorise;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

/// Size of the perturbations, relative.
const COST_NOISE: f64 = 1e-5;
const BOUND_NOISE: f64 = 1e-6;
/// Rounds in which dependent columns of the first basis are replaced.
const REPLACEMENTS: usize = 12;
/// A pivot below this makes a column one that depends on the others.
const DEPENDENT: f64 = 1e-7;

/// For every variable of `direct` how clearly it is off its bounds at the optimum. Where the noise
/// made the program unbounded, which it can by way of free columns, it is done without.
pub(crate) fn weights(direct: &Program, budget: &Budget) -> Option<Vec<f64>> {
    let unbounded = |s: &Option<SolverStatus>| *s == Some(SolverStatus::DualInfeasible);
    match weights_with(direct, 1.0, budget) {
        Err(status) if unbounded(&status) => weights_with(direct, 0.0, budget).ok(),
        other => other.ok(),
    }
}

/// The same with a share of the noise, or the status with which the solver failed.
fn weights_with(
    direct: &Program,
    noise: f64,
    budget: &Budget,
) -> Result<Vec<f64>, Option<SolverStatus>> {
    budget.report(Stage::Interior, 0);
    let p = direct;
    let total = p.n + p.m;
    let mut random = Engine::slack(p);
    // The solver takes sizes about 1 for granted, as the noise does; powers of two change no order
    // of the ratios.
    let ends = p.lower.iter().chain(&p.upper).copied();
    let length = unit(ends.filter(|b| b.is_finite()));
    let price = unit(p.cost.iter().copied());
    // One constraint row a finite bound; equations first. (variable, sign, right-hand side)
    let mut equations = Vec::new();
    let mut sides = Vec::new();
    for v in 0..total {
        let (l, u) = (p.lower[v], p.upper[v]);
        let mut slack =
            |b: f64| noise * BOUND_NOISE * random.next_random() * (1.0 / length + b.abs());
        if l == u {
            equations.push((v, 1.0, u));
            continue;
        }
        if u < f64::INFINITY {
            sides.push((v, 1.0, u + slack(u)));
        }
        if l > f64::NEG_INFINITY {
            sides.push((v, -1.0, -l + slack(l)));
        }
    }
    let rows: Vec<(usize, f64, f64)> = equations.iter().chain(&sides).copied().collect();
    let mut lists: Vec<Vec<(usize, f64)>> = vec![Vec::new(); p.n];
    for (k, &(v, sign, _)) in rows.iter().enumerate() {
        if v < p.n {
            lists[v].push((k, sign));
        } else {
            for (j, a) in p.rows.line(v - p.n) {
                lists[j].push((k, sign * a));
            }
        }
    }
    let (mut start, mut index, mut value) = (vec![0], Vec::new(), Vec::new());
    for list in &lists {
        for &(k, a) in list {
            index.push(k);
            value.push(a);
        }
        start.push(index.len());
    }
    let largest = p.cost.iter().fold(0.0f64, |m, c| m.max(c.abs())).max(1e-6);
    let cost = p.cost.iter().enumerate().map(|(j, c)| {
        // Where a column has one bound only, the noise must not lure it away from there: that can
        // make a bounded program unbounded.
        let share = match (p.lower[j] > f64::NEG_INFINITY, p.upper[j] < f64::INFINITY) {
            (true, false) => random.next_random(),
            (false, true) => -random.next_random(),
            _ => 2.0 * random.next_random() - 1.0,
        };
        c + noise * COST_NOISE * largest * share
    });
    let cost: Vec<f64> = cost.map(|c| c * price).collect();
    let a = CscMatrix::new(rows.len(), p.n, start, index, value);
    let b: Vec<f64> = rows.iter().map(|r| r.2 * length).collect();
    let cones = [
        SupportedConeT::ZeroConeT(equations.len()),
        SupportedConeT::NonnegativeConeT(sides.len()),
    ];
    let seconds = budget
        .left()
        .map_or(f64::INFINITY, |t| t.as_secs_f64() / 1.5);
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .time_limit(seconds)
        .tol_gap_abs(1e-12)
        .tol_gap_rel(1e-12)
        .tol_feas(1e-10)
        .max_iter(200)
        .build()
        .map_err(|_| None)?;
    let quadratic = CscMatrix::zeros((p.n, p.n));
    let mut solver =
        DefaultSolver::new(&quadratic, &cost, &a, &b, &cones, settings).map_err(|_| None)?;
    solver.solve();
    let usable = matches!(
        solver.solution.status,
        SolverStatus::Solved
            | SolverStatus::AlmostSolved
            | SolverStatus::InsufficientProgress
            | SolverStatus::MaxIterations
            | SolverStatus::NumericalError
    );
    if !usable {
        return Err(Some(solver.solution.status));
    }
    // Distance over price, the smaller of the two sides.
    let mut out = vec![f64::INFINITY; total];
    for (k, &(v, _, _)) in rows.iter().enumerate() {
        let ratio = if k < equations.len() {
            0.0
        } else {
            let s = solver.solution.s[k].max(1e-300);
            s / solver.solution.z[k].max(1e-300)
        };
        out[v] = out[v].min(ratio);
    }
    Ok(out)
}

/// The power of two that brings numbers to 1 in the geometric mean, those that are zero apart.
fn unit(numbers: impl Iterator<Item = f64>) -> f64 {
    let exponents = numbers
        .filter(|v| *v != 0.0)
        .map(|v| v.abs().log2().ceil() as i64);
    ldexp(1.0, super::program::centre(exponents, 0))
}

/// Statuses with the m heaviest variables of `program` basic; `weights` are those of `direct`,
/// of which `program` may be the dual.
pub(crate) fn heaviest(program: &Program, weights: &[f64]) -> Vec<Status> {
    let total = program.n + program.m;
    let weight: Vec<f64> = if program.dualised {
        // Our column i is the logical of row i there, our logical j the column j: turned round.
        let there = |v: usize| {
            if v < program.n {
                weights[program.m + v]
            } else {
                weights[v - program.n]
            }
        };
        (0..total).map(|v| 1.0 / there(v).max(1e-300)).collect()
    } else {
        weights.to_vec()
    };
    let mut order: Vec<usize> = (0..total).collect();
    order.sort_by(|&a, &b| weight[b].total_cmp(&weight[a]).then(a.cmp(&b)));
    let mut status: Vec<Status> = (0..total)
        .map(|v| rest(program.lower[v], program.upper[v]))
        .collect();
    for v in independent(program, &order) {
        status[v] = Status::Basic;
    }
    status
}

/// Nearly the first m of an order that are linearly independent: those that depend on the others
/// make room for the next ones. (Columns that are made to fit the rows left over instead give
/// ill-conditioned bases, worse than the logicals that stand in for what is still missing.)
fn independent(program: &Program, order: &[usize]) -> Vec<usize> {
    let (first, mut rest) = order.split_at(program.m);
    let mut chosen = first.to_vec();
    for _ in 0..REPLACEMENTS {
        let columns: Vec<Vec<(u32, f64)>> = chosen
            .iter()
            .map(|&v| {
                let mut c = Vec::new();
                program.each(v, |i, a| c.push((i as u32, a)));
                c
            })
            .collect();
        let Err(left) = factorise(&Double, &columns, 0.1, DEPENDENT) else {
            break;
        };
        let count = left.columns.len().min(rest.len());
        for (&k, &v) in left.columns.iter().zip(rest) {
            chosen[k as usize] = v;
        }
        rest = &rest[count..];
    }
    chosen
}
