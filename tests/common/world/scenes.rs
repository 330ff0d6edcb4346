//! Random scenes on small integer grids, so that degeneracies happen by themselves, and a plain
//! shrinker for what fails.

use super::oracle::polygon;
use super::rng::Rng;
use snapfit::geometry::{Polygon, Vec2, defects, interiors_intersect};
use snapfit::number::Rat;
use snapfit::scene::{Motion, Obstacle, Pawl, Root, Scene};

/// What a random scene is made of.
#[derive(Clone, Debug)]
pub struct Recipe {
    pub seed: u64,
    pub pawls: usize,
    pub obstacles: usize,
    /// Most vertices of one polygon.
    pub corners: usize,
    /// Coordinates are multiples of 1/grid.
    pub grid: i64,
    pub friction: bool,
    pub limits: bool,
    pub root: bool,
    pub phases: usize,
}

impl Recipe {
    /// A recipe drawn from a seed; now and then a large one, up to about 2,500 contact pairs.
    pub fn draw(seed: u64) -> Recipe {
        let mut r = Rng::new(seed);
        let large = r.chance(4);
        Recipe {
            seed,
            pawls: *r.pick(&[1, 1, 1, 2, 2, 3]),
            obstacles: if large {
                r.range(4, 6) as usize
            } else {
                r.range(1, 4) as usize
            },
            corners: if large { 14 } else { r.range(3, 8) as usize },
            grid: if large {
                16
            } else {
                *r.pick(&[1, 1, 1, 2, 2, 4, 7])
            },
            friction: r.chance(50),
            limits: r.chance(15),
            root: r.chance(15),
            phases: *r.pick(&[1, 1, 2, 2, 3]),
        }
    }
}

/// A star-shaped polygon about (0, 0) with vertices on the grid, in either listing order.
fn star(r: &mut Rng, corners: usize, radius: f64, grid: i64, convex: bool) -> Vec<Vec2> {
    loop {
        let n = r.range(3, corners.max(3) as i64) as usize;
        let mut angles: Vec<f64> = (0..n).map(|_| r.unit() * std::f64::consts::TAU).collect();
        angles.sort_by(f64::total_cmp);
        let mut v: Vec<Vec2> = Vec::new();
        for a in angles {
            let rho = radius * if convex { 1.0 } else { 0.25 + 0.75 * r.unit() };
            let g = |x: f64| Rat::frac((x * grid as f64).round() as i64, grid);
            let p = Vec2::new(g(rho * a.cos()), g(rho * a.sin()));
            if v.last() != Some(&p) {
                v.push(p);
            }
        }
        if v.len() > 1 && v.first() == v.last() {
            v.pop();
        }
        if v.len() >= 3 && proper(&v) {
            if r.chance(50) {
                v.reverse();
            }
            return v;
        }
    }
}

/// An axis-parallel shape: bar, L or hook, the stuff that mechanisms are made of.
fn block(r: &mut Rng, size: i64, grid: i64) -> Vec<Vec2> {
    let mut d = |lo: i64| r.range(lo, (size * grid).max(lo + 1));
    let (w, h, a, b) = (d(2), d(2), d(1), d(1));
    let p = |x: i64, y: i64| Vec2::new(Rat::frac(x, grid), Rat::frac(y, grid));
    let (a, b) = (a.min(w - 1).max(1), b.min(h - 1).max(1));
    match r.range(0, 3) {
        0 => vec![p(0, 0), p(w, 0), p(w, h), p(0, h)],
        1 => vec![p(0, 0), p(w, 0), p(w, b), p(a, b), p(a, h), p(0, h)],
        2 => vec![p(0, 0), p(w, 0), p(a, h)],
        _ => vec![p(0, 0), p(w, b), p(w, h), p(a, h), p(a, b)],
    }
}

fn proper(v: &[Vec2]) -> bool {
    defects(&Polygon::new(v.to_vec(), Vec::new())).is_empty()
}

