//! Structures drawn with characters: one a cell, rows from the top down.
//!
//! `#` is a block, `@` a fixed block, `.` and a space are empty. Blocks are those of the family
//! `grid`, twenty vertices with clearance 1/50, with tabs and sockets only towards neighbours that
//! are there; joints are left to closeness.

use crate::flex::generate::{block, body, structure};
use crate::flex::{Structure, Term};

/// The eight blocks of PF Fig. 1, as far as its caption tells: a ring of eight; the upper right
/// one is to flex to the right.
pub const FIG1: &str = "###\n#.#\n@##";

/// A frame like that of PF Fig. 5, in want of a cross beam.
pub const FRAME: &str = "\
###########
#.........#
#.........#
#.........#
@##########";

/// The same frame with a vertical beam of blocks in its middle.
pub const BRACED: &str = "\
###########
#....#....#
#....#....#
#....#....#
@##########";

/// Most cells of a drawing.
pub const MOST_CELLS: usize = 1_000_000;

/// The structure that a drawing shows, with an objective. Bodies are named after column and row,
/// counted from the lower left: `b0_0`.
///
/// # Errors
/// No block, too many cells, or a character that means nothing; with line and column.
pub fn layout(name: &str, drawing: &str) -> Result<Structure, String> {
    // Some editors begin a file with a byte order mark.
    let drawing = drawing.strip_prefix('\u{feff}').unwrap_or(drawing);
    let lines: Vec<Vec<char>> = drawing.lines().map(|l| l.chars().collect()).collect();
    if drawing.len() > MOST_CELLS {
        return Err(format!("a drawing has at most {MOST_CELLS} cells"));
    }
    for (i, line) in lines.iter().enumerate() {
        for (k, c) in line.iter().enumerate() {
            if !"#@. ".contains(*c) {
                return Err(format!(
                    "drawing:{}:{}: `{}` means nothing; # is a block, @ a fixed one, . and space are empty",
                    i + 1,
                    k + 1,
                    c.escape_default()
                ));
            }
        }
    }
    let height = lines.len();
    let at = |x: usize, y: usize| -> Option<char> {
        // y counts from the bottom.
        let row = height.checked_sub(y + 1)?;
        lines[row].get(x).copied().filter(|c| "#@".contains(*c))
    };
    let width = lines.iter().map(Vec::len).max().unwrap_or(0);
    let mut bodies = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let Some(c) = at(x, y) else {
                continue;
            };
            let left = x > 0 && at(x - 1, y).is_some();
            let below = y > 0 && at(x, y - 1).is_some();
            let shape = block(at(x + 1, y).is_some(), at(x, y + 1).is_some(), left, below);
            let place = (10 * x as i64, 10 * y as i64);
            bodies.push(body(format!("b{x}_{y}"), &shape, place, c == '@'));
        }
    }
    if bodies.is_empty() {
        return Err("the drawing shows no block".to_owned());
    }
    Ok(structure(name.to_owned(), bodies, None, Vec::new()))
}

/// PF Fig. 1: eight blocks, the upper right one to the right.
///
/// # Panics
/// Never: its drawing is a constant that tests read.
pub fn fig1() -> Structure {
    let mut s = layout("fig1", FIG1).unwrap_or_else(|e| unreachable!("{e}"));
    let corner = s.bodies.iter().position(|b| b.name == "b2_2");
    s.objective = corner
        .map(|body| Term::Body {
            body,
            dx: crate::number::Rat::one(),
            dy: crate::number::Rat::zero(),
            dtheta: crate::number::Rat::zero(),
        })
        .into_iter()
        .collect();
    s
}
