//! What a walk walks on: arcs of the input, or edges of faces already found.

use super::kernel::{CurveId, NumId};
use crate::geometry::index::Bounds;

pub(crate) const NONE: u32 = u32::MAX;

/// A point: a number on the u axis and a curve that passes over it there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) x: NumId,
    pub(crate) c: CurveId,
}

/// What an arc lies on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Carrier {
    /// The graph of a curve.
    Graph(CurveId),
    /// A line u = const, between the heights of two curves.
    Vertical(CurveId, CurveId),
}

/// An arc, or an edge of a face already found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub(crate) carrier: Carrier,
    /// Left and right end on the u axis; the same for verticals.
    pub(crate) l: NumId,
    pub(crate) r: NumId,
    /// The vertices at the left (or lower) and right (or upper) end.
    pub(crate) vl: u32,
    pub(crate) vr: u32,
    pub(crate) color: u8,
    /// The component of its colour that it belongs to.
    pub(crate) comp: u32,
    /// The arc of the input that it is part of.
    pub(crate) arc: u32,
    /// A box around it; `EMPTY` until it is asked for.
    pub(crate) bounds: Bounds,
}

/// A component of the input of a walk: where its leftmost (then lowest) point is, and an item that
/// starts there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Comp {
    pub(crate) vertex: u32,
    pub(crate) item: u32,
}

/// Where a point lies on an item.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Place {
    Inside,
    Low,
    High,
}
