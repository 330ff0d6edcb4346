//! Speed against accuracy: the same scene under every arithmetic, and what each gets wrong.
//!
//! The filtered result is the reference (the exact kernel's, only faster). Everything else is
//! measured against it: which events are missing, which were made up, how far times and angles
//! are from the correctly rounded ones, and whether the verdict is right. Beside the kernels
//! stands what is done today: time stepping in doubles (DP §4.3, "Typical Simulation Algorithm").
//!
//! | file | question |
//! | --- | --- |
//! | `setting` | what is compared? |
//! | `score` | how far is one result from the reference? |
//! | `step` | what would time stepping have said? |
//! | `stratum` | what kind of scene is it? |
//! | `table` | what does a scene, or a folder of them, come to? |
//! | `family` | where does each setting start to lie as a gap closes? |
//! | `map` | what do the neighbours of a coincidence look like? |
//! | `plot` | the pictures |

pub mod family;
pub mod map;
pub mod plot;
pub mod score;
pub mod setting;
pub mod step;
pub mod stratum;
pub mod table;

pub use setting::Setting;
pub use table::{Row, SceneRows, trade};
