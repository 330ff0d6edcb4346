//! What the algorithms may ask about curves and numbers, answered exactly.
//!
//! The idea: every question has a fast answer that carries its proof (two enclosures that do not meet, a
//! value larger than its error bound) and a slow one that is always right (integers, polynomials, real
//! algebraic numbers). The first is tried first and never guesses. Equal things share one name as soon as
//! their equality is known: curves are hash-consed, ends of arcs too, a crossing belongs to its pair
//! of curves, and numbers proven equal are united, so that the second question costs nothing.

use super::approx::{Approx, horner};
use super::frames::{Frame, scaled};
use super::hash::{FastMap, WordHasher};
use super::places::Places;
use crate::geometry::index::Hull;
use crate::number::{Algebraic, Int, Poly, Rat};
use std::hash::{BuildHasher, BuildHasherDefault};

/// A curve t = P(u)/Q(u); equal ids are equal functions.
pub(crate) type CurveId = u32;
/// A real number on the u axis; equal ids are equal numbers, different ids may be.
pub(crate) type NumId = u32;

/// How often each stage settled a question: the ledger of the filters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stats {
    /// Pairs of curves whose crossings were asked for.
    pub pairs: u64,
    /// Those of them that fell through to exact isolation.
    pub pairs_exact: u64,
    /// Comparisons of two numbers whose enclosures met.
    pub numbers_exact: u64,
    /// Comparisons of two curves at a number that enclosures could not settle.
    pub heights_exact: u64,
    /// Comparisons of two curves beside a common point that slopes could not settle.
    pub germs_exact: u64,
}

/// Coefficients P₀ P₁ P₂ Q₀ Q₁ Q₂; small ones make h = P₁Q₂ − P₂Q₁ in machine words.
pub(super) enum Coeffs {
    Small([i64; 6]),
    Big(Box<[Int; 6]>),
}

/// Below this the coefficients of h stay below 2¹²⁷: six products of two.
const SMALL: u64 = 1 << 60;

/// Below this the coefficients of h stay below 2⁶³.
const TINY: u64 = 1 << 29;

/// Coefficients of more bits than this are scaled: h has twice as many, and is multiplied by other numbers too.
const LONG: u64 = 256;

pub(super) struct Curve {
    pub(super) p: [Approx; 3],
    pub(super) q: [Approx; 3],
    pub(super) exact: Coeffs,
    /// Equal for proportional denominators, and only for those.
    pub(super) den: u32,
    /// All coefficients are below `TINY`.
    pub(super) tiny: bool,
    /// `p` and `q` enclose the coefficients times 2^-scale.
    pub(super) scale: u64,
}

/// What a number is.
#[derive(Clone, Copy)]
pub(super) enum Def {
    /// A root of an end's equation: an index of `roots`.
    Root(u32),
    /// The only root of the pair's h in the enclosure.
    Cross(CurveId, CurveId),
    /// Its value is in `exact`.
    Known,
}

pub(super) struct Num {
    pub(super) lo: f64,
    pub(super) hi: f64,
    pub(super) parent: NumId,
    pub(super) def: Def,
}

/// Curves, numbers and what is known about them.
#[derive(Default)]
pub(crate) struct Kernel {
    pub(super) curves: Vec<Curve>,
    curve_ids: FastMap<[i64; 6], CurveId>,
    /// By a hash of the coefficients, or the next free key after it.
    big_curve_ids: FastMap<u64, CurveId>,
    dens: FastMap<[i64; 3], u32>,
    big_dens: FastMap<[Int; 3], u32>,
    pub(super) nums: Vec<Num>,
    /// The k-th real root, from below, of m₀ + m₁u + m₂u², with its last coefficient positive.
    pub(super) roots: Vec<([i64; 3], u8)>,
    pub(super) root_ids: FastMap<([i64; 3], u8), NumId>,
    pub(super) big_root_ids: FastMap<([Int; 3], u8), NumId>,
    /// Values of the few numbers that were asked for exactly.
    pub(super) exact: FastMap<NumId, Algebraic>,
    /// Cells of 2^-FINE of those that had near neighbours; see `make_fine`.
    pub(super) fine: FastMap<NumId, Int>,
    /// Points near clusters of numbers, and the distances of numbers from them; see `frames.rs`.
    pub(super) frames: Vec<Frame>,
    pub(super) frame_near: FastMap<(u64, usize), u32>,
    pub(super) local: FastMap<NumId, (u32, Approx)>,
    pub(super) framed: FastMap<(CurveId, u32), Int>,
    pub(super) beside: FastMap<(CurveId, u32), Option<(Approx, Approx)>>,
    /// Equations of low degree of crossings, where they turned out to have one.
    pub(super) low: FastMap<NumId, [i64; 3]>,
    /// The crossing of a pair that was named last, and for each the one before it: there are many of these.
    pub(super) pairs: FastMap<(CurveId, CurveId), NumId>,
    pub(super) next_cross: Vec<NumId>,
    /// All others, of the few pairs whose crossings were isolated exactly.
    pub(super) complete: FastMap<(CurveId, CurveId), Vec<NumId>>,
    /// Numbers with equations of low degree in which several pairs were seen to meet; see `add_hub`.
    /// With a serial number each; and up to which one a number was held against them.
    pub(super) hubs: Vec<(NumId, u32)>,
    pub(super) hubs_made: u32,
    pub(super) hubs_tried: FastMap<NumId, u32>,
    /// Which curves are known to meet where.
    pub(super) places: Places,
    pub(crate) stats: Stats,
}

