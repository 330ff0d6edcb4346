//! The table: one row a setting, for a scene or for a stratum of many.

use super::score::{Score, Verdict, score, wilson};
use super::setting::Setting;
use super::stratum::{Stratum, stratum};
use crate::scene::Scene;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Duration;

/// One setting on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The setting.
    pub setting: String,
    /// What became of the verdict.
    #[serde(serialize_with = "verdict")]
    pub verdict: Verdict,
    /// CPU seconds of the simulation alone, the least of the repetitions.
    pub seconds: f64,
    /// By how much the resident memory peaked, KiB, in the first repetition; null where the system
    /// does not tell.
    pub memory_kib: Option<u64>,
    /// Events of the reference that are missing.
    pub missed: usize,
    /// Events that the reference does not have.
    pub spurious: usize,
    /// Worst error of a time, in units of the last place.
    pub time_ulps: Option<f64>,
    /// Worst error of an orientation, likewise.
    pub angle_ulps: Option<f64>,
}

/// A scene under all settings.
#[derive(Clone, Debug, Serialize)]
pub struct SceneRows {
    /// Its name.
    pub scene: String,
    /// What kind it is.
    pub stratum: Stratum,
    /// One row a setting.
    pub rows: Vec<Row>,
}

/// One setting over a stratum.
#[derive(Clone, Debug, Serialize)]
pub struct Rates {
    /// The stratum.
    pub stratum: Stratum,
    /// The setting.
    pub setting: String,
    /// How many scenes.
    pub scenes: usize,
    /// Right verdicts.
    pub right: usize,
    /// Wrong ones.
    pub wrong: usize,
    /// None within the limits; no wrong answer.
    pub undecided: usize,
    /// Broken down; no answer either.
    pub broken: usize,
    /// The rate of wrong verdicts among those given, with its 95 % Wilson bounds.
    pub wrong_rate: [f64; 2],
    /// Missed and spurious events, all scenes together.
    pub missed: usize,
    /// See `missed`.
    pub spurious: usize,
    /// The median over the scenes of the seconds.
    pub seconds: f64,
    /// The median of the worst error of a time, in units of the last place.
    pub time_ulps: f64,
    /// Whether no other setting is both faster and wrong less often (at equal rates: nearer).
    pub pareto: bool,
}

fn verdict<S: Serializer>(v: &Verdict, s: S) -> Result<S::Ok, S::Error> {
    s.serialize_str(word(*v))
}

fn word(v: Verdict) -> &'static str {
    match v {
        Verdict::Right => "right",
        Verdict::Wrong => "wrong",
        Verdict::Undecided => "undecided",
        Verdict::Broken => "broken",
    }
}

/// Runs a scene under the settings, each `repeat` times. None where the reference itself is
/// undecided within the limit.
pub fn trade(
    scene: &Scene,
    settings: &[Setting],
    repeat: usize,
    limit: Duration,
) -> Option<SceneRows> {
    let reference = Setting::usual(0.0)[0].run(scene, limit);
    let (trajectory, right) = (reference.trajectory?, reference.observed?);
    let rows = settings
        .iter()
        .map(|setting| {
            let first = setting.run(scene, limit);
            let coarsely = matches!(setting, Setting::Stepping(_));
            let s: Score = score(&right, first.observed.as_ref(), first.broke, coarsely);
            let mut seconds = first.seconds;
            if first.observed.is_some() {
                for _ in 1..repeat {
                    seconds = seconds.min(setting.run(scene, limit).seconds);
                }
            }
            let answered = matches!(s.verdict, Verdict::Right | Verdict::Wrong);
            Row {
                setting: setting.name(),
                verdict: s.verdict,
                seconds,
                memory_kib: first.memory,
                missed: s.missed,
                spurious: s.spurious,
                time_ulps: answered.then_some(s.time_ulps),
                angle_ulps: answered.then_some(s.angle_ulps),
            }
        })
        .collect();
    Some(SceneRows {
        scene: scene.name.clone(),
        stratum: stratum(scene, &trajectory),
        rows,
    })
}

