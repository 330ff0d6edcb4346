//! Enclosures of any width: fixed-point intervals, rounded outward.
//!
//! Forces hold arctangents, so they have no exact form. A [`Fix`] is a pair of integers over
//! 2^bits; every operation rounds its ends away from each other, and a quotient or a root that
//! does not exist is no value at all. Who needs a narrower answer asks again with more bits.

use crate::number::{Int, Rat};
use std::cell::RefCell;

/// The precision: values are integers over 2^bits.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Bits(pub u64);

/// An interval [lo, hi]/2^bits that holds the value meant.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fix {
    lo: Int,
    hi: Int,
    bits: u64,
}

fn ceil_shr(x: &Int, k: u64) -> Int {
    -((-x).shr(k))
}

fn div_floor(a: &Int, b: &Int) -> Int {
    a.div_rem_floor(b).0
}

fn div_ceil(a: &Int, b: &Int) -> Int {
    -((-a).div_rem_floor(b).0)
}

/// 1 where the interval holds no negative number, -1 where no positive one, 0 else.
fn side(lo: &Int, hi: &Int) -> i32 {
    if lo.sign() >= 0 {
        1
    } else if hi.sign() <= 0 {
        -1
    } else {
        0
    }
}

impl Bits {
    /// The interval [lo, hi]/2^bits.
    pub(super) fn units(self, lo: Int, hi: Int) -> Fix {
        Fix {
            lo,
            hi,
            bits: self.0,
        }
    }
    /// A rational number.
    pub fn rat(self, r: &Rat) -> Fix {
        let n = r.numer().shl(self.0);
        Fix {
            lo: div_floor(&n, r.denom()),
            hi: div_ceil(&n, r.denom()),
            bits: self.0,
        }
    }
    /// The interval between two rational numbers.
    pub fn hull(self, lo: &Rat, hi: &Rat) -> Fix {
        Fix {
            lo: self.rat(lo).lo,
            hi: self.rat(hi).hi,
            bits: self.0,
        }
    }
    /// An integer.
    pub fn int(self, n: i64) -> Fix {
        let n = Int::from(n).shl(self.0);
        Fix {
            lo: n.clone(),
            hi: n,
            bits: self.0,
        }
    }
    /// arctan(1/n) for n ≥ 2, by its alternating series.
    fn atan_inverse(self, n: i64) -> Fix {
        let (n2, guard) = (Int::from(n * n), 16);
        let mut power = Int::one()
            .shl(self.0 + guard)
            .div_rem_floor(&Int::from(n))
            .0;
        let (mut sum, mut k) = (Int::zero(), 0i64);
        while !power.is_zero() {
            let term = power.div_rem_floor(&Int::from(2 * k + 1)).0;
            sum = if k % 2 == 0 { sum + term } else { sum - term };
            power = power.div_rem_floor(&n2).0;
            k += 1;
        }
        // Each term is off by less than 2 units below, the tail by less than one.
        let error = Int::from(2 * k + 2);
        Fix {
            lo: (&sum - &error).shr(guard),
            hi: ceil_shr(&(sum + error), guard),
            bits: self.0,
        }
    }
    /// π, by Machin's formula. The last one made is kept, a thread each.
    pub fn pi(self) -> Fix {
        thread_local! {
            static LAST: RefCell<Option<Fix>> = const { RefCell::new(None) };
        }
        LAST.with_borrow_mut(|last| match last {
            Some(pi) if pi.bits == self.0 => pi.clone(),
            _ => {
                let four = self.int(4);
                let pi = four.mul(&four.mul(&self.atan_inverse(5)).sub(&self.atan_inverse(239)));
                last.insert(pi).clone()
            }
        })
    }
}

