//! An outer bound on the true flex: no motion without collision, however long and curved, moves
//! the objective farther than this.
//!
//! | file | question |
//! | --- | --- |
//! | `joint` | what do two bodies forbid each other, and which region can they not leave? |
//! | `net` | what do all joints and closed chains leave to the objective? |
//! | `above` | how are upper bounds kept upper bounds? |
//!
//! *One joint.* What two bodies A and B forbid each other depends on B's place in A's frame alone:
//! (ξ, φ), its reference point and its angle, counted from the start as (Δξ, φ). Take a region
//! |Δξ| ≤ a, |φ| ≤ b. Inside it a signed distance differs from its linear part by no more than a
//! second-order slack in a and b, and a vertex that starts outside an edge stays there, as long as
//! its foot cannot leave the edge (`joint` says when). So every collision-free path inside the
//! region lies in a polyhedron of three variables. If that polyhedron lies strictly inside the
//! region, the path can never have reached the region's boundary: it is there for good, and the
//! polyhedron's own extent is a smaller region, with which the slack is taken anew.
//!
//! *All joints.* Variables are the angles θ of all bodies and Δξ of all joints. Rows are those of
//! the joints, and closed chains of bodies: Σ ±R(θ_A)ξ = 0 round a chain, turned into the frame of
//! its first body, holds only *relative* angles, which are small, so its linear part is off by
//! little. The objective is summed along a chain of joints from a fixed body. What the
//! linearisation of these may lose is added to the optimum, which is exact and certified.
//!
//! *What is proven.* All of it: lengths, feet and angles are enclosed from the exact rationals of
//! the structure, and every slack and loss is a sum of products rounded upwards (`above`), by
//! inequalities that hold for all numbers of the region and not only for small ones.

mod above;
mod joint;
mod net;

use super::fit::Fitted;
use super::model::{Form, Scaffold};
use super::types::Structure;
use crate::number::Rat;

/// A proven outer bound.
#[derive(Clone, Debug)]
pub struct OuterBound {
    /// No collision-free motion gains more.
    pub value: Rat,
    /// The exact optimum of the relaxed program, part of it.
    pub relaxed: Rat,
    /// What its linearised objective may lose, the other part.
    pub loss: Rat,
    /// Rows and columns of the relaxed program.
    pub size: (usize, usize),
    /// Rows of joints that could not be used.
    pub dropped: usize,
    /// Whether the relaxed program's certificate passed the verifier.
    pub verified: bool,
}

/// Bounds the objective of a structure over all collision-free motions from its start.
///
/// # Errors
/// Why there is no bound: a pinned body, a body that no chain of joints ties to a fixed one, a
/// joint that does not hold, a limit.
///
/// Cost: six small programs a joint and round, and one large one.
pub fn outer_bound(
    structure: &Structure,
    time_limit: Option<std::time::Duration>,
) -> Result<OuterBound, String> {
    if let Some(fit) = Fitted::of(structure) {
        let own = outer_bound(&fit.structure, time_limit)?;
        let unit = fit.weight();
        return Ok(OuterBound {
            value: &own.value * &unit,
            relaxed: &own.relaxed * &unit,
            loss: &own.loss * &unit,
            ..own
        });
    }
    let scaffold = Scaffold::new(structure);
    if scaffold.forms.contains(&Form::Pinned) {
        return Err("a pinned body is not bounded here".to_owned());
    }
    let placed = scaffold.place(&scaffold.start);
    let mut hinges = joint::hinges(&scaffold, &placed);
    for h in &mut hinges {
        h.settle();
    }
    hinges.retain(joint::Hinge::holds);
    let net = net::Net::new(&scaffold, &hinges);
    net.bound(structure, &scaffold, time_limit)
}
