//! What `forces` prints: the types of its result, and of the picture's points.

use super::bound::Bound;
use super::handbook::Handbook;
use crate::motion::OutcomeKind;
use crate::report::Num;
use crate::report::json::ContactDocument;
use schemars::JsonSchema;
use serde::Serialize;

/// The result of `forces`. Every enclosure is a pair of exact rationals, narrower than the digits
/// asked for where the search settled.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ForcesDocument {
    /// `snapfit.forces/1`.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// How the motion ended.
    pub outcome: &'static str,
    /// Whether any pawl has a stiffness; without one there are no forces.
    pub modelled: bool,
    /// How many significant digits were asked for.
    pub digits: u32,
    /// What was left out, in words; null where nothing was.
    pub note: Option<String>,
    /// Over the whole motion and all pawls; null where no pawl has a stiffness.
    pub peak: Option<PeakDocument>,
    /// The same a pawl.
    pub pawls: Vec<PawlForces>,
    /// What the root feels, all pawls together; null where nothing of it was asked for.
    pub root: Option<RootForces>,
    /// Assembly against disassembly; null where it was not asked for, nothing was modelled or there
    /// is no way back.
    pub comparison: Option<Comparison>,
    /// What to draw.
    #[serde(skip)]
    pub drawing: Drawing,
    /// Whether a limit of time stopped the motion or a search: what is enclosed still is, but no
    /// more than that.
    #[serde(skip)]
    pub undecided: bool,
}

/// Resistance over travel, in doubles, for the picture.
#[derive(Debug, Default)]
pub struct Drawing {
    /// One a phase, the way back last.
    pub phases: Vec<DrawnPhase>,
}

/// One phase of the picture.
#[derive(Debug)]
pub struct DrawnPhase {
    /// In words.
    pub name: String,
    /// How far the root goes.
    pub length: f64,
    /// Where it goes back over the phase before.
    pub back: bool,
    /// Travel and resistance; one run of points a window.
    pub rubbed: Vec<Vec<[f64; 2]>>,
    /// The same without friction; empty where there is none.
    pub smooth: Vec<Vec<[f64; 2]>>,
    /// Travel and the handbook's value.
    pub handbook: Vec<[f64; 2]>,
    /// Travel at which the force grows past every bound.
    pub unbounded: Option<f64>,
}

/// A peak of force and one of torque.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct PeakDocument {
    /// The contact force.
    pub force: Bound,
    /// The torque at the hinge.
    pub torque: Bound,
    /// When the force peaks: at an instant, or between two.
    pub time: When,
    /// Whose force it is.
    pub pawl: String,
}

/// An instant, or an interval of them.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum When {
    /// At an instant.
    At(Num),
    /// Between two rational instants.
    Between {
        /// Not before.
        lo: String,
        /// Not after.
        hi: String,
    },
}

/// Forces of one pawl.
#[derive(Debug, Serialize, JsonSchema)]
pub struct PawlForces {
    /// Its name.
    pub name: String,
    /// Over its whole motion; null without a stiffness.
    pub peak: Option<PeakDocument>,
    /// A sliding segment each, in order of time.
    pub segments: Vec<SegmentForces>,
}

/// Forces along one sliding segment.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SegmentForces {
    /// When it begins.
    pub from: Num,
    /// When it ends.
    pub to: Num,
    /// In which phase.
    pub phase: usize,
    /// The contact.
    pub contact: ContactDocument,
    /// The contact force.
    pub force: Bound,
    /// The contact force without friction; null where the scene has none, or it was not asked for.
    pub force_without_friction: Option<Bound>,
    /// The torque at the hinge.
    pub torque: Bound,
    /// When the force peaks.
    pub time: When,
    /// The snap-fit handbook's formula beside the model, at the largest deflection; null where it
    /// was not asked for.
    pub handbook: Option<Handbook>,
}

/// What the root feels: the sum over the pawls.
#[derive(Debug, Serialize, JsonSchema)]
pub struct RootForces {
    /// The point of the root that torques are about, as drawn; it moves with the root.
    pub reference: [Num; 2],
    /// A phase each, in order.
    pub phases: Vec<PhaseForces>,
    /// Straight back from the end of the plan (the first direction of the control family), where
    /// the plan has no reverse of its own.
    pub way_back: Option<PhaseForces>,
}

/// The root's loads over one phase.
#[derive(Debug, Serialize, JsonSchema)]
pub struct PhaseForces {
    /// Which phase; null for the way back.
    pub phase: Option<usize>,
    /// When it begins; the way back has a clock of its own.
    pub from: Num,
    /// When it ends.
    pub to: Num,
    /// How the motion ended, where it ended in this phase.
    pub outcome: &'static str,
    /// The root's velocity.
    pub velocity: [Num; 2],
    /// With friction as the scene has it; null where it was not asked for.
    pub peak: Option<RootPeak>,
    /// Without friction; null where the scene has none, or it was not asked for.
    pub peak_without_friction: Option<RootPeak>,
    /// What the drive puts in; `unbounded` where friction holds at last with the spring wound;
    /// null where it was not asked for, or a limit stopped the search.
    pub work: Option<Bound>,
    /// Why the work is unbounded, or was not settled; null elsewhere.
    pub work_note: Option<String>,
    /// Without friction: what goes into the springs.
    pub work_without_friction: Option<Bound>,
    /// Spring energy set free by snaps; null where the work was not asked for.
    pub lost_in_snaps: Option<Bound>,
    /// Evenly spaced instants strictly inside the phase.
    pub history: Vec<Sample>,
}

impl PhaseForces {
    /// Whether a limit stopped the motion in it: what its peaks are then nobody knows.
    pub(super) fn stopped(&self) -> bool {
        self.outcome == OutcomeKind::Undecided.name()
    }
}

/// Suprema over a phase.
#[derive(Debug, Serialize, JsonSchema)]
pub struct RootPeak {
    /// Against the travel: what a drive has to push with.
    pub resistance: Bound,
    /// Along the travel: what it has to hold back.
    pub help: Bound,
    /// Size of the force.
    pub force: Bound,
    /// Size of the torque about the reference point.
    pub torque: Bound,
    /// When the resistance peaks; null where nothing resists.
    pub time: Option<When>,
}

/// All loads at one instant.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Sample {
    /// When.
    pub time: Num,
    /// Force on the root.
    pub force: [Bound; 2],
    /// Torque on the root about the reference point.
    pub torque: Bound,
    /// Force against the travel.
    pub resistance: Bound,
    /// The same without friction; null where the scene has none.
    pub resistance_without_friction: Option<Bound>,
    /// The pawls that are held away from rest then.
    pub pawls: Vec<PawlSample>,
}

/// One pawl at one instant.
#[derive(Debug, Serialize, JsonSchema)]
pub struct PawlSample {
    /// Its name.
    pub pawl: String,
    /// Its orientation in radians.
    pub theta: Bound,
    /// The spring's torque kθ.
    pub torque: Bound,
    /// The contact force.
    pub force: Bound,
}

/// Assembly against disassembly.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Comparison {
    /// The largest resistance of the phases that are no reverse.
    pub assembly: Bound,
    /// The largest resistance on the way back.
    pub disassembly: Bound,
    /// Disassembly over assembly; null where one of them is unbounded or zero.
    pub ratio: Option<Bound>,
    /// `assembly`, `disassembly` or `neither`.
    pub easier: &'static str,
}
