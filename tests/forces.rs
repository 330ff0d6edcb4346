//! Certified peaks against dense sampling by another route: the balance of torques at a contact
//! whose sliding direction is read off finite differences of the motion itself.
#![allow(clippy::unwrap_used)]

mod common;

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

/// Without friction the drive's power goes into the springs, whatever the contact: −f·ṗ = Σ kθθ̇,
/// by finite differences of the motion. And a torque about another point differs by a moment.
#[test]
fn the_roots_loads_balance() {
    let mut checked = 0;
    for name in SCENES {
        let mut s = scene(name);
        s.friction = None;
        s.pawls.iter_mut().for_each(|p| {
            p.stiffness.get_or_insert(Rat::from(3));
        });
        let doc = asked(&s, 9, 40);
        let shift = snapfit::geometry::Vec2::new(Rat::from(2), Rat::from(-5));
        let moved = s.root.clone().map(|root| {
            let mut other = s.clone();
            let base = root.reference.clone().unwrap_or(s.pawls[0].hinge.clone());
            other.root = Some(snapfit::scene::Root {
                reference: Some(&base + &shift),
                ..root
            });
            asked(&other, 9, 40)
        });
        let run = simulate(&s, &Default::default()).unwrap();
        let ground = Ground::new(&s, None);
        let all = stretches(&s, &ground.shapes, &ground.obstacles, &run);
        let root = doc.root.as_ref().unwrap();
        for (k, phase) in root.phases.iter().enumerate() {
            let v = &run.phases[k].velocity;
            let speed = value(&v.norm2()).sqrt();
            for (i, at) in phase.history.iter().enumerate() {
                let t = at.time.value.unwrap() - value(&run.phases[k].from);
                let mut power = 0.0;
                let h = 1e-6;
                let mut near = false;
                for st in all.iter().filter(|st| st.phase == k) {
                    let (t0, t1) = (st.t[0].interval().lo, st.t[1].interval().hi);
                    near |= (t - t0).abs() < 1e-4 || (t - t1).abs() < 1e-4;
                    if t0 < t && t < t1 {
                        let stiff = value(s.pawls[st.pawl].stiffness.as_ref().unwrap());
                        let rate = (theta(&run, st, t + h) - theta(&run, st, t - h)) / (2.0 * h);
                        power += stiff * theta(&run, st, t) * rate;
                    }
                }
                if near {
                    continue;
                }
                checked += usize::from(power != 0.0);
                let got = middle(&at.resistance) * speed;
                assert!(
                    (got - power).abs() <= 1e-5 * (1.0 + power.abs()),
                    "{name} {t}: {got} {power}"
                );
                if let Some(moved) = &moved {
                    let there = &moved.root.as_ref().unwrap().phases[k].history[i];
                    let [fx, fy] = at.force.each_ref().map(middle);
                    // −shift × f.
                    let moment = -(2.0 * fy + 5.0 * fx);
                    let got = middle(&there.torque) - middle(&at.torque);
                    assert!(
                        (got - moment).abs() <= 1e-6 * (1.0 + moment.abs()),
                        "{name} {t}"
                    );
                }
            }
        }
    }
    assert!(checked > 20, "{checked}");
}

/// With friction: the work is the integral of the resistance, and no sample beats a peak.
#[test]
fn work_and_peaks_of_the_root_hold_against_sampling() {
    let mut worked = 0;
    for name in SCENES {
        let mut s = scene(name);
        s.friction = Some(Rat::frac(1, 4));
        s.pawls.iter_mut().for_each(|p| {
            p.stiffness.get_or_insert(Rat::from(3));
        });
        let n = 1500;
        let doc = asked(&s, 6, n);
        for p in &doc.root.as_ref().unwrap().phases {
            let length = p.to.value.unwrap() - p.from.value.unwrap();
            let [vx, vy] = p.velocity.each_ref().map(|v| v.value.unwrap());
            let step = length * vx.hypot(vy) / f64::from(n);
            let mut sum = 0.0;
            let (mut most, mut least, mut turn) = (0.0f64, 0.0f64, 0.0f64);
            for at in &p.history {
                let w = middle(&at.resistance);
                sum += w * step;
                most = most.max(w);
                least = least.min(w);
                turn = turn.max(middle(&at.torque).abs());
            }
            let peak = p.peak.as_ref().unwrap();
            for (peak, seen) in [
                (&peak.resistance, most),
                (&peak.help, -least),
                (&peak.torque, turn),
            ] {
                if let Some([lo, hi]) = ends(peak) {
                    assert!(
                        seen <= value(&hi) * (1.0 + 1e-6) + 1e-9,
                        "{name}: {seen} {hi}"
                    );
                    assert!(value(&lo) <= seen * 1.03 + 1e-3, "{name}: {seen} {lo}");
                    assert!((&hi - &lo) * Rat::from(10).pow(5) <= hi, "{name}: narrow");
                }
            }
            let work = p.work.as_ref().expect("settled");
            if ends(work).is_some() {
                worked += usize::from(sum != 0.0);
                let got = middle(work);
                assert!(
                    (got - sum).abs() <= 0.01 * (most + -least) * step * f64::from(n),
                    "{name}: {got} {sum}"
                );
            }
        }
    }
    assert!(worked >= 5, "{worked}");
}

