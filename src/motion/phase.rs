//! One pawl through one phase (DP §9).
//!
//! The state is at rest or on an arc. Find the next time at which anything touches it, look at
//! the place (the module `local`), go on. Which arcs are looked at is the method's affair (the module
//! `sight`): all of them, O(n) box tests a step, or those that the boundary of F names.

use super::friction::stick_time;
use super::ledger::FaceCost;
use super::local::{
    Incident, Landing, Next, Place, State, at_rest_next, contacts, group, incident, is_tangency,
    resolve, rests_on_level, right_sorted, settle, snap,
};
use super::sight::{All, Sight};
use super::solids::Solids;
use super::sweep::Sweep;
use super::trajectory::{Angle, Branch, Event, EventKind, OutcomeKind, Segment, Sliding};
use crate::contact::{Chart, Contact, ContactKind};
use crate::geometry::{Polygon, Vec2, interiors_intersect};
use crate::kernel::{Filtered, Instant, Kernel, Position};
use crate::number::{Rat, Scalar};
use crate::slice::{ArcId, Configuration, Free, Point, Shape, Slice, Whereabouts};
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

/// What a pawl's run needs besides the slice.
pub struct Setting<'a> {
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
    /// An instant at which the orientation is wanted (the root's collision).
    pub probe: Option<&'a Rat>,
    /// Asked between events; true ends the run undecided.
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
    /// The sweep over the free component (DP §9.2).
    #[default]
    Sweep,
    /// The simple algorithm: every step looks at every arc.
    Naive,
}

impl Method {
    /// The contract's word for it.
    pub fn name(self) -> &'static str {
        match self {
            Method::Sweep => "sweep",
            Method::Naive => "naive",
        }
    }
}

struct Runner<'a, K: Kernel> {
    slice: &'a Slice<K>,
    set: &'a Setting<'a>,
    /// Angular stops, μ and the probe in the kernel's numbers.
    limits: Option<(K::Num, K::Num)>,
    friction: Option<K::Num>,
    probe_at: Option<K::Num>,
    end: K::Time,
    zero: K::Root,
    state: State,
    /// The last instant that was looked at.
    clock: K::Time,
    /// When the current segment began, and the turns then.
    segment_from: K::Time,
    segment_winding: i64,
    /// Arcs that hold along the current segment, by contact; empty at rest.
    held: Vec<ArcId>,
    events: Vec<Event<K>>,
    segments: Vec<Segment<K>>,
    probed: Option<Angle<K>>,
    /// Which arcs are looked at.
    sight: Box<dyn Sight<K> + 'a>,
    /// What ran.
    method: Method,
    free: Option<Rc<Free>>,
    faces: FaceCost,
    degenerate: u64,
}

