//! Patches: for each pair of features that can touch, the C-function with the conditions under
//! which it is a real contact.

use super::{Contact, ContactKind, ObstacleShape, PawlShape, Ring, Trig, window};
use crate::geometry::Vec2;
use crate::geometry::index::Hull;
use crate::number::{Enclosed, Interval, Rat, Scalar, filter};

/// A straight phase as one hinge sees it: p(t) = p₀ + v·t, 0 ≤ t ≤ duration.
#[derive(Clone, Debug)]
pub struct Frame<R = Rat> {
    /// Hinge at the start of the phase.
    pub p0: Vec2<R>,
    /// Velocity, not zero.
    pub v: Vec2<R>,
    /// How long the phase lasts.
    pub duration: R,
}

impl<R: Scalar> Frame<R> {
    /// In certified intervals.
    pub fn enclosed(&self) -> Frame<Enclosed> {
        Frame {
            p0: self.p0.enclosed(),
            v: self.v.enclosed(),
            duration: Enclosed::new(self.duration.interval()),
        }
    }
}

/// One contact pair over one phase (DP eqs. 3, 4, 22): the C-function f = f₀ + t·f₁ is positive
/// where the features are apart and negative where they penetrate.
#[derive(Clone, Debug)]
pub struct Patch<R = Rat> {
    /// Who touches whom.
    pub contact: Contact,
    /// The part of the C-function without t.
    pub f0: Trig<R>,
    /// The part of the C-function with t.
    pub f1: Trig<R>,
    /// Both must be ≥ 0: neither polygon penetrates beside the contact (applicability, DP §5).
    pub wedge: [Trig<R>; 2],
    /// (g₀, g₁): both g₀ + t·g₁ must be ≥ 0: the contact lies between the ends of the edge.
    pub location: [(Trig<R>, Trig<R>); 2],
    /// The pawl vertex and obstacle vertex that meet where each location condition ends.
    pub ends: [(Vec2<R>, Vec2<R>); 2],
    /// The pawl edge (direction) and obstacle edge (normal) that are flush where each wedge
    /// condition ends, as ids: (pawl edge, obstacle ring's global edge id).
    pub flush: [(u32, u32); 2],
    /// In which charts it may be met within the phase.
    pub charts: [bool; 2],
    /// For intervals: whether a wedge condition certainly ends exactly where the curve turns back in time (type B: the
    /// pawl's edge is square to its arm) or goes to infinity (type A: the obstacle's edge runs along the
    /// motion).
    pub squared: bool,
}

/// Whether one of two numbers is certainly zero; asked of intervals alone, since nothing else needs to know.
fn certainly_zero<R: Scalar>(x: impl Fn() -> [R; 2]) -> bool {
    R::ROUGH && x().iter().any(|x| x.interval() == Interval::point(0.0))
}

/// R_θ a · n as a function of θ.
fn dot<R: Scalar>(a: &Vec2<R>, n: &Vec2<R>) -> Trig<R> {
    Trig::new(a.dot(n), a.cross(n), R::zero())
}

/// n · R_θ m = R_θ m · n, plus a constant.
fn dot_plus<R: Scalar>(a: &Vec2<R>, n: &Vec2<R>, k: R) -> Trig<R> {
    Trig::new(a.dot(n), a.cross(n), k)
}

fn box_of<R: Scalar>(points: &[&Vec2<R>]) -> (Interval, Interval) {
    let hull = |f: fn(&Vec2<R>) -> Interval| {
        points.iter().map(|p| f(p)).fold(
            Interval {
                lo: f64::INFINITY,
                hi: f64::NEG_INFINITY,
            },
            |a, b| Interval {
                lo: a.lo.min(b.lo),
                hi: a.hi.max(b.hi),
            },
        )
    };
    (hull(|p| p.x.interval()), hull(|p| p.y.interval()))
}

/// Certified enclosure of the squared distance between two boxes' points.
fn dist2(a: (Interval, Interval), b: (Interval, Interval)) -> Interval {
    let gap = |p: Interval, q: Interval| (p - q).square();
    gap(a.0, b.0) + gap(a.1, b.1)
}

