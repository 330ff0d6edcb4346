//! Structures as TOML text, which [`super::read_structure`] reads back to the same structure.

use super::types::{Hold, Path, Structure, Term};
use crate::geometry::Vec2;
use crate::number::Rat;
use std::fmt::Write;

/// A structure as TOML.
pub fn structure_to_toml(s: &Structure) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut out, s);
    out
}

fn write(out: &mut String, s: &Structure) -> std::fmt::Result {
    let name = |k: usize| quoted(&s.bodies[k].name);
    writeln!(out, "[structure]\nname = {}", quoted(&s.name))?;
    writeln!(out, "epsilon = {}", number(&s.epsilon))?;
    if let Some(n) = s.nearest {
        writeln!(out, "nearest = {n}")?;
    }
    for b in &s.bodies {
        let ring: Vec<String> = b.vertices.iter().map(point).collect();
        writeln!(out, "\n[[body]]\nname = {}", quoted(&b.name))?;
        writeln!(out, "vertices = [{}]", ring.join(", "))?;
        writeln!(out, "position = {}", point(&b.position))?;
        if !b.tan_half.is_zero() {
            writeln!(out, "tan_half = {}", number(&b.tan_half))?;
        }
        match &b.hold {
            Hold::Free => {}
            Hold::Fixed => writeln!(out, "fixed = true")?,
            Hold::Pin(p) => writeln!(out, "pin = {}", point(p))?,
        }
    }
    for joint in s.joints.iter().flatten() {
        let pairs: Vec<String> = joint
            .bodies
            .iter()
            .map(|&(a, b)| format!("[{}, {}]", name(a), name(b)))
            .collect();
        writeln!(out, "\n[[joint]]\nbodies = [{}]", pairs.join(", "))?;
        if let Some(contacts) = &joint.contacts {
            for (key, of_first) in [("first", true), ("second", false)] {
                let list: Vec<String> = contacts
                    .iter()
                    .filter(|c| c.edge_of_first == of_first)
                    .map(|c| format!("[{}, {}]", c.edge, c.vertex))
                    .collect();
                writeln!(out, "{key} = [{}]", list.join(", "))?;
            }
        }
    }
    for v in &s.views {
        writeln!(out, "\n[[view]]\nbody = {}", name(v.body))?;
        writeln!(out, "camera = {}", point(&v.camera))?;
        writeln!(out, "left = {}", point(&v.left))?;
        writeln!(out, "right = {}", point(&v.right))?;
        if let Some(far) = &v.far {
            writeln!(out, "far = {}", point(far))?;
        }
        writeln!(out, "of = {}", name(v.of))?;
        writeln!(out, "marker = {}", point(&v.marker))?;
    }
    if !s.objective.is_empty() {
        writeln!(out, "\n[objective]\nterms = [")?;
        for term in &s.objective {
            let weight = |key: &str, w: &Rat| {
                if w.is_zero() {
                    String::new()
                } else {
                    format!(", {key} = {}", number(w))
                }
            };
            let line = match term {
                Term::Body {
                    body,
                    dx,
                    dy,
                    dtheta,
                } => format!(
                    "body = {}{}{}{}",
                    name(*body),
                    weight("dx", dx),
                    weight("dy", dy),
                    weight("dtheta", dtheta)
                ),
                Term::Vertex {
                    body,
                    vertex,
                    dx,
                    dy,
                } => format!(
                    "body = {}, vertex = {vertex}{}{}",
                    name(*body),
                    weight("dx", dx),
                    weight("dy", dy)
                ),
                Term::Towards { body, x } => {
                    format!("body = {}, towards_x = {}", name(*body), number(x))
                }
                Term::Radial { body, from } => {
                    let who = body.map(|b| format!("body = {}, ", name(b)));
                    format!("{}radial_from = {}", who.unwrap_or_default(), point(from))
                }
            };
            writeln!(out, "  {{ {line} }},")?;
        }
        writeln!(out, "]")?;
    }
    writeln!(out, "\n[step]\nviolation = {}", number(&s.step.violation))?;
    if s.step.path == Path::Safe {
        writeln!(out, "path = \"safe\"")?;
    }
    if let Some(limit) = &s.step.rotation_limit {
        writeln!(out, "rotation_limit = {}", number(limit))?;
    }
    writeln!(
        out,
        "gain = {}\nmost = {}",
        number(&s.step.gain),
        s.step.most
    )
}

/// As a decimal where that is exact and short, else as a fraction.
fn number(r: &Rat) -> String {
    let ten = |k: u32| crate::number::Int::from(10).pow(k);
    for k in 0..=9 {
        let scaled = r * &Rat::from(ten(k));
        if scaled.is_integer() {
            let digits = scaled.numer().abs().to_string();
            let sign = if r.sign() < 0 { "-" } else { "" };
            if k == 0 {
                return format!("\"{sign}{digits}\"");
            }
            let digits = format!("{digits:0>width$}", width = k as usize + 1);
            let (whole, part) = digits.split_at(digits.len() - k as usize);
            return format!("\"{sign}{whole}.{part}\"");
        }
    }
    format!("\"{r}\"")
}

fn point(p: &Vec2) -> String {
    format!("[{}, {}]", number(&p.x), number(&p.y))
}

/// A TOML basic string.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
