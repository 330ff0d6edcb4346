//! JSON to tree and back: RFC 8259 strictly, with places, and numbers left as their text.
//!
//! The usual readers either turn numbers into doubles, or forget where things stood, or accept
//! more than JSON; a strict one that keeps both is short, and the tests hold it against
//! `serde_json`.

use super::diagnostic::Diagnostic;
use super::source::{Sources, Span};
use super::tree::{Entry, Kind, MAX_DEPTH, Node};
use std::collections::HashSet;
use std::fmt::Write as _;

pub(super) fn read(sources: &Sources, index: usize) -> Result<Node, Diagnostic> {
    let mut reader = Reader {
        sources,
        index,
        text: sources.get(index).text(),
        at: 0,
        depth: 0,
    };
    reader.skip_blanks();
    let node = reader.value()?;
    reader.skip_blanks();
    if reader.at < reader.text.len() {
        return Err(reader.unexpected("nothing after the value"));
    }
    Ok(node)
}

struct Reader<'a> {
    sources: &'a Sources,
    index: usize,
    text: &'a str,
    at: usize,
    depth: usize,
}

impl Reader<'_> {
    fn span(&self, start: usize, end: usize) -> Span {
        Span {
            source: self.index,
            start,
            end,
        }
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn skip_blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    /// Takes one byte if it is the one that is asked for.
    fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn error(&self, start: usize, end: usize, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(self.sources, self.span(start, end), "syntax")
            .message(format!("this is not JSON: {}", message.into()))
            .help(
                "JSON has no comments, no trailing commas, and keys and fractions in double quotes",
            )
    }

    /// An error at the next character.
    fn unexpected(&self, expected: &str) -> Diagnostic {
        match self.text[self.at..].chars().next() {
            Some(c) => self.error(
                self.at,
                self.at + c.len_utf8(),
                format!("expected {expected}, found `{}`", c.escape_debug()),
            ),
            None => self.error(
                self.at,
                self.at,
                format!("expected {expected}, but the text ends"),
            ),
        }
    }

    fn value(&mut self) -> Result<Node, Diagnostic> {
        let start = self.at;
        let kind = match self.peek() {
            Some(open @ (b'{' | b'[')) => {
                if self.depth == MAX_DEPTH {
                    let span = self.span(start, start + 1);
                    return Err(Diagnostic::error(self.sources, span, "nested-too-deep")
                        .message(format!("more than {MAX_DEPTH} levels of nesting"))
                        .help("a scene needs five levels"));
                }
                self.at += 1;
                self.depth += 1;
                let kind = if open == b'{' {
                    Kind::Table(self.members()?)
                } else {
                    Kind::Array(self.items()?)
                };
                self.depth -= 1;
                kind
            }
            Some(b'"') => Kind::String(self.string()?),
            Some(b'-' | b'0'..=b'9') => Kind::Number(self.number()?),
            Some(b't') => self.word("true", Kind::Bool(true))?,
            Some(b'f') => self.word("false", Kind::Bool(false))?,
            Some(b'n') => self.word("null", Kind::Other("null"))?,
            _ => return Err(self.unexpected("a value")),
        };
        Ok(Node {
            span: self.span(start, self.at),
            kind,
        })
    }

    fn word(&mut self, word: &str, kind: Kind) -> Result<Kind, Diagnostic> {
        if self.text[self.at..].starts_with(word) {
            self.at += word.len();
            Ok(kind)
        } else {
            Err(self.unexpected("a value"))
        }
    }

    fn members(&mut self) -> Result<Vec<Entry>, Diagnostic> {
        let mut entries: Vec<Entry> = Vec::new();
        let mut seen = HashSet::new();
        self.skip_blanks();
        if self.take(b'}') {
            return Ok(entries);
        }
        loop {
            let start = self.at;
            if self.peek() != Some(b'"') {
                return Err(self.unexpected("a key in double quotes"));
            }
            let key = self.string()?;
            let key_span = self.span(start, self.at);
            if !seen.insert(key.clone()) {
                return Err(Diagnostic::error(self.sources, key_span, "duplicate-key")
                    .message(format!("`{key}` stands here twice"))
                    .help("keep one of the two"));
            }
            self.skip_blanks();
            if !self.take(b':') {
                return Err(self.unexpected("`:`"));
            }
            self.skip_blanks();
            let value = self.value()?;
            entries.push(Entry {
                key,
                key_span,
                value,
            });
            self.skip_blanks();
            if self.take(b'}') {
                return Ok(entries);
            }
            if !self.take(b',') {
                return Err(self.unexpected("`,` or `}`"));
            }
            self.skip_blanks();
        }
    }

    fn items(&mut self) -> Result<Vec<Node>, Diagnostic> {
        let mut items = Vec::new();
        self.skip_blanks();
        if self.take(b']') {
            return Ok(items);
        }
        loop {
            items.push(self.value()?);
            self.skip_blanks();
            if self.take(b']') {
                return Ok(items);
            }
            if !self.take(b',') {
                return Err(self.unexpected("`,` or `]`"));
            }
            self.skip_blanks();
        }
    }

    /// `-? (0 | [1-9][0-9]*) (. [0-9]+)? ([eE] [+-]? [0-9]+)?`
    fn number(&mut self) -> Result<String, Diagnostic> {
        let start = self.at;
        self.take(b'-');
        if !self.take(b'0') {
            self.digits()?;
        }
        if self.take(b'.') {
            self.digits()?;
        }
        if self.take(b'e') || self.take(b'E') {
            let _signed = self.take(b'+') || self.take(b'-');
            self.digits()?;
        }
        Ok(self.text[start..self.at].to_owned())
    }

    fn digits(&mut self) -> Result<(), Diagnostic> {
        if !matches!(self.peek(), Some(b'0'..=b'9')) {
            return Err(self.unexpected("a digit"));
        }
        while matches!(self.peek(), Some(b'0'..=b'9')) {
            self.at += 1;
        }
        Ok(())
    }

    fn string(&mut self) -> Result<String, Diagnostic> {
        let open = self.at;
        self.at += 1;
        let mut out = String::new();
        loop {
            let Some(c) = self.text[self.at..].chars().next() else {
                return Err(self.error(open, open + 1, "this string never ends"));
            };
            match c {
                '"' => {
                    self.at += 1;
                    return Ok(out);
                }
                '\\' => out.push(self.escape()?),
                '\u{0}'..='\u{1f}' => {
                    return Err(self.error(
                        self.at,
                        self.at + 1,
                        format!("`{}` inside a string must be escaped", c.escape_debug()),
                    ));
                }
                _ => {
                    out.push(c);
                    self.at += c.len_utf8();
                }
            }
        }
    }

    fn escape(&mut self) -> Result<char, Diagnostic> {
        let start = self.at;
        self.at += 1;
        let plain = match self.peek() {
            Some(c @ (b'"' | b'\\' | b'/')) => Some(char::from(c)),
            Some(b'b') => Some('\u{8}'),
            Some(b'f') => Some('\u{c}'),
            Some(b'n') => Some('\n'),
            Some(b'r') => Some('\r'),
            Some(b't') => Some('\t'),
            Some(b'u') => None,
            _ => return Err(self.error(start, self.at, "unknown escape in a string")),
        };
        self.at += 1;
        if let Some(c) = plain {
            return Ok(c);
        }
        let first = self.hex4(start)?;
        let code = match first {
            // A character past U+FFFF is written as two escapes, high surrogate first.
            0xd800..=0xdbff if self.text[self.at..].starts_with("\\u") => {
                self.at += 2;
                let second = self.hex4(start)?;
                if (0xdc00..=0xdfff).contains(&second) {
                    0x10000 + ((first - 0xd800) << 10) + (second - 0xdc00)
                } else {
                    first
                }
            }
            _ => first,
        };
        char::from_u32(code)
            .ok_or_else(|| self.error(start, self.at, "half of a surrogate pair in a string"))
    }

    fn hex4(&mut self, start: usize) -> Result<u32, Diagnostic> {
        let digits = self.text.as_bytes().get(self.at..self.at + 4);
        let value = digits.and_then(|digits| {
            digits.iter().try_fold(0, |value, &digit| {
                Some(value * 16 + char::from(digit).to_digit(16)?)
            })
        });
        match value {
            Some(value) => {
                self.at += 4;
                Ok(value)
            }
            None => Err(self.error(start, self.at, "\\u needs four hexadecimal digits")),
        }
    }
}

