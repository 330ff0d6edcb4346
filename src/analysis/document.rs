//! The result of `classify` as the contract writes it.

use super::bound::Bound;
use super::classify::{Ask, Direction, Relative, Verdict, relative};
use super::escape::{Ground, just_past, lasting};
use super::peak::Peak;
use super::total::{Arc, Flip, Sample, Total, total};
use crate::contact::{Contact, ContactKind};
use crate::geometry::Vec2;
use crate::motion::{OutcomeKind, PlanError, Trajectory};
use crate::number::Rat;
use crate::report::Num;
use crate::report::json::ContactDocument;
use crate::report::words;
use crate::scene::{Motion, Scene};
use crate::slice::Time;
use schemars::{JsonSchema, Schema, generate::SchemaSettings};
use serde::Serialize;

/// The result of `classify`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ClassifyDocument {
    /// `snapfit.classify/1`.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// The verdict; null where there is none, see `reason`.
    pub class: Option<&'static str>,
    /// `total` where that was asked and is not none, else `relative`; null for none.
    pub extent: Option<&'static str>,
    /// In words.
    pub reason: String,
    /// The verdict on the family of directions.
    pub relative: Option<&'static str>,
    /// The verdict on the whole circle, where asked.
    pub total: Option<&'static str>,
    /// The infimum of the μ that locks the family; null where none does or none is needed.
    pub critical_friction: Option<Num>,
    /// The infimum of the μ at which the plan itself sticks.
    pub critical_friction_forward: Option<Num>,
    /// The contact force at which the family lets go: at a force limit below it a force holds every
    /// direction that nothing else blocks. Null where all are blocked anyway or no pawl has a
    /// stiffness.
    pub critical_force: Option<Bound>,
    /// What that means at the root, where a designer measures: the largest push against the travel,
    /// all pawls together, of the direction that takes the least.
    pub critical_root_force: Option<Bound>,
    /// What the verdict rests on.
    pub assumed: Vec<&'static str>,
    /// What was left out of the model, because it was not needed or not given.
    pub not_modelled: Vec<&'static str>,
    /// The family, in order.
    pub directions: Vec<DirectionDocument>,
    /// How far a direction of the circle was run to count as a way out; null where the circle was
    /// not asked for. The directions of the family run the length of the phase that they reverse.
    pub escape_distance: Option<Num>,
    /// Arcs that cover the circle, each proven at least as firmly blocked as it says. An arc of
    /// `none` gets out wherever it was tried, and everywhere if it says `proven`.
    pub cover: Vec<ArcDocument>,
    /// Where the exact verdicts of single directions flip.
    pub flips: Vec<FlipDocument>,
    /// The single directions of the circle that were decided, counter-clockwise.
    pub samples: Vec<SampleDocument>,
    /// A direction that gets out, where the circle was asked and one was found.
    pub escape: Option<[Num; 2]>,
    /// Radians of directions not proven at least as firmly blocked as the class.
    pub undecided_width: Option<f64>,
    /// Whether a limit of time stopped the plan itself.
    #[serde(skip)]
    late: bool,
}

/// One direction of the family.
#[derive(Debug, Serialize, JsonSchema)]
pub struct DirectionDocument {
    /// The root's velocity.
    pub velocity: [Num; 2],
    /// How firmly it is blocked.
    pub verdict: &'static str,
    /// How the motion that decided ended, its clock starting at the end of the plan.
    pub outcome: StopDocument,
    /// Whether friction was in that motion's model.
    pub friction_modelled: bool,
    /// The infimum of the μ that locks this direction.
    pub critical_friction: Option<Num>,
    /// The highest contact force of the escape, where it was held against the limit.
    pub peak_force: Option<Bound>,
    /// The largest push that the escape needs at the root, all pawls together.
    pub peak_root_force: Option<Bound>,
    /// A plan that gets out: append it to the scene's.
    pub plan: Option<String>,
}

/// How a motion ended.
#[derive(Debug, Serialize, JsonSchema)]
pub struct StopDocument {
    /// As in a result of `simulate`.
    pub kind: &'static str,
    /// When.
    pub time: Num,
    /// The pawl that ended it.
    pub pawl: Option<String>,
    /// The last event of that pawl.
    pub event: Option<&'static str>,
    /// Who touches whom then.
    pub contacts: Vec<ContactDocument>,
}

