//! Bounds without a vertex: short prices that are nearly exact, and the proof that exact ones are
//! near. Checked against the exact optimum, and by damage done to the certificates.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;
#[path = "common/world/rng.rs"]
mod rng;

use common::count;
use rng::Rng;
use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{Accuracy, Certificate, Model, Options, Outcome, Range, Status, report, solve};
use snapfit::number::{Int, Rat};

/// A multiple of 2⁻²⁰ between −2 and 2.
fn fraction(r: &mut Rng) -> Rat {
    Rat::frac(r.below(1 << 22) as i64 - (1 << 21), 1 << 20)
}

/// A multiple of 2⁻²⁰ above 0, up to 1.
fn positive(r: &mut Rng) -> Rat {
    Rat::frac(1 + r.below(1 << 20) as i64, 1 << 20)
}

/// A chain of mostly free columns; inequalities between neighbours, from one side or both, with
/// the origin inside. Without its last rows it may be unbounded.
fn chain(r: &mut Rng, size: usize, closed: bool) -> Model {
    let mut model = Model::new("chain");
    model.maximise = r.below(2) == 0;
    for j in 0..size {
        let range = match r.below(8) {
            0 => Range::at_least(-positive(r)),
            1 => Range {
                lower: Some(-positive(r)),
                upper: Some(positive(r)),
            },
            _ => Range::free(),
        };
        let cost = if r.below(3) == 0 {
            fraction(r)
        } else {
            Rat::zero()
        };
        model.add_column(&format!("x{j}"), cost, range);
    }
    model.constant = fraction(r);
    for j in 0..size {
        for k in 0..2 + r.below(4) {
            let range = match (k, r.below(4)) {
                (0, _) => Range {
                    lower: Some(-positive(r)),
                    upper: Some(positive(r)),
                },
                (_, 0) => Range::at_most(positive(r)),
                _ => Range::at_least(-positive(r)),
            };
            let i = model.add_row(&format!("r{j}.{k}"), range);
            model.set(i, j, fraction(r));
            if j + 1 < size {
                model.set(i, j + 1, fraction(r));
            }
        }
    }
    if closed {
        for j in 0..size {
            let i = model.add_row(&format!("s{j}"), Range::at_least(-positive(r)));
            model.set(i, j, Rat::one());
            let i = model.add_row(&format!("t{j}"), Range::at_most(positive(r)));
            model.set(i, j, Rat::one());
        }
    }
    model
}

fn bounds(model: &Model) -> Outcome {
    let options = Options {
        accuracy: Accuracy::Bounds,
        ..Options::default()
    };
    solve(model, &options)
}

fn is_near(out: &Outcome) -> bool {
    matches!(
        out.certificate,
        Some(Certificate::Bounds {
            repair: Some(_),
            ..
        })
    )
}

fn holds(enclosure: &(Option<Rat>, Option<Rat>), optimum: &Rat) -> bool {
    let (low, high) = enclosure;
    low.as_ref().is_none_or(|l| l <= optimum) && high.as_ref().is_none_or(|h| h >= optimum)
}

/// The enclosure holds the exact optimum, is narrow, and survives its journey through JSON.
#[test]
fn nearly_exact_prices_enclose_the_optimum() {
    let mut r = Rng::new(0x1357_9bdf_0246_8ace);
    let (mut near, mut all) = (0, 0);
    for k in 0..count(4000) {
        let size = 2 + r.below(if k % 8 == 0 { 30 } else { 8 }) as usize;
        let model = chain(&mut r, size, k % 5 != 0);
        let exact = solve(&model, &Options::default());
        let out = bounds(&model);
        assert_eq!(out.status, exact.status, "{model:?}");
        let claim = Claim::of(&out).unwrap();
        assert_eq!(verify(&model, &claim), Ok(()), "{model:?}");
        let json = report::to_json(&model, "m", &out);
        let back = report::from_json(&model, &json).unwrap();
        assert_eq!(verify(&model, &back), Ok(()));
        assert_eq!(back.certificate, claim.certificate);
        let Some(optimum) = &exact.objective else {
            continue;
        };
        all += 1;
        near += usize::from(is_near(&out));
        assert!(holds(&out.enclosure, optimum), "{model:?} {out:?}");
        let (low, high) = &out.enclosure;
        let width = high.as_ref().unwrap() - low.as_ref().unwrap();
        let size = optimum.abs().nearest_f64().unwrap().max(1.0);
        assert!(width.nearest_f64().unwrap() <= 1.001e-9 * size);
    }
    assert!(2 * near > all, "{near} of {all} by nearly exact prices");
}

