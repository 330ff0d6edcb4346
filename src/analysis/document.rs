//! The results of `classify` and `forces` as the contract writes them.

use super::classify::{Ask, Direction, Relative, Verdict, relative};
use super::escape::Ground;
use super::peak::{Instant, Peak, Peaked, force, higher, torque};
use super::stretch::stretches;
use super::total::{Total, total};
use crate::contact::{Contact, ContactKind};
use crate::geometry::Vec2;
use crate::motion::{Options, OutcomeKind, PlanError, Trajectory, simulate};
use crate::number::Rat;
use crate::report::Num;
use crate::report::json::ContactDocument;
use crate::scene::{Motion, Scene};
use crate::slice::Time;
use serde::Serialize;

/// The result of `classify`.
#[derive(Debug, Serialize)]
pub struct ClassifyDocument {
    /// `snapfit.classify/1`.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// The verdict; null where there is none, see `reason`.
    pub class: Option<&'static str>,
    /// `total` where that was asked and is not none, else `relative`; null for none.
    pub extent: Option<&'static str>,
    /// In words.
    pub reason: String,
    /// The verdict on the family of directions.
    pub relative: Option<&'static str>,
    /// The verdict on the whole circle, where asked.
    pub total: Option<&'static str>,
    /// The infimum of the μ that locks the family; null where none does or none is needed.
    pub critical_friction: Option<Num>,
    /// The infimum of the μ at which the plan itself sticks.
    pub critical_friction_forward: Option<Num>,
    /// What the verdict rests on.
    pub assumed: Vec<&'static str>,
    /// What was left out of the model, because it was not needed or not given.
    pub not_modelled: Vec<&'static str>,
    /// The family, in order.
    pub directions: Vec<DirectionDocument>,
    /// Arcs that cover the circle, each proven at least as firmly blocked as it says.
    pub cover: Vec<ArcDocument>,
    /// A direction that gets out, where the circle was asked and one was found.
    pub escape: Option<[Num; 2]>,
    /// Radians of directions not proven at least as firmly blocked as the class.
    pub undecided_width: Option<f64>,
}

/// One direction of the family.
#[derive(Debug, Serialize)]
pub struct DirectionDocument {
    /// The root's velocity.
    pub velocity: [Num; 2],
    /// How firmly it is blocked.
    pub verdict: &'static str,
    /// How the motion that decided ended, its clock starting at the end of the plan.
    pub outcome: StopDocument,
    /// Whether friction was in that motion's model.
    pub friction_modelled: bool,
    /// The infimum of the μ that locks this direction.
    pub critical_friction: Option<Num>,
    /// The highest contact force of the escape, where it was held against the limit.
    pub peak_force: Option<Bound>,
    /// A plan that gets out: append it to the scene's.
    pub plan: Option<String>,
}

/// How a motion ended.
#[derive(Debug, Serialize)]
pub struct StopDocument {
    /// As in a result of `simulate`.
    pub kind: &'static str,
    /// When.
    pub time: Num,
    /// The pawl that ended it.
    pub pawl: Option<String>,
    /// The last event of that pawl.
    pub event: Option<&'static str>,
    /// Who touches whom then.
    pub contacts: Vec<ContactDocument>,
}

/// An arc of directions, counter-clockwise between two unit vectors.
#[derive(Debug, Serialize)]
pub struct ArcDocument {
    /// Begin, exactly.
    pub from: [String; 2],
    /// End, exactly.
    pub to: [String; 2],
    /// What is proven; `undecided` where nothing is.
    pub verdict: &'static str,
}

/// A supremum.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Bound {
    /// Past every bound.
    Unbounded(Unbounded),
    /// Between two exact rationals.
    Within {
        /// At least this.
        lo: String,
        /// At most this.
        hi: String,
    },
}

/// The word for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Unbounded {
    /// Past every bound.
    #[serde(rename = "unbounded")]
    Unbounded,
}

impl Bound {
    fn of(p: &Peak) -> Bound {
        match p {
            Peak::Unbounded => Bound::Unbounded(Unbounded::Unbounded),
            Peak::Within(lo, hi) => Bound::Within {
                lo: lo.to_string(),
                hi: hi.to_string(),
            },
        }
    }
}

fn pair(v: &Vec2) -> [Num; 2] {
    [Num::of_rat(&v.x), Num::of_rat(&v.y)]
}

fn instant(t: &Time) -> Num {
    t.as_rat().map_or_else(|| Num::of(t.exact()), Num::of_rat)
}

