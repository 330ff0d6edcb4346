//! Back to text: a scene as TOML, every number an exact string.

use super::types::{Motion, Scene};
use crate::geometry::Vec2;
use crate::number::Rat;
use std::fmt::Write as _;

impl Scene {
    /// The scene as TOML that reads back equal, provided that its numbers are within the reader's
    /// limits. Numbers are integers or fractions in lowest terms. Linear in the output.
    pub fn to_toml(&self) -> String {
        let mut out = Lines(String::new());
        out.line("[scene]");
        out.key("name", &quoted(&self.name));
        out.number("friction", self.friction.as_ref());
        for obstacle in &self.obstacles {
            out.line("\n[[obstacle]]");
            out.key("name", &quoted(&obstacle.name));
            out.key("vertices", &ring(&obstacle.vertices));
            if !obstacle.holes.is_empty() {
                let holes: Vec<String> = obstacle.holes.iter().map(|h| ring(h)).collect();
                out.key("holes", &format!("[{}]", holes.join(", ")));
            }
        }
        if let Some(root) = &self.root {
            out.line("\n[root]");
            out.key("vertices", &ring(&root.vertices));
            if let Some(reference) = &root.reference {
                out.key("reference", &point(reference));
            }
        }
        for pawl in &self.pawls {
            out.line("\n[[pawl]]");
            out.key("name", &quoted(&pawl.name));
            out.key("hinge", &point(&pawl.hinge));
            out.key("vertices", &ring(&pawl.vertices));
            out.number("stiffness", pawl.stiffness.as_ref());
            // Zero is no default where the limits exclude it, but then it is no valid start.
            out.number("start", Some(&pawl.start).filter(|s| !s.is_zero()));
            if let Some((lo, hi)) = &pawl.limits {
                out.key("limits", &format!("[\"{lo}\", \"{hi}\"]"));
            }
        }
        for motion in &self.motions {
            out.line("\n[[motion]]");
            match motion {
                Motion::Reverse => out.key("reverse", "true"),
                Motion::Translate {
                    velocity,
                    duration,
                    until_root_collision,
                } => {
                    out.key("velocity", &point(velocity));
                    if *until_root_collision {
                        out.key("until", "\"root-collision\"");
                    }
                    out.number("duration", duration.as_ref());
                }
            }
        }
        if let Some(classify) = &self.classify {
            out.line("\n[classify]");
            if !classify.directions.is_empty() {
                out.key("directions", &ring(&classify.directions));
            }
            if classify.total {
                out.key("total", "true");
            }
            out.number("force_limit", classify.force_limit.as_ref());
            out.number("escape_distance", classify.escape_distance.as_ref());
        }
        out.0
    }
}

struct Lines(String);

impl Lines {
    fn line(&mut self, text: &str) {
        self.0.push_str(text);
        self.0.push('\n');
    }
    fn key(&mut self, key: &str, value: &str) {
        self.line(&format!("{key} = {value}"));
    }
    fn number(&mut self, key: &str, value: Option<&Rat>) {
        if let Some(value) = value {
            self.key(key, &format!("\"{value}\""));
        }
    }
}

fn point(p: &Vec2) -> String {
    format!("[\"{}\", \"{}\"]", p.x, p.y)
}

fn ring(points: &[Vec2]) -> String {
    let points: Vec<String> = points.iter().map(point).collect();
    format!("[{}]", points.join(", "))
}

/// A TOML basic string.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            // Writing to a string cannot fail.
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
