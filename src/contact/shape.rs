//! Polygons prepared for contact: edges with outward normals, vertices with their convexity.
//!
//! Most edges of a long obstacle are out of reach, so nothing exact is made of an edge before it is asked for:
//! what is near is found by boxes of the vertices' enclosures (`chain.rs` of the geometry), and normals and
//! convexity come a handful at a time when a first one of them is wanted.

use crate::geometry::Vec2;
use crate::geometry::chain::Chain;
use crate::geometry::index::Hull;
use crate::number::{Enclosed, Interval, Rat, Scalar};
use crate::scene::{Obstacle, Pawl};
use std::ops::Index;
use std::sync::{Arc, OnceLock};

/// How many edges are made at a time.
const PART: usize = 16;

/// The normals of some edges, made together.
type Part<R> = OnceLock<Box<[Vec2<R>]>>;

/// What is known of the edges of a ring, and what can be made of them.
#[derive(Debug)]
struct Edges<R> {
    vertices: Arc<Vec<Vec2<R>>>,
    /// Whether the solid lies to the left of the edges as listed.
    solid_left: OnceLock<bool>,
    hole: bool,
    /// Of a ring of enclosures: for each edge whether its ends have equal x, equal y. Differences of enclosures do not
    /// show it, and much of what happens by force is due to edges that run along an axis.
    flat: Box<[[bool; 2]]>,
    normals: Box<[Part<R>]>,
    /// A bit for each vertex.
    convex: Box<[OnceLock<u16>]>,
}

impl<R: Scalar> Edges<R> {
    fn new(
        vertices: Arc<Vec<Vec2<R>>>,
        hole: bool,
        solid_left: Option<bool>,
        flat: Box<[[bool; 2]]>,
    ) -> Arc<Edges<R>> {
        let parts = vertices.len().div_ceil(PART);
        let known = OnceLock::new();
        if let Some(left) = solid_left {
            let _ = known.set(left);
        }
        Arc::new(Edges {
            vertices,
            solid_left: known,
            hole,
            flat,
            normals: (0..parts).map(|_| OnceLock::new()).collect(),
            convex: (0..parts).map(|_| OnceLock::new()).collect(),
        })
    }
    /// The sign of the ring's area, by enclosures of the shoelace sum where they can tell.
    fn solid_left(&self) -> bool {
        *self.solid_left.get_or_init(|| {
            let v = &self.vertices;
            if v.len() < 3 {
                return !self.hole;
            }
            // The shoelace sum about the first vertex.
            let rough = || {
                let at = |i: usize| v[i].enclosed();
                let origin = at(0);
                let mut last = &at(1) - &origin;
                let mut total = Enclosed::new(Interval::point(0.0));
                for i in 2..v.len() {
                    let next = &at(i) - &origin;
                    total = total.plus(&last.cross(&next));
                    last = next;
                }
                total.interval().sign()
            };
            let sign = R::EXACT.then(rough).flatten().unwrap_or_else(|| {
                let term = |i: usize| (&v[i] - &v[0]).cross(&(&v[i + 1] - &v[0]));
                let terms = 1..v.len() - 1;
                terms.fold(R::zero(), |s, i| s.plus(&term(i))).sign()
            });
            (sign > 0) != self.hole
        })
    }
    fn part(&self, p: usize) -> std::ops::Range<usize> {
        p * PART..self.vertices.len().min((p + 1) * PART)
    }
    fn normal(&self, k: usize) -> &Vec2<R> {
        let made = self.normals[k / PART].get_or_init(|| {
            let (v, left) = (&self.vertices, self.solid_left());
            let one = |k: usize| {
                let mut edge = &v[(k + 1) % v.len()] - &v[k];
                let [same_x, same_y] = self.flat.get(k).copied().unwrap_or_default();
                if same_x {
                    edge.x = R::zero();
                }
                if same_y {
                    edge.y = R::zero();
                }
                let right = edge.right_normal();
                if left { right } else { -&right }
            };
            self.part(k / PART).map(one).collect()
        });
        &made[k % PART]
    }
    fn convex(&self, k: usize) -> bool {
        let made = self.convex[k / PART].get_or_init(|| {
            let (v, left) = (&self.vertices, self.solid_left());
            let n = v.len();
            let mut bits = 0;
            for k in self.part(k / PART) {
                let (into, out) = (&v[k] - &v[(k + n - 1) % n], &v[(k + 1) % n] - &v[k]);
                let rough = || into.enclosed().cross(&out.enclosed()).sign();
                let turn = match if R::EXACT { rough() } else { 0 } {
                    0 => into.cross(&out).sign(),
                    s => s,
                };
                if if left { turn > 0 } else { turn < 0 } {
                    bits |= 1 << (k % PART);
                }
            }
            bits
        });
        made >> (k % PART) & 1 == 1
    }
}

/// The outward normals of a ring's edges: edge k joins vertex k to k + 1, and its normal is as long as it.
#[derive(Clone, Debug)]
pub struct Normals<R = Rat>(Arc<Edges<R>>);

impl<R: Scalar> Index<usize> for Normals<R> {
    type Output = Vec2<R>;
    /// The normal of an edge, made when first asked for. Panics if there is no such edge.
    fn index(&self, k: usize) -> &Vec2<R> {
        self.0.normal(k)
    }
}

impl<R: Scalar> Normals<R> {
    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Vec2<R>> {
        (0..self.0.vertices.len()).map(|k| self.0.normal(k))
    }
}

