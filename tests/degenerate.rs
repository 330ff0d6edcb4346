//! Degenerate scenes by construction, with answers worked out by hand. The pawls and their
//! Pythagorean turns are those of `events.rs` and `rules.rs`, where more of the kind stand: seams
//! and split edges, walls, duplicated obstacles, a snap that a vertex stops just in time, contact
//! exactly at θ = π/2, π, 3π/2 and 2π.
#![allow(clippy::unwrap_used)]

#[path = "common/hand.rs"]
mod hand;
use hand::{ARM, FLOOR, on_floor, q, scene, tell, tell_scene, two_to};
use snapfit::geometry::Vec2;
use snapfit::number::Rat;
use snapfit::scene::{Motion, Scene};

/// A scene p ↦ k·p + shift, at the same speed in its own units: times and angles stay.
fn moved(mut s: Scene, k: &Rat, shift: &Vec2) -> Scene {
    let f = |p: &mut Vec2| *p = &p.scale(k) + shift;
    for o in &mut s.obstacles {
        o.vertices.iter_mut().for_each(f);
        o.holes.iter_mut().flatten().for_each(f);
    }
    if let Some(r) = &mut s.root {
        r.vertices.iter_mut().for_each(f);
    }
    for p in &mut s.pawls {
        f(&mut p.hinge);
        p.vertices.iter_mut().for_each(f);
    }
    for m in &mut s.motions {
        if let Motion::Translate { velocity, .. } = m {
            *velocity = velocity.scale(k);
        }
    }
    s
}

// ── coincidences ────────────────────────────────────────────────────────────────────────────

/// A tip and a heel land on different obstacles at exactly t = 2: 6 − 2 − 4 = 0 and
/// 6 − 2 − 7/4 = 9/4. The tip is nearer to the hinge and is followed.
#[test]
fn two_unrelated_landings_at_one_time() {
    on_floor(
        "block: 5,2 8,2 8,9/4 5,9/4
         pawl p at 0,6: 0,0 3,-4 3,0 6,-7/4 6,1 0,1
         move 0,-1 for 3",
    )
    .events(
        "2 | 0 | translational-collision | B1@floor.2 / B1@floor.2 B3@block.2
         3 | 1/7 | phase-end
         3 | 1/7 | plan-end",
    )
    .segments("p", "0 | 2 | free\n 2 | 3 | B1@floor.2");
}

/// Two contacts change places at an irrational angle, by accident and not by name: the heel
/// (6,−8) = 2·(3,−4) lands on a block at −7/2 when h = 9/2. With it on the block and the tip on
/// the floor h + 2r_y = −7/2 and h + r_y = 0: h = 7/2, t = 5/2, where 3 sin θ − 4 cos θ = −7/2:
/// 15u² + 12u − 1 = 0, u = (−6 + √51)/15.
#[test]
fn two_unrelated_contacts_at_an_irrational_angle() {
    tell(
        "floor: -20,-1 4,-1 4,0 -20,0
         block: 5,-5 9,-5 9,-7/2 5,-7/2
         pawl p at 0,6: 0,0 3,-4 4,-1 6,-8 8,0
         move 0,-1 for 11/4",
    )
    .events(
        "3/2 | 0 | translational-collision | B3@block.2
         5/2 | -2/5+1/15√51 | sliding-collision | B1@floor.2
         11/4 | root(-3, 24, 29) near 0.11 | phase-end
         11/4 | root(-3, 24, 29) near 0.11 | plan-end",
    )
    .segments(
        "p",
        "0 | 3/2 | free\n 3/2 | 5/2 | B3@block.2\n 5/2 | 11/4 | B1@floor.2",
    );
}

/// A tip falls exactly into a groove's reflex corner: (4,3)·dθ runs into the right wall,
/// −(4,3)·dθ into the left one.
#[test]
fn into_a_reflex_corner() {
    tell(
        "groove: -5,-3 5,-3 5,5 0,0 -5,5
         pawl p at -3,6: 0,0 3,-4 4,-1
         move 0,-1 for 5",
    )
    .events("2 | 0 | jam-incompatible | B1@groove.2 B1@groove.3")
    .outcome("jammed 2 p");
}

