//! Certified `f64` intervals with outward rounding.
//!
//! The idea: a double settles a question only where its error bound proves the answer. An interval
//! carries the bound along: after every operation the ends are moved outward past the rounding error, so
//! the exact result of the operation on any reals of the operands is inside. Where nothing can be said the
//! result is the whole line; it is never NaN.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A closed interval of doubles that encloses a real number; either end may be infinite, which
/// says that nothing is known on that side (infinity itself is no member).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// lower end
    pub lo: f64,
    /// upper end
    pub hi: f64,
}

/// a + b rounded down and up: the rounding error of an addition is itself a double (Knuth's two-sum), so
/// an exact sum is not widened.
#[inline]
fn sum_down(a: f64, b: f64) -> f64 {
    let (s, e) = two_sum(a, b);
    // A NaN error (overflow on the way) counts as inexact.
    if (0.0..f64::INFINITY).contains(&e) && s < f64::INFINITY {
        s
    } else {
        s.next_down()
    }
}
#[inline]
fn sum_up(a: f64, b: f64) -> f64 {
    let (s, e) = two_sum(a, b);
    if (0.0..f64::INFINITY).contains(&-e) && s > f64::NEG_INFINITY {
        s
    } else {
        s.next_up()
    }
}
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// a·b with the convention of unbounded sets: zero times an infinite end is zero.
#[inline]
fn prod_down(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 {
        0.0
    } else {
        (a * b).next_down()
    }
}
#[inline]
fn prod_up(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 {
        0.0
    } else {
        (a * b).next_up()
    }
}

impl Interval {
    /// A point. `x` should be finite; operations on anything else answer with the whole line or
    /// an unbounded interval.
    #[inline]
    pub fn point(x: f64) -> Interval {
        Interval { lo: x, hi: x }
    }
    /// The whole line.
    #[inline]
    pub fn all() -> Interval {
        Interval {
            lo: f64::NEG_INFINITY,
            hi: f64::INFINITY,
        }
    }
    /// The ends as given, or the whole line where they are no interval.
    #[inline]
    fn guard(lo: f64, hi: f64) -> Interval {
        if lo <= hi {
            Interval { lo, hi }
        } else {
            Interval::all()
        }
    }
    /// The sign that holds throughout, None if undecided. Some(0) only for the point zero.
    #[inline]
    pub fn sign(&self) -> Option<i32> {
        if self.lo > 0.0 {
            Some(1)
        } else if self.hi < 0.0 {
            Some(-1)
        } else if self.lo == 0.0 && self.hi == 0.0 {
            Some(0)
        } else {
            None
        }
    }
    /// Whether every number of self lies strictly below every number of other.
    #[inline]
    pub fn below(&self, other: &Interval) -> bool {
        self.hi < other.lo
    }
    /// Whether they share a point.
    #[inline]
    pub fn meets(&self, other: &Interval) -> bool {
        !(self.below(other) || other.below(self))
    }
    /// Whether `x` is inside.
    #[inline]
    pub fn contains(&self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }
    /// Whether both ends are finite.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }
    /// hi − lo, rounded up.
    #[inline]
    pub fn width(&self) -> f64 {
        sum_up(self.hi, -self.lo)
    }
    /// The least interval that holds both.
    #[inline]
    pub fn hull(&self, o: &Interval) -> Interval {
        Interval::guard(self.lo.min(o.lo), self.hi.max(o.hi))
    }
    /// Square root of the non-negative part; the point zero where that part is empty.
    pub fn sqrt(&self) -> Interval {
        if self.lo.is_nan() || self.hi.is_nan() {
            return Interval::all();
        }
        if self.hi < 0.0 {
            return Interval::point(0.0);
        }
        // IEEE square roots are correctly rounded. An exact one has at most 26 significant bits or shows by
        // its square; otherwise one step outward is enough.
        let exact = |s: f64, x: f64| {
            let half = f64::from_bits(s.to_bits() & !0x07ff_ffff);
            half == s && s * s == x && x.is_normal()
        };
        let lo = if self.lo <= 0.0 {
            0.0
        } else {
            let s = self.lo.sqrt();
            if exact(s, self.lo) {
                s
            } else {
                s.next_down().max(0.0)
            }
        };
        let hi = if self.hi == 0.0 {
            0.0
        } else {
            let s = self.hi.sqrt();
            if exact(s, self.hi) { s } else { s.next_up() }
        };
        Interval::guard(lo, hi)
    }
    /// Square: never negative, tighter than a product with itself.
    pub fn square(&self) -> Interval {
        let (a, b) = (self.lo.abs(), self.hi.abs());
        if self.lo > 0.0 || self.hi < 0.0 {
            let (s, l) = if a < b { (a, b) } else { (b, a) };
            Interval::guard(prod_down(s, s).max(0.0), prod_up(l, l))
        } else if self.lo.is_nan() || self.hi.is_nan() {
            Interval::all()
        } else {
            let l = a.max(b);
            Interval::guard(0.0, prod_up(l, l))
        }
    }
}

/// 2^k for −1074 ≤ k ≤ 1023.
pub(crate) fn pow2(k: i32) -> f64 {
    if k >= -1022 {
        f64::from_bits(((k + 1023) as u64) << 52)
    } else {
        f64::from_bits(1 << (k + 1074))
    }
}

