//! Real root isolation: from a square-free polynomial to intervals that hold one root each.
//!
//! The idea (Vincent, Collins & Akritas; Lane & Riesenfeld): written in the Bernstein basis of an interval, a
//! polynomial has at most as many roots inside as its coefficients have sign changes, and no or one sign
//! change is exact. So halve the interval (de Casteljau: only additions and shifts on integers) until every
//! piece shows none or one. On a square-free polynomial this ends. Positive and negative roots are
//! searched apart, from zero to a power of two above all roots. Where halving only ever drops one side, a
//! cluster of roots is being zoomed in on, and Newton's step for a root of that multiplicity points at
//! it (Sagraloff 2012): the cell that it names replaces the piece if no sign changes are left outside of it, and the
//! number of bits gained so doubles from jump to jump. Whether a jump is taken costs or saves time, no more.

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

/// Sign changes, zeros skipped.
fn all_variations(b: &[Int]) -> usize {
    let signs = b.iter().map(Int::sign).filter(|&s| s != 0);
    let (mut last, mut count) = (0, 0);
    for s in signs {
        count += usize::from(last * s < 0);
        last = s;
    }
    count
}

/// The Bernstein coefficients on both sides of u = j/d, up to a positive factor each: as de Casteljau's weights
/// leave them, the l-th on the left and the l-th from the end on the right times d^l. Value at u: where they meet.
fn split(b: &[Int], j: &Int, d: &Int) -> (Vec<Int>, Vec<Int>) {
    let n = b.len() - 1;
    let rest = d - j;
    let mut row = b.to_vec();
    let mut left = Vec::with_capacity(n + 1);
    for l in 0..=n {
        left.push(row[0].clone());
        for i in 0..n - l {
            row[i] = &row[i] * &rest + &row[i + 1] * j;
        }
    }
    (left, row)
}

/// The cell j of 2^t equal ones that holds all roots of a piece, as far as sign changes tell: j and the
/// coefficients there. `u` is where the roots are thought to be, in units of the cell.
fn jump(b: &[Int], j: &Int, t: u64) -> Option<Vec<Int>> {
    let n = b.len() - 1;
    let d = Int::one().shl(t);
    let mut cell = b.to_vec();
    if !j.is_zero() {
        let (outside, mut right) = split(b, j, &d);
        if right[0].is_zero() || all_variations(&outside) > 0 {
            return None;
        }
        for (i, c) in right.iter_mut().enumerate() {
            *c = c.shl(t * i as u64);
        }
        cell = right;
    } else {
        for c in &mut cell {
            *c = c.shl(t * n as u64);
        }
    }
    let rest = &d - j;
    if !rest.is_one() {
        let (mut inside, outside) = split(&cell, &Int::one(), &rest);
        if inside[n].is_zero() || all_variations(&outside) > 0 {
            return None;
        }
        // Substitution of (j + u)/2^t leaves integers, so the powers of the divisor go out again.
        let mut power = Int::one();
        for c in &mut inside {
            *c = c.div_exact(&power);
            power *= &rest;
        }
        cell = inside;
    }
    strip(&mut cell);
    Some(cell)
}

/// Newton's guesses for a root of multiplicity k, from both ends, as cells of 2^t.
fn guesses(b: &[Int], t: u64) -> [Option<Int>; 2] {
    let n = b.len() - 1;
    let k = Int::from(all_variations(b) as i64);
    let most = Int::one().shl(t) - Int::one();
    let from = |value: &Int, next: &Int| {
        // u = −k·f/f' with f' = n·(next − value).
        let slope = (next - value) * Int::from(n as i64);
        if slope.sign() * value.sign() >= 0 {
            return None;
        }
        // More leading bits than the cell's number has would be wasted.
        let cut = slope.bits().saturating_sub(t + 16);
        let (v, s) = (value.shr(cut).abs(), slope.shr(cut).abs());
        let j = (&k * v).shl(t).div_rem_floor(&s).0;
        (j <= most).then_some(j)
    };
    let right = from(&b[n], &b[n - 1]).map(|j| &most - j);
    [from(&b[0], &b[1]), right]
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

/// So many halvings that drop one side come before a jump.
const PATIENCE: u64 = 4;

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
        /// Coefficients, position, depth, and how often in a row one side has been dropped.
        Piece(Vec<Int>, Int, i64, u64),
        Met(Rat),
    }
    let mut first = bernstein(&scaled);
    strip(&mut first);
    let mut stack = vec![Step::Piece(first, Int::zero(), 0, 0)];
    while let Some(step) = stack.pop() {
        // The piece is [at, at + 1]·2^(k − depth).
        let (b, at, depth, mut run) = match step {
            Step::Met(r) => {
                out.push(Isolated::Exact(r));
                continue;
            }
            Step::Piece(b, at, depth, run) => (b, at, depth, run),
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
        if run >= PATIENCE {
            let cells = guesses(&b, run).into_iter().flatten();
            if let Some((j, cell)) = { cells }.find_map(|j| Some((j.clone(), jump(&b, &j, run)?))) {
                stack.push(Step::Piece(
                    cell,
                    at.shl(run) + j,
                    depth + run as i64,
                    2 * run,
                ));
                continue;
            }
            run = 0;
        }
        let (left, right) = halve(&b);
        let dropped = all_variations(&left) == 0 || all_variations(&right) == 0;
        let run = if dropped { run + 1 } else { 0 };
        let middle = at.shl(1) + Int::one();
        let met = right[0]
            .is_zero()
            .then(|| Rat::dyadic(middle.clone(), k - depth - 1));
        stack.push(Step::Piece(right, middle, depth + 1, run));
        stack.extend(met.map(Step::Met));
        stack.push(Step::Piece(left, at.shl(1), depth + 1, run));
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
    fn jumps_find_the_clusters_that_halving_finds() {
        // Products of (x − u)² − 2^-2k and the like: pairs and triples of roots 2^-k apart, at places of a
        // few digits and at dyadic ones, where they straddle a border of every grid.
        let mut seed = 3;
        for round in 0..40usize {
            let k = [20, 90, 300, 1001][round % 4];
            let u = &coefficients(&mut seed, 2, 30)[0].abs() + Int::one();
            let w = [Int::from(3i64), Int::from(8i64), u.clone()][round / 4 % 3].clone();
            // w·x − u
            let line = Poly::new(vec![-&u, w]);
            let tiny = Poly::constant(Int::one()).scale(&Int::from(1 + (round % 3) as i64));
            let mut p = (&line * &line).scale(&Int::one().shl(2 * k)) - tiny;
            if round % 2 == 1 {
                p = &p * (line.scale(&Int::one().shl(k + 7)) - Poly::constant(Int::one()));
            }
            p *= Poly::new(coefficients(&mut seed, 3, 20));
            if p.degree().is_none_or(|d| d < 4) || p.coeff(0).is_zero() {
                continue;
            }
            let p = p.squarefree();
            let found = Algebraic::from_isolated(p.clone(), exact(&p, p.coeffs(), false));
            // Each certified root by root, by signs at rationals between them, and their number by factors.
            let mut want: Vec<Algebraic> = Vec::new();
            for f in p.irreducible_factors() {
                want.extend(f.real_roots());
            }
            want.sort();
            assert_eq!(found, want, "{p}");
            for pair in found.windows(2) {
                let between = Algebraic::between(&pair[0], &pair[1]);
                assert!(p.sign_at(&between) != 0 && pair[0].cmp_rat(&between).is_lt());
            }
        }
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
