//! Walking round a face: from a vertex along an arc to the next vertex, and turn.
//!
//! The idea: the boundary cycle of one face needs no arrangement. Along an arc only the *stops* matter,
//! the points where another arc crosses, touches, ends or begins (`stops.rs`). At a stop all arcs through the
//! point are known, so their germs can be sorted round it exactly, and the walk takes the
//! next one clockwise from where it came: the face stays on the left.
//!
//! Arcs come in colours. Nought: arcs about which nothing is known, all pairs are tested. One and up: the
//! edges of the faces that are merged; edges of one colour meet in common vertices only, which they name, so
//! only pairs of different colours are tested.

use super::approx::Approx;
use super::bands::Bands;
use super::cluster::Fan;
use super::hash::FastMap;
pub(crate) use super::hulls::hull_of;
use super::hulls::index;
use super::item::Place;
pub(crate) use super::item::{Carrier, Comp, Item, NONE, Point};
use super::kernel::{CurveId, Kernel, NumId};
use super::meet::Cross;
use super::pencil::Pencil;
use super::stops::{Hit, Link, Vertex};
use super::windows::{Cut, Window};
use crate::geometry::index::Tree;
use std::cmp::Ordering;

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
    pub(super) fn forward(self) -> bool {
        matches!(self, Dir::Right | Dir::Up)
    }
}

#[derive(Clone, Copy)]
pub(super) struct Germ {
    pub(super) item: u32,
    pub(super) dir: Dir,
    /// The edge along it, once it was traced.
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
    /// Its germs at the low and the high end.
    pub(super) germs: [u32; 2],
}

/// A boundary cycle of the face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cycle {
    pub(crate) leftmost: u32,
    pub(crate) half_edges: u32,
    /// Whether the face lies outside of it.
    pub(crate) hole: bool,
}

/// The start lies on an arc, so no face holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OnArc(pub(crate) u32);

/// Where a ray down ends.
struct Ray {
    /// The item hit, and a curve through the point.
    below: Option<(u32, CurveId)>,
    /// Whether the ray hits it inside, and no other item there.
    alone: bool,
    /// An item through the ray's own begin that does not begin there itself.
    through: Option<u32>,
    /// An item that begins there.
    beside: Option<u32>,
}

/// One walk: its items, what was found about them so far, and the boundary traced.
pub(crate) struct Tracer<'a> {
    pub(super) k: &'a mut Kernel,
    pub(super) items: &'a [Item],
    pub(super) comps: &'a [Comp],
    pub(super) tree: Tree,
    pub(super) windows: Vec<Window>,
    pub(super) vertices: Vec<Vertex>,
    pub(super) links: Vec<Link>,
    pub(super) germs: Vec<Germ>,
    /// The germs of vertices that have many, by vertex, curve and direction.
    many_germs: FastMap<(u32, CurveId, u8), u32>,
    pub(super) stops: Vec<u32>,
    pub(super) pairs: FastMap<(u32, u32), (u32, u32)>,
    pub(super) crosses: Vec<Cross>,
    /// Items seen by the current search, and items that the current vertex knows.
    pub(super) stamp: Vec<u32>,
    pub(super) serial: u32,
    pub(super) mark: Vec<u32>,
    pub(super) mark_serial: u32,
    /// The vertices of many arcs that an item passes through.
    pub(super) busy: FastMap<u32, Vec<u32>>,
    /// Those that pass through one such vertex, blown up there, and to which of them an item belongs.
    pub(super) pencils: Vec<Pencil>,
    pub(super) pencil_of: Vec<u32>,
    /// What is known of items within clusters.
    pub(super) fans: Vec<Fan>,
    /// Pairs tested for a meeting, and how many may be before the walk is given up.
    pub(super) tests: u64,
    pub(super) budget: u64,
    /// Those of them that searches found in vain, and the bands that were made when they were too many.
    pub(super) wasted: u64,
    pub(super) bands: Bands,
    /// Buffers.
    pub(super) hits: Vec<Hit>,
    pub(super) near: Vec<u32>,
    pub(super) numbers: Vec<NumId>,
    pub(super) edges: Vec<Edge>,
    /// The edges below the face on each curve, of so many edges.
    edges_on: FastMap<CurveId, Vec<u32>>,
    edges_listed: usize,
    pub(super) cycles: Vec<Cycle>,
    /// The half-edges in the order walked: twice the edge, one more if against its direction.
    pub(super) order: Vec<u32>,
    /// Components whose boundary was traced.
    pub(super) touched: Vec<bool>,
    pub(super) unbounded: bool,
}

