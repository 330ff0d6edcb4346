//! Within a cluster: where the members pass one another, seen from a frame.
//!
//! The idea: k arcs that pass near one another, but not through one point, have k²/2 crossings in a place too small for
//! doubles, and few of them lie on the face. Seen from a frame in that place (`frames.rs`) each arc is known in doubles:
//! how far it lies above another at the frame, and how steep it is. So where two of them cross is enclosed by a
//! difference and a quotient, without a name for the crossing. What an item meets is brought into order by that, and
//! the item's range is cut between the enclosures, in halves, down to the few that a walk passes: only those are
//! found exactly.

use super::approx::Approx;
use super::item::{Carrier, Item, NONE};
use super::kernel::{CurveId, Kernel, NumId};
use super::trace::Tracer;
use super::windows::{Cut, Window};

/// Where many curves pass so near one another that doubles do not tell them apart: `half` to either side of `middle`.
#[derive(Clone, Copy)]
pub(super) struct Core {
    pub(super) middle: f64,
    pub(super) half: f64,
}

impl Core {
    /// Its ends, rounded.
    pub(super) fn range(&self) -> (f64, f64) {
        (self.middle - self.half, self.middle + self.half)
    }

    /// The part of the axis just outside of which something may be asked again.
    pub(super) fn crowded(&self) -> (f64, f64) {
        let (from, to) = self.range();
        (
            from.next_down().next_down().next_down(),
            to.next_up().next_up().next_up(),
        )
    }
}

/// The members of a cluster, seen from a frame in it.
pub(super) struct Cluster {
    frame: u32,
    /// A double in the core.
    middle: f64,
    /// So near to the frame `near` holds.
    reach: f64,
    /// By item.
    members: Vec<Member>,
}

/// An item of a cluster.
struct Member {
    item: u32,
    curve: CurveId,
    /// Its height at the frame, above a curve that all are compared with.
    height: Approx,
    /// Its slopes all over the crowded part, and next to the frame.
    slopes: Approx,
    near: Approx,
    /// An enclosure of its range.
    range: (f64, f64),
}

/// Where another item may meet this one: an enclosure of the distance from the frame.
#[derive(Clone, Copy)]
struct Meeting {
    lo: f64,
    hi: f64,
    /// No meeting before this one lies right of it, and none from this one on left of it.
    before: f64,
    after: f64,
    other: u32,
}

/// What an item meets within a cluster.
pub(super) struct Fan {
    /// Members, by the places.
    meetings: Vec<Meeting>,
    /// Those whose places are not known, and items outside of the cluster.
    others: Vec<u32>,
    frame: u32,
    middle: f64,
    /// The window of which they are.
    from: f64,
    to: f64,
}

/// A window within a cluster that has no more meetings than this is not halved.
const ENOUGH: usize = 6;

impl Cluster {
    /// The cluster of items that pass near one another in a core, one crossing in which is given.
    pub(super) fn new(
        k: &mut Kernel,
        items: &[Item],
        core: Core,
        x: NumId,
        mut members: Vec<u32>,
    ) -> Cluster {
        let frame = k.frame_of(x);
        let (lo, hi) = k.frame_range(frame);
        let (a, b) = core.crowded();
        let whole = Approx::between(a.min(lo), b.max(hi));
        let next = Approx::between(lo.next_down(), hi.next_up());
        members.sort_unstable();
        let members = members
            .into_iter()
            .filter_map(|item| {
                let Item { carrier, l, r, .. } = items[item as usize];
                let Carrier::Graph(curve) = carrier else {
                    return None;
                };
                Some(Member {
                    item,
                    curve,
                    height: k.height_in_frame(curve, frame).unwrap_or(UNKNOWN),
                    slopes: k.slope_over(curve, whole),
                    near: k.slope_over(curve, next),
                    range: (k.enclosure(l).0, k.enclosure(r).1),
                })
            })
            .collect();
        Cluster {
            frame,
            middle: core.middle,
            reach: (lo - lo.next_down()).min(hi.next_up() - hi),
            members,
        }
    }
}

/// Of which nothing is known.
const UNKNOWN: Approx = Approx {
    v: 0.0,
    e: f64::INFINITY,
};

impl Member {
    /// An enclosure of the distance at which another member meets this one, if it does anywhere in the core; None where
    /// that is not known.
    fn meets(&self, o: &Member, reach: f64) -> Option<(f64, f64)> {
        let slopes = self.slopes - o.slopes;
        let steep = slopes.v.abs() - slopes.e;
        // One of them is steeper all over: they meet once at most.
        if !(steep > 0.0) {
            return None;
        }
        let apart = o.height - self.height;
        // By the mean value theorem: the distance is that of their heights over a difference of slopes between.
        let at = if apart.v.abs() + apart.e < steep * (reach * 0.5) {
            apart.over(self.near - o.near)
        } else {
            apart.over(slopes)
        };
        (at.v.is_finite() && at.e.is_finite()).then(|| (at.lo(), at.hi()))
    }
}

