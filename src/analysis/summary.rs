//! Verdicts and forces for a reader at a terminal.

use super::bound::Bound;
use super::document::ClassifyDocument;
use super::forces::{ForcesDocument, PhaseForces};
use crate::report::summary::Style;
use crate::report::words::{approx, contact, digits, exactly, short};
use std::fmt::Write;

fn bold(style: Style, text: &str) -> String {
    match style {
        Style::Plain => text.to_owned(),
        Style::Ansi => format!("\x1b[1m{text}\x1b[0m"),
    }
}

/// The summary of `classify`, with a line feed at its end.
pub fn classify_summary(doc: &ClassifyDocument, style: Style) -> String {
    let head = match (doc.class, doc.extent) {
        (None, _) => "no class".to_owned(),
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
            "  ({}, {})  {}: {} at t = {}",
            short(&d.velocity[0]),
            short(&d.velocity[1]),
            d.verdict,
            d.outcome.kind,
            short(&d.outcome.time)
        );
        if let Some(mu) = &d.critical_friction {
            let _ = write!(out, "; locks above μ = {}", short(mu));
        }
        if let Some(f) = &d.peak_force {
            let _ = write!(out, "; contact force at most {}", decimal(f));
        }
        out.push('\n');
    }
    if let Some(mu) = &doc.critical_friction {
        let exact = exactly(mu).replace('t', "μ");
        let _ = writeln!(out, "the family locks above μ = {} ({exact})", approx(mu));
    }
    if let Some(mu) = &doc.critical_friction_forward {
        let _ = writeln!(out, "the plan itself sticks above μ = {}", approx(mu));
    }
    if let Some(f) = &doc.critical_force {
        let _ = writeln!(out, "by force it lets go at {}", decimal(f));
    }
    if let Some(total) = doc.total {
        let count = |v: &str| doc.cover.iter().filter(|a| a.verdict == v).count();
        let _ = write!(out, "every direction: {total}");
        if !doc.cover.is_empty() {
            let _ = write!(out, "; {} arcs", doc.cover.len());
        }
        for v in ["kinematic", "friction", "force", "undecided"] {
            if count(v) > 0 {
                let _ = write!(out, ", {} {v}", count(v));
            }
        }
        let _ = writeln!(
            out,
            "; {} flips; {} rad undecided",
            doc.flips.len(),
            digits(doc.undecided_width.unwrap_or(0.0), 3)
        );
    }
    let _ = writeln!(out, "\nassumed: {}", doc.assumed.join("; "));
    if !doc.not_modelled.is_empty() {
        let _ = writeln!(out, "not modelled: {}", doc.not_modelled.join("; "));
    }
    out
}

/// An enclosure as one decimal, as far as it is sure to about six digits.
fn decimal(b: &Bound) -> String {
    match b {
        Bound::Unbounded(_) => "∞".to_owned(),
        Bound::Within { .. } => digits(b.approx(), 6),
    }
}

/// The summary of `forces`, with a line feed at its end.
pub fn forces_summary(doc: &ForcesDocument, style: Style) -> String {
    let mut out = bold(style, &format!("“{}”: {}", doc.scene, doc.outcome)) + "\n";
    if let Some(note) = &doc.note {
        let _ = writeln!(out, "{note}");
    }
    let Some(peak) = &doc.peak else {
        return out;
    };
    let _ = writeln!(
        out,
        "highest contact force {} ({}), highest torque {}",
        decimal(&peak.force),
        peak.pawl,
        decimal(&peak.torque)
    );
    for pawl in doc.pawls.iter().filter(|p| p.peak.is_some()) {
        let _ = writeln!(out, "\n{}", bold(style, &format!("pawl “{}”", pawl.name)));
        let head = [
            "phase",
            "from",
            "to",
            "contact",
            "force",
            "torque",
            "along travel",
            "handbook",
        ];
        let mut rows = vec![head.map(str::to_owned)];
        for s in &pawl.segments {
            let beside = |f: fn(&super::handbook::Handbook) -> Option<&Bound>| {
                let h = s.handbook.as_ref();
                h.map_or_else(String::new, |h| f(h).map_or("locks".to_owned(), decimal))
            };
            rows.push([
                s.phase.to_string(),
                approx(&s.from),
                approx(&s.to),
                contact(&s.contact),
                decimal(&s.force),
                decimal(&s.torque),
                beside(|h| h.model.as_ref()),
                beside(|h| h.formula.as_ref()),
            ]);
        }
        table(&rows, &mut out);
    }
    if let Some(root) = doc.root.as_ref().filter(|r| r.phases.iter().any(has_more)) {
        let _ = writeln!(out, "\n{}", bold(style, "root, all pawls together"));
        let head = [
            "phase", "velocity", "outcome", "resists", "helps", "force", "torque", "work",
        ];
        let mut rows = vec![head.map(str::to_owned)];
        let row = |p: &PhaseForces| {
            let of = |f: fn(&super::forces::RootPeak) -> &Bound| {
                // What a limit stopped has no peaks, only what was seen until then.
                let peak = p.peak.as_ref().filter(|_| !p.stopped());
                peak.map_or_else(|| "—".to_owned(), |e| decimal(f(e)))
            };
            let worked = p.lost_in_snaps.as_ref();
            [
                p.phase.map_or_else(|| "back".to_owned(), |k| k.to_string()),
                format!("({}, {})", short(&p.velocity[0]), short(&p.velocity[1])),
                p.outcome.to_owned(),
                of(|e| &e.resistance),
                of(|e| &e.help),
                of(|e| &e.force),
                of(|e| &e.torque),
                worked.map_or_else(String::new, |_| {
                    p.work.as_ref().map_or_else(|| "—".to_owned(), decimal)
                }),
            ]
        };
        rows.extend(root.phases.iter().chain(&root.way_back).map(row));
        table(&rows, &mut out);
    }
    if let Some(c) = &doc.comparison {
        let ratio = c
            .ratio
            .as_ref()
            .map_or_else(String::new, |r| format!(", ratio {}", decimal(r)));
        let _ = writeln!(
            out,
            "\nassembly {}, disassembly {}{ratio}; easier: {}",
            decimal(&c.assembly),
            decimal(&c.disassembly),
            c.easier
        );
    }
    out
}

/// Whether a phase has more than its history.
fn has_more(p: &PhaseForces) -> bool {
    p.peak.is_some() || p.lost_in_snaps.is_some()
}

/// Rows under a head; a column with nothing below its head is left out.
fn table<const N: usize>(rows: &[[String; N]], out: &mut String) {
    let width = |c: usize| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0);
    let shown: Vec<(usize, usize)> = (0..N)
        .filter(|&c| rows.iter().skip(1).any(|r| !r[c].is_empty()))
        .map(|c| (c, width(c)))
        .collect();
    for r in rows {
        let mut line = String::from(" ");
        for &(c, w) in &shown {
            let cell = &r[c];
            let gap = " ".repeat(w - cell.chars().count());
            let _ = write!(line, " {cell}{gap} ");
        }
        out.push_str(line.trim_end());
        out.push('\n');
    }
}
