//! Which point of one body is to stay on its side of which line of another.
//!
//! Every constraint has one form: a point of one body (a vertex, a marker) stays on the positive
//! side of a directed line of another (an edge, a corner's averaged line, an edge of a cone of
//! view). A [`Pair`] names the two. The rules by which close bodies get their pairs (PF §V, V-A):
//!
//! * Only a convex vertex can touch, so only convex vertices are points.
//! * A vertex is paired with an edge if it lies at most ε away from it on its outer side and its
//!   foot falls on the edge; past an end it is still paired if the corner there is reflex, which
//!   is PF's swap: the point is measured against the concave corner.
//! * Where two convex corners face each other, past the ends of all four edges, one line is made:
//!   through the corner of the lower body, its normal the average of the two edges' (`average`),
//!   or one of the four edges, to be chosen (`branch`).
//!
//! Distances are compared with ε exactly; doubles decide only what their error bound proves.

use super::model::{Form, Scaffold};
use super::shape::{IntVec, Placed, dot};
use crate::geometry::{Box2, Corner, Vec2};
use crate::number::{Int, Interval, Rat};
use std::collections::HashSet;

/// A directed line of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Plane {
    /// An edge, by the vertex it begins at.
    Edge(u32),
    /// The averaged line of a convex corner, by its vertex.
    Corner(u32),
    /// The left edge of the cone of a view.
    ConeLeft(u32),
    /// The right edge of the cone of a view.
    ConeRight(u32),
    /// The line beyond which a view does not reach.
    Range(u32),
}

/// A point of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Point {
    /// A vertex.
    Vertex(u32),
    /// The marker of a view.
    Marker(u32),
}

/// A constraint by name: this point stays on the positive side of this line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pair {
    /// The body of the line.
    pub line_body: u32,
    /// The line.
    pub plane: Plane,
    /// The body of the point.
    pub point_body: u32,
    /// The point.
    pub point: Point,
}

/// Two convex corners that face each other: at least one of these four pairs must hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facing {
    /// The corner of the lower body.
    pub first: (u32, u32),
    /// The corner of the higher body.
    pub second: (u32, u32),
}

/// What a selection finds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Selection {
    /// Constraints that all hold, in a fixed order.
    pub(crate) pairs: Vec<Pair>,
    /// Convex corners that face each other.
    pub(crate) facing: Vec<Facing>,
}

/// Pairs of boxes, the lower index first, that come nearer than `grow` in both directions. Sweeps
/// along the longer side of the whole.
pub(crate) fn meeting(boxes: &[Box2], grow: f64) -> Vec<(usize, usize)> {
    let whole = boxes.iter().fold(Box2::EMPTY, |a, b| a.hull(b));
    let flat = whole.x.width() >= whole.y.width();
    let along = |b: &Box2| if flat { b.x } else { b.y };
    let across = |b: &Box2| if flat { b.y } else { b.x };
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| along(&boxes[a]).lo.total_cmp(&along(&boxes[b]).lo));
    let mut out = Vec::new();
    let mut active: Vec<usize> = Vec::new();
    for &k in &order {
        let start = along(&boxes[k]).lo - grow;
        active.retain(|&j| along(&boxes[j]).hi >= start);
        let mine = across(&boxes[k]);
        for &j in &active {
            let other = across(&boxes[j]);
            if other.lo <= mine.hi + grow && mine.lo <= other.hi + grow {
                out.push((j.min(k), j.max(k)));
            }
        }
        active.push(k);
    }
    out.sort_unstable();
    out
}

/// The box of a placed body.
pub(crate) fn box_of(p: &Placed) -> Box2 {
    let empty = Box2::EMPTY;
    p.near.iter().fold(empty, |b, [x, y]| {
        let around = |v: f64| Interval {
            lo: (v - p.blur).next_down(),
            hi: (v + p.blur).next_up(),
        };
        b.hull(&Box2 {
            x: around(*x),
            y: around(*y),
        })
    })
}

/// One body against another: vertices of `b` against edges of `a`.
struct Duel<'a> {
    scaffold: &'a Scaffold,
    a: usize,
    b: usize,
    pa: &'a Placed,
    pb: &'a Placed,
    epsilon: &'a Rat,
    epsilon_near: f64,
    /// How far inside an edge a vertex may lie and still be paired with it.
    slack: &'a Rat,
    slack_near: f64,
}

