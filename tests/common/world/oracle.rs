//! The brute-force oracle: one pawl in one phase, looked at one instant at a time.
//!
//! It shares no approach with the engine: no curves over time, no arcs, no algebraic numbers. At a
//! fixed time all orientations at which any vertex lies on any edge are computed in doubles;
//! between two neighbouring ones nothing can change, so one polygon intersection test in each gap
//! tells what is free. Where doubles leave that test open by a margin it is asked exactly, at a
//! rational orientation inside the gap.

use snapfit::contact::{Contact, ContactKind};
use snapfit::geometry::{Polygon, Vec2, interiors_intersect};
use snapfit::motion::Angle;
use snapfit::motion::trajectory::{Segment, Trajectory};
use snapfit::number::Rat;
use snapfit::scene::{Obstacle, Scene};
use std::f64::consts::{PI, TAU};

type P = [f64; 2];

pub fn f(r: &Rat) -> f64 {
    r.nearest_f64().unwrap()
}
pub fn fp(p: &Vec2) -> P {
    [f(&p.x), f(&p.y)]
}
fn sub(a: P, b: P) -> P {
    [a[0] - b[0], a[1] - b[1]]
}
fn dot(a: P, b: P) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
fn cross(a: P, b: P) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
fn turn(a: P, theta: f64) -> P {
    let (s, c) = theta.sin_cos();
    [c * a[0] - s * a[1], s * a[0] + c * a[1]]
}
/// The representative in (−π, π].
pub fn principal(theta: f64) -> f64 {
    let x = theta - TAU * (theta / TAU).round();
    if x <= -PI { x + TAU } else { x }
}

/// An orientation at which a vertex lies on an edge.
#[derive(Clone, Copy, Debug)]
pub struct Critical {
    pub theta: f64,
    pub contact: Contact,
}

struct Ring {
    obstacle: u32,
    ring: u32,
    at: Vec<P>,
}

/// One pawl in one phase.
pub struct World {
    shape: Vec<Vec2>,
    obstacles: Vec<Polygon>,
    p0: Vec2,
    v: Vec2,
    /// θ at the stops.
    pub limits: Option<(f64, f64)>,
    pub duration: f64,
    /// How large the scene's coordinates are.
    pub size: f64,
    a: Vec<P>,
    rings: Vec<Ring>,
    fp0: P,
    fv: P,
}

pub fn polygon(o: &Obstacle) -> Polygon {
    Polygon::new(o.vertices.clone(), o.holes.clone())
}

impl World {
    /// The pawl `pawl` of a scene while the root, displaced by `offset`, moves with velocity v.
    pub fn new(scene: &Scene, pawl: usize, offset: &Vec2, v: &Vec2, duration: f64) -> World {
        let p = &scene.pawls[pawl];
        let shape: Vec<Vec2> = p.vertices.iter().map(|q| q - &p.hinge).collect();
        let p0 = &p.hinge + offset;
        let mut rings = Vec::new();
        for (i, o) in scene.obstacles.iter().enumerate() {
            for (k, r) in std::iter::once(&o.vertices).chain(&o.holes).enumerate() {
                rings.push(Ring {
                    obstacle: i as u32,
                    ring: k as u32,
                    at: r.iter().map(fp).collect(),
                });
            }
        }
        let a: Vec<P> = shape.iter().map(fp).collect();
        let all = rings.iter().flat_map(|r| &r.at).chain(&a);
        let size = all
            .flat_map(|p| [p[0].abs(), p[1].abs()])
            .fold(1e-300, f64::max);
        World {
            limits: p
                .limits
                .as_ref()
                .map(|(lo, hi)| (2.0 * f(lo).atan(), 2.0 * f(hi).atan())),
            a,
            rings,
            fp0: fp(&p0),
            fv: fp(v),
            shape,
            obstacles: scene.obstacles.iter().map(polygon).collect(),
            p0,
            v: v.clone(),
            duration,
            size,
        }
    }

    fn hinge(&self, t: f64) -> P {
        [self.fp0[0] + t * self.fv[0], self.fp0[1] + t * self.fv[1]]
    }

