//! `--time-limit` for work that does not ask the clock by itself: a thread does it, and the verb goes on
//! without it when the time is up. Ending the process ends the thread.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// As much as a main thread has, several times over; pages that are not used cost nothing.
const STACK: usize = 64 << 20;

/// What the work yields, or None where the limit came first.
pub(crate) fn within<T: Send + 'static>(
    limit: Option<Duration>,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<Option<T>, String> {
    let Some(limit) = limit else {
        return Ok(Some(work()));
    };
    if limit.is_zero() {
        return Ok(None);
    }
    let (done, answer) = channel();
    let worker = std::thread::Builder::new()
        .stack_size(STACK)
        .spawn(move || {
            // Nobody waits any more once the time is up.
            let _ = done.send(work());
        })
        .map_err(|e| format!("--time-limit: no thread to work on: {e}"))?;
    match answer.recv_timeout(limit) {
        Ok(found) => Ok(Some(found)),
        Err(RecvTimeoutError::Timeout) => Ok(None),
        Err(RecvTimeoutError::Disconnected) => match worker.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => unreachable!("it sends before it ends"),
        },
    }
}
