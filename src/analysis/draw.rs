//! Pictures of verdicts, in doubles: force over travel, and the rose of directions.

use super::document::ClassifyDocument;
use super::forces::{DrawnPhase, ForcesDocument};
use crate::report::picture::svg::{INK, MUTED, RULE, Svg, text_width};
use crate::report::words::digits;

/// The colours of phases, in turn.
const COLOURS: [&str; 4] = ["#1b6ca8", "#c8553d", "#3a7d44", "#7b4b94"];

/// An arc that got out wherever it was tried, without a proof.
const TRIED: &str = "none, tried";

/// What a verdict is drawn in: the firmer, the darker.
fn shade(verdict: &str) -> &'static str {
    match verdict {
        "kinematic" => "#1d3557",
        "friction" => "#457b9d",
        "force" => "#e9a03b",
        "none" => "#f3b8b0",
        TRIED => "#fbe4e0",
        _ => "#d8dde3",
    }
}

/// Page coordinates of travel and force.
struct Axis {
    x: [f64; 2],
    y: [f64; 2],
    rect: [f64; 4],
}

impl Axis {
    fn at(&self, p: [f64; 2]) -> [f64; 2] {
        let part = |v: f64, [lo, hi]: [f64; 2]| (v - lo) / (hi - lo).max(1e-300);
        let [left, top, width, height] = self.rect;
        [
            left + part(p[0], self.x) * width,
            top + (1.0 - part(p[1], self.y)) * height,
        ]
    }
}

/// 1, 2 or 5 times a power of ten.
fn step(span: f64) -> f64 {
    let about = (span / 6.0).max(1e-300);
    let power = 10f64.powf(about.log10().floor());
    let by = about / power;
    power
        * match by {
            b if b < 1.5 => 1.0,
            b if b < 3.5 => 2.0,
            b if b < 7.5 => 5.0,
            _ => 10.0,
        }
}

/// Force against the travel over the travel: one curve a phase, the way back from right to left
/// over the same ground, without friction dashed, the handbook's values as rings.
pub fn force_plot(doc: &ForcesDocument) -> String {
    let (width, height) = (900.0, 520.0);
    let mut page = Svg::new();
    let title = format!("{}: force against the travel", doc.scene);
    page.text(28.0, 34.0, 17.0, INK, "start", true, &title);
    if !doc.modelled {
        let note = doc.note.as_deref().unwrap_or("nothing is modelled");
        page.text(28.0, 60.0, 13.0, MUTED, "start", false, note);
        return page.finish(width, 90.0, &doc.scene, note);
    }
    let phases = &doc.drawing.phases;
    // Where each phase begins along the path, and which way it goes.
    let mut places: Vec<(f64, f64)> = Vec::new();
    let mut end = 0.0;
    for p in phases {
        let way = if p.back { -1.0 } else { 1.0 };
        places.push((end, way));
        end += way * p.length;
    }
    let reach = places
        .iter()
        .zip(phases)
        .flat_map(|((from, way), p)| [*from, from + way * p.length]);
    let (mut lo, mut hi) = (0.0f64, 0.0f64);
    for x in reach.filter(|x| x.is_finite()) {
        lo = lo.min(x);
        hi = hi.max(x);
    }
    let axis = Axis {
        x: [lo, hi.max(lo + 1e-9)],
        y: heights(phases),
        rect: [78.0, 60.0, width - 110.0, height - 155.0],
    };
    grid(&mut page, &axis);
    let mut y = height - 36.0;
    page.clip(axis.rect);
    for (k, (p, (from, way))) in phases.iter().zip(&places).enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let place = |q: &[f64; 2]| axis.at([from + way * q[0], q[1]]);
        for run in &p.smooth {
            let points: Vec<_> = run.iter().map(place).collect();
            page.polyline(&points, colour, 1.1, "5 4");
        }
        for run in &p.rubbed {
            let points: Vec<_> = run.iter().map(place).collect();
            page.polyline(&points, colour, 2.2, "");
        }
        for q in p.handbook.iter().filter(|q| q[1].is_finite()) {
            page.circle(place(q), 4.0, "none", colour, 1.5);
        }
        if let Some(at) = p.unbounded {
            let [x, _] = axis.at([from + way * at, 0.0]);
            page.line(
                [x, axis.rect[1]],
                [x, axis.rect[1] + axis.rect[3]],
                colour,
                1.2,
                "2 3",
            );
        }
    }
    page.end();
    page.rect(axis.rect, "none", RULE);
    for (k, p) in phases.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let x = 78.0 + 400.0 * (k % 2) as f64;
        page.line([x, y - 4.0], [x + 22.0, y - 4.0], colour, 2.2, "");
        let arrow = if p.back { "←" } else { "→" };
        let held = if p.unbounded.is_some() {
            ", held for good at the dotted line"
        } else {
            ""
        };
        let name = format!("{arrow} {}{held}", p.name);
        page.text(x + 30.0, y, 12.0, INK, "start", false, &name);
        if k % 2 == 1 {
            y += 17.0;
        }
    }
    let mut marks = vec!["→ ←: which way the root goes; below 0 it is pulled along"];
    if phases.iter().any(|p| !p.smooth.is_empty()) {
        marks.push("dashed: without friction");
    }
    if phases.iter().any(|p| !p.handbook.is_empty()) {
        marks.push("rings: the handbook's formula at the largest deflection");
    }
    let legend = marks.join("; ");
    page.text(width - 32.0, 52.0, 11.0, MUTED, "end", false, &legend);
    page.text(
        axis.rect[0] + axis.rect[2] / 2.0,
        axis.rect[1] + axis.rect[3] + 33.0,
        12.0,
        INK,
        "middle",
        false,
        "travel of the root, in the scene's unit of length",
    );
    page.upward(
        [18.0, axis.rect[1] + axis.rect[3] / 2.0],
        12.0,
        INK,
        "push against the travel, in the unit of stiffness per length",
    );
    page.finish(width, height.max(y + 20.0), &doc.scene, &title)
}

