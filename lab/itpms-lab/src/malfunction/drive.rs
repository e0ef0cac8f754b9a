//! Everyday drives on which nothing is wrong, recorded, to put malfunctions into.

use itpms_core::model::{CarConfig, CarSample};
use itpms_sim::road::{AfterLast, Amplitude, Pothole, RoadClass, Segment, Segments, Surface, Tracks};
use itpms_sim::scenario::{Scenario, ToleranceSpec};
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::{Pressure, Speed};

use crate::runner::Result;

const DRIVE_S: f64 = 360.0;
/// When a malfunction may begin, in s, and the speed in m/s at which it does.
const EARLIEST_S: f64 = 60.0;
const BEGINS_M_S: f64 = 5.0;
/// Pressures of the four tires over the placard's: all different, so that a swap shows, none low.
const SHARES: [f64; 4] = [1.03, 0.98, 1.0, 0.96];

/// A road that tells nothing: `Gd(n0)` in m³, as of glass or of a test bench's drum. What is left in the sensors is their own
/// noise and the imbalance of the wheels. Before and after it a road of class B, all at one speed.
const GLASS_M3: f64 = 1e-12;
const GLASS_M_S: f64 = 14.0;
const BEFORE_GLASS_S: f64 = 100.0;
const GLASS_S: f64 = 640.0;
const AFTER_GLASS_S: f64 = 130.0;

pub(super) struct Recorded {
    pub(super) rate_hz: f64,
    pub(super) car: CarConfig<f64>,
    pub(super) rows: Vec<CarSample<f64>>,
    pub(super) pressure_kpa: [f64; 4],
    /// Index of the row at which a malfunction begins.
    pub(super) begins: usize,
    /// Index of the row at which it ends, where the road decides that.
    pub(super) ends: Option<usize>,
}

impl Recorded {
    /// The drive of a seed: an everyday journey of a car that differs from what its estimator is given as cars do; with
    /// every second seed over potholes and humps.
    pub(super) fn of(seed: u64) -> Result<Self> {
        let mut scenario = everyday()?;
        if seed.is_multiple_of(2) {
            scenario.road.pothole = holes();
        }
        let mut drive = Self::record(&scenario, seed)?;
        let begins = drive.rows.iter().position(|row| row.time_s >= EARLIEST_S && row.speed_m_s > BEGINS_M_S);
        drive.begins = begins.unwrap_or(drive.rows.len());
        Ok(drive)
    }

    /// The same car on a road that for eleven minutes tells nothing.
    pub(super) fn over_glass(seed: u64) -> Result<Self> {
        let mut scenario = everyday()?.composed(seed)?;
        scenario.duration_s = BEFORE_GLASS_S + GLASS_S + AFTER_GLASS_S;
        scenario.speed = Speed::ConstantKmH(3.6 * GLASS_M_S);
        let class_b = RoadClass::B.gd_n0_m3();
        let stretch = |(seconds, gd_n0_m3): (f64, f64)| Segment {
            length_m: seconds * GLASS_M_S,
            roughness: gd_n0_m3.into(),
            slope: 2.0,
        };
        let stretches = [(BEFORE_GLASS_S, class_b), (GLASS_S, GLASS_M3), (AFTER_GLASS_S, class_b)];
        scenario.road.surface = Surface::Segments(Segments {
            list: stretches.map(stretch).to_vec(),
            after_last: AfterLast::Hold,
            amplitude: Amplitude::Gaussian,
        });
        if let Some(car) = &mut scenario.car {
            // The journey's bends and passengers belong to its stops.
            car.lateral_points_s_m_s2.clear();
            car.payload.clear();
        }
        let mut drive = Self::record(&scenario, seed)?;
        let row_at = |time_s: f64| drive.rows.iter().position(|row| row.time_s >= time_s);
        let (begins, ends) = (row_at(BEFORE_GLASS_S), row_at(BEFORE_GLASS_S + GLASS_S));
        (drive.begins, drive.ends) = (begins.unwrap_or(drive.rows.len()), ends);
        Ok(drive)
    }

    fn record(scenario: &Scenario, seed: u64) -> Result<Self> {
        let mut scenario = scenario.clone();
        let car = scenario.car_config()?;
        let mut pressure_kpa = [f64::NAN; 4];
        for (corner, spec) in scenario.corner.iter_mut() {
            let kpa = SHARES[corner.index()] * spec.placard_kpa;
            pressure_kpa[corner.index()] = kpa;
            spec.pressure = Pressure::ConstantKpa(kpa);
        }
        let rows: Vec<CarSample<f64>> =
            Simulation::new(&scenario, seed)?.map(|row| row.car_sample()).collect();
        let begins = rows.len();
        Ok(Self { rate_hz: scenario.rate_hz, car, rows, pressure_kpa, begins, ends: None })
    }
}

/// Six minutes of a car that differs from its file, before its seed composes them.
fn everyday() -> Result<Scenario> {
    let mut scenario = Scenario::builtin("drive-normal")?;
    scenario.duration_s = DRIVE_S;
    if let Some(journey) = &mut scenario.journey {
        journey.tolerances = Some(ToleranceSpec::default());
    }
    Ok(scenario)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_lies_between_two_roads_and_is_driven_for_more_than_ten_minutes() {
        let drive = Recorded::over_glass(1).unwrap();
        let ends = drive.ends.unwrap();
        assert!((drive.rows[drive.begins].time_s - BEFORE_GLASS_S).abs() < 0.01);
        assert!((drive.rows[ends].time_s - BEFORE_GLASS_S - GLASS_S).abs() < 0.01);
        assert!(GLASS_S > 610.0 && drive.rows.iter().all(|row| (row.speed_m_s - GLASS_M_S).abs() < 1e-9));
        let wheel = |row: &CarSample<f64>| row.corners[2].map_or(f64::NAN, |corner| corner.wheel_accel_m_s2);
        let rms = |rows: &[CarSample<f64>]| {
            (rows.iter().map(|row| wheel(row).powi(2)).sum::<f64>() / rows.len() as f64).sqrt()
        };
        // Metres to either side of the joint the wheel still swings.
        let [before, on, after] =
            [&drive.rows[..drive.begins], &drive.rows[drive.begins + 1000..ends - 1000], &drive.rows[ends..]];
        let [before, on, after] = [before, on, after].map(rms);
        // Twice the noise that is stated and an imbalance of 2 g m at 7.4 Hz (some 0.1 m/s2) are left.
        assert!(on < 0.3 && before > 1.0 && after > 1.0, "{before} {on} {after}");
    }
}