/// Why numbers and curves of the input are none.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Defect {
    NoSuchRoot,
    NoDenominator,
}

impl Kernel {
    // ----- curves -----

    /// The curve t = P(u)/Q(u), coefficients constant first. Common factors do not matter.
    pub(crate) fn curve(&mut self, p: &[Int; 3], q: &[Int; 3]) -> Result<CurveId, Defect> {
        if q.iter().all(Int::is_zero) {
            return Err(Defect::NoDenominator);
        }
        if let Some(c) = small_key(p, q) {
            return Ok(self.small_curve(c));
        }
        let key = reduce(p, q);
        if let Some(c) = machine(&key) {
            return Ok(self.small_curve(c));
        }
        let mut hash = BuildHasherDefault::<WordHasher>::default().hash_one(&key);
        while let Some(&id) = self.big_curve_ids.get(&hash) {
            if matches!(&self.curves[id as usize].exact, Coeffs::Big(c) if **c == key) {
                return Ok(id);
            }
            hash = hash.wrapping_add(1);
        }
        // Long ones are scaled, so that products of two stay within the doubles.
        let bits = key.iter().map(Int::bits).max().unwrap_or(0);
        let scale = if bits > LONG { bits } else { 0 };
        let a: [Approx; 6] = std::array::from_fn(|i| {
            if scale == 0 {
                return Approx::from_interval(key[i].interval());
            }
            scaled(&key[i], scale).unwrap_or(Approx {
                v: 0.0,
                e: 2f64.powi(-800),
            })
        });
        let id = self.curves.len() as CurveId;
        let next = (self.dens.len() + self.big_dens.len()) as u32;
        let mut den: [Int; 3] = std::array::from_fn(|i| key[i + 3].clone());
        primitive(&mut den);
        let den = match machine(&den) {
            Some(den) => *self.dens.entry(den).or_insert(next),
            None => *self.big_dens.entry(den).or_insert(next),
        };
        self.curves.push(Curve {
            p: [a[0], a[1], a[2]],
            q: [a[3], a[4], a[5]],
            exact: Coeffs::Big(Box::new(key)),
            den,
            tiny: false,
            scale,
        });
        self.big_curve_ids.insert(hash, id);
        Ok(id)
    }

    fn small_curve(&mut self, c: [i64; 6]) -> CurveId {
        let next = self.curves.len() as CurveId;
        let id = *self.curve_ids.entry(c).or_insert(next);
        if id == next {
            let g = gcd(
                gcd(c[3].unsigned_abs(), c[4].unsigned_abs()),
                c[5].unsigned_abs(),
            ) as i64;
            let next_den = (self.dens.len() + self.big_dens.len()) as u32;
            let den = [c[3] / g, c[4] / g, c[5] / g];
            let den = *self.dens.entry(den).or_insert(next_den);
            let a = c.map(|x| Approx::from_int(i128::from(x)));
            self.curves.push(Curve {
                p: [a[0], a[1], a[2]],
                q: [a[3], a[4], a[5]],
                exact: Coeffs::Small(c),
                den,
                tiny: c.iter().all(|x| x.unsigned_abs() < TINY),
                scale: 0,
            });
        }
        id
    }

