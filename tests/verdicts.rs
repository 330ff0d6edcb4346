//! Verdicts on random designs: always decided or said to be open, never a panic; and against
//! brute force.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/world/mod.rs"]
mod world;

use common::count;
use snapfit::analysis::classify::{Verdict, family, relative};
use snapfit::analysis::escape::Start;
use snapfit::analysis::{Ask, Wish, classify, forces};
use snapfit::geometry::Vec2;
use snapfit::motion::OutcomeKind;
use snapfit::motion::root::first_collision;
use snapfit::number::Rat;
use snapfit::scene::{Classify, Motion, Obstacle, Pawl, Scene};
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

/// Writes a random hook as a scene, to look at: `TEST_SEED=7000007 cargo test … -- --ignored hook_as`.
#[test]
#[ignore = "a tool"]
fn hook_as_a_scene() {
    let seed = std::env::var("TEST_SEED").unwrap().parse().unwrap();
    println!("{}", hook(seed).to_toml());
}
