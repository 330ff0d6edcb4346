//! Structures of any size: measured in a power of two near their own.
//!
//! Doubles propose directions and look for what is near; past their range, or where their squares
//! leave it, they say nothing. So a structure far larger or smaller than one is divided by a power
//! of two, exactly, worked on, and what is found is multiplied back, exactly. Nothing else
//! changes: angles keep their size, and the weights of displacements are multiplied by what
//! lengths were divided by. Weights that are themselves far from one are divided by a power of two
//! together with the gain that ends a run.

use super::outcome::{Flexed, Why};
use super::shape::Pose;
use super::types::{Hold, Structure, Term};
use crate::geometry::Vec2;
use crate::number::{Int, Rat};

/// Sizes from 2 to minus this up to 2 to this are left as they are.
const PLAIN: i64 = 64;

/// A structure in a unit of its own.
#[derive(Clone, Debug)]
pub(crate) struct Fitted {
    pub(crate) structure: Structure,
    /// Its unit of length is 2 to this.
    lengths: i64,
    /// The unit of its objective is 2 to this.
    weights: i64,
}

/// The power of two 2ᵏ.
fn power(k: i64) -> Rat {
    let big = Int::one().shl(k.unsigned_abs());
    if k < 0 {
        Rat::new(Int::one(), big)
    } else {
        Rat::from(big)
    }
}

/// The least k with |v| < 2ᵏ for the largest v in size; None where all are zero.
fn size<'a>(all: impl Iterator<Item = &'a Rat>) -> Option<i64> {
    let most = all.map(Rat::abs).max().filter(|v| !v.is_zero())?;
    Some(most.floor().bits() as i64)
        .filter(|k| *k > 0)
        .or_else(|| {
            // Below one: 1 / v lies in (2^(j−1), 2ʲ], so v in [2⁻ʲ, 2^(1−j)).
            let inverse = most.recip().ceil();
            let j = (&inverse - Int::one()).bits() as i64;
            Some(1 - j)
        })
}

fn scaled(p: &Vec2, by: &Rat) -> Vec2 {
    Vec2::new(&p.x * by, &p.y * by)
}

impl Fitted {
    /// The structure in its own unit; None where its file's unit does.
    pub(crate) fn of(structure: &Structure) -> Option<Fitted> {
        let points = structure.bodies.iter().flat_map(|b| {
            let own = b.vertices.iter().chain([&b.position]);
            own.flat_map(|p| [&p.x, &p.y])
        });
        let far = |k: &i64| k.abs() > PLAIN;
        let lengths = size(points).filter(far).unwrap_or(0);
        let mut out = structure.clone();
        let unit = power(-lengths);
        let small = |p: &mut Vec2| *p = scaled(p, &unit);
        out.epsilon = &out.epsilon * &unit;
        out.step.violation = &out.step.violation * &unit;
        for body in &mut out.bodies {
            body.vertices.iter_mut().for_each(small);
            small(&mut body.position);
            if let Hold::Pin(p) = &mut body.hold {
                small(p);
            }
        }
        for view in &mut out.views {
            small(&mut view.camera);
            small(&mut view.marker);
            view.far.iter_mut().for_each(small);
        }
        // Terms whose weight is one by their nature keep it: then the objective is a length.
        let mut natural = false;
        for term in &mut out.objective {
            match term {
                Term::Body { dx, dy, .. } | Term::Vertex { dx, dy, .. } => {
                    (*dx, *dy) = (&*dx * &power(lengths), &*dy * &power(lengths));
                }
                Term::Towards { x, .. } => {
                    natural = true;
                    *x = &*x * &unit;
                }
                Term::Radial { from, .. } => {
                    natural = true;
                    small(from);
                }
            }
        }
        let each = out.objective.iter().flat_map(|t| match t {
            Term::Body { dx, dy, dtheta, .. } => vec![dx, dy, dtheta],
            Term::Vertex { dx, dy, .. } => vec![dx, dy],
            _ => Vec::new(),
        });
        let weights = if natural {
            lengths
        } else {
            size(each).filter(far).unwrap_or(0)
        };
        if lengths == 0 && weights == 0 {
            return None;
        }
        let worth = power(-weights);
        for term in &mut out.objective {
            match term {
                Term::Body { dx, dy, dtheta, .. } => {
                    (*dx, *dy, *dtheta) = (&*dx * &worth, &*dy * &worth, &*dtheta * &worth);
                }
                Term::Vertex { dx, dy, .. } => (*dx, *dy) = (&*dx * &worth, &*dy * &worth),
                Term::Towards { .. } | Term::Radial { .. } => {}
            }
        }
        out.step.gain = &out.step.gain * &worth;
        Some(Fitted {
            structure: out,
            lengths,
            weights,
        })
    }

