//! Families of robots: the flock of PF §VI-B, held together by what its cameras must see, and the
//! tree, held together by joints.
//!
//! *The tree.* Every robot but the first hangs on an elder one by a loose hinge: the elder's arm
//! ends in an octagonal head inside an octagonal socket. The head lies in a circle of radius 1.978
//! and the socket around one of radius 2, so the hinge turns freely, until the arm meets a lip of
//! the socket's mouth some 2° to either side. Robots stand on the lattice of the two directions
//! (±4/5, 3/5), ten long, and face away from their elder: tan(θ/2) is −1/2 or 1/2. A robot with
//! two neighbours behind it hangs on the one that the seed says, so the tree branches like a
//! river, and any number of robots makes one. Robots that no hinge joins stand more than 1 apart.

use super::generate::{Cent, body, structure};
use super::random::Pcg64;
use super::types::{Body, Hold, Structure, Term, View};
use crate::geometry::Vec2;
use crate::number::Rat;

/// From a robot's hinge to its arms' heads.
const ARM: i64 = 1_000;
/// Half the side of a robot's square hull.
const HULL: i64 = 300;
/// A corner of a head's octagon, the others being its reflections; the arm is as wide as a side.
const HEAD: Cent = (183, 75);
/// A corner of a socket's octagon; the lower side is its mouth.
const SOCKET: Cent = (200, 83);
/// Half the width of the mouth at the hull's face.
const MOUTH: i64 = 140;

fn cent(v: i64) -> Rat {
    Rat::frac(v, 100)
}

/// An octagon from one end of its rear side to the other, by one corner: how far each of its corners
/// lies along a direction and across it.
fn octagon((a, b): Cent) -> [Cent; 8] {
    [
        (-a, b),
        (-b, a),
        (b, a),
        (a, b),
        (a, -b),
        (b, -a),
        (-b, -a),
        (-a, -b),
    ]
}

/// Adds the outline of an arm with its head, in a direction of length 1 that leaves the hull by
/// its right, upper or left side.
fn arm(to: &Vec2, outline: &mut Vec<Vec2>) {
    // `across` counts to the right of the arm.
    let at = |along: Rat, across: i64| {
        let across = cent(across);
        Vec2::new(
            &to.x * &along + &to.y * &across,
            &to.y * &along - &to.x * &across,
        )
    };
    // Where a side of the arm meets the hull's.
    let root = |across: i64| match to.x.sign() {
        0 => at(cent(HULL), across),
        sign => {
            let face = cent(i64::from(sign) * HULL);
            at((face - &to.y * &cent(across)) / &to.x, across)
        }
    };
    let side = HEAD.1;
    outline.push(root(side));
    outline.extend(octagon(HEAD).map(|(along, across)| at(cent(ARM + along), across)));
    outline.push(root(-side));
}

/// A robot of the tree, its hinge at the origin of its frame, its elder below it.
fn member(hinge: bool, right: Option<&Vec2>, ahead: bool, left: Option<&Vec2>) -> Vec<Vec2> {
    let corner = |x: i64, y: i64| Vec2::new(cent(x), cent(y));
    let mut v = vec![corner(HULL, -HULL)];
    if let Some(to) = right {
        arm(to, &mut v);
    }
    v.push(corner(HULL, HULL));
    if ahead {
        arm(&Vec2::new(Rat::zero(), Rat::one()), &mut v);
    }
    v.push(corner(-HULL, HULL));
    if let Some(to) = left {
        arm(to, &mut v);
    }
    v.push(corner(-HULL, -HULL));
    if hinge {
        v.push(corner(-MOUTH, -HULL));
        // Cut out, so gone round the other way than a head.
        v.extend(octagon(SOCKET).map(|(along, across)| corner(-across, along)));
        v.push(corner(MOUTH, -HULL));
    }
    v
}

/// Robots on loose hinges, the first one fixed; the last one is to go to the right.
pub(super) fn tree(n: usize, seed: u64) -> Structure {
    let mut rng = Pcg64::new(seed);
    // By number: place on the lattice (steps to the right, to the left), whether it faces right.
    let mut places: Vec<(i64, i64, bool)> = Vec::with_capacity(n);
    // Who hangs on whom: to the right, to the left.
    let mut younger = vec![[false; 2]; n];
    let (mut generation, mut steps) = (0usize, 0usize);
    for k in 0..n {
        let (i, j) = (steps, generation - steps);
        let faces_right = match (i, j) {
            (_, 0) => true,
            (0, _) => false,
            _ => rng.integer(0, 1) == 1,
        };
        if k > 0 {
            // Generation g has g + 1 robots and begins at g (g + 1) / 2.
            let before = generation * (generation - 1) / 2;
            let elder = before + if faces_right { i - 1 } else { i };
            younger[elder][usize::from(!faces_right)] = true;
        }
        places.push((i as i64, j as i64, faces_right));
        steps += 1;
        if steps > generation {
            (generation, steps) = (generation + 1, 0);
        }
    }
    let aside = |sign: i64| Vec2::new(Rat::frac(24 * sign, 25), Rat::frac(-7, 25));
    let bodies = places.iter().zip(&younger).enumerate();
    let bodies = bodies.map(|(k, ((i, j, faces_right), [to_right, to_left]))| {
        // Who faces right turns off to the left, and the other way round.
        let (ahead, turns_off) = if *faces_right {
            (*to_right, to_left.then(|| aside(-1)))
        } else {
            (*to_left, to_right.then(|| aside(1)))
        };
        let (right, left) = if *faces_right {
            (None, turns_off.as_ref())
        } else {
            (turns_off.as_ref(), None)
        };
        Body {
            name: format!("robot{k}"),
            vertices: member(k > 0, right, ahead, left),
            position: Vec2::new(Rat::from(8 * (i - j)), Rat::from(6 * (i + j))),
            tan_half: Rat::frac(if *faces_right { -1 } else { 1 }, 2),
            hold: if k == 0 { Hold::Fixed } else { Hold::Free },
        }
    });
    let sideways = Term::Body {
        body: n - 1,
        dx: Rat::one(),
        dy: Rat::zero(),
        dtheta: Rat::zero(),
    };
    structure(format!("tree{n}"), bodies.collect(), None, vec![sideways])
}

