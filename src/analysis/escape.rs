//! One way out: from where a plan ended, straight in one direction.
//!
//! A verdict asks the same question of many directions: with the root displaced by the plan and
//! the pawls at the angles it left them at, what does a straight motion meet? The forward plan is
//! simulated once; from its end every direction is one phase of its own, run by the same
//! rules ([`crate::motion::phase`]).
//!
//! The length of a way out is a distance. At a velocity w it lasts distance/|w|, which may be
//! irrational, while a phase must last a rational time: the phase is then made a little longer,
//! and what happens past the exact end is left out of account.

use super::classify::Ask;
use crate::contact::{Contact, Frame, ObstacleShape, PawlShape};
use crate::geometry::{Polygon, Vec2};
use crate::kernel::Certified;
use crate::motion::phase::{End, Run, Setting, run};
use crate::motion::root::first_collision;
use crate::motion::solids::Solids;
use crate::motion::{Angle, Event, EventKind, Outcome, OutcomeKind, PawlTrace, Phase, Trajectory};
use crate::number::filter::with_filter;
use crate::number::{Algebraic, Int, Poly, Rat};
use crate::scene::{Motion, Scene};
use crate::slice::{Slice, Time};
use std::time::Instant;

/// Where the ways out begin: the root's displacement and the pawls' orientations.
#[derive(Clone, Debug)]
pub struct Start {
    /// Displacement of the root from time 0.
    pub offset: Vec2,
    /// One orientation a pawl, in file order.
    pub angles: Vec<Angle>,
    /// Who touches each pawl then: what held it goes on holding it, where it can.
    pub touching: Vec<Vec<Contact>>,
}

impl Start {
    /// The end of a completed plan; None where it did not complete.
    pub fn after(plan: &Trajectory) -> Option<Start> {
        if plan.outcome.kind != OutcomeKind::Completed {
            return None;
        }
        let last = plan.phases.last()?;
        let lasted = last.to.as_rat()?;
        let angles = plan
            .pawls
            .iter()
            .map(|p| {
                p.events
                    .last()
                    .map_or_else(Angle::rest, |e| e.angle.clone())
            })
            .collect();
        Some(Start {
            offset: &last.offset + &last.velocity.scale(lasted),
            angles,
            touching: plan.touching.clone(),
        })
    }
}

/// The scene with a straight motion appended to its plan.
pub fn with_motion(scene: &Scene, velocity: &Vec2, duration: &Rat) -> Scene {
    let mut longer = scene.clone();
    longer.motions.push(Motion::Translate {
        velocity: velocity.clone(),
        duration: Some(duration.clone()),
        until_root_collision: false,
    });
    longer
}

/// How long a motion at a velocity lasts that covers the distance √`distance2`: a rational
/// duration at least that long, and the exact one.
pub fn lasting(velocity: &Vec2, distance2: &Rat) -> (Rat, Time) {
    let t2 = distance2 / velocity.norm2();
    let (n, d) = (t2.numer(), t2.denom());
    if let (Some(n), Some(d)) = (n.sqrt_exact(), d.sqrt_exact()) {
        let t = Rat::new(n, d);
        return (t.clone(), Time::from(t));
    }
    let roots = Poly::new(vec![-n, Int::zero(), d.clone()]).real_roots();
    let exact = roots.last().cloned().unwrap_or_else(|| Rat::zero().into());
    (just_past(&exact), Time::at(exact))
}

/// A rational number at least as large as a positive one, and larger by less than 2⁻¹⁶ of it.
pub(super) fn just_past(exact: &Algebraic) -> Rat {
    let mut bits = 16;
    loop {
        let (lo, hi) = exact.enclosure(bits);
        if lo.sign() > 0 && (&hi - &lo) * Rat::from(1 << 16) <= lo {
            return hi;
        }
        bits *= 2;
    }
}

/// A scene prepared for many ways out.
pub struct Ground<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The pawls about their hinges.
    pub shapes: Vec<PawlShape>,
    /// The obstacles' rings.
    pub obstacles: Vec<ObstacleShape>,
    fixed: Solids<'a>,
    turning: Vec<Polygon>,
    /// When to give up, undecided.
    pub deadline: Option<Instant>,
    /// Whether to do without certified doubles.
    exact: bool,
}

