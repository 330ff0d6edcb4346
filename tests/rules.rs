//! What the model leaves open, as the contract fixes it: one test or more a sentence, answers by
//! hand. The pawls and their Pythagorean turns are those of `events.rs`; further:
//!
//! * *swing*, tip (−4,−3) at rest: (4,−3) is u = 4/3, (3,−4) is 1, (0,−5) is 1/2, (−3,−4) is 1/7.
#![allow(clippy::unwrap_used)]

#[path = "common/hand.rs"]
mod hand;
use hand::{ARM, FLOOR, on_floor, scene, tell};
use snapfit::motion::{Options, OutcomeKind, simulate};
use snapfit::scene::read_scene;

const RIDGE: &str = "ridge: -6,-3 6,-3 0,0\n"; // edge 1 falls to the right, edge 2 rises from the left

// ── Component ───────────────────────────────────────────────────────────────────────────────

/// The arm's tip hangs at y = −1 and is carried over a ridge of height 0. It meets the slope
/// y = x/2 at x = −2 when the hinge is at −5, t = 3, and is highest on the ridge's top, r = (4,−3),
/// u = 1/7, hinge at −4, t = 4: the arm's least turn has its maximum there. A stop at exactly 1/7
/// leaves one point of free space at that instant, more before and after: not connected.
#[test]
fn parts_that_meet_in_a_point_are_not_connected() {
    let told = tell(
        &(RIDGE.to_owned()
            + "pawl p at -8,3: 0,0 3,-4 4,-1; limits -1 1/7
               move 1,0 for 8"),
    );
    told.events(
        "3 | 0 | translational-collision | B1@ridge.2
         4 | 1/7 | jam-incompatible | B1@ridge.2 limit1 / B1@ridge.1 B1@ridge.2 limit1",
    )
    .outcome("jammed 4 p");
}

/// The same with a stop 2⁻²⁰⁰ further: the way is open. On the far slope y = −x/2 the tip comes
/// back to rest, y = −1, at x = 2, hinge at −1, t = 7.
#[test]
fn a_passage_of_the_least_width_opens() {
    let mut s = scene(
        &(RIDGE.to_owned()
            + "pawl p at -8,3: 0,0 3,-4 4,-1; limits -1 1/7
               move 1,0 for 8"),
    );
    let (_, hi) = s.pawls[0].limits.as_mut().unwrap();
    *hi += hand::two_to(-200);
    hand::tell_scene(s)
        .events(
            "3 | 0 | translational-collision | B1@ridge.2
             4 | 1/7 | sliding-collision | B1@ridge.1
             7 | 0 | release | B1@ridge.1
             8 | 0 | phase-end
             8 | 0 | plan-end",
        )
        .outcome("completed 8");
}

/// Two blocks touch along x = 7/2. The tip slides over their common seam when the hinge is
/// √(25 − 49/4) up: a cut, no event, and no way in.
#[test]
fn a_seam_is_no_passage_and_no_event() {
    tell(
        "left: -20,-1 7/2,-1 7/2,0 -20,0
         right: 7/2,-1 20,-1 20,0 7/2,0
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 3",
    )
    .events(
        "2 | 0 | translational-collision | B1@left.2
         3 | 1/7 | phase-end
         3 | 1/7 | plan-end",
    )
    .segments(
        "p",
        "0 | 2 | free
         2 | 6-1/2√51 | B1@left.2
         6-1/2√51 | 3 | B1@right.2",
    );
}

/// The same for one block whose top edge is split in two.
#[test]
fn the_joint_of_a_split_edge_is_no_event() {
    tell(
        "floor: -20,-1 20,-1 20,0 7/2,0 -20,0
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 3",
    )
    .events(
        "2 | 0 | translational-collision | B1@floor.3
         3 | 1/7 | phase-end
         3 | 1/7 | plan-end",
    )
    .segments(
        "p",
        "0 | 2 | free
         2 | 6-1/2√51 | B1@floor.3
         6-1/2√51 | 3 | B1@floor.2",
    );
}

/// And for a pawl's split edge. The peg's tip is at c = √(8 + w_y²) along the lower edge: 3 at
/// the landing (w_y = −1, t = 4), √8 at t = 5, 3 again at t = 6; the joint at 29/10 is passed at
/// w_y = ∓√41/10.
#[test]
fn the_joint_of_a_pawls_split_edge_is_no_event() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -3,5: -1,-1 29/10,-1 9,-1 9,1 -1,1
         move 0,-1 for 6",
    )
    .events(
        "4 | 0 | translational-collision | A1@peg.0
         6 | 1/3 | phase-end
         6 | 1/3 | plan-end",
    )
    .segments(
        "p",
        "0 | 4 | free
         4 | 5-1/10√41 | A1@peg.0
         5-1/10√41 | 5+1/10√41 | A0@peg.0
         5+1/10√41 | 6 | A1@peg.0",
    );
}

