//! Reading scenes: what is good reads alike in both notations and comes back.
#![allow(
    clippy::unwrap_used,
    reason = "a test that unwraps nothing fails, as it should"
)]

#[allow(unreachable_pub, reason = "a test file is a crate of its own")]
mod common;

use common::count;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use snapfit::geometry::Vec2;
use snapfit::number::Rat;
use snapfit::scene::{
    Classify, Motion, Obstacle, Pawl, Rendering, Root, Scene, SceneError, check, read_scene,
    read_scene_bytes, read_scene_with,
};

/// Uses every part of the format.
const GOOD: &str = include_str!("data/all.toml");

#[test]
fn the_good_scene_is_good() {
    let file = read_scene("good.toml", GOOD).expect("good");
    assert_eq!(file.warnings().len(), 0);
    let scene = file.scene();
    assert_eq!(scene.friction, Some(Rat::frac(1, 4)));
    assert_eq!(
        scene.pawls[1].stiffness,
        Some(Rat::frac(1, 2)),
        "0.5 is a half"
    );
    assert_eq!(scene.pawls[1].hinge.y, Rat::frac(13, 2));
    assert_eq!(scene.obstacles[0].holes.len(), 2);
    assert_eq!(scene.motions[1], Motion::Reverse);
}

#[test]
fn bytes_that_are_no_text() {
    let mut bytes = b"[scene]\nname = \"a".to_vec();
    bytes.extend([0xff, 0xfe]);
    let found = read_scene_bytes("x.toml", &bytes, &[]).unwrap_err();
    assert_eq!(found[0].code(), "not-utf8");
    assert_eq!((found[0].line(), found[0].column()), (2, 10));
    assert!(read_scene_bytes("x.toml", GOOD.as_bytes(), &[]).is_ok());
}

#[test]
fn overrides_replace_and_are_blamed() {
    let set = |path, value| read_scene_with("good.toml", GOOD, &[(path, value)]);
    let stiff =
        |s: Result<snapfit::scene::SceneFile, _>| s.unwrap().scene().pawls[0].stiffness.clone();
    for (path, value) in [
        ("pawl.0.stiffness", "22/7"),
        ("pawl.left.stiffness", "22/7"),
        ("pawl.\"left\".stiffness", "\"22/7\""),
        ("pawl.0.stiffness", " 22/7 "),
    ] {
        assert_eq!(
            stiff(set(path, value)),
            Some(Rat::frac(22, 7)),
            "{path}={value}"
        );
    }
    let file = set("pawl.left.vertices", "[[0,6],[\"1/2\",3],[-1,3]]").unwrap();
    assert_eq!(file.scene().pawls[0].vertices[1].x, Rat::frac(1, 2));
    assert_eq!(
        set("pawl.right.start", "0.1").unwrap().scene().pawls[1].start,
        Rat::frac(1, 10)
    );
    assert!(
        !set("classify.total", "false")
            .unwrap()
            .scene()
            .classify
            .clone()
            .unwrap()
            .total
    );
    let bare = GOOD[..GOOD.find("[classify]").unwrap()].to_owned();
    let file = read_scene_with("x.toml", &bare, &[("classify.total", "true")]).unwrap();
    assert!(file.scene().classify.as_ref().unwrap().total);

    for (path, value, code, column) in [
        ("pawl.3.stiffness", "1", "unknown-override", 6),
        ("pawl.middle.stiffness", "1", "unknown-override", 6),
        ("pawls.0.stiffness", "1", "unknown-override", 1),
        ("scene.friction.x", "1", "unknown-override", 16),
        ("", "1", "unknown-override", 1),
        ("pawl.left.stiffnes", "1", "unknown-key", 11),
        ("pawl.left.stiffness", "-1", "stiffness-not-positive", 21),
        ("pawl.left.stiffness", "soft", "malformed-number", 21),
        ("pawl.left.start", "  3", "start-outside-limits", 19),
        (
            "pawl.left.vertices",
            "[[0,6],[1,3]]",
            "too-few-vertices",
            20,
        ),
        (
            "pawl.left.vertices",
            "[[0,6],[1,3],[1,3],[-1,3]]",
            "zero-length-edge",
            33,
        ),
    ] {
        let found = set(path, value).unwrap_err();
        assert_eq!(found[0].code(), code, "{path}={value}");
        assert_eq!(
            (found[0].line(), found[0].column()),
            (1, column),
            "{path}={value}"
        );
        let place = format!("--set:1:{column}");
        assert!(found[0].render(Rendering::Plain).contains(&place));
    }
}

