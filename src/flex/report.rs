//! Results as JSON, in the words of the contract.

use super::bound::OuterBound;
use super::model::turned_by;
use super::outcome::{Ending, Flexed};
use super::shape::Pose;
use super::types::Structure;
use crate::number::{Algebraic, Rat};
use crate::report::Num;
use crate::report::theta::theta;
use serde::Serialize;
use serde_json::Value;

/// The result of `snapfit flex`.
#[derive(Clone, Debug, Serialize)]
pub struct FlexDocument {
    /// Which format this is.
    pub schema: &'static str,
    /// Name of the structure.
    pub structure: String,
    /// Bodies, fixed ones included.
    pub bodies: usize,
    /// Rows of the first program.
    pub rows: usize,
    /// Columns of the programs.
    pub columns: usize,
    /// Programs solved in sequence, one a step.
    pub iterations: usize,
    /// How stepping ended.
    pub outcome: &'static str,
    /// Why it ended there, in a sentence.
    pub reason: String,
    /// The weighted displacement reached, exact.
    pub displacement: Num,
    /// The largest violation at the end.
    pub violation: Num,
    /// The steps.
    pub steps: Vec<StepDocument>,
    /// `fast` or `safe`.
    pub path: &'static str,
    /// `exact`, `bounds` or `float`.
    pub accuracy: &'static str,
    /// Where the bodies stand at the end.
    pub poses: Vec<PoseDocument>,
    /// Bits of the longest number of any pose, after each step.
    pub bits: Vec<u64>,
    /// What proves the steps' optima.
    pub certificate: Value,
    /// Where asked for: an outer bound of the flex.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<BoundDocument>,
}

/// One step.
#[derive(Clone, Debug, Serialize)]
pub struct StepDocument {
    /// Optimum of the step's program.
    pub objective: Num,
    /// The scale at which its direction was applied.
    pub step: Num,
    /// What the displacement gained.
    pub gain: Num,
    /// Rows of the program.
    pub rows: usize,
    /// Bits that the geometry of the program's gradients was rounded to before they were computed,
    /// exactly, from it; null where nothing was rounded. What the certificates prove is the
    /// optimum of the program with these gradients.
    pub gradient_bits: Option<u32>,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Of these, for pairs and rows.
    pub model_seconds: f64,
    /// Programs that the step took; more than one where corners are branched on.
    pub programs: usize,
    /// Convex corners that face each other.
    pub facing: usize,
    /// Pivots of the exact simplex method.
    pub exact_pivots: u64,
    /// On a safe path: what was proven to be free of collision throughout the step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proof: Option<ProofDocument>,
    /// With `--contact`: the first contact of the whole path, in the step in which it comes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactDocument>,
}

/// A vertex that passes into a body.
#[derive(Clone, Debug, Serialize)]
pub struct ContactDocument {
    /// The body it passes into.
    pub edge_body: String,
    /// The edge it passes, counted as listed.
    pub edge: usize,
    /// The vertex's body.
    pub vertex_body: String,
    /// The vertex, counted as listed.
    pub vertex: usize,
    /// When, exactly: 0 at the step's begin, 1 at its end.
    pub time: Num,
}

/// An outer bound: no motion without collision moves the objective farther.
#[derive(Clone, Debug, Serialize)]
pub struct BoundDocument {
    /// The bound; null where there is none.
    pub outer: Option<Num>,
    /// Over the displacement that this run reached, which a safe path attains.
    pub ratio: Option<f64>,
    /// The exact optimum of the relaxed program.
    pub relaxed: Option<Num>,
    /// What its linearised objective may lose.
    pub loss: Option<Num>,
    /// Contacts that gave no row.
    pub dropped: Option<usize>,
    /// Whether the relaxed program's certificate passed the verifier.
    pub verified: bool,
    /// Why there is no bound.
    pub reason: Option<String>,
}

/// The size of a proof.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ProofDocument {
    /// Pairs of bodies that may come near each other.
    pub bodies: usize,
    /// Vertices against edges.
    pub pairs: usize,
    /// Of these, decided in rationals.
    pub exact: usize,
}

