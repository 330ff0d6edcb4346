//! The exact LP solver: random programs against an oracle that works quite differently
//! (Fourier–Motzkin elimination), from any start, within any limit (here), against those who cheat
//! (`certificates`), on programs with a known optimum (`classics`), and from files (`reading`).
//! `TEST_MULT` scales the random runs (1 is the full size).
#![allow(clippy::unwrap_used)]

mod certificates;
mod classics;
#[path = "../common/mod.rs"]
mod common;
mod reading;
#[path = "../common/world/rng.rs"]
mod rng;

use common::count;
use rng::Rng;
use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{Accuracy, Method, Model, Options, Outcome, Place, Range, Status, report, solve};
use snapfit::number::Rat;

/// A number from −3 to 3.
fn small(r: &mut Rng) -> i64 {
    r.range(-3, 3)
}

fn rat(v: i64) -> Rat {
    Rat::from(v)
}

fn random_model(r: &mut Rng) -> Model {
    let mut model = Model::new("random");
    model.maximise = r.below(2) == 0;
    let (n, m) = (r.below(4) as usize, r.below(5) as usize);
    let range = |r: &mut Rng, usual: Range| {
        let a = rat(small(r));
        let b = rat(small(r));
        match r.below(8) {
            0 => Range::free(),
            1 => Range::fixed(a),
            2 => Range::at_least(a),
            3 => Range::at_most(a),
            4 => Range {
                lower: Some(if a < b { a.clone() } else { b.clone() }),
                upper: Some(if a < b { b } else { a }),
            },
            _ => usual,
        }
    };
    for j in 0..n {
        let cost = Rat::frac(small(r), 1 + r.below(3) as i64);
        let range = range(r, Range::at_least(Rat::zero()));
        model.add_column(&format!("x{j}"), cost, range);
    }
    for i in 0..m {
        let bound = rat(small(r));
        let range = range(r, Range::at_most(bound));
        model.add_row(&format!("r{i}"), range);
        let copy = i > 0 && r.below(6) == 0; // redundant or contradictory rows
        for j in 0..n {
            let v = if copy {
                let old = model.columns[j]
                    .entries
                    .iter()
                    .find(|e| e.0 == i as u32 - 1);
                old.map_or(Rat::zero(), |e| e.1.clone())
            } else if r.below(3) > 0 {
                Rat::frac(small(r), 1 + r.below(2) as i64)
            } else {
                Rat::zero()
            };
            model.set(i, j, v);
        }
    }
    model
}

/// Least value of the objective by eliminating the columns one by one: None if infeasible,
/// Some(None) if it has no end.
fn oracle(model: &Model) -> Option<Option<Rat>> {
    let n = model.columns.len();
    // Rows a·(x, t) ≤ b; t is the objective, to be minimised.
    let mut rows: Vec<(Vec<Rat>, Rat)> = Vec::new();
    let mut bound = |a: Vec<Rat>, range: &Range| {
        if let Some(u) = &range.upper {
            rows.push((a.clone(), u.clone()));
        }
        if let Some(l) = &range.lower {
            rows.push((a.into_iter().map(|v| -v).collect(), -l));
        }
    };
    for (j, c) in model.columns.iter().enumerate() {
        let mut a = vec![Rat::zero(); n + 1];
        a[j] = Rat::one();
        bound(a, &c.range);
    }
    for (i, r) in model.rows.iter().enumerate() {
        let mut a = vec![Rat::zero(); n + 1];
        for (j, c) in model.columns.iter().enumerate() {
            for (k, v) in &c.entries {
                if *k == i as u32 {
                    a[j] = v.clone();
                }
            }
        }
        bound(a, &r.range);
    }
    let sign = rat(if model.maximise { -1 } else { 1 });
    let mut a: Vec<Rat> = model.columns.iter().map(|c| &c.cost * &sign).collect();
    a.push(rat(-1));
    bound(a, &Range::fixed(Rat::zero()));
    for j in 0..n {
        let (with, mut next): (Vec<_>, Vec<_>) = rows.into_iter().partition(|r| !r.0[j].is_zero());
        for p in with.iter().filter(|r| r.0[j].sign() > 0) {
            for q in with.iter().filter(|r| r.0[j].sign() < 0) {
                let (s, t) = (-&q.0[j], &p.0[j]);
                let mix = |x: &Rat, y: &Rat| &(x * &s) + &(y * t);
                let a: Vec<Rat> = p.0.iter().zip(&q.0).map(|(x, y)| mix(x, y)).collect();
                let b = mix(&p.1, &q.1);
                // Normalise, so that repeats are found.
                let size = a.iter().find(|v| !v.is_zero()).map_or(Rat::one(), Rat::abs);
                let row = (a.iter().map(|v| v / &size).collect(), &b / &size);
                if !next.contains(&row) {
                    next.push(row);
                }
            }
        }
        rows = next;
    }
    let mut least: Option<Rat> = None;
    let mut most: Option<Rat> = None;
    for (a, b) in rows {
        match a[n].sign() {
            0 if b.sign() < 0 => return None,
            0 => {}
            1 => {
                let v = &b / &a[n];
                most = Some(most.map_or(v.clone(), |m| if v < m { v } else { m }));
            }
            _ => {
                let v = &b / &a[n];
                least = Some(least.map_or(v.clone(), |m| if v > m { v } else { m }));
            }
        }
    }
    if matches!((&least, &most), (Some(l), Some(m)) if l > m) {
        return None;
    }
    Some(least.map(|l| &model.constant + &(l * sign)))
}