    /// Visits every (vertex, edge start, edge end, contact), the vertex first on the pawl and the
    /// edge on an obstacle (type B), then the other way round.
    fn pairs(&self, mut see: impl FnMut(P, P, P, Contact)) {
        let m = self.a.len();
        for r in &self.rings {
            let n = r.at.len();
            let contact = |kind, of: usize, pf: usize| Contact::Obstacle {
                obstacle: r.obstacle,
                kind,
                ring: r.ring,
                obstacle_feature: of as u32,
                pawl_feature: pf as u32,
            };
            for j in 0..n {
                for i in 0..m {
                    let (q, q1) = (r.at[j], r.at[(j + 1) % n]);
                    see(self.a[i], q, q1, contact(ContactKind::B, j, i));
                    let (a, a1) = (self.a[i], self.a[(i + 1) % m]);
                    see(q, a, a1, contact(ContactKind::A, j, i));
                }
            }
        }
    }

    /// All critical orientations at time t, ascending in (−π, π].
    pub fn criticals(&self, t: f64) -> Vec<Critical> {
        let p = self.hinge(t);
        let mut out = Vec::new();
        let slack = 1e-9 * self.size;
        self.pairs(|vertex, e0, e1, contact| {
            let b = matches!(
                contact,
                Contact::Obstacle {
                    kind: ContactKind::B,
                    ..
                }
            );
            // The vertex that turns against a fixed line, or that stands still while a line turns.
            let (x, o) = if b {
                (vertex, p)
            } else {
                (sub(vertex, p), [0.0, 0.0])
            };
            let (l0, l1) = (sub(e0, o), sub(e1, o));
            let along = sub(l1, l0);
            let len = dot(along, along).sqrt();
            let n = [along[1] / len, -along[0] / len];
            let (radius, d) = (dot(x, x).sqrt(), dot(l0, n));
            if radius <= 1e-12 * self.size || d.abs() > radius + slack {
                return;
            }
            let spread = (d / radius).clamp(-1.0, 1.0).acos();
            let (xa, na) = (x[1].atan2(x[0]), n[1].atan2(n[0]));
            for s in [spread, -spread] {
                let w = na + s;
                let y = [radius * w.cos(), radius * w.sin()];
                let k = dot(sub(y, l0), along) / len;
                if k >= -slack && k <= len + slack {
                    let theta = if b { w - xa } else { xa - w };
                    out.push(Critical {
                        theta: principal(theta),
                        contact,
                    });
                }
            }
        });
        if let Some((lo, hi)) = self.limits {
            for (k, theta) in [lo, hi].into_iter().enumerate() {
                out.push(Critical {
                    theta,
                    contact: Contact::Limit(k as u8),
                });
            }
        }
        out.sort_by(|a, b| a.theta.total_cmp(&b.theta));
        out
    }

    /// Times in (t0, t1) at which a vertex lies on an edge while the orientation stays θ.
    pub fn crossings_at(&self, theta: f64, t0: f64, t1: f64) -> Vec<f64> {
        let slack = 1e-9 * self.size;
        let v = self.fv;
        let mut out = Vec::new();
        self.pairs(|vertex, e0, e1, contact| {
            let b = matches!(
                contact,
                Contact::Obstacle {
                    kind: ContactKind::B,
                    ..
                }
            );
            let at = |x: P| {
                let y = turn(x, theta);
                [self.fp0[0] + y[0], self.fp0[1] + y[1]]
            };
            // vertex + t·w against the fixed edge.
            let (x, l0, l1, w) = if b {
                (at(vertex), e0, e1, v)
            } else {
                (vertex, at(e0), at(e1), [-v[0], -v[1]])
            };
            let along = sub(l1, l0);
            let len = dot(along, along).sqrt();
            let n = [along[1] / len, -along[0] / len];
            let speed = dot(w, n);
            if speed.abs() < 1e-14 * dot(w, w).sqrt() {
                return;
            }
            let t = dot(sub(l0, x), n) / speed;
            if t <= t0 || t >= t1 {
                return;
            }
            let y = [x[0] + t * w[0], x[1] + t * w[1]];
            let k = dot(sub(y, l0), along) / len;
            if k >= -slack && k <= len + slack {
                out.push(t);
            }
        });
        out.sort_by(f64::total_cmp);
        out
    }

