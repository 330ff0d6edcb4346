//! What the drive has to do: the loads of all pawls together, phase by phase.
//!
//! The ends of all parts ([`super::load`]) cut a phase into windows in which the same contacts
//! slide throughout. Inside a window every load is smooth. Its extremes are enclosed by branch
//! and bound: a cell on which a slope has one sign is decided by its ends, one that cannot beat
//! what is attained is dropped, any other is halved. With one contact the cells are cells of its
//! position, with several they are cells of time. What the loads add up to along the way, the work,
//! is integrated in `work`.

use super::fix::{Bits, Fix};
use super::load::{Load, Part, Rig};
use super::peak::Peak;
use crate::number::Rat;
use crate::slice::Time;

/// What is maximised: the resistance, what the pawls help, the squared force, the torque either way.
const QUANTITIES: usize = 5;

/// The extremes over a phase, each an enclosure of a supremum.
#[derive(Clone, Debug)]
pub(super) struct Extremes {
    /// Of −f·ṗ/|ṗ|, at least 0.
    pub(super) resistance: Peak,
    /// Of f·ṗ/|ṗ|, at least 0.
    pub(super) help: Peak,
    /// Of |f|.
    pub(super) force: Peak,
    /// Of the torque about the reference point, either way round.
    pub(super) torque: Peak,
    /// About when the resistance peaks: between two instants of the phase.
    pub(super) when: Option<[Rat; 2]>,
}

/// One sliding part with what it needs to know of its pawl.
pub(super) struct Slide<'a> {
    pub(super) part: Part<'a>,
    pub(super) rig: &'a Rig,
    /// A bound of the contact force over its stretch; None where there is none.
    pub(super) bound: Option<Rat>,
    /// Whether the contact force over its stretch is proven to have no bound.
    pub(super) unbounded: bool,
}

/// A window: the same slides throughout.
struct Window<'a> {
    t: [Time; 2],
    slides: Vec<&'a Slide<'a>>,
}

