//! Whether one integer polynomial divides another, on short rows of words.
//!
//! The idea: an exact quotient needs no estimates. Its words follow from the lowest ones up, since an odd number
//! has an inverse modulo 2^64 (Jebelean 1993), so long division runs modulo a power of two above anything that a true
//! quotient can reach. What comes out in the end is a congruence between numbers far shorter than the modulus:
//! an equality. Two rows of words are all the memory it takes, where long integers would be made by the dozen.

use super::{Int, Poly};

/// The words of |v|, in room for them; the rest is zero.
fn fill(v: &Int, room: &mut [u64]) {
    let mut i = 0;
    v.for_each_word(|w| {
        if w != 0 {
            room[i] = w;
        }
        i += 1;
    });
}

/// Two's complement turned round.
fn negate(a: &mut [u64]) {
    let mut carry = true;
    for w in a {
        (*w, carry) = (!*w).overflowing_add(u64::from(carry));
    }
}

fn negative(a: &[u64]) -> bool {
    a.last().is_some_and(|w| w >> 63 == 1)
}

/// Without the zeros at the high end.
fn trimmed(a: &[u64]) -> &[u64] {
    let n = a.iter().rposition(|&w| w != 0).map_or(0, |i| i + 1);
    &a[..n]
}

/// r ∓ a·b modulo 2^64 to the power of r's length.
fn add_product(r: &mut [u64], a: &[u64], b: &[u64], minus: bool) {
    for (i, &x) in a.iter().enumerate().take(r.len()) {
        let mut carry = 0u128;
        let some = b.len().min(r.len() - i);
        let (low, rest) = r[i..].split_at_mut(some);
        let mut over = false;
        for (w, &y) in low.iter_mut().zip(b) {
            carry += u128::from(x) * u128::from(y);
            let (v, o) = if minus {
                let (v, o) = w.overflowing_sub(carry as u64);
                let (v, p) = v.overflowing_sub(u64::from(over));
                (v, o | p)
            } else {
                let (v, o) = w.overflowing_add(carry as u64);
                let (v, p) = v.overflowing_add(u64::from(over));
                (v, o | p)
            };
            (*w, over) = (v, o);
            carry >>= 64;
        }
        let mut carry = carry as u64;
        for w in rest {
            if carry == 0 && !over {
                break;
            }
            let (v, o, p);
            if minus {
                (v, o) = w.overflowing_sub(carry);
                (*w, p) = v.overflowing_sub(u64::from(over));
            } else {
                (v, o) = w.overflowing_add(carry);
                (*w, p) = v.overflowing_add(u64::from(over));
            }
            (over, carry) = (o | p, 0);
        }
    }
}

/// 1/d modulo 2^64, for odd d (Newton, each step doubling the bits that are right).
fn inverse(d: u64) -> u64 {
    let mut x = d.wrapping_mul(3) ^ 2;
    for _ in 0..4 {
        x = x.wrapping_mul(2u64.wrapping_sub(d.wrapping_mul(x)));
    }
    x
}

/// The most words of a number: longer ones are no longer short.
const MOST: usize = 64;

