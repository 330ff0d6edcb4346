//! F as a result: the two ways to it name one boundary, its boundary obeys Euler's relation, it does not
//! depend on how the scene is listed, and what it says of a configuration is what the polygons say.

#![allow(clippy::unwrap_used)]

#[path = "common/clear.rs"]
mod clear;
mod common;
#[path = "common/world/mod.rs"]
mod world;

use clear::{clear, solids};
use common::count;
use snapfit::contact::Chart;
use snapfit::contact::{ObstacleShape, PawlShape};
use snapfit::face::Method as Way;
use snapfit::motion::friction::regions;
use snapfit::motion::{Angle, EventKind, Method, Options, Seen, simulate, slices};
use snapfit::number::Rat;
use snapfit::report::slice::SliceDocument;
use snapfit::scene::{Motion, Scene};
use snapfit::slice::{Configuration, Free, Shape, Slice, Time, Whereabouts};
use std::collections::HashMap;
use std::rc::Rc;
use world::rng::Rng;
use world::scenes::{Recipe, random_scene};

/// Every slice of random scenes that has an F.
fn each(n: usize, first: u64, see: &mut dyn FnMut(u64, &Scene, Seen)) {
    for seed in (0..n as u64).map(|k| first + world::first_seed() + k) {
        let scene = random_scene(&Recipe::draw(seed));
        slices(&scene, &Options::default(), &mut |s: Seen| {
            if s.free.is_some() {
                see(seed, &scene, s);
            }
        })
        .unwrap();
    }
}

fn document(scene: &Scene, seen: &Seen) -> serde_json::Value {
    serde_json::to_value(SliceDocument::new(scene, seen)).unwrap()
}

/// DP Lemma 9.2: by merges from leaves of one arc, of three, of many, F is what the walk finds, name by name.
#[test]
fn merges_and_the_walk_name_one_boundary() {
    let (mut slices, mut merges, mut edges) = (0, 0, 0);
    each(count(20_000), 10_000_000, &mut |seed, scene, mut seen| {
        let walked = seen.free.clone().unwrap();
        let told = boundary(scene, &seen);
        for leaf in [1, 3, 20] {
            let merged = Free::with_leaf(&seen.slice, walked.start(), Way::Merge, leaf);
            let merged = merged.unwrap_or_else(|| panic!("seed {seed}: no F by merges"));
            merges += merged.found().merges;
            assert_eq!(merged.found().method, Way::Merge);
            seen.free = Some(Rc::new(merged));
            let other = boundary(scene, &seen);
            assert!(
                told == other,
                "seed {seed}, phase {}, leaf {leaf}: {}\n{}",
                seen.phase,
                told.unlike(&other),
                scene.to_toml()
            );
        }
        slices += 1;
        edges += walked.edges().len();
    });
    eprintln!("{slices} slices, {merges} merges, {edges} edges");
    assert!(merges > slices);
}

/// Euler's relation for one face. F is connected, so on the sphere that closes the cylinder every connected
/// piece of its boundary is walked in exactly one cycle; and each piece, a graph of V vertices and E edges, has
/// E − V + 2 faces, F among them, so never fewer than one.
#[test]
fn every_piece_of_the_boundary_is_one_cycle() {
    let mut pieces = 0;
    each(count(20_000), 11_000_000, &mut |seed, _, seen| {
        let f = seen.free.unwrap();
        let mut parent: Vec<usize> = (0..f.vertices().len()).collect();
        fn root(p: &mut [usize], mut x: usize) -> usize {
            while p[x] != x {
                p[x] = p[p[x]];
                x = p[x];
            }
            x
        }
        for e in f.edges() {
            let (a, b) = (
                root(&mut parent, e.low as usize),
                root(&mut parent, e.high as usize),
            );
            parent[a] = b;
        }
        // V − E + 1 a piece, by its root; and the cycles that walk it.
        let mut euler: HashMap<usize, i64> = HashMap::new();
        let mut cycles: HashMap<usize, u32> = HashMap::new();
        for v in 0..parent.len() {
            *euler.entry(root(&mut parent, v)).or_insert(1) += 1;
        }
        for e in f.edges() {
            *euler.get_mut(&root(&mut parent, e.low as usize)).unwrap() -= 1;
        }
        for c in 0..f.cycles() {
            let (e, _) = f.cycle(c).next().unwrap();
            let v = f.edges()[e as usize].low as usize;
            *cycles.entry(root(&mut parent, v)).or_insert(0) += 1;
        }
        assert_eq!(
            cycles.len(),
            euler.len(),
            "seed {seed}: each piece is walked"
        );
        for (piece, n) in cycles {
            assert_eq!(n, 1, "seed {seed}: a piece is walked once");
            assert!(euler[&piece] <= 2, "seed {seed}: it has a face");
            pieces += 1;
        }
    });
    assert!(pieces > 50);
}