    /// Whether the configuration is free: no interior meets another, and no stop is passed.
    pub fn free(&self, t: f64, theta: f64) -> bool {
        if !self.between_stops(theta) {
            return false;
        }
        match self.guess(t, theta) {
            Some(x) => x,
            None => self.free_exactly(&Rat::from_f64(t), theta),
        }
    }

    fn between_stops(&self, theta: f64) -> bool {
        self.limits.is_none_or(|(lo, hi)| lo < theta && theta < hi)
    }

    /// The exact test at a rational orientation within 2⁻⁵⁰ of θ.
    pub fn free_exactly(&self, t: &Rat, theta: f64) -> bool {
        if !self.between_stops(theta) {
            return false;
        }
        let theta = principal(theta);
        // tan(θ/2) in [−1, 1], with a half turn beside it where needed.
        let (half, back) = if theta.abs() <= PI / 2.0 {
            (theta / 2.0, false)
        } else {
            ((theta - PI.copysign(theta)) / 2.0, true)
        };
        let scale = (1u64 << 50) as f64;
        let u = Rat::from_f64((half.tan() * scale).round() / scale);
        let p = &self.p0 + &self.v.scale(t);
        let ring: Vec<Vec2> = self
            .shape
            .iter()
            .map(|a| {
                let r = a.rotate_tan_half(&u);
                let r = if back { -&r } else { r };
                &r + &p
            })
            .collect();
        let moved = Polygon::new(ring, Vec::new());
        !self
            .obstacles
            .iter()
            .any(|o| interiors_intersect(&moved, o))
    }

    /// The same in doubles, where every distance leaves a margin.
    fn guess(&self, t: f64, theta: f64) -> Option<bool> {
        let p = self.hinge(t);
        let margin = 1e-9 * self.size;
        let moved: Vec<P> = self
            .a
            .iter()
            .map(|a| {
                let y = turn(*a, theta);
                [y[0] + p[0], y[1] + p[1]]
            })
            .collect();
        let (m, mut close) = (moved.len(), false);
        for r in &self.rings {
            for j in 0..r.at.len() {
                let (q, q1) = (r.at[j], r.at[(j + 1) % r.at.len()]);
                for i in 0..m {
                    let (a, a1) = (moved[i], moved[(i + 1) % m]);
                    let side = |x: P, y: P, z: P| {
                        let e = sub(y, x);
                        cross(e, sub(z, x)) / dot(e, e).sqrt()
                    };
                    let s = [
                        side(q, q1, a),
                        side(q, q1, a1),
                        side(a, a1, q),
                        side(a, a1, q1),
                    ];
                    let apart = |x: f64, y: f64| x.min(y) > margin || x.max(y) < -margin;
                    let cut = |x: f64, y: f64| x.min(y) < -margin && x.max(y) > margin;
                    if cut(s[0], s[1]) && cut(s[2], s[3]) {
                        return Some(false);
                    }
                    if !apart(s[0], s[1]) && !apart(s[2], s[3]) {
                        close = true;
                    }
                }
            }
        }
        if close {
            return None;
        }
        let inside = |x: P, ring: &[P]| {
            let n = ring.len();
            let mut odd = false;
            for k in 0..n {
                let (a, b) = (ring[k], ring[(k + 1) % n]);
                if (a[1] > x[1]) != (b[1] > x[1])
                    && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                {
                    odd = !odd;
                }
            }
            odd
        };
        for k in 0..self.obstacles.len() {
            let rings = || self.rings.iter().filter(|r| r.obstacle as usize == k);
            let odd = rings().filter(|r| inside(moved[0], &r.at)).count() % 2 == 1;
            if odd || rings().any(|r| inside(r.at[0], &moved)) {
                return Some(false);
            }
        }
        Some(true)
    }

