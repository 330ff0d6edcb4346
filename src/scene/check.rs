//! `check`: what a scene consists of, what would be modelled, and what is left out and why.

use super::diagnostic::Diagnostic;
use super::read::SceneFile;
use super::types::{Motion, Scene};
use crate::geometry::{Corner, Polygon, interiors_intersect};
use serde::Serialize;
use std::fmt;

/// What [`check`] finds, for people (by `Display`) and for programs (by `Serialize`).
#[derive(Clone, Debug, Serialize)]
pub struct CheckReport {
    /// The schema of this report.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// How many obstacles there are.
    pub obstacles: usize,
    /// Edges of all obstacles, holes included; as many as vertices.
    pub obstacle_edges: usize,
    /// Vertices of obstacles at which a pawl's edge can strike.
    pub obstacle_convex_vertices: usize,
    /// Each pawl with its counts.
    pub pawls: Vec<PawlReport>,
    /// Phases of the plan.
    pub phases: usize,
    /// Contact pairs before any culling, over all pawls and phases.
    pub contact_pairs: usize,
    /// What is modelled and what is not.
    pub features: Vec<Feature>,
    /// What is worth a look, each as `file:line:column: warning[code]: message`.
    pub warnings: Vec<String>,
}

/// The counts of one pawl.
#[derive(Clone, Debug, Serialize)]
pub struct PawlReport {
    /// Its name.
    pub name: String,
    /// Edges, as many as vertices.
    pub edges: usize,
    /// Vertices that can strike.
    pub convex_vertices: usize,
    /// Pairs of a convex pawl vertex and an obstacle edge.
    pub type_b_pairs: usize,
    /// Pairs of a pawl edge and a convex obstacle vertex.
    pub type_a_pairs: usize,
}

/// One part of the model.
#[derive(Clone, Debug, Serialize)]
pub struct Feature {
    /// Its name: friction, forces, root, limits, holes or classify.
    pub name: &'static str,
    /// Whether it is modelled.
    pub modelled: bool,
    /// Why, in terms of the file.
    pub reason: String,
}

/// Counts what a scene consists of and says what would be modelled. Besides the warnings of the
/// reader there are those on what is allowed but may be a slip: straight vertices, and obstacles that overlap (one
/// [`interiors_intersect`] for every two obstacles whose boxes meet).
pub fn check(file: &SceneFile) -> CheckReport {
    let scene = file.scene();
    let obstacles: Vec<Polygon> = scene
        .obstacles
        .iter()
        .map(|o| Polygon::new(o.vertices.clone(), o.holes.clone()))
        .collect();
    let obstacle_edges = obstacles.iter().map(Polygon::len).sum();
    let obstacle_convex_vertices = obstacles.iter().map(convex_vertices).sum();
    let bodies: Vec<Polygon> = scene
        .pawls
        .iter()
        .map(|p| Polygon::new(p.vertices.clone(), Vec::new()))
        .collect();
    let pawls: Vec<PawlReport> = scene
        .pawls
        .iter()
        .zip(&bodies)
        .map(|(pawl, body)| {
            let convex = convex_vertices(body);
            PawlReport {
                name: pawl.name.clone(),
                edges: body.len(),
                convex_vertices: convex,
                type_b_pairs: convex * obstacle_edges,
                type_a_pairs: body.len() * obstacle_convex_vertices,
            }
        })
        .collect();
    let pairs: usize = pawls.iter().map(|p| p.type_a_pairs + p.type_b_pairs).sum();
    let mut warnings = file.warnings().to_vec();
    for (k, body) in obstacles.iter().enumerate() {
        warnings.extend(straight_vertices(file, body, &format!("obstacle.{k}")));
    }
    for (k, body) in bodies.iter().enumerate() {
        warnings.extend(straight_vertices(file, body, &format!("pawl.{k}")));
    }
    warnings.extend(overlapping_obstacles(file, &obstacles));
    warnings.extend(odd_forces(file));
    warnings.sort_by_key(Diagnostic::span);
    CheckReport {
        schema: "snapfit.check/1",
        scene: scene.name.clone(),
        obstacles: obstacles.len(),
        obstacle_edges,
        obstacle_convex_vertices,
        pawls,
        phases: scene.motions.len(),
        contact_pairs: pairs * scene.motions.len(),
        features: features(scene),
        warnings: warnings.iter().map(ToString::to_string).collect(),
    }
}

fn convex_vertices(polygon: &Polygon) -> usize {
    let rings = polygon.rings().iter().enumerate();
    rings
        .map(|(ring, vertices)| {
            (0..vertices.len())
                .filter(|&k| polygon.corner(ring, k) == Corner::Convex)
                .count()
        })
        .sum()
}

