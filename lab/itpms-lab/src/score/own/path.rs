//! An owner's path: what the first day teaches, and what is known on a later one.
//!
//! Called by the plan. It calls what the commands call: `vehicle init`'s file, `vehicle learn`'s listener, a calibration of ten minutes
//! whose reference is kept.
use itpms_core::model::{CarConfig, Corner, VehicleCalibration};
use itpms_core::monitor::MonitoredCar;
use itpms_core::wheel_speed::RadiusCalibration;
use itpms_data::Vehicle;
use itpms_data::reference::StoredReference;
use itpms_sim::scenario::Scenario;
use itpms_sim::simulation::{SimRow, Simulation};
use itpms_sim::time_profile::Pressure;

use super::car::OwnCar;
use super::day::{Change, Day, RATE_HZ, SAME};
use super::seen::{LOSS_S, Seen};
use crate::runner::{Result, StudyError};
use crate::sensors::equipped;
use crate::tuning::monitor;
use itpms_analysis::learn::{Listener, PASSES, WheelbaseListener, learn};

/// Ten minutes at placard pressures, and a later day, in s.
pub(super) const DAYS_S: [f64; 2] = [600.0, 130.0];
/// Remaining share of a pressure after a loss on the later day.
const LEFT: f64 = 0.8;

itpms_core::labelled! {
    /// What an owner gives the estimator on a later day.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub(super) enum Way {
        LearnedAndReference = "learned and reference",
        FileAndReference = "file and reference",
        Learned = "learned",
    }
}

/// A car's file, and what a calibration has taught, if it taught what a program would load.
pub(super) struct Taught {
    config: CarConfig<f64>,
    calibration: Option<VehicleCalibration<f64>>,
    wheels: Option<RadiusCalibration<f64>>,
}

pub(super) struct Owned {
    index: usize,
    car: OwnCar,
    later: Day,
    learned: Taught,
    file: Taught,
}

impl Owned {
    /// Draws the car of a turn, drives its ten minutes, and learns of them as far as the ways need it.
    pub(super) fn teach(index: usize, seed: u64, ways: &[Way], wheel_speeds: bool) -> Result<Self> {
        let car = OwnCar::draw(index, seed)?;
        let [mut first, mut later] = Day::two(index, seed, DAYS_S);
        if wheel_speeds {
            (first.wheel_speeds, later.wheel_speeds) = (Some(seed), Some(seed));
        }
        let (scenario, drive_seed) = first.scenario(&car, &SAME, None)?;
        let rows: Vec<SimRow> = Simulation::new(&scenario, drive_seed)?.collect();
        let learned = match ways.contains(&Way::LearnedAndReference) || ways.contains(&Way::Learned) {
            true => learned(&car, &rows)?,
            false => car.file.car_config(&Corner::ALL),
        };
        let mut taught = [Taught { config: learned, calibration: None, wheels: None }, Taught::of(&car.file)];
        for (way, taught) in [Way::LearnedAndReference, Way::FileAndReference].into_iter().zip(&mut taught) {
            if ways.contains(&way) {
                taught.calibrate(&car.file, &rows, &scenario)?;
            }
        }
        let [learned, file] = taught;
        Ok(Self { index, car, later, learned, file })
    }

    pub(super) fn has_reference(&self, way: Way) -> bool {
        match way {
            Way::LearnedAndReference => self.learned.calibration.is_some(),
            Way::FileAndReference => self.file.calibration.is_some(),
            Way::Learned => true,
        }
    }

    fn estimator(&self, way: Way, scenario: &Scenario) -> Result<Box<MonitoredCar<f64>>> {
        let taught = if way == Way::FileAndReference { &self.file } else { &self.learned };
        let mut estimator = equipped(&monitor(&taught.config), scenario)?;
        if let Some(calibration) = taught.calibration.as_ref().filter(|_| way != Way::Learned) {
            estimator.load_calibration(calibration)?;
            if let (Some(wheels), Some(taught)) = (estimator.wheels_mut(), &taught.wheels) {
                // One that no program would load is none.
                let _ = wheels.load_calibration(taught);
            }
        }
        Ok(estimator)
    }

