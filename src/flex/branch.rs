//! The program of a step, and the choice that facing corners leave.
//!
//! Averaged corners are rows like any other. With `--corners branch` two facing convex corners
//! stand for a disjunction, one of four edges must keep them apart, and the best of all choices is
//! found by branch and bound: the program without the open disjunctions bounds every choice from
//! above; where its optimum breaks one, four programs follow, each with one more row. A leaf has a
//! row for every disjunction, so its exact optimum is attained by a motion that respects them all;
//! the search ends when no open node promises more.

use super::model::{Row, Scaffold};
use super::pairs::Selection;
use super::safe::linear;
use super::shape::{Placed, Pose};
use super::step::{Corners, Run};
use crate::certificate::lp::{Claim, verify};
use crate::lp::{self, Model, Outcome, Places, Status};
use crate::number::Rat;

/// Most programs of one step.
const MOST_PROGRAMS: usize = 400;

/// What a step's programs gave.
pub(crate) struct Solved {
    pub(crate) status: Status,
    pub(crate) objective: Rat,
    /// A proven enclosure of the optimum over all choices.
    pub(crate) enclosure: (Option<Rat>, Option<Rat>),
    /// (x, y, θ) of every body, where there is an optimum.
    pub(crate) direction: Option<Vec<[f64; 3]>>,
    pub(crate) facing: usize,
    pub(crate) programs: usize,
    pub(crate) exact_pivots: u64,
    pub(crate) verified: Option<bool>,
    pub(crate) certificate: serde_json::Value,
    /// The optimal basis, where the program has the given rows and no more.
    pub(crate) basis: Option<Places>,
}

