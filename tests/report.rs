//! The result document against the contract: its shape, its numbers, its order.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use serde_json::Value;
use snapfit::motion::{Method, Options, simulate};
use snapfit::number::{Algebraic, Int, Poly, Rat};
use snapfit::report::json::{Provenance, ResultDocument, result_schema};
use snapfit::report::summary::{Style, summary};
use snapfit::report::{picture, theta};
use snapfit::scene::read_scene;
use std::collections::BTreeSet;

const SCENES: [(&str, &str); 6] = [
    ("pins", include_str!("data/pins.toml")),
    ("fork", include_str!("data/fork.toml")),
    ("frame", include_str!("data/frame.toml")),
    ("stops", include_str!("data/stops.toml")),
    ("bars", include_str!("data/bars.toml")),
    ("root", include_str!("data/root.toml")),
];

fn document(text: &str) -> (snapfit::scene::Scene, ResultDocument) {
    let scene = read_scene("test.toml", text).unwrap().into_scene();
    let trajectory = simulate(&scene, &Options::default()).unwrap();
    let how = Provenance {
        arithmetic: "exact",
        method: Method::Sweep,
    };
    let document = ResultDocument::new(&scene, &trajectory, how);
    (scene, document)
}

fn value(text: &str) -> Value {
    serde_json::from_str(&document(text).1.to_text().unwrap()).unwrap()
}

