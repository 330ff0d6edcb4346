//! One joint: its rows with proven slack, and a region that no path leaves.
//!
//! *When does a vertex v of one body stay outside an edge e of the other,* outer normal n, while
//! both move without collision? Let P be the states in which v's foot is on the closed edge and v
//! is not behind its line; v starts so. It can leave P only by crossing the line:
//!
//! - with its foot inside the edge: behind lies the solid, so v would enter it.
//! - past a reflex end c, along a way on which the line runs inside the solid: v would be in the
//!   solid already; at c itself all that lies behind the line near c is solid.
//! - past a convex end c, by τ: let an edge g of v run back along e, at an angle of at most Ψ to
//!   it, its own body on the side of n. Enlarge P by the states with v past c and c not on the
//!   inner side of g. There v is at most τ·tan Ψ behind the line of e, for g climbs no more on its
//!   way from v to c. How is the enlarged P left? By c passing through g, between its ends if
//!   τ/cos Ψ < |g|: then c enters the other solid. Or from v = c: then g, which leaves v at an
//!   angle of at most Ψ to e, runs on into the solid behind e at c, if the solid's angle at c is
//!   larger than Ψ. Either is a collision.
//!
//! A vertex of which none can be said gives no row, which only makes the bound larger.
//!
//! *The slack.* With |n| = 1, the vertex at r from the centre of what turns, d differs from its
//! linear part by −(1 − cos φ) n·r + (sin φ − φ) n·r⊥; where the line is the turning body's, also
//! by (1 − cos φ) n·Δξ ± sin φ Δξ·e.

use super::above::Above;
use crate::flex::model::{Form, Row, Scaffold};
use crate::flex::pairs::{Plane, Point, select};
use crate::flex::shape::{IntVec, Placed};
use crate::geometry::{Corner, Vec2};
use crate::lp::{self, Model, Range, Status};
use crate::number::{Interval, Rat};
use std::collections::BTreeMap;

/// A joint with the region that no path leaves.
pub(super) struct Hinge {
    pub(super) a: usize,
    pub(super) b: usize,
    pub(super) rows: Vec<Sighted>,
    /// |Δξ| ≤ shift in x and in y, |φ| ≤ turn.
    pub(super) shift: [Above; 2],
    pub(super) turn: Above,
    pub(super) dropped: usize,
}

/// A row of a joint: exact for the program, enclosed for the slack.
pub(super) struct Sighted {
    row: Row,
    /// Whether the line is body a's.
    of_first: bool,
    /// The length of the row's normal.
    length: Above,
    /// Coefficient of φ when x₂ − x₁ and θ_B − θ_A are the variables.
    phi: Rat,
    /// From the turning centre to what turns: its length, how far it points against the normal,
    /// and its part along the edge.
    arm: Above,
    inward: Above,
    along: Above,
    /// How fast the foot runs along the edge as the body turns.
    swing: Above,
    /// The edge's direction, part by part.
    unit: [Above; 2],
    /// From the edge's start to the foot, from the foot to its end.
    room: [Interval; 2],
    /// What happens past either end.
    ends: [Past; 2],
}

/// Past an end of an edge.
#[derive(Clone, Debug)]
enum Past {
    /// The line goes on inside the solid at least this far.
    Solid(f64),
    /// An edge of the vertex runs back along it.
    Along(Back),
    /// Nothing is known.
    Open,
}

/// An edge of the vertex that runs back along the edge at the start.
#[derive(Clone, Debug)]
struct Back {
    /// The tangent of the angle between them.
    tangent: Above,
    /// Its length at least.
    length: f64,
    /// The tangent of the solid's angle at the end at least; infinite from a right angle on.
    corner: f64,
}