#[test]
fn a_preloaded_pawl_starts_on_its_stop() {
    let start = |limits: &str| {
        let text = GOOD.replace("start = \"1/10\"\n", "").replace(
            "limits = [\"-1/2\", \"1/2\"]",
            &format!("limits = {limits}"),
        );
        let file = read_scene("x.toml", &text).unwrap();
        let back = read_scene("y.toml", &file.scene().to_toml()).unwrap();
        assert_eq!(file.scene(), back.scene());
        file.scene().pawls[0].start.clone()
    };
    assert_eq!(start("[\"-1/2\", \"1/2\"]"), Rat::zero());
    assert_eq!(start("[\"0\", \"1/2\"]"), Rat::zero());
    assert_eq!(start("[\"1/9\", \"1/2\"]"), Rat::frac(1, 9));
    assert_eq!(start("[\"-1/2\", \"-1/7\"]"), Rat::frac(-1, 7));
}

#[test]
fn warnings_and_check() {
    let text = GOOD
        .replace("[14, 0], ", "[13, 0], [14, 0], ")
        .replace("[12, 3]]", "[12, 3], [9, -1]]")
        .replace("name = \"right\"", "name = \"block\"")
        .replace("stiffness = 0.5\n", "");
    let file = read_scene("w.toml", &text).unwrap_or_else(|e| panic!("{}", SceneError::from(e)));
    let report = check(&file);
    for code in [
        "straight-vertex",
        "obstacles-overlap",
        "shared-name",
        "some-stiffness",
    ] {
        assert!(
            report.warnings.iter().any(|w| w.contains(code)),
            "{code}: {report}"
        );
    }
    assert!(report.warnings.iter().all(|w| w.starts_with("w.toml:")));
    assert_eq!(report.obstacle_edges, 4 + 3 + 3 + 6);
    // A hole of three corners has none that can strike; the block has one reflex and one straight.
    assert_eq!(report.pawls.len(), 2);
    assert_eq!(report.phases, 2);
    let by_hand: usize = report
        .pawls
        .iter()
        .map(|p| p.type_a_pairs + p.type_b_pairs)
        .sum();
    assert_eq!(report.contact_pairs, 2 * by_hand);
    let shown = report.to_string();
    for word in [
        "friction", "μ = 1/4", "forces", "root", "limits", "holes", "classify",
    ] {
        assert!(shown.contains(word), "{shown}");
    }
    let json: serde_json::Value = serde_json::to_value(&report).unwrap();
    assert_eq!(json["schema"], "snapfit.check/1");
    let modelled = |file: &str| -> Vec<String> {
        let report = check(&read_scene("x.toml", file).unwrap());
        let on = report.features.into_iter().filter(|f| f.modelled);
        on.map(|f| f.name.to_owned()).collect()
    };
    assert_eq!(
        modelled(GOOD),
        ["friction", "forces", "root", "limits", "holes", "classify"]
    );
    assert_eq!(modelled(MINIMAL), ["classify"]);
}

/// Nothing but what must be there.
const MINIMAL: &str = r#"
scene = { name = "least" }
obstacle = [ { name = "a", vertices = [[0, 0], [1, 0], [0, 1]] } ]
pawl = [ { name = "p", hinge = [9, 9], vertices = [[0, 0], [-1, 0], [0, -1]] } ]
motion = [ { velocity = [1, 0], duration = 1 } ]
"#;

// ---- the outsider's scenes -------------------------------------------------------------------

fn outside_scenes() -> Vec<(String, String)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/oracle/scenes");
    let mut found = Vec::new();
    let mut folders = vec![std::path::PathBuf::from(folder)];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else {
            continue;
        };
        for entry in entries.flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "toml")
                && let Ok(text) = std::fs::read_to_string(&path)
            {
                found.push((path.display().to_string(), text));
            }
        }
    }
    if found.is_empty() {
        eprintln!("SKIPPED: no scenes in {folder}");
    }
    found
}

