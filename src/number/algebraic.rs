//! Real algebraic numbers: exact answers about irrational roots.
//!
//! The idea: a root is a square-free integer polynomial and an interval that holds no other root of it. Two
//! numbers are told apart first by their double enclosures; if those meet, a gcd decides equality for good;
//! only numbers known to differ are refined, and refinement squares its precision with every step (quadratic
//! interval refinement, Abbott 2006). So each question ends, and only near coincidences pay for it.
//! Values have no history: a number made by a long computation costs no more than one read from a file.

use super::isolate::Isolated;
use super::modular::gcd_degree_bound;
use super::rat::decompose;
use super::{Int, Interval, Poly, Rat};
use std::cmp::Ordering;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// A real algebraic number: a rational, or the one root of a square-free integer polynomial in an isolating
/// interval. Immutable, Send + Sync, cheap to clone. Equality and order are those of the numbers.
///
/// # Example
/// ```
/// use snapfit::number::{Algebraic, Poly, Rat};
/// let sqrt2 = Poly::from_i64(&[-2, 0, 1]).real_roots().remove(1);
/// let sum = Poly::from_i64(&[-4, 0, 2]).real_roots().remove(1);
/// assert_eq!(sqrt2, sum);
/// assert!(sqrt2 > Algebraic::from(Rat::frac(141, 100)));
/// assert_eq!(sqrt2.to_rat(), None);
/// ```
#[derive(Clone)]
pub struct Algebraic(Repr);

#[derive(Clone)]
enum Repr {
    Rational(Arc<Known>),
    Root(Arc<Root>),
}
use Repr::{Rational, Root as RootOf};

struct Known {
    value: Rat,
    interval: Interval,
}

/// Invariant: `poly` is primitive and square-free with a positive leading coefficient; it has exactly one root
/// in the open interval (lo, hi)/2^e, none at the ends, so `sign_lo` ≠ 0 is its sign at lo and −sign_lo that
/// at hi.
struct Root {
    poly: Arc<Poly>,
    span: Span,
    sign_lo: i32,
    enclosure: OnceLock<Interval>,
    rational: OnceLock<Option<Rat>>,
    minimal: OnceLock<Arc<Poly>>,
}

/// The interval (lo/2^e, hi/2^e).
#[derive(Clone)]
struct Span {
    lo: Int,
    hi: Int,
    e: u64,
}

/// Where a number lies on the grid of step 2^-b.
enum Cell {
    /// It is this rational number, met on the way.
    Exact(Rat),
    /// Strictly between k/2^b and (k+1)/2^b.
    Between(Int),
}

impl Span {
    /// Doubles lo < hi, exactly.
    fn from_doubles(x: Interval) -> Span {
        let ((m, a), (n, b)) = (decompose(x.lo), decompose(x.hi));
        let e = 0.max(-a).max(-b);
        Span {
            lo: Int::from(m).shl((a + e) as u64),
            hi: Int::from(n).shl((b + e) as u64),
            e: e as u64,
        }
    }
    fn common(&self, o: &Span) -> Option<Span> {
        let e = self.e.max(o.e);
        let at = |v: &Int, from: u64| v.shl(e - from);
        let lo = at(&self.lo, self.e).max(at(&o.lo, o.e));
        let hi = at(&self.hi, self.e).min(at(&o.hi, o.e));
        (lo < hi).then_some(Span { lo, hi, e })
    }
    /// Whether `p` has different non-zero signs at the ends.
    fn changes_sign(&self, p: &Poly) -> bool {
        p.sign_at_dyadic(&self.lo, self.e) * p.sign_at_dyadic(&self.hi, self.e) < 0
    }
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

impl Root {
    fn new(poly: Arc<Poly>, span: Span, sign_lo: i32, enclosure: OnceLock<Interval>) -> Root {
        Root {
            poly,
            span,
            sign_lo,
            enclosure,
            rational: OnceLock::new(),
            minimal: OnceLock::new(),
        }
    }

