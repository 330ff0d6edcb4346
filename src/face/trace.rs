//! Walking round a face: from a vertex along an arc to the next vertex, and turn.
//!
//! The idea: the boundary cycle of one face needs no arrangement. Along an arc only the *stops* matter,
//! the points where another arc crosses, touches, ends or begins; they are found piece by piece from a
//! static index, only where the walk passes. At a stop all arcs through the point are known (each of
//! them meets this one there), so their germs can be sorted round it exactly, and the walk takes the
//! next one clockwise from where it came: the face stays on the left.
//!
//! Arcs come in colours. Nought: arcs about which nothing is known, all pairs are tested. One and up: the
//! edges of the faces that are merged; edges of one colour meet in common vertices only, which they name, so
//! only pairs of different colours are tested.

use super::approx::Approx;
use super::hash::FastMap;
use super::index::{Bounds, Tree};
use super::kernel::{CurveId, Kernel, NumId};
use std::cmp::Ordering;

pub(crate) const NONE: u32 = u32::MAX;

/// A point: a number on the u axis and a curve that passes over it there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) x: NumId,
    pub(crate) c: CurveId,
}

/// What an arc lies on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Carrier {
    /// The graph of a curve.
    Graph(CurveId),
    /// A line u = const, between the heights of two curves.
    Vertical(CurveId, CurveId),
}

/// An arc, or an edge of a face already found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub(crate) carrier: Carrier,
    /// Left and right end on the u axis; the same for verticals.
    pub(crate) l: NumId,
    pub(crate) r: NumId,
    /// The vertices at the left (or lower) and right (or upper) end.
    pub(crate) vl: u32,
    pub(crate) vr: u32,
    pub(crate) color: u8,
    /// The component of its colour that it belongs to.
    pub(crate) comp: u32,
    /// The arc of the input that it is part of.
    pub(crate) arc: u32,
    /// A box around it; `EMPTY` until it is asked for.
    pub(crate) bounds: Bounds,
}

/// A component of the input of a walk: where its leftmost (then lowest) point is, and an item that
/// starts there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Comp {
    pub(crate) vertex: u32,
    pub(crate) item: u32,
}

/// Where a point lies on an item.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Place {
    Inside,
    Low,
    High,
}

#[derive(Clone, Copy)]
struct Cross {
    x: NumId,
    /// A curve through the point, which orders points on verticals.
    c: CurveId,
    /// On the item with the smaller index, and on the other.
    places: [Place; 2],
    vertex: u32,
}

#[derive(Clone, Copy)]
struct Hit {
    x: NumId,
    c: CurveId,
    other: u32,
    there: Place,
    cross: u32,
}

#[derive(Clone, Copy)]
struct Link {
    item: u32,
    place: Place,
    next: u32,
}

#[derive(Clone, Copy)]
pub(super) struct Vertex {
    pub(super) at: Point,
    parent: u32,
    links: u32,
    germs: u32,
    germ_count: u32,
}

/// The direction in which a germ leaves its vertex.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Dir {
    Right,
    Up,
    Left,
    Down,
}

impl Dir {
    fn reverse(self) -> Dir {
        match self {
            Dir::Right => Dir::Left,
            Dir::Left => Dir::Right,
            Dir::Up => Dir::Down,
            Dir::Down => Dir::Up,
        }
    }
    /// Whether the walk goes from the low to the high end.
    fn forward(self) -> bool {
        matches!(self, Dir::Right | Dir::Up)
    }
}

#[derive(Clone, Copy)]
pub(super) struct Germ {
    pub(super) item: u32,
    pub(super) dir: Dir,
    /// The edge that leaves forward here, once it was traced.
    pub(super) edge: u32,
    /// Whether the sector that follows counter-clockwise was found to lie in the face.
    open: bool,
}

/// An edge of the face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) item: u32,
    pub(crate) low: u32,
    pub(crate) high: u32,
    /// Whether the face lies above (left of the way from low to high) and below.
    pub(crate) above: bool,
    pub(crate) below: bool,
    pub(crate) cycle: u32,
}

