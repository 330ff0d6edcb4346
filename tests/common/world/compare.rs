//! The engine against the oracle: the shape of a trajectory, single instants, the whole course.

use super::follow::{Follower, Forecast, How, SHORTEST};
use super::oracle::{World, check_instant, f, polygon, radians, segment_at, theta_on};
use super::rng::Rng;
use snapfit::geometry::{Polygon, Vec2, interiors_intersect};
use snapfit::motion::trajectory::{OutcomeKind, Trajectory};
use snapfit::motion::{Method, Options, simulate};
use snapfit::number::Rat;
use snapfit::report::json::{Provenance, ResultDocument};
use snapfit::scene::{Motion, Scene};
use snapfit::slice::Time;
use std::time::{Duration, Instant};

/// What a comparison covered.
#[derive(Clone, Copy, Default, Debug)]
pub struct Covered {
    pub scenes: usize,
    pub instants: usize,
    pub held: usize,
    pub phases: usize,
    pub snaps: usize,
    pub jams: usize,
    pub sticks: usize,
    pub bifurcations: usize,
    pub collisions: usize,
    pub steps: usize,
    pub doubts: usize,
}

impl Covered {
    pub fn add(&mut self, o: &Covered) {
        self.scenes += o.scenes;
        self.instants += o.instants;
        self.held += o.held;
        self.phases += o.phases;
        self.snaps += o.snaps;
        self.jams += o.jams;
        self.sticks += o.sticks;
        self.bifurcations += o.bifurcations;
        self.collisions += o.collisions;
        self.steps += o.steps;
        self.doubts += o.doubts;
    }
}

pub fn ft(t: &Time) -> f64 {
    let i = t.interval();
    (i.lo + i.hi) / 2.0
}

/// The engine's answer, with panics and hangs as errors.
pub fn engine(scene: &Scene) -> Result<Trajectory, String> {
    engine_by(scene, Method::default())
}

/// The engine's answer by both methods, which must be one to the byte.
pub fn by_both(scene: &Scene) -> Result<Trajectory, String> {
    let told = |t: &Trajectory| {
        let how = Provenance {
            arithmetic: "filtered",
            method: Method::Sweep,
        };
        let mut doc = serde_json::to_value(ResultDocument::new(scene, t, how)).unwrap();
        doc.as_object_mut().unwrap().remove("ledger");
        doc.to_string()
    };
    let naive = engine_by(scene, Method::Naive)?;
    let sweep = engine_by(scene, Method::Sweep)?;
    if told(&naive) == told(&sweep) {
        Ok(sweep)
    } else {
        Err("the sweep and the scan tell different stories".to_owned())
    }
}

fn engine_by(scene: &Scene, method: Method) -> Result<Trajectory, String> {
    let quiet = std::panic::AssertUnwindSafe(|| {
        simulate(
            scene,
            &Options {
                deadline: Some(Instant::now() + Duration::from_secs(20)),
                method,
                ..Options::default()
            },
        )
    });
    match std::panic::catch_unwind(quiet) {
        Ok(Ok(t)) if t.outcome.kind == OutcomeKind::Undecided => Err("undecided".into()),
        Ok(Ok(t)) => Ok(t),
        Ok(Err(e)) => Err(format!("plan error: {e}")),
        Err(p) => {
            let text = p
                .downcast_ref::<String>()
                .cloned()
                .or_else(|| p.downcast_ref::<&str>().map(|s| (*s).to_owned()))
                .unwrap_or_default();
            Err(format!("panic: {text}"))
        }
    }
}

/// Compares the engine with the oracle: `instants` random times, and with `steps` > 0 the whole
/// course followed independently.
pub fn compare(scene: &Scene, seed: u64, instants: usize, steps: usize) -> Result<Covered, String> {
    let t = engine(scene)?;
    let mut covered = Covered {
        scenes: 1,
        ..Covered::default()
    };
    shape(scene, &t)?;
    root(scene, &t, &mut covered)?;
    at_instants(scene, &t, seed, instants, &mut covered)?;
    if steps > 0 {
        // A gap that comes and goes between two steps is missed: a difference counts where it
        // stays with steps twenty times as short.
        let (mut coarse, mut fine) = (covered, covered);
        if course(scene, &t, steps, &mut coarse).is_ok() {
            covered = coarse;
        } else {
            course(scene, &t, 20 * steps, &mut fine)?;
            covered = fine;
        }
    }
    Ok(covered)
}

