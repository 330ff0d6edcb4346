//! From tree to scene: which keys there are, which must be there, what type each has.
//!
//! The conversion never stops at the first trouble: what cannot be read is left out and noted,
//! and the rest is still judged. Meaning (polygons, plans, starts) is `validate`'s.

use super::diagnostic::Diagnostic;
use super::source::{Sources, Span};
use super::tree::{Kind, Node};
use super::types::{Classify, Motion, Obstacle, Pawl, Root, Scene};
use crate::number::Rat;

/// The tables of a format and the keys of each.
pub(crate) type Tables = &'static [(&'static str, &'static [&'static str])];

/// The tables of the format and their keys: the one list that the reader, its suggestions and the
/// schema's test go by. The table with the empty name is the file itself.
pub(crate) const TABLES: Tables = &[
    (
        "",
        &["scene", "obstacle", "root", "pawl", "motion", "classify"],
    ),
    ("scene", &["name", "friction"]),
    ("obstacle", &["name", "vertices", "holes"]),
    ("root", &["vertices", "reference"]),
    (
        "pawl",
        &["name", "hinge", "vertices", "stiffness", "start", "limits"],
    ),
    ("motion", &["velocity", "duration", "until", "reverse"]),
    (
        "classify",
        &["directions", "total", "force_limit", "escape_distance"],
    ),
];

/// Most errors that are listed in one run.
pub const MAX_ERRORS: usize = 100;

/// A scene in the making: what could be read, where it stands, and what is wrong so far.
pub(crate) struct Conversion<'a> {
    /// What the file describes, for messages: a scene or a structure.
    noun: &'static str,
    /// The tables of its format.
    tables: Tables,
    pub(crate) tree: &'a Node,
    pub(crate) sources: &'a Sources,
    /// None as soon as a part is missing that the scene cannot be without.
    pub(crate) name: Option<String>,
    pub(crate) friction: Option<Rat>,
    pub(crate) obstacles: Vec<Option<Obstacle>>,
    /// The outer option: whether the file has one; the inner: whether it could be read.
    pub(crate) root: Option<Option<Root>>,
    pub(crate) pawls: Vec<Option<Pawl>>,
    pub(crate) motions: Vec<Option<Motion>>,
    pub(crate) classify: Option<Classify>,
    pub(crate) errors: Vec<Diagnostic>,
    pub(crate) warnings: Vec<Diagnostic>,
    /// Bits of all numbers so far, u64::MAX once the limit has been passed and said.
    pub(crate) bits: u64,
    /// Vertices of all rings so far.
    pub(crate) vertices: usize,
}

