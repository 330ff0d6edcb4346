//! The result of `simulate` as the contract has it: `snapfit.result/1`.
//!
//! The types are the format; the JSON Schema is derived from them. Times are on the clock of the
//! whole plan, except that t in a segment's curve counts from the start of its phase.

use super::ledger::LedgerDocument;
use super::num::{Num, Numbers, Orientation};
use crate::contact::{Contact, ContactKind};
use crate::motion::trajectory::Sliding;
use crate::motion::{self, Method, OutcomeKind, RootContact, Trajectory};
use crate::number::{Int, Rat};
use crate::scene::Scene;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;

/// Which columns a line of the printed result may fill.
const WIDTH: usize = 110;

/// The result of a simulation.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "snapfit result")]
pub struct ResultDocument {
    /// `snapfit.result/1`.
    #[schemars(extend("enum" = ["snapfit.result/1"]))]
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// Which arithmetic decided: `exact`, `filtered` or `f64`.
    #[schemars(extend("enum" = ["exact", "filtered", "f64"]))]
    pub arithmetic: &'static str,
    /// Which algorithm ran: `naive` or `sweep`.
    #[schemars(extend("enum" = ["naive", "sweep"]))]
    pub method: &'static str,
    /// Which library carried integers too long for a machine word.
    pub backend: &'static str,
    /// The phases that ran.
    pub phases: Vec<PhaseDocument>,
    /// How it ended.
    pub outcome: OutcomeDocument,
    /// One history a pawl, in file order.
    pub pawls: Vec<PawlDocument>,
    /// What it took.
    pub ledger: LedgerDocument,
}

/// One phase as it really ran.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Phase")]
pub struct PhaseDocument {
    /// When it began.
    pub from: Num,
    /// When it ended.
    pub to: Num,
    /// The root's velocity.
    pub velocity: [Num; 2],
}

/// How, when, where and why the motion ended.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Outcome")]
pub struct OutcomeDocument {
    /// `completed`, `jammed`, `stuck`, `root-collision`, `bifurcated` or `undecided`.
    #[schemars(extend("enum" = ["completed", "jammed", "stuck", "root-collision", "bifurcated", "undecided"]))]
    pub kind: &'static str,
    /// When.
    pub time: Num,
    /// In which phase.
    pub phase: usize,
    /// Name of the pawl that ended it.
    pub pawl: Option<String>,
    /// The root's displacement from time 0.
    pub position: [Num; 2],
    /// The continuations of a bifurcation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branches: Option<Vec<BranchDocument>>,
}

/// One way on from a bifurcation.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Branch")]
pub struct BranchDocument {
    /// `counter-clockwise` or `clockwise`.
    #[schemars(extend("enum" = ["counter-clockwise", "clockwise"]))]
    pub direction: &'static str,
    /// What would drive the pawl that way.
    pub contacts: Vec<ContactDocument>,
    /// Whether friction holds it at once.
    pub sticks: bool,
}

/// One pawl's history.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Pawl")]
pub struct PawlDocument {
    /// Its name.
    pub name: String,
    /// In order of time, then of kind.
    pub events: Vec<EventDocument>,
    /// In order of time.
    pub segments: Vec<SegmentDocument>,
}

/// tan(θ/2).
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum TanHalf {
    /// Where it is finite.
    Finite(Num),
    /// θ is an odd multiple of π.
    Infinite(Infinity),
}

/// The word for an infinite tangent.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub enum Infinity {
    /// θ is an odd multiple of π.
    #[serde(rename = "infinity")]
    Infinity,
}

/// Something that happened to a pawl. θ = 2·atan(tan_half) + 2π·winding.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Event")]
pub struct EventDocument {
    /// What.
    #[schemars(extend("enum" = ["release", "graze", "translational-collision", "sliding-collision", "snap-free", "snap-free-vertex", "snap-landing", "limit-stop", "stick", "jam-incompatible", "jam-single", "bifurcation", "root-collision", "phase-end", "plan-end"]))]
    pub kind: &'static str,
    /// When.
    pub time: Num,
    /// In which phase.
    pub phase: usize,
    /// tan(θ/2) then.
    pub tan_half: TanHalf,
    /// θ in radians, correctly rounded.
    pub theta: f64,
    /// Whole turns; θ = π has 0.
    pub winding: i64,
    /// tan(θ/2) after a snap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_tan_half: Option<TanHalf>,
    /// θ after a snap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_theta: Option<f64>,
    /// Whole turns after a snap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_winding: Option<i64>,
    /// Who touches whom.
    pub contacts: Vec<EventContact>,
}

