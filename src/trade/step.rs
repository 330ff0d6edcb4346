//! Time stepping in doubles: DP §4.3, "Typical Simulation Algorithm", as it is done today.
//!
//! At every step the hinge moves on by v·dt. A pawl that then penetrates is turned away until it
//! does not; one that does not is let back towards rest until it touches. Collision detection
//! looks at the new place only. Contacts shorter than a step are missed, a jam is found when no
//! turn within reach helps, a snap when a turn is much larger than the one before.

use super::score::{Happening, Observed};
use crate::geometry::Vec2;
use crate::motion::OutcomeKind;
use crate::number::Rat;
use crate::scene::{Motion, Scene};
use std::time::Instant;

type P = [f64; 2];

/// How deep two bodies must overlap to count as overlapping.
const SKIN: f64 = 1e-9;
/// The largest turn by which a pawl is pushed out in one step.
const PUSH: f64 = 0.5;
/// A turn towards rest is a snap above this.
const SNAP: f64 = 0.05;

fn point(p: &Vec2) -> P {
    let f = |r: &Rat| r.nearest_f64().unwrap_or(f64::MAX);
    [f(&p.x), f(&p.y)]
}

/// An obstacle's rings, with its box.
struct Body {
    rings: Vec<Vec<P>>,
    low: P,
    high: P,
}

impl Body {
    fn new(rings: Vec<Vec<P>>) -> Body {
        let all = || rings.iter().flatten();
        let fold =
            |f: fn(f64, f64) -> f64, s: f64| [0, 1].map(|k| all().fold(s, |m, p| f(m, p[k])));
        let (low, high) = (
            fold(f64::min, f64::INFINITY),
            fold(f64::max, f64::NEG_INFINITY),
        );
        Body { rings, low, high }
    }
    fn holds(&self, p: P) -> bool {
        let mut inside = false;
        for r in &self.rings {
            for i in 0..r.len() {
                let (a, b) = (r[i], r[(i + 1) % r.len()]);
                if (a[1] > p[1]) != (b[1] > p[1])
                    && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]
                {
                    inside = !inside;
                }
            }
        }
        inside && self.edges().all(|(a, b)| distance(p, a, b) > SKIN)
    }
    fn edges(&self) -> impl Iterator<Item = (P, P)> {
        self.rings
            .iter()
            .flat_map(|r| (0..r.len()).map(|i| (r[i], r[(i + 1) % r.len()])))
    }
    fn overlaps(&self, o: &Body) -> bool {
        let apart = |k: usize| self.high[k] < o.low[k] || o.high[k] < self.low[k];
        if apart(0) || apart(1) {
            return false;
        }
        self.edges()
            .any(|(a, b)| o.edges().any(|(c, d)| crosses(a, b, c, d)))
            || self.rings.iter().flatten().any(|&p| o.holds(p))
            || o.rings.iter().flatten().any(|&p| self.holds(p))
    }
}

