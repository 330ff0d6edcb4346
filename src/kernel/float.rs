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

// ── identification ──────────────────────────────────────────────────────────────────────────

/// One canonical value; shared by everything that was identified with it.
#[derive(Debug)]
struct Class {
    value: Cell<f64>,
    /// Classes that this one has swallowed.
    merged: RefCell<Vec<Rc<Class>>>,
}

impl Class {
    fn new(value: f64) -> Rc<Class> {
        Rc::new(Class {
            value: Cell::new(value),
            merged: RefCell::default(),
        })
    }
    fn become_value(&self, value: f64) {
        self.value.set(value);
        for m in self.merged.borrow().iter() {
            m.become_value(value);
        }
    }
}

/// The values met so far, as disjoint ranges: what lies within the tolerance of a range belongs to
/// it and widens it, and what joins two ranges makes one of them. So the outcome does not depend
/// on the order in which values are met, only the canonical value does: it is the first one's.
#[derive(Debug)]
struct Classes {
    /// (lowest, highest, class), ascending.
    ranges: Vec<(f64, f64, Rc<Class>)>,
}

impl Classes {
    const fn new() -> Classes {
        Classes { ranges: Vec::new() }
    }
    fn identify(&mut self, x: f64, tolerance: f64) -> Rc<Class> {
        if tolerance <= 0.0 || !x.is_finite() {
            return Class::new(x);
        }
        // The first range that ends at or after x − tolerance.
        let at = self.ranges.partition_point(|r| r.1 < x - tolerance);
        let near = |r: &(f64, f64, Rc<Class>)| r.0 <= x + tolerance;
        if !self.ranges.get(at).is_some_and(near) {
            let class = Class::new(x);
            self.ranges.insert(at, (x, x, class.clone()));
            return class;
        }
        if self.ranges.get(at + 1).is_some_and(near) {
            let (_, high, other) = self.ranges.remove(at + 1);
            let first = &mut self.ranges[at];
            first.1 = high;
            other.become_value(first.2.value.get());
            first.2.merged.borrow_mut().push(other);
        }
        let range = &mut self.ranges[at];
        range.0 = range.0.min(x);
        range.1 = range.1.max(x);
        range.2.clone()
    }
}

/// A position or an instant: the canonical value of what it was identified with.
#[derive(Clone, Debug)]
pub struct Place(Rc<Class>);

/// An instant of the double kernel.
#[derive(Clone, Debug)]
pub struct Moment(Rc<Class>);

fn place(x: f64) -> Place {
    let tolerance = TOLERANCE.get();
    Place(PLACES.with_borrow_mut(|c| c.identify(x + 0.0, tolerance)))
}
fn moment(t: f64) -> Moment {
    let tolerance = TOLERANCE.get();
    Moment(TIMES.with_borrow_mut(|c| c.identify(t + 0.0, tolerance)))
}
fn around(x: f64) -> Interval {
    let w = SLACK * TOLERANCE.get();
    Interval {
        lo: x - w,
        hi: x + w,
    }
}
fn middle(a: f64, b: f64) -> Double {
    let m = a.midpoint(b);
    Double(if m.is_finite() {
        m + 0.0
    } else {
        a.max(b).min(f64::MAX)
    })
}

macro_rules! ordered_by_value {
    ($t:ty) => {
        impl $t {
            /// The canonical value.
            pub fn get(&self) -> f64 {
                self.0.value.get()
            }
        }
        impl PartialEq for $t {
            fn eq(&self, o: &$t) -> bool {
                self.cmp(o).is_eq()
            }
        }
        impl Eq for $t {}
        impl PartialOrd for $t {
            fn partial_cmp(&self, o: &$t) -> Option<Ordering> {
                Some(self.cmp(o))
            }
        }
        impl Ord for $t {
            fn cmp(&self, o: &$t) -> Ordering {
                self.get().total_cmp(&o.get())
            }
        }
    };
}
ordered_by_value!(Place);
ordered_by_value!(Moment);

// ── polynomials ─────────────────────────────────────────────────────────────────────────────

/// No polynomial of the motion has a higher degree.
const MOST: usize = 8;

