//! θ over t: one strip a pawl on a common time axis, the plan's phases shaded, the panels' letters
//! along the top.

use super::fit;
use super::panels::{Moment, colour};
use super::stage::{Stage, Stroke};
use super::svg::{INK, MUTED, Point, RULE, Svg, text_width};
use crate::report::json::{PawlDocument, ResultDocument};
use crate::report::words::digits;

const LEFT: f64 = 58.0;
const RIGHT: f64 = 14.0;
const STRIP_GAP: f64 = 16.0;

/// 1, 2 or 5 times a power of ten, about as large as asked.
pub(super) fn nice_step(about: f64) -> f64 {
    let power = 10f64.powf(about.log10().floor());
    let by = about / power;
    let step = if by < 1.5 {
        1.0
    } else if by < 3.5 {
        2.0
    } else if by < 7.5 {
        5.0
    } else {
        10.0
    };
    step * power
}

/// Steps that read well in degrees.
fn degree_step(span: f64) -> f64 {
    const STEPS: [f64; 16] = [
        0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0,
    ];
    let fits = STEPS.into_iter().find(|s| span / s <= 6.0);
    fits.unwrap_or_else(|| nice_step(span / 5.0))
}

/// A strip of the plot: page coordinates for time and degrees.
struct Axes {
    t: [f64; 2],
    degrees: [f64; 2],
    rect: [f64; 4],
}

impl Axes {
    fn x(&self, t: f64) -> f64 {
        self.rect[0] + (t - self.t[0]) / (self.t[1] - self.t[0]) * self.rect[2]
    }
    fn y(&self, degrees: f64) -> f64 {
        let [lo, hi] = self.degrees;
        self.rect[1] + (hi - degrees) / (hi - lo) * self.rect[3]
    }
    fn at(&self, [t, theta]: Point) -> Point {
        [self.x(t), self.y(theta.to_degrees())]
    }
}

/// Draws the strips into [x, y, width]; returns the y below them.
pub(super) fn draw(
    page: &mut Svg,
    stage: &Stage,
    result: &ResultDocument,
    moments: &[Moment],
    [x, y, width]: [f64; 3],
) -> f64 {
    let end = stage.phases.last().map_or(0.0, |p| p.to);
    if !(end.is_finite() && end > 0.0) {
        return y;
    }
    let t = [0.0, end];
    let height = match stage.pawls.len() {
        1 => 250.0,
        2 => 190.0,
        3 => 150.0,
        _ => 120.0,
    };
    let inner = width - LEFT - RIGHT;
    let top = y + 40.0;
    let bottom = top + stage.pawls.len() as f64 * (height + STRIP_GAP) - STRIP_GAP;
    let whole = Axes {
        t,
        degrees: [0.0, 1.0],
        rect: [x + LEFT, top, inner, bottom - top],
    };
    phases(page, stage, &whole, y);
    letters(page, moments, &whole, y + 20.0);
    let mut strip_top = top;
    for (i, history) in result.pawls.iter().enumerate() {
        let axes = Axes {
            t,
            degrees: range(&stage.pawls[i].track, history),
            rect: [x + LEFT, strip_top, inner, height],
        };
        let title = if stage.pawls.len() > 1 || !history.name.is_empty() {
            format!("θ of {}", history.name)
        } else {
            "θ".to_owned()
        };
        strip(
            page,
            &axes,
            &stage.pawls[i].track,
            history,
            colour(i),
            &title,
        );
        strip_top += height + STRIP_GAP;
    }
    let below = time_axis(page, &whole);
    legend(page, result, [x, below + 20.0, width])
}

/// Which degrees a strip shows: all of the history and rest, with some air.
fn range(track: &[Stroke], history: &PawlDocument) -> [f64; 2] {
    let strokes = track.iter().flat_map(|s| s.points.iter().map(|p| p[1]));
    let events = history
        .events
        .iter()
        .flat_map(|e| [Some(e.theta), e.to_theta])
        .flatten();
    let (mut lo, mut hi) = (0.0f64, 0.0f64);
    for theta in strokes.chain(events).filter(|t| t.is_finite()) {
        lo = lo.min(theta.to_degrees());
        hi = hi.max(theta.to_degrees());
    }
    if hi - lo < 1e-9 {
        return [-10.0, 10.0];
    }
    let air = 0.12 * (hi - lo);
    [lo - air, hi + air]
}

fn phases(page: &mut Svg, stage: &Stage, axes: &Axes, y: f64) {
    let [_, top, _, height] = axes.rect;
    for (k, phase) in stage.phases.iter().enumerate() {
        let (a, b) = (axes.x(phase.from), axes.x(phase.to));
        let fill = if k % 2 == 0 { "#f5f7fa" } else { "#e9eef4" };
        page.rect([a, y, b - a, top + height - y], fill, "none");
        let [vx, vy] = phase.velocity;
        let long = format!("phase {k}, velocity ({}, {})", digits(vx, 4), digits(vy, 4));
        let short = format!("phase {k}");
        let words = [long, short, k.to_string()];
        if let Some(w) = words.iter().find(|w| text_width(w, 11.0) < b - a - 6.0) {
            page.text((a + b) / 2.0, y + 13.0, 11.0, MUTED, "middle", false, w);
        }
    }
}

