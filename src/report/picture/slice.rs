//! A slice as a picture (DP Figs. 19–22): the cylinder unrolled, time to the right and orientation upwards.
//!
//! F is shaded, its boundary drawn in the colour of the contact's type, arcs that bound other parts of free space
//! or nothing faintly, sticking regions in red. The attractor θ = 0 is dashed, the trajectory runs along
//! it and along F's boundary, with the marks of its events. Everything is in doubles: nothing here decides.

use super::super::json::ResultDocument;
use super::stage::Stage;
use super::svg::{CONTACT, INK, MUTED, Point, RULE, Svg};
use crate::contact::{Chart, Contact, ContactKind};
use crate::motion::Seen;
use crate::motion::friction::regions;
use crate::number::{Algebraic, Rat};
use crate::scene::Scene;
use crate::slice::{Arc, Owner, Shape};
use std::f64::consts::{FRAC_PI_2, PI};

const TYPE_A: &str = "#1d6f42";
const TYPE_B: &str = "#1f5fa8";
const LIMIT: &str = "#7a4fa3";
const FREE: &str = "#fdf3d0";
const WIDTH: f64 = 1180.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 62.0;
const HEIGHT: f64 = 560.0;
/// Columns by which F is shaded.
const COLUMNS: i64 = 420;

/// What a picture of a slice is made from.
pub struct SlicePicture<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The whole result, of which the pawl's history in the phase is drawn.
    pub result: &'a ResultDocument,
    /// The slice with F.
    pub seen: &'a Seen,
}

struct Axes {
    duration: f64,
}

impl Axes {
    fn x(&self, t: f64) -> f64 {
        LEFT + (WIDTH - LEFT - RIGHT) * t / self.duration
    }
    /// θ from −π to π.
    fn y(&self, theta: f64) -> f64 {
        TOP + HEIGHT * (PI - theta) / (2.0 * PI)
    }
    fn at(&self, t: f64, theta: f64) -> Point {
        [self.x(t), self.y(theta)]
    }
}

/// θ in (−π, π] of a chart position.
fn theta(chart: Chart, x: f64) -> f64 {
    let a = 2.0 * x.atan();
    match chart {
        Chart::Rest => a,
        Chart::Back if x > 0.0 => a - PI,
        Chart::Back => a + PI,
    }
}

fn colour(c: &Contact) -> &'static str {
    match c {
        Contact::Limit(_) => LIMIT,
        Contact::Obstacle {
            kind: ContactKind::A,
            ..
        } => TYPE_A,
        Contact::Obstacle { .. } => TYPE_B,
    }
}

fn middle(x: &Algebraic) -> f64 {
    let i = x.interval();
    (i.lo + i.hi) / 2.0
}

fn double(r: &Rat) -> f64 {
    r.nearest_f64().unwrap_or(0.0)
}

/// Points (t, θ) along a stretch of an arc between two chart positions (or times, of a level), cut where θ
/// wraps round.
fn course(p: &SlicePicture<'_>, arc: &Arc, from: f64, to: f64) -> Vec<Vec<[f64; 2]>> {
    let curve = p.seen.slice.curve(arc.curve);
    let (n, d) = curve.reduced(arc.chart);
    let coef = |f: &crate::number::Poly| -> [f64; 3] {
        let s = f.coeffs().iter().map(|c| c.bits()).max().unwrap_or(0);
        let s = s.saturating_sub(900);
        std::array::from_fn(|i| double(&Rat::from(f.coeff(i).shr(s))))
    };
    let (n, d) = (coef(n), coef(d));
    let horner = |c: [f64; 3], x: f64| (c[2] * x + c[1]) * x + c[0];
    let steps = 48;
    let mut pieces = vec![Vec::new()];
    for i in 0..=steps {
        let x = from + (to - from) * f64::from(i) / f64::from(steps);
        let point = match arc.shape {
            Shape::Level => [x, theta(arc.chart, middle(&arc.lo.x))],
            Shape::Wall => [middle_time(&arc.lo.t), theta(arc.chart, x)],
            Shape::Graph { .. } => [-horner(n, x) / horner(d, x), theta(arc.chart, x)],
        };
        let last: Option<&[f64; 2]> = pieces.last().and_then(|l: &Vec<[f64; 2]>| l.last());
        if let Some(l) = last.filter(|l| (l[1] - point[1]).abs() > PI) {
            // Over θ = ±π, x = 0 of the back chart: up to there on one side, from there on the other.
            let edge = if l[1] > 0.0 { PI } else { -PI };
            let t = match arc.shape {
                Shape::Graph { .. } => -horner(n, 0.0) / horner(d, 0.0),
                _ => point[0],
            };
            if let Some(l) = pieces.last_mut() {
                l.push([t, edge]);
            }
            pieces.push(vec![[t, -edge]]);
        }
        if let Some(l) = pieces.last_mut() {
            l.push(point);
        }
    }
    pieces
}

