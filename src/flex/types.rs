//! What a structure file says: bodies, where they stand, what holds them, what is asked.

use crate::geometry::Vec2;
use crate::number::Rat;

/// A structure: loosely joined rigid bodies and the question how far they flex.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// Name of the structure.
    pub name: String,
    /// ε > 0: a vertex nearer than this to an edge makes a constraint.
    pub epsilon: Rat,
    /// The bodies, at least one.
    pub bodies: Vec<Body>,
    /// Which bodies constrain each other; None: every two that are close.
    pub joints: Option<Vec<Joint>>,
    /// Where given, a body is kept apart from this many nearest bodies, however far they are.
    pub nearest: Option<usize>,
    /// Markers that bodies must keep in view.
    pub views: Vec<View>,
    /// The weighted sum to be maximised; empty where the file asks nothing.
    pub objective: Vec<Term>,
    /// How time steps are taken.
    pub step: StepRules,
}

/// A kind of joint, and where it occurs.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Pairs of bodies by index.
    pub bodies: Vec<(usize, usize)>,
    /// What touches what; None: whatever is close.
    pub contacts: Option<Vec<Contact>>,
}

/// A vertex of one body of a joint against an edge of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// Whether the edge is the first body's.
    pub edge_of_first: bool,
    /// The edge, from this vertex to the next.
    pub edge: usize,
    /// The vertex of the other body.
    pub vertex: usize,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name, unique in the structure.
    pub name: String,
    /// A simple polygon in the body's frame, in either sense.
    pub vertices: Vec<Vec2>,
    /// Where the frame's origin stands.
    pub position: Vec2,
    /// tan(θ/2) of the frame's rotation.
    pub tan_half: Rat,
    /// What holds it.
    pub hold: Hold,
}

/// What holds a body.
#[derive(Clone, Debug, PartialEq)]
pub enum Hold {
    /// Nothing: three degrees of freedom.
    Free,
    /// It does not move.
    Fixed,
    /// It turns about this point of its frame.
    Pin(Vec2),
}

/// A marker on one body that a camera on another must keep in view: it stays inside the cone
/// from the ray `right` counter-clockwise to the ray `left`, less than half a turn.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The body that carries the camera.
    pub body: usize,
    /// The camera, in its frame.
    pub camera: Vec2,
    /// The cone's left edge, a direction in its frame.
    pub left: Vec2,
    /// The cone's right edge.
    pub right: Vec2,
    /// Where given, a point ahead in its frame: what lies beyond the line through it, square to
    /// the way from the camera, is too far to be seen.
    pub far: Option<Vec2>,
    /// The body that carries the marker.
    pub of: usize,
    /// The marker, in its frame.
    pub marker: Vec2,
}

/// A term of the objective.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    /// Weights on the movement of a body: of its frame's origin, and of its turn φ, which counts as
    /// 2 tan(φ/2).
    Body {
        /// Index of the body.
        body: usize,
        /// Weight of the origin's displacement to the right.
        dx: Rat,
        /// Weight of the origin's displacement upwards.
        dy: Rat,
        /// Weight of the rotation, counter-clockwise.
        dtheta: Rat,
    },
    /// Weights on the movement of a vertex.
    Vertex {
        /// Index of the body.
        body: usize,
        /// Index of the vertex as listed.
        vertex: usize,
        /// Weight of its displacement to the right.
        dx: Rat,
        /// Weight of its displacement upwards.
        dy: Rat,
    },
    /// The movement of a body's origin towards an upright line, with weight one: it is not moved
    /// past the line, and what moves it away from the line counts against it.
    Towards {
        /// Index of the body, which is not pinned.
        body: usize,
        /// Abscissa of the line.
        x: Rat,
    },
    /// The movement of the origins of bodies away from a point, each with weight one.
    Radial {
        /// One body, or all that move.
        body: Option<usize>,
        /// The point.
        from: Vec2,
    },
}

/// How time steps are taken (PF §V-B).
#[derive(Clone, Debug, PartialEq)]
pub struct StepRules {
    /// The exact violation (a distance) that a step may reach; ε/300 by default.
    pub violation: Rat,
    /// Whether steps are shortened until their whole motion is proven free of collision.
    pub path: Path,
    /// Largest rotation of a body in one step, as 2 tan(φ/2); 2⁶⁴ or more is no limit.
    pub rotation_limit: Option<Rat>,
    /// Stepping ends where a step gains less; 10⁻⁶ by default.
    pub gain: Rat,
    /// Most steps; 100 by default.
    pub most: usize,
}

/// How much a path must respect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Path {
    /// The constraints at the ends of steps, up to the violation allowed.
    Fast,
    /// No collision at any time, proven.
    Safe,
}

impl Path {
    /// The word used in files and results.
    pub fn word(self) -> &'static str {
        match self {
            Path::Fast => "fast",
            Path::Safe => "safe",
        }
    }
}

impl StepRules {
    /// The rules that hold where the file says nothing.
    pub fn for_epsilon(epsilon: &Rat) -> StepRules {
        StepRules {
            violation: epsilon / &Rat::from(300),
            path: Path::Fast,
            rotation_limit: None,
            gain: Rat::frac(1, 1_000_000),
            most: 100,
        }
    }
}
