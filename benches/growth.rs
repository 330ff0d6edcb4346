//! How time and memory grow: the face by walking and by merging on long racks and on a family whose whole
//! arrangement is quadratic, degenerate sets beside a generic one, and scenes with many teeth, many pawls, or
//! nearly all of the obstacle out of reach. Everything as ratios, counts and exponents of one run; the figures kept
//! are in `README.md` beside this file.
//!
//! `cargo bench --bench growth` goes to 10⁵ arcs, `GROWTH_MAX=1000000` further; words after `--` choose parts.

use snapfit::face::{ArcFile, Method, RootOf, SourceArc, face};
use snapfit::motion::{Arithmetic, Ledger, Method as By, Options, simulate, slices};
use snapfit::number::{Int, Rat};
use snapfit::scene::{SceneFile, read_scene};
use snapfit::slice::Free;
use std::fmt::Write;
use std::path::PathBuf;

fn cpu() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

/// CPU seconds of a job, the least of enough runs to be told from noise.
fn seconds(mut job: impl FnMut()) -> f64 {
    let (mut least, mut spent) = (f64::INFINITY, 0.0);
    for _ in 0..5 {
        let from = cpu();
        job();
        let took = cpu() - from;
        least = least.min(took);
        spent += took;
        if spent > 4.0 {
            break;
        }
    }
    least
}

/// Peak resident megabytes since the last call with `reset`; NaN where the system does not say.
fn peak(reset: bool) -> f64 {
    if reset {
        let _ = std::fs::write("/proc/self/clear_refs", "5");
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kb = line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok());
    kb.map_or(f64::NAN, |kb| kb / 1024.0)
}

/// The slope of the least-squares line through the logarithms.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|p| (p.0.ln(), p.1.ln())).collect();
    let mean = logs
        .iter()
        .fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (mut above, mut below) = (0.0, 0.0);
    for p in &logs {
        above += (p.0 - mean.0) * (p.1 - mean.1);
        below += (p.0 - mean.0) * (p.0 - mean.0);
    }
    above / below
}

/// The contact arcs of a pawl with six corners and one tooth with six, 22 in all.
const TOOTH: &str = include_str!("tooth.arcs");

/// A long rack: the tooth again and again, 5/8 of a time unit apart. A tooth moved along the path by d moves its
/// arcs by d in t, exactly: P becomes P + d·Q.
fn rack(n: usize) -> Vec<SourceArc> {
    let tooth = ArcFile::parse(TOOTH)
        .expect("the tooth is well formed")
        .arcs;
    let (up, down) = (5i64, 8i64);
    (0..n)
        .map(|i| {
            let (arc, k) = (&tooth[i % tooth.len()], (i / tooth.len()) as i64);
            let (d, b) = (Int::from(up * k), Int::from(down));
            SourceArc {
                p: std::array::from_fn(|j| &arc.p[j] * &b + &arc.q[j] * &d),
                q: std::array::from_fn(|j| &arc.q[j] * &b),
                ..arc.clone()
            }
        })
        .collect()
}

fn ratio(n: i64, d: i64) -> RootOf {
    RootOf {
        c: [Int::from(-n), Int::from(d), Int::zero()],
        k: 0,
    }
}

/// Two families of long crossing lines, or of curves t = P/(1 + u²): about n²/4·(a share) crossings, and a face around
/// them all whose boundary is the fringe of their ends.
/// Of each also: constant, slope, and its ends in thousandths.
fn lattice(n: usize, curved: bool) -> (Vec<SourceArc>, Vec<[i64; 4]>) {
    let mut seed = 5u64;
    let mut below = |m: i64| {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((seed >> 33) as i64) % m
    };
    let (mut arcs, mut plain) = (Vec::new(), Vec::new());
    let steep = 700 * n as i64;
    for i in 0..n as i64 {
        let (c, s) = (
            (i / 2) * 1000 + below(100),
            if i % 2 == 0 { steep } else { -steep },
        );
        let (a, b) = (-1000 + below(99), 1000 + below(99));
        let m = n as i64;
        let (p, q) = if curved {
            ([c + 300 * m, s, c - 200 * m], [1000, 0, 1000])
        } else {
            ([c, s, 0], [1000, 0, 0])
        };
        arcs.push(SourceArc {
            p: p.map(Int::from),
            q: q.map(Int::from),
            left: ratio(a, 1000),
            right: ratio(b, 1000),
            line: 0,
        });
        plain.push([c, s, a, b]);
    }
    (arcs, plain)
}

