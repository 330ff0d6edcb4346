//! Names before numbers: points where arcs can end are told by what meets there, and supporting lines by what
//! they are, so that forced coincidences cost no arithmetic (DP §8.4.2).

use super::CurveId;
use crate::contact::{Chart, Ring};
use crate::geometry::Vec2;
use crate::kernel::Kernel;
use std::collections::HashMap;
use std::rc::Rc;

/// A point whose name is known: equal names share one handle.
#[derive(Debug)]
pub(super) struct Named<K: Kernel> {
    pub(super) x: K::Root,
    pub(super) t: std::cell::OnceCell<K::Time>,
}

/// The points of one name, ascending.
pub(super) type Names<K> = Rc<[Rc<Named<K>>]>;

/// The names of points where arcs can end (idea 2: names before numbers).
#[derive(PartialEq, Eq, Hash)]
pub(super) enum Name<R> {
    /// A pawl vertex on an obstacle vertex, both by their coordinates.
    VertexVertex(Box<(Vec2<R>, Vec2<R>)>, Chart),
    /// A pawl edge flush on an obstacle edge, both by their supporting lines.
    Flush(u32, u32, Chart),
    /// A vertical tangency of a curve.
    Tangency(CurveId, Chart),
}

/// Supporting lines (normal, offset) numbered so that collinear edges share a number; each when first asked
/// for, since most edges of a long obstacle are out of reach.
pub(super) struct Lines<K: Kernel> {
    rings: Vec<Ring<K::Num>>,
    /// The first edge of each ring, numbered through all of them.
    first: Vec<u32>,
    seen: HashMap<K::Key, u32>,
    of_edge: HashMap<u32, u32>,
}

impl<K: Kernel> Lines<K> {
    pub(super) fn new<'a>(rings: impl Iterator<Item = &'a Ring<K::Num>>) -> Lines<K> {
        let rings: Vec<_> = rings.cloned().collect();
        let mut next = 0;
        let mut first = Vec::with_capacity(rings.len());
        for r in &rings {
            first.push(next);
            next += r.len() as u32;
        }
        Lines {
            rings,
            first,
            seen: HashMap::new(),
            of_edge: HashMap::new(),
        }
    }

    pub(super) fn number(&mut self, edge: u32) -> u32 {
        if let Some(&n) = self.of_edge.get(&edge) {
            return n;
        }
        let r = self.first.partition_point(|&f| f <= edge) - 1;
        let (ring, k) = (&self.rings[r], (edge - self.first[r]) as usize);
        let (n, on) = (&ring.normals[k], &ring.vertices[k]);
        // Offset first, so that the sign is fixed by the normal alone and orientation stays
        // out of the name.
        let line = [n.dot(on), n.x.clone(), n.y.clone()];
        let next = self.of_edge.len() as u32;
        let number = match K::primitive(&line) {
            Some((line, _)) => *self.seen.entry(K::key(&line)).or_insert(next),
            None => next,
        };
        self.of_edge.insert(edge, number);
        number
    }
}
