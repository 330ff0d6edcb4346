//! The questions that the motion asks of the slice. Everything here is decided exactly; the
//! enclosures that come first only save work.

use super::scout;
use super::{Arc, ArcId, CurveId, Shape, Slice};
use crate::contact::Chart;
use crate::kernel::{Filtered, Instant, Kernel, Polynomial, Position};
use crate::number::Interval;
use crate::number::filter::{self, Stage};
use std::cmp::Ordering;
use std::collections::HashMap;

/// Where two curves cross.
#[derive(Clone, Debug)]
pub struct Cross<K: Kernel = Filtered> {
    /// Chart position.
    pub x: K::Root,
    /// When.
    pub t: K::Time,
}

pub(super) type CrossCache<K> = HashMap<(CurveId, CurveId, Chart), std::sync::Arc<[Cross<K>]>>;

/// A point of the cylinder whose time is a rational number or a rational function of its x.
#[derive(Clone, Debug)]
pub struct Point<K: Kernel = Filtered> {
    /// The chart x is meant in.
    pub chart: Chart,
    /// Chart position.
    pub x: K::Root,
    /// When.
    pub t: K::Time,
    /// Curves known to pass through it.
    pub on: Vec<CurveId>,
}

/// How an arc leaves a point on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Germs {
    /// Towards earlier times.
    pub left: bool,
    /// Towards later times.
    pub right: bool,
    /// Straight up (walls).
    pub up: bool,
    /// Straight down (walls).
    pub down: bool,
}

impl<K: Kernel> Slice<K> {
    /// Where the graph parts of two different curves cross in a chart, ascending in x.
    ///
    /// P₁Q₂ − P₂Q₁ is a quartic; where Q₁ and Q₂ are proportional (two type B contacts, or two
    /// obstacle vertices against one pawl edge) only a quadratic. Computed once a pair.
    pub fn crossings(&self, a: CurveId, b: CurveId, chart: Chart) -> std::sync::Arc<[Cross<K>]> {
        let key = (a.min(b), a.max(b), chart);
        let lock = || self.crossings.lock().unwrap_or_else(|e| e.into_inner());
        if let Some(c) = lock().get(&key) {
            return c.clone();
        }
        let (p, q) = self.curve(key.0).reduced(chart);
        let (p2, q2) = self.curve(key.1).reduced(chart);
        let h = K::Poly::crossing(p, q, p2, q2);
        let list: std::sync::Arc<[Cross<K>]> = if h.is_zero() {
            std::sync::Arc::new([])
        } else {
            let mut roots = h.chart_roots();
            roots.retain(|x| x.sign_of(q) != 0);
            let mut list: Vec<Cross<K>> = roots
                .into_iter()
                .map(|x| Cross {
                    t: K::Time::ratio(&x, p.negated(), q.clone()),
                    x,
                })
                .collect();
            self.name_crossings(key, &mut list);
            list.into()
        };
        lock().insert(key, list.clone());
        list
    }

    /// Gives crossings at points that both curves pass through by name the handles of those: such
    /// a point is a crossing, so where only one crossing can be it, it is that one.
    fn name_crossings(&self, (a, b, chart): (CurveId, CurveId, Chart), list: &mut [Cross<K>]) {
        for (x, t) in self.shop.named_on_both(a, b, chart) {
            let at = x.interval();
            let mut near = list.iter_mut().filter(|c| c.x.interval().meets(&at));
            if let (Some(c), None) = (near.next(), near.next()) {
                (c.x, c.t) = (x, t);
            }
        }
    }

    /// When a graph arc's curve passes position x (where its denominator does not vanish).
    pub fn time_at(&self, arc: &Arc<K>, x: &K::Root) -> K::Time {
        let (p, q) = self.curve(arc.curve).reduced(arc.chart);
        K::Time::ratio(x, p.negated(), q.clone())
    }

    /// The position of an arc at a rational time within its span. None off its span, and on walls.
    pub fn height_at(&self, arc: &Arc<K>, t: &K::Num) -> Option<K::Root> {
        match arc.shape {
            Shape::Wall => None,
            Shape::Level => Some(arc.lo.x.clone()),
            Shape::Graph { .. } => {
                let (p, q) = self.curve(arc.curve).reduced(arc.chart);
                K::Poly::at_time(p, q, t)
                    .chart_roots()
                    .into_iter()
                    .find(|x| arc.spans_x(x))
            }
        }
    }

