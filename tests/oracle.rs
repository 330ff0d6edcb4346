//! The engine against an oracle of brute force that shares no approach with it.

#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/world/mod.rs"]
mod world;

use common::count;
use snapfit::scene::{Scene, read_scene};
use world::compare::{Covered, compare};
use world::scenes::{Recipe, random_scene, shrink};

fn named_scenes() -> Vec<(String, Scene)> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut out = Vec::new();
    for dir in ["../shared/oracle/scenes/figures", "examples"] {
        let Ok(list) = std::fs::read_dir(root.join(dir)) else {
            eprintln!("SKIPPED: there is no {dir}");
            continue;
        };
        let mut files: Vec<_> = list.filter_map(|e| Some(e.ok()?.path())).collect();
        files.sort();
        for path in files {
            if path.extension().is_none_or(|e| e != "toml") {
                continue;
            }
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            let text = std::fs::read_to_string(&path).unwrap();
            match read_scene(&name, &text) {
                Ok(file) => out.push((name, file.into_scene())),
                Err(e) => panic!("{name}: {e:?}"),
            }
        }
    }
    out
}

/// Contract, design.md idea 3: at every instant of every named scene the state is the end of a
/// free interval that is nearest to rest; its course, snaps and end are what brute force finds.
#[test]
fn named_scenes_agree_with_brute_force() {
    let mut all = Covered::default();
    let mut wrong = Vec::new();
    for (name, scene) in named_scenes() {
        match compare(&scene, 1, count(1000), 300) {
            Ok(c) => all.add(&c),
            Err(e) => wrong.push(format!("{name}: {e}")),
        }
    }
    eprintln!("{all:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The same for random scenes, convex and not, with one to three pawls, friction or none.
#[test]
fn random_scenes_agree_with_brute_force() {
    let mut all = Covered::default();
    let n = count(2000) as u64;
    let mut wrong = Vec::new();
    let mut seeds: Vec<u64> = (0..n).map(|k| world::first_seed() + k).collect();
    if let Ok(list) = std::env::var("TEST_SEEDS") {
        seeds = list.split(',').map(|s| s.parse().unwrap()).collect();
    }
    for seed in seeds {
        let scene = random_scene(&Recipe::draw(seed));
        match compare(&scene, seed, 20, 150) {
            Ok(c) => all.add(&c),
            Err(e) => wrong.push((seed, e, scene)),
        }
    }
    eprintln!("{all:?}");
    if std::env::var("TEST_SHRINK").is_ok() {
        let kind = |e: &str| -> String {
            let letters = e.chars().filter(|c| c.is_alphabetic() || *c == ' ');
            letters.collect::<String>().replace("ee", "e")
        };
        for (seed, e, scene) in &wrong {
            let like = kind(e.split_once(": ").map_or(e, |x| x.1));
            let again = |s: &Scene| compare(s, *seed, 40, 150).err();
            let small = shrink(scene, &|s| {
                again(s).is_some_and(|x| kind(&x).ends_with(&like))
            });
            eprintln!("── seed {seed}: {:?}\n{}", again(&small), small.to_toml());
        }
    }
    // Where doubles cannot tell the oracle says so; that must stay rare.
    assert!(all.doubts * 20 <= all.phases + 20, "{all:?}");
    let list: Vec<String> = wrong
        .iter()
        .map(|w| format!("seed {}: {}", w.0, w.1))
        .collect();
    assert!(
        list.is_empty(),
        "{} of {n}:\n{}",
        list.len(),
        list.join("\n")
    );
}

/// One scene from the file that TEST_SCENE names, with all that brute force finds.
#[test]
#[ignore = "a tool: needs TEST_SCENE"]
fn one_scene() {
    let Ok(path) = std::env::var("TEST_SCENE") else {
        return;
    };
    // A file, or a seed.
    let scene = match path.parse() {
        Ok(seed) => random_scene(&Recipe::draw(seed)),
        Err(_) => {
            let text = std::fs::read_to_string(&path).unwrap();
            read_scene(&path, &text).unwrap().into_scene()
        }
    };
    eprintln!("{}", scene.to_toml());
    let t = world::compare::engine(&scene).unwrap();
    for p in &t.pawls {
        for e in &p.events {
            eprintln!(
                "{} {:?} phase {} t {} θ {} to {:?} {:?}",
                p.name,
                e.kind,
                e.phase,
                world::compare::ft(&e.time),
                world::oracle::radians(&e.angle),
                e.to.as_ref().map(world::oracle::radians),
                e.contacts
            );
        }
    }
    let o = &t.outcome;
    eprintln!(
        "{:?} at {} phase {} {:?}",
        o.kind,
        world::compare::ft(&o.time),
        o.phase,
        o.pawl
    );
    if std::env::var("TEST_ARCS").is_ok() {
        world::compare::arcs(&scene, &t);
    }
    world::compare::forecast(&scene, &t);
    eprintln!("{:?}", compare(&scene, 1, 100, 150));
}
