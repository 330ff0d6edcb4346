//! Root isolation and refinement in doubles, every decision certified.
//!
//! The idea: on most polynomials the signs that steer exact isolation are far from zero, so intervals of
//! doubles prove them at a tenth of the cost. The searches here walk the same tree as the exact ones and
//! give up (`None`) at the first sign that the intervals leave open; they never guess. Newton's method in
//! plain doubles only proposes where a root might be: what is returned has been proven by interval signs.

use super::isolate::{Isolated, root_bound};
use super::{Int, Interval, Poly, filter};

/// The highest degree handled; more would only make the buffers larger.
const MOST: usize = 10;

/// Coefficient enclosures of a polynomial, scaled by a common positive factor into the range of doubles.
pub(crate) struct FloatPoly {
    c: [Interval; MOST + 1],
    n: usize,
}

/// How a scaled list of integers becomes doubles without overflow: the common shift.
fn common_shift(c: &[Int], grow: i64) -> i64 {
    let top = c
        .iter()
        .enumerate()
        .filter(|(_, v)| !v.is_zero())
        .map(|(i, v)| v.bits() as i64 + grow * i as i64)
        .max();
    top.unwrap_or(0)
}

impl FloatPoly {
    /// None where the degree is too high.
    pub(crate) fn new(p: &Poly) -> Option<FloatPoly> {
        let c = p.coeffs();
        let n = c.len().checked_sub(1)?;
        if n > MOST || !filter::on() {
            return None;
        }
        let mut out = [Interval::point(0.0); MOST + 1];
        // Small coefficients stay as they are: small integers are exact.
        let top = common_shift(c, 0);
        let shift = if top > 300 { 300 - top } else { 0 };
        for (o, v) in out.iter_mut().zip(c) {
            *o = if shift == 0 {
                v.interval()
            } else {
                v.interval_shifted(shift)
            };
        }
        Some(FloatPoly { c: out, n })
    }
    fn at(&self, x: f64) -> Interval {
        let x = Interval::point(x);
        self.c[..self.n]
            .iter()
            .rev()
            .fold(self.c[self.n], |acc, c| acc * x + *c)
    }
    /// Value and derivative, uncertified.
    fn guess(&self, x: f64) -> (f64, f64) {
        let mut v = 0.0;
        let mut d = 0.0;
        for c in self.c[..=self.n].iter().rev() {
            d = d * x + v;
            v = v * x + 0.5 * (c.lo + c.hi);
        }
        (v, d)
    }
    /// An enclosure, mostly narrow, of the root that lies strictly between lo and hi, where the polynomial has
    /// the sign `sign_lo` at lo and the opposite one at hi and no other root in between. The signs at
    /// the ends of the answer are proven. None where doubles prove nothing.
    pub(crate) fn polish(&self, lo: f64, hi: f64, sign_lo: i32) -> Option<Interval> {
        if !(lo < hi && lo.is_finite() && hi.is_finite()) {
            return None;
        }
        let (mut a, mut b) = (lo, hi);
        let mut x = 0.5 * a + 0.5 * b;
        let mut slope = 0.0;
        for _ in 0..100 {
            let (v, d) = self.guess(x);
            slope = d;
            if v == 0.0 {
                break;
            }
            if (v > 0.0) == (sign_lo > 0) {
                a = x;
            } else {
                b = x;
            }
            let newton = x - v / d;
            let next = if newton > a && newton < b {
                newton
            } else {
                0.5 * a + 0.5 * b
            };
            let step = (next - x).abs();
            x = next;
            if step <= 1e-15 * x.abs() || b <= a.next_up() {
                break;
            }
        }
        let v = self.at(x);
        let mut radius = 2.25 * v.lo.abs().max(v.hi.abs()) / slope.abs();
        for _ in 0..3 {
            let (l, h) = (
                (x - radius).min(x.next_down()).max(lo),
                (x + radius).max(x.next_up()).min(hi),
            );
            if (l == lo || self.at(l).sign() == Some(sign_lo))
                && (h == hi || self.at(h).sign() == Some(-sign_lo))
            {
                return Some(Interval { lo: l, hi: h });
            }
            radius *= 2.0;
        }
        None
    }
    /// Whether the polynomial is proven to have exactly one root, simple, in (lo, hi), and none at the
    /// ends: the sign there at lo.
    pub(crate) fn one_root(&self, x: Interval) -> Option<i32> {
        let (s, t) = (self.at(x.lo).sign()?, self.at(x.hi).sign()?);
        if s * t >= 0 {
            return None;
        }
        // The derivative keeps its sign on all of the interval.
        let mut acc = Interval::point(0.0);
        for i in (1..=self.n).rev() {
            acc = acc * x + self.c[i] * Interval::point(i as f64);
        }
        (acc.sign()? != 0).then_some(s)
    }
}

