//! F: the component of the free cylinder that holds a configuration (DP §9.1), with its boundary
//! annotated (DP §9.4).
//!
//! The slice is unrolled (`strip.rs`), the face of the start is traced and glued along the cut
//! ([`crate::face`]), and the cut is taken out again: an edge that ends on it is followed by the one that begins on its other side.
//! What remains are edges, stretches of arcs or of the window's borders t = 0 and t = T, each with
//! the sides on which F lies, in cycles that keep F on their left (left as seen with t upwards and x to the right).
//!
//! The annotation is what the sweep needs to handle an event in O(1): for each vertex all arcs through it and
//! the edges that leave it towards later times, for each arc its edges in order of time, and where
//! the boundary touches rest. Vertical tangencies are ends of arcs from the beginning, and where
//! friction changes between sticking and sliding is told by the arc alone (`motion::friction`).

use super::strip::{Owner, Strip};
use super::{ArcId, Shape, Slice, Time};
use crate::contact::Chart;
use crate::face::{Boundary, FaceKernel, Found, Method as FaceMethod, NumId, boundary};
use crate::geometry::index::{Hull, Tree};
use crate::kernel::{Instant, Kernel};
use crate::number::{Algebraic, Int, Poly, Rat, Scalar};
use std::cmp::Ordering;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard};

const NONE: u32 = u32::MAX;

/// A rational point of the cylinder.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Configuration {
    /// The chart x is meant in.
    pub chart: Chart,
    /// Chart position.
    pub x: Rat,
    /// When, from the start of the phase.
    pub t: Rat,
}

/// Where a configuration lies with respect to F.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Whereabouts {
    /// In F: it can be reached without leaving free space.
    Inside,
    /// On F's boundary, in contact.
    Boundary,
    /// Neither.
    Outside,
}

/// A vertex of F's boundary.
#[derive(Clone, Copy, Debug)]
pub struct FreeVertex {
    num: NumId,
    curve: u32,
    /// Enclosure of its position on the strip: x in the rest chart, x + 2 in the back chart.
    pub x: [f64; 2],
    /// Enclosure of its time.
    pub t: [f64; 2],
    /// −1, 0 or 1: the side of rest it lies on, 1 all over the back chart, −1 on the cut.
    pub side: i8,
    /// Whether it lies on the cut, where it may be nothing but the coordinates' seam.
    pub cut: bool,
    /// Whether F goes on along rest from here: for vertices at rest.
    rest_open: bool,
}

/// An edge of F's boundary.
#[derive(Clone, Copy, Debug)]
pub struct FreeEdge {
    /// What it is a stretch of.
    pub owner: Owner,
    /// Its end with the smaller x (graphs, walls, the window), or the earlier one (levels).
    pub low: u32,
    /// Its other end.
    pub high: u32,
    /// Whether F lies on its side of larger x (graphs, levels) or of larger t (walls, the window).
    pub above: bool,
    /// Whether F lies on the other side.
    pub below: bool,
    /// A box around it: x on the strip from and to, t from and to.
    pub bounds: [f64; 4],
    shape: Shape,
    chart: Chart,
    ends: [NumId; 2],
    curve: u32,
    /// Whether its left side, going from low to high, is the one called above.
    left_is_above: bool,
}

impl FreeEdge {
    /// Its earlier end (either one where t is constant).
    pub fn first(&self) -> u32 {
        match self.shape {
            Shape::Graph { rising: false } => self.high,
            _ => self.low,
        }
    }
    /// Its later end.
    pub fn last(&self) -> u32 {
        match self.shape {
            Shape::Graph { rising: false } => self.low,
            _ => self.high,
        }
    }
    /// How it lies; the window's borders lie as walls.
    pub fn shape(&self) -> Shape {
        self.shape
    }
    /// The chart of its arc; the rest chart for the window's borders, which span both.
    pub fn chart(&self) -> Chart {
        self.chart
    }
}

/// Where F's boundary touches rest.
#[derive(Clone, Debug)]
pub struct Touch {
    /// When.
    pub t: Rat,
    /// The edges that do.
    pub edges: Vec<u32>,
    /// The vertex there, if it is one.
    pub vertex: Option<u32>,
}

