//! The snap-fit handbook's formula beside the model, and why they part.
//!
//! Bayer's handbook gives the mating and separation force of a hook as
//!
//! ```text
//! W = P·(μ + tan α)/(1 − μ·tan α),
//! ```
//!
//! P the force that bends the arm, α the slope against the travel. For an arm of length L on a
//! torsional spring P = k|θ|/L. The formula takes the arm as it is drawn, in line with the
//! travel: it knows neither that the arm turns nor that a face on the arm turns with it. Its
//! asymptote μ·tan α = 1 is the model's sector boundary at θ = 0, but a vertex of the arm on a
//! fixed slope sticks before, at θ = 90° − arctan μ − α on the way out.

use super::bound::Bound;
use super::fix::{Bits, Fix};
use super::load::{Part, Rig};
use super::stretch::{Stretch, Touch};
use crate::geometry::Vec2;
use crate::number::Rat;
use schemars::JsonSchema;
use serde::Serialize;

/// The formula's value and the model's at a segment's largest deflection.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Handbook {
    /// tan α of the slope against the travel, exactly; null where it stands square to it.
    pub slope: Option<String>,
    /// (μ ± tan α)/(1 ∓ μ·tan α): plus while it climbs; null where the formula says that it locks.
    pub factor: Option<String>,
    /// The formula's force against the travel; null where it locks.
    pub formula: Option<Bound>,
    /// The model's force against the travel; null where it is not bounded.
    pub model: Option<Bound>,
    /// What the formula does not know.
    pub parts: Vec<&'static str>,
    /// Whether the largest deflection is at the segment's end.
    #[serde(skip)]
    pub late: bool,
}

/// The formula along a stretch; None where there is no slope or no arm.
pub(super) fn handbook(s: &Stretch, k: &Rat, mu: &Rat, digits: u32) -> Option<Handbook> {
    let touch = s.touch.as_ref().filter(|_| !s.still())?;
    let v = &s.velocity;
    let normal = match touch {
        Touch::B { n, .. } => n,
        Touch::A { m, .. } => m,
    };
    let (square, along) = (normal.dot(v).abs(), normal.cross(v).abs());
    let slope = (!along.is_zero()).then(|| &square / &along);
    // |θ| grows with the position above rest.
    let late = (s.x[1] > s.x[0]) == (s.side >= 0);
    let factor = slope.as_ref().and_then(|tan| {
        let one = Rat::one();
        let (up, down) = if late {
            (mu + tan, &one - &(mu * tan))
        } else {
            (mu - tan, &one + &(mu * tan))
        };
        (down.sign() > 0).then(|| up / down)
    });
    let b = Bits(u64::from(digits) * 10 / 3 + 48);
    let parts = Part::cut(s, mu.sign() > 0);
    let part = if late { parts.last()? } else { parts.first()? };
    let rig = Rig {
        stiffness: k.clone(),
        mu: mu.clone(),
        arm: Vec2::default(),
    };
    let x = part.end(late, b);
    let load = part.load(&x, &rig, 1, b);
    let arm: Fix = match touch {
        Touch::B { a, .. } => b.rat(&a.dot(v)),
        Touch::A { w, .. } => {
            let t = load.as_ref()?.clock.order(0);
            b.rat(&w.dot(v)).sub(&t.mul(&b.rat(&v.norm2())))
        }
    };
    // The arm along the travel, in units of the speed's.
    let speed = b.rat(&v.norm2()).sqrt()?;
    let bend = part.angle(&x, b).abs().mul(&b.rat(k));
    let bend = bend.mul(&speed).div(&arm.abs())?;
    let formula = factor
        .as_ref()
        .map(|f| Bound::of_fix(&bend.mul(&b.rat(f)), digits));
    let model = load.map(|l| Bound::of_fix(&l.resistance.order(0), digits));
    let mut reasons = Vec::new();
    match touch {
        Touch::B { a, .. } => {
            reasons.push("the arm turns, and meets the fixed slope at another angle");
            if !a.cross(v).is_zero() {
                reasons.push("the tip is not in line with the hinge along the travel");
            }
        }
        Touch::A { .. } => {
            reasons.push("the slope is the arm's and turns with it");
            reasons.push("the contact wanders along the arm");
        }
    }
    if factor.is_none() {
        reasons.push("by the formula it locks: μ·tan α is at least 1");
    }
    Some(Handbook {
        slope: slope.map(|r| r.to_string()),
        factor: factor.map(|r| r.to_string()),
        formula,
        model,
        parts: reasons,
        late,
    })
}