fn contact(scene: &Scene, contact: &Contact) -> ContactDocument {
    match *contact {
        Contact::Limit(limit) => ContactDocument::Limit { limit },
        Contact::Obstacle {
            obstacle,
            kind,
            ring,
            obstacle_feature,
            pawl_feature,
        } => {
            let obstacle = scene.obstacles[obstacle as usize].name.clone();
            let hole = ring.checked_sub(1);
            match kind {
                ContactKind::B => ContactDocument::B {
                    pawl_vertex: pawl_feature,
                    obstacle,
                    obstacle_edge: obstacle_feature,
                    hole,
                },
                ContactKind::A => ContactDocument::A {
                    pawl_edge: pawl_feature,
                    obstacle,
                    obstacle_vertex: obstacle_feature,
                    hole,
                },
            }
        }
    }
}

fn stop(scene: &Scene, run: &Trajectory) -> StopDocument {
    let outcome = &run.outcome;
    let pawl = outcome.pawl.map(|i| &run.pawls[i]);
    let last = pawl.and_then(|p| p.events.last());
    StopDocument {
        kind: outcome.kind.name(),
        time: instant(&outcome.time),
        pawl: pawl.map(|p| p.name.clone()),
        event: last.map(|e| e.kind.name()),
        contacts: last.map_or_else(Vec::new, |e| {
            e.contacts.iter().map(|c| contact(scene, c)).collect()
        }),
    }
}

impl ClassifyDocument {
    /// Whether a limit kept the question open: of the family, or of part of the circle.
    pub fn undecided(&self) -> bool {
        let open = self.class.is_none()
            && self
                .directions
                .iter()
                .any(|d| d.outcome.kind == "undecided");
        open || self.undecided_width.is_some_and(|w| w > 0.0)
    }
}

/// Decides a scene's class: the family of directions and, where asked, the circle.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn classify(scene: &Scene, ask: &Ask) -> Result<ClassifyDocument, PlanError> {
    let family = relative(scene, ask)?;
    let wants = scene.classify.as_ref().is_some_and(|c| c.total);
    let circle = family.start.as_ref().filter(|_| wants).map(|start| {
        let ground = Ground::new(scene, ask.deadline);
        total(&ground, start, family.class)
    });
    Ok(written(scene, &family, circle.as_ref()))
}

fn written(scene: &Scene, family: &Relative, circle: Option<&Total>) -> ClassifyDocument {
    let whole = circle.and_then(|t| t.class).filter(|c| *c != Verdict::None);
    let class = whole.or(family.class);
    let extent = match (class, whole) {
        (None | Some(Verdict::None), _) => None,
        (_, Some(_)) => Some("total"),
        _ => Some("relative"),
    };
    let undecided = circle.map(|t| t.undecided_width);
    let reason = reason(scene, family, circle);
    let rubbed = family.directions.iter().any(|d| d.with_friction);
    let pushed = family.directions.iter().any(|d| d.peak.is_some());
    let mut assumed = vec![
        "rigid planar bodies, straight quasistatic translation of the root",
        "each pawl is pulled towards rest; pawls meet neither each other nor the root",
    ];
    let mut not_modelled = Vec::new();
    let mut place = |used: bool, what, without| {
        if used {
            assumed.push(what);
        } else {
            not_modelled.push(without);
        }
    };
    place(
        rubbed,
        "Coulomb friction, one coefficient throughout",
        "friction",
    );
    place(
        pushed,
        "linear torsional springs; the force limit bounds each contact force",
        "stiffness and forces",
    );
    place(
        scene.root.is_some(),
        "the root blocks where it collides",
        "root collision",
    );
    ClassifyDocument {
        schema: "snapfit.classify/1",
        scene: scene.name.clone(),
        class: class.map(Verdict::name),
        extent,
        reason,
        relative: family.class.map(Verdict::name),
        total: circle.and_then(|t| t.class).map(Verdict::name),
        critical_friction: family.critical.as_ref().map(Num::of),
        critical_friction_forward: family.critical_forward.as_ref().map(Num::of),
        assumed,
        not_modelled,
        directions: family
            .directions
            .iter()
            .map(|d| direction(scene, d))
            .collect(),
        cover: circle.map_or_else(Vec::new, |t| {
            t.cover
                .iter()
                .map(|a| {
                    let text = |v: &Vec2| [v.x.to_string(), v.y.to_string()];
                    let [from, to] = a.ends();
                    ArcDocument {
                        from: text(&from),
                        to: text(&to),
                        verdict: a.verdict.map_or("undecided", Verdict::name),
                    }
                })
                .collect()
        }),
        escape: circle.and_then(|t| t.escape.as_ref()).map(pair),
        undecided_width: undecided,
    }
}

