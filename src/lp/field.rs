//! The two fields that a basis is factorised over: doubles, which propose, and the integers
//! modulo a prime, which are exact and never grow.
//!
//! The prime lies below 2⁵⁷, so that 2¹³ products can be added in 128 bits before one reduction:
//! that is what makes the triangular solves of p-adic lifting cheap. Entries are kept in
//! Montgomery form (times 2⁶⁴), so that one reduction also takes that factor off again.

/// What sparse elimination asks of a number.
pub(crate) trait Field {
    /// An element.
    type E: Copy + Default + PartialEq + std::fmt::Debug;
    /// Whether it counts as zero.
    fn is_zero(&self, a: Self::E) -> bool;
    /// Size for threshold pivoting; every non-zero element of a finite field is as good as any.
    fn size(&self, a: Self::E) -> f64;
    /// a − m·b.
    fn sub_mul(&self, a: Self::E, m: Self::E, b: Self::E) -> Self::E;
    /// a·b.
    fn times(&self, a: Self::E, b: Self::E) -> Self::E;
    /// 1/a for a ≠ 0.
    fn reciprocal(&self, a: Self::E) -> Self::E;
}

/// Doubles. What cancels to below 10⁻¹⁴ is dropped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Double;

impl Field for Double {
    type E = f64;
    fn is_zero(&self, a: f64) -> bool {
        a.abs() < 1e-14
    }
    fn size(&self, a: f64) -> f64 {
        a.abs()
    }
    fn sub_mul(&self, a: f64, m: f64, b: f64) -> f64 {
        a - m * b
    }
    fn times(&self, a: f64, b: f64) -> f64 {
        a * b
    }
    fn reciprocal(&self, a: f64) -> f64 {
        1.0 / a
    }
}

/// The integers modulo an odd prime below 2⁵⁷; elements in Montgomery form.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prime {
    /// The prime.
    pub(crate) p: u64,
    /// −p⁻¹ modulo 2⁶⁴.
    negative_inverse: u64,
    /// p⁻¹ modulo 2⁶⁴.
    pub(crate) inverse: u64,
    /// 2⁶⁴ modulo p.
    r: u64,
    /// 2¹²⁸ modulo p.
    r2: u64,
}

/// Products that may be summed in 128 bits before a reduction.
pub(crate) const TERMS: usize = 1 << 13;

impl Prime {
    /// The `index`-th of a fixed sequence of primes just below 2⁵⁷.
    pub(crate) fn nth(index: usize) -> Prime {
        let mut candidate = (1u64 << 57) - 1;
        let mut left = index;
        loop {
            if is_prime(candidate) {
                if left == 0 {
                    return Prime::new(candidate);
                }
                left -= 1;
            }
            candidate -= 2;
        }
    }

    fn new(p: u64) -> Prime {
        let mut inverse = p; // Newton: right bits 3, 6, 12, 24, 48, 96
        for _ in 0..5 {
            inverse = inverse.wrapping_mul(2u64.wrapping_sub(p.wrapping_mul(inverse)));
        }
        let r = ((1u128 << 64) % u128::from(p)) as u64;
        Prime {
            p,
            inverse,
            negative_inverse: inverse.wrapping_neg(),
            r,
            r2: (u128::from(r) * u128::from(r) % u128::from(p)) as u64,
        }
    }

    /// t·2⁻⁶⁴ modulo p, for t < 2¹²⁷.
    pub(crate) fn reduce(&self, t: u128) -> u64 {
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        (((t + u128::from(m) * u128::from(self.p)) >> 64) as u64) % self.p
    }

    /// a·b·2⁻⁶⁴: the product of a Montgomery number with a plain one is plain.
    pub(crate) fn mul(&self, a: u64, b: u64) -> u64 {
        let t = u128::from(a) * u128::from(b);
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        let r = ((t + u128::from(m) * u128::from(self.p)) >> 64) as u64;
        if r >= self.p { r - self.p } else { r }
    }

    /// Montgomery form of a plain residue.
    pub(crate) fn enter(&self, a: u64) -> u64 {
        self.mul(a, self.r2)
    }