impl Fix {
    /// The lower end.
    pub fn lo(&self) -> Rat {
        Rat::new(self.lo.clone(), Int::one().shl(self.bits))
    }
    /// The upper end.
    pub fn hi(&self) -> Rat {
        Rat::new(self.hi.clone(), Int::one().shl(self.bits))
    }
    /// Both ends over 2^bits.
    pub(super) fn ends(self) -> [Int; 2] {
        [self.lo, self.hi]
    }
    /// hi − lo over 2^bits.
    pub(super) fn width(&self) -> Int {
        &self.hi - &self.lo
    }
    /// The sign that holds throughout, None if undecided.
    pub fn sign(&self) -> Option<i32> {
        match (self.lo.sign(), self.hi.sign()) {
            (0, 0) => Some(0),
            (1, _) => Some(1),
            (_, -1) => Some(-1),
            _ => None,
        }
    }
    /// The sum.
    pub fn add(&self, o: &Fix) -> Fix {
        Fix {
            lo: &self.lo + &o.lo,
            hi: &self.hi + &o.hi,
            bits: self.bits,
        }
    }
    /// The negated value.
    pub fn neg(&self) -> Fix {
        Fix {
            lo: -&self.hi,
            hi: -&self.lo,
            bits: self.bits,
        }
    }
    /// The difference.
    pub fn sub(&self, o: &Fix) -> Fix {
        self.add(&o.neg())
    }
    /// The product.
    pub fn mul(&self, o: &Fix) -> Fix {
        let (a, b, c, d) = (&self.lo, &self.hi, &o.lo, &o.hi);
        let up = |x: Int| ceil_shr(&x, self.bits);
        let down = |x: Int| x.shr(self.bits);
        // Which ends meet is read off the signs; only where both hold zero are there two candidates.
        let (lo, hi) = match (side(a, b), side(c, d)) {
            (1, 1) => (down(a * c), up(b * d)),
            (1, -1) => (down(b * c), up(a * d)),
            (1, _) => (down(b * c), up(b * d)),
            (-1, 1) => (down(a * d), up(b * c)),
            (-1, -1) => (down(b * d), up(a * c)),
            (-1, _) => (down(a * d), up(a * c)),
            (_, 1) => (down(a * d), up(b * d)),
            (_, -1) => (down(b * c), up(a * c)),
            _ => (down((a * d).min(b * c)), up((a * c).max(b * d))),
        };
        Fix {
            lo,
            hi,
            bits: self.bits,
        }
    }
    /// The quotient; None where the divisor may be zero.
    pub fn div(&self, o: &Fix) -> Option<Fix> {
        let (c, d) = (&o.lo, &o.hi);
        let (a, b) = (self.lo.shl(self.bits), self.hi.shl(self.bits));
        let (low, high) = match (c.sign(), d.sign()) {
            (1, _) => (
                (&a, if a.sign() < 0 { c } else { d }),
                (&b, if b.sign() < 0 { d } else { c }),
            ),
            (_, -1) => (
                (&b, if b.sign() < 0 { c } else { d }),
                (&a, if a.sign() < 0 { d } else { c }),
            ),
            _ => return None,
        };
        Some(Fix {
            lo: div_floor(low.0, low.1),
            hi: div_ceil(high.0, high.1),
            bits: self.bits,
        })
    }
    /// The absolute value.
    pub fn abs(&self) -> Fix {
        match self.sign() {
            Some(s) if s < 0 => self.neg(),
            Some(_) => self.clone(),
            None => Fix {
                lo: Int::zero(),
                hi: (-&self.lo).max(self.hi.clone()),
                bits: self.bits,
            },
        }
    }
    /// The square root of the part that is not negative; None where there is none.
    pub fn sqrt(&self) -> Option<Fix> {
        let floor = |v: &Int| v.max(&Int::zero()).shl(self.bits).sqrt();
        let hi = self.hi.shl(self.bits);
        let root = hi.sqrt()?;
        let exact = &root * &root == hi;
        Some(Fix {
            lo: floor(&self.lo)?,
            hi: if exact { root } else { root + Int::one() },
            bits: self.bits,
        })
    }
    /// The least interval that holds both.
    pub fn join(&self, o: &Fix) -> Fix {
        Fix {
            lo: self.lo.clone().min(o.lo.clone()),
            hi: self.hi.clone().max(o.hi.clone()),
            bits: self.bits,
        }
    }
    /// What lies in both: two enclosures of one value.
    pub fn meet(&self, o: &Fix) -> Fix {
        let lo = self.lo.clone().max(o.lo.clone());
        let hi = self.hi.clone().min(o.hi.clone());
        if lo > hi {
            return self.join(o);
        }
        Fix {
            lo,
            hi,
            bits: self.bits,
        }
    }
    /// The part of it within an interval that is known to hold the value.
    pub fn clamp(&self, within: &Fix) -> Fix {
        self.meet(within)
    }
    /// The arctangent. Monotone, so each end is enclosed by itself.
    pub fn atan(&self) -> Fix {
        let end = |v: &Int| {
            atan_point(&Fix {
                lo: v.clone(),
                hi: v.clone(),
                bits: self.bits,
            })
        };
        if self.lo == self.hi {
            return end(&self.lo);
        }
        Fix {
            lo: end(&self.lo).lo,
            hi: end(&self.hi).hi,
            bits: self.bits,
        }
    }
}

