//! `snapfit slice` from outside: what it prints, what it answers, and how it refuses.

#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::process::{Command, Output};

const PINS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/pins.toml");

fn snapfit(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_snapfit"));
    command.args(args).output().unwrap()
}

fn json(args: &[&str]) -> Value {
    let out = snapfit(args);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(0), "{said}");
    serde_json::from_slice(&out.stdout).unwrap()
}

/// Both ways print the same vertices and edges, and the ledger of a simulation says which ran.
#[test]
fn both_ways_are_told_apart_by_the_ledger_alone() {
    let free = |way: &str| json(&["slice", PINS, "--face", way])["free"].clone();
    let (walk, merge) = (free("walk"), free("merge"));
    assert!(walk["edges"].as_array().unwrap().len() > 2);
    for key in ["half_edges", "components", "vertices", "edges"] {
        assert_eq!(walk[key], merge[key], "{key}");
    }
    for (way, walked, merged) in [("walk", 1, 0), ("merge", 0, 1), ("auto", 1, 0)] {
        let args = ["simulate", PINS, "--method", "sweep", "--face", way];
        let phase = &json(&args)["ledger"]["phases"][0];
        assert_eq!(phase["walked"], walked, "{way}");
        assert_eq!(phase["merged"], merged, "{way}");
        assert_eq!(
            (&phase["slices"], &phase["abandoned"]),
            (&1.into(), &0.into())
        );
    }
}

#[test]
fn questions_are_answered_in_order() {
    let doc = json(&[
        "slice", PINS, "--at", "1/8", "--reach", "1/8,0", "--from", "0",
    ]);
    let queries = doc["queries"].as_array().unwrap();
    let kinds: Vec<&str> = queries
        .iter()
        .map(|q| q["query"].as_str().unwrap())
        .collect();
    assert_eq!(kinds, ["reach", "intervals", "run"]);
    // From the start that the scene has, the run is the one that it simulates.
    let run = &queries[2];
    let whole = json(&["simulate", PINS]);
    assert_eq!(run["outcome"], "completed", "the first phase is");
    assert_eq!(run["reused"], true);
    let kinds = |v: &Value| -> Vec<Value> {
        let list = v.as_array().unwrap().iter();
        let kinds = list.filter(|e| e["phase"] == 0).map(|e| e["kind"].clone());
        kinds
            .filter(|k| k != "phase-end" && k != "plan-end")
            .collect()
    };
    assert_eq!(kinds(&run["events"]), kinds(&whole["pawls"][0]["events"]));
}

#[test]
fn what_cannot_be_asked_is_refused() {
    for (args, what) in [
        (["--at", "1e9"], "the phase lasts"),
        (["--reach", "1"], "expected TIME,TAN_HALF"),
        (["--from", "x"], "x"),
        (["--phase", "9"], "phases"),
        (["--pawl", "nobody"], "no pawl"),
    ] {
        let out = snapfit(&["slice", PINS, args[0], args[1]]);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{args:?}: {said}");
        assert!(said.contains(what), "{args:?}: {said}");
        assert!(out.stdout.is_empty());
    }
}