fn moved(v: &[Vec2], by: &Vec2) -> Vec<Vec2> {
    v.iter().map(|p| p + by).collect()
}

/// Whether nothing penetrates at the start.
pub fn starts_free(s: &Scene) -> bool {
    let fixed: Vec<Polygon> = s.obstacles.iter().map(polygon).collect();
    let clear = |p: &Polygon| !fixed.iter().any(|o| interiors_intersect(p, o));
    s.pawls.iter().all(|p| {
        let at_rest = Polygon::new(p.vertices.clone(), Vec::new());
        clear(&at_rest.rotated(&p.hinge, &p.start))
    }) && s
        .root
        .iter()
        .all(|r| clear(&Polygon::new(r.vertices.clone(), Vec::new())))
}

/// The scene of a recipe.
pub fn random_scene(recipe: &Recipe) -> Scene {
    for attempt in 0.. {
        let mut r = Rng::new(recipe.seed.wrapping_mul(1_000_003).wrapping_add(attempt));
        let s = attempt_scene(recipe, &mut r);
        let whole = s.obstacles.iter().all(|o| defects(&polygon(o)).is_empty())
            && s.pawls.iter().all(|p| proper(&p.vertices));
        if whole && starts_free(&s) {
            return s;
        }
    }
    unreachable!()
}

fn attempt_scene(recipe: &Recipe, r: &mut Rng) -> Scene {
    let g = recipe.grid;
    let point = |r: &mut Rng, lo: i64, hi: i64| {
        Vec2::new(
            Rat::frac(r.range(lo * g, hi * g), g),
            Rat::frac(r.range(lo * g, hi * g), g),
        )
    };
    let mut obstacles = Vec::new();
    for i in 0..recipe.obstacles {
        let mut holes = Vec::new();
        let at = point(r, -5, 5);
        let vertices = match r.range(0, 9) {
            0..=4 => {
                let radius = r.range(1, 4) as f64;
                let convex = r.chance(40);
                star(r, recipe.corners, radius, g, convex)
            }
            5 => {
                let convex = r.chance(50);
                holes.push(moved(&star(r, 4, 1.5, g, convex), &at));
                star(r, recipe.corners, 5.0, g, true)
            }
            _ => block(r, 4, g),
        };
        obstacles.push(Obstacle {
            name: format!("o{i}"),
            vertices: moved(&vertices, &at),
            holes,
        });
    }
    let heading = match r.range(0, 5) {
        0..=2 => Vec2::new(Rat::zero(), Rat::from(-1)),
        3 => Vec2::new(Rat::from(r.range(-1, 1)), Rat::from(-1)),
        _ => Vec2::new(Rat::from(r.range(-2, 2)), Rat::from(-r.range(1, 3))),
    };
    let mut pawls = Vec::new();
    for i in 0..recipe.pawls {
        let radius = r.range(2, 5) as f64;
        let mut v = if r.chance(75) {
            let convex = r.chance(40);
            star(r, recipe.corners, radius, g, convex)
        } else {
            block(r, 4, g)
        };
        // The hinge: a vertex, the middle, or beside the pawl.
        match r.range(0, 4) {
            0..=1 => {
                let k = r.next() as usize % v.len();
                let a = -&v[k];
                v = moved(&v, &a);
            }
            2 => {
                let by = point(r, -3, 3);
                v = moved(&v, &by);
            }
            _ => {}
        }
        let hinge = Vec2::new(
            Rat::frac(r.range(-5 * g, 5 * g), g),
            Rat::frac(r.range(3 * g, 9 * g), g),
        );
        let limits = (recipe.limits && r.chance(70)).then(|| {
            let lo = Rat::frac(r.range(-8, 0), 8);
            let hi = &lo + Rat::frac(r.range(1, 12), 8);
            (lo, hi)
        });
        let start = match (&limits, r.chance(15)) {
            (Some((lo, hi)), _) if lo.sign() > 0 || hi.sign() < 0 => lo.clone(),
            (Some((_, hi)), true) => hi.clone(),
            (None, true) => Rat::frac(r.range(-6, 6), 4),
            _ => Rat::zero(),
        };
        pawls.push(Pawl {
            name: format!("p{i}"),
            vertices: moved(&v, &hinge),
            hinge,
            stiffness: None,
            start,
            limits,
        });
    }
    let root = recipe.root.then(|| Root {
        vertices: {
            let by = Vec2::new(Rat::from(r.range(-3, 3)), Rat::from(9));
            moved(&block(r, 4, g), &by)
        },
        reference: None,
    });
    let mut motions = Vec::new();
    for k in 0..recipe.phases {
        if k > 0 && r.chance(60) {
            motions.push(Motion::Reverse);
            continue;
        }
        let velocity = match k {
            0 => heading.clone(),
            _ => loop {
                let v = Vec2::new(Rat::from(r.range(-2, 2)), Rat::from(r.range(-2, 2)));
                if !v.is_zero() {
                    break v;
                }
            },
        };
        motions.push(Motion::Translate {
            velocity,
            duration: Some(Rat::frac(r.range(4, 24), 2)),
            until_root_collision: root.is_some() && r.chance(40),
        });
    }
    let friction = recipe.friction.then(|| match r.range(0, 5) {
        0 => Rat::zero(),
        1 => Rat::frac(1, 50),
        2 => Rat::frac(3, 10),
        3 => Rat::frac(1, 2),
        4 => Rat::one(),
        _ => Rat::from(3),
    });
    Scene {
        name: format!("random-{}", recipe.seed),
        friction,
        obstacles,
        root,
        pawls,
        motions,
        classify: None,
    }
}

