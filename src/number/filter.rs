//! The filter: whether doubles may settle a question, and what settled how many.
//!
//! Every enclosure in doubles passes this switch. With it off, each one is the whole line, so no
//! double can settle or shorten anything, and the reference arithmetic is the same code without
//! its first stage. The switch and the counters belong to the thread, and cost a load each.
//!
//! A question is counted once, where it is settled: by a shared *name* (one handle, no
//! arithmetic), by *double* enclosures, by a *wider* fixed precision (some hundred bits), or
//! *exactly* (rational arithmetic, a gcd, refinement as far as it takes).

use std::cell::Cell;

/// What settled a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// One handle: equal without arithmetic.
    Name,
    /// Double enclosures.
    Double,
    /// A fixed precision of some hundred bits.
    Wider,
    /// Exact arithmetic.
    Exact,
}

/// How many questions each stage has settled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// By names.
    pub names: u64,
    /// By double enclosures.
    pub doubles: u64,
    /// By a wider fixed precision.
    pub wider: u64,
    /// Exactly.
    pub exact: u64,
    /// Of these, how many found two numbers equal or an expression zero.
    pub zeros: u64,
    /// The most bits of an integer that an exact answer was read from.
    pub most_bits: u64,
}

impl Counts {
    /// All questions.
    pub fn asked(&self) -> u64 {
        self.names + self.doubles + self.wider + self.exact
    }
    /// What was counted since `before`; the most bits are those of all time since the last reset.
    pub fn since(&self, before: &Counts) -> Counts {
        Counts {
            names: self.names - before.names,
            doubles: self.doubles - before.doubles,
            wider: self.wider - before.wider,
            exact: self.exact - before.exact,
            zeros: self.zeros - before.zeros,
            most_bits: self.most_bits,
        }
    }
}

thread_local! {
    static ON: Cell<bool> = const { Cell::new(true) };
    static SETTLED: [Cell<u64>; 4] = const { [const { Cell::new(0) }; 4] };
    static ZEROS: Cell<u64> = const { Cell::new(0) };
    static BITS: Cell<u64> = const { Cell::new(0) };
}

/// Whether doubles may settle anything on this thread.
#[inline]
pub(crate) fn on() -> bool {
    ON.get()
}

/// Counts a question as settled.
#[inline]
pub(crate) fn settled(by: Stage) {
    SETTLED.with(|s| {
        let c = &s[by as usize];
        c.set(c.get() + 1);
    });
}

/// Counts a question as settled exactly, whether with the answer equal or zero, on integers of
/// so many bits.
pub(crate) fn settled_exactly(zero: bool, bits: u64) {
    settled(Stage::Exact);
    if zero {
        ZEROS.set(ZEROS.get() + 1);
    }
    BITS.set(BITS.get().max(bits));
}

/// What has been counted on this thread.
pub fn counts() -> Counts {
    let [names, doubles, wider, exact] = SETTLED.with(|s| [0, 1, 2, 3].map(|i| s[i].get()));
    Counts {
        names,
        doubles,
        wider,
        exact,
        zeros: ZEROS.get(),
        most_bits: BITS.get(),
    }
}

/// Forgets the most bits seen so far.
pub fn reset_bits() {
    BITS.set(0);
}

/// Runs `f` with the filter on or off on this thread, also out of a panic.
pub fn with_filter<T>(on: bool, f: impl FnOnce() -> T) -> T {
    struct Restore(bool);
    impl Drop for Restore {
        fn drop(&mut self) {
            ON.set(self.0);
        }
    }
    let _restore = Restore(ON.replace(on));
    f()
}
