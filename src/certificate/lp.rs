//! Checking certificates of linear programs; nothing here knows of any method that found them.
//!
//! - *optimal*: a point within all bounds, and prices y such that every column's reduced cost
//!   d = c − Aᵀy and every row's price has the sign its variable's place allows: where minimising,
//!   d > 0 only at the lower bound, d < 0 only at the upper one. Then for any feasible z,
//!   c·z − c·x = Σ d(z − x) + Σ y(Az − Ax) ≥ 0.
//! - *infeasible*: prices with which the interval of y·(rows' activities) misses that of
//!   (Aᵀy)·(columns' values), though the two are one number.
//! - *unbounded*: a feasible point and a direction that never leaves the bounds and improves.
//! - *bounds*: a feasible point and prices whose dual objective is the other end; prices may be
//!   those of the module `lp_near`, which are exact but for a remainder that it accounts for.
//! - *basis*: see the module `lp_basis`.
//!
//! All sums are of integers over common denominators.

use super::lp_basis;
use super::lp_near::Near;
use crate::lp::{Certificate, Model, Outcome, Range, Status, Vector};
use crate::number::{Int, Rat};

/// Why a certificate was rejected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rejection(pub String);

impl std::fmt::Display for Rejection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Rejection {}

pub(super) fn reject<T>(why: impl Into<String>) -> Result<T, Rejection> {
    Err(Rejection(why.into()))
}

/// What a result claims of a model.
#[derive(Clone, Debug)]
pub struct Claim {
    /// The status claimed.
    pub status: Status,
    /// The exact objective claimed, for an optimum.
    pub objective: Option<Rat>,
    /// The enclosure of the optimum claimed, where that is all.
    pub enclosure: (Option<Rat>, Option<Rat>),
    /// The proof offered.
    pub certificate: Certificate,
}

impl Claim {
    /// What an outcome claims; None if it offers no proof.
    pub fn of(outcome: &Outcome) -> Option<Claim> {
        Some(Claim {
            status: outcome.status,
            objective: outcome.objective.clone(),
            enclosure: outcome.enclosure.clone(),
            certificate: outcome.certificate.clone()?,
        })
    }
}

/// Checks that the certificate proves the claim.
pub fn verify(model: &Model, claim: &Claim) -> Result<(), Rejection> {
    match (&claim.certificate, claim.status) {
        (Certificate::Optimal { primal, dual }, Status::Optimal) => {
            let x = Point::new(model, primal)?;
            x.feasible(model)?;
            let y = Prices::new(model, dual)?;
            y.complementary(model, &x)?;
            objective_is(claim, &x.objective(model))
        }
        (
            Certificate::Basis {
                columns,
                rows,
                order,
                primal_denominator,
                dual_denominator,
            },
            Status::Optimal,
        ) => {
            let evidence = lp_basis::Evidence {
                columns,
                rows,
                order,
                primal_denominator,
                dual_denominator,
            };
            let value = lp_basis::objective(model, &evidence)?;
            objective_is(claim, &value)
        }
        (Certificate::Infeasible { prices }, Status::Infeasible) => {
            Prices::new(model, prices)?.contradictory(model)
        }
        (Certificate::Crossed { row, index }, Status::Infeasible) => {
            let range = if *row {
                model.rows.get(*index as usize).map(|r| &r.range)
            } else {
                model.columns.get(*index as usize).map(|c| &c.range)
            };
            match range {
                Some(range) if range.is_empty() => Ok(()),
                _ => reject("the bounds do not cross"),
            }
        }
        (Certificate::Unbounded { point, ray }, Status::Unbounded) => {
            Point::new(model, point)?.feasible(model)?;
            Point::new(model, ray)?.recedes(model)
        }
        (bounds @ Certificate::Bounds { .. }, Status::Optimal | Status::Undecided) => {
            if proven(model, bounds)? == claim.enclosure {
                Ok(())
            } else {
                reject("the enclosure claimed is not the one proven")
            }
        }
        _ => reject("the certificate is of another kind than the status"),
    }
}