fn middle_time(t: &crate::slice::Time) -> f64 {
    let i = t.interval();
    (i.lo + i.hi) / 2.0
}

/// The range that a whole arc is drawn over.
fn whole(arc: &Arc) -> [f64; 2] {
    match arc.shape {
        Shape::Level => [middle_time(&arc.lo.t), middle_time(&arc.hi.t)],
        _ => [middle(&arc.lo.x), middle(&arc.hi.x)],
    }
}

/// The picture as an SVG document.
pub fn slice_svg(p: &SlicePicture<'_>) -> String {
    let seen = p.seen;
    let axes = Axes {
        duration: double(&seen.slice.frame.duration),
    };
    let mut page = Svg::new();
    let pawl = &p.scene.pawls[seen.pawl].name;
    let title = format!("{}: pawl {pawl}, phase {}", p.scene.name, seen.phase);
    page.text(LEFT, 26.0, 17.0, INK, "start", true, &title);
    let about = match &seen.free {
        Some(f) => format!(
            "{} contact arcs; F has {} half-edges in {} cycle{}",
            seen.slice.arcs().len(),
            f.half_edges(),
            f.cycles(),
            if f.cycles() == 1 { "" } else { "s" }
        ),
        None if p.result.outcome.kind == "undecided" => format!(
            "{} contact arcs; F was not found within the time limit",
            seen.slice.arcs().len()
        ),
        None => format!(
            "{} contact arcs; the pawl has no interval to be in",
            seen.slice.arcs().len()
        ),
    };
    page.text(LEFT, 46.0, 12.5, MUTED, "start", false, &about);
    let window = [LEFT, TOP, WIDTH - LEFT - RIGHT, HEIGHT];
    page.clip(window);
    page.rect(window, "#f1f3f5", "none");
    shade(&mut page, p, &axes);
    for arc in seen.slice.arcs() {
        let [from, to] = whole(arc);
        let dash = if arc.is_barrier() { "" } else { "2 3" };
        stroke(&mut page, p, &axes, arc, [from, to], RULE, 0.7, dash);
    }
    boundary(&mut page, p, &axes);
    page.line(
        axes.at(0.0, 0.0),
        axes.at(axes.duration, 0.0),
        INK,
        1.0,
        "6 4",
    );
    trajectory(&mut page, p, &axes);
    page.end();
    frame(&mut page, p, &axes);
    page.finish(WIDTH, TOP + HEIGHT + 76.0, &p.scene.name, &title)
}

#[allow(clippy::too_many_arguments, reason = "a stroke has as many properties")]
fn stroke(
    page: &mut Svg,
    p: &SlicePicture<'_>,
    axes: &Axes,
    arc: &Arc,
    [from, to]: [f64; 2],
    colour: &str,
    width: f64,
    dash: &str,
) {
    for piece in course(p, arc, from, to) {
        let points: Vec<Point> = piece.iter().map(|q| axes.at(q[0], q[1])).collect();
        if points.len() > 1 && points.iter().flatten().all(|c| c.is_finite()) {
            page.polyline(&points, colour, width, dash);
        }
    }
}

fn shade(page: &mut Svg, p: &SlicePicture<'_>, axes: &Axes) {
    let Some(free) = &p.seen.free else { return };
    let duration = &p.seen.slice.frame.duration;
    let wide = (axes.x(axes.duration) - axes.x(0.0)) / COLUMNS as f64;
    let mut band = |t: f64, lo: f64, hi: f64| {
        let y = axes.y(hi);
        let rect = [axes.x(t) - wide / 2.0, y, wide + 0.4, axes.y(lo) - y];
        page.rect(rect, FREE, "none");
    };
    for i in 0..COLUMNS {
        let t = duration * &Rat::frac(2 * i + 1, 2 * COLUMNS);
        let at = double(&t);
        let Some(list) = free.intervals(&p.seen.slice, &t) else {
            band(at, -PI, PI);
            continue;
        };
        for interval in list {
            let end =
                |(e, x): &(u32, Algebraic)| theta(free.edges()[*e as usize].chart(), middle(x));
            let (lo, hi) = (end(&interval.low), end(&interval.high));
            if lo <= hi {
                band(at, lo, hi);
            } else {
                band(at, lo, PI);
                band(at, -PI, hi);
            }
        }
    }
}

