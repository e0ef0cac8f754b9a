//! Everyday drives on which nothing is wrong, recorded, to put malfunctions into.

use itpms_core::car::CarConfig;
use itpms_core::sample::{CarSample, Corner};
use itpms_sim::road::{Pothole, Tracks};
use itpms_sim::scenario::{Scenario, ToleranceSpec};
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::Pressure;

use super::MalfunctionError;

/// Length in s of a drive.
const DRIVE_S: f64 = 360.0;
/// When a malfunction may begin, in s, and the speed in m/s at which it does.
const EARLIEST_S: f64 = 60.0;
const BEGINS_M_S: f64 = 5.0;
/// Pressures of the four tires over the placard's: all different, so that a swap shows, none low.
const SHARES: [f64; 4] = [1.03, 0.98, 1.0, 0.96];

/// A recorded drive.
pub(super) struct Recorded {
    pub(super) rate_hz: f64,
    pub(super) car: CarConfig<f64>,
    pub(super) rows: Vec<CarSample<f64>>,
    pub(super) pressure_kpa: [f64; 4],
    /// Index of the row at which a malfunction begins.
    pub(super) begins: usize,
}

impl Recorded {
    /// The drive of a seed: an everyday journey of a car that differs from what its estimator is told as cars do; with
    /// every second seed over potholes and humps.
    pub(super) fn of(seed: u64) -> Result<Self, MalfunctionError> {
        let mut scenario = Scenario::builtin("drive-normal")?;
        scenario.duration_s = DRIVE_S;
        if let Some(journey) = &mut scenario.journey {
            journey.tolerances = Some(ToleranceSpec::default());
        }
        if seed.is_multiple_of(2) {
            scenario.road.pothole = holes();
        }
        let mut car = CarConfig { corners: [None; 4], wheelbase_m: Some(scenario.wheelbase_m) };
        let mut pressure_kpa = [f64::NAN; 4];
        for (i, corner) in Corner::ALL.into_iter().enumerate() {
            let told = scenario.corner_config(corner)?;
            pressure_kpa[i] = SHARES[i] * told.placard_kpa;
            if let Some(spec) = scenario.corner.get_mut(corner) {
                spec.pressure = Pressure::ConstantKpa(pressure_kpa[i]);
            }
            car.corners[i] = Some(told);
        }
        let rows: Vec<CarSample<f64>> =
            Simulation::new(&scenario, seed)?.map(|row| row.car_sample()).collect();
        let begins = rows.iter().position(|row| row.time_s >= EARLIEST_S && row.speed_m_s > BEGINS_M_S);
        let begins = begins.unwrap_or(rows.len());
        Ok(Self { rate_hz: scenario.rate_hz, car, rows, pressure_kpa, begins })
    }
}

/// A hole or a hump every 40 to 160 m, left, right or across.
fn holes() -> Vec<Pothole> {
    let one = |i: u32| {
        let turn = f64::from(i * 7 % 13);
        let depth_m = if i % 4 == 3 { -0.03 } else { 0.015 + 0.002 * turn };
        let tracks = match i % 3 {
            0 => Tracks::Both,
            1 => Tracks::Left,
            _ => Tracks::Right,
        };
        let at_m = 50.0 + 100.0 * f64::from(i) + 4.0 * turn;
        Pothole { at_m, length_m: 0.3 + 0.07 * turn, depth_m, edge_m: 0.08, tracks }
    };
    (0..140).map(one).collect()
}
