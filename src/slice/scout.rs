//! Which arcs a patch has, seen in certified doubles.
//!
//! The same search as in `build.rs` (break points along x, one sample in every gap), with an interval for every
//! number. An answer is given only where every break point is enclosed apart from the others (`breaks.rs`) and every
//! sign is proven; so it is the answer that exact numbers give. What coincides by force, or has no two-dimensional
//! graph, is left to exact numbers (`None`).

use super::arc::{Arc, Shape, Side};
use super::breaks::{Breaks, Form, Truth, Zeros, at, form, holds_zero, twice, zero};
use super::shop::Shop;
use crate::contact::{Chart, Contact, Frame, Patch, Trig};
use crate::kernel::Kernel;
use crate::number::filter::{self, Stage};
use crate::number::{Enclosed, Interval, Scalar};
use std::cell::OnceCell;
use std::rc::Rc;

/// An arc as far as enclosures tell.
pub(super) struct Seen {
    contact: Contact,
    chart: Chart,
    shape: Shape,
    side: Side,
    ends: [(Interval, Interval); 2],
    at_rest: Interval,
    /// Which of its patch's arcs it is.
    k: u32,
}

impl Seen {
    pub(super) fn arc<K: Kernel>(&self, shop: Rc<Shop<K>>, patch: u32) -> Arc<K> {
        let [lo, hi] = self.ends;
        Arc {
            contact: self.contact,
            chart: self.chart,
            shape: self.shape,
            side: self.side,
            t_span: lo.1.hull(&hi.1),
            x_span: lo.0.hull(&hi.0),
            ends: self.ends,
            at_rest: self.at_rest,
            exact: OnceCell::new(),
            source: Some((shop, patch, self.k)),
        }
    }
}

fn constant(t: &Trig<Enclosed>) -> bool {
    zero(&t.c) && zero(&t.s)
}

/// The conditions of a patch in one chart.
struct View {
    f0: Form,
    f1: Form,
    wedge: [Form; 2],
    location: [(Form, Form); 2],
}

impl View {
    /// Whether the patch is real on its graph at x.
    fn valid(&self, x: Interval, f0: Interval, f1: Interval) -> Option<bool> {
        let mut sure = true;
        for w in &self.wedge {
            match at(w, x).sign() {
                Some(s) if s < 0 => return Some(false),
                Some(s) if s > 0 => {}
                _ => sure = false,
            }
        }
        let s1 = f1.sign()?;
        for (l0, l1) in &self.location {
            match (at(l0, x) * f1 - f0 * at(l1, x)).sign() {
                Some(s) if s * s1 < 0 => return Some(false),
                Some(s) if s * s1 > 0 => {}
                _ => sure = false,
            }
        }
        sure.then_some(true)
    }
    fn time(&self, x: Interval) -> Interval {
        -(at(&self.f0, x) / at(&self.f1, x))
    }
}

