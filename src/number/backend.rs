//! Which library carries the integers that outgrow a machine word.

use std::sync::atomic::{AtomicU8, Ordering};

/// A big-number library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// num-bigint: pure Rust, always there.
    Num,
    /// GMP by rug, with the feature `rug`: faster from a few thousand bits on. LGPL.
    Rug,
}

impl Backend {
    /// The word that the command line uses.
    pub fn name(self) -> &'static str {
        match self {
            Backend::Num => "num",
            Backend::Rug => "rug",
        }
    }
    /// Whether it is built in.
    pub fn built_in(self) -> bool {
        self == Backend::Num || cfg!(feature = "rug")
    }
}

static CHOSEN: AtomicU8 = AtomicU8::new(0);

/// The library that new long integers are made with.
#[inline]
pub fn backend() -> Backend {
    if CHOSEN.load(Ordering::Relaxed) == 1 {
        Backend::Rug
    } else {
        Backend::Num
    }
}

/// Chooses the library for the whole process; false, and no change, where it is not built in.
/// Integers made before stay what they are, and mix with the new ones.
pub fn set_backend(b: Backend) -> bool {
    if b.built_in() {
        CHOSEN.store(u8::from(b == Backend::Rug), Ordering::Relaxed);
    }
    b.built_in()
}
