//! Integers, rationals, intervals and literals, against a second implementation and by hand.
// Tests may panic: that is how they fail.
#![allow(clippy::unwrap_used)]
mod common;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use proptest::prelude::*;
use proptest::test_runner::Config;
use snapfit::number::literal::{self, LiteralError, MAX_DIGITS};
use snapfit::number::{Int, Interval, Rat};
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

fn config(nominal: usize) -> Config {
    Config {
        cases: common::count(nominal) as u32,
        failure_persistence: None,
        ..Config::default()
    }
}
fn hash<T: Hash>(x: &T) -> u64 {
    let mut h = DefaultHasher::new();
    x.hash(&mut h);
    h.finish()
}

/// Sizes around the word borders and far beyond.
fn big() -> impl Strategy<Value = BigInt> {
    prop_oneof![
        4 => (-20i64..=20).prop_map(BigInt::from),
        3 => any::<i64>().prop_map(BigInt::from),
        3 => any::<i128>().prop_map(BigInt::from),
        2 => (0u64..300, -2i64..=2, any::<bool>()).prop_map(|(k, d, s)| {
            let v = (BigInt::from(1) << k) + d;
            if s { -v } else { v }
        }),
        2 => prop::collection::vec(any::<u32>(), 1..40).prop_map(|d| BigInt::from(num_bigint::BigUint::new(d))),
    ]
}
fn int(v: &BigInt) -> Int {
    Int::from(v.clone())
}
fn same(a: &Int, b: &BigInt) -> bool {
    BigInt::from(a.clone()) == *b && *a == Int::from(b.clone()) && hash(a) == hash(&int(b))
}
fn ratio() -> impl Strategy<Value = BigRational> {
    (
        big(),
        big().prop_filter("not zero", |d| *d != BigInt::from(0)),
    )
        .prop_map(|(n, d)| BigRational::new(n, d))
}
fn equal(a: &Rat, b: &BigRational) -> bool {
    BigInt::from(a.numer().clone()) == *b.numer() && BigInt::from(a.denom().clone()) == *b.denom()
}

