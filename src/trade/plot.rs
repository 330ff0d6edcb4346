//! The pictures: time against error, cost over the gap, and maps.
//!
//! Drawn with the project's own pen, as the pictures of mechanisms are: an axis, some marks and a
//! legend are less than what a plotting library would bring along.

use super::family::Breakdown;
use super::map::Map;
use super::table::{Rates, SceneRows};
use crate::report::picture::svg::{INK, MUTED, RULE, Svg};
use std::fmt::Write;

const COLOURS: [&str; 9] = [
    "#1b7837", "#2166ac", "#b2182b", "#e08214", "#762a83", "#4d4d4d", "#80cdc1", "#bf812d",
    "#f781bf",
];

/// A logarithmic axis.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64> + Clone, from: f64, to: f64) -> Axis {
        let logs = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let low = logs.clone().fold(f64::INFINITY, f64::min).floor();
        let high = logs.fold(f64::NEG_INFINITY, f64::max).ceil();
        let (low, high) = if low < high {
            (low, high)
        } else if low.is_finite() {
            (low, low + 1.0)
        } else {
            (0.0, 1.0)
        };
        Axis {
            low,
            high,
            from,
            to,
        }
    }
    fn at(&self, v: f64) -> f64 {
        let l = v.max(f64::MIN_POSITIVE).log10().clamp(self.low, self.high);
        self.from + (l - self.low) / (self.high - self.low) * (self.to - self.from)
    }
    fn ticks(&self) -> impl Iterator<Item = i32> {
        let step = (((self.high - self.low) / 8.0).ceil() as i32).max(1);
        (self.low as i32..=self.high as i32).step_by(step as usize)
    }
}

fn frame(pen: &mut Svg, x: &Axis, y: &Axis, across: &str, up: &str) {
    for t in x.ticks() {
        let at = x.at(10f64.powi(t));
        pen.line([at, y.from], [at, y.to], "#e4e7eb", 0.8, "");
        pen.text(at, y.from + 16.0, 11.0, MUTED, "middle", false, &power(t));
    }
    for t in y.ticks() {
        let at = y.at(10f64.powi(t));
        pen.line([x.from, at], [x.to, at], "#e4e7eb", 0.8, "");
        pen.text(x.from - 6.0, at + 4.0, 11.0, MUTED, "end", false, &power(t));
    }
    pen.line([x.from, y.from], [x.to, y.from], RULE, 1.0, "");
    pen.line([x.from, y.from], [x.from, y.to], RULE, 1.0, "");
    let middle = (x.from + x.to) / 2.0;
    pen.text(middle, y.from + 34.0, 12.0, INK, "middle", false, across);
    pen.text(x.from - 40.0, y.to - 10.0, 12.0, INK, "start", false, up);
}

fn power(t: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let mut text = String::from(if t < 0 { "10⁻" } else { "10" });
    for c in t.unsigned_abs().to_string().bytes() {
        text.push(digits[(c - b'0') as usize]);
    }
    text
}

/// Time against the worst error of a time, one mark a scene and setting; wrong verdicts crossed.
pub fn scatter(scenes: &[SceneRows], rates: &[Rates]) -> String {
    let (w, h) = (760.0, 460.0);
    let all = || scenes.iter().flat_map(|s| &s.rows);
    let x = Axis::new(all().map(|r| r.seconds), 90.0, 540.0);
    let y = Axis::new(
        all().map(|r| r.time_ulps.unwrap_or(0.0).max(0.1)),
        400.0,
        50.0,
    );
    let mut pen = Svg::new();
    let about = "seconds of CPU (simulation alone)";
    frame(
        &mut pen,
        &x,
        &y,
        about,
        "worst error of an event time, ulps (0 drawn as 10⁻¹)",
    );
    let names: Vec<String> = scenes
        .first()
        .map(|s| s.rows.iter().map(|r| r.setting.clone()).collect())
        .unwrap_or_default();
    for s in scenes {
        for (k, r) in s.rows.iter().enumerate() {
            let Some(u) = r.time_ulps else { continue };
            let (at, colour) = (
                [x.at(r.seconds), y.at(u.max(0.1))],
                COLOURS[k % COLOURS.len()],
            );
            pen.circle(at, 3.2, colour, "#ffffff", 0.6);
            if r.verdict == super::score::Verdict::Wrong {
                for d in [-1.0, 1.0] {
                    let (a, b) = (
                        [at[0] - 5.0, at[1] - 5.0 * d],
                        [at[0] + 5.0, at[1] + 5.0 * d],
                    );
                    pen.line(a, b, colour, 1.4, "");
                }
            }
        }
    }
    for (k, name) in names.iter().enumerate() {
        let top = 60.0 + 36.0 * k as f64;
        pen.circle(
            [566.0, top],
            4.0,
            COLOURS[k % COLOURS.len()],
            "#ffffff",
            0.6,
        );
        pen.text(576.0, top + 4.0, 12.0, INK, "start", false, name);
        let mine = rates.iter().filter(|r| r.setting == *name);
        let (wrong, given) = mine.fold((0, 0), |(a, b), r| (a + r.wrong, b + r.wrong + r.right));
        let note = format!("{wrong} of {given} verdicts wrong");
        pen.text(576.0, top + 18.0, 10.0, MUTED, "start", false, &note);
    }
    pen.finish(
        w,
        h,
        "Speed against accuracy",
        "Time and error of each arithmetic.",
    )
}

