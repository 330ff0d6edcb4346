//! Reports: what a trajectory looks like to a program, to a reader and to the eye.
//!
//! The engine's answer is exact and knows no words. Here it gets them, three times over the same
//! [`crate::motion::Trajectory`]: [`json`] is the published contract, with every number exact and
//! as the nearest double; [`summary`] is for a terminal and abbreviates; [`picture`] draws, and is
//! the only one that computes in doubles, since an eye cannot tell.

pub mod json;
pub mod ledger;
mod layout;
mod num;
pub mod picture;
pub mod summary;
mod theta;
mod words;

pub use layout::pretty;
pub use num::{Exact, Num};
pub use theta::theta;
