//! From a configuration to a linear program: signed distances, their gradients, the objective.
//!
//! A constraint (PF eq. 12) says that a point p of body 2 stays on the positive side of a line of
//! body 1, normal n outward, through o: d(q₁, q₂) = n(q₁)·(p(q₂) − o(q₁)) ≥ 0. With r₂ = p − x₂
//! and Δ = x₂ − x₁ that is n·Δ + n·r₂ − n·(o − x₁), whose last term no motion changes. Hence
//!
//! ∂x₁ = −n, ∂x₂ = n, ∂θ₁ = n × (p − x₁), ∂θ₂ = r₂ × n
//!
//! which is PF eq. 16 with its sign put right and its lost line for θ₂. Normals keep whatever
//! length makes everything rational, and each row is multiplied by a positive number that makes
//! it integral; neither changes the half-space. A program maximises c·q̇ under J q̇ + d₀ ≥ 0
//! (PF eq. 11), with three columns for a free body and one for a pinned one.

mod program;

use self::program::{Weighted, weights};
use super::pairs::{Facing, Pair, Plane, Point, averaged};
use super::shape::{IntVec, Placed, Pose, Shape, cross, dot, double, integral, primitive};
use super::types::{Hold, Joint, Structure, Term, View};
use crate::geometry::Vec2;
use crate::number::{Int, Rat};

/// The freedoms of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// x, y and θ.
    Free,
    /// θ alone.
    Pinned,
    /// None.
    Fixed,
}

/// A line in its body's frame: a normal of any length, and a point over `h`.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    normal: IntVec,
    base: IntVec,
    h: Int,
    /// The normal of length one and the point, as doubles.
    unit: [f64; 2],
    near: [f64; 2],
}

/// The lines and the marker of a view, in their frames.
#[derive(Clone, Debug)]
pub(crate) struct Sight {
    pub(crate) body: usize,
    pub(crate) of: usize,
    left: Line,
    right: Line,
    pub(crate) range: Option<Line>,
    marker: IntVec,
    h: Int,
    near: [f64; 2],
}

/// All of a structure that does not change as it moves.
#[derive(Clone, Debug)]
pub(crate) struct Scaffold {
    pub(crate) shapes: Vec<Shape>,
    pub(crate) forms: Vec<Form>,
    pub(crate) epsilon: Rat,
    pub(crate) joints: Option<Vec<Joint>>,
    pub(crate) nearest: Option<usize>,
    pub(crate) views: Vec<Sight>,
    /// Pairs of bodies that are looked at beside the joints.
    pub(crate) extra: Vec<(usize, usize)>,
    /// Weights of the objective.
    terms: Vec<Weighted>,
    /// Bodies that are to move towards an abscissa.
    gathered: Vec<(usize, Rat)>,
    /// First column of each body.
    columns: Vec<usize>,
    pub(crate) column_count: usize,
    /// Where every body stands at the start.
    pub(crate) start: Vec<Pose>,
    pub(crate) rotation_limit: Option<Rat>,
    /// Limits of rotation by body, for the next program.
    pub(crate) turn_limits: Option<Vec<Rat>>,
}

/// A constraint at a configuration, in integers: J q̇ + d₀ ≥ 0 times a positive number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) pair: Pair,
    /// Coefficients of x₂ and y₂; those of x₁ and y₁ are the opposite.
    pub(crate) normal: IntVec,
    pub(crate) theta1: Int,
    pub(crate) theta2: Int,
    pub(crate) d0: Int,
}

/// A constraint in doubles: a line's normal of length one and a point of the line in its body's
/// frame, a point in the other's.
#[derive(Clone, Debug)]
pub(crate) struct Sketch {
    pub(crate) one: usize,
    pub(crate) two: usize,
    unit: [f64; 2],
    from: [f64; 2],
    to: [f64; 2],
}

