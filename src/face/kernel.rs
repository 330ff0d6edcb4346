//! What the algorithms may ask about curves and numbers, answered exactly.
//!
//! The idea: every question has a fast answer that carries its proof (two enclosures that do not meet, a
//! value larger than its error bound) and a slow one that is always right (integers, polynomials, real
//! algebraic numbers). The first is tried first and never guesses. Equal things share one name as soon as
//! their equality is known: curves are hash-consed, ends of arcs too, a crossing belongs to its pair
//! of curves, and numbers proven equal are united, so that the second question costs nothing.

use super::approx::{Approx, horner};
use super::hash::FastMap;
use crate::number::{Algebraic, Int, Poly, Rat};
use std::cmp::Ordering;

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

/// Coefficients P₀ P₁ P₂ Q₀ Q₁ Q₂; small ones make h = P₁Q₂ − P₂Q₁ exact in doubles.
enum Coeffs {
    Small([i64; 6]),
    Big(Box<[Int; 6]>),
}

/// Below this the coefficients of h stay below 2⁵³: six products of two.
const SMALL: u64 = 1 << 25;

struct Curve {
    p: [Approx; 3],
    q: [Approx; 3],
    exact: Coeffs,
}

enum Def {
    /// The k-th real root, from below, of m₀ + m₁u + m₂u², with its last coefficient positive.
    Root([i64; 3], u8),
    /// The only root of the pair's h in the enclosure.
    Cross(CurveId, CurveId),
    /// `exact` is there.
    Known,
}

struct Num {
    lo: f64,
    hi: f64,
    parent: NumId,
    def: Def,
    exact: Option<Box<Algebraic>>,
    /// floor(x·2^FINE)
    fine: Option<Box<Int>>,
}

/// Bits after the point of the cached cells that tell very near numbers apart.
const FINE: u32 = 320;

#[derive(Default)]
struct PairRoots {
    ids: Vec<NumId>,
    complete: bool,
}

