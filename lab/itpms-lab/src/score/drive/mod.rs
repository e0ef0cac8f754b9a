//! Four wheels: the drives of a whole car, what is changed about them, and the sample loop they share.
//!
//! Called by the score. Every drive is simulated twice over, under two kinds of car: one body that heaves, pitches and
//! rolls, and four quarter cars that know nothing of each other, whose rear wheels meet the front wheels' road a
//! wheelbase later. An estimator that needs one of the two would be an estimator of a simulator.
//!
//! | module | idea |
//! |---|---|
//! | `errors` | errors of four wheels over a drive's windows, as cells |
//! | `puncture` | a puncture at two speeds; the sources of information one by one |
//! | `detect` | how soon a loss is warned of, on which wheel |
//! | `disturb` | the same while something differs from what the estimator is given |
//! | `limit` | what cannot be done better |
//! | `learn`, `learned_car` | what ten minutes at known pressures teach of a car, and what that is worth later |
//! | `several` | tires that lose air together, or did before the drive, on cars that are not their files |
//! | `real`, `real_list` | cars that are not their files: level, honesty and warnings with each deviation |

mod detect;
mod disturb;
mod errors;
mod learn;
mod learned_car;
mod limit;
mod puncture;
mod real;
mod real_list;
mod several;

use itpms_core::car::{EstimatorOptions, Sources};
use itpms_core::model::{CarConfig, CarEstimate, Corner};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_sim::scenario::{CornerSpec, Scenario};
use itpms_sim::sensor::SensorSpec;
use itpms_sim::simulation::{SimRow, Simulation};
use itpms_sim::time_profile::Speed;

use super::Part;
use super::row::Row;
use super::stats::Window;
use crate::runner::{Result, Runner};
use crate::sensors::{equipped, wheel_speeds_beside};
use crate::tuning::monitor;

/// Length in s of the reset that a row's `reset` stands for.
const RESET_S: f64 = 10.0;