impl Sketch {
    /// The signed distance where bodies stand at (x, y, angle), and its derivatives by the first
    /// and by the second one's.
    pub(crate) fn measure(&self, at: &[[f64; 3]]) -> (f64, [f64; 3], [f64; 3]) {
        let turned = |v: [f64; 2], angle: f64| {
            let (s, c) = angle.sin_cos();
            [c * v[0] - s * v[1], s * v[0] + c * v[1]]
        };
        let (a, b) = (at[self.one], at[self.two]);
        let n = turned(self.unit, a[2]);
        let (from, arm) = (turned(self.from, a[2]), turned(self.to, b[2]));
        let way = [b[0] - a[0] + arm[0], b[1] - a[1] + arm[1]];
        let gap = n[0] * (way[0] - from[0]) + n[1] * (way[1] - from[1]);
        let first = [-n[0], -n[1], n[0] * way[1] - n[1] * way[0]];
        let second = [n[0], n[1], arm[0] * n[1] - arm[1] * n[0]];
        (gap, first, second)
    }
}

fn line(normal: IntVec, base: IntVec, h: Int) -> Line {
    let (x, y) = super::pairs::unit(&normal);
    let part = |k: usize| double(&Rat::new(base[k].clone(), h.clone()));
    Line {
        unit: [x, y],
        near: [part(0), part(1)],
        normal: primitive(normal),
        base,
        h,
    }
}

fn sight(structure: &Structure, view: &View) -> Sight {
    let relative = |body: usize, p: &Vec2| p - &super::shape::reference(&structure.bodies[body]);
    let camera = relative(view.body, &view.camera);
    let marker = relative(view.of, &view.marker);
    let through = |normal: Vec2, point: &Vec2| {
        let (mut n, _) = integral(std::iter::once(&normal));
        let (mut b, h) = integral(std::iter::once(point));
        line(n.swap_remove(0), b.swap_remove(0), h)
    };
    let (mut m, h) = integral(std::iter::once(&marker));
    Sight {
        body: view.body,
        of: view.of,
        // To the right of the left ray, to the left of the right one.
        left: through(view.left.right_normal(), &camera),
        right: through(-&view.right.right_normal(), &camera),
        range: view.far.as_ref().map(|far| {
            let back = &view.camera - far;
            through(back, &relative(view.body, far))
        }),
        near: super::shape::doubles(&marker),
        marker: m.swap_remove(0),
        h,
    }
}

impl Scaffold {
    pub(crate) fn new(structure: &Structure) -> Scaffold {
        let forms: Vec<Form> = structure
            .bodies
            .iter()
            .map(|b| match b.hold {
                Hold::Free => Form::Free,
                Hold::Pin(_) => Form::Pinned,
                Hold::Fixed => Form::Fixed,
            })
            .collect();
        let mut columns = Vec::with_capacity(forms.len());
        let mut column_count = 0;
        for form in &forms {
            columns.push(column_count);
            column_count += match form {
                Form::Free => 3,
                Form::Pinned => 1,
                Form::Fixed => 0,
            };
        }
        let mut scaffold = Scaffold {
            shapes: structure.bodies.iter().map(Shape::of).collect(),
            forms,
            epsilon: structure.epsilon.clone(),
            joints: structure.joints.clone(),
            nearest: structure.nearest,
            views: structure
                .views
                .iter()
                .map(|v| sight(structure, v))
                .collect(),
            extra: Vec::new(),
            terms: Vec::new(),
            gathered: structure
                .objective
                .iter()
                .filter_map(|t| match t {
                    Term::Towards { body, x } => Some((*body, x.clone())),
                    _ => None,
                })
                .collect(),
            columns,
            column_count,
            start: structure.bodies.iter().map(Pose::of).collect(),
            rotation_limit: structure.step.rotation_limit.clone(),
            turn_limits: None,
        };
        scaffold.terms = weights(structure, &scaffold);
        scaffold
    }

    /// The bodies at given poses.
    pub(crate) fn place(&self, poses: &[Pose]) -> Vec<Placed> {
        let each = self.shapes.iter().zip(poses);
        each.map(|(s, p)| Placed::new(s, p)).collect()
    }

