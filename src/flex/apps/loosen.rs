//! How loose joints may be (PF §VI-A, Fig. 6): bodies inset, and the largest inset within a limit
//! of flex, by bisection.
//!
//! The inset is `i_overlay`'s, with sharp corners, on a grid fine enough that it moves no vertex
//! by more than [`slop`]. It works on rounded coordinates, so nothing of it is trusted: the result
//! must lie inside the original, edge must follow edge, and the ends of each must be as far
//! inside the original's line as was asked, within the slop; all of that is checked exactly, and
//! whatever fails is an error. What is exact, then, is the structure that results, which stands for the asked inset
//! within the slop; the flex of that structure; and the two ends of the bracket that bisection
//! leaves. That flex grows with the inset is true of the true flex; of PF's procedure it is an
//! assumption, and every probe is reported.

use crate::flex::shape::{double, doubles};
use crate::flex::{Ending, FlexOptions, Structure, flex};
use crate::geometry::{Location, Meeting, Polygon, Vec2, defects, meet};
use crate::number::{Int, Rat};
use crate::report::Num;
use crate::report::words::digits;
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};
use i_overlay::mesh::math::MathMode;
use serde::Serialize;

/// Bits after the point of the inset's grid.
const GRID_BITS: u32 = 30;
/// Most vertices of a body that is inset: the check looks at all pairs of edges.
const MOST_VERTICES: usize = 2_000;

/// How far an inset edge's ends may be off: 2⁻²⁰.
pub fn slop() -> Rat {
    Rat::new(Int::one(), Int::one().shl(20))
}

/// A polygon's ring inset by a distance > 0; vertex k of the result belongs to vertex k.
///
/// # Errors
/// The inset swallows an edge or falls apart, or the library's result fails the exact check.
pub fn inset(ring: &[Vec2], by: &Rat) -> Result<Vec<Vec2>, String> {
    if ring.len() > MOST_VERTICES {
        return Err(format!("a body has more than {MOST_VERTICES} vertices"));
    }
    let original = Polygon::new(ring.to_vec(), Vec::new());
    let forward = original.is_counter_clockwise(0);
    let contour: Vec<[f64; 2]> = if forward {
        ring.iter().map(doubles).collect()
    } else {
        ring.iter().rev().map(doubles).collect()
    };
    let size = contour.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
    if size > f64::from(1u32 << 24) {
        return Err("coordinates past 2^24 are not inset".to_owned());
    }
    // An inset this large swallows the body, and the library's grid would overflow.
    if double(by) > 2.0 * size {
        return Err("nothing is left of it".to_owned());
    }
    // Sharper corners than 2° are not mitred by the library; the check will say so.
    let mut style = OutlineStyle::new(-double(by)).line_join(LineJoin::Miter(0.035));
    style.math = MathMode::Float;
    style.miter_min_turn = 0.0;
    let scale = f64::from(1u32 << GRID_BITS);
    let shapes = contour
        .outline_fixed_scale_as::<i64>(&style, scale)
        .map_err(|_| "its inset cannot be computed in doubles".to_owned())?;
    let [shape] = shapes.as_slice() else {
        return Err(match shapes.len() {
            0 => "nothing is left of it".to_owned(),
            n => format!("it falls into {n} parts"),
        });
    };
    let [outer] = shape.as_slice() else {
        return Err("an inset has holes".to_owned());
    };
    let exact = |p: &[f64; 2]| Vec2::new(decimal(p[0]), decimal(p[1]));
    let mut found: Vec<Vec2> = thinned(outer, ring.len()).iter().map(exact).collect();
    if found.len() != ring.len() {
        return Err(format!(
            "the inset has {} vertices where the body has {}: it swallows an edge",
            found.len(),
            ring.len()
        ));
    }
    if Polygon::new(found.clone(), Vec::new()).is_counter_clockwise(0) != forward {
        found.reverse();
    }
    // The library begins where it likes: turn the ring so that vertices stay together.
    let n = ring.len();
    let far = |turn: usize| -> f64 {
        (0..n)
            .map(|k| {
                let (a, b) = (doubles(&ring[k]), doubles(&found[(k + turn) % n]));
                (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)
            })
            .sum()
    };
    let turn = (0..n).min_by(|&a, &b| far(a).total_cmp(&far(b)));
    found.rotate_left(turn.unwrap_or(0));
    check(&original, &found, by, forward)?;
    Ok(found)
}

