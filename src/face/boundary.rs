//! The boundary of a face as something to walk on, and faces that are glued along a cut.
//!
//! The idea: a cylinder that is cut open is a strip of the plane, and its two cut lines are pairs of
//! verticals that are one. The face of the start is traced in the strip; wherever it borders a stretch of the
//! cut, the face beyond the partner stretch belongs to it too, so that one is traced from there, until no
//! stretch is left. Then the islands are looked for once, in all of these faces. Each side of an
//! edge is walked once whatever the order, and the index over the arcs is made once.
//!
//! What comes out names each edge's arc, the ends of its stretch, the sides on which the face lies, the
//! half-edges in the order of the walk, and all arcs through each vertex, those hidden behind others too.

use super::cylinder;
use super::kernel::{CurveId, Kernel, NumId};
use super::merge::arcs_alone;
use super::read::{SourceArc, Upright};
use super::run::{FaceError, Method, graph, upright};
use super::trace::{Carrier, Item, OnArc, Point, Tracer};
use crate::number::Rat;

/// Two verticals that are the two sides of one stretch of a cut: the one on the left border of the strip
/// and the one on its right border, by their numbers among the uprights. Nothing but ends of arcs may
/// lie on them.
pub(crate) type Glue = (usize, usize);

/// An edge of the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundaryEdge {
    /// The arc that it is part of: graphs first, then uprights. Of arcs that overlap, the first.
    pub(crate) item: u32,
    /// Its left (or lower) and right (or upper) end, as vertices.
    pub(crate) ends: [u32; 2],
    /// Whether the face lies above (left of the way from the first end to the second) and below.
    pub(crate) sides: [bool; 2],
}

/// The boundary of a face, or of several that are glued.
pub(crate) struct Boundary {
    /// Whatever is to be known of the numbers and curves.
    pub(crate) kernel: Kernel,
    /// For each vertex its number and a curve over it.
    pub(crate) vertices: Vec<(NumId, CurveId)>,
    /// For each vertex the arcs through it: `links[starts[v]..starts[v + 1]]`.
    pub(crate) links: Vec<u32>,
    pub(crate) link_starts: Vec<u32>,
    pub(crate) edges: Vec<BoundaryEdge>,
    /// The curve of each arc; none for uprights.
    pub(crate) curves: Vec<Option<CurveId>>,
    /// Half-edges cycle by cycle, as walked with the face on the left: twice the edge, one more if it
    /// goes from the second end to the first.
    pub(crate) order: Vec<u32>,
    /// Where each cycle begins in `order`, and where the last one ends.
    pub(crate) cycles: Vec<u32>,
}

/// A strip: what bounds faces on a cylinder that is cut open.
pub(crate) struct Strip<'a> {
    /// The graphs of arcs, then the strip's lower border and its upper one. Dropped once read: they are a tenth
    /// of all that a large slice needs.
    pub(crate) graphs: Vec<SourceArc>,
    /// The uprights of arcs, then those of the cut.
    pub(crate) uprights: &'a [Upright],
    /// The stretches of the cut, left and right in turn.
    pub(crate) glue: &'a [Glue],
    /// For each upright of an arc whether it is the other side of the one before it, a level on the cut.
    pub(crate) second: &'a [bool],
    /// For each graph, then each upright, names of its ends: equal ones over one number are one point. May be
    /// shorter.
    pub(crate) names: &'a [[u64; 2]],
}

/// How a face is to be found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    pub(crate) method: Method,
    /// How many pairs an automatic walk may test.
    pub(crate) patience: u64,
    /// How many arcs a leaf of the merge tree takes.
    pub(crate) leaf: usize,
}

/// How a face was found.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Found {
    /// Walk or merge.
    pub method: Method,
    /// How many merges were made.
    pub merges: u64,
}

