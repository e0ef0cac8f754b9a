//! The estimator of a whole car survives any bits in its samples, and is sound again behind them.

use std::sync::LazyLock;

use itpms_core::Real;
use itpms_core::model::{CarEstimate, CarSample};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::common::car_ride::{CarRide, car, cast, config, drive, sound};

static ROWS: LazyLock<Vec<CarSample<f64>>> = LazyLock::new(|| CarRide::new(5).rows());

/// One row's damage: which fields are replaced by which bits, and which corner is not there.
type Damage = (u16, u8, [u64; 10]);

fn damaged<T: Real>(
    row: &CarSample<f64>,
    (mask, gone, bits): &Damage,
    from_bits: fn(u64) -> T,
) -> CarSample<T> {
    let mut row = cast::<T>(row);
    let hit = |i: usize| mask & (1 << i) != 0;
    // Half of the bits are any, half make a number that passes for an acceleration or a speed.
    let any =
        |i: usize| if bits[i] & 1 == 0 { from_bits(bits[i]) } else { T::lit((bits[i] % 401) as f64 - 200.0) };
    if hit(0) && bits[0].is_multiple_of(4) {
        row.time_s = f64::from_bits(bits[0]);
    }
    if hit(1) {
        row.speed_m_s = any(1);
    }
    for (i, corner) in row.corners.iter_mut().enumerate() {
        if let Some(corner) = corner {
            for (k, x) in [&mut corner.body_accel_m_s2, &mut corner.wheel_accel_m_s2].into_iter().enumerate()
            {
                if hit(2 + 2 * i + k) {
                    *x = any(2 + 2 * i + k);
                }
            }
        }
        if gone >> 4 == 0 && gone & (1 << i) != 0 {
            *corner = None;
        }
    }
    row
}

/// Drives on a good road, through the damage, and on.
fn survives<T: Real>(damage: &[Damage], from_bits: fn(u64) -> T) -> CarEstimate<T> {
    let mut car = car(&config::<T>());
    let (before, after) = (&ROWS[..1500], &ROWS[1500 + damage.len()..]);
    drive(&mut car, before).iter().for_each(sound);
    for (row, damage) in ROWS[1500..].iter().zip(damage) {
        sound(&car.update(&damaged(row, damage, from_bits)));
    }
    let estimates = drive(&mut car, after);
    estimates.iter().for_each(sound);
    *estimates.last().unwrap()
}

fn damage() -> impl Strategy<Value = Vec<Damage>> {
    prop::collection::vec((any::<u16>(), any::<u8>(), any::<[u64; 10]>()), 100..400)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 6,
        failure_persistence: None,
        max_shrink_iters: 0,
        rng_seed: RngSeed::Fixed(31),
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_f64_is_survived(damage in damage()) {
        survives::<f64>(&damage, f64::from_bits);
    }

    #[test]
    fn any_f32_is_survived(damage in damage()) {
        survives::<f32>(&damage, |bits| f32::from_bits(bits as u32));
    }
}
