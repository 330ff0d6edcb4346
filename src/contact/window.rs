//! Which patches can matter within a phase: decided in certified intervals, before any exact
//! number is made (idea 4: what cannot be met is never made).
//!
//! Over a range of positions a patch is out of the question if one of its conditions certainly
//! fails throughout, or if the times at which its C-function vanishes certainly lie outside the
//! phase. Ranges are halved until that is so everywhere, or a few halvings have not shown it.
//! Where f₁ may vanish only the wedge conditions can exclude a range, and they bind graphs,
//! levels and walls alike; so nothing that the exact construction would keep is lost.

use super::{Chart, Patch, Trig};
use crate::number::{Enclosed, Interval, Scalar};

/// How often a range is halved.
const HALVINGS: u32 = 1;

type Form = [Interval; 3];

/// A patch's conditions in one chart.
struct Window {
    f0: Form,
    f1: Form,
    wedge: [Form; 2],
    location: [(Form, Form); 2],
    duration: f64,
}

fn form(t: &Trig<Enclosed>, chart: Chart) -> Form {
    t.form(chart).map(|e| e.interval())
}

fn at(f: &Form, x: Interval) -> Interval {
    (f[2] * x + f[1]) * x + f[0]
}

/// In which charts a patch may be met within a phase that lasts at most `duration`.
pub(super) fn charts(patch: &Patch<Enclosed>, duration: f64) -> [bool; 2] {
    Chart::BOTH.map(|chart| {
        let pair = |k: usize| {
            let (l0, l1) = &patch.location[k];
            (form(l0, chart), form(l1, chart))
        };
        let w = Window {
            f0: form(&patch.f0, chart),
            f1: form(&patch.f1, chart),
            wedge: [form(&patch.wedge[0], chart), form(&patch.wedge[1], chart)],
            location: [pair(0), pair(1)],
            duration,
        };
        !w.empty(-1.0, 1.0, HALVINGS)
    })
}

impl Window {
    fn empty(&self, lo: f64, hi: f64, halvings: u32) -> bool {
        let x = Interval { lo, hi };
        let below = |i: Interval| i.hi < 0.0;
        if self.wedge.iter().any(|w| below(at(w, x))) {
            return true;
        }
        let f1 = at(&self.f1, x);
        if let Some(s) = f1.sign().filter(|s| *s != 0) {
            let f0 = at(&self.f0, x);
            let t = -(f0 / f1);
            if t.hi < 0.0 || t.lo > self.duration {
                return true;
            }
            for (l0, l1) in &self.location {
                let v = at(l0, x) * f1 - f0 * at(l1, x);
                if v.sign() == Some(-s) {
                    return true;
                }
            }
        }
        if halvings == 0 {
            return false;
        }
        let middle = lo.midpoint(hi);
        self.empty(lo, middle, halvings - 1) && self.empty(middle, hi, halvings - 1)
    }
}