itpms_core::labelled! {
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    enum Plant {
        /// One rigid body over four wheels.
        Car = "car",
        /// Four quarter cars on two independent tracks.
        Quarters = "quarters",
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Setup {
    /// Suffix of the row's name; empty for the usual one.
    label: &'static str,
    sources: Sources,
    /// Seconds at the start that it is set to placard pressure.
    reset_s: Option<f64>,
}

impl Setup {
    /// Everything it has, without a reset.
    const USUAL: Self = Self { label: "", sources: Sources::SpectrumAndSharedRoad, reset_s: None };
    /// The same after a reset.
    const RESET: Self = Self { label: "reset", reset_s: Some(RESET_S), ..Self::USUAL };
}

/// A drive and the estimators that go along on it.
#[derive(Debug, Clone)]
struct Drive {
    /// Prefix of its rows' names.
    name: String,
    scenario: Scenario,
    setups: Vec<Setup>,
    /// The car's speed as the estimator is given, over the true one.
    speed_factor: f64,
    /// Distance of the axles as the estimator is given.
    wheelbase_m: f64,
    /// Whether a rigid car has wheel speeds beside.
    wheel_speeds: bool,
    struck: Corner,
    /// All that counts for RMSE and coverage.
    judged: Window,
    /// While the pressures are settled, before and after the change.
    before: Window,
    after: Window,
    /// The change and the time it takes to notice.
    change: Window,
}

impl Drive {
    /// `drive-puncture` under one of the two cars.
    fn puncture(plant: Plant, km_h: f64) -> Result<Self> {
        let mut scenario = Scenario::builtin("drive-puncture")?;
        scenario.speed = Speed::ConstantKmH(km_h);
        if plant == Plant::Quarters {
            scenario.car = None;
        }
        let end_s = scenario.duration_s;
        Ok(Self {
            name: format!("{}, {km_h} km/h", plant.label()),
            wheelbase_m: scenario.wheelbase_m,
            scenario,
            wheel_speeds: false,
            setups: vec![Setup::USUAL, Setup::RESET],
            speed_factor: 1.0,
            struck: Corner::FrontLeft,
            judged: Window::new(3.0, end_s),
            before: Window::new(RESET_S, 20.0),
            change: Window::new(20.0, 25.0),
            after: Window::new(27.0, end_s),
        })
    }

    fn named(mut self, addition: &str) -> Self {
        if !addition.is_empty() {
            self.name = format!("{}, {addition}", self.name);
        }
        self
    }

    fn with_scenario(mut self, edit: impl FnOnce(&mut Scenario)) -> Self {
        edit(&mut self.scenario);
        self
    }

    fn with_setups(self, setups: &[Setup]) -> Self {
        Self { setups: setups.to_vec(), ..self }
    }

    /// Rear wheels that far beside the front ones' track.
    fn with_rear_offset_m(mut self, offset_m: f64) -> Self {
        match &mut self.scenario.car {
            Some(car) => car.rear_offset_m = offset_m,
            None => self.scenario.rear_offset_m = offset_m,
        }
        self
    }

    /// Sensor noise in m/s² rms; the estimator is given it.
    fn with_noise(self, noise_m_s2: f64) -> Self {
        self.with_scenario(|scenario| scenario.sensor = SensorSpec::with_noise(noise_m_s2))
    }

    fn each_corner(mut self, mut edit: impl FnMut(Corner, &mut CornerSpec)) -> Self {
        self.scenario.corner.iter_mut().for_each(|(corner, spec)| edit(corner, spec));
        self
    }

    fn row_name(&self, setup: &Setup) -> String {
        if setup.label.is_empty() { self.name.clone() } else { format!("{}, {}", self.name, setup.label) }
    }

    /// Keeps the rows whose names contain `only`; `None` if there are none.
    fn only(mut self, only: Option<&str>) -> Option<Self> {
        if let Some(only) = only {
            let names: Vec<String> = self.setups.iter().map(|setup| self.row_name(setup)).collect();
            let mut names = names.iter();
            self.setups.retain(|_| names.next().is_some_and(|name| name.contains(only)));
        }
        (!self.setups.is_empty()).then_some(self)
    }

    fn file_config(&self) -> Result<CarConfig<f64>> {
        Ok(CarConfig { wheelbase_m: Some(self.wheelbase_m), ..self.scenario.car_config()? })
    }

    fn simulated(&self, seed: u64) -> Scenario {
        let mut scenario = self.scenario.clone();
        if self.wheel_speeds && scenario.car.is_some() {
            scenario.wheel_speeds = Some(wheel_speeds_beside(seed));
        }
        scenario
    }

    /// An estimator for each setup, under its monitor as everywhere else: what is suspect is kept from it.
    fn cars(&self, scenario: &Scenario) -> Result<Vec<Box<MonitoredCar<f64>>>> {
        let config = self.file_config()?;
        let set_up = |setup: &Setup| {
            let options = EstimatorOptions { sources: setup.sources, ..EstimatorOptions::default() };
            let config = MonitorConfig { options, ..monitor(&config) };
            let mut car = equipped(&config, scenario)?;
            if let Some(seconds) = setup.reset_s {
                car.begin_calibration(seconds)?;
            }
            Ok(car)
        };
        self.setups.iter().map(set_up).collect()
    }

    /// Every row of the log with its truth and what the estimator of each setup, by its number, reported after it.
    fn drive(&self, seed: u64, mut look: impl FnMut(usize, &SimRow, &CarEstimate<f64>)) -> Result<()> {
        let scenario = self.simulated(seed);
        let mut cars = self.cars(&scenario)?;
        for row in Simulation::new(&scenario, seed)? {
            let mut sample = row.car_sample();
            sample.speed_m_s *= self.speed_factor;
            for (number, car) in cars.iter_mut().enumerate() {
                look(number, &row, &car.update(&sample));
            }
        }
        Ok(())
    }
}

pub(super) struct Plan {
    errors: errors::Plan,
    detection: detect::Plan,
    real: real::Plan,
    learn: learn::Plan,
    several: several::Plan,
}

impl Plan {
    /// `wanted` parts with `seeds` drives per row; of these only the rows whose names contain `only`.
    pub(super) fn new(
        wanted: impl Fn(Part) -> bool,
        seeds: usize,
        only: Option<&str>,
        wheel_speeds: bool,
    ) -> Result<Self> {
        let mut errors = errors::Plan::default();
        if wanted(Part::Drive) {
            let beside = |(drive, goal): (Drive, _)| (Drive { wheel_speeds, ..drive }, goal);
            errors.add("drive", puncture::drives()?.into_iter().map(beside).collect(), seeds, only);
            errors.add("drive-noise", puncture::noisy()?, seeds, only);
        }
        if wanted(Part::Ablation) {
            errors.add("ablation", puncture::ablation()?, seeds, only);
        }
        if wanted(Part::Disturbances) {
            errors.add("disturbances", disturb::drives()?, seeds, only);
        }
        let detection =
            if wanted(Part::Detection) { detect::Plan::new(seeds, only) } else { Default::default() };
        let real =
            if wanted(Part::Car) { real::Plan::new(seeds, only, wheel_speeds) } else { Default::default() };
        let learn = if wanted(Part::Learn) { learn::Plan::new(seeds, only) } else { Default::default() };
        let several =
            if wanted(Part::Several) { several::Plan::new(seeds, only) } else { Default::default() };
        Ok(Self { errors, detection, real, learn, several })
    }

    pub(super) fn drives(&self) -> u64 {
        self.errors.drives()
            + self.detection.drives()
            + self.real.drives()
            + self.learn.drives()
            + self.several.drives()
    }

    pub(super) fn rows(&self, runner: &Runner<'_>) -> Result<Vec<Row>> {
        let mut rows = self.errors.rows(runner)?;
        rows.extend(self.detection.rows(runner)?);
        rows.extend(self.real.rows(runner)?);
        rows.extend(self.learn.rows(runner)?);
        rows.extend(self.several.rows(runner)?);
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runner::on_study_stack;

    #[test]
    fn rows_are_chosen_by_their_names() {
        let drive = || Drive::puncture(Plant::Car, 80.0).unwrap();
        assert_eq!(drive().only(None).unwrap().setups.len(), 2);
        assert_eq!(drive().only(Some("80 km/h")).unwrap().setups.len(), 2);
        assert_eq!(drive().only(Some("reset")).unwrap().setups, [Setup::RESET]);
        assert!(drive().only(Some("quarters")).is_none());
    }

    /// Drives on which the softer wheel's slower hop was once taken for a sensor whose gain had changed, and what had just been
    /// learned was given up.
    #[test]
    fn a_puncture_is_believed_for_good() {
        on_study_stack(|| [2, 3, 7].map(assert_believed));
    }

    fn assert_believed(seed: u64) {
        let drive = Drive::puncture(Plant::Car, 80.0).unwrap();
        let mut worst_kpa = 0.0f64;
        let look = |_, row: &SimRow, estimate: &CarEstimate<f64>| {
            let (truth, found) = (row.corners[0].unwrap(), estimate.corners[0].unwrap());
            if drive.after.contains(row.time_s) {
                assert!(found.validity.is_valid(), "seed {seed}, {} s: {found:?}", row.time_s);
                worst_kpa = worst_kpa.max((found.pressure_kpa - truth.pressure_kpa).abs());
            }
        };
        drive.clone().with_setups(&[Setup::USUAL]).drive(seed, look).unwrap();
        assert!(worst_kpa < 12.0, "seed {seed}: {worst_kpa} kPa");
    }

    #[test]
    fn no_disturbance_is_known_to_the_estimator() {
        let drive = Drive::puncture(Plant::Quarters, 20.0).unwrap();
        let other = drive.clone().with_rear_offset_m(0.02).each_corner(|_, spec| {
            spec.truth.unsprung_mass_factor = 1.03;
        });
        assert_eq!(drive.file_config().unwrap(), other.file_config().unwrap());
    }
}
