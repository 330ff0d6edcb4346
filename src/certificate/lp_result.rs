//! What a result says besides its certificate must agree with it.
//!
//! A reader looks at `objective`, `bounds`, `primal` and `dual` and not at the certificate, so
//! these are held against what the certificate has proven. A result holds what
//! [`crate::lp::report::to_json`] writes for its status and nothing else: every number in it is
//! either checked here or is a count of what the solver did (`float_iterations`,
//! `exact_pivots`), which proves nothing and is claimed by nobody; a key, a table or a type that
//! is not written for that status is refused, since nothing would prove what it says.

use super::lp::{Claim, Point, Prices, Rejection, reject};
use crate::lp::{Certificate, Model, Status, Vector};
use crate::number::{Int, Rat};
use serde_json::{Value, json};

/// Keys of every result.
const ALWAYS: [&str; 14] = [
    "schema",
    "model",
    "name",
    "sense",
    "rows",
    "columns",
    "status",
    "objective",
    "bounds",
    "method",
    "accuracy",
    "float_iterations",
    "exact_pivots",
    "certificate",
];

/// Keys that a result may have.
const SOMETIMES: [&str; 6] = [
    "reason",
    "relaxed",
    "ignored_objective_rhs",
    "negative_upper_bounds",
    "primal",
    "dual",
];

/// The relative distance within which two bounds are an optimum: 1 in so many.
const CLOSE: i64 = 1_000_000_000;

/// Checks the rest of a result whose claim [`super::lp::verify`] has accepted.
///
/// # Errors
/// What disagrees.
pub fn agrees(model: &Model, claim: &Claim, result: &Value) -> Result<(), Rejection> {
    form(model, result)?;
    certificate(claim, &result["certificate"])?;
    let enclosed = matches!(claim.certificate, Certificate::Bounds { .. });
    match (enclosed, claim.status) {
        (true, Status::Optimal) => word(result, "accuracy", &["bounds"])?,
        // An exact proof may be found where less was asked for, and less where that was.
        _ => word(result, "accuracy", &["exact", "bounds"])?,
    }
    numbers(model, claim, result)?;
    vectors(model, claim, result)
}

/// Checks that an undecided result without a certificate claims nothing indeed.
///
/// # Errors
/// What it claims, with nothing to prove it, or what is wrong with its form.
pub fn claims_nothing(model: &Model, result: &Value) -> Result<(), Rejection> {
    form(model, result)?;
    word(result, "status", &["undecided"])?;
    word(result, "accuracy", &["exact", "bounds", "float"])?;
    if !result["certificate"].is_null() {
        return reject("there is a certificate");
    }
    without_objective(result)?;
    without_bounds(result)?;
    unlisted(result, &["primal", "dual"])
}

/// A table with these keys and no others.
fn keys(what: &str, value: &Value, always: &[&str], sometimes: &[&str]) -> Result<(), Rejection> {
    let Some(map) = value.as_object() else {
        return reject(format!("{what} is no table"));
    };
    if let Some(key) = always.iter().find(|k| !map.contains_key(**k)) {
        return reject(format!("{what} has no `{key}`"));
    }
    let known = |k: &str| always.contains(&k) || sometimes.contains(&k);
    match map.keys().find(|k| !known(k)) {
        Some(key) => reject(format!("{what} has `{key}`, which nothing proves")),
        None => Ok(()),
    }
}

fn word(result: &Value, name: &str, right: &[&str]) -> Result<(), Rejection> {
    match result[name].as_str() {
        Some(w) if right.contains(&w) => Ok(()),
        _ => reject(format!("`{name}` is not {}", right.join(" or "))),
    }
}

