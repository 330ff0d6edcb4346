//! What the pawls together do to the root: its loads and their peaks, and the work of the drive.

use super::handbook::bayer;
use super::{MORE, SCENES, asked, ends, middle, scene, theta, value};
use snapfit::analysis::escape::Ground;
use snapfit::analysis::stretch::stretches;
use snapfit::analysis::{Ask, Wish, forces};
use snapfit::motion::simulate;
use snapfit::number::Rat;
use snapfit::scene::{Scene, read_scene};

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
