//! Certified boxes of doubles: the cheap half of every predicate.

use super::Vec2;
use crate::number::Interval;

/// A box of doubles that certainly contains what it was made from.
///
/// It serves as the enclosure of a single point and as the bounding box of many. That two boxes
/// do not meet is a proof that their contents do not; that they meet proves nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box2 {
    /// Encloses the abscissae.
    pub x: Interval,
    /// Encloses the ordinates.
    pub y: Interval,
}

impl Box2 {
    /// The box of nothing: it meets no box, and its hull with any box is that box.
    pub const EMPTY: Box2 = Box2 {
        x: Interval {
            lo: f64::INFINITY,
            hi: f64::NEG_INFINITY,
        },
        y: Interval {
            lo: f64::INFINITY,
            hi: f64::NEG_INFINITY,
        },
    };

    /// The tightest box of doubles around one point; a point itself where the coordinates are
    /// doubles.
    pub fn of_point(p: &Vec2) -> Box2 {
        Box2 {
            x: p.x.interval(),
            y: p.y.interval(),
        }
    }

    /// The smallest box around both.
    pub fn hull(&self, other: &Box2) -> Box2 {
        Box2 {
            x: hull(self.x, other.x),
            y: hull(self.y, other.y),
        }
    }

    /// Whether the two boxes share a point. `false` is a proof that their contents share none.
    pub fn meets(&self, other: &Box2) -> bool {
        self.x.meets(&other.x) && self.y.meets(&other.y)
    }
}

/// The smallest interval around both.
fn hull(a: Interval, b: Interval) -> Interval {
    Interval {
        lo: a.lo.min(b.lo),
        hi: a.hi.max(b.hi),
    }
}
