//! Safe paths against dense sampling with an intersection test of polygons.
#![allow(clippy::unwrap_used)]

use snapfit::flex::apps::loosen::loosen;
use snapfit::flex::generate::generate;
use snapfit::flex::{
    Body, Ending, FlexOptions, Flexed, Hold, Path, Pose, Structure, Term, Why, flex,
};
use snapfit::geometry::{Polygon, Vec2, interiors_intersect};
use snapfit::number::Rat;

#[path = "common/blocks.rs"]
mod blocks;
mod common;
use blocks::{moves, plain, r, rectangle, v};

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

/// What every safe path must be: nothing violated, every step proven and found clear by sampling,
/// and never a step back.
fn sound(s: &Structure, safe: &Flexed, samples: i64, what: &str) {
    assert!(safe.violation.square.is_zero(), "{what}");
    let mut steps = safe.steps.iter().filter(|s| !s.scale.is_zero());
    assert!(steps.all(|s| s.proof.is_some()), "{what}");
    assert!(safe.steps.iter().all(|s| s.gain.sign() >= 0), "{what}");
    assert_eq!(overlaps(s, safe, samples), 0, "{what}");
}

/// With clearances of a third of a tab the second order takes all that a whole step promises;
/// safe paths go on all the same, to within a thousandth of where fast ones end.
#[test]
fn wide_clearances_are_crossed_too() {
    for (bodies, by) in [(12, r(2, 5)), (12, r(1, 2)), (12, r(3, 5)), (20, r(2, 5))] {
        let mut s = loosen(&generate("grid", bodies, 1).unwrap(), &by).unwrap();
        let fast = flex(&s, &FlexOptions::default());
        s.step.path = Path::Safe;
        let safe = flex(&s, &FlexOptions::default());
        let what = format!("{bodies} by {by}: {}", safe.why);
        assert_eq!(safe.ending, Ending::Converged, "{what}");
        let most = &fast.displacement * &r(999, 1000);
        assert!(safe.displacement >= most, "{what}");
        sound(&s, &safe, 4 + common::count(100) as i64 / 10, &what);
    }
}

/// Any family, any clearance, any direction: a safe path is sound, and it ends for a reason that
/// is no lack of decision.
#[test]
fn safe_paths_of_any_clearance_are_sound_and_decided() {
    let mut seed = 0x2545_F491_4F6C_DD1Du64;
    let mut draw = |n: u64| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 20) % n
    };
    let families = ["grid", "jit", "wall", "chain", "can", "ring", "tree"];
    for _ in 0..6 + common::count(1000) {
        let family = families[draw(7) as usize];
        let bodies = 8 + draw(6) as usize;
        let by = r(1 + draw(50) as i64, 100);
        let plain = generate(family, bodies, draw(1000)).unwrap();
        // A tree's walls are thin; what cannot be inset so far is no case.
        let Ok(mut s) = loosen(&plain, &by) else {
            continue;
        };
        let last = s.bodies.len() - 1;
        let (dx, dy) = (draw(5) as i64 - 2, draw(5) as i64 - 2);
        let dy = if dx == 0 && dy == 0 { 1 } else { dy };
        s.objective = vec![moves(last, dx, dy)];
        s.step.path = Path::Safe;
        s.step.most = 40;
        let safe = flex(&s, &FlexOptions::default());
        let what = format!("{family} {bodies} by {by} to ({dx}, {dy}): {}", safe.why);
        eprintln!("{what}");
        assert_ne!(safe.ending, Ending::Undecided, "{what}");
        sound(&s, &safe, 3, &what);
    }
}

/// What turns only to first order: a square peg that fits its hole exactly. The program promises a
/// turn, nothing of it can be had, and that is said.
#[test]
fn a_promise_that_cannot_be_kept_is_told() {
    let bodies = vec![
        rectangle("left", [-20, -20, 0, 30], Hold::Fixed),
        rectangle("right", [10, -20, 30, 30], Hold::Fixed),
        rectangle("below", [0, -20, 10, 0], Hold::Fixed),
        rectangle("above", [0, 10, 10, 30], Hold::Fixed),
        rectangle("peg", [0, 0, 10, 10], Hold::Free),
    ];
    let turn = Term::Body {
        body: 4,
        dx: Rat::zero(),
        dy: Rat::zero(),
        dtheta: Rat::one(),
    };
    let mut s = plain(bodies, vec![turn]);
    s.step.path = Path::Safe;
    let safe = flex(&s, &FlexOptions::default());
    assert!(safe.displacement < r(1, 1000), "{}", safe.displacement);
    match safe.ending {
        Ending::Undecided => {
            assert!(
                matches!(safe.why, Why::Unproven(p) if p > 0.0),
                "{:?}",
                safe.why
            );
            assert!(safe.why.to_string().contains("could be proven"));
        }
        other => assert_eq!(other, Ending::Converged),
    }
}