/// An arc of directions, counter-clockwise between two unit vectors.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ArcDocument {
    /// Begin, exactly.
    pub from: [String; 2],
    /// End, exactly.
    pub to: [String; 2],
    /// What is known; `undecided` where nothing is.
    pub verdict: &'static str,
    /// Whether it is proven of every direction of the arc: that it is blocked so firmly, or that
    /// it gets out.
    pub proven: bool,
    /// What the proof rests on, and how the motion in the arc's middle ends.
    pub reason: String,
}

/// A change of the verdict round the circle.
#[derive(Debug, Serialize, JsonSchema)]
pub struct FlipDocument {
    /// Before it.
    pub from: [String; 2],
    /// After it, at most 2⁻⁶⁰ of tan(φ/2) away.
    pub to: [String; 2],
    /// The verdict before it.
    pub before: &'static str,
    /// The verdict after it.
    pub after: &'static str,
    /// The direction in between that is written with the fewest digits: the critical one, most
    /// likely; null where none is short.
    pub critical: Option<[String; 2]>,
    /// Its own verdict.
    pub at: Option<&'static str>,
}

/// One direction of the circle.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SampleDocument {
    /// A unit vector.
    pub direction: [String; 2],
    /// Its exact verdict.
    pub verdict: &'static str,
}

/// The JSON Schema of `classify`'s result.
pub fn classify_schema() -> Schema {
    schema_of::<ClassifyDocument>("snapfit.classify/1")
}

/// The JSON Schema of `forces`' result.
pub fn forces_schema() -> Schema {
    schema_of::<super::forces::ForcesDocument>("snapfit.forces/1")
}

fn schema_of<T: JsonSchema>(id: &str) -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    schema.insert("$id".to_owned(), id.into());
    schema
}

fn pair(v: &Vec2) -> [Num; 2] {
    [Num::of_rat(&v.x), Num::of_rat(&v.y)]
}

fn instant(t: &Time) -> Num {
    t.as_rat().map_or_else(|| Num::of(t.exact()), Num::of_rat)
}

pub(super) fn contact(scene: &Scene, contact: &Contact) -> ContactDocument {
    match *contact {
        Contact::Limit(limit) => ContactDocument::Limit { limit },
        Contact::Obstacle {
            obstacle,
            kind,
            ring,
            obstacle_feature,
            pawl_feature,
        } => {
            let obstacle = scene.obstacles[obstacle as usize].name.clone();
            let hole = ring.checked_sub(1);
            match kind {
                ContactKind::B => ContactDocument::B {
                    pawl_vertex: pawl_feature,
                    obstacle,
                    obstacle_edge: obstacle_feature,
                    hole,
                },
                ContactKind::A => ContactDocument::A {
                    pawl_edge: pawl_feature,
                    obstacle,
                    obstacle_vertex: obstacle_feature,
                    hole,
                },
            }
        }
    }
}

fn stop(scene: &Scene, run: &Trajectory) -> StopDocument {
    let outcome = &run.outcome;
    let pawl = outcome.pawl.map(|i| &run.pawls[i]);
    let last = pawl.and_then(|p| p.events.last());
    StopDocument {
        kind: outcome.kind.name(),
        time: instant(&outcome.time),
        pawl: pawl.map(|p| p.name.clone()),
        event: last.map(|e| e.kind.name()),
        contacts: last.map_or_else(Vec::new, |e| {
            e.contacts.iter().map(|c| contact(scene, c)).collect()
        }),
    }
}

impl ClassifyDocument {
    /// Whether a direction gets out, or would but for the force limit.
    pub fn gets_out(&self) -> bool {
        self.escape.is_some() || self.directions.iter().any(|d| d.plan.is_some())
    }
    /// Whether a limit kept the question open: of the family, or of part of the circle.
    pub fn undecided(&self) -> bool {
        let open = self.class.is_none()
            && self
                .directions
                .iter()
                .any(|d| d.outcome.kind == "undecided");
        open || self.late || self.undecided_width.is_some_and(|w| w > 0.0)
    }
}

