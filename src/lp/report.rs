//! Results as JSON, and back again for the verifier.

use super::model::Model;
use super::outcome::{Certificate, Outcome, Place, Repair, Status, Vector};
use crate::certificate::lp::Claim;
use crate::number::{Int, Rat, literal};
use serde_json::{Map, Value, json};

/// A rational as the contract's NUM.
fn num(v: &Rat) -> Value {
    json!({ "value": v.nearest_f64(), "exact": { "rational": v.to_string() } })
}

/// The JSON of `snapfit lp`.
pub fn to_json(model: &Model, file: &str, outcome: &Outcome) -> Value {
    let text = |v: &Option<Rat>| v.as_ref().map(ToString::to_string);
    let mut out = json!({
        "schema": "snapfit.lp/1",
        "model": file,
        "name": model.name,
        "sense": if model.maximise { "maximize" } else { "minimize" },
        "rows": model.rows.len(),
        "columns": model.columns.len(),
        "status": outcome.status.word(),
        "objective": outcome.objective.as_ref().map(num),
        "bounds": { "lower": text(&outcome.enclosure.0), "upper": text(&outcome.enclosure.1) },
        "method": outcome.method,
        "accuracy": outcome.accuracy,
        "float_iterations": outcome.float_iterations,
        "exact_pivots": outcome.exact_pivots,
        "certificate": outcome.certificate.as_ref().map(|c| certificate(model, c)),
    });
    if let Some(map) = out.as_object_mut() {
        // A feasible point's objective is not the optimum's.
        let loose = matches!(outcome.certificate, Some(Certificate::Bounds { .. }));
        if (outcome.accuracy == "float" || loose)
            && let Some(Value::Object(objective)) = map.get_mut("objective")
        {
            objective.remove("exact");
        }
        if let Some(reason) = &outcome.reason {
            map.insert("reason".into(), json!(reason));
        }
        if model.relaxed {
            map.insert("relaxed".into(), json!(true));
        }
        if let Some(v) = &model.ignored_rhs {
            map.insert("ignored_objective_rhs".into(), json!(v.to_string()));
        }
        if let Some(names) = model.freed_names() {
            map.insert("negative_upper_bounds".into(), json!(names));
        }
        if let Some(values) = &outcome.values {
            let names = model.columns.iter().map(|c| c.name.clone());
            let pairs = names.zip(values.iter().map(|v| json!(v.to_string())));
            map.insert("primal".into(), Value::Object(pairs.collect()));
        }
        if let Some(prices) = &outcome.prices {
            let names = model.rows.iter().map(|r| r.name.clone());
            let pairs = names.zip(prices.iter().map(|v| json!(v.to_string())));
            map.insert("dual".into(), Value::Object(pairs.collect()));
        }
    }
    out
}

fn vector<'a>(v: &Vector, name: impl Fn(usize) -> &'a str) -> Value {
    let pairs = v.numerators.iter();
    let pairs = pairs.map(|(i, n)| (name(*i as usize).to_string(), json!(n.to_string())));
    json!({
        "denominator": v.denominator.to_string(),
        "numerators": Value::Object(pairs.collect::<Map<_, _>>()),
    })
}

fn places(list: &[Place]) -> String {
    let letter = |p: &Place| match p {
        Place::Basic => 'B',
        Place::Lower => 'L',
        Place::Upper => 'U',
        Place::Zero => 'Z',
    };
    list.iter().map(letter).collect()
}

fn certificate(model: &Model, c: &Certificate) -> Value {
    let column = |j: usize| model.columns[j].name.as_str();
    let row = |i: usize| model.rows[i].name.as_str();
    match c {
        Certificate::Optimal { primal, dual } => json!({
            "kind": "optimal", "primal": vector(primal, column), "dual": vector(dual, row),
        }),
        Certificate::Basis {
            columns,
            rows,
            order,
            primal_denominator,
            dual_denominator,
        } => json!({
            "kind": "basis", "columns": places(columns), "rows": places(rows),
            "order": order.iter().map(|&(i, j)| json!([i, j])).collect::<Vec<_>>(),
            "primal_denominator": primal_denominator.to_string(),
            "dual_denominator": dual_denominator.to_string(),
        }),
        Certificate::Infeasible { prices } => json!({
            "kind": "infeasible", "prices": vector(prices, row),
        }),
        Certificate::Crossed { row, index } => json!({
            "kind": "crossed", "row": row, "index": index,
        }),
        Certificate::Unbounded { point, ray } => json!({
            "kind": "unbounded", "point": vector(point, column), "ray": vector(ray, column),
        }),
        Certificate::Bounds {
            primal,
            dual,
            repair,
        } => {
            let mut out = json!({
                "kind": "bounds",
                "primal": primal.as_ref().map(|v| vector(v, column)),
                "dual": dual.as_ref().map(|v| vector(v, row)),
            });
            if let (Some(r), Some(map)) = (repair, out.as_object_mut()) {
                let hints = json!({ "order": r.order, "margin": r.margin });
                map.insert("repair".into(), hints);
            }
            out
        }
    }
}

