//! Places in texts: spans, and the lines and columns that people count.

use std::ops::Range;
use std::sync::Arc;

/// A text with a name: the file, or one `--set` argument.
#[derive(Debug)]
pub struct Source {
    name: String,
    text: String,
    /// Byte offsets at which lines start.
    lines: Vec<usize>,
}

impl Source {
    /// Takes a text. A byte order mark in front is dropped and counts in no span and no column.
    pub fn new(name: &str, text: &str) -> Source {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let starts = text.match_indices('\n').map(|(at, _)| at + 1);
        Source {
            name: name.to_owned(),
            text: text.to_owned(),
            lines: std::iter::once(0).chain(starts).collect(),
        }
    }

    /// The name that messages show.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text that spans refer to.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Line and column of a byte offset, both from 1, the column in characters. An offset past
    /// the end is the end; one inside a character is that character; one inside a line end of two
    /// characters is that line end.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let line = self.lines.partition_point(|&start| start <= offset);
        let start = self.lines[line - 1];
        let offset = offset.min(self.line_range(offset).end);
        let before = self.text[start..]
            .char_indices()
            .take_while(|(at, c)| start + at + c.len_utf8() <= offset)
            .count();
        (line, before + 1)
    }

    /// The byte range of the line that an offset lies in, without its line end.
    pub(crate) fn line_range(&self, offset: usize) -> Range<usize> {
        let line = self.lines.partition_point(|&start| start <= offset);
        let start = self.lines[line - 1];
        let end = self
            .lines
            .get(line)
            .map_or(self.text.len(), |&next| next - 1);
        let end = start + self.text[start..end].trim_end_matches('\r').len();
        start..end
    }
}

/// A byte range in one of several sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// Which source: 0 for the file, then the overrides in order.
    pub source: usize,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// The bytes.
    pub fn range(&self) -> Range<usize> {
        self.start..self.end
    }
}

/// The texts that one tree was made from: the file first, then the overrides.
#[derive(Clone, Debug, Default)]
pub struct Sources(Vec<Arc<Source>>);

impl Sources {
    /// No texts yet.
    pub fn new() -> Sources {
        Sources::default()
    }

    /// Adds a text and returns its index for [`Span::source`].
    pub fn add(&mut self, source: Source) -> usize {
        self.0.push(Arc::new(source));
        self.0.len() - 1
    }

    /// The source of an index. Panics if there is none.
    pub fn get(&self, index: usize) -> &Arc<Source> {
        &self.0[index]
    }

    /// The text of a span.
    pub fn text(&self, span: Span) -> &str {
        self.0[span.source].text.get(span.range()).unwrap_or("")
    }
}
