#![allow(dead_code, unreachable_pub, clippy::unwrap_used, missing_docs)]
//! Scenes and expected stories in a few lines of text, for tests whose answers are worked out by
//! hand.
//!
//! **Scenes.** One line an item; `#` begins a comment. Pawl vertices are *relative to the hinge*,
//! since that is how one reckons with them (r in the paper is a vertex turned about the hinge).
//!
//! ```text
//! friction 1/4
//! floor: -9,-1 9,-1 9,0 -9,0             # an obstacle and its vertices
//! floor hole: …                          # a hole in it
//! root: -2,10 2,10 2,12 -2,12
//! pawl p at 0,6: 0,0 3,-4 4,-1; start 1/2; limits -1 1; stiffness 2
//! move 0,-1 for 3
//! move 0,-1 until root-collision for 20
//! reverse
//! ```
//!
//! **Stories.** One event a line: `time | tan_half | kind | contacts`. Times count from the start
//! of the plan. A line that begins with `?` may be missing. Kinds and contacts may offer
//! alternatives with `/`. `1/2 > 0` is a snap from tan(θ/2) = 1/2 to 0; `inf` is θ = π; `1/3 w1`
//! is wound by one turn. Contacts are `B1@floor.2` (pawl vertex 1 on edge 2 of the floor),
//! `A0@peg.2` (pawl edge 0 on vertex 2 of the peg), `B1@floor:1.2` (on its first hole), `limit0`;
//! contacts of the root begin with `root-`. Without a fourth column they are not looked at.
//!
//! **Numbers.** `3/7`, `1/2-3√5`, `-√2`, or `root(1, 0, -4) near 0.5`: the real root of
//! 1 − 4x² (constant first) nearest to 0.5. They are compared exactly. `*` is any number.

use snapfit::contact::{Contact, ContactKind};
use snapfit::geometry::Vec2;
use snapfit::motion::{
    Angle, Event, EventKind, Method, Options, OutcomeKind, RootContact, Trajectory, simulate,
};
use snapfit::number::{Algebraic, Poly, Rat};
use snapfit::report::json::{Provenance, ResultDocument};
use snapfit::scene::{Motion, Obstacle, Pawl, Root, Scene, read_scene};
use snapfit::slice::Time;

/// A wide floor; its edge 2 is the top, y = 0.
pub const FLOOR: &str = "floor: -20,-1 20,-1 20,0 -20,0\n";
/// A pawl whose tip, vertex 1, hangs 4 below its hinge and 3 to the right.
pub const ARM: &str = "pawl p at 0,6: 0,0 3,-4 4,-1\n";

/// The story of a scene on [`FLOOR`].
pub fn on_floor(rest: &str) -> Told {
    tell(&(FLOOR.to_owned() + rest))
}

/// A rational from its text.
pub fn q(text: &str) -> Rat {
    text.trim()
        .parse()
        .unwrap_or_else(|e| panic!("number {text:?}: {e}"))
}

/// 2^k.
pub fn two_to(k: i32) -> Rat {
    let p = (0..k.unsigned_abs()).fold(Rat::one(), |a, _| a * Rat::from(2));
    if k < 0 { p.recip() } else { p }
}

fn point(text: &str) -> Vec2 {
    let (x, y) = text
        .split_once(',')
        .unwrap_or_else(|| panic!("point {text:?}"));
    Vec2::new(q(x), q(y))
}

fn points(text: &str) -> Vec<Vec2> {
    text.split_whitespace().map(point).collect()
}

