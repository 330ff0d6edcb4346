use crate::number::{Rat, Scalar};

/// One of the two charts of the circle of orientations.
///
/// In half-turn h the orientation is θ = π·h + 2·atan(x) with |x| ≤ 1, so a chart never leaves
/// [−1, 1] and u = ∞ is an ordinary point. Even half-turns use `Rest`, where x = tan(θ/2) = u;
/// odd ones use `Back`, where x = −1/u. In both, x grows with θ.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Chart {
    /// Around θ = 0.
    Rest,
    /// Around θ = π.
    Back,
}

impl Chart {
    /// Both charts.
    pub const BOTH: [Chart; 2] = [Chart::Rest, Chart::Back];

    /// The chart of half-turn h.
    pub fn of_half_turn(h: i64) -> Chart {
        if h.rem_euclid(2) == 0 {
            Chart::Rest
        } else {
            Chart::Back
        }
    }
    /// The other one.
    pub fn other(self) -> Chart {
        match self {
            Chart::Rest => Chart::Back,
            Chart::Back => Chart::Rest,
        }
    }
    /// 0 or 1, for indexing.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// c·cos θ + s·sin θ + k.
///
/// Multiplied by the positive 1 + x² it is a quadratic in x in either chart, with the same sign.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default)]
pub struct Trig<R = Rat> {
    /// Coefficient of cos θ.
    pub c: R,
    /// Coefficient of sin θ.
    pub s: R,
    /// Constant.
    pub k: R,
}

impl<R: Scalar> Trig<R> {
    /// c·cos θ + s·sin θ + k.
    pub fn new(c: R, s: R, k: R) -> Trig<R> {
        Trig { c, s, k }
    }
    /// A constant.
    pub fn constant(k: R) -> Trig<R> {
        Trig {
            c: R::zero(),
            s: R::zero(),
            k,
        }
    }
    /// The quadratic (constant first) that has this function's sign in the chart.
    pub fn form(&self, chart: Chart) -> [R; 3] {
        let (sum, dif) = (self.k.plus(&self.c), self.k.minus(&self.c));
        let lin = self.s.plus(&self.s);
        match chart {
            Chart::Rest => [sum, lin, dif],
            Chart::Back => [dif, lin.negated(), sum],
        }
    }
    /// The value at chart position x, times 1 + x².
    pub fn value(&self, chart: Chart, x: &R) -> R {
        let [a, b, c] = self.form(chart);
        c.times(x).plus(&b).times(x).plus(&a)
    }
    /// Whether identically zero.
    pub fn is_zero(&self) -> bool {
        self.c.is_zero() && self.s.is_zero() && self.k.is_zero()
    }
    /// The negated function.
    pub fn neg(&self) -> Trig<R> {
        Trig {
            c: self.c.negated(),
            s: self.s.negated(),
            k: self.k.negated(),
        }
    }
    /// Multiplied by a scalar.
    pub fn scale(&self, f: &R) -> Trig<R> {
        Trig {
            c: self.c.times(f),
            s: self.s.times(f),
            k: self.k.times(f),
        }
    }
    /// The sum.
    pub fn add(&self, o: &Trig<R>) -> Trig<R> {
        Trig {
            c: self.c.plus(&o.c),
            s: self.s.plus(&o.s),
            k: self.k.plus(&o.k),
        }
    }
    /// Derivative with respect to θ.
    pub fn derivative(&self) -> Trig<R> {
        Trig {
            c: self.s.clone(),
            s: self.c.negated(),
            k: R::zero(),
        }
    }
}

impl Trig {
    /// [`Trig::form`] as an integer polynomial, up to a positive factor.
    pub fn poly(&self, chart: Chart) -> crate::number::Poly {
        crate::number::Poly::from_rats(&self.form(chart))
    }
}
