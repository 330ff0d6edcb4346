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

#[test]
fn debug_dump() {
    use snapfit::analysis::{escape::*, stretch::stretches};
    let p = std::env::var("FIGS").unwrap() + "/fig7E.toml";
    let s = scene(&std::fs::read_to_string(p).unwrap());
    let r = relative(&s, &ASK).unwrap();
    let g = Ground::new(&s, None);
    let run = &r.directions[0].run;
    for e in &run.pawls[0].events { println!("EV {:?} t={} x={:?} h={} to={:?} {:?}", e.kind, e.time.interval().lo, e.angle.x.nearest_f64(), e.angle.half_turn, e.to.as_ref().map(|a| a.x.nearest_f64()), e.contacts); }
    for s in &run.pawls[0].segments { println!("SEG {} {} {:?}", s.from.interval().lo, s.to.interval().lo, s.sliding.as_ref().map(|x| (x.contact, x.branch))); }
    for st in stretches(&s, &g.shapes, &g.obstacles, run) {
        println!("ST t {} {} x {:?} {:?} h {} side {} {:?}", st.t[0].interval().lo, st.t[1].interval().lo, st.x[0].nearest_f64(), st.x[1].nearest_f64(), st.half_turn, st.side, st.contact);
        println!("   {:?}", snapfit::analysis::peak::force(&st, s.pawls[0].stiffness.as_ref().unwrap(), s.friction.as_ref().unwrap(), 30).peak);
    }
}