/// A polynomial in doubles, constant first; the leading coefficient is not zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatPoly {
    c: [f64; MOST + 1],
    /// Coefficients in use.
    n: usize,
}

impl FloatPoly {
    fn new(c: &[f64]) -> FloatPoly {
        let mut p = FloatPoly {
            c: [0.0; MOST + 1],
            n: c.len().min(MOST + 1),
        };
        p.c[..p.n].copy_from_slice(&c[..p.n]);
        p.trimmed()
    }
    fn trimmed(mut self) -> FloatPoly {
        let most = self.coeffs().iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        let least = CANCEL.get() * most;
        while self.n > 0 && (self.c[self.n - 1].abs() <= least) {
            self.n -= 1;
            self.c[self.n] = 0.0;
        }
        self
    }
    fn coeffs(&self) -> &[f64] {
        &self.c[..self.n]
    }
    fn eval(&self, x: f64) -> f64 {
        self.coeffs().iter().rev().fold(0.0, |s, c| s * x + c)
    }
    /// Σ |c_i x^i|.
    fn size(&self, x: f64) -> f64 {
        let x = x.abs();
        self.coeffs().iter().rev().fold(0.0, |s, c| s * x + c.abs())
    }
    fn slope(&self) -> FloatPoly {
        let mut d = FloatPoly {
            c: [0.0; MOST + 1],
            n: self.n.saturating_sub(1),
        };
        for i in 0..d.n {
            d.c[i] = self.c[i + 1] * (i + 1) as f64;
        }
        d.trimmed()
    }
    /// Zero, or nothing beside its own terms.
    fn touches(&self, x: f64) -> bool {
        self.eval(x).abs() <= CANCEL.get() * self.size(x)
    }
    /// The roots in [lo, hi], ascending: between neighbouring extrema there is at most one.
    fn roots_in(&self, lo: f64, hi: f64) -> Vec<f64> {
        let inside = |x: &f64| (lo..=hi).contains(x);
        match *self.coeffs() {
            [] | [_] => Vec::new(),
            [c, b] => Some(-c / b).filter(inside).into_iter().collect(),
            [c, b, a] => {
                let mut r = quadratic(a, b, c);
                r.retain(inside);
                r
            }
            _ => {
                let mut stops = vec![lo];
                stops.extend(self.slope().roots_in(lo, hi));
                stops.push(hi);
                let mut out = Vec::new();
                for (i, &x) in stops.iter().enumerate() {
                    if self.touches(x) {
                        out.push(x);
                    } else if let Some(&y) = stops.get(i + 1)
                        && !self.touches(y)
                        && self.eval(x) * self.eval(y) < 0.0
                    {
                        out.push(self.between(x, y));
                    }
                }
                out.dedup();
                out
            }
        }
    }
    /// The root between two points of different sign: false position (Illinois), then halving.
    fn between(&self, mut a: f64, mut b: f64) -> f64 {
        let (mut fa, mut fb) = (self.eval(a), self.eval(b));
        for round in 0..200 {
            let mut x = if round < 40 {
                (a * fb - b * fa) / (fb - fa)
            } else {
                a.midpoint(b)
            };
            if !(x > a && x < b) {
                x = a.midpoint(b);
                if x <= a || x >= b {
                    break;
                }
            }
            let fx = self.eval(x);
            if fx == 0.0 {
                return x;
            }
            if (fx > 0.0) == (fb > 0.0) {
                (b, fb) = (x, fx);
                fa *= 0.5;
            } else {
                (a, fa) = (x, fx);
                fb *= 0.5;
            }
            if b - a <= 4.0 * f64::EPSILON * a.abs().max(b.abs()) {
                break;
            }
        }
        a.midpoint(b)
    }
}

/// The real roots of a quadratic, ascending, without the cancellation in −b ± √.
fn quadratic(a: f64, b: f64, c: f64) -> Vec<f64> {
    let (bb, ac) = (b * b, 4.0 * a * c);
    let d = bb - ac;
    if d.abs() <= 4.0 * CANCEL.get() * (bb + ac.abs()) {
        return vec![-b / (2.0 * a)];
    }
    if d < 0.0 {
        return Vec::new();
    }
    let q = -0.5 * (b + d.sqrt().copysign(b));
    let mut r = vec![q / a, if q == 0.0 { 0.0 } else { c / q }];
    r.sort_by(f64::total_cmp);
    r.dedup();
    r
}

