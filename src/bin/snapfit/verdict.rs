//! The verbs `classify` and `forces`.

use super::args::{Arithmetic, Classify, Engine, Forces, Format};
use super::{
    DECIDED, Failure, UNDECIDED, UNEXPECTED, format_of, misplanned, output, provenance, read, style,
};
use snapfit::analysis::escape::with_motion;
use snapfit::analysis::summary::{classify_summary, forces_summary};
use snapfit::analysis::{self, Ask, ClassifyDocument, Verdict, draw};
use snapfit::motion::simulate;
use snapfit::report::json::{Provenance, ResultDocument};
use snapfit::report::{picture, pretty};
use snapfit::scene::Scene;
use std::io::Write;
use std::time::Instant;

fn ask(engine: &Engine) -> Result<(Ask, Provenance), Failure> {
    if engine.arithmetic == Arithmetic::F64 {
        return Err(
            "--arithmetic f64: verdicts and forces are certified; there is: exact, filtered"
                .to_owned()
                .into(),
        );
    }
    let how = provenance(engine)?;
    let ask = Ask {
        deadline: engine
            .time_limit
            .and_then(|limit| Instant::now().checked_add(limit)),
        critical: true,
        exact: engine.arithmetic == Arithmetic::Exact,
        method: super::method(engine),
    };
    Ok((ask, how))
}

/// `kinematic`, or `total-kinematic`.
fn expectation(word: &str) -> Result<(&'static str, bool), Failure> {
    let class = word.strip_prefix("total-").unwrap_or(word);
    let class = Verdict::from_name(class).ok_or_else(|| {
        format!(
            "--expect {word}: expected none, force, friction, kinematic, or total- and one of them"
        )
    })?;
    Ok((class.name(), word.starts_with("total-")))
}

pub(super) fn run_classify(args: &Classify) -> Result<u8, Failure> {
    let expected = args.expect.as_deref().map(expectation).transpose()?;
    for to in [&args.svg, &args.escape].into_iter().flatten() {
        output::prepare(&args.common.file, Some(to))?;
        output::apart(Some(to), args.common.out.as_deref())?;
    }
    output::apart(args.svg.as_deref(), args.escape.as_deref())?;
    let file = read(&args.common)?;
    let (ask, how) = ask(&args.engine)?;
    let (document, decisive) = analysis::document::classify_with_way(file.scene(), &ask)
        .map_err(|error| misplanned(&file, &error))?;
    let text = match format_of(args.format, &args.common) {
        Format::Json => {
            let text = serde_json::to_string(&document).map_err(|e| e.to_string())?;
            pretty(&text, 100) + "\n"
        }
        Format::Summary => classify_summary(&document, style()),
    };
    output::write(args.common.out.as_deref(), &text)?;
    let longer = decisive.map(|(v, lasts)| with_motion(file.scene(), &v, &lasts));
    if let Some(path) = &args.svg {
        let motion = longer.as_ref().unwrap_or_else(|| file.scene());
        output::write(Some(path), &drawing(motion, &document, &ask, how)?)?;
    }
    if let Some(path) = &args.escape {
        match longer.as_ref().filter(|_| document.gets_out()) {
            Some(scene) => output::write(Some(path), &scene.to_toml())?,
            None => {
                let _ = writeln!(
                    std::io::stderr(),
                    "snapfit: no way out was found; nothing to write"
                );
            }
        }
    }
    if document.undecided() {
        return Ok(UNDECIDED);
    }
    match expected {
        Some((class, total))
            if document.class != Some(class) || total && document.extent != Some("total") =>
        {
            let found = match (document.class, document.extent) {
                (None, _) => "no class".to_owned(),
                (Some(class), None) => class.to_owned(),
                (Some(class), Some(extent)) => format!("{extent} {class} diode"),
            };
            let hint = match &args.svg {
                Some(path) => format!("; drawn in {}", path.display()),
                None => "; --svg PATH draws it".to_owned(),
            };
            let _ = writeln!(
                std::io::stderr(),
                "snapfit: not as expected: {found}; {}{hint}",
                document.reason
            );
            Ok(UNEXPECTED)
        }
        _ => Ok(DECIDED),
    }
}

/// The motion that decides, and the rose below it where the circle was asked for.
fn drawing(
    scene: &Scene,
    document: &ClassifyDocument,
    ask: &Ask,
    how: Provenance,
) -> Result<String, Failure> {
    let run = simulate(scene, &ask.options()).map_err(|e| e.to_string())?;
    let motion = picture::svg(scene, &ResultDocument::new(scene, &run, how));
    if document.total.is_none() {
        return Ok(motion);
    }
    Ok(draw::stacked(&[motion, draw::rose(document)]))
}

pub(super) fn run_forces(args: &Forces) -> Result<u8, Failure> {
    if let Some(to) = &args.svg {
        output::prepare(&args.common.file, Some(to))?;
        output::apart(Some(to), args.common.out.as_deref())?;
    }
    let file = read(&args.common)?;
    let wish = analysis::Wish {
        digits: args.digits,
        samples: args.samples.unwrap_or(if args.all { 8 } else { 0 }),
        root: args.root || args.all,
        work: args.work || args.all,
        smooth: args.without_friction || args.all,
        handbook: args.handbook || args.all,
        draw: args.svg.is_some(),
    };
    let (ask, _) = ask(&args.engine)?;
    let document =
        analysis::forces(file.scene(), &wish, &ask).map_err(|error| misplanned(&file, &error))?;
    let text = match format_of(args.format, &args.common) {
        Format::Json => {
            let text = serde_json::to_string(&document).map_err(|e| e.to_string())?;
            pretty(&text, 100) + "\n"
        }
        Format::Summary => forces_summary(&document, style()),
    };
    output::write(args.common.out.as_deref(), &text)?;
    if let Some(path) = &args.svg {
        output::write(Some(path), &draw::force_plot(&document))?;
    }
    if !document.modelled && !args.common.quiet {
        let note = document.note.as_deref().unwrap_or_default();
        let _ = writeln!(std::io::stderr(), "snapfit: {note}");
    }
    Ok(if document.undecided {
        UNDECIDED
    } else {
        DECIDED
    })
}
