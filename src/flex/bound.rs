//! An outer bound on the true flex: no motion without collision, however long and curved, moves
//! the objective farther than this.
//!
//! *One joint.* What two bodies A and B forbid each other depends on B's place in A's frame alone:
//! (ξ, φ), its reference point and its angle, counted from the start as (Δξ, φ). Take a region
//! |Δξ| ≤ a, |φ| ≤ b. Inside it a signed distance differs from its linear part by no more than a
//! second-order slack in a and b, and a vertex that starts outside an edge stays there, as long as
//! its foot cannot leave the edge (below). So every collision-free path inside the region lies in
//! a polyhedron of three variables. If that polyhedron lies strictly inside the region, the path
//! can never have reached the region's boundary: it is there for good, and the polyhedron's own
//! extent is a smaller region, with which the slack is taken anew.
//!
//! *When does a vertex stay outside an edge?* If its foot stays on the edge: passing the line
//! there means entering the solid. Past a reflex end: if the line goes on inside the solid. Past a
//! convex end c by at most τ: if an edge g of the vertex runs back along the edge, at an angle of
//! at most ψ to it. Then either c is on the outer side of g, and the vertex lies at most τ·tan ψ
//! behind the line, or g leads through the solid at c. A vertex of which none can be said gives no
//! row, which only makes the bound larger.
//!
//! *All joints.* Variables are the angles θ of all bodies and Δξ of all joints. Rows are those of
//! the joints, and closed chains of bodies: Σ ±R(θ_A)ξ = 0 round a chain, turned into the frame of
//! its first body, holds only *relative* angles, which are small, so its linear part is off by
//! little. The objective is summed along a chain of joints from a fixed body. What the
//! linearisation of these may lose is added to the optimum, which is exact and certified.
//!
//! *What is not proven.* The slacks and losses are computed in doubles and rounded outwards by a
//! margin (`up`) that is generous for coordinates of ordinary size, not by an error analysis. Until
//! they are intervals the bound is as sound as that margin.

use super::model::{Form, Row, Scaffold};
use super::pairs::{Plane, Point, select};
use super::shape::{Placed, double};
use super::types::Structure;
use crate::certificate::lp::{Claim, verify};
use crate::geometry::{Corner, Meeting, Vec2, meet};
use crate::lp::{self, Model, Range, Status};
use crate::number::Rat;
use std::collections::{BTreeMap, HashMap, VecDeque};

/// An outer bound; the module says what of it is proven.
#[derive(Clone, Debug)]
pub struct OuterBound {
    /// No collision-free motion gains more.
    pub value: Rat,
    /// The exact optimum of the relaxed program, part of it.
    pub relaxed: Rat,
    /// What its linearised objective may lose, the other part.
    pub loss: Rat,
    /// Rows and columns of the relaxed program.
    pub size: (usize, usize),
    /// Rows of joints that could not be used.
    pub dropped: usize,
    /// Whether the relaxed program's certificate passed the verifier.
    pub verified: bool,
}

/// A joint with the region that no path leaves.
struct Hinge {
    a: usize,
    b: usize,
    rows: Vec<Sighted>,
    /// |Δξ| ≤ shift in x and in y, |φ| ≤ turn.
    shift: [f64; 2],
    turn: f64,
    dropped: usize,
}

/// A row of a joint in doubles for the slack, exact for the program.
struct Sighted {
    row: Row,
    /// Whether the line is body a's.
    of_first: bool,
    /// The length of its normal, from above.
    length: f64,
    /// Coefficient of φ when x₂ − x₁ and θ_B − θ_A are the variables.
    phi: Rat,
    /// From the turning centre to what turns: its length, its part along the normal and along the
    /// edge.
    arm: f64,
    inward: f64,
    swing: f64,
    /// The edge's direction.
    unit: [f64; 2],
    /// Start of the foot along the edge, the edge's length.
    foot: f64,
    edge_length: f64,
    /// What happens past either end.
    ends: [Past; 2],
}

