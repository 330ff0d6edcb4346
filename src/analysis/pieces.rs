//! The circle where some directions get out: its pieces between the flips.
//!
//! The class is settled then, and no proof can make it weaker or stronger. What a designer still
//! wants to see is which directions hold. So neighbouring single directions are compared, the
//! flips between them isolated, and of the pieces that are left those that block are proven as in
//! [`super::total`], the widest first, as far as a smaller budget of work goes. A piece whose directions got out,
//! wherever they were tried, is listed as `none`; at last each is tried to be proven open, as a whole or by
//! halves, as far as a budget of work goes, and says whether it is.
//! Where neighbours get out by different courses more directions between them are tried, lest a
//! narrow piece that holds be passed over.

use super::classify::Verdict;
use super::total::{Arc, FLIPS, Flip, Met, Sample, Search, simplest};
use crate::motion::OutcomeKind;
use crate::number::Rat;

/// What proofs may cost beside a way out, all together and one alone: they decide no class.
const WORK: u64 = 30_000_000;
const PROOF: u64 = WORK / 10;

/// The narrowest piece that is halved, as a share of a quarter: 2 to minus this.
const DEPTH: u32 = 16;

/// The widest piece that is tried to be proven open, and the narrowest that is halved for it.
const LEAST_HALVED: u32 = 3;
const OPEN: u32 = 9;

/// The share of a quarter, 2 to minus this, past which no two neighbours are left untried.
const COARSE: u32 = 4;

/// The same where ways out of different courses are neighbours, and how many directions may be
/// tried in all to come to that.
const FINE: u32 = 9;
const TRIED: usize = 600;

fn share(power: u32) -> Rat {
    Rat::from(2).pow(power).recip()
}

/// A piece whose ends fare alike, not proven yet.
struct Pending {
    width: Rat,
    ends: [Sample; 2],
}

impl Pending {
    fn new(a: Sample, b: Sample) -> Pending {
        Pending {
            width: &b.s - &a.s,
            ends: [a, b],
        }
    }
}

