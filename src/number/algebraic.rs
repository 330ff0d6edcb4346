//! Real algebraic numbers: exact answers about irrational roots.
//!
//! The idea: a number is a rational, a root (a square-free integer polynomial and an interval that holds
//! no other root of it), or a quotient of two polynomials at a root. Two numbers are told apart first by their
//! double enclosures; if those meet, a gcd decides equality for good; only numbers known to differ are refined.
//! So each question ends, and only near coincidences pay for it. A quotient's own polynomial is a resultant,
//! which few questions need: it is made when one does. Nothing else is kept of how a number came about, so
//! a value made by a long computation costs no more than one read from a file.

mod order;
mod quotient;

use self::order::{cmp_values, separating_grid, told_apart};
use self::quotient::{Narrowing, ends, homogenise, outer, pick};
use super::filter::{self, Stage};
use super::isolate::Isolated;
use super::refine::Span;
use super::root::{Root, grid, linear};
use super::{Interval, Poly, Rat};
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
/// let again = Poly::from_i64(&[-4, 0, 2]).real_roots().remove(1);
/// assert_eq!(sqrt2, again);
/// assert!(sqrt2 > Algebraic::from(Rat::frac(141, 100)));
/// assert_eq!(sqrt2.to_rat(), None);
/// ```
#[derive(Clone)]
pub struct Algebraic(Repr);

#[derive(Clone)]
enum Repr {
    Rational(Arc<Known>),
    Root(Arc<Root>),
    Quotient(Arc<Quotient>),
}
use Repr::{Quotient as QuotientOf, Rational, Root as RootOf};

struct Known {
    value: Rat,
    interval: Interval,
}

/// num(root)/den(root), where den does not vanish.
struct Quotient {
    root: Arc<Root>,
    num: Poly,
    den: Poly,
    /// The sign of den there.
    den_sign: i32,
    /// Evaluated on the root's enclosure.
    wide: Interval,
    /// Whether that is narrow enough to be shown.
    useful: bool,
    resolved: OnceLock<Algebraic>,
}