/// F without its numbering: its vertices with all their contacts, its edges by the places that they join, and its
/// cycles from the least edge on.
#[derive(PartialEq)]
struct Told {
    vertices: Vec<String>,
    edges: Vec<String>,
    cycles: Vec<Vec<String>>,
}

impl Told {
    /// What one has and the other has not.
    fn unlike(&self, o: &Told) -> String {
        let only = |a: &[String], b: &[String]| -> Vec<String> {
            a.iter().filter(|x| !b.contains(x)).cloned().collect()
        };
        format!(
            "vertices {:#?} {:#?} edges {:#?} {:#?} cycles {} {}",
            only(&self.vertices, &o.vertices),
            only(&o.vertices, &self.vertices),
            only(&self.edges, &o.edges),
            only(&o.edges, &self.edges),
            self.cycles.len(),
            o.cycles.len()
        )
    }
}

/// With contacts and curves, or (`bare`) places and sides alone: of overlapping contacts the first one's are told, and
/// which one is first is the listing's affair.
fn told(scene: &Scene, seen: &Seen, bare: bool) -> Told {
    let doc = document(scene, seen);
    let free = &doc["free"];
    let list = |key: &str| free[key].as_array().unwrap();
    let place = |v: &serde_json::Value| {
        let v = &free["vertices"][v.as_u64().unwrap() as usize];
        format!("{}@{}", v["tan_half"], v["time"])
    };
    let edge = |e: &serde_json::Value| {
        let mut text = format!("{}-{} {}", place(&e["from"]), place(&e["to"]), e["free"]);
        if !bare {
            text += &format!(
                " {} {} {} {}",
                e["kind"], e["curve"], e["branch"], e["contact"]
            );
        }
        text
    };
    let names: Vec<String> = list("edges").iter().map(edge).collect();
    let cycle = |c: &serde_json::Value| {
        let half = |h: &serde_json::Value| {
            let h = h.as_i64().unwrap();
            format!("{}{}", names[h.unsigned_abs() as usize - 1], h.signum())
        };
        let mut walk: Vec<String> = c.as_array().unwrap().iter().map(half).collect();
        let least = (0..walk.len()).min_by_key(|&i| walk[i].clone()).unwrap();
        walk.rotate_left(least);
        walk
    };
    let vertex = |v: &serde_json::Value| match bare {
        true => format!("{}@{}", v["tan_half"], v["time"]),
        false => v.to_string(),
    };
    let mut t = Told {
        vertices: list("vertices").iter().map(vertex).collect(),
        cycles: list("cycles").iter().map(cycle).collect(),
        edges: names.clone(),
    };
    t.vertices.sort();
    t.edges.sort();
    t.cycles.sort();
    t
}

fn boundary(scene: &Scene, seen: &Seen) -> Told {
    told(scene, seen, false)
}