// ── grazes ──────────────────────────────────────────────────────────────────────────────────

/// A flat bottom carried at rest exactly along a floor and off its end: touching, never held.
#[test]
fn at_rest_along_an_edge_and_off_its_end() {
    tell(
        "floor: -20,-1 6,-1 6,0 -20,0
         pawl p at 0,4: 0,0 5/2,-4 4,-4 5,-1
         move 1,0 for 9
         reverse",
    )
    .events(
        "?2 | 0 | graze
         ?7/2 | 0 | graze
         9 | 0 | phase-end
         ?29/2 | 0 | graze
         ?16 | 0 | graze
         18 | 0 | phase-end
         18 | 0 | plan-end",
    )
    .outcome("completed 18");
}

/// A bar's lower edge passes flush over the tip of a peg, 1 below the hinge. While the tip is
/// ahead of the hinge (c > 0) the turns 0 … 2ψ are free, tan ψ = c; once it is behind, −2ψ … 0.
/// The two meet in the point c = 0 only: closed, although θ = 0 would touch all along.
#[test]
fn an_edge_flush_over_a_tip_below_the_hinge() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -9,1: -1,-1 1,-1 1,1 -1,1
         move 1,0 for 18",
    )
    .events("?8 | 0 | graze\n 9 | 0 | jam-single | A0@peg.0")
    .outcome("jammed 9 p");
}

/// A vertex that is the hinge passes exactly by an obstacle's corner, with free space on both
/// sides.
#[test]
fn the_hinge_passes_a_corner() {
    tell(
        "o: 0,0 -3,1 -3,-1
         pawl p at 0,3: 0,0 4,-1 4,1
         move 0,-1 for 6",
    )
    .events("?3 | 0 | graze\n 6 | 0 | phase-end\n 6 | 0 | plan-end")
    .outcome("completed 6");
}

/// The pawl's edge runs through the hinge and the peg's tip lies on the hinge's path: w = 0 at
/// t = 3, whatever the turn. Above it the edge comes down on the tip: a wall.
#[test]
fn an_obstacles_vertex_on_the_path_of_the_hinge() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at 0,3: -3,0 3,0 0,2
         move 0,-1 for 5",
    )
    .events("3 | 0 | jam-single | A0@peg.0")
    .outcome("jammed 3 p");
    // Along the edge the tip is touched from c = 3 on, with free space above; behind the hinge
    // there is free space only below, and the two meet in a point: closed at c = 0, by the wall.
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -5,0: -3,0 3,0 0,2
         move 1,0 for 10",
    )
    .events("?2 | 0 | graze\n 5 | 0 | jam-single | A0@peg.0")
    .outcome("jammed 5 p");
}

/// A curve of type A with two factors. The hinge moves along the bar's own lower edge, so the
/// peg's tip stays on it at u = 1/3, c = 3 − 5t from the foot of the hinge; the other factor is
/// θ + 2ψ, tan ψ = c, where the tip would touch on the far side of the foot. Free is what lies
/// between: at c = 0, t = 3/5, where |w| is the bar's distance, every turn penetrates.
#[test]
fn a_curve_that_factors() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -3,-1: -1,-1 9,-1 9,1 -1,1; start 1/3
         move 4,3 for 1",
    )
    .events("3/5 | 1/3 | jam-single | A0@peg.0")
    .segments("p", "0 | 3/5 | A0@peg.0")
    .outcome("jammed 3/5 p");
}

// ── slots ───────────────────────────────────────────────────────────────────────────────────

