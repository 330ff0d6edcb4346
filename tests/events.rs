//! One smallest scene for every kind of event and for its dual (DP §9.2 and the contract), with
//! the answer worked out by hand beside it.
//!
//! Three pawls carry most of it. Their tips are 5 from the hinge, so that r = (3, −4) and
//! (4, −3) and (0, −5) are Pythagorean: a turn from direction a to direction b has
//! cos θ = a·b/25, sin θ = a×b/25 and tan(θ/2) = sin θ/(1 + cos θ):
//!
//! * (3,−4) → (4,−3): 24/25, 7/25: **1/7**. (3,−4) → (5,0): 3/5, 4/5: **1/2**.
//! * (0,−5) → (3,−4): 4/5, 3/5: **1/3**. (0,−5) → (4,−3): 3/5, 4/5: **1/2**.
//!
//! A *hook* is a triangle above the floor whose hinge lies below it (nothing says that a pawl
//! must contain its hinge): (4,3) → (3,4) is 1/7, (4,3) → (0,5) is 1/2.
#![allow(clippy::unwrap_used)]

#[path = "common/hand.rs"]
mod hand;
use hand::{ARM, on_floor, tell};

const HOOK: &str = "pawl p at 0,-2: 4,3 5,5 3,5\n"; // tip 0

// ── (i) translational collision and release ─────────────────────────────────────────────────

/// The tip hangs 4 below the hinge: it lands when the hinge is 4 up, at t = 2. At t = 3 the hinge
/// is 3 up, so r = (4,−3): u = 1/7.
#[test]
fn translational_collision_b() {
    on_floor(&(ARM.to_owned() + "move 0,-1 for 3"))
        .events(
            "2 | 0 | translational-collision | B1@floor.2
             3 | 1/7 | phase-end
             3 | 1/7 | plan-end",
        )
        .segments("p", "0 | 2 | free\n 2 | 3 | B1@floor.2")
        .outcome("completed 3");
}

/// A bar whose lower edge (pawl edge 0) runs 1 below the hinge; a peg's tip at w = (3, −5 + t)
/// from the hinge. It touches at w = (3,−1), t = 4. At t = 6, w = (3,1), and in the pawl's frame
/// it lies at (√(10 − 1), −1) = (3,−1): cos = 8/10, sin = 6/10, u = 1/3.
#[test]
fn translational_collision_a() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -3,5: -1,-1 9,-1 9,1 -1,1
         move 0,-1 for 6",
    )
    .events(
        "4 | 0 | translational-collision | A0@peg.0
         6 | 1/3 | phase-end
         6 | 1/3 | plan-end",
    )
    .segments("p", "0 | 4 | free\n 4 | 6 | A0@peg.0")
    .outcome("completed 6");
}

/// Down for 3 as above, and back up: the curve crosses rest where it met it, at height 4, t = 4.
#[test]
fn release_b() {
    on_floor(&(ARM.to_owned() + "move 0,-1 for 3\n move 0,1 for 3"))
        .events(
            "2 | 0 | translational-collision | B1@floor.2
             3 | 1/7 | phase-end
             4 | 0 | release | B1@floor.2
             6 | 0 | phase-end
             6 | 0 | plan-end",
        )
        .segments(
            "p",
            "0 | 2 | free
             2 | 3 | B1@floor.2
             3 | 4 | B1@floor.2
             4 | 6 | free",
        )
        .outcome("completed 6");
}

/// The bar on the peg, down for 6 and back: released at w = (3,−1) again, t = 6 + 2.
#[test]
fn release_a() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -3,5: -1,-1 9,-1 9,1 -1,1
         move 0,-1 for 6
         reverse",
    )
    .events(
        "4 | 0 | translational-collision | A0@peg.0
         6 | 1/3 | phase-end
         8 | 0 | release | A0@peg.0
         12 | 0 | phase-end
         12 | 0 | plan-end",
    )
    .outcome("completed 12");
}

// ── (ii) sliding collision ──────────────────────────────────────────────────────────────────

