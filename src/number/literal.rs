//! Exact number literals (the contract's grammar). STUB.
use super::Rat;
/// Why a literal was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LiteralError {
    /** not a number of this grammar */
    Malformed,
    /** denominator zero or negative */
    BadDenominator,
    /** past MAX_DIGITS */
    TooManyDigits,
    /** exponent past MAX_EXPONENT */
    ExponentTooLarge,
}
/// Most digits in one literal.
pub const MAX_DIGITS: usize = 100_000;
/// Largest exponent in size.
pub const MAX_EXPONENT: i64 = 100_000;
/// Reads `[+-]digits[.digits][e[+-]digits]` or `[+-]integer/integer` exactly.
pub fn parse(_text: &str) -> Result<Rat, LiteralError> {
    todo!()
}
