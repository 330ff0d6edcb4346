//! Which arcs a patch has, seen in certified doubles.
//!
//! The same search as in `build.rs` (break points along x, one sample in every gap), with an interval for every
//! number. An answer is given only where each root is proven to lie inside or outside of the chart, no two of them
//! may be equal, and every sign is proven; so it is the answer that exact numbers give. Where a root may lie on a
//! seam, or two functions may have the same roots (right angles force both), the exact patch is asked, a few
//! products each; that costs a tenth of working the patch out. What else coincides by force, or has no two-dimensional
//! graph, is left to exact numbers (`None`).

use super::arc::{Arc, Shape, Side};
use super::shop::Shop;
use crate::contact::{Chart, Contact, Frame, Patch, Trig};
use crate::kernel::Kernel;
use crate::number::filter::{self, Stage};
use crate::number::{Enclosed, Interval, Scalar};
use std::cell::OnceCell;
use std::rc::Rc;

/// Two ends of edges, two flush edges, two tangencies, two poles, each twice, and the seams.
const MOST: usize = 16;

/// Functions whose zeros are break points, of one patch.
const FUNCTIONS: usize = 6;

type Form = [Interval; 3];

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

fn at(f: &Form, x: Interval) -> Interval {
    (f[2] * x + f[1]) * x + f[0]
}

fn form(t: &Trig<Enclosed>, chart: Chart) -> Form {
    t.form(chart).map(|e| e.interval())
}

fn twice(i: Interval) -> Interval {
    Interval {
        lo: 2.0 * i.lo,
        hi: 2.0 * i.hi,
    }
}

fn zero(e: &Enclosed) -> bool {
    e.interval() == Interval::point(0.0)
}

fn constant(t: &Trig<Enclosed>) -> bool {
    zero(&t.c) && zero(&t.s)
}

fn holds_zero(e: &Enclosed) -> bool {
    e.interval().contains(0.0)
}

/// The functions of an orientation whose zeros are break points of a patch.
#[derive(Clone, Copy, Debug)]
enum Zeros {
    /// Where the k-th end of the edge is met.
    Meet(usize),
    /// Where the k-th neighbouring edge is flush.
    Wedge(usize),
    /// f₀.
    Curve,
    /// The derivative of f₀.
    Turn,
    /// f₁.
    Pole,
    /// f₀'f₁ − f₀f₁', where the time is extreme.
    Bend,
}

/// How a quadratic behaves at an end of the chart, by exact numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum AtSeam {
    /// It does not vanish.
    No,
    /// One root is there.
    Once,
    /// Both roots are.
    Twice,
}

impl AtSeam {
    /// By the coefficients, constant first.
    fn of<R: Scalar>([c, b, a]: &[R; 3], end: i32) -> AtSeam {
        let both = a.plus(c);
        let value = if end > 0 { both.plus(b) } else { both.minus(b) };
        if !value.is_zero() {
            AtSeam::No
        } else if a == c {
            AtSeam::Twice // the product of the roots is c/a
        } else {
            AtSeam::Once
        }
    }
}

/// The patch in exact numbers, made when something is asked of it.
pub(super) struct Truth<'a, R: Scalar> {
    frame: &'a Frame<R>,
    make: &'a dyn Fn() -> Patch<R>,
    patch: OnceCell<Box<Patch<R>>>,
}

impl<'a, R: Scalar> Truth<'a, R> {
    pub(super) fn new(frame: &'a Frame<R>, make: &'a dyn Fn() -> Patch<R>) -> Truth<'a, R> {
        Truth {
            frame,
            make,
            patch: OnceCell::new(),
        }
    }
    /// The patch, if it was made.
    pub(super) fn into_patch(self) -> Option<Box<Patch<R>>> {
        self.patch.into_inner()
    }
    fn form(&self, which: Zeros, chart: Chart) -> [R; 3] {
        let patch = self.patch.get_or_init(|| Box::new((self.make)()));
        match which {
            Zeros::Meet(k) => {
                let (a, q) = &patch.ends[k];
                let (v, w) = (&self.frame.v, q - &self.frame.p0);
                Trig::new(a.cross(v), a.dot(v).negated(), w.cross(v).negated()).form(chart)
            }
            Zeros::Wedge(k) => patch.wedge[k].form(chart),
            Zeros::Curve => patch.f0.form(chart),
            Zeros::Turn => patch.f0.derivative().form(chart),
            Zeros::Pole => patch.f1.form(chart),
            Zeros::Bend => {
                let (p, q) = (patch.f0.form(chart), patch.f1.form(chart));
                let minor = |i: usize, j: usize| p[j].times(&q[i]).minus(&p[i].times(&q[j]));
                let middle = minor(0, 2);
                [minor(0, 1), middle.plus(&middle), minor(1, 2)]
            }
        }
    }
    fn at_seam(&self, which: Zeros, chart: Chart, end: i32) -> AtSeam {
        let found = AtSeam::of(&self.form(which, chart), end);
        filter::settled_exactly(found != AtSeam::No, 0);
        found
    }
    /// Whether two functions are multiples of one another, so that their roots are the same.
    fn proportional(&self, a: Zeros, b: Zeros, chart: Chart) -> bool {
        let (a, b) = (self.form(a, chart), self.form(b, chart));
        let minor = |i: usize, j: usize| a[i].times(&b[j]) == a[j].times(&b[i]);
        let yes = minor(0, 1) && minor(1, 2) && minor(0, 2) && b.iter().any(|c| !c.is_zero());
        filter::settled_exactly(yes, 0);
        yes
    }
}

