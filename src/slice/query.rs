//! Questions to F: where a configuration lies, and which orientations are free at a time.

use super::free::time_of;
use super::{Configuration, Free, Interval, Owner, Shape, Slice, Time, Whereabouts};
use crate::contact::Chart;
use crate::geometry::index::Hull;
use crate::kernel::{Instant as _, Kernel};
use crate::number::{Rat, Scalar};
use crate::slice::ArcId;
use std::cmp::Ordering;

impl Free {
    /// Where a configuration lies.
    ///
    /// The highest edge below it along t decides. O(log |F|) where boxes tell apart.
    pub fn locate(&self, at: &Configuration) -> Whereabouts {
        self.look(at, false)
    }

    /// Where a configuration lies, or (`after`) whether the points right after it, at the same orientation, lie
    /// in F: what passes through it then lies below them.
    fn look(&self, at: &Configuration, after: bool) -> Whereabouts {
        if at.t.sign() < 0 || at.t > self.duration {
            return Whereabouts::Outside;
        }
        let mut k = self.kernel();
        let x = if at.chart == Chart::Back {
            &at.x + &Rat::from(2)
        } else {
            at.x.clone()
        };
        let (xn, height) = (k.rational(&x), k.constant(&at.t));
        let (xi, ti) = (x.interval(), at.t.interval());
        // Below the point, or on it: the edges over x that end to the right of it or over it.
        let mut near = Vec::new();
        self.tree.query(
            &Hull::boxed([xi.lo, xi.hi, f64::NEG_INFINITY, ti.hi]),
            |e| {
                near.push(e);
                true
            },
        );
        let mut best: Option<(u32, bool)> = None;
        for e in near {
            let edge = &self.edges[e as usize];
            let (l, r) = (k.cmp(edge.ends[0], xn), k.cmp(xn, edge.ends[1]));
            if l.is_gt() || r.is_gt() {
                continue;
            }
            if edge.shape == Shape::Level {
                if after {
                    // It blocks one orientation alone, and bounds nothing from above or below.
                    continue;
                }
                let on = [edge.low, edge.high].map(|v| {
                    time_of(
                        &mut k,
                        self.vertices[v as usize].num,
                        self.vertices[v as usize].curve,
                    )
                    .cmp_rat(&at.t)
                });
                if on[0].is_le() && on[1].is_ge() {
                    return Whereabouts::Boundary;
                }
                continue;
            }
            match k.cmp_at(edge.curve, height, xn) {
                Ordering::Equal if after => {}
                Ordering::Equal => return Whereabouts::Boundary,
                Ordering::Greater => continue,
                Ordering::Less => {}
            }
            // Of edges that meet right below: the topmost one to the left decides; the strip's left
            // border is looked at from its right.
            let border = x == Rat::from(-1);
            if if border { r.is_eq() } else { l.is_eq() } {
                continue;
            }
            let higher = best.is_none_or(|(o, _)| {
                let other = self.edges[o as usize].curve;
                k.cmp_at(edge.curve, other, xn)
                    .then_with(|| k.cmp_beside(edge.curve, other, xn, border))
                    .is_gt()
            });
            if higher {
                let later = if edge.left_is_above {
                    edge.above
                } else {
                    edge.below
                };
                best = Some((e, later));
            }
        }
        match best {
            Some((_, true)) => Whereabouts::Inside,
            _ => Whereabouts::Outside,
        }
    }

    /// The intervals of orientation in F just after a time, by ascending lower ends on the strip (rest
    /// chart, then back chart). None where all orientations are in F.
    ///
    /// O(a log a) for the a arcs of F's boundary alive then.
    pub fn intervals<K: Kernel>(&self, slice: &Slice<K>, t: &Rat) -> Option<Vec<Interval>> {
        let when = Time::from(t.clone());
        let now = K::Time::of(K::Num::from_rat(t));
        let ti = t.interval();
        let mut alive: Vec<(u32, ArcId)> = Vec::new();
        let mut near = Vec::new();
        self.edges_near([-2.0, 4.0], [ti.lo, ti.hi], |e| near.push(e));
        for e in near {
            let edge = &self.edges[e as usize];
            if let (Owner::Arc(a), Shape::Graph { .. } | Shape::Level) = (edge.owner, edge.shape)
                && self.cmp_time(edge.first(), &when).is_le()
                && self.cmp_time(edge.last(), &when).is_gt()
            {
                alive.push((e, a));
            }
        }
        // A level on the cut lies at one of the strip's two ends, whichever chart its arc is named in.
        let mut k = self.kernel();
        let ends = [-1, 3].map(|x| k.rational(&Rat::from(x)));
        let mut end = |e: u32| {
            let edge = &self.edges[e as usize];
            match edge.shape {
                Shape::Level if k.cmp(edge.ends[0], ends[0]).is_eq() => -1,
                Shape::Level if k.cmp(edge.ends[0], ends[1]).is_eq() => 1,
                _ => 0,
            }
        };
        let mut alive: Vec<(i32, u32, ArcId)> =
            alive.into_iter().map(|(e, a)| (end(e), e, a)).collect();
        // Others ask it below.
        drop(k);
        alive.sort_by(|p, q| {
            let (a, b) = (slice.arc(p.2), slice.arc(q.2));
            p.0.cmp(&q.0)
                .then(a.chart.cmp(&b.chart))
                .then_with(|| slice.cmp_heights_after(p.2, q.2, &now))
        });
        let position = |e: u32, a: ArcId| {
            let arc = slice.arc(a);
            let x = slice
                .height_at(arc, &K::Num::from_rat(t))
                .unwrap_or_else(|| arc.start().x.clone());
            (e, crate::kernel::Position::<K>::publish(&x))
        };
        let (mut out, mut open, mut first_high) = (Vec::new(), None, None);
        for &(_, e, a) in &alive {
            let edge = &self.edges[e as usize];
            if edge.below {
                let high = position(e, a);
                match open.take() {
                    Some(low) => out.push(Interval { low, high }),
                    None => first_high = Some(high),
                }
            }
            if edge.above {
                open = Some(position(e, a));
            }
        }
        if let (Some(low), Some(high)) = (open, first_high) {
            out.push(Interval { low, high });
        }
        if out.is_empty() {
            let all = |x: i64| Configuration {
                chart: Chart::Rest,
                x: Rat::frac(x, 7919),
                t: t.clone(),
            };
            // Nothing bounds F just after t: one orientation speaks for all. At t itself it may lie on the
            // phase's start, or where an arc has just ended.
            if self.look(&all(3), true) == Whereabouts::Inside {
                return None;
            }
        }
        Some(out)
    }
}
