//! Scenes: what the user describes, how it is read, and what is refused.
//!
//! A file goes through three rooms, and what it says goes through them exactly:
//!
//! 1. **Text to tree** (`tree`, `toml`, `json`): both notations become one tree whose every
//!    key and value knows its place in the text, and whose numbers are still text. `--set`
//!    (`overrides`) changes the tree, so an override is checked as if it stood in the file.
//! 2. **Tree to scene** (`convert`, `values`): shapes and types. One list of known keys
//!    (`convert::TABLES`) serves the reader, its suggestions and the test of the schema.
//! 3. **Scene to sense** (`validate`): polygons that are polygons, plans that can run, nothing
//!    that starts inside something else.
//!
//! Whatever is wrong becomes a [`Diagnostic`] with a stable code and a place; reading goes on past
//! it where that makes sense, so one run lists what there is to repair.
//!
//! ```
//! let text = r#"
//! scene = { name = "latch" }
//! [[obstacle]]
//! name = "floor"
//! vertices = [[-9, -1], [9, -1], [9, 0], [-9, 0]]
//! [[pawl]]
//! name = "tip"
//! hinge = [0, 6]
//! vertices = [[0, 6], ["3/2", 2], [2, 3]]
//! [[motion]]
//! velocity = [0, -0.1]
//! duration = "1e1"
//! "#;
//! let file = snapfit::scene::read_scene("latch.toml", text).unwrap();
//! assert_eq!(file.scene().pawls[0].name, "tip");
//! let refused = snapfit::scene::read_scene("latch.toml", &text.replace("duration", "durration"));
//! assert_eq!(refused.unwrap_err()[0].code(), "unknown-key");
//! ```

mod check;
mod convert;
mod diagnostic;
mod json;
mod overrides;
mod picture;
mod read;
mod schema;
mod source;
mod toml;
mod tree;
mod types;
mod validate;
mod values;
mod write;

pub use check::{CheckReport, Feature, PawlReport, check};
pub use convert::MAX_ERRORS;
pub(crate) use convert::{Conversion, Tables, clip};
pub use diagnostic::{CODES, Diagnostic, Rendering, STRUCTURE_CODES, SceneError, Severity};
pub use overrides::apply_overrides;
pub use read::{
    MAX_FILE_BYTES, MAX_TOTAL_BITS, MAX_VERTICES, SceneFile, read_scene, read_scene_bytes,
    read_scene_with,
};
pub(crate) use read::{text_of, tree_of};
pub(crate) use schema::{Number, Point, Ring, without_null};
pub use schema::{SceneDocument, scene_schema};
pub use source::{Source, Sources, Span};
pub use tree::{Entry, Kind, MAX_DEPTH, Node, Notation, read_tree};
pub use types::*;
pub(crate) use validate::explain_defects;
