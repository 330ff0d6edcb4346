//! Every direction of the circle, certified.
//!
//! The paper thinks a decision over all directions impractical and offers sampling. Here the
//! circle is cut into arcs. An exact motion in the middle of an arc says what to prove and about
//! when; the proof for the whole arc is that of `cells`, which follows every successor in
//! certified intervals. An arc that resists is halved, down to a bound on depth and time. One exact
//! way out settles the class, which is then `none`; what the rest of the circle does is told all
//! the same, and of the arcs that get out those are proven that can be (`pieces`).

use super::classify::{Direction, Verdict, direction};
use super::escape::{Ground, Start};
use super::field::{Directions, Field, Grain, Model};
use crate::geometry::Vec2;
use crate::motion::{EventKind, OutcomeKind};
use crate::number::{Int, Rat};
use crate::scene::Scene;
use crate::slice::Time;
use std::hash::{DefaultHasher, Hash, Hasher};

/// An arc of directions: from the quarter-turn `quarter` on, tan(φ/2) from `from` to `to`, in
/// [0, 1].
#[derive(Clone, Debug)]
pub struct Arc {
    /// Which quarter of the circle, counted from the direction of x.
    pub quarter: u8,
    /// Begin, as the tangent of half the angle into the quarter.
    pub from: Rat,
    /// End.
    pub to: Rat,
    /// What is known of the arc: every direction of it is blocked at least so firmly, proven; or,
    /// with `Verdict::None`, every direction of it that was tried gets out. None where nothing is
    /// known.
    pub verdict: Option<Verdict>,
    /// Of an arc of `Verdict::None`: whether every direction of it is proven to get out.
    pub open: bool,
    /// How the exact motion in its middle ends, and by which pawl.
    pub middle: Option<(OutcomeKind, Option<usize>)>,
}

/// One direction, decided exactly.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Which quarter of the circle.
    pub quarter: u8,
    /// tan(φ/2) into the quarter.
    pub s: Rat,
    /// How firmly it is blocked.
    pub verdict: Verdict,
    /// What its motion meets, contact by contact: two motions alike in this differ in times only.
    pub(super) course: u64,
}

/// Where the exact verdict changes: between two directions 2⁻⁶⁰ apart at most.
#[derive(Clone, Debug)]
pub struct Flip {
    /// Both sides, counter-clockwise.
    pub sides: [Sample; 2],
    /// A short direction between them with its verdict, where there is one: the critical
    /// direction itself, most likely.
    pub critical: Option<(Vec2, Verdict)>,
}

impl Arc {
    /// A quarter of the circle, of which nothing is known.
    fn whole(quarter: u8) -> Arc {
        Arc {
            quarter,
            from: Rat::zero(),
            to: Rat::one(),
            verdict: None,
            open: false,
            middle: None,
        }
    }
    /// The unit vector at position s of a quarter.
    pub fn unit(quarter: u8, s: &Rat) -> Vec2 {
        let (one, s2) = (Rat::one(), s.square());
        let d = &one + &s2;
        let (c, s) = ((&one - &s2) / &d, (s + s) / &d);
        match quarter % 4 {
            0 => Vec2::new(c, s),
            1 => Vec2::new(-s, c),
            2 => Vec2::new(-c, -s),
            _ => Vec2::new(s, -c),
        }
    }
    /// Both ends as unit vectors.
    pub fn ends(&self) -> [Vec2; 2] {
        [
            Arc::unit(self.quarter, &self.from),
            Arc::unit(self.quarter, &self.to),
        ]
    }
    /// Its angle in radians, rounded up: 2(arctan to − arctan from) ≤ 2(to − from).
    pub fn width(&self) -> f64 {
        let w = &self.to - &self.from;
        (&w + &w).interval().hi
    }
    fn middle(&self) -> Rat {
        Rat::midpoint(&self.from, &self.to)
    }
    fn directions(&self) -> Directions {
        // Cosine and sine are monotone within a quarter.
        let [a, b] = self.ends();
        [
            a.x.interval().hull(&b.x.interval()),
            a.y.interval().hull(&b.y.interval()),
        ]
    }
}

