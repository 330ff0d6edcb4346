//! The windows of an item: parts of its range, in each of which few others meet it.
//!
//! The idea: an item's range is halved into windows, lazily, until few others may meet it inside one; then all
//! that do are found, sorted and named (`stops.rs`). So a walk that uses a short end of a long arc pays for what is
//! near that end. The limit grows with the square of the depth: about a common point of many arcs no
//! window is ever empty, and halving must end there too. (Where many are known to pass near one another, that part
//! is cut out and not halved in doubles, but as `cluster.rs` says.)

use super::bands::Bands;
use super::item::{Carrier, Item, NONE};
use super::kernel::{CurveId, NumId};
use super::trace::Tracer;
use crate::geometry::index::Hull;
use std::cmp::Ordering;

/// Where an item's range is cut: at a double, or at a distance from the frame of a cluster (`off`, from `frame`; `at` is
/// then a double in the cluster's core, which nothing else is cut in).
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Cut {
    pub(super) at: f64,
    pub(super) off: f64,
    pub(super) frame: u32,
}

impl Cut {
    pub(super) fn plain(at: f64) -> Cut {
        Cut {
            at,
            off: 0.0,
            frame: NONE,
        }
    }

    /// Whether it lies left of another cut of the same item.
    fn before(&self, o: &Cut) -> bool {
        self.at < o.at || self.at == o.at && self.off < o.off
    }
}

/// A part of an item's range, `to` excluded unless it is the item's end. Item i's whole range is window i.
#[derive(Clone, Copy)]
pub(super) struct Window {
    pub(super) from: Cut,
    pub(super) to: Cut,
    /// Its two halves, where it was halved.
    pub(super) kids: u32,
    pub(super) stops: u32,
    pub(super) stop_count: u32,
    /// Within a cluster: what is known of the item there, and the part of it that is this window's.
    pub(super) fan: u32,
    pub(super) part: (u32, u32),
}

impl Window {
    pub(super) fn new(from: Cut, to: Cut) -> Window {
        Window {
            from,
            to,
            kids: NONE,
            stops: NONE,
            stop_count: 0,
            fan: NONE,
            part: (0, 0),
        }
    }
}

/// How many others a window at this depth may have before it is halved.
fn crowd(depth: usize) -> usize {
    if depth < DEEPEST {
        16 + depth * depth / 8
    } else {
        usize::MAX
    }
}

/// Past this many halvings a window takes whatever is there.
const DEEPEST: usize = 24;

/// Nor is one halved that is such a part of the item.
const TINIEST: f64 = 1.0 / (1u64 << 20) as f64;

/// So many different points in so small a window are a cluster.
const CLUSTER: usize = 24;

/// At every so many halvings it is asked whether all that are near meet the item in one place, by how many of them.
const LOOK: usize = 3;
const SOME: usize = 4;

/// How many items a search may find in vain, on average, before bands are made; and how many in all before that
/// is asked.
const VAIN: u64 = 16;
const PATIENT: u64 = 4096;

/// A window whose stops are known, and those as a range of `stops`.
#[derive(Clone, Copy)]
pub(super) struct Leaf {
    pub(super) window: u32,
    pub(super) from: usize,
    pub(super) to: usize,
}

