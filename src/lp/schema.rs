//! The JSON Schema of what `snapfit lp` prints, as [`super::report::to_json`] writes it.

use schemars::{Schema, json_schema};
use serde_json::{Value, json};

/// A sparse vector over one denominator, by names.
fn vector(of: &str) -> Value {
    json!({
        "type": "object",
        "description": format!("{of}: `numerators` over `denominator`; what is not named is zero."),
        "required": ["denominator", "numerators"],
        "additionalProperties": false,
        "properties": {
            "denominator": { "$ref": "#/$defs/Integer", "description": "Positive." },
            "numerators": {
                "type": "object",
                "additionalProperties": { "$ref": "#/$defs/Rational" },
            },
        },
    })
}

/// One kind of certificate.
fn kind(name: &str, what: &str, parts: Value, optional: &[&str]) -> Value {
    let mut properties = parts;
    let mut required = vec!["kind".to_owned()];
    if let Some(map) = properties.as_object_mut() {
        let keys = map.keys().filter(|k| !optional.contains(&k.as_str()));
        required.extend(keys.cloned());
        map.insert("kind".into(), json!({ "const": name }));
    }
    json!({
        "type": "object",
        "description": what,
        "required": required,
        "additionalProperties": false,
        "properties": properties,
    })
}

/// The kinds of certificates.
fn kinds() -> Value {
    let places = json!({ "type": "string", "pattern": "^[BLUZ]*$",
        "description": "A letter for each: basic, at its lower bound, at its upper one, free at zero." });
    let index = json!({ "type": "integer", "minimum": 0 });
    let or_null = |schema: Value| json!({ "anyOf": [schema, { "type": "null" }] });
    let integer = json!({ "$ref": "#/$defs/Integer" });
    json!([
        kind(
            "optimal",
            "A feasible point and prices of the same objective.",
            json!({ "primal": vector("Values of the columns"), "dual": vector("Prices of the rows") }),
            &[]
        ),
        kind(
            "basis",
            "An optimal basis, where its point and prices would be too long.",
            json!({
                "columns": places, "rows": places,
                "order": { "type": "array", "description": "Rows and columns in an order of elimination.",
                    "items": { "type": "array", "items": index, "minItems": 2, "maxItems": 2 } },
                "primal_denominator": integer, "dual_denominator": integer,
            }),
            &[]
        ),
        kind(
            "infeasible",
            "Prices with which the bounds contradict each other.",
            json!({ "prices": vector("Prices of the rows") }),
            &[]
        ),
        kind(
            "crossed",
            "A row or column whose lower bound is above its upper one.",
            json!({ "row": { "type": "boolean", "description": "Whether a row is meant." }, "index": index }),
            &[]
        ),
        kind(
            "unbounded",
            "A feasible point and a direction in which it improves without end.",
            json!({ "point": vector("Values of the columns"), "ray": vector("Change of the columns") }),
            &[]
        ),
        kind(
            "bounds",
            "A feasible point, prices, or both; their objectives are `bounds`.",
            json!({
                "primal": or_null(vector("Values of the columns")),
                "dual": or_null(vector("Prices of the rows")),
                "repair": { "type": "object", "required": ["order", "margin"], "additionalProperties": false,
                    "description": "Where the prices are feasible but for a remainder: what helps to prove \
                        that feasible ones are as near as the bound needs.",
                    "properties": { "order": { "type": "array", "items": index }, "margin": index } },
            }),
            &["repair"]
        ),
    ])
}

/// The JSON Schema of what `snapfit lp` prints (draft 2020-12), as `snapfit schema lp` prints it.
pub fn lp_schema() -> Schema {
    let table = |what: &str| {
        json!({ "type": "object", "description": what,
            "additionalProperties": { "$ref": "#/$defs/Rational" } })
    };
    let end = |what: &str| json!({ "anyOf": [{ "$ref": "#/$defs/Rational" }, { "type": "null" }], "description": what });
    json_schema!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "snapfit.lp/1",
        "title": "LpDocument",
        "description": "What `snapfit lp` prints; `snapfit verify` refuses any key that is not told here.",
        "type": "object",
        "required": ["schema", "model", "name", "sense", "rows", "columns", "status", "objective", "bounds",
            "method", "accuracy", "float_iterations", "exact_pivots", "certificate"],
        "additionalProperties": false,
        "properties": {
            "schema": { "const": "snapfit.lp/1" },
            "model": { "type": "string", "description": "The file of the model, as it was named; `-` is standard input." },
            "name": { "type": "string", "description": "The model's own name, possibly empty." },
            "sense": { "enum": ["minimize", "maximize"] },
            "rows": { "type": "integer", "minimum": 0, "description": "How many." },
            "columns": { "type": "integer", "minimum": 0, "description": "How many." },
            "status": { "enum": ["optimal", "infeasible", "unbounded", "undecided"],
                "description": "How it ended; undecided: a limit was reached first." },
            "reason": { "type": "string", "description": "Why nothing was decided." },
            "objective": {
                "description": "The optimum; null where there is none or it is not known. Without `exact` it is that of a \
                    feasible point within `bounds`, or, with accuracy `float`, what doubles say.",
                "anyOf": [
                    { "type": "null" },
                    { "type": "object", "required": ["value"], "additionalProperties": false, "properties": {
                        "value": { "type": ["number", "null"],
                            "description": "The nearest double, ties to even; null past the double range." },
                        "exact": { "type": "object", "required": ["rational"], "additionalProperties": false,
                            "properties": { "rational": { "$ref": "#/$defs/Rational" } } },
                    } },
                ],
            },
            "bounds": { "type": "object", "required": ["lower", "upper"], "additionalProperties": false,
                "description": "Proven: the optimum lies between these, ends included.",
                "properties": { "lower": end("Null: not known."), "upper": end("Null: not known.") } },
            "method": { "enum": ["warm", "exact"], "description": "As asked for by --method." },
            "accuracy": { "enum": ["float", "bounds", "exact"], "description": "As asked for by --accuracy." },
            "float_iterations": { "type": "integer", "minimum": 0, "description": "Iterations in doubles." },
            "exact_pivots": { "type": "integer", "minimum": 0, "description": "Pivots of the exact simplex method." },
            "certificate": { "description": "The proof; null where nothing is proven.",
                "anyOf": [{ "type": "null" }, { "$ref": "#/$defs/Certificate" }] },
            "relaxed": { "const": true, "description": "The model asks for integers, which were left out." },
            "ignored_objective_rhs": { "$ref": "#/$defs/Rational",
                "description": "The objective's right-hand side in an MPS file, which is not part of the objective." },
            "negative_upper_bounds": { "type": "array", "minItems": 1, "items": { "type": "string" },
                "description": "Columns to which an MPS file gives a negative upper bound and no lower one, which is \
                    then minus infinity." },
            "primal": table("With --values: the value of every column, at an optimum or of a feasible point."),
            "dual": table("With --values: the price of every row."),
        },
        "$defs": {
            "Rational": { "type": "string", "pattern": "^-?[0-9]+(/[1-9][0-9]*)?$",
                "description": "`p` or `p/q` in lowest terms." },
            "Integer": { "type": "string", "pattern": "^-?[0-9]+$" },
            "Certificate": { "description": "What `snapfit verify` checks.", "oneOf": kinds() },
        },
    })
}
