//! A proof for a whole arc of directions: where the pawl can be, by cells.
//!
//! Take every direction w of an arc at once. Time is cut into slabs, orientation into cells; a
//! cell of a slab stands for all directions of the arc, all times of the slab and all orientations
//! of the cell. Everything is computed in certified intervals, so a cell can be shown
//!
//! * *blocked*: an edge of the pawl properly crosses an edge of an obstacle throughout; no pawl
//!   is there in any of these motions;
//! * *idle*: no contact that could hold a pawl away from rest is possible anywhere in it (the
//!   C-function has no zero, or the contact's conditions fail, or it pushes towards rest); a pawl
//!   that is not at rest cannot be there either;
//! * *locked*: every contact that could hold a pawl there sticks throughout (friction), or needs
//!   at least the limiting force throughout.
//!
//! What the clamp allows (see [`crate::motion`]) is followed from cell to cell: from one slab to
//! the next at the same orientation; away from rest only to the neighbouring cell, pushed by a
//! contact; towards rest through any cells that are not blocked (a snap), to stop at a contact or
//! at rest. At rest both ways round are followed. Every successor that cannot be excluded is kept,
//! so if no cell is left before the pawl is out, *no* motion of the arc gets out.
//!
//! The same cells can prove the opposite. A cell *yields* if every contact that is possible in it
//! surely pushes the pawl the same way, away from rest, and surely slides. Then the free interval
//! above a pawl in it cannot close there, nothing sticks, and no corner leaves open which way to
//! go. If every cell that a pawl can be in yields until it is out, *every* motion of the arc gets
//! out. Where neither is shown nothing is claimed.
//!
//! # Why this is no fourth kernel
//!
//! The design's other way is a kernel of intervals under the one sweep: the events of an arc of
//! directions in order, and every successor followed where the order is undecided. What is shared
//! with the sweep here is less: the clamp's rules, the C-functions with their conditions (types A
//! and B) and the test for sticking are written once more, in intervals over cells. In exchange
//! nothing is ever ordered or isolated. Over an arc of some width most events of a crowded scene
//! overlap in time, the tree of successors branches at each of them, and a branch may end in a
//! state that no direction of the arc reaches, which then blocks the proof. Cells merge what the
//! tree would keep apart: a slab costs its cells times the contacts in reach, however many
//! orders of events there are, and an arc that is too wide is halved, as it would be there. What is
//! lost is sharpness at critical directions, where cells would have to be infinitely fine; these
//! are decided one by one with the exact rule. And since the two codes share no line, the tests that hold
//! covers against exact single directions test one by the other.

use super::field::{
    Body, Directions, Field, Model, Point, Side, cross, dot, minus, negative, positive,
};
use crate::number::Interval;
use std::collections::{BTreeMap, BTreeSet};

/// Orientation in cells: n (odd) a half-turn, numbered along the covering line; θ = 0 is inside
/// cell (n − 1)/2 of half-turn 0, which is numbered 0.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    pub(super) n: i64,
}

