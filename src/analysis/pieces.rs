//! The circle where some directions get out: its pieces between the flips.
//!
//! The class is settled then, and no proof can make it weaker or stronger. What a designer still
//! wants to see is which directions hold. So neighbouring single directions are compared, the
//! flips between them isolated, and of the pieces that are left those that block are proven as in
//! [`super::total`], as far as a smaller budget of work goes. A piece whose directions got out,
//! wherever they were tried, is listed as `none`: nothing is claimed of it, so nothing needs proof.

use super::classify::Verdict;
use super::total::{Arc, FLIPS, Sample, Search, simplest};
use crate::motion::OutcomeKind;
use crate::number::Rat;

/// What proofs may cost beside a way out: they decide no class.
const WORK: u64 = 200_000_000;

/// The narrowest piece that is halved, as a share of a quarter: 2 to minus this.
const DEPTH: u32 = 16;

/// The share of a quarter, 2 to minus this, past which no two neighbours are left untried.
const COARSE: u32 = 4;

fn share(power: u32) -> Rat {
    Rat::from(2).pow(power).recip()
}

impl Search<'_> {
    /// Replaces the cover, and the flips, by those of the pieces.
    pub(super) fn pieces(&mut self) {
        self.cover.clear();
        self.field.spent.set(0);
        self.field.allowed.set(WORK);
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
                verdict: k.verdict,
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
                    self.between(pair[0].clone(), pair[1].clone());
                }
                from = pair[1].s.clone();
            }
            if from < Rat::one() {
                self.put(quarter, &from, &Rat::one(), None, None);
            }
        }
    }

    /// Appends a piece; one that goes on as the piece before it is joined to that.
    fn put(
        &mut self,
        quarter: u8,
        from: &Rat,
        to: &Rat,
        verdict: Option<Verdict>,
        middle: Option<(OutcomeKind, Option<usize>)>,
    ) {
        if from >= to {
            return;
        }
        let joins = |a: &&mut Arc| {
            a.quarter == quarter && a.to == *from && a.verdict == verdict && a.middle == middle
        };
        if verdict.is_none_or(|v| v == Verdict::None)
            && let Some(last) = self.cover.last_mut().filter(joins)
        {
            last.to = to.clone();
            return;
        }
        self.cover.push(Arc {
            quarter,
            from: from.clone(),
            to: to.clone(),
            verdict,
            middle,
        });
    }

    /// The pieces between two decided directions of one quarter.
    fn between(&mut self, a: Sample, b: Sample) {
        let quarter = a.quarter;
        if &b.s - &a.s > share(COARSE) {
            let mid = Rat::midpoint(&a.s, &b.s);
            return self.parted(a, mid, b);
        }
        if a.verdict == b.verdict {
            return self.piece(a, b);
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
        self.piece(a, low_end.clone());
        self.put(quarter, &low_end.s, &high_end.s, None, None);
        if high_end.verdict == b.verdict {
            self.piece(high_end, b);
        } else {
            self.between(high_end, b);
        }
    }

    /// The pieces on both sides of a direction that is tried now.
    fn parted(&mut self, a: Sample, mid: Rat, b: Sample) {
        let quarter = a.quarter;
        match self.tried(quarter, &mid) {
            Some((verdict, _, (kind, _)))
                if verdict != Verdict::None || kind == OutcomeKind::Completed =>
            {
                let mid = Sample {
                    quarter,
                    s: mid,
                    verdict,
                };
                self.between(a, mid.clone());
                self.between(mid, b);
            }
            _ => self.put(quarter, &a.s, &b.s, None, None),
        }
    }

    /// A piece whose ends fare alike.
    fn piece(&mut self, a: Sample, b: Sample) {
        let (quarter, width) = (a.quarter, &b.s - &a.s);
        if width.sign() <= 0 {
            return;
        }
        if a.verdict == Verdict::None {
            let end = Some((OutcomeKind::Completed, None));
            return self.put(quarter, &a.s, &b.s, Some(Verdict::None), end);
        }
        let spent = self.field.spent.get() > WORK || width <= share(DEPTH);
        // A direction about the middle with few digits.
        let quarter_of_it = &width * &Rat::frac(1, 4);
        let mid = simplest(&(&a.s + &quarter_of_it), Some(&(&b.s - &quarter_of_it)));
        let met = if spent {
            None
        } else {
            self.tried(quarter, &mid)
        };
        let Some((verdict, time, middle)) = met else {
            return self.put(quarter, &a.s, &b.s, None, None);
        };
        let open = verdict == Verdict::None && middle.0 != OutcomeKind::Completed;
        if open {
            return self.put(quarter, &a.s, &b.s, None, Some(middle));
        }
        let mid = Sample {
            quarter,
            s: mid,
            verdict,
        };
        if verdict != a.verdict {
            self.between(a, mid.clone());
            return self.between(mid, b);
        }
        let arc = Arc {
            quarter,
            from: a.s.clone(),
            to: b.s.clone(),
            verdict: None,
            middle: Some(middle),
        };
        let depth = (0..DEPTH).find(|d| width >= share(*d)).unwrap_or(DEPTH);
        if let Some(proven) = self.prove(&arc, verdict, time, depth) {
            return self.put(quarter, &a.s, &b.s, Some(proven), Some(middle));
        }
        self.piece(a, mid.clone());
        self.piece(mid, b);
    }
}
