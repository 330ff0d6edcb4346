//! The way in: a text becomes a [`Structure`], or the list of what is wrong, each with its place.
//!
//! The rooms are those of scenes (text to tree, tree to types, types to sense), and the first is
//! the very same: notation, numbers, overrides and diagnostics are `scene`'s. Here the file as a
//! whole and its bodies are read; `joints` reads who constrains whom, `asked` what is asked.

mod asked;
mod joints;

use super::types::{Body, Hold, StepRules, Structure};
use crate::geometry::{Polygon, Vec2, interiors_intersect};
use crate::number::Rat;
use crate::scene::{
    Conversion, Diagnostic, Kind, Node, Sources, Tables, clip, explain_defects, text_of, tree_of,
};
use std::collections::HashMap;

/// The tables of the format and their keys, for the reader and the schema's test. The table with
/// the empty name is the file itself.
pub(crate) const TABLES: Tables = &[
    (
        "",
        &["structure", "body", "joint", "view", "objective", "step"],
    ),
    ("structure", &["name", "epsilon", "nearest"]),
    ("joint", &["bodies", "first", "second"]),
    (
        "body",
        &["name", "vertices", "position", "tan_half", "fixed", "pin"],
    ),
    (
        "view",
        &["body", "camera", "left", "right", "far", "of", "marker"],
    ),
    ("objective", &["terms", "radial_from"]),
    (
        "term",
        &[
            "body",
            "vertex",
            "dx",
            "dy",
            "dtheta",
            "radial_from",
            "towards_x",
        ],
    ),
    (
        "step",
        &["violation", "path", "rotation_limit", "gain", "most"],
    ),
];

/// Most steps that a file may ask for.
pub const MAX_STEPS: usize = 10_000;

/// A structure as it was read: what it says, and where it says it.
#[derive(Clone, Debug)]
pub struct StructureFile {
    structure: Structure,
    tree: Node,
    sources: Sources,
    warnings: Vec<Diagnostic>,
}

impl StructureFile {
    /// What the file says.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// What the file says, without the rest.
    pub fn into_structure(self) -> Structure {
        self.structure
    }

    /// What is worth a look although the structure is sound.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// An error about the place of a dotted path, for what is found out only later. `code` must
    /// be one of [`crate::scene::CODES`].
    pub fn error_at(&self, path: &str, code: &'static str) -> Diagnostic {
        let mut node = &self.tree;
        for step in path.split('.') {
            match node.find(step) {
                Some(next) => node = next,
                None => break,
            }
        }
        Diagnostic::error(&self.sources, node.span, code)
    }
}

/// What a file looks like by its top-level keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guise {
    /// A scene of obstacles and pawls.
    Scene,
    /// A structure of loosely joined bodies.
    Structure,
    /// A result that this program wrote.
    Result,
}

/// What a text looks like; None where it is none of them or cannot be read.
///
/// Cost: reads the text once.
pub fn guise(name: &str, bytes: &[u8]) -> Option<Guise> {
    let text = text_of("file", name, bytes).ok()?;
    let (tree, _) = tree_of("file", name, text, &[]).ok()?;
    let has = |keys: &[&str]| keys.iter().any(|k| tree.get(k).is_some());
    if has(&["schema"]) {
        Some(Guise::Result)
    } else if has(&["scene", "pawl", "obstacle"]) {
        Some(Guise::Scene)
    } else {
        has(&["structure", "body"]).then_some(Guise::Structure)
    }
}

/// Whether a text looks like a structure rather than a scene: by its top-level keys.
pub fn is_structure(name: &str, bytes: &[u8]) -> bool {
    guise(name, bytes) == Some(Guise::Structure)
}

/// Reads a structure from bytes. `name` is for messages, and its ending tells JSON from TOML;
/// `overrides` are dotted paths and values as for scenes.
///
/// # Errors
/// Everything that is wrong with it, in the order of the file.
///
/// Cost: near-linear in the text; bodies whose boxes meet cost one
/// [`crate::geometry::interiors_intersect`] each pair.
pub fn read_structure(
    name: &str,
    bytes: &[u8],
    overrides: &[(&str, &str)],
) -> Result<StructureFile, Vec<Diagnostic>> {
    let text = text_of("structure", name, bytes)?;
    let (tree, sources) = tree_of("structure", name, text, overrides)?;
    let mut c = Conversion::bare("structure", TABLES, &tree, &sources);
    let structure = convert(&mut c);
    if let Some(structure) = &structure
        && c.errors.is_empty()
    {
        starts(&mut c, structure);
    }
    let (structure, warnings) = c.settle(structure)?;
    Ok(StructureFile {
        structure,
        tree,
        sources,
        warnings,
    })
}

/// Names of bodies to indices.
type Names = HashMap<String, usize>;

