//! Two curves: which is higher at a number or beside it, and where they meet.
//!
//! The idea: all of it is one polynomial, h = P₁Q₂ − P₂Q₁, whose sign (with those of the denominators) is
//! that of the difference of the curves, and whose roots are the crossings. It is known exactly in machine words
//! where the curves are small, with error bounds in doubles otherwise, and exactly in any case.

use super::approx::{Approx, horner};
use super::cluster::Core;
use super::isolate::{Roots, isolate, one_sign};
use super::kernel::{Coeffs, CurveId, Def, Kernel, NumId, two};
use crate::number::filter::{self, Stage};
use crate::number::{Int, Poly};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

impl Kernel {
    /// Whether the denominators are proportional: then h is P₁q₂ − P₂q₁ with their leading coefficients, a
    /// quadratic; else it is P₁Q₂ − P₂Q₁.
    #[inline]
    pub(super) fn proportional(&self, c: CurveId, d: CurveId) -> bool {
        self.curves[c as usize].den == self.curves[d as usize].den
    }

    /// h.
    pub(super) fn diff_poly(&self, c: CurveId, d: CurveId) -> Poly {
        let ((p, q), (p2, q2)) = (self.polys(c), self.polys(d));
        if self.proportional(c, d) {
            let n = q.degree().unwrap_or(0);
            p.scale(&q2.coeff(n)) - p2.scale(&q.coeff(n))
        } else {
            &p * &q2 - &p2 * &q
        }
    }

    /// h in machine words, where the curves are small.
    #[inline]
    pub(super) fn diff_small(&self, c: CurveId, d: CurveId) -> Option<[i128; 5]> {
        let (a, b) = (&self.curves[c as usize], &self.curves[d as usize]);
        let (Coeffs::Small(x), Coeffs::Small(y)) = (&a.exact, &b.exact) else {
            return None;
        };
        Some(if a.tiny && b.tiny {
            difference::<i64>(x, y, a.den == b.den).map(i128::from)
        } else {
            difference::<i128>(x, y, a.den == b.den)
        })
    }

    /// The coefficients of h with certified errors.
    #[inline]
    pub(super) fn diff(&self, c: CurveId, d: CurveId) -> [Approx; 5] {
        let (a, b) = (&self.curves[c as usize], &self.curves[d as usize]);
        if let (Coeffs::Small(x), Coeffs::Small(y)) = (&a.exact, &b.exact) {
            return if a.tiny && b.tiny {
                difference::<i64>(x, y, a.den == b.den).map(Approx::from_word)
            } else {
                difference::<i128>(x, y, a.den == b.den).map(Approx::from_int)
            };
        }
        let mut h = [Approx::default(); 5];
        if self.proportional(c, d) {
            let k = if a.q[2].v != 0.0 {
                2
            } else {
                usize::from(a.q[1].v != 0.0)
            };
            for (i, h) in h.iter_mut().enumerate().take(3) {
                *h = a.p[i] * b.q[k] - b.p[i] * a.q[k];
            }
            return h;
        }
        for i in 0..3 {
            for j in 0..3 {
                h[i + j] = h[i + j] + (a.p[i] * b.q[j] - b.p[i] * a.q[j]);
            }
        }
        h
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
        let root = self.find(x);
        if self.places.alike(root, c, d) || self.places.alike(x, c, d) {
            filter::settled(Stage::Name);
            return Ordering::Equal;
        }
        let order = self.cmp_at_exactly(c, d, x, root);
        if order.is_eq() {
            self.places.unite(root, c, d);
        }
        order
    }

    fn cmp_at_exactly(&mut self, c: CurveId, d: CurveId, x: NumId, root: NumId) -> Ordering {
        self.stats.heights_exact += 1;
        for id in [x, root] {
            if let Def::Cross(a, b) = self.nums[id as usize].def
                && ((a, b) == (c, d) || (a, b) == (d, c))
            {
                return Ordering::Equal;
            }
            if let Some(m) = self.equation(id)
                && let Some(h) = self.diff_small(c, d)
                && vanishes(&h, &m) == Some(true)
            {
                return Ordering::Equal;
            }
        }
        let h = self.diff_poly(c, d);
        let s = self.exact(x).sign_of(&h);
        (s * self.diff_orientation(c, d, x)).cmp(&0)
    }

