//! Exact linear programming: floating point proposes a basis, exact arithmetic disposes.

mod basis;
mod budget;
mod field;
mod float;
mod lift;
mod lu;
pub mod model;
mod outcome;
mod problem;
pub mod read;
mod reconstruct;
mod simplex;
mod solve;

pub use model::{Column, Model, Range, Row};
pub use read::{LpError, read_model};
pub use outcome::{Certificate, Outcome, Place, Status, Vector};
pub use solve::{Accuracy, Method, Options, solve};
