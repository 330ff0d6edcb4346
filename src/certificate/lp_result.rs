//! What a result says besides its certificate must agree with it.
//!
//! A reader looks at `objective`, `bounds`, `primal` and `dual` and not at the certificate, so
//! these are held against what the certificate has proven: every number that stands in a result
//! is either checked here or is a count of what the solver did (`float_iterations`,
//! `exact_pivots`), which proves nothing and is claimed by nobody.

use super::lp::{Claim, Point, Prices, Rejection, reject};
use crate::lp::{Certificate, Model, Status, Vector};
use crate::number::{Int, Rat};
use serde_json::Value;

/// Checks the rest of a result whose claim [`super::lp::verify`] has accepted.
///
/// # Errors
/// What disagrees.
pub fn agrees(model: &Model, claim: &Claim, result: &Value) -> Result<(), Rejection> {
    form(model, claim, result)?;
    numbers(claim, result)?;
    vectors(model, claim, result)
}

/// The words and counts that say what kind of result it is, of which model.
fn form(model: &Model, claim: &Claim, result: &Value) -> Result<(), Rejection> {
    let word = |name: &str, right: &[&str]| match result[name].as_str() {
        Some(w) if right.contains(&w) => Ok(()),
        _ => reject(format!("`{name}` is not {}", right.join(" or "))),
    };
    let count = |name: &str, right: usize| match result[name].as_u64() {
        Some(n) if n == right as u64 => Ok(()),
        _ => reject(format!("the model has {right} {name}")),
    };
    word("schema", &["snapfit.lp/1"])?;
    let sense = ["minimize", "maximize"][usize::from(model.maximise)];
    word("sense", &[sense])?;
    count("rows", model.rows.len())?;
    count("columns", model.columns.len())?;
    if result["relaxed"].as_bool().unwrap_or(false) != model.relaxed {
        return reject("`relaxed` is not what the model's integers say");
    }
    let ignored = model.ignored_rhs.as_ref().map(ToString::to_string);
    if result["ignored_objective_rhs"].as_str() != ignored.as_deref() {
        return reject("`ignored_objective_rhs` is not the model's");
    }
    let enclosed = matches!(claim.certificate, Certificate::Bounds { .. });
    match (enclosed, claim.status) {
        (true, Status::Optimal) => word("accuracy", &["bounds"]),
        // An exact proof may be found where less was asked for, and less where that was.
        _ => word("accuracy", &["exact", "bounds"]),
    }
}

/// The objective's double and the enclosure.
fn numbers(claim: &Claim, result: &Value) -> Result<(), Rejection> {
    let value = &result["objective"]["value"];
    if matches!(claim.status, Status::Infeasible | Status::Unbounded) {
        let ends = [
            &result["objective"],
            &result["bounds"]["lower"],
            &result["bounds"]["upper"],
        ];
        return if ends.iter().all(|v| v.is_null()) {
            Ok(())
        } else {
            reject("there is no optimum to speak of")
        };
    }
    match (&claim.objective, value.as_f64()) {
        (Some(o), v) if v != o.nearest_f64() => {
            return reject("`objective.value` is not the double nearest to the exact objective");
        }
        (None, Some(v)) => {
            let v = Rat::from_f64(v);
            let below = claim
                .enclosure
                .0
                .as_ref()
                .is_some_and(|l| v < double(l, -1));
            let above = claim.enclosure.1.as_ref().is_some_and(|u| v > double(u, 1));
            if below || above {
                return reject("`objective.value` is outside `bounds`");
            }
        }
        _ => {}
    }
    let Some(o) = &claim.objective else {
        return Ok(());
    };
    let (below, above) = &claim.enclosure;
    let held = if exact(claim) {
        below.as_ref() == Some(o) && above.as_ref() == Some(o)
    } else {
        below.as_ref().is_none_or(|l| l <= o) && above.as_ref().is_none_or(|u| u >= o)
    };
    if !held {
        return reject("`bounds` are not those of the objective");
    }
    Ok(())
}

/// A bound with room for the rounding of a double that was made of it.
fn double(bound: &Rat, side: i64) -> Rat {
    let size = Rat::from(side) * bound.abs();
    bound + &(size / Rat::from(1i64 << 52))
}

/// `primal` and `dual`, where they are written out.
fn vectors(model: &Model, claim: &Claim, result: &Value) -> Result<(), Rejection> {
    let columns = model.columns.iter().map(|c| c.name.as_str());
    let rows = model.rows.iter().map(|r| r.name.as_str());
    let primal = listed("primal", &result["primal"], columns)?;
    let dual = listed("dual", &result["dual"], rows)?;
    if primal.is_none() && dual.is_none() {
        return Ok(());
    }
    let Some(objective) = claim.objective.as_ref().filter(|_| exact(claim)) else {
        return loose(model, claim, primal, dual);
    };
    if let Some(v) = primal {
        let x = Point::new(model, &v)?;
        x.feasible(model)?;
        if x.objective(model) != *objective {
            return reject("`primal` has another objective");
        }
    }
    if let Some(v) = dual
        && Prices::new(model, &v)?.bound(model)? != *objective
    {
        return reject("`dual` has another objective");
    }
    Ok(())
}

/// Whether the certificate proves the objective itself.
fn exact(claim: &Claim) -> bool {
    matches!(
        claim.certificate,
        Certificate::Optimal { .. } | Certificate::Basis { .. }
    )
}

/// Without an exact objective a listed point is feasible and listed prices bound what is claimed.
fn loose(
    model: &Model,
    claim: &Claim,
    primal: Option<Vector>,
    dual: Option<Vector>,
) -> Result<(), Rejection> {
    let (below, above) = if model.maximise {
        (&claim.enclosure.0, &claim.enclosure.1)
    } else {
        (&claim.enclosure.1, &claim.enclosure.0)
    };
    if let Some(v) = primal {
        let x = Point::new(model, &v)?;
        x.feasible(model)?;
        if claim.status == Status::Optimal && below.as_ref() != Some(&x.objective(model)) {
            return reject("`primal` has another objective than the enclosure's end");
        }
    }
    if let Some(v) = dual
        && claim.status == Status::Optimal
        && above.as_ref() != Some(&Prices::new(model, &v)?.bound(model)?)
    {
        return reject("`dual` has another objective than the enclosure's end");
    }
    Ok(())
}

/// A vector written out by names, all of them.
fn listed<'a>(
    what: &str,
    value: &Value,
    names: impl Iterator<Item = &'a str>,
) -> Result<Option<Vector>, Rejection> {
    let map = match value {
        Value::Null => return Ok(None),
        Value::Object(map) => map,
        _ => return reject(format!("`{what}` is no table")),
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
    Ok(Some(Vector {
        denominator: Int::one(),
        numerators,
    }))
}