/// The lower and the upper end of the optimum that a certificate of bounds proves; None where it
/// offers nothing for that end.
///
/// # Errors
/// Why it proves nothing, or that it is of another kind.
pub fn proven(
    model: &Model,
    certificate: &Certificate,
) -> Result<(Option<Rat>, Option<Rat>), Rejection> {
    let Certificate::Bounds {
        primal,
        dual,
        repair,
    } = certificate
    else {
        return reject("the certificate is not one of bounds");
    };
    let point = match primal {
        Some(v) => Some(worth(model, v)?),
        None => None,
    };
    let prices = match (dual, repair) {
        (Some(v), None) => Some(Prices::new(model, v)?.bound(model)?),
        (Some(v), Some(r)) => {
            let near = Near::new(model, Prices::new(model, v)?)?;
            Some(near.bound(&r.order, r.margin)?)
        }
        (None, None) => None,
        (None, Some(_)) => return reject("there are no prices to repair"),
    };
    Ok(if model.maximise {
        (point, prices)
    } else {
        (prices, point)
    })
}

/// The objective of a point, which must be feasible.
pub(crate) fn worth(model: &Model, point: &Vector) -> Result<Rat, Rejection> {
    let x = Point::new(model, point)?;
    x.feasible(model)?;
    Ok(x.objective(model))
}

fn objective_is(claim: &Claim, value: &Rat) -> Result<(), Rejection> {
    match &claim.objective {
        Some(o) if o == value => Ok(()),
        Some(_) => reject("the objective claimed is not that of the point"),
        None => reject("no objective is claimed"),
    }
}

/// Components as integers over one positive denominator.
fn integers(v: &Vector, length: usize) -> Result<(Vec<Int>, Int), Rejection> {
    if v.denominator.sign() <= 0 {
        return reject("a denominator is not positive");
    }
    let common = v
        .numerators
        .iter()
        .fold(Int::one(), |l, (_, n)| l.lcm(n.denom()));
    let mut out = vec![Int::zero(); length];
    let mut last = None;
    for (i, n) in &v.numerators {
        if *i as usize >= length || last.is_some_and(|l| l >= *i) {
            return reject("a vector's components are not in order");
        }
        last = Some(*i);
        out[*i as usize] = n.numer() * &common.div_exact(n.denom());
    }
    Ok((out, &v.denominator * &common))
}

/// The sign of value/scale − bound, for scale > 0.
fn against(value: &Int, scale: &Int, bound: &Rat) -> i32 {
    if bound.is_zero() {
        return value.sign();
    }
    (value * bound.denom() - scale * bound.numer()).sign()
}

/// Where value/scale stands in a range.
struct Standing {
    at_lower: bool,
    at_upper: bool,
}

fn standing(value: &Int, scale: &Int, range: &Range, name: &str) -> Result<Standing, Rejection> {
    let lower = range.lower.as_ref().map(|l| against(value, scale, l));
    let upper = range.upper.as_ref().map(|u| against(value, scale, u));
    if lower.is_some_and(|s| s < 0) || upper.is_some_and(|s| s > 0) {
        return reject(format!("`{name}` is outside its bounds"));
    }
    Ok(Standing {
        at_lower: lower == Some(0),
        at_upper: upper == Some(0),
    })
}

/// A point: columns over one denominator, activities over one each.
pub(super) struct Point {
    x: Vec<Int>,
    denominator: Int,
    /// Σ aᵢⱼ xⱼ times denominator times the row's factor.
    activity: Vec<Int>,
    factor: Vec<Int>,
}

impl Point {
    pub(super) fn new(model: &Model, v: &Vector) -> Result<Point, Rejection> {
        let (x, denominator) = integers(v, model.columns.len())?;
        let mut factor = vec![Int::one(); model.rows.len()];
        for c in &model.columns {
            for (i, a) in &c.entries {
                let f = &mut factor[*i as usize];
                *f = f.lcm(a.denom());
            }
        }
        let mut activity = vec![Int::zero(); model.rows.len()];
        for (c, x) in model.columns.iter().zip(&x) {
            if x.is_zero() {
                continue;
            }
            for (i, a) in &c.entries {
                let i = *i as usize;
                let a = a.numer() * &factor[i].div_exact(a.denom());
                activity[i] += &(&a * x);
            }
        }
        Ok(Point {
            x,
            denominator,
            activity,
            factor,
        })
    }