impl<'a> Conversion<'a> {
    /// A conversion that has read nothing yet, of a format with other tables than a scene's.
    pub(crate) fn bare(
        noun: &'static str,
        tables: Tables,
        tree: &'a Node,
        sources: &'a Sources,
    ) -> Conversion<'a> {
        Conversion {
            noun,
            tables,
            tree,
            sources,
            name: None,
            friction: None,
            obstacles: Vec::new(),
            root: None,
            pawls: Vec::new(),
            motions: Vec::new(),
            classify: None,
            errors: Vec::new(),
            warnings: Vec::new(),
            bits: 0,
            vertices: 0,
        }
    }

    /// Reads all that can be read of a tree.
    pub(crate) fn of(tree: &'a Node, sources: &'a Sources) -> Conversion<'a> {
        let mut c = Conversion::bare("scene", TABLES, tree, sources);
        if c.table(tree, "") {
            c.scene_section();
            c.obstacles = c.list_of("obstacle", "no-obstacle", Self::obstacle);
            c.root = c.section("root").map(|node| c.root(node));
            c.pawls = c.list_of("pawl", "no-pawl", Self::pawl);
            c.motions = c.list_of("motion", "no-motion", Self::motion);
            c.classify = c.section("classify").map(|node| c.classify(node));
        }
        c
    }

    /// The scene with its warnings, if nothing is wrong with it.
    ///
    /// # Errors
    /// As [`Conversion::settle`].
    pub(crate) fn finish(mut self) -> Result<(Scene, Vec<Diagnostic>), Vec<Diagnostic>> {
        let scene = self.whole();
        self.settle(scene)
    }

    /// The scene, if every part of it could be read; takes the parts.
    fn whole(&mut self) -> Option<Scene> {
        Some(Scene {
            name: self.name.take()?,
            friction: self.friction.take(),
            obstacles: self.obstacles.drain(..).collect::<Option<_>>()?,
            root: match self.root.take() {
                Some(root) => Some(root?),
                None => None,
            },
            pawls: self.pawls.drain(..).collect::<Option<_>>()?,
            motions: self.motions.drain(..).collect::<Option<_>>()?,
            classify: self.classify.take(),
        })
    }

    /// What was made of the file, with the warnings.
    ///
    /// # Errors
    /// What is wrong with it, even where something could be made. Both lists are in the order of
    /// the file.
    pub(crate) fn settle<T>(
        self,
        made: Option<T>,
    ) -> Result<(T, Vec<Diagnostic>), Vec<Diagnostic>> {
        let (mut errors, mut warnings) = (self.errors, self.warnings);
        errors.sort_by_key(Diagnostic::span);
        warnings.sort_by_key(Diagnostic::span);
        match made {
            Some(made) if errors.is_empty() => Ok((made, warnings)),
            _ => Err(errors),
        }
    }

    /// Notes an error at a place, unless there are [`MAX_ERRORS`] already.
    pub(crate) fn error(
        &mut self,
        span: Span,
        code: &'static str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        if self.errors.len() >= MAX_ERRORS {
            return;
        }
        self.errors.push(
            Diagnostic::error(self.sources, span, code)
                .message(message)
                .help(help),
        );
    }

    /// Notes a warning at a place.
    pub(crate) fn warning(
        &mut self,
        span: Span,
        code: &'static str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.warnings.push(
            Diagnostic::warning(self.sources, span, code)
                .message(message)
                .help(help),
        );
    }

    // The sections of the file.

    fn scene_section(&mut self) {
        match self.tree.get("scene") {
            None if misspelt(self.tree, "scene") => {}
            None => self.error(
                self.tree.span,
                "missing-key",
                "the section [scene] is missing",
                "begin the file with [scene] and a name",
            ),
            Some(node) => {
                if self.table(node, "scene") {
                    self.name = self.required(node, "name", Self::string);
                    self.friction = self.optional(node, "friction", Self::number);
                }
            }
        }
    }

    /// An optional section that is a single table.
    pub(crate) fn section(&mut self, key: &'static str) -> Option<&'a Node> {
        let node = self.tree.get(key)?;
        self.table(node, key).then_some(node)
    }

    /// A list of tables; an item that cannot be read leaves a None.
    pub(crate) fn list_of<T>(
        &mut self,
        key: &'static str,
        none: &'static str,
        read: fn(&mut Self, &'a Node) -> Option<T>,
    ) -> Vec<Option<T>> {
        let node = self.tree.get(key);
        let items = match node.map(|n| &n.kind) {
            Some(Kind::Array(items)) => items.as_slice(),
            None => &[],
            Some(_) => {
                let node = node.unwrap_or(self.tree);
                self.error(
                    node.span,
                    "wrong-type",
                    format!("`{key}` is a list of tables, not {}", node.describe()),
                    format!("in TOML write [[{key}]] with double brackets, once for each"),
                );
                return Vec::new();
            }
        };
        if items.is_empty() && (node.is_some() || !misspelt(self.tree, key)) {
            self.error(
                node.unwrap_or(self.tree).span,
                none,
                format!("the {} has no {key}", self.noun),
                format!("add at least one [[{key}]]"),
            );
        }
        items
            .iter()
            .map(|item| {
                if self.table(item, key) {
                    read(self, item)
                } else {
                    None
                }
            })
            .collect()
    }

    fn obstacle(&mut self, node: &'a Node) -> Option<Obstacle> {
        let name = self.required(node, "name", Self::string);
        let vertices = self.required(node, "vertices", Self::ring);
        let holes = match node.get("holes") {
            None => Some(Vec::new()),
            Some(holes) => self.list(holes, "a list of rings", Self::ring),
        };
        Some(Obstacle {
            name: name?,
            vertices: vertices?,
            holes: holes?,
        })
    }

    fn root(&mut self, node: &'a Node) -> Option<Root> {
        let vertices = self.required(node, "vertices", Self::ring);
        let reference = self.optional(node, "reference", Self::point);
        Some(Root {
            vertices: vertices?,
            reference,
        })
    }

    fn pawl(&mut self, node: &'a Node) -> Option<Pawl> {
        let name = self.required(node, "name", Self::string);
        let hinge = self.required(node, "hinge", Self::point);
        let vertices = self.required(node, "vertices", Self::ring);
        let stiffness = self.optional(node, "stiffness", Self::number);
        let start = self.optional(node, "start", Self::number);
        let limits = self.optional(node, "limits", Self::pair);
        let start = start.unwrap_or_else(|| default_start(limits.as_ref()));
        Some(Pawl {
            name: name?,
            hinge: hinge?,
            vertices: vertices?,
            stiffness,
            start,
            limits,
        })
    }

    fn motion(&mut self, node: &'a Node) -> Option<Motion> {
        if let Some(reverse) = node.get("reverse") {
            return self.reverse(node, reverse);
        }
        let velocity = self.required(node, "velocity", Self::point);
        let duration = self.optional(node, "duration", Self::number);
        let until = self.optional(node, "until", Self::string);
        if let (Some(value), Some(until)) = (node.get("until"), &until)
            && until != "root-collision"
        {
            self.error(
                value.span,
                "unknown-until",
                format!("a motion cannot run until `{until}`"),
                "the only end besides a duration is \"root-collision\"",
            );
        }
        Some(Motion::Translate {
            velocity: velocity?,
            duration,
            until_root_collision: until.is_some(),
        })
    }

    fn reverse(&mut self, node: &'a Node, reverse: &'a Node) -> Option<Motion> {
        if !matches!(reverse.kind, Kind::Bool(true)) {
            self.error(
                reverse.span,
                "reverse-false",
                "`reverse` can only be true",
                "leave `reverse` out of a motion with a velocity",
            );
            return None;
        }
        if let Kind::Table(entries) = &node.kind {
            // An unknown key has its own message.
            let known = ["velocity", "duration", "until"];
            let other = entries.iter().find(|e| known.contains(&e.key.as_str()));
            if let Some(other) = other {
                self.error(
                    other.key_span,
                    "reverse-not-alone",
                    format!("`{}` stands beside `reverse`", other.key),
                    "a reverse goes back along the phase before, at its speed, for as long as it lasted: it takes nothing else",
                );
            }
        }
        Some(Motion::Reverse)
    }

    fn classify(&mut self, node: &'a Node) -> Classify {
        let directions = match node.get("directions") {
            None => Vec::new(),
            Some(list) => self
                .list(list, "a list of directions", Self::point)
                .unwrap_or_default(),
        };
        Classify {
            directions,
            total: self.optional(node, "total", Self::boolean).unwrap_or(false),
            force_limit: self.optional(node, "force_limit", Self::number),
            escape_distance: self.optional(node, "escape_distance", Self::number),
        }
    }

    // What sections are made of.

    /// Whether the node is a table; notes the keys that a table of this name does not have.
    pub(crate) fn table(&mut self, node: &Node, name: &'static str) -> bool {
        let whole = format!("a {}", self.noun);
        let shown = if name.is_empty() {
            whole.as_str()
        } else {
            name
        };
        let Kind::Table(entries) = &node.kind else {
            self.error(
                node.span,
                "wrong-type",
                format!("{shown} is a table, not {}", node.describe()),
                if name.is_empty() {
                    "in JSON the file is one object".to_owned()
                } else if matches!(
                    name,
                    "obstacle" | "pawl" | "motion" | "body" | "joint" | "view"
                ) {
                    format!("in TOML write [[{name}]], in JSON a list of objects")
                } else {
                    format!("in TOML write [{name}] once, with single brackets")
                },
            );
            return false;
        };
        let tables = self.tables;
        let keys = tables
            .iter()
            .find(|(table, _)| *table == name)
            .map_or(&[] as &[&str], |(_, keys)| keys);
        for entry in entries {
            if !keys.contains(&entry.key.as_str()) && self.errors.len() < MAX_ERRORS {
                let place = match name {
                    "" => format!("at the top of {whole}"),
                    _ => format!("in `{name}`"),
                };
                self.error(
                    entry.key_span,
                    "unknown-key",
                    format!("`{}` is not a key {place}", clip(&entry.key)),
                    suggestion(&entry.key, keys),
                );
            }
        }
        true
    }

    pub(crate) fn required<T>(
        &mut self,
        table: &'a Node,
        key: &'static str,
        read: fn(&mut Self, &'a Node) -> Option<T>,
    ) -> Option<T> {
        match table.get(key) {
            Some(node) => read(self, node),
            None if misspelt(table, key) => None,
            None => {
                self.error(
                    table.span,
                    "missing-key",
                    format!("`{key}` is missing"),
                    format!(
                        "add {}",
                        EXAMPLES
                            .iter()
                            .find(|(k, _)| *k == key)
                            .map_or(key, |e| e.1)
                    ),
                );
                None
            }
        }
    }

    pub(crate) fn optional<T>(
        &mut self,
        table: &'a Node,
        key: &str,
        read: fn(&mut Self, &'a Node) -> Option<T>,
    ) -> Option<T> {
        table.get(key).and_then(|node| read(self, node))
    }
}

/// What to add where a key is missing.
const EXAMPLES: &[(&str, &str)] = &[
    ("name", "name = \"…\""),
    (
        "vertices",
        "vertices = [[\"0\",\"0\"], [\"1\",\"0\"], [\"0\",\"1\"]]",
    ),
    ("epsilon", "epsilon = \"3/5\""),
    ("position", "position = [\"0\",\"0\"]"),
    ("terms", "terms = [ { body = \"…\", dy = \"1\" } ]"),
    ("hinge", "hinge = [\"0\",\"0\"]"),
    (
        "velocity",
        "velocity = [\"0\",\"-1\"], or reverse = true alone",
    ),
];

/// Zero, or the limit that holds the pawl away from it.
fn default_start(limits: Option<&(Rat, Rat)>) -> Rat {
    match limits {
        Some((lo, _)) if lo.sign() > 0 => lo.clone(),
        Some((_, hi)) if hi.sign() < 0 => hi.clone(),
        _ => Rat::zero(),
    }
}

/// What an unknown key may have been meant to be.
fn suggestion(key: &str, known: &[&str]) -> String {
    match nearest(key, known) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("the keys here are: {}", known.join(", ")),
    }
}

/// The known key that an unknown one is a slip of, if it looks like one.
pub(crate) fn nearest<'k>(key: &str, known: &[&'k str]) -> Option<&'k str> {
    let key = clip(key).to_lowercase();
    let (distance, meant) = known
        .iter()
        .map(|k| (strsim::osa_distance(&key, k), *k))
        .min_by_key(|(distance, _)| *distance)?;
    // A plural, a slip or two: more than that is another word.
    (distance <= 1 + meant.len() / 4).then_some(meant)
}

/// Whether a table has a key that is a slip of this one: then its absence needs no message.
pub(crate) fn misspelt(table: &Node, key: &str) -> bool {
    match &table.kind {
        // Only a file that means harm has more keys than the first few.
        Kind::Table(entries) => entries
            .iter()
            .take(MAX_ERRORS)
            .any(|e| nearest(&e.key, &[key]).is_some()),
        _ => false,
    }
}

/// A text that is short enough for a message.
pub(crate) fn clip(text: &str) -> String {
    const MOST: usize = 40;
    if text.chars().count() <= MOST {
        text.to_owned()
    } else {
        text.chars()
            .take(MOST)
            .chain(std::iter::once('…'))
            .collect()
    }
}
