//! F, the free component of a slice, and the sweep over it.
//!
//! The sweep against the simple algorithm, as JSON to the byte; F against a flood of the whole
//! arrangement that samples doubles and says where it is in doubt; membership against the
//! polygon test; and F as a thing: cycles that close, sides that agree with the contacts.

#![allow(clippy::unwrap_used)]

#[path = "common/clear.rs"]
mod clear;
mod common;
#[path = "common/world/mod.rs"]
mod world;

use clear::{clear, solids};
use common::count;
use snapfit::contact::Chart;
use snapfit::motion::{Arithmetic, Method, Options, Seen, simulate, slices};
use snapfit::number::Rat;
use snapfit::report::json::{Provenance, ResultDocument};
use snapfit::scene::Scene;
use snapfit::slice::{Configuration, Free, Owner, Shape, Side, Slice, Whereabouts};
use world::rng::Rng;
use world::scenes::{Recipe, random_scene};

/// The doubles that a snap goes by: where they say an arc is, there it is, also in phases that run backwards.
#[test]
fn positions_in_doubles_hold_the_exact_ones() {
    let (mut seen, mut narrow) = (0, 0);
    for seed in (0..count(20_000) as u64).map(|k| 8_500_000 + world::first_seed() + k) {
        let scene = random_scene(&Recipe::draw(seed));
        slices(&scene, &Options::default(), &mut |s: Seen| {
            let (slice, mut r) = (&s.slice, Rng::new(seed));
            let ids = 0..slice.arcs().len() as u32;
            for id in ids.filter(|&id| matches!(slice.arc(id).shape, Shape::Graph { .. })) {
                let arc = slice.arc(id);
                let t = &slice.frame.duration * &Rat::frac(r.range(1, 99_999), 100_019);
                if arc.start().t.cmp_rat(&t).is_gt() || arc.end().t.cmp_rat(&t).is_lt() {
                    continue;
                }
                let about = slice.position_about(id, t.interval());
                let x = slice.height_at(arc, &t).unwrap();
                let [lo, hi] = [about.lo, about.hi].map(Rat::from_f64);
                assert!(
                    x.cmp_rat(&lo).is_ge() && x.cmp_rat(&hi).is_le(),
                    "seed {seed}, arc {id} at {t}: {about:?}"
                );
                seen += 1;
                narrow += usize::from(about.width() < 1e-9);
            }
        })
        .unwrap();
    }
    eprintln!("{narrow} of {seen} are narrow");
    assert!(seen > 100 && 10 * narrow > 9 * seen);
}

/// The result of a method as text, without what it cost, and how many runs were swept.
fn told(scene: &Scene, method: Method, arithmetic: Arithmetic) -> (String, u64) {
    let options = Options {
        method,
        arithmetic,
        ..Options::default()
    };
    let t = simulate(scene, &options).unwrap();
    let how = Provenance {
        arithmetic: "filtered",
        method: Method::Naive,
    };
    let swept = t.ledger.phases.iter().map(|p| p.swept).sum();
    let doc = ResultDocument::new(scene, &t, how);
    let mut doc = serde_json::to_value(&doc).unwrap();
    doc.as_object_mut().unwrap().remove("ledger");
    (serde_json::to_string_pretty(&doc).unwrap(), swept)
}