    fn column(&self, model: &Model, j: usize) -> Result<Standing, Rejection> {
        let c = &model.columns[j];
        standing(&self.x[j], &self.denominator, &c.range, &c.name)
    }

    fn row(&self, model: &Model, i: usize) -> Result<Standing, Rejection> {
        let r = &model.rows[i];
        let scale = &self.denominator * &self.factor[i];
        standing(&self.activity[i], &scale, &r.range, &r.name)
    }

    pub(super) fn feasible(&self, model: &Model) -> Result<(), Rejection> {
        for j in 0..model.columns.len() {
            self.column(model, j)?;
        }
        for i in 0..model.rows.len() {
            self.row(model, i)?;
        }
        Ok(())
    }

    /// c·x without the constant, as a fraction.
    fn slope(&self, model: &Model) -> Rat {
        let costs = model.columns.iter().map(|c| &c.cost);
        let scale = costs.fold(Int::one(), |l, c| l.lcm(c.denom()));
        let mut sum = Int::zero();
        for (c, x) in model.columns.iter().zip(&self.x) {
            if !c.cost.is_zero() && !x.is_zero() {
                let cost = c.cost.numer() * &scale.div_exact(c.cost.denom());
                sum += &(&cost * x);
            }
        }
        Rat::new(sum, &scale * &self.denominator)
    }

    pub(super) fn objective(&self, model: &Model) -> Rat {
        &model.constant + &self.slope(model)
    }

    /// As a direction: nothing moves towards a bound that exists, and the objective improves.
    fn recedes(&self, model: &Model) -> Result<(), Rejection> {
        let free = |sign: i32, range: &Range| {
            !(sign > 0 && range.upper.is_some() || sign < 0 && range.lower.is_some())
        };
        for (c, x) in model.columns.iter().zip(&self.x) {
            if !free(x.sign(), &c.range) {
                return reject(format!("the ray leaves the bounds of `{}`", c.name));
            }
        }
        for (r, a) in model.rows.iter().zip(&self.activity) {
            if !free(a.sign(), &r.range) {
                return reject(format!("the ray leaves the bounds of `{}`", r.name));
            }
        }
        let slope = self.slope(model).sign();
        if slope == if model.maximise { 1 } else { -1 } {
            Ok(())
        } else {
            reject("the ray does not improve the objective")
        }
    }
}

/// Prices of the rows over one denominator.
pub(crate) struct Prices {
    pub(super) y: Vec<Int>,
    pub(super) denominator: Int,
}

impl Prices {
    pub(crate) fn new(model: &Model, v: &Vector) -> Result<Prices, Rejection> {
        let (y, denominator) = integers(v, model.rows.len())?;
        Ok(Prices { y, denominator })
    }

    /// (cost − Aᵀy)ⱼ as an integer over a positive one.
    pub(super) fn reduced(&self, model: &Model, j: usize, with_cost: bool) -> (Int, Int) {
        let c = &model.columns[j];
        let mut scale = c.cost.denom().clone();
        for (_, a) in &c.entries {
            scale = scale.lcm(a.denom());
        }
        let mut sum = if with_cost && !c.cost.is_zero() {
            c.cost.numer() * &scale.div_exact(c.cost.denom()) * self.denominator.clone()
        } else {
            Int::zero()
        };
        for (i, a) in &c.entries {
            let y = &self.y[*i as usize];
            if !y.is_zero() {
                sum -= &(a.numer() * &scale.div_exact(a.denom()) * y.clone());
            }
        }
        (sum, &scale * &self.denominator)
    }

