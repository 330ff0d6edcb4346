//! One pawl through one phase (DP §9).
//!
//! The state is at rest or on an arc. Find the next time at which anything touches it, look at
//! the place (the module `local`), go on. Which arcs are looked at is the method's affair (the module
//! `sight`): all of them, O(n) box tests a step, or those that the boundary of F names.

use super::friction::stick_time;
use super::ledger::FaceCost;
use super::local::{Incident, Place, State, incident, is_tangency, resolve};
use super::sight::{All, Sight};
use super::solids::Solids;
use super::trajectory::{Angle, Branch, Event, OutcomeKind, Segment};
use crate::contact::{Chart, Contact, ContactKind};
use crate::geometry::Polygon;
use crate::kernel::{Filtered, Instant, Kernel, Position};
use crate::number::{Rat, Scalar};
use crate::slice::{ArcId, Free, Point, Shape, Slice};
use std::rc::Rc;

/// What one pawl's run through a phase yields.
#[derive(Debug)]
pub struct Run<K: Kernel = Filtered> {
    /// Events, in order of time and kind.
    pub events: Vec<Event<K>>,
    /// Segments, in order of time.
    pub segments: Vec<Segment<K>>,
    /// How and when it ended before the phase did.
    pub end: Option<(OutcomeKind, K::Time, Vec<Branch>)>,
    /// Orientation at the end.
    pub angle: Angle<K>,
    /// Orientation at the probe, or at the end where that is earlier.
    pub probed: Angle<K>,
    /// Contacts that touch at the end.
    pub touching: Vec<Contact>,
    /// Instants at which more arcs met than in general position.
    pub degenerate: u64,
    /// What ran: the simple algorithm also where the slice cannot be swept.
    pub method: Method,
    /// F, where the sweep ran; the first, if it led on into another.
    pub free: Option<Rc<Free>>,
    /// How F was come by, as often as it was.
    pub faces: FaceCost,
}

/// What may end a plan: when, how, and which pawl (None: the root). The least ends it: the first of any kind, at
/// one instant the graver kind, then the first pawl of the file.
pub(crate) type End<K> = (<K as Kernel>::Time, OutcomeKind, Option<usize>);

impl<K: Kernel> Run<K> {
    /// A run that a limit stopped before its slice was built.
    pub(crate) fn late(start: &Angle<K>, touching: &[Contact]) -> Run<K> {
        let origin = K::Time::of(K::Num::zero());
        Run {
            events: Vec::new(),
            segments: Vec::new(),
            end: Some((OutcomeKind::Undecided, origin, Vec::new())),
            angle: start.clone(),
            probed: start.clone(),
            touching: touching.to_vec(),
            degenerate: 0,
            method: Method::Naive,
            free: None,
            faces: FaceCost::default(),
        }
    }
    /// How this run of the `pawl`-th pawl may end the plan.
    pub(crate) fn ends_plan(&self, pawl: usize) -> Option<End<K>> {
        let (kind, at, _) = self.end.as_ref()?;
        Some((at.clone(), *kind, Some(pawl)))
    }
}

/// What a pawl's run needs besides the slice.
pub struct Setting<'a, K: Kernel = Filtered> {
    /// The pawl's polygon about its hinge, at θ = 0.
    pub shape: &'a Polygon,
    /// The obstacles.
    pub obstacles: &'a Solids<'a>,
    /// Angular stops.
    pub limits: Option<&'a (Rat, Rat)>,
    /// Coulomb's μ, where friction is modelled.
    pub friction: Option<&'a Rat>,
    /// Index of the phase.
    pub phase: usize,
    /// The instant at which the plan is over whatever the pawl does (the root collides, or another pawl has
    /// ended it): the orientation there is wanted, and nothing after it is worked out.
    pub probe: Option<&'a K::Time>,
    /// Asked between events and while F is made; true ends the run undecided.
    pub stop: &'a dyn Fn() -> bool,
    /// Which arcs are looked at.
    pub method: Method,
    /// F of another run through the slice: it is not made again if it holds this run's start too.
    pub known: Option<Rc<Free>>,
    /// The way to F.
    pub face: crate::face::Method,
}

/// Which algorithm runs. Both are to give the same answers.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Method {
    /// The one that a phase's size calls for: the sweep from [`SWEEP_FROM`] arcs on.
    #[default]
    Auto,
    /// The sweep over the free component (DP §9.2).
    Sweep,
    /// The simple algorithm: every step looks at every arc.
    Naive,
}

