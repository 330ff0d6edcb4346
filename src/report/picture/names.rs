//! Room for names: each obstacle's name inside what a panel shows of it, clear of all that moves.

use super::svg::{MUTED, Point, Svg, text_width};

const SIZE: f64 = 10.5;
/// Candidates in each direction.
const GRID: usize = 9;
/// Past so many vertices a name is not worth the search.
const MOST_VERTICES: usize = 400;

/// The names that a panel is to carry.
pub(super) struct Names {
    frame: [f64; 4],
    asked: Vec<(String, Vec<Vec<Point>>)>,
    obstructions: Vec<Vec<Point>>,
}

impl Names {
    /// Names within a frame [x, y, width, height] of the page.
    pub(super) fn new(frame: [f64; 4]) -> Names {
        Names {
            frame,
            asked: Vec::new(),
            obstructions: Vec::new(),
        }
    }

    /// Asks for a name within a shape.
    pub(super) fn ask(&mut self, name: &str, rings: Vec<Vec<Point>>) {
        if rings.iter().map(Vec::len).sum::<usize>() <= MOST_VERTICES {
            self.asked.push((name.to_owned(), rings));
        }
    }

    /// Keeps names out of a polygon.
    pub(super) fn avoid(&mut self, ring: Vec<Point>) {
        self.obstructions.push(ring);
    }

    /// Writes those that have room.
    pub(super) fn write(&self, page: &mut Svg) {
        let [x, y, w, h] = self.frame;
        for (name, rings) in &self.asked {
            let half = [0.5 * text_width(name, SIZE) + 2.0, 0.5 * SIZE + 1.0];
            // What of the shape's box is seen, less half a name.
            let points = || rings.iter().flatten();
            let least = |axis: usize, edge: f64| {
                points()
                    .fold(f64::INFINITY, |m, p| m.min(p[axis]))
                    .max(edge)
            };
            let most = |axis: usize, edge: f64| {
                points()
                    .fold(f64::NEG_INFINITY, |m, p| m.max(p[axis]))
                    .min(edge)
            };
            let lo = [least(0, x) + half[0], least(1, y) + half[1]];
            let hi = [most(0, x + w) - half[0], most(1, y + h) - half[1]];
            if lo[0] > hi[0] || lo[1] > hi[1] {
                continue;
            }
            let middle = [(lo[0] + hi[0]) / 2.0, (lo[1] + hi[1]) / 2.0];
            let step = |axis: usize, k: usize| {
                lo[axis] + (hi[axis] - lo[axis]) * k as f64 / (GRID - 1) as f64
            };
            let grid = (0..GRID * GRID).map(|k| [step(0, k % GRID), step(1, k / GRID)]);
            let off = |p: &Point| (p[0] - middle[0]).abs() + (p[1] - middle[1]).abs();
            let free = grid.filter(|c| self.fits(*c, half, rings));
            if let Some([cx, cy]) = free.min_by(|a, b| off(a).total_cmp(&off(b))) {
                page.text(cx, cy + 0.36 * SIZE, SIZE, MUTED, "middle", false, name);
            }
        }
    }

    /// Whether a name about c lies within the shape and outside of all that is to be avoided.
    fn fits(&self, c: Point, half: Point, rings: &[Vec<Point>]) -> bool {
        let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
        steps
            .iter()
            .flat_map(|i| steps.map(|j| [c[0] + i * half[0], c[1] + j * half[1]]))
            .all(|p| {
                inside(p, rings)
                    && self
                        .obstructions
                        .iter()
                        .all(|o| !inside(p, std::slice::from_ref(o)))
            })
    }
}

/// Whether a point lies within rings, by the even-odd rule.
fn inside(p: Point, rings: &[Vec<Point>]) -> bool {
    let mut odd = false;
    for ring in rings {
        for (i, a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            if (a[1] > p[1]) != (b[1] > p[1]) {
                let x = a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                odd ^= x > p[0];
            }
        }
    }
    odd
}
