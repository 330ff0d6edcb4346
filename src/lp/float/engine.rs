//! What the dual and the primal method share: a basis in doubles, its factors, updates, values.
//!
//! The factors are refreshed every [`REFRESH`] pivots; in between, each pivot appends the column
//! that entered (the product form of the inverse).

use super::program::Program;
use crate::lp::basis::Status;
use crate::lp::budget::{Budget, Exhausted};
use crate::lp::field::Double;
use crate::lp::lu::{Lu, factorise};

/// Pivots between two factorisations.
pub(crate) const REFRESH: usize = 64;
/// Feasibility tolerances of values and of reduced costs: first, and for the finish.
const TOLERANCES: [f64; 3] = [1e-7, 1e-9, 1e-12];
/// Wrong reduced costs that are left to exact arithmetic where floating point gives up.
const FEW: usize = 16;
/// Relative size of the random widening of bounds.
const WIDTH: f64 = 1e-6;
/// Smallest pivot.
pub(crate) const PIVOT: f64 = 1e-7;

/// How a float run ended, as far as floats can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    Optimal,
    Infeasible,
    Unbounded,
    /// Gave up; the basis may still be a good start.
    Stuck,
}

struct Eta {
    position: usize,
    pivot: f64,
    entries: Vec<(u32, f64)>,
}

/// A basis at work.
pub(crate) struct Engine<'a> {
    pub(crate) program: &'a Program,
    /// Working costs of all variables (logicals have zero but for shifts).
    pub(crate) cost: Vec<f64>,
    /// Working bounds: the program's, but for a while under perturbation.
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    pub(crate) status: Vec<Status>,
    /// Basic variable at each position.
    pub(crate) head: Vec<usize>,
    pub(crate) x: Vec<f64>,
    pub(crate) d: Vec<f64>,
    lu: Option<Lu<f64>>,
    etas: Vec<Eta>,
    work: Vec<f64>,
    pub(crate) iterations: u64,
    random: u64,
    /// The basic variable whose row seemed to prove the program infeasible.
    pub(crate) blame: Option<usize>,
    /// Whether the bounds of what enters are widened.
    widening: bool,
    pub(crate) tolerance: f64,
    /// Iterations after which a run gives up.
    pub(crate) most: u64,
}

impl<'a> Engine<'a> {
    /// A basis given by status; resting places must be finite where bounds are.
    pub(crate) fn new(program: &'a Program, status: Vec<Status>) -> Engine<'a> {
        let mut cost = program.cost.clone();
        cost.resize(program.n + program.m, 0.0);
        let mut engine = Engine {
            program,
            cost,
            lower: program.lower.clone(),
            upper: program.upper.clone(),
            status,
            head: Vec::new(),
            x: vec![0.0; program.n + program.m],
            d: vec![0.0; program.n + program.m],
            lu: None,
            etas: Vec::new(),
            work: Vec::new(),
            iterations: 0,
            random: 0x1234_5678_9abc_def1,
            blame: None,
            widening: false,
            tolerance: TOLERANCES[0],
            most: u64::MAX,
        };
        engine.collect_head();
        engine
    }

    /// The basis of logicals.
    pub(crate) fn slack(program: &'a Program) -> Engine<'a> {
        let mut status: Vec<Status> = (0..program.n)
            .map(|j| rest(program.lower[j], program.upper[j]))
            .collect();
        status.resize(program.n + program.m, Status::Basic);
        Engine::new(program, status)
    }

    /// A number in [0, 1), always the same sequence.
    pub(crate) fn next_random(&mut self) -> f64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1u64 << 53) as f64
    }