/// Phases as planned; segments without gaps; events in order; contacts of events touch; no leap
/// of θ but in a snap.
pub fn shape(scene: &Scene, t: &Trajectory) -> Result<(), String> {
    let last = t.phases.len() - 1;
    let mut offset = Vec2::default();
    let mut clock = Rat::zero();
    for (k, p) in t.phases.iter().enumerate() {
        let before = k.checked_sub(1).map(|b| &t.phases[b]);
        let velocity = match (&scene.motions[k], before) {
            (Motion::Translate { velocity, .. }, _) => velocity.clone(),
            (Motion::Reverse, Some(b)) => -&b.velocity,
            _ => return Err("a reverse without a phase before it".into()),
        };
        if p.velocity != velocity || p.offset != offset || p.from != clock {
            return Err(format!("phase {k} does not follow from the plan"));
        }
        if k < last {
            let d =
                p.to.exact()
                    .to_rat()
                    .ok_or("a phase ends at no rational time")?;
            let planned = match (&scene.motions[k], before) {
                (Motion::Reverse, Some(b)) => b.to.exact().to_rat(),
                (
                    Motion::Translate {
                        duration,
                        until_root_collision: false,
                        ..
                    },
                    _,
                ) => duration.clone(),
                _ => None,
            };
            if planned.is_some_and(|x| x != d) {
                return Err(format!("phase {k} lasts {d}"));
            }
            offset = &offset + &velocity.scale(&d);
            clock += &d;
        }
    }
    for (i, pawl) in t.pawls.iter().enumerate() {
        for (k, phase) in t.phases.iter().enumerate() {
            let w = World::new(scene, i, &phase.offset, &phase.velocity, ft(&phase.to));
            let segs: Vec<_> = pawl.segments.iter().filter(|s| s.phase == k).collect();
            let events: Vec<_> = pawl.events.iter().filter(|e| e.phase == k).collect();
            let mut at = Time::from(Rat::zero());
            for s in &segs {
                if s.from != at || s.to <= s.from {
                    return Err(format!(
                        "{}: a gap between segments at {}",
                        pawl.name,
                        ft(&at)
                    ));
                }
                at = s.to.clone();
            }
            if at != phase.to {
                return Err(format!("{}: segments end at {}", pawl.name, ft(&at)));
            }
            for w in events.windows(2) {
                let order = w[0].time.cmp(&w[1].time);
                if order.is_gt() || order.is_eq() && w[0].kind > w[1].kind {
                    return Err(format!(
                        "{}: events out of order: {:?} at {}, {:?} at {}",
                        pawl.name,
                        w[0].kind,
                        ft(&w[0].time),
                        w[1].kind,
                        ft(&w[1].time)
                    ));
                }
            }
            for e in &events {
                // A snap's contacts are those left behind, a release's likewise.
                let theta = radians(&e.angle);
                for c in &e.contacts {
                    let d = w.distance(ft(&e.time), theta, *c);
                    if d > 1e-7 * w.size.max(1.0) {
                        return Err(format!(
                            "{}: {:?} at {} names {c:?}, {d} apart",
                            pawl.name,
                            e.kind,
                            ft(&e.time)
                        ));
                    }
                }
            }
            for pair in segs.windows(2) {
                let t0 = ft(&pair[0].to);
                if events
                    .iter()
                    .any(|e| e.to.is_some() && e.time == pair[0].to)
                {
                    continue;
                }
                let h = 1e-9 * ft(&phase.to);
                let (a, b) = (Rat::from_f64(t0 - h), Rat::from_f64(t0 + h));
                if pair[0].from.cmp_rat(&a).is_lt() && pair[1].to.cmp_rat(&b).is_gt() {
                    let (x, y) = (theta_on(pair[0], &a), theta_on(pair[1], &b));
                    if (x - y).abs() > 5e-3 {
                        return Err(format!("{}: θ leaps from {x} to {y} at {t0}", pawl.name));
                    }
                }
            }
        }
    }
    Ok(())
}

/// The root's collision: no overlap before it, overlap just after it.
fn root(scene: &Scene, t: &Trajectory, covered: &mut Covered) -> Result<(), String> {
    let Some(root) = &scene.root else {
        return Ok(());
    };
    let fixed: Vec<Polygon> = scene.obstacles.iter().map(polygon).collect();
    let mut rng = Rng::new(7);
    for (k, phase) in t.phases.iter().enumerate() {
        let hits = |time: &Rat| {
            let by = &phase.offset + &phase.velocity.scale(time);
            let body = Polygon::new(root.vertices.clone(), Vec::new()).translated(&by);
            fixed.iter().any(|o| interiors_intersect(&body, o))
        };
        let until = matches!(
            &scene.motions[k],
            Motion::Translate {
                until_root_collision: true,
                ..
            }
        );
        let last = k + 1 == t.phases.len();
        let ended = last && t.outcome.kind == OutcomeKind::RootCollision;
        let Some(d) = phase.to.exact().to_rat() else {
            continue;
        };
        for _ in 0..20 {
            let at = rng.fraction() * &d;
            if hits(&at) {
                return Err(format!("the root overlaps at {at} of phase {k}"));
            }
        }
        let bound = match &scene.motions[k] {
            Motion::Translate { duration, .. } => duration.clone(),
            Motion::Reverse => None,
        };
        let early = until
            && bound.is_none_or(|b| d < b)
            && !(last && t.outcome.kind != OutcomeKind::Completed);
        if ended || early {
            covered.collisions += 1;
            if !hits(&(&d + Rat::frac(1, 1 << 40))) {
                return Err(format!("the root does not overlap after {d} of phase {k}"));
            }
        }
    }
    Ok(())
}