fn solved(model: &Model, method: Method) -> Outcome {
    let options = Options {
        method,
        ..Options::default()
    };
    let out = solve(model, &options);
    assert_ne!(out.status, Status::Undecided, "{:?} {model:?}", out.reason);
    let claim = Claim::of(&out).expect("a certificate");
    assert_eq!(verify(model, &claim), Ok(()), "{model:?} {out:?}");
    out
}

#[test]
fn random_programs_agree_with_elimination() {
    let mut r = Rng::new(0x9e37_79b9_7f4a_7c15);
    let mut seen = [0; 3];
    for _ in 0..count(100_000) {
        let model = random_model(&mut r);
        let want = oracle(&model);
        for method in [Method::Exact, Method::Warm] {
            let out = solved(&model, method);
            let got = match out.status {
                Status::Infeasible => None,
                Status::Unbounded => Some(None),
                _ => Some(out.objective.clone()),
            };
            assert_eq!(got, want, "{method:?} {model:?}");
        }
        seen[match want {
            None => 0,
            Some(None) => 1,
            Some(Some(_)) => 2,
        }] += 1;
    }
    assert!(
        count(100_000) < 500 || seen.iter().all(|&s| s > 50),
        "{seen:?}"
    );
}

/// Any start ends in the same optimum: a good one without a pivot, and lists that fit nothing.
#[test]
fn starts_from_any_basis() {
    let mut r = Rng::new(0x1357_9bdf_0246_8ace);
    let mut without_pivots = 0;
    for _ in 0..count(10_000) {
        let model = random_model(&mut r);
        let cold = solved(&model, Method::Exact);
        let last = cold.basis.clone().expect("a basis");
        let mut other = last.clone();
        let places = [Place::Basic, Place::Lower, Place::Upper, Place::Zero];
        for place in other.columns.iter_mut().chain(&mut other.rows) {
            *place = places[r.below(4) as usize];
        }
        other.rows.truncate(r.below(6) as usize);
        other.columns.resize(r.below(6) as usize, Place::Basic);
        for method in [Method::Exact, Method::Warm] {
            for basis in [last.clone(), other.clone()] {
                let options = Options {
                    method,
                    basis: Some(basis),
                    ..Options::default()
                };
                let out = solve(&model, &options);
                assert_eq!(out.status, cold.status);
                assert_eq!(out.objective, cold.objective);
                let claim = Claim::of(&out).expect("a certificate");
                assert_eq!(verify(&model, &claim), Ok(()), "{model:?} {out:?}");
                if options.basis.as_ref() == Some(&last) && method == Method::Exact {
                    assert!(out.status != Status::Optimal || out.exact_pivots == 0);
                    without_pivots += u64::from(cold.exact_pivots > 0);
                }
            }
        }
    }
    assert!(count(10_000) < 50 || without_pivots > 10);
}

