//! snapfit predicts, exactly, the motion of planar mechanisms that click: a rigid root
//! translates, pawls hang from it on torsional springs, they strike polygonal obstacles, comply,
//! slide, stick, jam and snap (Donald & Pai 1993, cited as DP).
//!
//! The story, in order; each module depends only on what stands before it:
//!
//! ```text
//! scene file ─ scene ─▶ Scene ─ contact ─▶ patches ─ slice ─▶ arcs on the (t, θ) cylinder
//!   ─ face ─▶ the free component F ─ motion ─▶ Trajectory ─ report ─▶ JSON, summary, SVG
//! ```
//!
//! * [`number`]: integers and rationals behind one seam, certified intervals, real algebraic
//!   numbers. No float decides anything; a float may settle a sign that its error bound proves.
//! * [`geometry`]: points, rational rotations, polygons, exact predicates.
//! * [`kernel`]: which arithmetic answers; everything from `contact` to `motion` is written over it.
//! * [`scene`]: what the user describes, read with places, validated.
//! * [`contact`]: C-functions and their patches, types A and B.
//! * [`face`](mod@face): the single face of an arrangement of arcs.
//! * [`slice`](mod@slice): the cylinder of one phase, cut by monotone arcs with named ends, and the
//!   free component on it.
//! * [`motion`]: the dynamical rules in one place, and the two algorithms.
//! * [`report`]: results as JSON with every number exact, summaries, pictures.
//! * [`analysis`]: verdicts and forces: does it lock, why, and how firmly.
//! * [`trade`](mod@trade): speed against accuracy, measured over the arithmetics.
//! * [`lp`], [`certificate`]: exact linear programming, and the checker of its certificates, which
//!   shares only the reader and the numbers with it.
//! * [`flex`](mod@flex): PuzzleFlex, how far loosely joined bodies move, on top of `lp`.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = r#"
//!     [scene]
//!     name = "tip on a floor"
//!     [[obstacle]]
//!     name = "floor"
//!     vertices = [["-10", "-1"], ["10", "-1"], ["10", "0"], ["-10", "0"]]
//!     [[pawl]]
//!     name = "finger"
//!     hinge = ["0", "6"]
//!     vertices = [["0", "6"], ["3", "2"], ["16/5", "9/5"]]
//!     [[motion]]
//!     velocity = ["0", "-1"]
//!     duration = "5"
//! "#;
//! let file = snapfit::scene::read_scene("tip.toml", text).map_err(|e| format!("{e:?}"))?;
//! let trajectory = snapfit::motion::simulate(file.scene(), &Default::default())?;
//! assert_eq!(trajectory.outcome.kind, snapfit::motion::OutcomeKind::Completed);
//! // The lower vertex, 4 1/5 below the hinge, meets the floor at t = 6 − 21/5 = 9/5.
//! let first = &trajectory.pawls[0].events[0];
//! assert_eq!(first.time.as_rat(), Some(&snapfit::number::Rat::frac(9, 5)));
//! # Ok(())
//! # }
//! ```

pub mod analysis;
pub mod certificate;
pub mod contact;
pub mod face;
pub mod flex;
pub mod geometry;
pub mod kernel;
pub mod lp;
pub mod motion;
pub mod number;
pub mod report;
pub mod scene;
pub mod slice;
pub mod trade;
