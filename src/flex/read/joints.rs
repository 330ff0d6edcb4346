//! Who constrains whom: the tables of joints and of views.

use super::{Names, named, whole_number};
use crate::flex::types::{Body, Contact, Joint, View};
use crate::scene::{Conversion, Kind, Node, clip};

pub(super) fn joints(c: &mut Conversion<'_>, bodies: &[Body], names: &Names) -> Option<Vec<Joint>> {
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

pub(super) fn views(c: &mut Conversion<'_>, names: &Names) -> Vec<View> {
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
