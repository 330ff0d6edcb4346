//! PuzzleFlex: programs against published optima, invariance, bounds, corners and long chains.
#![allow(clippy::unwrap_used)]

use snapfit::flex::generate::generate;
use snapfit::flex::{
    Corners, Ending, FlexOptions, Hold, Path, Pose, StepRules, Structure, Term, Why, flex,
    outer_bound,
};
use snapfit::geometry::Vec2;
use snapfit::number::Rat;

#[path = "common/blocks.rs"]
mod blocks;
mod common;
use blocks::{moves, plain, r, rectangle, v};

fn first_optimum(structure: &Structure) -> Rat {
    let mut s = structure.clone();
    s.step.most = 1;
    s.step.path = Path::Fast;
    let flexed = flex(
        &s,
        &FlexOptions {
            verify: true,
            ..FlexOptions::default()
        },
    );
    assert_eq!(flexed.steps[0].verified, Some(true));
    flexed.steps[0].objective.clone()
}

/// The published programs are those of these structures, rational for rational. The larger ones
/// run with TEST_MULT=1.
#[test]
fn optima_are_those_published() {
    let folder = std::path::Path::new("../shared/data/lp/puzzleflex");
    if !folder.is_dir() {
        eprintln!("skipped: the published optima are not here");
        return;
    }
    let cases = [
        ("grid", 36),
        ("jit", 36),
        ("jrot", 36),
        ("grid", 90),
        ("jit", 90),
        ("jrot", 90),
        ("grid", 392),
    ];
    let most = if common::count(100) >= 100 {
        cases.len()
    } else {
        4
    };
    for (family, bodies) in &cases[..most] {
        let wanted = std::fs::read_to_string(folder.join(format!("pf_{family}{bodies}_y.exact")));
        let structure = generate(family, *bodies, 1).unwrap();
        assert_eq!(
            first_optimum(&structure).to_string(),
            wanted.unwrap().trim(),
            "{family} {bodies}"
        );
    }
}

/// The structure turned by tan(θ/2) = u about the origin and shifted, the objective with it.
fn carried(s: &Structure, u: &Rat, by: &Vec2) -> Structure {
    let mut out = s.clone();
    for b in &mut out.bodies {
        b.position = &b.position.rotate_tan_half(u) + by;
        b.tan_half = (&b.tan_half + u) / (Rat::one() - &b.tan_half * u);
    }
    for t in &mut out.objective {
        if let Term::Body { dx, dy, .. } | Term::Vertex { dx, dy, .. } = t {
            let d = v(dx.clone(), dy.clone()).rotate_tan_half(u);
            (*dx, *dy) = (d.x, d.y);
        }
    }
    out
}

#[test]
fn optima_do_not_depend_on_where_a_structure_stands() {
    for (family, bodies) in [("wall", 9), ("can", 12), ("ring", 7), ("jit", 6)] {
        let s = generate(family, bodies, 3).unwrap();
        let wanted = first_optimum(&s);
        assert!(wanted.sign() > 0, "{family}");
        let moved = carried(&s, &r(2, 7), &v(r(-31, 3), r(5, 1)));
        assert_eq!(first_optimum(&moved), wanted, "{family}");
    }
}

#[test]
fn optima_do_not_depend_on_names_and_order() {
    for (family, bodies) in [("wall", 9), ("can", 12), ("chain", 5)] {
        let s = generate(family, bodies, 1).unwrap();
        let wanted = first_optimum(&s);
        let mut other = s.clone();
        other.bodies.reverse();
        for (k, b) in other.bodies.iter_mut().enumerate() {
            // Another first vertex, and every second body listed clockwise.
            let n = b.vertices.len();
            b.vertices.rotate_left((3 * k) % n);
            if k % 2 == 0 {
                b.vertices.reverse();
            }
        }
        for t in &mut other.objective {
            if let Term::Body { body, .. } = t {
                *body = s.bodies.len() - 1 - *body;
            }
        }
        assert_eq!(first_optimum(&other), wanted, "{family}");
    }
}

/// A unit square between a floor and a ceiling 1/10 above it rises by 1/10, whatever it weighs
/// sideways; between walls it turns no farther than its diagonal allows.
#[test]
fn a_block_under_a_ceiling() {
    let bodies = || {
        vec![
            rectangle("floor", [-40, -10, 40, 0], Hold::Fixed),
            rectangle("ceiling", [-40, 11, 40, 20], Hold::Fixed),
            rectangle("block", [0, 0, 10, 10], Hold::Free),
        ]
    };
    let s = plain(bodies(), vec![moves(2, 0, 1)]);
    let flexed = flex(&s, &FlexOptions::default());
    assert_eq!(flexed.ending, Ending::Converged);
    assert_eq!(flexed.steps[0].objective, r(1, 10));
    let off = (&flexed.displacement - &r(1, 10)).abs();
    assert!(off < r(1, 500_000), "{off}");
    // Sideways nothing holds it.
    let s = plain(bodies(), vec![moves(2, 1, 0)]);
    assert_eq!(flex(&s, &FlexOptions::default()).ending, Ending::Unbounded);
    // It turns about any corner: lifting the other end by 1/10 over a length of 1, to first order.
    let turn = Term::Body {
        body: 2,
        dx: Rat::zero(),
        dy: Rat::zero(),
        dtheta: Rat::one(),
    };
    let s = plain(bodies(), vec![turn]);
    let flexed = flex(&s, &FlexOptions::default());
    assert_eq!(flexed.steps[0].objective, r(1, 10));
}

