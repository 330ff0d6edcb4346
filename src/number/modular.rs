//! Polynomials modulo a prime: cheap proofs of what does *not* happen.
//!
//! The idea: a common factor over the integers survives reduction modulo any prime that spares a leading
//! coefficient. So if two polynomials are coprime modulo one prime they are coprime, and a few word
//! operations have replaced a long exact computation. The same arithmetic serves the factorisation.

use super::{Int, Poly};

/// The Mersenne prime 2^61 − 1: reduction is a shift and an addition.
const P: u64 = (1 << 61) - 1;

#[inline]
fn reduce(x: u128) -> u64 {
    // x < 2^122, so one fold leaves less than 2^62.
    let y = (x as u64 & P) + (x >> 61) as u64;
    if y >= P { y - P } else { y }
}
#[inline]
fn mul(a: u64, b: u64) -> u64 {
    reduce(a as u128 * b as u128)
}
/// The non-negative remainder of an integer modulo 2^61 − 1.
fn residue(v: &Int) -> u64 {
    // 2^64 ≡ 8: the words, least significant first, weigh 1, 8, 64, …
    let (mut acc, mut weight) = (0u64, 1u64);
    v.for_each_word(|w| {
        let r = (w & P) + (w >> 61);
        let r = if r >= P { r - P } else { r };
        acc = reduce(acc as u128 + r as u128 * weight as u128);
        weight = mul(weight, 8);
    });
    if v.sign() < 0 && acc != 0 {
        P - acc
    } else {
        acc
    }
}

/// The degree of the gcd modulo 2^61 − 1: an upper bound of the degree of the true gcd. None where both
/// leading coefficients vanish modulo that prime, or a polynomial is zero.
pub(crate) fn gcd_degree_bound(a: &Poly, b: &Poly) -> Option<usize> {
    const INLINE: usize = 20;
    let n = a.coeffs().len().max(b.coeffs().len());
    if n <= INLINE {
        let (mut x, mut y) = ([0u64; INLINE], [0u64; INLINE]);
        gcd_degree(a, b, &mut x, &mut y)
    } else {
        gcd_degree(a, b, &mut vec![0; n], &mut vec![0; n])
    }
}

fn gcd_degree<'a>(a: &Poly, b: &Poly, mut x: &'a mut [u64], mut y: &'a mut [u64]) -> Option<usize> {
    let load = |p: &Poly, to: &mut [u64]| {
        for (t, c) in to.iter_mut().zip(p.coeffs()) {
            *t = residue(c);
        }
        p.coeffs().len()
    };
    let (mut nx, mut ny) = (load(a, x), load(b, y));
    if nx == 0 || ny == 0 || (x[nx - 1] == 0 && y[ny - 1] == 0) {
        return None;
    }
    let trim = |v: &[u64], mut n: usize| {
        while n > 0 && v[n - 1] == 0 {
            n -= 1;
        }
        n
    };
    nx = trim(x, nx);
    ny = trim(y, ny);
    loop {
        if nx < ny {
            std::mem::swap(&mut x, &mut y);
            std::mem::swap(&mut nx, &mut ny);
        }
        match ny {
            0 => return Some(nx.saturating_sub(1)),
            1 => return Some(0),
            _ => {}
        }
        // x ← lc(y)·x − lc(x)·z^k·y, which needs no inverse.
        while nx >= ny {
            let (lx, ly, k) = (x[nx - 1], P - y[ny - 1], nx - ny);
            // −lc(y)·x + lc(x)·y: the sign is irrelevant.
            for c in &mut x[..k] {
                *c = mul(*c, ly);
            }
            for i in 0..ny {
                let s = mul(x[k + i], ly) + mul(lx, y[i]);
                x[k + i] = if s >= P { s - P } else { s };
            }
            nx = trim(x, nx);
        }
    }
}

/// A polynomial modulo a prime below 2^31, constant first, no zeros at the end.
pub(crate) type Residues = Vec<u64>;

/// Arithmetic of polynomials modulo an odd prime below 2^31.
#[derive(Clone, Copy)]
pub(crate) struct Field {
    pub(crate) p: u64,
}

