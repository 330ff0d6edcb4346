//! The verbs `lp` and `verify`: arguments in, JSON out, an exit status back.

use super::budget::Meter;
use super::model::Model;
use super::outcome::Status;
use super::read::read_model;
use super::report::{from_json, to_json};
use super::solve::{Accuracy, Method, Options, solve};
use crate::certificate::lp::verify;
use crate::certificate::{lp_json, lp_result};
use std::io::{Read, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Bad usage or bad input.
const BAD: u8 = 2;
/// Not decided within the limits.
const UNDECIDED: u8 = 3;
/// A certificate was rejected.
const REJECTED: u8 = 4;

/// Arguments of `snapfit lp`.
#[derive(clap::Args, Clone, Debug)]
pub struct LpArgs {
    /// An .mps or .lp file, gzipped or not; `-` is standard input
    pub model: PathBuf,
    /// Who finds the basis: floating point with exact repair, or the exact simplex method alone
    #[arg(long, value_enum, default_value_t = MethodArg::Warm)]
    pub method: MethodArg,
    /// How much is proven
    #[arg(long, value_enum, default_value_t = AccuracyArg::Exact)]
    pub accuracy: AccuracyArg,
    /// Write all values and prices as exact rationals
    #[arg(long)]
    pub values: bool,
    /// Seconds after which the result is "undecided"
    #[arg(long, value_name = "SECONDS")]
    pub time_limit: Option<f64>,
    /// Mebibytes that no single structure may exceed
    #[arg(long, value_name = "MIB")]
    pub memory_limit: Option<u64>,
    /// Write the result there instead of standard output
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Show no progress on a terminal
    #[arg(short, long)]
    pub quiet: bool,
}

/// `--method`.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodArg {
    /// Floating point proposes, exact arithmetic disposes.
    Warm,
    /// The exact simplex method alone.
    Exact,
}

/// `--accuracy`.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccuracyArg {
    /// Nothing is proven.
    Float,
    /// A rational enclosure of the optimum, proven.
    Bounds,
    /// The optimum itself, proven.
    Exact,
}

