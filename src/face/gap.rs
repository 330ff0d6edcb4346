//! The difference of two curves over a range: how far one lies above the other.

use super::approx::Approx;
use super::isolate::{bernstein, one_sign};
use super::kernel::{CurveId, Kernel};

/// The difference of two curves as a quotient of polynomials of degree n.
pub(super) struct Gap {
    above: [Approx; 5],
    below: [Approx; 5],
    n: usize,
}

impl Gap {
    /// An enclosure over [a, b]; None where the denominator may vanish.
    pub(super) fn range(&self, a: f64, b: f64) -> Option<(f64, f64)> {
        let (p, q) = (
            bernstein(&self.above[..=self.n], a, b),
            bernstein(&self.below[..=self.n], a, b),
        );
        let sign = q[0].sign().filter(|&s| s != 0)?;
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for (p, q) in p.iter().zip(&q).take(self.n + 1) {
            if q.sign() != Some(sign) {
                return None;
            }
            let t = p.over(*q);
            if !(t.v.is_finite() && t.e.is_finite()) {
                return None;
            }
            (lo, hi) = (lo.min(t.lo()), hi.max(t.hi()));
        }
        Some((lo, hi))
    }

    /// Whether it is surely above `high` all over [a, b], or below `low`.
    pub(super) fn outside(&self, low: f64, high: f64, a: f64, b: f64) -> bool {
        let m = a + (b - a) * 0.5;
        let value = |f: &[Approx; 5]| f[..=self.n].iter().rev().fold(0.0, |s, c| s * m + c.v);
        let (above, below) = (value(&self.above), value(&self.below));
        let bound = match above / below {
            v if v > high => high,
            v if v < low => low,
            _ => return false,
        };
        let bound = Approx::exact(bound);
        let mut rest = [Approx::default(); 5];
        for (r, (p, q)) in rest.iter_mut().zip(self.above.iter().zip(&self.below)) {
            *r = *p - bound * *q;
        }
        // The signs are those in the middle.
        one_sign(&rest[..=self.n], a, b) && one_sign(&self.below[..=self.n], a, b)
    }
}

impl Kernel {
    /// The difference c − d.
    #[inline]
    pub(super) fn gap(&self, c: CurveId, d: CurveId) -> Gap {
        let above = self.diff(c, d);
        let (a, b) = (&self.curves[c as usize], &self.curves[d as usize]);
        let mut below = [Approx::default(); 5];
        if self.proportional(c, d) {
            let lead = b.q[(0..3).rev().find(|&i| b.q[i].v != 0.0).unwrap_or(0)];
            for (o, q) in below.iter_mut().zip(&a.q) {
                *o = *q * lead;
            }
            return Gap { above, below, n: 2 };
        }
        for i in 0..3 {
            for j in 0..3 {
                below[i + j] = below[i + j] + a.q[i] * b.q[j];
            }
        }
        Gap { above, below, n: 4 }
    }
}
