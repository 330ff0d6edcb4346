//! How a direction is followed: the bodies' places, bent along with their rotations.
//!
//! A direction gives every body a velocity and a turn. Straight ahead, two joined bodies that turn
//! together by θ part by θ²/2 of their distance, however stiff the joint: an arc is left along its
//! tangent. But what the program says of a joint is relative, B's place as A sees it, and that may
//! be kept to higher order: with θ the mean turn of the two, Δ the way between them and δ its
//! velocity, the way becomes R(θ)(Δ + δ − θΔ⊥). Bodies in a row are placed so one after the other;
//! where chains close, the ways contradict each other a little, and places are those of least
//! squares. What is left of the violation comes from the small relative turns.
//!
//! All in doubles: this proposes a configuration, and the exact test judges it.

use super::model::Form;
use super::shape::{Pose, doubles};
use std::collections::VecDeque;

/// Bodies as they are joined.
pub(crate) struct Bend {
    links: Vec<(usize, usize)>,
    /// Neighbours of a body: the other, the link, and 1 where the link leads to the other.
    near: Vec<Vec<(usize, usize, f64)>>,
    /// Whether a body's place is given: what is held, and bodies without links.
    given: Vec<bool>,
    /// Bodies from the given ones outwards, each with the link it is reached by.
    order: Vec<(usize, usize, usize, f64)>,
    places: Vec<[f64; 2]>,
}

/// Most iterations of the conjugate gradients, and the residual at which they end.
const MOST: usize = 400;
const RESIDUAL: f64 = 1e-12;

impl Bend {
    /// The joints between bodies at their poses. `links` may repeat.
    pub(crate) fn new(
        forms: &[Form],
        poses: &[Pose],
        links: impl Iterator<Item = (usize, usize)>,
    ) -> Bend {
        let mut links: Vec<(usize, usize)> = links.map(|(a, b)| (a.min(b), a.max(b))).collect();
        links.sort_unstable();
        links.dedup();
        let n = forms.len();
        let mut near = vec![Vec::new(); n];
        for (k, &(a, b)) in links.iter().enumerate() {
            near[a].push((b, k, 1.0));
            near[b].push((a, k, -1.0));
        }
        let mut given: Vec<bool> = (0..n)
            .map(|b| forms[b] != Form::Free || near[b].is_empty())
            .collect();
        let mut order = Vec::new();
        let mut seen = given.clone();
        let mut queue: VecDeque<usize> = (0..n).filter(|&b| given[b]).collect();
        let mut next = 0;
        loop {
            while let Some(a) = queue.pop_front() {
                for &(b, k, sign) in &near[a] {
                    if !seen[b] {
                        seen[b] = true;
                        order.push((a, b, k, sign));
                        queue.push_back(b);
                    }
                }
            }
            // A part that nothing holds: its first body goes straight.
            while next < n && seen[next] {
                next += 1;
            }
            if next == n {
                break;
            }
            (seen[next], given[next]) = (true, true);
            queue.push_back(next);
        }
        Bend {
            links,
            near,
            given,
            order,
            places: poses.iter().map(|p| doubles(&p.place)).collect(),
        }
    }

    /// The displacements (dx, dy) and turns dθ of the bodies for a part of a direction.
    pub(crate) fn follow(&self, direction: &[[f64; 3]], scale: f64) -> Vec<[f64; 3]> {
        let mut out: Vec<[f64; 3]> = direction.iter().map(|d| d.map(|v| v * scale)).collect();
        // A turn by dθ is made with half its tangent, so it is this angle.
        let angle = |b: usize| 2.0 * (out[b][2] / 2.0).atan();
        let ways: Vec<[f64; 2]> = self
            .links
            .iter()
            .map(|&(a, b)| {
                let part = |i: usize| self.places[b][i] - self.places[a][i];
                let (delta, turn) = ([part(0), part(1)], (angle(a) + angle(b)) / 2.0);
                let slope = (out[a][2] + out[b][2]) / 2.0;
                let seen = [
                    delta[0] + (out[b][0] - out[a][0]) + slope * delta[1],
                    delta[1] + (out[b][1] - out[a][1]) - slope * delta[0],
                ];
                let (s, c) = turn.sin_cos();
                [c * seen[0] - s * seen[1], s * seen[0] + c * seen[1]]
            })
            .collect();
        for axis in 0..2 {
            let mut x: Vec<f64> = (0..out.len())
                .map(|b| self.places[b][axis] + out[b][axis])
                .collect();
            for &(a, b, k, sign) in &self.order {
                x[b] = x[a] + sign * ways[k][axis];
            }
            self.relax(&mut x, |k| ways[k][axis]);
            for (b, slot) in out.iter_mut().enumerate() {
                if !self.given[b] {
                    slot[axis] = x[b] - self.places[b][axis];
                }
            }
        }
        out
    }

