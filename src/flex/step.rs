//! Time stepping (PF §V-B): solve, move as far as the violation allows, build anew, solve again.
//!
//! At a configuration q the program's optimum q̇ is a direction. The step is the largest scale
//! s ≤ 1 found by bisection for which the exact distances at the new configuration are violated by
//! no more than the threshold; the next program enforces the constraints again, so errors do not
//! add up. Stepping ends where a step gains less than asked.
//!
//! Gradients are taken at stations near the bodies (`station`).
//!
//! *Rounding.* A rotation by sδ is applied as the rational rotation of half-tangent sδ/2 (which
//! agrees with it up to the third order), then tan(θ/2) is replaced by the simplest fraction near
//! it and positions by multiples of a power of two. The radius of rounding is a small part of the
//! threshold, so digits never pile up, and whatever rounding does to the constraints is seen by
//! the same exact test, since it judges the rounded configuration.

use super::bend::Bend;
use super::branch::Solved;
use super::fit::{Fitted, finite};
use super::grain::Grain;
use super::model::{Row, Scaffold};
use super::outcome::{Flexed, Violation};
use super::pairs::{Pair, Selection, select};
use super::settle::Tight;
use super::shape::{Placed, Pose, double};
use super::station::{Rounding, Stations};
use super::types::{Path, Structure};
use crate::lp::{self, Place, Places, Status};
use crate::number::Rat;
use std::cell::RefCell;
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// What facing convex corners become (PF §V-A).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Corners {
    /// One half-plane, its normal averaged from the two edges of a corner.
    #[default]
    Average,
    /// The exact disjunction: one of the four edges, found by branching.
    Branch,
}

/// What a caller may choose.
#[derive(Clone, Copy, Default)]
pub struct FlexOptions<'a> {
    /// How much is proven of every linear program.
    pub accuracy: lp::Accuracy,
    /// Who finds its basis.
    pub method: lp::Method,
    /// What becomes of facing corners.
    pub corners: Corners,
    /// Time after which stepping ends undecided.
    pub time_limit: Option<Duration>,
    /// Whether certificates are checked by the independent verifier.
    pub verify: bool,
    /// Whether the exact first contact is looked for, up to which the path is free of collision.
    pub contact: bool,
    /// Shown every program before it is solved.
    pub programs: Option<&'a dyn Fn(&lp::Model)>,
    /// Told of every step as it begins.
    pub progress: Option<&'a dyn Fn(FlexProgress)>,
}

/// Where a run is.
#[derive(Clone, Copy, Debug)]
pub struct FlexProgress {
    /// Steps done.
    pub step: usize,
    /// Bodies of the structure.
    pub bodies: usize,
    /// Rows of the program at hand.
    pub rows: usize,
    /// Displacement so far.
    pub displacement: f64,
    /// What the last step gained.
    pub gain: f64,
}

/// A run in the making.
pub(crate) struct Run<'a> {
    pub(crate) structure: &'a Structure,
    pub(crate) scaffold: Scaffold,
    pub(crate) stations: Stations,
    pub(crate) options: &'a FlexOptions<'a>,
    pub(crate) deadline: Option<Instant>,
    /// No vertex is farther from its body's reference point.
    reach: f64,
    /// What distances and poses are rounded by: a part of the gain asked for, since what rounding
    /// takes from bodies in a row adds up.
    fine: f64,
    /// On a safe path: how far a body may turn in a step, where that was found to help.
    pub(crate) trust: Option<f64>,
    /// The last optimal basis: places of the columns, and of rows by pair.
    memory: RefCell<Option<Memory>>,
}

type Memory = (Vec<Place>, HashMap<Pair, Place>);

/// The grain of distances: this part of the gain at which stepping ends, over the bodies.
const FINE: f64 = 0.25;
/// Of what a program promises, the part of a direction followed must gain this much at least.
pub(crate) const KEEPS: f64 = 0.1;
/// Bisections of a step's scale.
const HALVINGS: usize = 8;

/// Flexes a structure: PF's procedure from its first configuration to convergence.
///
/// Cost: a linear program a step; building it is near-linear in the bodies.
pub fn flex(structure: &Structure, options: &FlexOptions<'_>) -> Flexed {
    match Fitted::of(structure) {
        Some(fit) => fit.back(Run::new(&fit.structure, options).flex()),
        None => Run::new(structure, options).flex(),
    }
}

