//! What solving gives: a status, the exact objective, and a certificate that proves both.

use super::basis::{Basis, Frame, RowVector, Status as Resting};
use super::model::Model;
use super::problem::Problem;
use super::simplex::Verdict;
use crate::number::{Int, Rat};

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// There is an optimum; objective and certificate say so.
    Optimal,
    /// No point satisfies all bounds.
    Infeasible,
    /// Feasible points improve without end.
    Unbounded,
    /// A limit was reached first.
    Undecided,
}

impl Status {
    /// The word used in results.
    pub fn word(self) -> &'static str {
        match self {
            Status::Optimal => "optimal",
            Status::Infeasible => "infeasible",
            Status::Unbounded => "unbounded",
            Status::Undecided => "undecided",
        }
    }
}

/// A sparse rational vector over one denominator: component `i` is `numerator / denominator`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vector {
    /// Positive.
    pub denominator: Int,
    /// Non-zero components by index. They are integers but for a small factor of the scaling.
    pub numerators: Vec<(u32, Rat)>,
}

impl Vector {
    /// The exact value of a component.
    pub fn value(&self, index: usize) -> Rat {
        let found = self
            .numerators
            .binary_search_by_key(&(index as u32), |e| e.0);
        match found {
            Ok(k) => &self.numerators[k].1 / &Rat::from(self.denominator.clone()),
            Err(_) => Rat::zero(),
        }
    }

    /// Bits of all numerators together.
    pub fn bits(&self) -> u64 {
        let each = self.numerators.iter();
        each.map(|(_, v)| v.numer().bits()).sum::<u64>() + self.denominator.bits()
    }
}

/// Where a variable or row rests in a basis certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the basis.
    Basic,
    /// At its lower bound.
    Lower,
    /// At its upper bound.
    Upper,
    /// Free, at zero.
    Zero,
}

/// A basis in the model's own terms: which columns and rows are basic, where the others rest.
///
/// Every [`Outcome`] of the exact method carries the last one, and [`super::Options::basis`] takes
/// one as the start for a similar program. As a start it need not fit: lists that are too short
/// or too long, places without a bound, a wrong number of basic ones or a singular choice are all
/// repaired, since exact arithmetic decides in any case.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Places {
    /// Places of the columns.
    pub columns: Vec<Place>,
    /// Places of the rows' activities.
    pub rows: Vec<Place>,
}

impl Places {
    pub(crate) fn of(basis: &Basis, n: usize) -> Places {
        let place = |s: &Resting| match s {
            Resting::Basic => Place::Basic,
            Resting::Lower => Place::Lower,
            Resting::Upper => Place::Upper,
            Resting::Zero => Place::Zero,
        };
        Places {
            columns: basis.status[..n].iter().map(place).collect(),
            rows: basis.status[n..].iter().map(place).collect(),
        }
    }

    /// The basis of a problem that this means. Columns that are not mentioned rest, rows that are
    /// not mentioned are basic (slack).
    pub(crate) fn basis(&self, problem: &Problem) -> Basis {
        let mut basis = Basis::slack(problem);
        let (columns, rows) = basis.status.split_at_mut(problem.n);
        let given = self.columns.iter().zip(columns);
        for (place, slot) in given.chain(self.rows.iter().zip(rows)) {
            *slot = match place {
                Place::Basic => Resting::Basic,
                Place::Lower => Resting::Lower,
                Place::Upper => Resting::Upper,
                Place::Zero => Resting::Zero,
            };
        }
        basis.tidy(problem);
        basis
    }
}

/// What proves a result. Vectors are in the model's own terms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Certificate {
    /// A feasible point and dual prices of equal objective.
    Optimal {
        /// Values of the columns.
        primal: Vector,
        /// Prices of the rows.
        dual: Vector,
    },
    /// A basis whose point and prices are too long to write out, with what makes checking it
    /// quick: the order of elimination and the two denominators, none of which is trusted.
    Basis {
        /// Places of the columns.
        columns: Vec<Place>,
        /// Places of the rows' activities.
        rows: Vec<Place>,
        /// (row, column) pairs in the order of elimination.
        order: Vec<(u32, u32)>,
        /// Denominator of the point in the integral scaling described in the verifier.
        primal_denominator: Int,
        /// Denominator of the prices, likewise.
        dual_denominator: Int,
    },
    /// Prices y with which the rows' activities and the columns' values contradict each other.
    Infeasible {
        /// Prices of the rows.
        prices: Vector,
    },
    /// A variable or row whose lower bound exceeds its upper bound.
    Crossed {
        /// Whether a row is meant.
        row: bool,
        /// Its index.
        index: u32,
    },
    /// A feasible point and a direction that stays feasible and improves.
    Unbounded {
        /// Values of the columns.
        point: Vector,
        /// Change of the columns.
        ray: Vector,
    },
    /// A feasible point and prices whose objectives enclose the optimum.
    Bounds {
        /// Values of the columns, if a feasible point is known.
        primal: Option<Vector>,
        /// Prices of the rows, if feasible ones are known.
        dual: Option<Vector>,
        /// Given where the prices are only nearly feasible: what helps to prove that feasible
        /// ones are so near that the bound holds as it stands.
        repair: Option<Repair>,
    },
}

