//! The file format as types, for its JSON Schema.
//!
//! These types mirror the file, not the scene: numbers are what a file may hold there, and what
//! may be left out is optional. Nothing is read through them, as they would forget the places and
//! the text of numbers; a test holds their keys against those of the reader.

#![allow(dead_code, reason = "only the schemas of these types are used")]

use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::Value;
use std::borrow::Cow;

/// The JSON Schema of a scene file (draft 2020-12), as `snapfit schema scene` prints it.
pub fn scene_schema() -> Schema {
    let mut schema = schemars::schema_for!(SceneDocument);
    without_null(&mut schema);
    schema.insert("$id".to_owned(), "snapfit.scene/1".into());
    schema
}

/// What may be left out of a file may not be null instead, as `schemars` takes an `Option` to
/// mean: takes the null out of every choice, and the choice away where one way is left.
pub(crate) fn without_null(schema: &mut Schema) {
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|t| t != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            schema.insert("type".to_owned(), only);
        }
    }
    if let Some(Value::Array(ways)) = schema.get_mut("anyOf") {
        ways.retain(|way| way.get("type").is_none_or(|t| t != "null"));
        if let [Value::Object(only)] = ways.as_slice() {
            let only = only.clone();
            schema.remove("anyOf");
            for (key, value) in only {
                // The field's own description says more than its type's.
                if schema.get(&key).is_none() {
                    schema.insert(key, value);
                }
            }
        }
    }
    transform_subschemas(&mut without_null, schema);
}

/// An exact number: text that is read exactly, or a bare literal.
pub(crate) struct Number;

impl JsonSchema for Number {
    fn schema_name() -> Cow<'static, str> {
        "Number".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "An exact number: [+-]digits[.digits][e[+-]digits] or integer/integer with a positive denominator, as a string or bare. A bare 0.1 is 1/10.",
            "anyOf": [
                { "type": "number" },
                { "type": "string", "pattern": "^[+-]?[0-9]+((\\.[0-9]+)?([eE][+-]?[0-9]+)?|/\\+?0*[1-9][0-9]*)$" }
            ]
        })
    }
}

/// A point or vector: x to the right, y up.
pub(crate) type Point = [Number; 2];

/// A simple polygon by its vertices, in either sense, closed implicitly.
#[derive(JsonSchema)]
#[schemars(transparent)]
pub(crate) struct Ring(#[schemars(length(min = 3))] Vec<Point>);

/// A scene for snapfit: fixed obstacles, pawls on torsional springs, and a plan along which the
/// root carries them.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct SceneDocument {
    scene: SceneSection,
    /// Fixed bodies; they may touch or overlap each other.
    #[schemars(length(min = 1))]
    obstacle: Vec<ObstacleTable>,
    /// The body that carries the pawls. Left out: no root collision is modelled.
    root: Option<RootSection>,
    /// The pawls; each moves independently of the others.
    #[schemars(length(min = 1))]
    pawl: Vec<PawlTable>,
    /// The plan: straight-line translations of the root, one after the other.
    #[schemars(length(min = 1))]
    motion: Vec<MotionTable>,
    /// What `classify` is asked.
    classify: Option<ClassifySection>,
}

/// The scene as a whole.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct SceneSection {
    /// Name of the scene.
    name: String,
    /// Coulomb's μ, at least 0. Left out: no friction is modelled.
    friction: Option<Number>,
}

/// A fixed body.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct ObstacleTable {
    /// Name, unique among the obstacles.
    name: String,
    /// The outer boundary.
    vertices: Ring,
    /// Holes inside it, disjoint.
    holes: Option<Vec<Ring>>,
}

/// The root body.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct RootSection {
    /// Drawn at time 0.
    vertices: Ring,
    /// The point that torques on the root are about. Left out: the first hinge at time 0.
    reference: Option<Point>,
}

/// A pawl on a torsional spring, at rest as drawn.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct PawlTable {
    /// Name, unique among the pawls.
    name: String,
    /// Drawn position of the hinge at time 0.
    hinge: Point,
    /// Drawn at time 0 and at rest.
    vertices: Ring,
    /// Torque per radian, positive. Left out: no forces are modelled.
    stiffness: Option<Number>,
    /// tan(θ/2) at time 0. Left out: 0, or the limit nearest to it.
    start: Option<Number>,
    /// Angular stops, tan(θ/2), the lower one first.
    limits: Option<[Number; 2]>,
}

/// One phase of the plan.
#[derive(JsonSchema)]
#[serde(untagged)]
enum MotionTable {
    /// A translation for a duration.
    Timed(TimedMotion),
    /// A translation until the root collides.
    UntilRootCollision(RootCollisionMotion),
    /// Back along the phase before.
    Reverse(ReverseMotion),
}

/// A translation for a duration, or until the root collides if that is earlier.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct TimedMotion {
    /// Velocity of the root, not zero.
    velocity: Point,
    /// Positive.
    duration: Number,
    /// Ends where the root collides; the duration is then the upper bound.
    until: Option<Until>,
}

/// A translation until the root collides.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct RootCollisionMotion {
    /// Velocity of the root, not zero.
    velocity: Point,
    /// Ends where the root collides.
    until: Until,
}

/// Back along the phase before, at its speed, for as long as it really lasted.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct ReverseMotion {
    /// Always true.
    #[schemars(extend("const" = true))]
    reverse: bool,
}

/// What ends a phase besides its duration.
#[derive(JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Until {
    /// The root collides with an obstacle.
    RootCollision,
}

/// What `classify` is asked.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct ClassifySection {
    /// The control family, none of them zero. Left out: the reverse of the plan's last phase that
    /// is no reverse.
    directions: Option<Vec<Point>>,
    /// Decide every direction of the circle too.
    total: Option<bool>,
    /// The modulus bound of a force diode.
    force_limit: Option<Number>,
    /// How far a direction of the circle must run to be a way out (with `total`). The family's
    /// directions run the length of the phase that they reverse. Left out: past the bounding box
    /// of the scene.
    escape_distance: Option<Number>,
}