fn windows<'a>(slides: &'a [Slide<'a>]) -> Vec<Window<'a>> {
    let mut breaks: Vec<Time> = slides.iter().flat_map(|s| s.part.t.clone()).collect();
    breaks.sort();
    breaks.dedup();
    let on = |t: &Time, u: &Time| -> Vec<&'a Slide<'a>> {
        let holds = |s: &&Slide<'_>| s.part.t[0] <= *t && *u <= s.part.t[1];
        slides.iter().filter(holds).collect()
    };
    breaks
        .windows(2)
        .map(|w| Window {
            slides: on(&w[0], &w[1]),
            t: [w[0].clone(), w[1].clone()],
        })
        .filter(|w| !w.slides.is_empty())
        .collect()
}

/// An instant, enclosed.
fn at(t: &Time, b: Bits) -> Fix {
    match t.as_rat() {
        Some(r) => b.rat(r),
        None => {
            let (lo, hi) = t.exact().enclosure(b.0 as u32);
            b.hull(&lo, &hi)
        }
    }
}

/// Values and slopes of the five quantities.
type Five = [(Fix, Option<Fix>); QUANTITIES];

/// The five quantities of some loads together, with their slopes: by their own variable where one
/// is alone, else by time.
fn summed(loads: &[Load], b: Bits) -> Five {
    let single = loads.len() == 1;
    let zero = || (b.int(0), Some(b.int(0)));
    let mut sum = [zero(), zero(), zero(), zero()];
    for l in loads {
        let rate = l.clock.order(1);
        for (total, q) in sum
            .iter_mut()
            .zip([&l.resistance, &l.force[0], &l.force[1], &l.torque])
        {
            total.0 = total.0.add(&q.order(0));
            // By its own variable where it is alone, else by time.
            let slope = if single {
                Some(q.order(1))
            } else {
                q.order(1).div(&rate)
            };
            total.1 = total.1.as_ref().zip(slope).map(|(a, s)| a.add(&s));
        }
    }
    let [(w, dw), (x, dx), (y, dy), (m, dm)] = sum;
    let square = x.mul(&x).add(&y.mul(&y));
    let two = b.int(2);
    let slope = dx
        .zip(dy)
        .map(|(dx, dy)| x.mul(&dx).add(&y.mul(&dy)).mul(&two));
    let minus = |d: &Option<Fix>| d.as_ref().map(Fix::neg);
    [
        (w.clone(), dw.clone()),
        (w.neg(), minus(&dw)),
        (square, slope),
        (m.clone(), dm.clone()),
        (m.neg(), minus(&dm)),
    ]
}

impl Window<'_> {
    /// The variable of its cells at both ends: the position of the only contact, or time.
    fn ends(&self, b: Bits) -> Option<[Fix; 2]> {
        let end = |late: bool| {
            let t = &self.t[usize::from(late)];
            match &self.slides[..] {
                [s] if *t == s.part.t[usize::from(late)] => Some(s.part.end(late, b)),
                [s] => s.part.place(&at(t, b), b),
                _ => Some(at(t, b)),
            }
        };
        Some([end(false)?, end(true)?])
    }

    /// The loads over a cell of the variable.
    fn loads(&self, cell: [&Fix; 2], n: usize, b: Bits) -> Option<Vec<Load>> {
        if let [s] = &self.slides[..] {
            return Some(vec![s.part.load(&cell[0].join(cell[1]), s.rig, n, b)?]);
        }
        self.slides
            .iter()
            .map(|s| {
                // The position is monotone in time.
                let (a, z) = (s.part.place(cell[0], b)?, s.part.place(cell[1], b)?);
                s.part.load(&a.join(&z), s.rig, n, b)
            })
            .collect()
    }

    fn five(&self, cell: [&Fix; 2], b: Bits) -> Option<Five> {
        Some(summed(&self.loads(cell, 2, b)?, b))
    }

    /// The five quantities over a sliver beside an end at which contacts are on the edge of their
    /// cones with the spring at rest: a single one, or some of several.
    fn beside(&self, late: bool, place: &Fix, b: Bits) -> Option<Five> {
        let end = &self.t[usize::from(late)];
        let ends_here = |s: &Slide<'_>| *end == s.part.t[usize::from(late)];
        if let [s] = &self.slides[..] {
            let load = ends_here(s).then(|| s.part.sliver(late, place, s.rig, b))?;
            return Some(summed(&[load?], b));
        }
        let each = self.slides.iter().map(|s| {
            let near = s.part.place(place, b)?;
            if ends_here(s)
                && let Some(load) = s.part.sliver(late, &near, s.rig, b)
            {
                return Some(load);
            }
            let x = s.part.place(&at(end, b), b)?.join(&near);
            s.part.load(&x, s.rig, 2, b)
        });
        let loads: Vec<Load> = each.collect::<Option<_>>()?;
        Some(summed(&loads, b))
    }

    /// Upper bounds of the five quantities over a cell where some balance may be singular; None
    /// for one that may grow past every bound.
    fn tops(&self, cell: [&Fix; 2], b: Bits) -> Option<[Option<Rat>; QUANTITIES]> {
        let mut sum = [(); 4].map(|()| Some(Rat::zero()));
        for s in &self.slides {
            let x = match &self.slides[..] {
                [_] => cell[0].join(cell[1]),
                _ => s.part.place(cell[0], b)?.join(&s.part.place(cell[1], b)?),
            };
            let tops = match s.part.load(&x, s.rig, 1, b) {
                Some(l) => {
                    let (w, m) = (l.resistance.order(0), l.torque.order(0));
                    [w.hi(), -w.lo(), m.hi(), -m.lo()].map(Some)
                }
                None => s.part.tops(&x, s.rig, b)?,
            };
            for (total, top) in sum.iter_mut().zip(tops) {
                *total = total.as_ref().zip(top).map(|(a, t)| a + &t);
            }
        }
        let [w, help, m, back] = sum;
        Some([w, help, None, m, back])
    }

    /// The time of a place of the variable.
    fn time(&self, x: &Fix, b: Bits) -> Option<[Rat; 2]> {
        let t = match &self.slides[..] {
            [s] => s.part.load(x, s.rig, 1, b)?.clock.order(0),
            _ => x.clone(),
        };
        Some([t.lo(), t.hi()])
    }
}

