//! What is wrong, where, and what to do about it.
//!
//! A [`Diagnostic`] holds its source, so it can be shown long after the reader is gone: in one
//! line for a list, or as a picture of the line with the place underlined.

use super::picture;
use super::source::{Source, Sources, Span};
use std::fmt;
use std::sync::Arc;

/// Every code that reading and checking a scene can give, with what it means. The codes are
/// stable: scripts may rely on them.
pub const CODES: &[(&str, &str)] = &[
    ("not-utf8", "the file is not UTF-8 text"),
    ("too-large", "the file is larger than the documented limit"),
    ("syntax", "the text is neither TOML nor JSON"),
    ("duplicate-key", "a key stands twice in one table"),
    (
        "nested-too-deep",
        "arrays and tables are nested past the limit",
    ),
    ("unknown-key", "a key that the format does not know"),
    ("missing-key", "a key that must be there is not"),
    (
        "wrong-type",
        "a value of another type than the format asks for",
    ),
    ("malformed-number", "not a number of the contract's grammar"),
    (
        "bad-denominator",
        "a fraction whose denominator is zero or negative",
    ),
    (
        "number-too-large",
        "a number, or all numbers together, past the documented limits",
    ),
    ("unknown-override", "a --set path that leads nowhere"),
    (
        "too-few-vertices",
        "a polygon with fewer than three vertices",
    ),
    (
        "too-many-vertices",
        "more vertices than the documented limit",
    ),
    ("zero-area", "a polygon whose vertices lie on one line"),
    ("zero-length-edge", "two consecutive vertices coincide"),
    ("spike", "a boundary that turns back on itself"),
    ("edges-meet", "a polygon whose edges cross or touch"),
    ("hole-outside", "a hole that is not inside its obstacle"),
    ("holes-overlap", "two holes that overlap"),
    ("no-obstacle", "a scene without an obstacle"),
    ("no-pawl", "a scene without a pawl"),
    ("no-motion", "a scene without a motion"),
    ("duplicate-name", "two obstacles, or two pawls, of one name"),
    ("friction-negative", "a negative coefficient of friction"),
    (
        "stiffness-not-positive",
        "a stiffness that is zero or negative",
    ),
    (
        "limits-order",
        "limits whose lower end is not below the upper one",
    ),
    ("start-outside-limits", "a start outside the limits"),
    (
        "start-penetrates",
        "a pawl or the root starts inside an obstacle",
    ),
    ("zero-velocity", "a velocity of zero"),
    (
        "duration-not-positive",
        "a duration that is zero or negative",
    ),
    (
        "endless-motion",
        "a motion with neither a duration nor an end",
    ),
    ("reverse-first", "a reverse with no phase before it"),
    (
        "reverse-not-alone",
        "a reverse with other keys in its table",
    ),
    ("reverse-false", "`reverse` with another value than true"),
    ("unknown-until", "an `until` that the format does not know"),
    (
        "until-without-root",
        "until = \"root-collision\" in a scene without a root",
    ),
    ("zero-direction", "a direction of zero length"),
    (
        "limit-not-positive",
        "a limit of `classify` that is negative, or zero where it must not be",
    ),
    (
        "shared-name",
        "warning: an obstacle and a pawl share a name",
    ),
    (
        "straight-vertex",
        "warning: a vertex in the middle of a straight edge",
    ),
    ("obstacles-overlap", "warning: obstacles overlap"),
    (
        "some-stiffness",
        "warning: some pawls have a stiffness and others have none",
    ),
    (
        "unused-force-limit",
        "warning: a force limit that no force can reach",
    ),
];

/// The codes that only structures give ([`crate::flex`]); the others are those of [`CODES`].
pub const STRUCTURE_CODES: &[(&str, &str)] = &[
    ("no-body", "a structure without a body"),
    ("unknown-body", "a name that no body of the structure has"),
    (
        "unknown-vertex",
        "an index that the body's polygon does not have",
    ),
    ("joint-with-itself", "a joint whose two bodies are one"),
    (
        "epsilon-not-positive",
        "an epsilon that is zero or negative",
    ),
    (
        "step-not-positive",
        "a rule of [step] that must be positive",
    ),
    ("unknown-path", "a path that is neither fast nor safe"),
    ("fixed-and-pinned", "a body that is fixed and pinned"),
    ("empty-term", "a term of the objective that weighs nothing"),
    ("mixed-term", "keys in one term that do not belong together"),
    (
        "view-cone",
        "a cone of view that is empty or half a plane or more",
    ),
    ("bodies-penetrate", "two bodies overlap at the start"),
];

