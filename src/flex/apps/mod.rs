//! Applications of flexing (PF §IV, §VI): each a question about a structure.
//!
//! | file | question | PF |
//! | --- | --- | --- |
//! | `constraints` | which constraints are there, and what does each alone allow? | §IV |
//! | `brace` | where would a beam hold most? | §VI-A, Fig. 5 |
//! | `loosen` | how loose may the joints be? | §VI-A, Fig. 6 |
//! | `separate` | does it come apart, and which way? | §VI-C, Fig. 8 |
//! | `escape` | does a translation clear everything, for ever? | beyond PF |
//! | `sequence` | in which order does it come apart, body by body? | beyond PF |
//! | `layout` | structures drawn with characters | Figs. 1, 5 |
//!
//! Flocks (§VI-B, Fig. 7) and the structure of Fig. 9 are families of [`super::generate`].

pub mod brace;
pub mod constraints;
pub mod escape;
pub mod layout;
pub mod loosen;
pub mod separate;
pub mod sequence;
