//! A number of few bits between two others: samples between break points, where any number will do and a short one is
//! the cheapest to go on with.

use super::super::Int;
use super::super::interval::pow2;
use super::Rat;

impl Rat {
    /// A dyadic rational k/2^j strictly between a < b with the least j ≥ 0, and the k least in size among
    /// those. Linear in the bits of b − a.
    ///
    /// # Panics
    /// Unless a < b.
    pub fn short_between(a: &Rat, b: &Rat) -> Rat {
        assert!(a < b, "no number lies between {a} and {b}");
        if a.sign() < 0 && b.sign() > 0 {
            return Rat::zero();
        }
        // The least j lies near −log2(b − a): start where a grid point cannot be sure to be missed.
        let width = b - a;
        let guess = width.den.bits() as i64 - width.num.bits() as i64 - 2;
        let mut j = guess.max(0) as u64;
        let fits = |j: u64| {
            let k = raw_floor_shifted(a, j) + Int::one();
            (Rat::dyadic(k.clone(), -(j as i64)) < *b).then_some(k)
        };
        // A grid of step < b − a always hits; a coarser one may, by luck: the coarsest is found by
        // ever longer steps down, and by halving the last one (finer grids hold the points of coarser ones).
        while fits(j).is_none() {
            j += 1;
        }
        let (mut misses, mut step) = (None, 1);
        while misses.is_none() && j > 0 {
            let down = j.saturating_sub(step);
            if fits(down).is_some() {
                (j, step) = (down, 2 * step);
            } else {
                misses = Some(down);
            }
        }
        while let Some(m) = misses.filter(|m| j - m > 1) {
            let middle = m.midpoint(j);
            if fits(middle).is_some() {
                j = middle;
            } else {
                misses = Some(middle);
            }
        }
        // `j` only ever moves to a grid that was seen to hit.
        let first = fits(j).expect("the loops above end at a grid that hits");
        // Of the hits on this grid the one nearest zero.
        let last = {
            let c = raw_ceil_shifted(b, j) - Int::one();
            if c < first { first.clone() } else { c }
        };
        let k = if first.sign() > 0 {
            first
        } else if last.sign() < 0 {
            last
        } else {
            Int::zero()
        };
        Rat::dyadic(k, -(j as i64))
    }
    /// [`short_between`](Self::short_between) of two finite doubles, mostly in doubles: scaling by powers of two
    /// is exact.
    ///
    /// # Panics
    /// Unless x < y, both finite.
    pub(crate) fn short_between_doubles(x: f64, y: f64) -> Rat {
        const EXACT: f64 = (1u64 << 52) as f64;
        if x < 0.0 && y > 0.0 {
            return Rat::zero();
        }
        let negative = x < 0.0;
        let (a, b) = if negative { (-y, -x) } else { (x, y) };
        // The step of the grid is at first less than the width, which the difference shows to within a factor of two.
        let width = (b - a).to_bits() >> 52;
        let mut j = (1023 - width as i64 + 2).max(0);
        if !(0.0 <= a && a < b && b < EXACT) || width == 0 || j > 1000 {
            return Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
        }
        // floor(a·2^j) + 1, where doubles hold it and it lies below b·2^j.
        let fits = |j: i64| {
            let s = pow2(j as i32);
            let k = (a * s).floor() + 1.0;
            (k < b * s).then_some(k)
        };
        if b * pow2(j as i32) >= EXACT {
            return Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
        }
        let Some(mut k) = fits(j) else {
            return Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
        };
        while j > 0
            && let Some(coarser) = fits(j - 1)
        {
            (j, k) = (j - 1, coarser);
        }
        let k = if negative { -k } else { k };
        Rat::dyadic(Int::from(k as i64), -j)
    }
}

/// floor(a·2^j).
fn raw_floor_shifted(a: &Rat, j: u64) -> Int {
    match a.den.log2() {
        Some(k) if k <= j => a.num.shl(j - k),
        Some(k) => a.num.shr(k - j),
        None => a.num.shl(j).div_rem_floor(&a.den).0,
    }
}
/// ceil(a·2^j).
fn raw_ceil_shifted(a: &Rat, j: u64) -> Int {
    -raw_floor_shifted(&-a, j)
}

#[cfg(test)]
mod between_tests {
    use super::*;

    #[test]
    fn doubles_find_the_same_short_numbers() {
        let mut seed = 9u64;
        let mut next = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            seed >> 11
        };
        let mut ends = vec![
            0.0, 1.0, 0.5, -0.5, 1e300, 5e-324, -1e-310, 3.0, 4.0, 0.1, 0.25,
        ];
        for i in 0..60 {
            let x = next() as f64 * 2f64.powi(-(next() as i32 % 80));
            ends.extend([x, -x, x.next_up(), x + 2f64.powi(-i), x.round()]);
        }
        for &x in &ends {
            for &y in ends.iter().filter(|y| x < **y) {
                let slow = Rat::short_between(&Rat::from_f64(x), &Rat::from_f64(y));
                assert_eq!(Rat::short_between_doubles(x, y), slow, "{x:?} {y:?}");
            }
        }
    }
}
