//! Real roots and algebraic numbers: certified, counted a second way, and driven into the corners where
//! isolators are known to fail.
// Tests may panic: that is how they fail.
#![allow(clippy::unwrap_used)]
mod common;

use proptest::prelude::*;
use proptest::test_runner::Config;
use snapfit::number::{Algebraic, Int, Poly, Rat};
use std::cmp::Ordering;

fn config(nominal: usize) -> Config {
    Config {
        cases: common::count(nominal) as u32,
        failure_persistence: None,
        ..Config::default()
    }
}
fn poly(c: &[i64]) -> Poly {
    Poly::from_i64(c)
}
fn product(factors: &[Poly]) -> Poly {
    factors.iter().fold(poly(&[1]), |a, f| &a * f)
}

/// Sturm's theorem, the second way: distinct real roots in (lo, hi], over the rationals.
fn sturm_count(p: &Poly, lo: &Rat, hi: &Rat) -> usize {
    let to_rats = |p: &Poly| {
        p.coeffs()
            .iter()
            .map(|c| Rat::from(c.clone()))
            .collect::<Vec<_>>()
    };
    let mut chain = vec![to_rats(p), to_rats(&p.derivative())];
    loop {
        let b = chain[chain.len() - 1].clone();
        if b.is_empty() {
            chain.pop();
            break;
        }
        let mut r = chain[chain.len() - 2].clone();
        while r.len() >= b.len() {
            let q = r.last().unwrap() / b.last().unwrap();
            let k = r.len() - b.len();
            for (i, c) in b.iter().enumerate() {
                r[k + i] = &r[k + i] - &q * c;
            }
            while r.last().is_some_and(Rat::is_zero) {
                r.pop();
            }
        }
        chain.push(r.iter().map(|c| -c).collect());
    }
    let changes = |x: &Rat| {
        let signs: Vec<i32> = chain
            .iter()
            .map(|f| {
                f.iter()
                    .rev()
                    .fold(Rat::zero(), |acc, c| &acc * x + c)
                    .sign()
            })
            .filter(|s| *s != 0)
            .collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    };
    changes(lo) - changes(hi)
}

