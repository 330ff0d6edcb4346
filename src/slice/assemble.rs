//! From the face of the strip to F: the cut is taken out, and the boundary annotated (DP §9.4).
//!
//! An edge that ends on the cut is followed by the one that begins on its other side. Then, for each vertex, all
//! arcs through it and the edges that leave it towards later times; for each arc its edges in order of time; and
//! where the boundary touches rest.

use super::free::{Free, FreeEdge, FreeVertex, NONE, Touch};
use super::strip::{Owner, Strip};
use super::{ArcId, Configuration, Shape, Slice};
use crate::contact::Chart;
use crate::face::{Boundary, FaceKernel, Found};
use crate::geometry::index::{Hull, Tree};
use crate::kernel::{Instant, Kernel};
use crate::number::{Rat, Scalar};
use std::cmp::Ordering;
use std::collections::HashMap;
use std::sync::Mutex;

/// How a boundary edge of the strip lies there.
struct Lie {
    shape: Shape,
    chart: Chart,
    left_is_above: bool,
}

fn lie<K: Kernel>(slice: &Slice<K>, owner: Owner) -> Lie {
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

/// CSR starts from sorted keys.
fn starts(keys: impl Iterator<Item = u32>, n: usize) -> Vec<u32> {
    let mut out = vec![0u32; n + 1];
    for k in keys {
        out[k as usize + 1] += 1;
    }
    for i in 0..n {
        out[i + 1] += out[i];
    }
    out
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
        let uprights = self.strip.graphs.len();
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
        self.mark_rest(&order, &cycles);
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
        let timed = |e: &FreeEdge| {
            matches!(e.shape, Shape::Graph { .. } | Shape::Level) && e.owner != Owner::Cut
        };
        let edges = self.edges;
        let mut leaving: Vec<u32> = (0..edges.len() as u32)
            .filter(|&e| timed(&edges[e as usize]))
            .collect();
        leaving.sort_by_key(|&e| edges[e as usize].first());
        let leaving_starts = starts(
            leaving.iter().map(|&e| edges[e as usize].first()),
            vertices.len(),
        );
        let entries = edges
            .iter()
            .enumerate()
            .map(|(i, e)| (Hull::boxed(e.bounds), i as u32))
            .collect();
        let mut twins: HashMap<(u32, i32, Chart), Vec<ArcId>> = HashMap::new();
        let mut levels = Vec::new();
        for (i, a) in slice
            .arcs()
            .iter()
            .enumerate()
            .filter(|(_, a)| a.is_barrier())
        {
            match a.shape {
                Shape::Level => levels.push(i as ArcId),
                Shape::Wall => {}
                Shape::Graph { .. } => twins
                    .entry((a.curve, a.branch, a.chart))
                    .or_default()
                    .push(i as ArcId),
            }
        }
        let mut free = Free {
            kernel: Mutex::new(self.b.kernel),
            duration: slice.frame.duration.to_rat(),
            start,
            found,
            vertices,
            links,
            link_starts,
            edges,
            order,
            cycles,
            leaving,
            leaving_starts,
            on: Vec::new(),
            touches: Vec::new(),
            rest_at_end: Vec::new(),
            tree: Tree::new(entries),
            twins,
            levels,
        };
        free.sort_arcs(slice);
        free.find_touches(slice);
        Some(free)
    }

    /// For vertices at rest, whether F holds what comes right after them at rest: whether one of the sectors
    /// of F there holds the direction of time.
    fn mark_rest(&mut self, order: &[u32], cycles: &[u32]) {
        // Directions counter-clockwise from straight down: t upwards, x to the right.
        let class = |e: &FreeEdge, forward: bool| match (e.shape == Shape::Level, forward) {
            (true, false) => 0,
            (false, true) => 1,
            (true, true) => 2,
            (false, false) => 3,
        };
        for w in cycles.windows(2) {
            let cycle = &order[w[0] as usize..w[1] as usize];
            for (i, &h) in cycle.iter().enumerate() {
                let n = cycle[(i + 1) % cycle.len()];
                let (come, go) = (self.edges[h as usize / 2], self.edges[n as usize / 2]);
                let v = if h % 2 == 0 { come.high } else { come.low };
                if self.vertices[v as usize].side != 0 {
                    continue;
                }
                let (a, b) = (class(&go, n.is_multiple_of(2)), class(&come, h % 2 == 1));
                let x = self.vertices[v as usize].num;
                let k = &mut self.b.kernel;
                let holds = match a.cmp(&b) {
                    _ if n == h ^ 1 => a != 2,
                    Ordering::Less => a < 2 && b > 2,
                    Ordering::Greater => a < 2 || b > 2,
                    Ordering::Equal if a == 1 => {
                        !k.cmp_beside(go.curve, come.curve, x, true).is_lt()
                    }
                    Ordering::Equal => !k.cmp_beside(go.curve, come.curve, x, false).is_gt(),
                };
                self.vertices[v as usize].rest_open |= holds;
            }
        }
    }
}