/// What a result in JSON claims of a model, or what is wrong with its form.
pub fn from_json(model: &Model, result: &Value) -> Result<Claim, String> {
    let status = match result["status"].as_str() {
        Some("optimal") => Status::Optimal,
        Some("infeasible") => Status::Infeasible,
        Some("unbounded") => Status::Unbounded,
        Some("undecided") => Status::Undecided,
        _ => return Err("`status` is missing or unknown".into()),
    };
    let rational = |v: &Value| -> Result<Option<Rat>, String> {
        match v {
            Value::Null => Ok(None),
            Value::String(s) => self::rational(s).map(Some),
            _ => Err("a rational is a string".into()),
        }
    };
    let c = &result["certificate"];
    let kind = c["kind"].as_str().ok_or("the result has no certificate")?;
    let columns = Names::new(model.columns.iter().map(|c| c.name.as_str()));
    let rows = Names::new(model.rows.iter().map(|r| r.name.as_str()));
    let optional = |v: &Value, names: &Names<'_>| match v {
        Value::Null => Ok(None),
        v => names.vector(v).map(Some),
    };
    let certificate = match kind {
        "optimal" => Certificate::Optimal {
            primal: columns.vector(&c["primal"])?,
            dual: rows.vector(&c["dual"])?,
        },
        "basis" => {
            let mut order = Vec::new();
            for pair in c["order"].as_array().ok_or("`order` is missing")? {
                let part = |k: usize| pair[k].as_u64().and_then(|v| u32::try_from(v).ok());
                let two = pair.as_array().is_some_and(|p| p.len() == 2);
                let (Some(i), Some(j), true) = (part(0), part(1), two) else {
                    return Err("`order` holds pairs of indices".into());
                };
                order.push((i, j));
            }
            Certificate::Basis {
                columns: read_places(&c["columns"])?,
                rows: read_places(&c["rows"])?,
                order,
                primal_denominator: int(&c["primal_denominator"])?,
                dual_denominator: int(&c["dual_denominator"])?,
            }
        }
        "infeasible" => Certificate::Infeasible {
            prices: rows.vector(&c["prices"])?,
        },
        "crossed" => Certificate::Crossed {
            row: c["row"].as_bool().ok_or("`row` is missing")?,
            index: c["index"]
                .as_u64()
                .and_then(|v| u32::try_from(v).ok())
                .ok_or("`index` is missing")?,
        },
        "unbounded" => Certificate::Unbounded {
            point: columns.vector(&c["point"])?,
            ray: columns.vector(&c["ray"])?,
        },
        "bounds" => Certificate::Bounds {
            primal: optional(&c["primal"], &columns)?,
            dual: optional(&c["dual"], &rows)?,
            repair: match &c["repair"] {
                Value::Null => None,
                r => Some(Repair {
                    order: r["order"]
                        .as_array()
                        .ok_or("`repair.order` is missing")?
                        .iter()
                        .map(|v| v.as_u64().and_then(|v| u32::try_from(v).ok()))
                        .collect::<Option<_>>()
                        .ok_or("`repair.order` holds indices of columns")?,
                    margin: r["margin"]
                        .as_u64()
                        .and_then(|v| u32::try_from(v).ok())
                        .ok_or("`repair.margin` is missing")?,
                }),
            },
        },
        other => return Err(format!("unknown kind of certificate `{other}`")),
    };
    Ok(Claim {
        status,
        objective: rational(&result["objective"]["exact"]["rational"])?,
        enclosure: (
            rational(&result["bounds"]["lower"])?,
            rational(&result["bounds"]["upper"])?,
        ),
        certificate,
    })
}

/// Long integers pass the literal's limit on digits, which is for people.
pub(crate) fn rational(s: &str) -> Result<Rat, String> {
    if let Ok(v) = literal::parse(s) {
        return Ok(v);
    }
    let (n, d) = s.split_once('/').unwrap_or((s, "1"));
    let (n, d): (Int, Int) = (n.parse()?, d.parse()?);
    if d.sign() <= 0 {
        return Err("a denominator is not positive".into());
    }
    Ok(Rat::new(n, d))
}

fn int(v: &Value) -> Result<Int, String> {
    v.as_str().ok_or("an integer is a string")?.parse()
}

fn read_places(v: &Value) -> Result<Vec<Place>, String> {
    let letters = v.as_str().ok_or("places are missing")?.chars();
    letters
        .map(|c| match c {
            'B' => Ok(Place::Basic),
            'L' => Ok(Place::Lower),
            'U' => Ok(Place::Upper),
            'Z' => Ok(Place::Zero),
            _ => Err(format!("`{c}` is no place")),
        })
        .collect()
}

/// Names to indices.
struct Names<'a>(std::collections::HashMap<&'a str, u32>);

impl<'a> Names<'a> {
    fn new(names: impl Iterator<Item = &'a str>) -> Names<'a> {
        Names(names.zip(0..).collect())
    }

    fn vector(&self, v: &Value) -> Result<Vector, String> {
        let denominator = int(&v["denominator"])?;
        let mut numerators = Vec::new();
        for (name, n) in v["numerators"]
            .as_object()
            .ok_or("numerators are missing")?
        {
            let index = *self
                .0
                .get(name.as_str())
                .ok_or(format!("unknown name `{name}`"))?;
            numerators.push((
                index,
                self::rational(n.as_str().ok_or("a numerator is a string")?)?,
            ));
        }
        numerators.sort_by_key(|e| e.0);
        Ok(Vector {
            denominator,
            numerators,
        })
    }
}
