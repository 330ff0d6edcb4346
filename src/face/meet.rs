//! The common points of two items, found once for each pair that has any.
//!
//! The idea: a pair of graphs meets where h vanishes, and the roots that the two share by name (common
//! ends) are divided out before the others are looked for, so that coincidences by construction cost nothing.

use super::item::{Carrier, Item, NONE, Place};
use super::kernel::{CurveId, NumId};
use super::trace::Tracer;
use std::cmp::Ordering;

#[derive(Clone, Copy)]
pub(super) struct Cross {
    pub(super) x: NumId,
    /// A curve through the point, which orders points on verticals.
    pub(super) c: CurveId,
    /// On the item with the smaller index, and on the other.
    pub(super) places: [Place; 2],
    pub(super) vertex: u32,
}

impl Tracer<'_> {
    /// The common points of two items, as a range of `crosses`.
    pub(super) fn meet(&mut self, a: u32, b: u32) -> (u32, u32) {
        let (a, b) = (a.min(b), a.max(b));
        if let Some(&r) = self.pairs.get(&(a, b)) {
            return r;
        }
        let from = self.crosses.len() as u32;
        let (i, j) = (self.items[a as usize], self.items[b as usize]);
        match (i.carrier, j.carrier) {
            (Carrier::Graph(c), Carrier::Graph(d)) if c == d => self.overlap(&i, &j, c),
            (Carrier::Graph(c), Carrier::Graph(d)) => self.cross((a, b), (&i, &j), c, d),
            (Carrier::Graph(c), Carrier::Vertical(..)) => self.pierce(&i, c, &j, false),
            (Carrier::Vertical(..), Carrier::Graph(d)) => self.pierce(&j, d, &i, true),
            (Carrier::Vertical(..), Carrier::Vertical(..)) => self.stack(&i, &j),
        }
        let range = (from, self.crosses.len() as u32);
        self.pairs.insert((a, b), range);
        range
    }

    fn push_cross(&mut self, x: NumId, c: CurveId, places: [Place; 2]) {
        self.crosses.push(Cross {
            x,
            c,
            places,
            vertex: NONE,
        });
    }

    /// Where a number lies in an item's range; None outside.
    pub(super) fn place(&mut self, item: &Item, x: NumId) -> Option<Place> {
        match self.k.cmp(item.l, x) {
            Ordering::Greater => return None,
            Ordering::Equal => return Some(Place::Low),
            Ordering::Less => {}
        }
        match self.k.cmp(x, item.r) {
            Ordering::Greater => None,
            Ordering::Equal => Some(Place::High),
            Ordering::Less => Some(Place::Inside),
        }
    }

    /// Two graphs of different curves.
    fn cross(&mut self, (a, b): (u32, u32), (i, j): (&Item, &Item), c: CurveId, d: CurveId) {
        let k = &*self.k;
        let lo = k.enclosure(i.l).0.max(k.enclosure(j.l).0);
        let hi = k.enclosure(i.r).1.min(k.enclosure(j.r).1);
        if lo > hi {
            return;
        }
        // Common ends first: they are roots known without search.
        let mut known = [NONE; 4];
        let mut n = 0;
        let mut apart = false;
        for (x, p) in [(i.l, Place::Low), (i.r, Place::High)] {
            for (y, q) in [(j.l, Place::Low), (j.r, Place::High)] {
                let order = self.k.cmp(x, y);
                if order.is_eq() && self.k.cmp_at(c, d, x).is_eq() {
                    self.push_cross(x, c, [p, q]);
                    known[n] = x;
                    n += 1;
                }
                // One ends where the other begins, or before.
                apart |= p != q && (order.is_eq() || order.is_lt() == (p == Place::High));
            }
        }
        if apart {
            return;
        }
        // So are the vertices of many arcs that both pass through; each of the two stops there anyway.
        if let (Some(mine), Some(theirs)) = (self.busy.get(&a), self.busy.get(&b)) {
            let mut shared = mine.clone();
            shared.retain(|v| theirs.contains(v));
            for v in shared {
                let x = self.vertices[v as usize].at.x;
                let ends = [i.vl, i.vr, j.vl, j.vr].map(|e| self.find(e) == v);
                let pushed = (ends[0] || ends[1]) && (ends[2] || ends[3]);
                for _ in usize::from(pushed)..self.k.contact(c, d, x) {
                    if n < known.len() {
                        known[n] = x;
                        n += 1;
                    }
                }
            }
        }
        let mut found = std::mem::take(&mut self.numbers);
        found.clear();
        self.k.crossings(c, d, (lo, hi), &known[..n], &mut found);
        for &x in &found {
            let Some(p) = self.place(i, x) else { continue };
            let Some(q) = self.place(j, x) else { continue };
            let mut repeated = false;
            for &e in &known[..n] {
                repeated |= p != Place::Inside && q != Place::Inside && self.k.cmp(e, x).is_eq();
            }
            if repeated {
                continue;
            }
            // The name of an end is the better one.
            let x = match (p, q) {
                (Place::Low, _) => i.l,
                (Place::High, _) => i.r,
                (_, Place::Low) => j.l,
                (_, Place::High) => j.r,
                _ => x,
            };
            self.push_cross(x, c, [p, q]);
        }
        self.numbers = found;
    }

    /// Two graphs on one curve: their ends on each other.
    fn overlap(&mut self, i: &Item, j: &Item, c: CurveId) {
        for (x, p) in [(i.l, Place::Low), (i.r, Place::High)] {
            if let Some(q) = self.place(j, x) {
                self.push_cross(x, c, [p, q]);
            }
        }
        for (x, q) in [(j.l, Place::Low), (j.r, Place::High)] {
            if let Some(Place::Inside) = self.place(i, x) {
                self.push_cross(x, c, [Place::Inside, q]);
            }
        }
    }

    /// A graph and a vertical.
    fn pierce(&mut self, graph: &Item, c: CurveId, vertical: &Item, vertical_first: bool) {
        let Carrier::Vertical(lo, hi) = vertical.carrier else {
            return;
        };
        let Some(p) = self.place(graph, vertical.l) else {
            return;
        };
        let Some(q) = self.place_between(lo, hi, c, vertical.l) else {
            return;
        };
        let places = if vertical_first { [q, p] } else { [p, q] };
        self.push_cross(vertical.l, c, places);
    }

    /// Where the point of curve `c` over x lies on a vertical there.
    pub(super) fn place_between(
        &mut self,
        lo: CurveId,
        hi: CurveId,
        c: CurveId,
        x: NumId,
    ) -> Option<Place> {
        match self.k.cmp_at(lo, c, x) {
            Ordering::Greater => return None,
            Ordering::Equal => return Some(Place::Low),
            Ordering::Less => {}
        }
        match self.k.cmp_at(c, hi, x) {
            Ordering::Greater => None,
            Ordering::Equal => Some(Place::High),
            Ordering::Less => Some(Place::Inside),
        }
    }

    /// Two verticals.
    fn stack(&mut self, i: &Item, j: &Item) {
        if !self.k.cmp(i.l, j.l).is_eq() {
            return;
        }
        let (Carrier::Vertical(a, b), Carrier::Vertical(c, d)) = (i.carrier, j.carrier) else {
            return;
        };
        for (e, p) in [(a, Place::Low), (b, Place::High)] {
            if let Some(q) = self.place_between(c, d, e, i.l) {
                self.push_cross(i.l, e, [p, q]);
            }
        }
        for (e, q) in [(c, Place::Low), (d, Place::High)] {
            if let Some(Place::Inside) = self.place_between(a, b, e, i.l) {
                self.push_cross(i.l, e, [Place::Inside, q]);
            }
        }
    }
}