/// Crossings of a lattice, all pairs: c + s·u = d + r·u for lines, c(1 + u²) + s·u = d(1 + u²) + r·u for
/// curves, between the ends. In doubles, for the count.
fn crossings(lines: &[[i64; 4]], curved: bool) -> u64 {
    let mut count = 0;
    for (i, l) in lines.iter().enumerate() {
        for m in &lines[i + 1..] {
            let (d, s) = ((l[0] - m[0]) as f64, (l[1] - m[1]) as f64);
            if s == 0.0 {
                continue;
            }
            let (a, b) = (l[2].max(m[2]) as f64 / 1e3, l[3].min(m[3]) as f64 / 1e3);
            let within = |u: f64| a <= u && u <= b;
            if !curved {
                count += u64::from(within(-d / s));
            } else if d == 0.0 {
                count += u64::from(within(0.0));
            } else if s * s >= 4.0 * d * d {
                // d·u² + s·u + d: the roots are each other's inverses.
                let q = -0.5 * (s + s.signum() * (s * s - 4.0 * d * d).sqrt());
                count += u64::from(within(q / d)) + u64::from(within(d / q));
            }
        }
    }
    count
}

fn sizes(from: usize, factor: usize, most: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(from), move |n| Some(n * factor)).take_while(move |&n| n <= most)
}

fn racks(most: usize) {
    println!("\n# Long racks: F is near-linear");
    println!(
        "lambda(n)/n for arcs that meet at most four times is about 2^alpha(n), and alpha(n) <= 4 here"
    );
    println!("method      n     |F|    |F|/n  us/arc   peak MB");
    let start = (Rat::frac(1, 7), Rat::frac(-1, 3));
    for method in [Method::Merge, Method::Walk] {
        let (mut time, mut room) = (Vec::new(), Vec::new());
        for n in sizes(1000, 10, most) {
            let arcs = rack(n);
            let before = peak(true);
            let mut edges = 0;
            let s = seconds(|| edges = face(&arcs, &start, method).expect("arcs").half_edges);
            let mb = peak(false) - before;
            println!(
                "{method:5?} {n:8} {edges:8} {:6.3} {:8.2} {mb:8.1}",
                edges as f64 / n as f64,
                s / n as f64 * 1e6
            );
            time.push((n as f64, s));
            room.push((n as f64, mb));
        }
        // Below a few megabytes the allocator's own steps show.
        room.retain(|p| p.0 >= 1e4);
        println!(
            "{method:?}: time n^{:.3}, memory n^{:.3}",
            exponent(&time),
            exponent(&room)
        );
    }
}

fn lattices(most: usize, curved: bool) {
    println!(
        "\n# Long crossing {}, the start outside: the whole arrangement is quadratic",
        if curved { "curves" } else { "lines" }
    );
    println!("     n  crossings      |F|  |F|/n  merge s  auto");
    let mut points = [Vec::new(), Vec::new(), Vec::new()];
    for n in sizes(250, 4, most.min(64_000)) {
        let (arcs, plain) = lattice(n, curved);
        let start = (Rat::zero(), Rat::from(-10 * n as i64));
        let mut answer = None;
        let merge = seconds(|| answer = Some(face(&arcs, &start, Method::Merge).expect("arcs")));
        let auto = face(&arcs, &start, Method::Auto).expect("arcs").method;
        let edges = answer.map_or(0, |a| a.half_edges);
        let all = crossings(&plain, curved);
        println!(
            "{n:6} {all:10} {edges:8} {:6.2} {merge:8.4} {auto:?}",
            edges as f64 / n as f64
        );
        for (list, y) in points.iter_mut().zip([all as f64, merge, edges as f64]) {
            list.push((n as f64, y));
        }
    }
    let [all, merge, edges] = points.map(|p| exponent(&p));
    println!("crossings n^{all:.2}, |F| n^{edges:.2}, merge n^{merge:.2}");
}

