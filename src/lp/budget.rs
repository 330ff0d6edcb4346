//! Limits on time and memory, asked for everywhere and obeyed within a fraction of a second.

use std::time::{Duration, Instant};

/// What a computation may use. Cheap to copy; counting starts when it is made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    deadline: Option<Instant>,
    bytes: u64,
}

/// A limit was reached; nothing is decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Exhausted;

impl Budget {
    pub(crate) fn new(time: Option<Duration>, bytes: Option<u64>) -> Budget {
        Budget {
            deadline: time.and_then(|t| Instant::now().checked_add(t)),
            bytes: bytes.unwrap_or(u64::MAX),
        }
    }

    /// Err once the time is over.
    pub(crate) fn check(&self) -> Result<(), Exhausted> {
        match self.deadline {
            Some(d) if Instant::now() >= d => Err(Exhausted),
            _ => Ok(()),
        }
    }

    /// Err where one structure would take more than the memory allowed.
    pub(crate) fn allow(&self, bytes: u64) -> Result<(), Exhausted> {
        if bytes > self.bytes {
            Err(Exhausted)
        } else {
            Ok(())
        }
    }

    /// Time left, if it is limited.
    pub(crate) fn left(&self) -> Option<Duration> {
        self.deadline
            .map(|d| d.saturating_duration_since(Instant::now()))
    }
}
