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
use crate::kernel::{Filtered, Instant, Kernel, Polynomial, Position};
use crate::number::Scalar;
use crate::slice::{ArcId, Shape, Slice};

/// The earliest time t ≥ `from` such that the contact sticks just after t while the state follows
/// the arc; `None` if it slides to the arc's end. `mu` is Coulomb's coefficient.
pub fn stick_time<K: Kernel>(
    slice: &Slice<K>,
    arc: ArcId,
    from: &K::Time,
    mu: &K::Num,
) -> Option<K::Time> {
    let found = stretches(slice, arc, from, mu, false);
    found.into_iter().find(|s| s.sticks).map(|s| s.from)
}

/// A stretch of an arc along which the contact sticks, or slides, throughout.
#[derive(Clone, Debug)]
pub struct Stretch<K: Kernel = Filtered> {
    /// When it begins.
    pub from: K::Time,
    /// When it ends.
    pub to: K::Time,
    /// Whether friction holds the contact.
    pub sticks: bool,
}

/// The sticking and sliding regions of a whole graph or level, in order of time (DP Prop. 9.5): at most
/// three. One that slides where there is no friction.
pub fn regions<K: Kernel>(slice: &Slice<K>, arc: ArcId, mu: Option<&K::Num>) -> Vec<Stretch<K>> {
    let a = slice.arc(arc);
    let found = match mu {
        Some(mu) => stretches(slice, arc, &a.start().t, mu, true),
        None => Vec::new(),
    };
    let mut out: Vec<Stretch<K>> = Vec::new();
    for s in found {
        match out.last_mut() {
            Some(l) if l.sticks == s.sticks => l.to = s.to,
            _ => out.push(s),
        }
    }
    debug_assert!(out.len() <= 3, "three regions an arc");
    if out.is_empty() {
        out.push(Stretch {
            from: a.start().t.clone(),
            to: a.end().t.clone(),
            sticks: false,
        });
    }
    out
}

/// What sticks and slides from an instant on; up to the first that sticks unless all are wanted.
fn stretches<K: Kernel>(
    slice: &Slice<K>,
    arc: ArcId,
    from: &K::Time,
    mu: &K::Num,
    all: bool,
) -> Vec<Stretch<K>> {
    let Some(patch) = slice.patch(arc).filter(|_| mu.sign() > 0) else {
        return Vec::new();
    };
    match patch.contact {
        Contact::Obstacle {
            kind: ContactKind::B,
            ..
        } => type_b(slice, arc, patch, from, mu, all),
        Contact::Obstacle {
            kind: ContactKind::A,
            ..
        } => type_a(slice, arc, patch, from, mu, all),
        Contact::Limit(_) => Vec::new(),
    }
}

/// Walks the gaps between `breaks` from `from` to `end`; the whether
/// `sticks` holds in each is tested at one rational time inside.
fn walk<K: Kernel>(
    from: &K::Time,
    end: &K::Time,
    mut breaks: Vec<K::Time>,
    all: bool,
    mut sticks: impl FnMut(&K::Num) -> bool,
) -> Vec<Stretch<K>> {
    breaks.retain(|t| t > from && t < end);
    breaks.sort();
    breaks.dedup();
    breaks.push(end.clone());
    let mut begin = from.clone();
    let mut out = Vec::new();
    for b in breaks {
        let sticks = sticks(&K::Time::between(&begin, &b));
        out.push(Stretch {
            from: begin,
            to: b.clone(),
            sticks,
        });
        if sticks && !all {
            break;
        }
        begin = b;
    }
    out
}

fn type_b<K: Kernel>(
    slice: &Slice<K>,
    id: ArcId,
    patch: &Patch<K::Num>,
    from: &K::Time,
    mu: &K::Num,
    all: bool,
) -> Vec<Stretch<K>> {
    let arc = slice.arc(id);
    let v = &slice.frame.v;
    let a = &patch.ends[0].0;
    let r_y = Trig::new(patch.f0.c.clone(), patch.f0.s.clone(), K::Num::zero());
    let r_x = Trig::new(patch.f0.s.clone(), patch.f0.c.negated(), K::Num::zero());
    let d = Trig::new(a.dot(v), a.cross(v), K::Num::zero());
    let pull = r_y.scale(&mu.negated());
    let chart = arc.chart;
    let polys = [d, pull.add(&r_x.neg()), pull.add(&r_x)].map(|t| K::Poly::of(&t.form(chart)));
    let inside = |sign: &dyn Fn(&K::Poly) -> i32| {
        let [d, minus, plus] = [sign(&polys[0]), sign(&polys[1]), sign(&polys[2])];
        (d > 0 && minus > 0 && plus > 0) || (d < 0 && minus < 0 && plus < 0)
    };
    if arc.shape == Shape::Level {
        return vec![Stretch {
            from: from.clone(),
            to: arc.end().t.clone(),
            sticks: inside(&|p| arc.lo.x.sign_of(p)),
        }];
    }
    let mut breaks = Vec::new();
    for p in polys.iter().filter(|p| !p.is_zero()) {
        for x in p.chart_roots() {
            if arc.spans_x(&x) {
                breaks.push(slice.time_at(arc, &x));
            }
        }
    }
    walk::<K>(from, &arc.end().t, breaks, all, |t| {
        slice
            .height_at(arc, t)
            .is_some_and(|x| inside(&|p| x.sign_of(p)))
    })
}

fn type_a<K: Kernel>(
    slice: &Slice<K>,
    id: ArcId,
    patch: &Patch<K::Num>,
    from: &K::Time,
    mu: &K::Num,
    all: bool,
) -> Vec<Stretch<K>> {
    let v = &slice.frame.v;
    let w = &patch.ends[0].1 - &slice.frame.p0;
    let e = patch.f0.k.negated();
    if e.is_zero() {
        return Vec::new();
    }
    let speed2 = v.norm2();
    let m2 = patch.f1.c.square().plus(&patch.f1.s.square()).over(&speed2);
    // d(t) = ṗ·r and (1 + μ²)·e² − |r|²·|m|².
    let along = v.dot(&w);
    let d = [along.clone(), speed2.negated()];
    let held = K::Num::one().plus(&mu.square()).times(&e.square());
    let k = [
        held.minus(&w.norm2().times(&m2)),
        along.plus(&along).times(&m2),
        speed2.times(&m2).negated(),
    ];
    let (d, k) = (K::Poly::of(&d), K::Poly::of(&k));
    let breaks = d
        .roots()
        .into_iter()
        .chain(k.roots())
        .map(K::Time::at)
        .collect();
    walk::<K>(from, &slice.arc(id).end().t, breaks, all, |t| {
        d.sign_at(t) * e.sign() > 0 && k.sign_at(t) > 0
    })
}