/// Whether reading failed or went on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Severity {
    /// The scene is refused.
    Error,
    /// The scene is read; something in it is worth a look.
    Warning,
}

/// One thing that is wrong with a file, and its place.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    severity: Severity,
    code: &'static str,
    message: String,
    help: Option<String>,
    span: Span,
    source: Arc<Source>,
}

impl Diagnostic {
    /// A diagnostic of severity error at a place, its message still to be given. `code` must be
    /// one of [`CODES`] or [`STRUCTURE_CODES`].
    pub fn error(sources: &Sources, span: Span, code: &'static str) -> Diagnostic {
        debug_assert!(
            CODES
                .iter()
                .chain(STRUCTURE_CODES)
                .any(|(known, _)| *known == code),
            "{code}"
        );
        Diagnostic {
            severity: Severity::Error,
            code,
            message: String::new(),
            help: None,
            span,
            source: Arc::clone(sources.get(span.source)),
        }
    }

    /// The same as a warning.
    pub fn warning(sources: &Sources, span: Span, code: &'static str) -> Diagnostic {
        Diagnostic {
            severity: Severity::Warning,
            ..Diagnostic::error(sources, span, code)
        }
    }

    /// With a message, which says what is wrong in one sentence without a full stop.
    #[must_use]
    pub fn message(mut self, message: impl Into<String>) -> Diagnostic {
        self.message = message.into();
        self
    }

    /// With a help, which says what to do.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Diagnostic {
        self.help = Some(help.into());
        self
    }

    /// Error or warning.
    pub fn severity(&self) -> Severity {
        self.severity
    }

    /// The stable code, one of [`CODES`].
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// What is wrong.
    pub fn text(&self) -> &str {
        &self.message
    }

    /// What to do about it.
    pub fn advice(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The place, in bytes of [`Diagnostic::source_text`].
    pub fn span(&self) -> Span {
        self.span
    }

    /// The name of the file or argument it is about.
    pub fn source_name(&self) -> &str {
        self.source.name()
    }

    /// The whole text of that file or argument.
    pub fn source_text(&self) -> &str {
        self.source.text()
    }

    /// The offending text itself.
    pub fn offending(&self) -> &str {
        self.source.text().get(self.span.range()).unwrap_or("")
    }

    /// The line, from 1.
    pub fn line(&self) -> usize {
        self.source.line_column(self.span.start).0
    }

    /// The column in characters, from 1.
    pub fn column(&self) -> usize {
        self.source.line_column(self.span.start).1
    }

    /// The diagnostic for people: its line with the place underlined. Contains
    /// `file:line:column` in every rendering.
    pub fn render(&self, rendering: Rendering) -> String {
        picture::draw(self, &self.source, rendering)
    }
}

/// How [`Diagnostic::render`] draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rendering {
    /// ASCII without colours, for pipes and logs.
    Plain,
    /// Line-drawing characters without colours.
    Unicode,
    /// Line-drawing characters and ANSI colours, for a terminal.
    Colour,
}

/// One line: `file:line:column: error[code]: message`.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        let (line, column) = self.source.line_column(self.span.start);
        write!(
            f,
            "{}:{line}:{column}: {severity}[{}]: {}",
            self.source.name(),
            self.code,
            self.message
        )
    }
}

impl std::error::Error for Diagnostic {}

/// Everything that is wrong with a file, as one error. Never empty.
///
/// It is what `?` makes of the diagnostics that [`super::read_scene`] gives.
#[derive(Clone, Debug)]
pub struct SceneError(Vec<Diagnostic>);

impl SceneError {
    /// The single diagnostics, in the order of the file.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.0
    }

    /// All of them for people.
    pub fn render(&self, rendering: Rendering) -> String {
        self.0.iter().map(|d| d.render(rendering)).collect()
    }
}

impl From<Vec<Diagnostic>> for SceneError {
    fn from(diagnostics: Vec<Diagnostic>) -> SceneError {
        SceneError(diagnostics)
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, diagnostic) in self.0.iter().enumerate() {
            if k > 0 {
                writeln!(f)?;
            }
            write!(f, "{diagnostic}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}
