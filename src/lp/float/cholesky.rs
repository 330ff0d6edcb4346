//! Factors of sparse symmetric positive definite matrices, for the normal equations.
//!
//! The order of elimination comes from the approximate minimum degree method (crate `amd`). The
//! pattern is analysed once; afterwards each set of numbers costs only its arithmetic. Row k of
//! the factor is the solution of a triangular system with the rows before it ("up-looking"). A
//! pivot that has all but vanished is made so large that its unknown becomes zero, which is what
//! interior-point methods want of it.

/// A pivot below this share of the diagonal entry that it began as is no number any more.
const VANISHED: f64 = 1e-15;
/// What a vanished pivot becomes.
const HUGE: f64 = 1e64;

/// A pattern with its order, the factor's pattern, and the factor itself.
pub(crate) struct Cholesky {
    n: usize,
    /// Position of each unknown in the order, and its reverse.
    place: Vec<u32>,
    order: Vec<u32>,
    /// Upper triangle of the permuted matrix by columns, the diagonal last.
    start: Vec<usize>,
    index: Vec<u32>,
    /// Numbers of the matrix in that pattern; to be filled before [`Cholesky::factorise`].
    pub(crate) value: Vec<f64>,
    /// Columns that row k of the factor has, in an order in which they can be eliminated.
    reach_start: Vec<usize>,
    reach: Vec<u32>,
    /// The factor by columns, the diagonal first.
    column_start: Vec<usize>,
    column_index: Vec<u32>,
    factor: Vec<f64>,
    work: Vec<f64>,
}

