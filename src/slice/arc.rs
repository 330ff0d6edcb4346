use crate::contact::{Chart, Contact};
use crate::kernel::{Filtered, Instant, Kernel, Position};
use crate::number::Interval;

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
#[derive(Clone, Debug)]
pub struct Arc<K: Kernel = Filtered> {
    /// Which contact it is.
    pub contact: Contact,
    /// The chart that x is meant in.
    pub chart: Chart,
    /// The curve it lies on.
    pub curve: CurveId,
    /// Sign of ∂(P + tQ)/∂u along it, for the curve as written: the sign of the radical in
    /// DP eq. 26. Zero on walls.
    pub branch: i32,
    /// How it lies.
    pub shape: Shape,
    /// Where its contact leaves the configuration free.
    pub side: Side,
    /// The end with the smaller x (graph, wall) or the earlier one (level).
    pub lo: End<K>,
    /// The end with the larger x (graph, wall) or the later one (level).
    pub hi: End<K>,
    /// Enclosure of the times it spans.
    pub t_span: Interval,
    /// Enclosure of the positions it spans.
    pub x_span: Interval,
}

impl<K: Kernel> Arc<K> {
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
    /// Computes the enclosures from the ends.
    pub(super) fn with_spans(mut self) -> Arc<K> {
        let hull = |a: Interval, b: Interval| Interval {
            lo: a.lo.min(b.lo),
            hi: a.hi.max(b.hi),
        };
        self.t_span = hull(self.lo.t.interval(), self.hi.t.interval());
        self.x_span = hull(self.lo.x.interval(), self.hi.x.interval());
        self
    }
}
