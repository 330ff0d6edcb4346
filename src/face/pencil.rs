//! Many arcs through one point, told apart by blowing the point up.
//!
//! The idea: k arcs through a point overlap near it in every hull, so a search along one of them finds all the
//! others, k² in all, though most of them meet it nowhere else. Subtract one of the arcs from all and divide by
//! u − x: t ↦ (t − t₀)·Q₀/(u − x) is one-to-one beside the point, so whatever meets elsewhere still meets, but at
//! the point itself arcs of different slopes now lie at different heights. Where they all touch, divide again. In
//! this plane an index of hulls works as it does anywhere else. (Blowing up is how algebraic geometry resolves
//! singular points; the quotients are exact because the common root is.)

use super::approx::Approx;
use super::cluster::{Cluster, Core};
use super::isolate::bernstein;
use super::item::{Carrier, Item, NONE};
use super::kernel::{CurveId, Kernel, NumId, in_parts};
use super::trace::Tracer;
use crate::geometry::index::{Hull, Tree};

/// Where arcs were blown up, and against which of them.
#[derive(Clone)]
struct Chart {
    /// The curve subtracted.
    reference: CurveId,
    /// The points and how often each was divided by; in all at most four.
    at: Vec<(NumId, usize)>,
    /// Where they pass near one another but not through one point.
    core: Option<Core>,
}

/// Arcs through a point, in the plane where it is blown up. Those of them that touch there, or pass through a second
/// point together, may be a pencil of their own within it.
pub(super) struct Pencil {
    chart: Chart,
    /// The pencil within which this one is, made earlier; and the outermost one.
    pub(super) parent: u32,
    pub(super) root: u32,
    /// The members there.
    tree: Tree,
    count: usize,
    /// Whether all of them are lines in the chart, so that what hulls do not tell apart meets.
    pub(super) straight: bool,
    /// How its members pass one another within the core, if it has one.
    pub(super) cluster: Option<Cluster>,
    /// The index of all others, if this is an outermost pencil and its members are a large part of all items.
    pub(super) rest: Option<Tree>,
}

/// Into how many pieces each member that is no line in the chart is cut for the index.
const PIECES: usize = 2;

/// A curve in the plane of a chart: a cubic over a quadratic.
struct BlownUp {
    top: [Approx; 5],
    below: [Approx; 5],
}

impl BlownUp {
    /// Whether it is a line.
    fn straight(&self) -> bool {
        let is_zero = |c: &Approx| c.sign() == Some(0);
        self.below[1..].iter().all(is_zero) && self.top[2..].iter().all(is_zero)
    }

    /// A hull over [a, b].
    fn hull(&self, a: f64, b: f64) -> Hull {
        let over = |f: &[Approx; 5], a, b| bernstein(&f[..4], a, b);
        let q = over(&self.below, a, b);
        let p = over(&self.top, a, b);
        let Some((lo, hi)) = quotients(&p, &q) else {
            let part = |a, b| quotients(&over(&self.top, a, b), &over(&self.below, a, b));
            let (lo, hi) = in_parts(a, b, &part).unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            return Hull::boxed([a, b, lo, hi]);
        };
        let boxed = Hull::boxed([a, b, lo, hi]);
        let slope = ((p[3].v / q[3].v) - (p[0].v / q[0].v)) / (b - a);
        if !slope.is_finite() {
            return boxed;
        }
        // N − slope·u·Q over Q is a cubic over a cubic too.
        let s = Approx::exact(slope);
        let mut rest = self.top;
        for i in 0..3 {
            rest[i + 1] = rest[i + 1] - s * self.below[i];
        }
        match quotients(&over(&rest, a, b), &q) {
            Some((low, high)) => Hull {
                slope,
                low,
                high,
                ..boxed
            },
            None => boxed,
        }
    }
}

impl Chart {
    fn blow_up(&self, k: &Kernel, c: CurveId) -> BlownUp {
        let (top, below) = k.blown_up(c, self.reference, &self.at, self.core);
        BlownUp { top, below }
    }
}

