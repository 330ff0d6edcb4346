//! What several test files share.

/// How often a random test runs: its nominal count times `TEST_MULT` (default 0.01), at least
/// once. `TEST_MULT=1` is the full strength.
pub fn count(nominal: usize) -> usize {
    let mult = std::env::var("TEST_MULT")
        .ok()
        .and_then(|text| text.parse::<f64>().ok())
        .unwrap_or(0.01);
    ((nominal as f64 * mult) as usize).max(1)
}
