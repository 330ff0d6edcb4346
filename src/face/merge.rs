//! One face by divide and conquer: the face of each half, and of the two the part that holds the start.
//!
//! The idea (Guibas, Sharir & Sifrony 1988; Donald & Pai, Lemma 9.2): the face R of the red arcs and the face
//! B of the blue ones that hold the start z. The face of all arcs is the component of R ∩ B that
//! holds z, and it is also the face of z among the *edges* of ∂R and ∂B alone, because R, connected and
//! clear of ∂R, is the face of z in the arrangement of ∂R. So the merge is again a walk, on
//! edges instead of arcs, and hidden arcs are never seen again. It follows the component of z only:
//! no other component of R ∩ B is touched, though there may be quadratically many crossings in all. Nothing in
//! the argument is special to two faces; sixteen at a time make a quarter of the levels.
//!
//! Edges stay cut at every vertex, also where an arc ends on them from outside. Nothing more is needed for
//! the count of the whole arrangement: let p be a point of the final face's boundary where arcs meet. The arcs
//! of one half through p bound that half's face there (p lies in its closure), so p is a vertex of R
//! or of B, or one edge of each passes through it and the walk finds the crossing.

use super::kernel::Kernel;
use super::trace::{Carrier, Comp, Dir, Item, NONE, OnArc, Point, Tracer, hull_of};
use crate::geometry::index::{EMPTY, Hull, arrange};

/// The boundary of one face: its edges by their vertices, cut at every vertex of the arrangement.
#[derive(Default)]
pub(crate) struct Face {
    /// The edges; their ends name `points`, their components `comps`.
    pub(crate) items: Vec<Item>,
    /// On which sides of each edge the face lies: above, below.
    pub(crate) sides: Vec<[bool; 2]>,
    pub(crate) points: Vec<Point>,
    /// The boundary cycles: where each begins.
    pub(crate) comps: Vec<Comp>,
    pub(crate) half_edges: u64,
    pub(crate) unbounded: bool,
}

/// The face of arcs that know nothing of each other, by walking.
pub(crate) fn walk(k: &mut Kernel, arcs: &[Item], start: Point) -> Result<Face, OnArc> {
    let face = walk_within(k, arcs, start, u64::MAX)?;
    Ok(face.expect("no walk makes so many tests"))
}

/// The same, given up (None) once it has tested more than `budget` pairs for a meeting.
pub(crate) fn walk_within(
    k: &mut Kernel,
    arcs: &[Item],
    start: Point,
    budget: u64,
) -> Result<Option<Face>, OnArc> {
    let (mut items, comps, ends) = arcs_alone(arcs);
    trace(k, &mut items, &comps, ends, start, budget)
}

/// Arcs as items to walk on: each with ends and a component of its own.
pub(super) fn arcs_alone(arcs: &[Item]) -> (Vec<Item>, Vec<Comp>, Vec<Point>) {
    let mut items = Vec::with_capacity(arcs.len());
    let mut comps = Vec::with_capacity(arcs.len());
    let mut ends = Vec::with_capacity(2 * arcs.len());
    for (i, arc) in arcs.iter().enumerate() {
        let v = ends.len() as u32;
        let (low, high) = match arc.carrier {
            Carrier::Graph(c) => (c, c),
            Carrier::Vertical(a, b) => (a, b),
        };
        ends.push(Point { x: arc.l, c: low });
        ends.push(Point { x: arc.r, c: high });
        items.push(Item {
            vl: v,
            vr: v + 1,
            color: 0,
            comp: i as u32,
            ..*arc
        });
        comps.push(Comp {
            vertex: v,
            item: i as u32,
        });
    }
    (items, comps, ends)
}

