//! The forces along one trajectory: a pawl, a segment, a phase at a time.
//!
//! Peaks of single contacts come from [`super::peak`], those of the root, where the pawls add up,
//! from [`super::drive`]; here they are put together and written down.

use super::bound::{Bound, Unbounded};
use super::document::contact;
use super::drive::{Extremes, Slide, extremes, instant, trace};
use super::escape::Ground;
use super::fix::Bits;
use super::force_document::{
    Drawing, DrawnPhase, ForcesDocument, PawlForces, PawlSample, PeakDocument, PhaseForces,
    RootPeak, Sample, SegmentForces, When,
};
use super::forces::{Wish, reference};
use super::handbook::handbook;
use super::load::{Part, Rig};
use super::peak::{Instant, Peak, Peaked, force, higher, torque};
use super::stretch::{Stretch, stretches};
use super::work::{Work, work};
use crate::motion::{OutcomeKind, Trajectory};
use crate::number::{Algebraic, Rat};
use crate::report::Num;
use crate::report::words::{equals, short};
use crate::scene::{Motion, Scene};
use crate::slice::Time;
use std::cell::RefCell;
use std::collections::VecDeque;

/// One trajectory with its stretches.
pub(super) struct Way<'a> {
    scene: &'a Scene,
    run: &'a Trajectory,
    ground: &'a Ground<'a>,
    slid: Vec<Stretch>,
    /// The highest contact force of each stretch; None without a stiffness.
    peaks: Vec<Option<Peaked>>,
    /// One a pawl: with friction, and without.
    rigs: Vec<Option<[Rig; 2]>>,
    goal: u32,
    wish: &'a Wish,
    mu: Rat,
    clocks: Clocks,
}

/// The last irrational instants that were written, by phase.
type Clocks = RefCell<VecDeque<(usize, Algebraic, Num)>>;

/// How many instants are kept: those of a segment and its peak, and as many more.
const KEPT: usize = 6;