/// The rates per stratum and setting, in that order.
pub fn rates(scenes: &[SceneRows]) -> Vec<Rates> {
    let mut groups: BTreeMap<(Stratum, usize), Vec<&Row>> = BTreeMap::new();
    for s in scenes {
        for (k, row) in s.rows.iter().enumerate() {
            groups.entry((s.stratum, k)).or_default().push(row);
        }
    }
    let mut out: Vec<Rates> = groups
        .iter()
        .map(|((stratum, _), rows)| {
            let count = |v: Verdict| rows.iter().filter(|r| r.verdict == v).count();
            let (right, wrong) = (count(Verdict::Right), count(Verdict::Wrong));
            let (lo, hi) = wilson(wrong, right + wrong);
            Rates {
                stratum: *stratum,
                setting: rows[0].setting.clone(),
                scenes: rows.len(),
                right,
                wrong,
                undecided: count(Verdict::Undecided),
                broken: count(Verdict::Broken),
                wrong_rate: [lo, hi],
                missed: rows.iter().map(|r| r.missed).sum(),
                spurious: rows.iter().map(|r| r.spurious).sum(),
                seconds: median(rows.iter().map(|r| r.seconds)),
                time_ulps: median(rows.iter().filter_map(|r| r.time_ulps)),
                pareto: true,
            }
        })
        .collect();
    let rate = |r: &Rates| r.wrong as f64 / (r.right + r.wrong).max(1) as f64;
    for i in 0..out.len() {
        let (a, rest) = (&out[i], &out);
        let beaten = rest.iter().any(|b| {
            b.stratum == a.stratum
                && b.seconds < a.seconds
                && (rate(b), b.time_ulps) <= (rate(a), a.time_ulps)
        });
        out[i].pareto = !beaten;
    }
    out
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut v: Vec<f64> = values.collect();
    v.sort_by(f64::total_cmp);
    v.get(v.len() / 2).copied().unwrap_or(0.0)
}

/// A number of seconds for people.
fn time(s: f64) -> String {
    match s {
        s if s >= 1.0 => format!("{s:.2} s"),
        s if s >= 1e-3 => format!("{:.2} ms", s * 1e3),
        s => format!("{:.1} µs", s * 1e6),
    }
}

fn ulps(u: Option<f64>) -> String {
    match u {
        None => "–".to_owned(),
        Some(u) if u < 1e5 => format!("{u:.0}"),
        Some(u) => format!("{u:.1e}"),
    }
}

/// The rows of each scene as text.
pub fn scene_table(scenes: &[SceneRows]) -> String {
    let mut out = String::new();
    for s in scenes {
        let stratum = serde_json::to_value(s.stratum).unwrap_or_default();
        let _ = writeln!(
            out,
            "{} ({})",
            s.scene,
            stratum.as_str().unwrap_or_default()
        );
        let _ = writeln!(
            out,
            "  {:<15} {:>10} {:>10} {:>10} {:>7} {:>9} {:>10} {:>10}",
            "setting", "verdict", "time", "memory", "missed", "spurious", "time ulps", "angle ulps"
        );
        for r in &s.rows {
            let memory = r.memory_kib.map_or("–".to_owned(), |m| format!("{m} KiB"));
            let _ = writeln!(
                out,
                "  {:<15} {:>10} {:>10} {:>10} {:>7} {:>9} {:>10} {:>10}",
                r.setting,
                word(r.verdict),
                time(r.seconds),
                memory,
                r.missed,
                r.spurious,
                ulps(r.time_ulps),
                ulps(r.angle_ulps)
            );
        }
    }
    out
}

/// The rates as text.
pub fn rates_table(rates: &[Rates]) -> String {
    let mut out = String::new();
    let mut last = None;
    for r in rates {
        if last != Some(r.stratum) {
            last = Some(r.stratum);
            let stratum = serde_json::to_value(r.stratum).unwrap_or_default();
            let _ = writeln!(
                out,
                "{}, {} scenes",
                stratum.as_str().unwrap_or_default(),
                r.scenes
            );
            let _ = writeln!(
                out,
                "  {:<15} {:>6} {:>6} {:>9} {:>6}  {:<17} {:>7} {:>8} {:>10} {:>10}  Pareto",
                "setting",
                "right",
                "wrong",
                "undecided",
                "broken",
                "wrong, 95 %",
                "missed",
                "spurious",
                "time",
                "time ulps"
            );
        }
        let _ = writeln!(
            out,
            "  {:<15} {:>6} {:>6} {:>9} {:>6}  {:<17} {:>7} {:>8} {:>10} {:>10}  {}",
            r.setting,
            r.right,
            r.wrong,
            r.undecided,
            r.broken,
            format!(
                "{:.2} … {:.2} %",
                100.0 * r.wrong_rate[0],
                100.0 * r.wrong_rate[1]
            ),
            r.missed,
            r.spurious,
            time(r.seconds),
            ulps(Some(r.time_ulps)),
            if r.pareto { "*" } else { "" }
        );
    }
    out
}
