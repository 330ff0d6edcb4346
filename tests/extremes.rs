//! Stability at the extremes: scales, offsets, slivers, near coincidences, long numbers, and other
//! solvers' hard quartics.

#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/world/mod.rs"]
mod world;

use common::count;
use snapfit::geometry::Vec2;
use snapfit::motion::{Arithmetic, Options, OutcomeKind, Trajectory, simulate};
use snapfit::number::filter::with_filter;
use snapfit::number::{Algebraic, Int, Poly, Rat, literal};
use snapfit::scene::{Motion, Scene, read_scene};
use snapfit::trade::family::FAMILIES;
use world::rng::Rng;
use world::scenes::{Recipe, random_scene};

fn rat(text: &str) -> Rat {
    literal::parse(text).unwrap()
}

fn run(scene: &Scene) -> Trajectory {
    simulate(scene, &Options::default()).unwrap()
}

fn exactly(scene: &Scene) -> Trajectory {
    let options = Options {
        arithmetic: Arithmetic::Exact,
        ..Options::default()
    };
    simulate(scene, &options).unwrap()
}

/// What happens, times multiplied: exactly the same, or a panic that says where.
fn same(a: &Trajectory, b: &Trajectory, slower: &Rat, what: &str) {
    assert_eq!(a.outcome.kind, b.outcome.kind, "{what}");
    assert_eq!(a.outcome.pawl, b.outcome.pawl, "{what}");
    for (p, q) in a.pawls.iter().zip(&b.pawls) {
        assert_eq!(p.events.len(), q.events.len(), "{what}");
        for (e, f) in p.events.iter().zip(&q.events) {
            assert_eq!((e.kind, &e.contacts), (f.kind, &f.contacts), "{what}");
            assert_eq!(
                e.time.affine(&Rat::zero(), slower),
                *f.time.exact(),
                "{what}"
            );
            assert_eq!(e.angle, f.angle, "{what}");
            assert_eq!(e.to, f.to, "{what}");
        }
    }
}

/// Lengths times `size`, plus `by`; durations times `slower` with velocities to match.
fn moved(scene: &Scene, size: &Rat, by: &Vec2, slower: &Rat) -> Scene {
    let mut s = scene.clone();
    let place = |p: &mut Vec2| *p = &p.scale(size) + by;
    for o in &mut s.obstacles {
        o.vertices.iter_mut().for_each(place);
        o.holes.iter_mut().flatten().for_each(place);
    }
    if let Some(r) = &mut s.root {
        r.vertices.iter_mut().for_each(place);
        r.reference.iter_mut().for_each(place);
    }
    for p in &mut s.pawls {
        place(&mut p.hinge);
        p.vertices.iter_mut().for_each(place);
    }
    for m in &mut s.motions {
        if let Motion::Translate {
            velocity, duration, ..
        } = m
        {
            *velocity = velocity.scale(&(size / slower));
            if let Some(d) = duration {
                *d = &*d * slower;
            }
        }
    }
    s
}

fn two_to(e: i64) -> Rat {
    let p = Rat::from(Int::one().shl(e.unsigned_abs()));
    if e < 0 { p.recip() } else { p }
}

#[test]
fn scaling_by_a_power_of_two_changes_nothing_but_the_scale() {
    let n = count(20_000) as u64;
    let mut rng = Rng::new(4);
    let origin = Vec2::default();
    // The whole range of doubles, its ends, and far beyond, as rationals.
    let ends = [-1074, -1075, -1022, -538, 511, 512, 1023, 1024, -5000, 5000];
    for k in 0..n {
        let e = match ends.get(k as usize) {
            Some(&e) => e,
            None => rng.range(-1074, 1023),
        };
        let scene = random_scene(&Recipe::draw(3_000_000 + k));
        let scaled = moved(&scene, &two_to(e), &origin, &Rat::one());
        let what = format!("seed {k}, 2^{e}");
        let (a, b) = (run(&scene), run(&scaled));
        same(&a, &b, &Rat::one(), &what);
        if k % 10 == 0 {
            same(&a, &exactly(&scaled), &Rat::one(), &what);
        }
    }
}

#[test]
fn far_away_and_tiny() {
    let n = count(2_000) as u64;
    let far = Vec2::new(rat("1e9"), rat("-1e9"));
    for k in 0..n {
        let scene = random_scene(&Recipe::draw(4_000_000 + k));
        let a = run(&scene);
        same(
            &a,
            &run(&moved(&scene, &rat("1e-9"), &far, &Rat::one())),
            &Rat::one(),
            "offset",
        );
        // Speeds of 1e-30.
        let slow = rat("1e30");
        same(
            &a,
            &run(&moved(&scene, &Rat::one(), &Vec2::default(), &slow)),
            &slow,
            "speed",
        );
    }
}