/// The face of several faces' edges, each face a colour.
fn merge(k: &mut Kernel, faces: Vec<Face>, start: Point) -> Result<Face, OnArc> {
    let (mut items, mut comps, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for (i, face) in faces.into_iter().enumerate() {
        let (v, c, n) = (points.len() as u32, comps.len() as u32, items.len() as u32);
        let color = i as u8 + 1;
        items.extend(face.items.into_iter().map(|i| Item {
            vl: i.vl + v,
            vr: i.vr + v,
            comp: i.comp + c,
            color,
            ..i
        }));
        comps.extend(face.comps.into_iter().map(|b| Comp {
            vertex: b.vertex + v,
            item: b.item + n,
        }));
        points.extend(face.points);
    }
    let face = trace(k, &mut items, &comps, points, start, u64::MAX)?;
    Ok(face.expect("no walk makes so many tests"))
}

fn trace(
    k: &mut Kernel,
    items: &mut [Item],
    comps: &[Comp],
    points: Vec<Point>,
    start: Point,
    budget: u64,
) -> Result<Option<Face>, OnArc> {
    let mut t = Tracer::new(k, items, comps, points.into_iter());
    t.budget = budget;
    t.outline(start)?;
    t.islands();
    if t.tests > t.budget {
        return Ok(None);
    }
    let face = extract(&mut t);
    #[cfg(debug_assertions)]
    {
        euler(&t);
        check(&face, t.k);
    }
    Ok(Some(face))
}

/// How many faces one merge takes: each level of the tree walks along all edges that are left, so fewer levels
/// are faster as long as few pairs of edges are near each other.
const WAYS: usize = 8;

/// A fixed seed, so that every run is the same.
const SEED: u64 = 0x5eed_5eed_5eed_5eed;

/// Arcs that are walked alone to see how the others are best dealt; and from how many on that is done.
const SAMPLE: usize = 2048;
const SAMPLED: usize = 8 * SAMPLE;

/// The face by merges, from leaves of `leaf` arcs. Counts the merges made.
///
/// Any balanced tree keeps the bound of Lemma 9.2. Dealt at random, every leaf sees all of the plane, so
/// what lies behind the boundary is dropped at once; but where nearly all arcs bound the face, nothing is, and arcs
/// near each other had better go to one leaf: what they do to each other is then settled early, in few
/// places of the memory. The face of a sample tells which it is.
pub(crate) fn divide(
    k: &mut Kernel,
    arcs: &[Item],
    start: Point,
    leaf: usize,
    merges: &mut u64,
) -> Result<Face, OnArc> {
    let mut dealt = arcs.to_vec();
    let mut seed = SEED;
    for i in (1..dealt.len()).rev() {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        dealt.swap(i, ((seed >> 32) as usize) % (i + 1));
    }
    if dealt.len() >= SAMPLED {
        let face = walk(k, &dealt[..SAMPLE], start)?;
        let mut seen: Vec<u32> = face.items.iter().map(|i| i.arc).collect();
        seen.sort_unstable();
        seen.dedup();
        if 2 * seen.len() >= SAMPLE {
            let mut order: Vec<(Hull, u32)> = arcs
                .iter()
                .zip(0..)
                .map(|(arc, i)| (hull_of(k, arc), i))
                .collect();
            arrange(&mut order);
            dealt.clear();
            dealt.extend(order.iter().map(|&(_, i)| arcs[i as usize]));
        }
    }
    conquer(k, &dealt, start, leaf.max(1), merges)
}

fn conquer(
    k: &mut Kernel,
    arcs: &[Item],
    start: Point,
    leaf: usize,
    merges: &mut u64,
) -> Result<Face, OnArc> {
    if arcs.len() <= leaf {
        return walk(k, arcs, start);
    }
    let ways = arcs.len().div_ceil(leaf).min(WAYS);
    let parts = arcs.chunks(arcs.len().div_ceil(ways));
    let faces = parts
        .map(|p| conquer(k, p, start, leaf, merges))
        .collect::<Result<_, _>>()?;
    *merges += 1;
    merge(k, faces, start)
}

/// The traced boundary with vertices numbered afresh.
fn extract(t: &mut Tracer<'_>) -> Face {
    let mut number = vec![NONE; t.vertices.len()];
    let mut face = Face {
        unbounded: t.unbounded,
        ..Face::default()
    };
    for e in 0..t.edges.len() {
        let edge = t.edges[e];
        for v in [edge.low, edge.high] {
            if number[v as usize] == NONE {
                number[v as usize] = face.points.len() as u32;
                face.points.push(t.vertices[v as usize].at);
            }
        }
        let item = t.items[edge.item as usize];
        let (low, high) = (
            t.vertices[edge.low as usize].at,
            t.vertices[edge.high as usize].at,
        );
        let carrier = match item.carrier {
            Carrier::Graph(c) => Carrier::Graph(c),
            Carrier::Vertical(..) => Carrier::Vertical(low.c, high.c),
        };
        face.items.push(Item {
            carrier,
            l: low.x,
            r: high.x,
            vl: number[edge.low as usize],
            vr: number[edge.high as usize],
            color: 0,
            comp: edge.cycle,
            arc: item.arc,
            // Uncut, it keeps its box.
            bounds: if item.l == low.x && item.r == high.x && carrier == item.carrier {
                item.bounds
            } else {
                EMPTY
            },
        });
        face.sides.push([edge.above, edge.below]);
    }
    for c in 0..t.cycles.len() {
        let cycle = t.cycles[c];
        face.half_edges += u64::from(cycle.half_edges);
        let (from, to) = t.germs_of(cycle.leftmost);
        let first = t.germs[from..to]
            .iter()
            .rev()
            .find(|g| {
                matches!(g.dir, Dir::Right | Dir::Up)
                    && g.edge != NONE
                    && t.edges[g.edge as usize].cycle == c as u32
            })
            .expect("a cycle begins with an edge to the right or up");
        face.comps.push(Comp {
            vertex: number[cycle.leftmost as usize],
            item: first.edge,
        });
    }
    face
}

/// Euler's relation of the boundary as a plane graph, V − E + F = 1 + C: the orbits of its half-edges, turned round
/// each vertex by the order of the germs, are 2C − V + E, as many as if every component were alone.
#[cfg(debug_assertions)]
fn euler(t: &Tracer<'_>) {
    let mut parent: Vec<u32> = (0..t.vertices.len() as u32).collect();
    fn find(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    let mut seen = vec![false; t.vertices.len()];
    for e in &t.edges {
        let (a, b) = (find(&mut parent, e.low), find(&mut parent, e.high));
        parent[a as usize] = b;
        (seen[e.low as usize], seen[e.high as usize]) = (true, true);
    }
    let vertices = seen.iter().filter(|&&s| s).count();
    let components = (0..t.vertices.len() as u32)
        .filter(|&v| seen[v as usize] && parent[v as usize] == v)
        .count();
    // The half-edge 2e goes to the high end.
    let mut walked = vec![false; 2 * t.edges.len()];
    let mut orbits = 0;
    for first in 0..walked.len() {
        let mut at = first;
        orbits += usize::from(!walked[first]);
        while !walked[at] {
            walked[at] = true;
            let edge = &t.edges[at / 2];
            let (w, back) = if at % 2 == 0 {
                (edge.high, edge.germs[1])
            } else {
                (edge.low, edge.germs[0])
            };
            let vertex = &t.vertices[w as usize];
            let (from, n) = (vertex.germs, vertex.germ_count);
            let turn = (1..=n)
                .map(|i| from + (back - from + n - i) % n)
                .find(|&g| t.germs[g as usize].edge != NONE)
                .expect("the germ itself has an edge");
            let germ = t.germs[turn as usize];
            at = 2 * germ.edge as usize + usize::from(!germ.dir.forward());
        }
    }
    assert_eq!(
        vertices + orbits,
        t.edges.len() + 2 * components,
        "Euler's relation"
    );
}

/// The invariants of a boundary: every edge joins its points in order and lies on them, bounds the face on
/// a side, and the half-edges of every vertex balance.
#[cfg(debug_assertions)]
fn check(face: &Face, k: &mut Kernel) {
    let mut balance = vec![0i64; face.points.len()];
    let mut sides = 0;
    for (item, s) in face.items.iter().zip(&face.sides) {
        let (p, q) = (face.points[item.vl as usize], face.points[item.vr as usize]);
        match item.carrier {
            Carrier::Graph(c) => {
                assert!(k.cmp(p.x, q.x).is_lt(), "an edge goes to the right");
                assert!(
                    k.cmp_at(c, p.c, p.x).is_eq() && k.cmp_at(c, q.c, q.x).is_eq(),
                    "an edge holds its ends"
                );
            }
            Carrier::Vertical(..) => {
                assert!(
                    k.cmp(p.x, q.x).is_eq() && k.cmp_at(p.c, q.c, p.x).is_lt(),
                    "a vertical goes up"
                );
            }
        }
        assert!(s[0] || s[1], "an edge bounds the face");
        for (side, turn) in [(s[0], 1), (s[1], -1)] {
            if side {
                balance[item.vl as usize] += turn;
                balance[item.vr as usize] -= turn;
                sides += 1;
            }
        }
    }
    assert_eq!(
        sides, face.half_edges,
        "every half-edge is the side of an edge"
    );
    assert!(balance.iter().all(|&b| b == 0), "cycles are closed");
}
