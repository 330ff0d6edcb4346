//! `--set name=value`: changes to the tree before anything is made of it, so that an override is
//! judged by the same rules, and blamed by its own place, as if it stood in the file.

use super::convert::{clip, nearest};
use super::diagnostic::Diagnostic;
use super::source::{Source, Sources, Span};
use super::toml;
use super::tree::{Entry, Kind, Node};

/// Replaces values of a tree, in the order given. A path is made of keys, indices, and names of
/// tables in a list (`pawl.left.stiffness`), joined by dots; a step with a dot in it is put in
/// double quotes. The last key may be new to its table. The new value is a TOML value, or else a
/// bare word: `3`, `1/3`, `true`, `"left"`, `[["0","0"],["1","0"],["0","1"]]`.
///
/// # Errors
/// `unknown-override` for every path that leads nowhere; the others are applied.
pub fn apply_overrides(
    tree: &mut Node,
    overrides: &[(&str, &str)],
) -> Result<Sources, Vec<Diagnostic>> {
    let mut sources = Sources::new();
    // Index 0 stands for the file, as everywhere.
    sources.add(Source::new("", ""));
    apply_overrides_at(tree, &mut sources, overrides)?;
    Ok(sources)
}

/// [`apply_overrides`] that adds the texts of the overrides to the given sources.
pub(super) fn apply_overrides_at(
    tree: &mut Node,
    sources: &mut Sources,
    overrides: &[(&str, &str)],
) -> Result<(), Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    for (path, value) in overrides {
        let source = sources.add(Source::new("--set", &format!("{path}={value}")));
        let value_at = path.len() + 1;
        if let Err(diagnostic) = apply(tree, sources, source, path, value, value_at) {
            diagnostics.push(diagnostic);
        }
    }
    if diagnostics.is_empty() {
        Ok(())
    } else {
        Err(diagnostics)
    }
}

fn apply(
    tree: &mut Node,
    sources: &Sources,
    source: usize,
    path: &str,
    value: &str,
    value_at: usize,
) -> Result<(), Diagnostic> {
    let steps = steps(path);
    let mut node = tree;
    for (k, (step, start)) in steps.iter().enumerate() {
        let span = Span {
            source,
            start: *start,
            end: start + step.len(),
        };
        let last = k + 1 == steps.len();
        node = descend(node, step, span, last).map_err(|choices| {
            Diagnostic::error(sources, span, "unknown-override")
                .message(format!("there is no `{step}` here to set"))
                .help(choices)
        })?;
    }
    *node = read_value(value, source, value_at);
    Ok(())
}

/// The steps of a path with their byte offsets; quotes keep a step with dots together.
fn steps(path: &str) -> Vec<(String, usize)> {
    let mut steps = vec![(String::new(), 0)];
    let mut quoted = false;
    for (at, c) in path.char_indices() {
        match c {
            '"' => quoted = !quoted,
            '.' if !quoted => steps.push((String::new(), at + 1)),
            _ => {
                if let Some((step, _)) = steps.last_mut() {
                    step.push(c);
                }
            }
        }
    }
    steps
}

/// One step down; Err says what could have been chosen.
fn descend<'a>(
    node: &'a mut Node,
    step: &str,
    span: Span,
    last: bool,
) -> Result<&'a mut Node, String> {
    let what = node.describe();
    match &mut node.kind {
        Kind::Table(entries) => {
            let found = entries.iter().position(|e| e.key == step);
            let place = match found {
                Some(place) => place,
                // A new key is judged by the conversion, which knows the format.
                None if last && !step.is_empty() => {
                    entries.push(Entry {
                        key: step.to_owned(),
                        key_span: span,
                        value: Node {
                            span,
                            kind: Kind::Bool(false),
                        },
                    });
                    entries.len() - 1
                }
                // `--set classify.total=true` makes the section that it needs.
                None if matches!(step, "classify" | "step" | "objective") => {
                    entries.push(Entry {
                        key: step.to_owned(),
                        key_span: span,
                        value: Node {
                            span,
                            kind: Kind::Table(Vec::new()),
                        },
                    });
                    entries.len() - 1
                }
                None => {
                    let keys: Vec<&str> = entries.iter().map(|e| e.key.as_str()).collect();
                    return Err(match nearest(step, &keys) {
                        Some(meant) => format!("did you mean `{meant}`?"),
                        None => format!("choose one of: {}", listed(&keys)),
                    });
                }
            };
            Ok(&mut entries[place].value)
        }
        Kind::Array(items) => {
            let count = items.len();
            let named = items.iter().position(
                |item| matches!(item.get("name").map(|n| &n.kind), Some(Kind::String(s)) if s == step),
            );
            let place = named.or_else(|| step.parse().ok().filter(|&k: &usize| k < count));
            match place {
                Some(place) => Ok(&mut items[place]),
                None if count == 0 => Err("the list is empty".to_owned()),
                None => {
                    let names: Vec<&str> = items
                        .iter()
                        .filter_map(|item| match item.get("name").map(|n| &n.kind) {
                            Some(Kind::String(s)) => Some(s.as_str()),
                            _ => None,
                        })
                        .collect();
                    let index = match count {
                        1 => "the index 0".to_owned(),
                        _ => format!("an index from 0 to {}", count - 1),
                    };
                    Err(match nearest(step, &names) {
                        Some(meant) => format!("did you mean `{meant}`?"),
                        None if names.is_empty() => format!("choose {index}"),
                        None => format!("choose {index}, or a name: {}", listed(&names)),
                    })
                }
            }
        }
        _ => Err(format!("{what} has no parts")),
    }
}

/// The first few of what there is, for a message.
fn listed(names: &[&str]) -> String {
    const MOST: usize = 12;
    let mut text: Vec<String> = names.iter().take(MOST).map(|n| clip(n)).collect();
    if names.len() > MOST {
        text.push("…".to_owned());
    }
    text.join(", ")
}

/// A TOML value where it reads as one; anything else is a string, which may be a number.
fn read_value(text: &str, source: usize, offset: usize) -> Node {
    let trimmed = text.trim();
    let leading = text.len() - text.trim_start().len();
    let compound =
        trimmed.starts_with(['[', '{', '"', '\'']) || trimmed == "true" || trimmed == "false";
    let node = compound
        .then(|| toml::read_value(text, source, offset))
        .flatten();
    node.unwrap_or_else(|| Node {
        span: Span {
            source,
            start: offset + leading,
            end: offset + leading + trimmed.len(),
        },
        kind: Kind::String(trimmed.to_owned()),
    })
}
