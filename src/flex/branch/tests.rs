//! Branching against every choice there is.

use super::*;
use crate::flex::step::FlexOptions;
use crate::flex::types::{Body, Hold, StepRules, Structure, Term};
use crate::geometry::Vec2;

fn square(name: &str, at: [i64; 2], hold: Hold) -> Body {
    let v = |x: i64, y: i64| Vec2::new(Rat::from(x), Rat::from(y));
    Body {
        name: name.to_owned(),
        vertices: vec![v(-1, -1), v(1, -1), v(1, 1), v(-1, 1)],
        position: Vec2::new(Rat::frac(at[0], 100), Rat::frac(at[1], 100)),
        tan_half: Rat::zero(),
        hold,
    }
}

/// Three squares corner to corner along a diagonal, the first and last held, with gaps and
/// weights as drawn; what turns is limited, so that every choice has an optimum or none.
fn diagonal(gaps: [i64; 4], weight: [i64; 3]) -> Structure {
    let epsilon = Rat::frac(1, 2);
    let last = [400 + gaps[0] + gaps[2], 400 + gaps[1] + gaps[3]];
    // Walls beside the free one keep every choice bounded.
    let mut bodies = vec![
        square("first", [0, 0], Hold::Fixed),
        square("free", [200 + gaps[0], 200 + gaps[1]], Hold::Free),
        square("last", last, Hold::Fixed),
        square("left", [200 + gaps[0] - 230, 200 + gaps[1]], Hold::Fixed),
        square("right", [200 + gaps[0] + 230, 200 + gaps[1]], Hold::Fixed),
        square("below", [200 + gaps[0], 200 + gaps[1] - 230], Hold::Fixed),
        square("above", [200 + gaps[0], 200 + gaps[1] + 230], Hold::Fixed),
    ];
    // The walls must not run into the squares at the corners.
    for (b, turn) in bodies.iter_mut().skip(3).zip([0, 0, 0, 0]) {
        b.tan_half = Rat::from(turn);
        for v in &mut b.vertices {
            *v = v.scale(&Rat::frac(1, 2));
        }
    }
    for (k, by) in [(3, [50, 0]), (4, [-50, 0]), (5, [0, 50]), (6, [0, -50])] {
        let p = &mut bodies[k].position;
        p.x = &p.x + &Rat::frac(by[0], 100);
        p.y = &p.y + &Rat::frac(by[1], 100);
    }
    let step = StepRules {
        rotation_limit: Some(Rat::frac(1, 10)),
        most: 1,
        ..StepRules::for_epsilon(&epsilon)
    };
    Structure {
        name: "diagonal".to_owned(),
        bodies,
        joints: None,
        nearest: None,
        views: Vec::new(),
        objective: vec![Term::Body {
            body: 1,
            dx: Rat::from(weight[0]),
            dy: Rat::from(weight[1]),
            dtheta: Rat::from(weight[2]),
        }],
        step,
        epsilon,
    }
}

#[test]
fn no_choice_of_sides_is_better() {
    let mut seed = 3u64;
    let mut draw = |n: i64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as i64 % n
    };
    let options = FlexOptions {
        corners: Corners::Branch,
        ..FlexOptions::default()
    };
    let (mut two, mut worse) = (0, 0);
    for _ in 0..12 {
        let gaps = [0; 4].map(|_| 1 + draw(15));
        let s = diagonal(gaps, [draw(9) - 4, draw(9) - 4, draw(3) - 1]);
        let run = Run::new(&s, &options);
        let poses = &run.scaffold.start;
        let placed = run.scaffold.place(poses);
        let selection = run.selection(&placed, false);
        let (_, rows) = run.rows(&selection, &placed);
        let found = solve(&run, &rows, &selection, &placed, poses);
        let k = selection.facing.len();
        two += usize::from(k == 2);
        let mut best: Option<Rat> = None;
        for code in 0..4usize.pow(k as u32) {
            let mut all = rows.clone();
            for (i, f) in selection.facing.iter().enumerate() {
                let side = run.scaffold.choices(f)[code / 4usize.pow(i as u32) % 4];
                all.push(run.row(&side, &placed));
            }
            let (_, outcome) = run.program(&all, poses);
            let Some(value) = outcome
                .objective
                .filter(|_| outcome.status == Status::Optimal)
            else {
                assert_eq!(outcome.status, Status::Infeasible);
                continue;
            };
            worse += usize::from(best.as_ref().is_some_and(|b| *b != value));
            if best.as_ref().is_none_or(|b| value > *b) {
                best = Some(value);
            }
        }
        assert_eq!(Some(found.objective), best);
        assert_eq!(found.enclosure.1, best);
    }
    assert!(two > 6, "two disjunctions at once: {two}");
    assert!(worse > 6, "choices differ: {worse}");
}