/// The words and counts that say what kind of result it is, of which model.
fn form(model: &Model, result: &Value) -> Result<(), Rejection> {
    keys("the result", result, &ALWAYS, &SOMETIMES)?;
    let count = |name: &str, right: usize| match result[name].as_u64() {
        Some(n) if n == right as u64 => Ok(()),
        _ => reject(format!("the model has {right} {name}")),
    };
    word(result, "schema", &["snapfit.lp/1"])?;
    word(result, "name", &[&model.name])?;
    let sense = ["minimize", "maximize"][usize::from(model.maximise)];
    word(result, "sense", &[sense])?;
    word(result, "method", &["warm", "exact"])?;
    count("rows", model.rows.len())?;
    count("columns", model.columns.len())?;
    for name in ["float_iterations", "exact_pivots"] {
        if !result[name].is_u64() {
            return reject(format!("`{name}` is no count"));
        }
    }
    if !result["model"].is_string() {
        return reject("`model` is no text");
    }
    match (result.get("reason"), result["status"] == "undecided") {
        (None, _) | (Some(Value::String(_)), true) => {}
        (Some(_), true) => return reject("`reason` is no text"),
        (Some(_), false) => return reject("there is a `reason` for what is decided"),
    }
    let relaxed = model.relaxed.then_some(Value::Bool(true));
    if result.get("relaxed") != relaxed.as_ref() {
        return reject("`relaxed` is not what the model's integers say");
    }
    let ignored = model.ignored_rhs.as_ref().map(|v| json!(v.to_string()));
    if result.get("ignored_objective_rhs") != ignored.as_ref() {
        return reject("`ignored_objective_rhs` is not the model's");
    }
    let freed = model.freed_names().map(|names| json!(names));
    if result.get("negative_upper_bounds") != freed.as_ref() {
        return reject("`negative_upper_bounds` are not the model's");
    }
    Ok(())
}

/// The keys of a certificate, whose values are the claim's.
fn certificate(claim: &Claim, value: &Value) -> Result<(), Rejection> {
    let table = |what: &str, always: &[&str]| keys(what, value, always, &[]);
    let vector = |key: &str| {
        let what = format!("`certificate.{key}`");
        keys(&what, &value[key], &["denominator", "numerators"], &[])
    };
    let what = "the certificate";
    match &claim.certificate {
        Certificate::Optimal { .. } => {
            table(what, &["kind", "primal", "dual"])?;
            vector("primal").and_then(|()| vector("dual"))
        }
        Certificate::Basis { .. } => table(
            what,
            &[
                "kind",
                "columns",
                "rows",
                "order",
                "primal_denominator",
                "dual_denominator",
            ],
        ),
        Certificate::Infeasible { .. } => {
            table(what, &["kind", "prices"])?;
            vector("prices")
        }
        Certificate::Crossed { .. } => table(what, &["kind", "row", "index"]),
        Certificate::Unbounded { .. } => {
            table(what, &["kind", "point", "ray"])?;
            vector("point").and_then(|()| vector("ray"))
        }
        Certificate::Bounds {
            primal,
            dual,
            repair,
        } => {
            keys(what, value, &["kind", "primal", "dual"], &["repair"])?;
            for (key, given) in [("primal", primal), ("dual", dual)] {
                if given.is_some() {
                    vector(key)?;
                }
            }
            match (repair, value.get("repair")) {
                (None, Some(_)) => reject("`certificate.repair` is no table"),
                (None, None) => Ok(()),
                (Some(_), _) => {
                    let repair = &value["repair"];
                    keys("`certificate.repair`", repair, &["order", "margin"], &[])
                }
            }
        }
    }
}

fn without_objective(result: &Value) -> Result<(), Rejection> {
    if result["objective"].is_null() {
        return Ok(());
    }
    reject("there is an `objective`, which nothing proves")
}

/// The table of bounds, with both ends missing.
fn without_bounds(result: &Value) -> Result<(), Rejection> {
    if result["bounds"] == json!({ "lower": null, "upper": null }) {
        return Ok(());
    }
    reject("there are `bounds`, which nothing proves")
}

