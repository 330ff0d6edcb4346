//! Pictures: the mechanism at its events (as in DP Fig. 4), and θ over time, as one SVG file.
//!
//! A picture is drawn from the scene and the finished result document, in doubles: nothing here
//! decides anything. `stage` turns both into shapes and curves, `panels` draws the small
//! multiples (`names` finds room for the obstacles' names), `plot` the histories; letters tie an instant of the one to the same instant of the
//! other.

mod names;
mod panels;
mod plot;
mod slice;
mod stage;
mod structure;
pub(crate) mod svg;

use super::json::ResultDocument;
use super::words::{UNPROVEN, headline, reason};
use crate::scene::Scene;
pub use slice::{SlicePicture, slice_svg};
use stage::Stage;
pub use structure::{StructurePicture, structure_svg};
use svg::{INK, MUTED, Svg, text_width};

/// Width of the page; its height follows.
const WIDTH: f64 = 1180.0;
const MARGIN: f64 = 28.0;

/// The picture of a result as an SVG document.
pub fn svg(scene: &Scene, result: &ResultDocument) -> String {
    let stage = Stage::new(scene, result);
    let moments = panels::moments(&stage, result);
    let mut page = Svg::new();
    let inner = WIDTH - 2.0 * MARGIN;
    let mut y = MARGIN + 16.0;
    page.text(
        MARGIN,
        y,
        17.0,
        INK,
        "start",
        true,
        &fit(&headline(result), 17.0, inner),
    );
    if let Some(why) = reason(result) {
        for line in wrap(&why, 12.5, inner) {
            y += 18.0;
            page.text(MARGIN, y, 12.5, MUTED, "start", false, &line);
        }
    }
    if result.arithmetic == "f64" {
        y += 18.0;
        page.text(MARGIN, y, 12.5, MUTED, "start", false, UNPROVEN);
    }
    y += 20.0;
    y = panels::draw(&mut page, &stage, &moments, [MARGIN, y, inner]);
    y += 26.0;
    y = plot::draw(
        &mut page,
        &stage,
        result,
        &moments.chosen,
        [MARGIN, y, inner],
    );
    page.finish(WIDTH, y + MARGIN, &result.scene, &headline(result))
}

/// The text, cut short with an ellipsis where it would be wider than there is room.
fn fit(text: &str, size: f64, room: f64) -> String {
    if text_width(text, size) <= room {
        return text.to_owned();
    }
    let mut cut = String::new();
    for c in text.chars() {
        if text_width(&cut, size) + 1.6 * size > room {
            break;
        }
        cut.push(c);
    }
    cut.trim_end().to_owned() + "…"
}

/// The text in lines no wider than there is room, three at most.
fn wrap(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        let joined = if lines[last].is_empty() {
            word.to_owned()
        } else {
            format!("{} {word}", lines[last])
        };
        if text_width(&joined, size) <= room || lines[last].is_empty() || lines.len() == 3 {
            lines[last] = joined;
        } else {
            lines.push(word.to_owned());
        }
    }
    lines.iter().map(|l| fit(l, size, room)).collect()
}
