//! What a simulation yields (DP Def. 2.1): phases, events, segments, and how it ended.

use crate::contact::{Chart, Contact};
use crate::geometry::Vec2;
use crate::kernel::{Filtered, Instant as _, Kernel, Polynomial, Position};
use crate::number::{Rat, Scalar};
use std::cmp::Ordering;

/// An orientation on the covering line: θ = π·half_turn + 2·atan(x), |x| ≤ 1.
#[derive(Clone, Debug)]
pub struct Angle<K: Kernel = Filtered> {
    /// Which half-turn.
    pub half_turn: i64,
    /// Position in its chart.
    pub x: K::Root,
}

impl<K: Kernel> Angle<K> {
    /// θ = 0, where the spring rests.
    pub fn rest() -> Angle<K> {
        Angle {
            half_turn: 0,
            x: K::Root::of(K::Num::zero()),
        }
    }
    /// The orientation with tan(θ/2) = u, −π < θ < π.
    pub fn from_tan_half(u: &K::Num) -> Angle<K> {
        let one = K::Num::one();
        if u.abs() <= one {
            Angle {
                half_turn: 0,
                x: K::Root::of(u.clone()),
            }
        } else {
            Angle {
                half_turn: i64::from(u.sign()),
                x: K::Root::of(one.negated().over(u)),
            }
        }
    }
    /// The chart of its half-turn.
    pub fn chart(&self) -> Chart {
        Chart::of_half_turn(self.half_turn)
    }
    /// −1, 0 or 1: on which side of rest it lies.
    pub fn side(&self) -> i32 {
        // ±1 with x = ∓1 is π/2, still on its side.
        match self.half_turn {
            0 => self.x.sign(),
            h => h.signum() as i32,
        }
    }
    /// tan(θ/2); None where it is infinite.
    pub fn tan_half(&self) -> Option<K::Root> {
        match self.chart() {
            Chart::Rest => Some(self.x.clone()),
            Chart::Back if self.x.sign() == 0 => None,
            Chart::Back => {
                let (one, zero) = (K::Num::one(), K::Num::zero());
                let minus_one = K::Poly::of(&[one.negated()]);
                Some(self.x.ratio(&minus_one, &K::Poly::of(&[zero, one])))
            }
        }
    }
    /// Whole turns: θ = 2·atan(tan_half) + 2π·winding, and θ = π has winding 0.
    pub fn winding(&self) -> i64 {
        let h = self.half_turn;
        match self.chart() {
            Chart::Rest => h.div_euclid(2),
            Chart::Back if self.x.sign() > 0 => (h + 1).div_euclid(2),
            Chart::Back => (h - 1).div_euclid(2),
        }
    }
}

impl<K: Kernel> PartialEq for Angle<K> {
    fn eq(&self, o: &Angle<K>) -> bool {
        self.cmp(o).is_eq()
    }
}
impl<K: Kernel> Eq for Angle<K> {}
impl<K: Kernel> PartialOrd for Angle<K> {
    fn partial_cmp(&self, o: &Angle<K>) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
/// Comparison along the covering line.
impl<K: Kernel> Ord for Angle<K> {
    fn cmp(&self, o: &Angle<K>) -> Ordering {
        if self.half_turn == o.half_turn {
            return self.x.cmp(&o.x);
        }
        let (lo, hi, swap) = if self.half_turn < o.half_turn {
            (self, o, false)
        } else {
            (o, self, true)
        };
        let one = K::Num::one();
        let seam = hi.half_turn - lo.half_turn == 1
            && lo.x.cmp_num(&one).is_eq()
            && hi.x.cmp_num(&one.negated()).is_eq();
        match (seam, swap) {
            (true, _) => Ordering::Equal,
            (false, false) => Ordering::Less,
            (false, true) => Ordering::Greater,
        }
    }
}

/// What happened (DP §9: the seven kinds and their duals, and what frames them), in the order in
/// which kinds at one instant follow each other.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum EventKind {
    /// (i), dual: contact ends where the curve crosses rest.
    Release,
    /// Touches at an instant without effect.
    Graze,
    /// (i): a curve meets the pawl at rest and drives it away.
    TranslationalCollision,
    /// (ii): another constraint takes over.
    SlidingCollision,
    /// (iv): the near end jumps at a vertical tangency.
    SnapFree,
    /// (vi): the near end jumps at a vertex of free space.
    SnapFreeVertex,
    /// Where a snap ends on a contact.
    SnapLanding,
    /// An angular stop takes over.
    LimitStop,
    /// (vii): friction holds the contact.
    Stick,
    /// (iii): the interval closes between two curves.
    JamIncompatible,
    /// (v): the interval closes on one curve, or at a wall.
    JamSingle,
    /// Struck so that both ways round are open.
    Bifurcation,
    /// The root's interior would meet an obstacle's from here on.
    RootCollision,
    /// A phase of the plan ends.
    PhaseEnd,
    /// The plan ends.
    PlanEnd,
}

