//! The obstacles as polygons, made when a first test needs one: most runs never ask whether a placement is
//! clear, and a polygon costs a look at every vertex.

use super::root::obstacle_polygon;
use crate::geometry::Polygon;
use crate::scene::Obstacle;
use std::ops::Deref;
use std::sync::OnceLock;

/// The obstacles of a scene as a slice of polygons.
#[derive(Debug)]
pub struct Solids<'a> {
    from: &'a [Obstacle],
    made: OnceLock<Vec<Polygon>>,
}

impl<'a> Solids<'a> {
    /// Of these obstacles; O(1) until the first look.
    pub fn new(from: &'a [Obstacle]) -> Solids<'a> {
        Solids {
            from,
            made: OnceLock::new(),
        }
    }
}

impl Deref for Solids<'_> {
    type Target = [Polygon];
    fn deref(&self) -> &[Polygon] {
        self.made
            .get_or_init(|| self.from.iter().map(obstacle_polygon).collect())
    }
}