impl Duel<'_> {
    /// Whether vertex `v` of b is paired with edge `k` of a.
    fn pairs(&self, v: usize, k: usize) -> bool {
        let shape = &self.scaffold.shapes[self.a];
        let next = (k + 1) % shape.len();
        let (e0, e1, p) = (self.pa.near[k], self.pa.near[next], self.pb.near[v]);
        let (ex, ey) = (e1[0] - e0[0], e1[1] - e0[1]);
        let (px, py) = (p[0] - e0[0], p[1] - e0[1]);
        let length = ex.hypot(ey);
        let sense = f64::from(shape.sense);
        let s = sense * (ey * px - ex * py) / length;
        let f = (ex * px + ey * py) / length;
        // Positions are blurred by at most `b`; the direction by b / length.
        let b = 4.0 * (self.pa.blur + self.pb.blur);
        let b = b + b * (px.abs() + py.abs()) / length + 1e-12 * (px.abs() + py.abs());
        if !b.is_finite() {
            return self.pairs_exactly(v, k);
        }
        if s > self.epsilon_near + b || s < -self.slack_near - b {
            return false;
        }
        let sure_height = s < self.epsilon_near - b && s > -self.slack_near + b;
        let reflex = |c: usize| shape.corners[c] == Corner::Reflex;
        let past_start = if reflex(k) { self.epsilon_near } else { 0.0 };
        let past_end = if reflex(next) { self.epsilon_near } else { 0.0 };
        if f < -past_start - b || f > length + past_end + b {
            return false;
        }
        if sure_height && f > -past_start + b && f < length + past_end - b {
            return true;
        }
        self.pairs_exactly(v, k)
    }

    fn pairs_exactly(&self, v: usize, k: usize) -> bool {
        let shape = &self.scaffold.shapes[self.a];
        let next = (k + 1) % shape.len();
        let (e0, e1, p) = (self.pa.vertex(k), self.pa.vertex(next), self.pb.vertex(v));
        let (e, d) = (&e1 - &e0, &p - &e0);
        let sense = Rat::from(i64::from(shape.sense));
        let s = &d.cross(&e) * &sense;
        let f = d.dot(&e);
        let l2 = e.norm2();
        let within = |v: &Rat, bound: &Rat| v.square() <= &bound.square() * &l2;
        let height = if s.sign() >= 0 {
            within(&s, self.epsilon)
        } else {
            within(&s, self.slack)
        };
        let past = |over: Rat, corner: usize| {
            over.sign() <= 0
                || (shape.corners[corner] == Corner::Reflex && within(&over, self.epsilon))
        };
        height && past(-&f, k) && past(&f - &l2, next)
    }

    /// Adds the pairs of b's vertices with a's edges.
    fn fight(&self, out: &mut Vec<Pair>) {
        let shape = &self.scaffold.shapes[self.a];
        let reach = box_of(self.pa);
        let grow = self.epsilon_near * (1.0 + 1e-12);
        for (v, [x, y]) in self.pb.near.iter().enumerate() {
            let slack = grow + self.pb.blur;
            if self.scaffold.shapes[self.b].corners[v] != Corner::Convex
                || *x < reach.x.lo - slack
                || *x > reach.x.hi + slack
                || *y < reach.y.lo - slack
                || *y > reach.y.hi + slack
            {
                continue;
            }
            for k in 0..shape.len() {
                if self.pairs(v, k) {
                    out.push(Pair {
                        line_body: self.a as u32,
                        plane: Plane::Edge(k as u32),
                        point_body: self.b as u32,
                        point: Point::Vertex(v as u32),
                    });
                }
            }
        }
    }
}

