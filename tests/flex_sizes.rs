//! Structures of any size and with odd numbers: nothing is lost past the range of doubles, and
//! what is called apart comes apart.
#![allow(clippy::unwrap_used)]

use snapfit::flex::apps::constraints::constraints;
use snapfit::flex::apps::separate::{SeparateDocument, separate};
use snapfit::flex::report::{FlexDocument, StructureCheck};
use snapfit::flex::{
    Ending, FlexOptions, Flexed, Hold, Path, Structure, Term, flex, read_structure,
};
use snapfit::geometry::Vec2;
use snapfit::number::{Int, Rat};
use std::process::Command;

/// A tongue in a channel that is open to the left, in a unit of its own size: coordinates below 1.
fn gap(overrides: &[(&str, &str)]) -> Structure {
    let text = r#"
[structure]
name = "a block in a gap"
epsilon = "1/8"
[[body]]
name = "channel"
vertices = [["0", "0"], ["15/16", "0"], ["15/16", "3/4"], ["0", "3/4"], ["0", "21/40"], ["3/4", "21/40"], ["3/4", "9/40"], ["0", "9/40"]]
fixed = true
[[body]]
name = "tongue"
vertices = [["0", "0"], ["1/2", "0"], ["1/2", "1/4"], ["0", "1/4"]]
position = ["9/40", "1/4"]
[objective]
terms = [{ body = "tongue", dtheta = "1" }]
[step]
violation = "1/4000"
"#;
    read_structure("gap.toml", text.as_bytes(), overrides)
        .unwrap()
        .into_structure()
}

/// 2ᵏ.
fn power(k: i64) -> Rat {
    let big = Int::one().shl(k.unsigned_abs());
    if k < 0 {
        Rat::new(Int::one(), big)
    } else {
        Rat::from(big)
    }
}

/// All lengths times 2ᵏ.
fn times(s: &Structure, k: i64) -> Structure {
    let unit = power(k);
    let mut out = s.clone();
    let grow = |p: &mut Vec2| *p = Vec2::new(&p.x * &unit, &p.y * &unit);
    out.epsilon = &out.epsilon * &unit;
    out.step.violation = &out.step.violation * &unit;
    for b in &mut out.bodies {
        b.vertices.iter_mut().for_each(grow);
        grow(&mut b.position);
        if let Hold::Pin(p) = &mut b.hold {
            grow(p);
        }
    }
    out
}

fn run(s: &Structure) -> Flexed {
    flex(s, &FlexOptions::default())
}

const SIZES: [i64; 11] = [
    -4000, -2000, -1000, -600, -65, 500, 516, 1000, 1024, 1300, 4000,
];

/// Scaled by a power of two a structure keeps its rows, its verdict, and how far it turns; and
/// lengths are scaled with it.
#[test]
fn size_changes_nothing_but_lengths() {
    let base = gap(&[]);
    let (rows, want) = (constraints(&base), run(&base));
    assert_eq!(want.ending, Ending::Converged);
    assert!(rows.len() > 3 && want.displacement > Rat::frac(1, 10));
    let apart = separate(&base, true, None);
    assert_eq!(apart.verdict(), "comes-apart");
    for k in SIZES {
        let s = times(&base, k);
        let unit = power(k);
        let mine = constraints(&s);
        assert_eq!(mine.len(), rows.len(), "2^{k}");
        for (a, b) in mine.iter().zip(&rows) {
            assert_eq!(a.pair, b.pair, "2^{k}");
            assert_eq!(a.signed_square(), b.signed_square() * unit.square());
        }
        assert_eq!(StructureCheck::of(&s, Vec::new()).rows, rows.len());
        let got = run(&s);
        assert_eq!(got.ending, want.ending, "2^{k}");
        assert_eq!(got.displacement, want.displacement, "2^{k}");
        let places = |f: &Flexed| f.configurations.last().unwrap()[1].place.x.clone();
        assert_eq!(places(&got), places(&want) * unit.clone(), "2^{k}");
        let parted = separate(&s, true, None);
        assert_eq!(parted.verdict(), "comes-apart", "2^{k}");
        for (a, b) in parted.cases.iter().zip(&apart.cases) {
            assert_eq!((&a.velocities, a.clear), (&b.velocities, b.clear), "2^{k}");
        }
    }
}

