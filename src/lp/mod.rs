//! Exact linear programming: floating point proposes a basis, exact arithmetic disposes.

pub mod model;
pub mod read;

pub use model::{Column, Model, Range, Row};
pub use read::{LpError, read_model};