fn degenerate() {
    println!(
        "\n# Degenerate sets: microseconds per (half-edge + arc), over those of the generic set"
    );
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data/arcs");
    let mut base = None;
    for name in [
        "generic_1024",
        "overlap_256",
        "overlapscale_256",
        "tangent_256",
        "commonalg_256",
        "common_256",
        "tangall_256",
        "near_256",
    ] {
        let path = folder.join(format!("deg_{name}.arcs.gz"));
        let Ok(file) = ArcFile::open(&path) else {
            eprintln!("SKIPPED: {} is not here", path.display());
            continue;
        };
        let per = [Method::Walk, Method::Merge].map(|m| {
            let mut edges = 0;
            let s = seconds(|| {
                edges = face(&file.arcs, &file.start, m).expect("arcs").half_edges;
            });
            s * 1e6 / (edges as f64 + file.arcs.len() as f64)
        });
        let base = *base.get_or_insert(per);
        println!(
            "{name:17} walk {:6.2} ({:4.1} x)  merge {:6.2} ({:4.1} x)",
            per[0],
            per[0] / base[0],
            per[1],
            per[1] / base[1]
        );
    }
}

/// A rack of `teeth` below the path of `pawls` equal pawls, and another of `far` teeth out of reach, which is part
/// of the same obstacle (the file's one polygon goes down to it).
fn scene(teeth: usize, far: usize, pawls: usize) -> String {
    let mut text =
        String::from("[scene]\nname = \"rack\"\n[[obstacle]]\nname = \"R\"\nvertices = [");
    let mut at = |x: f64, y: f64| {
        let _ = write!(text, "[\"{x}\", \"{y}\"],");
    };
    for i in 0..teeth {
        at(i as f64, 0.0);
        at(i as f64 + 0.5, 0.625);
    }
    at(teeth as f64, 0.0);
    at(teeth as f64, -99.0);
    for i in 0..far {
        at((teeth + 1 + i) as f64, -100.0);
        at((teeth + 1 + i) as f64 + 0.5, -99.5);
    }
    at((teeth + far + 2) as f64, -102.0);
    at(0.0, -102.0);
    text.push_str("]\n");
    for k in 0..pawls {
        let _ = writeln!(
            text,
            "[[pawl]]\nname = \"p{k}\"\nhinge = [\"-2\", \"2\"]\n\
             vertices = [[\"-2\", \"2\"], [\"-2\", \"0.3\"], [\"-2.3\", \"0.3\"]]\nstiffness = \"1\""
        );
    }
    let _ = writeln!(
        text,
        "[[motion]]\nvelocity = [\"1\", \"0\"]\nduration = \"{teeth}\""
    );
    text
}