/// What holds every point within `reach` of the path: a box, and a strip along the path.
fn capsule(path: (Interval, Interval), v: (Interval, Interval), reach: f64) -> Hull {
    let r = reach * (1.0 + 1e-12);
    let wide = |i: Interval| (i.lo - r - i.lo.abs() * 1e-12, i.hi + r + i.hi.abs() * 1e-12);
    let ((x0, x1), (y0, y1)) = (wide(path.0), wide(path.1));
    let boxed = Hull::boxed([x0, x1, y0, y1]);
    let middle = |i: Interval| i.lo * 0.5 + i.hi * 0.5;
    // The path runs up or down along a diagonal of its box; any slope near that gives a strip.
    let rising = middle(v.0) * middle(v.1) > 0.0;
    let (dx, dy) = (path.0.hi - path.0.lo, path.1.hi - path.1.lo);
    let slope = if rising { dy / dx } else { -dy / dx };
    if !slope.is_finite() || v.0.sign().is_none() || v.1.sign().is_none() {
        return boxed;
    }
    // Both ends of the diagonal, up to the width of the ends' enclosures.
    let ends = if rising {
        [(path.0.lo, path.1.lo), (path.0.hi, path.1.hi)]
    } else {
        [(path.0.lo, path.1.hi), (path.0.hi, path.1.lo)]
    };
    let at = ends.map(|(x, y)| y - slope * x);
    let size = |x: f64, y: f64| y.abs() + (slope * x).abs();
    let room =
        r * (1.0 + slope * slope).sqrt() * (1.0 + 1e-9) + 1e-9 * (size(x0, y0) + size(x1, y1));
    Hull {
        slope,
        low: at[0].min(at[1]) - room,
        high: at[0].max(at[1]) + room,
        ..boxed
    }
}

/// The patches of a pawl against the obstacles over a phase, without those that lie out of the
/// pawl's reach along the hinge's path (idea 4: what cannot be met is never made).
///
/// Cost: O(log n) a ring of n edges (the first time O(n log n)), one certified interval test a pair of features near
/// the path, exact work only for pairs within reach.
pub fn patches<R: Scalar>(
    frame: &Frame<R>,
    pawl: &PawlShape<R>,
    obstacles: &[ObstacleShape<R>],
) -> Vec<Patch<R>> {
    let mut out = Vec::new();
    pairs(frame, pawl, obstacles, &mut |p| {
        out.push(p.patch(frame, pawl, obstacles));
    });
    out
}

/// Visits the pairs of features that may be met within the phase. Where numbers are exact and doubles may
/// settle questions, each comes with its patch in certified intervals, and those that certainly cannot be met are
/// left out.
pub fn pairs_within<R: Scalar>(
    frame: &Frame<R>,
    pawl: &PawlShape<R>,
    obstacles: &[ObstacleShape<R>],
    visit: &mut dyn FnMut(Pair, Option<Patch<Enclosed>>),
) {
    if !R::EXACT || !filter::on() {
        return pairs(frame, pawl, obstacles, &mut |p| visit(p, None));
    }
    let duration = frame.duration.interval().hi;
    let near = frame.enclosed();
    let body = pawl.ring.rough();
    pairs(frame, pawl, obstacles, &mut |p| {
        let rough = p.of_rings(&near, body, obstacles[p.o].rings[p.r].rough());
        let charts = window::charts(&rough, duration);
        if charts != [false; 2] {
            visit(p, Some(Patch { charts, ..rough }));
        }
    });
}

/// A pair of features within reach of each other.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    kind: ContactKind,
    o: usize,
    r: usize,
    /// Of the pawl.
    i: usize,
    /// Of the obstacle.
    j: usize,
    edge_base: u32,
}

impl Pair {
    /// Its patch.
    pub fn patch<R: Scalar>(
        &self,
        frame: &Frame<R>,
        pawl: &PawlShape<R>,
        obstacles: &[ObstacleShape<R>],
    ) -> Patch<R> {
        self.of_rings(frame, &pawl.ring, &obstacles[self.o].rings[self.r])
    }
    fn of_rings<R: Scalar>(&self, frame: &Frame<R>, ring: &Ring<R>, oring: &Ring<R>) -> Patch<R> {
        let Pair {
            o,
            r,
            i,
            j,
            edge_base,
            ..
        } = *self;
        match self.kind {
            ContactKind::B => type_b(frame, ring, oring, o, r, i, j, edge_base),
            ContactKind::A => type_a(frame, ring, oring, o, r, i, j, edge_base),
        }
    }
}