#[test]
fn numbers_of_ten_thousand_digits() {
    // A third to ten thousand digits differs from a third by less than anything else in the scene,
    // and only the exact numbers can know.
    let long = format!("0.{}", "3".repeat(9_990));
    let text = |tip: &str| {
        format!(
            r#"
[scene]
name = "long"
[[obstacle]]
name = "floor"
vertices = [["-40", "-1"], ["40", "-1"], ["40", "0"], ["-40", "0"]]
[[pawl]]
name = "p"
hinge = ["1/3", "6"]
vertices = [["{tip}", "1"], ["4/3", "4"], ["1/3", "6"], ["-2/3", "4"]]
[[motion]]
velocity = ["0", "-1"]
duration = "2"
"#
        )
    };
    let read = |tip: &str| read_scene("long", &text(tip)).unwrap().into_scene();
    assert_eq!(run(&read("1/3")).outcome.kind, OutcomeKind::Bifurcated);
    let t = run(&read(&long));
    // Left of the point under the hinge: it gives way to the left, clockwise.
    assert_eq!(t.outcome.kind, OutcomeKind::Completed);
    assert_eq!(t.pawls[0].events.last().unwrap().angle.side(), -1);
    assert_eq!(t.pawls[0].events[0].time.as_rat(), Some(&Rat::one()));
}

#[test]
fn slivers() {
    // Obstacles and pawls 10¹⁵ times as long as wide.
    let scene = |floor: &str, pawl: &str| {
        let text = format!(
            "[scene]\nname = \"sliver\"\n[[obstacle]]\nname = \"o\"\nvertices = {floor}\n[[pawl]]\n\
             name = \"p\"\nhinge = [\"0\", \"6\"]\nvertices = {pawl}\n[[motion]]\n\
             velocity = [\"0\", \"-1\"]\nduration = \"3\"\n"
        );
        read_scene("sliver", &text).unwrap().into_scene()
    };
    let thick = r#"[["-40","-1"],["40","-1"],["40","0"],["-40","0"]]"#;
    let floors = [
        r#"[["-1e15","-1"],["1e15","-1"],["1e15","0"],["-1e15","0"]]"#,
        r#"[["-40","-4e-14"],["40","-4e-14"],["40","0"],["-40","0"]]"#,
    ];
    let pawl = r#"[["3","2"],["4","4"],["0","6"]]"#;
    let right = run(&scene(thick, pawl));
    for floor in floors {
        let t = run(&scene(floor, pawl));
        same(&right, &t, &Rat::one(), floor);
        same(&t, &exactly(&scene(floor, pawl)), &Rat::one(), floor);
    }
    let needle = r#"[["3","2"],["3.000000000000005","2"],["0","6"]]"#;
    let t = run(&scene(thick, needle));
    same(&t, &exactly(&scene(thick, needle)), &Rat::one(), "needle");
    assert_eq!(t.outcome.kind, OutcomeKind::Completed);
}

/// The gap 2^-k is seen for every k: what it decides does not depend on how small it is.
#[test]
fn near_coincidences_down_to_two_to_the_minus_thousand() {
    for family in FAMILIES {
        let kinds = |t: &Trajectory| {
            let events = t.pawls[0].events.iter();
            events
                .map(|e| (e.kind, e.contacts.clone()))
                .collect::<Vec<_>>()
        };
        let first = run(&family.scene(12));
        for k in [20, 50, 53, 60, 100, 200, 333, 500, 1000] {
            let scene = family.scene(k);
            let t = run(&scene);
            assert_eq!(t.outcome.kind, first.outcome.kind, "{} {k}", family.name);
            assert_eq!(kinds(&t), kinds(&first), "{} {k}", family.name);
            if k == 100 || k == 1000 {
                same(&t, &exactly(&scene), &Rat::one(), family.name);
            }
        }
    }
    // Friction from none to far too much: slides, and sticks at the landing.
    let mut scene = FAMILIES[3].scene(10);
    for (mu, kind) in [
        ("0", OutcomeKind::Completed),
        ("1e9", OutcomeKind::Stuck),
        ("0.75", OutcomeKind::Completed),
    ] {
        scene.friction = Some(rat(mu));
        assert_eq!(run(&scene).outcome.kind, kind, "{mu}");
        same(&run(&scene), &exactly(&scene), &Rat::one(), mu);
    }
}

