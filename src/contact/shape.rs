//! Polygons prepared for contact: edges with outward normals, vertices with their convexity.

use crate::geometry::Vec2;
use crate::scene::{Obstacle, Pawl};

/// A closed ring of vertices in listing order, with the side on which the solid lies.
#[derive(Clone, Debug)]
pub struct Ring {
    /// Vertices as listed.
    pub vertices: Vec<Vec2>,
    /// For each edge k (vertex k to k + 1) its outward normal, as long as the edge.
    pub normals: Vec<Vec2>,
    /// For each vertex whether it is strictly convex: only such a vertex can touch.
    pub convex: Vec<bool>,
}

impl Ring {
    /// Prepares a simple ring; `hole` means that the solid lies outside of it.
    pub fn new(vertices: Vec<Vec2>, hole: bool) -> Ring {
        let n = vertices.len();
        let mut area2 = crate::number::Rat::zero();
        for i in 0..n {
            area2 += &vertices[i].cross(&vertices[(i + 1) % n]);
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
        }
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
pub struct PawlShape {
    /// The ring, relative to the hinge, at θ = 0.
    pub ring: Ring,
}

impl PawlShape {
    /// The pawl's ring about its hinge.
    pub fn new(pawl: &Pawl) -> PawlShape {
        let rel = pawl.vertices.iter().map(|p| p - &pawl.hinge).collect();
        PawlShape {
            ring: Ring::new(rel, false),
        }
    }
}

/// An obstacle's rings.
#[derive(Clone, Debug)]
pub struct ObstacleShape {
    /// The outer ring, then the holes.
    pub rings: Vec<Ring>,
}

impl ObstacleShape {
    /// The obstacle's rings.
    pub fn new(obstacle: &Obstacle) -> ObstacleShape {
        let mut rings = vec![Ring::new(obstacle.vertices.clone(), false)];
        rings.extend(obstacle.holes.iter().map(|h| Ring::new(h.clone(), true)));
        ObstacleShape { rings }
    }
}
