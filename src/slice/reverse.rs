//! A phase run backwards: the same slice and the same F with time turned round.
//!
//! A reversed phase moves the hinge back along its path, so at t' = T − t everything touches as it did at t. Which pairs
//! of features may touch, and which arcs they have, need not be looked for again: an arc's enclosures are turned
//! round, and its exact part is cut from the reversed patch when a question asks for it, the k-th arc of its
//! patch as before, since arcs of a patch follow each other along x. F keeps its boundary. What depends on which way
//! time runs is made anew: which end of an edge comes first, what leaves a vertex, where F goes on along rest. (The
//! friction regions belong to the arc and the velocity and are never stored.)

use super::annotate::Draft;
use super::assemble::lie;
use super::free::{Free, FreeEdge, FreeVertex, NONE};
use super::shop::Shop;
use super::{Arc, ArcId, Owner, Shape, Side, Slice};
use crate::contact::{Contact, Frame};
use crate::face::FaceKernel;
use crate::kernel::Kernel;
use crate::number::{Interval, Poly, Rat, Scalar};
use std::cell::OnceCell;
use std::collections::HashMap;
use std::rc::Rc;

fn turned_shape(s: Shape) -> Shape {
    match s {
        Shape::Graph { rising } => Shape::Graph { rising: !rising },
        s => s,
    }
}

fn turned_side(s: Side) -> Side {
    match s {
        Side::Before => Side::After,
        Side::After => Side::Before,
        s => s,
    }
}

/// Whether one arc is the other turned round, as far as that shows without exact numbers.
fn matches<K: Kernel>(a: &Arc<K>, turned: &Arc<K>) -> bool {
    a.contact == turned.contact
        && a.chart == turned.chart
        && turned_shape(a.shape) == turned.shape
        && turned_side(a.side) == turned.side
}

impl<K: Kernel> Slice<K> {
    /// The slice of the phase run backwards: what [`Slice::new`] makes of the reversed phase, arc by arc with the
    /// same ids, from this one and the pawl's angular stops. None where an arc that only just touches the
    /// phase's ends counts on one way and not on the other.
    ///
    /// Cost: O(1) an arc in doubles; exact numbers where something is asked.
    pub fn reversed(&self, limits: Option<&(K::Num, K::Num)>) -> Option<Slice<K>> {
        let end = &self.frame.duration;
        let frame = Frame {
            p0: &self.frame.p0 + &self.frame.v.scale(end),
            v: -&self.frame.v,
            duration: end.clone(),
        };
        let shop = Rc::new(self.shop.reversed(frame.clone()));
        let end = Scalar::interval(end);
        let mut arcs: Vec<Arc<K>> = Vec::with_capacity(self.arcs().len());
        let mut at = 0;
        while let Some(arc) = self.arcs().get(at) {
            if let Some((_, patch, k)) = &arc.source {
                arcs.push(seen(arc, end, (shop.clone(), *patch, *k)));
                at += 1;
                continue;
            }
            if let Contact::Limit(which) = arc.contact {
                let (lo, hi) = limits?;
                arcs.push(shop.limit(if which == 0 { lo } else { hi }, which));
                at += 1;
                continue;
            }
            let patch = self.patch_id(at as ArcId)?;
            let to = (at..self.arcs().len())
                .find(|&i| self.patch_id(i as ArcId) != Some(patch))
                .unwrap_or(self.arcs().len());
            worked_out(&self.arcs()[at..to], &shop.within(patch, end.hi), &mut arcs)?;
            at = to;
        }
        Some(self.with_arcs(frame, arcs, shop))
    }
}

/// An arc that doubles see, turned round.
fn seen<K: Kernel>(arc: &Arc<K>, end: Interval, source: (Rc<Shop<K>>, u32, u32)) -> Arc<K> {
    Arc {
        shape: turned_shape(arc.shape),
        side: turned_side(arc.side),
        t_span: end - arc.t_span,
        ends: arc.ends.map(|(x, t)| (x, end - t)),
        at_rest: end - arc.at_rest,
        exact: OnceCell::new(),
        source: Some(source),
        ..arc.clone()
    }
}

