//! One corner whose wheel's tooth pulses are read, against the same corner alone:
//! `cargo run --release -p itpms-sim --example corner_with_pulses [SEEDS]`.
//!
//! The paper's corner at 80 km/h, classes A, B and C in turn, with a vehicle file whose values are typical ones, as it is and with an unsprung
//! mass 5 % off. Its pulses were calibrated for ten minutes another day, its accelerations never were. After four minutes the tire loses
//! a fifth in ten seconds. Both estimators meet the same samples.

use std::error::Error;

use itpms_core::Estimator;
use itpms_core::model::{Confidence, Corner, CornerEstimate};
use itpms_core::torsion::{TorsionConfig, TorsionWheel};
use itpms_sim::pulses::{PulseSpec, PulseWheel};
use itpms_sim::road::{RoadClass, RoadSpec};
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::{Pressure, Speed};

const RATE_HZ: f64 = 200.0;
const SPEED_KM_H: f64 = 80.0;
const PLACARD_KPA: f64 = 241.3;
/// Where errors are looked at: when the level has been learned, in the first minute after the loss, and later.
const WINDOWS_S: [(f64, f64); 3] = [(120.0, 240.0), (250.0, 310.0), (310.0, 480.0)];

/// Sums over a window: rows, squared errors and variances in kPa², rows inside the 95 % interval.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Window {
    rows: f64,
    square: f64,
    variance: f64,
    inside: f64,
}

impl Window {
    fn add(&mut self, error_kpa: f64, sd_kpa: f64) {
        self.rows += 1.0;
        self.square += error_kpa * error_kpa;
        self.variance += sd_kpa * sd_kpa;
        self.inside += f64::from(u8::from(error_kpa.abs() < 1.96 * sd_kpa));
    }

    fn join(&mut self, other: &Self) {
        self.rows += other.rows;
        self.square += other.square;
        self.variance += other.variance;
        self.inside += other.inside;
    }

    /// Rms of the errors and of the stated sd in kPa, share inside.
    pub(crate) fn figures(&self) -> [f64; 3] {
        let mean = |sum: f64| sum / self.rows;
        [mean(self.square).sqrt(), mean(self.variance).sqrt(), mean(self.inside)]
    }
}

/// The windows of a drive: of the corner alone, and with pulses.
pub(crate) type Reported = [[Window; 3]; 2];

/// Pulses of a wheel at a pressure, calibrated on class B at 70 to 90 km/h.
fn calibrated(seed: u64) -> Result<TorsionWheel<f64>, Box<dyn Error>> {
    let mut known = TorsionWheel::new(&TorsionConfig::new())?;
    let mut wheel = PulseWheel::new(&PulseSpec::default(), seed, 0);
    let at = |time_s: f64| ((SPEED_KM_H + 10.0 * (time_s / 60.0).sin()) / 3.6, PLACARD_KPA);
    // Until its teeth are known.
    wheel.roll(90.0, at, |time_s| _ = known.push(time_s));
    known.begin_calibration();
    wheel.roll(600.0, at, |time_s| _ = known.push(time_s));
    known.end_calibration();
    let mut later = TorsionWheel::new(&TorsionConfig::new())?;
    let learned = known.calibration().ok_or("nothing was learned of the pulses")?;
    if later.load_calibration(&learned) { Ok(later) } else { Err("what was learned is no tire's".into()) }
}

/// A drive of a car whose unsprung mass is so many times its file's.
pub(crate) fn drive(unsprung_factor: f64, seed: u64) -> Result<Reported, Box<dyn Error>> {
    let mut pulses = calibrated(seed)?;
    let class = [RoadClass::A, RoadClass::B, RoadClass::C][(seed % 3) as usize];
    let spec = PulseSpec { roughness: class.into(), ..PulseSpec::default() };
    let mut rolling = PulseWheel::of_car(&spec, seed, seed + 1000, 0);

    let mut scenario = Scenario::builtin("paper-drop")?;
    (scenario.duration_s, scenario.rate_hz) = (480.0, RATE_HZ);
    scenario.speed = Speed::ConstantKmH(SPEED_KM_H);
    scenario.road = RoadSpec::iso8608(class, 2.0);
    scenario.confidence = Confidence::Typical;
    let corner = scenario.corner.get_mut(Corner::FrontLeft).ok_or("no corner")?;
    corner.initial_stiffness_n_per_m = None;
    corner.truth.unsprung_mass_factor = unsprung_factor;
    corner.pressure = Pressure::ramp(PLACARD_KPA, 0.8 * PLACARD_KPA, 240.0, 10.0);

    let mut alone = Estimator::new(&scenario.corner_config(Corner::FrontLeft)?, RATE_HZ)?;
    let mut with_pulses = alone.clone();
    let mut configured = Reported::default();
    for row in Simulation::new(&scenario, seed)? {
        let Some(truth) = row.corners[Corner::FrontLeft.index()] else { continue };
        let (body, wheel) = (truth.body_accel_m_s2, truth.wheel_accel_m_s2);
        let at = |_| (row.speed_m_s, truth.pressure_kpa);
        rolling.roll(1.0 / RATE_HZ, at, |time_s| {
            if let Some(piece) = pulses.push(time_s) {
                with_pulses.take_piece(&piece);
            }
        });
        for (estimator, configured) in [&mut alone, &mut with_pulses].into_iter().zip(&mut configured) {
            let estimate = estimator.update(row.time_s, row.speed_m_s, body, wheel);
            take(configured, row.time_s, truth.pressure_kpa, &estimate);
        }
    }
    Ok(configured)
}

fn take(configured: &mut [Window; 3], time_s: f64, truth_kpa: f64, estimate: &CornerEstimate<f64>) {
    for (window, (from_s, to_s)) in configured.iter_mut().zip(WINDOWS_S) {
        if estimate.validity.is_valid() && time_s > from_s && time_s <= to_s {
            window.add(estimate.pressure_kpa - truth_kpa, estimate.pressure_sd_kpa);
        }
    }
}

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let seeds = std::env::args().nth(1).map_or(Ok(6), |seeds| seeds.parse::<u64>())?;
    println!("rms, sd in kPa, inside: before a loss of a fifth | in the minute after it | later");
    for (name, factor) in [("as its file", 1.0), ("unsprung +5 %", 1.05), ("unsprung -5 %", 0.95)] {
        let mut all = Reported::default();
        for seed in 0..seeds {
            let configured = drive(factor, seed)?;
            all.iter_mut().flatten().zip(configured.iter().flatten()).for_each(|(sum, one)| sum.join(one));
        }
        for (how, windows) in ["alone", "with pulses"].iter().zip(&all) {
            let figures = windows.each_ref().map(|window| {
                let [rms, sd, inside] = window.figures();
                format!("{rms:5.1} {sd:5.1} {:4.0} %", 100.0 * inside)
            });
            println!("{name:14} {how:12} {}", figures.join(" | "));
        }
    }
    Ok(())
}
