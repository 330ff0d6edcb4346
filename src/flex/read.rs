//! The way in: a text becomes a [`Structure`], or the list of what is wrong, each with its place.
//!
//! The rooms are those of scenes (text to tree, tree to types, types to sense), and the first is
//! the very same: notation, numbers, overrides and diagnostics are `scene`'s.

use super::types::{Body, Contact, Hold, Joint, Path, StepRules, Structure, Term, View};
use crate::geometry::{Polygon, Vec2, interiors_intersect};
use crate::number::Rat;
use crate::scene::{
    Conversion, Diagnostic, Kind, MAX_FILE_BYTES, Node, Notation, Source, Sources, Span, Tables,
    apply_overrides_at, clip, explain_defects, read_tree,
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
    let text = std::str::from_utf8(bytes).ok()?;
    if bytes.len() > MAX_FILE_BYTES {
        return None;
    }
    let mut sources = Sources::new();
    let index = sources.add(Source::new(name, text));
    let tree = read_tree(&sources, index, Notation::of(name, text)).ok()?;
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
    let mut sources = Sources::new();
    if bytes.len() > MAX_FILE_BYTES {
        sources.add(Source::new(name, ""));
        return Err(vec![
            Diagnostic::error(&sources, Span::default(), "too-large")
                .message(format!(
                    "the file has {} bytes, more than the {MAX_FILE_BYTES} that are read",
                    bytes.len()
                ))
                .help("split the structure"),
        ]);
    }
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
            let index = sources.add(Source::new(name, &good));
            let end = sources.get(index).text().len();
            let span = Span {
                source: index,
                start: end,
                end,
            };
            return Err(vec![
                Diagnostic::error(&sources, span, "not-utf8")
                    .message("the text here is not UTF-8")
                    .help("save the file as UTF-8"),
            ]);
        }
    };
    let index = sources.add(Source::new(name, text));
    let mut tree = read_tree(&sources, index, Notation::of(name, text))?;
    apply_overrides_at(&mut tree, &mut sources, overrides)?;
    let mut c = Conversion::bare("structure", TABLES, &tree, &sources);
    let structure = convert(&mut c);
    if let Some(structure) = &structure
        && c.errors.is_empty()
    {
        starts(&mut c, structure);
    }
    let (mut errors, mut warnings) = (c.errors, c.warnings);
    errors.sort_by_key(Diagnostic::span);
    warnings.sort_by_key(Diagnostic::span);
    match structure {
        Some(structure) if errors.is_empty() => Ok(StructureFile {
            structure,
            tree,
            sources,
            warnings,
        }),
        _ => Err(errors),
    }
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
    let joints = whole.as_ref().and_then(|b| joints(c, b, &names));
    let nearest = head.get("nearest").and_then(|n| whole_number(c, n));
    let views = if whole.is_some() && tree.get("view").is_some() {
        views(c, &names)
    } else {
        Vec::new()
    };
    let objective = match (tree.get("objective"), &whole) {
        (Some(node), Some(bodies)) => objective(c, node, bodies, &names),
        _ => Vec::new(),
    };
    let mut step = StepRules::for_epsilon(epsilon.as_ref().unwrap_or(&Rat::one()));
    if let Some(node) = tree.get("step") {
        rules(c, node, &mut step);
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

fn joints(c: &mut Conversion<'_>, bodies: &[Body], names: &Names) -> Option<Vec<Joint>> {
    let node = c.tree.get("joint")?;
    let Kind::Array(items) = &node.kind else {
        c.wrong_type(node, "a list of tables", "in TOML write [[joint]]");
        return None;
    };
    let mut out = Vec::new();
    for item in items {
        if !c.table(item, "joint") {
            continue;
        }
        let Some(list) = item.get("bodies") else {
            c.error(
                item.span,
                "missing-key",
                "`bodies` is missing",
                "add bodies = [[\"a\", \"b\"]]",
            );
            continue;
        };
        let pairs = pairs(c, list, names);
        let named = item.get("first").is_some() || item.get("second").is_some();
        let mut contacts = Vec::new();
        for (key, edge_of_first) in [("first", true), ("second", false)] {
            let Some(list) = item.get(key) else {
                continue;
            };
            let Kind::Array(entries) = &list.kind else {
                c.wrong_type(list, "a list of pairs", "write [[edge, vertex]]");
                continue;
            };
            for entry in entries {
                let Kind::Array(two) = &entry.kind else {
                    c.wrong_type(entry, "an edge and a vertex", "write [edge, vertex]");
                    continue;
                };
                let [edge, vertex] = two.as_slice() else {
                    c.wrong_type(entry, "an edge and a vertex", "write [edge, vertex]");
                    continue;
                };
                let (Some(e), Some(v)) = (whole_number(c, edge), whole_number(c, vertex)) else {
                    continue;
                };
                let bad = pairs.iter().find(|&&(a, b)| {
                    let (of_edge, of_vertex) = if edge_of_first { (a, b) } else { (b, a) };
                    e >= bodies[of_edge].vertices.len() || v >= bodies[of_vertex].vertices.len()
                });
                if let Some(&(a, b)) = bad {
                    c.error(
                        entry.span,
                        "unknown-vertex",
                        format!(
                            "bodies `{}` and `{}` have no such edge and vertex",
                            clip(&bodies[a].name),
                            clip(&bodies[b].name)
                        ),
                        "both count from 0; `first` takes edges of the first body",
                    );
                    continue;
                }
                contacts.push(Contact {
                    edge_of_first,
                    edge: e,
                    vertex: v,
                });
            }
        }
        out.push(Joint {
            bodies: pairs,
            contacts: named.then_some(contacts),
        });
    }
    Some(out)
}

fn pairs(c: &mut Conversion<'_>, list: &Node, names: &Names) -> Vec<(usize, usize)> {
    let Kind::Array(items) = &list.kind else {
        c.wrong_type(list, "a list of pairs of names", "write [[\"a\", \"b\"]]");
        return Vec::new();
    };
    let mut out = Vec::with_capacity(items.len());
    for item in items {
        match &item.kind {
            Kind::Array(pair) if pair.len() == 2 => {
                let (a, b) = (named(c, &pair[0], names), named(c, &pair[1], names));
                match (a, b) {
                    (Some(a), Some(b)) if a == b => c.error(
                        item.span,
                        "joint-with-itself",
                        "a body is joined to itself",
                        "name two bodies",
                    ),
                    (Some(a), Some(b)) => out.push((a, b)),
                    _ => {}
                }
            }
            _ => c.wrong_type(item, "two names of bodies", "write [\"a\", \"b\"]"),
        }
    }
    out
}

fn views(c: &mut Conversion<'_>, names: &Names) -> Vec<View> {
    let tree = c.tree;
    let Some(Kind::Array(items)) = tree.get("view").map(|n| &n.kind) else {
        let node = tree.get("view").unwrap_or(tree);
        c.wrong_type(node, "a list of tables", "in TOML write [[view]]");
        return Vec::new();
    };
    let mut out = Vec::new();
    for item in items {
        if !c.table(item, "view") {
            continue;
        }
        let who = |c: &mut Conversion<'_>, key: &'static str| match item.get(key) {
            Some(node) => named(c, node, names),
            None => {
                c.error(
                    item.span,
                    "missing-key",
                    format!("`{key}` is missing"),
                    "name a body",
                );
                None
            }
        };
        let (body, of) = (who(c, "body"), who(c, "of"));
        let camera = c.required(item, "camera", Conversion::point);
        let left = c.required(item, "left", Conversion::point);
        let right = c.required(item, "right", Conversion::point);
        let far = c.optional(item, "far", Conversion::point);
        let marker = c.required(item, "marker", Conversion::point);
        if far.is_some() && far == camera {
            c.error(
                item.get("far").unwrap_or(item).span,
                "view-cone",
                "`far` is the camera itself",
                "give a point ahead of the camera",
            );
        }
        if let (Some(l), Some(r)) = (&left, &right)
            && r.cross(l).sign() <= 0
        {
            c.error(
                item.get("left").unwrap_or(item).span,
                "view-cone",
                "the cone from `right` counter-clockwise to `left` is no cone of less than half a turn",
                "swap the two directions, or narrow the cone",
            );
        }
        if body.is_some() && body == of {
            c.error(
                item.span,
                "joint-with-itself",
                "a body views itself",
                "name two bodies",
            );
        }
        if let (Some(body), Some(of), Some(camera), Some(left), Some(right), Some(marker)) =
            (body, of, camera, left, right, marker)
        {
            out.push(View {
                body,
                camera,
                left,
                right,
                far,
                of,
                marker,
            });
        }
    }
    out
}

fn objective<'a>(
    c: &mut Conversion<'a>,
    node: &'a Node,
    bodies: &[Body],
    names: &Names,
) -> Vec<Term> {
    if !c.table(node, "objective") {
        return Vec::new();
    }
    let mut out = Vec::new();
    if let Some(from) = c.optional(node, "radial_from", Conversion::point) {
        out.push(Term::Radial { body: None, from });
    }
    match node.get("terms").map(|n| (&n.kind, n)) {
        Some((Kind::Array(items), _)) => {
            out.extend(items.iter().filter_map(|item| term(c, item, bodies, names)));
        }
        Some((_, other)) => {
            c.wrong_type(
                other,
                "a list of terms",
                "write terms = [ { body = \"…\", dy = \"1\" } ]",
            );
        }
        None if out.is_empty() => {
            let _: Option<()> = c.required(node, "terms", |_, _| None);
        }
        None => {}
    }
    out
}