/// A scene from its few lines; see the module's opening.
pub fn scene(text: &str) -> Scene {
    let mut s = Scene {
        name: "by hand".to_owned(),
        friction: None,
        obstacles: Vec::new(),
        root: None,
        pawls: Vec::new(),
        motions: Vec::new(),
        classify: None,
    };
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or("").trim();
        if line.is_empty() {
            continue;
        }
        if let Some(mu) = line.strip_prefix("friction ") {
            s.friction = Some(q(mu));
        } else if line == "reverse" {
            s.motions.push(Motion::Reverse);
        } else if let Some(rest) = line.strip_prefix("move ") {
            let mut words = rest.split_whitespace();
            let velocity = point(words.next().unwrap());
            let (mut duration, mut until_root_collision) = (None, false);
            while let Some(w) = words.next() {
                match (w, words.next()) {
                    ("for", Some(d)) => duration = Some(q(d)),
                    ("until", Some("root-collision")) => until_root_collision = true,
                    other => panic!("{line}: {other:?}"),
                }
            }
            s.motions.push(Motion::Translate {
                velocity,
                duration,
                until_root_collision,
            });
        } else if let Some(rest) = line.strip_prefix("pawl ") {
            let (head, body) = rest.split_once(':').unwrap();
            let (name, at) = head.split_once(" at ").unwrap();
            let hinge = point(at);
            let mut parts = body.split(';');
            let vertices = points(parts.next().unwrap());
            let mut pawl = Pawl {
                name: name.to_owned(),
                vertices: vertices.iter().map(|v| v + &hinge).collect(),
                hinge,
                stiffness: None,
                start: Rat::zero(),
                limits: None,
            };
            for part in parts {
                let words: Vec<&str> = part.split_whitespace().collect();
                match words[..] {
                    ["start", u] => pawl.start = q(u),
                    ["limits", lo, hi] => pawl.limits = Some((q(lo), q(hi))),
                    ["stiffness", k] => pawl.stiffness = Some(q(k)),
                    _ => panic!("{line}: {part}"),
                }
            }
            s.pawls.push(pawl);
        } else if let Some(rest) = line.strip_prefix("root:") {
            s.root = Some(Root {
                vertices: points(rest),
                reference: None,
            });
        } else {
            let (name, body) = line.split_once(':').unwrap_or_else(|| panic!("{line}"));
            if let Some(of) = name.strip_suffix(" hole") {
                let o = s.obstacles.iter_mut().find(|o| o.name == of).unwrap();
                o.holes.push(points(body));
            } else {
                s.obstacles.push(Obstacle {
                    name: name.to_owned(),
                    vertices: points(body),
                    holes: Vec::new(),
                });
            }
        }
    }
    s
}

/// A number from its text; see the module's opening.
pub fn number(text: &str) -> Algebraic {
    let text = text.trim();
    if let Some(rest) = text.strip_prefix("root(") {
        let (coefficients, near) = rest.split_once(')').unwrap();
        let coefficients: Vec<Rat> = coefficients.split(',').map(q).collect();
        let near: f64 = near
            .trim()
            .strip_prefix("near")
            .unwrap()
            .trim()
            .parse()
            .unwrap();
        let roots = Poly::from_rats(&coefficients).real_roots();
        let off = |r: &Algebraic| (r.nearest_f64().unwrap() - near).abs();
        return roots
            .into_iter()
            .min_by(|a, b| off(a).total_cmp(&off(b)))
            .unwrap_or_else(|| panic!("{text}: no real root"));
    }
    let Some((head, radicand)) = text.split_once('√') else {
        return Algebraic::from(q(text));
    };
    let split = head.char_indices().skip(1).find(|(_, c)| "+-".contains(*c));
    let (a, b) = match split {
        Some((i, _)) => (q(&head[..i]), &head[i..]),
        None => (Rat::zero(), head),
    };
    let b = match b {
        "" | "+" => Rat::one(),
        "-" => Rat::from(-1),
        other => q(other),
    };
    // x = a + b√c solves x² − 2ax + a² − b²c = 0; the sign of b picks the root.
    let c = q(radicand);
    let p = Poly::from_rats(&[a.square() - b.square() * &c, -(&a + &a), Rat::one()]);
    let roots = p.real_roots();
    let pick = if b.sign() < 0 {
        roots.first()
    } else {
        roots.last()
    };
    pick.unwrap().clone()
}

/// Whether an orientation is as written.
fn angle_is(angle: &Angle, text: &str) -> bool {
    if text == "*" {
        return true;
    }
    let (u, winding) = match text.split_once(" w") {
        Some((u, w)) => (u, w.trim().parse::<i64>().unwrap()),
        None => (text, 0),
    };
    angle.winding() == winding
        && match angle.tan_half() {
            None => u.trim() == "inf",
            Some(x) => u.trim() != "inf" && x == number(u),
        }
}

fn show_number(x: &Algebraic) -> String {
    match x.to_rat() {
        Some(r) if r.to_string().len() < 60 => r.to_string(),
        _ => format!(
            "{:?} of {:?}",
            x.nearest_f64(),
            x.minimal_polynomial()
                .coeffs()
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>()
        ),
    }
}

fn show_angle(a: &Angle) -> String {
    let u = a.tan_half().map_or("inf".to_owned(), |x| show_number(&x));
    match a.winding() {
        0 => u,
        w => format!("{u} w{w}"),
    }
}

/// A simulated scene.
pub struct Told {
    /// What was asked.
    pub scene: Scene,
    /// What came out.
    pub trajectory: Trajectory,
}

