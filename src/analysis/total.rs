//! Every direction of the circle, certified.
//!
//! The paper thinks a decision over all directions impractical and offers sampling. Here the
//! circle is cut into arcs. An exact motion in the middle of an arc says what to prove and about
//! when; the proof for the whole arc is that of `cells`, which follows every successor in
//! certified intervals. An arc that resists is halved, down to a bound on depth and time. One exact
//! way out settles the question at once: the class is then `none`.

use super::cells::{Directions, Field, Grain, Model};
use super::classify::{Verdict, direction};
use super::escape::{Ground, Start};
use crate::geometry::Vec2;
use crate::number::Rat;
use crate::scene::Scene;

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
    /// What is proven of every direction of the arc: blocked at least so firmly. None where nothing
    /// is.
    pub verdict: Option<Verdict>,
}

impl Arc {
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
    /// The arcs, in order round the circle. Empty where a way out was found.
    pub cover: Vec<Arc>,
    /// A direction that gets out.
    pub escape: Option<Vec2>,
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

/// How often an arc may be halved: a quarter's 2⁻¹⁶ is about 10⁻⁵ radians.
const DEPTH: u32 = 16;

/// Decides every direction. `known` are verdicts already met on single directions.
pub fn total(ground: &Ground<'_>, start: &Start, known: Option<Verdict>) -> Total {
    let scene = ground.scene;
    let asked = scene
        .classify
        .as_ref()
        .and_then(|c| c.escape_distance.clone());
    let distance = asked.unwrap_or_else(|| clear_distance(scene, start));
    let mut search = Search {
        ground,
        start,
        distance2: distance.square(),
        distance: distance.interval().lo,
        field: Field::new(ground, start),
        weakest: known,
        cover: Vec::new(),
        escape: None,
    };
    search.run();
    let class = search.weakest;
    let escape = search.escape;
    let undecided_width = search
        .cover
        .iter()
        .filter(|a| escape.is_none() && a.verdict < class)
        .map(Arc::width)
        .fold(0.0, |a, b| a + b);
    Total {
        class,
        cover: search.cover,
        escape,
        distance,
        undecided_width,
    }
}

struct Search<'a> {
    ground: &'a Ground<'a>,
    start: &'a Start,
    distance2: Rat,
    distance: f64,
    field: Field,
    weakest: Option<Verdict>,
    cover: Vec<Arc>,
    escape: Option<Vec2>,
}

impl Search<'_> {
    fn run(&mut self) {
        // Coarse samples first: most ways out are wide.
        let samples = 8;
        for quarter in 0..4 {
            for k in 0..samples {
                let s = Rat::frac(k, samples);
                if self.sample(quarter, &s).is_none() {
                    return;
                }
            }
        }
        for quarter in 0..4 {
            let whole = Arc {
                quarter,
                from: Rat::zero(),
                to: Rat::one(),
                verdict: None,
            };
            self.cover(whole, 0);
            if self.escape.is_some() {
                self.cover.clear();
                return;
            }
        }
    }

    /// The verdict of one direction with the time at which it is blocked; None if it gets out, or
    /// the time is up.
    fn sample(&mut self, quarter: u8, s: &Rat) -> Option<(Verdict, f64)> {
        if self.ground.late() {
            return None;
        }
        let w = Arc::unit(quarter, s);
        let d = direction(self.ground, self.start, &w, &self.distance2, false);
        if d.open {
            return Some((Verdict::None, self.distance));
        }
        self.weakest = Some(self.weakest.map_or(d.verdict, |v| v.min(d.verdict)));
        if d.verdict == Verdict::None {
            self.escape = Some(w);
            return None;
        }
        let time = match (&d.peak, d.verdict) {
            (Some((p, _)), Verdict::Force) => match &p.when {
                super::peak::Instant::At(t) => t.interval().hi,
                super::peak::Instant::Between(_, t) => t.interval().hi,
            },
            _ => d.run.outcome.time.interval().hi,
        };
        Some((d.verdict, time))
    }

    fn cover(&mut self, mut arc: Arc, depth: u32) {
        if self.escape.is_some() {
            return;
        }
        let Some((verdict, time)) = self.sample(arc.quarter, &arc.middle()) else {
            if self.escape.is_none() {
                self.cover.push(arc);
            }
            return;
        };
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
        };
        self.cover(half(&arc.from, &mid), depth + 1);
        self.cover(half(&mid, &arc.to), depth + 1);
    }

    /// Tries to prove the arc blocked, as firmly as its middle is or else as the class needs.
    fn prove(&self, arc: &Arc, verdict: Verdict, time: f64, depth: u32) -> Option<Verdict> {
        let w = arc.directions();
        let scale = self.field.reach();
        // Lateral uncertainty at the time of blocking, and slabs to match.
        let reached = time.max(scale / 64.0).min(self.distance);
        let spread = arc.width() / 4.0;
        let grain = Grain {
            step: (reached * spread).max(scale * 1e-6),
            spread,
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
