//! Reading models: every number exactly as written, every error with its line and column.
//!
//! [`read_model`] tells the two formats apart by the file name and, failing that, by the text:
//! an MPS file holds a `ROWS` section. Gzip is recognised by its first two bytes.

mod lpfile;
mod mps;

use super::model::Model;
use crate::number::{Rat, literal};
use std::fmt;
use std::io::Read;

/// Largest decompressed model that is read, in bytes.
pub const MAX_MODEL_BYTES: u64 = 2 << 30;

/// Why a model was refused. Lines and columns count from 1, columns in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LpError {
    /// The file, as named by the caller.
    pub file: String,
    /// Line, 0 where the whole file is meant.
    pub line: usize,
    /// Column in characters, 0 where the whole line is meant.
    pub column: usize,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for LpError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
            if self.column > 0 {
                write!(f, ":{}", self.column)?;
            }
        }
        write!(f, ": {}", self.message)
    }
}

impl std::error::Error for LpError {}

/// An error before the file's name is attached: line, byte offset within the line, message.
#[derive(Debug)]
struct At {
    line: usize,
    column: usize,
    message: String,
}

/// Reads a model from the bytes of an MPS or LP file, gzipped or not.
pub fn read_model(name: &str, bytes: &[u8]) -> Result<Model, LpError> {
    let error = |line, column, message: String| LpError {
        file: name.to_string(),
        line,
        column,
        message,
    };
    let unpacked;
    let bytes = if bytes.starts_with(&[0x1f, 0x8b]) {
        let mut out = Vec::new();
        flate2::read::MultiGzDecoder::new(bytes)
            .take(MAX_MODEL_BYTES + 1)
            .read_to_end(&mut out)
            .map_err(|e| error(0, 0, format!("damaged gzip: {e}")))?;
        unpacked = out;
        &unpacked[..]
    } else {
        bytes
    };
    if bytes.len() as u64 > MAX_MODEL_BYTES {
        return Err(error(
            0,
            0,
            format!("more than {MAX_MODEL_BYTES} bytes of model"),
        ));
    }
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let before = &bytes[..e.valid_up_to()];
        let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
        let start = before
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |p| p + 1);
        let column = String::from_utf8_lossy(&before[start..]).chars().count() + 1;
        error(line, column, "not UTF-8 text".to_string())
    })?;
    // Some editors put a byte order mark before everything.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let base = name.strip_suffix(".gz").unwrap_or(name);
    let lower = base.to_ascii_lowercase();
    let is_mps = if lower.ends_with(".mps") {
        true
    } else if lower.ends_with(".lp") {
        false
    } else {
        text.lines()
            .any(|l| l.get(..4).is_some_and(|s| s.eq_ignore_ascii_case("rows")))
    };
    let result = if is_mps {
        mps::read(text)
    } else {
        lpfile::read(text)
    };
    result.map_err(|at| error(at.line, at.column, at.message))
}

/// Reads one exact number, or says what is wrong with it.
fn number(text: &str) -> Result<Rat, String> {
    if let Some(value) = short_decimal(text) {
        return Ok(value);
    }
    let parsed = match literal::parse(text) {
        Err(literal::LiteralError::Malformed) => literal::parse(&tidy(text)),
        other => other,
    };
    parsed.map_err(|e| match e {
        literal::LiteralError::Malformed => format!("`{}` is not a number", clip(text)),
        literal::LiteralError::BadDenominator => {
            format!("`{}` has a denominator that is not positive", clip(text))
        }
        literal::LiteralError::TooManyDigits => {
            format!("a number of more than {} digits", literal::MAX_DIGITS)
        }
        literal::LiteralError::ExponentTooLarge => {
            format!("an exponent larger than {}", literal::MAX_EXPONENT)
        }
    })
}

/// Plain decimals of at most 18 digits without exponent, the bulk of any file, without detours.
fn short_decimal(text: &str) -> Option<Rat> {
    let bytes = text.as_bytes();
    let (negative, digits) = match bytes.first()? {
        b'-' => (true, &bytes[1..]),
        b'+' => (false, &bytes[1..]),
        _ => (false, bytes),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let (mut value, mut places, mut point, mut any) = (0i64, 0, false, false);
    for &b in digits {
        match b {
            b'0'..=b'9' => {
                value = value * 10 + i64::from(b - b'0');
                any = true;
                places += u32::from(point);
            }
            b'.' if !point => point = true,
            _ => return None,
        }
    }
    if !any {
        return None;
    }
    let value = if negative { -value } else { value };
    Some(Rat::decimal(value, places))
}

/// `1.`, `.5e3` and `1D3`, which old files write, in the stricter grammar of exact literals.
fn tidy(text: &str) -> String {
    let lower = text.to_ascii_lowercase().replace('d', "e");
    let (mantissa, exponent) = match lower.find('e') {
        Some(i) => lower.split_at(i),
        None => (&lower[..], ""),
    };
    let (sign, digits) = match mantissa.strip_prefix(['+', '-']) {
        Some(rest) => mantissa.split_at(mantissa.len() - rest.len()),
        None => ("", mantissa),
    };
    if digits == "." {
        return String::new();
    }
    let lead = if digits.starts_with('.') { "0" } else { "" };
    format!(
        "{sign}{lead}{}{exponent}",
        digits.strip_suffix('.').unwrap_or(digits)
    )
}

/// A piece of hostile input short enough for a message.
fn clip(text: &str) -> String {
    let mut out: String = text.chars().take(40).collect();
    if out.len() < text.len() {
        out.push('…');
    }
    out
}