/// Reads a scene of the short notation through the scene reader (so that it is a valid scene),
/// simulates it and checks what holds for every trajectory.
pub fn tell(text: &str) -> Told {
    tell_scene(scene(text))
}

/// The sweep's answer, which must be the simple algorithm's, as JSON to the byte.
pub fn by_both_methods(scene: &Scene) -> Trajectory {
    let run = |method| {
        let options = Options {
            method,
            ..Options::default()
        };
        simulate(scene, &options).unwrap()
    };
    let text = |t: &Trajectory| {
        let how = Provenance {
            arithmetic: "filtered",
            method: Method::Naive,
        };
        let mut doc = serde_json::to_value(ResultDocument::new(scene, t, how)).unwrap();
        doc.as_object_mut().unwrap().remove("ledger");
        serde_json::to_string_pretty(&doc).unwrap()
    };
    let (naive, sweep) = (run(Method::Naive), run(Method::Sweep));
    assert_eq!(
        text(&naive),
        text(&sweep),
        "the methods differ on\n{}",
        scene.to_toml()
    );
    sweep
}

/// [`tell`] for a scene that is there already.
pub fn tell_scene(scene: Scene) -> Told {
    let toml = scene.to_toml();
    match read_scene("by-hand.toml", &toml) {
        Ok(file) => assert_eq!(*file.scene(), scene, "reads back equal"),
        Err(errors) => panic!(
            "not a scene: {}\n{toml}",
            errors
                .iter()
                .map(|d| d.text().to_owned())
                .collect::<Vec<_>>()
                .join("; ")
        ),
    }
    let trajectory = by_both_methods(&scene);
    let told = Told { scene, trajectory };
    told.audit();
    told
}

impl Told {
    fn index(&self, pawl: &str) -> usize {
        self.trajectory
            .pawls
            .iter()
            .position(|p| p.name == pawl)
            .unwrap()
    }

    /// A contact as the tests write it.
    pub fn contact(&self, c: &Contact) -> String {
        match c {
            Contact::Limit(k) => format!("limit{k}"),
            Contact::Obstacle {
                obstacle,
                kind,
                ring,
                obstacle_feature,
                pawl_feature,
            } => {
                let kind = if *kind == ContactKind::B { "B" } else { "A" };
                let name = &self.scene.obstacles[*obstacle as usize].name;
                let hole = if *ring > 0 {
                    format!(":{ring}")
                } else {
                    String::new()
                };
                format!("{kind}{pawl_feature}@{name}{hole}.{obstacle_feature}")
            }
        }
    }

    fn root_contact(&self, c: &RootContact) -> String {
        let kind = if c.vertex_of_root { "B" } else { "A" };
        let name = &self.scene.obstacles[c.obstacle as usize].name;
        format!(
            "root-{kind}{}@{name}.{}",
            c.root_feature, c.obstacle_feature
        )
    }

    fn global(&self, phase: usize, t: &Time) -> Time {
        t.shift(&self.trajectory.phases[phase].from)
    }

    fn time_is(&self, phase: usize, t: &Time, text: &str) -> bool {
        text == "*" || self.global(phase, t) == Time::at(number(text))
    }

    fn contacts_of(&self, e: &Event) -> Vec<String> {
        let mut all: Vec<String> = e.contacts.iter().map(|c| self.contact(c)).collect();
        all.extend(e.root_contacts.iter().map(|c| self.root_contact(c)));
        all.sort();
        all
    }

    fn show(&self, e: &Event) -> String {
        let to =
            e.to.as_ref()
                .map_or(String::new(), |a| format!(" > {}", show_angle(a)));
        format!(
            "{} | {}{to} | {} | {}",
            show_number(self.global(e.phase, &e.time).exact()),
            show_angle(&e.angle),
            e.kind.name(),
            self.contacts_of(e).join(" ")
        )
    }

    /// Everything that happened, for messages.
    pub fn full(&self) -> String {
        let mut out = String::new();
        for (i, p) in self.trajectory.pawls.iter().enumerate() {
            out += &format!("pawl {}\n", p.name);
            for e in &p.events {
                out += &format!("  {}\n", self.show(e));
            }
            for line in self.segment_lines(i) {
                out += &format!("  segment {line}\n");
            }
        }
        let o = &self.trajectory.outcome;
        out += &format!(
            "outcome {} at {} pawl {:?}\n",
            o.kind.name(),
            show_number(self.global(o.phase, &o.time).exact()),
            o.pawl
        );
        out + &self.scene.to_toml()
    }

