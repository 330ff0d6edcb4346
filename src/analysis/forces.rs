//! The verb `forces`: contact forces, what the root feels, the drive's work, and the handbook's
//! formula beside it (DP App. A).
//!
//! A pawl takes part where it has a stiffness; where none has, nothing is modelled and the result
//! says so. The plan is enclosed by `way`; the way back is run too where the plan itself
//! does not go back, so that assembly stands against disassembly.

use super::bound::Bound;
use super::classify::{Ask, family};
use super::escape::{Ground, Start};
pub use super::force_document::{
    Comparison, Drawing, DrawnPhase, ForcesDocument, PawlForces, PawlSample, PeakDocument,
    PhaseForces, RootForces, RootPeak, Sample, SegmentForces, When,
};
use super::peak::Peak;
use super::way::Way;
use crate::geometry::Vec2;
use crate::motion::{OutcomeKind, PlanError, Trajectory, simulate};
use crate::number::Rat;
use crate::report::Num;
use crate::scene::{Motion, Scene};

/// What to enclose. The peaks of force and torque, by pawl and segment, always are; all else
/// costs searches of its own.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// Significant decimals of every enclosure.
    pub digits: u32,
    /// Instants of the history a phase.
    pub samples: u32,
    /// What the root feels: its peaks a phase and on the way back.
    pub root: bool,
    /// The drive's work.
    pub work: bool,
    /// Every peak without friction too.
    pub smooth: bool,
    /// The handbook's formula.
    pub handbook: bool,
    /// Collect the points of a picture too.
    pub draw: bool,
}

impl Default for Wish {
    fn default() -> Wish {
        Wish {
            digits: 6,
            samples: 0,
            root: false,
            work: false,
            smooth: false,
            handbook: false,
            draw: false,
        }
    }
}

impl Wish {
    /// All that can be enclosed, with so many digits and samples; no picture.
    pub fn all(digits: u32, samples: u32) -> Wish {
        Wish {
            digits,
            samples,
            root: true,
            work: true,
            smooth: true,
            handbook: true,
            draw: false,
        }
    }
    /// Whether anything is wanted that is told phase by phase.
    pub(super) fn phases(&self) -> bool {
        self.root || self.work || self.draw || self.samples > 0
    }
}

/// Simulates a scene and encloses its forces, each within a relative 10^-digits.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn forces(scene: &Scene, wish: &Wish, ask: &Ask) -> Result<ForcesDocument, PlanError> {
    let run = simulate(scene, &ask.options())?;
    let modelled = scene.pawls.iter().any(|p| p.stiffness.is_some());
    let mut out = ForcesDocument {
        schema: "snapfit.forces/1",
        scene: scene.name.clone(),
        outcome: run.outcome.kind.name(),
        modelled,
        digits: wish.digits,
        note: note(scene, &run),
        peak: None,
        pawls: Vec::new(),
        root: None,
        comparison: None,
        drawing: Drawing::default(),
        undecided: run.outcome.kind == OutcomeKind::Undecided,
    };
    if !modelled {
        out.pawls = run
            .pawls
            .iter()
            .map(|p| PawlForces {
                name: p.name.clone(),
                peak: None,
                segments: Vec::new(),
            })
            .collect();
        return Ok(out);
    }
    let ground = Ground::asked(scene, ask);
    let way = Way::new(scene, &ground, &run, wish);
    way.pawls(&mut out);
    if !wish.phases() {
        return Ok(out);
    }
    let mut phases: Vec<PhaseForces> = Vec::new();
    for k in 0..run.phases.len() {
        phases.push(way.phase(k, &mut out.drawing));
    }
    let goes_back = scene.motions.contains(&Motion::Reverse);
    let mut way_back = None;
    if !goes_back
        && (wish.root || wish.draw)
        && let (Some(start), Some((directions, distance2))) =
            (Start::after(&run), family(scene, &run))
        && let Some(v) = directions.first()
    {
        let back = ground.escape(&start, v, &distance2, scene.friction.as_ref());
        let mut phase = Way::new(scene, &ground, &back, wish).phase(0, &mut out.drawing);
        phase.phase = None;
        way_back = Some(phase);
    }
    if ground.late() {
        out.undecided = true;
        let late = "the time was up: what the root feels is enclosed as far as it was searched";
        out.note = Some(match out.note.take() {
            Some(note) => format!("{note}; {late}"),
            None => late.to_owned(),
        });
    }
    out.comparison = comparison(scene, &phases, way_back.as_ref(), wish.digits);
    let reference = reference(scene);
    out.root = Some(RootForces {
        reference: [Num::of_rat(&reference.x), Num::of_rat(&reference.y)],
        phases,
        way_back,
    });
    if let Some(last) = out.drawing.phases.last_mut().filter(|_| !goes_back) {
        last.back = out.root.as_ref().is_some_and(|r| r.way_back.is_some());
    }
    Ok(out)
}

