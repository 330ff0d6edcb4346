//! From the face of the strip to a boundary on the cylinder: the cut is taken out.
//!
//! An edge that ends on the cut is followed by the one that begins on its other side; vertices on the cut are
//! united with their partners.

use super::annotate::Draft;
use super::free::{Free, FreeEdge, FreeVertex, NONE};
use super::strip::{Owner, Strip};
use super::{ArcId, Configuration, Shape, Slice};
use crate::contact::Chart;
use crate::face::{Boundary, Found};
use crate::kernel::Kernel;
use crate::number::Rat;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// How a boundary edge of the strip lies there.
pub(super) struct Lie {
    pub(super) shape: Shape,
    pub(super) chart: Chart,
    pub(super) left_is_above: bool,
}

pub(super) fn lie<K: Kernel>(slice: &Slice<K>, owner: Owner) -> Lie {
    let (shape, chart) = match owner {
        Owner::Arc(id) => (slice.arc(id).shape, slice.arc(id).chart),
        Owner::Cut => (Shape::Level, Chart::Rest),
        Owner::Start | Owner::End => (Shape::Wall, Chart::Rest),
    };
    // Left of a graph t(x) is later. On a rising one later is below, at the same time.
    let left_is_above = !matches!(shape, Shape::Graph { rising: true } | Shape::Level);
    Lie {
        shape,
        chart,
        left_is_above,
    }
}

/// F while it is put together.
pub(super) struct Assembly {
    strip: Strip,
    b: Boundary,
    /// The vertex that each vertex of the strip has become.
    renamed: Vec<u32>,
    vertices: Vec<FreeVertex>,
    links: Vec<Vec<ArcId>>,
    /// The edge that each edge of the strip has become; NONE for stretches of the cut.
    kept: Vec<u32>,
    edges: Vec<FreeEdge>,
}

impl Assembly {
    pub(super) fn new<K: Kernel>(slice: &Slice<K>, strip: Strip, b: Boundary) -> Option<Assembly> {
        let mut a = Assembly {
            renamed: Vec::with_capacity(b.vertices.len()),
            vertices: Vec::with_capacity(b.vertices.len()),
            links: Vec::with_capacity(b.vertices.len()),
            kept: Vec::with_capacity(b.edges.len()),
            edges: Vec::with_capacity(b.edges.len()),
            strip,
            b,
        };
        a.take_vertices()?;
        a.take_edges(slice);
        Some(a)
    }

    /// The strip's vertices, those on the cut united with their partners. None if one lies on the cut where
    /// nothing can end.
    fn take_vertices(&mut self) -> Option<()> {
        let k = &mut self.b.kernel;
        let cuts = [Rat::from(-1), Rat::from(3)];
        let cut_ids = [k.rational(&cuts[0]), k.rational(&cuts[1])];
        let rest = k.rational(&Rat::zero());
        let mut on_cut: HashMap<usize, u32> = HashMap::new();
        for (v, &(num, curve)) in self.b.vertices.iter().enumerate() {
            let (lo, hi) = k.enclosure(num);
            let mut stop = None;
            for (x, &id) in cuts.iter().zip(&cut_ids) {
                if k.cmp(num, id).is_eq() {
                    let (p, q) = k.polys(curve);
                    let t = p.eval(x) / q.eval(x);
                    stop = Some(self.strip.stops.binary_search(&t).ok()?);
                }
            }
            let next = self.vertices.len() as u32;
            let id = match stop {
                Some(s) => *on_cut.entry(s).or_insert(next),
                None => next,
            };
            if id == next {
                let t = k.height(curve, num);
                self.vertices.push(FreeVertex {
                    num,
                    curve,
                    x: [lo, hi],
                    t: [t.lo(), t.hi()],
                    // On the cut, −π/2 for the edges of the rest chart.
                    side: if stop.is_some() {
                        -1
                    } else {
                        k.cmp(num, rest) as i8
                    },
                    cut: stop.is_some(),
                    rest_open: false,
                });
                let mut links = Vec::new();
                if let Some(s) = stop {
                    // Beyond the cut too, where F may not lie: what ends on it there touches the state
                    // on this side of it.
                    let (t, ends) = (&self.strip.stops[s], &self.strip.at_cut);
                    let from = ends.partition_point(|e| e.0 < *t);
                    let here = ends[from..].iter().take_while(|e| e.0 == *t);
                    links.extend(here.map(|e| e.1));
                }
                self.links.push(links);
            }
            let links =
                &self.b.links[self.b.link_starts[v] as usize..self.b.link_starts[v + 1] as usize];
            for &item in links {
                if let Owner::Arc(a) = self.strip.owners[item as usize] {
                    self.links[id as usize].push(a);
                }
            }
            self.renamed.push(id);
        }
        for l in &mut self.links {
            l.sort_unstable();
            l.dedup();
        }
        Some(())
    }

