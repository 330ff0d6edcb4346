//! A spinner on standard error for work that takes a while.

use super::output;
use indicatif::{ProgressBar, ProgressStyle};
use snapfit::lp::Meter;
use snapfit::lp::cli::{LpArgs, run_lp};
use snapfit::motion::plan::Progress;
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long work may take before anything is shown.
const PATIENCE: Duration = Duration::from_millis(500);

/// Shows what the engine is at, from half a second on; gone when dropped.
pub(crate) struct Spinner {
    news: Option<Sender<String>>,
    thread: Option<JoinHandle<()>>,
}

impl Spinner {
    pub(crate) fn start() -> Spinner {
        let (news, inbox) = channel::<String>();
        let thread = std::thread::spawn(move || {
            let begin = std::time::Instant::now();
            let mut message = String::from("reading");
            loop {
                match inbox.recv_timeout(PATIENCE.saturating_sub(begin.elapsed())) {
                    Ok(text) => message = text,
                    Err(RecvTimeoutError::Timeout) => break,
                    Err(RecvTimeoutError::Disconnected) => return,
                }
            }
            let bar = ProgressBar::new_spinner();
            if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(100));
            bar.set_message(message);
            for text in inbox {
                bar.set_message(text);
            }
            bar.finish_and_clear();
        });
        Spinner {
            news: Some(news),
            thread: Some(thread),
        }
    }

    pub(crate) fn tell(&self, p: Progress) {
        let (phase, pawl) = (p.phase, p.pawl);
        self.say(format!(
            "phase {phase} of {}, pawl {pawl}: {} arcs",
            p.phases, p.arcs
        ));
    }

    pub(crate) fn say(&self, text: String) {
        if let Some(news) = &self.news {
            let _ = news.send(text);
        }
    }
}

/// Runs the verb `lp` with a spinner that follows what it is at.
pub(crate) fn solving(args: &LpArgs) -> u8 {
    let meter = Arc::new(Meter::default());
    if args.quiet || !std::io::stderr().is_terminal() {
        return run_lp(args, &meter, &output::write);
    }
    let spinner = Spinner::start();
    let (done, ending) = channel::<()>();
    let news = spinner.news.clone();
    let watched = meter.clone();
    let follower = std::thread::spawn(move || {
        while let Err(RecvTimeoutError::Timeout) = ending.recv_timeout(PATIENCE / 2) {
            if let Some(news) = &news {
                let _ = news.send(watched.line());
            }
        }
    });
    let status = run_lp(args, &meter, &output::write);
    drop(done);
    let _ = follower.join();
    status
}

impl Drop for Spinner {
    fn drop(&mut self) {
        self.news.take();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
