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

/// What the solver counted, and the names by which the model is found, prove nothing.
const CLAIMED_BY_NOBODY: [&str; 6] = [
    "/float_iterations",
    "/exact_pivots",
    "/method",
    "/model",
    "/name",
    "/seconds",
];

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
