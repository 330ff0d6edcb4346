//! The mechanism at its events: one panel an instant, all at one scale (DP Fig. 4).
//!
//! What matters is where the pawls are. If they stay near, every panel shows the same window of
//! the plane and the mechanism moves through it; if they travel far, the window travels along.

use super::fit;
use super::names::Names;
use super::plot::nice_step;
use super::stage::Stage;
use super::svg::{CONTACT, INK, MUTED, Point, RULE, Svg, clipped};
use crate::report::json::{EventDocument, ResultDocument};
use crate::report::words::digits;

/// Most panels that are drawn.
const MOST: usize = 16;
const GAP: f64 = 16.0;
const CAPTION: f64 = 46.0;

/// Colours of the pawls: told apart by most eyes (Okabe and Ito).
const PAWLS: [&str; 6] = [
    "#0072b2", "#d55e00", "#009e73", "#aa4499", "#e69f00", "#56b4e9",
];

/// The colour of a pawl.
pub(super) fn colour(pawl: usize) -> &'static str {
    PAWLS[pawl % PAWLS.len()]
}

/// An instant worth a panel.
pub(super) struct Moment {
    pub(super) letter: String,
    pub(super) phase: usize,
    pub(super) t: f64,
    /// For each pawl θ, and θ after a snap.
    poses: Vec<(f64, Option<f64>)>,
    /// Contact points: those that begin or hold, and those left behind by a snap.
    touching: Vec<Point>,
    left: Vec<Point>,
    captions: Vec<String>,
    /// Whether the motion comes to grief here.
    ends: bool,
}

/// The weight of what ends a motion.
const GRIEF: u32 = 7;

/// The instants that are drawn, and of how many.
pub(super) struct Moments {
    pub(super) chosen: Vec<Moment>,
    of: usize,
}

/// How much an event deserves a panel.
fn weight(kind: &str) -> u32 {
    match kind {
        "jam-incompatible" | "jam-single" | "stick" | "bifurcation" => GRIEF,
        "root-collision" => 6,
        "snap-free" | "snap-free-vertex" => 6,
        "translational-collision" | "snap-landing" => 5,
        "sliding-collision" | "release" | "limit-stop" => 4,
        "plan-end" => 3,
        "phase-end" => 2,
        _ => 0,
    }
}

/// Events of one instant, with the index of their pawl.
struct Group<'a> {
    phase: usize,
    t: f64,
    weight: u32,
    events: Vec<(usize, &'a EventDocument)>,
}

/// The instants to draw, in order, lettered.
pub(super) fn moments(stage: &Stage, result: &ResultDocument) -> Moments {
    let mut all: Vec<(usize, &EventDocument)> = Vec::new();
    for (i, pawl) in result.pawls.iter().enumerate() {
        let drawn = pawl.events.iter().filter(|e| e.time.approx().is_finite());
        all.extend(drawn.map(|e| (i, e)));
    }
    all.sort_by(|(_, a), (_, b)| {
        let times = a.time.approx().total_cmp(&b.time.approx());
        a.phase.cmp(&b.phase).then(times)
    });
    let mut groups = vec![Group {
        phase: 0,
        t: 0.0,
        weight: 5,
        events: Vec::new(),
    }];
    for (pawl, event) in all {
        let (phase, t) = (event.phase, event.time.approx());
        match groups.last_mut() {
            Some(g) if g.phase == phase && g.t == t => {
                g.weight = g.weight.max(weight(event.kind));
                g.events.push((pawl, event));
            }
            _ => groups.push(Group {
                phase,
                t,
                weight: weight(event.kind),
                events: vec![(pawl, event)],
            }),
        }
    }
    let mut ranked = spread(&groups);
    let worth = groups.iter().filter(|g| g.weight > 0).count();
    ranked.sort_unstable();
    let chosen = ranked.into_iter().enumerate();
    let chosen = chosen.map(|(k, i)| {
        let g = &groups[i];
        moment(stage, result, letter(k), (g.phase, g.t), &g.events)
    });
    Moments {
        chosen: chosen.collect(),
        of: worth,
    }
}