/// The verdict on the whole circle.
#[derive(Debug)]
pub struct Total {
    /// The weakest verdict met; None if time ran out before any.
    pub class: Option<Verdict>,
    /// The arcs, in order round the circle.
    pub cover: Vec<Arc>,
    /// A direction that gets out.
    pub escape: Option<Vec2>,
    /// Where the verdict of single directions flips.
    pub flips: Vec<Flip>,
    /// The single directions that were decided, in order round the circle.
    pub samples: Vec<Sample>,
    /// The distance run.
    pub distance: Rat,
    /// Radians of directions that are not proven to be at least as firmly blocked as `class`.
    pub undecided_width: f64,
}

/// A distance past which the root and the pawls are clear of the obstacles in any direction: the
/// sum of the sides of a box round everything.
pub fn clear_distance(scene: &Scene, start: &Start) -> Rat {
    let mut points: Vec<Vec2> = Vec::new();
    for o in &scene.obstacles {
        points.extend(o.vertices.iter().cloned());
    }
    if let Some(r) = &scene.root {
        points.extend(r.vertices.iter().map(|p| p + &start.offset));
    }
    for p in &scene.pawls {
        let hinge = &p.hinge + &start.offset;
        let reach = p.vertices.iter().map(|v| {
            let d = v - &p.hinge;
            d.x.abs() + d.y.abs()
        });
        let reach = reach.max().unwrap_or_default();
        points.push(&hinge + &Vec2::new(reach.clone(), reach.clone()));
        points.push(&hinge - &Vec2::new(reach.clone(), reach));
    }
    let span = |f: fn(&Vec2) -> &Rat| {
        let (lo, hi) = (points.iter().map(f).min(), points.iter().map(f).max());
        lo.zip(hi).map_or_else(Rat::one, |(a, b)| b - a)
    };
    span(|p| &p.x) + span(|p| &p.y)
}

/// A unit of length in which doubles hold a scene of this size: 1 if they do anyway.
fn unit(distance: &Rat) -> Rat {
    let [n, d] = [distance.numer(), distance.denom()].map(Int::bits);
    let two = Rat::from(2);
    match u32::try_from(n.abs_diff(d)) {
        Ok(e) if e > 100 && n > d => two.pow(e).recip(),
        Ok(e) if e > 100 => two.pow(e),
        _ => Rat::one(),
    }
}

/// The most directions that are decided by themselves for a cover: a scene whose arcs nowhere
/// prove would else ask for a quarter of a million.
const MOST_SAMPLES: usize = 20_000;

/// How often an arc may be halved: a quarter's 2⁻¹⁶ is about 10⁻⁵ radians.
const DEPTH: u32 = 16;

/// Decides every direction. `family` are directions to look at first: they run as far as all
/// others here, however short the way was over which they were decided before.
pub fn total(ground: &Ground<'_>, start: &Start, family: &[Vec2]) -> Total {
    let scene = ground.scene;
    let asked = scene
        .classify
        .as_ref()
        .and_then(|c| c.escape_distance.clone());
    let distance = asked.unwrap_or_else(|| clear_distance(scene, start));
    let unit = unit(&distance);
    let mut search = Search {
        ground,
        start,
        distance2: distance.square(),
        distance: (&distance * &unit).interval().lo,
        field: Field::new(ground, start, &unit),
        unit,
        weakest: None,
        cover: Vec::new(),
        escape: None,
        samples: Vec::new(),
        flips: Vec::new(),
    };
    search.run(family);
    if search.escape.is_some() {
        search.pieces();
    }
    if search.cover.is_empty() {
        // The time was up before any proof.
        search.cover = (0..4).map(Arc::whole).collect();
    }
    search
        .samples
        .sort_by(|a, b| (a.quarter, &a.s).cmp(&(b.quarter, &b.s)));
    search
        .samples
        .dedup_by(|a, b| (a.quarter, &a.s) == (b.quarter, &b.s));
    if search.escape.is_none() {
        search.between_samples();
    }
    let class = search.weakest;
    let escape = search.escape;
    // Nothing is weaker than a way out.
    let undecided_width = search
        .cover
        .iter()
        .filter(|a| escape.is_none() && (a.verdict.is_none() || a.verdict < class))
        .map(Arc::width)
        .fold(0.0, |a, b| a + b);
    Total {
        class,
        cover: search.cover,
        escape,
        flips: search.flips,
        samples: search.samples,
        distance,
        undecided_width,
    }
}

/// How many flips are isolated; also how many edges, and how many arcs that resist, have their own
/// direction tried.
pub(super) const FLIPS: usize = 32;

