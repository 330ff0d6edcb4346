//! Which of two numbers is greater, and whether they are one.
//!
//! The idea: the cheapest proof first. One handle, then double enclosures, then (where a quotient's own polynomial
//! has not been made) a few hundred bits; then a gcd decides equality, and only what is known to differ
//! is refined until it shows.

use super::super::filter::{self, Stage};
use super::super::refine::Cell;
use super::super::root::{Root, grid};
use super::super::{Interval, Rat};
use super::quotient::ends;
use super::{Algebraic, QuotientOf, Rational, RootOf};
use std::cmp::Ordering;
use std::sync::Arc;

/// What enclosures alone prove: the order of numbers that they hold apart, or equality where both
/// are one double.
#[inline]
pub(super) fn told_apart(x: &Interval, y: &Interval) -> Option<Ordering> {
    let order = if x.below(y) {
        Ordering::Less
    } else if y.below(x) {
        Ordering::Greater
    } else if x.lo == x.hi && *x == *y && x.is_finite() {
        Ordering::Equal
    } else {
        return None;
    };
    filter::settled(Stage::Double);
    Some(order)
}

/// Counts an equality of roots as settled, and keeps it where it holds: by name where both have
/// one polynomial (and so, their intervals being isolating, no arithmetic told them equal).
fn settled_equality(a: &Arc<Root>, b: &Arc<Root>, same: bool) {
    if same {
        Root::unite(a, b);
        if a.poly == b.poly {
            return filter::settled(Stage::Name);
        }
    }
    filter::settled_exactly(same, a.poly.most_bits().max(b.poly.most_bits()));
}

/// Two rationals that their enclosures do not tell apart.
pub(super) fn cmp_values(a: &Rat, b: &Rat) -> Ordering {
    // Fractions in lowest terms are one number if and only if they are spelt alike.
    if a == b {
        filter::settled(Stage::Name);
        return Ordering::Equal;
    }
    filter::settled_exactly(false, a.bits().max(b.bits()));
    a.cmp(b)
}

/// Two roots that are known to differ.
fn cmp_different(a: &Root, b: &Root) -> Ordering {
    let wider = grid(a.enclosure(), 100);
    let mut bits = wider;
    let settled = |bits| {
        if bits == wider {
            filter::settled(Stage::Wider);
        } else {
            filter::settled_exactly(false, bits);
        }
    };
    let (mut x, mut y) = (a.refine(), b.refine());
    loop {
        // With a value met exactly one has v ≤ number ≤ v, else k < number·2^bits < k + 1.
        let ((lo, hi), (l, h)) = match (x.cell(bits), y.cell(bits)) {
            (Cell::Between(j), Cell::Between(k)) => {
                if j != k {
                    settled(bits);
                    return j.cmp(&k);
                }
                bits = 2 * bits + 32;
                continue;
            }
            (p, q) => (ends(p, bits), ends(q, bits)),
        };
        if hi <= l {
            settled(bits);
            return Ordering::Less;
        }
        if h <= lo {
            settled(bits);
            return Ordering::Greater;
        }
        bits = 2 * bits + 32;
    }
}

/// The least j ≥ 0 such that two different irrational numbers lie in different cells of the grid of step 2^-j.
pub(super) fn separating_grid(a: &Algebraic, b: &Algebraic) -> u64 {
    let (Ok(a), Ok(b)) = (a.root(), b.root()) else {
        return 0;
    };
    let (mut a, mut b) = (a.refine(), b.refine());
    let mut bits = 64;
    loop {
        if let (Cell::Between(x), Cell::Between(y)) = (a.cell(bits), b.cell(bits))
            && x != y
        {
            // Coarser grids: drop bits as long as the cells differ (monotone, so bisect).
            let (mut least, mut most) = (0, bits);
            while least < most {
                let j = least.midpoint(most);
                if x.shr(bits - j) != y.shr(bits - j) {
                    most = j
                } else {
                    least = j + 1
                }
            }
            return most;
        }
        bits *= 2;
    }
}