/// A contact of the pawl, or (in a root collision) of the root.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum EventContact {
    /// Of the pawl.
    Pawl(ContactDocument),
    /// Of the root.
    Root(RootContactDocument),
}

/// A contact of a pawl. Indices count the vertices as listed in the file; edge k joins vertex k
/// to vertex k + 1.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type")]
#[schemars(rename = "Contact")]
pub enum ContactDocument {
    /// A pawl vertex touches an obstacle edge.
    B {
        /// Vertex of the pawl.
        pawl_vertex: u32,
        /// Name of the obstacle.
        obstacle: String,
        /// Edge of its outer ring, or of the hole.
        obstacle_edge: u32,
        /// Which hole of the obstacle.
        #[serde(skip_serializing_if = "Option::is_none")]
        hole: Option<u32>,
    },
    /// A pawl edge touches an obstacle vertex.
    A {
        /// Edge of the pawl.
        pawl_edge: u32,
        /// Name of the obstacle.
        obstacle: String,
        /// Vertex of its outer ring, or of the hole.
        obstacle_vertex: u32,
        /// Which hole of the obstacle.
        #[serde(skip_serializing_if = "Option::is_none")]
        hole: Option<u32>,
    },
    /// The pawl is on an angular stop.
    #[serde(rename = "limit")]
    Limit {
        /// 0: the lower one, 1: the upper one.
        limit: u8,
    },
}

/// A contact of the root.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type")]
#[schemars(rename = "RootContact")]
pub enum RootContactDocument {
    /// A root vertex touches an obstacle edge.
    B {
        /// Vertex of the root.
        root_vertex: u32,
        /// Name of the obstacle.
        obstacle: String,
        /// Edge of its outer ring, or of the hole.
        obstacle_edge: u32,
        /// Which hole of the obstacle.
        #[serde(skip_serializing_if = "Option::is_none")]
        hole: Option<u32>,
    },
    /// A root edge touches an obstacle vertex.
    A {
        /// Edge of the root.
        root_edge: u32,
        /// Name of the obstacle.
        obstacle: String,
        /// Vertex of its outer ring, or of the hole.
        obstacle_vertex: u32,
        /// Which hole of the obstacle.
        #[serde(skip_serializing_if = "Option::is_none")]
        hole: Option<u32>,
    },
}

/// A stretch of motion under one constraint, or under none.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Segment")]
pub struct SegmentDocument {
    /// `free` (θ = 0) or `sliding`.
    #[schemars(extend("enum" = ["free", "sliding"]))]
    pub kind: &'static str,
    /// In which phase.
    pub phase: usize,
    /// When it begins.
    pub from: Num,
    /// When it ends.
    pub to: Num,
    /// Whole turns at both ends.
    pub winding: [i64; 2],
    /// What holds the pawl away from rest; null where it is free.
    pub contact: Option<ContactDocument>,
    /// What else holds throughout.
    pub also: Vec<ContactDocument>,
    /// The curve that u = tan(θ/2) is on; null where it is free.
    pub curve: Option<CurveDocument>,
    /// The sign in u = (−B ± √(B² − 4AC))/(2A); where A = 0, `+` if B > 0 and `-` if B < 0; null where it is free.
    #[schemars(extend("enum" = ["+", "-", null]))]
    pub branch: Option<&'static str>,
}

/// P(u) + t·Q(u) = 0 with u = tan(θ/2), t from the start of the phase. Exact rationals, constant
/// first.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "Curve")]
pub struct CurveDocument {
    /// P.
    pub p: [String; 3],
    /// Q.
    pub q: [String; 3],
}

/// How a result was obtained; it says so itself.
#[derive(Clone, Copy, Debug)]
pub struct Provenance {
    /// Which arithmetic decided.
    pub arithmetic: &'static str,
    /// Which algorithm was asked for: where the choice was open, the result names the one that ran.
    pub method: Method,
}

