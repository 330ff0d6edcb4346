//! The structure file as types, for its JSON Schema; nothing is read through them. A test holds
//! their keys against those of the reader.

#![allow(dead_code, reason = "only the schemas of these types are used")]

use crate::scene::{Number, Point, Ring, without_null};
use schemars::{JsonSchema, Schema};

/// The JSON Schema of a structure file (draft 2020-12), as `snapfit schema structure` prints it.
pub fn structure_schema() -> Schema {
    let mut schema = schemars::schema_for!(StructureDocument);
    without_null(&mut schema);
    schema.insert("$id".to_owned(), "snapfit.structure/1".into());
    schema
}

/// A structure for `snapfit flex`: loosely joined rigid bodies, and the question how far they
/// flex.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct StructureDocument {
    structure: StructureSection,
    /// The bodies; at the start they may touch, but not overlap.
    #[schemars(length(min = 1))]
    body: Vec<BodyTable>,
    /// Which bodies constrain each other. Left out: every two that are close.
    joint: Option<Vec<JointTable>>,
    /// Markers that must stay in view.
    view: Option<Vec<ViewTable>>,
    /// What is maximised.
    objective: Option<ObjectiveSection>,
    /// How time steps are taken.
    step: Option<StepSection>,
}

/// The structure as a whole.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct StructureSection {
    /// Name of the structure.
    name: String,
    /// Vertex-edge pairs nearer than this are constraints.
    epsilon: Number,
    /// Each body is kept apart from this many nearest bodies, however far they are.
    nearest: Option<u32>,
}

/// A rigid body.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct BodyTable {
    /// Name, unique in the structure.
    name: String,
    /// In the body's frame.
    vertices: Ring,
    /// Where the frame's origin stands. Left out: at the origin.
    position: Option<Point>,
    /// tan(θ/2) of the frame's rotation. Left out: 0.
    tan_half: Option<Number>,
    /// The body does not move.
    fixed: Option<bool>,
    /// The body turns about this point of its frame.
    pin: Option<Point>,
}

/// A kind of joint and the pairs of bodies that have it.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct JointTable {
    /// Names of bodies, two a pair.
    bodies: Vec<[String; 2]>,
    /// Contacts [edge of the first body, vertex of the second]. Neither `first` nor `second`:
    /// whatever is close.
    first: Option<Vec<[u32; 2]>>,
    /// Contacts [edge of the second body, vertex of the first].
    second: Option<Vec<[u32; 2]>>,
}

/// A camera that must keep a marker in view.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct ViewTable {
    /// The body that carries the camera.
    body: String,
    /// The camera, in its frame.
    camera: Point,
    /// Direction of the cone's left edge, in its frame.
    left: Point,
    /// Direction of the cone's right edge; the cone runs counter-clockwise from it to `left`.
    right: Point,
    /// A point ahead beyond which nothing is seen, in its frame. Left out: no limit.
    far: Option<Point>,
    /// The body that carries the marker.
    of: String,
    /// The marker, in its frame.
    marker: Point,
}

/// What is maximised: the sum of the terms.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct ObjectiveSection {
    /// Weighted movements.
    terms: Option<Vec<TermTable>>,
    /// The movement of all bodies away from a point.
    radial_from: Option<Point>,
}

/// A term: weights on a body's movement, on a vertex's, or movement away from a point.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct TermTable {
    /// Name of the body.
    body: Option<String>,
    /// Index of a vertex.
    vertex: Option<u32>,
    /// Weight of the movement to the right.
    dx: Option<Number>,
    /// Weight of the movement upwards.
    dy: Option<Number>,
    /// Weight of the rotation, counter-clockwise. A turn by φ counts as the rational 2 tan(φ/2), which is φ
    /// in radians up to its third power (0.482 for 0.473): φ = 2 atan(d/2) for a turn of weight one
    /// that counts d.
    dtheta: Option<Number>,
    /// Movement away from this point.
    radial_from: Option<Point>,
    /// Movement of the body's origin towards this abscissa, and not past it.
    towards_x: Option<Number>,
}

/// How time steps are taken.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct StepSection {
    /// The exact violation that a step may reach. Left out: epsilon/300.
    violation: Option<Number>,
    /// Whether every motion is proven free of collision.
    path: Option<PathWord>,
    /// Largest rotation of a body in one step, as 2 tan(φ/2) of its turn φ; 2⁶⁴ or more is no limit.
    rotation_limit: Option<Number>,
    /// Stepping ends where a step gains less. Left out: 10⁻⁶.
    gain: Option<Number>,
    /// Most steps. Left out: 100.
    #[schemars(range(min = 1))]
    most: Option<u32>,
}

/// How much a path must respect.
#[derive(JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum PathWord {
    /// The constraints at the ends of steps, up to the violation allowed.
    Fast,
    /// No collision at any time, proven.
    Safe,
}