/// The nearest decimal of eight digits after the point, far within the slop: what an inset of 1/10
/// makes of 0 is 1/10 again, not a fraction of the grid.
fn decimal(v: f64) -> Rat {
    const UNITS: i64 = 100_000_000;
    Rat::new(
        Rat::from_f64((v * UNITS as f64).round()).floor(),
        Int::from(UNITS),
    )
}

/// The ring without those vertices that lie, but for the grid, on the line of their neighbours:
/// the library leaves some behind at reflex corners.
fn thinned(ring: &[[f64; 2]], wanted: usize) -> Vec<[f64; 2]> {
    let mut ring = ring.to_vec();
    while ring.len() > wanted.max(3) {
        let n = ring.len();
        let off = |k: usize| {
            let (a, b, c) = (ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]);
            let (dx, dy) = (c[0] - a[0], c[1] - a[1]);
            (dx * (b[1] - a[1]) - dy * (b[0] - a[0])).abs() / dx.hypot(dy)
        };
        let least = (0..n)
            .map(|k| (off(k), k))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match least {
            Some((off, k)) if off * f64::from(1u32 << 22) <= 1.0 => {
                ring.remove(k);
            }
            _ => break,
        }
    }
    ring
}

/// Checks an inset exactly, see the head of the module.
fn check(original: &Polygon, found: &[Vec2], by: &Rat, forward: bool) -> Result<(), String> {
    let ring = &original.rings()[0];
    let n = ring.len();
    let (least, most) = (by - &slop(), by + &slop());
    for k in 0..n {
        let next = (k + 1) % n;
        let e = &ring[next] - &ring[k];
        let length2 = e.norm2();
        for v in [&found[k], &found[next]] {
            let mut s = e.cross(&(v - &ring[k]));
            if !forward {
                s = -s;
            }
            let square = s.square();
            let inside = s.sign() > 0
                && square >= &least.square() * &length2
                && square <= &most.square() * &length2;
            if !inside {
                return Err(format!("edge {k} is not as far inside as was asked"));
            }
        }
        if original.locate(&found[k]) != Location::Inside {
            return Err(format!("vertex {k} of the inset is not inside"));
        }
        for j in 0..n {
            let crossing = meet([&found[k], &found[next]], [&ring[j], &ring[(j + 1) % n]]);
            if crossing != Meeting::Apart {
                return Err(format!("edge {k} of the inset leaves the body"));
            }
        }
    }
    match defects(&Polygon::new(found.to_vec(), Vec::new())).first() {
        None => Ok(()),
        Some(_) => Err("the inset crosses itself".to_owned()),
    }
}

/// A structure with every body inset: clearances grow by twice as much, and so does ε.
///
/// # Errors
/// As [`inset`], with the body's name; `by` is not positive.
pub fn loosen(structure: &Structure, by: &Rat) -> Result<Structure, String> {
    if by.sign() <= 0 {
        return Err("the inset is not positive".to_owned());
    }
    if *by < slop() {
        return Err(
            "an inset below 2^-20 is not made: no edge of one is placed more finely than that"
                .to_owned(),
        );
    }
    let mut out = structure.clone();
    for body in &mut out.bodies {
        body.vertices =
            inset(&body.vertices, by).map_err(|e| format!("body {}: {e}", body.name))?;
    }
    out.epsilon = &out.epsilon + &(by * &Rat::from(2));
    Ok(out)
}

/// What is compared with the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Measure {
    /// The displacement that time stepping reaches.
    #[default]
    Stepped,
    /// The optimum of the first linear program.
    Linear,
}

/// A probe of the search.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The inset.
    pub inset: Rat,
    /// The flex, exact; None where the inset or the program failed.
    pub flex: Option<Rat>,
    /// Why there is none.
    pub reason: Option<String>,
}

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Tolerance {
    /// The largest inset found within the limit, with its flex; None where even 0 is past it.
    pub within: Option<(Rat, Rat)>,
    /// The least inset found that is past the limit, or cannot be made.
    pub beyond: Option<Rat>,
    /// All probes in order.
    pub probes: Vec<Probe>,
}

