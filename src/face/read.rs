//! Bare arcs from text: one arc a line, exact integers, errors with their place.

use crate::number::{Int, Rat, literal};
use std::fmt;
use std::io::Read;
use std::path::Path;

/// The k-th real root, from below and counted from nought, of c₀ + c₁u + c₂u².
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RootOf {
    /// Coefficients, constant first.
    pub c: [Int; 3],
    /// Which root.
    pub k: u8,
}

/// The graph t = P(u)/Q(u) between two numbers, as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceArc {
    /// P, constant first.
    pub p: [Int; 3],
    /// Q, constant first.
    pub q: [Int; 3],
    /// The left end.
    pub left: RootOf,
    /// The right end.
    pub right: RootOf,
    /// The line it stands on, from 1; 0 if it comes from no file.
    pub line: usize,
}

/// A vertical u = const between the heights of two curves there, which files of arcs do not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Upright {
    /// Where it stands.
    pub u: RootOf,
    /// P and Q of a curve through its lower end.
    pub low: [[Int; 3]; 2],
    /// P and Q of a curve through its upper end.
    pub high: [[Int; 3]; 2],
}

/// What an arcs file holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArcFile {
    /// The point (u, t) whose face is asked for.
    pub start: (Rat, Rat),
    /// The arcs.
    pub arcs: Vec<SourceArc>,
}

/// Why an arcs file could not be read. Line and column count from 1, columns in characters; 0 where the
/// file as a whole is meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// The line.
    pub line: usize,
    /// The column.
    pub column: usize,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.column) {
            (0, _) => f.write_str(&self.message),
            (line, 0) => write!(f, "{line}: {}", self.message),
            (line, column) => write!(f, "{line}:{column}: {}", self.message),
        }
    }
}
impl std::error::Error for ReadError {}

/// The longest number read, in digits: the same limit as in scenes.
const MAX_DIGITS: usize = literal::MAX_DIGITS;
/// The largest text accepted after decompression, in bytes.
const MAX_TEXT: u64 = 4 << 30;

/// The words of a line with their columns.
struct Words<'a> {
    line: usize,
    text: &'a str,
    /// Byte offset of what was not read yet.
    at: usize,
}

impl<'a> Words<'a> {
    fn error(&self, byte: usize, message: impl Into<String>) -> ReadError {
        let column = self.text[..byte.min(self.text.len())].chars().count() + 1;
        ReadError {
            line: self.line,
            column,
            message: message.into(),
        }
    }
    /// The next word and where it begins.
    fn next(&mut self, what: &str) -> Result<(usize, &'a str), ReadError> {
        let rest = &self.text[self.at..];
        let from = self.at + (rest.len() - rest.trim_start().len());
        let word = self.text[from..].split_whitespace().next().unwrap_or("");
        if word.is_empty() {
            return Err(self.error(
                self.text.trim_end().len(),
                format!("the line ends where {what} should stand"),
            ));
        }
        self.at = from + word.len();
        Ok((from, word))
    }
    fn int(&mut self, what: &str) -> Result<Int, ReadError> {
        let (at, word) = self.next(what)?;
        let digits = word.strip_prefix(['+', '-']).unwrap_or(word);
        if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
            return Err(self.error(at, format!("{what}: `{}` is no integer", shorten(word))));
        }
        if digits.len() > MAX_DIGITS {
            return Err(self.error(at, format!("{what}: more than {MAX_DIGITS} digits")));
        }
        // A machine word needs no big-number parser.
        if digits.len() <= 18 {
            let size = digits
                .bytes()
                .fold(0i64, |n, b| n * 10 + i64::from(b - b'0'));
            return Ok(Int::from(if word.starts_with('-') { -size } else { size }));
        }
        word.strip_prefix('+')
            .unwrap_or(word)
            .parse()
            .map_err(|_| self.error(at, format!("{what}: `{}` is no integer", shorten(word))))
    }
    fn ints(&mut self, what: [&str; 3]) -> Result<[Int; 3], ReadError> {
        Ok([self.int(what[0])?, self.int(what[1])?, self.int(what[2])?])
    }
    fn root(&mut self, what: [&str; 4]) -> Result<RootOf, ReadError> {
        let c = self.ints([what[0], what[1], what[2]])?;
        let (at, word) = self.next(what[3])?;
        match word {
            "0" => Ok(RootOf { c, k: 0 }),
            "1" => Ok(RootOf { c, k: 1 }),
            _ => Err(self.error(
                at,
                format!(
                    "{}: a quadratic has the roots 0 and 1, not `{}`",
                    what[3],
                    shorten(word)
                ),
            )),
        }
    }
    fn rational(&mut self, what: &str) -> Result<Rat, ReadError> {
        let (at, word) = self.next(what)?;
        literal::parse(word)
            .map_err(|e| self.error(at, format!("{what}: `{}`: {e}", shorten(word))))
    }
    fn end(&mut self) -> Result<(), ReadError> {
        let rest = &self.text[self.at..];
        let from = self.at + (rest.len() - rest.trim_start().len());
        if from < self.text.len() {
            Err(self.error(from, "more than the line should hold"))
        } else {
            Ok(())
        }
    }
}

