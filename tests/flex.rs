//! PuzzleFlex: programs against published optima, invariance, safe paths against sampling, and
//! what a file may not say.
#![allow(clippy::unwrap_used)]

use snapfit::flex::generate::{FAMILIES, generate};
use snapfit::flex::{
    Body, Corners, Ending, FlexOptions, Flexed, Hold, Path, Pose, StepRules, Structure, Term, flex,
    outer_bound, read_structure, structure_schema, structure_to_toml,
};
use snapfit::geometry::{Polygon, Vec2, interiors_intersect};
use snapfit::number::Rat;
use snapfit::scene::STRUCTURE_CODES;
use std::collections::BTreeSet;

mod common;

fn r(n: i64, d: i64) -> Rat {
    Rat::frac(n, d)
}

fn v(x: Rat, y: Rat) -> Vec2 {
    Vec2::new(x, y)
}

fn first_optimum(structure: &Structure) -> Rat {
    let mut s = structure.clone();
    s.step.most = 1;
    s.step.path = Path::Fast;
    let flexed = flex(
        &s,
        &FlexOptions {
            verify: true,
            ..FlexOptions::default()
        },
    );
    assert_eq!(flexed.steps[0].verified, Some(true));
    flexed.steps[0].objective.clone()
}

/// The published programs are those of these structures, rational for rational. The larger ones
/// run with TEST_MULT=1.
#[test]
fn optima_are_those_published() {
    let folder = std::path::Path::new("../shared/data/lp/puzzleflex");
    if !folder.is_dir() {
        eprintln!("skipped: the published optima are not here");
        return;
    }
    let cases = [
        ("grid", 36),
        ("jit", 36),
        ("jrot", 36),
        ("grid", 90),
        ("jit", 90),
        ("jrot", 90),
        ("grid", 392),
    ];
    let most = if common::count(100) >= 100 {
        cases.len()
    } else {
        4
    };
    for (family, bodies) in &cases[..most] {
        let wanted = std::fs::read_to_string(folder.join(format!("pf_{family}{bodies}_y.exact")));
        let structure = generate(family, *bodies, 1).unwrap();
        assert_eq!(
            first_optimum(&structure).to_string(),
            wanted.unwrap().trim(),
            "{family} {bodies}"
        );
    }
}

/// The structure turned by tan(θ/2) = u about the origin and shifted, the objective with it.
fn carried(s: &Structure, u: &Rat, by: &Vec2) -> Structure {
    let mut out = s.clone();
    for b in &mut out.bodies {
        b.position = &b.position.rotate_tan_half(u) + by;
        b.tan_half = (&b.tan_half + u) / (Rat::one() - &b.tan_half * u);
    }
    for t in &mut out.objective {
        if let Term::Body { dx, dy, .. } | Term::Vertex { dx, dy, .. } = t {
            let d = v(dx.clone(), dy.clone()).rotate_tan_half(u);
            (*dx, *dy) = (d.x, d.y);
        }
    }
    out
}

#[test]
fn optima_do_not_depend_on_where_a_structure_stands() {
    for (family, bodies) in [("wall", 9), ("can", 12), ("ring", 7), ("jit", 6)] {
        let s = generate(family, bodies, 3).unwrap();
        let wanted = first_optimum(&s);
        assert!(wanted.sign() > 0, "{family}");
        let moved = carried(&s, &r(2, 7), &v(r(-31, 3), r(5, 1)));
        assert_eq!(first_optimum(&moved), wanted, "{family}");
    }
}

#[test]
fn optima_do_not_depend_on_names_and_order() {
    for (family, bodies) in [("wall", 9), ("can", 12), ("chain", 5)] {
        let s = generate(family, bodies, 1).unwrap();
        let wanted = first_optimum(&s);
        let mut other = s.clone();
        other.bodies.reverse();
        for (k, b) in other.bodies.iter_mut().enumerate() {
            // Another first vertex, and every second body listed clockwise.
            let n = b.vertices.len();
            b.vertices.rotate_left((3 * k) % n);
            if k % 2 == 0 {
                b.vertices.reverse();
            }
        }
        for t in &mut other.objective {
            if let Term::Body { body, .. } = t {
                *body = s.bodies.len() - 1 - *body;
            }
        }
        assert_eq!(first_optimum(&other), wanted, "{family}");
    }
}