/// The hinge moves along a floor exactly as far below it as the tip is long: the tip only just
/// reaches the floor's line at u = −1/3, with free space on both sides. The pawl, let go at
/// u = −3/4, snaps through it to rest.
#[test]
fn a_touch_with_free_space_on_both_sides_is_no_barrier() {
    on_floor(
        "pawl p at 0,5: 0,0 3,-4 5/2,-5/2; start -3/4
         move 1,0 for 3",
    )
    .events(
        "0 | -3/4 > 0 | snap-free / snap-free-vertex
         3 | 0 | phase-end
         3 | 0 | plan-end",
    )
    .segments("p", "0 | 3 | free");
}

// ── Right limit ─────────────────────────────────────────────────────────────────────────────

/// The swing is dragged off the shelf's end at t = 2 (hinge (−2,3)) and snaps towards rest. The
/// peg's tip, at (−3,−4) from the hinge then, lies on the circle of the swing's tip and comes
/// inside just then: it stops the snap, exactly vertex on vertex, u = 1/7. One instant later the
/// swing's tip meets the peg's right flank 2x + y = −10 + 2s (s = t − 2, from the hinge) below its
/// top; at s = 5/2 it is at (0,−5), u = 1/2.
#[test]
fn what_begins_just_then_stops_a_snap() {
    tell(
        "shelf: 2,-1/2 20,-1/2 20,0 2,0
         peg: -5,-1 -6,-3 -4,-3
         pawl p at 0,3: 0,0 -4,-3 -1,-2; start 4/3
         move -1,0 for 9/2",
    )
    .events(
        "2 | 4/3 > 1/7 | snap-free-vertex | B1@shelf.2
         2 | 1/7 | snap-landing | B1@peg.2
         9/2 | 1/2 | phase-end
         9/2 | 1/2 | plan-end",
    )
    .segments("p", "0 | 2 | B1@shelf.2\n 2 | 9/2 | B1@peg.2");
}

/// The arm on the shelf's end at t = 5, as in `snap_free_vertex`; a peg's tip lies at
/// (697,−696)/197 from the hinge, on the circle of the arm's tip half-way down (u = 1/14), and
/// leaves it just then: it does not stop the snap.
#[test]
fn what_ends_just_then_does_not() {
    tell(
        "shelf: 2,-1/8 20,-1/8 20,0 2,0
         peg: 303/197,-105/197 7/5,-3 17/10,-3
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 3
         move -1,0 for 4",
    )
    .events(
        "2 | 0 | translational-collision | B1@shelf.2
         3 | 1/7 | phase-end
         5 | 1/7 > 0 | snap-free-vertex | B1@shelf.2
         7 | 0 | phase-end
         7 | 0 | plan-end",
    );
}

// ── Jumps ───────────────────────────────────────────────────────────────────────────────────

/// A wall meets a state that is held elsewhere, in the middle of the wall's orientations: a jam.
#[test]
fn a_wall_is_a_jam_never_a_move_away_from_rest() {
    on_floor(
        "pawl p at 0,3: 0,0 1,2 -1,2; start 1/7; limits 1/7 1/2
         move 0,-1 for 5",
    )
    .events(
        "?0 | 1/7 | limit-stop | limit0
         3 | 1/7 | jam-single | B0@floor.2 / B0@floor.2 limit0",
    )
    .outcome("jammed 3 p");
}

/// Leaving a wall is nothing.
#[test]
fn leaving_a_wall_is_free() {
    on_floor("pawl p at 0,0: 0,0 1,2 -1,2\n move 0,1 for 1\n move 1,0 for 1\n reverse")
        .events(
            "1 | 0 | phase-end
             2 | 0 | phase-end
             3 | 0 | phase-end
             3 | 0 | plan-end",
        )
        .segments("p", "0 | 1 | free\n 1 | 2 | free\n 2 | 3 | free");
}

// ── Splits ──────────────────────────────────────────────────────────────────────────────────

/// A kite whose lower point follows the floor back towards rest while the hinge rises: at t = 1,
/// h = 4, u = 1/3 (r = (3,−4)), dθ/dt = −1/3. Just then its upper point, 5 straight above the
/// hinge, meets the point of an obstacle at (0,9). Both points have half-angle atan 1/2, so from
/// there on orientations within (t − 1)/10 of u = 1/3 are closed: a new piece of closed space
/// begins on the state, and leaves a cusp between itself and the state's curve, since
/// 1/10 < 1/3. The state keeps to the part that borders its curve: at t = 3/2, h = 9/2,
/// cos θ = 9/10, u = √19/19.
#[test]
fn away_from_rest_the_state_keeps_to_its_curve() {
    on_floor(
        "q: 0,9 1,11 -1,11
         pawl p at 0,3: 0,-5 11/5,-2/5 3,4 -1,2; start 1/2
         move 0,1 for 3/2",
    )
    .events(
        "?1 | 1/3 | graze
         3/2 | 1/19√19 | phase-end
         3/2 | 1/19√19 | plan-end",
    )
    .outcome("completed 3/2");
}