impl EventKind {
    /// The contract's word for it.
    pub fn name(self) -> &'static str {
        match self {
            EventKind::Release => "release",
            EventKind::Graze => "graze",
            EventKind::TranslationalCollision => "translational-collision",
            EventKind::SlidingCollision => "sliding-collision",
            EventKind::SnapFree => "snap-free",
            EventKind::SnapFreeVertex => "snap-free-vertex",
            EventKind::SnapLanding => "snap-landing",
            EventKind::LimitStop => "limit-stop",
            EventKind::Stick => "stick",
            EventKind::JamIncompatible => "jam-incompatible",
            EventKind::JamSingle => "jam-single",
            EventKind::Bifurcation => "bifurcation",
            EventKind::RootCollision => "root-collision",
            EventKind::PhaseEnd => "phase-end",
            EventKind::PlanEnd => "plan-end",
        }
    }
}

/// A contact of the root with an obstacle.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct RootContact {
    /// Index of the obstacle.
    pub obstacle: u32,
    /// 0 for the outer ring, h + 1 for hole h.
    pub ring: u32,
    /// Whether a root vertex touches an obstacle edge (type B); else an obstacle vertex touches a
    /// root edge (type A).
    pub vertex_of_root: bool,
    /// The obstacle's edge (type B) or vertex (type A).
    pub obstacle_feature: u32,
    /// The root's vertex (type B) or edge (type A).
    pub root_feature: u32,
}

/// Something that happened to one pawl.
#[derive(Clone, Debug, PartialEq)]
pub struct Event<K: Kernel = Filtered> {
    /// What.
    pub kind: EventKind,
    /// When, counted from the start of the phase.
    pub time: K::Time,
    /// In which phase.
    pub phase: usize,
    /// Orientation then.
    pub angle: Angle<K>,
    /// Orientation after a snap.
    pub to: Option<Angle<K>>,
    /// Who touches whom.
    pub contacts: Vec<Contact>,
    /// Contacts of the root, for a root collision.
    pub root_contacts: Vec<RootContact>,
}

/// A stretch of motion under one constraint, or under none.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment<K: Kernel = Filtered> {
    /// In which phase.
    pub phase: usize,
    /// Begin, counted from the start of the phase.
    pub from: K::Time,
    /// End, counted from the start of the phase.
    pub to: K::Time,
    /// Whole turns at both ends.
    pub winding: [i64; 2],
    /// What holds it away from rest; None for a free segment.
    pub sliding: Option<Sliding<K>>,
}

impl<K: Kernel> Segment<K> {
    /// What of it comes before an instant after its begin.
    pub(crate) fn until(mut self, cut: &K::Time) -> Segment<K> {
        if self.to <= *cut {
            return self;
        }
        let [from, to] = self.winding;
        if let Some(t) = self.sliding.as_ref().and_then(Sliding::upright)
            && from != to
        {
            self.winding[1] = match cut.cmp_num(&K::Num::from_rat(&t)) {
                Ordering::Less => from,
                Ordering::Equal => from.min(to),
                Ordering::Greater => to,
            };
        }
        self.to = cut.clone();
        self
    }
}

/// The constraint of a sliding segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Sliding<K: Kernel = Filtered> {
    /// The first contact that holds throughout.
    pub contact: Contact,
    /// The other ones.
    pub also: Vec<Contact>,
    /// P, constant first.
    pub p: [K::Coef; 3],
    /// Q, constant first.
    pub q: [K::Coef; 3],
    /// The sign of the radical in DP eq. 26.
    pub branch: i32,
}

impl<K: Kernel> Sliding<K> {
    /// When the curve passes θ = π, where the turns change: u = ∞ there, so the leading coefficients cancel.
    /// None if it never does.
    fn upright(&self) -> Option<Rat> {
        let rat = |c: &K::Coef| Rat::from(K::publish(c));
        let (p, q) = (self.p.each_ref().map(rat), self.q.each_ref().map(rat));
        let k = (0..3).rev().find(|&k| !p[k].is_zero() || !q[k].is_zero())?;
        (!q[k].is_zero()).then(|| -(&p[k] / &q[k]))
    }
}

/// How one way on from a bifurcation begins.
#[derive(Clone, Debug)]
pub struct Branch {
    /// +1: counter-clockwise, −1: clockwise.
    pub direction: i32,
    /// The contacts that would drive it.
    pub contacts: Vec<Contact>,
    /// Whether friction holds it at once.
    pub sticks: bool,
}

