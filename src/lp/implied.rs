//! Prices that prove a bound, by what single rows say of the columns.
//!
//! A column without a lower bound must not have a positive reduced cost, one without an upper
//! bound no negative one. But a row may bound such a column all the same, once all the others in
//! it are bounded from the right side, and so on from row to row. Each bound found so remembers its
//! row and how many were found before it. Going back from the last to the first, a reduced cost
//! that leans on a bound found so is brought to zero by the price of that row; this changes other
//! columns' costs only to the sides on which the row leant, which were found before. So one pass
//! makes prices that prove a bound of any prices at all, exactly; the nearer those were to
//! the optimum's, the better the bound.

use super::budget::{Budget, Exhausted};
use super::model::Model;
use crate::number::{Int, Rat};
use std::collections::VecDeque;

/// Bits of a price's numerator and denominator beyond which it is given up.
const LONGEST: u64 = 20_000;
/// Bits that a price keeps where it may be rounded.
const SHORT: i64 = 60;

/// How a side of a column is known to be bounded.
#[derive(Clone, Copy, PartialEq)]
enum Known {
    No,
    /// By the model.
    Given,
    /// By this row.
    By(u32),
}

/// What single rows say of the columns.
pub(crate) struct Implied {
    /// For each column whether its lower and its upper side is bounded.
    sides: Vec<[Known; 2]>,
    /// Bounds found, in order: column and side.
    found: Vec<(u32, usize)>,
    rows: Vec<Vec<(u32, Rat)>>,
}

impl Implied {
    /// Finds all bounds that rows imply one by one.
    pub(crate) fn new(model: &Model) -> Implied {
        let known = |end: &Option<Rat>| match end {
            Some(_) => Known::Given,
            None => Known::No,
        };
        let mut rows = vec![Vec::new(); model.rows.len()];
        for (j, c) in model.columns.iter().enumerate() {
            for (i, a) in &c.entries {
                rows[*i as usize].push((j as u32, a.clone()));
            }
        }
        let mut out = Implied {
            sides: model
                .columns
                .iter()
                .map(|c| [known(&c.range.lower), known(&c.range.upper)])
                .collect(),
            found: Vec::new(),
            rows,
        };
        // How many terms of a row are not bounded from below, and from above: an upper bound of
        // the row leans on the former. A row is looked at again when the count falls.
        let mut missing: Vec<[usize; 2]> = out
            .rows
            .iter()
            .map(|row| {
                [0, 1].map(|end| {
                    let open = |e: &&(u32, Rat)| {
                        let side = if e.1.sign() > 0 { end } else { 1 - end };
                        out.sides[e.0 as usize][side] == Known::No
                    };
                    row.iter().filter(open).count()
                })
            })
            .collect();
        let mut queue: VecDeque<(u32, usize)> = VecDeque::new();
        for i in 0..out.rows.len() {
            queue.extend([0, 1].map(|end| (i as u32, end)));
        }
        while let Some((i, end)) = queue.pop_front() {
            let range = &model.rows[i as usize].range;
            let bound = if end == 0 { &range.upper } else { &range.lower };
            if bound.is_none() || missing[i as usize][end] > 1 {
                continue;
            }
            let alone = missing[i as usize][end] == 1;
            for k in 0..out.rows[i as usize].len() {
                let (j, sign) = (
                    out.rows[i as usize][k].0 as usize,
                    out.rows[i as usize][k].1.sign(),
                );
                // The side on which the row leans, and the one that it bounds.
                let leans = if sign > 0 { end } else { 1 - end };
                let bounds = 1 - leans;
                let others = !alone || out.sides[j][leans] == Known::No;
                if !others || out.sides[j][bounds] != Known::No {
                    continue;
                }
                out.sides[j][bounds] = Known::By(i);
                out.found.push((j as u32, bounds));
                for (r, a) in &model.columns[j].entries {
                    let end = if a.sign() > 0 { bounds } else { 1 - bounds };
                    let count = &mut missing[*r as usize][end];
                    *count -= 1;
                    if *count <= 1 {
                        queue.push_back((*r, end));
                    }
                }
            }
        }
        out
    }

    /// A column that no single row bounds from one of its sides.
    pub(crate) fn open(&self) -> Option<usize> {
        self.sides.iter().position(|s| s.contains(&Known::No))
    }