impl Algebraic {
    /// The rational value where it is known without work; None proves nothing.
    pub fn known_rat(&self) -> Option<Rat> {
        match &self.0 {
            Rational(k) => Some(k.value.clone()),
            _ => None,
        }
    }
    /// The roots of a square-free primitive polynomial with positive leading coefficient.
    pub(crate) fn from_isolated(p: Poly, found: Vec<Isolated>) -> Vec<Algebraic> {
        let p = Arc::new(p);
        // Signs alternate from root to root, and the last one is positive.
        let count = found.len();
        let make = |(i, r): (usize, Isolated)| match r {
            Isolated::Exact(v) => Algebraic::from(v),
            Isolated::Open { lo, hi, e } => {
                let sign_lo = if (count - i) % 2 == 1 { -1 } else { 1 };
                Root::new(p.clone(), Span { lo, hi, e }, sign_lo).into()
            }
        };
        found.into_iter().enumerate().map(make).collect()
    }
    /// The two irrational roots of a primitive quadratic with positive leading coefficient, by disjoint
    /// finite enclosures.
    pub(crate) fn pair(p: Poly, x: Interval, y: Interval) -> Vec<Algebraic> {
        let p = Arc::new(p);
        vec![
            Root::enclosed(p.clone(), x, 1).into(),
            Root::enclosed(p, y, -1).into(),
        ]
    }
    /// Whether both are handles of one number (no arithmetic; false proves nothing).
    pub fn same_handle(&self, o: &Algebraic) -> bool {
        match (&self.0, &o.0) {
            (Rational(a), Rational(b)) => Arc::ptr_eq(a, b),
            (RootOf(a), RootOf(b)) => Arc::ptr_eq(a, b),
            (QuotientOf(a), QuotientOf(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
    /// Counts the question where both are handles of one number.
    fn named_alike(&self, o: &Algebraic) -> bool {
        let same = self.same_handle(o);
        if same {
            filter::settled(Stage::Name);
        }
        same
    }
    /// The same number as a rational or a root.
    fn settled(&self) -> &Algebraic {
        match &self.0 {
            QuotientOf(q) => q.resolved.get_or_init(|| q.resolve()),
            _ => self,
        }
    }
    /// The root behind a number that is settled and not in rational form.
    fn root(&self) -> Result<&Arc<Root>, &Rat> {
        match &self.settled().0 {
            Rational(k) => Err(&k.value),
            RootOf(r) => Ok(r),
            // `pick`, which settles them, makes rationals and roots only.
            QuotientOf(_) => unreachable!("quotients settle to rationals or roots"),
        }
    }
    /// The exact rational value where the number is rational (decided, not guessed; the answer is kept).
    pub fn to_rat(&self) -> Option<Rat> {
        match self.root() {
            Err(r) => Some(r.clone()),
            Ok(root) => root.to_rat().cloned(),
        }
    }
    /// Certified double enclosure, made once: within 1e-14 of the number's size, tighter for
    /// quadratics. (That of a [`ratio`](Self::ratio)
    /// may be up to 2^-36 of its size wide.)
    pub fn interval(&self) -> Interval {
        match &self.0 {
            _ if !filter::on() => Interval::all(),
            Rational(k) => k.interval,
            RootOf(r) => r.enclosure(),
            // The same answer whether or not the quotient has been resolved since.
            QuotientOf(q) if q.useful => q.wide,
            QuotientOf(_) => self.settled().interval(),
        }
    }
    /// Certified doubles around the number, as narrow as they come without work.
    fn around(&self) -> Interval {
        match &self.0 {
            QuotientOf(q) if filter::on() => q.wide,
            _ => self.interval(),
        }
    }
    /// Rationals lo ≤ self ≤ hi with hi − lo ≤ 2^-bits; lo = hi only where self is rational and equal to it;
    /// otherwise lo < self < hi.
    pub fn enclosure(&self, bits: u32) -> (Rat, Rat) {
        match self.root() {
            Err(r) => (r.clone(), r.clone()),
            Ok(root) => ends(root.refine().cell(bits as u64), bits as u64),
        }
    }
    /// Nearest double, ties to even; None past the range.
    pub fn nearest_f64(&self) -> Option<f64> {
        let root = match self.root() {
            Err(r) => return r.nearest_f64(),
            Ok(root) => root,
        };
        let mut bits = grid(root.enclosure(), 64);
        let mut refiner = root.refine();
        loop {
            let (lo, hi) = ends(refiner.cell(bits), bits);
            let (a, b) = (lo.nearest_f64(), hi.nearest_f64());
            if a == b {
                return a;
            }
            // A rational number may be the very tie, and then no refinement ends. Few numbers come here.
            if let Some(r) = root.to_rat() {
                return r.nearest_f64();
            }
            bits = 2 * bits + 64;
        }
    }
    /// -1, 0, 1.
    pub fn sign(&self) -> i32 {
        if let Some(s) = self.around().sign() {
            filter::settled(Stage::Double);
            return s;
        }
        match &self.0 {
            Rational(k) => {
                let s = k.value.sign();
                filter::settled_exactly(s == 0, k.value.bits());
                s
            }
            QuotientOf(q) => q.root.sign_of(&q.num) * q.den_sign,
            RootOf(_) => self.cmp_rat(&Rat::zero()) as i32,
        }
    }
    /// Exact comparison with a rational: at most one exact evaluation.
    pub fn cmp_rat(&self, r: &Rat) -> Ordering {
        let (x, y) = (self.around(), r.interval());
        if let Some(o) = told_apart(&x, &y) {
            return o;
        }
        match &self.0 {
            Rational(k) => cmp_values(&k.value, r),
            // n/d − r has the sign of (n − r·d)·d.
            QuotientOf(q) => {
                let excess = q.num.scale(r.denom()) - q.den.scale(r.numer());
                (q.root.sign_of(&excess) * q.den_sign).cmp(&0)
            }
            RootOf(root) => {
                if *r <= root.span.low() {
                    filter::settled_exactly(false, r.bits());
                    return Ordering::Greater;
                }
                if *r >= root.span.high() {
                    filter::settled_exactly(false, r.bits());
                    return Ordering::Less;
                }
                match root.poly.sign_at(r) {
                    0 => Ordering::Equal,
                    s if s == root.sign_below() => Ordering::Greater,
                    _ => Ordering::Less,
                }
            }
        }
    }
    /// Exact sign of a polynomial at this number: an interval first, then a gcd for zero, then refinement.
    pub fn sign_of(&self, p: &Poly) -> i32 {
        match &self.0 {
            Rational(k) => p.sign_at(&k.value),
            RootOf(root) => root.sign_of(p),
            QuotientOf(q) => {
                if let Some(s) = p.sign_over(self.around()) {
                    filter::settled(Stage::Double);
                    return s;
                }
                // den^n·p(num/den) at the root, while its degree stays small.
                match p.degree() {
                    Some(n) if n <= 4 => {
                        q.root.sign_of(&homogenise(p, &q.num, &q.den))
                            * if n % 2 == 1 { q.den_sign } else { 1 }
                    }
                    _ => self.settled().sign_of(p),
                }
            }
        }
    }
    /// Primitive irreducible polynomial with positive leading coefficient. Made once.
    pub fn minimal_polynomial(&self) -> Poly {
        match self.root() {
            Err(r) => linear(r),
            Ok(root) => (**root.minimal()).clone(),
        }
    }
    /// The polynomial the number is defined by: square-free, primitive, positive leading coefficient, not
    /// always irreducible.
    pub fn defining_polynomial(&self) -> Poly {
        match self.root() {
            Err(r) => linear(r),
            Ok(root) => (*root.poly).clone(),
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
        let others = roots.iter().filter(|r| *r != self);
        let least = others
            .map(|other| separating_grid(self, other))
            .max()
            .unwrap_or(0);
        self.enclosure(least as u32)
    }
    /// num(self)/den(self). Cheap: the polynomial of the quotient is made only when a question needs it.
    ///
    /// # Panics
    /// If `den` vanishes at this number.
    pub fn ratio(&self, num: &Poly, den: &Poly) -> Algebraic {
        let root = match self.root() {
            Err(r) => return Algebraic::from(num.eval(r) / den.eval(r)),
            Ok(root) => root.clone(),
        };
        let den_sign = root.sign_of(den);
        assert!(den_sign != 0, "the denominator vanishes");
        if num.is_zero() {
            return Algebraic::from(Rat::zero());
        }
        let x = root.enclosure();
        let q = Poly::quotient_over(num, den, x);
        let size = q.lo.abs().min(q.hi.abs());
        let useful = q.is_finite() && q.sign().is_some() && q.width() <= size * 2f64.powi(-36);
        let (num, den) = (num.clone(), den.clone());
        Algebraic(QuotientOf(Arc::new(Quotient {
            root,
            num,
            den,
            den_sign,
            wide: q,
            useful,
            resolved: OnceLock::new(),
        })))
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
        let (x, y) = (a.around().hi, b.around().lo);
        if x < y && x.is_finite() && y.is_finite() {
            return Rat::short_between_doubles(x, y);
        }
        let mut bits = grid(a.around(), 64);
        let (mut u, mut v) = (a.narrowing(), b.narrowing());
        loop {
            let ((_, x), (y, _)) = (u.at(bits), v.at(bits));
            match x.cmp(&y) {
                Ordering::Less => return Rat::short_between(&x, &y),
                // A common end of two open cells lies strictly between.
                Ordering::Equal if a.cmp_rat(&x).is_lt() && b.cmp_rat(&x).is_gt() => return x,
                _ => bits = 2 * bits + 32,
            }
        }
    }
    /// Ever narrower rational ends.
    fn narrowing(&self) -> Narrowing<'_> {
        match &self.0 {
            Rational(k) => Narrowing::Known(&k.value),
            RootOf(r) => Narrowing::Root(r.refine()),
            QuotientOf(q) => match q.resolved.get() {
                Some(r) => r.narrowing(),
                None => Narrowing::Quotient(q.root.refine(), q),
            },
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
        self.root_over_about(p, q, None, locate)
    }
    /// The same where an enclosure of the root may be known already; `locate` is only asked if that holds
    /// another root too.
    pub(crate) fn root_over_about(
        &self,
        p: &Poly,
        q: &Poly,
        about: Option<Interval>,
        locate: &mut dyn FnMut(u32) -> (Rat, Rat),
    ) -> Algebraic {
        // Π over the roots t of m of (p + t·q), up to a constant: q^n·m(−p/q).
        let minus_p = -p;
        let mut resultant = match self.root() {
            Err(r) => p.scale(r.denom()) + q.scale(r.numer()),
            Ok(root) => homogenise(&root.poly, &minus_p, q),
        };
        if resultant.is_zero() {
            // A rational conjugate t may make p + t·q vanish; the minimal polynomial has no such roots.
            resultant = homogenise(&self.minimal_polynomial(), &minus_p, q);
        }
        let mut bits = 64;
        let rough = match about {
            Some(about) => about,
            None => {
                let (lo, hi) = locate(bits);
                if lo == hi {
                    return Algebraic::from(lo);
                }
                outer(&lo, &hi)
            }
        };
        pick(&resultant, rough, || {
            let x = locate(bits);
            bits = bits.saturating_mul(2);
            x
        })
    }
}

impl From<Rat> for Algebraic {
    fn from(value: Rat) -> Algebraic {
        let interval = value.tight();
        Algebraic(Rational(Arc::new(Known { value, interval })))
    }
}
impl From<Root> for Algebraic {
    fn from(r: Root) -> Algebraic {
        Algebraic(RootOf(Arc::new(r)))
    }
}
/// The rational, or the polynomial and about where its root lies.
impl fmt::Debug for Algebraic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Rational(k) => write!(f, "{}", k.value),
            RootOf(r) => write!(f, "{:?} (root of {})", r.enclosure().lo, r.poly),
            QuotientOf(q) => write!(
                f,
                "({})/({}) at {:?} (root of {})",
                q.num,
                q.den,
                q.root.enclosure().lo,
                q.root.poly
            ),
        }
    }
}
