//! Whether a structure comes apart, decided exactly (PF §VI-C, Fig. 8).
//!
//! The constraints J q̇ + d₀ ≥ 0 let something move without end exactly if their cone
//! {r : J r ≥ 0} holds more than 0. PF looks for such a direction r by the sum Σ of all x and y
//! velocities, which "for almost every" r is not zero: once a program asks for a large sum, once
//! for a very negative one. Here the two programs are the maximum and the minimum of Σ itself;
//! unboundedness comes with a ray as its proof. The case that PF leaves open, Σ = 0, is decided
//! too, by at most two more programs and a rank:
//!
//! * the largest sum of all rows' rates J r over r in the cone, Σ r = 0, |rⱼ| ≤ 1: where it is
//!   positive, its point is a direction; where it is zero, J r = 0 for all of them;
//! * then a weighted sum of the columns under J r = 0, Σ r = 0, |rⱼ| ≤ 1: where it is positive,
//!   its point slides and changes no distance; and where J with the row Σ has full column rank
//!   (shown modulo a prime, which can only lose rank), there is none.
//!
//! A held body is needed, or the whole could always drift away: where the file holds none, the
//! first body is. What is decided is the linear model of near constraints; a direction without
//! rotations is checked against all bodies for all time by [`super::escape`], exactly; one that
//! collides takes nothing apart. Nor does a direction in which only pinned bodies turn about their
//! pins: where the case Σ = 0 begins with such a one, programs for every freedom of the free bodies
//! look for another.

use super::escape::escapes;
use super::sequence::{SequenceDocument, sequence};
use crate::certificate::lp::{Claim, verify};
use crate::flex::fit::Fitted;
use crate::flex::model::{Form, Row};
use crate::flex::shape::placed;
use crate::flex::step::{FlexOptions, Run};
use crate::flex::{Hold, Structure};
use crate::geometry::Vec2;
use crate::lp::{self, Certificate, Model, Options, Range, Status};
use crate::number::Rat;
use crate::report::Num;
use serde::Serialize;
use std::time::Duration;

/// The sign of the sum of all x and y velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Sum {
    /// Σ > 0.
    Positive,
    /// Σ < 0.
    Negative,
    /// Σ = 0.
    Zero,
}

/// Whether a cone holds a direction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// This one, its largest component 1 in size.
    Ray(Vec<Rat>),
    /// None but 0: proven.
    None,
    /// A limit was reached.
    Undecided,
}

/// A cone {r : every row · r ≥ 0} with the columns that count in the sum.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cone {
    pub(crate) columns: usize,
    pub(crate) rows: Vec<Vec<(usize, Rat)>>,
    pub(crate) counted: Vec<usize>,
    /// Columns of bodies that nothing holds.
    pub(crate) loose: Vec<usize>,
    pub(crate) time_limit: Option<Duration>,
}

impl Cone {
    fn model(&self, range: &Range) -> Model {
        let mut model = Model::new("separate");
        model.maximise = true;
        for k in 0..self.columns {
            model.add_column(&format!("q{k}"), Rat::zero(), range.clone());
        }
        for (i, row) in self.rows.iter().enumerate() {
            let r = model.add_row(&format!("r{i}"), Range::at_least(Rat::zero()));
            for (c, v) in row {
                model.set(r, *c, v.clone());
            }
        }
        model
    }

    fn options(&self) -> Options {
        Options {
            values: true,
            time_limit: self.time_limit,
            ..Options::default()
        }
    }

    /// Whether the cone holds a direction whose sum has this sign.
    pub(crate) fn ray(&self, sum: Sum) -> Answer {
        match sum {
            Sum::Positive => self.unbounded(&Rat::one()),
            Sum::Negative => self.unbounded(&Rat::from(-1)),
            Sum::Zero => self.loosened(),
        }
    }

