//! Reading scenes: what is good reads alike in both notations and comes back; what is damaged is
//! refused with the right code at the right place, known by construction.

#[allow(unreachable_pub, reason = "a test file is a crate of its own")]
mod common;

use common::count;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use snapfit::geometry::Vec2;
use snapfit::number::Rat;
use snapfit::scene::{
    CODES, Classify, Diagnostic, MAX_VERTICES, Motion, Obstacle, Pawl, Rendering, Root, Scene,
    SceneError, Severity, check, read_scene, read_scene_bytes, read_scene_with,
};

/// Uses every part of the format.
const GOOD: &str = r#"[scene]
name = "all"
friction = "1/4"

[[obstacle]]
name = "plate"
vertices = [["-10","-4"], ["10","-4"], ["10","0"], ["-10","0"]]
holes = [[["-2","-3"], ["2","-3"], ["0","-1"]], [["4","-3"], ["6","-3"], ["5","-1"]]]

[[obstacle]]
name = "block"
vertices = [[12, 0], [14, 0], [14, 3], [12, 3]]

[root]
vertices = [["-2","10"], ["2","10"], ["2","12"], ["-2","12"]]
reference = ["0","10"]

[[pawl]]
name = "left"
hinge = ["0","6"]
vertices = [["0","6"], ["1","3"], ["-1","3"]]
stiffness = "2"
start = "1/10"
limits = ["-1/2", "1/2"]

[[pawl]]
name = "right"
hinge = ["5","6.5"]
vertices = [["5","6.5"], ["6","3e0"], ["4","3"]]
stiffness = 0.5

[[motion]]
velocity = ["0","-1"]
duration = "12"
until = "root-collision"

[[motion]]
reverse = true

[classify]
directions = [["0","1"], ["1","1"]]
total = true
force_limit = "5"
escape_distance = "100"
"#;