    /// The later day with nothing changed, by every way: without a loss and with one, which are the same drive until it begins.
    pub(super) fn later(&self, ways: &[Way]) -> Result<Vec<[Seen; 2]>> {
        let struck = Corner::ALL[self.index % 4];
        let kpa = self.car.placard_kpa;
        let loss = Pressure::ramp(kpa, LEFT * kpa, LOSS_S[0], LOSS_S[1]);
        let simulation = |lost| {
            let (scenario, seed) = self.later.scenario(&self.car, &SAME, lost)?;
            Ok::<_, StudyError>(Simulation::new(&scenario, seed)?)
        };
        let mut estimators = vec![];
        let (scenario, _) = self.later.scenario(&self.car, &SAME, None)?;
        for &way in ways {
            estimators.push((self.estimator(way, &scenario)?, None, [Seen::sound(), Seen::losing(struck)]));
        }
        for (sound, lost) in simulation(None)?.zip(simulation(Some((struck, loss)))?) {
            for (car, losing, [seen, seen_losing]) in &mut estimators {
                if lost.time_s >= LOSS_S[0] {
                    take(losing.get_or_insert_with(|| car.clone()), &lost, &mut [seen_losing]);
                    take(car, &sound, &mut [seen]);
                } else {
                    take(car, &sound, &mut [seen, seen_losing]);
                }
            }
        }
        Ok(estimators.into_iter().map(|(_, _, seen)| seen).collect())
    }

    /// A later day of a car that has changed, no tire losing air, with what was learned and the reference.
    pub(super) fn changed(&self, change: &Change) -> Result<Seen> {
        let (scenario, seed) = self.later.scenario(&self.car, change, None)?;
        let (mut car, mut seen) = (self.estimator(Way::LearnedAndReference, &scenario)?, Seen::sound());
        for row in Simulation::new(&scenario, seed)? {
            take(&mut car, &row, &mut [&mut seen]);
        }
        Ok(seen)
    }
}

fn take(car: &mut MonitoredCar<f64>, row: &SimRow, seen: &mut [&mut Seen]) {
    let estimate = car.update(&row.car_sample());
    for seen in seen {
        seen.take(row, &estimate, car.report());
    }
}

/// The car of the file as the drive shows it, its wheelbase first.
fn learned(car: &OwnCar, rows: &[SimRow]) -> Result<CarConfig<f64>> {
    let mut file = car.file.car_config(&Corner::ALL);
    let mut listener = WheelbaseListener::new(&file, RATE_HZ);
    rows.iter().for_each(|row| listener.take(&row.car_sample()));
    file.wheelbase_m = listener.finish().map(|found| found.wheelbase_m).or(file.wheelbase_m);
    let mut config = file;
    for _ in 0..PASSES {
        let mut listener = Listener::new(&config, [car.placard_kpa; 4], RATE_HZ)?;
        rows.iter().for_each(|row| listener.take(&row.car_sample()));
        config = learn(&file, &[listener.finish()])?.car;
    }
    Ok(config)
}

impl Taught {
    fn of(file: &Vehicle) -> Self {
        Self { config: file.car_config(&Corner::ALL), calibration: None, wheels: None }
    }

    /// By a calibration that lasts as long as the drive, and a reference that is stored and read again; one that is refused is none.
    fn calibrate(&mut self, file: &Vehicle, rows: &[SimRow], scenario: &Scenario) -> Result<()> {
        let mut car = equipped(&monitor(&self.config), scenario)?;
        car.begin_calibration(DAYS_S[0])?;
        for row in rows {
            car.update(&row.car_sample());
        }
        car.end_calibration();
        self.wheels = car.wheels().and_then(|wheels| wheels.calibration().copied());
        let Some(calibration) = car.estimator().calibration() else { return Ok(()) };
        let file = Vehicle { wheelbase_m: self.config.wheelbase_m, ..file.clone() };
        if let Ok(stored) = StoredReference::new(&file, calibration, 0) {
            self.config.wheelbase_m = stored.wheelbase_m.or(file.wheelbase_m);
            self.calibration = Some(stored.reference);
        }
        Ok(())
    }
}
