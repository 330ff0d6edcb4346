//! Motion: the dynamical rules, in one place, and the two algorithms that apply them.
//!
//! # The clamp
//!
//! On the line L(t) the free component of a pawl is a set of intervals of orientation. The state
//! is the point of its own interval nearest to rest, followed continuously in t. Everything in
//! DP §8 and §9 is a consequence. At a critical point z two questions decide:
//!
//! 1. *Does the interval survive?* Just above z (and just below) the configuration stays free
//!    across the instant unless an arc closes on z from that side, or a wall stands there. If the
//!    side that the state borders is closed, the motion jams.
//! 2. *Where does the interval end just after?* At the topmost arc that leaves z to the right
//!    (seen from above). If there is one, the state follows it; if there is none, the near end
//!    has jumped, and the state snaps to the next arc on the way to rest, or to rest itself.
//!
//! No normals are needed (DP eq. 32 is neither necessary nor sufficient), and vertical tangencies,
//! vertices, walls, levels and seams are all the same case.
//!
//! # Modules
//!
//! [`friction`] says where a contact sticks (DP §6, §7), [`phase`] runs one pawl through one
//! phase by the rules in `local`, asking a `sight` which arcs may matter: all of them (the simple
//! algorithm) or those on F's boundary (the `sweep`). [`ledger`] counts, [`root`] finds the root's
//! collision, [`solids`] holds the obstacles for it, [`plan`] strings phases together, `replay` starts anew on a slice that is there, [`trajectory`] holds what comes out.

mod beside;
mod close;
mod enter;
pub mod friction;
pub mod ledger;
mod local;
pub mod phase;
pub mod plan;
mod replay;
pub mod root;
mod sight;
pub mod solids;
mod start;
mod sweep;
pub mod trajectory;

pub use ledger::Ledger;
pub use phase::{Method, Run, SWEEP_FROM};
pub use plan::{Arithmetic, Options, PlanError, Seen, simulate, slices};
pub use trajectory::{
    Angle, Branch, Event, EventKind, Outcome, OutcomeKind, PawlTrace, Phase, RootContact, Segment,
    Trajectory,
};
