//! Wrong answers that were found by random scenes, each by name, with what is right and why.
#![allow(clippy::unwrap_used)]

#[path = "common/hand.rs"]
mod hand;

use snapfit::motion::{Arithmetic, EventKind, Options, OutcomeKind, Trajectory, simulate};
use snapfit::number::Rat;
use snapfit::scene::read_scene;

fn run(text: &str) -> Trajectory {
    let file = read_scene("scene.toml", text).unwrap();
    hand::by_both_methods(file.scene())
}

/// At t = 7 the slope of o0 lets the pawl come to rest, and at the same instant the apex of o1
/// strikes the pawl's corner, vertex 0. Above rest o0 still stands, so only the way below is open:
/// the pawl is driven clockwise from there on. It once was held at θ = 0, inside o1, since a part
/// beside its old curve opens at that very place; but that part does not hold rest.
#[test]
fn released_and_struck_at_rest_at_one_instant() {
    let t = run(r#"
[scene]
name = "random-20536"
[[obstacle]]
name = "o0"
vertices = [["2", "3/2"], ["7/2", "7/2"], ["7/2", "5/2"]]
[[obstacle]]
name = "o1"
vertices = [["-5/2", "-1"], ["0", "-1"], ["-1/2", "1/2"]]
[[pawl]]
name = "p0"
hinge = ["3/2", "9"]
vertices = [["-1/2", "15/2"], ["5/2", "15/2"], ["5/2", "17/2"], ["3/2", "17/2"]]
[[motion]]
velocity = ["0", "-1"]
duration = "15/2"
"#);
    let seven = Rat::from(7);
    let held = t.pawls[0]
        .segments
        .iter()
        .find(|s| s.from.cmp_rat(&seven).is_eq())
        .expect("something begins at 7");
    assert!(held.sliding.is_some(), "driven, not at rest");
    let last = t.pawls[0].events.last().unwrap();
    assert_eq!(last.angle.side(), -1, "clockwise");
}

/// The hinge, a pawl vertex, passes exactly through an obstacle's corner and is free on both
/// sides of it: no wall.
#[test]
fn the_hinge_grazes_a_corner() {
    let t = run(r#"
[scene]
name = "corner-graze-at-hinge"
[[obstacle]]
name = "o0"
vertices = [["2", "3"], ["1", "2"], ["1", "1"]]
[[pawl]]
name = "p0"
hinge = ["2", "4"]
vertices = [["2", "4"], ["6", "5"], ["7", "5"]]
[[motion]]
velocity = ["0", "-1"]
duration = "5"
"#);
    assert_eq!(t.outcome.kind, OutcomeKind::Completed);
    assert!(t.pawls[0].segments.iter().all(|s| s.sliding.is_none()));
}

/// A level and a graph on one curve: a vertex-vertex name at x = 0 is the level's, not the
/// graph's. The pawl's edge lies along the motion from t = 5; at 6 its foot passes the contact.
#[test]
fn a_name_on_the_level_is_not_the_graphs() {
    let t = run(r#"
[scene]
name = "seam-level"
[[obstacle]]
name = "o0"
vertices = [["3", "-2"], ["-4", "2"], ["-3", "-8"]]
[[pawl]]
name = "p0"
hinge = ["-5", "3"]
vertices = [["-3", "3"], ["-7", "2"], ["-4", "2"]]
[[motion]]
velocity = ["0", "-1"]
duration = "4"
"#);
    assert_eq!(t.outcome.kind, OutcomeKind::Jammed);
    assert!(t.outcome.time.cmp_rat(&Rat::one()).is_eq());
}

/// What lies past the phase's end is never made, so nothing may be looked at there.
#[test]
fn a_short_phase_that_starts_on_a_stop() {
    let t = run(r#"
[scene]
name = "short-phase-on-a-stop"
[[obstacle]]
name = "o1"
vertices = [["9/2", "1"], ["4", "7/4"], ["9/2", "5/2"], ["19/4", "9/4"]]
[[pawl]]
name = "p0"
hinge = ["9/2", "33/4"]
vertices = [["15/4", "23/2"], ["9/2", "5"], ["29/4", "13/2"]]
start = "3/8"
limits = ["-1/2", "3/8"]
[[motion]]
velocity = ["0", "-25/3"]
duration = "3/10"
"#);
    assert_eq!(t.outcome.kind, OutcomeKind::Completed);
    assert_eq!(t.pawls[0].events[0].kind, EventKind::SnapFree);
}

/// At the phase's last instant a curve comes to θ = −π/2, where the unrolled cylinder is cut, from
/// the side on which F does not lie. The sweep once did not see it.
#[test]
fn met_on_the_cut_from_beyond_it() {
    let t = run(r#"
[scene]
name = "random-7001665"
[[obstacle]]
name = "o0"
vertices = [["1", "2"], ["0", "2"], ["-1", "1"], ["0", "0"]]
[root]
vertices = [["-1", "9"], ["3", "9"], ["0", "12"]]
[[pawl]]
name = "p0"
hinge = ["2", "3"]
vertices = [["0", "-1"], ["3", "2"], ["3", "3"], ["2", "3"], ["2", "2"]]
start = "-3/2"
[[pawl]]
name = "p1"
hinge = ["-2", "3"]
vertices = [["-3", "2"], ["-1", "3"], ["-1", "5"], ["-2", "5"], ["-2", "3"]]
[[motion]]
velocity = ["0", "-1"]
until = "root-collision"
duration = "2"
[[motion]]
reverse = true
"#);
    let met = |p: &snapfit::motion::PawlTrace| {
        p.events
            .iter()
            .any(|e| e.kind == EventKind::SlidingCollision && e.phase == 1)
    };
    assert!(t.pawls.iter().any(met));
}

/// The edge of p1 that turns through the hinge's own line has a C-function with a level besides its graph.
/// At t = 6 the state stands on that level, at another time than the graph passes it, and the graph has no
/// part there. The reference kernel, which has no doubles to tell the times apart, once took it to have one.
#[test]
fn a_level_is_not_the_graph_of_its_curve() {
    let file = read_scene(
        "scene.toml",
        r#"
[scene]
name = "random-7503251"
[[obstacle]]
name = "o0"
vertices = [["5", "-5"], ["2", "-1"], ["6", "-3"]]
[[pawl]]
name = "p1"
hinge = ["5", "3"]
vertices = [["4", "0"], ["7", "0"], ["7", "2"], ["4", "2"]]
[[motion]]
velocity = ["0", "-1"]
duration = "11/2"
[[motion]]
reverse = true
"#,
    )
    .unwrap();
    for arithmetic in [Arithmetic::Filtered, Arithmetic::Exact] {
        let options = Options {
            arithmetic,
            ..Options::default()
        };
        let t = simulate(file.scene(), &options).unwrap();
        assert_eq!(t.outcome.kind, OutcomeKind::Completed, "{arithmetic:?}");
    }
}
