//! `slice`: the free component of a pawl's slice of a phase; and its picture.

use super::args::{Common, Engine, Render};
use super::{DECIDED, Failure, output};
use clap::Args;
use snapfit::motion::{Options, Seen, Trajectory, slices};
use snapfit::number::Rat;
use snapfit::report::json::ResultDocument;
use snapfit::report::picture::{SlicePicture, slice_svg};
use snapfit::report::pretty;
use snapfit::report::slice::SliceDocument;
use snapfit::scene::SceneFile;
use std::path::Path;

/// Which slice is meant.
#[derive(Args, Clone)]
pub(crate) struct Which {
    /// Of a slice: the phase, counted from 0 [default: the first]
    #[arg(long, value_name = "K")]
    pub(crate) phase: Option<usize>,
    /// Of a slice: the pawl [default: the first]
    #[arg(long, value_name = "NAME")]
    pub(crate) pawl: Option<String>,
}

#[derive(Args)]
pub(crate) struct SliceArgs {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    engine: Engine,
    #[command(flatten)]
    which: Which,
    /// Ask whether the orientation tan(θ/2) can be reached at a time without leaving free space (repeatable)
    #[arg(long, value_name = "TIME,TAN_HALF", allow_hyphen_values = true)]
    reach: Vec<String>,
    /// Ask for the free intervals just after a time from the start of the phase (repeatable)
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    at: Vec<String>,
    /// Ask how the pawl would move from the orientation tan(θ/2) at the start of the phase (repeatable)
    #[arg(long, value_name = "TAN_HALF", allow_hyphen_values = true)]
    from: Vec<String>,
}

fn number(text: &str) -> Result<Rat, String> {
    text.trim().parse().map_err(|e| format!("{text}: {e}"))
}

/// The slice that is meant, with the whole trajectory.
fn seen(file: &SceneFile, engine: &Engine, which: &Which) -> Result<(Seen, Trajectory), Failure> {
    let scene = file.scene();
    let pawl = match &which.pawl {
        None => 0,
        Some(name) => scene
            .pawls
            .iter()
            .position(|p| p.name == *name)
            .ok_or_else(|| format!("--pawl {name}: the scene has no pawl of that name"))?,
    };
    let options = Options {
        deadline: super::deadline(engine),
        face: engine.face,
        ..Options::default()
    };
    let phase = which.phase.unwrap_or(0);
    let mut found = None;
    let trajectory = slices(scene, &options, &mut |s| {
        if (s.phase, s.pawl) == (phase, pawl) {
            found = Some(s);
        }
    })
    .map_err(|e| super::misplanned(file, &e))?;
    let found = found.ok_or_else(|| {
        format!(
            "--phase {}: the plan ran through {} phase{}, counted from 0",
            phase,
            trajectory.phases.len(),
            if trajectory.phases.len() == 1 {
                ""
            } else {
                "s"
            }
        )
    })?;
    Ok((found, trajectory))
}

/// Prints F.
pub(crate) fn run_slice(args: &SliceArgs) -> Result<u8, Failure> {
    let mut reach = Vec::new();
    for r in &args.reach {
        let (t, u) = r
            .split_once(',')
            .ok_or_else(|| format!("--reach {r}: expected TIME,TAN_HALF"))?;
        reach.push((number(t)?, number(u)?));
    }
    let at: Vec<Rat> = args
        .at
        .iter()
        .map(|t| number(t))
        .collect::<Result<_, _>>()?;
    let from: Vec<Rat> = args
        .from
        .iter()
        .map(|u| number(u))
        .collect::<Result<_, _>>()?;
    let file = super::read(&args.common)?;
    let (seen, _) = seen(&file, &args.engine, &args.which)?;
    let mut document = SliceDocument::new(file.scene(), &seen);
    for (t, u) in &reach {
        document.reach(&seen, t, u);
    }
    for t in &at {
        let end = &seen.slice.frame.duration;
        if t.sign() < 0 || t >= end {
            return Err(format!("--at {t}: the phase lasts from 0 to before {end}").into());
        }
        document.intervals(&seen, t);
    }
    for u in &from {
        if !seen.may_start(file.scene(), u) {
            return Err(format!(
                "--from {u}: the pawl cannot start there: it would penetrate or lie past its stops"
            )
            .into());
        }
        document.run(file.scene(), &seen, u);
    }
    let text = serde_json::to_string(&document).map_err(|e| e.to_string())?;
    output::write(args.common.out.as_deref(), &(pretty(&text, 110) + "\n"))?;
    Ok(DECIDED)
}

/// Draws a slice.
pub(crate) fn run_render(
    args: &Render,
    file: &SceneFile,
    to: Option<&Path>,
) -> Result<u8, Failure> {
    let how = super::provenance(&args.engine)?;
    let (seen, trajectory) = seen(file, &args.engine, &args.which)?;
    let result = ResultDocument::new(file.scene(), &trajectory, how);
    let picture = SlicePicture {
        scene: file.scene(),
        result: &result,
        seen: &seen,
    };
    output::write(to, &slice_svg(&picture))?;
    Ok(super::status(&trajectory))
}