impl Cholesky {
    /// Analyses the pattern in which the unknowns of each clique meet each other; the diagonal is
    /// always there. None where the factor would have more than `most` entries.
    pub(crate) fn new<'a>(
        n: usize,
        cliques: impl Iterator<Item = &'a [u32]> + Clone,
        most: usize,
    ) -> Option<Cholesky> {
        let mut rows: Vec<Vec<u32>> = (0..n as u32).map(|j| vec![j]).collect();
        for clique in cliques {
            for (k, &a) in clique.iter().enumerate() {
                for &b in &clique[k + 1..] {
                    rows[a.max(b) as usize].push(a.min(b));
                }
            }
            // Keeps what is doubled within bounds.
            for &a in clique {
                let row = &mut rows[a as usize];
                if row.len() > 64 && row.len().is_power_of_two() {
                    row.sort_unstable();
                    row.dedup();
                }
            }
        }
        let (mut start, mut index) = (vec![0isize], Vec::new());
        for row in &mut rows {
            row.sort_unstable();
            row.dedup();
            index.extend(row.iter().map(|&i| i as isize));
            start.push(index.len() as isize);
        }
        let (order, place, _) =
            amd::order(n as isize, &start, &index, &amd::Control::default()).ok()?;
        let order: Vec<u32> = order.iter().map(|&j| j as u32).collect();
        let place: Vec<u32> = place.iter().map(|&j| j as u32).collect();
        let mut upper: Vec<Vec<u32>> = vec![Vec::new(); n];
        for (j, row) in rows.iter().enumerate() {
            for &i in row {
                let (a, b) = (place[i as usize], place[j]);
                upper[a.max(b) as usize].push(a.min(b));
            }
        }
        let mut out = Cholesky {
            n,
            place,
            order,
            start: vec![0],
            index: Vec::new(),
            value: Vec::new(),
            reach_start: vec![0],
            reach: Vec::new(),
            column_start: Vec::new(),
            column_index: Vec::new(),
            factor: Vec::new(),
            work: vec![0.0; n],
        };
        for column in &mut upper {
            column.sort_unstable();
            out.index.extend_from_slice(column);
            out.start.push(out.index.len());
        }
        out.value = vec![0.0; out.index.len()];
        out.analyse(most)?;
        Some(out)
    }

    /// The elimination tree, and from it the factor's pattern.
    fn analyse(&mut self, most: usize) -> Option<()> {
        const NONE: u32 = u32::MAX;
        let n = self.n;
        let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
        for k in 0..n {
            for &i in &self.index[self.start[k]..self.start[k + 1]] {
                let mut i = i as usize;
                while i < k {
                    let next = ancestor[i];
                    ancestor[i] = k as u32;
                    if next == NONE {
                        parent[i] = k as u32;
                        break;
                    }
                    i = next as usize;
                }
            }
        }
        let mut mark = vec![NONE; n];
        let mut count = vec![1usize; n];
        let mut path = Vec::new();
        for k in 0..n {
            mark[k] = k as u32;
            let first = self.reach.len();
            for &i in &self.index[self.start[k]..self.start[k + 1]] {
                let mut i = i as usize;
                path.clear();
                while mark[i] != k as u32 {
                    mark[i] = k as u32;
                    path.push(i as u32);
                    i = parent[i] as usize;
                }
                self.reach.extend_from_slice(&path);
            }
            // A column comes before its ancestors, and those have higher numbers.
            self.reach[first..].sort_unstable();
            for &i in &self.reach[first..] {
                count[i as usize] += 1;
            }
            self.reach_start.push(self.reach.len());
            if self.reach.len() > most {
                return None;
            }
        }
        let mut at = 0;
        for c in &count {
            self.column_start.push(at);
            at += c;
        }
        self.column_start.push(at);
        self.column_index = vec![0; at];
        self.factor = vec![0.0; at];
        let mut next = self.column_start.clone();
        for k in 0..n {
            for &i in &self.reach[self.reach_start[k]..self.reach_start[k + 1]] {
                self.column_index[next[i as usize]] = k as u32;
                next[i as usize] += 1;
            }
            self.column_index[next[k]] = k as u32;
            next[k] += 1;
        }
        Some(())
    }

    /// The order of elimination.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Memory taken.
    pub(crate) fn bytes(&self) -> u64 {
        (16 * self.reach.len() + 12 * self.index.len()) as u64
    }

    /// Where the entry of two unknowns that meet lies in `value`.
    pub(crate) fn position(&self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.place[a as usize], self.place[b as usize]);
        let (low, high) = (a.min(b), a.max(b) as usize);
        let column = &self.index[self.start[high]..self.start[high + 1]];
        (self.start[high] + column.partition_point(|&i| i < low)) as u32
    }

    /// Factorises what `value` holds. Says whether all pivots were sound.
    pub(crate) fn factorise(&mut self) -> bool {
        let mut sound = true;
        let mut next = self.column_start.clone();
        for k in 0..self.n {
            let span = self.start[k]..self.start[k + 1];
            for (&i, &v) in self.index[span.clone()].iter().zip(&self.value[span]) {
                self.work[i as usize] = v;
            }
            let diagonal = self.work[k];
            let mut pivot = diagonal;
            self.work[k] = 0.0;
            for &i in &self.reach[self.reach_start[k]..self.reach_start[k + 1]] {
                let i = i as usize;
                let first = self.column_start[i];
                let v = self.work[i] / self.factor[first];
                self.work[i] = 0.0;
                let (indices, values) = (&self.column_index, &self.factor);
                for (r, l) in indices[first + 1..next[i]]
                    .iter()
                    .zip(&values[first + 1..next[i]])
                {
                    self.work[*r as usize] -= l * v;
                }
                pivot -= v * v;
                self.factor[next[i]] = v;
                next[i] += 1;
            }
            if pivot.is_nan() || pivot <= VANISHED * diagonal {
                sound = false;
                pivot = HUGE * HUGE;
            }
            self.factor[next[k]] = pivot.sqrt();
            next[k] += 1;
        }
        sound
    }

    /// Solves for a right-hand side, in place.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        let mut x: Vec<f64> = self.order.iter().map(|&j| b[j as usize]).collect();
        for k in 0..self.n {
            let (first, last) = (self.column_start[k], self.column_start[k + 1]);
            let v = x[k] / self.factor[first];
            x[k] = v;
            for e in first + 1..last {
                x[self.column_index[e] as usize] -= self.factor[e] * v;
            }
        }
        for k in (0..self.n).rev() {
            let (first, last) = (self.column_start[k], self.column_start[k + 1]);
            let mut v = x[k];
            for e in first + 1..last {
                v -= self.factor[e] * x[self.column_index[e] as usize];
            }
            x[k] = v / self.factor[first];
        }
        for (k, &j) in self.order.iter().enumerate() {
            b[j as usize] = x[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Cholesky;

    /// A ring of springs with a chord, held at every node: the solution is checked against the
    /// matrix; a matrix that is singular in one unknown leaves that one at zero.
    #[test]
    fn solves_what_it_factorised() {
        let n = 9;
        let mut cliques: Vec<Vec<u32>> = (0..n as u32).map(|j| vec![j, (j + 1) % 9]).collect();
        cliques.push(vec![0, 4]);
        let springs = || cliques.iter().map(Vec::as_slice);
        let mut c = Cholesky::new(n, springs(), 1000).expect("a small pattern");
        assert!(Cholesky::new(n, springs(), 3).is_none());
        for held in [0.5, 0.0] {
            c.value.fill(0.0);
            for (k, s) in cliques.iter().enumerate() {
                let w = 1.0 + k as f64;
                for (a, b, v) in [(s[0], s[0], w), (s[1], s[1], w), (s[0], s[1], -w)] {
                    let p = c.position(a, b) as usize;
                    c.value[p] += v;
                }
            }
            for j in 0..n as u32 {
                let p = c.position(j, j) as usize;
                c.value[p] += held;
            }
            assert_eq!(c.factorise(), held > 0.0);
            let mut x: Vec<f64> = (0..n).map(|j| (j as f64 - 4.0) * 0.25).collect();
            let right = x.clone();
            c.solve(&mut x);
            let mut left: Vec<f64> = x.iter().map(|v| v * held).collect();
            for (k, s) in cliques.iter().enumerate() {
                let (a, b) = (s[0] as usize, s[1] as usize);
                let force = (1.0 + k as f64) * (x[a] - x[b]);
                left[a] += force;
                left[b] -= force;
            }
            for (l, r) in left.iter().zip(&right) {
                assert!((l - r).abs() < 1e-9, "{left:?} {right:?}");
            }
        }
    }
}
