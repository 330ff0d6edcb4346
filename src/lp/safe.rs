//! Certified bounds from points that need not be optimal.
//!
//! Any feasible point bounds the optimum from one side; any prices bound it from the other, as
//! c·x = (c − Aᵀy)·x + y·(A·x) lies above what the bounds of columns and rows leave of it. Here
//! both are computed exactly from whatever is at hand: doubles from floating point, or the basis
//! that the exact method had reached when a limit stopped it. What cannot be proven is dropped.

use super::budget::Budget;
use super::enclose::Enclosure;
use super::implied::Implied;
use super::model::{Model, Range};
use super::outcome::{Certificate, Outcome, Repair, Status, Vector};
use super::repair;
use crate::number::{Int, Rat};

/// What is proven about the optimum so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Known {
    /// A feasible point and its objective.
    primal: Option<(Vector, Rat)>,
    /// Prices and the bound that they prove.
    dual: Option<(Vector, Rat)>,
    /// What the proof needs where the prices are only nearly feasible.
    repair: Option<Repair>,
    /// Where no prices were found, a column that no single row bounds.
    open: Option<usize>,
}

/// Gap between the two ends, relative to the larger of 1 and their size, that counts as closed.
const GAP: (i64, i64) = (1, 1_000_000_000);

impl Known {
    /// Takes a feasible point in, where it is better than the one known.
    pub(crate) fn point(&mut self, model: &Model, point: Vector) {
        let value = objective(model, &point);
        let better = |old: &Rat| (value < *old) != model.maximise;
        if self.primal.as_ref().is_none_or(|(_, old)| better(old)) {
            self.primal = Some((point, value));
        }
    }

    /// Takes prices in, where they prove more than those known.
    pub(crate) fn prices(&mut self, model: &Model, prices: Vector) {
        let Some(value) = bound(model, &prices) else {
            return;
        };
        let better = |old: &Rat| (value > *old) != model.maximise;
        if self.dual.as_ref().is_none_or(|(_, old)| better(old)) {
            self.dual = Some((prices, value));
            self.repair = None;
        }
    }

    /// Takes in an enclosure whose ends are proven already.
    pub(crate) fn enclosed(&mut self, ends: Enclosure) {
        self.primal = Some(ends.primal);
        self.dual = Some(ends.dual);
        self.repair = ends.repair;
    }

    /// Takes in what doubles suggest: values of the columns and prices of the rows, both of which
    /// may be missing or wrong.
    ///
    /// Where no prices at hand prove a bound, ones are made that do, within the `budget`.
    pub(crate) fn guess(&mut self, model: &Model, x: &[f64], y: &[f64], budget: &Budget) {
        let rest: Vec<Rat> = model
            .columns
            .iter()
            .map(|c| nearest_zero(&c.range))
            .collect();
        let rest_feasible = feasible(model, &rest);
        if let Some(x) = exact(x, model.columns.len()) {
            let mut x = x;
            for (v, c) in x.iter_mut().zip(&model.columns) {
                clamp(v, &c.range);
            }
            // Back towards a point that is certainly feasible, as little as will do.
            let steps: &[u32] = if rest_feasible {
                &[30, 20, 10, 4, 1]
            } else {
                &[]
            };
            let mut found = feasible(model, &x).then(|| x.clone());
            for &k in steps {
                if found.is_none() {
                    let back = Rat::new(Int::one(), Int::one().shl(u64::from(k)));
                    let mixed = x.iter().zip(&rest).map(|(a, b)| a + &(&(b - a) * &back));
                    let mixed: Vec<Rat> = mixed.collect();
                    found = feasible(model, &mixed).then_some(mixed);
                }
            }
            if let Some(x) = found {
                self.point(model, vector(&x));
            }
        }
        if rest_feasible {
            self.point(model, vector(&rest));
        }
        self.double_prices(model, y);
        self.prices(model, vector(&[]));
        if self.dual.is_none() {
            for near in [y, &[]] {
                if let Some(y) = repair::prices(model, near) {
                    self.double_prices(model, &y);
                }
            }
        }
        if self.dual.is_none() {
            let implied = Implied::new(model);
            for near in [exact(y, model.rows.len()), Some(Vec::new())] {
                let near = near.as_deref();
                let found = near.map(|y| implied.prices(model, y, budget));
                if let Some(Ok(Some(y))) = found {
                    self.prices(model, vector(&y));
                }
            }
            self.open = implied.open();
        }
    }

    /// What is not known of the two ends, as the end of a sentence; empty where both are.
    pub(crate) fn missing(&self, model: &Model) -> String {
        let mut out = String::new();
        if self.primal.is_none() {
            out.push_str("; no feasible point is known");
        }
        if self.dual.is_none() {
            out.push_str("; no prices that bound the objective are known");
            if let Some(j) = self.open {
                let name = &model.columns[j].name;
                out.push_str(&format!(", and no single row bounds column `{name}`"));
            }
        }
        out
    }

    /// Takes in prices that doubles suggest.
    fn double_prices(&mut self, model: &Model, y: &[f64]) {
        let Some(mut y) = exact(y, model.rows.len()) else {
            return;
        };
        for (v, r) in y.iter_mut().zip(&model.rows) {
            // A price needs the bound that it leans on.
            let sign = if model.maximise { -v.sign() } else { v.sign() };
            let missing = match sign {
                1 => r.range.lower.is_none(),
                -1 => r.range.upper.is_none(),
                _ => false,
            };
            if missing {
                *v = Rat::zero();
            }
        }
        self.prices(model, vector(&y));
    }