/// A bar one wide, with a prow, over a slot between two blocks. The prow's sides leave less and
/// less turn until the shoulders are between the corners, at t = 1. (A blunt bar could tilt onto
/// either block; with the prow a turn by δ moves the shoulder 4δ into the block and only δ/2 up.)
fn slot(clearance: &Rat) -> hand::Told {
    let mut s = scene(
        "left: -9,-9 -1/2,-9 -1/2,0 -9,0
         right: 1/2,-9 9,-9 9,0 1/2,0
         pawl p at 0,5: 0,-5 1/2,-4 1/2,0 -1/2,0 -1/2,-4
         move 0,-1 for 3",
    );
    for k in [0, 3] {
        s.obstacles[1].vertices[k].x += clearance;
    }
    tell_scene(s)
}

/// Of exactly zero clearance: it does not open.
#[test]
fn a_slot_of_zero_clearance() {
    slot(&Rat::zero())
        .events("1 | 0 | jam-incompatible")
        .outcome("jammed 1 p");
}

/// Of clearance 2⁻²⁰⁰: it opens, and rest lies in it.
#[test]
fn a_slot_of_the_least_clearance() {
    slot(&two_to(-200))
        .outcome("completed 3")
        .segments("p", "0 | 3 | free");
}

/// Started inside: of zero clearance there is no interval at all.
#[test]
fn a_start_inside_a_slot() {
    for (right, outcome) in [("1/2", "jammed 0 p"), ("501/1000", "completed 3")] {
        tell(&format!(
            "left: -9,-9 -1/2,-9 -1/2,0 -9,0
             right: {right},-9 9,-9 9,0 {right},0
             pawl p at 0,3: -1/2,-4 1/2,-4 1/2,0 -1/2,0
             move 0,-1 for 3"
        ))
        .outcome(outcome);
    }
}

/// The blunt bar over the slot of zero clearance: it tilts, either way.
#[test]
fn a_blunt_bar_over_a_slot_bifurcates() {
    tell(
        "left: -9,-9 -1/2,-9 -1/2,0 -9,0
         right: 1/2,-9 9,-9 9,0 1/2,0
         pawl p at 0,5: -1/2,-4 1/2,-4 1/2,0 -1/2,0
         move 0,-1 for 3",
    )
    .events("1 | 0 | bifurcation | A0@left.2 A0@right.3")
    .outcome("bifurcated 1 p");
}

// ── flush ───────────────────────────────────────────────────────────────────────────────────

/// Two vertices come down flush at t = 3, u = 1/7, at x = 4 and 23/12, and are dragged to the left
/// off the shelf's end at x = 1: first the near one (11/12 later), from where the shelf's corner
/// lies under the edge between them, then the far one (3 later): nothing holds any more.
#[test]
fn flush_along_an_edge_and_off_its_end() {
    tell(
        "shelf: 1,-1 20,-1 20,0 1,0
         pawl p at 0,6: 0,0 1,-41/12 3,-4 4,-1
         move 0,-1 for 3
         move -1,0 for 4",
    )
    .events(
        "2 | 0 | translational-collision | B2@shelf.2
         3 | 1/7 | sliding-collision | B1@shelf.2
         3 | 1/7 | phase-end
         ?47/12 | 1/7 | sliding-collision
         6 | 1/7 > 0 | snap-free-vertex
         7 | 0 | phase-end
         7 | 0 | plan-end",
    )
    .segments(
        "p",
        "0 | 2 | free
         2 | 3 | B2@shelf.2
         3 | 47/12 | B1@shelf.2 B2@shelf.2
         47/12 | 6 | B2@shelf.2 A1@shelf.3
         6 | 7 | free",
    );
}

/// A snap that lands exactly on a corner: as `snap_landing_type_b`, with the low floor ending at
/// the landing place (1,−1). Just after, the tip is on top of it.
#[test]
fn a_snap_that_lands_on_a_corner() {
    tell(
        "shelf: 2,-1/2 20,-1/2 20,0 2,0
         low: -20,-2 1,-2 1,-1 -20,-1
         pawl p at 0,3: 0,0 0,-5 1,-2; start 1/2
         move -1,0 for 4",
    )
    .events(
        "2 | 1/2 > 1/3 | snap-free-vertex | B1@shelf.2
         2 | 1/3 | snap-landing | B1@low.2
         4 | 1/3 | phase-end
         4 | 1/3 | plan-end",
    )
    .segments("p", "0 | 2 | B1@shelf.2\n 2 | 4 | B1@low.2");
}

