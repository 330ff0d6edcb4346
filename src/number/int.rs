//! `Int`: integers of any size. STUB: signatures are fixed, bodies to be written.
use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// An integer of any size.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default, PartialOrd, Ord)]
pub struct Int(i128);

impl Int {
    /// Zero.
    pub fn zero() -> Int {
        todo!()
    }
    /// One.
    pub fn one() -> Int {
        todo!()
    }
    /// -1, 0 or 1.
    pub fn sign(&self) -> i32 {
        todo!()
    }
    /// Whether zero.
    pub fn is_zero(&self) -> bool {
        self.sign() == 0
    }
    /// Absolute value.
    pub fn abs(&self) -> Int {
        todo!()
    }
    /// Greatest common divisor, non-negative.
    pub fn gcd(&self, _other: &Int) -> Int {
        todo!()
    }
    /// Exact quotient; the caller knows that `d` divides `self`.
    pub fn div_exact(&self, _d: &Int) -> Int {
        todo!()
    }
    /// Floor division and the non-negative remainder for d > 0.
    pub fn div_rem_floor(&self, _d: &Int) -> (Int, Int) {
        todo!()
    }
    /// Bits of |self|.
    pub fn bits(&self) -> u64 {
        todo!()
    }
    /// self * 2^k.
    pub fn shl(&self, _k: u64) -> Int {
        todo!()
    }
    /// floor(self / 2^k).
    pub fn shr(&self, _k: u64) -> Int {
        todo!()
    }
    /// self^k.
    pub fn pow(&self, _k: u32) -> Int {
        todo!()
    }
    /// The value as i64 where it fits.
    pub fn to_i64(&self) -> Option<i64> {
        todo!()
    }
}
impl From<i64> for Int {
    fn from(_v: i64) -> Int {
        todo!()
    }
}
impl From<i128> for Int {
    fn from(_v: i128) -> Int {
        todo!()
    }
}
impl From<u64> for Int {
    fn from(_v: u64) -> Int {
        todo!()
    }
}
impl std::str::FromStr for Int {
    type Err = String;
    fn from_str(_s: &str) -> Result<Int, String> {
        todo!()
    }
}
impl fmt::Display for Int {
    fn fmt(&self, _f: &mut fmt::Formatter<'_>) -> fmt::Result {
        todo!()
    }
}
macro_rules! ops {
    ($t:ty) => {
        impl Add<&$t> for &$t {
            type Output = $t;
            fn add(self, _o: &$t) -> $t {
                todo!()
            }
        }
        impl Sub<&$t> for &$t {
            type Output = $t;
            fn sub(self, _o: &$t) -> $t {
                todo!()
            }
        }
        impl Mul<&$t> for &$t {
            type Output = $t;
            fn mul(self, _o: &$t) -> $t {
                todo!()
            }
        }
        impl Add<$t> for $t {
            type Output = $t;
            fn add(self, _o: $t) -> $t {
                todo!()
            }
        }
        impl Sub<$t> for $t {
            type Output = $t;
            fn sub(self, _o: $t) -> $t {
                todo!()
            }
        }
        impl Mul<$t> for $t {
            type Output = $t;
            fn mul(self, _o: $t) -> $t {
                todo!()
            }
        }
        impl Add<&$t> for $t {
            type Output = $t;
            fn add(self, _o: &$t) -> $t {
                todo!()
            }
        }
        impl Sub<&$t> for $t {
            type Output = $t;
            fn sub(self, _o: &$t) -> $t {
                todo!()
            }
        }
        impl Mul<&$t> for $t {
            type Output = $t;
            fn mul(self, _o: &$t) -> $t {
                todo!()
            }
        }
        impl Add<$t> for &$t {
            type Output = $t;
            fn add(self, _o: $t) -> $t {
                todo!()
            }
        }
        impl Sub<$t> for &$t {
            type Output = $t;
            fn sub(self, _o: $t) -> $t {
                todo!()
            }
        }
        impl Mul<$t> for &$t {
            type Output = $t;
            fn mul(self, _o: $t) -> $t {
                todo!()
            }
        }
        impl Neg for &$t {
            type Output = $t;
            fn neg(self) -> $t {
                todo!()
            }
        }
        impl Neg for $t {
            type Output = $t;
            fn neg(self) -> $t {
                todo!()
            }
        }
        impl AddAssign<&$t> for $t {
            fn add_assign(&mut self, _o: &$t) {
                todo!()
            }
        }
        impl SubAssign<&$t> for $t {
            fn sub_assign(&mut self, _o: &$t) {
                todo!()
            }
        }
        impl MulAssign<&$t> for $t {
            fn mul_assign(&mut self, _o: &$t) {
                todo!()
            }
        }
    };
}
pub(crate) use ops;
ops!(Int);
#[allow(dead_code)]
fn _o(_: Ordering) {}