fn convert<'a>(c: &mut Conversion<'a>) -> Option<Structure> {
    let tree = c.tree;
    if !c.table(tree, "") {
        return None;
    }
    let Some(head) = tree.get("structure") else {
        c.error(
            tree.span,
            "missing-key",
            "the section [structure] is missing",
            "begin the file with [structure], a name and an epsilon",
        );
        return None;
    };
    if !c.table(head, "structure") {
        return None;
    }
    let name = c.required(head, "name", Conversion::string);
    let epsilon = c.required(head, "epsilon", Conversion::number);
    if let Some(e) = &epsilon {
        positive(c, head, "epsilon", e, "epsilon-not-positive");
    }
    let bodies = c.list_of("body", "no-body", body);
    let whole: Option<Vec<Body>> = bodies.into_iter().collect();
    let mut names = Names::new();
    for (k, b) in whole.iter().flatten().enumerate() {
        if let Some(earlier) = names.insert(b.name.clone(), k) {
            let place = tree.find(&format!("body.{k}.name")).unwrap_or(tree).span;
            c.error(
                place,
                "duplicate-name",
                format!("body {earlier} has the name `{}` already", clip(&b.name)),
                "give each its own name",
            );
        }
        let table = format!("body.{k}");
        explain_defects(c, &Polygon::new(b.vertices.clone(), Vec::new()), &table);
    }
    let joints = whole.as_ref().and_then(|b| joints::joints(c, b, &names));
    let nearest = head.get("nearest").and_then(|n| whole_number(c, n));
    let views = if whole.is_some() && tree.get("view").is_some() {
        joints::views(c, &names)
    } else {
        Vec::new()
    };
    let objective = match (tree.get("objective"), &whole) {
        (Some(node), Some(bodies)) => asked::objective(c, node, bodies, &names),
        _ => Vec::new(),
    };
    let mut step = StepRules::for_epsilon(epsilon.as_ref().unwrap_or(&Rat::one()));
    if let Some(node) = tree.get("step") {
        asked::rules(c, node, &mut step);
    }
    Some(Structure {
        name: name?,
        epsilon: epsilon?,
        bodies: whole?,
        joints,
        nearest,
        views,
        objective,
        step,
    })
}

fn positive(c: &mut Conversion<'_>, table: &Node, key: &str, v: &Rat, code: &'static str) {
    if v.sign() <= 0 {
        let span = table.get(key).unwrap_or(table).span;
        c.error(
            span,
            code,
            format!("`{key}` is not positive"),
            "give a positive number",
        );
    }
}

fn body<'a>(c: &mut Conversion<'a>, node: &'a Node) -> Option<Body> {
    let name = c.required(node, "name", Conversion::string);
    let vertices = c.required(node, "vertices", Conversion::ring);
    let position = match node.get("position") {
        Some(p) => c.point(p),
        None => Some(Vec2::default()),
    };
    let tan_half = match node.get("tan_half") {
        Some(u) => c.number(u),
        None => Some(Rat::zero()),
    };
    let fixed = node
        .get("fixed")
        .and_then(|n| c.boolean(n))
        .unwrap_or(false);
    let pin = c.optional(node, "pin", Conversion::point);
    let hold = match pin {
        Some(_) if fixed => {
            let span = node.get("pin").unwrap_or(node).span;
            c.error(
                span,
                "fixed-and-pinned",
                "the body is fixed and pinned",
                "a fixed body does not turn: leave out one of the two",
            );
            Hold::Fixed
        }
        Some(point) => Hold::Pin(point),
        None if fixed => Hold::Fixed,
        None => Hold::Free,
    };
    Some(Body {
        name: name?,
        vertices: vertices?,
        position: position?,
        tan_half: tan_half?,
        hold,
    })
}

/// A non-negative integer that fits an index.
fn whole_number(c: &mut Conversion<'_>, node: &Node) -> Option<usize> {
    let text = match &node.kind {
        Kind::Number(s) | Kind::String(s) => s.as_str(),
        _ => "",
    };
    let value = text.parse::<u32>().ok();
    if value.is_none() {
        c.wrong_type(node, "a whole number", "count from 0");
    }
    value.map(|v| v as usize)
}

/// The body of a name.
fn named(c: &mut Conversion<'_>, node: &Node, names: &Names) -> Option<usize> {
    let Kind::String(name) = &node.kind else {
        c.wrong_type(node, "the name of a body", "put it in double quotes");
        return None;
    };
    let found = names.get(name).copied();
    if found.is_none() {
        c.error(
            node.span,
            "unknown-body",
            format!("no body is called `{}`", clip(name)),
            "names are those of [[body]]",
        );
    }
    found
}

/// Bodies may touch, but their interiors may not meet.
fn starts(c: &mut Conversion<'_>, structure: &Structure) {
    let placed = super::shape::placed(structure);
    let boxes: Vec<_> = placed.iter().map(|p| *p.bounds()).collect();
    for (a, b) in super::pairs::meeting(&boxes, 0.0) {
        if interiors_intersect(&placed[a], &placed[b]) {
            let span = c.tree.find(&format!("body.{b}")).unwrap_or(c.tree).span;
            c.error(
                span,
                "bodies-penetrate",
                format!(
                    "bodies `{}` and `{}` overlap",
                    clip(&structure.bodies[a].name),
                    clip(&structure.bodies[b].name)
                ),
                "at the start bodies may touch, but their interiors may not meet",
            );
        }
    }
}