fn at_instants(
    scene: &Scene,
    t: &Trajectory,
    seed: u64,
    instants: usize,
    covered: &mut Covered,
) -> Result<(), String> {
    let mut rng = Rng::new(seed ^ 0xABCD);
    for i in 0..t.pawls.len() {
        let worlds: Vec<World> = t
            .phases
            .iter()
            .map(|p| World::new(scene, i, &p.offset, &p.velocity, ft(&p.to)))
            .collect();
        for n in 0..instants.div_ceil(t.pawls.len()) {
            let k = n % t.phases.len();
            let d = Rat::from_f64(ft(&t.phases[k].to));
            let at = rng.fraction() * &d;
            let Some(s) = segment_at(t, i, k, &at) else {
                continue;
            };
            let theta = theta_on(s, &at);
            check_instant(&worlds[k], &at, s, theta)
                .map_err(|e| format!("{} in phase {k} at {}: {e}", t.pawls[i].name, f(&at)))?;
            covered.instants += 1;
            covered.held += usize::from(s.sliding.is_some());
        }
    }
    Ok(())
}

fn course(
    scene: &Scene,
    t: &Trajectory,
    steps: usize,
    covered: &mut Covered,
) -> Result<(), String> {
    'pawls: for (i, pawl) in t.pawls.iter().enumerate() {
        let mut theta = 2.0 * f(&scene.pawls[i].start).atan();
        for (k, phase) in t.phases.iter().enumerate() {
            let last = k + 1 == t.phases.len();
            let mine = last && t.outcome.pawl == Some(i);
            let cut = ft(&phase.to);
            // Beyond the engine's own end, where the plan goes on, so that its end is put to test.
            let planned = match &scene.motions[k] {
                Motion::Translate {
                    duration: Some(d),
                    until_root_collision,
                    ..
                } if !until_root_collision || last && mine => f(d),
                Motion::Reverse => ft(&t.phases[k - 1].to),
                _ => cut,
            };
            if planned <= 0.0 {
                continue;
            }
            let w = World::new(scene, i, &phase.offset, &phase.velocity, planned);
            let forecast = Follower::run(&w, scene.friction.as_ref(), theta, steps);
            covered.phases += 1;
            covered.steps += forecast.path.len();
            one_phase(t, i, k, cut, mine, planned, &forecast, covered)
                .map_err(|e| format!("{} in phase {k}: {e}", pawl.name))?;
            if let Some(doubt) = forecast.doubt {
                if std::env::var("TEST_DOUBTS").is_ok() {
                    eprintln!("doubt: {}: {}: {doubt:?}", scene.name, pawl.name);
                }
                covered.doubts += 1;
                continue 'pawls;
            }
            // A snap at the very end of a phase belongs to the next one; doubles cannot tell.
            if forecast.snaps.iter().any(|s| s.t > planned * (1.0 - 1e-6)) {
                covered.doubts += 1;
                continue 'pawls;
            }
            let Some(end) = forecast.path.last() else {
                continue 'pawls;
            };
            theta = end.1;
        }
    }
    Ok(())
}

