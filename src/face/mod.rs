//! One face of an arrangement of arcs: the component of the plane without them that holds a start.
//!
//! The idea: the whole arrangement may have quadratically many vertices, one face has nearly linearly many, so
//! never build the arrangement. Two ways lead to the face. The *walk* finds the arc below the start and goes
//! round the boundary, arc by arc, with a static index that tells what is near (`trace.rs`); a plane
//! sweep over the boundary finds the islands (`island.rs`). The *merge* divides the arcs at random,
//! takes the face of each half and merges the two, by the same walk on the edges of both faces
//! (`merge.rs`): hidden arcs take no part, which is what bounds the time whatever the arcs look like.
//!
//! Arcs are graphs t = P(u)/Q(u) over an interval of u, or verticals u = const. All decisions are exact: doubles
//! with error bounds first, algebraic numbers where those meet (`kernel.rs`). Overlapping arcs, common points,
//! tangencies, arcs that end inside others, isolated arcs and unbounded faces are ordinary input.

// `!(a < b)` is meant as written: true for a NaN too, so that a filter falls back.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod approx;
mod bands;
mod boundary;
mod cluster;
mod compare;
mod cylinder;
mod frames;
mod gap;
mod hash;
mod hulls;
mod island;
mod isolate;
mod item;
mod kernel;
mod meet;
mod merge;
mod numbers;
mod pencil;
mod places;
mod read;
mod region;
mod run;
mod stops;
mod trace;
mod windows;

pub use boundary::Found;
pub(crate) use boundary::{Boundary, Glue, Strip, Way, boundary};
pub use kernel::Stats;
pub(crate) use kernel::{Kernel as FaceKernel, NumId};
pub use read::{ArcFile, ReadError, RootOf, SourceArc, Upright};
pub use region::Region;
pub use run::{Answer, Args, FaceError, Method, Question, Report, face, run_cli};