    /// The cell of the grid of step 2^-bits that holds the root. Cost: a few evaluations at numbers of about
    /// `bits` bits.
    fn cell(&self, bits: u64) -> Cell {
        let p = &*self.poly;
        let Span {
            mut lo,
            mut hi,
            mut e,
        } = self.span.clone();
        // Every step keeps hi − lo = width in units of 2^-e.
        let width = &hi - &lo;
        let w = width.bits();
        let need = bits + w;
        if e < need {
            let n = p.coeffs().len() as u64 - 1;
            let (mut at_lo, mut at_hi) = (p.eval_dyadic(&lo, e), p.eval_dyadic(&hi, e));
            // Digits that the ends agree on: a secant is about as good again.
            let mut t = (lo.bits().max(hi.bits()).saturating_sub(w + 3)).clamp(1, 64);
            while e < need {
                t = t.min(need - e).max(1);
                let (down, up) = (at_lo.abs(), at_hi.abs());
                let j = secant(&down, &up, t);
                let base = lo.shl(t);
                let x = &base + &width * &j;
                let at_x = p.eval_dyadic(&x, e + t);
                let s = at_x.sign();
                if s == 0 {
                    return Cell::Exact(Rat::dyadic(x, -((e + t) as i64)));
                }
                let below = s == self.sign_lo;
                // The other end of the cell of the finer grid that the secant points at.
                let y = if below { &x + &width } else { &x - &width };
                let last = if below {
                    j + Int::one() == Int::one().shl(t)
                } else {
                    j.is_one()
                };
                let at_y = if last {
                    if below {
                        at_hi.shl(t * n)
                    } else {
                        at_lo.shl(t * n)
                    }
                } else {
                    p.eval_dyadic(&y, e + t)
                };
                if at_y.is_zero() {
                    return Cell::Exact(Rat::dyadic(y, -((e + t) as i64)));
                }
                if (at_y.sign() == self.sign_lo) == below {
                    // Not in this cell: the guess was too bold. With t = 1 the cells are the two halves, so this
                    // ends.
                    t /= 2;
                    continue;
                }
                (lo, hi, at_lo, at_hi) = if below {
                    (x, y, at_x, at_y)
                } else {
                    (y, x, at_y, at_x)
                };
                e += t;
                t *= 2;
            }
        }
        // The interval is no wider than a cell now: at most one grid point is inside.
        let cut = if e >= bits {
            let k = lo.shr(e - bits) + Int::one();
            if hi <= k.shl(e - bits) {
                return Cell::Between(k - Int::one());
            }
            k
        } else {
            // Cannot happen (need ≥ bits), but costs nothing to answer.
            lo.shl(bits - e) + Int::one()
        };
        let s = p.sign_at_dyadic(&cut, bits);
        if s == 0 {
            Cell::Exact(Rat::dyadic(cut, -(bits as i64)))
        } else if s == self.sign_lo {
            Cell::Between(cut)
        } else {
            Cell::Between(cut - Int::one())
        }
    }