/// The number of a pawl's contact arcs in a phase from which on the sweep pays for making F (see
/// `benches/README.md`: *crossover*).
pub const SWEEP_FROM: usize = 400;

impl Method {
    /// Whether a slice of so many arcs is swept.
    fn sweeps(self, arcs: usize) -> bool {
        match self {
            Method::Auto => arcs >= SWEEP_FROM,
            Method::Sweep => true,
            Method::Naive => false,
        }
    }
    /// The contract's word for it.
    pub fn name(self) -> &'static str {
        match self {
            Method::Auto => "auto",
            Method::Sweep => "sweep",
            Method::Naive => "naive",
        }
    }
}

pub(super) struct Runner<'a, K: Kernel> {
    pub(super) slice: &'a Slice<K>,
    pub(super) set: &'a Setting<'a, K>,
    /// Angular stops and μ in the kernel's numbers.
    pub(super) limits: Option<(K::Num, K::Num)>,
    pub(super) friction: Option<K::Num>,
    pub(super) end: K::Time,
    pub(super) zero: K::Root,
    pub(super) state: State,
    /// The last instant that was looked at.
    pub(super) clock: K::Time,
    /// When the current segment began, and the turns then.
    pub(super) segment_from: K::Time,
    pub(super) segment_winding: i64,
    /// Arcs that hold along the current segment, by contact; empty at rest.
    pub(super) held: Vec<ArcId>,
    pub(super) events: Vec<Event<K>>,
    pub(super) segments: Vec<Segment<K>>,
    pub(super) probed: Option<Angle<K>>,
    /// Which arcs are looked at.
    pub(super) sight: Box<dyn Sight<K> + 'a>,
    /// What ran.
    pub(super) method: Method,
    pub(super) free: Option<Rc<Free>>,
    pub(super) faces: FaceCost,
    pub(super) degenerate: u64,
}

/// Runs a pawl from `start` through the phase of the slice. `touching` are the contacts already
/// known (the end of the phase before), which are not reported anew.
pub fn run<K: Kernel>(
    slice: &Slice<K>,
    set: &Setting<'_, K>,
    start: &Angle<K>,
    touching: &[Contact],
) -> Run<K> {
    let zero = K::Root::of(K::Num::zero());
    let num = <K::Num as Scalar>::from_rat;
    let origin = K::Time::of(K::Num::zero());
    let mut r = Runner {
        slice,
        set,
        limits: set.limits.map(|(lo, hi)| (num(lo), num(hi))),
        friction: set.friction.map(num),
        end: K::Time::of(slice.frame.duration.clone()),
        zero,
        state: State::Rest,
        clock: origin.clone(),
        segment_from: origin,
        segment_winding: start.winding(),
        held: Vec::new(),
        events: Vec::new(),
        segments: Vec::new(),
        probed: None,
        sight: Box::new(All::new(slice)),
        method: Method::Naive,
        free: None,
        faces: FaceCost::default(),
        degenerate: 0,
    };
    let stop = r.go(start, touching);
    r.finish(stop)
}

/// How a run stopped: at the phase's end (with the orientation), where the plan is over, or by itself before.
pub(super) enum Stop<K: Kernel> {
    PhaseEnd(Angle<K>),
    Over(Angle<K>),
    Early {
        kind: OutcomeKind,
        at: K::Time,
        angle: Angle<K>,
        branches: Vec<Branch>,
    },
}

