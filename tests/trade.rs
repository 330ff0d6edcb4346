//! `trade`: what it measures, shown on scenes whose answers are known.

#![allow(clippy::unwrap_used)]

use snapfit::kernel::Identify;
use snapfit::motion::{Arithmetic, OutcomeKind};
use snapfit::scene::{Scene, read_scene};
use snapfit::trade::family::{FAMILIES, Family, breakdown};
use snapfit::trade::score::{Happening, Observed, Verdict, score};
use snapfit::trade::stratum::{Stratum, stratum};
use snapfit::trade::table::{rates, trade};
use snapfit::trade::{Setting, map, plot};
use std::process::{Command, Output};
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(20);

fn scene(name: &str) -> Scene {
    let path = format!("papers/donald-pai-1993/scenes/{name}.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    read_scene(&path, &text).unwrap().into_scene()
}

fn happening(what: &str, time: f64) -> Happening {
    Happening {
        what: what.to_owned(),
        coarse: None,
        time,
        theta: 0.0,
    }
}

#[test]
fn a_score_tells_missed_from_spurious() {
    let result = |events: &[(&str, f64)]| Observed {
        outcome: OutcomeKind::Completed,
        pawl: None,
        events: vec![events.iter().map(|e| happening(e.0, e.1)).collect()],
    };
    let right = result(&[("strike", 1.0), ("slide", 2.0), ("release", 4.0)]);
    let got = result(&[
        ("strike", 1.0),
        ("release", 4.0 + 4.0 * f64::EPSILON),
        ("graze", 5.0),
    ]);
    let s = score(&right, Some(&got), false, false);
    assert_eq!((s.verdict, s.missed, s.spurious), (Verdict::Right, 1, 1));
    assert_eq!(s.time_ulps, 1.0);
    let none = score(&right, None, false, false);
    assert_eq!((none.verdict, none.missed), (Verdict::Undecided, 0));
    assert_eq!(score(&right, None, true, false).verdict, Verdict::Broken);
    let mut jam = got;
    jam.outcome = OutcomeKind::Jammed;
    assert_eq!(
        score(&right, Some(&jam), false, false).verdict,
        Verdict::Wrong
    );
}

#[test]
fn stepping_nears_the_truth_as_steps_shrink() {
    // One strike at t = 1 and nothing else: found one step late at most, with steps of 3/n.
    let scene = Family::named("friction").unwrap().scene(0);
    let mut frictionless = scene;
    frictionless.friction = None;
    let right = Setting::Kernel(Arithmetic::Filtered).run(&frictionless, LIMIT);
    let right = right.observed.unwrap();
    for n in [10u32, 100, 1_000] {
        let got = Setting::Stepping(n).run(&frictionless, LIMIT).observed;
        let s = score(&right, got.as_ref(), false, true);
        assert_eq!(
            (s.verdict, s.missed, s.spurious),
            (Verdict::Right, 0, 0),
            "{n}"
        );
        assert!(
            s.time_error <= 3.0 / f64::from(n) * 1.001,
            "{n}: {}",
            s.time_error
        );
    }
    // And friction holds it at once.
    let mut stuck = frictionless;
    stuck.friction = Some(snapfit::number::Rat::from(2));
    let got = Setting::Stepping(1_000)
        .run(&stuck, LIMIT)
        .observed
        .unwrap();
    assert_eq!(got.outcome, OutcomeKind::Stuck);
}

#[test]
fn strata() {
    let of = |s: &Scene| {
        let t = Setting::Kernel(Arithmetic::Filtered).run(s, LIMIT);
        stratum(s, &t.trajectory.unwrap())
    };
    assert_eq!(of(&scene("fig15-diagonal")), Stratum::ForcedDegenerate);
    assert_eq!(of(&scene("fig13-b-jam")), Stratum::Generic);
    assert_eq!(of(&FAMILIES[0].scene(60)), Stratum::ExtremeScale);
}

#[test]
fn the_families_find_out_who_cannot_see_the_gap() {
    let settings = [
        Setting::Kernel(Arithmetic::Filtered),
        Setting::Kernel(Arithmetic::Exact),
        Setting::float(1e-9, Identify::Names),
        Setting::float(1e-9, Identify::None),
    ];
    let ks: Vec<u32> = (0..=120).step_by(10).collect();
    for name in ["strike", "race", "friction"] {
        let b = breakdown(&Family::named(name).unwrap(), &ks, &settings, 1, LIMIT);
        assert_eq!(b.lies_from[..2], [None, None], "{name}");
        // 10⁻⁹ is about 2⁻³⁰; where an angle opens with the root of a gap, half of that.
        assert!(
            b.lies_from[2].is_some_and(|k| (10..=40).contains(&k)),
            "{name}: {:?}",
            b.lies_from
        );
        assert!(plot::breakdown(&b).starts_with("<svg"));
    }
}

#[test]
fn the_map_of_fig_15() {
    let layers = [
        Setting::Kernel(Arithmetic::Filtered),
        Setting::float(1e-9, Identify::None),
        Setting::float(1e-9, Identify::Names),
    ];
    let m = map::map(&scene("fig15-diagonal"), (0, 1), 12, &layers, LIMIT).unwrap();
    let first = m.layers[0].pixels[0];
    assert!(
        m.layers[0].pixels.iter().all(|p| *p == first),
        "exactly, all neighbours agree"
    );
    assert!(
        m.layers[1].differ > 0,
        "without identification doubles do not"
    );
    assert_eq!(m.layers[2].differ, 0, "with names they do");
    assert!(plot::map(&m).contains("</svg>"));
    assert!(map::map(&scene("fig15-diagonal"), (7, 1), 2, &layers, LIMIT).is_none());
}

#[test]
fn rates_count_undecided_apart() {
    let settings = [
        Setting::Kernel(Arithmetic::Filtered),
        Setting::float(1e-9, Identify::Names),
    ];
    let mut rows = vec![trade(&scene("fig15-diagonal"), &settings, 1, LIMIT).unwrap()];
    rows.push(rows[0].clone());
    rows[1].rows[1].verdict = Verdict::Undecided;
    let r = rates(&rows);
    assert_eq!(r.len(), 2);
    assert_eq!((r[1].right, r[1].wrong, r[1].undecided), (1, 0, 1));
    assert_eq!(r[1].wrong_rate[0], 0.0);
    assert!(plot::scatter(&rows, &r).contains("</svg>"));
}

fn snapfit(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_snapfit"))
        .args(args)
        .output()
        .unwrap()
}

#[test]
fn on_the_command_line() {
    let figures = "papers/donald-pai-1993/scenes";
    let done = snapfit(&["trade", figures, "--fast", "--repeat", "1"]);
    assert_eq!(done.status.code(), Some(0));
    let doc: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    for scene in doc["scenes"].as_array().unwrap() {
        let rows = scene["rows"].as_array().unwrap();
        let names = rows.iter().find(|r| r["setting"] == "f64 names").unwrap();
        assert_eq!(names["verdict"], "right", "{scene}");
    }
    for bad in [
        &["trade"][..],
        &["trade", "--breakdown", "hopes"],
        &["trade", "no-such.toml"],
    ] {
        assert_eq!(snapfit(bad).status.code(), Some(2), "{bad:?}");
    }
}
