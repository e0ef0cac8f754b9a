//! Cars that are drawn from what a file says of how well it is known, and what is learned of them.
//!
//! Called by `learn`. The file is that of `drive-puncture`, known as one of confidence `typical` or as one that `itpms vehicle init` wrote;
//! masses, tires, springs, dampers, friction and the slope of stiffness over pressure are drawn from its standard deviations, sensors as those of
//! `drive-normal`.

use itpms_core::model::{CarConfig, Confidence, Corner, ParameterUncertainty, VehicleCalibration};
use itpms_core::monitor::MonitoredCar;
use itpms_sim::road::{RoadClass, RoadSpec};
use itpms_sim::scenario::{Scenario, ToleranceSpec};
use itpms_sim::simulation::Simulation;
use itpms_sim::time_profile::{Pressure, Speed};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::real_list::two_passengers;
use super::{Drive, Plant};
use crate::runner::Result;
use crate::tuning::monitor;
use itpms_analysis::learn::{DriveReading, Learned, Listener, PASSES, learn};

pub(super) const RATE_HZ: f64 = 200.0;
pub(super) const PLACARD_KPA: f64 = 241.3;
const KM_H: [f64; 2] = [80.0, 60.0];
const CLASSES: [RoadClass; 3] = [RoadClass::A, RoadClass::B, RoadClass::C];
/// Standard deviations beyond which nothing is drawn.
const FARTHEST: f64 = 2.5;
/// By how much one tire of a car differs from the others, at most: wear, age and production, whatever is known of their make.
const OWN_TIRE_SD: f64 = 0.024;
/// Standard deviation of a slope that no file speaks of.
const SLOPE_SD: f64 = 0.05;
/// Seeds of the drives of one car.
const LATER: u64 = 1 << 32;

/// A file's confidence, and the pressures in kPa at which the ten minutes are driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Subject {
    pub(super) name: &'static str,
    pub(super) by_size: bool,
    pub(super) pressures_kpa: &'static [f64],
    pub(super) learning_s: f64,
}

impl Subject {
    /// How well the file is known: as `itpms vehicle init` says, or as typical ones are.
    pub(super) fn known(&self) -> ParameterUncertainty<f64> {
        let typical = ParameterUncertainty::of(Confidence::Typical);
        if !self.by_size {
            return typical;
        }
        ParameterUncertainty {
            unsprung_mass_relative_sd: 0.15,
            spring_relative_sd: 0.25,
            damping_relative_sd: 0.30,
            stiffness_relative_sd: 0.08,
            friction_n: 40.0,
            friction_sd_n: 30.0,
            ..typical
        }
    }
}

#[derive(Debug, Clone)]
pub(super) struct DrawnCar {
    pub(super) file: CarConfig<f64>,
    /// The scenario, on the road of the learning drive, at placard pressures.
    pub(super) scenario: Scenario,
    seed: u64,
}

/// A corner's parameters, in the units of [`itpms_analysis::learn::LearnedCorner`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Truth {
    pub(super) unsprung_mass_kg: f64,
    pub(super) tire_n_per_m: f64,
    pub(super) damping_n_s_per_m: f64,
    pub(super) spring_n_per_m: f64,
    pub(super) friction_n: f64,
    pub(super) slope: f64,
}

struct Source(Pcg64);

impl Source {
    fn normal(&mut self) -> f64 {
        loop {
            let drawn: f64 = StandardNormal.sample(&mut self.0);
            if drawn.abs() <= FARTHEST {
                return drawn;
            }
        }
    }

    /// Factors of the four corners: `exp` of a deviation of which so much is common, so much by axle, so much of each.
    fn parts(&mut self, sd: f64, common: f64, axle: f64, own: f64) -> [f64; 4] {
        let all = common * self.normal();
        let axles = [self.normal(), self.normal()];
        std::array::from_fn(|i| (sd * (all + axle * axles[i / 2] + own * self.normal())).exp())
    }
}

impl DrawnCar {
    pub(super) fn draw(subject: &Subject, index: usize, seed: u64) -> Result<Self> {
        let mut drive = Drive::puncture(Plant::Car, KM_H[0])?
            .each_corner(|_, spec| spec.pressure = Pressure::ConstantKpa(PLACARD_KPA));
        drive.scenario.rate_hz = RATE_HZ;
        drive.scenario.road = road(index);
        let known = subject.known();
        let mut file = drive.file_config()?;
        file.corners.iter_mut().flatten().for_each(|corner| corner.uncertainty = known);
        let mut draw = Source(Pcg64::seed_from_u64(seed));
        let slope = (SLOPE_SD * draw.normal()).exp();
        let sprung = draw.parts(known.sprung_mass_relative_sd, 0.8, 0.6, 0.0);
        let unsprung = draw.parts(known.unsprung_mass_relative_sd, 0.8, 0.6, 0.0);
        let own = (OWN_TIRE_SD / known.stiffness_relative_sd).min(0.8);
        let tire = draw.parts(known.stiffness_relative_sd, (1.0 - own * own).sqrt(), 0.0, own);
        let spring = draw.parts(known.spring_relative_sd, 0.0, 1.0, 0.0);
        let damping = draw.parts(known.damping_relative_sd, 0.0, 0.8, 0.6);
        let mut drive = drive.each_corner(|corner, spec| {
            let i = corner.index();
            let truth = &mut spec.truth;
            truth.sprung_mass_factor *= sprung[i];
            truth.unsprung_mass_factor *= unsprung[i];
            truth.tire_stiffness_factor *= tire[i];
            truth.spring_factor *= spring[i];
            truth.damping_factor *= damping[i];
            truth.friction_n = (known.friction_n + known.friction_sd_n * draw.normal()).max(0.0);
            let tire_damping = known.tire_damping_n_s_per_m + known.tire_damping_sd_n_s_per_m * draw.normal();
            truth.tire_damping_n_s_per_m = tire_damping.max(0.0);
            let at_placard = spec.tire.stiffness_per_kpa * PLACARD_KPA + spec.tire.stiffness_at_zero;
            spec.tire.stiffness_per_kpa *= slope;
            spec.tire.stiffness_at_zero = at_placard - spec.tire.stiffness_per_kpa * PLACARD_KPA;
        });
        let sensors = ToleranceSpec {
            sprung_mass: 0.0,
            unsprung_mass: 0.0,
            damping: 0.0,
            spring: 0.0,
            tire_stiffness: 0.0,
            ..ToleranceSpec::default()
        };
        sensors.apply(seed, &mut drive.scenario);
        Ok(Self { file, scenario: drive.scenario, seed })
    }

