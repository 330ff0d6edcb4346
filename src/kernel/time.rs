use crate::number::filter::{self, Stage};
use crate::number::{Algebraic, Int, Interval, Poly, Rat};
use std::cmp::Ordering;
use std::sync::atomic::{AtomicU64, Ordering as AtomicOrdering};
use std::sync::{Arc, OnceLock};

/// An instant of a phase, counted from its start.
///
/// Either rational, or n(x)/d(x) at the chart position x where something happens. The polynomial
/// that defines the number itself (a resultant) is only made when a comparison cannot be settled
/// without it; two handles of one instant are equal without any arithmetic.
#[derive(Clone, Debug)]
pub struct Time(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    interval: Interval,
    form: Form,
    exact: OnceLock<Algebraic>,
    name: OnceLock<u64>,
}

#[derive(Debug)]
enum Form {
    Rational(Rat),
    Ratio { x: Algebraic, num: Poly, den: Poly },
}

impl Time {
    /// num(x)/den(x). The denominator must not vanish at x.
    pub fn ratio(x: &Algebraic, num: Poly, den: Poly) -> Time {
        if let Some(r) = x.known_rat() {
            return Time::from(num.eval(&r) / den.eval(&r));
        }
        let at = x.interval();
        let interval = Poly::quotient_over(&num, &den, at);
        Time(Arc::new(Inner {
            interval,
            form: Form::Ratio {
                x: x.clone(),
                num,
                den,
            },
            exact: OnceLock::new(),
            name: OnceLock::new(),
        }))
    }
    /// The instant that is the algebraic number x itself.
    pub fn at(x: Algebraic) -> Time {
        Time::ratio(
            &x,
            Poly::new(vec![Int::zero(), Int::one()]),
            Poly::constant(Int::one()),
        )
    }
    /// This instant on a clock that started `by` earlier.
    pub fn shift(&self, by: &Rat) -> Time {
        if by.is_zero() {
            return self.clone();
        }
        match &self.0.form {
            Form::Rational(r) => Time::from(r + by),
            Form::Ratio { x, num, den } => Time::ratio(
                x,
                num.scale(by.denom()) + den.scale(by.numer()),
                den.scale(by.denom()),
            ),
        }
    }
    /// a + b·t exactly.
    pub fn affine(&self, a: &Rat, b: &Rat) -> Algebraic {
        match &self.0.form {
            Form::Rational(t) => Algebraic::from(a + b * t),
            Form::Ratio { x, num, den } => {
                let all = Poly::from_rats(&[a.clone(), b.clone(), Rat::one()]);
                let (a, b, one) = (all.coeff(0), all.coeff(1), all.coeff(2));
                x.ratio(&(den.scale(&a) + num.scale(&b)), &den.scale(&one))
            }
        }
    }
    /// A certified enclosure; the whole line where the filter is off.
    pub fn interval(&self) -> Interval {
        if filter::on() {
            self.0.interval
        } else {
            Interval::all()
        }
    }
    /// The same instant, with an enclosure also if it was made while the filter was off.
    pub(super) fn renewed(&self) -> Time {
        match &self.0.form {
            Form::Rational(r) => Time::from(r.clone()),
            Form::Ratio { x, num, den } => Time::ratio(x, num.clone(), den.clone()),
        }
    }
    /// The rational value, where it is known to be rational without work.
    pub fn as_rat(&self) -> Option<&Rat> {
        match &self.0.form {
            Form::Rational(r) => Some(r),
            Form::Ratio { .. } => None,
        }
    }
    /// Numerator and denominator as polynomials of the position x that this time was made at.
    pub fn parts(&self) -> (Poly, Poly) {
        match &self.0.form {
            Form::Rational(r) => (
                Poly::constant(r.numer().clone()),
                Poly::constant(r.denom().clone()),
            ),
            Form::Ratio { num, den, .. } => (num.clone(), den.clone()),
        }
    }
    /// The number itself.
    pub fn exact(&self) -> &Algebraic {
        self.0.exact.get_or_init(|| match &self.0.form {
            Form::Rational(r) => Algebraic::from(r.clone()),
            Form::Ratio { x, num, den } => x.ratio(num, den),
        })
    }
    /// Whether both are handles of one instant (no arithmetic; false proves nothing).
    pub fn same_handle(&self, other: &Time) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
    /// A number that all handles of this instant share, and no other instant of this process ever has.
    pub(crate) fn name(&self) -> u64 {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        *self
            .0
            .name
            .get_or_init(|| NEXT.fetch_add(1, AtomicOrdering::Relaxed))
    }
    /// Exact comparison with a rational.
    pub fn cmp_rat(&self, r: &Rat) -> Ordering {
        match &self.0.form {
            Form::Rational(s) => s.cmp(r),
            Form::Ratio { .. } => {
                let (t, i) = (self.interval(), r.interval());
                if t.below(&i) {
                    filter::settled(Stage::Double);
                    Ordering::Less
                } else if i.below(&t) {
                    filter::settled(Stage::Double);
                    Ordering::Greater
                } else {
                    self.exact().cmp_rat(r)
                }
            }
        }
    }
    /// A rational strictly between two instants. Panics if they are equal.
    pub fn between(a: &Time, b: &Time) -> Rat {
        let (lo, hi) = if a < b { (a, b) } else { (b, a) };
        let (i, j) = (lo.interval(), hi.interval());
        if i.below(&j) && i.hi.is_finite() && j.lo.is_finite() {
            return Rat::short_between_doubles(i.hi, j.lo);
        }
        Algebraic::between(lo.exact(), hi.exact())
    }
}

impl From<Rat> for Time {
    fn from(r: Rat) -> Time {
        Time(Arc::new(Inner {
            interval: r.tight(),
            form: Form::Rational(r),
            exact: OnceLock::new(),
            name: OnceLock::new(),
        }))
    }
}

impl PartialEq for Time {
    fn eq(&self, o: &Time) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for Time {}
impl PartialOrd for Time {
    fn partial_cmp(&self, o: &Time) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Time {
    fn cmp(&self, o: &Time) -> Ordering {
        if self.same_handle(o) {
            filter::settled(Stage::Name);
            return Ordering::Equal;
        }
        let (x, y) = (self.interval(), o.interval());
        if x.below(&y) {
            filter::settled(Stage::Double);
            return Ordering::Less;
        }
        if y.below(&x) {
            filter::settled(Stage::Double);
            return Ordering::Greater;
        }
        match (&self.0.form, &o.0.form) {
            (Form::Rational(a), Form::Rational(b)) => {
                // Fractions in lowest terms are one number if they are spelt alike.
                if a == b {
                    filter::settled(Stage::Name);
                    return Ordering::Equal;
                }
                filter::settled_exactly(false, a.bits().max(b.bits()));
                a.cmp(b)
            }
            (Form::Rational(a), _) => o.cmp_rat(a).reverse(),
            (_, Form::Rational(b)) => self.cmp_rat(b),
            _ => self.exact().cmp(o.exact()),
        }
    }
}
