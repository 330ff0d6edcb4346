//! The exact LP solver against an oracle that works quite differently (Fourier–Motzkin
//! elimination), classics that make simplex methods cycle or crawl, extreme numbers, and the
//! published optima of netlib. `TEST_MULT` scales the random runs (1 is the full size).
#![allow(clippy::unwrap_used)]

use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{
    Accuracy, Certificate, Method, Model, Options, Outcome, Place, Range, Status, Vector,
    read_model, report, solve,
};
use snapfit::number::{Int, Rat};

struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % n
    }
    fn small(&mut self) -> i64 {
        self.below(7) as i64 - 3
    }
}

fn rat(v: i64) -> Rat {
    Rat::from(v)
}

fn runs(nominal: f64) -> u64 {
    let scale = std::env::var("TEST_MULT")
        .ok()
        .and_then(|s| s.parse::<f64>().ok());
    (nominal * scale.unwrap_or(0.01)) as u64
}

fn random_model(r: &mut Random) -> Model {
    let mut model = Model::new("random");
    model.maximise = r.below(2) == 0;
    let (n, m) = (r.below(4) as usize, r.below(5) as usize);
    let range = |r: &mut Random, usual: Range| {
        let a = rat(r.small());
        let b = rat(r.small());
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
        let cost = Rat::frac(r.small(), 1 + r.below(3) as i64);
        let range = range(r, Range::at_least(Rat::zero()));
        model.add_column(&format!("x{j}"), cost, range);
    }
    for i in 0..m {
        let bound = rat(r.small());
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
                Rat::frac(r.small(), 1 + r.below(2) as i64)
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
    let mut r = Random(0x9e37_79b9_7f4a_7c15);
    let mut seen = [0; 3];
    for _ in 0..runs(1e5) {
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
    assert!(runs(1e5) < 500 || seen.iter().all(|&s| s > 50), "{seen:?}");
}

/// Any start ends in the same optimum: a good one without a pivot, and lists that fit nothing.
#[test]
fn starts_from_any_basis() {
    let mut r = Random(0x1357_9bdf_0246_8ace);
    let mut without_pivots = 0;
    for _ in 0..runs(1e4) {
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
    assert!(runs(1e4) < 50 || without_pivots > 10);
}

/// Changes something in a vector.
fn shake(v: &mut Vector, r: &mut Random) {
    match (r.below(4), v.numerators.is_empty()) {
        (0, _) => v.denominator = &v.denominator + &Int::from(r.small()),
        (1, false) => {
            let k = r.below(v.numerators.len() as u64) as usize;
            v.numerators.remove(k);
        }
        (2, false) => {
            let k = r.below(v.numerators.len() as u64) as usize;
            v.numerators[k].0 = r.below(6) as u32;
        }
        (_, false) => {
            let k = r.below(v.numerators.len() as u64) as usize;
            v.numerators[k].1 = &v.numerators[k].1 + &Rat::from(r.small());
        }
        (_, true) => v.numerators.push((r.below(4) as u32, rat(r.small()))),
    }
}

/// A false claim is rejected, whatever is done to its certificate; and a certificate that was
/// changed only passes where what it claims is still true.
#[test]
fn false_claims_are_rejected() {
    let mut r = Random(0xdead_beef_cafe_f00d);
    let mut done = 0;
    while done < runs(1e4).max(20) {
        let model = random_model(&mut r);
        let out = solved(&model, Method::Warm);
        let honest = Claim::of(&out).expect("a certificate");
        for _ in 0..4 {
            let mut claim = honest.clone();
            match (&mut claim.certificate, r.below(2)) {
                (Certificate::Optimal { primal, .. }, 0) => shake(primal, &mut r),
                (Certificate::Optimal { dual, .. }, _) => shake(dual, &mut r),
                (Certificate::Infeasible { prices }, _) => shake(prices, &mut r),
                (Certificate::Unbounded { point, .. }, 0) => shake(point, &mut r),
                (Certificate::Unbounded { ray, .. }, _) => shake(ray, &mut r),
                _ => {}
            }
            match claim.status {
                Status::Optimal => {
                    let objective = claim.objective.clone().expect("an objective");
                    claim.objective = Some(&objective + &Rat::frac(1 + r.below(9) as i64, 1 << 40));
                }
                Status::Infeasible => claim.status = Status::Unbounded,
                _ => claim.status = Status::Infeasible,
            }
            assert!(verify(&model, &claim).is_err(), "{model:?} {claim:?}");
            done += 1;
        }
        // No other outcome's certificate proves a wrong status.
        let wrong = match honest.status {
            Status::Optimal => Certificate::Unbounded {
                point: vector(&[0, 1, 0]),
                ray: vector(&[1, 1, 1]),
            },
            _ => Certificate::Optimal {
                primal: vector(&[0, 0, 0]),
                dual: vector(&[0, 0, 0]),
            },
        };
        let status = match honest.status {
            Status::Optimal => Status::Unbounded,
            _ => Status::Optimal,
        };
        let claim = Claim {
            status,
            objective: Some(Rat::zero()),
            enclosure: (None, None),
            certificate: wrong,
        };
        assert!(verify(&model, &claim).is_err(), "{model:?} {claim:?}");
    }
}

/// A band of random integers whose determinants are long: its certificate is a basis.
fn banded(r: &mut Random, size: usize) -> Model {
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

/// Every change to a basis certificate, to the objective beside it or to its denominators is
/// rejected, or leaves it the certificate of what is still true.
#[test]
fn mutated_bases_are_rejected() {
    let mut r = Random(0x0bad_5eed_0bad_5eed);
    let model = banded(&mut r, 350);
    let out = solved(&model, Method::Warm);
    let honest = Claim::of(&out).expect("a certificate");
    let Certificate::Basis { columns, rows, .. } = &honest.certificate else {
        panic!("the vertex is long enough for the short form");
    };
    let (n, m) = (columns.len(), rows.len());
    let places = [Place::Basic, Place::Lower, Place::Upper, Place::Zero];
    let mut rejected = 0;
    for _ in 0..runs(1e4).max(20) {
        let mut claim = honest.clone();
        let Certificate::Basis {
            columns,
            rows,
            order,
            primal_denominator,
            dual_denominator,
        } = &mut claim.certificate
        else {
            unreachable!()
        };
        let k = r.below(order.len() as u64) as usize;
        let l = r.below(order.len() as u64) as usize;
        let way = r.below(9);
        match way {
            0 => columns[r.below(n as u64) as usize] = places[1 + r.below(3) as usize],
            1 => rows[r.below(m as u64) as usize] = places[2 * r.below(2) as usize],
            2 => order[k] = order[(k + 1) % order.len()],
            3 => order[k].0 = (order[k].0 + 1 + r.below(m as u64 - 1) as u32) % (m as u32 + 5),
            4 => drop(order.remove(k)),
            5 => *primal_denominator = &*primal_denominator + &Int::from(1 + r.small().abs()),
            6 => *dual_denominator = -&*dual_denominator,
            7 => *dual_denominator = &*dual_denominator + &Int::from(1 + r.small().abs()),
            _ => {
                let objective = claim.objective.clone().expect("an objective");
                claim.objective = Some(&objective + &Rat::frac(1 + r.below(9) as i64, 1 << 50));
                order.swap(k, l);
            }
        }
        let verdict = verify(&model, &claim);
        assert!(verdict.is_err(), "a basis mutated in way {way} passes");
        rejected += 1;
    }
    assert!(rejected >= 20);
}

/// The same bytes, run for run.
#[test]
fn determinism() {
    let mut r = Random(0xfeed_f00d);
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
    let mut r = Random(0x600d_600d);
    let (mut narrow, mut ended, mut limited) = (0, 0, [0; 3]);
    for k in 0..runs(1e4) {
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
    assert!(runs(1e4) < 50 || ended > 10, "{narrow} {ended}");
    assert_eq!(limited[Kind::Bounds as usize], 0);
    assert!(
        runs(1e4) < 50 || limited[1] > 10 && limited[2] > 10,
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

fn vector(v: &[i64]) -> Vector {
    Vector {
        denominator: Int::one(),
        numerators: (0..).zip(v.iter().map(|&v| rat(v))).collect(),
    }
}

#[test]
fn results_survive_json() {
    let mut r = Random(77);
    for _ in 0..50 {
        let model = random_model(&mut r);
        let out = solved(&model, Method::Warm);
        let text = report::to_json(&model, "m", &out).to_string();
        let value = serde_json::from_str(&text).expect("JSON");
        let claim = report::from_json(&model, &value).expect("a claim");
        assert_eq!(verify(&model, &claim), Ok(()));
    }
}

fn check(text: &str, objective: &str) {
    let model = read_model("t.lp", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    for method in [Method::Exact, Method::Warm] {
        let out = solved(&model, method);
        assert_eq!(
            out.objective.map(|o| o.to_string()).as_deref(),
            Some(objective)
        );
    }
}

#[test]
fn cycling_examples_end() {
    // Beale 1955.
    check(
        "min -3/4 a + 150 b - 1/50 c + 6 d\nst\n r1: 1/4 a - 60 b - 1/25 c + 9 d <= 0\n\
         r2: 1/2 a - 90 b - 1/50 c + 3 d <= 0\n r3: c <= 1\nend",
        "-1/20",
    );
    // Chvátal's form of the cycle.
    check(
        "max\n 10 a - 57 b - 9 c - 24 d\nst\n 0.5 a - 5.5 b - 2.5 c + 9 d <= 0\n\
         0.5 a - 1.5 b - 0.5 c + d <= 0\n a <= 1\nend",
        "1",
    );
    // Marshall & Suurballe.
    check(
        "min\n -2 x1 - 3 x2 + x3 + 12 x4\nst\n -2 x1 - 9 x2 + x3 + 9 x4 <= 0\n\
         1/3 x1 + x2 - 1/3 x3 - 2 x4 <= 0\n x1 + x2 <= 1\n x3 + x4 <= 1\nend",
        "-1",
    );
}

/// Hoffman's example of 1953: five pairs of columns, each the one before turned by 72° (in skew
/// coordinates), around a vertex where nothing can move. Largest coefficients lead round and
/// round. The numbers are irrational; nine digits keep every choice of pivot.
#[test]
fn hoffmans_circle() {
    let theta = 0.4 * std::f64::consts::PI;
    let (c, w) = (theta.cos(), 2.0);
    assert!(w > (1.0 - c) / (1.0 - 2.0 * c));
    let near = |v: f64| Rat::frac((v * 1e9).round() as i64, 1_000_000_000);
    let turn = [[c, -w * c], [theta.tan() * theta.sin() / w, c]];
    let mut pair = [[1.0, 0.0], [0.0, 1.0]];
    let first = [-(1.0 - c) / c, w];
    let mut cost = [0.0, 0.0];
    let mut model = Model::new("circle");
    model.add_column("x1", Rat::zero(), Range::at_least(Rat::zero()));
    model.add_row("one", Range::fixed(Rat::one()));
    model.add_row("p", Range::fixed(Rat::zero()));
    model.add_row("q", Range::fixed(Rat::zero()));
    model.set(0, 0, Rat::one());
    for k in 0..5 {
        for side in 0..2 {
            let name = format!("x{}", 2 * k + side + 2);
            let j = model.add_column(&name, near(cost[side]), Range::at_least(Rat::zero()));
            model.set(1, j, near(pair[0][side]));
            model.set(2, j, near(pair[1][side]));
        }
        let by = |row: [f64; 2], m: [[f64; 2]; 2]| {
            [0, 1].map(|s: usize| row[0] * m[0][s] + row[1] * m[1][s])
        };
        let more = by(first, pair);
        cost = [cost[0] + more[0], cost[1] + more[1]];
        pair = [by(turn[0], pair), by(turn[1], pair)];
    }
    assert!(cost.iter().all(|v| v.abs() < 1e-12), "the circle closes");
    let [a, b] = [Method::Exact, Method::Warm].map(|m| solved(&model, m));
    assert_eq!((a.status, &a.objective), (b.status, &b.objective));
    assert_eq!(a.objective, Some(Rat::zero()));
}

/// Klee & Minty's cube: exponentially many vertices, one right one.
#[test]
fn klee_minty() {
    let n = 12;
    let mut model = Model::new("cube");
    model.maximise = true;
    for j in 0..n {
        let cost = Rat::from(Int::from(10i64).pow((n - 1 - j) as u32));
        model.add_column(&format!("x{j}"), cost, Range::at_least(Rat::zero()));
    }
    for i in 0..n {
        let b = Rat::from(Int::from(100i64).pow(i as u32));
        model.add_row(&format!("r{i}"), Range::at_most(b));
        for j in 0..i {
            let v = Int::from(2i64) * Int::from(10i64).pow((i - j) as u32);
            model.set(i, j, Rat::from(v));
        }
        model.set(i, i, Rat::one());
    }
    for method in [Method::Exact, Method::Warm] {
        let want = Rat::from(Int::from(100i64).pow(n as u32 - 1));
        assert_eq!(solved(&model, method).objective, Some(want));
    }
}

/// Rows of the Hilbert matrix: determinants near 10⁻¹⁰⁰ that floating point takes for zero.
#[test]
fn hilbert_rows() {
    let n = 14;
    let mut model = Model::new("hilbert");
    for j in 0..n {
        model.add_column(&format!("x{j}"), Rat::one(), Range::free());
    }
    for i in 0..n {
        let sum = (0..n).fold(Rat::zero(), |s, j| s + Rat::frac(1, (i + j + 1) as i64));
        model.add_row(&format!("r{i}"), Range::fixed(sum));
        for j in 0..n {
            model.set(i, j, Rat::frac(1, (i + j + 1) as i64));
        }
    }
    for method in [Method::Exact, Method::Warm] {
        let out = solved(&model, method);
        assert_eq!(out.objective, Some(rat(n as i64)));
    }
}

#[test]
fn extreme_numbers() {
    check(
        "max\n 1e300 x + 1e-300 y\nst\n 1e-300 x + 1e300 y <= 1\n x <= 1e250\nend",
        &format!("1{}", "0".repeat(550))
            .parse::<Rat>()
            .map_or(String::new(), |big| {
                let one = Rat::one();
                let tiny = &one / &Rat::from(Int::from(10i64).pow(300));
                let rest = &one - &(&tiny * &Rat::from(Int::from(10i64).pow(250)));
                (&big + &(&(&rest * &tiny) * &tiny)).to_string()
            }),
    );
    // A coefficient that is itself the first lifting prime, and a multiple of the second.
    check(
        "max\n x\nst\n 144115188075855859 x <= 1\nend",
        "1/144115188075855859",
    );
    check(
        "max\n x\nst\n 144115188075855871 x + y <= 1\nend",
        "1/144115188075855871",
    );
}

#[test]
fn readers_say_where() {
    let place = |name: &str, text: &str| {
        let e = read_model(name, text.as_bytes()).expect_err("an error");
        (e.line, e.column, e.message)
    };
    let mps = "NAME t\nROWS\n N obj\n L r\nCOLUMNS\n x obj 1 r 2\n x r 3\nRHS\nENDATA\n";
    assert_eq!(place("a.mps", mps).0, 7);
    assert!(place("a.mps", mps).2.contains("second entry"));
    assert_eq!(place("a.mps", &mps.replace("x r 3", "y r 0x3")).1, 6);
    assert_eq!(
        place(
            "a.mps",
            &mps.replace(" x r 3\n", "").replace("ENDATA\n", "")
        )
        .0,
        7
    );
    assert_eq!(place("a.mps", &mps.replace("x r 3", "y q 3")).1, 4);
    assert_eq!(place("a.lp", "min x + x\nst\nend").0, 1);
    assert_eq!(place("a.lp", "min x\nst\n x + >= 2\nend").0, 3);
    assert_eq!(place("a.lp", "min x\nst\n x >= 1/0\nend").0, 3);
    assert!(read_model("a.mps", &[0x1f, 0x8b, 1, 2]).is_err());
    assert_eq!(
        read_model("a.mps", b"NAME\n\xff").expect_err("bytes").line,
        2
    );
    assert!(read_model("a.lp", b"").is_err() && read_model("a.mps", b"").is_err());
}

#[test]
fn mps_bounds_and_ranges() {
    let text = "NAME          t\nOBJSENSE\n    MAX\nROWS\n N  obj\n E  e\n G  g\n L  l\nCOLUMNS\n\
        \x20   x  obj  1.5  e  1.\n    x  g  .5\n    y  e  -1  l  2D0\n    z  l  1\n    w  obj  1\n\
        RHS\n    e  3  g  1\n    obj  7\nRANGES\n    R  e  -2  g  4\n    R  l  5\nBOUNDS\n\
        \x20UP B  x  -2\n FR B  y\n MI B  z\n UP B  z  8\n FX B  w  1/3\nENDATA\n";
    let m = read_model("t.mps", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    let range = |l: Option<i64>, u: Option<i64>| Range {
        lower: l.map(rat),
        upper: u.map(rat),
    };
    assert!(m.maximise);
    assert_eq!(m.rows[0].range, range(Some(1), Some(3)));
    assert_eq!(m.rows[1].range, range(Some(1), Some(5)));
    assert_eq!(m.rows[2].range, range(Some(-5), Some(0)));
    assert_eq!(m.columns[0].range, range(None, Some(-2)));
    assert_eq!(m.columns[1].range, Range::free());
    assert_eq!(m.columns[2].range, range(None, Some(8)));
    assert_eq!(m.columns[3].range, Range::fixed(Rat::frac(1, 3)));
    assert_eq!(m.columns[1].entries[1].1, rat(2));
    assert_eq!(m.ignored_rhs, Some(rat(7)));
}

/// 10³⁰ as a bound is the format's word for none; next to it lie numbers.
#[test]
fn mps_infinity() {
    let text = "NAME\nROWS\n N obj\n L r\nCOLUMNS\n x obj 1 r 1\n y obj 1 r 1\n z obj 1 r 1\n\
        RHS\n rhs r 1e30\nBOUNDS\n LO b x -1e30\n UP b x 1.0e+30\n LO b y 1e30\n\
        \x20UP b y 1000000000000000000000000000001\n MI b z\n UP b z Inf\nENDATA\n";
    let m = read_model("t.mps", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    let big = Rat::from(Int::from(10i64).pow(30));
    assert_eq!(m.columns[0].range, Range::free());
    assert_eq!(m.columns[1].range.lower, Some(big.clone()));
    assert_eq!(m.columns[1].range.upper, Some(&big + &Rat::one()));
    assert_eq!(m.columns[2].range, Range::free());
    assert_eq!(m.rows[0].range.upper, Some(big));
}

/// Published exact optima; the instances that take long are left to the table example.
#[test]
fn netlib() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/lp/netlib");
    let Ok(table) = std::fs::read_to_string(folder.join("truth.tsv")) else {
        eprintln!("SKIPPED: {} is missing", folder.display());
        return;
    };
    let slow = [
        "25fv47", "bnl1", "cycle", "d2q06c", "dfl001", "fit2p", "greenbeb", "maros", "maros-r7",
        "modszk1", "nesm", "pilot4", "pilot87", "stocfor2", "woodw",
    ];
    let all = std::env::var_os("NETLIB_ALL").is_some();
    for line in table.lines().skip(1) {
        let f: Vec<&str> = line.split('\t').collect();
        if slow.contains(&f[0]) && (!all || f[1].contains("TIMEOUT")) {
            continue;
        }
        let path = folder.join(format!("{}.mps.gz", f[0]));
        let bytes = std::fs::read(&path).expect("an instance");
        let model = read_model(f[0], &bytes);
        let model = model.or_else(|_| read_model("a.mps", &bytes));
        let model = model.unwrap_or_else(|e| panic!("{e}"));
        let out = solved(&model, Method::Warm);
        if f[1].contains("optimal") {
            assert_eq!(
                out.objective.map(|o| o.to_string()).as_deref(),
                Some(f[2]),
                "{}",
                f[0]
            );
        } else {
            assert!(f[1].starts_with(out.status.word()), "{}", f[0]);
        }
    }
}