fn keys(v: &Value) -> Vec<&str> {
    v.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Calls `f` on every number object within a document.
fn each_num(v: &Value, f: &mut impl FnMut(&Value)) {
    match v {
        Value::Object(map) if map.contains_key("exact") => f(v),
        Value::Object(map) => map.values().for_each(|v| each_num(v, f)),
        Value::Array(list) => list.iter().for_each(|v| each_num(v, f)),
        _ => {}
    }
}

fn rat(v: &Value) -> Rat {
    v.as_str().unwrap().parse().unwrap()
}

#[test]
fn orientations_are_correctly_rounded() {
    for line in include_str!("data/theta.txt")
        .lines()
        .filter(|l| !l.starts_with('#'))
    {
        let [h, n, d, digits] = line.split(' ').collect::<Vec<_>>()[..] else {
            panic!("four columns: {line}");
        };
        let x = Rat::new(n.parse::<Int>().unwrap(), d.parse::<Int>().unwrap());
        let nearest: f64 = digits.parse().unwrap();
        assert_eq!(
            theta(h.parse().unwrap(), &Algebraic::from(x)),
            nearest,
            "{line}"
        );
    }
}

#[test]
fn every_number_is_its_exact_form_rounded_and_isolated() {
    let mut degrees = BTreeSet::new();
    for (_, text) in SCENES {
        each_num(&value(text), &mut |num| {
            let double = num["value"].as_f64();
            let exact = &num["exact"];
            if !exact["rational"].is_null() {
                let r = rat(&exact["rational"]);
                assert_eq!(r.to_string(), exact["rational"].as_str().unwrap());
                assert_eq!(r.nearest_f64(), double);
                degrees.insert(1);
                return;
            }
            let coefficients = exact["polynomial"].as_array().unwrap();
            let coefficients: Vec<Int> = coefficients
                .iter()
                .map(|c| c.as_str().unwrap().parse().unwrap())
                .collect();
            let p = Poly::new(coefficients);
            assert_eq!(p.primitive(), p, "primitive, leading one positive");
            assert_eq!(p.squarefree(), p);
            assert_eq!(p.irreducible_factors().len(), 1);
            let (lo, hi) = (rat(&exact["interval"][0]), rat(&exact["interval"][1]));
            let roots = p.real_roots_in(&lo, &hi);
            assert_eq!(roots.len(), 1);
            assert_eq!(roots[0].nearest_f64(), double);
            // [k/2^j, (k+1)/2^j], and twice as coarse would hold another root.
            let width = &hi - &lo;
            assert_eq!(*width.numer(), Int::one());
            assert!((&lo / &width).is_integer());
            if width < Rat::one() {
                let twice = &width + &width;
                let lo = Rat::from((&lo / &twice).floor()) * &twice;
                assert!(p.real_roots_in(&lo, &(&lo + &twice)).len() > 1);
            }
            degrees.insert(p.degree().unwrap());
        });
    }
    assert!(degrees.contains(&2) && degrees.contains(&4), "{degrees:?}");
}

#[test]
fn the_document_has_the_contracts_shape() {
    for (name, text) in SCENES {
        let doc = value(text);
        assert_eq!(doc["schema"], "snapfit.result/1");
        assert_eq!(doc["arithmetic"], "exact");
        assert_eq!(doc["method"], "sweep");
        for key in ["kind", "time", "phase", "pawl", "position"] {
            assert!(doc["outcome"].get(key).is_some(), "{name}: outcome.{key}");
        }
        assert_eq!(doc["outcome"]["position"].as_array().unwrap().len(), 2);
        let bifurcated = doc["outcome"]["kind"] == "bifurcated";
        assert_eq!(doc["outcome"].get("branches").is_some(), bifurcated);
        for phase in doc["phases"].as_array().unwrap() {
            assert_eq!(keys(phase), ["from", "to", "velocity"]);
        }
        for pawl in doc["pawls"].as_array().unwrap() {
            for event in pawl["events"].as_array().unwrap() {
                check_event(event);
            }
            for segment in pawl["segments"].as_array().unwrap() {
                check_segment(segment);
            }
        }
    }
}

fn check_event(event: &Value) {
    for key in [
        "kind", "time", "phase", "tan_half", "theta", "winding", "contacts",
    ] {
        assert!(event.get(key).is_some(), "{event}");
    }
    let snap = matches!(
        event["kind"].as_str(),
        Some("snap-free" | "snap-free-vertex")
    );
    for key in ["to_tan_half", "to_theta", "to_winding"] {
        assert_eq!(event.get(key).is_some(), snap, "{event}");
    }
    // θ = 2·atan(tan_half) + 2π·winding
    if let Some(u) = event["tan_half"]["value"].as_f64() {
        let turns = event["winding"].as_i64().unwrap() as f64;
        let about = 2.0 * u.atan() + std::f64::consts::TAU * turns;
        assert!((about - event["theta"].as_f64().unwrap()).abs() < 1e-12);
    }
    for contact in event["contacts"].as_array().unwrap() {
        check_contact(contact);
    }
}

fn check_contact(contact: &Value) {
    let kind = contact["type"].as_str().unwrap();
    let root = contact
        .get("root_vertex")
        .or(contact.get("root_edge"))
        .is_some();
    let mut expected: BTreeSet<&str> = match (kind, root) {
        ("B", false) => ["type", "pawl_vertex", "obstacle", "obstacle_edge"].into(),
        ("A", false) => ["type", "pawl_edge", "obstacle", "obstacle_vertex"].into(),
        ("B", true) => ["type", "root_vertex", "obstacle", "obstacle_edge"].into(),
        ("A", true) => ["type", "root_edge", "obstacle", "obstacle_vertex"].into(),
        _ => ["type", "limit"].into(),
    };
    if contact.get("hole").is_some() {
        expected.insert("hole");
    }
    assert_eq!(keys(contact).into_iter().collect::<BTreeSet<_>>(), expected);
}

fn check_segment(segment: &Value) {
    let expected = [
        "kind", "phase", "from", "to", "winding", "contact", "also", "curve", "branch",
    ];
    let expected: BTreeSet<&str> = expected.into();
    assert_eq!(keys(segment).into_iter().collect::<BTreeSet<_>>(), expected);
    if segment["kind"] == "free" {
        for key in ["contact", "curve", "branch"] {
            assert!(segment[key].is_null());
        }
        return;
    }
    check_contact(&segment["contact"]);
    assert!(matches!(segment["branch"].as_str(), Some("+" | "-")));
    let curve = &segment["curve"];
    for side in ["p", "q"] {
        assert_eq!(curve[side].as_array().unwrap().iter().map(rat).count(), 3);
    }
    if segment["contact"]["type"] == "limit" {
        assert_eq!(curve["p"][1], "1");
        assert_eq!(curve["p"][2], "0");
        assert_eq!(curve["q"], serde_json::json!(["0", "0", "0"]));
        assert_eq!(segment["branch"], "+");
    }
}

#[test]
fn particular_contacts() {
    let frame = value(include_str!("data/frame.toml"));
    let segments = frame["pawls"][0]["segments"].as_array().unwrap();
    // The lower stop at tan(θ/2) = 1/10, then the hole's edge.
    assert_eq!(
        segments[0]["contact"],
        serde_json::json!({"type": "limit", "limit": 0})
    );
    assert_eq!(
        segments[0]["curve"]["p"],
        serde_json::json!(["-1/10", "1", "0"])
    );
    assert_eq!(
        segments[1]["contact"],
        serde_json::json!({"type": "B", "pawl_vertex": 1, "obstacle": "frame", "obstacle_edge": 0, "hole": 0})
    );
    let root = value(include_str!("data/root.toml"));
    assert_eq!(root["outcome"]["kind"], "root-collision");
    assert_eq!(
        root["pawls"][0]["events"][0]["contacts"],
        serde_json::json!([{"type": "A", "root_edge": 0, "obstacle": "tooth", "obstacle_vertex": 1}])
    );
}

#[test]
fn times_count_from_the_start_of_the_plan() {
    let doc = value(include_str!("data/pins.toml"));
    assert_eq!(doc["phases"][1]["from"]["value"], 18.0);
    assert_eq!(doc["phases"][1]["to"], doc["outcome"]["time"]);
    let mut clock = 0.0;
    for event in doc["pawls"][0]["events"].as_array().unwrap() {
        let t = event["time"]["value"].as_f64().unwrap();
        assert!(t >= clock);
        clock = t;
    }
    let mut clock = 0.0;
    for segment in doc["pawls"][0]["segments"].as_array().unwrap() {
        assert_eq!(segment["from"]["value"].as_f64().unwrap(), clock);
        clock = segment["to"]["value"].as_f64().unwrap();
    }
    assert_eq!(doc["outcome"]["time"]["value"].as_f64().unwrap(), clock);
    // The root's displacement then: down for 18, and back up since.
    let y = doc["outcome"]["position"][1]["value"].as_f64().unwrap();
    assert!((y - (clock - 36.0)).abs() < 1e-12);
}

#[test]
fn the_same_bytes_every_time() {
    for (_, text) in SCENES {
        // All but the seconds that the ledger tells, at the end.
        let texts = [(); 2].map(|()| {
            let all = document(text).1.to_text().unwrap();
            let (before, _) = all.split_once("\"ledger\"").unwrap();
            let ledger = serde_json::from_str::<Value>(&all).unwrap()["ledger"].take();
            (before.to_owned(), ledger["predicates"].clone())
        });
        assert_eq!(texts[0], texts[1]);
    }
}

#[test]
fn the_schema_names_what_documents_hold() {
    let schema = serde_json::to_value(result_schema()).unwrap();
    let defs = &schema["$defs"];
    for name in [
        "Num",
        "Outcome",
        "Pawl",
        "Event",
        "Segment",
        "Contact",
        "RootContact",
        "Curve",
    ] {
        assert!(defs.get(name).is_some(), "{name}");
    }
    for (_, text) in SCENES {
        let doc = value(text);
        let known = |v: &Value, def: &Value| {
            for key in keys(v) {
                assert!(def["properties"].get(key).is_some(), "{key}");
            }
        };
        known(&doc, &schema);
        known(&doc["outcome"], &defs["Outcome"]);
        for pawl in doc["pawls"].as_array().unwrap() {
            pawl["events"]
                .as_array()
                .unwrap()
                .iter()
                .for_each(|e| known(e, &defs["Event"]));
            pawl["segments"]
                .as_array()
                .unwrap()
                .iter()
                .for_each(|s| known(s, &defs["Segment"]));
        }
    }
}

#[test]
fn the_summary_says_how_when_and_why() {
    let (_, doc) = document(include_str!("data/pins.toml"));
    let text = summary(&doc, Style::Plain);
    assert!(text.starts_with("pins jams at t ≈ 24.42"), "{text}");
    assert!(text.contains("edge 2 on shelf vertex 0"), "{text}");
    assert!(text.contains("106.03° → 0.00°"), "{text}");
    assert!(!text.contains('\x1b'));
    assert!(summary(&doc, Style::Ansi).contains("\x1b[1m"));
    let (_, doc) = document(include_str!("data/fork.toml"));
    assert!(summary(&doc, Style::Plain).contains("counter-clockwise, driven by vertex 0"));
}

/// The mechanisms of examples/ do what their comments say.
#[test]
fn examples_end_as_told() {
    let cases = [
        ("bayer-hook", "completed", 0.0),
        ("bayer-hook-steep", "stuck", -2.727),
        ("ratchet-rack", "jammed", 0.907),
        ("door-latch", "stuck", 0.0),
        ("escapement-rack", "completed", -4.98),
    ];
    for (name, kind, degrees) in cases {
        let path = format!("{}/examples/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let (_, doc) = document(&std::fs::read_to_string(path).unwrap());
        assert_eq!((doc.scene.as_str(), doc.outcome.kind), (name, kind));
        let last = doc.pawls[0].events.last().unwrap();
        assert!(
            (last.theta.to_degrees() - degrees).abs() < 0.01,
            "{name}: {}",
            last.theta
        );
    }
    let clicks = document(include_str!("../examples/ratchet-rack.toml")).1;
    let snaps = clicks.pawls[0]
        .events
        .iter()
        .filter(|e| e.to_theta.is_some());
    assert_eq!(snaps.count(), 19);
}

#[test]
fn pictures_are_whole_and_names_are_escaped() {
    for (_, text) in SCENES {
        let (scene, doc) = document(text);
        let svg = picture::svg(&scene, &doc);
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(
            !svg.contains("NaN") && !svg.contains("inf"),
            "{}",
            doc.scene
        );
        assert_eq!(svg.matches("<g ").count(), svg.matches("</g>").count());
    }
    let (scene, doc) = document(include_str!("data/fork.toml"));
    let svg = picture::svg(&scene, &doc);
    assert!(svg.contains("fork &lt;&amp;&gt; &quot;x&quot;"));
}