/// A body's place.
#[derive(Clone, Debug, Serialize)]
pub struct PoseDocument {
    /// Its name.
    pub body: String,
    /// Abscissa of its frame's origin, exact.
    pub x: String,
    /// Ordinate.
    pub y: String,
    /// tan(θ/2), exact.
    pub tan_half: String,
    /// θ in radians, within (−π, π], correctly rounded.
    pub theta: f64,
    /// How far it has turned since the start, φ in radians, within (−π, π], correctly rounded; an
    /// objective counts a turn as 2 tan(φ/2).
    pub turned: f64,
}

/// θ of tan(θ/2), the nearest double.
fn radians(tan_half: &Rat) -> f64 {
    if tan_half.abs() <= Rat::one() {
        return theta(0, &Algebraic::from(tan_half.clone()));
    }
    // 2 atan u = ±π − 2 atan(1/u).
    theta(tan_half.sign().into(), &Algebraic::from(-tan_half.recip()))
}

impl FlexDocument {
    /// The document of a run.
    pub fn new(structure: &Structure, flexed: &Flexed, accuracy: &'static str) -> FlexDocument {
        let last = flexed.configurations.last();
        let poses = structure
            .bodies
            .iter()
            .zip(last.into_iter().flatten())
            .map(|(body, pose)| {
                let at = pose.position(body);
                PoseDocument {
                    body: body.name.clone(),
                    x: at.x.to_string(),
                    y: at.y.to_string(),
                    tan_half: pose.tan_half.to_string(),
                    theta: radians(&pose.tan_half),
                    turned: radians(&turned_by(&Pose::of(body), pose)),
                }
            })
            .collect();
        let proofs: Vec<Value> = flexed
            .steps
            .iter()
            .map(|s| {
                let end = |v: &Option<crate::number::Rat>| v.as_ref().map(ToString::to_string);
                serde_json::json!({
                    "lower": end(&s.enclosure.0),
                    "upper": end(&s.enclosure.1),
                    "verified": s.verified,
                    "lp": s.certificate,
                })
            })
            .collect();
        let all = flexed.steps.iter().all(|s| s.verified == Some(true));
        FlexDocument {
            schema: "snapfit.flex/1",
            structure: structure.name.clone(),
            bodies: structure.bodies.len(),
            rows: flexed.steps.first().map_or(0, |s| s.rows),
            columns: flexed.columns,
            iterations: flexed.steps.len(),
            outcome: flexed.ending.word(),
            reason: flexed.why.to_string(),
            displacement: Num::of_rat(&flexed.displacement),
            violation: Num::of(&flexed.violation.value()),
            steps: flexed
                .steps
                .iter()
                .map(|s| StepDocument {
                    objective: Num::of_rat(&s.objective),
                    step: Num::of_rat(&s.scale),
                    gain: Num::of_rat(&s.gain),
                    rows: s.rows,
                    gradient_bits: s.gradient_bits,
                    seconds: s.seconds,
                    model_seconds: s.model_seconds,
                    programs: s.programs,
                    facing: s.facing,
                    exact_pivots: s.exact_pivots,
                    proof: s.proof.map(|p| ProofDocument {
                        bodies: p.bodies,
                        pairs: p.pairs,
                        exact: p.exact,
                    }),
                    contact: s.contact.as_ref().map(|c| ContactDocument {
                        edge_body: structure.bodies[c.edge.0].name.clone(),
                        edge: c.edge.1,
                        vertex_body: structure.bodies[c.vertex.0].name.clone(),
                        vertex: c.vertex.1,
                        time: Num::of(&c.time),
                    }),
                })
                .collect(),
            path: structure.step.path.word(),
            accuracy,
            poses,
            bits: flexed.steps.iter().map(|s| s.bits).collect(),
            certificate: serde_json::json!({
                "kind": "lp-steps",
                "verified": all,
                "steps": proofs,
            }),
            bound: None,
        }
    }

