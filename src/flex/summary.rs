//! Results of the verbs of structures in a few lines, for people at a terminal.

use super::apps::brace::BraceDocument;
use super::apps::loosen::LoosenDocument;
use super::apps::separate::SeparateDocument;
use super::report::FlexDocument;
use crate::report::Num;
use crate::report::words::{digits, short};
use std::fmt::{Display, Formatter, Result};

/// Steps that a summary lists; of more, only the first and the last ones.
const LISTED: usize = 12;
/// Bodies whose motion a summary lists.
const MOTIONS: usize = 6;

/// How stepping ended, in words.
fn ending(outcome: &str) -> &str {
    match outcome {
        "converged" => "converged",
        "most-steps" => "not converged: the most steps were taken",
        "unbounded" => "unbounded: something comes apart, see `separate`",
        "infeasible" => "infeasible: no motion restores the constraints",
        other => other,
    }
}

/// A violation in words.
fn violated(violation: &Num) -> String {
    match violation.value {
        Some(0.0) => "none: every constraint is kept".to_owned(),
        _ => format!("{} at most", short(violation)),
    }
}

fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

impl Display for FlexDocument {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let bodies = counted(self.bodies, "body").replace("bodys", "bodies");
        writeln!(
            f,
            "{}: {bodies} flex by {}",
            self.structure,
            short(&self.displacement)
        )?;
        writeln!(f, "  outcome    {}", ending(self.outcome))?;
        writeln!(f, "  because    {}", self.reason)?;
        writeln!(
            f,
            "  programs   {} rows × {} columns, {}, accuracy {}",
            self.rows,
            self.columns,
            counted(self.iterations, "step"),
            self.accuracy
        )?;
        let checked = match &self.certificate["verified"] {
            serde_json::Value::Bool(true) => "every program's certificate verified",
            _ => "not every program has a verified certificate",
        };
        writeln!(f, "  proof      {checked}")?;
        if let Some(bits) = self.steps.iter().find_map(|s| s.gradient_bits) {
            writeln!(
                f,
                "  gradients  exact in the first step, then of geometry rounded to {bits} bits"
            )?;
        }
        let path = if self.path == "safe" {
            "safe: the whole motion is proven free of collision"
        } else {
            "fast: constraints are looked at where steps end"
        };
        writeln!(f, "  path       {path}")?;
        writeln!(f, "  violation  {}", violated(&self.violation))?;
        let n = self.steps.len();
        for (k, s) in self.steps.iter().enumerate() {
            let gap = n > LISTED && (LISTED / 2..n - LISTED / 2).contains(&k);
            if gap {
                if k == LISTED / 2 {
                    writeln!(f, "  …")?;
                }
                continue;
            }
            writeln!(
                f,
                "  step {:<4}  promised {:>12}, followed {:>9}, gained {:>12}",
                k + 1,
                digits(s.objective.approx(), 6),
                digits(s.step.approx(), 6),
                digits(s.gain.approx(), 6)
            )?;
            if let Some(c) = &s.contact {
                writeln!(
                    f,
                    "    first contact: vertex {} of {} meets edge {} of {} at {} of this step",
                    c.vertex,
                    c.vertex_body,
                    c.edge,
                    c.edge_body,
                    short(&c.time)
                )?;
            }
        }
        if let Some(b) = &self.bound {
            match (&b.outer, &b.reason) {
                (Some(outer), _) => {
                    write!(f, "  at most    {}", short(outer))?;
                    if let Some(ratio) = b.ratio {
                        write!(f, ", {} times what is reached", digits(ratio, 4))?;
                    }
                    writeln!(f)?;
                }
                (None, Some(why)) => writeln!(f, "  at most    no bound: {why}")?,
                (None, None) => writeln!(f, "  at most    no bound")?,
            }
        }
        Ok(())
    }
}

