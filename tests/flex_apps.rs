//! The applications of Lensgraf et al. 2019 (PF §IV, §VI), each with facts that could fail.
#![allow(clippy::unwrap_used)]

use snapfit::flex::apps::brace::{Change, brace, with_question};
use snapfit::flex::apps::constraints::{constraints, decimal};
use snapfit::flex::apps::layout::{BRACED, FRAME, fig1, layout};
use snapfit::flex::apps::loosen::{Measure, loosen, tolerance};
use snapfit::flex::apps::separate::{Answer, Separation, separate};
use snapfit::flex::apps::sequence::sequence;
use snapfit::flex::generate::generate;
use snapfit::flex::{
    FlexOptions, Flexed, Structure, Term, flex, read_structure, structure_to_toml,
};
use snapfit::geometry::Vec2;
use snapfit::number::Rat;
use std::process::Command;

fn example(name: &str, overrides: &[(&str, &str)]) -> Structure {
    let path = format!("{}/examples/flex/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let bytes = std::fs::read(&path).unwrap();
    match read_structure(&path, &bytes, overrides) {
        Ok(file) => file.into_structure(),
        Err(errors) => panic!("{errors:?}"),
    }
}

fn structure(text: &str) -> Structure {
    match read_structure("test.toml", text.as_bytes(), &[]) {
        Ok(file) => file.into_structure(),
        Err(errors) => panic!("{errors:?}"),
    }
}

fn term(s: &Structure, body: &str, dx: i64, dy: i64) -> Term {
    Term::Body {
        body: s.bodies.iter().position(|b| b.name == body).unwrap(),
        dx: Rat::from(dx),
        dy: Rat::from(dy),
        dtheta: Rat::zero(),
    }
}

fn first_optimum(s: &Structure) -> Rat {
    let mut s = s.clone();
    s.step.most = 1;
    let flexed = flex(&s, &FlexOptions::default());
    flexed.steps[0].objective.clone()
}

fn value(r: &Rat) -> f64 {
    r.nearest_f64().unwrap()
}

/// PF §IV: at two rational rotations that enclose π/4 the four bounds enclose ±(√2 − 1)/√2 and
/// ±(2 − √2)/√2, to thirty digits.
#[test]
fn the_arm_of_section_4_to_thirty_digits() {
    let below = example("arm", &[]);
    let above = example(
        "arm",
        &[(
            "body.arm.tan_half",
            "68480406462161287469/165326326037771920630",
        )],
    );
    // u < √2 − 1 < v: (u + 1)² < 2 < (v + 1)².
    let past = |s: &Structure| (&s.bodies[0].tan_half + &Rat::one()).square() > Rat::from(2);
    assert!(!past(&below) && past(&above));
    let bounds = |s: &Structure| -> Vec<(bool, Rat)> {
        let found = constraints(s);
        assert_eq!(found.len(), 4);
        let each = found.into_iter().map(|c| c.bound.unwrap());
        each.map(|b| (b.above, b.value)).collect()
    };
    let (at_below, at_above) = (bounds(&below), bounds(&above));
    // Bottom, right, top, left. 1 − √2/2 = (√2 − 1)/√2 and √2 − 1 = (2 − √2)/√2.
    let near = "0.292893218813452475599155637895";
    let far = "0.414213562373095048801688724209";
    let want = [(false, near), (false, far), (true, far), (true, near)];
    for (k, (from_above, digits)) in want.into_iter().enumerate() {
        let (one, two) = (&at_below[k], &at_above[k]);
        assert_eq!((one.0, two.0), (from_above, from_above));
        let sign = if from_above { "" } else { "-" };
        for bound in [&one.1, &two.1] {
            assert_eq!(decimal(bound, 30), format!("{sign}{digits}"), "wall {k}");
        }
        // Exactly on both sides of the irrational.
        let side = |b: &Rat| {
            let b = b.abs();
            if digits == near {
                ((Rat::one() - &b).square() * Rat::from(2)).cmp(&Rat::one())
            } else {
                (&b + &Rat::one()).square().cmp(&Rat::from(2))
            }
        };
        assert_eq!(side(&one.1), side(&two.1).reverse(), "wall {k}");
    }
    // The first to be met on the way up is the left wall.
    assert_eq!(first_optimum(&below), at_below[3].1);
}

/// PF Fig. 1: eight blocks. Two joints lie between the fixed block and the corner, each with a
/// clearance of 1/50, so pushing alone gains 1/25; turning must add to it.
#[test]
fn eight_blocks_flex_to_the_right() {
    let s = fig1();
    assert_eq!(s.bodies.len(), 8);
    assert_eq!(s, {
        let mut read = example("fig1", &[]);
        read.name = s.name.clone();
        read
    });
    let optimum = first_optimum(&s);
    assert!(optimum > Rat::frac(1, 25), "{}", value(&optimum));
    let flexed = flex(&s, &FlexOptions::default());
    assert!(flexed.displacement > Rat::frac(1, 25));
    assert!(flexed.violation.square <= s.step.violation.square());
}

/// PF Fig. 5: the pair that moved apart most asks for a vertical beam, and the beam helps.
#[test]
fn a_frame_asks_for_a_vertical_beam_and_is_helped_by_it() {
    let frame = with_question(&layout("frame", FRAME).unwrap());
    let (flexed, found) = brace(&frame, Change::Apart, &FlexOptions::default()).unwrap();
    let found = found.unwrap();
    let names: Vec<&str> = found
        .ends
        .iter()
        .map(|e| frame.bodies[e.0].name.as_str())
        .collect();
    assert!(
        names[0].ends_with("_0") && names[1].ends_with("_4"),
        "from the lower side to the upper: {names:?}"
    );
    let column = |name: &str| name[1..name.find('_').unwrap()].parse::<i64>().unwrap();
    assert!(
        names.iter().all(|n| (3..=7).contains(&column(n))),
        "{names:?}"
    );
    let [before, after] = found.squares.clone();
    assert!(after > before);
    assert!(flexed.displacement.sign() > 0);
    // How far the middles of the two long sides part, without and with the beam.
    let parting = |drawing: &str| {
        let mut s = layout("f", drawing).unwrap();
        s.objective = vec![term(&s, "b5_4", 0, 1), term(&s, "b5_0", 0, -1)];
        first_optimum(&s)
    };
    let (open, braced) = (parting(FRAME), parting(BRACED));
    assert!(
        &braced * &Rat::from(2) < open,
        "{} against {}",
        value(&braced),
        value(&open)
    );
}

/// No visible pair parts farther than the one that was found: against all pairs by brute force.
#[test]
fn no_visible_pair_parts_farther() {
    let s = with_question(&layout("ring", "####\n#..#\n@###").unwrap());
    let (flexed, found) = brace(&s, Change::Apart, &FlexOptions::default()).unwrap();
    let found = found.unwrap();
    let point = |poses: &[snapfit::flex::Pose], b: usize, v: usize| -> Vec2 {
        let turned = s.bodies[b].vertices[v].rotate_tan_half(&poses[b].tan_half);
        &poses[b].place + &turned
    };
    let (from, to) = (
        &flexed.configurations[0],
        flexed.configurations.last().unwrap(),
    );
    let polygons: Vec<snapfit::geometry::Polygon> = (0..s.bodies.len())
        .map(|b| {
            let n = s.bodies[b].vertices.len();
            let ring = (0..n).map(|v| point(from, b, v)).collect();
            snapfit::geometry::Polygon::new(ring, Vec::new())
        })
        .collect();
    // Samples of the open segment: enough to see every block in the way, not every graze.
    let seen = |a: &Vec2, b: &Vec2| {
        (1..60).all(|k| {
            let at = a + &(b - a).scale(&Rat::frac(k, 60));
            let inside = snapfit::geometry::Location::Inside;
            polygons.iter().all(|p| p.locate(&at) != inside)
        })
    };
    let all: Vec<(usize, usize)> = (0..s.bodies.len())
        .flat_map(|b| (0..s.bodies[b].vertices.len()).map(move |v| (b, v)))
        .collect();
    let length = |poses: &[snapfit::flex::Pose], p: (usize, usize), q: (usize, usize)| {
        value(&(&point(poses, p.0, p.1) - &point(poses, q.0, q.1)).norm2()).sqrt()
    };
    let best = value(&found.squares[1]).sqrt() - value(&found.squares[0]).sqrt();
    let mut rivals = 0;
    for (i, &p) in all.iter().enumerate() {
        for &q in &all[i + 1..] {
            if p.0 == q.0 || length(to, p, q) - length(from, p, q) <= best + 1e-12 {
                continue;
            }
            rivals += 1;
            let (a, b) = (point(from, p.0, p.1), point(from, q.0, q.1));
            assert!(
                !seen(&a, &b),
                "{p:?} and {q:?} see each other and part farther"
            );
        }
    }
    let _ = rivals;
    let [p, q] = found.ends;
    assert!(seen(&point(from, p.0, p.1), &point(from, q.0, q.1)));
}

/// PF Fig. 6: looser joints flex more, and the bracket of the largest inset holds.
#[test]
fn the_can_is_loosened_up_to_a_limit() {
    let can = generate("can", 8, 1).unwrap();
    let tight = first_optimum(&can);
    let loose = loosen(&can, &Rat::frac(1, 50)).unwrap();
    // Clearance 1/50 becomes 3/50. Pressing gains about in proportion.
    let more = first_optimum(&loose);
    assert!(
        more > &tight * &Rat::from(2),
        "{} {}",
        value(&tight),
        value(&more)
    );
    for (a, b) in can.bodies.iter().zip(&loose.bodies) {
        assert_eq!(a.vertices.len(), b.vertices.len());
    }
    // It reads back, so no two bodies overlap.
    let text = structure_to_toml(&loose);
    assert_eq!(structure(&text), loose);
    let limit = &tight * &Rat::frac(3, 2);
    let resolution = Rat::frac(1, 1000);
    let options = FlexOptions::default();
    let found = tolerance(&can, &limit, &resolution, Measure::Linear, &options).unwrap();
    let (inset, flex) = found.within.unwrap();
    let beyond = found.beyond.unwrap();
    assert!(flex <= limit && &beyond - &inset <= resolution);
    assert_eq!(first_optimum(&loosen(&can, &inset).unwrap()), flex);
    assert!(first_optimum(&loosen(&can, &beyond).unwrap()) > limit);
    // Clearance c + 2r against flex: 3/2 of the flex is about 3/2 of the clearance, r ≈ 1/200.
    assert!((0.003..0.008).contains(&value(&inset)), "{}", value(&inset));
    // A tight limit is not met by even the structure as it is.
    let half = &tight * &Rat::frac(1, 2);
    let none = tolerance(&can, &half, &resolution, Measure::Linear, &options).unwrap();
    assert!(none.within.is_none());
}

fn answers(cases: &[Separation; 3]) -> [bool; 3] {
    cases.each_ref().map(|c| match c.answer {
        Answer::Ray(_) => true,
        Answer::None => false,
        Answer::Undecided => panic!("undecided: {:?}", c.sum),
    })
}

/// A U with a block that fills it, its mouth turned by a rational rotation.
fn cup(tan_half: &str) -> Structure {
    structure(&format!(
        r#"
[structure]
name = "cup"
epsilon = "1/2"
[[body]]
name = "u"
vertices = [["0","0"], ["5","0"], ["5","4"], ["3","4"], ["3","1"], ["2","1"], ["2","4"], ["0","4"]]
tan_half = "{tan_half}"
fixed = true
[[body]]
name = "block"
vertices = [["2","1"], ["3","1"], ["3","3"], ["2","3"]]
tan_half = "{tan_half}"
"#
    ))
}

/// PF §VI-C: the sign of the sum says which of the two programs is unbounded.
#[test]
fn both_signs_and_the_case_between_them() {
    // Mouth up, left, and (by θ with tan(θ/2) = 3, past a quarter) to the lower left.
    assert_eq!(
        answers(&separate(&cup("0"), false, None).cases),
        [true, false, false]
    );
    assert_eq!(
        answers(&separate(&cup("1"), false, None).cases),
        [false, true, false]
    );
    // cos θ = −4/5, sin θ = 3/5: up becomes (−3/5, −4/5).
    let down = separate(&cup("3"), true, None).cases;
    assert_eq!(answers(&down), [false, true, false]);
    assert_eq!(down[1].clear, Some(true));
    let v = &down[1].velocities.as_ref().unwrap()[1];
    assert_eq!(&v[0] / &v[1], Rat::frac(3, 4));
    // The open case of the paper: sum zero and nothing else.
    let diagonal = example("diagonal", &[]);
    for translations in [false, true] {
        let cases = separate(&diagonal, translations, None).cases;
        assert_eq!(answers(&cases), [false, false, true]);
        let v = &cases[2].velocities.as_ref().unwrap()[1];
        assert_eq!([&v[0], &v[1]], [&Rat::one(), &Rat::from(-1)]);
        assert!(v[2].is_zero());
        assert_eq!(cases[2].clear, Some(true));
    }
}

/// What holds is proven to hold: dovetails in the plane, and a block shut in.
#[test]
fn what_interlocks_holds() {
    for (family, bodies) in [("grid", 6), ("chain", 4), ("can", 8)] {
        let s = generate(family, bodies, 1).unwrap();
        assert_eq!(
            answers(&separate(&s, false, None).cases),
            [false; 3],
            "{family}"
        );
        let order = sequence(&s, None);
        assert!(order.removed.is_empty(), "{family}");
        assert!(!order.left.is_empty());
    }
    let mut shut = cup("0");
    let lid = structure(
        r#"
[structure]
name = "lid"
epsilon = "1/2"
[[body]]
name = "lid"
vertices = [["0","4"], ["5","4"], ["5","5"], ["0","5"]]
fixed = true
"#,
    );
    shut.bodies.extend(lid.bodies);
    // The lid is one away from the block: too far for a near constraint, so the linear model
    // comes apart, and the check for all time says no.
    let cases = separate(&shut, true, None).cases;
    assert_eq!(answers(&cases), [true, false, false]);
    assert_eq!(cases[0].clear, Some(false));
    shut.epsilon = Rat::one();
    assert_eq!(answers(&separate(&shut, true, None).cases), [false; 3]);
    assert!(sequence(&shut, None).removed.is_empty());
}

/// PF Fig. 8: bodies leave from the top down, and only so.
#[test]
fn an_assembly_comes_apart_from_the_top() {
    let s = example("fig8", &[]);
    let cases = separate(&s, true, None).cases;
    assert!(answers(&cases)[0]);
    assert_eq!(cases[0].clear, Some(true));
    let order = sequence(&s, None);
    let names: Vec<&str> = order
        .removed
        .iter()
        .map(|r| s.bodies[r.0].name.as_str())
        .collect();
    assert_eq!(names, ["bridge", "left", "right", "slab"]);
    for (_, d) in &order.removed {
        assert!(d.x.is_zero() && d.y.sign() > 0);
    }
    // Holding the bridge holds all the rest.
    let mut capped = s.clone();
    capped.bodies[4].hold = snapfit::flex::Hold::Fixed;
    assert!(sequence(&capped, None).removed.is_empty());
    assert_eq!(answers(&separate(&capped, true, None).cases), [false; 3]);
}

/// The exact displacement of the flock after each step, with the rules of PF §VI-B.
#[test]
fn a_flock_keeps_its_views_and_its_limits() {
    let mut s = generate("flock", 28, 1).unwrap();
    s.step.most = 3;
    let flexed: Flexed = flex(&s, &FlexOptions::default());
    assert!(flexed.displacement.sign() > 0);
    let limit = value(s.step.rotation_limit.as_ref().unwrap());
    for pair in flexed.configurations.windows(2) {
        for (a, b) in pair[0].iter().zip(&pair[1]) {
            let turn = 2.0 * (value(&b.tan_half).atan() - value(&a.tan_half).atan());
            assert!(turn.abs() <= limit + 1e-3, "{turn}");
        }
    }
    // Every marker is seen at the end, up to the violation allowed.
    let last = flexed.configurations.last().unwrap();
    let allowed = s.step.violation.clone();
    for view in &s.views {
        let at =
            |body: usize, p: &Vec2| &last[body].place + &p.rotate_tan_half(&last[body].tan_half);
        let eye = at(view.body, &view.camera);
        let to = &at(view.of, &view.marker) - &eye;
        for (ray, sign) in [(&view.left, -1), (&view.right, 1)] {
            let ray = ray.rotate_tan_half(&last[view.body].tan_half);
            let side = ray.cross(&to) * Rat::from(sign);
            let bound = &allowed.square() * &ray.norm2();
            assert!(
                side.sign() >= 0 || side.square() <= bound,
                "a marker is out of view"
            );
        }
    }
    // Five nearest neighbours: each robot but the fixed pairs has rows; they change as it moves.
    assert!(flexed.steps.len() > 1);
    let rows: Vec<usize> = flexed.steps.iter().map(|s| s.rows).collect();
    assert!(rows[0] > 28 * 5, "{rows:?}");
}

fn snapfit(args: &[&str]) -> (i32, String, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_snapfit"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(args)
        .output()
        .unwrap();
    let text = |b: Vec<u8>| String::from_utf8(b).unwrap();
    (
        out.status.code().unwrap_or(-1),
        text(out.stdout),
        text(out.stderr),
    )
}

/// Verbs, their exits, and pictures with every body twice.
#[test]
fn the_verbs_answer() {
    let (code, text, _) = snapfit(&["flex", "examples/flex/arm.toml", "--constraints"]);
    assert_eq!(code, 0);
    assert!(text.contains("0.292893218813452475599155637895"), "{text}");
    let fig8 = "examples/flex/fig8.toml";
    let (code, text, _) = snapfit(&["separate", fig8, "--translations", "--sequence"]);
    assert_eq!(code, 0);
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["verdict"], "comes-apart");
    assert_eq!(json["sequence"]["removed"][0][0], "bridge");
    let (code, _, said) = snapfit(&["separate", fig8, "--expect", "holds"]);
    assert_eq!(code, 4, "{said}");
    let (code, svg, _) = snapfit(&["render", "examples/flex/fig1.toml", "--svg"]);
    assert_eq!(code, 0);
    assert!(svg.starts_with("<svg"));
    assert_eq!(
        svg.matches("<path").count(),
        16,
        "eight before, eight after"
    );
    let (code, _, said) = snapfit(&["loosen", fig8]);
    assert_eq!(code, 2, "{said}");
    let (code, text, _) = snapfit(&["loosen", "examples/flex/fig1.toml", "--by", "1/100"]);
    assert_eq!(code, 0);
    assert_eq!(structure(&text).bodies.len(), 8);
    let (code, _, said) = snapfit(&["loosen", "examples/flex/fig1.toml", "--by", "6"]);
    assert_eq!(code, 2);
    assert!(said.contains("body b0_0"), "{said}");
}

