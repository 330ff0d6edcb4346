//! The command line of snapfit: verbs over scene files.
//!
//! Standard output carries the result, standard error everything else. The exit status says what
//! became of the question: 0 decided, 2 bad usage or bad input, 3 undecided within the limits
//! given, 4 decided but not as expected, 1 a bug.

mod args;
mod face;
mod flex;
mod flex_apps;
mod flex_render;
mod limit;
mod output;
mod progress;
mod slice;
mod trade;
mod verdict;

use args::{Arithmetic, Check, Cli, Common, Engine, Format, Method, Name, Render, Simulate, Verb};
use clap::Parser;
use clap::error::ErrorKind;
use snapfit::analysis;
use snapfit::flex::{Guise, guise};
use snapfit::kernel::{FloatOptions, Identify};
use snapfit::motion::{self, Options, OutcomeKind, PlanError, Trajectory, simulate};
use snapfit::report::json::{Provenance, ResultDocument, result_schema};
use snapfit::report::{picture, pretty, summary};
use snapfit::scene::{self, Diagnostic, Rendering, SceneFile};
use std::io::{IsTerminal, Read, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

const DECIDED: u8 = 0;
const BUG: u8 = 1;
const BAD: u8 = 2;
const UNDECIDED: u8 = 3;
const UNEXPECTED: u8 = 4;

/// Why a verb gives no answer. All of it is the user's to mend, and ends in [`BAD`].
enum Failure {
    /// In words.
    Message(String),
    /// With places in a file.
    Scene(Vec<Diagnostic>),
}

impl From<String> for Failure {
    fn from(message: String) -> Failure {
        Failure::Message(message)
    }
}

fn main() -> ExitCode {
    report_panics();
    let status = std::panic::catch_unwind(|| match Cli::try_parse() {
        Ok(cli) => run(&cli.verb).unwrap_or_else(|failure| {
            complain(&failure);
            BAD
        }),
        Err(error) => usage(&error),
    });
    ExitCode::from(status.unwrap_or(BUG))
}

fn run(verb: &Verb) -> Result<u8, Failure> {
    match verb {
        Verb::Simulate(args) => run_simulate(args),
        Verb::Classify(args) => verdict::run_classify(args),
        Verb::Forces(args) => verdict::run_forces(args),
        Verb::Check(args) => run_check(args),
        Verb::Render(args) => run_render(args),
        Verb::Slice(args) => slice::run_slice(args),
        Verb::Face(args) => face::run(args),
        Verb::Flex(args) => flex::run_flex(args),
        Verb::Generate(args) => flex::run_generate(args),
        Verb::Brace(args) => flex_apps::run_brace(args),
        Verb::Loosen(args) => flex_apps::run_loosen(args),
        Verb::Separate(args) => flex_apps::run_separate(args),
        Verb::Lp(args) => {
            output::prepare(&args.model, args.out.as_deref())?;
            Ok(progress::solving(args))
        }
        Verb::Verify(args) => Ok(snapfit::lp::cli::run_verify(args, &output::write)),
        Verb::Trade(args) => trade::run(args),
        Verb::Schema(args) => {
            let schema = match args.name {
                Name::Scene => scene::scene_schema(),
                Name::Structure => snapfit::flex::structure_schema(),
                Name::Result => result_schema(),
                Name::Slice => snapfit::report::slice::slice_schema(),
                Name::Classify => analysis::classify_schema(),
                Name::Forces => analysis::forces_schema(),
                Name::Lp => snapfit::lp::lp_schema(),
            };
            let compact = serde_json::to_string(&schema).map_err(|e| e.to_string())?;
            output::write(args.out.as_deref(), &(pretty(&compact, 100) + "\n"))?;
            Ok(DECIDED)
        }
    }
}

fn run_simulate(args: &Simulate) -> Result<u8, Failure> {
    let file = read(&args.common)?;
    let (trajectory, mut document) = simulated(&file, &args.common, &args.engine)?;
    if args.no_times {
        document.without_times();
    }
    let text = match format_of(args.format, &args.common) {
        Format::Json => document.to_text().map_err(|e| e.to_string())?,
        Format::Summary => summary::summary(&document, style()),
    };
    output::write(args.common.out.as_deref(), &text)?;
    Ok(status(&trajectory))
}

fn run_check(args: &Check) -> Result<u8, Failure> {
    let (name, bytes) = read_bytes(&args.common)?;
    if snapfit::flex::is_structure(&name, &bytes) {
        return flex::run_check(&args.common, &name, &bytes, args.format);
    }
    let file = parse(&args.common, &name, &bytes)?;
    let report = scene::check(&file);
    let text = match format_of(args.format, &args.common) {
        Format::Json => {
            pretty(
                &serde_json::to_string(&report).map_err(|e| e.to_string())?,
                100,
            ) + "\n"
        }
        Format::Summary => report.to_string(),
    };
    output::write(args.common.out.as_deref(), &text)?;
    Ok(DECIDED)
}

fn run_render(args: &Render) -> Result<u8, Failure> {
    let to = match (&args.svg, &args.common.out) {
        (Some(path), None) => Some(path.as_path()),
        (Some(path), Some(out)) if path == Path::new("-") => Some(out.as_path()),
        (Some(_), Some(_)) => {
            return Err("give the picture's path once: to --svg or to --out"
                .to_owned()
                .into());
        }
        (None, _) => return Err("say what to draw: --svg [PATH]".to_owned().into()),
    };
    output::prepare(&args.common.file, to)?;
    let (name, bytes) = read_bytes(&args.common)?;
    let which = [
        ("--phase", args.which.phase.is_some()),
        ("--pawl", args.which.pawl.is_some()),
    ];
    if snapfit::flex::is_structure(&name, &bytes) {
        let engine = &args.engine;
        let scenes = [
            ("--slice", args.slice),
            ("--tolerance", engine.tolerance.is_some()),
            ("--identify", engine.identify.is_some()),
        ];
        let why = "is for scenes, and this is a structure";
        idle(&scenes, why)?;
        idle(&which, why)?;
        return flex_render::run_render(args, &name, &bytes, to);
    }
    let frames = [("--frames", args.frames.is_some())];
    idle(
        &frames,
        "is for structures: of a scene every event is drawn, on one page",
    )?;
    let file = parse(&args.common, &name, &bytes)?;
    if !args.slice {
        idle(&which, "is for --slice: it says which slice is meant")?;
    }
    if args.slice {
        return slice::run_render(args, &file, to);
    }
    let (trajectory, document) = simulated(&file, &args.common, &args.engine)?;
    output::write(to, &picture::svg(file.scene(), &document))?;
    Ok(status(&trajectory))
}

/// Reads the scene that is asked for; `-` is standard input.
fn read(common: &Common) -> Result<SceneFile, Failure> {
    let (name, bytes) = read_bytes(common)?;
    parse(common, &name, &bytes)
}

/// The bytes of the file that is asked for, and its name for messages.
fn read_bytes(common: &Common) -> Result<(String, Vec<u8>), Failure> {
    output::prepare(&common.file, common.out.as_deref())?;
    let mut bytes = Vec::new();
    let (name, done) = if common.file == Path::new("-") {
        (
            "<stdin>".to_owned(),
            std::io::stdin().lock().read_to_end(&mut bytes).map(|_| ()),
        )
    } else {
        let name = common.file.display().to_string();
        (name, std::fs::read(&common.file).map(|b| bytes = b))
    };
    if common.file.is_dir() {
        return Err(format!("{name}: this is a directory; give a file").into());
    }
    done.map_err(|e| format!("{name}: {e}"))?;
    Ok((name, bytes))
}

/// The overrides of `--set`.
fn overrides(common: &Common) -> Result<Vec<(&str, &str)>, Failure> {
    let mut overrides = Vec::new();
    for set in &common.set {
        match set.split_once('=') {
            Some((path, value)) => overrides.push((path.trim(), value.trim())),
            None => return Err(format!("--set {set}: expected NAME=VALUE").into()),
        }
    }
    Ok(overrides)
}

fn parse(common: &Common, name: &str, bytes: &[u8]) -> Result<SceneFile, Failure> {
    let overrides = overrides(common)?;
    scene::read_scene_bytes(name, bytes, &overrides)
        .map_err(|errors| mistaken(name, bytes, Guise::Scene, errors))
}

/// A file of another kind is named as such, instead of all its keys that are unknown here.
fn mistaken(name: &str, bytes: &[u8], wanted: Guise, errors: Vec<Diagnostic>) -> Failure {
    let is = guise(name, bytes).filter(|g| *g != wanted);
    let help = match (is, wanted) {
        (Some(Guise::Result), _) => "this is a result; give the file that it was made from",
        (Some(Guise::Structure), _) => {
            "this is a structure; it is for flex, brace, loosen, separate, render and check"
        }
        (Some(Guise::Scene), _) => {
            "this is a scene; it is for simulate, classify, forces, slice, trade, render and check"
        }
        (None, _) => return Failure::Scene(errors),
    };
    Failure::Message(format!("{name}:1:1: {help}"))
}

fn simulated(
    file: &SceneFile,
    common: &Common,
    engine: &Engine,
) -> Result<(Trajectory, ResultDocument), Failure> {
    let how = provenance(engine)?;
    if !common.quiet {
        for warning in file.warnings() {
            let _ = writeln!(std::io::stderr(), "{warning}");
        }
    }
    let show = !common.quiet && std::io::stderr().is_terminal();
    let spinner = show.then(progress::Spinner::start);
    let tell = |p| {
        if let Some(spinner) = &spinner {
            spinner.tell(p);
        }
    };
    let options = Options {
        deadline: deadline(engine),
        progress: Some(&tell),
        arithmetic: arithmetic(engine),
        method: method(engine),
        face: engine.face,
    };
    let trajectory = simulate(file.scene(), &options).map_err(|error| misplanned(file, &error))?;
    let document = ResultDocument::new(file.scene(), &trajectory, how);
    Ok((trajectory, document))
}

/// Refuses options that would do nothing: each with whether it was given.
fn idle(options: &[(&str, bool)], why: &str) -> Result<(), Failure> {
    match options.iter().find(|o| o.1) {
        Some((option, _)) => Err(format!("{option} {why}").into()),
        None => Ok(()),
    }
}

/// When to give up.
fn deadline(engine: &Engine) -> Option<Instant> {
    let limit = engine.time_limit?;
    Instant::now().checked_add(limit)
}

/// A plan that the engine found impossible, placed in the file.
fn misplanned(file: &SceneFile, error: &PlanError) -> Failure {
    let (PlanError::NeverCollides { phase } | PlanError::Impossible { phase }) = error;
    let place = format!("motion.{phase}.until");
    Failure::Scene(vec![
        file.error_at(&place, "endless-motion")
            .message(error.to_string()),
    ])
}

fn provenance(engine: &Engine) -> Result<Provenance, Failure> {
    let unbuilt = |option: &str, asked: &str, built: &str| {
        Failure::Message(format!(
            "--{option} {asked} is not built yet; there is: {built}"
        ))
    };
    let backend = match engine.backend {
        args::Backend::Num => snapfit::number::Backend::Num,
        args::Backend::Rug => snapfit::number::Backend::Rug,
    };
    if !snapfit::number::set_backend(backend) {
        return Err(unbuilt("backend", backend.name(), "num"));
    }
    let arithmetic = arithmetic(engine);
    if engine.arithmetic != Arithmetic::F64 {
        let asked = [
            ("--tolerance", engine.tolerance.is_some()),
            ("--identify", engine.identify.is_some()),
        ];
        idle(&asked, "is for --arithmetic f64: nothing else rounds")?;
    }
    Ok(Provenance {
        arithmetic: arithmetic.name(),
        method: method(engine).under(&arithmetic),
    })
}

/// The algorithm that the options ask for.
fn method(engine: &Engine) -> motion::Method {
    match engine.method {
        Method::Auto => motion::Method::Auto,
        Method::Sweep => motion::Method::Sweep,
        Method::Naive => motion::Method::Naive,
    }
}

/// The arithmetic that the options ask for.
fn arithmetic(engine: &Engine) -> motion::Arithmetic {
    match engine.arithmetic {
        Arithmetic::Exact => motion::Arithmetic::Exact,
        Arithmetic::Filtered => motion::Arithmetic::Filtered,
        Arithmetic::F64 => motion::Arithmetic::F64(FloatOptions {
            tolerance: engine.tolerance.unwrap_or(1e-9),
            identify: match engine.identify.unwrap_or(args::Identify::Names) {
                args::Identify::None => Identify::None,
                args::Identify::Times => Identify::Times,
                args::Identify::Names => Identify::Names,
            },
        }),
    }
}

fn status(trajectory: &Trajectory) -> u8 {
    match trajectory.outcome.kind {
        OutcomeKind::Undecided => UNDECIDED,
        _ => DECIDED,
    }
}

fn format_of(asked: Option<Format>, common: &Common) -> Format {
    let watched = common.out.is_none() && std::io::stdout().is_terminal();
    asked.unwrap_or(if watched {
        Format::Summary
    } else {
        Format::Json
    })
}

/// Colours only on a terminal, and not where the user wants none (NO_COLOR).
fn colour_on(terminal: bool) -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|t| t == "dumb");
    terminal && !set("NO_COLOR") && !dumb
}

