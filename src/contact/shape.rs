//! Polygons prepared for contact: edges with outward normals, vertices with their convexity.

use crate::geometry::Vec2;
use crate::geometry::index::{Hull, Tree};
use crate::number::{Enclosed, Rat, Scalar};
use crate::scene::{Obstacle, Pawl};
use std::sync::OnceLock;

/// A closed ring of vertices in listing order, with the side on which the solid lies.
#[derive(Clone, Debug)]
pub struct Ring<R = Rat> {
    /// Vertices as listed.
    pub vertices: Vec<Vec2<R>>,
    /// For each edge k (vertex k to k + 1) its outward normal, as long as the edge.
    pub normals: Vec<Vec2<R>>,
    /// For each vertex whether it is strictly convex: only such a vertex can touch.
    pub convex: Vec<bool>,
    /// The boxes of the edges, indexed when first asked for.
    index: OnceLock<Tree>,
    /// The ring in certified intervals, made when first asked for.
    rough: OnceLock<Box<Ring<Enclosed>>>,
}

impl<R: Scalar> Ring<R> {
    /// Prepares a simple ring; `hole` means that the solid lies outside of it.
    pub fn new(vertices: Vec<Vec2<R>>, hole: bool) -> Ring<R> {
        let n = vertices.len();
        let mut area2 = R::zero();
        for i in 0..n {
            area2 = area2.plus(&vertices[i].cross(&vertices[(i + 1) % n]));
        }
        let solid_left = (area2.sign() > 0) != hole;
        let mut normals = Vec::with_capacity(n);
        let mut convex = Vec::with_capacity(n);
        for i in 0..n {
            let out = &vertices[(i + 1) % n] - &vertices[i];
            let into = &vertices[i] - &vertices[(i + n - 1) % n];
            let turn = into.cross(&out).sign();
            convex.push(if solid_left { turn > 0 } else { turn < 0 });
            let right = out.right_normal();
            normals.push(if solid_left { right } else { -&right });
        }
        Ring {
            vertices,
            normals,
            convex,
            index: OnceLock::new(),
            rough: OnceLock::new(),
        }
    }
    /// The ring in certified intervals, made once.
    pub(super) fn rough(&self) -> &Ring<Enclosed> {
        self.rough.get_or_init(|| {
            Box::new(Ring {
                vertices: self.vertices.iter().map(Vec2::enclosed).collect(),
                normals: self.normals.iter().map(Vec2::enclosed).collect(),
                convex: self.convex.clone(),
                index: OnceLock::new(),
                rough: OnceLock::new(),
            })
        })
    }
    /// The edges that may meet a region, in order: O(log n) and what is near it, after O(n log n) once.
    pub(super) fn edges_near(&self, region: &Hull) -> Vec<usize> {
        let tree = self.index.get_or_init(|| {
            let edge = |i: usize| {
                let (p, q) = (&self.vertices[i], &self.vertices[self.next(i)]);
                let x = p.x.interval().hull(&q.x.interval());
                let y = p.y.interval().hull(&q.y.interval());
                Hull::boxed([x.lo, x.hi, y.lo, y.hi])
            };
            Tree::new((0..self.len()).map(|i| (edge(i), i as u32)).collect())
        });
        let mut near = Vec::new();
        tree.query(region, |i| {
            near.push(i as usize);
            true
        });
        near.sort_unstable();
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