/// The objective's double and the enclosure.
fn numbers(model: &Model, claim: &Claim, result: &Value) -> Result<(), Rejection> {
    let objective = &result["objective"];
    keys("`bounds`", &result["bounds"], &["lower", "upper"], &[])?;
    match (&claim.certificate, claim.status) {
        (Certificate::Optimal { .. } | Certificate::Basis { .. }, _) => {
            keys("`objective`", objective, &["value", "exact"], &[])?;
            let exact = &objective["exact"];
            keys("`objective.exact`", exact, &["rational"], &[])?;
            let Some(o) = &claim.objective else {
                return reject("no objective is claimed");
            };
            nearest(&objective["value"], o)?;
            match &claim.enclosure {
                (Some(lower), Some(upper)) if lower == o && upper == o => Ok(()),
                _ => reject("`bounds` are not those of the objective"),
            }
        }
        (Certificate::Bounds { .. }, Status::Optimal) => {
            let (Some(lower), Some(upper)) = &claim.enclosure else {
                return reject("an optimum is claimed that is bounded on one side only");
            };
            let one = Rat::one();
            let size = [lower.abs(), upper.abs()].into_iter().fold(one, Rat::max);
            if (upper - lower).abs() * Rat::from(CLOSE) > size {
                return reject("an optimum is claimed, and `bounds` are too far apart for one");
            }
            // What stands there is the double of the feasible point's objective, and no proof.
            keys("`objective`", objective, &["value"], &[])?;
            let point = if model.maximise { lower } else { upper };
            nearest(&objective["value"], point)
        }
        (Certificate::Bounds { .. }, _) => {
            if claim.enclosure == (None, None) {
                return reject("the certificate of bounds bounds nothing");
            }
            without_objective(result)
        }
        _ => without_objective(result).and_then(|()| without_bounds(result)),
    }
}

/// The double nearest to a number, as JSON; null past the double range.
fn nearest(value: &Value, right: &Rat) -> Result<(), Rejection> {
    // An integer that is no double would be rounded unseen.
    let whole = value.as_i64().map(i64::unsigned_abs);
    let double = value.is_f64() || whole.is_some_and(|v| v <= 1 << 53);
    let held = match right.nearest_f64() {
        None => value.is_null(),
        Some(v) => double && value.as_f64() == Some(v),
    };
    if held {
        return Ok(());
    }
    reject("`objective.value` is not the double nearest to the objective that is proven")
}

/// None of these tables is there.
fn unlisted(result: &Value, tables: &[&str]) -> Result<(), Rejection> {
    match tables.iter().find(|t| result.get(**t).is_some()) {
        Some(table) => reject(format!("there is `{table}`, which nothing proves")),
        None => Ok(()),
    }
}

/// `primal` and `dual`, where they are written out.
fn vectors(model: &Model, claim: &Claim, result: &Value) -> Result<(), Rejection> {
    let objective = match (&claim.certificate, &claim.objective) {
        (Certificate::Optimal { .. } | Certificate::Basis { .. }, Some(o)) => Some(o),
        // Of what improves without end a feasible point may be listed.
        (Certificate::Unbounded { .. }, _) => {
            unlisted(result, &["dual"])?;
            None
        }
        _ => return unlisted(result, &["primal", "dual"]),
    };
    if let Some(table) = result.get("primal") {
        let columns = model.columns.iter().map(|c| c.name.as_str());
        let x = Point::new(model, &listed("primal", table, columns)?)?;
        x.feasible(model)?;
        if objective.is_some_and(|o| x.objective(model) != *o) {
            return reject("`primal` has another objective");
        }
    }
    if let Some(table) = result.get("dual") {
        let rows = model.rows.iter().map(|r| r.name.as_str());
        let y = Prices::new(model, &listed("dual", table, rows)?)?;
        if objective != Some(&y.bound(model)?) {
            return reject("`dual` has another objective");
        }
    }
    Ok(())
}

/// A vector written out by names, all of them.
fn listed<'a>(
    what: &str,
    value: &Value,
    names: impl Iterator<Item = &'a str>,
) -> Result<Vector, Rejection> {
    let Some(map) = value.as_object() else {
        return reject(format!("`{what}` is no table"));
    };
    let mut numerators = Vec::new();
    let mut count = 0;
    for (name, index) in names.zip(0u32..) {
        let Some(text) = map.get(name).and_then(Value::as_str) else {
            return reject(format!("`{what}` says nothing of `{name}`"));
        };
        let v = crate::lp::report::rational(text).map_err(Rejection)?;
        count += 1;
        if !v.is_zero() {
            numerators.push((index, v));
        }
    }
    if count != map.len() {
        return reject(format!("`{what}` has names that the model has not"));
    }
    Ok(Vector {
        denominator: Int::one(),
        numerators,
    })
}
