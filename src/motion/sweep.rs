//! The sweep: the state follows F's boundary, and every event is at a place that F has named (DP §9).
//!
//! The state is at rest or on an edge of F. On an edge the next event is at its later end (or where it crosses
//! rest, or where friction takes hold); the vertex there knows all arcs through it and the edges that
//! leave it. At rest the next event is F's next touch of rest. A snap asks the edges that the line L(t) meets. So
//! a step costs O(1), a snap O(log |F|) where boxes tell edges apart, whatever the
//! number of arcs. The paper moves L(t) over the whole of F and keeps the order of the arcs along
//! it; here only the state's own edge is followed, and L(t) is asked for where a snap needs
//! it, since most of F is never met by the state.
//!
//! One thing leads out of F. The contract keeps the state on its curve where an obstacle begins at its
//! own place, and the part beside the curve may be joined to F in that point alone. Then the sight is
//! lost ([`Sight::entered`] says so) and F is made anew from there.

use super::local::State;
use super::sight::{Arcs, Sight};
use crate::contact::Chart;
use crate::kernel::{Instant, Kernel, Position};
use crate::number::{Interval, Rat, Scalar};
use crate::slice::{ArcId, Configuration, Free, Owner, Point, Shape, Slice, Whereabouts};
use std::borrow::Cow;
use std::cell::RefCell;
use std::rc::Rc;

/// Where the state was last seen.
#[derive(Clone, Debug)]
enum Spot {
    /// At the start of the phase, or somewhere inside F.
    Open,
    /// At a vertex.
    Vertex(u32),
    /// Inside of an edge.
    Edge(u32),
    /// Where the boundary touches rest: the index of the touch.
    Touch(usize),
}

struct Eye {
    spot: Spot,
    /// The edge that the state follows.
    edge: Option<u32>,
}

/// The arcs that F's boundary names.
pub(super) struct Sweep<'a, K: Kernel> {
    slice: &'a Slice<K>,
    free: Rc<Free>,
    end: K::Time,
    eye: RefCell<Eye>,
}

impl<'a, K: Kernel> Sweep<'a, K> {
    pub(super) fn new(slice: &'a Slice<K>, free: Rc<Free>) -> Sweep<'a, K> {
        Sweep {
            slice,
            free,
            end: K::Time::of(slice.frame.duration.clone()),
            eye: RefCell::new(Eye {
                spot: Spot::Open,
                edge: None,
            }),
        }
    }

    fn of_chart(&self, arcs: &[ArcId], chart: Chart) -> Vec<ArcId> {
        arcs.iter()
            .copied()
            .filter(|&a| self.slice.arc(a).chart == chart)
            .collect()
    }

    /// The arcs through both ends of an edge, by chart.
    fn beside(&self, edge: u32, chart: Chart, out: &mut Vec<ArcId>) {
        let e = &self.free.edges()[edge as usize];
        for v in [e.low, e.high] {
            out.extend(self.of_chart(self.free.arcs_at(v), chart));
        }
    }

    /// Whether an edge bears the state: its side, and its arc or one that coincides.
    fn bears(&self, edge: u32, arc: ArcId, lower: bool) -> bool {
        let e = &self.free.edges()[edge as usize];
        let Owner::Arc(a) = e.owner else { return false };
        (if lower { e.above } else { e.below }) && (a == arc || self.slice.coincide(a, arc))
    }

    /// Whether a graph's edge goes on from rest to later times.
    fn leaves_rest(&self, edge: u32) -> bool {
        let e = &self.free.edges()[edge as usize];
        let side = |v: u32| self.free.vertices()[v as usize].side;
        match e.shape() {
            Shape::Graph { rising: true } => side(e.low) <= 0 && side(e.high) > 0,
            Shape::Graph { rising: false } => side(e.high) >= 0 && side(e.low) < 0,
            _ => false,
        }
    }

    /// The edge that the state follows from here on.
    fn find(&self, spot: &Spot, arc: ArcId, lower: bool, at: &K::Time) -> Option<u32> {
        let bears = |e: &u32| self.bears(*e, arc, lower);
        let near = match *spot {
            Spot::Vertex(v) => self.free.leaving(v).iter().copied().find(bears),
            Spot::Edge(e) => Some(e).filter(bears),
            Spot::Touch(i) => self.free.touches()[i]
                .edges
                .iter()
                .copied()
                .find(|e| bears(e) && self.leaves_rest(*e)),
            Spot::Open => None,
        };
        near.or_else(|| {
            // Landed: by time.
            let t = at.publish();
            let edges: Vec<u32> = self.free.edges_of(arc).collect();
            let later = |e: &u32| {
                let last = self.free.edges()[*e as usize].last();
                self.free.cmp_time(last, &t).is_gt()
            };
            let from = edges.partition_point(|e| !later(e));
            edges[from..].iter().copied().take(1).find(|e| {
                let first = self.free.edges()[*e as usize].first();
                bears(e) && self.free.cmp_time(first, &t).is_le()
            })
        })
    }
}

/// In what part of its way a snap first looks for what stands in it, and how much further each time.
const LOOK: f64 = 1.0 / 4096.0;
const FURTHER: f64 = 8.0;

impl<K: Kernel> Sweep<'_, K> {
    /// The edges of a chart that may be met over a part of the strip, with their arcs.
    fn edges_across(&self, chart: Chart, span: [f64; 2], when: Interval) -> Vec<(ArcId, u32)> {
        let mut near = Vec::new();
        self.free.edges_near(span, [when.lo, when.hi], |e| {
            if let Owner::Arc(a) = self.free.edges()[e as usize].owner
                && self.slice.arc(a).chart == chart
            {
                near.push((a, e));
            }
        });
        near
    }

