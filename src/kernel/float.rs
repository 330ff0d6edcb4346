//! The double kernel: fast, and honest about what it is.
//!
//! Every number is one double. What keeps such a simulation on its feet is DP's §8.4.2: zeros
//! that should fall together come out a little apart, so "we should in effect identify these
//! times into one canonical, simultaneous zero-crossing time". Three safeguards do that, and each
//! can be left out to see what it buys ([`Identify`]):
//!
//! * *Zeros.* A sum that cancels to less than 2⁻⁴⁴ of its terms is zero, a polynomial's leading
//!   coefficient likewise; two roots that merge within rounding are one.
//! * *Times.* Instants (and positions) nearer to each other than the tolerance are one, and
//!   transitively so: what bridges two of them makes one of both ([`Classes`]).
//! * *Names.* Patch ends that meet by combinatorics (vertex on vertex, edge flush on edge) are
//!   computed once and shared: f_i, f_j and g_ij = f_i − f_j vanish together by construction, and
//!   the successor of an expiring constraint starts at the very point where that ends, so its
//!   neighbouring generators find it.
//!
//! Nothing here is certified; a result says `f64` and carries no exact numbers.

mod identify;
mod poly;

use self::identify::{Class, Classes, around, middle, moment, place};
pub(crate) use self::identify::{Moment, Place};
pub(crate) use self::poly::FloatPoly;
use super::{Instant, Kernel, Polynomial, Position, Time};
use crate::number::{Algebraic, Int, Interval, Rat, Scalar};
use std::cell::{Cell, RefCell};
use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
use std::rc::Rc;

/// Which zeros are taken for one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Identify {
    /// None: what comes out of the arithmetic decides.
    None,
    /// Those nearer than the tolerance.
    Times,
    /// Those nearer than the tolerance, and those that share a name.
    #[default]
    Names,
}

/// What the double kernel is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatOptions {
    /// Zeros nearer than this are one; in units of time, and of x in a chart.
    pub tolerance: f64,
    /// Which safeguards are on.
    pub identify: Identify,
}

impl Default for FloatOptions {
    fn default() -> FloatOptions {
        FloatOptions {
            tolerance: 1e-9,
            identify: Identify::Names,
        }
    }
}

/// Sums that cancel to less than this share of their terms count as zero.
const CANCELLED: f64 = 1.0 / (1u64 << 44) as f64;
/// Enclosures are widened by so many tolerances, for what is identified later.
const SLACK: f64 = 16.0;
/// Coefficients of curves are scaled to integers by this power of two when they are published.
pub const COEFFICIENT_BITS: i64 = 1074;

thread_local! {
    static TOLERANCE: Cell<f64> = const { Cell::new(0.0) };
    static CANCEL: Cell<f64> = const { Cell::new(0.0) };
    static NAMES: Cell<bool> = const { Cell::new(true) };
    static TIMES: RefCell<Classes> = const { RefCell::new(Classes::new()) };
    static PLACES: RefCell<Classes> = const { RefCell::new(Classes::new()) };
}

/// Runs `f` with the double kernel set up as asked, on this thread.
pub fn with_float<T>(options: &FloatOptions, f: impl FnOnce() -> T) -> T {
    let on = options.identify != Identify::None;
    TOLERANCE.set(if on { options.tolerance.max(0.0) } else { 0.0 });
    CANCEL.set(if on { CANCELLED } else { 0.0 });
    NAMES.set(options.identify == Identify::Names);
    Float::begin();
    f()
}

/// The double kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Float;

/// A double as a coordinate: ordered totally, zero without a sign.
#[derive(Clone, Copy, Debug, Default)]
pub struct Double(f64);

impl Double {
    /// The double itself.
    pub fn get(self) -> f64 {
        self.0
    }
}
impl PartialEq for Double {
    fn eq(&self, o: &Double) -> bool {
        self.cmp(o).is_eq()
    }
}
impl Eq for Double {}
impl PartialOrd for Double {
    fn partial_cmp(&self, o: &Double) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Double {
    fn cmp(&self, o: &Double) -> Ordering {
        self.0.total_cmp(&o.0)
    }
}
impl Hash for Double {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.to_bits().hash(state);
    }
}

/// a + b, zero where the terms cancel.
#[inline]
fn sum(a: f64, b: f64) -> f64 {
    let s = a + b;
    if s.abs() <= CANCEL.get() * a.abs() {
        0.0
    } else {
        s
    }
}

fn to_rat(x: f64) -> Rat {
    if x.is_finite() {
        Rat::from_f64(x)
    } else {
        Rat::from_f64(f64::MAX.copysign(x))
    }
}

impl Scalar for Double {
    const EXACT: bool = false;
    fn from_rat(r: &Rat) -> Double {
        Double(r.nearest_f64().unwrap_or(if r.sign() < 0 {
            f64::NEG_INFINITY
        } else {
            f64::INFINITY
        }))
    }
    fn to_rat(&self) -> Rat {
        to_rat(self.0)
    }
    #[inline]
    fn plus(&self, o: &Double) -> Double {
        Double(sum(self.0, o.0) + 0.0)
    }
    #[inline]
    fn minus(&self, o: &Double) -> Double {
        Double(sum(self.0, -o.0) + 0.0)
    }
    #[inline]
    fn times(&self, o: &Double) -> Double {
        Double(self.0 * o.0 + 0.0)
    }
    #[inline]
    fn over(&self, o: &Double) -> Double {
        Double(self.0 / o.0 + 0.0)
    }
    #[inline]
    fn negated(&self) -> Double {
        Double(-self.0 + 0.0)
    }
    #[inline]
    fn sign(&self) -> i32 {
        i32::from(self.0 > 0.0) - i32::from(self.0 < 0.0)
    }
    #[inline]
    fn interval(&self) -> Interval {
        Interval::point(self.0)
    }
    fn vanishes_beside(&self, size: &Double) -> bool {
        self.0.abs() <= 16.0 * CANCEL.get() * size.0.abs()
    }
    fn one() -> Double {
        Double(1.0)
    }
}