    fn matches(&self, e: &Event, line: &str) -> bool {
        let columns: Vec<&str> = line.split('|').map(str::trim).collect();
        let (from, to) = match columns[1].split_once('>') {
            Some((a, b)) => (a.trim(), Some(b.trim())),
            None => (columns[1], None),
        };
        let kind = columns[2].split(" / ").any(|k| {
            let known = ALL_KINDS.iter().any(|x| x.name() == k.trim());
            assert!(known, "kind {k:?}");
            e.kind.name() == k.trim()
        });
        kind && self.time_is(e.phase, &e.time, columns[0])
            && angle_is(&e.angle, from)
            && match (&e.to, to) {
                (None, None) => true,
                (Some(a), Some(t)) => angle_is(a, t),
                _ => false,
            }
            && columns.get(3).is_none_or(|c| {
                let got = self.contacts_of(e);
                c.split(" / ").any(|alternative| {
                    let mut want: Vec<String> =
                        alternative.split_whitespace().map(str::to_owned).collect();
                    want.sort();
                    want == got
                })
            })
    }

    /// The whole list of a pawl's events.
    pub fn story(&self, pawl: &str, text: &str) -> &Told {
        let events = &self.trajectory.pawls[self.index(pawl)].events;
        let mut i = 0;
        for line in text.lines().map(str::trim).filter(|l| !l.is_empty()) {
            let (optional, line) = match line.strip_prefix('?') {
                Some(l) => (true, l),
                None => (false, line),
            };
            match events.get(i) {
                Some(e) if self.matches(e, line) => i += 1,
                _ if optional => {}
                e => panic!(
                    "expected {line}\n   found {}\n{}",
                    e.map_or("nothing".to_owned(), |e| self.show(e)),
                    self.full()
                ),
            }
        }
        if let Some(e) = events.get(i) {
            panic!("not expected: {}\n{}", self.show(e), self.full());
        }
        self
    }

    fn segment_lines(&self, pawl: usize) -> Vec<String> {
        let p = &self.trajectory.pawls[pawl];
        p.segments
            .iter()
            .map(|s| {
                let t = |t: &Time| show_number(self.global(s.phase, t).exact());
                let held = match &s.sliding {
                    None => "free".to_owned(),
                    Some(h) => {
                        let all: Vec<String> = std::iter::once(&h.contact)
                            .chain(&h.also)
                            .map(|c| self.contact(c))
                            .collect();
                        all.join(" ")
                    }
                };
                format!("{} | {} | {held}", t(&s.from), t(&s.to))
            })
            .collect()
    }

    /// The whole list of a pawl's segments: `from | to | free` or `from | to | contact also…`.
    pub fn segments(&self, pawl: &str, text: &str) -> &Told {
        let index = self.index(pawl);
        let segments = &self.trajectory.pawls[index].segments;
        let shown = self.segment_lines(index);
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .filter(|l| !l.is_empty())
            .collect();
        let fits = lines.len() == segments.len()
            && lines
                .iter()
                .zip(segments)
                .zip(&shown)
                .all(|((line, s), shown)| {
                    let c: Vec<&str> = line.split('|').map(str::trim).collect();
                    self.time_is(s.phase, &s.from, c[0])
                        && self.time_is(s.phase, &s.to, c[1])
                        && shown.split('|').nth(2).map(str::trim) == Some(c[2])
                });
        assert!(fits, "expected segments {lines:#?}\n{}", self.full());
        self
    }

    /// How and when it ended: `jammed 6`, or `jammed 6 p` with the pawl that ended it.
    pub fn outcome(&self, text: &str) -> &Told {
        let o = &self.trajectory.outcome;
        let (kind, rest) = text.split_once(' ').unwrap();
        let (time, pawl) = match rest.rsplit_once(' ') {
            Some((t, p)) if self.trajectory.pawls.iter().any(|x| x.name == p) => (t, Some(p)),
            _ => (rest, None),
        };
        let named = o.pawl.map(|i| self.trajectory.pawls[i].name.as_str());
        assert!(
            o.kind.name() == kind
                && self.time_is(o.phase, &o.time, time)
                && (pawl.is_none() || pawl == named),
            "expected {text}\n{}",
            self.full()
        );
        self
    }

    /// The story of the pawl `p`.
    pub fn events(&self, text: &str) -> &Told {
        self.story("p", text)
    }