    /// Prices that prove a bound, from any prices; None where a column stays unbounded on the side
    /// that matters, or where they get too long.
    pub(crate) fn prices(
        &self,
        model: &Model,
        near: &[Rat],
        budget: &Budget,
    ) -> Result<Option<Vec<Rat>>, Exhausted> {
        let turn = if model.maximise { -1 } else { 1 };
        let mut y: Vec<Rat> = near.to_vec();
        y.resize(model.rows.len(), Rat::zero());
        for (v, r) in y.iter_mut().zip(&model.rows) {
            let leans = match v.sign() * turn {
                1 => &r.range.lower,
                -1 => &r.range.upper,
                _ => continue,
            };
            if leans.is_none() {
                *v = Rat::zero();
            }
        }
        let reduced = |c: &super::model::Column, y: &[Rat]| {
            let mut d = c.cost.clone();
            for (i, a) in &c.entries {
                let y = &y[*i as usize];
                if !y.is_zero() {
                    d = &d - &(a * y);
                }
            }
            d
        };
        for (count, &(j, side)) in self.found.iter().enumerate().rev() {
            if count % 64 == 0 {
                budget.check()?;
            }
            let c = &model.columns[j as usize];
            let d = reduced(c, &y);
            let wrong = if side == 0 { 1 } else { -1 };
            if d.sign() * turn != wrong {
                continue;
            }
            let Known::By(i) = self.sides[j as usize][side] else {
                return Ok(None);
            };
            let Some((_, a)) = c.entries.iter().find(|e| e.0 == i) else {
                return Ok(None);
            };
            // A little more than d/a where the column has its other bound from the model.
            let mut change = &d / a;
            if self.sides[j as usize][1 - side] == Known::Given {
                change = away(&change);
            }
            let price = &mut y[i as usize];
            *price = &*price + &change;
            if price.numer().bits() + price.denom().bits() > LONGEST {
                return Ok(None);
            }
        }
        let settled = model.columns.iter().zip(&self.sides).all(|(c, sides)| {
            match reduced(c, &y).sign() * turn {
                1 => sides[0] == Known::Given,
                -1 => sides[1] == Known::Given,
                _ => true,
            }
        });
        Ok(settled.then_some(y))
    }
}

/// A short number that is at least as far from zero, on the same side.
fn away(v: &Rat) -> Rat {
    if v.is_zero() || v.numer().bits() + v.denom().bits() <= 2 * SHORT as u64 {
        return v.clone();
    }
    let shift = SHORT - (v.numer().bits() as i64 - v.denom().bits() as i64);
    let scaled = v * &Rat::dyadic(Int::one(), shift);
    let whole = if v.sign() > 0 {
        scaled.ceil()
    } else {
        scaled.floor()
    };
    Rat::dyadic(whole, -shift)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lp::Range;

    /// x ≤ 3 by the model, y ≤ x, −z ≥ −y: maximise z + 2y − x with y, z ≥ 0 where nothing but the
    /// rows bounds y and z from above.
    #[test]
    fn bounds_pass_from_row_to_row() {
        let mut model = Model::new("three");
        model.maximise = true;
        let range = Range {
            lower: Some(Rat::zero()),
            upper: Some(Rat::from(3)),
        };
        let x = model.add_column("x", Rat::from(-1), range);
        let y = model.add_column("y", Rat::from(2), Range::at_least(Rat::zero()));
        let z = model.add_column("z", Rat::one(), Range::at_least(Rat::zero()));
        let r = model.add_row("r", Range::at_most(Rat::zero()));
        let s = model.add_row("s", Range::at_least(Rat::zero()));
        for (i, j, a) in [(r, y, 1), (r, x, -1), (s, y, 1), (s, z, -1)] {
            model.set(i, j, Rat::from(a));
        }
        let implied = Implied::new(&model);
        assert_eq!(implied.open(), None);
        assert_eq!(implied.found.len(), 2);
        let budget = Budget::new(None, None, None);
        let found = implied.prices(&model, &[], &budget);
        let found = found.expect("no limit").expect("prices");
        // The optimum 6 itself: 3·r − 1·s.
        assert_eq!(found, [Rat::from(3), Rat::from(-1)]);
        // Without x's bound there is none.
        model.columns[x].range.upper = None;
        let implied = Implied::new(&model);
        assert_eq!(implied.open(), Some(x));
        let found = implied.prices(&model, &[], &budget).expect("no limit");
        assert_eq!(found, None);
    }

    #[test]
    fn rounding_goes_away_from_zero() {
        for (n, d) in [(1, 3), (-7, 11), (5, 1)] {
            let v = Rat::frac(n, d).pow(9);
            let w = away(&v);
            assert!(w.sign() == v.sign() && w.abs() >= v.abs());
            assert!((&w - &v).abs() <= v.abs() * Rat::frac(1, 1 << 40));
        }
    }
}