    /// P and Q in lowest terms.
    pub(crate) fn polys(&self, c: CurveId) -> (Poly, Poly) {
        match &self.curves[c as usize].exact {
            Coeffs::Small(c) => (Poly::from_i64(&c[..3]), Poly::from_i64(&c[3..])),
            Coeffs::Big(c) => (Poly::new(c[..3].to_vec()), Poly::new(c[3..].to_vec())),
        }
    }

    /// The constant t = v.
    pub(crate) fn constant(&mut self, v: &Rat) -> CurveId {
        let zero = Int::zero;
        self.curve(
            &[v.numer().clone(), zero(), zero()],
            &[v.denom().clone(), zero(), zero()],
        )
        .expect("a rational has a denominator")
    }

    /// P and Q over [a, b] as Bernstein coefficients; None where the denominator may vanish.
    #[inline]
    fn bernstein(&self, c: CurveId, a: f64, b: f64) -> Option<([Approx; 3], [Approx; 3])> {
        let curve = &self.curves[c as usize];
        let (x, w) = (Approx::exact(a), Approx::exact(b) - Approx::exact(a));
        let bernstein = |f: &[Approx; 3]| {
            let (c0, c1, c2) = (horner(f, x), (f[2] * x + f[2] * x + f[1]) * w, f[2] * w * w);
            let b1 = c0 + c1.half();
            [c0, b1, c0 + c1 + c2]
        };
        let (p, q) = (bernstein(&curve.p), bernstein(&curve.q));
        let sign = q[0].sign();
        (matches!(sign, Some(-1 | 1)) && q.iter().all(|x| x.sign() == sign)).then_some((p, q))
    }

    /// An enclosure of t over [a, b], by the convex hull of the rational Bernstein form; the whole
    /// line where the denominator may vanish.
    pub(crate) fn range(&self, c: CurveId, a: f64, b: f64) -> (f64, f64) {
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        let Some((p, q)) = self.bernstein(c, a, b) else {
            return in_parts(a, b, &|a, b| {
                let (p, q) = self.bernstein(c, a, b)?;
                enclose((0..3).map(|i| p[i].over(q[i])))
            })
            .unwrap_or(all);
        };
        enclose((0..3).map(|i| p[i].over(q[i]))).unwrap_or(all)
    }

    /// A hull of the curve over [a, b]: its box, and a strip along its chord, by the same form.
    pub(crate) fn hull(&self, c: CurveId, a: f64, b: f64) -> Hull {
        let Some((p, q)) = self.bernstein(c, a, b) else {
            let (lo, hi) = self.range(c, a, b);
            return Hull::boxed([a, b, lo, hi]);
        };
        let unknown = Hull::boxed([a, b, f64::NEG_INFINITY, f64::INFINITY]);
        let t: [Approx; 3] = std::array::from_fn(|i| p[i].over(q[i]));
        let Some((lo, hi)) = enclose(t.into_iter()) else {
            return unknown;
        };
        let boxed = Hull::boxed([a, b, lo, hi]);
        let slope = (t[2].v - t[0].v) / (b - a);
        if !slope.is_finite() {
            return boxed;
        }
        // (P − s·u·Q)/Q as cubics over cubics, three times their coefficients.
        let s = Approx::exact(slope);
        let (a, b) = (Approx::exact(a), Approx::exact(b));
        let raise =
            |f: &[Approx; 3]| [three(f[0]), f[0] + two(f[1]), two(f[1]) + f[2], three(f[2])];
        let uq = [
            three(a * q[0]),
            two(a * q[1]) + b * q[0],
            a * q[2] + two(b * q[1]),
            three(b * q[2]),
        ];
        let (p, q) = (raise(&p), raise(&q));
        match enclose((0..4).map(|i| (p[i] - s * uq[i]).over(q[i]))) {
            Some((low, high)) => Hull {
                slope,
                low,
                high,
                ..boxed
            },
            None => boxed,
        }
    }

    /// t at a number.
    #[inline]
    pub(crate) fn height(&self, c: CurveId, x: NumId) -> Approx {
        let (curve, u) = (&self.curves[c as usize], self.approx(x));
        horner(&curve.p, u).over(horner(&curve.q, u))
    }

    /// The sign of the denominator at a number (0 at a pole).
    pub(crate) fn denominator_sign(&mut self, c: CurveId, x: NumId) -> i32 {
        if let Some(s) = horner(&self.curves[c as usize].q, self.approx(x)).sign() {
            return s;
        }
        let (_, q) = self.polys(c);
        self.exact(x).sign_of(&q)
    }

