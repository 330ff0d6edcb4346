//! The arguments, as clap reads them.

use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// Predicts, exactly, the motion of planar mechanisms that click
#[derive(Parser)]
#[command(
    version,
    about,
    max_term_width = 100,
    after_help = "\
Exit status: 0 decided (a jam is a result), 2 bad usage or bad input, 3 undecided within the limits\n\
given, 4 decided but not as --expect says, 1 a bug."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Subcommand)]
pub(crate) enum Verb {
    /// Simulate a scene: its events, contacts and outcome
    Simulate(Simulate),
    /// Validate a scene and say what would be modelled
    Check(Check),
    /// Say what locks it, and how firmly: the motion-diode class
    Classify(Classify),
    /// Enclose the contact forces and torques, and their peaks
    Forces(Forces),
    /// Draw the mechanism at its events, and its angles over time
    Render(Render),
    /// The free component that holds the start: its boundary, exactly, and questions to it
    Slice(crate::slice::SliceArgs),
    /// The face of bare arcs that holds the start: an unbounded one counts the frame at infinity too, four
    /// half-edges and a cycle, as CGAL does
    Face(crate::face::FaceArgs),
    /// Flex a structure of loosely joined bodies as far as it goes (PuzzleFlex)
    Flex(crate::flex::FlexArgs),
    /// Write a structure of one of the paper's families
    Generate(crate::flex::GenerateArgs),
    /// Find where a beam would hold a structure most
    Brace(crate::flex_apps::BraceArgs),
    /// Loosen a structure's joints, or find how loose they may be
    Loosen(crate::flex_apps::LoosenArgs),
    /// Decide whether a structure comes apart, and in which order
    Separate(crate::flex_apps::SeparateArgs),
    /// Solve a linear program exactly: status, objective and certificate
    Lp(snapfit::lp::cli::LpArgs),
    /// Check a linear program's certificate with code of its own
    Verify(snapfit::lp::cli::VerifyArgs),
    /// Speed against accuracy over the arithmetics: table, JSON and plot
    Trade(super::trade::Trade),
    /// Print the JSON Schema of a file format
    Schema(Schema),
}

/// The verbs that there are.
pub(crate) fn verbs() -> Vec<String> {
    let command = Cli::command();
    command
        .get_subcommands()
        .map(|c| c.get_name().to_owned())
        .collect()
}

#[derive(Args)]
pub(crate) struct Simulate {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(flatten)]
    pub(crate) engine: Engine,
    /// Leave the ledger's seconds out: two results of one scene are then the same to the byte
    #[arg(long)]
    pub(crate) no_times: bool,
    /// What to print [default: summary on a terminal, else json]
    #[arg(long, value_enum)]
    pub(crate) format: Option<Format>,
}

#[derive(Args)]
pub(crate) struct Classify {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(flatten)]
    pub(crate) engine: Engine,
    /// For use in CI: exit with status 4 unless the class is this one: none, force, friction or
    /// kinematic, or total-friction and so on, which asks that it hold in every direction too (see
    /// classify.total in the scene). With --svg the picture shows what was found instead
    #[arg(long, value_name = "CLASS")]
    pub(crate) expect: Option<String>,
    /// Draw the motion that decides (the escape, where there is one) and, where every direction is
    /// asked for, the rose of directions, as SVG to PATH
    #[arg(long, value_name = "PATH")]
    pub(crate) svg: Option<PathBuf>,
    /// Where a way out was found: write the scene with it appended to its plan, as TOML to PATH
    #[arg(long, value_name = "PATH")]
    pub(crate) escape: Option<PathBuf>,
    /// What to print [default: summary on a terminal, else json]
    #[arg(long, value_enum)]
    pub(crate) format: Option<Format>,
}

#[derive(Args)]
pub(crate) struct Forces {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(flatten)]
    pub(crate) engine: Engine,
    /// Significant digits of every enclosure
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) digits: u32,
    /// Add what the root feels, all pawls together: its peaks, the way back run too, and assembly
    /// against disassembly (several times a simulation)
    #[arg(long)]
    pub(crate) root: bool,
    /// Add the drive's work and what snaps set free
    #[arg(long)]
    pub(crate) work: bool,
    /// Add the histories: all loads at N instants of each phase
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=10000))]
    pub(crate) samples: Option<u32>,
    /// Add each value without friction beside it
    #[arg(long)]
    pub(crate) without_friction: bool,
    /// Add the snap-fit handbook's formula, and why it parts from the model
    #[arg(long)]
    pub(crate) handbook: bool,
    /// Add all of these, the histories at 8 instants of each phase
    #[arg(long)]
    pub(crate) all: bool,
    /// Draw force over travel as SVG, to PATH (the way back run too)
    #[arg(long, value_name = "PATH")]
    pub(crate) svg: Option<PathBuf>,
    /// What to print [default: summary on a terminal, else json]
    #[arg(long, value_enum)]
    pub(crate) format: Option<Format>,
}

