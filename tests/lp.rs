//! The exact LP solver against an oracle that works quite differently (Fourier–Motzkin
//! elimination), classics that make simplex methods cycle or crawl, extreme numbers, and the
//! published optima of netlib. `TEST_MULT` scales the random runs (1 is the full size).
#![allow(clippy::unwrap_used)]

use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{
    Certificate, Method, Model, Options, Outcome, Place, Range, Status, Vector, read_model, report,
    solve,
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

/// Published exact optima; the instances that take long are left to the table example.
#[test]
fn netlib() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/lp/netlib");
    let Ok(table) = std::fs::read_to_string(folder.join("truth.tsv")) else {
        eprintln!("SKIPPED: {} is missing", folder.display());
        return;
    };
    let slow = [
        "25fv47", "bnl1", "cycle", "d2q06c", "degen3", "dfl001", "fit2p", "greenbeb", "maros",
        "maros-r7", "modszk1", "nesm", "pilot4", "pilot87", "stocfor2", "woodw",
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
