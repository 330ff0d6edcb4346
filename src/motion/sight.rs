//! What the runner can see: the one thing in which the two methods differ.
//!
//! The rules of motion are stated once (`phase.rs`, `local.rs`); to apply them the runner needs arcs to look at:
//! which may meet the one it follows, which hold a point, which stand in the way of a snap. A [`Sight`]
//! names candidates, and the exact questions are then asked of these alone. [`All`] names every
//! arc there is: DP's simple algorithm, O(n) a step. The sweep's sight (`sweep.rs`) names those
//! that the boundary of F has at the place, O(1) a step. A sight that names too many costs time only;
//! so equal results mean that F named enough.

use super::local::State;
use crate::contact::Chart;
use crate::kernel::{Instant, Kernel, Position};
use crate::number::{Interval, Scalar};
use crate::slice::{ArcId, Point, Shape, Slice};
use std::borrow::Cow;
use std::cell::OnceCell;

/// Candidates, in ascending order of arc.
pub(super) type Arcs<'s> = Cow<'s, [ArcId]>;

/// Which arcs may matter.
pub(super) trait Sight<K: Kernel> {
    /// Those of a chart that may be the next to meet the arc that the state follows.
    fn along(&self, chart: Chart) -> Arcs<'_>;
    /// Those that may hold a point.
    fn at(&self, z: &Point<K>) -> Arcs<'_>;
    /// Those of a chart that may stand in the way of a snap just after t, from x (or the chart's end)
    /// towards rest (or the chart's other end), downwards or upwards.
    fn across(
        &self,
        chart: Chart,
        t: &K::Time,
        x: Option<&K::Root>,
        dir: i32,
        to_rest: bool,
    ) -> Arcs<'_>;
    /// Those that may coincide with an arc.
    fn twins(&self, arc: ArcId) -> Arcs<'_>;
    /// The next instant after one at which rest may be touched.
    fn next_touch(&self, after: &K::Time) -> Option<K::Time>;
    /// The state has changed, at an instant. False if this sight cannot see it from there on.
    fn entered(&self, state: State, at: &K::Time) -> bool;
    /// Whether a point (None: none within the phase) can be the state's next. False if what was named
    /// contradicts itself; then nothing that it named is to be used.
    fn vouches(&self, next: Option<&Point<K>>) -> bool;
    /// Whether a snap at an instant may land on an arc (None: at rest): an interval that the sight knows of
    /// must end there.
    fn lands(&self, on: Option<(ArcId, bool)>, at: &K::Time) -> bool;
}

/// Every arc there is.
pub(super) struct All<'a, K: Kernel> {
    slice: &'a Slice<K>,
    touches: Vec<Touch<K>>,
}

/// An arc that touches rest: when, and what encloses that. Ascending by time where numbers are compared as they
/// are, by lower ends where enclosures come first: then most times are never made.
struct Touch<K: Kernel> {
    rough: Interval,
    arc: ArcId,
    time: OnceCell<K::Time>,
}

impl<'a, K: Kernel> All<'a, K> {
    pub(super) fn new(slice: &'a Slice<K>) -> All<'a, K> {
        let zero = K::Root::of(K::Num::zero());
        let mut all = All {
            slice,
            touches: Vec::new(),
        };
        for &id in slice.arcs_in(Chart::Rest) {
            let arc = slice.arc(id);
            if arc.is_barrier() && arc.spans_x(&zero) {
                let mut touch = Touch {
                    rough: arc.rest_span(),
                    arc: id,
                    time: OnceCell::new(),
                };
                if !(K::ENCLOSES && touch.rough.is_finite()) {
                    touch.rough = all.time(&touch).interval();
                }
                all.touches.push(touch);
            }
        }
        if K::ENCLOSES {
            all.touches
                .sort_by(|a, b| a.rough.lo.total_cmp(&b.rough.lo));
        } else {
            let mut touches = std::mem::take(&mut all.touches);
            touches.sort_by(|a, b| all.time(a).cmp(all.time(b)));
            touches.dedup_by(|b, a| all.time(a) == all.time(b));
            all.touches = touches;
        }
        all
    }

    fn time<'t>(&self, touch: &'t Touch<K>) -> &'t K::Time {
        touch.time.get_or_init(|| {
            let arc = self.slice.arc(touch.arc);
            match arc.shape {
                Shape::Graph { .. } => {
                    let zero = K::Root::of(K::Num::zero());
                    self.slice.time_at(arc, &zero)
                }
                _ => arc.lo.t.clone(),
            }
        })
    }
}

impl<K: Kernel> Sight<K> for All<'_, K> {
    fn along(&self, chart: Chart) -> Arcs<'_> {
        Cow::Borrowed(self.slice.arcs_in(chart))
    }
    fn at(&self, z: &Point<K>) -> Arcs<'_> {
        Cow::Borrowed(self.slice.arcs_in(z.chart))
    }
    fn across(&self, chart: Chart, _: &K::Time, _: Option<&K::Root>, _: i32, _: bool) -> Arcs<'_> {
        Cow::Borrowed(self.slice.arcs_in(chart))
    }
    fn twins(&self, arc: ArcId) -> Arcs<'_> {
        Cow::Borrowed(self.slice.arcs_in(self.slice.arc(arc).chart))
    }
    fn next_touch(&self, after: &K::Time) -> Option<K::Time> {
        if !K::ENCLOSES {
            let i = self.touches.partition_point(|t| self.time(t) <= after);
            return self.touches.get(i).map(|t| self.time(t).clone());
        }
        let past = after.interval();
        let mut next: Option<&K::Time> = None;
        for touch in &self.touches {
            if next.is_some_and(|n| n.interval().below(&touch.rough)) {
                break;
            }
            if touch.rough.below(&past) {
                continue;
            }
            let t = self.time(touch);
            if t > after && next.is_none_or(|n| t < n) {
                next = Some(t);
            }
        }
        next.cloned()
    }
    fn entered(&self, _: State, _: &K::Time) -> bool {
        true
    }
    fn vouches(&self, _: Option<&Point<K>>) -> bool {
        true
    }
    fn lands(&self, _: Option<(ArcId, bool)>, _: &K::Time) -> bool {
        true
    }
}
