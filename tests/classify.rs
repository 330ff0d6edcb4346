//! Verdicts: the handbook's hooks, the paper's figures, critical friction against simulation, the
//! cover of the circle against exact single directions, and what a verdict may not depend on.
#![allow(clippy::unwrap_used)]

mod common;

use common::count;
use snapfit::analysis::classify::{Ask, Relative, Verdict, direction, relative};
use snapfit::analysis::document::classify_with_way;
use snapfit::analysis::escape::{Ground, Start, with_motion};
use snapfit::analysis::total::{Arc, total};
use snapfit::geometry::Vec2;
use snapfit::motion::{OutcomeKind, simulate};
use snapfit::number::{Poly, Rat};
use snapfit::scene::{Scene, read_scene};

fn scene(name: &str) -> Scene {
    let path = format!("{}/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap();
    match read_scene(name, &text) {
        Ok(file) => file.scene().clone(),
        Err(e) => panic!("{e:?}"),
    }
}

fn ask() -> Ask {
    Ask {
        critical: true,
        ..Ask::default()
    }
}

fn decided(scene: &Scene) -> Relative {
    relative(scene, &ask()).unwrap()
}

const FAMILIES: [(&str, Verdict); 14] = [
    ("examples/rabbit-clip.toml", Verdict::Force),
    ("tests/data/rabbit-small.toml", Verdict::Force),
    ("tests/data/rabbit-firm.toml", Verdict::Force),
    ("tests/data/rabbit-narrow.toml", Verdict::Force),
    ("tests/data/rabbit-large.toml", Verdict::Force),
    ("examples/rabbit-clip-lock.toml", Verdict::Kinematic),
    ("examples/handbook-vertex.toml", Verdict::Friction),
    ("examples/handbook-edge.toml", Verdict::None),
    ("examples/bayer-hook.toml", Verdict::None),
    ("tests/data/total-fig5.toml", Verdict::Kinematic),
    ("tests/data/total-fig7b.toml", Verdict::Kinematic),
    ("tests/data/total-fig7d.toml", Verdict::Friction),
    ("tests/data/total-fig7e.toml", Verdict::Force),
    ("tests/data/two-pawls.toml", Verdict::Friction),
];

#[test]
fn families_have_their_class() {
    for (name, class) in FAMILIES {
        assert_eq!(decided(&scene(name)).class, Some(class), "{name}");
    }
}

/// Two hooks with the same handbook numbers in different classes; the one that sticks does so
/// where tan(α′ + |θ|) = 1/μ: tan|θ| = (5/3 − 3/2)/(1 + 5/2) = 1/21, at 2.73°.
#[test]
fn the_handbook_pair_parts() {
    let vertex = decided(&scene("examples/handbook-vertex.toml"));
    let run = &vertex.directions[0].run;
    assert_eq!(run.outcome.kind, OutcomeKind::Stuck);
    let angle = &run.pawls[0].events.last().unwrap().angle;
    // tan θ = 2x/(1 − x²) = −1/21, so x² − 42x − 1 = 0.
    assert_eq!(angle.half_turn, 0);
    assert_eq!(angle.x.sign_of(&Poly::from_i64(&[-1, -42, 1])), 0);
    assert!(angle.x.sign() < 0);
    // The other one locks from μ·tan α′ = 1 on: the handbook's asymptote, at θ = 0, exactly.
    let edge = decided(&scene("examples/handbook-edge.toml"));
    assert_eq!(edge.critical.unwrap().to_rat(), Some(Rat::frac(2, 3)));
}

/// At μ* ± 2⁻¹⁰⁰ the motion sticks above and slides below.
#[test]
fn critical_friction_is_critical() {
    let eps = Rat::from(2).pow(100).recip();
    let mut checked = 0;
    for (name, class) in FAMILIES {
        if class == Verdict::Kinematic {
            continue;
        }
        let mut s = scene(name);
        s.friction = None;
        let free = decided(&s);
        let Some(critical) = free.critical else {
            // Nothing is met on the way out.
            continue;
        };
        checked += 1;
        let (lo, hi) = critical.enclosure(120);
        for (mu, locks) in [(&lo - &eps, false), (&hi + &eps, true)] {
            s.friction = Some(mu);
            let r = decided(&s);
            if r.start.is_none() {
                // The plan itself sticks there.
                assert!(
                    free.critical_forward
                        .as_ref()
                        .is_some_and(|f| *f < critical),
                    "{name}"
                );
                continue;
            }
            assert_eq!(r.class == Some(Verdict::Friction), locks, "{name}");
        }
        if let Some(forward) = free.critical_forward {
            let (lo, hi) = forward.enclosure(120);
            for (mu, sticks) in [(&lo - &eps, false), (&hi + &eps, true)] {
                s.friction = Some(mu);
                let run = simulate(&s, &Default::default()).unwrap();
                assert_eq!(
                    run.outcome.kind == OutcomeKind::Stuck,
                    sticks,
                    "{name} forward"
                );
            }
        }
    }
    assert!(checked >= 5);
}

/// Kinematic and friction verdicts do not depend on stiffness, kinematic ones not on μ either;
/// what sticks at μ sticks at every larger one.
#[test]
fn verdicts_depend_on_no_more_than_they_need() {
    for (name, class) in FAMILIES {
        let base = scene(name);
        if class >= Verdict::Friction {
            for k in [Rat::frac(1, 1000), Rat::from(77)] {
                let mut s = base.clone();
                s.pawls
                    .iter_mut()
                    .for_each(|p| p.stiffness = Some(k.clone()));
                assert_eq!(decided(&s).class, Some(class), "{name}");
            }
        }
        let mut before = Verdict::None;
        for mu in [
            Rat::zero(),
            Rat::frac(1, 10),
            Rat::frac(1, 3),
            Rat::frac(1, 2),
            Rat::frac(3, 5),
        ] {
            let mut s = base.clone();
            s.friction = Some(mu);
            let Some(now) = decided(&s).class else {
                break;
            };
            if class == Verdict::Kinematic {
                assert_eq!(now, class, "{name}");
            } else {
                assert!(now.max(Verdict::Force) >= before, "{name}");
                before = now;
            }
        }
    }
}

/// Every direction of the circle, and random exact directions against the cover.
#[test]
fn the_cover_holds_for_single_directions() {
    let scenes = [
        ("tests/data/total-fig5.toml", Verdict::Kinematic),
        ("tests/data/total-fig7b.toml", Verdict::Kinematic),
        ("tests/data/total-fig7d.toml", Verdict::Friction),
        ("tests/data/total-fig7e.toml", Verdict::Force),
    ];
    for (name, class) in scenes {
        let s = scene(name);
        let ground = Ground::new(&s, None);
        let plan = simulate(&s, &Default::default()).unwrap();
        let start = Start::after(&plan).unwrap();
        let whole = total(&ground, &start, &[]);
        assert_eq!(whole.class, Some(class), "{name}");
        assert_eq!(whole.undecided_width, 0.0, "{name}");
        let length: f64 = whole.cover.iter().map(Arc::width).sum();
        assert!(length >= 2.0 * std::f64::consts::PI, "{name}");
        for pair in whole.cover.windows(2) {
            assert_eq!(pair[0].ends()[1], pair[1].ends()[0], "{name}");
        }
        for (arc, w) in drawn(&whole.cover, count(10_000)) {
            let d = direction(&ground, &start, &w, &whole.distance.square(), false);
            let proven = arc.verdict.unwrap();
            let blocked = d.verdict >= proven || d.run.outcome.kind == OutcomeKind::Bifurcated;
            assert!(blocked, "{name}: {w:?} {:?} < {proven:?}", d.verdict);
        }
    }
}

/// Directions drawn from a cover: an arc, and a direction of it, its ends included.
fn drawn(cover: &[Arc], n: usize) -> impl Iterator<Item = (&Arc, Vec2)> {
    let mut seed = 0x9E37_79B9_7F4A_7C15u64;
    (0..n).map(move |_| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        let arc = &cover[(seed >> 20) as usize % cover.len()];
        let part = Rat::frac((seed & 0xFFFF) as i64, 0xFFFF);
        let at = &arc.from + &(&(&arc.to - &arc.from) * &part);
        (arc, Arc::unit(arc.quarter, &at))
    })
}