impl<'a> Tracer<'a> {
    /// Indexes the items, whose boxes are filled in. The vertices are those that items name as their ends.
    pub(crate) fn new(
        k: &'a mut Kernel,
        items: &'a mut [Item],
        comps: &'a [Comp],
        ends: impl Iterator<Item = Point>,
    ) -> Tracer<'a> {
        let tree = index(k, items);
        let windows = items
            .iter()
            .map(|i| {
                Window::new(
                    Cut::plain(k.enclosure(i.l).0),
                    Cut::plain(k.enclosure(i.r).1),
                )
            })
            .collect();
        let mut t = Tracer {
            k,
            items,
            comps,
            tree,
            windows,
            vertices: ends.map(Vertex::new).collect(),
            links: Vec::with_capacity(items.len() * 2),
            germs: Vec::new(),
            many_germs: FastMap::default(),
            stops: Vec::new(),
            pairs: FastMap::default(),
            crosses: Vec::new(),
            stamp: vec![0; items.len()],
            serial: 0,
            mark: vec![0; items.len()],
            mark_serial: 0,
            busy: FastMap::default(),
            pencils: Vec::new(),
            pencil_of: vec![NONE; items.len()],
            fans: Vec::new(),
            tests: 0,
            budget: u64::MAX,
            wasted: 0,
            bands: Bands::default(),
            hits: Vec::new(),
            near: Vec::new(),
            numbers: Vec::new(),
            edges: Vec::new(),
            edges_on: FastMap::default(),
            edges_listed: 0,
            cycles: Vec::new(),
            order: Vec::new(),
            touched: vec![false; comps.len()],
            unbounded: false,
        };
        for (i, item) in items.iter().enumerate() {
            t.link_new(item.vl, i as u32, Place::Low);
            t.link_new(item.vr, i as u32, Place::High);
        }
        t
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
        let many = rights.len() + lefts.len() > MANY;
        for (germs, right) in [(&mut rights, true), (&mut lefts, false)] {
            if germs.len() > 1 {
                // Overlapping arcs are one germ, told by its first item.
                let mut steep: Vec<(Approx, CurveId, u32)> =
                    germs.iter().map(|&(c, i)| (k.slope(c, x), c, i)).collect();
                steep.sort_by(|a, b| {
                    let o = match (a.0 - b.0).sign() {
                        Some(s) if s != 0 && a.1 != b.1 => s.cmp(&0),
                        _ => return k.cmp_beside(a.1, b.1, x, right).then(a.2.cmp(&b.2)),
                    };
                    if right { o } else { o.reverse() }
                });
                steep.dedup_by_key(|g| g.1);
                germs.clear();
                germs.extend(steep.iter().map(|g| (g.1, g.2)));
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
        if many {
            for g in from..to {
                let Germ { item, dir, .. } = self.germs[g];
                if let Carrier::Graph(c) = self.items[item as usize].carrier {
                    self.many_germs.insert((v, c, dir as u8), g as u32);
                }
            }
        }
        let vertex = &mut self.vertices[v as usize];
        vertex.germs = from as u32;
        vertex.germ_count = (to - from) as u32;
        if many {
            self.remember(v);
        }
        (from, to)
    }

    /// The germ of a visited vertex that leaves along an item.
    fn germ_along(&mut self, v: u32, item: u32, dir: Dir) -> usize {
        let (from, to) = self.germs_of(v);
        let carrier = self.items[item as usize].carrier;
        if to - from > MANY
            && let Carrier::Graph(c) = carrier
            && let Some(&g) = self.many_germs.get(&(v, c, dir as u8))
        {
            return g as usize;
        }
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

    // ----- cycles -----

    /// Walks the boundary that leaves `v` by a germ with the face on the left, until it closes.
    fn trace(&mut self, v0: u32, g0: usize) {
        let cycle = self.cycles.len() as u32;
        let (mut v, mut g) = (v0, g0);
        let (mut leftmost, mut hole, mut count) = (NONE, false, 0);
        loop {
            if self.tests > self.budget {
                return;
            }
            let Germ {
                item,
                dir,
                mut edge,
                ..
            } = self.germs[g];
            let (w, back) = if edge == NONE {
                let w = self.next_stop(item, v, dir.forward());
                // The item may not know yet who passes through w; its stops do now.
                let back = self.germ_along(w, item, dir.reverse());
                let mut ends = [(v, g as u32), (w, back as u32)];
                if !dir.forward() {
                    ends.reverse();
                }
                edge = self.edges.len() as u32;
                self.germs[g].edge = edge;
                self.germs[back].edge = edge;
                self.edges.push(Edge {
                    item,
                    low: ends[0].0,
                    high: ends[1].0,
                    above: false,
                    below: false,
                    cycle,
                    germs: ends.map(|e| e.1),
                });
                (w, back)
            } else {
                // Its other side was walked before.
                let e = &self.edges[edge as usize];
                let (w, back) = if dir.forward() {
                    (e.high, e.germs[1])
                } else {
                    (e.low, e.germs[0])
                };
                (w, back as usize)
            };
            let e = &mut self.edges[edge as usize];
            let side = if dir.forward() {
                &mut e.above
            } else {
                &mut e.below
            };
            debug_assert!(!*side, "a side of an edge was walked twice");
            *side = true;
            count += 1;
            self.order.push(2 * edge + u32::from(!dir.forward()));
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
        let leaf = self.leaf_at_end(item, false);
        let v = self.find(self.stops[leaf.from]);
        let (_, to) = self.germs_of(v);
        self.trace(v, to - 1);
    }

    /// Traces the cycle along one side of a vertical that nothing meets between its ends, unless that
    /// side was traced before: going up with the face on the left, or down.
    pub(super) fn border(&mut self, item: u32, up: bool) {
        let leaf = self.leaf_at_end(item, false);
        let low = self.find(self.stops[leaf.from]);
        self.germs_of(low);
        let g = self.germ_along(low, item, Dir::Up);
        let known = self.germs[g].edge;
        if known != NONE {
            let e = &self.edges[known as usize];
            if if up { e.above } else { e.below } {
                return;
            }
        }
        if up {
            self.trace(low, g);
            return;
        }
        let high = self.next_stop(item, low, true);
        self.germs_of(high);
        let g = self.germ_along(high, item, Dir::Down);
        self.trace(high, g);
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
            if self.tests > self.budget {
                return Ok(());
            }
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
        if !self.touched[self.items[item as usize].comp as usize] {
            return false;
        }
        if let Carrier::Graph(c) = self.items[item as usize].carrier
            && ray.alone
        {
            return self.opens_above(c, p.x);
        }
        self.germ_below(item, p.x, false)
            .is_some_and(|(_, g)| self.germs[g].open)
    }

    /// Whether the face lies just above a curve over a number that is no vertex's, as far as its edges were traced.
    fn opens_above(&mut self, c: CurveId, x: NumId) -> bool {
        for (at, e) in self.edges.iter().enumerate().skip(self.edges_listed) {
            if let Carrier::Graph(c) = self.items[e.item as usize].carrier
                && e.above
            {
                self.edges_on.entry(c).or_default().push(at as u32);
            }
        }
        self.edges_listed = self.edges.len();
        let edges = self.edges_on.get(&c).map_or(&[][..], |e| &e[..]);
        edges.iter().any(|&e| {
            let Edge { low, high, .. } = self.edges[e as usize];
            let [low, high] = [low, high].map(|v| self.vertices[v as usize].at.x);
            self.k.cmp(low, x).is_lt() && self.k.cmp(x, high).is_lt()
        })
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
        let (mut through, mut beside, mut alone) = (None, None, true);
        {
            tree.descend(
                |_, n| {
                    n.bounds[0] <= b && a <= n.bounds[1] && {
                        let (lo, hi) = n.t_over(a, b);
                        lo <= ceiling && hi >= floor.get()
                    }
                },
                |i| {
                    let item = self.items[i as usize];
                    let Some(place) = self.place(&item, p.x) else {
                        return true;
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
                        let order = match best {
                            None => Ordering::Greater,
                            Some((_, o, t)) => match (at - t).sign() {
                                Some(s) if s != 0 => s.cmp(&0),
                                _ => self.k.cmp_at(high, o, p.x),
                            },
                        };
                        alone &= !order.is_eq();
                        if order.is_gt() {
                            alone = place == Place::Inside;
                            best = Some((i, high, at));
                            floor.set(if at.lo().is_nan() {
                                f64::NEG_INFINITY
                            } else {
                                at.lo()
                            });
                        }
                        return true;
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
                    true
                },
            );
        }
        self.tree = tree;
        Ray {
            below: best.map(|(i, c, _)| (i, c)),
            alone,
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
                let leaf = self.leaf_at_end(below, true);
                hit = self.find(self.stops[leaf.to - 1]);
            }
            Carrier::Graph(_) => {
                let leaf = self.leaf_at(below, x);
                let mut at = leaf.from;
                while at < leaf.to && hit == NONE {
                    let y = self.find(self.stops[at]);
                    match self.k.cmp(self.vertices[y as usize].at.x, x) {
                        Ordering::Less => at += 1,
                        Ordering::Equal => hit = y,
                        Ordering::Greater => break,
                    }
                }
                if hit == NONE {
                    left = self.stop_from(below, leaf, at, false);
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

/// Vertices with more germs than this have them in a map too.
const MANY: usize = 16;