/// Obstacles in another order, rings begun elsewhere and listed the other way round: the same F.
#[test]
fn f_does_not_depend_on_the_listing() {
    let mut checked = 0;
    each(count(10_000), 12_000_000, &mut |seed, scene, seen| {
        let mut other = scene.clone();
        let mut r = Rng::new(seed);
        other.obstacles.reverse();
        for o in &mut other.obstacles {
            for ring in std::iter::once(&mut o.vertices).chain(&mut o.holes) {
                let by = r.range(0, ring.len() as i64 - 1) as usize;
                ring.rotate_left(by);
                if r.chance(50) {
                    ring.reverse();
                }
            }
        }
        let vertices = &mut other.pawls[seen.pawl].vertices;
        let by = r.range(0, vertices.len() as i64 - 1) as usize;
        vertices.rotate_left(by);
        let first = told(scene, &seen, true);
        for face in [Way::Walk, Way::Merge] {
            let options = Options {
                face,
                ..Options::default()
            };
            slices(&other, &options, &mut |s: Seen| {
                if (s.phase, s.pawl) == (seen.phase, seen.pawl) {
                    let again = told(&other, &s, true);
                    assert!(first == again, "seed {seed}\n{}", scene.to_toml());
                    checked += 1;
                }
            })
            .unwrap();
        }
    });
    eprintln!("{checked} listed anew");
    assert!(checked > 50);
}

fn draw(r: &mut Rng, slice: &Slice) -> Configuration {
    Configuration {
        chart: *r.pick(&Chart::BOTH),
        x: Rat::frac(r.range(-99_990, 99_990), 100_003),
        t: &slice.frame.duration * &Rat::frac(r.range(1, 99_999), 100_019),
    }
}

/// Membership by the polygon test, at 10⁵ and more random rational points (times `TEST_MULT`): inside of F the
/// pawl is clear; a clear place outside of F lies in a component of its own, which F's start is not in.
#[test]
fn membership_is_what_the_polygons_say() {
    let (mut points, mut inside, mut blocked, mut elsewhere) = (0, 0, 0, 0);
    each(count(25_000), 13_000_000, &mut |seed, scene, seen| {
        let f = seen.free.as_ref().unwrap();
        let solids = solids(scene);
        let mut r = Rng::new(seed);
        for k in 0..25 {
            let c = draw(&mut r, &seen.slice);
            let says = f.locate(&c);
            let clear = clear(scene, &solids, seen.pawl, &seen.slice, &c);
            points += 1;
            let story = || {
                format!(
                    "seed {seed} phase {} {c:?}\n{}",
                    seen.phase,
                    scene.to_toml()
                )
            };
            match (says, clear) {
                (Whereabouts::Inside, _) => {
                    inside += 1;
                    assert!(clear, "{}", story());
                }
                (Whereabouts::Outside, false) => blocked += 1,
                (Whereabouts::Outside, true) if k < 5 => {
                    elsewhere += 1;
                    let other = Free::new(&seen.slice, &c, Way::Auto);
                    let other = other.unwrap_or_else(|| panic!("{}", story()));
                    assert_eq!(other.locate(&c), Whereabouts::Inside, "{}", story());
                    assert_eq!(other.locate(f.start()), Whereabouts::Outside, "{}", story());
                }
                _ => {}
            }
        }
    });
    eprintln!("{points} points: {inside} in F, {blocked} blocked, {elsewhere} free elsewhere");
    assert!(points >= count(100_000) && inside > 100 && blocked > 100);
}

/// The free intervals at a time by the polygon test: the middle of each is clear and in F, its ends are contacts, and
/// between two of them something stands in the way.
#[test]
fn intervals_are_what_the_polygons_say() {
    let (mut found, mut gaps) = (0, 0);
    each(count(20_000), 14_000_000, &mut |seed, scene, seen| {
        check_intervals(seed, scene, &seen, &mut found, &mut gaps);
    });
    eprintln!("{found} intervals, {gaps} gaps");
    assert!(found > 50 && gaps > 20);
}