impl Kernel for Float {
    type Num = Double;
    type Coef = f64;
    type Key = Vec<i64>;
    type Poly = FloatPoly;
    type Root = Place;
    type Time = Moment;

    const CERTIFIED: bool = false;
    const ENCLOSES: bool = false;

    fn begin() {
        TIMES.with_borrow_mut(|c| c.ranges.clear());
        PLACES.with_borrow_mut(|c| c.ranges.clear());
        let tolerance = TOLERANCE.get();
        for x in [0.0, -1.0, 1.0] {
            PLACES.with_borrow_mut(|c| c.identify(x, tolerance));
        }
        TIMES.with_borrow_mut(|c| c.identify(0.0, tolerance));
    }
    fn names() -> bool {
        NAMES.get()
    }
    /// Divided by the largest one.
    fn primitive(c: &[Double]) -> Option<(Vec<f64>, i32)> {
        let most = c.iter().fold(0.0, |m: f64, c| m.max(c.0.abs()));
        if most == 0.0 || !most.is_finite() {
            return None;
        }
        let cancel = CANCEL.get();
        let last = c.iter().rev().find(|c| c.0.abs() > cancel * most)?;
        let sign = last.sign();
        let unit = most * f64::from(sign);
        let part = |c: &Double| {
            let x = c.0 / unit + 0.0;
            if x.abs() <= cancel { 0.0 } else { x }
        };
        Some((c.iter().map(part).collect(), sign))
    }
    /// Rounded well above the noise, so that what differs by rounding only is one; or bit by bit.
    fn key(c: &[f64]) -> Vec<i64> {
        if NAMES.get() {
            c.iter()
                .map(|c| (c * 2f64.powi(40)).round() as i64)
                .collect()
        } else {
            c.iter().map(|c| c.to_bits() as i64).collect()
        }
    }
    fn stop(u: &Double) -> [f64; 3] {
        let size = u.0.abs().max(1.0);
        [-u.0 / size, 1.0 / size, 0.0]
    }
    fn zero_coef() -> f64 {
        0.0
    }
    fn publish(c: &f64) -> Int {
        let scaled = to_rat(*c) * Rat::from(Int::one().shl(COEFFICIENT_BITS as u64));
        scaled.floor()
    }
}

impl Position<Float> for Place {
    fn of(x: Double) -> Place {
        place(x.0)
    }
    fn same(&self, o: &Place) -> bool {
        Rc::ptr_eq(&self.0, &o.0)
    }
    fn renew(&self) -> Place {
        place(self.get())
    }
    fn interval(&self) -> Interval {
        around(self.get())
    }
    fn sign(&self) -> i32 {
        Double(self.get()).sign()
    }
    fn cmp_num(&self, x: &Double) -> Ordering {
        self.get().total_cmp(&x.0)
    }
    /// Zero where a root lies within the tolerance, as far as the size of the terms tells.
    fn sign_of(&self, p: &FloatPoly) -> i32 {
        let x = self.get();
        let v = p.eval(x);
        if v.abs() <= TOLERANCE.get().max(CANCEL.get()) * p.size(x) {
            0
        } else {
            Double(v).sign()
        }
    }
    fn between(a: &Place, b: &Place) -> Double {
        middle(a.get(), b.get())
    }
    fn ratio(&self, num: &FloatPoly, den: &FloatPoly) -> Place {
        let x = self.get();
        // Past the chart: not a position that anything is identified with.
        Place(Class::new(num.eval(x) / den.eval(x)))
    }
    fn publish(&self) -> Algebraic {
        Algebraic::from(to_rat(self.get()))
    }
}

impl Instant<Float> for Moment {
    fn of(t: Double) -> Moment {
        moment(t.0)
    }
    fn same(&self, o: &Moment) -> bool {
        Rc::ptr_eq(&self.0, &o.0)
    }
    fn ratio(x: &Place, num: FloatPoly, den: FloatPoly) -> Moment {
        let x = x.get();
        let t = num.eval(x) / den.eval(x);
        moment(if t.is_nan() { f64::INFINITY } else { t })
    }
    fn at(x: Place) -> Moment {
        moment(x.get())
    }
    fn shift(&self, by: &Double) -> Moment {
        moment(self.get() + by.0)
    }
    fn interval(&self) -> Interval {
        around(self.get())
    }
    fn known(&self) -> Option<Double> {
        Some(Double(self.get()))
    }
    fn decided(&self) -> Option<Double> {
        self.known()
    }
    fn parts(&self) -> (FloatPoly, FloatPoly) {
        (FloatPoly::new(&[self.get()]), FloatPoly::one())
    }
    fn cmp_num(&self, t: &Double) -> Ordering {
        self.get().total_cmp(&t.0)
    }
    fn between(a: &Moment, b: &Moment) -> Double {
        middle(a.get(), b.get())
    }
    fn height(
        &self,
        _p: &FloatPoly,
        _q: &FloatPoly,
        _about: Option<Interval>,
        near: &mut dyn FnMut(&Double) -> Place,
    ) -> Place {
        near(&Double(self.get()))
    }
    fn publish(&self) -> Time {
        Time::from(to_rat(self.get()))
    }
}
