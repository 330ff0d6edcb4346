//! Taking a structure apart one body after the other, each by a translation without end.
//!
//! A body's near constraints leave it a cone of directions in the plane. Candidates are the rays
//! that the three signs of x + y give and the cone's furthest points towards eight sides, all from
//! exact programs; then the directions of edges of the body and of those beside it, since near
//! constraints ask too much where corners touch (PF §V-A). A candidate counts only if the body's translation along it is clear of every
//! body that is left, for all time ([`super::escape`]). The search is greedy, and loses nothing by
//! it: a body that can leave now can still leave after others have.

use super::escape::escapes;
use super::separate::{Answer, Cone, Sum, held};
use crate::flex::fit::Fitted;
use crate::flex::shape::placed;
use crate::flex::step::{FlexOptions, Run};
use crate::flex::{Hold, Structure};
use crate::geometry::{Polygon, Vec2};
use crate::lp::{self, Model, Options, Range, Status};
use crate::number::Rat;
use serde::Serialize;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// The order in which bodies leave.
#[derive(Clone, Debug, Default)]
pub struct Sequence {
    /// Bodies with their directions, in order.
    pub removed: Vec<(usize, Vec2)>,
    /// Free bodies that are left, for which no direction was found.
    pub left: Vec<usize>,
    /// Whether time ran out first.
    pub cut_short: bool,
}

/// The near constraints of two bodies: n · (velocity of `of` − velocity of `by`) ≥ 0.
struct Guard {
    of: usize,
    by: usize,
    normal: Vec2,
}

/// Takes a structure apart. Bodies that are held stay; where none is, the first does.
///
/// `limit` bounds the whole search.
///
/// Cost: for every body removed, up to eleven programs of two columns for every body left.
pub fn sequence(structure: &Structure, limit: Option<Duration>) -> Sequence {
    let deadline = limit.and_then(|t| Instant::now().checked_add(t));
    let structure = held(structure);
    // Directions of translation have no unit.
    let structure = Fitted::of(&structure).map_or(structure, |f| f.structure);
    let options = FlexOptions::default();
    let run = Run::new(&structure, &options);
    let poses = run.scaffold.place(&run.scaffold.start);
    let selection = run.selection(&poses, false);
    let (_, rows) = run.rows(&selection, &poses);
    let guards: Vec<Guard> = rows
        .iter()
        .map(|r| {
            let [x, y] = r.normal.clone();
            Guard {
                of: r.pair.point_body as usize,
                by: r.pair.line_body as usize,
                normal: Vec2::new(Rat::from(x), Rat::from(y)),
            }
        })
        .collect();
    let polygons = placed(&structure);
    let mut inside = vec![true; polygons.len()];
    let mut out = Sequence::default();
    loop {
        let late = std::cell::Cell::new(false);
        let next = (0..polygons.len())
            .filter(|&b| inside[b] && structure.bodies[b].hold == Hold::Free)
            .take_while(|_| {
                late.set(deadline.is_some_and(|d| Instant::now() >= d));
                !late.get()
            })
            .find_map(|b| way_out(b, &guards, &polygons, &inside).map(|d| (b, d)));
        out.cut_short = late.get();
        let Some((body, direction)) = next else {
            break;
        };
        inside[body] = false;
        out.removed.push((body, direction));
    }
    out.left = (0..polygons.len())
        .filter(|&b| inside[b] && structure.bodies[b].hold == Hold::Free)
        .collect();
    out
}

