//! PuzzleFlex: how far loosely joined rigid bodies flex, exactly (Lensgraf et al. 2019, cited as
//! PF).
//!
//! ```text
//! structure file ─ read ─▶ Structure ─ shape, pairs ─▶ constraints ─ model ─▶ linear program
//!   ─ lp ─▶ direction ─ step ─▶ next configuration …  ─ report, picture ─▶ JSON, SVG
//! ```
//!
//! | file | question |
//! | --- | --- |
//! | `types`, `read`, `schema` | what is a structure, and what is none? |
//! | `shape` | where does a body stand, in integers? |
//! | `pairs` | which point is to stay on its side of which line? |
//! | `model` | what are the distances, gradients and objective there? |
//! | `fit` | in which unit are doubles of use? |
//! | `station`, `grain` | where are gradients taken, and how are poses rounded? |
//! | `bend` | along which curve is a direction followed? |
//! | `run`, `limits` | when does stepping go on, and when does it end? |
//! | `step` | how far may a step go, and where does it end? |
//! | `safe`, `motion` | which part of a step is proven free of collision? |
//! | `outcome` | how and why did a run end? |
//! | `generate`, `robots` | the paper's families of structures |
//!
//! Configurations are rational throughout. What doubles do is to propose: a direction, a length.
//! Whether a configuration respects its constraints is decided by exact integers.

pub mod apps;
mod bend;
mod bound;
mod branch;
mod fit;
pub mod generate;
mod grain;
mod limits;
mod model;
mod motion;
mod mps;
mod outcome;
mod pairs;
mod random;
mod read;
pub mod report;
mod robots;
mod run;
mod safe;
mod schema;
mod settle;
mod shape;
mod station;
mod step;
mod summary;
mod types;
mod write;

pub use bound::{OuterBound, outer_bound};
pub use motion::{Contact as FirstContact, ProofSize};
pub use mps::to_mps;
pub use outcome::{Ending, Flexed, Step, Violation, Why};
pub use pairs::{Facing, Pair, Plane, Point};
pub use read::{Guise, MAX_STEPS, StructureFile, guise, is_structure, read_structure};
pub use schema::structure_schema;
pub use shape::Pose;
pub use step::{Corners, FlexOptions, FlexProgress, flex};
pub use types::*;
pub use write::structure_to_toml;