/// On a safe path too, which used doubles of its own.
#[test]
fn a_safe_path_keeps_its_size() {
    let mut base = gap(&[]);
    base.step.path = Path::Safe;
    let want = run(&base);
    assert!(want.displacement.sign() > 0 && want.violation.square.is_zero());
    for k in [-1300, -600, 516, 1020, 1300] {
        let got = run(&times(&base, k));
        assert_eq!(got.displacement, want.displacement, "2^{k}");
        assert!(got.violation.square.is_zero(), "2^{k}");
    }
}

/// Weights of any size: a displacement is weighted by them, exactly.
#[test]
fn weights_past_doubles_weigh() {
    let base = run(&gap(&[]));
    for path in [Path::Fast, Path::Safe] {
        for (k, sign) in [(1300, 1), (1300, -1), (2000, 1)] {
            let mut s = gap(&[]);
            s.step.path = path;
            let Term::Body { dtheta, .. } = &mut s.objective[0] else {
                panic!("a term of a body");
            };
            *dtheta = power(k) * Rat::from(sign);
            let got = run(&s).displacement / power(k);
            let off = (got - &base.displacement).abs();
            assert!(off < Rat::frac(1, 500), "{path:?} 2^{k}: {off:?}");
        }
    }
}

/// Numbers of many digits are proposed to as others are.
#[test]
fn many_digits_flex_as_few() {
    let want = run(&gap(&[])).displacement;
    let long = format!("0.225{}1", "0".repeat(400));
    let place = format!("[\"{long}\", \"1/4\"]");
    for path in [Path::Fast, Path::Safe] {
        for set in [
            ("body.tongue.position", place.as_str()),
            ("body.tongue.tan_half", "1e-400"),
            ("step.rotation_limit", "1e400"),
        ] {
            let mut s = gap(&[set]);
            s.step.path = path;
            let got = run(&s);
            let off = (&got.displacement - &want).abs();
            assert!(
                got.ending == Ending::Converged && off < Rat::frac(1, 500),
                "{path:?} {} {:?}",
                set.0,
                got.why
            );
        }
    }
}

/// A limit of rotation that lets no step gain is not called convergence; a violation without
/// bounds pairs nothing that lies past epsilon.
#[test]
fn odd_rules_are_told() {
    let got = run(&gap(&[("step.rotation_limit", "1e-400")]));
    assert_eq!(got.ending, Ending::Undecided);
    assert!(
        got.why.to_string().contains("rotation_limit"),
        "{}",
        got.why
    );
    let mut s = gap(&[("step.violation", "1e400")]);
    s.step.path = Path::Safe;
    let got = run(&s);
    assert_eq!(got.ending, Ending::Converged, "{}", got.why);
    assert!(got.displacement > Rat::frac(1, 20));
}

/// Angles in radians stand beside what an objective counts.
#[test]
fn poses_tell_their_angles() {
    let s = gap(&[]);
    let flexed = run(&s);
    let document = FlexDocument::new(&s, &flexed, "exact");
    let turned = document.poses[1].turned;
    let counted = document.displacement.value.unwrap();
    assert!((2.0 * (turned / 2.0).tan() - counted).abs() < 1e-15);
    assert!(turned < counted);
    assert_eq!(document.poses[0].turned, 0.0);
    // Past a quarter either way: 2 atan 3 and its negative, a half turn for tan(θ/2) = 10⁴⁰⁰.
    for (u, theta) in [
        ("3", 2.498_091_544_796_509),
        ("-3", -2.498_091_544_796_509),
        ("1e400", std::f64::consts::PI),
    ] {
        let text =
            format!("[structure]\nname = \"one\"\nepsilon = \"1\"\n{FREE}tan_half = \"{u}\"\n");
        let s = read(&text);
        let mut still = flexed.clone();
        still.configurations = vec![s.bodies.iter().map(snapfit::flex::Pose::of).collect()];
        let pose = &FlexDocument::new(&s, &still, "exact").poses[0];
        assert_eq!((pose.theta, pose.turned), (theta, 0.0), "{u}");
    }
}

fn room(epsilon: &str, mouth: &str) -> String {
    format!(
        r#"
[structure]
name = "room"
epsilon = "{epsilon}"
[[body]]
name = "walls"
vertices = [["0","0"],["10","0"],["10","10"],["0","10"],["0","{mouth}"],["1","{mouth}"],["1","9"],["9","9"],["9","1"],["1","1"],["1","5"],["0","5"]]
fixed = true
[[body]]
name = "b"
vertices = [["0","0"],["1","0"],["1","1"],["0","1"]]
position = ["4","5"]
"#
    )
}