#[test]
fn outside_scenes_read_alike_in_both_notations() {
    for (name, text) in outside_scenes() {
        let file = read_scene(&name, &text).unwrap_or_else(|e| panic!("{}", SceneError::from(e)));
        let json = file.tree().to_json();
        let again = read_scene("scene.json", &json).unwrap();
        assert_eq!(file.scene(), again.scene(), "{name}");
        let guessed = read_scene("-", &json).unwrap();
        assert_eq!(file.scene(), guessed.scene(), "{name}");
        let back = read_scene("back.toml", &file.scene().to_toml()).unwrap();
        assert_eq!(file.scene(), back.scene(), "{name}");
        assert!(check(&file).contact_pairs > 0);
    }
}

// ---- random scenes ---------------------------------------------------------------------------

fn rat() -> impl Strategy<Value = Rat> {
    prop_oneof![
        3 => (-20i64..20, 1i64..9).prop_map(|(n, d)| Rat::frac(n, d)),
        1 => ("[1-9][0-9]{0,40}", "[1-9][0-9]{0,40}")
            .prop_map(|(n, d)| format!("{n}/{d}").parse().unwrap()),
    ]
}

fn positive() -> impl Strategy<Value = Rat> {
    rat().prop_map(|r| r.abs() + Rat::frac(1, 3))
}

fn vector() -> impl Strategy<Value = Vec2> {
    (rat(), positive()).prop_map(|(x, y)| Vec2::new(x, y))
}

/// A triangle or quadrangle within a column of its own.
fn body(column: i64) -> impl Strategy<Value = Vec<Vec2>> {
    let unit = || (1i64..9).prop_map(|n| Rat::frac(n, 10));
    (unit(), unit(), any::<bool>(), any::<bool>()).prop_map(move |(u, v, four, turn)| {
        let x = |t: Rat| Rat::from(10 * column) + t;
        let mut ring = vec![
            Vec2::new(x(Rat::zero()), Rat::zero()),
            Vec2::new(x(Rat::from(2)), -&u),
            Vec2::new(x(Rat::one()), Rat::one() + &v),
        ];
        if four {
            ring.push(Vec2::new(x(-&u), Rat::one()));
        }
        if turn {
            ring.reverse();
        }
        ring
    })
}

fn scenes() -> impl Strategy<Value = Scene> {
    let name = "[a-zA-Z0-9 \"\\\\'\n\té✂#=\\[\\]]{0,12}";
    let obstacles = prop::collection::vec(Just(()), 1..4);
    let pawls = prop::collection::vec(
        (
            prop::option::of(positive()),
            prop::option::of((positive(), positive())),
            any::<bool>(),
        ),
        1..4,
    );
    let motions = prop::collection::vec(
        prop::option::of((vector(), prop::option::of(positive()), any::<bool>())),
        1..5,
    );
    let classify = prop::option::of((
        prop::collection::vec(vector(), 0..3),
        any::<bool>(),
        prop::option::of(positive()),
        prop::option::of(positive()),
    ));
    let bodies = [body(0), body(1), body(2), body(3)];
    let others = [body(5), body(6), body(7), body(8)];
    let first = (
        name,
        prop::option::of(positive()),
        obstacles,
        pawls,
        motions,
        classify,
    );
    (
        first,
        bodies,
        others,
        any::<bool>(),
        prop::option::of(vector()),
    )
        .prop_map(
            |(
                (name, friction, obstacles, pawls, motions, classify),
                bodies,
                others,
                root,
                reference,
            )| {
                let root = root.then(|| Root {
                    vertices: others[3].clone(),
                    reference,
                });
                let motions: Vec<Motion> = motions
                    .into_iter()
                    .enumerate()
                    .map(|(k, motion)| match motion {
                        None if k > 0 => Motion::Reverse,
                        None => Motion::Translate {
                            velocity: Vec2::new(Rat::one(), Rat::zero()),
                            duration: Some(Rat::one()),
                            until_root_collision: false,
                        },
                        Some((velocity, duration, until)) => {
                            let until = until && root.is_some();
                            Motion::Translate {
                                velocity,
                                duration: duration.or((!until).then(Rat::one)),
                                until_root_collision: until,
                            }
                        }
                    })
                    .collect();
                Scene {
                    name: name.clone(),
                    friction,
                    obstacles: (0..obstacles.len())
                        .map(|k| Obstacle {
                            name: format!("{name}{k}"),
                            vertices: bodies[k].clone(),
                            holes: Vec::new(),
                        })
                        .collect(),
                    root,
                    pawls: pawls
                        .into_iter()
                        .enumerate()
                        .map(|(k, (stiffness, limits, preloaded))| {
                            let limits = limits.map(|(lo, width)| (lo.clone(), lo + width));
                            let start = match &limits {
                                Some((lo, hi)) if preloaded => Rat::midpoint(lo, hi),
                                Some((lo, _)) => lo.clone(),
                                None => Rat::zero(),
                            };
                            Pawl {
                                name: format!("p{k}{name}"),
                                // Turned about a vertex of its own, a body keeps to its columns.
                                hinge: others[k][0].clone(),
                                vertices: others[k].clone(),
                                stiffness,
                                start,
                                limits,
                            }
                        })
                        .collect(),
                    motions,
                    classify: classify.map(|(directions, total, force_limit, escape_distance)| {
                        Classify {
                            directions,
                            total,
                            force_limit,
                            escape_distance,
                        }
                    }),
                }
            },
        )
}