    /// The line of a pair in its body's frame.
    fn line(&self, body: usize, plane: Plane) -> Line {
        let shape = &self.shapes[body];
        match plane {
            Plane::Edge(k) => {
                let k = k as usize;
                let (x, y) = super::pairs::unit(&shape.normals[k]);
                Line {
                    normal: shape.normals[k].clone(),
                    base: shape.vertices[k].clone(),
                    h: shape.h.clone(),
                    unit: [x, y],
                    near: shape.local[k],
                }
            }
            Plane::Corner(k) => {
                let (before, after) = shape.edges_at(k as usize);
                let normal = averaged(&shape.normals[before], &shape.normals[after]);
                line(normal, shape.vertices[k as usize].clone(), shape.h.clone())
            }
            Plane::ConeLeft(v) => self.views[v as usize].left.clone(),
            Plane::ConeRight(v) => self.views[v as usize].right.clone(),
            Plane::Range(v) => {
                let sight = &self.views[v as usize];
                sight.range.clone().unwrap_or_else(|| sight.left.clone())
            }
        }
    }

    /// The row of a pair.
    pub(crate) fn row(&self, pair: &Pair, placed: &[Placed]) -> Row {
        let (one, two) = (pair.line_body as usize, pair.point_body as usize);
        let line = self.line(one, pair.plane);
        let (p1, p2) = (&placed[one], &placed[two]);
        let marker;
        let (offset, den2) = match pair.point {
            Point::Vertex(v) => (&p2.offsets[v as usize], p2.den.clone()),
            Point::Marker(v) => {
                let sight = &self.views[v as usize];
                marker = p2.turn.apply(&sight.marker);
                (&marker, &p2.turn.d * &sight.h)
            }
        };
        // n = N / D₁; Δ over q; r₂ over den₂.
        let n = p1.turn.apply(&line.normal);
        let (delta, q) = difference(p1, p2);
        let constant = dot(&line.normal, &line.base);
        // Everything times D₁·den₂·q, and times h where the last term needs it.
        let scale = &den2 * &q;
        let mut normal = [&n[0] * &scale, &n[1] * &scale];
        let mut theta1 = &cross(&n, &delta) * &den2 + &cross(&n, offset) * &q;
        let mut theta2 = &cross(offset, &n) * &q;
        let mut d0 = &dot(&n, &delta) * &den2 + &dot(&n, offset) * &q;
        let last = &(&constant * &p1.turn.d) * &scale;
        let (whole, rest) = last.div_rem_floor(&line.h);
        if rest.is_zero() {
            d0 -= &whole;
        } else {
            let h = &line.h;
            normal = [&normal[0] * h, &normal[1] * h];
            theta1 = &theta1 * h;
            theta2 = &theta2 * h;
            d0 = &d0 * h - &last;
        }
        Row {
            pair: *pair,
            normal,
            theta1,
            theta2,
            d0,
        }
    }

    /// The signed distance of a pair in doubles, and a bound of its error.
    pub(crate) fn near(&self, pair: &Pair, placed: &[Placed]) -> (f64, f64) {
        let (p1, p2) = (
            &placed[pair.line_body as usize],
            &placed[pair.point_body as usize],
        );
        let (n, from, to) = self.seen(pair, placed);
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let far = dx.abs() + dy.abs();
        // A marker or a camera may lie outside its body: its own distance counts as well.
        let outlying = from[0].abs() + from[1].abs() + to[0].abs() + to[1].abs();
        let error = 4.0 * (p1.blur + p2.blur) + (far + outlying) * 2f64.powi(-46);
        (n[0] * dx + n[1] * dy, error)
    }

    /// A pair in doubles: the line's normal of length one, a point of the line, and the point.
    pub(crate) fn seen(&self, pair: &Pair, placed: &[Placed]) -> ([f64; 2], [f64; 2], [f64; 2]) {
        let (one, two) = (pair.line_body as usize, pair.point_body as usize);
        let (p1, p2) = (&placed[one], &placed[two]);
        let stored;
        let (unit, from) = match pair.plane {
            Plane::Edge(k) => (self.shapes[one].units[k as usize], p1.near[k as usize]),
            plane => {
                stored = self.line(one, plane);
                let (a, b) = (stored.near[0], stored.near[1]);
                let [x, y] = p1.centre;
                let at = [x + (p1.cos * a - p1.sin * b), y + (p1.sin * a + p1.cos * b)];
                (stored.unit, at)
            }
        };
        let n = [
            p1.cos * unit[0] - p1.sin * unit[1],
            p1.sin * unit[0] + p1.cos * unit[1],
        ];
        let to = match pair.point {
            Point::Vertex(v) => p2.near[v as usize],
            Point::Marker(v) => {
                let [a, b] = self.views[v as usize].near;
                let [x, y] = p2.centre;
                [x + (p2.cos * a - p2.sin * b), y + (p2.sin * a + p2.cos * b)]
            }
        };
        (n, from, to)
    }