/// Decides a scene's class: the family of directions and, where asked, the circle.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn classify(scene: &Scene, ask: &Ask) -> Result<ClassifyDocument, PlanError> {
    Ok(classify_with_way(scene, ask)?.0)
}

/// As [`classify`], with the motion that decides: a velocity and a duration from the end of the
/// plan. It is the escape of the circle if there is one, else the family's weakest direction.
///
/// # Errors
/// [`PlanError`] where the plan asks for what cannot be.
pub fn classify_with_way(
    scene: &Scene,
    ask: &Ask,
) -> Result<(ClassifyDocument, Option<(Vec2, Rat)>), PlanError> {
    let family = relative(scene, ask)?;
    let wants = scene.classify.as_ref().is_some_and(|c| c.total);
    let circle = family.start.as_ref().filter(|_| wants).map(|start| {
        let ground = Ground::asked(scene, ask);
        let also: Vec<Vec2> = family
            .directions
            .iter()
            .map(|d| d.velocity.clone())
            .collect();
        total(&ground, start, &also)
    });
    let weakest = family.directions.iter().min_by_key(|d| d.verdict);
    let relative_way = weakest.map(|d| (d.velocity.clone(), run_time(d)));
    let way = match circle.as_ref() {
        Some(t) if family.class != Some(Verdict::None) => {
            let way = t.escape.as_ref().map(|w| {
                let lasts = lasting(w, &t.distance.square()).0;
                (w.clone(), lasts)
            });
            way.or(relative_way)
        }
        _ => relative_way,
    };
    Ok((written(scene, &family, circle.as_ref()), way))
}

/// A rational duration in which a direction's motion has run its course.
fn run_time(d: &Direction) -> Rat {
    let end = &d.run.outcome.time;
    let lasts = match end.as_rat() {
        Some(t) => t.clone(),
        None => just_past(end.exact()),
    };
    // A little longer, where it ends for another reason than its length.
    match d.run.outcome.kind {
        OutcomeKind::Completed => lasts,
        _ if lasts.sign() > 0 => lasts * Rat::frac(17, 16),
        _ => Rat::one(),
    }
}

