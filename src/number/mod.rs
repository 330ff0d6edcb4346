//! Numbers: integers and rationals behind one seam, certified `f64` intervals, integer
//! polynomials and real algebraic numbers. Nothing to the right of this module touches a
//! big-number crate by name.

mod algebraic;
mod backend;
mod divides;
mod factor;
pub mod filter;
mod float;
mod gcd;
mod int;
mod interval;
mod isolate;
pub mod literal;
mod long;
pub(crate) mod modular;
mod ops;
mod poly;
mod quadratic;
mod rat;
mod refine;
mod root;
mod scalar;
mod words;

pub use algebraic::Algebraic;
pub use backend::{Backend, backend, set_backend};
pub use int::Int;
pub use interval::Interval;
pub use poly::Poly;
pub use rat::Rat;
pub use scalar::{Enclosed, Scalar};
