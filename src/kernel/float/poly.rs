//! Polynomials in doubles.
//!
//! The idea: a fixed array, since no polynomial of the motion is of high degree; roots between the roots of the
//! derivative, where bisection and Newton cannot miss; and coefficients or roots that differ by rounding alone are one.

use super::identify::{Class, Place, place};
use super::{CANCEL, Double, Float, TOLERANCE, sum};
use crate::kernel::Polynomial;
use crate::number::{Interval, Scalar};

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
    pub(super) fn new(c: &[f64]) -> FloatPoly {
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
    pub(super) fn eval(&self, x: f64) -> f64 {
        self.coeffs().iter().rev().fold(0.0, |s, c| s * x + c)
    }
    /// Σ |c_i x^i|.
    pub(super) fn size(&self, x: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{FloatOptions, with_float};

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
