//! Roots of a small polynomial against Sturm's theorem, and against each other.
#![no_main]
use libfuzzer_sys::fuzz_target;
use snapfit::number::{Algebraic, Int, Poly, Rat};

/// Distinct real roots in (lo, hi] of a square-free polynomial, by Sturm's theorem over the rationals.
fn sturm(p: &Poly, lo: &Rat, hi: &Rat) -> usize {
    let rats = |p: &Poly| {
        p.coeffs()
            .iter()
            .cloned()
            .map(Rat::from)
            .collect::<Vec<_>>()
    };
    let mut chain = vec![rats(p), rats(&p.derivative())];
    while let [.., a, b] = &chain[..] {
        let Some(lead) = b.last() else { break };
        let mut r = a.clone();
        while r.len() >= b.len() {
            let (q, k) = (&r[r.len() - 1] / lead, r.len() - b.len());
            for (i, c) in b.iter().enumerate() {
                r[k + i] = &r[k + i] - &q * c;
            }
            while r.last().is_some_and(Rat::is_zero) {
                r.pop();
            }
        }
        let next = r.iter().map(|c| -c).collect();
        chain.push(next);
    }
    let changes = |x: &Rat| {
        let value = |f: &Vec<Rat>| {
            f.iter()
                .rev()
                .fold(Rat::zero(), |acc, c| &acc * x + c)
                .sign()
        };
        let signs: Vec<i32> = chain.iter().map(value).filter(|s| *s != 0).collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    };
    changes(lo) - changes(hi)
}

/// One coefficient: the first byte tells its size.
fn coefficient(data: &mut &[u8]) -> Option<Int> {
    let (&kind, rest) = data.split_first()?;
    let take = match kind % 8 {
        0..=4 => 0,
        5 => 2,
        6 => 8,
        _ => 15,
    };
    if take == 0 {
        *data = rest;
        return Some(Int::from(i64::from(kind as i8 >> 3)));
    }
    let (digits, rest) = rest.split_at_checked(take)?;
    *data = rest;
    let v = digits.iter().fold(0i128, |v, &d| v << 8 | i128::from(d));
    let v = Int::from(if kind & 8 == 0 { v } else { -v });
    Some(if kind & 16 == 0 {
        v
    } else {
        v.shl(u64::from(kind >> 5) * 40)
    })
}

fn poly(data: &mut &[u8], most: usize) -> Poly {
    let Some((&n, rest)) = data.split_first() else {
        return Poly::zero();
    };
    *data = rest;
    Poly::new(
        (0..=usize::from(n) % (most + 1))
            .map_while(|_| coefficient(data))
            .collect(),
    )
}

fuzz_target!(|data: &[u8]| {
    let mut data = data;
    // Products, so that multiple, rational and shared roots are common.
    let (f, g, h) = (poly(&mut data, 4), poly(&mut data, 3), poly(&mut data, 2));
    let p = &f * &g;
    if p.is_zero() {
        return;
    }
    let roots = p.real_roots();
    let far = p.coeffs().iter().map(Int::abs).max().expect("not zero") + Int::one();
    let far = Rat::from(far);
    assert_eq!(roots.len(), sturm(&p.squarefree(), &-&far, &far));
    let mut again: Vec<Algebraic> = f.real_roots();
    again.extend(g.real_roots());
    again.sort();
    again.dedup();
    assert_eq!(roots, again);
    for w in roots.windows(2) {
        let m = Algebraic::between(&w[0], &w[1]);
        assert!(w[0].cmp_rat(&m).is_lt() && w[1].cmp_rat(&m).is_gt());
    }
    for r in &roots {
        assert_eq!(r.sign_of(&p), 0);
        let x = r.interval();
        assert!(!x.lo.is_finite() || r.cmp_rat(&Rat::from_f64(x.lo)).is_ge());
        assert!(!x.hi.is_finite() || r.cmp_rat(&Rat::from_f64(x.hi)).is_le());
        // The sign of a third polynomial, by comparing with its roots.
        if !h.is_zero() {
            let below = h.real_roots().into_iter().filter(|t| t < r).last();
            let met = h.real_roots().contains(r);
            assert_eq!(r.sign_of(&h) == 0, met);
            if !met {
                // No root of h lies between the last one below (or −∞) and r.
                let m = match below {
                    Some(t) => Algebraic::between(&t, r),
                    None => r.enclosure(0).0 - Rat::one() - &far,
                };
                assert_eq!(h.sign_at(&m), r.sign_of(&h));
            }
            if !met {
                let q = r.ratio(&g, &h);
                // g − q·h vanishes at r: compare q with a rational on either side of it.
                let (lo, hi) = q.enclosure(20);
                assert!(q.cmp_rat(&lo).is_ge() && q.cmp_rat(&hi).is_le());
                let excess = g.scale(lo.denom()) - h.scale(lo.numer());
                assert_eq!(
                    r.sign_of(&excess) * r.sign_of(&h),
                    if lo == hi { 0 } else { 1 }
                );
            }
        }
    }
});
