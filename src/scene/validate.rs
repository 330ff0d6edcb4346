//! From scene to sense: what can be read may still be no polygon, no plan, or start inside
//! something else. Each rule is one function; its place in the file is found by path.

use super::convert::{Conversion, clip, misspelt};
use super::source::Span;
use super::tree::{Kind, Node};
use super::types::{Motion, Pawl};
use crate::geometry::Vec2;
use crate::geometry::{Defect, EdgeRef, Meeting, Polygon, defects, interiors_intersect};
use crate::number::Rat;
use std::collections::{HashMap, HashSet};

/// Judges all that was read. Adds to the errors and warnings of the conversion.
pub(super) fn scene(c: &mut Conversion<'_>) {
    friction(c);
    names(c);
    let bodies = Bodies::of(c);
    pawls(c);
    motions(c);
    classify(c);
    starts(c, &bodies);
}

/// The value of a key of the `k`-th table of a list, or that table, or the file.
fn place(c: &Conversion<'_>, list: &str, k: usize, key: &str) -> Span {
    let table = c.tree.find(&format!("{list}.{k}"));
    table
        .and_then(|t| t.get(key))
        .or(table)
        .unwrap_or(c.tree)
        .span
}

fn friction(c: &mut Conversion<'_>) {
    if c.friction.as_ref().is_some_and(|mu| mu.sign() < 0) {
        let span = c.tree.find("scene.friction").unwrap_or(c.tree).span;
        c.error(
            span,
            "friction-negative",
            "the coefficient of friction is negative",
            "Coulomb's μ is at least 0; leave it out to model no friction",
        );
    }
}

/// Names tell bodies apart in results, so they are unique within their list.
fn names(c: &mut Conversion<'_>) {
    let names = |list: &[Option<&String>]| -> Vec<(usize, String)> {
        let named = list.iter().enumerate();
        named
            .filter_map(|(k, name)| name.map(|name| (k, name.clone())))
            .collect()
    };
    let obstacles: Vec<_> = c
        .obstacles
        .iter()
        .map(|o| o.as_ref().map(|o| &o.name))
        .collect();
    let pawls: Vec<_> = c
        .pawls
        .iter()
        .map(|p| p.as_ref().map(|p| &p.name))
        .collect();
    let (obstacles, pawls) = (names(&obstacles), names(&pawls));
    for (list, named) in [("obstacle", &obstacles), ("pawl", &pawls)] {
        let mut first = HashMap::new();
        for (k, name) in named {
            if let Some(earlier) = first.get(name) {
                c.error(
                    place(c, list, *k, "name"),
                    "duplicate-name",
                    format!("{list} {earlier} has the name `{}` already", clip(name)),
                    "give each its own name",
                );
            } else {
                first.insert(name, *k);
            }
        }
    }
    let taken: HashSet<&String> = obstacles.iter().map(|(_, name)| name).collect();
    for (k, name) in &pawls {
        if taken.contains(name) {
            c.warning(
                place(c, "pawl", *k, "name"),
                "shared-name",
                format!("an obstacle is called `{}` too", clip(name)),
                "results stay unambiguous, but people read them more easily with two names",
            );
        }
    }
}

/// The polygons of the scene where they stand at time 0, as far as they are proper.
struct Bodies {
    obstacles: Vec<Option<Polygon>>,
    root: Option<Polygon>,
    pawls: Vec<Option<Polygon>>,
}

impl Bodies {
    fn of(c: &mut Conversion<'_>) -> Bodies {
        let drawn: Vec<Option<Polygon>> = c
            .obstacles
            .iter()
            .map(|o| {
                o.as_ref()
                    .map(|o| Polygon::new(o.vertices.clone(), o.holes.clone()))
            })
            .collect();
        let obstacles = drawn
            .into_iter()
            .enumerate()
            .map(|(k, p)| p.filter(|p| explain_defects(c, p, &format!("obstacle.{k}"))))
            .collect();
        let root = match &c.root {
            Some(Some(root)) => {
                let p = Polygon::new(root.vertices.clone(), Vec::new());
                Some(p).filter(|p| explain_defects(c, p, "root"))
            }
            _ => None,
        };
        let drawn: Vec<Option<Polygon>> = c
            .pawls
            .iter()
            .map(|p| {
                p.as_ref()
                    .map(|p| Polygon::new(p.vertices.clone(), Vec::new()))
            })
            .collect();
        let pawls = drawn
            .into_iter()
            .enumerate()
            .map(|(k, p)| p.filter(|p| explain_defects(c, p, &format!("pawl.{k}"))))
            .collect();
        Bodies {
            obstacles,
            root,
            pawls,
        }
    }
}

/// Notes every defect of a polygon at its place in the file; whether there is none.
pub(crate) fn explain_defects(c: &mut Conversion<'_>, polygon: &Polygon, table: &str) -> bool {
    let found = defects(polygon);
    let rings = RingPlaces {
        table: c.tree.find(table).unwrap_or(c.tree),
    };
    for defect in &found {
        let (span, code, message, help) = explain(defect, &rings);
        c.error(span, code, message, help);
    }
    found.is_empty()
}