    /// Plain residue of a machine integer.
    pub(crate) fn residue(&self, a: i64) -> u64 {
        let r = a.unsigned_abs() % self.p;
        if a < 0 && r != 0 { self.p - r } else { r }
    }

    /// r·2⁶⁴ + w for a residue and a word.
    pub(crate) fn append(&self, r: u64, w: u64) -> u64 {
        let t = u128::from(r) * u128::from(self.r2) + u128::from(w) * u128::from(self.r);
        let m = (t as u64).wrapping_mul(self.negative_inverse);
        // t < 2⁶⁴p + 2¹¹⁴, so this is below 3p.
        let r = ((t + u128::from(m) * u128::from(self.p)) >> 64) as u64;
        let r = if r >= self.p { r - self.p } else { r };
        if r >= self.p { r - self.p } else { r }
    }

    /// a − b of residues.
    pub(crate) fn sub(&self, a: u64, b: u64) -> u64 {
        if a >= b { a - b } else { a + self.p - b }
    }

    /// Inverse of a Montgomery number that is not zero, in Montgomery form.
    pub(crate) fn invert(&self, a: u64) -> u64 {
        let (mut base, mut e) = (a, self.p - 2);
        let mut out = self.enter(1);
        while e > 0 {
            if e & 1 == 1 {
                out = self.mul(out, base);
            }
            base = self.mul(base, base);
            e >>= 1;
        }
        out
    }
}

impl Field for Prime {
    type E = u64;
    fn is_zero(&self, a: u64) -> bool {
        a == 0
    }
    fn size(&self, _a: u64) -> f64 {
        1.0
    }
    fn sub_mul(&self, a: u64, m: u64, b: u64) -> u64 {
        self.sub(a, self.mul(m, b))
    }
    fn times(&self, a: u64, b: u64) -> u64 {
        self.mul(a, b)
    }
    fn reciprocal(&self, a: u64) -> u64 {
        self.invert(a)
    }
}

/// Miller–Rabin with the bases that decide every 64-bit number.
fn is_prime(n: u64) -> bool {
    if n < 2 || n.is_multiple_of(2) {
        return n == 2;
    }
    let power = |mut b: u64, mut e: u64| {
        let mut out = 1u64;
        b %= n;
        while e > 0 {
            if e & 1 == 1 {
                out = (u128::from(out) * u128::from(b) % u128::from(n)) as u64;
            }
            b = (u128::from(b) * u128::from(b) % u128::from(n)) as u64;
            e >>= 1;
        }
        out
    };
    let (twos, odd) = (
        (n - 1).trailing_zeros(),
        (n - 1) >> (n - 1).trailing_zeros(),
    );
    [2u64, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37]
        .iter()
        .all(|&a| {
            if n.is_multiple_of(a) {
                return n == a;
            }
            let mut x = power(a, odd);
            if x == 1 || x == n - 1 {
                return true;
            }
            for _ in 1..twos {
                x = (u128::from(x) * u128::from(x) % u128::from(n)) as u64;
                if x == n - 1 {
                    return true;
                }
            }
            false
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_modulo_the_primes() {
        for index in 0..3 {
            let f = Prime::nth(index);
            assert!(f.p < 1 << 57 && f.p.wrapping_mul(f.inverse) == 1);
            let mut s = 12345u64;
            for _ in 0..1000 {
                s = s
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                let (a, b) = (s % f.p, (s >> 7) % f.p);
                let want = (u128::from(a) * u128::from(b) % u128::from(f.p)) as u64;
                assert_eq!(f.mul(f.enter(a), b), want);
                assert_eq!(
                    f.reduce(u128::from(f.enter(a)) * u128::from(b) * 7),
                    (u128::from(want) * 7 % u128::from(f.p)) as u64
                );
                if a != 0 {
                    assert_eq!(f.mul(f.invert(f.enter(a)), a), 1);
                }
            }
            assert_eq!(f.residue(-1), f.p - 1);
        }
    }
}
