//! snapfit predicts, exactly, the motion of planar mechanisms that click.

pub mod certificate;
pub mod contact;
pub mod geometry;
pub mod lp;
pub mod motion;
pub mod number;
pub mod scene;
pub mod slice;
