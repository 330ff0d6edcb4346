//! What certainty costs: filtered against f64, in one run, reading and printing apart;
//! the whole scene at gap 2⁻¹⁰⁰⁰ against 2⁻¹⁰; from what size on the sweep is the faster method.
//! `cargo bench --bench trade`; words after `--` choose parts (arithmetics, gaps, crossover), and
//! `busy [f64] [sweep] [forced]` runs one setting for a profiler; `busy gap pass 1000` one family's
//! scene at gap 2⁻¹⁰⁰⁰; `rounds 100` fixes how often, for an instruction count.
//!
//! Each figure is the least CPU time of many runs; ratios are what counts.
#![allow(clippy::unwrap_used)]

#[path = "../tests/common/world/mod.rs"]
mod world;

use snapfit::kernel::{FloatOptions, Identify};
use snapfit::motion::{Arithmetic, Method, Options, simulate};
use snapfit::scene::{Scene, read_scene};
use snapfit::trade::family::FAMILIES;
use world::scenes::{Recipe, random_scene};

/// Seconds of this thread's CPU.
fn cpu() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

/// The least seconds of several runs, at least a twentieth of a second in all.
fn least(mut job: impl FnMut()) -> f64 {
    let (mut best, mut spent, mut runs) = (f64::INFINITY, 0.0, 0);
    while runs < 5 || (spent < 0.05 && runs < 200) {
        let from = cpu();
        job();
        let s = cpu() - from;
        best = best.min(s);
        spent += s;
        runs += 1;
    }
    best
}

/// The least seconds of a simulation.
fn simulated(scene: &Scene, arithmetic: Arithmetic, method: Method) -> f64 {
    let options = Options {
        arithmetic,
        method,
        ..Options::default()
    };
    least(|| drop(simulate(scene, &options)))
}

fn float() -> Arithmetic {
    Arithmetic::F64(FloatOptions {
        tolerance: 1e-9,
        identify: Identify::Names,
    })
}

/// Filtered by each method against f64, both by what they do unasked.
fn compare(title: &str, scenes: &[Scene]) {
    let (mut all, mut ratios) = ([0.0; 4], Vec::new());
    let row = |title: &str, [auto, naive, sweep, float]: [f64; 4]| {
        println!(
            "{title:<34} {:>9.1} µs {:>6.2} {:>8.2} {:>6.2}",
            float * 1e6,
            auto / float,
            naive / float,
            sweep / float
        );
    };
    for scene in scenes {
        let filtered = |m| simulated(scene, Arithmetic::Filtered, m);
        let here = [
            filtered(Method::Auto),
            filtered(Method::Naive),
            filtered(Method::Sweep),
            simulated(scene, float(), Method::Auto),
        ];
        ratios.push(here[0] / here[3]);
        for (a, h) in all.iter_mut().zip(here) {
            *a += h;
        }
        if scenes.len() < 10 {
            row(&format!("  {}", scene.name), here);
        }
    }
    ratios.sort_by(f64::total_cmp);
    row(title, all);
    println!("{:<34} median {:.2}", "", ratios[ratios.len() / 2]);
}

fn file(path: &str) -> Scene {
    let text = std::fs::read_to_string(path).unwrap();
    read_scene(path, &text).unwrap().into_scene()
}

/// Scenes in general position: coordinates of seven digits, nothing degenerate met, something happens.
fn generic(n: usize) -> Vec<Scene> {
    (0..)
        .map(|seed| {
            let mut recipe = Recipe::draw(5_000_000 + seed);
            (recipe.grid, recipe.root) = (9_999_991, false);
            random_scene(&recipe)
        })
        .filter(|s| {
            let t = simulate(s, &Options::default()).unwrap();
            t.ledger.degenerate_events == 0 && t.pawls.iter().any(|p| p.events.len() > 3)
        })
        .take(n)
        .collect()
}

/// The forced degeneracies of the paper, and racks with flush faces.
fn forced() -> Vec<Scene> {
    let figures = "papers/donald-pai-1993/scenes/";
    [
        format!("{figures}fig04-two-pawls.toml"),
        format!("{figures}fig05-06-diode.toml"),
        format!("{figures}fig15-diagonal.toml"),
        "examples/ratchet-rack.toml".to_owned(),
        "examples/escapement-rack.toml".to_owned(),
    ]
    .iter()
    .map(|p| file(p))
    .collect()
}

fn header(words: [&str; 5]) {
    let [a, b, c, d, e] = words;
    println!("\n{a:<34} {b:>12} {c:>6} {d:>8} {e:>6}");
}

fn arithmetics() {
    header(["filtered over f64", "f64", "auto", "naive", "sweep"]);
    compare("generic, seven-digit coordinates", &generic(60));
    let short: Vec<Scene> = (0..60)
        .map(|seed| random_scene(&Recipe::draw(seed)))
        .collect();
    compare("random, small grids", &short);
    compare("forced-degenerate", &forced());
}

