//! The snap-fit handbook's formula beside the model: its example, its table, and where a hook locks.

use super::{asked, ends, middle, scene};
use snapfit::analysis::{Ask, Wish, forces};
use snapfit::number::Rat;
use snapfit::scene::Scene;

/// Bayer's Example I: the torque balance of a rigid arm, W = P·(sin α + μ cos α)/(cos(α ∓ θ) ∓
/// μ sin(α ∓ θ))…, beside the handbook's factor.
#[test]
fn the_handbooks_example_parts_by_the_arms_turn() {
    let doc = asked(&scene("examples/bayer-hook.toml"), 9, 0);
    let (mu, k, l) = (0.6, 4876.0, 19.0);
    let theta = (2.4f64 / 19.0).asin();
    let p = k * theta / l;
    let exact = |a: f64, sign: f64| {
        let turned = a + sign * theta;
        p * (a.sin() + mu * a.cos()) / (turned.cos() - mu * turned.sin())
    };
    let slopes = [15.0f64 / 26.0, 1.0].map(f64::atan);
    let find = |phase: usize, tan: &str| {
        let mut all = doc.pawls[0].segments.iter().filter(|s| s.phase == phase);
        let s = all.find(|s| {
            s.handbook
                .as_ref()
                .is_some_and(|h| h.slope.as_deref() == Some(tan))
        });
        s.unwrap().handbook.clone().unwrap()
    };
    let (there, back) = (find(0, "15/26"), find(1, "1"));
    for (h, want, factor, tan) in [
        (&there, exact(slopes[0], -1.0), "9/5", slopes[0].tan()),
        (&back, exact(slopes[1], 1.0), "4", 1.0),
    ] {
        assert_eq!(h.factor.as_deref(), Some(factor));
        let formula = p * (mu + tan) / (1.0 - mu * tan);
        assert!((middle(h.formula.as_ref().unwrap()) / formula - 1.0).abs() < 1e-8);
        assert!(
            (middle(h.model.as_ref().unwrap()) / want - 1.0).abs() < 1e-8,
            "{h:?} {want}"
        );
        assert!(!h.parts.is_empty());
    }
    // The table of the field: 1.477 in, 8.218 out, in units of P (its slope in is 30°).
    assert!((middle(there.model.as_ref().unwrap()) / p - 1.477).abs() < 0.002);
    assert!((middle(back.model.as_ref().unwrap()) / p - 8.218).abs() < 0.002);
    // By the steep hook the formula still lets go, and the model does not.
    let steep = asked(&scene("examples/bayer-hook-steep.toml"), 6, 0);
    assert_eq!(steep.outcome, "stuck");
    let held = steep.root.unwrap().phases.pop().unwrap();
    let held = held.peak.unwrap();
    assert_eq!(ends(&held.resistance), None);
    assert!(ends(&held.help).is_some());
}

/// Bayer's hook with other slopes: in by `tan_in`, out by `tan_out`.
pub(crate) fn bayer(tan_in: &Rat, tan_out: &Rat, mu: &Rat) -> Scene {
    let mut s = scene("examples/bayer-hook.toml");
    s.friction = Some(mu.clone());
    let catch = &mut s.obstacles[0].vertices;
    let tip = catch[5].y.clone();
    let wide = Rat::frac(29, 10);
    catch[4].y = &tip + &(&wide / tan_in);
    catch[6].y = &tip - &(&wide / tan_out);
    s
}

/// The whole table of the handbook's formula beside the model, W in units of kθ/L at the full
/// deflection: slope, μ, the handbook's value, the model's way in and way out.
#[test]
fn the_handbooks_table_is_found_again() {
    let p = 4876.0 * (2.4f64 / 19.0).asin() / 19.0;
    for (tan, mu, handbook, into, out) in [
        ("0.577350", "0.6", 1.801, 1.477, 2.356),
        ("1", "0.6", 4.000, 2.672, 8.218),
        ("1.191754", "0.6", 6.288, 3.520, 31.80),
        ("1", "0.3", 1.857, 1.514, 2.452),
        ("1", "0.2", 1.500, 1.270, 1.869),
    ] {
        let read = |text: &str| snapfit::number::literal::parse(text).unwrap();
        let slope = read(tan);
        let doc = asked(&bayer(&slope, &slope, &read(mu)), 9, 0);
        for (phase, model) in [(0, into), (1, out)] {
            let found = doc.pawls[0].segments.iter().find_map(|s| {
                let h = s.handbook.as_ref()?;
                let here = s.phase == phase && h.slope.as_deref() == Some(&slope.to_string());
                // The steeper way: on the other face the pawl is let down, not lifted.
                (here && middle(h.model.as_ref()?) > 0.0).then(|| h.clone())
            });
            let h = found.unwrap();
            let [w, m] = [&h.formula, &h.model].map(|b| middle(b.as_ref().unwrap()) / p);
            assert!((w / handbook - 1.0).abs() < 5e-4, "{tan} {mu}: {w}");
            assert!((m / model - 1.0).abs() < 5e-4, "{tan} {mu} {phase}: {m}");
        }
    }
}

/// The band in which the handbook lets go and the model holds: from cot(φ + θ) = 1.2698 (51.78°),
/// not from 1/μ (59.04°) on.
#[test]
fn removal_locks_earlier_than_the_handbook_says() {
    let mu = Rat::frac(3, 5);
    for (tan, outcome) in [
        (Rat::frac(12697, 10_000), "completed"),
        (Rat::frac(12699, 10_000), "stuck"),
        (Rat::frac(16, 10), "stuck"),
    ] {
        let s = bayer(&Rat::frac(15, 26), &tan, &mu);
        let doc = forces(&s, &Wish::default(), &Ask::default()).unwrap();
        assert_eq!(doc.outcome, outcome, "{tan}");
    }
}
