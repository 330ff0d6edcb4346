//! Hulls of items, and the index of them that a walk searches.

use super::item::{Carrier, Item};
use super::kernel::Kernel;
use crate::geometry::index::{Bounds, Hull, Tree};

/// Fills in the boxes of items, cuts them into pieces, more where they are long, about two an item in all, and
/// packs the hulls of the pieces.
pub(super) fn index(k: &Kernel, items: &mut [Item]) -> Tree {
    for item in items.iter_mut() {
        if item.bounds[0] > item.bounds[1] {
            item.bounds = box_of(k, item);
        }
    }
    // Long compared with what lies between the outer tenths of all arcs.
    let extent = |axis: usize| {
        let mut ends: Vec<f64> = items
            .iter()
            .flat_map(|i| [i.bounds[axis], i.bounds[axis + 1]])
            .filter(|x| x.is_finite())
            .collect();
        let n = ends.len();
        if n < 2 {
            return (0.0, 0.0, 1.0);
        }
        let (i, j) = (n / 10, n - 1 - n / 10);
        let lo = *ends.select_nth_unstable_by(i, f64::total_cmp).1;
        let hi = *ends.select_nth_unstable_by(j, f64::total_cmp).1;
        (lo, hi, if hi > lo { 1.0 / (hi - lo) } else { 0.0 })
    };
    let (u, t) = (extent(0), extent(2));
    let length = |b: &Bounds| {
        let part =
            |lo: f64, hi: f64, e: (f64, f64, f64)| (hi.min(e.1) - lo.max(e.0)).max(0.0) * e.2;
        part(b[0], b[1], u) + part(b[2], b[3], t)
    };
    let total: f64 = items.iter().map(|i| length(&i.bounds)).sum();
    let per = if total > 0.0 {
        items.len() as f64 / total
    } else {
        0.0
    };
    let mut entries = Vec::with_capacity(items.len() * 2);
    for (i, item) in items.iter().enumerate() {
        let b = &item.bounds;
        let Carrier::Graph(c) = item.carrier else {
            entries.push((Hull::boxed(*b), i as u32));
            continue;
        };
        // A range past the doubles cannot be cut into equal parts.
        let n = if (b[1] - b[0]).is_finite() {
            1 + ((length(b) * per) as usize).min(31)
        } else {
            1
        };
        let mut from = b[0];
        for p in 1..=n {
            let to = if p == n {
                b[1]
            } else {
                (b[0] + (b[1] - b[0]) * (p as f64 / n as f64)).clamp(from, b[1])
            };
            entries.push((k.hull(c, from, to), i as u32));
            from = to;
        }
    }
    Tree::new(entries)
}

/// A hull of a whole item.
pub(crate) fn hull_of(k: &Kernel, item: &Item) -> Hull {
    match item.carrier {
        Carrier::Graph(c) => k.hull(c, k.enclosure(item.l).0, k.enclosure(item.r).1),
        Carrier::Vertical(..) => Hull::boxed(box_of(k, item)),
    }
}

fn box_of(k: &Kernel, item: &Item) -> Bounds {
    let (a, b) = (k.enclosure(item.l).0, k.enclosure(item.r).1);
    match item.carrier {
        Carrier::Graph(c) => {
            let (lo, hi) = k.range(c, a, b);
            [a, b, lo, hi]
        }
        Carrier::Vertical(lo, hi) => {
            let (lo, hi) = (k.height(lo, item.l), k.height(hi, item.l));
            let known = [lo, hi].iter().all(|t| t.v.is_finite() && t.e.is_finite());
            if known {
                [a, b, lo.lo().min(hi.lo()), lo.hi().max(hi.hi())]
            } else {
                [a, b, f64::NEG_INFINITY, f64::INFINITY]
            }
        }
    }
}
