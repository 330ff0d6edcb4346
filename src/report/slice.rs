//! F as a document: `snapfit.slice/1`, what `snapfit slice` prints.
//!
//! Vertices, edges and cycles of the free component's boundary, every number exact. Times count from the
//! start of the phase, as t does in the curves.

use super::json::{
    ContactDocument, CurveDocument, EventDocument, Infinity, SegmentDocument, TanHalf,
    named_contact, run_documents,
};
use super::num::{Num, Numbers};
use crate::motion::friction::regions;
use crate::motion::{Angle, Method, Seen};
use crate::number::{Int, Rat};
use crate::scene::Scene;
use crate::slice::{Configuration, Free, Owner, Shape, Slice, Time, Whereabouts};
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;

/// A pawl's slice of a phase, and F.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "snapfit slice")]
pub struct SliceDocument {
    /// `snapfit.slice/1`.
    #[schemars(extend("const" = "snapfit.slice/1"))]
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// Index of the phase.
    pub phase: usize,
    /// Name of the pawl.
    pub pawl: String,
    /// How long the phase lasts.
    pub duration: Num,
    /// The pawl's orientation at the start of the phase.
    pub start: TanHalf,
    /// Contact arcs within reach; F's boundary is made of some of them.
    pub arcs: usize,
    /// F; null where the pawl has no interval to be in.
    pub free: Option<FreeDocument>,
    /// What was asked.
    pub queries: Vec<QueryDocument>,
}

/// F's boundary.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Free")]
pub struct FreeDocument {
    /// Half-edges, both sides of a slit counted.
    pub half_edges: usize,
    /// Boundary cycles.
    pub components: usize,
    /// Where edges end.
    pub vertices: Vec<FreeVertexDocument>,
    /// Stretches of contact arcs, and of the phase's two ends.
    pub edges: Vec<FreeEdgeDocument>,
    /// The cycles, with F on the left as seen with time upwards and the orientation to the right: edges by
    /// index from 1, negative where they are walked from `to` to `from`.
    pub cycles: Vec<Vec<i64>>,
}

/// A vertex.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "FreeVertex")]
pub struct FreeVertexDocument {
    /// When.
    pub time: Num,
    /// Orientation.
    pub tan_half: TanHalf,
    /// The same in radians, from −π/2 to 3π/2.
    pub theta: f64,
    /// All contacts made there, also those that F's boundary does not follow.
    pub contacts: Vec<ContactDocument>,
}

/// An edge.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "FreeEdge")]
pub struct FreeEdgeDocument {
    /// `contact`, or `start` and `end` for the phase's first and last instant.
    #[schemars(extend("enum" = ["contact", "start", "end"]))]
    pub kind: &'static str,
    /// The vertex with the smaller θ (where θ is constant: the earlier one).
    pub from: u32,
    /// The other one.
    pub to: u32,
    /// Where F lies: `above` or `below` in θ, `before` or `after` where t is constant; one side or both.
    #[schemars(
        length(min = 1, max = 2),
        inner(regex(pattern = "^(above|below|before|after)$"))
    )]
    pub free: Vec<&'static str>,
    /// Who touches whom.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactDocument>,
    /// The curve that it lies on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curve: Option<CurveDocument>,
    /// The sign of the radical, as in a result's segments; left out where t is constant.
    #[schemars(extend("enum" = ["+", "-"]))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<&'static str>,
    /// Where friction is modelled: where the whole arc sticks and slides in this phase's direction.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionDocument>,
}

/// A sticking or sliding region of an arc.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Region")]
pub struct RegionDocument {
    /// `stick` or `slide`.
    #[schemars(extend("enum" = ["stick", "slide"]))]
    pub kind: &'static str,
    /// When it begins.
    pub from: Num,
    /// When it ends.
    pub to: Num,
}

