//! TOML to tree. The `toml` crate parses and recovers from errors; what is kept here are places,
//! and numbers as the text that stands there.

use super::diagnostic::Diagnostic;
use super::source::{Sources, Span};
use super::tree::{Entry, Kind, Node};
use ::toml::Spanned;
use ::toml::de::{DeTable, DeValue};
use std::ops::Range;

/// Most syntax errors that are passed on; what follows the first few is usually their echo.
const MAX_SYNTAX_ERRORS: usize = 5;

pub(super) fn read(sources: &Sources, index: usize) -> Result<Node, Vec<Diagnostic>> {
    let text = sources.get(index).text();
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        let mut diagnostics: Vec<Diagnostic> = errors
            .iter()
            .take(MAX_SYNTAX_ERRORS)
            .map(|e| syntax_error(sources, index, e))
            .collect();
        // Behind a header that could not be read, keys land in the wrong table: an echo too.
        if diagnostics.iter().any(|d| d.code() != "duplicate-key") {
            diagnostics.retain(|d| d.code() != "duplicate-key");
        }
        diagnostics.sort_by_key(|d| d.span().start);
        diagnostics.dedup_by_key(|d| d.line());
        return Err(diagnostics);
    }
    let place = |range: Range<usize>| Span {
        source: index,
        start: range.start,
        end: range.end,
    };
    let mut root = table_node(text, table.get_ref(), &place);
    root.span = place(0..0);
    Ok(root)
}

/// Reads the value of an override, such as `[["0","0"],["1","0"]]`, standing at `offset` of a
/// source. None where it is no TOML value.
pub(super) fn read_value(text: &str, source: usize, offset: usize) -> Option<Node> {
    let value = DeValue::parse(text).ok()?;
    let place = |range: Range<usize>| Span {
        source,
        start: offset + range.start,
        end: offset + range.end,
    };
    Some(value_node(text, &value, &place))
}

fn syntax_error(sources: &Sources, index: usize, error: &::toml::de::Error) -> Diagnostic {
    let text = sources.get(index).text();
    let range = error.span().unwrap_or(text.len()..text.len());
    let span = Span {
        source: index,
        start: range.start.min(text.len()),
        end: range.end.min(text.len()),
    };
    let message = error.message();
    if message.contains("duplicate key") {
        return Diagnostic::error(sources, span, "duplicate-key")
            .message(format!("`{}` stands here twice", sources.text(span).trim()))
            .help(
                "keep one of the two; a list of tables is written with double brackets, [[name]]",
            );
    }
    if message.contains("recurs") {
        return Diagnostic::error(sources, span, "nested-too-deep")
            .message("arrays or tables are nested too deeply")
            .help("a scene needs five levels");
    }
    let mut diagnostic =
        Diagnostic::error(sources, span, "syntax").message(format!("this is not TOML: {message}"));
    let offending = sources.text(span);
    if offending.contains('/') && offending.chars().any(|c| c.is_ascii_digit()) {
        diagnostic = diagnostic.help("a fraction is written as a string: \"1/3\"");
    } else {
        diagnostic = diagnostic.help("see toml.io for the notation; a scene may also be JSON");
    }
    diagnostic
}

fn table_node(text: &str, table: &DeTable<'_>, place: &dyn Fn(Range<usize>) -> Span) -> Node {
    let mut entries: Vec<Entry> = table
        .iter()
        .map(|(key, value)| Entry {
            key: key.get_ref().to_string(),
            key_span: place(key.span()),
            value: value_node(text, value, place),
        })
        .collect();
    // The crate keeps keys in alphabetical order; messages follow the file.
    entries.sort_by_key(|e| e.key_span.start);
    Node {
        span: Span::default(),
        kind: Kind::Table(entries),
    }
}

fn value_node(
    text: &str,
    value: &Spanned<DeValue<'_>>,
    place: &dyn Fn(Range<usize>) -> Span,
) -> Node {
    let span = place(value.span());
    let kind = match value.get_ref() {
        DeValue::String(s) => Kind::String(s.to_string()),
        // The crate has undone underscores and prefixes; the text itself is what counts.
        DeValue::Integer(_) | DeValue::Float(_) => {
            Kind::Number(text.get(value.span()).unwrap_or("").to_owned())
        }
        DeValue::Boolean(b) => Kind::Bool(*b),
        DeValue::Datetime(_) => Kind::Other("a date or time"),
        DeValue::Array(items) => {
            Kind::Array(items.iter().map(|v| value_node(text, v, place)).collect())
        }
        DeValue::Table(table) => table_node(text, table, place).kind,
    };
    Node { span, kind }
}
