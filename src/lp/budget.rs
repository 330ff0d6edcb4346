//! Limits on time and memory, asked for everywhere and obeyed within a fraction of a second.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What a solve is at, to be looked at from another thread while it runs.
#[derive(Debug, Default)]
pub struct Meter {
    stage: AtomicU8,
    count: AtomicU64,
}

/// The stages of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Scaling,
    Simplex,
    Interior,
    Exact,
}

impl Meter {
    /// A line for people: the stage and how far it has come.
    pub fn line(&self) -> String {
        let count = self.count.load(Ordering::Relaxed);
        match self.stage.load(Ordering::Relaxed) {
            1 => format!("floating point: simplex method, iteration {count}"),
            2 => "floating point: interior point".to_string(),
            3 => format!("exact: after pivot {count}"),
            _ => "scaling".to_string(),
        }
    }
}

/// What a computation may use, and where it reports. Counting starts when it is made.
#[derive(Clone, Debug)]
pub(crate) struct Budget {
    deadline: Option<Instant>,
    bytes: u64,
    meter: Option<Arc<Meter>>,
}

/// A limit was reached; nothing is decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Exhausted;

impl Budget {
    pub(crate) fn new(
        time: Option<Duration>,
        bytes: Option<u64>,
        meter: Option<Arc<Meter>>,
    ) -> Budget {
        Budget {
            deadline: time.and_then(|t| Instant::now().checked_add(t)),
            bytes: bytes.unwrap_or(u64::MAX),
            meter,
        }
    }

    /// The same with only three quarters of the time that is left, for a stage whose result takes
    /// time to make use of.
    pub(crate) fn most(&self) -> Budget {
        let now = Instant::now();
        Budget {
            deadline: self.left().and_then(|t| now.checked_add(t / 4 * 3)),
            ..self.clone()
        }
    }

    /// Notes the stage for whoever watches.
    pub(crate) fn report(&self, stage: Stage, count: u64) {
        if let Some(meter) = &self.meter {
            meter.stage.store(stage as u8, Ordering::Relaxed);
            meter.count.store(count, Ordering::Relaxed);
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