/// Everything that must hold of the list of real roots, checked by exact evaluation alone.
fn certify(p: &Poly, roots: &[Algebraic]) {
    let far = p.coeffs().iter().map(|c| c.abs()).max().unwrap() + Int::one();
    let far = Rat::from(far);
    // Sturm's count at an end that is a multiple root would be wrong.
    let squarefree = p.squarefree();
    let count = sturm_count(&squarefree, &-&far, &far);
    assert_eq!(roots.len(), count, "{p}: {roots:?}");
    for r in roots {
        assert_eq!(r.sign_of(p), 0, "{p} at {r:?}");
        for bits in [0, 3, 53, 200] {
            let (lo, hi) = r.enclosure(bits);
            if lo == hi {
                assert_eq!(r.to_rat(), Some(lo.clone()));
                assert_eq!(p.sign_at(&lo), 0);
            } else {
                assert!(&hi - &lo <= Rat::frac(1, 2).pow(bits), "{p} at {bits}");
                let inside = sturm_count(&squarefree, &lo, &hi);
                assert!(inside >= 1);
                let (s, t) = (squarefree.sign_at(&lo), squarefree.sign_at(&hi));
                if inside == 1 && t != 0 {
                    // Alone in the cell, unless its lower end is another root.
                    assert!(s * t < 0 || s == 0, "{p} at {r:?}");
                }
                assert!(r.cmp_rat(&lo).is_gt() && r.cmp_rat(&hi).is_lt());
            }
        }
        let x = r.interval();
        assert!(
            x.lo <= x.hi
                && (x.lo == x.hi
                    || x.lo.next_up().next_up() >= x.hi
                    || x.width() < 1.1e-14 * x.hi.abs().max(x.lo.abs())),
            "{x:?}"
        );
        if x.lo.is_finite() {
            assert!(r.cmp_rat(&Rat::from_f64(x.lo)).is_ge());
        }
        if x.hi.is_finite() {
            assert!(r.cmp_rat(&Rat::from_f64(x.hi)).is_le());
        }
        if let Some(n) = r.nearest_f64() {
            assert!(x.contains(n), "{n} not in {x:?}");
        }
        let m = r.minimal_polynomial();
        assert_eq!(r.sign_of(&m), 0);
        assert_eq!(m.irreducible_factors(), vec![m.clone()]);
        let (lo, hi) = r.isolating_interval();
        if r.to_rat().is_none() {
            assert_eq!(m.real_roots_in(&lo, &hi), vec![r.clone()]);
            let j = hi.denom().bits().max(lo.denom().bits()) - 1;
            if j > 0 {
                // Coarser is too coarse.
                let k = lo.numer() * Int::one().shl(j).div_exact(lo.denom());
                let k = k.shr(1);
                let two = Int::one().shl(j - 1);
                assert!(
                    m.real_roots_in(
                        &Rat::new(k.clone(), two.clone()),
                        &Rat::new(k + Int::one(), two)
                    )
                    .len()
                        > 1
                );
            }
        }
    }
    for w in roots.windows(2) {
        assert_eq!(w[0].cmp(&w[1]), Ordering::Less);
        assert_eq!(w[1].cmp(&w[0]), Ordering::Greater);
        assert_ne!(w[0], w[1]);
        let m = Algebraic::between(&w[0], &w[1]);
        assert_eq!(Algebraic::between(&w[1], &w[0]), m);
        assert!(w[0].cmp_rat(&m).is_lt() && w[1].cmp_rat(&m).is_gt());
        assert_ne!(p.sign_at(&m), 0);
    }
}

fn rats(roots: &[Algebraic]) -> Vec<Option<String>> {
    roots
        .iter()
        .map(|r| r.to_rat().map(|r| r.to_string()))
        .collect()
}

#[test]
fn constants_and_zero() {
    assert!(poly(&[7]).real_roots().is_empty());
    assert!(
        poly(&[-7])
            .real_roots_in(&Rat::zero(), &Rat::one())
            .is_empty()
    );
    assert!(std::panic::catch_unwind(|| Poly::zero().real_roots()).is_err());
    assert!(Poly::zero().irreducible_factors().is_empty());
    assert!(poly(&[6]).irreducible_factors().is_empty());
    assert_eq!(Poly::zero().gcd(&Poly::zero()), Poly::zero());
    assert_eq!(Poly::zero().gcd(&poly(&[-4, -2])), poly(&[2, 1]));
    assert_eq!(Poly::zero().squarefree(), Poly::zero());
    assert_eq!(poly(&[0, 0, 0]).degree(), None);
}

#[test]
fn negative_leading_coefficient_and_content() {
    let p = poly(&[12, 0, -6]);
    let roots = p.real_roots();
    certify(&p, &roots);
    assert_eq!(roots, poly(&[-2, 0, 1]).real_roots());
    assert_eq!(roots[0].minimal_polynomial(), poly(&[-2, 0, 1]));
    let p = poly(&[30, 0, -60, 0, -30, 90]);
    certify(&p, &p.real_roots());
    for c in [
        [-2i64, 3, 5],
        [-2, -3, 5],
        [2, 3, -5],
        [2, -3, -5],
        [-1, 0, 7],
        [1, 0, -7],
        [0, 3, -5],
        [0, 0, 3],
    ] {
        let p = poly(&c);
        certify(&p, &p.real_roots());
    }
}

