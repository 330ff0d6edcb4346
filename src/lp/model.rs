//! A linear program as the user states it: exact rationals, names, and an interval for every
//! row and column.
//!
//! Everything downstream (scaling, floating point, bases) is derived from a [`Model`] and can be
//! checked against it; nothing here knows how a program is solved.

use crate::number::Rat;

/// A closed interval whose ends may be missing (infinite).
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Range {
    /// Lower end; `None` is −∞.
    pub lower: Option<Rat>,
    /// Upper end; `None` is +∞.
    pub upper: Option<Rat>,
}

impl Range {
    /// The whole line.
    pub fn free() -> Range {
        Range::default()
    }

    /// A single value.
    pub fn fixed(value: Rat) -> Range {
        Range {
            lower: Some(value.clone()),
            upper: Some(value),
        }
    }

    /// All numbers from `value` on.
    pub fn at_least(value: Rat) -> Range {
        Range {
            lower: Some(value),
            upper: None,
        }
    }

    /// All numbers up to `value`.
    pub fn at_most(value: Rat) -> Range {
        Range {
            lower: None,
            upper: Some(value),
        }
    }

    /// Whether no number lies within.
    pub fn is_empty(&self) -> bool {
        matches!((&self.lower, &self.upper), (Some(l), Some(u)) if l > u)
    }

    /// Whether `value` lies within.
    pub fn contains(&self, value: &Rat) -> bool {
        self.lower.as_ref().is_none_or(|l| l <= value)
            && self.upper.as_ref().is_none_or(|u| value <= u)
    }
}

/// A row: a name and the interval its activity must lie in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// Name, unique among the rows.
    pub name: String,
    /// Where the activity Σ aᵢⱼ xⱼ must lie.
    pub range: Range,
}

/// A column (a variable).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name, unique among the columns.
    pub name: String,
    /// Coefficient in the objective.
    pub cost: Rat,
    /// Where the value must lie.
    pub range: Range,
    /// Non-zero coefficients, `(row, value)`, one an entry.
    pub entries: Vec<(u32, Rat)>,
}

/// A linear program.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Model {
    /// Name of the program, possibly empty.
    pub name: String,
    /// Whether the objective is maximised.
    pub maximise: bool,
    /// Added to the objective.
    pub constant: Rat,
    /// Rows.
    pub rows: Vec<Row>,
    /// Columns.
    pub columns: Vec<Column>,
    /// Value given for the objective's right-hand side in an MPS file. By the convention of the
    /// published optima it is not part of the objective; it is kept so that a caller may say so.
    pub ignored_rhs: Option<Rat>,
    /// Columns to which an MPS file gives a negative upper bound and no lower one. By the format's
    /// old convention their lower bound is −∞ here, where some readers keep zero; they are kept so
    /// that a caller may say so.
    pub freed: Vec<u32>,
    /// Whether the file asked for integers, which a linear program leaves out.
    pub relaxed: bool,
}

impl Model {
    /// An empty program that minimises.
    pub fn new(name: &str) -> Model {
        Model {
            name: name.to_string(),
            ..Model::default()
        }
    }

    /// Adds a row and returns its index.
    pub fn add_row(&mut self, name: &str, range: Range) -> usize {
        self.rows.push(Row {
            name: name.to_string(),
            range,
        });
        self.rows.len() - 1
    }

    /// Adds a column without entries and returns its index.
    pub fn add_column(&mut self, name: &str, cost: Rat, range: Range) -> usize {
        self.columns.push(Column {
            name: name.to_string(),
            cost,
            range,
            entries: Vec::new(),
        });
        self.columns.len() - 1
    }

    /// Adds a coefficient. The caller gives each (row, column) once; a zero is left out.
    pub fn set(&mut self, row: usize, column: usize, value: Rat) {
        if !value.is_zero() {
            self.columns[column].entries.push((row as u32, value));
        }
    }

    /// Names of the columns that are [`Model::freed`]; None where there are none.
    pub(crate) fn freed_names(&self) -> Option<Vec<&str>> {
        let name = |j: &u32| self.columns[*j as usize].name.as_str();
        (!self.freed.is_empty()).then(|| self.freed.iter().map(name).collect())
    }

    /// Number of non-zero coefficients.
    pub fn entries(&self) -> usize {
        self.columns.iter().map(|c| c.entries.len()).sum()
    }
}
