//! Plans: phases one after the other, all pawls and the root together.

use super::ledger::{Ledger, PhaseCost};
use super::phase::{End, Method, Run, Setting, run};
use super::root::first_collision;
use super::solids::Solids;
use super::trajectory::{
    Angle, Event, EventKind, Outcome, OutcomeKind, PawlTrace, Phase, RootContact, Trajectory,
};
use crate::contact::{Contact, Frame, ObstacleShape, PawlShape};
use crate::geometry::{Polygon, Vec2};
use crate::kernel::{
    Exact, Filtered, Float, FloatOptions, Instant as _, Kernel, Position, with_float,
};
use crate::number::filter::{counts, reset_bits, with_filter};
use crate::number::{Rat, Scalar};
use crate::scene::{Motion, Scene};
use crate::slice::{Free, Slice};
use std::rc::Rc;
use std::time::Instant;

/// How a simulation is to run.
#[derive(Default)]
pub struct Options<'a> {
    /// When to give up, undecided.
    pub deadline: Option<Instant>,
    /// Told before each pawl's run through each phase.
    pub progress: Option<&'a dyn Fn(Progress)>,
    /// Which numbers decide.
    pub arithmetic: Arithmetic,
    /// Which algorithm runs.
    pub method: Method,
    /// The way to F, where the sweep runs.
    pub face: crate::face::Method,
}

/// Which numbers decide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Arithmetic {
    /// Certified double enclosures first, exact numbers where they cannot tell.
    #[default]
    Filtered,
    /// Exact numbers only: the reference, with the same answers.
    Exact,
    /// Doubles, with zeros identified; fast, and may be wrong.
    F64(FloatOptions),
}

impl Arithmetic {
    /// The contract's word for it.
    pub fn name(&self) -> &'static str {
        match self {
            Arithmetic::Filtered => "filtered",
            Arithmetic::Exact => "exact",
            Arithmetic::F64(_) => "f64",
        }
    }
}

impl Method {
    /// What runs under an arithmetic. F is traced with certified doubles first: so the reference, which
    /// knows none, scans unless the sweep is asked for by name; doubles alone always do, as they cannot
    /// vouch for F.
    pub fn under(self, arithmetic: &Arithmetic) -> Method {
        match (arithmetic, self) {
            (Arithmetic::Filtered, _) | (Arithmetic::Exact, Method::Sweep) => self,
            (Arithmetic::Exact | Arithmetic::F64(_), _) => Method::Naive,
        }
    }
}

/// How far a simulation has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Index of the phase at hand.
    pub phase: usize,
    /// Phases in all.
    pub phases: usize,
    /// Index of the pawl at hand.
    pub pawl: usize,
    /// Contact arcs of that pawl in that phase.
    pub arcs: usize,
}

/// A plan that cannot be carried out; what the scene's reader cannot see.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlanError {
    /// `until = "root-collision"` without a duration, and the root never collides.
    NeverCollides {
        /// Index of the phase.
        phase: usize,
    },
    /// `reverse` with no phase before it, or `until` without a root; a reader refuses both.
    Impossible {
        /// Index of the phase.
        phase: usize,
    },
}

impl std::fmt::Display for PlanError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            PlanError::NeverCollides { phase } => write!(
                f,
                "phase {phase} is to last until the root collides, but the root never does; \
                 give it a duration as an upper bound"
            ),
            PlanError::Impossible { phase } => {
                write!(f, "phase {phase} cannot be carried out as written")
            }
        }
    }
}

impl std::error::Error for PlanError {}

/// Simulates a scene (DP Def. 2.1) by the algorithm and in the arithmetic asked for.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn simulate(scene: &Scene, options: &Options<'_>) -> Result<Trajectory, PlanError> {
    match &options.arithmetic {
        Arithmetic::Filtered => simulate_with::<Filtered>(scene, options, &mut |_| {}),
        Arithmetic::Exact => with_filter(false, || {
            simulate_with::<Exact>(scene, options, &mut |_| {})
        })
        .map(Trajectory::published),
        Arithmetic::F64(float) => with_float(float, || {
            simulate_with::<Float>(scene, options, &mut |_| {})
        })
        .map(Trajectory::published),
    }
}