/// Whether d divides p over the integers; None where they are too long for it (or one is zero).
pub(super) fn divides(d: &Poly, p: &Poly) -> Option<bool> {
    let (m, n) = (d.degree()?, p.degree()?);
    if n < m {
        return Some(false);
    }
    let k = n - m;
    let lead = d.leading()?;
    let v = lead.trailing_zeros()?;
    // The coefficients of a true quotient are less than 2^k·√(n + 1) times p's greatest (Mignotte); the sums
    // below have as many terms as the shorter factor.
    let log = |n: usize| u64::from(usize::BITS - n.leading_zeros());
    let most = p.most_bits() + k as u64 + log(n + 1);
    let bits = most + d.most_bits() + log(n + 1) + v + 2;
    let len = bits.div_ceil(64) as usize;
    if len > MOST || k >= 128 {
        return None;
    }
    // Those of d, with the leading one once more as an odd number, and of the quotient; those of p.
    let mut room = vec![0u64; (m + 2 + k + 1) * len + (n + 1) * len];
    let (known, rest) = room.split_at_mut((m + 2 + k + 1) * len);
    for (c, row) in d.coeffs().iter().zip(known.chunks_mut(len)) {
        fill(c, row);
    }
    fill(&lead.abs().shr(v), &mut known[(m + 1) * len..(m + 2) * len]);
    for (c, row) in p.coeffs().iter().zip(rest.chunks_mut(len)) {
        fill(c, row);
        if c.sign() < 0 {
            negate(row);
        }
    }
    let (of_d, of_q) = known.split_at_mut((m + 2) * len);
    let row = |i: usize| trimmed(&of_d[i * len..(i + 1) * len]);
    let odd = row(m + 1);
    let unit = inverse(odd[0]);
    let mut minus = 0u128;
    let mut longest = 0;
    for i in (0..=n).rev() {
        let r = &mut rest[i * len..(i + 1) * len];
        // What the quotient's coefficients found so far contribute.
        for j in (i + 1).saturating_sub(m)..=k.min(i) {
            let (q, c) = (trimmed(&of_q[j * len..(j + 1) * len]), row(i - j));
            let plus = (minus >> j & 1 == 1) == (d.coeffs()[i - j].sign() < 0);
            add_product(r, q, c, plus);
        }
        if i < m {
            if r.iter().any(|&w| w != 0) {
                return Some(false);
            }
            continue;
        }
        let j = i - m;
        // r/2^v, exactly.
        let (words, shift) = ((v / 64) as usize, v % 64);
        if r[..words].iter().any(|&w| w != 0) || (shift > 0 && r[words] << (64 - shift) != 0) {
            return Some(false);
        }
        let sign = if negative(r) { u64::MAX } else { 0 };
        for t in 0..len {
            let at = |s: usize| r.get(s).copied().unwrap_or(sign);
            r[t] = if shift == 0 {
                at(t + words)
            } else {
                at(t + words) >> shift | at(t + words + 1) << (64 - shift)
            };
        }
        let q = &mut of_q[j * len..(j + 1) * len];
        for t in 0..len {
            q[t] = r[t].wrapping_mul(unit);
            add_product(&mut r[t..], &[q[t]], odd, true);
        }
        let turned = negative(q);
        if turned {
            negate(q);
        }
        minus |= u128::from(turned != (lead.sign() < 0)) << j;
        let q = trimmed(q);
        let top = q.last().map_or(0, |w| u64::from(w.leading_zeros()));
        longest = longest.max(64 * q.len() as u64 - top);
    }
    // All congruent; and short enough to be equal.
    Some(longest <= most)
}

#[cfg(test)]
mod tests {
    use super::super::gcd::tests::stream;
    use super::*;

    #[test]
    fn words_tell_what_long_division_tells() {
        let (mut seed, mut yes, mut no) = (9, 0, 0);
        for round in 0..4000usize {
            let bits = [1, 2, 9, 31, 60, 64, 100, 128, 150, 400][round % 10];
            let mut d = stream(&mut seed, round % 5, bits);
            let q = stream(&mut seed, round % 4, [3, 64, 200][round % 3]);
            if round % 7 == 0 {
                // Even at both ends, and more than a word of it.
                d = d.scale(&Int::one().shl(round as u64 % 90));
            }
            let mut p = &d * &q;
            match round % 6 {
                0 => p += Poly::constant(Int::one()),
                1 => p -= stream(&mut seed, 1, bits),
                2 => p = stream(&mut seed, 5, 300),
                _ => {}
            }
            if d.is_zero() || p.is_zero() {
                assert_eq!(divides(&d, &p), None);
                continue;
            }
            // Over the rationals first, then whether the quotient is whole.
            let want = p.div_exact(&d).is_some_and(|q| {
                let back = &q * &d;
                let n = p.degree().unwrap_or(0);
                (p.coeff(n) * &q.coeff(q.degree().unwrap_or(0)))
                    .div_rem_floor(&back.coeff(n))
                    .1
                    .is_zero()
                    && (0..=q.degree().unwrap_or(0)).all(|i| {
                        (p.coeff(n) * q.coeff(i))
                            .div_rem_floor(&back.coeff(n))
                            .1
                            .is_zero()
                    })
            });
            assert_eq!(divides(&d, &p), Some(want), "({p}) / ({d})");
            if want { yes += 1 } else { no += 1 }
        }
        assert!(yes > 1000 && no > 1000, "{yes} {no}");
    }

    #[test]
    fn long_numbers_are_left_to_others() {
        let long = Poly::new(vec![Int::one(), Int::one().shl(5000)]);
        assert_eq!(divides(&long, &long), None);
        assert_eq!(divides(&Poly::zero(), &long), None);
        assert_eq!(divides(&long, &Poly::from_i64(&[1])), Some(false));
    }
}