impl<'a> Run<'a> {
    pub(crate) fn new(structure: &'a Structure, options: &'a FlexOptions<'a>) -> Run<'a> {
        let scaffold = Scaffold::new(structure);
        let reach = scaffold.shapes.iter().map(|s| s.reach).fold(0.0, f64::max);
        let fine = double(&structure.step.gain) * FINE / structure.bodies.len().max(1) as f64;
        // Whatever gain is asked for, rounding stays a small part of the violation allowed, and
        // within what doubles hold.
        let most = double(&structure.step.violation) / 8.0;
        let fine = fine.min(most).clamp(1e-60, 1e60);
        Run {
            structure,
            stations: Stations::new(&scaffold, reach, fine),
            reach,
            fine,
            scaffold,
            options,
            trust: None,
            memory: RefCell::new(None),
            deadline: options
                .time_limit
                .and_then(|t| Instant::now().checked_add(t)),
        }
    }

    pub(crate) fn late(&self) -> bool {
        self.deadline.is_some_and(|d| Instant::now() >= d)
    }

    /// What the program of these rows may still take, and the last basis as its start.
    pub(crate) fn lp_options(&self, rows: &[Row]) -> lp::Options {
        let memory = self.memory.borrow();
        let basis = memory.as_ref().map(|(columns, places)| Places {
            columns: columns.clone(),
            // A row that is new is slack until shown otherwise.
            rows: rows
                .iter()
                .map(|r| places.get(&r.pair).copied().unwrap_or(Place::Basic))
                .collect(),
        });
        lp::Options {
            method: self.options.method,
            accuracy: self.options.accuracy,
            time_limit: self
                .deadline
                .map(|d| d.saturating_duration_since(Instant::now())),
            basis,
            values: rows.iter().any(Row::is_long),
            ..lp::Options::default()
        }
    }

    /// Builds and solves the program of some rows.
    pub(crate) fn program(&self, rows: &[Row], poses: &[Pose]) -> (lp::Model, lp::Outcome) {
        let model = self.scaffold.program(rows, poses, &self.stations.poses);
        if let Some(show) = self.options.programs {
            show(&model);
        }
        let outcome = lp::solve(&model, &self.lp_options(rows));
        self.remember(rows, &outcome);
        (model, outcome)
    }

    /// Keeps an optimal basis for the next program, by the names of the rows.
    fn remember(&self, rows: &[Row], outcome: &lp::Outcome) {
        if let (Status::Optimal, Some(basis)) = (outcome.status, &outcome.basis) {
            let places = rows.iter().map(|r| r.pair).zip(basis.rows.iter().copied());
            *self.memory.borrow_mut() = Some((basis.columns.clone(), places.collect()));
        }
    }

    /// The grain that poses are rounded to: finer than that of distances, so that rounding alone
    /// does not move a distance off its multiple.
    pub(crate) fn grain(&self) -> Grain {
        Grain::of(self.fine / 16.0, self.reach)
    }

    /// The pairs of a configuration. At the start nothing overlaps; later on a vertex may lie
    /// inside an edge by the violation that was allowed, on a fast path; but what lies deeper than
    /// epsilon is not near.
    pub(crate) fn selection(&self, placed: &[Placed], moved: bool) -> Selection {
        let slack = if moved && self.structure.step.path == Path::Fast {
            let twice = &self.structure.step.violation * &Rat::from(2);
            twice.min(self.structure.epsilon.clone())
        } else {
            Rat::zero()
        };
        select(&self.scaffold, placed, &slack)
    }

    /// All rows that hold together: the pairs and, where corners are averaged, theirs.
    pub(crate) fn rows(&self, selection: &Selection, placed: &[Placed]) -> (Vec<Pair>, Vec<Row>) {
        let mut pairs = selection.pairs.clone();
        if self.options.corners == Corners::Average {
            pairs.extend(self.scaffold.averaged(&selection.facing));
        }
        let rows = pairs.iter().map(|p| self.row(p, placed)).collect();
        (pairs, rows)
    }

    /// The row of a pair in a step's program.
    pub(crate) fn row(&self, pair: &Pair, placed: &[Placed]) -> Row {
        let rounding = match self.structure.step.path {
            Path::Fast => Rounding::Nearest,
            Path::Safe => Rounding::Down,
        };
        self.stations.row(&self.scaffold, pair, placed, rounding)
    }

    /// Whether bodies are joined; the robots of a flock are not, and go straight.
    fn joined(&self) -> bool {
        self.scaffold.nearest.is_none() && self.scaffold.views.is_empty()
    }

    /// How directions are followed from a configuration.
    fn bend(&self, pairs: &[Pair], poses: &[Pose]) -> Bend {
        let joined = self.joined();
        let links = pairs
            .iter()
            .filter(|_| joined)
            .map(|p| (p.line_body as usize, p.point_body as usize));
        Bend::new(&self.scaffold.forms, poses, links)
    }

    /// The longest scale up to 1 that bisection finds to keep the violation allowed, and the
    /// configuration there.
    pub(super) fn search(
        &self,
        rows: &[Row],
        poses: &[Pose],
        direction: &[[f64; 3]],
        solved: &Solved,
    ) -> (Rat, Vec<Pose>) {
        let allowed = &self.structure.step.violation;
        let grain = self.grain();
        let forms = &self.scaffold.forms;
        let promise = double(&solved.objective);
        let pairs: Vec<Pair> = rows.iter().map(|r| r.pair).collect();
        let bend = self.bend(&pairs, poses);
        let tight = self.tight(&pairs, poses, solved);
        // What the tight rows are at, of which a part of a step leaves the rest.
        let now: Vec<f64> = tight
            .iter()
            .flat_map(|t| &t.rows)
            .map(|&k| length(&rows[k]))
            .collect();
        let plain = |scale: f64| grain.moved(poses, forms, &bend.follow(direction, scale), 1.0);
        let close = self.fine / 64.0;
        let settled = |scale: f64| {
            let targets: Vec<f64> = now.iter().map(|d| d * (1.0 - scale)).collect();
            let bent = bend.follow(direction, scale);
            let there = tight.as_ref()?.settle(&bent, &targets, close)?;
            Some(grain.moved(poses, forms, &there, 1.0))
        };
        let before = self.scaffold.displacement(poses);
        // A step that is to restore constraints may lose; one that is to gain must gain.
        let least = |scale: f64| (promise > 0.0).then(|| finite(KEEPS * promise * scale));
        let good = |poses: &[Pose], scale: f64| {
            if let Some(least) = least(scale)
                && self.scaffold.displacement(poses) - &before < least
            {
                return false;
            }
            let placed = self.scaffold.place(poses);
            !self.exceeds(&pairs, &placed, allowed)
                && !super::pairs::too_deep(&self.scaffold, &placed, double(allowed))
        };
        let at = |scale: f64| {
            let there = settled(scale).filter(|there| good(there, scale));
            there.or_else(|| Some(plain(scale)).filter(|there| good(there, scale)))
        };
        if let Some(whole) = at(1.0) {
            return (Rat::one(), whole);
        }
        let (mut low, mut high) = (0.0f64, 1.0f64);
        let mut best = poses.to_vec();
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            match at(middle) {
                Some(there) => (low, best) = (middle, there),
                None => high = middle,
            }
        }
        (Rat::from_f64(low), best)
    }

