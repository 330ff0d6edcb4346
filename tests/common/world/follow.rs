//! The free interval that holds the state, followed through a phase by brute force.
//!
//! From one instant to the next the component is kept by a path inside free space: stay at an
//! orientation c a little inside the interval, translate, and take the interval around c then.
//! Where that fails, or anything looks like an event, the step is halved, down to a step so short
//! that what is left is the event itself. Nothing is known here of curves or of their ends.

use super::oracle::{World, f};
use snapfit::contact::Contact;
use snapfit::number::Rat;
use std::f64::consts::TAU;

/// The shortest step: events are found to within this part of a phase.
pub const SHORTEST: f64 = 1.0 / (1u64 << 30) as f64;
/// A leap of the near end within the shortest step that counts as a snap.
pub const LEAP: f64 = 2e-3;
/// How well doubles know an orientation at which a vertex only just reaches an edge.
pub const BLUR: f64 = 5e-8;

#[derive(Clone, Debug)]
pub struct Leap {
    pub t: f64,
    pub from: f64,
    pub to: f64,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum How {
    Jammed,
    Stuck,
    Bifurcated,
}

/// What a phase is predicted to bring.
#[derive(Debug)]
pub struct Forecast {
    /// θ at the end of each accepted step.
    pub path: Vec<(f64, f64)>,
    pub snaps: Vec<Leap>,
    pub end: Option<(How, f64)>,
    /// From here on the oracle itself cannot tell what follows, and why.
    pub doubt: Option<(f64, &'static str)>,
}

#[derive(Clone, Debug)]
struct State {
    t: f64,
    theta: f64,
    /// The interval, either end possibly infinite.
    lo: f64,
    hi: f64,
    /// What touches at θ; empty at rest.
    held: Vec<Contact>,
    /// 0 at rest, 1 where the lower end holds, −1 where the upper end does.
    side: i32,
    /// Whether rest was well inside the interval.
    roomy: bool,
    /// The greatest width so far.
    widest: f64,
    /// The side on which alone rest had room, last time it had room on one side only, and when.
    lean: (i32, f64),
}

pub struct Follower<'a> {
    w: &'a World,
    mu: Option<f64>,
    out: Forecast,
    budget: usize,
}

enum Step {
    Done(State),
    Over,
}

impl Follower<'_> {
    /// Follows a pawl from θ₀ through the phase in at least `steps` steps.
    pub fn run(w: &World, mu: Option<&Rat>, theta0: f64, steps: usize) -> Forecast {
        let mut me = Follower {
            w,
            mu: mu.map(f).filter(|m| *m > 0.0),
            budget: 20 * steps + 4000,
            out: Forecast {
                path: Vec::new(),
                snaps: Vec::new(),
                end: None,
                doubt: None,
            },
        };
        let dt = w.duration / steps as f64;
        let Some(mut s) = me.start(theta0) else {
            return me.out;
        };
        while s.t < w.duration * (1.0 - 1e-12) {
            let step = dt.min(w.duration - s.t);
            match me.step(s, step) {
                Step::Done(next) => s = next,
                Step::Over => break,
            }
        }
        me.out
    }

    fn start(&mut self, theta0: f64) -> Option<State> {
        let w = self.w;
        let h = w.duration * SHORTEST;
        // Free gaps whose closure holds θ₀, just after the start; an end may have run as far as
        // the root of the time that has passed.
        let reach = |me: &Self, h: f64| {
            let mut found: Vec<(f64, f64)> = Vec::new();
            for d in [0.0, 1e-5, -1e-5, 3e-7, -3e-7, 1e-4, -1e-4, 1e-3, -1e-3] {
                if let Some(i) = me.interval(h, theta0 + d)
                    && i.0 <= theta0 + LEAP / 2.0
                    && i.1 >= theta0 - LEAP / 2.0
                    && !found.iter().any(|k| (k.0 - i.0).abs() < 1e-9 || k.0 == i.0)
                {
                    found.push(i);
                }
            }
            found
        };
        let found = reach(self, h);
        if found.len() > 1 {
            let later: Vec<State> = reach(self, 1e3 * h)
                .into_iter()
                .map(|i| self.clamp(1e3 * h, i.0, i.1))
                .collect();
            // Rest itself stays free: it never was struck.
            if theta0 == 0.0
                && let Some(s) = later.iter().find(|s| s.side == 0)
            {
                self.out.path.push((s.t, 0.0));
                return Some(s.clone());
            }
            let both = later.len() == 2 && later[0].side * later[1].side < 0;
            if theta0.abs() < 1e-6 && both {
                let stuck: Vec<_> = later.iter().map(|s| self.sticks(s)).collect();
                if self.mu.is_none() || stuck.iter().all(Option::is_some) {
                    let held = stuck.iter().all(|x| *x == Some(true));
                    let how = if held { How::Stuck } else { How::Bifurcated };
                    self.out.end = Some((how, 0.0));
                    return None;
                }
            }
            self.out.doubt = Some((0.0, "starts between two intervals"));
            return None;
        }
        let Some(&(lo, hi)) = found.first() else {
            self.out.end = Some((How::Jammed, 0.0));
            // A gap that opens from a point is thinner than any of the offsets above: look finely.
            let opens = |t: f64| {
                (-400..=400).any(|k| {
                    self.interval(t, theta0 + f64::from(k) * LEAP / 800.0)
                        .is_some()
                })
            };
            if [1e2, 1e4, 1e6]
                .iter()
                .any(|k| !reach(self, k * h).is_empty() || opens(k * h))
            {
                self.out.doubt = Some((0.0, "a narrow start"));
            }
            return None;
        };
        let s = self.clamp(h, lo, hi);
        if (s.theta - theta0).abs() > LEAP {
            self.out.snaps.push(Leap {
                t: 0.0,
                from: theta0,
                to: s.theta,
            });
        }
        self.out.path.push((s.t, s.theta));
        if self.sticks(&s) == Some(true) {
            self.out.end = Some((How::Stuck, 0.0));
            return None;
        }
        Some(s)
    }

