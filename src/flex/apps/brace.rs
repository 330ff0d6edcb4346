//! Where a beam would hold most (PF §VI-A, Fig. 5): of all pairs of vertices that see each other
//! at the start, the one that moved apart most when the structure flexed.
//!
//! Two vertices of different bodies see each other if the open segment between them meets the
//! interior of no body; running along an edge or through a joint's clearance is no hindrance. All
//! pairs are ordered by their change of distance in doubles; from the first that is visible on,
//! those that doubles cannot tell apart are compared exactly, ties going to the pair that comes
//! first in the file. So the answer is exact for the configuration that flexing reached.

use crate::flex::Violation;
use crate::flex::fit::Fitted;
use crate::flex::shape::{Placed, Shape, double};
use crate::flex::{FlexOptions, Flexed, Pose, Structure, Term, flex};
use crate::geometry::{Box2, Location, Polygon, Vec2};
use crate::number::{Algebraic, Rat};
use crate::report::Num;
use serde::Serialize;
use std::cmp::Ordering;

/// Most vertices of a structure: the search looks at all pairs.
pub const MOST_VERTICES: usize = 3_000;

/// Which changes count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Change {
    /// Moved apart.
    #[default]
    Apart,
    /// Moved together.
    Together,
}

/// A pair of vertices that a beam might join.
#[derive(Clone, Debug)]
pub struct Brace {
    /// The ends: body and vertex.
    pub ends: [(usize, usize); 2],
    /// Where they are at first.
    pub before: [Vec2; 2],
    /// Squared distances, first and last.
    pub squares: [Rat; 2],
    /// Pairs that were looked at, and those of them whose view was tested.
    pub looked: (usize, usize),
}

impl Brace {
    /// The distances, first and last.
    pub fn distances(&self) -> [Algebraic; 2] {
        self.squares.clone().map(|square| {
            let root = Violation { square, pair: None };
            root.value()
        })
    }
}

/// A structure with a question: where it has none, all bodies are to move away from the middle of
/// the box of their reference points, as PF does.
pub fn with_question(structure: &Structure) -> Structure {
    let mut out = structure.clone();
    if out.objective.is_empty() {
        let axis = |pick: fn(&Vec2) -> &Rat| {
            let each = || structure.bodies.iter().map(|b| pick(&b.position));
            match (each().min(), each().max()) {
                (Some(a), Some(b)) => Rat::midpoint(a, b),
                _ => Rat::zero(),
            }
        };
        let from = Vec2::new(axis(|p| &p.x), axis(|p| &p.y));
        out.objective = vec![Term::Radial { body: None, from }];
    }
    out
}

/// Flexes a structure and finds where a beam would hold most; None where no two vertices of
/// different bodies see each other and move that way.
///
/// # Errors
/// More vertices than [`MOST_VERTICES`].
pub fn brace(
    structure: &Structure,
    change: Change,
    options: &FlexOptions<'_>,
) -> Result<(Flexed, Option<Brace>), String> {
    let vertices: usize = structure.bodies.iter().map(|b| b.vertices.len()).sum();
    if vertices > MOST_VERTICES {
        return Err(format!(
            "the structure has {vertices} vertices; pairs of more than {MOST_VERTICES} are not searched"
        ));
    }
    let flexed = flex(structure, options);
    let found = match (flexed.configurations.first(), flexed.configurations.last()) {
        (Some(before), Some(after)) => strongest(structure, before, after, change),
        _ => None,
    };
    Ok((flexed, found))
}