/// The swing lands on the low floor at r = (3,−4): exactly θ = π/2, where the charts meet.
#[test]
fn a_snap_that_lands_on_the_seam_of_the_charts() {
    for (sign, u) in [("", "1"), ("-", "-1")] {
        // The second time mirrored in the y-axis.
        let text = match sign {
            "" => {
                "shelf: 2,-1/2 20,-1/2 20,0 2,0
                 low: -20,-2 3/2,-2 3/2,-1 -20,-1
                 pawl p at 0,3: 0,0 -4,-3 -1,-2; start 4/3
                 move -1,0 for 4"
            }
            _ => {
                "shelf: -2,-1/2 -20,-1/2 -20,0 -2,0
                 low: 20,-2 -3/2,-2 -3/2,-1 20,-1
                 pawl p at 0,3: 0,0 4,-3 1,-2; start -4/3
                 move 1,0 for 4"
            }
        };
        tell(text).events(&format!(
            "2 | {sign}4/3 > {u} | snap-free-vertex | B1@shelf.2
             2 | {u} | snap-landing | B1@low.2
             4 | {u} | phase-end
             4 | {u} | plan-end"
        ));
    }
}

/// A wall that ends exactly at the state: the hinge is a vertex and the edge beside it comes down
/// flush, so the wall holds from θ = 0 upwards.
#[test]
fn a_wall_that_ends_at_the_state() {
    for pawl in ["0,0 3,0 0,2", "0,0 -3,0 0,2"] {
        on_floor(&format!("pawl p at 0,3: {pawl}\n move 0,-1 for 5"))
            .events("3 | 0 | jam-single / jam-incompatible")
            .outcome("jammed 3 p");
    }
}

// ── friction, exactly critical ──────────────────────────────────────────────────────────────

fn with_friction(text: &str, mu: &Rat) -> hand::Told {
    let mut s = scene(text);
    s.friction = Some(mu.clone());
    tell_scene(s)
}

/// Type B: the arm lands with r = (3,−4) and leaves the ray of μ = 3/4 at once.
#[test]
fn critical_friction_type_b() {
    let text = FLOOR.to_owned() + ARM + "move 0,-1 for 3";
    let (critical, tiny) = (q("3/4"), two_to(-100));
    with_friction(&text, &critical).outcome("completed 3");
    with_friction(&text, &(&critical - &tiny)).outcome("completed 3");
    with_friction(&text, &(&critical + &tiny)).outcome("stuck 2 p");
}

/// Type A: the bar lands with the tip at (1,−1) of its frame and moves into the cone of μ = 1; a
/// little less friction holds a little later, when c = h = μ.
#[test]
fn critical_friction_type_a() {
    let text = "peg: 0,0 -1,-3 1,-3
         pawl p at -1,5: -2,-1 9,-1 9,1 -2,1
         move 0,-1 for 6";
    let (critical, tiny) = (Rat::one(), two_to(-100));
    with_friction(text, &critical).outcome("stuck 4 p");
    with_friction(text, &(&critical + &tiny)).outcome("stuck 4 p");
    let later = Rat::from(4) + &tiny;
    with_friction(text, &(&critical - &tiny)).outcome(&format!("stuck {later} p"));
}

/// Held for good or not at all: a parallel translation on the ray and to either side of it.
#[test]
fn critical_friction_in_parallel_translation() {
    let text = FLOOR.to_owned() + "pawl p at 0,4: 0,0 0,-5 1,-2; start 1/3\n move 1,0 for 3";
    let (critical, tiny) = (q("3/4"), two_to(-100));
    with_friction(&text, &critical).outcome("completed 3");
    with_friction(&text, &(&critical - &tiny)).outcome("completed 3");
    with_friction(&text, &(&critical + &tiny)).outcome("stuck 0 p");
}