/// Adds the arcs of a patch that may be met within the phase. None where doubles cannot tell; what was
/// added then means nothing.
pub(super) fn look<R: Scalar>(
    patch: &Patch<Enclosed>,
    near: &Frame<Enclosed>,
    truth: &Truth<'_, R>,
    out: &mut Vec<Seen>,
) -> Option<()> {
    let end = near.duration.interval().hi;
    if never(patch, end) {
        return Some(());
    }
    if constant(&patch.f1) && zero(&patch.f1.k) {
        return levels(patch, end, truth, out);
    }
    ordinary(patch).then_some(())?;
    let v = &near.v;
    // Where a vertex meets a vertex: R a on the line through q − p₀ along v.
    let mut meet: [Option<Trig<Enclosed>>; 2] = [None, None];
    for (m, (a, q)) in meet.iter_mut().zip(&patch.ends) {
        if zero(&a.x) && zero(&a.y) {
            continue; // the hinge's own vertex meets no vertex anywhere but at the hinge
        }
        if holds_zero(&a.x) && holds_zero(&a.y) {
            return None;
        }
        let w = q - &near.p0;
        *m = Some(Trig::new(
            a.cross(v),
            a.dot(v).negated(),
            w.cross(v).negated(),
        ));
    }
    let mut k = 0;
    for chart in Chart::BOTH {
        if !patch.charts[chart.index()] {
            continue;
        }
        let pair = |i: usize| {
            let (l0, l1) = &patch.location[i];
            (form(l0, chart), form(l1, chart))
        };
        let view = View {
            f0: form(&patch.f0, chart),
            f1: form(&patch.f1, chart),
            wedge: [form(&patch.wedge[0], chart), form(&patch.wedge[1], chart)],
            location: [pair(0), pair(1)],
        };
        let mut breaks = Breaks::new(chart, truth);
        for (k, m) in meet.iter().enumerate() {
            if let Some(m) = m {
                breaks.roots(&form(m, chart), Zeros::Meet(k))?;
            }
        }
        for (k, w) in patch.wedge.iter().enumerate() {
            breaks.flush(w, Zeros::Wedge(k))?;
        }
        let bend = bend(&view.f0, &view.f1);
        if patch.squared {
            // Where the curve turns back, or has its pole, a wedge ends by force.
            if !constant(&patch.f1) {
                breaks.roots(&bend, Zeros::Bend)?;
            }
        } else if constant(&patch.f1) {
            // Type B: dt/dθ vanishes with the derivative of f₀, and there are no poles.
            breaks.flush(&patch.f0.derivative(), Zeros::Turn)?;
        } else {
            breaks.roots(&bend, Zeros::Bend)?;
            breaks.flush(&patch.f1, Zeros::Pole)?;
        }
        for w in breaks.all().windows(2) {
            let x = Interval::point(w[0].hi.midpoint(w[1].lo));
            let (f0, f1) = (at(&view.f0, x), at(&view.f1, x));
            let valid = view.valid(x, f0, f1)?;
            filter::settled(Stage::Double);
            if !valid {
                continue;
            }
            let (bends, s1) = (at(&bend, x).sign()?, f1.sign()?);
            if bends * s1 == 0 {
                return None;
            }
            let ends = [w[0], w[1]].map(|x| (x, view.time(x)));
            let span = ends[0].1.hull(&ends[1].1);
            if span.hi >= 0.0 && span.lo <= end {
                let rests = chart == Chart::Rest && w[0].hi < 0.0 && w[1].lo > 0.0;
                out.push(Seen {
                    contact: patch.contact,
                    chart,
                    shape: Shape::Graph { rising: bends < 0 },
                    side: if bends * s1 > 0 {
                        Side::Above
                    } else {
                        Side::Below
                    },
                    ends,
                    at_rest: if rests {
                        view.time(Interval::point(0.0))
                    } else {
                        Interval::all()
                    },
                    k,
                });
            }
            k += 1;
        }
    }
    Some(())
}

/// A C-function f₀ + t·f₁.
pub(super) type Function = (Trig<Enclosed>, Trig<Enclosed>);

/// Whether two functions certainly vanish at no common point with x in a range: the sign of f₀g₁ − g₀f₁ is
/// proven piece by piece.
pub(super) fn apart(f: &Function, g: &Function, chart: Chart, [lo, hi]: [f64; 2]) -> bool {
    let forms = [&f.0, &f.1, &g.0, &g.1].map(|t| form(t, chart));
    fn pieces(forms: &[Form; 4], lo: f64, hi: f64, halvings: u32) -> bool {
        let [f0, f1, g0, g1] = forms.each_ref().map(|p| at(p, Interval { lo, hi }));
        if matches!((f0 * g1 - g0 * f1).sign(), Some(1 | -1)) {
            return true;
        }
        let middle = lo.midpoint(hi);
        halvings > 0
            && pieces(forms, lo, middle, halvings - 1)
            && pieces(forms, middle, hi, halvings - 1)
    }
    const HALVINGS: u32 = 4;
    lo <= hi && pieces(&forms, lo, hi, HALVINGS)
}

/// An enclosure of where a function vanishes at t within `span`, where it surely does.
pub(super) fn position(f: &Function, chart: Chart, t: Interval, span: Interval) -> Interval {
    let (f0, f1) = (form(&f.0, chart), form(&f.1, chart));
    let [c, b, a]: Form = std::array::from_fn(|i| f0[i] + t * f1[i]);
    // There is a root, so what of the radicand is negative is error.
    let s = (b.square() - twice(twice(a * c))).sqrt();
    let roots = match b.sign() {
        // Past the chart where a is small, perhaps zero.
        Some(sign @ (1 | -1)) => {
            let q = if sign > 0 { -(b + s) } else { s - b };
            let far = 2.0 * a.lo.abs().max(a.hi.abs()) < q.lo.abs().min(q.hi.abs());
            let other = if far {
                Interval::point(f64::INFINITY)
            } else {
                q / twice(a)
            };
            [twice(c) / q, other]
        }
        _ => [(-b - s) / twice(a), (s - b) / twice(a)],
    };
    let within = |x: Interval| Interval {
        lo: x.lo.max(span.lo),
        hi: x.hi.min(span.hi),
    };
    match roots.map(|x| x.meets(&span).then(|| within(x))) {
        [Some(x), None] | [None, Some(x)] => x,
        _ => span,
    }
}

