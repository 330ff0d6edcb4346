//! The scene and its motion in doubles: bodies as points, θ over t as curves to be drawn.

use super::svg::Point;
use crate::geometry::Vec2;
use crate::number::Rat;
use crate::report::json::{
    ContactDocument, CurveDocument, EventContact, PawlDocument, ResultDocument,
    RootContactDocument, SegmentDocument,
};
use crate::scene::Scene;
use std::f64::consts::TAU;

/// How many pieces a curved stretch is drawn with.
const PIECES: usize = 72;

/// Everything that a picture shows, in doubles.
pub(super) struct Stage {
    /// Rings of each obstacle, with its name.
    pub(super) obstacles: Vec<(String, Vec<Vec<Point>>)>,
    /// The root at time 0.
    pub(super) root: Option<Vec<Point>>,
    pub(super) pawls: Vec<Pawl>,
    pub(super) phases: Vec<Phase>,
}

/// A pawl: its shape about the hinge, and what it did.
pub(super) struct Pawl {
    pub(super) name: String,
    pub(super) hinge: Point,
    pub(super) ring: Vec<Point>,
    pub(super) track: Vec<Stroke>,
}

/// A phase: when, and where the root was at its start.
pub(super) struct Phase {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) offset: Point,
    pub(super) velocity: Point,
}

/// A segment of motion as a curve over the time of the whole plan.
pub(super) struct Stroke {
    pub(super) free: bool,
    pub(super) phase: usize,
    /// (t, θ), ascending in t.
    pub(super) points: Vec<Point>,
    curve: Option<Curve>,
}

struct Curve {
    p: [f64; 3],
    q: [f64; 3],
    sign: f64,
    from: f64,
}

fn double(r: &Rat) -> f64 {
    r.nearest_f64().unwrap_or(1e300 * f64::from(r.sign()))
}

fn point(p: &Vec2) -> Point {
    [double(&p.x), double(&p.y)]
}

fn ring(vertices: &[Vec2]) -> Vec<Point> {
    vertices.iter().map(point).collect()
}

/// The point p turned by θ about the origin.
fn turned(p: Point, theta: f64) -> Point {
    let (s, c) = theta.sin_cos();
    [c * p[0] - s * p[1], s * p[0] + c * p[1]]
}

