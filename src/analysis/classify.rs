//! Motion diodes (DP §3.2, §4.4): does it lock, against which motions, and by what?
//!
//! *Model only what a verdict needs.* Each direction of the family is first run without friction
//! and without stiffness; only the spring's pull towards rest stays. If that motion jams or
//! the root collides, the direction is blocked kinematically, whatever μ and k are. Else friction
//! is put in, where the scene gives one; else the contact force of the escape is held against
//! the limit, where a stiffness and a limit are given. A family is as weak as its weakest
//! direction.

use super::critical::least_friction;
use super::escape::{Ground, Start};
use super::forces::resistance;
use super::peak::{Peak, Peaked, force, higher};
use super::stretch::{Stretch, stretches};
use crate::geometry::Vec2;
use crate::motion::{Arithmetic, Method, Options, OutcomeKind, PlanError, Trajectory, simulate};
use crate::number::{Algebraic, Rat};
use crate::scene::{Motion, Scene};
use std::time::Instant;

/// How firmly a direction or a family is locked, the weakest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Verdict {
    /// There is a way out.
    None,
    /// The way out needs a force past the limit.
    Force,
    /// Friction holds.
    Friction,
    /// The shapes alone hold.
    Kinematic,
}

impl Verdict {
    /// The contract's word for it.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::None => "none",
            Verdict::Force => "force",
            Verdict::Friction => "friction",
            Verdict::Kinematic => "kinematic",
        }
    }
    /// The verdict that a word means.
    pub fn from_name(name: &str) -> Option<Verdict> {
        use Verdict::{Force, Friction, Kinematic, None as Free};
        [Free, Force, Friction, Kinematic]
            .into_iter()
            .find(|v| v.name() == name)
    }
}

/// What one direction meets.
#[derive(Debug)]
pub struct Direction {
    /// The root's velocity.
    pub velocity: Vec2,
    /// How firmly it is blocked.
    pub verdict: Verdict,
    /// The motion that decided: without friction for a kinematic verdict, else with all that the
    /// scene models. Its clock begins at the end of the plan.
    pub run: Trajectory,
    /// Whether friction was in the model of that motion.
    pub with_friction: bool,
    /// The highest contact force of that motion over all pawls, where it was asked for.
    pub peak: Option<(Peaked, usize)>,
    /// The largest push against the travel that the root needs in that motion, all pawls
    /// together, where it ran its length and critical values were asked for.
    pub root_force: Option<Peak>,
    /// The infimum of the μ that locks this direction, with the pawl that does it; None where it
    /// is blocked without friction, or no μ does.
    pub critical: Option<(Algebraic, usize)>,
    /// The motion met a limit of time, or the model leaves its course open: the verdict is only
    /// what is proven.
    pub open: bool,
}

/// The verdict on a family of directions.
#[derive(Debug)]
pub struct Relative {
    /// Why there is no verdict: the plan does not complete.
    pub forward: Trajectory,
    /// The weakest verdict; None where the plan does not complete or time ran out.
    pub class: Option<Verdict>,
    /// The directions, in the order of the file.
    pub directions: Vec<Direction>,
    /// The infimum of the μ that locks all directions of the family.
    pub critical: Option<Algebraic>,
    /// The infimum of the μ at which the plan itself sticks: above it there is no assembly.
    pub critical_forward: Option<Algebraic>,
    /// Where the ways out begin; None where the plan does not complete.
    pub start: Option<Start>,
}

/// What to look for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ask {
    /// When to give up.
    pub deadline: Option<Instant>,
    /// Compute critical coefficients of friction, and the force at which a direction lets go.
    pub critical: bool,
    /// Decide every motion without certified doubles: the reference, with the same answers. (The
    /// proofs for whole arcs of directions are in double intervals all the same.)
    pub exact: bool,
    /// Which algorithm runs the plan. The ways out, one short phase each, look at every arc.
    pub method: Method,
}

impl Ask {
    /// How to simulate.
    pub fn options(&self) -> Options<'static> {
        Options {
            deadline: self.deadline,
            arithmetic: if self.exact {
                Arithmetic::Exact
            } else {
                Arithmetic::Filtered
            },
            method: self.method,
            ..Options::default()
        }
    }
}

/// The velocities of the family: the scene's, or the reverse of the plan's last phase that is no
/// reverse, with the squared length to run.
pub fn family(scene: &Scene, plan: &Trajectory) -> Option<(Vec<Vec2>, Rat)> {
    let last = scene
        .motions
        .iter()
        .rposition(|m| matches!(m, Motion::Translate { .. }))?;
    let phase = plan.phases.get(last)?;
    let lasted = phase.to.as_rat()?;
    let distance2 = phase.velocity.norm2() * lasted.square();
    let given = scene.classify.as_ref().map(|c| c.directions.clone());
    let directions = given
        .filter(|d| !d.is_empty())
        .unwrap_or_else(|| vec![-&phase.velocity]);
    Some((directions, distance2))
}