/// The arcs of a patch that was worked out at once, worked out anew: in the order of those that they turn round, which
/// is the other way about along a level.
fn worked_out<K: Kernel>(old: &[Arc<K>], new: &[Arc<K>], out: &mut Vec<Arc<K>>) -> Option<()> {
    if old.len() != new.len() {
        return None;
    }
    let mut from = 0;
    while from < old.len() {
        let mut to = from + 1;
        while to < old.len()
            && old[from].shape == Shape::Level
            && old[to].shape == Shape::Level
            && old[from].chart == old[to].chart
            && old[from].lo.x == old[to].lo.x
        {
            to += 1;
        }
        for (i, a) in old[from..to].iter().enumerate() {
            let turned = &new[to - 1 - i];
            if !matches(a, turned) {
                return None;
            }
            out.push(turned.clone());
        }
        from = to;
    }
    Some(())
}

/// The face kernel's curve T − P/Q.
fn turned_curve(
    k: &mut FaceKernel,
    known: &mut HashMap<u32, u32>,
    c: u32,
    end: &Rat,
) -> Option<u32> {
    if let Some(&m) = known.get(&c) {
        return Some(m);
    }
    let (p, q) = k.polys(c);
    let p: Poly = q.scale(end.numer()) - p.scale(end.denom());
    let q: Poly = q.scale(end.denom());
    let three = |f: &Poly| [0, 1, 2].map(|i| f.coeff(i));
    let m = k.curve(&three(&p), &three(&q)).ok()?;
    known.insert(c, m);
    Some(m)
}

impl Free {
    /// F of the phase run backwards, on the slice that [`Slice::reversed`] makes: nothing is traced again.
    /// None only where a curve cannot be turned, which certified kernels never make.
    ///
    /// Cost: O(|F| log |F|) for the annotation, and a copy of what is known of overlapping arcs.
    pub fn reversed<K: Kernel>(&self, slice: &Slice<K>) -> Option<Free> {
        let end = &self.duration;
        let mut known = HashMap::new();
        let mut k = self.kernel();
        let mut vertices = Vec::with_capacity(self.vertices.len());
        for v in &self.vertices {
            let curve = turned_curve(&mut k, &mut known, v.curve, end)?;
            let t = k.height(curve, v.num);
            vertices.push(FreeVertex {
                curve,
                t: [t.lo(), t.hi()],
                rest_open: false,
                ..*v
            });
        }
        let mut edges = Vec::with_capacity(self.edges.len());
        for e in &self.edges {
            let owner = match e.owner {
                Owner::Start => Owner::End,
                Owner::End => Owner::Start,
                o => o,
            };
            let lie = lie(slice, owner);
            let (low, high) = match e.shape {
                Shape::Level => (e.high, e.low),
                _ => (e.low, e.high),
            };
            let (above, below) = match e.shape {
                Shape::Wall => (e.below, e.above),
                _ => (e.above, e.below),
            };
            let t = [low, high].map(|v| vertices[v as usize].t);
            edges.push(FreeEdge {
                owner,
                low,
                high,
                above,
                below,
                bounds: [
                    e.bounds[0],
                    e.bounds[1],
                    t[0][0].min(t[1][0]),
                    t[0][1].max(t[1][1]),
                ],
                shape: lie.shape,
                chart: lie.chart,
                curve: match e.curve {
                    NONE => NONE,
                    c => turned_curve(&mut k, &mut known, c, end)?,
                },
                left_is_above: lie.left_is_above,
                ..*e
            });
        }
        drop(k);
        // Turned round, F lies on the left of the way back; a level's direction is turned with time.
        let mut order = Vec::with_capacity(self.order.len());
        for w in self.cycles.windows(2) {
            let cycle = &self.order[w[0] as usize..w[1] as usize];
            order.extend(cycle.iter().rev().map(|&h| {
                let level = self.edges[h as usize / 2].shape == Shape::Level;
                if level { h } else { h ^ 1 }
            }));
        }
        let along = self.along.reversed();
        let mut start = self.start.clone();
        start.t = end - &start.t;
        let draft = Draft {
            kernel: self.kernel.clone(),
            vertices,
            links: self.links.clone(),
            link_starts: self.link_starts.clone(),
            edges,
            order,
            cycles: self.cycles.clone(),
        };
        Some(draft.annotate(slice, start, self.found, Some(along)))
    }
}
