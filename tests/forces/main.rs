//! Certified peaks against dense sampling by another route: the balance of torques at a contact
//! whose sliding direction is read off finite differences of the motion itself. What the pawls do to
//! the root together is held in `root`, the snap-fit handbook's formula in `handbook`.
#![allow(clippy::unwrap_used)]

#[path = "../common/mod.rs"]
mod common;
mod handbook;
mod root;

use common::count;
use snapfit::analysis::bound::Bound;
use snapfit::analysis::escape::Ground;
use snapfit::analysis::forces::SegmentForces;
use snapfit::analysis::peak::{Instant, Peak, force, torque};
use snapfit::analysis::stretch::{Stretch, stretches};
use snapfit::analysis::{Ask, ForcesDocument, Wish, forces};
use snapfit::contact::{Contact, ContactKind};
use snapfit::motion::{Trajectory, simulate};
use snapfit::number::Rat;
use snapfit::scene::{Scene, read_scene};

fn scene(name: &str) -> Scene {
    let path = format!("{}/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap();
    match read_scene(name, &text) {
        Ok(file) => file.scene().clone(),
        Err(e) => panic!("{e:?}"),
    }
}

const SCENES: [&str; 7] = [
    "examples/handbook-vertex.toml",
    "examples/handbook-edge.toml",
    "tests/data/total-fig5.toml",
    "tests/data/total-fig7d.toml",
    "tests/data/total-fig7e.toml",
    "tests/data/two-pawls.toml",
    "tests/data/peg.toml",
];

const MORE: [&str; 5] = [
    "examples/bayer-hook.toml",
    "examples/rabbit-clip.toml",
    "examples/escapement-rack.toml",
    "examples/ratchet-rack.toml",
    "tests/data/total-fig7b.toml",
];

fn value(r: &Rat) -> f64 {
    r.nearest_f64().unwrap()
}

/// θ on a stretch at time t, from its curve in doubles.
fn theta(run: &Trajectory, s: &Stretch, t: f64) -> f64 {
    let slide = run.pawls[s.pawl].segments[s.segment]
        .sliding
        .as_ref()
        .unwrap();
    let f = |k: usize| {
        let [p, q] = [&slide.p[k], &slide.q[k]].map(|i| value(&Rat::from(i.clone())));
        p + t * q
    };
    let (c, b, a) = (f(0), f(1), f(2));
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt() * f64::from(slide.branch);
    // Of the two forms of a root the one without cancellation.
    let u = if (root > 0.0) == (b < 0.0) {
        (-b + root) / (2.0 * a)
    } else {
        2.0 * c / (-b - root)
    };
    2.0 * u.atan()
}

/// The contact force at θ, t from first principles.
fn balance(scene: &Scene, run: &Trajectory, s: &Stretch, t: f64, speed: f64) -> f64 {
    let pawl = &scene.pawls[s.pawl];
    let phase = &run.phases[s.phase];
    let th = theta(run, s, t);
    let (sin, cos) = th.sin_cos();
    let v = [value(&phase.velocity.x), value(&phase.velocity.y)];
    let p = [
        value(&(&pawl.hinge.x + &phase.offset.x)) + t * v[0],
        value(&(&pawl.hinge.y + &phase.offset.y)) + t * v[1],
    ];
    let turn = |a: [f64; 2]| [cos * a[0] - sin * a[1], sin * a[0] + cos * a[1]];
    let ring = |points: &[snapfit::geometry::Vec2], i: usize| {
        let at = |k: usize| {
            let q = &points[k % points.len()];
            [value(&q.x), value(&q.y)]
        };
        let area: f64 = (0..points.len())
            .map(|k| at(k)[0] * at(k + 1)[1] - at(k)[1] * at(k + 1)[0])
            .sum();
        let (a, b) = (at(i), at(i + 1));
        let d = [b[0] - a[0], b[1] - a[1]];
        let len = d[0].hypot(d[1]) * area.signum();
        (a, [d[1] / len, -d[0] / len])
    };
    let Contact::Obstacle {
        obstacle,
        kind,
        obstacle_feature,
        pawl_feature,
        ..
    } = s.contact
    else {
        return 0.0;
    };
    let body: Vec<_> = pawl.vertices.iter().map(|q| q - &pawl.hinge).collect();
    let (a, m) = ring(&body, pawl_feature as usize);
    let fixed = &scene.obstacles[obstacle as usize].vertices;
    let (q, n) = ring(fixed, obstacle_feature as usize);
    // Where it touches, and which way the obstacle pushes.
    let (r, push) = match kind {
        ContactKind::B => (turn(a), n),
        ContactKind::A => {
            let m = turn(m);
            ([q[0] - p[0], q[1] - p[1]], [-m[0], -m[1]])
        }
    };
    let side = [push[1], -push[0]];
    let slides = [v[0] - speed * r[1], v[1] + speed * r[0]];
    let along = (slides[0] * side[0] + slides[1] * side[1]).signum();
    let mu = scene.friction.as_ref().map_or(0.0, value);
    let f = [
        push[0] - mu * along * side[0],
        push[1] - mu * along * side[1],
    ];
    let k = value(pawl.stiffness.as_ref().unwrap());
    (k * th / (r[0] * f[1] - r[1] * f[0])).abs() * (1.0 + mu * mu).sqrt()
}

#[test]
fn peaks_hold_against_dense_sampling() {
    let (mut inside, mut checked) = (0, 0);
    for name in SCENES {
        let mut s = scene(name);
        s.pawls.iter_mut().for_each(|p| {
            p.stiffness.get_or_insert(Rat::from(3));
        });
        for mu in [Rat::zero(), Rat::frac(1, 4)] {
            s.friction = Some(mu.clone());
            let run = simulate(&s, &Default::default()).unwrap();
            let ground = Ground::new(&s, None);
            for st in stretches(&s, &ground.shapes, &ground.obstacles, &run) {
                let k = s.pawls[st.pawl].stiffness.as_ref().unwrap();
                let peaked = force(&st, k, &mu, 40);
                let (t0, t1) = (st.t[0].interval().hi, st.t[1].interval().lo);
                let n = 4000;
                let mut best = 0.0f64;
                for i in 1..n {
                    let t = t0 + (t1 - t0) * f64::from(i) / f64::from(n);
                    let h = (t1 - t0) * 1e-5;
                    let speed = (theta(&run, &st, t + h) - theta(&run, &st, t - h)) / (2.0 * h);
                    best = best.max(balance(&s, &run, &st, t, speed));
                }
                let twist = theta(&run, &st, t0).abs().max(theta(&run, &st, t1).abs()) * value(k);
                let Peak::Within(lo, hi) = torque(&st, k, 40).peak else {
                    panic!("a torque is finite");
                };
                assert!(
                    (twist - value(&lo)).abs() <= 1e-6 * (1.0 + value(&hi)),
                    "{name}"
                );
                match &peaked.peak {
                    Peak::Unbounded => assert!(best > 1.0, "{name} {st:?} {best}"),
                    Peak::Within(lo, hi) => {
                        checked += 1;
                        inside += i32::from(matches!(peaked.when, Instant::Between(..)));
                        assert!(
                            best <= value(hi) * (1.0 + 1e-7),
                            "{name} {st:?} {best} {hi}"
                        );
                        assert!(value(lo) <= best * 1.01 + 1e-9, "{name} {st:?} {best} {lo}");
                        assert!((hi - lo) * Rat::from(2).pow(40) <= *lo, "{name}: narrow");
                    }
                }
            }
        }
    }
    // Prop. A.1 says that there are none of these.
    assert!(inside > 0, "peaks inside a stretch");
    assert!(checked > 20);
}

/// The same against samples enclosed to 30 digits, by the vectors of the balance: none is higher
/// than a peak's upper bound, and the highest comes near its lower one. Exact comparisons.
#[test]
fn peaks_hold_against_samples_in_high_precision() {
    let samples = u32::try_from(count(10_000)).unwrap();
    let mut met = 0;
    for name in SCENES.iter().chain(&MORE) {
        let mut s = scene(name);
        s.pawls.iter_mut().for_each(|p| {
            p.stiffness.get_or_insert(Rat::from(3));
        });
        let wish = Wish {
            digits: 30,
            samples,
            ..Wish::default()
        };
        let doc = forces(&s, &wish, &Ask::default()).unwrap();
        for phase in &doc.root.as_ref().unwrap().phases {
            for at in &phase.history {
                for p in &at.pawls {
                    let pawl = doc.pawls.iter().find(|q| q.name == p.pawl).unwrap();
                    let [lo, _] = ends(&p.force).unwrap();
                    let [twist, _] = ends(&p.torque.clone()).unwrap();
                    // The segment at hand, which the instant is inside.
                    let t = at.time.value.unwrap();
                    let mut own = pawl.segments.iter().filter(|q| {
                        Some(q.phase) == phase.phase
                            && q.from.value.unwrap() <= t
                            && t <= q.to.value.unwrap()
                    });
                    let seg = own.next().unwrap();
                    let beside = own.next();
                    let most = |f: fn(&SegmentForces) -> &Bound| {
                        let of = |q: &SegmentForces| ends(f(q)).map(|e| e[1].clone());
                        let a = of(seg)?;
                        Some(beside.map_or(Some(a.clone()), of)?.max(a))
                    };
                    met += 1;
                    assert!(most(|q| &q.force).is_none_or(|m| lo <= m), "{name} {t}");
                    assert!(
                        most(|q| &q.torque).is_none_or(|m| twist.abs() <= m),
                        "{name} {t}"
                    );
                }
            }
        }
    }
    assert!(met > 3 * samples, "{met}");
}

/// More digits, narrower, and never apart.
#[test]
fn enclosures_nest() {
    let s = scene("tests/data/total-fig5.toml");
    let run = simulate(&s, &Default::default()).unwrap();
    let ground = Ground::new(&s, None);
    let k = Rat::one();
    for st in stretches(&s, &ground.shapes, &ground.obstacles, &run) {
        let peak = |goal| match force(&st, &k, &Rat::zero(), goal).peak {
            Peak::Within(lo, hi) => Some((lo, hi)),
            Peak::Unbounded => None,
        };
        if let (Some(wide), Some(narrow)) = (peak(20), peak(200)) {
            assert!(wide.0 <= narrow.1 && narrow.0 <= wide.1);
            assert!((&narrow.1 - &narrow.0) * Rat::from(2).pow(200) <= narrow.0);
        }
    }
}

fn ends(b: &Bound) -> Option<[Rat; 2]> {
    match b {
        Bound::Unbounded(_) => None,
        Bound::Within { lo, hi } => Some([lo.parse().unwrap(), hi.parse().unwrap()]),
    }
}

fn middle(b: &Bound) -> f64 {
    let [lo, hi] = ends(b).unwrap();
    0.5 * (value(&lo) + value(&hi))
}

fn asked(s: &Scene, digits: u32, samples: u32) -> ForcesDocument {
    forces(s, &Wish::all(digits, samples), &Ask::default()).unwrap()
}

/// The digits asked for bound both the width and the length of what is printed.
#[test]
fn digits_are_the_users() {
    let s = scene("tests/data/total-fig7e.toml");
    let mut before: Option<[Rat; 2]> = None;
    for digits in [2, 3, 6, 30, 100] {
        let doc = asked(&s, digits, 2);
        let force = &doc.peak.as_ref().unwrap().force;
        let Bound::Within { lo, .. } = force else {
            panic!("finite");
        };
        assert!(lo.len() <= 2 * digits as usize + 10, "{lo}");
        let [lo, hi] = ends(force).unwrap();
        assert!((&hi - &lo) * Rat::from(10).pow(digits) <= hi, "{digits}");
        if let Some([a, b]) = before {
            assert!(a <= hi && lo <= b, "enclosures of one number meet");
        }
        before = Some([lo, hi]);
    }
}

#[test]
fn without_a_stiffness_nothing_is_modelled_and_that_is_said() {
    let mut s = scene("tests/data/total-fig7e.toml");
    s.pawls.iter_mut().for_each(|p| p.stiffness = None);
    let doc = asked(&s, 6, 3);
    assert!(!doc.modelled && doc.peak.is_none() && doc.root.is_none());
    assert!(doc.note.unwrap().contains("no pawl has a stiffness"));
}

/// What is asked for besides the peaks changes none of them, and what is not asked for is absent.
#[test]
fn each_wish_adds_its_own_part_and_changes_no_other() {
    for name in SCENES {
        let mut s = scene(name);
        s.friction = Some(Rat::frac(1, 4));
        s.pawls.iter_mut().for_each(|p| {
            p.stiffness.get_or_insert(Rat::from(3));
        });
        let run = |wish: &Wish| {
            let doc = forces(&s, wish, &Ask::default()).unwrap();
            serde_json::to_value(&doc).unwrap()
        };
        let (least, all) = (run(&Wish::default()), run(&Wish::all(6, 3)));
        assert_eq!(least["peak"], all["peak"], "{name}");
        assert!(least["root"].is_null() && least["comparison"].is_null());
        assert!(!all["root"].is_null());
        let segments = |doc: &serde_json::Value| {
            let pawls = doc["pawls"].as_array().unwrap().clone();
            pawls
                .iter()
                .flat_map(|p| p["segments"].as_array().unwrap().clone())
                .collect::<Vec<_>>()
        };
        for (a, b) in segments(&least).iter().zip(&segments(&all)) {
            for key in ["from", "to", "force", "torque", "time"] {
                assert_eq!(a[key], b[key], "{name} {key}");
            }
            assert!(a["force_without_friction"].is_null() && a["handbook"].is_null());
            assert!(!b["force_without_friction"].is_null());
        }
        let one = |wish: Wish| run(&wish)["root"]["phases"][0].clone();
        let base = &all["root"]["phases"][0];
        let root = one(Wish {
            root: true,
            ..Wish::default()
        });
        assert_eq!(root["peak"], base["peak"], "{name}");
        assert!(root["lost_in_snaps"].is_null());
        let work = one(Wish {
            work: true,
            ..Wish::default()
        });
        assert_eq!(work["work"], base["work"], "{name}");
        assert_eq!(work["lost_in_snaps"], base["lost_in_snaps"], "{name}");
        assert!(work["peak"].is_null());
        let seen = one(Wish {
            samples: 3,
            ..Wish::default()
        });
        assert_eq!(seen["history"], base["history"], "{name}");
        assert!(seen["peak"].is_null());
    }
}
