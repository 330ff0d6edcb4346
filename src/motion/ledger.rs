//! The ledger of a simulation: what was asked, what settled it, what it cost.

use super::phase::Method;
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

impl Ledger {
    /// Which algorithm ran, in a run that was asked for one: where the choice was open, the sweep if any
    /// pawl of any phase ran by it.
    pub fn ran(&self, asked: Method) -> Method {
        match asked {
            Method::Auto if self.phases.iter().any(|p| p.swept > 0) => Method::Sweep,
            Method::Auto => Method::Naive,
            asked => asked,
        }
    }
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
    /// Slices built from contacts; a reversed phase turns those of its phase round instead.
    pub slices: u64,
    /// How free components were come by.
    pub faces: FaceCost,
    /// Seconds to build the slices.
    pub build: f64,
    /// Seconds to follow the motion.
    pub run: f64,
}

/// How a run came by the free components that it looked through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaceCost {
    /// Found by walking round them.
    pub walked: u64,
    /// Found by merges.
    pub merged: u64,
    /// How many merges that took.
    pub merges: u64,
    /// Known from another run or another phase, and used again.
    pub reused: u64,
    /// Given up because they contradicted what the slice says; all arcs were looked at from there on.
    pub abandoned: u64,
}

impl FaceCost {
    /// Adds another run's.
    pub fn add(&mut self, o: &FaceCost) {
        self.walked += o.walked;
        self.merged += o.merged;
        self.merges += o.merges;
        self.reused += o.reused;
        self.abandoned += o.abandoned;
    }
    /// Notes one that was found.
    pub fn found(&mut self, how: crate::face::Found) {
        if how.method == crate::face::Method::Merge {
            self.merged += 1;
        } else {
            self.walked += 1;
        }
        self.merges += how.merges;
    }
}