    /// Whether the curve has no pole between two numbers, ends included.
    pub(crate) fn bounded(&mut self, c: CurveId, l: NumId, r: NumId) -> bool {
        let (a, b) = (self.nums[l as usize].lo, self.nums[r as usize].hi);
        let [q0, q1, q2] = self.curves[c as usize].q;
        if (q1 * q1 - two(two(q0 * q2))).sign() == Some(-1) || self.range(c, a, b).0.is_finite() {
            return true;
        }
        let (_, q) = self.polys(c);
        if q.degree() == Some(0) {
            return true;
        }
        let (l, r) = (self.exact(l).clone(), self.exact(r).clone());
        q.real_roots().iter().all(|z| *z < l || *z > r)
    }
}

/// An enclosure over [a, b] from those over its eighths, where the whole has none: 1 + u² has none, by its
/// coefficients, over a long range.
#[cold]
pub(super) fn in_parts(
    a: f64,
    b: f64,
    part: &dyn Fn(f64, f64) -> Option<(f64, f64)>,
) -> Option<(f64, f64)> {
    const PARTS: usize = 8;
    if !(b - a).is_finite() {
        return None;
    }
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut from = a;
    for i in 1..=PARTS {
        let to = match i {
            PARTS => b,
            _ => (a + (b - a) * (i as f64 / PARTS as f64)).clamp(from, b),
        };
        let (l, h) = part(from, to)?;
        (lo, hi) = (lo.min(l), hi.max(h));
        from = to;
    }
    Some((lo, hi))
}

/// The least interval around all; None where that is not finite.
#[inline]
fn enclose(t: impl Iterator<Item = Approx>) -> Option<(f64, f64)> {
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for t in t {
        if !(t.e.is_finite() && t.v.is_finite()) {
            return None;
        }
        (lo, hi) = (lo.min(t.lo()), hi.max(t.hi()));
    }
    Some((lo, hi))
}

#[inline]
pub(super) fn two(x: Approx) -> Approx {
    Approx {
        v: x.v * 2.0,
        e: x.e * 2.0,
    }
}

#[inline]
fn three(x: Approx) -> Approx {
    x * Approx::exact(3.0)
}

/// Coefficients as machine words below `SMALL`.
fn machine<const N: usize>(c: &[Int; N]) -> Option<[i64; N]> {
    let mut out = [0; N];
    for (o, x) in out.iter_mut().zip(c) {
        *o = x.to_i64().filter(|x| x.unsigned_abs() < SMALL)?;
    }
    Some(out)
}

