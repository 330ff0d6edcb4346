//! The face of a cylinder that is cut open, by divide and conquer.
//!
//! The idea is that of `merge.rs` with one thing more: the strip has a frame that is no part of any half. Its two
//! cut lines are one line of the cylinder and no barrier at all; its lower and upper border bound everything. So
//! a half's face is traced with the frame, glued along the cut as in `boundary.rs`, and then kept *without* it:
//! the edges of arcs alone. That is enough. Let R be the face of the red arcs that holds the start z on the
//! framed cylinder: R is connected and no arc enters it, so it is also the face of z among its own
//! edges; and the face of z among the edges of R and B is that of R ∩ B, as in the plane. The cut
//! may only be walked along between places where something ends on it, so each node puts it in afresh, cut at the
//! ends of its own edges; hidden arcs leave no stops behind.
//!
//! Two things are lost on the way and found again at the end: which arcs pass through a vertex of the boundary
//! though they are hidden behind others, and which of overlapping arcs is the first. An index over all arcs
//! answers the former; the latter follows from it. So the outcome is that of the walk, name by name.

use super::boundary::{Boundary, BoundaryEdge, Glue};
use super::kernel::{CurveId, Kernel, NumId};
use super::merge::arcs_alone;
use super::trace::{Carrier, Comp, Item, NONE, OnArc, Point, Tracer, hull_of};
use crate::geometry::index::{EMPTY, Hull, arrange};
use crate::number::Rat;
use std::cmp::Ordering;
use std::collections::HashMap;

/// A strip's items, in this order: the graphs of arcs, two graphs that are its lower and upper border, the uprights of
/// arcs, and the uprights of the cut, left and right in turn.
pub(super) struct Strip<'a> {
    pub(super) items: &'a [Item],
    /// How many graphs are arcs'; the borders follow.
    pub(super) graphs: usize,
    /// How many uprights are arcs'; the cut follows.
    pub(super) uprights: usize,
    /// Uprights (counted from the first) that go with the one before them: a level's other side on the cut.
    pub(super) second: &'a [bool],
    /// Where the cut's two lines are.
    pub(super) cut: [NumId; 2],
}

/// Faces a merge, as in the plane.
const WAYS: usize = 16;

/// Arcs that are walked alone to see how the others are best dealt; and from how many on that is done.
const SAMPLE: usize = 2048;
const SAMPLED: usize = 8 * SAMPLE;

/// A fixed seed, so that every run is the same.
const SEED: u64 = 0x5eed_5eed_5eed_5eed;

/// A half's face: edges of arcs, their ends and their connected pieces.
#[derive(Default)]
struct Part {
    items: Vec<Item>,
    points: Vec<Point>,
    comps: Vec<Comp>,
}

impl Strip<'_> {
    fn is_arc(&self, item: u32) -> bool {
        let i = item as usize;
        i < self.graphs || (self.graphs + 2..self.graphs + 2 + self.uprights).contains(&i)
    }
    fn borders(&self) -> &[Item] {
        &self.items[self.graphs..self.graphs + 2]
    }
    fn seams(&self) -> usize {
        self.graphs + 2 + self.uprights
    }
    /// The arcs as what must stay together: one item, or a level's two sides on the cut.
    fn units(&self) -> Vec<(u32, u32)> {
        let first = self.graphs + 2;
        let mut out: Vec<(u32, u32)> = (0..self.graphs as u32).map(|i| (i, 1)).collect();
        for u in 0..self.uprights {
            match out.last_mut() {
                Some(last) if self.second[u] => last.1 += 1,
                _ => out.push(((first + u) as u32, 1)),
            }
        }
        out
    }
}

