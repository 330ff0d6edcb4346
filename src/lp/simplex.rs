//! The exact simplex method, which stands on its own and has the last word after any proposal.
//!
//! Bounded primal and dual simplex over the rationals on a factorised basis. Every decision is a
//! sign or a comparison of exact numbers, settled by certified enclosures where they can settle
//! it. From a basis that is primal infeasible but dual feasible the dual method runs; otherwise
//! the primal one, whose first phase minimises the sum of infeasibilities.
//!
//! **Why it ends.** The status vector determines x, so the value that is minimised (the sum of
//! infeasibilities, then the objective; in the dual method the dual objective) is a function of
//! the status. It never gets worse, so a status can only recur along steps of length zero, during
//! which x (the duals) and hence the set of infeasible variables and the phase's costs stay
//! fixed: such a run is a run of the simplex method on *one* program, where an infeasible
//! variable has its violated bound as its only one. After [`PATIENCE`] steps of length zero the
//! choice of both variables is by least index among the candidates (Bland's rule) until a step
//! has length, and Bland's rule does not cycle (ties of the ratio test always go to the least).
//! There are finitely many statuses, finitely many proposals from outside, and the method changes
//! at most three times: the search for a feasible point that [`run`] may begin with ends in one,
//! after which the primal method keeps it.

use super::basis::{Basis, ColumnVector, Frame, Query, RowVector, Status};
use super::budget::{Budget, Exhausted, Stage};
use super::problem::Problem;
use crate::number::Int;
use std::cmp::Ordering;

/// Steps of length zero before Bland's rule takes over.
const PATIENCE: u64 = 30;

/// How the exact method ended.
pub(crate) enum Verdict<'a> {
    /// Primal and dual feasible.
    Optimal {
        frame: Frame<'a>,
        values: ColumnVector,
        duals: RowVector,
    },
    /// Prices that prove that no point satisfies all bounds.
    Infeasible { frame: Frame<'a>, prices: RowVector },
    /// A feasible basis, the variable that may leave its bound and its direction (±1).
    Unbounded {
        frame: Frame<'a>,
        values: ColumnVector,
        direction: ColumnVector,
        variable: usize,
        sign: i32,
    },
}

impl Verdict<'_> {
    /// The basis it was reached at.
    pub(crate) fn basis(&self) -> &Basis {
        match self {
            Verdict::Optimal { frame, .. }
            | Verdict::Infeasible { frame, .. }
            | Verdict::Unbounded { frame, .. } => &frame.basis,
        }
    }
}

/// Is shown every basis that is not the last: its values where they are feasible, its prices.
/// Ends the run by answering true.
pub(crate) type Watch<'w> = dyn FnMut(&Frame<'_>, Option<&ColumnVector>, &RowVector) -> bool + 'w;

/// Is shown every basis that is neither the last nor part of the search for a feasible point, and
/// may propose another one.
pub(crate) type Refine<'r> = dyn FnMut(&Frame<'_>, &ColumnVector, &RowVector) -> Option<Basis> + 'r;

/// What a run took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effort {
    pub(crate) pivots: u64,
    pub(crate) refinements: u64,
}

/// Which bound a basic variable violates.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Breach {
    None,
    Below,
    Above,
}

enum Step<'a> {
    Done(Box<Verdict<'a>>),
    Move {
        basis: Basis,
        length_zero: bool,
    },
    /// Proposed from outside: nothing is known of it.
    Jump(Basis),
}

/// Runs the exact simplex method from a basis (repaired if singular) to the end.
///
/// `blame` is a basic variable that floating point holds for irreparable. The question is then
/// first whether there is any feasible point: costs are taken for zero, for which every basis is
/// dual feasible, until the dual method has brought a feasible basis or a proof that there is none.
pub(crate) fn run<'a>(
    problem: &'a Problem,
    start: Basis,
    blame: Option<usize>,
    watch: &mut Watch<'_>,
    refine: &mut Refine<'_>,
    budget: &Budget,
    effort: &mut Effort,
) -> Result<Verdict<'a>, (Exhausted, Basis)> {
    let mut basis = start;
    let mut stalled = 0;
    let mut regular = false;
    // The denominator of the last values: other solutions for the same basis are likely to share it.
    let mut guess = None;
    let mut seeking = blame;
    loop {
        budget.report(Stage::Exact, effort.pivots);
        let frame = Frame::new(problem, basis, regular);
        regular = true;
        let before = frame.basis.clone();
        match step(
            frame,
            stalled >= PATIENCE,
            &mut seeking,
            watch,
            refine,
            &mut guess,
            budget,
        ) {
            Ok(Step::Jump(next)) => {
                effort.refinements += 1;
                (regular, guess) = (false, None);
                basis = next;
            }
            Ok(Step::Done(verdict)) => return Ok(*verdict),
            Ok(Step::Move {
                basis: next,
                length_zero,
            }) => {
                effort.pivots += 1;
                stalled = if length_zero { stalled + 1 } else { 0 };
                basis = next;
            }
            Err(e) => return Err((e, before)),
        }
    }
}