/// Finds the rings of one body in the tree.
struct RingPlaces<'a> {
    table: &'a Node,
}

impl RingPlaces<'_> {
    fn ring(&self, ring: usize) -> &Node {
        let node = match ring {
            0 => self.table.get("vertices"),
            hole => self
                .table
                .get("holes")
                .and_then(|holes| holes.find(&(hole - 1).to_string())),
        };
        node.unwrap_or(self.table)
    }

    fn vertex(&self, ring: usize, k: usize) -> Span {
        match &self.ring(ring).kind {
            Kind::Array(items) if !items.is_empty() => items[k % items.len()].span,
            _ => self.ring(ring).span,
        }
    }

    /// The vertices that an edge joins, in words.
    fn edge(&self, e: EdgeRef) -> String {
        let count = match &self.ring(e.ring).kind {
            Kind::Array(items) => items.len().max(1),
            _ => 1,
        };
        let ring = match e.ring {
            0 => String::new(),
            hole => format!(" of hole {}", hole - 1),
        };
        format!(
            "edge {}{ring} (vertex {} to {})",
            e.edge,
            e.edge,
            (e.edge + 1) % count
        )
    }
}

/// A ring in words.
fn ring_name(ring: usize) -> String {
    match ring {
        0 => "the polygon".to_owned(),
        hole => format!("hole {}", hole - 1),
    }
}

fn explain(defect: &Defect, rings: &RingPlaces<'_>) -> (Span, &'static str, String, String) {
    match defect {
        Defect::TooFewVertices { ring, count } => (
            rings.ring(*ring).span,
            "too-few-vertices",
            format!("{} has {count} vertices", ring_name(*ring)),
            "a polygon needs at least three; it is closed implicitly".to_owned(),
        ),
        Defect::ZeroArea { ring } => (
            rings.ring(*ring).span,
            "zero-area",
            format!("the vertices of {} lie on one line", ring_name(*ring)),
            "a body needs an inside".to_owned(),
        ),
        Defect::ZeroLengthEdge(e) => (
            rings.vertex(e.ring, e.edge + 1),
            "zero-length-edge",
            format!("{} has no length", rings.edge(*e)),
            "remove the repeated vertex; the last edge closes the polygon by itself".to_owned(),
        ),
        Defect::Spike { ring, vertex } => (
            rings.vertex(*ring, *vertex),
            "spike",
            format!(
                "at vertex {vertex} the boundary of {} turns back on itself",
                ring_name(*ring)
            ),
            "remove the vertex".to_owned(),
        ),
        Defect::EdgesMeet { first, second, how } => {
            let (verb, at) = match &**how {
                Meeting::Cross(p) => ("crosses", format!(" at {}", show(p))),
                Meeting::Touch(p) => ("touches", format!(" at {}", show(p))),
                Meeting::Overlap(p, q) => ("overlaps", format!(" from {} to {}", show(p), show(q))),
                Meeting::Apart => ("meets", String::new()),
            };
            (
                rings.vertex(first.ring, first.edge),
                "edges-meet",
                format!("{} {verb} {}{at}", rings.edge(*first), rings.edge(*second)),
                "the boundary of a body meets itself nowhere; list the vertices in order round it"
                    .to_owned(),
            )
        }
        Defect::HoleOutside { hole } => (
            rings.ring(hole + 1).span,
            "hole-outside",
            format!("hole {hole} is not inside the obstacle"),
            "a hole lies within the outer polygon; a notch belongs to the outer polygon itself"
                .to_owned(),
        ),
        Defect::HolesOverlap { first, second } => (
            rings.ring(second + 1).span,
            "holes-overlap",
            format!("hole {second} overlaps hole {first}"),
            "unite the two; a body inside a hole is an obstacle of its own".to_owned(),
        ),
    }
}

/// A point for a message: exact where that is short.
fn show(p: &Vec2) -> String {
    let number = |r: &Rat| {
        let exact = r.to_string();
        match r.nearest_f64() {
            Some(near) if exact.len() > 24 => format!("≈{near}"),
            _ => clip(&exact),
        }
    };
    format!("({}, {})", number(&p.x), number(&p.y))
}

fn pawls(c: &mut Conversion<'_>) {
    for k in 0..c.pawls.len() {
        let Some(pawl) = c.pawls[k].clone() else {
            continue;
        };
        if pawl.stiffness.as_ref().is_some_and(|s| s.sign() <= 0) {
            c.error(
                place(c, "pawl", k, "stiffness"),
                "stiffness-not-positive",
                "the stiffness is not positive",
                "a spring drives the pawl to rest; leave the stiffness out to model no forces",
            );
        }
        limits(c, k, &pawl);
    }
}

fn limits(c: &mut Conversion<'_>, k: usize, pawl: &Pawl) {
    let Some((lo, hi)) = &pawl.limits else {
        return;
    };
    if lo >= hi {
        c.error(
            place(c, "pawl", k, "limits"),
            "limits-order",
            "the lower limit is not below the upper one",
            "write limits = [\"lo\", \"hi\"], each tan(θ/2), counter-clockwise positive",
        );
    } else if pawl.start < *lo || pawl.start > *hi {
        c.error(
            place(c, "pawl", k, "start"),
            "start-outside-limits",
            "the pawl starts outside its limits",
            "start, lo and hi are all tan(θ/2); without a start the pawl begins as near to 0 as its limits allow",
        );
    }
}