/// The scene with everything left out that is not needed to fail.
pub fn shrink(scene: &Scene, fails: &dyn Fn(&Scene) -> bool) -> Scene {
    let mut best = scene.clone();
    let sound = |s: &Scene| {
        !s.obstacles.is_empty()
            && !s.pawls.is_empty()
            && !s.motions.is_empty()
            && s.motions[0] != Motion::Reverse
            && s.obstacles
                .iter()
                .all(|o| o.vertices.len() > 2 && defects(&polygon(o)).is_empty())
            && s.pawls
                .iter()
                .all(|p| p.vertices.len() > 2 && proper(&p.vertices))
            && starts_free(s)
    };
    loop {
        let mut tries: Vec<Scene> = Vec::new();
        let mut with = |change: &dyn Fn(&mut Scene)| {
            let mut s = best.clone();
            change(&mut s);
            tries.push(s);
        };
        for i in 0..best.pawls.len() {
            with(&|s| drop(s.pawls.remove(i)));
        }
        for i in 0..best.obstacles.len() {
            with(&|s| drop(s.obstacles.remove(i)));
        }
        for i in 0..best.motions.len() {
            with(&|s| drop(s.motions.remove(i)));
        }
        with(&|s| {
            s.root = None;
            for m in &mut s.motions {
                if let Motion::Translate {
                    until_root_collision,
                    ..
                } = m
                {
                    *until_root_collision = false;
                }
            }
        });
        with(&|s| s.friction = None);
        for i in 0..best.pawls.len() {
            with(&|s| s.pawls[i].limits = None);
            with(&|s| s.pawls[i].start = Rat::zero());
            for k in 0..best.pawls[i].vertices.len() {
                with(&|s| drop(s.pawls[i].vertices.remove(k)));
            }
        }
        for i in 0..best.obstacles.len() {
            for k in 0..best.obstacles[i].vertices.len() {
                with(&|s| drop(s.obstacles[i].vertices.remove(k)));
            }
            for k in 0..best.obstacles[i].holes.len() {
                with(&|s| drop(s.obstacles[i].holes.remove(k)));
            }
        }
        let smaller = tries
            .into_iter()
            .find(|s| *s != best && sound(s) && fails(s));
        match smaller {
            Some(s) => best = s,
            None => return best,
        }
    }
}
