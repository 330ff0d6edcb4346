//! Sparse elimination of a square matrix over either [`Field`].
//!
//! Rows hold values, columns only their pattern; the pivot is sought by Markowitz's count among
//! a few of the shortest rows and columns, with a threshold where the field has sizes. Singleton
//! rows and columns are found first by the same search, so that triangular parts cost nothing.
//! The result is P·A·Q = L·U, numbered by elimination step, with both factors kept by rows and by
//! columns: doubles solve column by column and skip zeros, residues solve row by row and reduce
//! once a row.

use super::field::{Field, Prime, TERMS};

/// Compressed rows of (index, value).
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines<E> {
    /// Where each line starts; one more than there are lines.
    start: Vec<u32>,
    index: Vec<u32>,
    value: Vec<E>,
}

impl<E: Copy + Default> Lines<E> {
    fn new() -> Lines<E> {
        Lines {
            start: vec![0],
            index: Vec::new(),
            value: Vec::new(),
        }
    }

    fn push(&mut self, entries: impl Iterator<Item = (u32, E)>) {
        for (i, v) in entries {
            self.index.push(i);
            self.value.push(v);
        }
        self.start.push(self.index.len() as u32);
    }

    pub(crate) fn line(&self, k: usize) -> impl DoubleEndedIterator<Item = (usize, E)> + '_ {
        let span = self.start[k] as usize..self.start[k + 1] as usize;
        self.index[span.clone()]
            .iter()
            .map(|&i| i as usize)
            .zip(self.value[span].iter().copied())
    }

    fn transposed(&self) -> Lines<E> {
        let n = self.start.len() - 1;
        let mut start = vec![0u32; n + 1];
        for &i in &self.index {
            start[i as usize + 1] += 1;
        }
        for k in 0..n {
            start[k + 1] += start[k];
        }
        let mut at = start.clone();
        let mut index = vec![0u32; self.index.len()];
        let mut value = vec![E::default(); self.index.len()];
        for k in 0..n {
            for (i, v) in self.line(k) {
                index[at[i] as usize] = k as u32;
                value[at[i] as usize] = v;
                at[i] += 1;
            }
        }
        Lines {
            start,
            index,
            value,
        }
    }
}

/// The factors of a non-singular matrix.
#[derive(Clone, Debug)]
pub(crate) struct Lu<E> {
    /// Row and column of the matrix that each step eliminated.
    pub(crate) row_of: Vec<u32>,
    pub(crate) column_of: Vec<u32>,
    lower_columns: Lines<E>,
    lower_rows: Lines<E>,
    upper_rows: Lines<E>,
    upper_columns: Lines<E>,
    diagonal: Vec<E>,
}

/// Rows and columns left without a pivot: the matrix is singular (or, in doubles, seems so).
#[derive(Clone, Debug)]
pub(crate) struct Singular {
    pub(crate) rows: Vec<u32>,
    pub(crate) columns: Vec<u32>,
}