#[derive(Args)]
pub(crate) struct Check {
    #[command(flatten)]
    pub(crate) common: Common,
    /// What to print [default: summary on a terminal, else json]
    #[arg(long, value_enum)]
    pub(crate) format: Option<Format>,
}

#[derive(Args)]
pub(crate) struct Render {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(flatten)]
    pub(crate) engine: Engine,
    /// Draw as SVG, to PATH or to standard output
    #[arg(long, value_name = "PATH", num_args = 0..=1, default_missing_value = "-")]
    pub(crate) svg: Option<PathBuf>,
    /// Draw a slice of configuration space instead: the free component and the way through it
    #[arg(long)]
    pub(crate) slice: bool,
    #[command(flatten)]
    pub(crate) which: crate::slice::Which,
    /// Of a structure only: so many pictures of its way, PATH with a number before its ending
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) frames: Option<u32>,
    /// Of a structure: how much is proven of every linear program
    #[arg(long, value_enum, default_value = "exact")]
    pub(crate) accuracy: crate::flex::Accuracy,
}

#[derive(Args)]
pub(crate) struct Schema {
    /// Which format
    #[arg(value_enum)]
    pub(crate) name: Name,
    /// Write to a file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Common {
    /// A scene, TOML or JSON; - is standard input
    pub(crate) file: PathBuf,
    /// Change a value of the scene before it is read, e.g. pawl.left.stiffness=3/2 (repeatable)
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<String>,
    /// Write to a file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// No warnings and no progress
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct Engine {
    /// Which numbers decide
    #[arg(long, value_enum, default_value = "filtered")]
    pub(crate) arithmetic: Arithmetic,
    /// With --arithmetic f64: zeros nearer than this are one [default: 1e-9]
    #[arg(long, value_name = "DISTANCE", allow_negative_numbers = true, value_parser = tolerance)]
    pub(crate) tolerance: Option<f64>,
    /// With --arithmetic f64: which zeros are taken for one [default: names]
    #[arg(long, value_enum)]
    pub(crate) identify: Option<Identify>,
    /// Which library carries long integers
    #[arg(long, value_enum, default_value = "num")]
    pub(crate) backend: Backend,
    /// Which algorithm runs
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) method: Method,
    /// Which way the sweep comes by the free component
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) face: snapfit::face::Method,
    /// Give up, undecided, after so many seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    pub(crate) time_limit: Option<Duration>,
}

pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    let t: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    if t.is_finite() && t >= 0.0 {
        Ok(t)
    } else {
        Err("expected a number that is not negative".to_owned())
    }
}

pub(crate) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text
        .parse()
        .map_err(|_| "expected a number of seconds".to_owned())?;
    Duration::try_from_secs_f64(seconds)
        .map_err(|_| "expected a number of seconds that is not negative".to_owned())
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Arithmetic {
    /// Exact numbers only: the reference, slow
    Exact,
    /// Certified double enclosures first, exact numbers where they cannot tell; the same answers
    Filtered,
    /// Doubles with a tolerance: fast, and may be wrong
    F64,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Identify {
    /// None
    None,
    /// Those nearer than the tolerance
    Times,
    /// Those nearer than the tolerance, and those that bear one name
    Names,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Backend {
    /// num-bigint
    Num,
    /// GMP by rug, where it is built in
    Rug,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Method {
    /// By the size of each phase; the result says what ran
    Auto,
    /// A sweep over the free component; with f64 every step looks at every arc
    Sweep,
    /// Every step looks at every arc
    Naive,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For programs
    Json,
    /// For people
    Summary,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Name {
    /// The scene file
    Scene,
    /// The structure file
    Structure,
    /// The result of `simulate`
    Result,
    /// The result of `slice`
    Slice,
    /// The result of `classify`
    Classify,
    /// The result of `forces`
    Forces,
    /// The result of `lp`
    Lp,
}
