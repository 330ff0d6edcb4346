//! Verdicts on random designs: always decided or said to be open, never a panic; and against
//! brute force.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/world/mod.rs"]
mod world;

use common::count;
use snapfit::analysis::bound::Bound;
use snapfit::analysis::classify::{Verdict, direction, family, relative};
use snapfit::analysis::escape::{Ground, Start};
use snapfit::analysis::total::{Arc, total};
use snapfit::analysis::{Ask, Wish, classify, forces};
use snapfit::geometry::Vec2;
use snapfit::motion::root::first_collision;
use snapfit::motion::{OutcomeKind, simulate};
use snapfit::number::Rat;
use snapfit::scene::{Classify, Motion, Obstacle, Pawl, Scene, read_scene};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use world::follow::{Follower, How};
use world::oracle::{World, radians};
use world::rng::Rng;
use world::scenes::{Recipe, random_scene};

/// Names the design at hand where a test goes down with a panic.
struct Named(u64);

impl Drop for Named {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("seed {}", self.0);
        }
    }
}

/// A random scene that asks for everything.
fn design(seed: u64) -> Scene {
    let mut recipe = Recipe::draw(seed);
    let mut r = Rng::new(seed ^ 0xD10D);
    recipe.phases = *r.pick(&[1, 1, 1, 2]);
    recipe.root = r.chance(40);
    let mut s = random_scene(&recipe);
    for p in &mut s.pawls {
        p.stiffness = r.chance(80).then(|| Rat::frac(r.range(1, 40), 4));
    }
    s.classify = Some(Classify {
        total: r.chance(60),
        force_limit: r.chance(60).then(|| Rat::from(r.range(1, 50))),
        ..Classify::default()
    });
    s
}

/// Contract: a verdict or what is open, in time.
#[test]
fn every_design_is_decided() {
    let n = count(2_000) as u64;
    let mut classes: BTreeMap<String, usize> = BTreeMap::new();
    let (mut open, mut longest) = (0, Duration::ZERO);
    for seed in (0..n).map(|k| 3_000_000 + world::first_seed() + k) {
        let _named = Named(seed);
        let s = design(seed);
        let begin = Instant::now();
        let ask = Ask {
            deadline: Some(begin + Duration::from_secs(60)),
            critical: true,
            ..Ask::default()
        };
        let d = classify(&s, &ask).unwrap();
        let f = forces(&s, &Wish::all(6, 0), &Ask::default()).unwrap();
        assert_eq!(f.pawls.len(), s.pawls.len());
        let took = begin.elapsed();
        if took > Duration::from_secs(4) || d.undecided() {
            eprintln!(
                "seed {seed}: {took:?} {:?} {:?}",
                d.class, d.undecided_width
            );
        }
        open += usize::from(d.undecided());
        longest = longest.max(took);
        *classes
            .entry(format!("{:?} {:?}", d.class, d.total))
            .or_default() += 1;
    }
    eprintln!("{n} designs: {classes:?}; {open} open, {longest:?}");
}

/// A hook that rides over a bump of random slopes, undercut or not, with a random face of its own.
fn hook(seed: u64) -> Scene {
    let mut r = Rng::new(seed ^ 0x400C);
    let q = |n: i64| Rat::frac(n, 4);
    let at = |x: i64, y: i64| Vec2::new(q(x), q(y));
    let (d, a) = (r.range(1, 6), r.range(1, 12));
    let b = r.range(-(a - 1).min(4), 12);
    let wall = vec![
        at(16, -40),
        at(16, a + 4),
        at(0, a + 4),
        at(0, a),
        at(-d, 0),
        at(0, -b),
        at(0, -40),
    ];
    let (tip, s, u, length) = (
        r.range(-3, 1),
        r.range(1, 8),
        r.range(0, 8),
        r.range(16, 40),
    );
    let high = a + 4 + s + r.range(1, 4);
    let shape = [
        (tip, 0),
        (-6, -s),
        (-8, 0),
        (-8, length),
        (-4, length),
        (-4, u),
    ];
    let shift = |(x, y): (i64, i64)| at(x, y + high);
    let hinge = (r.range(-16, 4), length - r.range(0, 8));
    let drop = high + b.max(0) + u.max(0) + r.range(1, 4);
    let mu = *r.pick(&[0, 1, 2, 3, 5, 8]);
    Scene {
        name: format!("hook-{seed}"),
        friction: Some(q(mu)),
        obstacles: vec![Obstacle {
            name: "wall".to_owned(),
            vertices: wall,
            holes: Vec::new(),
        }],
        root: None,
        pawls: vec![Pawl {
            name: "hook".to_owned(),
            hinge: shift(hinge),
            vertices: shape.into_iter().map(shift).collect(),
            stiffness: None,
            start: Rat::zero(),
            limits: None,
        }],
        motions: vec![Motion::Translate {
            velocity: Vec2::new(Rat::zero(), Rat::from(-1)),
            duration: Some(q(drop)),
            until_root_collision: false,
        }],
        classify: None,
    }
}

