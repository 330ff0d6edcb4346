//! Damaged scenes: what is broken is refused with the right code at the right place, both known by
//! construction (`table` lists them).
#![allow(
    clippy::unwrap_used,
    reason = "a test that unwraps nothing fails, as it should"
)]

#[allow(unreachable_pub, reason = "a test file is a crate of its own")]
#[path = "../common/mod.rs"]
mod common;
mod table;

use common::count;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use snapfit::scene::{
    CODES, Diagnostic, MAX_ERRORS, MAX_VERTICES, Rendering, SceneError, Severity, read_scene,
    read_scene_bytes,
};
use table::{AFTER, DAMAGE, GOOD};

/// A damaged text and what is expected of it: codes with lines and columns.
struct Case {
    text: String,
    expected: Vec<(String, usize, usize)>,
}

impl Case {
    /// From a text with marks.
    fn new(marked: &str, codes: &[&str]) -> Case {
        let places: Vec<(usize, usize)> = marked
            .match_indices('§')
            .map(|(at, _)| {
                let before = marked[..at].trim_start_matches('\u{feff}').replace('§', "");
                let line = before.matches('\n').count() + 1;
                let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
                (line, column)
            })
            .collect();
        assert_eq!(places.len(), codes.len(), "{marked}");
        Case {
            text: marked.replace('§', ""),
            expected: codes
                .iter()
                .zip(places)
                .map(|(code, (line, column))| ((*code).to_owned(), line, column))
                .collect(),
        }
    }

    fn assert_refused(&self, name: &str) {
        let found = match read_scene(name, &self.text) {
            Ok(_) => Vec::new(),
            Err(diagnostics) => diagnostics,
        };
        let shown: Vec<_> = found
            .iter()
            .map(|d| (d.code().to_owned(), d.line(), d.column()))
            .collect();
        let error = SceneError::from(found.clone()).render(Rendering::Plain);
        assert_eq!(shown, self.expected, "\n{error}\n{}", self.text);
        for d in &found {
            let place = format!("{name}:{}:{}", d.line(), d.column());
            assert!(
                d.render(Rendering::Plain).contains(&place),
                "{}",
                d.render(Rendering::Plain)
            );
            assert!(d.render(Rendering::Colour).contains(&place));
            assert!(d.to_string().starts_with(&place));
            assert!(d.advice().is_some_and(|help| !help.is_empty()), "{d}");
            assert!(!d.text().is_empty() && d.severity() == Severity::Error);
        }
    }
}

fn damaged(damage: &(&str, &str, &[&str])) -> Case {
    let (find, put, codes) = damage;
    assert!(GOOD.contains(find), "{find}");
    let moved = AFTER.iter().find(|(by, _)| by == put);
    let text = match moved {
        None => GOOD.replacen(find, put, 1),
        Some((_, marked)) => {
            let text = GOOD.replacen(find, &put.replace('§', ""), 1);
            let plain = marked.replace('§', "");
            assert!(text.contains(&plain), "{plain}");
            text.replacen(&plain, marked, 1)
        }
    };
    Case::new(&text, codes)
}

/// Harmless changes that move every place.
#[derive(Clone, Debug)]
struct Dress {
    bom: bool,
    crlf: bool,
    indent: usize,
    preamble: String,
}

impl Dress {
    fn on(&self, case: &Case) -> Case {
        let shift = self.preamble.matches('\n').count();
        let mut text = self.preamble.clone();
        for line in case.text.lines() {
            text.extend(std::iter::repeat_n(' ', self.indent));
            text.push_str(line);
            text.push_str(if self.crlf { "\r\n" } else { "\n" });
        }
        Case {
            text: if self.bom {
                format!("\u{feff}{text}")
            } else {
                text
            },
            expected: case
                .expected
                .iter()
                .map(|(code, line, column)| (code.clone(), line + shift, column + self.indent))
                .collect(),
        }
    }
}