impl Free {
    /// The edges of each arc, in order of time.
    fn sort_arcs<K: Kernel>(&mut self, slice: &Slice<K>) {
        let mut on = Vec::with_capacity(self.edges.len());
        for (i, e) in self.edges.iter().enumerate() {
            let Owner::Arc(a) = e.owner else { continue };
            on.push((a, i as u32));
            for &b in self.arcs_at(e.low) {
                if b != a && slice.coincide(a, b) && self.arcs_at(e.high).binary_search(&b).is_ok()
                {
                    on.push((b, i as u32));
                }
            }
        }
        let mut k = self.kernel.lock().unwrap_or_else(|e| e.into_inner());
        on.sort_by(|p, q| {
            p.0.cmp(&q.0).then_with(|| {
                let (e, f) = (&self.edges[p.1 as usize], &self.edges[q.1 as usize]);
                let by_x = k.cmp(e.ends[0], f.ends[0]);
                match e.shape {
                    Shape::Graph { rising: false } => by_x.reverse(),
                    Shape::Level => by_x.then_with(|| {
                        let [v, w] = [e, f].map(|e| self.vertices[e.low as usize]);
                        k.cmp_at(v.curve, w.curve, v.num)
                    }),
                    _ => by_x,
                }
            })
        });
        drop(k);
        on.dedup();
        self.on = on;
    }

    fn find_touches<K: Kernel>(&mut self, slice: &Slice<K>) {
        let zero = Rat::zero();
        let mut found: Vec<(Rat, u32, Option<u32>)> = Vec::new();
        let mut at_end = Vec::new();
        {
            let mut k = self.kernel();
            let rest = k.rational(&zero);
            let value = |k: &FaceKernel, curve: u32| {
                let (p, q) = k.polys(curve);
                p.eval(&zero) / q.eval(&zero)
            };
            for (i, e) in self.edges.iter().enumerate() {
                // By the edge's own ends: a vertex on the cut lies on both of the strip's borders.
                if e.bounds[0] > 0.0
                    || e.bounds[1] < 0.0
                    || k.cmp(e.ends[0], rest).is_gt()
                    || k.cmp(e.ends[1], rest).is_lt()
                {
                    continue;
                }
                let i = i as u32;
                match (e.owner, e.shape) {
                    (Owner::End, _) => {
                        at_end.extend_from_slice(self.arcs_at(e.low));
                        at_end.extend_from_slice(self.arcs_at(e.high));
                        for v in [e.low, e.high] {
                            if self.vertices[v as usize].side == 0 {
                                found.push((self.duration.clone(), i, Some(v)));
                            }
                        }
                    }
                    (Owner::Arc(a), Shape::Level) => {
                        for v in [e.low, e.high] {
                            found.push((value(&k, self.vertices[v as usize].curve), i, Some(v)));
                        }
                        if let Some(t) = slice.arc(a).lo.t.decided() {
                            found.push((t.to_rat(), i, None));
                        }
                    }
                    (Owner::Arc(_), _) => {
                        let v = [e.low, e.high]
                            .into_iter()
                            .find(|&v| self.vertices[v as usize].side == 0);
                        found.push((value(&k, e.curve), i, v));
                    }
                    _ => {}
                }
            }
        }
        at_end.sort_unstable();
        at_end.dedup();
        self.rest_at_end = at_end;
        found.sort_by(|a, b| a.0.cmp(&b.0));
        let mut touches: Vec<Touch> = Vec::new();
        for (t, e, v) in found {
            match touches.last_mut() {
                Some(l) if l.t == t => {
                    l.edges.push(e);
                    l.vertex = l.vertex.or(v);
                }
                _ => touches.push(Touch {
                    t,
                    edges: vec![e],
                    vertex: v,
                }),
            }
        }
        self.touches = touches;
    }
}