    /// Of those the ones that may be met first on the way down or up from `x`: what certainly stands in
    /// the way hides all that certainly lies behind it, and enclosures alone tell.
    fn first_across(
        &self,
        chart: Chart,
        span: [f64; 2],
        when: Interval,
        x: Interval,
        dir: i32,
    ) -> Vec<(ArcId, u32)> {
        const SLACK: f64 = 1e-9;
        let moved = if chart == Chart::Back { 2.0 } else { 0.0 };
        let (from, to) = if dir < 0 {
            (span[0] + 2.0 * SLACK, x.lo + moved - SLACK)
        } else {
            (x.hi + moved + SLACK, span[1] - 2.0 * SLACK)
        };
        let t_of = |v: u32| self.free.vertices()[v as usize].t;
        // Where an edge is at that time, and whether it certainly is there.
        let place = |&(a, e): &(ArcId, u32)| {
            let e = &self.free.edges()[e as usize];
            let lasts = t_of(e.first())[1] < when.lo && when.hi < t_of(e.last())[0];
            let [mut lo, mut hi, ..] = e.bounds;
            if lasts {
                let about = self.slice.position_about(a, when);
                (lo, hi) = (lo.max(about.lo + moved), hi.min(about.hi + moved));
            }
            (lo, hi, lasts)
        };
        let mut reach = ((span[1] - span[0]) * LOOK).max(SLACK);
        loop {
            let window = if dir < 0 {
                [span[0].max(to - reach), span[1]]
            } else {
                [span[0], span[1].min(from + reach)]
            };
            let mut near = self.edges_across(chart, window, when);
            let places: Vec<_> = near.iter().map(place).collect();
            let sure = places
                .iter()
                .filter(|p| p.2 && from.max(window[0]) < p.0 && p.1 < to.min(window[1]));
            let mut places = places.iter();
            let mut keep = |beside: &dyn Fn(&(f64, f64, bool)) -> bool| {
                near.retain(|_| places.next().is_some_and(beside));
            };
            let stop = if dir < 0 {
                let floor = sure.fold(f64::NEG_INFINITY, |f, p| f.max(p.0));
                keep(&|p| p.1 >= floor);
                floor
            } else {
                let ceiling = sure.fold(f64::INFINITY, |f, p| f.min(p.1));
                keep(&|p| p.0 <= ceiling);
                ceiling
            };
            if stop.is_finite() || window == span {
                return near;
            }
            reach *= FURTHER;
        }
    }
}