/// The pairs of bodies that constrain each other, with their rows.
pub(super) fn hinges(scaffold: &Scaffold, placed: &[Placed]) -> Vec<Hinge> {
    let selection = select(scaffold, placed, &Rat::zero());
    let rings: Vec<Vec<Vec2>> = placed
        .iter()
        .map(|p| (0..p.offsets.len()).map(|k| p.vertex(k)).collect())
        .collect();
    let mut by_pair: BTreeMap<(usize, usize), Vec<Sighted>> = BTreeMap::new();
    for pair in &selection.pairs {
        let (Plane::Edge(k), Point::Vertex(v)) = (pair.plane, pair.point) else {
            continue;
        };
        let (one, two) = (pair.line_body as usize, pair.point_body as usize);
        if scaffold.forms[one] == Form::Fixed && scaffold.forms[two] == Form::Fixed {
            continue;
        }
        let row = scaffold.row(pair, placed);
        // A vertex that starts behind the line is not held by this edge.
        if row.d0.sign() < 0 {
            continue;
        }
        let look = Look {
            scaffold,
            placed,
            rings: &rings,
            one,
            k: k as usize,
            two,
            v: v as usize,
        };
        by_pair
            .entry((one.min(two), one.max(two)))
            .or_default()
            .push(look.sight(row));
    }
    by_pair
        .into_iter()
        .map(|((a, b), rows)| Hinge {
            a,
            b,
            rows,
            shift: [Above::INFINITY; 2],
            turn: Above::INFINITY,
            dropped: 0,
        })
        .collect()
}

/// Edge k of body `one` and vertex v of body `two`, where they start.
struct Look<'a> {
    scaffold: &'a Scaffold,
    placed: &'a [Placed],
    rings: &'a [Vec<Vec2>],
    one: usize,
    k: usize,
    two: usize,
    v: usize,
}

impl Look<'_> {
    fn sight(&self, row: Row) -> Sighted {
        let of_first = self.one < self.two;
        let ring = &self.rings[self.one];
        let next = (self.k + 1) % ring.len();
        let (start, end) = (&ring[self.k], &ring[next]);
        let at = &self.rings[self.two][self.v];
        let edge = end - start;
        let edge_length = edge.norm2().interval().sqrt();
        // With θ_A = 0 the row is n·Δξ + θ₂φ for the first body's line; for the second's the
        // frame turns against the line: −n·Δξ + θ₁φ with the same integers.
        let (phi, centre) = if of_first {
            (&row.theta2, place(&self.placed[self.two]))
        } else {
            (&row.theta1, place(&self.placed[self.one]))
        };
        let arm = at - &centre;
        let outward = vector(&self.turned_normal(self.one, self.k));
        let over = |v: Rat, by: &Interval| v.interval() / *by;
        let outward_length = outward.norm2().interval().sqrt();
        let [x, y] = &row.normal;
        Sighted {
            of_first,
            length: Above::size(&Rat::from(x * x + y * y).interval().sqrt()),
            phi: Rat::from(phi.clone()),
            arm: Above::size(&arm.norm2().interval().sqrt()),
            inward: Above::positive(&-over(arm.dot(&outward), &outward_length)),
            along: Above::size(&over(arm.dot(&edge), &edge_length)),
            swing: Above::size(&over(arm.cross(&edge), &edge_length)),
            unit: [
                Above::size(&over(edge.x.clone(), &edge_length)),
                Above::size(&over(edge.y.clone(), &edge_length)),
            ],
            room: [
                over((at - start).dot(&edge), &edge_length),
                over((end - at).dot(&edge), &edge_length),
            ],
            ends: [
                self.past(self.k, &-&edge, &edge_length),
                self.past(next, &edge, &edge_length),
            ],
            row,
        }
    }

    /// The outer normal of an edge as it stands, times a positive number.
    fn turned_normal(&self, body: usize, edge: usize) -> IntVec {
        self.placed[body]
            .turn
            .apply(&self.scaffold.shapes[body].normals[edge])
    }

    /// What is past the end at a corner; `out` leads there along the edge, as long as the edge.
    fn past(&self, corner: usize, out: &Vec2, length: &Interval) -> Past {
        match self.scaffold.shapes[self.one].corners[corner] {
            Corner::Straight => Past::Open,
            Corner::Reflex => match self.solid(corner, out) {
                Some(part) => Past::Solid((part.interval() * *length).lo),
                None => Past::Open,
            },
            Corner::Convex => self.back(corner, out).map_or(Past::Open, Past::Along),
        }
    }

    /// How far the line of the edge goes on inside the solid past a reflex corner, over |out|.
    fn solid(&self, corner: usize, out: &Vec2) -> Option<Rat> {
        let ring = &self.rings[self.one];
        let n = ring.len();
        let tip = &ring[corner];
        // Where each vertex lies beside the line and along it.
        let seen: Vec<(Rat, Rat)> = ring
            .iter()
            .map(|w| {
                let d = w - tip;
                (out.cross(&d), out.dot(&d))
            })
            .collect();
        let square = out.norm2();
        let mut least: Option<Rat> = None;
        for k in 0..n {
            let next = (k + 1) % n;
            if k == corner || next == corner {
                continue;
            }
            let ((s, t), (s2, t2)) = (&seen[k], &seen[next]);
            let mut meets = Vec::new();
            if s.is_zero() {
                meets.push(t.clone());
            }
            if s2.is_zero() {
                meets.push(t2.clone());
            }
            if s.sign() * s2.sign() < 0 {
                meets.push((t * s2 - t2 * s) / (s2 - s));
            }
            for t in meets {
                if t.sign() > 0 && least.as_ref().is_none_or(|l| t < *l) {
                    least = Some(t);
                }
            }
        }
        least.map(|t| t / square)
    }

    /// An edge of the vertex that runs back along the edge past a convex corner.
    fn back(&self, corner: usize, out: &Vec2) -> Option<Back> {
        let (ring, mine) = (&self.rings[self.one], &self.rings[self.two]);
        let (n, m) = (ring.len(), mine.len());
        let before = (self.v + m - 1) % m;
        let at = &mine[self.v];
        let outward = vector(&self.turned_normal(self.one, self.k));
        let inner = -out;
        let candidates = [(self.v, (self.v + 1) % m), (before, before)];
        let best = candidates
            .into_iter()
            .filter_map(|(edge, far)| {
                let g = &mine[far] - at;
                let forward = g.dot(&inner);
                let away = vector(&self.turned_normal(self.two, edge));
                if forward.sign() <= 0 || away.dot(&outward).sign() >= 0 {
                    return None;
                }
                // The start must be one of the states meant: not past the corner with the corner
                // on the inner side.
                let ahead = at - &ring[corner];
                if ahead.dot(out).sign() > 0 && ahead.dot(&away).sign() > 0 {
                    return None;
                }
                let tangent = Above::of_rat(&(g.cross(&inner) / forward));
                Some((tangent, g.norm2().interval().sqrt().lo))
            })
            .min_by(|a, b| a.0.get().total_cmp(&b.0.get()))?;
        // The corner's other neighbour: the one that is not the edge's other end.
        let (left, right) = ((corner + n - 1) % n, (corner + 1) % n);
        let other = if corner == self.k { left } else { right };
        let side = &ring[other] - &ring[corner];
        let forward = side.dot(&inner);
        let solid = if forward.sign() <= 0 {
            f64::INFINITY
        } else {
            (side.cross(&inner).abs() / forward).interval().lo
        };
        Some(Back {
            tangent: best.0,
            length: best.1,
            corner: solid,
        })
    }
}

