//! Numbers that come out of others: num(x)/den(x) at a root x, and the roots of polynomials with such a coefficient.
//!
//! The idea: the polynomial of such a number is a resultant. Over the rationals that is read off at as many
//! points as its degree asks for and interpolated; an enclosure then tells which of its roots is meant.

use super::super::refine::{Cell, Refiner};
use super::super::root::{Root, grid, scale_of, value_on_cell};
use super::super::{Int, Interval, Poly, Rat};
use super::{Algebraic, Quotient};
use std::cmp::Ordering;

impl Quotient {
    pub(super) fn resolve(&self) -> Algebraic {
        let Quotient { root, num, den, .. } = self;
        // Conjugates at which the denominator vanishes are none of ours.
        let g = root.poly.gcd(den);
        let p = match g.degree() {
            Some(0) => None,
            _ => root.poly.div_exact(&g).map(|p| p.primitive()),
        };
        let p = p.as_ref().unwrap_or(&root.poly);
        let resultant = quotient_polynomial(p, num, den);
        let x = root.enclosure();
        let rough = Poly::quotient_over(num, den, x);
        let mut bits = grid(x, 64);
        let mut refiner = root.refine();
        pick(&resultant, rough, || {
            quotient_enclosure(&mut refiner, num, den, &mut bits)
        })
    }
}

impl Quotient {
    /// Two quotients at one root: a/b − c/d has the sign of (ad − bc)·bd.
    pub(super) fn cmp_same(&self, o: &Quotient) -> Ordering {
        let excess = &self.num * &o.den - &o.num * &self.den;
        (self.root.sign_of(&excess) * self.den_sign * o.den_sign).cmp(&0)
    }
}
/// A number between rational ends that close in on it.
pub(super) enum Narrowing<'a> {
    Known(&'a Rat),
    Root(Refiner<'a>),
    Quotient(Refiner<'a>, &'a Quotient),
}

impl Narrowing<'_> {
    /// Ends lo ≤ number ≤ hi, about 2^-bits apart.
    pub(super) fn at(&mut self, bits: u64) -> (Rat, Rat) {
        match self {
            Narrowing::Known(r) => (r.clone(), r.clone()),
            Narrowing::Root(r) => ends(r.cell(bits), bits),
            Narrowing::Quotient(r, q) => quotient_enclosure(r, &q.num, &q.den, &mut bits.clone()),
        }
    }
}

/// Rational ends around num/den, narrower with every call.
fn quotient_enclosure(
    refiner: &mut Refiner<'_>,
    num: &Poly,
    den: &Poly,
    bits: &mut u64,
) -> (Rat, Rat) {
    loop {
        let b = *bits;
        *bits = 2 * b + 32;
        let k = match refiner.cell(b) {
            Cell::Exact(r) => {
                let v = num.eval(&r) / den.eval(&r);
                return (v.clone(), v);
            }
            Cell::Between(k) => k,
        };
        let ((n, n_err), (d, d_err)) = (value_on_cell(num, &k, b), value_on_cell(den, &k, b));
        // num/den is the quotient of these times 2^shift.
        let shift = scale_of(den, b) - scale_of(num, b);
        let (n, d) = if d.sign() < 0 { (-n, -d) } else { (n, d) };
        let (d_low, d_high) = (&d - &d_err, &d + &d_err);
        if d_low.sign() <= 0 {
            continue;
        }
        let (n_low, n_high) = (&n - &n_err, n + n_err);
        let over = |n: &Int, d: &Int, up: bool| {
            let e = b as i64 + shift;
            let q = if e >= 0 {
                n.shl(e as u64).div_rem_floor(d).0
            } else {
                n.div_rem_floor(&d.shl(e.unsigned_abs())).0
            };
            Rat::dyadic(if up { q + Int::one() } else { q }, -(b as i64))
        };
        let d_of = |away_from_zero: bool| if away_from_zero { &d_low } else { &d_high };
        return (
            over(&n_low, d_of(n_low.sign() < 0), false),
            over(&n_high, d_of(n_high.sign() > 0), true),
        );
    }
}

/// R(y) = Res_x(p(x), y·den(x) − num(x)) up to a constant: its roots are num/den at the roots of p. `den` must
/// not vanish at any of them, so that the degree is that of p. Read off at as many points as it takes.
fn quotient_polynomial(p: &Poly, num: &Poly, den: &Poly) -> Poly {
    let n = p.coeffs().len() - 1;
    let formal = num.coeffs().len().max(den.coeffs().len()) - 1;
    let lead = p.coeff(n);
    let values = (0..=n as i64).map(|y| {
        let q = den.scale(&Int::from(y)) - num;
        let missing = q.degree().map_or(0, |d| formal - d);
        p.resultant(&q) * lead.pow(missing as u32)
    });
    interpolate(values.collect())
}

/// n! times the polynomial that takes the given values at 0, 1, …, n (Newton's forward differences).
fn interpolate(mut d: Vec<Int>) -> Poly {
    let n = d.len() - 1;
    for level in 1..=n {
        for i in (level..=n).rev() {
            let t = &d[i] - &d[i - 1];
            d[i] = t;
        }
    }
    // Σ d_i/i!·x(x−1)…(x−i+1), by Horner: the weights n!/i! keep it integral.
    let mut weight = Int::one();
    let mut c: Vec<Int> = Vec::new();
    for i in (0..=n).rev() {
        let x = Int::from(i as i64);
        c.insert(0, Int::zero());
        for j in 0..c.len() - 1 {
            let t = &c[j + 1] * &x;
            c[j] -= t;
        }
        c[0] += &d[i] * &weight;
        weight *= x;
    }
    Poly::new(c)
}

/// den^n·p(num/den).
pub(super) fn homogenise(p: &Poly, num: &Poly, den: &Poly) -> Poly {
    let Some(n) = p.degree() else {
        return Poly::zero();
    };
    let mut weight = Poly::constant(Int::one());
    let mut acc = Poly::constant(p.coeff(n));
    for i in (0..n).rev() {
        weight *= den;
        acc = acc * num + weight.scale(&p.coeff(i));
    }
    acc
}

/// Doubles around two rationals.
pub(super) fn outer(lo: &Rat, hi: &Rat) -> Interval {
    Interval {
        lo: lo.interval().lo,
        hi: hi.interval().hi,
    }
}

/// The one root of `p` that stays in ever smaller enclosures, the first of them given in doubles.
pub(super) fn pick(
    p: &Poly,
    rough: Interval,
    mut enclose: impl FnMut() -> (Rat, Rat),
) -> Algebraic {
    let p = p.squarefree();
    // Mostly the first enclosure isolates already, and no other root is ever looked at.
    if p.degree().is_some_and(|d| d >= 3)
        && let Some(root) = Root::adopt(&p, rough)
    {
        return root.into();
    }
    let mut roots = p.real_roots();
    roots.retain(|r| r.interval().meets(&rough));
    while roots.len() > 1 {
        let (lo, hi) = enclose();
        roots.retain(|r| r.cmp_rat(&lo).is_ge() && r.cmp_rat(&hi).is_le());
    }
    // The number itself is a root of `p`, and lies in every enclosure: it was never dropped, whatever the input.
    roots.pop().expect("no root lies in the enclosure")
}

pub(super) fn ends(cell: Cell, bits: u64) -> (Rat, Rat) {
    match cell {
        Cell::Exact(r) => (r.clone(), r),
        Cell::Between(k) => {
            let e = -(bits as i64);
            let next = Rat::dyadic(&k + Int::one(), e);
            (Rat::dyadic(k, e), next)
        }
    }
}