    fn enclosure(&self) -> Interval {
        *self.enclosure.get_or_init(|| {
            let mut bits = 64u64;
            loop {
                let k = match self.cell(bits) {
                    Cell::Exact(r) => return r.interval(),
                    Cell::Between(k) => k,
                };
                let known = k.abs().bits();
                // 2^-1140 lies far below the least double.
                if known >= 58 || bits >= 1140 {
                    let e = -(bits as i64);
                    let hi = Rat::dyadic(&k + Int::one(), e).interval().hi;
                    return Interval {
                        lo: Rat::dyadic(k, e).interval().lo,
                        hi,
                    };
                }
                bits = if known < 2 {
                    2 * bits + 64
                } else {
                    bits + 60 - known
                }
                .min(1140);
            }
        })
    }
}

/// The number of 2^t equal parts below the point where the secant through (0, down) and (1, −up) meets zero,
/// rounded, within 1..2^t.
fn secant(down: &Int, up: &Int, t: u64) -> Int {
    if t == 1 {
        return Int::one();
    }
    let sum = down + up;
    // More leading bits than the quotient has would be wasted.
    let cut = sum.bits().saturating_sub(t + 16);
    let (d, s) = (down.shr(cut), sum.shr(cut));
    let q = d.shl(t + 1).div_rem_floor(&s).0;
    let q = (q + Int::one()).shr(1);
    q.max(Int::one()).min(Int::one().shl(t) - Int::one())
}

impl Algebraic {
    /// The roots of a square-free primitive polynomial with positive leading coefficient.
    pub(crate) fn from_isolated(p: Poly, found: Vec<Isolated>) -> Vec<Algebraic> {
        let p = Arc::new(p);
        // Signs alternate from root to root, and the last one is positive.
        let count = found.len();
        let make = |(i, r): (usize, Isolated)| match r {
            Isolated::Exact(v) => Algebraic::from(v),
            Isolated::Open { lo, hi, e } => {
                let sign_lo = if (count - i) % 2 == 1 { -1 } else { 1 };
                debug_assert_eq!(p.sign_at_dyadic(&lo, e), sign_lo);
                debug_assert_eq!(p.sign_at_dyadic(&hi, e), -sign_lo);
                Algebraic(RootOf(Arc::new(Root::new(
                    p.clone(),
                    Span { lo, hi, e },
                    sign_lo,
                    OnceLock::new(),
                ))))
            }
        };
        found.into_iter().enumerate().map(make).collect()
    }
    /// The two irrational roots of a primitive quadratic with positive leading coefficient, by disjoint
    /// finite enclosures.
    pub(crate) fn pair(p: Poly, x: Interval, y: Interval) -> Vec<Algebraic> {
        let p = Arc::new(p);
        [(x, 1), (y, -1)]
            .map(|(i, s)| {
                Algebraic(RootOf(Arc::new(Root::new(
                    p.clone(),
                    Span::from_doubles(i),
                    s,
                    OnceLock::from(i),
                ))))
            })
            .into()
    }
    /// The exact rational value where the number is rational (decided, not guessed; the answer is kept).
    pub fn to_rat(&self) -> Option<Rat> {
        match &self.0 {
            Rational(k) => Some(k.value.clone()),
            RootOf(r) => r.to_rat().cloned(),
        }
    }
    /// Certified double enclosure, a few ulps wide, made once.
    pub fn interval(&self) -> Interval {
        match &self.0 {
            Rational(k) => k.interval,
            RootOf(r) => r.enclosure(),
        }
    }
    /// floor(self·2^bits), or the value.
    fn cell(&self, bits: u64) -> Cell {
        match &self.0 {
            Rational(k) => Cell::Exact(k.value.clone()),
            RootOf(r) => r.cell(bits),
        }
    }
    /// Rationals lo ≤ self ≤ hi with hi − lo ≤ 2^-bits; lo = hi only where self is rational and equal to it;
    /// otherwise lo < self < hi.
    pub fn enclosure(&self, bits: u32) -> (Rat, Rat) {
        match self.cell(bits as u64) {
            Cell::Exact(r) => (r.clone(), r),
            Cell::Between(k) => {
                let e = -(bits as i64);
                (Rat::dyadic(k.clone(), e), Rat::dyadic(k + Int::one(), e))
            }
        }
    }
    /// Nearest double, ties to even; None past the range.
    pub fn nearest_f64(&self) -> Option<f64> {
        if let Rational(k) = &self.0 {
            return k.value.nearest_f64();
        }
        let mut bits = self.grid(64);
        loop {
            let (lo, hi) = self.enclosure(bits);
            let (a, b) = (lo.nearest_f64(), hi.nearest_f64());
            if a == b {
                return a;
            }
            // A rational number may be the very tie; then no refinement ends. Irrational ones come here rarely.
            if let Some(r) = self.to_rat() {
                return r.nearest_f64();
            }
            bits = bits.saturating_mul(2).saturating_add(64);
        }
    }
    /// Bits after the point that show about `digits` significant bits, as far as doubles tell.
    fn grid(&self, digits: i64) -> u32 {
        let x = self.interval();
        let size = x.lo.abs().max(x.hi.abs());
        let exponent = (size.to_bits() >> 52) as i64 - 1023;
        (digits - exponent).clamp(0, 1200) as u32
    }
    /// -1, 0, 1.
    pub fn sign(&self) -> i32 {
        match &self.0 {
            Rational(k) => k.value.sign(),
            RootOf(r) => match r.enclosure().sign() {
                Some(s) => s,
                None => self.cmp_rat(&Rat::zero()) as i32,
            },
        }
    }
    /// Exact comparison with a rational: at most one exact evaluation.
    pub fn cmp_rat(&self, r: &Rat) -> Ordering {
        let root = match &self.0 {
            Rational(k) => return k.value.cmp(r),
            RootOf(root) => root,
        };
        let (x, y) = (root.enclosure(), r.interval());
        if x.below(&y) {
            return Ordering::Less;
        }
        if y.below(&x) {
            return Ordering::Greater;
        }
        let e = -(root.span.e as i64);
        if *r <= Rat::dyadic(root.span.lo.clone(), e) {
            return Ordering::Greater;
        }
        if *r >= Rat::dyadic(root.span.hi.clone(), e) {
            return Ordering::Less;
        }
        match root.poly.sign_at(r) {
            0 => Ordering::Equal,
            s if s == root.sign_lo => Ordering::Greater,
            _ => Ordering::Less,
        }
    }
    /// Exact sign of a polynomial at this number: an interval first, then a gcd for zero, then refinement.
    pub fn sign_of(&self, p: &Poly) -> i32 {
        let root = match &self.0 {
            Rational(k) => return p.sign_at(&k.value),
            RootOf(root) => root,
        };
        if let Some(s) = p.eval_interval(root.enclosure()).sign() {
            return s;
        }
        if root.is_root_of(p) {
            return 0;
        }
        let mut bits = self.grid(100) as u64;
        loop {
            let k = match root.cell(bits) {
                Cell::Exact(r) => return p.sign_at(&r),
                Cell::Between(k) => k,
            };
            let (value, error) = value_on_cell(p, &k, bits);
            if value.abs() > error {
                return value.sign();
            }
            bits = 2 * bits + 32;
        }
    }
    /// Primitive irreducible polynomial with positive leading coefficient. Made once.
    pub fn minimal_polynomial(&self) -> Poly {
        match &self.0 {
            Rational(k) => linear(&k.value),
            RootOf(r) => (**r.minimal()).clone(),
        }
    }
    /// The polynomial the number is defined by: square-free, primitive, positive leading coefficient, not
    /// always irreducible. Costs nothing.
    pub fn defining_polynomial(&self) -> Poly {
        match &self.0 {
            Rational(k) => linear(&k.value),
            RootOf(r) => (*r.poly).clone(),
        }
    }
    /// The contract's interval: [k/2^j, (k+1)/2^j] with the least j ≥ 0 that isolates the root of
    /// `minimal_polynomial`. A rational number is its own interval, twice the value.
    pub fn isolating_interval(&self) -> (Rat, Rat) {
        if let Some(r) = self.to_rat() {
            return (r.clone(), r);
        }
        // Neighbours share no cell of a fine enough grid; grids are nested, so the least j is found
        // by looking at coarser ones.
        let roots = self.minimal_polynomial().real_roots();
        let mut least = 0;
        for other in roots.iter().filter(|r| *r != self) {
            least = least.max(separating_grid(self, other));
        }
        self.enclosure(least as u32)
    }
    /// num(self)/den(self).
    ///
    /// # Panics
    /// If `den` vanishes at this number.
    pub fn ratio(&self, num: &Poly, den: &Poly) -> Algebraic {
        let root = match &self.0 {
            Rational(k) => return Algebraic::from(num.eval(&k.value) / den.eval(&k.value)),
            RootOf(root) => root,
        };
        assert!(self.sign_of(den) != 0, "the denominator vanishes");
        if num.is_zero() {
            return Algebraic::from(Rat::zero());
        }
        // Conjugates at which the denominator vanishes are none of ours.
        let g = root.poly.gcd(den);
        let p = if g.degree() == Some(0) {
            (*root.poly).clone()
        } else {
            root.poly.div_exact(&g).expect("a gcd divides").primitive()
        };
        // R(y) = Res_x(p(x), y·den(x) − num(x)) has the degree of p; read it off at as many points.
        let n = p.coeffs().len() - 1;
        let formal = num.coeffs().len().max(den.coeffs().len()) - 1;
        let lead = p.coeff(n);
        let points: Vec<(Rat, Rat)> = (0..=n as i64)
            .map(|y| {
                let q = den.scale(&Int::from(y)) - num;
                let missing = q.degree().map_or(0, |d| formal - d);
                let value = p.resultant(&q) * lead.pow(missing as u32);
                (Rat::from(y), Rat::from(value))
            })
            .collect();
        let roots = interpolate(&points).real_roots();
        let mut bits = self.grid(64) as u64;
        select(roots, || {
            loop {
                let k = match root.cell(bits) {
                    Cell::Exact(r) => {
                        let v = num.eval(&r) / den.eval(&r);
                        return (v.clone(), v);
                    }
                    Cell::Between(k) => k,
                };
                let ((n, en), (d, ed)) =
                    (value_on_cell(num, &k, bits), value_on_cell(den, &k, bits));
                let (n, en) = (
                    Rat::dyadic(n, -scale_of(num, bits)),
                    Rat::dyadic(en, -scale_of(num, bits)),
                );
                let (d, ed) = (
                    Rat::dyadic(d, -scale_of(den, bits)),
                    Rat::dyadic(ed, -scale_of(den, bits)),
                );
                bits = 2 * bits + 32;
                if d.abs() > ed {
                    let quotients = [
                        (&n - &en, &d - &ed),
                        (&n - &en, &d + &ed),
                        (&n + &en, &d - &ed),
                        (&n + &en, &d + &ed),
                    ];
                    let mut q = quotients.map(|(a, b)| a / b);
                    q.sort();
                    let [lo, _, _, hi] = q;
                    return (lo, hi);
                }
            }
        })
    }
    /// A rational strictly between two different numbers, of few bits.
    ///
    /// # Panics
    /// If they are equal.
    pub fn between(a: &Algebraic, b: &Algebraic) -> Rat {
        let (a, b) = match a.cmp(b) {
            Ordering::Less => (a, b),
            Ordering::Greater => (b, a),
            Ordering::Equal => panic!("no number lies between equal numbers"),
        };
        // Doubles are dyadic rationals.
        let (x, y) = (a.interval().hi, b.interval().lo);
        if x < y && x.is_finite() && y.is_finite() {
            return Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
        }
        let mut bits = a.grid(64);
        loop {
            let ((_, x), (y, _)) = (a.enclosure(bits), b.enclosure(bits));
            match x.cmp(&y) {
                Ordering::Less => return Rat::short_between(&x, &y),
                // A common end of two open cells lies strictly between.
                Ordering::Equal if a.cmp_rat(&x).is_lt() && b.cmp_rat(&x).is_gt() => return x,
                _ => bits = 2 * bits + 32,
            }
        }
    }
    /// The root x of p(x) + self·q(x) that lies in the enclosures delivered by `locate` (rational lo ≤ x ≤ hi,
    /// shrinking to the root as bits grow).
    ///
    /// # Panics
    /// If p + self·q is the zero polynomial, or no root lies in the enclosures.
    pub fn root_over(
        &self,
        p: &Poly,
        q: &Poly,
        locate: &mut dyn FnMut(u32) -> (Rat, Rat),
    ) -> Algebraic {
        let over = |m: &Poly| {
            // Π over the roots t of m of (p + t·q), up to a constant: q^n·m(−p/q).
            let minus_p = -p;
            let n = m.coeffs().len() - 1;
            let mut weight = Poly::constant(Int::one());
            let mut acc = Poly::constant(m.coeff(n));
            for i in (0..n).rev() {
                weight = weight * q;
                acc = acc * &minus_p + weight.scale(&m.coeff(i));
            }
            acc
        };
        let mut resultant = match &self.0 {
            Rational(k) => p.scale(k.value.denom()) + q.scale(k.value.numer()),
            RootOf(root) => over(&root.poly),
        };
        if resultant.is_zero() {
            // A rational conjugate t may make p + t·q vanish; the minimal polynomial has no such roots.
            resultant = over(&self.minimal_polynomial());
        }
        let mut bits = 64;
        let (lo, hi) = locate(bits);
        if lo == hi {
            return Algebraic::from(lo);
        }
        let roots = resultant.real_roots_in(&lo, &hi);
        select(roots, || {
            bits = bits.saturating_mul(2);
            locate(bits)
        })
    }
}

impl Root {
    fn to_rat(&self) -> Option<&Rat> {
        self.rational
            .get_or_init(|| {
                let lead = self.poly.leading()?;
                // lc·α is an integer if α is rational.
                let scaled = lead.interval() * self.enclosure();
                if scaled.lo.is_finite() && scaled.lo.ceil() > scaled.hi {
                    return None;
                }
                let bits = lead.bits() + 1;
                let k = match self.cell(bits) {
                    Cell::Exact(r) => return Some(r),
                    Cell::Between(k) => k,
                };
                // lc·k/2^bits < lc·α < lc·(k+1)/2^bits: at most one integer, the first above.
                let m = (lead * k).shr(bits) + Int::one();
                let r = Rat::new(m, lead.clone());
                let e = -(self.span.e as i64);
                let inside = Rat::dyadic(self.span.lo.clone(), e) < r
                    && r < Rat::dyadic(self.span.hi.clone(), e);
                (inside && self.poly.sign_at(&r) == 0).then_some(r)
            })
            .as_ref()
    }
    fn minimal(&self) -> &Arc<Poly> {
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
            Arc::new(factors.swap_remove(at.expect("one factor has the root")))
        })
    }
    /// Whether `p` vanishes at the root.
    fn is_root_of(&self, p: &Poly) -> bool {
        if p.is_zero() {
            return true;
        }
        if gcd_degree_bound(&self.poly, p) == Some(0) {
            return false;
        }
        // A divisor of `poly` has no root at the ends and at most one, simple, between.
        let g = self.poly.gcd(p);
        g.coeffs().len() > 1 && self.span.changes_sign(&g)
    }
}

