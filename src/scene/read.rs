//! The way in: a name and a text become a scene, or the list of what is wrong. Structures come in
//! by the same door (`text_of`, `tree_of`).

use super::convert::Conversion;
use super::diagnostic::Diagnostic;
use super::overrides::apply_overrides_at;
use super::source::{Source, Sources, Span};
use super::tree::{Node, Notation, read_tree};
use super::types::Scene;
use super::validate;

/// Largest file that is read, in bytes.
pub const MAX_FILE_BYTES: usize = 16 << 20;

/// Most vertices of all polygons of a scene together.
pub const MAX_VERTICES: usize = 100_000;

/// Most bits of all numbers of a scene together (numerators and denominators). A short literal
/// such as `1e100000` stands for a very long number; this keeps their sum within reason, beside
/// the limits on one literal ([`crate::number::literal`]).
pub const MAX_TOTAL_BITS: u64 = 1 << 26;

/// A scene as it was read: what it says, and where it says it.
#[derive(Clone, Debug)]
pub struct SceneFile {
    scene: Scene,
    tree: Node,
    sources: Sources,
    warnings: Vec<Diagnostic>,
}

impl SceneFile {
    /// What the file says.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What the file says, without the rest.
    pub fn into_scene(self) -> Scene {
        self.scene
    }

    /// What is worth a look although the scene is sound.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// The tree that the file is, overrides applied.
    pub fn tree(&self) -> &Node {
        &self.tree
    }

    /// The texts that spans refer to.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// The place of a dotted path such as `motion.0.until`; where that is not in the file, the
    /// place of the nearest table around it.
    pub fn span_of(&self, path: &str) -> Span {
        let mut node = &self.tree;
        for step in path.split('.') {
            match node.find(step) {
                Some(next) => node = next,
                None => break,
            }
        }
        node.span
    }

    /// An error about the place of a dotted path, for what is found out only later. `code` must
    /// be one of [`super::CODES`].
    pub fn error_at(&self, path: &str, code: &'static str) -> Diagnostic {
        Diagnostic::error(&self.sources, self.span_of(path), code)
    }

    /// A warning about the place of a dotted path.
    pub fn warning_at(&self, path: &str, code: &'static str) -> Diagnostic {
        Diagnostic::warning(&self.sources, self.span_of(path), code)
    }
}

/// Reads a scene from its text. `name` is for messages, and its ending tells JSON from TOML (see
/// [`Notation::of`]).
///
/// # Errors
/// Everything that is wrong with it, in the order of the file: syntax errors alone, else
/// structure, polygons, plan and starting positions together.
///
/// Cost: linear in the text, and near-linear in the vertices for polygons as people draw them;
/// starting positions cost one [`crate::geometry::interiors_intersect`] for every pawl (and the
/// root) and obstacle whose boxes meet.
pub fn read_scene(name: &str, text: &str) -> Result<SceneFile, Vec<Diagnostic>> {
    read_scene_with(name, text, &[])
}

/// [`read_scene`] from bytes that may not be text.
///
/// # Errors
/// As [`read_scene_with`]; `not-utf8` at the first byte that is none.
pub fn read_scene_bytes(
    name: &str,
    bytes: &[u8],
    overrides: &[(&str, &str)],
) -> Result<SceneFile, Vec<Diagnostic>> {
    read_scene_with(name, text_of("scene", name, bytes)?, overrides)
}

/// [`read_scene`] with values replaced first: each override is a dotted path of keys and indices
/// or names, such as `pawl.0.stiffness` or `pawl.left.stiffness`, and the new value.
///
/// # Errors
/// As [`read_scene`]; what is wrong with an override is placed in `--set path=value`.
pub fn read_scene_with(
    name: &str,
    text: &str,
    overrides: &[(&str, &str)],
) -> Result<SceneFile, Vec<Diagnostic>> {
    let (tree, sources) = tree_of("scene", name, text, overrides)?;
    let mut conversion = Conversion::of(&tree, &sources);
    validate::scene(&mut conversion);
    let (scene, warnings) = conversion.finish()?;
    Ok(SceneFile {
        scene,
        tree,
        sources,
        warnings,
    })
}

/// The text that bytes are. `noun` is what the file is to describe.
///
/// # Errors
/// `too-large`; `not-utf8` at the first byte that is none.
pub(crate) fn text_of<'a>(
    noun: &str,
    name: &str,
    bytes: &'a [u8],
) -> Result<&'a str, Vec<Diagnostic>> {
    // Refused by size first, so that no time goes into decoding what is not read.
    within_size(noun, name, bytes)?;
    std::str::from_utf8(bytes).map_err(|error| {
        let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
        let mut sources = Sources::new();
        let index = sources.add(Source::new(name, &good));
        let end = sources.get(index).text().len();
        let span = Span {
            source: index,
            start: end,
            end,
        };
        let byte = bytes[error.valid_up_to()];
        vec![
            Diagnostic::error(&sources, span, "not-utf8")
                .message(format!("the byte 0x{byte:02x} here is not UTF-8 text"))
                .help("save the file as UTF-8"),
        ]
    })
}

/// The tree that a text is, overrides applied, and the texts that its places are in. `noun` is
/// what the file is to describe.
///
/// # Errors
/// `too-large`, what is no TOML or JSON, and overrides that cannot be applied.
pub(crate) fn tree_of(
    noun: &str,
    name: &str,
    text: &str,
    overrides: &[(&str, &str)],
) -> Result<(Node, Sources), Vec<Diagnostic>> {
    within_size(noun, name, text.as_bytes())?;
    let mut sources = Sources::new();
    let index = sources.add(Source::new(name, text));
    let mut tree = read_tree(&sources, index, Notation::of(name, text))?;
    apply_overrides_at(&mut tree, &mut sources, overrides)?;
    Ok((tree, sources))
}

fn within_size(noun: &str, name: &str, bytes: &[u8]) -> Result<(), Vec<Diagnostic>> {
    let size = bytes.len();
    if size <= MAX_FILE_BYTES {
        return Ok(());
    }
    let mut sources = Sources::new();
    sources.add(Source::new(name, ""));
    Err(vec![
        Diagnostic::error(&sources, Span::default(), "too-large")
            .message(format!(
                "the file has {size} bytes, more than the {MAX_FILE_BYTES} that are read"
            ))
            .help(format!("split the {noun}")),
    ])
}
