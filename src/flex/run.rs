//! The loop of steps: when a run goes on, and when and why it ends.
//!
//! A run ends where a step gains less than asked. Two more cases end it, lest it go on for ever.
//! A step that loses restores constraints that the ones before overreached; what the next gains
//! it overreaches again. So after a little restoration one more program is solved: if it promises
//! next to nothing, that is the end, confirmed; if not, it is not followed, and its exact optimum
//! says what was left. And a promise of which no part can be followed, or proven on a safe path, ends
//! the run too: converged if it is little beside what was reached, undecided if not.

use super::branch::{self, Solved};
use super::fit::finite;
use super::limits::Limits;
use super::motion::{Motion, ProofSize};
use super::outcome::{Ending, Flexed, Step, Violation, Why};
use super::pairs::Pair;
use super::shape::{Pose, double};
use super::step::{FlexProgress, Run};
use super::types::Path;
use crate::lp::Status;
use crate::number::Rat;
use std::time::Instant;

/// A restoration that takes less than this part of the displacement is little; so is a promise that
/// cannot be kept.
const LITTLE: f64 = 1e-3;
/// After how many little restorations one more program is solved, to tell what is left to gain.
const CONFIRMATIONS: usize = 3;

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

impl Run<'_> {
    pub(super) fn flex(mut self) -> Flexed {
        let rules = &self.structure.step;
        let mut poses = self.scaffold.start.clone();
        let mut out = Flexed {
            ending: Ending::MostSteps,
            why: Why::Steps(rules.most),
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
        // What little restorations gave back; whether the last program came after one.
        let mut restored: Vec<f64> = Vec::new();
        let mut unconfirmed = false;
        // Whether no contact came yet.
        let mut clear = true;
        let mut pairs = Vec::new();
        let mut limits = Limits::default();
        for k in 0..rules.most {
            if self.late() {
                (out.ending, out.why) = (Ending::Undecided, Why::Time);
                break;
            }
            let begin = Instant::now();
            let placed = self.scaffold.place(&poses);
            self.stations.follow(&self.scaffold, &poses, &placed);
            self.scaffold.turn_limits = limits.bounds();
            let after = std::mem::take(&mut unconfirmed);
            let mut unfollowed = false;
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
                unfollowed = after && self.worth(double(&solved.objective));
                let next = solved.direction.as_ref().map(|direction| {
                    if unfollowed {
                        return (Rat::zero(), poses.clone());
                    }
                    self.search(&rows, &poses, direction, &solved)
                });
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
                (out.ending, out.why) = match taken.solved.status {
                    Status::Unbounded => (Ending::Unbounded, Why::Unbounded),
                    Status::Infeasible => (Ending::Infeasible, Why::Infeasible),
                    _ => (Ending::Undecided, Why::Time),
                };
            }
            let next = taken.next.unwrap_or_else(|| poses.clone());
            let reached = self.scaffold.displacement(&next);
            let gain = &reached - &out.displacement;
            if rules.path == Path::Safe && !stopped && gain.sign() < 0 {
                // Nothing is violated on a safe path, so nothing calls for a step back: it comes
                // from what is held back, and there is nothing more to gain.
                (out.ending, out.why) = self.settled(taken.promise, &out.displacement, true);
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
                gradient_bits: self.stations.bits(),
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
            let both = &gain + &finite(last_gain);
            let little = -&gain < &out.displacement.abs() * &Rat::from_f64(LITTLE);
            last_gain = double(&gain);
            if gain < rules.gain && (-&gain < rules.gain || little || both < rules.gain) {
                if limited {
                    limits.lift();
                    continue;
                }
                if -&gain >= rules.gain {
                    restored.push(-double(&gain));
                    if restored.len() <= CONFIRMATIONS {
                        // The program after it tells what is left to gain.
                        unconfirmed = true;
                        continue;
                    }
                }
                // A direction that cannot be followed at all shows nothing.
                let last = out.steps.last();
                let stuck = last.is_some_and(|s| s.scale.is_zero());
                let promise = match rules.path {
                    Path::Safe => taken.promise,
                    Path::Fast => last.map_or(0.0, |s| double(&s.objective)),
                };
                let loss = restored.last().copied().unwrap_or(0.0);
                (out.ending, out.why) = if gain.sign() < 0 && -&gain >= rules.gain {
                    (
                        Ending::Converged,
                        Why::Restored {
                            loss,
                            promise: None,
                        },
                    )
                } else if unfollowed {
                    let promise = Some(promise);
                    (Ending::Converged, Why::Restored { loss, promise })
                } else if stuck || rules.path == Path::Safe {
                    self.settled(promise, &out.displacement, stuck)
                } else {
                    (Ending::Converged, Why::Little(promise))
                };
                break;
            }
        }
        let placed = self.scaffold.place(&poses);
        if pairs.is_empty() {
            pairs = self.selection(&placed, true).pairs;
        }
        out.violation = self.worst(&pairs, &placed);
        if matches!(out.why, Why::Little(_))
            && let Some(promise) = self.unlimited(&poses).filter(|p| self.worth(*p))
        {
            (out.ending, out.why) = (Ending::Undecided, Why::Limited(promise));
        }
        out
    }

    /// What a program promises without the limit of rotation that the structure asks for; None
    /// where it asks for none.
    fn unlimited(&mut self, poses: &[Pose]) -> Option<f64> {
        self.scaffold.rotation_limit.take()?;
        self.scaffold.turn_limits = None;
        let placed = self.scaffold.place(poses);
        let selection = self.selection(&placed, true);
        let (_, rows) = self.rows(&selection, &placed);
        let solved = branch::solve(self, &rows, &selection, &placed, poses);
        match solved.status {
            Status::Optimal => Some(double(&solved.objective)),
            Status::Unbounded => Some(f64::INFINITY),
            _ => None,
        }
    }

    /// How a run ends that gains no more, though something was promised: converged, if that is
    /// little beside what was reached. `stuck` if no part of the direction was followed.
    fn settled(&self, promise: f64, reached: &Rat, stuck: bool) -> (Ending, Why) {
        if !self.worth(promise) {
            return (Ending::Converged, Why::Little(promise));
        }
        let why = match self.structure.step.path {
            Path::Safe => Why::Unproven(promise),
            Path::Fast if stuck => Why::Unfollowed(promise),
            Path::Fast => Why::Little(promise),
        };
        let little = promise < LITTLE * double(reached).abs();
        let ending = if little {
            Ending::Converged
        } else {
            Ending::Undecided
        };
        (ending, why)
    }

    /// Whether a promise is more than what ends a run.
    pub(crate) fn worth(&self, promise: f64) -> bool {
        promise > 10.0 * double(&self.structure.step.gain)
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
}
