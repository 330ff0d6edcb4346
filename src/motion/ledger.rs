//! The ledger of a simulation: what was asked, what settled it, what it cost.

use crate::number::filter::Counts;

/// What one simulation asked and spent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Predicates by the stage that settled them. All zero where doubles decided: they settle
    /// everything.
    pub counts: Counts,
    /// Critical instants at which more arcs met than in general position.
    pub degenerate_events: u64,
    /// One entry a phase that was run.
    pub phases: Vec<PhaseCost>,
}

/// What one phase cost, all pawls together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhaseCost {
    /// Contact arcs.
    pub arcs: u64,
    /// Pawls that ran by the sweep; the others scanned all arcs.
    pub swept: u64,
    /// Half-edges of the free components that were made.
    pub half_edges: u64,
    /// Seconds to build the slices.
    pub build: f64,
    /// Seconds to follow the motion.
    pub run: f64,
}
