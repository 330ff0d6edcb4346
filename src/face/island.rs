//! The other boundary components of a face, from left to right.
//!
//! The idea: a component of the boundary begins, at its leftmost (then lowest) point, with the low end of
//! some arc. So look at the beginnings of untouched components in that order, and straight down from each. What
//! lies next below began further left (or straight below), so it was looked at before: either its upper side
//! there was traced, then the beginning lies in the face, an island to be traced; or not, and then it lies
//! hidden or outside. Nothing below at all: in the face only if that is unbounded.
//!
//! The ray down goes through the index that the walk has anyway; a sweep over the traced boundary, which
//! would do without rays, made the merge take half as long again to twice as long, because every vertex had to be
//! placed among the edges that are active.

use super::trace::Tracer;
use crate::geometry::index::{EMPTY, hull, meet};

impl Tracer<'_> {
    /// Traces every island of the face whose outline is known.
    ///
    /// O(c log c) for c components of the input, and one ray for each that may lie in the face.
    pub(crate) fn islands(&mut self) {
        let mut around = EMPTY;
        for e in 0..self.edges.len() {
            around = hull(&around, &self.items[self.edges[e].item as usize].bounds);
        }
        let mut open = Vec::new();
        for comp in 0..self.touched.len() as u32 {
            if self.touched[comp as usize] {
                continue;
            }
            let at = self.begin_of(comp);
            let (x, t) = (self.k.enclosure(at.x), self.k.height(at.c, at.x));
            let bounds = [x.0, x.1, t.lo(), t.hi()];
            if self.unbounded || t.lo().is_nan() || t.hi().is_nan() || meet(&bounds, &around) {
                open.push((comp, at));
            }
        }
        open.sort_by(|a, b| self.cmp_points(a.1, b.1));
        for (comp, at) in open {
            if self.tests > self.budget {
                return;
            }
            if !self.touched[comp as usize] && self.opens_into_face(at) {
                self.trace_island(comp);
            }
        }
    }
}
