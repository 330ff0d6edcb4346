//! Proposals in floating point: nothing here decides anything.
//!
//! A program is scaled by powers of two ([`program`]), solved by a bounded dual simplex method
//! whose loose ends a primal one ties up ([`engine`], [`dual`], [`primal`]), or, where it is
//! large, by an interior point from which a basis is read off ([`interior`]). Where no basis is
//! wanted, an interior point of our own gives a point and prices ([`central`], [`cholesky`]). A basis that exact
//! arithmetic finds nearly optimal comes back to be refined ([`refine`]). All that leaves
//! this module is a basis, the iterations it took, and perhaps the row or column that seemed to
//! prove infeasibility or unboundedness.

pub(crate) mod central;
mod cholesky;
pub(crate) mod dual;
pub(crate) mod engine;
pub(crate) mod interior;
pub(crate) mod primal;
pub(crate) mod program;
pub(crate) mod propose;
pub(crate) mod refine;

pub(crate) use engine::Ending;
pub(crate) use propose::{Proposal, propose};
pub(crate) use refine::Refiner;