proptest! {
    #![proptest_config(config(100_000))]

    #[test]
    fn integers_agree_with_num(a in big(), b in big(), k in 0u64..400) {
        let (x, y) = (int(&a), int(&b));
        prop_assert!(same(&(&x + &y), &(&a + &b)));
        prop_assert!(same(&(&x - &y), &(&a - &b)));
        prop_assert!(same(&(&x * &y), &(&a * &b)));
        prop_assert!(same(&-&x, &-&a));
        prop_assert!(same(&x.abs(), &a.abs()));
        prop_assert!(same(&x.gcd(&y), &num_integer::Integer::gcd(&a, &b)));
        prop_assert!(same(&x.shl(k), &(&a << k)));
        prop_assert!(same(&x.shr(k), &num_integer::Integer::div_floor(&a, &(BigInt::from(1) << k))));
        prop_assert_eq!(x.cmp(&y), a.cmp(&b));
        prop_assert_eq!(x.bits(), a.bits());
        prop_assert_eq!(x.sign(), a.signum().to_i32().unwrap());
        prop_assert_eq!(x.trailing_zeros(), a.trailing_zeros());
        prop_assert_eq!(x.to_string().parse::<Int>(), Ok(x.clone()));
        prop_assert_eq!(x.to_string(), a.to_string());
        prop_assert_eq!(x.to_i64(), a.to_i64());
        for m in [1u64, 2, 97, 1 << 31, u64::MAX, (1 << 63) + 1] {
            prop_assert_eq!(x.mod_u64(m), num_integer::Integer::mod_floor(&a, &BigInt::from(m)).to_u64().unwrap());
        }
        if !y.is_zero() {
            let (q, r) = num_integer::Integer::div_mod_floor(&a, &b);
            let (p, s) = x.div_rem_floor(&y);
            prop_assert!(same(&p, &q) && same(&s, &r));
            prop_assert!(same(&(&x * &y).div_exact(&y), &a));
        }
        if a.is_positive() {
            prop_assert!(same(&x.sqrt().unwrap(), &a.sqrt()));
            prop_assert!(same(&(&x * &x).sqrt_exact().unwrap(), &a));
        }
    }

    #[test]
    fn gcd_of_multiples(a in big(), b in big(), g in big()) {
        // Common factors of every size, which random pairs do not have.
        let (x, y) = (&a * &g, &b * &g);
        prop_assert!(same(&int(&x).gcd(&int(&y)), &num_integer::Integer::gcd(&x, &y)));
    }

    #[test]
    fn rationals_agree_with_num(a in ratio(), b in ratio()) {
        let (x, y) = (Rat::from(a.clone()), Rat::from(b.clone()));
        prop_assert!(equal(&x, &a));
        prop_assert_eq!(BigRational::from(x.clone()), a.clone());
        prop_assert!(equal(&(&x + &y), &(&a + &b)));
        prop_assert!(equal(&(&x - &y), &(&a - &b)));
        prop_assert!(equal(&(&x * &y), &(&a * &b)));
        prop_assert!(equal(&(&x - &x), &(&a - &a)));
        prop_assert!(equal(&-&x, &-&a));
        prop_assert!(equal(&x.abs(), &a.abs()));
        prop_assert!(equal(&x.square(), &(&a * &a)));
        prop_assert!(equal(&x.pow(3), &(&a * &a * &a)));
        prop_assert!(equal(&Rat::midpoint(&x, &y), &((&a + &b) / BigInt::from(2))));
        prop_assert_eq!(x.cmp(&y), a.cmp(&b));
        prop_assert!(same(&x.floor(), &a.floor().to_integer()) && same(&x.ceil(), &a.ceil().to_integer()));
        if !y.is_zero() {
            prop_assert!(equal(&(&x / &y), &(&a / &b)));
            prop_assert!(equal(&y.recip(), &b.recip()));
        }
        prop_assert_eq!(x.to_string().parse::<Rat>(), Ok(x.clone()));
    }

    #[test]
    fn short_between_is_short(a in ratio(), b in ratio(), shrink in 0u32..300) {
        let (x, y) = (Rat::from(a), Rat::from(b));
        let y = &x + (&y - &x) * Rat::frac(1, 2).pow(shrink);
        if x != y {
            let (lo, hi) = (x.clone().min(y.clone()), x.max(y));
            let m = Rat::short_between(&lo, &hi);
            prop_assert!(lo < m && m < hi);
            let j = m.denom().bits() - 1;
            prop_assert_eq!(m.denom(), &Int::one().shl(j));
            if j > 0 {
                // No coarser grid has a point inside.
                let k = (&lo * Rat::from(Int::one().shl(j - 1))).floor() + Int::one();
                prop_assert!(Rat::new(k, Int::one().shl(j - 1)) >= hi);
            }
        }
    }

    #[test]
    fn doubles_are_nearest(n in big(), d in big(), e in -1200i64..1200) {
        if d != BigInt::from(0) {
            let two = Rat::from(Int::one().shl(e.unsigned_abs()));
            let x = Rat::new(int(&n), int(&d));
            let x = if e >= 0 { &x * &two } else { &x / &two };
            check_rounding(&x);
        }
    }

    #[test]
    fn doubles_round_trip(bits in any::<u64>()) {
        let x = f64::from_bits(bits);
        if x.is_finite() {
            let r = Rat::from_f64(x);
            prop_assert_eq!(r.nearest_f64(), Some(x + 0.0));
            prop_assert_eq!(r.interval(), Interval::point(x + 0.0));
            // Exactly between two doubles, and a hair to either side.
            let y = x.next_up();
            if y.is_finite() {
                let m = Rat::midpoint(&r, &Rat::from_f64(y));
                let even = if x.to_bits() & 1 == 0 { x } else { y };
                prop_assert_eq!(m.nearest_f64(), Some(even + 0.0));
                let hair = Rat::frac(1, 2).pow(1400);
                prop_assert_eq!((&m + &hair).nearest_f64(), Some(y + 0.0));
                prop_assert_eq!((&m - &hair).nearest_f64(), Some(x + 0.0));
                check_rounding(&m);
                check_rounding(&(&m + &hair));
            }
        }
    }

    #[test]
    fn intervals_contain(a in wild(), b in wild(), s in 0.0f64..=1.0, t in 0.0f64..=1.0) {
        contain(a, b, s, t);
    }

    #[test]
    fn decimal_literals(sign in "[+-]?", whole in "[0-9]{1,20}", frac in prop::option::of("[0-9]{1,30}"), exp in prop::option::of(-60i64..60)) {
        let mut text = format!("{sign}{whole}");
        if let Some(f) = &frac {
            text += &format!(".{f}");
        }
        if let Some(e) = exp {
            text += &format!("e{e}");
        }
        let digits: BigInt = format!("{whole}{}", frac.clone().unwrap_or_default()).parse().unwrap();
        let power = exp.unwrap_or(0) - frac.map_or(0, |f| f.len() as i64);
        let ten = BigRational::from(BigInt::from(10).pow(power.unsigned_abs() as u32));
        let want = BigRational::from(digits);
        let want = if power >= 0 { want * ten } else { want / ten };
        let want = if sign == "-" { -want } else { want };
        prop_assert!(equal(&literal::parse(&text).unwrap(), &want), "{}", text);
    }

    #[test]
    fn any_text_is_answered(text in "[0-9+./eE-]{0,12}") {
        // Never a panic; what is accepted matches the grammar, written here as a second reader.
        let ok = literal::parse(&text).is_ok();
        prop_assert_eq!(ok, by_hand(&text), "{}", text);
    }
}

