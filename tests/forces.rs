//! Certified peaks against dense sampling by another route: the balance of torques at a contact
//! whose sliding direction is read off finite differences of the motion itself.
#![allow(clippy::unwrap_used)]

use snapfit::analysis::escape::Ground;
use snapfit::analysis::peak::{Instant, Peak, force, torque};
use snapfit::analysis::stretch::{Stretch, stretches};
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