/// The panels' letters, each over its instant, moved apart where they would overlap.
fn letters(page: &mut Svg, moments: &[Moment], axes: &Axes, y: f64) {
    const ROOM: f64 = 13.0;
    let [left, top, width, height] = axes.rect;
    let mut at: Vec<f64> = moments.iter().map(|m| axes.x(m.t)).collect();
    for i in 0..at.len() {
        let least = if i == 0 { left } else { at[i - 1] + ROOM };
        at[i] = at[i].max(least);
    }
    for i in (0..at.len()).rev() {
        let most = if i + 1 == at.len() {
            left + width
        } else {
            at[i + 1] - ROOM
        };
        at[i] = at[i].min(most);
    }
    for (m, lx) in moments.iter().zip(&at) {
        let x = axes.x(m.t);
        page.text(*lx, y + 8.0, 11.5, INK, "middle", true, &m.letter);
        page.polyline(
            &[[*lx, y + 11.0], [x, top], [x, top + height]],
            "#b8c2cc",
            0.8,
            "2 3",
        );
    }
}

fn strip(
    page: &mut Svg,
    axes: &Axes,
    track: &[Stroke],
    history: &PawlDocument,
    colour: &str,
    title: &str,
) {
    let [left, top, width, height] = axes.rect;
    let step = degree_step(axes.degrees[1] - axes.degrees[0]);
    let mut k = (axes.degrees[0] / step).ceil();
    while k * step <= axes.degrees[1] {
        let y = axes.y(k * step);
        let rest = k == 0.0;
        page.line(
            [left, y],
            [left + width, y],
            if rest { RULE } else { "#d3dae1" },
            if rest { 1.0 } else { 0.6 },
            "",
        );
        page.text(
            left - 7.0,
            y + 3.8,
            11.0,
            MUTED,
            "end",
            false,
            &(digits(k * step, 6) + "°"),
        );
        k += 1.0;
    }
    for stroke in track {
        let points: Vec<Point> = stroke.points.iter().map(|p| axes.at(*p)).collect();
        page.polyline(&points, colour, if stroke.free { 1.6 } else { 2.4 }, "");
    }
    for e in &history.events {
        if let Some(to) = e.to_theta {
            let t = e.time.approx();
            page.line(axes.at([t, e.theta]), axes.at([t, to]), colour, 1.4, "5 4");
        }
    }
    let marked = |kind: &str| !matches!(kind, "phase-end" | "plan-end");
    for e in history.events.iter().filter(|e| marked(e.kind)) {
        page.marker(e.kind, axes.at([e.time.approx(), e.theta]), colour);
    }
    page.rect(axes.rect, "none", RULE);
    let title = fit(title, 12.0, 0.5 * width);
    // On a ground of its own, in the corner that the curve leaves free.
    let from = [axes.t[0], axes.t[0] + 0.25 * (axes.t[1] - axes.t[0])];
    let high = track
        .iter()
        .flat_map(|s| &s.points)
        .filter(|p| p[0] >= from[0] && p[0] <= from[1])
        .any(|p| axes.at(*p)[1] < top + 26.0);
    let y = if high { top + height - 8.0 } else { top + 16.0 };
    page.rect(
        [left + 4.0, y - 12.0, text_width(&title, 12.0) + 8.0, 16.0],
        "#ffffff",
        "none",
    );
    page.text(left + 8.0, y, 12.0, colour, "start", true, &title);
}

fn time_axis(page: &mut Svg, axes: &Axes) -> f64 {
    let [left, top, width, height] = axes.rect;
    let y = top + height;
    let step = nice_step((axes.t[1] - axes.t[0]) / 9.0);
    let mut k = 0.0;
    while k * step <= axes.t[1] * (1.0 + 1e-9) {
        let x = axes.x(k * step);
        page.line([x, y], [x, y + 4.0], RULE, 1.0, "");
        page.text(
            x,
            y + 17.0,
            11.0,
            MUTED,
            "middle",
            false,
            &digits(k * step, 6),
        );
        k += 1.0;
    }
    page.text(
        left + width / 2.0,
        y + 33.0,
        12.0,
        INK,
        "middle",
        false,
        "time t",
    );
    y + 36.0
}

/// What the marks mean: those that occur.
fn legend(page: &mut Svg, result: &ResultDocument, [x, y, width]: [f64; 3]) -> f64 {
    const KINDS: [&str; 13] = [
        "translational-collision",
        "sliding-collision",
        "release",
        "snap-free",
        "snap-free-vertex",
        "snap-landing",
        "limit-stop",
        "stick",
        "jam-incompatible",
        "jam-single",
        "bifurcation",
        "root-collision",
        "graze",
    ];
    let occurs = |kind: &&str| {
        let mut events = result.pawls.iter().flat_map(|p| &p.events);
        events.any(|e| e.kind == *kind)
    };
    let (mut at, mut y) = (x + LEFT, y);
    for kind in KINDS.into_iter().filter(occurs) {
        let room = 34.0 + text_width(kind, 11.5);
        if at + room > x + width {
            (at, y) = (x + LEFT, y + 18.0);
        }
        page.marker(kind, [at + 6.0, y], MUTED);
        page.text(at + 16.0, y + 4.0, 11.5, INK, "start", false, kind);
        at += room;
    }
    y + 8.0
}