impl Algebraic {
    /// Order by rational ends of so many bits after the point that ordinary coincidences of numbers
    /// of this size stop there: only what still looks equal is worth a resultant.
    fn told_apart_by_bits(&self, o: &Algebraic) -> Option<Ordering> {
        let unresolved =
            |a: &Algebraic| matches!(&a.0, QuotientOf(q) if q.resolved.get().is_none());
        if !filter::on() || !(unresolved(self) || unresolved(o)) {
            return None;
        }
        let wider = grid(self.around(), 100);
        let most = self.coefficient_bits().max(o.coefficient_bits());
        let (mut u, mut v) = (self.narrowing(), o.narrowing());
        for bits in [wider, 2 * most] {
            if bits < wider {
                break;
            }
            let ((a, b), (c, d)) = (u.at(bits), v.at(bits));
            let order = match (b < c, d < a) {
                (true, _) => Ordering::Less,
                (_, true) => Ordering::Greater,
                _ => continue,
            };
            if bits == wider {
                filter::settled(Stage::Wider);
            } else {
                filter::settled_exactly(false, bits);
            }
            return Some(order);
        }
        None
    }
    /// The bits of the largest integer that the number is written with.
    fn coefficient_bits(&self) -> u64 {
        match &self.0 {
            Rational(k) => k.value.bits(),
            RootOf(r) => r.poly.most_bits(),
            QuotientOf(q) => {
                let parts = q.num.most_bits().max(q.den.most_bits());
                parts.max(q.root.poly.most_bits())
            }
        }
    }
}

impl PartialEq for Algebraic {
    fn eq(&self, o: &Algebraic) -> bool {
        if self.named_alike(o) {
            return true;
        }
        if let Some(o) = told_apart(&self.around(), &o.around()) {
            return o.is_eq();
        }
        match (&self.0, &o.0) {
            (Rational(a), Rational(b)) => cmp_values(&a.value, &b.value).is_eq(),
            (Rational(a), _) => o.cmp_rat(&a.value).is_eq(),
            (_, Rational(b)) => self.cmp_rat(&b.value).is_eq(),
            (QuotientOf(a), QuotientOf(b)) if Arc::ptr_eq(&a.root, &b.root) => {
                a.cmp_same(b).is_eq()
            }
            _ if self.told_apart_by_bits(o).is_some() => false,
            _ => match (self.root(), o.root()) {
                (Ok(a), Ok(b)) if Arc::ptr_eq(a.representative(), b.representative()) => {
                    filter::settled(Stage::Name);
                    true
                }
                (Ok(a), Ok(b)) => {
                    let same = a.enclosure().meets(&b.enclosure()) && a.equals(b);
                    settled_equality(a, b, same);
                    same
                }
                (Err(r), _) => o.cmp_rat(r).is_eq(),
                (_, Err(r)) => self.cmp_rat(r).is_eq(),
            },
        }
    }
}
impl Eq for Algebraic {}
impl PartialOrd for Algebraic {
    fn partial_cmp(&self, o: &Algebraic) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Algebraic {
    fn cmp(&self, o: &Algebraic) -> Ordering {
        if self.named_alike(o) {
            return Ordering::Equal;
        }
        if let Some(o) = told_apart(&self.around(), &o.around()) {
            return o;
        }
        match (&self.0, &o.0) {
            (Rational(a), Rational(b)) => return cmp_values(&a.value, &b.value),
            (Rational(a), _) => return o.cmp_rat(&a.value).reverse(),
            (_, Rational(b)) => return self.cmp_rat(&b.value),
            (QuotientOf(a), QuotientOf(b)) if Arc::ptr_eq(&a.root, &b.root) => {
                return a.cmp_same(b);
            }
            _ => {}
        }
        if let Some(o) = self.told_apart_by_bits(o) {
            return o;
        }
        let (a, b) = match (self.root(), o.root()) {
            (Ok(a), Ok(b)) => (a, b),
            (Err(r), _) => return o.cmp_rat(r).reverse(),
            (_, Err(r)) => return self.cmp_rat(r),
        };
        if Arc::ptr_eq(a.representative(), b.representative()) {
            filter::settled(Stage::Name);
            return Ordering::Equal;
        }
        // Settling a quotient may have narrowed its enclosure.
        if let Some(o) = told_apart(&a.enclosure(), &b.enclosure()) {
            return o;
        }
        if a.equals(b) {
            settled_equality(a, b, true);
            Ordering::Equal
        } else {
            cmp_different(a, b)
        }
    }
}