/// An arc that is said to be open is so in every direction, ends included: each runs its length,
/// none blocks, none is left open. With friction and without, with a root and forces; a good part of
/// the directions that get out is proven.
#[test]
fn open_arcs_get_out_in_every_direction() {
    let cases = [
        ("examples/bayer-hook.toml", "3/5", 0.6),
        ("examples/bayer-hook.toml", "1/10", 0.5),
        ("examples/handbook-edge.toml", "1/5", 0.6),
        ("examples/handbook-vertex.toml", "1/5", 0.7),
        ("tests/data/peg.toml", "0", 0.8),
    ];
    for (name, mu, least) in cases {
        let mut s = scene(name);
        s.friction = mu.parse().ok();
        let ground = Ground::new(&s, None);
        let plan = simulate(&s, &Default::default()).unwrap();
        let Some(start) = Start::after(&plan) else {
            panic!("{name}: {:?}", plan.outcome.kind)
        };
        let whole = total(&ground, &start, &[]);
        let width = |f: &dyn Fn(&Arc) -> bool| -> f64 {
            let arcs = whole.cover.iter().filter(|a| f(a));
            arcs.map(Arc::width).sum()
        };
        let none = width(&|a| a.verdict == Some(Verdict::None));
        let open = width(&|a| a.open);
        eprintln!("{name} {mu}: {open} of {none} rad");
        assert!(open >= least * none, "{name} {mu}: {open} of {none} rad");
        assert!(
            whole
                .cover
                .iter()
                .all(|a| !a.open || a.verdict == Some(Verdict::None))
        );
        let arcs: Vec<Arc> = whole.cover.iter().filter(|a| a.open).cloned().collect();
        assert!(none == 0.0 || !arcs.is_empty(), "{name}");
        if arcs.is_empty() {
            continue;
        }
        for (arc, w) in drawn(&arcs, 40 + count(10_000)) {
            let d = direction(&ground, &start, &w, &whole.distance.square(), false);
            assert_eq!(d.verdict, Verdict::None, "{name} {mu}: {w:?} of {arc:?}");
            assert_eq!(
                d.run.outcome.kind,
                OutcomeKind::Completed,
                "{name} {mu}: {w:?}"
            );
        }
    }
}

