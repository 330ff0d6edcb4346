//! Many random scenes: no panic, no hang, no undecided verdict, and a trajectory that hangs
//! together.

#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/world/mod.rs"]
mod world;

use common::count;
use snapfit::motion::trajectory::OutcomeKind;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use world::compare::{engine, shape};
use world::scenes::{Recipe, random_scene};

/// Contract: a scene is decided. A hang is more than twenty seconds in one scene.
#[test]
fn every_random_scene_is_decided() {
    let n = count(10_000) as u64;
    let mut outcomes: BTreeMap<OutcomeKind, usize> = BTreeMap::new();
    let (mut pairs, mut longest) = (0, Duration::ZERO);
    let mut wrong = Vec::new();
    // Seeds of their own, so that these are not the oracle's scenes again.
    for seed in (0..n).map(|k| 1_000_000 + world::first_seed() + k) {
        let scene = random_scene(&Recipe::draw(seed));
        let mine: usize = scene.pawls.iter().map(|p| p.vertices.len()).sum();
        let theirs: usize = scene
            .obstacles
            .iter()
            .map(|o| o.vertices.len() + o.holes.iter().map(Vec::len).sum::<usize>())
            .sum();
        pairs = pairs.max(2 * mine * theirs);
        let begin = Instant::now();
        match engine(&scene).and_then(|t| shape(&scene, &t).map(|()| t)) {
            Ok(t) => *outcomes.entry(t.outcome.kind).or_default() += 1,
            Err(e) => wrong.push(format!("seed {seed}: {e}\n{}", scene.to_toml())),
        }
        longest = longest.max(begin.elapsed());
    }
    eprintln!("{n} scenes: {outcomes:?}; at most {pairs} pairs, {longest:?}");
    assert!(
        wrong.is_empty(),
        "{} of {n}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