    fn take_edges<K: Kernel>(&mut self, slice: &Slice<K>) {
        for e in &self.b.edges {
            let owner = self.strip.owners[e.item as usize];
            if owner == Owner::Cut {
                self.kept.push(NONE);
                continue;
            }
            self.kept.push(self.edges.len() as u32);
            let Lie {
                shape,
                chart,
                left_is_above,
            } = lie(slice, owner);
            let ends = e.ends.map(|v| self.b.vertices[v as usize]);
            let k = &self.b.kernel;
            let t = ends.map(|(num, curve)| k.height(curve, num));
            let (lo, hi) = (k.enclosure(ends[0].0).0, k.enclosure(ends[1].0).1);
            let [left, right] = e.sides;
            self.edges.push(FreeEdge {
                owner,
                low: self.renamed[e.ends[0] as usize],
                high: self.renamed[e.ends[1] as usize],
                above: if left_is_above { left } else { right },
                below: if left_is_above { right } else { left },
                bounds: [lo, hi, t[0].lo().min(t[1].lo()), t[0].hi().max(t[1].hi())],
                shape,
                chart,
                ends: [ends[0].0, ends[1].0],
                curve: self.b.curves[e.item as usize].unwrap_or(NONE),
                left_is_above,
            });
        }
    }

    /// The cycles of the cylinder: where the strip's boundary turns along a stretch of the cut, the walk
    /// goes on beyond it. None if the face does not lie beyond it, as it must.
    fn cycles(&self) -> Option<(Vec<u32>, Vec<u32>)> {
        let b = &self.b;
        let mut next = vec![NONE; 2 * b.edges.len()];
        for w in b.cycles.windows(2) {
            let cycle = &b.order[w[0] as usize..w[1] as usize];
            for (i, &h) in cycle.iter().enumerate() {
                next[h as usize] = cycle[(i + 1) % cycle.len()];
            }
        }
        // Which half-edge runs along the other side of a stretch of the cut.
        let uprights = self.strip.owners.len() - self.strip.uprights.len();
        let first = self.strip.uprights.len() - 2 * self.strip.glue.len();
        let mut across: HashMap<usize, u32> = HashMap::new();
        for (e, edge) in b.edges.iter().enumerate() {
            if self.kept[e] == NONE {
                // The right border is walked upwards, the left one downwards.
                across.insert(edge.item as usize, 2 * e as u32 + u32::from(!edge.sides[0]));
            }
        }
        let twin = |h: u32| {
            let item = b.edges[h as usize / 2].item as usize;
            let other = ((item - uprights - first) ^ 1) + uprights + first;
            across.get(&other).copied()
        };
        let (mut order, mut cycles) = (Vec::new(), vec![0]);
        let mut seen = vec![false; next.len()];
        for h0 in b.order.iter().copied() {
            if seen[h0 as usize] || self.kept[h0 as usize / 2] == NONE {
                continue;
            }
            let mut h = h0;
            while !seen[h as usize] {
                seen[h as usize] = true;
                order.push(2 * self.kept[h as usize / 2] + h % 2);
                h = next[h as usize];
                while self.kept[h as usize / 2] == NONE {
                    h = next[twin(h)? as usize];
                }
            }
            cycles.push(order.len() as u32);
        }
        Some((order, cycles))
    }

    pub(super) fn finish<K: Kernel>(
        mut self,
        slice: &Slice<K>,
        start: Configuration,
        found: Found,
    ) -> Option<Free> {
        let (order, cycles) = self.cycles()?;
        // Vertices that only the cut had are no longer any.
        let mut number = vec![NONE; self.vertices.len()];
        let (mut vertices, mut links, mut link_starts) = (Vec::new(), Vec::new(), vec![0]);
        for e in &mut self.edges {
            for v in [&mut e.low, &mut e.high] {
                let n = &mut number[*v as usize];
                if *n == NONE {
                    *n = vertices.len() as u32;
                    vertices.push(self.vertices[*v as usize]);
                    links.extend_from_slice(&self.links[*v as usize]);
                    link_starts.push(links.len() as u32);
                }
                *v = *n;
            }
        }
        let draft = Draft {
            kernel: Arc::new(Mutex::new(self.b.kernel)),
            vertices,
            links,
            link_starts,
            edges: self.edges,
            order,
            cycles,
        };
        Some(draft.annotate(slice, start, found, None))
    }
}