    /// The free interval around c at time t; None if c is not well inside one.
    fn interval(&self, t: f64, c: f64) -> Option<(f64, f64)> {
        let w = self.w;
        let crit = w.criticals(t);
        if crit.is_empty() {
            return w.free(t, c).then_some((f64::NEG_INFINITY, f64::INFINITY));
        }
        let n = crit.len() as i64;
        // Critical orientations on the covering line.
        let at = |k: i64| crit[k.rem_euclid(n) as usize].theta + TAU * k.div_euclid(n) as f64;
        let turns = (c / TAU).round() as i64;
        let mut k = crit.partition_point(|x| x.theta + TAU * turns as f64 <= c) as i64 + turns * n;
        while at(k) <= c {
            k += 1;
        }
        while at(k - 1) > c {
            k -= 1;
        }
        let tiny = 1e-11;
        if at(k) - at(k - 1) < 4.0 * tiny || c - at(k - 1) < tiny || at(k) - c < tiny {
            return None;
        }
        if !w.free(t, (at(k) + at(k - 1)) / 2.0) {
            return None;
        }
        let (mut lo, mut hi) = (k - 1, k);
        let open = |a: f64, b: f64| b - a < tiny || w.free(t, (a + b) / 2.0);
        // A cluster of critical orientations is crossed only into a gap that is free.
        let mut j = hi;
        while j - lo < n + 1 && open(at(j), at(j + 1)) {
            if at(j + 1) - at(j) >= tiny {
                hi = j + 1;
            }
            j += 1;
        }
        if j - lo > n {
            return Some((f64::NEG_INFINITY, f64::INFINITY));
        }
        let mut j = lo;
        while open(at(j - 1), at(j)) {
            if at(j) - at(j - 1) >= tiny {
                lo = j - 1;
            }
            j -= 1;
        }
        Some((at(lo), at(hi)))
    }

    /// Whether the pawl can translate at orientation c from t0 to t1.
    fn glides(&self, c: f64, t0: f64, t1: f64) -> bool {
        let mut cuts = self.w.crossings_at(c, t0, t1);
        cuts.push(t1);
        let mut from = t0;
        for t in cuts {
            if t - from > 1e-15 * self.w.duration && !self.w.free((t + from) / 2.0, c) {
                return false;
            }
            from = t;
        }
        true
    }

    /// The state in an interval: the point nearest to rest, with what holds it.
    fn clamp(&self, t: f64, lo: f64, hi: f64) -> State {
        let (theta, side) = if lo > BLUR {
            (lo, 1)
        } else if hi < -BLUR {
            (hi, -1)
        } else {
            (0.0, 0)
        };
        let mut held = Vec::new();
        if side != 0 {
            for c in self.w.criticals(t) {
                let d = super::oracle::principal(c.theta - theta);
                if d.abs() < 1e-9 {
                    held.push(c.contact);
                }
            }
        }
        State {
            t,
            theta,
            lo,
            hi,
            held,
            side,
            roomy: lo < -BLUR && hi > BLUR,
            widest: hi - lo,
            lean: (i32::from(lo > -1e-5) - i32::from(hi < 1e-5), t),
        }
    }

    /// The states that can be reached by a step of dt, nearest to the near end first.
    fn advance(&self, s: &State, dt: f64) -> Vec<State> {
        let t = s.t + dt;
        let go = |c: f64| -> Option<State> {
            if !self.glides(c, s.t, t) {
                return None;
            }
            let (lo, hi) = self.interval(t, c)?;
            Some(self.clamp(t, lo, hi))
        };
        let widths = |width: f64| {
            let w = width.min(TAU) / 2.0;
            (0..=24).rev().map(move |k| w * 0.5f64.powi(k))
        };
        if s.side > 0 {
            return widths(s.hi - s.theta)
                .find_map(|d| go(s.theta + d))
                .into_iter()
                .collect();
        }
        if s.side < 0 {
            return widths(s.theta - s.lo)
                .find_map(|d| go(s.theta - d))
                .into_iter()
                .collect();
        }
        if s.roomy
            && let Some(n) = go(0.0)
        {
            return vec![n];
        }
        let up = widths(s.hi).filter(|d| *d > 1e-10).find_map(&go);
        let down = widths(-s.lo).filter(|d| *d > 1e-10).find_map(|d| go(-d));
        let mut out: Vec<State> = Vec::new();
        out.extend(up);
        if let Some(n) = down
            && !out.iter().any(|m| m.lo == n.lo || m.hi == n.hi)
        {
            out.push(n);
        }
        out
    }

