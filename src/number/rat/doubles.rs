//! Rationals and integers as doubles: the nearest one, or the narrowest enclosure.
//!
//! The idea: one division. Where both parts are doubles the processor's quotient is correctly rounded and an exact
//! remainder tells on which side the number lies; elsewhere 64 leading bits of the quotient, and whether anything follows
//! them, do.

use super::super::interval::pow2;
use super::super::{Int, Interval, filter};
use super::Rat;
use std::cmp::Ordering;

impl Rat {
    /// Nearest double, ties to even; None past the double range. Never −0.
    pub fn nearest_f64(&self) -> Option<f64> {
        if let Some((q, r)) = self.quotient() {
            // IEEE division of exactly representable operands is correctly rounded.
            let _ = r;
            return Some(q + 0.0);
        }
        if self.is_zero() {
            return Some(0.0);
        }
        let (q, sticky, e) = self.leading();
        let x = Rounded::new(q, sticky, e).nearest()?;
        Some(if self.sign() < 0 { -x + 0.0 } else { x })
    }
    /// Tightest double enclosure (a point where exact); the whole line where the filter is off.
    #[inline]
    pub fn interval(&self) -> Interval {
        if filter::on() {
            self.tight()
        } else {
            Interval::all()
        }
    }
    /// The bits of the longer part.
    pub(crate) fn bits(&self) -> u64 {
        self.num.bits().max(self.den.bits())
    }
    /// Tightest double enclosure.
    pub(crate) fn tight(&self) -> Interval {
        if let Some((q, r)) = self.quotient() {
            return match r.partial_cmp(&0.0) {
                Some(Ordering::Greater) => Interval {
                    lo: q,
                    hi: q.next_up(),
                },
                Some(Ordering::Less) => Interval {
                    lo: q.next_down(),
                    hi: q,
                },
                _ => Interval::point(q + 0.0),
            };
        }
        if self.is_zero() {
            return Interval::point(0.0);
        }
        let (q, sticky, e) = self.leading();
        signed(self.sign(), Rounded::new(q, sticky, e).enclosure())
    }
    /// For parts below 2^53: the nearest double q, and a double with the sign of self − q.
    #[inline]
    fn quotient(&self) -> Option<(f64, f64)> {
        const LIMIT: u64 = 1 << 53;
        let (n, d) = (self.num.to_i64()?, self.den.to_i64()?);
        if n.unsigned_abs() >= LIMIT || d.unsigned_abs() >= LIMIT {
            return None;
        }
        let (n, d) = (n as f64, d as f64);
        let q = n / d;
        // n − q·d without rounding: the product in two parts (Dekker, Veltkamp); no part can overflow or
        // underflow at these sizes, and n − p is exact since p is near n (Sterbenz).
        let (qh, ql) = split(q);
        let (dh, dl) = split(d);
        let p = q * d;
        let e = ql * dl - (((p - qh * dh) - ql * dh) - qh * dl);
        Some((q, (n - p) - e))
    }
    /// |self| = (q + fraction)·2^e, q of 63 or 64 bits; whether the fraction is not zero. Not for zero.
    fn leading(&self) -> (u64, bool, i64) {
        if self.is_integer() {
            let (q, s, sticky) = self.num.top64();
            return (q, sticky, s as i64);
        }
        let s = 63 - (self.num.bits() as i64 - self.den.bits() as i64);
        let n = self.num.abs();
        let (n, d) = if s >= 0 {
            (n.shl(s as u64), self.den.clone())
        } else {
            (n, self.den.shl(s.unsigned_abs()))
        };
        let (q, r) = n.div_rem_floor(&d);
        let (top, shift, _) = q.top64();
        debug_assert!(shift == 0);
        (top, !r.is_zero(), -s)
    }
}

/// Veltkamp's split into two halves of 26 bits.
#[inline]
fn split(x: f64) -> (f64, f64) {
    let t = 134_217_729.0 * x;
    let h = t - (t - x);
    (h, x - h)
}

/// x = m·2^e exactly.
///
/// # Panics
/// On NaN and infinities.
pub(crate) fn decompose(x: f64) -> (i64, i64) {
    assert!(x.is_finite(), "{x} is no rational number");
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i64;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (m, e) = if exponent == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, exponent - 1075)
    };
    (if x < 0.0 { -m } else { m }, e)
}

/// A positive real number between two neighbouring doubles, `m`·2^`u` and (`m`+1)·2^`u`.
struct Rounded {
    m: u64,
    u: i64,
    exact: bool,
    /// Whether the nearest one, ties to even, is the upper.
    up: bool,
}

impl Rounded {
    /// From (q + fraction)·2^e with q > 0; `sticky` tells whether the fraction is not zero.
    fn new(q: u64, sticky: bool, e: i64) -> Rounded {
        let msb = 63 - q.leading_zeros() as i64 + e;
        let u = (msb - 52).max(-1074);
        let drop = u - e;
        if drop > 64 {
            // Below half of the least subnormal double.
            return Rounded {
                m: 0,
                u,
                exact: false,
                up: false,
            };
        }
        if drop <= 0 {
            // Fewer bits than a double holds; the fraction then lies wholly below the last one.
            debug_assert!(!sticky || drop == 0);
            return Rounded {
                m: q << -drop,
                u,
                exact: !sticky,
                up: false,
            };
        }
        let wide = q as u128;
        let (low, half) = (wide & ((1 << drop) - 1), 1u128 << (drop - 1));
        let m = (wide >> drop) as u64;
        Rounded {
            m,
            u,
            exact: low == 0 && !sticky,
            up: low > half || low == half && (sticky || m & 1 == 1),
        }
    }
    fn value(&self, m: u64) -> f64 {
        if self.u > 971 || self.u == 971 && m >> 53 != 0 {
            f64::INFINITY
        } else {
            m as f64 * pow2(self.u as i32)
        }
    }
    fn nearest(&self) -> Option<f64> {
        let x = self.value(self.m + self.up as u64);
        x.is_finite().then_some(x)
    }
    fn enclosure(&self) -> Interval {
        let lo = self.value(self.m).min(f64::MAX);
        if self.exact && self.u <= 971 {
            Interval::point(lo)
        } else {
            Interval {
                lo,
                hi: self.value(self.m + 1),
            }
        }
    }
}

fn signed(sign: i32, x: Interval) -> Interval {
    if sign < 0 { -x } else { x }
}

impl Int {
    /// Tightest double enclosure (a point where exact); the whole line where the filter is off.
    #[inline]
    pub fn interval(&self) -> Interval {
        if !filter::on() {
            return Interval::all();
        }
        if let Some(v) = self.to_i64()
            && v.unsigned_abs() >> 53 == 0
        {
            return Interval::point(v as f64);
        }
        self.interval_shifted(0)
    }
    /// Tightest double enclosure of self·2^k.
    pub(crate) fn interval_shifted(&self, k: i64) -> Interval {
        if self.is_zero() {
            return Interval::point(0.0);
        }
        let (q, shift, sticky) = self.top64();
        signed(
            self.sign(),
            Rounded::new(q, sticky, shift as i64 + k).enclosure(),
        )
    }
}
