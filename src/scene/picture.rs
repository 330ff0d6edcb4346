//! The picture of a diagnostic: its line, the place underlined. `miette` draws; what is done here
//! is to count columns in characters and to cut a long line around the place.

use super::diagnostic::{Diagnostic, Rendering, Severity};
use super::source::Source;
use miette::{
    GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError, MietteSpanContents,
    SourceCode, SourceSpan, SpanContents,
};
use std::fmt;

/// Draws a diagnostic; where drawing fails, the one line that says it all.
pub(super) fn draw(diagnostic: &Diagnostic, source: &Source, rendering: Rendering) -> String {
    let theme = match rendering {
        Rendering::Plain => GraphicalTheme::none(),
        Rendering::Unicode => GraphicalTheme::unicode_nocolor(),
        Rendering::Colour => GraphicalTheme::unicode(),
    };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_links(false)
        .with_context_lines(1);
    let mut out = String::new();
    match handler.render_report(&mut out, &Picture { diagnostic, source }) {
        Ok(()) => out,
        Err(fmt::Error) => format!("{diagnostic}\n"),
    }
}

/// A diagnostic as `miette` wants it.
#[derive(Debug)]
struct Picture<'a> {
    diagnostic: &'a Diagnostic,
    source: &'a Source,
}

impl fmt::Display for Picture<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.diagnostic.text())
    }
}

impl std::error::Error for Picture<'_> {}

impl miette::Diagnostic for Picture<'_> {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.diagnostic.code()))
    }
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity() {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
        })
    }
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let advice = self.diagnostic.advice();
        advice.map(|help| Box::new(help) as _)
    }
    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(self.source)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        // An underline over many lines helps nobody: it ends with the first.
        let span = self.diagnostic.span();
        let line_end = self.source.line_range(span.start).end;
        let start = span.start.min(line_end);
        let window_end = window_around(self.source.text(), start).1;
        let end = span.end.min(line_end).min(window_end);
        let label = LabeledSpan::new(None, start, end.saturating_sub(start));
        Some(Box::new(std::iter::once(label)))
    }
}

/// Longest excerpt of one line to either side of the place, in bytes: a file may be one line.
const WINDOW: usize = 100;

/// The byte range of the excerpt that is shown around an offset.
fn window_around(text: &str, at: usize) -> (usize, usize) {
    let mut from = at.saturating_sub(WINDOW);
    while !text.is_char_boundary(from) {
        from += 1;
    }
    let mut to = (at + WINDOW).min(text.len());
    while !text.is_char_boundary(to) {
        to -= 1;
    }
    (from, to)
}

/// Shows the line of a place; columns count in characters, and a long line is cut.
impl SourceCode for Source {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        _lines_before: usize,
        _lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let text = self.text();
        let at = span.offset().min(text.len());
        let line = self.line_range(at);
        let (from, to) = window_around(text, at);
        let (from, to) = (from.max(line.start), to.min(line.end).max(at));
        let (number, column) = self.line_column(at);
        Ok(Box::new(MietteSpanContents::new_named(
            self.name().to_owned(),
            &text.as_bytes()[from..to],
            SourceSpan::from((from, to - from)),
            number - 1,
            column - 1,
            1,
        )))
    }
}