/// Hints for the proof that feasible prices are near given ones. None of it is trusted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Repair {
    /// The free columns in an order of elimination that leaves few entries.
    pub order: Vec<u32>,
    /// 2 to the power of minus this is below all eigenvalues of the scaled matrix of the rows.
    pub margin: u32,
}

/// The result of solving a model.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// The objective: exact where the accuracy is, else the best value known.
    pub objective: Option<Rat>,
    /// A proven enclosure of the optimum, either end possibly unknown.
    pub enclosure: (Option<Rat>, Option<Rat>),
    /// `exact` or `warm`.
    pub method: &'static str,
    /// `float`, `bounds` or `exact`.
    pub accuracy: &'static str,
    /// The proof; `None` where nothing is decided, or for `float`.
    pub certificate: Option<Certificate>,
    /// The last basis of the exact method: the optimal one where there is an optimum. None where
    /// that method was not reached.
    pub basis: Option<Places>,
    /// Values of the columns as doubles, for pictures and directions: those of the exact vertex
    /// where there is one, else what floating point found. Empty where neither is known.
    pub near: Vec<f64>,
    /// Values of the columns, where asked for.
    pub values: Option<Vec<Rat>>,
    /// Prices of the rows, where asked for.
    pub prices: Option<Vec<Rat>>,
    /// Pivots of the exact simplex method.
    pub exact_pivots: u64,
    /// Iterations of floating point.
    pub float_iterations: u64,
    /// Why nothing was decided.
    pub reason: Option<String>,
}

impl Outcome {
    pub(crate) fn undecided(reason: &str) -> Outcome {
        Outcome {
            status: Status::Undecided,
            objective: None,
            enclosure: (None, None),
            method: "exact",
            accuracy: "exact",
            certificate: None,
            basis: None,
            near: Vec::new(),
            values: None,
            prices: None,
            exact_pivots: 0,
            float_iterations: 0,
            reason: Some(reason.to_string()),
        }
    }
}

/// Bits of vectors up to which a certificate carries them.
pub(crate) const VECTOR_BITS: u64 = 4_000_000;
/// Bits of sums of a row's or a column's sizes up to which a basis alone can be checked.
const BASIS_BITS: u64 = 2000;

/// Turns the exact method's verdict into a result in the model's terms.
pub(crate) fn conclude(model: &Model, verdict: &Verdict<'_>, want_values: bool) -> Outcome {
    let mut out = Outcome::undecided("");
    out.reason = None;
    out.basis = Some(Places::of(verdict.basis(), model.columns.len()));
    match verdict {
        Verdict::Optimal {
            frame,
            values,
            duals,
        } => {
            let p = frame.problem;
            out.status = Status::Optimal;
            out.near = near(frame, values);
            let mut terms = Vec::new();
            let mut constant = Int::zero();
            for j in 0..p.n {
                if p.cost[j].is_zero() {
                    continue;
                }
                if frame.basis.status[j] == Resting::Basic {
                    let q = values.component(frame, j);
                    terms.push((q.terms[0].0, p.cost[j].clone()));
                } else {
                    constant -= &(&p.cost[j] * &frame.resting_value(j));
                }
            }
            let top = values.solution.numerator(&terms, &constant);
            let scale = &(&values.solution.denominator * &p.bound_scale) * &p.cost_scale;
            let objective = &model.constant + &Rat::new(top, scale);
            out.enclosure = (Some(objective.clone()), Some(objective.clone()));
            out.objective = Some(objective);
            let lengths = frame.kernel.size() as u64
                * (values.solution.denominator.bits() + duals.solution.denominator.bits());
            let vectors = lengths <= VECTOR_BITS || p.sum_bits > BASIS_BITS;
            if want_values || vectors {
                let primal = point(frame, values);
                let dual = prices(frame, duals, &p.cost_scale);
                if want_values {
                    out.values = Some((0..p.n).map(|j| primal.value(j)).collect());
                    out.prices = Some((0..p.m).map(|i| dual.value(i)).collect());
                }
                if vectors {
                    out.certificate = Some(Certificate::Optimal { primal, dual });
                }
            }
            if out.certificate.is_none() {
                let (rows, columns) = frame.kernel.order();
                let places = Places::of(&frame.basis, p.n);
                out.certificate = Some(Certificate::Basis {
                    columns: places.columns,
                    rows: places.rows,
                    order: rows
                        .iter()
                        .zip(columns)
                        .map(|(&i, &j)| {
                            (
                                frame.kernel.rows[i as usize],
                                frame.kernel.columns[j as usize],
                            )
                        })
                        .collect(),
                    primal_denominator: with_contents(
                        &(&values.solution.denominator * &p.bound_scale),
                        frame
                            .kernel
                            .columns
                            .iter()
                            .map(|&j| p.column_scale[j as usize].denom()),
                    ),
                    dual_denominator: with_contents(
                        &(&duals.solution.denominator * &p.cost_scale.abs()),
                        frame
                            .kernel
                            .rows
                            .iter()
                            .map(|&i| p.row_scale[i as usize].denom()),
                    ),
                });
            }
        }
        Verdict::Infeasible { frame, prices: y } => {
            out.status = Status::Infeasible;
            out.certificate = Some(Certificate::Infeasible {
                prices: prices(frame, y, &Int::one()),
            });
        }
        Verdict::Unbounded {
            frame,
            values,
            direction,
            variable,
            sign,
        } => {
            let p = frame.problem;
            out.status = Status::Unbounded;
            let point = point(frame, values);
            let mut ray = Vec::new();
            let d = &direction.solution.denominator;
            for j in 0..p.n {
                let v = if frame.basis.status[j] == Resting::Basic {
                    -direction.numerator(&direction.component(frame, j))
                } else if j == *variable {
                    d.clone()
                } else {
                    continue;
                };
                if !v.is_zero() {
                    let v = Rat::from(v * Int::from(i64::from(*sign)));
                    ray.push((j as u32, v * &p.column_scale[j]));
                }
            }
            if want_values {
                out.values = Some((0..p.n).map(|j| point.value(j)).collect());
            }
            out.certificate = Some(Certificate::Unbounded {
                point,
                ray: Vector {
                    denominator: d.clone(),
                    numerators: ray,
                },
            });
        }
    }
    out
}

