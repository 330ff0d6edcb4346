//! Programs with a known optimum: classics that make simplex methods cycle or crawl, extreme
//! numbers, and netlib.

use super::{rat, solved};
use snapfit::lp::{Method, Model, Range, read_model};
use snapfit::number::{Int, Rat};

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
