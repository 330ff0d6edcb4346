//! Whether a translation for ever takes one polygon clear of another: exact, and of all time.
//!
//! Let the direction be d. Along a line parallel to d, a point of the moving polygon meets a point
//! of the other one some day exactly if it lies behind it. So the motion is free exactly if on
//! every line parallel to d that meets both interiors, all of the mover lies ahead of all of the
//! other: for every edge e of the mover and every edge f of the other, e is ahead of f wherever
//! both have a point on the same line. Positions along d are linear in between, so comparing at
//! the two ends of the common stretch decides. Edges parallel to d have no open stretch and do not
//! count. The polygons' interiors must not meet at the start.

use crate::geometry::{Polygon, Vec2};
use crate::number::Rat;

/// An edge seen along d: its two ends (across, along), the lower across first.
type Seen = [(Rat, Rat); 2];

fn edges(polygon: &Polygon, d: &Vec2) -> Vec<Seen> {
    let seen = |p: &Vec2| (d.cross(p), d.dot(p));
    (0..polygon.rings().len())
        .flat_map(|ring| (0..polygon.rings()[ring].len()).map(move |k| (ring, k)))
        .filter_map(|(ring, k)| {
            let [a, b] = polygon.edge(ring, k);
            let (a, b) = (seen(a), seen(b));
            match a.0.cmp(&b.0) {
                std::cmp::Ordering::Less => Some([a, b]),
                std::cmp::Ordering::Greater => Some([b, a]),
                std::cmp::Ordering::Equal => None,
            }
        })
        .collect()
}

/// Position along d where an edge crosses the line `across`.
fn along(edge: &Seen, across: &Rat) -> Rat {
    let [a, b] = edge;
    let part = &(across - &a.0) / &(&b.0 - &a.0);
    &a.1 + &(&part * &(&b.1 - &a.1))
}

/// Whether their boxes alone show that the mover never meets the other: they share no line along
/// d, or the mover is wholly ahead. Doubles, rounded outward.
fn far_apart(mover: &Polygon, other: &Polygon, d: &Vec2) -> bool {
    let (dx, dy) = (d.x.interval(), d.y.interval());
    let seen = |p: &Polygon| {
        let b = p.bounds();
        (dx * b.y - dy * b.x, dx * b.x + dy * b.y)
    };
    let ((a, p), (b, q)) = (seen(mover), seen(other));
    a.hi < b.lo || b.hi < a.lo || p.lo >= q.hi
}

/// Whether `mover`, going on along `d` for ever, never meets the interior of `other`. For d = 0:
/// true, since the interiors do not meet at the start.
///
/// Cost: the product of the numbers of edges.
pub fn escapes(mover: &Polygon, other: &Polygon, d: &Vec2) -> bool {
    if d.is_zero() {
        return true;
    }
    if far_apart(mover, other, d) {
        return true;
    }
    let (mine, theirs) = (edges(mover, d), edges(other, d));
    mine.iter().all(|e| {
        theirs.iter().all(|f| {
            let low = (&e[0].0).max(&f[0].0);
            let high = (&e[1].0).min(&f[1].0);
            low >= high || [low, high].iter().all(|at| along(e, at) >= along(f, at))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[(i64, i64)]) -> Polygon {
        let v = |&(x, y): &(i64, i64)| Vec2::new(Rat::from(x), Rat::from(y));
        Polygon::new(points.iter().map(v).collect(), Vec::new())
    }

    fn d(x: i64, y: i64) -> Vec2 {
        Vec2::new(Rat::from(x), Rat::from(y))
    }

    /// A block in a U: out through the mouth only, with no room to spare.
    #[test]
    fn a_block_leaves_a_u_by_its_mouth_alone() {
        let u = polygon(&[
            (0, 0),
            (5, 0),
            (5, 4),
            (3, 4),
            (3, 1),
            (2, 1),
            (2, 4),
            (0, 4),
        ]);
        let block = polygon(&[(2, 1), (3, 1), (3, 2), (2, 2)]);
        assert!(escapes(&block, &u, &d(0, 1)));
        for away in [d(1, 0), d(0, -1), d(-1, 0), d(1, 100), d(-1, 100)] {
            assert!(!escapes(&block, &u, &away), "{away:?}");
        }
        // The other way round it is the U that leaves.
        assert!(escapes(&u, &block, &d(0, -1)));
        assert!(!escapes(&u, &block, &d(0, 1)));
    }

    /// Far away, and yet in the way.
    #[test]
    fn an_obstacle_far_off_counts() {
        let block = polygon(&[(0, 0), (1, 0), (1, 1), (0, 1)]);
        let far = polygon(&[(1000, 0), (1001, 0), (1001, 1), (1000, 1)]);
        assert!(!escapes(&block, &far, &d(1, 0)));
        assert!(escapes(&block, &far, &d(-1, 0)));
        // Sliding past with edges in one line is no collision.
        assert!(escapes(&block, &far, &d(999, 1)) == false);
        assert!(escapes(&block, &far, &d(1, 1)));
        assert!(escapes(
            &block,
            &polygon(&[(2, 1), (3, 1), (3, 2), (2, 2)]),
            &d(1, 0)
        ));
    }
}