/// The least interval around the quotients of cubics' coefficients; None where a divisor may vanish.
fn quotients(p: &[Approx; 5], q: &[Approx; 5]) -> Option<(f64, f64)> {
    let sign = q[0].sign().filter(|&s| s != 0)?;
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for (p, q) in p.iter().zip(q).take(4) {
        let t = p.over(*q);
        if q.sign() != Some(sign) || !(t.v.is_finite() && t.e.is_finite()) {
            return None;
        }
        (lo, hi) = (lo.min(t.lo()), hi.max(t.hi()));
    }
    Some((lo, hi))
}

impl Pencil {
    /// Where all members meet, and how often at least.
    pub(super) fn known(&self) -> &[(NumId, usize)] {
        &self.chart.at
    }

    /// How many of the members pass near one another somewhere in [a, b], so that nothing is to be asked of the
    /// pencil there.
    pub(super) fn crowd_in(&self, a: f64, b: f64) -> Option<usize> {
        let core = self.chart.core?;
        let (from, to) = core.range();
        // One rounding further out.
        (from.next_down() <= b && a <= to.next_up()).then_some(self.count)
    }

    /// The part of the axis just outside of which something may be asked again.
    pub(super) fn crowded(&self) -> Option<(f64, f64)> {
        Some(self.chart.core?.crowded())
    }

    /// Calls `found` with the members that may meet a curve over [a, b] beside the point.
    pub(super) fn query(
        &self,
        k: &Kernel,
        c: CurveId,
        (a, b): (f64, f64),
        found: impl FnMut(u32) -> bool,
    ) {
        self.tree.query(&self.chart.blow_up(k, c).hull(a, b), found);
    }
}

