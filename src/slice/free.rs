//! F: the component of the free cylinder that holds a configuration (DP §9.1), with its boundary
//! annotated (DP §9.4).
//!
//! The slice is unrolled (`strip.rs`), the face of the start is found, by a walk or by merges, and glued along the
//! cut ([`crate::face`]), and the cut is taken out again (`assemble.rs`); `query.rs` asks what lies where.
//! What remains are edges, stretches of arcs or of the window's borders t = 0 and t = T, each with
//! the sides on which F lies, in cycles that keep F on their left (left as seen with t upwards and x to the right).
//!
//! The annotation is what the sweep needs to handle an event in O(1): for each vertex all arcs through it and
//! the edges that leave it towards later times, for each arc its edges in order of time, and where
//! the boundary touches rest. Vertical tangencies are ends of arcs from the beginning, and where
//! friction changes between sticking and sliding is told by the arc alone (`motion::friction`).

use super::annotate::Along;
use super::assemble::Assembly;
use super::strip::{Owner, Strip};
use super::{ArcId, Shape, Slice, Time};
use crate::contact::Chart;
use crate::face::{FaceKernel, Found, Method as FaceMethod, NumId, Way, boundary};
use crate::geometry::index::{Hull, Tree};
use crate::kernel::Kernel;
use crate::number::{Algebraic, Int, Poly, Rat};
use std::cmp::Ordering;
use std::sync::{Arc, Mutex, MutexGuard};

pub(super) const NONE: u32 = u32::MAX;

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
    pub(super) num: NumId,
    pub(super) curve: u32,
    /// Enclosure of its position on the strip: x in the rest chart, x + 2 in the back chart.
    pub x: [f64; 2],
    /// Enclosure of its time.
    pub t: [f64; 2],
    /// −1, 0 or 1: the side of rest it lies on, 1 all over the back chart, −1 on the cut.
    pub side: i8,
    /// Whether it lies on the cut, where it may be nothing but the coordinates' seam.
    pub cut: bool,
    /// Whether F goes on along rest from here: for vertices at rest.
    pub(super) rest_open: bool,
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
    pub(super) shape: Shape,
    pub(super) chart: Chart,
    pub(super) ends: [NumId; 2],
    pub(super) curve: u32,
    /// Whether its left side, going from low to high, is the one called above.
    pub(super) left_is_above: bool,
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
    pub(super) kernel: Arc<Mutex<FaceKernel>>,
    pub(super) duration: Rat,
    pub(super) start: Configuration,
    pub(super) found: Found,
    pub(super) vertices: Vec<FreeVertex>,
    pub(super) links: Vec<ArcId>,
    pub(super) link_starts: Vec<u32>,
    pub(super) edges: Vec<FreeEdge>,
    /// Half-edges cycle by cycle: twice the edge, one more from high to low.
    pub(super) order: Vec<u32>,
    pub(super) cycles: Vec<u32>,
    pub(super) leaving: Vec<u32>,
    pub(super) leaving_starts: Vec<u32>,
    pub(super) along: Along,
    pub(super) touches: Vec<Touch>,
    pub(super) rest_at_end: Vec<ArcId>,
    pub(super) tree: Tree,
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

/// Arcs a leaf of the merge tree.
const LEAF: usize = 128;

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
        Free::with_leaf(slice, at, way, LEAF)
    }

    /// The same, unless `stop`, asked between the stages of the work, says that it is too late.
    pub fn unless<K: Kernel>(
        slice: &Slice<K>,
        at: &Configuration,
        way: FaceMethod,
        stop: &dyn Fn() -> bool,
    ) -> Option<Free> {
        Free::made(slice, at, way, LEAF, stop)
    }

    /// The same with merges from leaves of so many arcs: F does not depend on it.
    pub fn with_leaf<K: Kernel>(
        slice: &Slice<K>,
        at: &Configuration,
        way: FaceMethod,
        leaf: usize,
    ) -> Option<Free> {
        Free::made(slice, at, way, leaf, &|| false)
    }

    fn made<K: Kernel>(
        slice: &Slice<K>,
        at: &Configuration,
        way: FaceMethod,
        leaf: usize,
        stop: &dyn Fn() -> bool,
    ) -> Option<Free> {
        let go_on = || (!stop()).then_some(());
        go_on()?;
        let mut strip = Strip::new(slice)?;
        go_on()?;
        let mut x = at.x.clone();
        if at.chart == Chart::Back {
            x += &Rat::from(2);
        }
        let cut = crate::face::Strip {
            graphs: std::mem::take(&mut strip.graphs),
            uprights: &strip.uprights,
            glue: &strip.glue,
            second: &strip.second,
            names: &strip.names,
        };
        let how = Way {
            method: way,
            patience: patience(slice.arcs().len()),
            leaf,
        };
        let (b, found) = boundary(cut, &(x, at.t.clone()), how).ok()?;
        go_on()?;
        Assembly::new(slice, strip, b)?.finish(slice, at.clone(), found)
    }

    /// Forgets that an arc bounds F, to see that a damaged F is found out.
    #[cfg(test)]
    pub(crate) fn forget_owner(&mut self, arc: crate::slice::ArcId) {
        for e in &mut self.edges {
            if e.owner == Owner::Arc(arc) {
                e.owner = Owner::Cut;
            }
        }
    }
    pub(super) fn kernel(&self) -> MutexGuard<'_, FaceKernel> {
        self.kernel.lock().unwrap_or_else(|e| e.into_inner())
    }
    /// The configuration that it was found from.
    pub fn start(&self) -> &Configuration {
        &self.start
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
        let from = self.along.on.partition_point(|o| o.0 < arc);
        let to = self.along.on.partition_point(|o| o.0 <= arc);
        self.along.on[from..to].iter().map(|o| o.1)
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
        self.along.beside(slice, arc)
    }
    /// The chart position and the time of a vertex.
    pub fn place(&self, v: u32) -> (Chart, Algebraic, Time) {
        let v = &self.vertices[v as usize];
        let mut k = self.kernel();
        let t = time_of(&mut k, v.num, v.curve);
        if v.cut {
            // It lies on both sides of the strip: by the lower one.
            return (Chart::Rest, Algebraic::from(Rat::from(-1)), t);
        }
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
    /// Edges, all that meet a box of the strip among them.
    pub fn edges_near(&self, x: [f64; 2], t: [f64; 2], mut found: impl FnMut(u32)) {
        self.tree
            .query(&Hull::boxed([x[0], x[1], t[0], t[1]]), |e| {
                found(e);
                true
            });
    }
}

pub(super) fn time_of(k: &mut FaceKernel, x: NumId, curve: u32) -> Time {
    let (p, q) = k.polys(curve);
    Time::ratio(k.exact(x), p, q)
}
