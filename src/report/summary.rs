//! The result for a reader at a terminal: one sentence, why, and a table a pawl.

use super::json::{EventDocument, ResultDocument};
use super::words::{UNPROVEN, approx, contacts, degrees, exactly, headline, reason};
use std::fmt::Write;

/// Whether and how the summary stresses what matters.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Style {
    /// Text alone.
    Plain,
    /// ANSI bold, dim and colours.
    Ansi,
}

impl Style {
    fn paint(self, code: &str, text: &str) -> String {
        match self {
            Style::Plain => text.to_owned(),
            Style::Ansi => format!("\x1b[{code}m{text}\x1b[0m"),
        }
    }
}

/// The summary of a result, with a line feed at its end.
pub fn summary(result: &ResultDocument, style: Style) -> String {
    let mut out = style.paint("1", &headline(result)) + "\n";
    if let Some(why) = reason(result) {
        out.push_str(&why);
        out.push('\n');
    }
    if result.arithmetic == "f64" {
        out.push_str(UNPROVEN);
        out.push('\n');
    }
    for branch in result.outcome.branches.iter().flatten() {
        let on: Vec<String> = branch.contacts.iter().map(super::words::contact).collect();
        let holds = if branch.sticks {
            ", where friction holds it"
        } else {
            ""
        };
        let on = if on.is_empty() {
            String::new()
        } else {
            format!(", driven by {}", on.join(", "))
        };
        let _ = writeln!(out, "  {}{on}{holds}", branch.direction);
    }
    for pawl in &result.pawls {
        out.push('\n');
        out.push_str(&style.paint("1", &format!("pawl “{}”", pawl.name)));
        out.push('\n');
        out.push_str(&table(&pawl.events, style));
    }
    out
}

const HEAD: [&str; 6] = ["phase", "time", "exactly", "θ", "event", "contacts"];
const RIGHT: [bool; 6] = [true, true, false, true, false, false];

fn table(events: &[EventDocument], style: Style) -> String {
    let rows: Vec<[String; 6]> = events.iter().map(row).collect();
    let width = |c: usize| {
        let cells = rows.iter().map(|r| r[c].chars().count());
        cells.chain([HEAD[c].chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..HEAD.len()).map(width).collect();
    let line = |cells: [&str; 6]| {
        let mut text = String::from("  ");
        for (c, cell) in cells.iter().enumerate() {
            let gap = " ".repeat(widths[c] - cell.chars().count());
            let (before, after) = if RIGHT[c] {
                (gap.as_str(), "")
            } else {
                ("", gap.as_str())
            };
            let _ = write!(text, "{before}{cell}{after}  ");
        }
        text.trim_end().to_owned()
    };
    let mut out = style.paint("2", &line(HEAD)) + "\n";
    for (event, row) in events.iter().zip(&rows) {
        let text = line(row.each_ref().map(String::as_str));
        out.push_str(&match colour(event.kind) {
            Some(code) => style.paint(code, &text),
            None => text,
        });
        out.push('\n');
    }
    out
}

fn row(e: &EventDocument) -> [String; 6] {
    let theta = match e.to_theta {
        Some(to) => format!("{} → {}", degrees(e.theta), degrees(to)),
        None => degrees(e.theta),
    };
    [
        e.phase.to_string(),
        approx(&e.time),
        exactly(&e.time),
        theta,
        e.kind.to_owned(),
        contacts(&e.contacts),
    ]
}

fn colour(kind: &str) -> Option<&'static str> {
    match kind {
        "jam-incompatible" | "jam-single" | "stick" | "root-collision" | "bifurcation" => {
            Some("31")
        }
        "snap-free" | "snap-free-vertex" => Some("33"),
        "phase-end" | "plan-end" | "graze" => Some("2"),
        _ => None,
    }
}