fn direction(scene: &Scene, d: &Direction) -> DirectionDocument {
    let out = d.run.outcome.kind == OutcomeKind::Completed;
    let plan = out.then(|| {
        let lasted = d.run.outcome.time.interval().hi;
        let lasted = d
            .run
            .outcome
            .time
            .as_rat()
            .cloned()
            .unwrap_or_else(|| Rat::from_f64(lasted));
        format!(
            "[[motion]]\nvelocity = [\"{}\", \"{}\"]\nduration = \"{lasted}\"\n",
            d.velocity.x, d.velocity.y
        )
    });
    DirectionDocument {
        velocity: pair(&d.velocity),
        verdict: d.verdict.name(),
        outcome: stop(scene, &d.run),
        friction_modelled: d.with_friction,
        critical_friction: d.critical.as_ref().map(|c| Num::of(&c.0)),
        peak_force: d.peak.as_ref().map(|p| Bound::of(&p.0.peak)),
        plan,
    }
}

fn reason(scene: &Scene, family: &Relative, circle: Option<&Total>) -> String {
    let end = &family.forward.outcome;
    if family.start.is_none() {
        return format!("the plan does not complete: {}", end.kind.name());
    }
    let Some(weakest) = family.directions.iter().min_by_key(|d| d.verdict) else {
        return "no direction to decide".to_owned();
    };
    let way = format!("({}, {})", weakest.velocity.x, weakest.velocity.y);
    let mut text = match weakest.verdict {
        Verdict::None if weakest.open => {
            format!(
                "along {way} the motion ends {}: not proven blocked",
                weakest.run.outcome.kind.name()
            )
        }
        Verdict::None => format!("along {way} it gets out"),
        Verdict::Force => format!("along {way} it gets out only past the force limit"),
        _ => {
            let by = weakest
                .run
                .outcome
                .pawl
                .map(|i| scene.pawls[i].name.as_str());
            let end = weakest.run.outcome.kind.name();
            format!("along {way} it ends {end}, by {}", by.unwrap_or("the root"))
        }
    };
    if let Some(t) = circle {
        match (&t.escape, t.class) {
            (Some(w), _) => text += &format!("; along ({}, {}) it gets out", w.x, w.y),
            (None, Some(c)) if t.undecided_width == 0.0 => {
                text += &format!("; every direction is blocked, at least by {}", c.name());
            }
            _ => text += &format!("; {} rad of directions are not decided", t.undecided_width),
        }
    }
    text
}

/// The result of `forces`.
#[derive(Debug, Serialize)]
pub struct ForcesDocument {
    /// `snapfit.forces/1`.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// How the motion ended.
    pub outcome: &'static str,
    /// Over the whole motion and all pawls; null where no pawl has a stiffness.
    pub peak: Option<PeakDocument>,
    /// The same a pawl.
    pub pawls: Vec<PawlForces>,
}

/// A peak of force and one of torque.
#[derive(Clone, Debug, Serialize)]
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
#[derive(Clone, Debug, Serialize)]
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
#[derive(Debug, Serialize)]
pub struct PawlForces {
    /// Its name.
    pub name: String,
    /// Over its whole motion; null without a stiffness.
    pub peak: Option<PeakDocument>,
    /// A sliding segment each, in order of time.
    pub segments: Vec<SegmentForces>,
}

/// Forces along one sliding segment.
#[derive(Debug, Serialize)]
pub struct SegmentForces {
    /// When it begins.
    pub from: Num,
    /// When it ends.
    pub to: Num,
    /// The contact.
    pub contact: ContactDocument,
    /// The contact force.
    pub force: Bound,
    /// The torque at the hinge.
    pub torque: Bound,
    /// When the force peaks.
    pub time: When,
}