impl ResultDocument {
    /// The document for a trajectory of the scene.
    pub fn new(scene: &Scene, trajectory: &Trajectory, how: Provenance) -> ResultDocument {
        let mut writer = Writer {
            scene,
            numbers: Numbers::new(&trajectory.phases),
        };
        let mut document = ResultDocument {
            schema: "snapfit.result/1",
            scene: scene.name.clone(),
            arithmetic: how.arithmetic,
            method: trajectory.ledger.ran(how.method).name(),
            backend: crate::number::backend().name(),
            phases: trajectory
                .phases
                .iter()
                .enumerate()
                .map(|(i, p)| PhaseDocument {
                    from: Num::of_rat(&p.from),
                    to: writer.numbers.time(i, &p.to),
                    velocity: [Num::of_rat(&p.velocity.x), Num::of_rat(&p.velocity.y)],
                })
                .collect(),
            outcome: writer.outcome(trajectory),
            pawls: trajectory
                .pawls
                .iter()
                .map(|p| PawlDocument {
                    name: p.name.clone(),
                    events: p.events.iter().map(|e| writer.event(e)).collect(),
                    segments: p.segments.iter().map(|s| writer.segment(s)).collect(),
                })
                .collect(),
            ledger: LedgerDocument::new(&trajectory.ledger),
        };
        if how.arithmetic == "f64" {
            document.in_doubles();
        }
        document
    }

    /// The document as text, with a line feed at its end. The same bytes for the same trajectory.
    ///
    /// # Errors
    /// None that a document of these types can meet; passed on all the same.
    pub fn to_text(&self) -> Result<String, serde_json::Error> {
        Ok(super::pretty(&serde_json::to_string(self)?, WIDTH) + "\n")
    }
}

/// The JSON Schema of a result (draft 2020-12), as `snapfit schema result` prints it.
pub fn result_schema() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let mut schema = settings
        .into_generator()
        .into_root_schema_for::<ResultDocument>();
    schema.insert("$id".to_owned(), "snapfit.result/1".into());
    schema
}

/// A contact by the names of the scene.
pub(super) fn named_contact(scene: &Scene, contact: &Contact) -> ContactDocument {
    let numbers = Numbers::new(&[]);
    Writer { scene, numbers }.contact(contact)
}

/// The events and segments of one run through a phase, times counted from its start.
pub(super) fn run_documents(
    scene: &Scene,
    phase: usize,
    run: &motion::Run,
) -> (Vec<EventDocument>, Vec<SegmentDocument>) {
    let zero = motion::Phase {
        from: Rat::zero(),
        to: Rat::zero().into(),
        offset: Default::default(),
        velocity: Default::default(),
    };
    let phases = vec![zero; phase + 1];
    let numbers = Numbers::new(&phases);
    let mut writer = Writer { scene, numbers };
    (
        run.events.iter().map(|e| writer.event(e)).collect(),
        run.segments.iter().map(|s| writer.segment(s)).collect(),
    )
}

struct Writer<'a> {
    scene: &'a Scene,
    numbers: Numbers<'a>,
}

