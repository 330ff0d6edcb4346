//! Where a walk may stop: the vertices along an item, found only where the walk passes.
//!
//! The idea: an item's range is halved into windows, lazily, until few others may meet it inside one; then all
//! that do are found, sorted and named. So a walk that uses a short end of a long arc pays for what is near that
//! end. The limit grows with the square of the depth: about a common point of many arcs no
//! window is ever empty, and halving must end there too. (Where many are known to pass near one another, that part
//! is cut out and not halved.)
//!
//! A vertex knows all its arcs once its window is made, since each of them meets the item there.

use super::bands::Bands;
use super::item::{Carrier, Item, NONE, Place, Point};
use super::kernel::{CurveId, NumId};
use super::pencil::Pencil;
use super::trace::Tracer;
use crate::geometry::index::Hull;
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

/// A part of an item's range, `to` excluded unless it is the item's end. Item i's whole range is window i.
#[derive(Clone, Copy)]
pub(super) struct Window {
    pub(super) from: f64,
    pub(super) to: f64,
    /// Its two halves, where it was halved.
    kids: u32,
    stops: u32,
    stop_count: u32,
}

impl Window {
    pub(super) fn new(from: f64, to: f64) -> Window {
        Window {
            from,
            to,
            kids: NONE,
            stops: NONE,
            stop_count: 0,
        }
    }
}

/// How many others a window at this depth may have before it is halved.
fn crowd(depth: usize) -> usize {
    if depth < DEEPEST {
        16 + depth * depth / 8
    } else {
        usize::MAX
    }
}

/// Past this many halvings a window takes whatever is there.
const DEEPEST: usize = 24;

/// More hits than this are brought roughly into order first.
const MANY: usize = 24;

/// How many items a search may find in vain, on average, before bands are made; and how many in all before that
/// is asked.
const VAIN: u64 = 16;
const PATIENT: u64 = 4096;