impl Field {
    pub(crate) fn reduce(&self, f: &Poly) -> Residues {
        let mut r = f.coeffs().iter().map(|c| c.mod_u64(self.p)).collect();
        trim(&mut r);
        r
    }
    fn pow(&self, mut b: u64, mut e: u64) -> u64 {
        let mut r = 1;
        while e > 0 {
            if e & 1 == 1 {
                r = r * b % self.p;
            }
            b = b * b % self.p;
            e >>= 1;
        }
        r
    }
    pub(crate) fn inverse(&self, a: u64) -> u64 {
        self.pow(a, self.p - 2)
    }
    pub(crate) fn monic(&self, mut f: Residues) -> Residues {
        if let Some(&l) = f.last() {
            let i = self.inverse(l);
            for c in &mut f {
                *c = *c * i % self.p;
            }
        }
        f
    }
    pub(crate) fn sub(&self, a: &[u64], b: &[u64]) -> Residues {
        let n = a.len().max(b.len());
        let at = |v: &[u64], i: usize| v.get(i).copied().unwrap_or(0);
        let mut r = (0..n)
            .map(|i| (at(a, i) + self.p - at(b, i)) % self.p)
            .collect();
        trim(&mut r);
        r
    }
    pub(crate) fn mul(&self, a: &[u64], b: &[u64]) -> Residues {
        if a.is_empty() || b.is_empty() {
            return Vec::new();
        }
        let mut r = vec![0; a.len() + b.len() - 1];
        for (i, x) in a.iter().enumerate() {
            for (j, y) in b.iter().enumerate() {
                r[i + j] = (r[i + j] + x * y) % self.p;
            }
        }
        r
    }
    /// Quotient and remainder; `b` not zero.
    pub(crate) fn div_rem(&self, a: &[u64], b: &[u64]) -> (Residues, Residues) {
        let mut r = a.to_vec();
        let Some(&l) = b.last() else {
            return (Vec::new(), r);
        };
        if a.len() < b.len() {
            return (Vec::new(), r);
        }
        let inv = self.inverse(l);
        let mut q = vec![0; a.len() - b.len() + 1];
        for k in (0..q.len()).rev() {
            let c = r[k + b.len() - 1] * inv % self.p;
            q[k] = c;
            for (i, y) in b.iter().enumerate() {
                r[k + i] = (r[k + i] + (self.p - c) * y) % self.p;
            }
        }
        trim(&mut r);
        trim(&mut q);
        (q, r)
    }
    fn rem(&self, a: &[u64], b: &[u64]) -> Residues {
        self.div_rem(a, b).1
    }
    pub(crate) fn gcd(&self, a: &[u64], b: &[u64]) -> Residues {
        let (mut a, mut b) = (a.to_vec(), b.to_vec());
        while !b.is_empty() {
            let r = self.rem(&a, &b);
            a = b;
            b = r;
        }
        self.monic(a)
    }
    /// (s, t) with s·a + t·b = 1 for coprime a and b, deg s < deg b, deg t < deg a.
    pub(crate) fn bezout(&self, a: &[u64], b: &[u64]) -> (Residues, Residues) {
        let (mut r0, mut r1) = (a.to_vec(), b.to_vec());
        let (mut s0, mut s1, mut t0, mut t1) = (vec![1], vec![], vec![], vec![1]);
        while !r1.is_empty() {
            let (q, r) = self.div_rem(&r0, &r1);
            let s = self.sub(&s0, &self.mul(&q, &s1));
            let t = self.sub(&t0, &self.mul(&q, &t1));
            (r0, r1, s0, s1, t0, t1) = (r1, r, s1, s, t1, t);
        }
        let i = self.inverse(r0.last().copied().unwrap_or(1));
        let scale = |v: Vec<u64>| v.into_iter().map(|c| c * i % self.p).collect();
        (scale(s0), scale(t0))
    }
    pub(crate) fn derivative(&self, f: &[u64]) -> Residues {
        let mut r = f
            .iter()
            .enumerate()
            .skip(1)
            .map(|(i, c)| i as u64 % self.p * c % self.p)
            .collect();
        trim(&mut r);
        r
    }
    fn mul_mod(&self, a: &[u64], b: &[u64], m: &[u64]) -> Residues {
        let mut r = self.mul(a, b);
        trim(&mut r);
        self.rem(&r, m)
    }
    fn pow_mod(&self, b: &[u64], mut e: u64, m: &[u64]) -> Residues {
        let (mut b, mut r) = (self.rem(b, m), self.rem(&[1], m));
        while e > 0 {
            if e & 1 == 1 {
                r = self.mul_mod(&r, &b, m);
            }
            b = self.mul_mod(&b, &b, m);
            e >>= 1;
        }
        r
    }
    /// Distinct-degree factorisation of a monic square-free polynomial: (product of all irreducible
    /// factors of degree d, d).
    pub(crate) fn distinct_degrees(&self, f: &[u64]) -> Vec<(Residues, usize)> {
        let (mut f, mut out, mut d) = (f.to_vec(), Vec::new(), 0);
        let mut h: Residues = vec![0, 1];
        while f.len() > 2 * (d + 1) {
            d += 1;
            h = self.pow_mod(&h, self.p, &f);
            let g = self.gcd(&self.sub(&h, &[0, 1]), &f);
            if g.len() > 1 {
                f = self.div_rem(&f, &g).0;
                h = self.rem(&h, &f);
                out.push((g, d));
            }
        }
        if f.len() > 1 {
            let d = f.len() - 1;
            out.push((f, d));
        }
        out
    }
    /// Cantor–Zassenhaus: splits a monic product of irreducible factors of degree d. The random choices
    /// come from a fixed seed, so that a run can be repeated.
    pub(crate) fn equal_degree(&self, f: Residues, d: usize) -> Vec<Residues> {
        let (mut todo, mut out, mut seed) = (vec![f], Vec::new(), 0x9e37_79b9_7f4a_7c15u64);
        while let Some(g) = todo.pop() {
            let n = g.len() - 1;
            if n == d {
                out.push(g);
                continue;
            }
            let mut a: Residues = (0..n)
                .map(|_| {
                    seed = seed
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1_442_695_040_888_963_407);
                    (seed >> 33) % self.p
                })
                .collect();
            trim(&mut a);
            // a^((p^d − 1)/2) through the norm a^(1 + p + … + p^(d−1)).
            let mut norm = a.clone();
            let mut b = a;
            for _ in 1..d {
                b = self.pow_mod(&b, self.p, &g);
                norm = self.mul_mod(&norm, &b, &g);
            }
            let b = self.pow_mod(&norm, (self.p - 1) / 2, &g);
            let h = self.gcd(&self.sub(&b, &[1]), &g);
            if h.len() > 1 && h.len() < g.len() {
                todo.push(self.monic(self.div_rem(&g, &h).0));
                todo.push(h);
            } else {
                todo.push(g);
            }
        }
        out
    }
}

