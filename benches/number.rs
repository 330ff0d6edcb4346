//! What the number layer costs, in microseconds: `cargo bench --bench number`.
//!
//! No harness: each line is the least of several batches, which on a shared machine says more than a mean.
#![allow(clippy::unwrap_used)]
use num_rational::BigRational;
use snapfit::number::{Algebraic, Int, Poly, Rat};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Microseconds a call: the quickest of several batches.
fn time<T>(mut f: impl FnMut() -> T) -> f64 {
    let start = Instant::now();
    let mut calls = 0u32;
    while start.elapsed() < Duration::from_millis(5) {
        black_box(f());
        calls += 1;
    }
    let mut best = f64::INFINITY;
    for _ in 0..25 {
        let start = Instant::now();
        for _ in 0..calls {
            black_box(f());
        }
        best = best.min(start.elapsed().as_secs_f64() * 1e6 / f64::from(calls));
    }
    best
}
fn line<T>(name: &str, f: impl FnMut() -> T) {
    println!("{name:<58} {:>10.3} µs", time(f));
}

/// Like `line`, where every call needs numbers of its own: that two are equal is proven once.
fn first<T>(name: &str, mut make: impl FnMut() -> T, mut f: impl FnMut(&T)) {
    let mut best = f64::INFINITY;
    for _ in 0..40 {
        let fresh: Vec<T> = (0..200).map(|_| make()).collect();
        let start = Instant::now();
        fresh.iter().for_each(&mut f);
        best = best.min(start.elapsed().as_secs_f64() * 1e6 / 200.0);
    }
    println!("{name:<58} {best:>10.3} µs");
}

/// A reproducible stream of numbers (SplitMix64).
struct Stream(u64);
impl Stream {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    fn int(&mut self, bits: u64) -> Int {
        let mut v = Int::zero();
        for _ in 0..bits.div_ceil(62) {
            v = v.shl(62) + Int::from((self.next() >> 2) as i64);
        }
        let v = v.shr(v.bits().saturating_sub(bits));
        if self.next() & 1 == 0 { v } else { -v }
    }
    fn poly(&mut self, degree: usize, bits: u64) -> Poly {
        Poly::new((0..=degree).map(|_| self.int(bits)).collect())
    }
    /// A quartic with four real roots: a product of two quadratics with real roots.
    fn split_quartic(&mut self, bits: u64) -> Poly {
        let mut half = || {
            let (a, b, c) = (self.int(bits / 2), self.int(bits / 2), self.int(bits / 2));
            Poly::new(vec![-c.abs(), b, a.abs() + Int::one()])
        };
        half() * half()
    }
}

/// Calls on a list of inputs in turn.
fn each<T, R>(list: &[T], mut f: impl FnMut(&T) -> R) -> impl FnMut() -> R {
    let mut i = 0;
    move || {
        i = (i + 1) % list.len();
        f(&list[i])
    }
}

/// Roots of x² − 2 and 2^k·x² − 2^(k+1) − 1.
fn near(bits: u64) -> (Poly, Poly) {
    let n = Int::one().shl(bits);
    let two_n = &n + &n;
    (
        Poly::from_i64(&[-2, 0, 1]),
        Poly::new(vec![-two_n - Int::one(), Int::zero(), n]),
    )
}

