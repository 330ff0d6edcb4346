//! The other boundary components of a face, from left to right.
//!
//! The idea: a component of the boundary begins, at its leftmost (then lowest) point, with the low end of
//! some arc. So look at the beginnings of untouched components in that order, and straight down from each. What
//! lies next below began further left (or straight below), so it was looked at before: either its upper side
//! there was traced, then the beginning lies in the face, an island to be traced; or not, and then it lies
//! hidden or outside. Nothing below at all: in the face only if that is unbounded.
//!
//! A component that crosses what was traced is part of it, and a connected part of all arcs has one cycle round any
//! face: the walk has passed it already, and no ray is needed. Long arcs that were traced tell that of many others by
//! the order at both ends of what the two have in common.
//!
//! The ray down goes through the index that the walk has anyway; a sweep over the traced boundary, which
//! would do without rays, made the merge take half as long again to twice as long, because every vertex had to be
//! placed among the edges that are active.

use super::item::{Carrier, Item};
use super::trace::Tracer;
use crate::geometry::index::{EMPTY, hull, meet};

/// By how many traced items it is asked whether a component is connected to them.
const LONGEST: usize = 4;

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
        let longest = self.longest_touched();
        for (comp, at) in open {
            if self.tests > self.budget {
                return;
            }
            let item = self.comps[comp as usize].item;
            let traced = self.touched[comp as usize]
                || longest.iter().any(|&other| self.surely_cross(item, other));
            if !traced && self.opens_into_face(at) {
                self.trace_island(comp);
            }
        }
    }

    /// The longest graphs, along u, of those traced.
    fn longest_touched(&self) -> Vec<u32> {
        let mut longest: Vec<(f64, u32)> = Vec::with_capacity(LONGEST + 1);
        for (i, item) in self.items.iter().enumerate() {
            let length = self.k.enclosure(item.r).0 - self.k.enclosure(item.l).1;
            let graph = matches!(item.carrier, Carrier::Graph(_));
            let full = longest.len() == LONGEST;
            if !graph
                || !self.touched[item.comp as usize]
                || full && longest.iter().all(|l| length <= l.0)
            {
                continue;
            }
            longest.push((length, i as u32));
            longest.sort_by(|a, b| b.0.total_cmp(&a.0));
            longest.truncate(LONGEST);
        }
        longest.into_iter().map(|l| l.1).collect()
    }

    /// Whether two items surely have a point in common: one is above the other at the one end of the range they share,
    /// and below at the other end.
    fn surely_cross(&self, a: u32, b: u32) -> bool {
        let (i, j): (&Item, &Item) = (&self.items[a as usize], &self.items[b as usize]);
        let (Carrier::Graph(c), Carrier::Graph(d)) = (i.carrier, j.carrier) else {
            return false;
        };
        let k = &*self.k;
        let left = |x, y| k.enclosure(x).1 < k.enclosure(y).0;
        let later = if left(i.l, j.l) { j.l } else { i.l };
        let earlier = if left(i.r, j.r) { i.r } else { j.r };
        // Both ends lie in both ranges: one of two that doubles do not tell apart might not.
        let sure = (left(i.l, j.l) || left(j.l, i.l)) && (left(i.r, j.r) || left(j.r, i.r));
        if !sure || !left(later, earlier) {
            return false;
        }
        let side = |x| (k.height(c, x) - k.height(d, x)).sign();
        matches!(
            (side(later), side(earlier)),
            (Some(1), Some(-1)) | (Some(-1), Some(1))
        )
    }
}