/// The grammar once more, by splitting.
fn by_hand(text: &str) -> bool {
    let number = |s: &str| !s.is_empty() && s.bytes().all(|c| c.is_ascii_digit());
    let signed = |s: &str| number(s.strip_prefix(['+', '-']).unwrap_or(s));
    if let Some((n, d)) = text.split_once('/') {
        return signed(n)
            && signed(d)
            && !d.starts_with('-')
            && d.bytes().any(|c| (b'1'..=b'9').contains(&c));
    }
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((m, e)) => (m, Some(e)),
        None => (text, None),
    };
    let mantissa = mantissa.strip_prefix(['+', '-']).unwrap_or(mantissa);
    let mantissa_ok = match mantissa.split_once('.') {
        Some((w, f)) => number(w) && number(f),
        None => number(mantissa),
    };
    mantissa_ok
        && exponent.is_none_or(|e| signed(e) && e.parse::<i64>().is_ok_and(|v| v.abs() <= 100_000))
}

/// The nearest double is nearest: neither neighbour is nearer, ties are even, and the interval is tight.
fn check_rounding(x: &Rat) {
    let i = x.interval();
    let ends_hold = (i.lo == f64::NEG_INFINITY || Rat::from_f64(i.lo) <= *x)
        && (i.hi == f64::INFINITY || *x <= Rat::from_f64(i.hi));
    assert!(
        ends_hold && (i.lo == i.hi || i.lo.next_up() == i.hi),
        "{x}: {i:?}"
    );
    let limit = Rat::from(Int::one().shl(1024) - Int::one().shl(970));
    match x.nearest_f64() {
        None => assert!(x.abs() >= limit),
        Some(d) => {
            assert!(x.abs() < limit && i.contains(d));
            assert!(d != 0.0 || d.is_sign_positive());
            let distance = |y: f64| (Rat::from_f64(y) - x).abs();
            for y in [d.next_up(), d.next_down()]
                .into_iter()
                .filter(|y| y.is_finite())
            {
                match distance(d).cmp(&distance(y)) {
                    std::cmp::Ordering::Less => {}
                    std::cmp::Ordering::Equal => assert!(d.to_bits() & 1 == 0),
                    std::cmp::Ordering::Greater => panic!("{y} is nearer to {x} than {d}"),
                }
            }
        }
    }
}

/// Intervals with ends from all over the range: zeros, subnormals, the largest, infinities, neighbours.
fn wild() -> impl Strategy<Value = Interval> {
    let end = prop_oneof![
        4 => (-4i32..=4).prop_map(f64::from),
        4 => any::<f64>().prop_filter("a number", |x| !x.is_nan()),
        1 => prop::sample::select(vec![0.0, -0.0, f64::MIN_POSITIVE, -f64::MIN_POSITIVE, 5e-324, -5e-324, f64::MAX, f64::MIN, f64::INFINITY, f64::NEG_INFINITY, 1e-200, -1e200, 1.5e154]),
        2 => (-1074i32..1024, any::<bool>()).prop_map(|(e, s)| { let x = 2f64.powi(e.max(-1022)) * 2f64.powi((e + 1022).min(0)); if s { -x } else { x } }),
    ];
    (end.clone(), end, 0u8..3).prop_map(|(a, b, kind)| {
        let (lo, hi) = match kind {
            0 => (a, a.next_up()),
            1 if a.is_finite() => (a, a),
            _ => (a.min(b), a.max(b)),
        };
        // [∞, ∞] holds no number.
        if lo == f64::INFINITY || hi == f64::NEG_INFINITY {
            Interval {
                lo: 1.0,
                hi: f64::INFINITY,
            }
        } else {
            Interval { lo, hi }
        }
    })
}