impl<K: Kernel> Sight<K> for Sweep<'_, K> {
    fn along(&self, chart: Chart) -> Arcs<'_> {
        let Some(edge) = self.eye.borrow().edge else {
            return Cow::Borrowed(&[]);
        };
        let last = self.free.edges()[edge as usize].last();
        Cow::Owned(self.of_chart(self.free.arcs_at(last), chart))
    }

    fn at(&self, z: &Point<K>) -> Arcs<'_> {
        let mut eye = self.eye.borrow_mut();
        if let Some(e) = eye.edge {
            let last = self.free.edges()[e as usize].last();
            let crosses = z.chart == Chart::Rest
                && z.x.sign() == 0
                && self.free.vertices()[last as usize].side != 0;
            eye.spot = if crosses {
                Spot::Edge(e)
            } else {
                Spot::Vertex(last)
            };
        } else if matches!(eye.spot, Spot::Open) {
            // At rest, or else inside of F, where no arc is.
            let touches = self.free.touches();
            let i = touches.partition_point(|c| z.t.cmp_num(&number::<K>(&c.t)).is_gt());
            match touches.get(i) {
                Some(c) if z.t.cmp_num(&number::<K>(&c.t)).is_eq() => eye.spot = Spot::Touch(i),
                _ if z.t == self.end => {
                    return Cow::Owned(self.of_chart(self.free.arcs_at_rest_end(), z.chart));
                }
                _ => {}
            }
        }
        let mut out = Vec::new();
        match eye.spot {
            Spot::Open => {}
            Spot::Vertex(v) => out = self.of_chart(self.free.arcs_at(v), z.chart),
            Spot::Edge(e) => self.beside(e, z.chart, &mut out),
            Spot::Touch(i) => {
                for &e in &self.free.touches()[i].edges {
                    self.beside(e, z.chart, &mut out);
                }
                if z.t == self.end {
                    out.extend(self.of_chart(self.free.arcs_at_rest_end(), z.chart));
                }
            }
        }
        out.sort_unstable();
        out.dedup();
        Cow::Owned(out)
    }

    fn across(
        &self,
        chart: Chart,
        t: &K::Time,
        x: Option<&K::Root>,
        dir: i32,
        to_rest: bool,
    ) -> Arcs<'_> {
        let moved = if chart == Chart::Back { 2.0 } else { 0.0 };
        let (mut lo, mut hi) = (-1.0, 1.0);
        if let Some(x) = x {
            let i = x.interval();
            if dir < 0 {
                hi = i.hi.min(1.0);
            } else {
                lo = i.lo.max(-1.0);
            }
        }
        if to_rest {
            if dir < 0 {
                lo = 0.0;
            } else {
                hi = 0.0;
            }
        }
        let slack = 1e-9;
        let when = t.interval();
        let span = [lo + moved - slack, hi + moved + slack];
        let near = match x {
            None => self.edges_across(chart, span, when),
            Some(x) => self.first_across(chart, span, when, x.interval(), dir),
        };
        let mut out = Vec::new();
        out.extend(near.iter().map(|n| n.0));
        if chart == Chart::Rest && lo <= -1.0 {
            // A level on the cut is met from below at the strip's other border.
            self.free
                .edges_near([3.0 - slack, 3.0 + slack], [when.lo, when.hi], |e| {
                    if let Owner::Arc(a) = self.free.edges()[e as usize].owner
                        && self.slice.arc(a).chart == chart
                    {
                        out.push(a);
                    }
                });
        }
        out.sort_unstable();
        out.dedup();
        Cow::Owned(out)
    }

    fn twins(&self, arc: ArcId) -> Arcs<'_> {
        Cow::Borrowed(self.free.twins(self.slice, arc))
    }

    fn next_touch(&self, after: &K::Time) -> Option<K::Time> {
        let touches = self.free.touches();
        let i = touches.partition_point(|c| after.cmp_num(&number::<K>(&c.t)).is_ge());
        touches.get(i).map(|c| K::Time::of(number::<K>(&c.t)))
    }

    fn entered(&self, state: State, at: &K::Time) -> bool {
        let mut eye = self.eye.borrow_mut();
        if *at == self.end {
            eye.edge = None;
            return true;
        }
        match state {
            State::On { arc, lower, .. } => {
                let spot = std::mem::replace(&mut eye.spot, Spot::Open);
                eye.edge = self.find(&spot, arc, lower, at);
                eye.edge.is_some()
            }
            State::Rest => {
                eye.edge = None;
                let spot = std::mem::replace(&mut eye.spot, Spot::Open);
                let vertex = match spot {
                    Spot::Vertex(v) => Some(v),
                    Spot::Touch(i) => self.free.touches()[i].vertex,
                    _ => None,
                };
                // After a snap the vertex is elsewhere, and rest lies inside of F.
                vertex.is_none_or(|v| {
                    self.free.vertices()[v as usize].side != 0 || self.free.rest_goes_on(v)
                })
            }
        }
    }

    fn vouches(&self, next: Option<&Point<K>>) -> bool {
        // On an edge: its later end, rest on the way there, or the end of the phase.
        let Some(e) = self.eye.borrow().edge else {
            return true;
        };
        let last = self.free.edges()[e as usize].last();
        let Some(z) = next else {
            return self.free.cmp_time(last, &self.end.publish()).is_ge();
        };
        // A contradiction that enclosures do not show is not looked for: this is a net, and an
        // exact comparison at every step would cost more than the sweep saves.
        match self.free.clearly(last, &z.t.publish()) {
            None => true,
            Some(order) => order.is_gt() && z.chart == Chart::Rest && z.x.sign() == 0,
        }
    }

    fn lands(&self, on: Option<(ArcId, bool)>, at: &K::Time) -> bool {
        if let Some((arc, lower)) = on {
            return self.find(&Spot::Open, arc, lower, at).is_some();
        }
        let soon = at.shift(&K::Num::one());
        let soon = if self.end < soon {
            self.end.clone()
        } else {
            soon
        };
        let next = self.next_touch(at).filter(|n| *n < soon).unwrap_or(soon);
        if next <= *at {
            return true;
        }
        let (chart, x) = (Chart::Rest, Rat::zero());
        let t = K::Time::between(at, &next).to_rat();
        self.free.locate(&Configuration { chart, x, t }) != Whereabouts::Outside
    }
}

fn number<K: Kernel>(x: &Rat) -> K::Num {
    <K::Num as Scalar>::from_rat(x)
}