fn motions(c: &mut Conversion<'_>) {
    let has_root = c.root.is_some();
    for k in 0..c.motions.len() {
        match c.motions[k].clone() {
            None => {}
            Some(Motion::Reverse) if k == 0 => c.error(
                place(c, "motion", k, "reverse"),
                "reverse-first",
                "the plan begins with a reverse",
                "a reverse goes back along the phase before it; put a motion with a velocity first",
            ),
            Some(Motion::Reverse) => {}
            Some(Motion::Translate {
                velocity,
                duration,
                until_root_collision,
            }) => {
                if velocity.is_zero() {
                    c.error(
                        place(c, "motion", k, "velocity"),
                        "zero-velocity",
                        "the velocity is zero",
                        "every phase moves; remove the phase",
                    );
                }
                if duration.as_ref().is_some_and(|d| d.sign() <= 0) {
                    c.error(
                        place(c, "motion", k, "duration"),
                        "duration-not-positive",
                        "the duration is not positive",
                        "turn the velocity round to move the other way",
                    );
                }
                // A key that is there but could not be read has its own message.
                let table = c.tree.find(&format!("motion.{k}")).unwrap_or(c.tree);
                let ends = ["duration", "until"];
                if !ends
                    .iter()
                    .any(|key| table.get(key).is_some() || misspelt(table, key))
                {
                    c.error(
                        table.span,
                        "endless-motion",
                        "the motion never ends",
                        "add duration = \"…\", or until = \"root-collision\", or both",
                    );
                }
                if until_root_collision && !has_root && c.tree.get("root").is_none() {
                    c.error(
                        place(c, "motion", k, "until"),
                        "until-without-root",
                        "the scene has no root that could collide",
                        "add a [root] with vertices, or give a duration instead",
                    );
                }
            }
        }
    }
}

fn classify(c: &mut Conversion<'_>) {
    let Some(asked) = c.classify.clone() else {
        return;
    };
    let span = |c: &Conversion<'_>, path: &str| c.tree.find(path).unwrap_or(c.tree).span;
    // Only a list that was read whole has the indices of the file.
    for (k, direction) in asked.directions.iter().enumerate() {
        if direction.is_zero() {
            c.error(
                span(c, &format!("classify.directions.{k}")),
                "zero-direction",
                "a direction has no length",
                "write the direction in which to escape",
            );
        }
    }
    if asked.force_limit.as_ref().is_some_and(|f| f.sign() < 0) {
        c.error(
            span(c, "classify.force_limit"),
            "limit-not-positive",
            "the force limit is negative",
            "it bounds the modulus of the force",
        );
    }
    if asked
        .escape_distance
        .as_ref()
        .is_some_and(|d| d.sign() <= 0)
    {
        c.error(
            span(c, "classify.escape_distance"),
            "limit-not-positive",
            "the escape distance is not positive",
            "leave it out to escape past the scene's bounding box",
        );
    }
}

/// No pawl and no root may start inside an obstacle; to touch is allowed.
fn starts(c: &mut Conversion<'_>, bodies: &Bodies) {
    let mut met: Vec<(Span, String, Vec<usize>)> = Vec::new();
    let inside = |body: &Polygon| -> Vec<usize> {
        let obstacles = bodies.obstacles.iter().enumerate();
        obstacles
            .filter(|(_, o)| o.as_ref().is_some_and(|o| interiors_intersect(body, o)))
            .map(|(k, _)| k)
            .collect()
    };
    if let Some(root) = &bodies.root {
        let span = c.tree.find("root.vertices").unwrap_or(c.tree).span;
        met.push((span, "the root".to_owned(), inside(root)));
    }
    for (k, body) in bodies.pawls.iter().enumerate() {
        if let (Some(body), Some(pawl)) = (body, &c.pawls[k]) {
            let turned = if pawl.start.is_zero() {
                inside(body)
            } else {
                inside(&body.rotated(&pawl.hinge, &pawl.start))
            };
            // The culprit is whatever put the pawl there.
            let table = c.tree.find(&format!("pawl.{k}"));
            let key = ["start", "limits", "vertices"]
                .into_iter()
                .filter(|key| !pawl.start.is_zero() || *key == "vertices")
                .find_map(|key| table?.get(key));
            let span = key.or(table).unwrap_or(c.tree).span;
            met.push((span, format!("pawl `{}`", clip(&pawl.name)), turned));
        }
    }
    for (span, who, obstacles) in met {
        if obstacles.is_empty() {
            continue;
        }
        let names: Vec<String> = obstacles
            .iter()
            .filter_map(|&k| c.obstacles[k].as_ref())
            .map(|o| format!("`{}`", clip(&o.name)))
            .collect();
        c.error(
            span,
            "start-penetrates",
            format!("{who} starts inside obstacle {}", names.join(" and ")),
            "at time 0 bodies may touch, but their interiors may not meet",
        );
    }
}
