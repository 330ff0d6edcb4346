//! What keeps a polygon from being a proper one: not a yes or no but the reasons, each with the
//! edges it is about, so that a message can point at them.

use super::overlap::{boundary_relation, interiors_intersect};
use super::predicates::orient_pins;
use super::segment::{Meeting, meet_pins};
use super::{Box2, Polygon, Vec2};

/// Most defects that [`defects`] lists for one polygon; a thoroughly tangled ring has as many as
/// it has pairs of edges, and nobody reads those.
pub const MAX_DEFECTS: usize = 8;

/// An edge by its ring and its index in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeRef {
    /// 0 for the outer ring, h + 1 for hole h.
    pub ring: usize,
    /// The edge from vertex `edge` to the next one.
    pub edge: usize,
}

/// One reason why a polygon is not a proper one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Defect {
    /// Fewer than three vertices.
    TooFewVertices {
        /// The ring.
        ring: usize,
        /// How many there are.
        count: usize,
    },
    /// All vertices lie on one line.
    ZeroArea {
        /// The ring.
        ring: usize,
    },
    /// Two consecutive vertices coincide.
    ZeroLengthEdge(EdgeRef),
    /// The boundary turns back on itself: the edge that arrives at a vertex and the one that
    /// leaves it overlap.
    Spike {
        /// The ring.
        ring: usize,
        /// The vertex where it turns back.
        vertex: usize,
    },
    /// Two edges of one ring that do not follow each other share a point, or two edges of
    /// different rings cross or overlap.
    EdgesMeet {
        /// The edge that comes first in the listing.
        first: EdgeRef,
        /// The other one.
        second: EdgeRef,
        /// How they meet.
        how: Box<Meeting>,
    },
    /// A hole lies outside the outer ring, or reaches out of it through a vertex.
    HoleOutside {
        /// The hole.
        hole: usize,
    },
    /// Two holes overlap, or one lies within the other.
    HolesOverlap {
        /// The one that is listed first.
        first: usize,
        /// The other one.
        second: usize,
    },
}

/// Why the polygon is not a proper one: empty where every ring is simple, every hole lies inside
/// the outer ring, and holes are disjoint (rings may touch in single points). At most
/// [`MAX_DEFECTS`] reasons, in the order of the listing.
///
/// Edges are compared only where their boxes overlap along both axes, found by sorting along the
/// axis with less overlap: about n log n for drawn shapes, n² box comparisons at worst.
pub fn defects(polygon: &Polygon) -> Vec<Defect> {
    let mut found = Vec::new();
    for ring in 0..polygon.rings().len() {
        single_ring(polygon, ring, &mut found);
    }
    if found.is_empty() {
        found = edges_that_meet(polygon);
    }
    if found.is_empty() {
        found = misplaced_holes(polygon);
    }
    found.truncate(MAX_DEFECTS);
    found
}

/// What can be wrong between a vertex and its neighbours.
fn single_ring(polygon: &Polygon, ring: usize, found: &mut Vec<Defect>) {
    let vertices = &polygon.rings()[ring];
    let n = vertices.len();
    if n < 3 {
        found.push(Defect::TooFewVertices { ring, count: n });
        return;
    }
    let before = found.len();
    for edge in 0..n {
        let [a, b] = polygon.edge(ring, edge);
        if a == b {
            found.push(Defect::ZeroLengthEdge(EdgeRef { ring, edge }));
        }
    }
    if found.len() > before {
        return;
    }
    // Edges have positive length from here on, so one of them spans the line, if there is one.
    let [a, b] = polygon.edge_pins(ring, 0);
    if (2..n).all(|k| orient_pins(a, b, polygon.pin(ring, k)) == 0) {
        found.push(Defect::ZeroArea { ring });
        return;
    }
    for vertex in 0..n {
        let arrives = polygon.pin(ring, vertex + n - 1);
        let here = polygon.pin(ring, vertex);
        let leaves = polygon.pin(ring, vertex + 1);
        if orient_pins(arrives, here, leaves) == 0
            && (arrives.at - here.at).dot(&(leaves.at - here.at)).sign() > 0
        {
            found.push(Defect::Spike { ring, vertex });
        }
    }
}