/// Seconds over k, one line a setting; where it lies the line is dashed.
pub fn breakdown(b: &Breakdown) -> String {
    let (w, h) = (760.0, 420.0);
    let seconds = b
        .gaps
        .iter()
        .flat_map(|g| g.cells.iter().map(|c| c.seconds));
    let y = Axis::new(seconds.clone(), 360.0, 50.0);
    let most = b.gaps.iter().map(|g| g.k).max().unwrap_or(1).max(1);
    let (left, right) = (90.0, 560.0);
    let at = |k: u32| left + f64::from(k) / f64::from(most) * (right - left);
    let mut pen = Svg::new();
    for t in y.ticks() {
        let v = y.at(10f64.powi(t));
        pen.line([left, v], [right, v], "#e4e7eb", 0.8, "");
        pen.text(left - 6.0, v + 4.0, 11.0, MUTED, "end", false, &power(t));
    }
    for i in 0..=5u32 {
        let k = most * i / 5;
        pen.line([at(k), 360.0], [at(k), 50.0], "#e4e7eb", 0.8, "");
        pen.text(at(k), 376.0, 11.0, MUTED, "middle", false, &k.to_string());
    }
    pen.text(
        (left + right) / 2.0,
        396.0,
        12.0,
        INK,
        "middle",
        false,
        "k, the gap being 2⁻ᵏ",
    );
    pen.text(
        left - 40.0,
        38.0,
        12.0,
        INK,
        "start",
        false,
        "seconds of CPU; dashed where not right",
    );
    for (i, name) in b.settings.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        for pair in b.gaps.windows(2) {
            let (p, q) = (&pair[0], &pair[1]);
            let dash = if q.cells[i].verdict == "right" {
                ""
            } else {
                "3 3"
            };
            let (a, c) = (y.at(p.cells[i].seconds), y.at(q.cells[i].seconds));
            pen.line([at(p.k), a], [at(q.k), c], colour, 1.6, dash);
        }
        let top = 60.0 + 34.0 * i as f64;
        pen.line([580.0, top], [600.0, top], colour, 2.0, "");
        pen.text(606.0, top + 4.0, 12.0, INK, "start", false, name);
        let from = b.lies_from[i].map_or("never lies".to_owned(), |k| format!("lies from k = {k}"));
        pen.text(606.0, top + 17.0, 10.0, MUTED, "start", false, &from);
    }
    let title = format!("Breakdown: {}", b.family);
    pen.finish(w, h, &title, "Cost over the gap of each arithmetic.")
}

/// The layers of a map side by side.
pub fn map(m: &Map) -> String {
    let side = 256.0;
    let n = m.layers.len().max(1) as f64;
    let (w, h) = (
        30.0 + (side + 24.0) * n,
        340.0 + 16.0 * m.legend.len() as f64,
    );
    let mut pen = Svg::new();
    for (i, layer) in m.layers.iter().enumerate() {
        let left = 24.0 + (side + 24.0) * i as f64;
        pen.text(left, 28.0, 13.0, INK, "start", true, &layer.setting);
        let note = format!("{} of {} differ", layer.differ, layer.pixels.len());
        pen.text(left + side, 28.0, 11.0, MUTED, "end", false, &note);
        // Runs of one colour are one stroke.
        let unit = side / m.size as f64;
        for (row, line) in layer.pixels.chunks(m.size).enumerate() {
            let mut from = 0;
            for to in 1..=line.len() {
                if to == line.len() || line[to] != line[from] {
                    let colour = COLOURS[usize::from(line[from]) % COLOURS.len()];
                    let x = left + from as f64 * unit;
                    let y = 40.0 + row as f64 * unit;
                    // A row reaches under the next, or the paper shines through between them.
                    let below = if row + 1 < m.size { 1.5 } else { 1.0 };
                    let (wide, high) = ((to - from) as f64 * unit, below * unit);
                    pen.rect([x, y, wide, high], colour, "none");
                    from = to;
                }
            }
        }
    }
    for (i, word) in m.legend.iter().enumerate() {
        let y = 320.0 + 16.0 * i as f64;
        pen.rect(
            [24.0, y - 9.0, 10.0, 10.0],
            COLOURS[i % COLOURS.len()],
            "none",
        );
        pen.text(40.0, y, 11.0, INK, "start", false, word);
    }
    let mut about = String::new();
    let _ = write!(
        about,
        "Vertex {} of pawl {} over {} by {} neighbouring doubles.",
        m.vertex.1, m.vertex.0, m.size, m.size
    );
    pen.finish(w, h, &format!("Neighbours of {}", m.scene), &about)
}