struct Best {
    lo: Rat,
    hi: Rat,
    unbounded: bool,
    when: Option<[Rat; 2]>,
}

impl Best {
    fn attain(&mut self, v: &Fix, when: impl FnOnce() -> Option<[Rat; 2]>) {
        let lo = v.lo();
        if lo > self.lo {
            self.lo = lo;
            self.when = when();
        }
        let hi = v.hi();
        if hi > self.hi {
            self.hi = hi;
        }
    }
    fn peak(&self) -> Peak {
        if self.unbounded {
            Peak::Unbounded
        } else {
            Peak::Within(self.lo.clone(), self.hi.clone())
        }
    }
}

/// Narrow enough.
fn close(lo: &Rat, hi: &Rat, goal: u32) -> bool {
    hi <= lo || (hi - lo) * Rat::from(2).pow(goal) <= *lo
}

/// The extremes over all slides of one phase, within a relative 2^-goal where the search settles
/// within its budget, and before `stop` says that the time is up; always enclosed.
pub(super) fn extremes(slides: &[Slide<'_>], goal: u32, stop: &dyn Fn() -> bool) -> Extremes {
    let fine = Bits(u64::from(goal) + 40);
    let mut best: Vec<Best> = (0..QUANTITIES)
        .map(|_| Best {
            lo: Rat::zero(),
            hi: Rat::zero(),
            unbounded: false,
            when: None,
        })
        .collect();
    for w in &windows(slides) {
        search(w, goal, fine, &mut best, stop);
    }
    let root = |p: Peak| match p {
        Peak::Unbounded => Peak::Unbounded,
        Peak::Within(lo, hi) => {
            let b = Bits(2 * fine.0);
            let end = |r: &Rat| b.rat(r).sqrt().unwrap_or_else(|| b.int(0));
            Peak::Within(end(&lo).lo(), end(&hi).hi())
        }
    };
    Extremes {
        when: best[0].when.clone(),
        resistance: best[0].peak(),
        help: best[1].peak(),
        force: root(best[2].peak()),
        torque: best[3].peak().max(best[4].peak()),
    }
}

fn search(w: &Window<'_>, goal: u32, fine: Bits, best: &mut [Best], stop: &dyn Fn() -> bool) {
    let Some(ends) = w.ends(fine) else {
        return unsettled(w, best);
    };
    let (mut l, mut r) = (ends[0].hi(), ends[1].lo());
    let forward = l <= r;
    if !forward {
        (l, r) = (ends[1].hi(), ends[0].lo());
    }
    // Loads grow past every bound only towards an end; where the contact begins on the edge of
    // its cone they jump there, and stay finite.
    let mut singular = false;
    let sliver = (&r - &l) * Rat::from(2).pow(goal + 8).recip();
    for (late, e) in ends.iter().enumerate() {
        let low = (late == 0) == forward;
        let place = if low { &l + &sliver } else { &r - &sliver };
        let five = w.five([e, e], fine).or_else(|| {
            let five = w.beside(late == 1, &fine.rat(&place), fine)?;
            *if low { &mut l } else { &mut r } = place;
            Some(five)
        });
        match five {
            Some(five) => {
                for (k, v) in five.iter().enumerate() {
                    best[k].attain(&v.0, || w.time(e, fine));
                }
            }
            None => singular = true,
        }
    }
    if l >= r {
        return;
    }
    let mut skipped = [false; QUANTITIES];
    if singular {
        let limit = w.slides.iter().any(|s| s.bound.is_none());
        if !limit {
            return unsettled(w, best);
        }
        // Which way it grows shows well before the end.
        let near = [(&l, &r), (&r, &l)].map(|(end, other)| {
            let step = (other - end) * Rat::from(2).pow(20).recip();
            fine.rat(&(end + &step))
        });
        for (x, end) in near.iter().zip([&l, &r]) {
            let Some(tops) = w.tops([x, &fine.rat(end)], fine) else {
                return unsettled(w, best);
            };
            let five = w.five([x, x], fine);
            for (k, _) in tops.iter().enumerate().filter(|(_, t)| t.is_none()) {
                let grows = five.as_ref().is_none_or(|f| f[k].0.lo().sign() > 0);
                best[k].unbounded |= grows;
            }
        }
        skipped = [0, 1, 2, 3, 4].map(|k| best[k].unbounded);
    }
    let coarse = Bits(fine.0.min(56));
    let mut budget = 3000;
    let mut cells = vec![(l, r, 0u32, skipped)];
    while let Some((l, r, depth, mut done)) = cells.pop() {
        budget -= 1;
        if stop() {
            budget = 0;
        }
        let b = if depth < 12 { coarse } else { fine };
        let cell = [b.rat(&l), b.rat(&r)];
        let five = w.five([&cell[0], &cell[1]], b);
        let tops: Option<[Option<Rat>; QUANTITIES]> = match &five {
            Some(f) => Some(f.each_ref().map(|v| Some(v.0.hi()))),
            None => w.tops([&cell[0], &cell[1]], b),
        };
        if five.is_none()
            && let Some(tops) = &tops
        {
            for (k, top) in tops.iter().enumerate() {
                let Some(top) = top else { continue };
                if *top <= best[k].lo || close(&best[k].lo, top, goal + 2) {
                    best[k].hi = best[k].hi.clone().max(top.clone());
                    done[k] = true;
                }
            }
        }
        if let Some(five) = &five {
            let mut ends: Option<[Option<Five>; 2]> = None;
            for (k, v) in five.iter().enumerate() {
                if done[k] {
                    continue;
                }
                let (value, slope) = v;
                if value.hi() <= best[k].lo || close(&best[k].lo, &value.hi(), goal + 2) {
                    best[k].hi = best[k].hi.clone().max(value.hi());
                    done[k] = true;
                } else if slope.as_ref().is_some_and(|s| s.sign().is_some()) {
                    let both = ends.get_or_insert_with(|| {
                        [&l, &r].map(|x| {
                            let x = fine.rat(x);
                            w.five([&x, &x], fine)
                        })
                    });
                    let mut whole = true;
                    for (x, f) in [&l, &r].into_iter().zip(both.iter()) {
                        match f {
                            Some(f) => best[k].attain(&f[k].0, || w.time(&fine.rat(x), fine)),
                            None => whole = false,
                        }
                    }
                    done[k] = whole;
                }
            }
        }
        if done.iter().all(|d| *d) {
            continue;
        }
        let mid = Rat::midpoint(&l, &r);
        let x = b.rat(&mid);
        if let Some(centre) = w.five([&x, &x], b) {
            let half = b.rat(&(&r - &mid));
            for k in 0..QUANTITIES {
                if done[k] {
                    continue;
                }
                // Only what is attained: the top of an inner point bounds nothing else.
                if centre[k].0.lo() > best[k].lo {
                    best[k].attain(&centre[k].0, || w.time(&x, b));
                }
                // The mean value form is the narrower one on small cells.
                let slope = five.as_ref().and_then(|f| f[k].1.as_ref());
                let Some(slope) = slope else { continue };
                let top = centre[k].0.add(&slope.abs().mul(&half)).hi();
                if top <= best[k].lo || close(&best[k].lo, &top, goal + 2) {
                    best[k].hi = best[k].hi.clone().max(top);
                    done[k] = true;
                }
            }
        }
        if done.iter().all(|d| *d) {
            continue;
        }
        let spent = budget <= 0 || u64::from(depth) + 8 > fine.0;
        if spent {
            match tops {
                Some(tops) => {
                    for k in (0..QUANTITIES).filter(|k| !done[*k]) {
                        match &tops[k] {
                            Some(top) => best[k].hi = best[k].hi.clone().max(top.clone()),
                            None => best[k].unbounded = true,
                        }
                    }
                }
                None => unsettled(w, best),
            }
            continue;
        }
        cells.push((l, mid.clone(), depth + 1, done));
        cells.push((mid, r, depth + 1, done));
    }
}

/// Where nothing finer is known: no load is larger than the sum of the contacts' bounds.
fn unsettled(w: &Window<'_>, best: &mut [Best]) {
    let mut force = Rat::zero();
    let mut turn = Rat::zero();
    for s in &w.slides {
        let Some(bound) = &s.bound else {
            best.iter_mut().for_each(|b| b.unbounded = true);
            return;
        };
        force += bound;
        let arm = &s.rig.arm;
        turn += &(bound * &(arm.x.abs() + arm.y.abs()));
        let b = Bits(32);
        let end = |late| s.part.angle(&s.part.end(late, b), b).abs().hi();
        turn += &(end(false).max(end(true)) * &s.rig.stiffness);
    }
    let square = force.square();
    for (k, top) in [&force, &force, &square, &turn, &turn]
        .into_iter()
        .enumerate()
    {
        best[k].hi = best[k].hi.clone().max(top.clone());
    }
}

/// The loads of all slides together at an instant of a phase (with their sum where several
/// pawls slide); None where a load may be singular.
pub(super) struct Instantaneous {
    /// Force on the root.
    pub(super) force: [Fix; 2],
    /// Torque about its reference point.
    pub(super) torque: Fix,
    /// Against the travel.
    pub(super) resistance: Fix,
    /// A slide's index, θ and contact force.
    pub(super) pawls: Vec<(usize, Fix, Fix)>,
}

/// The loads at a rational instant of a phase; where a window ends there, those just after.
pub(super) fn instant(slides: &[Slide<'_>], t: &Rat, b: Bits) -> Option<Instantaneous> {
    let mut out = Instantaneous {
        force: [b.int(0), b.int(0)],
        torque: b.int(0),
        resistance: b.int(0),
        pawls: Vec::new(),
    };
    let spans = |s: &Slide<'_>| s.part.t[0].cmp_rat(t).is_le() && s.part.t[1].cmp_rat(t).is_gt();
    for (i, s) in slides.iter().enumerate().filter(|(_, s)| spans(s)) {
        let x = if s.part.t[0].cmp_rat(t).is_eq() {
            s.part.end(false, b)
        } else {
            s.part.place(&b.rat(t), b)?
        };
        let l = s.part.load(&x, s.rig, 1, b)?;
        out.force = [0, 1].map(|k| out.force[k].add(&l.force[k].order(0)));
        out.torque = out.torque.add(&l.torque.order(0));
        out.resistance = out.resistance.add(&l.resistance.order(0));
        out.pawls.push((i, s.part.angle(&x, b), l.size.order(0)));
    }
    Some(out)
}

/// Resistance over time in doubles, for pictures: runs of points, one a window.
pub(super) fn trace(slides: &[Slide<'_>], points: usize) -> Vec<Vec<[f64; 2]>> {
    let b = Bits(64);
    let middle = |r: [Rat; 2]| {
        let [lo, hi] = r.map(|r| r.nearest_f64().unwrap_or(f64::NAN));
        0.5 * (lo + hi)
    };
    windows(slides)
        .iter()
        .filter_map(|w| {
            let [l, r] = w.ends(b)?;
            let (l, r) = (
                Rat::midpoint(&l.lo(), &l.hi()),
                Rat::midpoint(&r.lo(), &r.hi()),
            );
            let at = |k: usize| {
                // Dense towards both ends, where a load may rise steeply.
                let share = 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / points as f64).cos();
                let x = &l + &(&(&r - &l) * &Rat::from_f64(share));
                let x = b.rat(&x);
                let loads = w.loads([&x, &x], 1, b)?;
                let sum = loads
                    .iter()
                    .fold(b.int(0), |s, l| s.add(&l.resistance.order(0)));
                let t = w.time(&x, b)?;
                Some([middle(t), middle([sum.lo(), sum.hi()])])
            };
            Some((0..=points).filter_map(at).collect())
        })
        .collect()
}