/// The forces to show: all that is finite, a steep rise cut off well above the rest.
fn heights(phases: &[DrawnPhase]) -> [f64; 2] {
    let mut steady: Vec<f64> = Vec::new();
    let (mut lo, mut hi) = (0.0f64, 0.0f64);
    for p in phases {
        for v in p
            .rubbed
            .iter()
            .flatten()
            .chain(p.smooth.iter().flatten())
            .map(|q| q[1])
        {
            if v.is_finite() {
                steady.push(v.abs());
            }
        }
        for v in p.handbook.iter().map(|q| q[1]).filter(|v| v.is_finite()) {
            (lo, hi) = (lo.min(v), hi.max(v));
        }
    }
    steady.sort_by(f64::total_cmp);
    let most = steady.get(steady.len() * 9 / 10).copied().unwrap_or(0.0);
    let held = phases.iter().any(|p| p.unbounded.is_some());
    let cut = if held {
        (4.0 * most).max(hi).max(-lo)
    } else {
        f64::MAX
    };
    for p in phases {
        for q in p.rubbed.iter().flatten().chain(p.smooth.iter().flatten()) {
            if q[1].is_finite() {
                lo = lo.min(q[1].max(-cut));
                hi = hi.max(q[1].min(cut));
            }
        }
    }
    if hi - lo < 1e-12 {
        return [-1.0, 1.0];
    }
    let air = 0.06 * (hi - lo);
    [lo - air, hi + air]
}

fn grid(page: &mut Svg, axis: &Axis) {
    let [left, top, width, height] = axis.rect;
    for (k, [lo, hi]) in [axis.x, axis.y].into_iter().enumerate() {
        let step = step(hi - lo);
        let mut i = (lo / step).ceil();
        while i * step <= hi {
            let v = i * step;
            let strong = i == 0.0;
            let (colour, thick) = if strong {
                (RULE, 1.2)
            } else {
                ("#e1e6eb", 0.7)
            };
            if k == 0 {
                let [x, _] = axis.at([v, 0.0]);
                page.line([x, top], [x, top + height], colour, thick, "");
                page.text(
                    x,
                    top + height + 16.0,
                    11.0,
                    MUTED,
                    "middle",
                    false,
                    &digits(v, 6),
                );
            } else {
                let [_, y] = axis.at([0.0, v]);
                page.line([left, y], [left + width, y], colour, thick, "");
                page.text(
                    left - 7.0,
                    y + 4.0,
                    11.0,
                    MUTED,
                    "end",
                    false,
                    &digits(v, 6),
                );
            }
            i += 1.0;
        }
    }
}