    fn collect_head(&mut self) {
        let m = self.program.m;
        self.head = (0..self.status.len())
            .filter(|&v| self.status[v] == Status::Basic)
            .collect();
        // A basis of the wrong size is completed or cut; factorising repairs the rest.
        let mut i = 0;
        while self.head.len() < m && i < m {
            let v = self.program.n + i;
            if self.status[v] != Status::Basic {
                self.status[v] = Status::Basic;
                self.head.push(v);
            }
            i += 1;
        }
        while self.head.len() > m {
            if let Some(v) = self.head.pop() {
                self.status[v] = rest(self.lower[v], self.upper[v]);
            }
        }
    }

    /// Factorises the basis anew, repairing it with logicals where it seems singular.
    pub(crate) fn refactor(&mut self) {
        self.etas.clear();
        loop {
            let columns: Vec<Vec<(u32, f64)>> = self
                .head
                .iter()
                .map(|&v| {
                    let mut c = Vec::new();
                    self.program.each(v, |i, a| c.push((i as u32, a)));
                    c
                })
                .collect();
            match factorise(&Double, &columns, 0.1, 1e-11) {
                Ok(lu) => {
                    self.lu = Some(lu);
                    return;
                }
                Err(left) => {
                    for (&k, &i) in left.columns.iter().zip(&left.rows) {
                        let v = self.head[k as usize];
                        self.status[v] = rest(self.lower[v], self.upper[v]);
                        let logical = self.program.n + i as usize;
                        self.head[k as usize] = logical;
                        self.status[logical] = Status::Basic;
                    }
                }
            }
        }
    }

    /// Rows to positions: B⁻¹b.
    pub(crate) fn ftran(&mut self, b: &mut [f64]) {
        let Some(lu) = &self.lu else { return };
        lu.solve(b, &mut self.work);
        for eta in &self.etas {
            let t = b[eta.position];
            if t != 0.0 {
                let t = t / eta.pivot;
                b[eta.position] = t;
                for &(i, a) in &eta.entries {
                    b[i as usize] -= a * t;
                }
            }
        }
    }

    /// Positions to rows: B⁻ᵀd.
    pub(crate) fn btran(&mut self, d: &mut [f64]) {
        for eta in self.etas.iter().rev() {
            let mut s = d[eta.position];
            for &(i, a) in &eta.entries {
                s -= a * d[i as usize];
            }
            d[eta.position] = s / eta.pivot;
        }
        if let Some(lu) = &self.lu {
            lu.solve_transposed(d, &mut self.work);
        }
    }

    /// Values of everything from the resting places.
    ///
    /// One step of refinement makes them as accurate as doubles can show them.
    pub(crate) fn compute_values(&mut self) {
        let p = self.program;
        let mut b = vec![0.0; p.m];
        for v in 0..p.n + p.m {
            if self.status[v] == Status::Basic {
                continue;
            }
            let value = match self.status[v] {
                Status::Lower => self.lower[v],
                Status::Upper => self.upper[v],
                _ => 0.0,
            };
            self.x[v] = value;
            if value != 0.0 {
                p.each(v, |i, a| b[i] -= a * value);
            }
        }
        let mut residual = b.clone();
        self.ftran(&mut b);
        for (k, &v) in self.head.iter().enumerate() {
            self.x[v] = b[k];
            p.each(v, |i, a| residual[i] -= a * b[k]);
        }
        self.ftran(&mut residual);
        for (k, &v) in self.head.iter().enumerate() {
            self.x[v] += residual[k];
        }
    }

    /// Reduced costs of everything from the working costs.
    pub(crate) fn compute_reduced(&mut self) {
        let p = self.program;
        let mut y: Vec<f64> = self.head.iter().map(|&v| self.cost[v]).collect();
        self.btran(&mut y);
        for v in 0..p.n {
            let mut s = self.cost[v];
            for (i, a) in p.columns.line(v) {
                s -= a * y[i];
            }
            self.d[v] = s;
        }
        for (i, &y) in y.iter().enumerate() {
            self.d[p.n + i] = self.cost[p.n + i] + y;
        }
        for &v in &self.head {
            self.d[v] = 0.0;
        }
    }

