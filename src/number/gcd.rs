//! Greatest common divisors of polynomials by images modulo a few primes.
//!
//! The idea (Brown 1971): modulo a prime a gcd takes word operations; scaled to the leading coefficient that the true one
//! divides, its images are joined by the Chinese remainder theorem until they are long enough. How many
//! primes that takes need not be known: a candidate that divides both polynomials is a common divisor, and
//! as its degree is that of an image, which is never less than that of the gcd, it is the greatest.

use super::{Int, Poly, divides};
use std::cmp::Ordering;

/// 2^61 − c is prime for each of these c.
const OFFSETS: [u64; 24] = [
    1, 31, 45, 229, 259, 283, 339, 391, 403, 465, 531, 579, 675, 759, 799, 819, 829, 843, 859, 939,
    985, 1015, 1153, 1195,
];
const MASK: u64 = (1 << 61) - 1;

/// Words of an integer that are summed up before they are reduced.
const CHUNK: usize = 7;

/// The field of the integers modulo 2^61 − c, c < 2^11, with what does not depend on the polynomials.
#[derive(Clone, Copy)]
struct Prime {
    c: u64,
    /// 2^64i.
    powers: [u64; CHUNK + 1],
    /// 1 over the product of the primes before it in the list.
    joins: u64,
}

static PRIMES: [Prime; OFFSETS.len()] = {
    let mut all = [Prime::new(0, 1); OFFSETS.len()];
    let mut i = 0;
    while i < all.len() {
        let c = OFFSETS[i];
        let p = Prime::new(c, 1);
        let (mut product, mut j) = (1, 0);
        while j < i {
            product = p.mul(product, p.reduce(((1 << 61) - OFFSETS[j]) as u128));
            j += 1;
        }
        all[i] = Prime::new(c, p.inverse(product));
        i += 1;
    }
    all
};

impl Prime {
    const fn new(c: u64, joins: u64) -> Prime {
        let mut p = Prime {
            c,
            powers: [1; CHUNK + 1],
            joins,
        };
        let mut i = 1;
        while i <= CHUNK {
            // 2^64 ≡ 8c.
            p.powers[i] = p.mul(p.powers[i - 1], 8 * c);
            i += 1;
        }
        p
    }
    const fn p(self) -> u64 {
        (1 << 61) - self.c
    }
    /// x modulo p: 2^61 ≡ c.
    #[inline]
    const fn reduce(self, x: u128) -> u64 {
        // Less than 2^79, then less than 2^29 + 2^61.
        let y = (x >> 61) * self.c as u128 + (x as u64 & MASK) as u128;
        let z = (y >> 61) as u64 * self.c + (y as u64 & MASK);
        if z >= self.p() { z - self.p() } else { z }
    }
    #[inline]
    const fn mul(self, a: u64, b: u64) -> u64 {
        self.reduce(a as u128 * b as u128)
    }
    fn sub(self, a: u64, b: u64) -> u64 {
        if a >= b { a - b } else { a + self.p() - b }
    }
    /// 1/a for a ≠ 0 (Euclid).
    const fn inverse(self, a: u64) -> u64 {
        let (mut r, mut s) = (self.p(), a);
        // Cofactors of a; their signs alternate.
        let (mut x, mut y, mut minus) = (0u64, 1u64, false);
        while s > 1 {
            let q = r / s;
            (r, s) = (s, r - q * s);
            (x, y) = (y, x + q * y);
            minus = !minus;
        }
        if minus { self.p() - y } else { y }
    }
    fn residue(self, v: &Int) -> u64 {
        // Products of less than 2^125, as many as 128 bits hold together.
        let (mut sum, mut i) = (0u128, 0);
        let (mut total, mut weight) = (0, 1);
        v.for_each_word(|w| {
            sum += u128::from(w) * u128::from(self.powers[i]);
            i += 1;
            if i == CHUNK {
                total =
                    self.reduce(u128::from(self.mul(self.reduce(sum), weight)) + u128::from(total));
                weight = self.mul(weight, self.powers[CHUNK]);
                (sum, i) = (0, 0);
            }
        });
        let last = self.mul(self.reduce(sum), weight);
        let r = self.reduce(u128::from(last) + u128::from(total));
        if v.sign() < 0 && r != 0 {
            self.p() - r
        } else {
            r
        }
    }
    /// The gcd of two polynomials, up to a factor.
    fn gcd(self, mut a: Vec<u64>, mut b: Vec<u64>) -> Vec<u64> {
        loop {
            if a.len() < b.len() {
                std::mem::swap(&mut a, &mut b);
            }
            let Some(&lb) = b.last() else {
                break;
            };
            // a ← lc(b)·a − lc(a)·z^k·b, which needs no inverse.
            while a.len() >= b.len() {
                let (la, k) = (a[a.len() - 1], a.len() - b.len());
                for x in &mut a[..k] {
                    *x = self.mul(*x, lb);
                }
                for (x, y) in a[k..].iter_mut().zip(&b) {
                    *x = self.sub(self.mul(*x, lb), self.mul(la, *y));
                }
                while a.last() == Some(&0) {
                    a.pop();
                }
            }
        }
        a
    }
    /// Multiplied so that the leading coefficient is `lead`.
    fn scale_to(self, a: &mut [u64], lead: u64) {
        if let Some(&l) = a.last() {
            let scale = self.mul(lead, self.inverse(l));
            for x in a {
                *x = self.mul(*x, scale);
            }
        }
    }
}

