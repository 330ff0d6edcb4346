//! The schema against the reader: the same keys, and every scene that reads also validates.
#![allow(clippy::unwrap_used)]

use serde_json::{Map, Value};
use snapfit::scene::{read_scene, scene_schema};
use std::collections::{BTreeMap, BTreeSet};

fn schema() -> Value {
    serde_json::to_value(scene_schema()).expect("a schema is JSON")
}

/// As much of JSON Schema as a scene's schema uses; anything else fails the test.
fn validate(root: &Value, schema: &Value, value: &Value) -> Result<(), String> {
    let Some(rules) = schema.as_object() else {
        return Err(format!("not a schema: {schema}"));
    };
    for (keyword, rule) in rules {
        validate_keyword(root, rules, keyword, rule, value)
            .map_err(|e| format!("{e}\n in {value}"))?;
    }
    Ok(())
}

fn validate_keyword(
    root: &Value,
    rules: &Map<String, Value>,
    keyword: &str,
    rule: &Value,
    value: &Value,
) -> Result<(), String> {
    let fail = || Err(format!("{keyword}: {rule}"));
    match keyword {
        "$schema" | "$id" | "$defs" | "title" | "description" => Ok(()),
        "$ref" => {
            let name = rule.as_str().and_then(|r| r.strip_prefix("#/$defs/"));
            let name = name.ok_or_else(|| format!("a reference to {rule}"))?;
            validate(root, &root["$defs"][name], value)
        }
        "type" => {
            let holds = match rule.as_str() {
                Some("object") => value.is_object(),
                Some("array") => value.is_array(),
                Some("string") => value.is_string(),
                Some("number") => value.is_number(),
                Some("boolean") => value.is_boolean(),
                _ => return Err(format!("a type {rule}")),
            };
            if holds { Ok(()) } else { fail() }
        }
        "anyOf" | "oneOf" => {
            let ways = rule.as_array().expect("a list");
            let fits = ways
                .iter()
                .filter(|way| validate(root, way, value).is_ok())
                .count();
            if fits == 1 || (fits > 1 && keyword == "anyOf") {
                Ok(())
            } else {
                fail()
            }
        }
        "const" => {
            if rule == value {
                Ok(())
            } else {
                fail()
            }
        }
        // The grammar of numbers is the reader's to test.
        "pattern" => {
            let text = value.as_str().unwrap_or("0");
            snapfit::number::literal::parse(text).map_or_else(|_| fail(), |_| Ok(()))
        }
        "items" => value
            .as_array()
            .into_iter()
            .flatten()
            .try_for_each(|item| validate(root, rule, item)),
        "minItems" | "maxItems" => {
            let count = value.as_array().map(|items| items.len() as u64);
            let bound = rule.as_u64().expect("a count");
            let holds = count.is_none_or(|n| {
                if keyword == "minItems" {
                    n >= bound
                } else {
                    n <= bound
                }
            });
            if holds { Ok(()) } else { fail() }
        }
        "required" => {
            let names = rule.as_array().expect("a list");
            let missing = names
                .iter()
                .find(|name| value.get(name.as_str().unwrap_or("")).is_none());
            missing.map_or(Ok(()), |name| Err(format!("{name} is missing")))
        }
        "properties" => {
            for (name, rule) in rule.as_object().expect("a table") {
                if let Some(part) = value.get(name) {
                    validate(root, rule, part)?;
                }
            }
            Ok(())
        }
        "additionalProperties" => {
            assert_eq!(rule, false);
            let known = rules["properties"].as_object().expect("a table");
            let keys = value.as_object().into_iter().flat_map(Map::keys);
            match keys.into_iter().find(|key| !known.contains_key(*key)) {
                Some(key) => Err(format!("{key} is not known")),
                None => Ok(()),
            }
        }
        _ => Err(format!("the test does not know the keyword {keyword}")),
    }
}