fn step<'a>(
    frame: Frame<'a>,
    bland: bool,
    seeking: &mut Option<usize>,
    watch: &mut Watch<'_>,
    refine: &mut Refine<'_>,
    guess: &mut Option<Int>,
    budget: &Budget,
) -> Result<Step<'a>, Exhausted> {
    budget.check()?;
    let p = frame.problem;
    let values = frame.values(guess.as_ref(), budget)?;
    *guess = Some(values.solution.denominator.clone());
    let guess = guess.as_ref();
    let breaches: Vec<(usize, Breach)> = frame
        .basics()
        .map(|v| (v, breach(&frame, &values, v)))
        .collect();
    let infeasible = breaches.iter().any(|b| b.1 != Breach::None);
    if !infeasible {
        *seeking = None;
    }
    if let Some(first) = *seeking {
        let none = frame.price(|_| Int::zero(), Some(&Int::one()), budget)?;
        let wrong = |b: &&(usize, Breach)| b.0 == first && b.1 != Breach::None;
        let breaches = match breaches.iter().find(wrong) {
            Some(b) if !bland => std::slice::from_ref(b),
            _ => &breaches[..],
        };
        return dual_step(frame, &values, breaches, &none, bland, guess, budget);
    }
    let duals = frame.price(|v| cost(p, v), guess, budget)?;
    let improving = entering(&frame, &duals, bland);
    if !infeasible {
        let Some((q, sign)) = improving else {
            return Ok(Step::Done(Box::new(Verdict::Optimal {
                frame,
                values,
                duals,
            })));
        };
        if watch(&frame, Some(&values), &duals) {
            return Err(Exhausted);
        }
        if let Some(basis) = refine(&frame, &values, &duals) {
            return Ok(Step::Jump(basis));
        }
        return primal_step(frame, values, breaches, q, sign, guess, budget);
    }
    if watch(&frame, None, &duals) {
        return Err(Exhausted);
    }
    if let Some(basis) = refine(&frame, &values, &duals) {
        return Ok(Step::Jump(basis));
    }
    if improving.is_none() {
        return dual_step(frame, &values, &breaches, &duals, bland, guess, budget);
    }
    // Phase one: a step along the slope of the sum of infeasibilities.
    let mut slope = vec![0i64; p.n + p.m];
    for &(v, b) in &breaches {
        slope[v] = match b {
            Breach::Below => -1,
            Breach::Above => 1,
            Breach::None => 0,
        };
    }
    let prices = frame.price(|v| Int::from(slope[v]), guess, budget)?;
    match entering(&frame, &prices, bland) {
        None => Ok(Step::Done(Box::new(Verdict::Infeasible { frame, prices }))),
        Some((q, sign)) => primal_step(frame, values, breaches, q, sign, guess, budget),
    }
}

fn cost(p: &Problem, v: usize) -> Int {
    p.cost.get(v).cloned().unwrap_or_else(Int::zero)
}

fn breach(frame: &Frame<'_>, values: &ColumnVector, v: usize) -> Breach {
    let p = frame.problem;
    if let Some(l) = &p.lower[v]
        && values.sign(&values.component(frame, v).minus(l)) < 0
    {
        return Breach::Below;
    }
    if let Some(u) = &p.upper[v]
        && values.sign(&values.component(frame, v).minus(u)) > 0
    {
        return Breach::Above;
    }
    Breach::None
}

/// +1 where raising the variable lowers the cost and it may rise, −1 for lowering, 0 for neither.
fn improves(frame: &Frame<'_>, v: usize, reduced: i32) -> i32 {
    match frame.basis.status[v] {
        _ if frame.problem.is_fixed(v) => 0,
        Status::Lower if reduced < 0 => 1,
        Status::Upper if reduced > 0 => -1,
        Status::Zero => -reduced,
        _ => 0,
    }
}

/// A variable that improves, and its direction; the least index under Bland's rule, else the
/// steepest by estimate.
fn entering(frame: &Frame<'_>, duals: &RowVector, bland: bool) -> Option<(usize, i32)> {
    let mut best: Option<(usize, i32, f64)> = None;
    for v in 0..frame.basis.status.len() {
        if frame.basis.status[v] == Status::Basic || frame.problem.is_fixed(v) {
            continue;
        }
        let q = duals.reduced(frame, v);
        let sign = improves(frame, v, duals.sign(&q));
        if sign == 0 {
            continue;
        }
        if bland {
            return Some((v, sign));
        }
        let slope = duals.approximate(&q).abs();
        if best.as_ref().is_none_or(|b| slope > b.2) {
            best = Some((v, sign, slope));
        }
    }
    best.map(|b| (b.0, b.1))
}

