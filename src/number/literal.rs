//! Exact number literals: the grammar of the files, read without ever passing through a double.
//!
//! The idea: `0.1` in a file means one tenth. A literal is `[+-]digits[.digits][e[+-]digits]` (`E` too) or
//! `[+-]integer/integer` with a positive denominator, and nothing else: no hexadecimal, infinity, NaN,
//! underscores, spaces, `.5` or `5.`. Limits keep a short text from standing for an enormous number.

use super::{Int, Rat};
use std::fmt;

/// Why a literal was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LiteralError {
    /// not a number of this grammar
    Malformed,
    /// denominator zero or negative
    BadDenominator,
    /// past [`MAX_DIGITS`]
    TooManyDigits,
    /// exponent past [`MAX_EXPONENT`]
    ExponentTooLarge,
}

impl fmt::Display for LiteralError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LiteralError::Malformed => {
                write!(
                    f,
                    "not a number (expected digits[.digits][e[+-]digits] or integer/integer)"
                )
            }
            LiteralError::BadDenominator => write!(f, "the denominator must be positive"),
            LiteralError::TooManyDigits => write!(f, "more than {MAX_DIGITS} digits in one number"),
            LiteralError::ExponentTooLarge => {
                write!(f, "the exponent is larger than {MAX_EXPONENT} in size")
            }
        }
    }
}
impl std::error::Error for LiteralError {}

/// Most digits in one literal (both parts of a fraction together; the exponent's do not count).
pub const MAX_DIGITS: usize = 100_000;
/// Largest exponent in size.
pub const MAX_EXPONENT: i64 = 100_000;

/// The leading run of digits, and what follows it.
fn digits(s: &str) -> (&str, &str) {
    s.split_at(s.bytes().take_while(u8::is_ascii_digit).count())
}

/// The value of a run of digits.
fn value(s: &str) -> Result<Int, LiteralError> {
    if s.is_empty() {
        return Err(LiteralError::Malformed);
    }
    if s.len() <= 18 {
        return Ok(Int::from(
            s.bytes().fold(0i64, |v, c| v * 10 + (c - b'0') as i64),
        ));
    }
    s.parse().map_err(|_| LiteralError::Malformed)
}

/// Reads `[+-]digits[.digits][e[+-]digits]` or `[+-]integer/integer` exactly. The denominator may carry a
/// sign by the grammar, but must be positive.
///
/// # Errors
/// See [`LiteralError`]; text outside the grammar is `Malformed` whatever its length.
pub fn parse(text: &str) -> Result<Rat, LiteralError> {
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let (whole, rest) = digits(unsigned);
    if whole.is_empty() {
        return Err(LiteralError::Malformed);
    }
    let size = if let Some(den) = rest.strip_prefix('/') {
        fraction(whole, den)?
    } else {
        decimal(whole, rest)?
    };
    Ok(if text.starts_with('-') { -size } else { size })
}

fn fraction(num: &str, den: &str) -> Result<Rat, LiteralError> {
    let size = den.strip_prefix(['+', '-']).unwrap_or(den);
    let (d, rest) = digits(size);
    if d.is_empty() || !rest.is_empty() {
        return Err(LiteralError::Malformed);
    }
    if den.starts_with('-') || d.bytes().all(|c| c == b'0') {
        return Err(LiteralError::BadDenominator);
    }
    if num.len() + d.len() > MAX_DIGITS {
        return Err(LiteralError::TooManyDigits);
    }
    Ok(Rat::new(value(num)?, value(d)?))
}

fn decimal(whole: &str, rest: &str) -> Result<Rat, LiteralError> {
    let (frac, rest) = match rest.strip_prefix('.') {
        Some(r) => {
            let (f, r) = digits(r);
            if f.is_empty() {
                return Err(LiteralError::Malformed);
            }
            (f, r)
        }
        None => ("", rest),
    };
    let exponent = match rest.strip_prefix(['e', 'E']) {
        Some(r) => {
            let size = r.strip_prefix(['+', '-']).unwrap_or(r);
            let (d, tail) = digits(size);
            if d.is_empty() || !tail.is_empty() {
                return Err(LiteralError::Malformed);
            }
            // Leading zeros are harmless; more than six digits are past the limit anyway.
            let d = d.trim_start_matches('0');
            let size = if d.len() > 6 {
                i64::MAX
            } else {
                d.bytes().fold(0, |v, c| v * 10 + (c - b'0') as i64)
            };
            if size > MAX_EXPONENT {
                return Err(LiteralError::ExponentTooLarge);
            }
            if r.starts_with('-') { -size } else { size }
        }
        None if rest.is_empty() => 0,
        None => return Err(LiteralError::Malformed),
    };
    if whole.len() + frac.len() > MAX_DIGITS {
        return Err(LiteralError::TooManyDigits);
    }
    // The significant digits and the power of ten they are multiplied with, zeros at the end taken off.
    let all = [whole, frac].concat();
    let significant = all.trim_end_matches('0');
    if significant.is_empty() {
        return Ok(Rat::zero());
    }
    let exponent = exponent - frac.len() as i64 + (all.len() - significant.len()) as i64;
    let m = value(significant)?;
    let ten = |k: u64| Int::from(5i64).pow(k as u32).shl(k);
    if exponent >= 0 {
        return Ok(Rat::from(m * ten(exponent as u64)));
    }
    let k = exponent.unsigned_abs();
    Ok(Rat::new(m, ten(k)))
}
