//! Certified `f64` intervals with outward rounding. STUB.
/// A closed interval of doubles that encloses a real number; either end may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /** lower end */
    pub lo: f64,
    /** upper end */
    pub hi: f64,
}
impl Interval {
    /// A point.
    pub fn point(x: f64) -> Interval {
        Interval { lo: x, hi: x }
    }
    /// The whole line.
    pub fn all() -> Interval {
        Interval {
            lo: f64::NEG_INFINITY,
            hi: f64::INFINITY,
        }
    }
    /// The sign that holds throughout, None if undecided. Some(0) only for the point zero.
    pub fn sign(&self) -> Option<i32> {
        todo!()
    }
    /// Whether every number of self lies strictly below every number of other.
    pub fn below(&self, other: &Interval) -> bool {
        self.hi < other.lo
    }
    /// Whether they share a point.
    pub fn meets(&self, other: &Interval) -> bool {
        !(self.below(other) || other.below(self))
    }
    /// Square root of the non-negative part.
    pub fn sqrt(&self) -> Interval {
        todo!()
    }
    /// Square.
    pub fn square(&self) -> Interval {
        todo!()
    }
}
impl std::ops::Add for Interval {
    type Output = Interval;
    fn add(self, _o: Interval) -> Interval {
        todo!()
    }
}
impl std::ops::Sub for Interval {
    type Output = Interval;
    fn sub(self, _o: Interval) -> Interval {
        todo!()
    }
}
impl std::ops::Mul for Interval {
    type Output = Interval;
    fn mul(self, _o: Interval) -> Interval {
        todo!()
    }
}
/// The whole line where the divisor holds zero.
impl std::ops::Div for Interval {
    type Output = Interval;
    fn div(self, _o: Interval) -> Interval {
        todo!()
    }
}
impl std::ops::Neg for Interval {
    type Output = Interval;
    fn neg(self) -> Interval {
        todo!()
    }
}