/// The verdict of a direction, the time at which it is blocked, how and by whom.
pub(super) type Met = (Verdict, f64, (OutcomeKind, Option<usize>));

/// The events of a direction's motion with their contacts, in order, without their times.
fn course(d: &Direction) -> u64 {
    let mut hash = DefaultHasher::new();
    for pawl in &d.run.pawls {
        for e in pawl.events.iter().filter(|e| e.kind != EventKind::Graze) {
            (e.kind, &e.contacts).hash(&mut hash);
        }
        u8::MAX.hash(&mut hash);
    }
    hash.finish()
}

/// The fraction with the least denominator strictly between 0 ≤ a < b (None: no upper end).
pub(super) fn simplest(a: &Rat, b: Option<&Rat>) -> Rat {
    let whole = Rat::from(a.numer().div_rem_floor(a.denom()).0);
    let next = &whole + &Rat::one();
    match b {
        Some(b) if next >= *b => {
            // Both ends share the integer part: go on with the reciprocals of what is left.
            let low = a - &whole;
            let up = (b - &whole).recip();
            let rest = simplest(&up, (!low.is_zero()).then(|| low.recip()).as_ref());
            whole + rest.recip()
        }
        _ => next,
    }
}

/// A direction strictly inside an arc with a slope of few digits.
fn short_direction(quarter: u8, from: &Rat, to: &Rat) -> Vec2 {
    // Into its quarter the slope 2s/(1 − s²) grows from 0; near the end its reciprocal is short.
    let one = Rat::one();
    let steep = |s: &Rat| (s + s) / (&one - &s.square());
    let flat = |s: &Rat| (&one - &s.square()) / (s + s);
    let (x, y) = if *to < Rat::frac(1, 2) {
        (Rat::one(), simplest(&steep(from), Some(&steep(to))))
    } else if from.sign() > 0 {
        (simplest(&flat(to), Some(&flat(from))), Rat::one())
    } else {
        (Rat::one(), Rat::one())
    };
    match quarter % 4 {
        0 => Vec2::new(x, y),
        1 => Vec2::new(-y, x),
        2 => Vec2::new(-x, -y),
        _ => Vec2::new(y, -x),
    }
}

pub(super) struct Search<'a> {
    pub(super) ground: &'a Ground<'a>,
    pub(super) start: &'a Start,
    pub(super) distance2: Rat,
    /// In the field's unit, as all double times here.
    distance: f64,
    unit: Rat,
    pub(super) field: Field,
    pub(super) weakest: Option<Verdict>,
    pub(super) cover: Vec<Arc>,
    pub(super) escape: Option<Vec2>,
    pub(super) samples: Vec<Sample>,
    pub(super) flips: Vec<Flip>,
}

