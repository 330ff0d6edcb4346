//! Sticking caused by friction (DP §6, §7, §9.3).
//!
//! In a frame whose y-axis is the contact's outward normal, let r = (r_x, r_y) point from the
//! hinge to the contact and ṗ be the hinge's velocity. The paper's sectors I and III, with the
//! sliding direction of eqs. 11 and 17 put in, reduce to one test a type. With d = ṗ·r:
//!
//! * type B: stick ⟺ d > 0 and −μ·r_y > |r_x|, or d < 0 and μ·r_y > |r_x|;
//! * type A: stick ⟺ d > 0 and μ·r_y > |r_x|, or d < 0 and −μ·r_y > |r_x|.
//!
//! *Derivation.* −r = β·n + γ·(n − μσx̂), σ = ±1 the sliding direction, gives γ = r_x/(μσ) and
//! β = −r_y − γ. For type B, s·r_x = ṗ·r, so r_x·σ = |r_x|·sgn d and γ = |r_x|·sgn d/μ; the hinge
//! is in sector I or III when β and γ have one sign. For type A, s·r_x = −ṗ·r turns sgn d round.
//! The cone is open: on the ray f_e itself the contact slides.
//!
//! For type B all of it depends on the orientation alone: three quadratics in x. For type A
//! r_y = e is constant along the curve and r_x² = |r|²·|m|² − e², so all of it depends on time
//! alone: a line and a quadratic in t (DP eqs. 18–21). Neither needs a normalised normal.

use crate::contact::{Contact, ContactKind, Patch, Trig};
use crate::number::{Poly, Rat};
use crate::slice::{ArcId, Shape, Slice, Time};

/// The earliest time t ≥ `from` such that the contact sticks just after t while the state follows
/// the arc; `None` if it slides to the arc's end. `mu` is Coulomb's coefficient.
pub fn stick_time(slice: &Slice, arc: ArcId, from: &Time, mu: &Rat) -> Option<Time> {
    if mu.sign() <= 0 {
        return None;
    }
    let patch = slice.patch(arc)?;
    match patch.contact {
        Contact::Obstacle {
            kind: ContactKind::B,
            ..
        } => type_b(slice, arc, patch, from, mu),
        Contact::Obstacle {
            kind: ContactKind::A,
            ..
        } => type_a(slice, arc, patch, from, mu),
        Contact::Limit(_) => None,
    }
}

/// Walks the gaps between `breaks` from `from` to `end`; the first gap in which `sticks` holds
/// (tested at one rational time inside) begins the sticking.
fn walk(
    from: &Time,
    end: &Time,
    mut breaks: Vec<Time>,
    mut sticks: impl FnMut(&Rat) -> bool,
) -> Option<Time> {
    breaks.retain(|t| t > from && t < end);
    breaks.sort();
    breaks.dedup();
    breaks.push(end.clone());
    let mut begin = from.clone();
    for b in breaks {
        if sticks(&Time::between(&begin, &b)) {
            return Some(begin);
        }
        begin = b;
    }
    None
}

fn type_b(slice: &Slice, id: ArcId, patch: &Patch, from: &Time, mu: &Rat) -> Option<Time> {
    let arc = slice.arc(id);
    let v = &slice.frame.v;
    let a = &patch.ends[0].0;
    let r_y = Trig::new(patch.f0.c.clone(), patch.f0.s.clone(), Rat::zero());
    let r_x = Trig::new(patch.f0.s.clone(), -&patch.f0.c, Rat::zero());
    let d = Trig::new(a.dot(v), a.cross(v), Rat::zero());
    let pull = r_y.scale(&-mu);
    let chart = arc.chart;
    let polys = [d, pull.add(&r_x.neg()), pull.add(&r_x)].map(|t| t.poly(chart));
    let inside = |sign: &dyn Fn(&Poly) -> i32| {
        let [d, minus, plus] = [sign(&polys[0]), sign(&polys[1]), sign(&polys[2])];
        (d > 0 && minus > 0 && plus > 0) || (d < 0 && minus < 0 && plus < 0)
    };
    if arc.shape == Shape::Level {
        return inside(&|p| arc.lo.x.sign_of(p)).then(|| from.clone());
    }
    let mut breaks = Vec::new();
    for p in polys.iter().filter(|p| !p.is_zero()) {
        for x in p.real_roots_in(&Rat::from(-1), &Rat::one()) {
            if arc.spans_x(&x) {
                breaks.push(slice.time_at(arc, &x));
            }
        }
    }
    walk(from, &arc.end().t, breaks, |t| {
        slice
            .height_at(arc, t)
            .is_some_and(|x| inside(&|p| x.sign_of(p)))
    })
}

fn type_a(slice: &Slice, id: ArcId, patch: &Patch, from: &Time, mu: &Rat) -> Option<Time> {
    let v = &slice.frame.v;
    let w = &patch.ends[0].1 - &slice.frame.p0;
    let e = -&patch.f0.k;
    if e.is_zero() {
        return None;
    }
    let speed2 = v.norm2();
    let m2 = (patch.f1.c.square() + patch.f1.s.square()) / &speed2;
    // d(t) = ṗ·r and (1 + μ²)·e² − |r|²·|m|².
    let d = [v.dot(&w), -&speed2];
    let k = [
        (Rat::one() + mu.square()) * e.square() - w.norm2() * &m2,
        (v.dot(&w) + v.dot(&w)) * &m2,
        -(&speed2 * &m2),
    ];
    let (d, k) = (Poly::from_rats(&d), Poly::from_rats(&k));
    let breaks = d
        .real_roots()
        .into_iter()
        .chain(k.real_roots())
        .map(Time::at)
        .collect();
    walk(from, &slice.arc(id).end().t, breaks, |t| {
        d.sign_at(t) * e.sign() > 0 && k.sign_at(t) > 0
    })
}