impl<'a> Way<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        ground: &'a Ground<'a>,
        run: &'a Trajectory,
        wish: &'a Wish,
    ) -> Way<'a> {
        let slid = stretches(scene, &ground.shapes, &ground.obstacles, run);
        let goal = (wish.digits.saturating_mul(10)).div_ceil(3) + 3;
        let mu = scene.friction.clone().unwrap_or_default();
        let at = reference(scene);
        let rigs = scene.pawls.iter().map(|p| {
            let rig = |mu: Rat| Rig {
                stiffness: p.stiffness.clone().unwrap_or_default(),
                mu,
                arm: &p.hinge - &at,
            };
            p.stiffness.as_ref()?;
            Some([rig(mu.clone()), rig(Rat::zero())])
        });
        Way {
            rigs: rigs.collect(),
            peaks: slid
                .iter()
                .map(|s| {
                    let k = scene.pawls[s.pawl].stiffness.as_ref()?;
                    Some(force(s, k, &mu, goal))
                })
                .collect(),
            scene,
            run,
            ground,
            slid,
            goal,
            wish,
            mu,
            clocks: RefCell::default(),
        }
    }

    /// An instant of a phase on the plan's clock. Neighbouring segments and their peaks share their
    /// instants, and an irrational one is dear to write: the last few are kept.
    fn clock(&self, phase: usize, t: &Time) -> Num {
        let from = &self.run.phases[phase].from;
        if let Some(t) = t.as_rat() {
            return Num::of_rat(&(from + t));
        }
        let mut kept = self.clocks.borrow_mut();
        let exact = t.exact();
        if let Some((.., num)) = kept
            .iter()
            .find(|(k, e, _)| *k == phase && e.same_handle(exact))
        {
            return num.clone();
        }
        let num = if from.is_zero() {
            Num::of(exact)
        } else {
            Num::of(&t.affine(from, &Rat::one()))
        };
        if kept.len() == KEPT {
            kept.pop_front();
        }
        kept.push_back((phase, exact.clone(), num.clone()));
        num
    }

    fn between(&self, phase: usize, a: &Rat, b: &Rat) -> When {
        let from = &self.run.phases[phase].from;
        if a == b {
            return When::At(Num::of_rat(&(from + a)));
        }
        let [a, b] = super::bound::rounded(a, b, self.wish.digits.max(6));
        When::Between {
            lo: (from + &a).to_string(),
            hi: (from + &b).to_string(),
        }
    }

    fn when(&self, phase: usize, i: &Instant) -> When {
        match i {
            Instant::At(t) => When::At(self.clock(phase, t)),
            Instant::Between(a, b) => self.between(phase, a, b),
        }
    }

    /// Whether pawl i ended the motion: its force then grows past every bound.
    fn ended(&self, i: usize) -> bool {
        let end = &self.run.outcome;
        matches!(end.kind, OutcomeKind::Jammed | OutcomeKind::Stuck) && end.pawl == Some(i)
    }

    pub(super) fn pawls(&self, doc: &mut ForcesDocument) {
        let digits = self.wish.digits;
        let mut overall: Option<(PeakDocument, Peak, Peak)> = None;
        for (i, pawl) in self.run.pawls.iter().enumerate() {
            let mut out = PawlForces {
                name: pawl.name.clone(),
                peak: None,
                segments: Vec::new(),
            };
            let Some(k) = &self.scene.pawls[i].stiffness else {
                doc.pawls.push(out);
                continue;
            };
            let mut best: Option<(Peaked, usize)> = None;
            let mut turned = Peak::zero();
            for (j, segment) in pawl.segments.iter().enumerate() {
                let Some(sliding) = &segment.sliding else {
                    continue;
                };
                let (mut push, mut twist) = (None, Peak::zero());
                let mut smooth: Option<Peaked> = None;
                let mut beside = None;
                for (s, p) in self.slid.iter().zip(&self.peaks) {
                    if s.pawl != i || s.segment != j {
                        continue;
                    }
                    let Some(p) = p else { continue };
                    push = Some(higher(push, p.clone()));
                    if self.wish.smooth && self.mu.sign() > 0 {
                        smooth = Some(higher(smooth, force(s, k, &Rat::zero(), self.goal)));
                    }
                    let t = torque(s, k, self.goal).peak;
                    if self.wish.handbook && t != Peak::zero() {
                        beside = handbook(s, k, &self.mu, digits).or(beside);
                    }
                    twist = twist.max(t);
                }
                let Some(mut push) = push else {
                    continue;
                };
                let end = &self.run.outcome;
                if self.ended(i) && segment.phase == end.phase && segment.to == end.time {
                    push = Peaked {
                        peak: Peak::Unbounded,
                        when: Instant::At(segment.to.clone()),
                    };
                }
                out.segments.push(SegmentForces {
                    from: self.clock(segment.phase, &segment.from),
                    to: self.clock(segment.phase, &segment.to),
                    phase: segment.phase,
                    contact: contact(self.scene, &sliding.contact),
                    force: Bound::of(&push.peak, digits),
                    force_without_friction: smooth.map(|p| Bound::of(&p.peak, digits)),
                    torque: Bound::of(&twist, digits),
                    time: self.when(segment.phase, &push.when),
                    handbook: beside,
                });
                turned = turned.max(twist);
                best = Some(match best {
                    None => (push, segment.phase),
                    Some((b, phase)) => {
                        let first = exceeds(&b.peak, &push.peak);
                        let phase = if first { phase } else { segment.phase };
                        (higher(Some(b), push), phase)
                    }
                });
            }
            if self.ended(i) && best.as_ref().is_none_or(|b| b.0.peak != Peak::Unbounded) {
                let held = Peaked {
                    peak: Peak::Unbounded,
                    when: Instant::At(self.run.outcome.time.clone()),
                };
                best = Some((held, self.run.outcome.phase));
            }
            let (push, phase) = best.unwrap_or((
                Peaked {
                    peak: Peak::zero(),
                    when: Instant::At(Time::from(Rat::zero())),
                },
                0,
            ));
            let peak = PeakDocument {
                force: Bound::of(&push.peak, digits),
                torque: Bound::of(&turned, digits),
                time: self.when(phase, &push.when),
                pawl: pawl.name.clone(),
            };
            out.peak = Some(peak.clone());
            doc.pawls.push(out);
            overall = Some(match overall {
                None => (peak, push.peak, turned),
                Some((old, force, torque)) => {
                    let first = exceeds(&force, &push.peak);
                    let shown = if first { old } else { peak };
                    (shown, force.max(push.peak), torque.max(turned))
                }
            });
        }
        doc.peak = overall.map(|(p, force, torque)| PeakDocument {
            force: Bound::of(&force, digits),
            torque: Bound::of(&torque, digits),
            ..p
        });
    }

    /// The slides of one phase, with friction or without.
    fn slides(&self, phase: usize, smooth: bool) -> Vec<Slide<'_>> {
        let mut out = Vec::new();
        // Only the root's search asks how high each force goes.
        let searched = self.wish.root;
        for (s, p) in self.slid.iter().zip(&self.peaks) {
            let Some(rig) = self.rigs[s.pawl].as_ref().filter(|_| s.phase == phase) else {
                continue;
            };
            let rig = &rig[usize::from(smooth)];
            let k = &rig.stiffness;
            let peak = if !searched {
                None
            } else if smooth && self.mu.sign() > 0 {
                Some(force(s, k, &rig.mu, 16).peak)
            } else {
                p.as_ref().map(|p| p.peak.clone())
            };
            let bound = match peak {
                Some(Peak::Within(_, hi)) => Some(hi),
                _ => None,
            };
            let grows = p.as_ref().is_some_and(|p| p.peak == Peak::Unbounded);
            let unbounded = grows && rig.mu.sign() > 0;
            for part in Part::cut(s, rig.mu.sign() > 0) {
                out.push(Slide {
                    part,
                    rig,
                    bound: bound.clone(),
                    unbounded,
                });
            }
        }
        out
    }

    /// The largest resistance of a phase.
    pub(super) fn resistance(&self, k: usize) -> Peak {
        let stop = || self.ground.late();
        extremes(&self.slides(k, false), self.goal, &stop).resistance
    }

    pub(super) fn phase(&self, k: usize, drawing: &mut Drawing) -> PhaseForces {
        let digits = self.wish.digits;
        let phase = &self.run.phases[k];
        let end = &self.run.outcome;
        let here = end.phase == k;
        let wish = self.wish;
        let stop = || self.ground.late();
        let rubbed = self.slides(k, false);
        let high = wish.root.then(|| {
            let mut high = extremes(&rubbed, self.goal, &stop);
            let by = end.pawl.filter(|i| here && self.ended(*i));
            if by.is_some_and(|i| self.rigs[i].is_some()) {
                // Held for good: no force moves it on.
                high.resistance = Peak::Unbounded;
                high.force = Peak::Unbounded;
                high.torque = Peak::Unbounded;
            }
            high
        });
        let rubs = self.mu.sign() > 0;
        let smooth = if rubs {
            self.slides(k, true)
        } else {
            Vec::new()
        };
        let without =
            (rubs && wish.root && wish.smooth).then(|| extremes(&smooth, self.goal, &stop));
        let bound = |w: [Rat; 2]| Bound::within(&w[0], &w[1], digits);
        let spent = |slides: &[Slide<'_>]| {
            let each = slides.iter().map(|s| work(s, self.goal, &stop));
            each.fold(Work::zero(), Work::plus)
        };
        let done = wish.work.then(|| spent(&rubbed));
        let work_note = done.as_ref().and_then(|w| self.work_note(k, w));
        let written = |w: Work| match w {
            Work::Within(w) => Some(bound(w)),
            Work::Unbounded(_) => Some(Bound::Unbounded(Unbounded::Unbounded)),
            Work::Open => None,
        };
        if self.wish.draw {
            drawing.phases.push(self.drawn(k, &rubbed, &smooth));
        }
        PhaseForces {
            phase: Some(k),
            from: Num::of_rat(&phase.from),
            to: self.clock(k, &phase.to),
            outcome: if here { end.kind.name() } else { "completed" },
            velocity: [
                Num::of_rat(&phase.velocity.x),
                Num::of_rat(&phase.velocity.y),
            ],
            peak: high.map(|e| self.root_peak(k, &e)),
            peak_without_friction: without.map(|e| self.root_peak(k, &e)),
            work: done.and_then(written),
            work_note,
            work_without_friction: (rubs && wish.work && wish.smooth)
                .then(|| spent(&smooth))
                .and_then(written),
            lost_in_snaps: wish.work.then(|| bound(self.lost(k))),
            history: self.history(k, &rubbed, &smooth),
        }
    }

    /// Why the work of a phase has no bound, or is not told.
    fn work_note(&self, k: usize, w: &Work) -> Option<String> {
        match w {
            Work::Within(_) => None,
            Work::Unbounded(t) => Some(format!(
                "the work grows past every bound towards t {}: there the contact reaches the \
                 edge of its sticking cone with the spring wound, the force grows like one over \
                 the distance left, and so the work like its logarithm",
                equals(&self.clock(k, t))
            )),
            Work::Open => Some("not settled within the search's budget or the time".to_owned()),
        }
    }

    fn root_peak(&self, phase: usize, e: &Extremes) -> RootPeak {
        let of = |p: &Peak| Bound::of(p, self.wish.digits);
        let when = e.when.as_ref();
        RootPeak {
            resistance: of(&e.resistance),
            help: of(&e.help),
            force: of(&e.force),
            torque: of(&e.torque),
            time: when.map(|[a, b]| self.between(phase, a, b)),
        }
    }

    /// Spring energy that snaps set free: ½k(θ² before − θ² after).
    fn lost(&self, phase: usize) -> [Rat; 2] {
        let b = Bits(u64::from(self.goal) + 48);
        let mut sum = b.int(0);
        for (pawl, rig) in self.run.pawls.iter().zip(&self.rigs) {
            let Some([rig, _]) = rig else { continue };
            for e in pawl.events.iter().filter(|e| e.phase == phase) {
                let Some(to) = &e.to else { continue };
                let energy = |a: &crate::motion::Angle| {
                    let (lo, hi) = a.x.enclosure(b.0 as u32);
                    let t = super::peak::theta(&b.hull(&lo, &hi), a.half_turn, b);
                    t.mul(&t).mul(&b.rat(&(&rig.stiffness / &Rat::from(2))))
                };
                sum = sum.add(&energy(&e.angle).sub(&energy(to)));
            }
        }
        [sum.lo(), sum.hi()]
    }

    fn history(&self, k: usize, rubbed: &[Slide<'_>], smooth: &[Slide<'_>]) -> Vec<Sample> {
        let digits = self.wish.digits;
        let b = Bits(u64::from(self.goal) + 48);
        let phase = &self.run.phases[k];
        let length = match phase.to.as_rat() {
            Some(t) => t.clone(),
            None => phase.to.exact().enclosure(64).0,
        };
        if length.is_zero() {
            return Vec::new();
        }
        let n = i64::from(self.wish.samples);
        (1..=n)
            .filter_map(|i| {
                let t = &length * &Rat::frac(2 * i - 1, 2 * n);
                let now = instant(rubbed, &t, b)?;
                let free = instant(smooth, &t, b).filter(|_| !smooth.is_empty());
                let of = |f: &super::fix::Fix| Bound::of_fix(f, digits);
                let pawls = now.pawls.iter().map(|(i, angle, force)| {
                    let slide = &rubbed[*i];
                    PawlSample {
                        pawl: self.run.pawls[slide.part.stretch.pawl].name.clone(),
                        theta: of(angle),
                        torque: of(&angle.mul(&b.rat(&slide.rig.stiffness))),
                        force: of(force),
                    }
                });
                Some(Sample {
                    time: Num::of_rat(&(&phase.from + &t)),
                    pawls: pawls.collect(),
                    force: now.force.each_ref().map(of),
                    torque: of(&now.torque),
                    resistance: of(&now.resistance),
                    resistance_without_friction: free.map(|f| of(&f.resistance)),
                })
            })
            .collect()
    }

    fn drawn(&self, k: usize, rubbed: &[Slide<'_>], smooth: &[Slide<'_>]) -> DrawnPhase {
        let phase = &self.run.phases[k];
        let speed = phase.velocity.norm2().nearest_f64().unwrap_or(0.0).sqrt();
        let travel = |runs: Vec<Vec<[f64; 2]>>| -> Vec<Vec<[f64; 2]>> {
            let scaled = |run: Vec<[f64; 2]>| run.iter().map(|p| [p[0] * speed, p[1]]).collect();
            runs.into_iter().map(scaled).collect()
        };
        let end = &self.run.outcome;
        let stopped = end.phase == k && end.pawl.is_some_and(|i| self.ended(i));
        let to = phase.to.interval().hi;
        let handbook = self.slid.iter().filter(|s| s.phase == k).filter_map(|s| {
            let stiffness = self.scene.pawls[s.pawl].stiffness.as_ref()?;
            let h = handbook(s, stiffness, &self.mu, 6)?;
            let at = s.t[usize::from(h.late)].interval().hi;
            Some([at * speed, h.formula?.approx()])
        });
        DrawnPhase {
            name: format!(
                "root moved by ({}, {}){}",
                short(&Num::of_rat(&phase.velocity.x)),
                short(&Num::of_rat(&phase.velocity.y)),
                if end.phase == k && end.kind != OutcomeKind::Completed {
                    format!(", {}", end.kind.name())
                } else {
                    String::new()
                }
            ),
            length: to * speed,
            back: self.scene.motions.get(k) == Some(&Motion::Reverse),
            handbook: handbook.collect(),
            rubbed: travel(trace(rubbed, 40)),
            smooth: travel(trace(smooth, 40)),
            unbounded: stopped.then_some(to * speed),
        }
    }
}

/// Whether `higher` keeps the instant of the first of two peaks.
fn exceeds(a: &Peak, b: &Peak) -> bool {
    match (a, b) {
        (Peak::Unbounded, _) => true,
        (_, Peak::Unbounded) => false,
        (Peak::Within(x, _), Peak::Within(y, _)) => x >= y,
    }
}
