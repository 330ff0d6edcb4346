//! What is asked, and how steps are taken: the tables of the objective and of the step.

use super::{MAX_STEPS, Names, named, positive, whole_number};
use crate::flex::types::{Body, Hold, Path, StepRules, Term};
use crate::number::Rat;
use crate::scene::{Conversion, Kind, Node, clip};

pub(super) fn objective<'a>(
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

pub(super) fn rules<'a>(c: &mut Conversion<'a>, node: &'a Node, step: &mut StepRules) {
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