/// A pawl with a straight front and a round back, of `corners` corners in all, that passes the first `passed` of
/// `length` units of a row of teeth, `teeth` in all.
fn row(teeth: usize, length: usize, passed: usize, corners: usize) -> String {
    let mut text =
        String::from("[scene]\nname = \"row\"\n[[obstacle]]\nname = \"R\"\nvertices = [");
    let (n, w) = (16 * teeth, 16 * length);
    for i in 0..teeth {
        // As steep as those of the rack, whatever their size.
        let _ = write!(
            text,
            "[\"{}/{n}\", \"0\"],[\"{}/{n}\", \"{}/{n}\"],",
            i * w,
            i * w + w / 2,
            10 * length
        );
    }
    let _ = writeln!(
        text,
        "[\"{length}\", \"0\"],[\"{length}\", \"-1\"],[\"0\", \"-1\"]]"
    );
    let back = corners - 2;
    let mut at = String::new();
    for k in 0..back {
        let _ = write!(
            at,
            ",[\"-{}/1000\", \"{}/1000\"]",
            2300 + 4 * k * (back - k),
            300 + 1400 * k / back
        );
    }
    // The tip reaches halfway down the teeth.
    let tip = format!("{}/{}", 5 * length, n);
    let tip = if length == teeth { "3/10" } else { &tip };
    let _ = writeln!(
        text,
        "[[pawl]]\nname = \"p\"\nhinge = [\"-2\", \"2\"]\n\
         vertices = [[\"-2\", \"2\"], [\"-2\", \"{tip}\"]{at}]\nstiffness = \"1\"\n\
         [[motion]]\nvelocity = [\"1\", \"0\"]\nduration = \"{passed}\""
    );
    text
}

/// A long rack: as many units as teeth.
fn long_rack(teeth: usize) -> String {
    row(teeth, teeth, teeth, CORNERS)
}

/// Dense obstacles: fine teeth, all within reach as the pawl passes over eight units of them.
fn comb(teeth: usize) -> String {
    row(teeth, 8, 8, CORNERS)
}

/// A long rack, of which a tenth is within reach.
fn part_rack(teeth: usize) -> String {
    row(teeth, teeth, teeth.div_ceil(10), CORNERS)
}

/// Corners of the pawl that the long scenes have.
const CORNERS: usize = 12;

fn read(text: &str) -> SceneFile {
    match read_scene("growth", text) {
        Ok(file) => file,
        Err(why) => panic!("{why:?}"),
    }
}

/// CPU seconds of a simulation, reading apart: parsing, and the validation that makes sure of simple polygons and
/// of a clear start, belong to the reading of a file; whatever the motion needs of the obstacles does not.
fn simulated(text: &str) -> f64 {
    let file = read(text);
    seconds(|| {
        simulate(file.scene(), &Options::default()).expect("the plan can be carried out");
    })
}

/// The same by a method and an arithmetic, with what the ledger says.
fn by(file: &SceneFile, method: By, arithmetic: Arithmetic) -> (f64, Ledger) {
    let mut ledger = Ledger::default();
    let s = seconds(|| {
        let options = Options {
            method,
            arithmetic,
            ..Options::default()
        };
        let t = simulate(file.scene(), &options).expect("the plan can be carried out");
        ledger = t.ledger;
    });
    (s, ledger)
}

/// The simple algorithm as DP states it (all pairs of features, all arcs at every step, exact numbers only), the same
/// with an index of what is near and enclosures, and the sweep.
fn methods() {
    println!(
        "\n# Methods on a rack: milliseconds, by the simple algorithm bare and with an index, and by the sweep"
    );
    println!(" teeth      n    bare   index   sweep");
    let (mut bare, mut index, mut sweep) = (Vec::new(), Vec::new(), Vec::new());
    let mut crossover = None;
    for teeth in sizes(4, 2, 2048) {
        let file = read(&scene(teeth, 0, 1));
        let n = (3 * (2 * teeth + 5)) as f64;
        let a = (teeth <= 64).then(|| by(&file, By::Naive, Arithmetic::Exact).0);
        let b = by(&file, By::Naive, Arithmetic::Filtered).0;
        let c = by(&file, By::Sweep, Arithmetic::Filtered).0;
        bare.extend(a.map(|a| (n, a)));
        index.push((n, b));
        sweep.push((n, c));
        if c < b {
            crossover.get_or_insert(teeth);
        } else {
            crossover = None;
        }
        println!(
            "{teeth:6} {n:6} {:>7} {:7.2} {:7.2}",
            a.map_or("-".to_owned(), |a| format!("{:.2}", a * 1e3)),
            b * 1e3,
            c * 1e3
        );
    }
    let late = |p: &[(f64, f64)]| exponent(&p[p.len() / 2..]);
    println!(
        "bare n^{:.2}, index n^{:.2}, sweep n^{:.2} (upper halves); the sweep is ahead from {crossover:?} teeth on",
        late(&bare),
        late(&index),
        late(&sweep)
    );
}

