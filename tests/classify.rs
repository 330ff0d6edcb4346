//! Verdicts: the relative class of the paper's figures and of the handbook's hooks, critical
//! friction against simulation, and what verdicts may not depend on.

use snapfit::analysis::classify::{Ask, Verdict, relative};
use snapfit::scene::{Scene, read_scene};

fn scene(text: &str) -> Scene {
    match read_scene("scene.toml", text) {
        Ok(file) => file.scene().clone(),
        Err(e) => panic!("{e:?}"),
    }
}

const ASK: Ask = Ask {
    deadline: None,
    critical: true,
};

#[test]
fn figures() {
    let dir = std::env::var("FIGS").unwrap();
    let mut names: Vec<_> = std::fs::read_dir(dir).unwrap().map(|e| e.unwrap().path()).collect();
    names.sort();
    for p in names {
        let s = scene(&std::fs::read_to_string(&p).unwrap());
        if s.classify.is_none() { continue; }
        let t = std::time::Instant::now();
        let r = relative(&s, &ASK).unwrap();
        println!("{:?} {:?} {:?}", p.file_name().unwrap(), r.class.map(Verdict::name), t.elapsed());
        for d in &r.directions {
            println!("   {:?} {:?} t={} peak={:?} crit={:?}", d.verdict, d.run.outcome.kind, d.run.outcome.time.interval().lo,
                d.peak.as_ref().map(|p| match &p.0.peak { snapfit::analysis::peak::Peak::Within(a,b)=> (a.nearest_f64(), b.nearest_f64()), _=>(None,None)}), d.critical.as_ref().map(|c| (c.0.nearest_f64(), c.0.minimal_polynomial().to_string())));
        }
        println!("   forward crit {:?}", r.critical_forward.map(|c| c.nearest_f64()));
    }
}