/// One way out settles the class; the circle is covered all the same. Where the verdict turns, the
/// arcs do, and each flip is as narrow as promised.
#[test]
fn a_way_out_is_named_and_the_rest_is_told() {
    let mut s = scene("tests/data/total-fig7d.toml");
    s.obstacles.truncate(1);
    let ground = Ground::new(&s, None);
    let plan = simulate(&s, &Default::default()).unwrap();
    let start = Start::after(&plan).unwrap();
    let whole = total(&ground, &start, &[]);
    assert_eq!(whole.class, Some(Verdict::None));
    assert_eq!(whole.undecided_width, 0.0);
    assert!(whole.escape.is_some());
    let length: f64 = whole.cover.iter().map(Arc::width).sum();
    assert!(length >= 2.0 * std::f64::consts::PI);
    for (i, arc) in whole.cover.iter().enumerate() {
        let next = &whole.cover[(i + 1) % whole.cover.len()];
        assert_eq!(arc.ends()[1], next.ends()[0]);
    }
    let narrow = Rat::from(2).pow(60).recip();
    assert!(whole.flips.len() >= 2);
    for f in &whole.flips {
        let [a, b] = &f.sides;
        assert!(a.verdict != b.verdict && &b.s - &a.s <= narrow);
    }
    let width = |v: Option<Verdict>| -> f64 {
        let arcs = whole.cover.iter().filter(|a| a.verdict == v);
        arcs.map(Arc::width).sum()
    };
    let held: f64 = [Verdict::Force, Verdict::Friction, Verdict::Kinematic]
        .map(|v| width(Some(v)))
        .iter()
        .sum();
    assert!(held > 1.0 && width(Some(Verdict::None)) > 0.5 && width(None) < 0.1);
    for (arc, w) in drawn(&whole.cover, count(10_000)) {
        let d = direction(&ground, &start, &w, &whole.distance.square(), false);
        let Some(said) = arc.verdict else { continue };
        // The gap of a flip goes to the side of which nothing is claimed.
        let gap = &arc.to - &arc.from <= narrow;
        // Of `none` nothing is claimed; here it is so all the same.
        let open = d.run.outcome.kind == OutcomeKind::Bifurcated;
        let right = match said {
            Verdict::None => d.verdict == Verdict::None || gap,
            v => d.verdict >= v,
        };
        assert!(right || open, "{w:?} {:?}, said {said:?}", d.verdict);
    }
}

