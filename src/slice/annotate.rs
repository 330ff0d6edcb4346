//! The annotation of F's boundary (DP §9.4): what the sweep needs to handle an event in O(1).
//!
//! For each vertex the edges that leave it towards later times, and whether F goes on along rest from there; for
//! each arc its edges in order of time; and where the boundary touches rest. All of it depends on which way time runs,
//! so a boundary that is turned round in time is annotated afresh.

use super::free::{Free, FreeEdge, FreeVertex, Touch};
use super::strip::Owner;
use super::{ArcId, Configuration, Shape, Slice};
use crate::face::{FaceKernel, Found};
use crate::geometry::index::{Hull, Tree};
use crate::kernel::{Instant, Kernel};
use crate::number::{Rat, Scalar};
use std::cmp::Ordering;
use std::sync::{Arc, Mutex};

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

/// The box of an edge and, for a graph, a strip along its chord: long edges beside each other share most of their
/// boxes.
fn hull(k: &FaceKernel, e: &FreeEdge) -> Hull {
    let boxed = Hull::boxed(e.bounds);
    match e.shape {
        Shape::Graph { .. } if matches!(e.owner, Owner::Arc(_)) => {
            let strip = k.hull(e.curve, e.bounds[0], e.bounds[1]);
            if strip.low.is_finite() && strip.high.is_finite() {
                Hull {
                    bounds: e.bounds,
                    ..strip
                }
            } else {
                boxed
            }
        }
        _ => boxed,
    }
}

/// What is to be known along whole arcs.
#[derive(Clone, Default)]
pub(super) struct Along {
    known: bool,
    /// (arc, edge) by arc, then in order of time, overlapping arcs included.
    pub(super) on: Vec<(ArcId, u32)>,
    /// Graphs by curve and branch, so that those that lie on one another stand together.
    graphs: Vec<ArcId>,
    /// Where in `graphs` those that an arc may lie on begin and end.
    range: Vec<[u32; 2]>,
    levels: Vec<ArcId>,
}

impl Along {
    fn twins<K: Kernel>(slice: &Slice<K>) -> Along {
        let arcs = slice.arcs();
        let (mut graphs, mut levels): (Vec<ArcId>, Vec<ArcId>) = (Vec::new(), Vec::new());
        for (i, a) in arcs.iter().enumerate().filter(|(_, a)| a.is_barrier()) {
            match a.shape {
                Shape::Level => levels.push(i as ArcId),
                Shape::Wall => {}
                Shape::Graph { .. } => graphs.push(i as ArcId),
            }
        }
        let key = |i: &ArcId| {
            let a = &arcs[*i as usize];
            (a.curve, a.branch, a.chart)
        };
        graphs.sort_by_key(key);
        let mut range = vec![[0; 2]; arcs.len()];
        let mut from = 0;
        for same in graphs.chunk_by(|a, b| key(a) == key(b)) {
            let to = from + same.len() as u32;
            for &a in same {
                range[a as usize] = [from, to];
            }
            from = to;
        }
        Along {
            known: true,
            on: Vec::new(),
            graphs,
            range,
            levels,
        }
    }
    /// The same with time turned round.
    pub(super) fn reversed(&self) -> Along {
        let mut along = self.clone();
        for same in along.on.chunk_by_mut(|a, b| a.0 == b.0) {
            same.reverse();
        }
        along
    }
    /// The arcs among which are all that coincide with one wherever both exist.
    pub(super) fn beside<K: Kernel>(&self, slice: &Slice<K>, arc: ArcId) -> &[ArcId] {
        match slice.arc(arc).shape {
            Shape::Level => &self.levels,
            _ => {
                let [from, to] = self.range[arc as usize];
                &self.graphs[from as usize..to as usize]
            }
        }
    }
}

/// A boundary that is whole but not annotated.
pub(super) struct Draft {
    pub(super) kernel: Arc<Mutex<FaceKernel>>,
    pub(super) vertices: Vec<FreeVertex>,
    pub(super) links: Vec<ArcId>,
    pub(super) link_starts: Vec<u32>,
    pub(super) edges: Vec<FreeEdge>,
    pub(super) order: Vec<u32>,
    pub(super) cycles: Vec<u32>,
}

impl Draft {
    /// F, found from a configuration. O(|F| log |F|) and O(n) for the arcs that lie on one another.
    ///
    /// What is known along the arcs already is taken as it is.
    pub(super) fn annotate<K: Kernel>(
        mut self,
        slice: &Slice<K>,
        start: Configuration,
        found: Found,
        along: Option<Along>,
    ) -> Free {
        self.mark_rest();
        let timed = |e: &FreeEdge| {
            matches!(e.shape, Shape::Graph { .. } | Shape::Level) && e.owner != Owner::Cut
        };
        let edges = self.edges;
        let vertices = self.vertices;
        let mut leaving: Vec<u32> = (0..edges.len() as u32)
            .filter(|&e| timed(&edges[e as usize]))
            .collect();
        leaving.sort_by_key(|&e| edges[e as usize].first());
        let leaving_starts = starts(
            leaving.iter().map(|&e| edges[e as usize].first()),
            vertices.len(),
        );
        let entries = {
            let k = self.kernel.lock().unwrap_or_else(|e| e.into_inner());
            let hulls = edges.iter().map(|e| hull(&k, e));
            hulls.zip(0..).collect()
        };
        let mut free = Free {
            kernel: self.kernel,
            duration: slice.frame.duration.to_rat(),
            start,
            found,
            vertices,
            links: self.links,
            link_starts: self.link_starts,
            edges,
            order: self.order,
            cycles: self.cycles,
            leaving,
            leaving_starts,
            along: along.unwrap_or_default(),
            touches: Vec::new(),
            rest_at_end: Vec::new(),
            tree: Tree::new(entries),
        };
        if !free.along.known {
            free.along = Along::twins(slice);
            free.sort_arcs(slice);
        }
        free.find_touches(slice);
        free
    }

    /// For vertices at rest, whether F holds what comes right after them at rest: whether one of the sectors
    /// of F there holds the direction of time.
    fn mark_rest(&mut self) {
        let mut k = self.kernel.lock().unwrap_or_else(|e| e.into_inner());
        let (order, cycles) = (&self.order, &self.cycles);
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
        self.along.on = on;
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
