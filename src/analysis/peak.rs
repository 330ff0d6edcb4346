//! The highest contact force along a stretch, certified (DP App. A, and where it fails).
//!
//! Prop. A.1 says that the force peaks at an end of a stretch; that fails for type A, and for type
//! B needs a cut where the sliding reverses. So nothing is assumed: the stretch is cut at the roots
//! of d, and each part is searched (`slope`). Doubles with proven bounds settle what
//! they can; numbers of any width settle the rest.

use super::climb::Spot;
use super::fix::{Bits, Fix};
use super::qpoly::QPoly;
use super::rough;
use super::slope::Part;
use super::stretch::{Law, Stretch};
use crate::number::{Algebraic, Interval, Rat};
use crate::slice::Time;

/// A supremum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Peak {
    /// Past every bound.
    Unbounded,
    /// Between two rational numbers.
    Within(Rat, Rat),
}

impl Peak {
    /// Nothing pushes.
    pub fn zero() -> Peak {
        Peak::Within(Rat::zero(), Rat::zero())
    }
    /// The larger one: of two enclosed suprema that of their maximum.
    pub fn max(self, o: Peak) -> Peak {
        match (self, o) {
            (Peak::Within(a, b), Peak::Within(c, d)) => Peak::Within(a.max(c), b.max(d)),
            _ => Peak::Unbounded,
        }
    }
    /// Whether it is certainly at least `limit` (Some(true)), certainly below (Some(false)).
    pub fn reaches(&self, limit: &Rat) -> Option<bool> {
        match self {
            Peak::Unbounded => Some(true),
            Peak::Within(lo, _) if lo >= limit => Some(true),
            Peak::Within(_, hi) if hi < limit => Some(false),
            Peak::Within(..) => None,
        }
    }
}

/// Where a supremum is attained, or approached.
#[derive(Clone, Debug)]
pub enum Instant {
    /// At an end of a part: exactly known.
    At(Time),
    /// Inside: between two rational times at one of which at least the lower bound is attained.
    Between(Rat, Rat),
}

/// A peak with its instant, counted from the start of the phase.
#[derive(Clone, Debug)]
pub struct Peaked {
    /// How high.
    pub peak: Peak,
    /// When.
    pub when: Instant,
}

/// Narrow enough: relative width at most 2^-goal.
pub(super) fn narrow(lo: &Rat, hi: &Rat, goal: u32) -> bool {
    (hi - lo) * Rat::from(2).pow(goal) <= *lo
}

/// A positive value in doubles, where they hold it narrowly enough.
fn settled(v: Interval, goal: u32) -> Option<(Rat, Rat)> {
    if !(v.is_finite() && v.lo > 0.0) {
        return None;
    }
    let (lo, hi) = (Rat::from_f64(v.lo), Rat::from_f64(v.hi));
    narrow(&lo, &hi, goal).then_some((lo, hi))
}

/// The largest torque k|θ| of a stretch: θ is monotone, so it is attained at an end.
pub fn torque(s: &Stretch, stiffness: &Rat, goal: u32) -> Peaked {
    let (s0, s1) = (&s.x[0], &s.x[1]);
    // |θ| grows with x on the upper side.
    let late = (s1 >= s0) == (s.side >= 0);
    let (x, when) = if late { (s1, &s.t[1]) } else { (s0, &s.t[0]) };
    let when = Instant::At(when.clone());
    if s.half_turn == 0 && x.sign() == 0 {
        return Peaked {
            peak: Peak::zero(),
            when,
        };
    }
    let rough = rough::theta(&x.interval(), s.half_turn);
    let rough = if s.side < 0 { -rough } else { rough };
    if let Some((lo, hi)) = settled(rough * stiffness.interval(), goal) {
        return Peaked {
            peak: Peak::Within(lo, hi),
            when,
        };
    }
    let mut n = 64 + u64::from(goal);
    loop {
        let b = Bits(n);
        let (lo, hi) = x.enclosure(n as u32);
        let v = theta(&b.hull(&lo, &hi), s.half_turn, b)
            .abs()
            .mul(&b.rat(stiffness));
        let (lo, hi) = (v.lo(), v.hi());
        if narrow(&lo, &hi, goal) || n > 1 << 16 {
            return Peaked {
                peak: Peak::Within(lo.max(Rat::zero()), hi),
                when,
            };
        }
        n *= 2;
    }
}

pub(super) fn theta(x: &Fix, half_turn: i64, b: Bits) -> Fix {
    let turned = x.atan().mul(&b.int(2));
    if half_turn == 0 {
        return turned;
    }
    turned.add(&b.pi().mul(&b.int(half_turn)))
}