impl Tracer<'_> {
    /// Keeps in mind that many items pass through a vertex that knows all its arcs: pairs of them need not be
    /// asked again what they do there, and most of them become a pencil.
    pub(super) fn remember(&mut self, v: u32) {
        let x = self.vertices[v as usize].at.x;
        self.k.exact(x);
        let mut through = Vec::new();
        self.each_link(v, |item| through.push(item));
        for &item in &through {
            self.busy.entry(item).or_default().push(v);
        }
        // Those that are in one pencil already, or in none.
        let mut by_pencil: Vec<(u32, u32)> = through
            .iter()
            .filter(|&&i| matches!(self.items[i as usize].carrier, Carrier::Graph(_)))
            .map(|&i| (self.pencil_of[i as usize], i))
            .collect();
        by_pencil.sort_unstable();
        let class = by_pencil
            .chunk_by(|a, b| a.0 == b.0)
            .max_by_key(|c| c.len());
        if let Some(class) = class
            && 2 * class.len() > through.len()
        {
            let old = class[0].0;
            let members: Vec<u32> = class.iter().map(|m| m.1).collect();
            self.gather_pencil(x, old, members);
        }
    }

    /// Makes a pencil of items through the point over x, all of one pencil `old` or of none.
    fn gather_pencil(&mut self, x: NumId, old: u32, mut members: Vec<u32>) {
        let curve = |item: u32| match self.items[item as usize].carrier {
            Carrier::Graph(c) => c,
            Carrier::Vertical(..) => unreachable!("pencils hold graphs"),
        };
        let mut chart = match self.pencils.get(old as usize) {
            Some(p) => p.chart.clone(),
            None => Chart {
                // By slope, the middle one: if most of them touch, it is one of those.
                reference: {
                    let mut slopes: Vec<(f64, CurveId)> = members
                        .iter()
                        .map(|&i| (self.k.slope(curve(i), x).v, curve(i)))
                        .collect();
                    let middle = slopes.len() / 2;
                    slopes
                        .select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0))
                        .1
                        .1
                },
                at: Vec::new(),
                core: None,
            },
        };
        let used = chart.at.iter().map(|a| a.1).sum::<usize>() + usize::from(chart.core.is_some());
        let orders: Vec<usize> = members
            .iter()
            .map(|&i| self.k.contact(curve(i), chart.reference, x))
            .collect();
        // As often as half of them allow.
        let order = (1..=4 - used.min(4))
            .rev()
            .find(|&m| 2 * orders.iter().filter(|&&o| o >= m).count() > members.len());
        let Some(order) = order else {
            return;
        };
        let close: Vec<u32> = members
            .iter()
            .zip(&orders)
            .filter(|m| *m.1 >= order)
            .map(|m| *m.0)
            .collect();
        let mut parent = old;
        if order > 1 && members.len() - close.len() > FEW {
            // The others cross those that touch.
            let mut around = chart.clone();
            around.at.push((x, 1));
            members.retain({
                let mut orders = orders.iter();
                move |_| orders.next().is_some_and(|&o| o >= 1)
            });
            parent = self.add_pencil(around, &members, parent);
        }
        chart.at.push((x, order));
        self.add_pencil(chart, &close, parent);
    }

    /// Makes a pencil of items that pass near one another near `middle`, in a window too small to be halved.
    pub(super) fn gather_cluster(&mut self, item: u32, middle: NumId, window: f64, near: &[u32]) {
        let Carrier::Graph(reference) = self.items[item as usize].carrier else {
            return;
        };
        let core = Core {
            middle: self.k.enclosure(middle).0,
            half: window,
        };
        let mut members: Vec<u32> = near.to_vec();
        members.push(item);
        members.retain(|&i| {
            matches!(self.items[i as usize].carrier, Carrier::Graph(_))
                && self.pencil_of[i as usize] == NONE
        });
        let chart = Chart {
            reference,
            at: Vec::new(),
            core: Some(core),
        };
        let id = self.add_pencil(chart, &members, NONE);
        let cluster = Cluster::new(self.k, self.items, core, middle, members);
        self.pencils[id as usize].cluster = Some(cluster);
    }

    /// Makes a pencil of members of another one, or of items that are in none.
    fn add_pencil(&mut self, chart: Chart, members: &[u32], parent: u32) -> u32 {
        let id = self.pencils.len() as u32;
        // One all of whose members left it is not asked again.
        let parent = match self.pencils.get(parent as usize) {
            Some(p) if p.count == members.len() => p.parent,
            _ => parent,
        };
        let root = self
            .pencils
            .get(parent as usize)
            .map_or(id, |parent| parent.root);
        let mut entries = Vec::with_capacity(PIECES * members.len());
        let mut straight = true;
        for &item in members {
            let Item { carrier, l, r, .. } = self.items[item as usize];
            let Carrier::Graph(c) = carrier else {
                continue;
            };
            self.pencil_of[item as usize] = id;
            let (a, b) = (self.k.enclosure(l).0, self.k.enclosure(r).1);
            let blown_up = chart.blow_up(self.k, c);
            straight &= blown_up.straight();
            let cut = (b - a).is_finite() && !blown_up.straight();
            let pieces = if cut { PIECES } else { 1 };
            let mut from = a;
            for p in 1..=pieces {
                let to = if p == pieces {
                    b
                } else {
                    (a + (b - a) * (p as f64 / pieces as f64)).clamp(from, b)
                };
                entries.push((blown_up.hull(from, to), item));
                from = to;
            }
        }
        let rest = (root == id && LARGE * members.len() >= self.items.len()).then(|| {
            let tree = &self.tree;
            let others = (0..tree.entries())
                .map(|at| (*tree.hull(at), tree.entry(at)))
                .filter(|e| self.pencil_of[e.1 as usize] != id);
            Tree::new(others.collect())
        });
        self.pencils.push(Pencil {
            chart,
            parent,
            root,
            tree: Tree::new(entries),
            count: members.len(),
            straight,
            cluster: None,
            rest,
        });
        id
    }

    /// The innermost pencil that holds both items.
    pub(super) fn common_pencil(&self, a: u32, b: u32) -> u32 {
        let (mut p, mut q) = (self.pencil_of[a as usize], self.pencil_of[b as usize]);
        while p != q && p != NONE && q != NONE {
            // What is within another was made later.
            let inner = if p > q { &mut p } else { &mut q };
            *inner = self.pencils[*inner as usize].parent;
        }
        if p == q { p } else { NONE }
    }

    /// Whether an item is in a pencil.
    pub(super) fn in_pencil(&self, item: u32, pencil: u32) -> bool {
        let mut p = self.pencil_of[item as usize];
        while p != NONE && p > pencil {
            p = self.pencils[p as usize].parent;
        }
        p == pencil
    }

    /// The pencil of an item.
    pub(super) fn pencil(&self, item: u32) -> Option<(u32, &Pencil)> {
        let p = self.pencil_of[item as usize];
        (p != NONE).then(|| (p, &self.pencils[p as usize]))
    }
}

/// More than so many that cross where others touch are told from those by a pencil around them.
const FEW: usize = 16;

/// A pencil of at least one in so many items has an index of the others.
const LARGE: usize = 4;