/// A direction in which a body leaves all others that are inside.
fn way_out(body: usize, guards: &[Guard], polygons: &[Polygon], inside: &[bool]) -> Option<Vec2> {
    let normals = guards.iter().filter_map(|g| {
        if g.of == body && inside[g.by] {
            Some(g.normal.clone())
        } else if g.by == body && inside[g.of] {
            Some(-&g.normal)
        } else {
            None
        }
    });
    let cone = Cone {
        columns: 2,
        rows: normals
            .map(|n| vec![(0, n.x), (1, n.y)])
            .map(|row| row.into_iter().filter(|e| !e.1.is_zero()).collect())
            .collect(),
        counted: vec![0, 1],
        loose: vec![0, 1],
        time_limit: None,
    };
    let signs = [Sum::Positive, Sum::Negative, Sum::Zero];
    let rays = signs.into_iter().filter_map(|sum| match cone.ray(sum) {
        Answer::Ray(r) => Some(Vec2::new(r[0].clone(), r[1].clone())),
        _ => None,
    });
    let clear = |d: &Vec2| {
        !d.is_zero()
            && (0..polygons.len())
                .filter(|&k| k != body && inside[k])
                .all(|k| escapes(&polygons[body], &polygons[k], d))
    };
    let sides = (0..8).filter_map(|k| furthest(&cone, k));
    let beside = guards
        .iter()
        .filter(|g| g.of == body || g.by == body)
        .map(|g| if g.of == body { g.by } else { g.of })
        .filter(|&k| inside[k]);
    let shapes: BTreeSet<usize> = beside.chain([body]).collect();
    let slides = shapes.into_iter().flat_map(|k| {
        let ring = &polygons[k].rings()[0];
        (0..ring.len()).flat_map(move |i| {
            let edge = &ring[(i + 1) % ring.len()] - &ring[i];
            [-&edge, edge]
        })
    });
    let mut tried = BTreeSet::new();
    let mut first_time = move |d: &Vec2| {
        let size = d.x.abs().max(d.y.abs());
        !size.is_zero() && tried.insert((&d.x / &size, &d.y / &size))
    };
    let all = rays.chain(sides).chain(slides);
    all.filter(|d| first_time(d)).find(clear)
}

/// The cone's furthest point towards a side, within the unit square.
fn furthest(cone: &Cone, side: usize) -> Option<Vec2> {
    const SIDES: [(i64, i64); 8] = [
        (0, 1),
        (1, 0),
        (0, -1),
        (-1, 0),
        (2, 1),
        (-1, 2),
        (-2, -1),
        (1, -2),
    ];
    let (x, y) = SIDES[side];
    let unit = Range {
        lower: Some(Rat::from(-1)),
        upper: Some(Rat::one()),
    };
    let mut model = Model::new("side");
    model.maximise = true;
    for (k, weight) in [x, y].into_iter().enumerate() {
        model.add_column(&format!("d{k}"), Rat::from(weight), unit.clone());
    }
    for (i, row) in cone.rows.iter().enumerate() {
        let r = model.add_row(&format!("r{i}"), Range::at_least(Rat::zero()));
        for (c, v) in row {
            model.set(r, *c, v.clone());
        }
    }
    let options = Options {
        values: true,
        ..Options::default()
    };
    let outcome = lp::solve(&model, &options);
    let values = outcome
        .values
        .filter(|_| outcome.status == Status::Optimal)?;
    Some(Vec2::new(values[0].clone(), values[1].clone()))
}

/// The sequence in a result.
#[derive(Clone, Debug, Serialize)]
pub struct SequenceDocument {
    /// Bodies with their directions, in order.
    pub removed: Vec<(String, [String; 2])>,
    /// Free bodies that are left.
    pub left: Vec<String>,
    /// Whether time ran out first.
    pub cut_short: bool,
}

impl SequenceDocument {
    /// The document of a sequence.
    pub fn new(structure: &Structure, sequence: &Sequence) -> SequenceDocument {
        let name = |b: usize| structure.bodies[b].name.clone();
        SequenceDocument {
            removed: sequence
                .removed
                .iter()
                .map(|(b, d)| (name(*b), [d.x.to_string(), d.y.to_string()]))
                .collect(),
            left: sequence.left.iter().map(|&b| name(b)).collect(),
            cut_short: sequence.cut_short,
        }
    }
}
