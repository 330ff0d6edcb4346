//! All joints at once: the program whose optimum, with what its linear parts may lose, is the bound.

use super::OuterBound;
use super::above::Above;
use super::joint::{Hinge, place};
use crate::certificate::lp::{Claim, verify};
use crate::flex::model::{Form, Scaffold};
use crate::flex::types::Structure;
use crate::geometry::Vec2;
use crate::lp::{self, Model, Range, Status};
use crate::number::{Interval, Rat};
use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};

/// The bodies as nodes, joints as links; the fixed ones are tied together.
pub(super) struct Net<'a> {
    hinges: &'a [Hinge],
    /// Neighbours of a body by hinge; a link without one joins two fixed bodies.
    links: Vec<Vec<(usize, Option<usize>)>>,
    /// From a fixed body outwards: the body before, and the hinge.
    before: Vec<Option<(usize, Option<usize>)>>,
    /// |θ| of each body at most.
    turns: Vec<Above>,
}

impl<'a> Net<'a> {
    pub(super) fn new(scaffold: &Scaffold, hinges: &'a [Hinge]) -> Net<'a> {
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
            turns: vec![Above::INFINITY; n],
        };
        let mut queue: VecDeque<usize> = fixed.iter().copied().collect();
        for &b in &fixed {
            net.turns[b] = Above::ZERO;
        }
        while let Some(b) = queue.pop_front() {
            for &(next, hinge) in &net.links[b] {
                if !net.turns[next].is_finite() {
                    let more = hinge.map_or(Above::ZERO, |k| hinges[k].turn);
                    net.turns[next] = net.turns[b] + more;
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

    /// The bound; the module `bound` says how.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn bound(
        &self,
        structure: &Structure,
        scaffold: &Scaffold,
        time_limit: Option<std::time::Duration>,
    ) -> Result<OuterBound, String> {
        let places: Vec<Vec2> = scaffold.place(&scaffold.start).iter().map(place).collect();
        let mut relaxation = Relaxation::new(self, scaffold, places);
        for k in 0..self.hinges.len() {
            relaxation.joint(k);
        }
        let tree: HashSet<usize> = self
            .before
            .iter()
            .filter_map(|b| b.and_then(|b| b.1))
            .collect();
        for k in (0..self.hinges.len()).filter(|k| !tree.contains(k)) {
            if let Some(steps) = self.chain(k) {
                relaxation.close(k, &steps);
            }
        }
        let mut loss = Above::ZERO;
        for (body, point, weight, dtheta) in scaffold.weighted(&scaffold.start) {
            let lost = relaxation.term(body, &point, &weight, &dtheta);
            loss = loss
                + lost.ok_or_else(|| {
                    let name = &structure.bodies[body].name;
                    format!("no chain of joints that hold ties body `{name}` to a fixed one")
                })?;
        }
        let loss = loss.rational().ok_or("bodies turn too far for a bound")?;
        let model = relaxation.model;
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
        Ok(OuterBound {
            value: &relaxed + &loss,
            relaxed,
            loss,
            size: (model.rows.len(), model.columns.len()),
            dropped: self.hinges.iter().map(|h| h.dropped).sum(),
            verified,
        })
    }
}

/// A step of a chain: from one body to another, by a joint or between two fixed ones.
type Link = (usize, usize, Option<usize>);

/// The relaxed program in the making.
struct Relaxation<'a> {
    net: &'a Net<'a>,
    places: Vec<Vec2>,
    model: Model,
    /// Columns of the angles of the bodies, and of Δξ of the joints.
    theta: Vec<Option<usize>>,
    xi: Vec<[usize; 2]>,
}

/// |v| ≤ limit.
fn within(limit: Above) -> Range {
    match limit.rational() {
        Some(limit) => Range {
            lower: Some(-&limit),
            upper: Some(limit),
        },
        None => Range::free(),
    }
}

impl<'a> Relaxation<'a> {
    fn new(net: &'a Net<'a>, scaffold: &Scaffold, places: Vec<Vec2>) -> Relaxation<'a> {
        let mut model = Model::new("outer");
        model.maximise = true;
        let mut angle = |b: usize| {
            let column = || model.add_column(&format!("t{b}"), Rat::zero(), within(net.turns[b]));
            (scaffold.forms[b] != Form::Fixed).then(column)
        };
        let theta = (0..scaffold.forms.len()).map(&mut angle).collect();
        let mut xi = Vec::with_capacity(net.hinges.len());
        for (k, h) in net.hinges.iter().enumerate() {
            let mut column = |name: &str, limit: Above| {
                model.add_column(&format!("{name}{k}"), Rat::zero(), within(limit))
            };
            xi.push([column("u", h.shift[0]), column("v", h.shift[1])]);
        }
        Relaxation {
            net,
            places,
            model,
            theta,
            xi,
        }
    }

    /// The way between two bodies at the start.
    fn way(&self, from: usize, to: usize) -> Vec2 {
        &self.places[to] - &self.places[from]
    }

    /// Adds a row of columns that may occur more than once.
    fn add(&mut self, name: &str, range: Range, entries: Vec<(Option<usize>, Rat)>) {
        let row = self.model.add_row(name, range);
        let mut sums: BTreeMap<usize, Rat> = BTreeMap::new();
        for (column, value) in entries {
            if let Some(c) = column {
                *sums.entry(c).or_insert_with(Rat::zero) += &value;
            }
        }
        for (c, v) in sums {
            self.model.set(row, c, v);
        }
    }

    /// The rows of a joint, and that its region holds its angle.
    fn joint(&mut self, k: usize) {
        let h = &self.net.hinges[k];
        let (a, b) = (self.theta[h.a], self.theta[h.b]);
        for (i, r) in h.rows.iter().enumerate() {
            let slack = r.slack(h.shift, h.turn);
            let Some(lower) = slack.and_then(|s| r.lower(s)) else {
                continue;
            };
            let ([x, y], phi) = r.entries();
            let [u, v] = self.xi[k];
            let entries = vec![(Some(u), x), (Some(v), y), (b, phi.clone()), (a, -phi)];
            self.add(&format!("r{k}_{i}"), Range::at_least(lower), entries);
        }
        let angle = vec![(b, Rat::one()), (a, -Rat::one())];
        self.add(&format!("p{k}"), within(h.turn), angle);
    }

    /// Two rows for a closed chain, by the hinge that closes it: in the frame of its first body
    /// Σ ±R(α)(ξ₀ + Δξ) = 0 with α the angle of a step's frame against the first body. The linear
    /// part is off by (R(α) − 1)Δξ and by −(1 − cos α)s + (sin α − α)s⊥, s = ±ξ₀ the step.
    fn close(&mut self, closing: usize, steps: &[Link]) {
        let first = steps[0].0;
        let turn_of = |l: &Option<usize>| l.map_or(Above::ZERO, |k| self.net.hinges[k].turn);
        // A body's angle against the first one, from either side of the chain.
        let mut angles: HashMap<usize, Above> = HashMap::from([(first, Above::ZERO)]);
        let mut walked = Above::ZERO;
        for (_, to, link) in steps {
            walked = walked + turn_of(link);
            angles.entry(*to).or_insert(walked);
        }
        walked = Above::ZERO;
        for (from, _, link) in steps.iter().rev() {
            walked = walked + turn_of(link);
            if let Some(angle) = angles.get_mut(from) {
                *angle = angle.min(walked);
            }
        }
        // The rest, by how much it may lie below and above zero in x and y.
        let (mut below, mut above) = ([Above::ZERO; 2], [Above::ZERO; 2]);
        let mut parts: [Vec<(Option<usize>, Rat)>; 2] = [Vec::new(), Vec::new()];
        for (from, to, link) in steps {
            // ξ₀ of the step, in the frame of the joint's first body.
            let frame = link.map_or(*from, |k| self.net.hinges[k].a);
            let step = self.way(*from, *to);
            let angle = angles.get(&frame).copied().unwrap_or(Above::INFINITY);
            let sizes = [Above::of_rat(&step.x), Above::of_rat(&step.y)];
            let signs = [step.x.sign(), step.y.sign()];
            for axis in 0..2 {
                let third = sizes[1 - axis] * angle.cubic();
                below[axis] = below[axis] + third;
                above[axis] = above[axis] + third;
                let bent = sizes[axis] * angle.versine();
                if signs[axis] > 0 {
                    below[axis] = below[axis] + bent;
                } else {
                    above[axis] = above[axis] + bent;
                }
            }
            if let Some(k) = link {
                let h = &self.net.hinges[*k];
                let sign = Rat::from(if frame == *from { 1 } else { -1 });
                for axis in 0..2 {
                    parts[axis].push((Some(self.xi[*k][axis]), sign.clone()));
                    let off = h.shift[1 - axis] * angle + h.shift[axis] * angle.versine();
                    below[axis] = below[axis] + off;
                    above[axis] = above[axis] + off;
                }
            }
            for (body, sign) in [(frame, 1), (first, -1)] {
                let sign = Rat::from(sign);
                parts[0].push((self.theta[body], -&(&step.y * &sign)));
                parts[1].push((self.theta[body], &step.x * &sign));
            }
        }
        for (axis, entries) in parts.into_iter().enumerate() {
            // Linear part = −rest.
            let range = Range {
                lower: above[axis].rational().map(|v| -v),
                upper: below[axis].rational(),
            };
            self.add(&format!("c{closing}_{axis}"), range, entries);
        }
    }

    /// Adds a term of the objective: the linear parts to the costs; what they may fall short by is
    /// returned. None where no chain of joints leads to the body.
    fn term(&mut self, body: usize, point: &Vec2, weight: &Vec2, dtheta: &Rat) -> Option<Above> {
        let turn = self.net.turns[body];
        if !turn.is_finite() {
            return None;
        }
        let wide = [Above::of_rat(&weight.x), Above::of_rat(&weight.y)];
        // w·(R(θ)s − s) = θ w·s⊥ − (1 − cos θ) w·s + (sin θ − θ) w·s⊥.
        let turned = |s: &Vec2, angle: Above| {
            let against = Above::positive(&(-weight.dot(s)).interval());
            against * angle.versine() + Above::of_rat(&weight.cross(s)) * angle.cubic()
        };
        // w·s⊥ = s × w.
        let lever = |s: &Vec2| s.cross(weight);
        let mut loss = turned(point, turn);
        let mut costs = vec![(self.theta[body], dtheta + &lever(point))];
        if !dtheta.is_zero() {
            // An angle counts as twice the tangent of its half; the excess grows with |θ|, so it
            // is largest at the bound: 2 tan(θ/2) − θ ≤ θ·v/(1 − v) with v = θ²/8.
            let half = Above::HALF * turn;
            let v = half.versine();
            let bottom = Interval::point(1.0) - v.interval();
            let excess = if bottom.lo > 0.0 {
                Above::of((v.interval() / bottom).hi)
            } else {
                Above::INFINITY
            };
            loss = loss + Above::of_rat(dtheta) * turn * excess;
        }
        let mut at = body;
        while let Some((before, link)) = self.net.before[at] {
            if let Some(k) = link {
                let h = &self.net.hinges[k];
                let step = self.way(before, at);
                let sign = Rat::from(if h.a == before { 1 } else { -1 });
                let [u, v] = self.xi[k];
                costs.push((Some(u), &weight.x * &sign));
                costs.push((Some(v), &weight.y * &sign));
                costs.push((self.theta[h.a], lever(&step)));
                let angle = self.net.turns[h.a];
                let across = wide[0] * h.shift[1] + wide[1] * h.shift[0];
                let straight = wide[0] * h.shift[0] + wide[1] * h.shift[1];
                loss = loss + turned(&step, angle) + across * angle + straight * angle.versine();
            }
            at = before;
        }
        for (column, value) in costs {
            if let Some(c) = column {
                let cost = &mut self.model.columns[c].cost;
                *cost = &*cost + &value;
            }
        }
        Some(loss)
    }
}
