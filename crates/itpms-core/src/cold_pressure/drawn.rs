//! Drawn drives of cars that warm up otherwise than the model has it: how far off cold pressures are, and which losses pass for none. The figures
//! of docs/cold-pressure.md.

extern crate std;

use std::{format, println};

use super::{ColdTires, ZERO_C_K};
use crate::model::{Air, SEA_LEVEL_KPA, standard_atmosphere_kpa};
use crate::random::Random;

const DRIVES: u32 = 4000;
const PLACARD_KPA: f64 = 240.0;
/// Standard deviation of an estimated pressure in kPa, and a share of the reference below which a tire is low by UN R141, for certain.
const PRESSURE_SD_KPA: f64 = 5.0;
const LOW: f64 = 0.88;
const SURE_KPA: f64 = 1.64 * PRESSURE_SD_KPA;

/// Gauge pressure in kPa at another temperature in degrees Celsius and in other air, from one at sea level.
fn moved(kpa: f64, from_c: f64, to_c: f64, air_kpa: f64) -> f64 {
    (kpa + SEA_LEVEL_KPA) * (to_c + ZERO_C_K) / (from_c + ZERO_C_K) - air_kpa
}

struct Drawn {
    /// Cold pressure in kPa: true, found with its sd, and the pressure that was read.
    truth_kpa: f64,
    cold_kpa: f64,
    sd_kpa: f64,
    read_kpa: f64,
    /// Reference pressure in kPa: where the temperature is not known, and where it is.
    unaware_kpa: f64,
    aware_kpa: f64,
}

/// A tire that was filled in one weather is driven in another one, on one drive of ten over a pass, this share of its cold pressure short.
fn drive(random: &mut Random, loss: f64) -> Drawn {
    let filled_c = 12.0 + 8.0 * random.normal();
    let day_c = (filled_c + 9.0 * random.normal()).clamp(-20.0, 38.0);
    let altitude_m =
        if random.uniform() < 0.1 { 300.0 + 1300.0 * random.uniform() } else { 300.0 * random.uniform() };
    let (speed_m_s, seconds) = ((40.0 + 90.0 * random.uniform()) / 3.6, -1200.0 * random.uniform().ln());
    // The tire's own rise and nine minutes, not the model's.
    let rise_k = 0.22 * 3.6 * speed_m_s * (0.25 * random.normal()).exp();
    let excess_k = rise_k * (1.0 - (-seconds / 540.0).exp());
    let truth_kpa = moved(PLACARD_KPA, filled_c, day_c, SEA_LEVEL_KPA) * (1.0 - loss);
    let barometric_kpa = standard_atmosphere_kpa(altitude_m);
    let read_kpa =
        moved(truth_kpa, day_c, day_c + excess_k, barometric_kpa) + PRESSURE_SD_KPA * random.normal();
    let air = Air {
        ambient_temperature_c: day_c + 1.5 * random.normal(),
        barometric_kpa: barometric_kpa + 0.3 * random.normal(),
        altitude_m: f64::NAN,
    };
    let mut tires = ColdTires::new(SEA_LEVEL_KPA);
    for _ in 0..1 + seconds as u32 {
        tires.take(&air);
        tires.advance(1.0, speed_m_s);
    }
    let cold = tires.cold(read_kpa, PRESSURE_SD_KPA).unwrap();
    // monitor.md, eq. 4 and 5, after a calibration that has warmed the tire by .6 to 1.1 of 22 K.
    let taken_kpa =
        moved(PLACARD_KPA, filled_c, filled_c + 22.0 * (0.6 + 0.5 * random.uniform()), SEA_LEVEL_KPA);
    let taken = (taken_kpa / PLACARD_KPA).clamp(0.97, 1.08);
    let warmth = (speed_m_s / 20.0).min(1.0) * (1.0 - (-seconds / 600.0).exp());
    Drawn {
        truth_kpa,
        cold_kpa: cold.pressure_kpa,
        sd_kpa: cold.sd_kpa,
        read_kpa,
        unaware_kpa: PLACARD_KPA * (1.0 + (taken - 1.0) * warmth),
        aware_kpa: tires.expected_kpa(PLACARD_KPA).unwrap(),
    }
}

fn drives(seed: u64, loss: f64) -> impl Iterator<Item = Drawn> {
    let mut random = Random(seed);
    (0..DRIVES).map(move |_| drive(&mut random, loss))
}

#[test]
fn cold_pressures_are_within_their_standard_deviations() {
    for (seed, loss) in [(1, 0.0), (2, 0.2)] {
        let (mut square, mut mean, mut inside, mut unaware) = (0.0, 0.0, 0u32, 0.0);
        for drawn in drives(seed, loss) {
            let error_kpa = drawn.cold_kpa - drawn.truth_kpa;
            square += error_kpa * error_kpa / f64::from(DRIVES);
            mean += error_kpa / f64::from(DRIVES);
            inside += u32::from(error_kpa.abs() < 1.96 * drawn.sd_kpa);
            unaware += (drawn.read_kpa - drawn.truth_kpa).powi(2) / f64::from(DRIVES);
        }
        let (rms, unaware, inside) = (square.sqrt(), unaware.sqrt(), f64::from(inside) / f64::from(DRIVES));
        let found =
            format!("{loss}: rms {rms:.2}, mean {mean:.2}, inside {inside:.3}, as it is read {unaware:.1}");
        assert!(rms < 8.0 && mean.abs() < 3.0 && (0.93..0.99).contains(&inside) && unaware > 17.0, "{found}");
        println!("{found}");
    }
}

#[test]
fn a_reference_that_follows_the_temperature_lets_fewer_losses_pass() {
    // Of those that lost a quarter and need air, the ones not below the limit; of healthy ones, those that are.
    let is_low = |drawn: &Drawn, reference_kpa: f64| drawn.read_kpa + SURE_KPA < LOW * reference_kpa;
    let share = |seed, loss, counts: fn(&Drawn) -> bool, aware: bool| {
        let (mut all, mut low) = (0u32, 0u32);
        for drawn in drives(seed, loss).filter(counts) {
            all += 1;
            low += u32::from(is_low(&drawn, if aware { drawn.aware_kpa } else { drawn.unaware_kpa }));
        }
        f64::from(low) / f64::from(all)
    };
    let missed =
        [false, true].map(|aware| 1.0 - share(3, 0.25, |drawn| drawn.truth_kpa < 0.8 * PLACARD_KPA, aware));
    let warned =
        [false, true].map(|aware| share(4, 0.0, |drawn| drawn.truth_kpa > 0.85 * PLACARD_KPA, aware));
    let found =
        format!("missed without and with a temperature {missed:.4?}, healthy ones warned of {warned:.5?}");
    assert!(missed[1] < 0.5 * missed[0] && missed[1] < 0.02 && warned[1] < 1.5e-3, "{found}");
    println!("{found}");
}
