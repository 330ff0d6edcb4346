//! Where two segments meet: the four ways, told apart exactly.

use super::predicates::{Pin, orient_pins};
use super::{Box2, Vec2};
use crate::number::Rat;

/// How two closed segments of positive length meet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// They share no point.
    Apart,
    /// They cross at one point inside both.
    Cross(Vec2),
    /// They share exactly one point, an end of at least one of them.
    Touch(Vec2),
    /// They lie on one line and share a piece of positive length, given by its two ends in
    /// lexicographic order.
    Overlap(Vec2, Vec2),
}

/// How the segments `p` and `q` meet, exactly. Both must have positive length.
pub fn meet(p: [&Vec2; 2], q: [&Vec2; 2]) -> Meeting {
    let bp = p.map(Box2::of_point);
    let bq = q.map(Box2::of_point);
    let pin = |at, near| Pin { at, near };
    meet_pins(
        [pin(p[0], &bp[0]), pin(p[1], &bp[1])],
        [pin(q[0], &bq[0]), pin(q[1], &bq[1])],
    )
}

/// [`meet`] where the boxes are at hand.
pub(crate) fn meet_pins(p: [Pin<'_>; 2], q: [Pin<'_>; 2]) -> Meeting {
    debug_assert!(p[0].at != p[1].at && q[0].at != q[1].at);
    if !p[0].near.hull(p[1].near).meets(&q[0].near.hull(q[1].near)) {
        return Meeting::Apart;
    }
    let q_sides = [orient_pins(p[0], p[1], q[0]), orient_pins(p[0], p[1], q[1])];
    if q_sides == [0, 0] {
        return meet_on_a_line(p.map(|e| e.at), q.map(|e| e.at));
    }
    if q_sides[0] * q_sides[1] > 0 {
        return Meeting::Apart;
    }
    let p_sides = [orient_pins(q[0], q[1], p[0]), orient_pins(q[0], q[1], p[1])];
    if p_sides[0] * p_sides[1] > 0 {
        return Meeting::Apart;
    }
    // Each segment now reaches the other's line, and the lines differ: the one point where the
    // lines meet lies on both segments. It is an end wherever a side is zero.
    let end = [
        (q_sides[0], q[0]),
        (q_sides[1], q[1]),
        (p_sides[0], p[0]),
        (p_sides[1], p[1]),
    ]
    .into_iter()
    .find(|(side, _)| *side == 0);
    match end {
        Some((_, pin)) => Meeting::Touch(pin.at.clone()),
        None => Meeting::Cross(crossing(p.map(|e| e.at), q.map(|e| e.at))),
    }
}

/// Two segments on one line: the lexicographic order of points is the order along the line.
fn meet_on_a_line(p: [&Vec2; 2], q: [&Vec2; 2]) -> Meeting {
    let lo = p[0].min(p[1]).max(q[0].min(q[1]));
    let hi = p[0].max(p[1]).min(q[0].max(q[1]));
    match lo.cmp(hi) {
        std::cmp::Ordering::Less => Meeting::Overlap(lo.clone(), hi.clone()),
        std::cmp::Ordering::Equal => Meeting::Touch(lo.clone()),
        std::cmp::Ordering::Greater => Meeting::Apart,
    }
}

/// The common point of two lines that are not parallel.
fn crossing(p: [&Vec2; 2], q: [&Vec2; 2]) -> Vec2 {
    let along = p[1] - p[0];
    let across = q[1] - q[0];
    let t: Rat = (q[0] - p[0]).cross(&across) / along.cross(&across);
    p[0] + &along.scale(&t)
}
