//! Prices that prove a bound, made from prices that do not.
//!
//! A column without a lower bound must not have a positive reduced cost, one without an upper
//! bound none below zero (where minimising). Starting anywhere, a price is changed so that one
//! such column comes right, by the row where that does least harm to the others, as long as the
//! sum of what is wrong falls. It is all done in doubles, with a margin on every one-sided column
//! that rounding cannot use up; whether the outcome proves anything is decided exactly elsewhere.
//! Free columns have no margin, so programs that have any are seldom helped.

use super::model::{Model, Range};

/// Margin of reduced costs, relative to the sizes that they are made of.
const MARGIN: f64 = 1e-11;
/// Share of what was wrong that a change must put right to be made.
const GAIN: f64 = 1e-3;
/// Changes allowed, a row and column.
const CHANGES: usize = 8;

/// The program in doubles, to be minimised.
struct Doubles {
    columns: Vec<Vec<(usize, f64)>>,
    rows: Vec<Vec<(usize, f64)>>,
    cost: Vec<f64>,
    /// Whether a column has a lower and an upper bound, and likewise a row.
    column_ends: Vec<(bool, bool)>,
    row_ends: Vec<(bool, bool)>,
}

fn ends(range: &Range) -> (bool, bool) {
    (range.lower.is_some(), range.upper.is_some())
}

impl Doubles {
    fn new(model: &Model) -> Doubles {
        let turn = if model.maximise { -1.0 } else { 1.0 };
        let double = |v: &crate::number::Rat| v.nearest_f64().unwrap_or(f64::NAN);
        let mut rows = vec![Vec::new(); model.rows.len()];
        let mut columns = Vec::with_capacity(model.columns.len());
        for (j, c) in model.columns.iter().enumerate() {
            let column = c.entries.iter().map(|(i, a)| (*i as usize, double(a)));
            let column: Vec<(usize, f64)> = column.collect();
            for &(i, a) in &column {
                rows[i].push((j, a));
            }
            columns.push(column);
        }
        Doubles {
            rows,
            cost: model
                .columns
                .iter()
                .map(|c| turn * double(&c.cost))
                .collect(),
            column_ends: model.columns.iter().map(|c| ends(&c.range)).collect(),
            row_ends: model.rows.iter().map(|r| ends(&r.range)).collect(),
            columns,
        }
    }

    /// How far a reduced cost is from where it may be: what to add.
    fn wanted(&self, j: usize, d: f64, margin: f64) -> f64 {
        match self.column_ends[j] {
            (true, false) if d < margin => margin - d,
            (false, true) if d > -margin => -margin - d,
            (false, false) => -d,
            _ => 0.0,
        }
    }

    /// Whether a row's price may have this sign.
    fn allowed(&self, i: usize, price: f64) -> bool {
        price == 0.0 || price > 0.0 && self.row_ends[i].0 || price < 0.0 && self.row_ends[i].1
    }
}

/// Prices near the given ones that seem to prove a bound, or None.
pub(crate) fn prices(model: &Model, near: &[f64]) -> Option<Vec<f64>> {
    let p = Doubles::new(model);
    let (n, m) = (p.columns.len(), p.rows.len());
    let turn = if model.maximise { -1.0 } else { 1.0 };
    let mut y: Vec<f64> = match near.len() == m && near.iter().all(|v| v.is_finite()) {
        true => near.iter().map(|v| turn * v).collect(),
        false => vec![0.0; m],
    };
    for (i, y) in y.iter_mut().enumerate() {
        if !p.allowed(i, *y) {
            *y = 0.0;
        }
    }
    let (mut d, mut margin) = (p.cost.clone(), vec![0.0; n]);
    for j in 0..n {
        let mut size = p.cost[j].abs();
        for &(i, a) in &p.columns[j] {
            d[j] -= a * y[i];
            size += (a * y[i]).abs();
        }
        if !d[j].is_finite() {
            return None;
        }
        margin[j] = MARGIN * (size + f64::MIN_POSITIVE);
    }
    let mut queue: Vec<usize> = (0..n)
        .filter(|&j| p.wanted(j, d[j], margin[j]) != 0.0)
        .collect();
    let mut left = CHANGES * (n + m);
    while let Some(j) = queue.pop() {
        let wanted = p.wanted(j, d[j], margin[j]);
        if wanted == 0.0 {
            continue;
        }
        left = left.checked_sub(1)?;
        // A little more than wanted, or the others' harm comes back for ever.
        let aim = if p.column_ends[j] == (false, false) {
            wanted
        } else {
            1.5 * wanted
        };
        let mut best: Option<(f64, usize, f64)> = None;
        for &(i, a) in &p.columns[j] {
            let step = -aim / a;
            if a == 0.0 || !p.allowed(i, y[i] + step) {
                continue;
            }
            let mut wrong = 0.0;
            for &(k, b) in &p.rows[i] {
                let before = p.wanted(k, d[k], margin[k]).abs();
                wrong += p.wanted(k, d[k] - b * step, margin[k]).abs() - before;
            }
            if best.is_none_or(|b| wrong < b.0) {
                best = Some((wrong, i, step));
            }
        }
        let (wrong, i, step) = best?;
        if wrong > -GAIN * wanted.abs() {
            return None;
        }
        y[i] += step;
        for &(k, b) in &p.rows[i] {
            d[k] -= b * step;
            margin[k] = margin[k].max(MARGIN * (b * y[i]).abs());
            if k != j && p.wanted(k, d[k], margin[k]) != 0.0 {
                queue.push(k);
            }
        }
        if p.wanted(j, d[j], margin[j]) != 0.0 {
            queue.push(j);
        }
    }
    Some(y.iter().map(|v| turn * v).collect())
}