/// DP §9: both algorithms, one answer, to the byte.
#[test]
fn the_sweep_tells_what_the_scan_tells() {
    let n = count(100_000) as u64;
    let (mut swept, mut reference) = (0, 0);
    let mut wrong = Vec::new();
    for seed in (0..n).map(|k| 7_000_000 + world::first_seed() + k) {
        let scene = random_scene(&Recipe::draw(seed));
        let all = std::panic::catch_unwind(|| {
            let filtered = |method| told(&scene, method, Arithmetic::Filtered);
            let naive = filtered(Method::Naive).0;
            let mut sweeps = vec![filtered(Method::Sweep)];
            // The reference is slow.
            if seed % 10 == 0 {
                sweeps.push(told(&scene, Method::Sweep, Arithmetic::Exact));
            }
            (naive, sweeps)
        });
        match all {
            Ok((naive, sweeps)) => {
                swept += sweeps[0].1;
                reference += sweeps.get(1).map_or(0, |s| s.1);
                for (sweep, _) in sweeps.iter().filter(|s| s.0 != naive) {
                    let first = naive.lines().zip(sweep.lines()).find(|(a, b)| a != b);
                    let toml = scene.to_toml();
                    eprintln!("seed {seed} differs: {first:?}\n{toml}");
                    wrong.push(format!("seed {seed} differs\n{toml}"));
                }
            }
            Err(_) => {
                let toml = scene.to_toml();
                eprintln!("seed {seed} panics\n{toml}");
                wrong.push(format!("seed {seed} panics\n{toml}"));
            }
        }
    }
    eprintln!("{n} scenes, {swept} runs swept, {reference} by the reference");
    assert!(
        wrong.is_empty(),
        "{} of {n}: {}",
        wrong.len(),
        wrong[..wrong.len().min(3)].join("\n")
    );
    assert!(swept >= n && 10 * reference >= n, "the sweep ran");
}

/// Every slice of random scenes that has an F.
fn each_free(n: usize, first: u64, see: &mut dyn FnMut(u64, &Scene, &Slice, &Free, usize)) {
    for seed in (0..n as u64).map(|k| first + world::first_seed() + k) {
        let scene = random_scene(&Recipe::draw(seed));
        slices(&scene, &Options::default(), &mut |s: Seen| {
            if let Some(f) = &s.free {
                see(seed, &scene, &s.slice, f, s.pawl);
            }
        })
        .unwrap();
    }
}

fn draw(r: &mut Rng, slice: &Slice) -> Configuration {
    Configuration {
        chart: *r.pick(&Chart::BOTH),
        x: Rat::frac(r.range(-99_990, 99_990), 100_003),
        t: &slice.frame.duration * &Rat::frac(r.range(1, 99_999), 100_019),
    }
}

/// What lies in F is free, and what F's boundary separates from it by one arc is as the side says.
#[test]
fn members_are_free() {
    let (mut inside, mut outside) = (0, 0);
    each_free(
        count(10_000),
        8_000_000,
        &mut |seed, scene, slice, free, pawl| {
            let mut r = Rng::new(seed);
            for _ in 0..40 {
                let c = draw(&mut r, slice);
                match free.locate(&c) {
                    Whereabouts::Inside => {
                        inside += 1;
                        assert!(
                            clear(scene, &solids(scene), pawl, slice, &c),
                            "seed {seed} {c:?}\n{}",
                            scene.to_toml()
                        );
                    }
                    Whereabouts::Outside => outside += 1,
                    Whereabouts::Boundary => {}
                }
            }
        },
    );
    eprintln!("{inside} in F, {outside} outside");
    assert!(inside > 100 && outside > 100);
}

/// The cycles close, every side of every edge is walked once, and the sides are those that the contacts leave
/// free.
#[test]
fn the_boundary_is_one() {
    let mut edges = 0;
    each_free(count(10_000), 8_000_000, &mut |seed, _, slice, free, _| {
        let mut sides = vec![[false; 2]; free.edges().len()];
        for c in 0..free.cycles() {
            let cycle: Vec<(u32, bool)> = free.cycle(c).collect();
            for (i, &(e, forward)) in cycle.iter().enumerate() {
                let (f, onward) = cycle[(i + 1) % cycle.len()];
                let (e1, f1) = (&free.edges()[e as usize], &free.edges()[f as usize]);
                let to = if forward { e1.high } else { e1.low };
                let from = if onward { f1.low } else { f1.high };
                assert_eq!(to, from, "seed {seed}: a cycle goes on where it came to");
                assert!(!std::mem::replace(
                    &mut sides[e as usize][usize::from(forward)],
                    true
                ));
            }
        }
        for (e, s) in free.edges().iter().zip(&sides) {
            edges += 1;
            let walked = usize::from(s[0]) + usize::from(s[1]);
            assert_eq!(
                walked,
                usize::from(e.above) + usize::from(e.below),
                "seed {seed}"
            );
            assert!(walked > 0);
            let Owner::Arc(a) = e.owner else { continue };
            if matches!(e.shape(), Shape::Wall) {
                continue;
            }
            match slice.arc(a).side {
                Side::Above => assert!(e.above, "seed {seed}: F lies on the free side"),
                Side::Below => assert!(e.below, "seed {seed}: F lies on the free side"),
                Side::Neither | Side::Both | Side::Before | Side::After => {}
            }
        }
    });
    assert!(edges > 1000);
}

