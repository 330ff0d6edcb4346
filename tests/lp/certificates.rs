//! False claims are rejected: certificates and what they claim, changed in every way, and what a
//! journey through JSON leaves of them.

use super::{Rng, banded, random_model, rat, small, solved};
use crate::common::count;
use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{Certificate, Method, Place, Status, Vector, report};
use snapfit::number::{Int, Rat};

/// Changes something in a vector.
fn shake(v: &mut Vector, r: &mut Rng) {
    match (r.below(4), v.numerators.is_empty()) {
        (0, _) => v.denominator = &v.denominator + &Int::from(small(r)),
        (1, false) => {
            let k = r.below(v.numerators.len() as u64) as usize;
            v.numerators.remove(k);
        }
        (2, false) => {
            let k = r.below(v.numerators.len() as u64) as usize;
            v.numerators[k].0 = r.below(6) as u32;
        }
        (_, false) => {
            let k = r.below(v.numerators.len() as u64) as usize;
            v.numerators[k].1 = &v.numerators[k].1 + &Rat::from(small(r));
        }
        (_, true) => v.numerators.push((r.below(4) as u32, rat(small(r)))),
    }
}

/// A false claim is rejected, whatever is done to its certificate; and a certificate that was
/// changed only passes where what it claims is still true.
#[test]
fn false_claims_are_rejected() {
    let mut r = Rng::new(0xdead_beef_cafe_f00d);
    let mut done = 0;
    while done < count(10_000).max(20) {
        let model = random_model(&mut r);
        let out = solved(&model, Method::Warm);
        let honest = Claim::of(&out).expect("a certificate");
        for _ in 0..4 {
            let mut claim = honest.clone();
            match (&mut claim.certificate, r.below(2)) {
                (Certificate::Optimal { primal, .. }, 0) => shake(primal, &mut r),
                (Certificate::Optimal { dual, .. }, _) => shake(dual, &mut r),
                (Certificate::Infeasible { prices }, _) => shake(prices, &mut r),
                (Certificate::Unbounded { point, .. }, 0) => shake(point, &mut r),
                (Certificate::Unbounded { ray, .. }, _) => shake(ray, &mut r),
                _ => {}
            }
            match claim.status {
                Status::Optimal => {
                    let objective = claim.objective.clone().expect("an objective");
                    claim.objective = Some(&objective + &Rat::frac(1 + r.below(9) as i64, 1 << 40));
                }
                Status::Infeasible => claim.status = Status::Unbounded,
                _ => claim.status = Status::Infeasible,
            }
            assert!(verify(&model, &claim).is_err(), "{model:?} {claim:?}");
            done += 1;
        }
        // No other outcome's certificate proves a wrong status.
        let wrong = match honest.status {
            Status::Optimal => Certificate::Unbounded {
                point: vector(&[0, 1, 0]),
                ray: vector(&[1, 1, 1]),
            },
            _ => Certificate::Optimal {
                primal: vector(&[0, 0, 0]),
                dual: vector(&[0, 0, 0]),
            },
        };
        let status = match honest.status {
            Status::Optimal => Status::Unbounded,
            _ => Status::Optimal,
        };
        let claim = Claim {
            status,
            objective: Some(Rat::zero()),
            enclosure: (None, None),
            certificate: wrong,
        };
        assert!(verify(&model, &claim).is_err(), "{model:?} {claim:?}");
    }
}

/// Every change to a basis certificate, to the objective beside it or to its denominators is
/// rejected, or leaves it the certificate of what is still true.
#[test]
fn mutated_bases_are_rejected() {
    let mut r = Rng::new(0x0bad_5eed_0bad_5eed);
    let model = banded(&mut r, 350);
    let out = solved(&model, Method::Warm);
    let honest = Claim::of(&out).expect("a certificate");
    let Certificate::Basis { columns, rows, .. } = &honest.certificate else {
        panic!("the vertex is long enough for the short form");
    };
    let (n, m) = (columns.len(), rows.len());
    let places = [Place::Basic, Place::Lower, Place::Upper, Place::Zero];
    let mut rejected = 0;
    for _ in 0..count(10_000).max(20) {
        let mut claim = honest.clone();
        let Certificate::Basis {
            columns,
            rows,
            order,
            primal_denominator,
            dual_denominator,
        } = &mut claim.certificate
        else {
            unreachable!()
        };
        let k = r.below(order.len() as u64) as usize;
        let l = r.below(order.len() as u64) as usize;
        let way = r.below(9);
        match way {
            0 => columns[r.below(n as u64) as usize] = places[1 + r.below(3) as usize],
            1 => rows[r.below(m as u64) as usize] = places[2 * r.below(2) as usize],
            2 => order[k] = order[(k + 1) % order.len()],
            3 => order[k].0 = (order[k].0 + 1 + r.below(m as u64 - 1) as u32) % (m as u32 + 5),
            4 => drop(order.remove(k)),
            5 => *primal_denominator = &*primal_denominator + &Int::from(1 + small(&mut r).abs()),
            6 => *dual_denominator = -&*dual_denominator,
            7 => *dual_denominator = &*dual_denominator + &Int::from(1 + small(&mut r).abs()),
            _ => {
                let objective = claim.objective.clone().expect("an objective");
                claim.objective = Some(&objective + &Rat::frac(1 + r.below(9) as i64, 1 << 50));
                order.swap(k, l);
            }
        }
        let verdict = verify(&model, &claim);
        assert!(verdict.is_err(), "a basis mutated in way {way} passes");
        rejected += 1;
    }
    assert!(rejected >= 20);
}

fn vector(v: &[i64]) -> Vector {
    Vector {
        denominator: Int::one(),
        numerators: (0..).zip(v.iter().map(|&v| rat(v))).collect(),
    }
}

#[test]
fn results_survive_json() {
    let mut r = Rng::new(77);
    for _ in 0..50 {
        let model = random_model(&mut r);
        let out = solved(&model, Method::Warm);
        let text = report::to_json(&model, "m", &out).to_string();
        let value = serde_json::from_str(&text).expect("JSON");
        let claim = report::from_json(&model, &value).expect("a claim");
        assert_eq!(verify(&model, &claim), Ok(()));
    }
}
