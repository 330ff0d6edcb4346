//! Ever narrower intervals around one root.
//!
//! The idea (quadratic interval refinement, Abbott 2006): cut the interval into 2^t equal parts, let the
//! secant through its ends point at one of them, and check the signs at the ends of that part. While the
//! guess is right, t doubles: the precision squares with every step, at the price of two exact evaluations. A
//! wrong guess halves t, down to plain bisection, so nothing depends on luck.

use super::{Int, Interval, Poly, Rat, rat::decompose};
use std::sync::Mutex;

/// The open interval (lo, hi)/2^e.
#[derive(Clone)]
pub(crate) struct Span {
    pub(crate) lo: Int,
    pub(crate) hi: Int,
    pub(crate) e: u64,
}

/// Where a number lies on the grid of step 2^-b.
pub(crate) enum Cell {
    /// It is this rational number, met on the way.
    Exact(Rat),
    /// Strictly between k/2^b and (k+1)/2^b.
    Between(Int),
}

impl Span {
    /// Doubles lo < hi, exactly.
    pub(crate) fn from_doubles(x: Interval) -> Span {
        let ((m, a), (n, b)) = (decompose(x.lo), decompose(x.hi));
        let e = 0.max(-a).max(-b);
        Span {
            lo: Int::from(m).shl((a + e) as u64),
            hi: Int::from(n).shl((b + e) as u64),
            e: e as u64,
        }
    }
    /// The ends as doubles, where both are doubles.
    pub(crate) fn doubles(&self) -> Option<Interval> {
        let (lo, hi) = (
            self.lo.interval_shifted(-(self.e as i64)),
            self.hi.interval_shifted(-(self.e as i64)),
        );
        (lo.lo == lo.hi && hi.lo == hi.hi).then_some(Interval {
            lo: lo.lo,
            hi: hi.lo,
        })
    }
    /// Doubles around it.
    pub(crate) fn hull(&self) -> Interval {
        let e = -(self.e as i64);
        Interval {
            lo: self.lo.interval_shifted(e).lo,
            hi: self.hi.interval_shifted(e).hi,
        }
    }
    pub(crate) fn low(&self) -> Rat {
        Rat::dyadic(self.lo.clone(), -(self.e as i64))
    }
    pub(crate) fn high(&self) -> Rat {
        Rat::dyadic(self.hi.clone(), -(self.e as i64))
    }
    /// The part that two intervals share, unless it is empty.
    pub(crate) fn common(&self, o: &Span) -> Option<Span> {
        let e = self.e.max(o.e);
        let at = |v: &Int, from: u64| v.shl(e - from);
        let lo = at(&self.lo, self.e).max(at(&o.lo, o.e));
        let hi = at(&self.hi, self.e).min(at(&o.hi, o.e));
        (lo < hi).then_some(Span { lo, hi, e })
    }
    /// Whether `p` has different non-zero signs at the ends.
    pub(crate) fn changes_sign(&self, p: &Poly) -> bool {
        let sign = |v: &Int| {
            let about = v.interval_shifted(-(self.e as i64));
            p.sign_over(about)
                .unwrap_or_else(|| p.sign_at_dyadic(v, self.e))
        };
        sign(&self.lo) * sign(&self.hi) < 0
    }
}

/// A refinement under way: keeps what it knows from one question to the next, finer one.
pub(crate) struct Refiner<'a> {
    p: &'a Poly,
    sign_lo: i32,
    span: Span,
    /// hi − lo, the same number of units 2^-e at every precision.
    width: Int,
    /// The values at the ends, times 2^(e·degree).
    ends: Option<(Int, Int)>,
    /// The next cut is into 2^t parts.
    t: u64,
    exact: Option<Rat>,
    /// Where the interval reached is left for the next refinement, with its precision at the start.
    keep: Option<(&'a Mutex<Option<Box<Span>>>, u64)>,
}

impl Drop for Refiner<'_> {
    fn drop(&mut self) {
        if let Some((place, from)) = self.keep
            && self.span.e > from
        {
            let mut kept = place.lock().unwrap_or_else(|e| e.into_inner());
            if kept.as_ref().is_none_or(|s| s.e < self.span.e) {
                *kept = Some(Box::new(self.span.clone()));
            }
        }
    }
}