/// How the motion ended.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum OutcomeKind {
    /// Kinematic constraints leave no way on.
    Jammed,
    /// Friction holds a contact.
    Stuck,
    /// The root collided where no phase asked for it.
    RootCollision,
    /// The model leaves the way on open.
    Bifurcated,
    /// The plan ran to its end.
    Completed,
    /// A limit was reached.
    Undecided,
}

impl OutcomeKind {
    /// The contract's word for it.
    pub fn name(self) -> &'static str {
        match self {
            OutcomeKind::Jammed => "jammed",
            OutcomeKind::Stuck => "stuck",
            OutcomeKind::RootCollision => "root-collision",
            OutcomeKind::Bifurcated => "bifurcated",
            OutcomeKind::Completed => "completed",
            OutcomeKind::Undecided => "undecided",
        }
    }
}

/// How, when, where and why the motion ended.
#[derive(Clone, Debug)]
pub struct Outcome<K: Kernel = Filtered> {
    /// How.
    pub kind: OutcomeKind,
    /// When, counted from the start of `phase`.
    pub time: K::Time,
    /// In which phase.
    pub phase: usize,
    /// Which pawl ended it.
    pub pawl: Option<usize>,
    /// The continuations of a bifurcation.
    pub branches: Vec<Branch>,
}

/// One phase as it really ran.
#[derive(Clone, Debug)]
pub struct Phase<K: Kernel = Filtered> {
    /// Start, counted from the start of the plan.
    pub from: Rat,
    /// Planned end, or the end of the motion where it ended within the phase.
    pub to: K::Time,
    /// The root's displacement at the start.
    pub offset: Vec2,
    /// Velocity.
    pub velocity: Vec2,
}

/// One pawl's history.
#[derive(Clone, Debug)]
pub struct PawlTrace<K: Kernel = Filtered> {
    /// Its name.
    pub name: String,
    /// In order of time, then of kind.
    pub events: Vec<Event<K>>,
    /// In order of time.
    pub segments: Vec<Segment<K>>,
}

/// The whole result.
#[derive(Clone, Debug)]
pub struct Trajectory<K: Kernel = Filtered> {
    /// The phases that ran.
    pub phases: Vec<Phase<K>>,
    /// The end.
    pub outcome: Outcome<K>,
    /// One history a pawl, in file order.
    pub pawls: Vec<PawlTrace<K>>,
    /// Who touches each pawl at the end of a plan that completed: a motion that goes on from
    /// there begins with these held.
    pub touching: Vec<Vec<Contact>>,
    /// What it took.
    pub ledger: super::ledger::Ledger,
}

// ── results for outsiders ───────────────────────────────────────────────────────────────────

impl<K: Kernel> Angle<K> {
    fn published(self) -> Angle {
        Angle {
            half_turn: self.half_turn,
            x: self.x.publish(),
        }
    }
}

impl<K: Kernel> Trajectory<K> {
    /// The same in exact numbers: those that the kernel's own stand for.
    pub fn published(self) -> Trajectory {
        let phase = |p: Phase<K>| Phase {
            from: p.from,
            to: p.to.publish(),
            offset: p.offset,
            velocity: p.velocity,
        };
        let event = |e: Event<K>| Event {
            kind: e.kind,
            time: e.time.publish(),
            phase: e.phase,
            angle: e.angle.published(),
            to: e.to.map(Angle::published),
            contacts: e.contacts,
            root_contacts: e.root_contacts,
        };
        let sliding = |s: Sliding<K>| Sliding {
            contact: s.contact,
            also: s.also,
            p: s.p.map(|c| K::publish(&c)),
            q: s.q.map(|c| K::publish(&c)),
            branch: s.branch,
        };
        let segment = |s: Segment<K>| Segment {
            phase: s.phase,
            from: s.from.publish(),
            to: s.to.publish(),
            winding: s.winding,
            sliding: s.sliding.map(sliding),
        };
        let trace = |p: PawlTrace<K>| PawlTrace {
            name: p.name,
            events: p.events.into_iter().map(event).collect(),
            segments: p.segments.into_iter().map(segment).collect(),
        };
        Trajectory {
            phases: self.phases.into_iter().map(phase).collect(),
            outcome: Outcome {
                kind: self.outcome.kind,
                time: self.outcome.time.publish(),
                phase: self.outcome.phase,
                pawl: self.outcome.pawl,
                branches: self.outcome.branches,
            },
            pawls: self.pawls.into_iter().map(trace).collect(),
            touching: self.touching,
            ledger: self.ledger,
        }
    }
}
