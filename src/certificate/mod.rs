//! What a result proves, checked by code that shares nothing with the engine but integers,
//! rationals and the reading of models.

pub mod lp;
mod lp_basis;
mod lp_digits;
pub mod lp_json;
pub(crate) mod lp_near;
pub mod lp_result;
