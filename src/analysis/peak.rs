//! The highest contact force along a stretch, certified (DP App. A, and where it fails).
//!
//! Along a stretch the force is f(x) = K·T(x)·den(x)/N(x), T = θ/x (x taken into den) or, past
//! half a turn, θ. Prop. A.1 says that it peaks at an end; that fails for type A, and for type B
//! needs a cut where the sliding reverses. So nothing is assumed: the stretch is cut at the roots
//! of d, and each part is searched by branch and bound on x. A cell on which the derivative's
//! numerator
//!
//! ```text
//! E(x) = T′·den·N + T·(den′·N − den·N′)
//! ```
//!
//! has one sign is decided by its ends; one that cannot beat what is already attained is
//! dropped; any other is halved. What remains is narrower than asked. The supremum is unbounded
//! exactly where N has a root at a part's end and T·den has none: decided in algebraic numbers.

use super::fix::{Bits, Fix};
use super::qpoly::{QPoly, horner};
use super::stretch::{Law, Stretch};
use crate::number::{Algebraic, Rat};
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
fn narrow(lo: &Rat, hi: &Rat, goal: u32) -> bool {
    (hi - lo) * Rat::from(2).pow(goal) <= *lo
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
                let mut part = Part {
                    ends: [part[0].clone(), part[1].clone()],
                    half_turn: s.half_turn,
                    num: den.clone(),
                    den: turn.scale(&away).add(&rise.scale(&rub)),
                    scale2: stiffness.square() * (Rat::one() + mu.square()) * normal2,
                    by_x: false,
                    goal,
                };
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

/// Where in a part.
enum Spot {
    End(usize),
    Inside(Rat, Rat),
}

/// A part of a stretch on which the sliding keeps its direction.
struct Part {
    ends: [Algebraic; 2],
    half_turn: i64,
    num: QPoly,
    den: QPoly,
    /// K².
    scale2: Rat,
    /// T is θ/x rather than θ.
    by_x: bool,
    goal: u32,
}

/// A part's coefficients at one precision.
struct Tables {
    b: Bits,
    scale: Fix,
    num: Vec<Fix>,
    den: Vec<Fix>,
    /// num·den and num′·den − num·den′, multiplied out exactly: near a common root of both
    /// terms nothing is lost.
    both: Vec<Fix>,
    bend: Vec<Fix>,
}

impl Part {
    fn supremum(&mut self) -> (Peak, Spot) {
        let at_rest = |x: &Algebraic| self.half_turn == 0 && x.sign() == 0;
        // Where θ and N vanish together, one x is cancelled.
        let through_rest = self.ends.iter().any(at_rest);
        if through_rest && self.den.0.first().is_none_or(Rat::is_zero) && !self.den.0.is_empty() {
            self.den.0.remove(0);
            self.by_x = true;
        }
        let cancelled = self.by_x;
        if self.half_turn == 0 && !self.by_x {
            // θ = x·(θ/x): where f is nearly 0/0 the cancellation is then in the polynomials.
            self.num.0.insert(0, Rat::zero());
            self.by_x = true;
        }
        let den = self.den.poly();
        if den.is_zero() {
            return (Peak::Unbounded, Spot::End(0));
        }
        for k in 0..2 {
            let rests = self.half_turn == 0 && self.ends[k].sign() == 0 && !cancelled;
            if self.ends[k].sign_of(&den) == 0 && !rests {
                return (Peak::Unbounded, Spot::End(k));
            }
        }
        let mut n = 64 + u64::from(self.goal);
        loop {
            if let Some((lo, hi, at)) = self.search(n)
                && (narrow(&lo, &hi, self.goal) || hi.is_zero() || n > 1 << 14)
            {
                return (Peak::Within(lo, hi), at);
            }
            n *= 2;
        }
    }

    fn search(&self, n: u64) -> Option<(Rat, Rat, Spot)> {
        let b = Bits(n);
        let (rise, fall) = (self.num.derivative(), self.den.derivative());
        let bend = rise.mul(&self.den).sub(&self.num.mul(&fall));
        let t = Tables {
            b,
            scale: b.rat(&self.scale2).sqrt()?,
            num: self.num.fix(b),
            den: self.den.fix(b),
            both: self.num.mul(&self.den).fix(b),
            bend: bend.fix(b),
        };
        let (mut lo, mut hi) = (Rat::zero(), Rat::zero());
        let mut at = Spot::End(0);
        let mut boxes = Vec::new();
        for k in 0..2 {
            let (l, r) = self.ends[k].enclosure(n as u32 - 8);
            let v = self.value(&t, &b.hull(&l, &r))?;
            if v.lo() > lo {
                (lo, at) = (v.lo(), Spot::End(k));
            }
            hi = hi.max(v.hi());
            boxes.push((l, r));
        }
        let mut cells = Vec::new();
        if boxes[0].1 < boxes[1].0 {
            cells.push((boxes[0].1.clone(), boxes[1].0.clone(), 0u32));
        }
        // More cells with more bits, so that every search ends.
        let mut budget = 20_000 + 100 * n;
        while let Some((l, r, depth)) = cells.pop() {
            budget = budget.checked_sub(1)?;
            let x = b.hull(&l, &r);
            let falls = self.slope(&t, &x).sign();
            if falls.is_some() {
                // Monotone: highest at an end.
                for end in [&l, &r] {
                    let v = self.value(&t, &b.rat(end))?;
                    if v.lo() > lo {
                        lo = v.lo();
                        at = match () {
                            () if *end == boxes[0].1 => Spot::End(0),
                            () if *end == boxes[1].0 => Spot::End(1),
                            () => Spot::Inside(l.clone(), r.clone()),
                        };
                    }
                    hi = hi.max(v.hi());
                }
                continue;
            }
            let mid = Rat::midpoint(&l, &r);
            let (value, centre) = (self.value(&t, &x), self.value(&t, &b.rat(&mid))?);
            if centre.lo() > lo {
                (lo, at) = (centre.lo(), Spot::Inside(l.clone(), r.clone()));
            }
            let bound = value.map(|v| {
                // The mean value form is the narrower one on small cells.
                let plain = v.hi();
                let slope = self.derivative(&t, &x);
                let reach = slope.map(|d| {
                    let half = b.rat(&(&r - &mid));
                    centre.add(&d.abs().mul(&half)).hi()
                });
                reach.map_or(plain.clone(), |m| m.min(plain))
            });
            if let Some(top) = bound
                && (top <= lo || narrow(&lo, &top, self.goal + 2))
            {
                hi = hi.max(top);
                continue;
            }
            if u64::from(depth) + 8 > n {
                return None;
            }
            cells.push((l, mid.clone(), depth + 1));
            cells.push((mid, r, depth + 1));
        }
        Some((lo, hi, at))
    }

    /// |T| over an enclosed position, and T′ with the sign of |T|.
    fn lever(&self, b: Bits, x: &Fix) -> (Fix, Fix) {
        let two = b.int(2);
        let slope = two
            .div(&b.int(1).add(&x.mul(x)))
            .unwrap_or_else(|| b.int(2));
        if !self.by_x {
            let t = theta(x, self.half_turn, b);
            return match t.sign() {
                Some(s) if s < 0 => (t.neg(), slope.neg()),
                Some(_) => (t, slope),
                None => (t.abs(), slope.join(&slope.neg())),
            };
        }
        // 2·arctan(x)/x = 2 − 2x²/3 + …: even, falling in |x|, with a derivative between
        // −4x/3 and 0.
        let third = |k: i64| b.rat(&Rat::frac(k, 3));
        let value = match x.sign() {
            Some(s) if s != 0 => x.atan().mul(&two).div(x),
            _ => None,
        };
        let series = two.sub(&x.mul(x).mul(&third(2))).join(&two);
        let value = value.unwrap_or(series);
        // A′ = (2/(1 + x²) − A)/x away from 0.
        let rough = x.mul(&third(-4)).join(&b.int(0));
        let fine = match x.sign() {
            Some(s) if s != 0 => slope.sub(&value).div(x),
            _ => None,
        };
        let slope = match fine {
            Some(f) if f.hi() - f.lo() < rough.hi() - rough.lo() => f,
            _ => rough,
        };
        (value, slope)
    }

    fn value(&self, t: &Tables, x: &Fix) -> Option<Fix> {
        let (lever, _) = self.lever(t.b, x);
        let q = horner(&t.num, x, t.b).div(&horner(&t.den, x, t.b))?;
        Some(lever.mul(&q.abs()).mul(&t.scale))
    }

    /// E(x), up to a sign that is constant along the part.
    fn slope(&self, t: &Tables, x: &Fix) -> Fix {
        let (lever, rate) = self.lever(t.b, x);
        let (both, bend) = (horner(&t.both, x, t.b), horner(&t.bend, x, t.b));
        rate.mul(&both).add(&lever.mul(&bend))
    }

    fn derivative(&self, t: &Tables, x: &Fix) -> Option<Fix> {
        let den = horner(&t.den, x, t.b);
        Some(self.slope(t, x).div(&den.mul(&den))?.mul(&t.scale))
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