#[test]
fn a_hundred_thousand_vertices() {
    // A floor as a saw of blunt teeth, as long as it takes; the pawl meets a few of them.
    let n = count(10_000_000).min(100_000) as i64 / 2;
    let mut vertices = vec![(n, -1), (n, 0)];
    vertices.extend((1..n).rev().map(|k| (k, k % 2)));
    vertices.extend([(0, 0), (0, -1)]);
    let list: Vec<String> = vertices
        .iter()
        .map(|(x, y)| format!("[\"{}/100\",\"{y}/1000\"]", 100 * x - 50 * n))
        .collect();
    let text = format!(
        "[scene]\nname = \"saw\"\n[[obstacle]]\nname = \"o\"\nvertices = [{}]\n[[pawl]]\nname = \"p\"\n\
         hinge = [\"0.3\", \"6\"]\nvertices = [[\"3\",\"2\"],[\"4\",\"4\"],[\"0.3\",\"6\"]]\n[[motion]]\n\
         velocity = [\"1/7\", \"-1\"]\nduration = \"3\"\n",
        list.join(",")
    );
    let scene = read_scene("saw", &text).unwrap().into_scene();
    assert!(scene.obstacles[0].vertices.len() as i64 >= n);
    assert_ne!(run(&scene).outcome.kind, OutcomeKind::Undecided);
}

#[test]
fn what_is_no_number_stays_outside() {
    for bad in [
        "nan", "inf", "-inf", "infinity", "1e999999", "0x10", "1/0", "1e", "--1", "",
    ] {
        let text = format!(
            "[scene]\nname = \"s\"\n[[obstacle]]\nname = \"o\"\n\
             vertices = [[\"{bad}\",\"0\"],[\"1\",\"0\"],[\"0\",\"1\"]]\n[[pawl]]\nname = \"p\"\n\
             hinge = [\"9\", \"9\"]\nvertices = [[\"8\",\"8\"],[\"9\",\"8\"],[\"9\",\"9\"]]\n[[motion]]\n\
             velocity = [\"0\", \"-1\"]\nduration = \"1\"\n"
        );
        assert!(read_scene("s", &text).is_err(), "{bad}");
        // Bare, too: TOML itself knows nan and inf.
        let bare = text.replace(&format!("\"{bad}\""), bad);
        assert!(read_scene("s", &bare).is_err(), "bare {bad}");
    }
}

/// The 24 cases of Orellana and De Michele (ACM TOMS Algorithm 1010, table 1): real roots, and
/// conjugate pairs as (real part, imaginary part).
#[allow(clippy::type_complexity)]
const QUARTICS: [(&[&str], &[(&str, &str)]); 22] = [
    (&["1e9", "1e6", "1e3", "1"], &[]),
    (&["2.003", "2.002", "2.001", "2"], &[]),
    (&["1e53", "1e50", "1e49", "1e47"], &[]),
    (&["1e14", "2", "1", "-1"], &[]),
    (&["-2e7", "1e7", "1", "-1"], &[]),
    (&["1e7", "-1e6"], &[("1", "1")]),
    (&["-7", "-4"], &[("-1e6", "1e5")]),
    (&["1e8", "11"], &[("1e3", "1")]),
    (&[], &[("1e7", "1e6"), ("1", "2")]),
    (&[], &[("1e4", "3"), ("-7", "1e3")]),
    (&[], &[("1.001", "4.998"), ("1", "5.001")]),
    (&[], &[("1e3", "3"), ("1e3", "1")]),
    (&[], &[("2", "1e4"), ("1", "1e3")]),
    (&["1e3", "1e3", "1e3", "1e3"], &[]),
    (&["1e3", "1e3", "1e3", "1e-15"], &[]),
    (&[], &[("1e16", "1e7"), ("1", "0.1")]),
    (&["10000", "10001", "10010", "10100"], &[]),
    (&[], &[("4e5", "3e2"), ("3e4", "7e3")]),
    (&["1e44", "1e30", "1e30", "1"], &[]),
    (&["1e14", "1e7", "1e7", "1"], &[]),
    (&["1e15", "1e7", "1e7", "1"], &[]),
    (&["1e154", "1e152", "10", "1"], &[]),
];

