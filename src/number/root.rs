//! One real root of an integer polynomial: the data behind an irrational `Algebraic`.
//!
//! The idea: a root is pinned by a square-free polynomial and an interval that holds no other root of it. What
//! is costly to know (a narrow enclosure, whether it is rational, the minimal polynomial) is worked out on the
//! first question and kept.

use super::filter::{self, Stage};
use super::float::FloatPoly;
use super::refine::{Cell, Refiner, Span};
use super::{Int, Interval, Poly, Rat};
use std::sync::{Arc, Mutex, OnceLock};

/// How wide, for its size, a double enclosure may be: some dozen units in the last place.
pub(super) const NARROW: f64 = 1e-14;

/// How many polynomials a root remembers to vanish there.
const MOST_KNOWN: usize = 16;

/// Invariant: `poly` is primitive and square-free with a positive leading coefficient; it has exactly one root
/// in the open interval `span`, none at the ends, so `sign_lo` ≠ 0 is its sign at the lower end and −sign_lo
/// that at the upper.
pub(crate) struct Root {
    pub(crate) poly: Arc<Poly>,
    pub(crate) span: Span,
    sign_lo: i32,
    // What few roots come to know is kept apart: there are several roots an arc.
    enclosure: OnceLock<(Interval, Option<Box<Span>>)>,
    /// The narrowest interval that a refinement has ended with. Cells of a grid are what they are,
    /// whatever they are found from.
    sharp: Mutex<Option<Box<Span>>>,
    /// Polynomials proven to vanish here: what is proven once is known by name from then on.
    vanishing: Mutex<Vec<Poly>>,
    rational: OnceLock<Option<Box<Rat>>>,
    minimal: OnceLock<Arc<Poly>>,
    /// Another root that has been proven to be the same number; what is proven once is one handle
    /// from then on. Links lead to lower addresses only, so they form no circle.
    same: OnceLock<Arc<Root>>,
}

