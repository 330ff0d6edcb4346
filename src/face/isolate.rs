//! Simple roots of a polynomial of low degree in doubles, with proof, or the word that doubles cannot tell.
//!
//! The idea: Bernstein coefficients on an interval have at least as many sign changes as the polynomial has
//! roots there, and as many up to an even number. No change: no root; one change: one root; else halve.
//! The coefficients carry error bounds, so that every sign used is certain.

use super::approx::{Approx, horner};

/// Enclosures of simple roots.
pub(super) struct Roots {
    pub(super) at: [(f64, f64); 4],
    pub(super) n: usize,
}

/// How deep the halving goes before exact arithmetic takes over.
const DEPTH: u32 = 10;

/// Encloses every root of the polynomial in [a, b], each in an interval that holds no other; false where
/// doubles cannot tell. By Bernstein coefficients: no sign change, no root; one, one root.
pub(super) fn isolate(g: &[Approx], a: f64, b: f64, out: &mut Roots) -> bool {
    let n = g.len() - 1;
    if n == 0 {
        return matches!(g[0].sign(), Some(-1 | 1));
    }
    if n <= 2
        && let Some(found) = closed(g, a, b)
    {
        *out = found;
        return true;
    }
    let c = bernstein(g, a, b);
    settle(
        &Whole {
            g,
            n,
            slack: (a.abs() + b.abs()) * 64.0 * f64::EPSILON,
        },
        &c,
        a,
        b,
        0,
        out,
    )
}

/// A root's enclosure is at most so wide, as part of its size, to be taken from the formula.
const NARROW: f64 = 1.0 / (1u64 << 44) as f64;

/// The roots near [a, b] of a polynomial of degree one or two by the formula; None where that does not tell them
/// apart, or is rougher than a search.
fn closed(g: &[Approx], a: f64, b: f64) -> Option<Roots> {
    let mut roots = Roots {
        at: [(0.0, 0.0); 4],
        n: 0,
    };
    let mut take = |x: Approx| {
        if !(x.e <= x.v.abs() * NARROW) {
            return None;
        }
        let (lo, hi) = (x.lo(), x.hi());
        if hi >= a && lo <= b {
            // A double's own value is a narrow enough interval, but an interval must have an inside.
            roots.at[roots.n] = (lo.next_down(), hi.next_up());
            roots.n += 1;
        }
        Some(())
    };
    if g.len() == 2 {
        take((-g[0]).over(g[1]))?;
        return Some(roots);
    }
    let [g0, g1, g2] = [g[0], g[1], g[2]];
    let radicand = g1 * g1 - Approx::exact(4.0) * (g0 * g2);
    match radicand.sign()? {
        1 => {}
        -1 => return Some(roots),
        _ => return None,
    }
    // Nothing cancels: the root grows the side that g1 has.
    let s = radicand.sqrt();
    let q = if g1.v > 0.0 {
        -(g1 + s).half()
    } else {
        (s - g1).half()
    };
    let (x, y) = (q.over(g2), g0.over(q));
    if !(x.hi().next_up() < y.lo().next_down() || y.hi().next_up() < x.lo().next_down()) {
        return None;
    }
    take(x)?;
    take(y)?;
    Some(roots)
}

/// Whether the polynomial surely has no root in [a, b]: its value in the middle outweighs all that the other
/// terms of its expansion there can add. (Bernstein coefficients would tell a little more at ten times the cost.)
pub(super) fn one_sign(g: &[Approx], a: f64, b: f64) -> bool {
    let n = g.len() - 1;
    let m = a + (b - a) * 0.5;
    // Not quite half the length, if that was rounded down: hence the room.
    let r = (b - m).max(m - a);
    let far = m.abs() + r;
    let (mut size, mut error) = (0.0, 0.0);
    let mut c = [0.0; 5];
    for k in (0..=n).rev() {
        size = size * far + g[k].v.abs();
        error = error * far + g[k].e;
        c[k] = g[k].v;
    }
    for i in 0..n {
        for j in (i..n).rev() {
            c[j] += m * c[j + 1];
        }
    }
    let rest = c[1..=n].iter().rev().fold(0.0, |s, x| s * r + x.abs()) * r;
    // Fewer than forty roundings of numbers that add up to `size`.
    c[0].abs() - rest > size * (64.0 * f64::EPSILON) + error * (1.0 + 1e-9) + f64::MIN_POSITIVE
}

