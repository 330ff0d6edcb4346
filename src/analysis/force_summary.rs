//! Forces for a reader at a terminal: the peaks, a table a pawl, what the root feels.

use super::bound::Bound;
use super::force_document::RootPeak;
use super::forces::{ForcesDocument, PhaseForces};
use super::handbook::Handbook;
use super::peak::Peak;
use super::summary::bold;
use crate::report::summary::Style;
use crate::report::words::{approx, contact, degrees, short};
use std::fmt::Write;

/// The summary of `forces`, with a line feed at its end.
pub fn forces_summary(doc: &ForcesDocument, style: Style) -> String {
    let mut out = bold(style, &format!("“{}”: {}", doc.scene, doc.outcome)) + "\n";
    if let Some(note) = &doc.note {
        let _ = writeln!(out, "{note}");
    }
    let Some(peak) = &doc.peak else {
        return out;
    };
    let decimal = |b: &Bound| b.decimal(doc.digits);
    let far = if doc.undecided {
        " as far as it got"
    } else {
        ""
    };
    let _ = writeln!(
        out,
        "highest contact force{far} {} ({}), highest torque {}",
        decimal(&peak.force),
        peak.pawl,
        decimal(&peak.torque)
    );
    for pawl in doc.pawls.iter().filter(|p| !p.segments.is_empty()) {
        let _ = writeln!(out, "\n{}", bold(style, &format!("pawl “{}”", pawl.name)));
        let head = [
            "phase",
            "from",
            "to",
            "contact",
            "force",
            "at μ = 0",
            "torque",
            "along travel",
            "handbook",
        ];
        let mut rows = vec![head.map(str::to_owned)];
        for s in &pawl.segments {
            let beside = |f: fn(&Handbook) -> Option<&Bound>| {
                let h = s.handbook.as_ref();
                h.map_or_else(String::new, |h| f(h).map_or("locks".to_owned(), decimal))
            };
            rows.push([
                s.phase.to_string(),
                approx(&s.from),
                approx(&s.to),
                contact(&s.contact),
                decimal(&s.force),
                s.force_without_friction
                    .as_ref()
                    .map_or_else(String::new, decimal),
                decimal(&s.torque),
                beside(|h| h.model.as_ref()),
                beside(|h| h.formula.as_ref()),
            ]);
        }
        table(&rows, &mut out);
    }
    let all = || doc.pawls.iter().flat_map(|p| &p.segments);
    if all().any(|s| s.force == Bound::of(&Peak::Unbounded, 1)) {
        out.push_str("∞: the contact force grows past every bound, as where it jams or sticks\n");
    }
    if all().any(|s| s.handbook.is_some()) {
        out.push_str(
            "along travel: the force against the travel at the segment's largest deflection, \
             beside the handbook's formula for it\n",
        );
        let mut parts: Vec<&str> = Vec::new();
        for part in all().flat_map(|s| &s.handbook).flat_map(|h| &h.parts) {
            if !parts.contains(part) {
                parts.push(part);
            }
        }
        if !parts.is_empty() {
            let _ = writeln!(out, "what parts them: {}", parts.join("; "));
        }
    }
    if let Some(root) = &doc.root {
        let phases: Vec<&PhaseForces> = root.phases.iter().chain(&root.way_back).collect();
        if phases.iter().any(|p| has_more(p)) {
            let _ = writeln!(out, "\n{}", bold(style, "root, all pawls together"));
            felt(&phases, doc.digits, &mut out);
        }
        for p in phases {
            history(p, doc.digits, style, &mut out);
        }
    }
    if let Some(c) = &doc.comparison {
        let ratio = c
            .ratio
            .as_ref()
            .map_or_else(String::new, |r| format!(", ratio {}", decimal(r)));
        let _ = writeln!(
            out,
            "\nlargest push: assembly {}, disassembly {}{ratio}; easier: {}",
            decimal(&c.assembly),
            decimal(&c.disassembly),
            c.easier
        );
    }
    out
}

/// Which phase, or the way back.
fn named(p: &PhaseForces) -> String {
    p.phase.map_or_else(|| "back".to_owned(), |k| k.to_string())
}

/// What the root feels, a phase a row, and why a work has no bound.
fn felt(phases: &[&PhaseForces], digits: u32, out: &mut String) {
    let decimal = |b: &Bound| b.decimal(digits);
    let head = [
        "phase",
        "velocity",
        "outcome",
        "resists",
        "at μ = 0",
        "helps",
        "force",
        "torque",
        "work",
        "work at μ = 0",
        "lost in snaps",
    ];
    let mut rows = vec![head.map(str::to_owned)];
    for p in phases {
        let of = |f: fn(&RootPeak) -> &Bound| {
            // What a limit stopped has no peaks, only what was seen until then.
            let peak = p.peak.as_ref().filter(|_| !p.stopped());
            peak.map_or_else(|| "—".to_owned(), |e| decimal(f(e)))
        };
        let worked = |b: &Option<Bound>| match &p.lost_in_snaps {
            Some(_) => b.as_ref().map_or_else(|| "—".to_owned(), decimal),
            None => String::new(),
        };
        let smooth = p.peak_without_friction.as_ref().filter(|_| !p.stopped());
        let free = p.work_without_friction.as_ref();
        rows.push([
            named(p),
            format!("({}, {})", short(&p.velocity[0]), short(&p.velocity[1])),
            p.outcome.to_owned(),
            of(|e| &e.resistance),
            smooth.map_or_else(String::new, |e| decimal(&e.resistance)),
            of(|e| &e.help),
            of(|e| &e.force),
            of(|e| &e.torque),
            worked(&p.work),
            free.map_or_else(String::new, decimal),
            worked(&p.lost_in_snaps),
        ]);
    }
    table(&rows, out);
    for p in phases {
        if let Some(note) = &p.work_note {
            let _ = writeln!(out, "phase {}: {note}", named(p));
        }
    }
}

/// The history of a phase, an instant a row; nothing where none was asked for.
fn history(p: &PhaseForces, digits: u32, style: Style, out: &mut String) {
    if p.history.is_empty() {
        return;
    }
    let which = match p.phase {
        Some(k) => format!("history of phase {k}"),
        None => "history of the way back".to_owned(),
    };
    let _ = writeln!(out, "\n{}", bold(style, &which));
    let head = [
        "time",
        "resists",
        "at μ = 0",
        "torque",
        "pawls away from rest",
    ];
    let mut rows = vec![head.map(str::to_owned)];
    for s in &p.history {
        let pawls: Vec<String> = s
            .pawls
            .iter()
            .map(|q| {
                let at = degrees(q.theta.approx());
                format!("{} at {at}: {}", q.pawl, q.force.decimal(digits))
            })
            .collect();
        rows.push([
            approx(&s.time),
            s.resistance.decimal(digits),
            s.resistance_without_friction
                .as_ref()
                .map_or_else(String::new, |b| b.decimal(digits)),
            s.torque.decimal(digits),
            pawls.join("; "),
        ]);
    }
    table(&rows, out);
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