    pub(super) fn truth(&self, corner: Corner) -> Option<Truth> {
        let (spec, nominal) =
            (self.scenario.corner.get(corner)?, self.file.corners[corner.index()].as_ref()?);
        let (truth, car) = (&spec.truth, &nominal.quarter_car);
        let at_placard = spec.tire.stiffness_per_kpa * PLACARD_KPA + spec.tire.stiffness_at_zero;
        Some(Truth {
            unsprung_mass_kg: truth.unsprung_mass_factor * car.unsprung_mass_kg(),
            tire_n_per_m: truth.tire_stiffness_factor * at_placard,
            damping_n_s_per_m: truth.damping_factor * car.damping_n_s_per_m(),
            spring_n_per_m: truth.spring_factor * car.spring_n_per_m(),
            friction_n: truth.friction_n,
            slope: spec.tire.stiffness_per_kpa / nominal.tire.stiffness_per_kpa(),
        })
    }

    /// What its learning drives teach, and what a calibration with the learned car does in the first of them.
    pub(super) fn learn(&self, subject: &Subject) -> Result<(Learned, Option<VehicleCalibration<f64>>)> {
        let drives: Vec<([f64; 4], Vec<_>)> = subject
            .pressures_kpa
            .iter()
            .enumerate()
            .map(|(number, &kpa)| {
                let mut scenario = self.scenario.clone();
                scenario.duration_s = subject.learning_s / subject.pressures_kpa.len() as f64;
                scenario.corner.iter_mut().for_each(|(_, spec)| spec.pressure = Pressure::ConstantKpa(kpa));
                let seed = self.seed.wrapping_add(number as u64 * LATER / 2);
                let rows = Simulation::new(&scenario, seed)?.map(|row| row.car_sample()).collect();
                Ok(([kpa; 4], rows))
            })
            .collect::<Result<_>>()?;
        let mut config = self.file;
        let mut learned = None;
        for _ in 0..PASSES {
            let mut readings: Vec<DriveReading> = vec![];
            for (pressures_kpa, rows) in &drives {
                let mut listener = Listener::new(&config, *pressures_kpa, RATE_HZ)?;
                rows.iter().for_each(|row| listener.take(row));
                readings.push(listener.finish());
            }
            let now = learn(&self.file, &readings)?;
            config = now.car;
            learned = Some(now);
        }
        let learned = learned.ok_or(itpms_analysis::learn::LearnError::NoDrive)?;
        // At the placard's pressure; the drive at another one is none.
        let mut calibration = None;
        if let Some((_, rows)) = drives.iter().find(|(kpa, _)| *kpa == [PLACARD_KPA; 4]) {
            let mut car = estimator(&learned.car)?;
            car.begin_calibration(subject.learning_s)?;
            for row in rows {
                car.update(row);
            }
            car.end_calibration();
            // One that no program would load is none.
            calibration = car.estimator().calibration().filter(|learned| learned.check().is_ok());
        }
        Ok((learned, calibration))
    }

    /// Another drive of the car: the next class of road, slower, every other car with two passengers.
    pub(super) fn later(&self, index: usize, duration_s: f64) -> (Scenario, u64) {
        let mut scenario = self.scenario.clone();
        scenario.duration_s = duration_s;
        scenario.road = road(index + 1);
        scenario.speed = Speed::ConstantKmH(KM_H[1]);
        if let Some(car) = scenario.car.as_mut().filter(|_| index % 2 == 1) {
            car.payload = two_passengers();
        }
        (scenario, self.seed.wrapping_add(LATER))
    }
}

fn road(index: usize) -> RoadSpec {
    RoadSpec { contact_length_m: 0.1, ..RoadSpec::iso8608(CLASSES[index % CLASSES.len()], 2.0) }
}

/// An estimator of this car under its monitor, at [`RATE_HZ`].
pub(super) fn estimator(config: &CarConfig<f64>) -> Result<Box<MonitoredCar<f64>>> {
    let mut car = Box::new(MonitoredCar::unconfigured());
    car.configure(&monitor(config), RATE_HZ)?;
    Ok(car)
}
