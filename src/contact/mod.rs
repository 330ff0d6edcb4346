//! Contacts: which pawl feature touches which obstacle feature, and the C-function of each
//! pair (DP §5, eqs. 3 and 4).
//!
//! Along one straight phase the hinge is at p(t) = p₀ + v·t, and every C-function of either
//! type, every applicability boundary and every "still on the edge?" test has one shape:
//!
//! ```text
//! F₀(θ) + t·F₁(θ),     Fᵢ(θ) = c·cos θ + s·sin θ + k
//! ```
//!
//! So a [`Patch`] is nothing but a handful of [`Trig`] functions: the C-function itself, two
//! wedge conditions (the polygons do not penetrate beside the contact) and two location
//! conditions (the contact is on the edge, not past its ends). Both contact types look alike
//! from here on; what distinguishes them stays in this module and in the friction rules.

mod cone;
mod patch;
mod shape;
mod trig;
mod window;

pub use cone::Cones;
pub use patch::{Frame, Pair, Patch, pairs_within, patches};
pub use shape::{Convexity, Normals, ObstacleShape, PawlShape, Ring};
pub use trig::{Chart, Trig};

/// A contact between a feature of a pawl and a feature of an obstacle, or with an angular stop.
///
/// Indices count vertices as listed in the file; edge k joins vertex k to k + 1. The order is
/// the contract's: by obstacle, type B before type A, obstacle feature, pawl feature.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Contact {
    /// Contact with an obstacle.
    Obstacle {
        /// Index of the obstacle.
        obstacle: u32,
        /// Which type of contact.
        kind: ContactKind,
        /// 0 for the outer ring, h + 1 for hole h.
        ring: u32,
        /// Edge (type B) or vertex (type A) of the obstacle's ring.
        obstacle_feature: u32,
        /// Vertex (type B) or edge (type A) of the pawl.
        pawl_feature: u32,
    },
    /// The pawl rests on its angular stop 0 (lower) or 1 (upper).
    Limit(u8),
}

/// The type of a contact (Lozano-Pérez's convention, DP §5).
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum ContactKind {
    /// A pawl vertex touches an obstacle edge.
    B,
    /// An obstacle vertex touches a pawl edge.
    A,
}