/// Past an end of an edge.
#[derive(Clone, Copy)]
enum Past {
    /// The line goes on inside the solid this far.
    Solid(f64),
    /// An edge of the vertex runs back along it at this angle, as far as this.
    Along(f64, f64),
    /// Nothing is known.
    Open,
}

/// Rounds outwards what was computed in doubles with a few dozen operations.
fn up(v: f64) -> f64 {
    v * (1.0 + 1e-9) + 1e-13
}

fn rational(v: f64) -> Rat {
    if v.is_finite() {
        // Short, and not below.
        let scale = 2f64.powi(50);
        Rat::from_f64((v * scale).ceil().min(2f64.powi(100)) / scale)
    } else {
        Rat::from(1 << 40)
    }
}

/// Bounds the objective of a structure over all collision-free motions from its start.
///
/// # Errors
/// Why there is no bound: a pinned body, a body that no chain of joints ties to a fixed one, a
/// joint that does not hold, a limit.
///
/// Cost: six small programs a joint and round, and one large one.
pub fn outer_bound(
    structure: &Structure,
    time_limit: Option<std::time::Duration>,
) -> Result<OuterBound, String> {
    let scaffold = Scaffold::new(structure);
    if scaffold.forms.contains(&Form::Pinned) {
        return Err("a pinned body is not bounded here".to_owned());
    }
    let placed = scaffold.place(&scaffold.start);
    let mut hinges = hinges(&scaffold, &placed);
    for h in &mut hinges {
        h.settle();
    }
    hinges.retain(|h| h.turn.is_finite());
    let net = Net::new(&scaffold, &hinges);
    net.bound(structure, &scaffold, &placed, time_limit)
}

/// The pairs of bodies that constrain each other, with their rows.
fn hinges(scaffold: &Scaffold, placed: &[Placed]) -> Vec<Hinge> {
    let selection = select(scaffold, placed, &Rat::zero());
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
        if row.d0.sign() < 0 {
            continue;
        }
        let sighted = sight(scaffold, placed, row, (one, k as usize), (two, v as usize));
        by_pair
            .entry((one.min(two), one.max(two)))
            .or_default()
            .push(sighted);
    }
    by_pair
        .into_iter()
        .map(|((a, b), rows)| Hinge {
            a,
            b,
            rows,
            shift: [f64::INFINITY; 2],
            turn: f64::INFINITY,
            dropped: 0,
        })
        .collect()
}