/// What to replace by what in [`GOOD`], `§` marking where the error is expected (nothing is
/// marked for the file's beginning), and the codes in the order of the places.
const DAMAGE: &[(&str, &str, &[&str])] = &[
    // Syntax.
    ("friction = \"1/4\"", "friction = §", &["syntax"]),
    ("friction = \"1/4\"", "friction = §1/4", &["syntax"]),
    ("name = \"all\"", "name = \"all§", &["syntax"]),
    ("reverse = true", "reverse = §maybe", &["syntax"]),
    ("[root]", "[root§\n", &["syntax"]),
    (
        "total = true",
        "total = true\n§total = true",
        &["duplicate-key"],
    ),
    ("[classify]", "[§scene]\n[classify]", &["duplicate-key"]),
    // Keys.
    ("friction = ", "§frction = ", &["unknown-key"]),
    ("stiffness = \"2\"", "§Stiffness = \"2\"", &["unknown-key"]),
    ("start = ", "§begin = ", &["unknown-key"]),
    ("reference = ", "§refrence = ", &["unknown-key"]),
    ("holes = ", "§hole = ", &["unknown-key"]),
    ("force_limit = ", "§force-limit = ", &["unknown-key"]),
    ("[classify]", "[§klassify]", &["unknown-key"]),
    ("duration = \"12\"", "§durations = \"12\"", &["unknown-key"]),
    (
        "reverse = true",
        "reverse = true\n§speed = 2",
        &["unknown-key"],
    ),
    ("[scene]\nname = \"all\"", "§[scene]", &["missing-key"]),
    (
        "[[obstacle]]\nname = \"plate\"",
        "§[[obstacle]]",
        &["missing-key"],
    ),
    ("[[pawl]]\nname = \"left\"", "§[[pawl]]", &["missing-key"]),
    (
        "[[pawl]]\nname = \"left\"\nhinge = [\"0\",\"6\"]",
        "§[[pawl]]\nname = \"left\"",
        &["missing-key"],
    ),
    (
        "[[motion]]\nvelocity = [\"0\",\"-1\"]",
        "§[[motion]]",
        &["missing-key"],
    ),
    (
        "[root]\nvertices = [[\"-2\",\"10\"], [\"2\",\"10\"], [\"2\",\"12\"], [\"-2\",\"12\"]]",
        "§[root]",
        &["missing-key"],
    ),
    // Types.
    ("name = \"all\"", "name = §12", &["wrong-type"]),
    ("name = \"block\"", "name = §[\"block\"]", &["wrong-type"]),
    ("friction = \"1/4\"", "friction = §true", &["wrong-type"]),
    (
        "friction = \"1/4\"",
        "friction = §1979-05-27",
        &["wrong-type"],
    ),
    ("hinge = [\"0\",\"6\"]", "hinge = §\"0,6\"", &["wrong-type"]),
    (
        "hinge = [\"0\",\"6\"]",
        "hinge = §[\"0\",\"6\",\"0\"]",
        &["wrong-type"],
    ),
    (
        "[\"1\",\"3\"], [\"-1\",\"3\"]",
        "§[\"1\"], [\"-1\",\"3\"]",
        &["wrong-type"],
    ),
    (
        "[\"1\",\"3\"], [\"-1\",\"3\"]",
        "§\"1\", §\"3\", [\"-1\",\"3\"]",
        &["wrong-type", "wrong-type"],
    ),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = §[\"1/2\"]",
        &["wrong-type"],
    ),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = §\"1/2\"",
        &["wrong-type"],
    ),
    ("total = true", "total = §\"true\"", &["wrong-type"]),
    (
        "directions = [[\"0\",\"1\"], [\"1\",\"1\"]]",
        "directions = §3",
        &["wrong-type"],
    ),
    ("[root]", "§[[root]]", &["wrong-type"]),
    (
        "until = \"root-collision\"",
        "until = §true",
        &["wrong-type"],
    ),
    // Numbers.
    (
        "friction = \"1/4\"",
        "friction = §\"1 / 4\"",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §\"\"",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §\"0,25\"",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §\".25\"",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §0x10",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §1_000",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §inf",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §nan",
        &["malformed-number"],
    ),
    ("[\"6\",\"3e0\"]", "[\"6\",§\"3e\"]", &["malformed-number"]),
    ("[12, 0]", "[§\"1é2\", 0]", &["malformed-number"]),
    (
        "friction = \"1/4\"",
        "friction = §\"1/0\"",
        &["bad-denominator"],
    ),
    (
        "start = \"1/10\"",
        "start = §\"1/-10\"",
        &["bad-denominator"],
    ),
    (
        "[12, 0], [14, 0]",
        "[§\"12/0\", 0], [§\"14/0\", 0]",
        &["bad-denominator", "bad-denominator"],
    ),
    (
        "duration = \"12\"",
        "duration = §\"1e100001\"",
        &["number-too-large"],
    ),
    (
        "stiffness = 0.5",
        "stiffness = §1e-999999",
        &["number-too-large"],
    ),
    // Polygons.
    (
        "[\"0\",\"6\"], [\"1\",\"3\"], [\"-1\",\"3\"]",
        "§[\"0\",\"6\"], [\"1\",\"3\"]",
        &["too-few-vertices"],
    ),
    (
        "[\"0\",\"6\"], [\"1\",\"3\"], [\"-1\",\"3\"]",
        "§",
        &["too-few-vertices"],
    ),
    (
        "[\"1\",\"3\"], [\"-1\",\"3\"]",
        "[\"1\",\"3\"], §[\"1\",\"3\"], [\"-1\",\"3\"]",
        &["zero-length-edge"],
    ),
    (
        "[14, 3], [12, 3]",
        "[14, 3], §[14, 3.0], [12, 3]",
        &["zero-length-edge"],
    ),
    (
        "[[12, 0], [14, 0], [14, 3], [12, 3]]",
        "[§[12, 0], [14, 0], [14, 3], [12, 3], [12, 0]]",
        &["zero-length-edge"],
    ),
    (
        "[\"1\",\"3\"], [\"-1\",\"3\"]",
        "[\"0\",\"5\"], [\"0\",\"3\"]",
        &["zero-area"],
    ),
    (
        "[[12, 0], [14, 0], [14, 3], [12, 3]]",
        "[§[12, 0], [14, 3], [14, 0], [12, 3]]",
        &["edges-meet"],
    ),
    (
        "[[12, 0], [14, 0], [14, 3], [12, 3]]",
        "[§[12, 0], [14, 0], [14, 3], [12, 3], [13, -1]]",
        &["edges-meet"],
    ),
    (
        "[14, 3], [12, 3]",
        "§§[14, 3], [12, 3], [13, 3.5], [14, 4], [13, 3]",
        &["edges-meet", "edges-meet"],
    ),
    (
        "[14, 3], [12, 3]",
        "[14, 3], §[14, 9], [14, 4], [12, 3]",
        &["spike"],
    ),
    (
        "[\"-2\",\"-3\"], [\"2\",\"-3\"]",
        "[\"-2\",\"-3\"]",
        &["too-few-vertices"],
    ),
    ("[\"0\",\"-1\"]]", "[\"0\",\"-3\"]]", &["zero-area"]),
    (
        "[[\"4\",\"-3\"], [\"6\",\"-3\"], [\"5\",\"-1\"]]",
        "§[[\"24\",\"-3\"], [\"26\",\"-3\"], [\"25\",\"-1\"]]",
        &["hole-outside"],
    ),
    (
        "[[\"4\",\"-3\"], [\"6\",\"-3\"], [\"5\",\"-1\"]]",
        "§[[\"-1\",\"-2.5\"], [\"1\",\"-2.5\"], [\"0\",\"-2\"]]",
        &["holes-overlap"],
    ),
    // Meaning.
    (
        "friction = \"1/4\"",
        "friction = §\"-1/4\"",
        &["friction-negative"],
    ),
    (
        "stiffness = \"2\"",
        "stiffness = §\"0\"",
        &["stiffness-not-positive"],
    ),
    (
        "stiffness = 0.5",
        "stiffness = §-0.5",
        &["stiffness-not-positive"],
    ),
    ("name = \"block\"", "name = §\"plate\"", &["duplicate-name"]),
    ("name = \"right\"", "name = §\"left\"", &["duplicate-name"]),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = §[\"1/2\", \"-1/2\"]",
        &["limits-order"],
    ),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = §[\"1/10\", \"0.1\"]",
        &["limits-order"],
    ),
    (
        "start = \"1/10\"",
        "start = §\"51/100\"",
        &["start-outside-limits"],
    ),
    (
        "start = \"1/10\"",
        "start = §\"0.50000000000000000000000000001\"",
        &["start-outside-limits"],
    ),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = [\"1/5\", \"1/2\"]",
        &["start-outside-limits"],
    ),
    (
        "velocity = [\"0\",\"-1\"]",
        "velocity = §[\"0\",\"0/5\"]",
        &["zero-velocity"],
    ),
    (
        "duration = \"12\"",
        "duration = §\"0\"",
        &["duration-not-positive"],
    ),
    (
        "duration = \"12\"",
        "duration = §-12",
        &["duration-not-positive"],
    ),
    (
        "[[motion]]\nvelocity = [\"0\",\"-1\"]\nduration = \"12\"\nuntil = \"root-collision\"",
        "§[[motion]]\nvelocity = [\"0\",\"-1\"]",
        &["endless-motion"],
    ),
    (
        "until = \"root-collision\"",
        "until = §\"root collision\"",
        &["unknown-until"],
    ),
    (
        "[[motion]]\nvelocity",
        "[[motion]]\nreverse = §true\n[[motion]]\nvelocity",
        &["reverse-first"],
    ),
    ("reverse = true", "reverse = §false", &["reverse-false"]),
    ("reverse = true", "reverse = §1", &["reverse-false"]),
    (
        "reverse = true",
        "reverse = true\n§duration = \"2\"",
        &["reverse-not-alone"],
    ),
    (
        "reverse = true",
        "§velocity = [0, 1]\nreverse = true",
        &["reverse-not-alone"],
    ),
    (
        "[\"1\",\"1\"]]\ntotal",
        "§[\"0\",\"0\"]]\ntotal",
        &["zero-direction"],
    ),
    (
        "force_limit = \"5\"",
        "force_limit = §\"-5\"",
        &["limit-not-positive"],
    ),
    (
        "escape_distance = \"100\"",
        "escape_distance = §\"0\"",
        &["limit-not-positive"],
    ),
    // Starting positions.
    (
        "[\"-2\",\"10\"], [\"2\",\"10\"]",
        "[\"-2\",\"-1\"], [\"2\",\"-1\"]",
        &["start-penetrates"],
    ),
    (
        "[\"5\",\"6.5\"], [\"6\",\"3e0\"], [\"4\",\"3\"]",
        "[\"5\",\"6.5\"], [\"6\",\"-0.5\"], [\"4\",\"3\"]",
        &["start-penetrates"],
    ),
    (
        "[12, 0], [14, 0], [14, 3], [12, 3]",
        "[1, 4], [1, 5], [3, 5], [3, 4]",
        &["start-penetrates"],
    ),
    // Several at once, in the order of the file.
    (
        "stiffness = \"2\"\nstart = \"1/10\"\nlimits = [\"-1/2\", \"1/2\"]",
        "stiffness = §\"-2\"\nstart = §\"ten\"\nlimits = §[2, 1]\n§limit = 3",
        &[
            "stiffness-not-positive",
            "malformed-number",
            "limits-order",
            "unknown-key",
        ],
    ),
    (
        "friction = \"1/4\"\n\n[[obstacle]]\nname = \"plate\"",
        "friction = §\"1/0\"\n\n[[obstacle]]\nname = \"plate\"\n§colour = \"red\"",
        &["bad-denominator", "unknown-key"],
    ),
];