// ── sizes ───────────────────────────────────────────────────────────────────────────────────

const STEP: &str = "floor: -20,-1 20,-1 20,H 7/2,H 7/2,0 -20,0
    pawl p at 0,6: 0,0 -1,-2 3,-4
    move 0,-1 for 3";

/// A step of height H, however small, in the way of the tip at x = 7/2: the part of free space
/// that the state is in closes between the floor and the step's side when r = (7/2, −√51/2):
/// t = 6 − √51/2, u = (28 − 3√51)/(71 + 4√51) = (8 − √51)/13.
#[test]
fn a_step_however_small() {
    for h in ["1", "1e-9", "1e-60"] {
        tell(&STEP.replace('H', h))
            .events(
                "2 | 0 | translational-collision | B2@floor.4
                 6-1/2√51 | 8/13-1/13√51 | jam-incompatible | B2@floor.3 B2@floor.4",
            )
            .outcome("jammed 6-1/2√51 p");
    }
}

/// Everything scaled by 10¹² and shifted by 10⁹, with a feature of 10⁻⁹ in the end: no answer
/// changes.
#[test]
fn large_and_shifted_with_small_features() {
    let k = q("1e12");
    let shift = Vec2::new(q("1e9"), q("-1e9"));
    for text in [STEP.replace('H', "1e-21"), STEP.replace('H', "1/3")] {
        tell_scene(moved(scene(&text), &k, &shift))
            .events(
                "2 | 0 | translational-collision | B2@floor.4
                 6-1/2√51 | 8/13-1/13√51 | jam-incompatible | B2@floor.3 B2@floor.4",
            )
            .outcome("jammed 6-1/2√51 p");
    }
    let corner = "floor: -20,-1 4,-1 4,0 -20,0
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 4";
    for k in [q("1e12"), q("1e-12")] {
        tell_scene(moved(scene(corner), &k, &shift)).events(
            "2 | 0 | translational-collision | B1@floor.2
             3 | 1/7 | sliding-collision | A0@floor.2
             4 | -2+√5 | phase-end
             4 | -2+√5 | plan-end",
        );
    }
}

/// A spike 2·10⁻³⁰ wide is as good as a peg.
#[test]
fn a_spike() {
    tell(
        "spike: 0,0 -1e-30,-3 1e-30,-3
         pawl p at -3,5: -1,-1 9,-1 9,1 -1,1
         move 0,-1 for 6",
    )
    .events(
        "4 | 0 | translational-collision | A0@spike.0
         6 | 1/3 | phase-end
         6 | 1/3 | plan-end",
    );
}

// ── obstacles of every sort ─────────────────────────────────────────────────────────────────

/// A pawl in a hole: it lands on the hole's lower side, wherever the hole's listing begins and
/// whichever way it runs.
#[test]
fn inside_a_hole() {
    for (hole, edge) in [
        ("-10,0 10,0 10,15 -10,15", 0),
        ("10,15 10,0 -10,0 -10,15", 1),
    ] {
        tell(&format!(
            "frame: -20,-20 20,-20 20,20 -20,20
             frame hole: {hole}
             pawl p at 0,6: 0,0 3,-4 4,-1
             move 0,-1 for 3"
        ))
        .events(&format!(
            "2 | 0 | translational-collision | B1@frame:1.{edge}
             3 | 1/7 | phase-end
             3 | 1/7 | plan-end"
        ));
    }
}

/// Blocks that overlap, with one top: both hold where both are.
#[test]
fn overlapping_obstacles() {
    tell(
        "left: -20,-1 5,-1 5,0 -20,0
         right: 2,-2 20,-2 20,0 2,0
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 3",
    )
    .events(
        "2 | 0 | translational-collision | B1@left.2 B1@right.2
         3 | 1/7 | phase-end
         3 | 1/7 | plan-end",
    )
    .segments("p", "0 | 2 | free\n 2 | 3 | B1@left.2 B1@right.2");
}