#[test]
fn dyadic_roots_met_while_bisecting() {
    // Zero, one, powers of two and their neighbours are where halving lands.
    let p = product(&[
        poly(&[0, 1]),
        poly(&[-1, 1]),
        poly(&[1, 1]),
        poly(&[-1, 2]),
        poly(&[-3, 4]),
        poly(&[-2, 0, 1]),
    ]);
    let roots = p.real_roots();
    certify(&p, &roots);
    assert_eq!(
        rats(&roots),
        [
            None,
            Some("-1"),
            Some("0"),
            Some("1/2"),
            Some("3/4"),
            Some("1"),
            None
        ]
        .map(|s| s.map(String::from))
    );
    // A root so near zero that its first interval would begin at the root zero.
    let p = product(&[
        poly(&[0, 1]),
        poly(&[-1, 1 << 40]),
        poly(&[1, 3 << 40]),
        poly(&[-2, 0, 1]),
    ]);
    certify(&p, &p.real_roots());
    let p = product(&[poly(&[0, 1]), poly(&[-1, 0, 3 << 40])]);
    certify(&p, &p.real_roots());
    let p = product(&[poly(&[0, 1]), poly(&[-1, 2]), poly(&[-1, 0, 2])]);
    certify(&p, &p.real_roots());
}

#[test]
fn roots_at_the_ends_of_the_interval() {
    let p = product(&[poly(&[-1, 3]), poly(&[-2, 3]), poly(&[-2, 0, 1])]);
    let at = |a: Rat, b: Rat| p.real_roots_in(&a, &b).len();
    assert_eq!(at(Rat::frac(1, 3), Rat::frac(2, 3)), 2);
    assert_eq!(at(Rat::frac(1, 3), Rat::frac(1, 3)), 1);
    assert_eq!(
        at(Rat::frac(1, 3) + Rat::frac(1, 1 << 60), Rat::frac(2, 3)),
        1
    );
    assert_eq!(at(Rat::frac(2, 3), Rat::frac(3, 2)), 2);
    assert_eq!(at(Rat::frac(2, 3), Rat::frac(1, 3)), 0);
    let q = poly(&[-1, 0, 4]);
    assert_eq!(
        q.real_roots_in(&Rat::frac(-1, 2), &Rat::frac(1, 2)).len(),
        2
    );
}

#[test]
fn double_roots() {
    let p = product(&[
        poly(&[-2, 0, 1]),
        poly(&[-2, 0, 1]),
        poly(&[-1, 2]),
        poly(&[-1, 2]),
        poly(&[-1, 2]),
        poly(&[1, 0, 1]),
    ]);
    let roots = p.real_roots();
    certify(&p, &roots);
    assert_eq!(roots.len(), 3);
    assert_eq!(
        poly(&[1, -2, 1]).real_roots(),
        vec![Algebraic::from(Rat::one())]
    );
    assert_eq!(
        p.squarefree(),
        product(&[poly(&[-2, 0, 1]), poly(&[-1, 2]), poly(&[1, 0, 1])])
    );
}

#[test]
fn degree_that_drops_by_cancellation() {
    let p = poly(&[1, 2, 3, 4]) - poly(&[5, -6, 3, 4]);
    assert_eq!(p.degree(), Some(1));
    assert_eq!(p.real_roots(), vec![Algebraic::from(Rat::frac(1, 2))]);
    assert_eq!((poly(&[1, 1]) - poly(&[1, 1])).degree(), None);
    // Over t = √2 the leading coefficient −2 + t² would vanish; it does not, but p + t·q drops for t = −1.
    let r = Algebraic::from(Rat::from(-1)).root_over(
        &poly(&[-3, 1, 1]),
        &poly(&[0, 0, 1]),
        &mut |_| (Rat::from(2), Rat::from(4)),
    );
    assert_eq!(r, Algebraic::from(Rat::from(3)));
}

