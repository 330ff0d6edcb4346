//! The way from a model to its outcome.

use super::basis::Basis;
use super::budget::Budget;
use super::float;
use super::model::Model;
use super::outcome::{Certificate, Outcome, Places, Status, conclude};
use super::problem::Problem;
use super::simplex::{self, Effort};
use crate::number::Rat;
use std::time::Duration;

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
    /// A proven rational enclosure of the optimum. At present it is found as for `Exact`, so
    /// that its width is zero.
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
}

/// Solves a model.
pub fn solve(model: &Model, options: &Options) -> Outcome {
    let budget = Budget::new(options.time_limit, options.memory_limit);
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
    let start = if options.method == Method::Warm {
        let proposal = float::propose(&problem, given.as_ref(), budget);
        iterations = proposal.iterations;
        blame = proposal.blame;
        if options.accuracy == Accuracy::Float {
            return unproven(model, &proposal);
        }
        proposal.basis
    } else {
        given.unwrap_or_else(|| Basis::slack(&problem))
    };
    let run = simplex::run(&problem, start, blame, budget, &mut effort);
    let mut outcome = match run {
        Ok(verdict) => conclude(model, &verdict, options.values),
        Err((_, last)) => {
            let mut out = Outcome::undecided("a limit was reached");
            out.basis = Some(Places::of(&last, problem.n));
            out
        }
    };
    outcome.float_iterations = iterations;
    outcome.exact_pivots = effort.pivots;
    outcome
}

/// What floating point says, with nothing to prove it.
fn unproven(model: &Model, proposal: &float::Proposal) -> Outcome {
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
        out.reason = Some("floating point gave up".to_string());
    }
    if out.status == Status::Optimal && proposal.objective.is_finite() {
        let value = Rat::from_f64(proposal.objective);
        let value = if model.maximise { -value } else { value };
        out.objective = Some(&model.constant + &value);
    }
    out
}
