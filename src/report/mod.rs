//! Reports: what a trajectory looks like to a program, to a reader and to the eye.
//!
//! The engine's answer is exact and knows no words. Here it gets them, three times over the same
//! [`crate::motion::Trajectory`]: [`json`] is the published contract, with every number exact and
//! as the nearest double; [`summary`] is for a terminal and abbreviates; [`picture`] draws, and is
//! the only one that computes in doubles, since an eye cannot tell.

pub mod json;
mod layout;
pub mod ledger;
mod num;
pub mod picture;
pub mod slice;
pub mod summary;
pub(crate) mod theta;
pub(crate) mod words;

pub use layout::pretty;
pub use num::{Exact, Num};
pub use theta::theta;
