//! The Cramer-Rao bound of both sides of a car, for drives it holds for.
//!
//! Called where the cells of a row are made. It is that of four quarter cars on one spectrum which are what the estimator is given.

use itpms_core::model::Corner;
use itpms_sim::plant::Deviations;
use itpms_sim::road::{Iso8608, Surface, coherence};

use super::super::case::{bound_setting, bound_times_s, invalid};
use super::{Drive, Setup};
use crate::runner::Result;
use itpms_analysis::bound::SideBound;

/// Sd in kPa of each pressure at the start: that of the estimator of a car.
const START_SD_KPA: f64 = 36.0;

/// Rms in kPa of the bound's sd over the time that is judged, by corner; NaN where there is none.
pub(super) fn rms_kpa(drive: &Drive, setup: &Setup) -> Result<[f64; 4]> {
    let mut rms = [f64::NAN; 4];
    let Some(road) = road(drive) else { return Ok(rms) };
    let scenario = &drive.scenario;
    let (setting, times) = (bound_setting(scenario, road)?, bound_times_s(scenario));
    for side in [[Corner::FrontLeft, Corner::RearLeft], [Corner::FrontRight, Corner::RearRight]] {
        let [Some(front), Some(rear)] = side.map(|corner| scenario.corner.get(corner)) else { continue };
        let profiles = [
            front.pressure.profile_kpa().map_err(|e| invalid(scenario, e))?,
            rear.pressure.profile_kpa().map_err(|e| invalid(scenario, e))?,
        ];
        let pressures: Vec<[f64; 2]> =
            times.iter().map(|&t| profiles.each_ref().map(|profile| profile.value(t))).collect();
        let configs = [scenario.corner_config(side[0])?, scenario.corner_config(side[1])?];
        let bound = SideBound::new(configs, &setting, scenario.rear_offset_m, coherence)?;
        let sds = bound.history(&times, &pressures, START_SD_KPA, setup.reset_s);
        for (axle, corner) in side.into_iter().enumerate() {
            rms[corner.index()] = drive.judged.rms(&times, sds.iter().map(|sd| sd[axle]));
        }
    }
    Ok(rms)
}

/// The one spectrum of a drive that the bound holds for.
fn road(drive: &Drive) -> Option<&Iso8608> {
    let scenario = &drive.scenario;
    let as_stated = scenario.corner.iter().all(|(_, corner)| {
        corner.truth == Deviations::default() && corner.body_sensor.is_none() && corner.wheel_sensor.is_none()
    });
    let configured = drive.speed_factor == 1.0 && drive.wheelbase_m == scenario.wheelbase_m;
    match &scenario.road.surface {
        Surface::Iso8608(iso)
            if scenario.car.is_none() && as_stated && configured && scenario.road.contact_length_m == 0.0 =>
        {
            Some(iso)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {

    use super::super::Plant;
    use super::*;

    fn puncture(plant: Plant, km_h: f64) -> Drive {
        Drive::puncture(plant, km_h).unwrap()
    }

    #[test]
    fn the_bound_of_an_independent_computation() {
        // A separate script, by steps of 2 ms: rms over t > 3 s of both wheels on the left.
        for (km_h, setup, expected) in [
            (80.0, Setup::USUAL, [4.02, 2.44]),
            (80.0, Setup::RESET, [3.46, 1.00]),
            (20.0, Setup::USUAL, [7.62, 5.28]),
            (20.0, Setup::RESET, [6.12, 1.29]),
        ] {
            let found = rms_kpa(&puncture(Plant::Quarters, km_h).with_rear_offset_m(0.02), &setup).unwrap();
            for (corner, expected) in [(0, expected[0]), (2, expected[1])] {
                let found = found[corner];
                assert!(
                    (found / expected - 1.0).abs() < 0.03,
                    "{km_h} km/h, {setup:?}: {found} for {expected}"
                );
            }
        }
    }

    #[test]
    fn a_shared_road_tells_more_and_a_car_that_is_not_its_file_has_no_bound() {
        let on_track = rms_kpa(&puncture(Plant::Quarters, 20.0), &Setup::USUAL).unwrap();
        let beside =
            rms_kpa(&puncture(Plant::Quarters, 20.0).with_rear_offset_m(0.02), &Setup::USUAL).unwrap();
        assert!(on_track.iter().zip(beside).all(|(on_track, beside)| 3.0 * on_track < beside));
        let heavy =
            puncture(Plant::Quarters, 20.0).each_corner(|_, corner| corner.truth.unsprung_mass_factor = 1.01);
        for drive in [heavy, puncture(Plant::Car, 20.0)] {
            assert!(rms_kpa(&drive, &Setup::USUAL).unwrap().iter().all(|rms| rms.is_nan()));
        }
    }
}
