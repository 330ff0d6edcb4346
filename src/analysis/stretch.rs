//! Sliding stretches: what forces and friction need to know of a trajectory's sliding segments.
//!
//! # The balance (DP App. A, derived anew)
//!
//! Let r point from the hinge to the contact and N be the unit normal along which the obstacle
//! pushes the pawl: the obstacle's outward normal n for type B, −R m for type A, m being the
//! pawl edge's outward normal. The pawl's material point at the contact slides with velocity
//! ṗ + θ̇·ẑ×r = s·x̂, where x̂ ⟂ N: friction pushes against it. With σ = sgn s,
//!
//! ```text
//! f = λ(N − μσx̂),  λ ≥ 0,      r × f = kθ      (the spring's torque on the pawl is −kθ)
//! ```
//!
//! The velocity has no component along ẑ×r… except the turning itself, so s·(r·x̂) = ṗ·r =: d
//! for both types: what rubs is decided by the sign of d. Let F be the C-function with n or m
//! unnormalised, F_θ its derivative by θ, and ρ_y = R a·n (type B) or e = q·R m (type A, constant
//! on the curve). Then |F_θ| = |n|·|r·x̂|, and the sign of F_θ at a contact that holds the pawl is
//! that of θ. Put in:
//!
//! ```text
//! |f| = √(1+μ²)·|n|·k|θ| / (|F_θ| + ε·μ·sgn(d)·ρ_y),     ε = +1 for type B, −1 for type A
//! ```
//!
//! The denominator is positive while the contact slides, zero on the cone's ray, and the sticking
//! cone is where it is negative: the rules of [`crate::motion::friction`] found again, and
//! with them the critical coefficient |F_θ|/|ρ_y| wherever ε·sgn(d)·ρ_y < 0.
//!
//! A stretch is the part of a segment that lies in one chart, where all of this is a quotient of
//! polynomials in the chart position x, and x is monotone.

use super::fix::{Bits, Fix};
use super::qpoly::QPoly;
use crate::contact::{Chart, Contact, ContactKind, ObstacleShape, PawlShape, Trig};
use crate::geometry::Vec2;
use crate::motion::{Angle, PawlTrace, Segment, Trajectory};
use crate::number::{Algebraic, Int, Poly, Rat};
use crate::scene::Scene;
use crate::slice::Time;

/// A part of a sliding segment in one chart.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Index of the pawl.
    pub pawl: usize,
    /// Index of the segment in the pawl's history.
    pub segment: usize,
    /// In which phase.
    pub phase: usize,
    /// The contact that holds.
    pub contact: Contact,
    /// Which half-turn: θ = π·half_turn + 2·atan(x).
    pub half_turn: i64,
    /// Position where it begins and where it ends in time.
    pub x: [Algebraic; 2],
    /// When, from the start of the phase.
    pub t: [Time; 2],
    /// Sign of θ.
    pub side: i32,
    pub(super) law: Law,
    /// Who touches whom; None on an angular stop.
    pub(super) touch: Option<Touch>,
    /// The root's velocity.
    pub(super) velocity: Vec2,
    p: [Int; 3],
    q: [Int; 3],
    branch: i32,
}

/// The geometry of a contact.
#[derive(Clone, Debug)]
pub(super) enum Touch {
    /// The pawl's vertex a, from its hinge, on an edge with outward normal n.
    B { a: Vec2, n: Vec2 },
    /// The pawl's edge with outward normal m on a vertex at w from the hinge at the phase's start.
    A { m: Vec2, w: Vec2 },
}