impl Search<'_> {
    /// Replaces the cover, and the flips, by those of the pieces.
    pub(super) fn pieces(&mut self) {
        self.cover.clear();
        self.field.spent.set(0);
        let mut pending: Vec<Pending> = Vec::new();
        self.samples
            .sort_by(|a, b| (a.quarter, &a.s).cmp(&(b.quarter, &b.s)));
        let known = self.samples.clone();
        for quarter in 0..4 {
            let next = (quarter + 1) % 4;
            let mut knots: Vec<Sample> = known
                .iter()
                .filter(|k| k.quarter == quarter)
                .cloned()
                .collect();
            let end = known.iter().find(|k| k.quarter == next && k.s.is_zero());
            knots.extend(end.map(|k| Sample {
                quarter,
                s: Rat::one(),
                ..k.clone()
            }));
            let mut from = Rat::zero();
            if knots.first().is_none_or(|k| k.s.sign() > 0) {
                // The quarter's first direction is open: so is what follows it.
                let to = knots.first().map_or_else(Rat::one, |k| k.s.clone());
                self.put(quarter, &from, &to, None, None);
                from = to;
            }
            for pair in knots.windows(2) {
                if pair[0].s < pair[1].s {
                    self.between(pair[0].clone(), pair[1].clone(), &mut pending);
                }
                from = pair[1].s.clone();
            }
            if from < Rat::one() {
                self.put(quarter, &from, &Rat::one(), None, None);
            }
        }
        // Kept by width: the last is the widest.
        pending.sort_by(|a, b| a.width.cmp(&b.width));
        while let Some(next) = pending.pop() {
            let [a, b] = next.ends;
            let mut more = Vec::new();
            self.piece(a, b, &mut more);
            for m in more {
                let at = pending.partition_point(|p| p.width <= m.width);
                pending.insert(at, m);
            }
        }
        self.joined();
        self.opened();
        self.joined();
        self.flips.sort_by(|a, b| {
            let at = |f: &Flip| (f.sides[0].quarter, f.sides[0].s.clone());
            at(a).cmp(&at(b))
        });
    }

    /// Proves arcs of `none` open, as a whole or by halves, the widest first.
    fn opened(&mut self) {
        self.field.spent.set(0);
        self.field.allowed.set(WORK);
        let (mut left, rest): (Vec<Arc>, Vec<Arc>) = std::mem::take(&mut self.cover)
            .into_iter()
            .partition(|a| a.verdict == Some(Verdict::None));
        self.cover = rest;
        let width = |a: &Arc| &a.to - &a.from;
        left.sort_by_key(width);
        while let Some(mut arc) = left.pop() {
            let wide = width(&arc);
            arc.open = wide <= share(LEAST_HALVED) && self.prove_open(&arc);
            let done = arc.open || wide <= share(OPEN) || self.field.spent.get() >= WORK;
            if done || self.ground.late() {
                self.cover.push(arc);
                continue;
            }
            let mid = Rat::midpoint(&arc.from, &arc.to);
            let (mut low, mut high) = (arc.clone(), arc);
            low.to = mid.clone();
            high.from = mid;
            for half in [low, high] {
                let at = left.partition_point(|p| width(p) <= width(&half));
                left.insert(at, half);
            }
        }
    }

    /// Puts the arcs in order, and joins neighbours of which the same is said.
    fn joined(&mut self) {
        let mut arcs = std::mem::take(&mut self.cover);
        arcs.sort_by(|a, b| (a.quarter, &a.from).cmp(&(b.quarter, &b.from)));
        for arc in arcs {
            let alike = |a: &&mut Arc| {
                let claims = a.verdict.is_some_and(|v| v != Verdict::None);
                let same = a.verdict == arc.verdict && a.open == arc.open;
                let same = same && a.middle == arc.middle;
                !claims && same && a.quarter == arc.quarter && a.to == arc.from
            };
            match self.cover.last_mut().filter(alike) {
                Some(last) => last.to = arc.to,
                None => self.cover.push(arc),
            }
        }
    }

    /// Adds a piece, if there is anything of it.
    fn put(
        &mut self,
        quarter: u8,
        from: &Rat,
        to: &Rat,
        verdict: Option<Verdict>,
        middle: Option<(OutcomeKind, Option<usize>)>,
    ) {
        if from < to {
            self.cover.push(Arc {
                quarter,
                from: from.clone(),
                to: to.clone(),
                verdict,
                open: false,
                middle,
            });
        }
    }

    /// The pieces between two decided directions of one quarter.
    fn between(&mut self, a: Sample, b: Sample, pending: &mut Vec<Pending>) {
        let quarter = a.quarter;
        if &b.s - &a.s > share(COARSE) {
            let mid = Rat::midpoint(&a.s, &b.s);
            return self.parted(a, mid, b, pending);
        }
        if a.verdict == b.verdict {
            return pending.push(Pending::new(a, b));
        }
        if self.flips.len() >= FLIPS || self.ground.late() {
            return self.put(quarter, &a.s, &b.s, None, None);
        }
        let flip = self.isolate(a.clone(), b.clone());
        let [low, high] = flip.sides.clone();
        self.flips.push(flip);
        // A side that gets out takes the gap, in which nothing is claimed then.
        let (mut low_end, mut high_end) = (low, high);
        match (low_end.verdict, high_end.verdict) {
            (Verdict::None, _) => low_end.s = high_end.s.clone(),
            (_, Verdict::None) => high_end.s = low_end.s.clone(),
            _ => {}
        }
        pending.push(Pending::new(a, low_end.clone()));
        self.put(quarter, &low_end.s, &high_end.s, None, None);
        self.between(high_end, b, pending);
    }

    /// A direction that is tried now; None where it is open or the time is up.
    fn decided(&mut self, quarter: u8, s: &Rat) -> Option<(Sample, Met)> {
        let met = self.tried(quarter, s)?;
        // What is open leaves no sample.
        if met.0 == Verdict::None && met.2.0 != OutcomeKind::Completed {
            return None;
        }
        Some((self.samples.last()?.clone(), met))
    }

    /// The pieces on both sides of a direction that is tried now.
    fn parted(&mut self, a: Sample, mid: Rat, b: Sample, pending: &mut Vec<Pending>) {
        let quarter = a.quarter;
        match self.decided(quarter, &mid) {
            Some((mid, _)) => {
                self.between(a, mid.clone(), pending);
                self.between(mid, b, pending);
            }
            None => self.put(quarter, &a.s, &b.s, None, None),
        }
    }

    /// A piece whose ends fare alike.
    fn piece(&mut self, a: Sample, b: Sample, pending: &mut Vec<Pending>) {
        let (quarter, width) = (a.quarter, &b.s - &a.s);
        if width.sign() <= 0 {
            return;
        }
        let free = a.verdict == Verdict::None;
        let end = free.then_some((OutcomeKind::Completed, None));
        let known = free.then_some(Verdict::None);
        let spent = if free {
            // Ways out of one course have nothing between them that one of them would not meet,
            // most likely; else a narrow obstacle may lie there.
            a.course == b.course || width <= share(FINE) || self.samples.len() > TRIED
        } else {
            self.field.spent.get() >= WORK || width <= share(DEPTH)
        };
        if spent {
            return self.put(quarter, &a.s, &b.s, known, end);
        }
        // A direction about the middle with few digits.
        let quarter_of_it = &width * &Rat::frac(1, 4);
        let mid = simplest(&(&a.s + &quarter_of_it), Some(&(&b.s - &quarter_of_it)));
        let Some((mid, (verdict, time, middle))) = self.decided(quarter, &mid) else {
            return self.put(quarter, &a.s, &b.s, known, end);
        };
        if verdict != a.verdict {
            self.between(a, mid.clone(), pending);
            return self.between(mid, b, pending);
        }
        if free {
            pending.push(Pending::new(a, mid.clone()));
            return pending.push(Pending::new(mid, b));
        }
        let arc = Arc {
            quarter,
            from: a.s.clone(),
            to: b.s.clone(),
            verdict: None,
            open: false,
            middle: Some(middle),
        };
        let depth = (0..DEPTH).find(|d| width >= share(*d)).unwrap_or(DEPTH);
        let allowed = self.field.spent.get() + PROOF;
        self.field.allowed.set(allowed.min(WORK));
        if let Some(proven) = self.prove(&arc, verdict, time, depth) {
            return self.put(quarter, &a.s, &b.s, Some(proven), Some(middle));
        }
        pending.push(Pending::new(a, mid.clone()));
        pending.push(Pending::new(mid, b));
    }
}