#[test]
fn rational_against_algebraic() {
    // A rational root of a polynomial that nobody factored.
    let p = product(&[poly(&[-1, 3]), poly(&[-2, 0, 1]), poly(&[-3, 0, 0, 1])]);
    let third = &p.real_roots()[1];
    assert_eq!(third.cmp_rat(&Rat::frac(1, 3)), Ordering::Equal);
    assert_eq!(*third, Algebraic::from(Rat::frac(1, 3)));
    assert_eq!(third.to_rat(), Some(Rat::frac(1, 3)));
    assert_eq!(third.minimal_polynomial(), poly(&[-1, 3]));
    assert_eq!(third.nearest_f64(), Some(1.0 / 3.0));
    // The tie between two doubles, as a root that is not known to be rational.
    let tie = (Int::one().shl(53) + Int::one(), Int::one().shl(53));
    let p = Poly::new(vec![-&tie.0, tie.1.clone()]) * poly(&[-7, 0, 0, 1]) * poly(&[1, 0, 3]);
    let r = &p.real_roots()[0];
    assert_eq!(r.nearest_f64(), Some(1.0));
    assert_eq!(r.to_rat(), Some(Rat::new(tie.0, tie.1)));
    let sqrt2 = &poly(&[-2, 0, 1]).real_roots()[1];
    let convergent = Rat::new("1855077841".parse().unwrap(), "1311738121".parse().unwrap());
    assert_eq!(
        sqrt2.cmp_rat(&convergent) as i32,
        -(poly(&[-2, 0, 1]).sign_at(&convergent))
    );
}

/// Roots of two different polynomials that agree to `bits` bits.
fn near_pair(bits: u64) -> (Algebraic, Algebraic) {
    let two = Int::from(2i64);
    let n = Int::one().shl(bits);
    let p = Poly::new(vec![-&two * &n, Int::zero(), n.clone()]);
    let q = Poly::new(vec![-(&two * &n) - Int::one(), Int::zero(), n]);
    (p.real_roots().remove(1), q.real_roots().remove(1))
}

#[test]
fn very_near_roots_of_two_polynomials() {
    for bits in [40, 60, 200, 1000, 5000] {
        let (a, b) = near_pair(bits);
        assert_eq!(
            (a.cmp(&b), b.cmp(&a)),
            (Ordering::Less, Ordering::Greater),
            "{bits}"
        );
        assert_ne!(a, b);
        let m = Algebraic::between(&b, &a);
        assert!(a.cmp_rat(&m).is_lt() && b.cmp_rat(&m).is_gt());
        // And of one polynomial: (x² − 2)(2^b x² − 2^(b+1) − 1).
        let p = a.defining_polynomial() * b.defining_polynomial();
        let roots = p.real_roots();
        assert_eq!(roots.len(), 4);
        assert_eq!(roots[2], a);
        assert_eq!(roots[3], b);
        assert_eq!(roots[2].sign_of(&b.defining_polynomial()), -1);
        assert_eq!(roots[3].sign_of(&a.defining_polynomial()), 1);
    }
    // Mignotte's polynomial: two roots of one irreducible polynomial as near as can be.
    for (n, a) in [(5usize, 100i64), (9, 10_000)] {
        let mut c = vec![Int::zero(); n + 1];
        c[0] = Int::from(-2i64);
        c[1] = Int::from(4 * a);
        c[2] = Int::from(-2 * a * a);
        c[n] = Int::one();
        let p = Poly::new(c);
        certify(&p, &p.real_roots());
    }
}