impl Polynomial<Float> for FloatPoly {
    fn of(c: &[Double]) -> FloatPoly {
        let mut v = [0.0; MOST + 1];
        for (x, c) in v.iter_mut().zip(c) {
            *x = c.0;
        }
        FloatPoly::new(&v[..c.len().min(MOST + 1)])
    }
    fn pair(a: &[Double; 3], b: &[Double; 3]) -> (FloatPoly, FloatPoly) {
        (FloatPoly::of(a), FloatPoly::of(b))
    }
    fn of_curve(c: &[f64; 3], mirrored: bool) -> FloatPoly {
        FloatPoly::new(&if mirrored { [c[2], -c[1], c[0]] } else { *c })
    }
    fn zero() -> FloatPoly {
        FloatPoly::new(&[])
    }
    fn one() -> FloatPoly {
        FloatPoly::new(&[1.0])
    }
    fn is_zero(&self) -> bool {
        self.n == 0
    }
    fn degree(&self) -> Option<usize> {
        self.n.checked_sub(1)
    }
    fn negated(&self) -> FloatPoly {
        FloatPoly {
            c: self.c.map(|c| -c),
            n: self.n,
        }
    }
    fn plus(&self, o: &FloatPoly) -> FloatPoly {
        FloatPoly {
            c: std::array::from_fn(|i| sum(self.c[i], o.c[i])),
            n: self.n.max(o.n),
        }
        .trimmed()
    }
    fn minus(&self, o: &FloatPoly) -> FloatPoly {
        self.plus(&o.negated())
    }
    fn times(&self, o: &FloatPoly) -> FloatPoly {
        let (mut c, mut size) = ([0.0; MOST + 1], [0.0; MOST + 1]);
        for (i, a) in self.coeffs().iter().enumerate() {
            for (j, b) in o.coeffs().iter().enumerate() {
                let k = (i + j).min(MOST);
                c[k] += a * b;
                size[k] += (a * b).abs();
            }
        }
        let cancel = CANCEL.get();
        for (c, s) in c.iter_mut().zip(size) {
            if c.abs() <= cancel * s {
                *c = 0.0;
            }
        }
        let n = match (self.n, o.n) {
            (0, _) | (_, 0) => 0,
            (a, b) => (a + b - 1).min(MOST + 1),
        };
        FloatPoly { c, n }.trimmed()
    }
    fn derivative(&self) -> FloatPoly {
        self.slope()
    }
    /// Of quadratics: the linear factor at a root of one that the other shares.
    fn common(&self, o: &FloatPoly) -> FloatPoly {
        let (few, many) = if self.n <= o.n { (self, o) } else { (o, self) };
        let shared = |x: &f64| many.eval(*x).abs() <= 64.0 * CANCEL.get() * many.size(*x);
        let bound = few.coeffs().iter().fold(0.0, |m: f64, c| m.max(c.abs()))
            / few.coeffs().last().map_or(1.0, |c| c.abs())
            + 1.0;
        few.roots_in(-bound, bound)
            .into_iter()
            .filter(shared)
            .fold(FloatPoly::one(), |g, x| {
                g.times(&FloatPoly::new(&[-x, 1.0]))
            })
    }
    fn quotient(&self, g: &FloatPoly) -> FloatPoly {
        if self.n < g.n || g.n == 0 {
            return FloatPoly::zero();
        }
        let mut rest = self.c;
        let mut out = FloatPoly {
            c: [0.0; MOST + 1],
            n: self.n - g.n + 1,
        };
        for k in (0..out.n).rev() {
            let q = rest[k + g.n - 1] / g.c[g.n - 1];
            for (i, c) in g.coeffs().iter().enumerate() {
                rest[k + i] -= q * c;
            }
            out.c[k] = q;
        }
        out.trimmed()
    }
    fn at_time(p: &FloatPoly, q: &FloatPoly, t: &Double) -> FloatPoly {
        let mut scaled = *q;
        scaled.c.iter_mut().for_each(|c| *c *= t.0);
        p.plus(&scaled)
    }
    fn crossing(p1: &FloatPoly, q1: &FloatPoly, p2: &FloatPoly, q2: &FloatPoly) -> FloatPoly {
        if let (Some(a), Some(b)) = (q1.coeffs().last(), q2.coeffs().last())
            && q1.n == q2.n
            && (0..q1.n).all(|i| sum(q1.c[i] * b, -(q2.c[i] * a)) == 0.0)
        {
            let (mut l, mut r) = (*p1, *p2);
            l.c.iter_mut().for_each(|c| *c *= b);
            r.c.iter_mut().for_each(|c| *c *= a);
            return l.minus(&r);
        }
        p1.times(q2).minus(&p2.times(q1))
    }
    fn constant_ratio(p: &FloatPoly, q: &FloatPoly) -> Double {
        Double(-p.c[0] / q.c[0] + 0.0)
    }
    fn sign_at(&self, x: &Double) -> i32 {
        Double(self.eval(x.0)).sign()
    }
    fn eval_interval(&self, x: Interval) -> Interval {
        let terms = self.coeffs().iter().rev();
        terms.fold(Interval::point(0.0), |s, c| s * x + Interval::point(*c))
    }
    fn chart_roots(&self) -> Vec<Place> {
        // A root just past the end of the chart is the end.
        let slack = TOLERANCE.get();
        let roots = self.roots_in(-1.0 - slack, 1.0 + slack);
        let mut out: Vec<Place> = roots
            .into_iter()
            .map(|x| place(x.clamp(-1.0, 1.0)))
            .collect();
        out.dedup();
        out
    }
    fn roots(&self) -> Vec<Place> {
        let most = self.coeffs().iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        let bound = most / self.coeffs().last().map_or(1.0, |c| c.abs()) + 1.0;
        // These are instants; they are identified when they are made into one.
        let roots = self.roots_in(-bound, bound).into_iter();
        roots.map(|x| Place(Class::new(x))).collect()
    }
}

