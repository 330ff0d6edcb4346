//! What the test crates share: how many random cases a test runs, a plain random source, scenes
//! as text, generators and the brute-force oracle.
#![allow(dead_code, clippy::unwrap_used)]

pub mod follow;
pub mod oracle;
pub mod rng;
pub mod scenes;
pub mod shrink;
pub mod text;

/// The nominal count times the environment variable TEST_MULT (by default 1/100), at least one.
pub fn count(nominal: usize) -> usize {
    let factor = std::env::var("TEST_MULT")
        .ok()
        .and_then(|v| v.parse::<f64>().ok())
        .unwrap_or(0.01);
    ((nominal as f64 * factor) as usize).max(1)
}

/// The seed at which random tests begin: TEST_SEED, by default 1.
pub fn first_seed() -> u64 {
    std::env::var("TEST_SEED")
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(1)
}
