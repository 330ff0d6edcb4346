//! What the oracle's, the random and the metamorphic tests share: a plain random source,
//! generators, scenes as text, the brute-force oracle.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

pub mod compare;
pub mod follow;
pub mod oracle;
pub mod rng;
pub mod scenes;

/// The seed at which random tests begin: TEST_SEED, by default 1.
pub fn first_seed() -> u64 {
    std::env::var("TEST_SEED")
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(1)
}