/// For people: a few lines that say how it ended, in words; piped, JSON as ever.
#[test]
fn results_are_told_to_people_too() {
    let people = |args: &[&str]| {
        let (code, text, said) = snapfit(&[args, &["--format", "summary"][..]].concat());
        assert_eq!(code, 0, "{said}");
        assert!(!text.contains('{'), "{text}");
        text
    };
    let text = people(&["flex", "examples/flex/fig1.toml"]);
    assert!(text.contains("8 bodies flex by"), "{text}");
    assert!(text.contains("outcome    converged"), "{text}");
    assert!(text.contains("certificate verified"), "{text}");
    let safe = people(&["flex", "examples/flex/fig1.toml", "--path", "safe"]);
    assert!(safe.contains("violation  none"), "{safe}");
    let text = people(&["separate", "examples/flex/fig8.toml", "--translations"]);
    assert!(text.contains(": comes apart by translations"), "{text}");
    let text = people(&["brace", "examples/flex/frame.toml"]);
    assert!(text.contains("  beam       vertex"), "{text}");
    let (_, piped, _) = snapfit(&["flex", "examples/flex/fig1.toml"]);
    let json: serde_json::Value = serde_json::from_str(&piped).unwrap();
    assert_eq!(json["outcome"], "converged");
}

/// A limit that the structure is past as it is drawn is said, in both formats.
#[test]
fn a_limit_already_exceeded_is_said() {
    let ask = ["loosen", "examples/flex/fig1.toml", "--limit", "1/1000000"];
    let (code, text, _) = snapfit(&ask);
    assert_eq!(code, 0);
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(json["inset"].is_null());
    let why = json["reason"].as_str().unwrap();
    assert!(why.contains("as drawn already flexes by"), "{why}");
    let (_, text, _) = snapfit(&[&ask[..], &["--format", "summary"]].concat());
    assert!(text.contains("over the limit"), "{text}");
}