/// An interval of orientations in F at one time, by its ends; None where F goes all the way round.
#[derive(Clone, Debug)]
pub struct Interval {
    /// The edge at the lower end and its position there.
    pub low: (u32, Algebraic),
    /// The edge at the upper end and its position there; below `low` on the strip if the interval
    /// passes the cut.
    pub high: (u32, Algebraic),
}

/// F, see the module.
pub struct Free {
    kernel: Mutex<FaceKernel>,
    duration: Rat,
    found: Found,
    vertices: Vec<FreeVertex>,
    links: Vec<ArcId>,
    link_starts: Vec<u32>,
    edges: Vec<FreeEdge>,
    /// Half-edges cycle by cycle: twice the edge, one more from high to low.
    order: Vec<u32>,
    cycles: Vec<u32>,
    leaving: Vec<u32>,
    leaving_starts: Vec<u32>,
    /// (arc, edge) by arc, then in order of time, overlapping arcs included.
    on: Vec<(ArcId, u32)>,
    touches: Vec<Touch>,
    rest_at_end: Vec<ArcId>,
    tree: Tree,
    /// Graphs that lie on one curve and branch, where there are several.
    twins: HashMap<(u32, i32, Chart), Vec<ArcId>>,
    levels: Vec<ArcId>,
}

impl std::fmt::Debug for Free {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "Free({} edges, {} cycles)",
            self.edges.len(),
            self.cycles.len() - 1
        )
    }
}

/// How a boundary edge of the strip lies there.
struct Lie {
    shape: Shape,
    chart: Chart,
    left_is_above: bool,
}

fn lie<K: Kernel>(slice: &Slice<K>, owner: Owner) -> Lie {
    let (shape, chart) = match owner {
        Owner::Arc(id) => (slice.arc(id).shape, slice.arc(id).chart),
        Owner::Cut => (Shape::Level, Chart::Rest),
        Owner::Start | Owner::End => (Shape::Wall, Chart::Rest),
    };
    // Left of a graph t(x) is later. On a rising one later is below, at the same time.
    let left_is_above = !matches!(shape, Shape::Graph { rising: true } | Shape::Level);
    Lie {
        shape,
        chart,
        left_is_above,
    }
}

/// CSR starts from sorted keys.
fn starts(keys: impl Iterator<Item = u32>, n: usize) -> Vec<u32> {
    let mut out = vec![0u32; n + 1];
    for k in keys {
        out[k as usize + 1] += 1;
    }
    for i in 0..n {
        out[i + 1] += out[i];
    }
    out
}

/// How many pairs the walk may test among n arcs before the merge is expected to be faster: walks whose searches
/// find what is near stay far below it (see `benches/README.md`).
fn patience(n: usize) -> u64 {
    let n = n as u64 + 64;
    40 * n * u64::from(n.ilog2())
}

impl Free {
    /// F of the slice's barriers that holds a configuration strictly within the phase and on no
    /// arc. None where the slice cannot be unrolled, the configuration lies on an arc, or the pieces do
    /// not fit together.
    ///
    /// Cost, by walking: O(n log n) for an index of the arcs, then in proportion to what the walk round F meets;
    /// by merging (DP Lemma 9.2): near-linear times log² n where few pairs of edges are near each other, whatever
    /// the arcs hidden behind F's boundary do. Both name the same F, and [`Free::found`] tells which ran.
    pub fn new<K: Kernel>(slice: &Slice<K>, at: &Configuration, way: FaceMethod) -> Option<Free> {
        let strip = Strip::new(slice)?;
        let mut x = at.x.clone();
        if at.chart == Chart::Back {
            x += &Rat::from(2);
        }
        let cut = crate::face::Strip {
            graphs: &strip.graphs,
            uprights: &strip.uprights,
            glue: &strip.glue,
            second: &strip.second,
        };
        let (b, found) = boundary(&cut, &(x, at.t.clone()), way, patience).ok()?;
        Assembly::new(slice, strip, b)?.finish(slice, found)
    }

