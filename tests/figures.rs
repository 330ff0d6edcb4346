//! The paper's own cases (Donald & Pai 1993): the figures' narratives, on scenes of our own with
//! answers worked out by hand (`papers/donald-pai-1993/scenes`) and, where it is there, on an
//! outsider's set of scenes; §8.4.1; and the errata, re-derived in
//! `papers/donald-pai-1993/README.md`.
#![allow(clippy::unwrap_used)]

#[path = "common/hand.rs"]
mod hand;
use hand::{Told, q, scene, tell, tell_scene};
use snapfit::contact::{
    Chart, Contact, ContactKind, Frame, ObstacleShape, Patch, PawlShape, Trig, patches,
};
use snapfit::motion::OutcomeKind;
use snapfit::number::Rat;
use snapfit::scene::{Motion, Scene, read_scene};
use std::path::PathBuf;

fn read(path: PathBuf) -> Scene {
    let text = std::fs::read_to_string(&path).unwrap();
    read_scene("figure.toml", &text).unwrap().into_scene()
}

/// One of our own scenes.
fn own(name: &str) -> Scene {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    read(
        root.join("papers/donald-pai-1993/scenes")
            .join(format!("{name}.toml")),
    )
}

/// One of the outsider's scenes, where they are there.
fn theirs(name: &str) -> Option<Scene> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let dir = root.join("../shared/oracle/scenes/figures");
    if !dir.is_dir() {
        eprintln!("SKIPPED: {name}: no {}", dir.display());
        return None;
    }
    Some(read(dir.join(format!("{name}.toml"))))
}

/// Events as `kind contacts`, without times.
fn narrative(told: &Told, pawl: &str) -> Vec<String> {
    let p = told
        .trajectory
        .pawls
        .iter()
        .find(|p| p.name == pawl)
        .unwrap();
    p.events
        .iter()
        .filter(|e| e.kind.name() != "graze")
        .map(|e| {
            let mut contacts: Vec<String> = e.contacts.iter().map(|c| told.contact(c)).collect();
            contacts.sort();
            format!("{} {}", e.kind.name(), contacts.join(" "))
                .trim()
                .to_owned()
        })
        .collect()
}

fn narrates(told: &Told, pawl: &str, lines: &str) {
    let want: Vec<&str> = lines
        .lines()
        .map(str::trim)
        .filter(|l| !l.is_empty())
        .collect();
    assert_eq!(narrative(told, pawl), want, "{}", told.full());
}

fn ends(told: &Told, kind: OutcomeKind) {
    assert_eq!(told.trajectory.outcome.kind, kind, "{}", told.full());
}

fn with(mut s: Scene, mu: Option<&str>, reverse: bool) -> Told {
    s.friction = mu.map(q);
    if reverse {
        s.motions.push(Motion::Reverse);
    }
    tell_scene(s)
}

// ── Figures 3 and 4: two hooks and a T ──────────────────────────────────────────────────────

/// The hooks' lower faces have slope ±2. *Left*, hinge (−9/2, 11 − t): the bar's corner (−4,3) is
/// at (1/2, 3 − h) and meets the face, 6 below, when h = 9: t = 2. The nose (1,−5) reaches the
/// corner when |w|² = 26, w = (1/2, −√103/2): t = 8 − √103/2, u = (10 − √103)/3, slides down the
/// bar's end, parallel, for 1, and the upper face lets it back over the lower corner: rest when
/// that is 39/8 below the hinge, t = 33/8. *Right*, mirrored and shorter: face at h = 11/2, t = 11/2;
/// nose (−1,−3/2) at the corner when |w|² = 13/4, w = (−1/2, −√3): t = 8 − √3, u = (2√3 − 3)/3.
/// The root comes down on the bar at t = 7, when the right nose is at 4 − √3 > 2: still beside it.
/// The way back mirrors the way in about t = 7.
#[test]
fn fig_4_both_pawls_comply_and_the_device_comes_out() {
    let told = tell_scene(own("fig04-two-pawls"));
    told.story(
        "left",
        "2 | 0 | translational-collision | A2@bar.3
         8-1/2√103 | 10/3-1/3√103 | sliding-collision | B3@bar.3
         9-1/2√103 | 10/3-1/3√103 | sliding-collision | A3@bar.0
         33/8 | 0 | release | A3@bar.0
         7 | 0 | root-collision | root-B0@bar.2 root-B1@bar.2
         7 | 0 | phase-end
         79/8 | 0 | translational-collision | A3@bar.0
         5+1/2√103 | 10/3-1/3√103 | sliding-collision | B3@bar.3
         6+1/2√103 | 10/3-1/3√103 | sliding-collision | A2@bar.3
         12 | 0 | release | A2@bar.3
         14 | 0 | phase-end
         14 | 0 | plan-end",
    )
    .story(
        "right",
        "11/2 | 0 | translational-collision | A3@bar.2
         8-√3 | -1+2/3√3 | sliding-collision | B3@bar.1
         7 | -1+2/3√3 | root-collision | root-B0@bar.2 root-B1@bar.2
         7 | -1+2/3√3 | phase-end
         6+√3 | -1+2/3√3 | sliding-collision | A3@bar.2
         17/2 | 0 | release | A3@bar.2
         14 | 0 | phase-end
         14 | 0 | plan-end",
    )
    .outcome("completed 14");
}