/// Solves the program of a configuration.
pub(crate) fn solve(
    run: &Run<'_>,
    rows: &[Row],
    selection: &Selection,
    placed: &[Placed],
    poses: &[Pose],
) -> Solved {
    let facing = &selection.facing;
    let scaffold = &run.scaffold;
    if run.options.corners == Corners::Average || facing.is_empty() {
        let (model, outcome) = run.program(rows, poses);
        let basis = outcome.basis.clone();
        return Solved {
            basis,
            ..conclude(run, &model, &outcome, facing.len(), 1, None)
        };
    }
    let choices: Vec<[Row; 4]> = facing
        .iter()
        .map(|f| scaffold.choices(f).map(|p| run.row(&p, placed)))
        .collect();
    let all = |taken: &[Option<u8>]| -> Vec<Row> {
        let chosen = taken.iter().zip(&choices);
        let more = chosen.filter_map(|(t, four)| t.map(|t| four[t as usize].clone()));
        rows.iter().cloned().chain(more).collect()
    };
    let program = |taken: &[Option<u8>]| scaffold.program(&all(taken), poses, &run.stations.poses);
    let solved = |taken: &[Option<u8>]| run.program(&all(taken), poses);
    let mut programs = 1;
    let root = vec![None; facing.len()];
    let (model, outcome) = solved(&root);
    if outcome.status != Status::Optimal {
        // Unbounded without the corners may still be bounded with them, but not provably so here.
        return conclude(run, &model, &outcome, facing.len(), 1, None);
    }
    let mut open = vec![(root, outcome)];
    let mut best: Option<(Model, Outcome)> = None;
    let value = |o: &Outcome| o.objective.clone().unwrap_or_else(Rat::zero);
    while let Some(next) = most_promising(&open) {
        let (taken, outcome) = open.swap_remove(next);
        if let Some((_, found)) = &best
            && value(&outcome) <= value(found)
        {
            // The most promising node promises nothing: done.
            open.clear();
            break;
        }
        if programs >= MOST_PROGRAMS {
            open.push((taken, outcome));
            break;
        }
        let direction = directions(scaffold, &outcome);
        let kept = |row: &Row| linear(row, &direction);
        // The disjunction that the optimum breaks most.
        let broken = (0..facing.len())
            .filter(|&k| taken[k].is_none())
            .map(|k| {
                (
                    k,
                    choices[k]
                        .iter()
                        .map(kept)
                        .fold(f64::NEG_INFINITY, f64::max),
                )
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match broken {
            None => {
                // A leaf: every disjunction has its row.
                let model = program(&taken);
                if best
                    .as_ref()
                    .is_none_or(|(_, b)| value(&outcome) > value(b))
                {
                    best = Some((model, outcome));
                }
            }
            Some((_, least)) if least >= -1e-12 => {
                // Nothing is broken as far as doubles see: take for each the row kept best.
                let mut leaf = taken.clone();
                for k in 0..facing.len() {
                    if leaf[k].is_none() {
                        let by = |a: &usize, b: &usize| {
                            kept(&choices[k][*a]).total_cmp(&kept(&choices[k][*b]))
                        };
                        leaf[k] = (0..4).max_by(by).map(|c| c as u8);
                    }
                }
                let (model, found) = solved(&leaf);
                programs += 1;
                if found.status == Status::Undecided {
                    return conclude(run, &model, &found, facing.len(), programs, None);
                }
                let reached = found.status == Status::Optimal;
                let whole = reached && value(&found) >= value(&outcome);
                if reached && best.as_ref().is_none_or(|(_, b)| value(&found) > value(b)) {
                    best = Some((model, found));
                }
                if !whole {
                    // An exact breach that doubles did not see: branch on the first open one.
                    let k = taken.iter().position(Option::is_none).unwrap_or(0);
                    programs += expand(&taken, k, &solved, &mut open);
                }
            }
            Some((k, _)) => programs += expand(&taken, k, &solved, &mut open),
        }
    }
    // Where the search was cut short the open nodes still bound the optimum from above.
    let above = open.iter().map(|(_, o)| value(o)).max();
    match best {
        Some((model, outcome)) => conclude(run, &model, &outcome, facing.len(), programs, above),
        None => conclude(
            run,
            &Model::new("flex"),
            &Outcome {
                status: if open.is_empty() {
                    Status::Infeasible
                } else {
                    Status::Undecided
                },
                ..lp::solve(&Model::new("flex"), &run.lp_options(&[]))
            },
            facing.len(),
            programs,
            above,
        ),
    }
}

type Node = (Vec<Option<u8>>, Outcome);

/// Solves the program with the sides that were chosen.
type Solver<'a> = dyn Fn(&[Option<u8>]) -> (Model, Outcome) + 'a;

fn most_promising(open: &[Node]) -> Option<usize> {
    (0..open.len()).max_by(|&a, &b| open[a].1.objective.cmp(&open[b].1.objective))
}

/// Adds the four children of a node on one disjunction; how many programs were solved.
fn expand(taken: &[Option<u8>], k: usize, solved: &Solver<'_>, open: &mut Vec<Node>) -> usize {
    for choice in 0..4 {
        let mut child = taken.to_vec();
        child[k] = Some(choice);
        let (_, outcome) = solved(&child);
        if outcome.status == Status::Optimal {
            open.push((child, outcome));
        }
    }
    4
}

/// The values of an outcome by body.
fn directions(scaffold: &Scaffold, outcome: &Outcome) -> Vec<[f64; 3]> {
    // Exact values where the program was asked for them: its numbers are long.
    let at = |c: Option<usize>| {
        let exact = |c: usize| outcome.values.as_ref()?.get(c).map(super::shape::double);
        let near = |c: usize| outcome.near.get(c).copied();
        c.and_then(|c| exact(c).or_else(|| near(c))).unwrap_or(0.0)
    };
    (0..scaffold.forms.len())
        .map(|b| scaffold.column(b).map(at))
        .collect()
}

fn conclude(
    run: &Run<'_>,
    model: &Model,
    outcome: &Outcome,
    facing: usize,
    programs: usize,
    above: Option<Rat>,
) -> Solved {
    let verified = if run.options.verify {
        Claim::of(outcome).map(|claim| verify(model, &claim).is_ok())
    } else {
        None
    };
    let mut report = lp::report::to_json(model, "", outcome);
    let mut enclosure = outcome.enclosure.clone();
    if let (Some(above), Some(upper)) = (above, &mut enclosure.1)
        && above > *upper
    {
        *upper = above;
    }
    Solved {
        status: outcome.status,
        objective: outcome.objective.clone().unwrap_or_else(Rat::zero),
        enclosure,
        direction: (outcome.status == Status::Optimal && !outcome.near.is_empty())
            .then(|| directions(&run.scaffold, outcome)),
        facing,
        programs,
        exact_pivots: outcome.exact_pivots,
        verified,
        certificate: report["certificate"].take(),
        basis: None,
    }
}

#[cfg(test)]
mod tests;