fn rectangle(name: &str, [x0, y0, x1, y1]: [i64; 4], hold: Hold) -> Body {
    let at = |x, y| v(r(x, 10), r(y, 10));
    Body {
        name: name.to_owned(),
        vertices: vec![at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)],
        position: Vec2::default(),
        tan_half: Rat::zero(),
        hold,
    }
}

fn plain(bodies: Vec<Body>, objective: Vec<Term>) -> Structure {
    let epsilon = r(3, 5);
    Structure {
        name: "by hand".to_owned(),
        step: StepRules::for_epsilon(&epsilon),
        epsilon,
        bodies,
        joints: None,
        nearest: None,
        views: Vec::new(),
        objective,
    }
}

fn moves(body: usize, dx: i64, dy: i64) -> Term {
    Term::Body {
        body,
        dx: Rat::from(dx),
        dy: Rat::from(dy),
        dtheta: Rat::zero(),
    }
}

/// A unit square between a floor and a ceiling 1/10 above it rises by 1/10, whatever it weighs
/// sideways; between walls it turns no farther than its diagonal allows.
#[test]
fn a_block_under_a_ceiling() {
    let bodies = || {
        vec![
            rectangle("floor", [-40, -10, 40, 0], Hold::Fixed),
            rectangle("ceiling", [-40, 11, 40, 20], Hold::Fixed),
            rectangle("block", [0, 0, 10, 10], Hold::Free),
        ]
    };
    let s = plain(bodies(), vec![moves(2, 0, 1)]);
    let flexed = flex(&s, &FlexOptions::default());
    assert_eq!(flexed.ending, Ending::Converged);
    assert_eq!(flexed.steps[0].objective, r(1, 10));
    let off = (&flexed.displacement - &r(1, 10)).abs();
    assert!(off < r(1, 500_000), "{off}");
    // Sideways nothing holds it.
    let s = plain(bodies(), vec![moves(2, 1, 0)]);
    assert_eq!(flex(&s, &FlexOptions::default()).ending, Ending::Unbounded);
    // It turns about any corner: lifting the other end by 1/10 over a length of 1, to first order.
    let turn = Term::Body {
        body: 2,
        dx: Rat::zero(),
        dy: Rat::zero(),
        dtheta: Rat::one(),
    };
    let s = plain(bodies(), vec![turn]);
    let flexed = flex(&s, &FlexOptions::default());
    assert_eq!(flexed.steps[0].objective, r(1, 10));
}

fn polygon(body: &Body, pose: &Pose) -> Polygon {
    let at = pose.position(body);
    let turned = |p: &Vec2| &at + &p.rotate_tan_half(&pose.tan_half);
    Polygon::new(body.vertices.iter().map(turned).collect(), Vec::new())
}

/// Where a body is at a part `s` of a step: its reference point goes straight, tan of half its
/// turn grows in proportion.
fn between(body: &Body, a: &Pose, b: &Pose, s: &Rat) -> Polygon {
    let w = (&b.tan_half - &a.tan_half) / (Rat::one() + &a.tan_half * &b.tan_half) * s;
    let place = &a.place + &(&b.place - &a.place).scale(s);
    let pose = Pose {
        place,
        tan_half: (&a.tan_half + &w) / (Rat::one() - &a.tan_half * &w),
    };
    polygon(body, &pose)
}

/// Overlaps of any two bodies at `samples` instants of every step.
fn overlaps(s: &Structure, flexed: &Flexed, samples: i64) -> usize {
    let mut found = 0;
    for step in flexed.configurations.windows(2) {
        for k in 0..=samples {
            let at = r(k, samples);
            let placed: Vec<Polygon> = (0..s.bodies.len())
                .map(|b| between(&s.bodies[b], &step[0][b], &step[1][b], &at))
                .collect();
            for a in 0..placed.len() {
                for b in a + 1..placed.len() {
                    found += usize::from(interiors_intersect(&placed[a], &placed[b]));
                }
            }
        }
    }
    found
}