    /// Whether the closed arc holds the point.
    pub fn holds(&self, arc: &Arc<K>, z: &Point<K>) -> bool {
        if arc.chart != z.chart
            || !arc.t_span.meets(&z.t.interval())
            || !arc.x_span.meets(&z.x.interval())
        {
            return false;
        }
        match arc.shape {
            Shape::Level => arc.lo.x == z.x && arc.lo.t <= z.t && z.t <= arc.hi.t,
            Shape::Wall => arc.lo.t == z.t && arc.spans_x(&z.x),
            Shape::Graph { .. } => {
                let is_end = |e: &super::End<K>| e.x.same(&z.x) && e.t.same(&z.t);
                if is_end(&arc.lo) || is_end(&arc.hi) {
                    filter::settled(Stage::Name);
                    return true;
                }
                arc.spans_x(&z.x) && (self.lies_on(arc, z) || self.passes(arc, z))
            }
        }
    }

    /// Whether the point is known to lie on the arc's graph. A point of the level that a curve holds besides
    /// its graph is named on the curve at every time, and proves nothing.
    fn lies_on(&self, arc: &Arc<K>, z: &Point<K>) -> bool {
        let known = z.on.contains(&arc.curve) && !self.curve(arc.curve).factored;
        if known {
            filter::settled(Stage::Name);
        }
        known
    }

    fn passes(&self, arc: &Arc<K>, z: &Point<K>) -> bool {
        let (p, q) = self.curve(arc.curve).reduced(arc.chart);
        let (num, den) = z.t.parts();
        z.x.sign_of(&p.times(&den).plus(&q.times(&num))) == 0
    }

    /// How an arc leaves a point that it holds.
    pub fn germs(&self, arc: &Arc<K>, z: &Point<K>) -> Germs {
        match arc.shape {
            Shape::Wall => Germs {
                left: false,
                right: false,
                up: z.x < arc.hi.x,
                down: arc.lo.x < z.x,
            },
            Shape::Level => Germs {
                left: arc.lo.t < z.t,
                right: z.t < arc.hi.t,
                up: false,
                down: false,
            },
            Shape::Graph { rising } => {
                let (below, above) = (arc.lo.x < z.x, z.x < arc.hi.x);
                let (left, right) = if rising {
                    (below, above)
                } else {
                    (above, below)
                };
                Germs {
                    left,
                    right,
                    up: false,
                    down: false,
                }
            }
        }
    }

    /// dx/dt of a graph arc at a point on it, as an enclosure.
    fn slope(&self, arc: &Arc<K>, z: &Point<K>) -> Interval {
        if arc.shape == Shape::Level {
            return Interval::point(0.0);
        }
        let (p, q) = self.curve(arc.curve).reduced(arc.chart);
        let (x, t) = (z.x.interval(), z.t.interval());
        let fx = p.derivative().eval_interval(x) + t * q.derivative().eval_interval(x);
        -q.eval_interval(x) / fx
    }

    /// Which of two arcs through z (in one chart, neither a wall) is higher just after z.
    /// `Equal` means that they coincide there.
    pub fn cmp_after(&self, a: ArcId, b: ArcId, z: &Point<K>) -> Ordering {
        self.cmp_beside(a, b, z, true)
    }

    /// Which of two arcs through z is higher just before z.
    pub fn cmp_before(&self, a: ArcId, b: ArcId, z: &Point<K>) -> Ordering {
        self.cmp_beside(a, b, z, false)
    }

    fn cmp_beside(&self, ia: ArcId, ib: ArcId, z: &Point<K>, after: bool) -> Ordering {
        let (a, b) = (self.arc(ia), self.arc(ib));
        if ia == ib {
            return Ordering::Equal;
        }
        let against_level = |arc: &Arc<K>| cmp_horizontal(arc, after);
        match (a.shape, b.shape) {
            (_, Shape::Level) => return against_level(a),
            (Shape::Level, _) => return against_level(b).reverse(),
            _ => {}
        }
        if a.curve == b.curve {
            // Coincident, or the two branches that meet in a tangency.
            return if a.branch == b.branch {
                Ordering::Equal
            } else {
                a.lo.x.cmp(&b.lo.x)
            };
        }
        let (sa, sb) = (self.slope(a, z), self.slope(b, z));
        let by_slope = if sa.below(&sb) {
            Some(Ordering::Less)
        } else if sb.below(&sa) {
            Some(Ordering::Greater)
        } else {
            None
        };
        if let Some(o) = by_slope {
            return if after { o } else { o.reverse() };
        }
        let t = if after {
            let mut next = a.end().t.clone().min(b.end().t.clone());
            for c in self.shared_crossings(a, b) {
                if c.t > z.t && c.t < next {
                    next = c.t;
                }
            }
            K::Time::between(&z.t, &next)
        } else {
            let mut last = a.start().t.clone().max(b.start().t.clone());
            for c in self.shared_crossings(a, b) {
                if c.t < z.t && c.t > last {
                    last = c.t;
                }
            }
            K::Time::between(&last, &z.t)
        };
        self.cmp_heights(a, b, &t)
    }