fn sum(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

impl Stage {
    pub(super) fn new(scene: &Scene, result: &ResultDocument) -> Stage {
        let mut offset = [0.0, 0.0];
        let mut phases = Vec::new();
        for p in &result.phases {
            let phase = Phase {
                from: p.from.approx(),
                to: p.to.approx(),
                offset,
                velocity: [p.velocity[0].approx(), p.velocity[1].approx()],
            };
            let length = phase.to - phase.from;
            offset = sum(offset, phase.velocity.map(|v| v * length));
            phases.push(phase);
        }
        let pawls = scene
            .pawls
            .iter()
            .zip(&result.pawls)
            .map(|(pawl, history)| Pawl {
                name: pawl.name.clone(),
                hinge: point(&pawl.hinge),
                ring: pawl
                    .vertices
                    .iter()
                    .map(|v| point(&(v - &pawl.hinge)))
                    .collect(),
                track: track(history, &phases),
            })
            .collect();
        let rings = |o: &crate::scene::Obstacle| {
            let mut all = vec![ring(&o.vertices)];
            all.extend(o.holes.iter().map(|h| ring(h)));
            all
        };
        Stage {
            obstacles: scene
                .obstacles
                .iter()
                .map(|o| (o.name.clone(), rings(o)))
                .collect(),
            root: scene.root.as_ref().map(|r| ring(&r.vertices)),
            pawls,
            phases,
        }
    }

    /// The root's displacement.
    pub(super) fn offset(&self, phase: usize, t: f64) -> Point {
        let p = &self.phases[phase];
        sum(p.offset, p.velocity.map(|v| v * (t - p.from)))
    }

    /// The root at a displacement.
    pub(super) fn root_at(&self, offset: Point) -> Option<Vec<Point>> {
        let root = self.root.as_ref()?;
        Some(root.iter().map(|p| sum(*p, offset)).collect())
    }

    /// A pawl's outline at a displacement of the root and an orientation.
    pub(super) fn pawl_at(&self, pawl: usize, offset: Point, theta: f64) -> Vec<Point> {
        let p = &self.pawls[pawl];
        let hinge = sum(p.hinge, offset);
        p.ring
            .iter()
            .map(|v| sum(turned(*v, theta), hinge))
            .collect()
    }

    /// θ of a pawl at an instant of a phase.
    pub(super) fn theta(&self, pawl: usize, phase: usize, t: f64) -> f64 {
        let track = &self.pawls[pawl].track;
        let on = |s: &&Stroke| s.phase == phase && s.spans(t);
        match track
            .iter()
            .find(on)
            .or_else(|| track.iter().rfind(|s| s.points[0][0] <= t))
        {
            Some(stroke) => stroke.theta(t),
            None => 0.0,
        }
    }

    /// Where a contact lies, for a pawl at a displacement and an orientation.
    pub(super) fn contact_point(
        &self,
        contact: &EventContact,
        pawl: usize,
        offset: Point,
        theta: f64,
    ) -> Option<Point> {
        let of_obstacle = |name: &str, hole: Option<u32>, vertex: u32| {
            let (_, rings) = self.obstacles.iter().find(|o| o.0 == name)?;
            let ring = rings.get(hole.map_or(0, |h| h as usize + 1))?;
            ring.get(vertex as usize).copied()
        };
        match contact {
            EventContact::Pawl(ContactDocument::B { pawl_vertex, .. }) => self
                .pawl_at(pawl, offset, theta)
                .get(*pawl_vertex as usize)
                .copied(),
            EventContact::Root(RootContactDocument::B { root_vertex, .. }) => {
                self.root_at(offset)?.get(*root_vertex as usize).copied()
            }
            EventContact::Pawl(ContactDocument::A {
                obstacle,
                obstacle_vertex,
                hole,
                ..
            })
            | EventContact::Root(RootContactDocument::A {
                obstacle,
                obstacle_vertex,
                hole,
                ..
            }) => of_obstacle(obstacle, *hole, *obstacle_vertex),
            EventContact::Pawl(ContactDocument::Limit { .. }) => None,
        }
    }
}

fn track(history: &PawlDocument, phases: &[Phase]) -> Vec<Stroke> {
    let stroke = |s: &SegmentDocument| {
        let (from, to) = (s.from.approx(), s.to.approx());
        let curve = s.curve.as_ref().map(|c| {
            let sign = if s.branch == Some("-") { -1.0 } else { 1.0 };
            Curve::new(c, sign, phases[s.phase].from)
        });
        let mut points: Vec<Point> = Vec::with_capacity(PIECES + 1);
        let pieces = if curve.is_some() { PIECES } else { 1 };
        for k in 0..=pieces {
            // Dense towards both ends, where a curve may turn vertical.
            let share = 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / pieces as f64).cos();
            let t = if k == pieces {
                to
            } else {
                from + share * (to - from)
            };
            let theta = curve.as_ref().map_or(0.0, |c| c.theta(t));
            let near = match points.last() {
                Some(last) => last[1],
                None => theta + TAU * s.winding[0] as f64,
            };
            points.push([t, lifted(theta, near)]);
        }
        Stroke {
            free: curve.is_none(),
            phase: s.phase,
            points,
            curve,
        }
    };
    history.segments.iter().map(stroke).collect()
}

/// θ plus the whole turns that bring it nearest.
fn lifted(theta: f64, near: f64) -> f64 {
    theta + TAU * ((near - theta) / TAU).round()
}

impl Stroke {
    fn spans(&self, t: f64) -> bool {
        self.points[0][0] <= t && self.points.last().is_some_and(|p| p[0] >= t)
    }
    fn theta(&self, t: f64) -> f64 {
        let near = self
            .points
            .iter()
            .min_by(|a, b| (a[0] - t).abs().total_cmp(&(b[0] - t).abs()));
        match (&self.curve, near) {
            (Some(c), Some(near)) if self.spans(t) => lifted(c.theta(t), near[1]),
            (_, Some(near)) => near[1],
            _ => 0.0,
        }
    }
}

impl Curve {
    fn new(curve: &CurveDocument, sign: f64, from: f64) -> Curve {
        // A common factor keeps large coefficients within the double range.
        let read = |s: &String| s.parse::<Rat>().unwrap_or_default();
        let (p, q) = (curve.p.each_ref().map(read), curve.q.each_ref().map(read));
        let largest = p.iter().chain(&q).map(Rat::abs).max().unwrap_or_default();
        let scaled = |c: &Rat| {
            if largest.is_zero() {
                0.0
            } else {
                double(&(c / &largest))
            }
        };
        Curve {
            p: p.each_ref().map(scaled),
            q: q.each_ref().map(scaled),
            sign,
            from,
        }
    }
    fn theta(&self, t: f64) -> f64 {
        let t = t - self.from;
        let [c, b, a] = [0, 1, 2].map(|i| self.p[i] + t * self.q[i]);
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt() * self.sign;
        // u = n/d, in whichever form loses no digits; atan2 takes d = 0 in its stride.
        let (n, d) = if root * b <= 0.0 {
            (root - b, 2.0 * a)
        } else {
            (-2.0 * c, root + b)
        };
        if d < 0.0 {
            2.0 * (-n).atan2(-d)
        } else {
            2.0 * n.atan2(d)
        }
    }
}