#[test]
fn chebyshev_wilkinson_and_swinnerton_dyer() {
    let w = product(&(1..=20).map(|k| poly(&[-k, 1])).collect::<Vec<_>>());
    let roots = w.real_roots();
    assert_eq!(
        rats(&roots),
        (1..=20).map(|k| Some(k.to_string())).collect::<Vec<_>>()
    );
    assert_eq!(w.irreducible_factors().len(), 20);
    let (mut a, mut b) = (poly(&[1]), poly(&[0, 1]));
    for _ in 1..12 {
        let c = poly(&[0, 2]) * &b - &a;
        a = b;
        b = c;
    }
    certify(&b, &b.real_roots());
    // √2 + √3 + √5 + √7: degree 16, splits into quadratics modulo every prime.
    let mut sd = poly(&[0, 1]);
    for k in [2i64, 3, 5, 7] {
        // p(x − √k)·p(x + √k) by writing p(x ± y) = A + y·B with y² = k.
        let (mut u, mut v) = (Poly::zero(), Poly::zero());
        for c in sd.coeffs().iter().rev() {
            let (nu, nv) = (
                &u * poly(&[0, 1]) + v.scale(&Int::from(k)),
                &v * poly(&[0, 1]) + &u,
            );
            u = nu + Poly::constant(c.clone());
            v = nv;
        }
        sd = &u * &u - (&v * &v).scale(&Int::from(k));
    }
    assert_eq!(sd.degree(), Some(16));
    assert_eq!(sd.irreducible_factors(), vec![sd.clone()]);
    assert_eq!(sd.real_roots().len(), 16);
    let top = sd.real_roots().remove(15);
    let sum: f64 = [2f64, 3.0, 5.0, 7.0].iter().map(|x| x.sqrt()).sum();
    assert!((top.nearest_f64().unwrap() - sum).abs() < 1e-14);
}

#[test]
fn known_factorisations() {
    let check = |factors: &[Poly]| {
        let p = product(factors).scale(&Int::from(-6i64));
        let mut want: Vec<Poly> = factors.iter().map(Poly::primitive).collect();
        want.sort_by(|a, b| a.degree().cmp(&b.degree()).then_with(|| a.cmp(b)));
        want.dedup();
        assert_eq!(p.irreducible_factors(), want);
    };
    check(&[poly(&[0, 1]), poly(&[1, 0, 1])]);
    check(&[poly(&[-2, 0, 1]), poly(&[-3, 0, 1]), poly(&[-2, 0, 1])]);
    check(&[poly(&[1, 0, 0, 0, 1])]);
    check(&[
        poly(&[1, 1, 1, 1, 1]),
        poly(&[-1, 1]),
        poly(&[1, -1, 1, -1, 1]),
        poly(&[1, 1]),
    ]);
    check(&[
        poly(&[7, 5, 3]),
        poly(&[-11, 2, 0, 6]),
        poly(&[3, 1, 1, 0, 0, 2]),
    ]);
    check(&[poly(&[-1, 1 << 40]), poly(&[1 << 50, 3, 1 << 20, 5])]);
    // Dense, of degree 16, with large coefficients.
    let f = poly(&[123456789, -987654321, 5, 7, 11, 13, 17, 19, 1 << 40]);
    let g = poly(&[-3, 1 << 45, 0, 0, 2, 0, 0, 0, 5]);
    check(&[f, g]);
}

#[test]
fn tiny_and_huge_roots() {
    for e in [300u32, 1020, 1080, 1100, 3000] {
        let ten = Int::from(2i64).pow(e);
        // 2^-e·√2 and 2^e·√2
        for p in [
            Poly::new(vec![Int::from(-2i64), Int::zero(), &ten * &ten]),
            Poly::new(vec![
                Int::from(-2i64) * &ten * &ten,
                Int::zero(),
                Int::one(),
            ]),
            Poly::new(vec![
                Int::from(-2i64),
                Int::zero(),
                Int::zero(),
                &ten * &ten * &ten,
            ]),
        ] {
            let roots = p.real_roots();
            certify(&p, &roots);
            assert!(roots.iter().all(|r| r.sign() != 0));
            if p.degree() == Some(2) {
                assert_eq!([roots[0].sign(), roots[1].sign()], [-1, 1]);
                let x = roots[1].nearest_f64();
                let large = p.leading().unwrap().is_one();
                match (large, e) {
                    (true, 1080..) => assert_eq!(x, None),
                    (false, 1080..) => assert_eq!(x, Some(0.0)),
                    (false, 1020) => assert_eq!(
                        x,
                        Some(f64::from_bits(1 << 52) * 4.0 * std::f64::consts::SQRT_2)
                    ),
                    _ => assert!(x.unwrap() > 0.0),
                }
            }
        }
    }
}

