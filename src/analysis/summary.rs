//! Verdicts for a reader at a terminal.

use super::document::ClassifyDocument;
use crate::report::summary::Style;
use crate::report::words::{digits, equals, exactly, short};
use std::fmt::Write;

pub use super::force_summary::forces_summary;

pub(super) fn bold(style: Style, text: &str) -> String {
    match style {
        Style::Plain => text.to_owned(),
        Style::Ansi => format!("\x1b[1m{text}\x1b[0m"),
    }
}

/// The summary of `classify`, with a line feed at its end.
pub fn classify_summary(doc: &ClassifyDocument, style: Style) -> String {
    let head = match (doc.class, doc.extent) {
        (None, _) => "no class".to_owned(),
        (Some("none"), _) => "no diode: it comes apart".to_owned(),
        (Some(class), Some(extent)) => format!("{extent} {class} diode"),
        (Some(class), None) => class.to_owned(),
    };
    let mut out = bold(style, &format!("“{}”: {head}", doc.scene)) + "\n";
    let _ = writeln!(out, "{}", doc.reason);
    if !doc.directions.is_empty() {
        let _ = writeln!(out, "\ndirections");
    }
    for d in &doc.directions {
        let _ = write!(
            out,
            "  ({}, {})  {}: {} at t {}",
            short(&d.velocity[0]),
            short(&d.velocity[1]),
            d.verdict,
            d.outcome.kind,
            equals(&d.outcome.time)
        );
        if let Some(mu) = &d.critical_friction {
            let _ = write!(out, "; locks above μ {}", equals(mu));
        }
        if let Some(f) = &d.peak_force {
            let _ = write!(out, "; highest contact force {}", f.decimal(6));
        }
        if let Some(f) = &d.peak_root_force {
            let _ = write!(out, "; push at the root up to {}", f.decimal(6));
        }
        out.push('\n');
    }
    if let Some(mu) = &doc.critical_friction {
        let exact = exactly(mu).replace('t', "μ");
        let said = equals(mu);
        let exact = match said.starts_with('≈') {
            true => format!(" ({exact})"),
            false => String::new(),
        };
        let _ = writeln!(out, "the family locks above μ {said}{exact}");
    }
    if let Some(mu) = &doc.critical_friction_forward {
        let _ = writeln!(out, "the plan itself sticks above μ {}", equals(mu));
    }
    if let Some(f) = &doc.critical_force {
        let _ = write!(out, "it lets go at a contact force of {}", f.decimal(6));
        if let Some(f) = &doc.critical_root_force {
            let _ = write!(out, ", a push of {} at the root", f.decimal(6));
        }
        out.push('\n');
    }
    if let Some(total) = doc.total {
        out.push_str(&circle(doc, total));
    }
    let _ = writeln!(out, "\nassumed: {}", doc.assumed.join("; "));
    if !doc.not_modelled.is_empty() {
        let _ = writeln!(out, "not modelled: {}", doc.not_modelled.join("; "));
    }
    out
}

/// Every direction, in a sentence.
fn circle(doc: &ClassifyDocument, total: &str) -> String {
    let mut out = format!("every direction: {total}");
    if let Some(d) = &doc.escape_distance {
        let _ = write!(out, ", run over a distance of {}", short(d));
    }
    let counts: Vec<String> = ["kinematic", "friction", "force", "none", "undecided"]
        .iter()
        .map(|v| (*v, doc.cover.iter().filter(|a| a.verdict == *v).count()))
        .filter(|c| c.1 > 0)
        .map(|(v, n)| format!("{n} {v}"))
        .collect();
    if !counts.is_empty() {
        let all = counted(doc.cover.len(), "arc");
        let _ = write!(out, "; {all}: {}", counts.join(", "));
        let out_of = doc.cover.iter().filter(|a| a.verdict == "none");
        let open = out_of.clone().filter(|a| a.proven).count();
        if open > 0 {
            let _ = write!(out, " ({open} of {} proven to get out)", out_of.count());
        }
    }
    let _ = writeln!(
        out,
        "; {}; {} rad not proven to hold so firmly",
        counted(doc.flips.len(), "flip"),
        digits(doc.undecided_width.unwrap_or(0.0), 3)
    );
    out
}

/// `1 arc`, `2 arcs`.
fn counted(n: usize, what: &str) -> String {
    match n {
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    }
}
