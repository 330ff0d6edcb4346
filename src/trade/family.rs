//! Families of scenes with one gap that closes: 2⁻ᵏ from an exact coincidence.
//!
//! Each says how the scene would change if the gap were taken for zero or crossed, so a setting
//! that cannot see the gap is found out.

use super::score::{Observed, Verdict, score};
use super::setting::{Outcome, Setting};
use crate::scene::{Scene, read_scene};
use serde::Serialize;
use std::time::Duration;

/// A family: its name, what closes, and the scene with `@GAP@` where the gap goes.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Its name.
    pub name: &'static str,
    /// What the gap is.
    pub about: &'static str,
    template: &'static str,
}

/// All families.
pub const FAMILIES: [Family; 5] = [
    Family {
        name: "strike",
        about: "a tip comes down on a floor, the gap beside the point under its hinge: it gives \
                way to that side, and at no gap either way is open",
        template: r#"
[scene]
name = "strike"
[[obstacle]]
name = "floor"
vertices = [["-40", "-1"], ["40", "-1"], ["40", "0"], ["-40", "0"]]
[[pawl]]
name = "p"
hinge = ["0", "6"]
vertices = [["@GAP@", "1"], ["1", "4"], ["0", "6"], ["-1", "4"]]
[[motion]]
velocity = ["0", "-1"]
duration = "2"
"#,
    },
    Family {
        name: "race",
        about: "two corners of a pawl meet two floors, one of them higher by the gap: the second \
                contact jams what the first has begun to turn",
        template: r#"
[scene]
name = "race"
[[obstacle]]
name = "left"
vertices = [["-6", "-1"], ["-1", "-1"], ["-1", "0"], ["-6", "0"]]
[[obstacle]]
name = "right"
vertices = [["1", "-1"], ["6", "-1"], ["6", "@GAP@"], ["1", "@GAP@"]]
[[pawl]]
name = "p"
hinge = ["0", "6"]
vertices = [["-3", "2"], ["3", "2"], ["0", "6"]]
[[motion]]
velocity = ["0", "-1"]
duration = "3"
"#,
    },
    Family {
        name: "pass",
        about: "a tip passes over a block, higher than it by the gap: no contact at all",
        template: r#"
[scene]
name = "pass"
[[obstacle]]
name = "block"
vertices = [["3", "-1"], ["5", "-1"], ["5", "0"], ["3", "0"]]
[[pawl]]
name = "p"
hinge = ["0", "6"]
vertices = [["-1", "@GAP@"], ["1", "4"], ["0", "6"]]
[[motion]]
velocity = ["1", "0"]
duration = "10"
"#,
    },
    Family {
        name: "friction",
        about: "μ above the critical 3/4 by the gap: the landing sticks, at no gap it slides",
        template: r#"
[scene]
name = "friction"
friction = "@3/4+GAP@"
[[obstacle]]
name = "floor"
vertices = [["-40", "-1"], ["40", "-1"], ["40", "0"], ["-40", "0"]]
[[pawl]]
name = "p"
hinge = ["0", "6"]
vertices = [["3", "2"], ["4", "4"], ["0", "6"]]
[[motion]]
velocity = ["0", "-1"]
duration = "3"
"#,
    },
    Family {
        name: "parallel",
        about: "a tip that touches slides along a floor, which it nears by the gap per length: \
                driven for as long as the gap is there",
        template: r#"
[scene]
name = "parallel"
[[obstacle]]
name = "floor"
vertices = [["-40", "-1"], ["40", "-1"], ["40", "0"], ["-40", "0"]]
[[pawl]]
name = "p"
hinge = ["0", "6"]
vertices = [["2", "0"], ["3", "4"], ["0", "6"]]
[[motion]]
velocity = ["1", "@-GAP@"]
duration = "4"
"#,
    },
];

impl Family {
    /// The family of a name.
    pub fn named(name: &str) -> Option<Family> {
        FAMILIES.into_iter().find(|f| f.name == name)
    }
    /// The scene with the gap 2⁻ᵏ.
    pub fn scene(&self, k: u32) -> Scene {
        let power = crate::number::Int::one().shl(u64::from(k));
        let more = &power * &crate::number::Int::from(3i64) + crate::number::Int::from(4i64);
        let four = power.shl(2);
        let text = self
            .template
            .replace("@GAP@", &format!("1/{power}"))
            .replace("@-GAP@", &format!("-1/{power}"))
            .replace("@3/4+GAP@", &format!("{more}/{four}"));
        match read_scene(self.name, &text) {
            Ok(file) => file.into_scene(),
            // A template of this file with a power of two put in, whatever k is.
            Err(e) => unreachable!("the families are scenes: {e:?}"),
        }
    }
}

