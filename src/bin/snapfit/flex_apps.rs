//! The verbs of the applications of structures: `brace`, `loosen`, `separate`.

use crate::args::{Common, Format, seconds};
use crate::flex::{Accuracy, parse};
use crate::{DECIDED, Failure, UNDECIDED, UNEXPECTED, output};
use clap::{Args, ValueEnum};
use serde::Serialize;
use snapfit::flex::apps::brace::{BraceDocument, Change, brace, with_question};
use snapfit::flex::apps::constraints::ConstraintsDocument;
use snapfit::flex::apps::loosen::{LoosenDocument, Measure, loosen, tolerance};
use snapfit::flex::apps::separate::{SeparateDocument, Separated, separate};
use snapfit::flex::apps::sequence::{SequenceDocument, sequence};
use snapfit::flex::{Ending, FlexOptions, Pose, Structure, structure_to_toml};
use snapfit::geometry::Vec2;
use snapfit::number::Rat;
use snapfit::report::picture::{StructurePicture, structure_svg};
use snapfit::report::pretty;
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

/// Arguments of `snapfit brace`.
#[derive(Args)]
pub(crate) struct BraceArgs {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    format: FormatArg,
    /// How much is proven of every linear program
    #[arg(long, value_enum, default_value = "exact")]
    accuracy: Accuracy,
    /// Which changes of distance count
    #[arg(long, value_enum, default_value = "apart")]
    change: ChangeArg,
    /// Draw the flexed structure with the beam
    #[arg(long, value_name = "PATH")]
    svg: Option<PathBuf>,
    /// Give up, undecided, after so many seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    time_limit: Option<Duration>,
}

/// Arguments of `snapfit loosen`.
#[derive(Args)]
#[command(group = clap::ArgGroup::new("question").required(true).args(["by", "limit"]))]
pub(crate) struct LoosenArgs {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    format: FormatArg,
    /// Inset every body by this much, and print the structure
    #[arg(long, value_name = "DISTANCE", allow_negative_numbers = true, value_parser = exact)]
    by: Option<Rat>,
    /// Find the largest inset whose flex is within this limit
    #[arg(long, value_name = "FLEX", allow_negative_numbers = true, value_parser = exact)]
    limit: Option<Rat>,
    /// With --limit: how finely insets are told apart
    #[arg(long, value_name = "DISTANCE", value_parser = exact, default_value = "1/1024")]
    resolution: Rat,
    /// With --limit: what is held against it
    #[arg(long, value_enum, default_value = "stepped")]
    measure: MeasureArg,
    /// How much is proven of every linear program
    #[arg(long, value_enum, default_value = "exact")]
    accuracy: Accuracy,
}