/// A rational inside, near the ends for s near 0 or 1.
fn inside(x: Interval, s: f64) -> Rat {
    let far = Rat::from(Int::one().shl(1100));
    let lo = if x.lo.is_finite() {
        Rat::from_f64(x.lo)
    } else {
        -&far
    };
    let hi = if x.hi.is_finite() {
        Rat::from_f64(x.hi)
    } else {
        far
    };
    let s = Rat::from_f64(if s < 0.2 {
        0.0
    } else if s > 0.8 {
        1.0
    } else {
        s
    });
    &lo + (&hi - &lo) * s
}
fn holds(i: Interval, r: &Rat) -> bool {
    !i.lo.is_nan()
        && !i.hi.is_nan()
        && (i.lo == f64::NEG_INFINITY || i.lo != f64::INFINITY && Rat::from_f64(i.lo) <= *r)
        && (i.hi == f64::INFINITY || i.hi != f64::NEG_INFINITY && *r <= Rat::from_f64(i.hi))
}
fn contain(a: Interval, b: Interval, s: f64, t: f64) {
    let (x, y) = (inside(a, s), inside(b, t));
    assert!(holds(a + b, &(&x + &y)), "{a:?} + {b:?} = {:?}", a + b);
    assert!(holds(a - b, &(&x - &y)), "{a:?} - {b:?} = {:?}", a - b);
    assert!(holds(a * b, &(&x * &y)), "{a:?} * {b:?} = {:?}", a * b);
    assert!(holds(-a, &-&x));
    assert!(holds(a.square(), &x.square()), "{a:?}² = {:?}", a.square());
    if !y.is_zero() {
        assert!(holds(a / b, &(&x / &y)), "{a:?} / {b:?} = {:?}", a / b);
    } else {
        assert_eq!(a / b, Interval::all());
    }
    if x.sign() >= 0 {
        // √x inside: the squares of the ends lie on the two sides of x.
        let r = a.sqrt();
        assert!(
            r.lo >= 0.0 && Rat::from_f64(r.lo).square() <= x,
            "√{a:?} = {r:?}"
        );
        assert!(
            r.hi == f64::INFINITY || Rat::from_f64(r.hi).square() >= x,
            "√{a:?} = {r:?}"
        );
    }
    if let Some(s) = a.sign() {
        assert_eq!(s, x.sign());
    }
    if a.below(&b) {
        assert!(x < y && !a.meets(&b));
    }
    assert!(holds(a.hull(&b), &x) && holds(a.hull(&b), &y));
    if a.width().is_finite() {
        assert!(Rat::from_f64(a.width()) >= Rat::from_f64(a.hi) - Rat::from_f64(a.lo));
    }
}