/// The instants that tell most: the weightiest, of each kind the first rather than the tenth, and
/// of equals the one farthest in time from those already chosen, so that a long plan is seen whole.
fn spread(groups: &[Group<'_>]) -> Vec<usize> {
    let kinds = |g: &Group<'_>| -> Vec<(usize, &str)> {
        let events = g.events.iter();
        events.map(|(pawl, e)| (*pawl, e.kind)).collect()
    };
    let mut kind_of: Vec<Vec<(usize, &str)>> = Vec::new();
    let which: Vec<usize> = groups
        .iter()
        .map(|g| {
            let own = kinds(g);
            kind_of.iter().position(|k| *k == own).unwrap_or_else(|| {
                kind_of.push(own);
                kind_of.len() - 1
            })
        })
        .collect();
    let mut taken = vec![0i64; kind_of.len()];
    let mut chosen: Vec<usize> = Vec::new();
    let mut left: Vec<usize> = (0..groups.len())
        .filter(|&i| groups[i].weight > 0)
        .collect();
    while chosen.len() < MOST && !left.is_empty() {
        let rank = |i: usize| 4 * i64::from(groups[i].weight) - 3 * taken[which[i]];
        let apart = |i: usize| {
            let gaps = chosen.iter().map(|&c| (groups[c].t - groups[i].t).abs());
            gaps.fold(f64::INFINITY, f64::min)
        };
        // The first of equals, where nothing is chosen yet.
        let best = left.iter().copied().reduce(|a, b| {
            let order = rank(b).cmp(&rank(a)).then(apart(b).total_cmp(&apart(a)));
            if order.is_gt() { b } else { a }
        });
        let Some(best) = best else { break };
        taken[which[best]] += 1;
        chosen.push(best);
        left.retain(|&i| i != best);
    }
    chosen
}

fn letter(k: usize) -> String {
    char::from(b'a' + (k % 26) as u8).to_string()
}

fn moment(
    stage: &Stage,
    result: &ResultDocument,
    letter: String,
    (phase, t): (usize, f64),
    events: &[(usize, &EventDocument)],
) -> Moment {
    let offset = stage.offset(phase, t);
    let mut poses = Vec::new();
    for pawl in 0..stage.pawls.len() {
        let mine = || events.iter().filter(|e| e.0 == pawl).map(|e| e.1);
        let before = mine()
            .next()
            .map_or_else(|| stage.theta(pawl, phase, t), |e| e.theta);
        let snap = mine().find(|e| e.to_theta.is_some());
        poses.push((
            snap.map_or(before, |e| e.theta),
            snap.and_then(|e| e.to_theta),
        ));
    }
    let (mut touching, mut left) = (Vec::new(), Vec::new());
    for (pawl, e) in events {
        let lost = e.to_theta.is_some() || e.kind == "release";
        for c in &e.contacts {
            if let Some(p) = stage.contact_point(c, *pawl, offset, e.theta) {
                if lost { left.push(p) } else { touching.push(p) }
            }
        }
    }
    Moment {
        letter,
        phase,
        t,
        poses,
        touching,
        left,
        captions: captions(result, events),
        ends: events.iter().any(|e| weight(e.1.kind) == GRIEF),
    }
}

/// One line a set of kinds: which pawls, what happened.
fn captions(result: &ResultDocument, events: &[(usize, &EventDocument)]) -> Vec<String> {
    if events.is_empty() {
        return vec!["start".to_owned()];
    }
    let mut lines: Vec<(Vec<&str>, String)> = Vec::new();
    for (i, pawl) in result.pawls.iter().enumerate() {
        let mut kinds: Vec<&str> = Vec::new();
        let mine = events.iter().filter(|e| e.0 == i);
        for e in mine.filter(|e| e.1.kind != "graze") {
            if !kinds.contains(&e.1.kind) {
                kinds.push(e.1.kind);
            }
        }
        if kinds.contains(&"plan-end") {
            kinds.retain(|k| *k != "phase-end");
        }
        if kinds.is_empty() {
            continue;
        }
        let text = kinds.join(", ");
        match lines.iter_mut().find(|l| l.1 == text) {
            Some(l) => l.0.push(&pawl.name),
            None => lines.push((vec![&pawl.name], text)),
        }
    }
    let alone = result.pawls.len() == 1;
    let words = lines.iter().map(|(names, text)| {
        if alone || names.len() == result.pawls.len() {
            text.clone()
        } else {
            format!("{}: {text}", names.join(", "))
        }
    });
    words.collect()
}