    /// How far the two features of a contact are apart at a configuration.
    pub fn distance(&self, t: f64, theta: f64, contact: Contact) -> f64 {
        let p = self.hinge(t);
        match contact {
            Contact::Limit(k) => {
                let Some((lo, hi)) = self.limits else {
                    return f64::INFINITY;
                };
                (if k == 0 { theta - lo } else { theta - hi }).abs()
            }
            Contact::Obstacle {
                obstacle,
                kind,
                ring,
                obstacle_feature,
                pawl_feature,
            } => {
                let r = self
                    .rings
                    .iter()
                    .find(|r| r.obstacle == obstacle && r.ring == ring)
                    .unwrap();
                let (j, i) = (obstacle_feature as usize, pawl_feature as usize);
                let at = |i: usize| {
                    let y = turn(self.a[i % self.a.len()], theta);
                    [y[0] + p[0], y[1] + p[1]]
                };
                let q = |j: usize| r.at[j % r.at.len()];
                let (x, e0, e1) = match kind {
                    ContactKind::B => (at(i), q(j), q(j + 1)),
                    ContactKind::A => (q(j), at(i), at(i + 1)),
                };
                let along = sub(e1, e0);
                let k = (dot(sub(x, e0), along) / dot(along, along)).clamp(0.0, 1.0);
                let d = sub(x, [e0[0] + k * along[0], e0[1] + k * along[1]]);
                dot(d, d).sqrt()
            }
        }
    }

    /// Coulomb's law by force balance: the torque that the contact force along the edge of the
    /// friction cone (against the sliding) has about the hinge, turned so that the frictionless
    /// force's is positive, and divided by the lengths. Negative: the sliding force would drive
    /// the pawl the wrong way, so nothing can balance the spring, and the contact sticks.
    /// None where the contact does not slide or holds no torque.
    pub fn balance(&self, t: f64, theta: f64, contact: Contact, mu: f64) -> Option<f64> {
        let Contact::Obstacle {
            obstacle,
            kind,
            ring,
            obstacle_feature,
            pawl_feature,
        } = contact
        else {
            return None;
        };
        let r = self
            .rings
            .iter()
            .find(|r| r.obstacle == obstacle && r.ring == ring)
            .unwrap();
        let (j, i) = (obstacle_feature as usize, pawl_feature as usize);
        let p = self.hinge(t);
        let a = |i: usize| turn(self.a[i % self.a.len()], theta);
        // Where the force acts, from the hinge, and the tangent there.
        let (lever, tangent) = match kind {
            ContactKind::B => (a(i), sub(r.at[(j + 1) % r.at.len()], r.at[j])),
            ContactKind::A => (sub(r.at[j], p), sub(a(i + 1), a(i))),
        };
        let len = dot(tangent, tangent).sqrt();
        let x = [tangent[0] / len, tangent[1] / len];
        // The line of the push; its sense is the one that turns the pawl away from rest.
        let mut n = [-x[1], x[0]];
        let arm = dot(lever, lever).sqrt();
        let mut push = cross(lever, n);
        let want = if theta >= 0.0 { 1.0 } else { -1.0 };
        if push.abs() < 1e-9 * arm {
            return None;
        }
        if push * want < 0.0 {
            n = [-n[0], -n[1]];
            push = -push;
        }
        // The pawl turns so that the contact is kept: (v + ω ẑ×lever)·n = 0.
        let omega = -dot(self.fv, n) / push;
        let slide = dot(self.fv, x) + omega * cross(lever, x);
        let speed = dot(self.fv, self.fv).sqrt();
        if slide.abs() < 1e-9 * speed {
            return None;
        }
        let s = slide.signum();
        let force = [n[0] - mu * s * x[0], n[1] - mu * s * x[1]];
        Some(cross(lever, force) * want / (arm * (1.0 + mu * mu).sqrt()))
    }
}

// ── reading a trajectory ────────────────────────────────────────────────────────────────────────

/// θ as a double.
pub fn radians(angle: &Angle) -> f64 {
    PI * angle.half_turn as f64 + 2.0 * angle.x.nearest_f64().unwrap().atan()
}