impl<K: Kernel> Runner<'_, K> {
    fn go(&mut self, start: &Angle<K>, touching: &[Contact]) -> Stop<K> {
        let origin = self.clock.clone();
        if self.end <= origin {
            return Stop::PhaseEnd(start.clone());
        }
        let z = Point {
            chart: start.chart(),
            x: start.x.clone(),
            t: origin.clone(),
            on: Vec::new(),
        };
        let inc = incident(
            self.slice,
            &*self.sight,
            &Place::new(z.clone(), start.half_turn),
        );
        let next = self.begin(start, &z, &inc, touching);
        let known = self.set.method == Method::Auto && self.set.known.is_some();
        // By name every kernel that can vouch for F sweeps; of itself only the one that asks enclosures.
        let asked = K::CERTIFIED && self.set.method == Method::Sweep;
        let pays = K::ENCLOSES && self.set.method.sweeps(self.slice.arcs().len());
        if known || asked || pays {
            let seed = self.seed(&next, start, &z, &inc);
            self.look_from(seed);
        }
        let entry = Entry {
            inc: &inc,
            tangency: true,
            known: Some(touching),
        };
        if let Some(stop) = self.enter(next, start.clone(), &origin, &entry) {
            return stop;
        }
        let mut last = start.clone();
        loop {
            if (self.set.stop)() {
                let at = self.clock.clone();
                let angle = last;
                return Stop::Early {
                    kind: OutcomeKind::Undecided,
                    at,
                    angle,
                    branches: vec![],
                };
            }
            if let Some(stop) = self.step(&mut last) {
                return stop;
            }
        }
    }

    // ── steps ───────────────────────────────────────────────────────────────────────────────

    /// From the current state to the next time at which something touches it.
    fn step(&mut self, last: &mut Angle<K>) -> Option<Stop<K>> {
        let (z, half_turn) = match self.state {
            State::Rest => {
                let hit = self.sight.next_touch(&self.clock);
                let hit = hit.filter(|t| *t <= self.end);
                if let Some(over) = self.probe(hit.as_ref()) {
                    return Some(over);
                }
                let Some(t) = hit else {
                    return Some(self.complete(Angle::rest()));
                };
                let z = Point {
                    chart: Chart::Rest,
                    x: self.zero.clone(),
                    t,
                    on: Vec::new(),
                };
                (z, 0)
            }
            State::On { arc, half_turn, .. } => {
                let mut next = self.next_on(arc, half_turn);
                if !self.sight.vouches(next.as_ref()) {
                    self.look_from(None);
                    next = self.next_on(arc, half_turn);
                }
                if let Some(mu) = &self.friction
                    && let Some(t) = stick_time(self.slice, arc, &self.clock, mu)
                    && t < self.end
                    && next.as_ref().is_none_or(|z| t < z.t)
                {
                    let over = self.probe(Some(&t));
                    return over.or_else(|| Some(self.stick(arc, half_turn, t)));
                }
                if let Some(over) = self.probe(next.as_ref().map(|z| &z.t)) {
                    return Some(over);
                }
                match next {
                    Some(z) => (z, half_turn),
                    None => {
                        let x = self.position(arc, &self.end.clone());
                        return Some(self.complete(Angle { half_turn, x }));
                    }
                }
            }
        };
        let angle = Angle {
            half_turn,
            x: z.x.clone(),
        };
        *last = angle.clone();
        let at = z.t.clone();
        let at_rest = half_turn == 0 && z.chart == Chart::Rest && z.x.sign() == 0;
        let tangency = match self.state {
            State::On { arc, .. } => is_tangency(self.slice, arc, &z.x),
            State::Rest => false,
        };
        let place = Place::new(z, half_turn);
        let inc = incident(self.slice, &*self.sight, &place);
        self.degenerate += u64::from(is_degenerate(self.slice, &inc));
        let free = |arc: ArcId, above: bool| self.free_beside(arc, above, &at);
        let next = resolve(self.slice, &place, &inc, self.state, at_rest, &free);
        self.enter(
            next,
            angle,
            &at,
            &Entry {
                inc: &inc,
                tangency,
                known: None,
            },
        )
    }

    /// Where the state passes the probe before `next`: notes the orientation there, and stops if that is before
    /// the phase's end. What would happen later, nobody asks.
    fn probe(&mut self, next: Option<&K::Time>) -> Option<Stop<K>> {
        let at = self.set.probe.filter(|_| self.probed.is_none())?;
        if next.is_some_and(|n| n <= at) {
            return None;
        }
        let angle = match self.state {
            State::Rest => Angle::rest(),
            State::On { arc, half_turn, .. } => Angle {
                half_turn,
                x: self.position(arc, at),
            },
        };
        self.probed = Some(angle.clone());
        if self.end <= *at {
            return None;
        }
        self.cut(at, &angle, &angle);
        Some(Stop::Over(angle))
    }

    /// The next point at which anything meets the arc that the state follows.
    fn next_on(&self, id: ArcId, half_turn: i64) -> Option<Point<K>> {
        let slice = self.slice;
        let arc = slice.arc(id);
        let mut until = self.end.clone();
        let mut best: Option<Point<K>> = None;
        let mut take = |p: Point<K>, until: &mut K::Time| {
            if p.t > self.clock && p.t <= *until && best.as_ref().is_none_or(|b| p.t < b.t) {
                *until = p.t.clone();
                best = Some(p);
            }
        };
        let end = arc.end();
        take(
            Point {
                chart: arc.chart,
                x: end.x.clone(),
                t: end.t.clone(),
                on: vec![arc.curve],
            },
            &mut until,
        );
        if half_turn == 0 && matches!(arc.shape, Shape::Graph { .. }) && arc.spans_x(&self.zero) {
            let t = slice.time_at(arc, &self.zero);
            let x = self.zero.clone();
            take(
                Point {
                    chart: arc.chart,
                    x,
                    t,
                    on: vec![arc.curve],
                },
                &mut until,
            );
        }
        for &b in self.sight.along(arc.chart).iter() {
            if b != id
                && slice.arc(b).is_barrier()
                && let Some(p) = slice.first_meeting(id, b, &self.clock, &until)
            {
                take(p, &mut until);
            }
        }
        if arc.shape == Shape::Level && arc.lo.x.cmp_num(&K::side(false)).is_eq() {
            // On the seam: what comes from below lives in the other chart.
            let one = K::Num::one();
            for &b in self.sight.along(arc.chart.other()).iter() {
                let other = slice.arc(b);
                if other.is_barrier() && other.hi.x.cmp_num(&one).is_eq() {
                    let t = other.hi.t.clone();
                    if t <= arc.hi.t {
                        let x = arc.lo.x.clone();
                        take(
                            Point {
                                chart: arc.chart,
                                x,
                                t,
                                on: Vec::new(),
                            },
                            &mut until,
                        );
                    }
                }
            }
        }
        best
    }

    /// The position of an arc at an instant within it.
    pub(super) fn position(&self, id: ArcId, t: &K::Time) -> K::Root {
        let slice = self.slice;
        let arc = slice.arc(id);
        if arc.shape == Shape::Level {
            return arc.lo.x.clone();
        }
        for e in [&arc.lo, &arc.hi] {
            if e.t == *t {
                return e.x.clone();
            }
        }
        if let Some(r) = t.decided()
            && let Some(x) = slice.height_at(arc, &r)
        {
            return x;
        }
        let (p, q) = slice.curve(arc.curve).reduced(arc.chart);
        let about = slice.position_about(id, t.interval());
        let about = (K::ENCLOSES && about != arc.x_span).then_some(about);
        t.height(p, q, about, &mut |t| {
            // Outside its span the arc is bounded by its own ends.
            if arc.start().t.cmp_num(t).is_ge() {
                arc.start().x.clone()
            } else if arc.end().t.cmp_num(t).is_le() {
                arc.end().x.clone()
            } else {
                slice
                    .height_at(arc, t)
                    .unwrap_or_else(|| arc.start().x.clone())
            }
        })
    }
}