/// A window whose stops are known, and those as a range of `stops`.
#[derive(Clone, Copy)]
pub(super) struct Leaf {
    pub(super) window: u32,
    pub(super) from: usize,
    pub(super) to: usize,
}

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

    // ----- windows -----

    /// The leaf of an item's windows on the path that `right` tells at each cut; made when first asked for.
    fn leaf(&mut self, item: u32, mut right: impl FnMut(&mut Self, f64) -> bool) -> Leaf {
        let (mut w, mut depth) = (item, 0);
        loop {
            let window = self.windows[w as usize];
            if window.kids != NONE {
                let mid = self.windows[window.kids as usize].to;
                w = window.kids + u32::from(right(self, mid));
                depth += 1;
                continue;
            }
            if window.stops != NONE {
                let from = window.stops as usize;
                return Leaf {
                    window: w,
                    from,
                    to: from + window.stop_count as usize,
                };
            }
            self.open(item, w, depth);
        }
    }

    /// The leaf that holds a number of the item's range.
    pub(super) fn leaf_at(&mut self, item: u32, x: NumId) -> Leaf {
        self.leaf(item, |t, mid| t.k.cmp_double(x, mid).is_ge())
    }

    /// The leaf at the low end of an item, or at its high end.
    pub(super) fn leaf_at_end(&mut self, item: u32, high: bool) -> Leaf {
        self.leaf(item, |_, _| high)
    }

    /// The leaf next to another one.
    fn leaf_beside(&mut self, item: u32, leaf: Leaf, forward: bool) -> Leaf {
        let Window { from, to, .. } = self.windows[leaf.window as usize];
        debug_assert!(
            if forward {
                to < self.windows[item as usize].to
            } else {
                from > self.windows[item as usize].from
            },
            "an arc ends in a stop"
        );
        self.leaf(item, |_, mid| if forward { to >= mid } else { from > mid })
    }

    /// Halves a window, or finds its stops.
    fn open(&mut self, item: u32, w: u32, depth: usize) {
        let Window { from, to, .. } = self.windows[w as usize];
        let me = self.items[item as usize];
        // What is crowded is cut out in two steps instead of ever smaller halves around it.
        let mid = match self.pencil(item).and_then(|p| p.1.crowded()) {
            Some((a, _)) if from < a && a < to => a,
            Some((_, b)) if from < b && b < to => b,
            Some((a, b)) if a <= from && to <= b => to,
            _ => from + (to - from) * 0.5,
        };
        let (hull, most) = match me.carrier {
            Carrier::Graph(c) => (
                self.k.hull(c, from, to),
                if from < mid && mid < to && self.parts(&me, mid) {
                    crowd(depth)
                } else {
                    usize::MAX
                },
            ),
            Carrier::Vertical(..) => (Hull::boxed(me.bounds), usize::MAX),
        };
        let mut near = std::mem::take(&mut self.near);
        if self.gather(item, &hull, most, &mut near) {
            self.stop(item, w, &near);
            // As many different points in so small a window: not one point that many pass through.
            let Window {
                stops, stop_count, ..
            } = self.windows[w as usize];
            if depth >= DEEPEST
                && stop_count as usize > crowd(DEEPEST - 1)
                && self.pencil(item).is_none()
            {
                let middle = self.stops[(stops + stop_count / 2) as usize];
                let middle = self.vertices[middle as usize].at.x;
                self.gather_cluster(item, self.k.enclosure(middle).0, to - from, &near);
            }
        } else {
            let kids = self.windows.len() as u32;
            self.windows.push(Window::new(from, mid));
            self.windows.push(Window::new(mid, to));
            self.windows[w as usize].kids = kids;
        }
        self.near = near;
    }

    /// Whether a cut surely lies between the ends of an item, l < mid ≤ r. The ends belong to its outermost
    /// windows without a test, so whatever else happens at an end must belong there too: the item that is
    /// hardly wider than the enclosures of its ends cannot be halved.
    fn parts(&self, item: &Item, mid: f64) -> bool {
        self.k.enclosure(item.l).1 < mid && mid <= self.k.enclosure(item.r).0
    }

    /// The items that may meet this one inside a hull; false as soon as there are more than `most`.
    fn gather(&mut self, item: u32, hull: &Hull, most: usize, near: &mut Vec<u32>) -> bool {
        near.clear();
        let range = (hull.bounds[0], hull.bounds[1]);
        let mut pencil = self.pencil(item);
        if let Some(crowd) = pencil.and_then(|p| p.1.crowd_in(range.0, range.1)) {
            if crowd > most {
                return false;
            }
            pencil = None;
        }
        let innermost = pencil.map_or(NONE, |p| p.0);
        let outermost = pencil.map_or(NONE, |p| p.1.root);
        self.serial += 1;
        let serial = self.serial;
        self.stamp[item as usize] = serial;
        let mut stamp = std::mem::take(&mut self.stamp);
        let (items, k) = (self.items, &*self.k);
        let me = &items[item as usize];
        let busy = self.busy.get(&item);
        let (mut few, mut tests, mut wasted) = (true, 0, 0);
        let mut consider = |b: u32| {
            if stamp[b as usize] == serial {
                return true;
            }
            stamp[b as usize] = serial;
            tests += 1;
            let other = &items[b as usize];
            // Edges of one colour meet at common vertices only.
            if me.color != 0 && other.color == me.color {
                return true;
            }
            if let (Carrier::Graph(c), Carrier::Graph(d)) = (me.carrier, other.carrier)
                && c != d
            {
                let lo = hull.bounds[0].max(k.enclosure(other.l).0);
                let hi = hull.bounds[1].min(k.enclosure(other.r).1);
                let vain = lo > hi
                    || match self.pencils.get(self.common_pencil(item, b) as usize) {
                        Some(shared) => k.miss_beside(c, d, lo, hi, shared.known()),
                        None => {
                            k.miss(c, d, lo, hi)
                                || busy.is_some_and(|mine| self.only_there(mine, b, (c, d), lo, hi))
                        }
                    };
                if vain {
                    wasted += 1;
                    return true;
                }
            }
            near.push(b);
            few = near.len() <= most;
            few
        };
        let (mut inner, mut p) = (NONE, innermost);
        while let (Some(pencil), Carrier::Graph(c)) = (self.pencils.get(p as usize), me.carrier) {
            pencil.query(k, c, range, |b| {
                inner != NONE && self.in_pencil(b, inner) || consider(b)
            });
            (inner, p) = (p, pencil.parent);
        }
        let outer = self.pencils.get(outermost as usize);
        if let Some(Pencil {
            rest: Some(rest), ..
        }) = outer
        {
            rest.query(hull, &mut consider);
        } else {
            let (bands, entries) = (&self.bands, self.tree.entries());
            let wanted = |at: usize, node: &Hull| {
                !node.apart(hull)
                    && match me.carrier {
                        Carrier::Graph(c) if at >= entries && !bands.is_empty() => {
                            let from = node.bounds[0].max(hull.bounds[0]);
                            let to = node.bounds[1].min(hull.bounds[1]);
                            !bands.apart(k, at, c, from, to)
                        }
                        _ => true,
                    }
            };
            self.tree.descend(wanted, |b| {
                outermost != NONE && self.in_pencil(b, outermost) || consider(b)
            });
        }
        self.stamp = stamp;
        self.tests += tests;
        self.wasted += wasted;
        if self.bands.is_empty() && self.wasted > VAIN * u64::from(serial) + PATIENT {
            self.bands = Bands::new(self.k, self.items, &self.tree);
        }
        few
    }

    /// Whether an item through the vertices `mine` surely meets another over [lo, hi] only in those that both
    /// pass through.
    fn only_there(
        &self,
        mine: &[u32],
        other: u32,
        (c, d): (CurveId, CurveId),
        lo: f64,
        hi: f64,
    ) -> bool {
        let Some(theirs) = self.busy.get(&other) else {
            return false;
        };
        let known: Vec<(NumId, usize)> = mine
            .iter()
            .filter(|v| theirs.contains(v))
            .map(|&v| {
                let x = self.vertices[v as usize].at.x;
                (x, self.k.contact(c, d, x))
            })
            .collect();
        !known.is_empty() && self.k.miss_beside(c, d, lo, hi, &known)
    }

    /// The remembered vertices inside an item, as hits on a window.
    fn known_hits(
        &mut self,
        item: u32,
        me: &Item,
        (first, from): (bool, f64),
        (last, to): (bool, f64),
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
                && (first || self.k.cmp_double(at.x, from).is_ge())
                && (last || self.k.cmp_double(at.x, to).is_lt())
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
    fn stop(&mut self, item: u32, w: u32, near: &[u32]) {
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
                let inside = (first || self.k.cmp_double(z.x, from).is_ge())
                    && (last || self.k.cmp_double(z.x, to).is_lt());
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
            for &b in &twins {
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

    /// Tells a vertex on one item to a twin of it that passes over the same point, and to the pairs that the
    /// twin makes with the others there: overlapping arcs meet each other at their ends only.
    fn share(&mut self, v: u32, twin: u32, hits: &[Hit]) {
        let t = self.items[twin as usize];
        let place = match t.carrier {
            Carrier::Graph(_) => self.place(&t, hits[0].x),
            Carrier::Vertical(lo, hi) => self.place_between(lo, hi, hits[0].c, hits[0].x),
        };
        if place != Some(Place::Inside) {
            return;
        }
        self.mark_linked(v);
        self.link_marked(v, twin, Place::Inside);
        for h in hits {
            let color = self.items[h.other as usize].color;
            if h.other == twin || h.cross == NONE || color != 0 && color == t.color {
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