/// Hand cases in the spirit of the ITF1788 vectors: operands, operation, and an interval that the
/// result must hold and not exceed by more than two units in the last place at an end.
#[test]
fn interval_vectors() {
    const INF: f64 = f64::INFINITY;
    const MAX: f64 = f64::MAX;
    const TINY: f64 = 5e-324;
    let i = |lo, hi| Interval { lo, hi };
    let close = |got: Interval, lo: f64, hi: f64| {
        let down = |x: f64| x.next_down().next_down();
        let up = |x: f64| x.next_up().next_up();
        assert!(
            got.lo <= lo && got.lo >= down(lo) && got.hi >= hi && got.hi <= up(hi),
            "{got:?} for [{lo}, {hi}]"
        );
    };
    // Sums are exact where the exact sum is a double.
    assert_eq!(i(1.0, 2.0) + i(3.0, 4.0), i(4.0, 6.0));
    assert_eq!(i(-INF, 2.0) + i(3.0, 4.0), i(-INF, 6.0));
    assert_eq!(i(-INF, 2.0) + i(3.0, INF), Interval::all());
    assert_eq!(i(MAX, MAX) + i(MAX, MAX), i(MAX, INF));
    assert_eq!(i(-MAX, -MAX) + i(-MAX, -MAX), i(-INF, -MAX));
    assert_eq!(i(1.0, 1.0) + i(TINY, TINY), i(1.0, 1f64.next_up()));
    assert_eq!(i(1.0, 1.0) - i(TINY, TINY), i(1f64.next_down(), 1.0));
    assert_eq!(i(0.1, 0.1) - i(0.1, 0.1), i(0.0, 0.0));
    // Products: all nine sign cases.
    close(i(1.0, 2.0) * i(3.0, 4.0), 3.0, 8.0);
    close(i(1.0, 2.0) * i(-3.0, 4.0), -6.0, 8.0);
    close(i(1.0, 2.0) * i(-4.0, -3.0), -8.0, -3.0);
    close(i(-1.0, 2.0) * i(3.0, 4.0), -4.0, 8.0);
    close(i(-1.0, 2.0) * i(-3.0, 4.0), -6.0, 8.0);
    close(i(-1.0, 2.0) * i(-5.0, 4.0), -10.0, 8.0);
    close(i(-1.0, 2.0) * i(-4.0, -3.0), -8.0, 4.0);
    close(i(-2.0, -1.0) * i(3.0, 4.0), -8.0, -3.0);
    close(i(-2.0, -1.0) * i(-3.0, 4.0), -8.0, 6.0);
    close(i(-2.0, -1.0) * i(-4.0, -3.0), 3.0, 8.0);
    assert_eq!(i(0.0, 0.0) * Interval::all(), i(0.0, 0.0));
    assert_eq!(Interval::all() * i(0.0, 0.0), i(0.0, 0.0));
    close(i(0.0, 1.0) * i(0.0, INF), 0.0, INF);
    close(i(-1.0, 0.0) * i(1.0, INF), -INF, 0.0);
    close(i(1.0, 2.0) * i(1.0, INF), 1.0, INF);
    close(i(TINY, TINY) * i(TINY, TINY), 0.0, TINY);
    close(i(-TINY, -TINY) * i(TINY, TINY), -TINY, 0.0);
    close(i(MAX, MAX) * i(2.0, 2.0), MAX, INF);
    close(i(MAX, MAX) * i(-2.0, -2.0), -INF, -MAX);
    // Quotients.
    close(i(1.0, 2.0) / i(4.0, 8.0), 0.125, 0.5);
    close(i(-1.0, 2.0) / i(4.0, 8.0), -0.25, 0.5);
    close(i(-2.0, -1.0) / i(4.0, 8.0), -0.5, -0.125);
    close(i(1.0, 2.0) / i(-8.0, -4.0), -0.5, -0.125);
    close(i(-1.0, 2.0) / i(-8.0, -4.0), -0.5, 0.25);
    assert_eq!(i(1.0, 2.0) / i(0.0, 1.0), Interval::all());
    assert_eq!(i(1.0, 2.0) / i(-1.0, 1.0), Interval::all());
    assert_eq!(i(0.0, 0.0) / i(0.0, 0.0), Interval::all());
    assert_eq!(i(0.0, 0.0) / i(1.0, INF), i(0.0, 0.0));
    close(i(1.0, INF) / i(1.0, INF), 0.0, INF);
    close(i(-INF, -1.0) / i(1.0, INF), -INF, 0.0);
    close(i(TINY, TINY) / i(MAX, MAX), 0.0, TINY);
    close(i(MAX, MAX) / i(TINY, TINY), MAX, INF);
    // Squares and roots.
    close(i(-3.0, 2.0).square(), 0.0, 9.0);
    close(i(-3.0, -2.0).square(), 4.0, 9.0);
    close(i(-INF, -2.0).square(), 4.0, INF);
    close(i(TINY, TINY).square(), 0.0, TINY);
    assert_eq!(i(4.0, 9.0).sqrt(), i(2.0, 3.0));
    assert_eq!(i(-4.0, 9.0).sqrt(), i(0.0, 3.0));
    assert_eq!(i(-4.0, -1.0).sqrt(), i(0.0, 0.0));
    assert_eq!(i(0.0, INF).sqrt(), i(0.0, INF));
    close(
        i(2.0, 2.0).sqrt(),
        std::f64::consts::SQRT_2,
        std::f64::consts::SQRT_2,
    );
    close(i(TINY, TINY).sqrt(), TINY.sqrt(), TINY.sqrt());
    // Signs.
    assert_eq!(i(0.0, 1.0).sign(), None);
    assert_eq!(i(TINY, 1.0).sign(), Some(1));
    assert_eq!(i(-1.0, -TINY).sign(), Some(-1));
    assert_eq!(i(-0.0, 0.0).sign(), Some(0));
    // What is no interval becomes the whole line.
    assert_eq!(i(INF, INF) - i(INF, INF), Interval::all());
    assert_eq!(i(f64::NAN, 1.0) + i(1.0, 1.0), Interval::all());
    assert_eq!(i(f64::NAN, f64::NAN) * i(1.0, 2.0), Interval::all());
    assert_eq!(i(f64::NAN, f64::NAN).square(), Interval::all());
    assert_eq!(i(f64::NAN, f64::NAN).sqrt(), Interval::all());
}