    /// Crossings of two graph arcs' curves that lie on both arcs.
    fn shared_crossings(&self, a: &Arc<K>, b: &Arc<K>) -> Vec<Cross<K>> {
        self.crossings(a.curve, b.curve, a.chart)
            .iter()
            .filter(|c| a.spans_x(&c.x) && b.spans_x(&c.x))
            .cloned()
            .collect()
    }

    fn cmp_heights(&self, a: &Arc<K>, b: &Arc<K>, t: &K::Num) -> Ordering {
        match (self.height_at(a, t), self.height_at(b, t)) {
            (Some(x), Some(y)) => x.cmp(&y),
            _ => {
                debug_assert!(!K::CERTIFIED, "both arcs span the time");
                Ordering::Equal
            }
        }
    }

    /// Whether an arc exists just after t (walls never do).
    pub fn alive_after(&self, arc: &Arc<K>, t: &K::Time) -> bool {
        let at = t.interval();
        if matches!(arc.shape, Shape::Wall) || arc.t_span.hi < at.lo || arc.t_span.lo > at.hi {
            return false;
        }
        let [from, to] = arc.times();
        if K::ENCLOSES && from.below(&at) && at.below(&to) {
            filter::settled(Stage::Double);
            return true;
        }
        arc.start().t <= *t && *t < arc.end().t
    }

    /// Whether an arc is there at a time, its ends included.
    pub fn alive_at(&self, arc: &Arc<K>, t: &K::Time) -> bool {
        let at = t.interval();
        if arc.t_span.hi < at.lo || arc.t_span.lo > at.hi {
            return false;
        }
        arc.start().t <= *t && *t <= arc.end().t
    }

    /// An enclosure of the position of an arc at t, where it is alive: of a graph by doubles alone, from the
    /// C-function of its patch.
    pub fn position_about(&self, id: ArcId, t: Interval) -> Interval {
        let arc = self.arc(id);
        match (arc.shape, self.rough_at(id, t)) {
            (Shape::Graph { .. }, Some((f, t))) => scout::position(f, arc.chart, t, arc.x_span),
            _ => arc.x_span,
        }
    }

    /// The position of an arc just after t against a constant x; `Equal` only for a level there.
    pub fn cmp_after_const(&self, id: ArcId, t: &K::Time, x: &K::Root) -> Ordering {
        let (arc, xi) = (self.arc(id), x.interval());
        if xi.below(&arc.x_span) {
            return Ordering::Greater;
        }
        if arc.x_span.below(&xi) {
            return Ordering::Less;
        }
        let Shape::Graph { rising } = arc.shape else {
            return arc.lo.x.cmp(x);
        };
        // What is told apart at t is so just after it.
        let about = self.position_about(id, t.interval());
        if let Some(order) = told_apart(&about, &xi) {
            return order;
        }
        if K::ENCLOSES && arc.ends[0].0.below(&xi) && xi.below(&arc.ends[1].0) {
            filter::settled(Stage::Double);
        } else if *x <= arc.lo.x {
            return Ordering::Greater;
        } else if *x >= arc.hi.x {
            return Ordering::Less;
        }
        if (*t >= self.time_at(arc, x)) == rising {
            Ordering::Greater
        } else {
            Ordering::Less
        }
    }

    /// Which of two arcs of one chart, both alive just after t, is higher there.
    pub fn cmp_heights_after(&self, ia: ArcId, ib: ArcId, t: &K::Time) -> Ordering {
        let (a, b) = (self.arc(ia), self.arc(ib));
        if a.x_span.below(&b.x_span) {
            return Ordering::Less;
        }
        if b.x_span.below(&a.x_span) {
            return Ordering::Greater;
        }
        match (a.shape, b.shape) {
            (_, Shape::Level) => return self.cmp_after_const(ia, t, &b.lo.x),
            (Shape::Level, _) => return self.cmp_after_const(ib, t, &a.lo.x).reverse(),
            _ => {}
        }
        let about = [ia, ib].map(|id| self.position_about(id, t.interval()));
        if let Some(order) = told_apart(&about[0], &about[1]) {
            return order;
        }
        if a.curve == b.curve {
            return if a.branch == b.branch {
                Ordering::Equal
            } else {
                a.lo.x.cmp(&b.lo.x)
            };
        }
        let mut next = a.end().t.clone().min(b.end().t.clone());
        for c in self.shared_crossings(a, b) {
            if c.t > *t && c.t < next {
                next = c.t;
            }
        }
        self.cmp_heights(a, b, &K::Time::between(t, &next))
    }

