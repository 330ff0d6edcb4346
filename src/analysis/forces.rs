//! The result of `forces`: contact forces, what the root feels, the drive's work, and the
//! handbook's formula beside it (DP App. A).
//!
//! A pawl takes part where it has a stiffness; where none has, nothing is modelled and the result
//! says so. Peaks of single contacts come from [`super::peak`], those of the root, where the pawls
//! add up, from `drive`. The way back is run too where the plan itself does not go back, so that
//! assembly stands against disassembly.

use super::bound::Bound;
use super::classify::{Ask, family};
use super::document::contact;
use super::drive::{Extremes, Slide, extremes, instant, trace, work};
use super::escape::{Ground, Start};
use super::fix::Bits;
use super::handbook::{Handbook, handbook};
use super::load::{Part, Rig};
use super::peak::{Instant, Peak, Peaked, force, higher, torque};
use super::stretch::{Stretch, stretches};
use crate::geometry::Vec2;
use crate::motion::{Options, OutcomeKind, PlanError, Trajectory, simulate};
use crate::number::{Algebraic, Rat};
use crate::report::Num;
use crate::report::json::ContactDocument;
use crate::scene::{Motion, Scene};
use crate::slice::Time;
use schemars::JsonSchema;
use serde::Serialize;
use std::cell::RefCell;
use std::collections::VecDeque;

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
    /// What the drive puts in: null where it is not bounded, as where friction holds at last, or
    /// where it was not asked for.
    pub work: Option<Bound>,
    /// Without friction: what goes into the springs.
    pub work_without_friction: Option<Bound>,
    /// Spring energy set free by snaps; null where the work was not asked for.
    pub lost_in_snaps: Option<Bound>,
    /// Evenly spaced instants strictly inside the phase.
    pub history: Vec<Sample>,
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
    fn phases(&self) -> bool {
        self.root || self.work || self.draw || self.samples > 0
    }
}