fn written(scene: &Scene, family: &Relative, circle: Option<&Total>) -> ClassifyDocument {
    let whole = circle.and_then(|t| t.class).filter(|c| *c != Verdict::None);
    let class = whole.or(family.class);
    let extent = match (class, whole) {
        (None | Some(Verdict::None), _) => None,
        (_, Some(_)) => Some("total"),
        _ => Some("relative"),
    };
    let undecided = circle.map(|t| t.undecided_width);
    let reason = reason(scene, family, circle);
    let covered = |least: &[Verdict]| {
        let arcs = circle.iter().flat_map(|t| &t.cover);
        arcs.filter_map(|a| a.verdict).any(|v| least.contains(&v))
    };
    let rubs = scene.friction.as_ref().is_some_and(|m| m.sign() > 0);
    let sprung = scene.pawls.iter().any(|p| p.stiffness.is_some());
    let rubbed = family.directions.iter().any(|d| d.with_friction)
        || rubs && covered(&[Verdict::Friction, Verdict::Force]);
    let limited = scene
        .classify
        .as_ref()
        .is_some_and(|c| c.force_limit.is_some());
    let pushed = limited
        && (family.directions.iter().any(|d| d.peak.is_some()) || covered(&[Verdict::Force]));
    let mut assumed = vec![
        "rigid planar bodies, straight quasistatic translation of the root",
        "each pawl is pulled towards rest; pawls meet neither each other nor the root",
    ];
    let mut not_modelled = Vec::new();
    let mut place = |used: bool, what, without| {
        if used {
            assumed.push(what);
        } else {
            not_modelled.push(without);
        }
    };
    place(
        rubbed,
        "Coulomb friction, one coefficient throughout",
        match (&scene.friction, rubs) {
            (None, _) => "friction (none is given)",
            (_, false) => "friction (its coefficient is 0)",
            _ => "friction (given, but this verdict does not need it)",
        },
    );
    place(
        pushed,
        "linear torsional springs; the force limit bounds each contact force",
        match (sprung, limited) {
            (false, _) => "forces (no pawl has a stiffness)",
            (_, false) => "a force limit (none is given: forces decide nothing here)",
            _ => "forces (a limit is given, but this verdict does not need it)",
        },
    );
    place(
        scene.root.is_some(),
        "the root blocks where it collides",
        "root collision (no root is given)",
    );
    ClassifyDocument {
        schema: "snapfit.classify/1",
        scene: scene.name.clone(),
        class: class.map(Verdict::name),
        extent,
        reason,
        relative: family.class.map(Verdict::name),
        total: circle.and_then(|t| t.class).map(Verdict::name),
        critical_friction: family.critical.as_ref().map(Num::of),
        critical_friction_forward: family.critical_forward.as_ref().map(Num::of),
        assumed,
        not_modelled,
        directions: family
            .directions
            .iter()
            .map(|d| direction(scene, d))
            .collect(),
        cover: circle.map_or_else(Vec::new, |t| {
            t.cover
                .iter()
                .map(|a| {
                    let [from, to] = a.ends();
                    ArcDocument {
                        from: text(&from),
                        to: text(&to),
                        verdict: a.verdict.map_or("undecided", Verdict::name),
                        proven: a.open || a.verdict.is_some_and(|v| v != Verdict::None),
                        reason: arc_reason(scene, a),
                    }
                })
                .collect()
        }),
        critical_force: critical_force(family),
        critical_root_force: least(free(family).map(|d| d.root_force.as_ref()))
            .map(|p| Bound::of(p, 6)),
        escape_distance: circle.map(|t| Num::of_rat(&t.distance)),
        flips: circle.map_or_else(Vec::new, |t| t.flips.iter().map(flip).collect()),
        samples: circle.map_or_else(Vec::new, |t| {
            let of = |s: &Sample| SampleDocument {
                direction: text(&Arc::unit(s.quarter, &s.s)),
                verdict: s.verdict.name(),
            };
            t.samples.iter().map(of).collect()
        }),
        escape: circle.and_then(|t| t.escape.as_ref()).map(pair),
        undecided_width: undecided,
        late: family.forward.outcome.kind == OutcomeKind::Undecided,
    }
}

fn text(v: &Vec2) -> [String; 2] {
    [v.x.to_string(), v.y.to_string()]
}

fn flip(f: &Flip) -> FlipDocument {
    let [from, to] = f
        .sides
        .each_ref()
        .map(|s| text(&Arc::unit(s.quarter, &s.s)));
    FlipDocument {
        from,
        to,
        before: f.sides[0].verdict.name(),
        after: f.sides[1].verdict.name(),
        critical: f.critical.as_ref().map(|c| text(&c.0)),
        at: f.critical.as_ref().map(|c| c.1.name()),
    }
}

/// The directions that neither shapes nor friction block.
fn free(family: &Relative) -> impl Iterator<Item = &Direction> {
    let all = family.directions.iter();
    all.filter(|d| d.verdict <= Verdict::Force && !d.open)
}

/// The least of some peaks, if all are known.
fn least<'a>(peaks: impl Iterator<Item = Option<&'a Peak>>) -> Option<&'a Peak> {
    let peaks: Option<Vec<&Peak>> = peaks.collect();
    peaks?.into_iter().reduce(|a, b| match (a, b) {
        (Peak::Unbounded, b) => b,
        (a, Peak::Unbounded) => a,
        (Peak::Within(_, x), Peak::Within(_, y)) if x <= y => a,
        _ => b,
    })
}

/// The least peak of the directions that nothing else blocks: at a larger limit that one gets out.
fn critical_force(family: &Relative) -> Option<Bound> {
    let peaks = free(family).map(|d| d.peak.as_ref().map(|p| &p.0.peak));
    Some(Bound::of(least(peaks)?, 12))
}

