//! Structures before and after (PF Figs. 1, 5–9): displaced outlines over the red originals.
//!
//! Drawn in doubles from exact poses. Cones of view are yellow, markers red dots; where there are
//! views, a window shows a few robots enlarged, as PF Fig. 7 does.

use super::svg::{CONTACT, INK, MUTED, Point, RULE, Svg, clipped, text_width};
use super::{MARGIN, WIDTH, fit, wrap};
use crate::flex::{Body, Hold, Pose, Structure, View};
use crate::geometry::Vec2;

/// Highest part of the page that the drawing may take.
const TALLEST: f64 = 900.0;
/// Outlines of the first configuration, and what fills them.
const BEFORE: &str = "#c1121f";
const BEFORE_FILL: &str = "#fbe3e4";
/// What fills displaced bodies, and those that are held.
const AFTER_FILL: &str = "#dfe4ea";
const HELD_FILL: &str = "#9aa5b1";
const CONE: &str = "#f2c80f";

/// A picture of a structure.
pub struct StructurePicture<'a> {
    /// The structure.
    pub structure: &'a Structure,
    /// Where its bodies stand at first: drawn red, below.
    pub before: &'a [Pose],
    /// Where they stand in the end.
    pub after: &'a [Pose],
    /// Says what is seen.
    pub title: String,
    /// A line of detail below it; may be empty.
    pub note: String,
    /// A line to be stressed, such as a brace.
    pub brace: Option<[Point; 2]>,
    /// Configurations that set the frame beside the two, so that all pictures of an animation
    /// share one.
    pub frame: &'a [Vec<Pose>],
}

fn double(p: &Vec2) -> Point {
    let d = |r: &crate::number::Rat| r.nearest_f64().unwrap_or(0.0);
    [d(&p.x), d(&p.y)]
}

/// A point of a body's frame in the plane.
fn at(body: &Body, pose: &Pose, p: &Vec2) -> Point {
    let reference = match &body.hold {
        Hold::Pin(pin) => double(pin),
        _ => [0.0, 0.0],
    };
    let u = pose.tan_half.nearest_f64().unwrap_or(0.0);
    let (c, s) = ((1.0 - u * u) / (1.0 + u * u), 2.0 * u / (1.0 + u * u));
    let [x, y] = double(p);
    let (x, y) = (x - reference[0], y - reference[1]);
    let [px, py] = double(&pose.place);
    [px + c * x - s * y, py + s * x + c * y]
}

fn outline(body: &Body, pose: &Pose) -> Vec<Point> {
    body.vertices.iter().map(|v| at(body, pose, v)).collect()
}

/// From the plane to the page.
#[derive(Clone, Copy)]
struct Map {
    origin: Point,
    scale: f64,
    page: Point,
}

impl Map {
    fn to(&self, p: Point) -> Point {
        [
            self.page[0] + (p[0] - self.origin[0]) * self.scale,
            self.page[1] - (p[1] - self.origin[1]) * self.scale,
        ]
    }

    fn all(&self, ring: &[Point]) -> Vec<Point> {
        ring.iter().map(|&p| self.to(p)).collect()
    }
}

/// The box [x0, y0, x1, y1] of some configurations.
fn bounds<'a>(structure: &Structure, all: impl Iterator<Item = &'a [Pose]>) -> [f64; 4] {
    let empty = [
        f64::INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NEG_INFINITY,
    ];
    all.flat_map(|poses| structure.bodies.iter().zip(poses))
        .flat_map(|(b, p)| outline(b, p))
        .fold(empty, |b, [x, y]| {
            [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)]
        })
}

/// The picture as an SVG document.
pub fn structure_svg(picture: &StructurePicture<'_>) -> String {
    let structure = picture.structure;
    let frames = picture.frame.iter().map(Vec::as_slice);
    let [x0, y0, x1, y1] = bounds(
        structure,
        [picture.before, picture.after].into_iter().chain(frames),
    );
    let (w, h) = ((x1 - x0).max(1e-9), (y1 - y0).max(1e-9));
    let inner = WIDTH - 2.0 * MARGIN;
    let scale = (inner / w).min(TALLEST / h);
    let mut page = Svg::new();
    let mut y = MARGIN + 16.0;
    let title = fit(&picture.title, 17.0, inner);
    page.text(MARGIN, y, 17.0, INK, "start", true, &title);
    if !picture.note.is_empty() {
        for line in wrap(&picture.note, 12.5, inner) {
            y += 18.0;
            page.text(MARGIN, y, 12.5, MUTED, "start", false, &line);
        }
    }
    y += 24.0;
    legend(&mut page, y, structure);
    y += 20.0;
    let map = Map {
        origin: [x0, y1],
        scale,
        page: [MARGIN + (inner - w * scale) / 2.0, y],
    };
    let whole = [MARGIN, y, inner, h * scale];
    draw(&mut page, picture, &map, whole);
    y += h * scale;
    if let Some(window) = window(picture, scale) {
        y += 20.0;
        y = enlarged(&mut page, picture, window, y, inner);
    }
    page.finish(WIDTH, y + MARGIN, &structure.name, &picture.title)
}

/// What the colours mean.
fn legend(page: &mut Svg, y: f64, structure: &Structure) {
    let mut x = MARGIN;
    let mut entry = |page: &mut Svg, fill: &str, stroke: &str, words: &str| {
        page.rect([x, y - 9.0, 14.0, 10.0], fill, stroke);
        page.text(x + 20.0, y, 11.5, MUTED, "start", false, words);
        x += 44.0 + text_width(words, 11.5);
    };
    entry(page, BEFORE_FILL, BEFORE, "at first");
    entry(page, AFTER_FILL, INK, "displaced");
    if structure.bodies.iter().any(|b| b.hold != Hold::Free) {
        entry(page, HELD_FILL, INK, "held");
    }
    if !structure.views.is_empty() {
        entry(page, CONE, CONE, "view of a marker (red dot)");
    }
}

