//! What happens at an instant: each way on is carried out and reported (DP §9.2's events).
//!
//! `local` has decided what follows; here the state changes, events are noted and segments cut.

use super::friction::stick_time;
use super::local::{Incident, Landing, Next, State, contacts, group, snap};
use super::phase::{Entry, Runner, Stop};
use super::trajectory::{Angle, Branch, Event, EventKind, OutcomeKind};
use crate::contact::Contact;
use crate::kernel::Kernel;
use crate::slice::{ArcId, Shape};

impl<K: Kernel> Runner<'_, K> {
    pub(super) fn event(
        &mut self,
        kind: EventKind,
        at: &K::Time,
        angle: &Angle<K>,
        contacts: Vec<Contact>,
    ) {
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
    pub(super) fn enter(
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

    pub(super) fn come_to_rest(&mut self, angle: &Angle<K>, at: &K::Time, entry: &Entry<'_>) {
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

    pub(super) fn follow(
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
    pub(super) fn hold(&mut self, arc: ArcId, at: &K::Time, angle: &Angle<K>) -> Option<Stop<K>> {
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
    pub(super) fn stick(&mut self, arc: ArcId, half_turn: i64, at: K::Time) -> Stop<K> {
        let angle = Angle {
            half_turn,
            x: self.position(arc, &at),
        };
        let touching = contacts(self.slice, &self.held);
        self.early(OutcomeKind::Stuck, EventKind::Stick, &at, angle, touching)
    }

    /// Ends the run with an event.
    pub(super) fn early(
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
    pub(super) fn snap(
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
    pub(super) fn fork(
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
    pub(super) fn touch(&mut self, at: &K::Time, angle: &Angle<K>, mut fresh: Vec<Contact>) {
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
    pub(super) fn same_constraint(&self, arc: ArcId, arcs: &[ArcId]) -> bool {
        let State::On { arc: before, .. } = self.state else {
            return false;
        };
        let (a, b) = (self.slice.arc(before), self.slice.arc(arc));
        let one_curve = a.curve == b.curve
            && (a.branch == b.branch || a.shape == Shape::Level || b.shape == Shape::Level);
        one_curve || self.slice.coincide(before, arc) || arcs.iter().any(|x| self.held.contains(x))
    }
}
