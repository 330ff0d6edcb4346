//! Regions of the plane: an outer ring and its holes, kept as they were listed.

use super::predicates::{Corner, Pin, orient_pins};
use super::{Box2, Vec2};
use crate::number::Rat;
use std::cmp::Ordering;

/// A polygonal region: the inside of an outer ring without the insides of its holes.
///
/// Ring 0 is the outer ring, ring h + 1 is hole h; edge k of a ring joins its vertex k to vertex
/// k + 1 (the last one to vertex 0). Rings keep the order and the sense in which they were
/// listed, so indices are those of the file; [`Polygon::solid_left`] says on which side the solid
/// lies. Collinear vertices are ordinary.
///
/// Any list of points makes a `Polygon`; [`super::defects`] tells whether it is a proper one:
/// every ring simple, every hole inside the outer ring, holes disjoint but for single points.
/// What needs a proper polygon says so.
#[derive(Clone, Debug)]
pub struct Polygon {
    rings: Vec<Vec<Vec2>>,
    /// Certified boxes, parallel to `rings`.
    boxes: Vec<Vec<Box2>>,
    /// Whether each ring is listed counter-clockwise.
    counter_clockwise: Vec<bool>,
    bounds: Box2,
}

/// Where a point lies with respect to a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Location {
    /// In the open interior.
    Inside,
    /// On an edge or a vertex.
    Boundary,
    /// In the open exterior, which a hole belongs to.
    Outside,
}

impl Polygon {
    /// A region from its rings as listed, in either sense. O(vertices).
    pub fn new(outer: Vec<Vec2>, holes: Vec<Vec<Vec2>>) -> Polygon {
        let mut rings = vec![outer];
        rings.extend(holes);
        let boxes: Vec<Vec<Box2>> = rings
            .iter()
            .map(|ring| ring.iter().map(Box2::of_point).collect())
            .collect();
        let bounds = boxes
            .iter()
            .flatten()
            .fold(Box2::EMPTY, |all, b| all.hull(b));
        let mut polygon = Polygon {
            counter_clockwise: Vec::new(),
            rings,
            boxes,
            bounds,
        };
        let senses = (0..polygon.rings.len()).map(|ring| polygon.sense(ring));
        polygon.counter_clockwise = senses.collect();
        polygon
    }

    /// The rings: the outer one, then the holes.
    pub fn rings(&self) -> &[Vec<Vec2>] {
        &self.rings
    }

    /// How many vertices (and edges) all rings have together.
    pub fn len(&self) -> usize {
        self.rings.iter().map(Vec::len).sum()
    }

    /// Whether there is no vertex at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The two ends of an edge as listed. Panics if there is no such ring or edge.
    pub fn edge(&self, ring: usize, k: usize) -> [&Vec2; 2] {
        let vertices = &self.rings[ring];
        [&vertices[k], &vertices[(k + 1) % vertices.len()]]
    }

    /// Twice the signed area of a ring as listed: positive for a counter-clockwise one. Panics if
    /// there is no such ring.
    ///
    /// O(vertices) operations, but on numbers that grow where the vertices have many different
    /// denominators; nothing here relies on it.
    pub fn twice_signed_area(&self, ring: usize) -> Rat {
        // The shoelace sum, about the first vertex so that the products stay short.
        let mut total = Rat::zero();
        if let Some((first, rest)) = self.rings[ring].split_first() {
            for pair in rest.windows(2) {
                total += &(&pair[0] - first).cross(&(&pair[1] - first));
            }
        }
        total
    }

    /// Twice the area of the region of a proper polygon.
    pub fn twice_area(&self) -> Rat {
        let mut total = self.twice_signed_area(0).abs();
        for hole in 1..self.rings.len() {
            total -= &self.twice_signed_area(hole).abs();
        }
        total
    }

    /// Whether a simple ring is listed counter-clockwise. Panics if there is no such ring.
    pub fn is_counter_clockwise(&self, ring: usize) -> bool {
        self.counter_clockwise[ring]
    }

    /// The sense of a ring, without its area: a simple ring turns at its leftmost vertex (the
    /// lowest of these), as it may not fold back there, and it turns the way it is listed.
    fn sense(&self, ring: usize) -> bool {
        let n = self.rings[ring].len();
        let first = (0..n).min_by(|&i, &j| {
            let (a, b) = (self.pin(ring, i), self.pin(ring, j));
            if a.near.x.below(&b.near.x) {
                Ordering::Less
            } else if b.near.x.below(&a.near.x) {
                Ordering::Greater
            } else {
                a.at.cmp(b.at)
            }
        });
        first.is_some_and(|k| {
            let before = self.pin(ring, k + n - 1);
            orient_pins(before, self.pin(ring, k), self.pin(ring, k + 1)) > 0
        })
    }