/// Decides the scene's family of directions.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn relative(scene: &Scene, ask: &Ask) -> Result<Relative, PlanError> {
    let forward = simulate(scene, &ask.options())?;
    let ground = Ground::asked(scene, ask);
    let start = Start::after(&forward);
    let mut out = Relative {
        class: None,
        directions: Vec::new(),
        critical: None,
        critical_forward: None,
        start: start.clone(),
        forward,
    };
    let (Some(start), Some((directions, distance2))) = (start, family(scene, &out.forward)) else {
        return Ok(out);
    };
    for v in &directions {
        let d = direction(&ground, &start, v, &distance2, ask.critical);
        out.directions.push(d);
    }
    let late = |r: &Trajectory| r.outcome.kind == OutcomeKind::Undecided;
    let weakest = out.directions.iter().map(|d| d.verdict).min();
    out.class = weakest.filter(|_| !out.directions.iter().any(|d| late(&d.run)));
    if ask.critical {
        out.critical = family_friction(&out.directions);
        let slid = stretches(scene, &ground.shapes, &ground.obstacles, &out.forward);
        out.critical_forward = least_friction(&slid).map(|c| c.0);
    }
    Ok(out)
}

/// The infimum of the μ that locks every direction: the largest of theirs. Directions that are
/// locked anyway ask for none; one that no μ locks spoils it; none at all ask for no friction.
fn family_friction(directions: &[Direction]) -> Option<Algebraic> {
    let mut worst: Option<Algebraic> = None;
    for d in directions
        .iter()
        .filter(|d| d.verdict != Verdict::Kinematic)
    {
        let (mu, _) = d.critical.clone()?;
        worst = Some(match worst {
            Some(w) if w >= mu => w,
            _ => mu,
        });
    }
    worst
}

/// Decides one direction over the distance √`distance2`.
pub fn direction(
    ground: &Ground<'_>,
    start: &Start,
    velocity: &Vec2,
    distance2: &Rat,
    critical: bool,
) -> Direction {
    let scene = ground.scene;
    let smooth = ground.escape(start, velocity, distance2, None);
    let mut out = Direction {
        velocity: velocity.clone(),
        verdict: Verdict::None,
        open: open(&smooth),
        run: smooth,
        with_friction: false,
        peak: None,
        root_force: None,
        critical: None,
    };
    if blocks(&out.run) {
        out.verdict = Verdict::Kinematic;
        return out;
    }
    if out.open {
        return out;
    }
    let slid = stretches(scene, &ground.shapes, &ground.obstacles, &out.run);
    if critical {
        out.critical = least_friction(&slid).map(|(mu, i)| (mu, slid[i].pawl));
    }
    if let Some(mu) = scene.friction.as_ref().filter(|m| m.sign() > 0) {
        out.run = ground.escape(start, velocity, distance2, Some(mu));
        out.with_friction = true;
        out.open = open(&out.run);
        if blocks(&out.run) {
            out.verdict = Verdict::Friction;
            return out;
        }
        if out.open {
            return out;
        }
    }
    // Having run its length, the motion is the frictionless one: friction changes no path.
    let limit = scene.classify.as_ref().and_then(|c| c.force_limit.as_ref());
    let zero = Rat::zero();
    let mu = scene.friction.as_ref().unwrap_or(&zero);
    if critical || limit.is_some() {
        out.peak = highest(scene, &slid, mu, 40);
    }
    if critical && out.peak.is_some() {
        out.root_force = resistance(scene, ground, &out.run);
    }
    if let Some(limit) = limit {
        let mut goal = 40;
        while let Some((p, _)) = &out.peak {
            match p.peak.reaches(limit) {
                Some(true) => {
                    out.verdict = Verdict::Force;
                    break;
                }
                Some(false) => break,
                None if goal > 2000 => {
                    out.open = true;
                    break;
                }
                None => {
                    goal *= 2;
                    out.peak = highest(scene, &slid, mu, goal);
                }
            }
        }
    }
    out
}

fn blocks(run: &Trajectory) -> bool {
    matches!(
        run.outcome.kind,
        OutcomeKind::Jammed | OutcomeKind::Stuck | OutcomeKind::RootCollision
    )
}

fn open(run: &Trajectory) -> bool {
    matches!(
        run.outcome.kind,
        OutcomeKind::Undecided | OutcomeKind::Bifurcated
    )
}

/// The highest contact force over all pawls that have a stiffness, and whose it is.
pub fn highest(scene: &Scene, slid: &[Stretch], mu: &Rat, goal: u32) -> Option<(Peaked, usize)> {
    let mut best: Option<(Peaked, usize)> = None;
    for s in slid {
        let Some(k) = &scene.pawls[s.pawl].stiffness else {
            continue;
        };
        let p = force(s, k, mu, goal);
        best = Some(match best {
            None => (p, s.pawl),
            Some((b, pawl)) => {
                let second = match (&b.peak, &p.peak) {
                    (Peak::Within(x, _), Peak::Within(y, _)) => y > x,
                    (_, second) => *second == Peak::Unbounded,
                };
                (higher(Some(b), p), if second { s.pawl } else { pawl })
            }
        });
    }
    best
}