/// At the start of a phase, and wherever an arc's end falls on a rational instant, the intervals just after it are those
/// a little later, before any other arc begins or ends: as many, and as near as the time is.
#[test]
fn intervals_right_after_an_instant_are_those_a_little_later() {
    let (mut starts, mut joints, mut whole) = (0, 0, 0);
    each(count(20_000), 15_000_000, &mut |seed, _, seen| {
        let f = seen.free.as_ref().unwrap();
        let mut times = vec![(Rat::zero(), true)];
        let ends = (0..f.vertices().len() as u32).filter_map(|v| f.place(v).2.as_rat().cloned());
        times.extend(ends.take(4).map(|t| (t, false)));
        for (t, start) in times {
            if t >= *f.duration() {
                continue;
            }
            let little = &t + &(f.duration() - &t) * &Rat::frac(1, 1 << 40);
            let between = (0..f.vertices().len() as u32).any(|v| {
                let (from, to) = (Time::from(t.clone()), Time::from(little.clone()));
                f.cmp_time(v, &from).is_gt() && f.cmp_time(v, &to).is_le()
            });
            if between {
                continue;
            }
            if start {
                starts += 1;
            } else {
                joints += 1;
            }
            let edges = |t: &Rat| {
                f.intervals(&seen.slice, t)
                    .map(|l| l.iter().map(|i| (i.low.0, i.high.0)).collect::<Vec<_>>())
            };
            let (now, then) = (edges(&t), edges(&little));
            whole += u32::from(now.is_none());
            assert_eq!(now, then, "seed {seed}, t = {t}");
            // And by one orientation at a time a little later.
            let c = Configuration {
                t: little.clone(),
                ..draw(&mut Rng::new(seed), &seen.slice)
            };
            if now.is_none() {
                assert_eq!(f.locate(&c), Whereabouts::Inside, "seed {seed}, t = {t}");
            } else if now.is_some_and(|n| n.is_empty()) {
                assert_ne!(f.locate(&c), Whereabouts::Inside, "seed {seed}, t = {t}");
            }
        }
    });
    eprintln!("{starts} starts, {joints} other instants, {whole} with the whole circle free");
    assert!(starts > 20 && whole > 5);
}

/// An interval that ends on the cut, at a level whose arc is named in the other chart.
#[test]
fn a_level_on_the_cut_ends_the_last_interval() {
    let seed = 14_088_516;
    let (mut found, mut gaps) = (0, 0);
    let scene = random_scene(&Recipe::draw(seed));
    slices(&scene, &Options::default(), &mut |s: Seen| {
        if s.free.is_some() {
            check_intervals(seed, &scene, &s, &mut found, &mut gaps);
        }
    })
    .unwrap();
    assert!(found >= 2 && gaps >= 2);
}

fn check_intervals(seed: u64, scene: &Scene, seen: &Seen, found: &mut usize, gaps: &mut usize) {
    let f = seen.free.as_ref().unwrap();
    let solids = solids(scene);
    let mut r = Rng::new(seed);
    let t = draw(&mut r, &seen.slice).t;
    let Some(list) = f.intervals(&seen.slice, &t) else {
        for _ in 0..5 {
            let c = Configuration {
                t: t.clone(),
                ..draw(&mut r, &seen.slice)
            };
            assert_eq!(f.locate(&c), Whereabouts::Inside, "seed {seed}");
        }
        return;
    };
    let strip = |(e, x): &(u32, snapfit::number::Algebraic)| {
        let i = x.interval();
        i.lo.midpoint(i.hi) + 2.0 * f.edges()[*e as usize].chart().index() as f64
    };
    let at = |m: f64| {
        let m = if m > 3.0 { m - 4.0 } else { m };
        let (chart, x) = if m <= 1.0 {
            (Chart::Rest, m)
        } else {
            (Chart::Back, m - 2.0)
        };
        Configuration {
            chart,
            x: Rat::from_f64(x),
            t: t.clone(),
        }
    };
    let ends: Vec<(f64, f64)> = list
        .iter()
        .map(|i| {
            let (lo, hi) = (strip(&i.low), strip(&i.high));
            (lo, if hi < lo { hi + 4.0 } else { hi })
        })
        .collect();
    for (i, &(lo, hi)) in ends.iter().enumerate() {
        if hi - lo > 1e-9 {
            *found += 1;
            let c = at(lo.midpoint(hi));
            assert_eq!(f.locate(&c), Whereabouts::Inside, "seed {seed} {c:?}");
            assert!(
                clear(scene, &solids, seen.pawl, &seen.slice, &c),
                "seed {seed} {c:?}"
            );
        }
        let next = match ends.get(i + 1) {
            Some(n) => n.0,
            None => ends[0].0 + 4.0,
        };
        if next - hi > 1e-9 {
            *gaps += 1;
            let c = at(hi.midpoint(next));
            assert_ne!(f.locate(&c), Whereabouts::Inside, "seed {seed} {c:?}");
        }
    }
}

