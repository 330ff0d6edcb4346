//! Whether a configuration is free, by the polygons and nothing of the engine's.
#![allow(dead_code, unreachable_pub)]

use snapfit::contact::Chart;
use snapfit::geometry::{Polygon, Vec2, interiors_intersect};
use snapfit::scene::{Obstacle, Scene};
use snapfit::slice::{Configuration, Slice};

/// The obstacles as polygons.
pub fn solids(scene: &Scene) -> Vec<Polygon> {
    let solid = |o: &Obstacle| Polygon::new(o.vertices.clone(), o.holes.clone());
    scene.obstacles.iter().map(solid).collect()
}

/// Whether the pawl is clear of all obstacles and strictly between its stops, by the polygons.
pub fn clear(
    scene: &Scene,
    solids: &[Polygon],
    pawl: usize,
    slice: &Slice,
    c: &Configuration,
) -> bool {
    let p = &scene.pawls[pawl];
    if let Some((lo, hi)) = &p.limits {
        let u = match c.chart {
            Chart::Rest => Some(c.x.clone()),
            Chart::Back if c.x.is_zero() => None,
            Chart::Back => Some(-c.x.recip()),
        };
        if u.is_none_or(|u| u <= *lo || u >= *hi) {
            return false;
        }
    }
    let hinge = &slice.frame.p0 + &slice.frame.v.scale(&c.t);
    let ring: Vec<Vec2> = p
        .vertices
        .iter()
        .map(|v| {
            let turned = (v - &p.hinge).rotate_tan_half(&c.x);
            let turned = match c.chart {
                Chart::Back => -&turned,
                Chart::Rest => turned,
            };
            &turned + &hinge
        })
        .collect();
    let moved = Polygon::new(ring, Vec::new());
    !solids.iter().any(|o| interiors_intersect(&moved, o))
}