/// The keys of every table of the format as the schema has them, by the key that holds the table.
fn keys_of_schema() -> BTreeMap<String, BTreeSet<String>> {
    let root = schema();
    let mut tables = BTreeMap::new();
    let keys = |schema: &Value| -> BTreeSet<String> {
        let mut ways = vec![schema.clone()];
        let mut keys = BTreeSet::new();
        while let Some(way) = ways.pop() {
            if let Some(name) = way.get("$ref").and_then(Value::as_str) {
                ways.push(root["$defs"][name.trim_start_matches("#/$defs/")].clone());
            }
            ways.extend(
                way.get("anyOf")
                    .and_then(Value::as_array)
                    .cloned()
                    .unwrap_or_default(),
            );
            ways.extend(way.get("items").cloned());
            let properties = way.get("properties").and_then(Value::as_object);
            keys.extend(properties.into_iter().flat_map(|p| p.keys().cloned()));
        }
        keys
    };
    for (section, schema) in root["properties"].as_object().expect("sections") {
        tables.insert(section.clone(), keys(schema));
    }
    tables.insert(String::new(), tables.keys().cloned().collect());
    tables
}

/// The reader says which keys it knows when it meets one that it does not know.
fn keys_of_reader(table: &str) -> BTreeSet<String> {
    let strange = "zzzzzzzzzzzz";
    let text = match table {
        "" => format!("{strange} = 1"),
        "obstacle" | "pawl" | "motion" => format!("[[{table}]]\n{strange} = 1"),
        _ => format!("[{table}]\n{strange} = 1"),
    };
    let found = read_scene("x.toml", &text).expect_err("a strange key");
    let unknown = found
        .iter()
        .find(|d| d.code() == "unknown-key")
        .expect("unknown-key");
    let advice = unknown.advice().expect("advice");
    let list = advice
        .strip_prefix("the keys here are: ")
        .expect("a list of keys");
    list.split(", ").map(str::to_owned).collect()
}

#[test]
fn reader_and_schema_know_the_same_keys() {
    let schema = keys_of_schema();
    assert_eq!(schema.len(), 7);
    for (table, keys) in schema {
        assert_eq!(keys, keys_of_reader(&table), "{table:?}");
    }
}

#[test]
fn what_reads_validates() {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../shared/oracle/scenes/figures"
    );
    let Ok(entries) = std::fs::read_dir(folder) else {
        eprintln!("SKIPPED: no scenes in {folder}");
        return;
    };
    let schema = schema();
    for entry in entries.flatten() {
        let text = std::fs::read_to_string(entry.path()).expect("text");
        let file = read_scene("x.toml", &text).expect("good");
        let json: Value = serde_json::from_str(&file.tree().to_json()).expect("JSON");
        validate(&schema, &schema, &json).unwrap_or_else(|e| panic!("{:?}: {e}", entry.path()));
    }
}

#[test]
fn the_schema_refuses_what_is_no_scene() {
    let schema = schema();
    let good: Value = serde_json::from_str(
        r#"{"scene": {"name": "s"},
            "obstacle": [{"name": "o", "vertices": [[0, "0"], ["1/2", 0], [0, 1e3]]}],
            "pawl": [{"name": "p", "hinge": [0, 0], "vertices": [[0, 0], [1, 0], [0, 1]]}],
            "motion": [{"velocity": [0, 1], "duration": 1}, {"reverse": true},
                       {"velocity": [0, 1], "until": "root-collision"}]}"#,
    )
    .expect("JSON");
    assert_eq!(validate(&schema, &schema, &good), Ok(()));
    for (path, value) in [
        ("/scene/name", Value::Null),
        ("/scene", serde_json::json!({"name": "s", "friction": null})),
        ("/obstacle", serde_json::json!([])),
        ("/obstacle/0/vertices", serde_json::json!([[0, 0], [1, 1]])),
        ("/obstacle/0/vertices/0", serde_json::json!([0, 0, 0])),
        ("/obstacle/0/vertices/0", serde_json::json!(["a", 0])),
        ("/pawl/0", serde_json::json!({"name": "p"})),
        ("/motion/1", serde_json::json!({"reverse": false})),
        ("/motion/0", serde_json::json!({"velocity": [0, 1]})),
        (
            "/motion/0",
            serde_json::json!({"velocity": [0, 1], "until": "noon"}),
        ),
    ] {
        let mut bad = good.clone();
        *bad.pointer_mut(path).expect("a place") = value;
        assert!(validate(&schema, &schema, &bad).is_err(), "{path}: {bad}");
    }
}
