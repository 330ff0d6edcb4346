//! Verdicts: does it lock, why, how firmly, and with what forces (DP §3.2, §4.4, Appendix A).
//!
//! A trajectory says what moves; a designer asks what that means. [`classify`](fn@classify) runs the ways out
//! from where a plan ended ([`escape`]) and names the weakest; [`critical`] finds the least
//! friction that would lock, exactly; [`peak`] encloses the forces of the sliding stretches
//! ([`stretch`]: the balance of forces is derived there) as narrowly as asked, by doubles with
//! proven bounds where those tell and by the outward rounded arithmetic of [`fix`] where not. Kinematic and friction verdicts are exact; what holds an
//! arctangent is enclosed, and decided only when the enclosure decides.

pub mod bound;
mod cells;
pub mod classify;
mod climb;
pub mod critical;
pub mod document;
pub mod draw;
mod drive;
pub mod escape;
mod field;
pub mod fix;
mod force_document;
mod force_summary;
pub mod forces;
pub mod handbook;
mod jet;
mod load;
pub mod peak;
mod pieces;
mod qpoly;
mod rough;
mod slope;
pub mod stretch;
pub mod summary;
pub mod total;
mod way;
mod work;

pub use classify::{Ask, Verdict};
pub use document::{ClassifyDocument, classify, classify_schema, forces_schema};
pub use forces::{ForcesDocument, Wish, forces};