/// On the way up the left hook's upper face, direction (−4,1), meets the bar's lower corner at
/// r = (1/2, −39/8). The corner slides towards the nose, so the force on the pawl is
/// −(1,4) + μ(4,−1), r × f = −55/8 + 19μ: it holds for μ > 55/152.
#[test]
fn fig_4_with_friction_the_left_pawl_sticks() {
    let told = tell_scene(own("fig04-high-friction"));
    told.story(
        "left",
        "2 | 0 | translational-collision | A2@bar.3
         8-1/2√103 | 10/3-1/3√103 | sliding-collision | B3@bar.3
         9-1/2√103 | 10/3-1/3√103 | sliding-collision | A3@bar.0
         33/8 | 0 | release | A3@bar.0
         7 | 0 | root-collision
         7 | 0 | phase-end
         79/8 | 0 | translational-collision | A3@bar.0
         79/8 | 0 | stick | A3@bar.0",
    )
    .outcome("stuck 79/8 left");
    for (mu, stuck) in [("55/152", false), ("56/152", true), ("1/50", false)] {
        let told = with(own("fig04-two-pawls"), Some(mu), false);
        let kind = if stuck {
            OutcomeKind::Stuck
        } else {
            OutcomeKind::Completed
        };
        ends(&told, kind);
    }
}

const FIG_4_DOWN_LEFT: &str = "translational-collision A2@bar.3
    sliding-collision B3@bar.3
    sliding-collision A3@bar.0
    release A3@bar.0
    root-collision
    phase-end\n";
const FIG_4_DOWN_RIGHT: &str = "translational-collision A2@bar.2
    sliding-collision B3@bar.1
    root-collision
    phase-end\n";