/// den·x − num.
fn linear(r: &Rat) -> Poly {
    Poly::new(vec![-r.numer(), r.denom().clone()])
}

fn scale_of(p: &Poly, bits: u64) -> i64 {
    bits as i64 * (p.coeffs().len() as i64 - 1).max(0)
}

/// (v, err): on the cell k of the grid 2^-bits the value of p, times 2^(bits·degree), is v ± err.
fn value_on_cell(p: &Poly, k: &Int, bits: u64) -> (Int, Int) {
    let value = p.eval_dyadic(k, bits);
    if p.coeffs().len() <= 1 {
        return (value, Int::zero());
    }
    let size = k.bits() as i64 + 1 - bits as i64;
    // |p(x) − p(k/2^b)| ≤ |p'|·2^-b
    let error = slope_bits(p, size) - bits as i64 + scale_of(p, bits);
    (
        value,
        if error >= 0 {
            Int::one().shl(error as u64)
        } else {
            Int::one()
        },
    )
}

/// The polynomial through the points (Newton), up to a positive factor.
fn interpolate(points: &[(Rat, Rat)]) -> Poly {
    let n = points.len();
    let mut d: Vec<Rat> = points.iter().map(|(_, y)| y.clone()).collect();
    for level in 1..n {
        for i in (level..n).rev() {
            d[i] = (&d[i] - &d[i - 1]) / (&points[i].0 - &points[i - level].0);
        }
    }
    let mut c: Vec<Rat> = Vec::new();
    for i in (0..n).rev() {
        // c ← c·(x − x_i) + d_i
        c.insert(0, Rat::zero());
        for j in 0..c.len() - 1 {
            let t = &c[j + 1] * &points[i].0;
            c[j] -= t;
        }
        c[0] += &d[i];
    }
    Poly::from_rats(&c)
}

