//! A step's end, put where the constraints that the program's optimum stands on truly hold.
//!
//! The optimum of a program is a vertex: as many rows as basic columns hold with equality, as far
//! as the first order knows. Where the step leads, their true distances are off by second-order
//! terms. Left for the next program to restore, these errors come back as motion, which errs
//! again, and bodies at the end of a long lever go up and down by turns. So the end is corrected:
//! Newton's method on the square system of those rows, from the end of the step, to the distances
//! that the program promised there. What a program then finds at the corrected end is what its
//! vertex lacks to be optimal, not what the last step has left behind.
//!
//! All in doubles: this proposes a configuration, and the exact test judges it.

use super::model::{Scaffold, Sketch};
use super::pairs::Pair;
use super::shape::{Pose, double, doubles};
use crate::lp::field::Double;
use crate::lp::lu::factorise;
use crate::lp::{Place, Places};

/// Most iterations.
const MOST: usize = 8;
/// An iteration that leaves more than this part of the error is the last.
const SHRINKS: f64 = 0.5;

/// Pivoting of the factors: least size relative to the row, and at all.
const THRESHOLD: f64 = 0.1;
const TINY: f64 = 1e-13;

/// The rows that a program's optimum stands on.
pub(crate) struct Tight {
    contacts: Vec<Sketch>,
    /// The unknown of each body's x, y, θ, where it is basic.
    unknowns: Vec<[Option<usize>; 3]>,
    /// Places and angles before the step.
    from: Vec<[f64; 3]>,
    /// Turns are measured by the length that the largest body sweeps.
    reach: f64,
    /// Index of each tight row in its program.
    pub(crate) rows: Vec<usize>,
}

impl Tight {
    /// The rows that are tight in a basis; None where the basis is not one of these pairs'.
    pub(crate) fn new(
        scaffold: &Scaffold,
        pairs: &[Pair],
        basis: &Places,
        poses: &[Pose],
        reach: f64,
    ) -> Option<Tight> {
        if basis.rows.len() != pairs.len() || basis.columns.len() != scaffold.column_count {
            return None;
        }
        let rows: Vec<usize> = (0..pairs.len())
            .filter(|&k| basis.rows[k] != Place::Basic)
            .collect();
        let mut count = 0;
        let mut unknowns = Vec::with_capacity(poses.len());
        for body in 0..poses.len() {
            unknowns.push(scaffold.column(body).map(|column| {
                let basic = column.is_some_and(|c| basis.columns[c] == Place::Basic);
                basic.then(|| {
                    count += 1;
                    count - 1
                })
            }));
        }
        let from = poses.iter().map(|p| {
            let [x, y] = doubles(&p.place);
            [x, y, 2.0 * double(&p.tan_half).atan()]
        });
        (count == rows.len() && count > 0).then(|| Tight {
            contacts: rows.iter().map(|&k| scaffold.sketch(&pairs[k])).collect(),
            unknowns,
            from: from.collect(),
            reach: if reach > 0.0 { reach } else { 1.0 },
            rows,
        })
    }