    /// The column of a variable through the inverse, by positions.
    pub(crate) fn column(&mut self, v: usize) -> Vec<f64> {
        let mut b = vec![0.0; self.program.m];
        self.program.each(v, |i, a| b[i] = a);
        self.ftran(&mut b);
        b
    }

    /// Row `r` of the inverse.
    pub(crate) fn inverse_row(&mut self, r: usize) -> Vec<f64> {
        let mut e = vec![0.0; self.program.m];
        e[r] = 1.0;
        self.btran(&mut e);
        e
    }

    /// ρ·a for every variable that has a non-zero one, into `alpha`; their list in `touched`.
    pub(crate) fn pivot_row(&self, rho: &[f64], alpha: &mut [f64], touched: &mut Vec<u32>) {
        let p = self.program;
        for &v in touched.iter() {
            alpha[v as usize] = 0.0;
        }
        touched.clear();
        for (i, &r) in rho.iter().enumerate() {
            if r.abs() < 1e-14 {
                continue;
            }
            for (j, a) in p.rows.line(i) {
                if alpha[j] == 0.0 {
                    touched.push(j as u32);
                }
                alpha[j] += r * a;
                if alpha[j] == 0.0 {
                    alpha[j] = 1e-300; // cancelled, but listed already
                }
            }
            alpha[p.n + i] = -r;
            touched.push((p.n + i) as u32);
        }
    }

    /// Exchanges the basic variable at a position; `column` is that of the entering one.
    pub(crate) fn exchange(&mut self, position: usize, entering: usize, column: &[f64]) {
        self.head[position] = entering;
        self.status[entering] = Status::Basic;
        if self.widening {
            self.widen(entering);
        }
        let entries = column
            .iter()
            .enumerate()
            .filter(|&(i, a)| i != position && a.abs() > 1e-14)
            .map(|(i, &a)| (i as u32, a))
            .collect();
        self.etas.push(Eta {
            position,
            pivot: column[position],
            entries,
        });
        self.iterations += 1;
    }

    /// Whether it is time for new factors.
    pub(crate) fn stale(&self) -> bool {
        self.etas.len() >= REFRESH
    }

    pub(crate) fn fresh(&self) -> bool {
        self.etas.is_empty()
    }

    /// Sum of primal infeasibilities beyond the tolerance.
    pub(crate) fn infeasibility(&self) -> f64 {
        let each = self.head.iter().map(|&v| self.excess(v).abs());
        each.filter(|e| *e > self.tolerance).sum()
    }

    /// The objective at the current values.
    pub(crate) fn objective(&self) -> f64 {
        let pairs = self.program.cost.iter().zip(&self.x);
        pairs.map(|(c, x)| c * x).sum()
    }

    /// Prices of the rows for the program's own costs.
    pub(crate) fn prices(&mut self) -> Vec<f64> {
        let costs = &self.program.cost;
        let cost = |&v: &usize| costs.get(v).copied().unwrap_or(0.0);
        let mut y: Vec<f64> = self.head.iter().map(cost).collect();
        self.btran(&mut y);
        y
    }

    /// How far a basic variable is outside: negative below, positive above.
    pub(crate) fn excess(&self, v: usize) -> f64 {
        let x = self.x[v];
        if x < self.lower[v] {
            x - self.lower[v]
        } else if x > self.upper[v] {
            x - self.upper[v]
        } else {
            0.0
        }
    }

    /// Whether a resting variable would improve, beyond the tolerance.
    pub(crate) fn attractive(&self, v: usize) -> bool {
        if self.lower[v] == self.upper[v] {
            return false;
        }
        match self.status[v] {
            Status::Basic => false,
            Status::Lower => self.d[v] < -self.tolerance,
            Status::Upper => self.d[v] > self.tolerance,
            Status::Zero => self.d[v].abs() > self.tolerance,
        }
    }

