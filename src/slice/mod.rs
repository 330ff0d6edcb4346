//! The slice: the cylinder (t, θ) over one straight phase, cut by contact arcs (DP §9.1).
//!
//! A patch of configuration space meets the cylinder in a curve f₀(θ) + t·f₁(θ) = 0. Seen from
//! the orientation it is a *graph*: t = −f₀/f₁ is a rational function of x. So everything that a
//! patch contributes is found along x: the places where anything can change are roots of
//! quadratics, and between two neighbouring ones a single rational sample decides whether the
//! contact is real. Each valid stretch is an [`Arc`]: monotone in t and in x, with named ends.
//! Two degenerate shapes complete the picture: *levels* (x constant, the hinge moves parallel to
//! the contact) and *walls* (t constant, the contact is at the hinge itself).
//!
//! Algorithms to the right of this module see no coordinates: they ask the [`Slice`] where two
//! arcs cross, which of two times is earlier, which of two arcs is higher just after a time.

mod annotate;
mod arc;
mod assemble;
mod breaks;
mod build;
mod free;
mod names;
mod predicates;
mod query;
mod reverse;
mod scout;
mod shop;
mod strip;
mod valid;

pub use crate::kernel::Time;
pub use arc::{Arc, ArcId, Curve, CurveId, End, Exact, Shape, Side};
pub use free::{Configuration, Free, FreeEdge, FreeVertex, Interval, Touch, Whereabouts};
pub use predicates::{Cross, Germs, Point, cmp_horizontal};
pub use shop::Slice;
pub use strip::Owner;