/// The face of the start on the cylinder by merges, from leaves of at most `most` arcs, with what it bounds
/// named as by the walk. Counts the merges made.
pub(super) fn conquered(
    mut k: Kernel,
    strip: &Strip<'_>,
    glue: &[Glue],
    start: Point,
    most: usize,
    merges: &mut u64,
) -> Result<Boundary, OnArc> {
    let most = most.max(1);
    let mut units = strip.units();
    shuffle(&mut units);
    if units.len() >= SAMPLED {
        let sample = leaf(&mut k, strip, &units[..SAMPLE], start)?;
        let mut seen: Vec<u32> = sample.items.iter().map(|i| i.arc).collect();
        seen.sort_unstable();
        seen.dedup();
        if 2 * seen.len() >= SAMPLE {
            // Nearly all arcs bound the face: what is near each other goes to one leaf.
            let mut order: Vec<(Hull, u32)> = units
                .iter()
                .zip(0..)
                .map(|(u, i)| (hull_of(&k, &strip.items[u.0 as usize]), i))
                .collect();
            arrange(&mut order);
            units = order.iter().map(|&(_, i)| units[i as usize]).collect();
        }
    }
    let parts = if units.len() <= most {
        vec![leaf(&mut k, strip, &units, start)?]
    } else {
        divide(&mut k, strip, &units, start, most, merges)?
    };
    *merges += 1;
    finish(k, strip, glue, parts, start)
}

fn shuffle(units: &mut [(u32, u32)]) {
    let mut seed = SEED;
    for i in (1..units.len()).rev() {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        units.swap(i, ((seed >> 32) as usize) % (i + 1));
    }
}

/// The faces of the parts that one merge takes.
fn divide(
    k: &mut Kernel,
    strip: &Strip<'_>,
    units: &[(u32, u32)],
    start: Point,
    most: usize,
    merges: &mut u64,
) -> Result<Vec<Part>, OnArc> {
    let ways = units.len().div_ceil(most).min(WAYS);
    units
        .chunks(units.len().div_ceil(ways))
        .map(|u| conquer(k, strip, u, start, most, merges))
        .collect()
}

fn conquer(
    k: &mut Kernel,
    strip: &Strip<'_>,
    units: &[(u32, u32)],
    start: Point,
    most: usize,
    merges: &mut u64,
) -> Result<Part, OnArc> {
    if units.len() <= most {
        return leaf(k, strip, units, start);
    }
    let parts = divide(k, strip, units, start, most, merges)?;
    *merges += 1;
    let mut all = together(parts);
    let seams = frame(k, strip, &mut all);
    let mut t = traced(k, &mut all, &seams, start)?;
    Ok(extract(&mut t, strip))
}

/// The face of arcs that know nothing of each other.
fn leaf(
    k: &mut Kernel,
    strip: &Strip<'_>,
    units: &[(u32, u32)],
    start: Point,
) -> Result<Part, OnArc> {
    let arcs: Vec<Item> = units
        .iter()
        .flat_map(|&(first, n)| first..first + n)
        .map(|i| strip.items[i as usize])
        .collect();
    let (items, comps, points) = arcs_alone(&arcs);
    let mut all = Part {
        items,
        points,
        comps,
    };
    let seams = frame(k, strip, &mut all);
    let mut t = traced(k, &mut all, &seams, start)?;
    Ok(extract(&mut t, strip))
}

/// Several faces' edges, each face a colour.
fn together(parts: Vec<Part>) -> Part {
    let mut all = Part::default();
    for (i, part) in parts.into_iter().enumerate() {
        let (v, c, n) = (
            all.points.len() as u32,
            all.comps.len() as u32,
            all.items.len() as u32,
        );
        all.items.extend(part.items.into_iter().map(|item| Item {
            vl: item.vl + v,
            vr: item.vr + v,
            comp: item.comp + c,
            color: i as u8 + 1,
            ..item
        }));
        all.comps.extend(part.comps.into_iter().map(|b| Comp {
            vertex: b.vertex + v,
            item: b.item + n,
        }));
        all.points.extend(part.points);
    }
    all
}