    /// The sign that turns h into the difference of the curves.
    fn diff_orientation(&mut self, c: CurveId, d: CurveId, x: NumId) -> i32 {
        // The last coefficient of every denominator is positive.
        let first = self.denominator_sign(c, x);
        if self.proportional(c, d) {
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
        let orientation = self.diff_orientation(c, d, x);
        if let Some((s, odd)) = self.germ_sign(c, d, x) {
            let o = (s * orientation).cmp(&0);
            return if odd { turn(o) } else { o };
        }
        let mut h = self.diff_poly(c, d);
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

    /// The sign of the first derivative of h that does not vanish at its root x, and whether its order is
    /// odd, by integers and doubles; None where these do not tell.
    fn germ_sign(&self, c: CurveId, d: CurveId, x: NumId) -> Option<(i32, bool)> {
        let m = self.equation(x)?;
        let (mut h, u) = (self.diff_small(c, d)?, self.approx(x));
        let mut odd = false;
        loop {
            h = derivative_of(&h)?;
            odd = !odd;
            if h == [0; 5] {
                return None;
            }
            if let Some(s @ (1 | -1)) = horner(&h.map(Approx::from_int), u).sign() {
                return Some((s, odd));
            }
            if vanishes(&h, &m) != Some(true) {
                return None;
            }
        }
    }

    /// The slope of a curve over a number.
    pub(super) fn slope(&self, c: CurveId, x: NumId) -> Approx {
        self.slope_over(c, self.approx(x))
    }

    /// Its slopes over all that a double and its error enclose; nothing is known where there may be a pole.
    pub(super) fn slope_over(&self, c: CurveId, u: Approx) -> Approx {
        let curve = &self.curves[c as usize];
        let (p, q) = (horner(&curve.p, u), horner(&curve.q, u));
        let (dp, dq) = (derivative(&curve.p, u), derivative(&curve.q, u));
        (dp * q - p * dq).over(q * q)
    }

    /// Whether the two surely do not meet over [lo, hi].
    #[inline]
    pub(crate) fn miss(&self, c: CurveId, d: CurveId, lo: f64, hi: f64) -> bool {
        let h = self.diff(c.min(d), c.max(d));
        let n = (0..5).rev().find(|&k| h[k].sign() != Some(0));
        match n {
            None => false,
            Some(0) => matches!(h[0].sign(), Some(-1 | 1)),
            Some(n) => one_sign(&h[..=n], lo, hi),
        }
    }

    /// Whether the two surely meet nowhere over [lo, hi] but at the points over `known`, where h vanishes at least
    /// as often as said.
    pub(crate) fn miss_beside(
        &self,
        c: CurveId,
        d: CurveId,
        lo: f64,
        hi: f64,
        known: &[(NumId, usize)],
    ) -> bool {
        let mut g = self.diff(c.min(d), c.max(d));
        let Some(mut n) = (0..5).rev().find(|&k| g[k].sign() != Some(0)) else {
            return false;
        };
        for &(x, order) in known {
            for _ in 0..order.min(n) {
                deflate(&mut g, &mut n, self.approx(x));
            }
        }
        one_sign(&g[..=n], lo, hi)
    }

    /// How often h vanishes at its root x, as far as doubles and machine words tell: at least once, and
    /// never said to be more than it is. For equal curves more than any other.
    pub(super) fn contact(&self, c: CurveId, d: CurveId, x: NumId) -> usize {
        if c == d {
            return 5;
        }
        if matches!((self.slope(c, x) - self.slope(d, x)).sign(), Some(-1 | 1)) {
            return 1;
        }
        let (Some(m), Some(h)) = (self.equation(x), self.diff_small(c, d)) else {
            return 1;
        };
        further_multiplicity(h, &m)
    }

    /// P₁Q₂ − P₂Q₁, whatever the denominators.
    pub(super) fn full_difference(&self, c: CurveId, d: CurveId) -> [Approx; 5] {
        let (a, b) = (&self.curves[c as usize], &self.curves[d as usize]);
        if let (Coeffs::Small(x), Coeffs::Small(y)) = (&a.exact, &b.exact) {
            return difference::<i128>(x, y, false).map(Approx::from_int);
        }
        let mut h = [Approx::default(); 5];
        for i in 0..3 {
            for j in 0..3 {
                h[i + j] = h[i + j] + (a.p[i] * b.q[j] - b.p[i] * a.q[j]);
            }
        }
        h
    }

    /// (c − d)·Q_d over the product of u − x for the roots x of h, each as often as said: a polynomial over the
    /// denominator of c. With a core also divided by u − x in the middle of it, as if that were a root: what
    /// remains is part of the errors, wherever u is not in the core.
    pub(super) fn blown_up(
        &self,
        c: CurveId,
        d: CurveId,
        at: &[(NumId, usize)],
        core: Option<Core>,
    ) -> ([Approx; 5], [Approx; 5]) {
        let a = &self.curves[c as usize];
        let mut below = [Approx::default(); 5];
        below[..3].copy_from_slice(&a.q);
        if c == d {
            return ([Approx::default(); 5], below);
        }
        // With one denominator for both it is cancelled: what is left of two of degree two is a line, and its hull no
        // more than that.
        let (mut top, mut n) = if self.proportional(c, d) {
            let lead = a.q.iter().rev().find(|q| q.v != 0.0);
            below = [Approx::default(); 5];
            below[0] = lead.copied().unwrap_or_default();
            (self.diff(c, d), 2)
        } else {
            (self.full_difference(c, d), 4)
        };
        for &(x, order) in at {
            for _ in 0..order {
                deflate(&mut top, &mut n, self.approx(x));
            }
        }
        if let Some(core) = core {
            let rest = deflate(&mut top, &mut n, Approx::exact(core.middle));
            top[0].e += (rest.v.abs() + rest.e) / core.half * (1.0 + 1e-9);
        }
        (top, below)
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
            deflate(&mut g, &mut n, self.approx(e));
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
        if let Some(x) = self.touch(c, d) {
            out.push(x);
            return;
        }
        if !self.shared_touch((c, d), &h, (lo - margin, hi + margin), known, out) {
            out.truncate(from);
            self.all_crossings(c, d, out);
        }
    }

    /// The roots of h where the two curves touch in a point in which others were seen to touch; false if they do not,
    /// or the remaining roots are not told apart. Exact isolation is for the first pair that touches there.
    fn shared_touch(
        &mut self,
        (c, d): (CurveId, CurveId),
        h: &[Approx; 5],
        range: (f64, f64),
        known: &[NumId],
        out: &mut Vec<NumId>,
    ) -> bool {
        let Some(exact) = self.diff_small(c, d) else {
            return false;
        };
        let Some((at, order)) = (0..self.hubs.len()).rev().find_map(|i| {
            let order = multiplicity(&exact, &self.equation(self.hubs[i].0)?);
            (order >= 2).then_some((i, order))
        }) else {
            return false;
        };
        let hub = self.hubs.remove(at);
        self.hubs.push(hub);
        let x = hub.0;
        let (mut g, mut n) = (*h, 4);
        while n > 0 && g[n].sign() == Some(0) {
            n -= 1;
        }
        let mut others = Vec::new();
        for &e in known {
            if self.cmp(e, x).is_ne() {
                others.push(e);
            }
        }
        for e in others.iter().copied().chain(std::iter::repeat_n(x, order)) {
            if n > 0 {
                deflate(&mut g, &mut n, self.approx(e));
            }
        }
        others.push(x);
        let mut found = Roots {
            at: [(0.0, 0.0); 4],
            n: 0,
        };
        if !isolate(&g[..=n], range.0, range.1, &mut found) {
            return false;
        }
        for &r in &found.at[..found.n] {
            let clear = others.iter().all(|&e| {
                let (a, b) = self.enclosure(e);
                b < r.0 || r.1 < a
            });
            let id = clear.then(|| self.intern(c, d, h, r)).flatten();
            match id {
                Some(id) => out.push(id),
                None => return false,
            }
        }
        out.push(x);
        true
    }

    /// The only root of h, if that is a square by its discriminant: named by its equation, so that all curves that
    /// touch there share the name.
    fn touch(&mut self, c: CurveId, d: CurveId) -> Option<NumId> {
        let [h0, h1, h2, 0, 0] = self.diff_small(c, d)? else {
            return None;
        };
        let square = h1.checked_mul(h1)? == h2.checked_mul(h0)?.checked_mul(4)?;
        if h2 == 0 || !square {
            return None;
        }
        let m = [Int::from(h1), Int::from(h2.checked_mul(2)?), Int::zero()];
        let x = self.root(&m, 0).ok()?;
        let ids = self.complete.entry((c, d)).or_default();
        if !ids.contains(&x) {
            ids.push(x);
        }
        Some(x)
    }

    /// The name of the only root of h in an enclosure; None where it may be confused with another.
    fn intern(&mut self, c: CurveId, d: CurveId, h: &[Approx; 5], r: (f64, f64)) -> Option<NumId> {
        for id in self.interned((c, d)) {
            let n = &self.nums[id as usize];
            if n.hi < r.0 || r.1 < n.lo {
                continue;
            }
            let around = Approx::between(n.lo.min(r.0), n.hi.max(r.1));
            // Monotone on both: one root.
            return matches!(horner(&slope_of(h), around).sign(), Some(-1 | 1)).then_some(id);
        }
        if self.complete.contains_key(&(c, d)) {
            return None;
        }
        let id = self.add(r.0, r.1, Def::Cross(c, d));
        let before = self.pairs.insert((c, d), id);
        self.next_cross.resize(id as usize, NumId::MAX);
        self.next_cross.push(before.unwrap_or(NumId::MAX));
        Some(id)
    }

    /// The crossings of a pair that have names.
    fn interned(&self, pair: (CurveId, CurveId)) -> impl Iterator<Item = NumId> + '_ {
        let first = self.pairs.get(&pair).copied();
        let next = |x: &NumId| self.next_cross.get(*x as usize).copied();
        let one_by_one =
            std::iter::successors(first, move |x| next(x).filter(|&y| y != NumId::MAX));
        let at_once = self.complete.get(&pair).into_iter().flatten().copied();
        one_by_one.chain(at_once)
    }

    /// The double roots of h, if it has any and none of a higher order, and what is left of h without them. They
    /// are roots of a polynomial of low degree, h's with its derivative, and so are named by it: all curves
    /// that touch at one place share the name.
    fn multiple_roots(&mut self, h: &Poly) -> Option<(Poly, Vec<NumId>)> {
        let g = h.gcd(&h.derivative()).primitive();
        let n = g.degree().filter(|n| (1..=2).contains(n))?;
        let rest = h.div_exact(&g)?.div_exact(&g)?;
        let m = [0, 1, 2].map(|i| g.coeff(i));
        let mut ids = Vec::new();
        for k in 0..n as u8 {
            ids.extend(self.root(&m, k).ok());
        }
        for &x in &ids {
            self.add_hub(x);
        }
        Some((rest, ids))
    }

    /// All real roots of h, exactly.
    #[cold]
    fn all_crossings(&mut self, c: CurveId, d: CurveId, out: &mut Vec<NumId>) {
        if !self.complete.contains_key(&(c, d)) {
            let before: Vec<NumId> = self.interned((c, d)).collect();
            let mut ids = Vec::new();
            self.stats.pairs_exact += 1;
            let mut h = self.diff_poly(c, d);
            if let Some((rest, multiple)) = self.multiple_roots(&h) {
                h = rest;
                ids.extend(multiple);
            }
            for r in h.real_roots() {
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
                    self.settle_value(id, r);
                    ids.push(id);
                }
            }
            self.complete.insert((c, d), ids);
        }
        out.extend(self.interned((c, d)));
    }
}

