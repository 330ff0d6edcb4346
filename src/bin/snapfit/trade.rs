//! `trade`: speed against accuracy over the arithmetics.

use super::{DECIDED, Failure, UNDECIDED, output};
use clap::{Args, ValueEnum};
use serde::Serialize;
use snapfit::flex::{Guise, guise};
use snapfit::kernel::Identify;
use snapfit::motion::Arithmetic;
use snapfit::report::pretty;
use snapfit::scene::{Scene, read_scene_bytes};
use snapfit::trade::family::{FAMILIES, Family, breakdown};
use snapfit::trade::table::{Rates, SceneRows, rates, rates_table, scene_table, trade};
use snapfit::trade::{Setting, map, plot};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Args)]
pub(crate) struct Trade {
    /// Scenes, or folders of them (searched through)
    #[arg(required_unless_present = "breakdown")]
    files: Vec<PathBuf>,
    /// Close the gap of a family instead: strike, race, pass, friction, parallel
    #[arg(long, value_name = "FAMILY", conflicts_with = "files")]
    breakdown: Option<String>,
    /// With --breakdown: gaps from 1 down to 2^-K
    #[arg(long, value_name = "K", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=2000))]
    most: u32,
    /// With --breakdown: every so many k
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
    /// Map the neighbouring doubles of a pawl's vertex instead of timing
    #[arg(long)]
    map: bool,
    /// With --map: which vertex, as PAWL.VERTEX by number
    #[arg(long, value_name = "PAWL.VERTEX", default_value = "0.1", value_parser = vertex)]
    vertex: (usize, usize),
    /// With --map: doubles a side
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(2..=1024))]
    size: u32,
    /// f64: zeros nearer than this are one
    #[arg(long, value_name = "DISTANCE", allow_negative_numbers = true, value_parser = super::args::tolerance, default_value = "1e-9")]
    tolerance: f64,
    /// Take the least time of so many runs
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeat: u32,
    /// Leave out the slow settings: exact and time stepping
    #[arg(long)]
    fast: bool,
    /// Give up on a run, undecided, after so many seconds
    #[arg(long, value_name = "SECONDS", default_value = "20", allow_negative_numbers = true, value_parser = super::args::seconds)]
    time_limit: Duration,
    /// What to print [default: table on a terminal, else json]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Draw as SVG
    #[arg(long, value_name = "PATH")]
    svg: Option<PathBuf>,
    /// Write to a file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For programs
    Json,
    /// For people
    Table,
}

fn vertex(text: &str) -> Result<(usize, usize), String> {
    let parsed = text
        .split_once('.')
        .and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    parsed.ok_or_else(|| "expected PAWL.VERTEX, two numbers".to_owned())
}

/// What is printed for scenes.
#[derive(Serialize)]
struct Document {
    schema: &'static str,
    tolerance: f64,
    scenes: Vec<SceneRows>,
    rates: Vec<Rates>,
    undecided: Vec<String>,
}

pub(crate) fn run(args: &Trade) -> Result<u8, Failure> {
    // Where doubles break down it is a finding, not a bug to be reported.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let done = compare(args);
    std::panic::set_hook(hook);
    done
}

fn compare(args: &Trade) -> Result<u8, Failure> {
    output::apart(args.svg.as_deref(), args.out.as_deref())?;
    if let Some(name) = &args.breakdown {
        return close(args, name);
    }
    let files = collect(&args.files)?;
    for file in &files {
        for to in [&args.svg, &args.out] {
            output::spare_input(file, to.as_deref())?;
        }
    }
    let mut scenes = Vec::new();
    for file in &files {
        let bytes = std::fs::read(file).map_err(|e| format!("{}: {e}", file.display()))?;
        let name = file.display().to_string();
        let read = read_scene_bytes(&name, &bytes, &[])
            .map_err(|errors| super::mistaken(&name, &bytes, Guise::Scene, errors))?;
        scenes.push(read.into_scene());
    }
    if args.map {
        return draw_map(args, &scenes);
    }
    let settings: Vec<Setting> = Setting::usual(args.tolerance)
        .into_iter()
        .filter(|s| !args.fast || !slow(s))
        .collect();
    let (mut done, mut undecided) = (Vec::new(), Vec::new());
    for scene in &scenes {
        match trade(scene, &settings, args.repeat as usize, args.time_limit) {
            Some(rows) => done.push(rows),
            None => undecided.push(scene.name.clone()),
        }
    }
    let rates = rates(&done);
    if let Some(path) = &args.svg {
        output::write(Some(path), &plot::scatter(&done, &rates))?;
    }
    let status = if undecided.is_empty() {
        DECIDED
    } else {
        UNDECIDED
    };
    let table = if done.len() == 1 {
        scene_table(&done)
    } else {
        rates_table(&rates)
    };
    let document = Document {
        schema: "snapfit.trade/1",
        tolerance: args.tolerance,
        scenes: done,
        rates,
        undecided,
    };
    print(args, &document, &table)?;
    Ok(status)
}