/// Where a place that the damage does not mark is expected: the value after this text.
const AFTER: &[(&str, &str)] = &[
    // The ring as a whole.
    (
        "[\"0\",\"5\"], [\"0\",\"3\"]",
        "vertices = §[[\"0\",\"6\"], [\"0\",\"5\"]",
    ),
    (
        "[\"0\",\"-3\"]]",
        "holes = [§[[\"-2\",\"-3\"], [\"2\",\"-3\"], [\"0\",\"-3\"]]",
    ),
    (
        "[\"-2\",\"-3\"]",
        "holes = [§[[\"-2\",\"-3\"], [\"0\",\"-1\"]]",
    ),
    (
        "§[\"0\",\"6\"], [\"1\",\"3\"]",
        "vertices = §[[\"0\",\"6\"], [\"1\",\"3\"]]",
    ),
    ("§", "vertices = §[]"),
    // What put the body there.
    ("limits = [\"1/5\", \"1/2\"]", "start = §\"1/10\""),
    (
        "[\"-2\",\"-1\"], [\"2\",\"-1\"]",
        "vertices = §[[\"-2\",\"-1\"]",
    ),
    (
        "[\"5\",\"6.5\"], [\"6\",\"-0.5\"], [\"4\",\"3\"]",
        "vertices = §[[\"5\",\"6.5\"]",
    ),
    ("[1, 4], [1, 5], [3, 5], [3, 4]", "start = §\"1/10\""),
];

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
        assert!(found.len() < 1_000);
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