impl Tracer<'_> {
    // ----- windows -----

    /// The leaf of an item's windows on the path that `right` tells at each cut; made when first asked for.
    fn leaf(&mut self, item: u32, mut right: impl FnMut(&mut Self, Cut) -> bool) -> Leaf {
        let (mut w, mut depth) = (item, 0);
        loop {
            let window = self.windows[w as usize];
            if window.kids != NONE {
                let mid = self.windows[window.kids as usize].to;
                w = window.kids + u32::from(right(self, mid));
                depth += 1;
                continue;
            }
            if window.stops != NONE {
                let from = window.stops as usize;
                return Leaf {
                    window: w,
                    from,
                    to: from + window.stop_count as usize,
                };
            }
            self.open(item, w, depth);
        }
    }

    /// The leaf that holds a number of the item's range.
    pub(super) fn leaf_at(&mut self, item: u32, x: NumId) -> Leaf {
        self.leaf(item, |t, mid| t.cmp_cut(x, mid).is_ge())
    }

    /// The leaf at the low end of an item, or at its high end.
    pub(super) fn leaf_at_end(&mut self, item: u32, high: bool) -> Leaf {
        self.leaf(item, |_, _| high)
    }

    /// The leaf next to another one.
    pub(super) fn leaf_beside(&mut self, item: u32, leaf: Leaf, forward: bool) -> Leaf {
        let Window { from, to, .. } = self.windows[leaf.window as usize];
        debug_assert!(
            if forward {
                to.before(&self.windows[item as usize].to)
            } else {
                self.windows[item as usize].from.before(&from)
            },
            "an arc ends in a stop"
        );
        self.leaf(item, |_, mid| {
            if forward {
                !to.before(&mid)
            } else {
                mid.before(&from)
            }
        })
    }

    /// Halves a window, or finds its stops.
    fn open(&mut self, item: u32, w: u32, depth: usize) {
        let Window { from, to, .. } = self.windows[w as usize];
        if self.open_within(item, w) {
            return;
        }
        let (from, to) = (from.at, to.at);
        let me = self.items[item as usize];
        // What is crowded is cut out in two steps instead of ever smaller halves around it.
        let crowded = self.pencil(item).map(|p| p.1.crowded());
        let mid = match crowded.flatten() {
            Some((a, _)) if from < a && a < to => a,
            Some((_, b)) if from < b && b < to => b,
            Some((a, b)) if a <= from && to <= b => to,
            _ => from + (to - from) * 0.5,
        };
        let halved = matches!(me.carrier, Carrier::Graph(_))
            && from < mid
            && mid < to
            && self.parts(&me, mid);
        let whole = self.windows[item as usize];
        let deep = depth >= DEEPEST || to - from <= (whole.to.at - whole.from.at) * TINIEST;
        let most = match halved {
            true if !deep => crowd(depth),
            _ => usize::MAX,
        };
        let mut near = std::mem::take(&mut self.near);
        if self.gather(item, (from, to), most, false, &mut near)
            || self.glued(item, (from, to), &near)
                && self.gather(item, (from, to), usize::MAX, false, &mut near)
        {
            self.stop(item, w, &near);
            // As many different points in so small a window: not one point that many pass through.
            let Window {
                stops, stop_count, ..
            } = self.windows[w as usize];
            if deep && stop_count as usize > CLUSTER && self.pencil(item).is_none() {
                let middle = self.stops[(stops + stop_count / 2) as usize];
                let middle = self.vertices[middle as usize].at.x;
                self.gather_cluster(item, middle, to - from, &near);
            }
        } else {
            let mid = match crowded {
                None if depth.is_multiple_of(LOOK) && depth > 0 => {
                    self.beside_crowd(item, (from, to), &near).unwrap_or(mid)
                }
                _ => mid,
            };
            let kids = self.windows.len() as u32;
            self.windows
                .push(Window::new(Cut::plain(from), Cut::plain(mid)));
            self.windows
                .push(Window::new(Cut::plain(mid), Cut::plain(to)));
            self.windows[w as usize].kids = kids;
        }
        self.near = near;
    }

    /// Whether some of those that are near a window, and so perhaps all, cannot be told from the item in doubles
    /// anywhere: however small its halves, none would have fewer.
    fn glued(&self, item: u32, (from, to): (f64, f64), near: &[u32]) -> bool {
        // A crowd that is known of beforehand is not searched for, and it lies in one place.
        let (Carrier::Graph(c), false) = (self.items[item as usize].carrier, near.is_empty())
        else {
            return false;
        };
        // Not where halves begin, which are places that data like.
        let places = [0.3, 0.7].map(|s| from + (to - from) * s);
        let last = near.len() - 1;
        (0..SOME).all(|i| {
            let b = near[i * last / (SOME - 1)];
            match self.items[b as usize].carrier {
                Carrier::Graph(d) => places.iter().all(|&x| !self.apart(item, b, (c, d), x, x)),
                Carrier::Vertical(..) => false,
            }
        })
    }

    /// Whether two items surely do not meet over [lo, hi].
    fn apart(&self, item: u32, other: u32, (c, d): (CurveId, CurveId), lo: f64, hi: f64) -> bool {
        let k = &*self.k;
        if c == d {
            return false;
        }
        match self.pencils.get(self.common_pencil(item, other) as usize) {
            Some(shared) if shared.straight => false,
            Some(shared) => k.miss_beside(c, d, lo, hi, shared.known()),
            None => {
                k.miss(c, d, lo, hi)
                    || self
                        .busy
                        .get(&item)
                        .is_some_and(|mine| self.only_there(mine, other, (c, d), lo, hi))
            }
        }
    }

    /// Where to cut a window beside a place where some of those that are near, and so perhaps many of them, meet an item
    /// all at once; None if they do not, or the cut is of no use.
    fn beside_crowd(&mut self, item: u32, (from, to): (f64, f64), near: &[u32]) -> Option<f64> {
        let me = self.items[item as usize];
        let whole = self.windows[item as usize];
        let half = (whole.to.at - whole.from.at) * (TINIEST / 4.0);
        let (mut lo, mut hi, mut met) = (f64::INFINITY, f64::NEG_INFINITY, 0);
        for i in 0..SOME {
            let (s, e) = self.meet(item, near[i * (near.len() - 1) / (SOME - 1)]);
            for cross in s..e {
                let x = self.k.enclosure(self.crosses[cross as usize].x);
                if from <= x.0 && x.1 < to {
                    (lo, hi, met) = (lo.min(x.0), hi.max(x.1), met + 1);
                }
            }
        }
        if met < SOME || hi - lo > half {
            return None;
        }
        let cuts = [lo - half, hi + half];
        cuts.into_iter()
            .find(|&x| from < x && x < to && self.parts(&me, x))
    }

    /// Whether a cut surely lies between the ends of an item, l < mid ≤ r. The ends belong to its outermost
    /// windows without a test, so whatever else happens at an end must belong there too: the item that is
    /// hardly wider than the enclosures of its ends cannot be halved.
    fn parts(&self, item: &Item, mid: f64) -> bool {
        self.k.enclosure(item.l).1 < mid && mid <= self.k.enclosure(item.r).0
    }

    /// The order of a number of an item's range and a cut of it.
    pub(super) fn cmp_cut(&mut self, x: NumId, cut: Cut) -> Ordering {
        if cut.frame == NONE {
            self.k.cmp_double(x, cut.at)
        } else {
            self.k.cmp_framed(x, cut.frame, cut.off)
        }
    }

    /// The items that may meet this one over a range; false as soon as there are more than `most`. Only those that
    /// are not in the item's outermost pencil, if it is so asked.
    pub(super) fn gather(
        &mut self,
        item: u32,
        range: (f64, f64),
        most: usize,
        others: bool,
        near: &mut Vec<u32>,
    ) -> bool {
        near.clear();
        let mut pencil = self.pencil(item);
        let outermost = match pencil {
            Some((_, p)) if others => p.root,
            _ => NONE,
        };
        if others {
            pencil = None;
        }
        if let Some(crowd) = pencil.and_then(|p| p.1.crowd_in(range.0, range.1)) {
            if crowd > most {
                return false;
            }
            pencil = None;
        }
        let innermost = pencil.map_or(NONE, |p| p.0);
        let outermost = pencil.map_or(outermost, |p| p.1.root);
        self.serial += 1;
        let serial = self.serial;
        self.stamp[item as usize] = serial;
        let mut stamp = std::mem::take(&mut self.stamp);
        let (items, k) = (self.items, &*self.k);
        let me = &items[item as usize];
        let (mut count, mut tests, mut wasted) = (0, 0, 0);
        let mut consider = |b: u32| {
            if stamp[b as usize] == serial {
                return true;
            }
            stamp[b as usize] = serial;
            tests += 1;
            let other = &items[b as usize];
            // Edges of one colour meet at common vertices only.
            if me.color != 0 && other.color == me.color {
                return true;
            }
            if let (Carrier::Graph(c), Carrier::Graph(d)) = (me.carrier, other.carrier) {
                let (left, right) = (k.enclosure(other.l), k.enclosure(other.r));
                // One on the same curve that covers the range is there in every part of it: halving cannot help.
                if c == d && left.1 < range.0 && range.1 < right.0 {
                    near.push(b);
                    return true;
                }
                let (lo, hi) = (range.0.max(left.0), range.1.min(right.1));
                if c != d && (lo > hi || self.apart(item, b, (c, d), lo, hi)) {
                    wasted += 1;
                    return true;
                }
            }
            near.push(b);
            count += 1;
            count <= most
        };
        let (mut inner, mut p) = (NONE, innermost);
        while let (Some(pencil), Carrier::Graph(c)) = (self.pencils.get(p as usize), me.carrier) {
            pencil.query(k, c, range, |b| {
                inner != NONE && self.in_pencil(b, inner) || consider(b)
            });
            (inner, p) = (p, pencil.parent);
        }
        let outer = self.pencils.get(outermost as usize);
        let rest = outer.and_then(|p| p.rest.as_ref());
        let hull = || match me.carrier {
            Carrier::Graph(c) => k.hull(c, range.0, range.1),
            Carrier::Vertical(..) => Hull::boxed(me.bounds),
        };
        if let Some(rest) = rest {
            if rest.entries() > 0 {
                rest.query(&hull(), &mut consider);
            }
        } else {
            let hull = hull();
            let (bands, entries) = (&self.bands, self.tree.entries());
            let wanted = |at: usize, node: &Hull| {
                !node.apart(&hull)
                    && match me.carrier {
                        Carrier::Graph(c) if at >= entries && !bands.is_empty() => {
                            let from = node.bounds[0].max(hull.bounds[0]);
                            let to = node.bounds[1].min(hull.bounds[1]);
                            !bands.apart(k, at, c, from, to)
                        }
                        _ => true,
                    }
            };
            self.tree.descend(wanted, |b| {
                outermost != NONE && self.in_pencil(b, outermost) || consider(b)
            });
        }
        let few = count <= most;
        self.stamp = stamp;
        self.tests += tests;
        self.wasted += wasted;
        if self.bands.is_empty() && self.wasted > VAIN * u64::from(serial) + PATIENT {
            self.bands = Bands::new(self.k, self.items, &self.tree);
        }
        few
    }

    /// Whether an item through the vertices `mine` surely meets another over [lo, hi] only in those that both
    /// pass through.
    fn only_there(
        &self,
        mine: &[u32],
        other: u32,
        (c, d): (CurveId, CurveId),
        lo: f64,
        hi: f64,
    ) -> bool {
        let Some(theirs) = self.busy.get(&other) else {
            return false;
        };
        let known: Vec<(NumId, usize)> = mine
            .iter()
            .filter(|v| theirs.contains(v))
            .map(|&v| {
                let x = self.vertices[v as usize].at.x;
                (x, self.k.contact(c, d, x))
            })
            .collect();
        !known.is_empty() && self.k.miss_beside(c, d, lo, hi, &known)
    }
}