    /// Whether doubles have any chance to be feasible as they are: not where rows are equations,
    /// nor, for the prices, where columns are free.
    pub(crate) fn may_guess(model: &Model) -> bool {
        let equation = |r: &Range| r.lower.is_some() && r.lower == r.upper;
        let free = |r: &Range| r.lower.is_none() && r.upper.is_none();
        !model.rows.iter().any(|r| equation(&r.range))
            && !model.columns.iter().any(|c| free(&c.range))
    }

    /// Whether the two ends are known and meet but for 10⁻⁹.
    pub(crate) fn closed(&self) -> bool {
        let (Some((_, a)), Some((_, b))) = (&self.primal, &self.dual) else {
            return false;
        };
        let mut size = Rat::one();
        for v in [a.abs(), b.abs()] {
            if v > size {
                size = v;
            }
        }
        (a - b).abs() <= &size * &Rat::frac(GAP.0, GAP.1)
    }

    /// Writes the enclosure and its proof into an outcome. It is optimal where the ends are one,
    /// or where an enclosure is all that was `asked` for and it is closed.
    pub(crate) fn publish(self, model: &Model, asked: bool, out: &mut Outcome) {
        if self.primal.is_none() && self.dual.is_none() {
            return;
        }
        let met = matches!((&self.primal, &self.dual), (Some((_, a)), Some((_, b))) if a == b);
        if met || asked && self.closed() {
            out.status = Status::Optimal;
            out.reason = None;
            out.objective = self.primal.as_ref().map(|p| p.1.clone());
        }
        if met
            && self.repair.is_none()
            && let (Some((primal, value)), Some((dual, _))) = (&self.primal, &self.dual)
        {
            out.enclosure = (Some(value.clone()), Some(value.clone()));
            out.certificate = Some(Certificate::Optimal {
                primal: primal.clone(),
                dual: dual.clone(),
            });
            return;
        }
        let (above, below) = (
            self.primal.as_ref().map(|p| p.1.clone()),
            self.dual.as_ref().map(|d| d.1.clone()),
        );
        out.enclosure = if model.maximise {
            (above, below)
        } else {
            (below, above)
        };
        out.certificate = Some(Certificate::Bounds {
            primal: self.primal.map(|p| p.0),
            dual: self.dual.map(|d| d.0),
            repair: self.repair,
        });
    }
}

fn exact(v: &[f64], length: usize) -> Option<Vec<Rat>> {
    let usable = v.len() == length && v.iter().all(|v| v.is_finite() && v.abs() < 1e100);
    let small = |v: f64| if v.abs() < 1e-100 { 0.0 } else { v };
    usable.then(|| v.iter().map(|&v| Rat::from_f64(small(v))).collect())
}

fn vector(v: &[Rat]) -> Vector {
    let entries = (0..).zip(v).filter(|(_, v)| !v.is_zero());
    Vector {
        denominator: Int::one(),
        numerators: entries.map(|(k, v)| (k, v.clone())).collect(),
    }
}

fn nearest_zero(range: &Range) -> Rat {
    let mut v = Rat::zero();
    clamp(&mut v, range);
    v
}

fn clamp(v: &mut Rat, range: &Range) {
    if let Some(l) = &range.lower
        && *v < *l
    {
        *v = l.clone();
    }
    if let Some(u) = &range.upper
        && *v > *u
    {
        *v = u.clone();
    }
}

/// Whether all columns and rows lie within their bounds.
fn feasible(model: &Model, x: &[Rat]) -> bool {
    let mut activity = vec![Rat::zero(); model.rows.len()];
    for (c, x) in model.columns.iter().zip(x) {
        if !c.range.contains(x) {
            return false;
        }
        if !x.is_zero() {
            for (i, a) in &c.entries {
                let slot = &mut activity[*i as usize];
                *slot = &*slot + &(a * x);
            }
        }
    }
    let mut rows = model.rows.iter().zip(&activity);
    rows.all(|(r, a)| r.range.contains(a))
}

fn objective(model: &Model, x: &Vector) -> Rat {
    let scale = Rat::from(x.denominator.clone());
    let mut sum = Rat::zero();
    for (j, v) in &x.numerators {
        let cost = &model.columns[*j as usize].cost;
        if !cost.is_zero() {
            sum = &sum + &(cost * v);
        }
    }
    &model.constant + &(&sum / &scale)
}

/// What the prices prove: the least (greatest, where maximising) that they leave possible.
fn bound(model: &Model, y: &Vector) -> Option<Rat> {
    let scale = Rat::from(y.denominator.clone());
    let mut prices = vec![Rat::zero(); model.rows.len()];
    for (i, v) in &y.numerators {
        prices[*i as usize] = v.clone();
    }
    let mut sum = Rat::zero();
    let mut add = |price: &Rat, range: &Range| -> Option<()> {
        let least = (price.sign() > 0) != model.maximise;
        if !price.is_zero() {
            let end = if least { &range.lower } else { &range.upper };
            let end = end.as_ref()?;
            if !end.is_zero() {
                sum = &sum + &(price * end);
            }
        }
        Some(())
    };
    for (r, y) in model.rows.iter().zip(&prices) {
        add(y, &r.range)?;
    }
    for c in &model.columns {
        let mut d = &c.cost * &scale;
        for (i, a) in &c.entries {
            let y = &prices[*i as usize];
            if !y.is_zero() {
                d = &d - &(a * y);
            }
        }
        add(&d, &c.range)?;
    }
    Some(&model.constant + &(&sum / &scale))
}