/// Doubly linked lists of lines by their count.
struct Buckets {
    head: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
    count: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Buckets {
    fn new(counts: impl Iterator<Item = usize>, n: usize) -> Buckets {
        let mut out = Buckets {
            head: vec![NONE; n + 1],
            next: vec![NONE; n],
            previous: vec![NONE; n],
            count: vec![NONE; n],
        };
        for (i, c) in counts.enumerate() {
            out.insert(i, c);
        }
        out
    }

    fn insert(&mut self, i: usize, count: usize) {
        let head = self.head[count];
        self.next[i] = head;
        self.previous[i] = NONE;
        if head != NONE {
            self.previous[head as usize] = i as u32;
        }
        self.head[count] = i as u32;
        self.count[i] = count as u32;
    }

    fn remove(&mut self, i: usize) {
        if self.count[i] == NONE {
            return;
        }
        let (n, p) = (self.next[i], self.previous[i]);
        if p == NONE {
            self.head[self.count[i] as usize] = n;
        } else {
            self.next[p as usize] = n;
        }
        if n != NONE {
            self.previous[n as usize] = p;
        }
        self.count[i] = NONE;
    }

    fn update(&mut self, i: usize, count: usize) {
        if self.count[i] != count as u32 {
            self.remove(i);
            self.insert(i, count);
        }
    }
}

/// Factorises the matrix whose `n` columns are given; `threshold` is the least size of a pivot
/// relative to its row (only doubles mind), `tiny` the least absolute size.
pub(crate) fn factorise<F: Field>(
    field: &F,
    columns: &[Vec<(u32, F::E)>],
    threshold: f64,
    tiny: f64,
) -> Result<Lu<F::E>, Singular> {
    let n = columns.len();
    let mut rows: Vec<Vec<(u32, F::E)>> = vec![Vec::new(); n];
    let mut pattern: Vec<Vec<u32>> = vec![Vec::new(); n];
    for (j, column) in columns.iter().enumerate() {
        for &(i, v) in column {
            if !field.is_zero(v) {
                rows[i as usize].push((j as u32, v));
                pattern[j].push(i);
            }
        }
    }
    let mut row_buckets = Buckets::new(rows.iter().map(Vec::len), n);
    let mut column_buckets = Buckets::new(pattern.iter().map(Vec::len), n);
    let mut row_step = vec![NONE; n];
    let mut column_step = vec![NONE; n];
    let mut row_of = Vec::with_capacity(n);
    let mut column_of = Vec::with_capacity(n);
    let mut lower: Vec<Vec<(u32, F::E)>> = Vec::with_capacity(n);
    let mut upper: Vec<Vec<(u32, F::E)>> = Vec::with_capacity(n);
    let mut diagonal = Vec::with_capacity(n);
    let mut place = vec![NONE; n]; // where a column stands in the pivot row
    for step in 0..n {
        let Some((r, c)) = find_pivot(
            field,
            &rows,
            &pattern,
            &row_buckets,
            &column_buckets,
            threshold,
            tiny,
        ) else {
            let open = |steps: &[u32]| {
                (0..n as u32)
                    .filter(|&i| steps[i as usize] == NONE)
                    .collect()
            };
            return Err(Singular {
                rows: open(&row_step),
                columns: open(&column_step),
            });
        };
        row_step[r] = step as u32;
        column_step[c] = step as u32;
        row_of.push(r as u32);
        column_of.push(c as u32);
        row_buckets.remove(r);
        column_buckets.remove(c);
        let mut pivot_row = std::mem::take(&mut rows[r]);
        let at = pivot_row.iter().position(|e| e.0 == c as u32).unwrap_or(0);
        let pivot = pivot_row.swap_remove(at).1;
        let column = std::mem::take(&mut pattern[c]);
        for &(j, _) in &pivot_row {
            let list = &mut pattern[j as usize];
            if let Some(k) = list.iter().position(|&i| i == r as u32) {
                list.swap_remove(k);
            }
        }
        let mut multipliers = Vec::with_capacity(column.len().saturating_sub(1));
        if column.len() > 1 {
            let inverse = field.reciprocal(pivot);
            for (k, &(j, _)) in pivot_row.iter().enumerate() {
                place[j as usize] = k as u32;
            }
            let mut hit = vec![false; pivot_row.len()];
            for &i in column.iter().filter(|&&i| i != r as u32) {
                let row = &mut rows[i as usize];
                let Some(k) = row.iter().position(|e| e.0 == c as u32) else {
                    continue;
                };
                let m = field.times(row.swap_remove(k).1, inverse);
                multipliers.push((i, m));
                hit.iter_mut().for_each(|h| *h = false);
                let mut k = 0;
                while k < row.len() {
                    let (j, v) = row[k];
                    let q = place[j as usize];
                    if q != NONE {
                        hit[q as usize] = true;
                        let v = field.sub_mul(v, m, pivot_row[q as usize].1);
                        if field.is_zero(v) {
                            row.swap_remove(k);
                            let list = &mut pattern[j as usize];
                            if let Some(at) = list.iter().position(|&x| x == i) {
                                list.swap_remove(at);
                            }
                            continue;
                        }
                        row[k].1 = v;
                    }
                    k += 1;
                }
                for (q, &(j, v)) in pivot_row.iter().enumerate() {
                    if !hit[q] {
                        let v = field.sub_mul(F::E::default(), m, v);
                        if !field.is_zero(v) {
                            row.push((j, v));
                            pattern[j as usize].push(i);
                        }
                    }
                }
                row_buckets.update(i as usize, rows[i as usize].len());
            }
            for &(j, _) in &pivot_row {
                place[j as usize] = NONE;
            }
        }
        for &(j, _) in &pivot_row {
            column_buckets.update(j as usize, pattern[j as usize].len());
        }
        lower.push(multipliers);
        upper.push(pivot_row);
        diagonal.push(pivot);
    }
    let mut lower_columns = Lines::new();
    let mut upper_rows = Lines::new();
    for (l, u) in lower.into_iter().zip(upper) {
        lower_columns.push(l.into_iter().map(|(i, v)| (row_step[i as usize], v)));
        upper_rows.push(u.into_iter().map(|(j, v)| (column_step[j as usize], v)));
    }
    Ok(Lu {
        row_of,
        column_of,
        lower_rows: lower_columns.transposed(),
        upper_columns: upper_rows.transposed(),
        lower_columns,
        upper_rows,
        diagonal,
    })
}

/// The acceptable pivot of least Markowitz count among a few short lines.
fn find_pivot<F: Field>(
    field: &F,
    rows: &[Vec<(u32, F::E)>],
    pattern: &[Vec<u32>],
    row_buckets: &Buckets,
    column_buckets: &Buckets,
    threshold: f64,
    tiny: f64,
) -> Option<(usize, usize)> {
    let n = rows.len();
    let mut best: Option<(usize, usize)> = None;
    let mut cost = usize::MAX;
    let mut looked = 0;
    let acceptable = |i: usize, v: F::E| {
        let size = field.size(v);
        let largest = rows[i].iter().fold(0.0f64, |m, e| m.max(field.size(e.1)));
        size > tiny && size >= threshold * largest
    };
    for count in 1..=n {
        if cost <= (count - 1) * (count - 1) {
            return best;
        }
        let mut j = column_buckets.head[count];
        while j != NONE {
            let column = j as usize;
            for &i in &pattern[column] {
                let row = &rows[i as usize];
                let this = (row.len() - 1) * (count - 1);
                if this < cost {
                    let v = row
                        .iter()
                        .find(|e| e.0 == j)
                        .map_or(F::E::default(), |e| e.1);
                    if acceptable(i as usize, v) {
                        best = Some((i as usize, column));
                        cost = this;
                    }
                }
            }
            if cost == 0 {
                return best;
            }
            looked += 1;
            if looked >= 4 && best.is_some() {
                return best;
            }
            j = column_buckets.next[column];
        }
        let mut i = row_buckets.head[count];
        while i != NONE {
            let row = &rows[i as usize];
            let largest = row.iter().fold(0.0f64, |m, e| m.max(field.size(e.1)));
            for &(j, v) in row {
                let this = (pattern[j as usize].len() - 1) * (count - 1);
                let size = field.size(v);
                if this < cost && size > tiny && size >= threshold * largest {
                    best = Some((i as usize, j as usize));
                    cost = this;
                }
            }
            if cost == 0 {
                return best;
            }
            looked += 1;
            if looked >= 4 && best.is_some() {
                return best;
            }
            i = row_buckets.next[i as usize];
        }
    }
    best
}

impl Lu<f64> {
    /// log₂ of the determinant's size.
    pub(crate) fn log2_determinant(&self) -> f64 {
        self.diagonal.iter().map(|d| d.abs().log2()).sum()
    }

