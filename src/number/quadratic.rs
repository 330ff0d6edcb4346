//! The real roots of quadratics, in closed form.
//!
//! The idea: nearly all equations of the engine are quadratics, and a square root is all that theirs takes. Doubles give
//! narrow enclosures of both roots where they suffice; else one integer square root does, of as many bits
//! as separate the roots. Either way q = −b ∓ √(b² − 4ac) is taken with the sign that cancels nothing, and the roots
//! are q/(2a) and 2c/q.

use super::refine::Span;
use super::root::{NARROW, Root};
use super::{Algebraic, Int, Interval, Poly, Rat, filter};
use std::sync::Arc;

/// The real roots of a·x² + b·x + c, a ≠ 0, ascending.
pub(super) fn quadratic_roots(a: &Int, b: &Int, c: &Int) -> Vec<Algebraic> {
    let d = b * b - (a * c).shl(2);
    match d.sign() {
        -1 => return Vec::new(),
        0 => return vec![Algebraic::from(Rat::new(-b, a + a))],
        _ => {}
    }
    if let Some(s) = d.sqrt_exact() {
        let two_a = a + a;
        let (x, y) = (Rat::new(-b - &s, two_a.clone()), Rat::new(&s - b, two_a));
        return if a.sign() > 0 {
            vec![x.into(), y.into()]
        } else {
            vec![y.into(), x.into()]
        };
    }
    let p = Poly::new(vec![c.clone(), b.clone(), a.clone()]).primitive();
    // The enclosures of both roots. Doubles are rational and the roots are not: where they lie apart each
    // holds one root, in its interior.
    if let Some((x, y)) = in_doubles(a, b, c, &d) {
        return Algebraic::pair(p, x, y);
    }
    by_square_root(p)
}

/// Narrow enclosures of both irrational roots, ascending and apart.
fn in_doubles(a: &Int, b: &Int, c: &Int, d: &Int) -> Option<(Interval, Interval)> {
    if !filter::on() {
        return None;
    }
    let most = a.bits().max(b.bits()).max(c.bits()) as i64;
    let (ia, ib, ic, s) = if most <= 500 {
        (
            a.interval(),
            b.interval(),
            c.interval(),
            d.interval().sqrt(),
        )
    } else {
        // Scaled together, so that nothing overflows.
        let k = 500 - most;
        (
            a.interval_shifted(k),
            b.interval_shifted(k),
            c.interval_shifted(k),
            d.interval_shifted(2 * k).sqrt(),
        )
    };
    let positive = b.sign() >= 0;
    let q = if positive { -(ib + s) } else { s - ib };
    let (mut x, mut y) = (q / (ia + ia), (ic + ic) / q);
    // x is the root nearer −∞ where a and b agree in sign.
    if positive != (a.sign() > 0) {
        std::mem::swap(&mut x, &mut y);
    }
    let narrow = |x: &Interval| x.width() <= NARROW * x.lo.abs().min(x.hi.abs());
    (x.below(&y) && narrow(&x) && narrow(&y)).then_some((x, y))
}

/// The two irrational roots of a primitive quadratic with positive leading coefficient.
fn by_square_root(p: Poly) -> Vec<Algebraic> {
    const BITS: i64 = 72;
    let [c, b, a] = p.coeffs() else {
        // Both callers have matched on the number of coefficients.
        unreachable!("a quadratic has three coefficients");
    };
    let d = b * b - (a * c).shl(2);
    // S < 2^m·√d < S + 1, so 2^m·|q| lies between Q and Q + 1.
    let m = (BITS - d.bits() as i64 / 2).max(2) as u64;
    let s = d.shl(2 * m).sqrt().unwrap_or_default();
    let q = b.abs().shl(m) + s;
    let next = &q + Int::one();
    // (n/d, N/D) on a grid that tells the roots apart, which lie √d/a > 1/a from one another: the
    // errors of both, 2^-m/(2a) and two cells each, are less.
    let grid = a.bits() as i64 + 3;
    let outer = |negative: bool, (n, d): (&Int, &Int), (n2, d2): (&Int, &Int)| {
        let size = n.bits() as i64 - d.bits() as i64;
        let e = (BITS - size).max(grid).max(0) as u64;
        let lo = n.shl(e).div_rem_floor(d).0;
        let hi = n2.shl(e).div_rem_floor(d2).0 + Int::one();
        if negative {
            Span {
                lo: -hi,
                hi: -lo,
                e,
            }
        } else {
            Span { lo, hi, e }
        }
    };
    let (two_a, two_c) = (a.shl(m + 1), c.abs().shl(m + 1));
    let turned = b.sign() >= 0;
    let large = outer(turned, (&q, &two_a), (&next, &two_a));
    let small = outer(turned != (c.sign() < 0), (&two_c, &next), (&two_c, &q));
    let (x, y) = if turned {
        (large, small)
    } else {
        (small, large)
    };
    let p = Arc::new(p);
    vec![
        Root::spanned(p.clone(), x, 1).into(),
        Root::spanned(p, y, -1).into(),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::isolate::isolate;
    use super::*;

    /// Quadratics of all sizes, near and far roots among them.
    fn samples() -> Vec<[Int; 3]> {
        let mut seed = 11u64;
        let mut next = |bits: u64| {
            let mut v = Int::zero();
            for _ in 0..bits.div_ceil(31) {
                seed = seed
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                v = v.shl(31) + Int::from((seed >> 33) as i64);
            }
            let v = v.shr(v.bits().saturating_sub(bits));
            if seed >> 40 & 1 == 0 { v } else { -v }
        };
        let mut out = Vec::new();
        for round in 0..400usize {
            let bits = [3, 20, 60, 130, 700, 1500][round % 6];
            let low = [3, 40, 900][round / 6 % 3];
            out.push([next(low), next(bits), next(bits)]);
            out.push([next(bits), next(low), next(bits)]);
            out.push([next(bits), next(bits), next(low)]);
            // (x − u)² − tiny, times a number: roots 2^-bits apart.
            let u = next(40);
            let scale = Int::one().shl(2 * bits) * next(9);
            out.push([&u * &u * &scale - Int::one(), -(&u + &u) * &scale, scale]);
        }
        out.retain(|c| !c[2].is_zero());
        out
    }

    #[test]
    fn the_closed_form_finds_what_isolation_finds() {
        let mut by_integers = 0;
        for [c, b, a] in samples() {
            let p = Poly::new(vec![c.clone(), b.clone(), a.clone()]).primitive();
            let d = &b * &b - (&a * &c).shl(2);
            let found = quadratic_roots(&a, &b, &c);
            let exactly = filter::with_filter(false, || quadratic_roots(&a, &b, &c));
            assert_eq!(found.len(), (d.sign() + 1) as usize, "{p}");
            let renewed: Vec<_> = exactly.iter().map(|r| r.defining_polynomial()).collect();
            assert_eq!(renewed.len(), found.len());
            if d.sign() <= 0 {
                continue;
            }
            let want = Algebraic::from_isolated(p.clone(), isolate(&p));
            assert_eq!(found, want, "{p}");
            assert_eq!(exactly, want, "{p}");
            if d.sqrt_exact().is_none() {
                by_integers += 1;
                let roots = by_square_root(p.clone());
                assert_eq!(roots, want, "{p}");
                assert!(roots[0] < roots[1]);
                for (r, w) in roots.iter().zip(&want) {
                    assert_eq!(r.nearest_f64(), w.nearest_f64());
                    assert!(r.interval().meets(&w.interval()));
                }
            }
        }
        assert!(by_integers > 300, "{by_integers}");
    }
}
