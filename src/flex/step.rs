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
use super::branch::{self, Solved};
use super::grain::Grain;
use super::limits::Limits;
use super::model::{Row, Scaffold};
use super::motion::{Contact, Motion, ProofSize};
use super::pairs::{Pair, Selection, select};
use super::settle::Tight;
use super::shape::{Placed, Pose, double};
use super::station::{Rounding, Stations};
use super::types::{Path, Structure};
use crate::lp::{self, Place, Places, Status};
use crate::number::{Algebraic, Int, Poly, Rat};
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

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// A step gained less than asked.
    Converged,
    /// The number of steps was reached.
    MostSteps,
    /// The linear program is unbounded: something comes apart.
    Unbounded,
    /// No motion restores the constraints.
    Infeasible,
    /// The time was over.
    Undecided,
}

impl Ending {
    /// The word used in results.
    pub fn word(self) -> &'static str {
        match self {
            Ending::Converged => "converged",
            Ending::MostSteps => "most-steps",
            Ending::Unbounded => "unbounded",
            Ending::Infeasible => "infeasible",
            Ending::Undecided => "undecided",
        }
    }
}

/// One step.
#[derive(Clone, Debug)]
pub struct Step {
    /// The exact optimum of the linear program (for floats and bounds: the best value known).
    pub objective: Rat,
    /// A proven enclosure of the optimum.
    pub enclosure: (Option<Rat>, Option<Rat>),
    /// The scale at which its direction was applied.
    pub scale: Rat,
    /// Rows of the program.
    pub rows: usize,
    /// Facing corners.
    pub facing: usize,
    /// Programs solved for this step.
    pub programs: usize,
    /// Pivots of the exact method, over these programs' last.
    pub exact_pivots: u64,
    /// Wall-clock time of the step: model, program, search.
    pub seconds: f64,
    /// Part of it that went into pairs and rows.
    pub model_seconds: f64,
    /// Whether the certificate passed the verifier; None where it was not asked.
    pub verified: Option<bool>,
    /// The certificate as JSON; null where there is none.
    pub certificate: serde_json::Value,
    /// What the proof of a safe step looked at; None where nothing was proven.
    pub proof: Option<ProofSize>,
    /// Where asked for, the first contact of the whole path, if it comes in this step.
    pub contact: Option<Contact>,
    /// Exact gain in displacement.
    pub gain: Rat,
    /// Bits of the longest number of any pose afterwards.
    pub bits: u64,
}

/// The result of a run.
#[derive(Clone, Debug)]
pub struct Flexed {
    /// How it ended.
    pub ending: Ending,
    /// The steps, in order.
    pub steps: Vec<Step>,
    /// The configurations: the start, then one after each step.
    pub configurations: Vec<Vec<Pose>>,
    /// The weighted displacement, exact.
    pub displacement: Rat,
    /// The largest violation at the end (a distance), zero if there is none.
    pub violation: Violation,
    /// Columns of the programs.
    pub columns: usize,
}

/// A distance whose square is rational.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Its square.
    pub square: Rat,
    /// The constraint, where one is violated.
    pub pair: Option<Pair>,
}

impl Violation {
    /// The distance itself.
    pub fn value(&self) -> Algebraic {
        let s = &self.square;
        if let (Some(n), Some(d)) = (s.numer().sqrt_exact(), s.denom().sqrt_exact()) {
            return Algebraic::from(Rat::new(n, d));
        }
        let p = Poly::new(vec![-s.numer(), Int::zero(), s.denom().clone()]);
        let roots = p.real_roots();
        let largest = roots.into_iter().next_back();
        largest.unwrap_or_else(|| Algebraic::from(Rat::zero()))
    }
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
    /// The last optimal basis: places of the columns, and of rows by pair.
    memory: RefCell<Option<Memory>>,
}

type Memory = (Vec<Place>, HashMap<Pair, Place>);

/// What a step took.
struct Taken {
    model_seconds: f64,
    rows: usize,
    pairs: Vec<Pair>,
    solved: Solved,
    programs: usize,
    scale: Rat,
    next: Option<Vec<Pose>>,
    proof: Option<ProofSize>,
    /// What a safe step's program promised; zero for a fast one.
    promise: f64,
}