    /// Solves A·x = b in place: `b` by rows becomes x by columns. `work` is scratch.
    pub(crate) fn solve(&self, b: &mut [f64], work: &mut Vec<f64>) {
        let n = self.diagonal.len();
        work.clear();
        work.extend(self.row_of.iter().map(|&r| b[r as usize]));
        for k in 0..n {
            let t = work[k];
            if t != 0.0 {
                for (i, m) in self.lower_columns.line(k) {
                    work[i] -= m * t;
                }
            }
        }
        for k in (0..n).rev() {
            let t = work[k];
            if t != 0.0 {
                let t = t / self.diagonal[k];
                work[k] = t;
                for (i, u) in self.upper_columns.line(k) {
                    work[i] -= u * t;
                }
            }
        }
        for k in 0..n {
            b[self.column_of[k] as usize] = work[k];
        }
    }

    /// Solves Aᵀ·y = d in place: `d` by columns becomes y by rows.
    pub(crate) fn solve_transposed(&self, d: &mut [f64], work: &mut Vec<f64>) {
        let n = self.diagonal.len();
        work.clear();
        work.extend(self.column_of.iter().map(|&c| d[c as usize]));
        for k in 0..n {
            let t = work[k];
            if t != 0.0 {
                let t = t / self.diagonal[k];
                work[k] = t;
                for (j, u) in self.upper_rows.line(k) {
                    work[j] -= u * t;
                }
            }
        }
        for k in (0..n).rev() {
            let t = work[k];
            if t != 0.0 {
                for (i, m) in self.lower_rows.line(k) {
                    work[i] -= m * t;
                }
            }
        }
        for k in 0..n {
            d[self.row_of[k] as usize] = work[k];
        }
    }
}

impl Lu<u64> {
    /// Inverts the diagonal, which the two solves below expect. To be called once.
    pub(crate) fn prepare(&mut self, field: &Prime) {
        for d in &mut self.diagonal {
            *d = field.invert(*d);
        }
    }