impl<'a, R: Scalar> IntoIterator for &'a Normals<R> {
    type Item = &'a Vec2<R>;
    type IntoIter = Box<dyn Iterator<Item = &'a Vec2<R>> + 'a>;
    fn into_iter(self) -> Self::IntoIter {
        Box::new(self.iter())
    }
}

/// For each vertex of a ring whether it is strictly convex: only such a vertex can touch.
#[derive(Clone, Debug)]
pub struct Convexity<R = Rat>(Arc<Edges<R>>);

impl<R: Scalar> Index<usize> for Convexity<R> {
    type Output = bool;
    /// Of one vertex, found when first asked for. Panics if there is no such vertex.
    fn index(&self, k: usize) -> &bool {
        if self.0.convex(k) { &true } else { &false }
    }
}

/// A closed ring of vertices in listing order, with the side on which the solid lies. A copy costs O(1).
#[derive(Clone, Debug)]
pub struct Ring<R = Rat> {
    /// Vertices as listed.
    pub vertices: Arc<Vec<Vec2<R>>>,
    /// The outward normals of the edges.
    pub normals: Normals<R>,
    /// Which vertices are strictly convex.
    pub convex: Convexity<R>,
    /// The boxes of the edges, made when first asked for; shared by all copies, as everything else is.
    index: Arc<OnceLock<Chain>>,
    /// The ring in certified intervals, made when first asked for.
    rough: Arc<OnceLock<Box<Ring<Enclosed>>>>,
}

impl<R: Scalar> Ring<R> {
    /// Prepares a simple ring; `hole` means that the solid lies outside of it. O(1): whatever is exact is
    /// made of an edge when it is first asked for.
    pub fn new(vertices: Vec<Vec2<R>>, hole: bool) -> Ring<R> {
        Ring::with(vertices, hole, None, Box::default())
    }
    fn with(
        vertices: Vec<Vec2<R>>,
        hole: bool,
        solid_left: Option<bool>,
        flat: Box<[[bool; 2]]>,
    ) -> Ring<R> {
        let vertices = Arc::new(vertices);
        let edges = Edges::new(vertices.clone(), hole, solid_left, flat);
        Ring {
            vertices,
            normals: Normals(edges.clone()),
            convex: Convexity(edges),
            index: Arc::default(),
            rough: Arc::default(),
        }
    }
    /// Edge k as a vector from vertex k to k + 1.
    pub fn edge(&self, k: usize) -> Vec2<R> {
        let n = &self.normals[k];
        let left = Vec2::new(n.y.negated(), n.x.clone());
        if self.normals.0.solid_left() {
            left
        } else {
            -&left
        }
    }
    /// The ring in certified intervals, made once: normals when asked for, and no convexity, which intervals
    /// do not know.
    pub(super) fn rough(&self) -> &Ring<Enclosed> {
        self.rough.get_or_init(|| {
            let (edges, v) = (&self.normals.0, &self.vertices);
            let flat = |k: usize| {
                let (p, q) = (&v[k], &v[self.next(k)]);
                [p.x == q.x, p.y == q.y]
            };
            Box::new(Ring::with(
                self.vertices.iter().map(Vec2::enclosed).collect(),
                edges.hole,
                Some(edges.solid_left()),
                (0..v.len()).map(flat).collect(),
            ))
        })
    }
    /// The edges that may meet a region, in order: O(log n) and what is near it where the ring winds little, after
    /// O(n) in doubles once.
    pub(super) fn edges_near(&self, region: &Hull) -> Vec<usize> {
        let edge = |i: usize| {
            let (p, q) = (&self.vertices[i], &self.vertices[self.next(i)]);
            let x = p.x.interval().hull(&q.x.interval());
            let y = p.y.interval().hull(&q.y.interval());
            [x.lo, x.hi, y.lo, y.hi]
        };
        let index = self.index.get_or_init(|| Chain::new(self.len(), edge));
        let mut near = Vec::new();
        index.query(region, edge, |i| near.push(i));
        near
    }
    /// Number of vertices, and of edges.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }
    /// The vertex after i.
    pub fn next(&self, i: usize) -> usize {
        (i + 1) % self.len()
    }
    /// The vertex before i.
    pub fn prev(&self, i: usize) -> usize {
        (i + self.len() - 1) % self.len()
    }
}

/// A pawl's polygon about its hinge.
#[derive(Clone, Debug)]
pub struct PawlShape<R = Rat> {
    /// The ring, relative to the hinge, at θ = 0.
    pub ring: Ring<R>,
}

impl<R: Scalar> PawlShape<R> {
    /// The pawl's ring about its hinge.
    pub fn new(pawl: &Pawl) -> PawlShape<R> {
        let hinge = &Vec2::from_exact(&pawl.hinge);
        let rel = pawl.vertices.iter().map(|p| &Vec2::from_exact(p) - hinge);
        let rel = rel.collect();
        PawlShape {
            ring: Ring::new(rel, false),
        }
    }
}

/// An obstacle's rings.
#[derive(Clone, Debug)]
pub struct ObstacleShape<R = Rat> {
    /// The outer ring, then the holes.
    pub rings: Vec<Ring<R>>,
}

impl<R: Scalar> ObstacleShape<R> {
    /// The obstacle's rings.
    pub fn new(obstacle: &Obstacle) -> ObstacleShape<R> {
        let ring = |r: &Vec<Vec2>, hole| Ring::new(r.iter().map(Vec2::from_exact).collect(), hole);
        let mut rings = vec![ring(&obstacle.vertices, false)];
        rings.extend(obstacle.holes.iter().map(|h| ring(h, true)));
        ObstacleShape { rings }
    }
}