/// The work of every way is enclosed, narrower where more digits are asked for, or it is said
/// that it has no bound, and why: only where friction holds at last.
#[test]
fn work_is_settled_everywhere() {
    let clips = [
        "examples/rabbit-clip-lock.toml",
        "examples/ratchet-sinks.toml",
        "examples/bayer-hook-steep.toml",
        "tests/data/rabbit-large.toml",
        "tests/data/rabbit-firm.toml",
    ];
    let (mut unbounded, mut rubbed) = (0, 0);
    for name in SCENES.into_iter().chain(MORE).chain(clips) {
        let mut s = scene(name);
        s.friction.get_or_insert(Rat::frac(1, 4));
        s.pawls.iter_mut().for_each(|p| {
            p.stiffness.get_or_insert(Rat::from(3));
        });
        let with = |digits| {
            let wish = Wish {
                digits,
                root: true,
                work: true,
                ..Wish::default()
            };
            let doc = forces(&s, &wish, &Ask::default()).unwrap();
            let root = doc.root.unwrap();
            root.phases.into_iter().chain(root.way_back)
        };
        for (few, many) in with(6).zip(with(30)) {
            let (a, b) = (few.work.expect("settled"), many.work.expect("settled"));
            let stuck = few.outcome == "stuck";
            match (ends(&a), ends(&b)) {
                (Some([lo, hi]), Some([low, high])) => {
                    assert!(few.work_note.is_none());
                    assert!(lo <= low && low <= high && high <= hi, "{name}");
                    let most = lo.abs().max(hi.abs()).max(Rat::one());
                    assert!((&high - &low) * Rat::from(10).pow(27) <= most, "{name}");
                    rubbed += usize::from(!lo.is_zero());
                }
                (None, None) => {
                    assert!(stuck, "{name}");
                    assert!(few.work_note.is_some());
                    let peak = few.peak.unwrap();
                    assert!(ends(&peak.resistance).is_none(), "{name}");
                    unbounded += 1;
                }
                _ => panic!("{name}: {a:?} {b:?}"),
            }
        }
    }
    assert!(unbounded >= 2 && rubbed >= 10, "{unbounded} {rubbed}");
}

/// Where the sliding is just about to stick as it begins, at rest, force and work stay finite: the
/// spring's pull and the balance's denominator vanish together. The handbook's asymptote.
#[test]
fn work_is_finite_from_the_boundary_on() {
    // tan α = 3/2 and μ = 2/3: the first instant is on the cone's ray.
    let s = bayer(&Rat::frac(3, 2), &Rat::frac(1, 2), &Rat::frac(2, 3));
    let wish = Wish {
        work: true,
        root: true,
        ..Wish::default()
    };
    let doc = forces(&s, &wish, &Ask::default()).unwrap();
    let there = &doc.root.as_ref().unwrap().phases[0];
    let n = 3000;
    let dense = asked(&s, 6, n);
    let history = &dense.root.as_ref().unwrap().phases[0].history;
    let length = there.to.value.unwrap() - there.from.value.unwrap();
    let sum: f64 =
        history.iter().map(|h| middle(&h.resistance)).sum::<f64>() * length / f64::from(n);
    let work = there.work.as_ref().expect("settled");
    assert!(ends(work).is_some());
    assert!((middle(work) - sum).abs() <= 0.01 * sum, "{sum} {work:?}");
}

