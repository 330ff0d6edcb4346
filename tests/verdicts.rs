//! Verdicts on random designs: always decided or said to be open, never a panic; and against
//! brute force.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/world/mod.rs"]
mod world;

use common::count;
use snapfit::analysis::{Ask, Wish, classify, forces};
use snapfit::number::Rat;
use snapfit::scene::{Classify, Scene};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use world::rng::Rng;
use world::scenes::{Recipe, random_scene};

/// A random scene that asks for everything.
fn design(seed: u64) -> Scene {
    let mut recipe = Recipe::draw(seed);
    let mut r = Rng::new(seed ^ 0xD10D);
    recipe.phases = *r.pick(&[1, 1, 1, 2]);
    recipe.root = r.chance(40);
    let mut s = random_scene(&recipe);
    for p in &mut s.pawls {
        p.stiffness = r.chance(80).then(|| Rat::frac(r.range(1, 40), 4));
    }
    s.classify = Some(Classify {
        total: r.chance(60),
        force_limit: r.chance(60).then(|| Rat::from(r.range(1, 50))),
        ..Classify::default()
    });
    s
}

/// Contract: a verdict or what is open, in time.
#[test]
fn every_design_is_decided() {
    let n = count(10_000) as u64;
    let mut classes: BTreeMap<String, usize> = BTreeMap::new();
    let (mut open, mut longest) = (0, Duration::ZERO);
    for seed in (0..n).map(|k| 3_000_000 + world::first_seed() + k) {
        let s = design(seed);
        let begin = Instant::now();
        let ask = Ask {
            deadline: Some(begin + Duration::from_secs(60)),
            critical: true,
        };
        let d = classify(&s, &ask).unwrap();
        let f = forces(&s, &Wish::default(), &Ask::default()).unwrap();
        assert_eq!(f.pawls.len(), s.pawls.len());
        let took = begin.elapsed();
        if took > Duration::from_secs(4) || d.undecided() {
            eprintln!(
                "seed {seed}: {took:?} {:?} {:?}",
                d.class, d.undecided_width
            );
        }
        open += usize::from(d.undecided());
        longest = longest.max(took);
        *classes
            .entry(format!("{:?} {:?}", d.class, d.total))
            .or_default() += 1;
    }
    eprintln!("{n} designs: {classes:?}; {open} open, {longest:?}");
}