    fn unbounded(&self, cost: &Rat) -> Answer {
        let mut model = self.model(&Range::free());
        for &c in &self.counted {
            model.columns[c].cost = cost.clone();
        }
        let outcome = lp::solve(&model, &self.options());
        match (outcome.status, &outcome.certificate) {
            (Status::Unbounded, Some(Certificate::Unbounded { ray, .. })) => {
                let found: Vec<Rat> = (0..self.columns).map(|k| ray.value(k)).collect();
                let proven = Claim::of(&outcome).is_some_and(|c| verify(&model, &c).is_ok());
                match proven && self.holds(&found) {
                    true => Answer::Ray(normal(found)),
                    false => Answer::Undecided,
                }
            }
            (Status::Optimal, _) => Answer::None,
            _ => Answer::Undecided,
        }
    }

    /// Whether a vector lies in the cone, checked term by term.
    fn holds(&self, r: &[Rat]) -> bool {
        let rate =
            |row: &Vec<(usize, Rat)>| row.iter().fold(Rat::zero(), |sum, (c, v)| sum + v * &r[*c]);
        self.rows.iter().all(|row| rate(row).sign() >= 0)
    }

    /// A direction with sum 0, one that moves a free body where there is any.
    fn loosened(&self) -> Answer {
        let first = self.level();
        let moves = |r: &[Rat]| self.loose.iter().any(|&c| !r[c].is_zero());
        if !matches!(&first, Answer::Ray(r) if !moves(r)) {
            return first;
        }
        let mut model = self.level_model();
        for &c in &self.loose {
            for cost in [Rat::one(), Rat::from(-1)] {
                model.columns[c].cost = cost;
                match self.best(&model) {
                    Answer::None => {}
                    other => return other,
                }
            }
            model.columns[c].cost = Rat::zero();
        }
        first
    }

    /// The cone within a box, with sum 0 as its last row.
    fn level_model(&self) -> Model {
        let unit = Range {
            lower: Some(Rat::from(-1)),
            upper: Some(Rat::one()),
        };
        let mut model = self.model(&unit);
        let sum = model.add_row("sum", Range::fixed(Rat::zero()));
        for &c in &self.counted {
            model.set(sum, c, Rat::one());
        }
        model
    }

    fn level(&self) -> Answer {
        let mut model = self.level_model();
        for row in &self.rows {
            for (c, v) in row {
                model.columns[*c].cost = &model.columns[*c].cost + v;
            }
        }
        match self.best(&model) {
            Answer::None => {}
            other => return other,
        }
        // Every direction left changes no distance: rows become equations.
        for row in &mut model.rows[..self.rows.len()] {
            row.range = Range::fixed(Rat::zero());
        }
        // Weights in no special position; a direction orthogonal to them is caught by the rank.
        for (k, column) in model.columns.iter_mut().enumerate() {
            column.cost = Rat::from((k as i64 * 7_919 + 104_729) % 1_000_003 + 1);
        }
        match self.best(&model) {
            Answer::None if self.full_rank() => Answer::None,
            Answer::None => Answer::Undecided,
            other => other,
        }
    }

    /// The optimum of a program over a box, as a direction where it is positive.
    fn best(&self, model: &Model) -> Answer {
        let outcome = lp::solve(model, &self.options());
        if outcome.status != Status::Optimal {
            return Answer::Undecided;
        }
        let positive = outcome.objective.as_ref().is_some_and(|v| v.sign() > 0);
        match (positive, outcome.values) {
            (true, Some(values)) if self.holds(&values) => Answer::Ray(normal(values)),
            (true, _) => Answer::Undecided,
            (false, _) => Answer::None,
        }
    }