impl Stretch {
    /// Whether θ stands still.
    pub(super) fn still(&self) -> bool {
        self.x[0] == self.x[1]
    }
    pub(super) fn curve(&self) -> Curve<'_> {
        Curve {
            p: &self.p,
            q: &self.q,
            branch: self.branch,
        }
    }
    /// t = −p/q in the chart; None on an angular stop.
    pub(super) fn clock(&self) -> Option<&(QPoly, QPoly)> {
        match &self.law {
            Law::Graph { clock, .. } => Some(clock),
            _ => None,
        }
    }
    /// Where d vanishes inside, in order of time: the variable (x, or t where θ stands still) and
    /// the instant.
    pub(super) fn reversals(&self) -> Vec<(Algebraic, Time)> {
        let (lo, hi) = if self.x[0] <= self.x[1] {
            (&self.x[0], &self.x[1])
        } else {
            (&self.x[1], &self.x[0])
        };
        match &self.law {
            Law::Graph { drag, clock, .. } if lo != hi && !drag.poly().is_zero() => {
                let roots = drag.poly().real_roots_in(&Rat::from(-1), &Rat::one());
                let (p, q) = QPoly::pair(&clock.0.scale(&Rat::from(-1)), &clock.1);
                let mut at: Vec<_> = roots
                    .into_iter()
                    .filter(|x| lo < x && x < hi)
                    .map(|x| {
                        let t = Time::ratio(&x, p.clone(), q.clone());
                        (x, t)
                    })
                    .collect();
                if self.x[0] > self.x[1] {
                    at.reverse();
                }
                at
            }
            Law::Level { drag, .. } => {
                let roots = drag.poly().real_roots().into_iter();
                let (begin, end) = (self.t[0].exact(), self.t[1].exact());
                let inside = roots.filter(|t| begin < t && t < end);
                inside.map(|t| (t.clone(), Time::at(t))).collect()
            }
            _ => Vec::new(),
        }
    }
    /// The sign of d between two places (x, or t where θ stands still).
    pub(super) fn drag_between(&self, a: &Algebraic, b: &Algebraic) -> i32 {
        let within = |a: &Algebraic, b: &Algebraic| match a.cmp(b) {
            std::cmp::Ordering::Less => Algebraic::between(a, b),
            std::cmp::Ordering::Greater => Algebraic::between(b, a),
            std::cmp::Ordering::Equal => a.enclosure(64).0,
        };
        match &self.law {
            Law::Graph { drag, .. } if self.still() => self.x[0].sign_of(&drag.poly()),
            Law::Graph { drag, .. } => drag.eval(&within(a, b)).sign(),
            Law::Level { drag, .. } => drag.eval(&within(a, b)).sign(),
            Law::Stop => 0,
        }
    }
}

/// |F_θ|, ρ_y and d along a stretch.
#[derive(Clone, Debug)]
pub(super) enum Law {
    /// F_θ = turn/den, ρ_y = rise/den, and d has the sign of `drag`; den > 0 inside.
    Graph {
        turn: QPoly,
        rise: QPoly,
        den: QPoly,
        drag: QPoly,
        /// t = −p/q.
        clock: (QPoly, QPoly),
        epsilon: i32,
        normal2: Rat,
    },
    /// Type A at constant θ: F_θ² = turn2(t), ρ_y = e, d = drag(t).
    Level {
        turn2: QPoly,
        e: Rat,
        drag: QPoly,
        normal2: Rat,
    },
    /// On an angular stop: no obstacle, no contact force.
    Stop,
}

/// All stretches of a trajectory, by pawl and in order of time.
pub fn stretches(
    scene: &Scene,
    shapes: &[PawlShape],
    obstacles: &[ObstacleShape],
    run: &Trajectory,
) -> Vec<Stretch> {
    let mut out = Vec::new();
    for (i, pawl) in run.pawls.iter().enumerate() {
        for (j, segment) in pawl.segments.iter().enumerate() {
            let Some(sliding) = &segment.sliding else {
                continue;
            };
            let phase = &run.phases[segment.phase];
            let world = World {
                p0: &scene.pawls[i].hinge + &phase.offset,
                v: phase.velocity.clone(),
                contact: sliding.contact,
                shape: &shapes[i],
                obstacles,
                p: &sliding.p,
                q: &sliding.q,
            };
            let curve = Curve {
                p: &sliding.p,
                q: &sliding.q,
                branch: sliding.branch,
            };
            let from = known(pawl, segment, false)
                .unwrap_or_else(|| curve.angle(segment, &segment.from, segment.winding[0]));
            let to = known(pawl, segment, true)
                .unwrap_or_else(|| curve.angle(segment, &segment.to, segment.winding[1]));
            let place = Stretch {
                pawl: i,
                segment: j,
                phase: segment.phase,
                contact: sliding.contact,
                half_turn: 0,
                x: [from.x.clone(), to.x.clone()],
                t: [segment.from.clone(), segment.to.clone()],
                side: 0,
                law: Law::Stop,
                touch: world.touch(),
                velocity: phase.velocity.clone(),
                p: sliding.p.clone(),
                q: sliding.q.clone(),
                branch: sliding.branch,
            };
            world.split(&from, &to, &place, &mut out);
        }
    }
    out
}

