//! The estimator of a drive's car, whichever was chosen.

use itpms_core::car::CarEstimator;
use itpms_core::estimator::OutsideStiffness;
use itpms_core::model::{
    Air, CalibrationError, CarConfig, CarEstimate, CarSample, Corner, ParameterError, VehicleCalibration,
};
use itpms_core::monitor::{MonitorConfig, MonitoredCar, MonitoredWheels};
use itpms_core::torsion::CarTorsion;
use itpms_core::warning::MonitorReport;
use itpms_paper::{EstimatorKind, PaperCar};

/// A running estimator of a car, in its box: by value it would cross the stack, and whose that is the caller alone knows.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AnyCar {
    /// The default estimator; beside one of the paper's it has no corners, only wheel speeds and tooth pulses.
    car: Box<MonitoredCar<f64, Option<Box<CarTorsion<f64>>>>>,
    /// One of the paper's filters on each corner.
    paper: Option<Box<PaperCar<f64>>>,
}

impl AnyCar {
    /// An estimator of `kind` for samples that come at about `sample_rate_hz`; of a car without corners wheel speeds are all there is.
    /// Errors: the rate must be positive and finite; limits and parameters that the estimator refuses are named.
    pub fn new(
        kind: EstimatorKind,
        config: &MonitorConfig<f64>,
        sample_rate_hz: f64,
    ) -> Result<Self, ParameterError> {
        let (mut car, mut paper) = (Box::new(MonitoredCar::unconfigured_with(None)), None);
        if kind == EstimatorKind::Informed || !config.car.has_corners() {
            car.configure(config, sample_rate_hz)?;
        } else {
            let without_corners = CarConfig { corners: [None; 4], ..config.car };
            car.configure(&MonitorConfig { car: without_corners, ..*config }, sample_rate_hz)?;
            paper = Some(Box::new(PaperCar::new(kind, config, sample_rate_hz)?));
        }
        Ok(Self { car, paper })
    }

    pub fn estimator(&self) -> Option<&CarEstimator<f64>> {
        self.paper.is_none().then(|| self.car.estimator())
    }

    /// Takes the stiffness of a corner's tire that another source follows, which the paper's filters have no use for.
    pub fn follow(&mut self, corner: Corner, stiffness: Option<OutsideStiffness<f64>>) {
        self.car.follow(corner, stiffness);
    }

    /// Takes what the car says of the air around it, which the paper's filters have no use for.
    pub fn follow_air(&mut self, air: &Air<f64>) {
        self.car.follow_air(air);
    }

    /// All tires have their pressures from the next sample on, for `seconds`: the placards', or for wheel speeds and tooth pulses so much
    /// of them. Errors: the length must be positive and finite.
    pub fn begin_calibration(
        &mut self,
        seconds: f64,
        pressure_share: &[f64; 4],
    ) -> Result<(), ParameterError> {
        self.car.begin_calibration_at(seconds, pressure_share)?;
        self.paper.as_mut().map_or(Ok(()), |paper| paper.begin_calibration(seconds))
    }

    pub fn end_calibration(&mut self) {
        self.car.end_calibration();
    }

    /// Begins with what an earlier drive taught, which the paper's filters have no use for.
    /// Errors: an implausible calibration, or one of other corners or other placard pressures.
    pub fn load_calibration(
        &mut self,
        calibration: &VehicleCalibration<f64>,
    ) -> Result<(), CalibrationError> {
        self.paper.as_ref().map_or_else(|| self.car.load_calibration(calibration), |_| Ok(()))
    }

    /// Takes one sample; gives the estimate after it.
    pub fn update(&mut self, sample: &CarSample<f64>) -> CarEstimate<f64> {
        let Some(paper) = &mut self.paper else { return self.car.update(sample) };
        let estimate = paper.update(sample);
        if let Some(message) = sample.wheel_speeds {
            self.car.update(&CarSample::of_wheel_speeds(message));
        }
        if let Some(wheels) = self.car.wheels() {
            paper.follow_wheels(wheels);
        }
        estimate
    }

    /// Analyses tooth pulses from here on.
    pub fn read_pulses(&mut self, torsion: Box<CarTorsion<f64>>) {
        self.car.read_pulses(torsion);
    }

    /// The analysis of the tooth pulses, where they are read.
    pub fn torsion(&self) -> Option<&CarTorsion<f64>> {
        self.car.torsion()
    }

    /// The same, to take pulses in.
    pub fn torsion_mut(&mut self) -> Option<&mut CarTorsion<f64>> {
        self.car.torsion_mut()
    }

    /// The monitor of the wheel speeds, where they are used.
    pub fn wheels(&self) -> Option<&MonitoredWheels<f64>> {
        self.car.wheels()
    }

    /// The same, to be prepared for the drive.
    pub fn wheels_mut(&mut self) -> Option<&mut MonitoredWheels<f64>> {
        self.car.wheels_mut()
    }

    /// The monitors' reports after the last sample.
    pub fn report(&self) -> &MonitorReport<f64> {
        self.paper.as_ref().map_or_else(|| self.car.report(), |paper| paper.report())
    }

    /// Whether the speed says that the car stands while its wheels roll.
    pub fn denies_standstill(&self) -> bool {
        self.paper.as_ref().map_or_else(|| self.car.denies_standstill(), |paper| paper.denies_standstill())
    }
}