/// A rectangle of the plane: [x0, y0, x1, y1].
type Window = [f64; 4];

fn around(points: impl IntoIterator<Item = Point>) -> Window {
    let none = [
        f64::INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NEG_INFINITY,
    ];
    points.into_iter().fold(none, |w, [x, y]| {
        [w[0].min(x), w[1].min(y), w[2].max(x), w[3].max(y)]
    })
}

fn size(w: &Window) -> [f64; 2] {
    [w[2] - w[0], w[3] - w[1]]
}

/// The window of each moment: all of one size.
fn windows(stage: &Stage, moments: &[Moment]) -> Vec<Window> {
    let outline = |m: &Moment, offset: Point| -> Vec<Point> {
        let poses = m.poses.iter().enumerate();
        poses
            .flat_map(|(i, (before, after))| {
                let mut points = stage.pawl_at(i, offset, *before);
                points.extend(after.iter().flat_map(|a| stage.pawl_at(i, offset, *a)));
                // The hinge may lie outside of the polygon.
                let hinge = stage.pawls[i].hinge;
                points.push([hinge[0] + offset[0], hinge[1] + offset[1]]);
                points
            })
            .collect()
    };
    let offsets: Vec<Point> = moments.iter().map(|m| stage.offset(m.phase, m.t)).collect();
    let mut near = around(moments.iter().flat_map(|m| outline(m, [0.0, 0.0])));
    // The root whole where it does not dwarf the pawls, else as much of it as is near them.
    let [w, h] = size(&near);
    let reach = 0.3 * w.max(h);
    if let Some(root) = &stage.root {
        let whole = around(
            root.iter()
                .copied()
                .chain([[near[0], near[1]], [near[2], near[3]]]),
        );
        let [wide, high] = size(&whole);
        let reach = if wide.max(high) <= 2.5 * w.max(h) {
            wide.max(high)
        } else {
            reach
        };
        let frame = [
            near[0] - reach,
            near[1] - reach,
            near[2] + reach,
            near[3] + reach,
        ];
        let part = around(clipped(root, frame));
        if part[0] <= part[2] {
            near = [
                near[0].min(part[0]),
                near[1].min(part[1]),
                near[2].max(part[2]),
                near[3].max(part[3]),
            ];
        }
    }
    let paths = around(offsets.iter().copied());
    let [dx, dy] = size(&paths);
    let [w, h] = size(&near);
    let stays = dx <= 1.2 * w.max(0.5 * h) && dy <= 1.2 * h.max(0.5 * w);
    offsets
        .iter()
        .map(|o| {
            let base = if stays {
                [
                    near[0] + paths[0],
                    near[1] + paths[1],
                    near[2] + paths[2],
                    near[3] + paths[3],
                ]
            } else {
                [
                    near[0] + o[0],
                    near[1] + o[1],
                    near[2] + o[0],
                    near[3] + o[1],
                ]
            };
            framed(base)
        })
        .collect()
}

/// With a margin, and neither a needle nor a ribbon.
fn framed(w: Window) -> Window {
    let [mut dx, mut dy] = size(&w);
    let c = [(w[0] + w[2]) / 2.0, (w[1] + w[3]) / 2.0];
    let margin = 0.16 * dx.max(dy).max(1e-300);
    dx += margin;
    dy += margin;
    dx = dx.max(0.62 * dy);
    dy = dy.max(dx / 2.2);
    [
        c[0] - dx / 2.0,
        c[1] - dy / 2.0,
        c[0] + dx / 2.0,
        c[1] + dy / 2.0,
    ]
}