#[test]
fn every_damage_is_named_and_placed() {
    for damage in DAMAGE {
        damaged(damage).assert_refused("damaged.toml");
    }
}

#[test]
fn damage_is_placed_in_any_dress() {
    let dress = (
        any::<bool>(),
        any::<bool>(),
        0usize..5,
        "(#[ a-zäöü✂𝄞]{0,20}\n|\n){0,6}",
    );
    let dress = dress.prop_map(|(bom, crlf, indent, preamble)| Dress {
        bom,
        crlf,
        indent,
        preamble,
    });
    // At 1 % every class still comes about once; the test above runs each of them anyway.
    let cases = count(300).max(3) * 40;
    let mut runner = TestRunner::new(Config {
        cases: cases as u32,
        failure_persistence: None,
        ..Config::default()
    });
    runner
        .run(&(dress, 0..DAMAGE.len()), |(dress, k)| {
            // Undamaged but dressed reads alike, and so do the damaged ones that are no damage.
            dress
                .on(&damaged(&DAMAGE[k]))
                .assert_refused("dressed.toml");
            Ok(())
        })
        .unwrap();
}

#[test]
fn json_damage_is_named_and_placed() {
    let good = read_scene("good.toml", GOOD)
        .expect("good")
        .tree()
        .to_json();
    assert!(read_scene("good.json", &good).is_ok());
    let damage: &[(&str, &str, &[&str])] = &[
        ("\"total\":true", "\"total\":true §\"x\":1", &["syntax"]),
        ("\"total\":true", "\"total\":§tru", &["syntax"]),
        ("\"total\":true", "\"total\":true,§}", &["syntax"]),
        ("\"total\":true", "§total:true", &["syntax"]),
        ("\"total\":true", "\"total\":§'x'", &["syntax"]),
        (
            "\"total\":true",
            "\"total\":true, §// no comments",
            &["syntax"],
        ),
        ("\"total\":true", "\"total\" §= true", &["syntax"]),
        ("[12,0]", "[0§12,0]", &["syntax"]),
        ("[12,0]", "[12.§,0]", &["syntax"]),
        ("[12,0]", "[§+12,0]", &["syntax"]),
        ("[12,0]", "[12,§]", &["syntax"]),
        ("[12,0]", "[§NaN,0]", &["syntax"]),
        ("\"all\"", "\"a§\tll\"", &["syntax"]),
        ("\"all\"", "\"a§\\x6c\"", &["syntax"]),
        ("\"all\"", "\"a§\\ud800\"", &["syntax"]),
        ("\"all\"", "\"a§\\u12G4\"", &["syntax"]),
        (
            "\"total\":true",
            "\"total\":true,\n  §\"total\":false",
            &["duplicate-key"],
        ),
        ("\"total\":true", "\"total\":§null", &["wrong-type"]),
        (
            "\"total\":true",
            "\"total\":true,\n §\"ü✂\":1, §\"é\":2",
            &["unknown-key", "unknown-key"],
        ),
        ("[12,0]", "[§\"12/-1\",0]", &["bad-denominator"]),
        ("[12,0]", "[§1e999999,0]", &["number-too-large"]),
    ];
    for (find, put, codes) in damage {
        assert!(good.contains(find), "{find}");
        Case::new(&good.replacen(find, put, 1), codes).assert_refused("damaged.json");
    }
    let open = good[..good.len() - 1].to_owned() + "§";
    Case::new(&open, &["syntax"]).assert_refused("open.json");
    Case::new(&format!("{good} §x"), &["syntax"]).assert_refused("trailing.json");
    Case::new("§[]", &["wrong-type"]).assert_refused("list.json");
}