/// DP §9.3 (with errata 5): a t-monotone arc has at most three regions in which it sticks or slides, they follow
/// each other, and they alternate.
#[test]
fn an_arc_has_at_most_three_regions() {
    let mut most = [0usize; 4];
    let frictions = [Rat::frac(1, 5), Rat::one(), Rat::from(4)];
    each(count(10_000), 15_000_000, &mut |seed, _, seen| {
        let arcs = seen.slice.arcs();
        for (id, arc) in arcs.iter().enumerate() {
            if arc.shape == Shape::Wall {
                continue;
            }
            for mu in &frictions {
                let found = regions(&seen.slice, id as u32, Some(mu));
                assert!((1..=3).contains(&found.len()), "seed {seed} arc {id}");
                most[found.len()] += 1;
                assert!(found[0].from == arc.start().t && found[found.len() - 1].to == arc.end().t);
                for w in found.windows(2) {
                    assert!(w[0].to == w[1].from && w[0].sticks != w[1].sticks);
                }
            }
        }
    });
    eprintln!("arcs of one, two and three regions: {:?}", &most[1..]);
    assert!(most[1] > 100 && most[2] > 10 && most[3] > 0);
}

/// A reversed phase by turning the slice and F round in time: the boundary that a slice built from the contacts of
/// the reversed phase has, edge by edge, vertex by vertex with all its contacts.
#[test]
fn turned_round_is_built_anew() {
    let (mut checked, mut refused) = (0, 0);
    each(count(10_000), 17_000_000, &mut |seed, scene, seen| {
        let pawl = &scene.pawls[seen.pawl];
        let Some(turned) = seen.slice.reversed(pawl.limits.as_ref()) else {
            refused += 1;
            return;
        };
        let turned = Rc::new(turned);
        let free = seen.free.as_ref().unwrap().reversed(&turned).unwrap();
        let obstacles: Vec<ObstacleShape> =
            scene.obstacles.iter().map(ObstacleShape::new).collect();
        let fresh = Slice::new(
            turned.frame.clone(),
            &PawlShape::new(pawl),
            &obstacles,
            pawl.limits.as_ref(),
        );
        let anew = Free::new(&fresh, free.start(), Way::Walk);
        let anew = anew.unwrap_or_else(|| panic!("seed {seed}"));
        let with = |slice: Rc<Slice>, free: Free| Seen {
            phase: seen.phase,
            pawl: seen.pawl,
            slice,
            free: Some(Rc::new(free)),
            start: seen.start.clone(),
        };
        let (turned, anew) = (with(turned, free), with(Rc::new(fresh), anew));
        assert!(
            boundary(scene, &turned) == boundary(scene, &anew),
            "seed {seed}\n{}",
            scene.to_toml()
        );
        checked += 1;
    });
    eprintln!("{checked} turned round, {refused} refused");
    assert!(checked > 30 && refused * 20 < checked);
}

