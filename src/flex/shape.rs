//! Bodies as integers, and where they stand.
//!
//! A [`Shape`] is a body in its own frame, taken from the point that its pose moves (the origin,
//! or the pin): integers over one denominator. A [`Pose`] places it: a point and the rational
//! tangent of half its angle. A [`Placed`] is the two together, still integers: rotating by
//! tan(θ/2) = p/q multiplies by (q² − p², 2pq) over q² + p², so no rational is reduced on the way
//! to a row of the linear program.

use super::types::{Body, Hold, Structure};
use crate::geometry::{Corner, Polygon, Vec2};
use crate::number::{Int, Rat};

/// An integer vector.
pub(crate) type IntVec = [Int; 2];

/// a·b.
pub(crate) fn dot(a: &IntVec, b: &IntVec) -> Int {
    &a[0] * &b[0] + &a[1] * &b[1]
}

/// a × b.
pub(crate) fn cross(a: &IntVec, b: &IntVec) -> Int {
    &a[0] * &b[1] - &a[1] * &b[0]
}

/// Where a body stands: the point of it that translations move, and tan(θ/2).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pose {
    /// The reference point (the frame's origin; a pinned body's pin) in the plane.
    pub place: Vec2,
    /// tan(θ/2) of the frame's rotation.
    pub tan_half: Rat,
}

/// A rational rotation by integers: cos = c/d, sin = s/d, d > 0.
#[derive(Clone, Debug)]
pub(crate) struct Turn {
    pub(crate) c: Int,
    pub(crate) s: Int,
    pub(crate) d: Int,
}

impl Turn {
    /// The rotation by θ with tan(θ/2) = u.
    pub(crate) fn of(u: &Rat) -> Turn {
        let (p, q) = (u.numer(), u.denom());
        let (pp, qq) = (p * p, q * q);
        let (mut c, mut s, mut d) = (&qq - &pp, (p * q).shl(1), qq + pp);
        if d.is_even() {
            // p and q both odd: all three are even.
            (c, s, d) = (c.shr(1), s.shr(1), d.shr(1));
        }
        Turn { c, s, d }
    }

    /// d times the rotated vector.
    pub(crate) fn apply(&self, v: &IntVec) -> IntVec {
        [
            &self.c * &v[0] - &self.s * &v[1],
            &self.s * &v[0] + &self.c * &v[1],
        ]
    }
}

/// A body's polygon about its reference point, in integers over `h`.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    /// Vertices as listed.
    pub(crate) vertices: Vec<IntVec>,
    /// Vertices as doubles.
    pub(crate) local: Vec<[f64; 2]>,
    /// The outward normal of edge k, a primitive integer vector.
    pub(crate) normals: Vec<IntVec>,
    /// The same of length one, in doubles.
    pub(crate) units: Vec<[f64; 2]>,
    /// Corners as seen from the solid.
    pub(crate) corners: Vec<Corner>,
    /// The common denominator.
    pub(crate) h: Int,
    /// 1 where the vertices are listed counter-clockwise, else −1.
    pub(crate) sense: i32,
    /// No vertex is farther than this from the reference point.
    pub(crate) reach: f64,
}

/// The point of a body's frame that its pose places.
pub(crate) fn reference(body: &Body) -> Vec2 {
    match &body.hold {
        Hold::Pin(p) => p.clone(),
        _ => Vec2::default(),
    }
}

/// A vector without the common factor of its parts.
pub(crate) fn primitive(v: IntVec) -> IntVec {
    let g = v[0].gcd(&v[1]);
    if g.is_zero() || g.is_one() {
        return v;
    }
    [v[0].div_exact(&g), v[1].div_exact(&g)]
}

/// The nearest double; infinite past the double range.
pub(crate) fn double(r: &Rat) -> f64 {
    r.nearest_f64().unwrap_or(f64::INFINITY)
}

/// A point as doubles.
pub(crate) fn doubles(p: &Vec2) -> [f64; 2] {
    [double(&p.x), double(&p.y)]
}

/// Points over their least common denominator.
pub(crate) fn integral<'a>(points: impl Iterator<Item = &'a Vec2> + Clone) -> (Vec<IntVec>, Int) {
    let h = points
        .clone()
        .fold(Int::one(), |h, p| h.lcm(p.x.denom()).lcm(p.y.denom()));
    let whole = |v: &Rat| v.numer() * &h.div_exact(v.denom());
    (points.map(|p| [whole(&p.x), whole(&p.y)]).collect(), h)
}

