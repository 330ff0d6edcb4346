//! `lp` and `verify` from outside: every number that a reader may look at in a result is checked,
//! and no file is lost.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const OPTIMAL: &str = "Maximize\n profit: 3 x + 2 y\nSubject To\n c1: x + y <= 4\n \
    c2: x + 3 y <= 6\n c3: x <= 3.1\nEnd\n";
const RELAXED: &str = "Maximize\n x\nSubject To\n c: 2 x <= 5\nGenerals\n x\nEnd\n";
const INFEASIBLE: &str = "Minimize\n x\nSubject To\n c1: x + y <= 1\n c2: x + y >= 2\nEnd\n";
const UNBOUNDED: &str = "Maximize\n x + y\nSubject To\n c1: x - y <= 1\nEnd\n";

fn snapfit(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_snapfit"));
    let command = command.current_dir(folder).args(args).stdin(Stdio::null());
    command.output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// An empty folder of its own for a test, with a model in it.
fn folder(name: &str, model: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("lp-{name}"));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join("m.lp"), model).unwrap();
    path
}

/// The result of solving the folder's model.
fn solved(folder: &Path, more: &[&str]) -> Value {
    let args = [&["lp", "m.lp", "-o", "r.json"], more].concat();
    let output = snapfit(folder, &args);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_slice(&fs::read(folder.join("r.json")).unwrap()).unwrap()
}

fn verdict(folder: &Path, result: &Value) -> (Option<i32>, String) {
    fs::write(folder.join("t.json"), result.to_string()).unwrap();
    let output = snapfit(folder, &["verify", "t.json"]);
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    let reason = said["reason"].as_str().unwrap_or("").to_owned();
    (output.status.code(), reason)
}

/// Every leaf of a value, as a JSON pointer.
fn leaves(value: &Value, at: &str, out: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            for (k, v) in map {
                let k = k.replace('~', "~0").replace('/', "~1");
                leaves(v, &format!("{at}/{k}"), out);
            }
        }
        Value::Array(list) => {
            for (k, v) in list.iter().enumerate() {
                leaves(v, &format!("{at}/{k}"), out);
            }
        }
        _ => out.push(at.to_owned()),
    }
}

/// What the solver counted, and the path by which the model is found, prove nothing.
const CLAIMED_BY_NOBODY: [&str; 3] = ["/float_iterations", "/exact_pivots", "/model"];

/// Any number changed, anywhere in a result, is found out.
#[test]
fn no_number_can_be_changed() {
    for (name, model, more) in [
        ("optimal", OPTIMAL, &["--values"][..]),
        ("plain", OPTIMAL, &[]),
        ("relaxed", RELAXED, &[]),
        ("infeasible", INFEASIBLE, &[]),
        ("unbounded", UNBOUNDED, &[]),
        ("bounds", OPTIMAL, &["--accuracy", "bounds"]),
    ] {
        let folder = folder(name, model);
        let right = solved(&folder, more);
        assert_eq!(
            verdict(&folder, &right),
            (Some(0), String::new()),
            "{right}"
        );
        let mut places = Vec::new();
        leaves(&right, "", &mut places);
        let mut tried = 0;
        for place in places {
            if CLAIMED_BY_NOBODY.iter().any(|p| place.starts_with(p)) {
                continue;
            }
            // Other prices, another point or ray may prove as much; `lp.rs` damages those.
            let as_much = ["infeasible", "unbounded"].contains(&name);
            if as_much && place.starts_with("/certificate/") && !place.ends_with("/kind") {
                continue;
            }
            let mut wrong = right.clone();
            let leaf = wrong.pointer_mut(&place).unwrap();
            *leaf = match leaf {
                Value::Null => json!("77"),
                Value::Bool(b) => json!(!*b),
                Value::Number(n) => json!(n.as_f64().unwrap() + 1.0),
                Value::String(s) if s.parse::<i64>().is_ok() || s.contains('/') => {
                    json!(format!("{s}7"))
                }
                _ => json!("other"),
            };
            let (status, reason) = verdict(&folder, &wrong);
            assert_eq!(status, Some(4), "{name}: {place} in {wrong}");
            assert!(!reason.is_empty());
            tried += 1;
        }
        assert!(tried >= 6, "{name}: {tried}");
    }
}

