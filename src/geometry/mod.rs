//! Points, rational rotations, polygons and exact predicates on them.
mod vec2;
pub use vec2::Vec2;
