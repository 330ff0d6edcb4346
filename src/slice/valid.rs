//! Whether a patch is a real contact at a place of its graph: by enclosures where they can tell, exactly where not.

use crate::contact::{Chart, Patch, Trig};
use crate::number::{Interval, Scalar};

/// Interval versions of a patch's conditions in one chart, to settle samples without big numbers.
pub(super) struct Filter {
    f0: [Interval; 3],
    f1: [Interval; 3],
    wedge: [[Interval; 3]; 2],
    location: [([Interval; 3], [Interval; 3]); 2],
}

/// [`Trig::form`] of the coefficients' enclosures.
pub(super) fn enclose<R: Scalar>(t: &Trig<R>, chart: Chart) -> [Interval; 3] {
    let (c, s, k) = (t.c.interval(), t.s.interval(), t.k.interval());
    match chart {
        Chart::Rest => [k + c, s + s, k - c],
        Chart::Back => [k - c, -(s + s), k + c],
    }
}

pub(super) fn horner(f: &[Interval; 3], x: Interval) -> Interval {
    (f[2] * x + f[1]) * x + f[0]
}

impl Filter {
    pub(super) fn new<R: Scalar>(p: &Patch<R>, chart: Chart) -> Filter {
        Filter {
            f0: enclose(&p.f0, chart),
            f1: enclose(&p.f1, chart),
            wedge: [enclose(&p.wedge[0], chart), enclose(&p.wedge[1], chart)],
            location: [0, 1].map(|k| {
                (
                    enclose(&p.location[k].0, chart),
                    enclose(&p.location[k].1, chart),
                )
            }),
        }
    }
    /// Whether the patch is real on its graph at x, where the intervals can tell.
    pub(super) fn valid_graph(&self, x: Interval) -> Option<bool> {
        let mut sure = true;
        for w in &self.wedge {
            match horner(w, x).sign() {
                Some(s) if s < 0 => return Some(false),
                Some(s) if s > 0 => {}
                _ => sure = false,
            }
        }
        let (f0, f1) = (horner(&self.f0, x), horner(&self.f1, x));
        for (l0, l1) in &self.location {
            match ((horner(l0, x) * f1 - f0 * horner(l1, x)).sign(), f1.sign()) {
                (Some(a), Some(b)) if a * b < 0 => return Some(false),
                (Some(a), Some(b)) if a * b > 0 => {}
                _ => sure = false,
            }
        }
        sure.then_some(true)
    }
}

pub(super) fn wedge_ok<R: Scalar>(p: &Patch<R>, chart: Chart, x: &R) -> bool {
    p.wedge.iter().all(|w| w.value(chart, x).sign() >= 0)
}

/// Whether the patch is real at position x of its graph, exactly.
pub(super) fn valid_graph<R: Scalar>(p: &Patch<R>, chart: Chart, x: &R) -> bool {
    if !wedge_ok(p, chart, x) {
        return false;
    }
    let (f0, f1) = (p.f0.value(chart, x), p.f1.value(chart, x));
    let s = f1.sign();
    p.location.iter().all(|(l0, l1)| {
        let v = l0.value(chart, x).times(&f1);
        let v = v.minus(&f0.times(&l1.value(chart, x)));
        v.sign() * s >= 0
    })
}