/// Without time nothing is claimed of any direction, and that is said.
#[test]
fn a_circle_without_time_is_open() {
    let s = scene("tests/data/total-fig7d.toml");
    let plan = simulate(&s, &Default::default()).unwrap();
    let ground = Ground::new(&s, Some(std::time::Instant::now()));
    let whole = total(&ground, &Start::after(&plan).unwrap(), &[]);
    assert!(whole.class.is_none() && whole.escape.is_none());
    assert!(whole.cover.iter().all(|a| a.verdict.is_none()));
    assert!(whole.undecided_width >= 2.0 * std::f64::consts::PI);
}

/// A ratchet's pawl sinks in exactly when tan β > μ: here tan β = 1/6. At 1/6 itself it slides,
/// as the cone is open.
#[test]
fn a_pawl_sinks_in_when_the_angle_beats_friction() {
    let mut s = scene("examples/ratchet-sinks.toml");
    let eps = Rat::from(2).pow(80).recip();
    let sixth = Rat::frac(1, 6);
    for (mu, end) in [
        (Rat::zero(), OutcomeKind::Jammed),
        (&sixth - &eps, OutcomeKind::Jammed),
        (sixth.clone(), OutcomeKind::Jammed),
        (&sixth + &eps, OutcomeKind::Stuck),
        (Rat::frac(1, 2), OutcomeKind::Stuck),
    ] {
        s.friction = Some(mu.clone());
        let run = simulate(&s, &Default::default()).unwrap();
        assert_eq!(run.outcome.kind, end, "{mu}");
    }
}

/// Clips as their makers label them: the one that "works", the one whose larger snap is "firmer",
/// and the one with the lock, "irreversible". (That a narrow one is "hard to take apart" is the
/// bow's doing: a rigid foot cannot tell.)
#[test]
fn clips_are_what_their_makers_say() {
    let force = |name: &str| {
        let d = decided(&scene(name));
        let (peak, _) = d.directions[0].peak.clone().unwrap();
        match peak.peak {
            snapfit::analysis::peak::Peak::Within(lo, _) => lo,
            other => panic!("{name}: {other:?}"),
        }
    };
    assert!(force("tests/data/rabbit-firm.toml") > force("tests/data/rabbit-small.toml"));
    let lock = decided(&scene("examples/rabbit-clip-lock.toml"));
    assert_eq!(lock.class, Some(Verdict::Kinematic));
}

/// The way out that a verdict names is a plan: simulated, it completes; and where the design
/// locks, the motion that decides ends as the verdict says.
#[test]
fn the_deciding_motion_can_be_simulated() {
    for (name, class) in FAMILIES {
        let s = scene(name);
        if s.motions.contains(&snapfit::scene::Motion::Reverse) {
            continue;
        }
        let (doc, way) = classify_with_way(&s, &ask()).unwrap();
        let (v, lasts) = way.unwrap();
        let run = simulate(&with_motion(&s, &v, &lasts), &Default::default()).unwrap();
        let completes = run.outcome.kind == OutcomeKind::Completed;
        assert_eq!(
            completes,
            class <= Verdict::Force,
            "{name}: {:?}",
            run.outcome.kind
        );
        assert_eq!(doc.class, Some(class.name()), "{name}");
    }
}

/// Flips are isolated to 2⁻⁶⁰, and both sides are what they are said to be.
#[test]
fn flips_are_isolated() {
    for name in ["tests/data/total-fig7d.toml", "tests/data/total-fig7e.toml"] {
        let s = scene(name);
        let ground = Ground::new(&s, None);
        let plan = simulate(&s, &Default::default()).unwrap();
        let start = Start::after(&plan).unwrap();
        let whole = total(&ground, &start, &[]);
        assert!(!whole.flips.is_empty(), "{name}");
        for f in &whole.flips {
            let [a, b] = &f.sides;
            assert!(&b.s - &a.s <= Rat::from(2).pow(60).recip());
            assert_ne!(a.verdict, b.verdict);
            for side in [a, b] {
                let w = Arc::unit(side.quarter, &side.s);
                let d = direction(&ground, &start, &w, &whole.distance.square(), false);
                assert_eq!(d.verdict, side.verdict, "{name}");
            }
        }
    }
}