fn main() {
    let mut s = Stream(1);
    let small: Vec<Poly> = (0..64)
        .map(|_| {
            Poly::from_i64(&[
                -(1 + (s.next() % 1000) as i64),
                (s.next() % 2000) as i64 - 1000,
                1 + (s.next() % 1000) as i64,
            ])
        })
        .collect();
    let wide: Vec<Poly> = (0..64)
        .map(|_| Poly::new(vec![-s.int(40).abs(), s.int(40), s.int(40).abs()]))
        .collect();
    let hundred: Vec<Poly> = (0..64)
        .map(|_| Poly::new(vec![-s.int(100).abs(), s.int(100), s.int(100).abs()]))
        .collect();
    line(
        "quadratic: isolate, 10-bit coefficients",
        each(&small, Poly::real_roots),
    );
    line(
        "quadratic: isolate, 40-bit coefficients",
        each(&wide, Poly::real_roots),
    );
    line(
        "quadratic: isolate, 100-bit coefficients",
        each(&hundred, Poly::real_roots),
    );
    line("quadratic: rational roots", || {
        Poly::from_i64(&[-6, 1, 1]).real_roots()
    });
    for bits in [30, 100, 300, 1000] {
        let any: Vec<Poly> = (0..64).map(|_| s.poly(4, bits)).collect();
        let split: Vec<Poly> = (0..64).map(|_| s.split_quartic(bits)).collect();
        let enclose = |p: &Poly| p.real_roots().iter().map(|r| r.interval().lo).sum::<f64>();
        line(
            &format!("quartic {bits} bits: isolate"),
            each(&any, Poly::real_roots),
        );
        line(
            &format!("quartic {bits} bits: isolate, doubles"),
            each(&any, enclose),
        );
        line(
            &format!("quartic {bits} bits, four real roots: isolate"),
            each(&split, Poly::real_roots),
        );
        line(
            &format!("quartic {bits} bits, four real roots: isolate, doubles"),
            each(&split, enclose),
        );
    }
    let octics: Vec<Poly> = (0..16)
        .map(|_| s.split_quartic(60) * s.split_quartic(60))
        .collect();
    line(
        "octic 60 bits, eight real roots: isolate",
        each(&octics, Poly::real_roots),
    );

    for bits in [50, 200, 1000] {
        let (p, q) = near(bits);
        let (a, b) = (p.real_roots().remove(1), q.real_roots().remove(1));
        black_box((a.interval(), b.interval()));
        line(&format!("compare √2 with a root 2^-{bits} away"), || {
            a.cmp(&b)
        });
        let fresh = || {
            let (a, b) = (p.real_roots().remove(1), q.real_roots().remove(1));
            black_box((a.interval(), b.interval()));
            (a, b)
        };
        first(
            &format!("the same, first time, 2^-{bits} away"),
            fresh,
            |(a, b)| {
                black_box(a.cmp(b));
            },
        );
    }
    let far = (
        Poly::from_i64(&[-2, 0, 1]).real_roots().remove(1),
        Poly::from_i64(&[-3, 0, 1]).real_roots().remove(1),
    );
    line("compare √2 with √3", || far.0.cmp(&far.1));
    let equal = |p: &Poly, f: &Poly, g: &Poly| {
        // One root of p within two larger polynomials.
        let find = |f: &Poly| {
            (p * f)
                .real_roots()
                .into_iter()
                .find(|r| r.sign_of(p) == 0)
                .expect("p has a real root")
        };
        let (a, b): (Algebraic, Algebraic) = (find(f), find(g));
        black_box((a.interval(), b.interval()));
        (a, b)
    };
    let p = Poly::from_i64(&[-2, 0, 1]);
    let (a, b) = equal(
        &p,
        &Poly::from_i64(&[5, 1, 3]),
        &Poly::from_i64(&[7, -2, 4]),
    );
    line("compare equal, small quartics", || a.cmp(&b));
    let (f, g) = (Poly::from_i64(&[5, 1, 3]), Poly::from_i64(&[7, -2, 4]));
    first(
        "the same, first time",
        || equal(&p, &f, &g),
        |(a, b)| {
            black_box(a.cmp(b));
        },
    );
    let same = (
        p.real_roots().remove(1),
        p.scale(&Int::from(3i64)).real_roots().remove(1),
    );
    line("compare equal, same small quadratic", || {
        same.0.cmp(&same.1)
    });
    let p = Poly::new(vec![-s.int(150).abs(), s.int(150), s.int(150).abs()]);
    let (f, g) = (s.poly(2, 150), s.poly(2, 150));
    let (a, b) = equal(&p, &f, &g);
    line("compare equal, 300-bit quartics", || a.cmp(&b));
    first(
        "the same, first time",
        || equal(&p, &f, &g),
        |(a, b)| {
            black_box(a.cmp(b));
        },
    );
    line("sign of a 150-bit quadratic that vanishes", || {
        a.sign_of(&p)
    });
    line("sign of a 150-bit quadratic that does not", || {
        a.sign_of(&f)
    });

    let sqrt2 = Poly::from_i64(&[-2, 0, 1]).real_roots().remove(1);
    line("ratio (x+1)/(x−1) at √2", || {
        sqrt2.ratio(&Poly::from_i64(&[1, 1]), &Poly::from_i64(&[-1, 1]))
    });
    let quartic = s.split_quartic(60).real_roots().remove(3);
    let (f, g) = (s.poly(2, 30), s.poly(2, 30));
    line(
        "ratio of 30-bit quadratics at a 60-bit quartic's root",
        || quartic.ratio(&f, &g),
    );
    let dense = s.poly(8, 60);
    line("irreducible factors of a random octic", || {
        dense.irreducible_factors()
    });
    let split = s.poly(4, 30) * s.poly(4, 30);
    line("irreducible factors of a product of quartics", || {
        split.irreducible_factors()
    });
    let q = quartic.ratio(&f, &g);
    let r = quartic.ratio(&f, &g);
    line("the same, its polynomial made", || {
        let q = quartic.ratio(&f, &g);
        q.defining_polynomial()
    });
    line("two such quotients compared for equality", || q == r);
    let (p, t) = (Poly::from_i64(&[3, -20, 7]), Poly::from_i64(&[-11, 5, 2]));
    let (lo, hi) = (Rat::frac(15, 8), Rat::frac(33, 16));
    line("root of p + √2·q, located in [15/8, 33/16]", || {
        sqrt2.root_over(&p, &t, &mut |_| (lo.clone(), hi.clone()))
    });
    line("nearest double of √2", || sqrt2.nearest_f64());

    for bits in [15, 30, 60, 200, 1000] {
        let r: Vec<(Rat, Rat)> = (0..256)
            .map(|_| {
                let mut r = || Rat::new(s.int(bits), s.int(bits).abs() + Int::one());
                (r(), r())
            })
            .collect();
        line(
            &format!("Rat add, {bits} bits over {bits} bits"),
            each(&r, |(a, b)| a + b),
        );
        let theirs: Vec<(BigRational, BigRational)> = r
            .iter()
            .cloned()
            .map(|(a, b)| (a.into(), b.into()))
            .collect();
        line(
            &format!("num-rational add, {bits} bits over {bits} bits"),
            each(&theirs, |(a, b)| a + b),
        );
        line(
            &format!("Rat multiply, {bits} bits over {bits} bits"),
            each(&r, |(a, b)| a * b),
        );
        line(
            &format!("Rat compare, {bits} bits over {bits} bits"),
            each(&r, |(a, b)| a.cmp(b)),
        );
        line(
            &format!("Rat to double enclosure, {bits} bits"),
            each(&r, |(a, _)| a.interval()),
        );
        let v: Vec<(Int, Int)> = (0..256).map(|_| (s.int(bits), s.int(bits))).collect();
        line(
            &format!("Int multiply, {bits} bits"),
            each(&v, |(a, b)| a * b),
        );
        line(&format!("Int add, {bits} bits"), each(&v, |(a, b)| a + b));
        line(
            &format!("Int gcd, {bits} bits"),
            each(&v, |(a, b)| a.gcd(b)),
        );
    }
}