/// One pawl's slice of one phase, as a simulation met it.
pub struct Seen<K: Kernel = Filtered> {
    /// Index of the phase.
    pub phase: usize,
    /// Index of the pawl.
    pub pawl: usize,
    /// The slice.
    pub slice: Rc<Slice<K>>,
    /// F, where the sweep ran and the pawl had an interval to be in.
    pub free: Option<Rc<Free>>,
    /// The pawl's orientation at the start of the phase.
    pub start: Angle<K>,
}

/// Simulates a scene by the sweep in the filtered arithmetic and shows every slice on the way.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn slices(
    scene: &Scene,
    options: &Options<'_>,
    see: &mut dyn FnMut(Seen),
) -> Result<Trajectory, PlanError> {
    let options = Options {
        deadline: options.deadline,
        progress: options.progress,
        arithmetic: Arithmetic::Filtered,
        method: Method::Sweep,
        face: options.face,
    };
    simulate_with::<Filtered>(scene, &options, see)
}

fn simulate_with<K: Kernel>(
    scene: &Scene,
    options: &Options<'_>,
    see: &mut dyn FnMut(Seen<K>),
) -> Result<Trajectory<K>, PlanError> {
    let num = <K::Num as Scalar>::from_rat;
    reset_bits();
    let before_all = counts();
    let mut ledger = Ledger::default();
    let obstacles: Vec<ObstacleShape<K::Num>> =
        scene.obstacles.iter().map(ObstacleShape::new).collect();
    let fixed = Solids::new(&scene.obstacles);
    let shapes: Vec<PawlShape<K::Num>> = scene.pawls.iter().map(PawlShape::new).collect();
    let turning: Vec<Polygon> = scene
        .pawls
        .iter()
        .map(|p| p.vertices.iter().map(|v| v - &p.hinge).collect())
        .map(|ring| Polygon::new(ring, Vec::new()))
        .collect();
    let mut angles: Vec<Angle<K>> = scene
        .pawls
        .iter()
        .map(|p| Angle::from_tan_half(&num(&p.start)))
        .collect();
    let mut touching: Vec<Vec<Contact>> = vec![Vec::new(); scene.pawls.len()];
    let mut pawls: Vec<PawlTrace<K>> = scene
        .pawls
        .iter()
        .map(|p| PawlTrace {
            name: p.name.clone(),
            events: Vec::new(),
            segments: Vec::new(),
        })
        .collect();
    let mut phases: Vec<Phase<K>> = Vec::new();
    let mut offset = Vec2::default();
    let mut clock = Rat::zero();
    let mut before: Option<(Vec2, Rat)> = None;
    // Each pawl's slice of the phase before, with F, where the next phase runs it backwards.
    let mut kept: Vec<Option<Kept<K>>> = Vec::new();
    kept.resize_with(scene.pawls.len(), || None);
    let stop = || options.deadline.is_some_and(|d| Instant::now() >= d);
    for (index, motion) in scene.motions.iter().enumerate() {
        let plan = schedule(scene, index, motion, &offset, before.as_ref())?;
        K::begin();
        for angle in &mut angles {
            angle.x = angle.x.renew();
        }
        let mut cost = PhaseCost::default();
        let end = K::Time::of(num(&plan.duration));
        let mut phase = Phase {
            from: clock.clone(),
            to: end.clone(),
            offset: offset.clone(),
            velocity: plan.velocity.clone(),
        };
        // What ends the plan, as far as is known: a pawl is followed no further than that. One that comes before
        // the culprit in the file has been followed all the way; to spare it that, all pawls would have to go
        // forward together, their next instants compared at every step.
        let collides = plan.collision.as_ref().map(|c| K::Time::of(num(&c.0)));
        let mut over: Option<End<K>> = collides
            .clone()
            .filter(|_| !plan.until_collision)
            .map(|t| (t, OutcomeKind::RootCollision, None));
        let mut runs: Vec<Run<K>> = Vec::with_capacity(scene.pawls.len());
        for (i, pawl) in scene.pawls.iter().enumerate() {
            let clock = Instant::now();
            let frame = Frame {
                p0: Vec2::from_exact(&(&pawl.hinge + &offset)),
                v: Vec2::from_exact(&plan.velocity),
                duration: num(&plan.duration),
            };
            let limits = pawl.limits.as_ref().map(|(lo, hi)| (num(lo), num(hi)));
            let turned = kept[i].take().and_then(|(slice, free)| {
                let slice = Rc::new(slice.reversed(limits.as_ref())?);
                let free = free.and_then(|f| f.reversed(&slice)).map(Rc::new);
                Some((slice, free))
            });
            cost.slices += u64::from(turned.is_none());
            let made = turned.or_else(|| {
                let limits = limits.as_ref();
                let slice = Slice::<K>::unless(frame, &shapes[i], &obstacles, limits, &stop)?;
                Some((Rc::new(slice), None))
            });
            cost.build += clock.elapsed().as_secs_f64();
            let Some((slice, known)) = made else {
                // Too late before anything of this pawl is known but where it starts.
                let late = Run::late(&angles[i], &touching[i]);
                over = over.into_iter().chain(late.ends_plan(i)).min();
                runs.push(late);
                continue;
            };
            cost.arcs += slice.arcs().len() as u64;
            if let Some(report) = options.progress {
                let phases = scene.motions.len();
                report(Progress {
                    phase: index,
                    phases,
                    pawl: i,
                    arcs: slice.arcs().len(),
                });
            }
            let set = Setting {
                shape: &turning[i],
                obstacles: &fixed,
                limits: pawl.limits.as_ref(),
                friction: scene.friction.as_ref(),
                phase: index,
                probe: over.as_ref().map(|o| &o.0).or(collides.as_ref()),
                stop: &stop,
                method: options.method,
                known,
                face: options.face,
            };
            let clock = Instant::now();
            runs.push(run(&slice, &set, &angles[i], &touching[i]));
            cost.run += clock.elapsed().as_secs_f64();
            if let Some(r) = runs.last() {
                over = over.into_iter().chain(r.ends_plan(i)).min();
                let next = scene.motions.get(index + 1);
                if r.method == Method::Sweep && matches!(next, Some(Motion::Reverse)) {
                    kept[i] = Some((slice.clone(), r.free.clone()));
                }
                cost.faces.add(&r.faces);
                cost.swept += u64::from(r.method == Method::Sweep);
                cost.half_edges += r.free.as_ref().map_or(0, |f| f.half_edges() as u64);
                see(Seen {
                    phase: index,
                    pawl: i,
                    slice,
                    free: r.free.clone(),
                    start: angles[i].clone(),
                });
            }
        }
        ledger.phases.push(cost);
        ledger.degenerate_events += runs.iter().map(|r| r.degenerate).sum::<u64>();
        if K::CERTIFIED {
            ledger.counts = counts().since(&before_all);
        }
        let cut = over.as_ref().map_or(end.clone(), |o| o.0.clone());
        if let Some((t, kind, pawl)) = &over {
            phase.to = t.clone();
            let branches = match pawl {
                Some(i) => runs[*i]
                    .end
                    .as_ref()
                    .map(|e| e.2.clone())
                    .unwrap_or_default(),
                None => Vec::new(),
            };
            phases.push(phase);
            for (i, r) in runs.into_iter().enumerate() {
                append(&mut pawls[i], r, &cut, &plan, index, false);
            }
            let outcome = Outcome {
                kind: *kind,
                time: t.clone(),
                phase: index,
                pawl: *pawl,
                branches,
            };
            return Ok(Trajectory {
                phases,
                outcome,
                pawls,
                touching,
                ledger,
            });
        }
        phases.push(phase);
        let last = index + 1 == scene.motions.len();
        for (i, r) in runs.into_iter().enumerate() {
            angles[i] = r.angle.clone();
            touching[i] = r.touching.clone();
            append(&mut pawls[i], r, &cut, &plan, index, true);
            if last && let Some(e) = pawls[i].events.last().cloned() {
                pawls[i].events.push(Event {
                    kind: EventKind::PlanEnd,
                    ..e
                });
            }
        }
        offset = &offset + &plan.velocity.scale(&plan.duration);
        clock += &plan.duration;
        before = Some((plan.velocity.clone(), plan.duration.clone()));
    }
    let last = phases.len().saturating_sub(1);
    let time = phases
        .last()
        .map_or(K::Time::of(K::Num::zero()), |p| p.to.clone());
    let outcome = Outcome {
        kind: OutcomeKind::Completed,
        time,
        phase: last,
        pawl: None,
        branches: Vec::new(),
    };
    Ok(Trajectory {
        phases,
        outcome,
        pawls,
        touching,
        ledger,
    })
}