/// Whether more arcs meet than in general position, or an edge lies flush on an edge (DP §8.4.2,
/// Fig. 15: the constraints of two neighbouring vertices hold at once).
fn is_degenerate<K: Kernel>(slice: &Slice<K>, inc: &[Incident]) -> bool {
    let flush =
        |a: &Incident, b: &Incident| match (slice.arc(a.arc).contact, slice.arc(b.arc).contact) {
            (
                Contact::Obstacle {
                    obstacle: o,
                    kind: k,
                    ring: r,
                    obstacle_feature: f,
                    pawl_feature: p,
                },
                Contact::Obstacle {
                    obstacle,
                    kind,
                    ring,
                    obstacle_feature,
                    pawl_feature,
                },
            ) if (o, k, r) == (obstacle, kind, ring) => match k {
                ContactKind::B => f == obstacle_feature && p != pawl_feature,
                ContactKind::A => p == pawl_feature && f != obstacle_feature,
            },
            _ => false,
        };
    inc.len() > 2 || inc.iter().any(|a| inc.iter().any(|b| flush(a, b)))
}

/// How an instant was reached.
pub(super) struct Entry<'a> {
    /// The arcs at the place.
    pub(super) inc: &'a [Incident],
    /// Whether the curve that the state followed is vertically tangent there.
    pub(super) tangency: bool,
    /// At the start of a phase: the contacts that are known to touch.
    pub(super) known: Option<&'a [Contact]>,
}