    /// Distances of the tight rows, and their derivatives by the unknowns, by columns; turns are
    /// measured by the length that the largest body sweeps.
    fn slopes(&self, at: &[[f64; 3]]) -> (Vec<f64>, Vec<Vec<(u32, f64)>>) {
        let mut columns: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.rows.len()];
        let mut gaps = Vec::with_capacity(self.rows.len());
        for (k, contact) in self.contacts.iter().enumerate() {
            let (gap, first, second) = contact.measure(at);
            gaps.push(gap);
            for (body, slope) in [(contact.one, first), (contact.two, second)] {
                for ((unknown, v), unit) in self.unknowns[body].iter().zip(slope).zip(self.units())
                {
                    if let Some(u) = unknown {
                        columns[*u].push((k as u32, v / unit));
                    }
                }
            }
        }
        (gaps, columns)
    }

    fn units(&self) -> [f64; 3] {
        [1.0, 1.0, self.reach]
    }

    /// Adds a solution to places and angles.
    fn add(&self, at: &mut [[f64; 3]], solution: &[f64]) {
        for (slot, unknowns) in at.iter_mut().zip(&self.unknowns) {
            for ((v, unknown), unit) in slot.iter_mut().zip(unknowns).zip(self.units()) {
                if let Some(u) = unknown {
                    *v += solution[*u] / unit;
                }
            }
        }
    }

    /// By how much each tight row ends up farther open than its derivatives say.
    pub(crate) fn curvature(&self, moved: &[[f64; 3]]) -> Vec<f64> {
        let at = self.after(moved);
        let each = self.contacts.iter().map(|contact| {
            let (before, first, second) = contact.measure(&self.from);
            let (after, _, _) = contact.measure(&at);
            let along = |body: usize, slope: [f64; 3]| -> f64 {
                let (to, from) = (at[body], self.from[body]);
                (0..3).map(|k| slope[k] * (to[k] - from[k])).sum()
            };
            after - before - along(contact.one, first) - along(contact.two, second)
        });
        each.collect()
    }

    /// Places and angles after displacements and turns.
    fn after(&self, moved: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let add = |(f, m): (&[f64; 3], &[f64; 3])| {
            [f[0] + m[0], f[1] + m[1], f[2] + 2.0 * (m[2] / 2.0).atan()]
        };
        self.from.iter().zip(moved).map(add).collect()
    }

    /// Corrects displacements and turns (made by half their tangents) so that the tight rows are
    /// at the given distances, in the order of [`Tight::rows`]. None where that does not work out.
    pub(crate) fn settle(
        &self,
        moved: &[[f64; 3]],
        targets: &[f64],
        close: f64,
    ) -> Option<Vec<[f64; 3]>> {
        let mut at = self.after(moved);
        let mut best: Option<Vec<[f64; 3]>> = None;
        let mut last = f64::INFINITY;
        let mut work = Vec::new();
        for _ in 0..MOST {
            let (gaps, columns) = self.slopes(&at);
            let each = targets.iter().zip(&gaps);
            let mut lack: Vec<f64> = each.map(|(target, gap)| target - gap).collect();
            let worst = lack.iter().fold(0.0f64, |w, v| w.max(v.abs()));
            if worst.is_nan() || worst > SHRINKS * last {
                break;
            }
            best = Some(at.clone());
            last = worst;
            if worst <= close {
                break;
            }
            let lu = factorise(&Double, &columns, THRESHOLD, TINY).ok()?;
            lu.solve(&mut lack, &mut work);
            self.add(&mut at, &lack);
        }
        let best = best?;
        let back = |(to, (from, m)): (&[f64; 3], (&[f64; 3], &[f64; 3]))| {
            let part = |k: usize| {
                // What was not touched stays what it was, to the last bit.
                let plain = from[k]
                    + if k == 2 {
                        2.0 * (m[2] / 2.0).atan()
                    } else {
                        m[k]
                    };
                if to[k] == plain {
                    return m[k];
                }
                let by = to[k] - from[k];
                if k == 2 { 2.0 * (by / 2.0).tan() } else { by }
            };
            [part(0), part(1), part(2)]
        };
        let out: Vec<[f64; 3]> = best
            .iter()
            .zip(self.from.iter().zip(moved))
            .map(back)
            .collect();
        out.iter().flatten().all(|v| v.is_finite()).then_some(out)
    }
}

#[cfg(test)]
mod tests {
    use crate::flex::FlexOptions;
    use crate::flex::branch;
    use crate::flex::generate::generate;
    use crate::flex::step::Run;
    use crate::number::Rat;

    /// After a whole step the rows that its program stands on are off; settled, they are not.
    #[test]
    fn the_rows_of_a_vertex_hold_at_the_end_of_its_step() {
        let structure = generate("grid", 12, 1).expect("a structure");
        let options = FlexOptions::default();
        let run = Run::new(&structure, &options);
        let poses = run.scaffold.start.clone();
        let placed = run.scaffold.place(&poses);
        let selection = run.selection(&placed, false);
        let (pairs, rows) = run.rows(&selection, &placed);
        let solved = branch::solve(&run, &rows, &selection, &placed, &poses);
        let direction = solved.direction.clone().expect("an optimum");
        let tight = run.tight(&pairs, &poses, &solved).expect("a basis");
        let off = |moved: &[[f64; 3]]| {
            let there = run.grain().moved(&poses, &run.scaffold.forms, moved, 1.0);
            let placed = run.scaffold.place(&there);
            let each = tight.rows.iter();
            each.map(|&k| run.scaffold.near(&pairs[k], &placed).0.abs())
                .fold(0.0, f64::max)
        };
        let targets = vec![0.0; tight.rows.len()];
        let close = 1e-12;
        let there = tight.settle(&direction, &targets, close);
        let there = there.expect("an end");
        assert!(off(&direction) > 1e-4, "{}", off(&direction));
        assert!(off(&there) < 1e-9, "{}", off(&there));
        // No motion, no correction, to the last bit.
        let still = vec![[0.0; 3]; poses.len()];
        let gaps: Vec<f64> = tight
            .rows
            .iter()
            .map(|&k| run.scaffold.near(&pairs[k], &run.scaffold.place(&poses)).0)
            .collect();
        let kept = tight.settle(&still, &gaps, 1e-9);
        assert_eq!(kept, Some(still));
        assert!(run.scaffold.displacement(&run.scaffold.start) == Rat::zero());
    }
}
