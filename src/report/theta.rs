//! Orientations as doubles: θ = π·h + 2·atan(x), correctly rounded.
//!
//! The idea: Euler's series for the arc tangent has positive terms that at least halve, so its
//! partial sums in fixed point enclose it with an error that is counted, not estimated:
//!
//! ```text
//! atan x = Σ tₙ,   t₀ = x/(1 + x²),   tₙ₊₁ = tₙ · y · 2(n+1)/(2n+3),   y = x²/(1 + x²) ≤ 1/2
//! ```
//!
//! π is four times the same sum at x = 1. An orientation whose half-angle's tangent is algebraic
//! is transcendental unless it is 0 (Lindemann), so it never lies half-way between two doubles,
//! and refining until both ends of the enclosure round alike ends.

use crate::number::{Algebraic, Int, Rat};

/// The double nearest to π·`half_turn` + 2·atan(`x`), where |x| ≤ 1.
pub fn theta(half_turn: i64, x: &Algebraic) -> f64 {
    if half_turn == 0 && x.sign() == 0 {
        return 0.0;
    }
    let mut bits = 128u32;
    loop {
        let (lo, hi) = enclosure(half_turn, x, bits);
        let ends = (rounded(&lo, bits), rounded(&hi, bits));
        if ends.0.to_bits() == ends.1.to_bits() {
            return ends.0;
        }
        bits *= 2;
    }
}

/// The double nearest to n/2^bits; a zero is positive.
fn rounded(n: &Int, bits: u32) -> f64 {
    let r = Rat::new(n.clone(), Int::one().shl(u64::from(bits)));
    let nearest = r.nearest_f64().unwrap_or(if r.sign() < 0 {
        f64::NEG_INFINITY
    } else {
        f64::INFINITY
    });
    nearest + 0.0
}

/// Enclosure of π·h + 2·atan(x) in units of 2^-bits.
fn enclosure(half_turn: i64, x: &Algebraic, bits: u32) -> (Int, Int) {
    let (lo, hi) = x.enclosure(bits);
    // atan grows, so each end goes down or up by itself; grid points are exact.
    let below = atan(&grid(&lo, bits).0, bits).0;
    let above = atan(&grid(&hi, bits).1, bits).1;
    let quarter = atan(&Int::one().shl(u64::from(bits)), bits);
    let turn = Int::from(half_turn).shl(2);
    let (p, q) = (&turn * &quarter.0, &turn * &quarter.1);
    let (p, q) = if half_turn < 0 { (q, p) } else { (p, q) };
    (p + below.shl(1), q + above.shl(1))
}

/// The neighbours of r on the grid of step 2^-bits, below and above (or r itself twice).
fn grid(r: &Rat, bits: u32) -> (Int, Int) {
    let (k, rest) = r.numer().shl(u64::from(bits)).div_rem_floor(r.denom());
    if rest.is_zero() {
        (k.clone(), k)
    } else {
        (k.clone(), k + Int::one())
    }
}

/// Enclosure of atan(k/2^bits) in units of 2^-bits, for |k| ≤ 2^bits.
fn atan(k: &Int, bits: u32) -> (Int, Int) {
    if k.sign() < 0 {
        let (lo, hi) = atan(&-k, bits);
        return (-hi, -lo);
    }
    let b = u64::from(bits);
    let square = k * k;
    let whole = Int::one().shl(2 * b) + &square;
    let y = square.shl(b).div_rem_floor(&whole).0;
    let mut term = k.shl(2 * b).div_rem_floor(&whole).0;
    let mut sum = Int::zero();
    let mut n = 0i64;
    while !term.is_zero() {
        sum += &term;
        let next = (&term * &y).shr(b) * Int::from(2 * (n + 1));
        term = next.div_rem_floor(&Int::from(2 * n + 3)).0;
        n += 1;
    }
    // Every step rounds down: a term lacks at most e ≤ e/2 + 3 < 6 units, and the tail that the
    // fixed point no longer shows is less than twice such a term.
    let lost = Int::from(6 * n + 12);
    let above = &sum + &lost;
    (sum, above)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Poly;

    #[test]
    fn pi_is_enclosed() {
        // floor(π·2^124), from the decimal digits of π.
        let (lo, hi) = enclosure(1, &Algebraic::from(Rat::zero()), 124);
        let pi: Int = "66814286504060421741230023322616923956"
            .parse()
            .expect("digits");
        assert!(lo <= pi && pi <= hi, "{lo} {hi}");
        assert!((hi - lo).bits() < 14);
    }

    #[test]
    fn zero_is_exactly_zero() {
        assert_eq!(theta(0, &Algebraic::from(Rat::zero())).to_bits(), 0);
    }

    #[test]
    fn odd_in_the_orientation() {
        for (h, n, d) in [(0, 1, 3), (0, 1, 1), (1, -2, 7), (2, 5, 9), (7, 0, 1)] {
            let x = Algebraic::from(Rat::frac(n, d));
            let minus = Algebraic::from(Rat::frac(-n, d));
            assert_eq!(theta(h, &x), -theta(-h, &minus));
        }
    }

    #[test]
    fn tiny_orientations_keep_all_their_bits() {
        // 2·atan(x) = 2x − 2x³/3 + …, and the cube is far below half an ulp.
        let tiny = Rat::new(Int::from(3), Int::one().shl(900));
        let expected = tiny.nearest_f64().expect("in range") * 2.0;
        assert_eq!(theta(0, &Algebraic::from(tiny)), expected);
    }

    #[test]
    fn an_irrational_tangent() {
        // tan(π/8) = √2 − 1 is a root of x² + 2x − 1; θ = π/4.
        let roots = Poly::new(vec![-Int::one(), Int::from(2), Int::one()]).real_roots();
        assert_eq!(theta(0, &roots[1]), std::f64::consts::FRAC_PI_4);
        assert_eq!(
            theta(0, &Algebraic::from(Rat::one())),
            std::f64::consts::FRAC_PI_2
        );
        assert_eq!(
            theta(1, &Algebraic::from(Rat::zero())),
            std::f64::consts::PI
        );
    }
}