impl Tolerance {
    /// Why even the structure as it is drawn is not within the limit.
    fn why_none(&self) -> String {
        match self.probes.first() {
            Some(Probe {
                flex: Some(flex), ..
            }) if double(flex).is_finite() => format!(
                "the structure as drawn already flexes by {}, over the limit",
                digits(double(flex), 6)
            ),
            Some(Probe { flex: Some(_), .. }) => {
                "the structure as drawn already flexes past the double range, over the limit"
                    .to_owned()
            }
            Some(Probe {
                reason: Some(why), ..
            }) => {
                format!("of the structure as drawn, {why}")
            }
            _ => "nothing was tried".to_owned(),
        }
    }
}

/// Finds how far all bodies may be inset so that the flex stays within a limit, to a resolution:
/// doubles the inset from the resolution on, then bisects.
///
/// Cost: two runs of flexing for every bit of inset over resolution.
///
/// # Errors
/// The resolution or the limit is not positive.
pub fn tolerance(
    structure: &Structure,
    limit: &Rat,
    resolution: &Rat,
    measure: Measure,
    options: &FlexOptions<'_>,
) -> Result<Tolerance, String> {
    if resolution.sign() <= 0 || limit.sign() <= 0 {
        return Err("the limit and the resolution must be positive".to_owned());
    }
    let mut probes = Vec::new();
    let mut probe = |inset: &Rat| -> Option<Rat> {
        let (flex, reason) = match probe(structure, inset, measure, options) {
            Ok(v) => (Some(v), None),
            Err(e) => (None, Some(e)),
        };
        probes.push(Probe {
            inset: inset.clone(),
            flex: flex.clone(),
            reason,
        });
        flex.filter(|f| f <= limit)
    };
    let Some(first) = probe(&Rat::zero()) else {
        return Ok(Tolerance {
            within: None,
            beyond: Some(Rat::zero()),
            probes,
        });
    };
    let two = Rat::from(2);
    let (mut low, mut high) = ((Rat::zero(), first), resolution.clone());
    // An inset past the size of the bodies fails, so this ends; the bound is for odd inputs.
    let mut ended = false;
    for _ in 0..64 {
        match probe(&high) {
            Some(flex) => {
                low = (high.clone(), flex);
                high = &high * &two;
            }
            None => {
                ended = true;
                break;
            }
        }
    }
    while ended && &high - &low.0 > *resolution {
        let middle = Rat::midpoint(&low.0, &high);
        match probe(&middle) {
            Some(flex) => low = (middle, flex),
            None => high = middle,
        }
    }
    Ok(Tolerance {
        within: Some(low),
        beyond: ended.then_some(high),
        probes,
    })
}

fn probe(
    structure: &Structure,
    inset: &Rat,
    measure: Measure,
    options: &FlexOptions<'_>,
) -> Result<Rat, String> {
    let mut loose = if inset.is_zero() {
        structure.clone()
    } else {
        loosen(structure, inset)?
    };
    if measure == Measure::Linear {
        loose.step.most = 1;
    }
    let flexed = flex(&loose, options);
    match (measure, flexed.ending) {
        (_, ending @ (Ending::Unbounded | Ending::Infeasible | Ending::Undecided)) => {
            Err(format!("the flex is {}", ending.word()))
        }
        (Measure::Linear, _) => flexed
            .steps
            .first()
            .map(|s| s.objective.clone())
            .ok_or_else(|| "no step was taken".to_owned()),
        (Measure::Stepped, _) => Ok(flexed.displacement),
    }
}

/// The result of `snapfit loosen --limit`.
#[derive(Clone, Debug, Serialize)]
pub struct LoosenDocument {
    /// Which format this is.
    pub schema: &'static str,
    /// Name of the structure.
    pub structure: String,
    /// The limit of flex.
    pub limit: Num,
    /// `stepped` or `linear`.
    pub measure: &'static str,
    /// The largest inset found within it: every clearance grows by twice as much.
    pub inset: Option<Num>,
    /// Its flex.
    pub flex: Option<Num>,
    /// The least inset found to be past it.
    pub beyond: Option<Num>,
    /// Why there is no inset within the limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// How far an inset edge may be from where it was asked to be.
    pub slop: Num,
    /// All probes: inset, flex or the reason why there is none.
    pub probes: Vec<ProbeDocument>,
}

