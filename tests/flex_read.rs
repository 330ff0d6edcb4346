//! What a structure file may say and what not.
#![allow(clippy::unwrap_used)]

use snapfit::flex::generate::{FAMILIES, generate};
use snapfit::flex::{read_structure, structure_schema, structure_to_toml};
use snapfit::scene::STRUCTURE_CODES;
use std::collections::BTreeSet;

#[test]
fn structures_read_back_as_they_were_written() {
    for (family, _) in FAMILIES {
        let s = generate(family, 8, 5).unwrap();
        let text = structure_to_toml(&s);
        let back = read_structure("x.toml", text.as_bytes(), &[]).unwrap();
        assert_eq!(back.structure(), &s, "{family}");
    }
}

const PAIR: &str = r#"
[structure]
name = "pair"
epsilon = "3/5"
[[body]]
name = "a"
vertices = [["0","0"], ["1","0"], ["1","1"], ["0","1"]]
position = ["0","0"]
fixed = true
[[body]]
name = "b"
vertices = [["0","0"], ["1","0"], ["1","1"], ["0","1"]]
position = ["0","1.5"]
[objective]
terms = [ { body = "b", dx = "0", dy = "-1" } ]
"#;

#[test]
fn what_is_wrong_is_said_with_its_code() {
    assert!(read_structure("x.toml", PAIR.as_bytes(), &[]).is_ok());
    let cases: &[(&str, &str, &str)] = &[
        ("[structure]", "[structur]", "missing-key"),
        (
            "epsilon = \"3/5\"",
            "epsilon = \"0\"",
            "epsilon-not-positive",
        ),
        ("epsilon = \"3/5\"", "epsilon = \"1/0\"", "bad-denominator"),
        (
            "epsilon = \"3/5\"",
            "epsilon = \"3/5\"\nnearest = -1",
            "wrong-type",
        ),
        ("name = \"b\"", "name = \"a\"", "duplicate-name"),
        ("\"1.5\"", "\"0.5\"", "bodies-penetrate"),
        (
            "fixed = true",
            "fixed = true\npin = [0, 0]",
            "fixed-and-pinned",
        ),
        ("fixed = true", "fixed = 1", "wrong-type"),
        ("fixed = true", "fixd = true", "unknown-key"),
        ("body = \"b\"", "body = \"c\"", "unknown-body"),
        ("body = \"b\"", "body = \"b\", vertex = 4", "unknown-vertex"),
        ("dy = \"-1\"", "dy = \"0\"", "empty-term"),
        ("dy = \"-1\"", "radial_from = [0, 0]", "mixed-term"),
        (
            "[objective]",
            "[step]\nviolation = \"-1\"\n[objective]",
            "step-not-positive",
        ),
        (
            "[objective]",
            "[step]\npath = \"quick\"\n[objective]",
            "unknown-path",
        ),
        (
            "[objective]",
            "[step]\nmost = 0\n[objective]",
            "step-not-positive",
        ),
        (
            "[objective]",
            "[[joint]]\nbodies = [[\"a\", \"a\"]]\n[objective]",
            "joint-with-itself",
        ),
        (
            "[objective]",
            "[[joint]]\nbodies = [[\"a\", \"b\"]]\nfirst = [[4, 0]]\n[objective]",
            "unknown-vertex",
        ),
        (
            "[objective]",
            "[[view]]\nbody = \"a\"\nof = \"b\"\ncamera = [0, 0]\nmarker = [0, 0]\nleft = [1, 0]\nright = [0, 1]\n[objective]",
            "view-cone",
        ),
        ("[\"1\",\"1\"]", "[\"1\",\"-1\"]", "edges-meet"),
        ("[[body]]", "[[zzzz]]", "no-body"),
    ];
    let mut seen = BTreeSet::new();
    for (from, to, code) in cases {
        let text = if *from == "[[body]]" {
            PAIR.replace(from, to)
        } else {
            PAIR.replacen(from, to, 1)
        };
        let errors = read_structure("x.toml", text.as_bytes(), &[]).expect_err(to);
        let codes: Vec<&str> = errors.iter().map(|e| e.code()).collect();
        assert!(codes.contains(code), "{to}: {codes:?}");
        assert!(errors.iter().all(|e| e.line() >= 1 && e.column() >= 1));
        seen.extend(codes);
    }
    let missing: Vec<&str> = STRUCTURE_CODES
        .iter()
        .map(|(code, _)| *code)
        .filter(|code| !seen.contains(code))
        .collect();
    assert!(missing.is_empty(), "codes without a case: {missing:?}");
}

#[test]
fn damaged_files_never_panic() {
    let bytes = PAIR.as_bytes();
    for cut in (0..bytes.len()).step_by(3) {
        let _ = read_structure("x.toml", &bytes[..cut], &[]);
        let mut damaged = bytes.to_vec();
        damaged[cut] = b"[]{}\"=\x00\xff9-"[cut % 10];
        let _ = read_structure("x.toml", &damaged, &[]);
    }
}

/// The reader's message on an unknown key lists the keys of the table, which are the schema's.
#[test]
fn the_schema_has_the_keys_of_the_reader() {
    let schema = serde_json::to_value(structure_schema()).unwrap();
    let keys = |name: &str| -> BTreeSet<String> {
        let table = if name.is_empty() {
            &schema
        } else {
            &schema["$defs"][name]
        };
        table["properties"]
            .as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect()
    };
    let view = "[[view]]\nqqqqqqqqqq = 1\n[objective]";
    let joint = "[[joint]]\nqqqqqqqqqq = 1\n[objective]";
    for (name, from, to) in [
        ("", "[structure]", "qqqqqqqqqq = 1\n[structure]"),
        (
            "StructureSection",
            "[structure]",
            "[structure]\nqqqqqqqqqq = 1",
        ),
        ("BodyTable", "fixed = true", "qqqqqqqqqq = 1"),
        ("JointTable", "[objective]", joint),
        ("ViewTable", "[objective]", view),
        (
            "ObjectiveSection",
            "[objective]",
            "[objective]\nqqqqqqqqqq = 1",
        ),
        ("TermTable", "body = \"b\"", "qqqqqqqqqq = \"b\""),
        (
            "StepSection",
            "[objective]",
            "[step]\nqqqqqqqqqq = 1\n[objective]",
        ),
    ] {
        let text = PAIR.replacen(from, to, 1);
        let errors = read_structure("x.toml", text.as_bytes(), &[]).unwrap_err();
        let help = errors
            .iter()
            .find(|e| e.code() == "unknown-key")
            .and_then(|e| e.advice())
            .unwrap_or_else(|| panic!("{name}: {errors:?}"));
        let listed: BTreeSet<String> = help
            .trim_start_matches("the keys here are: ")
            .split(", ")
            .map(str::to_owned)
            .collect();
        assert_eq!(listed, keys(name), "{name}");
    }
}