fn shorten(word: &str) -> String {
    if word.chars().count() <= 24 {
        word.into()
    } else {
        word.chars().take(24).chain(['…']).collect()
    }
}

impl ArcFile {
    /// Reads the text of an arcs file: `n u t`, then n lines
    /// `P0 P1 P2 Q0 Q1 Q2 l0 l1 l2 lk r0 r1 r2 rk [ul ur kind]`. Empty lines are skipped; what follows the
    /// fourteenth field is for the eye only.
    ///
    /// # Errors
    /// With the place of the first thing that is wrong.
    pub fn parse(text: &str) -> Result<ArcFile, ReadError> {
        // A byte order mark, as some editors write and as scenes may have.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text
            .split('\n')
            .enumerate()
            .map(|(i, text)| Words {
                line: i + 1,
                text: text.strip_suffix('\r').unwrap_or(text),
                at: 0,
            })
            .filter(|w| !w.text.trim().is_empty());
        let missing = |message: String| ReadError {
            line: 0,
            column: 0,
            message,
        };
        let mut head = lines
            .next()
            .ok_or_else(|| missing("the file is empty".into()))?;
        let (at, word) = head.next("the number of arcs")?;
        let count: usize = word.parse().map_err(|_| {
            head.error(
                at,
                format!("the number of arcs: `{}` is none", shorten(word)),
            )
        })?;
        let start = (
            head.rational("the start's u")?,
            head.rational("the start's t")?,
        );
        head.end()?;
        let mut arcs = Vec::with_capacity(count.min(text.len() / 28));
        for mut w in lines {
            if arcs.len() == count {
                return Err(w.error(0, format!("a line past the {count} arcs announced")));
            }
            let p = w.ints(["P0", "P1", "P2"])?;
            let q = w.ints(["Q0", "Q1", "Q2"])?;
            let left = w.root(["l0", "l1", "l2", "lk"])?;
            let right = w.root(["r0", "r1", "r2", "rk"])?;
            arcs.push(SourceArc {
                p,
                q,
                left,
                right,
                line: w.line,
            });
        }
        if arcs.len() < count {
            let found = arcs.len();
            return Err(head.error(at, format!("{count} arcs announced, {found} found")));
        }
        Ok(ArcFile { start, arcs })
    }

    /// Reads a file, unpacked if its first bytes say gzip; `-` is standard input.
    ///
    /// # Errors
    /// Where the file cannot be read, is no text, or see [`ArcFile::parse`].
    pub fn open(path: &Path) -> Result<ArcFile, ReadError> {
        let failed = |e: std::io::Error| ReadError {
            line: 0,
            column: 0,
            message: e.to_string(),
        };
        let mut bytes = Vec::new();
        if path.as_os_str() == "-" {
            std::io::stdin()
                .lock()
                .take(MAX_TEXT)
                .read_to_end(&mut bytes)
                .map_err(failed)?;
        } else {
            std::fs::File::open(path)
                .map_err(failed)?
                .take(MAX_TEXT)
                .read_to_end(&mut bytes)
                .map_err(failed)?;
        }
        if bytes.starts_with(&[0x1f, 0x8b]) {
            let mut text = Vec::new();
            flate2::read::MultiGzDecoder::new(&bytes[..])
                .take(MAX_TEXT)
                .read_to_end(&mut text)
                .map_err(failed)?;
            bytes = text;
        }
        if bytes.len() as u64 >= MAX_TEXT {
            return Err(ReadError {
                line: 0,
                column: 0,
                message: format!("more than {MAX_TEXT} bytes of text"),
            });
        }
        let text = std::str::from_utf8(&bytes).map_err(|e| {
            let before = &bytes[..e.valid_up_to()];
            let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
            let tail = before.rsplit(|&b| b == b'\n').next().unwrap_or(before);
            let column = String::from_utf8_lossy(tail).chars().count() + 1;
            ReadError {
                line,
                column,
                message: "not UTF-8 text".into(),
            }
        })?;
        ArcFile::parse(text)
    }
}