    /// Solves A·x = b modulo p, plain residues in and out.
    pub(crate) fn solve_mod(&self, field: &Prime, b: &[u64], x: &mut [u64], work: &mut Vec<u64>) {
        let n = self.diagonal.len();
        work.clear();
        for k in 0..n {
            let t = b[self.row_of[k] as usize];
            let s = dot(field, &self.lower_rows, k, work);
            work.push(field.sub(t, s));
        }
        for k in (0..n).rev() {
            let s = dot(field, &self.upper_rows, k, work);
            work[k] = field.mul(self.diagonal[k], field.sub(work[k], s));
        }
        for k in 0..n {
            x[self.column_of[k] as usize] = work[k];
        }
    }

    /// Solves Aᵀ·y = d modulo p, plain residues in and out.
    pub(crate) fn solve_transposed_mod(
        &self,
        field: &Prime,
        d: &[u64],
        y: &mut [u64],
        work: &mut Vec<u64>,
    ) {
        let n = self.diagonal.len();
        work.clear();
        for k in 0..n {
            let t = d[self.column_of[k] as usize];
            let s = dot(field, &self.upper_columns, k, work);
            work.push(field.mul(self.diagonal[k], field.sub(t, s)));
        }
        for k in (0..n).rev() {
            let s = dot(field, &self.lower_columns, k, work);
            work[k] = field.sub(work[k], s);
        }
        for k in 0..n {
            y[self.row_of[k] as usize] = work[k];
        }
    }
}

/// One line of a factor (Montgomery) times the vector (plain), reduced once every [`TERMS`].
fn dot(field: &Prime, lines: &Lines<u64>, k: usize, x: &[u64]) -> u64 {
    let span = lines.start[k] as usize..lines.start[k + 1] as usize;
    if span.is_empty() {
        return 0;
    }
    if span.len() <= TERMS {
        let mut sum = 0u128;
        for (&i, &v) in lines.index[span.clone()].iter().zip(&lines.value[span]) {
            sum += u128::from(v) * u128::from(x[i as usize]);
        }
        return field.reduce(sum);
    }
    let mut out = 0;
    let (mut sum, mut terms) = (0u128, 0);
    for (i, v) in lines.line(k) {
        sum += u128::from(v) * u128::from(x[i]);
        terms += 1;
        if terms == TERMS {
            out = (out + field.reduce(sum)) % field.p;
            (sum, terms) = (0, 0);
        }
    }
    (out + field.reduce(sum)) % field.p
}