/// The supremum of the contact force over a stretch, within a relative 2^-goal.
pub fn force(s: &Stretch, stiffness: &Rat, mu: &Rat, goal: u32) -> Peaked {
    match &s.law {
        Law::Stop => Peaked {
            peak: Peak::zero(),
            when: Instant::At(s.t[0].clone()),
        },
        Law::Level { .. } => level(s, stiffness, mu, goal),
        Law::Graph {
            turn,
            rise,
            den,
            drag,
            clock,
            epsilon,
            normal2,
        } => {
            let (lo, hi) = if s.x[0] <= s.x[1] {
                (&s.x[0], &s.x[1])
            } else {
                (&s.x[1], &s.x[0])
            };
            let mut cuts = vec![lo.clone(), hi.clone()];
            let drag = drag.poly();
            if mu.sign() > 0 && !drag.is_zero() && lo != hi {
                let roots = drag.real_roots_in(&Rat::from(-1), &Rat::one());
                cuts.extend(roots.into_iter().filter(|x| lo < x && x < hi));
                cuts.sort();
            }
            let mut best: Option<Peaked> = None;
            for part in cuts.windows(2) {
                let sample = match part[0] == part[1] {
                    true => None,
                    false => Some(Algebraic::between(&part[0], &part[1])),
                };
                let sign = |p: &crate::number::Poly| match &sample {
                    Some(r) => p.sign_at(r),
                    None => part[0].sign_of(p),
                };
                let rub = mu * &Rat::from(i64::from(epsilon * sign(&drag)));
                let away = Rat::from(i64::from(sign(&turn.poly())));
                let part = Part::new(
                    [part[0].clone(), part[1].clone()],
                    s.half_turn,
                    den.clone(),
                    turn.scale(&away).add(&rise.scale(&rub)),
                    stiffness.square() * (Rat::one() + mu.square()) * normal2,
                    goal,
                );
                let (peak, at) = part.supremum();
                let when = match at {
                    Spot::End(k) if part.ends[k] == s.x[0] => Instant::At(s.t[0].clone()),
                    Spot::End(k) if part.ends[k] == s.x[1] => Instant::At(s.t[1].clone()),
                    Spot::End(k) => {
                        let (p, q) = QPoly::pair(&clock.0.scale(&Rat::from(-1)), &clock.1);
                        Instant::At(Time::ratio(&part.ends[k], p, q))
                    }
                    Spot::Inside(a, b) => {
                        let at = |x: &Rat| -(clock.0.eval(x) / clock.1.eval(x));
                        let (a, b) = (at(&a), at(&b));
                        Instant::Between(a.clone().min(b.clone()), a.max(b))
                    }
                };
                best = Some(higher(best, Peaked { peak, when }));
            }
            best.unwrap_or_else(|| Peaked {
                peak: Peak::zero(),
                when: Instant::At(s.t[0].clone()),
            })
        }
    }
}

/// The higher of two peaks, enclosing the maximum of both.
pub(super) fn higher(a: Option<Peaked>, b: Peaked) -> Peaked {
    let Some(a) = a else {
        return b;
    };
    let second = match (&a.peak, &b.peak) {
        (Peak::Unbounded, _) => false,
        (_, Peak::Unbounded) => true,
        (Peak::Within(x, _), Peak::Within(y, _)) => y > x,
    };
    Peaked {
        when: if second { b.when } else { a.when },
        peak: a.peak.max(b.peak),
    }
}

/// Type A at constant θ: the denominator √S ± μ·e is monotone on each side of d = 0.
fn level(s: &Stretch, stiffness: &Rat, mu: &Rat, goal: u32) -> Peaked {
    let Law::Level {
        turn2,
        e,
        drag,
        normal2,
    } = &s.law
    else {
        return Peaked {
            peak: Peak::zero(),
            when: Instant::At(s.t[0].clone()),
        };
    };
    let [from, to] = &s.t;
    let mut cuts = vec![from.exact().clone(), to.exact().clone()];
    if let [c0, c1] = &drag.0[..] {
        let turn: Algebraic = (-(c0 / c1)).into();
        if cuts[0] < turn && turn < cuts[1] {
            cuts.insert(1, turn);
        }
    }
    let (num, den) = QPoly::pair(turn2, &QPoly(vec![Rat::one()]));
    let mut best: Option<Peaked> = None;
    for part in cuts.windows(2) {
        let sign = drag.eval(&Algebraic::between(&part[0], &part[1])).sign();
        let rub = -(mu * e) * Rat::from(i64::from(sign));
        for t in part {
            let s2 = t.ratio(&num, &den);
            // √S + rub = 0 exactly?
            let zero = rub.sign() <= 0 && s2.cmp_rat(&rub.square()).is_eq();
            let peak = if zero {
                Peak::Unbounded
            } else {
                level_value(s, &s2, &rub, &(stiffness, mu, normal2), goal)
            };
            let when = Instant::At(Time::at(t.clone()));
            best = Some(higher(best, Peaked { peak, when }));
        }
    }
    best.unwrap_or_else(|| Peaked {
        peak: Peak::zero(),
        when: Instant::At(from.clone()),
    })
}

fn level_value(
    s: &Stretch,
    s2: &Algebraic,
    rub: &Rat,
    (stiffness, mu, normal2): &(&Rat, &Rat, &Rat),
    goal: u32,
) -> Peak {
    let scale2 = stiffness.square() * (Rat::one() + mu.square()) * *normal2;
    let lever = rough::theta(&s.x[0].interval(), s.half_turn);
    let lever = if s.side < 0 { -lever } else { lever };
    let rough = scale2.interval().sqrt() * lever / (s2.interval().sqrt() + rub.interval());
    if let Some((lo, hi)) = settled(rough, goal) {
        return Peak::Within(lo, hi);
    }
    let mut n = 64 + u64::from(goal);
    loop {
        let b = Bits(n);
        let (xl, xh) = s.x[0].enclosure(n as u32);
        let (sl, sh) = s2.enclosure(n as u32);
        let lever = theta(&b.hull(&xl, &xh), s.half_turn, b).abs();
        let value = b
            .rat(&scale2)
            .sqrt()
            .and_then(|k| Some((k, b.hull(&sl, &sh).sqrt()?.add(&b.rat(rub)))))
            .and_then(|(k, d)| k.mul(&lever).div(&d));
        if let Some(v) = value {
            let (lo, hi) = (v.lo(), v.hi());
            if narrow(&lo, &hi, goal) || n > 1 << 14 {
                return Peak::Within(lo.max(Rat::zero()), hi);
            }
        }
        n *= 2;
        if n > 1 << 20 {
            return Peak::Unbounded;
        }
    }
}