/// A probe.
#[derive(Clone, Debug, Serialize)]
pub struct ProbeDocument {
    /// The inset.
    pub inset: Num,
    /// The flex.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flex: Option<Num>,
    /// Why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl LoosenDocument {
    /// The document of a search.
    pub fn new(
        structure: &Structure,
        limit: &Rat,
        measure: Measure,
        found: &Tolerance,
    ) -> LoosenDocument {
        LoosenDocument {
            schema: "snapfit.loosen/1",
            structure: structure.name.clone(),
            limit: Num::of_rat(limit),
            measure: match measure {
                Measure::Stepped => "stepped",
                Measure::Linear => "linear",
            },
            inset: found.within.as_ref().map(|w| Num::of_rat(&w.0)),
            flex: found.within.as_ref().map(|w| Num::of_rat(&w.1)),
            beyond: found.beyond.as_ref().map(Num::of_rat),
            reason: found.within.is_none().then(|| found.why_none()),
            slop: Num::of_rat(&slop()),
            probes: found
                .probes
                .iter()
                .map(|p| ProbeDocument {
                    inset: Num::of_rat(&p.inset),
                    flex: p.flex.as_ref().map(Num::of_rat),
                    reason: p.reason.clone(),
                })
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[(i64, i64)]) -> Vec<Vec2> {
        let v = |&(x, y): &(i64, i64)| Vec2::new(Rat::from(x), Rat::from(y));
        points.iter().map(v).collect()
    }

    #[test]
    fn an_l_keeps_its_vertices_in_order_either_way_round() {
        let l = ring(&[(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)]);
        let by = Rat::frac(1, 8);
        let near = |a: &Vec2, x: i64, y: i64| {
            (doubles(a)[0] - x as f64 / 8.0).abs() < 1e-6
                && (doubles(a)[1] - y as f64 / 8.0).abs() < 1e-6
        };
        let want = [(1, 1), (31, 1), (31, 7), (7, 7), (7, 23), (1, 23)];
        let got = inset(&l, &by).expect("an inset");
        for (g, (x, y)) in got.iter().zip(want) {
            assert!(near(g, x, y), "{got:?}");
        }
        let back: Vec<Vec2> = l.iter().rev().cloned().collect();
        let got = inset(&back, &by).expect("an inset");
        for (g, (x, y)) in got.iter().rev().zip(want) {
            assert!(near(g, x, y), "{got:?}");
        }
    }

    /// Decimals stay decimals, and an inset of none of the grid's numbers is within the slop.
    #[test]
    fn an_inset_by_a_tenth_is_a_tenth() {
        let l = ring(&[(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)]);
        let got = inset(&l, &Rat::frac(1, 10)).expect("an inset");
        let tenths = [(1, 1), (39, 1), (39, 9), (9, 9), (9, 29), (1, 29)];
        let want = tenths.map(|(x, y)| Vec2::new(Rat::frac(x, 10), Rat::frac(y, 10)));
        assert_eq!(got, want);
    }

    #[test]
    fn what_an_inset_swallows_is_an_error() {
        let l = ring(&[(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)]);
        assert!(inset(&l, &Rat::frac(1, 2)).is_err());
        assert!(inset(&l, &Rat::from(5)).is_err());
    }

    /// The check sees what a library could get wrong.
    #[test]
    fn a_false_inset_is_refused() {
        let square = ring(&[(0, 0), (4, 0), (4, 4), (0, 4)]);
        let polygon = Polygon::new(square.clone(), Vec::new());
        let by = Rat::one();
        let good = ring(&[(1, 1), (3, 1), (3, 3), (1, 3)]);
        assert!(check(&polygon, &good, &by, true).is_ok());
        let mut bad = good.clone();
        bad[2].x = Rat::frac(31, 10);
        assert!(check(&polygon, &bad, &by, true).is_err());
        let mut turned = good;
        turned.rotate_left(1);
        assert!(check(&polygon, &turned, &by, true).is_err());
    }
}