/// Enclosures of break points, ascending, no two of which meet.
struct Breaks<'a, R: Scalar> {
    at: [Interval; MOST],
    len: usize,
    chart: Chart,
    /// Whether the last function looked at has a root on the lower or the upper seam.
    seams: [bool; 2],
    /// The functions whose roots are all here.
    known: [Option<Zeros>; FUNCTIONS],
    truth: &'a Truth<'a, R>,
}

impl<'a, R: Scalar> Breaks<'a, R> {
    /// The seams.
    fn new(chart: Chart, truth: &'a Truth<'a, R>) -> Breaks<'a, R> {
        let mut at = [Interval::point(1.0); MOST];
        at[0] = Interval::point(-1.0);
        Breaks {
            at,
            len: 2,
            chart,
            seams: [false; 2],
            known: [None; FUNCTIONS],
            truth,
        }
    }
    fn all(&self) -> &[Interval] {
        &self.at[..self.len]
    }
    /// Takes in a root if it lies within the chart; None if that is not certain, or it may be one that
    /// is there.
    fn root(&mut self, x: Interval) -> Option<()> {
        if x.lo > 1.0 || x.hi < -1.0 {
            filter::settled(Stage::Double);
            return Some(());
        }
        let i = self.all().iter().position(|b| !b.below(&x))?;
        if x.lo == x.hi && self.at[i] == x {
            return Some(()); // both are this very double
        }
        if i == 0 || !x.below(&self.at[i]) || self.len == MOST {
            return None;
        }
        // One question as the ledger counts: inside, and where among the others.
        filter::settled(Stage::Double);
        self.at.copy_within(i..self.len, i + 1);
        self.at[i] = x;
        self.len += 1;
        Some(())
    }
    /// The roots of c·cos θ + s·sin θ: where an edge is flush, or a distance extreme. What runs along the axes has
    /// them at θ = 0 or on a seam, exactly.
    fn flush(&mut self, w: &Trig<Enclosed>, which: Zeros) -> Option<()> {
        if zero(&w.s) && !holds_zero(&w.c) {
            return Some(());
        }
        if zero(&w.c) && !holds_zero(&w.s) {
            return self.root(Interval::point(0.0));
        }
        self.roots(&form(w, self.chart), which)
    }
    /// The roots of c + bx + ax², unless they are those of a function that was looked at.
    fn roots(&mut self, f: &Form, which: Zeros) -> Option<()> {
        if self.find(f, which).is_none() {
            // Nothing was taken in: the first of the roots in the chart is met already.
            let same = |k: &Zeros| self.truth.proportional(which, *k, self.chart);
            self.known.iter().flatten().any(same).then_some(())?;
        }
        let room = self.known.iter_mut().find(|k| k.is_none());
        room.map(|k| *k = Some(which))
    }
    fn find(&mut self, f: &Form, which: Zeros) -> Option<()> {
        let whole = Interval { lo: -1.0, hi: 1.0 };
        if matches!(at(f, whole).sign(), Some(1 | -1)) {
            filter::settled(Stage::Double);
            return Some(());
        }
        let [c, b, a] = *f;
        // a + c ± b are the values at the seams. This only picks whom to ask.
        let (sum, size) = (a.lo + c.lo, a.lo.abs() + c.lo.abs());
        let near = (sum.abs() - b.lo.abs()).abs() <= 1e-9 * size;
        let mut hits = [false; 2];
        for (hit, end) in hits.iter_mut().zip([-1, 1]).filter(|_| near) {
            let value = if end > 0 { a + c + b } else { a + c - b };
            if value.contains(0.0) {
                match self.truth.at_seam(which, self.chart, end) {
                    AtSeam::No => {}
                    AtSeam::Once => *hit = true,
                    AtSeam::Twice => return None,
                }
            }
        }
        if hits[0] || hits[1] {
            self.seams = hits;
            if hits == [true; 2] {
                return Some(());
            }
            // The other root is c/a or −c/a: past the chart where a is small, perhaps zero.
            let least = c.lo.abs().min(c.hi.abs());
            if !c.contains(0.0) && a.lo.abs().max(a.hi.abs()) < least {
                return Some(());
            }
            return self.root(if hits[1] { c / a } else { -(c / a) });
        }
        let d = b.square() - twice(twice(a * c));
        let s = match d.sign()? {
            1 => d.sqrt(),
            -1 => {
                filter::settled(Stage::Double);
                return Some(());
            }
            _ => return None,
        };
        let sign = b.sign().unwrap_or(0);
        if sign == 0 {
            // No cancellation worth the name: b is small beside s.
            let a = twice(a);
            self.root((-b - s) / a)?;
            return self.root((s - b) / a);
        }
        let q = if sign > 0 { -(b + s) } else { s - b };
        self.root(twice(c) / q)?;
        // The other root, −q/2a, is past the chart where a is small beside q.
        let (most, least) = (a.lo.abs().max(a.hi.abs()), q.lo.abs().min(q.hi.abs()));
        if 2.0 * most < least {
            return Some(());
        }
        self.root(q / twice(a))
    }
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
        'root: for &x in &breaks.all()[first..breaks.len - 1] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Rat;

    #[test]
    fn exact_roots_at_a_seam() {
        let of = |c: [i64; 3], end| AtSeam::of(&c.map(Rat::from), end);
        // (x − 1)(2x + 3)
        assert_eq!(of([-3, 1, 2], 1), AtSeam::Once);
        assert_eq!(of([-3, 1, 2], -1), AtSeam::No);
        // (x − 1)(x + 1), and a line through −1.
        assert_eq!([of([-1, 0, 1], 1), of([-1, 0, 1], -1)], [AtSeam::Once; 2]);
        assert_eq!(of([4, 4, 0], -1), AtSeam::Once);
        // −3(x + 1)²
        assert_eq!(of([-3, -6, -3], -1), AtSeam::Twice);
        assert_eq!(of([-3, -6, -3], 1), AtSeam::No);
    }
}