/// A little more than half a unit in the last place of a finite double: added to it, or taken from it, it
/// gives a neighbour.
#[inline]
fn unit(x: f64) -> f64 {
    const HALF: f64 = 0.5 * f64::EPSILON * (1.0 + f64::EPSILON);
    x.abs() * HALF + 5e-324
}

#[inline]
fn lesser(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}
#[inline]
fn greater(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

/// The ends' sums without a branch, where nothing overflows; an exact one is not widened.
#[inline]
fn sum(a: f64, b: f64, c: f64, d: f64) -> Option<Interval> {
    let ((s, e), (t, f)) = (two_sum(a, c), two_sum(b, d));
    let finite = s.abs() < f64::INFINITY && t.abs() < f64::INFINITY;
    finite.then(|| Interval {
        lo: s - if e < 0.0 { unit(s) } else { 0.0 },
        hi: t + if f > 0.0 { unit(t) } else { 0.0 },
    })
}

impl Add for Interval {
    type Output = Interval;
    #[inline]
    fn add(self, o: Interval) -> Interval {
        if let Some(s) = sum(self.lo, self.hi, o.lo, o.hi) {
            return s;
        }
        Interval::guard(sum_down(self.lo, o.lo), sum_up(self.hi, o.hi))
    }
}
impl Sub for Interval {
    type Output = Interval;
    #[inline]
    fn sub(self, o: Interval) -> Interval {
        if let Some(s) = sum(self.lo, self.hi, -o.hi, -o.lo) {
            return s;
        }
        Interval::guard(sum_down(self.lo, -o.hi), sum_up(self.hi, -o.lo))
    }
}
impl Mul for Interval {
    type Output = Interval;
    /// The extremes of the four products of ends, without a branch on signs; zero, infinite ends and
    /// overflow go the long way.
    #[inline]
    fn mul(self, o: Interval) -> Interval {
        let (a, b, c, d) = (self.lo, self.hi, o.lo, o.hi);
        let (p, q, r, s) = (a * c, a * d, b * c, b * d);
        let zero = (a == 0.0 && b == 0.0) || (c == 0.0 && d == 0.0);
        if (p.abs() + q.abs()) + (r.abs() + s.abs()) < f64::INFINITY && !zero {
            let lo = lesser(lesser(p, q), lesser(r, s));
            let hi = greater(greater(p, q), greater(r, s));
            return Interval {
                lo: lo - unit(lo),
                hi: hi + unit(hi),
            };
        }
        self.product(o)
    }
}

impl Interval {
    /// The product by cases.
    fn product(self, o: Interval) -> Interval {
        let (a, b, c, d) = (self.lo, self.hi, o.lo, o.hi);
        if a >= 0.0 {
            if c >= 0.0 {
                return Interval::guard(prod_down(a, c), prod_up(b, d));
            }
            if d <= 0.0 {
                return Interval::guard(prod_down(b, c), prod_up(a, d));
            }
            return Interval::guard(prod_down(b, c), prod_up(b, d));
        }
        if b <= 0.0 {
            if c >= 0.0 {
                return Interval::guard(prod_down(a, d), prod_up(b, c));
            }
            if d <= 0.0 {
                return Interval::guard(prod_down(b, d), prod_up(a, c));
            }
            return Interval::guard(prod_down(a, d), prod_up(a, c));
        }
        if c >= 0.0 {
            return Interval::guard(prod_down(a, d), prod_up(b, d));
        }
        if d <= 0.0 {
            return Interval::guard(prod_down(b, c), prod_up(a, c));
        }
        if a.is_nan() || b.is_nan() || c.is_nan() || d.is_nan() {
            return Interval::all();
        }
        Interval::guard(
            prod_down(a, d).min(prod_down(b, c)),
            prod_up(a, c).max(prod_up(b, d)),
        )
    }
}
/// The whole line where the divisor holds zero.
impl Div for Interval {
    type Output = Interval;
    fn div(self, o: Interval) -> Interval {
        let negative = o.hi < 0.0;
        if !(o.lo > 0.0 || negative) {
            return Interval::all();
        }
        // A negative divisor turns both signs.
        let (n, c, d) = if negative {
            (-self, -o.hi, -o.lo)
        } else {
            (self, o.lo, o.hi)
        };
        // x/∞ stands for the values x/y with y as large as you like: its limit is 0.
        let quot = |x: f64, y: f64| {
            if x == 0.0 || y.is_infinite() {
                0.0
            } else {
                x / y
            }
        };
        let down = |x: f64, y: f64| {
            let q = quot(x, y);
            if q == 0.0 && (x >= 0.0 || y.is_infinite()) {
                0.0
            } else {
                q.next_down()
            }
        };
        let up = |x: f64, y: f64| {
            let q = quot(x, y);
            if q == 0.0 && (x <= 0.0 || y.is_infinite()) {
                0.0
            } else {
                q.next_up()
            }
        };
        let lo = if n.lo >= 0.0 {
            down(n.lo, d)
        } else {
            down(n.lo, c)
        };
        let hi = if n.hi >= 0.0 {
            up(n.hi, c)
        } else {
            up(n.hi, d)
        };
        Interval::guard(lo, hi)
    }
}
impl Neg for Interval {
    type Output = Interval;
    #[inline]
    fn neg(self) -> Interval {
        Interval {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}
