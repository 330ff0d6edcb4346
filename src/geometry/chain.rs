//! An index of the edges of a polyline in the order of the list.
//!
//! The idea: edges that follow each other lie near each other, so boxes around runs of consecutive edges, and
//! boxes around runs of those, are a good tree without any sorting: one pass over the doubles. Where a
//! ring jumps to and fro the boxes overlap and a query costs up to one look at every edge, which is what
//! building a sorted tree for it would cost too.

use super::index::{Bounds, EMPTY, Hull, hull};

/// Edges a leaf, and nodes a node.
const FAN: usize = 16;

/// Boxes around runs of edges, around runs of those, and so on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chain {
    /// How many edges there are.
    len: usize,
    /// Level by level; the last one has one box.
    levels: Vec<Vec<Bounds>>,
}

impl Chain {
    /// From the boxes of the edges. O(len).
    pub(crate) fn new(len: usize, edge: impl Fn(usize) -> Bounds) -> Chain {
        let runs = |n: usize, of: &dyn Fn(usize) -> Bounds| -> Vec<Bounds> {
            let around = |from: usize| {
                let run = from..n.min(from + FAN);
                run.fold(EMPTY, |b, i| hull(&b, &of(i)))
            };
            (0..n).step_by(FAN).map(around).collect()
        };
        let mut levels = vec![runs(len, &edge)];
        while let Some(last) = levels.last().filter(|l| l.len() > 1) {
            let next = runs(last.len(), &|i| last[i]);
            levels.push(next);
        }
        Chain { len, levels }
    }

    /// The edges whose boxes may meet a region, in order of the list.
    pub(crate) fn query(
        &self,
        region: &Hull,
        edge: impl Fn(usize) -> Bounds,
        mut found: impl FnMut(usize),
    ) {
        let near = |b: &Bounds| !Hull::boxed(*b).apart(region);
        // Nodes still to look at, the next one last: (level, index).
        let mut open = vec![(self.levels.len(), 0)];
        while let Some((level, at)) = open.pop() {
            match level {
                0 if near(&edge(at)) => found(at),
                0 => {}
                _ => {
                    let boxes = &self.levels[level - 1];
                    if at < boxes.len() && near(&boxes[at]) {
                        let below = match level {
                            1 => self.len,
                            _ => self.levels[level - 2].len(),
                        };
                        let run = at * FAN..below.min((at + 1) * FAN);
                        open.extend(run.rev().map(|i| (level - 1, i)));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every edge that a look at all of them finds, in order, for rings of every size about the fan's powers.
    #[test]
    fn finds_what_a_scan_finds() {
        for len in [0, 1, 2, 15, 16, 17, 255, 256, 257, 4100] {
            // A spiral of short edges, and one edge in ten somewhere else.
            let edge = |i: usize| {
                let r = i as f64;
                let (x, y) = if i % 10 == 7 {
                    ((i * 7919 % 1000) as f64, (i * 104_729 % 1000) as f64)
                } else {
                    (r * (r / 9.0).cos(), r * (r / 9.0).sin())
                };
                [x, x + 1.0, y, y + 2.0]
            };
            let chain = Chain::new(len, edge);
            for k in 0..40 {
                let (x, y) = (
                    (k * 37 % 100) as f64 * 20.0 - 1000.0,
                    k as f64 * 40.0 - 800.0,
                );
                let region = Hull::boxed([x, x + 300.0, y, y + 150.0]);
                let mut found = Vec::new();
                chain.query(&region, edge, |i| found.push(i));
                let scan: Vec<usize> = (0..len)
                    .filter(|&i| !Hull::boxed(edge(i)).apart(&region))
                    .collect();
                assert_eq!(found, scan, "{len} edges, region {k}");
            }
        }
    }
}