/// Racks and combs from 10³ pairs of features on: time and memory of a whole simulation, the size of F. Memory is told
/// truly of the first family only, since what is freed stays with the process: `-- long part` runs one.
fn long_scenes(most: usize, chosen: &[String]) {
    println!(
        "\n# Scenes by the sweep, n pairs of features before culling; lambda(n)/n is about 2^alpha(n), at most 16 here"
    );
    type Family = (&'static str, fn(usize) -> String);
    let families: [Family; 3] = [
        ("rack", |n| long_rack(n / CORNERS / 2 - 1)),
        ("part", |n| part_rack(n / CORNERS / 2 - 1)),
        ("comb", |n| comb(n / CORNERS / 2 - 1)),
    ];
    let alone = |f: &Family| chosen.iter().any(|c| c == f.0);
    let any = families.iter().any(alone);
    for (name, make) in families.into_iter().filter(|f| !any || alone(f)) {
        println!(
            "{name}       n    arcs     |F|   |F|/n  us/n  build s   run s  peak MB  found by"
        );
        let (mut time, mut room) = (Vec::new(), Vec::new());
        for n in sizes(1000, 10, most) {
            let file = read(&make(n));
            let before = peak(true);
            let (mut s, mut ledger) = (f64::INFINITY, Ledger::default());
            for _ in 0..if n < 100_000 { 3 } else { 1 } {
                let from = cpu();
                let options = Options {
                    method: By::Sweep,
                    ..Options::default()
                };
                ledger = simulate(file.scene(), &options).expect("a plan").ledger;
                s = s.min(cpu() - from);
            }
            let mb = peak(false) - before;
            let p = ledger.phases[0];
            println!(
                "{name} {n:8} {:7} {:7} {:7.3} {:5.1} {:8.3} {:7.3} {mb:8.1}  {}",
                p.arcs,
                p.half_edges,
                p.half_edges as f64 / n as f64,
                s / n as f64 * 1e6,
                p.build,
                p.run,
                if p.faces.merged > 0 { "merge" } else { "walk" }
            );
            time.push((n as f64, s));
            room.push((n as f64, mb));
        }
        room.retain(|p| p.0 >= 1e4);
        println!(
            "{name}: time n^{:.3}, memory n^{:.3}",
            exponent(&time),
            exponent(&room)
        );
    }
}

/// F of a slice by the walk and by the merge.
fn ways() {
    println!("\n# F of a slice: milliseconds by the walk and by the merge, and what auto takes");
    type Family = (&'static str, fn(usize) -> String);
    let families: [Family; 3] = [("rack", long_rack), ("comb", comb), ("wheel", wheel)];
    for (name, make) in families {
        for size in sizes(16, 4, 4096) {
            let file = read(&make(size));
            let mut seen = None;
            let options = Options {
                method: By::Sweep,
                ..Options::default()
            };
            slices(file.scene(), &options, &mut |s| seen = Some(s)).expect("a plan");
            let Some((slice, free)) = seen.and_then(|s| Some((s.slice, s.free?))) else {
                println!("{name:6} {size:5}: no F");
                continue;
            };
            let mut edges = 0;
            let mut time = |way| {
                seconds(|| {
                    let f = Free::new(&*slice, free.start(), way).expect("F");
                    edges = f.half_edges();
                })
            };
            let (walk, merge) = (time(Method::Walk), time(Method::Merge));
            let auto = Free::new(&*slice, free.start(), Method::Auto)
                .expect("F")
                .found();
            println!(
                "{name:6} {size:5} {:7} arcs {edges:7} half-edges  walk {:8.2}  merge {:8.2}  ({:.2} x)  {:?}",
                slice.arcs().len(),
                walk * 1e3,
                merge * 1e3,
                merge / walk,
                auto.method
            );
        }
    }
}

/// A pawl of many corners, a star, among many small obstacles that its corners pass again and again: nearly every
/// pair of features meets somewhere, and hardly anything of it bounds F.
fn wheel(size: usize) -> String {
    let mut text = String::from("[scene]\nname = \"wheel\"\n");
    let posts = size / 8;
    for i in 0..posts {
        let _ = writeln!(
            text,
            "[[obstacle]]\nname = \"o{i}\"\nvertices = [[\"{x}/16\", \"-3\"], [\"{x}/16\", \"-1.5\"], [\"{}/16\", \"-3\"]]",
            8 * i + 1,
            x = 8 * i
        );
    }
    text.push_str("[[pawl]]\nname = \"p\"\nhinge = [\"-4\", \"0\"]\nvertices = [");
    let corners = 24;
    for k in 0..corners {
        // Around the hinge by rational points of the circle, long and short in turn.
        let (m, r) = (
            2 * k as i64 - corners as i64 + 1,
            if k % 2 == 0 { 28 } else { 12 },
        );
        let (u, d) = (m, corners as i64 / 2);
        let den = (d * d + u * u) * 10;
        let (x, y) = ((d * d - u * u) * r, 2 * u * d * r);
        let _ = write!(text, "[\"{}/{den}\", \"{y}/{den}\"],", x - 4 * den);
    }
    let _ = writeln!(
        text,
        "]\nstart = \"0\"\n[[motion]]\nvelocity = [\"1\", \"0\"]\nduration = \"{}/16\"",
        8 * posts + 128
    );
    text
}

fn scenes() {
    println!("\n# Scenes");
    let base = simulated(&scene(8, 0, 1));
    let mut points = Vec::new();
    for teeth in sizes(8, 2, 256) {
        let s = simulated(&scene(teeth, 0, 1));
        println!("{teeth:4} teeth: {:7.2} x", s / base);
        points.push((teeth as f64, s));
    }
    println!("teeth: n^{:.2}", exponent(&points));
    let mut points = Vec::new();
    for k in sizes(1, 2, 32) {
        points.push((k as f64, simulated(&scene(32, 0, k))));
    }
    let one = points[0].1;
    for (k, s) in &points {
        println!("{k:3} pawls: {:6.2} x one", s / one);
    }
    println!("pawls: k^{:.2}", exponent(&points));
}

/// Nearly all of the obstacle out of reach; the two sizes of scene in turn, so that a busy machine slows both.
fn far() {
    println!("\n# 99 % of the obstacle out of reach, reading apart");
    for teeth in [8, 32, 128, 400] {
        let [near, with] = [0, 99 * teeth].map(|far| read(&scene(teeth, far, 1)));
        let mut best = [f64::INFINITY; 2];
        for _ in 0..9 {
            for (file, best) in [&near, &with].into_iter().zip(&mut best) {
                let from = cpu();
                simulate(file.scene(), &Options::default()).expect("a plan");
                *best = best.min(cpu() - from);
            }
        }
        println!(
            "{teeth:4} teeth, {:6} out of reach: {:8.3} ms, {:.2} x",
            99 * teeth,
            best[1] * 1e3,
            best[1] / best[0]
        );
    }
}

fn main() {
    let chosen: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    let wanted = |part: &str| chosen.is_empty() || chosen.iter().any(|c| c == part);
    let most = std::env::var("GROWTH_MAX")
        .ok()
        .and_then(|m| m.parse().ok())
        .unwrap_or(100_000);
    if wanted("racks") {
        racks(most);
    }
    if wanted("lattices") {
        lattices(most.min(64_000), false);
        lattices(most.min(64_000), true);
    }
    if wanted("degenerate") {
        degenerate();
    }
    if wanted("scenes") {
        scenes();
    }
    if wanted("far") {
        far();
    }
    if wanted("methods") {
        methods();
    }
    if wanted("long") {
        long_scenes(most, &chosen);
    }
    if wanted("ways") {
        ways();
    }
}