/// Images joined so far, in mixed radix (Garner): a coefficient is d₀ + d₁·p₀ + d₂·p₀p₁ + …
struct Joined {
    digits: Vec<Vec<u64>>,
    primes: Vec<Prime>,
}

impl Joined {
    fn new(terms: usize) -> Joined {
        Joined {
            digits: vec![Vec::with_capacity(4); terms],
            primes: Vec::with_capacity(4),
        }
    }
    /// Joins one more image; `index` is the place of its prime in the list.
    fn join(&mut self, image: &[u64], index: usize) {
        let prime = PRIMES[index];
        let inverse = if self.primes.len() == index {
            prime.joins
        } else {
            // Some prime was passed over.
            let known = self.primes.iter();
            let product = known.fold(1, |m, q| prime.mul(m, prime.reduce(q.p() as u128)));
            prime.inverse(product)
        };
        for (c, &r) in self.digits.iter_mut().zip(image) {
            let mut value = 0;
            for (d, q) in c.iter().zip(&self.primes).rev() {
                value = prime.reduce(value as u128 * q.p() as u128 + *d as u128);
            }
            c.push(prime.mul(prime.sub(r, value), inverse));
        }
        self.primes.push(prime);
    }
    /// Whether the last digit of every coefficient is what the shortest number near zero has there: 0, or the greatest.
    fn settled(&self) -> bool {
        let Some(last) = self.primes.last() else {
            return false;
        };
        let short = |d: &u64| *d == 0 || *d == last.p() - 1;
        self.primes.len() > 1 && self.digits.iter().all(|c| c.last().is_some_and(short))
    }
    /// The integers of least size that the images are those of, and the bits of the product of the primes.
    fn integers(&self) -> (Vec<Int>, u64) {
        let mut m = [0; OFFSETS.len()];
        m[0] = 1;
        self.primes
            .iter()
            .for_each(|q| times_plus(&mut m, q.p(), 0));
        let value = |c: &Vec<u64>| {
            let mut v = [0; OFFSETS.len()];
            let digits = c.iter().zip(&self.primes).rev();
            digits.for_each(|(d, q)| times_plus(&mut v, q.p(), *d));
            // The other representative.
            let (mut w, mut borrow) = (m, false);
            for (a, b) in w.iter_mut().zip(v) {
                let (x, o) = a.overflowing_sub(b);
                let (y, p) = x.overflowing_sub(u64::from(borrow));
                (*a, borrow) = (y, o | p);
            }
            match v.iter().rev().cmp(w.iter().rev()) {
                Ordering::Greater => Int::from_words(true, &w),
                _ => Int::from_words(false, &v),
            }
        };
        let top = m.iter().rposition(|&w| w != 0).unwrap_or(0);
        let bits = 64 * (top as u64 + 1) - u64::from(m[top].leading_zeros());
        (self.digits.iter().map(value).collect(), bits)
    }
}

/// v·by + plus, of words; there is room for it.
fn times_plus(v: &mut [u64], by: u64, plus: u64) {
    let mut carry = u128::from(plus);
    for w in v {
        carry += u128::from(*w) * u128::from(by);
        *w = carry as u64;
        carry >>= 64;
    }
}

/// Whether d divides p over the integers: a primitive one does if it divides at all (Gauss).
fn divides(d: &Poly, p: &Poly) -> bool {
    divides::divides(d, p).unwrap_or_else(|| divides_long(d, p))
}

/// The same, in integers of any length.
fn divides_long(d: &Poly, p: &Poly) -> bool {
    let (Some(m), Some(n), Some(lead)) = (d.degree(), p.degree(), d.leading()) else {
        return false;
    };
    if n < m {
        return false;
    }
    let low = |p: &Poly| p.coeffs().iter().position(|c| !c.is_zero());
    let (Some(at), Some(from)) = (low(d), low(p)) else {
        return false;
    };
    // The last coefficients that are not zero divide one another too: mostly enough to say no.
    if from < at || !p.coeffs()[from].div_rem_floor(&d.coeffs()[at]).1.is_zero() {
        return false;
    }
    let mut rest = p.coeffs().to_vec();
    for k in (0..=n - m).rev() {
        let (q, r) = rest[k + m].div_rem_floor(lead);
        if !r.is_zero() {
            return false;
        }
        if !q.is_zero() {
            for (x, y) in rest[k..k + m].iter_mut().zip(d.coeffs()) {
                *x -= &q * y;
            }
        }
    }
    rest[..m].iter().all(Int::is_zero)
}