/// What is buried inside another obstacle is not there: a corner under the surface, and a corner
/// of one block inside the other where the tip passes.
#[test]
fn buried_features() {
    on_floor(
        "buried: 3,-1/2 5,-1/2 4,-1/8
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 3",
    )
    .events(
        "2 | 0 | translational-collision | B1@floor.2
         3 | 1/7 | phase-end
         3 | 1/7 | plan-end",
    )
    .segments("p", "0 | 2 | free\n 2 | 3 | B1@floor.2");
}

/// A reflex vertex makes no contact of its own. The notch's corner (0,−2) comes down on the tip
/// of a narrow peg at t = 3: what touches are the notch's two edges. The left one pushes with
/// (−2,3) and turns the pawl clockwise (r × f = −4), the right one counter-clockwise.
#[test]
fn a_reflex_vertex_does_not_touch() {
    tell(
        "peg: 0,0 -1/2,-4 1/2,-4
         pawl p at 0,5: -3,-4 0,-2 3,-4 3,0 -3,0
         move 0,-1 for 5",
    )
    .events("3 | 0 | jam-incompatible | A0@peg.0 A1@peg.0")
    .outcome("jammed 3 p");
}

/// Either listing order, and a listing that begins elsewhere, name other features of the same
/// shapes and change nothing else.
#[test]
fn listings() {
    let story = |e: usize, v: usize| {
        format!(
            "2 | 0 | translational-collision | B{v}@floor.{e}
             3 | 1/7 | phase-end
             3 | 1/7 | plan-end"
        )
    };
    for (floor, e) in [
        ("-20,-1 20,-1 20,0 -20,0", 2),
        ("-20,0 20,0 20,-1 -20,-1", 0),
        ("20,0 -20,0 -20,-1 20,-1", 0),
        ("-20,-1 0,-1 20,-1 20,0 -20,0", 3),
    ] {
        for (pawl, v) in [
            ("0,0 3,-4 4,-1", 1),
            ("4,-1 3,-4 0,0", 1),
            ("3,-4 4,-1 2,-1/2 0,0", 0),
        ] {
            tell(&format!(
                "floor: {floor}\npawl p at 0,6: {pawl}\nmove 0,-1 for 3"
            ))
            .events(&story(e, v));
        }
    }
}

// ── arcs closed around the cylinder ─────────────────────────────────────────────────────────

/// A square about its hinge over a peg's tip: nearer than the half-diagonal 2√2 it can turn only in
/// four windows about 0, 90°, 180°, 270°, of half-width ψ with cos ψ = 2/|w|; the closed pieces between
/// them end in cusps, corner on tip, and all their ends together run around the cylinder. Started
/// in the window at 90°, |w| = 5/2, tan(ψ/2) = 1/3, it snaps to that window's lower end,
/// (1 − 1/3)/(1 + 1/3) = 1/2; lifted off it is let go at |w| = 2√2, at 45°.
#[test]
fn windows_around_the_cylinder() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at 0,5/2: -2,-2 2,-2 2,2 -2,2; start 1
         move 0,1 for 1",
    )
    .events(
        "0 | 1 > 1/2 | snap-free / snap-free-vertex
         0 | 1/2 | snap-landing | A3@peg.0
         -5/2+2√2 | -1+√2 > 0 | snap-free-vertex | A3@peg.0
         1 | 0 | phase-end
         1 | 0 | plan-end",
    )
    .segments("p", "0 | -5/2+2√2 | A3@peg.0\n -5/2+2√2 | 1 | free");
}

/// Pressed down on the tip instead: the window closes at |w| = 2. From w = (6/5, −2) it is struck at
/// rest, and w = (6/5, −8/5) is the end, u = 1/3.
#[test]
fn a_window_closes() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -6/5,5: -2,-2 2,-2 2,2 -2,2
         move 0,-1 for 5",
    )
    .events(
        "3 | 0 | translational-collision | A0@peg.0
         17/5 | 1/3 | jam-single | A0@peg.0",
    );
}
