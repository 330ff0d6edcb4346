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
        (["--reach", "x,0"], "--reach x"),
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

const TIP: &str = r#"
[scene]
name = "tip"
friction = "1/4"
[[obstacle]]
name = "floor"
vertices = [["-10", "-1"], ["10", "-1"], ["10", "0"], ["-10", "0"]]
[[pawl]]
name = "finger"
hinge = ["0", "6"]
vertices = [["0", "6"], ["3", "2"], ["16/5", "9/5"]]
[[motion]]
velocity = ["0", "-1"]
duration = "5"
[[motion]]
reverse = true
"#;

/// A file of its own for a test.
fn written(name: &str, text: &str) -> std::path::PathBuf {
    let path = std::env::temp_dir().join(format!("snapfit-{}-{name}", std::process::id()));
    std::fs::write(&path, text).unwrap();
    path
}

/// Just after a phase begins everything is free where nothing is met yet, in the first phase as in the next.
#[test]
fn free_intervals_at_the_very_start_of_a_phase() {
    let path = written("tip.toml", TIP);
    let file = path.to_str().unwrap();
    let ask = |phase: &str, t: &str| {
        let d = json(&["slice", file, "--phase", phase, "--at", t]);
        let mut q = d["queries"][0].clone();
        q.as_object_mut().unwrap().remove("time");
        q
    };
    assert_eq!(ask("0", "0")["all"], true);
    assert_eq!(ask("0", "0"), ask("0", "1e-30"));
    // The second begins where the first ends: in contact.
    let joint = ask("1", "0");
    assert_eq!(joint["all"], false);
    assert_eq!(joint["intervals"].as_array().unwrap().len(), 1);
    std::fs::remove_file(path).unwrap();
}

#[test]
fn the_half_turn_can_be_asked_for() {
    let d = json(&["slice", PINS, "--reach", "1/8,infinity"]);
    assert_eq!(d["queries"][0]["tan_half"], "infinity");
    // Next to it the answer is the same: no arc is there.
    let near = json(&["slice", PINS, "--reach", "1/8,1e30"]);
    assert_eq!(
        d["queries"][0]["answer"], near["queries"][0]["answer"],
        "{d}"
    );
}

#[test]
fn the_time_limit_is_heeded() {
    let arcs = written("limit.arcs", "0 0 0\n");
    for args in [
        &["slice", PINS, "--time-limit", "0"][..],
        &["face", arcs.to_str().unwrap(), "--time-limit", "0"],
    ] {
        let out = snapfit(args);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(3), "{said}");
        assert!(said.contains("undecided: --time-limit"), "{said}");
        assert!(out.stdout.is_empty());
    }
    std::fs::remove_file(arcs).unwrap();
    assert_eq!(
        json(&["slice", PINS, "--time-limit", "1000"]),
        json(&["slice", PINS])
    );
}

#[test]
fn what_a_slice_does_not_heed_is_refused() {
    for args in [
        &["--arithmetic", "f64"][..],
        &["--tolerance", "1e-3"],
        &["--identify", "none"],
        &["--backend", "rug"],
        &["--method", "naive"],
    ] {
        // Where it is built in, it is heeded.
        if args[0] == "--backend" && cfg!(feature = "rug") {
            continue;
        }
        for verb in [&["slice", PINS][..], &["render", PINS, "--svg", "--slice"]] {
            let out = snapfit(&[verb, args].concat());
            let said = String::from_utf8_lossy(&out.stderr).into_owned();
            assert_eq!(out.status.code(), Some(2), "{args:?}: {said}");
            assert!(said.contains(args[0]), "{args:?}: {said}");
            assert!(out.stdout.is_empty());
        }
    }
}

/// `face` writes to a file, reads past a byte order mark, and says where too many arcs are announced.
#[test]
fn faces_are_written_and_refused_with_their_place() {
    let arc = "-1 0 1 1 0 0  1 1 0 0  -1 1 0 0\n";
    let good = written("good.arcs", &format!("\u{feff}1 0 0\n{arc}"));
    let out = written("face.json", "");
    let file = good.to_str().unwrap();
    let said = snapfit(&["face", file, "--out", out.to_str().unwrap()]);
    assert_eq!(said.status.code(), Some(0), "{said:?}");
    assert!(said.stdout.is_empty());
    let found: Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
    assert_eq!(
        (&found["half_edges"], &found["unbounded"]),
        (&6.into(), &true.into())
    );
    let bad = written("bad.arcs", &format!("\n  7 0 0\n{arc}"));
    let said = snapfit(&["face", bad.to_str().unwrap()]);
    let told = String::from_utf8_lossy(&said.stderr).into_owned();
    assert!(
        told.contains("bad.arcs:2:3: 7 arcs announced, 1 found"),
        "{told}"
    );
    for p in [good, out, bad] {
        std::fs::remove_file(p).unwrap();
    }
}