    /// Whether the rows and the sum have full column rank, modulo a prime; if so, then also over
    /// the rationals. Sparse elimination, the shortest row as pivot.
    fn full_rank(&self) -> bool {
        const P: u64 = (1 << 61) - 1;
        let times = |a: u64, b: u64| (u128::from(a) * u128::from(b) % u128::from(P)) as u64;
        let inverse = |a: u64| {
            let (mut base, mut power, mut out) = (a, P - 2, 1);
            while power > 0 {
                if power & 1 == 1 {
                    out = times(out, base);
                }
                base = times(base, base);
                power >>= 1;
            }
            out
        };
        let mut rows: Vec<Vec<(usize, u64)>> = Vec::new();
        for row in &self.rows {
            let mut out = Vec::new();
            for (c, v) in row {
                let (n, d) = (v.numer().mod_u64(P), v.denom().mod_u64(P));
                if d == 0 {
                    return false;
                }
                out.push((*c, times(n, inverse(d))));
            }
            rows.push(out);
        }
        rows.push(self.counted.iter().map(|&c| (c, 1)).collect());
        for row in &mut rows {
            row.retain(|e| e.1 != 0);
            row.sort_unstable();
        }
        for column in 0..self.columns {
            let holders: Vec<usize> = (0..rows.len())
                .filter(|&i| rows[i].first().is_some_and(|e| e.0 == column))
                .collect();
            let Some(&pivot) = holders.iter().min_by_key(|&&i| rows[i].len()) else {
                return false;
            };
            let chosen = std::mem::take(&mut rows[pivot]);
            let scale = inverse(chosen[0].1);
            for i in holders {
                if i == pivot {
                    continue;
                }
                let factor = times(P - rows[i][0].1, scale);
                let mut sum: std::collections::BTreeMap<usize, u64> =
                    rows[i].iter().copied().collect();
                for &(c, v) in &chosen {
                    let slot = sum.entry(c).or_insert(0);
                    *slot = (*slot + times(factor, v)) % P;
                }
                rows[i] = sum.into_iter().filter(|e| e.1 != 0).collect();
            }
        }
        true
    }
}

/// A vector scaled so that its largest component is 1 in size.
fn normal(v: Vec<Rat>) -> Vec<Rat> {
    let largest = v.iter().map(Rat::abs).max();
    match largest {
        Some(top) if !top.is_zero() => v.iter().map(|x| x / &top).collect(),
        _ => v,
    }
}

/// How a structure comes apart in one sign of the sum.
#[derive(Clone, Debug)]
pub struct Separation {
    /// The sign of the sum.
    pub sum: Sum,
    /// The answer, over the columns of the structure.
    pub answer: Answer,
    /// Where there is a direction: x, y and θ of every body.
    pub velocities: Option<Vec<[Rat; 3]>>,
    /// Where the direction rotates nothing: whether it clears everything for all time.
    pub clear: Option<bool>,
    /// Whether the direction takes something apart: it moves a body that no pin holds, and is not
    /// known to collide.
    pub parts: bool,
}

/// What was decided of a structure.
#[derive(Clone, Debug)]
pub struct Separated {
    /// The three signs.
    pub cases: [Separation; 3],
    /// Constraints that hold the bodies where they stand; with none, nothing is within epsilon of
    /// anything.
    pub rows: usize,
    /// Where a direction of the three signs collides and none is clear: a body and a translation of it alone that
    /// clears everything for all time.
    pub way_out: Option<(usize, Vec2)>,
}

impl Separated {
    /// `comes-apart` if a direction takes something apart; `holds` if the near constraints leave no
    /// free body any direction; `undecided` if a limit was reached, or if directions are left by
    /// the near constraints but one collides farther on and none was found that is clear for all
    /// time. Where all directions turn bodies, it is a statement to first order, as PF's.
    pub fn verdict(&self) -> &'static str {
        let any = |f: fn(&Separation) -> bool| self.cases.iter().any(f);
        if self.way_out.is_some() || any(|c| c.parts && c.clear.is_some()) {
            "comes-apart"
        } else if any(|c| c.clear == Some(false)) {
            "undecided"
        } else if any(|c| c.parts) {
            "comes-apart"
        } else if any(|c| c.answer == Answer::Undecided) {
            "undecided"
        } else {
            "holds"
        }
    }
}

