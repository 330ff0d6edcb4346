//! Enclosures as results write them: exact rationals with no more digits than were asked for.

use super::fix::Fix;
use super::peak::Peak;
use crate::number::Rat;
use crate::report::words::digits;
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
    /// As one decimal of at most so many significant digits, fewer where fewer are sure; both ends
    /// where not even one is.
    pub(super) fn decimal(&self, most: u32) -> String {
        let Bound::Within { lo, hi } = self else {
            return "∞".to_owned();
        };
        let (Ok(lo), Ok(hi)) = (lo.parse::<Rat>(), hi.parse::<Rat>()) else {
            return String::new();
        };
        let size = lo.abs().max(hi.abs());
        let wide = &hi - &lo;
        let sure = |d: u32| &wide * &Rat::from(10).pow(d) <= size;
        if wide.is_zero() || sure(most) {
            return decimal(&Rat::midpoint(&lo, &hi), most);
        }
        if lo.sign() < 0 && lo == -&hi {
            // Nothing is known but how small it is.
            return format!("±{}", decimal(&hi, 2));
        }
        match (1..most).rev().find(|d| sure(*d)) {
            Some(d) => decimal(&Rat::midpoint(&lo, &hi), d),
            None => format!("{} … {}", decimal(&lo, 2), decimal(&hi, 2)),
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

/// A rational number rounded to so many significant digits, without trailing zeros.
fn decimal(x: &Rat, significant: u32) -> String {
    if x.is_zero() {
        return "0".to_owned();
    }
    let significant = significant.max(1);
    if significant <= 15
        && let Some(x) = x.nearest_f64().filter(|x| x.is_normal())
    {
        return digits(x, significant as usize);
    }
    let ten = Rat::from(10);
    let length = |n: &crate::number::Int| n.to_string().trim_start_matches('-').len() as i64;
    // 10^e ≤ |x| < 10^(e+1).
    let mut e = length(x.numer()) - length(x.denom());
    let power = |e: i64| {
        let p = ten.pow(u32::try_from(e.unsigned_abs()).unwrap_or(u32::MAX));
        if e < 0 { p.recip() } else { p }
    };
    if power(e) > x.abs() {
        e -= 1;
    }
    let places = i64::from(significant) - 1 - e;
    if e.unsigned_abs() > 300 {
        return scientific(x, significant, e, &power(places));
    }
    let scaled = x.abs() * power(places) + Rat::frac(1, 2);
    let mut text = scaled.numer().div_rem_floor(scaled.denom()).0.to_string();
    let sign = if x.sign() < 0 { "−" } else { "" };
    if places <= 0 {
        text += &"0".repeat(places.unsigned_abs() as usize);
        return format!("{sign}{text}");
    }
    let places = places as usize;
    if text.len() <= places {
        text = "0".repeat(places + 1 - text.len()) + &text;
    }
    text.insert(text.len() - places, '.');
    let text = text.trim_end_matches('0').trim_end_matches('.');
    format!("{sign}{text}")
}

/// One far from 1, where 10^e ≤ |x| < 10^(e+1), as a mantissa and a power of ten; `shift` is 10^(significant − 1 − e).
fn scientific(x: &Rat, significant: u32, e: i64, shift: &Rat) -> String {
    let scaled = x.abs() * shift + Rat::frac(1, 2);
    let mut text = scaled.numer().div_rem_floor(scaled.denom()).0.to_string();
    // 9.99… may round up to ten.
    let e = e + (text.len() as i64 - i64::from(significant));
    text.insert(1, '.');
    let mantissa = text.trim_end_matches('0').trim_end_matches('.');
    let sign = if x.sign() < 0 { "−" } else { "" };
    format!("{sign}{mantissa}e{e}").replace('-', "−")
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
    /// As many digits as were asked for, and no more than are sure.
    #[test]
    fn decimals_show_what_is_sure() {
        let third = Bound::within(&Rat::frac(1, 3), &Rat::frac(1, 3), 40);
        assert_eq!(third.decimal(3), "0.333");
        assert_eq!(third.decimal(30), format!("0.{}", "3".repeat(30)));
        let wide = Bound::Within {
            lo: "123/100".to_owned(),
            hi: "124/100".to_owned(),
        };
        assert_eq!(wide.decimal(9), "1.2");
        let open = Bound::Within {
            lo: "-1".to_owned(),
            hi: "2".to_owned(),
        };
        assert_eq!(open.decimal(9), "−1 … 2");
        assert_eq!(decimal(&Rat::frac(-200, 3), 20), "−66.666666666666666667");
        assert_eq!(decimal(&Rat::from(1_000_000), 20), "1000000");
        let huge = Rat::from(10).pow(400);
        assert_eq!(decimal(&(&huge * &Rat::frac(-5, 2)), 6), "−2.5e400");
        assert_eq!(decimal(&huge.recip(), 6), "1e−400");
        let almost = &huge * &Rat::frac(99_999_999, 10_000_000);
        assert_eq!(decimal(&almost, 4), "1e401");
    }
}
