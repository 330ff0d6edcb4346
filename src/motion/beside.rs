//! Rational points beside an arc or a place, and whether the pawl is free there.
//!
//! Where combinatorics leaves open on which side of an arc free space lies, one polygon test at a rational point
//! decides: near enough to the arc that nothing else lies between, just after the instant.

use super::local::State;
use super::phase::Runner;
use super::sight::{All, Sight};
use super::trajectory::Angle;
use crate::contact::Chart;
use crate::geometry::{Polygon, Vec2, interiors_intersect};
use crate::kernel::{Instant, Kernel, Position};
use crate::number::Scalar;
use crate::slice::{ArcId, Point, Shape};

/// A rational point of the cylinder in the kernel's numbers: chart, position, time.
pub(super) type Spot<K> = (Chart, <K as Kernel>::Num, <K as Kernel>::Num);

impl<K: Kernel> Runner<'_, K> {
    /// A point of the interval that holds rest, or borders it, just after an instant.
    pub(super) fn rest_after(&self, at: &K::Time) -> Option<Spot<K>> {
        let slice = self.slice;
        let lies = |&id: &ArcId| {
            let arc = slice.arc(id);
            arc.shape == Shape::Level
                && arc.is_barrier()
                && arc.lo.x.sign() == 0
                && slice.alive_after(arc, at)
        };
        if let Some(level) = slice.arcs_in(Chart::Rest).iter().copied().find(lies) {
            return [true, false]
                .into_iter()
                .filter_map(|above| self.beside(level, above, at))
                .find(|p| self.free_at(p.clone()));
        }
        let soon = self.within_phase(at, at.shift(&K::Num::one()));
        let next = All::new(slice).next_touch(at).filter(|n| *n < soon);
        let t = K::Time::between(at, &next.unwrap_or(soon));
        Some((Chart::Rest, K::Num::zero(), t))
    }

    /// Whether the side of an arc is free just after `from`: by one polygon test at a rational
    /// point beside it, before anything meets the arc.
    pub(super) fn free_beside(&self, id: ArcId, above: bool, from: &K::Time) -> bool {
        self.beside(id, above, from)
            .is_some_and(|p| self.free_at(p))
    }

    /// A rational point beside an arc just after `from`, before anything meets the arc.
    pub(super) fn beside(&self, id: ArcId, above: bool, from: &K::Time) -> Option<Spot<K>> {
        let slice = self.slice;
        let arc = slice.arc(id);
        let mut until = self.within_phase(from, arc.end().t.clone());
        for &b in slice.arcs_in(arc.chart) {
            if b != id
                && let Some(p) = slice.first_meeting(id, b, from, &until)
            {
                until = p.t;
            }
        }
        let t = K::Time::between(from, &until);
        let x = slice.height_at(arc, &t)?;
        Some(self.near(arc.chart, &x, &t, above))
    }

    /// `until`, but not past the phase's end: what can only be met after it was never made.
    pub(super) fn within_phase(&self, from: &K::Time, until: K::Time) -> K::Time {
        if *from < self.end && self.end < until {
            self.end.clone()
        } else {
            until
        }
    }

    /// What must hold just after an instant, by the polygons alone: the state's own interval is
    /// free beside it, and at rest nothing penetrates. Asked by debug assertions only.
    pub(super) fn holds_after(&self, at: &K::Time) -> bool {
        match self.state {
            State::On { arc, lower, .. } => self.free_beside(arc, lower, at),
            State::Rest => {
                let next = self.sight.next_touch(at);
                let soon = self.within_phase(at, at.shift(&K::Num::one()));
                let t = K::Time::between(at, &next.filter(|n| *n < soon).unwrap_or(soon));
                self.clear_at(Chart::Rest, &K::Num::zero(), &t)
            }
        }
    }

    /// Whether the configuration is free just after the start along the horizontal through z,
    /// where no arc leaves z to the right.
    pub(super) fn free_along(&self, z: &Point<K>) -> bool {
        self.free_at(self.ahead(z))
    }

    /// A rational point just after the start along the horizontal through z, where no arc leaves z to the
    /// right.
    pub(super) fn ahead(&self, z: &Point<K>) -> Spot<K> {
        let slice = self.slice;
        let mut until = self.within_phase(&self.clock, K::Time::of(K::Num::one()));
        for &b in slice.arcs_in(z.chart) {
            let arc = slice.arc(b);
            if !arc.spans_x(&z.x) {
                continue;
            }
            let t = match arc.shape {
                Shape::Graph { .. } => slice.time_at(arc, &z.x),
                _ => arc.lo.t.clone(),
            };
            if t > self.clock && t < until {
                until = t;
            }
        }
        self.near(z.chart, &z.x, &K::Time::between(&self.clock, &until), true)
    }

    /// Time t and an orientation just above (or below) x, nearer than any other arc at that time.
    pub(super) fn near(&self, chart: Chart, x: &K::Root, t: &K::Num, above: bool) -> Spot<K> {
        let slice = self.slice;
        let seam = K::Root::of(K::side(above));
        let mut bound = seam;
        let when = K::Time::of(t.clone());
        for &b in slice.arcs_in(chart) {
            let arc = slice.arc(b);
            // Only what lies between x and the bound found so far can move it.
            let (low, high) = if above {
                (x.interval(), bound.interval())
            } else {
                (bound.interval(), x.interval())
            };
            if arc.x_span.hi < low.lo || high.hi < arc.x_span.lo || !slice.alive_at(arc, &when) {
                continue;
            }
            let Some(h) = slice.height_at(arc, t) else {
                continue;
            };
            if above && h > *x && h < bound || !above && h < *x && h > bound {
                bound = h;
            }
        }
        if bound == *x {
            // At the seam itself: look from the other chart.
            let x = K::Root::of(K::side(!above));
            return self.near(chart.other(), &x, t, above);
        }
        (chart, K::Root::between(x, &bound), t.clone())
    }

    /// Whether a rational point is free: between the stops, and the pawl's interior clear of every
    /// obstacle's.
    pub(super) fn free_at(&self, (chart, at, t): Spot<K>) -> bool {
        if let Some((lo, hi)) = &self.limits {
            let angle: Angle<K> = Angle {
                half_turn: chart.index() as i64,
                x: K::Root::of(at.clone()),
            };
            // Stops leave less than a turn, so any lift that lies between them will do.
            let (lo, hi): (Angle<K>, Angle<K>) =
                (Angle::from_tan_half(lo), Angle::from_tan_half(hi));
            let inside = [0, -2].iter().any(|turn| {
                let a = Angle {
                    half_turn: angle.half_turn + turn,
                    x: angle.x.clone(),
                };
                lo.cmp(&a).is_lt() && a.cmp(&hi).is_lt()
            });
            if !inside {
                return false;
            }
        }
        self.clear_at(chart, &at, &t)
    }

    /// Whether the pawl's interior is clear of every obstacle's at a rational time and position.
    pub(super) fn clear_at(&self, chart: Chart, at: &K::Num, t: &K::Num) -> bool {
        // Exact for the numbers given, also where those are doubles.
        let (at, t) = (&at.to_rat(), &t.to_rat());
        let exact = |p: &Vec2<K::Num>| Vec2::new(p.x.to_rat(), p.y.to_rat());
        let frame = &self.slice.frame;
        let p = &exact(&frame.p0) + &exact(&frame.v).scale(t);
        let ring = self.set.shape.rings()[0]
            .iter()
            .map(|a| {
                let turned = a.rotate_tan_half(at);
                let turned = if chart == Chart::Back {
                    -&turned
                } else {
                    turned
                };
                &turned + &p
            })
            .collect::<Vec<Vec2>>();
        let moved = Polygon::new(ring, Vec::new());
        !self
            .set
            .obstacles
            .iter()
            .any(|o| interiors_intersect(&moved, o))
    }
}