    /// Least squares of x_b − x_a − way over all links, by conjugate gradients from a guess.
    fn relax(&self, x: &mut [f64], way: impl Fn(usize) -> f64) {
        let n = x.len();
        let free = |b: usize| !self.given[b];
        // The residual of the normal equations: at each body the sum of what its links lack.
        let mut r: Vec<f64> = (0..n)
            .map(|b| {
                let lack = |&(o, k, sign): &(usize, usize, f64)| x[o] - x[b] - sign * way(k);
                if free(b) {
                    self.near[b].iter().map(lack).sum()
                } else {
                    0.0
                }
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(p, q)| p * q).sum::<f64>();
        let mut p = r.clone();
        let mut old = dot(&r, &r);
        let end = RESIDUAL * RESIDUAL * n as f64;
        for _ in 0..MOST {
            if old <= end || old.is_nan() {
                break;
            }
            let q: Vec<f64> = (0..n)
                .map(|b| {
                    let pull = |&(o, _, _): &(usize, usize, f64)| p[b] - p[o];
                    if free(b) {
                        self.near[b].iter().map(pull).sum()
                    } else {
                        0.0
                    }
                })
                .collect();
            let step = old / dot(&p, &q);
            for b in 0..n {
                x[b] += step * p[b];
                r[b] -= step * q[b];
            }
            let new = dot(&r, &r);
            for b in 0..n {
                p[b] = r[b] + new / old * p[b];
            }
            old = new;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec2;
    use crate::number::Rat;

    /// Bodies that all turn about one point as one stay as far from each other as they were, in a
    /// chain as in a mesh; straight ahead they would part.
    #[test]
    fn what_turns_as_one_stays_together() {
        let side = 4;
        let at = |k: usize| [(k % side) as f64, (k / side) as f64];
        let poses: Vec<Pose> = (0..side * side)
            .map(|k| Pose {
                place: Vec2::new(Rat::from_f64(at(k)[0]), Rat::from_f64(at(k)[1])),
                tan_half: Rat::zero(),
            })
            .collect();
        let mut forms = vec![Form::Free; side * side];
        forms[0] = Form::Pinned;
        let mesh: Vec<(usize, usize)> = (0..side * side)
            .flat_map(|k| {
                let right = (k % side + 1 < side).then_some((k, k + 1));
                let up = (k + side < side * side).then_some((k, k + side));
                right.into_iter().chain(up)
            })
            .collect();
        let chain: Vec<(usize, usize)> = (1..side * side).map(|k| (k - 1, k)).collect();
        let turn = 0.6;
        let direction: Vec<[f64; 3]> = (0..side * side)
            .map(|k| [-turn * at(k)[1], turn * at(k)[0], turn])
            .collect();
        for links in [mesh, chain] {
            let bend = Bend::new(&forms, &poses, links.iter().copied());
            let moved = bend.follow(&direction, 1.0);
            let there = |k: usize| [at(k)[0] + moved[k][0], at(k)[1] + moved[k][1]];
            for &(a, b) in &links {
                let (p, q) = (there(a), there(b));
                let way = (p[0] - q[0]).hypot(p[1] - q[1]);
                let was = (at(a)[0] - at(b)[0]).hypot(at(a)[1] - at(b)[1]);
                assert!((way - was).abs() < 1e-9, "{a} {b}: {way} {was}");
            }
        }
    }
}