/// However a certificate is damaged: where it is still accepted, what it claims is still true, and
/// an enclosure that is not what it proves is never accepted.
#[test]
fn damaged_certificates_prove_nothing_false() {
    let mut r = Rng::new(0xfeed_5eed_cafe_0001);
    let (mut done, mut rejected) = (0, 0);
    let nominal = count(10_000).max(100);
    while done < nominal {
        let size = 2 + r.below(8) as usize;
        let model = chain(&mut r, size, true);
        let out = bounds(&model);
        if !is_near(&out) {
            continue;
        }
        let optimum = solve(&model, &Options::default()).objective.unwrap();
        let honest = Claim::of(&out).unwrap();
        assert_eq!(verify(&model, &honest), Ok(()));
        for _ in 0..8 {
            // An end moved by as little as 2⁻⁶⁰.
            let mut claim = honest.clone();
            let by = Rat::new(Int::one(), Int::one().shl(20 + r.below(41)));
            if r.below(2) == 0 {
                claim.enclosure.0 = claim.enclosure.0.map(|l| l + &by);
            } else {
                claim.enclosure.1 = claim.enclosure.1.map(|h| h - &by);
            }
            assert!(verify(&model, &claim).is_err(), "{model:?}");
            // Damage, and whatever the damaged certificate may prove as the claim.
            let mut claim = honest.clone();
            let Certificate::Bounds {
                primal,
                dual,
                repair,
            } = &mut claim.certificate
            else {
                unreachable!()
            };
            let (dual, repair) = (dual.as_mut().unwrap(), repair.as_mut().unwrap());
            if dual.numerators.is_empty() {
                // Nothing to gain: every price is nought.
                break;
            }
            let k = r.below(dual.numerators.len() as u64) as usize;
            match r.below(8) {
                0 => repair.margin = r.below(60) as u32,
                1 => {
                    let k = r.below(repair.order.len() as u64 + 1) as usize;
                    repair.order.truncate(k);
                }
                2 => {
                    let k = r.below(repair.order.len() as u64) as usize;
                    repair.order[k] = r.below(model.columns.len() as u64 + 2) as u32;
                }
                3 => {
                    dual.numerators.remove(k);
                }
                4 => dual.numerators[k].1 = -&dual.numerators[k].1,
                5 => {
                    let by = Rat::frac(1, 1 << r.below(40));
                    dual.numerators[k].1 = &dual.numerators[k].1 * &(Rat::one() + by);
                }
                6 => dual.denominator = &dual.denominator + &Int::from(r.below(9) as i64 - 4),
                _ => {
                    let point = primal.as_mut().unwrap();
                    let Some(entry) = point.numerators.first_mut() else {
                        continue;
                    };
                    entry.1 = &entry.1 * &(Rat::one() + fraction(&mut r));
                }
            }
            done += 1;
            if let Ok(proven) = snapfit::certificate::lp::proven(&model, &claim.certificate) {
                assert!(holds(&proven, &optimum), "{model:?} {claim:?} {proven:?}");
            } else {
                rejected += 1;
            }
            let changed = claim.certificate != honest.certificate;
            if changed && verify(&model, &claim).is_ok() {
                assert!(holds(&claim.enclosure, &optimum));
            }
        }
    }
    assert!(3 * rejected > done, "{rejected} of {done}");
}

/// Prices whose remainder is no rounding error are refused: here they miss the only free column's
/// cost by half, which no small change puts right.
#[test]
fn a_large_remainder_is_refused() {
    let mut model = Model::new("half");
    let x = model.add_column("x", Rat::one(), Range::free());
    let r = model.add_row("r", Range::at_least(Rat::one()));
    model.set(r, x, Rat::one());
    let out = bounds(&model);
    let mut claim = Claim::of(&out).unwrap();
    assert_eq!(claim.status, Status::Optimal);
    for (price, margin, accepted) in [
        (Rat::one(), 4, true),
        (Rat::frac((1 << 30) - 1, 1 << 30), 4, true),
        (Rat::frac(1, 2), 0, false),
        (Rat::frac(1, 2), 1, false),
        (Rat::frac(-1, 2), 4, false),
        (Rat::zero(), 4, false),
    ] {
        claim.certificate = Certificate::Bounds {
            primal: None,
            dual: Some(snapfit::lp::Vector {
                denominator: Int::one(),
                numerators: vec![(0, price.clone())],
            }),
            repair: Some(snapfit::lp::Repair {
                order: vec![0],
                margin,
            }),
        };
        let proven = snapfit::certificate::lp::proven(&model, &claim.certificate);
        assert_eq!(proven.is_ok(), accepted, "{price} {margin} {proven:?}");
        if let Ok((low, _)) = proven {
            assert!(low.unwrap() <= Rat::one());
        }
    }
}

/// Two nearly parallel rows: the prices ½, ½ miss the second cost by 2⁻¹⁰, but prices that meet it
/// are 1024 away and of the wrong sign; the program is unbounded. Whatever margin is hinted at,
/// nothing is proven.
#[test]
fn a_nearly_singular_matrix_proves_nothing() {
    let tiny = Rat::frac(1, 1 << 20);
    let mut model = Model::new("parallel");
    let x = model.add_column("x", Rat::one(), Range::free());
    let y = model.add_column("y", Rat::one() + Rat::frac(1, 1 << 10), Range::free());
    for (name, slope) in [("r", Rat::one()), ("s", Rat::one() + tiny)] {
        let i = model.add_row(name, Range::at_least(Rat::one()));
        model.set(i, x, Rat::one());
        model.set(i, y, slope);
    }
    let exact = solve(&model, &Options::default());
    assert_eq!(exact.status, Status::Unbounded);
    let half = Rat::frac(1, 2);
    for margin in 0..64 {
        let certificate = Certificate::Bounds {
            primal: None,
            dual: Some(snapfit::lp::Vector {
                denominator: Int::one(),
                numerators: vec![(0, half.clone()), (1, half.clone())],
            }),
            repair: Some(snapfit::lp::Repair {
                order: vec![0, 1],
                margin,
            }),
        };
        let proven = snapfit::certificate::lp::proven(&model, &certificate);
        assert!(proven.is_err(), "{margin} {proven:?}");
    }
}