/// Arms that come down on a floor, each by its hinge's height, its side and its stiffness. A tip is
/// (±3, −4) from its hinge and lands 4 below it; with μ = 3/4 that is on the cone's ray, from where
/// it slides outwards.
fn arms(each: &[(i64, i64, i64)]) -> Scene {
    let pawl = |(k, (height, side, stiffness)): (usize, &(i64, i64, i64))| {
        let at = |x: i64, y: i64| format!("[{}, {}]", 20 * k as i64 + side * x, height + y);
        let (hinge, tip, back) = (at(0, 0), at(3, -4), at(4, -1));
        format!(
            "[[pawl]]\nname = 'arm{k}'\nhinge = {hinge}\nvertices = [{hinge}, {tip}, {back}]\n\
             stiffness = {stiffness}\n"
        )
    };
    let pawls: String = each.iter().enumerate().map(pawl).collect();
    let text = format!(
        "[scene]\nname = 'arms'\nfriction = '3/4'\n\
         [[obstacle]]\nname = 'floor'\nvertices = [[-90, -1], [90, -1], [90, 0], [-90, 0]]\n\
         [root]\nvertices = [[0, 20], [1, 20], [0, 21]]\n{pawls}\
         [[motion]]\nvelocity = [0, -1]\nduration = '7/2'\n"
    );
    read_scene("arms.toml", &text).unwrap().into_scene()
}

/// Pawls that begin on the ray, at once or one while the other slides already: the root's resistance
/// at the end, where each is at its highest, is the sum of what they give alone, as narrow. (The
/// force leans by 3 : 4, so that no bound by its size is so narrow.)
#[test]
fn pawls_on_the_ray_together_add_up() {
    let wish = Wish {
        root: true,
        ..Wish::default()
    };
    let peak = |each: &[(i64, i64, i64)]| {
        let doc = forces(&arms(each), &wish, &Ask::default()).unwrap();
        let peak = &doc.root.as_ref().unwrap().phases[0].peak;
        ends(&peak.as_ref().unwrap().resistance).expect("bounded")
    };
    let narrow = |[lo, hi]: &[Rat; 2]| {
        assert!(lo.sign() > 0);
        assert!(hi - lo <= hi * &Rat::frac(1, 10_000), "{lo} {hi}");
    };
    let one = (6, 1, 5);
    let first = peak(&[one]);
    narrow(&first);
    for other in [
        one,
        (6, 1, 15),
        (6, -1, 5),
        (6, -1, 2),
        (7, 1, 5),
        (7, -1, 3),
    ] {
        let second = peak(&[other]);
        let both = peak(&[one, other]);
        narrow(&both);
        let sum = [0, 1].map(|k| &first[k] + &second[k]);
        assert!(both[0] <= sum[1] && sum[0] <= both[1], "{other:?}");
    }
}

/// Bayer's Example I: the torque balance of a rigid arm, W = P·(sin α + μ cos α)/(cos(α ∓ θ) ∓
/// μ sin(α ∓ θ))…, beside the handbook's factor.
#[test]
fn the_handbooks_example_parts_by_the_arms_turn() {
    let doc = asked(&scene("examples/bayer-hook.toml"), 9, 0);
    let (mu, k, l) = (0.6, 4876.0, 19.0);
    let theta = (2.4f64 / 19.0).asin();
    let p = k * theta / l;
    let exact = |a: f64, sign: f64| {
        let turned = a + sign * theta;
        p * (a.sin() + mu * a.cos()) / (turned.cos() - mu * turned.sin())
    };
    let slopes = [15.0f64 / 26.0, 1.0].map(f64::atan);
    let find = |phase: usize, tan: &str| {
        let mut all = doc.pawls[0].segments.iter().filter(|s| s.phase == phase);
        let s = all.find(|s| {
            s.handbook
                .as_ref()
                .is_some_and(|h| h.slope.as_deref() == Some(tan))
        });
        s.unwrap().handbook.clone().unwrap()
    };
    let (there, back) = (find(0, "15/26"), find(1, "1"));
    for (h, want, factor, tan) in [
        (&there, exact(slopes[0], -1.0), "9/5", slopes[0].tan()),
        (&back, exact(slopes[1], 1.0), "4", 1.0),
    ] {
        assert_eq!(h.factor.as_deref(), Some(factor));
        let formula = p * (mu + tan) / (1.0 - mu * tan);
        assert!((middle(h.formula.as_ref().unwrap()) / formula - 1.0).abs() < 1e-8);
        assert!(
            (middle(h.model.as_ref().unwrap()) / want - 1.0).abs() < 1e-8,
            "{h:?} {want}"
        );
        assert!(!h.parts.is_empty());
    }
    // The table of the field: 1.477 in, 8.218 out, in units of P (its slope in is 30°).
    assert!((middle(there.model.as_ref().unwrap()) / p - 1.477).abs() < 0.002);
    assert!((middle(back.model.as_ref().unwrap()) / p - 8.218).abs() < 0.002);
    // By the steep hook the formula still lets go, and the model does not.
    let steep = asked(&scene("examples/bayer-hook-steep.toml"), 6, 0);
    assert_eq!(steep.outcome, "stuck");
    let held = steep.root.unwrap().phases.pop().unwrap();
    let held = held.peak.unwrap();
    assert_eq!(ends(&held.resistance), None);
    assert!(ends(&held.help).is_some());
}

