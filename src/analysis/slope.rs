//! The contact force along a part of a stretch as a function to be climbed.
//!
//! Along a part f(x) = K·T(x)·num(x)/den(x), T = 2·arctan(x)/x (the factor x then is in num, or
//! cancelled from den) or, past half a turn, T = |θ|. Its derivative has the sign of
//!
//! ```text
//! E(x) = T′·num·den + T·(num′·den − num·den′)
//! ```
//!
//! whose polynomials are multiplied out exactly, so that nothing is lost near a common root. The
//! supremum is unbounded exactly where den has a root at an end of the part and T·num has none:
//! decided in algebraic numbers. Else [`climb`] is run on doubles, and on wider and wider
//! fixed-point numbers over what doubles leave.

use super::climb::{Scale, Spot, climb};
use super::fix::{Bits, Fix};
use super::peak::{Peak, narrow, theta};
use super::qpoly::{QPoly, horner};
use super::rough;
use crate::number::{Algebraic, Int, Interval, Rat};

/// A part of a stretch on which the sliding keeps its direction.
pub(super) struct Part {
    /// x from … to, from < to or both the same.
    pub(super) ends: [Algebraic; 2],
    pub(super) half_turn: i64,
    pub(super) num: QPoly,
    pub(super) den: QPoly,
    /// K².
    pub(super) scale2: Rat,
    /// T is 2·arctan(x)/x rather than |θ|.
    by_x: bool,
    /// Relative width asked for, as a power of 1/2.
    goal: u32,
}

/// The widest numbers that are tried.
const MOST_BITS: u64 = 1 << 14;

impl Part {
    /// K·|θ|·num/den between two places. Where θ and den vanish together at an end, x is
    /// cancelled.
    pub(super) fn new(
        ends: [Algebraic; 2],
        half_turn: i64,
        mut num: QPoly,
        mut den: QPoly,
        scale2: Rat,
        goal: u32,
    ) -> Part {
        let by_x = half_turn == 0;
        if by_x {
            let through_rest = ends.iter().any(|x| x.sign() == 0);
            if through_rest && den.0.first().is_some_and(Rat::is_zero) {
                den.0.remove(0);
            } else {
                num.0.insert(0, Rat::zero());
            }
        }
        Part {
            ends,
            half_turn,
            num,
            den,
            scale2,
            by_x,
            goal,
        }
    }

    /// The supremum, within a relative 2^-goal where [`MOST_BITS`] allow it, and where it is.
    pub(super) fn supremum(&self) -> (Peak, Spot<Rat>) {
        let den = self.den.poly();
        if den.is_zero() {
            return (Peak::Unbounded, Spot::End(0));
        }
        for k in 0..2 {
            let x = &self.ends[k];
            // Where num has the factor x, and den has it no more than once, f is finite at rest.
            let rests = self.by_x && x.sign() == 0 && self.num.0.first().is_none_or(Rat::is_zero);
            if !rests && x.sign_of(&den) == 0 {
                return (Peak::Unbounded, Spot::End(k));
            }
        }
        let (rise, fall) = (self.num.derivative(), self.den.derivative());
        let both = self.num.mul(&self.den);
        let bend = rise.mul(&self.den).sub(&self.num.mul(&fall));
        let exact = [&self.num, &self.den, &both, &bend];
        let rough = self.by_doubles(exact);
        if let Some(rough) = &rough
            && rough.settled
            && (narrow(&rough.lo, &rough.hi, self.goal) || rough.hi.is_zero())
        {
            return (
                Peak::Within(rough.lo.clone(), rough.hi.clone()),
                rough.at.clone(),
            );
        }
        let mut n = 64 + u64::from(self.goal);
        loop {
            if let Some((lo, hi, at)) = self.by_many_bits(exact, n, rough.as_ref())
                && (narrow(&lo, &hi, self.goal) || hi.is_zero() || n > MOST_BITS)
            {
                return (Peak::Within(lo, hi), at);
            }
            n *= 2;
        }
    }