/// A boundary cycle of the face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cycle {
    pub(crate) leftmost: u32,
    pub(crate) half_edges: u32,
    /// Whether the face lies outside of it.
    pub(crate) hole: bool,
}

struct Piece {
    from: f64,
    to: f64,
    bounds: Bounds,
    stops: u32,
    stop_count: u32,
}

/// The start lies on an arc, so no face holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OnArc(pub(crate) u32);

/// Where a ray down ends.
struct Ray {
    /// The item hit, and a curve through the point.
    below: Option<(u32, CurveId)>,
    /// An item through the ray's own begin that does not begin there itself.
    through: Option<u32>,
    /// An item that begins there.
    beside: Option<u32>,
}

/// One walk: its items, what was found about them so far, and the boundary traced.
pub(crate) struct Tracer<'a> {
    pub(super) k: &'a mut Kernel,
    pub(super) items: &'a [Item],
    comps: &'a [Comp],
    pieces: Vec<Piece>,
    first_piece: Vec<u32>,
    tree: Tree,
    boxes: Vec<Bounds>,
    pub(super) vertices: Vec<Vertex>,
    links: Vec<Link>,
    pub(super) germs: Vec<Germ>,
    stops: Vec<u32>,
    pairs: FastMap<(u32, u32), (u32, u32)>,
    crosses: Vec<Cross>,
    stamp: Vec<u32>,
    serial: u32,
    hits: Vec<Hit>,
    near: Vec<u32>,
    numbers: Vec<NumId>,
    pub(super) edges: Vec<Edge>,
    pub(super) cycles: Vec<Cycle>,
    /// Components whose boundary was traced.
    pub(super) touched: Vec<bool>,
    pub(super) unbounded: bool,
}