/// Runs a pawl from `start` through the phase of the slice. `touching` are the contacts already
/// known (the end of the phase before), which are not reported anew.
pub fn run<K: Kernel>(
    slice: &Slice<K>,
    set: &Setting<'_>,
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
        probe_at: set.probe.map(num),
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

/// How a run stopped: at the phase's end (with the orientation), or before it.
enum Stop<K: Kernel> {
    PhaseEnd(Angle<K>),
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
        if self.set.method == Method::Sweep && K::ENCLOSES {
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

    // ── the start of a phase ────────────────────────────────────────────────────────────────

    /// What follows at the first instant: the right limit, from nothing but the geometry.
    fn begin(
        &self,
        start: &Angle<K>,
        z: &Point<K>,
        inc: &[Incident],
        touching: &[Contact],
    ) -> Next {
        let slice = self.slice;
        let side = start.side();
        let toward = Next::Snap(-side);
        if inc.is_empty() {
            return if side == 0 { Next::Rest } else { toward };
        }
        let place = Place::new(z.clone(), start.half_turn);
        let right = right_sorted(slice, &place, inc);
        let (Some(bottom), Some(top)) = (right.first(), right.last()) else {
            return match self.free_along(z) {
                true if side == 0 => Next::Rest,
                true => toward,
                false => self.no_interval(inc),
            };
        };
        let up = self.free_beside(top.arc, true, &self.clock);
        let down = self.free_beside(bottom.arc, false, &self.clock);
        let free = |arc: ArcId, above: bool| self.free_beside(arc, above, &self.clock);
        if side == 0 && (up || down) {
            let next = at_rest_next(slice, Some((top.clone(), bottom.clone())), up, down);
            return match next {
                Next::Rest => next,
                _ if rests_on_level(slice, &place, inc, false, &free) => Next::Rest,
                _ => next,
            };
        }
        let (near_open, far_open) = if side > 0 { (down, up) } else { (up, down) };
        let near = if side > 0 { top } else { bottom };
        // What held the pawl in the phase before holds it still, if it can.
        if near_open && !(far_open && touching.contains(&slice.arc(near.arc).contact)) {
            return toward;
        }
        if far_open {
            return settle(slice, Some(near.clone()), side > 0, false);
        }
        // A cusp that opens here: between two neighbouring arcs.
        let cusps: Vec<usize> = (0..right.len() - 1)
            .filter(|&i| self.free_beside(right[i].arc, true, &self.clock))
            .collect();
        let pick = if side >= 0 {
            cusps.first()
        } else {
            cusps.last()
        };
        let Some(&i) = pick else {
            return self.no_interval(inc);
        };
        if side == 0 {
            let below = settle(slice, Some(right[i].clone()), true, true);
            if below != Next::Rest {
                return below;
            }
            return settle(slice, Some(right[i + 1].clone()), false, true);
        }
        let near = if side > 0 { &right[i] } else { &right[i + 1] };
        settle(slice, Some(near.clone()), side > 0, false)
    }

    /// A point of the state's own interval just after the start.
    fn seed(
        &self,
        next: &Next,
        start: &Angle<K>,
        z: &Point<K>,
        inc: &[Incident],
    ) -> Option<Spot<K>> {
        match *next {
            Next::Rest => self.rest_after(&self.clock),
            Next::Follow { arc, lower, .. } => self.beside(arc, lower, &self.clock),
            Next::Snap(dir) => {
                let place = Place::new(z.clone(), start.half_turn);
                let right = right_sorted(self.slice, &place, inc);
                match if dir < 0 { right.first() } else { right.last() } {
                    Some(near) => self.beside(near.arc, dir > 0, &self.clock),
                    None => Some(self.ahead(z)),
                }
            }
            Next::Fork { .. } | Next::Jam { .. } => None,
        }
    }

    /// A point of the interval that holds rest, or borders it, just after an instant.
    fn rest_after(&self, at: &K::Time) -> Option<Spot<K>> {
        let slice = self.slice;
        let lies = |&id: &ArcId| {
            let arc = slice.arc(id);
            arc.shape == Shape::Level
                && arc.is_barrier()
                && arc.lo.x.sign() == 0
                && slice.alive_after(arc, at)
        };
        if let Some(level) = slice.arcs_in(Chart::Rest).iter().copied().find(lies) {
            return [true, false]
                .into_iter()
                .filter_map(|above| self.beside(level, above, at))
                .find(|p| self.free_at(p.clone()));
        }
        let soon = self.within_phase(at, at.shift(&K::Num::one()));
        let next = All::new(slice).next_touch(at).filter(|n| *n < soon);
        let t = K::Time::between(at, &next.unwrap_or(soon));
        Some((Chart::Rest, K::Num::zero(), t))
    }

    /// Looks through F of a point, where there is one.
    fn look_from(&mut self, at: Option<Spot<K>>) {
        let free = at.and_then(|(chart, x, t)| {
            let (x, t) = (x.to_rat(), t.to_rat());
            let at = Configuration { chart, x, t };
            let known = self.free.iter().chain(&self.set.known);
            match known
                .into_iter()
                .find(|f| f.locate(&at) == Whereabouts::Inside)
            {
                Some(f) => {
                    self.faces.reused += 1;
                    Some(f.clone())
                }
                None => {
                    let made = Free::new(self.slice, &at, self.set.face);
                    made.inspect(|f| self.faces.found(f.found())).map(Rc::new)
                }
            }
        });
        match free {
            Some(free) => {
                self.free.get_or_insert_with(|| free.clone());
                self.sight = Box::new(Sweep::new(self.slice, free));
                self.method = Method::Sweep;
            }
            None => {
                self.faces.abandoned += u64::from(self.free.is_some());
                self.sight = Box::new(All::new(self.slice));
                self.method = Method::Naive;
            }
        }
    }

    /// The state has left F through a point: looks through the component that it has come to.
    fn look_again(&mut self, at: &K::Time) {
        let seed = match self.state {
            State::On { arc, lower, .. } => self.beside(arc, lower, at),
            State::Rest => self.rest_after(at),
        };
        self.look_from(seed);
        if !self.sight.entered(self.state, at) {
            // It does not border the component that was made for it: F cannot be trusted here.
            self.look_from(None);
        }
    }

    fn no_interval(&self, inc: &[Incident]) -> Next {
        let arcs: Vec<ArcId> = inc.iter().map(|i| i.arc).collect();
        let wall = |i: &Incident| i.germs.up || i.germs.down;
        let curve = |a: ArcId| self.slice.arc(a).curve;
        let single = inc.iter().any(wall) || arcs.windows(2).all(|w| curve(w[0]) == curve(w[1]));
        Next::Jam { arcs, single }
    }

    /// Whether the side of an arc is free just after `from`: by one polygon test at a rational
    /// point beside it, before anything meets the arc.
    fn free_beside(&self, id: ArcId, above: bool, from: &K::Time) -> bool {
        self.beside(id, above, from)
            .is_some_and(|p| self.free_at(p))
    }

    /// A rational point beside an arc just after `from`, before anything meets the arc.
    fn beside(&self, id: ArcId, above: bool, from: &K::Time) -> Option<Spot<K>> {
        let slice = self.slice;
        let arc = slice.arc(id);
        let mut until = self.within_phase(from, arc.end().t.clone());
        for &b in slice.arcs_in(arc.chart) {
            if b != id
                && let Some(p) = slice.first_meeting(id, b, from, &until)
            {
                until = p.t;
            }
        }
        let t = K::Time::between(from, &until);
        let x = slice.height_at(arc, &t)?;
        Some(self.near(arc.chart, &x, &t, above))
    }

    /// `until`, but not past the phase's end: what can only be met after it was never made.
    fn within_phase(&self, from: &K::Time, until: K::Time) -> K::Time {
        if *from < self.end && self.end < until {
            self.end.clone()
        } else {
            until
        }
    }

    /// What must hold just after an instant, by the polygons alone: the state's own interval is
    /// free beside it, and at rest nothing penetrates. Asked by debug assertions only.
    fn holds_after(&self, at: &K::Time) -> bool {
        match self.state {
            State::On { arc, lower, .. } => self.free_beside(arc, lower, at),
            State::Rest => {
                let next = self.sight.next_touch(at);
                let soon = self.within_phase(at, at.shift(&K::Num::one()));
                let t = K::Time::between(at, &next.filter(|n| *n < soon).unwrap_or(soon));
                self.clear_at(Chart::Rest, &K::Num::zero(), &t)
            }
        }
    }

    /// Whether the configuration is free just after the start along the horizontal through z,
    /// where no arc leaves z to the right.
    fn free_along(&self, z: &Point<K>) -> bool {
        self.free_at(self.ahead(z))
    }

    /// A rational point just after the start along the horizontal through z, where no arc leaves z to the
    /// right.
    fn ahead(&self, z: &Point<K>) -> Spot<K> {
        let slice = self.slice;
        let mut until = self.within_phase(&self.clock, K::Time::of(K::Num::one()));
        for &b in slice.arcs_in(z.chart) {
            let arc = slice.arc(b);
            if !arc.spans_x(&z.x) {
                continue;
            }
            let t = match arc.shape {
                Shape::Graph { .. } => slice.time_at(arc, &z.x),
                _ => arc.lo.t.clone(),
            };
            if t > self.clock && t < until {
                until = t;
            }
        }
        self.near(z.chart, &z.x, &K::Time::between(&self.clock, &until), true)
    }

    /// Time t and an orientation just above (or below) x, nearer than any other arc at that time.
    fn near(&self, chart: Chart, x: &K::Root, t: &K::Num, above: bool) -> Spot<K> {
        let slice = self.slice;
        let seam = K::Root::of(K::side(above));
        let mut bound = seam;
        for &b in slice.arcs_in(chart) {
            let arc = slice.arc(b);
            let when = K::Time::of(t.clone());
            if arc.start().t > when || arc.end().t < when {
                continue;
            }
            let Some(h) = slice.height_at(arc, t) else {
                continue;
            };
            if above && h > *x && h < bound || !above && h < *x && h > bound {
                bound = h;
            }
        }
        if bound == *x {
            // At the seam itself: look from the other chart.
            let x = K::Root::of(K::side(!above));
            return self.near(chart.other(), &x, t, above);
        }
        (chart, K::Root::between(x, &bound), t.clone())
    }

    /// Whether a rational point is free: between the stops, and the pawl's interior clear of every
    /// obstacle's.
    fn free_at(&self, (chart, at, t): Spot<K>) -> bool {
        if let Some((lo, hi)) = &self.limits {
            let angle: Angle<K> = Angle {
                half_turn: chart.index() as i64,
                x: K::Root::of(at.clone()),
            };
            // Stops leave less than a turn, so any lift that lies between them will do.
            let (lo, hi): (Angle<K>, Angle<K>) =
                (Angle::from_tan_half(lo), Angle::from_tan_half(hi));
            let inside = [0, -2].iter().any(|turn| {
                let a = Angle {
                    half_turn: angle.half_turn + turn,
                    x: angle.x.clone(),
                };
                lo.cmp(&a).is_lt() && a.cmp(&hi).is_lt()
            });
            if !inside {
                return false;
            }
        }
        self.clear_at(chart, &at, &t)
    }

    /// Whether the pawl's interior is clear of every obstacle's at a rational time and position.
    fn clear_at(&self, chart: Chart, at: &K::Num, t: &K::Num) -> bool {
        // Exact for the numbers given, also where those are doubles.
        let (at, t) = (&at.to_rat(), &t.to_rat());
        let exact = |p: &Vec2<K::Num>| Vec2::new(p.x.to_rat(), p.y.to_rat());
        let frame = &self.slice.frame;
        let p = &exact(&frame.p0) + &exact(&frame.v).scale(t);
        let ring = self.set.shape.rings()[0]
            .iter()
            .map(|a| {
                let turned = a.rotate_tan_half(at);
                let turned = if chart == Chart::Back {
                    -&turned
                } else {
                    turned
                };
                &turned + &p
            })
            .collect::<Vec<Vec2>>();
        let moved = Polygon::new(ring, Vec::new());
        !self
            .set
            .obstacles
            .iter()
            .any(|o| interiors_intersect(&moved, o))
    }

    // ── steps ───────────────────────────────────────────────────────────────────────────────

    /// From the current state to the next time at which something touches it.
    fn step(&mut self, last: &mut Angle<K>) -> Option<Stop<K>> {
        let (z, half_turn) = match self.state {
            State::Rest => {
                let hit = self.sight.next_touch(&self.clock);
                let hit = hit.filter(|t| *t <= self.end);
                self.probe(hit.as_ref());
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
                    self.probe(Some(&t));
                    return Some(self.stick(arc, half_turn, t));
                }
                self.probe(next.as_ref().map(|z| &z.t));
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

    /// Notes the orientation at the probe if the state passes it before `next`.
    fn probe(&mut self, next: Option<&K::Time>) {
        let Some(t) = self.probe_at.as_ref().filter(|_| self.probed.is_none()) else {
            return;
        };
        if next.is_some_and(|n| n.cmp_num(t).is_le()) {
            return;
        }
        self.probed = Some(match self.state {
            State::Rest => Angle::rest(),
            State::On { arc, half_turn, .. } => Angle {
                half_turn,
                x: self.position(arc, &K::Time::of(t.clone())),
            },
        });
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
    fn position(&self, id: ArcId, t: &K::Time) -> K::Root {
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
        t.height(p, q, &mut |t| {
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

    // ── what happens at an instant ──────────────────────────────────────────────────────────

    fn event(&mut self, kind: EventKind, at: &K::Time, angle: &Angle<K>, contacts: Vec<Contact>) {
        self.events.push(Event {
            kind,
            time: at.clone(),
            phase: self.set.phase,
            angle: angle.clone(),
            to: None,
            contacts,
            root_contacts: Vec::new(),
        });
    }

    /// Carries out what follows at an instant: reports it and changes the state.
    fn enter(
        &mut self,
        next: Next,
        angle: Angle<K>,
        at: &K::Time,
        entry: &Entry<'_>,
    ) -> Option<Stop<K>> {
        let last = *at == self.end;
        let stop = match next {
            Next::Rest => {
                self.come_to_rest(&angle, at, entry);
                None
            }
            Next::Follow {
                arc,
                half_turn,
                lower,
            } => self.follow(arc, half_turn, lower, &angle, at, entry),
            // What would begin at a phase's last instant belongs to the next phase.
            Next::Snap(_) if last => None,
            Next::Snap(dir) => self.snap(dir, &angle, at, entry),
            Next::Jam { arcs, single } => {
                let mut touching = contacts(self.slice, &arcs);
                touching.extend(contacts(self.slice, &self.held));
                touching.sort();
                touching.dedup();
                if last {
                    self.touch(at, &angle, touching);
                    None
                } else {
                    let kind = if single {
                        EventKind::JamSingle
                    } else {
                        EventKind::JamIncompatible
                    };
                    Some(self.early(OutcomeKind::Jammed, kind, at, angle.clone(), touching))
                }
            }
            Next::Fork { up, down } => self.fork(up, down, &angle, at, last),
        };
        self.clock = at.clone();
        if stop.is_none() && !self.sight.entered(self.state, at) {
            self.look_again(at);
        }
        debug_assert!(
            !K::CERTIFIED || stop.is_some() || last || self.holds_after(at),
            "the state's interval is free"
        );
        match stop {
            None if last => Some(self.complete(angle)),
            stop => stop,
        }
    }

    fn come_to_rest(&mut self, angle: &Angle<K>, at: &K::Time, entry: &Entry<'_>) {
        if self.held.is_empty() {
            // A touch without effect, where nothing was touching before or is after.
            let lying = |i: &Incident| self.slice.arc(i.arc).shape == Shape::Level;
            if entry.known.is_none() && !entry.inc.is_empty() && !entry.inc.iter().any(lying) {
                let arcs: Vec<ArcId> = entry.inc.iter().map(|i| i.arc).collect();
                self.event(EventKind::Graze, at, angle, contacts(self.slice, &arcs));
            }
        } else {
            let released = contacts(self.slice, &self.held);
            self.cut(at, angle, angle);
            self.event(EventKind::Release, at, angle, released);
        }
        self.held.clear();
        self.state = State::Rest;
    }

    fn follow(
        &mut self,
        arc: ArcId,
        half_turn: i64,
        lower: bool,
        angle: &Angle<K>,
        at: &K::Time,
        entry: &Entry<'_>,
    ) -> Option<Stop<K>> {
        let slice = self.slice;
        let arcs = group(slice, &*self.sight, arc, at);
        let first = arcs.first().copied().unwrap_or(arc);
        let (old, new) = (contacts(slice, &self.held), contacts(slice, &arcs));
        let same = self.same_constraint(first, &arcs);
        let mut fresh: Vec<Contact> = new.iter().filter(|c| !old.contains(c)).copied().collect();
        if fresh.is_empty() {
            fresh = new.clone();
        }
        let limit = new.iter().all(|c| matches!(c, Contact::Limit(_)));
        let kind = match (entry.known, self.state) {
            (Some(known), _) if new.iter().all(|c| known.contains(c)) => None,
            (Some(_), _) if limit => Some(EventKind::LimitStop),
            (Some(_), _) if angle.side() != 0 => None,
            (_, State::Rest) if limit => Some(EventKind::LimitStop),
            (_, State::Rest) => Some(EventKind::TranslationalCollision),
            _ if same => None,
            _ if limit => Some(EventKind::LimitStop),
            _ => Some(EventKind::SlidingCollision),
        };
        // A seam, or the joint of a split edge, cuts the segment and is no event; so does a
        // point where the discriminant vanishes, since the branch changes there.
        let key = |id: ArcId| {
            let a = slice.arc(id);
            (a.curve, a.branch, a.shape == Shape::Level)
        };
        if old != new || self.held.first().map(|&h| key(h)) != Some(key(first)) {
            self.cut(at, angle, angle);
        }
        if let Some(kind) = kind {
            self.event(kind, at, angle, fresh);
        }
        self.held = arcs;
        self.state = State::On {
            arc: first,
            half_turn,
            lower,
        };
        if same || *at == self.end {
            return None;
        }
        self.hold(first, at, angle)
    }

    /// Sticks at once where friction holds the contact that the state has begun to follow.
    fn hold(&mut self, arc: ArcId, at: &K::Time, angle: &Angle<K>) -> Option<Stop<K>> {
        let mu = self.friction.as_ref()?;
        let t = stick_time(self.slice, arc, at, mu)?;
        if t != *at {
            return None;
        }
        let touching = contacts(self.slice, &self.held);
        Some(self.early(
            OutcomeKind::Stuck,
            EventKind::Stick,
            at,
            angle.clone(),
            touching,
        ))
    }

    /// Sticks on the way along an arc.
    fn stick(&mut self, arc: ArcId, half_turn: i64, at: K::Time) -> Stop<K> {
        let angle = Angle {
            half_turn,
            x: self.position(arc, &at),
        };
        let touching = contacts(self.slice, &self.held);
        self.early(OutcomeKind::Stuck, EventKind::Stick, &at, angle, touching)
    }

    /// Ends the run with an event.
    fn early(
        &mut self,
        kind: OutcomeKind,
        event: EventKind,
        at: &K::Time,
        angle: Angle<K>,
        touching: Vec<Contact>,
    ) -> Stop<K> {
        self.cut(at, &angle, &angle);
        self.event(event, at, &angle, touching);
        Stop::Early {
            kind,
            at: at.clone(),
            angle,
            branches: Vec::new(),
        }
    }

    /// The snap: pure rotation towards rest, up to the first arc in the way (DP §8.1).
    fn snap(
        &mut self,
        dir: i32,
        angle: &Angle<K>,
        at: &K::Time,
        entry: &Entry<'_>,
    ) -> Option<Stop<K>> {
        let slice = self.slice;
        let released = contacts(slice, &self.held);
        let (x, half_turn) = (&angle.x, angle.half_turn);
        let mut landing = snap(slice, &*self.sight, x, half_turn, at, dir, entry.inc);
        let on = match landing {
            Landing::Rest => None,
            Landing::On { arc, .. } => Some((arc, dir < 0)),
        };
        if !self.sight.lands(on, at) {
            self.look_from(None);
            landing = snap(slice, &*self.sight, x, half_turn, at, dir, entry.inc);
        }
        let (to, target) = match landing {
            Landing::Rest => (Angle::rest(), None),
            Landing::On { arc, half_turn } => (
                Angle {
                    half_turn,
                    x: self.position(arc, at),
                },
                Some((arc, half_turn)),
            ),
        };
        self.cut(at, angle, &to);
        let kind = if entry.tangency {
            EventKind::SnapFree
        } else {
            EventKind::SnapFreeVertex
        };
        self.event(kind, at, angle, released);
        if let Some(e) = self.events.last_mut() {
            e.to = Some(to.clone());
        }
        let Some((arc, half_turn)) = target else {
            self.held.clear();
            self.state = State::Rest;
            return None;
        };
        self.held = group(slice, &*self.sight, arc, at);
        let first = self.held.first().copied().unwrap_or(arc);
        self.state = State::On {
            arc: first,
            half_turn,
            lower: dir < 0,
        };
        let touching = contacts(slice, &self.held);
        let limit = touching.iter().all(|c| matches!(c, Contact::Limit(_)));
        self.event(EventKind::SnapLanding, at, &to, touching.clone());
        if limit {
            self.event(EventKind::LimitStop, at, &to, touching);
        }
        self.hold(first, at, &to)
    }

    /// Struck at rest so that both ways round are open.
    fn fork(
        &mut self,
        up: ArcId,
        down: ArcId,
        angle: &Angle<K>,
        at: &K::Time,
        last: bool,
    ) -> Option<Stop<K>> {
        let slice = self.slice;
        let mut branches = Vec::new();
        for (direction, arc) in [(1, up), (-1, down)] {
            let arcs = group(slice, &*self.sight, arc, at);
            let first = arcs.first().copied().unwrap_or(arc);
            let sticks = self
                .friction
                .as_ref()
                .and_then(|mu| stick_time(slice, first, at, mu))
                .is_some_and(|t| t == *at);
            branches.push(Branch {
                direction,
                contacts: contacts(slice, &arcs),
                sticks,
            });
        }
        let mut all: Vec<Contact> = branches.iter().flat_map(|b| b.contacts.clone()).collect();
        all.sort();
        all.dedup();
        if last {
            self.touch(at, angle, all);
            return None;
        }
        if branches.iter().all(|b| b.sticks) {
            return Some(self.early(OutcomeKind::Stuck, EventKind::Stick, at, angle.clone(), all));
        }
        let (kind, event) = (OutcomeKind::Bifurcated, EventKind::Bifurcation);
        match self.early(kind, event, at, angle.clone(), all) {
            Stop::Early {
                kind, at, angle, ..
            } => Some(Stop::Early {
                kind,
                at,
                angle,
                branches,
            }),
            stop => Some(stop),
        }
    }

    /// Reports contacts made at a phase's last instant.
    fn touch(&mut self, at: &K::Time, angle: &Angle<K>, mut fresh: Vec<Contact>) {
        let old = contacts(self.slice, &self.held);
        fresh.retain(|c| !old.contains(c));
        if !fresh.is_empty() {
            let kind = match self.state {
                State::Rest => EventKind::TranslationalCollision,
                State::On { .. } => EventKind::SlidingCollision,
            };
            self.event(kind, at, angle, fresh);
        }
    }

    /// Whether going on along `arc` is no change of constraint.
    fn same_constraint(&self, arc: ArcId, arcs: &[ArcId]) -> bool {
        let State::On { arc: before, .. } = self.state else {
            return false;
        };
        let (a, b) = (self.slice.arc(before), self.slice.arc(arc));
        let one_curve = a.curve == b.curve
            && (a.branch == b.branch || a.shape == Shape::Level || b.shape == Shape::Level);
        one_curve || self.slice.coincide(before, arc) || arcs.iter().any(|x| self.held.contains(x))
    }

    // ── segments and the end ────────────────────────────────────────────────────────────────

    /// Ends the current segment; the next one begins with the orientation `after`.
    fn cut(&mut self, at: &K::Time, before: &Angle<K>, after: &Angle<K>) {
        if *at > self.segment_from {
            let sliding = self.held.first().map(|&first| {
                let arc = self.slice.arc(first);
                let curve = self.slice.curve(arc.curve);
                let also = contacts(self.slice, &self.held);
                Sliding {
                    contact: arc.contact,
                    also: also.into_iter().filter(|c| *c != arc.contact).collect(),
                    p: curve.p.clone(),
                    q: curve.q.clone(),
                    branch: arc.branch,
                }
            });
            self.segments.push(Segment {
                phase: self.set.phase,
                from: self.segment_from.clone(),
                to: at.clone(),
                winding: [self.segment_winding, before.winding()],
                sliding,
            });
        }
        self.segment_from = at.clone();
        self.segment_winding = after.winding();
    }

    fn complete(&mut self, angle: Angle<K>) -> Stop<K> {
        let end = self.end.clone();
        self.cut(&end, &angle, &angle);
        Stop::PhaseEnd(angle)
    }

    fn finish(mut self, stop: Stop<K>) -> Run<K> {
        let (angle, end) = match stop {
            Stop::PhaseEnd(angle) => (angle, None),
            Stop::Early {
                kind,
                at,
                angle,
                branches,
            } => (angle, Some((kind, at, branches))),
        };
        let mut touching = Vec::new();
        if end.is_none() {
            let on = self.held.iter().map(|&h| self.slice.arc(h).curve).collect();
            let z = Point {
                chart: angle.chart(),
                x: angle.x.clone(),
                t: self.end.clone(),
                on,
            };
            let inc = incident(self.slice, &*self.sight, &Place::new(z, angle.half_turn));
            let arcs: Vec<ArcId> = inc.iter().map(|i| i.arc).collect();
            touching = contacts(self.slice, &arcs);
        }
        // One kind at one instant is one event; kinds follow in the contract's order. Grouping is
        // stable in time, since events are made in order of time.
        let mut events: Vec<Event<K>> = Vec::new();
        for e in std::mem::take(&mut self.events) {
            match events.last_mut() {
                Some(l) if l.kind == e.kind && l.time == e.time && l.to.is_none() => {
                    l.contacts.extend(e.contacts);
                    l.contacts.sort();
                    l.contacts.dedup();
                }
                _ => events.push(e),
            }
        }
        let probed = self.probed.unwrap_or_else(|| angle.clone());
        Run {
            events,
            segments: self.segments,
            end,
            angle,
            probed,
            touching,
            degenerate: self.degenerate,
            method: self.method,
            free: self.free,
            faces: self.faces,
        }
    }
}

/// A rational point of the cylinder in the kernel's numbers: chart, position, time.
type Spot<K> = (Chart, <K as Kernel>::Num, <K as Kernel>::Num);

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
struct Entry<'a> {
    /// The arcs at the place.
    inc: &'a [Incident],
    /// Whether the curve that the state followed is vertically tangent there.
    tangency: bool,
    /// At the start of a phase: the contacts that are known to touch.
    known: Option<&'a [Contact]>,
}