/// A blunter obstacle (half-angle atan 2) closes 2(t − 1)/5 to either side, more than the state's
/// curve gives way: it takes over and turns the pawl back, with the kite's upper point on its
/// left edge. At t = 19/10 that point is at (−7/5, 24/5): 24/5 = (5 − 9/10) + 7/10; u = 1/2.
#[test]
fn a_new_piece_that_covers_the_curve_takes_over() {
    on_floor(
        "q: 0,9 4,11 -4,11
         pawl p at 0,3: 0,-5 11/5,-2/5 3,4 -1,2; start 1/2
         move 0,1 for 19/10",
    )
    .events(
        "1 | 1/3 | sliding-collision | B2@q.2
         19/10 | 1/2 | phase-end
         19/10 | 1/2 | plan-end",
    )
    .segments("p", "0 | 1 | B0@floor.2\n 1 | 19/10 | B2@q.2");
}

/// The mirror image of the cusp: θ < 0.
#[test]
fn away_from_rest_the_state_keeps_to_its_curve_mirrored() {
    on_floor(
        "q: 0,9 1,11 -1,11
         pawl p at 0,3: 0,-5 -11/5,-2/5 -3,4 1,2; start -1/2
         move 0,1 for 3/2",
    )
    .events(
        "?1 | -1/3 | graze
         3/2 | -1/19√19 | phase-end
         3/2 | -1/19√19 | plan-end",
    );
}

fn branches(told: &hand::Told) -> Vec<(i32, String, bool)> {
    let b = &told.trajectory.outcome.branches;
    b.iter()
        .map(|b| (b.direction, told.contact(&b.contacts[0]), b.sticks))
        .collect()
}

/// Tip on corner: the arm's tip (3,−4) comes down on a peg's tip at t = 2. Counter-clockwise its
/// edge from the hinge slides over the peg's tip (it needs dθ = 3/25 dt, more than the right
/// flank's 1/9); clockwise its tip slides down the left flank (n = (−3,2): dθ = −dt/3).
#[test]
fn tip_on_corner_bifurcates() {
    let told = tell(
        "peg: 0,0 -2,-3 2,-3
         pawl p at -3,6: 0,0 3,-4 4,-1
         move 0,-1 for 5",
    );
    told.events("2 | 0 | bifurcation").outcome("bifurcated 2 p");
    assert_eq!(
        branches(&told),
        [
            (1, "A0@peg.0".to_owned(), false),
            (-1, "B1@peg.0".to_owned(), false)
        ]
    );
}

/// With friction the left flank holds for μ > 6/17: f = (−3,2) + μ(2,3), r × f = −6 + 17μ. The
/// edge through the hinge cannot be held. One slides, the other holds: still open which.
#[test]
fn one_branch_slides_and_the_other_holds() {
    for (mu, holds) in [("6/17", false), ("1/2", true)] {
        let told = tell(&format!(
            "friction {mu}
             peg: 0,0 -2,-3 2,-3
             pawl p at -3,6: 0,0 3,-4 4,-1
             move 0,-1 for 5"
        ));
        told.events("2 | 0 | bifurcation").outcome("bifurcated 2 p");
        assert_eq!(
            branches(&told),
            [
                (1, "A0@peg.0".to_owned(), false),
                (-1, "B1@peg.0".to_owned(), holds)
            ]
        );
    }
}

/// Tip on the flat below the hinge: on n the contact holds, whichever way, with any friction.
#[test]
fn stuck_where_friction_holds_both() {
    for mu in ["1", "1e-30"] {
        on_floor(&format!(
            "friction {mu}\npawl p at 0,8: 0,0 0,-5 1,-2\n move 0,-1 for 5"
        ))
        .events(
            "?3 | 0 | translational-collision | B1@floor.2
                 3 | 0 | stick | B1@floor.2",
        )
        .outcome("stuck 3 p");
    }
}

// ── Start ───────────────────────────────────────────────────────────────────────────────────

/// The two points of `jam_incompatible` both on the floor from the start: down there is nothing,
/// up there is.
#[test]
fn no_interval_at_the_start_is_a_jam() {
    let two = "pawl p at 0,3: 0,1 -117/25,-44/25 0,-1 3,-4 4,-1; start 1/7\n";
    on_floor(&(two.to_owned() + "move 0,-1 for 1"))
        .events("0 | 1/7 | jam-incompatible | B1@floor.2 B3@floor.2")
        .segments("p", "")
        .outcome("jammed 0 p");
    on_floor(&(two.to_owned() + "move 0,1 for 2"))
        .events(
            "1 | 0 | release | B3@floor.2
             2 | 0 | phase-end
             2 | 0 | plan-end",
        )
        .outcome("completed 2");
}