    fn kernel(&self) -> MutexGuard<'_, FaceKernel> {
        self.kernel.lock().unwrap_or_else(|e| e.into_inner())
    }
    /// Which way led to it.
    pub fn found(&self) -> Found {
        self.found
    }
    /// How long the phase lasts.
    pub fn duration(&self) -> &Rat {
        &self.duration
    }
    /// Its vertices.
    pub fn vertices(&self) -> &[FreeVertex] {
        &self.vertices
    }
    /// Its edges.
    pub fn edges(&self) -> &[FreeEdge] {
        &self.edges
    }
    /// How many boundary cycles it has.
    pub fn cycles(&self) -> usize {
        self.cycles.len() - 1
    }
    /// The half-edges of a cycle: (edge, whether from low to high).
    pub fn cycle(&self, c: usize) -> impl Iterator<Item = (u32, bool)> + '_ {
        self.order[self.cycles[c] as usize..self.cycles[c + 1] as usize]
            .iter()
            .map(|h| (h / 2, h % 2 == 0))
    }
    /// How many half-edges its boundary has.
    pub fn half_edges(&self) -> usize {
        self.order.len()
    }
    /// The arcs through a vertex, also those hidden behind others; ascending.
    pub fn arcs_at(&self, v: u32) -> &[ArcId] {
        let v = v as usize;
        &self.links[self.link_starts[v] as usize..self.link_starts[v + 1] as usize]
    }
    /// The edges that leave a vertex towards later times.
    pub fn leaving(&self, v: u32) -> &[u32] {
        let v = v as usize;
        &self.leaving[self.leaving_starts[v] as usize..self.leaving_starts[v + 1] as usize]
    }
    /// The edges that an arc lies on, in order of time.
    pub fn edges_of(&self, arc: ArcId) -> impl DoubleEndedIterator<Item = u32> + '_ {
        let from = self.on.partition_point(|o| o.0 < arc);
        let to = self.on.partition_point(|o| o.0 <= arc);
        self.on[from..to].iter().map(|o| o.1)
    }
    /// Where its boundary touches rest, in order of time.
    pub fn touches(&self) -> &[Touch] {
        &self.touches
    }
    /// The arcs that may hold rest at the end of the phase.
    pub fn arcs_at_rest_end(&self) -> &[ArcId] {
        &self.rest_at_end
    }
    /// Whether F goes on along rest from a vertex at rest, inside of it or beside a level.
    pub fn rest_goes_on(&self, v: u32) -> bool {
        self.vertices[v as usize].rest_open
            || self
                .leaving(v)
                .iter()
                .any(|&e| self.edges[e as usize].shape == Shape::Level)
    }
    /// The arcs among which are all that coincide with one wherever both exist.
    pub fn twins<K: Kernel>(&self, slice: &Slice<K>, arc: ArcId) -> &[ArcId] {
        let a = slice.arc(arc);
        match a.shape {
            Shape::Level => &self.levels,
            _ => self
                .twins
                .get(&(a.curve, a.branch, a.chart))
                .map_or(&[], Vec::as_slice),
        }
    }
    /// The chart position and the time of a vertex.
    pub fn place(&self, v: u32) -> (Chart, Algebraic, Time) {
        let v = &self.vertices[v as usize];
        let mut k = self.kernel();
        let t = time_of(&mut k, v.num, v.curve);
        let x = k.exact(v.num).clone();
        let one = Rat::one();
        if x.cmp_rat(&one).is_le() {
            return (Chart::Rest, x, t);
        }
        let (num, den) = (Poly::from_i64(&[-2, 1]), Poly::constant(Int::one()));
        let x = match x.known_rat() {
            Some(r) => Algebraic::from(r - Rat::from(2)),
            None => x.ratio(&num, &den),
        };
        (Chart::Back, x, t)
    }
    /// Exact order of a vertex's time and an instant.
    pub fn cmp_time(&self, v: u32, t: &Time) -> Ordering {
        self.clearly(v, t).unwrap_or_else(|| {
            let v = &self.vertices[v as usize];
            time_of(&mut self.kernel(), v.num, v.curve).cmp(t)
        })
    }
    /// The order of a vertex's time and an instant where enclosures tell it.
    pub(crate) fn clearly(&self, v: u32, t: &Time) -> Option<Ordering> {
        let (v, i) = (&self.vertices[v as usize], t.interval());
        if v.t[1] < i.lo {
            Some(Ordering::Less)
        } else if i.hi < v.t[0] {
            Some(Ordering::Greater)
        } else {
            None
        }
    }
    /// The edges whose boxes meet a box of the strip.
    pub fn edges_near(&self, x: [f64; 2], t: [f64; 2], mut found: impl FnMut(u32)) {
        self.tree
            .query(&Hull::boxed([x[0], x[1], t[0], t[1]]), |e| {
                found(e);
                true
            });
    }

    // ── queries ─────────────────────────────────────────────────────────────────────────────

    /// Where a configuration lies.
    ///
    /// The highest edge below it along t decides. O(log |F|) where boxes tell apart.
    pub fn locate(&self, at: &Configuration) -> Whereabouts {
        if at.t.sign() < 0 || at.t > self.duration {
            return Whereabouts::Outside;
        }
        let mut k = self.kernel();
        let x = if at.chart == Chart::Back {
            &at.x + &Rat::from(2)
        } else {
            at.x.clone()
        };
        let (xn, height) = (k.rational(&x), k.constant(&at.t));
        let (xi, ti) = (x.interval(), at.t.interval());
        // Below the point, or on it: the edges over x that end to the right of it or over it.
        let mut near = Vec::new();
        self.tree.query(
            &Hull::boxed([xi.lo, xi.hi, f64::NEG_INFINITY, ti.hi]),
            |e| {
                near.push(e);
                true
            },
        );
        let mut best: Option<(u32, bool)> = None;
        for e in near {
            let edge = &self.edges[e as usize];
            let (l, r) = (k.cmp(edge.ends[0], xn), k.cmp(xn, edge.ends[1]));
            if l.is_gt() || r.is_gt() {
                continue;
            }
            if edge.shape == Shape::Level {
                let on = [edge.low, edge.high].map(|v| {
                    time_of(
                        &mut k,
                        self.vertices[v as usize].num,
                        self.vertices[v as usize].curve,
                    )
                    .cmp_rat(&at.t)
                });
                if on[0].is_le() && on[1].is_ge() {
                    return Whereabouts::Boundary;
                }
                continue;
            }
            match k.cmp_at(edge.curve, height, xn) {
                Ordering::Equal => return Whereabouts::Boundary,
                Ordering::Greater => continue,
                Ordering::Less => {}
            }
            // Of edges that meet right below: the topmost one to the left decides; the strip's left
            // border is looked at from its right.
            let border = x == Rat::from(-1);
            if if border { r.is_eq() } else { l.is_eq() } {
                continue;
            }
            let higher = best.is_none_or(|(o, _)| {
                let other = self.edges[o as usize].curve;
                k.cmp_at(edge.curve, other, xn)
                    .then_with(|| k.cmp_beside(edge.curve, other, xn, border))
                    .is_gt()
            });
            if higher {
                let later = if edge.left_is_above {
                    edge.above
                } else {
                    edge.below
                };
                best = Some((e, later));
            }
        }
        match best {
            Some((_, true)) => Whereabouts::Inside,
            _ => Whereabouts::Outside,
        }
    }

    /// The intervals of orientation in F just after a time, by ascending lower ends on the strip (rest
    /// chart, then back chart). None where all orientations are in F.
    ///
    /// O(a log a) for the a arcs of F's boundary alive then.
    pub fn intervals<K: Kernel>(&self, slice: &Slice<K>, t: &Rat) -> Option<Vec<Interval>> {
        let when = Time::from(t.clone());
        let now = K::Time::of(K::Num::from_rat(t));
        let ti = t.interval();
        let mut alive: Vec<(u32, ArcId)> = Vec::new();
        let mut near = Vec::new();
        self.edges_near([-2.0, 4.0], [ti.lo, ti.hi], |e| near.push(e));
        for e in near {
            let edge = &self.edges[e as usize];
            if let (Owner::Arc(a), Shape::Graph { .. } | Shape::Level) = (edge.owner, edge.shape)
                && self.cmp_time(edge.first(), &when).is_le()
                && self.cmp_time(edge.last(), &when).is_gt()
            {
                alive.push((e, a));
            }
        }
        alive.sort_by(|p, q| {
            let (a, b) = (slice.arc(p.1), slice.arc(q.1));
            // The two sides of a level on the cut lie at the strip's two ends.
            let turn = |e: u32| self.edges[e as usize].bounds[0] > 2.9;
            a.chart
                .cmp(&b.chart)
                .then(turn(p.0).cmp(&turn(q.0)))
                .then_with(|| slice.cmp_heights_after(p.1, q.1, &now))
        });
        let position = |e: u32, a: ArcId| {
            let arc = slice.arc(a);
            let x = slice
                .height_at(arc, &K::Num::from_rat(t))
                .unwrap_or_else(|| arc.start().x.clone());
            (e, crate::kernel::Position::<K>::publish(&x))
        };
        let (mut out, mut open, mut first_high) = (Vec::new(), None, None);
        for &(e, a) in &alive {
            let edge = &self.edges[e as usize];
            if edge.below {
                let high = position(e, a);
                match open.take() {
                    Some(low) => out.push(Interval { low, high }),
                    None => first_high = Some(high),
                }
            }
            if edge.above {
                open = Some(position(e, a));
            }
        }
        if let (Some(low), Some(high)) = (open, first_high) {
            out.push(Interval { low, high });
        }
        if out.is_empty() {
            let all = |x: i64| Configuration {
                chart: Chart::Rest,
                x: Rat::frac(x, 7919),
                t: t.clone(),
            };
            if self.locate(&all(3)) == Whereabouts::Inside {
                return None;
            }
        }
        Some(out)
    }
}