/// The grain of distances: this part of the gain at which stepping ends, over the bodies.
const FINE: f64 = 0.25;
/// Of what a program promises, the part of a direction followed must gain this much at least.
const KEEPS: f64 = 0.1;
/// A restoration that takes less than this part of the displacement is little.
const LITTLE: f64 = 1e-3;
/// Bisections of a step's scale.
const HALVINGS: usize = 8;

/// Flexes a structure: PF's procedure from its first configuration to convergence.
///
/// Cost: a linear program a step; building it is near-linear in the bodies.
pub fn flex(structure: &Structure, options: &FlexOptions<'_>) -> Flexed {
    Run::new(structure, options).flex()
}

impl<'a> Run<'a> {
    pub(crate) fn new(structure: &'a Structure, options: &'a FlexOptions<'a>) -> Run<'a> {
        let scaffold = Scaffold::new(structure);
        let reach = scaffold.shapes.iter().map(|s| s.reach).fold(0.0, f64::max);
        let fine = double(&structure.step.gain) * FINE / structure.bodies.len().max(1) as f64;
        Run {
            structure,
            stations: Stations::new(&scaffold, reach, fine),
            reach,
            fine,
            scaffold,
            options,
            memory: RefCell::new(None),
            deadline: options
                .time_limit
                .and_then(|t| Instant::now().checked_add(t)),
        }
    }

    fn late(&self) -> bool {
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

    fn flex(mut self) -> Flexed {
        let rules = &self.structure.step;
        let mut poses = self.scaffold.start.clone();
        let mut out = Flexed {
            ending: Ending::MostSteps,
            steps: Vec::new(),
            configurations: vec![poses.clone()],
            displacement: Rat::zero(),
            violation: Violation {
                square: Rat::zero(),
                pair: None,
            },
            columns: self.scaffold.column_count,
        };
        let mut last_gain = 0.0;
        // Whether no contact came yet.
        let mut clear = true;
        let mut pairs = Vec::new();
        let mut limits = Limits::default();
        for k in 0..rules.most {
            if self.late() {
                out.ending = Ending::Undecided;
                break;
            }
            let begin = Instant::now();
            let placed = self.scaffold.place(&poses);
            self.stations.follow(&self.scaffold, &poses, &placed);
            self.scaffold.turn_limits = limits.bounds();
            let taken = if rules.path == Path::Safe {
                self.tell(k, &out, last_gain, out.steps.last().map_or(0, |s| s.rows));
                let safe = self.safe_step(&poses, &placed, k > 0);
                Taken {
                    model_seconds: 0.0,
                    rows: safe.rows.len(),
                    pairs: safe.rows.iter().map(|r| r.pair).collect(),
                    solved: safe.solved,
                    programs: safe.programs,
                    scale: safe.scale,
                    next: safe.next,
                    proof: safe.proof,
                    promise: safe.promise,
                }
            } else {
                let selection = self.selection(&placed, k > 0);
                let (pairs, rows) = self.rows(&selection, &placed);
                let model_seconds = begin.elapsed().as_secs_f64();
                self.tell(k, &out, last_gain, rows.len());
                let solved = branch::solve(&self, &rows, &selection, &placed, &poses);
                let next = solved
                    .direction
                    .as_ref()
                    .map(|direction| self.search(&rows, &poses, direction, &solved));
                let (scale, next) = next.unzip();
                Taken {
                    model_seconds,
                    rows: rows.len(),
                    pairs,
                    programs: solved.programs,
                    solved,
                    scale: scale.unwrap_or_else(Rat::zero),
                    next,
                    proof: None,
                    promise: 0.0,
                }
            };
            pairs.clone_from(&taken.pairs);
            if limits.active() && taken.solved.status == Status::Infeasible {
                // What is to be restored takes more than the limits allow.
                limits.lift();
                continue;
            }
            let stopped = taken.next.is_none();
            if stopped {
                out.ending = match taken.solved.status {
                    Status::Unbounded => Ending::Unbounded,
                    Status::Infeasible => Ending::Infeasible,
                    _ => Ending::Undecided,
                };
            }
            let next = taken.next.unwrap_or_else(|| poses.clone());
            let reached = self.scaffold.displacement(&next);
            let gain = &reached - &out.displacement;
            if rules.path == Path::Safe && !stopped && gain.sign() < 0 {
                // Nothing is violated on a safe path, so nothing calls for a step back: it comes
                // from what is held back, and there is nothing more to gain.
                out.ending = self.settled(taken.promise);
                break;
            }
            let contact = if clear && self.options.contact && taken.proof.is_none() {
                Motion::new(&self.scaffold, &poses, &next).first_contact()
            } else {
                None
            };
            clear &= contact.is_none();
            let limited = limits.active();
            if rules.path == Path::Fast && !stopped {
                let angle = |p: &Pose| 2.0 * double(&p.tan_half).atan();
                let each = poses.iter().zip(&next);
                let turned: Vec<f64> = each.map(|(a, b)| angle(b) - angle(a)).collect();
                let promise = double(&taken.solved.objective);
                limits.learn(&turned, double(&taken.scale), promise, double(&gain));
            }
            if !stopped {
                poses = next;
                out.configurations.push(poses.clone());
            }
            out.displacement = reached;
            out.steps.push(Step {
                objective: taken.solved.objective,
                enclosure: taken.solved.enclosure,
                scale: taken.scale,
                rows: taken.rows,
                facing: taken.solved.facing,
                programs: taken.programs,
                exact_pivots: taken.solved.exact_pivots,
                seconds: begin.elapsed().as_secs_f64(),
                model_seconds: taken.model_seconds,
                verified: taken.solved.verified,
                certificate: taken.solved.certificate,
                proof: taken.proof,
                contact,
                gain: gain.clone(),
                bits: poses.iter().map(Pose::bits).max().unwrap_or(0),
            });
            if stopped {
                break;
            }
            // A step that loses has restored constraints that the ones before overreached. If
            // that was little, what the next would gain it would overreach again, over and over,
            // and so it is if what was overreached and restored came to nothing.
            let both = &gain + &Rat::from_f64(last_gain);
            let little = -&gain < &out.displacement.abs() * &Rat::from_f64(LITTLE);
            last_gain = double(&gain);
            if gain < rules.gain && (-&gain < rules.gain || little || both < rules.gain) {
                if limited {
                    limits.lift();
                    continue;
                }
                // A direction that cannot be followed at all shows nothing.
                let stuck = out.steps.last().filter(|s| s.scale.is_zero());
                let promise = stuck.map_or(taken.promise, |s| double(&s.objective));
                out.ending = self.settled(promise);
                break;
            }
        }
        let placed = self.scaffold.place(&poses);
        if pairs.is_empty() {
            pairs = self.selection(&placed, true).pairs;
        }
        out.violation = self.worst(&pairs, &placed);
        out
    }

    /// How a run ends that gains no more: converged, unless its program promised a step
    /// much more than what could be proven.
    fn settled(&self, promise: f64) -> Ending {
        if promise > 10.0 * double(&self.structure.step.gain) {
            Ending::Undecided
        } else {
            Ending::Converged
        }
    }

    fn tell(&self, step: usize, out: &Flexed, gain: f64, rows: usize) {
        if let Some(tell) = self.options.progress {
            tell(FlexProgress {
                step,
                bodies: self.scaffold.forms.len(),
                rows,
                displacement: double(&out.displacement),
                gain,
            });
        }
    }

    /// The grain that poses are rounded to: finer than that of distances, so that rounding alone
    /// does not move a distance off its multiple.
    pub(crate) fn grain(&self) -> Grain {
        Grain::of(self.fine / 16.0, self.reach)
    }

    /// The pairs of a configuration. At the start nothing overlaps; later on a vertex may lie
    /// inside an edge by the violation that was allowed.
    pub(crate) fn selection(&self, placed: &[Placed], moved: bool) -> Selection {
        let slack = if moved {
            &self.structure.step.violation * &Rat::from(2)
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
    fn search(
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
        let least = |scale: f64| (promise > 0.0).then(|| Rat::from_f64(KEEPS * promise * scale));
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