fn sight(
    scaffold: &Scaffold,
    placed: &[Placed],
    row: Row,
    (one, k): (usize, usize),
    (two, v): (usize, usize),
) -> Sighted {
    let (s1, s2) = (&scaffold.shapes[one], &scaffold.shapes[two]);
    let (p1, p2) = (&placed[one], &placed[two]);
    let of_first = one < two;
    let n1 = s1.len();
    let next = (k + 1) % n1;
    let (start, end, at) = (p1.near[k], p1.near[next], p2.near[v]);
    let minus = |p: [f64; 2], q: [f64; 2]| [p[0] - q[0], p[1] - q[1]];
    let dot = |p: [f64; 2], q: [f64; 2]| p[0] * q[0] + p[1] * q[1];
    let along = minus(end, start);
    let edge_length = along[0].hypot(along[1]);
    let unit = [along[0] / edge_length, along[1] / edge_length];
    let normal = p1.unit(&s1.normals[k]);
    // With θ_A = 0 the row is n·Δξ + θ₂φ for the first body's line; for the second's the frame
    // turns against the line: −n·Δξ + θ₁φ with the same integers.
    let phi = if of_first { &row.theta2 } else { &row.theta1 };
    let centre = if of_first { p2.centre } else { p1.centre };
    let arm = minus(at, centre);
    let [x, y] = &row.normal;
    let length = Rat::from(x * x + y * y).interval().sqrt().hi;
    let past = |corner: usize, out: [f64; 2], tip: [f64; 2]| match s1.corners[corner] {
        Corner::Reflex => Past::Solid(inside(p1, corner, out, tip)),
        Corner::Convex => {
            let n2 = s2.len();
            let other = if corner == k {
                p1.near[(k + n1 - 1) % n1]
            } else {
                p1.near[(next + 1) % n1]
            };
            let side = minus(other, tip);
            let mut best = Past::Open;
            for (edge, far) in [(v, (v + 1) % n2), ((v + n2 - 1) % n2, (v + n2 - 1) % n2)] {
                let back = minus(p2.near[far], at);
                let g = back[0].hypot(back[1]);
                let away = p2.unit(&s2.normals[edge]);
                let cosine = -dot(back, out) / g;
                let sine = (back[0] * out[1] - back[1] * out[0]).abs() / g;
                if cosine > 0.9 && dot(away, normal) < -0.9 {
                    let angle = sine.atan2(cosine);
                    best = Past::Along(up(angle), g.min(side[0].hypot(side[1])));
                }
            }
            best
        }
        Corner::Straight => Past::Open,
    };
    Sighted {
        of_first,
        length,
        phi: Rat::from(phi.clone()),
        arm: up(arm[0].hypot(arm[1])),
        inward: dot(arm, normal),
        swing: up((arm[1] * unit[0] - arm[0] * unit[1]).abs()),
        unit,
        foot: dot(minus(at, start), unit),
        edge_length,
        ends: [past(k, [-unit[0], -unit[1]], start), past(next, unit, end)],
        row,
    }
}

/// How far the line of an edge goes on inside the solid past a reflex corner, within reason.
fn inside(p: &Placed, corner: usize, out: [f64; 2], tip: [f64; 2]) -> f64 {
    let n = p.near.len();
    let mut free = f64::INFINITY;
    for k in 0..n {
        let next = (k + 1) % n;
        if k == corner || next == corner {
            continue;
        }
        // Exact would be no better: the length is halved below anyway.
        let far = 100.0;
        let point = |v: [f64; 2]| Vec2::new(Rat::from_f64(v[0]), Rat::from_f64(v[1]));
        let end = point([tip[0] + far * out[0], tip[1] + far * out[1]]);
        let (a, b) = (point(p.near[k]), point(p.near[next]));
        if let Meeting::Cross(at) | Meeting::Touch(at) | Meeting::Overlap(at, _) =
            meet([&point(tip), &end], [&a, &b])
        {
            let d = super::shape::doubles(&(&at - &point(tip)));
            free = free.min(d[0].hypot(d[1]));
        }
    }
    free / 2.0
}

impl Sighted {
    /// The slack of the row's linear part in a region, as a distance; None where the row may not
    /// hold there. With |n| = 1 the distance's second-order part is at most
    /// max(0, −n·r) φ²/2 + |r| |φ|³/6, for a line of the second body besides |Δξ·e| |φ| with e
    /// along the edge.
    fn slack(&self, shift: [f64; 2], turn: f64) -> Option<f64> {
        let size = shift[0].hypot(shift[1]);
        let slide = up(shift[0] * self.unit[0].abs() + shift[1] * self.unit[1].abs());
        // How far the vertex may move along the edge, seen from the edge's body.
        let moved = up(slide + size * turn + self.swing * turn + self.arm * turn * turn / 2.0);
        let over = [moved - self.foot, self.foot + moved - self.edge_length];
        let mut extra = 0.0f64;
        for (past, over) in self.ends.iter().zip(over) {
            if over <= 0.0 {
                continue;
            }
            match past {
                Past::Solid(depth) if over < *depth => {}
                Past::Along(angle, length)
                    if over + moved < *length / 2.0 && angle + turn < 0.5 =>
                {
                    extra = extra.max(up(over * (angle + turn).tan()));
                }
                _ => return None,
            }
        }
        let curved =
            (1e-12 - self.inward).max(0.0) * turn * turn / 2.0 + self.arm * turn.powi(3) / 6.0;
        let mixed = if self.of_first {
            0.0
        } else {
            slide * turn + size * turn * turn / 2.0
        };
        Some(up(curved + mixed + extra))
    }

