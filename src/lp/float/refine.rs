//! Iterative refinement: what floating point could not see, magnified until it can.
//!
//! At a basis that exact arithmetic found not quite optimal, the values and the reduced costs are
//! known to any accuracy. In the unknowns Δ = S·(x − x̂) the bounds are S·(l − x̂), S·(u − x̂) and
//! the costs, up to a constant, T·d̂: the same program, but violations of 10⁻¹² have become 1
//! and what is far away is farther. Its float optimum is the next basis; one such round stands
//! for as many exact pivots as there were wrong signs. (After Gleixner, Steffy & Wolter 2016,
//! with exact vertices in place of their float ones.)

use super::engine::{Ending, Engine};
use super::program::Program;
use crate::lp::basis::{Basis, ColumnVector, Frame, RowVector, Status};
use crate::lp::budget::Budget;
use crate::lp::digits::{ldexp, mantissa};
use crate::lp::problem::Problem;

/// Rounds in one solve; what is still wrong then is left to exact pivots.
const ROUNDS: usize = 12;
/// What is farther than this after magnifying is brought so near: of any larger number the
/// rounding alone would pass for a violation. If it should matter, the next round sees it.
const FAR: f64 = 1e6;

/// Proposes bases near one that is nearly optimal.
pub(crate) struct Refiner {
    direct: Option<Program>,
    rounds: usize,
    pub(crate) iterations: u64,
}

/// Doubles for the units of the scaled program.
struct Units<'a> {
    problem: &'a Problem,
    exponents: &'a [i64],
    /// Mantissas and exponents of the problem's scales over the program's.
    bound: (f64, i64),
    cost: (f64, i64),
}

impl Units<'_> {
    /// A distance on a variable's axis.
    fn length(&self, v: usize, value: f64) -> f64 {
        let e = self.exponents[v];
        let shift = if v < self.problem.n { -e } else { e };
        ldexp(value / self.bound.0, shift - self.bound.1)
    }

    /// A reduced cost of a variable.
    fn price(&self, v: usize, value: f64) -> f64 {
        let e = self.exponents[v];
        let shift = if v < self.problem.n { e } else { -e };
        ldexp(value / self.cost.0, shift - self.cost.1)
    }
}

impl Refiner {
    pub(crate) fn new() -> Refiner {
        Refiner {
            direct: None,
            rounds: 0,
            iterations: 0,
        }
    }

    /// A basis to go on from; None where refinement has nothing to offer.
    pub(crate) fn refine(
        &mut self,
        frame: &Frame<'_>,
        values: &ColumnVector,
        duals: &RowVector,
        budget: &Budget,
    ) -> Option<Basis> {
        if self.rounds >= ROUNDS {
            return None;
        }
        self.rounds += 1;
        let p = frame.problem;
        let direct = self.direct.get_or_insert_with(|| Program::new(p));
        let program = magnified(direct, frame, values, duals)?;
        let mut engine = Engine::new(&program, program.statuses(p, &frame.basis));
        engine.most = 500 + program.m as u64;
        let ending = engine.optimise(false, budget);
        self.iterations += engine.iterations;
        let basis = program.basis(p, &engine.status);
        let useful = ending == Ok(Ending::Optimal) && basis != frame.basis;
        if !useful {
            self.rounds = ROUNDS;
        }
        useful.then_some(basis)
    }
}

/// A power of two by which the largest violation becomes about 1.
fn magnification(violation: f64) -> f64 {
    if violation > 0.0 && violation < 1.0 {
        ldexp(1.0, (-violation.log2().floor() as i64).min(900))
    } else {
        1.0
    }
}

/// The program around the frame's basis.
fn magnified(
    direct: &Program,
    frame: &Frame<'_>,
    values: &ColumnVector,
    duals: &RowVector,
) -> Option<Program> {
    let p = frame.problem;
    let total = p.n + p.m;
    let (bound, cost) = (mantissa(&p.bound_scale), mantissa(&p.cost_scale.abs()));
    let units = Units {
        problem: p,
        exponents: &direct.exponents,
        bound: (bound.0, bound.1 - direct.bound_shift),
        cost: (cost.0, cost.1 - direct.cost_shift),
    };
    // x̂ − l, u − x̂ and d̂, unmagnified.
    let mut below = vec![f64::INFINITY; total];
    let mut above = vec![f64::INFINITY; total];
    let mut reduced = vec![0.0; total];
    let (mut primal, mut dual) = (0.0f64, 0.0f64);
    for v in 0..total {
        let status = frame.basis.status[v];
        let resting = frame.resting_value(v);
        // An exact zero has an approximation too, and magnified it would drown the rest.
        let distance = |bound: &crate::number::Int, outside: i32| {
            let value = if status == Status::Basic {
                let q = values.component(frame, v).minus(bound);
                let value = values.approximate(&q);
                if value * f64::from(outside) > 0.0 && values.sign(&q) != outside {
                    0.0
                } else {
                    value
                }
            } else {
                let (a, e) = mantissa(&(&resting - bound));
                ldexp(a, e)
            };
            units.length(v, value)
        };
        if let Some(l) = &p.lower[v] {
            below[v] = distance(l, -1);
        }
        if let Some(u) = &p.upper[v] {
            above[v] = -distance(u, 1);
        }
        if status == Status::Basic {
            primal = primal.max(-below[v]).max(-above[v]);
        } else {
            let q = duals.reduced(frame, v);
            reduced[v] = units.price(v, duals.approximate(&q));
            let wrong = match status {
                _ if p.is_fixed(v) => 0.0,
                Status::Lower => -reduced[v],
                Status::Upper => reduced[v],
                _ => reduced[v].abs(),
            };
            if wrong > 0.0 && duals.sign(&q) == 0 {
                reduced[v] = 0.0;
            } else {
                dual = dual.max(wrong);
            }
        }
        if below[v].is_nan() || above[v].is_nan() || !reduced[v].is_finite() {
            return None;
        }
    }
    let (stretch, weight) = (magnification(primal), magnification(dual));
    let far = |v: f64| {
        if v.is_finite() { v.clamp(-FAR, FAR) } else { v }
    };
    let all_free = (0..p.n).all(|j| p.lower[j].is_none() && p.upper[j].is_none());
    if all_free && let Some(mut program) = direct.dual() {
        // Prices as the unknowns, less ŷ; a row's slack is the cost of its price.
        for i in 0..p.m {
            let v = p.n + i;
            program.lower[i] = far((program.lower[i] - reduced[v]) * weight);
            program.upper[i] = far((program.upper[i] - reduced[v]) * weight);
            let slack = if p.lower[v].is_some() {
                below[v]
            } else {
                -above[v]
            };
            program.cost[i] = if slack.is_finite() {
                (slack * stretch).clamp(-FAR, FAR)
            } else {
                0.0
            };
        }
        for (j, d) in reduced[..p.n].iter().enumerate() {
            program.lower[p.m + j] = d * weight;
            program.upper[p.m + j] = d * weight;
        }
        return Some(program);
    }
    let mut program = direct.clone();
    program.lower = below.iter().map(|d| far(-d * stretch)).collect();
    program.upper = above.iter().map(|d| far(d * stretch)).collect();
    program.cost = reduced
        .iter()
        .map(|d| (d * weight).clamp(-FAR, FAR))
        .collect();
    Some(program)
}