/// The orientation at a segment's end (`late`) or beginning, where an event tells it.
fn known(pawl: &PawlTrace, segment: &Segment, late: bool) -> Option<Angle> {
    let at = if late { &segment.to } else { &segment.from };
    let mut then = pawl
        .events
        .iter()
        .filter(|e| e.phase == segment.phase && e.time == *at && e.root_contacts.is_empty());
    if late {
        then.next().map(|e| e.angle.clone())
    } else {
        then.next_back()
            .map(|e| e.to.clone().unwrap_or_else(|| e.angle.clone()))
    }
}

pub(super) struct Curve<'a> {
    p: &'a [Int; 3],
    q: &'a [Int; 3],
    branch: i32,
}

impl Curve<'_> {
    fn in_chart(c: &[Int; 3], chart: Chart) -> Poly {
        match chart {
            Chart::Rest => Poly::new(c.to_vec()),
            Chart::Back => Poly::new(vec![c[2].clone(), -&c[1], c[0].clone()]),
        }
    }
    /// The orientation at a rational instant.
    fn at(&self, t: &Rat, winding: i64) -> Option<Angle> {
        for chart in Chart::BOTH {
            let (p, q) = (Self::in_chart(self.p, chart), Self::in_chart(self.q, chart));
            let f = p.scale(t.denom()) + q.scale(t.numer());
            if f.is_zero() {
                continue;
            }
            let slope = f.derivative();
            for x in f.real_roots_in(&Rat::from(-1), &Rat::one()) {
                let s = x.sign_of(&slope);
                if s == 0 || s == self.branch || self.branch == 0 {
                    return Some(angle_of(chart, x, winding));
                }
            }
        }
        None
    }
    /// The orientation at an instant of the segment.
    fn angle(&self, segment: &Segment, t: &Time, winding: i64) -> Angle {
        let rational = t.as_rat().cloned().or_else(|| t.exact().to_rat());
        if let Some(r) = rational {
            return self.at(&r, winding).unwrap_or_else(Angle::rest);
        }
        // At constant θ any instant tells it: its place is a root of P and of Q.
        let mid = Time::between(&segment.from, &segment.to);
        if let Some(a) = self.at(&mid, winding) {
            let parts = [self.p, self.q].map(|c| Self::in_chart(c, a.chart()));
            let later = Time::between(&Time::from(mid.clone()), &segment.to);
            if parts.iter().all(|p| a.x.sign_of(p) == 0)
                && self.at(&later, winding).is_some_and(|b| b == a)
            {
                return a;
            }
        }
        // Else x = ±1 would make the instant rational, so refining settles the chart.
        let exact = t.exact();
        let place = |chart: Chart, bits: u32| {
            let (lo, hi) = exact.enclosure(bits);
            let b = Bits(u64::from(bits) + 16);
            self.enclosed(chart, &b.hull(&lo, &hi), b)
        };
        let mut bits = 32;
        loop {
            for chart in Chart::BOTH {
                let Some(x) = place(chart, bits) else {
                    continue;
                };
                if (bits < 1 << 14 || chart == Chart::Back)
                    && (x.lo() <= Rat::from(-1) || x.hi() >= Rat::one())
                {
                    continue;
                }
                let (p, q) = (Self::in_chart(self.p, chart), Self::in_chart(self.q, chart));
                let x = exact.root_over(&p, &q, &mut |bits| {
                    let mut more = bits;
                    loop {
                        if let Some(x) = place(chart, more) {
                            return (x.lo(), x.hi());
                        }
                        more *= 2;
                    }
                });
                return angle_of(chart, x, winding);
            }
            bits *= 2;
        }
    }
    /// The place in a chart at an enclosed instant of the segment; None where more bits are
    /// needed.
    pub(super) fn enclosed(&self, chart: Chart, t: &Fix, b: Bits) -> Option<Fix> {
        let (p, q) = (Self::in_chart(self.p, chart), Self::in_chart(self.q, chart));
        let [c, half, a] = [0, 1, 2].map(|k| {
            let at = |f: &Poly| b.rat(&Rat::from(f.coeff(k)));
            at(&p).add(&t.mul(&at(&q)))
        });
        let four = b.int(4);
        let root = half.mul(&half).sub(&four.mul(&a).mul(&c)).sqrt()?;
        let root = root.mul(&b.int(i64::from(self.branch)));
        let two = b.int(2);
        // Two forms of one root: each is poor where the other is good.
        let near = root.sub(&half).div(&a.mul(&two));
        let far = c.mul(&two).div(&half.add(&root).neg());
        match (near, far) {
            (Some(x), Some(y)) => Some(x.meet(&y)),
            (x, y) => x.or(y),
        }
    }
}