/// Every object within a value, as a JSON pointer.
fn tables(value: &Value, at: &str, out: &mut Vec<String>) {
    if let Value::Object(map) = value {
        out.push(at.to_owned());
        for (k, v) in map {
            let k = k.replace('~', "~0").replace('/', "~1");
            tables(v, &format!("{at}/{k}"), out);
        }
    }
}

/// A result of each status, its folder and its name.
fn one_of_each(what: &str) -> Vec<(&'static str, PathBuf, Value)> {
    let mut out = Vec::new();
    for (name, model, more) in [
        ("optimal", OPTIMAL, &["--values"][..]),
        ("infeasible", INFEASIBLE, &["--values"]),
        ("unbounded", UNBOUNDED, &["--values"]),
        ("bounds", OPTIMAL, &["--accuracy", "bounds"]),
    ] {
        let folder = folder(&format!("{what}-{name}"), model);
        let right = solved(&folder, more);
        out.push((name, folder, right));
    }
    let folder = folder(&format!("{what}-undecided"), OPTIMAL);
    let args = ["lp", "m.lp", "--time-limit", "0"];
    let output = snapfit(&folder, &args);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let right = serde_json::from_slice(&output.stdout).unwrap();
    out.push(("undecided", folder, right));
    for (name, folder, right) in &out {
        assert_eq!(verdict(folder, right).0, Some(0), "{name}: {right}");
    }
    out
}

/// What is left out, or of another type than the program writes, is refused wherever it stands.
#[test]
fn no_part_can_be_left_out_or_be_of_another_type() {
    for (name, folder, right) in one_of_each("types") {
        let mut places = Vec::new();
        tables(&right, "", &mut places);
        let mut tried = 0;
        for place in places {
            // A proof may do without one of its numbers.
            if place.starts_with("/certificate/") && name != "optimal" {
                continue;
            }
            let keys: Vec<String> = right
                .pointer(&place)
                .unwrap()
                .as_object()
                .unwrap()
                .keys()
                .cloned()
                .collect();
            for key in keys {
                // Prose; what is not listed claims nothing; without a path there is no model.
                if ["reason", "model"].contains(&key.as_str()) {
                    continue;
                }
                let listed = place.is_empty() && ["primal", "dual"].contains(&key.as_str());
                for other in [
                    None,
                    Some(json!(null)),
                    Some(json!({})),
                    Some(json!(0)),
                    Some(json!("x")),
                ] {
                    let mut wrong = right.clone();
                    let table = wrong.pointer_mut(&place).unwrap().as_object_mut().unwrap();
                    let counted = ["float_iterations", "exact_pivots"].contains(&key.as_str());
                    match other {
                        None if listed => continue,
                        None => table.remove(&key),
                        Some(v) if table[&key] == v || counted && v == json!(0) => continue,
                        Some(v) => table.insert(key.clone(), v),
                    };
                    let (status, reason) = verdict(&folder, &wrong);
                    assert_eq!(status, Some(4), "{name}: {place}/{key} in {wrong}");
                    assert!(!reason.is_empty());
                    tried += 1;
                }
            }
        }
        assert!(tried >= 50, "{name}: {tried}");
    }
}

/// Numbers and tables that the program would not write for a status are refused: nothing proves
/// them.
#[test]
fn nothing_unproven_can_be_added() {
    let exact = |v: &str| json!({ "value": v.parse::<f64>().unwrap(), "exact": { "rational": v } });
    for (name, folder, right) in one_of_each("added") {
        let mut wrong = Vec::new();
        let mut add = |place: &str, key: &str, value: Value| {
            let mut one = right.clone();
            let table = one.pointer_mut(place).unwrap().as_object_mut().unwrap();
            if table.get(key) != Some(&value) {
                table.insert(key.to_owned(), value);
                wrong.push(one);
            }
        };
        let within = match name {
            "bounds" => right["objective"]["value"].clone(),
            _ => json!(11.0),
        };
        for value in [
            exact("11"),
            exact("-100"),
            json!({ "value": 11.0 }),
            json!([]),
            within,
        ] {
            add("", "objective", value);
        }
        add("", "optimum", json!("11"));
        add("/bounds", "exact", json!("11"));
        add("", "bounds", json!({ "lower": "-1", "upper": "1000" }));
        add("", "relaxed", json!(false));
        add("", "ignored_objective_rhs", json!("0"));
        add("", "negative_upper_bounds", json!([]));
        let decided = name != "undecided";
        if decided {
            add("", "reason", json!("none"));
        }
        add("/certificate", "objective", json!("11"));
        let rows = right["rows"].as_u64().unwrap();
        let prices: serde_json::Map<_, _> =
            (1..=rows).map(|i| (format!("c{i}"), json!("0"))).collect();
        add("", "dual", Value::Object(prices));
        if name == "bounds" {
            // A double within the bounds that is not the feasible point's.
            let double = right["objective"]["value"].as_f64().unwrap();
            add("/objective", "value", json!(double * (1.0 + 1e-15)));
            add("/objective", "exact", json!({ "rational": "111/10" }));
        }
        if !["optimal", "unbounded"].contains(&name) {
            add("", "primal", json!({ "x": "0", "y": "0" }));
        }
        assert!(wrong.len() >= 11, "{name}");
        for one in wrong {
            assert_eq!(verdict(&folder, &one).0, Some(4), "{name}: {one}");
        }
    }
}

