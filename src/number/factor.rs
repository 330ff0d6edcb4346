//! Factorisation over the rationals (Zassenhaus).
//!
//! The idea: factor modulo a small prime, lift the factors to a power of the prime above any coefficient that
//! a true factor can have (Hensel, Mignotte), and try which products of the lifted factors divide. Most
//! polynomials are seen to be irreducible before any lifting, because the degrees of their factors
//! modulo a few primes leave no other choice. The number of products tried is exponential in the number of
//! lifted factors in the worst case, which small degrees keep harmless.

use super::modular::{Field, Residues};
use super::{Int, Poly, Rat};

/// The irreducible factors of a primitive square-free polynomial; none for constants.
pub(crate) fn squarefree(p: &Poly) -> Vec<Poly> {
    let mut out = Vec::new();
    let mut p = p.clone();
    if p.degree().is_some_and(|d| d >= 1) && p.coeff(0).is_zero() {
        p = Poly::new(p.coeffs()[1..].to_vec());
        out.push(Poly::from_i64(&[0, 1]));
    }
    match p.degree() {
        None | Some(0) => {}
        Some(1) => out.push(p.primitive()),
        Some(2) => quadratic(p, &mut out),
        Some(_) => zassenhaus(p, &mut out),
    }
    out
}

fn quadratic(p: Poly, out: &mut Vec<Poly>) {
    let (c, b, a) = (p.coeff(0), p.coeff(1), p.coeff(2));
    let Some(s) = (&b * &b - Int::from(4i64) * &a * &c).sqrt_exact() else {
        out.push(p.primitive());
        return;
    };
    let two_a = &a + &a;
    for num in [&s - &b, -&s - &b] {
        let r = Rat::new(num, two_a.clone());
        out.push(Poly::new(vec![-r.numer(), r.denom().clone()]));
    }
}

/// Trial primes: odd, in ascending order.
fn primes() -> impl Iterator<Item = u64> {
    (3..1u64 << 30).step_by(2).filter(|&n| {
        (3..)
            .step_by(2)
            .take_while(|d| d * d <= n)
            .all(|d| n % d != 0)
    })
}

/// The set of sums of the degrees, as bits; exact for degrees below 128.
fn degree_sums(degrees: impl Iterator<Item = usize>) -> u128 {
    degrees.fold(1, |set, d| set | set << d)
}

/// A prime, the distinct-degree factorisation modulo it, and the number of irreducible factors.
type Trial = (u64, Vec<(Residues, usize)>, usize);

fn zassenhaus(p: Poly, out: &mut Vec<Poly>) {
    const TRIALS: usize = 6;
    let n = p.coeffs().len() - 1;
    let mut allowed = u128::MAX;
    let mut best: Option<Trial> = None;
    let mut good = 0;
    // The degree of the factors of a square-free polynomial drops or doubles up only at the finitely many
    // primes that divide its leading coefficient or discriminant.
    for prime in primes() {
        let field = Field { p: prime };
        let f = field.reduce(&p);
        if f.len() != n + 1 || field.gcd(&f, &field.derivative(&f)).len() != 1 {
            continue;
        }
        let parts = field.distinct_degrees(&field.monic(f));
        let degrees = parts
            .iter()
            .flat_map(|(g, d)| std::iter::repeat_n(*d, (g.len() - 1) / d));
        let count = degrees.clone().count();
        if n < 128 {
            allowed &= degree_sums(degrees);
            if allowed == 1 | 1 << n {
                out.push(p);
                return;
            }
        } else if count == 1 {
            out.push(p);
            return;
        }
        if best.as_ref().is_none_or(|b| count < b.2) {
            best = Some((prime, parts, count));
        }
        good += 1;
        if good == TRIALS {
            break;
        }
    }
    let Some((prime, parts, _)) = best else {
        // No prime below 2^30 is good: no polynomial that fits a memory is like that.
        out.push(p);
        return;
    };
    let field = Field { p: prime };
    let factors: Vec<Residues> = parts
        .into_iter()
        .flat_map(|(g, d)| field.equal_degree(g, d))
        .collect();
    let (lifted, modulus) = lift(&p, factors, field);
    recombine(p, lifted, &modulus, allowed, out);
}

