//! `snapfit schema slice` against what `snapfit slice` prints: every document of random scenes and of every
//! scene of the project holds to the schema, and a document that is damaged does not.

#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/world/mod.rs"]
mod world;

use common::count;
use serde_json::{Value, json};
use snapfit::motion::{Options, Seen, slices};
use snapfit::number::Rat;
use snapfit::report::slice::{SliceDocument, slice_schema};
use snapfit::scene::{Scene, read_scene};
use world::scenes::{Recipe, random_scene};

/// As much of JSON Schema as this schema uses; a keyword that is not known here fails the test.
fn validate(root: &Value, schema: &Value, value: &Value) -> Result<(), String> {
    let rules = schema.as_object().ok_or("not a schema")?;
    for (keyword, rule) in rules {
        let ok = match keyword.as_str() {
            "$schema" | "$id" | "$defs" | "title" | "description" | "format" => true,
            "$ref" => {
                let name = rule.as_str().unwrap().strip_prefix("#/$defs/").unwrap();
                validate(root, &root["$defs"][name], value)?;
                true
            }
            "type" => {
                let names = match rule {
                    Value::Array(names) => names.clone(),
                    one => vec![one.clone()],
                };
                names.iter().any(|n| match n.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "integer" => value.is_i64() || value.is_u64(),
                    "number" => value.is_number(),
                    "boolean" => value.is_boolean(),
                    "null" => value.is_null(),
                    other => panic!("type {other}"),
                })
            }
            "const" => rule == value,
            "pattern" => {
                let (text, rule) = (value.as_str(), rule.as_str().unwrap());
                match rule.strip_prefix("^(").and_then(|w| w.strip_suffix(")$")) {
                    // One word of several.
                    Some(words) => text.is_none_or(|v| words.split('|').any(|w| w == v)),
                    // A rational.
                    None => text.is_none_or(|v| v.parse::<Rat>().is_ok()),
                }
            }
            "enum" => rule.as_array().unwrap().contains(value),
            "anyOf" | "oneOf" => {
                let ways = rule.as_array().unwrap();
                let fits = ways.iter().filter(|w| validate(root, w, value).is_ok());
                let fits = fits.count();
                fits == 1 || (fits > 1 && keyword == "anyOf")
            }
            "minimum" => value.as_f64().is_none_or(|v| v >= rule.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|v| v <= rule.as_f64().unwrap()),
            "minItems" => value
                .as_array()
                .is_none_or(|v| v.len() as u64 >= rule.as_u64().unwrap()),
            "maxItems" => value
                .as_array()
                .is_none_or(|v| v.len() as u64 <= rule.as_u64().unwrap()),
            "items" => {
                for item in value.as_array().into_iter().flatten() {
                    validate(root, rule, item)?;
                }
                true
            }
            "required" => rule
                .as_array()
                .unwrap()
                .iter()
                .all(|name| value.get(name.as_str().unwrap()).is_some()),
            "properties" => {
                for (name, rule) in rule.as_object().unwrap() {
                    if let Some(part) = value.get(name) {
                        validate(root, rule, part).map_err(|e| format!("{name}: {e}"))?;
                    }
                }
                true
            }
            other => return Err(format!("the test does not know the keyword {other}")),
        };
        if !ok {
            let mut text = value.to_string();
            text.truncate(200);
            return Err(format!("{keyword} {rule} does not hold for {text}"));
        }
    }
    Ok(())
}

/// The document of a slice with a question of each kind.
fn asked(scene: &Scene, seen: &Seen) -> Value {
    let mut d = SliceDocument::new(scene, seen);
    let t = &seen.slice.frame.duration * &Rat::frac(2, 7);
    for u in [Rat::zero(), Rat::frac(-9, 8)] {
        d.reach(seen, &t, Some(&u));
        if seen.may_start(scene, &u) {
            d.run(scene, seen, &u);
        }
    }
    d.reach(seen, &t, None);
    d.intervals(seen, &t);
    serde_json::to_value(&d).unwrap()
}

