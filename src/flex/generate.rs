//! The paper's families of structures: grids and walls of interlocking blocks, rings, chains, the
//! can, trees of robots.
//!
//! The block of `grid`, `jit`, `jrot` and `ring` has twenty vertices: a square of side 10 inset by
//! 1/100, dovetail tabs on its right and top, sockets on its left and bottom, so that faces stand
//! 1/50 apart. In `jit` every block is shifted inside its clearance, in `jrot` shifted and turned,
//! in `ring` bent round a circle. These four name their contacts (as the nominal block has them);
//! the others leave it to closeness. `robots` holds the families of robots.

use super::random::Pcg64;
use super::robots::{flock, tree};
use super::types::{Body, Contact, Hold, Joint, StepRules, Structure, Term};
use crate::geometry::Vec2;
use crate::number::Rat;

/// The families by name, with what each is.
pub const FAMILIES: &[(&str, &str)] = &[
    ("grid", "interlocking blocks in rows and columns"),
    ("jit", "the same, every block shifted inside its clearance"),
    ("jrot", "the same, shifted and turned"),
    ("ring", "the same bent round a closed ring"),
    ("chain", "blocks in a row, one dovetail between two"),
    ("wall", "bricks in running bond"),
    ("can", "the outline of a can, its top pressed in"),
    ("flock", "robots that keep each other in view"),
    ("tree", "robots on round hinges, branching as the seed says"),
];

/// Most bodies that are generated.
pub const MAX_BODIES: usize = 5_000;

/// Generates a structure.
///
/// # Errors
/// An unknown family, or a number of bodies that the family does not have.
pub fn generate(family: &str, bodies: usize, seed: u64) -> Result<Structure, String> {
    let least = match family {
        "can" => 8,
        "ring" => 4,
        _ => 2,
    };
    if !(least..=MAX_BODIES).contains(&bodies) {
        return Err(format!("{family} has from {least} to {MAX_BODIES} bodies"));
    }
    match family {
        "grid" | "jit" | "jrot" | "ring" => Ok(lattice(family, bodies, seed)),
        "chain" => Ok(chain(bodies)),
        "wall" => Ok(wall(bodies)),
        "can" => Ok(can(bodies)),
        "flock" => Ok(flock(bodies)),
        "tree" => Ok(tree(bodies, seed)),
        _ => {
            let names: Vec<&str> = FAMILIES.iter().map(|f| f.0).collect();
            Err(format!(
                "there is no family `{family}`; there is: {}",
                names.join(", ")
            ))
        }
    }
}

/// A vertex in hundredths.
pub(super) type Cent = (i64, i64);

fn cents((x, y): Cent) -> Vec2 {
    Vec2::new(Rat::frac(x, 100), Rat::frac(y, 100))
}

/// Half the side of the cell, less half the clearance.
const FACE: i64 = 499;
/// The tab on the right face, downside up: neck, head, head, neck.
const TAB: [Cent; 4] = [(499, -100), (699, -150), (699, 150), (499, 100)];
/// The socket on the left face, from its top down.
const SOCKET: [Cent; 4] = [(-499, 102), (-299, 152), (-299, -152), (-499, -102)];

/// Turned by +90°.
fn quarter((x, y): Cent) -> Cent {
    (-y, x)
}

/// A block with tabs and sockets on those sides that are asked for, counter-clockwise from its
/// lower right corner.
pub(super) fn block(right: bool, top: bool, left: bool, bottom: bool) -> Vec<Cent> {
    let mut v = vec![(FACE, -FACE)];
    let mut side = |wanted: bool, shape: [Cent; 4], turned: bool, corner: Option<Cent>| {
        if wanted {
            v.extend(shape.map(|p| if turned { quarter(p) } else { p }));
        }
        v.extend(corner);
    };
    side(right, TAB, false, Some((FACE, FACE)));
    side(top, TAB, true, Some((-FACE, FACE)));
    side(left, SOCKET, false, Some((-FACE, -FACE)));
    side(bottom, SOCKET, true, None);
    v
}

/// The contacts of a block with its like at an offset: a convex vertex above an edge, at most 3/5
/// away, its foot on the edge or at most 3/5 past a reflex end.
fn contacts(v: &[Cent], (ox, oy): Cent) -> Vec<Contact> {
    const EPSILON: i64 = 60;
    let n = v.len();
    let moved: Vec<Cent> = v.iter().map(|&(x, y)| (x + ox, y + oy)).collect();
    let at = |ring: &[Cent], k: usize| ring[k % n];
    let convex: Vec<bool> = (0..n)
        .map(|k| {
            let (a, b, c) = (at(v, k + n - 1), at(v, k), at(v, k + 1));
            (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0) > 0
        })
        .collect();
    let mut out = Vec::new();
    for edge_of_first in [true, false] {
        let (edges, points) = if edge_of_first {
            (v, moved.as_slice())
        } else {
            (moved.as_slice(), v)
        };
        for vertex in 0..n {
            for edge in 0..n {
                let (a, b, p) = (at(edges, edge), at(edges, edge + 1), points[vertex]);
                let (ex, ey) = (b.0 - a.0, b.1 - a.1);
                let (px, py) = (p.0 - a.0, p.1 - a.1);
                let l2 = ex * ex + ey * ey;
                let within = |d: i64| d * d <= EPSILON * EPSILON * l2;
                let (s, f) = (ey * px - ex * py, ex * px + ey * py);
                let over = (-f).max(f - l2);
                let end = if f < 0 { edge } else { (edge + 1) % n };
                if convex[vertex]
                    && s > 0
                    && within(s)
                    && (over <= 0 || (!convex[end] && within(over)))
                {
                    out.push(Contact {
                        edge_of_first,
                        edge,
                        vertex,
                    });
                }
            }
        }
    }
    out
}