fn term<'a>(
    c: &mut Conversion<'a>,
    node: &'a Node,
    bodies: &[Body],
    names: &Names,
) -> Option<Term> {
    if !c.table(node, "term") {
        return None;
    }
    let body = node.get("body").map(|n| named(c, n, names));
    if body == Some(None) {
        return None;
    }
    let body = body.flatten();
    let weight = |c: &mut Conversion<'a>, key: &str| match node.get(key) {
        Some(n) => c.number(n),
        None => Some(Rat::zero()),
    };
    let mixed = |c: &mut Conversion<'a>, message: &str| {
        c.error(
            node.span,
            "mixed-term",
            message,
            "a term is { body, dx, dy, dtheta }, { body, vertex, dx, dy }, { body, towards_x } or { radial_from }",
        );
        None
    };
    if let Some(from) = node.get("radial_from") {
        if ["vertex", "dx", "dy", "dtheta", "towards_x"]
            .iter()
            .any(|k| node.get(k).is_some())
        {
            return mixed(c, "`radial_from` stands beside weights");
        }
        return c.point(from).map(|from| Term::Radial { body, from });
    }
    if let Some(line) = node.get("towards_x") {
        if ["vertex", "dx", "dy", "dtheta"]
            .iter()
            .any(|k| node.get(k).is_some())
        {
            return mixed(c, "`towards_x` stands beside weights");
        }
        let Some(body) = body else {
            return mixed(c, "the term names no body");
        };
        if matches!(bodies[body].hold, Hold::Pin(_)) {
            return mixed(c, "a pinned body does not move towards a line");
        }
        return c.number(line).map(|x| Term::Towards { body, x });
    }
    let (dx, dy, dtheta) = (weight(c, "dx"), weight(c, "dy"), weight(c, "dtheta"));
    let (dx, dy, dtheta) = (dx?, dy?, dtheta?);
    let Some(body) = body else {
        return mixed(c, "the term names no body");
    };
    if dx.is_zero() && dy.is_zero() && dtheta.is_zero() {
        c.error(
            node.span,
            "empty-term",
            "all weights of the term are zero",
            "give dx, dy or dtheta",
        );
        return None;
    }
    let Some(vertex) = node.get("vertex") else {
        return Some(Term::Body {
            body,
            dx,
            dy,
            dtheta,
        });
    };
    if node.get("dtheta").is_some() {
        return mixed(c, "a vertex has no angle");
    }
    let k = whole_number(c, vertex)?;
    let count = bodies[body].vertices.len();
    if k >= count {
        c.error(
            vertex.span,
            "unknown-vertex",
            format!("body `{}` has {count} vertices", clip(&bodies[body].name)),
            "vertices count from 0",
        );
        return None;
    }
    Some(Term::Vertex {
        body,
        vertex: k,
        dx,
        dy,
    })
}