/// A pawl's vertex at the hinge starts on the floor: a wall, closed from the first instant.
#[test]
fn a_wall_at_the_start_is_a_jam() {
    on_floor("pawl p at 0,0: 0,0 1,2 -1,2\n move 0,-1 for 1")
        .events("0 | 0 | jam-single | B0@floor.2")
        .outcome("jammed 0 p");
}

/// Penetration is refused, for a pawl and for the root.
#[test]
fn penetration_at_the_start_is_an_error() {
    for text in [
        "pawl p at 0,3: 0,0 3,-4 4,-1\n move 0,1 for 1",
        "root: -1,-1/2 1,-1/2 0,5\npawl p at 0,9: 0,0 3,-4 4,-1\n move 0,1 for 1",
    ] {
        let s = scene(&(FLOOR.to_owned() + text));
        assert!(read_scene("x.toml", &s.to_toml()).is_err());
    }
}

/// Let go where nothing holds it, a pawl snaps at time 0.
#[test]
fn start_that_nothing_holds_snaps() {
    on_floor("pawl p at 0,9: 0,0 3,-4 4,-1; start 1/2\n move 0,-1 for 1")
        .events(
            "0 | 1/2 > 0 | snap-free / snap-free-vertex
             1 | 0 | phase-end
             1 | 0 | plan-end",
        )
        .segments("p", "0 | 1 | free");
}

// ── Ends ────────────────────────────────────────────────────────────────────────────────────

/// Nothing runs after an end.
#[test]
fn later_phases_do_not_run() {
    for (text, outcome) in [
        ("pawl p at 0,3: 0,0 1,2 -1,2\n", "jammed 3 p"),
        ("friction 1\npawl p at 0,7: 0,0 3,-4 4,-1\n", "stuck 3 p"),
        ("pawl p at 0,8: 0,0 0,-5 1,-2\n", "bifurcated 3 p"),
        (
            "root: -1,3 1,3 0,5\npawl p at 0,90: 0,0 1,0 0,1\n",
            "root-collision 3",
        ),
    ] {
        let told = on_floor(&(text.to_owned() + "move 0,-1 for 5\nmove 0,1 for 5\nreverse"));
        told.outcome(outcome);
        assert_eq!(told.trajectory.phases.len(), 1);
        let kinds: Vec<&str> = told.trajectory.pawls[0]
            .events
            .iter()
            .map(|e| e.kind.name())
            .collect();
        assert!(
            !kinds.contains(&"phase-end") && !kinds.contains(&"plan-end"),
            "{kinds:?}"
        );
    }
}

