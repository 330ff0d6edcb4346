//! A phase run backwards: the same slice and the same F with time turned round.
//!
//! A reversed phase moves the hinge back along its path, so at t' = T − t everything touches as it did at t. Patches,
//! curves and arcs are those of the phase with t replaced by T − t, an exact substitution in
//! coefficients; no patch is culled again, no root isolated, and F keeps its boundary. What depends on which way
//! time runs is made anew: which end of an edge comes first, what leaves a vertex, where F goes on along rest. (The
//! friction regions belong to the arc and the velocity and are never stored.)

use super::annotate::Draft;
use super::assemble::lie;
use super::free::{Free, FreeEdge, FreeVertex};
use super::{Arc, Curve, End, Owner, Point, Shape, Side, Slice};
use crate::contact::{Chart, Frame, Patch, Trig};
use crate::face::FaceKernel;
use crate::kernel::{Instant, Kernel, Polynomial};
use crate::number::{Poly, Rat, Scalar};
use std::collections::HashMap;

/// Instants turned round, each handle once, so that shared handles stay shared.
struct Mirror<K: Kernel> {
    end: K::Num,
    /// By the bits of the enclosure.
    known: HashMap<[u64; 2], Vec<(K::Time, K::Time)>>,
}

impl<K: Kernel> Mirror<K> {
    fn time(&mut self, x: &K::Root, t: &K::Time) -> K::Time {
        let i = t.interval();
        let list = self
            .known
            .entry([i.lo, i.hi].map(f64::to_bits))
            .or_default();
        if let Some((_, m)) = list.iter().find(|(o, _)| o.same(t)) {
            return m.clone();
        }
        let mirrored = match t.known() {
            Some(t) => K::Time::of(self.end.minus(&t)),
            None => {
                let (num, den) = t.parts();
                let (p, q) = turned::<K>(&num, &den, &self.end);
                K::Time::ratio(x, p, q)
            }
        };
        list.push((t.clone(), mirrored.clone()));
        mirrored
    }
    fn end(&mut self, e: &End<K>) -> End<K> {
        End {
            x: e.x.clone(),
            t: self.time(&e.x, &e.t),
        }
    }
}

/// end − num/den as (numerator, denominator).
fn turned<K: Kernel>(num: &K::Poly, den: &K::Poly, end: &K::Num) -> (K::Poly, K::Poly) {
    let zero = K::Num::zero;
    let (up, down) = K::Poly::pair(
        &[end.clone(), zero(), zero()],
        &[K::Num::one(), zero(), zero()],
    );
    (den.times(&up).minus(&num.times(&down)), den.times(&down))
}

/// f₀ + t·f₁ with t = end − t'.
fn substituted<R: Scalar>(f: (&Trig<R>, &Trig<R>), end: &R) -> (Trig<R>, Trig<R>) {
    (f.0.add(&f.1.scale(end)), f.1.neg())
}

fn patch<R: Scalar>(p: &Patch<R>, end: &R) -> Patch<R> {
    let (f0, f1) = substituted((&p.f0, &p.f1), end);
    Patch {
        f0,
        f1,
        location: [0, 1].map(|i| substituted((&p.location[i].0, &p.location[i].1), end)),
        ..p.clone()
    }
}

impl<K: Kernel> Slice<K> {
    /// The slice of the phase run backwards: what [`Slice::new`] makes of the reversed phase, from this one.
    ///
    /// Cost: a few operations an arc; crossings are found anew where they are asked for.
    pub fn reversed(&self) -> Slice<K> {
        let end = &self.frame.duration;
        let mut mirror = Mirror {
            end: end.clone(),
            known: HashMap::new(),
        };
        let patches: Vec<Patch<K::Num>> = self.patches.iter().map(|p| patch(p, end)).collect();
        // A curve's coefficients by any patch on it, in their normal form, and the sign that it takes.
        let mut by: Vec<Option<u32>> = vec![None; self.curves.len()];
        for (arc, patch) in self.arcs.iter().zip(&self.patch_of) {
            by[arc.curve as usize] = by[arc.curve as usize].or(*patch);
        }
        let mut flips = vec![1; self.curves.len()];
        let mut curves = Vec::with_capacity(self.curves.len());
        for (i, c) in self.curves.iter().enumerate() {
            let Some(p) = by[i].map(|p| p as usize) else {
                curves.push(c.clone());
                continue;
            };
            let normal = |p: &Patch<K::Num>| {
                let all =
                    p.f0.form(Chart::Rest)
                        .into_iter()
                        .chain(p.f1.form(Chart::Rest));
                K::primitive(&all.collect::<Vec<_>>())
            };
            let (Some((_, before)), Some((all, after))) =
                (normal(&self.patches[p]), normal(&patches[p]))
            else {
                curves.push(c.clone());
                continue;
            };
            flips[i] = before * after;
            let reduced = Chart::BOTH.map(|chart| {
                let (rp, rq) = c.reduced(chart);
                // t = −rp/rq, so t' = end + rp/rq.
                let (num, den) = turned::<K>(&rp.negated(), rq, end);
                (num.negated(), den)
            });
            let [(rp0, rq0), (rp1, rq1)] = reduced;
            curves.push(Curve {
                p: std::array::from_fn(|i| all[i].clone()),
                q: std::array::from_fn(|i| all[i + 3].clone()),
                rp: [rp0, rp1],
                rq: [rq0, rq1],
            });
        }
        let arcs = self
            .arcs
            .iter()
            .map(|a| {
                let (lo, hi) = (mirror.end(&a.lo), mirror.end(&a.hi));
                let (lo, hi) = match a.shape {
                    Shape::Level => (hi, lo),
                    _ => (lo, hi),
                };
                Arc {
                    branch: a.branch * flips[a.curve as usize],
                    shape: match a.shape {
                        Shape::Graph { rising } => Shape::Graph { rising: !rising },
                        s => s,
                    },
                    side: match a.side {
                        Side::Before => Side::After,
                        Side::After => Side::Before,
                        s => s,
                    },
                    lo,
                    hi,
                    ..a.clone()
                }
                .with_spans()
            })
            .collect();
        let named = self
            .named
            .iter()
            .map(|points| {
                let turn = |p: &Point<K>| Point {
                    t: mirror.time(&p.x, &p.t),
                    ..p.clone()
                };
                points.iter().map(turn).collect()
            })
            .collect();
        Slice {
            frame: Frame {
                p0: &self.frame.p0 + &self.frame.v.scale(end),
                v: -&self.frame.v,
                duration: end.clone(),
            },
            curves,
            arcs,
            by_chart: self.by_chart.clone(),
            patch_of: self.patch_of.clone(),
            patches,
            named,
            crossings: Default::default(),
        }
    }
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
    /// Cost: O(|F| log |F|) for the annotation.
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
            let level = e.shape == Shape::Level;
            let along_t = !matches!(e.shape, Shape::Graph { .. } | Shape::Level);
            let (low, high) = if level {
                (e.high, e.low)
            } else {
                (e.low, e.high)
            };
            let (above, below) = if along_t {
                (e.below, e.above)
            } else {
                (e.above, e.below)
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
                    super::free::NONE => super::free::NONE,
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
        Some(draft.annotate(slice, start, self.found))
    }
}