/// A question to F and its answer.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case", tag = "query")]
#[schemars(rename = "Query")]
pub enum QueryDocument {
    /// Can a configuration be reached without leaving free space?
    Reach {
        /// When.
        time: Num,
        /// Orientation.
        tan_half: TanHalf,
        /// `inside`, `boundary` (in contact, or at the phase's first or last instant beside F) or `outside`.
        #[schemars(extend("enum" = ["inside", "boundary", "outside"]))]
        answer: &'static str,
    },
    /// Which orientations are in F just after a time?
    Intervals {
        /// When.
        time: Num,
        /// Whether all are.
        all: bool,
        /// From each lower end upwards to the upper one; past θ = 3π/2 where that is smaller.
        intervals: Vec<[TanHalf; 2]>,
    },
    /// How would the pawl move from another orientation at the start of the phase?
    Run {
        /// Orientation at the start.
        from: TanHalf,
        /// Whether F served for this start too.
        reused: bool,
        /// How the run ended, as in a result.
        #[schemars(extend("enum" = ["completed", "jammed", "stuck", "bifurcated", "undecided"]))]
        outcome: &'static str,
        /// When.
        time: Num,
        /// In order of time, then of kind.
        events: Vec<EventDocument>,
        /// In order of time.
        segments: Vec<SegmentDocument>,
    },
}

/// The JSON Schema of what `snapfit slice` prints (draft 2020-12), as `snapfit schema slice` prints it.
pub fn slice_schema() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let mut schema = settings
        .into_generator()
        .into_root_schema_for::<SliceDocument>();
    schema.insert("$id".to_owned(), "snapfit.slice/1".into());
    schema
}

fn time(t: &Time) -> Num {
    match t.as_rat() {
        Some(r) => Num::of_rat(r),
        None => Num::of(t.exact()),
    }
}

fn half(numbers: &mut Numbers<'_>, half_turn: i64, x: crate::number::Algebraic) -> (TanHalf, f64) {
    let o = numbers.orientation(&Angle { half_turn, x });
    (o.tan_half.into(), o.theta)
}

impl SliceDocument {
    /// The document of a slice.
    pub fn new(scene: &Scene, seen: &Seen) -> SliceDocument {
        let mut numbers = Numbers::new(&[]);
        SliceDocument {
            schema: "snapfit.slice/1",
            scene: scene.name.clone(),
            phase: seen.phase,
            pawl: scene.pawls[seen.pawl].name.clone(),
            duration: Num::of_rat(&seen.slice.frame.duration),
            start: half(&mut numbers, seen.start.half_turn, seen.start.x.clone()).0,
            arcs: seen.slice.arcs().len(),
            free: seen
                .free
                .as_ref()
                .map(|f| FreeDocument::new(scene, &seen.slice, f, &mut numbers)),
            queries: Vec::new(),
        }
    }

    /// Asks whether a configuration can be reached: a time, and tan(θ/2), None where θ is an odd multiple of π.
    pub fn reach(&mut self, seen: &Seen, t: &Rat, u: Option<&Rat>) {
        let at: Angle = match u {
            Some(u) => Angle::from_tan_half(u),
            None => Angle {
                half_turn: 1,
                x: Rat::zero().into(),
            },
        };
        let answer = seen.free.as_ref().map(|f| {
            f.locate(&Configuration {
                chart: at.chart(),
                x: at.x.to_rat().unwrap_or_default(),
                t: t.clone(),
            })
        });
        self.queries.push(QueryDocument::Reach {
            time: Num::of_rat(t),
            tan_half: match u {
                Some(u) => TanHalf::Finite(Num::of_rat(u)),
                None => TanHalf::Infinite(Infinity::Infinity),
            },
            answer: match answer {
                Some(Whereabouts::Inside) => "inside",
                Some(Whereabouts::Boundary) => "boundary",
                _ => "outside",
            },
        });
    }

    /// Asks for the run from another orientation at the start of the phase.
    pub fn run(&mut self, scene: &Scene, seen: &Seen, u: &Rat) {
        let start: Angle = Angle::from_tan_half(u);
        let run = seen.run_from(scene, &start, Method::Sweep);
        let (events, segments) = run_documents(scene, seen.phase, &run);
        let (outcome, at) = match &run.end {
            Some((kind, at, _)) => (kind.name(), at.clone()),
            None => ("completed", Time::from(seen.slice.frame.duration.clone())),
        };
        self.queries.push(QueryDocument::Run {
            from: half(&mut Numbers::new(&[]), start.half_turn, start.x).0,
            reused: run.faces.reused > 0,
            outcome,
            time: time(&at),
            events,
            segments,
        });
    }

