//! PCG64 with the seeding and the draws that NumPy's `default_rng` makes, so that a family and a
//! seed name the same structure in both worlds (O'Neill 2014, PCG XSL-RR 128/64; Lemire 2019 for
//! bounded integers). Only repeatability matters here: nothing is decided by it.

/// The generator.
pub(crate) struct Pcg64 {
    state: u128,
    increment: u128,
    /// The upper half of the last draw, where only its lower half was used.
    half: Option<u32>,
}

const MULTIPLIER: u128 = 0x2360_ED05_1FC6_5DA4_4385_DF64_9FCC_F645;

impl Pcg64 {
    /// Seeds it as `SeedSequence(seed)` does.
    pub(crate) fn new(seed: u64) -> Pcg64 {
        let words = expand(seed);
        let wide = |k: usize| (u128::from(words[k]) << 64) | u128::from(words[k + 1]);
        let mut rng = Pcg64 {
            state: 0,
            increment: (wide(2) << 1) | 1,
            half: None,
        };
        rng.advance();
        rng.state = rng.state.wrapping_add(wide(0));
        rng.advance();
        rng
    }

    fn advance(&mut self) {
        self.state = self
            .state
            .wrapping_mul(MULTIPLIER)
            .wrapping_add(self.increment);
    }

    fn next64(&mut self) -> u64 {
        self.advance();
        let folded = (self.state >> 64) as u64 ^ self.state as u64;
        folded.rotate_right((self.state >> 122) as u32)
    }

    fn next32(&mut self) -> u32 {
        if let Some(half) = self.half.take() {
            return half;
        }
        let next = self.next64();
        self.half = Some((next >> 32) as u32);
        next as u32
    }

    /// An integer from `low` to `high`, both included.
    pub(crate) fn integer(&mut self, low: i64, high: i64) -> i64 {
        let range = (high - low) as u32;
        if range == 0 {
            return low;
        }
        let count = u64::from(range) + 1;
        let mut wide = u64::from(self.next32()) * count;
        let threshold = (u64::from(u32::MAX - range) % count) as u32;
        while (wide as u32) < threshold {
            wide = u64::from(self.next32()) * count;
        }
        low + (wide >> 32) as i64
    }

    /// A double from `low` up to `high`.
    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.next64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0);
        low + (high - low) * unit
    }
}

/// `SeedSequence(seed).generate_state(4, uint64)`.
fn expand(seed: u64) -> [u64; 4] {
    const MIX: u32 = 16;
    let mut entropy = vec![seed as u32];
    if seed >> 32 != 0 {
        entropy.push((seed >> 32) as u32);
    }
    let mut constant: u32 = 0x43b0_d7e5;
    let mut hash = |value: u32| {
        let value = value ^ constant;
        constant = constant.wrapping_mul(0x931e_8875);
        let value = value.wrapping_mul(constant);
        value ^ (value >> MIX)
    };
    let mut pool = [0u32; 4];
    for (k, slot) in pool.iter_mut().enumerate() {
        *slot = hash(entropy.get(k).copied().unwrap_or(0));
    }
    for from in 0..4 {
        for to in 0..4 {
            if from != to {
                let mixed = 0xca01_f9ddu32
                    .wrapping_mul(pool[to])
                    .wrapping_sub(0x4973_f715u32.wrapping_mul(hash(pool[from])));
                pool[to] = mixed ^ (mixed >> MIX);
            }
        }
    }
    let mut constant: u32 = 0x8b51_f9dd;
    let mut words = [0u32; 8];
    for (k, word) in words.iter_mut().enumerate() {
        let value = pool[k % 4] ^ constant;
        constant = constant.wrapping_mul(0x58f3_8ded);
        let value = value.wrapping_mul(constant);
        *word = value ^ (value >> MIX);
    }
    std::array::from_fn(|k| u64::from(words[2 * k]) | (u64::from(words[2 * k + 1]) << 32))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first doubles of `default_rng(12345)`, as NumPy's own documentation prints them.
    #[test]
    fn draws_are_those_of_numpy() {
        let mut rng = Pcg64::new(12345);
        assert_eq!(rng.uniform(0.0, 1.0), 0.22733602246716966);
        assert_eq!(rng.uniform(0.0, 1.0), 0.31675833970975287);
        assert_eq!(rng.uniform(0.0, 1.0), 0.7973654573327341);
    }
}
