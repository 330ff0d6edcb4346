//! The map of a coincidence: the verdict for each of a square of neighbouring doubles.
//!
//! One vertex of a pawl is moved over n × n neighbouring doubles; each gives a scene of its own,
//! exactly that far off. Doubles and exact numbers colour the square by what they say happens.
//! (The idea is that of Kettner, Mehlhorn, Pion, Schirra and Yap, "Classroom examples of
//! robustness problems", ESA 2004, who map an orientation predicate.)

use super::setting::Setting;
use crate::number::Rat;
use crate::scene::Scene;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Duration;

/// A square of verdicts, row by row from the top.
#[derive(Clone, Debug, Serialize)]
pub struct Map {
    /// The scene.
    pub scene: String,
    /// Which vertex of which pawl moves.
    pub vertex: (usize, usize),
    /// Pixels a side.
    pub size: usize,
    /// What happens, by number.
    pub legend: Vec<String>,
    /// One map a setting.
    pub layers: Vec<Layer>,
}

/// One setting's verdicts.
#[derive(Clone, Debug, Serialize)]
pub struct Layer {
    /// The setting.
    pub setting: String,
    /// How many pixels differ from the first layer.
    pub differ: usize,
    /// Indices into the legend.
    #[serde(skip)]
    pub pixels: Vec<u8>,
}

/// Maps the neighbourhood. None where the scene has no such vertex, or it is no double.
pub fn map(
    scene: &Scene,
    vertex: (usize, usize),
    size: usize,
    settings: &[Setting],
    limit: Duration,
) -> Option<Map> {
    let centre = scene.pawls.get(vertex.0)?.vertices.get(vertex.1)?.clone();
    let (x, y) = (centre.x.nearest_f64()?, centre.y.nearest_f64()?);
    let mut legend: BTreeMap<String, u8> = BTreeMap::new();
    let mut words: Vec<String> = Vec::new();
    let mut layers: Vec<Layer> = settings
        .iter()
        .map(|s| Layer {
            setting: s.name(),
            differ: 0,
            pixels: Vec::with_capacity(size * size),
        })
        .collect();
    let half = size as i64 / 2;
    for row in 0..size as i64 {
        for column in 0..size as i64 {
            let mut moved = scene.clone();
            let at = &mut moved.pawls[vertex.0].vertices[vertex.1];
            at.x = Rat::from_f64(step(x, column - half));
            at.y = Rat::from_f64(step(y, half - row));
            for (layer, setting) in layers.iter_mut().zip(settings) {
                let word = said(setting, &moved, limit);
                let next = words.len().min(255) as u8;
                let index = *legend.entry(word.clone()).or_insert_with(|| {
                    words.push(word);
                    next
                });
                layer.pixels.push(index);
            }
        }
    }
    let first = layers.first().map(|l| l.pixels.clone()).unwrap_or_default();
    for layer in &mut layers {
        let pairs = layer.pixels.iter().zip(&first);
        layer.differ = pairs.filter(|(a, b)| a != b).count();
    }
    Some(Map {
        scene: scene.name.clone(),
        vertex,
        size,
        legend: words,
        layers,
    })
}

/// The double that is `n` neighbours further up.
fn step(x: f64, n: i64) -> f64 {
    let mut x = x;
    for _ in 0..n.unsigned_abs() {
        x = if n > 0 { x.next_up() } else { x.next_down() };
    }
    x
}

/// The outcome, and which kinds of events led to it.
fn said(setting: &Setting, scene: &Scene, limit: Duration) -> String {
    let o = setting.run(scene, limit);
    match o.observed {
        None if o.broke => "broken".to_owned(),
        None => "undecided".to_owned(),
        Some(o) => {
            let kinds = o.events.iter().flatten().map(|e| {
                let word = e.what.split(' ').next().unwrap_or_default();
                word.to_owned()
            });
            let kinds: Vec<String> = kinds.collect();
            format!("{}: {}", o.outcome.name(), kinds.join(", "))
        }
    }
}