/// h from the coefficients, in a word that holds it; see [`Kernel::proportional`].
#[inline]
fn difference<T>(a: &[i64; 6], b: &[i64; 6], proportional: bool) -> [T; 5]
where
    T: From<i64> + Copy + Default + Mul<Output = T> + Sub<Output = T> + Add<Output = T>,
{
    let times = |x: i64, y: i64| T::from(x) * T::from(y);
    let mut h = [T::default(); 5];
    if proportional {
        let k = 5 - (3..6).rev().position(|i| a[i] != 0).unwrap_or(0);
        for i in 0..3 {
            h[i] = times(a[i], b[k]) - times(b[i], a[k]);
        }
    } else {
        for i in 0..3 {
            for j in 0..3 {
                h[i + j] = h[i + j] + (times(a[i], b[j + 3]) - times(b[i], a[j + 3]));
            }
        }
    }
    h
}

/// Divides by u − x; the degree n falls by one. Returns what remains, which is zero for a factor.
#[inline]
fn deflate(g: &mut [Approx; 5], n: &mut usize, x: Approx) -> Approx {
    let mut carry = g[*n];
    for k in (0..*n).rev() {
        let below = g[k] + x * carry;
        g[k] = carry;
        carry = below;
    }
    g[*n] = Approx::default();
    *n -= 1;
    carry
}