    /// Checks what holds for every trajectory: events in the contract's order, segments that
    /// follow each other without a gap, and a curve, a branch and a contact that agree with plain
    /// geometry in the middle of each segment.
    fn audit(&self) {
        for (i, p) in self.trajectory.pawls.iter().enumerate() {
            for w in p.events.windows(2) {
                let order =
                    (w[0].phase, &w[0].time, w[0].kind) < (w[1].phase, &w[1].time, w[1].kind);
                assert!(order, "order of events\n{}", self.full());
            }
            let mut phase = 0;
            let mut clock = Time::from(Rat::zero());
            for s in &p.segments {
                if s.phase != phase {
                    assert!(s.phase == phase + 1, "{}", self.full());
                    assert!(clock == self.trajectory.phases[phase].to, "{}", self.full());
                    phase = s.phase;
                    clock = Time::from(Rat::zero());
                }
                assert!(s.from == clock && s.from < s.to, "gap\n{}", self.full());
                clock = s.to.clone();
                if s.sliding.is_some() {
                    self.audit_segment(i, s);
                }
            }
            assert!(
                clock == self.trajectory.phases[phase].to,
                "end\n{}",
                self.full()
            );
        }
        let o = &self.trajectory.outcome;
        assert!(o.kind != OutcomeKind::Undecided, "{}", self.full());
        assert!(
            o.time == self.trajectory.phases[o.phase].to,
            "{}",
            self.full()
        );
    }

    fn audit_segment(&self, pawl: usize, s: &snapfit::motion::Segment) {
        let h = s.sliding.as_ref().unwrap();
        let t = Time::between(&s.from, &s.to);
        let coefficient = |k: usize| Rat::from(h.p[k].clone()) + &t * Rat::from(h.q[k].clone());
        let [c, b, a] = [0, 1, 2].map(coefficient);
        let size = [&a, &b, &c].iter().map(|x| x.abs()).max().unwrap();
        let f = |x: &Rat| (x / &size).nearest_f64().unwrap();
        let [fa, fb, fc] = [&a, &b, &c].map(f);
        let u = if a.is_zero() {
            assert_eq!(
                b.sign(),
                h.branch,
                "branch of a linear curve\n{}",
                self.full()
            );
            -fc / fb
        } else {
            let d = f(&((b.square() - Rat::from(4) * &a * &c) / &size));
            assert!(d > -1e-12, "discriminant {d}\n{}", self.full());
            let root = f64::from(h.branch) * d.max(0.0).sqrt();
            if root * fb > 0.0 {
                2.0 * fc / (-fb - root)
            } else {
                (-fb + root) / (2.0 * fa)
            }
        };
        let Contact::Obstacle {
            obstacle,
            kind,
            ring,
            obstacle_feature,
            pawl_feature,
        } = h.contact
        else {
            return;
        };
        // A rational orientation that near, exact from there on.
        let u = Rat::from_f64(u);
        let place = &self.scene.pawls[pawl];
        let phase = &self.trajectory.phases[s.phase];
        let hinge = &(&place.hinge + &phase.offset) + &phase.velocity.scale(&t);
        let turned: Vec<Vec2> = place
            .vertices
            .iter()
            .map(|v| &(v - &place.hinge).rotate_tan_half(&u) + &hinge)
            .collect();
        let o = &self.scene.obstacles[obstacle as usize];
        let fixed = if ring == 0 {
            &o.vertices
        } else {
            &o.holes[ring as usize - 1]
        };
        let edge = |v: &[Vec2], k: u32| {
            let k = k as usize;
            (v[k].clone(), v[(k + 1) % v.len()].clone())
        };
        let (at, (e0, e1)) = match kind {
            ContactKind::B => (
                turned[pawl_feature as usize].clone(),
                edge(fixed, obstacle_feature),
            ),
            ContactKind::A => (
                fixed[obstacle_feature as usize].clone(),
                edge(&turned, pawl_feature),
            ),
        };
        let along = &e1 - &e0;
        let off = (along.cross(&(&at - &e0)) / along.norm2())
            .nearest_f64()
            .unwrap();
        let place = (along.dot(&(&at - &e0)) / along.norm2())
            .nearest_f64()
            .unwrap();
        assert!(
            off.abs() < 1e-7 && place > -1e-7 && place < 1.0 + 1e-7,
            "at {t} the contact is off by {off} at {place}\n{}",
            self.full()
        );
    }
}

const ALL_KINDS: [EventKind; 15] = [
    EventKind::Release,
    EventKind::Graze,
    EventKind::TranslationalCollision,
    EventKind::SlidingCollision,
    EventKind::SnapFree,
    EventKind::SnapFreeVertex,
    EventKind::SnapLanding,
    EventKind::LimitStop,
    EventKind::Stick,
    EventKind::JamIncompatible,
    EventKind::JamSingle,
    EventKind::Bifurcation,
    EventKind::RootCollision,
    EventKind::PhaseEnd,
    EventKind::PlanEnd,
];