fn distance(p: P, a: P, b: P) -> f64 {
    let (d, w) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let s = ((w[0] * d[0] + w[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    (w[0] - s * d[0]).hypot(w[1] - s * d[1])
}

/// Whether two segments cross, by more than the skin on all four sides.
fn crosses(a: P, b: P, c: P, d: P) -> bool {
    let side = |a: P, b: P, p: P| {
        let l = (b[0] - a[0]).hypot(b[1] - a[1]).max(f64::MIN_POSITIVE);
        ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) / l
    };
    let split = |x: f64, y: f64| (x > SKIN && y < -SKIN) || (x < -SKIN && y > SKIN);
    split(side(a, b, c), side(a, b, d)) && split(side(c, d, a), side(c, d, b))
}

/// A pawl under way.
struct State<'a> {
    ring: Vec<P>,
    obstacles: &'a [Body],
    theta: f64,
    limits: (f64, f64),
    last_turn: f64,
    touching: bool,
    events: Vec<Happening>,
}

impl State<'_> {
    fn at(&self, p: P, theta: f64) -> Body {
        let (s, c) = theta.sin_cos();
        let turn = |q: &P| [c * q[0] - s * q[1] + p[0], s * q[0] + c * q[1] + p[1]];
        Body::new(vec![self.ring.iter().map(turn).collect()])
    }
    fn free(&self, p: P, theta: f64) -> bool {
        let body = self.at(p, theta);
        (self.limits.0..=self.limits.1).contains(&theta)
            && !self.obstacles.iter().any(|o| o.overlaps(&body))
    }
    /// Between a free orientation and one that is not: the last free one.
    fn edge(&self, p: P, mut free: f64, mut not: f64) -> f64 {
        for _ in 0..50 {
            let m = free.midpoint(not);
            if self.free(p, m) {
                free = m;
            } else {
                not = m;
            }
        }
        free
    }
    fn note(&mut self, coarse: &'static str, time: f64) {
        self.events.push(Happening {
            what: coarse.to_owned(),
            coarse: Some(coarse),
            time,
            theta: self.theta,
        });
    }
    /// One step; Some at a jam or where friction holds.
    fn step(&mut self, p: P, v: P, mu: Option<f64>, time: f64) -> Option<OutcomeKind> {
        let before = self.theta;
        if self.free(p, before) {
            self.let_back(p);
        } else {
            // Away from rest; from rest itself, the nearer way out.
            let sides: &[f64] = if before > 0.0 {
                &[1.0]
            } else if before < 0.0 {
                &[-1.0]
            } else {
                &[1.0, -1.0]
            };
            let mut reach = 1e-6;
            let out = loop {
                let to = sides.iter().map(|s| before + s * reach);
                if let Some(t) = to.into_iter().find(|&t| self.free(p, t)) {
                    break Some(t);
                }
                reach *= 1.5;
                if reach > PUSH {
                    break None;
                }
            };
            let Some(out) = out else {
                return Some(OutcomeKind::Jammed);
            };
            self.theta = self.edge(p, out, before);
            if !self.touching {
                self.note("strike", time);
            }
            self.touching = true;
        }
        let turn = self.theta - before;
        if self.touching && before != 0.0 {
            let towards = turn * before < 0.0;
            if towards && turn.abs() > SNAP && turn.abs() > 10.0 * self.last_turn.abs() {
                self.theta = before;
                self.note("snap", time);
                self.theta = before + turn;
            } else if self.theta == 0.0 {
                self.note("release", time);
            }
        }
        if self.theta == 0.0 {
            self.touching = false;
        }
        self.last_turn = turn;
        let held = self.touching && mu.is_some_and(|mu| self.sticks(p, v, mu));
        held.then_some(OutcomeKind::Stuck)
    }
    /// Turns towards rest as far as nothing is in the way.
    fn let_back(&mut self, p: P) {
        let mut at = self.theta;
        while at != 0.0 {
            let next = if at.abs() <= 0.01 {
                0.0
            } else {
                at - 0.01f64.copysign(at)
            };
            if !self.free(p, next) {
                at = self.edge(p, at, next);
                break;
            }
            at = next;
        }
        self.theta = at;
    }
    /// Coulomb friction at the nearest contact (DP §6, §7, as in `motion::friction`).
    fn sticks(&self, p: P, v: P, mu: f64) -> bool {
        let body = self.at(p, self.theta);
        let mut best = (1e-4, None);
        for o in self.obstacles {
            for (mine, (vs, es)) in [(true, (&body, o)), (false, (o, &body))] {
                for &q in vs.rings.iter().flatten() {
                    for (a, b) in es.edges() {
                        let d = distance(q, a, b);
                        if d < best.0 {
                            best = (d, Some((q, a, b, mine)));
                        }
                    }
                }
            }
        }
        let (_, Some((q, a, b, type_b))) = best else {
            return false;
        };
        let l = (b[0] - a[0]).hypot(b[1] - a[1]);
        let n = [(b[1] - a[1]) / l, -(b[0] - a[0]) / l];
        let r = [q[0] - p[0], q[1] - p[1]];
        let (mut ry, rx) = (r[0] * n[0] + r[1] * n[1], r[0] * n[1] - r[1] * n[0]);
        // Outward: the edge of an obstacle faces the hinge's side of the contact; a pawl's edge
        // faces away from the pawl's middle.
        let mid = body.rings[0]
            .iter()
            .fold([0.0, 0.0], |m, p| [m[0] + p[0], m[1] + p[1]]);
        let k = body.rings[0].len() as f64;
        let inward = (mid[0] / k - q[0]) * n[0] + (mid[1] / k - q[1]) * n[1];
        if (inward < 0.0) == type_b {
            ry = -ry;
        }
        let d = v[0] * r[0] + v[1] * r[1];
        let pull = if type_b { -mu * ry } else { mu * ry };
        (d > 0.0 && pull > rx.abs()) || (d < 0.0 && -pull > rx.abs())
    }
}

