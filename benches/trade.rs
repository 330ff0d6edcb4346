//! What certainty costs: filtered against f64, in one run, reading and printing apart;
//! the whole scene at gap 2⁻¹⁰⁰⁰ against 2⁻¹⁰. `cargo bench --bench trade`.
//!
//! Each figure is the least CPU time of many runs; ratios are what counts.
#![allow(clippy::unwrap_used)]

#[path = "../tests/common/world/mod.rs"]
mod world;

use snapfit::kernel::Identify;
use snapfit::motion::{Arithmetic, Options, simulate};
use snapfit::scene::{Scene, read_scene};
use snapfit::trade::Setting;
use snapfit::trade::family::FAMILIES;
use std::time::Duration;
use world::scenes::{Recipe, random_scene};

const LIMIT: Duration = Duration::from_secs(20);

/// The least seconds of several runs, at least a tenth of a second in all.
fn least(setting: &Setting, scene: &Scene) -> f64 {
    let (mut best, mut spent, mut runs) = (f64::INFINITY, 0.0, 0);
    while runs < 5 || (spent < 0.1 && runs < 200) {
        let s = setting.run(scene, LIMIT).seconds;
        best = best.min(s);
        spent += s;
        runs += 1;
    }
    best
}

fn compare(title: &str, scenes: &[Scene]) {
    let filtered = Setting::Kernel(Arithmetic::Filtered);
    let float = Setting::float(1e-9, Identify::Names);
    let (mut f, mut d, mut ratios) = (0.0, 0.0, Vec::new());
    for scene in scenes {
        let (a, b) = (least(&filtered, scene), least(&float, scene));
        f += a;
        d += b;
        ratios.push(a / b);
        if scenes.len() < 10 {
            println!(
                "  {:<32} {:>9.1} µs {:>9.1} µs {:>6.2}",
                scene.name,
                a * 1e6,
                b * 1e6,
                a / b
            );
        }
    }
    ratios.sort_by(f64::total_cmp);
    println!(
        "{title:<34} {:>9.1} ms {:>9.1} ms {:>6.2}  (median of {}: {:.2})",
        f * 1e3,
        d * 1e3,
        f / d,
        ratios.len(),
        ratios[ratios.len() / 2]
    );
}

fn file(path: &str) -> Scene {
    let text = std::fs::read_to_string(path).unwrap();
    read_scene(path, &text).unwrap().into_scene()
}

fn main() {
    println!("{:<34} {:>12} {:>12} {:>6}", "", "filtered", "f64", "ratio");
    let generic: Vec<Scene> = (0..)
        .map(|seed| {
            let mut recipe = Recipe::draw(5_000_000 + seed);
            (recipe.grid, recipe.root) = (9_999_991, false);
            random_scene(&recipe)
        })
        .filter(|s| {
            let t = simulate(s, &Options::default()).unwrap();
            t.ledger.degenerate_events == 0 && t.pawls.iter().any(|p| p.events.len() > 3)
        })
        .take(60)
        .collect();
    compare("generic, seven-digit coordinates", &generic);
    let short: Vec<Scene> = (0..200)
        .map(|seed| random_scene(&Recipe::draw(seed)))
        .take(60)
        .collect();
    compare("random, small grids", &short);
    let figures = "papers/donald-pai-1993/scenes/";
    let forced: Vec<Scene> = [
        format!("{figures}fig04-two-pawls.toml"),
        format!("{figures}fig05-06-diode.toml"),
        format!("{figures}fig15-diagonal.toml"),
        "examples/ratchet-rack.toml".to_owned(),
        "examples/escapement-rack.toml".to_owned(),
    ]
    .iter()
    .map(|p| file(p))
    .collect();
    compare("forced-degenerate", &forced);
    println!(
        "\n{:<34} {:>12} {:>12} {:>6}",
        "", "gap 2^-1000", "gap 2^-10", "ratio"
    );
    for family in FAMILIES {
        let filtered = Setting::Kernel(Arithmetic::Filtered);
        let (far, near) = (
            least(&filtered, &family.scene(1000)),
            least(&filtered, &family.scene(10)),
        );
        println!(
            "{:<34} {:>9.1} µs {:>9.1} µs {:>6.2}",
            family.name,
            far * 1e6,
            near * 1e6,
            far / near
        );
    }
}