/// Decides for each of the three signs whether a structure comes apart. With `translations`
/// rotations are left out. `limit` bounds each program.
///
/// Cost: at most four linear programs, and where pinned bodies alone turn two more for every freedom
/// of the free ones; for directions without rotations the product of the edges of every two bodies
/// that part. Where one collides and none is clear, a search for one body's way out like [`sequence`]'s.
pub fn separate(structure: &Structure, translations: bool, limit: Option<Duration>) -> Separated {
    let file = held(structure);
    let fit = Fitted::of(&file);
    let structure = fit.as_ref().map_or(&file, |f| &f.structure);
    let unit = fit.as_ref().map_or_else(Rat::one, Fitted::length);
    let options = FlexOptions::default();
    let run = Run::new(structure, &options);
    let poses = run.scaffold.place(&run.scaffold.start);
    let selection = run.selection(&poses, false);
    let (_, rows) = run.rows(&selection, &poses);
    let cone = cone_of(&run, &rows, translations, limit);
    let polygons = placed(structure);
    let cases = [Sum::Positive, Sum::Negative, Sum::Zero].map(|sum| {
        let answer = cone.ray(sum);
        let mut velocities = match &answer {
            Answer::Ray(r) => Some(
                (0..structure.bodies.len())
                    .map(|b| {
                        run.scaffold
                            .column(b)
                            .map(|c| c.map_or_else(Rat::zero, |c| r[c].clone()))
                    })
                    .collect::<Vec<[Rat; 3]>>(),
            ),
            _ => None,
        };
        let clear = velocities
            .as_ref()
            .filter(|v| v.iter().all(|[_, _, t]| t.is_zero()))
            .map(|v| {
                let way = |b: usize| Vec2::new(v[b][0].clone(), v[b][1].clone());
                (0..polygons.len()).all(|a| {
                    (a + 1..polygons.len())
                        .all(|b| escapes(&polygons[b], &polygons[a], &(&way(b) - &way(a))))
                })
            });
        let free = |b: usize| structure.bodies[b].hold == Hold::Free;
        let moves = |v: &[[Rat; 3]]| {
            let each = v.iter().enumerate();
            each.filter(|(b, _)| free(*b))
                .any(|(_, d)| d.iter().any(|x| !x.is_zero()))
        };
        let parts = clear != Some(false) && velocities.as_ref().is_some_and(|v| moves(v));
        if let Some(all) = velocities.as_mut().filter(|_| fit.is_some()) {
            in_units(all, &unit);
        }
        Separation {
            sum,
            answer,
            velocities,
            clear,
            parts,
        }
    });
    let collides = cases.iter().any(|c| c.clear == Some(false));
    let way_out = (collides && !cases.iter().any(|c| c.parts && c.clear.is_some()))
        .then(|| sequence(&file, limit).removed.into_iter().next());
    Separated {
        cases,
        rows: rows.len(),
        way_out: way_out.flatten(),
    }
}

/// Velocities whose lengths are in multiples of `unit`, in the file's, the largest again 1 in size.
fn in_units(all: &mut [[Rat; 3]], unit: &Rat) {
    for [x, y, _] in all.iter_mut() {
        (*x, *y) = (&*x * unit, &*y * unit);
    }
    let largest = all.iter().flatten().map(Rat::abs).max();
    if let Some(top) = largest.filter(|t| !t.is_zero()) {
        for v in all.iter_mut().flatten() {
            *v = &*v / &top;
        }
    }
}

/// The structure with its first body fixed where none is held.
pub(crate) fn held(structure: &Structure) -> Structure {
    let mut out = structure.clone();
    if out.bodies.iter().all(|b| b.hold == Hold::Free) {
        out.bodies[0].hold = Hold::Fixed;
    }
    out
}

fn cone_of(run: &Run<'_>, rows: &[Row], translations: bool, limit: Option<Duration>) -> Cone {
    let scaffold = &run.scaffold;
    let mut cone = Cone {
        columns: scaffold.column_count,
        time_limit: limit,
        ..Cone::default()
    };
    let mut turning = vec![false; cone.columns];
    for (body, form) in scaffold.forms.iter().enumerate() {
        let [x, y, theta] = scaffold.column(body);
        if *form == Form::Free {
            cone.counted.extend(x.into_iter().chain(y));
            cone.loose.extend(x.into_iter().chain(y).chain(theta));
        }
        if let Some(t) = theta {
            turning[t] = true;
        }
    }
    for row in rows {
        let entries = scaffold.entries(row).into_iter();
        let kept = entries.filter(|(c, _)| !(translations && turning[*c]));
        cone.rows
            .push(kept.map(|(c, v)| (c, Rat::from(v))).collect());
    }
    if translations {
        // θ = 0, as two rows.
        for (t, _) in turning.iter().enumerate().filter(|t| *t.1) {
            cone.rows.push(vec![(t, Rat::one())]);
            cone.rows.push(vec![(t, Rat::from(-1))]);
        }
    }
    cone
}

