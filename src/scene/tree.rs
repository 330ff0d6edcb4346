//! One tree for both notations: every key and value with its place, every number still text.

use super::diagnostic::Diagnostic;
use super::source::{Sources, Span};
use super::{json, toml};

/// Deepest nesting of arrays and tables that is read; a scene needs five.
pub const MAX_DEPTH: usize = 64;

/// A value and its place.
#[derive(Clone, Debug)]
pub struct Node {
    /// Where it stands. A TOML table under a header has the header's place.
    pub span: Span,
    /// What it is.
    pub kind: Kind,
}

/// What a value is.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A table or object, in the order of the text, keys unique.
    Table(Vec<Entry>),
    /// An array.
    Array(Vec<Node>),
    /// A string, escapes undone.
    String(String),
    /// A bare number, exactly as it is written.
    Number(String),
    /// `true` or `false`.
    Bool(bool),
    /// Something that no scene holds: a TOML date or time, a JSON null.
    Other(&'static str),
}

/// A key with its value.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The key, escapes undone.
    pub key: String,
    /// Where the key stands.
    pub key_span: Span,
    /// Its value.
    pub value: Node,
}

/// How a tree is written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    /// TOML 1.1.
    Toml,
    /// JSON, RFC 8259, strictly.
    Json,
}

impl Notation {
    /// JSON for a name that ends in `.json` or a text that begins with `{`, otherwise TOML.
    pub fn of(name: &str, text: &str) -> Notation {
        let json_name = name
            .rsplit_once('.')
            .is_some_and(|(_, ext)| ext.eq_ignore_ascii_case("json"));
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        // No TOML document begins with a brace, so the text may overrule a missing extension.
        if json_name || text.trim_start().starts_with('{') {
            Notation::Json
        } else {
            Notation::Toml
        }
    }
}

/// Reads source `index` as a tree in the given notation.
///
/// # Errors
/// One or several [`Diagnostic`]s with code `syntax`, `duplicate-key` or `nested-too-deep`.
pub fn read_tree(
    sources: &Sources,
    index: usize,
    notation: Notation,
) -> Result<Node, Vec<Diagnostic>> {
    match notation {
        Notation::Toml => toml::read(sources, index),
        Notation::Json => json::read(sources, index).map_err(|e| vec![e]),
    }
}

impl Node {
    /// What it is, in words for a message.
    pub(crate) fn describe(&self) -> &'static str {
        match &self.kind {
            Kind::Table(_) => "a table",
            Kind::Array(_) => "an array",
            Kind::String(_) => "a string",
            Kind::Number(_) => "a number",
            Kind::Bool(_) => "a boolean",
            Kind::Other(what) => what,
        }
    }

    /// The value of a key of a table.
    pub fn get(&self, key: &str) -> Option<&Node> {
        match &self.kind {
            Kind::Table(entries) => entries.iter().find(|e| e.key == key).map(|e| &e.value),
            _ => None,
        }
    }

    /// The value at a dotted path of keys and indices, such as `pawl.0.stiffness`.
    pub fn find(&self, path: &str) -> Option<&Node> {
        path.split('.')
            .try_fold(self, |node, step| match &node.kind {
                Kind::Array(items) => items.get(step.parse::<usize>().ok()?),
                _ => node.get(step),
            })
    }

    /// The tree as JSON text on one line. A bare number that JSON has no notation for (`+1`)
    /// becomes a string, which a scene reads alike; [`Kind::Other`] becomes null.
    pub fn to_json(&self) -> String {
        let mut out = String::new();
        json::write(self, &mut out);
        out
    }
}