type Row = [Interval; MOST + 1];

/// The number of roots in the open piece where that is proven to be 0 or 1; else None. For 1 the signs at both
/// ends are proven not to be zero.
fn count(b: &[Interval]) -> Option<usize> {
    let (mut changes, mut last, mut open) = (0, 0, 0);
    for c in b {
        let Some(s) = c.sign() else {
            open += 1;
            continue;
        };
        if s == 0 {
            continue;
        }
        // One open coefficient between opposite signs makes one change whatever it is; anywhere else it
        // may make more.
        let harmless = if last != 0 && s != last { 1 } else { 0 };
        if open > harmless {
            return None;
        }
        changes += harmless;
        if changes > 1 {
            return None;
        }
        open = 0;
        last = s;
    }
    (open == 0).then_some(changes)
}

/// The positive roots, as `isolate::positive` finds them; None where a sign stays open.
fn positive(c: &[Int], out: &mut Vec<Isolated>) -> Option<()> {
    const LIMIT: usize = 400;
    let n = c.len() - 1;
    let k = root_bound(c);
    // x = 2^k·u: the coefficient i weighs 2^(k·i). The largest is brought to about 1, so that the growth of the
    // sums below (n bits a level) stays far from overflow.
    let shift = -common_shift(c, k);
    let mut row: Row = [Interval::point(0.0); MOST + 1];
    let mut binomial = 1.0;
    for (i, v) in c.iter().enumerate() {
        // Divided by C(n, i): the Bernstein form after the sums.
        row[i] = v.interval_shifted(shift + k * i as i64) / Interval::point(binomial);
        binomial = binomial * (n - i) as f64 / (i + 1) as f64;
    }
    for i in 1..=n {
        for j in (i..=n).rev() {
            row[j] = row[j] + row[j - 1];
        }
    }
    let mut stack: Vec<(Row, u64, u32)> = Vec::with_capacity(16);
    stack.push((row, 0, 0));
    let mut steps = 0;
    while let Some((mut row, at, depth)) = stack.pop() {
        let b = &mut row[..=n];
        match count(b) {
            Some(0) => continue,
            Some(1) if b[0].sign() != Some(0) && b[n].sign() != Some(0) => {
                let e = depth as i64 - k;
                let (lo, hi) = (Int::from(at), Int::from(at + 1));
                out.push(if e >= 0 {
                    Isolated::Open {
                        lo,
                        hi,
                        e: e as u64,
                    }
                } else {
                    Isolated::Open {
                        lo: lo.shl(e.unsigned_abs()),
                        hi: hi.shl(e.unsigned_abs()),
                        e: 0,
                    }
                });
                continue;
            }
            _ => {}
        }
        steps += 1;
        if depth >= 60 || steps > LIMIT {
            return None;
        }
        // De Casteljau without the halves: both sides come out multiplied by 2^n. Scaling by a power of two ≥ 1
        // is exact.
        let scale = |x: Interval, k: usize| {
            let f = (1u64 << k) as f64;
            Interval {
                lo: x.lo * f,
                hi: x.hi * f,
            }
        };
        let mut left: Row = [Interval::point(0.0); MOST + 1];
        for (l, c) in left[..=n].iter_mut().enumerate() {
            *c = scale(b[0], n - l);
            for j in 0..n - l {
                b[j] = b[j] + b[j + 1];
            }
        }
        for (j, c) in b.iter_mut().enumerate() {
            *c = scale(*c, j);
        }
        // A root at the middle, or too near to tell: the exact search knows.
        if !matches!(b[0].sign(), Some(1 | -1)) {
            return None;
        }
        stack.push((row, 2 * at + 1, depth + 1));
        stack.push((left, 2 * at, depth + 1));
    }
    Some(())
}

/// The real roots of a square-free polynomial with non-zero constant term, ascending; None where
/// doubles do not suffice.
pub(crate) fn isolate(c: &[Int]) -> Option<Vec<Isolated>> {
    if c.len() > MOST + 1 || !filter::on() {
        return None;
    }
    let mut out = Vec::new();
    let signs = |flip: bool| {
        let mut last = 0;
        c.iter().enumerate().any(|(i, v)| {
            let s = if flip && i % 2 == 1 {
                -v.sign()
            } else {
                v.sign()
            };
            let change = s * last < 0;
            if s != 0 {
                last = s;
            }
            change
        })
    };
    // Descartes' rule first: without a sign change there is no such root.
    if signs(true) {
        let mirrored: Vec<Int> = c
            .iter()
            .enumerate()
            .map(|(i, v)| if i % 2 == 1 { -v } else { v.clone() })
            .collect();
        positive(&mirrored, &mut out)?;
        out.reverse();
        out.iter_mut().for_each(Isolated::mirror);
    }
    if signs(false) {
        positive(c, &mut out)?;
    }
    Some(out)
}