    /// Whether the basis is feasible and optimal but for a few reduced costs: exact arithmetic
    /// needs fewer pivots from here than floating point needs iterations from anywhere else.
    pub(crate) fn nearly_optimal(&mut self) -> bool {
        self.restore();
        let attractive = (0..self.status.len()).filter(|&v| self.attractive(v));
        self.infeasibility() == 0.0 && attractive.count() <= FEW
    }

    /// The program's own costs and bounds, and everything that follows from the basis.
    fn restore(&mut self) {
        self.widening = false;
        self.cost.clear();
        self.cost.extend_from_slice(&self.program.cost);
        self.cost.resize(self.program.n + self.program.m, 0.0);
        self.lower.copy_from_slice(&self.program.lower);
        self.upper.copy_from_slice(&self.program.upper);
        self.refactor();
        self.compute_values();
        self.compute_reduced();
    }

    /// Widens the bounds of the basic variables by random amounts, against stalling, and from now
    /// on those of every variable that enters. The others stay where they are, so that the values
    /// keep.
    pub(crate) fn perturb_bounds(&mut self) {
        self.widening = true;
        for k in 0..self.head.len() {
            self.widen(self.head[k]);
        }
    }

    fn widen(&mut self, v: usize) {
        let p = self.program;
        let moved = self.lower[v] != p.lower[v] || self.upper[v] != p.upper[v];
        if moved || p.lower[v] == p.upper[v] {
            return;
        }
        let (a, b) = (self.next_random(), self.next_random());
        self.lower[v] -= (0.5 + 0.5 * a) * WIDTH * (1.0 + self.lower[v].abs());
        self.upper[v] += (0.5 + 0.5 * b) * WIDTH * (1.0 + self.upper[v].abs());
    }

    /// Dual and primal in turn until both agree that the basis is optimal, or give up.
    /// `cold` perturbs the costs in the dual method.
    pub(crate) fn optimise(&mut self, cold: bool, budget: &Budget) -> Result<Ending, Exhausted> {
        self.tolerance = TOLERANCES[0];
        let ending = self.rounds(cold, 10, budget)?;
        if ending != Ending::Optimal {
            return Ok(ending);
        }
        // The finish may lose itself in noise: then the basis stays as it was.
        let most = self.most;
        for tolerance in &TOLERANCES[1..] {
            let before = (self.status.clone(), self.head.clone());
            self.tolerance = *tolerance;
            self.most = self.iterations + 100 + self.program.m as u64 / 20;
            if self.rounds(false, 2, budget)? == Ending::Stuck {
                (self.status, self.head) = before;
                self.restore();
            }
        }
        self.most = most;
        Ok(ending)
    }

    fn rounds(&mut self, cold: bool, most: u32, budget: &Budget) -> Result<Ending, Exhausted> {
        for round in 0..most {
            self.restore();
            if self.infeasibility() > 0.0 {
                match self.dual(budget, cold && round < 4 || round % 2 == 1)? {
                    Ending::Optimal => {}
                    other => return Ok(other),
                }
                self.restore();
            }
            if self.infeasibility() < 1e-4 && (0..self.status.len()).any(|v| self.attractive(v)) {
                match self.primal(budget)? {
                    Ending::Optimal => {}
                    other => return Ok(other),
                }
                self.restore();
            }
            let settled = !(0..self.status.len()).any(|v| self.attractive(v));
            if settled && self.infeasibility() == 0.0 {
                return Ok(Ending::Optimal);
            }
        }
        Ok(Ending::Stuck)
    }
}

/// A resting place in doubles.
pub(crate) fn rest(lower: f64, upper: f64) -> Status {
    match (lower > f64::NEG_INFINITY, upper < f64::INFINITY) {
        (true, true) if upper.abs() < lower.abs() => Status::Upper,
        (true, _) => Status::Lower,
        (false, true) => Status::Upper,
        (false, false) => Status::Zero,
    }
}