/// The floor ends at (4,0). The tip gets there at t = 3, u = 1/7; the pawl's edge from hinge to
/// tip slides on over the corner. At t = 4 the hinge is 2 up and the edge points along (4,−2):
/// tan θ = tan(atan 4/3 − atan 1/2) = (5/6)/(5/3) = 1/2, so u = √5 − 2.
#[test]
fn sliding_collision_b_to_a_at_a_vertex() {
    tell(
        "floor: -20,-1 4,-1 4,0 -20,0
         pawl p at 0,6: 0,0 3,-4 4,-1
         move 0,-1 for 4",
    )
    .events(
        "2 | 0 | translational-collision | B1@floor.2
         3 | 1/7 | sliding-collision | A0@floor.2
         4 | -2+√5 | phase-end
         4 | -2+√5 | plan-end",
    )
    .segments(
        "p",
        "0 | 2 | free\n 2 | 3 | B1@floor.2\n 3 | 4 | A0@floor.2",
    )
    .outcome("completed 4");
}

/// DP Fig. 16. The lower edge runs from v₂ = (3,−4) to v₁ = (1,−41/12): its direction is
/// (−24,7)/12, which a turn by u = 1/7 lays flat. So v₁ comes down at t = 3, and since it is nearer
/// to the hinge (r_x = 4 − 25/12 = 23/12 < 4) it needs more turn from there on and takes over. At
/// t = 7/2, height 5/2: sin θ − (41/12)·cos θ = −5/2, 71u² + 24u − 11 = 0, u = (−12 + 5√37)/71.
#[test]
fn sliding_collision_b_to_b_when_an_edge_lies_flush() {
    on_floor(
        "pawl p at 0,6: 0,0 1,-41/12 3,-4 4,-1
         move 0,-1 for 7/2",
    )
    .events(
        "2 | 0 | translational-collision | B2@floor.2
         3 | 1/7 | sliding-collision | B1@floor.2
         7/2 | -12/71+5/71√37 | phase-end
         7/2 | -12/71+5/71√37 | plan-end",
    )
    .segments(
        "p",
        "0 | 2 | free\n 2 | 3 | B2@floor.2\n 3 | 7/2 | B1@floor.2",
    )
    .outcome("completed 7/2");
}

/// A heel at (6,−7/4) lands first, on a block 3 up: 6 − t − 7/4 = 3, t = 5/4. When the hinge is 3
/// up, a turn by u = 1/7 brings it to (25/4, 0), still on the block, and the tip to (4,−3), on the
/// floor. The tip is nearer to the hinge and needs more turn from there on. At t = 4, height 2:
/// 3 sin θ − 4 cos θ = −2: 3u² + 3u − 1 = 0, u = (−3 + √21)/6.
#[test]
fn sliding_collision_with_another_obstacle() {
    on_floor(
        "block: 5,2 8,2 8,3 5,3
         pawl p at 0,6: 0,0 3,-4 3,0 6,-7/4 6,1 0,1
         move 0,-1 for 4",
    )
    .events(
        "5/4 | 0 | translational-collision | B3@block.2
         3 | 1/7 | sliding-collision | B1@floor.2
         4 | -1/2+1/6√21 | phase-end
         4 | -1/2+1/6√21 | plan-end",
    )
    .segments(
        "p",
        "0 | 5/4 | free\n 5/4 | 3 | B3@block.2\n 3 | 4 | B1@floor.2",
    )
    .outcome("completed 4");
}

// ── (iii) jam between two curves, and its dual (vi), snap free at a vertex ──────────────────

/// The tip (3,−4) on the right turns the pawl counter-clockwise; the point (−117/25, −44/25) on
/// the left is (−4,−3) turned back by u = 1/7, so it reaches the floor at t = 3 too, and every
/// further step would have to turn it clockwise.
#[test]
fn jam_incompatible() {
    on_floor(
        "pawl p at 0,6: 0,1 -117/25,-44/25 0,-1 3,-4 4,-1
         move 0,-1 for 5",
    )
    .events(
        "2 | 0 | translational-collision | B3@floor.2
         3 | 1/7 | jam-incompatible | B1@floor.2 B3@floor.2",
    )
    .segments("p", "0 | 2 | free\n 2 | 3 | B3@floor.2")
    .outcome("jammed 3 p");
}

