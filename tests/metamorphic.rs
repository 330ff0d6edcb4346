//! What must not change, or change in a known way, when a scene is written or placed differently.
//! Outcomes, kinds, times and orientations are compared exactly, and every scene runs by both methods.

#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/world/mod.rs"]
mod world;

use common::count;
use proptest::prelude::*;
use proptest::test_runner::Config;
use snapfit::contact::Contact;
use snapfit::geometry::Vec2;
use snapfit::motion::Angle;
use snapfit::motion::trajectory::{Event, EventKind, OutcomeKind, Trajectory};
use snapfit::number::{Algebraic, Int, Poly, Rat};
use snapfit::scene::{Motion, Obstacle, Scene};
use snapfit::slice::Time;
use std::cmp::Ordering;
use world::compare::by_both as engine;
use world::oracle::f;
use world::rng::Rng;
use world::scenes::{Recipe, random_scene, starts_free};

// ── scenes and changes ──────────────────────────────────────────────────────────────────────────

/// Small scenes; proptest makes them smaller still when one fails.
fn scenes() -> impl Strategy<Value = Scene> {
    let size = (1usize..=2, 1usize..=3, 3usize..=7, 1usize..=3);
    let on = (any::<bool>(), 0u8..6, 0u8..6);
    (
        any::<u32>(),
        size,
        prop::sample::select(vec![1i64, 1, 2, 4, 7]),
        on,
    )
        .prop_map(
            |(seed, (pawls, obstacles, corners, phases), grid, (friction, limits, root))| {
                random_scene(&Recipe {
                    seed: u64::from(seed),
                    pawls,
                    obstacles,
                    corners,
                    grid,
                    friction,
                    limits: limits == 5,
                    root: root == 5,
                    phases,
                })
            },
        )
}

fn rational() -> impl Strategy<Value = Rat> {
    (-40i64..=40, 1i64..=20).prop_map(|(n, d)| Rat::frac(n, d))
}

fn positive() -> impl Strategy<Value = Rat> {
    (1i64..=60, 1i64..=60).prop_map(|(n, d)| Rat::frac(n, d))
}

/// The scene with every point and every vector mapped.
fn mapped(s: &Scene, point: &dyn Fn(&Vec2) -> Vec2, vector: &dyn Fn(&Vec2) -> Vec2) -> Scene {
    let ring = |v: &[Vec2]| v.iter().map(point).collect::<Vec<_>>();
    let mut s = s.clone();
    for o in &mut s.obstacles {
        o.vertices = ring(&o.vertices);
        for h in &mut o.holes {
            *h = ring(h);
        }
    }
    if let Some(r) = &mut s.root {
        r.vertices = ring(&r.vertices);
    }
    for p in &mut s.pawls {
        p.hinge = point(&p.hinge);
        p.vertices = ring(&p.vertices);
    }
    for m in &mut s.motions {
        if let Motion::Translate { velocity, .. } = m {
            *velocity = vector(velocity);
        }
    }
    s
}

fn mirrored(s: &Scene) -> Scene {
    let flip = |p: &Vec2| Vec2::new(-&p.x, p.y.clone());
    let mut s = mapped(s, &flip, &flip);
    for p in &mut s.pawls {
        p.start = -&p.start;
        p.limits = p.limits.take().map(|(lo, hi)| (-hi, -lo));
    }
    s
}

/// Every ring begun elsewhere and perhaps listed the other way round.
fn relabelled(s: &Scene, seed: u64) -> Scene {
    let mut r = Rng::new(seed);
    let mut s = s.clone();
    let mut ring = |v: &mut Vec<Vec2>| {
        let k = r.next() as usize % v.len();
        v.rotate_left(k);
        if r.chance(50) {
            v.reverse();
        }
    };
    for o in &mut s.obstacles {
        ring(&mut o.vertices);
        o.holes.iter_mut().for_each(&mut ring);
    }
    for p in &mut s.pawls {
        ring(&mut p.vertices);
    }
    s.obstacles.reverse();
    s.pawls.reverse();
    s
}

// ── comparing ───────────────────────────────────────────────────────────────────────────────────

/// How the second trajectory is expected to differ from the first.
struct Change {
    /// Times are multiplied by this.
    time: Rat,
    /// θ → −θ.
    mirror: bool,
    /// Contacts keep their indices.
    contacts: bool,
    /// Phases keep their indices (else times are compared on the clock of the plan).
    phases: bool,
}

const SAME: fn() -> Change = || Change {
    time: Rat::one(),
    mirror: false,
    contacts: true,
    phases: true,
};

fn negated(a: &Angle) -> Angle {
    let minus = Poly::new(vec![Int::zero(), -Int::one()]);
    Angle {
        half_turn: -a.half_turn,
        x: a.x.ratio(&minus, &Poly::constant(Int::one())),
    }
}