#[test]
fn ratios_and_substitutions() {
    let sqrt2 = poly(&[-2, 0, 1]).real_roots().remove(1);
    // (√2 + 1)/(√2 − 1) = 3 + 2√2
    let r = sqrt2.ratio(&poly(&[1, 1]), &poly(&[-1, 1]));
    assert_eq!(r, poly(&[1, -6, 1]).real_roots()[1]);
    // √2²/1 is rational; 0/1 is zero.
    assert_eq!(
        sqrt2.ratio(&poly(&[0, 0, 1]), &poly(&[1])).to_rat(),
        Some(Rat::from(2))
    );
    assert_eq!(
        sqrt2.ratio(&poly(&[-2, 0, 1]), &poly(&[0, 1])).to_rat(),
        Some(Rat::zero())
    );
    assert_eq!(
        sqrt2.ratio(&Poly::zero(), &poly(&[0, 1])).to_rat(),
        Some(Rat::zero())
    );
    assert!(std::panic::catch_unwind(|| sqrt2.ratio(&poly(&[1]), &poly(&[-2, 0, 1]))).is_err());
    // A denominator that vanishes at a conjugate: root 1/3 beside √2.
    let p = product(&[poly(&[-1, 3]), poly(&[-2, 0, 1]), poly(&[1, 1, 0, 1])]);
    let root = p.real_roots().into_iter().find(|r| *r == sqrt2).unwrap();
    assert_eq!(
        root.ratio(&poly(&[1]), &poly(&[-1, 3])),
        sqrt2.ratio(&poly(&[1]), &poly(&[-1, 3]))
    );
    // x² = √2 over the enclosure [1, 2].
    let fourth = sqrt2.root_over(&poly(&[0, 0, 1]), &poly(&[-1]), &mut |_| {
        (Rat::one(), Rat::from(2))
    });
    assert_eq!(fourth.minimal_polynomial(), poly(&[-2, 0, 0, 0, 1]));
    // (x − t)(x − 5) = 0 with t = √2: both roots, told apart by the enclosure only.
    let (p, q) = (poly(&[0, -5, 1]), poly(&[5, -1]));
    let low = sqrt2.root_over(&p, &q, &mut |_| (Rat::one(), Rat::from(2)));
    assert_eq!(low, sqrt2);
    let high = sqrt2.root_over(&p, &q, &mut |_| (Rat::from(4), Rat::from(6)));
    assert_eq!(high.to_rat(), Some(Rat::from(5)));
    // The rational conjugate 2 of a polynomial nobody factored makes p + t·q vanish: t = 2, p = −2q.
    let t = product(&[poly(&[-2, 1]), poly(&[-2, 0, 1])])
        .real_roots()
        .into_iter()
        .find(|r| *r == sqrt2)
        .unwrap();
    let x = t.root_over(&poly(&[2, -2]), &poly(&[-1, 1]), &mut |_| {
        (Rat::zero(), Rat::from(2))
    });
    assert_eq!(x.to_rat(), Some(Rat::one()));
}

fn coefficient() -> impl Strategy<Value = Int> {
    // Heavy-tailed sizes: most small, some of hundreds of bits.
    prop_oneof![
        6 => (-9i64..=9).prop_map(Int::from),
        3 => any::<i32>().prop_map(Int::from),
        2 => any::<i64>().prop_map(Int::from),
        1 => (any::<i128>(), 0u64..300).prop_map(|(v, k)| Int::from(v).shl(k) + Int::one()),
    ]
}
fn any_poly(degree: usize) -> impl Strategy<Value = Poly> {
    prop::collection::vec(coefficient(), 1..=degree + 1)
        .prop_map(Poly::new)
        .prop_filter("not zero", |p| !p.is_zero())
}
fn small_poly(degree: usize, size: i64) -> impl Strategy<Value = Poly> {
    prop::collection::vec(-size..=size, 1..=degree + 1)
        .prop_map(|c| poly(&c))
        .prop_filter("not zero", |p| !p.is_zero())
}