/// Selects the constraints of a configuration.
///
/// `slack`: how far inside an edge a vertex may lie and still be held by it: zero at the start,
/// where nothing overlaps, and more than the violation allowed later on.
pub(crate) fn select(scaffold: &Scaffold, placed: &[Placed], slack: &Rat) -> Selection {
    let mut out = Selection::default();
    let epsilon = &scaffold.epsilon;
    let moves =
        |a: usize, b: usize| scaffold.forms[a] != Form::Fixed || scaffold.forms[b] != Form::Fixed;
    let tidy = |pairs: &mut Vec<(usize, usize)>| {
        pairs.sort_unstable();
        pairs.dedup();
        pairs.retain(|&(a, b)| moves(a, b));
    };
    let mut open: Vec<(usize, usize)> = Vec::new();
    match &scaffold.joints {
        None => {
            let boxes: Vec<Box2> = placed.iter().map(box_of).collect();
            let grow = super::shape::double(epsilon) * (1.0 + 1e-12);
            open = meeting(&boxes, grow);
        }
        Some(joints) => {
            for joint in joints {
                match &joint.contacts {
                    None => open.extend(joint.bodies.iter().map(|&(a, b)| (a.min(b), a.max(b)))),
                    Some(contacts) => {
                        for &(a, b) in joint.bodies.iter().filter(|&&(a, b)| moves(a, b)) {
                            out.pairs.extend(contacts.iter().map(|c| {
                                let (line, point) = if c.edge_of_first { (a, b) } else { (b, a) };
                                Pair {
                                    line_body: line as u32,
                                    plane: Plane::Edge(c.edge as u32),
                                    point_body: point as u32,
                                    point: Point::Vertex(c.vertex as u32),
                                }
                            }));
                        }
                    }
                }
            }
        }
    }
    open.extend(&scaffold.extra);
    tidy(&mut open);
    if let Some(count) = scaffold.nearest {
        let mut chosen = nearest(placed, count);
        tidy(&mut chosen);
        for &(a, b) in &chosen {
            separate(scaffold, placed, a, b, &mut out.pairs);
        }
        let taken: HashSet<(usize, usize)> = chosen.into_iter().collect();
        open.retain(|p| !taken.contains(p));
    }
    let (epsilon_near, slack_near) = (super::shape::double(epsilon), super::shape::double(slack));
    for (a, b) in open {
        let duel = |a: usize, b: usize| Duel {
            scaffold,
            a,
            b,
            pa: &placed[a],
            pb: &placed[b],
            epsilon,
            epsilon_near,
            slack,
            slack_near,
        };
        let from = out.pairs.len();
        duel(a, b).fight(&mut out.pairs);
        duel(b, a).fight(&mut out.pairs);
        facing(scaffold, placed, (a, b), from, &mut out);
    }
    for (k, view) in scaffold.views.iter().enumerate() {
        let k32 = k as u32;
        let range = view.range.is_some().then_some(Plane::Range(k32));
        let cone = [Plane::ConeLeft(k32), Plane::ConeRight(k32)];
        for plane in cone.into_iter().chain(range) {
            out.pairs.push(Pair {
                line_body: view.body as u32,
                plane,
                point_body: view.of as u32,
                point: Point::Marker(k as u32),
            });
        }
    }
    let mut seen = HashSet::with_capacity(out.pairs.len());
    out.pairs.retain(|p| seen.insert(*p));
    out
}

/// Convex corners of two bodies within ε of each other of which neither is paired with an edge of
/// the other's corner.
fn facing(
    scaffold: &Scaffold,
    placed: &[Placed],
    (a, b): (usize, usize),
    from: usize,
    out: &mut Selection,
) {
    let (sa, sb) = (&scaffold.shapes[a], &scaffold.shapes[b]);
    let (pa, pb) = (&placed[a], &placed[b]);
    let epsilon = super::shape::double(&scaffold.epsilon);
    let blur = 4.0 * (pa.blur + pb.blur);
    for (i, u) in pa.near.iter().enumerate() {
        if sa.corners[i] != Corner::Convex {
            continue;
        }
        for (j, v) in pb.near.iter().enumerate() {
            if sb.corners[j] != Corner::Convex {
                continue;
            }
            let (dx, dy) = (v[0] - u[0], v[1] - u[1]);
            let distance = dx.hypot(dy);
            if distance > epsilon + blur {
                continue;
            }
            let d = &pb.vertex(j) - &pa.vertex(i);
            if distance > epsilon - blur && d.norm2() > scaffold.epsilon.square() {
                continue;
            }
            let paired = |line: usize, edges: (usize, usize), point: usize, vertex: usize| {
                out.pairs[from..].iter().any(|p| {
                    p.line_body as usize == line
                        && p.point_body as usize == point
                        && p.point == Point::Vertex(vertex as u32)
                        && (p.plane == Plane::Edge(edges.0 as u32)
                            || p.plane == Plane::Edge(edges.1 as u32))
                })
            };
            if paired(a, sa.edges_at(i), b, j) || paired(b, sb.edges_at(j), a, i) {
                continue;
            }
            // Past the ends of both edges, seen from either corner: else another feature is nearer.
            let outside = |shape: &super::shape::Shape, p: &Placed, k: usize, d: &Vec2| {
                let n = shape.len();
                let at = p.vertex(k);
                let (before, after) = (p.vertex((k + n - 1) % n), p.vertex((k + 1) % n));
                d.dot(&(&at - &before)).sign() >= 0 && d.dot(&(&at - &after)).sign() >= 0
            };
            if outside(sa, pa, i, &d) && outside(sb, pb, j, &-&d) {
                out.facing.push(Facing {
                    first: (a as u32, i as u32),
                    second: (b as u32, j as u32),
                });
            }
        }
    }
}

