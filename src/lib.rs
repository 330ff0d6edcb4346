//! snapfit predicts, exactly, the motion of planar mechanisms that click.

pub mod contact;
pub mod geometry;
pub mod motion;
pub mod number;
pub mod report;
pub mod scene;
pub mod slice;