impl Root {
    /// See the invariant.
    pub(crate) fn new(poly: Arc<Poly>, span: Span, sign_lo: i32) -> Root {
        debug_assert_eq!(poly.sign_at_dyadic(&span.lo, span.e), sign_lo);
        debug_assert_eq!(poly.sign_at_dyadic(&span.hi, span.e), -sign_lo);
        let (enclosure, rational, minimal) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Root {
            poly,
            span,
            sign_lo,
            enclosure,
            sharp: Mutex::new(None),
            vanishing: Mutex::new(Vec::new()),
            rational,
            minimal,
            same: OnceLock::new(),
        }
    }
    /// The handle that stands for all roots proven to be this number.
    pub(crate) fn representative(self: &Arc<Root>) -> &Arc<Root> {
        let mut root = self;
        while let Some(next) = root.same.get() {
            root = next;
        }
        root
    }
    /// Notes that two roots have been proven to be one number.
    pub(crate) fn unite(a: &Arc<Root>, b: &Arc<Root>) {
        let (a, b) = (a.representative(), b.representative());
        let (low, high) = if Arc::as_ptr(a) < Arc::as_ptr(b) {
            (a, b)
        } else {
            (b, a)
        };
        if !Arc::ptr_eq(low, high) {
            // Another thread may have linked it meanwhile; then this proof is merely not kept.
            let _ = high.same.set(low.clone());
        }
    }
    /// With an isolating interval of doubles that is itself the narrow enclosure.
    pub(crate) fn enclosed(poly: Arc<Poly>, x: Interval, sign_lo: i32) -> Root {
        let root = Root::new(poly, Span::from_doubles(x), sign_lo);
        let _ = root.enclosure.set((x, None));
        root
    }
    /// With an isolating interval that is narrow for the root's size: its hull in doubles is the enclosure.
    pub(super) fn spanned(poly: Arc<Poly>, span: Span, sign_lo: i32) -> Root {
        let x = span.hull();
        let root = Root::new(poly, span, sign_lo);
        if x.is_finite() {
            let _ = root.enclosure.set((x, None));
        }
        root
    }
    /// The one root that a square-free polynomial is proven to have in an interval of doubles.
    pub(crate) fn adopt(poly: &Poly, x: Interval) -> Option<Root> {
        if !(x.is_finite() && x.lo < x.hi) {
            return None;
        }
        let float = FloatPoly::new(poly)?;
        let sign_lo = float.one_root(x)?;
        Some(Root::new(
            Arc::new(poly.clone()),
            Span::from_doubles(x),
            sign_lo,
        ))
    }
    /// A refinement that starts from the narrowest interval reached so far, and leaves its own there.
    pub(crate) fn refine(&self) -> Refiner<'_> {
        let sharp = self.sharp.lock().unwrap_or_else(|e| e.into_inner()).clone();
        let start = sharp.unwrap_or_else(|| {
            if filter::on() {
                self.enclosure();
            }
            let best = self.enclosure.get().filter(|_| filter::on());
            let best = best.and_then(|(_, s)| s.as_deref());
            Box::new(best.unwrap_or(&self.span).clone())
        });
        Refiner::new(&self.poly, *start, self.sign_lo).keeping(&self.sharp)
    }
    /// Certified double enclosure, made once; the whole line where the filter is off.
    pub(crate) fn enclosure(&self) -> Interval {
        if !filter::on() {
            return Interval::all();
        }
        self.enclosure.get_or_init(|| self.enclose()).0
    }
    fn enclose(&self) -> (Interval, Option<Box<Span>>) {
        let polished = || {
            let ends = self.span.doubles()?;
            FloatPoly::new(&self.poly)?.polish(ends.lo, ends.hi, self.sign_lo)
        };
        let start = match polished() {
            Some(x) => {
                let span = Span::from_doubles(x);
                if x.width() <= NARROW * x.lo.abs().min(x.hi.abs()) {
                    return (x, Some(Box::new(span)));
                }
                span
            }
            None => self.span.clone(),
        };
        self.narrowed(start)
    }
    /// The same by exact refinement.
    fn narrowed(&self, start: Span) -> (Interval, Option<Box<Span>>) {
        let size = start.lo.bits().max(start.hi.bits()) as i64 - start.e as i64;
        let mut bits = (60 - size).clamp(0, 1140) as u64;
        let mut refiner = Refiner::new(&self.poly, start, self.sign_lo);
        loop {
            let k = match refiner.cell(bits) {
                Cell::Exact(r) => return (r.interval(), None),
                Cell::Between(k) => k,
            };
            let known = k.abs().bits();
            // 2^-1140 lies far below the least double.
            if known >= 58 || bits >= 1140 {
                let e = -(bits as i64);
                let hi = Rat::dyadic(&k + Int::one(), e).interval().hi;
                let x = Interval {
                    lo: Rat::dyadic(k, e).interval().lo,
                    hi,
                };
                return (x, Some(Box::new(refiner.span().clone())));
            }
            bits = if known < 2 {
                2 * bits + 64
            } else {
                bits + 60 - known
            }
            .min(1140);
        }
    }
    /// The sign of the polynomial below the root, within the isolating interval.
    pub(crate) fn sign_below(&self) -> i32 {
        self.sign_lo
    }
    /// The value where it is rational.
    pub(crate) fn to_rat(&self) -> Option<&Rat> {
        let decide = || {
            let lead = self.poly.leading()?;
            // lc·α is an integer if α is rational.
            let scaled = lead.interval() * self.enclosure();
            if scaled.lo.is_finite() && scaled.lo.ceil() > scaled.hi {
                return None;
            }
            let bits = lead.bits() + 1;
            let k = match self.refine().cell(bits) {
                Cell::Exact(r) => return Some(r),
                Cell::Between(k) => k,
            };
            // lc·k/2^bits < lc·α < lc·(k+1)/2^bits: at most one integer, the first above.
            let m = (lead * k).shr(bits) + Int::one();
            let r = Rat::new(m, lead.clone());
            let inside = self.span.low() < r && r < self.span.high();
            (inside && self.poly.sign_at(&r) == 0).then_some(r)
        };
        let decide = || decide().map(Box::new);
        self.rational.get_or_init(decide).as_deref()
    }
    /// The irreducible polynomial of the root.
    pub(crate) fn minimal(&self) -> &Arc<Poly> {
        self.minimal.get_or_init(|| {
            if let Some(r) = self.to_rat() {
                return Arc::new(linear(r));
            }
            if self.poly.coeffs().len() == 3 {
                return self.poly.clone();
            }
            let mut factors = self.poly.irreducible_factors();
            if factors.len() == 1 {
                return self.poly.clone();
            }
            let at = factors.iter().position(|f| self.span.changes_sign(f));
            // Their product has one root in the span, a simple one, and none at its ends: so one factor changes its sign
            // there, and no other does.
            Arc::new(factors.swap_remove(at.expect("one factor has the root")))
        })
    }
    /// Whether `p` vanishes at the root.
    pub(crate) fn is_root_of(&self, p: &Poly) -> bool {
        if p.is_zero() {
            return true;
        }
        // A divisor of `poly` has no root at the ends and at most one, simple, between.
        let g = self.poly.gcd_of_primitive(p);
        g.coeffs().len() > 1 && self.span.changes_sign(&g)
    }
    /// Equality, decided without refinement.
    pub(crate) fn equals(&self, o: &Root) -> bool {
        let Some(common) = self.span.common(&o.span) else {
            return false;
        };
        if Arc::ptr_eq(&self.poly, &o.poly) || self.poly == o.poly {
            // Ends of either interval are no roots, and each holds but one.
            return common.changes_sign(&self.poly);
        }
        let g = self.poly.gcd_of_primitive(&o.poly);
        g.coeffs().len() > 1 && common.changes_sign(&g)
    }
    /// Exact sign of a polynomial at the root: an interval first, then a gcd for zero, then refinement.
    pub(crate) fn sign_of(&self, p: &Poly) -> i32 {
        if let Some(s) = p.sign_over(self.enclosure()) {
            filter::settled(Stage::Double);
            return s;
        }
        let known = || self.vanishing.lock().unwrap_or_else(|e| e.into_inner());
        if filter::on() && (*p == *self.poly || known().contains(p)) {
            filter::settled(Stage::Name);
            return 0;
        }
        if self.is_root_of(p) {
            let mut known = known();
            if known.len() < MOST_KNOWN {
                known.push(p.clone());
            }
            filter::settled_exactly(true, self.poly.most_bits().max(p.most_bits()));
            return 0;
        }
        let wider = grid(self.enclosure(), 100);
        let mut bits = wider;
        let mut refiner = self.refine();
        loop {
            let k = match refiner.cell(bits) {
                Cell::Exact(r) => return p.sign_at(&r),
                Cell::Between(k) => k,
            };
            let (value, error) = value_on_cell(p, &k, bits);
            if value.abs() > error {
                if bits == wider {
                    filter::settled(Stage::Wider);
                } else {
                    filter::settled_exactly(false, value.bits());
                }
                return value.sign();
            }
            bits = 2 * bits + 32;
        }
    }
}

