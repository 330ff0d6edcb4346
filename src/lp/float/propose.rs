//! Which proposal when.
//!
//! Large programs (and those turned round) go to the interior point first; the others to the
//! simplex method, with the interior point as the way out where that takes too many steps. A large
//! program whose normal equations fill up counts as one of the others.

use super::cholesky::Cholesky;
use super::engine::{Ending, Engine};
use super::interior;
use super::program::Program;
use crate::lp::basis::{Basis, Status};
use crate::lp::budget::{Budget, Exhausted};
use crate::lp::problem::Problem;

/// A basis and what it took.
pub(crate) struct Proposal {
    pub(crate) basis: Basis,
    pub(crate) iterations: u64,
    pub(crate) ending: Ending,
    /// Whether a limit of time or memory stopped one of the attempts.
    pub(crate) exhausted: bool,
    /// Where the program seemed infeasible, the basic variable that cannot be repaired.
    pub(crate) blame: Option<usize>,
    /// Values of the model's columns, prices of its rows; to be taken for what they are.
    pub(crate) point: Vec<f64>,
    pub(crate) prices: Vec<f64>,
    /// The objective as minimised, without the model's constant.
    pub(crate) objective: f64,
}

/// Non-zeros from which the interior point goes first.
const LARGE: usize = 33_000;
/// The same for programs that are dualised, where rows abound.
const LARGE_DUALISED: usize = 2_500;

/// Entries of its factor, for each of the program, from which an interior point is dear.
const DEAR: usize = 30;
/// Products that are made, for each entry of the program, to find out.
const PRODUCTS: usize = 60;

/// Whether the interior point's matrix fills up so much that simplex methods should come first.
fn dear(program: &Program) -> bool {
    let columns = &program.columns;
    let entries = columns.index.len();
    let spans = columns.start.windows(2);
    let products = spans.clone().map(|w| (w[1] - w[0]).pow(2) / 2);
    if products.sum::<usize>() > PRODUCTS * entries {
        return false;
    }
    let cliques = spans.map(|w| &columns.index[w[0]..w[1]]);
    Cholesky::new(program.m, cliques, DEAR * entries).is_none()
}

/// Proposes a basis for the problem, from a given one if there is one.
pub(crate) fn propose(problem: &Problem, start: Option<&Basis>, budget: &Budget) -> Proposal {
    let direct = Program::new(problem);
    let program = direct.dual().unwrap_or_else(|| direct.clone());
    let entries = direct.columns.index.len();
    let large = if program.dualised {
        entries >= LARGE_DUALISED
    } else {
        entries >= LARGE && !dear(&program)
    };
    let mut iterations = 0;
    let mut exhausted = false;
    let mut best: Option<(Vec<Status>, Ending, f64, Option<usize>)> = None;
    let mut point = (Vec::new(), Vec::new());
    let mut take = |engine: &mut Engine<'_>, ending: Result<Ending, Exhausted>| {
        iterations += engine.iterations;
        exhausted |= ending.is_err();
        let ending = ending.unwrap_or(Ending::Stuck);
        if best.is_none() || ending != Ending::Stuck {
            best = Some((
                engine.status.clone(),
                ending,
                engine.objective(),
                engine.blame,
            ));
            let prices = engine.prices();
            point = program.unscaled(problem, &engine.x[..program.n], &prices);
        }
        ending != Ending::Stuck || engine.nearly_optimal()
    };
    let from_interior = || {
        let weights = interior::weights(&direct, budget)?;
        Some(Engine::new(
            &program,
            interior::heaviest(&program, &weights),
        ))
    };
    let sizes = (program.n + program.m) as u64;
    let mut done = false;
    if let Some(basis) = start {
        let mut engine = Engine::new(&program, program.statuses(problem, basis));
        // A start that needs more than this was none.
        engine.most = 500 + program.m as u64 / 2;
        let ending = engine.optimise(false, budget);
        done = take(&mut engine, ending);
    }
    if !done
        && large
        && let Some(mut engine) = from_interior()
    {
        engine.most = program.m as u64 + 1000;
        let ending = engine.optimise(false, budget);
        done = take(&mut engine, ending);
    }
    if !done {
        let mut engine = Engine::slack(&program);
        engine.most = 4 * sizes + 1000;
        let ending = engine.optimise(true, budget);
        done = take(&mut engine, ending);
    }
    if !done
        && !large
        && let Some(mut engine) = from_interior()
    {
        engine.most = 4 * sizes + 1000;
        let ending = engine.optimise(false, budget);
        take(&mut engine, ending);
    }
    let (status, ending, objective, blame) = best.unwrap_or_else(|| {
        (
            Engine::slack(&program).status,
            Ending::Stuck,
            f64::NAN,
            None,
        )
    });
    Proposal {
        basis: program.basis(problem, &status),
        iterations,
        exhausted,
        point: point.0,
        prices: point.1,
        blame: blame.filter(|_| ending == Ending::Infeasible && !program.dualised),
        ending: match ending {
            // What the dual says of the dual.
            Ending::Infeasible | Ending::Unbounded if program.dualised => Ending::Stuck,
            other => other,
        },
        objective: program.unscaled_objective(objective),
    }
}
