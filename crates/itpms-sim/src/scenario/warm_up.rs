//! Tires that warm up as they roll, on a journey.
//!
//! Called when a scenario is composed: pressures that hold become pressures that follow the temperature.

use super::Scenario;
use crate::streams::{Purpose, generator};
use crate::time_profile::{Pressure, TimeProfile};
use itpms_core::model::Corner;
use rand_distr::{Distribution, StandardNormal};

/// A tire is as warm as its speed makes it after this time in s, and cold at this temperature in K.
const WARMS_IN_S: f64 = 480.0;
const COLD_K: f64 = 293.15;
const ATMOSPHERE_KPA: f64 = 101.325;
/// Speed in m/s at which it warms up by what is asked for, and the tires' spread about that, as a share.
const SPEED_M_S: f64 = 25.0;
const SPREAD: f64 = 0.1;
/// Time in s between two points of a pressure.
const STEP_S: f64 = 30.0;

/// Absolute pressure goes with absolute temperature at constant volume (Gay-Lussac). Pressures that change already are left. By how many
/// K the air is warmer than where the pressures were set, and the tires at 90 km/h than the air.
pub(super) fn warm([air_k, by_k]: [f64; 2], seed: u64, scenario: &mut Scenario) {
    let Ok(speed_m_s) = scenario.speed.profile_m_s() else { return };
    let mut random = generator(seed, Purpose::WarmUp, [0, 0]);
    for corner in Corner::ALL {
        let drawn: f64 = StandardNormal.sample(&mut random);
        let Some(spec) = scenario.corner.get_mut(corner) else { continue };
        let Pressure::ConstantKpa(cold_kpa) = spec.pressure else { continue };
        let warms_by_k = by_k * (1.0 + SPREAD * drawn.clamp(-2.5, 2.5));
        let points = warmer_k(&speed_m_s, scenario.duration_s)
            .map(|[time_s, share]| {
                let warmed = 1.0 + (air_k + warms_by_k * share) / COLD_K;
                [time_s, (cold_kpa + ATMOSPHERE_KPA) * warmed - ATMOSPHERE_KPA]
            })
            .collect();
        spec.pressure = Pressure::PointsSKpa(points);
    }
}

/// How much of its warmth at 90 km/h a tire has, over time in s: exact for the mean speed of each step.
fn warmer_k(speed_m_s: &TimeProfile, duration_s: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
    let kept = (-STEP_S / WARMS_IN_S).exp();
    let mut share = 0.0;
    (0..=(duration_s / STEP_S).ceil() as u32).map(move |i| {
        let time_s = f64::from(i) * STEP_S;
        let now = share;
        let way_m = speed_m_s.integral(time_s + STEP_S) - speed_m_s.integral(time_s);
        share = kept * share + (1.0 - kept) * way_m / (STEP_S * SPEED_M_S);
        [time_s, now]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tire_warms_up_as_it_rolls_and_cools_as_it_stands() {
        let speed = TimeProfile::new(&[[0.0, 25.0], [4800.0, 25.0], [4800.1, 0.0]]).unwrap();
        let shares: Vec<[f64; 2]> = warmer_k(&speed, 5280.0).collect();
        // Exponential with 480 s; ten time constants later nearly all of it is there, one further 1/e is left.
        for [time_s, share] in shares.iter().take_while(|[time_s, _]| *time_s <= 4800.0) {
            assert!((share - (1.0 - (-time_s / 480.0).exp())).abs() < 1e-9, "{time_s} {share}");
        }
        let [time_s, left] = shares[shares.len() - 1];
        assert!(time_s == 5280.0 && (left - (-1f64).exp()).abs() < 1e-3, "{time_s} {left}");
    }

    #[test]
    fn a_journey_warms_its_tires_only_if_it_says_so() {
        let mut scenario = Scenario::builtin("drive-normal").unwrap();
        let held = scenario.composed(3).unwrap();
        assert_eq!(held.corner.fl.as_ref().unwrap().pressure, Pressure::ConstantKpa(241.3));
        scenario.journey.as_mut().unwrap().warms_by_k = 20.0;
        let warm = scenario.composed(3).unwrap();
        assert_eq!((&warm.speed, &warm.car), (&held.speed, &held.car));
        for (_, spec) in warm.corner.iter() {
            let Pressure::PointsSKpa(points) = &spec.pressure else { panic!("{:?}", spec.pressure) };
            assert!((points[0][1] - 241.3).abs() < 1e-9);
            // 20 K of 293 are 23.4 kPa at 90 km/h; a quarter more for the quickest and the most unequal.
            let most = points.iter().map(|[_, kpa]| *kpa).fold(0.0, f64::max);
            assert!(most > 245.0 && most < 241.3 + 1.25 * 23.4 * 1.3, "{most}");
        }
        // Ten K of 293 colder, and standing: (241.3 + 101.3) 10 / 293.15 less.
        scenario.journey.as_mut().unwrap().air_k = -10.0;
        let cold = scenario.composed(3).unwrap();
        let Pressure::PointsSKpa(points) = &cold.corner.rr.as_ref().unwrap().pressure else { panic!() };
        assert!((points[0][1] - (241.3 - 342.625 * 10.0 / 293.15)).abs() < 1e-9);
    }
}