fn time_of(k: &mut FaceKernel, x: NumId, curve: u32) -> Time {
    let (p, q) = k.polys(curve);
    Time::ratio(k.exact(x), p, q)
}

/// F while it is put together.
struct Assembly {
    strip: Strip,
    b: Boundary,
    /// The vertex that each vertex of the strip has become.
    renamed: Vec<u32>,
    vertices: Vec<FreeVertex>,
    links: Vec<Vec<ArcId>>,
    /// The edge that each edge of the strip has become; NONE for stretches of the cut.
    kept: Vec<u32>,
    edges: Vec<FreeEdge>,
}

impl Assembly {
    fn new<K: Kernel>(slice: &Slice<K>, strip: Strip, b: Boundary) -> Option<Assembly> {
        let mut a = Assembly {
            renamed: Vec::with_capacity(b.vertices.len()),
            vertices: Vec::with_capacity(b.vertices.len()),
            links: Vec::with_capacity(b.vertices.len()),
            kept: Vec::with_capacity(b.edges.len()),
            edges: Vec::with_capacity(b.edges.len()),
            strip,
            b,
        };
        a.take_vertices()?;
        a.take_edges(slice);
        Some(a)
    }

    /// The strip's vertices, those on the cut united with their partners. None if one lies on the cut where
    /// nothing can end.
    fn take_vertices(&mut self) -> Option<()> {
        let k = &mut self.b.kernel;
        let cuts = [Rat::from(-1), Rat::from(3)];
        let cut_ids = [k.rational(&cuts[0]), k.rational(&cuts[1])];
        let rest = k.rational(&Rat::zero());
        let mut on_cut: HashMap<usize, u32> = HashMap::new();
        for (v, &(num, curve)) in self.b.vertices.iter().enumerate() {
            let (lo, hi) = k.enclosure(num);
            let mut stop = None;
            for (x, &id) in cuts.iter().zip(&cut_ids) {
                if k.cmp(num, id).is_eq() {
                    let (p, q) = k.polys(curve);
                    let t = p.eval(x) / q.eval(x);
                    stop = Some(self.strip.stops.binary_search(&t).ok()?);
                }
            }
            let next = self.vertices.len() as u32;
            let id = match stop {
                Some(s) => *on_cut.entry(s).or_insert(next),
                None => next,
            };
            if id == next {
                let t = k.height(curve, num);
                self.vertices.push(FreeVertex {
                    num,
                    curve,
                    x: [lo, hi],
                    t: [t.lo(), t.hi()],
                    // On the cut, −π/2 for the edges of the rest chart.
                    side: if stop.is_some() {
                        -1
                    } else {
                        k.cmp(num, rest) as i8
                    },
                    cut: stop.is_some(),
                    rest_open: false,
                });
                let mut links = Vec::new();
                if let Some(s) = stop {
                    // Beyond the cut too, where F may not lie: what ends on it there touches the state
                    // on this side of it.
                    let (t, ends) = (&self.strip.stops[s], &self.strip.at_cut);
                    let from = ends.partition_point(|e| e.0 < *t);
                    let here = ends[from..].iter().take_while(|e| e.0 == *t);
                    links.extend(here.map(|e| e.1));
                }
                self.links.push(links);
            }
            let links =
                &self.b.links[self.b.link_starts[v] as usize..self.b.link_starts[v + 1] as usize];
            for &item in links {
                if let Owner::Arc(a) = self.strip.owners[item as usize] {
                    self.links[id as usize].push(a);
                }
            }
            self.renamed.push(id);
        }
        for l in &mut self.links {
            l.sort_unstable();
            l.dedup();
        }
        Some(())
    }