/// Arguments of `snapfit verify`.
#[derive(clap::Args, Clone, Debug)]
#[command(
    after_help = "Exit status: 0 all that the result claims is proven, which may be bounds only where it is \
undecided; 2 bad usage or bad input; 3 the result is undecided and claims nothing; 4 rejected, with the reason."
)]
pub struct VerifyArgs {
    /// A result of `snapfit lp`; `-` is standard input
    pub result: PathBuf,
    /// The model, where it is no longer where the result says
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    if path == Path::new("-") {
        let mut bytes = Vec::new();
        let done = std::io::stdin().lock().read_to_end(&mut bytes);
        return done
            .map(|_| bytes)
            .map_err(|e| format!("standard input: {e}"));
    }
    std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn bad(message: impl std::fmt::Display) -> u8 {
    let _ = writeln!(std::io::stderr(), "{message}");
    BAD
}

/// Writes a result to a file, or to standard output.
pub type Write<'a> = &'a dyn Fn(Option<&Path>, &str) -> Result<(), String>;

/// Runs `snapfit lp`; the result is the exit status. What it is at is noted in `meter`.
pub fn run_lp(args: &LpArgs, meter: &Arc<Meter>, write: Write<'_>) -> u8 {
    let time_limit = match args.time_limit {
        None => None,
        Some(s) => match Duration::try_from_secs_f64(s) {
            Ok(d) => Some(d),
            Err(_) => return bad("--time-limit is not a number of seconds"),
        },
    };
    let options = Options {
        method: match args.method {
            MethodArg::Warm => Method::Warm,
            MethodArg::Exact => Method::Exact,
        },
        accuracy: match args.accuracy {
            AccuracyArg::Float => Accuracy::Float,
            AccuracyArg::Bounds => Accuracy::Bounds,
            AccuracyArg::Exact => Accuracy::Exact,
        },
        time_limit,
        memory_limit: args.memory_limit.map(|m| m.saturating_mul(1 << 20)),
        values: args.values,
        basis: None,
        meter: Some(meter.clone()),
    };
    let name = args.model.to_string_lossy();
    let model = match read(&args.model) {
        Err(e) => return bad(e),
        Ok(bytes) => match read_model(&name, &bytes) {
            Err(e) => return bad(e),
            Ok(m) => m,
        },
    };
    if !args.quiet {
        warn(&model, args, &name);
    }
    let outcome = solve(&model, &options);
    let mut text = to_json(&model, &name, &outcome).to_string();
    text.push('\n');
    let written = write(args.out.as_deref(), &text);
    match written {
        Err(e) => bad(e),
        Ok(()) if outcome.status == Status::Undecided => UNDECIDED,
        Ok(()) => 0,
    }
}

/// Says what was made of the model that its writer may not have meant.
fn warn(model: &Model, args: &LpArgs, name: &str) {
    let mut err = std::io::stderr().lock();
    let mut say = |what: String| {
        let _ = writeln!(err, "{name}: warning: {what}");
    };
    if args.model.to_str().is_none() {
        say(
            "this name is not UTF-8, so the result cannot hold it; `verify` will need --model FILE"
                .into(),
        );
    }
    if model.relaxed {
        say("integer columns are relaxed; what follows is the continuous program".into());
    }
    if let Some(v) = model.ignored_rhs.as_ref().filter(|v| !v.is_zero()) {
        say(format!(
            "the objective's right-hand side {v} is not part of the objective, as the published optima have it"
        ));
    }
    if let Some(names) = model.freed_names() {
        let others = match names.len() - 1 {
            0 => String::new(),
            n => format!(" and of {n} more"),
        };
        say(format!(
            "the upper bound of column `{}`{others} is negative and no lower bound is given: the lower bound is -infinity",
            names[0]
        ));
    }
}

/// The model that a result names: as it is written, seen from here, or, where there is none, from
/// where the result is. Two files that differ are not chosen from.
fn named(model: &Path, result: &Path) -> Result<PathBuf, String> {
    let folder = result.parent().filter(|p| !p.as_os_str().is_empty());
    let Some(beside) = folder.map(|f| f.join(model)).filter(|p| p.exists()) else {
        return Ok(model.to_owned());
    };
    if !model.exists() {
        return Ok(beside);
    }
    let place = |p: &Path| std::fs::canonicalize(p).ok();
    let one = place(model).is_some_and(|p| Some(p) == place(&beside));
    if one || matches!((read(model), read(&beside)), (Ok(a), Ok(b)) if a == b) {
        return Ok(model.to_owned());
    }
    Err(format!(
        "{}: its model `{}` may be the file of that name here or {}, which differ; name one by --model FILE",
        result.display(),
        model.display(),
        beside.display()
    ))
}

/// The verdict on a result, the reason for it, and the exit status.
///
/// A result that is undecided and claims nothing is neither proven nor wrong: its verdict is
/// "nothing claimed", with the exit status of what is not decided. One with bounds that hold is
/// verified like any other.
fn judge(model: &Model, result: &serde_json::Value) -> (&'static str, Option<String>, u8) {
    let undecided = result["status"] == "undecided";
    if undecided && result["certificate"].is_null() {
        if let Err(e) = lp_result::claims_nothing(model, result) {
            return ("rejected", Some(e.0), REJECTED);
        }
        let why = "the result is undecided and claims nothing: there is nothing to check";
        return ("nothing claimed", Some(why.to_string()), UNDECIDED);
    }
    let claim = match from_json(model, result) {
        Ok(claim) => claim,
        Err(e) => return ("rejected", Some(e), REJECTED),
    };
    match verify(model, &claim).and_then(|()| lp_result::agrees(model, &claim, result)) {
        Ok(()) if undecided => {
            let what = match &claim.enclosure {
                (Some(_), Some(_)) => "both its bounds hold",
                _ => "its bound holds",
            };
            let why = format!("the result is undecided; {what}");
            ("verified", Some(why), 0)
        }
        Ok(()) => ("verified", None, 0),
        Err(e) => ("rejected", Some(e.0), REJECTED),
    }
}

/// Runs `snapfit verify`; the result is the exit status.
pub fn run_verify(args: &VerifyArgs, write: Write<'_>) -> u8 {
    let result = match read(&args.result) {
        Err(e) => return bad(e),
        Ok(bytes) => bytes,
    };
    let name = args.result.display();
    let result: serde_json::Value = match lp_json::read(&result) {
        Ok(v) => v,
        Err(e) => {
            return bad(format!(
                "{name}:{}:{}: not a result of `snapfit lp`, which is JSON: {e}",
                e.line().max(1),
                e.column().max(1)
            ));
        }
    };
    let path = match (&args.model, result["model"].as_str()) {
        (Some(p), _) => p.clone(),
        (None, Some("-")) => {
            return bad(format!(
                "{name}: its model came from standard input; name it by --model FILE"
            ));
        }
        (None, Some(p)) => match named(Path::new(p), &args.result) {
            Ok(p) => p,
            Err(e) => return bad(e),
        },
        (None, None) => {
            return bad(format!(
                "{name}: this is no result of `snapfit lp`: it names no model"
            ));
        }
    };
    let model = match read(&path) {
        Err(e) => return bad(e),
        Ok(bytes) => match read_model(&path.to_string_lossy(), &bytes) {
            Err(e) => return bad(e),
            Ok(m) => m,
        },
    };
    let (verdict, reason, code) = judge(&model, &result);
    let verdict = serde_json::json!({
        "verdict": verdict,
        "reason": reason,
        "status": result["status"],
        "model": path.to_string_lossy(),
    });
    match write(None, &format!("{verdict}\n")) {
        Ok(()) => code,
        Err(e) => bad(e),
    }
}
