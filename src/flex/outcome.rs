//! What a run of steps gives: how and why it ended, its steps, what is violated at the end.

use super::motion::{Contact, ProofSize};
use super::pairs::Pair;
use super::shape::Pose;
use crate::number::{Algebraic, Int, Poly, Rat};
use crate::report::words::digits;
use std::fmt;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// A step gained less than asked.
    Converged,
    /// The number of steps was reached.
    MostSteps,
    /// The linear program is unbounded: something comes apart.
    Unbounded,
    /// No motion restores the constraints.
    Infeasible,
    /// The time was over.
    Undecided,
}

impl Ending {
    /// The word used in results.
    pub fn word(self) -> &'static str {
        match self {
            Ending::Converged => "converged",
            Ending::MostSteps => "most-steps",
            Ending::Unbounded => "unbounded",
            Ending::Infeasible => "infeasible",
            Ending::Undecided => "undecided",
        }
    }
}

/// Why a run ended: what tells one end that is called converged from another.
#[derive(Clone, Debug, PartialEq)]
pub enum Why {
    /// The last step was promised this and gained less than asked.
    Little(f64),
    /// A step gave `loss` back, to restore what the ones before overreached, and the program after
    /// it promises no more than `promise`.
    Restored {
        /// What was given back.
        loss: f64,
        /// The optimum of the program after it, where there was one.
        promise: Option<f64>,
    },
    /// On a safe path: this was promised, and no part of it could be proven to be gained.
    Unproven(f64),
    /// This was promised, and no part of the direction keeps the violation allowed.
    Unfollowed(f64),
    /// A step gained less than asked, and its program promises this where rotations are not limited.
    Limited(f64),
    /// The number of steps was reached.
    Steps(usize),
    /// The program has no optimum.
    Unbounded,
    /// The program has no solution.
    Infeasible,
    /// The time was over.
    Time,
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = |v: &f64| match v.is_finite() {
            true => digits(*v, 3),
            false => "a number past the double range".to_owned(),
        };
        match self {
            Why::Little(promise) if *promise <= 0.0 => {
                write!(f, "the last program finds nothing more to gain")
            }
            Why::Little(promise) => write!(
                f,
                "the last step was promised {} to first order and gained less than asked",
                short(promise)
            ),
            Why::Restored { loss, promise } => {
                write!(
                    f,
                    "a step gave {} back, to restore constraints that steps before it \
                     overreached; ",
                    short(loss)
                )?;
                match promise {
                    Some(promise) => write!(
                        f,
                        "the program after it promises {} more to first order, and was not \
                         followed, since steps so small gain and give back by turns",
                        short(promise)
                    ),
                    None => write!(f, "what may still be gained is of that order"),
                }
            }
            Why::Unproven(promise) => write!(
                f,
                "the last program promises {} more to first order, but no part of any direction \
                 it gave, however little bodies were allowed to turn, could be proven both free \
                 of collision and a gain; the path up to here is proven",
                short(promise)
            ),
            Why::Unfollowed(promise) => write!(
                f,
                "the last program promises {} more to first order, but no part of its direction \
                 keeps the violation allowed",
                short(promise)
            ),
            Why::Limited(promise) => write!(
                f,
                "the last step gained less than asked, but only for the limit of rotation: without \
                 `rotation_limit` its program promises {} to first order",
                short(promise)
            ),
            Why::Steps(most) => write!(f, "the most steps were taken ({most})"),
            Why::Unbounded => write!(
                f,
                "the last program is unbounded: something comes apart (see `separate`)"
            ),
            Why::Infeasible => write!(
                f,
                "no motion, to first order, restores the constraints that are violated"
            ),
            Why::Time => write!(f, "the time was over"),
        }
    }
}

/// One step.
#[derive(Clone, Debug)]
pub struct Step {
    /// The exact optimum of the linear program (for floats and bounds: the best value known).
    pub objective: Rat,
    /// A proven enclosure of the optimum.
    pub enclosure: (Option<Rat>, Option<Rat>),
    /// The scale at which its direction was applied.
    pub scale: Rat,
    /// Rows of the program.
    pub rows: usize,
    /// Bits that the geometry of the program's gradients was rounded to; None where it is exact.
    pub gradient_bits: Option<u32>,
    /// Facing corners.
    pub facing: usize,
    /// Programs solved for this step.
    pub programs: usize,
    /// Pivots of the exact method, over these programs' last.
    pub exact_pivots: u64,
    /// Wall-clock time of the step: model, program, search.
    pub seconds: f64,
    /// Part of it that went into pairs and rows.
    pub model_seconds: f64,
    /// Whether the certificate passed the verifier; None where it was not asked.
    pub verified: Option<bool>,
    /// The certificate as JSON; null where there is none.
    pub certificate: serde_json::Value,
    /// What the proof of a safe step looked at; None where nothing was proven.
    pub proof: Option<ProofSize>,
    /// Where asked for, the first contact of the whole path, if it comes in this step.
    pub contact: Option<Contact>,
    /// Exact gain in displacement.
    pub gain: Rat,
    /// Bits of the longest number of any pose afterwards.
    pub bits: u64,
}

/// The result of a run.
#[derive(Clone, Debug)]
pub struct Flexed {
    /// How it ended.
    pub ending: Ending,
    /// Why it ended there.
    pub why: Why,
    /// The steps, in order.
    pub steps: Vec<Step>,
    /// The configurations: the start, then one after each step.
    pub configurations: Vec<Vec<Pose>>,
    /// The weighted displacement, exact.
    pub displacement: Rat,
    /// The largest violation at the end (a distance), zero if there is none.
    pub violation: Violation,
    /// Columns of the programs.
    pub columns: usize,
}

/// A distance whose square is rational.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Its square.
    pub square: Rat,
    /// The constraint, where one is violated.
    pub pair: Option<Pair>,
}

impl Violation {
    /// The distance itself.
    pub fn value(&self) -> Algebraic {
        let s = &self.square;
        if let (Some(n), Some(d)) = (s.numer().sqrt_exact(), s.denom().sqrt_exact()) {
            return Algebraic::from(Rat::new(n, d));
        }
        let p = Poly::new(vec![-s.numer(), Int::zero(), s.denom().clone()]);
        let roots = p.real_roots();
        let largest = roots.into_iter().next_back();
        largest.unwrap_or_else(|| Algebraic::from(Rat::zero()))
    }
}
