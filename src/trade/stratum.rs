//! What kind of scene it is: the strata over which settings are compared.

use crate::geometry::Vec2;
use crate::motion::{Ledger, trajectory::EventKind, trajectory::Trajectory};
use crate::number::Rat;
use crate::scene::Scene;
use serde::Serialize;

/// A kind of scene, from the tamest to the wildest; the wildest that fits is the scene's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stratum {
    /// Nothing coincides.
    Generic,
    /// Things coincide because of how they are named: vertex on vertex, edge flush on edge.
    ForcedDegenerate,
    /// Unrelated things happen at exactly one instant.
    AccidentalDegenerate,
    /// Things nearly coincide: double enclosures do not tell them apart, though they differ.
    NearDegenerate,
    /// Sizes that differ by 2⁴⁰ and more, or lie so far from one.
    ExtremeScale,
}

/// Sizes beyond 2 to this power, up or down, are extreme.
const EXTREME: f64 = 40.0;

/// The stratum of a scene, from its sizes and from what the filtered run of it had to ask.
pub fn stratum(scene: &Scene, reference: &Trajectory) -> Stratum {
    let ledger: &Ledger = &reference.ledger;
    let near = ledger.counts.wider > 0 || ledger.counts.exact > ledger.counts.zeros;
    if spread(scene) {
        Stratum::ExtremeScale
    } else if near {
        Stratum::NearDegenerate
    } else if coincide(reference) {
        Stratum::AccidentalDegenerate
    } else if ledger.degenerate_events > 0 {
        Stratum::ForcedDegenerate
    } else {
        Stratum::Generic
    }
}

/// Whether several contacts begin or end at one instant of one pawl, or two pawls' events agree.
fn coincide(t: &Trajectory) -> bool {
    let struck = |k: EventKind| {
        matches!(
            k,
            EventKind::TranslationalCollision
                | EventKind::Bifurcation
                | EventKind::JamIncompatible
                | EventKind::SnapLanding
        )
    };
    t.pawls
        .iter()
        .flat_map(|p| &p.events)
        .any(|e| e.kind == EventKind::Bifurcation || (struck(e.kind) && e.contacts.len() > 2))
}

fn spread(scene: &Scene) -> bool {
    let mut bits: Vec<f64> = Vec::new();
    let mut add = |p: &Vec2| {
        for r in [&p.x, &p.y] {
            if !r.is_zero() {
                bits.push(log2(r));
            }
        }
    };
    scene.obstacles.iter().for_each(|o| {
        o.vertices.iter().for_each(&mut add);
        o.holes.iter().flatten().for_each(&mut add);
    });
    scene.pawls.iter().for_each(|p| {
        for v in &p.vertices {
            add(&(v - &p.hinge));
        }
    });
    let most = bits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = bits.iter().copied().fold(f64::INFINITY, f64::min);
    most > EXTREME || least < -EXTREME || most - least > EXTREME
}

/// About log₂ |r|; good enough to tell scales apart.
fn log2(r: &Rat) -> f64 {
    r.numer().bits() as f64 - r.denom().bits() as f64
}