impl Tracer<'_> {
    /// What an item meets in a window [from, to) within the core of its cluster; None where it has none or its frame
    /// does not lie inside the window.
    fn fan(&mut self, item: u32, from: f64, to: f64) -> Option<Fan> {
        let root = self.pencil(item)?.1.root;
        let pencil = &self.pencils[root as usize];
        let cluster = pencil.cluster.as_ref()?;
        let (a, b) = pencil.crowded()?;
        let (lo, hi) = self.k.frame_range(cluster.frame);
        let inside = |x: f64| from < x && x < to;
        if !(a <= from && to <= b && inside(lo) && inside(hi) && inside(cluster.middle)) {
            return None;
        }
        let at = cluster.members.binary_search_by_key(&item, |m| m.item);
        let me = &cluster.members[at.ok()?];
        let color = self.items[item as usize].color;
        let (left, right) = ((from - hi).next_down(), (to - lo).next_up());
        let (mut meetings, mut others) = (Vec::new(), Vec::new());
        for o in &cluster.members {
            let same = o.item == item || color != 0 && color == self.items[o.item as usize].color;
            if same || o.range.1 < from || to < o.range.0 {
                continue;
            }
            if o.curve == me.curve {
                others.push(o.item);
                continue;
            }
            match me.meets(o, cluster.reach) {
                Some((lo, hi)) if hi < left || right < lo => {}
                Some((lo, hi)) => meetings.push(Meeting {
                    lo,
                    hi,
                    before: f64::NEG_INFINITY,
                    after: f64::INFINITY,
                    other: o.item,
                }),
                None => others.push(o.item),
            }
        }
        self.tests += cluster.members.len() as u64;
        meetings.sort_unstable_by(|m, n| m.lo.total_cmp(&n.lo));
        let mut before = f64::NEG_INFINITY;
        for m in &mut meetings {
            m.before = before;
            before = before.max(m.hi);
        }
        let mut after = f64::INFINITY;
        for m in meetings.iter_mut().rev() {
            after = after.min(m.lo);
            m.after = after;
        }
        let (frame, middle) = (cluster.frame, cluster.middle);
        let mut outside = Vec::new();
        self.gather(item, (from, to), usize::MAX, true, &mut outside);
        others.append(&mut outside);
        Some(Fan {
            meetings,
            others,
            frame,
            middle,
            from,
            to,
        })
    }

    /// Halves a window of an item within a cluster, or finds its stops; false where it does not lie within one, or that
    /// is of no use.
    pub(super) fn open_within(&mut self, item: u32, w: u32) -> bool {
        let window = self.windows[w as usize];
        let (f, part) = if window.fan == NONE {
            let Some(fan) = self.fan(item, window.from.at, window.to.at) else {
                return false;
            };
            let n = fan.meetings.len() as u32;
            self.fans.push(fan);
            (self.fans.len() as u32 - 1, (0, n))
        } else {
            (window.fan, window.part)
        };
        let fan = &self.fans[f as usize];
        if let Some((at, cut)) = self.cut_within(item, fan, part) {
            let kids = self.windows.len() as u32;
            for (from, to, part) in [
                (window.from, cut, (part.0, at)),
                (cut, window.to, (at, part.1)),
            ] {
                self.windows.push(Window {
                    fan: f,
                    part,
                    ..Window::new(from, to)
                });
            }
            self.windows[w as usize].kids = kids;
            return true;
        }
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        let (i, j) = (part.0 as usize, part.1 as usize);
        near.extend(fan.meetings[i..j].iter().map(|m| m.other));
        near.extend(&fan.others);
        self.stop(item, w, &near);
        self.near = near;
        true
    }

    /// Where to cut a part of what an item meets within a cluster, about in the middle: how many lie before it, and the
    /// cut. None where there are few, or none is surely left of others.
    fn cut_within(&self, item: u32, fan: &Fan, part: (u32, u32)) -> Option<(u32, Cut)> {
        let (i, j) = (part.0 as usize, part.1 as usize);
        // What is asked of every part should not be most of what is asked.
        if j - i <= ENOUGH.max(fan.others.len()) {
            return None;
        }
        let Item { l, r, .. } = self.items[item as usize];
        let (lo, hi) = self.k.frame_range(fan.frame);
        let middle = i + (j - i) / 2;
        (0..j - i)
            .map(|k| match k % 2 {
                0 => middle + k / 2,
                _ => middle - k.div_ceil(2),
            })
            .filter(|&at| i < at && at < j)
            .find_map(|at| {
                let Meeting { before, after, .. } = fan.meetings[at];
                let off = (before * 0.5 + after * 0.5).min(after);
                // The ends belong to the outermost windows without a test, so cuts lie surely between them.
                let (left, right) = ((lo + off).next_down(), (hi + off).next_up());
                let parts = self.k.enclosure(l).1 < left && right <= self.k.enclosure(r).0;
                let whole = (fan.from < left) && (right < fan.to);
                (before < off && parts && whole).then_some((
                    at as u32,
                    Cut {
                        at: fan.middle,
                        off,
                        frame: fan.frame,
                    },
                ))
            })
    }
}