/// The derivative of h.
pub(super) fn slope_of(h: &[Approx; 5]) -> [Approx; 4] {
    [h[1], two(h[2]), h[3] * Approx::exact(3.0), two(two(h[4]))]
}

fn derivative_of(h: &[i128; 5]) -> Option<[i128; 5]> {
    let mut out = [0; 5];
    for k in 1..5 {
        out[k - 1] = h[k].checked_mul(k as i128)?;
    }
    Some(out)
}

/// How often h vanishes at the roots of m, as far as machine words tell and never said to be more than it is.
fn multiplicity(h: &[i128; 5], m: &[i64; 3]) -> usize {
    if vanishes(h, m) == Some(true) {
        further_multiplicity(*h, m)
    } else {
        0
    }
}

/// The same for an h that is known to vanish there.
fn further_multiplicity(mut h: [i128; 5], m: &[i64; 3]) -> usize {
    let mut order = 1;
    while order < 4 {
        match derivative_of(&h) {
            Some(next) if next != [0; 5] && vanishes(&next, m) == Some(true) => h = next,
            _ => break,
        }
        order += 1;
    }
    order
}

#[inline]
fn derivative(f: &[Approx; 3], u: Approx) -> Approx {
    two(f[2] * u) + f[1]
}

/// Whether h vanishes at the irrational (or only) roots of m, by pseudo-division; None where it does not
/// fit, or where the remainder does not tell.
pub(super) fn vanishes(h: &[i128; 5], m: &[i64; 3]) -> Option<bool> {
    let top = if m[2] != 0 { 2 } else { 1 };
    let mut r = *h;
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