/// For every body the `count` nearest others, by the distance of their reference points; ties go
/// to the lower index.
fn nearest(placed: &[Placed], count: usize) -> Vec<(usize, usize)> {
    let n = placed.len();
    let count = count.min(n.saturating_sub(1));
    let place = |k: usize| {
        let p = &placed[k];
        let at = |v: &Int| Rat::new(v.clone(), p.q.clone());
        Vec2::new(at(&p.place[0]), at(&p.place[1]))
    };
    let exact: Vec<Vec2> = (0..n).map(place).collect();
    let near: Vec<[f64; 2]> = exact.iter().map(super::shape::doubles).collect();
    // How far a squared distance in doubles may be off: coordinates by their rounding, the rest by its own.
    let size = near.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
    let blur = size * 2f64.powi(-50) + f64::MIN_POSITIVE;
    let error = |d: f64| 8.0 * blur * (d.sqrt() + 2.0 * blur) + d * 2f64.powi(-48);
    let mut out = Vec::with_capacity(n * count);
    for i in 0..n {
        let mut others: Vec<(f64, usize)> = (0..n)
            .filter(|&j| j != i)
            .map(|j| {
                let (dx, dy) = (near[j][0] - near[i][0], near[j][1] - near[i][1]);
                (dx * dx + dy * dy, j)
            })
            .collect();
        let by = |x: &(f64, usize), y: &(f64, usize)| {
            // Also where a double overflowed and the difference is no number.
            let clear = (x.0 - y.0).abs() > error(x.0) + error(y.0);
            if !clear {
                let square = |j: usize| (&exact[j] - &exact[i]).norm2();
                square(x.1).cmp(&square(y.1)).then(x.1.cmp(&y.1))
            } else {
                x.0.total_cmp(&y.0)
            }
        };
        if count < others.len() && count > 0 {
            // Exact comparisons only among those that may be chosen.
            others.select_nth_unstable_by(count - 1, |x, y| x.0.total_cmp(&y.0));
            let edge = others[count - 1].0;
            let far = |d: f64| d - error(d) > edge + error(edge);
            others.retain(|o| !far(o.0));
        }
        others.sort_by(by);
        out.extend(
            others
                .iter()
                .take(count)
                .map(|&(_, j)| (i.min(j), i.max(j))),
        );
    }
    out
}

/// Keeps two bodies apart by that edge of either from which the other is farthest.
fn separate(scaffold: &Scaffold, placed: &[Placed], a: usize, b: usize, out: &mut Vec<Pair>) {
    let mut best: Option<(f64, usize, usize, usize)> = None;
    for (line, point) in [(a, b), (b, a)] {
        let shape = &scaffold.shapes[line];
        for k in 0..shape.len() {
            let normal = placed[line].unit(&shape.normals[k]);
            let from = placed[line].near[k];
            let least = placed[point]
                .near
                .iter()
                .map(|p| normal[0] * (p[0] - from[0]) + normal[1] * (p[1] - from[1]))
                .fold(f64::INFINITY, f64::min);
            if best.is_none_or(|b| least > b.0) {
                best = Some((least, line, k, point));
            }
        }
    }
    let Some((_, line, k, point)) = best else {
        return;
    };
    for v in 0..scaffold.shapes[point].len() {
        if scaffold.shapes[point].corners[v] == Corner::Convex {
            out.push(Pair {
                line_body: line as u32,
                plane: Plane::Edge(k as u32),
                point_body: point as u32,
                point: Point::Vertex(v as u32),
            });
        }
    }
}