/// `jam_incompatible` with a phase that ends at t = 3: the second contact is told, the jam belongs
/// to the next phase that goes on down, and to nothing where it goes back up.
#[test]
fn a_jam_at_the_last_instant_belongs_to_the_next_phase() {
    let two = "pawl p at 0,6: 0,1 -117/25,-44/25 0,-1 3,-4 4,-1\n move 0,-1 for 3\n";
    let head = "2 | 0 | translational-collision | B3@floor.2
         3 | 1/7 | sliding-collision | B1@floor.2
         3 | 1/7 | phase-end\n";
    on_floor(two)
        .events(&(head.to_owned() + "3 | 1/7 | plan-end"))
        .outcome("completed 3");
    let told = on_floor(&(two.to_owned() + "move 0,-1 for 1"));
    told.events(&(head.to_owned() + "3 | 1/7 | jam-incompatible | B1@floor.2 B3@floor.2"))
        .outcome("jammed 3 p");
    assert_eq!(told.trajectory.outcome.phase, 1);
    on_floor(&(two.to_owned() + "reverse"))
        .events(
            &(head.to_owned()
                + "4 | 0 | release | B3@floor.2
                   6 | 0 | phase-end
                   6 | 0 | plan-end"),
        )
        .outcome("completed 6");
}

/// `snap_free_vertex` with a phase that ends at t = 5, tip on corner.
#[test]
fn a_snap_at_the_last_instant_belongs_to_the_next_phase() {
    let head = "shelf: 2,-1 20,-1 20,0 2,0
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 3
         move -1,0 for 2\n";
    let told = tell(&(head.to_owned() + "move -1,0 for 1"));
    told.events(
        "2 | 0 | translational-collision | B1@shelf.2
         3 | 1/7 | phase-end
         5 | 1/7 | phase-end
         5 | 1/7 > 0 | snap-free-vertex / snap-free
         6 | 0 | phase-end
         6 | 0 | plan-end",
    );
    assert_eq!(told.trajectory.pawls[0].events[3].phase, 2);
    tell(&(head.to_owned() + "reverse"))
        .events(
            "2 | 0 | translational-collision | B1@shelf.2
             3 | 1/7 | phase-end
             5 | 1/7 | phase-end
             7 | 1/7 | phase-end
             7 | 1/7 | plan-end",
        )
        .segments(
            "p",
            "0 | 2 | free
             2 | 3 | B1@shelf.2
             3 | 5 | B1@shelf.2
             5 | 7 | B1@shelf.2",
        );
}

/// `snap_free_type_b` with a phase that ends at the tangency.
#[test]
fn a_tangency_at_the_last_instant_belongs_to_the_next_phase() {
    let head = "pawl p at 0,4: 0,0 3,-4 5/2,-5/2; start -3/4\n move 0,1 for 1\n";
    on_floor(head)
        .events("1 | -1/3 | phase-end\n 1 | -1/3 | plan-end")
        .outcome("completed 1");
    on_floor(&(head.to_owned() + "move 0,1 for 1")).events(
        "1 | -1/3 | phase-end
         1 | -1/3 > 0 | snap-free / snap-free-vertex
         2 | 0 | phase-end
         2 | 0 | plan-end",
    );
}

/// There a reverse goes back the way it came: at t = 2 the hinge is 4 up again, u = −3/4.
#[test]
fn a_reverse_at_a_tangency_goes_back_the_way_it_came() {
    on_floor(
        "pawl p at 0,4: 0,0 3,-4 5/2,-5/2; start -3/4
         move 0,1 for 1
         reverse",
    )
    .events(
        "1 | -1/3 | phase-end
         2 | -3/4 | phase-end
         2 | -3/4 | plan-end",
    );
}

/// `stick_type_b` with a phase that ends on the ray, t = 1.
#[test]
fn a_stick_at_the_last_instant_belongs_to_the_next_phase() {
    let head = "friction 3/4\n pawl p at 0,3: 0,0 0,-5 1,-2; start 1/2\n move 2,1 for 1\n";
    on_floor(head)
        .events("1 | 1/3 | phase-end\n 1 | 1/3 | plan-end")
        .outcome("completed 1");
    on_floor(&(head.to_owned() + "move 2,1 for 1"))
        .events("1 | 1/3 | phase-end\n 1 | 1/3 | stick | B1@floor.2")
        .outcome("stuck 1 p");
    // Backwards the friction pulls the other way: r_x + μh > 0.
    on_floor(&(head.to_owned() + "reverse"))
        .events("1 | 1/3 | phase-end\n 2 | 1/2 | phase-end\n 2 | 1/2 | plan-end")
        .outcome("completed 2");
}

/// A reverse lasts as long as its phase really did: shortened from 20 to 10 by the root.
#[test]
fn reverse_of_a_shortened_phase() {
    let told = on_floor(
        "root: -2,10 2,10 2,12 -2,12
         pawl p at 10,12: 0,0 3,-4 4,-1
         move 0,-1 until root-collision for 20
         reverse",
    );
    told.events(
        "8 | 0 | translational-collision | B1@floor.2
         10 | root(-1, 3, 3) near 0.26 | root-collision | root-B0@floor.2 root-B1@floor.2
         10 | root(-1, 3, 3) near 0.26 | phase-end
         12 | 0 | release | B1@floor.2
         20 | 0 | phase-end
         20 | 0 | plan-end",
    )
    .outcome("completed 20");
}

/// `until` where the root never collides needs a bound, and with one the phase lasts that long.
#[test]
fn until_root_collision_without_one() {
    let text = "root: -2,10 2,10 2,12 -2,12\npawl p at 30,50: 0,0 1,0 0,1\n".to_owned();
    on_floor(&(text.clone() + "move 0,1 until root-collision for 4"))
        .events("4 | 0 | phase-end\n 4 | 0 | plan-end")
        .outcome("completed 4");
    let s = scene(&(FLOOR.to_owned() + &text + "move 0,1 until root-collision"));
    let refused =
        read_scene("x.toml", &s.to_toml()).is_err() || simulate(&s, &Options::default()).is_err();
    assert!(refused);
}

/// Touching and sliding along is no root collision.
#[test]
fn a_root_that_slides_along_does_not_collide() {
    on_floor(
        "root: -2,0 2,0 2,2 -2,2
         pawl p at 30,50: 0,0 1,0 0,1
         move 1,0 for 4
         move 0,1 for 1
         reverse",
    )
    .outcome("completed 6");
    // It slides along the floor until it meets a step at x = 5: 3 from its right side.
    on_floor(
        "step: 5,0 6,0 6,1 5,1
         root: -2,0 2,0 2,2 -2,2
         pawl p at 30,50: 0,0 1,0 0,1
         move 1,0 for 4",
    )
    .outcome("root-collision 3");
}

// ── Sticking ────────────────────────────────────────────────────────────────────────────────

/// At a change of constraint: with μ = 7/10 the first point slides from its landing on (3 > 4μ),
/// the second, at (23/12, −3) when it comes down flush, does not (23/12 < 3μ).
#[test]
fn sticks_at_a_change_of_constraint() {
    on_floor(
        "friction 7/10
         pawl p at 0,6: 0,0 1,-41/12 3,-4 4,-1
         move 0,-1 for 7/2",
    )
    .events(
        "2 | 0 | translational-collision | B2@floor.2
         3 | 1/7 | sliding-collision | B1@floor.2
         3 | 1/7 | stick | B1@floor.2",
    )
    .outcome("stuck 3 p");
}

/// It is the contact that the state follows *next* that counts. Landing flush with (5/2,−4) and
/// (4,−4), the nearer one is followed, and it alone decides: it is held for 5/2 < 4μ, where the
/// farther one would slide (4 > 4μ).
#[test]
fn the_contact_that_follows_next_decides() {
    let pawl = "pawl p at 0,6: 0,0 5/2,-4 4,-4 5,-1\n move 0,-1 for 5/2";
    for (mu, sticks) in [("3/5", false), ("5/8", false), ("7/10", true)] {
        let told = on_floor(&format!("friction {mu}\n{pawl}"));
        let kind = told.trajectory.outcome.kind;
        assert_eq!(kind == OutcomeKind::Stuck, sticks, "{}", told.full());
    }
}

/// On the ray alone it slides: at a landing that leaves the ray at once (r = (3,−4), μ = 3/4),
/// and all along a parallel translation on the ray.
#[test]
fn on_the_ray_alone_it_slides() {
    on_floor(&("friction 3/4\n".to_owned() + ARM + "move 0,-1 for 3")).outcome("completed 3");
    on_floor(
        "friction 3/4
         pawl p at 0,4: 0,0 0,-5 1,-2; start 1/3
         move 1,0 for 3",
    )
    .segments("p", "0 | 3 | B1@floor.2")
    .outcome("completed 3");
}

/// Inside the cone just after, though on the ray then: it sticks.
#[test]
fn inside_just_after_sticks() {
    on_floor(
        "friction 3/4
         pawl p at 0,4: 0,0 0,-5 1,-2; start 1/3
         move 2,1 for 1",
    )
    .events("0 | 1/3 | stick | B1@floor.2")
    .outcome("stuck 0 p");
}

/// At rest, parallel translation never sticks, whatever μ.
#[test]
fn parallel_translation_at_rest_never_sticks() {
    for v in ["1,0", "-1,0"] {
        on_floor(&format!(
            "friction 100\npawl p at 0,4: 0,0 3,-4 4,-1\n move {v} for 3"
        ))
        .events("3 | 0 | phase-end\n 3 | 0 | plan-end")
        .segments("p", "0 | 3 | free")
        .outcome("completed 3");
    }
}

/// Nor does leaving the contact.
#[test]
fn leaving_at_rest_never_sticks() {
    on_floor("friction 100\npawl p at 0,4: 0,0 3,-4 4,-1\n move 1,1 for 3")
        .segments("p", "0 | 3 | free")
        .outcome("completed 3");
}

/// Without friction in the scene none is modelled; μ = 0 never holds.
#[test]
fn zero_friction_never_holds() {
    on_floor(&("friction 0\n".to_owned() + ARM + "move 0,-1 for 3")).outcome("completed 3");
    on_floor("friction 0\npawl p at 0,8: 0,0 0,-5 1,-2\n move 0,-1 for 5")
        .outcome("bifurcated 3 p");
}

// ── σ = 0 ───────────────────────────────────────────────────────────────────────────────────

/// Parallel translation keeps θ, both ways (DP Fig. 14).
#[test]
fn parallel_translation_keeps_the_angle() {
    on_floor(&(ARM.to_owned() + "move 0,-1 for 3\n move 1,0 for 2\n reverse\n move 0,1 for 2"))
        .events(
            "2 | 0 | translational-collision | B1@floor.2
             3 | 1/7 | phase-end
             5 | 1/7 | phase-end
             7 | 1/7 | phase-end
             8 | 0 | release | B1@floor.2
             9 | 0 | phase-end
             9 | 0 | plan-end",
        )
        .segments(
            "p",
            "0 | 2 | free
             2 | 3 | B1@floor.2
             3 | 5 | B1@floor.2
             5 | 7 | B1@floor.2
             7 | 8 | B1@floor.2
             8 | 9 | free",
        );
}

/// A stop and a contact that hold together: both are told, the contact first.
#[test]
fn a_stop_and_a_contact_together() {
    on_floor(
        "pawl p at 0,3: 0,0 3,-4 4,-1; start 1/7; limits 1/7 1/2
         move 1,0 for 2",
    )
    .segments("p", "0 | 2 | B1@floor.2 limit0");
}

/// Two vertices flush on the floor, carried along it: one segment, the second contact in `also`.
#[test]
fn contacts_that_hold_together_are_also_told() {
    on_floor(
        "pawl p at 0,6: 0,0 1,-41/12 3,-4 4,-1
         move 0,-1 for 3
         move 1,0 for 1",
    )
    .events(
        "2 | 0 | translational-collision | B2@floor.2
         3 | 1/7 | sliding-collision | B1@floor.2
         3 | 1/7 | phase-end
         4 | 1/7 | phase-end
         4 | 1/7 | plan-end",
    )
    .segments(
        "p",
        "0 | 2 | free
         2 | 3 | B2@floor.2
         3 | 4 | B1@floor.2 B2@floor.2",
    );
}

/// A duplicated obstacle: the same contact twice, named by the first.
#[test]
fn a_duplicated_obstacle_is_also_told() {
    on_floor(&("twin: -20,-1 20,-1 20,0 -20,0\n".to_owned() + ARM + "move 0,-1 for 3"))
        .events(
            "2 | 0 | translational-collision | B1@floor.2 B1@twin.2
             3 | 1/7 | phase-end
             3 | 1/7 | plan-end",
        )
        .segments("p", "0 | 2 | free\n 2 | 3 | B1@floor.2 B1@twin.2");
}

// ── Ties ────────────────────────────────────────────────────────────────────────────────────

/// Every way to end, all at t = 3; the graver one names the outcome, and all are events.
#[test]
fn ties_between_kinds() {
    let wall = "pawl wall at 0,3: 0,0 1,2 -1,2\n";
    let held = "pawl held at 3,7: 0,0 3,-4 4,-1\n";
    let fork = "pawl fork at -9,8: 0,0 0,-5 1,-2\n";
    let root = "root: -1,3 1,3 0,5\n";
    let end = "move 0,-1 for 5";
    let kind = |told: &hand::Told, pawl: usize| -> Vec<String> {
        let e = &told.trajectory.pawls[pawl].events;
        e.iter().map(|e| e.kind.name().to_owned()).collect()
    };

    let told = on_floor(&format!("{fork}{wall}{root}{end}"));
    told.outcome("jammed 3 wall");
    assert_eq!(kind(&told, 0), ["bifurcation", "root-collision"]);
    assert_eq!(kind(&told, 1), ["jam-single", "root-collision"]);

    let told = on_floor(&format!("friction 1\n{held}{wall}{root}{end}"));
    told.outcome("jammed 3 wall");
    assert_eq!(
        kind(&told, 0),
        ["translational-collision", "stick", "root-collision"]
    );

    on_floor(&format!("friction 1\n{held}{root}{end}")).outcome("stuck 3 held");
    on_floor(&format!("{fork}{root}{end}")).outcome("root-collision 3");
    on_floor(&format!("{fork}{end}")).outcome("bifurcated 3 fork");
}

/// Of several pawls the first in the file; one that would end later only runs until then.
#[test]
fn ties_between_pawls() {
    let told = on_floor(
        "pawl late at -9,4: 0,0 1,2 -1,2
         pawl a at 0,3: 0,0 1,2 -1,2
         pawl b at 9,3: 0,0 1,2 -1,2
         move 0,-1 for 5",
    );
    told.outcome("jammed 3 a")
        .story("late", "")
        .story("a", "3 | 0 | jam-single | B0@floor.2")
        .story("b", "3 | 0 | jam-single | B0@floor.2")
        .segments("late", "0 | 3 | free");
}

// ── order of events, starts, winding ────────────────────────────────────────────────────────

/// At t = 1 the tip's curve comes back to rest (h = 4) and, at that very instant, the horn on the
/// left, (−4,3), meets a ceiling 7 up, which turns the pawl the same way. At t = 2 the horn is 2
/// above the hinge, at (−√21, 2): cos = (4√21 + 6)/25, sin = (3√21 − 8)/25, u = (√21 − 4)/5.
#[test]
fn released_and_struck_at_one_instant() {
    let told = on_floor(
        "ceiling: -20,7 -2,7 -2,8 -20,8
         pawl p at 0,3: 3,-4 0,1 -4,3 0,-2; start 1/7
         move 0,1 for 2",
    );
    told.events(
        "?1 | 0 | release | B0@floor.2
         1 | 0 | translational-collision / sliding-collision | B2@ceiling.0
         2 | -4/5+1/5√21 | phase-end
         2 | -4/5+1/5√21 | plan-end",
    )
    .segments("p", "0 | 1 | B0@floor.2\n 1 | 2 | B2@ceiling.0");
}

/// A phase that starts where three curves of free space meet: tip on corner, u = 1/7, the corner
/// at (4,0). Down, the edge slides over the corner; left, the tip stays on the floor; right, the
/// edge comes down on the corner to the direction (9/4,−3), rest, after 7/4.
#[test]
fn a_phase_that_starts_at_a_vertex_of_free_space() {
    let head = "floor: -20,-1 4,-1 4,0 -20,0
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 3\n";
    let story = "2 | 0 | translational-collision | B1@floor.2
         ?3 | 1/7 | sliding-collision
         3 | 1/7 | phase-end\n";
    tell(&(head.to_owned() + "move 0,-1 for 1"))
        .events(&(story.to_owned() + "4 | -2+√5 | phase-end\n 4 | -2+√5 | plan-end"))
        .segments(
            "p",
            "0 | 2 | free\n 2 | 3 | B1@floor.2\n 3 | 4 | A0@floor.2",
        );
    tell(&(head.to_owned() + "move -1,0 for 1"))
        .events(&(story.to_owned() + "4 | 1/7 | phase-end\n 4 | 1/7 | plan-end"))
        .segments(
            "p",
            "0 | 2 | free\n 2 | 3 | B1@floor.2\n 3 | 4 | B1@floor.2",
        );
    tell(&(head.to_owned() + "move 1,0 for 2"))
        .events(
            &(story.to_owned()
                + "19/4 | 0 | release | A0@floor.2
                   5 | 0 | phase-end
                   5 | 0 | plan-end"),
        )
        .segments(
            "p",
            "0 | 2 | free
             2 | 3 | B1@floor.2
             3 | 19/4 | A0@floor.2
             19/4 | 5 | free",
        );
}

/// Two points land flush at once, at rest: the nearer one, (5/2,−4), is followed. At t = 5/2,
/// h = 7/2: (5/2) sin θ − 4 cos θ = −7/2, 15u² + 10u − 1 = 0.
#[test]
fn landing_flush() {
    on_floor("pawl p at 0,6: 0,0 5/2,-4 4,-4 5,-1\n move 0,-1 for 5/2")
        .events(
            "2 | 0 | translational-collision | B1@floor.2 / B1@floor.2 B2@floor.2
             5/2 | root(-1, 10, 15) near 0.09 | phase-end
             5/2 | root(-1, 10, 15) near 0.09 | plan-end",
        )
        .segments("p", "0 | 2 | free\n 2 | 5/2 | B1@floor.2");
}

/// A hand that is carried round a square peg, once and a quarter: its edge 0 runs through the
/// hinge, so it points at the corner that is furthest counter-clockwise as the hinge sees it, and
/// changes corner where it lies flush on a side: at θ = 0, 90°, 180° … on the covering line. Then it
/// is drawn off downwards: the edge's end leaves the corner when |w| = 12, at (−1, √143); the tip
/// slides along the lower side until it is straight above the hinge, (0,12); and from 450° the
/// hand snaps back to rest, through more than a turn, since nothing is within its reach.
#[test]
fn wound_by_more_than_a_turn() {
    let told = tell(
        "peg: -1,-1 1,-1 1,1 -1,1
         pawl p at -4,4: 0,0 12,0 11,1
         move 0,-1 for 8
         move 1,0 for 8
         move 0,1 for 8
         move -1,0 for 8
         move 0,-1 for 8
         move 1,0 for 4
         move 0,-1 for 10",
    );
    told.events(
        "3 | 0 | translational-collision | A0@peg.3 / A0@peg.2 A0@peg.3
         8 | -3/5+1/5√34 | phase-end
         11 | 1 | sliding-collision | A0@peg.0
         16 | 5/3+1/3√34 | phase-end
         19 | inf | sliding-collision | A0@peg.1
         24 | -3/5-1/5√34 w1 | phase-end
         27 | -1 w1 | sliding-collision | A0@peg.2
         32 | 5/3-1/3√34 w1 | phase-end
         35 | 0 w1 | sliding-collision | A0@peg.3
         40 | -3/5+1/5√34 w1 | phase-end
         43 | 1 w1 | sliding-collision | A0@peg.0
         44 | 1/3+1/3√10 w1 | phase-end
         41+√143 | 1/11√143 w1 | sliding-collision | B1@peg.0
         53 | 1 w1 > 0 | snap-free | B1@peg.0
         54 | 0 | phase-end
         54 | 0 | plan-end",
    )
    .outcome("completed 54");
    let windings: Vec<[i64; 2]> = told.trajectory.pawls[0]
        .segments
        .iter()
        .map(|s| s.winding)
        .collect();
    assert_eq!(windings.first(), Some(&[0, 0]));
    assert!(windings.contains(&[1, 1]));
    assert_eq!(windings.last(), Some(&[0, 0]));
}

/// The same the other way round, mirrored in the y-axis: every angle changes sign.
#[test]
fn wound_the_other_way() {
    tell(
        "peg: 1,-1 -1,-1 -1,1 1,1
         pawl p at 4,4: 0,0 -12,0 -11,1
         move 0,-1 for 8
         move -1,0 for 8
         move 0,1 for 8
         move 1,0 for 8
         move 0,-1 for 8",
    )
    .events(
        "3 | 0 | translational-collision | A0@peg.3 / A0@peg.2 A0@peg.3
         8 | 3/5-1/5√34 | phase-end
         11 | -1 | sliding-collision | A0@peg.0
         16 | -5/3-1/3√34 | phase-end
         19 | inf w-1 | sliding-collision | A0@peg.1
         24 | 3/5+1/5√34 w-1 | phase-end
         27 | 1 w-1 | sliding-collision | A0@peg.2
         32 | -5/3+1/3√34 w-1 | phase-end
         35 | 0 w-1 | sliding-collision | A0@peg.3
         40 | 3/5-1/5√34 w-1 | phase-end
         40 | 3/5-1/5√34 w-1 | plan-end",
    );
}
