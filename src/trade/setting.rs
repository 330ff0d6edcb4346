//! The settings that are compared.

use super::score::{Observed, observe};
use super::step;
use crate::kernel::{FloatOptions, Identify};
use crate::motion::{Arithmetic, Options, Trajectory, simulate};
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// One way to simulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// A kernel.
    Kernel(Arithmetic),
    /// Time stepping in doubles, with so many steps over the whole plan.
    Stepping(u32),
}

/// What a setting made of a scene.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What happened; None where it gave up or broke down.
    pub observed: Option<Observed>,
    /// Seconds of this thread's CPU, reading and printing apart.
    pub seconds: f64,
    /// By how much the resident memory peaked above what it was, KiB; where the system tells.
    pub memory: Option<u64>,
    /// The trajectory, where there is one.
    pub trajectory: Option<Trajectory>,
    /// Whether it broke down: an internal error, possible where doubles decide.
    pub broke: bool,
}

impl Setting {
    /// The double kernel with a tolerance and safeguards.
    pub fn float(tolerance: f64, identify: Identify) -> Setting {
        Setting::Kernel(Arithmetic::F64(FloatOptions {
            tolerance,
            identify,
        }))
    }
    /// The usual comparison at a tolerance.
    pub fn usual(tolerance: f64) -> Vec<Setting> {
        let mut all = vec![
            Setting::Kernel(Arithmetic::Filtered),
            Setting::Kernel(Arithmetic::Exact),
        ];
        all.extend(
            [Identify::Names, Identify::Times, Identify::None]
                .map(|i| Setting::float(tolerance, i)),
        );
        all.extend([100, 1_000, 10_000].map(Setting::Stepping));
        all
    }
    /// Its name in tables.
    pub fn name(&self) -> String {
        match self {
            Setting::Kernel(Arithmetic::F64(o)) => match o.identify {
                Identify::None => "f64 none".to_owned(),
                Identify::Times => "f64 times".to_owned(),
                Identify::Names => "f64 names".to_owned(),
            },
            Setting::Kernel(a) => a.name().to_owned(),
            Setting::Stepping(n) => format!("stepping {n}"),
        }
    }
    /// Simulates a scene; gives up after `limit`.
    pub fn run(&self, scene: &Scene, limit: Duration) -> Outcome {
        let memory = Peak::start();
        let clock = cpu_seconds();
        let deadline = Instant::now().checked_add(limit);
        let work = || match self {
            Setting::Kernel(arithmetic) => {
                let options = Options {
                    deadline,
                    arithmetic: *arithmetic,
                    ..Options::default()
                };
                simulate(scene, &options).ok().map(Ok)
            }
            Setting::Stepping(steps) => step::simulate(scene, *steps, deadline).map(Err),
        };
        let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work));
        let seconds = cpu_seconds() - clock;
        let memory = memory.and_then(Peak::growth);
        let broke = done.is_err();
        let (trajectory, stepped) = match done.ok().flatten() {
            Some(Ok(t)) => (Some(t), None),
            Some(Err(o)) => (None, Some(o)),
            None => (None, None),
        };
        let observed = stepped.or_else(|| trajectory.as_ref().and_then(observe));
        Outcome {
            observed,
            seconds,
            memory,
            trajectory,
            broke,
        }
    }
}

/// Seconds of CPU that this thread has used.
fn cpu_seconds() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

/// The peak of the resident memory, which Linux lets a process reset and read.
struct Peak(u64);

impl Peak {
    fn start() -> Option<Peak> {
        std::fs::write("/proc/self/clear_refs", "5").ok()?;
        read("VmRSS:").map(Peak)
    }
    fn growth(self) -> Option<u64> {
        Some(read("VmHWM:")?.saturating_sub(self.0))
    }
}

fn read(key: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with(key))?;
    line.split_ascii_whitespace().nth(1)?.parse().ok()
}