fn angle_of(chart: Chart, x: Algebraic, winding: i64) -> Angle {
    let half_turn = match chart {
        Chart::Rest => 2 * winding,
        Chart::Back if x.sign() > 0 => 2 * winding - 1,
        Chart::Back => 2 * winding + 1,
    };
    Angle { half_turn, x }
}

struct World<'a> {
    p0: Vec2,
    v: Vec2,
    contact: Contact,
    shape: &'a PawlShape,
    obstacles: &'a [ObstacleShape],
    p: &'a [Int; 3],
    q: &'a [Int; 3],
}

impl World<'_> {
    /// Cuts a segment at the seams between charts.
    fn split(&self, from: &Angle, to: &Angle, place: &Stretch, out: &mut Vec<Stretch>) {
        // On a seam the same orientation has two names; take the one that the other end shares.
        let step = match from.cmp(to) {
            std::cmp::Ordering::Equal => 0,
            std::cmp::Ordering::Less => 1,
            std::cmp::Ordering::Greater => -1,
        };
        let edge = |d: i64| Algebraic::from(Rat::from(d));
        let (mut half, mut x, mut t) = (from.half_turn, from.x.clone(), place.t[0].clone());
        loop {
            let last = half == to.half_turn || step == 0;
            let end = if last { to.x.clone() } else { edge(step) };
            let until = if last {
                place.t[1].clone()
            } else {
                self.time_at(Chart::of_half_turn(half), &Rat::from(step))
                    .unwrap_or_else(|| place.t[1].clone())
            };
            if t < until {
                let (x0, x1) = if step == 0 {
                    (x.clone(), x.clone())
                } else {
                    (x, end)
                };
                let mut s = place.clone();
                s.half_turn = half;
                s.t = [t, until.clone()];
                s.side = match half {
                    0 if x0.sign() != 0 => x0.sign(),
                    0 => x1.sign(),
                    h => h.signum() as i32,
                };
                s.law = self.law(Chart::of_half_turn(half), &x0, &x1);
                s.x = [x0, x1];
                out.push(s);
            }
            if last {
                return;
            }
            half += step;
            x = edge(-step);
            t = until;
        }
    }

    fn touch(&self) -> Option<Touch> {
        let Contact::Obstacle {
            obstacle,
            kind,
            ring,
            obstacle_feature,
            pawl_feature,
        } = self.contact
        else {
            return None;
        };
        let oring = &self.obstacles[obstacle as usize].rings[ring as usize];
        let (i, j) = (pawl_feature as usize, obstacle_feature as usize);
        Some(match kind {
            ContactKind::B => Touch::B {
                a: self.shape.ring.vertices[i].clone(),
                n: oring.normals[j].clone(),
            },
            ContactKind::A => Touch::A {
                m: self.shape.ring.normals[i].clone(),
                w: &oring.vertices[j] - &self.p0,
            },
        })
    }

    /// P and Q without their common factor, their quotient unchanged.
    fn reduced(&self, chart: Chart) -> (QPoly, QPoly) {
        let (p, q) = (
            Curve::in_chart(self.p, chart),
            Curve::in_chart(self.q, chart),
        );
        let (whole_p, whole_q) = (QPoly::of(&p), QPoly::of(&q));
        if q.is_zero() || p.is_zero() {
            return (whole_p, whole_q);
        }
        let g = p.gcd(&q);
        if g.degree() == Some(0) {
            return (whole_p, whole_q);
        }
        (whole_p.over(&g), whole_q.over(&g))
    }

    fn time_at(&self, chart: Chart, x: &Rat) -> Option<Time> {
        let (p, q) = self.reduced(chart);
        let den = q.eval(x);
        (!den.is_zero()).then(|| Time::from(-(p.eval(x) / den)))
    }

    fn law(&self, chart: Chart, x0: &Algebraic, x1: &Algebraic) -> Law {
        let Contact::Obstacle {
            obstacle,
            kind,
            ring,
            obstacle_feature,
            pawl_feature,
        } = self.contact
        else {
            return Law::Stop;
        };
        let oring = &self.obstacles[obstacle as usize].rings[ring as usize];
        let (i, j) = (pawl_feature as usize, obstacle_feature as usize);
        let form = |t: &Trig| QPoly(t.form(chart).to_vec());
        let one = QPoly(vec![Rat::one(), Rat::zero(), Rat::one()]);
        let v = &self.v;
        match kind {
            ContactKind::B => {
                let (a, n) = (&self.shape.ring.vertices[i], &oring.normals[j]);
                let rise = Trig::new(a.dot(n), a.cross(n), Rat::zero());
                let (p, q) = self.reduced(chart);
                Law::Graph {
                    turn: form(&rise.derivative()),
                    rise: form(&rise),
                    den: one,
                    drag: form(&Trig::new(a.dot(v), a.cross(v), Rat::zero())),
                    clock: (p, q),
                    epsilon: 1,
                    normal2: n.norm2(),
                }
            }
            ContactKind::A => {
                let m = &self.shape.ring.normals[i];
                let e = m.dot(&self.shape.ring.vertices[i]);
                let w = &oring.vertices[j] - &self.p0;
                let (vw, v2) = (v.dot(&w), v.norm2());
                let normal2 = m.norm2();
                if x0 == x1 {
                    let two = Rat::from(2);
                    return Law::Level {
                        turn2: QPoly(vec![
                            w.norm2() * &normal2 - e.square(),
                            -(&two * &vw * &normal2),
                            &v2 * &normal2,
                        ]),
                        e,
                        drag: QPoly(vec![vw, -v2]),
                        normal2,
                    };
                }
                let f0 = Trig::new(m.dot(&w), m.cross(&w), Rat::zero()).derivative();
                let f1 = Trig::new(-m.dot(v), -m.cross(v), Rat::zero()).derivative();
                let (p, q) = self.reduced(chart);
                let at = Algebraic::between(x0, x1);
                let sign = Rat::from(i64::from(q.eval(&at).sign()));
                let (p, q) = (p.scale(&sign), q.scale(&sign));
                let den = q.mul(&one);
                Law::Graph {
                    turn: form(&f0).mul(&q).sub(&p.mul(&form(&f1))),
                    rise: den.scale(&e),
                    den,
                    drag: q.scale(&vw).add(&p.scale(&v2)),
                    clock: (p, q),
                    epsilon: -1,
                    normal2,
                }
            }
        }
    }
}
