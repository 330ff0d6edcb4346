//! `slice`: the free component of a pawl's slice of a phase; and its picture.

use super::args::{Arithmetic, Common, Engine, Method, Render};
use super::{DECIDED, Failure, UNDECIDED, limit, output};
use clap::Args;
use snapfit::motion::plan::Progress;
use snapfit::motion::{Options, OutcomeKind, Seen, Trajectory, slices};
use snapfit::number::Rat;
use snapfit::report::json::ResultDocument;
use snapfit::report::picture::{SlicePicture, slice_svg};
use snapfit::report::pretty;
use snapfit::report::slice::SliceDocument;
use snapfit::scene::SceneFile;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

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
    /// Ask whether the orientation tan(θ/2), a number or `infinity`, can be reached at a time without leaving
    /// free space (repeatable)
    #[arg(long, value_name = "TIME,TAN_HALF", allow_hyphen_values = true)]
    reach: Vec<String>,
    /// Ask for the free intervals just after a time from the start of the phase (repeatable)
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    at: Vec<String>,
    /// Ask how the pawl would move from the orientation tan(θ/2) at the start of the phase (repeatable)
    #[arg(long, value_name = "TAN_HALF", allow_hyphen_values = true)]
    from: Vec<String>,
}

fn number(option: &str, text: &str) -> Result<Rat, String> {
    text.trim()
        .parse()
        .map_err(|e| format!("{option} {text}: {e}"))
}

/// Refuses what a slice would not heed.
fn heeded(engine: &Engine) -> Result<(), Failure> {
    if engine.arithmetic == Arithmetic::F64 {
        return Err("--arithmetic f64: F is exact; there is: exact, filtered"
            .to_owned()
            .into());
    }
    if engine.method == Method::Naive {
        return Err("--method naive makes no F; there is: auto, sweep"
            .to_owned()
            .into());
    }
    super::provenance(engine).map(|_| ())
}

/// The slice that is meant, with the whole trajectory; None where a limit came before it.
fn seen(
    file: &SceneFile,
    options: &Options<'_>,
    which: &Which,
) -> Result<(Option<Seen>, Trajectory), Failure> {
    let scene = file.scene();
    let pawl = match &which.pawl {
        None => 0,
        Some(name) => scene
            .pawls
            .iter()
            .position(|p| p.name == *name)
            .ok_or_else(|| format!("--pawl {name}: the scene has no pawl of that name"))?,
    };
    let phase = which.phase.unwrap_or(0);
    let mut found = None;
    let trajectory = slices(scene, options, &mut |s| {
        if (s.phase, s.pawl) == (phase, pawl) {
            found = Some(s);
        }
    })
    .map_err(|e| super::misplanned(file, &e))?;
    if found.is_none() && trajectory.outcome.kind != OutcomeKind::Undecided {
        return Err(format!(
            "--phase {}: the plan ran through {} phase{}, counted from 0",
            phase,
            trajectory.phases.len(),
            if trajectory.phases.len() == 1 {
                ""
            } else {
                "s"
            }
        )
        .into());
    }
    Ok((found, trajectory))
}

/// What is asked of F.
struct Questions {
    /// When, and tan(θ/2); None where that is infinite.
    reach: Vec<(Rat, Option<Rat>)>,
    at: Vec<Rat>,
    from: Vec<Rat>,
}

impl Questions {
    fn read(args: &SliceArgs) -> Result<Questions, String> {
        let mut reach = Vec::new();
        for r in &args.reach {
            let (t, u) = r
                .split_once(',')
                .ok_or_else(|| format!("--reach {r}: expected TIME,TAN_HALF"))?;
            let u = match u.trim() {
                "infinity" => None,
                u => Some(number("--reach", u)?),
            };
            reach.push((number("--reach", t)?, u));
        }
        let all = |option: &str, texts: &[String]| -> Result<Vec<Rat>, String> {
            texts.iter().map(|t| number(option, t)).collect()
        };
        Ok(Questions {
            reach,
            at: all("--at", &args.at)?,
            from: all("--from", &args.from)?,
        })
    }

    fn ask(
        &self,
        file: &SceneFile,
        seen: &Seen,
        document: &mut SliceDocument,
    ) -> Result<(), String> {
        for (t, u) in &self.reach {
            document.reach(seen, t, u.as_ref());
        }
        for t in &self.at {
            let end = &seen.slice.frame.duration;
            if t.sign() < 0 || t >= end {
                return Err(format!("--at {t}: the phase lasts from 0 to before {end}"));
            }
            document.intervals(seen, t);
        }
        for u in &self.from {
            if !seen.may_start(file.scene(), u) {
                return Err(format!(
                    "--from {u}: the pawl cannot start there: it would penetrate or lie past its stops"
                ));
            }
            document.run(file.scene(), seen, u);
        }
        Ok(())
    }
}

/// Prints F.
pub(crate) fn run_slice(args: &SliceArgs) -> Result<u8, Failure> {
    let questions = Questions::read(args)?;
    heeded(&args.engine)?;
    let file = super::read(&args.common)?;
    let names: Vec<String> = file.scene().pawls.iter().map(|p| p.name.clone()).collect();
    let reached: Arc<Mutex<Option<Progress>>> = Arc::default();
    let (note, which, face) = (reached.clone(), args.which.clone(), args.engine.face);
    let work = move || -> Result<String, Failure> {
        let tell = |p| *note.lock().unwrap_or_else(PoisonError::into_inner) = Some(p);
        let options = Options {
            progress: Some(&tell),
            face,
            ..Options::default()
        };
        let (seen, _) = seen(&file, &options, &which)?;
        let seen = seen.ok_or_else(|| "undecided without a limit".to_owned())?;
        let mut document = SliceDocument::new(file.scene(), &seen);
        questions.ask(&file, &seen, &mut document)?;
        serde_json::to_string(&document).map_err(|e| e.to_string().into())
    };
    let Some(text) = limit::within(args.engine.time_limit, work)? else {
        let place = match *reached.lock().unwrap_or_else(PoisonError::into_inner) {
            None => "before any slice was built".to_owned(),
            Some(p) => format!(
                "at phase {} of {}, pawl {}, with {} contact arcs",
                p.phase, p.phases, names[p.pawl], p.arcs
            ),
        };
        let _ = writeln!(
            std::io::stderr(),
            "snapfit: undecided: --time-limit came {place}"
        );
        return Ok(UNDECIDED);
    };
    output::write(args.common.out.as_deref(), &(pretty(&text?, 110) + "\n"))?;
    Ok(DECIDED)
}

/// Draws a slice.
pub(crate) fn run_render(
    args: &Render,
    file: &SceneFile,
    to: Option<&Path>,
) -> Result<u8, Failure> {
    heeded(&args.engine)?;
    let how = super::provenance(&args.engine)?;
    let options = Options {
        deadline: super::deadline(&args.engine),
        face: args.engine.face,
        ..Options::default()
    };
    let (seen, trajectory) = seen(file, &options, &args.which)?;
    let Some(seen) = seen else {
        let _ = writeln!(
            std::io::stderr(),
            "snapfit: undecided: --time-limit came before the slice was built"
        );
        return Ok(UNDECIDED);
    };
    let result = ResultDocument::new(file.scene(), &trajectory, how);
    let picture = SlicePicture {
        scene: file.scene(),
        result: &result,
        seen: &seen,
    };
    output::write(to, &slice_svg(&picture))?;
    Ok(super::status(&trajectory))
}
