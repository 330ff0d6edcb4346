//! Times and positions that are taken for one (DP §8.4.2).
//!
//! The idea: what lies within the tolerance of a value met before is that value, and transitively so. Places and
//! moments are handles of canonical values, which may still be merged when something bridges two of them.

use super::{Double, PLACES, SLACK, TIMES, TOLERANCE};
use crate::number::Interval;
use std::cell::{Cell, RefCell};
use std::cmp::Ordering;
use std::rc::Rc;

/// One canonical value; shared by everything that was identified with it.
#[derive(Debug)]
pub(super) struct Class {
    pub(super) value: Cell<f64>,
    /// Classes that this one has swallowed.
    merged: RefCell<Vec<Rc<Class>>>,
}

impl Class {
    pub(super) fn new(value: f64) -> Rc<Class> {
        Rc::new(Class {
            value: Cell::new(value),
            merged: RefCell::default(),
        })
    }
    fn become_value(&self, value: f64) {
        self.value.set(value);
        for m in self.merged.borrow().iter() {
            m.become_value(value);
        }
    }
}

/// The values met so far, as disjoint ranges: what lies within the tolerance of a range belongs to
/// it and widens it, and what joins two ranges makes one of them. So the outcome does not depend
/// on the order in which values are met, only the canonical value does: it is the first one's.
#[derive(Debug)]
pub(super) struct Classes {
    /// (lowest, highest, class), ascending.
    pub(super) ranges: Vec<(f64, f64, Rc<Class>)>,
}

impl Classes {
    pub(super) const fn new() -> Classes {
        Classes { ranges: Vec::new() }
    }
    pub(super) fn identify(&mut self, x: f64, tolerance: f64) -> Rc<Class> {
        if tolerance <= 0.0 || !x.is_finite() {
            return Class::new(x);
        }
        // The first range that ends at or after x − tolerance.
        let at = self.ranges.partition_point(|r| r.1 < x - tolerance);
        let near = |r: &(f64, f64, Rc<Class>)| r.0 <= x + tolerance;
        if !self.ranges.get(at).is_some_and(near) {
            let class = Class::new(x);
            self.ranges.insert(at, (x, x, class.clone()));
            return class;
        }
        if self.ranges.get(at + 1).is_some_and(near) {
            let (_, high, other) = self.ranges.remove(at + 1);
            let first = &mut self.ranges[at];
            first.1 = high;
            other.become_value(first.2.value.get());
            first.2.merged.borrow_mut().push(other);
        }
        let range = &mut self.ranges[at];
        range.0 = range.0.min(x);
        range.1 = range.1.max(x);
        range.2.clone()
    }
}

/// A position or an instant: the canonical value of what it was identified with.
#[derive(Clone, Debug)]
pub struct Place(pub(super) Rc<Class>);

/// An instant of the double kernel.
#[derive(Clone, Debug)]
pub struct Moment(pub(super) Rc<Class>);

pub(super) fn place(x: f64) -> Place {
    let tolerance = TOLERANCE.get();
    Place(PLACES.with_borrow_mut(|c| c.identify(x + 0.0, tolerance)))
}
pub(super) fn moment(t: f64) -> Moment {
    let tolerance = TOLERANCE.get();
    Moment(TIMES.with_borrow_mut(|c| c.identify(t + 0.0, tolerance)))
}
pub(super) fn around(x: f64) -> Interval {
    let w = SLACK * TOLERANCE.get();
    Interval {
        lo: x - w,
        hi: x + w,
    }
}
pub(super) fn middle(a: f64, b: f64) -> Double {
    let m = a.midpoint(b);
    Double(if m.is_finite() {
        m + 0.0
    } else {
        a.max(b).min(f64::MAX)
    })
}

macro_rules! ordered_by_value {
    ($t:ty) => {
        impl $t {
            /// The canonical value.
            pub fn get(&self) -> f64 {
                self.0.value.get()
            }
        }
        impl PartialEq for $t {
            fn eq(&self, o: &$t) -> bool {
                self.cmp(o).is_eq()
            }
        }
        impl Eq for $t {}
        impl PartialOrd for $t {
            fn partial_cmp(&self, o: &$t) -> Option<Ordering> {
                Some(self.cmp(o))
            }
        }
        impl Ord for $t {
            fn cmp(&self, o: &$t) -> Ordering {
                self.get().total_cmp(&o.get())
            }
        }
    };
}
ordered_by_value!(Place);
ordered_by_value!(Moment);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identification_is_transitive_in_any_order() {
        // 0, 8, 16 in units of a tolerance of 10: neighbours are near, the ends are not.
        for order in [
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ] {
            let mut classes = Classes::new();
            let mut met: Vec<Option<Rc<Class>>> = vec![None; 3];
            for i in order {
                met[i] = Some(classes.identify(8.0 * i as f64, 10.0));
            }
            let far = classes.identify(40.0, 10.0);
            let values: Vec<f64> = met.iter().flatten().map(|c| c.value.get()).collect();
            // The canonical value is that of the first in the surviving class, the same for all.
            assert!(
                values.iter().all(|v| *v == values[0]),
                "{order:?}: {values:?}"
            );
            assert_eq!(far.value.get(), 40.0);
        }
    }
}