/// The one root that stays in ever smaller enclosures.
fn select(mut roots: Vec<Algebraic>, mut enclose: impl FnMut() -> (Rat, Rat)) -> Algebraic {
    while roots.len() > 1 {
        let (lo, hi) = enclose();
        roots.retain(|r| r.cmp_rat(&lo).is_ge() && r.cmp_rat(&hi).is_le());
    }
    roots.pop().expect("no root lies in the enclosure")
}

/// The least j ≥ 0 such that two different irrational numbers lie in different cells of the grid of step 2^-j.
fn separating_grid(a: &Algebraic, b: &Algebraic) -> u64 {
    let mut bits = 64;
    loop {
        if let (Cell::Between(x), Cell::Between(y)) = (a.cell(bits), b.cell(bits))
            && x != y
        {
            // Coarser grids: drop bits as long as the cells differ (monotone, so bisect).
            let (mut least, mut most) = (0, bits);
            while least < most {
                let j = least.midpoint(most);
                if x.shr(bits - j) != y.shr(bits - j) {
                    most = j
                } else {
                    least = j + 1
                }
            }
            return most;
        }
        bits *= 2;
    }
}

impl From<Rat> for Algebraic {
    fn from(value: Rat) -> Algebraic {
        let interval = value.interval();
        Algebraic(Rational(Arc::new(Known { value, interval })))
    }
}
impl PartialEq for Algebraic {
    fn eq(&self, o: &Algebraic) -> bool {
        match (&self.0, &o.0) {
            (Rational(a), Rational(b)) => a.value == b.value,
            (Rational(a), _) => o.cmp_rat(&a.value).is_eq(),
            (_, Rational(b)) => self.cmp_rat(&b.value).is_eq(),
            (RootOf(a), RootOf(b)) => {
                Arc::ptr_eq(a, b) || a.enclosure().meets(&b.enclosure()) && a.equals(b)
            }
        }
    }
}
impl Root {
    /// Equality, decided without refinement.
    fn equals(&self, o: &Root) -> bool {
        let Some(common) = self.span.common(&o.span) else {
            return false;
        };
        if Arc::ptr_eq(&self.poly, &o.poly) || self.poly == o.poly {
            // Ends of either interval are no roots, and each holds but one.
            return common.changes_sign(&self.poly);
        }
        if gcd_degree_bound(&self.poly, &o.poly) == Some(0) {
            return false;
        }
        let g = self.poly.gcd(&o.poly);
        g.coeffs().len() > 1 && common.changes_sign(&g)
    }
}
impl Eq for Algebraic {}
impl PartialOrd for Algebraic {
    fn partial_cmp(&self, o: &Algebraic) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Algebraic {
    fn cmp(&self, o: &Algebraic) -> Ordering {
        let (a, b) = match (&self.0, &o.0) {
            (Rational(a), Rational(b)) => return a.value.cmp(&b.value),
            (Rational(a), _) => return o.cmp_rat(&a.value).reverse(),
            (_, Rational(b)) => return self.cmp_rat(&b.value),
            (RootOf(a), RootOf(b)) => (a, b),
        };
        if Arc::ptr_eq(a, b) {
            return Ordering::Equal;
        }
        let (x, y) = (a.enclosure(), b.enclosure());
        if x.below(&y) {
            return Ordering::Less;
        }
        if y.below(&x) {
            return Ordering::Greater;
        }
        if a.equals(b) {
            return Ordering::Equal;
        }
        // They differ, so some grid tells them apart.
        let mut bits = self.grid(100) as u64;
        loop {
            match (a.cell(bits), b.cell(bits)) {
                (Cell::Exact(r), _) => return o.cmp_rat(&r).reverse(),
                (_, Cell::Exact(r)) => return self.cmp_rat(&r),
                (Cell::Between(j), Cell::Between(k)) if j != k => return j.cmp(&k),
                _ => bits = 2 * bits + 32,
            }
        }
    }
}
/// The nearest double, and the rational or the polynomial it stands for.
impl fmt::Debug for Algebraic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Rational(k) => write!(f, "{}", k.value),
            RootOf(r) => write!(f, "{:?} (root of {})", r.enclosure().lo, r.poly),
        }
    }
}
