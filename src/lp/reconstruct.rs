//! A rational from its residue: the half-way stop of Euclid's algorithm.
//!
//! If u ≡ n/d modulo M with |n|·d far below M, the Euclidean remainders of (M, u) hold ±n with
//! cofactor ±d just before a quotient of about M/(|n|·d): the one quotient that sticks out. So no
//! sizes need be guessed. Lehmer's trick runs most steps on the leading 62 bits; the large
//! quotient is exactly where it must fall back to a full division, and there we look.

use crate::number::Int;

/// Bits of a quotient that is taken for the stop; a random one is met once in 2⁴⁴ steps, and what
/// follows checks the guess.
const TELLING: u64 = 44;

/// n and d > 0 with n ≡ d·u modulo `modulus`, both small, if there are such.
pub(crate) fn reconstruct(u: &Int, modulus: &Int) -> Option<(Int, Int)> {
    let mut a = modulus.clone();
    let mut b = u.div_rem_floor(modulus).1;
    let (mut s, mut t) = (Int::zero(), Int::one());
    loop {
        if b.is_zero() {
            // The remainders ended: u·t ≡ 0, so the value 0 sticks out if t is small.
            return (t.bits() + TELLING < modulus.bits()).then(|| (Int::zero(), t.abs()));
        }
        let shift = a.bits().saturating_sub(62);
        let (x, y) = (a.shr(shift).to_i64()?, b.shr(shift).to_i64()?);
        match lehmer(x, y) {
            Some([p, q, v, w]) => {
                let c = |k: i64| Int::from(k);
                let next_a = &a * &c(p) + &b * &c(q);
                let next_b = &a * &c(v) + &b * &c(w);
                let next_s = &s * &c(p) + &t * &c(q);
                let next_t = &s * &c(v) + &t * &c(w);
                (a, b, s, t) = (next_a, next_b, next_s, next_t);
            }
            None => {
                let (q, r) = a.div_rem_floor(&b);
                if q.bits() >= TELLING {
                    let negative = t.sign() < 0;
                    return Some((if negative { -b } else { b }, t.abs()));
                }
                let next_t = &s - &(&q * &t);
                (a, b, s, t) = (b, r, t, next_t);
            }
        }
    }
}

/// Several quotients at once from the leading bits, as a matrix; None where not even one is sure.
fn lehmer(mut x: i64, mut y: i64) -> Option<[i64; 4]> {
    let (mut a, mut b, mut c, mut d) = (1i64, 0i64, 0i64, 1i64);
    let limit = 1i64 << 31;
    while y + c > 0 && y + d > 0 {
        let q = (x + a) / (y + c);
        if q >= limit || q != (x + b) / (y + d) {
            break;
        }
        let (e, f) = (a - q * c, b - q * d);
        if e.abs() >= limit || f.abs() >= limit {
            break;
        }
        (a, c, b, d) = (c, e, d, f);
        (x, y) = (y, x - q * y);
    }
    (b != 0).then_some([a, b, c, d])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_was_hidden() {
        let p = Int::from((1i64 << 57) - 13);
        for bits in [1u64, 5, 30, 62, 63, 64, 100, 500, 3000] {
            let n = (Int::one().shl(bits) + Int::from(12345i64)) * Int::from(-1i64);
            let d = Int::from(3i64).pow(bits as u32) + Int::from(2i64);
            let g = n.gcd(&d);
            let (n, d) = (n.div_exact(&g), d.div_exact(&g));
            let digits = (n.bits() + d.bits() + 60) / 56 + 1;
            let m = p.pow(digits as u32);
            // u = n/d: extended Euclid by hand.
            let (mut a, mut b, mut s, mut t) = (m.clone(), d.clone(), Int::zero(), Int::one());
            while !b.is_zero() {
                let (q, r) = a.div_rem_floor(&b);
                let next = &s - &(&q * &t);
                (a, b, s, t) = (b, r, t, next);
            }
            assert_eq!(a, Int::one());
            let u = (&s * &n).div_rem_floor(&m).1;
            assert_eq!(reconstruct(&u, &m), Some((n, d)));
        }
        let m = p.pow(3);
        assert_eq!(
            reconstruct(&Int::zero(), &m),
            Some((Int::zero(), Int::one()))
        );
        assert_eq!(
            reconstruct(&Int::from(7i64), &m),
            Some((Int::from(7i64), Int::one()))
        );
        assert_eq!(
            reconstruct(&Int::from(-7i64), &m),
            Some((Int::from(-7i64), Int::one()))
        );
    }
}