fn features(scene: &Scene) -> Vec<Feature> {
    let feature = |name, modelled, reason: String| Feature {
        name,
        modelled,
        reason,
    };
    let count = |n: usize, what: &str| format!("{n} of {} pawls {what}", scene.pawls.len());
    let springs = scene.pawls.iter().filter(|p| p.stiffness.is_some()).count();
    let stops = scene.pawls.iter().filter(|p| p.limits.is_some()).count();
    let holes: usize = scene.obstacles.iter().map(|o| o.holes.len()).sum();
    let until = scene.motions.iter().any(|m| {
        matches!(
            m,
            Motion::Translate {
                until_root_collision: true,
                ..
            }
        )
    });
    vec![
        match &scene.friction {
            Some(mu) => feature("friction", true, format!("μ = {mu}")),
            None => feature("friction", false, "[scene] has no `friction`".to_owned()),
        },
        feature("forces", springs > 0, count(springs, "have a `stiffness`")),
        match &scene.root {
            Some(_) if until => feature("root", true, "a phase ends where it collides".to_owned()),
            Some(_) => feature("root", true, "its collision ends the plan".to_owned()),
            None => feature("root", false, "there is no [root]".to_owned()),
        },
        feature("limits", stops > 0, count(stops, "have `limits`")),
        feature("holes", holes > 0, format!("{holes} in the obstacles")),
        match &scene.classify {
            Some(c) if c.total => feature("classify", true, "every direction".to_owned()),
            Some(_) => feature("classify", true, "the family of [classify]".to_owned()),
            None => feature(
                "classify",
                true,
                "there is no [classify]: the reverse of the plan's last phase".to_owned(),
            ),
        },
    ]
}

/// At most one warning a ring: for its first straight vertex.
fn straight_vertices(file: &SceneFile, body: &Polygon, table: &str) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (ring, vertices) in body.rings().iter().enumerate() {
        let mut straight =
            (0..vertices.len()).filter(|&k| body.corner(ring, k) == Corner::Straight);
        let Some(first) = straight.next() else {
            continue;
        };
        let list = match ring {
            0 => format!("{table}.vertices"),
            hole => format!("{table}.holes.{}", hole - 1),
        };
        let more = match straight.count() {
            0 => String::new(),
            n => format!(" (and {n} more)"),
        };
        found.push(
            file.warning_at(&format!("{list}.{first}"), "straight-vertex")
                .message(format!(
                    "vertex {first} lies in the middle of a straight edge{more}"
                ))
                .help("it changes nothing but the numbers of the edges"),
        );
    }
    found
}

fn overlapping_obstacles(file: &SceneFile, obstacles: &[Polygon]) -> Vec<Diagnostic> {
    let names = &file.scene().obstacles;
    let mut found = Vec::new();
    for (k, body) in obstacles.iter().enumerate() {
        let earlier = (0..k).find(|&j| interiors_intersect(&obstacles[j], body));
        if let Some(j) = earlier {
            found.push(
                file.warning_at(&format!("obstacle.{k}.vertices"), "obstacles-overlap")
                    .message(format!(
                        "obstacles `{}` and `{}` overlap",
                        names[j].name, names[k].name
                    ))
                    .help("that is allowed: together they are one body"),
            );
        }
    }
    found
}

fn odd_forces(file: &SceneFile) -> Vec<Diagnostic> {
    let scene = file.scene();
    let mut found = Vec::new();
    let springs = scene.pawls.iter().filter(|p| p.stiffness.is_some()).count();
    if springs > 0
        && let Some(without) = scene.pawls.iter().position(|p| p.stiffness.is_none())
    {
        found.push(
            file.warning_at(&format!("pawl.{without}"), "some-stiffness")
                .message(format!(
                    "pawl `{}` has no stiffness while others have one",
                    scene.pawls[without].name
                ))
                .help("forces on it are not modelled"),
        );
    }
    let limit = scene.classify.as_ref().and_then(|c| c.force_limit.as_ref());
    if limit.is_some() && springs == 0 {
        found.push(
            file.warning_at("classify.force_limit", "unused-force-limit")
                .message("a force limit is given, but no pawl has a stiffness")
                .help("give the pawls a stiffness to model forces"),
        );
    }
    found
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "scene {}", self.scene)?;
        writeln!(
            f,
            "  obstacles      {} with {} edges, {} convex vertices",
            self.obstacles, self.obstacle_edges, self.obstacle_convex_vertices
        )?;
        for pawl in &self.pawls {
            writeln!(
                f,
                "  pawl {:<9} {} edges, {} convex vertices; contact pairs: {} of type B, {} of type A",
                pawl.name, pawl.edges, pawl.convex_vertices, pawl.type_b_pairs, pawl.type_a_pairs
            )?;
        }
        writeln!(
            f,
            "  plan           {} phase{}, {} contact pairs before culling",
            self.phases,
            if self.phases == 1 { "" } else { "s" },
            self.contact_pairs
        )?;
        for feature in &self.features {
            let sign = if feature.modelled {
                "modelled"
            } else {
                "left out"
            };
            writeln!(f, "  {:<14} {sign}: {}", feature.name, feature.reason)?;
        }
        for warning in &self.warnings {
            writeln!(f, "{warning}")?;
        }
        Ok(())
    }
}