/// A non-negative ratio of two exact numbers, first by enclosures, in full where they tie.
struct Ratio<'q> {
    variable: usize,
    /// A missing query is an exact zero.
    top: (&'q dyn Exact, Option<Query>),
    bottom: (&'q dyn Exact, Query),
    /// (low, high) of both.
    enclosure: ((Int, Int), (Int, Int)),
    full: Option<(Int, Int)>,
}

/// What a ratio needs of its vectors.
trait Exact {
    fn exact(&self, q: &Query) -> Int;
    fn enclose(&self, q: &Query) -> (Int, Int);
}

impl Exact for ColumnVector {
    fn exact(&self, q: &Query) -> Int {
        self.numerator(q)
    }
    fn enclose(&self, q: &Query) -> (Int, Int) {
        self.solution.size(&q.terms, &q.constant)
    }
}

impl Exact for RowVector {
    fn exact(&self, q: &Query) -> Int {
        self.numerator(q)
    }
    fn enclose(&self, q: &Query) -> (Int, Int) {
        self.solution.size(&q.terms, &q.constant)
    }
}

impl<'q> Ratio<'q> {
    fn new(
        variable: usize,
        top: (&'q dyn Exact, Option<Query>),
        bottom: (&'q dyn Exact, Query),
    ) -> Ratio<'q> {
        let size = match &top.1 {
            Some(q) => top.0.enclose(q),
            None => (Int::zero(), Int::zero()),
        };
        Ratio {
            variable,
            enclosure: (size, bottom.0.enclose(&bottom.1)),
            top,
            bottom,
            full: None,
        }
    }

    /// |top| and |bottom| in full.
    fn full(&mut self) -> &(Int, Int) {
        let (top, bottom) = (&self.top, &self.bottom);
        self.full.get_or_insert_with(|| {
            let size = match &top.1 {
                Some(q) => top.0.exact(q).abs(),
                None => Int::zero(),
            };
            (size, bottom.0.exact(&bottom.1).abs())
        })
    }

    fn compare(&mut self, other: &mut Ratio<'q>) -> Ordering {
        {
            let ((a, b), (c, d)) = &self.enclosure;
            let ((e, f), (g, h)) = &other.enclosure;
            // [a, b]/[c, d] against [e, f]/[g, h]
            if b * h < e * c {
                return Ordering::Less;
            }
            if f * d < a * g {
                return Ordering::Greater;
            }
        }
        let (n, d) = self.full().clone();
        let (bn, bd) = other.full();
        (&n * bd).cmp(&(bn * &d))
    }
}

/// Least ratio, ties by least variable.
fn least(ratios: Vec<Ratio<'_>>) -> Option<Ratio<'_>> {
    let zero = ratios.iter().any(|r| r.top.1.is_none());
    let mut best: Option<Ratio<'_>> = None;
    for mut r in ratios {
        if zero && r.top.1.is_some() {
            continue;
        }
        let better = match &mut best {
            None => true,
            Some(b) if zero => r.variable < b.variable,
            Some(b) => match r.compare(b) {
                Ordering::Less => true,
                Ordering::Equal => r.variable < b.variable,
                Ordering::Greater => false,
            },
        };
        if better {
            best = Some(r);
        }
    }
    best
}

#[allow(clippy::too_many_arguments)] // one step's whole state, used once
fn primal_step<'a>(
    frame: Frame<'a>,
    values: ColumnVector,
    breaches: Vec<(usize, Breach)>,
    q: usize,
    sign: i32,
    guess: Option<&Int>,
    budget: &Budget,
) -> Result<Step<'a>, Exhausted> {
    let p = frame.problem;
    let direction = frame.direction(q, guess, budget)?;
    let feasible = breaches.iter().all(|b| b.1 == Breach::None);
    let mut ratios = Vec::new();
    let mut to_upper = vec![false; p.n + p.m];
    for &(v, b) in &breaches {
        let fall = direction.component(&frame, v);
        let rate = -direction.sign(&fall) * sign; // sign of the change of v
        let bound = match (rate, b) {
            (0, _) => None,
            (1, Breach::Below) => p.lower[v].as_ref().map(|l| (l, false)),
            (1, Breach::None) => p.upper[v].as_ref().map(|u| (u, true)),
            (-1, Breach::Above) => p.upper[v].as_ref().map(|u| (u, true)),
            (-1, Breach::None) => p.lower[v].as_ref().map(|l| (l, false)),
            _ => None,
        };
        if let Some((bound, upper)) = bound {
            let top = values.component(&frame, v).minus(bound);
            to_upper[v] = upper;
            let top = (values.sign(&top) != 0).then_some(top);
            ratios.push(Ratio::new(v, (&values, top), (&direction, fall)));
        }
    }
    let mut chosen = least(ratios);
    let mut length_zero = false;
    if let Some(c) = &mut chosen {
        length_zero = c.top.1.is_none();
    }
    // The entering variable's own other bound.
    if let (Some(l), Some(u)) = (&p.lower[q], &p.upper[q]) {
        let width = u - l;
        let flips = match &mut chosen {
            None => true,
            Some(_) if length_zero => false,
            Some(c) => {
                let (n, d) = c.full();
                // n/D₁ : d/D₂ against the width.
                n * &direction.solution.denominator
                    >= &width * d * values.solution.denominator.clone()
            }
        };
        if flips {
            let mut basis = frame.basis;
            basis.status[q] = if sign > 0 {
                Status::Upper
            } else {
                Status::Lower
            };
            return Ok(Step::Move {
                basis,
                length_zero: false,
            });
        }
    }
    let leaving = chosen.as_ref().map(|c| c.variable);
    drop(chosen);
    match leaving {
        None if feasible => Ok(Step::Done(Box::new(Verdict::Unbounded {
            frame,
            values,
            direction,
            variable: q,
            sign,
        }))),
        // Phase one is bounded below by zero, so some infeasible variable blocks.
        None => Err(Exhausted),
        Some(v) => {
            let mut basis = frame.basis;
            basis.status[v] = if to_upper[v] {
                Status::Upper
            } else {
                Status::Lower
            };
            basis.status[q] = Status::Basic;
            Ok(Step::Move { basis, length_zero })
        }
    }
}

fn dual_step<'a>(
    frame: Frame<'a>,
    values: &ColumnVector,
    breaches: &[(usize, Breach)],
    duals: &RowVector,
    bland: bool,
    guess: Option<&Int>,
    budget: &Budget,
) -> Result<Step<'a>, Exhausted> {
    let p = frame.problem;
    let mut leaving: Option<(usize, Breach, f64)> = None;
    for &(v, b) in breaches {
        let bound = match b {
            Breach::None => continue,
            Breach::Below => &p.lower[v],
            Breach::Above => &p.upper[v],
        };
        let size = match bound {
            Some(bound) if !bland => values.approximate(&values.component(&frame, v).minus(bound)),
            _ => 0.0,
        };
        if leaving.as_ref().is_none_or(|l| size.abs() > l.2) {
            leaving = Some((v, b, size.abs()));
        }
    }
    let Some((r, b, _)) = leaving else {
        return Err(Exhausted);
    };
    // The infeasibility of r alone as the cost: what cannot lower it proves infeasibility.
    let slope = if b == Breach::Below { -1i64 } else { 1 };
    let row = frame.price(|v| Int::from(if v == r { slope } else { 0 }), guess, budget)?;
    let mut ratios = Vec::new();
    for v in 0..frame.basis.status.len() {
        if frame.basis.status[v] == Status::Basic {
            continue;
        }
        let bottom = row.reduced(&frame, v);
        if improves(&frame, v, row.sign(&bottom)) == 0 {
            continue;
        }
        let top = duals.reduced(&frame, v);
        let top = (duals.sign(&top) != 0).then_some(top);
        ratios.push(Ratio::new(v, (duals, top), (&row, bottom)));
    }
    let Some(chosen) = least(ratios) else {
        return Ok(Step::Done(Box::new(Verdict::Infeasible {
            frame,
            prices: row,
        })));
    };
    let (q, length_zero) = (chosen.variable, chosen.top.1.is_none());
    drop(chosen);
    let mut basis = frame.basis;
    basis.status[r] = if b == Breach::Below {
        Status::Lower
    } else {
        Status::Upper
    };
    basis.status[q] = Status::Basic;
    Ok(Step::Move { basis, length_zero })
}

#[cfg(test)]
mod tests {
    use crate::lp::field::Prime;
    use crate::lp::{Model, Options, Range, solve};
    use crate::number::Rat;

    /// Coefficients that vanish modulo the primes used must not send the method in circles.
    #[test]
    fn multiples_of_the_primes() {
        let product = (0..5).fold(Rat::one(), |v, k| v * Rat::from(Prime::nth(k).p as i64));
        let mut model = Model::new("primes");
        model.maximise = true;
        let x = model.add_column("x", Rat::one(), Range::free());
        let y = model.add_column("y", Rat::one(), Range::at_least(Rat::zero()));
        let r = model.add_row("r", Range::at_most(Rat::one()));
        model.set(r, x, product.clone());
        model.set(r, y, &product + &Rat::one());
        let s = model.add_row("s", Range::at_most(Rat::one()));
        model.set(s, x, Rat::one());
        let out = solve(&model, &Options::default());
        assert_eq!(out.objective, Some(product.recip()));
    }
}