/// den·x − num.
pub(crate) fn linear(r: &Rat) -> Poly {
    Poly::new(vec![-r.numer(), r.denom().clone()])
}

/// Bits after the point that show about `digits` significant bits of a number, as far as doubles tell.
pub(crate) fn grid(x: Interval, digits: i64) -> u64 {
    let size = x.lo.abs().max(x.hi.abs());
    let exponent = (size.to_bits() >> 52) as i64 - 1023;
    (digits - exponent).clamp(0, 1200) as u64
}

/// A bound 2^b > |p'(x)| for |x| ≤ 2^size.
fn slope_bits(p: &Poly, size: i64) -> i64 {
    let terms = p
        .coeffs()
        .iter()
        .enumerate()
        .skip(1)
        .filter(|(_, c)| !c.is_zero());
    let most = terms
        .map(|(i, c)| c.bits() as i64 + bit_length(i) + size * (i as i64 - 1))
        .max();
    most.unwrap_or(0) + bit_length(p.coeffs().len())
}
fn bit_length(n: usize) -> i64 {
    (usize::BITS - n.leading_zeros()) as i64
}

/// The power of two that `value_on_cell` multiplies with.
pub(crate) fn scale_of(p: &Poly, bits: u64) -> i64 {
    bits as i64 * (p.coeffs().len() as i64 - 1).max(0)
}

/// (v, err): on the cell k of the grid 2^-bits the value of p, times 2^(bits·degree), is v ± err.
pub(crate) fn value_on_cell(p: &Poly, k: &Int, bits: u64) -> (Int, Int) {
    let value = p.eval_dyadic(k, bits);
    if p.coeffs().len() <= 1 {
        return (value, Int::zero());
    }
    let size = k.bits() as i64 + 1 - bits as i64;
    // |p(x) − p(k/2^b)| ≤ |p'|·2^-b
    let error = slope_bits(p, size) - bits as i64 + scale_of(p, bits);
    (value, Int::one().shl(error.max(0) as u64))
}