#[test]
fn extreme_rationals_round() {
    let two = |e: i64| {
        let p = Rat::from(Int::one().shl(e.unsigned_abs()));
        if e < 0 { p.recip() } else { p }
    };
    let hair = two(-1300);
    assert_eq!(two(-1074).nearest_f64(), Some(5e-324));
    assert_eq!(two(-1075).nearest_f64(), Some(0.0));
    assert_eq!((two(-1075) + &hair).nearest_f64(), Some(5e-324));
    assert_eq!((-two(-1075)).nearest_f64().map(f64::to_bits), Some(0));
    assert_eq!((two(-1074) * Rat::frac(3, 2)).nearest_f64(), Some(1e-323));
    assert_eq!(two(-5000).nearest_f64(), Some(0.0));
    assert_eq!(
        two(-5000).interval(),
        Interval {
            lo: 0.0,
            hi: 5e-324
        }
    );
    assert_eq!(two(1023).nearest_f64(), Some(2f64.powi(1023)));
    assert_eq!(two(1024).nearest_f64(), None);
    assert_eq!(
        two(5000).interval(),
        Interval {
            lo: f64::MAX,
            hi: f64::INFINITY
        }
    );
    assert_eq!(
        (-two(5000)).interval(),
        Interval {
            lo: f64::NEG_INFINITY,
            hi: -f64::MAX
        }
    );
    // The border of the range: half a unit beyond the largest double rounds to infinity.
    let border = two(1024) - two(970);
    assert_eq!(border.nearest_f64(), None);
    assert_eq!((&border - &hair).nearest_f64(), Some(f64::MAX));
    assert_eq!((-&border + &hair).nearest_f64(), Some(f64::MIN));
    assert_eq!((-border).nearest_f64(), None);
    check_rounding(&(two(1024) - &hair));
    assert!(std::panic::catch_unwind(|| Rat::from_f64(f64::NAN)).is_err());
    assert!(std::panic::catch_unwind(|| Rat::from_f64(f64::INFINITY)).is_err());
    assert_eq!(Rat::from_f64(-0.0), Rat::zero());
}

#[test]
fn rationals_compare_at_every_size() {
    let big = Int::from(10i64).pow(60);
    let mut list: Vec<Rat> = [(1i64, 3i64), (-1, 3), (0, 1), (1, 2), (2, 1), (-7, 2)]
        .iter()
        .map(|&(n, d)| Rat::frac(n, d))
        .collect();
    list.push(Rat::new(big.clone(), &big * &Int::from(3i64) + Int::one()));
    list.push(Rat::new(big.clone(), &big * &Int::from(3i64) - Int::one()));
    list.push(Rat::from(big.clone()));
    list.push(Rat::from(-big));
    list.push(Rat::frac(i64::MIN, i64::MAX));
    list.push(Rat::frac(i64::MAX, i64::MIN));
    for a in &list {
        for b in &list {
            let want = BigRational::from(a.clone()).cmp(&BigRational::from(b.clone()));
            assert_eq!(a.cmp(b), want, "{a} {b}");
            assert!(equal(
                &(a + b),
                &(BigRational::from(a.clone()) + BigRational::from(b.clone()))
            ));
            assert!(equal(
                &(a * b),
                &(BigRational::from(a.clone()) * BigRational::from(b.clone()))
            ));
        }
    }
}