/// The shelf ends on its left at (2,0). Cocked to u = 1/7 the tip leads the hinge by 4; moving
/// left it passes the corner when the hinge is at x = −2, at t = 3 + 2, and nothing is left to
/// hold it: on the far side the pawl's right edge stands clear of the corner.
#[test]
fn snap_free_vertex() {
    tell(
        "shelf: 2,-1 20,-1 20,0 2,0
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
    )
    .segments(
        "p",
        "0 | 2 | free
         2 | 3 | B1@shelf.2
         3 | 5 | B1@shelf.2
         5 | 7 | free",
    )
    .outcome("completed 7");
}

// ── (iv) snap free at a vertical tangency, and its dual (v), jam on a single curve ──────────

/// DP Fig. 13 B (1). Cocked past the vertical: (3,−4) → (−3,−4) has cos = 7/25, sin = −24/25,
/// u = −3/4. The hinge rises from 4 to 5, where the tip hangs straight down: (0,−5) has
/// cos = 4/5, sin = −3/5, u = −1/3. One instant later no turn reaches the floor.
#[test]
fn snap_free_type_b() {
    on_floor(
        "pawl p at 0,4: 0,0 3,-4 5/2,-5/2; start -3/4
         move 0,1 for 3",
    )
    .events(
        "1 | -1/3 > 0 | snap-free | B1@floor.2
         3 | 0 | phase-end
         3 | 0 | plan-end",
    )
    .segments("p", "0 | 1 | B1@floor.2\n 1 | 3 | free")
    .outcome("completed 3");
}

/// The same for type A: the pawl's edge 2 looks *towards* the hinge, 1 below it, and a spike's tip
/// presses on it from the hinge's side. In the pawl's frame the tip lies at (c, −1), c > 0, with
/// c² = |w|² − 1, so a spring that wants to raise θ is held. w = (−3/5, −1 + t): at t = 0 c = 3/5
/// and (3/5,−1) → (−3/5,−1) has cos = 8/17, sin = −15/17, u = −3/5. At t = 1/5 |w| = 1, c = 0,
/// (0,−1) → (−3/5,−4/5): u = −1/3; nearer than 1 no turn reaches the tip.
#[test]
fn snap_free_type_a() {
    tell(
        "spike: 0,0 3,3 1,3
         pawl p at 3/5,1: -9,-3 9,-3 9,-1 -9,-1; start -3/5
         move 0,-1 for 1/4",
    )
    .events(
        "1/5 | -1/3 > 0 | snap-free | A2@spike.0
         1/4 | 0 | phase-end
         1/4 | 0 | plan-end",
    )
    .segments("p", "0 | 1/5 | A2@spike.0\n 1/5 | 1/4 | free")
    .outcome("completed 1/4");
}

/// DP Fig. 13 B (2): hooked over the floor from below and pulled down. The tip (4,3) lands when
/// the hinge is at −3, t = 1, and is dragged to (0,5), straight above the hinge, at t = 3.
#[test]
fn jam_single_type_b() {
    on_floor(&(HOOK.to_owned() + "move 0,-1 for 5"))
        .events(
            "1 | 0 | translational-collision | B0@floor.2
             3 | 1/2 | jam-single | B0@floor.2",
        )
        .segments("p", "0 | 1 | free\n 1 | 3 | B0@floor.2")
        .outcome("jammed 3 p");
}

/// DP Fig. 13 A (2): the peg's tip at w = (3/5, −5 + t) meets the bar's lower edge, 1 below the
/// hinge, at t = 4, and the foot of the hinge when |w| = 1, w = (3/5,−4/5), t = 21/5:
/// (0,−1) → (3/5,−4/5) is u = 1/3.
#[test]
fn jam_single_type_a() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -3/5,5: -2,-1 9,-1 9,1 -2,1
         move 0,-1 for 6",
    )
    .events(
        "4 | 0 | translational-collision | A0@peg.0
         21/5 | 1/3 | jam-single | A0@peg.0",
    )
    .outcome("jammed 21/5 p");
}