proptest! {
    #![proptest_config(config(20_000))]

    #[test]
    fn roots_are_certified(p in any_poly(6)) {
        certify(&p, &p.real_roots());
    }

    #[test]
    fn products_of_small_factors(f in prop::collection::vec(small_poly(2, 4), 1..5)) {
        // Rational, double, dyadic and shared roots in abundance.
        let p = product(&f);
        if p.degree().is_some_and(|d| d <= 8) {
            let roots = p.real_roots();
            certify(&p, &roots);
            let mut all: Vec<Algebraic> = f.iter().flat_map(|g| g.real_roots()).collect();
            all.sort();
            all.dedup();
            prop_assert_eq!(all, roots);
        }
    }

    #[test]
    fn signs_agree_with_refinement(p in small_poly(4, 9), q in small_poly(4, 9)) {
        for a in p.real_roots() {
            // The sign of q on a narrow enclosure, or zero by a common factor.
            let s = a.sign_of(&q);
            let (lo, hi) = a.enclosure(400);
            if s == 0 {
                prop_assert!(p.gcd(&q).degree() != Some(0));
                prop_assert!(q.real_roots().contains(&a));
            } else {
                prop_assert_eq!(q.sign_at(&lo), s);
                prop_assert_eq!(q.sign_at(&hi), s);
            }
            for b in q.real_roots() {
                let (l, h) = b.enclosure(400);
                // 400 bits separate all different numbers of this kind.
                let want = match (a.to_rat(), b.to_rat()) {
                    (Some(x), Some(y)) => x.cmp(&y),
                    _ if hi <= l => Ordering::Less,
                    _ if h <= lo => Ordering::Greater,
                    _ => Ordering::Equal,
                };
                prop_assert_eq!(a.cmp(&b), want);
                prop_assert_eq!(a == b, want.is_eq());
            }
        }
    }

    #[test]
    fn ratio_is_the_quotient(p in small_poly(4, 9), n in small_poly(2, 9), d in small_poly(2, 9)) {
        for a in p.real_roots() {
            if a.sign_of(&d) != 0 {
                let r = a.ratio(&n, &d);
                // n(a)/d(a) lies within 2^-300 of the enclosure.
                let (lo, hi) = r.enclosure(300);
                let (x, y) = a.enclosure(400);
                let (v, w) = (n.eval(&x) / d.eval(&x), n.eval(&y) / d.eval(&y));
                let slack = Rat::frac(1, 2).pow(280);
                prop_assert!(&lo - &slack < v && v < &hi + &slack, "{:?} {:?} {:?}", a, n, d);
                prop_assert!(&lo - &slack < w && w < &hi + &slack);
            }
        }
    }

    #[test]
    fn quotients_compare_as_their_own_roots(
        p in small_poly(3, 9), q in small_poly(3, 9),
        n in small_poly(2, 9), d in small_poly(2, 9), near in 0u64..300,
    ) {
        // The same quotient of two numbers, of which the second may differ from the first by 2^-near of it, first
        // as it is, then by the roots of polynomials of its own.
        let k = Int::one().shl(near);
        for a in p.real_roots().iter().filter(|a| a.sign_of(&d) != 0) {
            for b in q.real_roots().iter().filter(|b| b.sign_of(&d) != 0) {
                let beside = n.scale(&(&k + Int::one()));
                let make = || {
                    let exactly = b.ratio(&n, &d);
                    (a.ratio(&n, &d), exactly, b.ratio(&beside, &d.scale(&k)))
                };
                let fresh = make();
                let settled = make();
                for x in [&settled.0, &settled.1, &settled.2] {
                    // Asking for the polynomial settles the quotient.
                    let _ = x.defining_polynomial();
                }
                prop_assert_eq!(fresh.0.cmp(&fresh.1), settled.0.cmp(&settled.1));
                let fresh = make();
                prop_assert_eq!(fresh.0 == fresh.2, settled.0 == settled.2);
                prop_assert_eq!(fresh.0.cmp(&fresh.2), settled.0.cmp(&settled.2));
                prop_assert_eq!(fresh.2.cmp(&fresh.1), settled.2.cmp(&settled.1));
                prop_assert_eq!(fresh.2.sign(), settled.2.sign());
                // Between different ones a rational.
                if fresh.1 != fresh.2 {
                    let m = Algebraic::between(&fresh.1, &fresh.2);
                    prop_assert_eq!(fresh.1.cmp_rat(&m), settled.1.cmp(&settled.2));
                    prop_assert_eq!(settled.2.cmp_rat(&m), settled.2.cmp(&settled.1));
                }
            }
        }
    }

    #[test]
    fn root_over_finds_the_root(m in small_poly(3, 9), p in small_poly(2, 9), q in small_poly(2, 9)) {
        for t in m.real_roots() {
            // Roots of p + t·q located by rational neighbours of t: sign changes of the polynomial at lo and hi of t.
            let (lo, hi) = t.enclosure(200);
            let at = |t: &Rat| p.scale(t.denom()) + q.scale(t.numer());
            let (f, g) = (at(&lo), at(&hi));
            if f.degree() != Some(2) || g.degree() != Some(2) {
                continue;
            }
            let (r, s) = (f.real_roots(), g.real_roots());
            if r.len() != 2 || s.len() != 2 {
                continue;
            }
            for (a, b) in r.iter().zip(&s) {
                let (a, b) = (a.enclosure(100), b.enclosure(100));
                let eps = Rat::frac(1, 2).pow(60);
                let (from, to) = (a.0.min(b.0) - &eps, a.1.max(b.1) + &eps);
                let x = t.root_over(&p, &q, &mut |_| (from.clone(), to.clone()));
                prop_assert!(x.cmp_rat(&from).is_ge() && x.cmp_rat(&to).is_le());
                // t = −p(x)/q(x), unless q vanishes there.
                if x.sign_of(&q) != 0 {
                    prop_assert_eq!(x.ratio(&-&p, &q), t.clone());
                } else {
                    prop_assert_eq!(x.sign_of(&p), 0);
                }
            }
        }
    }

    #[test]
    fn factors_multiply_back(p in small_poly(5, 30), q in small_poly(5, 30)) {
        let r = &p * &q;
        let factors = r.irreducible_factors();
        prop_assert_eq!(product(&factors), if r.degree() == Some(0) { poly(&[1]) } else { r.squarefree() });
        // Each divides one of the two, and is itself irreducible.
        for f in &factors {
            prop_assert!(p.div_exact(f).is_some() || q.div_exact(f).is_some());
            prop_assert_eq!(f.irreducible_factors(), vec![f.clone()]);
        }
    }

    #[test]
    fn gcd_divides_and_is_greatest(p in any_poly(4), q in any_poly(4), r in any_poly(3)) {
        let g = (&p * &r).gcd(&(&q * &r));
        prop_assert!((&p * &r).div_exact(&g).is_some() && (&q * &r).div_exact(&g).is_some());
        prop_assert!(g.div_exact(&r).is_some());
        let (a, b) = ((&p * &r).div_exact(&g).unwrap(), (&q * &r).div_exact(&g).unwrap());
        prop_assert_eq!(a.gcd(&b), poly(&[1]));
        prop_assert_eq!((&p * &q).div_exact(&q).map(|x| x.primitive()), Some(p.primitive()));
    }
}