/// The circle of directions: the cover's arcs by what is proven of them, single directions as
/// dots, flips as ticks, the family as arrows.
pub fn rose(doc: &ClassifyDocument) -> String {
    let (width, height) = (740.0, 668.0);
    let mut page = Svg::new();
    let class = doc.class.unwrap_or("no class");
    let title = match doc.extent {
        Some(extent) => format!("{}: {extent} {class} diode", doc.scene),
        None => format!("{}: {class}", doc.scene),
    };
    let title = match doc.total {
        Some("none") if doc.extent.is_some() => title + "; not in every direction",
        _ => title,
    };
    page.text(28.0, 34.0, 17.0, INK, "start", true, &title);
    let (cx, cy, outer, inner) = (370.0, 316.0, 210.0, 145.0);
    let read = |p: &[String; 2]| {
        let of = |s: &String| {
            s.parse::<crate::number::Rat>()
                .ok()
                .and_then(|r| r.nearest_f64())
        };
        [of(&p[0]).unwrap_or(0.0), of(&p[1]).unwrap_or(0.0)]
    };
    let angle = |p: &[String; 2]| {
        let [x, y] = read(p);
        y.atan2(x)
    };
    let at = |phi: f64, r: f64| [cx + r * phi.cos(), cy - r * phi.sin()];
    page.circle([cx, cy], outer, "#f5f7fa", RULE, 1.0);
    let mut seen: Vec<&str> = Vec::new();
    for arc in &doc.cover {
        let (from, mut to) = (angle(&arc.from), angle(&arc.to));
        if to <= from {
            to += std::f64::consts::TAU;
        }
        if to - from > 6.0 && doc.cover.len() > 1 {
            continue;
        }
        let tried = arc.verdict == "none" && !arc.proven;
        let said = if tried { TRIED } else { arc.verdict };
        let n = ((to - from) * 40.0).ceil().max(1.0) as usize;
        let along = |k: usize| from + (to - from) * k as f64 / n as f64;
        let mut ring: Vec<[f64; 2]> = (0..=n).map(|k| at(along(k), outer)).collect();
        ring.extend((0..=n).rev().map(|k| at(along(k), inner)));
        let style = format!(
            "fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"0.4\"",
            shade(said)
        );
        page.shape(&[ring], &style);
        if !seen.contains(&said) {
            seen.push(said);
        }
    }
    page.circle([cx, cy], inner, "#ffffff", RULE, 1.0);
    marks(&mut page, &at, outer + 20.0);
    for s in &doc.samples {
        let fill = shade(s.verdict);
        page.circle(at(angle(&s.direction), outer + 12.0), 3.4, fill, INK, 0.8);
        if !seen.contains(&s.verdict) {
            seen.push(s.verdict);
        }
    }
    for f in &doc.flips {
        let phi = angle(&f.from);
        page.line(
            at(phi, inner - 8.0),
            at(phi, outer + 20.0),
            "#c1121f",
            1.2,
            "",
        );
    }
    for d in &doc.directions {
        let [x, y] = [d.velocity[0].approx(), d.velocity[1].approx()];
        let phi = y.atan2(x);
        let colour = if d.verdict == "none" { "#c1121f" } else { INK };
        page.arrow([cx, cy], at(phi, inner - 14.0), colour);
    }
    if let Some(e) = &doc.escape {
        let phi = e[1].approx().atan2(e[0].approx());
        page.arrow(at(phi, inner - 14.0), at(phi, outer + 34.0), "#c1121f");
    }
    let (mut x, mut y) = (28.0, 601.0);
    let mut place = |wide: f64| {
        if x > 28.0 && x + wide > width - 28.0 {
            (x, y) = (28.0, y + 19.0);
        }
        let at = [x, y];
        x += wide + 22.0;
        at
    };
    for verdict in seen {
        let [x, y] = place(18.0 + text_width(verdict, 12.0));
        page.rect([x, y - 11.0, 13.0, 13.0], shade(verdict), RULE);
        page.text(x + 18.0, y, 12.0, INK, "start", false, verdict);
    }
    if !doc.flips.is_empty() || doc.escape.is_some() {
        let red = "red: where the verdict flips, and arrows that get out";
        let [x, y] = place(text_width(red, 12.0));
        page.text(x, y, 12.0, "#c1121f", "start", false, red);
    }
    let more = y - 601.0;
    let notes = [
        "the angle says which way the root is moved from the end of the plan",
        "ring: whole arcs, each proven to hold so firmly, or to get out; pale: got out wherever it was tried",
        "dots: single directions, decided exactly; arrows inside: the control family; outside: a way out",
    ];
    for (k, note) in notes.into_iter().enumerate() {
        page.text(
            28.0,
            622.0 + more + 15.0 * k as f64,
            11.0,
            MUTED,
            "start",
            false,
            note,
        );
    }
    page.finish(width, height + more, &doc.scene, &title)
}

/// Angles round the rose, every 30°, counter-clockwise from x.
fn marks(page: &mut Svg, at: &dyn Fn(f64, f64) -> [f64; 2], r: f64) {
    for k in 0..12 {
        let phi = f64::from(k) * std::f64::consts::PI / 6.0;
        page.line(at(phi, r), at(phi, r + 6.0), MUTED, 0.9, "");
        let [x, y] = at(phi, r + 30.0);
        let text = match k {
            0 => "0° (+x)".to_owned(),
            3 => "90° (+y)".to_owned(),
            _ => format!("{}°", 30 * k),
        };
        page.text(x, y + 4.0, 10.5, MUTED, "middle", false, &text);
    }
}

/// Two pictures, one under the other, as one.
pub fn stacked(pictures: &[String]) -> String {
    let size = |svg: &str, key: &str| {
        let at = svg
            .find(&format!(" {key}=\""))
            .map_or(0, |i| i + key.len() + 3);
        svg[at..]
            .split('"')
            .next()
            .and_then(|v| v.parse::<f64>().ok())
            .unwrap_or(0.0)
    };
    let width = pictures
        .iter()
        .map(|p| size(p, "width"))
        .fold(0.0, f64::max);
    let (mut y, mut body) = (0.0, String::new());
    for p in pictures {
        body += &p.replacen("<svg ", &format!("<svg y=\"{y}\" "), 1);
        y += size(p, "height");
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{y}\" viewBox=\"0 0 {width} {y}\">\n{body}</svg>\n"
    )
}