/// A wall: vertex 0 is the hinge itself and meets the floor at t = 3, whatever the turn.
#[test]
fn jam_single_at_a_wall() {
    on_floor("pawl p at 0,3: 0,0 1,2 -1,2\n move 0,-1 for 5")
        .events("3 | 0 | jam-single | B0@floor.2")
        .segments("p", "0 | 3 | free")
        .outcome("jammed 3 p");
}

/// The arm pressed down all the way: at t = 6 its hinge, a vertex, is on the floor, and so is the
/// tip (5,0), u = 1/2.
#[test]
fn jam_single_at_a_wall_while_sliding() {
    on_floor(&(ARM.to_owned() + "move 0,-1 for 8"))
        .events(
            "2 | 0 | translational-collision | B1@floor.2
             6 | 1/2 | jam-single | B0@floor.2 B1@floor.2 / B0@floor.2",
        )
        .outcome("jammed 6 p");
}

// ── (vii) stick ─────────────────────────────────────────────────────────────────────────────

/// Type B by orientation. Cocked to r = (4,−3), the hinge moves along (2,1): the tip is dragged to
/// the right, so the friction on the pawl points left, f ∝ (−μ, 1), and r × f = r_x − μ·h holds
/// the spring while r_x > 3h/4. At t = 1, h = 4, r = (3,−4) lies on the ray, and after it inside.
/// (0,−5) → (3,−4): u = 1/3.
#[test]
fn stick_type_b() {
    on_floor(
        "friction 3/4
         pawl p at 0,3: 0,0 0,-5 1,-2; start 1/2
         move 2,1 for 3/2",
    )
    .events("1 | 1/3 | stick | B1@floor.2")
    .segments("p", "0 | 1 | B1@floor.2")
    .outcome("stuck 1 p");
}

/// Erratum 1 of the paper: entry into sector III by the ray is at r = |r|/√(1+μ²)·(n − μ·v),
/// v the direction of sliding. The hook's tip is dragged to the left, v = (−1,0): with μ = 3/4,
/// r = 5·(4/5)·(3/4, 1) = (3,4), u = 1/7, when the hinge is at −4: t = 2. (As printed, without the
/// root and with the other sign, it would be (−12/5, 16/5).)
#[test]
fn stick_type_b_in_sector_iii() {
    on_floor(&("friction 3/4\n".to_owned() + HOOK + "move 0,-1 for 5"))
        .events(
            "1 | 0 | translational-collision | B0@floor.2
             2 | 1/7 | stick | B0@floor.2",
        )
        .outcome("stuck 2 p");
}

/// Type A by time. w = (1, −5 + t); landing at t = 4 with the tip at (1,−1) of the pawl's frame,
/// c² = |w|² − 1 = w_y². The vertex slides towards the hinge's foot, so friction on the pawl is
/// f ∝ (−μ, 1) in the pawl's frame, and r × f = c − μ·1 > 0 while c > 1/2: until w = (1, −1/2),
/// t = 9/2 (|w|² = 1 + μ², DP eq. 21). (1/2,−1) → (1,−1/2): cos = 4/5, sin = 3/5, u = 1/3.
#[test]
fn stick_type_a() {
    tell(
        "friction 1/2
         peg: 0,0 -1,-3 1,-3
         pawl p at -1,5: -2,-1 9,-1 9,1 -2,1
         move 0,-1 for 6",
    )
    .events(
        "4 | 0 | translational-collision | A0@peg.0
         9/2 | 1/3 | stick | A0@peg.0",
    )
    .outcome("stuck 9/2 p");
}

/// At landing: r = (3,−4), pressed down, slides to the right only if 3 − 4μ > 0; μ = 1 holds.
#[test]
fn stick_at_landing() {
    on_floor(&("friction 1\n".to_owned() + ARM + "move 0,-1 for 5"))
        .events(
            "2 | 0 | translational-collision | B1@floor.2
             2 | 0 | stick | B1@floor.2",
        )
        .segments("p", "0 | 2 | free")
        .outcome("stuck 2 p");
}