/// A band of random integers whose determinants are long: its certificate is a basis.
fn banded(r: &mut Rng, size: usize) -> Model {
    let mut model = Model::new("band");
    for j in 0..size {
        let cost = rat(r.below(4) as i64);
        model.add_column(&format!("x{j}"), cost, Range::free());
    }
    for i in 0..size {
        let price = rat(1 + r.below(1000) as i64);
        let lower = rat(r.below(1000) as i64 - 300);
        model.add_row(&format!("r{i}"), Range::at_least(lower));
        for j in i.saturating_sub(2)..(i + 3).min(size) {
            let most = if i == j { 4_000_000 } else { 1_000_000 };
            let v = 1 + r.below(most) as i64;
            let v = rat(if i == j { v + 4_000_000 } else { v });
            // Costs that positive prices nearly explain: there is an optimum, at a vertex.
            model.columns[j].cost = &model.columns[j].cost + &(&v * &price);
            model.set(i, j, v);
        }
    }
    model
}

/// The same bytes, run for run.
#[test]
fn determinism() {
    let mut r = Rng::new(0xfeed_f00d);
    let models = [
        banded(&mut r, 60),
        random_model(&mut r),
        random_model(&mut r),
    ];
    for model in &models {
        for accuracy in [Accuracy::Exact, Accuracy::Bounds] {
            let text = || {
                let options = Options {
                    accuracy,
                    values: true,
                    ..Options::default()
                };
                report::to_json(model, "m", &solve(model, &options)).to_string()
            };
            assert_eq!(text(), text());
        }
    }
}

/// `Bounds` gives an enclosure that holds the optimum, is narrow, and is proven; limits on time
/// and on memory give one that holds it and is proven.
#[test]
fn bounds_enclose() {
    let mut r = Rng::new(0x600d_600d);
    let (mut narrow, mut ended, mut limited) = (0, 0, [0; 3]);
    for k in 0..count(10_000) {
        let model = if k % 16 == 0 {
            banded(&mut r, 12)
        } else {
            random_model(&mut r)
        };
        let exact = solved(&model, Method::Warm);
        for kind in [Kind::Bounds, Kind::Time, Kind::Memory] {
            let bounds = kind == Kind::Bounds;
            let options = Options {
                accuracy: if bounds {
                    Accuracy::Bounds
                } else {
                    Accuracy::Exact
                },
                time_limit: (kind == Kind::Time).then_some(std::time::Duration::ZERO),
                memory_limit: (kind == Kind::Memory).then_some(0),
                ..Options::default()
            };
            let out = solve(&model, &options);
            limited[kind as usize] += u64::from(out.status == Status::Undecided);
            if bounds {
                assert_eq!(out.status, exact.status);
            }
            if let Some(claim) = Claim::of(&out) {
                assert_eq!(verify(&model, &claim), Ok(()), "{model:?} {out:?}");
            }
            let (low, high) = &out.enclosure;
            let Some(optimum) = &exact.objective else {
                // Without an optimum there is no enclosure of one from both sides.
                assert!(low.is_none() || high.is_none());
                continue;
            };
            assert!(low.as_ref().is_none_or(|l| l <= optimum), "{out:?}");
            assert!(high.as_ref().is_none_or(|h| h >= optimum), "{out:?}");
            if bounds {
                let (Some(low), Some(high)) = (low, high) else {
                    panic!("{out:?}");
                };
                let size = optimum.abs().nearest_f64().expect("a size").max(1.0);
                assert!((high - low).nearest_f64().expect("a width") <= 1.001e-9 * size);
                narrow += u64::from(low < high);
            } else {
                ended += u64::from(low.is_some() || high.is_some());
            }
        }
    }
    assert!(count(10_000) < 50 || ended > 10, "{narrow} {ended}");
    assert_eq!(limited[Kind::Bounds as usize], 0);
    assert!(
        count(10_000) < 50 || limited[1] > 10 && limited[2] > 10,
        "{limited:?}"
    );
}

/// What a run of [`bounds_enclose`] is limited by.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Bounds,
    Time,
    Memory,
}
