//! Whole exact solves with their certificates, and the checking of these: seconds of wall time,
//! best of a few. The instances lie outside the repository; without them the bench says so.
#![allow(clippy::unwrap_used)]

use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{Options, read_model, solve};
use std::path::Path;
use std::time::Instant;

fn best(mut f: impl FnMut()) -> f64 {
    let start = Instant::now();
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let t = Instant::now();
        f();
        least = least.min(t.elapsed().as_secs_f64());
        if start.elapsed().as_secs_f64() > 3.0 {
            break;
        }
    }
    least
}

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/lp");
    for name in [
        "netlib/afiro",
        "netlib/bandm",
        "netlib/stair",
        "netlib/woodw",
        "puzzleflex/pf_grid36_y",
        "puzzleflex/pf_jrot90_y",
        "puzzleflex/pf_grid392_y",
    ] {
        let path = folder.join(format!("{name}.mps.gz"));
        let Ok(bytes) = std::fs::read(&path) else {
            println!("SKIPPED: {} is missing", path.display());
            continue;
        };
        let read = || read_model("bench.mps", &bytes).expect("a model");
        let model = read();
        let outcome = solve(&model, &Options::default());
        let claim = Claim::of(&outcome).expect("a certificate");
        println!(
            "{name:<26} read {:.4} solve {:.4} verify {:.4}",
            best(|| drop(read())),
            best(|| drop(solve(&model, &Options::default()))),
            best(|| verify(&model, &claim).expect("a proof")),
        );
    }
}