/// Simulates a scene and encloses its forces, each within a relative 10^-`digits`.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn forces(scene: &Scene, digits: u32, ask: &Ask) -> Result<ForcesDocument, PlanError> {
    let options = Options {
        deadline: ask.deadline,
        ..Options::default()
    };
    let run = simulate(scene, &options)?;
    let ground = Ground::new(scene, ask.deadline);
    let slid = stretches(scene, &ground.shapes, &ground.obstacles, &run);
    let goal = (digits.saturating_mul(10)).div_ceil(3) + 2;
    let zero = Rat::zero();
    let mu = scene.friction.as_ref().unwrap_or(&zero);
    let clock = |phase: usize, t: &Time| match t.as_rat() {
        Some(t) => Num::of_rat(&(&run.phases[phase].from + t)),
        None => Num::of(&t.affine(&run.phases[phase].from, &Rat::one())),
    };
    let when = |phase: usize, i: &Instant| match i {
        Instant::At(t) => When::At(clock(phase, t)),
        Instant::Between(a, b) => {
            let from = &run.phases[phase].from;
            When::Between {
                lo: (from + a).to_string(),
                hi: (from + b).to_string(),
            }
        }
    };
    let ended = |i: usize| {
        matches!(run.outcome.kind, OutcomeKind::Jammed | OutcomeKind::Stuck)
            && run.outcome.pawl == Some(i)
    };
    let mut pawls = Vec::new();
    let mut overall: Option<(PeakDocument, Peak, Peak)> = None;
    for (i, pawl) in run.pawls.iter().enumerate() {
        let mut out = PawlForces {
            name: pawl.name.clone(),
            peak: None,
            segments: Vec::new(),
        };
        let Some(k) = &scene.pawls[i].stiffness else {
            pawls.push(out);
            continue;
        };
        let mut best: Option<(Peaked, usize)> = None;
        let mut turned = Peak::zero();
        for (j, segment) in pawl.segments.iter().enumerate() {
            let Some(sliding) = &segment.sliding else {
                continue;
            };
            let (mut push, mut twist) = (None, Peak::zero());
            for s in slid.iter().filter(|s| s.pawl == i && s.segment == j) {
                push = Some(higher(push, force(s, k, mu, goal)));
                twist = twist.max(torque(s, k, goal).peak);
            }
            let Some(mut push) = push else {
                continue;
            };
            // The motion ends held: the force grows past every bound.
            if ended(i) && segment.phase == run.outcome.phase && segment.to == run.outcome.time {
                push = Peaked {
                    peak: Peak::Unbounded,
                    when: Instant::At(segment.to.clone()),
                };
            }
            out.segments.push(SegmentForces {
                from: clock(segment.phase, &segment.from),
                to: clock(segment.phase, &segment.to),
                contact: contact(scene, &sliding.contact),
                force: Bound::of(&push.peak),
                torque: Bound::of(&twist),
                time: when(segment.phase, &push.when),
            });
            turned = turned.max(twist);
            best = Some(match best {
                None => (push, segment.phase),
                Some((b, phase)) => {
                    let first = exceeds(&b.peak, &push.peak);
                    (
                        higher(Some(b), push),
                        if first { phase } else { segment.phase },
                    )
                }
            });
        }
        if ended(i) && best.as_ref().is_none_or(|b| b.0.peak != Peak::Unbounded) {
            let held = Peaked {
                peak: Peak::Unbounded,
                when: Instant::At(run.outcome.time.clone()),
            };
            best = Some((held, run.outcome.phase));
        }
        let (push, phase) = best.unwrap_or((
            Peaked {
                peak: Peak::zero(),
                when: Instant::At(Time::from(Rat::zero())),
            },
            0,
        ));
        let peak = PeakDocument {
            force: Bound::of(&push.peak),
            torque: Bound::of(&turned),
            time: when(phase, &push.when),
            pawl: pawl.name.clone(),
        };
        out.peak = Some(peak.clone());
        pawls.push(out);
        overall = Some(match overall {
            None => (peak, push.peak, turned),
            Some((old, force, torque)) => {
                let first = exceeds(&force, &push.peak);
                (
                    if first { old } else { peak },
                    force.max(push.peak),
                    torque.max(turned),
                )
            }
        });
    }
    let peak = overall.map(|(p, force, torque)| PeakDocument {
        force: Bound::of(&force),
        torque: Bound::of(&torque),
        ..p
    });
    Ok(ForcesDocument {
        schema: "snapfit.forces/1",
        scene: scene.name.clone(),
        outcome: run.outcome.kind.name(),
        peak,
        pawls,
    })
}

/// Whether `higher` keeps the instant of the first of two peaks.
fn exceeds(a: &Peak, b: &Peak) -> bool {
    match (a, b) {
        (Peak::Unbounded, _) => true,
        (_, Peak::Unbounded) => false,
        (Peak::Within(x, _), Peak::Within(y, _)) => x >= y,
    }
}

/// The scene with a way out appended to its plan, which can be simulated.
pub fn with_motion(scene: &Scene, velocity: &Vec2, duration: &Rat) -> Scene {
    let mut longer = scene.clone();
    longer.motions.push(Motion::Translate {
        velocity: velocity.clone(),
        duration: Some(duration.clone()),
        until_root_collision: false,
    });
    longer
}