/// Steps through the whole plan, `steps` of one length; None where the time is over.
pub fn simulate(scene: &Scene, steps: u32, deadline: Option<Instant>) -> Option<Observed> {
    let mut plan = plan(scene)?;
    let obstacles: Vec<Body> = scene
        .obstacles
        .iter()
        .map(|o| {
            let rings = std::iter::once(&o.vertices).chain(&o.holes);
            Body::new(rings.map(|r| r.iter().map(point).collect()).collect())
        })
        .collect();
    let tan = |u: &Rat| 2.0 * u.nearest_f64().unwrap_or(f64::MAX).atan();
    let mut pawls: Vec<(P, State<'_>)> = scene
        .pawls
        .iter()
        .map(|p| {
            let h = point(&p.hinge);
            let ring = p.vertices.iter().map(point);
            let state = State {
                ring: ring.map(|q| [q[0] - h[0], q[1] - h[1]]).collect(),
                obstacles: &obstacles,
                theta: tan(&p.start),
                limits: p
                    .limits
                    .as_ref()
                    .map_or((f64::NEG_INFINITY, f64::INFINITY), |(a, b)| {
                        (tan(a), tan(b))
                    }),
                last_turn: 0.0,
                touching: p.start.sign() != 0,
                events: Vec::new(),
            };
            (h, state)
        })
        .collect();
    let root: Option<Vec<P>> = scene
        .root
        .as_ref()
        .map(|r| r.vertices.iter().map(point).collect());
    let mu = scene
        .friction
        .as_ref()
        .map(|m| m.nearest_f64().unwrap_or(f64::MAX));
    let whole: f64 = plan.iter().map(|p| p.duration).sum();
    let dt = whole / f64::from(steps.max(1));
    let (mut clock, mut offset) = (0.0, [0.0, 0.0]);
    let mut end = (OutcomeKind::Completed, None);
    'plan: for index in 0..plan.len() {
        let (v, mut duration) = (plan[index].v, plan[index].duration);
        let n = (duration / dt).ceil().max(1.0) as u64;
        for i in 1..=n {
            if deadline.is_some_and(|d| Instant::now() >= d) {
                return None;
            }
            let t = (i as f64 * dt).min(duration);
            let moved = [offset[0] + v[0] * t, offset[1] + v[1] * t];
            for (k, (h, state)) in pawls.iter_mut().enumerate() {
                let p = [h[0] + moved[0], h[1] + moved[1]];
                if let Some(kind) = state.step(p, v, mu, clock + t) {
                    end = (kind, Some(k));
                    break 'plan;
                }
            }
            if let Some(ring) = &root {
                let there = ring.iter().map(|q| [q[0] + moved[0], q[1] + moved[1]]);
                let body = Body::new(vec![there.collect()]);
                if obstacles.iter().any(|o| o.overlaps(&body)) {
                    if plan[index].until_root {
                        duration = t;
                        if let Some(next) = plan.get_mut(index + 1).filter(|p| p.back) {
                            next.duration = t;
                        }
                        break;
                    }
                    end = (OutcomeKind::RootCollision, None);
                    break 'plan;
                }
            }
        }
        offset = [offset[0] + v[0] * duration, offset[1] + v[1] * duration];
        clock += duration;
    }
    Some(Observed {
        outcome: end.0,
        pawl: end.1,
        events: pawls.into_iter().map(|(_, s)| s.events).collect(),
    })
}

/// A phase: velocity, longest duration, and whether it ends when the root collides.
struct Phase {
    v: P,
    duration: f64,
    until_root: bool,
    /// Whether it goes back along the phase before.
    back: bool,
}

fn plan(scene: &Scene) -> Option<Vec<Phase>> {
    // Where no duration is given, as long as it takes to leave the scene's box.
    let all = || {
        let fixed = scene.obstacles.iter().flat_map(|o| &o.vertices);
        let root = scene.root.iter().flat_map(|r| &r.vertices);
        fixed.chain(root).map(point)
    };
    let span = |k: usize| {
        let most = all().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
        most - all().map(|p| p[k]).fold(f64::INFINITY, f64::min)
    };
    let size = span(0).hypot(span(1));
    let mut out: Vec<Phase> = Vec::new();
    for m in &scene.motions {
        out.push(match m {
            Motion::Translate {
                velocity,
                duration,
                until_root_collision,
            } => {
                let v = point(velocity);
                let bound = duration.as_ref().and_then(Rat::nearest_f64);
                Phase {
                    v,
                    duration: bound.unwrap_or(size / v[0].hypot(v[1])),
                    until_root: *until_root_collision,
                    back: false,
                }
            }
            Motion::Reverse => {
                let last = out.last()?;
                Phase {
                    v: [-last.v[0], -last.v[1]],
                    duration: last.duration,
                    until_root: false,
                    back: true,
                }
            }
        });
    }
    Some(out)
}
