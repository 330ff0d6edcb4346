//! The verbs of structures: `flex` and `generate`, and `check` of a structure.

use crate::args::{Common, Format, seconds};
use crate::{DECIDED, Failure, UNDECIDED, output};
use clap::{Args, ValueEnum};
use snapfit::flex::report::{FlexDocument, StructureCheck};
use snapfit::flex::{self, Corners, FlexOptions, Path as PathRule, StructureFile};
use snapfit::lp;
use snapfit::report::pretty;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::Duration;

/// Arguments of `snapfit flex`.
#[derive(Args)]
pub(crate) struct FlexArgs {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    format: crate::flex_apps::FormatArg,
    /// How much is proven of every linear program
    #[arg(long, value_enum, default_value = "exact")]
    accuracy: Accuracy,
    /// What becomes of convex corners that face each other
    #[arg(long, value_enum, default_value = "average")]
    corners: CornerRule,
    /// How much the path must respect [default: what the structure says]
    #[arg(long, value_enum)]
    path: Option<PathArg>,
    /// Give up, undecided, after so many seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    time_limit: Option<Duration>,
    /// Write every linear program into a directory, as step0.mps and so on
    #[arg(long, value_name = "DIR")]
    programs: Option<PathBuf>,
    /// Bound the flex from outside too: what no motion without collision can exceed
    #[arg(long)]
    bound: bool,
    /// Give the exact first contact, up to which the path is free of collision
    #[arg(long)]
    contact: bool,
    /// Leave the certificates unchecked
    #[arg(long)]
    no_verify: bool,
    /// Only list the constraints where the structure stands, and what each alone allows
    #[arg(long)]
    constraints: bool,
}

/// Arguments of `snapfit generate`.
#[derive(Args)]
pub(crate) struct GenerateArgs {
    /// grid, jit, jrot, ring, chain, wall, can, flock or tree
    family: String,
    /// Number of bodies
    #[arg(
        long,
        required_unless_present = "drawing",
        allow_negative_numbers = true
    )]
    bodies: Option<usize>,
    /// Instead of a family, the name of a structure whose blocks this file shows: # a block, @ a
    /// fixed one, . nothing
    #[arg(long, value_name = "FILE", conflicts_with = "bodies")]
    drawing: Option<PathBuf>,
    /// What random shifts, turns and branches come from
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write to a file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Accuracy {
    /// Nothing is proven
    Float,
    /// A rational enclosure of every optimum
    Bounds,
    /// Every optimum itself
    Exact,
}

