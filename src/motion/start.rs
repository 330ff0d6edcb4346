//! The first instant of a phase (contract: *start*, *right limit*) and the choice of the component that is
//! looked through.
//!
//! At a phase's start nothing is known of the state but its orientation: what it follows next is
//! read off the geometry alone, by the arcs that leave the place and polygon tests beside them.

use super::beside::Spot;
use super::local::{
    Incident, Next, Place, State, at_rest_next, rests_on_level, right_sorted, settle,
};
use super::phase::{Method, Runner};
use super::sight::All;
use super::sweep::Sweep;
use super::trajectory::Angle;
use crate::contact::Contact;
use crate::kernel::Kernel;
use crate::number::Scalar;
use crate::slice::{ArcId, Configuration, Free, Point, Whereabouts};
use std::rc::Rc;

impl<K: Kernel> Runner<'_, K> {
    /// What follows at the first instant: the right limit, from nothing but the geometry.
    pub(super) fn begin(
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
    pub(super) fn seed(
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

    /// Looks through F of a point, where there is one.
    pub(super) fn look_from(&mut self, at: Option<Spot<K>>) {
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
                    let made = Free::unless(self.slice, &at, self.set.face, self.set.stop);
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
    pub(super) fn look_again(&mut self, at: &K::Time) {
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

    pub(super) fn no_interval(&self, inc: &[Incident]) -> Next {
        let arcs: Vec<ArcId> = inc.iter().map(|i| i.arc).collect();
        let wall = |i: &Incident| i.germs.up || i.germs.down;
        let curve = |a: ArcId| self.slice.arc(a).curve;
        let single = inc.iter().any(wall) || arcs.windows(2).all(|w| curve(w[0]) == curve(w[1]));
        Next::Jam { arcs, single }
    }
}