/// Adds items that know nothing of the others.
fn add(all: &mut Part, arcs: &[Item]) {
    let (v, c, n) = (
        all.points.len() as u32,
        all.comps.len() as u32,
        all.items.len() as u32,
    );
    let (items, comps, points) = arcs_alone(arcs);
    all.items.extend(items.into_iter().map(|item| Item {
        vl: item.vl + v,
        vr: item.vr + v,
        comp: item.comp + c,
        ..item
    }));
    all.comps.extend(comps.into_iter().map(|b| Comp {
        vertex: b.vertex + v,
        item: b.item + n,
    }));
    all.points.extend(points);
}

/// Adds the frame: the borders, and the cut between the places where an item ends on it. Returns the items of the
/// cut with their partners, and whether the face beyond the partner is walked upwards along it.
fn frame(k: &mut Kernel, strip: &Strip<'_>, all: &mut Part) -> HashMap<u32, (u32, bool)> {
    let mut stops: Vec<Rat> = Vec::new();
    let ends = strip.cut.map(|c| k.enclosure(c));
    let exact = strip.cut.map(|c| k.exact(c).to_rat().unwrap_or_default());
    let height = |k: &Kernel, c: CurveId, x: &Rat| {
        let (p, q) = k.polys(c);
        p.eval(x) / q.eval(x)
    };
    for at in &all.points {
        let (lo, hi) = k.enclosure(at.x);
        for i in 0..2 {
            if lo <= ends[i].1 && ends[i].0 <= hi && k.cmp(at.x, strip.cut[i]).is_eq() {
                stops.push(height(k, at.c, &exact[i]));
            }
        }
    }
    let window = [0, 1].map(|i| match strip.borders()[i].carrier {
        Carrier::Graph(c) => height(k, c, &exact[0]),
        Carrier::Vertical(..) => unreachable!("the borders are graphs"),
    });
    stops.retain(|t| *t > window[0] && *t < window[1]);
    stops.extend(window);
    stops.sort();
    stops.dedup();
    add(all, strip.borders());
    let first = all.items.len() as u32;
    let heights: Vec<CurveId> = stops.iter().map(|t| k.constant(t)).collect();
    let mut seams = HashMap::new();
    let mut cut = Vec::new();
    for w in heights.windows(2) {
        let n = first + cut.len() as u32;
        // Beyond the left border the strip goes on to the left of its right border, and vice versa.
        seams.insert(n, (n + 1, true));
        seams.insert(n + 1, (n, false));
        cut.extend(strip.cut.map(|x| Item {
            carrier: Carrier::Vertical(w[0], w[1]),
            l: x,
            r: x,
            vl: NONE,
            vr: NONE,
            color: 0,
            comp: 0,
            arc: NONE,
            bounds: EMPTY,
        }));
    }
    add(all, &cut);
    seams
}

/// The boundary of the start's face with all that is glued to it.
fn traced<'a>(
    k: &'a mut Kernel,
    all: &'a mut Part,
    seams: &HashMap<u32, (u32, bool)>,
    start: Point,
) -> Result<Tracer<'a>, OnArc> {
    let ends = std::mem::take(&mut all.points);
    let mut t = Tracer::new(k, &mut all.items, &all.comps, ends.into_iter());
    t.outline(start)?;
    let mut at = 0;
    while at < t.edges.len() {
        if let Some(&(other, up)) = seams.get(&t.edges[at].item) {
            t.border(other, up);
        }
        at += 1;
    }
    t.islands();
    Ok(t)
}

/// The edges of arcs with their vertices numbered afresh, in connected pieces.
fn extract(t: &mut Tracer<'_>, strip: &Strip<'_>) -> Part {
    let mut number = vec![NONE; t.vertices.len()];
    let mut part = Part::default();
    for e in 0..t.edges.len() {
        let edge = t.edges[e];
        let item = t.items[edge.item as usize];
        if item.arc == NONE || !strip.is_arc(item.arc) {
            continue;
        }
        let ends = [edge.low, edge.high].map(|v| {
            let n = &mut number[v as usize];
            if *n == NONE {
                *n = part.points.len() as u32;
                part.points.push(t.vertices[v as usize].at);
            }
            *n
        });
        let [low, high] = ends.map(|v| part.points[v as usize]);
        let carrier = match item.carrier {
            Carrier::Graph(c) => Carrier::Graph(c),
            Carrier::Vertical(..) => Carrier::Vertical(low.c, high.c),
        };
        let uncut = item.l == low.x && item.r == high.x && carrier == item.carrier;
        part.items.push(Item {
            carrier,
            l: low.x,
            r: high.x,
            vl: ends[0],
            vr: ends[1],
            color: 0,
            comp: NONE,
            arc: item.arc,
            bounds: if uncut { item.bounds } else { EMPTY },
        });
    }
    pieces(t, &mut part);
    part
}