#[test]
fn scenes_come_back_from_text() {
    let mut runner = TestRunner::new(Config {
        cases: count(10_000).max(50) as u32,
        failure_persistence: None,
        ..Config::default()
    });
    runner
        .run(&scenes(), |scene| {
            let text = scene.to_toml();
            let file = read_scene("x.toml", &text)
                .map_err(|e| TestCaseError::fail(format!("{}\n{text}", SceneError::from(e))))?;
            prop_assert_eq!(file.scene(), &scene);
            let json = read_scene("x.json", &file.tree().to_json())
                .map_err(|e| TestCaseError::fail(SceneError::from(e).to_string()))?;
            prop_assert_eq!(json.scene(), &scene);
            // What the strict reader writes, the usual reader reads.
            prop_assert!(serde_json::from_str::<serde_json::Value>(&file.tree().to_json()).is_ok());
            Ok(())
        })
        .unwrap();
}

/// The strict JSON reader accepts exactly what `serde_json` accepts, but for duplicate keys.
#[test]
fn json_agrees_with_serde_json() {
    let piece = prop_oneof![
        Just("{".to_owned()),
        Just("}".to_owned()),
        Just("[".to_owned()),
        Just("]".to_owned()),
        Just(",".to_owned()),
        Just(":".to_owned()),
        Just("\"a\"".to_owned()),
        Just("\"b\":".to_owned()),
        Just("1".to_owned()),
        Just("-0.5e+3".to_owned()),
        Just("true".to_owned()),
        Just("null".to_owned()),
        Just(" ".to_owned()),
        Just("\n".to_owned()),
        Just("[1,2]".to_owned()),
        Just("{\"c\":[]}".to_owned()),
        "\"[a-z\\\\\"u0-9dD/é\u{0}-\u{1f}]{0,8}\"",
        "-?[0-9.eE+-]{1,6}",
    ];
    let mut runner = TestRunner::new(Config {
        cases: count(400_000).max(2_000) as u32,
        failure_persistence: None,
        ..Config::default()
    });
    let texts = prop::collection::vec(piece, 1..9).prop_map(|pieces| pieces.concat());
    runner
        .run(&texts, |text| {
            let mut sources = snapfit::scene::Sources::new();
            let index = sources.add(snapfit::scene::Source::new("x.json", &text));
            let ours = snapfit::scene::read_tree(&sources, index, snapfit::scene::Notation::Json);
            let theirs = serde_json::from_str::<serde_json::Value>(&text);
            let number_out_of_range =
                matches!(&theirs, Err(e) if e.to_string().contains("out of range"));
            match ours {
                Ok(tree) => {
                    prop_assert!(
                        theirs.is_ok() || number_out_of_range,
                        "{text:?}: {theirs:?}"
                    );
                    if let Ok(theirs) = theirs {
                        let back: serde_json::Value =
                            serde_json::from_str(&tree.to_json()).unwrap();
                        prop_assert_eq!(back, theirs);
                    }
                }
                Err(e) if e[0].code() == "duplicate-key" => {}
                Err(e) => prop_assert!(theirs.is_err(), "{text:?}: {}", e[0]),
            }
            Ok(())
        })
        .unwrap();
}