impl Grid {
    fn half_turn(self, cell: i64) -> i64 {
        (cell + (self.n - 1) / 2).div_euclid(self.n)
    }
    fn x(self, cell: i64) -> Interval {
        let i = (cell + (self.n - 1) / 2).rem_euclid(self.n);
        let at = |k: i64| Interval::point((2 * k - self.n) as f64) / Interval::point(self.n as f64);
        at(i).hull(&at(i + 1))
    }
    pub(super) fn cells_of(self, half_turn: i64, x: Interval) -> Vec<i64> {
        let base = half_turn * self.n - (self.n - 1) / 2;
        (base - 1..=base + self.n)
            .filter(|&c| {
                let own = self.half_turn(c) == half_turn;
                own && self.x(c).meets(&x) || !own && (x.hi >= 1.0 || x.lo <= -1.0)
            })
            .collect()
    }
    /// (cos θ, sin θ).
    fn turn(self, cell: i64) -> Point {
        let x = self.x(cell);
        let one = Interval::point(1.0);
        let at = |x: f64| {
            let x = Interval::point(x.clamp(-1.0, 1.0));
            let d = one + x.square();
            ((one - x.square()) / d, (x + x) / d)
        };
        let (a, b) = (at(x.lo), at(x.hi));
        let mut c = a.0.hull(&b.0);
        if x.contains(0.0) {
            c = c.hull(&one);
        }
        let s = a.1.hull(&b.1);
        if self.half_turn(cell).rem_euclid(2) == 0 {
            [c, s]
        } else {
            [-c, -s]
        }
    }
    /// A lower bound of |θ|.
    fn least_angle(self, cell: i64) -> f64 {
        let h = self.half_turn(cell).abs();
        if h > 0 {
            return (h as f64 - 0.5) * 3.125;
        }
        let x = self.x(cell);
        let m = if x.contains(0.0) {
            0.0
        } else {
            x.lo.abs().min(x.hi.abs()).min(1.0)
        };
        // 2·arctan m ≥ 2(m − m³/3 + m⁵/5 − m⁷/7), in intervals.
        let m = Interval::point(m);
        let m2 = m.square();
        let f = |k: f64| Interval::point(1.0) / Interval::point(k);
        let series = m * (f(1.0) - m2 * (f(3.0) - m2 * (f(5.0) - m2 * f(7.0))));
        (series + series).lo.max(0.0)
    }
    /// An upper bound of |θ|.
    fn most_angle(self, cell: i64) -> f64 {
        let h = self.half_turn(cell).abs();
        let x = self.x(cell);
        // 2·arctan m ≤ 2m, and a half-turn is less than 3.15.
        let m = x.lo.abs().max(x.hi.abs());
        if h > 0 {
            (h as f64 + 0.5) * 3.15
        } else {
            2.0 * m
        }
    }
}

/// A contact that cannot be excluded in a cell.
struct Touch {
    /// F_θ.
    slope: Interval,
    /// ρ_y, and the sign that friction takes it with.
    rise: Interval,
    epsilon: f64,
    /// d: which way the contact slides.
    drag: Interval,
    /// Length of the normal.
    normal: Interval,
}

/// What is known of a cell.
#[derive(Clone, Copy)]
pub(super) struct Known {
    /// No pawl is there.
    blocked: bool,
    /// A contact or a stop may hold a pawl there, away from rest.
    holds: bool,
}

/// How far round a pawl is followed, in half-turns.
const TURNS: i64 = 4;

pub(super) struct View<'a> {
    field: &'a Field,
    body: &'a Body,
    w: &'a Directions,
    model: Model,
    slab: Interval,
    grid: Grid,
    rows: Vec<Row<'a>>,
    /// The cost of a look.
    cost: u64,
    known: BTreeMap<i64, Known>,
}

/// An obstacle's side with its begin vertex, as the pawl meets them during a slab. What does not
/// depend on the cell is computed once.
struct Row<'a> {
    ring: &'a [Side],
    side: usize,
    /// Whether the edge itself is within reach, and not only its begin vertex.
    edge: bool,
    /// The row of the edge's other end, where the edge is within reach.
    next: usize,
    /// n·(p − q): of the hinge above the edge's line.
    height: Interval,
    /// A pawl side each: a·n and a×n, then m·(q − p) and m×(q − p) at the start.
    pairs: Vec<[Interval; 4]>,
}