    fn take_edges<K: Kernel>(&mut self, slice: &Slice<K>) {
        for e in &self.b.edges {
            let owner = self.strip.owners[e.item as usize];
            if owner == Owner::Cut {
                self.kept.push(NONE);
                continue;
            }
            self.kept.push(self.edges.len() as u32);
            let Lie {
                shape,
                chart,
                left_is_above,
            } = lie(slice, owner);
            let ends = e.ends.map(|v| self.b.vertices[v as usize]);
            let k = &self.b.kernel;
            let t = ends.map(|(num, curve)| k.height(curve, num));
            let (lo, hi) = (k.enclosure(ends[0].0).0, k.enclosure(ends[1].0).1);
            let [left, right] = e.sides;
            self.edges.push(FreeEdge {
                owner,
                low: self.renamed[e.ends[0] as usize],
                high: self.renamed[e.ends[1] as usize],
                above: if left_is_above { left } else { right },
                below: if left_is_above { right } else { left },
                bounds: [lo, hi, t[0].lo().min(t[1].lo()), t[0].hi().max(t[1].hi())],
                shape,
                chart,
                ends: [ends[0].0, ends[1].0],
                curve: self.b.curves[e.item as usize].unwrap_or(NONE),
                left_is_above,
            });
        }
    }

    /// The cycles of the cylinder: where the strip's boundary turns along a stretch of the cut, the walk
    /// goes on beyond it. None if the face does not lie beyond it, as it must.
    fn cycles(&self) -> Option<(Vec<u32>, Vec<u32>)> {
        let b = &self.b;
        let mut next = vec![NONE; 2 * b.edges.len()];
        for w in b.cycles.windows(2) {
            let cycle = &b.order[w[0] as usize..w[1] as usize];
            for (i, &h) in cycle.iter().enumerate() {
                next[h as usize] = cycle[(i + 1) % cycle.len()];
            }
        }
        // Which half-edge runs along the other side of a stretch of the cut.
        let uprights = self.strip.graphs.len();
        let first = self.strip.uprights.len() - 2 * self.strip.glue.len();
        let mut across: HashMap<usize, u32> = HashMap::new();
        for (e, edge) in b.edges.iter().enumerate() {
            if self.kept[e] == NONE {
                // The right border is walked upwards, the left one downwards.
                across.insert(edge.item as usize, 2 * e as u32 + u32::from(!edge.sides[0]));
            }
        }
        let twin = |h: u32| {
            let item = b.edges[h as usize / 2].item as usize;
            let other = ((item - uprights - first) ^ 1) + uprights + first;
            across.get(&other).copied()
        };
        let (mut order, mut cycles) = (Vec::new(), vec![0]);
        let mut seen = vec![false; next.len()];
        for h0 in b.order.iter().copied() {
            if seen[h0 as usize] || self.kept[h0 as usize / 2] == NONE {
                continue;
            }
            let mut h = h0;
            while !seen[h as usize] {
                seen[h as usize] = true;
                order.push(2 * self.kept[h as usize / 2] + h % 2);
                h = next[h as usize];
                while self.kept[h as usize / 2] == NONE {
                    h = next[twin(h)? as usize];
                }
            }
            cycles.push(order.len() as u32);
        }
        Some((order, cycles))
    }