    /// Asks for the intervals just after a time.
    pub fn intervals(&mut self, seen: &Seen, t: &Rat) {
        let mut numbers = Numbers::new(&[]);
        let found = match &seen.free {
            Some(f) => f.intervals(&seen.slice, t),
            None => Some(Vec::new()),
        };
        let mut end = |f: &Free, e: u32, x: crate::number::Algebraic| {
            half(
                &mut numbers,
                f.edges()[e as usize].chart().index() as i64,
                x,
            )
            .0
        };
        let intervals = match (&seen.free, &found) {
            (Some(f), Some(list)) => list
                .iter()
                .map(|i| {
                    [
                        end(f, i.low.0, i.low.1.clone()),
                        end(f, i.high.0, i.high.1.clone()),
                    ]
                })
                .collect(),
            _ => Vec::new(),
        };
        self.queries.push(QueryDocument::Intervals {
            time: Num::of_rat(t),
            all: found.is_none(),
            intervals,
        });
    }
}

impl FreeDocument {
    fn new(scene: &Scene, slice: &Slice, free: &Free, numbers: &mut Numbers<'_>) -> FreeDocument {
        let vertices = (0..free.vertices().len() as u32)
            .map(|v| {
                let (chart, x, t) = free.place(v);
                let (tan_half, theta) = half(numbers, chart.index() as i64, x);
                let mut contacts: Vec<_> = free
                    .arcs_at(v)
                    .iter()
                    .map(|&a| slice.arc(a).contact)
                    .collect();
                contacts.sort();
                contacts.dedup();
                FreeVertexDocument {
                    time: time(&t),
                    tan_half,
                    theta,
                    contacts: contacts.iter().map(|c| named_contact(scene, c)).collect(),
                }
            })
            .collect();
        let edges = free.edges().iter().map(|e| edge(scene, slice, e)).collect();
        let cycles = (0..free.cycles())
            .map(|c| {
                free.cycle(c)
                    .map(|(e, forward)| {
                        let e = i64::from(e) + 1;
                        if forward { e } else { -e }
                    })
                    .collect()
            })
            .collect();
        FreeDocument {
            half_edges: free.half_edges(),
            components: free.cycles(),
            vertices,
            edges,
            cycles,
        }
    }
}

fn edge(scene: &Scene, slice: &Slice, e: &crate::slice::FreeEdge) -> FreeEdgeDocument {
    let words = match e.shape() {
        Shape::Wall => ["after", "before"],
        _ => ["above", "below"],
    };
    let free = words
        .into_iter()
        .zip([e.above, e.below])
        .filter_map(|(w, on)| on.then_some(w))
        .collect();
    let Owner::Arc(id) = e.owner else {
        return FreeEdgeDocument {
            kind: if e.owner == Owner::Start {
                "start"
            } else {
                "end"
            },
            from: e.low,
            to: e.high,
            free,
            contact: None,
            curve: None,
            branch: None,
            regions: Vec::new(),
        };
    };
    let arc = slice.arc(id);
    let curve = slice.curve(arc.curve);
    let text = |c: &[Int; 3]| [c[0].to_string(), c[1].to_string(), c[2].to_string()];
    let moves = arc.shape != Shape::Wall;
    let regions = match &scene.friction {
        Some(mu) if moves => regions(slice, id, Some(mu)),
        _ => Vec::new(),
    };
    FreeEdgeDocument {
        kind: "contact",
        from: e.low,
        to: e.high,
        free,
        contact: Some(named_contact(scene, &arc.contact)),
        curve: Some(CurveDocument {
            p: text(&curve.p),
            q: text(&curve.q),
        }),
        branch: moves.then_some(if arc.branch < 0 { "-" } else { "+" }),
        regions: regions
            .iter()
            .map(|r| RegionDocument {
                kind: if r.sticks { "stick" } else { "slide" },
                from: time(&r.from),
                to: time(&r.to),
            })
            .collect(),
    }
}