impl<'a> Refiner<'a> {
    /// `p` has the sign `sign_lo` at the lower end of `span`, the opposite one at the upper, and one root
    /// between.
    pub(crate) fn new(p: &'a Poly, span: Span, sign_lo: i32) -> Refiner<'a> {
        let width = &span.hi - &span.lo;
        // As many digits as the ends agree on, a secant should be good for again.
        let t = (span
            .lo
            .bits()
            .max(span.hi.bits())
            .saturating_sub(width.bits() + 3))
        .clamp(1, 1 << 12);
        Refiner {
            p,
            sign_lo,
            span,
            width,
            ends: None,
            t,
            exact: None,
            keep: None,
        }
    }
    /// The same, leaving the interval that it ends with.
    pub(crate) fn keeping(mut self, place: &'a Mutex<Option<Box<Span>>>) -> Refiner<'a> {
        self.keep = Some((place, self.span.e));
        self
    }
    /// The interval reached so far.
    pub(crate) fn span(&self) -> &Span {
        &self.span
    }
    /// The cell of the grid of step 2^-bits that holds the root. Cost: a few evaluations at numbers of about
    /// `bits` bits.
    pub(crate) fn cell(&mut self, bits: u64) -> Cell {
        let w = self.width.bits();
        while self.exact.is_none() && self.span.e < bits + w {
            self.step(bits + w - self.span.e);
        }
        if let Some(r) = &self.exact {
            return Cell::Exact(r.clone());
        }
        // The interval is no wider than a cell now, and no coarser: at most one grid point is inside.
        let drop = self.span.e - bits;
        let cut = self.span.lo.shr(drop) + Int::one();
        if self.span.hi <= cut.shl(drop) {
            return Cell::Between(cut - Int::one());
        }
        let s = self.p.sign_at_dyadic(&cut, bits);
        if s == 0 {
            Cell::Exact(Rat::dyadic(cut, -(bits as i64)))
        } else if s == self.sign_lo {
            Cell::Between(cut)
        } else {
            Cell::Between(cut - Int::one())
        }
    }
    /// Gains at most `most` ≥ 1 bits.
    fn step(&mut self, most: u64) {
        let p = self.p;
        let n = p.coeffs().len() as u64 - 1;
        let Span { lo, hi, e } = &self.span;
        let (at_lo, at_hi) = self
            .ends
            .get_or_insert_with(|| (p.eval_dyadic(lo, *e), p.eval_dyadic(hi, *e)));
        let t = self.t.min(most);
        let j = secant(at_lo, at_hi, t);
        let fine = e + t;
        let x = lo.shl(t) + &self.width * &j;
        let at_x = p.eval_dyadic(&x, fine);
        let s = at_x.sign();
        if s == 0 {
            self.exact = Some(Rat::dyadic(x, -(fine as i64)));
            return;
        }
        let below = s == self.sign_lo;
        // The other end of the part that the secant points at.
        let y = if below {
            &x + &self.width
        } else {
            &x - &self.width
        };
        let at_y = if below && j + Int::one() == Int::one().shl(t) {
            at_hi.shl(t * n)
        } else if !below && y == lo.shl(t) {
            at_lo.shl(t * n)
        } else {
            p.eval_dyadic(&y, fine)
        };
        if at_y.is_zero() {
            self.exact = Some(Rat::dyadic(y, -(fine as i64)));
            return;
        }
        if (at_y.sign() == self.sign_lo) == below {
            // Not in this part: too bold. With t = 1 the parts are the two halves, so this ends.
            self.t = t / 2;
            return;
        }
        let ((lo, at_lo), (hi, at_hi)) = if below {
            ((x, at_x), (y, at_y))
        } else {
            ((y, at_y), (x, at_x))
        };
        self.span = Span { lo, hi, e: fine };
        self.ends = Some((at_lo, at_hi));
        // A step cut short at the precision asked for says nothing against longer ones.
        self.t = self.t.max(2 * t);
    }
}

/// Of 2^t equal parts of the interval, how many lie below the zero of the secant through the values at the
/// ends, which differ in sign; rounded, within 1..2^t.
fn secant(at_lo: &Int, at_hi: &Int, t: u64) -> Int {
    if t == 1 {
        return Int::one();
    }
    let rise = at_hi - at_lo;
    // More leading bits than the quotient has would be wasted.
    let cut = rise.bits().saturating_sub(t + 16);
    let (d, s) = (at_lo.shr(cut).abs(), rise.shr(cut).abs());
    let q = (d.shl(t + 1).div_rem_floor(&s).0 + Int::one()).shr(1);
    q.max(Int::one()).min(Int::one().shl(t) - Int::one())
}
