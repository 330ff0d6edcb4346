//! Do two regions' interiors share a point? The predicate that decides what penetrates what.
//!
//! Both boundaries are cut at all their common points. A piece of A's boundary then lies strictly
//! inside B, strictly outside B, or on B's boundary, where the two solids lie on the same side of
//! it or on opposite sides; one point of a piece tells for all of it. The interiors share a point
//! if and only if
//!
//! 1. some piece of A's boundary lies inside B, or
//! 2. some piece of B's boundary lies inside A, or
//! 3. some piece lies on both boundaries with the solids on the same side.
//!
//! *If*: every boundary point of a proper polygon is a limit of its interior, so near a boundary
//! point of A inside B there are interior points of both; and near the middle of a piece of kind
//! 3 both regions fill the same half of a small disc. *Only if*: let U be the intersection of the
//! interiors, open, bounded and not empty. Its boundary is no finite set, and lies in the union
//! of the two boundaries and in both closures; so all but finitely many of its points lie inside
//! a piece: of A's boundary inside B, of B's inside A, or on both boundaries. In the last case U
//! lies to one side of the piece there, and both regions with it: kind 3.
//!
//! Nothing here asks for general position: shared edges, touching vertices, equal regions and
//! holes that are filled exactly are all ordinary.

use super::predicates::Pin;
use super::segment::{Meeting, meet_pins};
use super::{Location, Polygon, Vec2};
use crate::number::Rat;
use std::ops::ControlFlow;

/// Where the boundary of one region runs with respect to another region: which of the four kinds
/// of pieces of positive length occur.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoundaryRelation {
    /// A piece strictly inside the other region.
    pub inside: bool,
    /// A piece strictly outside it (a hole is outside).
    pub outside: bool,
    /// A piece on its boundary, the two solids on the same side.
    pub same_side: bool,
    /// A piece on its boundary, the two solids on opposite sides.
    pub opposite_side: bool,
}

impl BoundaryRelation {
    fn note(&mut self, piece: Piece) {
        match piece {
            Piece::Inside => self.inside = true,
            Piece::Outside => self.outside = true,
            Piece::SameSide => self.same_side = true,
            Piece::OppositeSide => self.opposite_side = true,
        }
    }
}

/// Whether the open interiors of two proper polygons share a point, exactly.
///
/// Disjoint boxes cost O(1); otherwise O(n·m) box comparisons, and exact arithmetic only for
/// edges whose boxes meet. Touching regions cost one point location for every piece between
/// touching points.
pub fn interiors_intersect(a: &Polygon, b: &Polygon) -> bool {
    if !a.bounds().meets(b.bounds()) {
        return false;
    }
    // Two edges that cross inside both prove it at once if one region, say B, has no holes: round
    // the crossing B then fills a half-disc, and A the part of the disc just beside its own edge
    // on both sides of the crossing. Where both have holes, both may be pinched at that point.
    let crossing_decides = a.rings().len() == 1 || b.rings().len() == 1;
    let found = walk(a, b, crossing_decides, &mut |piece| match piece {
        Piece::Inside | Piece::SameSide => ControlFlow::Break(()),
        Piece::Outside | Piece::OppositeSide => ControlFlow::Continue(()),
    });
    // Pieces on both boundaries have been seen from A's side; from B's only the inside is left.
    found.is_break()
        || walk(b, a, false, &mut |piece| match piece {
            Piece::Inside => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        })
        .is_break()
}

/// Which kinds of pieces A's boundary has with respect to B. Both must be proper polygons.
pub fn boundary_relation(a: &Polygon, b: &Polygon) -> BoundaryRelation {
    let mut relation = BoundaryRelation::default();
    // Never broken off, so there is nothing to learn from the flow.
    let _ = walk(a, b, false, &mut |piece| {
        relation.note(piece);
        ControlFlow::Continue(())
    });
    relation
}

/// What one piece of a boundary is to the other region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Piece {
    Inside,
    Outside,
    SameSide,
    OppositeSide,
}

