//! Numbers on the u axis: made, named, compared.
//!
//! The idea: a number is an enclosure in doubles and a word on what it is (a root of an end's equation, the
//! crossing of two curves). Most comparisons end with the enclosures. Those that meet are told apart by an
//! integer test where one side is a root of a small quadratic, else by algebraic numbers, made once, and by
//! cells of 2^-FINE. Numbers proven equal are united, so that the second question costs nothing.

use super::approx::{Approx, horner};
use super::compare::{slope_of, vanishes};
use super::kernel::{Def, Defect, Kernel, Num, NumId, two};
use crate::number::modular::gcd_degree_bound;
use crate::number::{Algebraic, Int, Poly, Rat};
use std::cmp::Ordering;

/// So many numbers are kept in mind with which others may be equal, the last ones.
const HUBS: usize = 8;

/// Bits after the point of the cached cells that tell very near numbers apart.
const FINE: u32 = 320;

impl Kernel {
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
        let def = Def::Root(self.roots.len() as u32);
        self.roots.push((m, k));
        let id = self.add(root.lo(), root.hi(), def);
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
        self.exact.insert(id, a);
        id
    }

    pub(super) fn add(&mut self, lo: f64, hi: f64, def: Def) -> NumId {
        let id = self.nums.len() as NumId;
        self.nums.push(Num {
            lo,
            hi,
            parent: id,
            def,
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
    pub(super) fn approx(&self, x: NumId) -> Approx {
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
        if let Some(order) = self.framed_apart(x, y).or_else(|| self.cells_apart(x, y)) {
            return order;
        }
        if self.united_by_equation(x, y) {
            return Ordering::Equal;
        }
        if self.joins_hub(x) | self.joins_hub(y) {
            return self.cmp(x, y);
        }
        if let Some(order) = self.cmp_in_old_frame(x, y) {
            return order;
        }
        // That frame told all but a few that differ, so these may be equal.
        let a = self.exact(x).defining_polynomial();
        let b = self.exact(y).defining_polynomial();
        if self.united_by_equation(x, y) {
            return Ordering::Equal;
        }
        // Numbers with no common equation are not equal: worth telling apart by ever more digits.
        if gcd_degree_bound(&a, &b) == Some(0) {
            if let Some(order) = self.cmp_in_frames(x, y, 0) {
                return order;
            }
            if let Some(order) = self.cmp_in_frames(x, y, 1) {
                return order;
            }
            self.make_fine(x);
            self.make_fine(y);
            if let Some(order) = self.cells_apart(x, y) {
                return order;
            }
        }
        let (a, b) = (self.exact(x).clone(), self.exact(y).clone());
        let order = a.cmp(&b);
        if order.is_eq() {
            let common = a.defining_polynomial().gcd(&b.defining_polynomial());
            self.learn(x, &common.primitive());
            self.unite(x, y);
            self.add_hub(x);
        }
        order
    }

    /// The equation of low degree that a number is known to satisfy, in machine words.
    pub(super) fn equation(&self, x: NumId) -> Option<[i64; 3]> {
        let mut x = x;
        loop {
            let n = &self.nums[x as usize];
            let known = match n.def {
                Def::Root(i) => Some(self.roots[i as usize].0),
                _ => self.low.get(&x).copied(),
            };
            // What is known of an equal number will do.
            if known.is_some() || n.parent == x {
                return known;
            }
            x = n.parent;
        }
    }

    /// Unites two numbers that their equations prove to be equal.
    fn united_by_equation(&mut self, x: NumId, y: NumId) -> bool {
        let equal = self.same_root(x, y) || self.same_root(y, x);
        if equal {
            self.unite(x, y);
        }
        equal
    }

    /// Whether y, a crossing, is x, by an integer test; false where that does not tell.
    pub(super) fn same_root(&self, x: NumId, y: NumId) -> bool {
        let (a, b) = (self.enclosure(x), self.enclosure(y));
        if a.1 < b.0 || b.1 < a.0 {
            return false;
        }
        let Some(m) = self.equation(x) else {
            return false;
        };
        // The one root of a polynomial where that is steep.
        let around = Approx::between(a.0.min(b.0), a.1.max(b.1));
        let alone = |steep: &[Approx]| matches!(horner(steep, around).sign(), Some(-1 | 1));
        if self.equation(y) == Some(m) {
            let [_, b, c] = m.map(Approx::from_word);
            return alone(&[b, two(c)]);
        }
        let Def::Cross(c, d) = self.nums[y as usize].def else {
            return false;
        };
        let Some(h) = self.diff_small(c, d) else {
            return false;
        };
        if vanishes(&h, &m) != Some(true) {
            return false;
        }
        // A crossing is the only root of h in its enclosure, as long as that is what it was found by.
        let inside = a.0 >= b.0 && a.1 <= b.1 && !self.exact.contains_key(&y);
        inside || alone(&slope_of(&h.map(Approx::from_int)))
    }

    /// Keeps a number in mind with which others may be equal, if its equation is of low degree: two crossings in one
    /// point are hard to tell to be equal, each of them and the root of such an equation are not.
    pub(super) fn add_hub(&mut self, x: NumId) {
        if self.equation(x).is_none() {
            return;
        }
        let x = self.find(x);
        for at in (0..self.hubs.len()).rev() {
            if self.find(self.hubs[at].0) == x {
                self.hubs.remove(at);
            }
        }
        self.hubs_made += 1;
        self.hubs.push((x, self.hubs_made));
        let old = self.hubs.len().saturating_sub(HUBS);
        self.hubs.drain(..old);
    }

    /// Unites a crossing with the hub that it is. Each crossing is held against each hub once.
    fn joins_hub(&mut self, x: NumId) -> bool {
        let x = self.find(x);
        let tried = self
            .hubs_tried
            .insert(x, self.hubs_made)
            .unwrap_or_default();
        if tried == self.hubs_made {
            return false;
        }
        let hub = self.hubs.iter().rev().filter(|h| h.1 > tried).map(|h| h.0);
        let hub = hub.into_iter().find(|&h| h != x && self.same_root(h, x));
        let Some(hub) = hub.map(|h| self.find(h)) else {
            return false;
        };
        if hub != x {
            self.unite(hub, x);
        }
        hub != x
    }

    pub(super) fn unite(&mut self, x: NumId, y: NumId) {
        // The name that all share is one with an equation, if any has one.
        let (x, y) = if self.equation(x).is_none() && self.equation(y).is_some() {
            (y, x)
        } else {
            (x, y)
        };
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

    /// Makes the cell of a number: an integer c with c ≤ x·2^FINE < c + 3/2.
    ///
    /// That is all that is asked of an enclosure lo ≤ x ≤ lo + 2^-(FINE+1), with c = floor(lo·2^FINE): equal
    /// numbers that came about in different ways may have neighbouring cells.
    fn make_fine(&mut self, x: NumId) {
        if !self.fine.contains_key(&x) {
            let (lo, _) = self.exact(x).enclosure(FINE + 1);
            let scaled = lo.numer().shl(u64::from(FINE));
            let cell = scaled.div_rem_floor(lo.denom()).0;
            self.fine.insert(x, cell);
        }
    }

    /// The order of two numbers whose cells are known and prove it: c + 2 ≤ d gives x·2^FINE < c + 3/2 < d ≤
    /// y·2^FINE. Equal and neighbouring cells prove nothing.
    fn cells_apart(&self, x: NumId, y: NumId) -> Option<Ordering> {
        let (c, d) = (self.fine.get(&x)?, self.fine.get(&y)?);
        let order = c.cmp(d);
        let apart = match order {
            Ordering::Less => d - c > Int::one(),
            Ordering::Greater => c - d > Int::one(),
            Ordering::Equal => false,
        };
        apart.then_some(order)
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
        if !self.exact.contains_key(&x) {
            let n = &self.nums[x as usize];
            let (lo, hi) = (n.lo, n.hi);
            let a = match n.def {
                Def::Root(i) => {
                    let (m, k) = self.roots[i as usize];
                    let roots = Poly::from_i64(&m).real_roots();
                    roots[(k as usize).min(roots.len() - 1)].clone()
                }
                Def::Cross(c, d) => {
                    let mut roots = self.diff_poly(c, d).real_roots();
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
            self.settle_value(x, a);
        }
        &self.exact[&x]
    }

    /// Keeps the value of a number, and its equation where that is of low degree.
    pub(super) fn settle_value(&mut self, x: NumId, a: Algebraic) {
        let i = a.interval();
        let n = &mut self.nums[x as usize];
        (n.lo, n.hi) = (n.lo.max(i.lo), n.hi.min(i.hi));
        if matches!(n.def, Def::Cross(..)) {
            let m = a.known_rat().map_or_else(
                || a.defining_polynomial(),
                |r| Poly::new(vec![-r.numer(), r.denom().clone()]),
            );
            self.learn(x, &m);
        }
        self.exact.insert(x, a);
    }

    /// Keeps an equation of a number, if that is of low degree and short.
    fn learn(&mut self, x: NumId, m: &Poly) {
        if m.degree().is_some_and(|n| n <= 2)
            && let [Some(a), Some(b), Some(c)] = [0, 1, 2].map(|i| m.coeff(i).to_i64())
        {
            self.low.insert(x, [a, b, c]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::face::kernel::CurveId;

    fn curve(k: &mut Kernel, p: [i64; 3], q: [i64; 3]) -> CurveId {
        k.curve(&p.map(Int::from), &q.map(Int::from))
            .expect("a denominator")
    }

    /// The crossing of two curves near a place.
    fn crossing(k: &mut Kernel, c: CurveId, d: CurveId, near: f64) -> NumId {
        let mut found = Vec::new();
        k.crossings(c, d, (0.0, 2.0), &[], &mut found);
        found.retain(|&x| (k.enclosure(x).0 - near).abs() < 1e-3);
        assert_eq!(found.len(), 1);
        found[0]
    }

    #[test]
    fn an_even_quartic_is_no_quadratic() {
        let mut k = Kernel::default();
        let c = curve(&mut k, [1, 0, 0], [1, 0, 1]);
        let d = curve(&mut k, [2, 0, -1], [1, 0, 2]);
        // u⁴ + u² − 1 is irreducible.
        let x = crossing(&mut k, c, d, 0.786);
        k.exact(x);
        assert_eq!(k.equation(x), None);
    }

    #[test]
    fn what_two_crossings_have_in_common_is_learnt() {
        // Through (√2, 5/11) all of them, with denominators of their own.
        let mut k = Kernel::default();
        let curves = [[5, 1, 1], [7, 3, 2], [2, 4, -1], [3, 2, 7]].map(|[a, d, e]| {
            let (p, q) = (
                [5 * d - 22 * a, 0, 5 * d + 11 * a],
                [11 * (d - 2 * e), 0, 11 * (d + e)],
            );
            curve(&mut k, p, q)
        });
        let [a, b, c, d] = curves;
        let (x, y, z) = (
            crossing(&mut k, a, b, 1.414),
            crossing(&mut k, c, d, 1.414),
            crossing(&mut k, a, d, 1.414),
        );
        assert!(k.cmp(x, y).is_eq());
        assert_eq!(k.equation(x), Some([-2, 0, 1]));
        let before = k.exact.len();
        assert!(k.cmp(x, z).is_eq());
        assert_eq!(k.exact.len(), before, "the third is known by its equation");
    }
}