/// The whole run, too, does not depend on where a structure stands: only roundings differ.
#[test]
fn runs_do_not_depend_on_where_a_structure_stands() {
    for (family, bodies) in [("wall", 9), ("jit", 6), ("grid", 12)] {
        let s = generate(family, bodies, 3).unwrap();
        let wanted = flex(&s, &FlexOptions::default());
        let moved = carried(&s, &r(2, 7), &v(r(-31, 3), r(5, 1)));
        let found = flex(&moved, &FlexOptions::default());
        assert_eq!(wanted.ending, Ending::Converged, "{family}");
        assert_eq!(found.ending, Ending::Converged, "{family}");
        let off = (&wanted.displacement - &found.displacement).abs();
        assert!(
            off <= &wanted.displacement * &r(1, 10_000),
            "{family}: {} {}",
            wanted.displacement,
            found.displacement
        );
    }
}

/// No safe path may pass the outer bound, and for tight joints the two are near each other. The
/// block under a ceiling has its bound by hand: a joint on every side, 1/10 of room.
#[test]
fn outer_bounds_hold_what_safe_paths_reach() {
    for (family, bodies) in [("grid", 6), ("jit", 6), ("jrot", 4), ("chain", 4)] {
        let mut s = generate(family, bodies, 2).unwrap();
        s.step.path = Path::Safe;
        let inner = flex(&s, &FlexOptions::default()).displacement;
        let outer = outer_bound(&s, None).unwrap();
        assert!(outer.verified, "{family}");
        assert!(outer.value >= inner, "{family}: {} < {inner}", outer.value);
        assert!(
            outer.value <= &inner * &r(5, 4),
            "{family}: {} {inner}",
            outer.value
        );
    }
    let bodies = vec![
        rectangle("floor", [-40, -10, 40, 0], Hold::Fixed),
        rectangle("block", [0, 0, 10, 10], Hold::Free),
    ];
    let s = plain(bodies, vec![moves(1, 1, 0)]);
    assert!(outer_bound(&s, None).is_err(), "nothing holds it");
}

/// What the bound is a bound of: safe paths that were led elsewhere on the way (other weights, then
/// the one asked) reach nothing beyond it.
#[test]
fn no_feasible_flex_is_beyond_the_outer_bound() {
    let mut seed = 7i64;
    let mut draw = move || {
        seed = (seed * 1_103_515_245 + 12_345) & 0x7fff_ffff;
        seed / 65_536 % 7 - 3
    };
    for (family, bodies) in [("grid", 4), ("jit", 4), ("jrot", 4), ("chain", 3)] {
        let mut s = generate(family, bodies, 5).unwrap();
        s.step.path = Path::Safe;
        s.step.gain = r(1, 10_000);
        let asked = s.objective.clone();
        let outer = outer_bound(&s, None).unwrap().value;
        let weight = |flexed: &[Pose]| -> Rat {
            let mut sum = Rat::zero();
            for t in &asked {
                let Term::Body { body, dx, dy, .. } = t else {
                    panic!("{family}: its objective moves bodies")
                };
                let (at, from) = (&flexed[*body], Pose::of(&s.bodies[*body]));
                let moved = &at.place - &from.place;
                sum = sum + dx * &moved.x + dy * &moved.y;
            }
            sum
        };
        let mut best = Rat::zero();
        for _ in 0..2 + common::count(100) / 10 {
            let mut other = s.clone();
            let last = other.bodies.len() - 1;
            other.objective = vec![moves(last, draw(), draw()), moves(last / 2, draw(), 1)];
            let away = flex(&other, &FlexOptions::default());
            let there = away.configurations.last().unwrap();
            for poses in &away.configurations {
                let reached = weight(poses);
                assert!(reached <= outer, "{family}: {reached} > {outer}");
                best = best.max(reached);
            }
            // And from there as far as it goes in the direction asked.
            let mut on = s.clone();
            for (b, pose) in on.bodies.iter_mut().zip(there) {
                b.position = pose.position(b);
                b.tan_half = pose.tan_half.clone();
            }
            for poses in &flex(&on, &FlexOptions::default()).configurations {
                let reached = weight(poses);
                assert!(reached <= outer, "{family}: {reached} > {outer}");
                best = best.max(reached);
            }
        }
        assert!(best >= &outer * &r(3, 4), "{family}: {best} of {outer}");
    }
}