/// Where the reference point stands.
pub(super) fn place(p: &Placed) -> Vec2 {
    let at = |k: usize| Rat::new(p.place[k].clone(), p.q.clone());
    Vec2::new(at(0), at(1))
}

fn vector(v: &IntVec) -> Vec2 {
    Vec2::new(Rat::from(v[0].clone()), Rat::from(v[1].clone()))
}

impl Sighted {
    /// By how much the linear part may fall below zero in a region, as a distance; None where the
    /// vertex may get behind the line there.
    pub(super) fn slack(&self, shift: [Above; 2], turn: Above) -> Option<Above> {
        // |Δξ| ≤ |Δξ_x| + |Δξ_y| would do; the root is nearer.
        let square = shift[0].square() + shift[1].square();
        let size = Above::of(square.interval().sqrt().hi);
        let slide = shift[0] * self.unit[0] + shift[1] * self.unit[1];
        // How far the foot may move along the edge, seen from the edge's body.
        let moved = slide + size * turn + self.swing * turn + self.arm * turn.versine();
        let mut extra = Above::ZERO;
        for (past, room) in self.ends.iter().zip(&self.room) {
            let over = Above::of((moved.interval() - *room).hi);
            if moved.is_finite() && room.lo > moved.get() {
                continue;
            }
            match past {
                Past::Solid(depth) if over.get() < *depth => {}
                Past::Along(back) => extra = extra.max(back.behind(over, turn)?),
                _ => return None,
            }
        }
        let curved = self.inward * turn.versine() + self.along * turn.cubic();
        let mixed = if self.of_first {
            Above::ZERO
        } else {
            slide * turn + size * turn.versine()
        };
        Some(curved + mixed + extra)
    }