fn slow(s: &Setting) -> bool {
    matches!(s, Setting::Kernel(Arithmetic::Exact) | Setting::Stepping(_))
}

fn close(args: &Trade, name: &str) -> Result<u8, Failure> {
    let Some(family) = Family::named(name) else {
        let names: Vec<&str> = FAMILIES.iter().map(|f| f.name).collect();
        return Err(format!("no family {name}; there are: {}", names.join(", ")).into());
    };
    let settings: Vec<Setting> = Setting::usual(args.tolerance)
        .into_iter()
        .filter(|s| !args.fast || !slow(s))
        .collect();
    let mut ks: Vec<u32> = (0..=args.most).step_by(args.every as usize).collect();
    if ks.last() != Some(&args.most) {
        ks.push(args.most);
    }
    let done = breakdown(
        &family,
        &ks,
        &settings,
        args.repeat as usize,
        args.time_limit,
    );
    if let Some(path) = &args.svg {
        output::write(Some(path), &plot::breakdown(&done))?;
    }
    print(args, &done, &done.table())?;
    Ok(DECIDED)
}

fn draw_map(args: &Trade, scenes: &[Scene]) -> Result<u8, Failure> {
    let [scene] = scenes else {
        return Err("--map takes one scene".to_owned().into());
    };
    let layers = [
        Setting::Kernel(Arithmetic::Filtered),
        Setting::float(args.tolerance, Identify::None),
        Setting::float(args.tolerance, Identify::Names),
    ];
    let size = args.size as usize;
    let Some(done) = map::map(scene, args.vertex, size, &layers, args.time_limit) else {
        return Err(format!(
            "the scene has no vertex {}.{}",
            args.vertex.0, args.vertex.1
        )
        .into());
    };
    if let Some(path) = &args.svg {
        output::write(Some(path), &plot::map(&done))?;
    }
    let mut table = String::new();
    for l in &done.layers {
        table += &format!("{:<15} {} of {} differ\n", l.setting, l.differ, size * size);
    }
    print(args, &done, &table)?;
    Ok(DECIDED)
}

fn print(args: &Trade, document: &impl Serialize, table: &str) -> Result<(), Failure> {
    let watched = args.out.is_none() && std::io::stdout().is_terminal();
    let format = args
        .format
        .unwrap_or(if watched { Format::Table } else { Format::Json });
    let text = match format {
        Format::Table => table.to_owned(),
        Format::Json => {
            let text = serde_json::to_string(document).map_err(|e| e.to_string())?;
            pretty(&text, 110) + "\n"
        }
    };
    output::write(args.out.as_deref(), &text)?;
    Ok(())
}

/// The scenes of files and folders, in order of their paths.
/// The files named, and those in the folders named that look like scenes.
fn collect(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut out = Vec::new();
    gather(paths, &mut out)?;
    if out.is_empty() {
        return Err("no scenes there".to_owned().into());
    }
    Ok(out)
}

fn gather(paths: &[PathBuf], out: &mut Vec<PathBuf>) -> Result<(), Failure> {
    for p in paths {
        if !p.is_dir() {
            out.push(p.clone());
            continue;
        }
        let mut inside = Vec::new();
        for entry in std::fs::read_dir(p).map_err(|e| format!("{}: {e}", p.display()))? {
            let path = entry.map_err(|e| format!("{}: {e}", p.display()))?.path();
            if path.is_dir() || is_scene(&path) {
                inside.push(path);
            }
        }
        inside.sort();
        gather(&inside, out)?;
    }
    Ok(())
}

/// Structures and results lie beside scenes and are passed over; what cannot be read is not, so
/// that its error is told.
fn is_scene(path: &Path) -> bool {
    if !path.extension().is_some_and(|e| e == "toml" || e == "json") {
        return false;
    }
    let name = path.display().to_string();
    let seen = std::fs::read(path).ok().and_then(|b| guise(&name, &b));
    seen.is_none_or(|g| g == Guise::Scene)
}