/// Bayer's hook with other slopes: in by `tan_in`, out by `tan_out`.
fn bayer(tan_in: &Rat, tan_out: &Rat, mu: &Rat) -> Scene {
    let mut s = scene("examples/bayer-hook.toml");
    s.friction = Some(mu.clone());
    let catch = &mut s.obstacles[0].vertices;
    let tip = catch[5].y.clone();
    let wide = Rat::frac(29, 10);
    catch[4].y = &tip + &(&wide / tan_in);
    catch[6].y = &tip - &(&wide / tan_out);
    s
}

/// The whole table of the handbook's formula beside the model, W in units of kθ/L at the full
/// deflection: slope, μ, the handbook's value, the model's way in and way out.
#[test]
fn the_handbooks_table_is_found_again() {
    let p = 4876.0 * (2.4f64 / 19.0).asin() / 19.0;
    for (tan, mu, handbook, into, out) in [
        ("0.577350", "0.6", 1.801, 1.477, 2.356),
        ("1", "0.6", 4.000, 2.672, 8.218),
        ("1.191754", "0.6", 6.288, 3.520, 31.80),
        ("1", "0.3", 1.857, 1.514, 2.452),
        ("1", "0.2", 1.500, 1.270, 1.869),
    ] {
        let read = |text: &str| snapfit::number::literal::parse(text).unwrap();
        let slope = read(tan);
        let doc = asked(&bayer(&slope, &slope, &read(mu)), 9, 0);
        for (phase, model) in [(0, into), (1, out)] {
            let found = doc.pawls[0].segments.iter().find_map(|s| {
                let h = s.handbook.as_ref()?;
                let here = s.phase == phase && h.slope.as_deref() == Some(&slope.to_string());
                // The steeper way: on the other face the pawl is let down, not lifted.
                (here && middle(h.model.as_ref()?) > 0.0).then(|| h.clone())
            });
            let h = found.unwrap();
            let [w, m] = [&h.formula, &h.model].map(|b| middle(b.as_ref().unwrap()) / p);
            assert!((w / handbook - 1.0).abs() < 5e-4, "{tan} {mu}: {w}");
            assert!((m / model - 1.0).abs() < 5e-4, "{tan} {mu} {phase}: {m}");
        }
    }
}

/// The band in which the handbook lets go and the model holds: from cot(φ + θ) = 1.2698 (51.78°),
/// not from 1/μ (59.04°) on.
#[test]
fn removal_locks_earlier_than_the_handbook_says() {
    let mu = Rat::frac(3, 5);
    for (tan, outcome) in [
        (Rat::frac(12697, 10_000), "completed"),
        (Rat::frac(12699, 10_000), "stuck"),
        (Rat::frac(16, 10), "stuck"),
    ] {
        let s = bayer(&Rat::frac(15, 26), &tan, &mu);
        let doc = forces(&s, &Wish::default(), &Ask::default()).unwrap();
        assert_eq!(doc.outcome, outcome, "{tan}");
    }
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