/// Bounds on one side, or far from each other, are no optimum; none at all are no proof.
#[test]
fn wide_bounds_are_no_optimum() {
    let (_, folder, right) = one_of_each("wide").pop().unwrap();
    let ends = |v: &Value| v["bounds"]["lower"].is_string() && v["bounds"]["upper"].is_string();
    assert!(ends(&right), "{right}");
    // Worse prices prove a worse bound.
    let mut wide = right.clone();
    let prices = json!({ "denominator": "1", "numerators": { "c1": "3" } });
    wide["certificate"] = json!({ "kind": "bounds", "dual": prices,
        "primal": { "denominator": "1", "numerators": {} } });
    wide["bounds"] = json!({ "lower": "0", "upper": "12" });
    assert_eq!(
        verdict(&folder, &wide),
        (
            Some(0),
            "the result is undecided; both its bounds hold".into()
        )
    );
    wide["status"] = json!("optimal");
    wide["accuracy"] = json!("bounds");
    wide["objective"] = json!({ "value": 0.0 });
    wide.as_object_mut().unwrap().remove("reason");
    assert!(verdict(&folder, &wide).1.contains("too far apart"));
    wide["certificate"]["dual"] = Value::Null;
    wide["bounds"]["upper"] = Value::Null;
    assert!(verdict(&folder, &wide).1.contains("one side"));
    let mut none = right;
    none["certificate"] = json!({ "kind": "bounds", "primal": null, "dual": null });
    none["bounds"] = json!({ "lower": null, "upper": null });
    assert!(verdict(&folder, &none).1.contains("bounds nothing"));
}

/// Of two values of one key one reader takes the first, another the last.
#[test]
fn a_key_that_stands_twice_is_refused() {
    let folder = folder("twice", OPTIMAL);
    let right = solved(&folder, &[]).to_string();
    let places = [
        ("{\"accuracy\"", "{\"objective\":{\"value\":5},\"accuracy\""),
        ("\"rational\":", "\"rational\":\"5\",\"rational\":"),
        ("\"numerators\":{", "\"numerators\":{\"x\":\"5\","),
        (
            "{\"accuracy\"",
            "{\"a\\u0063curacy\":\"float\",\"accuracy\"",
        ),
    ];
    for (before, after) in places {
        let text = right.replace(before, after);
        assert_ne!(text, right);
        // In the certificate either vector may have had the key already.
        fs::write(folder.join("t.json"), &text).unwrap();
        let output = snapfit(&folder, &["verify", "t.json"]);
        assert_eq!(output.status.code(), Some(2), "{text}");
        let said = stderr(&output);
        assert!(
            said.contains("twice in one object") && said.starts_with("t.json:1:"),
            "{said}"
        );
    }
}

/// Values written out and left incomplete, or for columns that are not there.
#[test]
fn listed_values_are_those_of_the_model() {
    let folder = folder("listed", OPTIMAL);
    let right = solved(&folder, &["--values"]);
    let mut short = right.clone();
    short["primal"].as_object_mut().unwrap().remove("y");
    assert!(verdict(&folder, &short).1.contains("`y`"));
    let mut more = right.clone();
    more["dual"]["c9"] = json!("0");
    assert_eq!(verdict(&folder, &more).0, Some(4));
}

