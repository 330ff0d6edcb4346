//! A static index of boxes: which pieces of arcs may meet this one?
//!
//! The idea (a packed tree, as by Leutenegger, Lopez & Edgington 1997): halve the boxes along the axis on
//! which they are spread widest compared with their own size, again and again, and pack neighbours into
//! nodes of eight. It adapts to any spread of the arcs, because only ranks matter, and takes linear memory
//! whatever they look like: there is no cell size to choose. (Slabs by u, each sorted by t, made rays
//! cost √n where obstacles are strung along t.)

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

/// The packed tree.
#[derive(Default)]
pub(crate) struct Tree {
    /// Entries in packed order, then the nodes level by level, the root last.
    boxes: Vec<Bounds>,
    /// Where each level starts in `boxes`, and where the last one ends.
    levels: Vec<usize>,
    /// What each entry stands for.
    ids: Vec<u32>,
}

impl Tree {
    /// Packs the entries. O(n log n).
    pub(crate) fn new(mut entries: Vec<(Bounds, u32)>) -> Tree {
        let n = entries.len();
        arrange(&mut entries);
        let mut boxes: Vec<Bounds> = entries.iter().map(|e| e.0).collect();
        let ids = entries.into_iter().map(|e| e.1).collect();
        let mut levels = vec![0, n];
        let mut from = 0;
        while boxes.len() - from > 1 {
            let to = boxes.len();
            for at in (from..to).step_by(FAN) {
                let group = &boxes[at..to.min(at + FAN)];
                let around = group.iter().fold(EMPTY, |a, b| hull(&a, b));
                boxes.push(around);
            }
            from = to;
            levels.push(boxes.len());
        }
        Tree { boxes, levels, ids }
    }

    /// Calls `found` with the entries whose boxes meet `b`.
    pub(crate) fn query(&self, b: &Bounds, found: impl FnMut(u32)) {
        self.descend(|node| meet(node, b), found);
    }

    /// Walks the tree from the root; only nodes that `wanted` admits are entered. Nodes with larger t come
    /// first, roughly, so that a search for the highest entry below a point prunes early.
    pub(crate) fn descend(
        &self,
        mut wanted: impl FnMut(&Bounds) -> bool,
        mut found: impl FnMut(u32),
    ) {
        if self.ids.is_empty() {
            return;
        }
        let mut stack = [(0u32, 0u32); 8 * 24];
        let mut top = 1;
        stack[0] = (self.levels.len() as u32 - 2, self.boxes.len() as u32 - 1);
        while top > 0 {
            top -= 1;
            let (level, at) = (stack[top].0 as usize, stack[top].1 as usize);
            if !wanted(&self.boxes[at]) {
                continue;
            }
            if level == 0 {
                found(self.ids[at]);
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
fn arrange(entries: &mut [(Bounds, u32)]) {
    let n = entries.len();
    if n <= FAN {
        return;
    }
    let mut child = FAN;
    while child * FAN < n {
        child *= FAN;
    }
    let far = f64::MAX / 8.0;
    let side = |b: &Bounds, axis: usize| (b[axis].max(-far), b[axis + 1].min(far));
    let middle = |b: &Bounds, axis: usize| {
        let (lo, hi) = side(b, axis);
        lo * 0.5 + hi * 0.5
    };
    // Spread of the middles over the sum of the sizes.
    let score = |axis: usize| {
        let (mut lo, mut hi, mut size) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for (b, _) in &*entries {
            let (from, to) = side(b, axis);
            let m = middle(b, axis);
            lo = lo.min(m);
            hi = hi.max(m);
            size += (to - from) / n as f64;
        }
        (hi - lo) / (size + f64::MIN_POSITIVE)
    };
    let axis = if score(2) > score(0) { 2 } else { 0 };
    let cut = n.div_ceil(child) / 2 * child;
    entries.select_nth_unstable_by(cut, |(a, _), (b, _)| {
        middle(a, axis).total_cmp(&middle(b, axis))
    });
    let (low, high) = entries.split_at_mut(cut);
    arrange(low);
    arrange(high);
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
            let entries: Vec<(Bounds, u32)> = (0..n)
                .map(|i| {
                    let (u, t) = (next(), next());
                    ([u, u + next() * 0.1, t, t + next() * 0.1], i as u32)
                })
                .collect();
            let tree = Tree::new(entries.clone());
            for _ in 0..50 {
                let (u, t) = (next(), next());
                let b = [u, u + next() * 0.2, t, t + next() * 0.2];
                let mut got = Vec::new();
                tree.query(&b, |i| got.push(i));
                got.sort_unstable();
                let want: Vec<u32> = entries
                    .iter()
                    .filter(|(e, _)| meet(e, &b))
                    .map(|e| e.1)
                    .collect();
                assert_eq!(got, want);
            }
        }
    }
}