    /// The unit of lengths.
    pub(crate) fn length(&self) -> Rat {
        power(self.lengths)
    }

    /// The unit of the objective.
    pub(crate) fn weight(&self) -> Rat {
        power(self.weights)
    }

    /// Poses in this unit.
    pub(crate) fn own(&self, poses: &[Pose]) -> Vec<Pose> {
        placed_by(poses, &power(-self.lengths))
    }

    /// A run in the units of the file.
    pub(crate) fn back(&self, mut run: Flexed) -> Flexed {
        let (length, weight) = (self.length(), self.weight());
        let worth = |v: &mut Rat| *v = &*v * &weight;
        let near = |v: &mut f64| {
            // A sentence's number: as near as a double can tell.
            let exact = Rat::from_f64(v.clamp(-f64::MAX, f64::MAX)) * weight.clone();
            *v = super::shape::double(&exact);
        };
        for poses in &mut run.configurations {
            *poses = placed_by(poses, &length);
        }
        worth(&mut run.displacement);
        run.violation.square = &run.violation.square * &length.square();
        for (k, step) in run.steps.iter_mut().enumerate() {
            worth(&mut step.objective);
            worth(&mut step.gain);
            step.enclosure.0.iter_mut().for_each(worth);
            step.enclosure.1.iter_mut().for_each(worth);
            if let Some(poses) = run.configurations.get(k + 1) {
                step.bits = poses.iter().map(Pose::bits).max().unwrap_or(0);
            }
        }
        match &mut run.why {
            Why::Little(v) | Why::Unproven(v) | Why::Unfollowed(v) | Why::Limited(v) => near(v),
            Why::Restored { loss, promise } => {
                near(loss);
                promise.iter_mut().for_each(near);
            }
            Why::Steps(_) | Why::Unbounded | Why::Infeasible | Why::Time => {}
        }
        run
    }
}

fn placed_by(poses: &[Pose], unit: &Rat) -> Vec<Pose> {
    let each = poses.iter().map(|p| Pose {
        place: scaled(&p.place, unit),
        tan_half: p.tan_half.clone(),
    });
    each.collect()
}

/// A double as a rational; what is past the range as its end, what is no number as zero. For
/// thresholds, which no exactness hangs on.
pub(crate) fn finite(v: f64) -> Rat {
    if v.is_nan() {
        return Rat::zero();
    }
    Rat::from_f64(v.clamp(-f64::MAX, f64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A size is the least power of two above it.
    #[test]
    fn sizes_are_powers_of_two() {
        for k in [-2000i64, -65, -3, -1, 0, 1, 2, 64, 1024, 4000] {
            let at = |v: Rat| size([Rat::zero(), -v].iter());
            assert_eq!(at(power(k)), Some(k + 1), "{k}");
            assert_eq!(at(power(k) * Rat::frac(3, 2)), Some(k + 1), "{k}");
            assert_eq!(at(power(k) * Rat::frac(5, 8)), Some(k), "{k}");
        }
        assert_eq!(size([Rat::zero()].iter()), None);
    }
}
