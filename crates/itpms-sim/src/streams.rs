//! Random numbers: one seed per drive, an independent generator for every purpose in it.
//!
//! Called by everything random in this crate. A road does not change when a sensor gets noisier, nor a sensor's noise when another corner
//! is added: each draws from a generator of its own, derived from the drive's seed, the purpose and two indices.

use rand::SeedableRng;
use rand_pcg::Pcg64;

/// Purposes of the random numbers. The values are part of a seed's meaning: do not renumber.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Purpose {
    /// Fourier coefficients of a road.
    Road = 1,
    SensorNoise = 2,
    /// Lost samples of a sensor.
    Dropout = 3,
    Clock = 4,
    PressureNoise = 5,
    /// The incoherent part of a line beside a track.
    RoadBeside = 6,
    /// Where a wheel's imbalance is when a drive starts.
    Imbalance = 7,
    Journey = 8,
    Fault = 9,
    /// How a car differs from its vehicle file.
    Tolerance = 10,
    /// How a car's wheels and their sensors differ from another's.
    WheelCar = 11,
    /// What disturbs wheel speeds on a drive, and the messages that are lost.
    WheelSpeeds = 12,
    /// How tires warm up on a journey.
    WarmUp = 13,
    /// Surfaces and strips under the wheels.
    WheelConditions = 14,
    /// Conditions of a drive, and of a car, that are drawn.
    DrawnConditions = 15,
}

/// A generator for one purpose; `index` tells apart sides, segments and blocks of a road, corners and sensors.
pub(crate) fn generator(seed: u64, purpose: Purpose, index: [u64; 2]) -> Pcg64 {
    let mut state = seed;
    for word in [purpose as u64, index[0], index[1]] {
        state = splitmix64(state ^ splitmix64(word));
    }
    let mut bytes = [0u8; 32];
    for chunk in bytes.chunks_exact_mut(8) {
        state = splitmix64(state);
        chunk.copy_from_slice(&state.to_le_bytes());
    }
    Pcg64::from_seed(bytes)
}

/// The output function of SplitMix64 (Steele, Lea and Flood 2014): a bijection whose every output bit depends on
/// every input bit, so that neighbouring seeds and indices lead to unrelated states.
fn splitmix64(x: u64) -> u64 {
    let z = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn splitmix_matches_the_published_sequence() {
        // First outputs of SplitMix64 seeded with 1234567, as published with the reference implementation.
        let gamma = 0x9e37_79b9_7f4a_7c15u64;
        let out: Vec<u64> =
            (0..3).map(|i| splitmix64(1_234_567u64.wrapping_add(gamma.wrapping_mul(i)))).collect();
        assert_eq!(out, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn every_purpose_and_index_has_its_own_stream() {
        let mut first = Vec::new();
        for seed in [0, 1] {
            use Purpose::*;
            let sensors = [SensorNoise, Dropout, Clock, PressureNoise, Fault];
            let roads = [Road, RoadBeside, Imbalance, Journey, Tolerance];
            let wheels = [WheelCar, WheelSpeeds, WarmUp, WheelConditions, DrawnConditions];
            for purpose in [sensors, roads, wheels].concat() {
                for index in [[0, 0], [0, 1], [1, 0]] {
                    first.push(generator(seed, purpose, index).next_u64());
                    assert_eq!(first.last(), Some(&generator(seed, purpose, index).next_u64()));
                }
            }
        }
        let count = first.len();
        first.sort_unstable();
        first.dedup();
        assert_eq!(first.len(), count);
    }
}
