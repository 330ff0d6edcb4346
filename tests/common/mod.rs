//! How many random cases a test runs.

#[allow(dead_code, unreachable_pub)]
/// The nominal count times the environment variable TEST_MULT (by default 1/100), at least one.
pub fn count(nominal: usize) -> usize {
    let factor = std::env::var("TEST_MULT")
        .ok()
        .and_then(|v| v.parse::<f64>().ok())
        .unwrap_or(0.01);
    ((nominal as f64 * factor) as usize).max(1)
}
