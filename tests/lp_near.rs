//! Bounds without a vertex: short prices that are nearly exact, and the proof that exact ones are
//! near. Checked against the exact optimum, and by damage done to the certificates.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::count;
use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{Accuracy, Certificate, Model, Options, Outcome, Range, Status, report, solve};
use snapfit::number::{Int, Rat};

struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % n
    }
    /// A multiple of 2⁻²⁰ between −2 and 2.
    fn fraction(&mut self) -> Rat {
        Rat::frac(self.below(1 << 22) as i64 - (1 << 21), 1 << 20)
    }
    fn positive(&mut self) -> Rat {
        Rat::frac(1 + self.below(1 << 20) as i64, 1 << 20)
    }
}

/// A chain of mostly free columns; inequalities between neighbours, from one side or both, with
/// the origin inside. Without its last rows it may be unbounded.
fn chain(r: &mut Random, size: usize, closed: bool) -> Model {
    let mut model = Model::new("chain");
    model.maximise = r.below(2) == 0;
    for j in 0..size {
        let range = match r.below(8) {
            0 => Range::at_least(-r.positive()),
            1 => Range {
                lower: Some(-r.positive()),
                upper: Some(r.positive()),
            },
            _ => Range::free(),
        };
        let cost = if r.below(3) == 0 {
            r.fraction()
        } else {
            Rat::zero()
        };
        model.add_column(&format!("x{j}"), cost, range);
    }
    model.constant = r.fraction();
    for j in 0..size {
        for k in 0..2 + r.below(4) {
            let range = match (k, r.below(4)) {
                (0, _) => Range {
                    lower: Some(-r.positive()),
                    upper: Some(r.positive()),
                },
                (_, 0) => Range::at_most(r.positive()),
                _ => Range::at_least(-r.positive()),
            };
            let i = model.add_row(&format!("r{j}.{k}"), range);
            model.set(i, j, r.fraction());
            if j + 1 < size {
                model.set(i, j + 1, r.fraction());
            }
        }
    }
    if closed {
        for j in 0..size {
            let i = model.add_row(&format!("s{j}"), Range::at_least(-r.positive()));
            model.set(i, j, Rat::one());
            let i = model.add_row(&format!("t{j}"), Range::at_most(r.positive()));
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
    let mut r = Random(0x1357_9bdf_0246_8ace);
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
    let mut r = Random(0xfeed_5eed_cafe_0001);
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
                    entry.1 = &entry.1 * &(Rat::one() + r.fraction());
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
