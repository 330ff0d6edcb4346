//! Solves the models named on the command line and prints a table: name, status, whether it
//! agrees with the published optimum beside it, pivots, seconds of CPU.
//!
//! `lp_table [--exact] [--limit SECONDS] FILE…`
#![allow(clippy::unwrap_used)]

use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{Method, Options, Outcome, read_model, solve};
use std::path::Path;
use std::time::Duration;

fn main() {
    let mut options = Options {
        time_limit: Some(Duration::from_secs(300)),
        ..Options::default()
    };
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--exact" => options.method = Method::Exact,
            "--limit" => {
                let seconds = args.next().and_then(|s| s.parse().ok()).unwrap_or(300.0);
                options.time_limit = Some(Duration::from_secs_f64(seconds));
            }
            file => row(Path::new(file), &options),
        }
    }
}

fn row(path: &Path, options: &Options) {
    let file = path.to_string_lossy();
    let start = cpu();
    let model = match std::fs::read(path).map(|b| read_model(&file, &b)) {
        Ok(Ok(m)) => m,
        Ok(Err(e)) => return println!("{e}"),
        Err(e) => return println!("{file}: {e}"),
    };
    let read = cpu() - start;
    let outcome = solve(&model, options);
    let total = cpu() - start;
    let start = cpu();
    let proof = match Claim::of(&outcome).map(|c| verify(&model, &c)) {
        Some(Ok(())) => "proven",
        Some(Err(e)) => {
            println!("{e}");
            "REJECTED"
        }
        None => "unproven",
    };
    let checking = cpu() - start;
    println!(
        "{:<24} {:<10} {:<8} {proof} float {:>6} exact {:>4} read {read:.3} total {total:.3} check {checking:.3}",
        path.file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .trim_end_matches(".mps.gz"),
        outcome.status.word(),
        agreement(path, &outcome),
        outcome.float_iterations,
        outcome.exact_pivots,
    );
}

/// CPU seconds of this thread where the system tells them, else 0.
fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let ns: f64 = text
        .split(' ')
        .next()
        .and_then(|s| s.parse().ok())
        .unwrap_or(0.0);
    ns * 1e-9
}

/// Compares with `NAME.exact` or `truth.tsv` beside the model.
fn agreement(path: &Path, outcome: &Outcome) -> &'static str {
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .to_string();
    let name = name.trim_end_matches(".mps.gz");
    let folder = path.parent().unwrap_or(Path::new("."));
    let ours = outcome.objective.as_ref().map(ToString::to_string);
    if let Ok(text) = std::fs::read_to_string(folder.join(format!("{name}.exact"))) {
        return verdict(ours.as_deref().map(|o| o.trim_start_matches('-')) == Some(text.trim()));
    }
    let Ok(table) = std::fs::read_to_string(folder.join("truth.tsv")) else {
        return "unknown";
    };
    for line in table.lines() {
        let f: Vec<&str> = line.split('\t').collect();
        if f.first() != Some(&name) {
            continue;
        }
        if f[1].contains("optimal") {
            return verdict(ours.as_deref() == Some(f[2]));
        }
        if f[1].contains("TIMEOUT") {
            let near = outcome.objective.as_ref().and_then(|o| o.nearest_f64());
            let koch: f64 = f[4].parse().unwrap_or(f64::NAN);
            return verdict(near.is_some_and(|v| ((v - koch) / koch).abs() < 1e-14));
        }
        return verdict(f[1].starts_with(outcome.status.word()));
    }
    "unknown"
}

fn verdict(equal: bool) -> &'static str {
    if equal { "agrees" } else { "DIFFERS" }
}