/// The visible pair whose distance changed most between two configurations.
pub fn strongest(
    structure: &Structure,
    before: &[Pose],
    after: &[Pose],
    change: Change,
) -> Option<Brace> {
    if let Some(fit) = Fitted::of(structure) {
        let (from, to) = (fit.own(before), fit.own(after));
        let (unit, own) = (fit.length(), strongest(&fit.structure, &from, &to, change)?);
        return Some(Brace {
            before: own.before.map(|p| Vec2::new(&p.x * &unit, &p.y * &unit)),
            squares: own.squares.map(|v| v * unit.square()),
            ..own
        });
    }
    let place = |poses: &[Pose]| -> Vec<Polygon> {
        let each = structure.bodies.iter().zip(poses);
        each.map(|(b, p)| Placed::new(&Shape::of(b), p).polygon())
            .collect()
    };
    let (from, to) = (place(before), place(after));
    let all: Vec<(usize, usize)> = (0..from.len())
        .flat_map(|b| (0..from[b].rings()[0].len()).map(move |v| (b, v)))
        .collect();
    let near = |polygons: &[Polygon], (b, v): (usize, usize)| {
        let p = &polygons[b].rings()[0][v];
        [double(&p.x), double(&p.y)]
    };
    let points: Vec<[[f64; 2]; 2]> = all
        .iter()
        .map(|&k| [near(&from, k), near(&to, k)])
        .collect();
    let size = points
        .iter()
        .flatten()
        .flatten()
        .fold(0.0f64, |m, v| m.max(v.abs()));
    // Coordinates are off by half a unit in the last place, the four operations by as much each.
    let error = size * 2f64.powi(-46);
    let sign = match change {
        Change::Apart => 1.0,
        Change::Together => -1.0,
    };
    let mut pairs: Vec<(f64, u32, u32)> = Vec::new();
    for i in 0..all.len() {
        for j in i + 1..all.len() {
            if all[i].0 == all[j].0 {
                continue;
            }
            let length = |k: usize| {
                let (p, q) = (points[i][k], points[j][k]);
                (p[0] - q[0]).hypot(p[1] - q[1])
            };
            let moved = sign * (length(1) - length(0));
            if moved > -error {
                pairs.push((moved, i as u32, j as u32));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let sight = Sight::new(&from);
    let squares = |i: usize, j: usize| {
        let square = |polygons: &[Polygon]| {
            let at = |k: usize| &polygons[all[k].0].rings()[0][all[k].1];
            (at(i) - at(j)).norm2()
        };
        [square(&from), square(&to)]
    };
    let mut best: Option<(f64, usize, usize, [Rat; 2])> = None;
    let mut tested = 0;
    for &(moved, i, j) in &pairs {
        let (i, j) = (i as usize, j as usize);
        if let Some((found, ..)) = &best
            && moved < found - 2.0 * error
        {
            break;
        }
        tested += 1;
        let at = |k: usize| &from[all[k].0].rings()[0][all[k].1];
        if !sight.free(at(i), at(j)) {
            continue;
        }
        let mine = squares(i, j);
        let better = match &best {
            None => true,
            Some((_, _, _, theirs)) => {
                let order = compare_changes(&mine, theirs);
                let order = if change == Change::Apart {
                    order
                } else {
                    order.reverse()
                };
                order == Ordering::Greater
            }
        };
        if better {
            best = Some((moved, i, j, mine));
        }
    }
    let (_, i, j, squares) = best?;
    let way = squares[1].cmp(&squares[0]);
    let wanted = match change {
        Change::Apart => Ordering::Greater,
        Change::Together => Ordering::Less,
    };
    (way == wanted).then(|| Brace {
        ends: [all[i], all[j]],
        before: [i, j].map(|k| from[all[k].0].rings()[0][all[k].1].clone()),
        squares,
        looked: (pairs.len(), tested),
    })
}

/// Compares √b − √a of two pairs of squares (a, b), exactly.
pub fn compare_changes(first: &[Rat; 2], second: &[Rat; 2]) -> Ordering {
    // √b − √a against √d − √c is √b + √c against √d + √a; both are ≥ 0, so their squares compare:
    // b + c + 2√(bc) against d + a + 2√(da).
    let ([a, b], [c, d]) = (first, second);
    let k = (&(d + a) - &(b + c)) / Rat::from(2);
    let (p, q) = (b * c, d * a);
    // √p against √q + k.
    if k.sign() >= 0 {
        // Squares again: p − q − k² against 2k√q.
        let left = &(&p - &q) - &k.square();
        let right = &(&k.square() * &q) * &Rat::from(4);
        if left.sign() < 0 {
            Ordering::Less
        } else {
            left.square().cmp(&right)
        }
    } else {
        // √p + (−k) against √q: the mirror image.
        let k = -&k;
        let left = &(&q - &p) - &k.square();
        let right = &(&k.square() * &p) * &Rat::from(4);
        if left.sign() < 0 {
            Ordering::Greater
        } else {
            right.cmp(&left.square())
        }
    }
}

/// What may hide one point from another.
struct Sight<'a> {
    polygons: &'a [Polygon],
    boxes: Vec<Box2>,
}

impl<'a> Sight<'a> {
    fn new(polygons: &'a [Polygon]) -> Sight<'a> {
        Sight {
            polygons,
            boxes: polygons.iter().map(|p| *p.bounds()).collect(),
        }
    }

    /// Whether the open segment meets no interior.
    fn free(&self, a: &Vec2, b: &Vec2) -> bool {
        let ends = [
            [a.x.interval(), a.y.interval()],
            [b.x.interval(), b.y.interval()],
        ];
        let low = |k: usize| ends[0][k].lo.min(ends[1][k].lo);
        let high = |k: usize| ends[0][k].hi.max(ends[1][k].hi);
        self.polygons.iter().zip(&self.boxes).all(|(polygon, b2)| {
            let apart =
                b2.x.hi < low(0) || b2.x.lo > high(0) || b2.y.hi < low(1) || b2.y.lo > high(1);
            apart || !crosses(polygon, a, b)
        })
    }
}

/// Whether the open segment from a to b meets the interior of a polygon.
fn crosses(polygon: &Polygon, a: &Vec2, b: &Vec2) -> bool {
    let d = b - a;
    let mut cuts = vec![Rat::zero(), Rat::one()];
    let ring = &polygon.rings()[0];
    let sides: Vec<Rat> = ring.iter().map(|p| d.cross(&(p - a))).collect();
    let length = d.norm2();
    for k in 0..ring.len() {
        let next = (k + 1) % ring.len();
        let (s, t) = (&sides[k], &sides[next]);
        if s.sign() * t.sign() > 0 {
            continue;
        }
        let mut cut = |p: &Vec2| {
            let at = &d.dot(&(p - a)) / &length;
            if at.sign() > 0 && at < Rat::one() {
                cuts.push(at);
            }
        };
        if s.is_zero() {
            cut(&ring[k]);
        }
        if !s.is_zero() && !t.is_zero() {
            let part = s / &(s - t);
            cut(&(&ring[k] + &(&ring[next] - &ring[k]).scale(&part)));
        }
    }
    cuts.sort();
    cuts.dedup();
    cuts.windows(2).any(|w| {
        let middle = a + &d.scale(&Rat::midpoint(&w[0], &w[1]));
        polygon.locate(&middle) == Location::Inside
    })
}

/// The result of `snapfit brace`.
#[derive(Clone, Debug, Serialize)]
pub struct BraceDocument {
    /// Which format this is.
    pub schema: &'static str,
    /// Name of the structure.
    pub structure: String,
    /// How far it flexed: the weighted displacement, exact.
    pub displacement: Num,
    /// How stepping ended.
    pub outcome: &'static str,
    /// The beam; null where there is none.
    pub brace: Option<BeamDocument>,
    /// Pairs of vertices that moved that way, and those whose view was tested.
    pub pairs: [usize; 2],
}

/// A beam.
#[derive(Clone, Debug, Serialize)]
pub struct BeamDocument {
    /// Its ends: body, vertex, and where it is at first.
    pub ends: [(String, usize, [String; 2]); 2],
    /// Its length at first.
    pub before: Num,
    /// The distance after flexing.
    pub after: Num,
}

impl BraceDocument {
    /// The document of a search.
    pub fn new(structure: &Structure, flexed: &Flexed, found: Option<&Brace>) -> BraceDocument {
        BraceDocument {
            schema: "snapfit.brace/1",
            structure: structure.name.clone(),
            displacement: Num::of_rat(&flexed.displacement),
            outcome: flexed.ending.word(),
            pairs: found.map_or([0, 0], |b| [b.looked.0, b.looked.1]),
            brace: found.map(|b| {
                let [before, after] = b.distances();
                let end = |k: usize| {
                    let (body, vertex) = b.ends[k];
                    let at = &b.before[k];
                    (
                        structure.bodies[body].name.clone(),
                        vertex,
                        [at.x.to_string(), at.y.to_string()],
                    )
                };
                BeamDocument {
                    ends: [end(0), end(1)],
                    before: Num::of(&before),
                    after: Num::of(&after),
                }
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_compare_like_their_doubles_and_know_ties() {
        let r = |n: i64, d: i64| Rat::frac(n, d);
        // √8 − √2 = √2 − 0.
        assert_eq!(
            compare_changes(&[r(2, 1), r(8, 1)], &[r(0, 1), r(2, 1)]),
            Ordering::Equal
        );
        let mut seed = 12345u64;
        let mut draw = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as i64 % 1000
        };
        for _ in 0..2000 {
            let v: Vec<i64> = (0..4).map(|_| draw().abs()).collect();
            let f = |k: usize| (v[k] as f64).sqrt();
            let want = (f(1) - f(0)) - (f(3) - f(2));
            let got = compare_changes(&[r(v[0], 1), r(v[1], 1)], &[r(v[2], 1), r(v[3], 1)]);
            if want.abs() > 1e-9 {
                assert_eq!(got, want.total_cmp(&0.0), "{v:?}");
            }
        }
    }

    #[test]
    fn sight_passes_along_an_edge_but_not_through_a_body() {
        let p = |x: i64, y: i64| Vec2::new(Rat::from(x), Rat::from(y));
        let square = Polygon::new(vec![p(0, 0), p(2, 0), p(2, 2), p(0, 2)], Vec::new());
        let polygons = [square];
        let sight = Sight::new(&polygons);
        assert!(sight.free(&p(-1, 0), &p(3, 0)), "along the lower edge");
        assert!(!sight.free(&p(0, 0), &p(2, 2)), "along the diagonal");
        assert!(!sight.free(&p(-1, 1), &p(3, 1)));
        assert!(sight.free(&p(-1, 1), &p(0, 1)), "up to the edge");
        assert!(sight.free(&p(-1, 1), &p(1, 3)), "past the corner");
    }
}