    /// Coefficients of Δξ and of φ.
    pub(super) fn entries(&self) -> ([Rat; 2], &Rat) {
        let sign = if self.of_first {
            Rat::one()
        } else {
            -Rat::one()
        };
        let part = |k: usize| Rat::from(self.row.normal[k].clone()) * sign.clone();
        ([part(0), part(1)], &self.phi)
    }

    /// The right-hand side −d₀ − slack; None where the slack is without bound.
    pub(super) fn lower(&self, slack: Above) -> Option<Rat> {
        let back = slack.rational()? * self.length.rational()?;
        Some(-(Rat::from(self.row.d0.clone()) + back))
    }
}

impl Back {
    /// How far the vertex may be behind the line, past the end by no more than `over`.
    fn behind(&self, over: Above, turn: Above) -> Option<Above> {
        // tan(ψ + φ) = (tan ψ + tan φ) / (1 − tan ψ tan φ).
        let t = turn.tangent();
        let bottom = Interval::point(1.0) - (self.tangent * t).interval();
        if bottom.lo <= 0.0 {
            return None;
        }
        let steep = Above::of(((self.tangent + t).interval() / bottom).hi);
        let reach = over * Above::of((Above::of(1.0) + steep.square()).interval().sqrt().hi);
        (steep.get() < 1.0 && steep.get() < self.corner && reach.get() < self.length)
            .then(|| over * steep)
    }
}

/// Rounds of widening before a joint is given up, of narrowing afterwards.
const WIDEN: usize = 12;
const NARROW: usize = 3;
/// Joints that may turn farther are given up.
const WIDEST: f64 = 0.5;

impl Hinge {
    /// Whether a region was found that no path leaves.
    pub(super) fn holds(&self) -> bool {
        self.turn.is_finite()
    }

    /// Finds a region that no path leaves; leaves it infinite where there is none.
    pub(super) fn settle(&mut self) {
        let Some(mut guess) = self.extent(None) else {
            return;
        };
        for _ in 0..WIDEN {
            let wider = |v: Above| Above::of(v.get() * 1.25 + 1e-9);
            guess = (guess.0.map(wider), wider(guess.1));
            let Some(found) = self.extent(Some(guess)) else {
                return;
            };
            if found.0[0] < guess.0[0] && found.0[1] < guess.0[1] && found.1 < guess.1 {
                (self.shift, self.turn) = found;
                break;
            }
            for k in 0..2 {
                guess.0[k] = guess.0[k].max(found.0[k]);
            }
            guess.1 = guess.1.max(found.1);
            let finite = guess.0.iter().all(|v| v.is_finite());
            if !finite || guess.1.get() > WIDEST {
                return;
            }
        }
        for _ in 0..NARROW {
            if !self.holds() {
                return;
            }
            if let Some(found) = self.extent(Some((self.shift, self.turn))) {
                for k in 0..2 {
                    self.shift[k] = self.shift[k].min(found.0[k]);
                }
                self.turn = self.turn.min(found.1);
            }
        }
        let open = |r: &&Sighted| r.slack(self.shift, self.turn).is_none();
        self.dropped = self.rows.iter().filter(open).count();
    }

