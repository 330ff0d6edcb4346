//! The constraints of a structure where it stands, and what each alone allows.
//!
//! A row J q̇ + d₀ ≥ 0 that has a single non-zero coefficient j is a bound of its own: q̇ ≥ −d₀/j
//! for j > 0, q̇ ≤ −d₀/j for j < 0. Those are the candidate boundary values of PF §IV, where the
//! structure is an arm turning about a pin. Rows are those of the first linear program, up to a
//! positive factor, so everything here is an exact rational.

use crate::flex::fit::Fitted;
use crate::flex::model::{Form, Row};
use crate::flex::step::{FlexOptions, Run};
use crate::flex::{Pair, Plane, Point, Structure};
use crate::number::{Int, Rat};
use crate::report::Num;
use serde::Serialize;

/// A bound that one constraint alone sets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bound {
    /// The body that it bounds.
    pub body: usize,
    /// `x`, `y` or `theta`.
    pub coordinate: &'static str,
    /// Whether it bounds from above.
    pub above: bool,
    /// The bound on the coordinate's change.
    pub value: Rat,
}

/// A constraint where a structure stands.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Which point, which line.
    pub pair: Pair,
    /// The squared length of the normal by which the row is multiplied.
    pub normal_square: Rat,
    /// d₀, in the same scale.
    pub d0: Rat,
    /// Non-zero coefficients: body, coordinate, value; in the same scale.
    pub gradient: Vec<(usize, &'static str, Rat)>,
    /// What it bounds by itself.
    pub bound: Option<Bound>,
}

impl Constraint {
    /// The signed distance squared, with the distance's sign.
    pub fn signed_square(&self) -> Rat {
        let square = &self.d0.square() / &self.normal_square;
        if self.d0.sign() < 0 { -square } else { square }
    }
}

/// The constraints of a structure's first program, in its order. Costs one model.
pub fn constraints(structure: &Structure) -> Vec<Constraint> {
    let options = FlexOptions::default();
    let fit = Fitted::of(structure);
    let run = Run::new(fit.as_ref().map_or(structure, |f| &f.structure), &options);
    let unit = fit.as_ref().map_or_else(Rat::one, Fitted::length);
    let placed = run.scaffold.place(&run.scaffold.start);
    let selection = run.selection(&placed, false);
    let (_, rows) = run.rows(&selection, &placed);
    rows.iter().map(|r| constraint(r, &run, &unit)).collect()
}

