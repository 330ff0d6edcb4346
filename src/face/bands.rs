//! Strips along curves: what a part of the index holds, told by one of its own arcs.
//!
//! The idea: hulls with straight strips tell long straight arcs apart, but n long arcs that curve alike overlap
//! in all of their hulls, and a search among them finds n neighbours where it has none. So a node of the
//! index may also know a curve g of its own and two numbers, low ≤ t − g(u) ≤ high for all that it holds. Arcs
//! that do not cross lie in layers, and eight neighbouring layers fill a band hardly thicker than their gaps,
//! whatever their common shape is. A band costs five to ten times what a straight strip costs, so bands are
//! made only once searches were seen to find much that they had to reject.

use super::gap::Gap;
use super::item::{Carrier, Item};
use super::kernel::{CurveId, Kernel};
use crate::geometry::index::Tree;

/// All that a node holds lies between `low` and `high` above the curve.
#[derive(Clone, Copy)]
struct Band {
    curve: CurveId,
    low: f64,
    high: f64,
}

/// The bands of the nodes of an index, by the nodes' places; none where nothing is known.
#[derive(Default)]
pub(super) struct Bands {
    bands: Vec<Option<Band>>,
}

impl Bands {
    /// Finds the bands of all nodes. O(n) for n entries.
    pub(super) fn new(k: &Kernel, items: &[Item], tree: &Tree) -> Bands {
        let mut bands: Vec<Option<Band>> = Vec::with_capacity(tree.len());
        for at in 0..tree.len() {
            let Some(children) = tree.children(at) else {
                bands.push(match items[tree.entry(at) as usize].carrier {
                    Carrier::Graph(curve) => Some(Band {
                        curve,
                        low: 0.0,
                        high: 0.0,
                    }),
                    Carrier::Vertical(..) => None,
                });
                continue;
            };
            let middle = children.start + (children.end - children.start) / 2;
            let around = bands[middle].and_then(|m| {
                let mut band = Band {
                    curve: m.curve,
                    low: f64::INFINITY,
                    high: f64::NEG_INFINITY,
                };
                for child in children {
                    let b = bands[child]?;
                    let [from, to, ..] = tree.hull(child).bounds;
                    let (low, high) = k.gap(b.curve, m.curve).range(from, to)?;
                    band.low = band.low.min((low + b.low).next_down());
                    band.high = band.high.max((high + b.high).next_up());
                }
                (band.low.is_finite() && band.high.is_finite()).then_some(band)
            });
            bands.push(around);
        }
        Bands { bands }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bands.is_empty()
    }

    /// Whether a curve over [from, to] surely meets nothing that a node holds.
    pub(super) fn apart(&self, k: &Kernel, at: usize, c: CurveId, from: f64, to: f64) -> bool {
        match self.bands.get(at) {
            Some(&Some(band)) if band.curve != c => {
                let gap: Gap = k.gap(c, band.curve);
                gap.outside(band.low, band.high, from, to)
            }
            _ => false,
        }
    }
}
