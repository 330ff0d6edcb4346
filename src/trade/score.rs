//! How far a result is from the reference.

use crate::motion::{EventKind, OutcomeKind, Trajectory};
use crate::number::Rat;
use crate::report::theta::theta;

/// One thing that happened to a pawl.
#[derive(Clone, Debug, PartialEq)]
pub struct Happening {
    /// Kind and contacts; what must agree for two happenings to be one.
    pub what: String,
    /// The coarse kind that time stepping can tell, if it can.
    pub coarse: Option<&'static str>,
    /// On the clock of the whole plan.
    pub time: f64,
    /// Orientation in radians.
    pub theta: f64,
}

/// A whole result, as far as it is compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Observed {
    /// How it ended.
    pub outcome: OutcomeKind,
    /// Which pawl ended it.
    pub pawl: Option<usize>,
    /// Per pawl, in order.
    pub events: Vec<Vec<Happening>>,
}

/// What a trajectory shows; None where it is undecided.
pub fn observe(t: &Trajectory) -> Option<Observed> {
    if t.outcome.kind == OutcomeKind::Undecided {
        return None;
    }
    let trace = |p: &crate::motion::PawlTrace| {
        p.events
            .iter()
            .filter(|e| !matches!(e.kind, EventKind::PhaseEnd | EventKind::PlanEnd))
            .map(|e| Happening {
                what: format!("{} {:?}", e.kind.name(), e.contacts),
                coarse: coarse(e.kind),
                time: clock(&t.phases[e.phase].from, &e.time),
                theta: theta(e.angle.half_turn, &e.angle.x),
            })
            .collect()
    };
    Some(Observed {
        outcome: t.outcome.kind,
        pawl: t.outcome.pawl,
        events: t.pawls.iter().map(trace).collect(),
    })
}

fn clock(from: &Rat, local: &crate::slice::Time) -> f64 {
    let t = local.affine(from, &Rat::one());
    t.nearest_f64().unwrap_or(f64::INFINITY)
}

fn coarse(kind: EventKind) -> Option<&'static str> {
    match kind {
        EventKind::TranslationalCollision => Some("strike"),
        EventKind::Release => Some("release"),
        EventKind::SnapFree | EventKind::SnapFreeVertex => Some("snap"),
        _ => None,
    }
}

/// What became of the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The outcome is that of the reference.
    Right,
    /// It is another.
    Wrong,
    /// There is none: a limit was reached.
    Undecided,
    /// There is none: it broke down.
    Broken,
}

/// A result against the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// The verdict.
    pub verdict: Verdict,
    /// Events of the reference that are missing.
    pub missed: usize,
    /// Events that the reference does not have.
    pub spurious: usize,
    /// The worst error of a matched time, in units of the last place of the right one.
    pub time_ulps: f64,
    /// The worst error of a matched orientation, likewise.
    pub angle_ulps: f64,
    /// The worst error of a matched time.
    pub time_error: f64,
}

/// Compares a result with the reference; `coarsely` where only strikes, releases and snaps can be
/// told.
pub fn score(reference: &Observed, got: Option<&Observed>, broke: bool, coarsely: bool) -> Score {
    let mut s = Score {
        verdict: Verdict::Undecided,
        missed: 0,
        spurious: 0,
        time_ulps: 0.0,
        angle_ulps: 0.0,
        time_error: 0.0,
    };
    let Some(got) = got else {
        if broke {
            s.verdict = Verdict::Broken;
        }
        return s;
    };
    let same = reference.outcome == got.outcome && reference.pawl == got.pawl;
    s.verdict = if same { Verdict::Right } else { Verdict::Wrong };
    for (a, b) in reference.events.iter().zip(&got.events) {
        let keep = |h: &&Happening| !coarsely || h.coarse.is_some();
        let a: Vec<&Happening> = a.iter().filter(keep).collect();
        let b: Vec<&Happening> = b.iter().filter(keep).collect();
        let alike = |x: &Happening, y: &Happening| {
            if coarsely {
                x.coarse == y.coarse
            } else {
                x.what == y.what
            }
        };
        let pairs = align(&a, &b, &alike);
        s.missed += a.len() - pairs.len();
        s.spurious += b.len() - pairs.len();
        for (i, j) in pairs {
            s.time_ulps = s.time_ulps.max(ulps(a[i].time, b[j].time));
            s.angle_ulps = s.angle_ulps.max(ulps(a[i].theta, b[j].theta));
            s.time_error = s.time_error.max((a[i].time - b[j].time).abs());
        }
    }
    s
}

/// The longest common subsequence.
fn align(
    a: &[&Happening],
    b: &[&Happening],
    alike: &dyn Fn(&Happening, &Happening) -> bool,
) -> Vec<(usize, usize)> {
    let (n, m) = (a.len(), b.len());
    let mut best = vec![vec![0usize; m + 1]; n + 1];
    for i in (0..n).rev() {
        for j in (0..m).rev() {
            best[i][j] = if alike(a[i], b[j]) {
                best[i + 1][j + 1] + 1
            } else {
                best[i + 1][j].max(best[i][j + 1])
            };
        }
    }
    let (mut i, mut j, mut out) = (0, 0, Vec::new());
    while i < n && j < m {
        if alike(a[i], b[j]) {
            out.push((i, j));
            i += 1;
            j += 1;
        } else if best[i + 1][j] >= best[i][j + 1] {
            i += 1;
        } else {
            j += 1;
        }
    }
    out
}

/// |got − right| in units of the last place of `right`; of 2⁻⁵² where `right` is zero, which has
/// no scale of its own.
pub fn ulps(right: f64, got: f64) -> f64 {
    if right == got {
        return 0.0;
    }
    if !right.is_finite() || !got.is_finite() {
        return f64::INFINITY;
    }
    let unit = if right == 0.0 {
        f64::EPSILON
    } else {
        right.abs().next_up() - right.abs()
    };
    (got - right).abs() / unit
}

/// The 95 % Wilson score interval of a rate (Wilson 1927). (0, 1) for no trials.
pub fn wilson(hits: usize, trials: usize) -> (f64, f64) {
    if trials == 0 {
        return (0.0, 1.0);
    }
    let z = 1.959_963_984_540_054;
    let (n, p) = (trials as f64, hits as f64 / trials as f64);
    let centre = p + z * z / (2.0 * n);
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z * z / n;
    (
        ((centre - half) / scale).max(0.0),
        ((centre + half) / scale).min(1.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_as_published() {
        // Newcombe (1998), Statistics in Medicine 17, table I: 81/263, 15/148, 0/20, 1/29.
        for (r, n, lo, hi) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let (a, b) = wilson(r, n);
            assert!((a - lo).abs() < 6e-5 && (b - hi).abs() < 6e-5, "{r}/{n}");
        }
    }

    #[test]
    fn units_in_the_last_place() {
        assert_eq!(ulps(1.0, 1.0 + f64::EPSILON), 1.0);
        assert_eq!(ulps(-4.0, -4.0), 0.0);
        assert_eq!(ulps(0.0, 2f64.powi(-50)), 4.0);
        assert_eq!(ulps(1.0, f64::NAN), f64::INFINITY);
    }
}