    /// The rows that the optimum of a program stands on.
    pub(crate) fn tight(&self, pairs: &[Pair], poses: &[Pose], solved: &Solved) -> Option<Tight> {
        let basis = solved.basis.as_ref().filter(|_| self.joined())?;
        Tight::new(&self.scaffold, pairs, basis, poses, self.reach)
    }

    /// Whether a pair is violated by more than a distance, exactly.
    pub(crate) fn exceeds(&self, pairs: &[Pair], placed: &[Placed], allowed: &Rat) -> bool {
        let near = double(allowed);
        pairs.iter().any(|pair| {
            let (d, error) = self.scaffold.near(pair, placed);
            let error = error + near * 1e-15;
            if d + error < -near {
                return true;
            }
            if d - error > -near {
                return false;
            }
            let row = self.scaffold.row(pair, placed);
            row.d0.sign() < 0 && violation(&row) > allowed.square()
        })
    }

    /// The largest violation, exactly.
    pub(crate) fn worst(&self, pairs: &[Pair], placed: &[Placed]) -> Violation {
        let near: Vec<(f64, f64)> = pairs
            .iter()
            .map(|p| self.scaffold.near(p, placed))
            .collect();
        let bound = near.iter().map(|(d, e)| d + e).fold(0.0, f64::min);
        let mut out = Violation {
            square: Rat::zero(),
            pair: None,
        };
        for (pair, (d, e)) in pairs.iter().zip(&near) {
            if d - e > bound {
                continue;
            }
            let row = self.scaffold.row(pair, placed);
            if row.d0.sign() < 0 {
                let square = violation(&row);
                if square > out.square {
                    out = Violation {
                        square,
                        pair: Some(*pair),
                    };
                }
            }
        }
        out
    }
}

/// The distance of a row in doubles.
fn length(row: &Row) -> f64 {
    double(&violation(row)).sqrt() * f64::from(row.d0.sign())
}

/// d² of a row: d₀² over the squared length of its normal.
pub(crate) fn violation(row: &Row) -> Rat {
    let [x, y] = &row.normal;
    Rat::new(&row.d0 * &row.d0, x * x + y * y)
}
