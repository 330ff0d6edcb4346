use crate::number::{Enclosed, Rat, Scalar};

/// A point or vector of the plane; its coordinates are rational unless said otherwise.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default, PartialOrd, Ord)]
pub struct Vec2<R = Rat> {
    /// To the right.
    pub x: R,
    /// Up.
    pub y: R,
}

impl<R: Scalar> Vec2<R> {
    /// A point from its coordinates.
    pub fn new(x: R, y: R) -> Vec2<R> {
        Vec2 { x, y }
    }
    /// A rational point in another arithmetic.
    pub fn from_exact(p: &Vec2) -> Vec2<R> {
        Vec2::new(R::from_rat(&p.x), R::from_rat(&p.y))
    }
    /// In certified intervals.
    pub fn enclosed(&self) -> Vec2<Enclosed> {
        Vec2::new(
            Enclosed::new(self.x.interval()),
            Enclosed::new(self.y.interval()),
        )
    }
    /// x·x' + y·y'.
    pub fn dot(&self, o: &Vec2<R>) -> R {
        self.x.times(&o.x).plus(&self.y.times(&o.y))
    }
    /// x·y' − y·x', the component out of the plane of the cross product.
    pub fn cross(&self, o: &Vec2<R>) -> R {
        self.x.times(&o.y).minus(&self.y.times(&o.x))
    }
    /// Turned by −90°: (y, −x). The outward normal of an edge whose solid lies to its left.
    pub fn right_normal(&self) -> Vec2<R> {
        Vec2::new(self.y.clone(), self.x.negated())
    }
    /// Multiplied by a scalar.
    pub fn scale(&self, k: &R) -> Vec2<R> {
        Vec2::new(self.x.times(k), self.y.times(k))
    }
    /// |self|².
    pub fn norm2(&self) -> R {
        self.dot(self)
    }
    /// Whether both coordinates are zero.
    pub fn is_zero(&self) -> bool {
        self.x.is_zero() && self.y.is_zero()
    }
    /// Turned by θ where u = tan(θ/2), exactly.
    pub fn rotate_tan_half(&self, u: &R) -> Vec2<R> {
        let uu = u.times(u);
        let one = R::one();
        let den = one.plus(&uu);
        let c = one.minus(&uu).over(&den);
        let s = u.plus(u).over(&den);
        Vec2::new(
            c.times(&self.x).minus(&s.times(&self.y)),
            s.times(&self.x).plus(&c.times(&self.y)),
        )
    }
}

impl<R: Scalar> std::ops::Add<&Vec2<R>> for &Vec2<R> {
    type Output = Vec2<R>;
    fn add(self, o: &Vec2<R>) -> Vec2<R> {
        Vec2::new(self.x.plus(&o.x), self.y.plus(&o.y))
    }
}
impl<R: Scalar> std::ops::Sub<&Vec2<R>> for &Vec2<R> {
    type Output = Vec2<R>;
    fn sub(self, o: &Vec2<R>) -> Vec2<R> {
        Vec2::new(self.x.minus(&o.x), self.y.minus(&o.y))
    }
}
impl<R: Scalar> std::ops::Neg for &Vec2<R> {
    type Output = Vec2<R>;
    fn neg(self) -> Vec2<R> {
        Vec2::new(self.x.negated(), self.y.negated())
    }
}