/// Draws the panels into [x, y, width]; returns the y below them.
pub(super) fn draw(
    page: &mut Svg,
    stage: &Stage,
    moments: &Moments,
    [x, y, width]: [f64; 3],
) -> f64 {
    let windows = windows(stage, &moments.chosen);
    let Some(first) = windows.first() else {
        return y;
    };
    let [dx, dy] = size(first);
    if !(dx.is_finite() && dy.is_finite()) {
        page.text(
            x,
            y + 14.0,
            12.0,
            MUTED,
            "start",
            false,
            "The scene is too large to be drawn.",
        );
        return y + 20.0;
    }
    let (columns, w) = columns(moments.chosen.len(), dx / dy, width);
    let h = w * dy / dx;
    let scale = w / dx;
    for (i, (m, window)) in moments.chosen.iter().zip(&windows).enumerate() {
        let px = x + (i % columns) as f64 * (w + GAP);
        let py = y + (i / columns) as f64 * (h + CAPTION);
        panel(page, stage, m, window, [px, py, w, h]);
    }
    let rows = moments.chosen.len().div_ceil(columns);
    let below = y + rows as f64 * (h + CAPTION);
    legend(page, stage, moments, scale, [x, below + 6.0, dx]);
    below + 22.0
}

/// How many columns, and how wide: a page about half as high as wide, few empty places.
fn columns(count: usize, aspect: f64, width: f64) -> (usize, f64) {
    let column = |columns: usize| {
        let w = (width - (columns - 1) as f64 * GAP) / columns as f64;
        w.min(330.0).min(330.0 * aspect.max(0.75))
    };
    let badness = |columns: usize| {
        let rows = count.div_ceil(columns);
        let height = rows as f64 * (column(columns) / aspect + CAPTION);
        let empty = (rows * columns - count) as f64 / columns as f64;
        let blank = width - columns as f64 * (column(columns) + GAP);
        (height - 0.5 * width).abs() + 0.45 * empty * width + 0.5 * blank
    };
    let best = (3..=6)
        .min_by(|a, b| badness(*a).total_cmp(&badness(*b)))
        .unwrap_or(4);
    (best, column(best))
}

fn panel(page: &mut Svg, stage: &Stage, m: &Moment, window: &Window, rect: [f64; 4]) {
    let [px, py, w, h] = rect;
    let scale = w / (window[2] - window[0]);
    let put = |p: Point| {
        [
            px + (p[0] - window[0]) * scale,
            py + (window[3] - p[1]) * scale,
        ]
    };
    let slack = 0.2 * size(window)[0].max(size(window)[1]);
    let beyond = [
        window[0] - slack,
        window[1] - slack,
        window[2] + slack,
        window[3] + slack,
    ];
    let placed =
        |ring: &[Point]| -> Vec<Point> { clipped(ring, beyond).into_iter().map(put).collect() };
    page.rect(rect, "#fbfcfd", "none");
    page.clip(rect);
    let mut names = Names::new(rect);
    for (name, rings) in &stage.obstacles {
        let rings: Vec<Vec<Point>> = rings.iter().map(|r| placed(r)).collect();
        page.shape(
            &rings,
            "fill=\"#cfd6de\" stroke=\"#616e7c\" stroke-width=\"1\"",
        );
        names.ask(name, rings);
    }
    let offset = stage.offset(m.phase, m.t);
    if let Some(root) = stage.root_at(offset) {
        let style = "fill=\"#eadfc4\" fill-opacity=\"0.8\" stroke=\"#8d7b4a\" stroke-width=\"1\"";
        let root = placed(&root);
        page.shape(std::slice::from_ref(&root), style);
        names.avoid(root);
    }
    for (i, (before, after)) in m.poses.iter().enumerate() {
        let c = colour(i);
        let now = placed(&stage.pawl_at(i, offset, after.unwrap_or(*before)));
        let style =
            format!("fill=\"{c}\" fill-opacity=\"0.32\" stroke=\"{c}\" stroke-width=\"1.5\"");
        page.shape(std::slice::from_ref(&now), &style);
        names.avoid(now);
        if after.is_some() {
            let ghost = placed(&stage.pawl_at(i, offset, *before));
            let style = format!(
                "fill=\"none\" stroke=\"{c}\" stroke-width=\"1.1\" stroke-dasharray=\"4 3\""
            );
            page.shape(std::slice::from_ref(&ghost), &style);
            names.avoid(ghost);
        }
    }
    names.write(page);
    for (i, pawl) in stage.pawls.iter().enumerate() {
        let hinge = put([pawl.hinge[0] + offset[0], pawl.hinge[1] + offset[1]]);
        page.circle(hinge, 3.6, "#ffffff", colour(i), 1.4);
        page.circle(hinge, 1.2, colour(i), "none", 0.0);
    }
    for p in &m.left {
        page.circle(put(*p), 3.4, "#ffffff", CONTACT, 1.4);
    }
    for p in &m.touching {
        page.circle(put(*p), 3.4, CONTACT, "#ffffff", 0.8);
    }
    page.end();
    page.rect(rect, "none", if m.ends { CONTACT } else { RULE });
    travel(page, stage, m.phase, [px, py]);
    let head = format!("({}) t = {}", m.letter, digits(m.t, 6));
    page.text(px, py + h + 15.0, 12.0, INK, "start", true, &head);
    let (shown, rest) = m.captions.split_at(m.captions.len().min(2));
    for (k, line) in shown.iter().enumerate() {
        let more = if k == 1 && !rest.is_empty() {
            ", …"
        } else {
            ""
        };
        let line = fit(&(line.clone() + more), 10.5, w);
        page.text(
            px,
            py + h + 28.0 + 12.0 * k as f64,
            10.5,
            MUTED,
            "start",
            false,
            &line,
        );
    }
}