    /// The outer bound beside what this run reached.
    pub fn bounded(&self, bound: &Result<OuterBound, String>) -> BoundDocument {
        let mut out = BoundDocument {
            outer: None,
            ratio: None,
            relaxed: None,
            loss: None,
            dropped: None,
            verified: false,
            reason: None,
        };
        match bound {
            Ok(b) => {
                let outer = Num::of_rat(&b.value);
                let inner = self.displacement.value.filter(|v| *v > 0.0);
                out.ratio = outer.value.zip(inner).map(|(o, i)| o / i);
                out.outer = Some(outer);
                out.relaxed = Some(Num::of_rat(&b.relaxed));
                out.loss = Some(Num::of_rat(&b.loss));
                out.dropped = Some(b.dropped);
                out.verified = b.verified;
            }
            Err(why) => out.reason = Some(why.clone()),
        }
        out
    }

    /// Whether the question was decided.
    pub fn decided(ending: Ending) -> bool {
        ending != Ending::Undecided
    }
}

/// What `check` says of a structure.
#[derive(Clone, Debug, Serialize)]
pub struct StructureCheck {
    /// Which format this is.
    pub schema: &'static str,
    /// Name of the structure.
    pub structure: String,
    /// Bodies.
    pub bodies: usize,
    /// Of these, fixed.
    pub fixed: usize,
    /// Of these, pinned.
    pub pinned: usize,
    /// Vertices of all bodies.
    pub vertices: usize,
    /// Columns of the first program.
    pub columns: usize,
    /// Rows of the first program.
    pub rows: usize,
    /// Convex corners that face each other at the start.
    pub facing: usize,
    /// Views.
    pub views: usize,
    /// Where constraints come from.
    pub joints: String,
    /// Whether an objective is given.
    pub objective: bool,
    /// Warnings, one a line.
    pub warnings: Vec<String>,
}

impl StructureCheck {
    /// Looks at a structure; costs one model.
    pub fn of(structure: &Structure, warnings: Vec<String>) -> StructureCheck {
        use super::types::Hold;
        let options = super::step::FlexOptions::default();
        let fit = super::fit::Fitted::of(structure);
        let own = fit.as_ref().map_or(structure, |f| &f.structure);
        let run = super::step::Run::new(own, &options);
        let placed = run.scaffold.place(&run.scaffold.start);
        let selection = run.selection(&placed, false);
        let (_, rows) = run.rows(&selection, &placed);
        let held = |f: fn(&Hold) -> bool| structure.bodies.iter().filter(|b| f(&b.hold)).count();
        StructureCheck {
            schema: "snapfit.check-structure/1",
            structure: structure.name.clone(),
            bodies: structure.bodies.len(),
            fixed: held(|h| *h == Hold::Fixed),
            pinned: held(|h| matches!(h, Hold::Pin(_))),
            vertices: structure.bodies.iter().map(|b| b.vertices.len()).sum(),
            columns: run.scaffold.column_count,
            rows: rows.len(),
            facing: selection.facing.len(),
            views: structure.views.len(),
            joints: match &structure.joints {
                None => "closeness: every two bodies nearer than epsilon".to_owned(),
                Some(list) => format!(
                    "{} named pairs of bodies",
                    list.iter().map(|j| j.bodies.len()).sum::<usize>()
                ),
            },
            objective: run.scaffold.has_objective(),
            warnings,
        }
    }
}

impl std::fmt::Display for StructureCheck {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "structure {}", self.structure)?;
        writeln!(
            f,
            "  bodies         {} ({} fixed, {} pinned) with {} vertices",
            self.bodies, self.fixed, self.pinned, self.vertices
        )?;
        writeln!(f, "  joints         {}", self.joints)?;
        writeln!(
            f,
            "  first program  {} rows × {} columns, {} pairs of facing corners, {} views",
            self.rows, self.columns, self.facing, self.views
        )?;
        let asked = if self.objective {
            "given"
        } else {
            "none: `flex` needs one"
        };
        writeln!(f, "  objective      {asked}")?;
        for warning in &self.warnings {
            writeln!(f, "{warning}")?;
        }
        Ok(())
    }
}