/// As many pictures as were asked for, numbered, all of one frame.
#[test]
fn frames_are_files() {
    let dir = std::env::temp_dir().join(format!("snapfit-frames-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let path = dir.join("way.svg");
    let to = path.to_str().unwrap();
    let (code, _, said) = snapfit(&[
        "render",
        "examples/flex/fig1.toml",
        "--svg",
        to,
        "--frames",
        "3",
    ]);
    assert_eq!(code, 0, "{said}");
    let frames: Vec<String> = (0..3)
        .map(|k| std::fs::read_to_string(dir.join(format!("way-{k}.svg"))).unwrap())
        .collect();
    let size = |s: &str| s[..s.find('>').unwrap()].to_owned();
    assert_eq!(size(&frames[0]), size(&frames[2]));
    assert_ne!(frames[0], frames[1]);
    assert_ne!(frames[1], frames[2]);
    std::fs::remove_dir_all(&dir).unwrap();
}

/// Two triangles far apart, one edge of the first against one vertex of the second.
fn two_triangles(draw: &mut dyn FnMut() -> i64) -> Structure {
    let mut triangle = |name: &str, far: i64| {
        // Counter-clockwise by construction: corners in three sectors about the origin.
        let (a, b, c) = (draw(), draw(), draw());
        let (x, y, u) = (draw() - 50, draw() - 50, draw() - 50);
        format!(
            r#"
[[body]]
name = "{name}"
vertices = [["{a}","-{b}"], ["{c}","{a}"], ["-{b}","{c}"]]
position = ["{}","{y}/7"]
tan_half = "{u}/37"
"#,
            far + x
        )
    };
    let (one, two) = (triangle("one", 0), triangle("two", 1000));
    let contact = format!("[[{}, {}]]", draw() % 3, draw() % 3);
    structure(&format!(
        "[structure]\nname = \"t\"\nepsilon = \"1\"\n{one}{two}\n[[joint]]\nbodies = [[\"one\", \"two\"]]\nfirst = {contact}\n"
    ))
}

/// The gradient of every kind of coordinate against central differences of the exact distance,
/// and PF eq. 16 as printed against both: it has every sign the other way (erratum 1).
#[test]
fn gradients_agree_with_differences_and_eq_16_does_not() {
    let mut seed = 2019u64;
    let mut draw = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        1 + (seed >> 33) as i64 % 97
    };
    for _ in 0..40 {
        let s = two_triangles(&mut draw);
        let row = constraints(&s).remove(0);
        let length = value(&row.normal_square).sqrt();
        let distance = |s: &Structure| {
            let row = constraints(s).remove(0);
            value(&row.d0) / value(&row.normal_square).sqrt()
        };
        for (body, coordinate, rate) in &row.gradient {
            let step = Rat::frac(1, 1 << 14);
            let moved = |by: &Rat| {
                let mut s = s.clone();
                let b = &mut s.bodies[*body];
                match *coordinate {
                    "x" => b.position.x = &b.position.x + by,
                    "y" => b.position.y = &b.position.y + by,
                    _ => {
                        // tan of half the sum of angles; `by` is tan of half the turn.
                        let u = b.tan_half.clone();
                        b.tan_half = (&u + by) / (Rat::one() - &u * by);
                    }
                }
                distance(&s)
            };
            let change = moved(&step) - moved(&-&step);
            let width = match *coordinate {
                "theta" => 4.0 * value(&step).atan(),
                _ => 2.0 * value(&step),
            };
            let (slope, exact) = (change / width, value(rate) / length);
            assert!(
                (slope - exact).abs() <= 1e-5 * (1.0 + exact.abs()),
                "{coordinate} of body {body}: {slope} against {exact}"
            );
        }
        // Eq. 16's first lines: ∂x₁ = a (r₁ sin − r₀ sin) = (y₁ − y₀)/ℓ of the edge in the plane,
        // which for a counter-clockwise polygon is the outward normal itself, where −n is due.
        let of = |want: usize, name: &str| {
            let found = row.gradient.iter().find(|g| g.0 == want && g.1 == name);
            found.map_or(0.0, |g| value(&g.2) / length)
        };
        let snapfit::flex::Plane::Edge(k) = row.pair.plane else {
            panic!("an edge was named");
        };
        let one = &s.bodies[0];
        let end = |k: usize| one.vertices[k % 3].rotate_tan_half(&one.tan_half);
        let (e0, e1) = (end(k as usize), end(k as usize + 1));
        let edge = &e1 - &e0;
        let l = value(&edge.norm2()).sqrt();
        let printed = [value(&edge.y) / l, -value(&edge.x) / l];
        for (name, printed) in [("x", printed[0]), ("y", printed[1])] {
            assert!((of(0, name) + printed).abs() < 1e-9);
            assert!((of(1, name) - printed).abs() < 1e-9);
        }
    }
}