impl<'a> Ground<'a> {
    /// Prepares a scene.
    pub fn new(scene: &'a Scene, deadline: Option<Instant>) -> Ground<'a> {
        let shapes: Vec<PawlShape> = scene.pawls.iter().map(PawlShape::new).collect();
        Ground {
            scene,
            obstacles: scene.obstacles.iter().map(ObstacleShape::new).collect(),
            fixed: Solids::new(&scene.obstacles),
            turning: shapes
                .iter()
                .map(|s| Polygon::new(s.ring.vertices.to_vec(), Vec::new()))
                .collect(),
            shapes,
            deadline,
            exact: false,
        }
    }

    /// Prepares a scene for what is asked.
    pub(super) fn asked(scene: &'a Scene, ask: &Ask) -> Ground<'a> {
        Ground {
            exact: ask.exact,
            ..Ground::new(scene, ask.deadline)
        }
    }

    /// Whether the time is up.
    pub fn late(&self) -> bool {
        self.deadline.is_some_and(|d| Instant::now() >= d)
    }

    /// Runs one straight motion over the distance √`distance2` from `start`. The result is a
    /// trajectory of one phase whose clock begins there.
    pub fn escape(
        &self,
        start: &Start,
        velocity: &Vec2,
        distance2: &Rat,
        friction: Option<&Rat>,
    ) -> Trajectory {
        if self.exact {
            let run = || self.run::<false>(start, velocity, distance2, friction);
            return with_filter(false, run).published();
        }
        self.run::<true>(start, velocity, distance2, friction)
    }

    /// With certified doubles, or without.
    fn run<const FILTER: bool>(
        &self,
        start: &Start,
        velocity: &Vec2,
        distance2: &Rat,
        friction: Option<&Rat>,
    ) -> Trajectory<Certified<FILTER>> {
        let (duration, end) = lasting(velocity, distance2);
        let stop = || self.late();
        let collision = self.scene.root.as_ref().and_then(|root| {
            first_collision(
                root,
                &self.scene.obstacles,
                &start.offset,
                velocity,
                Some(&duration),
            )
        });
        // Pawls are followed no further than to the first end known.
        let mut over: Option<End<Certified<FILTER>>> = collision
            .as_ref()
            .map(|(t, _)| (Time::from(t.clone()), OutcomeKind::RootCollision, None));
        let mut runs: Vec<Run<Certified<FILTER>>> = Vec::with_capacity(self.scene.pawls.len());
        for (i, pawl) in self.scene.pawls.iter().enumerate() {
            let frame = Frame {
                p0: &pawl.hinge + &start.offset,
                v: velocity.clone(),
                duration: duration.clone(),
            };
            let limits = pawl.limits.as_ref();
            let slice = Slice::new(frame, &self.shapes[i], &self.obstacles, limits);
            let set = Setting {
                shape: &self.turning[i],
                obstacles: &self.fixed,
                limits,
                friction,
                phase: 0,
                probe: over.as_ref().map(|o| &o.0),
                stop: &stop,
                method: crate::motion::Method::Naive,
                known: None,
                face: crate::face::Method::Auto,
            };
            let angle = Angle {
                half_turn: start.angles[i].half_turn,
                x: start.angles[i].x.clone(),
            };
            let run = run::<Certified<FILTER>>(&slice, &set, &angle, &start.touching[i]);
            over = over.into_iter().chain(run.ends_plan(i)).min();
            runs.push(run);
        }
        let over = over.filter(|e| e.0 < end);
        let (kind, cut, by) = match over {
            Some((t, kind, by)) => (kind, t, by),
            None => (OutcomeKind::Completed, end, None),
        };
        let branches = by
            .and_then(|i| runs[i].end.as_ref())
            .filter(|_| kind != OutcomeKind::Completed)
            .map_or_else(Vec::new, |e| e.2.clone());
        let struck = collision.filter(|_| kind == OutcomeKind::RootCollision);
        let pawls = runs
            .into_iter()
            .zip(&self.scene.pawls)
            .map(|(r, p)| trace(r, &p.name, &cut, struck.as_ref().map(|s| &s.1)))
            .collect();
        Trajectory {
            phases: vec![Phase {
                from: Rat::zero(),
                to: cut.clone(),
                offset: start.offset.clone(),
                velocity: velocity.clone(),
            }],
            outcome: Outcome {
                kind,
                time: cut,
                phase: 0,
                pawl: by,
                branches,
            },
            pawls,
            touching: Vec::new(),
            ledger: Default::default(),
        }
    }
}

/// A run as a history that ends at `cut`.
fn trace<const FILTER: bool>(
    run: Run<Certified<FILTER>>,
    name: &str,
    cut: &Time,
    struck: Option<&Vec<crate::motion::RootContact>>,
) -> PawlTrace<Certified<FILTER>> {
    let mut events: Vec<Event<Certified<FILTER>>> = run.events;
    events.retain(|e| e.time <= *cut);
    if let Some(contacts) = struck {
        events.push(Event {
            kind: EventKind::RootCollision,
            time: cut.clone(),
            phase: 0,
            angle: run.probed,
            to: None,
            contacts: Vec::<Contact>::new(),
            root_contacts: contacts.clone(),
        });
    }
    let before = run.segments.into_iter().take_while(|s| s.from < *cut);
    let segments = before.map(|s| s.until(cut)).collect();
    PawlTrace {
        name: name.to_owned(),
        events,
        segments,
    }
}
