//! CPU seconds from parsed arcs to the face, by walking and by merging: the best of five runs. Skips loudly
//! without the sets of arcs. CGAL's figures, for the ratio, come from its own harness run beside this one:
//! `FACE_PEER="S3200=1.2 C3200=2.6" cargo bench --bench face`.

use snapfit::face::{ArcFile, Method, face};
use std::path::PathBuf;

fn cpu() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

fn main() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data/arcs");
    let peers = std::env::var("FACE_PEER").unwrap_or_default();
    let sets = [
        "S3200",
        "C3200",
        "D3200",
        "FF3200",
        "G800",
        "deg_generic_1024",
        "deg_overlap_256",
        "deg_common_256",
    ];
    let more = [
        "deg_commonalg_256",
        "deg_tangent_256",
        "deg_tangall_256",
        "deg_near_256",
    ];
    println!(
        "{:18} {:>6} {:>7} {:>10} {:>10}  peer over each",
        "set", "arcs", "edges", "walk s", "merge s"
    );
    for name in sets.iter().chain(&more) {
        let path = folder.join(format!("{name}.arcs.gz"));
        let Ok(file) = ArcFile::open(&path) else {
            eprintln!("SKIPPED: {} is not here", path.display());
            continue;
        };
        let mut edges = 0;
        let best = [Method::Walk, Method::Merge].map(|method| {
            let mut least = f64::INFINITY;
            for _ in 0..5 {
                let from = cpu();
                match face(&file.arcs, &file.start, method) {
                    Ok(a) => edges = a.half_edges,
                    Err(e) => eprintln!("{name}: {e}"),
                }
                least = least.min(cpu() - from);
            }
            least
        });
        let peer = peers
            .split(' ')
            .find_map(|p| p.strip_prefix(&format!("{name}="))?.parse::<f64>().ok());
        let ratio = peer.map_or(String::new(), |p| {
            format!("{:.0} {:.0}", p / best[0], p / best[1])
        });
        println!(
            "{name:18} {:6} {edges:7} {:10.5} {:10.5}  {ratio}",
            file.arcs.len(),
            best[0],
            best[1]
        );
    }
}
