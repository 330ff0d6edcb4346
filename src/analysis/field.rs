//! A scene in double intervals, and the proof for one pawl over an arc of directions.
//!
//! Everything a proof by [`super::cells`] looks at, in certified intervals: obstacles, root and
//! pawls, their lengths in a unit in which doubles hold them. An arc is blocked if the root is, or
//! if of some pawl no cell is left; it is open if the root is clear of everything and every cell of
//! every pawl yields.

use super::cells::{Grid, View};
use super::escape::{Ground, Start};
use crate::contact::{PawlShape, Ring};
use crate::geometry::Vec2;
use crate::number::{Interval, Rat};
use std::cell::Cell;

/// What is in the model of a proof.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Model {
    /// Contacts slide freely.
    Shapes,
    /// Contacts stick.
    Friction,
    /// Contacts stick, and give way only to less than the limiting force.
    Force,
}

pub(super) type Point = [Interval; 2];

pub(super) fn point(v: &Vec2) -> Point {
    [v.x.interval(), v.y.interval()]
}

pub(super) fn dot(a: &Point, b: &Point) -> Interval {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn cross(a: &Point, b: &Point) -> Interval {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn minus(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn positive(i: Interval) -> bool {
    i.lo > 0.0
}

pub(super) fn negative(i: Interval) -> bool {
    i.hi < 0.0
}

/// One edge of a ring with its begin vertex, in intervals.
pub(super) struct Side {
    pub(super) at: Point,
    pub(super) next: usize,
    pub(super) prev: usize,
    pub(super) along: Point,
    pub(super) normal: Point,
    /// normal·at: the edge's line.
    pub(super) offset: Interval,
    pub(super) convex: bool,
    pub(super) length2: Interval,
    pub(super) normal_length: Interval,
}

/// A ring's sides, its lengths in the field's unit.
fn sides(ring: &Ring, unit: &Rat) -> Vec<Side> {
    (0..ring.len())
        .map(|i| {
            let (at, n) = (ring.vertices[i].scale(unit), ring.normals[i].scale(unit));
            let along = &ring.vertices[ring.next(i)].scale(unit) - &at;
            Side {
                at: point(&at),
                next: ring.next(i),
                prev: ring.prev(i),
                along: point(&along),
                normal: point(&n),
                offset: n.dot(&at).interval(),
                convex: ring.convex[i],
                length2: along.norm2().interval(),
                normal_length: n.norm2().interval().sqrt(),
            }
        })
        .collect()
}

/// An arc of directions as a box of unit vectors.
pub(super) type Directions = Point;

/// All obstacles' rings, the root and the pawls, in intervals.
pub(super) struct Field {
    pub(super) rings: Vec<Vec<Side>>,
    pub(super) root: Option<Vec<Side>>,
    pub(super) pawls: Vec<Body>,
    /// Cells looked at so far, times the corners in view.
    pub(super) spent: Cell<u64>,
    /// How many it may be.
    pub(super) allowed: Cell<u64>,
}

/// How much a cover may cost before the rest is left undecided; the paper's Fig. 5, extended,
/// takes a few hundredths of it.
const WORK: u64 = 2_000_000_000;

/// Past so many pairs of sides within reach at once nothing is tried: their table would fill the
/// memory, and the work would be over after a few cells anyway.
const PAIRS: usize = 4_000_000;

pub(super) struct Body {
    pub(super) sides: Vec<Side>,
    /// The hinge where the ways out begin.
    pub(super) hinge: Point,
    pub(super) reach: f64,
    pub(super) start: (i64, Interval),
    pub(super) limits: Option<[Interval; 2]>,
    pub(super) friction: Interval,
    /// k·√(1 + μ²) and the limiting force.
    pub(super) push: Option<(Interval, Interval)>,
}

/// How fine a proof is to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grain {
    /// Length of a slab, at least.
    pub(super) step: f64,
    /// A slab may be as long as this part of the time passed.
    pub(super) spread: f64,
    /// When to give up.
    pub(super) until: f64,
    /// When the time for the proof is up.
    pub(super) deadline: Option<std::time::Instant>,
}

impl Field {
    /// All lengths are taken in a unit in which doubles hold them: a power of two, so that the
    /// shapes stay what they are.
    pub(super) fn new(ground: &Ground<'_>, start: &Start, unit: &Rat) -> Field {
        let scene = ground.scene;
        let mu = scene.friction.clone().unwrap_or_else(Rat::zero);
        let limit = scene.classify.as_ref().and_then(|c| c.force_limit.clone());
        let body = |i: usize, shape: &PawlShape| {
            let pawl = &scene.pawls[i];
            let reach2 = shape
                .ring
                .vertices
                .iter()
                .map(|a| a.scale(unit).norm2())
                .max();
            let push = pawl.stiffness.as_ref().zip(limit.as_ref()).map(|(k, f)| {
                // A torque is a force times a length.
                let k = k * unit;
                let scale = (k.square() * (Rat::one() + mu.square())).interval().sqrt();
                (scale, f.interval())
            });
            Body {
                sides: sides(&shape.ring, unit),
                hinge: point(&(&pawl.hinge + &start.offset).scale(unit)),
                reach: reach2.unwrap_or_default().interval().sqrt().hi,
                start: (start.angles[i].half_turn, start.angles[i].x.interval()),
                limits: pawl
                    .limits
                    .as_ref()
                    .map(|(a, b)| [a.interval(), b.interval()]),
                friction: mu.interval(),
                push,
            }
        };
        Field {
            rings: ground
                .obstacles
                .iter()
                .flat_map(|o| &o.rings)
                .map(|ring| sides(ring, unit))
                .collect(),
            root: scene.root.as_ref().map(|r| {
                let moved = r.vertices.iter().map(|p| p + &start.offset).collect();
                sides(&Ring::new(moved, false), unit)
            }),
            pawls: ground
                .shapes
                .iter()
                .enumerate()
                .map(|(i, s)| body(i, s))
                .collect(),
            spent: Cell::new(0),
            allowed: Cell::new(WORK),
        }
    }

    /// The pawl that reaches farthest, for choosing a grain.
    pub(super) fn reach(&self) -> f64 {
        self.pawls.iter().map(|p| p.reach).fold(0.0, f64::max)
    }

    /// Whether no motion in one of the directions gets past `grain.until`: some pawl, or the
    /// root, is shown to be blocked before.
    pub(super) fn blocked(&self, w: &Directions, model: Model, grain: &Grain) -> bool {
        let root = self.root_blocked(w, grain);
        self.pawls
            .iter()
            .any(|body| self.pawl_blocked(body, w, model, grain, root))
    }

    /// A time from which on the root collides in every direction, at the grain's steps: the
    /// begin of the first slab that is blocked throughout.
    fn root_blocked(&self, w: &Directions, grain: &Grain) -> f64 {
        let Some(root) = &self.root else {
            return f64::INFINITY;
        };
        for slab in Slabs::new(grain) {
            let d = [slab * w[0], slab * w[1]];
            let still = [Interval::point(1.0), Interval::point(0.0)];
            if self
                .rings
                .iter()
                .any(|ring| crosses(root, ring, &d, &still))
            {
                return slab.lo;
            }
        }
        f64::INFINITY
    }

    fn pawl_blocked(
        &self,
        body: &Body,
        w: &Directions,
        model: Model,
        grain: &Grain,
        root: f64,
    ) -> bool {
        let grid = self.grid(body, grain);
        let mut live = grid.cells_of(body.start.0, body.start.1);
        let mut first = true;
        for slab in Slabs::new(grain) {
            if slab.lo >= root {
                return true;
            }
            if self.tired(grain) {
                return false;
            }
            let Some(near) = self.near_enough(body, w, slab) else {
                return false;
            };
            let mut view = View::new(self, body, w, (model, grid, slab), &near);
            match view.advance(&live, first) {
                Some(next) => live = next,
                None => return false,
            }
            first = false;
            if live.is_empty() {
                return true;
            }
        }
        false
    }

    /// Whether every motion in one of the directions runs at least to `grain.until`: the root
    /// touches nothing, and nothing stops any pawl.
    pub(super) fn open(&self, w: &Directions, grain: &Grain) -> bool {
        self.root_clear(w, grain) && self.pawls.iter().all(|body| self.pawl_open(body, w, grain))
    }

    fn root_clear(&self, w: &Directions, grain: &Grain) -> bool {
        let Some(root) = &self.root else {
            return true;
        };
        let corners: usize = self.rings.iter().map(Vec::len).sum();
        let cost = (corners * root.len()) as u64;
        Slabs::through(grain).all(|slab| {
            self.spent.set(self.spent.get() + cost);
            let d = [slab * w[0], slab * w[1]];
            !self.tired(grain) && self.rings.iter().all(|ring| apart(root, ring, &d))
        })
    }

    fn pawl_open(&self, body: &Body, w: &Directions, grain: &Grain) -> bool {
        let grid = self.grid(body, grain);
        let mut live = grid.cells_of(body.start.0, body.start.1);
        let mut first = true;
        for slab in Slabs::through(grain) {
            if self.tired(grain) {
                return false;
            }
            let Some(near) = self.near_enough(body, w, slab) else {
                return false;
            };
            // Whatever friction would do, a pawl may be where shapes let it.
            let mut view = View::new(self, body, w, (Model::Shapes, grid, slab), &near);
            match view.advance(&live, first) {
                Some(next) if !next.is_empty() => live = next,
                _ => return false,
            }
            first = false;
            if !live.iter().all(|c| view.yields(*c)) {
                return false;
            }
        }
        true
    }

    /// Whether the work or the time for a proof is spent.
    fn tired(&self, grain: &Grain) -> bool {
        let late = |d: std::time::Instant| std::time::Instant::now() >= d;
        self.spent.get() > self.allowed.get() || grain.deadline.is_some_and(late)
    }

    fn grid(&self, body: &Body, grain: &Grain) -> Grid {
        let per_half_turn = (3.2 * body.reach / grain.step).clamp(15.0, 4000.0) as i64 | 1;
        Grid { n: per_half_turn }
    }

    /// What is near, if that is not too much for a table.
    fn near_enough(&self, body: &Body, w: &Directions, slab: Interval) -> Option<Vec<Vec<bool>>> {
        let near = self.near(body, w, slab);
        let seen = near.iter().flatten().filter(|n| **n).count();
        (seen.saturating_mul(body.sides.len()) <= PAIRS).then_some(near)
    }

    /// The obstacle edges (ring, index) that the pawl can reach within a slab; a vertex comes with
    /// both its edges.
    fn near(&self, body: &Body, w: &Directions, slab: Interval) -> Vec<Vec<bool>> {
        let reach = Interval {
            lo: -body.reach,
            hi: body.reach,
        };
        let span = |k: usize| body.hinge[k] + slab * w[k] + reach;
        let (x, y) = (span(0), span(1));
        self.rings
            .iter()
            .map(|ring| {
                ring.iter()
                    .map(|s| {
                        let to = &ring[s.next].at;
                        s.at[0].hull(&to[0]).meets(&x) && s.at[1].hull(&to[1]).meets(&y)
                    })
                    .collect()
            })
            .collect()
    }
}

/// Whether some edge of a turned (`turn` = (cos, sin)) and displaced body properly crosses an edge
/// of a ring throughout.
fn crosses(body: &[Side], ring: &[Side], shift: &Point, turn: &Point) -> bool {
    // Signs of body vertices against ring edges, and of ring vertices against body edges.
    let vertex = |b: &Side, r: &Side| {
        let turned = dot(&b.at, &r.normal) * turn[0] + cross(&b.at, &r.normal) * turn[1];
        turned + dot(shift, &r.normal) - r.offset
    };
    let edge = |b: &Side, r: &Side| {
        let q = minus(&r.at, shift);
        dot(&b.normal, &q) * turn[0] + cross(&b.normal, &q) * turn[1] - b.offset
    };
    let apart = |a: Interval, b: Interval| positive(a) && negative(b) || negative(a) && positive(b);
    ring.iter().any(|r| {
        body.iter().any(|b| {
            apart(vertex(b, r), vertex(&body[b.next], r))
                && apart(edge(b, r), edge(b, &ring[r.next]))
        })
    })
}

/// Whether every edge of a displaced body is apart from every edge of a ring throughout.
fn apart(body: &[Side], ring: &[Side], shift: &Point) -> bool {
    let span = |b: &Side, k: usize| {
        let [from, to] = [b.at[k], body[b.next].at[k]];
        from.hull(&to) + shift[k]
    };
    // A line of one with both ends of the other on one side of it.
    let parted =
        |a: Interval, b: Interval| positive(a) && positive(b) || negative(a) && negative(b);
    body.iter().all(|b| {
        ring.iter().all(|r| {
            let boxed = |k: usize| r.at[k].hull(&ring[r.next].at[k]).meets(&span(b, k));
            let above = |b: &Side| dot(&b.at, &r.normal) + dot(shift, &r.normal) - r.offset;
            let beyond = |r: &Side| dot(&b.normal, &minus(&r.at, shift)) - b.offset;
            !boxed(0)
                || !boxed(1)
                || parted(above(b), above(&body[b.next]))
                || parted(beyond(r), beyond(&ring[r.next]))
        })
    })
}

/// Consecutive slabs of time from 0 to the grain's end.
struct Slabs {
    t: f64,
    grain: Grain,
    /// Whether the last one reaches past the end, rather than ending before it.
    through: bool,
}

impl Slabs {
    fn new(grain: &Grain) -> Slabs {
        Slabs {
            t: 0.0,
            grain: *grain,
            through: false,
        }
    }

    fn through(grain: &Grain) -> Slabs {
        Slabs {
            through: true,
            ..Slabs::new(grain)
        }
    }
}

impl Iterator for Slabs {
    type Item = Interval;
    fn next(&mut self) -> Option<Interval> {
        let lo = self.t;
        let hi = lo + self.grain.step.max(lo * self.grain.spread);
        self.t = hi;
        // Neighbouring slabs share their common instant; the last one ends before the end.
        let last = if self.through { lo } else { hi };
        let within = last <= self.grain.until && hi > lo;
        within.then_some(Interval { lo, hi })
    }
}
