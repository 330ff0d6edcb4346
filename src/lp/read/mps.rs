//! The MPS format, fixed and free.
//!
//! Lines are split at blanks; where that does not give the fields a section needs (a name with a
//! blank in it), the fixed columns of the old cards are used. The first free row is the
//! objective, further free rows are left out. Only the first right-hand side, range and bound
//! set count. A negative upper bound on a column whose lower bound was not given makes that
//! lower bound −∞, which [`Model::freed`] remembers. An upper bound of exactly 10³⁰ and a lower one of exactly −10³⁰ are infinite,
//! as writers of this format have meant it since its time and readers take it (Clp, QSopt,
//! and those whose infinity begins at 10²⁰); any other number is that number. A right-hand side of
//! the objective is remembered but not added: see [`Model::ignored_rhs`].

use super::{At, clip, number};
use crate::lp::model::{Column, Model, Range, Row};
use crate::number::{Int, Rat};
use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

/// The bound that stands for none.
static INFINITY: LazyLock<Rat> = LazyLock::new(|| Rat::from(Int::from(10i64).pow(30)));

#[derive(Clone, Copy, PartialEq, Debug)]
enum Section {
    Start,
    Name,
    ObjSense,
    Rows,
    Columns,
    Rhs,
    Ranges,
    Bounds,
    End,
}

#[derive(Clone, Copy, PartialEq)]
enum RowKind {
    Objective,
    Ignored,
    /// Index among the model's rows.
    Constraint(u32),
}

/// A word and the byte at which it starts.
type Field<'a> = (usize, &'a str);

