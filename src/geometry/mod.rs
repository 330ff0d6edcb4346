//! Points, polygons and the exact questions asked of them.
//!
//! One idea carries the module: *a float may only say what it has proven*. Every point travels
//! with a certified box of doubles ([`Box2`]); a predicate asks the boxes first and does exact
//! rational arithmetic only where they leave the answer open. So the answers are exact for every
//! input, and cheap for the usual one.
//!
//! | file | question |
//! | --- | --- |
//! | `vec2` | what is a point? |
//! | `box2` | where is it, roughly but surely? |
//! | `predicates` | on which side, in what kind of corner? |
//! | `segment` | where do two segments meet? |
//! | `polygon` | what is a region, and is a point in it? |
//! | `defects` | what keeps a polygon from being one? |
//! | `overlap` | do two regions' interiors share a point? |
//! | `index` | which pieces may meet this one? |
//! | `chain` | which edges of a polyline may meet a region? |

mod box2;
pub(crate) mod chain;
mod defects;
pub(crate) mod index;
mod overlap;
mod polygon;
mod predicates;
mod segment;
mod vec2;

pub use box2::Box2;
pub use defects::{Defect, EdgeRef, MAX_DEFECTS, defects};
pub use overlap::{BoundaryRelation, boundary_relation, interiors_intersect};
pub use polygon::{Location, Polygon};
pub use predicates::{Corner, corner, orient};
pub use segment::{Meeting, meet};
pub use vec2::Vec2;