/// The result of `snapfit separate`.
#[derive(Clone, Debug, Serialize)]
pub struct SeparateDocument {
    /// Which format this is.
    pub schema: &'static str,
    /// Name of the structure.
    pub structure: String,
    /// The body that was held because the file holds none.
    pub held: Option<String>,
    /// Whether rotations were left out.
    pub translations: bool,
    /// `comes-apart`, `holds` or `undecided`.
    pub verdict: &'static str,
    /// Constraints that hold the bodies where they stand; with 0, nothing is within epsilon of
    /// anything.
    pub rows: usize,
    /// Why it is undecided, or what the verdict leaves out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<&'static str>,
    /// The three signs.
    pub cases: Vec<CaseDocument>,
    /// Where a direction found collides and none is clear: a body and a translation of it alone, as two rationals,
    /// that clears everything for all time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub way_out: Option<(String, [String; 2])>,
    /// Bodies removed one after the other, where asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sequence: Option<SequenceDocument>,
}

/// One sign.
#[derive(Clone, Debug, Serialize)]
pub struct CaseDocument {
    /// The sign of the sum of x and y velocities.
    pub sum: Sum,
    /// `ray` (the near constraints leave a direction), `none` or `undecided`.
    pub answer: &'static str,
    /// Bodies that move, and how: x, y, θ.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<(String, [Num; 3])>,
    /// Without rotations: whether the motion is clear of everything for all time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clear: Option<bool>,
    /// Whether the direction takes something apart: it moves a body that no pin holds, and is not
    /// known to collide.
    pub parts: bool,
}

impl SeparateDocument {
    /// The document of a decision.
    pub fn new(structure: &Structure, translations: bool, found: &Separated) -> SeparateDocument {
        let cases = &found.cases;
        let verdict = found.verdict();
        let free = structure.bodies.iter().all(|b| b.hold == Hold::Free);
        SeparateDocument {
            schema: "snapfit.separate/1",
            structure: structure.name.clone(),
            held: free.then(|| structure.bodies[0].name.clone()),
            translations,
            verdict,
            rows: found.rows,
            reason: match verdict {
                "undecided" if cases.iter().any(|c| c.clear == Some(false)) => Some(
                    "what is within epsilon leaves it free to go, but no direction was found that \
                     does not collide farther on: a larger epsilon may decide it",
                ),
                "undecided" => Some("a limit was reached"),
                "holds" if cases.iter().any(|c| c.velocities.is_some()) => {
                    Some("pinned bodies turn about their pins, and nothing else moves")
                }
                _ => None,
            },
            way_out: found.way_out.as_ref().map(|(b, d)| {
                let name = structure.bodies[*b].name.clone();
                (name, [d.x.to_string(), d.y.to_string()])
            }),
            cases: cases
                .iter()
                .map(|c| CaseDocument {
                    sum: c.sum,
                    answer: match c.answer {
                        Answer::Ray(_) => "ray",
                        Answer::None => "none",
                        Answer::Undecided => "undecided",
                    },
                    motion: c
                        .velocities
                        .iter()
                        .flatten()
                        .zip(&structure.bodies)
                        .filter(|(v, _)| v.iter().any(|x| !x.is_zero()))
                        .map(|(v, b)| (b.name.clone(), [0, 1, 2].map(|k| Num::of_rat(&v[k]))))
                        .collect(),
                    clear: c.clear,
                    parts: c.parts,
                })
                .collect(),
            sequence: None,
        }
    }

    /// Adds bodies removed one after the other: any that is taken away for ever shows that the
    /// structure comes apart, also where near constraints ask more than they need to (where corners
    /// touch).
    pub fn with_sequence(&mut self, sequence: SequenceDocument) {
        if !sequence.removed.is_empty() {
            (self.verdict, self.reason) = ("comes-apart", None);
        }
        self.sequence = Some(sequence);
    }
}