#[test]
fn fig_4_on_the_outsiders_scenes() {
    for name in ["fig34-frictionless", "fig34-low-friction"] {
        let Some(s) = theirs(name) else { return };
        let told = tell_scene(s);
        narrates(
            &told,
            "left",
            &(FIG_4_DOWN_LEFT.to_owned()
                + "translational-collision A3@bar.0
                   sliding-collision B3@bar.3
                   sliding-collision A2@bar.3
                   release A2@bar.3
                   phase-end
                   plan-end"),
        );
        narrates(
            &told,
            "right",
            &(FIG_4_DOWN_RIGHT.to_owned()
                + "sliding-collision A2@bar.2
                   release A2@bar.2
                   phase-end
                   plan-end"),
        );
        // The root meets the bar 6 down: 9 − 3.
        told.outcome("completed 12");
    }
    let told = tell_scene(theirs("fig34-high-friction").unwrap());
    narrates(
        &told,
        "left",
        &(FIG_4_DOWN_LEFT.to_owned() + "translational-collision A3@bar.0\n stick A3@bar.0"),
    );
    narrates(
        &told,
        "right",
        &(FIG_4_DOWN_RIGHT.to_owned() + "sliding-collision A2@bar.2"),
    );
    assert_eq!(told.trajectory.outcome.pawl, Some(0));
    ends(&told, OutcomeKind::Stuck);
    for name in [
        "fig34-classify-frictionless",
        "fig34-classify-low-friction",
        "fig34-classify-high-friction",
    ] {
        let told = tell_scene(theirs(name).unwrap());
        narrates(&told, "left", &(FIG_4_DOWN_LEFT.to_owned() + "plan-end"));
        narrates(&told, "right", &(FIG_4_DOWN_RIGHT.to_owned() + "plan-end"));
        told.outcome("completed 6");
    }
}

// ── Figures 5 and 6: the diode ──────────────────────────────────────────────────────────────

/// Hinge (0, 5 − t); tip (4,−3), the edge from the hinge to it, and a tail whose upper edge runs 1
/// above the hinge. The tip lands on A at h = 3, t = 2; the edge lies flush at h = 0, t = 5,
/// (4,−3) → (5,0): u = 1/3, and slides over A's corner (3,0) until |w| = 5, w = (3,4), t = 9,
/// u = 1; the tip slides down A's side, parallel, for 1 and snaps off. C's vertex is at (−3,−1)
/// from the hinge: (−3,1) on the tail's edge at u = 1/3. It slides until w = (−3, 1/6), where the
/// edge meets it at (−17/6, 1) with u = 1/7, t = 10 + 7/6; there the tip is at (117,−44)/25, on B.
/// B takes over: flush 44/25 later at t = 1939/150, corner 4, side 1: snap to rest at 2689/150.
/// On the way up the tail's side edge (3/2 wide, 3 high) meets B's lower corner at (3,−1),
/// t = 38 − 1939/150; B turns the pawl clockwise, C counter-clockwise: jam.
#[test]
fn fig_5_and_6_the_diode() {
    let told = tell_scene(own("fig05-06-diode"));
    told.story(
        "pawl",
        "2 | 0 | translational-collision | B1@A.2
         5 | 1/3 | sliding-collision | A0@A.3
         9 | 1 | sliding-collision | B1@A.3
         10 | 1 > 1/3 | snap-free-vertex | B1@A.3
         10 | 1/3 | snap-landing | A3@C.0
         67/6 | 1/7 | sliding-collision | B1@B.2
         1939/150 | 1/3 | sliding-collision | A0@B.3
         2539/150 | 1 | sliding-collision | B1@B.3
         2689/150 | 1 > 0 | snap-free-vertex | B1@B.3
         19 | 0 | phase-end
         3761/150 | 0 | translational-collision | A1@B.0
         * | * | jam-incompatible | A1@B.0 A3@C.0",
    );
    ends(&told, OutcomeKind::Jammed);
    assert_eq!(told.trajectory.outcome.phase, 1);
}

#[test]
fn fig_5_and_6_on_the_outsiders_scenes() {
    let down = "translational-collision B2@A.3
        sliding-collision A1@A.0
        sliding-collision B2@A.0
        snap-free-vertex B2@A.0
        snap-landing A0@C.0
        sliding-collision B2@B.3
        sliding-collision A1@B.0
        sliding-collision B2@B.0
        snap-free-vertex B2@B.0
        phase-end\n";
    for name in ["fig5-down", "fig5-total-closed"] {
        let Some(s) = theirs(name) else { return };
        let told = tell_scene(s);
        narrates(&told, "pawl", &(down.to_owned() + "plan-end"));
        told.outcome("completed 16");
    }
    let told = tell_scene(theirs("fig56-down-up").unwrap());
    narrates(
        &told,
        "pawl",
        &(down.to_owned() + "translational-collision A0@C.0\n jam-incompatible A0@C.0 B2@B.0"),
    );
    ends(&told, OutcomeKind::Jammed);
    let told = tell_scene(theirs("fig56-variant").unwrap());
    narrates(
        &told,
        "pawl",
        "translational-collision A1@A.0
         sliding-collision B2@A.0
         snap-free-vertex B2@A.0
         snap-landing A0@C.0
         sliding-collision A1@B.0
         sliding-collision B2@B.0
         snap-free-vertex B2@B.0
         phase-end
         translational-collision A2@B.1
         sliding-collision B2@B.0
         jam-incompatible A0@C.0 B2@B.0",
    );
    ends(&told, OutcomeKind::Jammed);
}

// ── Figure 7: kinds of diodes ───────────────────────────────────────────────────────────────

/// B. The hinge stands over the bump, 3/2 to the right of its corner. Nose (−1,−5): at the corner
/// when w = (−3/2, −√95/2), t = 8 − √95/2, u = (√95 − 10)/5, beside the bump for 1; then it snaps
/// under it (at rest the nose is at √95/2 − 3 < 2). On the way up the nose meets the bump's lower
/// side at h = 7, t = 6, and r = (−1,−5) × (0,−1) = 1 turns it further in, until the hook's shank
/// meets the bump's corner: −(3/2)cos θ − sin²θ − 5 sin θ cos θ + 2 = 0, 7u⁴ + 20u³ − 20u + 1 = 0.
#[test]
fn fig_7_b_is_a_kinematic_diode() {
    tell_scene(own("fig07-b")).events(
        "2 | 0 | translational-collision | A2@bump.3
             8-1/2√95 | -2+1/5√95 | sliding-collision | B3@bump.3
             9-1/2√95 | -2+1/5√95 > 0 | snap-free-vertex | B3@bump.3
             5 | 0 | phase-end
             6 | 0 | translational-collision | B3@bump.0
             * | root(1, -20, 0, 20, 7) near 0.05 | jam-incompatible | A4@bump.0 B3@bump.0",
    );
}

/// Without C another translation takes it out again; with C the root cannot move to the left.
#[test]
fn fig_7_c_decides_about_other_translations() {
    tell_scene(own("fig07-b-without-c")).outcome("completed 8");
    tell_scene(own("fig07-b-with-c")).outcome("root-collision 11/2");
}

/// D. As the left hook of Fig. 4: the upper face holds by friction, and only by friction. E. A
/// steep upper face, direction (−1,1): r × f = −5 + 4μ at r = (1/2, −9/2): it comes out.
#[test]
fn fig_7_d_is_a_friction_diode_and_e_comes_out() {
    tell_scene(own("fig07-d")).outcome("stuck 47/8 p");
    with(own("fig07-d"), None, false).outcome("completed 10");
    let told = tell_scene(own("fig07-e"));
    told.events(
        "2 | 0 | translational-collision | A2@bump.3
         8-1/2√103 | 10/3-1/3√103 | sliding-collision | B3@bump.3
         9-1/2√103 | 10/3-1/3√103 | sliding-collision | A3@bump.0
         9/2 | 0 | release | A3@bump.0
         5 | 0 | phase-end
         11/2 | 0 | translational-collision | A3@bump.0
         1+1/2√103 | 10/3-1/3√103 | sliding-collision | B3@bump.3
         2+1/2√103 | 10/3-1/3√103 | sliding-collision | A2@bump.3
         8 | 0 | release | A2@bump.3
         10 | 0 | phase-end
         10 | 0 | plan-end",
    );
    let told = with(own("fig07-e"), Some("13/10"), false);
    assert_eq!(
        told.trajectory.outcome.kind,
        OutcomeKind::Stuck,
        "5/4 holds it"
    );
}

#[test]
fn fig_7_on_the_outsiders_scenes() {
    for c in ["", "-with-C"] {
        let Some(b) = theirs(&format!("fig7B{c}")) else {
            return;
        };
        let told = with(b, None, true);
        let n = narrative(&told, "pawl");
        assert_eq!(
            n[..5],
            [
                "translational-collision B3@wall.4",
                "sliding-collision A3@wall.5",
                "snap-free-vertex A3@wall.5",
                "root-collision",
                "phase-end"
            ]
        );
        ends(&told, OutcomeKind::Jammed);

        let d = theirs(&format!("fig7D{c}")).unwrap();
        let told = with(d.clone(), Some("1/2"), true);
        let n = narrative(&told, "pawl");
        assert_eq!(
            n[..6],
            [
                "translational-collision B3@wall.4",
                "sliding-collision A3@wall.5",
                "sliding-collision B3@wall.5",
                "release B3@wall.5",
                "root-collision",
                "phase-end"
            ]
        );
        ends(&told, OutcomeKind::Stuck);
        ends(&with(d, None, true), OutcomeKind::Completed);

        let told = with(theirs(&format!("fig7E{c}")).unwrap(), Some("1/20"), true);
        let n = narrative(&told, "pawl");
        assert_eq!(
            n[..5],
            [
                "translational-collision B3@wall.4",
                "sliding-collision A3@wall.5",
                "release A3@wall.5",
                "root-collision",
                "phase-end"
            ]
        );
        ends(&told, OutcomeKind::Completed);
    }
}

// ── Figures 11 to 14 ────────────────────────────────────────────────────────────────────────

/// At height h the tip (3,−4) reaches the floor where (4 + h)u² + 6u + h − 4 = 0, u =
/// (−3 ± √(25 − h²))/(4 + h): at h = 3 at 1/7 and at −1, both of them good contacts. The state
/// keeps to its own (+) all the way.
#[test]
fn fig_11_the_right_branch_is_kept() {
    let told = tell_scene(own("fig11-two-roots"));
    told.events(
        "2 | 0 | translational-collision | B1@floor.2
         3 | 1/7 | phase-end
         8 | 1/7 | phase-end
         9 | 0 | release | B1@floor.2
         10 | 0 | phase-end
         10 | 0 | plan-end",
    );
    // The sign of the radical for a positive leading coefficient.
    let branch = |told: &Told| -> Vec<i32> {
        let held = told.trajectory.pawls[0].segments.iter().filter_map(|s| {
            let h = s.sliding.as_ref()?;
            let a =
                Rat::from(h.p[2].clone()) + s.from.as_rat().unwrap() * Rat::from(h.q[2].clone());
            Some(h.branch * a.sign())
        });
        held.collect()
    };
    assert_eq!(branch(&told), [1, 1, 1]);
    // The other root is as good: started there, the pawl stays there, on the other branch.
    let mut s = own("fig11-two-roots");
    s.pawls[0].hinge.y = q("3");
    for v in &mut s.pawls[0].vertices {
        v.y -= &q("3");
    }
    s.pawls[0].start = q("-1");
    s.motions.truncate(2);
    s.motions.remove(0);
    let told = tell_scene(s);
    told.segments("p", "0 | 5 | B1@floor.2");
    assert_eq!(branch(&told), [-1]);
}

#[test]
fn fig_11_on_the_outsiders_scene() {
    let Some(s) = theirs("fig11-two-roots") else {
        return;
    };
    // The lower vertex is 21/5 below the hinge, which starts 6 up and comes 1 down, 3/1 across.
    tell_scene(s).events(
        "9/5 | 0 | translational-collision | B2@floor.2
         5 | * | phase-end
         8 | * | phase-end
         56/5 | 0 | release | B2@floor.2
         12 | 0 | phase-end
         12 | 0 | plan-end",
    );
}

/// Both types snap off and jam at a vertical tangency; worked out in `events.rs`.
#[test]
fn fig_12_and_13_snap_off_and_jam() {
    tell_scene(own("fig13-b-snap")).events(
        "1 | -1/3 > 0 | snap-free | B1@floor.2
         3 | 0 | phase-end
         3 | 0 | plan-end",
    );
    tell_scene(own("fig13-b-jam")).events(
        "1 | 0 | translational-collision | B0@floor.2
         3 | 1/2 | jam-single | B0@floor.2",
    );
    tell_scene(own("fig13-a-snap")).events(
        "1/5 | -1/3 > 0 | snap-free | A2@spike.0
         1/4 | 0 | phase-end
         1/4 | 0 | plan-end",
    );
    tell_scene(own("fig13-a-jam")).events(
        "4 | 0 | translational-collision | A0@peg.0
         21/5 | 1/3 | jam-single | A0@peg.0",
    );
    let Some(s) = theirs("fig12-B-snap") else {
        return;
    };
    narrates(
        &tell_scene(s),
        "p",
        "snap-free B1@floor.2\n phase-end\n plan-end",
    );
    narrates(
        &tell_scene(theirs("fig12-B-jam").unwrap()),
        "p",
        "translational-collision B5@ledge.2\n jam-single B5@ledge.2",
    );
    narrates(
        &tell_scene(theirs("fig12-A-jam").unwrap()),
        "p",
        "translational-collision A0@peg.0\n jam-single A0@peg.0",
    );
    narrates(
        &tell_scene(theirs("fig12-A-slide").unwrap()),
        "p",
        "translational-collision A0@peg.0
         sliding-collision A1@peg.0
         sliding-collision B2@peg.0
         snap-free B2@peg.0
         phase-end
         plan-end",
    );
}

/// Parallel to the edge θ is constant, neither a snap nor a jam; the edge's end is a snap.
#[test]
fn fig_14_parallel_to_the_edge() {
    tell_scene(own("fig14-parallel")).events(
        "2 | 0 | translational-collision | B1@floor.2
         3 | 1/7 | phase-end
         5 | 1/7 > 0 | snap-free-vertex | B1@floor.2
         7 | 0 | phase-end
         7 | 0 | plan-end",
    );
    let Some(s) = theirs("fig14-parallel") else {
        return;
    };
    narrates(
        &tell_scene(s),
        "p",
        "translational-collision B1@floor.2
         sliding-collision B2@floor.2
         phase-end
         sliding-collision A1@floor.2
         snap-free-vertex A1@floor.2
         phase-end
         plan-end",
    );
}

// ── Figures 15 to 17: forced nongenericity ──────────────────────────────────────────────────

/// Along (1, −2/5) the lower edge's end v_i = (3,−4) lands at h = 4, t = 5, and v_j = (1,−41/12)
/// comes down at h = 3, t = 15/2, u = 1/7 (`events.rs`); on at h = 5/2, t = 35/4.
#[test]
fn fig_15_one_constraint_replaces_the_other() {
    tell_scene(own("fig15-diagonal"))
        .events(
            "5 | 0 | translational-collision | B2@floor.2
             15/2 | 1/7 | sliding-collision | B1@floor.2
             35/4 | -12/71+5/71√37 | phase-end
             35/4 | -12/71+5/71√37 | plan-end",
        )
        .segments(
            "p",
            "0 | 5 | free\n 5 | 15/2 | B2@floor.2\n 15/2 | 35/4 | B1@floor.2",
        );
    let Some(s) = theirs("fig15-diagonal") else {
        return;
    };
    let told = tell_scene(s);
    narrates(
        &told,
        "left",
        "translational-collision B1@bar.2
         sliding-collision B2@bar.2
         sliding-collision B3@bar.2
         sliding-collision A2@bar.2
         sliding-collision A1@bar.2
         snap-free-vertex A1@bar.2
         phase-end
         plan-end",
    );
    narrates(&told, "right", "phase-end\n plan-end");
}

/// The first pawl's frame in the first phase.
fn first_frame(s: &Scene) -> Frame {
    let Motion::Translate {
        velocity, duration, ..
    } = &s.motions[0]
    else {
        panic!()
    };
    Frame {
        p0: s.pawls[0].hinge.clone(),
        v: velocity.clone(),
        duration: duration.clone().unwrap(),
    }
}

/// Fig. 17: at one exact instant (1) f_i leaves its applicability region, (2) f_j enters its own,
/// (3) f_j becomes zero, while f_i is. All four are exactly zero at t = 15/2, u = 1/7; and the two
/// regions' ends bear one name, so that no arithmetic is needed to see it (§8.4.2).
#[test]
fn fig_17_three_zeros_are_one_instant() {
    let s = own("fig15-diagonal");
    let frame = first_frame(&s);
    let obstacles: Vec<ObstacleShape> = s.obstacles.iter().map(ObstacleShape::new).collect();
    let all = patches(&frame, &PawlShape::new(&s.pawls[0]), &obstacles);
    let of = |vertex: u32| -> &Patch {
        let on_top = |p: &&Patch| matches!(p.contact, Contact::Obstacle { kind: ContactKind::B, obstacle_feature: 2, pawl_feature, .. } if pawl_feature == vertex);
        all.iter().find(on_top).unwrap()
    };
    let (i, j) = (of(2), of(1));
    let (t, u) = (q("15/2"), q("1/7"));
    let at = |g: &Trig| g.value(Chart::Rest, &u);
    let f = |p: &Patch| at(&p.f0) + &t * at(&p.f1);
    assert!(f(i).is_zero() && f(j).is_zero());
    let shared: Vec<(usize, usize)> = (0..2)
        .flat_map(|a| (0..2).map(move |b| (a, b)))
        .filter(|&(a, b)| i.flush[a] == j.flush[b])
        .collect();
    assert_eq!(shared.len(), 1, "one name");
    let (a, b) = shared[0];
    assert!(at(&i.wedge[a]).is_zero() && at(&j.wedge[b]).is_zero());
    // And they do change sign there: before it f_i applies and f_j does not, after it the reverse.
    for (u, signs) in [("1/8", (1, -1)), ("1/6", (-1, 1))] {
        let sign = |g: &Trig| g.value(Chart::Rest, &q(u)).sign();
        assert_eq!((sign(&i.wedge[a]), sign(&j.wedge[b])), signs);
    }
}

// ── §8.4.1 ──────────────────────────────────────────────────────────────────────────────────

/// A small deterministic generator: the tests below need variety, not quality.
struct Dice(u64);
impl Dice {
    fn roll(&mut self, lo: i64, hi: i64) -> i64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        lo + ((self.0 >> 33) % (hi - lo + 1) as u64) as i64
    }
    fn rat(&mut self) -> Rat {
        Rat::frac(self.roll(-12, 12), self.roll(1, 6))
    }
}

/// "The degenerate case of the formal leading coefficients vanishing does occur. However, if this
/// happens, θ = π is a solution": with f = c·cos θ + s·sin θ + k the form in u has the leading
/// coefficient k − c = f(π). Here for real patches whose C-function is zero at θ = π at some time:
/// A(t) vanishes exactly then, and the chart around θ = π has the root x = 0.
#[test]
fn a_vanishing_leading_coefficient_means_pi() {
    let mut dice = Dice(1);
    let mut hits = 0;
    for _ in 0..60 {
        let (x, y) = (dice.rat(), dice.rat());
        let (a, b) = (dice.roll(-5, 5), dice.roll(-5, 5));
        let (vx, vy) = (dice.roll(-3, 3), dice.roll(-3, 3));
        if (vx, vy) == (0, 0) {
            continue;
        }
        let s = scene(&format!(
            "o: -4,-3 5,-2 1,6
             pawl p at {x},{y}: {a},{b} {},{} {},{}
             move {vx},{vy} for 5",
            a + 3,
            b + 1,
            a + 1,
            b + 4
        ));
        let frame = first_frame(&s);
        let shapes: Vec<ObstacleShape> = s.obstacles.iter().map(ObstacleShape::new).collect();
        for p in patches(&frame, &PawlShape::new(&s.pawls[0]), &shapes) {
            let (a0, a1) = (
                p.f0.form(Chart::Rest)[2].clone(),
                p.f1.form(Chart::Rest)[2].clone(),
            );
            if a1.is_zero() {
                continue;
            }
            let t = -(a0 / a1);
            let zero = Rat::zero();
            let at_pi = p.f0.value(Chart::Back, &zero) + &t * p.f1.value(Chart::Back, &zero);
            assert!(at_pi.is_zero());
            let elsewhere = &t + &Rat::one();
            let at_pi =
                p.f0.value(Chart::Back, &zero) + &elsewhere * p.f1.value(Chart::Back, &zero);
            assert!(!at_pi.is_zero());
            hits += 1;
        }
    }
    assert!(hits > 100, "{hits}");
}

// ── errata ──────────────────────────────────────────────────────────────────────────────────

/// Props 6.1 and 6.2 with eqs. 11 and 17 against force balance, on random contacts of both types
/// (y along the outward normal). Sectors: −r = β·n + γ·f_e with f_e = (−μσ, 1), σ the sliding
/// direction: γ = r_x/(μσ), β = −r_y − γ; sticks where βγ > 0. Balance: quasistatic sliding needs
/// f_e to press against the spring as the bare normal does: sticks where (r × f_e)(r × n) < 0.
/// Erratum 8 with it: r × f_e = −αβμσ, so eq. 6 as printed is for σ = −1. And the engine's test:
/// type B: d > 0 and −μr_y > |r_x|, or d < 0 and μr_y > |r_x|, d = ṗ·r; type A with r_y turned.
#[test]
fn props_6_1_and_6_2_agree_with_force_balance() {
    let mut dice = Dice(7);
    let mut stuck = [0, 0];
    for n in 0..4000 {
        let (rx, ry, px, py) = (dice.rat(), dice.rat(), dice.rat(), dice.rat());
        let mu = dice.rat().abs();
        if rx.is_zero() || mu.is_zero() {
            continue;
        }
        let type_a = n % 2 == 1;
        // Eqs. 11 and 17.
        let s = &px + &py / &rx * &ry;
        let s = if type_a { -s } else { s };
        if s.is_zero() {
            continue;
        }
        let sigma = Rat::from(i64::from(s.sign()));
        let gamma = &rx / (&mu * &sigma);
        let beta = -&ry - &gamma;
        let by_sectors = (&beta * &gamma).sign() > 0;
        // r × f with f = (−μσ, 1); for type A the force on the pawl is −f, and so is −n: the
        // product of the two torques is the same.
        let torque = &rx + &ry * &mu * &sigma;
        assert_eq!(
            torque.sign(),
            (-(&beta) * &mu * &sigma).sign(),
            "eq. 6 with its sign"
        );
        let by_balance = (&torque * &rx).sign() < 0;
        assert_eq!(by_sectors, by_balance);
        let d = (&px * &rx + &py * &ry).sign();
        let lever = if type_a { ry.clone() } else { -&ry };
        let by_engine = (d > 0 && &mu * &lever > rx.abs()) || (d < 0 && -(&mu * &lever) > rx.abs());
        assert_eq!(
            by_engine, by_balance,
            "r = ({rx}, {ry}), ṗ = ({px}, {py}), μ = {mu}"
        );
        stuck[usize::from(type_a)] += usize::from(by_balance);
    }
    assert!(stuck.iter().all(|&n| n > 100), "{stuck:?}");
}

/// Erratum 2: a jam between two curves one of whose normals has η·t̂ > 0. The tip (4,−3) on the
/// floor raises the lower end by dθ/dt = 1/4; a point at (−4,−3), which an overhanging face with
/// the normal (−4,−1) holds from the other side, raises the upper end too, by
/// −n·ṗ/(n·r⊥) = −1/(−12 + 4) = 1/8. The lower overtakes the upper at t = 3: jammed, although the
/// upper curve's outward normal (1/8, −1) points in the direction of time.
#[test]
fn erratum_2_both_ends_rise() {
    tell(
        "floor: 2,-1 20,-1 20,0 2,0
         block: -41/10,2/5 -39/10,-2/5 -3,0
         pawl p at 0,6: 3,-4 22/5,4/5 -154/25,97/25 -189/25,-23/25 -117/25,-44/25 -24/5,7/5 72/25,-21/25
         move 0,-1 for 5",
    )
    .events(
        "2 | 0 | translational-collision | B0@floor.2
         3 | 1/7 | jam-incompatible | B0@floor.2 B4@block.0",
    )
    .outcome("jammed 3 p");
}

/// Erratum 2, the other half: an ordinary change of constraint with both η·t̂ < 0. In
/// `fig_15_one_constraint_replaces_the_other` both curves rise (dθ/dt > 0), so both outward normals
/// (−θ̇, 1) point against time, and the motion goes on.
#[test]
fn erratum_2_no_jam_with_both_normals_against_time() {
    let told = tell_scene(own("fig15-diagonal"));
    // Before and after t = 15/2 the pawl turns away from rest: 2/(5·4) and 2/(5·23/12).
    told.outcome("completed 35/4");
}

/// Erratum 5, ṗ·n < 0: into sector III by the reversal of sliding, r·ṗ = 0, when that comes after
/// the ray. The hook moves along (4,−3): from r = (4,3), inside the cone of μ = 2 but dragged to
/// the right (d = 7), where r_x + μr_y > 0 slides; at r = (3,4) d = 0, and then it is dragged to
/// the left, r_x − μr_y < 0: it holds. r_y grows by 3 a unit of time: 1/3 after the landing.
#[test]
fn erratum_5_sticking_begins_at_the_reversal() {
    tell(
        "friction 2
         floor: -20,-1 20,-1 20,0 -20,0
         pawl p at 0,-2: 4,3 5,5 3,5
         move 4,-3 for 2",
    )
    .events(
        "1/3 | 0 | translational-collision | B0@floor.2
         2/3 | 1/7 | stick | B0@floor.2",
    )
    .outcome("stuck 2/3 p");
}

/// Erratum 5, ṗ·n > 0: slide, then stick in sector I by the ray (worked out in `events.rs`), and it
/// would slide again past r·ṗ = 0: started there, r = (3,−4) with ṗ = (1,2), d = −5 < 0, it does.
#[test]
fn erratum_5_slide_stick_slide() {
    let floor = "friction 3/4\n floor: -20,-1 20,-1 20,0 -20,0\n";
    tell(&(floor.to_owned() + "pawl p at 0,3: 0,0 0,-5 1,-2; start 1/2\n move 2,1 for 3/2"))
        .events("1 | 1/3 | stick | B1@floor.2");
    tell(&(floor.to_owned() + "pawl p at 0,4: 0,0 0,-5 1,-2; start 1/3\n move 1,2 for 1/4"))
        .outcome("completed 1/4");
}