/// The largest resistance at the root along a motion of one phase; None where the time ran out.
pub(super) fn resistance(scene: &Scene, ground: &Ground<'_>, run: &Trajectory) -> Option<Peak> {
    let wish = Wish {
        root: true,
        ..Wish::default()
    };
    let way = Way::new(scene, ground, run, &wish);
    let peak = way.resistance(0);
    (!ground.late()).then_some(peak)
}

/// What a reader of the peaks has to know.
fn note(scene: &Scene, run: &Trajectory) -> Option<String> {
    let without: Vec<&str> = scene
        .pawls
        .iter()
        .filter(|p| p.stiffness.is_none())
        .map(|p| p.name.as_str())
        .collect();
    if without.len() == scene.pawls.len() {
        return Some("no pawl has a stiffness: no forces are modelled".to_owned());
    }
    let mut notes = Vec::new();
    if !without.is_empty() {
        notes.push(format!(
            "without a stiffness, and so without forces: {}",
            without.join(", ")
        ));
    }
    let met = match run.outcome.kind {
        OutcomeKind::Undecided => "the motion was not followed to its end",
        OutcomeKind::Bifurcated => "the motion forks",
        _ => "",
    };
    if !met.is_empty() {
        notes.push(format!("{met}: the peaks are those up to there"));
    }
    (!notes.is_empty()).then(|| notes.join("; "))
}

/// The point that torques on the root are about, as drawn.
pub(super) fn reference(scene: &Scene) -> Vec2 {
    let given = scene.root.as_ref().and_then(|r| r.reference.clone());
    given.unwrap_or_else(|| scene.pawls[0].hinge.clone())
}

fn comparison(
    scene: &Scene,
    phases: &[PhaseForces],
    way_back: Option<&PhaseForces>,
    digits: u32,
) -> Option<Comparison> {
    let is_back = |p: &&PhaseForces| {
        p.phase
            .is_some_and(|k| scene.motions.get(k) == Some(&Motion::Reverse))
    };
    let read = |b: &Bound| match b {
        Bound::Unbounded(_) => Peak::Unbounded,
        Bound::Within { lo, hi } => {
            let of = |s: &String| s.parse::<Rat>().unwrap_or_default();
            Peak::Within(of(lo), of(hi))
        }
    };
    let most = |list: &mut dyn Iterator<Item = &PhaseForces>| {
        list.filter_map(|p| p.peak.as_ref())
            .map(|p| read(&p.resistance))
            .reduce(Peak::max)
    };
    // A way that was not run to its end has no largest resistance to compare.
    if phases.iter().chain(way_back).any(PhaseForces::stopped) {
        return None;
    }
    let there = most(&mut phases.iter().filter(|p| !is_back(p)))?;
    let back = most(&mut phases.iter().filter(is_back).chain(way_back))?;
    let (ratio, easier) = match (&there, &back) {
        (Peak::Unbounded, Peak::Unbounded) => (None, "neither"),
        (Peak::Unbounded, _) => (None, "disassembly"),
        (_, Peak::Unbounded) => (None, "assembly"),
        (Peak::Within(a, b), Peak::Within(c, d)) => {
            let ratio = (a.sign() > 0).then(|| Bound::within(&(c / b), &(d / a), digits));
            let easier = match () {
                () if b < c => "assembly",
                () if d < a => "disassembly",
                () => "neither",
            };
            (ratio, easier)
        }
    };
    Some(Comparison {
        assembly: Bound::of(&there, digits),
        disassembly: Bound::of(&back, digits),
        ratio,
        easier,
    })
}
