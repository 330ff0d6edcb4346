//! Arcs and the curves they lie on.

use super::shop::Shop;
use crate::contact::{Chart, Contact};
use crate::kernel::{Filtered, Instant, Kernel, Position};
use crate::number::Interval;
use crate::number::filter::{self, Stage};
use std::cell::OnceCell;
use std::ops::Deref;
use std::rc::Rc;

/// Index of an arc in its [`super::Slice`].
pub type ArcId = u32;
/// Index of a curve in its [`super::Slice`]; equal ids are equal curves.
pub type CurveId = u32;

/// A curve P(u) + t·Q(u) = 0 on the cylinder, hash-consed: content removed, first non-zero
/// coefficient of (Q, P) from the top positive, so that coincident edges share one id.
#[derive(Clone, Debug)]
pub struct Curve<K: Kernel = Filtered> {
    /// P as written in u = tan(θ/2), constant first.
    pub p: [K::Coef; 3],
    /// Q likewise.
    pub q: [K::Coef; 3],
    /// P per chart with the common factor of P and Q removed.
    pub(super) rp: [K::Poly; 2],
    /// Q per chart with the common factor removed.
    pub(super) rq: [K::Poly; 2],
    /// Whether P and Q have a common root: the curve then holds a whole level besides its graph, and to lie
    /// on the curve is not to lie on the graph.
    pub(super) factored: bool,
}

impl<K: Kernel> Curve<K> {
    /// P and Q in a chart, without their common factor: on the graph part t = −P/Q.
    pub fn reduced(&self, chart: Chart) -> (&K::Poly, &K::Poly) {
        (&self.rp[chart.index()], &self.rq[chart.index()])
    }
}

/// On which side of an arc its contact leaves the configuration free.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Side {
    /// Free above (larger θ), blocked below.
    Above,
    /// Free below, blocked above.
    Below,
    /// Free on both sides: a touch, no barrier.
    Both,
    /// Blocked on both sides: a slit.
    Neither,
    /// A wall whose earlier side is free.
    Before,
    /// A wall whose later side is free.
    After,
}

/// How an arc lies on the cylinder.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// Monotone in t and in x; `rising` if x grows with t.
    Graph {
        /// Whether x grows with t.
        rising: bool,
    },
    /// x constant.
    Level,
    /// t constant.
    Wall,
}

/// An end of an arc.
#[derive(Clone, Debug)]
pub struct End<K: Kernel = Filtered> {
    /// Chart position.
    pub x: K::Root,
    /// When.
    pub t: K::Time,
}

/// A piece of a patch on the cylinder: in one chart, monotone, with both ends known exactly.
///
/// What certified doubles tell of it stands here. Its ends, curve and branch ([`Exact`]) are numbers that most arcs
/// are never asked for, so they are made when first looked at; `arc.lo`, `arc.hi`, `arc.curve` and
/// `arc.branch` do that by themselves (`Deref`).
#[derive(Clone, Debug)]
pub struct Arc<K: Kernel = Filtered> {
    /// Which contact it is.
    pub contact: Contact,
    /// The chart that x is meant in.
    pub chart: Chart,
    /// How it lies.
    pub shape: Shape,
    /// Where its contact leaves the configuration free.
    pub side: Side,
    /// Enclosure of the times it spans.
    pub t_span: Interval,
    /// Enclosure of the positions it spans.
    pub x_span: Interval,
    /// Enclosures of its ends, the lower one first: position and time.
    pub(super) ends: [(Interval, Interval); 2],
    /// Enclosure of the time at which it passes rest, where it does.
    pub(super) at_rest: Interval,
    pub(super) exact: OnceCell<Exact<K>>,
    /// Where the exact part is made: the shop, the patch, and which of the patch's arcs it is.
    pub(super) source: Option<(Rc<Shop<K>>, u32, u32)>,
}

/// The part of an arc that needs exact numbers.
#[derive(Clone, Debug)]
pub struct Exact<K: Kernel = Filtered> {
    /// The curve it lies on.
    pub curve: CurveId,
    /// Sign of ∂(P + tQ)/∂u along it, for the curve as written: the sign of the radical in
    /// DP eq. 26. Zero on walls.
    pub branch: i32,
    /// The end with the smaller x (graph, wall) or the earlier one (level).
    pub lo: End<K>,
    /// The end with the larger x (graph, wall) or the later one (level).
    pub hi: End<K>,
}

impl<K: Kernel> Deref for Arc<K> {
    type Target = Exact<K>;
    /// The exact part, made when first asked for.
    fn deref(&self) -> &Exact<K> {
        self.exact.get_or_init(|| match &self.source {
            Some((shop, patch, k)) => shop.exact(*patch, *k, self),
            // `Arc::made` fills it in, and `Seen::arc`, the only other maker, gives a source.
            None => unreachable!("an arc without a source is exact from the beginning"),
        })
    }
}

impl<K: Kernel> Arc<K> {
    /// An arc whose exact part is there from the beginning.
    pub(super) fn made(
        contact: Contact,
        chart: Chart,
        shape: Shape,
        side: Side,
        exact: Exact<K>,
    ) -> Arc<K> {
        let ends = [&exact.lo, &exact.hi].map(|e| (e.x.interval(), e.t.interval()));
        let hull = |a: Interval, b: Interval| Interval {
            lo: a.lo.min(b.lo),
            hi: a.hi.max(b.hi),
        };
        Arc {
            contact,
            chart,
            shape,
            side,
            t_span: hull(ends[0].1, ends[1].1),
            x_span: hull(ends[0].0, ends[1].0),
            ends,
            at_rest: Interval::all(),
            exact: OnceCell::from(exact),
            source: None,
        }
    }
    /// Its earlier end (either one of a wall).
    pub fn start(&self) -> &End<K> {
        match self.shape {
            Shape::Graph { rising: false } => &self.hi,
            _ => &self.lo,
        }
    }
    /// Its later end (either one of a wall).
    pub fn end(&self) -> &End<K> {
        match self.shape {
            Shape::Graph { rising: false } => &self.lo,
            _ => &self.hi,
        }
    }
    /// Enclosures of the times of its earlier and its later end.
    pub(super) fn times(&self) -> [Interval; 2] {
        let [lo, hi] = [self.ends[0].1, self.ends[1].1];
        match self.shape {
            Shape::Graph { rising: false } => [hi, lo],
            _ => [lo, hi],
        }
    }
    /// Whether x lies between its ends, ends included.
    pub fn spans_x(&self, x: &K::Root) -> bool {
        let i = x.interval();
        if i.below(&self.x_span) || self.x_span.below(&i) {
            return false;
        }
        if K::ENCLOSES && self.ends[0].0.below(&i) && i.below(&self.ends[1].0) {
            filter::settled(Stage::Double);
            return true;
        }
        self.lo.x <= *x && *x <= self.hi.x
    }
    /// Enclosure of the time at which it passes rest, as far as doubles tell; of no meaning where it does not.
    pub fn rest_span(&self) -> Interval {
        self.at_rest
    }
    /// The time of a wall, which is a number.
    pub fn wall_time(&self) -> Option<K::Num> {
        match self.shape {
            Shape::Wall => self.lo.t.known(),
            _ => None,
        }
    }
    /// Whether it bounds free space at all.
    pub fn is_barrier(&self) -> bool {
        self.side != Side::Both
    }
}