fn clock(t: &Trajectory, phase: usize, time: &Time, factor: &Rat) -> Algebraic {
    time.affine(&(&t.phases[phase].from * factor), factor)
}

/// An event as the comparison sees it.
fn mark(e: &Event, c: &Change, change: bool) -> String {
    let mut contacts = e.contacts.clone();
    if change && c.mirror {
        for k in &mut contacts {
            if let Contact::Limit(l) = k {
                *l = 1 - *l;
            }
        }
        contacts.sort();
    }
    let contacts = if c.contacts {
        format!("{contacts:?} {:?}", e.root_contacts.len())
    } else {
        String::new()
    };
    let phase = if c.phases { e.phase } else { 0 };
    format!("{:?} in {phase} {contacts}", e.kind)
}

fn events<'a>(t: &'a Trajectory, name: &str, c: &Change) -> Vec<&'a Event> {
    let trace = t.pawls.iter().find(|p| p.name == name).unwrap();
    trace
        .events
        .iter()
        .filter(|e| c.phases || e.kind != EventKind::PhaseEnd)
        .collect()
}

fn same(a: &Trajectory, b: &Trajectory, c: &Change) -> Result<(), String> {
    let factor = |change: bool| if change { c.time.clone() } else { Rat::one() };
    let when = |t: &Trajectory, e: &Event, change| clock(t, e.phase, &e.time, &factor(change));
    let turned = |x: &Angle, change: bool| {
        if change && c.mirror {
            negated(x)
        } else {
            x.clone()
        }
    };
    let (x, y) = (&a.outcome, &b.outcome);
    if x.kind != y.kind {
        return Err(format!("outcome {:?}, then {:?}", x.kind, y.kind));
    }
    let ends = [(a, true), (b, false)].map(|(t, change)| {
        let o = &t.outcome;
        clock(t, o.phase, &o.time, &factor(change))
    });
    if ends[0] != ends[1] {
        return Err(format!("ends at {:?}, then {:?}", ends[0], ends[1]));
    }
    let mut sides: Vec<_> = x.branches.iter().map(|b| (b.direction, b.sticks)).collect();
    if c.mirror {
        sides.iter_mut().for_each(|s| s.0 = -s.0);
    }
    let mut other: Vec<_> = y.branches.iter().map(|b| (b.direction, b.sticks)).collect();
    sides.sort_unstable();
    other.sort_unstable();
    if sides != other {
        return Err(format!("branches {sides:?}, then {other:?}"));
    }
    for p in &a.pawls {
        let (e, g) = (events(a, &p.name, c), events(b, &p.name, c));
        let list = |l: &[&Event], ch| l.iter().map(|e| mark(e, c, ch)).collect::<Vec<_>>();
        let (le, lg) = (list(&e, true), list(&g, false));
        if le != lg {
            return Err(format!("{}: events {le:#?}, then {lg:#?}", p.name));
        }
        for (e, g) in e.iter().zip(&g) {
            if when(a, e, true) != when(b, g, false) {
                return Err(format!("{}: {:?} at another time", p.name, e.kind));
            }
            let to = |x: &Event, ch| x.to.as_ref().map(|x| turned(x, ch));
            let unequal = |x: &Angle, y: &Angle| x.cmp(y) != Ordering::Equal;
            let differ = match (to(e, true), to(g, false)) {
                (Some(x), Some(y)) => unequal(&x, &y),
                (None, None) => false,
                _ => true,
            };
            if differ || unequal(&turned(&e.angle, true), &turned(&g.angle, false)) {
                return Err(format!("{}: {:?} at another orientation", p.name, e.kind));
            }
        }
    }
    Ok(())
}

fn agree(s: &Scene, changed: &Scene, c: &Change) -> Result<(), TestCaseError> {
    let told = |e: String| {
        TestCaseError::fail(format!("{e}\n── {}\n── {}", s.to_toml(), changed.to_toml()))
    };
    let a = engine(s).map_err(told)?;
    let b = engine(changed).map_err(told)?;
    same(&a, &b, c).map_err(told)
}

/// Whether friction has to decide between several contacts that hold throughout: there the order
/// of the file counts (contract), so relabelling may change what happens.
fn order_counts(s: &Scene) -> bool {
    s.friction.as_ref().is_some_and(|m| m.sign() > 0)
        && engine(s).is_ok_and(|t| {
            let several = |g: &snapfit::motion::Segment| {
                g.sliding.as_ref().is_some_and(|s| !s.also.is_empty())
            };
            let many = |e: &Event| e.kind != EventKind::PhaseEnd && e.contacts.len() > 1;
            t.pawls
                .iter()
                .any(|p| p.segments.iter().any(several) || p.events.iter().any(many))
        })
}