/// d times the least common multiple of the contents that scaling took out.
fn with_contents<'a>(d: &Int, contents: impl Iterator<Item = &'a Int>) -> Int {
    let common = contents.fold(Int::one(), |l, c| l.lcm(c));
    d * &common
}

/// Values of the columns as doubles.
fn near(frame: &Frame<'_>, values: &super::basis::ColumnVector) -> Vec<f64> {
    let p = frame.problem;
    let double = |v: &Rat| v.nearest_f64().unwrap_or(f64::INFINITY);
    // The scale of the bounds may lie past the double range, and values and a column's scale with
    // it: what they make together is what counts, so all go by mantissa and exponent.
    use super::digits::{ldexp, mantissa};
    let (scale, exponent) = mantissa(&p.bound_scale);
    (0..p.n)
        .map(|j| {
            let size = &p.column_scale[j];
            if frame.basis.status[j] != Resting::Basic {
                let v = Rat::new(frame.resting_value(j), p.bound_scale.clone());
                return double(&(v * size.clone()));
            }
            let (v, e) = values.scaled(&values.component(frame, j));
            let (v, e) = (v / scale, e - exponent);
            let (whole, by) = (ldexp(v, e), double(size));
            if (whole.is_normal() || whole == 0.0 && v == 0.0) && by.is_normal() {
                return whole * by;
            }
            let ((n, up), (d, down)) = (mantissa(size.numer()), mantissa(size.denom()));
            ldexp(v * n / d, e + up - down)
        })
        .collect()
}

/// Values of the columns, unscaled.
pub(crate) fn point(frame: &Frame<'_>, values: &super::basis::ColumnVector) -> Vector {
    let p = frame.problem;
    let d = &values.solution.denominator;
    let mut numerators = Vec::new();
    for j in 0..p.n {
        let v = if frame.basis.status[j] == Resting::Basic {
            values.numerator(&values.component(frame, j))
        } else {
            &frame.resting_value(j) * d
        };
        if !v.is_zero() {
            numerators.push((j as u32, Rat::from(v) * &p.column_scale[j]));
        }
    }
    Vector {
        denominator: d * &p.bound_scale,
        numerators,
    }
}

/// Prices of the rows, unscaled; `scale` is that of the costs.
pub(crate) fn prices(frame: &Frame<'_>, y: &RowVector, scale: &Int) -> Vector {
    let p: &Problem = frame.problem;
    let denominator = &y.solution.denominator * &scale.abs();
    let sign = Rat::from(i64::from(scale.sign()));
    let numerators = y
        .duals(frame)
        .into_iter()
        .enumerate()
        .filter(|(_, v)| !v.is_zero())
        .map(|(i, v)| (i as u32, &(Rat::from(v) * &p.row_scale[i]) * &sign))
        .collect();
    Vector {
        denominator,
        numerators,
    }
}