/// Arguments of `snapfit separate`.
#[derive(Args)]
pub(crate) struct SeparateArgs {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    format: FormatArg,
    /// Leave rotations out; directions are then checked for all time
    #[arg(long)]
    translations: bool,
    /// Take the bodies away one after the other, by translations
    #[arg(long)]
    sequence: bool,
    /// Draw a step in the direction found, to PATH
    #[arg(long, value_name = "PATH")]
    svg: Option<PathBuf>,
    /// With --svg: how far the fastest body goes [default: a quarter of the drawing's height]
    #[arg(long, value_name = "DISTANCE", value_parser = exact, requires = "svg")]
    step: Option<Rat>,
    /// Exit with status 4 unless it comes apart, or unless it holds
    #[arg(long, value_enum)]
    expect: Option<ExpectArg>,
    /// Give up on a program, and on the sequence, after so many seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    time_limit: Option<Duration>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ChangeArg {
    /// Vertices that moved apart
    Apart,
    /// Vertices that moved together
    Together,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MeasureArg {
    /// What time stepping reaches
    Stepped,
    /// The optimum of the first linear program
    Linear,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ExpectArg {
    /// It comes apart
    ComesApart,
    /// It holds
    Holds,
}

/// An exact number of the command line, in the notation of files.
fn exact(text: &str) -> Result<Rat, String> {
    snapfit::number::literal::parse(text).map_err(|e| e.to_string())
}

/// The format of a verb of structures.
#[derive(Args)]
pub(crate) struct FormatArg {
    /// How the result is told [default: summary on a terminal, json elsewhere]
    #[arg(long, value_enum)]
    format: Option<Format>,
}

/// Prints a document as JSON, or for people.
pub(crate) fn tell<D: Serialize + std::fmt::Display>(
    document: &D,
    format: &FormatArg,
    common: &Common,
) -> Result<(), Failure> {
    match crate::format_of(format.format, common) {
        Format::Json => print(document, common),
        Format::Summary => Ok(output::write(common.out.as_deref(), &document.to_string())?),
    }
}

fn print(document: &impl Serialize, common: &Common) -> Result<(), Failure> {
    let text = serde_json::to_string(document).map_err(|e| e.to_string())?;
    output::write(common.out.as_deref(), &(pretty(&text, 100) + "\n"))?;
    Ok(())
}

fn read(common: &Common) -> Result<Structure, Failure> {
    let (name, bytes) = crate::read_bytes(common)?;
    Ok(parse(common, &name, &bytes)?.into_structure())
}

fn decided(ending: Ending) -> u8 {
    if ending == Ending::Undecided {
        UNDECIDED
    } else {
        DECIDED
    }
}

/// `flex --constraints`.
pub(crate) fn run_constraints(common: &Common, structure: &Structure) -> Result<u8, Failure> {
    print(&ConstraintsDocument::new(structure), common)?;
    Ok(DECIDED)
}

pub(crate) fn run_brace(args: &BraceArgs) -> Result<u8, Failure> {
    let structure = with_question(&read(&args.common)?);
    let options = FlexOptions {
        accuracy: args.accuracy.level(),
        time_limit: args.time_limit,
        ..FlexOptions::default()
    };
    let change = match args.change {
        ChangeArg::Apart => Change::Apart,
        ChangeArg::Together => Change::Together,
    };
    let (flexed, found) = brace(&structure, change, &options)?;
    let document = BraceDocument::new(&structure, &flexed, found.as_ref());
    if let (Some(path), Some(before), Some(after)) = (
        &args.svg,
        flexed.configurations.first(),
        flexed.configurations.last(),
    ) {
        output::spare_input(&args.common.file, Some(path))?;
        let double = |r: &Rat| r.nearest_f64().unwrap_or(0.0);
        let title = match &document.brace {
            Some(b) => format!(
                "{}: a beam from {} to {}, {:.4} before and {:.4} after",
                structure.name,
                b.ends[0].0,
                b.ends[1].0,
                b.before.approx(),
                b.after.approx()
            ),
            None => format!("{}: no beam would hold anything", structure.name),
        };
        let svg = structure_svg(&StructurePicture {
            structure: &structure,
            before,
            after,
            title,
            note: "the dashed line joins the vertices in sight of each other that moved most"
                .to_owned(),
            brace: found
                .as_ref()
                .map(|b| b.before.each_ref().map(|p| [double(&p.x), double(&p.y)])),
            frame: &[],
        });
        output::write(Some(path), &svg)?;
    }
    tell(&document, &args.format, &args.common)?;
    Ok(decided(flexed.ending))
}

pub(crate) fn run_loosen(args: &LoosenArgs) -> Result<u8, Failure> {
    let structure = read(&args.common)?;
    if let Some(by) = &args.by {
        let loose = loosen(&structure, by)?;
        output::write(args.common.out.as_deref(), &structure_to_toml(&loose))?;
        return Ok(DECIDED);
    }
    let limit = args.limit.clone().unwrap_or_else(Rat::zero);
    if structure.objective.is_empty() {
        return Err("the structure asks nothing: it has no [objective]"
            .to_owned()
            .into());
    }
    let measure = match args.measure {
        MeasureArg::Stepped => Measure::Stepped,
        MeasureArg::Linear => Measure::Linear,
    };
    let options = FlexOptions {
        accuracy: args.accuracy.level(),
        ..FlexOptions::default()
    };
    let found = tolerance(&structure, &limit, &args.resolution, measure, &options)?;
    let document = LoosenDocument::new(&structure, &limit, measure, &found);
    tell(&document, &args.format, &args.common)?;
    Ok(DECIDED)
}

/// The picture of a step in the first direction found.
fn parted(structure: &Structure, found: &Separated, step: Option<&Rat>) -> String {
    let before: Vec<Pose> = structure.bodies.iter().map(Pose::of).collect();
    let apart = found.verdict() == "comes-apart" && found.way_out.is_none();
    let clear = found.cases.iter().find(|c| c.parts && c.clear.is_some());
    let parting = clear.or_else(|| found.cases.iter().find(|c| c.parts && apart));
    let velocities = match (parting, &found.way_out) {
        (Some(case), _) => case.velocities.clone(),
        (None, Some((body, d))) => {
            let mut all = vec![[0; 3].map(|_| Rat::zero()); structure.bodies.len()];
            let top = d.x.abs().max(d.y.abs());
            (all[*body][0], all[*body][1]) = (&d.x / &top, &d.y / &top);
            Some(all)
        }
        (None, None) => None,
    };
    let heights = || {
        structure
            .bodies
            .iter()
            .flat_map(|b| b.vertices.iter().map(|v| &v.y))
    };
    let size = match (heights().min(), heights().max()) {
        (Some(low), Some(high)) => high - low,
        _ => Rat::one(),
    };
    let step = step.cloned().unwrap_or(size / Rat::from(4));
    let after = match velocities {
        None => before.clone(),
        Some(ref all) => before
            .iter()
            .zip(all)
            .map(|(pose, [x, y, theta])| Pose {
                place: &pose.place + &Vec2::new(x * &step, y * &step),
                tan_half: &pose.tan_half + &(theta * &step) / &Rat::from(2),
            })
            .collect(),
    };
    let what = match velocities {
        Some(_) => "a step in a direction of separation",
        None if found.verdict() == "undecided" => "undecided whether it comes apart",
        None => "nothing comes apart",
    };
    structure_svg(&StructurePicture {
        structure,
        before: &before,
        after: &after,
        title: format!("{}: {what}", structure.name),
        note: String::new(),
        brace: None,
        frame: &[],
    })
}

pub(crate) fn run_separate(args: &SeparateArgs) -> Result<u8, Failure> {
    let structure = read(&args.common)?;
    let found = separate(&structure, args.translations, args.time_limit);
    let mut document = SeparateDocument::new(&structure, args.translations, &found);
    if args.sequence {
        let order = sequence(&structure, args.time_limit);
        document.with_sequence(SequenceDocument::new(&structure, &order));
    }
    if let Some(path) = &args.svg {
        output::spare_input(&args.common.file, Some(path))?;
        output::write(Some(path), &parted(&structure, &found, args.step.as_ref()))?;
    }
    tell(&document, &args.format, &args.common)?;
    let expected = match args.expect {
        None => {
            return Ok(if document.verdict == "undecided" {
                UNDECIDED
            } else {
                DECIDED
            });
        }
        Some(ExpectArg::ComesApart) => "comes-apart",
        Some(ExpectArg::Holds) => "holds",
    };
    if document.verdict == "undecided" {
        return Ok(UNDECIDED);
    }
    if document.verdict == expected {
        return Ok(DECIDED);
    }
    let _ = writeln!(
        std::io::stderr(),
        "snapfit: not as expected: it {}",
        document.verdict.replace('-', " ")
    );
    Ok(UNEXPECTED)
}