impl Search<'_> {
    /// One direction by itself, over the whole distance.
    fn decide(&self, w: &Vec2) -> Direction {
        direction(self.ground, self.start, w, &self.distance2, false)
    }

    /// Notes a verdict: the circle is as firm as the weakest.
    fn met(&mut self, verdict: Verdict) {
        self.weakest = Some(self.weakest.map_or(verdict, |w| w.min(verdict)));
    }

    fn run(&mut self, family: &[Vec2]) {
        // Coarse samples first: most ways out are wide. A narrow one is most likely along an edge.
        let coarse = 8;
        for quarter in 0..4 {
            for k in 0..coarse {
                let s = Rat::frac(k, coarse);
                if self.tried(quarter, &s).is_none() {
                    return;
                }
            }
        }
        if self.escape.is_some() {
            return;
        }
        for w in family.iter().cloned().chain(self.edges()) {
            if self.ground.late() {
                return;
            }
            let d = self.decide(&w);
            if d.open {
                continue;
            }
            self.met(d.verdict);
            if d.verdict == Verdict::None {
                self.escape = Some(w);
                return;
            }
        }
        for quarter in 0..4 {
            self.cover_arc(Arc::whole(quarter), 0);
            if self.escape.is_some() {
                return;
            }
        }
        // What resists is most likely a critical direction: a short one inside is decided by
        // itself.
        let open: Vec<Arc> = self
            .cover
            .iter()
            .filter(|a| a.verdict.is_none())
            .cloned()
            .collect();
        for arc in open.iter().take(FLIPS) {
            let w = short_direction(arc.quarter, &arc.from, &arc.to);
            let d = self.decide(&w);
            if self.ground.late() {
                return;
            }
            if !d.open {
                self.met(d.verdict);
                if d.verdict == Verdict::None {
                    self.escape = Some(w);
                    return;
                }
            }
        }
    }

    /// The directions along the obstacles' edges, both ways.
    fn edges(&self) -> Vec<Vec2> {
        let mut out: Vec<Vec2> = Vec::new();
        for ring in self.ground.obstacles.iter().flat_map(|o| &o.rings) {
            for n in &ring.normals {
                let along = Vec2::new(-&n.y, n.x.clone());
                let known = out.iter().any(|w| w.cross(&along).is_zero());
                if !known && out.len() < FLIPS {
                    out.push(along);
                }
            }
        }
        let back: Vec<Vec2> = out.iter().map(|w| -w).collect();
        out.extend(back);
        out
    }

    /// Isolates the flips between neighbouring samples.
    fn between_samples(&mut self) {
        let n = self.samples.len();
        for i in 0..n {
            let (a, b) = (self.samples[i].clone(), self.samples[(i + 1) % n].clone());
            // Within one quarter, its end included.
            let end = match (b.quarter + 4 - a.quarter) % 4 {
                0 if b.s > a.s => b.s.clone(),
                1 if b.s.is_zero() => Rat::one(),
                _ => continue,
            };
            if a.verdict != b.verdict && self.flips.len() < FLIPS {
                let quarter = a.quarter;
                let high = Sample {
                    quarter,
                    s: end,
                    ..b
                };
                let flip = self.isolate(a, high);
                self.flips.push(flip);
            }
        }
    }

    /// Two directions of one quarter with different verdicts, brought together: what the later
    /// one's verdict is may change on the way.
    pub(super) fn isolate(&self, mut low: Sample, mut high: Sample) -> Flip {
        let width = Rat::from(2).pow(60).recip();
        while &high.s - &low.s > width {
            let s = Rat::midpoint(&low.s, &high.s);
            let w = Arc::unit(low.quarter, &s);
            let d = self.decide(&w);
            if d.open || self.ground.late() {
                break;
            }
            let mid = Sample {
                quarter: low.quarter,
                s,
                verdict: d.verdict,
                course: course(&d),
            };
            if mid.verdict == low.verdict {
                low = mid;
            } else {
                high = mid;
            }
        }
        let few = |w: &Vec2| {
            let bits = [&w.x, &w.y].map(|c| (c.numer().bits(), c.denom().bits()));
            bits[0].1 + bits[1].0 < 48 && bits[0].0 + bits[1].1 < 48
        };
        let between = short_direction(low.quarter, &low.s, &high.s);
        // Else one of the sides is, at the end of a quarter.
        let sides = [&low, &high].map(|k| (Arc::unit(k.quarter, &k.s), k.verdict));
        let critical = if few(&between) {
            let d = self.decide(&between);
            Some((between, d.verdict))
        } else {
            sides.into_iter().find(|(w, _)| few(w))
        };
        Flip {
            sides: [low, high],
            critical,
        }
    }

    /// The verdict of one direction with the time at which it is blocked; None if it gets out, or
    /// the time is up.
    fn sample(&mut self, quarter: u8, s: &Rat) -> Option<Met> {
        let met = self.tried(quarter, s)?;
        match (met.0, met.2.0) {
            (Verdict::None, OutcomeKind::Completed) => None,
            _ => Some(met),
        }
    }

    /// How one direction fares; None where the time is up. What is not blocked and does not run
    /// its length either is open.
    pub(super) fn tried(&mut self, quarter: u8, s: &Rat) -> Option<Met> {
        if self.ground.late() {
            return None;
        }
        let w = Arc::unit(quarter, s);
        let d = self.decide(&w);
        let end = (d.run.outcome.kind, d.run.outcome.pawl);
        if d.open {
            // A force that cannot be told from the limit is open as well.
            let kind = match end.0 {
                OutcomeKind::Completed => OutcomeKind::Undecided,
                kind => kind,
            };
            return Some((Verdict::None, self.distance, (kind, end.1)));
        }
        self.samples.push(Sample {
            quarter,
            s: s.clone(),
            verdict: d.verdict,
            course: course(&d),
        });
        self.met(d.verdict);
        if d.verdict == Verdict::None {
            self.escape.get_or_insert(w);
            return Some((Verdict::None, self.distance, end));
        }
        let time = match (&d.peak, d.verdict) {
            (Some((p, _)), Verdict::Force) => match &p.when {
                super::peak::Instant::At(t) => self.in_unit(t),
                super::peak::Instant::Between(_, t) => (t * &self.unit).interval().hi,
            },
            _ => self.in_unit(&d.run.outcome.time),
        };
        Some((d.verdict, time, end))
    }

    /// An instant of a motion at unit speed, rounded up.
    fn in_unit(&self, t: &Time) -> f64 {
        if self.unit == Rat::one() {
            return t.interval().hi;
        }
        t.affine(&Rat::zero(), &self.unit).interval().hi
    }

    /// Covers an arc, whole where it is proven and else by halves, unless a way out is met.
    fn cover_arc(&mut self, mut arc: Arc, depth: u32) {
        if self.escape.is_some() {
            return;
        }
        if self.samples.len() > MOST_SAMPLES {
            self.cover.push(arc);
            return;
        }
        let Some((verdict, time, middle)) = self.sample(arc.quarter, &arc.middle()) else {
            if self.escape.is_none() {
                self.cover.push(arc);
            }
            return;
        };
        arc.middle = Some(middle);
        if depth >= 2 {
            arc.verdict = self.prove(&arc, verdict, time, depth);
        }
        if arc.verdict.is_some() || depth >= DEPTH {
            self.cover.push(arc);
            return;
        }
        let (quarter, mid) = (arc.quarter, arc.middle());
        let half = |from: &Rat, to: &Rat| Arc {
            quarter,
            from: from.clone(),
            to: to.clone(),
            verdict: None,
            open: false,
            middle: None,
        };
        self.cover_arc(half(&arc.from, &mid), depth + 1);
        self.cover_arc(half(&mid, &arc.to), depth + 1);
    }

    /// Tries to prove that every direction of the arc gets out.
    pub(super) fn prove_open(&self, arc: &Arc) -> bool {
        let scale = self.field.reach();
        let spread = arc.width() / 4.0;
        let grain = Grain {
            step: (self.distance.min(scale) * spread).max(scale / 256.0),
            spread,
            deadline: self.ground.deadline,
            until: self.distance * (1.0 + 1e-9),
        };
        self.field.open(&arc.directions(), &grain)
    }

    /// Tries to prove the arc blocked, as firmly as its middle is or else as the class needs.
    pub(super) fn prove(
        &self,
        arc: &Arc,
        verdict: Verdict,
        time: f64,
        depth: u32,
    ) -> Option<Verdict> {
        let w = arc.directions();
        let scale = self.field.reach();
        // Lateral uncertainty at the time of blocking, and slabs to match.
        let reached = time.max(scale / 64.0).min(self.distance);
        let spread = arc.width() / 4.0;
        let grain = Grain {
            step: (reached * spread).max(scale * 1e-6),
            spread,
            deadline: self.ground.deadline,
            until: (reached * 1.5 + scale * 0.25 * f64::from(depth.min(8))).min(self.distance),
        };
        let mut models = vec![verdict];
        if let Some(weakest) = self.weakest.filter(|&w| w < verdict && depth >= 6) {
            models.push(weakest);
        }
        models.into_iter().find(|v| {
            let model = match v {
                Verdict::Kinematic => Model::Shapes,
                Verdict::Friction => Model::Friction,
                Verdict::Force => Model::Force,
                Verdict::None => return false,
            };
            self.field.blocked(&w, model, &grain)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simple_fractions_are_found() {
        let between = |a: Rat, b: Rat| simplest(&a, Some(&b));
        assert_eq!(between(Rat::frac(3, 10), Rat::frac(2, 5)), Rat::frac(1, 3));
        assert_eq!(between(Rat::zero(), Rat::frac(1, 7)), Rat::frac(1, 8));
        assert_eq!(between(Rat::frac(5, 2), Rat::frac(7, 2)), Rat::from(3));
        let third = Rat::frac(1, 3);
        let eps = Rat::from(2).pow(70).recip();
        assert_eq!(between(&third - &eps, &third + &eps), third);
        // The diagonal of each quarter lies between directions on either side of it.
        for quarter in 0..4 {
            let w = short_direction(quarter, &Rat::frac(2, 5), &Rat::frac(3, 7));
            assert_eq!(w.x.abs(), w.y.abs());
            assert!(w.dot(&Arc::unit(quarter, &Rat::frac(2, 5))).sign() > 0);
        }
    }
}
