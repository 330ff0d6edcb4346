//! Segments, and what a run hands back.

use super::local::{Place, contacts, incident};
use super::phase::{Run, Runner, Stop};
use super::trajectory::{Angle, Event, Segment, Sliding};
use crate::kernel::Kernel;
use crate::slice::{ArcId, Point};

impl<K: Kernel> Runner<'_, K> {
    /// Ends the current segment; the next one begins with the orientation `after`.
    pub(super) fn cut(&mut self, at: &K::Time, before: &Angle<K>, after: &Angle<K>) {
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

    pub(super) fn complete(&mut self, angle: Angle<K>) -> Stop<K> {
        let end = self.end.clone();
        self.cut(&end, &angle, &angle);
        Stop::PhaseEnd(angle)
    }

    pub(super) fn finish(mut self, stop: Stop<K>) -> Run<K> {
        let completed = matches!(stop, Stop::PhaseEnd(_));
        let (angle, end) = match stop {
            Stop::PhaseEnd(angle) | Stop::Over(angle) => (angle, None),
            Stop::Early {
                kind,
                at,
                angle,
                branches,
            } => (angle, Some((kind, at, branches))),
        };
        let mut touching = Vec::new();
        if completed {
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