impl Display for BraceDocument {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(
            f,
            "{}: flexes by {} ({})",
            self.structure,
            short(&self.displacement),
            ending(self.outcome)
        )?;
        let Some(beam) = &self.brace else {
            return writeln!(
                f,
                "  no beam would hold anything: no two vertices in sight of each other moved so"
            );
        };
        let [(a, i, p), (b, j, q)] = &beam.ends;
        writeln!(
            f,
            "  beam       vertex {i} of {a} ({}, {}) to vertex {j} of {b} ({}, {})",
            p[0], p[1], q[0], q[1]
        )?;
        writeln!(
            f,
            "  length     {} at first, {} after",
            short(&beam.before),
            short(&beam.after)
        )?;
        writeln!(
            f,
            "  searched   {} pairs of vertices, {} views",
            self.pairs[0], self.pairs[1]
        )
    }
}

impl Display for LoosenDocument {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(
            f,
            "{}: flex of at most {}",
            self.structure,
            short(&self.limit)
        )?;
        match (&self.inset, &self.flex) {
            (Some(inset), Some(flex)) => {
                writeln!(
                    f,
                    "  inset      {}, which flexes by {}",
                    short(inset),
                    short(flex)
                )?;
            }
            _ => writeln!(f, "  inset      none")?,
        }
        match &self.beyond {
            Some(b) if self.inset.is_some() => writeln!(f, "  too much   {}", short(b))?,
            _ => {}
        }
        if let Some(why) = &self.reason {
            writeln!(f, "  because    {why}")?;
        }
        writeln!(f, "  probes     {}", self.probes.len())
    }
}

impl Display for SeparateDocument {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let verdict = match self.verdict {
            "comes-apart" => "comes apart",
            other => other,
        };
        let how = if self.translations {
            " by translations"
        } else {
            ""
        };
        writeln!(f, "{}: {verdict}{how}", self.structure)?;
        if let Some(held) = &self.held {
            writeln!(f, "  held       {held}: the file holds no body")?;
        }
        if self.rows == 0 {
            writeln!(f, "  near       nothing is within epsilon of anything")?;
        }
        if let Some(why) = self.reason {
            writeln!(f, "  because    {why}")?;
        }
        if let Some((body, [x, y])) = &self.way_out {
            writeln!(f, "  way out    {body} towards ({x}, {y})")?;
        }
        // What takes it apart; else what the near constraints leave.
        let apart = self.verdict == "comes-apart";
        let clear = self.cases.iter().find(|c| c.parts && c.clear.is_some());
        let first_order = || self.cases.iter().find(|c| c.parts && apart);
        let parting = clear.or_else(first_order);
        let moving = || self.cases.iter().find(|c| !c.motion.is_empty());
        if let Some(case) = parting.or_else(moving) {
            match (case.clear, case.parts) {
                (Some(true), true) => writeln!(f, "  direction  clear of everything for all time")?,
                (Some(false), _) => writeln!(f, "  direction  collides farther on")?,
                (None, true) => writeln!(f, "  direction  to first order: it turns")?,
                _ => {}
            }
            for (body, [x, y, turn]) in case.motion.iter().take(MOTIONS) {
                write!(f, "  {body} moves by ({}, {})", short(x), short(y))?;
                if turn.value != Some(0.0) {
                    write!(f, " and turns by {}", short(turn))?;
                }
                writeln!(f)?;
            }
            if case.motion.len() > MOTIONS {
                writeln!(f, "  … and {} more", case.motion.len() - MOTIONS)?;
            }
        }
        if let Some(s) = &self.sequence {
            for (body, [x, y]) in &s.removed {
                writeln!(f, "  take away  {body} towards ({x}, {y})")?;
            }
            if !s.left.is_empty() {
                writeln!(f, "  left       {}", s.left.join(", "))?;
            }
            if s.cut_short {
                writeln!(f, "  the time was over before the sequence was")?;
            }
        }
        Ok(())
    }
}