// ── the kernel ──────────────────────────────────────────────────────────────────────────────

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identification_is_transitive_in_any_order() {
        // 0, 8, 16 in units of a tolerance of 10: neighbours are near, the ends are not.
        for order in [
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ] {
            let mut classes = Classes::new();
            let mut met: Vec<Option<Rc<Class>>> = vec![None; 3];
            for i in order {
                met[i] = Some(classes.identify(8.0 * i as f64, 10.0));
            }
            let far = classes.identify(40.0, 10.0);
            let values: Vec<f64> = met.iter().flatten().map(|c| c.value.get()).collect();
            // The canonical value is that of the first in the surviving class, the same for all.
            assert!(
                values.iter().all(|v| *v == values[0]),
                "{order:?}: {values:?}"
            );
            assert_eq!(far.value.get(), 40.0);
        }
    }

    #[test]
    fn roots_in_doubles() {
        with_float(&FloatOptions::default(), || {
            let roots = |c: &[f64]| FloatPoly::new(c).roots_in(-2.0, 2.0);
            // (x − 1)²(x² + 1), which touches; and without a real root.
            let p = roots(&[1.0, -2.0, 2.0, -2.0, 1.0]);
            assert!(p.len() == 1 && (p[0] - 1.0).abs() < 1e-7, "{p:?}");
            assert!(roots(&[1.0, 0.0, 0.0, 0.0, 1.0]).is_empty());
            let q = roots(&[-1.0, 0.0, 1.0]);
            assert_eq!(q, [-1.0, 1.0]);
            // A cubic with three roots, none of them at an extremum.
            let r = roots(&[0.0, -1.0, 0.0, 1.0]);
            assert_eq!(r.len(), 3);
            assert!(
                r.iter()
                    .zip([-1.0, 0.0, 1.0])
                    .all(|(a, b)| (a - b).abs() < 1e-15)
            );
        });
    }
}