/// Pairs of edges that meet where they must not.
fn edges_that_meet(polygon: &Polygon) -> Vec<Defect> {
    let mut found = Vec::new();
    let edges = sorted_for_sweep(polygon);
    'sweep: for (i, (edge, bounds)) in edges.iter().enumerate() {
        for (other, other_bounds) in &edges[i + 1..] {
            if bounds.x.below(&other_bounds.x) {
                break;
            }
            if !bounds.y.meets(&other_bounds.y) {
                continue;
            }
            let (first, second) = (*edge.min(other), *edge.max(other));
            let same_ring = first.ring == second.ring;
            if same_ring && follow_each_other(polygon, first, second) {
                continue; // They share a vertex, and more only at a spike.
            }
            let how = meet_pins(
                polygon.edge_pins(first.ring, first.edge),
                polygon.edge_pins(second.ring, second.edge),
            );
            match how {
                Meeting::Apart => {}
                Meeting::Touch(_) if !same_ring => {}
                _ => {
                    let how = Box::new(how);
                    found.push(Defect::EdgesMeet { first, second, how });
                }
            }
            if found.len() >= MAX_DEFECTS {
                break 'sweep;
            }
        }
    }
    found.sort_by_key(|defect| match defect {
        Defect::EdgesMeet { first, second, .. } => Some((*first, *second)),
        _ => None,
    });
    found
}

/// The edges by the lower end of their boxes; the boxes turned so that x is the axis along which
/// they overlap less.
fn sorted_for_sweep(polygon: &Polygon) -> Vec<(EdgeRef, Box2)> {
    let mut edges: Vec<(EdgeRef, Box2)> = polygon
        .edge_indices()
        .map(|(ring, edge)| (EdgeRef { ring, edge }, polygon.edge_box(ring, edge)))
        .collect();
    let whole = polygon.bounds();
    let width = |b: &Box2| (b.x.hi - b.x.lo) / (whole.x.hi - whole.x.lo);
    let height = |b: &Box2| (b.y.hi - b.y.lo) / (whole.y.hi - whole.y.lo);
    let (across, up) = edges
        .iter()
        .fold((0.0, 0.0), |(w, h), (_, b)| (w + width(b), h + height(b)));
    // Only the speed hangs on this choice.
    if up < across {
        for (_, b) in &mut edges {
            *b = Box2 { x: b.y, y: b.x };
        }
    }
    edges.sort_by(|(_, a), (_, b)| a.x.lo.total_cmp(&b.x.lo));
    edges
}

/// Whether two different edges of one ring share a vertex.
fn follow_each_other(polygon: &Polygon, first: EdgeRef, second: EdgeRef) -> bool {
    let n = polygon.rings()[first.ring].len();
    first.edge + 1 == second.edge || (first.edge == 0 && second.edge + 1 == n)
}

/// Holes that lie wrong as a whole; the rings are simple, and meet in single points at most.
fn misplaced_holes(polygon: &Polygon) -> Vec<Defect> {
    let mut found = Vec::new();
    let alone: Vec<Polygon> = polygon
        .rings()
        .iter()
        .map(|ring: &Vec<Vec2>| Polygon::new(ring.clone(), Vec::new()))
        .collect();
    for (hole, region) in alone[1..].iter().enumerate() {
        if boundary_relation(region, &alone[0]).outside {
            found.push(Defect::HoleOutside { hole });
        }
        for (earlier, other) in alone[1..=hole].iter().enumerate() {
            if interiors_intersect(other, region) {
                found.push(Defect::HolesOverlap {
                    first: earlier,
                    second: hole,
                });
            }
        }
    }
    found
}