#[test]
fn safe_paths_never_collide_and_lose_little() {
    let families = [
        ("jit", 6),
        ("wall", 7),
        ("chain", 4),
        ("can", 10),
        ("ring", 8),
    ];
    for (family, bodies) in families {
        let mut s = generate(family, bodies, 2).unwrap();
        let fast = flex(&s, &FlexOptions::default());
        s.step.path = Path::Safe;
        let safe = flex(&s, &FlexOptions::default());
        assert_eq!(safe.ending, Ending::Converged, "{family}");
        assert!(safe.steps.iter().all(|s| s.proof.is_some()), "{family}");
        assert!(safe.violation.square.is_zero(), "{family}");
        let most = &fast.displacement * &r(9, 10);
        assert!(
            safe.displacement >= most,
            "{family}: {} {}",
            safe.displacement,
            fast.displacement
        );
        let samples = 4 + common::count(1000) as i64 / 10;
        assert_eq!(overlaps(&s, &safe, samples), 0, "{family}");
    }
}

/// A block in a gap goes to the wall, wherever it starts and however round or odd the numbers are:
/// rows of small integers (a distance of 1, say) must not lose their room to rounding.
#[test]
fn safe_blocks_reach_the_wall() {
    let mut seed = 5i64;
    let mut draw = |n: i64| {
        seed = (seed * 1_103_515_245 + 12_345) & 0x7fff_ffff;
        seed / 65_536 % n
    };
    let mut cases = vec![
        (r(11, 5), r(11, 10)),
        (r(9, 4), r(9, 8)),
        (r(5, 2), r(5, 4)),
    ];
    for _ in 0..20 + common::count(100) {
        let gap = r(2, 1) + r(1 + draw(60), 60 + draw(60));
        let room = &gap - &r(2, 1);
        let start = r(1, 1) + &room * &r(draw(7), 7);
        cases.push((gap, start));
    }
    for (gap, start) in cases {
        let wall = |name: &str, x0: Rat, x1: Rat| Body {
            name: name.to_owned(),
            vertices: vec![
                v(x0.clone(), Rat::zero()),
                v(x1.clone(), Rat::zero()),
                v(x1, r(4, 1)),
                v(x0, r(4, 1)),
            ],
            position: Vec2::default(),
            tan_half: Rat::zero(),
            hold: Hold::Fixed,
        };
        let mut block = rectangle("block", [-10, -10, 10, 10], Hold::Free);
        block.position = v(start.clone(), r(2, 1));
        let right = &gap + &r(3, 1);
        let bodies = vec![
            wall("left", r(-3, 1), Rat::zero()),
            wall("right", gap.clone(), right),
            block,
        ];
        let mut s = plain(bodies, vec![moves(2, 1, 0)]);
        s.epsilon = r(6, 1);
        s.step.path = Path::Safe;
        let room = &gap - &r(1, 1) - &start;
        let flexed = flex(&s, &FlexOptions::default());
        assert_eq!(flexed.ending, Ending::Converged, "{gap} {start}");
        assert!(flexed.displacement <= room, "{gap} {start}");
        let lost = &room - &flexed.displacement;
        assert!(lost < r(1, 100_000), "{gap} {start}: {lost} of {room}");
    }
}

/// The whole run, too, does not depend on where a structure stands: only roundings differ.
#[test]
fn runs_do_not_depend_on_where_a_structure_stands() {
    for (family, bodies) in [("wall", 9), ("jit", 6), ("grid", 12)] {
        let s = generate(family, bodies, 3).unwrap();
        let wanted = flex(&s, &FlexOptions::default());
        let moved = carried(&s, &r(2, 7), &v(r(-31, 3), r(5, 1)));
        let found = flex(&moved, &FlexOptions::default());
        assert_eq!(wanted.ending, Ending::Converged, "{family}");
        assert_eq!(found.ending, Ending::Converged, "{family}");
        let off = (&wanted.displacement - &found.displacement).abs();
        assert!(
            off <= &wanted.displacement * &r(1, 10_000),
            "{family}: {} {}",
            wanted.displacement,
            found.displacement
        );
    }
}