    /// In doubles. None where they are too short to hold the part.
    fn by_doubles(&self, exact: [&QPoly; 4]) -> Option<Rough> {
        let [num, den, both, bend] =
            exact.map(|p| p.0.iter().map(Rat::interval).collect::<Vec<_>>());
        let scale = Doubles {
            by_x: self.by_x,
            half_turn: self.half_turn,
            scale: self.scale2.interval().sqrt(),
            num,
            den,
            both,
            bend,
            goal: f64::from(self.goal.min(40) + 2).exp2().recip(),
        };
        let [a, z] = self.ends.each_ref().map(Algebraic::interval);
        if !a.is_finite() || !z.is_finite() {
            return None;
        }
        let ends = [[&a.lo, &a.hi], [&z.lo, &z.hi]];
        let whole = if a.hi < z.lo {
            vec![[a.hi, z.lo]]
        } else {
            Vec::new()
        };
        let found = climb(&scale, ends, whole, None, 2000)?;
        let rat = Rat::from_f64;
        let at = match found.at {
            Spot::End(k) => Spot::End(k),
            Spot::Inside(l, r) => Spot::Inside(rat(l), rat(r)),
        };
        let cells = found.left.iter().map(|[l, r]| [rat(*l), rat(*r)]);
        Some(Rough {
            lo: rat(found.lo),
            hi: rat(found.hi),
            at,
            settled: found.settled,
            cells: cells.collect(),
            searched: [rat(a.hi), rat(z.lo)],
        })
    }

    /// In numbers of n bits, over what doubles left. None where more bits are needed.
    fn by_many_bits(
        &self,
        exact: [&QPoly; 4],
        n: u64,
        rough: Option<&Rough>,
    ) -> Option<(Rat, Rat, Spot<Rat>)> {
        let b = Bits(n);
        let [num, den, both, bend] = exact.map(|p| p.fix(b));
        let scale = Wide {
            b,
            by_x: self.by_x,
            half_turn: self.half_turn,
            scale: b.rat(&self.scale2).sqrt()?,
            num,
            den,
            both,
            bend,
            goal: u64::from(self.goal) + 2,
        };
        let bits = n as u32 - 8;
        let ends = self.ends.each_ref().map(|x| {
            let (l, r) = x.enclosure(bits);
            b.hull(&l, &r).ends()
        });
        let (from, to) = (&ends[0][1], &ends[1][0]);
        let mut cells = Vec::new();
        let clip = |x: Int| x.max(from.clone()).min(to.clone());
        let mut push = |l: Int, r: Int| {
            let (l, r) = (clip(l), clip(r));
            if l < r {
                cells.push([l, r]);
            }
        };
        let mut known = None;
        match rough {
            Some(rough) => {
                // What lies between the doubles' ends and these has not been looked at.
                let [a, z] = rough.searched.each_ref().map(|x| b.rat(x).ends());
                push(from.clone(), a[1].clone());
                push(z[0].clone(), to.clone());
                let cell = |l: &Rat, r: &Rat| b.hull(l, r).ends();
                for [l, r] in &rough.cells {
                    let [l, r] = cell(l, r);
                    push(l, r);
                }
                let [value, _] = b.rat(&rough.lo).ends();
                let place = match &rough.at {
                    Spot::End(k) => Spot::End(*k),
                    Spot::Inside(l, r) => {
                        let [l, r] = cell(l, r);
                        Spot::Inside(clip(l), clip(r))
                    }
                };
                known = Some((value, place));
            }
            None => push(from.clone(), to.clone()),
        }
        // More cells with more bits, so that every search ends.
        let boxes = ends.each_ref().map(|[l, r]| [l, r]);
        let found = climb(&scale, boxes, cells, known, 20_000 + 100 * n)?;
        let rat = |x: &Int| Rat::dyadic(x.clone(), -(n as i64));
        let at = match &found.at {
            Spot::End(k) => Spot::End(*k),
            Spot::Inside(l, r) => Spot::Inside(rat(l), rat(r)),
        };
        found.settled.then(|| (rat(&found.lo), rat(&found.hi), at))
    }
}

/// What a search in doubles found, and leaves to wider numbers.
struct Rough {
    lo: Rat,
    hi: Rat,
    at: Spot<Rat>,
    /// Whether `hi` holds.
    settled: bool,
    cells: Vec<[Rat; 2]>,
    /// From where to where it looked between the ends.
    searched: [Rat; 2],
}

/// A part's coefficients as double intervals.
struct Doubles {
    by_x: bool,
    half_turn: i64,
    scale: Interval,
    num: Vec<Interval>,
    den: Vec<Interval>,
    both: Vec<Interval>,
    bend: Vec<Interval>,
    /// The relative width that is narrow enough.
    goal: f64,
}

fn sum(c: &[Interval], x: &Interval) -> Interval {
    c.iter()
        .rev()
        .fold(Interval::point(0.0), |v, c| v * *x + *c)
}

fn size(x: Interval) -> Interval {
    match x.sign() {
        Some(s) if s < 0 => -x,
        Some(_) => x,
        None => Interval {
            lo: 0.0,
            hi: x.hi.max(-x.lo),
        },
    }
}