/// Visits every piece of A's boundary until `visit` breaks off.
fn walk(
    a: &Polygon,
    b: &Polygon,
    crossing_decides: bool,
    visit: &mut dyn FnMut(Piece) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let near: Vec<(usize, usize)> = b
        .edge_indices()
        .filter(|&(ring, k)| b.edge_box(ring, k).meets(a.bounds()))
        .collect();
    for ring in 0..a.rings().len() {
        // What the piece before was, as long as no point of B's boundary has come between.
        let mut carried = None;
        for k in 0..a.rings()[ring].len() {
            let cut = EdgeCuts::of(a, (ring, k), b, &near);
            if crossing_decides && cut.crossed {
                return ControlFlow::Break(());
            }
            let [start, end] = a.edge(ring, k);
            let stops: Vec<&Vec2> = cut.stops(start, end);
            for pair in stops.windows(2) {
                if cut.points.contains(pair[0]) {
                    carried = None;
                }
                let piece = match (cut.shared_side(pair[0], pair[1]), carried) {
                    (Some(shared), _) => shared,
                    (None, Some(same)) => same,
                    (None, None) => side_of_middle(b, pair[0], pair[1]),
                };
                visit(piece)?;
                carried = Some(piece);
            }
            if cut.points.contains(end) {
                carried = None;
            }
        }
    }
    ControlFlow::Continue(())
}

/// All that one edge of A has in common with B's boundary.
struct EdgeCuts {
    /// The points where it must be cut, in order along the edge, its own ends only where they
    /// lie on B's boundary.
    points: SortedAlong,
    /// The pieces it shares with edges of B, ends in lexicographic order.
    overlaps: Vec<(Vec2, Vec2, Piece)>,
    /// Whether some edge of B crosses it inside both.
    crossed: bool,
}

impl EdgeCuts {
    fn of(a: &Polygon, (ring, k): (usize, usize), b: &Polygon, near: &[(usize, usize)]) -> Self {
        let edge: [Pin<'_>; 2] = a.edge_pins(ring, k);
        let edge_box = a.edge_box(ring, k);
        let mut points = Vec::new();
        let mut overlaps = Vec::new();
        let mut crossed = false;
        for &(b_ring, b_k) in near {
            if !b.edge_box(b_ring, b_k).meets(&edge_box) {
                continue;
            }
            match meet_pins(edge, b.edge_pins(b_ring, b_k)) {
                Meeting::Apart => {}
                Meeting::Touch(at) => points.push(at),
                Meeting::Cross(at) => {
                    crossed = true;
                    points.push(at);
                }
                Meeting::Overlap(from, to) => {
                    let along = edge[1].at - edge[0].at;
                    let [c, d] = b.edge(b_ring, b_k);
                    let same_way = along.dot(&(d - c)).sign() > 0;
                    let same_hand = a.solid_left(ring) == b.solid_left(b_ring);
                    let piece = if same_way == same_hand {
                        Piece::SameSide
                    } else {
                        Piece::OppositeSide
                    };
                    points.push(from.clone());
                    points.push(to.clone());
                    overlaps.push((from, to, piece));
                }
            }
        }
        EdgeCuts {
            points: SortedAlong::new(points, edge[0].at, edge[1].at),
            overlaps,
            crossed,
        }
    }

    /// The ends of the pieces in order: the edge's start, the cuts inside it, its end.
    fn stops<'a>(&'a self, start: &'a Vec2, end: &'a Vec2) -> Vec<&'a Vec2> {
        let inner = self.points.0.iter().filter(|p| *p != start && *p != end);
        std::iter::once(start)
            .chain(inner)
            .chain(std::iter::once(end))
            .collect()
    }

    /// The side on which the solids lie, if the piece lies on B's boundary.
    fn shared_side(&self, from: &Vec2, to: &Vec2) -> Option<Piece> {
        let (lo, hi) = (from.min(to), from.max(to));
        self.overlaps
            .iter()
            .find(|(start, end, _)| start <= lo && hi <= end)
            .map(|&(_, _, piece)| piece)
    }
}

/// Points of one segment without repetition, in its direction.
struct SortedAlong(Vec<Vec2>);

impl SortedAlong {
    fn new(mut points: Vec<Vec2>, start: &Vec2, end: &Vec2) -> SortedAlong {
        // On a segment the lexicographic order is the order along it, or its reverse.
        points.sort_unstable();
        points.dedup();
        if end < start {
            points.reverse();
        }
        SortedAlong(points)
    }

    fn contains(&self, p: &Vec2) -> bool {
        self.0.contains(p)
    }
}

/// Where a piece that does not lie on B's boundary runs: one point of it tells.
fn side_of_middle(b: &Polygon, from: &Vec2, to: &Vec2) -> Piece {
    let middle = Vec2::new(Rat::midpoint(&from.x, &to.x), Rat::midpoint(&from.y, &to.y));
    match b.locate(&middle) {
        Location::Inside => Piece::Inside,
        Location::Outside => Piece::Outside,
        Location::Boundary => unreachable!("a piece between cuts meets no boundary"),
    }
}
