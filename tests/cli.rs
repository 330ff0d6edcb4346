//! The command line from outside: exit statuses, streams, and files that are never lost.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::io::{Read, Write};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

const PINS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/pins.toml");

fn snapfit(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_snapfit"));
    command.args(args).stdin(Stdio::null()).output().unwrap()
}

fn with_input(args: &[&str], input: &[u8]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_snapfit"));
    command
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A child that refuses its arguments does not read.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// An empty folder of its own for a test.
fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-{name}"));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

#[test]
fn a_jam_is_a_result() {
    let output = snapfit(&["simulate", PINS]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["outcome"]["kind"], "jammed");
    assert!(output.stderr.is_empty());
}

#[test]
fn standard_input_and_overrides() {
    let text = fs::read(PINS).unwrap();
    let set = [
        "simulate",
        "-",
        "--set",
        "scene.name=renamed",
        "--set",
        "pawl.arm.stiffness=5/2",
    ];
    let output = with_input(&set, &text);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("\"scene\": \"renamed\""));
    for (bad, named) in [("scene.name", "scene.name"), ("nothing.here=1", "nothing")] {
        let output = with_input(&["simulate", "-", "--set", bad], &text);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(named));
    }
}

#[test]
fn bad_input_is_placed() {
    let bad = fs::read_to_string(PINS)
        .unwrap()
        .replace("duration = \"18\"", "duration = \"1/0\"");
    let line = 1 + bad.lines().position(|l| l.contains("1/0")).unwrap();
    for verb in [
        &["simulate", "-"][..],
        &["check", "-"],
        &["render", "-", "--svg"],
    ] {
        let output = with_input(verb, bad.as_bytes());
        assert_eq!(output.status.code(), Some(2));
        assert!(output.stdout.is_empty());
        assert!(
            stderr(&output).contains(&format!(":{line}:")),
            "{}",
            stderr(&output)
        );
    }
    let output = snapfit(&["simulate", "no-such-file.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("no-such-file.toml"));
    let endless = fs::read_to_string(PINS.replace("pins", "root"))
        .unwrap()
        .replace("[\"0\",\"-1/3\"]", "[\"0\",\"1\"]")
        .replace("duration = \"100\"", "until = \"root-collision\"");
    let output = with_input(&["simulate", "-"], endless.as_bytes());
    assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
    assert!(stderr(&output).contains("<stdin>:"), "{}", stderr(&output));
}

#[test]
fn bad_usage() {
    let wrong: [&[&str]; 9] = [
        &[],
        &["fly", PINS],
        &["simulate"],
        &["simulate", PINS, "--tolerance=-1"],
        &["simulate", PINS, "--arithmetic", "roman"],
        &["simulate", PINS, "--method", "guess"],
        &["simulate", PINS, "--time-limit", "soon"],
        &["render", PINS],
        &["schema", "nothing"],
    ];
    for args in wrong {
        let output = snapfit(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(output.stdout.is_empty(), "{args:?}");
        assert!(!output.stderr.is_empty(), "{args:?}");
    }
    let listed = stderr(&snapfit(&["fly"]));
    for verb in ["simulate", "check", "render", "schema"] {
        assert!(listed.contains(verb));
    }
}

#[test]
fn undecided_within_the_limit() {
    let output = snapfit(&["simulate", PINS, "--time-limit", "0"]);
    assert_eq!(output.status.code(), Some(3));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["outcome"]["kind"], "undecided");
}

#[test]
fn formats() {
    let summary = stdout(&snapfit(&["simulate", PINS, "--format", "summary"]));
    assert!(summary.starts_with("pins jams"), "{summary}");
    assert!(!summary.contains('\x1b'), "no colours in a pipe");
    let check = stdout(&snapfit(&["check", PINS]));
    assert!(serde_json::from_str::<serde_json::Value>(&check).is_ok());
    let check = stdout(&snapfit(&["check", PINS, "--format", "summary"]));
    assert!(check.starts_with("scene pins"));
    for name in ["scene", "result"] {
        let schema = snapfit(&["schema", name]);
        let schema: serde_json::Value = serde_json::from_slice(&schema.stdout).unwrap();
        assert_eq!(schema["$id"], format!("snapfit.{name}/1"));
    }
}

#[test]
fn out_replaces_a_file_whole() {
    let folder = folder("out");
    let path = folder.join("result.json");
    let shown = path.to_str().unwrap();
    fs::write(&path, "what was there").unwrap();
    let output = snapfit(&["simulate", PINS, "--out", shown]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(output.stdout.is_empty());
    let document: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    assert_eq!(document["scene"], "pins");
    assert_eq!(
        fs::read_dir(&folder).unwrap().count(),
        1,
        "nothing is left beside it"
    );
}

#[test]
fn out_keeps_the_file_where_it_fails() {
    let folder = folder("kept");
    let path = folder.join("result.json");
    let shown = path.to_str().unwrap();
    fs::write(&path, "precious").unwrap();
    // Refused input, and an input that would be overwritten.
    let output = with_input(&["simulate", "-", "--out", shown], b"nonsense");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
    let scene = folder.join("scene.toml");
    fs::copy(PINS, &scene).unwrap();
    let scene = scene.to_str().unwrap();
    for args in [
        ["simulate", scene, "--out", scene],
        ["render", scene, "--svg", scene],
    ] {
        assert_eq!(snapfit(&args).status.code(), Some(2));
    }
    assert_eq!(fs::read(scene).unwrap(), fs::read(PINS).unwrap());
    // A path that is no file.
    let output = snapfit(&["simulate", PINS, "--out", folder.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    let output = snapfit(&[
        "simulate",
        PINS,
        "--out",
        folder.join("no/where").to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
}

#[cfg(unix)]
#[test]
fn out_goes_through_a_link_and_keeps_permissions() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = folder("link");
    let (file, link) = (folder.join("real.json"), folder.join("link.json"));
    fs::write(&file, "old").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&file, &link).unwrap();
    let output = snapfit(&["simulate", PINS, "--out", link.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(
        fs::metadata(&file).unwrap().permissions().mode() & 0o777,
        0o640
    );
    assert!(fs::read_to_string(&file).unwrap().starts_with('{'));
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_ends_quietly() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_snapfit"));
    command
        .args(["simulate", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // The reader goes away before the input, and so before the output, is there.
    drop(child.stdout.take());
    child
        .stdin
        .take()
        .unwrap()
        .write_all(&fs::read(PINS).unwrap())
        .unwrap();
    let mut message = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut message)
        .unwrap();
    assert_eq!(message, "");
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn render_writes_one_picture() {
    let folder = folder("render");
    let path = folder.join("pins.svg");
    let output = snapfit(&["render", PINS, "--svg", path.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let file = fs::read_to_string(&path).unwrap();
    assert_eq!(stdout(&snapfit(&["render", PINS, "--svg"])), file);
    assert!(file.starts_with("<svg "));
}

/// Paths that cannot be written are told before any work, in words.
#[test]
fn outputs_are_looked_at_first() {
    let dir = folder("outputs");
    let within = dir.join("absent").join("x.json");
    for (path, says) in [
        (dir.to_str().unwrap(), "this is a directory"),
        (within.to_str().unwrap(), "there is no directory"),
    ] {
        for verb in [
            vec!["simulate", PINS, "--out", path],
            vec!["forces", PINS, "--svg", path],
            vec!["classify", PINS, "--svg", path],
            vec!["classify", PINS, "--escape", path],
            vec!["render", PINS, "--svg", path],
        ] {
            let output = snapfit(&verb);
            assert_eq!(output.status.code(), Some(2), "{verb:?}");
            assert!(
                stderr(&output).contains(says),
                "{verb:?}: {}",
                stderr(&output)
            );
            assert!(output.stdout.is_empty(), "{verb:?}");
        }
    }
    let output = snapfit(&["simulate", dir.to_str().unwrap()]);
    assert!(stderr(&output).contains("this is a directory"));
}

/// A name of --set that leads nowhere is answered with the one that was meant.
#[test]
fn overrides_suggest_what_was_meant() {
    let text = fs::read_to_string(PINS).unwrap();
    let name = text
        .split("[[pawl]]")
        .nth(1)
        .and_then(|p| p.split("name = \"").nth(1))
        .and_then(|p| p.split('"').next())
        .unwrap();
    for (set, meant) in [
        (format!("pawl.{name}x.stiffness=2"), name),
        (format!("pawl.{name}.stifness=2"), "stiffness"),
        ("scen.friction=1".to_owned(), "scene"),
    ] {
        let output = snapfit(&["simulate", PINS, "--set", &set]);
        assert_eq!(output.status.code(), Some(2), "{set}");
        let said = stderr(&output);
        assert!(said.contains(&format!("did you mean `{meant}`?")), "{said}");
    }
}

/// A plan that a limit of time stops leaves the verdict and the forces undecided.
#[test]
fn verdicts_and_forces_say_when_the_time_is_up() {
    for verb in ["classify", "forces"] {
        let output = snapfit(&[verb, PINS, "--time-limit", "0"]);
        assert_eq!(output.status.code(), Some(3), "{verb}");
        let _: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    }
}

/// Without its seconds a result is the same every time.
#[test]
fn results_without_times_are_the_same_bytes() {
    let run = || snapfit(&["simulate", PINS, "--no-times"]).stdout;
    assert_eq!(run(), run());
    let text = String::from_utf8(run()).unwrap();
    assert!(!text.contains("seconds"));
    assert!(stdout(&snapfit(&["simulate", PINS])).contains("run_seconds"));
}

/// The reference arithmetic finds the same class and the same forces.
#[test]
fn the_reference_gives_the_same_verdicts_and_forces() {
    for name in ["examples/handbook-vertex.toml", "examples/bayer-hook.toml"] {
        let file = format!("{}/{name}", env!("CARGO_MANIFEST_DIR"));
        for verb in ["classify", "forces"] {
            let by = |how: &str| snapfit(&[verb, &file, "--arithmetic", how]).stdout;
            assert!(by("exact") == by("filtered"), "{name} {verb}");
        }
    }
}

/// A file of another kind is named as what it is, in one line.
#[test]
fn a_file_of_another_kind_is_named() {
    let folder = folder("guise");
    let structure = folder.join("s.toml");
    let at = |p: &PathBuf| p.to_string_lossy().into_owned();
    let made = snapfit(&[
        "generate",
        "grid",
        "--bodies",
        "4",
        "--out",
        &at(&structure),
    ]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let result = folder.join("r.json");
    snapfit(&["simulate", PINS, "--out", &at(&result)]);
    for (verb, file, word) in [
        ("simulate", at(&structure), "this is a structure"),
        ("flex", PINS.to_owned(), "this is a scene"),
        ("simulate", at(&result), "this is a result"),
        ("flex", at(&result), "this is a result"),
    ] {
        let output = snapfit(&[verb, &file]);
        assert_eq!(output.status.code(), Some(2), "{verb} {file}");
        let said = stderr(&output);
        assert!(said.contains(word) && said.lines().count() == 1, "{said}");
    }
}

#[test]
fn negative_options_are_refused_in_words() {
    let output = snapfit(&["simulate", PINS, "--time-limit", "-1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("not negative"),
        "{}",
        stderr(&output)
    );
}

/// No input is written over, and no two results go to one file.
#[test]
fn inputs_and_results_are_spared() {
    let folder = folder("spared");
    let scene = folder.join("s.toml");
    fs::copy(PINS, &scene).unwrap();
    let before = fs::read(&scene).unwrap();
    let (scene, other) = (
        scene.to_string_lossy().into_owned(),
        folder.join("x").to_string_lossy().into_owned(),
    );
    for args in [
        &["trade", &scene, "--fast", "-o", &scene][..],
        &["trade", &scene, "--fast", "--svg", &scene],
        &["forces", &scene, "--svg", &scene],
        &["forces", &scene, "--svg", &other, "-o", &other],
        &["classify", &scene, "--svg", &other, "-o", &other],
    ] {
        let output = snapfit(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(stderr(&output).contains("lost"), "{}", stderr(&output));
    }
    assert_eq!(fs::read(&scene).unwrap(), before);
}

/// `trade` over a folder takes the scenes of it and of its folders, and nothing else.
#[test]
fn a_folder_is_searched_for_scenes() {
    let folder = folder("search");
    let below = folder.join("below");
    fs::create_dir_all(&below).unwrap();
    fs::create_dir_all(folder.join("empty")).unwrap();
    fs::copy(PINS, below.join("scene.toml")).unwrap();
    fs::write(folder.join("notes.txt"), "not a scene").unwrap();
    let structure = folder.join("grid.toml").to_string_lossy().into_owned();
    snapfit(&["generate", "grid", "--bodies", "4", "--out", &structure]);
    let top = folder.to_string_lossy().into_owned();
    let output = snapfit(&["trade", &top, "--fast", "--repeat", "1", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["scenes"].as_array().unwrap().len(), 1);
}

/// A limit that comes while a large slice is built is no mistake in the arguments.
#[test]
fn a_limit_within_a_slice_is_told() {
    let n = 3000;
    let comb: Vec<String> = (0..=n)
        .map(|k| {
            format!(
                "[\"{k}/10\", \"{}\"]",
                if k % 2 == 0 { "0" } else { "-1/2" }
            )
        })
        .collect();
    let scene = format!(
        "[scene]\nname = \"comb\"\n[[obstacle]]\nname = \"comb\"\nvertices = [[\"0\", \"-2\"], [\"300\", \"-2\"], {}]\n\
         [[pawl]]\nname = \"p\"\nhinge = [\"0\", \"5\"]\nvertices = [[\"0\", \"5\"], [\"3\", \"1\"], [\"16/5\", \"4/5\"]]\n\
         [[motion]]\nvelocity = [\"10\", \"0\"]\nduration = \"30\"\n",
        comb.into_iter().rev().collect::<Vec<_>>().join(", ")
    );
    let path = std::env::temp_dir().join(format!("snapfit-comb-{}.toml", std::process::id()));
    std::fs::write(&path, scene).unwrap();
    let file = path.to_str().unwrap();
    let output = snapfit(&["render", file, "--slice", "--svg", "--time-limit", "0"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("before the slice was built"), "{said}");
    let output = snapfit(&["simulate", file, "--time-limit", "0"]);
    assert_eq!(output.status.code(), Some(3));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["outcome"]["kind"], "undecided");
    assert_eq!(document["ledger"]["phases"][0]["half_edges"], 0);
    std::fs::remove_file(path).unwrap();
}