/// A slice and F, where it was made.
type Kept<K> = (Rc<Slice<K>>, Option<Rc<Free>>);

/// One phase with its duration known.
struct Schedule {
    velocity: Vec2,
    duration: Rat,
    until_collision: bool,
    /// The root's collision within the phase, or at its end where the phase lasts until then.
    collision: Option<(Rat, Vec<RootContact>)>,
}

fn schedule(
    scene: &Scene,
    phase: usize,
    motion: &Motion,
    offset: &Vec2,
    before: Option<&(Vec2, Rat)>,
) -> Result<Schedule, PlanError> {
    let (velocity, bound, until_collision) = match motion {
        Motion::Translate {
            velocity,
            duration,
            until_root_collision,
        } => (velocity.clone(), duration.clone(), *until_root_collision),
        Motion::Reverse => {
            let (v, d) = before.ok_or(PlanError::Impossible { phase })?;
            (-v, Some(d.clone()), false)
        }
    };
    let collision = scene.root.as_ref().and_then(|root| {
        first_collision(root, &scene.obstacles, offset, &velocity, bound.as_ref())
    });
    let duration = match (&collision, bound, until_collision) {
        (Some((t, _)), _, true) => t.clone(),
        (_, Some(d), _) => d,
        (None, None, true) if scene.root.is_some() => {
            return Err(PlanError::NeverCollides { phase });
        }
        _ => return Err(PlanError::Impossible { phase }),
    };
    Ok(Schedule {
        velocity,
        duration,
        until_collision,
        collision,
    })
}