/// Simulates a scene and encloses its forces, each within a relative 10^-digits.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn forces(scene: &Scene, wish: &Wish, ask: &Ask) -> Result<ForcesDocument, PlanError> {
    let options = Options {
        deadline: ask.deadline,
        ..Options::default()
    };
    let run = simulate(scene, &options)?;
    let modelled = scene.pawls.iter().any(|p| p.stiffness.is_some());
    let mut out = ForcesDocument {
        schema: "snapfit.forces/1",
        scene: scene.name.clone(),
        outcome: run.outcome.kind.name(),
        modelled,
        note: note(scene),
        peak: None,
        pawls: Vec::new(),
        root: None,
        comparison: None,
        drawing: Drawing::default(),
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
    let ground = Ground::new(scene, ask.deadline);
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

fn note(scene: &Scene) -> Option<String> {
    let without: Vec<&str> = scene
        .pawls
        .iter()
        .filter(|p| p.stiffness.is_none())
        .map(|p| p.name.as_str())
        .collect();
    match without.len() {
        0 => None,
        n if n == scene.pawls.len() => {
            Some("no pawl has a stiffness: no forces are modelled".to_owned())
        }
        _ => Some(format!(
            "without a stiffness, and so without forces: {}",
            without.join(", ")
        )),
    }
}

/// The point that torques on the root are about, as drawn.
fn reference(scene: &Scene) -> Vec2 {
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

/// One trajectory with its stretches.
struct Way<'a> {
    scene: &'a Scene,
    run: &'a Trajectory,
    slid: Vec<Stretch>,
    /// The highest contact force of each stretch; None without a stiffness.
    peaks: Vec<Option<Peaked>>,
    /// One a pawl: with friction, and without.
    rigs: Vec<Option<[Rig; 2]>>,
    goal: u32,
    wish: &'a Wish,
    mu: Rat,
    /// The last irrational instants that were written.
    clocks: RefCell<VecDeque<(usize, Algebraic, Num)>>,
}

/// How many instants are kept: those of a segment and its peak, and as many more.
const KEPT: usize = 6;

impl<'a> Way<'a> {
    fn new(scene: &'a Scene, ground: &Ground<'_>, run: &'a Trajectory, wish: &'a Wish) -> Way<'a> {
        let slid = stretches(scene, &ground.shapes, &ground.obstacles, run);
        let goal = (wish.digits.saturating_mul(10)).div_ceil(3) + 3;
        let mu = scene.friction.clone().unwrap_or_default();
        let at = reference(scene);
        let rigs = scene.pawls.iter().map(|p| {
            let rig = |mu: Rat| Rig {
                stiffness: p.stiffness.clone().unwrap_or_default(),
                mu,
                arm: &p.hinge - &at,
            };
            p.stiffness.as_ref()?;
            Some([rig(mu.clone()), rig(Rat::zero())])
        });
        Way {
            rigs: rigs.collect(),
            peaks: slid
                .iter()
                .map(|s| {
                    let k = scene.pawls[s.pawl].stiffness.as_ref()?;
                    Some(force(s, k, &mu, goal))
                })
                .collect(),
            scene,
            run,
            slid,
            goal,
            wish,
            mu,
            clocks: RefCell::default(),
        }
    }

    /// An instant of a phase on the plan's clock. Neighbouring segments and their peaks share their
    /// instants, and an irrational one is dear to write: the last few are kept.
    fn clock(&self, phase: usize, t: &Time) -> Num {
        let from = &self.run.phases[phase].from;
        if let Some(t) = t.as_rat() {
            return Num::of_rat(&(from + t));
        }
        let mut kept = self.clocks.borrow_mut();
        let exact = t.exact();
        if let Some((.., num)) = kept
            .iter()
            .find(|(k, e, _)| *k == phase && e.same_handle(exact))
        {
            return num.clone();
        }
        let num = if from.is_zero() {
            Num::of(exact)
        } else {
            Num::of(&t.affine(from, &Rat::one()))
        };
        if kept.len() == KEPT {
            kept.pop_front();
        }
        kept.push_back((phase, exact.clone(), num.clone()));
        num
    }

    fn between(&self, phase: usize, a: &Rat, b: &Rat) -> When {
        let from = &self.run.phases[phase].from;
        if a == b {
            return When::At(Num::of_rat(&(from + a)));
        }
        let [a, b] = super::bound::rounded(a, b, self.wish.digits.max(6));
        When::Between {
            lo: (from + &a).to_string(),
            hi: (from + &b).to_string(),
        }
    }

    fn when(&self, phase: usize, i: &Instant) -> When {
        match i {
            Instant::At(t) => When::At(self.clock(phase, t)),
            Instant::Between(a, b) => self.between(phase, a, b),
        }
    }

    /// Whether pawl i ended the motion: its force then grows past every bound.
    fn ended(&self, i: usize) -> bool {
        let end = &self.run.outcome;
        matches!(end.kind, OutcomeKind::Jammed | OutcomeKind::Stuck) && end.pawl == Some(i)
    }

    fn pawls(&self, doc: &mut ForcesDocument) {
        let digits = self.wish.digits;
        let mut overall: Option<(PeakDocument, Peak, Peak)> = None;
        for (i, pawl) in self.run.pawls.iter().enumerate() {
            let mut out = PawlForces {
                name: pawl.name.clone(),
                peak: None,
                segments: Vec::new(),
            };
            let Some(k) = &self.scene.pawls[i].stiffness else {
                doc.pawls.push(out);
                continue;
            };
            let mut best: Option<(Peaked, usize)> = None;
            let mut turned = Peak::zero();
            for (j, segment) in pawl.segments.iter().enumerate() {
                let Some(sliding) = &segment.sliding else {
                    continue;
                };
                let (mut push, mut twist) = (None, Peak::zero());
                let mut smooth: Option<Peaked> = None;
                let mut beside = None;
                for (s, p) in self.slid.iter().zip(&self.peaks) {
                    if s.pawl != i || s.segment != j {
                        continue;
                    }
                    let Some(p) = p else { continue };
                    push = Some(higher(push, p.clone()));
                    if self.wish.smooth && self.mu.sign() > 0 {
                        smooth = Some(higher(smooth, force(s, k, &Rat::zero(), self.goal)));
                    }
                    let t = torque(s, k, self.goal).peak;
                    if self.wish.handbook && t != Peak::zero() {
                        beside = handbook(s, k, &self.mu, digits).or(beside);
                    }
                    twist = twist.max(t);
                }
                let Some(mut push) = push else {
                    continue;
                };
                let end = &self.run.outcome;
                if self.ended(i) && segment.phase == end.phase && segment.to == end.time {
                    push = Peaked {
                        peak: Peak::Unbounded,
                        when: Instant::At(segment.to.clone()),
                    };
                }
                out.segments.push(SegmentForces {
                    from: self.clock(segment.phase, &segment.from),
                    to: self.clock(segment.phase, &segment.to),
                    phase: segment.phase,
                    contact: contact(self.scene, &sliding.contact),
                    force: Bound::of(&push.peak, digits),
                    force_without_friction: smooth.map(|p| Bound::of(&p.peak, digits)),
                    torque: Bound::of(&twist, digits),
                    time: self.when(segment.phase, &push.when),
                    handbook: beside,
                });
                turned = turned.max(twist);
                best = Some(match best {
                    None => (push, segment.phase),
                    Some((b, phase)) => {
                        let first = exceeds(&b.peak, &push.peak);
                        let phase = if first { phase } else { segment.phase };
                        (higher(Some(b), push), phase)
                    }
                });
            }
            if self.ended(i) && best.as_ref().is_none_or(|b| b.0.peak != Peak::Unbounded) {
                let held = Peaked {
                    peak: Peak::Unbounded,
                    when: Instant::At(self.run.outcome.time.clone()),
                };
                best = Some((held, self.run.outcome.phase));
            }
            let (push, phase) = best.unwrap_or((
                Peaked {
                    peak: Peak::zero(),
                    when: Instant::At(Time::from(Rat::zero())),
                },
                0,
            ));
            let peak = PeakDocument {
                force: Bound::of(&push.peak, digits),
                torque: Bound::of(&turned, digits),
                time: self.when(phase, &push.when),
                pawl: pawl.name.clone(),
            };
            out.peak = Some(peak.clone());
            doc.pawls.push(out);
            overall = Some(match overall {
                None => (peak, push.peak, turned),
                Some((old, force, torque)) => {
                    let first = exceeds(&force, &push.peak);
                    let shown = if first { old } else { peak };
                    (shown, force.max(push.peak), torque.max(turned))
                }
            });
        }
        doc.peak = overall.map(|(p, force, torque)| PeakDocument {
            force: Bound::of(&force, digits),
            torque: Bound::of(&torque, digits),
            ..p
        });
    }

    /// The slides of one phase, with friction or without.
    fn slides(&self, phase: usize, smooth: bool) -> Vec<Slide<'_>> {
        let mut out = Vec::new();
        // Only the root's search asks how high each force goes.
        let searched = self.wish.root;
        for (s, p) in self.slid.iter().zip(&self.peaks) {
            let Some(rig) = self.rigs[s.pawl].as_ref().filter(|_| s.phase == phase) else {
                continue;
            };
            let rig = &rig[usize::from(smooth)];
            let k = &rig.stiffness;
            let peak = if !searched {
                None
            } else if smooth && self.mu.sign() > 0 {
                Some(force(s, k, &rig.mu, 16).peak)
            } else {
                p.as_ref().map(|p| p.peak.clone())
            };
            let bound = match peak {
                Some(Peak::Within(_, hi)) => Some(hi),
                _ => None,
            };
            for part in Part::cut(s, rig.mu.sign() > 0) {
                out.push(Slide {
                    part,
                    rig,
                    bound: bound.clone(),
                });
            }
        }
        out
    }

    fn phase(&self, k: usize, drawing: &mut Drawing) -> PhaseForces {
        let digits = self.wish.digits;
        let phase = &self.run.phases[k];
        let end = &self.run.outcome;
        let here = end.phase == k;
        let wish = self.wish;
        let rubbed = self.slides(k, false);
        let high = wish.root.then(|| {
            let mut high = extremes(&rubbed, self.goal);
            let by = end.pawl.filter(|i| here && self.ended(*i));
            if by.is_some_and(|i| self.rigs[i].is_some()) {
                // Held for good: no force moves it on.
                high.resistance = Peak::Unbounded;
                high.force = Peak::Unbounded;
                high.torque = Peak::Unbounded;
            }
            high
        });
        let rubs = self.mu.sign() > 0;
        let smooth = if rubs {
            self.slides(k, true)
        } else {
            Vec::new()
        };
        let without = (rubs && wish.root && wish.smooth).then(|| extremes(&smooth, self.goal));
        let spent = |slides: &[Slide<'_>]| {
            slides
                .iter()
                .try_fold([Rat::zero(), Rat::zero()], |sum, s| {
                    let [lo, hi] = work(s, self.goal)?;
                    Some([&sum[0] + &lo, &sum[1] + &hi])
                })
        };
        let bound = |w: [Rat; 2]| Bound::within(&w[0], &w[1], digits);
        if self.wish.draw {
            drawing.phases.push(self.drawn(k, &rubbed, &smooth));
        }
        PhaseForces {
            phase: Some(k),
            from: Num::of_rat(&phase.from),
            to: self.clock(k, &phase.to),
            outcome: if here { end.kind.name() } else { "completed" },
            velocity: [
                Num::of_rat(&phase.velocity.x),
                Num::of_rat(&phase.velocity.y),
            ],
            peak: high.map(|e| self.root_peak(k, &e)),
            peak_without_friction: without.map(|e| self.root_peak(k, &e)),
            work: wish.work.then(|| spent(&rubbed).map(bound)).flatten(),
            work_without_friction: (rubs && wish.work && wish.smooth)
                .then(|| spent(&smooth).map(bound))
                .flatten(),
            lost_in_snaps: wish.work.then(|| bound(self.lost(k))),
            history: self.history(k, &rubbed, &smooth),
        }
    }

    fn root_peak(&self, phase: usize, e: &Extremes) -> RootPeak {
        let of = |p: &Peak| Bound::of(p, self.wish.digits);
        let when = e.when.as_ref();
        RootPeak {
            resistance: of(&e.resistance),
            help: of(&e.help),
            force: of(&e.force),
            torque: of(&e.torque),
            time: when.map(|[a, b]| self.between(phase, a, b)),
        }
    }

    /// Spring energy that snaps set free: ½k(θ² before − θ² after).
    fn lost(&self, phase: usize) -> [Rat; 2] {
        let b = Bits(u64::from(self.goal) + 48);
        let mut sum = b.int(0);
        for (pawl, rig) in self.run.pawls.iter().zip(&self.rigs) {
            let Some([rig, _]) = rig else { continue };
            for e in pawl.events.iter().filter(|e| e.phase == phase) {
                let Some(to) = &e.to else { continue };
                let energy = |a: &crate::motion::Angle| {
                    let (lo, hi) = a.x.enclosure(b.0 as u32);
                    let t = super::peak::theta(&b.hull(&lo, &hi), a.half_turn, b);
                    t.mul(&t).mul(&b.rat(&(&rig.stiffness / &Rat::from(2))))
                };
                sum = sum.add(&energy(&e.angle).sub(&energy(to)));
            }
        }
        [sum.lo(), sum.hi()]
    }

    fn history(&self, k: usize, rubbed: &[Slide<'_>], smooth: &[Slide<'_>]) -> Vec<Sample> {
        let digits = self.wish.digits;
        let b = Bits(u64::from(self.goal) + 48);
        let phase = &self.run.phases[k];
        let length = match phase.to.as_rat() {
            Some(t) => t.clone(),
            None => phase.to.exact().enclosure(64).0,
        };
        let n = i64::from(self.wish.samples);
        (1..=n)
            .filter_map(|i| {
                let t = &length * &Rat::frac(2 * i - 1, 2 * n);
                let now = instant(rubbed, &t, b)?;
                let free = instant(smooth, &t, b).filter(|_| !smooth.is_empty());
                let of = |f: &super::fix::Fix| Bound::of_fix(f, digits);
                let pawls = now.pawls.iter().map(|(i, angle, force)| {
                    let slide = &rubbed[*i];
                    PawlSample {
                        pawl: self.run.pawls[slide.part.stretch.pawl].name.clone(),
                        theta: of(angle),
                        torque: of(&angle.mul(&b.rat(&slide.rig.stiffness))),
                        force: of(force),
                    }
                });
                Some(Sample {
                    time: Num::of_rat(&(&phase.from + &t)),
                    pawls: pawls.collect(),
                    force: now.force.each_ref().map(of),
                    torque: of(&now.torque),
                    resistance: of(&now.resistance),
                    resistance_without_friction: free.map(|f| of(&f.resistance)),
                })
            })
            .collect()
    }

    fn drawn(&self, k: usize, rubbed: &[Slide<'_>], smooth: &[Slide<'_>]) -> DrawnPhase {
        let phase = &self.run.phases[k];
        let speed = phase.velocity.norm2().nearest_f64().unwrap_or(0.0).sqrt();
        let travel = |runs: Vec<Vec<[f64; 2]>>| -> Vec<Vec<[f64; 2]>> {
            let scaled = |run: Vec<[f64; 2]>| run.iter().map(|p| [p[0] * speed, p[1]]).collect();
            runs.into_iter().map(scaled).collect()
        };
        let end = &self.run.outcome;
        let stopped = end.phase == k && end.pawl.is_some_and(|i| self.ended(i));
        let to = phase.to.interval().hi;
        let handbook = self.slid.iter().filter(|s| s.phase == k).filter_map(|s| {
            let stiffness = self.scene.pawls[s.pawl].stiffness.as_ref()?;
            let h = handbook(s, stiffness, &self.mu, 6)?;
            let at = s.t[usize::from(h.late)].interval().hi;
            Some([at * speed, h.formula?.approx()])
        });
        DrawnPhase {
            name: format!(
                "velocity ({}, {}){}",
                phase.velocity.x,
                phase.velocity.y,
                if end.phase == k && end.kind != OutcomeKind::Completed {
                    format!(", {}", end.kind.name())
                } else {
                    String::new()
                }
            ),
            length: to * speed,
            back: self.scene.motions.get(k) == Some(&Motion::Reverse),
            handbook: handbook.collect(),
            rubbed: travel(trace(rubbed, 40)),
            smooth: travel(trace(smooth, 40)),
            unbounded: stopped.then_some(to * speed),
        }
    }
}

/// Whether `higher` keeps the instant of the first of two peaks.
fn exceeds(a: &Peak, b: &Peak) -> bool {
    match (a, b) {
        (Peak::Unbounded, _) => true,
        (_, Peak::Unbounded) => false,
        (Peak::Within(x, _), Peak::Within(y, _)) => x >= y,
    }
}
