//! Programs as free MPS text, so that a step's certificate can be checked elsewhere
//! (`snapfit verify`, or any other solver that reads rationals).

use crate::lp::Model;
use std::fmt::Write;

/// A model whose rows have lower ends only, as MPS; maximising is said by `OBJSENSE`.
pub fn to_mps(model: &Model) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut out, model);
    out
}

fn write(out: &mut String, model: &Model) -> std::fmt::Result {
    writeln!(out, "NAME {}", model.name)?;
    if model.maximise {
        writeln!(out, "OBJSENSE\n    MAX")?;
    }
    writeln!(out, "ROWS\n N  obj")?;
    for row in &model.rows {
        writeln!(out, " G  {}", row.name)?;
    }
    writeln!(out, "COLUMNS")?;
    for column in &model.columns {
        if !column.cost.is_zero() || column.entries.is_empty() {
            writeln!(out, "    {}  obj  {}", column.name, column.cost)?;
        }
        for (row, value) in &column.entries {
            writeln!(
                out,
                "    {}  {}  {value}",
                column.name, model.rows[*row as usize].name
            )?;
        }
    }
    writeln!(out, "RHS")?;
    for row in &model.rows {
        if let Some(lower) = row.range.lower.as_ref().filter(|v| !v.is_zero()) {
            writeln!(out, "    rhs  {}  {lower}", row.name)?;
        }
    }
    writeln!(out, "BOUNDS")?;
    for column in &model.columns {
        match (&column.range.lower, &column.range.upper) {
            (None, None) => writeln!(out, " FR bnd  {}", column.name)?,
            (lower, upper) => {
                match lower {
                    Some(v) => writeln!(out, " LO bnd  {}  {v}", column.name)?,
                    None => writeln!(out, " MI bnd  {}", column.name)?,
                }
                if let Some(v) = upper {
                    writeln!(out, " UP bnd  {}  {v}", column.name)?;
                }
            }
        }
    }
    writeln!(out, "ENDATA")
}