#[test]
fn missing_parts_are_named() {
    let codes = |text: &str| -> Vec<&str> {
        let found = read_scene("x.toml", text).unwrap_err();
        found.iter().map(Diagnostic::code).collect()
    };
    let nothing = ["missing-key", "no-obstacle", "no-pawl", "no-motion"];
    assert_eq!(codes(""), nothing);
    assert_eq!(codes("# only a comment\n"), nothing);
    assert_eq!(codes("obstacle = []\nscene = {}\n").len(), 4);
    let without_root = GOOD.replace("[root]", "").replacen(
        "vertices = [[\"-2\",\"10\"], [\"2\",\"10\"], [\"2\",\"12\"], [\"-2\",\"12\"]]\nreference = [\"0\",\"10\"]\n",
        "",
        1,
    );
    assert_eq!(codes(&without_root), ["until-without-root"]);
    // Single brackets where double ones are meant.
    let single = GOOD.replacen(
        "[[obstacle]]\nname = \"plate\"",
        "[obstacle]\nname = \"plate\"",
        1,
    );
    assert!(!codes(&single).is_empty());
}

#[test]
fn hostile_texts_are_refused_quickly() {
    let refused = |name: &str, text: &str| {
        let found = read_scene(name, text).unwrap_err();
        assert!(!found.is_empty());
        assert!(found.len() <= MAX_ERRORS);
        for d in &found {
            assert!(
                d.render(Rendering::Plain).len() < 2_000,
                "{}",
                d.render(Rendering::Plain)
            );
        }
        found[0].code()
    };
    let deep = |open: &str, n: usize| open.repeat(n);
    assert_eq!(
        refused("x.json", &format!("{{\"a\":{}", deep("[", 100_000))),
        "nested-too-deep"
    );
    assert_eq!(
        refused("x.json", &deep("{\"a\":", 100_000)),
        "nested-too-deep"
    );
    let toml = refused("x.toml", &format!("a = {}", deep("[", 100_000)));
    assert!(["nested-too-deep", "syntax"].contains(&toml), "{toml}");
    refused("x.toml", &format!("a = {}", deep("{a=", 100_000)));
    refused("x.toml", &format!("{}a = 1", deep("a.", 100_000)));
    refused("x.toml", &format!("[{}a]", deep("a.", 100_000)));
    refused("x.toml", &"[[".repeat(10_000));
    refused("x.toml", &"§".repeat(10_000));
    let keys = |n: usize| (0..n).map(|k| format!("k{k} = 1\n")).collect::<String>();
    refused("x.toml", &keys(200_000));
    refused("x.toml", &format!("[scene]\n{}", keys(200_000)));
    refused("x.toml", &"[[pawl]]\n".repeat(200_000));
    refused(
        "x.toml",
        &GOOD.replacen("[12, 0],", &"[12, true],".repeat(90_000), 1),
    );
    refused("x.toml", &"a = \"\n".repeat(200_000));
    refused("x.json", &format!("{{\"a\":[{}", "[],".repeat(200_000)));
    let long = "9".repeat(100_001);
    assert_eq!(
        refused("x.toml", &GOOD.replace("\"1/4\"", &format!("\"{long}\""))),
        "number-too-large"
    );
    let huge = vec![b' '; snapfit::scene::MAX_FILE_BYTES + 1];
    assert_eq!(
        read_scene_bytes("x.toml", &huge, &[]).unwrap_err()[0].code(),
        "too-large"
    );
    let many = "[\"1\",\"3\"],".repeat(MAX_VERTICES + 1);
    let text = GOOD.replacen("[\"1\",\"3\"],", &many, 1);
    assert_eq!(refused("x.toml", &text), "too-many-vertices");
}

#[test]
fn codes_are_documented_once() {
    let mut codes: Vec<&str> = CODES.iter().map(|(code, _)| *code).collect();
    codes.sort_unstable();
    let before = codes.len();
    codes.dedup();
    assert_eq!(codes.len(), before);
    for (_, _, used) in DAMAGE {
        assert!(used.iter().all(|code| codes.contains(code)));
    }
}