    fn finish<K: Kernel>(mut self, slice: &Slice<K>, found: Found) -> Option<Free> {
        let (order, cycles) = self.cycles()?;
        self.mark_rest(&order, &cycles);
        // Vertices that only the cut had are no longer any.
        let mut number = vec![NONE; self.vertices.len()];
        let (mut vertices, mut links, mut link_starts) = (Vec::new(), Vec::new(), vec![0]);
        for e in &mut self.edges {
            for v in [&mut e.low, &mut e.high] {
                let n = &mut number[*v as usize];
                if *n == NONE {
                    *n = vertices.len() as u32;
                    vertices.push(self.vertices[*v as usize]);
                    links.extend_from_slice(&self.links[*v as usize]);
                    link_starts.push(links.len() as u32);
                }
                *v = *n;
            }
        }
        let timed = |e: &FreeEdge| {
            matches!(e.shape, Shape::Graph { .. } | Shape::Level) && e.owner != Owner::Cut
        };
        let edges = self.edges;
        let mut leaving: Vec<u32> = (0..edges.len() as u32)
            .filter(|&e| timed(&edges[e as usize]))
            .collect();
        leaving.sort_by_key(|&e| edges[e as usize].first());
        let leaving_starts = starts(
            leaving.iter().map(|&e| edges[e as usize].first()),
            vertices.len(),
        );
        let entries = edges
            .iter()
            .enumerate()
            .map(|(i, e)| (Hull::boxed(e.bounds), i as u32))
            .collect();
        let mut twins: HashMap<(u32, i32, Chart), Vec<ArcId>> = HashMap::new();
        let mut levels = Vec::new();
        for (i, a) in slice
            .arcs()
            .iter()
            .enumerate()
            .filter(|(_, a)| a.is_barrier())
        {
            match a.shape {
                Shape::Level => levels.push(i as ArcId),
                Shape::Wall => {}
                Shape::Graph { .. } => twins
                    .entry((a.curve, a.branch, a.chart))
                    .or_default()
                    .push(i as ArcId),
            }
        }
        let mut free = Free {
            kernel: Mutex::new(self.b.kernel),
            duration: slice.frame.duration.to_rat(),
            found,
            vertices,
            links,
            link_starts,
            edges,
            order,
            cycles,
            leaving,
            leaving_starts,
            on: Vec::new(),
            touches: Vec::new(),
            rest_at_end: Vec::new(),
            tree: Tree::new(entries),
            twins,
            levels,
        };
        free.sort_arcs(slice);
        free.find_touches(slice);
        Some(free)
    }