/// The coefficients on [a, b].
#[inline]
pub(super) fn bernstein(g: &[Approx], a: f64, b: f64) -> [Approx; 5] {
    let n = g.len() - 1;
    // One over the binomial coefficients.
    const THIRD: f64 = 1.0 / 3.0;
    const SIXTH: f64 = 1.0 / 6.0;
    const SHARE: [[f64; 5]; 5] = [
        [1.0; 5],
        [1.0, 1.0, 0.0, 0.0, 0.0],
        [1.0, 0.5, 1.0, 0.0, 0.0],
        [1.0, THIRD, THIRD, 1.0, 0.0],
        [1.0, 0.25, SIXTH, 0.25, 1.0],
    ];
    let mut c = [Approx::default(); 5];
    c[..=n].copy_from_slice(g);
    let (x, w) = (Approx::exact(a), Approx::exact(b) - Approx::exact(a));
    for i in 0..n {
        for j in (i..n).rev() {
            c[j] = c[j] + x * c[j + 1];
        }
    }
    let mut power = w;
    for j in 1..=n {
        let v = SHARE[n][j];
        let e = if n > 2 && j < n {
            v * f64::EPSILON
        } else {
            0.0
        };
        c[j] = c[j] * power * Approx { v, e };
        power = power * w;
    }
    for i in 1..=n {
        for j in (i..=n).rev() {
            c[j] = c[j] + c[j - 1];
        }
    }
    c
}

/// What the halving keeps in mind of the whole.
struct Whole<'a> {
    g: &'a [Approx],
    n: usize,
    /// Bounds how far the ends of any part may lie from the true cuts.
    slack: f64,
}

fn settle(whole: &Whole<'_>, c: &[Approx; 5], a: f64, b: f64, depth: u32, out: &mut Roots) -> bool {
    let (g, n) = (whole.g, whole.n);
    // The most sign changes that the unknown signs allow: best with the last sign plus, minus.
    let none = -100;
    let (mut plus, mut minus) = (none, none);
    for (i, x) in c[..=n].iter().enumerate() {
        let s = x.sign();
        let start = if i == 0 { 0 } else { none };
        let (p, m) = (
            plus.max(minus + 1).max(start),
            minus.max(plus + 1).max(start),
        );
        (plus, minus) = match s {
            Some(1) => (p, none),
            Some(-1) => (none, m),
            Some(_) if i > 0 => (plus, minus),
            _ => (p, m),
        };
    }
    let most = plus.max(minus);
    let (first, last) = (c[0].sign(), c[n].sign());
    let (Some(first), Some(last)) = (first, last) else {
        return deeper(whole, c, a, b, depth, out);
    };
    if most == 0 && first != 0 {
        return true;
    }
    if most == 1 && first * last < 0 {
        if out.n == 4 {
            return false;
        }
        return match refine(g, a, b, first) {
            Some(r) => {
                out.at[out.n] = r;
                out.n += 1;
                true
            }
            None => false,
        };
    }
    deeper(whole, c, a, b, depth, out)
}

/// Halves (not quite, since a root in the very middle is likely) and settles both parts.
fn deeper(whole: &Whole<'_>, c: &[Approx; 5], a: f64, b: f64, depth: u32, out: &mut Roots) -> bool {
    let (g, n) = (whole.g, whole.n);
    if depth >= DEPTH || a >= b {
        return false;
    }
    const CUT: f64 = 0.484375;
    let (s, r) = (Approx::exact(CUT), Approx::exact(1.0 - CUT));
    let mid = a + (b - a) * CUT;
    if !(a < mid && mid < b) {
        return false;
    }
    let mut left = [Approx::default(); 5];
    let mut right = *c;
    for (k, first) in left.iter_mut().enumerate().take(n + 1) {
        *first = right[0];
        for j in 0..n - k {
            right[j] = right[j] * r + right[j + 1] * s;
        }
    }
    // `right` holds the last value of each round: reading it back gives the right part.
    // The true cut lies within `slack` of `mid`, and no root lies between the two.
    let near = Approx {
        v: mid,
        e: whole.slack,
    };
    if !matches!(horner(g, near).sign(), Some(-1 | 1)) {
        return false;
    }
    settle(whole, &left, a, mid, depth + 1, out) && settle(whole, &right, mid, b, depth + 1, out)
}

/// Shrinks [a, b], which holds one simple root and has sign `first` at a, to a few ulps.
fn refine(g: &[Approx], a: f64, b: f64, first: i32) -> Option<(f64, f64)> {
    let sign = f64::from(first);
    let (mut l, mut r) = (a, b);
    let mut x = l + (r - l) * 0.5;
    for _ in 0..80 {
        let (mut f, mut d) = (0.0, 0.0);
        for k in g.iter().rev() {
            d = d * x + f;
            f = f * x + k.v;
        }
        if f * sign > 0.0 {
            l = x;
        } else {
            r = x;
        }
        let step = x - f / d;
        let next = if step > l && step < r {
            step
        } else {
            l + (r - l) * 0.5
        };
        let still = (next - x).abs() <= x.abs() * f64::EPSILON;
        x = next;
        if still || l >= r {
            break;
        }
    }
    let unit = (x.abs() * f64::EPSILON).max(f64::MIN_POSITIVE);
    let end = |side: f64, wall: f64, want: i32| {
        let mut step = 2.0 * unit;
        for _ in 0..16 {
            let y = x + side * step;
            if (wall - y) * side <= 0.0 {
                return Some(wall);
            }
            if horner(g, Approx::exact(y)).sign() == Some(want) {
                return Some(y);
            }
            step *= 8.0;
        }
        None
    };
    let lo = end(-1.0, a, first)?;
    let hi = end(1.0, b, -first)?;
    (lo < hi).then_some((lo, hi))
}