/// Up to the first contact no bodies overlap; just after it the two that it names do.
#[test]
fn the_first_contact_is_where_overlap_begins() {
    let options = FlexOptions {
        contact: true,
        ..FlexOptions::default()
    };
    let mut met = 0;
    for (family, bodies) in [("jit", 6), ("wall", 7), ("chain", 4), ("can", 10)] {
        let s = generate(family, bodies, 2).unwrap();
        let flexed = flex(&s, &options);
        let found: Vec<usize> = (0..flexed.steps.len())
            .filter(|k| flexed.steps[*k].contact.is_some())
            .collect();
        assert!(found.len() < 2, "{family}: only the first is asked for");
        let Some(&k) = found.first() else { continue };
        met += 1;
        let contact = flexed.steps[k].contact.as_ref().unwrap();
        let time = contact.time.enclosure(40).0;
        let step = &flexed.configurations[k..k + 2];
        let at =
            |s: &Structure, b: usize, t: &Rat| between(&s.bodies[b], &step[0][b], &step[1][b], t);
        let little = r(1, 1_000_000);
        let (one, two) = (contact.edge.0, contact.vertex.0);
        let after = &time + &little;
        assert!(
            interiors_intersect(&at(&s, one, &after), &at(&s, two, &after)),
            "{family}"
        );
        for n in 1..8 {
            let before = (&time - &little) * r(n, 7);
            for a in 0..s.bodies.len() {
                for b in a + 1..s.bodies.len() {
                    assert!(
                        !interiors_intersect(&at(&s, a, &before), &at(&s, b, &before)),
                        "{family}: {a} and {b} before the first contact"
                    );
                }
            }
        }
    }
    assert!(met > 1, "contacts are what this is about: {met}");
}

/// No safe path may pass the outer bound, and for tight joints the two are near each other. The
/// block under a ceiling has its bound by hand: a joint on every side, 1/10 of room.
#[test]
fn outer_bounds_hold_what_safe_paths_reach() {
    for (family, bodies) in [("grid", 6), ("jit", 6), ("jrot", 4), ("chain", 4)] {
        let mut s = generate(family, bodies, 2).unwrap();
        s.step.path = Path::Safe;
        let inner = flex(&s, &FlexOptions::default()).displacement;
        let outer = outer_bound(&s, None).unwrap();
        assert!(outer.verified, "{family}");
        assert!(outer.value >= inner, "{family}: {} < {inner}", outer.value);
        assert!(
            outer.value <= &inner * &r(5, 4),
            "{family}: {} {inner}",
            outer.value
        );
    }
    let bodies = vec![
        rectangle("floor", [-40, -10, 40, 0], Hold::Fixed),
        rectangle("block", [0, 0, 10, 10], Hold::Free),
    ];
    let s = plain(bodies, vec![moves(1, 1, 0)]);
    assert!(outer_bound(&s, None).is_err(), "nothing holds it");
}