/// At the landing of a snap: free at u = 1/2, the pawl snaps at time 0 and meets the floor 4 below
/// the hinge with r = (3,−4), u = 1/3. Moving right, f ∝ (−1, 1): r × f = 3 − 4 < 0: it holds.
#[test]
fn stick_at_the_landing_of_a_snap() {
    on_floor(
        "friction 1
         pawl p at 0,4: 0,0 0,-5 1,-2; start 1/2
         move 1,0 for 2",
    )
    .events(
        "0 | 1/2 > 1/3 | snap-free / snap-free-vertex
         0 | 1/3 | snap-landing | B1@floor.2
         0 | 1/3 | stick | B1@floor.2",
    )
    .segments("p", "")
    .outcome("stuck 0 p");
}

/// At the first instant of a phase in contact: dragged to the left r × f = 3 + 4μ > 0 and the tip
/// slides; the reverse drags it to the right and holds at once (3 − 4 < 0), at t = 2.
#[test]
fn stick_at_the_first_instant_of_a_phase() {
    on_floor(
        "friction 1
         pawl p at 0,4: 0,0 0,-5 1,-2; start 1/3
         move -1,0 for 2
         reverse",
    )
    .events(
        "2 | 1/3 | phase-end
         2 | 1/3 | stick | B1@floor.2",
    )
    .segments("p", "0 | 2 | B1@floor.2")
    .outcome("stuck 2 p");
}

// ── snap-landing ────────────────────────────────────────────────────────────────────────────

/// Cocked to r = (4,−3), dragged left over the shelf's end at (2,0), t = 2; a lower floor 4 below
/// the hinge catches the tip at r = (3,−4), u = 1/3, and it slides on, parallel.
#[test]
fn snap_landing_type_b() {
    tell(
        "shelf: 2,-1/2 20,-1/2 20,0 2,0
         low: -20,-2 3/2,-2 3/2,-1 -20,-1
         pawl p at 0,3: 0,0 0,-5 1,-2; start 1/2
         move -1,0 for 4",
    )
    .events(
        "2 | 1/2 > 1/3 | snap-free-vertex | B1@shelf.2
         2 | 1/3 | snap-landing | B1@low.2
         4 | 1/3 | phase-end
         4 | 1/3 | plan-end",
    )
    .segments("p", "0 | 2 | B1@shelf.2\n 2 | 4 | B1@low.2")
    .outcome("completed 4");
}

/// A peg's tip at (−1/2, 1) is (3/2,−2) from the hinge (−2,3) at t = 2: the pawl's edge, which
/// runs through the hinge, meets it at the direction (3,−4), u = 1/3. From there the edge points at
/// the peg: at t = 3 along (5/2,−2), tan θ = 5/4, 5u² + 8u − 5 = 0, u = (−4 + √41)/5.
#[test]
fn snap_landing_type_a() {
    tell(
        "shelf: 2,-1/2 20,-1/2 20,0 2,0
         peg: -1/2,1 -1,-3 0,-3
         pawl p at 0,3: 0,0 0,-5 1,-2; start 1/2
         move -1,0 for 3",
    )
    .events(
        "2 | 1/2 > 1/3 | snap-free-vertex | B1@shelf.2
         2 | 1/3 | snap-landing | A0@peg.0
         3 | -4/5+1/5√41 | phase-end
         3 | -4/5+1/5√41 | plan-end",
    )
    .segments("p", "0 | 2 | B1@shelf.2\n 2 | 3 | A0@peg.0")
    .outcome("completed 3");
}

// ── graze, root collision ───────────────────────────────────────────────────────────────────

/// The tip passes exactly over the tip of a peg at t = 5. Whether it is told is optional; that it
/// has no effect is not.
#[test]
fn graze() {
    tell(
        "peg: 0,0 -1,-3 1,-3
         pawl p at -8,4: 0,0 3,-4 4,-1
         move 1,0 for 10",
    )
    .events(
        "?5 | 0 | graze
         10 | 0 | phase-end
         10 | 0 | plan-end",
    )
    .segments("p", "0 | 10 | free")
    .outcome("completed 10");
}

const ROOT: &str = "root: -2,10 2,10 2,12 -2,12\npawl p at 30,50: 0,0 1,0 0,1\n";

