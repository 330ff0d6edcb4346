//! Greatest common divisors of machine words.

/// Binary gcd on machine words; gcd(0, x) = x.
#[inline]
pub(crate) fn gcd_u64(mut a: u64, mut b: u64) -> u64 {
    if a == 0 || b == 0 {
        return a | b;
    }
    let shift = (a | b).trailing_zeros();
    a >>= a.trailing_zeros();
    b >>= b.trailing_zeros();
    while a != b {
        // The larger is replaced by the difference, written so that it compiles without a branch.
        let (d, borrow) = a.overflowing_sub(b);
        b = if borrow { a } else { b };
        a = if borrow { d.wrapping_neg() } else { d };
        a >>= a.trailing_zeros();
    }
    a << shift
}

pub(super) fn gcd_u128(mut a: u128, mut b: u128) -> u128 {
    if a == 0 || b == 0 {
        return a | b;
    }
    // One division first: operands of very different size would make the subtractive loop long.
    if a < b {
        std::mem::swap(&mut a, &mut b);
    }
    if a >> 64 != 0 && b >> 64 == 0 {
        return gcd_u64((a % b) as u64, b as u64) as u128;
    }
    let shift = (a | b).trailing_zeros();
    a >>= a.trailing_zeros();
    b >>= b.trailing_zeros();
    while a != b {
        if (a | b) >> 64 == 0 {
            return (gcd_u64(a as u64, b as u64) as u128) << shift;
        }
        if a < b {
            std::mem::swap(&mut a, &mut b);
        }
        a -= b;
        a >>= a.trailing_zeros();
    }
    a << shift
}