#[allow(clippy::too_many_arguments)]
fn one_phase(
    t: &Trajectory,
    i: usize,
    k: usize,
    cut: f64,
    mine: bool,
    planned: f64,
    forecast: &Forecast,
    covered: &mut Covered,
) -> Result<(), String> {
    let tol = planned * (8.0 * SHORTEST + 2e-8);
    let doubt = forecast.doubt.map_or(f64::INFINITY, |d| d.0);
    let until = cut.min(doubt) - 4.0 * tol;
    let events: Vec<_> = t.pawls[i].events.iter().filter(|e| e.phase == k).collect();
    // θ all along.
    for &(at, theta) in &forecast.path {
        if at >= until || events.iter().any(|e| (ft(&e.time) - at).abs() < 4.0 * tol) {
            continue;
        }
        let r = Rat::from_f64(at);
        let Some(s) = segment_at(t, i, k, &r) else {
            continue;
        };
        let mine = theta_on(s, &r);
        if (mine - theta).abs() > 2e-6 {
            return Err(format!("θ at {at}: {mine}, by brute force {theta}"));
        }
    }
    // Snaps, the plain ones; one that is hardly longer than nothing may be missed by either.
    let near = |a: f64, b: f64| (a - b).abs() < 4e-3;
    let snaps: Vec<_> = events
        .iter()
        .filter_map(|e| Some((ft(&e.time), radians(&e.angle), radians(e.to.as_ref()?))))
        .filter(|s| s.0 < until && (s.1 - s.2).abs() > 1e-2)
        .collect();
    let leaps: Vec<_> = forecast
        .snaps
        .iter()
        .filter(|s| s.t < until && (s.from - s.to).abs() > 1e-2)
        .collect();
    for s in &snaps {
        covered.snaps += 1;
        if !forecast
            .snaps
            .iter()
            .any(|l| (l.t - s.0).abs() < 2.0 * tol && near(l.from, s.1) && near(l.to, s.2))
        {
            return Err(format!(
                "a snap {s:?} that brute force does not see: {leaps:?}"
            ));
        }
    }
    if snaps.len() != leaps.len() {
        return Err(format!("snaps {snaps:?}, by brute force {leaps:?}"));
    }
    // How it ends.
    if doubt <= cut + tol {
        return Ok(());
    }
    let slow = planned * 1e-5;
    match (&forecast.end, mine) {
        (Some((how, at)), true) => {
            let same = match (how, t.outcome.kind) {
                (How::Jammed, OutcomeKind::Jammed) => {
                    covered.jams += 1;
                    (at - cut).abs() < 2.0 * tol
                }
                (How::Stuck, OutcomeKind::Stuck) => {
                    covered.sticks += 1;
                    (at - cut).abs() < slow
                }
                (How::Bifurcated, OutcomeKind::Bifurcated) => {
                    covered.bifurcations += 1;
                    (at - cut).abs() < 2.0 * tol
                }
                _ => false,
            };
            if !same {
                return Err(format!(
                    "ends {:?} at {cut}, by brute force {how:?} at {at}",
                    t.outcome.kind
                ));
            }
        }
        (None, true) => {
            return Err(format!(
                "ends {:?} at {cut}, by brute force it goes on",
                t.outcome.kind
            ));
        }
        (Some((how, at)), false) if *at < cut - 2.0 * slow => {
            return Err(format!("goes on to {cut}, by brute force {how:?} at {at}"));
        }
        _ => {}
    }
    Ok(())
}

/// Prints what brute force finds in each phase, each begun where the engine begins it.
pub fn forecast(scene: &Scene, t: &Trajectory) {
    for i in 0..t.pawls.len() {
        for (k, phase) in t.phases.iter().enumerate() {
            let planned = match &scene.motions[k] {
                Motion::Translate {
                    duration: Some(d), ..
                } => f(d),
                _ => ft(&phase.to),
            };
            let w = World::new(scene, i, &phase.offset, &phase.velocity, planned);
            let start = if k == 0 {
                2.0 * f(&scene.pawls[i].start).atan()
            } else {
                let ends = |e: &&snapfit::motion::Event| e.phase == k - 1;
                radians(&t.pawls[i].events.iter().rfind(ends).unwrap().angle)
            };
            let mut out = Follower::run(&w, scene.friction.as_ref(), start, 150);
            out.path.dedup_by(|a, b| a.0 - b.0 < planned / 400.0);
            eprintln!("{} phase {k}: {out:?}", t.pawls[i].name);
        }
    }
}

/// Prints the engine's arcs.
pub fn arcs(scene: &Scene, t: &Trajectory) {
    use snapfit::contact::{Frame, ObstacleShape, PawlShape};
    let obstacles: Vec<ObstacleShape> = scene.obstacles.iter().map(ObstacleShape::new).collect();
    for pawl in &scene.pawls {
        for phase in &t.phases {
            let frame = Frame {
                p0: &pawl.hinge + &phase.offset,
                v: phase.velocity.clone(),
                duration: Rat::from(20),
            };
            let shape = PawlShape::new(pawl);
            let slice = snapfit::slice::Slice::new(frame, &shape, &obstacles, pawl.limits.as_ref());
            for a in slice.arcs() {
                let x = |e: &snapfit::slice::End| e.x.nearest_f64().unwrap();
                eprintln!(
                    "{} {:?} x {}..{} t {}..{} {:?} {:?} {:?}",
                    pawl.name,
                    a.chart,
                    x(&a.lo),
                    x(&a.hi),
                    ft(&a.lo.t),
                    ft(&a.hi.t),
                    a.shape,
                    a.side,
                    a.contact
                );
            }
        }
    }
}