/// Curves, numbers and what is known about them.
#[derive(Default)]
pub(crate) struct Kernel {
    curves: Vec<Curve>,
    curve_ids: FastMap<[i64; 6], CurveId>,
    big_curve_ids: FastMap<[Int; 6], CurveId>,
    nums: Vec<Num>,
    root_ids: FastMap<([i64; 3], u8), NumId>,
    big_root_ids: FastMap<([Int; 3], u8), NumId>,
    pairs: FastMap<(CurveId, CurveId), PairRoots>,
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
        let (p, q) = reduce(&Poly::new(p.to_vec()), &Poly::new(q.to_vec()));
        let key: [Int; 6] =
            std::array::from_fn(|i| if i < 3 { p.coeff(i) } else { q.coeff(i - 3) });
        if let Some(c) = machine(&key) {
            return Ok(self.small_curve(c));
        }
        if let Some(&id) = self.big_curve_ids.get(&key) {
            return Ok(id);
        }
        let a: [Approx; 6] = std::array::from_fn(|i| Approx::from_interval(key[i].interval()));
        let id = self.curves.len() as CurveId;
        let exact = Coeffs::Big(Box::new(key.clone()));
        self.curves.push(Curve {
            p: [a[0], a[1], a[2]],
            q: [a[3], a[4], a[5]],
            exact,
        });
        self.big_curve_ids.insert(key, id);
        Ok(id)
    }

    fn small_curve(&mut self, c: [i64; 6]) -> CurveId {
        let next = self.curves.len() as CurveId;
        let id = *self.curve_ids.entry(c).or_insert(next);
        if id == next {
            let a = c.map(|x| Approx::exact(x as f64));
            self.curves.push(Curve {
                p: [a[0], a[1], a[2]],
                q: [a[3], a[4], a[5]],
                exact: Coeffs::Small(c),
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

    /// An enclosure of t over [a, b], by the convex hull of the rational Bernstein form; the whole
    /// line where the denominator may vanish.
    pub(crate) fn range(&self, c: CurveId, a: f64, b: f64) -> (f64, f64) {
        let curve = &self.curves[c as usize];
        let (x, w) = (Approx::exact(a), Approx::exact(b) - Approx::exact(a));
        let bernstein = |f: &[Approx; 3]| {
            let (c0, c1, c2) = (horner(f, x), (f[2] * x + f[2] * x + f[1]) * w, f[2] * w * w);
            let b1 = c0 + c1.half();
            [c0, b1, c0 + c1 + c2]
        };
        let (p, q) = (bernstein(&curve.p), bernstein(&curve.q));
        let sign = q[0].sign();
        if !matches!(sign, Some(-1 | 1)) || q.iter().any(|x| x.sign() != sign) {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let t: [Approx; 3] = std::array::from_fn(|i| p[i].over(q[i]));
        if !t.iter().all(|t| t.e.is_finite() && t.v.is_finite()) {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let lo = t.iter().fold(f64::INFINITY, |lo, t| lo.min(t.lo()));
        (lo, t.iter().fold(f64::NEG_INFINITY, |hi, t| hi.max(t.hi())))
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
        if self.range(c, a, b).0.is_finite() {
            return true;
        }
        let (_, q) = self.polys(c);
        if q.degree() == Some(0) {
            return true;
        }
        let (l, r) = (self.exact(l).clone(), self.exact(r).clone());
        q.real_roots().iter().all(|z| *z < l || *z > r)
    }

    // ----- numbers -----

    /// The k-th real root, from below, of m₀ + m₁u + m₂u² (a double root is one root, also by k = 1).
    pub(crate) fn root(&mut self, m: &[Int; 3], k: u8) -> Result<NumId, Defect> {
        let key = Poly::new(m.to_vec()).primitive();
        if matches!(key.degree(), None | Some(0)) {
            return Err(Defect::NoSuchRoot);
        }
        let key: [Int; 3] = std::array::from_fn(|i| key.coeff(i));
        let small: [Option<i64>; 3] =
            std::array::from_fn(|i| key[i].to_i64().filter(|c| c.unsigned_abs() < 1 << 53));
        if let [Some(a), Some(b), Some(c)] = small {
            return self.small_root([a, b, c], k);
        }
        if let Some(&id) = self.big_root_ids.get(&(key.clone(), k)) {
            return Ok(id);
        }
        let roots = Poly::new(key.to_vec()).real_roots();
        let double = roots.len() == 1 && !key[2].is_zero() && k == 1;
        let r = roots
            .get(if double { 0 } else { k as usize })
            .ok_or(Defect::NoSuchRoot)?;
        let id = self.known(r.clone());
        self.big_root_ids.insert((key, k), id);
        Ok(id)
    }

    fn small_root(&mut self, m: [i64; 3], mut k: u8) -> Result<NumId, Defect> {
        let x = m.map(|c| Approx::exact(c as f64));
        let root = if m[2] == 0 {
            if k > 0 {
                return Err(Defect::NoSuchRoot);
            }
            (-x[0]).over(x[1])
        } else {
            let d = i128::from(m[1]) * i128::from(m[1]) - 4 * i128::from(m[0]) * i128::from(m[2]);
            if d < 0 || k > 1 {
                return Err(Defect::NoSuchRoot);
            }
            if d == 0 {
                k = 0;
                (-x[1]).over(x[2] + x[2])
            } else {
                let v = d as f64;
                let s = Approx {
                    v,
                    e: v * f64::EPSILON,
                }
                .sqrt();
                // Written so that nothing cancels; s grows the side that x₁ already has.
                let low_first = m[1] >= 0;
                let q = if low_first {
                    -(x[1] + s).half()
                } else {
                    (s - x[1]).half()
                };
                if (k == 0) == low_first {
                    q.over(x[2])
                } else {
                    x[0].over(q)
                }
            }
        };
        if let Some(&id) = self.root_ids.get(&(m, k)) {
            return Ok(id);
        }
        let id = self.add(root.lo(), root.hi(), Def::Root(m, k));
        if !(root.lo().is_finite() && root.hi().is_finite()) {
            let i = self.exact(id).interval();
            (self.nums[id as usize].lo, self.nums[id as usize].hi) = (i.lo, i.hi);
        }
        self.root_ids.insert((m, k), id);
        Ok(id)
    }

    /// A rational number.
    pub(crate) fn rational(&mut self, r: &Rat) -> NumId {
        let m = [-r.numer(), r.denom().clone(), Int::zero()];
        self.root(&m, 0).expect("a linear equation has a root")
    }

    /// A real algebraic number under a name of its own.
    pub(crate) fn known(&mut self, a: Algebraic) -> NumId {
        let i = a.interval();
        let id = self.add(i.lo, i.hi, Def::Known);
        self.nums[id as usize].exact = Some(Box::new(a));
        id
    }

    fn add(&mut self, lo: f64, hi: f64, def: Def) -> NumId {
        let id = self.nums.len() as NumId;
        self.nums.push(Num {
            lo,
            hi,
            parent: id,
            def,
            exact: None,
            fine: None,
        });
        id
    }

    /// An enclosure.
    #[inline]
    pub(crate) fn enclosure(&self, x: NumId) -> (f64, f64) {
        let n = &self.nums[x as usize];
        (n.lo, n.hi)
    }
    #[inline]
    fn approx(&self, x: NumId) -> Approx {
        let n = &self.nums[x as usize];
        Approx::between(n.lo, n.hi)
    }

    /// The name that all numbers proven equal share.
    pub(crate) fn find(&mut self, mut x: NumId) -> NumId {
        while self.nums[x as usize].parent != x {
            let up = self.nums[x as usize].parent;
            let above = self.nums[up as usize].parent;
            self.nums[x as usize].parent = above;
            x = above;
        }
        x
    }

    /// Exact order of two numbers.
    #[inline]
    pub(crate) fn cmp(&mut self, x: NumId, y: NumId) -> Ordering {
        let (a, b) = (&self.nums[x as usize], &self.nums[y as usize]);
        if a.hi < b.lo {
            return Ordering::Less;
        }
        if b.hi < a.lo {
            return Ordering::Greater;
        }
        self.cmp_near(x, y)
    }

    #[cold]
    fn cmp_near(&mut self, x: NumId, y: NumId) -> Ordering {
        let (x, y) = (self.find(x), self.find(y));
        if x == y {
            return Ordering::Equal;
        }
        self.stats.numbers_exact += 1;
        if let (Some(a), Some(b)) = (&self.nums[x as usize].fine, &self.nums[y as usize].fine)
            && a != b
        {
            return a.cmp(b);
        }
        let (a, b) = (self.exact(x).clone(), self.exact(y).clone());
        if a == b {
            self.unite(x, y);
            return Ordering::Equal;
        }
        let order = self.fine(x).clone().cmp(self.fine(y));
        if order.is_eq() { a.cmp(&b) } else { order }
    }

    fn unite(&mut self, x: NumId, y: NumId) {
        let (lo, hi) = {
            let (a, b) = (&self.nums[x as usize], &self.nums[y as usize]);
            (a.lo.max(b.lo), a.hi.min(b.hi))
        };
        for id in [x, y] {
            let n = &mut self.nums[id as usize];
            // A crossing is the one root in its own enclosure; a smaller one holds the same number.
            (n.lo, n.hi) = (lo, hi);
        }
        self.nums[y as usize].parent = x;
    }

    /// floor(x·2^FINE), made once.
    fn fine(&mut self, x: NumId) -> &Int {
        if self.nums[x as usize].fine.is_none() {
            let (lo, _) = self.exact(x).enclosure(FINE + 1);
            let cell = (lo.numer().shl(u64::from(FINE)))
                .div_rem_floor(lo.denom())
                .0;
            self.nums[x as usize].fine = Some(Box::new(cell));
        }
        self.nums[x as usize].fine.as_ref().expect("just made")
    }

    /// Exact order of a number and a double.
    #[inline]
    pub(crate) fn cmp_double(&mut self, x: NumId, p: f64) -> Ordering {
        let n = &self.nums[x as usize];
        if n.hi < p {
            Ordering::Less
        } else if n.lo > p {
            Ordering::Greater
        } else if p.is_finite() {
            self.exact(x).cmp_rat(&Rat::from_f64(p))
        } else if p > 0.0 {
            Ordering::Less
        } else {
            Ordering::Greater
        }
    }

    /// The number itself, made once.
    pub(crate) fn exact(&mut self, x: NumId) -> &Algebraic {
        if self.nums[x as usize].exact.is_none() {
            let n = &self.nums[x as usize];
            let (lo, hi) = (n.lo, n.hi);
            let a = match n.def {
                Def::Root(m, k) => {
                    let roots = Poly::from_i64(&m).real_roots();
                    roots[(k as usize).min(roots.len() - 1)].clone()
                }
                Def::Cross(c, d) => {
                    let mut roots = self.diff_poly(c, d).0.real_roots();
                    roots.retain(|r| {
                        let i = r.interval();
                        i.lo <= hi && lo <= i.hi
                    });
                    if roots.len() > 1 {
                        let (lo, hi) = (Rat::from_f64(lo), Rat::from_f64(hi));
                        roots.retain(|r| r.cmp_rat(&lo).is_ge() && r.cmp_rat(&hi).is_le());
                    }
                    roots.pop().expect("a crossing's enclosure holds a root")
                }
                Def::Known => unreachable!("known numbers carry their value"),
            };
            let i = a.interval();
            let n = &mut self.nums[x as usize];
            (n.lo, n.hi) = (n.lo.max(i.lo), n.hi.min(i.hi));
            n.exact = Some(Box::new(a));
        }
        self.nums[x as usize].exact.as_ref().expect("just made")
    }

    // ----- two curves -----

    /// h and whether the denominators are proportional; then h is P₁q₂ − P₂q₁ with their leading
    /// coefficients, a quadratic. Else it is P₁Q₂ − P₂Q₁.
    fn diff_poly(&self, c: CurveId, d: CurveId) -> (Poly, bool) {
        let ((p, q), (p2, q2)) = (self.polys(c), self.polys(d));
        let n = q.degree().unwrap_or(0);
        if q2.degree() == Some(n) {
            let (l, l2) = (q.coeff(n), q2.coeff(n));
            if (0..n).all(|i| q.coeff(i) * &l2 == q2.coeff(i) * &l) {
                return (p.scale(&l2) - p2.scale(&l), true);
            }
        }
        (&p * &q2 - &p2 * &q, false)
    }

    /// The same with machine integers, where the curves are small.
    fn diff_small(&self, c: CurveId, d: CurveId) -> Option<([i64; 5], bool)> {
        let (Coeffs::Small(a), Coeffs::Small(b)) = (
            &self.curves[c as usize].exact,
            &self.curves[d as usize].exact,
        ) else {
            return None;
        };
        let k = if a[5] != 0 || b[5] != 0 {
            5
        } else if a[4] != 0 || b[4] != 0 {
            4
        } else {
            3
        };
        if a[3] * b[4] == a[4] * b[3] && a[3] * b[5] == a[5] * b[3] && a[4] * b[5] == a[5] * b[4] {
            let h = |i: usize| a[i] * b[k] - b[i] * a[k];
            return Some(([h(0), h(1), h(2), 0, 0], true));
        }
        let mut h = [0; 5];
        for i in 0..3 {
            for j in 0..3 {
                h[i + j] += a[i] * b[j + 3] - b[i] * a[j + 3];
            }
        }
        Some((h, false))
    }

    /// The coefficients of h with certified errors.
    fn diff(&self, c: CurveId, d: CurveId) -> [Approx; 5] {
        match self.diff_small(c, d) {
            Some((h, _)) => h.map(|x| Approx::exact(x as f64)),
            None => {
                let h = self.diff_poly(c, d).0;
                std::array::from_fn(|i| match h.coeffs().get(i) {
                    Some(x) => Approx::from_interval(x.interval()),
                    None => Approx::default(),
                })
            }
        }
    }

    /// Exact order of the values of two curves at a number; neither may have a pole there.
    #[inline]
    pub(crate) fn cmp_at(&mut self, c: CurveId, d: CurveId, x: NumId) -> Ordering {
        if c == d {
            return Ordering::Equal;
        }
        let (a, b) = (self.height(c, x), self.height(d, x));
        let gap = a - b;
        match gap.sign() {
            Some(s) if s != 0 => s.cmp(&0),
            _ => self.cmp_at_near(c, d, x),
        }
    }

    #[cold]
    fn cmp_at_near(&mut self, c: CurveId, d: CurveId, x: NumId) -> Ordering {
        self.stats.heights_exact += 1;
        let root = self.find(x);
        for id in [x, root] {
            if let Def::Cross(a, b) = self.nums[id as usize].def
                && ((a, b) == (c, d) || (a, b) == (d, c))
            {
                return Ordering::Equal;
            }
            if let Def::Root(m, _) = self.nums[id as usize].def
                && let Some((h, _)) = self.diff_small(c, d)
                && vanishes(&h, &m) == Some(true)
            {
                return Ordering::Equal;
            }
        }
        let (h, proportional) = self.diff_poly(c, d);
        let s = self.exact(x).sign_of(&h);
        (s * self.diff_orientation(c, d, x, proportional)).cmp(&0)
    }

    /// The sign that turns h into the difference of the curves.
    fn diff_orientation(&mut self, c: CurveId, d: CurveId, x: NumId, proportional: bool) -> i32 {
        // The last coefficient of every denominator is positive.
        let first = self.denominator_sign(c, x);
        if proportional {
            first
        } else {
            first * self.denominator_sign(d, x)
        }
    }

    /// Exact order just right (or left) of a common point of two curves.
    pub(crate) fn cmp_beside(&mut self, c: CurveId, d: CurveId, x: NumId, right: bool) -> Ordering {
        if c == d {
            return Ordering::Equal;
        }
        let (a, b) = (self.slope(c, x), self.slope(d, x));
        let turn = |o: Ordering| if right { o } else { o.reverse() };
        if let Some(s) = (a - b).sign()
            && s != 0
        {
            return turn(s.cmp(&0));
        }
        self.stats.germs_exact += 1;
        let (mut h, proportional) = self.diff_poly(c, d);
        let orientation = self.diff_orientation(c, d, x, proportional);
        let mut odd = false;
        loop {
            h = h.derivative();
            odd = !odd;
            debug_assert!(!h.is_zero(), "different curves differ beside a point");
            if h.is_zero() {
                return Ordering::Equal;
            }
            let s = self.exact(x).sign_of(&h) * orientation;
            if s != 0 {
                return if odd { turn(s.cmp(&0)) } else { s.cmp(&0) };
            }
        }
    }

    fn slope(&self, c: CurveId, x: NumId) -> Approx {
        let (curve, u) = (&self.curves[c as usize], self.approx(x));
        let (p, q) = (horner(&curve.p, u), horner(&curve.q, u));
        let (dp, dq) = (derivative(&curve.p, u), derivative(&curve.q, u));
        (dp * q - p * dq).over(q * q)
    }

    /// Every root of h in [lo, hi] goes to `out`, those equal to a `known` root perhaps not, and perhaps
    /// roots outside. The known ones must be roots of h.
    pub(crate) fn crossings(
        &mut self,
        c: CurveId,
        d: CurveId,
        range: (f64, f64),
        known: &[NumId],
        out: &mut Vec<NumId>,
    ) {
        self.stats.pairs += 1;
        let (c, d) = (c.min(d), c.max(d));
        let h = self.diff(c, d);
        // Deflation: what remains after dividing by u − e has the other roots.
        let mut g = h;
        let mut n = 4;
        while n > 0 && g[n].sign() == Some(0) {
            n -= 1;
        }
        for &e in known {
            if n == 0 {
                break;
            }
            let x = self.approx(e);
            let mut carry = g[n];
            for k in (0..n).rev() {
                let below = g[k] + x * carry;
                g[k] = carry;
                carry = below;
            }
            g[n] = Approx::default();
            n -= 1;
        }
        // A margin, so that a root at an end of the range lies well inside.
        let (lo, hi) = range;
        let margin = (hi - lo) * 2f64.powi(-24) + (lo.abs() + hi.abs()) * 2f64.powi(-40);
        let mut found = Roots {
            at: [(0.0, 0.0); 4],
            n: 0,
        };
        let settled = isolate(&g[..=n], lo - margin, hi + margin, &mut found);
        if settled && found.n == 0 {
            return;
        }
        let clear = |k: &Kernel, r: (f64, f64)| {
            known.iter().all(|&e| {
                let (a, b) = k.enclosure(e);
                b < r.0 || r.1 < a
            })
        };
        let from = out.len();
        if settled
            && found.at[..found.n].iter().all(|&r| {
                clear(self, r) && self.intern(c, d, &h, r).map(|id| out.push(id)).is_some()
            })
        {
            return;
        }
        out.truncate(from);
        self.all_crossings(c, d, out);
    }

    /// The name of the only root of h in an enclosure; None where it may be confused with another.
    fn intern(&mut self, c: CurveId, d: CurveId, h: &[Approx; 5], r: (f64, f64)) -> Option<NumId> {
        if let Some(pair) = self.pairs.get(&(c, d)) {
            for &id in &pair.ids {
                let n = &self.nums[id as usize];
                if n.hi < r.0 || r.1 < n.lo {
                    continue;
                }
                let around = Approx::between(n.lo.min(r.0), n.hi.max(r.1));
                let steep = [
                    h[1],
                    two(h[2]),
                    h[3] * Approx::exact(3.0),
                    h[4] * Approx::exact(4.0),
                ];
                // Monotone on both: one root.
                return matches!(horner(&steep, around).sign(), Some(-1 | 1)).then_some(id);
            }
            if pair.complete {
                return None;
            }
        }
        let id = self.add(r.0, r.1, Def::Cross(c, d));
        self.pairs.entry((c, d)).or_default().ids.push(id);
        Some(id)
    }

    /// All real roots of h, exactly.
    #[cold]
    fn all_crossings(&mut self, c: CurveId, d: CurveId, out: &mut Vec<NumId>) {
        let pair = self.pairs.entry((c, d)).or_default();
        if !pair.complete {
            pair.complete = true;
            let before = pair.ids.clone();
            self.stats.pairs_exact += 1;
            for r in self.diff_poly(c, d).0.real_roots() {
                let i = r.interval();
                let mut same = None;
                for &id in &before {
                    let (lo, hi) = self.enclosure(id);
                    if i.lo <= hi && lo <= i.hi && *self.exact(id) == r {
                        same = Some(id);
                    }
                }
                if same.is_none() {
                    let id = self.add(i.lo, i.hi, Def::Cross(c, d));
                    self.nums[id as usize].exact = Some(Box::new(r));
                    self.pairs.entry((c, d)).or_default().ids.push(id);
                }
            }
        }
        out.extend(self.pairs.get(&(c, d)).into_iter().flat_map(|p| &p.ids));
    }
}

#[inline]
fn two(x: Approx) -> Approx {
    Approx {
        v: x.v * 2.0,
        e: x.e * 2.0,
    }
}

#[inline]
fn derivative(f: &[Approx; 3], u: Approx) -> Approx {
    two(f[2] * u) + f[1]
}

/// Whether h vanishes at the irrational (or only) roots of m, by pseudo-division; None where it does not
/// fit, or where the remainder does not tell.
fn vanishes(h: &[i64; 5], m: &[i64; 3]) -> Option<bool> {
    let top = if m[2] != 0 { 2 } else { 1 };
    let mut r = h.map(i128::from);
    let lead = i128::from(m[top]);
    for k in (top..5).rev() {
        let c = r[k];
        if c == 0 {
            continue;
        }
        for x in &mut r[..k] {
            *x = x.checked_mul(lead)?;
        }
        for j in 0..top {
            let t = c.checked_mul(i128::from(m[j]))?;
            r[k - top + j] = r[k - top + j].checked_sub(t)?;
        }
        r[k] = 0;
    }
    if r[..top].iter().all(|&x| x == 0) {
        return Some(true);
    }
    None
}

/// The six coefficients as machine words below `SMALL`.
fn machine(c: &[Int; 6]) -> Option<[i64; 6]> {
    let mut out = [0; 6];
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
        *o = x.to_i64().filter(|x| x.unsigned_abs() < 1 << 40)?;
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
    // The resultant of two quadratics, or of what they degenerate to.
    let minor = |i: usize, j: usize| {
        i128::from(c[i]) * i128::from(c[3 + j]) - i128::from(c[j]) * i128::from(c[3 + i])
    };
    let res = minor(2, 0) * minor(2, 0) - minor(2, 1) * minor(1, 0);
    let plain = c[1] == 0 && c[2] == 0 && c[0] != 0 || c[4] == 0 && c[5] == 0;
    (plain || res != 0).then_some(c)
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// P/Q in lowest terms, without content, the last coefficient of Q positive.
fn reduce(p: &Poly, q: &Poly) -> (Poly, Poly) {
    let one = || Poly::constant(Int::one());
    if p.is_zero() {
        return (Poly::zero(), one());
    }
    let g = p.gcd(q);
    let (mut p, mut q) = (p.clone(), q.clone());
    if let (Some(a), Some(b)) = (p.div_exact(&g), q.div_exact(&g))
        && g.degree() != Some(0)
    {
        // Quotients come up to a factor; the leading coefficients give it back.
        let ratio =
            |f: &Poly, r: &Poly| Some(Rat::new(f.leading()?.clone(), r.leading()? * g.leading()?));
        if let (Some(s), Some(t)) = (ratio(&p, &a), ratio(&q, &b)) {
            let all = s / t;
            p = a.scale(all.numer());
            q = b.scale(all.denom());
        }
    }
    let content = p.content().gcd(&q.content());
    let content = if q.leading().is_some_and(|l| l.sign() < 0) {
        -content
    } else {
        content
    };
    let unscale = |f: &Poly| Poly::new(f.coeffs().iter().map(|c| c.div_exact(&content)).collect());
    (unscale(&p), unscale(&q))
}

/// Enclosures of simple roots.
struct Roots {
    at: [(f64, f64); 4],
    n: usize,
}

/// How deep the halving goes before exact arithmetic takes over.
const DEPTH: u32 = 10;

/// Encloses every root of the polynomial in [a, b], each in an interval that holds no other; false where
/// doubles cannot tell. By Bernstein coefficients: no sign change, no root; one, one root.
fn isolate(g: &[Approx], a: f64, b: f64, out: &mut Roots) -> bool {
    let n = g.len() - 1;
    if n == 0 {
        return matches!(g[0].sign(), Some(-1 | 1));
    }
    const BINOMIAL: [[f64; 5]; 5] = [
        [1.0; 5],
        [1.0, 1.0, 0.0, 0.0, 0.0],
        [1.0, 2.0, 1.0, 0.0, 0.0],
        [1.0, 3.0, 3.0, 1.0, 0.0],
        [1.0, 4.0, 6.0, 4.0, 1.0],
    ];
    let mut c = [Approx::default(); 5];
    c[..=n].copy_from_slice(g);
    let (x, w) = (Approx::exact(a), Approx::exact(b) - Approx::exact(a));
    for i in 0..n {
        for j in (i..n).rev() {
            c[j] = c[j] + x * c[j + 1];
        }
    }
    let mut power = w;
    for j in 1..=n {
        c[j] = (c[j] * power).over(Approx::exact(BINOMIAL[n][j]));
        power = power * w;
    }
    for i in 1..=n {
        for j in (i..=n).rev() {
            c[j] = c[j] + c[j - 1];
        }
    }
    settle(
        &Whole {
            g,
            n,
            slack: (a.abs() + b.abs()) * 64.0 * f64::EPSILON,
        },
        &c,
        a,
        b,
        0,
        out,
    )
}

/// What the halving keeps in mind of the whole.
struct Whole<'a> {
    g: &'a [Approx],
    n: usize,
    /// Bounds how far the ends of any part may lie from the true cuts.
    slack: f64,
}

fn settle(whole: &Whole<'_>, c: &[Approx; 5], a: f64, b: f64, depth: u32, out: &mut Roots) -> bool {
    let (g, n) = (whole.g, whole.n);
    // The most sign changes that the unknown signs allow: best with the last sign plus, minus.
    let none = -100;
    let (mut plus, mut minus) = (none, none);
    for (i, x) in c[..=n].iter().enumerate() {
        let s = x.sign();
        let start = if i == 0 { 0 } else { none };
        let (p, m) = (
            plus.max(minus + 1).max(start),
            minus.max(plus + 1).max(start),
        );
        (plus, minus) = match s {
            Some(1) => (p, none),
            Some(-1) => (none, m),
            Some(_) if i > 0 => (plus, minus),
            _ => (p, m),
        };
    }
    let most = plus.max(minus);
    let (first, last) = (c[0].sign(), c[n].sign());
    let (Some(first), Some(last)) = (first, last) else {
        return deeper(whole, c, a, b, depth, out);
    };
    if most == 0 && first != 0 {
        return true;
    }
    if most == 1 && first * last < 0 {
        if out.n == 4 {
            return false;
        }
        return match refine(g, a, b, first) {
            Some(r) => {
                out.at[out.n] = r;
                out.n += 1;
                true
            }
            None => false,
        };
    }
    deeper(whole, c, a, b, depth, out)
}

/// Halves (not quite, since a root in the very middle is likely) and settles both parts.
fn deeper(whole: &Whole<'_>, c: &[Approx; 5], a: f64, b: f64, depth: u32, out: &mut Roots) -> bool {
    let (g, n) = (whole.g, whole.n);
    if depth >= DEPTH || a >= b {
        return false;
    }
    const CUT: f64 = 0.484375;
    let (s, r) = (Approx::exact(CUT), Approx::exact(1.0 - CUT));
    let mid = a + (b - a) * CUT;
    if !(a < mid && mid < b) {
        return false;
    }
    let mut left = [Approx::default(); 5];
    let mut right = *c;
    for (k, first) in left.iter_mut().enumerate().take(n + 1) {
        *first = right[0];
        for j in 0..n - k {
            right[j] = right[j] * r + right[j + 1] * s;
        }
    }
    // `right` holds the last value of each round: reading it back gives the right part.
    // The true cut lies within `slack` of `mid`, and no root lies between the two.
    let near = Approx {
        v: mid,
        e: whole.slack,
    };
    if !matches!(horner(g, near).sign(), Some(-1 | 1)) {
        return false;
    }
    settle(whole, &left, a, mid, depth + 1, out) && settle(whole, &right, mid, b, depth + 1, out)
}

/// Shrinks [a, b], which holds one simple root and has sign `first` at a, to a few ulps.
fn refine(g: &[Approx], a: f64, b: f64, first: i32) -> Option<(f64, f64)> {
    let sign = f64::from(first);
    let (mut l, mut r) = (a, b);
    let mut x = l + (r - l) * 0.5;
    for _ in 0..80 {
        let (mut f, mut d) = (0.0, 0.0);
        for k in g.iter().rev() {
            d = d * x + f;
            f = f * x + k.v;
        }
        if f * sign > 0.0 {
            l = x;
        } else {
            r = x;
        }
        let step = x - f / d;
        let next = if step > l && step < r {
            step
        } else {
            l + (r - l) * 0.5
        };
        let still = (next - x).abs() <= x.abs() * f64::EPSILON;
        x = next;
        if still || l >= r {
            break;
        }
    }
    let unit = (x.abs() * f64::EPSILON).max(f64::MIN_POSITIVE);
    let end = |side: f64, wall: f64, want: i32| {
        let mut step = 2.0 * unit;
        for _ in 0..16 {
            let y = x + side * step;
            if (wall - y) * side <= 0.0 {
                return Some(wall);
            }
            if horner(g, Approx::exact(y)).sign() == Some(want) {
                return Some(y);
            }
            step *= 8.0;
        }
        None
    };
    let lo = end(-1.0, a, first)?;
    let hi = end(1.0, b, -first)?;
    (lo < hi).then_some((lo, hi))
}