/// The normal form of a small curve whose P and Q have no common root, as a first look shows.
fn small_key(p: &[Int; 3], q: &[Int; 3]) -> Option<[i64; 6]> {
    let mut c = [0i64; 6];
    let mut g = 0u64;
    for (o, x) in c.iter_mut().zip(p.iter().chain(q)) {
        *o = x.to_i64().filter(|x| x.unsigned_abs() < 1 << 62)?;
        g = gcd(g, o.unsigned_abs());
    }
    let lead = c[3..].iter().rev().find(|&&x| x != 0)?;
    let g = if *lead < 0 { -(g as i64) } else { g as i64 };
    for x in &mut c {
        *x /= g;
    }
    if c.iter().any(|x| x.unsigned_abs() >= SMALL) {
        return None;
    }
    // The resultant of two quadratics, or of what they degenerate to, modulo 2¹²⁸: not zero if that is not.
    let minor = |i: usize, j: usize| {
        i128::from(c[i]) * i128::from(c[3 + j]) - i128::from(c[j]) * i128::from(c[3 + i])
    };
    let times = |a: i128, b: i128| a.wrapping_mul(b);
    let res = times(minor(2, 0), minor(2, 0)).wrapping_sub(times(minor(2, 1), minor(1, 0)));
    let plain = c[1] == 0 && c[2] == 0 && c[0] != 0 || c[4] == 0 && c[5] == 0;
    (plain || res != 0).then_some(c)
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// A prime just below 2⁶⁴.
const PRIME: u64 = 0xffff_ffff_ffff_ffc5;

/// x modulo the prime, for which 2⁶⁴ is 59.
fn fold(x: u128) -> u64 {
    const OVER: u128 = 59;
    let x = u128::from(x as u64) + (x >> 64) * OVER;
    let x = u128::from(x as u64) + (x >> 64) * OVER;
    // Now below 2⁶⁴ + 60².
    let prime = u128::from(PRIME);
    (if x < prime { x } else { x - prime }) as u64
}

/// An integer modulo the prime.
fn residue(x: &Int) -> u64 {
    let (mut sum, mut power) = (0u64, 1u64);
    x.for_each_word(|w| {
        sum = fold(u128::from(w) * u128::from(power) + u128::from(sum));
        power = fold(u128::from(power) << 64);
    });
    if x.sign() < 0 && sum != 0 {
        PRIME - sum
    } else {
        sum
    }
}

/// Whether the resultant of two quadratics (or what they degenerate to) is not zero modulo a prime.
fn surely_coprime(p: &[Int; 3], q: &[Int; 3]) -> bool {
    let constant = |f: &[Int; 3]| f[1].is_zero() && f[2].is_zero() && !f[0].is_zero();
    if constant(p) || constant(q) {
        return true;
    }
    let (p, q) = (
        [0, 1, 2].map(|i| residue(&p[i])),
        [0, 1, 2].map(|i| residue(&q[i])),
    );
    let times = |a: u64, b: u64| fold(u128::from(a) * u128::from(b));
    let minus = |a: u64, b: u64| fold(u128::from(a) + u128::from(PRIME - b));
    let minor = |i: usize, j: usize| minus(times(p[i], q[j]), times(p[j], q[i]));
    minus(
        times(minor(2, 0), minor(2, 0)),
        times(minor(2, 1), minor(1, 0)),
    ) != 0
}

/// P/Q in lowest terms, without content, the last coefficient of Q positive.
fn reduce(p: &[Int; 3], q: &[Int; 3]) -> [Int; 6] {
    let coefficient =
        |p: &Poly, q: &Poly, i: usize| if i < 3 { p.coeff(i) } else { q.coeff(i - 3) };
    let mut c: [Int; 6] = if surely_coprime(p, q) {
        std::array::from_fn(|i| {
            if i < 3 {
                p[i].clone()
            } else {
                q[i - 3].clone()
            }
        })
    } else {
        let (p, q) = lowest_terms(Poly::new(p.to_vec()), Poly::new(q.to_vec()));
        std::array::from_fn(|i| coefficient(&p, &q, i))
    };
    primitive(&mut c);
    c
}

/// P/Q without their common factor.
fn lowest_terms(p: Poly, q: Poly) -> (Poly, Poly) {
    if p.is_zero() {
        return (p, Poly::constant(Int::one()));
    }
    let g = p.gcd(&q);
    if g.degree() != Some(0)
        && let (Some(a), Some(b)) = (p.div_exact(&g), q.div_exact(&g))
    {
        // Quotients come up to a factor; the leading coefficients give it back.
        let ratio =
            |f: &Poly, r: &Poly| Some(Rat::new(f.leading()?.clone(), r.leading()? * g.leading()?));
        if let (Some(s), Some(t)) = (ratio(&p, &a), ratio(&q, &b)) {
            let all = s / t;
            return (a.scale(all.numer()), b.scale(all.denom()));
        }
    }
    (p, q)
}

/// Divides by the common divisor, and makes the last one of them that is not zero positive.
fn primitive<const N: usize>(c: &mut [Int; N]) {
    // Numbers scaled by a power of two are short without it.
    let zeros: [u64; N] = std::array::from_fn(|i| c[i].trailing_zeros().unwrap_or(0));
    let without;
    let (odd, two) = if zeros.iter().any(|&z| z >= 64) {
        without = std::array::from_fn(|i| c[i].shr(zeros[i]));
        let given = zeros.iter().zip(c.iter()).filter(|p| !p.1.is_zero());
        (&without, given.map(|p| *p.0).min().unwrap_or(0))
    } else {
        (&*c, 0)
    };
    // The shortest first: mostly two of them have no common divisor. Equal ones are one.
    let mut order: [usize; N] = std::array::from_fn(|i| i);
    order.sort_unstable_by_key(|&i| odd[i].bits());
    let mut content = Int::zero();
    let mut last = None;
    for i in order {
        if last.is_some_and(|j: usize| odd[j] == odd[i]) {
            continue;
        }
        last = Some(i);
        content = content.gcd(&odd[i]);
        if content.is_one() {
            break;
        }
    }
    let mut content = content.shl(two);
    if content.is_zero() {
        return;
    }
    let negative = c
        .iter()
        .rev()
        .find(|c| !c.is_zero())
        .is_some_and(|c| c.sign() < 0);
    if negative {
        content = -content;
    }
    if !content.is_one() {
        for c in c {
            *c = c.div_exact(&content);
        }
    }
}