fn rules<'a>(c: &mut Conversion<'a>, node: &'a Node, step: &mut StepRules) {
    if !c.table(node, "step") {
        return;
    }
    let number = |c: &mut Conversion<'a>, key: &str| {
        let value = c.optional(node, key, Conversion::number)?;
        positive(c, node, key, &value, "step-not-positive");
        Some(value)
    };
    if let Some(v) = number(c, "violation") {
        step.violation = v;
    }
    if let Some(v) = number(c, "gain") {
        step.gain = v;
    }
    step.rotation_limit = number(c, "rotation_limit");
    if let Some(n) = node.get("most")
        && let Some(most) = whole_number(c, n)
    {
        if most == 0 || most > MAX_STEPS {
            c.error(
                n.span,
                "step-not-positive",
                format!("`most` is not from 1 to {MAX_STEPS}"),
                "it bounds the number of steps",
            );
        }
        step.most = most;
    }
    if let Some(n) = node.get("path")
        && let Some(word) = c.string(n)
    {
        match word.as_str() {
            "fast" => step.path = Path::Fast,
            "safe" => step.path = Path::Safe,
            other => c.error(
                n.span,
                "unknown-path",
                format!("there is no path `{}`", clip(other)),
                "choose \"fast\" or \"safe\"",
            ),
        }
    }
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
