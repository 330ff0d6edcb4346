//! Scenes as TOML, so that a failure can be read and run again.

use snapfit::geometry::Vec2;
use snapfit::scene::{Motion, Scene};
use std::fmt::Write;

fn ring(v: &[Vec2]) -> String {
    let points: Vec<String> = v
        .iter()
        .map(|p| format!("[\"{}\", \"{}\"]", p.x, p.y))
        .collect();
    format!("[{}]", points.join(", "))
}

/// The scene in the contract's format.
pub fn toml(s: &Scene) -> String {
    let mut o = format!("[scene]\nname = \"{}\"\n", s.name);
    if let Some(mu) = &s.friction {
        writeln!(o, "friction = \"{mu}\"").unwrap();
    }
    for b in &s.obstacles {
        let v = ring(&b.vertices);
        write!(o, "\n[[obstacle]]\nname = \"{}\"\nvertices = {v}\n", b.name).unwrap();
        if !b.holes.is_empty() {
            let holes: Vec<String> = b.holes.iter().map(|h| ring(h)).collect();
            writeln!(o, "holes = [{}]", holes.join(", ")).unwrap();
        }
    }
    if let Some(r) = &s.root {
        write!(o, "\n[root]\nvertices = {}\n", ring(&r.vertices)).unwrap();
    }
    for p in &s.pawls {
        write!(
            o,
            "\n[[pawl]]\nname = \"{}\"\nhinge = [\"{}\", \"{}\"]\nvertices = {}\nstiffness = \"1\"\n",
            p.name,
            p.hinge.x,
            p.hinge.y,
            ring(&p.vertices)
        )
        .unwrap();
        if !p.start.is_zero() {
            writeln!(o, "start = \"{}\"", p.start).unwrap();
        }
        if let Some((lo, hi)) = &p.limits {
            writeln!(o, "limits = [\"{lo}\", \"{hi}\"]").unwrap();
        }
    }
    for m in &s.motions {
        o.push_str("\n[[motion]]\n");
        match m {
            Motion::Reverse => o.push_str("reverse = true\n"),
            Motion::Translate {
                velocity,
                duration,
                until_root_collision,
            } => {
                writeln!(o, "velocity = [\"{}\", \"{}\"]", velocity.x, velocity.y).unwrap();
                if let Some(d) = duration {
                    writeln!(o, "duration = \"{d}\"").unwrap();
                }
                if *until_root_collision {
                    o.push_str("until = \"root-collision\"\n");
                }
            }
        }
    }
    o
}
