//! Scenes: what the user describes, how it is read, and what is refused.
mod types;
pub use types::*;