impl Doubles {
    /// |T| and its derivative.
    fn lever(&self, x: &Interval) -> [Interval; 2] {
        if self.by_x {
            return rough::lever(x);
        }
        let one = Interval::point(1.0);
        let slope = Interval::point(2.0) / (one + x.square());
        // More than half a turn from rest θ has the sign of its half-turn.
        let t = rough::theta(x, self.half_turn);
        if self.half_turn < 0 {
            [-t, -slope]
        } else {
            [t, slope]
        }
    }
    fn slope(&self, x: &Interval) -> Interval {
        let [t, rate] = self.lever(x);
        rate * sum(&self.both, x) + t * sum(&self.bend, x)
    }
}

fn interval(cell: [&f64; 2]) -> Interval {
    Interval {
        lo: *cell[0],
        hi: *cell[1],
    }
}

impl Scale for Doubles {
    type X = f64;
    fn value(&self, cell: [&f64; 2]) -> Option<[f64; 2]> {
        let x = interval(cell);
        let q = size(sum(&self.num, &x) / sum(&self.den, &x));
        let v = self.lever(&x)[0] * q * self.scale;
        v.is_finite().then_some([v.lo.max(0.0), v.hi])
    }
    fn monotone(&self, cell: [&f64; 2]) -> bool {
        self.slope(&interval(cell)).sign().is_some()
    }
    fn mean(&self, cell: [&f64; 2], middle: &f64, centre: &f64) -> Option<f64> {
        let x = interval(cell);
        let rate = size(self.slope(&x) / sum(&self.den, &x).square() * self.scale);
        let reach = size(x - Interval::point(*middle));
        let top = (Interval::point(*centre) + rate * reach).hi;
        top.is_finite().then_some(top)
    }
    fn middle(&self, [l, r]: [&f64; 2]) -> Option<f64> {
        let m = 0.5 * l + 0.5 * r;
        (*l < m && m < *r && r - l > 1e-13 * l.abs().max(r.abs())).then_some(m)
    }
    fn narrow(&self, lo: &f64, hi: &f64) -> bool {
        hi - lo <= self.goal * lo
    }
}

/// A part's coefficients at one precision; places and values are integers over 2^bits.
struct Wide {
    b: Bits,
    by_x: bool,
    half_turn: i64,
    scale: Fix,
    num: Vec<Fix>,
    den: Vec<Fix>,
    both: Vec<Fix>,
    bend: Vec<Fix>,
    goal: u64,
}

impl Wide {
    fn cell(&self, [l, r]: [&Int; 2]) -> Fix {
        self.b.units(l.clone(), r.clone())
    }
    /// |T| and its derivative.
    fn lever(&self, x: &Fix) -> (Fix, Fix) {
        let b = self.b;
        let two = b.int(2);
        let slope = two
            .div(&b.int(1).add(&x.mul(x)))
            .unwrap_or_else(|| b.int(2));
        if !self.by_x {
            let t = theta(x, self.half_turn, b);
            return match self.half_turn < 0 {
                true => (t.neg(), slope.neg()),
                false => (t, slope),
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
            Some(f) if f.width() < rough.width() => f,
            _ => rough,
        };
        (value, slope)
    }
    /// E(x), up to a sign that is constant along the part.
    fn slope(&self, x: &Fix) -> Fix {
        let (t, rate) = self.lever(x);
        let (both, bend) = (horner(&self.both, x, self.b), horner(&self.bend, x, self.b));
        rate.mul(&both).add(&t.mul(&bend))
    }
}

impl Scale for Wide {
    type X = Int;
    fn value(&self, cell: [&Int; 2]) -> Option<[Int; 2]> {
        let x = self.cell(cell);
        let q = horner(&self.num, &x, self.b).div(&horner(&self.den, &x, self.b))?;
        let v = self.lever(&x).0.mul(&q.abs()).mul(&self.scale);
        let [lo, hi] = v.ends();
        Some([lo.max(Int::zero()), hi])
    }
    fn monotone(&self, cell: [&Int; 2]) -> bool {
        self.slope(&self.cell(cell)).sign().is_some()
    }
    fn mean(&self, cell: [&Int; 2], middle: &Int, centre: &Int) -> Option<Int> {
        let x = self.cell(cell);
        let den = horner(&self.den, &x, self.b);
        let rate = self.slope(&x).div(&den.mul(&den))?.mul(&self.scale).abs();
        let reach = x.sub(&self.cell([middle, middle])).abs();
        let [_, more] = rate.mul(&reach).ends();
        Some(centre + &more)
    }
    fn middle(&self, [l, r]: [&Int; 2]) -> Option<Int> {
        // The last 8 bits are rounding's.
        let m = (l + r).shr(1);
        ((r - l).bits() > 8).then_some(m)
    }
    fn narrow(&self, lo: &Int, hi: &Int) -> bool {
        (hi - lo).shl(self.goal) <= *lo
    }
}