/// Every object's keys are known to the schema's definitions: nothing is printed that is not described.
fn described(root: &Value, value: &Value) {
    let known = |key: &str| {
        let text = root.to_string();
        text.contains(&format!("\"{key}\":"))
    };
    match value {
        Value::Object(map) => {
            for (key, v) in map {
                assert!(known(key), "{key} is not in the schema");
                described(root, v);
            }
        }
        Value::Array(list) => list.iter().take(3).for_each(|v| described(root, v)),
        _ => {}
    }
}

#[test]
fn every_document_holds_to_the_schema() {
    let root = serde_json::to_value(slice_schema()).unwrap();
    assert_eq!(root["$id"], "snapfit.slice/1");
    let (mut documents, mut free, mut runs) = (0, 0, 0);
    let mut see = |scene: &Scene, seen: &Seen| {
        let doc = asked(scene, seen);
        validate(&root, &root, &doc).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        described(&root, &doc);
        documents += 1;
        free += usize::from(!doc["free"].is_null());
        let queries = doc["queries"].as_array().unwrap();
        runs += queries.iter().filter(|q| q["query"] == "run").count();
    };
    for seed in (0..count(3_000) as u64).map(|k| 16_000_000 + k) {
        let scene = random_scene(&Recipe::draw(seed));
        slices(&scene, &Options::default(), &mut |s| see(&scene, &s)).unwrap();
    }
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        if path.extension().is_some_and(|e| e == "toml")
            && let Ok(file) = read_scene("scene.toml", &text)
        {
            slices(file.scene(), &Options::default(), &mut |s| {
                see(file.scene(), &s)
            })
            .unwrap();
        }
    }
    eprintln!("{documents} documents, {free} with an F, {runs} runs");
    assert!(free > 10 && runs > 10);
}

/// Whatever is taken out of a document, or turned into something else, is missed.
#[test]
fn a_damaged_document_does_not() {
    let root = serde_json::to_value(slice_schema()).unwrap();
    let mut doc = None;
    let mut seed = 16_100_000;
    while doc.is_none() {
        let scene = random_scene(&Recipe::draw(seed));
        slices(&scene, &Options::default(), &mut |s| {
            if s.free.as_ref().is_some_and(|f| f.edges().len() > 4) {
                doc = Some(asked(&scene, &s));
            }
        })
        .unwrap();
        seed += 1;
    }
    let doc = doc.unwrap();
    validate(&root, &root, &doc).unwrap();
    let bad = |path: &str, with: Option<Value>| {
        let mut damaged = doc.clone();
        let (parent, key) = path.rsplit_once('/').unwrap();
        let parent = damaged.pointer_mut(parent).unwrap();
        match with {
            Some(v) => parent[key] = v,
            None => {
                parent.as_object_mut().unwrap().remove(key).unwrap();
            }
        }
        assert!(validate(&root, &root, &damaged).is_err(), "{path}");
    };
    for key in [
        "schema", "scene", "phase", "pawl", "duration", "start", "arcs", "queries",
    ] {
        bad(&format!("/{key}"), None);
        bad(&format!("/{key}"), Some(json!(-1.5)));
    }
    bad("/schema", Some(json!("snapfit.slice/2")));
    for key in ["half_edges", "components", "vertices", "edges", "cycles"] {
        bad(&format!("/free/{key}"), None);
        bad(&format!("/free/{key}"), Some(json!("x")));
    }
    bad("/free/vertices/0/time", Some(json!("soon")));
    bad("/free/vertices/0/contacts", Some(json!([{"type": "C"}])));
    bad("/free/edges/0/kind", Some(json!("cut")));
    bad("/free/edges/0/free", Some(json!([])));
    bad("/free/edges/0/free", Some(json!(["beyond"])));
    bad("/queries/0/answer", Some(json!("perhaps")));
    bad("/queries/0/query", Some(json!("guess")));
}
