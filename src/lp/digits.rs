//! Integers by digits base p, by words in two's complement, and as doubles: what lifting works on.

use super::field::Prime;
use crate::number::Int;

/// Digits base p of an integer, all of its sign.
pub(super) fn digits_of(v: &Int, p: &Int) -> Vec<i64> {
    let mut rest = v.abs();
    let sign = i64::from(v.sign());
    let mut out = Vec::new();
    while !rest.is_zero() {
        let (q, r) = rest.div_rem_floor(p);
        out.push(sign * r.to_i64().unwrap_or(0));
        rest = q;
    }
    out
}

/// An integer of a word and a half and more.
pub(super) fn from_u128(v: u128) -> Int {
    match i128::try_from(v) {
        Ok(v) => Int::from(v),
        Err(_) => Int::from((v >> 64) as u64).shl(64) + Int::from(v as u64),
    }
}

/// Σ cₖ pᵏ by halves, so that large values cost what multiplication costs.
pub(super) fn compose(parts: &[Int], p: &Int) -> Int {
    match parts {
        [] => Int::zero(),
        [a] => a.clone(),
        _ if parts.len() <= 8 => parts
            .iter()
            .rev()
            .fold(Int::zero(), |v, c| &v * p + c.clone()),
        _ => {
            let half = parts.len().next_power_of_two() / 2;
            let (low, high) = parts.split_at(half);
            compose(low, p) + compose(high, p) * p.pow(half as u32)
        }
    }
}

/// v reduced to the interval [−M/2, M/2).
pub(super) fn nearest(v: &Int, modulus: &Int) -> Int {
    let r = v.div_rem_floor(modulus).1;
    if r.shl(1) >= *modulus { r - modulus } else { r }
}

/// Residue of a two's-complement number.
pub(super) fn residue(field: &Prime, words: &[u64]) -> u64 {
    let Some((&top, rest)) = words.split_last() else {
        return 0;
    };
    rest.iter()
        .rev()
        .fold(field.residue(top as i64), |r, &w| field.append(r, w))
}

/// acc += v modulo 2⁶⁴ᵂ.
pub(super) fn add_small(words: &mut [u64], v: i64) {
    let (first, carry) = words[0].overflowing_add(v as u64);
    words[0] = first;
    let fill = if v < 0 { u64::MAX } else { 0 };
    let mut carry = u64::from(carry);
    for w in &mut words[1..] {
        let (a, c1) = w.overflowing_add(fill);
        let (b, c2) = a.overflowing_add(carry);
        *w = b;
        carry = u64::from(c1 | c2);
    }
}

/// acc −= a·x modulo 2⁶⁴ᵂ, for signed a and unsigned x.
pub(super) fn sub_product(acc: &mut [u64], a: &[u64], x: u64) {
    let (mut carry, mut borrow) = (0u64, false);
    for (t, &a) in acc.iter_mut().zip(a) {
        let product = u128::from(a) * u128::from(x) + u128::from(carry);
        carry = (product >> 64) as u64;
        let (s, b1) = t.overflowing_sub(product as u64);
        let (s, b2) = s.overflowing_sub(u64::from(borrow));
        *t = s;
        borrow = b1 | b2;
    }
}

/// acc /= p modulo 2⁶⁴ᵂ, for a multiple of p.
pub(super) fn divide_exactly(acc: &mut [u64], field: &Prime) {
    let mut borrow = 0u64;
    for w in acc {
        let (t, under) = w.overflowing_sub(borrow);
        let q = t.wrapping_mul(field.inverse);
        *w = q;
        borrow = ((u128::from(q) * u128::from(field.p)) >> 64) as u64 + u64::from(under);
    }
}

/// A double in [½, 1) in size and an exponent.
pub(crate) fn mantissa(v: &Int) -> (f64, i64) {
    let bits = v.bits() as i64;
    let shift = (bits - 62).max(0);
    let top = v.shr(shift as u64).to_i64().unwrap_or(0) as f64;
    (ldexp(top, shift - bits), bits)
}

/// x·2ᵉ, saturating.
pub(crate) fn ldexp(x: f64, e: i64) -> f64 {
    let mut e = e.clamp(-4000, 4000);
    let mut x = x;
    while e > 1000 {
        x *= 2f64.powi(1000);
        e -= 1000;
    }
    while e < -1000 {
        x *= 2f64.powi(-1000);
        e += 1000;
    }
    x * 2f64.powi(e as i32)
}