fn gaps() {
    header(["filtered", "gap 2^-10", "times", "at", "-1000"]);
    for family in FAMILIES {
        let at = |k| simulated(&family.scene(k), Arithmetic::Filtered, Method::Auto);
        let (far, near) = (at(1000), at(10));
        println!(
            "{:<34} {:>9.1} µs {:>6.2}",
            family.name,
            near * 1e6,
            far / near
        );
    }
}

/// A pawl drawn over so many teeth: the longer the rack, the more arcs.
fn rack(teeth: usize) -> Scene {
    let tooth = |i: usize| format!("[\"{i}\", \"0\"], [\"{i}.5\", \"0.625\"], ");
    let profile: String = (0..teeth).map(tooth).collect();
    let text = format!(
        "[scene]\nname = \"rack {teeth}\"\n[[obstacle]]\nname = \"R\"\nvertices = [{profile}\
         [\"{teeth}\", \"0\"], [\"{teeth}\", \"-1\"], [\"0\", \"-1\"]]\n\
         [[pawl]]\nname = \"p\"\nhinge = [\"-2\", \"2\"]\n\
         vertices = [[\"-2\", \"2\"], [\"-2\", \"0.3\"], [\"-2.3\", \"0.3\"]]\n\
         [[motion]]\nvelocity = [\"1\", \"0\"]\nduration = \"{teeth}\"\n"
    );
    read_scene("rack", &text).unwrap().into_scene()
}

/// From how many arcs on the sweep is the faster one (`snapfit::motion::SWEEP_FROM`).
fn crossover() {
    println!("\nsweep over naive, filtered, by the arcs of a phase");
    for teeth in [2, 4, 8, 16, 32, 64, 128] {
        let scene = rack(teeth);
        let arcs = simulate(&scene, &Options::default()).unwrap().ledger.phases[0].arcs;
        let [n, s] =
            [Method::Naive, Method::Sweep].map(|m| simulated(&scene, Arithmetic::Filtered, m));
        println!("rack {teeth:>4} {arcs:>6} arcs {:>6.2}", s / n);
    }
    let mut by_size = vec![Vec::new(); 8];
    for seed in 0..300 {
        let mut recipe = Recipe::draw(6_000_000 + seed);
        recipe.pawls = 1;
        let scene = random_scene(&recipe);
        let ledger = simulate(&scene, &Options::default()).unwrap().ledger;
        let arcs = ledger.phases.iter().map(|p| p.arcs).max().unwrap_or(0);
        let class = (arcs / 25 + 1).ilog2() as usize;
        let [n, s] = [Method::Naive, Method::Sweep].map(|m| {
            let options = Options {
                method: m,
                ..Options::default()
            };
            let from = cpu();
            for _ in 0..3 {
                drop(simulate(&scene, &options));
            }
            cpu() - from
        });
        by_size[class.min(7)].push(s / n);
    }
    for (i, r) in by_size
        .iter_mut()
        .enumerate()
        .filter(|(_, r)| !r.is_empty())
    {
        r.sort_by(f64::total_cmp);
        println!(
            "random, {:>4} to {:>4} arcs: median {:.2} of {}",
            25 * ((1 << i) - 1),
            25 * ((2 << i) - 1),
            r[r.len() / 2],
            r.len()
        );
    }
}

/// For a profiler: the generic scenes again and again, by one arithmetic and method.
fn busy(arithmetic: Arithmetic, method: Method, scenes: &[Scene], most: usize) {
    let options = Options {
        arithmetic,
        method,
        ..Options::default()
    };
    let from = cpu();
    let mut rounds = 0;
    while rounds < most && (most < usize::MAX || cpu() - from < 4.0) {
        for s in scenes {
            drop(simulate(s, &options));
        }
        rounds += 1;
    }
    println!("{:.2} ms a round", (cpu() - from) * 1e3 / rounds as f64);
}

fn main() {
    let chosen: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    let has = |part: &str| chosen.iter().any(|c| c == part);
    let wanted = |part: &str| chosen.is_empty() || has(part);
    if has("busy") {
        let arithmetic = if has("f64") {
            float()
        } else {
            Arithmetic::Filtered
        };
        let method = if has("sweep") {
            Method::Sweep
        } else {
            Method::Naive
        };
        let number = |word: &str| {
            let at = chosen.iter().position(|c| c == word)?;
            chosen.get(at + 1)?.parse::<usize>().ok()
        };
        let gap = FAMILIES.iter().find_map(|f| Some((f, number(f.name)?)));
        let scenes = match gap {
            Some((family, k)) => vec![family.scene(k as u32)],
            None if has("forced") => forced(),
            None => generic(60),
        };
        return busy(
            arithmetic,
            method,
            &scenes,
            number("rounds").unwrap_or(usize::MAX),
        );
    }
    if wanted("arithmetics") {
        arithmetics();
    }
    if wanted("gaps") {
        gaps();
    }
    if wanted("crossover") {
        crossover();
    }
}