#[test]
fn literals_of_the_contract() {
    let ok = |text: &str, n: i64, d: i64| {
        assert_eq!(literal::parse(text), Ok(Rat::frac(n, d)), "{text}")
    };
    ok("3", 3, 1);
    ok("+3", 3, 1);
    ok("-0.125", -1, 8);
    ok("0.1", 1, 10);
    ok("22/7", 22, 7);
    ok("-44/14", -22, 7);
    ok("+6/+4", 3, 2);
    ok("0/5", 0, 1);
    ok("-0", 0, 1);
    ok("1e3", 1000, 1);
    ok("1E3", 1000, 1);
    ok("1e+3", 1000, 1);
    ok("2.50e-1", 1, 4);
    ok("1e-3", 1, 1000);
    ok("007", 7, 1);
    ok("1e0000000000000000000002", 100, 1);
    ok("0e-100000", 0, 1);
    ok("000.000e77", 0, 1);
    for bad in [
        "", "+", "-", ".5", "5.", "5.e3", "1e", "1e+", "e5", "0x10", "0b1", "inf", "-inf", "nan",
        "NaN", "1_000", " 1", "1 ", "1 /2", "1/ 2", "1/2/3", "1/", "/2", "1/2e3", "1.5/2", "1/2.5",
        "--1", "+-1", "1.2.3", "1e2.5", "1e5e5", "١", "1\u{a0}", "1\n", "½", "1,5", "1/--2", "#",
        "1e٣", "1f", "1d5", "1p3",
    ] {
        assert_eq!(literal::parse(bad), Err(LiteralError::Malformed), "{bad:?}");
    }
    for bad in ["1/0", "1/-2", "0/0", "1/000", "1/-0"] {
        assert_eq!(
            literal::parse(bad),
            Err(LiteralError::BadDenominator),
            "{bad:?}"
        );
    }
    for bad in [
        "1e100001",
        "1e-100001",
        "0e100001",
        "1e99999999999999999999999",
    ] {
        assert_eq!(
            literal::parse(bad),
            Err(LiteralError::ExponentTooLarge),
            "{bad:?}"
        );
    }
    for e in [
        LiteralError::Malformed,
        LiteralError::BadDenominator,
        LiteralError::TooManyDigits,
        LiteralError::ExponentTooLarge,
    ] {
        assert!(!e.to_string().is_empty());
    }
    assert!("x".parse::<Rat>().is_err());
}

#[test]
fn long_literals_are_quick_or_refused() {
    let start = std::time::Instant::now();
    let x = literal::parse("1e100000").unwrap();
    assert_eq!(x, Rat::from(Int::from(10i64).pow(100_000)));
    assert_eq!(literal::parse("1e-100000").unwrap(), x.recip());
    assert_eq!(
        literal::parse("3.7e-100000").unwrap() * x,
        Rat::frac(37, 10)
    );
    let nines = "9".repeat(MAX_DIGITS);
    assert_eq!(
        literal::parse(&nines).unwrap() + Rat::one(),
        Rat::from(Int::from(10i64).pow(MAX_DIGITS as u32))
    );
    assert_eq!(
        literal::parse(&format!("{nines}0")),
        Err(LiteralError::TooManyDigits)
    );
    assert_eq!(
        literal::parse(&format!("0.{nines}")),
        Err(LiteralError::TooManyDigits)
    );
    assert_eq!(
        literal::parse(&format!("1/{nines}")),
        Err(LiteralError::TooManyDigits)
    );
    assert_eq!(
        literal::parse(&format!("{nines}x")),
        Err(LiteralError::Malformed)
    );
    // A fraction of two long numbers with a long common factor: the slowest literal there is.
    let (a, b) = ("3".repeat(MAX_DIGITS / 2), "9".repeat(MAX_DIGITS / 2));
    assert_eq!(
        literal::parse(&format!("{a}/{b}")).unwrap(),
        Rat::frac(1, 3)
    );
    let (a, b) = (
        "1234567".repeat(MAX_DIGITS / 14),
        "7654321".repeat(MAX_DIGITS / 14),
    );
    assert!(literal::parse(&format!("{a}/{b}")).is_ok());
    let fives = "5".repeat(MAX_DIGITS - 1);
    assert!(literal::parse(&format!("0.{fives}e-100000")).is_ok());
    eprintln!("long literals: {:?}", start.elapsed());
    // Generous: a debug build on a busy machine; a quadratic reader of limbs one by one takes minutes.
    assert!(start.elapsed().as_secs() < 60);
}