impl Shape {
    /// The shape of a body whose polygon is proper.
    pub(crate) fn of(body: &Body) -> Shape {
        let from = reference(body);
        let relative: Vec<Vec2> = body.vertices.iter().map(|v| v - &from).collect();
        let polygon = Polygon::new(relative.clone(), Vec::new());
        let (vertices, h) = integral(relative.iter());
        let n = vertices.len();
        let sense = if polygon.is_counter_clockwise(0) {
            1
        } else {
            -1
        };
        let normals: Vec<IntVec> = (0..n)
            .map(|k| {
                let (a, b) = (&vertices[k], &vertices[(k + 1) % n]);
                let (x, y) = (&b[0] - &a[0], &b[1] - &a[1]);
                primitive(if sense > 0 { [y, -x] } else { [-y, x] })
            })
            .collect();
        let units = normals
            .iter()
            .map(|v| super::pairs::unit(v).into())
            .collect();
        let local = relative.iter().map(doubles).collect();
        let reach = relative
            .iter()
            .map(|v| v.norm2().interval().sqrt().hi)
            .fold(0.0, f64::max);
        Shape {
            corners: (0..n).map(|k| polygon.corner(0, k)).collect(),
            vertices,
            local,
            normals,
            units,
            h,
            sense,
            reach,
        }
    }

    /// Number of vertices, and of edges.
    pub(crate) fn len(&self) -> usize {
        self.vertices.len()
    }

    /// The edges that end and begin at a vertex, in the listed order.
    pub(crate) fn edges_at(&self, vertex: usize) -> (usize, usize) {
        ((vertex + self.len() - 1) % self.len(), vertex)
    }
}

impl Pose {
    /// The pose of a body as the file gives it.
    pub fn of(body: &Body) -> Pose {
        let turned = reference(body).rotate_tan_half(&body.tan_half);
        Pose {
            place: &body.position + &turned,
            tan_half: body.tan_half.clone(),
        }
    }

    /// Where the frame's origin stands.
    pub fn position(&self, body: &Body) -> Vec2 {
        let turned = reference(body).rotate_tan_half(&self.tan_half);
        &self.place - &turned
    }

    /// Bits of the longest of the three numbers.
    pub fn bits(&self) -> u64 {
        [&self.place.x, &self.place.y, &self.tan_half]
            .iter()
            .map(|v| v.numer().bits().max(v.denom().bits()))
            .max()
            .unwrap_or(0)
    }
}

/// A shape at a pose: everything relative to the reference point is an integer over `den`.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) turn: Turn,
    /// d·h.
    pub(crate) den: Int,
    /// The reference point over `q`.
    pub(crate) place: IntVec,
    pub(crate) q: Int,
    /// Rotated vertices over `den`.
    pub(crate) offsets: Vec<IntVec>,
    /// Vertices in the plane as doubles, each coordinate within [`Placed::blur`].
    pub(crate) near: Vec<[f64; 2]>,
    /// The reference point as doubles.
    pub(crate) centre: [f64; 2],
    /// The rotation as doubles.
    pub(crate) cos: f64,
    pub(crate) sin: f64,
    /// Error bound of `near`.
    pub(crate) blur: f64,
}

impl Placed {
    pub(crate) fn new(shape: &Shape, pose: &Pose) -> Placed {
        let turn = Turn::of(&pose.tan_half);
        let (mut place, q) = integral(std::iter::once(&pose.place));
        let offsets: Vec<IntVec> = shape.vertices.iter().map(|v| turn.apply(v)).collect();
        let [x, y] = doubles(&pose.place);
        let cos = double(&Rat::new(turn.c.clone(), turn.d.clone()));
        let sin = double(&Rat::new(turn.s.clone(), turn.d.clone()));
        let h = &shape.h;
        let near = shape
            .local
            .iter()
            .map(|[a, b]| [x + (cos * a - sin * b), y + (sin * a + cos * b)])
            .collect();
        // Each of at most six roundings is off by 2⁻⁵³ of a number below |place| + 2 reach.
        let blur = (x.abs() + y.abs() + 4.0 * shape.reach) * 2f64.powi(-49);
        Placed {
            den: &turn.d * h,
            turn,
            place: place.swap_remove(0),
            q,
            offsets,
            near,
            centre: [x, y],
            cos,
            sin,
            blur,
        }
    }

    /// A vertex in the plane.
    pub(crate) fn vertex(&self, k: usize) -> Vec2 {
        let o = &self.offsets[k];
        let at = |p: &Int, o: &Int| {
            Rat::new(p.clone(), self.q.clone()) + Rat::new(o.clone(), self.den.clone())
        };
        Vec2::new(at(&self.place[0], &o[0]), at(&self.place[1], &o[1]))
    }

    /// The polygon in the plane.
    pub(crate) fn polygon(&self) -> Polygon {
        Polygon::new(
            (0..self.offsets.len()).map(|k| self.vertex(k)).collect(),
            Vec::new(),
        )
    }
}

/// The polygons of a structure where its file places them.
pub(crate) fn placed(structure: &Structure) -> Vec<Polygon> {
    structure
        .bodies
        .iter()
        .map(|b| Placed::new(&Shape::of(b), &Pose::of(b)).polygon())
        .collect()
}