fn cases(nominal: usize) -> Config {
    Config {
        cases: count(nominal) as u32,
        failure_persistence: None,
        max_shrink_iters: 400,
        // Some properties hold only of runs that complete, which half of the scenes do not.
        max_global_rejects: 20 * count(nominal) as u32 + 1024,
        ..Config::default()
    }
}

// ── properties ──────────────────────────────────────────────────────────────────────────────────

proptest! {
    #![proptest_config(cases(1000))]

    /// θ is measured from the drawn orientation: a scene turned as a whole by a rational rotation
    /// does the same things at the same times and orientations.
    #[test]
    fn rotation_changes_nothing(s in scenes(), u in rational()) {
        let turn = |p: &Vec2| p.rotate_tan_half(&u);
        agree(&s, &mapped(&s, &turn, &turn), &SAME())?;
    }

    /// Shifted as a whole, far away.
    #[test]
    fn translation_changes_nothing(s in scenes(), x in rational(), e in 0u32..60) {
        let by = Vec2::new(&x * &Rat::from(Int::one().shl(u64::from(e))), x.clone());
        agree(&s, &mapped(&s, &|p| p + &by, &Vec2::clone), &SAME())?;
    }

    /// Lengths and speeds by p/q or by 2^e: times and orientations stay.
    #[test]
    fn scaling_changes_nothing(s in scenes(), k in positive(), e in -60i64..60) {
        let two = Rat::from(Int::one().shl(e.unsigned_abs()));
        let k = k * if e < 0 { two.recip() } else { two };
        let by = |p: &Vec2| p.scale(&k);
        agree(&s, &mapped(&s, &by, &by), &SAME())?;
    }

    /// Speeds alone by p/q: times by q/p.
    #[test]
    fn speed_scales_time(s in scenes(), k in positive()) {
        let mut fast = mapped(&s, &Vec2::clone, &|v| v.scale(&k));
        for m in &mut fast.motions {
            if let Motion::Translate { duration: Some(d), .. } = m {
                *d = &*d / &k;
            }
        }
        agree(&s, &fast, &Change { time: k.recip(), ..SAME() })?;
    }

    /// In the mirror θ → −θ, the stops and the ways on from a bifurcation change places.
    #[test]
    fn the_mirror_negates(s in scenes()) {
        agree(&s, &mirrored(&s), &Change { mirror: true, ..SAME() })?;
    }

    /// Where a ring begins, which way round it is listed, and the order of obstacles and pawls
    /// are names only.
    #[test]
    fn labels_are_names(s in scenes(), seed in any::<u64>()) {
        prop_assume!(!order_counts(&s));
        agree(&s, &relabelled(&s, seed), &Change { contacts: false, ..SAME() })?;
    }

    /// A collinear vertex on any edge is no event and changes no time (contract: the joint of a
    /// split edge).
    #[test]
    fn split_edges_are_no_events(s in scenes(), seed in any::<u64>(), k in 1i64..8) {
        prop_assume!(!order_counts(&s));
        let mut r = Rng::new(seed);
        let mut split = s.clone();
        let mut cut = |v: &mut Vec<Vec2>| {
            let i = r.next() as usize % v.len();
            let j = (i + 1) % v.len();
            let on = &v[i] + &(&v[j] - &v[i]).scale(&Rat::frac(k, 8));
            v.insert(i + 1, on);
        };
        split.obstacles.iter_mut().for_each(|o| cut(&mut o.vertices));
        split.pawls.iter_mut().for_each(|p| cut(&mut p.vertices));
        agree(&s, &split, &Change { contacts: false, ..SAME() })?;
    }

    /// An obstacle given twice is the same obstacle.
    #[test]
    fn a_duplicate_changes_nothing(s in scenes(), k in any::<prop::sample::Index>()) {
        prop_assume!(!order_counts(&s));
        let mut twice = s.clone();
        let o = &s.obstacles[k.index(s.obstacles.len())];
        twice.obstacles.push(Obstacle { name: "twin".into(), ..o.clone() });
        agree(&s, &twice, &Change { contacts: false, ..SAME() })?;
    }

    /// What lies out of every pawl's and the root's reach does not matter.
    #[test]
    fn what_is_out_of_reach_does_not_matter(s in scenes(), x in 60i64..200, shape in any::<u32>()) {
        let mut more = s.clone();
        let like = random_scene(&Recipe {
            seed: u64::from(shape), pawls: 1, obstacles: 1, corners: 6, grid: 2,
            friction: false, limits: false, root: false, phases: 1,
        });
        // Nothing moves further than 12 · √13 to the right in a phase; three phases at most.
        let far = Vec2::new(Rat::from(x + 140), Rat::zero());
        let vertices = like.obstacles[0].vertices.iter().map(|p| p + &far).collect();
        more.obstacles.push(Obstacle { name: "far".into(), vertices, holes: Vec::new() });
        agree(&s, &more, &SAME())?;
    }

    /// A phase cut in two with the same velocity: the same events but for the phase's end, and
    /// but for those at the very instant of the cut (contract, Ends).
    #[test]
    fn a_cut_phase_changes_nothing(s in scenes(), n in 1i64..997) {
        let mut s = s;
        s.root = None;
        let mut last: Option<(Vec2, Rat)> = None;
        for m in &mut s.motions {
            let (v, d) = match (&*m, &last) {
                (Motion::Translate { velocity, duration: Some(d), .. }, _) => (velocity.clone(), d.clone()),
                (_, Some((v, d))) => (-v, d.clone()),
                _ => unreachable!(),
            };
            *m = Motion::Translate { velocity: v.clone(), duration: Some(d.clone()), until_root_collision: false };
            last = Some((v, d));
        }
        let mut cut = s.clone();
        let (v, d) = match &s.motions[0] {
            Motion::Translate { velocity, duration: Some(d), .. } => (velocity.clone(), d.clone()),
            _ => unreachable!(),
        };
        let part = &d * &Rat::frac(n, 997);
        let piece = |d: Rat| Motion::Translate {
            velocity: v.clone(), duration: Some(d), until_root_collision: false,
        };
        cut.motions[0] = piece(part.clone());
        cut.motions.insert(1, piece(&d - &part));
        let a = engine(&s).map_err(TestCaseError::fail)?;
        let at_cut = |t: &Time| t.cmp_rat(&part).is_eq();
        prop_assume!(!a.pawls.iter().any(|p| p.events.iter().any(|e| e.phase == 0 && at_cut(&e.time))));
        agree(&s, &cut, &Change { phases: false, ..SAME() })?;
    }

    /// More friction never sticks later: with μ' > μ what stuck sticks no later, and what jammed or
    /// forked does so unless it has stuck by then.
    #[test]
    fn more_friction_sticks_no_later(s in scenes(), mu in positive(), more in positive()) {
        let with = |m: Rat| Scene { friction: Some(m), ..s.clone() };
        let a = engine(&with(mu.clone())).map_err(TestCaseError::fail)?;
        let b = engine(&with(&mu + &more)).map_err(TestCaseError::fail)?;
        let end = |t: &Trajectory| clock(t, t.outcome.phase, &t.outcome.time, &Rat::one());
        let (x, y) = (a.outcome.kind, b.outcome.kind);
        let order = end(&b).cmp(&end(&a));
        let ok = if y == OutcomeKind::Stuck { order.is_le() } else { x == y && order.is_eq() };
        prop_assert!(ok, "μ = {mu}: {x:?} at {}, μ + {more}: {y:?} at {}\n{}",
            end(&a).nearest_f64().unwrap(), end(&b).nearest_f64().unwrap(), s.to_toml());
    }

    /// Without friction a phase without snaps runs back along the same orientations.
    #[test]
    fn a_slide_without_friction_runs_back(s in scenes()) {
        let mut s = s;
        s.friction = None;
        s.root = None;
        s.motions.truncate(1);
        let a = engine(&s).map_err(TestCaseError::fail)?;
        let leap = a.pawls.iter().any(|p| p.events.iter().any(|e| e.to.is_some()));
        prop_assume!(a.outcome.kind == OutcomeKind::Completed && !leap);
        s.motions.push(Motion::Reverse);
        let b = engine(&s).map_err(TestCaseError::fail)?;
        // A release at which the interval opens both ways is, run backwards, a bifurcation.
        prop_assume!(b.outcome.kind != OutcomeKind::Bifurcated);
        prop_assert_eq!(b.outcome.kind, OutcomeKind::Completed, "{}", s.to_toml());
        let d = b.phases[1].from.clone();
        for p in &b.pawls {
            let part = |k: usize| p.segments.iter().filter(move |g| g.phase == k);
            let there: Vec<_> = part(0).collect();
            let mut back: Vec<_> = part(1).collect();
            back.reverse();
            prop_assert_eq!(there.len(), back.len(), "{}", s.to_toml());
            for (g, h) in there.iter().zip(&back) {
                let turned = |t: &Time| t.affine(&d, &Rat::from(-1));
                let same = turned(&g.from) == h.to.affine(&Rat::zero(), &Rat::one())
                    && turned(&g.to) == h.from.affine(&Rat::zero(), &Rat::one())
                    && g.sliding.as_ref().map(|x| x.contact) == h.sliding.as_ref().map(|x| x.contact);
                prop_assert!(same, "{}: {}..{}\n{}", p.name, f(&d), g.phase, s.to_toml());
            }
        }
    }
}

/// The generator never starts in penetration.
#[test]
fn scenes_start_free() {
    for seed in 0..count(2000) as u64 {
        assert!(starts_free(&random_scene(&Recipe::draw(seed))));
    }
}