    /// Whether friction holds the state: Some(true) or Some(false) where every contact says so.
    fn sticks(&self, s: &State) -> Option<bool> {
        let mu = self.mu?;
        if s.side == 0 {
            return Some(false);
        }
        let mut verdicts = s.held.iter().map(|c| match c {
            Contact::Limit(_) => Some(false),
            _ => self.w.balance(s.t, s.theta, *c, mu).map(|g| g < -1e-9),
        });
        let first = verdicts.next()??;
        verdicts.all(|v| v == Some(first)).then_some(first)
    }

    fn step(&mut self, s: State, dt: f64) -> Step {
        let short = dt <= self.w.duration * SHORTEST;
        self.budget = self.budget.saturating_sub(1);
        if self.budget == 0 {
            self.out.doubt = Some((s.t, "too many steps"));
            return Step::Over;
        }
        let next = self.advance(&s, dt);
        if !short {
            let smooth = next.len() == 1 && {
                let n = &next[0];
                n.side == s.side
                    && (n.theta - s.theta).abs() < 0.03
                    && (s.side == 0 || n.held.iter().any(|c| s.held.contains(c)))
                    && (self.mu.is_none() || self.sticks(n) == Some(false))
            };
            if smooth {
                let n = next.into_iter().next().unwrap();
                return self.accept(&s, n);
            }
            return match self.step(s, dt / 2.0) {
                Step::Done(m) => self.step(m, dt / 2.0),
                Step::Over => Step::Over,
            };
        }
        let at = s.t + dt / 2.0;
        let n = match next.len() {
            0 => {
                self.out.end = Some((How::Jammed, at));
                return Step::Over;
            }
            1 => next.into_iter().next().unwrap(),
            _ => {
                // Long enough for both ways to leave rest by more than doubles blur.
                let next = self.advance(&s, dt * 1024.0);
                let parted = |n: &State| n.side != 0 && n.theta.abs() < 10.0 * LEAP;
                if next.len() != 2 || !next.iter().all(parted) {
                    self.out.doubt = Some((s.t, "splits beside rest"));
                    return Step::Over;
                }
                let stuck: Vec<Option<bool>> = next.iter().map(|n| self.sticks(n)).collect();
                let how = if stuck.iter().all(|x| *x == Some(true)) {
                    How::Stuck
                } else {
                    How::Bifurcated
                };
                if self.mu.is_some() && stuck.iter().any(Option::is_none) {
                    self.out.doubt = Some((s.t, "friction between several contacts"));
                }
                self.out.end = Some((how, at));
                return Step::Over;
            }
        };
        if (n.theta - s.theta).abs() > LEAP {
            let away = n.theta.abs() > s.theta.abs() && n.theta * s.theta >= 0.0;
            if away {
                // What is left of the interval lies past the state: a jam, never a move away.
                self.out.end = Some((How::Jammed, at));
                return Step::Over;
            }
            self.out.snaps.push(Leap {
                t: at,
                from: s.theta,
                to: n.theta,
            });
        }
        self.out.path.push((n.t, n.theta));
        if self.mu.is_some() {
            // At a vertex two contacts touch: what counts is the one that is followed next.
            let after = || {
                let later = self.advance(&n, dt * 1024.0);
                later.first().and_then(|m| self.sticks(m))
            };
            match self.sticks(&n).or_else(after) {
                Some(true) => {
                    self.out.end = Some((How::Stuck, at));
                    return Step::Over;
                }
                Some(false) => {}
                None => {
                    self.out.doubt = Some((s.t, "friction in doubt"));
                    return Step::Over;
                }
            }
        }
        self.out.path.pop();
        self.accept(&s, n)
    }

    /// Takes a step, unless the interval closed to a point on the way as far as doubles can tell.
    fn accept(&mut self, s: &State, mut n: State) -> Step {
        let (was, is) = (s.hi - s.lo, n.hi - n.lo);
        if was < 4.0 * BLUR && s.widest > 100.0 * BLUR && is > was {
            self.out.doubt = Some((s.t, "a pinch"));
            return Step::Over;
        }
        // At rest where the room changes sides at once: the two parts meet in a point only, and
        // doubles cannot tell whether rest went from one to the other.
        if n.lean.0 == 0 || n.side != 0 {
            n.lean = s.lean;
        } else if n.lean.0 == -s.lean.0 && n.t - s.lean.1 < 1e3 * SHORTEST * self.w.duration {
            self.out.doubt = Some((s.lean.1, "the room at rest changes sides"));
            return Step::Over;
        }
        n.widest = is.max(s.widest);
        self.out.path.push((n.t, n.theta));
        Step::Done(n)
    }
}