/// What is within reach during a slab: the sides, each with its begin vertex, and the vertices
/// alone whose other side is.
fn rows<'a>(
    field: &'a Field,
    body: &Body,
    w: &Directions,
    slab: Interval,
    near: &[Vec<bool>],
) -> Vec<Row<'a>> {
    let mut out: Vec<Row<'a>> = Vec::new();
    let base = body.hinge;
    for (ring, near) in field.rings.iter().zip(near) {
        let begin = out.len();
        for (side, r) in ring.iter().enumerate() {
            if !near[side] && !near[r.prev] {
                continue;
            }
            let q = minus(&r.at, &base);
            let pair = |b: &Side| {
                [
                    dot(&b.at, &r.normal),
                    cross(&b.at, &r.normal),
                    dot(&b.normal, &q),
                    cross(&b.normal, &q),
                ]
            };
            out.push(Row {
                ring,
                side,
                edge: near[side],
                next: 0,
                height: dot(&base, &r.normal) - r.offset + slab * dot(w, &r.normal),
                pairs: body.sides.iter().map(pair).collect(),
            });
        }
        for k in begin..out.len() {
            let other = ring[out[k].side].next;
            // Rows are in the ring's order: most likely the one after, or the first.
            let is = |n: usize| out.get(n).is_some_and(|row| row.side == other);
            let next = [k + 1, begin].into_iter().find(|n| is(*n));
            out[k].next = next
                .or_else(|| (begin..out.len()).find(|n| is(*n)))
                .unwrap_or(k);
        }
    }
    out
}