/// What the settings made of one gap.
#[derive(Clone, Debug, Serialize)]
pub struct Gap {
    /// The gap is 2⁻ᵏ.
    pub k: u32,
    /// One a setting.
    pub cells: Vec<Cell>,
}

/// What one setting made of one gap.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// `right`, `wrong`, `events` (right verdict, wrong events), `undecided` or `broken`.
    pub verdict: &'static str,
    /// CPU seconds, the least of the repetitions.
    pub seconds: f64,
}

/// Where the settings start to lie.
#[derive(Clone, Debug, Serialize)]
pub struct Breakdown {
    /// The family.
    pub family: String,
    /// The settings.
    pub settings: Vec<String>,
    /// The k from which each is not right, null if it never lies: the right k before it is its
    /// neighbour, found by halving between the k that were tried.
    pub lies_from: Vec<Option<u32>>,
    /// One entry a k.
    pub gaps: Vec<Gap>,
}

/// What is right about a scene: what the first of the usual settings, which proves it, sees.
fn reference(scene: &Scene, limit: Duration) -> Option<Observed> {
    Setting::usual(0.0)[0].run(scene, limit).observed
}

/// What a setting's run is worth, in a word.
fn verdict(setting: &Setting, right: &Observed, run: &Outcome) -> &'static str {
    let coarsely = matches!(setting, Setting::Stepping(_));
    let sc = score(right, run.observed.as_ref(), run.broke, coarsely);
    match sc.verdict {
        Verdict::Right if sc.missed + sc.spurious > 0 => "events",
        Verdict::Right => "right",
        Verdict::Wrong => "wrong",
        Verdict::Undecided => "undecided",
        Verdict::Broken => "broken",
    }
}

/// Closes the gap over the given k, which ascend.
pub fn breakdown(
    family: &Family,
    ks: &[u32],
    settings: &[Setting],
    repeat: usize,
    limit: Duration,
) -> Breakdown {
    let mut gaps: Vec<Gap> = Vec::new();
    for &k in ks {
        let scene = family.scene(k);
        let Some(right) = reference(&scene, limit) else {
            continue;
        };
        let cells = settings
            .iter()
            .map(|s| {
                let first = s.run(&scene, limit);
                let verdict = verdict(s, &right, &first);
                let mut seconds = first.seconds;
                for _ in 1..repeat {
                    seconds = seconds.min(s.run(&scene, limit).seconds);
                }
                Cell { verdict, seconds }
            })
            .collect();
        gaps.push(Gap { k, cells });
    }
    let lies_at = |s: &Setting, k: u32| {
        let scene = family.scene(k);
        reference(&scene, limit)
            .is_some_and(|right| verdict(s, &right, &s.run(&scene, limit)) != "right")
    };
    let lies_from = settings
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let first = gaps.iter().position(|g| g.cells[i].verdict != "right")?;
            let mut wrong = gaps[first].k;
            let Some(before) = first.checked_sub(1) else {
                return Some(wrong);
            };
            let mut right = gaps[before].k;
            while wrong - right > 1 {
                let middle = right + (wrong - right) / 2;
                if lies_at(s, middle) {
                    wrong = middle;
                } else {
                    right = middle;
                }
            }
            Some(wrong)
        })
        .collect();
    Breakdown {
        family: family.name.to_owned(),
        settings: settings.iter().map(Setting::name).collect(),
        lies_from,
        gaps,
    }
}

impl Breakdown {
    /// As text.
    pub fn table(&self) -> String {
        use std::fmt::Write;
        let mut out = format!("{}: gap 2^-k\n", self.family);
        let least = |i: usize, from: u32, to: u32| {
            let inside = self.gaps.iter().filter(|g| (from..=to).contains(&g.k));
            let s = inside.map(|g| g.cells[i].seconds).fold(f64::NAN, f64::min);
            format!("{:.1} µs", s * 1e6)
        };
        let _ = writeln!(
            out,
            "  {:<15} {:>10} {:>12} {:>12} {:>12}",
            "setting", "lies from", "k ≤ 10", "k ≤ 100", "k ≥ 900"
        );
        for (i, name) in self.settings.iter().enumerate() {
            let from = self.lies_from[i].map_or("never".to_owned(), |k| format!("k = {k}"));
            let _ = writeln!(
                out,
                "  {name:<15} {from:>10} {:>12} {:>12} {:>12}",
                least(i, 0, 10),
                least(i, 11, 100),
                least(i, 900, u32::MAX)
            );
        }
        out
    }
}