/// Columns and rows of a lattice of n blocks: the published sizes, else the most even.
fn sides(n: usize, ring: bool) -> (usize, usize) {
    let known = match (n, ring) {
        (36, false) => Some((12, 3)),
        (50, false) => Some((10, 5)),
        (90, false) => Some((15, 6)),
        (153, false) => Some((51, 3)),
        (223, false) => Some((223, 1)),
        (332, false) => Some((83, 4)),
        (392, false) => Some((28, 14)),
        (396, false) => Some((99, 4)),
        (36, true) => Some((18, 2)),
        (90, true) => Some((30, 3)),
        (392, true) => Some((56, 7)),
        (688, _) => Some((172, 4)),
        (1703, _) => Some((131, 13)),
        (2497, _) => Some((227, 11)),
        _ => None,
    };
    known.unwrap_or_else(|| {
        let low = (1..)
            .take_while(|h| h * h <= n)
            .filter(|h| n.is_multiple_of(*h))
            // A ring as wide as it is round would overlap itself at its inner side.
            .filter(|h| !ring || (n / h >= 4 && n / h > *h))
            .last()
            .unwrap_or(1);
        (n / low, low)
    })
}

fn lattice(family: &str, n: usize, seed: u64) -> Structure {
    let (w, h) = sides(n, family == "ring");
    let template = block(true, true, true, true);
    let mut rng = Pcg64::new(seed);
    let mut bodies = Vec::with_capacity(n);
    for j in 0..h {
        for i in 0..w {
            let (x, y) = (10 * i as i64, 10 * j as i64);
            let nominal = Vec2::new(Rat::from(x), Rat::from(y));
            let (position, vertices) = match family {
                "jit" => {
                    // Four decimals, at most 1/250 off in each direction.
                    let (dx, dy) = (rng.integer(-40, 40), rng.integer(-40, 40));
                    let by = Vec2::new(Rat::frac(dx, 10_000), Rat::frac(dy, 10_000));
                    let vertices = template.iter().map(|&p| &cents(p) + &by).collect();
                    (nominal, vertices)
                }
                "jrot" => {
                    let angle = rng.uniform(-4e-4, 4e-4);
                    let dx = rng.uniform(-0.003, 0.003);
                    let dy = rng.uniform(-0.003, 0.003);
                    let (c, s) = (angle.cos(), angle.sin());
                    let decimals =
                        |v: f64| Rat::frac((v * 1e6).round_ties_even() as i64, 1_000_000);
                    let turned = |&(a, b): &Cent| {
                        let (a, b) = (a as f64 / 100.0, b as f64 / 100.0);
                        let at = Vec2::new(
                            decimals(x as f64 + dx + c * a - s * b),
                            decimals(y as f64 + dy + s * a + c * b),
                        );
                        &at - &nominal
                    };
                    let vertices = template.iter().map(turned).collect();
                    (nominal, vertices)
                }
                "ring" => {
                    let radius = 10.0 * w as f64 / (2.0 * std::f64::consts::PI);
                    let bent = |x: f64, y: f64| {
                        let angle = std::f64::consts::FRAC_PI_2 - x / radius;
                        let r = radius + y;
                        let decimals =
                            |v: f64| Rat::frac((v * 1e5).round_ties_even() as i64, 100_000);
                        Vec2::new(decimals(r * angle.cos()), decimals(r * angle.sin()))
                    };
                    let centre = bent(x as f64, y as f64);
                    let vertices = template
                        .iter()
                        .map(|&(a, b)| {
                            let at = bent(x as f64 + a as f64 / 100.0, y as f64 + b as f64 / 100.0);
                            &at - &centre
                        })
                        .collect();
                    (centre, vertices)
                }
                _ => (nominal, template.iter().map(|&p| cents(p)).collect()),
            };
            bodies.push(Body {
                name: format!("b{i}_{j}"),
                vertices,
                position,
                tan_half: Rat::zero(),
                hold: if i + j == 0 { Hold::Fixed } else { Hold::Free },
            });
        }
    }
    let (mut across, mut up) = (Vec::new(), Vec::new());
    for k in 0..n {
        let (i, j) = (k % w, k / w);
        if i + 1 < w {
            across.push((k, k + 1));
        } else if family == "ring" && w > 2 {
            across.push((k, j * w));
        }
        if j + 1 < h {
            up.push((k, k + w));
        }
    }
    let joint = |bodies: Vec<(usize, usize)>, offset: Cent| Joint {
        bodies,
        contacts: Some(contacts(&template, offset)),
    };
    let joints = [joint(across, (1000, 0)), joint(up, (0, 1000))];
    let far = match family {
        // Opposite the fixed block, in the outer layer.
        "ring" => (h - 1) * w + w / 2,
        _ => n - 1,
    };
    structure(
        format!("{family}{n}"),
        bodies,
        Some(
            joints
                .into_iter()
                .filter(|j| !j.bodies.is_empty())
                .collect(),
        ),
        vec![upwards(far)],
    )
}

