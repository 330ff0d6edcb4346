//! The ring operators of a type, by value and by reference in every form, from four methods of its own: so that numbers
//! and polynomials are written as people write them, and none of the forms is spelt out twice.

/// Every form of the ring operators, by value and by reference, from the inherent methods
/// `plus`, `minus`, `times` and `negated`.
macro_rules! ops {
    ($t:ty) => {
        $crate::number::ops::ops!(@two $t, Add, add, plus);
        $crate::number::ops::ops!(@two $t, Sub, sub, minus);
        $crate::number::ops::ops!(@two $t, Mul, mul, times);
        impl Neg for &$t {
            type Output = $t;
            #[inline]
            fn neg(self) -> $t {
                self.negated()
            }
        }
        impl Neg for $t {
            type Output = $t;
            #[inline]
            fn neg(self) -> $t {
                self.negated()
            }
        }
        $crate::number::ops::ops!(@assign $t, AddAssign, add_assign, plus);
        $crate::number::ops::ops!(@assign $t, SubAssign, sub_assign, minus);
        $crate::number::ops::ops!(@assign $t, MulAssign, mul_assign, times);
    };
    (@two $t:ty, $tr:ident, $f:ident, $m:ident) => {
        impl $tr<&$t> for &$t {
            type Output = $t;
            #[inline]
            fn $f(self, o: &$t) -> $t {
                self.$m(o)
            }
        }
        impl $tr<$t> for $t {
            type Output = $t;
            #[inline]
            fn $f(self, o: $t) -> $t {
                self.$m(&o)
            }
        }
        impl $tr<&$t> for $t {
            type Output = $t;
            #[inline]
            fn $f(self, o: &$t) -> $t {
                self.$m(o)
            }
        }
        impl $tr<$t> for &$t {
            type Output = $t;
            #[inline]
            fn $f(self, o: $t) -> $t {
                self.$m(&o)
            }
        }
    };
    (@assign $t:ty, $tr:ident, $f:ident, $m:ident) => {
        impl $tr<&$t> for $t {
            #[inline]
            fn $f(&mut self, o: &$t) {
                *self = self.$m(o);
            }
        }
        impl $tr<$t> for $t {
            #[inline]
            fn $f(&mut self, o: $t) {
                *self = self.$m(&o);
            }
        }
    };
}
pub(crate) use ops;
