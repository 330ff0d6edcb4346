//! The objective of a structure and its linear program.
//!
//! The columns are the freedoms of the bodies, the rows those of [`super`]; the objective is the
//! weighted sum of displacements, whose first-order change the program maximises.

use super::{Form, Row, Scaffold, direction, turned_by};
use crate::flex::shape::Pose;
use crate::flex::types::{Structure, Term};
use crate::geometry::Vec2;
use crate::lp::{Model, Range};
use crate::number::{Int, Rat};
use std::collections::HashMap;

/// A term of the objective with its point, relative to the reference point, in the frame.
#[derive(Clone, Debug)]
pub(super) struct Weighted {
    body: usize,
    point: Vec2,
    dx: Rat,
    dy: Rat,
    dtheta: Rat,
}

/// Bits of a row's longest coefficient past which it is divided by a power of two.
const LONG: u64 = 500;
/// A rotation of 2 to this in a step is no limit: 2 tan(θ/2) so large is a turn by π.
const TURNS: u64 = 64;

impl Row {
    /// Whether doubles may not hold its coefficients.
    pub(crate) fn is_long(&self) -> bool {
        let each = self
            .normal
            .iter()
            .chain([&self.theta1, &self.theta2, &self.d0]);
        each.map(Int::bits).any(|bits| bits > LONG)
    }
}

impl Scaffold {
    /// The weighted sum of displacements since the start, exactly. An angle counts as twice the
    /// tangent of half its change, which is the angle up to its third power.
    pub(crate) fn displacement(&self, poses: &[Pose]) -> Rat {
        let mut sum = Rat::zero();
        for (body, x) in &self.gathered {
            let off = |poses: &[Pose]| (&poses[*body].place.x - x).abs();
            sum = sum + off(&self.start) - off(poses);
        }
        for t in &self.terms {
            let (from, to) = (&self.start[t.body], &poses[t.body]);
            if from == to {
                continue;
            }
            let mut moved = &to.place - &from.place;
            if !t.point.is_zero() {
                let turned = &t.point.rotate_tan_half(&to.tan_half)
                    - &t.point.rotate_tan_half(&from.tan_half);
                moved = &moved + &turned;
            }
            sum = sum + &t.dx * &moved.x + &t.dy * &moved.y;
            if !t.dtheta.is_zero() {
                sum += &t.dtheta * &(turned_by(from, to) * Rat::from(2));
            }
        }
        sum
    }

    /// The objective's coefficients (x, y, θ) of every body at a configuration, gradients taken at
    /// its stations.
    fn costs(&self, poses: &[Pose], stations: &[Pose]) -> Vec<[Rat; 3]> {
        let mut costs = vec![[Rat::zero(), Rat::zero(), Rat::zero()]; self.forms.len()];
        for t in &self.terms {
            let slot = &mut costs[t.body];
            slot[0] = &slot[0] + &t.dx;
            slot[1] = &slot[1] + &t.dy;
            let mut theta = t.dtheta.clone();
            if !t.point.is_zero() {
                let r = t.point.rotate_tan_half(&stations[t.body].tan_half);
                theta = theta + &t.dy * &r.x - &t.dx * &r.y;
            }
            slot[2] = &slot[2] + &theta;
        }
        for (body, x) in &self.gathered {
            let way = (x - &poses[*body].place.x).sign();
            costs[*body][0] = &costs[*body][0] + &Rat::from(i64::from(way));
        }
        costs
    }

    /// The terms of the objective at a configuration: body, its point as turned there, weight of
    /// the point's displacement, weight of the angle. Movement towards a line counts by its tangent.
    pub(crate) fn weighted(&self, poses: &[Pose]) -> Vec<(usize, Vec2, Vec2, Rat)> {
        let each = self.terms.iter().map(|t| {
            let turned = t.point.rotate_tan_half(&poses[t.body].tan_half);
            let weight = Vec2::new(t.dx.clone(), t.dy.clone());
            (t.body, turned, weight, t.dtheta.clone())
        });
        // |x₀ − X| − |x − X| is concave in x: at most its tangent, so a bound of the sum with the
        // tangents in it bounds what is asked.
        let towards = self.gathered.iter().map(|(body, x)| {
            let way = (x - &poses[*body].place.x).sign();
            let weight = Vec2::new(Rat::from(i64::from(way)), Rat::zero());
            (*body, Vec2::default(), weight, Rat::zero())
        });
        each.chain(towards).collect()
    }

    /// Whether anything is asked.
    pub(crate) fn has_objective(&self) -> bool {
        !self.terms.is_empty() || !self.gathered.is_empty()
    }

