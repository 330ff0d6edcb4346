use crate::number::Rat;

/// A point or vector of the plane with rational coordinates.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default, PartialOrd, Ord)]
pub struct Vec2 {
    /// To the right.
    pub x: Rat,
    /// Up.
    pub y: Rat,
}

impl Vec2 {
    /// A point from its coordinates.
    pub fn new(x: Rat, y: Rat) -> Vec2 {
        Vec2 { x, y }
    }
    /// x·x' + y·y'.
    pub fn dot(&self, o: &Vec2) -> Rat {
        &self.x * &o.x + &self.y * &o.y
    }
    /// x·y' − y·x', the component out of the plane of the cross product.
    pub fn cross(&self, o: &Vec2) -> Rat {
        &self.x * &o.y - &self.y * &o.x
    }
    /// Turned by −90°: (y, −x). The outward normal of an edge whose solid lies to its left.
    pub fn right_normal(&self) -> Vec2 {
        Vec2::new(self.y.clone(), -&self.x)
    }
    /// Multiplied by a scalar.
    pub fn scale(&self, k: &Rat) -> Vec2 {
        Vec2::new(&self.x * k, &self.y * k)
    }
    /// |self|².
    pub fn norm2(&self) -> Rat {
        self.dot(self)
    }
    /// Whether both coordinates are zero.
    pub fn is_zero(&self) -> bool {
        self.x.is_zero() && self.y.is_zero()
    }
    /// Turned by θ where u = tan(θ/2), exactly.
    pub fn rotate_tan_half(&self, u: &Rat) -> Vec2 {
        let uu = u * u;
        let one = Rat::one();
        let den = &one + &uu;
        let c = (&one - &uu) / &den;
        let s = (u + u) / &den;
        Vec2::new(&c * &self.x - &s * &self.y, &s * &self.x + &c * &self.y)
    }
}

impl std::ops::Add<&Vec2> for &Vec2 {
    type Output = Vec2;
    fn add(self, o: &Vec2) -> Vec2 {
        Vec2::new(&self.x + &o.x, &self.y + &o.y)
    }
}
impl std::ops::Sub<&Vec2> for &Vec2 {
    type Output = Vec2;
    fn sub(self, o: &Vec2) -> Vec2 {
        Vec2::new(&self.x - &o.x, &self.y - &o.y)
    }
}
impl std::ops::Neg for &Vec2 {
    type Output = Vec2;
    fn neg(self) -> Vec2 {
        Vec2::new(-&self.x, -&self.y)
    }
}