    /// For vertices at rest, whether F holds what comes right after them at rest: whether one of the sectors
    /// of F there holds the direction of time.
    fn mark_rest(&mut self, order: &[u32], cycles: &[u32]) {
        // Directions counter-clockwise from straight down: t upwards, x to the right.
        let class = |e: &FreeEdge, forward: bool| match (e.shape == Shape::Level, forward) {
            (true, false) => 0,
            (false, true) => 1,
            (true, true) => 2,
            (false, false) => 3,
        };
        for w in cycles.windows(2) {
            let cycle = &order[w[0] as usize..w[1] as usize];
            for (i, &h) in cycle.iter().enumerate() {
                let n = cycle[(i + 1) % cycle.len()];
                let (come, go) = (self.edges[h as usize / 2], self.edges[n as usize / 2]);
                let v = if h % 2 == 0 { come.high } else { come.low };
                if self.vertices[v as usize].side != 0 {
                    continue;
                }
                let (a, b) = (class(&go, n.is_multiple_of(2)), class(&come, h % 2 == 1));
                let x = self.vertices[v as usize].num;
                let k = &mut self.b.kernel;
                let holds = match a.cmp(&b) {
                    _ if n == h ^ 1 => a != 2,
                    Ordering::Less => a < 2 && b > 2,
                    Ordering::Greater => a < 2 || b > 2,
                    Ordering::Equal if a == 1 => {
                        !k.cmp_beside(go.curve, come.curve, x, true).is_lt()
                    }
                    Ordering::Equal => !k.cmp_beside(go.curve, come.curve, x, false).is_gt(),
                };
                self.vertices[v as usize].rest_open |= holds;
            }
        }
    }
}

