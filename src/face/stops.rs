//! Where a walk may stop: the vertices along an item, found only where the walk passes.
//!
//! The idea: all that meet an item inside one of its windows (`windows.rs`) are found, sorted and named at once.
//!
//! A vertex knows all its arcs once its window is made, since each of them meets the item there.

use super::item::{Carrier, Item, NONE, Place, Point};
use super::kernel::{CurveId, NumId};
use super::trace::Tracer;
use super::windows::{Cut, Leaf, Window};
use std::cmp::Ordering;

/// What another item does on this one.
#[derive(Clone, Copy)]
pub(super) struct Hit {
    x: NumId,
    c: CurveId,
    other: u32,
    there: Place,
    cross: u32,
    /// The vertex there, where it is known already.
    vertex: u32,
}

/// An item through a vertex, in the vertex's list.
#[derive(Clone, Copy)]
pub(super) struct Link {
    pub(super) item: u32,
    pub(super) place: Place,
    pub(super) next: u32,
}

#[derive(Clone, Copy)]
pub(super) struct Vertex {
    pub(super) at: Point,
    pub(super) parent: u32,
    pub(super) links: u32,
    pub(super) germs: u32,
    pub(super) germ_count: u32,
}

impl Vertex {
    pub(super) fn new(at: Point) -> Vertex {
        Vertex {
            at,
            parent: NONE,
            links: NONE,
            germs: NONE,
            germ_count: 0,
        }
    }
}

/// More hits than this are brought roughly into order first.
const MANY: usize = 24;

