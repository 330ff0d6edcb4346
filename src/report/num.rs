//! Exact numbers as the contract writes them, each computed once.

use super::theta::theta;
use crate::contact::Chart;
use crate::motion::{Angle, Phase};
use crate::number::{Algebraic, Rat};
use crate::slice::Time;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// A number: the nearest double, and the number itself.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Num {
    /// The nearest double, ties to even; null past the double range.
    pub value: Option<f64>,
    /// The number itself; left out where doubles decided.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<Exact>,
}

/// An exact real number.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Exact {
    /// A rational number.
    Rational {
        /// `p` or `p/q` in lowest terms.
        #[schemars(regex(pattern = r"^-?[0-9]+(/[1-9][0-9]*)?$"))]
        rational: String,
    },
    /// An irrational root of a polynomial.
    Root {
        /// Integer coefficients, constant first: primitive, leading one positive, square-free.
        polynomial: Vec<String>,
        /// `[k/2^j, (k+1)/2^j]` with the least j ≥ 0 for which exactly one root lies in it.
        interval: [String; 2],
    },
}

impl Num {
    /// A rational number.
    pub fn of_rat(r: &Rat) -> Num {
        Num {
            value: r.nearest_f64(),
            exact: Some(Exact::Rational {
                rational: r.to_string(),
            }),
        }
    }
    /// An algebraic number. Costs its minimal polynomial.
    pub fn of(x: &Algebraic) -> Num {
        if let Some(r) = x.to_rat() {
            return Num::of_rat(&r);
        }
        let (lo, hi) = x.isolating_interval();
        let polynomial = x.minimal_polynomial();
        Num {
            value: x.nearest_f64(),
            exact: Some(Exact::Root {
                polynomial: polynomial
                    .coeffs()
                    .iter()
                    .map(ToString::to_string)
                    .collect(),
                interval: [lo.to_string(), hi.to_string()],
            }),
        }
    }
    /// The double, for pictures and tables: infinite past the double range, with the number's sign.
    pub fn approx(&self) -> f64 {
        let below = match &self.exact {
            Some(Exact::Rational { rational }) => rational.starts_with('-'),
            Some(Exact::Root { interval, .. }) => interval[0].starts_with('-'),
            None => false,
        };
        let past = if below {
            f64::NEG_INFINITY
        } else {
            f64::INFINITY
        };
        self.value.unwrap_or(past)
    }
}

/// An orientation in words: tan(θ/2), None where it is infinite; θ; and whole turns.
#[derive(Clone, Debug)]
pub(super) struct Orientation {
    pub(super) tan_half: Option<Num>,
    pub(super) theta: f64,
    pub(super) winding: i64,
}

/// What has been computed so far. Instants and orientations recur (a segment ends where the next
/// one and an event begin), and a minimal polynomial is the dearest part of a report.
pub(super) struct Numbers<'a> {
    phases: &'a [Phase],
    times: BTreeMap<(usize, Time), Num>,
    tangents: BTreeMap<(Chart, Algebraic), Option<Num>>,
    thetas: BTreeMap<(i64, Algebraic), f64>,
}

impl<'a> Numbers<'a> {
    pub(super) fn new(phases: &'a [Phase]) -> Numbers<'a> {
        Numbers {
            phases,
            times: BTreeMap::new(),
            tangents: BTreeMap::new(),
            thetas: BTreeMap::new(),
        }
    }

    /// A phase's local time on the clock of the whole plan.
    pub(super) fn time(&mut self, phase: usize, local: &Time) -> Num {
        let from = &self.phases[phase].from;
        let make = || match local.as_rat() {
            Some(t) => Num::of_rat(&(from + t)),
            // The instant's own number is kept where it has been made.
            None if from.is_zero() => Num::of(local.exact()),
            None => Num::of(&local.affine(from, &Rat::one())),
        };
        self.times
            .entry((phase, local.clone()))
            .or_insert_with(make)
            .clone()
    }

    pub(super) fn orientation(&mut self, angle: &Angle) -> Orientation {
        let tan_half = self
            .tangents
            .entry((angle.chart(), angle.x.clone()))
            .or_insert_with(|| angle.tan_half().map(|u| Num::of(&u)));
        let theta = self
            .thetas
            .entry((angle.half_turn, angle.x.clone()))
            .or_insert_with(|| theta(angle.half_turn, &angle.x));
        Orientation {
            tan_half: tan_half.clone(),
            theta: *theta,
            winding: angle.winding(),
        }
    }
}
