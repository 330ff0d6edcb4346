//! Real algebraic numbers: exact answers about irrational roots.
//!
//! The idea: a number is a rational, a root (a square-free integer polynomial and an interval that holds
//! no other root of it), or a quotient of two polynomials at a root. Two numbers are told apart first by their
//! double enclosures; if those meet, a gcd decides equality for good; only numbers known to differ are refined.
//! So each question ends, and only near coincidences pay for it. A quotient's own polynomial is a resultant,
//! which few questions need: it is made when one does. Nothing else is kept of how a number came about, so
//! a value made by a long computation costs no more than one read from a file.

use super::filter::{self, Stage};
use super::isolate::Isolated;
use super::refine::{Cell, Refiner, Span};
use super::root::{Root, grid, linear, scale_of, value_on_cell};
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
    /// Order by rational ends of so many bits after the point that ordinary coincidences of numbers
    /// of this size stop there: only what still looks equal is worth a resultant.
    fn told_apart_by_bits(&self, o: &Algebraic) -> Option<Ordering> {
        let unresolved =
            |a: &Algebraic| matches!(&a.0, QuotientOf(q) if q.resolved.get().is_none());
        if !filter::on() || !(unresolved(self) || unresolved(o)) {
            return None;
        }
        let wider = grid(self.around(), 100);
        let most = self.coefficient_bits().max(o.coefficient_bits());
        let (mut u, mut v) = (self.narrowing(), o.narrowing());
        for bits in [wider, 2 * most] {
            if bits < wider {
                break;
            }
            let ((a, b), (c, d)) = (u.at(bits), v.at(bits));
            let order = match (b < c, d < a) {
                (true, _) => Ordering::Less,
                (_, true) => Ordering::Greater,
                _ => continue,
            };
            if bits == wider {
                filter::settled(Stage::Wider);
            } else {
                filter::settled_exactly(false, bits);
            }
            return Some(order);
        }
        None
    }
    /// The bits of the largest integer that the number is written with.
    fn coefficient_bits(&self) -> u64 {
        match &self.0 {
            Rational(k) => k.value.bits(),
            RootOf(r) => r.poly.most_bits(),
            QuotientOf(q) => {
                let parts = q.num.most_bits().max(q.den.most_bits());
                parts.max(q.root.poly.most_bits())
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

impl Quotient {
    fn resolve(&self) -> Algebraic {
        let Quotient { root, num, den, .. } = self;
        // Conjugates at which the denominator vanishes are none of ours.
        let g = root.poly.gcd(den);
        let p = match g.degree() {
            Some(0) => None,
            _ => root.poly.div_exact(&g).map(|p| p.primitive()),
        };
        let p = p.as_ref().unwrap_or(&root.poly);
        let resultant = quotient_polynomial(p, num, den);
        let x = root.enclosure();
        let rough = Poly::quotient_over(num, den, x);
        let mut bits = grid(x, 64);
        let mut refiner = root.refine();
        pick(&resultant, rough, || {
            quotient_enclosure(&mut refiner, num, den, &mut bits)
        })
    }
}

/// A number between rational ends that close in on it.
enum Narrowing<'a> {
    Known(&'a Rat),
    Root(Refiner<'a>),
    Quotient(Refiner<'a>, &'a Quotient),
}

impl Narrowing<'_> {
    /// Ends lo ≤ number ≤ hi, about 2^-bits apart.
    fn at(&mut self, bits: u64) -> (Rat, Rat) {
        match self {
            Narrowing::Known(r) => (r.clone(), r.clone()),
            Narrowing::Root(r) => ends(r.cell(bits), bits),
            Narrowing::Quotient(r, q) => quotient_enclosure(r, &q.num, &q.den, &mut bits.clone()),
        }
    }
}

/// Rational ends around num/den, narrower with every call.
fn quotient_enclosure(
    refiner: &mut Refiner<'_>,
    num: &Poly,
    den: &Poly,
    bits: &mut u64,
) -> (Rat, Rat) {
    loop {
        let b = *bits;
        *bits = 2 * b + 32;
        let k = match refiner.cell(b) {
            Cell::Exact(r) => {
                let v = num.eval(&r) / den.eval(&r);
                return (v.clone(), v);
            }
            Cell::Between(k) => k,
        };
        let ((n, n_err), (d, d_err)) = (value_on_cell(num, &k, b), value_on_cell(den, &k, b));
        // num/den is the quotient of these times 2^shift.
        let shift = scale_of(den, b) - scale_of(num, b);
        let (n, d) = if d.sign() < 0 { (-n, -d) } else { (n, d) };
        let (d_low, d_high) = (&d - &d_err, &d + &d_err);
        if d_low.sign() <= 0 {
            continue;
        }
        let (n_low, n_high) = (&n - &n_err, n + n_err);
        let over = |n: &Int, d: &Int, up: bool| {
            let e = b as i64 + shift;
            let q = if e >= 0 {
                n.shl(e as u64).div_rem_floor(d).0
            } else {
                n.div_rem_floor(&d.shl(e.unsigned_abs())).0
            };
            Rat::dyadic(if up { q + Int::one() } else { q }, -(b as i64))
        };
        let d_of = |away_from_zero: bool| if away_from_zero { &d_low } else { &d_high };
        return (
            over(&n_low, d_of(n_low.sign() < 0), false),
            over(&n_high, d_of(n_high.sign() > 0), true),
        );
    }
}

/// R(y) = Res_x(p(x), y·den(x) − num(x)) up to a constant: its roots are num/den at the roots of p. `den` must
/// not vanish at any of them, so that the degree is that of p. Read off at as many points as it takes.
fn quotient_polynomial(p: &Poly, num: &Poly, den: &Poly) -> Poly {
    let n = p.coeffs().len() - 1;
    let formal = num.coeffs().len().max(den.coeffs().len()) - 1;
    let lead = p.coeff(n);
    let values = (0..=n as i64).map(|y| {
        let q = den.scale(&Int::from(y)) - num;
        let missing = q.degree().map_or(0, |d| formal - d);
        p.resultant(&q) * lead.pow(missing as u32)
    });
    interpolate(values.collect())
}

/// n! times the polynomial that takes the given values at 0, 1, …, n (Newton's forward differences).
fn interpolate(mut d: Vec<Int>) -> Poly {
    let n = d.len() - 1;
    for level in 1..=n {
        for i in (level..=n).rev() {
            let t = &d[i] - &d[i - 1];
            d[i] = t;
        }
    }
    // Σ d_i/i!·x(x−1)…(x−i+1), by Horner: the weights n!/i! keep it integral.
    let mut weight = Int::one();
    let mut c: Vec<Int> = Vec::new();
    for i in (0..=n).rev() {
        let x = Int::from(i as i64);
        c.insert(0, Int::zero());
        for j in 0..c.len() - 1 {
            let t = &c[j + 1] * &x;
            c[j] -= t;
        }
        c[0] += &d[i] * &weight;
        weight *= x;
    }
    Poly::new(c)
}

/// den^n·p(num/den).
fn homogenise(p: &Poly, num: &Poly, den: &Poly) -> Poly {
    let Some(n) = p.degree() else {
        return Poly::zero();
    };
    let mut weight = Poly::constant(Int::one());
    let mut acc = Poly::constant(p.coeff(n));
    for i in (0..n).rev() {
        weight *= den;
        acc = acc * num + weight.scale(&p.coeff(i));
    }
    acc
}

/// Doubles around two rationals.
fn outer(lo: &Rat, hi: &Rat) -> Interval {
    Interval {
        lo: lo.interval().lo,
        hi: hi.interval().hi,
    }
}

/// The one root of `p` that stays in ever smaller enclosures, the first of them given in doubles.
fn pick(p: &Poly, rough: Interval, mut enclose: impl FnMut() -> (Rat, Rat)) -> Algebraic {
    let p = p.squarefree();
    // Mostly the first enclosure isolates already, and no other root is ever looked at.
    if p.degree().is_some_and(|d| d >= 3)
        && let Some(root) = Root::adopt(&p, rough)
    {
        return root.into();
    }
    let mut roots = p.real_roots();
    roots.retain(|r| r.interval().meets(&rough));
    while roots.len() > 1 {
        let (lo, hi) = enclose();
        roots.retain(|r| r.cmp_rat(&lo).is_ge() && r.cmp_rat(&hi).is_le());
    }
    roots.pop().expect("no root lies in the enclosure")
}

fn ends(cell: Cell, bits: u64) -> (Rat, Rat) {
    match cell {
        Cell::Exact(r) => (r.clone(), r),
        Cell::Between(k) => {
            let e = -(bits as i64);
            let next = Rat::dyadic(&k + Int::one(), e);
            (Rat::dyadic(k, e), next)
        }
    }
}

/// The least j ≥ 0 such that two different irrational numbers lie in different cells of the grid of step 2^-j.
fn separating_grid(a: &Algebraic, b: &Algebraic) -> u64 {
    let (Ok(a), Ok(b)) = (a.root(), b.root()) else {
        return 0;
    };
    let (mut a, mut b) = (a.refine(), b.refine());
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

/// What enclosures alone prove: the order of numbers that they hold apart, or equality where both
/// are one double.
#[inline]
fn told_apart(x: &Interval, y: &Interval) -> Option<Ordering> {
    let order = if x.below(y) {
        Ordering::Less
    } else if y.below(x) {
        Ordering::Greater
    } else if x.lo == x.hi && *x == *y && x.is_finite() {
        Ordering::Equal
    } else {
        return None;
    };
    filter::settled(Stage::Double);
    Some(order)
}

/// Counts an equality of roots as settled, and keeps it where it holds: by name where both have
/// one polynomial (and so, their intervals being isolating, no arithmetic told them equal).
fn settled_equality(a: &Arc<Root>, b: &Arc<Root>, same: bool) {
    if same {
        Root::unite(a, b);
        if a.poly == b.poly {
            return filter::settled(Stage::Name);
        }
    }
    filter::settled_exactly(same, a.poly.most_bits().max(b.poly.most_bits()));
}

/// Two rationals that their enclosures do not tell apart.
fn cmp_values(a: &Rat, b: &Rat) -> Ordering {
    // Fractions in lowest terms are one number if and only if they are spelt alike.
    if a == b {
        filter::settled(Stage::Name);
        return Ordering::Equal;
    }
    filter::settled_exactly(false, a.bits().max(b.bits()));
    a.cmp(b)
}

/// Two roots that are known to differ.
fn cmp_different(a: &Root, b: &Root) -> Ordering {
    let wider = grid(a.enclosure(), 100);
    let mut bits = wider;
    let settled = |bits| {
        if bits == wider {
            filter::settled(Stage::Wider);
        } else {
            filter::settled_exactly(false, bits);
        }
    };
    let (mut x, mut y) = (a.refine(), b.refine());
    loop {
        // With a value met exactly one has v ≤ number ≤ v, else k < number·2^bits < k + 1.
        let ((lo, hi), (l, h)) = match (x.cell(bits), y.cell(bits)) {
            (Cell::Between(j), Cell::Between(k)) => {
                if j != k {
                    settled(bits);
                    return j.cmp(&k);
                }
                bits = 2 * bits + 32;
                continue;
            }
            (p, q) => (ends(p, bits), ends(q, bits)),
        };
        if hi <= l {
            settled(bits);
            return Ordering::Less;
        }
        if h <= lo {
            settled(bits);
            return Ordering::Greater;
        }
        bits = 2 * bits + 32;
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
impl PartialEq for Algebraic {
    fn eq(&self, o: &Algebraic) -> bool {
        if self.named_alike(o) {
            return true;
        }
        if let Some(o) = told_apart(&self.around(), &o.around()) {
            return o.is_eq();
        }
        match (&self.0, &o.0) {
            (Rational(a), Rational(b)) => cmp_values(&a.value, &b.value).is_eq(),
            (Rational(a), _) => o.cmp_rat(&a.value).is_eq(),
            (_, Rational(b)) => self.cmp_rat(&b.value).is_eq(),
            (QuotientOf(a), QuotientOf(b)) if Arc::ptr_eq(&a.root, &b.root) => {
                a.cmp_same(b).is_eq()
            }
            _ if self.told_apart_by_bits(o).is_some() => false,
            _ => match (self.root(), o.root()) {
                (Ok(a), Ok(b)) if Arc::ptr_eq(a.representative(), b.representative()) => {
                    filter::settled(Stage::Name);
                    true
                }
                (Ok(a), Ok(b)) => {
                    let same = a.enclosure().meets(&b.enclosure()) && a.equals(b);
                    settled_equality(a, b, same);
                    same
                }
                (Err(r), _) => o.cmp_rat(r).is_eq(),
                (_, Err(r)) => self.cmp_rat(r).is_eq(),
            },
        }
    }
}
impl Eq for Algebraic {}
impl PartialOrd for Algebraic {
    fn partial_cmp(&self, o: &Algebraic) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Quotient {
    /// Two quotients at one root: a/b − c/d has the sign of (ad − bc)·bd.
    fn cmp_same(&self, o: &Quotient) -> Ordering {
        let excess = &self.num * &o.den - &o.num * &self.den;
        (self.root.sign_of(&excess) * self.den_sign * o.den_sign).cmp(&0)
    }
}
impl Ord for Algebraic {
    fn cmp(&self, o: &Algebraic) -> Ordering {
        if self.named_alike(o) {
            return Ordering::Equal;
        }
        if let Some(o) = told_apart(&self.around(), &o.around()) {
            return o;
        }
        match (&self.0, &o.0) {
            (Rational(a), Rational(b)) => return cmp_values(&a.value, &b.value),
            (Rational(a), _) => return o.cmp_rat(&a.value).reverse(),
            (_, Rational(b)) => return self.cmp_rat(&b.value),
            (QuotientOf(a), QuotientOf(b)) if Arc::ptr_eq(&a.root, &b.root) => {
                return a.cmp_same(b);
            }
            _ => {}
        }
        if let Some(o) = self.told_apart_by_bits(o) {
            return o;
        }
        let (a, b) = match (self.root(), o.root()) {
            (Ok(a), Ok(b)) => (a, b),
            (Err(r), _) => return o.cmp_rat(r).reverse(),
            (_, Err(r)) => return self.cmp_rat(r),
        };
        if Arc::ptr_eq(a.representative(), b.representative()) {
            filter::settled(Stage::Name);
            return Ordering::Equal;
        }
        // Settling a quotient may have narrowed its enclosure.
        if let Some(o) = told_apart(&a.enclosure(), &b.enclosure()) {
            return o;
        }
        if a.equals(b) {
            settled_equality(a, b, true);
            Ordering::Equal
        } else {
            cmp_different(a, b)
        }
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