    /// Coefficients of Δξ and of φ.
    fn entries(&self) -> ([Rat; 2], &Rat) {
        let sign = if self.of_first {
            Rat::one()
        } else {
            -Rat::one()
        };
        let part = |k: usize| Rat::from(self.row.normal[k].clone()) * sign.clone();
        ([part(0), part(1)], &self.phi)
    }

    /// The right-hand side −d₀ − slack.
    fn lower(&self, slack: f64) -> Rat {
        let back = rational(slack) * rational(self.length);
        -(Rat::from(self.row.d0.clone()) + back)
    }
}

/// Rounds of widening before a joint is given up, of narrowing afterwards.
const WIDEN: usize = 12;
const NARROW: usize = 3;

impl Hinge {
    /// Finds a region that no path leaves; leaves it infinite where there is none.
    fn settle(&mut self) {
        let Some(mut guess) = self.extent([0.0; 2], 0.0, true) else {
            return;
        };
        for _ in 0..WIDEN {
            let wider = |v: f64| v * 1.25 + 1e-9;
            guess = (guess.0.map(wider), wider(guess.1));
            let Some(found) = self.extent(guess.0, guess.1, false) else {
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
            if !guess.0[0].is_finite() || !guess.0[1].is_finite() || guess.1 > 0.5 {
                return;
            }
        }
        for _ in 0..NARROW {
            if !self.turn.is_finite() {
                return;
            }
            if let Some(found) = self.extent(self.shift, self.turn, false) {
                for k in 0..2 {
                    self.shift[k] = self.shift[k].min(found.0[k]);
                }
                self.turn = self.turn.min(found.1);
            }
        }
        let valid = |r: &&Sighted| r.slack(self.shift, self.turn).is_none();
        self.dropped = self.rows.iter().filter(valid).count();
    }

    /// The largest |Δξ| and |φ| of the polyhedron that a region's slack gives, rounded outwards.
    fn extent(&self, shift: [f64; 2], turn: f64, linear: bool) -> Option<([f64; 2], f64)> {
        let mut model = Model::new("joint");
        model.maximise = true;
        for name in ["x", "y", "t"] {
            model.add_column(name, Rat::zero(), Range::free());
        }
        for (k, r) in self.rows.iter().enumerate() {
            let slack = if linear {
                Some(0.0)
            } else {
                r.slack(shift, turn)
            };
            let Some(slack) = slack else { continue };
            let row = model.add_row(&format!("r{k}"), Range::at_least(r.lower(slack)));
            let ([x, y], phi) = r.entries();
            model.set(row, 0, x);
            model.set(row, 1, y);
            model.set(row, 2, phi.clone());
        }
        let mut most = [0.0f64; 3];
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
                let value = outcome.objective.as_ref().map_or(f64::INFINITY, double);
                *most = most.max(up(value));
                basis = outcome.basis;
            }
        }
        Some(([most[0], most[1]], most[2]))
    }
}

/// The bodies as nodes, joints as links; the fixed ones are tied together.
struct Net<'a> {
    hinges: &'a [Hinge],
    /// Neighbours of a body by hinge; a link without one joins two fixed bodies.
    links: Vec<Vec<(usize, Option<usize>)>>,
    /// From a fixed body outwards: the body before, and the hinge.
    before: Vec<Option<(usize, Option<usize>)>>,
    /// |θ| of each body at most.
    turns: Vec<f64>,
    order: Vec<usize>,
}

