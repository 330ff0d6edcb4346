//! The root's collision: a pure translation against fixed polygons, solved in rationals.
//!
//! Between two neighbouring times at which a vertex of one body lies on an edge of the other,
//! whether the interiors meet cannot change. So the times are collected (each solves a linear
//! equation), and one exact overlap test in each gap, in order, finds the instant after which
//! interiors would meet. Touching and sliding along is no collision.

use super::trajectory::RootContact;
use crate::contact::Ring;
use crate::geometry::{Polygon, Vec2, interiors_intersect};
use crate::number::{Interval, Rat};
use crate::scene::{Obstacle, Root};

/// The first instant t ≥ 0 (at most `until`, where given) after which the root's interior would
/// meet an obstacle's, with the features that touch then. The root starts displaced by `offset`
/// and moves with velocity v. An instant equal to `until` is none: the phase ends before.
pub fn first_collision(
    root: &Root,
    obstacles: &[Obstacle],
    offset: &Vec2,
    v: &Vec2,
    until: Option<&Rat>,
) -> Option<(Rat, Vec<RootContact>)> {
    let verts: Vec<Vec2> = root.vertices.iter().map(|p| p + offset).collect();
    let body = Ring::new(verts, false);
    let mut touches: Vec<(Rat, RootContact)> = Vec::new();
    let mut best: Option<Rat> = None;
    for (o, obstacle) in obstacles.iter().enumerate() {
        let rings = std::iter::once((&obstacle.vertices, false))
            .chain(obstacle.holes.iter().map(|h| (h, true)));
        let first = touches.len();
        for (r, (ring, hole)) in rings.enumerate() {
            let ring = Ring::new(ring.clone(), hole);
            collect(&body, &ring, o as u32, r as u32, v, until, &mut touches);
        }
        let mut times: Vec<Rat> = touches[first..].iter().map(|t| t.0.clone()).collect();
        times.push(Rat::zero());
        times.sort();
        times.dedup();
        let fixed = obstacle_polygon(obstacle);
        for (i, t) in times.iter().enumerate() {
            if best.as_ref().is_some_and(|b| b <= t) {
                break;
            }
            let next = match (times.get(i + 1), until) {
                (Some(n), _) => n.clone(),
                (None, Some(u)) if u > t => u.clone(),
                (None, Some(_)) => break,
                (None, None) => t + &Rat::one(),
            };
            let at = &v.scale(&Rat::midpoint(t, &next));
            let moved = Polygon::new(body.vertices.iter().map(|p| p + at).collect(), Vec::new());
            if interiors_intersect(&moved, &fixed) {
                best = Some(t.clone());
                break;
            }
        }
    }
    let best = best?;
    let mut contacts: Vec<RootContact> = touches
        .into_iter()
        .filter(|t| t.0 == best)
        .map(|t| t.1)
        .collect();
    contacts.sort();
    contacts.dedup();
    Some((best, contacts))
}

/// The region of an obstacle.
pub fn obstacle_polygon(o: &Obstacle) -> Polygon {
    Polygon::new(o.vertices.clone(), o.holes.clone())
}

/// A box around all that the body passes over.
fn swept(body: &Ring, v: &Vec2, until: Option<&Rat>) -> (Interval, Interval) {
    let along = |of: fn(&Vec2) -> &Rat| {
        let none = Interval {
            lo: f64::INFINITY,
            hi: f64::NEG_INFINITY,
        };
        let at = |p: &Vec2| of(p).interval();
        let mut all = body.vertices.iter().fold(none, |all, p| all.hull(&at(p)));
        match until {
            Some(u) => all = all.hull(&(all + at(&v.scale(u)))),
            None if of(v).sign() > 0 => all.hi = f64::INFINITY,
            None if of(v).sign() < 0 => all.lo = f64::NEG_INFINITY,
            None => {}
        }
        all
    };
    (along(|p| &p.x), along(|p| &p.y))
}

fn collect(
    body: &Ring,
    ring: &Ring,
    obstacle: u32,
    ring_index: u32,
    v: &Vec2,
    until: Option<&Rat>,
    out: &mut Vec<(Rat, RootContact)>,
) {
    // The time at which `point`, moving with velocity w, lies on the edge from a to b.
    let meet = |point: &Vec2, w: &Vec2, a: &Vec2, b: &Vec2, n: &Vec2| -> Option<Rat> {
        let speed = w.dot(n);
        if speed.is_zero() {
            return None;
        }
        let t = (a - point).dot(n) / speed;
        if t.sign() < 0 || until.is_some_and(|u| t >= *u) {
            return None;
        }
        let at = point + &w.scale(&t);
        let along = b - a;
        let s = (&at - a).dot(&along);
        (s.sign() >= 0 && s <= along.norm2()).then_some(t)
    };
    let back = -v;
    let swept = swept(body, v, until);
    let near: Vec<usize> = (0..ring.len())
        .filter(|&j| {
            let (q, q1) = (&ring.vertices[j], &ring.vertices[ring.next(j)]);
            let x = q.x.interval().hull(&q1.x.interval());
            let y = q.y.interval().hull(&q1.y.interval());
            x.meets(&swept.0) && y.meets(&swept.1)
        })
        .collect();
    for (i, p) in body.vertices.iter().enumerate() {
        for &j in &near {
            let q = &ring.vertices[j];
            let (p1, q1) = (&body.vertices[body.next(i)], &ring.vertices[ring.next(j)]);
            let contact = |vertex_of_root| RootContact {
                obstacle,
                ring: ring_index,
                vertex_of_root,
                obstacle_feature: j as u32,
                root_feature: i as u32,
            };
            if let Some(t) = meet(p, v, q, q1, &ring.normals[j]) {
                out.push((t, contact(true)));
            }
            if let Some(t) = meet(q, &back, p, p1, &body.normals[i]) {
                out.push((t, contact(false)));
            }
        }
    }
}
