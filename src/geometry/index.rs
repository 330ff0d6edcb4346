//! A static index of hulls: which pieces of arcs may meet this one?
//!
//! The idea (a packed tree, as by Leutenegger, Lopez & Edgington 1997): halve the entries along the axis on
//! which they are spread widest compared with their own size, again and again, and pack neighbours into
//! nodes of eight. It adapts to any spread of the arcs, because only ranks matter, and takes linear memory
//! whatever they look like: there is no cell size to choose. (Slabs by u, each sorted by t, made rays
//! cost √n where obstacles are strung along t.)
//!
//! Boxes alone would let each of n long parallel arcs meet all others. So a hull is a box and a strip along
//! the chord, low ≤ t − slope·u ≤ high; and where boxes overlap heavily, entries are halved by slope and then
//! across it.

/// A box of doubles that encloses a piece: [u from, u to, t from, t to].
pub(crate) type Bounds = [f64; 4];

const FAN: usize = 8;

/// Whether two closed boxes meet.
#[inline]
pub(crate) fn meet(a: &Bounds, b: &Bounds) -> bool {
    a[0] <= b[1] && b[0] <= a[1] && a[2] <= b[3] && b[2] <= a[3]
}

/// The least box around both.
#[inline]
pub(crate) fn hull(a: &Bounds, b: &Bounds) -> Bounds {
    [
        a[0].min(b[0]),
        a[1].max(b[1]),
        a[2].min(b[2]),
        a[3].max(b[3]),
    ]
}

/// The box that holds nothing.
pub(crate) const EMPTY: Bounds = [
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// What encloses a piece of an arc, or many: a box, and a strip along a slope.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    pub(crate) bounds: Bounds,
    pub(crate) slope: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// Covers the roundings of a line evaluated at a double, with room.
const ERR: f64 = 8.0 * f64::EPSILON;

impl Hull {
    /// The box alone.
    pub(crate) fn boxed(bounds: Bounds) -> Hull {
        Hull {
            bounds,
            slope: 0.0,
            low: bounds[2],
            high: bounds[3],
        }
    }

    /// Whether the two have no point in common; false where doubles cannot tell.
    #[inline]
    pub(crate) fn apart(&self, o: &Hull) -> bool {
        if !meet(&self.bounds, &o.bounds) {
            return true;
        }
        // Written out, and without `min` and `max`, which see to what is not a number: most of a search is spent here,
        // and boxes that meet hold none.
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        let smaller = |a: f64, b: f64| if a < b { a } else { b };
        let from = larger(self.bounds[0], o.bounds[0]);
        let to = smaller(self.bounds[1], o.bounds[1]);
        // How far the one line lies above the other at both ends; what is not a number proves nothing, since the
        // room is none then either.
        let (s, r) = (self.slope * from, o.slope * from);
        let (t, q) = (self.slope * to, o.slope * to);
        let (first, last) = (s - r, t - q);
        let size = (s.abs() + r.abs()) + (t.abs() + q.abs());
        let above = smaller(first, last) + (self.low - o.high);
        let below = larger(first, last) + (self.high - o.low);
        above > ERR * (size + self.low.abs() + o.high.abs())
            || -below > ERR * (size + self.high.abs() + o.low.abs())
    }

    /// An enclosure of t over [a, b] within it.
    #[inline]
    pub(crate) fn t_over(&self, a: f64, b: f64) -> (f64, f64) {
        let (p, q) = (self.slope * a, self.slope * b);
        let room = ERR * (p.abs().max(q.abs()) + self.low.abs().max(self.high.abs()));
        let (lo, hi) = (p.min(q) + self.low - room, p.max(q) + self.high + room);
        // Not a number: only the box is known.
        (
            if lo > self.bounds[2] {
                lo
            } else {
                self.bounds[2]
            },
            if hi < self.bounds[3] {
                hi
            } else {
                self.bounds[3]
            },
        )
    }

    /// The least box around all, and a strip along the mean of their slopes.
    fn around(group: &[Hull]) -> Hull {
        let mut sum = 0.0;
        let mut out = Hull::boxed(EMPTY);
        for h in group {
            out.bounds = hull(&out.bounds, &h.bounds);
            sum += h.slope;
        }
        out.slope = sum / group.len() as f64;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for h in group {
            for x in [h.bounds[0], h.bounds[1]] {
                let (s, r) = (h.slope * x, out.slope * x);
                let room = ERR * (s.abs() + r.abs() + h.low.abs().max(h.high.abs()));
                low = low.min((s - r) + h.low - room);
                high = high.max((s - r) + h.high + room);
                if !(low.is_finite() && high.is_finite()) {
                    return Hull::boxed(out.bounds);
                }
            }
        }
        (out.low, out.high) = (low, high);
        out
    }
}

/// The packed tree.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    /// Entries in packed order, then the nodes level by level, the root last.
    hulls: Vec<Hull>,
    /// Where each level starts in `hulls`, and where the last one ends.
    levels: Vec<usize>,
    /// What each entry stands for.
    ids: Vec<u32>,
}