/// Robots in rows behind a leader, each with a camera on its front that keeps the marker on the
/// back of a robot before it in view. The flock is to move towards the leader's x.
pub(super) fn flock(n: usize) -> Structure {
    let half = Rat::frac(1, 2);
    let square: Vec<Cent> = vec![(50, -50), (50, 50), (-50, 50), (-50, -50)];
    let mut bodies = Vec::with_capacity(n);
    let mut views = Vec::new();
    let mut objective = Vec::new();
    let (mut row, mut column) = (0usize, 0usize);
    for k in 0..n {
        // Row r holds r + 1 robots, 3 apart, centred behind the leader.
        let x = &Rat::from(3 * column as i64) - &Rat::frac(3 * row as i64, 2);
        let mut robot = body(format!("robot{k}"), &square, (0, -3 * row as i64), k == 0);
        robot.position.x = x.clone();
        bodies.push(robot);
        if row > 0 {
            // The row before begins at row·(row − 1)/2.
            let before = row * (row - 1) / 2 + column.min(row - 1);
            let vec = |x: Rat, y: Rat| Vec2::new(x, y);
            views.push(View {
                body: k,
                camera: vec(Rat::zero(), half.clone()),
                left: vec(Rat::from(-1), Rat::one()),
                right: vec(Rat::one(), Rat::one()),
                far: Some(vec(Rat::zero(), Rat::from(4))),
                of: before,
                marker: vec(Rat::zero(), -&half),
            });
        }
        if k > 0 {
            objective.push(Term::Towards {
                body: k,
                x: Rat::zero(),
            });
        }
        column += 1;
        if column > row {
            (row, column) = (row + 1, 0);
        }
    }
    let mut s = structure(format!("flock{n}"), bodies, None, objective);
    s.nearest = Some(5);
    s.views = views;
    s.step.rotation_limit = Some(Rat::frac(1, 10));
    s.step.violation = Rat::frac(1, 100);
    s
}

#[cfg(test)]
mod tests {
    use crate::flex::generate::generate;
    use crate::flex::step::Run;
    use crate::flex::{FlexOptions, Structure};
    use crate::geometry::interiors_intersect;
    use std::collections::BTreeSet;

    /// Who constrains whom at the start.
    fn joined(s: &Structure) -> BTreeSet<(u32, u32)> {
        let options = FlexOptions::default();
        let run = Run::new(s, &options);
        let placed = run.scaffold.place(&run.scaffold.start);
        let pairs = run.selection(&placed, false).pairs;
        let two = |p: &crate::flex::Pair| {
            let (a, b) = (p.line_body, p.point_body);
            (a.min(b), a.max(b))
        };
        pairs.iter().map(two).collect()
    }

    /// A tree: of n robots n − 1 pairs are joined, each robot to one before it, whatever the
    /// count and the seed; nothing overlaps. Seeds make different trees.
    #[test]
    fn any_number_of_robots_makes_a_tree() {
        let mut shapes = BTreeSet::new();
        for n in (2..24).chain([55, 56, 100]) {
            for seed in 1..4 {
                let s = generate("tree", n, seed).expect("a tree");
                let joined = joined(&s);
                let younger: BTreeSet<u32> = joined.iter().map(|(_, b)| *b).collect();
                assert_eq!(joined.len(), n - 1, "{n} {seed}");
                assert_eq!(younger.len(), n - 1, "{n} {seed}: two elders");
                if n == 100 {
                    shapes.insert(joined);
                    let branches = |k: usize| {
                        let elder = |(a, _): &&(u32, u32)| *a as usize == k;
                        shapes.iter().flatten().filter(elder).count()
                    };
                    assert!((0..n).any(|k| branches(k) > 1), "it branches");
                    let placed = crate::flex::shape::placed(&s);
                    for (a, one) in placed.iter().enumerate() {
                        for two in &placed[a + 1..] {
                            assert!(!interiors_intersect(one, two));
                        }
                    }
                }
            }
        }
        assert_eq!(shapes.len(), 3);
    }

    /// A can of any count is one closed ring of blocks, with a tab where the count is odd.
    #[test]
    fn a_can_has_any_count() {
        for n in 8..40 {
            let s = generate("can", n, 1).expect("a can");
            assert_eq!(s.bodies.len(), n);
            // As many joints as blocks, or the ring's and the tab's.
            assert_eq!(joined(&s).len(), n, "{n}");
        }
    }
}