fn times(a: &[Rat], b: &[Rat]) -> Vec<Rat> {
    let mut c = vec![Rat::zero(); a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            c[i + j] += &(x * y);
        }
    }
    c
}

#[test]
fn the_quartics_of_algorithm_1010() {
    for filter in [true, false] {
        with_filter(filter, || {
            for (k, (real, pairs)) in QUARTICS.iter().enumerate() {
                let mut c = vec![Rat::one()];
                for r in *real {
                    c = times(&c, &[-rat(r), Rat::one()]);
                }
                for (a, b) in *pairs {
                    let (a, b) = (rat(a), rat(b));
                    let size = a.square() + b.square();
                    c = times(&c, &[size, -(&a + &a), Rat::one()]);
                }
                let mut right: Vec<Rat> = real.iter().map(|r| rat(r)).collect();
                right.sort();
                right.dedup();
                let p = Poly::from_rats(&c);
                assert_eq!(p.degree(), Some(4), "case {}", k + 1);
                let found = p.real_roots();
                let exact: Vec<Rat> = found.iter().map(|r| r.to_rat().unwrap()).collect();
                assert_eq!(exact, right, "case {}", k + 1);
                // And nudged by the last bit, where nothing is rational any more: certified.
                c[0] += &two_to(-200);
                certify(&Poly::from_rats(&c));
            }
            // Case 23 has irrational roots.
            let p = Poly::from_rats(&["0.001", "3/8", "1", "1", "1"].map(rat));
            let roots = certify(&p);
            let values: Vec<f64> = roots.iter().map(|r| r.nearest_f64().unwrap()).collect();
            assert_eq!(values.len(), 2);
            assert!((values[0] + 0.497314148060048).abs() < 1e-15);
            assert!((values[1] + 0.002_685_851_939_951_49).abs() < 1e-17);
            // Case 24, with S = 10³⁰.
            let s = rat("1e30");
            let c = [
                -&s,
                s.square() + &s,
                s.recip() - s.square(),
                -(Rat::one() + s.recip()),
                Rat::one(),
            ];
            let roots = Poly::from_rats(&c).real_roots();
            let exact: Vec<Rat> = roots.iter().map(|r| r.to_rat().unwrap()).collect();
            assert_eq!(exact, [-&s, s.recip(), Rat::one(), s.clone()]);
        });
    }
}

/// The roots, each between two rationals where the polynomial changes sign, pairwise apart, and as
/// many as Sturm's theorem counts.
fn certify(p: &Poly) -> Vec<Algebraic> {
    let roots = p.real_roots();
    let mut last: Option<Rat> = None;
    for r in &roots {
        let (lo, hi) = r.enclosure(900);
        if lo < hi {
            let q = p.squarefree();
            assert!(q.sign_at(&lo) * q.sign_at(&hi) < 0);
        } else {
            assert_eq!(p.sign_at(&lo), 0);
        }
        assert!(last.as_ref().is_none_or(|l| *l < lo));
        last = Some(hi);
    }
    assert_eq!(roots.len(), sturm(p));
    roots
}

/// How many distinct real roots there are, by Sturm's theorem, in plain rational arithmetic.
fn sturm(p: &Poly) -> usize {
    let c = |p: &Poly| -> Vec<Rat> { p.coeffs().iter().map(|c| Rat::from(c.clone())).collect() };
    let mut chain = vec![c(p), c(&p.derivative())];
    while chain.last().unwrap().len() > 1 {
        let (a, b) = (&chain[chain.len() - 2], &chain[chain.len() - 1]);
        let mut rest = a.clone();
        while rest.len() >= b.len() {
            let (q, at) = (
                rest.last().unwrap() / b.last().unwrap(),
                rest.len() - b.len(),
            );
            for (i, x) in b.iter().enumerate() {
                rest[at + i] -= &(&q * x);
            }
            rest.pop();
            while rest.last().is_some_and(Rat::is_zero) {
                rest.pop();
            }
        }
        if rest.is_empty() {
            break;
        }
        chain.push(rest.iter().map(|x| -x).collect());
    }
    let changes = |at: &dyn Fn(&Vec<Rat>) -> i32| {
        let signs: Vec<i32> = chain.iter().map(at).filter(|s| *s != 0).collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    };
    let high = |c: &Vec<Rat>| c.last().unwrap().sign();
    let low = |c: &Vec<Rat>| {
        if c.len().is_multiple_of(2) {
            -high(c)
        } else {
            high(c)
        }
    };
    changes(&low) - changes(&high)
}