/// A plan that goes there and back builds one slice and one F a pawl, and tells what the scan tells.
#[test]
fn there_and_back_builds_once() {
    let (mut there, mut back) = (0, 0);
    for seed in (0..count(10_000) as u64).map(|k| 18_000_000 + world::first_seed() + k) {
        let mut scene = random_scene(&Recipe::draw(seed));
        scene.motions.truncate(1);
        scene.motions.push(Motion::Reverse);
        let run = |method| {
            let options = Options {
                method,
                ..Options::default()
            };
            simulate(&scene, &options).unwrap()
        };
        let (sweep, naive) = (run(Method::Sweep), run(Method::Naive));
        assert_eq!(sweep.pawls.len(), naive.pawls.len());
        for (a, b) in sweep.pawls.iter().zip(&naive.pawls) {
            assert_eq!(a.events.len(), b.events.len(), "seed {seed}");
            for (a, b) in a.events.iter().zip(&b.events) {
                assert!(
                    a.kind == b.kind && a.time == b.time && a.contacts == b.contacts,
                    "seed {seed}"
                );
            }
        }
        if let [first, second] = sweep.ledger.phases.as_slice() {
            let pawls = scene.pawls.len() as u64;
            if first.swept == pawls {
                assert_eq!((first.slices, second.slices), (pawls, 0), "seed {seed}");
                there += first.faces.walked + first.faces.merged;
                back += second.faces.reused;
            }
            assert_eq!(naive.ledger.phases[1].slices, pawls);
        }
    }
    eprintln!("{there} made on the way there, {back} used again on the way back");
    assert!(there > 10 && 2 * back > there);
}

/// From any other start on the slice and F that are there: what a simulation of the scene with that start tells.
#[test]
fn another_start_needs_no_other_f() {
    let (mut runs, mut reused, mut events) = (0, 0, 0);
    each(count(10_000), 19_000_000, &mut |seed, scene, seen| {
        if seen.phase > 0 {
            return;
        }
        let mut r = Rng::new(seed);
        for _ in 0..4 {
            let u = Rat::frac(r.range(-300, 300), 97);
            if !seen.may_start(scene, &u) {
                continue;
            }
            let start: Angle = Angle::from_tan_half(&u);
            let run = seen.run_from(scene, &start, Method::Sweep);
            let mut other = scene.clone();
            other.root = None;
            other.pawls = vec![scene.pawls[seen.pawl].clone()];
            other.pawls[0].start = u.clone();
            other.motions = vec![Motion::Translate {
                velocity: seen.slice.frame.v.clone(),
                duration: Some(seen.slice.frame.duration.clone()),
                until_root_collision: false,
            }];
            let options = Options {
                method: Method::Naive,
                ..Options::default()
            };
            let whole = simulate(&other, &options).unwrap();
            let told: Vec<_> = whole.pawls[0]
                .events
                .iter()
                .filter(|e| !matches!(e.kind, EventKind::PhaseEnd | EventKind::PlanEnd))
                .collect();
            let story = || format!("seed {seed} from {u}\n{}", scene.to_toml());
            assert_eq!(run.events.len(), told.len(), "{}", story());
            for (a, b) in run.events.iter().zip(told) {
                assert!(
                    a.kind == b.kind
                        && a.time == b.time
                        && a.contacts == b.contacts
                        && a.angle.half_turn == b.angle.half_turn
                        && a.angle.x == b.angle.x,
                    "{}",
                    story()
                );
                events += 1;
            }
            let segments = &whole.pawls[0].segments;
            assert_eq!(run.segments.len(), segments.len(), "{}", story());
            for (a, b) in run.segments.iter().zip(segments) {
                assert!(a.from == b.from && a.to == b.to, "{}", story());
            }
            match &run.end {
                Some((kind, at, _)) => {
                    assert!(*kind == whole.outcome.kind && *at == whole.outcome.time);
                }
                None => assert_eq!(whole.outcome.kind.name(), "completed"),
            }
            runs += 1;
            reused += u64::from(run.faces.reused > 0);
        }
    });
    eprintln!("{runs} runs, {reused} with the F that was there, {events} events");
    assert!(runs > 30 && reused > 20 && reused < runs);
}