/// Adds a run to a pawl's history, up to the instant at which the plan went over.
fn append<K: Kernel>(
    pawl: &mut PawlTrace<K>,
    run: Run<K>,
    cut: &K::Time,
    plan: &Schedule,
    phase: usize,
    completed: bool,
) {
    pawl.events
        .extend(run.events.into_iter().filter(|e| e.time <= *cut));
    let before = run.segments.into_iter().take_while(|s| s.from < *cut);
    pawl.segments.extend(before.map(|s| s.until(cut)));
    let (angle, probed) = (run.angle, run.probed);
    let event = |kind, root_contacts: Vec<RootContact>| Event {
        kind,
        time: cut.clone(),
        phase,
        angle: if kind == EventKind::RootCollision {
            probed.clone()
        } else {
            angle.clone()
        },
        to: None,
        contacts: Vec::new(),
        root_contacts,
    };
    if let Some((t, contacts)) = &plan.collision
        && cut.cmp_num(&K::Num::from_rat(t)).is_eq()
    {
        pawl.events
            .push(event(EventKind::RootCollision, contacts.clone()));
    }
    if completed {
        pawl.events.push(event(EventKind::PhaseEnd, Vec::new()));
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::motion::Segment;
    use crate::scene::read_scene;

    /// The first pawl runs its hinge into a wall at t = 5, the second one rides over ten teeth from t = 9/2 on.
    fn wall_and_teeth() -> Scene {
        let teeth: String = (0..10)
            .map(|k| 4 * k - 18)
            .map(|x| {
                let (l, r) = (x - 1, x + 1);
                format!(
                    "[[obstacle]]\nname = 'tooth{x}'\nvertices = [[{l}, 0], [{r}, 0], [{x}, 2]]\n"
                )
            })
            .collect();
        let text = format!(
            "[scene]\nname = 'wall and teeth'\n\
             [[obstacle]]\nname = 'wall'\nvertices = [[-15, 25], [-14, 25], [-14, 35], [-15, 35]]\n{teeth}\
             [[pawl]]\nname = 'struck'\nhinge = [-20, 30]\nvertices = [[-20, 30], [-22, 31], [-22, 29]]\n\
             [[pawl]]\nname = 'rides'\nhinge = [-20, 5]\nvertices = [[-20, 5], [-21, 5], [-23, 1]]\n\
             [[motion]]\nvelocity = [1, 0]\nduration = 40\n"
        );
        read_scene("teeth.toml", &text).unwrap().into_scene()
    }

    /// The pawls by name, each with its events and segments.
    fn told(t: &Trajectory) -> Vec<(&str, &[Event], &[Segment])> {
        let mut all: Vec<_> = t
            .pawls
            .iter()
            .map(|p| (&*p.name, &p.events[..], &p.segments[..]))
            .collect();
        all.sort_by_key(|p| p.0);
        all
    }

    /// The pawls after the one that ends the plan are followed no further than that, by either method; what is
    /// told of them is the same as where they come first and are followed all the way.
    #[test]
    fn pawls_stop_where_another_one_has_ended_the_plan() {
        let scene = wall_and_teeth();
        let mut turned = scene.clone();
        turned.pawls.reverse();
        let mut all = Vec::new();
        for method in [Method::Naive, Method::Sweep] {
            let options = Options {
                method,
                ..Options::default()
            };
            let [short, long] = [&scene, &turned].map(|s| simulate(s, &options).unwrap());
            assert_eq!(short.outcome.kind, OutcomeKind::Jammed);
            assert!(short.outcome.time.cmp_rat(&Rat::from(5)).is_eq());
            assert_eq!(told(&short), told(&long));
            assert_eq!(short.pawls[1].events.len(), 1);
            assert_eq!(short.pawls[1].segments.len(), 2);
            let [few, many] = [&short, &long].map(|t| t.ledger.counts.asked());
            assert!(few < many, "{method:?}: {few}, {many} all the way");
            all.push(short);
        }
        assert_eq!(told(&all[0]), told(&all[1]));
    }

    /// An arm (3, −4) that starts upright, tan(θ/2) = 3, leans on a corner at (0, 3) and is turned to the left by
    /// it. It lies along (−3, 4), θ = π, when the corner is at (−9/4, 3), t = 9/4. The plan is over before, then,
    /// or later, and the turns are those of that instant whichever pawl comes first.
    #[test]
    fn the_turns_of_a_segment_are_those_where_the_plan_ends() {
        for (end, turns) in [("1", 0), ("9/4", 0), ("3", 1)] {
            let text = format!(
                "[scene]\nname = 'past the back'\n\
                 [[obstacle]]\nname = 'face'\nvertices = [[0, 3], [5, 3], [5, 20], [0, 20]]\n\
                 [[obstacle]]\nname = 'wall'\nvertices = [['{end}', 95], [9, 95], [9, 105], ['{end}', 105]]\n\
                 [[pawl]]\nname = 'turns'\nhinge = [0, 0]\nstart = 3\n\
                 vertices = [[0, 0], ['608/1000', '-794/1000'], [3, -4]]\n\
                 [[pawl]]\nname = 'struck'\nhinge = [0, 100]\nvertices = [[0, 100], [-2, 101], [-2, 99]]\n\
                 [[motion]]\nvelocity = [1, 0]\nduration = 40\n"
            );
            let scene = read_scene("back.toml", &text).unwrap().into_scene();
            let mut turned = scene.clone();
            turned.pawls.reverse();
            for method in [Method::Naive, Method::Sweep] {
                let options = Options {
                    method,
                    ..Options::default()
                };
                let [first, last] = [&scene, &turned].map(|s| simulate(s, &options).unwrap());
                assert_eq!(first.pawls[0].segments[0].winding, [0, turns], "{end}");
                assert_eq!(told(&first), told(&last), "{end} {method:?}");
            }
        }
    }
}