// Polynomials modulo an integer: coefficients in [0, m), constant first, no zeros at the end.
type Mods = Vec<Int>;

fn reduce(v: Vec<Int>, m: &Int) -> Mods {
    let mut v: Mods = v.into_iter().map(|c| c.div_rem_floor(m).1).collect();
    while v.last().is_some_and(Int::is_zero) {
        v.pop();
    }
    v
}
fn mul(a: &[Int], b: &[Int], m: &Int) -> Mods {
    let (a, b) = (Poly::new(a.to_vec()), Poly::new(b.to_vec()));
    reduce((a * b).coeffs().to_vec(), m)
}
fn add(a: &[Int], b: &[Int], m: &Int) -> Mods {
    reduce(
        (Poly::new(a.to_vec()) + Poly::new(b.to_vec()))
            .coeffs()
            .to_vec(),
        m,
    )
}
fn sub(a: &[Int], b: &[Int], m: &Int) -> Mods {
    reduce(
        (Poly::new(a.to_vec()) - Poly::new(b.to_vec()))
            .coeffs()
            .to_vec(),
        m,
    )
}
/// Quotient and remainder by a monic polynomial.
fn div_rem(a: &[Int], b: &[Int], m: &Int) -> (Mods, Mods) {
    if a.len() < b.len() {
        return (Vec::new(), a.to_vec());
    }
    let mut r = a.to_vec();
    let mut q = vec![Int::zero(); a.len() - b.len() + 1];
    for k in (0..q.len()).rev() {
        let c = r[k + b.len() - 1].div_rem_floor(m).1;
        for (i, y) in b.iter().enumerate() {
            r[k + i] -= &c * y;
        }
        q[k] = c;
    }
    (reduce(q, m), reduce(r, m))
}
fn lift_residues(r: &[u64]) -> Mods {
    r.iter().map(|&c| Int::from(c)).collect()
}

/// Hensel: monic factors modulo p become monic factors modulo the returned power of p, which exceeds
/// twice lc(f) times any coefficient of any factor of f.
fn lift(f: &Poly, factors: Vec<Residues>, field: Field) -> (Vec<Mods>, Int) {
    let n = f.coeffs().len() as u64;
    let widest = f.coeffs().iter().map(Int::bits).max().unwrap_or(0);
    let lead = f.coeff(f.coeffs().len() - 1);
    // Mignotte: a factor's coefficients are at most 2^n·‖f‖₂ ≤ 2^n·√(n+1)·max|c|.
    let bits = 2 * n + widest + lead.bits() + 2;
    let mut modulus = Int::from(field.p);
    while modulus.bits() <= bits {
        modulus = &modulus * &modulus;
    }
    let mut out = Vec::new();
    let mut rest = reduce(f.coeffs().to_vec(), &modulus);
    let last = factors.len() - 1;
    for (i, h) in factors.iter().enumerate() {
        if i == last {
            // Monic: the leading coefficient is a unit modulo p.
            let inv = inverse(&lead, &modulus, field);
            out.push(mul(&rest, &[inv], &modulus));
            break;
        }
        // rest = g·h with h monic and g carrying the leading coefficient.
        let g = factors[i + 1..]
            .iter()
            .fold(vec![lead.mod_u64(field.p)], |acc, x| field.mul(&acc, x));
        let (s, t) = field.bezout(&g, h);
        let (mut g, mut h) = (lift_residues(&g), lift_residues(h));
        let (mut s, mut t) = (lift_residues(&s), lift_residues(&t));
        let mut m = Int::from(field.p);
        // Quadratic lifting (von zur Gathen & Gerhard, Modern Computer Algebra, algorithm 15.10).
        while m < modulus {
            m = &m * &m;
            let e = sub(&rest, &mul(&g, &h, &m), &m);
            let (q, r) = div_rem(&mul(&s, &e, &m), &h, &m);
            let g2 = add(&g, &add(&mul(&t, &e, &m), &mul(&q, &g, &m), &m), &m);
            let h2 = add(&h, &r, &m);
            let b = sub(
                &add(&mul(&s, &g2, &m), &mul(&t, &h2, &m), &m),
                &[Int::one()],
                &m,
            );
            let (c, d) = div_rem(&mul(&s, &b, &m), &h2, &m);
            let t2 = sub(&t, &add(&mul(&t, &b, &m), &mul(&c, &g2, &m), &m), &m);
            s = sub(&s, &d, &m);
            t = t2;
            g = g2;
            h = h2;
        }
        out.push(h);
        rest = g;
    }
    (out, modulus)
}

