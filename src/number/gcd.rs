//! Greatest common divisors of polynomials by images modulo a few primes.
//!
//! The idea (Brown 1971): modulo a prime a gcd takes word operations; scaled to the leading coefficient that the true one
//! divides, its images are joined by the Chinese remainder theorem until they are long enough. How many
//! primes that takes need not be known: a candidate that divides both polynomials is a common divisor, and
//! as its degree is that of an image, which is never less than that of the gcd, it is the greatest.

use super::{Int, Poly};

/// 2^61 − c is prime for each of these c.
const PRIMES: [u64; 24] = [
    1, 31, 45, 229, 259, 283, 339, 391, 403, 465, 531, 579, 675, 759, 799, 819, 829, 843, 859, 939,
    985, 1015, 1153, 1195,
];
const MASK: u64 = (1 << 61) - 1;

/// The field of the integers modulo 2^61 − c, c < 2^11.
#[derive(Clone, Copy)]
struct Prime {
    c: u64,
}

impl Prime {
    fn p(self) -> u64 {
        (1 << 61) - self.c
    }
    /// x modulo p, for x < 2^125: 2^61 ≡ c.
    #[inline]
    fn reduce(self, x: u128) -> u64 {
        // Less than 2^75 + 2^61, then less than 2^26 + 2^61.
        let y = (x >> 61) * u128::from(self.c) + (x as u64 & MASK) as u128;
        let z = (y >> 61) as u64 * self.c + (y as u64 & MASK);
        if z >= self.p() { z - self.p() } else { z }
    }
    #[inline]
    fn mul(self, a: u64, b: u64) -> u64 {
        self.reduce(a as u128 * b as u128)
    }
    fn sub(self, a: u64, b: u64) -> u64 {
        if a >= b { a - b } else { a + self.p() - b }
    }
    fn inverse(self, a: u64) -> u64 {
        // Fermat.
        let (mut r, mut b, mut e) = (1, a, self.p() - 2);
        while e > 0 {
            if e & 1 == 1 {
                r = self.mul(r, b);
            }
            b = self.mul(b, b);
            e >>= 1;
        }
        r
    }
    fn residue(self, v: &Int) -> u64 {
        // 2^64 ≡ 8c.
        let (mut acc, mut weight) = (0, 1);
        v.for_each_word(|w| {
            acc = self.reduce(acc as u128 + w as u128 * weight as u128);
            weight = self.mul(weight, 8 * self.c);
        });
        if v.sign() < 0 && acc != 0 {
            self.p() - acc
        } else {
            acc
        }
    }
    /// The gcd of two polynomials, leading coefficient `lead`; `a` and `b` are used up.
    fn gcd(self, mut a: Vec<u64>, mut b: Vec<u64>, lead: u64) -> Vec<u64> {
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
        if let Some(&l) = a.last() {
            let scale = self.mul(lead, self.inverse(l));
            for x in &mut a {
                *x = self.mul(*x, scale);
            }
        }
        a
    }
}

/// What has been joined so far: coefficients modulo m, between −m/2 and m/2.
struct Joined {
    coeffs: Vec<Int>,
    m: Int,
}

impl Joined {
    fn first(image: &[u64], prime: Prime) -> Joined {
        let m = Int::from(prime.p());
        let coeffs = image.iter().map(|&r| balanced(Int::from(r), &m)).collect();
        Joined { coeffs, m }
    }
    /// Joins one more image (Garner). False if nothing was new in it.
    fn join(&mut self, image: &[u64], prime: Prime) -> bool {
        let inverse = prime.inverse(prime.residue(&self.m));
        let mut news = false;
        let all = &self.m * &Int::from(prime.p());
        for (c, &r) in self.coeffs.iter_mut().zip(image) {
            let step = prime.mul(prime.sub(r, prime.residue(c)), inverse);
            if step != 0 {
                news = true;
                *c = balanced(&*c + &self.m * Int::from(step), &all);
            }
        }
        self.m = all;
        news
    }
}

/// c or c − m, whichever is nearer to zero, for −m < c < m.
fn balanced(c: Int, m: &Int) -> Int {
    if c.shl(1) > *m { c - m } else { c }
}

/// Whether the primitive d divides p: if so the quotient is integral (Gauss).
fn divides(d: &Poly, p: &Poly) -> bool {
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
/// not suffice.
pub(super) fn gcd(a: &Poly, b: &Poly) -> Option<Poly> {
    let (la, lb) = (a.leading()?, b.leading()?);
    let mut lead: Option<Int> = None;
    let mut joined: Option<Joined> = None;
    for prime in PRIMES.map(|c| Prime { c }) {
        let load = |p: &Poly| -> Vec<u64> { p.coeffs().iter().map(|c| prime.residue(c)).collect() };
        let (x, y) = (load(a), load(b));
        if x.last() == Some(&0) || y.last() == Some(&0) {
            continue;
        }
        // Modulo every prime that spares the leading coefficients, the degree is at least the gcd's.
        let scale = lead.as_ref().map_or(1, |l| prime.residue(l));
        let mut image = prime.gcd(x, y, scale);
        if image.len() == 1 {
            return Some(Poly::constant(Int::one()));
        }
        if lead.is_none() {
            let l = la.gcd(lb);
            let r = prime.residue(&l);
            for c in &mut image {
                *c = prime.mul(*c, r);
            }
            lead = Some(l);
        }
        let news = match &mut joined {
            Some(j) if image.len() > j.coeffs.len() => continue,
            Some(j) if image.len() == j.coeffs.len() => j.join(&image, prime),
            // Fewer terms: the images before were of unlucky primes.
            _ => {
                joined = Some(Joined::first(&image, prime));
                true
            }
        };
        let Some(j) = &joined else {
            continue;
        };
        // Long coefficients are not complete before the leading one is.
        let complete = lead.as_ref().is_some_and(|l| j.coeffs.last() == Some(l));
        if !complete || (news && j.coeffs.iter().any(|c| c.bits() + 3 >= j.m.bits())) {
            continue;
        }
        let candidate = Poly::new(j.coeffs.clone()).primitive();
        if divides(&candidate, a) && divides(&candidate, b) {
            return Some(candidate);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::poly::subresultant_gcd;
    use super::*;

    fn stream(seed: &mut u64, degree: usize, bits: u64) -> Poly {
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
            if let Some(g) = gcd(&p, &q) {
                found += 1;
                assert_eq!(g, want, "{p}; {q}");
            }
        }
        // Not merely right: it is the usual way.
        assert!(found > 550, "{found}");
    }

    #[test]
    fn unlucky_primes_mislead_nobody() {
        // Modulo the first prime both are x² − 1, and the second loses a leading coefficient.
        let p = Int::from(Prime { c: 1 }.p());
        let one = Int::one();
        let a = Poly::new(vec![-&one, Int::zero(), one.clone()]);
        let b = Poly::new(vec![&p - &one, p.clone(), one.clone()]);
        assert_eq!(gcd(&a, &b), Some(Poly::constant(Int::one())));
        let c = Poly::from_i64(&[5, 7]);
        assert_eq!(gcd(&(&a * &c), &(&b * &c)), Some(c.clone()));
        let lost = Poly::new(vec![Int::from(5i64), Int::from(Prime { c: 31 }.p())]);
        assert_eq!(gcd(&(&lost * &c), &(&a * &c)), Some(c));
    }
}