    /// Signs agree with where the point stands.
    fn complementary(&self, model: &Model, x: &Point) -> Result<(), Rejection> {
        let turn = if model.maximise { -1 } else { 1 };
        let agrees = |sign: i32, s: &Standing| match sign * turn {
            1 => s.at_lower,
            -1 => s.at_upper,
            _ => true,
        };
        for j in 0..model.columns.len() {
            let sign = self.reduced(model, j, true).0.sign();
            if sign != 0 && !agrees(sign, &x.column(model, j)?) {
                let name = &model.columns[j].name;
                return reject(format!("the reduced cost of `{name}` has the wrong sign"));
            }
        }
        for i in 0..model.rows.len() {
            let sign = self.y[i].sign();
            if sign != 0 && !agrees(sign, &x.row(model, i)?) {
                let name = &model.rows[i].name;
                return reject(format!("the price of `{name}` has the wrong sign"));
            }
        }
        Ok(())
    }

    /// (low, high) of y·s over the rows' ranges less (Aᵀy)·x over the columns'; what is missing
    /// is infinite. `with_cost` adds c·x; columns to `skip` are left out.
    fn extent(
        &self,
        model: &Model,
        with_cost: bool,
        skip: impl Fn(usize) -> bool,
    ) -> (Option<Rat>, Option<Rat>) {
        let mut ends = [Some(Sum::default()), Some(Sum::default())];
        let mut add = |value: &Int, scale: &Int, range: &Range| {
            if value.is_zero() {
                return;
            }
            let (low, high) = if value.sign() > 0 {
                (&range.lower, &range.upper)
            } else {
                (&range.upper, &range.lower)
            };
            for (end, bound) in ends.iter_mut().zip([low, high]) {
                match bound {
                    Some(b) if b.is_zero() => {}
                    Some(b) => {
                        if let Some(s) = end {
                            s.add(value * b.numer(), scale * b.denom());
                        }
                    }
                    None => *end = None,
                }
            }
        };
        for (r, y) in model.rows.iter().zip(&self.y) {
            add(y, &self.denominator, &r.range);
        }
        for (j, c) in model.columns.iter().enumerate() {
            if !skip(j) {
                let (d, scale) = self.reduced(model, j, with_cost);
                add(&d, &scale, &c.range);
            }
        }
        let [low, high] = ends;
        (low.map(|s| s.value()), high.map(|s| s.value()))
    }

    /// Zero is not within the extent of y·s − (Aᵀy)·x, which is zero.
    fn contradictory(&self, model: &Model) -> Result<(), Rejection> {
        let (low, high) = self.extent(model, false, |_| false);
        if low.is_some_and(|l| l.sign() > 0) || high.is_some_and(|h| h.sign() < 0) {
            Ok(())
        } else {
            reject("the prices do not contradict the bounds")
        }
    }

    /// The bound on the objective: c·x = (c − Aᵀy)·x + y·s at its least (greatest).
    pub(super) fn bound(&self, model: &Model) -> Result<Rat, Rejection> {
        self.bound_but(model, |_| false)
    }

    /// The same for columns to `skip` whose reduced costs are known to be zero.
    pub(super) fn bound_but(
        &self,
        model: &Model,
        skip: impl Fn(usize) -> bool,
    ) -> Result<Rat, Rejection> {
        let (low, high) = self.extent(model, true, skip);
        match if model.maximise { high } else { low } {
            Some(v) => Ok(&model.constant + &v),
            None => reject("the prices bound nothing"),
        }
    }
}

/// A sum of fractions whose denominators mostly agree.
#[derive(Default)]
struct Sum {
    parts: Vec<(Int, Int)>,
}

impl Sum {
    fn add(&mut self, top: Int, bottom: Int) {
        match self.parts.iter_mut().find(|p| p.1 == bottom) {
            Some(p) => p.0 += &top,
            None => self.parts.push((top, bottom)),
        }
    }

    fn value(self) -> Rat {
        let parts = self.parts.into_iter();
        parts.fold(Rat::zero(), |s, (n, d)| s + Rat::new(n, d))
    }
}
