//! Any bits at all as time, speed and accelerations: no panic, nothing believed that is not finite, and a clean drive
//! afterwards brings the estimate back.

use std::sync::LazyLock;

use itpms_core::Real;
use itpms_core::estimator::Estimator;
use itpms_core::model::CornerEstimate;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::common::quarter_plant::Random;
use crate::common::ride::{Ride, Row, estimator, feed};

const RATE_HZ: f64 = 500.0;
/// Clean seconds after the garbage.
const CLEAN_S: f64 = 15.0;

static ROWS: LazyLock<Vec<Row>> = LazyLock::new(|| Ride { seconds: 2.0 + CLEAN_S, ..Ride::new(5) }.rows());

/// One row's damage: which fields are replaced, by bits or by a number in range.
#[derive(Debug, Clone)]
struct Damage {
    mask: u8,
    bits: [u64; 4],
}

fn damage() -> impl Strategy<Value = Vec<Damage>> {
    let one = (any::<u8>(), any::<[u64; 4]>()).prop_map(|(mask, bits)| Damage { mask, bits });
    prop::collection::vec(one, 200..600)
}

impl Damage {
    /// Field `i` of the row: as it is, any bits, or anything that passes for an acceleration. Three out of four times
    /// are left alone, as otherwise hardly a row would follow another.
    fn field<T: Real>(&self, i: usize, sane: f64, from_bits: fn(u64) -> T) -> T {
        let replaced = self.mask & (1 << i) != 0 && (i > 0 || self.bits[0].is_multiple_of(4));
        if !replaced {
            T::lit(sane)
        } else if self.mask & (16 << i) != 0 {
            from_bits(self.bits[i])
        } else {
            T::lit((self.bits[i] % 2001) as f64 - 1000.0)
        }
    }

    fn feed<T: Real>(&self, to: &mut Estimator<T>, row: &Row, from_bits: fn(u64) -> T) -> CornerEstimate<T> {
        to.update(
            self.field(0, row.time_s, f64::from_bits),
            self.field(1, row.speed_m_s, from_bits),
            self.field(2, row.body, from_bits),
            self.field(3, row.wheel, from_bits),
        )
    }
}

fn finite_or_not_believed<T: Real>(estimate: &CornerEstimate<T>) {
    let numbers = [
        estimate.pressure_kpa,
        estimate.pressure_sd_kpa,
        estimate.stiffness_n_per_m,
        estimate.stiffness_sd_n_per_m,
        estimate.diagnostics.pressure_variance_kpa2,
    ];
    let sound =
        numbers.iter().all(|x| x.is_finite()) && estimate.diagnostics.pressure_variance_kpa2 > T::zero();
    assert!(sound || !estimate.validity.is_valid(), "{estimate:?}");
}

/// The requirements on the default estimator after the clean drive.
#[derive(Clone, Copy, PartialEq)]
enum Afterwards {
    Anything,
    Recovers,
}

fn survive<T: Real>(damage: &[Damage], from_bits: fn(u64) -> T, afterwards: Afterwards) {
    let mut estimator = estimator::<T>(RATE_HZ);
    for (damage, row) in damage.iter().zip(ROWS.iter()) {
        finite_or_not_believed(&damage.feed(&mut estimator, row, from_bits));
    }
    let clean = &ROWS[damage.len()..][..(CLEAN_S * RATE_HZ) as usize];
    let mut last = None;
    for row in clean {
        let estimate = feed(&mut estimator, row);
        finite_or_not_believed(&estimate);
        last = Some(estimate);
    }
    if afterwards == Afterwards::Recovers {
        let last = last.unwrap();
        let error = last.pressure_kpa.to_f64() - clean[clean.len() - 1].pressure_kpa;
        let sd = last.pressure_sd_kpa.to_f64();
        let sound = last.validity.is_valid() && error.abs() < 3.0 * sd;
        assert!(sound, "{:?} error {error} sd {sd}", last.validity);
    }
}

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 24,
        failure_persistence: None,
        max_shrink_iters: 0,
        rng_seed: RngSeed::Fixed(20),
        ..ProptestConfig::default()
    }
}

fn f32_from_bits(bits: u64) -> f32 {
    f32::from_bits(bits as u32)
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_f64_is_survived_and_overcome(damage in damage()) {
        survive::<f64>(&damage, f64::from_bits, Afterwards::Recovers);
    }

    #[test]
    fn any_f32_is_survived(damage in damage()) {
        survive::<f32>(&damage, f32_from_bits, Afterwards::Anything);
    }

    #[test]
    fn any_f32_is_overcome(damage in damage()) {
        survive::<f32>(&damage, f32_from_bits, Afterwards::Recovers);
    }
}

/// A second of white noise over the whole range from the first sample on, then thirteen clean ones: (error, sd).
fn after_noise<T: Real>(seed: u64) -> (f64, f64) {
    let mut random = Random::new(seed);
    let mut rows = ROWS[..7000].to_vec();
    for row in &mut rows[..500] {
        for x in [&mut row.wheel, &mut row.body] {
            random.uniform();
            *x = 1000.0 * (2.0 * random.uniform() - 1.0);
        }
    }
    let mut estimator = estimator::<T>(RATE_HZ);
    for row in &rows {
        feed(&mut estimator, row);
    }
    let last = feed(&mut estimator, &ROWS[7000]);
    (last.pressure_kpa.to_f64() - ROWS[7000].pressure_kpa, last.pressure_sd_kpa.to_f64())
}

/// Seeds that were found by trying 150.
const UNLUCKY: [u64; 3] = [65, 128, 138];

fn overcome<T: Real>() {
    let results = UNLUCKY.map(after_noise::<T>);
    println!("(error, sd) in kPa: {results:.1?}");
    assert!(results.iter().all(|(error, sd)| error.abs() < 3.0 * sd));
}

#[test]
fn full_range_noise_is_overcome() {
    overcome::<f64>();
}

#[test]
fn full_range_noise_is_overcome_in_single_precision() {
    overcome::<f32>();
}