impl<'a> View<'a> {
    /// Of a slab of one body's motions.
    pub(super) fn new(
        field: &'a Field,
        body: &'a Body,
        w: &'a Directions,
        (model, grid, slab): (Model, Grid, Interval),
        near: &[Vec<bool>],
    ) -> View<'a> {
        let seen: usize = near.iter().flatten().filter(|n| **n).count();
        View {
            field,
            body,
            w,
            model,
            slab,
            grid,
            rows: rows(field, body, w, slab, near),
            cost: ((seen + 1) * body.sides.len()) as u64,
            known: BTreeMap::new(),
        }
    }

    /// The cells in which a pawl can be during the slab, from those of the slab before; None past
    /// the turns that are followed.
    pub(super) fn advance(&mut self, before: &[i64], first: bool) -> Option<Vec<i64>> {
        let mut live: BTreeSet<i64> = BTreeSet::new();
        let mut queue: Vec<i64> = Vec::new();
        for &c in before {
            // Where a motion begins the pawl may be held by nothing, and snaps.
            if first && !self.known(c).blocked || self.alive(c) {
                live.insert(c);
                queue.push(c);
            }
        }
        while let Some(c) = queue.pop() {
            if c.abs() > TURNS * self.grid.n {
                return None;
            }
            let mut reached = Vec::new();
            let away: &[i64] = match c.signum() {
                0 => &[1, -1],
                1 => &[1],
                _ => &[-1],
            };
            for d in away {
                if self.alive(c + d) {
                    reached.push(c + d);
                }
            }
            let mut at = c;
            while at != 0 {
                at -= at.signum();
                if live.contains(&at) && at != 0 && self.alive(at) {
                    // It has gone on from there itself.
                    break;
                }
                if self.known(at).blocked {
                    break;
                }
                if self.alive(at) {
                    reached.push(at);
                }
            }
            for r in reached {
                if live.insert(r) {
                    queue.push(r);
                }
            }
        }
        // One that only began here and is held by nothing is gone.
        Some(live.into_iter().filter(|&c| self.alive(c)).collect())
    }

    fn alive(&mut self, cell: i64) -> bool {
        let k = self.known(cell);
        !k.blocked && (cell == 0 || k.holds)
    }

    fn known(&mut self, cell: i64) -> Known {
        if let Some(k) = self.known.get(&cell) {
            return *k;
        }
        let k = self.look(cell);
        self.known.insert(cell, k);
        k
    }

    fn look(&self, cell: i64) -> Known {
        let stop = self.stop(cell);
        let mut out = Known {
            blocked: stop == Some(false),
            holds: stop == Some(true),
        };
        if out.blocked {
            return out;
        }
        let side = cell.signum();
        let angle = self.grid.least_angle(cell);
        let mut sought = !out.holds;
        out.blocked = self.scan(cell, &mut sought, &mut |touch| {
            !self.holds(touch, side, angle)
        });
        out.holds |= !sought;
        out
    }

    /// Whether nothing in the cell can stop a pawl that is there: every contact that is possible
    /// pushes it one way, away from rest, and slides; see the head of the module.
    pub(super) fn yields(&self, cell: i64) -> bool {
        if self.stop(cell).is_some() {
            return false;
        }
        let most = self.grid.most_angle(cell);
        // At rest the first contact says which way.
        let mut side = cell.signum();
        let mut so_far = true;
        let blocked = self.scan(cell, &mut so_far, &mut |touch| {
            let way = i64::from(touch.slope.sign().unwrap_or(0));
            if side == 0 {
                side = way;
            }
            way != 0 && way == side && self.slides(touch, side, most)
        });
        blocked || so_far
    }

    /// Looks at every contact that cannot be excluded in the cell, as long as `go_on` holds, which
    /// is set to what `each` says. Whether the cell is blocked.
    fn scan(&self, cell: i64, go_on: &mut bool, each: &mut dyn FnMut(&Touch) -> bool) -> bool {
        self.field.spent.set(self.field.spent.get() + self.cost);
        let turn = self.grid.turn(cell);
        let base = self.body.hinge;
        let slab = self.slab;
        let w = *self.w;
        let shift = [base[0] + slab * w[0], base[1] + slab * w[1]];
        let pawl = &self.body.sides;
        let turned = |c: Interval, s: Interval| c * turn[0] + s * turn[1];
        // n·(R a + p − q).
        let vertex = |b: usize, row: &Row<'_>| {
            let [c, s, ..] = row.pairs[b];
            turned(c, s) + row.height
        };
        // (q − p)·R m − e, for all sides of the pawl at once.
        let moved: Vec<Interval> = pawl
            .iter()
            .map(|b| slab * turned(dot(&b.normal, &w), cross(&b.normal, &w)) + b.offset)
            .collect();
        let edges = |row: &Row<'_>| -> Vec<Interval> {
            let each = row.pairs.iter().zip(&moved);
            each.map(|([.., c, s], m)| turned(*c, *s) - *m).collect()
        };
        let apart =
            |a: Interval, b: Interval| positive(a) && negative(b) || negative(a) && positive(b);
        let mut known: Vec<Option<Vec<Interval>>> = vec![None; self.rows.len()];
        for (k, row) in self.rows.iter().enumerate() {
            let r = &row.ring[row.side];
            let fa = known[k].get_or_insert_with(|| edges(row)).clone();
            if row.edge {
                let fb: Vec<Interval> = (0..pawl.len()).map(|b| vertex(b, row)).collect();
                let crossing = |b: usize| apart(fb[b], fb[pawl[b].next]);
                if (0..pawl.len()).any(crossing) {
                    let next = known[row.next].get_or_insert_with(|| edges(&self.rows[row.next]));
                    if (0..pawl.len()).any(|b| crossing(b) && apart(fa[b], next[b])) {
                        return true;
                    }
                }
                for (b, f) in pawl.iter().zip(&fb) {
                    if *go_on
                        && b.convex
                        && f.contains(0.0)
                        && let Some(touch) = self.type_b(b, r, &turn, &shift)
                    {
                        *go_on = each(&touch);
                    }
                }
            }
            for (b, f) in pawl.iter().zip(&fa) {
                if *go_on
                    && r.convex
                    && f.contains(0.0)
                    && let Some(touch) = self.type_a(b, r, row.ring, &turn, &shift)
                {
                    *go_on = each(&touch);
                }
            }
        }
        false
    }

    /// The contact of a pawl vertex with an obstacle edge in the cell, if there may be one.
    fn type_b(&self, b: &Side, r: &Side, turn: &Point, shift: &Point) -> Option<Touch> {
        let pawl = &self.body.sides;
        let turned = |v: &Point, n: &Point| dot(v, n) * turn[0] + cross(v, n) * turn[1];
        let behind = minus(&pawl[b.prev].at, &b.at);
        if negative(turned(&b.along, &r.normal)) || negative(turned(&behind, &r.normal)) {
            return None;
        }
        let place = turned(&b.at, &r.along) + dot(&minus(shift, &r.at), &r.along);
        if negative(place) || positive(place - r.length2) {
            return None;
        }
        // R a·n and its derivative.
        let (c, s) = (dot(&b.at, &r.normal), cross(&b.at, &r.normal));
        Some(Touch {
            slope: s * turn[0] - c * turn[1],
            rise: c * turn[0] + s * turn[1],
            drag: turned(&b.at, self.w),
            epsilon: 1.0,
            normal: r.normal_length,
        })
    }

    /// The contact of an obstacle vertex with a pawl edge in the cell, if there may be one.
    fn type_a(
        &self,
        b: &Side,
        r: &Side,
        ring: &[Side],
        turn: &Point,
        shift: &Point,
    ) -> Option<Touch> {
        let turned = |v: &Point, n: &Point| dot(v, n) * turn[0] + cross(v, n) * turn[1];
        let behind = minus(&ring[r.prev].at, &r.at);
        if negative(turned(&b.normal, &r.along)) || negative(turned(&b.normal, &behind)) {
            return None;
        }
        let q = minus(&r.at, shift);
        let place = turned(&b.along, &q) - dot(&b.along, &b.at);
        if negative(place) || positive(place - b.length2) {
            return None;
        }
        let (c, s) = (dot(&b.normal, &q), cross(&b.normal, &q));
        Some(Touch {
            slope: s * turn[0] - c * turn[1],
            rise: b.offset,
            drag: dot(self.w, &q),
            epsilon: -1.0,
            normal: b.normal_length,
        })
    }

    /// |F_θ| + ε·μ·sgn(d)·ρ_y of a contact that pushes to a side: where it is negative the contact
    /// sticks, and the contact's force is inverse to it.
    fn room(&self, touch: &Touch, side: i64) -> Interval {
        let push = if side > 0 { touch.slope } else { -touch.slope };
        let rub = self.body.friction * touch.rise * Interval::point(touch.epsilon);
        let rub = match touch.drag.sign() {
            Some(s) => rub * Interval::point(f64::from(s)),
            None => rub.hull(&-rub),
        };
        push + rub
    }

    /// Whether a contact may hold a pawl away from rest and let it slide: F_θ pushes the right
    /// way, and |F_θ| + ε·μ·sgn(d)·ρ_y may be positive and, with forces in the model, small
    /// enough for none to reach the limit.
    fn holds(&self, touch: &Touch, side: i64, angle: f64) -> bool {
        match side {
            0 => return true,
            1 if negative(touch.slope) => return false,
            -1 if positive(touch.slope) => return false,
            _ => {}
        }
        if self.model == Model::Shapes {
            return true;
        }
        let most = self.room(touch, side).hi;
        if most < 0.0 {
            return false;
        }
        if self.model == Model::Force
            && let Some((scale, limit)) = self.body.push
        {
            let force = scale * touch.normal * Interval::point(angle);
            return (limit * Interval::point(most.max(0.0))).hi > force.lo;
        }
        true
    }

    /// Whether a contact that pushes to a side surely slides, and surely needs less than the
    /// limiting force, where there is one.
    fn slides(&self, touch: &Touch, side: i64, angle: f64) -> bool {
        let least = self.room(touch, side).lo;
        least > 0.0
            && self.body.push.is_none_or(|(scale, limit)| {
                let force = scale * touch.normal * Interval::point(angle);
                (limit * Interval::point(least)).lo > force.hi
            })
    }

    /// Some(false): past an angular stop; Some(true): on one.
    fn stop(&self, cell: i64) -> Option<bool> {
        let [lo, hi] = self.body.limits?;
        let h = self.grid.half_turn(cell);
        if h.abs() > 1 {
            return Some(false);
        }
        let x = self.grid.x(cell);
        // tan(θ/2) is x, or −1/x past a quarter-turn.
        let u = if h == 0 {
            x
        } else if x.contains(0.0) {
            return Some(true);
        } else {
            -(Interval::point(1.0) / x)
        };
        // Half-turn 1 with x > 0, or −1 with x < 0, lies past a whole half-turn.
        let past = h != 0 && (u.lo > 0.0) != (h > 0);
        if past || u.hi < lo.lo || u.lo > hi.hi {
            return Some(false);
        }
        (u.meets(&lo) || u.meets(&hi)).then_some(true)
    }
}
