//! The work of the drive along a sliding part, as an enclosure.
//!
//! Without friction all of it is spring energy, known from the two ends. With friction the power
//! is integrated over the position of the contact: cells by Taylor sums with certified remainders,
//! halved where a sum is too wide, as it always is near an end where the balance is singular. Where
//! the spring is wound there, the contact force grows like 1/(distance) and its
//! integral past every bound; where it is at rest there, the quotient is a finite one.

use super::drive::Slide;
use super::fix::{Bits, Fix};
use crate::number::Rat;
use crate::slice::Time;

/// The work of the drive.
#[derive(Clone, Debug)]
pub(super) enum Work {
    /// Between two rational numbers.
    Within([Rat; 2]),
    /// It grows past every bound towards this instant of the phase.
    Unbounded(Time),
    /// Not settled within the budget or the time.
    Open,
}

impl Work {
    /// Nothing done.
    pub(super) fn zero() -> Work {
        Work::Within([Rat::zero(), Rat::zero()])
    }
    /// The sum: past every bound if one of them is (work against friction is never regained).
    pub(super) fn plus(self, o: Work) -> Work {
        match (self, o) {
            (Work::Unbounded(t), _) | (_, Work::Unbounded(t)) => Work::Unbounded(t),
            (Work::Within([a, b]), Work::Within([c, d])) => Work::Within([a + c, b + d]),
            _ => Work::Open,
        }
    }
}

/// The order at which the Taylor sums that integrate the work are cut off: even, and the higher
/// the more bits are asked for, so that the cells need not be ever smaller instead.
fn order(goal: u32) -> usize {
    (8 + 2 * (goal as usize / 16)).min(64)
}

/// The work of the drive along a slide, as an enclosure about 2^-goal wide relative to the largest
/// spring energy; [`Work::Open`] where that takes too many cells or `stop` says that the time is up.
pub(super) fn work(s: &Slide<'_>, goal: u32, stop: &dyn Fn() -> bool) -> Work {
    if s.part.stretch.touch.is_none() {
        return Work::zero();
    }
    let b = Bits(u64::from(goal) + 64);
    let ends = [s.part.end(false, b), s.part.end(true, b)];
    let k = b.rat(&(&s.rig.stiffness * &Rat::frac(1, 2)));
    let energy = |x: &Fix| {
        let a = s.part.angle(x, b);
        a.mul(&a).mul(&k)
    };
    let (first, last) = (energy(&ends[0]), energy(&ends[1]));
    if s.rig.mu.is_zero() {
        let stored = last.sub(&first);
        return Work::Within([stored.lo(), stored.hi()]);
    }
    rubbed(s, &ends, first.hi().max(last.hi()), goal, b, stop)
}

/// The work of a slide with friction; `largest` bounds the spring energy.
fn rubbed(
    s: &Slide<'_>,
    ends: &[Fix; 2],
    largest: Rat,
    goal: u32,
    b: Bits,
    stop: &dyn Fn() -> bool,
) -> Work {
    let fineness = Rat::from(2).pow(goal + 3).recip();
    let tolerance = &largest * &fineness;
    let forward = ends[0].lo() <= ends[1].lo();
    let (mut l, mut r) = if forward {
        (ends[0].hi(), ends[1].lo())
    } else {
        (ends[1].hi(), ends[0].lo())
    };
    let whole = &r - &l;
    let mut sum = b.int(0);
    for (late, e) in ends.iter().enumerate() {
        if let Some(at) = s.part.load(e, s.rig, 2, b) {
            // An end is known to the precision only.
            let width = b.rat(&(e.hi() - e.lo()));
            sum = sum.add(&at.work.order(0).mul(&width).join(&b.int(0)));
            continue;
        }
        if s.unbounded {
            return match s.part.diverges(e, s.rig, b) {
                true => Work::Unbounded(s.part.t[late].clone()),
                false => Work::Open,
            };
        }
        let step = &whole * Rat::from(2).pow(goal / 2 + 8).recip();
        let low = (late == 0) == forward;
        let place = if low { &l + &step } else { &r - &step };
        let Some(near) = s.part.sliver(late == 1, &b.rat(&place), s.rig, b) else {
            return Work::Open;
        };
        let bit = near.work.order(0).mul(&b.rat(&place).sub(e));
        sum = sum.add(&if low { bit } else { bit.neg() });
        *if low { &mut l } else { &mut r } = place;
    }
    let mut cells = vec![(l, r)];
    let mut budget = 3000;
    while let Some((l, r)) = cells.pop() {
        if l >= r {
            continue;
        }
        budget -= 1;
        if stop() {
            return Work::Open;
        }
        let mid = Rat::midpoint(&l, &r);
        let got = integral(s, [&l, &mid, &r], order(goal), b).filter(|v| {
            // Its share of the error by length, by what it contributes, or as one of many.
            let share = &tolerance * &(&(&r - &l) / &whole);
            let own = v.abs().lo() * &fineness;
            let few = &tolerance * &Rat::frac(1, 256);
            v.hi() - v.lo() <= share.max(own).max(few)
        });
        match got {
            Some(v) => sum = sum.add(&v),
            None if budget <= 0 => {
                let cell = b.hull(&l, &r);
                let grown = s.unbounded && s.part.diverges(&cell, s.rig, b);
                let at = &s.part.t[usize::from(forward)];
                return match grown {
                    true => Work::Unbounded(at.clone()),
                    false => Work::Open,
                };
            }
            None => {
                cells.push((l, mid.clone()));
                cells.push((mid, r));
            }
        }
    }
    let signed = if forward { sum } else { sum.neg() };
    Work::Within([signed.lo(), signed.hi()])
}

/// The work over a cell [l, r] of the position about its middle: the Taylor sum of the power in
/// units of half the cell, whose last term is taken over the whole cell.
fn integral(s: &Slide<'_>, [l, mid, r]: [&Rat; 3], order: usize, b: Bits) -> Option<Fix> {
    let pace = b.rat(&(r - mid));
    let over = s.part.load_at(&b.hull(l, r), &pace, s.rig, order + 2, b)?;
    let point = s.part.load_at(&b.rat(mid), &pace, s.rig, order + 1, b)?;
    // Odd powers integrate to nothing; the last order is even, so its power has one sign.
    let by = |k: usize| b.rat(&Rat::frac(2, k as i64 + 1));
    let rest = over.work.order(order).mul(&by(order));
    let terms = (0..order).step_by(2);
    Some(terms.fold(rest, |sum, k| sum.add(&point.work.order(k).mul(&by(k)))))
}
