//! Where along x the picture of a patch may change: its break points, each enclosed by doubles.
//!
//! They are the seams of the chart and zeros of quadratics in x. A root is taken in only where it is proven to lie
//! inside or outside of the chart, and apart from all that are there. Where a root may lie on a seam, or two functions
//! may have the same roots (right angles force both), the exact patch is asked ([`Truth`]), a few products each; that
//! costs a tenth of working the patch out.

use crate::contact::{Chart, Frame, Patch, Trig};
use crate::number::filter::{self, Stage};
use crate::number::{Enclosed, Interval, Scalar};
use std::cell::OnceCell;

/// Two ends of edges, two flush edges, two tangencies, two poles, each twice, and the seams.
const MOST: usize = 16;

/// Functions whose zeros are break points, of one patch.
const FUNCTIONS: usize = 6;

/// A quadratic in x, constant first.
pub(super) type Form = [Interval; 3];

pub(super) fn at(f: &Form, x: Interval) -> Interval {
    (f[2] * x + f[1]) * x + f[0]
}

pub(super) fn form(t: &Trig<Enclosed>, chart: Chart) -> Form {
    t.form(chart).map(|e| e.interval())
}

pub(super) fn twice(i: Interval) -> Interval {
    Interval {
        lo: 2.0 * i.lo,
        hi: 2.0 * i.hi,
    }
}

pub(super) fn zero(e: &Enclosed) -> bool {
    e.interval() == Interval::point(0.0)
}

pub(super) fn holds_zero(e: &Enclosed) -> bool {
    e.interval().contains(0.0)
}

/// The functions of an orientation whose zeros are break points of a patch.
#[derive(Clone, Copy, Debug)]
pub(super) enum Zeros {
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
pub(super) struct Breaks<'a, R: Scalar> {
    at: [Interval; MOST],
    len: usize,
    chart: Chart,
    /// Whether the last function looked at has a root on the lower or the upper seam.
    pub(super) seams: [bool; 2],
    /// The functions whose roots are all here.
    known: [Option<Zeros>; FUNCTIONS],
    truth: &'a Truth<'a, R>,
}

impl<'a, R: Scalar> Breaks<'a, R> {
    /// The seams.
    pub(super) fn new(chart: Chart, truth: &'a Truth<'a, R>) -> Breaks<'a, R> {
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
    pub(super) fn all(&self) -> &[Interval] {
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
    pub(super) fn flush(&mut self, w: &Trig<Enclosed>, which: Zeros) -> Option<()> {
        if zero(&w.s) && !holds_zero(&w.c) {
            return Some(());
        }
        if zero(&w.c) && !holds_zero(&w.s) {
            return self.root(Interval::point(0.0));
        }
        self.roots(&form(w, self.chart), which)
    }
    /// The roots of c + bx + ax², unless they are those of a function that was looked at.
    pub(super) fn roots(&mut self, f: &Form, which: Zeros) -> Option<()> {
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
