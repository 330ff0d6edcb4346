//! Gradients against differences, doubles against exact distances.

use super::*;
use crate::flex::types::{Body, StepRules};
use proptest::prelude::*;

fn rat() -> impl Strategy<Value = Rat> {
    (-40i64..40, 1i64..9).prop_map(|(n, d)| Rat::frac(n, d))
}

fn pose() -> impl Strategy<Value = Pose> {
    (rat(), rat(), (-20i64..20, 7i64..30)).prop_map(|(x, y, (p, q))| Pose {
        place: Vec2::new(x, y),
        tan_half: Rat::frac(p, q),
    })
}

/// A pentagon with a reflex corner, listed counter-clockwise or clockwise.
fn body(name: &str, clockwise: bool, hold: Hold) -> Body {
    let mut ring = vec![(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)];
    if clockwise {
        ring.reverse();
    }
    Body {
        name: name.to_owned(),
        vertices: ring
            .into_iter()
            .map(|(x, y)| Vec2::new(Rat::frac(x, 3), Rat::from(y)))
            .collect(),
        position: Vec2::default(),
        tan_half: Rat::zero(),
        hold,
    }
}

fn scaffold(clockwise: bool) -> Scaffold {
    let epsilon = Rat::one();
    let pin = Vec2::new(Rat::frac(1, 2), Rat::frac(-2, 7));
    Scaffold::new(&Structure {
        name: "two".to_owned(),
        bodies: vec![
            body("a", clockwise, Hold::Free),
            body("b", !clockwise, Hold::Pin(pin)),
        ],
        joints: None,
        nearest: None,
        views: Vec::new(),
        objective: Vec::new(),
        step: StepRules::for_epsilon(&epsilon),
        epsilon,
    })
}

/// n·(p − o), straight from PF eq. 12, with the normal as the row has it at these poses.
fn distance(s: &Scaffold, pair: &Pair, poses: &[Pose], factor: &Rat) -> Rat {
    let at = |body: usize, v: &IntVec, h: &Int| {
        let local = Vec2::new(
            Rat::new(v[0].clone(), h.clone()),
            Rat::new(v[1].clone(), h.clone()),
        );
        &poses[body].place + &local.rotate_tan_half(&poses[body].tan_half)
    };
    let (one, two) = (pair.line_body as usize, pair.point_body as usize);
    let line = s.line(one, pair.plane);
    let Point::Vertex(v) = pair.point else {
        unreachable!("only vertices are tried")
    };
    let p = at(two, &s.shapes[two].vertices[v as usize], &s.shapes[two].h);
    let o = at(one, &line.base, &line.h);
    let [x, y] = line.normal.map(Rat::from);
    let n = Vec2::new(x, y).rotate_tan_half(&poses[one].tan_half);
    &n.dot(&(&p - &o)) * factor
}

fn turned(pose: &Pose, w: &Rat) -> Pose {
    let u = &pose.tan_half;
    Pose {
        place: pose.place.clone(),
        tan_half: (u + w) / (Rat::one() - u * w),
    }
}

proptest! {
    /// Along x and y the distance is linear; in θ it is a + b cos + c sin, so that
    /// (d(δ) − d(−δ)) / (2 sin δ) is its derivative exactly, for any δ.
    #[test]
    fn gradients_are_exact_differences(
        one in pose(), two in pose(), edge in 0u32..5, vertex in 0u32..5,
        corner: bool, clockwise: bool, step in 1i64..9,
    ) {
        let s = scaffold(clockwise);
        let convex = s.shapes[0].corners[edge as usize] == crate::geometry::Corner::Convex;
        let plane = if corner && convex { Plane::Corner(edge) } else { Plane::Edge(edge) };
        let pair = Pair { line_body: 0, plane, point_body: 1, point: Point::Vertex(vertex) };
        let poses = [one, two];
        let w = Rat::frac(step, 10);
        let undefined = poses.iter().any(|p| {
            let (a, b) = (&p.tan_half * &w, Rat::one());
            a == b || a == -b
        });
        prop_assume!(!undefined);
        let row = s.row(&pair, &s.place(&poses));
        let line = s.line(0, plane);
        let [x, y] = line.normal.clone().map(Rat::from);
        let n = Vec2::new(x, y).rotate_tan_half(&poses[0].tan_half);
        let factor = if n.x.is_zero() {
            Rat::from(row.normal[1].clone()) / &n.y
        } else {
            Rat::from(row.normal[0].clone()) / &n.x
        };
        prop_assert!(factor.sign() > 0);
        prop_assert_eq!(&n.y * &factor, Rat::from(row.normal[1].clone()));
        let at = |poses: &[Pose]| distance(&s, &pair, poses, &factor);
        prop_assert_eq!(at(&poses), Rat::from(row.d0.clone()));
        for (body, sign) in [(0usize, -1i64), (1, 1)] {
            for axis in 0..2 {
                let mut moved = poses.clone();
                let slot = &mut moved[body].place;
                let slot = if axis == 0 { &mut slot.x } else { &mut slot.y };
                *slot = &*slot + &w;
                let slope = (at(&moved) - at(&poses)) / &w;
                let wanted = Rat::from(row.normal[axis].clone()) * Rat::from(sign);
                prop_assert_eq!(slope, wanted);
            }
            let (mut more, mut less) = (poses.clone(), poses.clone());
            more[body] = turned(&poses[body], &w);
            less[body] = turned(&poses[body], &-&w);
            let sine = (&w + &w) / (Rat::one() + &w * &w);
            let slope = (at(&more) - at(&less)) / (&sine + &sine);
            let wanted = if body == 0 { &row.theta1 } else { &row.theta2 };
            prop_assert_eq!(slope, Rat::from(wanted.clone()));
        }
    }

    /// A double's bound holds the exact distance.
    #[test]
    fn doubles_enclose_distances(
        one in pose(), two in pose(), edge in 0u32..5, vertex in 0u32..5,
    ) {
        let s = scaffold(false);
        let pair = Pair {
            line_body: 0, plane: Plane::Edge(edge), point_body: 1, point: Point::Vertex(vertex),
        };
        let placed = s.place(&[one, two]);
        let row = s.row(&pair, &placed);
        let (near, error) = s.near(&pair, &placed);
        let square = crate::flex::step::violation(&row);
        let exact = double(&square).sqrt() * f64::from(row.d0.sign());
        prop_assert!((near - exact).abs() <= error + 1e-12 * exact.abs(), "{near} {exact} {error}");
    }
}
