//! The types a scene consists of, exactly as the file gives them.
use crate::geometry::Vec2;
use crate::number::Rat;

/// A scene: obstacles, an optional root, pawls and a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name of the scene.
    pub name: String,
    /// Coulomb's μ ≥ 0; None where no friction is modelled.
    pub friction: Option<Rat>,
    /// Fixed bodies; they may touch or overlap.
    pub obstacles: Vec<Obstacle>,
    /// The root polygon, where root collisions are modelled.
    pub root: Option<Root>,
    /// The pawls, at least one.
    pub pawls: Vec<Pawl>,
    /// The plan, at least one phase.
    pub motions: Vec<Motion>,
    /// What `classify` is asked.
    pub classify: Option<Classify>,
}

/// A fixed polygon with holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Name, unique in the scene.
    pub name: String,
    /// The outer ring as listed (either orientation).
    pub vertices: Vec<Vec2>,
    /// Holes as listed.
    pub holes: Vec<Vec<Vec2>>,
}

/// The root body.
#[derive(Clone, Debug, PartialEq)]
pub struct Root {
    /// Drawn at time 0.
    pub vertices: Vec<Vec2>,
    /// The point that torques on the root are about.
    pub reference: Option<Vec2>,
}

/// A pawl on a torsional spring.
#[derive(Clone, Debug, PartialEq)]
pub struct Pawl {
    /// Name, unique in the scene.
    pub name: String,
    /// Drawn position of the hinge at time 0.
    pub hinge: Vec2,
    /// Drawn at time 0 and at rest, file coordinates (not relative to the hinge).
    pub vertices: Vec<Vec2>,
    /// Torque per radian; None where no forces are modelled.
    pub stiffness: Option<Rat>,
    /// tan(θ/2) at time 0; zero by default.
    pub start: Rat,
    /// Angular stops, tan(θ/2), lo < hi.
    pub limits: Option<(Rat, Rat)>,
}

/// One phase of the plan.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// A straight translation.
    Translate {
        /// Not zero.
        velocity: Vec2,
        /// Positive; an upper bound where `until_root_collision`.
        duration: Option<Rat>,
        /// Ends where the root collides.
        until_root_collision: bool,
    },
    /// Back along the phase before, at its speed, for as long as it really lasted.
    Reverse,
}

/// What `classify` is asked.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Classify {
    /// The control family; empty: the reverse of the plan's last phase that is no reverse.
    pub directions: Vec<Vec2>,
    /// Decide every direction of the circle too.
    pub total: bool,
    /// The modulus bound of a force diode.
    pub force_limit: Option<Rat>,
    /// How far a direction of the circle must run to be a way out; the family's run the length
    /// of the phase that they reverse.
    pub escape_distance: Option<Rat>,
}