/// Whether, where pairs are found by closeness, a long step has brought bodies together that had
/// no constraint between them: a convex vertex lies deeper inside another body than allowed. In
/// doubles: it only shortens a step whose result is judged exactly anyway.
pub(crate) fn too_deep(scaffold: &Scaffold, placed: &[Placed], allowed: f64) -> bool {
    if scaffold.joints.is_some() {
        return false;
    }
    let boxes: Vec<Box2> = placed.iter().map(box_of).collect();
    meeting(&boxes, -allowed).into_iter().any(|(a, b)| {
        let fixed = scaffold.forms[a] == Form::Fixed && scaffold.forms[b] == Form::Fixed;
        !fixed
            && (deepest(scaffold, placed, a, b) > allowed
                || deepest(scaffold, placed, b, a) > allowed)
    })
}

/// How deep the deepest convex vertex of b lies inside a; negative where none does.
fn deepest(scaffold: &Scaffold, placed: &[Placed], a: usize, b: usize) -> f64 {
    let ring = &placed[a].near;
    let mut most = -1.0f64;
    for (v, p) in placed[b].near.iter().enumerate() {
        if scaffold.shapes[b].corners[v] != Corner::Convex {
            continue;
        }
        let (mut inside, mut depth) = (false, f64::INFINITY);
        for (k, from) in ring.iter().enumerate() {
            let to = ring[(k + 1) % ring.len()];
            let (ex, ey) = (to[0] - from[0], to[1] - from[1]);
            let (px, py) = (p[0] - from[0], p[1] - from[1]);
            let t = ((px * ex + py * ey) / (ex * ex + ey * ey)).clamp(0.0, 1.0);
            depth = depth.min((px - t * ex).hypot(py - t * ey));
            let spans = (from[1] > p[1]) != (to[1] > p[1]);
            if spans && px < ex * py / ey {
                inside = !inside;
            }
        }
        if inside {
            most = most.max(depth);
        }
    }
    most
}

impl Placed {
    /// A normal of the shape's frame, turned, of length one.
    pub(crate) fn unit(&self, normal: &IntVec) -> [f64; 2] {
        let (x, y) = unit(normal);
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }
}

/// An integer vector made as long as one, in doubles.
pub(crate) fn unit(v: &IntVec) -> (f64, f64) {
    let shift = v[0].bits().max(v[1].bits()).saturating_sub(60);
    let cut = |v: &Int| v.shr(shift).to_i64().unwrap_or(0) as f64;
    let (x, y) = (cut(&v[0]), cut(&v[1]));
    let length = x.hypot(y);
    (x / length, y / length)
}

/// The averaged normal of a convex corner, as an integer vector: n₁/|n₁| + n₂/|n₂| times a
/// positive factor. Exact where both lengths are rational; else each unit vector is taken with
/// an error of at most 2⁻³⁰ in each part, which turns the average by less than 2⁻²⁹/cos(α/2),
/// α the angle between the normals. Any normal between the two is a sound choice.
pub(crate) fn averaged(first: &IntVec, second: &IntVec) -> IntVec {
    let square = |v: &IntVec| dot(v, v);
    let (s1, s2) = (square(first), square(second));
    if let (Some(l1), Some(l2)) = (s1.sqrt_exact(), s2.sqrt_exact()) {
        let part = |k: usize| &first[k] * &l2 + &second[k] * &l1;
        return super::shape::primitive([part(0), part(1)]);
    }
    let rounded = |v: &IntVec, s: &Int, k: usize| {
        // floor(2³⁰·|v|/√s), as √ of an integer quotient; then the sign.
        let top = (&v[k] * &v[k]).shl(60);
        let (q, _) = top.div_rem_floor(s);
        let root = q.sqrt().unwrap_or_else(Int::zero);
        if v[k].sign() < 0 { -root } else { root }
    };
    let part = |k: usize| rounded(first, &s1, k) + rounded(second, &s2, k);
    super::shape::primitive([part(0), part(1)])
}