/// The arcs of a vertex that moves along an edge: each at one orientation.
fn levels<R: Scalar>(
    patch: &Patch<Enclosed>,
    end: f64,
    truth: &Truth<'_, R>,
    out: &mut Vec<Seen>,
) -> Option<()> {
    let mut k = 0;
    for chart in Chart::BOTH {
        if !patch.charts[chart.index()] {
            continue;
        }
        let f = form(&patch.f0, chart);
        let mut breaks = Breaks::new(chart, truth);
        breaks.roots(&f, Zeros::Curve)?;
        // Of a level on the seam the copy at −1 is enough.
        let first = usize::from(!breaks.seams[0]);
        let inner = breaks.all();
        'root: for &x in &inner[first..inner.len() - 1] {
            for w in &patch.wedge {
                match at(&form(w, chart), x).sign()? {
                    1 => {}
                    -1 => continue 'root,
                    _ => return None,
                }
            }
            let (mut lo, mut hi) = (None, None);
            for (l0, l1) in &patch.location {
                let (l0, l1) = (at(&form(l0, chart), x), at(&form(l1, chart), x));
                let t = -(l0 / l1);
                match l1.sign()? {
                    1 => lo = Some(t),
                    -1 => hi = Some(t),
                    _ => return None,
                }
            }
            let (lo, hi) = (lo?, hi?);
            if hi.below(&lo) {
                continue;
            }
            let slope = (twice(f[2]) * x + f[1]).sign()?;
            if slope == 0 || !lo.below(&hi) {
                return None;
            }
            filter::settled(Stage::Double);
            if hi.hi >= 0.0 && lo.lo <= end {
                out.push(Seen {
                    contact: patch.contact,
                    chart,
                    shape: Shape::Level,
                    side: if slope > 0 { Side::Above } else { Side::Below },
                    ends: [(x, lo), (x, hi)],
                    at_rest: Interval::all(),
                    k,
                });
            }
            k += 1;
        }
    }
    Some(())
}

/// Whether a contact at the hinge itself, which happens at one time, certainly does not happen: not within the
/// phase, or not on the edge.
fn never(patch: &Patch<Enclosed>, end: f64) -> bool {
    let (f0, f1) = (&patch.f0, &patch.f1);
    if !constant(f0) || !constant(f1) || holds_zero(&f1.k) {
        return false;
    }
    let t = -(f0.k.interval() / f1.k.interval());
    let beyond = |(l0, l1): &(Trig<Enclosed>, Trig<Enclosed>)| {
        constant(l0) && constant(l1) && (l0.k.interval() + t * l1.k.interval()).sign() == Some(-1)
    };
    t.hi < 0.0 || t.lo > end || patch.location.iter().any(beyond)
}

/// Whether f₀ and f₁ certainly have no common root, and f₁ does not vanish throughout: then the patch
/// is made of graphs alone.
fn ordinary(patch: &Patch<Enclosed>) -> bool {
    let (f0, f1) = (&patch.f0, &patch.f1);
    if constant(f1) {
        // Type B: f₁ is a constant.
        return !(holds_zero(&f1.k) || holds_zero(&f0.c) && holds_zero(&f0.s));
    }
    // Type A: f₁ vanishes at (cos, sin) = ±(−s₁, c₁)/ρ.
    let cross = f0.s.times(&f1.c).minus(&f0.c.times(&f1.s)).square();
    let other = f0.k.square().times(&f1.c.square().plus(&f1.s.square()));
    matches!(cross.minus(&other).interval().sign(), Some(1 | -1))
}

/// P'Q − PQ' of two quadratics: again a quadratic.
fn bend(p: &Form, q: &Form) -> Form {
    let minor = |i: usize, j: usize| p[j] * q[i] - p[i] * q[j];
    [minor(0, 1), twice(minor(0, 2)), minor(1, 2)]
}
