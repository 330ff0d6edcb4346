//! Sides and corners: the sign of one cross product, asked of boxes first.

use super::{Box2, Vec2};

/// A point together with its certified box, so that the box is made once and asked often.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pin<'a> {
    /// The exact point.
    pub(crate) at: &'a Vec2,
    /// A box that holds it.
    pub(crate) near: &'a Box2,
}

/// Which side of the directed line from `a` to `b` the point `c` lies on: 1 to the left, −1 to
/// the right, 0 on the line (also where `a` = `b`). Exact for every input.
pub fn orient(a: &Vec2, b: &Vec2, c: &Vec2) -> i32 {
    let boxes = [Box2::of_point(a), Box2::of_point(b), Box2::of_point(c)];
    orient_pins(
        Pin {
            at: a,
            near: &boxes[0],
        },
        Pin {
            at: b,
            near: &boxes[1],
        },
        Pin {
            at: c,
            near: &boxes[2],
        },
    )
}

/// [`orient`] where the boxes are at hand.
pub(crate) fn orient_pins(a: Pin<'_>, b: Pin<'_>, c: Pin<'_>) -> i32 {
    let doubt = (b.near.x - a.near.x) * (c.near.y - a.near.y)
        - (b.near.y - a.near.y) * (c.near.x - a.near.x);
    match doubt.sign() {
        Some(sign) => sign,
        None => (b.at - a.at).cross(&(c.at - a.at)).sign(),
    }
}

/// The kind of corner that a polygon makes at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Corner {
    /// The solid fills less than a half-plane there. Only such a vertex can strike something.
    Convex,
    /// The two edges continue each other: an ordinary, if idle, vertex.
    Straight,
    /// The solid fills more than a half-plane there.
    Reflex,
}

/// The corner at `at` between its neighbours along a boundary whose solid lies to the left.
///
/// An edge that folds back on itself (a spike) is no corner of a simple polygon; it is called
/// [`Corner::Straight`] here.
pub fn corner(before: &Vec2, at: &Vec2, after: &Vec2) -> Corner {
    Corner::from_turn(orient(before, at, after))
}

impl Corner {
    /// From the sign of the turn, the solid to the left.
    pub(crate) fn from_turn(turn: i32) -> Corner {
        match turn {
            1.. => Corner::Convex,
            0 => Corner::Straight,
            _ => Corner::Reflex,
        }
    }
}
