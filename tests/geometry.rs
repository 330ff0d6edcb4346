//! Geometry against slow ways that share nothing with it: regions as sets of unit cells, the
//! plane cut into vertical slabs, all pairs of edges by solving their equations.
#![allow(
    clippy::unwrap_used,
    reason = "a test that unwraps nothing fails, as it should"
)]

#[allow(unreachable_pub, reason = "a test file is a crate of its own")]
mod common;

use common::count;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use snapfit::geometry::{
    Box2, Corner, Defect, Location, MAX_DEFECTS, Meeting, Polygon, Vec2, boundary_relation, corner,
    defects, interiors_intersect, meet, orient,
};
use snapfit::number::Rat;

fn p(x: i64, y: i64) -> Vec2 {
    Vec2::new(Rat::from(x), Rat::from(y))
}

fn ring(points: &[(i64, i64)]) -> Vec<Vec2> {
    points.iter().map(|&(x, y)| p(x, y)).collect()
}

fn poly(points: &[(i64, i64)]) -> Polygon {
    Polygon::new(ring(points), Vec::new())
}

fn rect(x0: i64, y0: i64, x1: i64, y1: i64) -> Polygon {
    poly(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
}

fn runner(nominal: usize) -> TestRunner {
    TestRunner::new(Config {
        cases: count(nominal).max(50) as u32,
        failure_persistence: None,
        // Most random rings are no polygons; that is known and cheap.
        max_local_rejects: u32::MAX,
        ..Config::default()
    })
}

// ---- the slow ways ---------------------------------------------------------------------------

/// The interiors of two regions share a point iff in some slab between consecutive abscissae of
/// vertices and crossings the vertical sections overlap in a piece of positive length.
fn overlap_by_slabs(a: &Polygon, b: &Polygon) -> bool {
    let edges = |q: &Polygon| -> Vec<[Vec2; 2]> {
        q.rings()
            .iter()
            .flat_map(|r| (0..r.len()).map(|k| [r[k].clone(), r[(k + 1) % r.len()].clone()]))
            .collect()
    };
    let (ea, eb) = (edges(a), edges(b));
    let mut xs: Vec<Rat> = ea.iter().chain(&eb).map(|e| e[0].x.clone()).collect();
    for e in &ea {
        for f in &eb {
            if let Some(x) = crossing_abscissa(e, f) {
                xs.push(x);
            }
        }
    }
    xs.sort();
    xs.dedup();
    let sections = |edges: &[[Vec2; 2]], x: &Rat| -> Vec<Rat> {
        let mut ys: Vec<Rat> = edges
            .iter()
            .filter(|e| (&e[0].x < x) != (&e[1].x < x))
            .map(|e| {
                let t = (x - &e[0].x) / (&e[1].x - &e[0].x);
                &e[0].y + &t * (&e[1].y - &e[0].y)
            })
            .collect();
        ys.sort();
        ys
    };
    xs.windows(2).any(|pair| {
        let x = Rat::midpoint(&pair[0], &pair[1]);
        let (sa, sb) = (sections(&ea, &x), sections(&eb, &x));
        sa.chunks(2).any(|i| {
            sb.chunks(2)
                .any(|j| std::cmp::max(&i[0], &j[0]) < std::cmp::min(&i[1], &j[1]))
        })
    })
}

/// By Cramer's rule on the lines' equations.
fn crossing_abscissa(e: &[Vec2; 2], f: &[Vec2; 2]) -> Option<Rat> {
    let line = |e: &[Vec2; 2]| {
        let (a, b) = (&e[1].y - &e[0].y, &e[0].x - &e[1].x);
        let c = &a * &e[0].x + &b * &e[0].y;
        (a, b, c)
    };
    let ((a1, b1, c1), (a2, b2, c2)) = (line(e), line(f));
    let det = &a1 * &b2 - &a2 * &b1;
    (!det.is_zero()).then(|| (&c1 * &b2 - &c2 * &b1) / det)
}

/// Whether two closed segments share a point, by solving p + s d = q + t e.
fn segments_meet_by_solving(p: [&Vec2; 2], q: [&Vec2; 2]) -> bool {
    let (d, e, w) = (p[1] - p[0], q[1] - q[0], q[0] - p[0]);
    let det = d.cross(&e);
    let unit = |r: &Rat| r.sign() >= 0 && *r <= Rat::one();
    if !det.is_zero() {
        return unit(&(w.cross(&e) / &det)) && unit(&(w.cross(&d) / &det));
    }
    if !w.cross(&d).is_zero() {
        return false;
    }
    let along = |v: &Vec2| v.dot(&d) / d.norm2();
    let (s, t) = (along(&w), along(&(q[1] - p[0])));
    let (lo, hi) = if s < t { (s, t) } else { (t, s) };
    lo <= Rat::one() && hi.sign() >= 0
}

/// Whether a ring is simple, by all pairs of edges.
fn simple_by_pairs(ring: &[Vec2]) -> bool {
    let n = ring.len();
    let edge = |k: usize| [&ring[k % n], &ring[(k + 1) % n]];
    if n < 3 || (0..n).any(|k| ring[k] == ring[(k + 1) % n]) {
        return false;
    }
    for i in 0..n {
        for j in i + 1..n {
            let next = j == i + 1 || (i == 0 && j == n - 1);
            if !next {
                if segments_meet_by_solving(edge(i), edge(j)) {
                    return false;
                }
                continue;
            }
            // The far end of either edge must not lie on the other.
            let (a, b) = if j == i + 1 {
                (edge(i), edge(j))
            } else {
                (edge(j), edge(i))
            };
            let on = |v: &Vec2, e: [&Vec2; 2]| {
                (e[1] - e[0]).cross(&(v - e[0])).is_zero()
                    && (v - e[0]).dot(&(v - e[1])).sign() <= 0
            };
            if on(b[1], a) || on(a[0], b) {
                return false;
            }
        }
    }
    true
}

// ---- regions as sets of cells ----------------------------------------------------------------

const SIDE: usize = 5;

/// A region of unit cells, with its boundary traced into rings; None where the cells have no
/// proper polygon (several pieces, or a ring that touches itself).
#[derive(Clone, Debug)]
struct Cells {
    filled: Vec<bool>,
    polygon: Polygon,
}

impl Cells {
    fn at(filled: &[bool], x: i64, y: i64) -> bool {
        let inside = |v: i64| (0..SIDE as i64).contains(&v);
        inside(x) && inside(y) && filled[y as usize * SIDE + x as usize]
    }

    fn new(filled: Vec<bool>) -> Option<Cells> {
        let at = |x, y| Cells::at(&filled, x, y);
        // Directed unit edges with the solid to the left.
        let mut edges: Vec<[(i64, i64); 2]> = Vec::new();
        for y in 0..SIDE as i64 {
            for x in 0..SIDE as i64 {
                if at(x, y) {
                    let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
                    let others = [(x, y - 1), (x + 1, y), (x, y + 1), (x - 1, y)];
                    for k in 0..4 {
                        if !at(others[k].0, others[k].1) {
                            edges.push([corners[k], corners[(k + 1) % 4]]);
                        }
                    }
                }
            }
        }
        let mut rings = Vec::new();
        while let Some(first) = edges.pop() {
            let mut points = vec![first[0]];
            let mut last = first;
            while last[1] != points[0] {
                // At a pinch the left turn stays with the same cell.
                let turn = |e: &[(i64, i64); 2]| {
                    let d = (last[1].0 - last[0].0, last[1].1 - last[0].1);
                    let f = (e[1].0 - e[0].0, e[1].1 - e[0].1);
                    d.0 * f.1 - d.1 * f.0
                };
                let (k, _) = edges
                    .iter()
                    .enumerate()
                    .filter(|(_, e)| e[0] == last[1])
                    .max_by_key(|(_, e)| turn(e))?;
                last = edges.swap_remove(k);
                points.push(last[0]);
            }
            rings.push(ring(&points));
        }
        let outer: Vec<usize> = (0..rings.len())
            .filter(|&k| Polygon::new(rings[k].clone(), vec![]).is_counter_clockwise(0))
            .collect();
        if outer.len() != 1 {
            return None;
        }
        let outer = rings.swap_remove(outer[0]);
        let polygon = Polygon::new(outer, rings);
        defects(&polygon)
            .is_empty()
            .then_some(Cells { filled, polygon })
    }

    /// Whether two regions overlap when the second is moved by half-cells.
    fn overlap(&self, other: &Cells, dx2: i64, dy2: i64) -> bool {
        let n = SIDE as i64;
        (0..n * n).any(|i| {
            let (x, y) = (i % n, i / n);
            Cells::at(&self.filled, x, y)
                && (0..n * n).any(|j| {
                    let (u, v) = (j % n, j / n);
                    Cells::at(&other.filled, u, v)
                        && (2 * x - (2 * u + dx2)).abs() < 2
                        && (2 * y - (2 * v + dy2)).abs() < 2
                })
        })
    }
}

fn cells() -> impl Strategy<Value = Cells> {
    prop::collection::vec(prop::bool::weighted(0.7), SIDE * SIDE)
        .prop_filter_map("no polygon", Cells::new)
}

/// A map of the plane that keeps what is inside what: turned, sheared, scaled, moved.
#[derive(Clone, Debug)]
struct Affine {
    shear: Rat,
    turn: Rat,
    scale: Rat,
    shift: Vec2,
    mirror: bool,
}

impl Affine {
    fn of(&self, v: &Vec2) -> Vec2 {
        let v = Vec2::new(&v.x + &self.shear * &v.y, v.y.clone());
        let v = v.rotate_tan_half(&self.turn).scale(&self.scale);
        let v = if self.mirror {
            Vec2::new(-&v.x, v.y)
        } else {
            v
        };
        &v + &self.shift
    }
    fn polygon(&self, q: &Polygon) -> Polygon {
        let mut rings: Vec<Vec<Vec2>> = q
            .rings()
            .iter()
            .map(|r| r.iter().map(|v| self.of(v)).collect())
            .collect();
        let outer = rings.remove(0);
        Polygon::new(outer, rings)
    }
}

fn affine() -> impl Strategy<Value = Affine> {
    let small = || (-9i64..=9, 1i64..=9).prop_map(|(n, d)| Rat::frac(n, d));
    // Near powers of ten that overflow and underflow doubles, and that lose their digits.
    let scale = prop_oneof![
        Just("1"),
        Just("1/3"),
        Just("1e30"),
        Just("1e-30"),
        Just("1e400"),
        Just("1e-400"),
        Just("1000000000000000001/1000000000000000000"),
    ]
    .prop_map(|s| snapfit::number::literal::parse(s).unwrap());
    let shift = prop_oneof![Just("0"), Just("1e20"), Just("1/7"), Just("-1e-20")]
        .prop_map(|s| snapfit::number::literal::parse(s).unwrap());
    (small(), small(), scale, shift.clone(), shift, any::<bool>()).prop_map(
        |(shear, turn, scale, x, y, mirror)| Affine {
            shear,
            turn,
            scale,
            shift: Vec2::new(x, y),
            mirror,
        },
    )
}

#[test]
fn overlap_agrees_with_cells() {
    let case = (cells(), cells(), -11i64..=11, -11i64..=11, affine());
    runner(20_000)
        .run(&case, |(a, b, dx, dy, map)| {
            let truth = a.overlap(&b, dx, dy);
            let moved = b
                .polygon
                .translated(&Vec2::new(Rat::frac(dx, 2), Rat::frac(dy, 2)));
            prop_assert_eq!(interiors_intersect(&a.polygon, &moved), truth);
            prop_assert_eq!(interiors_intersect(&moved, &a.polygon), truth);
            prop_assert_eq!(overlap_by_slabs(&a.polygon, &moved), truth);
            let (ma, mb) = (map.polygon(&a.polygon), map.polygon(&moved));
            prop_assert_eq!(interiors_intersect(&ma, &mb), truth, "mapped by {:?}", map);
            Ok(())
        })
        .unwrap();
}

#[test]
fn location_agrees_with_cells() {
    let case = (cells(), affine());
    runner(2_000)
        .run(&case, |(a, map)| {
            let mapped = map.polygon(&a.polygon);
            for y in -1..=2 * SIDE as i64 + 1 {
                for x in -1..=2 * SIDE as i64 + 1 {
                    // Half-integer points: a point is inside, outside or on the boundary as the
                    // cells round it are all, none or partly filled.
                    let touching = |v: i64| {
                        if v % 2 == 0 {
                            vec![v / 2 - 1, v / 2]
                        } else {
                            vec![v.div_euclid(2)]
                        }
                    };
                    let around: Vec<bool> = touching(y)
                        .into_iter()
                        .flat_map(|cy| touching(x).into_iter().map(move |cx| (cx, cy)))
                        .map(|(cx, cy)| Cells::at(&a.filled, cx, cy))
                        .collect();
                    let truth = if around.iter().all(|f| *f) {
                        Location::Inside
                    } else if around.iter().any(|f| *f) {
                        Location::Boundary
                    } else {
                        Location::Outside
                    };
                    let v = Vec2::new(Rat::frac(x, 2), Rat::frac(y, 2));
                    prop_assert_eq!(a.polygon.locate(&v), truth);
                    prop_assert_eq!(mapped.locate(&map.of(&v)), truth);
                }
            }
            Ok(())
        })
        .unwrap();
}

#[test]
fn area_and_corners_agree_with_cells() {
    runner(10_000)
        .run(&(cells(), affine()), |(a, map)| {
            let filled = a.filled.iter().filter(|f| **f).count() as i64;
            prop_assert_eq!(a.polygon.twice_area(), Rat::from(2 * filled));
            let mapped = map.polygon(&a.polygon);
            for r in 0..a.polygon.rings().len() {
                for q in [&a.polygon, &mapped] {
                    let area = q.twice_signed_area(r);
                    prop_assert_eq!(q.is_counter_clockwise(r), area.sign() > 0);
                }
            }
            let mut turns = 0;
            for (r, vertices) in a.polygon.rings().iter().enumerate() {
                for k in 0..vertices.len() {
                    prop_assert_eq!(a.polygon.corner(r, k), mapped.corner(r, k));
                    turns += match a.polygon.corner(r, k) {
                        Corner::Convex => 1,
                        Corner::Straight => 0,
                        Corner::Reflex => -1,
                    };
                }
            }
            // Four quarter turns round the outside, four back round every hole.
            prop_assert_eq!(turns, 4 - 4 * (a.polygon.rings().len() as i64 - 1));
            Ok(())
        })
        .unwrap();
}

// ---- general polygons ------------------------------------------------------------------------

/// Rings on a small grid: of few vertices, so that a good share of them are simple, and with
/// every kind of coincidence.
fn any_ring(max: usize) -> impl Strategy<Value = Vec<Vec2>> {
    prop::collection::vec((0i64..6, 0i64..6), 3..=max).prop_map(|points| ring(&points))
}

fn simple(max: usize) -> impl Strategy<Value = Polygon> {
    any_ring(max)
        .prop_map(|r| Polygon::new(r, vec![]))
        .prop_filter("not simple", |q| defects(q).is_empty())
}

#[test]
fn simplicity_agrees_with_all_pairs() {
    runner(100_000)
        .run(&any_ring(8), |r| {
            let found = defects(&Polygon::new(r.clone(), vec![]));
            prop_assert_eq!(found.is_empty(), simple_by_pairs(&r), "{:?}", found);
            prop_assert!(found.len() <= MAX_DEFECTS);
            if found.is_empty() {
                let q = Polygon::new(r, vec![]);
                prop_assert_eq!(q.is_counter_clockwise(0), q.twice_signed_area(0).sign() > 0);
            }
            Ok(())
        })
        .unwrap();
}

#[test]
fn overlap_agrees_with_slabs() {
    let case = (simple(6), simple(6), affine(), -8i64..=8, -8i64..=8);
    runner(40_000)
        .run(&case, |(a, b, map, dx, dy)| {
            let b = b.translated(&Vec2::new(Rat::frac(dx, 2), Rat::frac(dy, 3)));
            let truth = overlap_by_slabs(&a, &b);
            prop_assert_eq!(interiors_intersect(&a, &b), truth);
            prop_assert_eq!(interiors_intersect(&b, &a), truth);
            let (ma, mb) = (map.polygon(&a), map.polygon(&b));
            prop_assert_eq!(interiors_intersect(&ma, &mb), truth, "mapped by {:?}", map);
            prop_assert!(interiors_intersect(&a, &a));
            Ok(())
        })
        .unwrap();
}

#[test]
fn meetings_agree_with_solving() {
    let segment = || ((0i64..5, 0i64..5), (0i64..5, 0i64..5)).prop_filter("point", |(a, b)| a != b);
    runner(100_000)
        .run(&(segment(), segment(), affine()), |(s, t, map)| {
            let at = |q: (i64, i64)| map.of(&p(q.0, q.1));
            let (s, t) = ([at(s.0), at(s.1)], [at(t.0), at(t.1)]);
            let (s, t) = ([&s[0], &s[1]], [&t[0], &t[1]]);
            let how = meet(s, t);
            prop_assert_eq!(how != Meeting::Apart, segments_meet_by_solving(s, t));
            let on = |v: &Vec2, e: [&Vec2; 2]| {
                orient(e[0], e[1], v) == 0 && (v - e[0]).dot(&(v - e[1])).sign() <= 0
            };
            let is_end = |v: &Vec2| s.contains(&v) || t.contains(&v);
            match &how {
                Meeting::Apart => {}
                Meeting::Cross(v) => prop_assert!(on(v, s) && on(v, t) && !is_end(v)),
                Meeting::Touch(v) => prop_assert!(on(v, s) && on(v, t) && is_end(v)),
                Meeting::Overlap(v, w) => {
                    prop_assert!(v < w && is_end(v) && is_end(w));
                    prop_assert!(on(v, s) && on(v, t) && on(w, s) && on(w, t));
                }
            }
            prop_assert_eq!(how, meet(t, s));
            Ok(())
        })
        .unwrap();
}

// ---- by hand ---------------------------------------------------------------------------------

#[test]
fn regions_that_only_touch_share_no_interior() {
    let a = rect(0, 0, 4, 4);
    for (what, b) in [
        ("a whole edge", rect(4, 0, 8, 4)),
        ("part of an edge", rect(4, 1, 8, 2)),
        ("more than an edge", rect(4, -3, 8, 9)),
        ("a corner on a corner", rect(4, 4, 8, 8)),
        ("a corner on an edge", poly(&[(4, 2), (6, 1), (6, 3)])),
        ("an edge on a corner", poly(&[(2, 6), (6, 2), (6, 6)])),
        (
            "wrapped around",
            poly(&[
                (-1, -1),
                (5, -1),
                (5, 5),
                (4, 5),
                (4, 0),
                (0, 0),
                (0, 5),
                (-1, 5),
            ]),
        ),
        (
            "collinear vertices in the contact",
            poly(&[(4, 0), (8, 0), (8, 4), (4, 4), (4, 3), (4, 1)]),
        ),
    ] {
        assert!(defects(&b).is_empty(), "{what}");
        assert!(!interiors_intersect(&a, &b), "{what}");
        assert!(!interiors_intersect(&b, &a), "{what}");
    }
}

#[test]
fn regions_that_share_interior_in_degenerate_ways() {
    let a = rect(0, 0, 4, 4);
    for (what, b) in [
        ("equal", rect(0, 0, 4, 4)),
        (
            "equal, other sense",
            poly(&[(0, 0), (0, 4), (4, 4), (4, 0)]),
        ),
        (
            "equal, more vertices",
            poly(&[(0, 0), (2, 0), (4, 0), (4, 4), (0, 4), (0, 3)]),
        ),
        (
            "inside, touching all round",
            poly(&[(2, 0), (4, 2), (2, 4), (0, 2)]),
        ),
        ("inside, free", rect(1, 1, 2, 2)),
        ("around", rect(-1, -1, 5, 5)),
        ("half, on three edges", rect(0, 0, 2, 4)),
        (
            "through two corners",
            poly(&[(-1, -1), (5, 5), (6, 5), (0, -1)]),
        ),
        ("a cross without a vertex inside", rect(1, -1, 2, 5)),
    ] {
        assert!(defects(&b).is_empty(), "{what}");
        assert!(interiors_intersect(&a, &b), "{what}");
        assert!(interiors_intersect(&b, &a), "{what}");
    }
}

#[test]
fn a_hole_is_outside() {
    let frame = Polygon::new(
        ring(&[(0, 0), (9, 0), (9, 9), (0, 9)]),
        vec![ring(&[(3, 3), (6, 3), (6, 6), (3, 6)])],
    );
    assert!(defects(&frame).is_empty());
    assert_eq!(frame.locate(&p(4, 4)), Location::Outside);
    assert_eq!(frame.locate(&p(3, 4)), Location::Boundary);
    assert_eq!(frame.locate(&p(1, 4)), Location::Inside);
    assert!(
        !interiors_intersect(&frame, &rect(3, 3, 6, 6)),
        "fills the hole exactly"
    );
    assert!(
        !interiors_intersect(&frame, &rect(4, 4, 5, 5)),
        "lies in the hole"
    );
    assert!(
        interiors_intersect(&frame, &rect(2, 4, 5, 5)),
        "reaches out of the hole"
    );
    assert!(interiors_intersect(&frame, &frame.clone()));
    // Frames that interlock: the second fills the first's hole and all but touches outside.
    let outer = Polygon::new(
        ring(&[(-3, -3), (12, -3), (12, 12), (-3, 12)]),
        vec![ring(&[(0, 0), (9, 0), (9, 9), (0, 9)])],
    );
    assert!(!interiors_intersect(&frame, &outer));
    assert!(boundary_relation(&frame, &outer).opposite_side);
}

/// A hole's vertex on an edge pinches the region just where another edge crosses.
#[test]
fn crossings_at_a_pinch() {
    let a = Polygon::new(
        ring(&[(0, 0), (8, 0), (8, 8), (0, 8)]),
        vec![ring(&[(4, 0), (7, 4), (1, 4)])],
    );
    assert!(defects(&a).is_empty());
    for b in [
        poly(&[(4, -1), (4, 3), (5, 3)]),
        poly(&[(4, -1), (4, 3), (3, 3)]),
        poly(&[(4, 0), (5, 3), (3, 3)]),
        poly(&[(4, 0), (3, -3), (5, -3)]),
    ] {
        let truth = overlap_by_slabs(&a, &b);
        assert_eq!(interiors_intersect(&a, &b), truth, "{b:?}");
        assert_eq!(interiors_intersect(&b, &a), truth, "{b:?}");
    }
}

#[test]
fn defects_name_what_is_wrong() {
    let first = |q: &Polygon| defects(q).first().cloned();
    assert_eq!(
        first(&poly(&[(0, 0), (1, 0)])),
        Some(Defect::TooFewVertices { ring: 0, count: 2 })
    );
    assert_eq!(
        first(&poly(&[(0, 0), (1, 1), (2, 2)])),
        Some(Defect::ZeroArea { ring: 0 })
    );
    assert!(matches!(
        first(&poly(&[(0, 0), (2, 0), (2, 0), (0, 2)])),
        Some(Defect::ZeroLengthEdge(e)) if e.edge == 1
    ));
    assert!(matches!(
        first(&poly(&[(0, 0), (2, 0), (0, 2), (0, 0)])),
        Some(Defect::ZeroLengthEdge(e)) if e.edge == 3
    ));
    assert_eq!(
        first(&poly(&[(0, 0), (4, 0), (4, 4), (4, 2), (0, 4)])),
        Some(Defect::Spike { ring: 0, vertex: 2 })
    );
    assert!(matches!(
        first(&poly(&[(0, 0), (2, 2), (2, 0), (0, 2)])),
        Some(Defect::EdgesMeet { first, second, how })
            if (first.edge, second.edge) == (0, 2) && *how == Meeting::Cross(p(1, 1))
    ));
    assert!(matches!(
        first(&poly(&[(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)])),
        Some(Defect::EdgesMeet { how, .. }) if *how == Meeting::Touch(p(2, 0))
    ));
    let square = ring(&[(0, 0), (9, 0), (9, 9), (0, 9)]);
    let with = |holes: &[&[(i64, i64)]]| {
        first(&Polygon::new(
            square.clone(),
            holes.iter().map(|h| ring(h)).collect(),
        ))
    };
    assert_eq!(with(&[&[(1, 1), (2, 1), (1, 2)]]), None);
    assert_eq!(with(&[&[(0, 4), (2, 3), (2, 5)]]), None, "a hole may touch");
    assert_eq!(
        with(&[&[(11, 1), (12, 1), (11, 2)]]),
        Some(Defect::HoleOutside { hole: 0 })
    );
    assert!(matches!(
        with(&[&[(8, 1), (12, 1), (8, 2)]]),
        Some(Defect::EdgesMeet { .. })
    ));
    assert_eq!(
        with(&[&[(1, 1), (5, 1), (1, 5)], &[(2, 2), (3, 2), (2, 3)]]),
        Some(Defect::HolesOverlap {
            first: 0,
            second: 1
        })
    );
    // Out through a vertex of the outer ring, without any edges that cross.
    let notch = Polygon::new(
        ring(&[(0, 0), (8, 0), (8, 8), (4, 4), (0, 8)]),
        vec![ring(&[(2, 2), (6, 2), (4, 4), (5, 7), (3, 7), (4, 4)])],
    );
    assert!(!defects(&notch).is_empty());
}

#[test]
fn predicates_by_hand() {
    assert_eq!(orient(&p(0, 0), &p(1, 0), &p(0, 1)), 1);
    assert_eq!(orient(&p(0, 0), &p(1, 0), &p(5, 0)), 0);
    // Doubles of these coordinates are equal; the points are not on a line.
    let big = |x: &str, y: &str| Vec2::new(x.parse().unwrap(), y.parse().unwrap());
    let far = big("100000000000000000001", "100000000000000000000");
    assert_eq!(orient(&p(0, 0), &p(1, 1), &far), -1);
    assert_eq!(corner(&p(0, 0), &p(1, 0), &p(1, 1)), Corner::Convex);
    assert_eq!(corner(&p(0, 0), &p(1, 0), &p(2, 0)), Corner::Straight);
    assert_eq!(corner(&p(0, 0), &p(1, 0), &p(1, -1)), Corner::Reflex);
    assert!(!Box2::EMPTY.meets(&Box2::of_point(&p(0, 0))));
    assert!(Polygon::new(vec![], vec![]).is_empty());
}

#[test]
fn turning_is_exact() {
    let square = rect(1, 1, 2, 3);
    let back = square
        .rotated(&p(7, -2), &Rat::frac(3, 5))
        .rotated(&p(7, -2), &Rat::frac(-3, 5));
    assert_eq!(back.rings(), square.rings());
}

/// A comb of many teeth: near-linear where it matters, and no quadratic surprise.
#[test]
fn large_polygons_stay_fast() {
    let n = 2_000;
    let mut points = vec![(0, -5)];
    for k in 0..n {
        points.extend([
            (4 * k, 0),
            (4 * k + 1, 1_000),
            (4 * k + 2, 1_000),
            (4 * k + 3, 0),
        ]);
    }
    points.push((4 * n, -5));
    let comb = poly(&points);
    assert!(defects(&comb).is_empty());
    let other = comb.translated(&p(0, -1_006));
    assert!(!interiors_intersect(&comb, &other));
    let between = comb.translated(&Vec2::new(Rat::from(2), Rat::from(1)));
    assert!(interiors_intersect(&comb, &between));
}