impl Free {
    /// The edges of each arc, in order of time.
    fn sort_arcs<K: Kernel>(&mut self, slice: &Slice<K>) {
        let mut on = Vec::with_capacity(self.edges.len());
        for (i, e) in self.edges.iter().enumerate() {
            let Owner::Arc(a) = e.owner else { continue };
            on.push((a, i as u32));
            for &b in self.arcs_at(e.low) {
                if b != a && slice.coincide(a, b) && self.arcs_at(e.high).binary_search(&b).is_ok()
                {
                    on.push((b, i as u32));
                }
            }
        }
        let mut k = self.kernel.lock().unwrap_or_else(|e| e.into_inner());
        on.sort_by(|p, q| {
            p.0.cmp(&q.0).then_with(|| {
                let (e, f) = (&self.edges[p.1 as usize], &self.edges[q.1 as usize]);
                let by_x = k.cmp(e.ends[0], f.ends[0]);
                match e.shape {
                    Shape::Graph { rising: false } => by_x.reverse(),
                    Shape::Level => by_x.then_with(|| {
                        let [v, w] = [e, f].map(|e| self.vertices[e.low as usize]);
                        k.cmp_at(v.curve, w.curve, v.num)
                    }),
                    _ => by_x,
                }
            })
        });
        drop(k);
        on.dedup();
        self.on = on;
    }

    fn find_touches<K: Kernel>(&mut self, slice: &Slice<K>) {
        let zero = Rat::zero();
        let mut found: Vec<(Rat, u32, Option<u32>)> = Vec::new();
        let mut at_end = Vec::new();
        {
            let mut k = self.kernel();
            let rest = k.rational(&zero);
            let value = |k: &FaceKernel, curve: u32| {
                let (p, q) = k.polys(curve);
                p.eval(&zero) / q.eval(&zero)
            };
            for (i, e) in self.edges.iter().enumerate() {
                // By the edge's own ends: a vertex on the cut lies on both of the strip's borders.
                if e.bounds[0] > 0.0
                    || e.bounds[1] < 0.0
                    || k.cmp(e.ends[0], rest).is_gt()
                    || k.cmp(e.ends[1], rest).is_lt()
                {
                    continue;
                }
                let i = i as u32;
                match (e.owner, e.shape) {
                    (Owner::End, _) => {
                        at_end.extend_from_slice(self.arcs_at(e.low));
                        at_end.extend_from_slice(self.arcs_at(e.high));
                        for v in [e.low, e.high] {
                            if self.vertices[v as usize].side == 0 {
                                found.push((self.duration.clone(), i, Some(v)));
                            }
                        }
                    }
                    (Owner::Arc(a), Shape::Level) => {
                        for v in [e.low, e.high] {
                            found.push((value(&k, self.vertices[v as usize].curve), i, Some(v)));
                        }
                        if let Some(t) = slice.arc(a).lo.t.decided() {
                            found.push((t.to_rat(), i, None));
                        }
                    }
                    (Owner::Arc(_), _) => {
                        let v = [e.low, e.high]
                            .into_iter()
                            .find(|&v| self.vertices[v as usize].side == 0);
                        found.push((value(&k, e.curve), i, v));
                    }
                    _ => {}
                }
            }
        }
        at_end.sort_unstable();
        at_end.dedup();
        self.rest_at_end = at_end;
        found.sort_by(|a, b| a.0.cmp(&b.0));
        let mut touches: Vec<Touch> = Vec::new();
        for (t, e, v) in found {
            match touches.last_mut() {
                Some(l) if l.t == t => {
                    l.edges.push(e);
                    l.vertex = l.vertex.or(v);
                }
                _ => touches.push(Touch {
                    t,
                    edges: vec![e],
                    vertex: v,
                }),
            }
        }
        self.touches = touches;
    }
}