fn upwards(body: usize) -> Term {
    Term::Body {
        body,
        dx: Rat::zero(),
        dy: Rat::one(),
        dtheta: Rat::zero(),
    }
}

/// A structure with the block's ε and a tenth of its clearance as the violation allowed.
pub(super) fn structure(
    name: String,
    bodies: Vec<Body>,
    joints: Option<Vec<Joint>>,
    objective: Vec<Term>,
) -> Structure {
    let epsilon = Rat::frac(3, 5);
    Structure {
        step: StepRules {
            violation: Rat::frac(1, 500),
            ..StepRules::for_epsilon(&epsilon)
        },
        name,
        epsilon,
        bodies,
        joints,
        nearest: None,
        views: Vec::new(),
        objective,
    }
}

pub(super) fn body(name: String, shape: &[Cent], at: (i64, i64), fixed: bool) -> Body {
    Body {
        name,
        vertices: shape.iter().map(|&p| cents(p)).collect(),
        position: Vec2::new(Rat::from(at.0), Rat::from(at.1)),
        tan_half: Rat::zero(),
        hold: if fixed { Hold::Fixed } else { Hold::Free },
    }
}

fn chain(n: usize) -> Structure {
    let bodies = (0..n)
        .map(|k| {
            let shape = block(k + 1 < n, false, k > 0, false);
            body(format!("link{k}"), &shape, (10 * k as i64, 0), k == 0)
        })
        .collect();
    structure(format!("chain{n}"), bodies, None, vec![upwards(n - 1)])
}

/// Bricks twice as wide as high, each course shifted by half a brick: two tabs on top of each,
/// two sockets below.
fn wall(n: usize) -> Structure {
    let w = (1..).find(|w| w * w >= n).unwrap_or(n);
    let brick = |top: bool, bottom: bool| {
        let mut v: Vec<Cent> = vec![(999, -FACE), (999, FACE)];
        let tab = |x: i64| TAB.map(quarter).map(|(a, b)| (a + x, b));
        let socket = |x: i64| SOCKET.map(quarter).map(|(a, b)| (a + x, b));
        if top {
            v.extend(tab(500));
            v.extend(tab(-500));
        }
        v.extend([(-999, FACE), (-999, -FACE)]);
        if bottom {
            v.extend(socket(-500));
            v.extend(socket(500));
        }
        v
    };
    let rows = n.div_ceil(w);
    let bodies = (0..n)
        .map(|k| {
            let (i, j) = ((k % w) as i64, (k / w) as i64);
            let shape = brick(k / w + 1 < rows, j > 0);
            body(
                format!("brick{i}_{j}"),
                &shape,
                (20 * i + 10 * (j % 2), 10 * j),
                k == 0,
            )
        })
        .collect();
    structure(format!("wall{n}"), bodies, None, vec![upwards(n - 1)])
}

/// The outline of a can, one block thick: its bottom stands fixed, its top's middle is pressed
/// down. A closed ring of blocks on a lattice has an even number of them; of an odd number the
/// last one is the can's tab, which stands on its top beside the middle.
fn can(n: usize) -> Structure {
    // n = 2 (w + h) − 4 without the tab, about half as wide as high.
    let sum = n / 2 + 2;
    let w = (sum / 3).max(3);
    let h = sum - w;
    let tab = (n % 2 == 1).then_some((w / 2 - 1, h));
    let inside = |i: usize, j: usize| {
        let edge = i == 0 || j == 0 || i + 1 == w || j + 1 == h;
        (i < w && j < h && edge) || tab == Some((i, j))
    };
    let mut bodies = Vec::with_capacity(n);
    let mut pressed = 0;
    for j in 0..=h {
        for i in 0..w {
            if !inside(i, j) {
                continue;
            }
            let right = inside(i + 1, j);
            let top = inside(i, j + 1);
            let left = i > 0 && inside(i - 1, j);
            let bottom = j > 0 && inside(i, j - 1);
            if j + 1 == h && i == w / 2 {
                pressed = bodies.len();
            }
            let at = (10 * i as i64, 10 * j as i64);
            let shape = block(right, top, left, bottom);
            bodies.push(body(format!("c{i}_{j}"), &shape, at, j == 0 && i == w / 2));
        }
    }
    let down = Term::Body {
        body: pressed,
        dx: Rat::zero(),
        dy: Rat::from(-1),
        dtheta: Rat::zero(),
    };
    structure(format!("can{n}"), bodies, None, vec![down])
}
