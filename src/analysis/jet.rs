//! Truncated power series with enclosed coefficients: derivatives and integrals without formulas.
//!
//! A [`Jet`] of length n stands for a function of one variable by its Taylor coefficients of
//! order 0 to n − 1 at a point or, with an interval for the variable, for all points of it at
//! once. Each operation computes the coefficients of its result from those of its operands, so
//! a formula written once yields values (n = 1), slopes (n = 2) and, for integrals, the high
//! orders with a certified remainder.

use super::fix::{Bits, Fix};
use crate::number::Rat;

/// Taylor coefficients, order 0 first; at least one.
#[derive(Clone, Debug)]
pub(super) struct Jet {
    c: Vec<Fix>,
    b: Bits,
}

impl Jet {
    /// A constant.
    pub(super) fn constant(x: Fix, n: usize, b: Bits) -> Jet {
        let mut c = vec![b.int(0); n.max(1)];
        c[0] = x;
        Jet { c, b }
    }
    /// A variable that moves at a pace.
    pub(super) fn moving(x: Fix, pace: Fix, n: usize, b: Bits) -> Jet {
        let mut j = Jet::constant(x, n, b);
        if n > 1 {
            j.c[1] = pace;
        }
        j
    }
    /// The coefficient of an order; zero past the last one.
    pub(super) fn order(&self, k: usize) -> Fix {
        self.c.get(k).cloned().unwrap_or_else(|| self.b.int(0))
    }
    pub(super) fn len(&self) -> usize {
        self.c.len()
    }
    fn zip(&self, o: &Jet, f: impl Fn(&Fix, &Fix) -> Fix) -> Jet {
        let c = self.c.iter().zip(&o.c).map(|(x, y)| f(x, y)).collect();
        Jet { c, b: self.b }
    }
    pub(super) fn add(&self, o: &Jet) -> Jet {
        self.zip(o, Fix::add)
    }
    pub(super) fn sub(&self, o: &Jet) -> Jet {
        self.zip(o, Fix::sub)
    }
    pub(super) fn scale(&self, k: &Fix) -> Jet {
        Jet {
            c: self.c.iter().map(|x| x.mul(k)).collect(),
            b: self.b,
        }
    }
    pub(super) fn neg(&self) -> Jet {
        Jet {
            c: self.c.iter().map(Fix::neg).collect(),
            b: self.b,
        }
    }
    pub(super) fn mul(&self, o: &Jet) -> Jet {
        let c = (0..self.len())
            .map(|k| {
                let terms = (0..=k).map(|j| self.c[j].mul(&o.c[k - j]));
                terms.fold(self.b.int(0), |s, t| s.add(&t))
            })
            .collect();
        Jet { c, b: self.b }
    }
    /// The quotient; None where the divisor may vanish.
    pub(super) fn div(&self, o: &Jet) -> Option<Jet> {
        let mut c: Vec<Fix> = Vec::with_capacity(self.len());
        for k in 0..self.len() {
            let less = (0..k).fold(self.b.int(0), |s, j| s.add(&c[j].mul(&o.c[k - j])));
            c.push(self.c[k].sub(&less).div(&o.c[0])?);
        }
        Some(Jet { c, b: self.b })
    }
    /// The arctangent: its slope is u′/(1 + u²).
    pub(super) fn atan(&self) -> Option<Jet> {
        let one = Jet::constant(self.b.int(1), self.len(), self.b);
        let rate = one.div(&one.add(&self.mul(self)))?;
        let mut c = vec![self.c[0].atan()];
        for k in 1..self.len() {
            let sum = (1..=k).fold(self.b.int(0), |s, j| {
                let j_u = self.c[j].mul(&self.b.int(j as i64));
                s.add(&j_u.mul(&rate.c[k - j]))
            });
            c.push(sum.mul(&self.b.rat(&Rat::frac(1, k as i64))));
        }
        Some(Jet { c, b: self.b })
    }
    /// The derivative, one order shorter (but never empty).
    pub(super) fn derivative(&self) -> Jet {
        let by = |(k, x): (usize, &Fix)| x.mul(&self.b.int(k as i64));
        let mut c: Vec<Fix> = self.c.iter().enumerate().skip(1).map(by).collect();
        if c.is_empty() {
            c.push(self.b.int(0));
        }
        Jet { c, b: self.b }
    }
    /// The first n orders.
    pub(super) fn cut(mut self, n: usize) -> Jet {
        self.c.truncate(n.max(1));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// arctan and a quotient against their known series at 0.
    #[test]
    fn series_have_the_known_coefficients() {
        let b = Bits(80);
        let x = Jet::moving(b.int(0), b.int(1), 6, b);
        let a = x.atan().expect("defined");
        for (k, want) in [(1, (1, 1)), (3, (-1, 3)), (5, (1, 5)), (2, (0, 1))] {
            let want = b.rat(&Rat::frac(want.0, want.1));
            assert!(
                a.order(k).sub(&want).abs().hi() < Rat::from(2).pow(60).recip(),
                "{k}"
            );
        }
        let one = Jet::constant(b.int(1), 6, b);
        let geometric = one.div(&one.sub(&x)).expect("defined");
        assert!((0..6).all(|k| geometric.order(k) == b.int(1)));
        let slope = geometric.derivative();
        assert_eq!((slope.len(), slope.order(2)), (5, b.int(3)));
    }
}