impl Tree {
    /// Packs the entries. O(n log n).
    pub(crate) fn new(mut entries: Vec<(Hull, u32)>) -> Tree {
        let n = entries.len();
        arrange(&mut entries);
        let mut hulls: Vec<Hull> = Vec::with_capacity(n + n / (FAN - 1) + 24);
        hulls.extend(entries.iter().map(|e| e.0));
        let ids = entries.into_iter().map(|e| e.1).collect();
        let mut levels = vec![0, n];
        let mut from = 0;
        while hulls.len() - from > 1 {
            let to = hulls.len();
            for at in (from..to).step_by(FAN) {
                let around = Hull::around(&hulls[at..to.min(at + FAN)]);
                hulls.push(around);
            }
            from = to;
            levels.push(hulls.len());
        }
        Tree { hulls, levels, ids }
    }

    /// How many places there are: entries first, then nodes, each after all that it holds.
    pub(crate) fn len(&self) -> usize {
        self.hulls.len()
    }

    /// How many of them are entries.
    pub(crate) fn entries(&self) -> usize {
        self.ids.len()
    }

    /// The hull at a place.
    pub(crate) fn hull(&self, at: usize) -> &Hull {
        &self.hulls[at]
    }

    /// What the entry at a place stands for.
    pub(crate) fn entry(&self, at: usize) -> u32 {
        self.ids[at]
    }

    /// The places that a node holds; None for an entry.
    pub(crate) fn children(&self, at: usize) -> Option<std::ops::Range<usize>> {
        let level = self.levels.iter().rposition(|&from| from <= at)?;
        // The last level's end is listed too.
        let level = level.min(self.levels.len().checked_sub(2)?);
        if level == 0 {
            return None;
        }
        let first = self.levels[level - 1] + (at - self.levels[level]) * FAN;
        Some(first..self.levels[level].min(first + FAN))
    }

    /// Calls `found` with the entries whose hulls may meet `h`, until it says false.
    pub(crate) fn query(&self, h: &Hull, found: impl FnMut(u32) -> bool) {
        self.descend(|_, node| !node.apart(h), found);
    }

    /// Walks the tree from the root; only places that `wanted` admits are entered. Nodes with larger t come
    /// first, roughly, so that a search for the highest entry below a point prunes early. Ends when `found`
    /// says false.
    pub(crate) fn descend(
        &self,
        mut wanted: impl FnMut(usize, &Hull) -> bool,
        mut found: impl FnMut(u32) -> bool,
    ) {
        if self.ids.is_empty() {
            return;
        }
        let mut stack = [(0u32, 0u32); 8 * 24];
        let mut top = 1;
        stack[0] = (self.levels.len() as u32 - 2, self.hulls.len() as u32 - 1);
        while top > 0 {
            top -= 1;
            let (level, at) = (stack[top].0 as usize, stack[top].1 as usize);
            if !wanted(at, &self.hulls[at]) {
                continue;
            }
            if level == 0 {
                if !found(self.ids[at]) {
                    return;
                }
                continue;
            }
            let first = self.levels[level - 1] + (at - self.levels[level]) * FAN;
            for child in first..self.levels[level].min(first + FAN) {
                stack[top] = (level as u32 - 1, child as u32);
                top += 1;
            }
        }
    }
}

/// Orders the entries so that every aligned run of 8, 64, 512, … lies close together.
pub(crate) fn arrange(entries: &mut [(Hull, u32)]) {
    let n = entries.len();
    if n <= FAN {
        return;
    }
    let mut child = FAN;
    while child * FAN < n {
        child *= FAN;
    }
    let cut = n.div_ceil(child) / 2 * child;
    let key = best_axis(entries);
    entries.select_nth_unstable_by(cut, |(a, _), (b, _)| key.of(a).total_cmp(&key.of(b)));
    let (low, high) = entries.split_at_mut(cut);
    arrange(low);
    arrange(high);
}

