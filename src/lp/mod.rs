//! Exact linear programming: floating point proposes a basis, exact arithmetic disposes.
//!
//! ```text
//! bytes ─ read ─▶ Model ─ problem ─▶ integers ─ float ─▶ a basis ─ simplex ─▶ verdict ─ outcome ─▶ certificate
//!                                                      (proposal)   (exact, over basis, lift, lu, field)
//! ```
//!
//! [`solve`] does it all. The exact simplex method ([`Method::Exact`]) needs no proposal and the
//! warm path ([`Method::Warm`]) is the same method started from one, so there is one place that
//! decides. Its linear algebra is p-adic: see the module `lift`.

mod basis;
mod budget;
pub mod cli;
mod digits;
mod enclose;
pub(crate) mod field;
mod float;
mod implied;
mod lift;
pub(crate) mod lu;
pub mod model;
mod outcome;
mod problem;
pub mod read;
mod reconstruct;
mod repair;
pub mod report;
mod safe;
mod schema;
mod simplex;
mod solution;
mod solve;

pub use budget::Meter;
pub use model::{Column, Model, Range, Row};
pub use outcome::{Certificate, Outcome, Place, Places, Repair, Status, Vector};
pub use read::{LpError, read_model};
pub use schema::lp_schema;
pub use solve::{Accuracy, Method, Options, solve};