fn boundary(page: &mut Svg, p: &SlicePicture<'_>, axes: &Axes) {
    let Some(free) = &p.seen.free else { return };
    for e in free.edges() {
        let Owner::Arc(id) = e.owner else { continue };
        let arc = p.seen.slice.arc(id);
        let moved = 2.0 * arc.chart.index() as f64;
        let range = match arc.shape {
            Shape::Level => [e.bounds[2], e.bounds[3]],
            _ => [e.bounds[0] - moved, e.bounds[1] - moved],
        };
        stroke(page, p, axes, arc, range, colour(&arc.contact), 2.0, "");
        if arc.shape == Shape::Wall || p.scene.friction.is_none() {
            continue;
        }
        for r in regions(&p.seen.slice, id, p.scene.friction.as_ref()) {
            if !r.sticks {
                continue;
            }
            // In time; the arc is monotone, so that its points in that time are a stretch.
            let (from, to) = (middle_time(&r.from), middle_time(&r.to));
            for piece in course(p, arc, range[0], range[1]) {
                let points: Vec<Point> = piece
                    .iter()
                    .filter(|q| q[0] >= from && q[0] <= to)
                    .map(|q| axes.at(q[0], q[1]))
                    .collect();
                if points.len() > 1 {
                    page.polyline(&points, CONTACT, 4.0, "2 2");
                }
            }
        }
    }
}

fn trajectory(page: &mut Svg, p: &SlicePicture<'_>, axes: &Axes) {
    let stage = Stage::new(p.scene, p.result);
    let phase = p.seen.phase;
    let Some(begin) = p.result.phases.get(phase).map(|q| q.from.approx()) else {
        return;
    };
    let history = &p.result.pawls[p.seen.pawl];
    let wrap = |a: f64| a - 2.0 * PI * ((a + PI) / (2.0 * PI)).floor();
    for s in history.segments.iter().filter(|s| s.phase == phase) {
        let (from, to) = (s.from.approx(), s.to.approx());
        let mut points: Vec<Point> = Vec::new();
        let mut last = 0.0;
        for i in 0..=96 {
            // Just inside, so that a jump at an end belongs to nobody.
            let part = (f64::from(i) / 96.0).clamp(1e-9, 1.0 - 1e-9);
            let t = from + (to - from) * part;
            let a = wrap(stage.theta(p.seen.pawl, phase, t));
            if !points.is_empty() && f64::abs(a - last) > PI {
                page.polyline(&points, INK, 3.2, "");
                points.clear();
            }
            points.push(axes.at(t - begin, a));
            last = a;
        }
        page.polyline(&points, INK, 3.2, "");
    }
    for e in history.events.iter().filter(|e| e.phase == phase) {
        let at = axes.at(e.time.approx() - begin, wrap(e.theta));
        if let Some(to) = e.to_theta {
            page.arrow(at, axes.at(e.time.approx() - begin, wrap(to)), INK);
        }
        page.marker(e.kind, at, CONTACT);
    }
}

fn frame(page: &mut Svg, p: &SlicePicture<'_>, axes: &Axes) {
    page.rect([LEFT, TOP, WIDTH - LEFT - RIGHT, HEIGHT], "none", RULE);
    for (a, name) in [
        (PI, "180°"),
        (FRAC_PI_2, "90°"),
        (0.0, "0° rest"),
        (-FRAC_PI_2, "−90°"),
        (-PI, "−180°"),
    ] {
        let y = axes.y(a);
        page.line([LEFT - 5.0, y], [LEFT, y], RULE, 1.0, "");
        page.text(LEFT - 9.0, y + 4.0, 12.0, MUTED, "end", false, name);
    }
    let step = super::plot::nice_step(axes.duration / 8.0);
    let bottom = TOP + HEIGHT;
    let mut k = 0.0;
    while k * step <= axes.duration * (1.0 + 1e-9) && k < 100.0 {
        let x = axes.x(k * step);
        page.line([x, bottom], [x, bottom + 5.0], RULE, 1.0, "");
        let label = format!("{}", (k * step * 1e6).round() / 1e6);
        page.text(x, bottom + 19.0, 12.0, MUTED, "middle", false, &label);
        k += 1.0;
    }
    let x = WIDTH - RIGHT;
    page.text(
        x,
        bottom + 36.0,
        12.0,
        MUTED,
        "end",
        false,
        "t, from the start of the phase",
    );
    let mut x = LEFT;
    let y = bottom + 56.0;
    let sticks = p.scene.friction.is_some();
    for (name, c, width, dash) in [
        ("type A", TYPE_A, 2.0, ""),
        ("type B", TYPE_B, 2.0, ""),
        ("angular stop", LIMIT, 2.0, ""),
        ("other arcs", RULE, 0.7, ""),
        ("sticking", CONTACT, 4.0, "2 2"),
        ("trajectory", INK, 3.2, ""),
        ("attractor θ = 0", INK, 1.0, "6 4"),
    ] {
        if name == "sticking" && !sticks {
            continue;
        }
        page.line([x, y], [x + 26.0, y], c, width, dash);
        page.text(x + 32.0, y + 4.0, 12.0, INK, "start", false, name);
        x += 48.0 + super::svg::text_width(name, 12.0);
    }
    page.rect([x, y - 7.0, 26.0, 14.0], FREE, RULE);
    page.text(x + 32.0, y + 4.0, 12.0, INK, "start", false, "F");
}