/// The boundary of the face that holds the start, with all that is glued to it, by the way that is asked for.
///
/// The walk: O(n log n) for the index, then in proportion to what it meets. The merge: see `cylinder.rs`.
pub(crate) fn boundary(
    mut strip: Strip<'_>,
    start: &(Rat, Rat),
    way: Way,
) -> Result<(Boundary, Found), FaceError> {
    let bad = |i: usize| move |why| FaceError::BadArc(i, 0, why);
    let on = |OnArc(i)| FaceError::StartOnArc(i as usize, 0);
    let sources = std::mem::take(&mut strip.graphs);
    let graphs = sources.len();
    let mut k = Kernel::default();
    let mut items = Vec::with_capacity(graphs + strip.uprights.len());
    for (i, arc) in sources.iter().enumerate() {
        items.push(graph(&mut k, arc, i).map_err(bad(i))?);
    }
    drop(sources);
    for (i, arc) in strip.uprights.iter().enumerate() {
        let i = graphs + i;
        items.push(upright(&mut k, arc, i).map_err(bad(i))?);
    }
    for (item, names) in items.iter().zip(strip.names) {
        k.name_ends(item, *names);
    }
    let z = Point {
        x: k.rational(&start.0),
        c: k.constant(&start.1),
    };
    if way.method != Method::Merge {
        let budget = match way.method {
            Method::Auto => way.patience,
            _ => u64::MAX,
        };
        let walked = walked(k, &items, &strip, z, budget).map_err(on)?;
        match walked {
            Ok(b) => {
                let method = Method::Walk;
                return Ok((b, Found { method, merges: 0 }));
            }
            Err(given_up) => k = given_up,
        }
    }
    let mut merges = 0;
    let cut = [0, 1].map(|i| items[items.len() - 2 + i].l);
    let framed = cylinder::Strip {
        items: &items,
        graphs: graphs - 2,
        uprights: strip.second.len(),
        second: strip.second,
        cut,
    };
    let b = cylinder::conquered(k, &framed, strip.glue, z, way.leaf, &mut merges).map_err(on)?;
    let method = Method::Merge;
    Ok((b, Found { method, merges }))
}

/// The boundary by walking; the kernel alone where that took more than `budget` tests.
fn walked(
    mut k: Kernel,
    items: &[Item],
    strip: &Strip<'_>,
    start: Point,
    budget: u64,
) -> Result<Result<Boundary, Kernel>, OnArc> {
    let first = items.len() - strip.uprights.len();
    let curves = items
        .iter()
        .map(|i| match i.carrier {
            Carrier::Graph(c) => Some(c),
            Carrier::Vertical(..) => None,
        })
        .collect();
    let (mut items, comps, ends) = arcs_alone(items);
    let mut t = Tracer::new(&mut k, &mut items, &comps, ends.into_iter());
    t.budget = budget;
    t.outline(start)?;
    let mut partner = vec![None; strip.uprights.len()];
    for &(left, right) in strip.glue {
        // Beyond the left border the strip goes on to the left of its right border, and vice versa.
        partner[left] = Some((first + right, true));
        partner[right] = Some((first + left, false));
    }
    let mut at = 0;
    while at < t.edges.len() && t.tests <= t.budget {
        let item = t.edges[at].item as usize;
        if let Some(Some((other, up))) = item.checked_sub(first).map(|i| partner[i]) {
            t.border(other as u32, up);
        }
        at += 1;
    }
    t.islands();
    if t.tests > t.budget {
        drop(t);
        return Ok(Err(k));
    }
    let mut number = vec![u32::MAX; t.vertices.len()];
    let mut vertices = Vec::new();
    let (mut links, mut link_starts) = (Vec::new(), vec![0]);
    let mut edges = Vec::with_capacity(t.edges.len());
    for e in &t.edges {
        let ends = [e.low, e.high].map(|v| {
            let id = &mut number[v as usize];
            if *id == u32::MAX {
                *id = vertices.len() as u32;
                let at = t.vertices[v as usize].at;
                vertices.push((at.x, at.c));
                t.each_link(v, |item| links.push(item));
                link_starts.push(links.len() as u32);
            }
            *id
        });
        edges.push(BoundaryEdge {
            item: e.item,
            ends,
            sides: [e.above, e.below],
        });
    }
    let order = std::mem::take(&mut t.order);
    let mut cycles = vec![0];
    let mut sum = 0;
    for c in &t.cycles {
        sum += c.half_edges;
        cycles.push(sum);
    }
    Ok(Ok(Boundary {
        kernel: k,
        vertices,
        links,
        link_starts,
        edges,
        curves,
        order,
        cycles,
    }))
}