/// θ on a segment at rational time t of its phase, from the curve, branch and winding as the
/// contract prints them.
pub fn theta_on(segment: &Segment, t: &Rat) -> f64 {
    let Some(s) = &segment.sliding else {
        return 0.0;
    };
    let at = |k: usize| Rat::from(s.p[k].clone()) + t * Rat::from(s.q[k].clone());
    let (c, b, a) = (at(0), at(1), at(2));
    let half = if a.is_zero() {
        // The finite root is `+` if B > 0 and `−` if B < 0; the other one is infinite.
        if b.sign() == s.branch {
            f(&(-&c / &b)).atan()
        } else {
            PI / 2.0
        }
    } else {
        // Scaled by the largest, so that nothing leaves the range of doubles.
        let big = [&a, &b, &c].into_iter().map(Rat::abs).max().unwrap();
        let (a, b, c) = (&a / &big, &b / &big, &c / &big);
        let disc = b.square() - Rat::from(4) * &a * &c;
        assert!(disc.sign() >= 0, "no real root on the segment");
        let (fa, fb, fc, root) = (f(&a), f(&b), f(&c), f(&disc).sqrt());
        let sign = f64::from(s.branch);
        // u = (−B ± √D)/(2A), by whichever form does not cancel.
        if fb * sign <= 0.0 {
            (-fb + sign * root).atan2(2.0 * fa)
        } else {
            (2.0 * fc).atan2(-fb - sign * root)
        }
    };
    // atan2 may come out beside the line's other end.
    let mut theta = principal(2.0 * half);
    let [w0, w1] = segment.winding;
    let turns = if theta > 0.0 { w0.min(w1) } else { w0.max(w1) };
    theta += TAU * turns as f64;
    theta
}

/// The segment of a pawl that holds at rational time t (inside it) of a phase.
pub fn segment_at<'a>(
    trajectory: &'a Trajectory,
    pawl: usize,
    phase: usize,
    t: &Rat,
) -> Option<&'a Segment> {
    trajectory.pawls[pawl]
        .segments
        .iter()
        .find(|s| s.phase == phase && s.from.cmp_rat(t).is_lt() && s.to.cmp_rat(t).is_gt())
}

/// Whether θ at time t is what the model says by looking at that instant alone: no penetration,
/// θ at the end of a free interval that is nearest to rest (or at rest in one), on a contact that
/// is named and touches. `None`: too near to a degeneracy to tell.
pub fn check_instant(w: &World, t: &Rat, segment: &Segment, theta: f64) -> Result<(), String> {
    const GUARD: f64 = 2e-7;
    let ft = f(t);
    let crit = w.criticals(ft);
    let here = principal(theta);
    // The nearest critical orientations outside the guard, as distances up and down.
    let (mut up, mut down) = (TAU, TAU);
    let mut touching = f64::INFINITY;
    for c in &crit {
        let d = principal(c.theta - here);
        touching = touching.min(d.abs());
        if d.abs() <= GUARD {
            continue;
        }
        let (u, v) = if d > 0.0 { (d, TAU - d) } else { (TAU + d, -d) };
        up = up.min(u);
        down = down.min(v);
    }
    let gap = |up_side: bool| {
        let width = if up_side { up } else { down };
        if width < 2.0 * GUARD {
            return None;
        }
        let d = width / 2.0;
        Some(w.free_exactly(t, if up_side { theta + d } else { theta - d }))
    };
    if segment.sliding.is_none() {
        if theta != 0.0 {
            return Err("a free segment away from rest".into());
        }
        return match (gap(true), gap(false)) {
            (Some(false), Some(false)) => Err("at rest, but neither side is free".into()),
            _ => Ok(()),
        };
    }
    if touching > GUARD {
        return Err(format!("held at θ = {theta}, but nothing touches there"));
    }
    let lower = theta > 0.0;
    if theta.abs() > 1e-9 {
        if gap(lower) == Some(false) {
            return Err(format!("θ = {theta}: the side away from rest is not free"));
        }
        if gap(!lower) == Some(true) {
            return Err(format!("θ = {theta}: the way to rest is free"));
        }
    }
    let s = segment.sliding.as_ref().unwrap();
    for c in std::iter::once(&s.contact).chain(&s.also) {
        let d = w.distance(ft, theta, *c);
        if d > 1e-9 * w.size.max(1.0) {
            return Err(format!("{c:?} is reported but is {d} apart at θ = {theta}"));
        }
    }
    Ok(())
}