/// A row whose lengths are in multiples of `unit`.
fn constraint(row: &Row, run: &Run<'_>, unit: &Rat) -> Constraint {
    let rat = |v: Int| Rat::from(v);
    let [nx, ny] = &row.normal;
    let (one, two) = (row.pair.line_body as usize, row.pair.point_body as usize);
    let parts = [
        (one, "x", -nx),
        (one, "y", -ny),
        (one, "theta", row.theta1.clone()),
        (two, "x", nx.clone()),
        (two, "y", ny.clone()),
        (two, "theta", row.theta2.clone()),
    ];
    let free = |body: usize, coordinate: &str| match run.scaffold.forms[body] {
        Form::Free => true,
        Form::Pinned => coordinate == "theta",
        Form::Fixed => false,
    };
    let gradient: Vec<(usize, &'static str, Rat)> = parts
        .into_iter()
        .filter(|(b, c, v)| free(*b, c) && !v.is_zero())
        .map(|(b, c, v)| {
            (
                b,
                c,
                if c == "theta" {
                    rat(v) * unit.clone()
                } else {
                    rat(v)
                },
            )
        })
        .collect();
    let d0 = rat(row.d0.clone()) * unit.clone();
    let bound = match gradient.as_slice() {
        [(body, coordinate, j)] => Some(Bound {
            body: *body,
            coordinate,
            above: j.sign() < 0,
            value: -(&d0 / j),
        }),
        _ => None,
    };
    Constraint {
        pair: row.pair,
        normal_square: rat(nx * nx + ny * ny),
        d0,
        gradient,
        bound,
    }
}

/// A rational as a decimal that is cut off, not rounded, after so many digits past the point.
pub fn decimal(r: &Rat, digits: u32) -> String {
    let scaled = r.abs() * Rat::from(Int::from(10).pow(digits));
    let whole = scaled.floor().to_string();
    let width = digits as usize + 1;
    let whole = format!("{whole:0>width$}");
    let (a, b) = whole.split_at(whole.len() - digits as usize);
    let sign = if r.sign() < 0 { "-" } else { "" };
    if b.is_empty() {
        format!("{sign}{a}")
    } else {
        format!("{sign}{a}.{b}")
    }
}

/// The result of `snapfit flex --constraints`.
#[derive(Clone, Debug, Serialize)]
pub struct ConstraintsDocument {
    /// Which format this is.
    pub schema: &'static str,
    /// Name of the structure.
    pub structure: String,
    /// The constraints.
    pub constraints: Vec<ConstraintDocument>,
}

/// One constraint.
#[derive(Clone, Debug, Serialize)]
pub struct ConstraintDocument {
    /// The body of the line.
    pub line_body: String,
    /// `edge 3`, `corner 2`, `cone left`, `cone right` or `range`.
    pub line: String,
    /// The body of the point.
    pub point_body: String,
    /// `vertex 1` or `marker`.
    pub point: String,
    /// The squared distance, negative where the point is on the wrong side.
    pub signed_square: Num,
    /// The row's gradient, exact: coefficients of its non-zero columns.
    pub gradient: Vec<(String, &'static str, String)>,
    /// What it bounds by itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<BoundDocument>,
}

/// A bound.
#[derive(Clone, Debug, Serialize)]
pub struct BoundDocument {
    /// The body.
    pub body: String,
    /// `x`, `y` or `theta`.
    pub coordinate: &'static str,
    /// `at-most` or `at-least`.
    pub side: &'static str,
    /// Its value, exact.
    pub value: Num,
    /// The same to thirty digits, cut off.
    pub decimal: String,
}

impl ConstraintsDocument {
    /// The document of a structure.
    pub fn new(structure: &Structure) -> ConstraintsDocument {
        let name = |k: usize| structure.bodies[k].name.clone();
        let each = constraints(structure);
        ConstraintsDocument {
            schema: "snapfit.flex-constraints/1",
            structure: structure.name.clone(),
            constraints: each
                .iter()
                .map(|c| ConstraintDocument {
                    line_body: name(c.pair.line_body as usize),
                    line: match c.pair.plane {
                        Plane::Edge(k) => format!("edge {k}"),
                        Plane::Corner(k) => format!("corner {k}"),
                        Plane::ConeLeft(_) => "cone left".to_owned(),
                        Plane::ConeRight(_) => "cone right".to_owned(),
                        Plane::Range(_) => "range".to_owned(),
                    },
                    point_body: name(c.pair.point_body as usize),
                    point: match c.pair.point {
                        Point::Vertex(k) => format!("vertex {k}"),
                        Point::Marker(_) => "marker".to_owned(),
                    },
                    signed_square: Num::of_rat(&c.signed_square()),
                    gradient: c
                        .gradient
                        .iter()
                        .map(|(b, k, v)| (name(*b), *k, v.to_string()))
                        .collect(),
                    bound: c.bound.as_ref().map(|b| BoundDocument {
                        body: name(b.body),
                        coordinate: b.coordinate,
                        side: if b.above { "at-most" } else { "at-least" },
                        value: Num::of_rat(&b.value),
                        decimal: decimal(&b.value, 30),
                    }),
                })
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_cut_not_rounded() {
        assert_eq!(decimal(&Rat::frac(2, 3), 4), "0.6666");
        assert_eq!(decimal(&Rat::frac(-199, 100), 1), "-1.9");
        assert_eq!(decimal(&Rat::from(7), 0), "7");
    }
}