    /// The columns x, y, θ of a body, as far as it has them.
    pub(crate) fn column(&self, body: usize) -> [Option<usize>; 3] {
        let c = self.columns[body];
        match self.forms[body] {
            Form::Free => [Some(c), Some(c + 1), Some(c + 2)],
            Form::Pinned => [None, None, Some(c)],
            Form::Fixed => [None; 3],
        }
    }

    /// The entries of a row by column.
    pub(crate) fn entries(&self, row: &Row) -> Vec<(usize, Int)> {
        let one = self.column(row.pair.line_body as usize);
        let two = self.column(row.pair.point_body as usize);
        let mut out = Vec::with_capacity(6);
        let mut put = |column: Option<usize>, value: Int| {
            if let Some(c) = column
                && !value.is_zero()
            {
                out.push((c, value));
            }
        };
        put(one[0], -&row.normal[0]);
        put(one[1], -&row.normal[1]);
        put(one[2], row.theta1.clone());
        put(two[0], row.normal[0].clone());
        put(two[1], row.normal[1].clone());
        put(two[2], row.theta2.clone());
        out
    }

    /// The linear program of a configuration: rows r0, r1, …, columns x, y, t with the body's
    /// index.
    pub(crate) fn program(&self, rows: &[Row], poses: &[Pose], stations: &[Pose]) -> Model {
        let mut model = Model::new("flex");
        model.maximise = true;
        let costs = self.costs(poses, stations);
        let no_limit = Rat::from(Int::one().shl(TURNS));
        let lines: HashMap<usize, &Rat> = self.gathered.iter().map(|(b, x)| (*b, x)).collect();
        for (body, cost) in costs.into_iter().enumerate() {
            let names = ["x", "y", "t"];
            for (k, (column, cost)) in self.column(body).iter().zip(cost).enumerate() {
                if column.is_some() {
                    let left = lines.get(&body).map(|x| *x - &poses[body].place.x);
                    let own = self.turn_limits.as_ref().map(|all| &all[body]);
                    let asked = self.rotation_limit.as_ref();
                    let limit = asked
                        .filter(|v| **v < no_limit)
                        .into_iter()
                        .chain(own)
                        .min();
                    let range = match (limit, k) {
                        // Not past the line.
                        (_, 0) => match left {
                            Some(left) if left.sign() > 0 => Range::at_most(left),
                            Some(left) if left.sign() < 0 => Range::at_least(left),
                            _ => Range::free(),
                        },
                        (Some(limit), 2) => Range {
                            lower: Some(-limit),
                            upper: Some(limit.clone()),
                        },
                        _ => Range::free(),
                    };
                    model.add_column(&format!("{}{body}", names[k]), cost, range);
                }
            }
        }
        for (k, row) in rows.iter().enumerate() {
            let entries = self.entries(row);
            let own = entries.iter().map(|(_, v)| v.bits()).max().unwrap_or(0);
            // A row is free up to a positive factor; this one keeps it within what doubles hold,
            // which propose the basis.
            let unit = (own > LONG).then(|| Int::one().shl(own));
            let part = |v: Int| match &unit {
                Some(unit) => Rat::new(v, unit.clone()),
                None => Rat::from(v),
            };
            let r = model.add_row(&format!("r{k}"), Range::at_least(part(-&row.d0)));
            for (c, v) in entries {
                model.set(r, c, part(v));
            }
        }
        model
    }
}

/// The terms of the objective with their points.
pub(super) fn weights(structure: &Structure, scaffold: &Scaffold) -> Vec<Weighted> {
    let mut out = Vec::new();
    let body_point =
        |body: usize, at: &Vec2| at - &crate::flex::shape::reference(&structure.bodies[body]);
    for term in &structure.objective {
        match term {
            Term::Body {
                body,
                dx,
                dy,
                dtheta,
            } => out.push(Weighted {
                body: *body,
                point: body_point(*body, &Vec2::default()),
                dx: dx.clone(),
                dy: dy.clone(),
                dtheta: dtheta.clone(),
            }),
            Term::Vertex {
                body,
                vertex,
                dx,
                dy,
            } => out.push(Weighted {
                body: *body,
                point: body_point(*body, &structure.bodies[*body].vertices[*vertex]),
                dx: dx.clone(),
                dy: dy.clone(),
                dtheta: Rat::zero(),
            }),
            // Kept apart: its sign changes with the configuration.
            Term::Towards { .. } => {}
            Term::Radial { body, from } => {
                let all = 0..structure.bodies.len();
                for k in all.filter(|k| body.is_none_or(|b| b == *k)) {
                    if scaffold.forms[k] == Form::Fixed {
                        continue;
                    }
                    let away = direction(&(&structure.bodies[k].position - from));
                    out.push(Weighted {
                        body: k,
                        point: body_point(k, &Vec2::default()),
                        dx: away.x,
                        dy: away.y,
                        dtheta: Rat::zero(),
                    });
                }
            }
        }
    }
    out
}