/// Finds the connected pieces of the edges and where each begins.
fn pieces(t: &mut Tracer<'_>, part: &mut Part) {
    let mut parent: Vec<u32> = (0..part.points.len() as u32).collect();
    fn root(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    for item in &part.items {
        let (a, b) = (root(&mut parent, item.vl), root(&mut parent, item.vr));
        parent[a as usize] = b;
    }
    let mut comp_of = vec![NONE; part.points.len()];
    for i in 0..part.items.len() {
        let v = part.items[i].vl;
        let r = root(&mut parent, v) as usize;
        if comp_of[r] == NONE {
            comp_of[r] = part.comps.len() as u32;
            part.comps.push(Comp {
                vertex: v,
                item: i as u32,
            });
        }
        part.items[i].comp = comp_of[r];
        let comp = &mut part.comps[comp_of[r] as usize];
        if comp.vertex != v {
            let (p, q) = (part.points[v as usize], part.points[comp.vertex as usize]);
            if t.cmp_points(p, q).is_lt() {
                *comp = Comp {
                    vertex: v,
                    item: i as u32,
                };
            }
        }
    }
}

/// The last merge, with the strip's own frame, and everything by its name.
fn finish(
    mut k: Kernel,
    strip: &Strip<'_>,
    glue: &[Glue],
    parts: Vec<Part>,
    start: Point,
) -> Result<Boundary, OnArc> {
    let mut all = together(parts);
    let beyond = touching_from_beyond(&mut k, strip);
    add(&mut all, &beyond);
    add(&mut all, strip.borders());
    let first = all.items.len() as u32;
    let seam = |u: usize| first + (u - strip.uprights) as u32;
    let mut seams = HashMap::new();
    for &(left, right) in glue {
        seams.insert(seam(left), (seam(right), true));
        seams.insert(seam(right), (seam(left), false));
    }
    add(&mut all, &strip.items[strip.seams()..]);
    let mut t = traced(&mut k, &mut all, &seams, start)?;
    // What the last walk knows, numbered in the order of the walk.
    let mut number = vec![NONE; t.vertices.len()];
    let (mut vertices, mut known, mut edges) = (Vec::new(), Vec::new(), Vec::new());
    for e in &t.edges {
        let ends = [e.low, e.high].map(|v| {
            let id = &mut number[v as usize];
            if *id == NONE {
                *id = vertices.len() as u32;
                let at = t.vertices[v as usize].at;
                vertices.push((at.x, at.c));
                let mut links = Vec::new();
                t.each_link(v, |item| links.push(t.items[item as usize].arc));
                known.push(links);
            }
            *id
        });
        edges.push(BoundaryEdge {
            item: t.items[e.item as usize].arc,
            ends,
            sides: [e.above, e.below],
        });
    }
    let order = std::mem::take(&mut t.order);
    let mut cycles = vec![0];
    for c in &t.cycles {
        cycles.push(cycles[cycles.len() - 1] + c.half_edges);
    }
    drop(t);
    let (links, link_starts) = all_links(&mut k, strip, &vertices, known);
    for e in &mut edges {
        let at =
            |v: u32| &links[link_starts[v as usize] as usize..link_starts[v as usize + 1] as usize];
        let carrier = |i: u32| strip.items[i as usize].carrier;
        let along = |i: u32| match (carrier(e.item), carrier(i)) {
            (Carrier::Graph(c), Carrier::Graph(d)) => c == d,
            (Carrier::Vertical(..), Carrier::Vertical(..)) => true,
            _ => false,
        };
        let other = at(e.ends[1]);
        let least = at(e.ends[0])
            .iter()
            .copied()
            .find(|&i| along(i) && other.binary_search(&i).is_ok());
        debug_assert!(least.is_some(), "an edge's arc passes through its ends");
        e.item = least.unwrap_or(e.item);
    }
    let curves = strip
        .items
        .iter()
        .map(|i| match i.carrier {
            Carrier::Graph(c) => Some(c),
            Carrier::Vertical(..) => None,
        })
        .collect();
    Ok(Boundary {
        kernel: k,
        vertices,
        links,
        link_starts,
        edges,
        curves,
        order,
        cycles,
    })
}

/// The arcs beyond a border that end on it. No face that a half has found is bounded by them, but they are stops of
/// the border: what begins at the last instant touches there. (An arc is monotone, so it touches in an end.)
fn touching_from_beyond(k: &mut Kernel, strip: &Strip<'_>) -> Vec<Item> {
    let borders = [0, 1].map(|i| match strip.borders()[i].carrier {
        Carrier::Graph(c) => c,
        Carrier::Vertical(..) => unreachable!("the borders are graphs"),
    });
    let mut out = Vec::new();
    for (i, item) in strip.items.iter().enumerate() {
        if !strip.is_arc(i as u32) {
            continue;
        }
        let ends = match item.carrier {
            Carrier::Graph(c) => [(c, item.l), (c, item.r)],
            Carrier::Vertical(low, high) => [(low, item.l), (high, item.l)],
        };
        for (border, outward) in borders.into_iter().zip([Ordering::Less, Ordering::Greater]) {
            let meets = |k: &Kernel, (c, x): (CurveId, NumId)| {
                let (t, b) = (k.height(c, x), k.height(border, x));
                // Not a number: it may.
                !(t.hi() < b.lo() || b.hi() < t.lo())
            };
            if !ends.iter().any(|&e| meets(k, e)) {
                continue;
            }
            let [a, b] = ends.map(|(c, x)| k.cmp_at(c, border, x));
            if (a.is_eq() && b == outward) || (b.is_eq() && a == outward) {
                out.push(*item);
                break;
            }
        }
    }
    out
}

/// For each vertex all items through it, ascending, also those that no merge kept.
fn all_links(
    k: &mut Kernel,
    strip: &Strip<'_>,
    vertices: &[(NumId, CurveId)],
    known: Vec<Vec<u32>>,
) -> (Vec<u32>, Vec<u32>) {
    let (mut items, comps, ends) = arcs_alone(strip.items);
    let mut t = Tracer::new(k, &mut items, &comps, ends.into_iter());
    let tree = std::mem::take(&mut t.tree);
    drop(t);
    let (mut links, mut starts) = (Vec::new(), vec![0]);
    let mut near = Vec::new();
    for (&(x, c), known) in vertices.iter().zip(known) {
        let (xs, ts) = (k.enclosure(x), k.height(c, x));
        let ts = if ts.lo().is_nan() || ts.hi().is_nan() {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else {
            [ts.lo(), ts.hi()]
        };
        near.clear();
        tree.query(&Hull::boxed([xs.0, xs.1, ts[0], ts[1]]), |i| {
            near.push(i);
            true
        });
        near.sort_unstable();
        near.dedup();
        near.retain(|i| known.contains(i) || passes(k, &strip.items[*i as usize], x, c));
        links.extend_from_slice(&near);
        starts.push(links.len() as u32);
    }
    (links, starts)
}

/// Whether an item passes through the point of a curve over a number.
fn passes(k: &mut Kernel, item: &Item, x: NumId, c: CurveId) -> bool {
    let (low, high) = match item.carrier {
        Carrier::Graph(d) => (d, d),
        Carrier::Vertical(a, b) => (a, b),
    };
    if k.cmp(item.l, x).is_gt() || k.cmp(x, item.r).is_gt() {
        return false;
    }
    k.cmp_at(low, c, x).is_le() && k.cmp_at(high, c, x).is_ge()
}