    /// The largest |Δξ| and |φ| of the polyhedron that a region's slack gives, rounded upwards;
    /// without a region, that of the linear parts, for a first guess.
    fn extent(&self, region: Option<([Above; 2], Above)>) -> Option<([Above; 2], Above)> {
        let mut model = Model::new("joint");
        model.maximise = true;
        for name in ["x", "y", "t"] {
            model.add_column(name, Rat::zero(), Range::free());
        }
        for (k, r) in self.rows.iter().enumerate() {
            let slack = match region {
                None => Some(Above::ZERO),
                Some((shift, turn)) => r.slack(shift, turn),
            };
            let Some(lower) = slack.and_then(|s| r.lower(s)) else {
                continue;
            };
            let row = model.add_row(&format!("r{k}"), Range::at_least(lower));
            let ([x, y], phi) = r.entries();
            model.set(row, 0, x);
            model.set(row, 1, y);
            model.set(row, 2, phi.clone());
        }
        let mut most = [Above::ZERO; 3];
        let mut basis = None;
        for (column, most) in most.iter_mut().enumerate() {
            for sign in [1, -1] {
                for (k, c) in model.columns.iter_mut().enumerate() {
                    c.cost = if k == column {
                        Rat::from(sign)
                    } else {
                        Rat::zero()
                    };
                }
                let outcome = lp::solve(
                    &model,
                    &lp::Options {
                        method: lp::Method::Exact,
                        basis: basis.take(),
                        ..lp::Options::default()
                    },
                );
                if outcome.status != Status::Optimal {
                    return None;
                }
                let value = outcome.objective.as_ref();
                let value = value.map_or(Above::INFINITY, |v| Above::positive(&v.interval()));
                *most = most.max(value);
                basis = outcome.basis;
            }
        }
        Some(([most[0], most[1]], most[2]))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::flex::generate::generate;
    use crate::flex::shape::Pose;
    use crate::geometry::interiors_intersect;

    /// Walks of one body of a joint that never overlaps the other, pushed at random into its
    /// corners, never leave the region and never break a row of the polyhedron. The margins that
    /// were left, without the slack, are returned.
    fn walk(family: &str, bodies: usize, draw: &mut dyn FnMut() -> f64) -> Vec<f64> {
        let s = generate(family, bodies, 3).unwrap();
        let scaffold = Scaffold::new(&s);
        let placed = scaffold.place(&scaffold.start);
        let mut hinges = hinges(&scaffold, &placed);
        let mut margins = Vec::new();
        for h in hinges.iter_mut().take(3) {
            h.settle();
            assert!(h.holds(), "{family}");
            let still = placed[h.a].polygon();
            let turn = h.turn.get();
            let mut at = scaffold.start[h.b].clone();
            for _ in 0..4 {
                // A push that is kept for a while slides along what it meets.
                let push = [draw(), draw(), 2.0 * draw()];
                for step in 0..80 {
                    let part = [0.3, 0.08, 0.02, 0.005][step % 4];
                    let mut by = |k: usize| (push[k] + 0.4 * draw()) * part;
                    let shift = [0, 1].map(|k| by(k) * h.shift[k].get());
                    let mut next = at.clone();
                    next.place.x += Rat::from_f64((shift[0] * 1e9).round() / 1e9);
                    next.place.y += Rat::from_f64((shift[1] * 1e9).round() / 1e9);
                    let half = Rat::from_f64((by(2) * turn * 5e8).round() / 1e9);
                    next.tan_half =
                        (&next.tan_half + &half) / (Rat::one() - &next.tan_half * &half);
                    let there = Placed::new(&scaffold.shapes[h.b], &next);
                    if !interiors_intersect(&still, &there.polygon()) {
                        at = next;
                        margins.push(kept(h, &scaffold.start[h.b], &at));
                    }
                }
            }
        }
        margins
    }

    /// The least margin of the region and of the polyhedron's rows at a pose.
    fn kept(h: &Hinge, start: &Pose, at: &Pose) -> f64 {
        let double = |r: &Rat| r.nearest_f64().unwrap();
        let shift = [&at.place.x - &start.place.x, &at.place.y - &start.place.y];
        let phi = 2.0 * double(&crate::flex::model::turned_by(start, at)).atan();
        for (at, most) in shift.iter().zip(&h.shift) {
            assert!(double(at).abs() <= most.get());
        }
        assert!(phi.abs() <= h.turn.get());
        let mut least = f64::INFINITY;
        for r in &h.rows {
            let Some(lower) = r.slack(h.shift, h.turn).and_then(|s| r.lower(s)) else {
                continue;
            };
            let ([x, y], turned) = r.entries();
            let value = double(&(&x * &shift[0] + &y * &shift[1])) + double(turned) * phi;
            let scale = r.length.get();
            let margin = (value - double(&lower)) / scale;
            assert!(margin >= -1e-12, "a row is broken: {margin}");
            // How far the linear part alone went below zero: what the slack is for.
            least = least.min((value + double(&Rat::from(r.row.d0.clone()))) / scale);
        }
        least
    }

    #[test]
    fn no_walk_breaks_a_row() {
        let mut seed = 11u64;
        let mut draw = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / f64::from(1u32 << 30) - 1.0
        };
        let mut all = Vec::new();
        for (family, bodies) in [("grid", 4), ("jit", 4), ("jrot", 4), ("chain", 3)] {
            all.extend(walk(family, bodies, &mut draw));
        }
        assert!(all.len() > 150, "{}", all.len());
        // Somewhere the linear part alone is broken, so the slack is needed.
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least < 0.0, "{least}");
    }
}
