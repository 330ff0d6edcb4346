//! `render` of a structure: before and after, or the frames of the way.

use crate::args::Render;
use crate::flex::{Accuracy, parse};
use crate::{DECIDED, Failure, UNDECIDED, output};
use snapfit::flex::{self, Ending, FlexOptions, Flexed, Pose, Structure};
use snapfit::number::Rat;
use snapfit::report::picture::{StructurePicture, structure_svg};
use std::path::{Path, PathBuf};

/// Draws a structure: flexed where it has an objective, else as it stands.
pub(crate) fn run_render(
    args: &Render,
    name: &str,
    bytes: &[u8],
    to: Option<&Path>,
) -> Result<u8, Failure> {
    let structure = parse(&args.common, name, bytes)?.into_structure();
    let start: Vec<Pose> = structure.bodies.iter().map(Pose::of).collect();
    if structure.objective.is_empty() {
        let configurations = vec![start];
        let note = "nothing is asked: the structure as it stands".to_owned();
        let title = format!("{}: {} bodies", structure.name, structure.bodies.len());
        draw(&structure, &configurations, title, note, args.frames, to)?;
        return Ok(DECIDED);
    }
    let options = FlexOptions {
        accuracy: args.accuracy.level(),
        time_limit: args.engine.time_limit,
        ..FlexOptions::default()
    };
    let flexed = flex::flex(&structure, &options);
    let (title, note) = words(&structure, &flexed, args.accuracy);
    draw(
        &structure,
        &flexed.configurations,
        title,
        note,
        args.frames,
        to,
    )?;
    Ok(if flexed.ending == Ending::Undecided {
        UNDECIDED
    } else {
        DECIDED
    })
}

fn words(structure: &Structure, flexed: &Flexed, accuracy: Accuracy) -> (String, String) {
    let value = |r: &Rat| r.nearest_f64().unwrap_or(f64::INFINITY);
    let title = format!(
        "{}: {} bodies flex by {:.6}",
        structure.name,
        structure.bodies.len(),
        value(&flexed.displacement)
    );
    let proven = match accuracy {
        Accuracy::Exact => "every program solved exactly",
        Accuracy::Bounds => "every program's optimum enclosed",
        Accuracy::Float => "programs in floating point, nothing proven",
    };
    let note = format!(
        "{} steps ({}), {} rows × {} columns in the first program, largest violation {:.3e}; {proven}",
        flexed.steps.len(),
        flexed.ending.word(),
        flexed.steps.first().map_or(0, |s| s.rows),
        flexed.columns,
        flexed.violation.value().nearest_f64().unwrap_or(f64::NAN),
    );
    (title, note)
}

fn draw(
    structure: &Structure,
    configurations: &[Vec<Pose>],
    title: String,
    note: String,
    frames: Option<u32>,
    to: Option<&Path>,
) -> Result<(), Failure> {
    let (Some(before), Some(after)) = (configurations.first(), configurations.last()) else {
        return Ok(());
    };
    let picture = |after: &[Pose], title: String, note: String| {
        structure_svg(&StructurePicture {
            structure,
            before,
            after,
            title,
            note,
            brace: None,
            frame: configurations,
        })
    };
    let Some(frames) = frames else {
        output::write(to, &picture(after, title, note))?;
        return Ok(());
    };
    let Some(path) = to.filter(|p| *p != Path::new("-")) else {
        return Err("frames are files: give --svg a path".to_owned().into());
    };
    for k in 0..frames {
        let part = if frames > 1 {
            f64::from(k) / f64::from(frames - 1)
        } else {
            1.0
        };
        let poses = between(configurations, part);
        let svg = picture(
            &poses,
            format!("{}: {:.0} % of the way", structure.name, 100.0 * part),
            note.clone(),
        );
        output::write(Some(&numbered(path, k, frames)), &svg)?;
    }
    Ok(())
}

/// The configuration at a part, 0 to 1, of the way: every step takes as long as any other.
fn between(configurations: &[Vec<Pose>], part: f64) -> Vec<Pose> {
    let steps = configurations.len() - 1;
    let at = part * steps as f64;
    let k = (at as usize).min(steps.saturating_sub(1));
    let (from, to) = (&configurations[k], &configurations[(k + 1).min(steps)]);
    // An eye sees no finer than this.
    let t = Rat::frac(((at - k as f64).clamp(0.0, 1.0) * 4096.0) as i64, 4096);
    let mix = |a: &Rat, b: &Rat| a + &(&t * &(b - a));
    from.iter()
        .zip(to)
        .map(|(a, b)| Pose {
            place: snapfit::geometry::Vec2::new(
                mix(&a.place.x, &b.place.x),
                mix(&a.place.y, &b.place.y),
            ),
            tan_half: mix(&a.tan_half, &b.tan_half),
        })
        .collect()
}

/// picture.svg → picture-07.svg
fn numbered(path: &Path, k: u32, of: u32) -> PathBuf {
    let width = of.saturating_sub(1).to_string().len();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{k:0width$}.{ending}"))
}