impl<'a> Net<'a> {
    fn new(scaffold: &Scaffold, hinges: &'a [Hinge]) -> Net<'a> {
        let n = scaffold.forms.len();
        let mut links = vec![Vec::new(); n];
        for (k, h) in hinges.iter().enumerate() {
            links[h.a].push((h.b, Some(k)));
            links[h.b].push((h.a, Some(k)));
        }
        let fixed: Vec<usize> = (0..n)
            .filter(|&b| scaffold.forms[b] == Form::Fixed)
            .collect();
        for two in fixed.windows(2) {
            links[two[0]].push((two[1], None));
            links[two[1]].push((two[0], None));
        }
        let mut net = Net {
            hinges,
            links,
            before: vec![None; n],
            turns: vec![f64::INFINITY; n],
            order: Vec::new(),
        };
        let mut queue: VecDeque<usize> = fixed.iter().copied().collect();
        for &b in &fixed {
            net.turns[b] = 0.0;
        }
        while let Some(b) = queue.pop_front() {
            net.order.push(b);
            for &(next, hinge) in &net.links[b] {
                if net.turns[next].is_infinite() {
                    let more = hinge.map_or(0.0, |k| hinges[k].turn);
                    net.turns[next] = up(net.turns[b] + more);
                    net.before[next] = Some((b, hinge));
                    queue.push_back(next);
                }
            }
        }
        net
    }

    /// The shortest closed chain through a hinge, as (body before, hinge) steps from its first
    /// body back to it.
    fn chain(&self, hinge: usize) -> Option<Vec<(usize, usize, Option<usize>)>> {
        const LONGEST: usize = 12;
        let h = &self.hinges[hinge];
        let mut from: HashMap<usize, (usize, Option<usize>)> = HashMap::new();
        let mut queue = VecDeque::from([(h.b, 0usize)]);
        from.insert(h.b, (h.a, Some(hinge)));
        while let Some((b, depth)) = queue.pop_front() {
            for &(next, link) in &self.links[b] {
                if link == Some(hinge) || from.contains_key(&next) || depth >= LONGEST {
                    continue;
                }
                from.insert(next, (b, link));
                if next == h.a {
                    let mut steps = Vec::new();
                    let mut at = h.a;
                    loop {
                        let &(before, link) = from.get(&at)?;
                        steps.push((before, at, link));
                        at = before;
                        if at == h.a {
                            break;
                        }
                    }
                    steps.reverse();
                    return Some(steps);
                }
                queue.push_back((next, depth + 1));
            }
        }
        None
    }

    fn bound(
        &self,
        structure: &Structure,
        scaffold: &Scaffold,
        placed: &[Placed],
        time_limit: Option<std::time::Duration>,
    ) -> Result<OuterBound, String> {
        let n = scaffold.forms.len();
        let mut model = Model::new("outer");
        model.maximise = true;
        let theta: Vec<Option<usize>> = (0..n)
            .map(|b| {
                let limit = rational(self.turns[b].min(10.0));
                let range = Range {
                    lower: Some(-&limit),
                    upper: Some(limit),
                };
                (scaffold.forms[b] != Form::Fixed)
                    .then(|| model.add_column(&format!("t{b}"), Rat::zero(), range))
            })
            .collect();
        let xi: Vec<[usize; 2]> = self
            .hinges
            .iter()
            .enumerate()
            .map(|(k, h)| {
                [0, 1].map(|axis| {
                    let limit = rational(h.shift[axis]);
                    let range = Range {
                        lower: Some(-&limit),
                        upper: Some(limit),
                    };
                    model.add_column(&format!("{}{k}", ["u", "v"][axis]), Rat::zero(), range)
                })
            })
            .collect();
        let mut dropped = 0;
        for (k, h) in self.hinges.iter().enumerate() {
            dropped += h.dropped;
            for (i, r) in h.rows.iter().enumerate() {
                let Some(slack) = r.slack(h.shift, h.turn) else {
                    continue;
                };
                let row = model.add_row(&format!("r{k}_{i}"), Range::at_least(r.lower(slack)));
                let ([x, y], phi) = r.entries();
                model.set(row, xi[k][0], x);
                model.set(row, xi[k][1], y);
                if let Some(t) = theta[h.b] {
                    model.set(row, t, phi.clone());
                }
                if let Some(t) = theta[h.a] {
                    model.set(row, t, -phi);
                }
            }
            // |φ| ≤ turn.
            let limit = rational(h.turn);
            let row = model.add_row(
                &format!("p{k}"),
                Range {
                    lower: Some(-&limit),
                    upper: Some(limit),
                },
            );
            for (body, sign) in [(h.b, 1), (h.a, -1)] {
                if let Some(t) = theta[body] {
                    model.set(row, t, Rat::from(sign));
                }
            }
        }
        let way = |from: usize, to: usize| -> Vec2 {
            let at = |b: usize| {
                let p = &placed[b];
                Vec2::new(
                    Rat::new(p.place[0].clone(), p.q.clone()),
                    Rat::new(p.place[1].clone(), p.q.clone()),
                )
            };
            &at(to) - &at(from)
        };
        let tree: Vec<Option<usize>> = self.before.iter().map(|b| b.and_then(|b| b.1)).collect();
        for k in 0..self.hinges.len() {
            if tree.contains(&Some(k)) {
                continue;
            }
            let Some(steps) = self.chain(k) else { continue };
            let first = steps[0].0;
            // What the linear part may be off by, below and above, in x and y.
            let (mut below, mut above) = ([0.0f64; 2], [0.0f64; 2]);
            // Bounds of the angles against the first body along the chain, from both sides.
            let turn_of = |l: &Option<usize>| l.map_or(0.0, |k| self.hinges[k].turn);
            let total: f64 = steps.iter().map(|s| turn_of(&s.2)).sum();
            let mut walked = 0.0;
            let mut relative: HashMap<usize, f64> = HashMap::from([(first, 0.0)]);
            for (_, to, link) in &steps {
                walked += turn_of(link);
                let least = up(walked.min(total - walked + 1e-15));
                relative.entry(*to).or_insert(least);
            }
            // Coefficients: Σ ±(Δξ + (θ_A − θ_first) ξ₀⊥) within [−above, −below], x and y.
            let mut parts: [Vec<(usize, Rat)>; 2] = [Vec::new(), Vec::new()];
            let mut add = |axis: usize, column: Option<usize>, value: Rat| {
                if let Some(c) = column {
                    parts[axis].push((c, value));
                }
            };
            for (from, to, link) in &steps {
                // ξ₀ of the step, in the frame of the joint's first body.
                let frame = link.map_or(*from, |k| self.hinges[k].a);
                let forward = frame == *from;
                let step = way(*from, *to);
                let angle = relative.get(&frame).copied().unwrap_or(f64::INFINITY);
                if let Some(k) = link {
                    let h = &self.hinges[*k];
                    let sign = if forward { Rat::one() } else { -Rat::one() };
                    add(0, Some(xi[*k][0]), sign.clone());
                    add(1, Some(xi[*k][1]), sign);
                    for axis in 0..2 {
                        let off = h.shift[1 - axis] * angle + h.shift[axis] * angle * angle / 2.0;
                        below[axis] -= off;
                        above[axis] += off;
                    }
                }
                // The step itself, ±ξ₀, turns with the frame.
                // (R(α) − 1)s = αs⊥ − (1 − cos α)s + (sin α − α)s⊥.
                let parts = [double(&step.x), double(&step.y)];
                for axis in 0..2 {
                    let bent = parts[axis].abs() * angle * angle / 2.0;
                    if parts[axis] > 0.0 {
                        below[axis] -= bent;
                    } else {
                        above[axis] += bent;
                    }
                    let third = parts[1 - axis].abs() * angle.powi(3) / 6.0;
                    below[axis] -= third;
                    above[axis] += third;
                }
                for (body, sign) in [(frame, 1), (first, -1)] {
                    let sign = Rat::from(sign);
                    add(0, theta[body], -&(&step.y * &sign));
                    add(1, theta[body], &step.x * &sign);
                }
            }
            for (axis, entries) in parts.into_iter().enumerate() {
                // Linear + rest = 0 with the rest in [below, above].
                let row = model.add_row(
                    &format!("c{k}_{axis}"),
                    Range {
                        lower: Some(-&rational(up(above[axis]))),
                        upper: Some(rational(up(-below[axis]))),
                    },
                );
                let mut sums: BTreeMap<usize, Rat> = BTreeMap::new();
                for (c, v) in entries {
                    let slot = sums.entry(c).or_insert_with(Rat::zero);
                    *slot = &*slot + &v;
                }
                for (c, v) in sums {
                    model.set(row, c, v);
                }
            }
        }
        let mut loss = 0.0;
        let mut costs: BTreeMap<usize, Rat> = BTreeMap::new();
        for (body, point, weight, dtheta) in scaffold.weighted(&scaffold.start) {
            if self.turns[body].is_infinite() {
                let name = &structure.bodies[body].name;
                return Err(format!(
                    "no chain of holding joints ties body `{name}` to a fixed one"
                ));
            }
            let mut put = |column: Option<usize>, value: Rat| {
                if let Some(c) = column {
                    let slot = costs.entry(c).or_insert_with(Rat::zero);
                    *slot = &*slot + &value;
                }
            };
            let wide = [double(&weight.x).abs(), double(&weight.y).abs()];
            // w·(R(θ)s − s) ≤ θ w·s⊥ + what follows.
            let turned = |s: &Vec2, angle: f64| {
                let straight = double(&weight.dot(s));
                let across = double(&weight.cross(s)).abs();
                up((-straight).max(0.0) * angle * angle / 2.0 + across * angle.powi(3) / 6.0)
            };
            put(theta[body], dtheta.clone());
            // An angle counts as twice the tangent of its half.
            let widest = self.turns[body].min(3.0);
            loss += up(double(&dtheta).abs() * (2.0 * (widest / 2.0).tan() - widest)) + 1e-15;
            put(
                theta[body],
                weight.y.clone() * point.x.clone() - &weight.x * &point.y,
            );
            loss += turned(&point, self.turns[body]);
            let mut at = body;
            while let Some((before, link)) = self.before[at] {
                if let Some(k) = link {
                    let h = &self.hinges[k];
                    let forward = h.a == before;
                    let step = way(before, at);
                    let sign = if forward { Rat::one() } else { -Rat::one() };
                    put(Some(xi[k][0]), &weight.x * &sign);
                    put(Some(xi[k][1]), &weight.y * &sign);
                    put(theta[h.a], &weight.y * &step.x - &weight.x * &step.y);
                    let angle = self.turns[h.a];
                    let across = wide[0] * h.shift[1] + wide[1] * h.shift[0];
                    let straight = wide[0] * h.shift[0] + wide[1] * h.shift[1];
                    loss +=
                        turned(&step, angle) + up(across * angle + straight * angle * angle / 2.0);
                }
                at = before;
            }
        }
        for (c, v) in costs {
            model.columns[c].cost = v;
        }
        let outcome = lp::solve(
            &model,
            &lp::Options {
                time_limit,
                ..lp::Options::default()
            },
        );
        let (Status::Optimal, Some(relaxed)) = (outcome.status, outcome.objective.clone()) else {
            return Err(format!("the relaxed program is {}", outcome.status.word()));
        };
        let verified = Claim::of(&outcome).is_some_and(|c| verify(&model, &c).is_ok());
        let loss = rational(up(loss));
        Ok(OuterBound {
            value: &relaxed + &loss,
            relaxed,
            loss,
            size: (model.rows.len(), model.columns.len()),
            dropped,
            verified,
        })
    }
}