impl Accuracy {
    pub(crate) fn level(self) -> lp::Accuracy {
        match self {
            Accuracy::Float => lp::Accuracy::Float,
            Accuracy::Bounds => lp::Accuracy::Bounds,
            Accuracy::Exact => lp::Accuracy::Exact,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CornerRule {
    /// One half-plane with an averaged normal
    Average,
    /// The exact disjunction of four edges, by branch and bound
    Branch,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PathArg {
    /// Constraints hold at the ends of steps up to the violation allowed
    Fast,
    /// Nothing ever collides, proven
    Safe,
}

pub(crate) fn parse(common: &Common, name: &str, bytes: &[u8]) -> Result<StructureFile, Failure> {
    let overrides = crate::overrides(common)?;
    let file = flex::read_structure(name, bytes, &overrides)
        .map_err(|errors| crate::mistaken(name, bytes, flex::Guise::Structure, errors))?;
    if !common.quiet {
        for warning in file.warnings() {
            let _ = writeln!(std::io::stderr(), "{warning}");
        }
    }
    Ok(file)
}

pub(crate) fn run_flex(args: &FlexArgs) -> Result<u8, Failure> {
    let (name, bytes) = crate::read_bytes(&args.common)?;
    let file = parse(&args.common, &name, &bytes)?;
    if args.constraints {
        return crate::flex_apps::run_constraints(&args.common, file.structure());
    }
    if file.structure().objective.is_empty() {
        return Err(Failure::Scene(vec![
            file.error_at("structure", "missing-key")
                .message("the structure asks nothing: it has no [objective]")
                .help("add [objective] with terms = [ { body = \"…\", dy = \"1\" } ]"),
        ]));
    }
    let mut structure = file.into_structure();
    match args.path {
        Some(PathArg::Fast) => structure.step.path = PathRule::Fast,
        Some(PathArg::Safe) => structure.step.path = PathRule::Safe,
        None => {}
    }
    let show = !args.common.quiet && std::io::stderr().is_terminal();
    let spinner = show.then(crate::progress::Spinner::start);
    let tell = |p: flex::FlexProgress| {
        if let Some(spinner) = &spinner {
            spinner.say(format!(
                "step {}: {} bodies, {} rows, displacement {:.6}, last gain {:.1e}",
                p.step, p.bodies, p.rows, p.displacement, p.gain
            ));
        }
    };
    let (accuracy, word) = match args.accuracy {
        Accuracy::Float => (lp::Accuracy::Float, "float"),
        Accuracy::Bounds => (lp::Accuracy::Bounds, "bounds"),
        Accuracy::Exact => (lp::Accuracy::Exact, "exact"),
    };
    if let Some(dir) = args.programs.as_ref().filter(|d| !d.is_dir()) {
        return Err(format!("{}: no folder to write programs to", dir.display()).into());
    }
    let count = std::cell::Cell::new(0u32);
    let write = |model: &lp::Model| {
        if let Some(dir) = &args.programs {
            let path = dir.join(format!("step{}.mps", count.replace(count.get() + 1)));
            if let Err(e) = output::write(Some(&path), &flex::to_mps(model)) {
                let _ = writeln!(std::io::stderr(), "snapfit: {e}");
            }
        }
    };
    let options = FlexOptions {
        programs: Some(&write),
        accuracy,
        method: lp::Method::Warm,
        corners: match args.corners {
            CornerRule::Average => Corners::Average,
            CornerRule::Branch => Corners::Branch,
        },
        time_limit: args.time_limit,
        verify: !args.no_verify && accuracy != lp::Accuracy::Float,
        contact: args.contact,
        progress: Some(&tell),
    };
    let flexed = flex::flex(&structure, &options);
    let bound = args
        .bound
        .then(|| flex::outer_bound(&structure, args.time_limit));
    drop(spinner);
    let mut document = FlexDocument::new(&structure, &flexed, word);
    document.bound = bound.map(|b| document.bounded(&b));
    crate::flex_apps::tell(&document, &args.format, &args.common)?;
    Ok(if FlexDocument::decided(flexed.ending) {
        DECIDED
    } else {
        UNDECIDED
    })
}

pub(crate) fn run_generate(args: &GenerateArgs) -> Result<u8, Failure> {
    let structure = match (&args.drawing, args.bodies) {
        (Some(path), _) => {
            output::spare_input(path, args.out.as_deref())?;
            let text =
                std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
            flex::apps::layout::layout(&args.family, &text)?
        }
        (None, bodies) => flex::generate::generate(&args.family, bodies.unwrap_or(0), args.seed)?,
    };
    output::write(args.out.as_deref(), &flex::structure_to_toml(&structure))?;
    Ok(DECIDED)
}

/// `check` of a structure.
pub(crate) fn run_check(
    common: &Common,
    name: &str,
    bytes: &[u8],
    format: Option<Format>,
) -> Result<u8, Failure> {
    let overrides = crate::overrides(common)?;
    let file = flex::read_structure(name, bytes, &overrides)
        .map_err(|errors| crate::mistaken(name, bytes, flex::Guise::Structure, errors))?;
    let warnings = file.warnings().iter().map(ToString::to_string).collect();
    let report = StructureCheck::of(file.structure(), warnings);
    let text = match crate::format_of(format, common) {
        Format::Json => {
            pretty(
                &serde_json::to_string(&report).map_err(|e| e.to_string())?,
                100,
            ) + "\n"
        }
        Format::Summary => report.to_string(),
    };
    output::write(common.out.as_deref(), &text)?;
    Ok(DECIDED)
}