/// The primitive gcd of two polynomials of degree ≥ 1, leading coefficient positive. None where the primes at hand do
/// not suffice. `primitive` says that one of the two is known to be.
pub(super) fn gcd(a: &Poly, b: &Poly, primitive: bool) -> Option<Poly> {
    let (la, lb) = (a.leading()?, b.leading()?);
    let mut lead: Option<Int> = None;
    let mut joined: Option<Joined> = None;
    for (index, prime) in PRIMES.iter().enumerate() {
        let load = |p: &Poly| -> Vec<u64> { p.coeffs().iter().map(|c| prime.residue(c)).collect() };
        let (x, y) = (load(a), load(b));
        if x.last() == Some(&0) || y.last() == Some(&0) {
            continue;
        }
        // Modulo every prime that spares the leading coefficients, the degree is at least the gcd's.
        let mut image = prime.gcd(x, y);
        if image.len() == 1 {
            return Some(Poly::constant(Int::one()));
        }
        let terms = joined.as_ref().map(|j| j.digits.len());
        if terms.is_some_and(|n| image.len() > n) {
            continue;
        }
        if terms != Some(image.len()) {
            // The first image, or those before were of unlucky primes.
            let (small, large) = if a.degree() <= b.degree() {
                (a, b)
            } else {
                (b, a)
            };
            if small.coeffs().len() == image.len() {
                let candidate = small.primitive();
                if divides(&candidate, large) {
                    return Some(candidate);
                }
            }
            joined = Some(Joined::new(image.len()));
        }
        let j = joined.as_mut()?;
        let lead = lead.get_or_insert_with(|| la.gcd(lb).abs());
        prime.scale_to(&mut image, prime.residue(lead));
        j.join(&image, index);
        // Not before the leading coefficient is complete are the others likely to be.
        let bits = 60 * j.primes.len() as u64;
        if lead.bits() >= bits {
            continue;
        }
        let (coeffs, most) = j.integers();
        let full = |c: &Int| c.bits() + 4 >= most;
        if !j.settled() && coeffs.iter().any(full) {
            continue;
        }
        let candidate = Poly::new(coeffs);
        // What divides a primitive polynomial is primitive, so its content need not be looked for.
        if primitive && divides(&candidate, a) && divides(&candidate, b) {
            return Some(candidate);
        }
        let candidate = candidate.primitive();
        if divides(&candidate, a) && divides(&candidate, b) {
            return Some(candidate);
        }
    }
    None
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::poly::subresultant_gcd;
    use super::*;

    /// A polynomial of this degree at most, its coefficients of about so many bits.
    pub(in crate::number) fn stream(seed: &mut u64, degree: usize, bits: u64) -> Poly {
        let mut next = || {
            let mut v = Int::zero();
            for _ in 0..bits.div_ceil(31) {
                *seed = seed
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                v = v.shl(31) + Int::from((*seed >> 33) as i64);
            }
            let v = v.shr(v.bits().saturating_sub(bits));
            if *seed >> 40 & 1 == 0 { v } else { -v }
        };
        Poly::new((0..=degree).map(|_| next()).collect())
    }

    #[test]
    fn the_quick_gcd_is_the_slow_one() {
        let (mut seed, mut found) = (5, 0);
        for round in 0..600usize {
            let bits = [2, 9, 31, 60, 62, 100, 150, 400][round % 8];
            let f = stream(&mut seed, round % 4, bits);
            let [mut p, mut q] = [0, 1].map(|_| stream(&mut seed, 1 + round % 5, bits));
            if round % 3 > 0 {
                (p, q) = (&p * &f, &q * &f);
            }
            if round % 11 == 0 {
                q = &q * &stream(&mut seed, 0, 90);
            }
            if p.degree().is_none_or(|d| d < 1) || q.degree().is_none_or(|d| d < 1) {
                continue;
            }
            let (x, y) = (p.primitive(), q.primitive());
            let want = if x.degree() >= y.degree() {
                subresultant_gcd(x, y)
            } else {
                subresultant_gcd(y, x)
            };
            if let Some(g) = gcd(&p, &q, false) {
                found += 1;
                assert_eq!(g, want, "{p}; {q}");
                if p.content().is_one() || q.content().is_one() {
                    assert_eq!(gcd(&p, &q, true), Some(want));
                }
            }
        }
        // Not merely right: it is the usual way.
        assert!(found > 550, "{found}");
    }

    #[test]
    fn unlucky_primes_mislead_nobody() {
        // Modulo the first prime both are x² − 1, and the second loses a leading coefficient.
        let p = Int::from(PRIMES[0].p());
        let one = Int::one();
        let a = Poly::new(vec![-&one, Int::zero(), one.clone()]);
        let b = Poly::new(vec![&p * &p - &one, p.clone(), one.clone()]);
        assert_eq!(gcd(&a, &b, true), Some(Poly::constant(Int::one())));
        let c = Poly::from_i64(&[5, 7]);
        assert_eq!(gcd(&(&a * &c), &(&b * &c), true), Some(c.clone()));
        let lost = Poly::new(vec![Int::from(5i64), Int::from(PRIMES[1].p())]);
        assert_eq!(gcd(&(&lost * &c), &(&a * &c), true), Some(c));
    }
}