/// By what entries are halved.
enum Key {
    /// The middle of the box along an axis (0: u, 2: t).
    Middle(usize),
    Slope,
    /// The middle of the strip, moved along `slope` as seen from u = `at`.
    Across {
        slope: f64,
        at: f64,
    },
}

const FAR: f64 = f64::MAX / 8.0;

fn side(b: &Bounds, axis: usize) -> (f64, f64) {
    (b[axis].max(-FAR), b[axis + 1].min(FAR))
}

impl Key {
    fn of(&self, h: &Hull) -> f64 {
        match *self {
            Key::Middle(axis) => {
                let (lo, hi) = side(&h.bounds, axis);
                lo * 0.5 + hi * 0.5
            }
            Key::Slope => h.slope,
            Key::Across { slope, at } => {
                // Where the middle line of the strip, over the middle of its own box, lies across the slope.
                let (lo, hi) = side(&h.bounds, 0);
                let x = lo * 0.5 + hi * 0.5;
                (h.slope * x + (h.low * 0.5 + h.high * 0.5)) - slope * (x - at)
            }
        }
    }
}

/// How many times over the boxes cover their hull before position alone is held to be useless.
const CROWDED: f64 = 6.0;

fn best_axis(entries: &[(Hull, u32)]) -> Key {
    let n = entries.len() as f64;
    let (mut lo, mut hi, mut size) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2], [0.0; 2]);
    let mut around = EMPTY;
    let (mut area, mut slopes, mut steepest) = (0.0, (f64::INFINITY, f64::NEG_INFINITY), 0.0);
    for (h, _) in entries {
        let mut part = [0.0; 2];
        for axis in 0..2 {
            let (from, to) = side(&h.bounds, 2 * axis);
            let m = from * 0.5 + to * 0.5;
            (lo[axis], hi[axis]) = (lo[axis].min(m), hi[axis].max(m));
            part[axis] = to - from;
            size[axis] += part[axis] / n;
        }
        area += part[0] * part[1];
        around = hull(&around, &h.bounds);
        slopes = (slopes.0.min(h.slope), slopes.1.max(h.slope));
        steepest += h.slope / n;
    }
    let (w, t) = (around[1] - around[0], around[3] - around[2]);
    if area > CROWDED * w * t && w.is_finite() && t.is_finite() {
        // The strips' own width across, and how far apart slopes drive two of them along the box.
        let fan = (slopes.1 - slopes.0) * size[0];
        let key = Key::Across {
            slope: steepest,
            at: around[0] * 0.5 + around[1] * 0.5,
        };
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for (h, _) in entries {
            let k = key.of(h);
            (from, to) = (from.min(k), to.max(k));
        }
        return if fan > (to - from) * 0.5 {
            Key::Slope
        } else {
            key
        };
    }
    // Spread of the middles over the sum of the sizes.
    let score = |axis: usize| (hi[axis] - lo[axis]) / (size[axis] + f64::MIN_POSITIVE);
    Key::Middle(if score(1) > score(0) { 2 } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_a_scan_finds() {
        let mut seed = 12345u64;
        let mut next = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / 2f64.powi(31)
        };
        for n in [0usize, 1, 7, 8, 9, 64, 65, 1000] {
            let mut draw = |size: f64| {
                let (u, t, s, w) = (next(), next(), next() * 4.0 - 2.0, next() * size);
                let thick = next() * 0.01;
                let (p, q) = (t, t + s * w);
                Hull {
                    bounds: [u, u + w, p.min(q) - thick, p.max(q) + thick],
                    slope: s,
                    low: t - s * u - thick,
                    high: t - s * u + thick,
                }
            };
            let entries: Vec<(Hull, u32)> = (0..n)
                .map(|i| (draw(if i % 2 == 0 { 0.1 } else { 1.5 }), i as u32))
                .collect();
            let tree = Tree::new(entries.clone());
            let mut pruned = 0;
            for _ in 0..50 {
                let h = draw(0.5);
                let mut got = Vec::new();
                tree.query(&h, |i| {
                    got.push(i);
                    true
                });
                got.sort_unstable();
                let want: Vec<u32> = entries
                    .iter()
                    .filter(|(e, _)| !e.apart(&h))
                    .map(|e| e.1)
                    .collect();
                assert_eq!(got, want);
                pruned += entries
                    .iter()
                    .filter(|(e, _)| meet(&e.bounds, &h.bounds) && e.apart(&h))
                    .count();
            }
            assert!(n < 64 || pruned > 0, "strips tell apart what boxes cannot");
        }
    }
}