/// Visits the pairs of features within reach along the hinge's path.
fn pairs<R: Scalar>(
    frame: &Frame<R>,
    pawl: &PawlShape<R>,
    obstacles: &[ObstacleShape<R>],
    visit: &mut dyn FnMut(Pair),
) {
    let ring = &pawl.ring;
    let m = ring.len();
    let p_end = &frame.p0 + &frame.v.scale(&frame.duration);
    let path = box_of(&[&frame.p0, &p_end]);
    let radius2: Vec<Interval> = ring.vertices.iter().map(|a| a.norm2().interval()).collect();
    let hinge = (Interval::point(0.0), Interval::point(0.0));
    let nearest2: Vec<f64> = (0..m)
        .map(|i| {
            dist2(
                box_of(&[&ring.vertices[i], &ring.vertices[ring.next(i)]]),
                hinge,
            )
            .lo
        })
        .collect();
    let reach2 = radius2.iter().map(|r| r.hi).fold(0.0, f64::max);
    let velocity = (frame.v.x.interval(), frame.v.y.interval());
    let near = capsule(path, velocity, reach2.sqrt());
    let mut edge_base = 0u32;
    for (o, obstacle) in obstacles.iter().enumerate() {
        for (r, oring) in obstacle.rings.iter().enumerate() {
            for j in oring.edges_near(&near) {
                let (q, q_next) = (&oring.vertices[j], &oring.vertices[oring.next(j)]);
                let edge_box = box_of(&[q, q_next]);
                let d2 = dist2(edge_box, path);
                if d2.lo <= reach2 {
                    for (i, r2) in radius2.iter().enumerate() {
                        if ring.convex[i] && d2.lo <= r2.hi && d2.hi >= r2.lo {
                            visit(Pair {
                                kind: ContactKind::B,
                                o,
                                r,
                                i,
                                j,
                                edge_base,
                            });
                        }
                    }
                }
                let q2 = dist2(box_of(&[q]), path);
                if oring.convex[j] && q2.lo <= reach2 {
                    for i in 0..m {
                        let far = radius2[i].hi.max(radius2[ring.next(i)].hi);
                        if q2.lo <= far && q2.hi >= nearest2[i] {
                            visit(Pair {
                                kind: ContactKind::A,
                                o,
                                r,
                                i,
                                j,
                                edge_base,
                            });
                        }
                    }
                }
            }
            edge_base += oring.len() as u32;
        }
    }
}

#[allow(clippy::too_many_arguments)]
fn type_b<R: Scalar>(
    frame: &Frame<R>,
    ring: &Ring<R>,
    oring: &Ring<R>,
    o: usize,
    r: usize,
    i: usize,
    j: usize,
    edge_base: u32,
) -> Patch<R> {
    let a = &ring.vertices[i];
    let n = &oring.normals[j];
    let (q0, q1) = (&oring.vertices[j], &oring.vertices[oring.next(j)]);
    let tau = oring.edge(j);
    let (ahead, behind) = (ring.edge(i), -&ring.edge(ring.prev(i)));
    let to_hinge = &frame.p0 - q0;
    let past = q1 - &frame.p0;
    let vt = frame.v.dot(&tau);
    let squared = certainly_zero(|| [ahead.dot(a), behind.dot(a)]);
    Patch {
        squared,
        contact: Contact::Obstacle {
            obstacle: o as u32,
            kind: ContactKind::B,
            ring: r as u32,
            obstacle_feature: j as u32,
            pawl_feature: i as u32,
        },
        f0: dot_plus(a, n, to_hinge.dot(n)),
        f1: Trig::constant(frame.v.dot(n)),
        wedge: [dot(&ahead, n), dot(&behind, n)],
        location: [
            (
                dot_plus(a, &tau, to_hinge.dot(&tau)),
                Trig::constant(vt.clone()),
            ),
            (
                dot_plus(a, &tau, past.dot(&tau).negated()).neg(),
                Trig::constant(vt.negated()),
            ),
        ],
        ends: [(a.clone(), q0.clone()), (a.clone(), q1.clone())],
        flush: [
            (i as u32, edge_base + j as u32),
            (ring.prev(i) as u32, edge_base + j as u32),
        ],
        charts: [true; 2],
    }
}

#[allow(clippy::too_many_arguments)]
fn type_a<R: Scalar>(
    frame: &Frame<R>,
    ring: &Ring<R>,
    oring: &Ring<R>,
    o: usize,
    r: usize,
    i: usize,
    j: usize,
    edge_base: u32,
) -> Patch<R> {
    let m = &ring.normals[i];
    let (a0, a1) = (&ring.vertices[i], &ring.vertices[ring.next(i)]);
    let tau = ring.edge(i);
    let q = &oring.vertices[j];
    let w = q - &frame.p0;
    let e = m.dot(a0);
    let (ahead, behind) = (oring.edge(j), -&oring.edge(oring.prev(j)));
    // (w − v·t)·R m − e and (w − v·t)·R τ between a₀·τ and a₁·τ.
    let v = &frame.v;
    let minus_v = -v;
    let squared = certainly_zero(|| [ahead.cross(v), behind.cross(v)]);
    Patch {
        squared,
        contact: Contact::Obstacle {
            obstacle: o as u32,
            kind: ContactKind::A,
            ring: r as u32,
            obstacle_feature: j as u32,
            pawl_feature: i as u32,
        },
        f0: dot_plus(m, &w, e.negated()),
        f1: dot(m, &minus_v),
        wedge: [dot(m, &ahead), dot(m, &behind)],
        location: [
            (
                dot_plus(&tau, &w, a0.dot(&tau).negated()),
                dot(&tau, &minus_v),
            ),
            (
                dot_plus(&tau, &w, a1.dot(&tau).negated()).neg(),
                dot(&tau, v),
            ),
        ],
        ends: [(a0.clone(), q.clone()), (a1.clone(), q.clone())],
        flush: [
            (i as u32, edge_base + j as u32),
            (i as u32, edge_base + oring.prev(j) as u32),
        ],
        charts: [true; 2],
    }
}
