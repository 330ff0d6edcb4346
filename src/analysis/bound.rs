//! Enclosures as results write them: exact rationals with no more digits than were asked for.

use super::fix::Fix;
use super::peak::Peak;
use crate::number::Rat;
use schemars::JsonSchema;
use serde::Serialize;

/// A quantity, enclosed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Bound {
    /// Past every bound.
    Unbounded(Unbounded),
    /// Between two exact rationals.
    Within {
        /// At least this.
        lo: String,
        /// At most this.
        hi: String,
    },
}

/// The word for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub enum Unbounded {
    /// Past every bound.
    #[serde(rename = "unbounded")]
    Unbounded,
}

/// The enclosure rounded outward to about `digits` significant decimals: what it grows by is less
/// than 10^-digits of its larger end.
pub(super) fn rounded(lo: &Rat, hi: &Rat, digits: u32) -> [Rat; 2] {
    let size = lo.abs().max(hi.abs());
    if size.is_zero() {
        return [Rat::zero(), Rat::zero()];
    }
    // 10^e ≤ size, give or take one: the length of the digits tells.
    let ten = Rat::from(10);
    let power = |e: i64| {
        let p = ten.pow(u32::try_from(e.unsigned_abs()).unwrap_or(u32::MAX));
        if e < 0 { p.recip() } else { p }
    };
    let length = |n: &crate::number::Int| n.to_string().trim_start_matches('-').len() as i64;
    let mut e = length(size.numer()) - length(size.denom());
    if power(e) > size {
        e -= 1;
    }
    let unit = power(e - i64::from(digits));
    let down = |r: &Rat| {
        let q = r / &unit;
        Rat::from(q.numer().div_rem_floor(q.denom()).0) * &unit
    };
    let up = |r: &Rat| -down(&-r);
    [down(lo), up(hi)]
}

impl Bound {
    /// An enclosure between two rationals.
    pub(super) fn within(lo: &Rat, hi: &Rat, digits: u32) -> Bound {
        let [lo, hi] = rounded(lo, hi, digits);
        Bound::Within {
            lo: lo.to_string(),
            hi: hi.to_string(),
        }
    }
    pub(super) fn of_fix(x: &Fix, digits: u32) -> Bound {
        Bound::within(&x.lo(), &x.hi(), digits)
    }
    pub(super) fn of(p: &Peak, digits: u32) -> Bound {
        match p {
            Peak::Unbounded => Bound::Unbounded(Unbounded::Unbounded),
            Peak::Within(lo, hi) => Bound::within(lo, hi, digits),
        }
    }
    /// The middle as a double; infinite where unbounded.
    pub fn approx(&self) -> f64 {
        match self {
            Bound::Unbounded(_) => f64::INFINITY,
            Bound::Within { lo, hi } => {
                let read = |s: &str| s.parse::<Rat>().ok().and_then(|r| r.nearest_f64());
                0.5 * (read(lo).unwrap_or(f64::NAN) + read(hi).unwrap_or(f64::NAN))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_outward_and_short() {
        let third = Rat::frac(1, 3);
        for (x, digits) in [(third.clone(), 3), (Rat::from(12345), 2), (-third, 5)] {
            let [lo, hi] = rounded(&x, &x, digits);
            assert!(lo <= x && x <= hi);
            let wide = (&hi - &lo) * Rat::from(10).pow(digits);
            assert!(wide <= x.abs(), "{x} {digits}");
            assert!(lo.denom().to_string().len() <= digits as usize + 3);
        }
        assert_eq!(rounded(&Rat::zero(), &Rat::zero(), 9)[1], Rat::zero());
    }
}
