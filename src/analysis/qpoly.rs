//! Polynomials with rational coefficients, where the scale matters: values, not only signs.

use super::fix::{Bits, Fix};
use crate::number::{Poly, Rat};

/// Coefficients, constant first.
#[derive(Clone, Debug, Default)]
pub(super) struct QPoly(pub(super) Vec<Rat>);

impl QPoly {
    pub(super) fn of(p: &Poly) -> QPoly {
        QPoly(p.coeffs().iter().cloned().map(Rat::from).collect())
    }
    pub(super) fn add(&self, o: &QPoly) -> QPoly {
        let zero = Rat::zero();
        QPoly(
            (0..self.0.len().max(o.0.len()))
                .map(|i| self.0.get(i).unwrap_or(&zero) + o.0.get(i).unwrap_or(&zero))
                .collect(),
        )
    }
    pub(super) fn scale(&self, k: &Rat) -> QPoly {
        QPoly(self.0.iter().map(|c| c * k).collect())
    }
    pub(super) fn sub(&self, o: &QPoly) -> QPoly {
        self.add(&o.scale(&Rat::from(-1)))
    }
    pub(super) fn mul(&self, o: &QPoly) -> QPoly {
        if self.0.is_empty() || o.0.is_empty() {
            return QPoly::default();
        }
        let mut out = vec![Rat::zero(); self.0.len() + o.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in o.0.iter().enumerate() {
                out[i + j] += &(a * b);
            }
        }
        QPoly(out)
    }
    /// The quotient by a divisor.
    pub(super) fn over(&self, d: &Poly) -> QPoly {
        let (Some(m), Some(lead)) = (d.degree(), d.leading()) else {
            return self.clone();
        };
        let lead = Rat::from(lead.clone());
        let mut rest = self.0.clone();
        let mut out = vec![Rat::zero(); (rest.len()).saturating_sub(m)];
        for k in (0..out.len()).rev() {
            let c = &rest[k + m] / &lead;
            for (i, y) in d.coeffs().iter().enumerate() {
                let less = &c * &Rat::from(y.clone());
                rest[k + i] -= &less;
            }
            out[k] = c;
        }
        QPoly(out)
    }
    pub(super) fn derivative(&self) -> QPoly {
        let by = |(i, c): (usize, &Rat)| c * &Rat::from(i as i64);
        QPoly(self.0.iter().enumerate().skip(1).map(by).collect())
    }
    pub(super) fn eval(&self, x: &Rat) -> Rat {
        self.0.iter().rev().fold(Rat::zero(), |v, c| v * x + c)
    }
    /// The integer polynomial of the same sign everywhere.
    pub(super) fn poly(&self) -> Poly {
        Poly::from_rats(&self.0)
    }
    /// Num and den as integer polynomials with the quotient unchanged.
    pub(super) fn pair(num: &QPoly, den: &QPoly) -> (Poly, Poly) {
        let n = num.0.len();
        let all: Vec<Rat> = num
            .0
            .iter()
            .chain(&den.0)
            .cloned()
            .chain([Rat::one()])
            .collect();
        let p = Poly::from_rats(&all);
        let part = |r: std::ops::Range<usize>| Poly::new(r.map(|i| p.coeff(i)).collect());
        (part(0..n), part(n..n + den.0.len()))
    }
    pub(super) fn fix(&self, bits: Bits) -> Vec<Fix> {
        self.0.iter().map(|c| bits.rat(c)).collect()
    }
}

/// Horner's rule on enclosed coefficients.
pub(super) fn horner(c: &[Fix], x: &Fix, bits: Bits) -> Fix {
    c.iter().rev().fold(bits.int(0), |v, c| v.mul(x).add(c))
}