/// The way out by brute force; None where the oracle itself cannot tell.
fn forecast(s: &Scene, start: &Start, v: &Vec2, lasts: &Rat) -> Option<Verdict> {
    let duration = lasts.nearest_f64()?;
    let root = s
        .root
        .as_ref()
        .and_then(|root| first_collision(root, &s.obstacles, &start.offset, v, Some(lasts)));
    if root.is_some() {
        return Some(Verdict::Kinematic);
    }
    let zero = Rat::zero();
    let mu = s.friction.as_ref().unwrap_or(&zero);
    for (model, verdict) in [(None, Verdict::Kinematic), (Some(mu), Verdict::Friction)] {
        for i in 0..s.pawls.len() {
            let w = World::new(s, i, &start.offset, v, duration);
            let f = Follower::run(&w, model, radians(&start.angles[i]), 300);
            match f.end {
                _ if f.doubt.is_some() => return None,
                Some((How::Bifurcated, _)) => return None,
                // Too near the end of the way to be told apart from it.
                Some((_, t)) if t > duration * (1.0 - 1e-6) => return None,
                Some(_) => return Some(verdict),
                None => {}
            }
        }
    }
    Some(Verdict::None)
}

/// Verdicts against a brute-force follower that knows no curves.
#[test]
fn verdicts_agree_with_brute_force() {
    let n = count(4_000) as u64;
    let mut met: BTreeMap<Verdict, usize> = BTreeMap::new();
    let (mut compared, mut doubtful, mut incomplete) = (0, 0, 0);
    let mut wrong = Vec::new();
    for k in 0..n {
        let seed = 5_000_000 + world::first_seed() + k;
        let _named = Named(seed);
        let mut s = if k % 4 == 0 { design(seed) } else { hook(seed) };
        s.classify = None;
        let r = relative(&s, &Ask::default()).unwrap();
        let (Some(start), Some((directions, _))) = (&r.start, family(&s, &r.forward)) else {
            incomplete += 1;
            continue;
        };
        let d = &r.directions[0];
        let lasts = match s.motions.iter().rposition(|m| *m != Motion::Reverse) {
            Some(k) => r.forward.phases[k].to.as_rat().unwrap().clone(),
            None => continue,
        };
        let ours = d.verdict;
        if d.run.outcome.kind == OutcomeKind::Bifurcated {
            doubtful += 1;
            continue;
        }
        match forecast(&s, start, &directions[0], &lasts) {
            None => doubtful += 1,
            Some(theirs) => {
                compared += 1;
                *met.entry(ours).or_default() += 1;
                if theirs != ours {
                    wrong.push(format!(
                        "seed {seed}: {ours:?}, by brute force {theirs:?}\n{}",
                        s.to_toml()
                    ));
                }
            }
        }
    }
    eprintln!(
        "{n} designs: {compared} compared {met:?}, {doubtful} doubtful, {incomplete} do not assemble"
    );
    assert!(
        wrong.is_empty(),
        "{} of {compared}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(2 * compared > n - incomplete, "too many doubts");
}

/// Kinematic verdicts mind neither friction nor stiffness, friction's no stiffness, and what
/// locks at some μ locks at every larger one at which the design still assembles.
#[test]
fn verdicts_mind_no_more_than_they_must() {
    let (mut kinematic, mut friction) = (0, 0);
    for seed in (0..count(2_000) as u64).map(|k| 7_000_000 + world::first_seed() + k) {
        let _named = Named(seed);
        let base = hook(seed);
        let class = |mu: i64, k: Option<i64>| {
            let mut s = base.clone();
            s.friction = Some(Rat::frac(mu, 4));
            s.pawls[0].stiffness = k.map(Rat::from);
            relative(&s, &Ask::default()).unwrap().class
        };
        let mut least = Verdict::None;
        for mu in [0, 1, 2, 4, 7] {
            let Some(now) = class(mu, None) else { break };
            assert!(now >= least, "seed {seed} at μ = {mu}/4");
            assert!((least == Verdict::Kinematic) <= (now == Verdict::Kinematic));
            least = now;
            kinematic += usize::from(now == Verdict::Kinematic);
            friction += usize::from(now == Verdict::Friction);
            if now >= Verdict::Friction {
                assert_eq!(class(mu, Some(1 + mu)), Some(now), "seed {seed}");
            }
        }
        if class(0, None) == Some(Verdict::Kinematic) {
            let rubbed = class(2, Some(9));
            assert!(
                rubbed.is_none() || rubbed == Some(Verdict::Kinematic),
                "seed {seed}"
            );
        }
    }
    eprintln!("{kinematic} kinematic, {friction} by friction");
    assert!(kinematic + friction > 0);
}

/// A figure of the paper in its closed basin, its corners, friction and force limit drawn anew.
fn basin(seed: u64) -> Option<Scene> {
    let mut r = Rng::new(seed ^ 0xBA51);
    let name = *r.pick(&["fig5", "fig7b", "fig7d", "fig7e"]);
    let path = format!(
        "{}/tests/data/total-{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).unwrap();
    let mut s = read_scene(name, &text).unwrap().scene().clone();
    let mut places = Rng::new(seed ^ 0x91ACE);
    let mut moved = |v: &Vec2| {
        let mut by = || Rat::frac(places.range(-6, 6), 40);
        Vec2::new(&v.x + &by(), &v.y + &by())
    };
    for o in s.obstacles.iter_mut().filter(|o| !o.name.contains("basin")) {
        o.vertices = o.vertices.iter().map(&mut moved).collect();
    }
    for p in &mut s.pawls {
        p.vertices = p.vertices.iter().map(&mut moved).collect();
        p.stiffness = Some(Rat::frac(r.range(1, 40), 4));
    }
    s.friction = r.chance(80).then(|| Rat::frac(r.range(0, 6), 4));
    s.classify = Some(Classify {
        total: true,
        force_limit: r.chance(60).then(|| Rat::frac(r.range(1, 80), 8)),
        ..Classify::default()
    });
    // Only what a file may say.
    Some(read_scene("basin", &s.to_toml()).ok()?.scene().clone())
}

/// The circle's cover of random designs against random exact directions.
#[test]
fn covers_of_random_designs_hold() {
    let mut proven: BTreeMap<String, usize> = BTreeMap::new();
    let (mut seed, mut designs, mut open) = (11_000_000 + world::first_seed() * 1000, 0, 0);
    while designs < count(400).min(40) {
        seed += 1;
        let _named = Named(seed);
        let Some(s) = basin(seed) else { continue };
        let deadline = Some(Instant::now() + Duration::from_secs(10));
        let plan = simulate(&s, &Default::default()).unwrap();
        let Some(start) = Start::after(&plan) else {
            continue;
        };
        let whole = total(&Ground::new(&s, deadline), &start, &[]);
        if whole.cover.is_empty() {
            continue;
        }
        designs += 1;
        open += usize::from(whole.undecided_width > 0.0);
        let name = format!("{:?}", whole.class);
        *proven.entry(name).or_default() += 1;
        let ground = Ground::new(&s, None);
        let mut r = Rng::new(seed);
        for _ in 0..count(10_000) {
            // Narrow arcs are where the verdict turns: as likely as wide ones.
            let arc = r.pick(&whole.cover);
            let part = r.fraction();
            let at = &arc.from + &(&(&arc.to - &arc.from) * &part);
            let w = Arc::unit(arc.quarter, &at);
            let d = direction(&ground, &start, &w, &whole.distance.square(), false);
            if d.run.outcome.kind == OutcomeKind::Bifurcated {
                continue;
            }
            if let Some(v) = arc.verdict {
                assert!(d.verdict >= v, "seed {seed}: {w:?} {:?} < {v:?}", d.verdict);
            }
            if whole.undecided_width == 0.0 {
                assert!(Some(d.verdict) >= whole.class, "seed {seed}: {w:?}");
            }
        }
    }
    eprintln!("{designs} covers: {proven:?}; {open} with a part undecided");
}

/// Peaks of random hooks against their histories.
#[test]
fn peaks_of_random_designs_hold_against_samples() {
    let mut met = 0;
    for seed in (0..count(2_000) as u64).map(|k| 13_000_000 + world::first_seed() + k) {
        let _named = Named(seed);
        let mut s = if seed % 3 == 0 {
            design(seed)
        } else {
            hook(seed)
        };
        s.pawls.iter_mut().for_each(|p| {
            p.stiffness.get_or_insert(Rat::from(7));
        });
        let wish = Wish {
            digits: 12,
            samples: 60,
            ..Wish::default()
        };
        let doc = forces(&s, &wish, &Ask::default()).unwrap();
        let read = |b: &Bound| match b {
            Bound::Within { lo, hi } => Some([lo, hi].map(|t| t.parse::<Rat>().unwrap())),
            Bound::Unbounded(_) => None,
        };
        for at in doc
            .root
            .iter()
            .flat_map(|r| &r.phases)
            .flat_map(|p| &p.history)
        {
            for p in &at.pawls {
                let pawl = doc.pawls.iter().find(|q| q.name == p.pawl).unwrap();
                let peak = pawl.peak.as_ref().unwrap();
                met += 1;
                if let (Some([lo, _]), Some([_, most])) = (read(&p.force), read(&peak.force)) {
                    assert!(lo <= most, "seed {seed} at {:?}", at.time.value);
                }
            }
        }
    }
    eprintln!("{met} loads");
    assert!(met > 0);
}

/// A scene in another unit of length, with the forces that go with it.
fn in_unit(s: &Scene, unit: &Rat) -> Scene {
    let mut s = s.clone();
    let to = |v: &mut Vec2| *v = v.scale(unit);
    for o in &mut s.obstacles {
        o.vertices.iter_mut().for_each(to);
        o.holes.iter_mut().flatten().for_each(to);
    }
    if let Some(r) = &mut s.root {
        r.vertices.iter_mut().for_each(to);
        r.reference.iter_mut().for_each(to);
    }
    for p in &mut s.pawls {
        p.vertices.iter_mut().for_each(to);
        to(&mut p.hinge);
    }
    for m in &mut s.motions {
        if let Motion::Translate { duration, .. } = m {
            duration.iter_mut().for_each(|d| *d = &*d * unit);
        }
    }
    if let Some(c) = &mut s.classify {
        c.force_limit.iter_mut().for_each(|f| *f = &*f / unit);
        c.escape_distance.iter_mut().for_each(|d| *d = &*d * unit);
    }
    s
}

/// A unit of length is none of the verdict's business, also far past the doubles.
#[test]
fn verdicts_mind_no_unit() {
    let text = |name: &str| {
        let path = format!("{}/tests/data/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).unwrap();
        read_scene(name, &text).unwrap().scene().clone()
    };
    let mut scenes = vec![text("two-pawls")];
    // The circle of directions in numbers so long takes minutes.
    if count(100) > 1 {
        scenes.push(text("total-fig7e"));
    }
    scenes.extend((0..count(200) as u64).map(|k| hook(17_000_000 + world::first_seed() + k)));
    let far = Rat::from(2).pow(600);
    for s in scenes {
        let ask = Ask {
            critical: true,
            ..Ask::default()
        };
        let told = |s: &Scene| {
            let d = classify(s, &ask).unwrap();
            let mu = d.critical_friction.map(|n| n.value);
            (d.class, d.extent, d.total, d.undecided_width, mu)
        };
        let here = told(&s);
        for unit in [far.clone(), far.recip()] {
            let there = in_unit(&s, &unit);
            assert_eq!(told(&there), here, "{}", s.name);
            let peak = |s: &Scene| {
                let mut s = s.clone();
                s.pawls.iter_mut().for_each(|p| {
                    p.stiffness.get_or_insert(Rat::from(7));
                });
                forces(&s, &Wish::default(), &Ask::default()).unwrap().peak
            };
            let [a, b] = [peak(&s), peak(&there)].map(|p| match p.unwrap().force {
                Bound::Within { lo, hi } => Some([lo, hi].map(|t| t.parse::<Rat>().unwrap())),
                Bound::Unbounded(_) => None,
            });
            match (a, b) {
                (Some(a), Some(b)) => {
                    let b = b.map(|f| f * &unit);
                    assert!(a[0] <= b[1] && b[0] <= a[1], "{}", s.name);
                }
                (a, b) => assert_eq!(a.is_some(), b.is_some(), "{}", s.name),
            }
        }
    }
}

/// Writes a random hook as a scene, to look at: `TEST_SEED=7000007 cargo test … -- --ignored hook_as`.
#[test]
#[ignore = "a tool"]
fn hook_as_a_scene() {
    let seed = std::env::var("TEST_SEED").unwrap().parse().unwrap();
    println!("{}", hook(seed).to_toml());
}
