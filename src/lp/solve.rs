//! The way from a model to its outcome.

use super::basis::{Basis, ColumnVector, Frame, RowVector};
use super::budget::{Budget, Meter, Stage};
use super::enclose;
use super::float::{self, Refiner};
use super::model::Model;
use super::outcome::{Certificate, Outcome, Places, Status, VECTOR_BITS, conclude, point, prices};
use super::problem::Problem;
use super::safe::Known;
use super::simplex::{self, Effort};
use crate::number::{Int, Rat};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Who finds the basis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// Floating point proposes, exact arithmetic disposes.
    #[default]
    Warm,
    /// The exact simplex method alone.
    Exact,
}

/// How much is proven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Accuracy {
    /// Nothing: the floating-point result.
    Float,
    /// A proven enclosure of the optimum of relative width 10⁻⁹ at most: a rational feasible point
    /// and rational prices. The exact method ends as soon as it has both, which may be at the
    /// optimum itself; then the width is zero.
    Bounds,
    /// The optimum itself.
    #[default]
    Exact,
}

/// What a caller may choose.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Who finds the basis.
    pub method: Method,
    /// How much is proven.
    pub accuracy: Accuracy,
    /// Time after which the result is "undecided".
    pub time_limit: Option<Duration>,
    /// Bytes that no single structure may exceed.
    pub memory_limit: Option<u64>,
    /// Whether to write out all values and prices.
    pub values: bool,
    /// A basis to start from, as [`Outcome::basis`] gives it: that of a similar program saves
    /// most of the work. It need not fit, see [`Places`].
    pub basis: Option<Places>,
    /// Where to note what the solve is at.
    pub meter: Option<Arc<Meter>>,
}

/// Solves a model.
pub fn solve(model: &Model, options: &Options) -> Outcome {
    let budget = Budget::new(
        options.time_limit,
        options.memory_limit,
        options.meter.clone(),
    );
    let method = match options.method {
        Method::Warm => "warm",
        Method::Exact => "exact",
    };
    let mut outcome = decide(model, options, &budget);
    outcome.method = method;
    outcome.accuracy = match options.accuracy {
        Accuracy::Float => "float",
        Accuracy::Bounds => "bounds",
        Accuracy::Exact => "exact",
    };
    outcome
}

fn decide(model: &Model, options: &Options, budget: &Budget) -> Outcome {
    budget.report(Stage::Scaling, 0);
    let Some(problem) = Problem::new(model) else {
        return Outcome::undecided("the program's integers are too long");
    };
    if let Some(v) = problem.crossed() {
        let mut out = Outcome::undecided("");
        out.reason = None;
        out.status = Status::Infeasible;
        out.certificate = Some(Certificate::Crossed {
            row: v >= problem.n,
            index: (if v >= problem.n { v - problem.n } else { v }) as u32,
        });
        return out;
    }
    let mut effort = Effort::default();
    let given = options.basis.as_ref().map(|b| b.basis(&problem));
    let mut iterations = 0;
    let mut blame = None;
    let mut known = Known::default();
    let mut guess = (Vec::new(), Vec::new());
    // Vectors that are to be written out are better exact.
    if options.accuracy == Accuracy::Bounds
        && options.method == Method::Warm
        && !options.values
        && given.is_none()
        && let Some(found) = enclose::enclose(model, &problem, &budget.most())
    {
        iterations = found.steps;
        let near = found.near.clone();
        known.enclosed(found);
        if known.closed() {
            let mut out = Outcome::undecided("");
            known.publish(model, true, &mut out);
            out.float_iterations = iterations;
            out.near = near;
            return out;
        }
    }
    let start = if options.method == Method::Warm {
        let most = budget.most();
        let proposal = float::propose(&problem, given.as_ref(), &most);
        iterations += proposal.iterations;
        blame = proposal.blame;
        guess = (proposal.point.clone(), proposal.prices.clone());
        if options.accuracy == Accuracy::Float {
            return Outcome {
                near: guess.0,
                ..unproven(model, &proposal, most.check().is_err())
            };
        }
        proposal.basis
    } else {
        given.unwrap_or_else(|| Basis::slack(&problem))
    };
    if options.accuracy == Accuracy::Bounds && Known::may_guess(model) {
        known.guess(model, &guess.0, &guess.1, budget);
        if known.closed() {
            let mut out = Outcome::undecided("");
            known.publish(model, true, &mut out);
            out.float_iterations = iterations;
            out.near = guess.0;
            return out;
        }
    }
    let mut last = (Instant::now(), Duration::ZERO);
    let mut watch = |frame: &Frame<'_>, values: Option<&ColumnVector>, duals: &RowVector| {
        let bounds = options.accuracy == Accuracy::Bounds;
        // Where the vertex is asked for, these are for the case that a limit comes first.
        if !bounds && last.0.elapsed() < 20 * last.1 {
            return false;
        }
        let start = Instant::now();
        let bits = |d: &Int| d.bits() * frame.kernel.size() as u64;
        if let Some(v) = values
            && bits(&v.solution.denominator) <= VECTOR_BITS
        {
            known.point(model, point(frame, v));
        }
        if bits(&duals.solution.denominator) <= VECTOR_BITS {
            known.prices(model, prices(frame, duals, &problem.cost_scale));
        }
        last = (Instant::now(), start.elapsed());
        bounds && known.closed()
    };
    let mut refiner = Refiner::new();
    let mut refine = |frame: &Frame<'_>, values: &ColumnVector, duals: &RowVector| {
        let floats = options.method == Method::Warm;
        floats.then(|| refiner.refine(frame, values, duals, budget))?
    };
    let run = simplex::run(
        &problem,
        start,
        blame,
        &mut watch,
        &mut refine,
        budget,
        &mut effort,
    );
    let mut outcome = match run {
        Ok(verdict) => conclude(model, &verdict, options.values),
        Err((_, last)) => {
            if !known.closed() {
                let grace = Budget::new(options.time_limit.map(grace), options.memory_limit, None);
                known.guess(model, &guess.0, &guess.1, &grace);
            }
            let reason = format!("a limit was reached{}", known.missing(model));
            let mut out = Outcome::undecided(&reason);
            out.basis = Some(Places::of(&last, problem.n));
            known.publish(model, options.accuracy == Accuracy::Bounds, &mut out);
            out
        }
    };
    if outcome.near.is_empty() {
        outcome.near = guess.0;
    }
    outcome.float_iterations = iterations + refiner.iterations;
    outcome.exact_pivots = effort.pivots;
    outcome
}

/// Time for putting bounds together once a limit was reached.
fn grace(limit: Duration) -> Duration {
    (limit / 10).max(Duration::from_millis(50))
}

/// What floating point says, with nothing to prove it; `late` where its time is over.
fn unproven(model: &Model, proposal: &float::Proposal, late: bool) -> Outcome {
    let mut out = Outcome::undecided("");
    out.reason = None;
    out.float_iterations = proposal.iterations;
    out.status = match proposal.ending {
        float::Ending::Optimal => Status::Optimal,
        float::Ending::Infeasible => Status::Infeasible,
        float::Ending::Unbounded => Status::Unbounded,
        float::Ending::Stuck => Status::Undecided,
    };
    if out.status == Status::Undecided {
        let limit = late || proposal.exhausted;
        let reason = ["floating point gave up", "a limit was reached"][usize::from(limit)];
        out.reason = Some(reason.to_string());
    }
    if out.status == Status::Optimal && proposal.objective.is_finite() {
        let value = Rat::from_f64(proposal.objective);
        let value = if model.maximise { -value } else { value };
        out.objective = Some(&model.constant + &value);
    }
    out
}