fn draw(page: &mut Svg, picture: &StructurePicture<'_>, map: &Map, [x, y, w, h]: [f64; 4]) {
    let structure = picture.structure;
    // Thin lines where bodies are small.
    let typical = (map.scale * map.scale * area(structure) / structure.bodies.len() as f64).sqrt();
    let width = (typical / 25.0).clamp(0.25, 1.3);
    let pad = 2.0 * width;
    let seen = [x - pad, y - pad, x + w + pad, y + h + pad];
    let shape = |page: &mut Svg, ring: &[Point], style: &str| {
        let ring = clipped(&map.all(ring), seen);
        page.shape(&[ring], style);
    };
    let red = format!("fill=\"{BEFORE_FILL}\" stroke=\"{BEFORE}\" stroke-width=\"{width:.2}\"");
    for (body, pose) in structure.bodies.iter().zip(picture.before) {
        shape(page, &outline(body, pose), &red);
    }
    for view in &structure.views {
        let ring = cone(structure, picture.after, view);
        shape(
            page,
            &ring,
            &format!("fill=\"{CONE}\" fill-opacity=\"0.35\" stroke=\"none\""),
        );
    }
    for (body, pose) in structure.bodies.iter().zip(picture.after) {
        let fill = if body.hold == Hold::Fixed {
            HELD_FILL
        } else {
            AFTER_FILL
        };
        let style = format!(
            "fill=\"{fill}\" fill-opacity=\"0.75\" stroke=\"{INK}\" stroke-width=\"{width:.2}\""
        );
        shape(page, &outline(body, pose), &style);
        if let Hold::Pin(pin) = &body.hold {
            page.circle(map.to(at(body, pose, pin)), 3.0, "#ffffff", INK, 1.2);
        }
    }
    for view in &structure.views {
        let (body, pose) = (&structure.bodies[view.of], &picture.after[view.of]);
        let p = map.to(at(body, pose, &view.marker));
        if (seen[0]..=seen[2]).contains(&p[0]) && (seen[1]..=seen[3]).contains(&p[1]) {
            page.circle(p, (typical / 8.0).clamp(0.6, 4.0), CONTACT, "none", 0.0);
        }
    }
    if let Some([a, b]) = picture.brace {
        page.line(map.to(a), map.to(b), "#0072b2", 3.0, "7 4");
        for p in [a, b] {
            page.circle(map.to(p), 4.0, "#0072b2", "#ffffff", 1.0);
        }
    }
}

/// The area of all bodies together.
fn area(structure: &Structure) -> f64 {
    let each = structure.bodies.iter().map(|b| {
        let v: Vec<Point> = b.vertices.iter().map(double).collect();
        let n = v.len();
        let cross = |k: usize| v[k][0] * v[(k + 1) % n][1] - v[k][1] * v[(k + 1) % n][0];
        (0..n).map(cross).sum::<f64>().abs() / 2.0
    });
    each.sum::<f64>().max(1e-12)
}

/// The cone of a view as far as its marker, or as its range.
fn cone(structure: &Structure, poses: &[Pose], view: &View) -> Vec<Point> {
    let (body, pose) = (&structure.bodies[view.body], &poses[view.body]);
    let eye = at(body, pose, &view.camera);
    let marker = at(&structure.bodies[view.of], &poses[view.of], &view.marker);
    let far = view.far.as_ref().map_or(marker, |f| at(body, pose, f));
    let reach = (far[0] - eye[0]).hypot(far[1] - eye[1]);
    let ahead = |d: &Vec2| {
        let end = at(body, pose, &(&view.camera + d));
        let (dx, dy) = (end[0] - eye[0], end[1] - eye[1]);
        let l = dx.hypot(dy).max(1e-12);
        // As far as the line square to the way ahead.
        let along = (dx * (far[0] - eye[0]) + dy * (far[1] - eye[1])) / (l * reach.max(1e-12));
        let t = reach / along.max(0.2) / l;
        [eye[0] + t * dx, eye[1] + t * dy]
    };
    vec![eye, ahead(&view.right), ahead(&view.left)]
}

/// A part of the plane that is worth enlarging: where robots are drawn small.
fn window(picture: &StructurePicture<'_>, scale: f64) -> Option<[f64; 4]> {
    let view = picture
        .structure
        .views
        .get(picture.structure.views.len() / 2)?;
    let place = |k: usize| double(&picture.after[k].place);
    let (a, b) = (place(view.body), place(view.of));
    let half = 3.2 * (b[0] - a[0]).hypot(b[1] - a[1]);
    (half * scale < 150.0).then_some([
        a[0] - half,
        a[1] - half / 2.0,
        a[0] + half,
        a[1] + half / 2.0,
    ])
}

fn enlarged(
    page: &mut Svg,
    picture: &StructurePicture<'_>,
    [x0, y0, x1, y1]: [f64; 4],
    y: f64,
    inner: f64,
) -> f64 {
    let width = inner.min(760.0);
    let scale = width / (x1 - x0);
    let rect = [MARGIN, y, width, (y1 - y0) * scale];
    page.clip(rect);
    let map = Map {
        origin: [x0, y1],
        scale,
        page: [MARGIN, y],
    };
    draw(page, picture, &map, rect);
    page.end();
    page.rect(rect, "none", RULE);
    y + rect[3]
}