/// The cells of L(t) at a rational time: lower and upper ends on the strip, and whether free.
fn cells(
    scene: &Scene,
    pawl: usize,
    slice: &Slice,
    t: &Rat,
) -> Vec<(f64, f64, Configuration, bool)> {
    let mut at: Vec<(Chart, Rat)> = Vec::new();
    let f = |x: &snapfit::number::Algebraic| {
        let i = x.interval();
        Rat::from_f64((i.lo + i.hi) / 2.0)
    };
    for a in slice.arcs().iter().filter(|a| a.is_barrier()) {
        let s = a.start().t.cmp_rat(t);
        if s.is_ge() || a.end().t.cmp_rat(t).is_le() {
            continue;
        }
        if let Some(x) = slice.height_at(a, t) {
            at.push((a.chart, f(&x)));
        }
    }
    at.sort();
    at.dedup();
    let strip = |p: &(Chart, Rat)| p.1.nearest_f64().unwrap() + 2.0 * p.0.index() as f64;
    let mut out = Vec::new();
    let n = at.len();
    for i in 0..n {
        let lo = strip(&at[i]);
        let hi = if i + 1 < n {
            strip(&at[i + 1])
        } else {
            strip(&at[0]) + 4.0
        };
        let mid = (lo + hi) / 2.0;
        let m = if mid > 3.0 { mid - 4.0 } else { mid };
        let (chart, x) = if m <= 1.0 {
            (Chart::Rest, m)
        } else {
            (Chart::Back, m - 2.0)
        };
        let c = Configuration {
            chart,
            x: Rat::from_f64(x),
            t: t.clone(),
        };
        let free = hi - lo > 1e-9 && clear(scene, &solids(scene), pawl, slice, &c);
        out.push((lo, hi, c, free));
    }
    if n == 0 {
        let c = Configuration {
            chart: Chart::Rest,
            x: Rat::frac(1, 7919),
            t: t.clone(),
        };
        let free = clear(scene, &solids(scene), pawl, slice, &c);
        out.push((-1.0, 3.0, c, free));
    }
    out
}