impl Tracer<'_> {
    // ----- vertices -----

    pub(super) fn find(&mut self, mut v: u32) -> u32 {
        while self.vertices[v as usize].parent != NONE {
            v = self.vertices[v as usize].parent;
        }
        v
    }

    fn unite(&mut self, v: u32, w: u32) -> u32 {
        let (v, w) = (self.find(v), self.find(w));
        if v == w {
            return v;
        }
        let (a, b) = (&self.vertices[v as usize], &self.vertices[w as usize]);
        debug_assert!(
            a.germs == NONE || b.germs == NONE,
            "two visited vertices are one point"
        );
        // The one visited already knows all of its arcs.
        let (keep, drop) = if b.germs != NONE { (w, v) } else { (v, w) };
        self.vertices[drop as usize].parent = keep;
        self.mark_linked(keep);
        let mut at = self.vertices[drop as usize].links;
        while at != NONE {
            let link = self.links[at as usize];
            self.link_marked(keep, link.item, link.place);
            at = link.next;
        }
        keep
    }

    /// Marks the items that a vertex knows.
    fn mark_linked(&mut self, v: u32) {
        self.mark_serial += 1;
        let vertex = &self.vertices[v as usize];
        if vertex.germs != NONE {
            return;
        }
        let mut at = vertex.links;
        while at != NONE {
            let link = self.links[at as usize];
            self.mark[link.item as usize] = self.mark_serial;
            at = link.next;
        }
    }

    /// Adds an item to the vertex whose items are marked, unless it is there or the vertex knows all.
    fn link_marked(&mut self, v: u32, item: u32, place: Place) {
        if self.vertices[v as usize].germs != NONE || self.mark[item as usize] == self.mark_serial {
            return;
        }
        self.mark[item as usize] = self.mark_serial;
        self.link_new(v, item, place);
    }

    /// Adds an item to a vertex that does not know it.
    pub(super) fn link_new(&mut self, v: u32, item: u32, place: Place) {
        let next = self.vertices[v as usize].links;
        self.vertices[v as usize].links = self.links.len() as u32;
        self.links.push(Link { item, place, next });
    }

    /// Calls `found` with every item through a visited vertex.
    pub(super) fn each_link(&self, v: u32, mut found: impl FnMut(u32)) {
        let mut at = self.vertices[v as usize].links;
        while at != NONE {
            let link = &self.links[at as usize];
            found(link.item);
            at = link.next;
        }
    }

    /// Lexicographic order of two points.
    pub(super) fn cmp_points(&mut self, p: Point, q: Point) -> Ordering {
        match self.k.cmp(p.x, q.x) {
            Ordering::Equal => self.k.cmp_at(p.c, q.c, p.x),
            o => o,
        }
    }

    /// The remembered vertices inside an item, as hits on a window.
    fn known_hits(
        &mut self,
        item: u32,
        me: &Item,
        (first, from): (bool, Cut),
        (last, to): (bool, Cut),
        hits: &mut Vec<Hit>,
    ) {
        let Some(vertices) = self.busy.get(&item).cloned() else {
            return;
        };
        for v in vertices {
            let at = self.vertices[v as usize].at;
            if matches!(me.carrier, Carrier::Graph(_))
                && self.find(me.vl) != v
                && self.find(me.vr) != v
                && (first || self.cmp_cut(at.x, from).is_ge())
                && (last || self.cmp_cut(at.x, to).is_lt())
            {
                hits.push(Hit {
                    x: at.x,
                    c: at.c,
                    other: item,
                    there: Place::Inside,
                    cross: NONE,
                    vertex: v,
                });
            }
        }
    }

    /// Finds the stops of a window, in order from low to high.
    pub(super) fn stop(&mut self, item: u32, w: u32, near: &[u32]) {
        let Window { from, to, .. } = self.windows[w as usize];
        let me = self.items[item as usize];
        let whole = self.windows[item as usize];
        let (first, last) = (from == whole.from, to == whole.to);
        let mut hits = std::mem::take(&mut self.hits);
        hits.clear();
        let (low, high) = match me.carrier {
            Carrier::Graph(c) => (c, c),
            Carrier::Vertical(a, b) => (a, b),
        };
        let mut end = |x, c, there| {
            hits.push(Hit {
                x,
                c,
                other: item,
                there,
                cross: NONE,
                vertex: NONE,
            });
        };
        if first {
            end(me.l, low, Place::Low);
        }
        if last {
            end(me.r, high, Place::High);
        }
        self.known_hits(item, &me, (first, from), (last, to), &mut hits);
        // Arcs on the same curve.
        let mut twins = Vec::new();
        for &b in near {
            let (s, e) = self.meet(item, b);
            let twin = match (me.carrier, self.items[b as usize].carrier) {
                (Carrier::Graph(c), Carrier::Graph(d)) => c == d,
                (Carrier::Vertical(..), Carrier::Vertical(..)) => s < e,
                _ => false,
            };
            if twin {
                twins.push(b);
            }
            for cross in s..e {
                let z = self.crosses[cross as usize];
                let inside = (first || self.cmp_cut(z.x, from).is_ge())
                    && (last || self.cmp_cut(z.x, to).is_lt());
                if inside {
                    hits.push(Hit {
                        x: z.x,
                        c: z.c,
                        other: b,
                        there: z.places[usize::from(item < b)],
                        cross,
                        vertex: z.vertex,
                    });
                }
            }
        }
        let vertical = matches!(me.carrier, Carrier::Vertical(..));
        if !vertical && hits.len() > MANY {
            self.presort(&mut hits);
        }
        let k = &mut *self.k;
        let mut order = |a: &Hit, b: &Hit| {
            if vertical {
                k.cmp_at(a.c, b.c, a.x)
            } else {
                k.cmp(a.x, b.x)
            }
        };
        hits.sort_by(&mut order);
        let start = self.stops.len();
        let mut at = 0;
        while at < hits.len() {
            let k = &mut *self.k;
            let mut end = at + 1;
            while end < hits.len()
                && if vertical {
                    k.cmp_at(hits[at].c, hits[end].c, me.l).is_eq()
                } else {
                    k.cmp(hits[at].x, hits[end].x).is_eq()
                }
            {
                end += 1;
            }
            let v = self.vertex_of(item, &hits[at..end]);
            // One walk need tell the others on a curve but once; where items have colours each sees others.
            let known = match me.carrier {
                Carrier::Graph(c) if me.color == 0 && !twins.is_empty() => {
                    self.told.insert((v, c), ()).is_some()
                }
                _ => false,
            };
            for &b in twins.iter().filter(|_| !known) {
                self.share(v, b, &hits[at..end]);
            }
            self.stops.push(v);
            at = end;
        }
        self.hits = hits;
        let w = &mut self.windows[w as usize];
        w.stops = start as u32;
        w.stop_count = (self.stops.len() - start) as u32;
    }

    /// Brings many hits nearly into order by what is known of their places in doubles: a sort that goes by exact
    /// order then hardly asks more than whether neighbours are in order.
    fn presort(&mut self, hits: &mut [Hit]) {
        // Neighbours are asked for once, so that those too near for doubles are seen from a frame.
        for i in 1..hits.len() {
            self.k.cmp(hits[i - 1].x, hits[i].x);
        }
        hits.sort_by_cached_key(|h| {
            let key = self.k.rough(h.x);
            key.map(|v| {
                // As `total_cmp` orders doubles.
                let bits = v.to_bits() as i64;
                bits ^ ((bits >> 63) as u64 >> 1) as i64
            })
        });
    }

    /// The vertex where an item has these hits, all at one point.
    fn vertex_of(&mut self, item: u32, hits: &[Hit]) -> u32 {
        let mut v = NONE;
        let mut here = Place::Inside;
        for h in hits {
            if h.other == item {
                here = h.there;
            }
            let other = &self.items[h.other as usize];
            let end = match h.there {
                Place::Low => other.vl,
                Place::High => other.vr,
                Place::Inside => NONE,
            };
            for w in [end, h.vertex] {
                if w != NONE {
                    v = if v == NONE {
                        self.find(w)
                    } else {
                        self.unite(v, w)
                    };
                }
            }
        }
        if v == NONE {
            v = self.vertices.len() as u32;
            self.vertices.push(Vertex::new(Point {
                x: hits[0].x,
                c: hits[0].c,
            }));
        }
        self.mark_linked(v);
        self.link_marked(v, item, here);
        for h in hits {
            self.link_marked(v, h.other, h.there);
            if h.cross != NONE {
                self.crosses[h.cross as usize].vertex = v;
            }
        }
        v
    }

    /// Tells a vertex on one item, whose items are marked, to a twin of it that passes over the same point, and to
    /// the pairs that the twin makes with the others there: overlapping arcs meet each other at their ends only.
    fn share(&mut self, v: u32, twin: u32, hits: &[Hit]) {
        let t = self.items[twin as usize];
        let place = match t.carrier {
            Carrier::Graph(_) => self.place(&t, hits[0].x),
            Carrier::Vertical(lo, hi) => self.place_between(lo, hi, hits[0].c, hits[0].x),
        };
        if place != Some(Place::Inside) {
            return;
        }
        self.link_marked(v, twin, Place::Inside);
        for h in hits {
            let other = &self.items[h.other as usize];
            let color = other.color;
            if h.other == twin || h.cross == NONE || color != 0 && color == t.color {
                continue;
            }
            // Where neither ends, two on one curve do not meet.
            let along = match (t.carrier, other.carrier) {
                (Carrier::Graph(c), Carrier::Graph(d)) => c == d,
                (Carrier::Vertical(..), Carrier::Vertical(..)) => true,
                _ => false,
            };
            if along && h.there == Place::Inside {
                continue;
            }
            let (s, e) = self.meet(twin, h.other);
            for cross in s..e {
                let z = self.crosses[cross as usize];
                let same = match t.carrier {
                    Carrier::Graph(_) => self.k.cmp(z.x, h.x).is_eq(),
                    Carrier::Vertical(..) => self.k.cmp_at(z.c, h.c, h.x).is_eq(),
                };
                if same {
                    self.crosses[cross as usize].vertex = v;
                }
            }
        }
    }

    // ----- stops -----

    /// The stop after (or before) position `at` of a leaf's stops.
    pub(super) fn stop_from(&mut self, item: u32, mut leaf: Leaf, at: usize, forward: bool) -> u32 {
        if forward {
            if at + 1 < leaf.to {
                return self.stops[at + 1];
            }
        } else if at > leaf.from {
            return self.stops[at - 1];
        }
        loop {
            leaf = self.leaf_beside(item, leaf, forward);
            if leaf.from < leaf.to {
                return self.stops[if forward { leaf.from } else { leaf.to - 1 }];
            }
        }
    }

    /// The next vertex along an item from one on it.
    pub(super) fn next_stop(&mut self, item: u32, v: u32, forward: bool) -> u32 {
        let me = self.items[item as usize];
        let leaf = if self.find(me.vl) == v {
            self.leaf_at_end(item, false)
        } else if self.find(me.vr) == v {
            self.leaf_at_end(item, true)
        } else {
            let x = self.vertices[v as usize].at.x;
            self.leaf_at(item, x)
        };
        let at = (leaf.from..leaf.to)
            .find(|&s| self.find(self.stops[s]) == v)
            .expect("a vertex on an arc is a stop of it");
        let w = self.stop_from(item, leaf, at, forward);
        self.find(w)
    }
}
