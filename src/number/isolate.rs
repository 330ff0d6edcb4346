//! Real root isolation: from a square-free polynomial to intervals that hold one root each.
//!
//! The idea (Vincent, Collins & Akritas; Lane & Riesenfeld): written in the Bernstein basis of an interval, a
//! polynomial has at most as many roots inside as its coefficients have sign changes, and no or one sign
//! change is exact. So halve the interval (de Casteljau: only additions and shifts on integers) until every
//! piece shows none or one. On a square-free polynomial this ends. Positive and negative roots are
//! searched apart, from zero to a power of two above all roots.

use super::{Int, Poly, Rat, float};

/// One real root.
pub(crate) enum Isolated {
    /// A dyadic root met while halving, or zero.
    Exact(Rat),
    /// The only root in the open interval (lo/2^e, hi/2^e), no root at its ends.
    Open {
        /// lower end
        lo: Int,
        /// upper end
        hi: Int,
        /// exponent
        e: u64,
    },
}

impl Isolated {
    /// The root of the polynomial in −x.
    pub(crate) fn mirror(&mut self) {
        match self {
            Isolated::Exact(v) => *v = -&*v,
            Isolated::Open { lo, hi, .. } => {
                let t = -&*lo;
                *lo = -&*hi;
                *hi = t;
            }
        }
    }
}

/// A power of two 2^k, strictly above the size of every complex root (Fujiwara's bound).
pub(crate) fn root_bound(c: &[Int]) -> i64 {
    let n = c.len() - 1;
    let lead = c[n].bits() as i64;
    let most = (1..=n)
        .filter(|&i| !c[n - i].is_zero())
        // |c_{n−i}/c_n| < 2^d
        .map(|i| {
            let d = c[n - i].bits() as i64 - lead + 1;
            d.div_euclid(i as i64) + (d.rem_euclid(i as i64) != 0) as i64
        })
        .max();
    most.unwrap_or(0) + 1
}

/// lcm of the binomials C(n, j) times C(i, j)/C(n, j), as integers.
fn bernstein(c: &[Int]) -> Vec<Int> {
    let n = c.len() - 1;
    let mut row = vec![Int::one()];
    for j in 0..n {
        // C(n, j+1) = C(n, j)·(n − j)/(j + 1)
        let next = (&row[j] * Int::from((n - j) as i64)).div_exact(&Int::from(j as i64 + 1));
        row.push(next);
    }
    let lcm = row
        .iter()
        .fold(Int::one(), |l, b| &l * b.div_exact(&l.gcd(b)));
    let scaled: Vec<Int> = c
        .iter()
        .zip(&row)
        .map(|(c, b)| c * lcm.div_exact(b))
        .collect();
    // b_i = Σ_j C(i, j)·scaled_j: repeated sums, as in Pascal's triangle.
    let mut b = scaled;
    for i in 1..=n {
        for j in (i..=n).rev() {
            let s = &b[j] + &b[j - 1];
            b[j] = s;
        }
    }
    b
}

/// Sign changes, zeros skipped; counting stops at two.
fn variations(b: &[Int]) -> usize {
    let (mut last, mut count) = (0, 0);
    for c in b {
        let s = c.sign();
        if s != 0 {
            if last != 0 && s != last {
                count += 1;
                if count == 2 {
                    break;
                }
            }
            last = s;
        }
    }
    count
}

/// The Bernstein coefficients on both halves, common powers of two taken out.
fn halve(b: &[Int]) -> (Vec<Int>, Vec<Int>) {
    let n = b.len() - 1;
    let mut left = Vec::with_capacity(n + 1);
    let mut row = b.to_vec();
    // Level l holds sums of 2^l terms: the true value is row/2^l, and everything is scaled by 2^n.
    for l in 0..=n {
        left.push(row[0].shl((n - l) as u64));
        for j in 0..n - l {
            let s = &row[j] + &row[j + 1];
            row[j] = s;
        }
    }
    // row[j] now holds the entry of level n − j that ends the row: the right half, read from its left end.
    let mut right = row;
    for (j, c) in right.iter_mut().enumerate() {
        *c = c.shl(j as u64);
    }
    strip(&mut left);
    strip(&mut right);
    (left, right)
}

fn strip(b: &mut [Int]) {
    if let Some(z) = b.iter().filter_map(Int::trailing_zeros).min()
        && z > 0
    {
        for c in b {
            *c = c.shr(z);
        }
    }
}