const ROD: &str = r#"
[structure]
name = "rod"
epsilon = "1/2"
[[body]]
name = "stop"
vertices = [["-5","-2"],["5","-2"],["5","-1"],["-5","-1"]]
fixed = true
[[body]]
name = "rod"
vertices = [["0","-1/10"],["2","-1/10"],["2","1/10"],["0","1/10"]]
pin = ["0","0"]
"#;

/// A block that pins nothing, within the reach of no constraint, beside a rod that turns.
const FREE: &str = r#"
[[body]]
name = "free"
vertices = [["0","0"],["1","0"],["1","1"],["0","1"]]
position = ["20","0"]
"#;

fn read(text: &str) -> Structure {
    let file = read_structure("test.toml", text.as_bytes(), &[]);
    file.unwrap().into_structure()
}

/// A direction that collides takes nothing apart, a way out of one body does, and a rod that turns
/// about its pin stays.
#[test]
fn what_collides_does_not_come_apart() {
    let verdict = |text: &str, translations: bool| {
        let s = read(text);
        let found = separate(&s, translations, None);
        let document = SeparateDocument::new(&s, translations, &found);
        assert_eq!(document.verdict, found.verdict());
        (found.verdict(), found.rows, document.to_string())
    };
    for translations in [true, false] {
        let (word, rows, text) = verdict(&room("1/2", "51/10"), translations);
        assert_eq!((word, rows), ("undecided", 0), "{text}");
        assert!(text.contains("nothing is within epsilon"), "{text}");
        assert!(text.contains("collides farther on"), "{text}");
        let (word, rows, _) = verdict(&room("20", "51/10"), translations);
        assert_eq!((word, rows > 0), ("holds", true));
        // A mouth as wide as the block: it leaves to the left.
        assert_eq!(verdict(&room("1/2", "6"), translations).0, "comes-apart");
    }
    let (word, _, text) = verdict(ROD, false);
    assert_eq!(word, "holds", "{text}");
    assert!(text.contains("pinned bodies turn"), "{text}");
    let (word, _, text) = verdict(&format!("{ROD}{FREE}"), false);
    assert_eq!(word, "comes-apart", "{text}");
}

fn snapfit(args: &[&str]) -> (i32, String, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_snapfit"))
        .args(args)
        .output()
        .unwrap();
    let text = |b: Vec<u8>| String::from_utf8(b).unwrap();
    let code = out.status.code().unwrap_or(-1);
    (code, text(out.stdout), text(out.stderr))
}

/// The verb agrees with its verdict: exit, `--expect`, `--sequence`.
#[test]
fn the_verb_of_separation_agrees_with_itself() {
    let dir = std::env::temp_dir().join(format!("snapfit-room-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let file = |name: &str, text: &str| {
        let path = dir.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let shut = file("shut.toml", &room("1/2", "51/10"));
    for more in [&["--sequence"][..], &[], &["--expect", "comes-apart"]] {
        let (code, text, said) = snapfit(&[&["separate", &shut, "--translations"], more].concat());
        assert_eq!(code, 3, "{said}");
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["verdict"], "undecided", "{more:?}");
    }
    let open = file("open.toml", &room("1/2", "6"));
    let (code, text, _) = snapfit(&["separate", &open, "--sequence", "--expect", "comes-apart"]);
    assert_eq!(code, 0, "{text}");
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["sequence"]["removed"][0][0], "b");
    // What the library says when asked for far too much, or too little.
    for (by, says) in [
        ("1e400", "body walls: nothing is left"),
        ("1e-5000", "below 2^-20"),
    ] {
        let (code, _, said) = snapfit(&["loosen", &shut, "--by", by]);
        assert_eq!(code, 2, "{said}");
        assert!(said.contains(says), "{said}");
    }
    // Frames are files, also where --svg is given without a path.
    let (code, _, said) = snapfit(&["render", &shut, "--frames", "3", "--svg"]);
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("give --svg a path"), "{said}");
    // A drawing that begins with a byte order mark.
    let drawing = file("marked.txt", "\u{feff}##\n@#\n");
    let (code, text, said) = snapfit(&["generate", "marked", "--drawing", &drawing]);
    assert_eq!(code, 0, "{said}");
    assert_eq!(read(&text).bodies.len(), 4);
    std::fs::remove_dir_all(&dir).unwrap();
}