    /// A pair in the frames of its bodies, in doubles.
    pub(crate) fn sketch(&self, pair: &Pair) -> Sketch {
        let (one, two) = (pair.line_body as usize, pair.point_body as usize);
        let line = self.line(one, pair.plane);
        Sketch {
            one,
            two,
            unit: line.unit,
            from: line.near,
            to: match pair.point {
                Point::Vertex(v) => self.shapes[two].local[v as usize],
                Point::Marker(v) => self.views[v as usize].near,
            },
        }
    }

    /// The averaged rows that stand for facing corners.
    pub(crate) fn averaged(&self, facing: &[Facing]) -> Vec<Pair> {
        facing
            .iter()
            .map(|f| Pair {
                line_body: f.first.0,
                plane: Plane::Corner(f.first.1),
                point_body: f.second.0,
                point: Point::Vertex(f.second.1),
            })
            .collect()
    }

    /// The four edges of which one must keep facing corners apart.
    pub(crate) fn choices(&self, f: &Facing) -> [Pair; 4] {
        let of = |(line, corner): (u32, u32), (point, vertex): (u32, u32)| {
            let (before, after) = self.shapes[line as usize].edges_at(corner as usize);
            [before, after].map(|k| Pair {
                line_body: line,
                plane: Plane::Edge(k as u32),
                point_body: point,
                point: Point::Vertex(vertex),
            })
        };
        let [a, b] = of(f.first, f.second);
        let [c, d] = of(f.second, f.first);
        [a, b, c, d]
    }
}

/// tan(Δθ/2) of the rotation from one pose to another.
pub(crate) fn turned_by(from: &Pose, to: &Pose) -> Rat {
    let (u, v) = (&from.tan_half, &to.tan_half);
    let bottom = Rat::one() + u * v;
    if bottom.is_zero() {
        // A half turn within one run: no step is that long; count it as a large one.
        return Rat::from(1 << 20);
    }
    (v - u) / bottom
}

/// x₂ − x₁ over a common denominator.
fn difference(p1: &Placed, p2: &Placed) -> (IntVec, Int) {
    if p1.q == p2.q {
        let part = |k: usize| &p2.place[k] - &p1.place[k];
        return ([part(0), part(1)], p1.q.clone());
    }
    let g = p1.q.gcd(&p2.q);
    let (f1, f2) = (p2.q.div_exact(&g), p1.q.div_exact(&g));
    let part = |k: usize| &p2.place[k] * &f2 - &p1.place[k] * &f1;
    ([part(0), part(1)], &p1.q * &f1)
}

/// Bits that a radial direction is rounded to: each part is off by at most 2⁻³⁰.
const DIRECTION_BITS: u64 = 30;

/// v/|v| with each part within 2⁻³⁰; exact where |v| is rational and short. Zero for zero.
pub(crate) fn direction(v: &Vec2) -> Vec2 {
    let (mut whole, _) = integral(std::iter::once(v));
    let v = primitive(whole.swap_remove(0));
    let square = dot(&v, &v);
    if square.is_zero() {
        return Vec2::default();
    }
    if let Some(length) = square.sqrt_exact()
        && length.bits() <= DIRECTION_BITS
    {
        let part = |k: usize| Rat::new(v[k].clone(), length.clone());
        return Vec2::new(part(0), part(1));
    }
    let part = |k: usize| {
        let top = (&v[k] * &v[k]).shl(2 * DIRECTION_BITS);
        let root = top
            .div_rem_floor(&square)
            .0
            .sqrt()
            .unwrap_or_else(Int::zero);
        let root = if v[k].sign() < 0 { -root } else { root };
        Rat::new(root, Int::one().shl(DIRECTION_BITS))
    };
    Vec2::new(part(0), part(1))
}

#[cfg(test)]
mod tests;