/// F against a flood of the whole arrangement: slabs between all critical times, their free cells by
/// the polygon test, joined where they overlap from one slab to the next. Doubtful overlaps let the slice pass.
#[test]
fn the_flood_reaches_what_f_holds() {
    let (mut checked, mut doubtful, mut members) = (0, 0, 0);
    each_free(
        count(20_000),
        9_000_000,
        &mut |seed, scene, slice, free, pawl| {
            if slice.arcs().len() > 60 {
                return;
            }
            let end = slice.frame.duration.nearest_f64().unwrap();
            let mut times = vec![0.0, end];
            let mid = |t: &snapfit::slice::Time| {
                let i = t.interval();
                (i.lo + i.hi) / 2.0
            };
            let arcs: Vec<_> = slice.arcs().iter().filter(|a| a.is_barrier()).collect();
            for (i, a) in arcs.iter().enumerate() {
                times.extend([mid(&a.lo.t), mid(&a.hi.t)]);
                for b in &arcs[..i] {
                    if a.chart == b.chart && a.curve != b.curve {
                        times.extend(
                            slice
                                .crossings(a.curve, b.curve, a.chart)
                                .iter()
                                .map(|c| mid(&c.t)),
                        );
                    }
                    // A level and a graph.
                    for (g, l) in [(a, b), (b, a)] {
                        if g.chart == l.chart
                            && l.shape == Shape::Level
                            && matches!(g.shape, Shape::Graph { .. })
                            && g.spans_x(&l.lo.x)
                        {
                            times.push(mid(&slice.time_at(g, &l.lo.x)));
                        }
                    }
                }
            }
            times.retain(|t| (0.0..=end).contains(t));
            times.sort_by(f64::total_cmp);
            times.dedup_by(|b, a| *b - *a < 1e-9 * end);
            if times.windows(2).any(|w| w[1] - w[0] < 1e-5 * end) {
                doubtful += 1;
                return;
            }
            // Cells of every slab at its two ends (just inside) name one another in order.
            let mut slabs = Vec::new();
            for w in times.windows(2) {
                let eps = (w[1] - w[0]) * 1e-9;
                let at = |t: f64| cells(scene, pawl, slice, &Rat::from_f64(t));
                let (a, m, b) = (at(w[0] + eps), at((w[0] + w[1]) / 2.0), at(w[1] - eps));
                if a.len() != m.len() || b.len() != m.len() {
                    doubtful += 1;
                    return;
                }
                slabs.push((a, m, b));
            }
            let mut ids = Vec::new();
            let mut parent: Vec<usize> = Vec::new();
            for s in &slabs {
                ids.push(parent.len());
                parent.extend(parent.len()..parent.len() + s.1.len());
            }
            fn root(p: &mut [usize], mut x: usize) -> usize {
                while p[x] != x {
                    p[x] = p[p[x]];
                    x = p[x];
                }
                x
            }
            for k in 1..slabs.len() {
                let t = times[k];
                let walls: Vec<(f64, f64)> = arcs
                    .iter()
                    .filter(|a| a.shape == Shape::Wall && (mid(&a.lo.t) - t).abs() < 1e-8 * end)
                    .map(|a| {
                        let s = 2.0 * a.chart.index() as f64;
                        (a.x_span.lo + s, a.x_span.hi + s)
                    })
                    .collect();
                for (i, p) in slabs[k - 1].2.iter().enumerate() {
                    for (j, q) in slabs[k].0.iter().enumerate() {
                        if !slabs[k - 1].1[i].3 || !slabs[k].1[j].3 {
                            continue;
                        }
                        // What walls leave of the overlap.
                        let mut width: f64 = 0.0;
                        for turn in [-4.0, 0.0, 4.0] {
                            let (lo, hi) = (p.0.max(q.0 + turn), p.1.min(q.1 + turn));
                            let mut cuts = vec![lo, hi];
                            for w in &walls {
                                for s in [-4.0, 0.0, 4.0] {
                                    cuts.extend([w.0 + s, w.1 + s]);
                                }
                            }
                            cuts.retain(|c| *c >= lo && *c <= hi);
                            cuts.sort_by(f64::total_cmp);
                            for c in cuts.windows(2) {
                                let m = (c[0] + c[1]) / 2.0;
                                let walled = walls.iter().any(|w| {
                                    [-4.0, 0.0, 4.0].iter().any(|s| w.0 + s < m && m < w.1 + s)
                                });
                                if !walled {
                                    width = width.max(c[1] - c[0]);
                                }
                            }
                        }
                        if width > 1e-3 {
                            let (a, b) = (
                                root(&mut parent, ids[k - 1] + i),
                                root(&mut parent, ids[k] + j),
                            );
                            parent[a] = b;
                        } else if width > 1e-12 {
                            doubtful += 1;
                            return;
                        }
                    }
                }
            }
            // One class of cells is F, all of it.
            let mut f_class = None;
            let mut wide = Vec::new();
            for (k, s) in slabs.iter().enumerate() {
                for (i, c) in s.1.iter().enumerate() {
                    if c.3 && c.1 - c.0 > 1e-6 {
                        let class = root(&mut parent, ids[k] + i);
                        let inside = free.locate(&c.2) == Whereabouts::Inside;
                        members += usize::from(inside);
                        if inside {
                            let first = *f_class.get_or_insert(class);
                            assert_eq!(
                                first,
                                class,
                                "seed {seed}: F is connected\n{}",
                                scene.to_toml()
                            );
                        }
                        wide.push((class, inside));
                    }
                }
            }
            for (class, inside) in wide {
                assert_eq!(
                    Some(class) == f_class,
                    inside,
                    "seed {seed}: F holds all that the flood reaches\n{}",
                    scene.to_toml()
                );
            }
            checked += 1;
        },
    );
    eprintln!("{checked} slices flooded, {doubtful} in doubt, {members} cells in F");
    assert!(checked > doubtful / 4 && members > 20);
}
