//! The ledger of a result, and what a result in doubles leaves out.

use super::json::{CurveDocument, ResultDocument, TanHalf};
use super::num::Num;
use crate::kernel::COEFFICIENT_BITS;
use crate::motion::Ledger;
use crate::number::{Int, Rat};
use schemars::JsonSchema;
use serde::Serialize;

/// What was asked, what settled it, and what it took.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Ledger")]
pub struct LedgerDocument {
    /// Predicates by the stage that settled them. All zero in `f64`, where doubles settle all.
    pub predicates: PredicatesDocument,
    /// The most bits of an integer that an exact answer was read from.
    pub most_bits: u64,
    /// Critical instants at which more arcs met than in general position.
    pub degenerate_events: u64,
    /// One entry a phase.
    pub phases: Vec<PhaseCostDocument>,
}

/// How many predicates there were, and what settled them.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Predicates")]
pub struct PredicatesDocument {
    /// All.
    pub asked: u64,
    /// Two handles of one thing: no arithmetic.
    pub names: u64,
    /// Double enclosures.
    pub doubles: u64,
    /// A fixed precision of some hundred bits.
    pub wider: u64,
    /// Exact arithmetic.
    pub exact_calls: u64,
    /// Of the exact ones, how many found equality or zero.
    pub zeros: u64,
}

/// What a phase cost, all pawls together.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "PhaseCost")]
pub struct PhaseCostDocument {
    /// Contact arcs.
    pub arcs: u64,
    /// Pawls that ran by the sweep; the others scanned all arcs.
    pub swept: u64,
    /// Half-edges of the free components that were made.
    pub half_edges: u64,
    /// Slices built from contacts; a reversed phase turns those of its phase round instead.
    pub slices: u64,
    /// Free components found by walking round them.
    pub walked: u64,
    /// Free components found by merges.
    pub merged: u64,
    /// How many merges that took.
    pub merges: u64,
    /// Free components known from another run or phase.
    pub reused: u64,
    /// Free components given up because they contradicted the slice; all arcs were looked at from there on.
    pub abandoned: u64,
    /// Seconds to build the slices; absent where times are left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub build_seconds: Option<f64>,
    /// Seconds to follow the motion; absent where times are left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run_seconds: Option<f64>,
}

impl LedgerDocument {
    pub(super) fn new(ledger: &Ledger) -> LedgerDocument {
        let c = &ledger.counts;
        LedgerDocument {
            predicates: PredicatesDocument {
                asked: c.asked(),
                names: c.names,
                doubles: c.doubles,
                wider: c.wider,
                exact_calls: c.exact,
                zeros: c.zeros,
            },
            most_bits: c.most_bits,
            degenerate_events: ledger.degenerate_events,
            phases: ledger
                .phases
                .iter()
                .map(|p| PhaseCostDocument {
                    arcs: p.arcs,
                    swept: p.swept,
                    half_edges: p.half_edges,
                    slices: p.slices,
                    walked: p.faces.walked,
                    merged: p.faces.merged,
                    merges: p.faces.merges,
                    reused: p.faces.reused,
                    abandoned: p.faces.abandoned,
                    build_seconds: Some(p.build),
                    run_seconds: Some(p.run),
                })
                .collect(),
        }
    }
}

impl ResultDocument {
    /// Leaves the seconds out, which differ from run to run: what remains is the same, to the
    /// byte, wherever and as often as the scene is run.
    pub fn without_times(&mut self) {
        for p in &mut self.ledger.phases {
            p.build_seconds = None;
            p.run_seconds = None;
        }
    }
    /// What a result of the double kernel shows: doubles, nowhere an exact number.
    pub(super) fn in_doubles(&mut self) {
        let plain = |n: &mut Num| n.exact = None;
        let tangent = |t: &mut TanHalf| {
            if let TanHalf::Finite(n) = t {
                plain(n);
            }
        };
        for p in &mut self.phases {
            plain(&mut p.from);
            plain(&mut p.to);
            p.velocity.iter_mut().for_each(plain);
        }
        plain(&mut self.outcome.time);
        self.outcome.position.iter_mut().for_each(plain);
        for pawl in &mut self.pawls {
            for e in &mut pawl.events {
                plain(&mut e.time);
                tangent(&mut e.tan_half);
                e.to_tan_half.iter_mut().for_each(tangent);
            }
            for s in &mut pawl.segments {
                plain(&mut s.from);
                plain(&mut s.to);
                if let Some(c) = &mut s.curve {
                    unscale(c);
                }
            }
        }
    }
}

/// Coefficients come as doubles times a power of two; on an angular stop, as rationals.
fn unscale(c: &mut CurveDocument) {
    let unit = Rat::from(Int::one().shl(COEFFICIENT_BITS as u64));
    let scaled = c.p.iter().chain(&c.q).all(|t| !t.contains('/'))
        && c.p.iter().chain(&c.q).any(|t| t.len() > 200);
    for text in c.p.iter_mut().chain(&mut c.q) {
        let Ok(r) = text.parse::<Rat>() else { continue };
        let r = if scaled { r / &unit } else { r };
        if let Some(x) = r.nearest_f64() {
            *text = x.to_string();
        }
    }
}