impl Writer<'_> {
    fn outcome(&mut self, trajectory: &Trajectory) -> OutcomeDocument {
        let outcome = &trajectory.outcome;
        let phase = &trajectory.phases[outcome.phase];
        let along = |start: &Rat, speed: &Rat| match outcome.time.as_rat() {
            Some(t) => Num::of_rat(&(start + speed * t)),
            None => Num::of(&outcome.time.affine(start, speed)),
        };
        OutcomeDocument {
            kind: outcome.kind.name(),
            time: self.numbers.time(outcome.phase, &outcome.time),
            phase: outcome.phase,
            pawl: outcome.pawl.map(|i| trajectory.pawls[i].name.clone()),
            position: [
                along(&phase.offset.x, &phase.velocity.x),
                along(&phase.offset.y, &phase.velocity.y),
            ],
            branches: (outcome.kind == OutcomeKind::Bifurcated).then(|| {
                let branch = |b: &motion::Branch| BranchDocument {
                    direction: if b.direction > 0 {
                        "counter-clockwise"
                    } else {
                        "clockwise"
                    },
                    contacts: b.contacts.iter().map(|c| self.contact(c)).collect(),
                    sticks: b.sticks,
                };
                outcome.branches.iter().map(branch).collect()
            }),
        }
    }

    fn event(&mut self, event: &motion::Event) -> EventDocument {
        let at = self.numbers.orientation(&event.angle);
        let to = event.to.as_ref().map(|a| self.numbers.orientation(a));
        let pawl = event
            .contacts
            .iter()
            .map(|c| EventContact::Pawl(self.contact(c)));
        let root = event
            .root_contacts
            .iter()
            .map(|c| EventContact::Root(self.root_contact(c)));
        EventDocument {
            kind: event.kind.name(),
            contacts: pawl.chain(root).collect(),
            time: self.numbers.time(event.phase, &event.time),
            phase: event.phase,
            theta: at.theta,
            winding: at.winding,
            tan_half: tan_half(at),
            to_theta: to.as_ref().map(|o| o.theta),
            to_winding: to.as_ref().map(|o| o.winding),
            to_tan_half: to.map(tan_half),
        }
    }

    fn segment(&mut self, segment: &motion::Segment) -> SegmentDocument {
        let sliding = segment.sliding.as_ref();
        SegmentDocument {
            kind: if sliding.is_some() { "sliding" } else { "free" },
            phase: segment.phase,
            from: self.numbers.time(segment.phase, &segment.from),
            to: self.numbers.time(segment.phase, &segment.to),
            winding: segment.winding,
            contact: sliding.map(|s| self.contact(&s.contact)),
            also: sliding.map_or_else(Vec::new, |s| {
                s.also.iter().map(|c| self.contact(c)).collect()
            }),
            curve: sliding.map(curve),
            branch: sliding.map(|s| {
                if s.branch < 0 && !on_stop(s) {
                    "-"
                } else {
                    "+"
                }
            }),
        }
    }

    fn contact(&self, contact: &Contact) -> ContactDocument {
        match *contact {
            Contact::Limit(limit) => ContactDocument::Limit { limit },
            Contact::Obstacle {
                obstacle,
                kind,
                ring,
                obstacle_feature,
                pawl_feature,
            } => {
                let name = self.obstacle(obstacle);
                let hole = ring.checked_sub(1);
                match kind {
                    ContactKind::B => ContactDocument::B {
                        pawl_vertex: pawl_feature,
                        obstacle: name,
                        obstacle_edge: obstacle_feature,
                        hole,
                    },
                    ContactKind::A => ContactDocument::A {
                        pawl_edge: pawl_feature,
                        obstacle: name,
                        obstacle_vertex: obstacle_feature,
                        hole,
                    },
                }
            }
        }
    }

    fn root_contact(&self, contact: &RootContact) -> RootContactDocument {
        let obstacle = self.obstacle(contact.obstacle);
        let hole = contact.ring.checked_sub(1);
        if contact.vertex_of_root {
            RootContactDocument::B {
                root_vertex: contact.root_feature,
                obstacle,
                obstacle_edge: contact.obstacle_feature,
                hole,
            }
        } else {
            RootContactDocument::A {
                root_edge: contact.root_feature,
                obstacle,
                obstacle_vertex: contact.obstacle_feature,
                hole,
            }
        }
    }

    fn obstacle(&self, index: u32) -> String {
        self.scene.obstacles[index as usize].name.clone()
    }
}

fn tan_half(o: Orientation) -> TanHalf {
    o.tan_half.into()
}

impl From<Option<Num>> for TanHalf {
    /// None is an infinite one.
    fn from(n: Option<Num>) -> TanHalf {
        match n {
            Some(n) => TanHalf::Finite(n),
            None => TanHalf::Infinite(Infinity::Infinity),
        }
    }
}

fn on_stop(sliding: &Sliding) -> bool {
    matches!(sliding.contact, Contact::Limit(_))
}

fn curve(sliding: &Sliding) -> CurveDocument {
    let text = |c: &[Int; 3]| [c[0].to_string(), c[1].to_string(), c[2].to_string()];
    if on_stop(sliding) && !sliding.p[1].is_zero() {
        // u − u₀ whatever integers it was scaled to.
        let u = Rat::new(sliding.p[0].clone(), sliding.p[1].clone());
        let zero = || "0".to_owned();
        return CurveDocument {
            p: [u.to_string(), "1".to_owned(), zero()],
            q: [zero(), zero(), zero()],
        };
    }
    CurveDocument {
        p: text(&sliding.p),
        q: text(&sliding.q),
    }
}
