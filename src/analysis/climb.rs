//! The highest place of a smooth function, by branch and bound, certified.
//!
//! A range is cut into cells. One on which the function is monotone is dropped: its higher end is
//! an end of the range or lies in a neighbour that is not dropped for this reason, since the
//! slope cannot have two signs at one place. One that cannot beat what is already attained is
//! dropped too, any other is halved. The same few lines run on any [`Scale`]: doubles for nearly all
//! questions, fixed-point numbers of any width for the cells that are left.

/// Numbers to search on, with a function enclosed on them.
pub(super) trait Scale {
    /// A place, and a value.
    type X: Clone + PartialOrd;
    /// The value over a cell, enclosed and not negative; None where that is not known.
    fn value(&self, cell: [&Self::X; 2]) -> Option<[Self::X; 2]>;
    /// Whether the slope has one sign throughout a cell.
    fn monotone(&self, cell: [&Self::X; 2]) -> bool;
    /// A bound of the value over a cell from the one at its middle and the slope.
    fn mean(&self, cell: [&Self::X; 2], middle: &Self::X, centre: &Self::X) -> Option<Self::X>;
    /// A place strictly inside; None where there is none, or the cell is as small as is of use.
    fn middle(&self, cell: [&Self::X; 2]) -> Option<Self::X>;
    /// Whether two values are as near one another as asked for.
    fn narrow(&self, lo: &Self::X, hi: &Self::X) -> bool;
}

/// Where the highest value met was met.
#[derive(Clone, Debug)]
pub(super) enum Spot<X> {
    /// At an end of the range.
    End(usize),
    /// In a cell.
    Inside(X, X),
}

/// What a search found: the supremum over the range is at least `lo`; it is at most `hi`
/// unless it is attained in one of the cells `left`.
pub(super) struct Summit<X> {
    pub(super) lo: X,
    pub(super) hi: X,
    pub(super) at: Spot<X>,
    /// Cells that could not be decided, or no further than to `narrow`.
    pub(super) left: Vec<[X; 2]>,
    /// Whether none was given up: then `hi` holds for them too.
    pub(super) settled: bool,
}

/// A cell that is given up, with a bound of its values where one is known.
type Given<X> = ([X; 2], Option<X>);

/// Searches cells, with the boxes of both ends of their range. `known` is a value that is attained,
/// with its place; `budget` bounds the cells looked at. None where the value at an end is not
/// known.
pub(super) fn climb<S: Scale>(
    scale: &S,
    ends: [[&S::X; 2]; 2],
    mut cells: Vec<[S::X; 2]>,
    known: Option<(S::X, Spot<S::X>)>,
    mut budget: u64,
) -> Option<Summit<S::X>> {
    let first = scale.value(ends[0])?;
    let last = scale.value(ends[1])?;
    let (mut lo, mut at) = if last[0] > first[0] {
        (last[0].clone(), Spot::End(1))
    } else {
        (first[0].clone(), Spot::End(0))
    };
    let mut hi = if last[1] > first[1] {
        last[1].clone()
    } else {
        first[1].clone()
    };
    if let Some((value, place)) = known {
        if value > hi {
            hi = value.clone();
        }
        if value > lo {
            (lo, at) = (value, place);
        }
    }
    let mut left: Vec<Given<S::X>> = Vec::new();
    while let Some([l, r]) = cells.pop() {
        let cell = [&l, &r];
        if budget == 0 {
            left.push(([l, r], None));
            continue;
        }
        budget -= 1;
        if scale.monotone(cell) {
            continue;
        }
        let Some(mid) = scale.middle(cell) else {
            left.push(([l, r], None));
            continue;
        };
        let mut top = scale.value(cell).map(|v| v[1].clone());
        if let Some(centre) = scale.value([&mid, &mid]) {
            if centre[0] > lo {
                (lo, at) = (centre[0].clone(), Spot::Inside(l.clone(), r.clone()));
            }
            // The mean value form is the narrower one on small cells.
            top = match (top, scale.mean(cell, &mid, &centre[1])) {
                (Some(a), Some(b)) => Some(if b < a { b } else { a }),
                (a, b) => a.or(b),
            };
        }
        match top {
            Some(top) if top <= lo => {}
            Some(top) if scale.narrow(&lo, &top) => left.push(([l, r], Some(top))),
            _ => {
                cells.push([l, mid.clone()]);
                cells.push([mid, r]);
            }
        }
    }
    left.retain(|(_, top)| top.as_ref().is_none_or(|t| *t > lo));
    let settled = left.iter().all(|(_, top)| top.is_some());
    for (_, top) in &left {
        if let Some(top) = top
            && *top > hi
        {
            hi = top.clone();
        }
    }
    // Where all cells were dropped for being level with what is attained.
    if lo > hi {
        hi = lo.clone();
    }
    Some(Summit {
        lo,
        hi,
        at,
        left: left.into_iter().map(|l| l.0).collect(),
        settled,
    })
}
