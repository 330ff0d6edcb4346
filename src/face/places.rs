//! Which curves are known to pass through one point.
//!
//! The idea: where arcs come from a scene, several curves run through one corner by construction, and the
//! slice knows such points by name; other coincidences are proven once, by algebra. Either way the
//! curves are put in one class of the place (a union-find), so that of k curves through a point at most k − 1 pairs
//! are ever proven, and none where names say it.

use super::hash::FastMap;
use super::item::{Carrier, Item};
use super::kernel::{CurveId, Kernel, NumId};

/// Classes of curves over numbers.
#[derive(Default)]
pub(super) struct Places {
    classes: FastMap<(NumId, CurveId), u32>,
    named: FastMap<(NumId, u64), u32>,
    parents: Vec<u32>,
}

impl Places {
    fn class(&mut self, at: (NumId, CurveId)) -> u32 {
        let parents = &mut self.parents;
        *self.classes.entry(at).or_insert_with(|| {
            parents.push(parents.len() as u32);
            parents.len() as u32 - 1
        })
    }
    fn find(&self, mut class: u32) -> u32 {
        while self.parents[class as usize] != class {
            class = self.parents[class as usize];
        }
        class
    }
    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        // Towards the older one: chains stay short, for classes are few.
        let (old, young) = (a.min(b), a.max(b));
        self.parents[young as usize] = old;
    }
    /// A curve passes over a number through the point of a name.
    pub(super) fn name(&mut self, x: NumId, c: CurveId, name: u64) {
        let mine = self.class((x, c));
        let first = *self.named.entry((x, name)).or_insert(mine);
        self.join(mine, first);
    }
    /// Two curves have been proven to meet over a number.
    pub(super) fn unite(&mut self, x: NumId, c: CurveId, d: CurveId) {
        let (a, b) = (self.class((x, c)), self.class((x, d)));
        self.join(a, b);
    }
    /// Whether two curves are known to meet over a number.
    pub(super) fn alike(&self, x: NumId, c: CurveId, d: CurveId) -> bool {
        let class = |c| self.classes.get(&(x, c)).map(|&k| self.find(k));
        class(c).is_some_and(|k| class(d) == Some(k))
    }
}

impl Kernel {
    /// Notes the names of an item's ends.
    pub(super) fn name_ends(&mut self, item: &Item, names: [u64; 2]) {
        let ends = match item.carrier {
            Carrier::Graph(c) => [(item.l, c), (item.r, c)],
            Carrier::Vertical(low, high) => [(item.l, low), (item.l, high)],
        };
        for ((x, c), name) in ends.into_iter().zip(names) {
            let x = self.find(x);
            self.places.name(x, c, name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_is_an_equivalence() {
        let mut p = Places::default();
        assert!(!p.alike(0, 1, 1));
        p.name(0, 1, 77);
        p.name(0, 2, 77);
        p.name(0, 3, 78);
        p.name(1, 3, 77);
        assert!(p.alike(0, 1, 2) && !p.alike(0, 1, 3) && !p.alike(1, 1, 3));
        p.unite(0, 3, 4);
        assert!(p.alike(0, 4, 3) && !p.alike(0, 4, 1));
        p.unite(0, 4, 2);
        assert!(p.alike(0, 1, 3) && !p.alike(1, 3, 4));
    }
}