/// The direction in which the root moves, in a corner of its own.
fn travel(page: &mut Svg, stage: &Stage, phase: usize, [px, py]: Point) {
    let [vx, vy] = stage.phases[phase].velocity;
    let l = vx.hypot(vy);
    if !(l.is_finite() && l > 0.0) {
        return;
    }
    let half = [9.0 * vx / l, -9.0 * vy / l];
    let c = [px + 15.0, py + 15.0];
    page.circle(c, 11.5, "#ffffff", RULE, 0.8);
    page.arrow(
        [c[0] - half[0], c[1] - half[1]],
        [c[0] + half[0], c[1] + half[1]],
        INK,
    );
}

/// What the signs in the panels mean, and a scale.
fn legend(page: &mut Svg, stage: &Stage, moments: &Moments, scale: f64, [x, y, dx]: [f64; 3]) {
    let mut at = x;
    let unit = nice_step(dx / 4.0);
    let bar = unit * scale;
    page.line([at, y], [at + bar, y], INK, 1.4, "");
    for end in [at, at + bar] {
        page.line([end, y - 3.0], [end, y + 3.0], INK, 1.4, "");
    }
    at += bar + 6.0;
    let word = |page: &mut Svg, at: &mut f64, text: &str| {
        page.text(*at, y + 3.8, 11.0, MUTED, "start", false, text);
        *at += super::text_width(text, 11.0) + 20.0;
    };
    let units = if unit == 1.0 {
        "1 unit".to_owned()
    } else {
        format!("{} units", digits(unit, 3))
    };
    word(page, &mut at, &units);
    page.circle([at + 4.0, y], 3.4, CONTACT, "#ffffff", 0.8);
    at += 12.0;
    word(page, &mut at, "contact");
    if moments.chosen.iter().any(|m| !m.left.is_empty()) {
        page.circle([at + 4.0, y], 3.4, "#ffffff", CONTACT, 1.4);
        at += 12.0;
        word(page, &mut at, "contact lost");
    }
    page.circle([at + 4.0, y], 3.6, "#ffffff", colour(0), 1.4);
    page.circle([at + 4.0, y], 1.2, colour(0), "none", 0.0);
    at += 12.0;
    word(page, &mut at, "hinge");
    if moments
        .chosen
        .iter()
        .any(|m| m.poses.iter().any(|p| p.1.is_some()))
    {
        page.line([at, y], [at + 20.0, y], colour(0), 1.1, "4 3");
        at += 26.0;
        word(page, &mut at, "before a snap");
    }
    page.arrow([at, y], [at + 18.0, y], INK);
    at += 24.0;
    word(page, &mut at, "motion of the root");
    if stage.pawls.len() > 1 {
        for (i, pawl) in stage.pawls.iter().enumerate().take(6) {
            page.rect([at, y - 4.5, 12.0, 9.0], colour(i), "none");
            at += 17.0;
            word(page, &mut at, &fit(&pawl.name, 11.0, 90.0));
        }
    }
    if moments.chosen.len() < moments.of {
        let note = format!(
            "({} of {} instants are drawn)",
            moments.chosen.len(),
            moments.of
        );
        word(page, &mut at, &note);
    }
}