/// arctan x: past 1 from the reciprocal, then four times arctan x = 2·arctan(x/(1 + √(1 + x²))),
/// then the series.
fn atan_point(x: &Fix) -> Fix {
    let b = Bits(x.bits);
    let one = b.int(1);
    if x.lo.sign() < 0 {
        return atan_point(&x.neg()).neg();
    }
    if x.lo > one.lo
        && let Some(inverse) = one.div(x)
    {
        let half_pi = Fix {
            lo: b.pi().lo.shr(1),
            hi: ceil_shr(&b.pi().hi, 1),
            bits: x.bits,
        };
        return half_pi.sub(&inverse.atan());
    }
    let mut y = x.clone();
    let mut halvings = 0;
    for _ in 0..4 {
        let next = one.add(&y.mul(&y)).sqrt().and_then(|r| y.div(&one.add(&r)));
        if let Some(n) = next {
            y = n;
            halvings += 1;
        }
    }
    // Alternating with falling terms (0 ≤ y ≤ 1): the tail is less than the first term left out.
    let y2 = y.mul(&y);
    let (mut power, mut sum, mut k) = (y.clone(), b.int(0), 0i64);
    while let Some(term) = power.div(&b.int(2 * k + 1)) {
        sum = if k % 2 == 0 {
            sum.add(&term)
        } else {
            sum.sub(&term)
        };
        power = power.mul(&y2);
        k += 1;
        if power.hi <= Int::one() {
            let tail = power.hi.clone();
            sum = Fix {
                lo: sum.lo - &tail,
                hi: sum.hi + tail,
                bits: x.bits,
            };
            break;
        }
    }
    let scale = b.int(1 << halvings);
    sum.mul(&scale)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn pi_and_arctangents_hold_the_known_digits() {
        let b = Bits(200);
        // 50 digits of π and of arctan(2).
        let pi = "3.14159265358979323846264338327950288419716939937510";
        let atan2 = "1.10714871779409050301706546017853704007004764540143";
        let ulp = Rat::from(10).pow(50).recip();
        for (got, text) in [(b.pi(), pi), (b.rat(&Rat::from(2)).atan(), atan2)] {
            let v = crate::number::literal::parse(text).expect("in range");
            assert!(got.lo() <= &v + &ulp && &v - &ulp <= got.hi());
            assert!(got.hi() - got.lo() < Rat::from(2).pow(180).recip());
        }
        // arctan is odd, and four times arctan 1 is π.
        let one = b.int(1).atan().mul(&b.int(4));
        assert!(one.lo() <= b.pi().hi() && b.pi().lo() <= one.hi());
        let third = b
            .rat(&Rat::frac(-1, 3))
            .atan()
            .add(&b.rat(&Rat::frac(1, 3)).atan());
        assert_eq!(third.sign(), None);
    }

    /// Products and quotients over all combinations of signs hold those of the ends, and no more.
    #[test]
    fn products_and_quotients_are_the_least_enclosures() {
        let b = Bits(6);
        let unit = Rat::from(64).recip();
        for i in 0..2401i64 {
            let [a, c] = [i % 49, i / 49].map(|k| {
                let (x, y) = (k % 7 - 3, k / 7 - 3);
                (x.min(y) * 37, x.max(y) * 37)
            });
            let fix = |(x, y): (i64, i64)| b.units(Int::from(x), Int::from(y));
            let rat = |x: i64| Rat::frac(x, 64);
            let pairs = [(a.0, c.0), (a.0, c.1), (a.1, c.0), (a.1, c.1)];
            let close = |f: &Fix, all: &[Rat]| {
                let (lo, hi) = (all.iter().min().unwrap(), all.iter().max().unwrap());
                f.lo() <= *lo && *lo < f.lo() + &unit && *hi <= f.hi() && f.hi() - &unit < *hi
            };
            let all = pairs.map(|(x, y)| rat(x) * rat(y));
            assert!(close(&fix(a).mul(&fix(c)), &all), "{a:?}·{c:?}");
            match fix(a).div(&fix(c)) {
                Some(q) => {
                    let all = pairs.map(|(x, y)| rat(x) / rat(y));
                    assert!(close(&q, &all), "{a:?}/{c:?}");
                }
                None => assert!(c.0 <= 0 && 0 <= c.1),
            }
        }
    }

    #[test]
    fn rounding_goes_outward() {
        let b = Bits(8);
        let third = b.rat(&Rat::frac(1, 3));
        assert!(third.lo() < Rat::frac(1, 3) && Rat::frac(1, 3) < third.hi());
        let q = b.int(1).div(&b.int(-3)).expect("in range");
        assert!(q.lo() < Rat::frac(-1, 3) && Rat::frac(-1, 3) < q.hi());
        let r = b.int(2).sqrt().expect("in range");
        assert!(r.lo().square() < Rat::from(2) && Rat::from(2) < r.hi().square());
        assert!(b.int(1).div(&third.sub(&third)).is_none());
    }
}