/// Writes a tree as JSON on one line.
pub(super) fn write(node: &Node, out: &mut String) {
    match &node.kind {
        Kind::Table(entries) => {
            out.push('{');
            for (k, entry) in entries.iter().enumerate() {
                if k > 0 {
                    out.push(',');
                }
                write_string(&entry.key, out);
                out.push(':');
                write(&entry.value, out);
            }
            out.push('}');
        }
        Kind::Array(items) => {
            out.push('[');
            for (k, item) in items.iter().enumerate() {
                if k > 0 {
                    out.push(',');
                }
                write(item, out);
            }
            out.push(']');
        }
        Kind::String(s) => write_string(s, out),
        Kind::Number(text) if is_number(text) => out.push_str(text),
        Kind::Number(text) => write_string(text, out),
        Kind::Bool(b) => out.push_str(if *b { "true" } else { "false" }),
        Kind::Other(_) => out.push_str("null"),
    }
}

fn is_number(text: &str) -> bool {
    let mut sources = Sources::new();
    let index = sources.add(super::source::Source::new("", text));
    !text.starts_with('\u{feff}')
        && read(&sources, index).is_ok_and(|node| matches!(node.kind, Kind::Number(_)))
}

fn write_string(s: &str, out: &mut String) {
    out.push('"');
    for c in s.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            // Control characters by their code; writing to a string cannot fail.
            '\u{0}'..='\u{1f}' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            _ => out.push(c),
        }
    }
    out.push('"');
}