/// Two squares corner to corner: an averaged half-plane forbids what one of the edges allows, and
/// branching finds the best of all choices.
#[test]
fn branching_finds_the_best_side() {
    let bodies = vec![
        rectangle("still", [-20, -20, 0, 0], Hold::Fixed),
        rectangle("right", [60, -60, 80, 60], Hold::Fixed),
        rectangle("free", [1, 1, 21, 21], Hold::Free),
    ];
    let mut s = plain(bodies, vec![moves(2, -1, -3)]);
    s.epsilon = Rat::from(1);
    s.step = StepRules {
        rotation_limit: Some(r(1, 1000)),
        most: 1,
        ..StepRules::for_epsilon(&r(3, 5))
    };
    let average = flex(&s, &FlexOptions::default());
    let branch = flex(
        &s,
        &FlexOptions {
            corners: Corners::Branch,
            ..FlexOptions::default()
        },
    );
    assert_eq!(average.steps[0].facing, 1);
    // Past one of its edges alone the square may go on without end: to the left or downwards.
    assert_eq!(branch.ending, Ending::Unbounded);
    assert_eq!(average.ending, Ending::Unbounded);
    // With a weight that the averaged line bounds: −x − y.
    s.objective = vec![moves(2, -1, -1)];
    let average = flex(&s, &FlexOptions::default());
    assert!(average.steps[0].objective >= r(2, 10) && average.steps[0].objective < r(21, 100));
}

/// A chain long enough to curl past where it is farthest: its best lies within the joints' ranges,
/// where no vertex is, and is reached all the same.
#[test]
fn a_chain_curls_to_its_best_in_few_steps() {
    let s = generate("chain", 223, 1).expect("a structure");
    let flexed = flex(&s, &FlexOptions::default());
    assert_eq!(flexed.ending, Ending::Converged);
    assert!(flexed.steps.len() <= 30, "{}", flexed.steps.len());
    assert!(flexed.displacement > r(157_203, 100));
    assert!(flexed.violation.square <= s.step.violation.square());
}

/// Digits stay bounded however many steps are taken.
#[test]
fn digits_do_not_pile_up() {
    let mut s = generate("chain", 6, 1).unwrap();
    // Short steps: a small violation allowed, and no end by gain.
    s.step.violation = r(1, 100_000);
    s.step.gain = r(1, 1_000_000_000);
    s.step.most = 20;
    s.step.rotation_limit = Some(r(1, 500));
    let flexed = flex(&s, &FlexOptions::default());
    assert!(flexed.steps.len() >= 5, "{}", flexed.steps.len());
    let bits: Vec<u64> = flexed.steps.iter().map(|s| s.bits).collect();
    assert!(bits.iter().all(|b| *b <= 64), "{bits:?}");
}

/// How a run ended is said in a sentence, and which gradients were rounded: none of the first step.
/// After a little restoration the exact optimum of one more program tells what is left.
#[test]
fn the_end_of_a_run_is_explained() {
    let s = generate("grid", 36, 1).unwrap();
    let flexed = flex(&s, &FlexOptions::default());
    assert_eq!(flexed.ending, Ending::Converged);
    assert_eq!(flexed.steps[0].gradient_bits, None);
    assert!(flexed.steps[1..].iter().all(|s| s.gradient_bits.is_some()));
    let last = flexed.steps.last().unwrap();
    assert!(
        flexed.steps.iter().any(|s| s.gain.sign() < 0),
        "one restores"
    );
    assert!(last.gain.is_zero() && last.objective.is_zero());
    assert!(
        matches!(flexed.why, Why::Little(p) if p == 0.0),
        "{:?}",
        flexed.why
    );
    let mut one = s.clone();
    one.step.most = 1;
    assert_eq!(flex(&one, &FlexOptions::default()).why, Why::Steps(1));
    let none = FlexOptions {
        time_limit: Some(std::time::Duration::ZERO),
        ..FlexOptions::default()
    };
    assert_eq!(flex(&s, &none).why, Why::Time);
}

/// A gain that no double holds, small or large, is no reason to fail.
#[test]
fn any_gain_may_be_asked_for() {
    for gain in ["1e-9999", "1e9999"] {
        let mut s = generate("grid", 4, 1).unwrap();
        s.step.gain = snapfit::number::literal::parse(gain).unwrap();
        s.step.most = 3;
        for path in [Path::Fast, Path::Safe] {
            s.step.path = path;
            let flexed = flex(&s, &FlexOptions::default());
            assert!(flexed.displacement.sign() > 0, "{gain}");
        }
    }
}