/// What the bound is a bound of: safe paths that were led elsewhere on the way (other weights, then
/// the one asked) reach nothing beyond it.
#[test]
fn no_feasible_flex_is_beyond_the_outer_bound() {
    let mut seed = 7i64;
    let mut draw = move || {
        seed = (seed * 1_103_515_245 + 12_345) & 0x7fff_ffff;
        seed / 65_536 % 7 - 3
    };
    for (family, bodies) in [("grid", 4), ("jit", 4), ("jrot", 4), ("chain", 3)] {
        let mut s = generate(family, bodies, 5).unwrap();
        s.step.path = Path::Safe;
        s.step.gain = r(1, 10_000);
        let asked = s.objective.clone();
        let outer = outer_bound(&s, None).unwrap().value;
        let weight = |flexed: &[Pose]| -> Rat {
            let mut sum = Rat::zero();
            for t in &asked {
                let Term::Body { body, dx, dy, .. } = t else {
                    panic!("{family}: its objective moves bodies")
                };
                let (at, from) = (&flexed[*body], Pose::of(&s.bodies[*body]));
                let moved = &at.place - &from.place;
                sum = sum + dx * &moved.x + dy * &moved.y;
            }
            sum
        };
        let mut best = Rat::zero();
        for _ in 0..2 + common::count(100) / 10 {
            let mut other = s.clone();
            let last = other.bodies.len() - 1;
            other.objective = vec![moves(last, draw(), draw()), moves(last / 2, draw(), 1)];
            let away = flex(&other, &FlexOptions::default());
            let there = away.configurations.last().unwrap();
            for poses in &away.configurations {
                let reached = weight(poses);
                assert!(reached <= outer, "{family}: {reached} > {outer}");
                best = best.max(reached);
            }
            // And from there as far as it goes in the direction asked.
            let mut on = s.clone();
            for (b, pose) in on.bodies.iter_mut().zip(there) {
                b.position = pose.position(b);
                b.tan_half = pose.tan_half.clone();
            }
            for poses in &flex(&on, &FlexOptions::default()).configurations {
                let reached = weight(poses);
                assert!(reached <= outer, "{family}: {reached} > {outer}");
                best = best.max(reached);
            }
        }
        assert!(best >= &outer * &r(3, 4), "{family}: {best} of {outer}");
    }
}

/// Two squares corner to corner: an averaged half-plane forbids what one of the edges allows, and
/// branching finds the best of all choices.
#[test]
fn branching_finds_the_best_side() {
    let bodies = vec![
        rectangle("still", [-20, -20, 0, 0], Hold::Fixed),
        rectangle("right", [60, -60, 80, 60], Hold::Fixed),
        rectangle("free", [1, 1, 21, 21], Hold::Free),
    ];
    let mut s = plain(bodies, vec![moves(2, -1, -3)]);
    s.epsilon = Rat::from(1);
    s.step = StepRules {
        rotation_limit: Some(r(1, 1000)),
        most: 1,
        ..StepRules::for_epsilon(&r(3, 5))
    };
    let average = flex(&s, &FlexOptions::default());
    let branch = flex(
        &s,
        &FlexOptions {
            corners: Corners::Branch,
            ..FlexOptions::default()
        },
    );
    assert_eq!(average.steps[0].facing, 1);
    // Past one of its edges alone the square may go on without end: to the left or downwards.
    assert_eq!(branch.ending, Ending::Unbounded);
    assert_eq!(average.ending, Ending::Unbounded);
    // With a weight that the averaged line bounds: −x − y.
    s.objective = vec![moves(2, -1, -1)];
    let average = flex(&s, &FlexOptions::default());
    assert!(average.steps[0].objective >= r(2, 10) && average.steps[0].objective < r(21, 100));
}

/// A chain long enough to curl past where it is farthest: its best lies within the joints' ranges,
/// where no vertex is, and is reached all the same.
#[test]
fn a_chain_curls_to_its_best_in_few_steps() {
    let s = generate("chain", 223, 1).expect("a structure");
    let flexed = flex(&s, &FlexOptions::default());
    assert_eq!(flexed.ending, Ending::Converged);
    assert!(flexed.steps.len() <= 30, "{}", flexed.steps.len());
    assert!(flexed.displacement > r(157_203, 100));
    assert!(flexed.violation.square <= s.step.violation.square());
}

/// Digits stay bounded however many steps are taken.
#[test]
fn digits_do_not_pile_up() {
    let mut s = generate("chain", 6, 1).unwrap();
    // Short steps: a small violation allowed, and no end by gain.
    s.step.violation = r(1, 100_000);
    s.step.gain = r(1, 1_000_000_000);
    s.step.most = 20;
    s.step.rotation_limit = Some(r(1, 500));
    let flexed = flex(&s, &FlexOptions::default());
    assert!(flexed.steps.len() >= 5, "{}", flexed.steps.len());
    let bits: Vec<u64> = flexed.steps.iter().map(|s| s.bits).collect();
    assert!(bits.iter().all(|b| *b <= 64), "{bits:?}");
}

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
