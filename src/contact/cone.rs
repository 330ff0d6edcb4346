//! Cones: the local picture where two bodies touch at one point.

use super::Ring;
use crate::geometry::Vec2;
use crate::number::{Rat, Scalar};

/// The solid near a boundary point, as a union of convex cones, each given by its generators: a
/// half-plane (τ, −τ, inward) inside an edge, a wedge at a convex vertex, two half-planes at a
/// reflex one.
#[derive(Clone, Debug)]
pub struct Cones<R = Rat>(Vec<Vec<Vec2<R>>>);

impl<R: Scalar> Cones<R> {
    /// The solid of a ring beside a point inside edge k.
    pub fn at_edge(ring: &Ring<R>, k: usize) -> Cones<R> {
        Cones(vec![half_plane(ring, k)])
    }
    /// The solid of a ring beside vertex i.
    pub fn at_vertex(ring: &Ring<R>, i: usize) -> Cones<R> {
        if ring.convex[i] {
            let at = &ring.vertices[i];
            let ahead = &ring.vertices[ring.next(i)] - at;
            let behind = &ring.vertices[ring.prev(i)] - at;
            return Cones(vec![vec![ahead, behind]]);
        }
        Cones(vec![half_plane(ring, ring.prev(i)), half_plane(ring, i)])
    }
    /// Every generator once.
    pub fn generators(&self) -> impl Iterator<Item = &Vec2<R>> {
        self.0.iter().flatten()
    }
    /// All generators mapped, by a rotation say.
    pub fn map(&self, f: impl Fn(&Vec2<R>) -> Vec2<R>) -> Cones<R> {
        Cones(self.0.iter().map(|c| c.iter().map(&f).collect()).collect())
    }
    /// Whether the interior of these cones, moved by s, meets that of the others.
    ///
    /// Two convex cones meet so iff s lies inside the cone that the others and the negatives of
    /// these generate; that is so iff no line through the apex along a generator has all of them
    /// on one closed side and s on the other.
    pub fn overlap(&self, s: &Vec2<R>, others: &Cones<R>) -> bool {
        self.0.iter().any(|mine| {
            others
                .0
                .iter()
                .any(|theirs| convex_overlap(mine, s, theirs))
        })
    }
}

fn half_plane<R: Scalar>(ring: &Ring<R>, k: usize) -> Vec<Vec2<R>> {
    let along = &ring.vertices[ring.next(k)] - &ring.vertices[k];
    vec![-&along, along, -&ring.normals[k]]
}

fn convex_overlap<R: Scalar>(mine: &[Vec2<R>], s: &Vec2<R>, theirs: &[Vec2<R>]) -> bool {
    let all: Vec<Vec2<R>> = theirs
        .iter()
        .cloned()
        .chain(mine.iter().map(|g| -g))
        .collect();
    let candidates = all.iter().map(Vec2::right_normal).flat_map(|n| [-&n, n]);
    let zero = R::zero();
    !candidates
        .into_iter()
        .any(|n| n.dot(s) <= zero && all.iter().all(|g| n.dot(g) >= zero))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: i64, y: i64) -> Vec2 {
        Vec2::new(Rat::from(x), Rat::from(y))
    }

    #[test]
    fn wedges_over_a_floor() {
        // A unit square's corner at the origin, solid up and right; a floor whose top is y = 0.
        let square = Ring::new(vec![v(0, 0), v(1, 0), v(1, 1), v(0, 1)], false);
        let floor = Ring::new(vec![v(-5, -1), v(5, -1), v(5, 0), v(-5, 0)], false);
        let (corner, top) = (Cones::at_vertex(&square, 0), Cones::at_edge(&floor, 2));
        assert!(!corner.overlap(&v(0, 0), &top)); // flush is a touch
        assert!(!corner.overlap(&v(3, 0), &top));
        assert!(corner.overlap(&v(0, -1), &top));
        // Corner to corner: only a move into the other's quadrant overlaps.
        let end = Cones::at_vertex(&floor, 2);
        assert!(corner.overlap(&v(-1, -1), &end));
        assert!(!corner.overlap(&v(1, -1), &end));
        assert!(!corner.overlap(&v(-1, 1), &end));
        assert!(!corner.overlap(&v(0, -1), &end)); // slides down along the side
    }

    #[test]
    fn a_reflex_corner_is_two_half_planes() {
        // An L whose reflex corner (1, 1) opens up and right.
        let l = Ring::new(
            vec![v(0, 0), v(2, 0), v(2, 1), v(1, 1), v(1, 2), v(0, 2)],
            false,
        );
        let square = Ring::new(vec![v(0, 0), v(1, 0), v(1, 1), v(0, 1)], false);
        let (corner, nook) = (Cones::at_vertex(&square, 0), Cones::at_vertex(&l, 3));
        assert!(!corner.overlap(&v(0, 0), &nook));
        assert!(!corner.overlap(&v(1, 1), &nook));
        assert!(corner.overlap(&v(1, -1), &nook));
        assert!(corner.overlap(&v(-1, 1), &nook));
    }
}