/// 1/a modulo a power of the prime (Newton).
fn inverse(a: &Int, modulus: &Int, field: Field) -> Int {
    let mut x = Int::from(field.inverse(a.mod_u64(field.p)));
    let mut m = Int::from(field.p);
    while &m < modulus {
        m = &m * &m;
        x = (&x * (Int::from(2i64) - a * &x)).div_rem_floor(&m).1;
    }
    x
}

/// The representative of least size.
fn symmetric(c: Int, m: &Int) -> Int {
    let c = c.div_rem_floor(m).1;
    if c.shl(1) > *m { c - m } else { c }
}

fn recombine(mut f: Poly, mut parts: Vec<Mods>, m: &Int, allowed: u128, out: &mut Vec<Poly>) {
    let mut size = 1;
    while 2 * size <= parts.len() {
        let mut pick: Vec<usize> = (0..size).collect();
        let found = loop {
            if let Some(g) = try_product(&f, &parts, &pick, m, allowed) {
                break Some(g);
            }
            if !next_choice(&mut pick, parts.len()) {
                break None;
            }
        };
        match found {
            Some((g, rest)) => {
                out.push(g);
                f = rest;
                for &i in pick.iter().rev() {
                    parts.swap_remove(i);
                }
            }
            None => size += 1,
        }
    }
    if f.degree().is_some_and(|d| d >= 1) {
        out.push(f);
    }
}

/// The next choice of as many indices below n, in lexicographic order; false at the end.
fn next_choice(pick: &mut [usize], n: usize) -> bool {
    let k = pick.len();
    let Some(i) = (0..k).rev().find(|&i| pick[i] < n - k + i) else {
        return false;
    };
    pick[i] += 1;
    for j in i + 1..k {
        pick[j] = pick[j - 1] + 1;
    }
    true
}

/// The true factor that a choice of lifted factors stands for, and its cofactor.
fn try_product(
    f: &Poly,
    parts: &[Mods],
    pick: &[usize],
    m: &Int,
    allowed: u128,
) -> Option<(Poly, Poly)> {
    let degree: usize = pick.iter().map(|&i| parts[i].len() - 1).sum();
    if degree < 128 && allowed >> degree & 1 == 0 {
        return None;
    }
    let lead = f.leading()?;
    // The constant term first: it divides lc·f(0), and that fails for nearly every wrong choice.
    let constant = pick
        .iter()
        .fold(lead.clone(), |acc, &i| symmetric(acc * &parts[i][0], m));
    if constant.is_zero() || !(lead * f.coeff(0)).div_rem_floor(&constant).1.is_zero() {
        return None;
    }
    let product = pick
        .iter()
        .fold(vec![lead.clone()], |acc, &i| mul(&acc, &parts[i], m));
    let g = Poly::new(product.into_iter().map(|c| symmetric(c, m)).collect()).primitive();
    let rest = f.div_exact(&g)?.primitive();
    Some((g, rest))
}