impl<'a> Tracer<'a> {
    /// Indexes the items. The vertices are those that items name as their ends.
    pub(crate) fn new(
        k: &'a mut Kernel,
        items: &'a [Item],
        comps: &'a [Comp],
        ends: impl Iterator<Item = Point>,
    ) -> Tracer<'a> {
        let free = |at| Vertex {
            at,
            parent: NONE,
            links: NONE,
            germs: NONE,
            germ_count: 0,
        };
        let mut t = Tracer {
            k,
            items,
            comps,
            pieces: Vec::with_capacity(items.len() * 2),
            first_piece: Vec::with_capacity(items.len() + 1),
            tree: Tree::default(),
            boxes: Vec::new(),
            vertices: ends.map(free).collect(),
            links: Vec::with_capacity(items.len() * 2),
            germs: Vec::new(),
            stops: Vec::new(),
            pairs: FastMap::default(),
            crosses: Vec::new(),
            stamp: vec![0; items.len()],
            serial: 0,
            hits: Vec::new(),
            near: Vec::new(),
            numbers: Vec::new(),
            edges: Vec::new(),
            cycles: Vec::new(),
            touched: vec![false; comps.len()],
            unbounded: false,
        };
        t.cut();
        for (i, item) in items.iter().enumerate() {
            t.link(item.vl, i as u32, Place::Low);
            t.link(item.vr, i as u32, Place::High);
        }
        t
    }

    /// Cuts the items into pieces, more where they are long, about four an item in all, and packs them.
    fn cut(&mut self) {
        let known = |i: &Item| {
            if i.bounds[0] <= i.bounds[1] {
                i.bounds
            } else {
                self.box_of(i)
            }
        };
        let spans: Vec<Bounds> = self.items.iter().map(known).collect();
        // Long compared with what lies between the outer tenths of all arcs.
        let extent = |axis: usize| {
            let mut ends: Vec<f64> = spans
                .iter()
                .flat_map(|b| [b[axis], b[axis + 1]])
                .filter(|x| x.is_finite())
                .collect();
            let n = ends.len();
            if n < 2 {
                return (0.0, 0.0, 1.0);
            }
            let (i, j) = (n / 10, n - 1 - n / 10);
            let lo = *ends.select_nth_unstable_by(i, f64::total_cmp).1;
            let hi = *ends.select_nth_unstable_by(j, f64::total_cmp).1;
            (lo, hi, if hi > lo { 1.0 / (hi - lo) } else { 0.0 })
        };
        let (u, t) = (extent(0), extent(2));
        let length = |b: &Bounds| {
            let part =
                |lo: f64, hi: f64, e: (f64, f64, f64)| (hi.min(e.1) - lo.max(e.0)).max(0.0) * e.2;
            part(b[0], b[1], u) + part(b[2], b[3], t)
        };
        let total: f64 = spans.iter().map(length).sum();
        let per = if total > 0.0 {
            1.0 * spans.len() as f64 / total
        } else {
            0.0
        };
        let mut entries = Vec::new();
        for (i, item) in self.items.iter().enumerate() {
            self.first_piece.push(self.pieces.len() as u32);
            let b = &spans[i];
            let n = match item.carrier {
                Carrier::Vertical(..) => 1,
                Carrier::Graph(_) => 1 + ((length(b) * per) as usize).min(31),
            };
            let mut from = b[0];
            for p in 1..=n {
                let to = if p == n {
                    b[1]
                } else {
                    b[0] + (b[1] - b[0]) * (p as f64 / n as f64)
                };
                let to = to.max(from).min(b[1]);
                let bounds = match item.carrier {
                    Carrier::Graph(c) if n > 1 => {
                        let (lo, hi) = self.k.range(c, from, to);
                        [from, to, lo, hi]
                    }
                    _ => *b,
                };
                entries.push((bounds, i as u32));
                self.pieces.push(Piece {
                    from,
                    to,
                    bounds,
                    stops: NONE,
                    stop_count: 0,
                });
                from = to;
            }
        }
        self.first_piece.push(self.pieces.len() as u32);
        self.tree = Tree::new(entries);
        self.boxes = spans;
    }

    fn box_of(&self, item: &Item) -> Bounds {
        let (a, b) = (self.k.enclosure(item.l).0, self.k.enclosure(item.r).1);
        match item.carrier {
            Carrier::Graph(c) => {
                let (lo, hi) = self.k.range(c, a, b);
                [a, b, lo, hi]
            }
            Carrier::Vertical(lo, hi) => {
                let (lo, hi) = (self.k.height(lo, item.l), self.k.height(hi, item.l));
                let known = [lo, hi].iter().all(|t| t.v.is_finite() && t.e.is_finite());
                if known {
                    [a, b, lo.lo().min(hi.lo()), lo.hi().max(hi.hi())]
                } else {
                    [a, b, f64::NEG_INFINITY, f64::INFINITY]
                }
            }
        }
    }

    /// The box of a whole item.
    pub(super) fn bounds(&self, item: u32) -> Bounds {
        self.boxes[item as usize]
    }

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
        let mut at = self.vertices[drop as usize].links;
        while at != NONE {
            let link = self.links[at as usize];
            self.link(keep, link.item, link.place);
            at = link.next;
        }
        keep
    }

    fn link(&mut self, v: u32, item: u32, place: Place) {
        let vertex = &self.vertices[v as usize];
        let (known, mut at) = (vertex.germs != NONE, vertex.links);
        let head = at;
        if known {
            return;
        }
        while at != NONE {
            let link = &self.links[at as usize];
            if link.item == item {
                debug_assert_eq!(link.place, place);
                return;
            }
            at = link.next;
        }
        self.vertices[v as usize].links = self.links.len() as u32;
        self.links.push(Link {
            item,
            place,
            next: head,
        });
    }

    /// Lexicographic order of two points.
    pub(super) fn cmp_points(&mut self, p: Point, q: Point) -> Ordering {
        match self.k.cmp(p.x, q.x) {
            Ordering::Equal => self.k.cmp_at(p.c, q.c, p.x),
            o => o,
        }
    }

    // ----- pairs -----

    /// The common points of two items, as a range of `crosses`.
    fn meet(&mut self, a: u32, b: u32) -> (u32, u32) {
        let (a, b) = (a.min(b), a.max(b));
        if let Some(&r) = self.pairs.get(&(a, b)) {
            return r;
        }
        let from = self.crosses.len() as u32;
        let (i, j) = (self.items[a as usize], self.items[b as usize]);
        match (i.carrier, j.carrier) {
            (Carrier::Graph(c), Carrier::Graph(d)) if c == d => self.overlap(&i, &j, c),
            (Carrier::Graph(c), Carrier::Graph(d)) => self.cross(&i, &j, c, d),
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
    fn place(&mut self, item: &Item, x: NumId) -> Option<Place> {
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
    fn cross(&mut self, i: &Item, j: &Item, c: CurveId, d: CurveId) {
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
    fn place_between(&mut self, lo: CurveId, hi: CurveId, c: CurveId, x: NumId) -> Option<Place> {
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

    // ----- stops -----

    /// The stops on a piece, in order from low to high, as a range of `stops`; made when first asked for.
    fn stops_on(&mut self, item: u32, piece: u32) -> (usize, usize) {
        let p = &self.pieces[piece as usize];
        if p.stops != NONE {
            return (p.stops as usize, (p.stops + p.stop_count) as usize);
        }
        let (bounds, from, to) = (p.bounds, p.from, p.to);
        let me = self.items[item as usize];
        let first = piece == self.first_piece[item as usize];
        let last = piece + 1 == self.first_piece[item as usize + 1];
        let mut hits = std::mem::take(&mut self.hits);
        let mut near = std::mem::take(&mut self.near);
        hits.clear();
        near.clear();
        let (low, high) = match me.carrier {
            Carrier::Graph(c) => (c, c),
            Carrier::Vertical(a, b) => (a, b),
        };
        if first {
            hits.push(Hit {
                x: me.l,
                c: low,
                other: item,
                there: Place::Low,
                cross: NONE,
            });
        }
        if last {
            hits.push(Hit {
                x: me.r,
                c: high,
                other: item,
                there: Place::High,
                cross: NONE,
            });
        }
        self.serial += 1;
        self.stamp[item as usize] = self.serial;
        let (stamp, serial) = (&mut self.stamp, self.serial);
        let items = self.items;
        self.tree.query(&bounds, |b| {
            // Edges of one colour meet at common vertices only.
            let foreign = me.color == 0 || items[b as usize].color != me.color;
            if foreign && stamp[b as usize] != serial {
                stamp[b as usize] = serial;
                near.push(b);
            }
        });
        // Arcs on the same curve.
        let mut twins = Vec::new();
        for &b in &near {
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
                    });
                }
            }
        }
        let k = &mut *self.k;
        let vertical = matches!(me.carrier, Carrier::Vertical(..));
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
        self.near = near;
        let p = &mut self.pieces[piece as usize];
        p.stops = start as u32;
        p.stop_count = (self.stops.len() - start) as u32;
        (start, self.stops.len())
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
            let bound = if h.cross == NONE {
                NONE
            } else {
                self.crosses[h.cross as usize].vertex
            };
            for w in [end, bound] {
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
            let at = Point {
                x: hits[0].x,
                c: hits[0].c,
            };
            self.vertices.push(Vertex {
                at,
                parent: NONE,
                links: NONE,
                germs: NONE,
                germ_count: 0,
            });
        }
        self.link(v, item, here);
        for h in hits {
            self.link(v, h.other, h.there);
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
        self.link(v, twin, Place::Inside);
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

    /// The germs of a boundary vertex all of whose arcs are known, counter-clockwise from straight down, as a range
    /// of `germs`.
    pub(super) fn germs_of(&mut self, v: u32) -> (usize, usize) {
        let vertex = self.vertices[v as usize];
        if vertex.germs != NONE {
            return (
                vertex.germs as usize,
                (vertex.germs + vertex.germ_count) as usize,
            );
        }
        let mut rights: Vec<(CurveId, u32)> = Vec::new();
        let mut lefts: Vec<(CurveId, u32)> = Vec::new();
        let (mut up, mut down) = (NONE, NONE);
        let mut at = vertex.links;
        while at != NONE {
            let Link { item, place, next } = self.links[at as usize];
            at = next;
            self.touched[self.items[item as usize].comp as usize] = true;
            match self.items[item as usize].carrier {
                Carrier::Graph(c) => {
                    if place != Place::High {
                        rights.push((c, item));
                    }
                    if place != Place::Low {
                        lefts.push((c, item));
                    }
                }
                Carrier::Vertical(..) => {
                    if place != Place::High {
                        up = up.min(item);
                    }
                    if place != Place::Low {
                        down = down.min(item);
                    }
                }
            }
        }
        let x = vertex.at.x;
        let k = &mut *self.k;
        for (germs, right) in [(&mut rights, true), (&mut lefts, false)] {
            if germs.len() > 1 {
                // Overlapping arcs are one germ, told by its first item.
                germs.sort_by(|a, b| k.cmp_beside(a.0, b.0, x, right).then(a.1.cmp(&b.1)));
                germs.dedup_by_key(|g| g.0);
            }
        }
        let from = self.germs.len();
        let mut push = |item, dir| {
            self.germs.push(Germ {
                item,
                dir,
                edge: NONE,
                open: false,
            })
        };
        if down != NONE {
            push(down, Dir::Down);
        }
        rights.iter().for_each(|g| push(g.1, Dir::Right));
        if up != NONE {
            push(up, Dir::Up);
        }
        lefts.iter().rev().for_each(|g| push(g.1, Dir::Left));
        let to = self.germs.len();
        let vertex = &mut self.vertices[v as usize];
        vertex.germs = from as u32;
        vertex.germ_count = (to - from) as u32;
        (from, to)
    }

    /// The germ of a visited vertex that leaves along an item.
    fn germ_along(&mut self, v: u32, item: u32, dir: Dir) -> usize {
        let (from, to) = self.germs_of(v);
        let carrier = self.items[item as usize].carrier;
        let same = |other: u32| {
            other == item
                || match (carrier, self.items[other as usize].carrier) {
                    (Carrier::Graph(c), Carrier::Graph(d)) => c == d,
                    (Carrier::Vertical(..), Carrier::Vertical(..)) => true,
                    _ => false,
                }
        };
        (from..to)
            .find(|&g| self.germs[g].dir == dir && same(self.germs[g].item))
            .expect("an arc through a vertex has a germ there")
    }

    /// The piece of an item that holds a number of its range.
    fn piece_at(&mut self, item: u32, x: NumId) -> u32 {
        let (mut lo, mut hi) = (
            self.first_piece[item as usize],
            self.first_piece[item as usize + 1] - 1,
        );
        while lo < hi {
            let mid = lo.midpoint(hi);
            if self.k.cmp_double(x, self.pieces[mid as usize].to).is_lt() {
                hi = mid
            } else {
                lo = mid + 1
            }
        }
        lo
    }

    /// The stop after (or before) position `at` of a piece's stops.
    fn stop_from(&mut self, item: u32, mut piece: u32, at: usize, forward: bool) -> u32 {
        let (from, to) = self.stops_on(item, piece);
        if forward {
            if at + 1 < to {
                return self.stops[at + 1];
            }
            loop {
                piece += 1;
                debug_assert!(
                    piece < self.first_piece[item as usize + 1],
                    "an arc ends in a stop"
                );
                let (from, to) = self.stops_on(item, piece);
                if from < to {
                    return self.stops[from];
                }
            }
        }
        if at > from {
            return self.stops[at - 1];
        }
        loop {
            debug_assert!(
                piece > self.first_piece[item as usize],
                "an arc begins in a stop"
            );
            piece -= 1;
            let (from, to) = self.stops_on(item, piece);
            if from < to {
                return self.stops[to - 1];
            }
        }
    }

    /// The next vertex along an item from one on it.
    fn next_stop(&mut self, item: u32, v: u32, forward: bool) -> u32 {
        let me = self.items[item as usize];
        let (first, last) = (
            self.first_piece[item as usize],
            self.first_piece[item as usize + 1] - 1,
        );
        let piece = if self.find(me.vl) == v {
            first
        } else if self.find(me.vr) == v {
            last
        } else {
            let x = self.vertices[v as usize].at.x;
            self.piece_at(item, x)
        };
        let (from, to) = self.stops_on(item, piece);
        let at = (from..to)
            .find(|&s| self.find(self.stops[s]) == v)
            .expect("a vertex on an arc is a stop of it");
        let w = self.stop_from(item, piece, at, forward);
        self.find(w)
    }

    // ----- cycles -----

    /// Walks the boundary that leaves `v` by a germ with the face on the left, until it closes.
    fn trace(&mut self, v0: u32, g0: usize) {
        let cycle = self.cycles.len() as u32;
        let (mut v, mut g) = (v0, g0);
        let (mut leftmost, mut hole, mut count) = (NONE, false, 0);
        loop {
            let Germ { item, dir, .. } = self.germs[g];
            let w = self.next_stop(item, v, dir.forward());
            // The item may not know yet who passes through w; its stops do now.
            let back = self.germ_along(w, item, dir.reverse());
            let (slot, low, high) = if dir.forward() {
                (g, v, w)
            } else {
                (back, w, v)
            };
            let mut edge = self.germs[slot].edge;
            if edge == NONE {
                edge = self.edges.len() as u32;
                self.germs[slot].edge = edge;
                self.edges.push(Edge {
                    item,
                    low,
                    high,
                    above: false,
                    below: false,
                    cycle,
                });
            }
            let e = &mut self.edges[edge as usize];
            let side = if dir.forward() {
                &mut e.above
            } else {
                &mut e.below
            };
            debug_assert!(!*side, "a side of an edge was walked twice");
            *side = true;
            count += 1;
            let (from, to) = self.germs_of(w);
            let turn = if back == from { to - 1 } else { back - 1 };
            self.germs[turn].open = true;
            if self.germs[back].dir.forward() && self.germs[turn].dir.forward() {
                // Both edges of the corner lie to the right: perhaps the leftmost one.
                let order = if leftmost == NONE {
                    Ordering::Greater
                } else if leftmost == w {
                    Ordering::Equal
                } else {
                    self.cmp_points(
                        self.vertices[leftmost as usize].at,
                        self.vertices[w as usize].at,
                    )
                };
                // A corner that wraps round the first germ looks to the left.
                let wraps = back == from;
                match order {
                    Ordering::Greater => (leftmost, hole) = (w, wraps),
                    Ordering::Equal => hole |= wraps,
                    Ordering::Less => {}
                }
            }
            (v, g) = (w, turn);
            if v == v0 && g == g0 {
                break;
            }
        }
        self.cycles.push(Cycle {
            leftmost,
            half_edges: count,
            hole,
        });
    }

    /// Traces the component that begins at a vertex with nothing to the left of it.
    pub(super) fn trace_island(&mut self, comp: u32) {
        let Comp { item, .. } = self.comps[comp as usize];
        let piece = self.first_piece[item as usize];
        let (from, _) = self.stops_on(item, piece);
        let v = self.find(self.stops[from]);
        let (_, to) = self.germs_of(v);
        self.trace(v, to - 1);
    }

    /// The point where a component begins.
    pub(super) fn begin_of(&self, comp: u32) -> Point {
        self.vertices[self.comps[comp as usize].vertex as usize].at
    }

    /// Finds the outer boundary, if there is one, and what lies below the start: rays down from component
    /// to component, each of which begins further left.
    pub(crate) fn outline(&mut self, start: Point) -> Result<(), OnArc> {
        let mut from = start;
        loop {
            let ray = self.ray_down(from);
            if let Some(on) = ray.through.or(ray.beside)
                && self.cycles.is_empty()
            {
                return Err(OnArc(self.items[on as usize].arc));
            }
            let Some((item, _)) = ray.below else {
                self.unbounded = true;
                return Ok(());
            };
            let (v, g) = self
                .germ_below(item, from.x, true)
                .expect("every germ is made when asked for");
            self.trace(v, g);
            let cycle = self.cycles[self.cycles.len() - 1];
            if !cycle.hole {
                return Ok(());
            }
            from = self.vertices[cycle.leftmost as usize].at;
        }
    }

    /// Whether the begin of an untouched component lies in the face, all components that begin before
    /// it having been settled.
    pub(super) fn opens_into_face(&mut self, p: Point) -> bool {
        let ray = self.ray_down(p);
        if ray.through.is_some() {
            // It hangs on a component that began earlier and is not in the face.
            return false;
        }
        let Some((item, _)) = ray.below else {
            return self.unbounded;
        };
        self.touched[self.items[item as usize].comp as usize]
            && self
                .germ_below(item, p.x, false)
                .is_some_and(|(_, g)| self.germs[g].open)
    }

    /// What lies next below a point.
    fn ray_down(&mut self, p: Point) -> Ray {
        let tree = std::mem::take(&mut self.tree);
        let (a, b) = self.k.enclosure(p.x);
        let height = self.k.height(p.c, p.x);
        let ceiling = if height.hi().is_nan() {
            f64::INFINITY
        } else {
            height.hi()
        };
        let floor = std::cell::Cell::new(f64::NEG_INFINITY);
        let mut best: Option<(u32, CurveId, Approx)> = None;
        let (mut through, mut beside) = (None, None);
        {
            tree.descend(
                |n| n[0] <= b && a <= n[1] && n[2] <= ceiling && n[3] >= floor.get(),
                |i| {
                    let item = self.items[i as usize];
                    let Some(place) = self.place(&item, p.x) else {
                        return;
                    };
                    let (low, high) = match item.carrier {
                        Carrier::Graph(c) => (c, c),
                        Carrier::Vertical(lo, hi) => (lo, hi),
                    };
                    let at = self.k.height(high, p.x);
                    let order = match (at - height).sign() {
                        Some(s) if s != 0 => s.cmp(&0),
                        _ => self.k.cmp_at(high, p.c, p.x),
                    };
                    if order.is_lt() {
                        let higher = match best {
                            None => true,
                            Some((_, o, t)) => match (at - t).sign() {
                                Some(s) if s != 0 => s > 0,
                                _ => self.k.cmp_at(high, o, p.x).is_gt(),
                            },
                        };
                        if higher {
                            best = Some((i, high, at));
                            floor.set(if at.lo().is_nan() {
                                f64::NEG_INFINITY
                            } else {
                                at.lo()
                            });
                        }
                        return;
                    }
                    let (begins, on) = match item.carrier {
                        Carrier::Graph(_) => (place == Place::Low, order.is_eq()),
                        Carrier::Vertical(..) => {
                            let o = self.k.cmp_at(low, p.c, p.x);
                            (o.is_eq(), o.is_le())
                        }
                    };
                    if on {
                        *(if begins { &mut beside } else { &mut through }) = Some(i);
                    }
                },
            );
        }
        self.tree = tree;
        Ray {
            below: best.map(|(i, c, _)| (i, c)),
            through,
            beside,
        }
    }

    /// The germ whose following sector holds the points just above an item's point over x: its vertex and
    /// place. Without `visit`, None where that vertex was not visited yet.
    fn germ_below(&mut self, below: u32, x: NumId, visit: bool) -> Option<(u32, usize)> {
        let item = self.items[below as usize];
        let mut hit = NONE;
        let mut left = NONE;
        match item.carrier {
            Carrier::Vertical(..) => {
                let (_, to) = self.stops_on(below, self.first_piece[below as usize]);
                hit = self.find(self.stops[to - 1]);
            }
            Carrier::Graph(_) => {
                let piece = self.piece_at(below, x);
                let (mut at, to) = self.stops_on(below, piece);
                while at < to && hit == NONE {
                    let y = self.find(self.stops[at]);
                    match self.k.cmp(self.vertices[y as usize].at.x, x) {
                        Ordering::Less => at += 1,
                        Ordering::Equal => hit = y,
                        Ordering::Greater => break,
                    }
                }
                if hit == NONE {
                    left = self.stop_from(below, piece, at, false);
                    left = self.find(left);
                }
            }
        }
        let v = if hit == NONE { left } else { hit };
        if !visit && self.vertices[v as usize].germs == NONE {
            return None;
        }
        if hit == NONE {
            return Some((v, self.germ_along(v, below, Dir::Right)));
        }
        let (from, to) = self.germs_of(v);
        // The last germ before straight up.
        let g = (from..to)
            .rev()
            .find(|&g| matches!(self.germs[g].dir, Dir::Right | Dir::Down))
            .unwrap_or(to - 1);
        Some((v, g))
    }
}