struct Reader<'a> {
    model: Model,
    rows: HashMap<&'a str, RowKind>,
    columns: HashMap<&'a str, usize>,
    rhs: Vec<Option<Rat>>,
    ranges: Vec<Option<Rat>>,
    senses: Vec<u8>,
    objective_seen: bool,
    in_integers: bool,
    /// The last row of the current column that was given, to refuse repeats in one pass.
    stamp: Vec<usize>,
    cost_stamp: usize,
    lower_given: Vec<bool>,
    bound_kinds: HashSet<(usize, &'static str)>,
    sets: [Option<&'a str>; 3],
}

/// Reads an MPS text.
pub(super) fn read(text: &str) -> Result<Model, At> {
    let mut reader = Reader {
        model: Model::default(),
        rows: HashMap::new(),
        columns: HashMap::new(),
        rhs: Vec::new(),
        ranges: Vec::new(),
        senses: Vec::new(),
        objective_seen: false,
        in_integers: false,
        stamp: Vec::new(),
        cost_stamp: usize::MAX,
        lower_given: Vec::new(),
        bound_kinds: HashSet::new(),
        sets: [None; 3],
    };
    let mut section = Section::Start;
    let mut last = 0;
    for (index, raw) in text.lines().enumerate() {
        last = index + 1;
        let line = raw.trim_end();
        if line.is_empty() || line.starts_with('*') {
            continue;
        }
        let at = |(offset, message): (usize, String)| At {
            line: index + 1,
            column: line.get(..offset).map_or(0, |s| s.chars().count()) + 1,
            message,
        };
        let header = !line.starts_with([' ', '\t']);
        if header {
            section = reader.header(line, section).map_err(at)?;
            if section == Section::End {
                break;
            }
        } else {
            reader.data(line, section).map_err(at)?;
        }
    }
    if section != Section::End {
        return Err(At {
            line: last.max(1),
            column: 1,
            message: "the file ends without ENDATA".to_string(),
        });
    }
    Ok(reader.finish())
}

type Fault = (usize, String);

impl<'a> Reader<'a> {
    fn header(&mut self, line: &'a str, before: Section) -> Result<Section, Fault> {
        let fields = split(line);
        let word = fields[0].1.to_ascii_uppercase();
        let next = match word.as_str() {
            "NAME" => {
                self.model.name = line[4..].trim().to_string();
                Section::Name
            }
            "OBJSENSE" => {
                if let Some(&(offset, sense)) = fields.get(1) {
                    self.sense(offset, sense)?;
                }
                Section::ObjSense
            }
            // Some writers put the sense alone on the first column.
            "MAX" | "MAXIMIZE" | "MAXIMISE" | "MIN" | "MINIMIZE" | "MINIMISE"
                if before == Section::ObjSense =>
            {
                self.sense(0, fields[0].1)?;
                Section::ObjSense
            }
            "ROWS" => Section::Rows,
            "COLUMNS" => Section::Columns,
            "RHS" => Section::Rhs,
            "RANGES" => Section::Ranges,
            "BOUNDS" => Section::Bounds,
            "ENDATA" => Section::End,
            _ => return Err((0, format!("unknown section `{}`", clip(fields[0].1)))),
        };
        let early = |s: Section| matches!(s, Section::Start | Section::Name | Section::ObjSense);
        let ok = match next {
            Section::Name | Section::ObjSense | Section::Rows => early(before),
            Section::Columns => before == Section::Rows,
            Section::Rhs => before == Section::Columns,
            _ => matches!(
                before,
                Section::Columns | Section::Rhs | Section::Ranges | Section::Bounds
            ),
        };
        if ok {
            Ok(next)
        } else {
            Err((0, format!("section {word} does not belong here")))
        }
    }

    fn sense(&mut self, offset: usize, word: &str) -> Result<(), Fault> {
        self.model.maximise = match word.to_ascii_uppercase().as_str() {
            "MAX" | "MAXIMIZE" | "MAXIMISE" => true,
            "MIN" | "MINIMIZE" | "MINIMISE" => false,
            _ => return Err((offset, format!("`{}` is neither MAX nor MIN", clip(word)))),
        };
        Ok(())
    }

    fn data(&mut self, line: &'a str, section: Section) -> Result<(), Fault> {
        match section {
            Section::ObjSense => {
                let (offset, word) = split(line)[0];
                self.sense(offset, word)
            }
            Section::Rows => self.row(line),
            Section::Columns => self.column(line),
            Section::Rhs => self.vector(line, 0),
            Section::Ranges => self.vector(line, 1),
            Section::Bounds => self.bound(line),
            _ => Err((0, "data outside any section".to_string())),
        }
    }

    fn row(&mut self, line: &'a str) -> Result<(), Fault> {
        let fields = split(line);
        let (offset, name) = match fields.len() {
            2 => fields[1],
            1 => return Err((fields[0].0, "a row needs a sense and a name".to_string())),
            _ => fixed(line, 4, 12).ok_or((fields[1].0, "a row needs a name".to_string()))?,
        };
        let kind = match fields[0].1.to_ascii_uppercase().as_str() {
            "N" if self.objective_seen => RowKind::Ignored,
            "N" => {
                self.objective_seen = true;
                RowKind::Objective
            }
            s @ ("E" | "L" | "G") => {
                let index = self.model.rows.len() as u32;
                self.model.rows.push(Row {
                    name: name.to_string(),
                    range: Range::free(),
                });
                self.senses.push(s.as_bytes()[0]);
                self.rhs.push(None);
                self.ranges.push(None);
                self.stamp.push(usize::MAX);
                RowKind::Constraint(index)
            }
            _ => {
                return Err((
                    fields[0].0,
                    format!("`{}` is not one of N, E, L, G", clip(fields[0].1)),
                ));
            }
        };
        if self.rows.insert(name, kind).is_some() {
            return Err((offset, format!("row `{}` is declared twice", clip(name))));
        }
        Ok(())
    }

    fn known(&self, fields: &[Field<'_>]) -> bool {
        fields
            .iter()
            .step_by(2)
            .all(|(_, name)| self.rows.contains_key(name))
    }

    fn column(&mut self, line: &'a str) -> Result<(), Fault> {
        let mut fields = split(line);
        if fields.len() >= 3 && fields[1].1 == "'MARKER'" {
            self.in_integers = match fields[2].1 {
                "'INTORG'" => true,
                "'INTEND'" => false,
                other => return Err((fields[2].0, format!("unknown marker {}", clip(other)))),
            };
            self.model.relaxed |= self.in_integers;
            return Ok(());
        }
        let fits = |f: &[Field<'a>]| matches!(f.len(), 3 | 5);
        if !fits(&fields) || !self.known(&fields[1..]) {
            let cards = fixed_pairs(line);
            if fits(&cards) && self.known(&cards[1..]) {
                fields = cards;
            }
        }
        if !fits(&fields) {
            let message = "a column line holds a column and one or two pairs of row and value";
            return Err((fields[0].0, message.to_string()));
        }
        let (offset, name) = fields[0];
        let current = self.model.columns.len().wrapping_sub(1);
        let index = match self.columns.get(name) {
            Some(&i) if i == current => i,
            Some(_) => {
                return Err((
                    offset,
                    format!("column `{}` appears again after others", clip(name)),
                ));
            }
            None => {
                self.columns.insert(name, self.model.columns.len());
                self.lower_given.push(false);
                self.model.columns.push(Column {
                    name: name.to_string(),
                    cost: Rat::zero(),
                    range: Range::at_least(Rat::zero()),
                    entries: Vec::new(),
                });
                self.model.columns.len() - 1
            }
        };
        for pair in fields[1..].chunks(2) {
            let [(row_at, row), (value_at, value)] = pair else {
                return Err((offset, "a row without a value".to_string()));
            };
            let kind = *self
                .rows
                .get(row)
                .ok_or_else(|| (*row_at, format!("unknown row `{}`", clip(row))))?;
            let value = number(value).map_err(|m| (*value_at, m))?;
            let repeated = match kind {
                RowKind::Ignored => false,
                RowKind::Objective => {
                    let repeated = self.cost_stamp == index;
                    self.cost_stamp = index;
                    self.model.columns[index].cost = value;
                    repeated
                }
                RowKind::Constraint(r) => {
                    let repeated = self.stamp[r as usize] == index;
                    self.stamp[r as usize] = index;
                    if !value.is_zero() {
                        self.model.columns[index].entries.push((r, value));
                    }
                    repeated
                }
            };
            if repeated {
                return Err((
                    *row_at,
                    format!(
                        "column `{}` has a second entry in row `{}`",
                        clip(name),
                        clip(row)
                    ),
                ));
            }
        }
        Ok(())
    }

    /// The right-hand side (`which` 0) or the ranges (1).
    fn vector(&mut self, line: &'a str, which: usize) -> Result<(), Fault> {
        let mut fields = split(line);
        if matches!(fields.len(), 2 | 4) {
            fields.insert(0, (0, ""));
        }
        if !matches!(fields.len(), 3 | 5) || !self.known(&fields[1..]) {
            let cards = fixed_pairs(line);
            if matches!(cards.len(), 3 | 5) && self.known(&cards[1..]) {
                fields = cards;
            }
        }
        if !matches!(fields.len(), 3 | 5) {
            return Err((
                fields[0].0,
                "one or two pairs of row and value are needed".to_string(),
            ));
        }
        if *self.sets[which].get_or_insert(fields[0].1) != fields[0].1 {
            return Ok(());
        }
        for pair in fields[1..].chunks(2) {
            let [(row_at, row), (value_at, value)] = pair else {
                return Ok(());
            };
            let kind = *self
                .rows
                .get(row)
                .ok_or_else(|| (*row_at, format!("unknown row `{}`", clip(row))))?;
            let value = number(value).map_err(|m| (*value_at, m))?;
            let slot = match kind {
                RowKind::Constraint(r) if which == 0 => &mut self.rhs[r as usize],
                RowKind::Constraint(r) => &mut self.ranges[r as usize],
                RowKind::Objective if which == 0 => &mut self.model.ignored_rhs,
                _ => continue,
            };
            if slot.replace(value).is_some() {
                return Err((
                    *row_at,
                    format!("row `{}` is given a second value", clip(row)),
                ));
            }
        }
        Ok(())
    }

    fn bound(&mut self, line: &'a str) -> Result<(), Fault> {
        let fields = split(line);
        let kinds = ["UP", "LO", "FX", "FR", "MI", "PL", "BV", "LI", "UI", "SC"];
        let word = fields[0].1.to_ascii_uppercase();
        let Some(&kind) = kinds.iter().find(|k| **k == word) else {
            return Err((
                fields[0].0,
                format!("unknown bound kind `{}`", clip(fields[0].1)),
            ));
        };
        let needs_value = !matches!(kind, "FR" | "MI" | "PL" | "BV");
        let known = |name: &str| self.columns.contains_key(name);
        // (set, column, value), blanks in names sought in the fixed columns.
        let (set, column, value) = match (&fields[1..], needs_value) {
            ([s, c, v], true) if known(c.1) => (s.1, *c, Some(*v)),
            ([c, v], true) if known(c.1) => ("", *c, Some(*v)),
            ([s, c] | [s, c, _], false) if known(c.1) => (s.1, *c, None),
            ([c] | [c, _], false) if known(c.1) => ("", *c, None),
            _ => {
                let column = fixed(line, 14, 22).filter(|c| known(c.1));
                match column {
                    Some(c) => (
                        fixed(line, 4, 12).map_or("", |s| s.1),
                        c,
                        fixed(line, 24, usize::MAX).filter(|_| needs_value),
                    ),
                    None => {
                        let i = (fields.len() - 1).min(2);
                        return Err((
                            fields[i].0,
                            format!("bound on an unknown column `{}`", clip(fields[i].1)),
                        ));
                    }
                }
            }
        };
        if *self.sets[2].get_or_insert(set) != set {
            return Ok(());
        }
        let index = self.columns[column.1];
        if !self.bound_kinds.insert((index, kind)) {
            return Err((
                column.0,
                format!("column `{}` has a second {kind} bound", clip(column.1)),
            ));
        }
        let mut given: Option<Option<Rat>> = None; // Some(None) is an infinite value
        if needs_value {
            let Some((offset, text)) = value else {
                return Err((column.0, format!("bound {kind} needs a value")));
            };
            let infinite = match text.to_ascii_lowercase().as_str() {
                "inf" | "+inf" | "infinity" | "+infinity" => Some(1),
                "-inf" | "-infinity" => Some(-1),
                _ => None,
            };
            given = Some(match (infinite, kind) {
                (Some(1), "UP" | "UI") | (Some(-1), "LO" | "LI") => None,
                (Some(_), _) => {
                    return Err((offset, format!("bound {kind} cannot be {}", clip(text))));
                }
                (None, _) => {
                    let v = number(text).map_err(|m| (offset, m))?;
                    let sign = if matches!(kind, "UP" | "UI") { 1 } else { -1 };
                    let means_infinity = kind != "FX" && v.sign() == sign && v.abs() == *INFINITY;
                    (!means_infinity).then_some(v)
                }
            });
        }
        let range = &mut self.model.columns[index].range;
        match (kind, given) {
            ("UP" | "UI", Some(v)) => {
                if !self.lower_given[index] && v.as_ref().is_some_and(|v| v.sign() < 0) {
                    range.lower = None;
                }
                range.upper = v;
            }
            ("LO" | "LI", Some(v)) => {
                range.lower = v;
                self.lower_given[index] = true;
            }
            ("FX", Some(Some(v))) => {
                *range = Range::fixed(v);
                self.lower_given[index] = true;
            }
            ("FR", _) => {
                *range = Range::free();
                self.lower_given[index] = true;
            }
            ("MI", _) => {
                range.lower = None;
                self.lower_given[index] = true;
            }
            ("PL", _) => range.upper = None,
            ("BV", _) => {
                range.lower = Some(Rat::zero());
                range.upper = Some(Rat::one());
                self.lower_given[index] = true;
            }
            _ => {
                return Err((
                    fields[0].0,
                    "semi-continuous columns are not linear programming".to_string(),
                ));
            }
        }
        self.model.relaxed |= matches!(kind, "BV" | "LI" | "UI");
        Ok(())
    }

    fn finish(mut self) -> Model {
        // Nothing else leaves a column without the lower bound that it was not given.
        let columns = (0..).zip(&self.model.columns).zip(&self.lower_given);
        let freed = columns.filter(|((_, c), given)| !*given && c.range.lower.is_none());
        self.model.freed = freed.map(|((j, _), _)| j).collect();
        for (i, row) in self.model.rows.iter_mut().enumerate() {
            let b = self.rhs[i].take().unwrap_or_else(Rat::zero);
            let r = self.ranges[i].take();
            row.range = match (self.senses[i], r) {
                (b'E', None) => Range::fixed(b),
                (b'E', Some(r)) if r.sign() >= 0 => Range {
                    upper: Some(&b + &r),
                    lower: Some(b),
                },
                (b'E', Some(r)) => Range {
                    lower: Some(&b + &r),
                    upper: Some(b),
                },
                (b'L', None) => Range::at_most(b),
                (b'L', Some(r)) => Range {
                    lower: Some(&b - &r.abs()),
                    upper: Some(b),
                },
                (_, None) => Range::at_least(b),
                (_, Some(r)) => Range {
                    upper: Some(&b + &r.abs()),
                    lower: Some(b),
                },
            };
        }
        self.model
    }
}

/// The words of a line with their byte offsets. Never empty for a line that is not blank.
fn split(line: &str) -> Vec<Field<'_>> {
    let mut out = Vec::with_capacity(6);
    let mut start = None;
    for (i, b) in line.bytes().enumerate() {
        match (b == b' ' || b == b'\t' || b == b'\r', start) {
            (false, None) => start = Some(i),
            (true, Some(s)) => {
                out.push((s, &line[s..i]));
                start = None;
            }
            _ => {}
        }
    }
    if let Some(s) = start {
        out.push((s, &line[s..]));
    }
    if out.is_empty() {
        out.push((0, ""));
    }
    out
}

/// The text between two fixed columns, trimmed; None where it is blank or cut by a character.
fn fixed(line: &str, from: usize, to: usize) -> Option<Field<'_>> {
    let part = line.get(from..to.min(line.len()))?;
    let trimmed = part.trim_start();
    let offset = from + part.len() - trimmed.len();
    let trimmed = trimmed.trim_end();
    (!trimmed.is_empty()).then_some((offset, trimmed))
}

/// Name and one or two pairs by fixed columns.
fn fixed_pairs(line: &str) -> Vec<Field<'_>> {
    let spans = [(4, 12), (14, 22), (24, 36), (39, 47), (49, 61)];
    let mut out: Vec<Field<'_>> = Vec::new();
    for (k, (from, to)) in spans.into_iter().enumerate() {
        match fixed(line, from, to) {
            Some(f) => out.push(f),
            None if k == 0 => out.push((0, "")),
            None => break,
        }
    }
    out
}
