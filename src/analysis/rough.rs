//! Arctangents in doubles, with proven bounds.
//!
//! The idea: most enclosures that a user asks for are wider than a double's last digits, so a
//! double with a proven error settles them. Who needs more asks [`super::fix`].

use crate::number::Interval;

/// arctan x lies within a relative 2⁻⁴⁷ of what [`atan_rough`] computes.
const ERROR: f64 = 1.0 / (1u64 << 47) as f64;

/// π.
pub(super) fn pi() -> Interval {
    // The nearest double is below π.
    let lo = std::f64::consts::PI;
    Interval {
        lo,
        hi: lo.next_up(),
    }
}

/// arctan x for 0 ≤ x ≤ 1: three times arctan x = 2·arctan(x/(1 + √(1 + x²))), which leaves at most
/// tan(π/32) < 0.0985, then the series.
///
/// Its error, with u = 2⁻⁵³ and operations that are rounded to nearest: a halving loses at most 4u and
/// passes an earlier relative error on at most once (the slope of ln y′ over ln y is 1/√(1 + y²));
/// the series, a Horner sum whose terms after the first are below 0.0033 in all, loses less than
/// 2u and its last product one more; the first term left out is below 2⁻⁵⁸ of the value. That is below
/// 16u = 2⁻⁴⁹ in all; [`ERROR`] is four times as much.
fn atan_rough(x: f64) -> f64 {
    let mut y = x;
    for _ in 0..3 {
        y /= 1.0 + (1.0 + y * y).sqrt();
    }
    let z = y * y;
    let mut sum = 0.0;
    // Σ (−z)^k/(2k + 1), k from 8 down to 0: z^9/19 < 2⁻⁶⁰.
    for k in (0..9u32).rev() {
        sum = 1.0 / f64::from(2 * k + 1) - z * sum;
    }
    8.0 * (y * sum)
}

/// arctan x, enclosed. Any finite double; odd.
fn atan_point(x: f64) -> Interval {
    if x < 0.0 {
        return -atan_point(-x);
    }
    if x > 1.0 {
        let half = pi() * Interval::point(0.5);
        return half - atan(&(Interval::point(1.0) / Interval::point(x)));
    }
    // x − x³/3 < arctan x ≤ x: below, x³/3 is less than half a step, and no square underflows
    // above.
    if x < 1e-100 {
        return Interval {
            lo: x.next_down().max(0.0),
            hi: x,
        };
    }
    let y = atan_rough(x);
    Interval {
        lo: y * (1.0 - ERROR),
        hi: y * (1.0 + ERROR),
    }
}

/// The arctangent; monotone, so each end by itself.
pub(super) fn atan(x: &Interval) -> Interval {
    if !x.is_finite() {
        return pi() * Interval { lo: -0.5, hi: 0.5 };
    }
    let lo = atan_point(x.lo);
    if x.lo == x.hi {
        return lo;
    }
    Interval {
        lo: lo.lo,
        hi: atan_point(x.hi).hi,
    }
}

/// θ = π·`half_turn` + 2·arctan(x).
pub(super) fn theta(x: &Interval, half_turn: i64) -> Interval {
    let a = atan(x);
    let turned = a + a;
    match half_turn {
        0 => turned,
        h => turned + pi() * Interval::point(h as f64),
    }
}

/// 2·arctan(x)/x = 2·∫₀¹ ds/(1 + x²s²) at a double x ≥ 0; 2 at 0.
fn lever_point(x: f64) -> Interval {
    if x < 1e-100 {
        // 2 − 2x²/3.
        return Interval {
            lo: 2f64.next_down(),
            hi: 2.0,
        };
    }
    let a = atan_point(x);
    (a + a) / Interval::point(x)
}

/// The derivative by z = x² of 2·arctan(x)/x, at a double z ≥ 0.
fn bend_point(z: f64) -> Interval {
    let x = Interval::point(z);
    if z < 1.0 / 256.0 {
        // 2·Σ k(−1)^k z^(k−1)/(2k + 1): alternating, and the terms fall.
        let term =
            |k: i32| Interval::point(f64::from(2 * k)) / Interval::point(f64::from(2 * k + 1));
        let sum = (1..8)
            .rev()
            .fold(Interval::point(0.0), |s, k| term(k) - x * s);
        let left = z.powi(7).next_up() * 2.0;
        return Interval {
            lo: -left,
            hi: left,
        } - sum;
    }
    // (2/(1 + z) − A)/(2z).
    let root = x.sqrt();
    let a = atan(&root);
    let slope = Interval::point(2.0) / (Interval::point(1.0) + x);
    (slope - (a + a) / root) / (x + x)
}

/// 2·arctan(x)/x with its derivative: even, and as the integral above shows, falling in |x| and
/// convex in x²: so both are known from the ends.
pub(super) fn lever(x: &Interval) -> [Interval; 2] {
    let (a, b) = (x.lo.abs(), x.hi.abs());
    let far = a.max(b);
    let near = if x.contains(0.0) { 0.0 } else { a.min(b) };
    let value = Interval {
        lo: lever_point(far).lo,
        hi: lever_point(near).hi,
    };
    let z = x.square();
    let bend = Interval {
        lo: bend_point(z.lo).lo,
        hi: bend_point(z.hi).hi,
    };
    let twice = *x + *x;
    [value, twice * bend]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::fix::Bits;
    use super::*;
    use crate::number::Rat;

    /// Every double enclosure holds the wide one, near 0 and 1 and in between.
    #[test]
    fn doubles_enclose_what_many_bits_enclose() {
        let b = Bits(400);
        let mut xs: Vec<f64> = (-300..1).map(|k| 10f64.powi(k)).collect();
        xs.extend((0..3000).map(|k| f64::from(k).sqrt() / 54.0));
        xs.extend([1f64.next_down(), 1.0, 1f64.next_up(), 3.5, 1e9, 1.0 / 16.0]);
        xs.extend([(1.0f64 / 256.0).sqrt(), (1.0f64 / 256.0).sqrt().next_down()]);
        let holds = |i: Interval, v: &super::super::fix::Fix, what: &str, x: f64| {
            assert!(Rat::from_f64(i.lo) <= v.lo(), "{what} {x}");
            assert!(v.hi() <= Rat::from_f64(i.hi), "{what} {x}");
        };
        for x in xs.iter().flat_map(|x| [*x, -*x]) {
            let wide = b.rat(&Rat::from_f64(x));
            let i = Interval::point(x);
            let a = wide.atan();
            if x.abs() > 1e-90 {
                holds(atan(&i), &a, "arctan", x);
                let got = atan(&i);
                assert!(
                    got.width() <= 2.1 * ERROR * got.hi.abs().max(1e-300) + 1e-15,
                    "{x}"
                );
            }
            if x.abs() <= 1.0 && x.abs() > 1e-20 {
                let value = a.mul(&b.int(2)).div(&wide).unwrap();
                let slope = b.int(2).div(&b.int(1).add(&wide.mul(&wide))).unwrap();
                let rate = slope.sub(&value).div(&wide).unwrap();
                let [v, d] = lever(&i);
                holds(v, &value, "lever", x);
                holds(d, &rate, "its slope", x);
                assert!(d.width() < 1e-9, "{x}: {d:?}");
            }
        }
        assert!(pi().lo < pi().hi);
        holds(pi(), &b.pi(), "π", 0.0);
        holds(
            theta(&Interval::point(0.5), 3),
            &super::super::peak::theta(&b.rat(&Rat::frac(1, 2)), 3, b),
            "θ",
            0.5,
        );
    }
}