pub(crate) fn trim(v: &mut Vec<u64>) {
    while v.last() == Some(&0) {
        v.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_is_one() {
        let common = Poly::from_i64(&[3, -1, 4, 1]);
        let (a, b) = (
            Poly::from_i64(&[1, 5, -9, 2]),
            Poly::from_i64(&[-6, 5, 3, 5]),
        );
        assert_eq!(gcd_degree_bound(&a, &b), Some(0));
        assert_eq!(gcd_degree_bound(&(&a * &common), &(&b * &common)), Some(3));
        assert_eq!(gcd_degree_bound(&common, &(&b * &common)), Some(3));
        assert_eq!(gcd_degree_bound(&Poly::zero(), &a), None);
        // A leading coefficient that the prime divides.
        let p = Int::from(P);
        let vanishing = Poly::new(vec![Int::one(), p.clone()]);
        assert_eq!(
            gcd_degree_bound(&vanishing, &Poly::new(vec![Int::from(2i64), p])),
            None
        );
        assert_eq!(gcd_degree_bound(&vanishing, &a), Some(0));
        // More coefficients than the inline buffer holds.
        let long = (0..5).fold(common.clone(), |acc, _| &acc * &acc.derivative() + &a);
        assert_eq!(gcd_degree_bound(&(&long * &common), &common), Some(3));
    }

    #[test]
    fn residues_of_all_sizes() {
        let p = i128::from(P);
        for v in [
            0,
            1,
            -1,
            p,
            -p,
            p + 1,
            i128::MAX,
            i128::MIN,
            1 << 64,
            -(1 << 100) + 17,
        ] {
            assert_eq!(i128::from(residue(&Int::from(v))), v.rem_euclid(p), "{v}");
            let big = Int::from(v) * Int::from(v) * Int::from(v);
            assert_eq!(residue(&big), big.mod_u64(P), "{v}³");
        }
    }
}