fn arc_reason(scene: &Scene, a: &Arc) -> String {
    let proof = match a.verdict {
        None => "nothing is proven",
        Some(Verdict::None) if a.open => return "every direction of it gets out".to_owned(),
        Some(Verdict::None) => return "gets out wherever it was tried".to_owned(),
        Some(Verdict::Force) => "held by friction, or by more than the force limit",
        Some(Verdict::Friction) => "held by friction where the shapes alone do not",
        Some(Verdict::Kinematic) => "the shapes alone hold",
    };
    match &a.middle {
        Some((kind, by)) => {
            let by = by.map_or("the root", |i| scene.pawls[i].name.as_str());
            match kind {
                OutcomeKind::Completed => format!("{proof}; its middle runs its length"),
                _ => format!("{proof}; its middle ends {}, by {by}", kind.name()),
            }
        }
        None => proof.to_owned(),
    }
}

fn direction(scene: &Scene, d: &Direction) -> DirectionDocument {
    let out = d.run.outcome.kind == OutcomeKind::Completed;
    let plan = out.then(|| {
        format!(
            "[[motion]]\nvelocity = [\"{}\", \"{}\"]\nduration = \"{}\"\n",
            d.velocity.x,
            d.velocity.y,
            run_time(d)
        )
    });
    DirectionDocument {
        velocity: pair(&d.velocity),
        verdict: d.verdict.name(),
        outcome: stop(scene, &d.run),
        friction_modelled: d.with_friction,
        critical_friction: d.critical.as_ref().map(|c| Num::of(&c.0)),
        peak_force: d.peak.as_ref().map(|p| Bound::of(&p.0.peak, 12)),
        peak_root_force: d.root_force.as_ref().map(|p| Bound::of(p, 6)),
        plan,
    }
}

/// A direction in a sentence.
fn towards(v: &Vec2) -> String {
    let [x, y] = pair(v).map(|c| words::short(&c));
    format!("({x}, {y})")
}

fn same_way(a: &Vec2, b: &Vec2) -> bool {
    a.cross(b).is_zero() && a.dot(b).sign() > 0
}

fn reason(scene: &Scene, family: &Relative, circle: Option<&Total>) -> String {
    let end = &family.forward.outcome;
    if family.start.is_none() {
        let by = end
            .pawl
            .map_or(String::new(), |i| format!(", by {}", scene.pawls[i].name));
        let mut text = format!(
            "the plan does not complete: it ends {} in phase {}{by}",
            end.kind.name(),
            end.phase
        );
        if scene.motions.get(end.phase) == Some(&Motion::Reverse) {
            text +=
                "; that phase is a way back: without it in the plan, its end is what is classified";
        }
        return text;
    }
    let Some(weakest) = family.directions.iter().min_by_key(|d| d.verdict) else {
        return "no direction to decide".to_owned();
    };
    let way = towards(&weakest.velocity);
    let mut text = match weakest.verdict {
        Verdict::None if weakest.open => {
            format!(
                "along {way} the motion ends {}: not proven blocked",
                weakest.run.outcome.kind.name()
            )
        }
        Verdict::None => format!("along {way} it gets out"),
        Verdict::Force => format!("along {way} it gets out only past the force limit"),
        _ => {
            let met = stop(scene, &weakest.run);
            let by = met.pawl.as_deref().unwrap_or("the root");
            let touching: Vec<String> = met.contacts.iter().map(words::contact).collect();
            let on = if touching.is_empty() {
                String::new()
            } else {
                format!(" ({})", touching.join(", "))
            };
            format!(
                "along {way} it ends {} at t {}, by {by}{on}",
                met.kind,
                words::equals(&met.time)
            )
        }
    };
    if scene.motions.last() == Some(&Motion::Reverse) {
        text += "; the plan comes back by itself, and this is asked of its end";
    }
    if let Some(t) = circle {
        match (&t.escape, t.class) {
            // Said already, where it is the family's own way out.
            (Some(w), _) if weakest.verdict == Verdict::None && same_way(w, &weakest.velocity) => {}
            (Some(w), _) => text += &format!("; along {} it gets out", towards(w)),
            (None, Some(c)) if t.undecided_width == 0.0 => {
                text += &format!("; every direction is blocked, at least by {}", c.name());
            }
            _ => text += &format!("; {} rad of directions are not decided", t.undecided_width),
        }
    }
    text
}