/// The root comes down flat on the floor at t = 10 with both lower corners; the phase asked for it.
#[test]
fn root_collision_asked() {
    on_floor(&(ROOT.to_owned() + "move 0,-1 until root-collision"))
        .events(
            "10 | 0 | root-collision | root-B0@floor.2 root-B1@floor.2
             10 | 0 | phase-end
             10 | 0 | plan-end",
        )
        .outcome("completed 10");
}

/// Nothing asked for it: the plan ends there.
#[test]
fn root_collision_unasked() {
    on_floor(&(ROOT.to_owned() + "move 0,-1 for 12\n move 0,1 for 1"))
        .events("10 | 0 | root-collision | root-B0@floor.2 root-B1@floor.2")
        .segments("p", "0 | 10 | free")
        .outcome("root-collision 10");
}

// ── stops ───────────────────────────────────────────────────────────────────────────────────

/// Preloaded: the lower stop at u = 1/7 keeps the spring from rest, with the tip at (4,−3). The
/// floor takes over when the hinge is 3 up, t = 3; on the way back the stop does, at t = 5.
#[test]
fn limit_stop() {
    on_floor(
        "pawl p at 0,6: 0,0 3,-4 4,-1; start 1/7; limits 1/7 1/2
         move 0,-1 for 4
         reverse",
    )
    .events(
        "?0 | 1/7 | limit-stop | limit0
         3 | 1/7 | sliding-collision | B1@floor.2
         4 | -1/2+1/6√21 | phase-end
         5 | 1/7 | limit-stop | limit0
         8 | 1/7 | phase-end
         8 | 1/7 | plan-end",
    )
    .segments(
        "p",
        "0 | 3 | limit0
         3 | 4 | B1@floor.2
         4 | 5 | B1@floor.2
         5 | 8 | limit0",
    )
    .outcome("completed 8");
}

/// Preloaded and started away from its stop: it snaps onto the stop at time 0.
#[test]
fn snap_onto_a_stop() {
    on_floor(
        "pawl p at 0,9: 0,0 3,-4 4,-1; start 1/2; limits 1/7 1/2
         move 0,-1 for 4",
    )
    .events(
        "0 | 1/2 > 1/7 | snap-free / snap-free-vertex
         0 | 1/7 | snap-landing | limit0
         ?0 | 1/7 | limit-stop | limit0
         4 | 1/7 | phase-end
         4 | 1/7 | plan-end",
    )
    .segments("p", "0 | 4 | limit0")
    .outcome("completed 4");
}

/// An upper stop at u = 1/7 meets the contact at t = 3: between the two nothing is left.
#[test]
fn jam_at_a_stop() {
    on_floor(
        "pawl p at 0,6: 0,0 3,-4 4,-1; limits -1 1/7
         move 0,-1 for 5",
    )
    .events(
        "2 | 0 | translational-collision | B1@floor.2
         3 | 1/7 | jam-incompatible | B1@floor.2 limit1",
    )
    .outcome("jammed 3 p");
}

// ── bifurcation, ends ───────────────────────────────────────────────────────────────────────

/// The tip straight below the hinge lands on the flat at t = 3: h = 5 cos θ has a solution on
/// either side from there on.
#[test]
fn bifurcation() {
    let told = on_floor("pawl p at 0,8: 0,0 0,-5 1,-2\n move 0,-1 for 5");
    told.events("3 | 0 | bifurcation | B1@floor.2")
        .outcome("bifurcated 3 p");
    let branches = &told.trajectory.outcome.branches;
    let found: Vec<(i32, String, bool)> = branches
        .iter()
        .map(|b| (b.direction, told.contact(&b.contacts[0]), b.sticks))
        .collect();
    let tip = "B1@floor.2".to_owned();
    assert_eq!(found, [(1, tip.clone(), false), (-1, tip, false)]);
}

/// A phase's last instant belongs to it: the contact made then is told, before the ends.
#[test]
fn ends_come_last() {
    on_floor(&(ARM.to_owned() + "move 0,-1 for 2"))
        .events(
            "2 | 0 | translational-collision | B1@floor.2
             2 | 0 | phase-end
             2 | 0 | plan-end",
        )
        .segments("p", "0 | 2 | free")
        .outcome("completed 2");
}