    /// Whether two arcs coincide wherever both exist: one curve and branch, or levels at one x.
    pub fn coincide(&self, ia: ArcId, ib: ArcId) -> bool {
        let (a, b) = (self.arc(ia), self.arc(ib));
        if a.chart != b.chart {
            return false;
        }
        match (a.shape, b.shape) {
            (Shape::Level, Shape::Level) => a.lo.x == b.lo.x,
            (Shape::Graph { .. }, Shape::Graph { .. }) => {
                a.curve == b.curve && a.branch == b.branch
            }
            _ => false,
        }
    }

    /// The earliest point after `from` and not after `until` at which the arc `ia` meets the arc
    /// `ib` anew, ends or begins to coincide with it. `None` if there is none.
    pub fn first_meeting(
        &self,
        ia: ArcId,
        ib: ArcId,
        from: &K::Time,
        until: &K::Time,
    ) -> Option<Point<K>> {
        let (a, b) = (self.arc(ia), self.arc(ib));
        if !a.t_span.meets(&b.t_span)
            || !a.x_span.meets(&b.x_span)
            || b.t_span.hi < from.interval().lo
            || b.t_span.lo > until.interval().hi
        {
            return None;
        }
        let later = |t: &K::Time| *t > *from && *t <= *until;
        let point = |x: &K::Root, t: K::Time, on: Vec<CurveId>| Point {
            chart: a.chart,
            x: x.clone(),
            t,
            on,
        };
        if matches!(
            (a.shape, b.shape),
            (Shape::Graph { .. }, Shape::Graph { .. })
        ) && self.apart(ia, ib)
        {
            filter::settled(Stage::Double);
            return None;
        }
        if self.coincide(ia, ib) {
            // Ends in order of time, each with its own handles.
            return [b.start(), b.end()]
                .into_iter()
                .find(|e| later(&e.t))
                .filter(|e| a.start().t <= e.t && e.t <= a.end().t)
                .map(|e| point(&e.x, e.t.clone(), vec![b.curve]));
        }
        match (a.shape, b.shape) {
            (Shape::Graph { .. }, Shape::Graph { .. }) => {
                if a.curve == b.curve {
                    return None; // they can only meet in a's own end
                }
                let mut best: Option<Point<K>> = None;
                for c in self.crossings(a.curve, b.curve, a.chart).iter() {
                    let i = c.t.interval();
                    if i.hi < from.interval().lo || i.lo > until.interval().hi {
                        continue;
                    }
                    if a.spans_x(&c.x)
                        && b.spans_x(&c.x)
                        && later(&c.t)
                        && best.as_ref().is_none_or(|p| c.t < p.t)
                    {
                        best = Some(point(&c.x, c.t.clone(), vec![a.curve, b.curve]));
                    }
                }
                best
            }
            (Shape::Graph { .. }, Shape::Level) => {
                let x = &b.lo.x;
                if !a.spans_x(x) {
                    return None;
                }
                let t = self.time_at(a, x);
                (later(&t) && b.lo.t <= t && t <= b.hi.t).then(|| point(x, t, vec![a.curve]))
            }
            (Shape::Level, Shape::Graph { .. }) => {
                let x = &a.lo.x;
                if !b.spans_x(x) {
                    return None;
                }
                let t = self.time_at(b, x);
                (later(&t) && t <= a.hi.t).then(|| point(x, t, vec![b.curve]))
            }
            (Shape::Graph { .. }, Shape::Wall) => {
                let c = b.wall_time()?;
                let t = b.lo.t.clone();
                if !later(&t) || a.start().t > t || t > a.end().t {
                    return None;
                }
                let x = self.height_at(a, &c)?;
                b.spans_x(&x).then(|| point(&x, t, vec![a.curve]))
            }
            (Shape::Level, Shape::Wall) => {
                let t = b.lo.t.clone();
                (later(&t) && t <= a.hi.t && b.spans_x(&a.lo.x))
                    .then(|| point(&a.lo.x, t, Vec::new()))
            }
            (Shape::Level, Shape::Level) | (Shape::Wall, _) => None,
        }
    }
}

/// The order of two positions whose enclosures prove it.
fn told_apart(a: &Interval, b: &Interval) -> Option<Ordering> {
    let order = if a.below(b) {
        Ordering::Less
    } else if b.below(a) {
        Ordering::Greater
    } else {
        return None;
    };
    filter::settled(Stage::Double);
    Some(order)
}

/// Which side of the horizontal through a point on it an arc lies on just after (or before).
pub fn cmp_horizontal<K: Kernel>(arc: &Arc<K>, after: bool) -> Ordering {
    match arc.shape {
        Shape::Graph { rising } if rising == after => Ordering::Greater,
        Shape::Graph { .. } => Ordering::Less,
        _ => Ordering::Equal,
    }
}