/// The positive roots of a square-free polynomial with non-zero constant term, ascending.
fn positive(c: &[Int], out: &mut Vec<Isolated>) {
    // Descartes' rule on the coefficients themselves.
    if variations(c) == 0 {
        return;
    }
    let n = c.len() - 1;
    let k = root_bound(c);
    // x = 2^k·u with u in (0, 1), scaled to integers.
    let scaled: Vec<Int> = c
        .iter()
        .enumerate()
        .map(|(i, v)| {
            v.shl(if k >= 0 {
                k * i as i64
            } else {
                -k * (n - i) as i64
            } as u64)
        })
        .collect();
    enum Step {
        Piece(Vec<Int>, Int, i64),
        Met(Rat),
    }
    let mut first = bernstein(&scaled);
    strip(&mut first);
    let mut stack = vec![Step::Piece(first, Int::zero(), 0)];
    while let Some(step) = stack.pop() {
        // The piece is [at, at + 1]·2^(k − depth).
        let (b, at, depth) = match step {
            Step::Met(r) => {
                out.push(Isolated::Exact(r));
                continue;
            }
            Step::Piece(b, at, depth) => (b, at, depth),
        };
        match variations(&b) {
            0 => continue,
            1 if b[0].sign() * b[n].sign() != 0 => {
                let e = depth - k;
                let next = &at + Int::one();
                out.push(if e >= 0 {
                    Isolated::Open {
                        lo: at,
                        hi: next,
                        e: e as u64,
                    }
                } else {
                    Isolated::Open {
                        lo: at.shl(e.unsigned_abs()),
                        hi: next.shl(e.unsigned_abs()),
                        e: 0,
                    }
                });
                continue;
            }
            // A root at an end of the piece, already reported: halve on until it is left behind.
            _ => {}
        }
        let (left, right) = halve(&b);
        let middle = at.shl(1) + Int::one();
        let met = right[0]
            .is_zero()
            .then(|| Rat::dyadic(middle.clone(), k - depth - 1));
        stack.push(Step::Piece(right, middle, depth + 1));
        stack.extend(met.map(Step::Met));
        stack.push(Step::Piece(left, at.shl(1), depth + 1));
    }
}

/// The real roots of a square-free polynomial of degree ≥ 1, ascending.
pub(crate) fn isolate(p: &Poly) -> Vec<Isolated> {
    let mut c = p.coeffs();
    let zero = c[0].is_zero();
    if zero {
        c = &c[1..];
    } else if let Some(found) = float::isolate(c) {
        return found;
    }
    exact(p, c, zero)
}

/// The exact search: `c` are the coefficients of `p` without the root zero.
fn exact(p: &Poly, c: &[Int], zero: bool) -> Vec<Isolated> {
    let mut out = Vec::new();
    if c.len() > 1 {
        let mirrored: Vec<Int> = c
            .iter()
            .enumerate()
            .map(|(i, v)| if i % 2 == 1 { -v } else { v.clone() })
            .collect();
        positive(&mirrored, &mut out);
        out.reverse();
        out.iter_mut().for_each(Isolated::mirror);
    }
    if zero {
        out.push(Isolated::Exact(Rat::zero()));
    }
    if c.len() > 1 {
        positive(c, &mut out);
    }
    // Intervals that begin at zero must not have the root zero at an end.
    if zero {
        for r in &mut out {
            if let Isolated::Open { lo, hi, e } = r
                && (lo.is_zero() || hi.is_zero())
            {
                shrink_from_zero(p, lo, hi, e);
            }
        }
    }
    out
}

/// Moves the end at zero towards the root, past the roots at the end.
fn shrink_from_zero(p: &Poly, lo: &mut Int, hi: &mut Int, e: &mut u64) {
    let negative = hi.is_zero();
    let far = if negative { lo.clone() } else { hi.clone() };
    let outer = p.sign_at_dyadic(&far, *e);
    let mut depth = *e;
    let mut cut = far.clone();
    // The root is not zero, so some far/2^i lies on its other side.
    loop {
        depth += 1;
        let s = p.sign_at_dyadic(&cut, depth);
        if s != outer {
            break;
        }
    }
    // The cut may be the root itself: one halving more is then beyond it.
    if p.sign_at_dyadic(&cut, depth) == 0 {
        depth += 1;
    }
    let scale = depth - *e;
    cut = far.clone();
    let far = far.shl(scale);
    *e = depth;
    if negative {
        *lo = far;
        *hi = cut;
    } else {
        *lo = cut;
        *hi = far;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Algebraic;

    /// A reproducible stream of small and large coefficients.
    fn coefficients(seed: &mut u64, n: usize, bits: u32) -> Vec<Int> {
        (0..n)
            .map(|_| {
                *seed = seed
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                let v =
                    Int::from((*seed >> (64 - bits.min(63))) as i64 - (1i64 << (bits.min(63) - 1)));
                v.shl(u64::from(bits.saturating_sub(63)) * (*seed & 1))
            })
            .collect()
    }

    #[test]
    fn doubles_walk_the_same_tree_as_the_exact_search() {
        let (mut seed, mut settled) = (7, 0);
        for round in 0..600usize {
            let (n, bits) = (2 + round % 9, [3, 10, 40, 63, 200, 1100][round % 6]);
            let p = Poly::new(coefficients(&mut seed, n + 1, bits)).squarefree();
            if p.degree().is_none_or(|d| d < 1) || p.coeff(0).is_zero() {
                continue;
            }
            let exact = exact(&p, p.coeffs(), false);
            if let Some(fast) = float::isolate(p.coeffs()) {
                settled += 1;
                let fast = Algebraic::from_isolated(p.clone(), fast);
                assert_eq!(fast, Algebraic::from_isolated(p, exact));
            }
        }
        // Not merely correct: the quick way is the usual one.
        assert!(settled > 400, "{settled}");
    }

    #[test]
    fn the_bound_lies_above_the_roots() {
        for c in [
            [-8i64, 0, 0, 1],
            [-7, 0, 0, 1],
            [-1, 0, 0, 1000],
            [5, -100, 3, 1],
            [0, 0, -1, 1],
        ] {
            let p = Poly::from_i64(&c);
            let bound = Rat::dyadic(Int::one(), root_bound(p.coeffs()));
            for r in p.real_roots() {
                assert!(
                    r.cmp_rat(&bound).is_lt() && r.cmp_rat(&-&bound).is_gt(),
                    "{p}"
                );
            }
        }
    }
}