/// The result may lie elsewhere; the model is then found beside it.
#[test]
fn a_model_is_found_beside_its_result() {
    let folder = folder("beside", OPTIMAL);
    solved(&folder, &[]);
    let above = folder.parent().unwrap();
    let output = snapfit(above, &["verify", "lp-beside/r.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// The verdict says which model it is about; of two that differ none is taken.
#[test]
fn the_model_that_was_read_is_named() {
    let inner = folder("named", OPTIMAL);
    solved(&inner, &[]);
    let outer = inner.parent().unwrap().join("lp-named-outer");
    let _ = fs::remove_dir_all(&outer);
    fs::create_dir_all(outer.join("in")).unwrap();
    for file in ["m.lp", "r.json"] {
        fs::copy(inner.join(file), outer.join("in").join(file)).unwrap();
    }
    let model = |output: &Output| -> String {
        let said: Value = serde_json::from_slice(&output.stdout).unwrap();
        said["model"].as_str().unwrap().to_owned()
    };
    let beside = snapfit(&outer, &["verify", "in/r.json"]);
    assert_eq!(
        (beside.status.code(), model(&beside)),
        (Some(0), "in/m.lp".into())
    );
    // The same file twice is no question.
    fs::copy(inner.join("m.lp"), outer.join("m.lp")).unwrap();
    let here = snapfit(&outer, &["verify", "in/r.json"]);
    assert_eq!((here.status.code(), model(&here)), (Some(0), "m.lp".into()));
    fs::write(outer.join("m.lp"), UNBOUNDED).unwrap();
    let unclear = snapfit(&outer, &["verify", "in/r.json"]);
    assert_eq!(unclear.status.code(), Some(2));
    let said = stderr(&unclear);
    assert!(
        said.contains("in/m.lp") && said.contains("--model"),
        "{said}"
    );
    let told = snapfit(&outer, &["verify", "in/r.json", "--model", "m.lp"]);
    assert_eq!((told.status.code(), model(&told)), (Some(4), "m.lp".into()));
}

/// The result names its model, which JSON cannot where the name is no text.
#[cfg(unix)]
#[test]
fn a_name_that_is_no_text_is_told() {
    use std::os::unix::ffi::OsStrExt;
    let folder = folder("bytes", OPTIMAL);
    let name = std::ffi::OsStr::from_bytes(b"m\xff.lp");
    if fs::copy(folder.join("m.lp"), folder.join(name)).is_err() {
        return; // this file system has no such names
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_snapfit"));
    let command = command.current_dir(&folder).arg("lp").arg(name);
    let output = command.stdin(Stdio::null()).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("not UTF-8"), "{}", stderr(&output));
}

/// A place where nothing can be written is told before anything is read.
#[test]
fn the_output_is_looked_at_first() {
    let folder = folder("outputs", "no model");
    for (out, what) in [
        ("none/r.json", "there is no directory"),
        (".", "is a directory"),
    ] {
        let output = snapfit(&folder, &["lp", "m.lp", "--out", out]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(what), "{}", stderr(&output));
    }
}

const CONVENTIONS: &str = "NAME t\nROWS\n N cost\n G r\nCOLUMNS\n x cost 1 r 1\n y cost 1 r 1\n \
    z cost 1 r 1\nRHS\n b r -10\n b cost 7\nBOUNDS\n UP b x -1\n UP b z -2\n LO b z -3\nENDATA\n";

/// What MPS leaves to convention is told, in the result and beside it.
#[test]
fn conventions_are_told() {
    let folder = folder("conventions", OPTIMAL);
    fs::write(folder.join("m.mps"), CONVENTIONS).unwrap();
    let output = snapfit(&folder, &["lp", "m.mps"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = stderr(&output);
    let lines: Vec<_> = said.lines().collect();
    assert_eq!(lines.len(), 2, "{said}");
    assert!(lines[0].contains("right-hand side 7"), "{said}");
    assert!(lines[1].contains("`x` is negative"), "{said}");
    let right: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(right["objective"]["value"], -10.0);
    assert_eq!(right["ignored_objective_rhs"], "7");
    assert_eq!(right["negative_upper_bounds"], json!(["x"]));
    assert_eq!(verdict(&folder, &right).0, Some(0));
    for key in ["negative_upper_bounds", "ignored_objective_rhs"] {
        let mut wrong = right.clone();
        wrong.as_object_mut().unwrap().remove(key);
        assert_eq!(verdict(&folder, &wrong).0, Some(4));
    }
    let quiet = snapfit(&folder, &["lp", "m.mps", "--quiet"]);
    assert!(quiet.stderr.is_empty());
}

#[test]
fn a_limit_is_named_as_the_reason_of_floats_too() {
    // Long enough for the limit to be looked at.
    let mut model = "Minimize\n".to_owned();
    model += &(0..600)
        .map(|i| format!(" + {} x{i}\n", 1 + i * 7 % 11))
        .collect::<String>();
    model += "Subject To\n";
    for i in 0..599 {
        model += &format!(" x{i} + {} x{} >= {}\n", 1 + i % 3, i + 1, 1 + i * 5 % 13);
    }
    let folder = folder("float-limit", &(model + "End\n"));
    let args = ["lp", "m.lp", "--accuracy", "float", "--time-limit", "0"];
    let output = snapfit(&folder, &args);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(said["reason"].as_str().unwrap().contains("limit"), "{said}");
    assert_eq!(verdict(&folder, &said).0, Some(3));
}

#[test]
fn the_model_is_never_overwritten() {
    let folder = folder("spared", OPTIMAL);
    let output = snapfit(&folder, &["lp", "m.lp", "--out", "m.lp"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read_to_string(folder.join("m.lp")).unwrap(), OPTIMAL);
}

#[test]
fn integers_are_relaxed_aloud() {
    let folder = folder("integers", RELAXED);
    let output = snapfit(&folder, &["lp", "m.lp"]);
    assert!(stderr(&output).contains("relaxed"), "{}", stderr(&output));
    let quiet = snapfit(&folder, &["lp", "m.lp", "--quiet"]);
    assert!(quiet.stderr.is_empty());
}

#[test]
fn a_byte_order_mark_is_no_text() {
    let folder = folder("mark", &format!("\u{feff}{OPTIMAL}"));
    assert_eq!(solved(&folder, &[])["objective"]["value"], 11.1);
    let mps = "\u{feff}NAME t\nROWS\n N c\n L r\nCOLUMNS\n x c -1 r 1\nRHS\n b r 2\nENDATA\n";
    fs::write(folder.join("m.mps"), mps).unwrap();
    let output = snapfit(&folder, &["lp", "m.mps"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn what_is_no_result_is_said_so() {
    let folder = folder("no-result", OPTIMAL);
    for text in ["", "Maximize x", "{}", "[1]"] {
        fs::write(folder.join("r.json"), text).unwrap();
        let output = snapfit(&folder, &["verify", "r.json"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            stderr(&output).contains("result of `snapfit lp`"),
            "{}",
            stderr(&output)
        );
    }
}

/// What a limit left open is verified where it claims bounds, and is neither right nor wrong where
/// it claims nothing.
#[test]
fn undecided_results_are_judged_by_what_they_claim() {
    let folder = folder("undecided", OPTIMAL);
    for limit in ["--time-limit", "--memory-limit"] {
        let output = snapfit(&folder, &["lp", "m.lp", "-o", "r.json", limit, "0"]);
        let text = fs::read(folder.join("r.json")).unwrap();
        let right: Value = serde_json::from_slice(&text).unwrap();
        // So small a program may be decided by bounds that meet.
        let open = right["status"] == "undecided";
        assert_eq!(output.status.code(), Some(if open { 3 } else { 0 }));
        assert!(!right["bounds"]["lower"].is_null(), "{limit}: {right}");
        let (status, reason) = verdict(&folder, &right);
        assert_eq!((status, reason.contains("undecided")), (Some(0), open));
    }
    let output = snapfit(
        &folder,
        &["lp", "m.lp", "-o", "r.json", "--time-limit", "0"],
    );
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let text = fs::read(folder.join("r.json")).unwrap();
    let right: Value = serde_json::from_slice(&text).unwrap();
    // More than was proven.
    let mut wrong = right.clone();
    wrong["bounds"]["lower"] = json!("111/10");
    wrong["bounds"]["upper"] = json!("111/10");
    assert_eq!(verdict(&folder, &wrong).0, Some(4));
    // Bounds without their proof.
    wrong = right.clone();
    wrong["certificate"] = Value::Null;
    assert_eq!(verdict(&folder, &wrong).0, Some(4));
    // Nothing.
    for end in ["lower", "upper"] {
        wrong["bounds"][end] = Value::Null;
    }
    let (status, reason) = verdict(&folder, &wrong);
    assert_eq!(status, Some(3));
    assert!(reason.contains("nothing"), "{reason}");
    // An optimum without a proof is no undecided result.
    wrong["status"] = json!("optimal");
    assert_eq!(verdict(&folder, &wrong).0, Some(4));
}

/// As much of JSON Schema as this schema uses; a keyword that is not known here fails the test.
fn validate(root: &Value, schema: &Value, value: &Value) -> Result<(), String> {
    for (keyword, rule) in schema.as_object().unwrap() {
        let each = |ways: &Value| -> usize {
            let ways = ways.as_array().unwrap().iter();
            ways.filter(|w| validate(root, w, value).is_ok()).count()
        };
        let held = match keyword.as_str() {
            "$schema" | "$id" | "$defs" | "title" | "description" => true,
            "$ref" => {
                let at = rule.as_str().unwrap().strip_prefix('#').unwrap();
                validate(root, root.pointer(at).unwrap(), value)?;
                true
            }
            "const" => rule == value,
            "enum" => rule.as_array().unwrap().contains(value),
            "anyOf" => each(rule) > 0,
            "oneOf" => each(rule) == 1,
            "type" => {
                let is = |name: &Value| match name.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "integer" => value.is_u64() || value.is_i64(),
                    "number" => value.is_number(),
                    "boolean" => value.is_boolean(),
                    "null" => value.is_null(),
                    other => panic!("type {other}"),
                };
                rule.as_array()
                    .map_or_else(|| is(rule), |names| names.iter().any(is))
            }
            "pattern" => {
                let text = value.as_str().unwrap_or("");
                match rule.as_str().unwrap() {
                    "^[BLUZ]*$" => text.chars().all(|c| "BLUZ".contains(c)),
                    pattern => {
                        (text.contains('/') <= pattern.contains('/'))
                            && text.parse::<snapfit::number::Rat>().is_ok()
                    }
                }
            }
            "minimum" => value.as_i64().is_none_or(|v| Some(v) >= rule.as_i64()),
            "minItems" | "maxItems" => value.as_array().is_none_or(|v| {
                let most = rule.as_u64().unwrap() as usize;
                if keyword == "minItems" {
                    v.len() >= most
                } else {
                    v.len() <= most
                }
            }),
            "required" => {
                let keys = rule.as_array().unwrap().iter();
                let has = |k: &Value| value.get(k.as_str().unwrap()).is_some();
                value.as_object().is_none() || keys.clone().all(has)
            }
            "properties" => {
                for (key, part) in rule.as_object().unwrap() {
                    if let Some(v) = value.get(key) {
                        validate(root, part, v)?;
                    }
                }
                true
            }
            "additionalProperties" => {
                for (key, v) in value.as_object().into_iter().flatten() {
                    if schema["properties"].get(key).is_some() {
                        continue;
                    }
                    if rule == false {
                        return Err(format!("unknown {key}"));
                    }
                    validate(root, rule, v)?;
                }
                true
            }
            "items" => {
                for v in value.as_array().into_iter().flatten() {
                    validate(root, rule, v)?;
                }
                true
            }
            other => panic!("keyword {other}"),
        };
        if !held {
            return Err(format!("{keyword}: {rule} of {value}"));
        }
    }
    Ok(())
}

/// Results hold to `snapfit schema lp`, and damaged ones do not.
#[test]
fn results_hold_to_their_schema() {
    let mut all: Vec<Value> = one_of_each("schema").into_iter().map(|r| r.2).collect();
    let folder = folder("schema", RELAXED);
    all.push(solved(&folder, &["--accuracy", "float"]));
    let crossed = "Minimize\n x\nSubject To\n c: x <= 1\nBounds\n 3 <= x <= 2\nEnd\n";
    fs::write(folder.join("m.lp"), crossed).unwrap();
    all.push(solved(&folder, &[]));
    fs::write(folder.join("m.mps"), CONVENTIONS).unwrap();
    let output = snapfit(&folder, &["lp", "m.mps"]);
    all.push(serde_json::from_slice(&output.stdout).unwrap());
    let output = snapfit(&folder, &["schema", "lp"]);
    let schema: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut damaged = 0;
    for right in &all {
        validate(&schema, &schema, right).unwrap_or_else(|e| panic!("{e}\n{right}"));
        for place in right.as_object().unwrap().keys() {
            let mut wrong = right.clone();
            wrong[place] = json!({ "what": [] });
            assert!(validate(&schema, &schema, &wrong).is_err(), "{wrong}");
            damaged += 1;
        }
    }
    assert!(damaged >= 100, "{damaged}");
}