    /// Whether the solid lies to the left of a ring's edges as listed (counter-clockwise for the
    /// outer ring, clockwise for a hole). Panics if there is no such ring.
    pub fn solid_left(&self, ring: usize) -> bool {
        self.is_counter_clockwise(ring) == (ring == 0)
    }

    /// The kind of corner at vertex `k` of a ring, exactly. Panics if there is no such vertex.
    pub fn corner(&self, ring: usize, k: usize) -> Corner {
        let n = self.rings[ring].len();
        let turn = orient_pins(
            self.pin(ring, (k + n - 1) % n),
            self.pin(ring, k),
            self.pin(ring, k + 1),
        );
        Corner::from_turn(if self.solid_left(ring) { turn } else { -turn })
    }

    /// A box of doubles around all vertices.
    pub fn bounds(&self) -> &Box2 {
        &self.bounds
    }

    /// Where `p` lies, exactly; the region is that of the even-odd rule, which for a proper
    /// polygon is the outer ring's inside without the holes. O(edges).
    pub fn locate(&self, p: &Vec2) -> Location {
        let near = Box2::of_point(p);
        if !near.meets(&self.bounds) {
            return Location::Outside;
        }
        let p = Pin { at: p, near: &near };
        let mut inside = false;
        for (ring, k) in self.edge_indices() {
            let [a, b] = self.edge_pins(ring, k);
            match ray_meets(a, b, p) {
                Ray::Through => inside = !inside,
                Ray::StartsOn => return Location::Boundary,
                Ray::Misses => {}
            }
        }
        if inside {
            Location::Inside
        } else {
            Location::Outside
        }
    }

    /// The region moved by a vector.
    pub fn translated(&self, by: &Vec2) -> Polygon {
        self.mapped(|p| p + by)
    }

    /// The region turned about `centre` by θ where `tan_half` = tan(θ/2), exactly.
    pub fn rotated(&self, centre: &Vec2, tan_half: &Rat) -> Polygon {
        self.mapped(|p| centre + &(p - centre).rotate_tan_half(tan_half))
    }

    fn mapped(&self, f: impl Fn(&Vec2) -> Vec2) -> Polygon {
        let mut rings = self
            .rings
            .iter()
            .map(|ring| ring.iter().map(&f).collect::<Vec<_>>());
        let outer = rings.next().unwrap_or_default();
        Polygon::new(outer, rings.collect())
    }

    /// Every edge as (ring, index).
    pub(crate) fn edge_indices(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.rings
            .iter()
            .enumerate()
            .flat_map(|(ring, vertices)| (0..vertices.len()).map(move |k| (ring, k)))
    }

    /// A vertex with its box; the index may run one past the end, to vertex 0.
    pub(crate) fn pin(&self, ring: usize, k: usize) -> Pin<'_> {
        let k = k % self.rings[ring].len();
        Pin {
            at: &self.rings[ring][k],
            near: &self.boxes[ring][k],
        }
    }

    /// The two ends of an edge with their boxes.
    pub(crate) fn edge_pins(&self, ring: usize, k: usize) -> [Pin<'_>; 2] {
        [self.pin(ring, k), self.pin(ring, k + 1)]
    }

    /// The box of an edge.
    pub(crate) fn edge_box(&self, ring: usize, k: usize) -> Box2 {
        let [a, b] = self.edge_pins(ring, k);
        a.near.hull(b.near)
    }
}

/// What the ray from a point towards +x does at an edge.
enum Ray {
    Through,
    Misses,
    StartsOn,
}

/// An edge owns its lower end only, so a ray through a vertex counts once or twice as it must.
fn ray_meets(a: Pin<'_>, b: Pin<'_>, p: Pin<'_>) -> Ray {
    let (low, high) = match compare_y(a, b) {
        Ordering::Less => (a, b),
        Ordering::Greater => (b, a),
        Ordering::Equal => {
            let level = compare_y(a, p) == Ordering::Equal;
            let within = between(&a.at.x, &b.at.x, &p.at.x);
            return if level && within {
                Ray::StartsOn
            } else {
                Ray::Misses
            };
        }
    };
    let above = compare_y(p, low);
    let below = compare_y(p, high);
    if above == Ordering::Less || below == Ordering::Greater {
        return Ray::Misses;
    }
    match orient_pins(low, high, p) {
        0 => Ray::StartsOn,
        // Left of an edge that rises: the edge lies towards +x.
        1.. if below == Ordering::Less => Ray::Through,
        _ => Ray::Misses,
    }
}

/// Compares ordinates, boxes first.
fn compare_y(a: Pin<'_>, b: Pin<'_>) -> Ordering {
    if a.near.y.below(&b.near.y) {
        Ordering::Less
    } else if b.near.y.below(&a.near.y) {
        Ordering::Greater
    } else {
        a.at.y.cmp(&b.at.y)
    }
}

/// Whether `x` lies between two numbers given in whichever order.
fn between(a: &Rat, b: &Rat, x: &Rat) -> bool {
    (a <= x && x <= b) || (b <= x && x <= a)
}