fn style() -> summary::Style {
    if colour_on(std::io::stdout().is_terminal()) {
        summary::Style::Ansi
    } else {
        summary::Style::Plain
    }
}

fn complain(failure: &Failure) {
    let mut stderr = std::io::stderr().lock();
    // Where even standard error is closed there is nobody to tell.
    let _ = match failure {
        Failure::Message(message) => writeln!(stderr, "snapfit: {message}"),
        Failure::Scene(diagnostics) => {
            let all: String = diagnostics.iter().map(told).collect();
            stderr.write_all(all.as_bytes())
        }
    };
}

/// A diagnostic: with a picture of the place on a terminal, else a line that tools understand.
fn told(d: &Diagnostic) -> String {
    if std::io::stderr().is_terminal() {
        return d.render(if colour_on(true) {
            Rendering::Colour
        } else {
            Rendering::Unicode
        });
    }
    match d.advice() {
        Some(advice) => format!("{d}\n  help: {advice}\n"),
        None => format!("{d}\n"),
    }
}

/// What clap makes of the arguments: help, the version, or an error.
fn usage(error: &clap::Error) -> u8 {
    let _ = error.print();
    if error.kind() == ErrorKind::InvalidSubcommand {
        let _ = writeln!(
            std::io::stderr(),
            "\nThere is: {}",
            args::verbs().join(", ")
        );
    }
    if error.use_stderr() { BAD } else { DECIDED }
}

/// A panic is a bug: one line that asks for a report, and the long form for those who ask for it.
fn report_panics() {
    let wanted = std::env::var_os("RUST_BACKTRACE").is_some_and(|v| v != "0");
    let long = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let payload = info.payload();
        let what = payload.downcast_ref::<&str>().copied();
        let what = what.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        let what = what.unwrap_or("unknown").replace('\n', " ");
        let place = info
            .location()
            .map_or_else(String::new, |l| format!(" at {l}"));
        let _ = writeln!(
            std::io::stderr(),
            "snapfit {}: internal error{place}: {what}. This is a bug: please report it together \
             with the scene that shows it",
            env!("CARGO_PKG_VERSION")
        );
        if wanted {
            long(info);
        }
    }));
}
