//! The car between two steps: what was set, the drive that it began, and what can be read. Knows neither version of the interface.

use std::path::Path;
use std::thread;

use itpms_analysis::suspension::SuspensionVerdict;
use itpms_core::conditioning::SAMPLE_RATES_HZ;
use itpms_core::model::{Air, CarEstimate, Corner, CornerConfig, PressureMap, QuarterCar};
use itpms_core::warning::Cause;
use itpms_data::log::{LogCorner, LogMotion};
use itpms_data::out::WheelSpeedUse;
use itpms_data::reference::crc64;
use itpms_data::{LogRow, Vehicle};
use itpms_drive::{Drive, DriveError, Settings};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::outputs::{all_fine, code, cold_add, cold_pressure, state};
use crate::struts::{Struts, damper, load};
use crate::variables::{Causality, OfCar, OfCorner, Role, Variable, parameter, variables};

/// How a saved state begins: what it is, its format and the program's version, which has to be the same.
const MAGIC: &str = concat!("itpms-fmu-state 7 ", env!("CARGO_PKG_VERSION"), " ");
/// Wheel speeds alone come at least so often.
const WHEEL_SPEED_RATE_HZ: f64 = 9.5;
/// Stack for building a car from bytes; a simulation tool's thread may have less.
const STACK_BYTES: usize = 32 << 20;

/// Why a step, or what comes before it, did not happen.
#[derive(Debug, Error)]
pub enum ModelError {
    #[error("{0}")]
    Vehicle(String),
    #[error(transparent)]
    Refused(#[from] itpms_core::ParameterError),
    #[error(transparent)]
    Drive(#[from] DriveError),
    #[error(
        "a step of {0} s, expected {1}: a step is the time between two samples, which the tool sets (FMPy: step_size=0.002, output_interval=0.002)"
    )]
    Step(f64, &'static str),
    #[error("a step {0}, expected it after the initialization and before the end")]
    Order(&'static str),
    #[error("the saved state {0}")]
    State(String),
}

#[derive(Debug, Clone)]
pub struct Model {
    file: Vehicle,
    variables: Vec<Variable>,
    values: Vec<f64>,
    drive: Option<Box<Drive>>,
    struts: Option<Struts>,
    phase: Phase,
}

/// Phase of a unit's life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    Made,
    /// Initialized: it can be stepped.
    Initialized,
    /// Terminated: only a reset goes on.
    Terminated,
}

impl Model {
    /// A car as its vehicle file has it, before anything is set.
    pub fn new(file: Vehicle) -> Self {
        let variables = variables(&file);
        let values = variables.iter().map(|variable| variable.start).collect();
        Self { file, variables, values, drive: None, struts: None, phase: Phase::Made }
    }

    /// The same of the vehicle file in a folder of resources.
    pub fn of_resources(folder: &Path) -> Result<Self, ModelError> {
        let path = folder.join(crate::package::VEHICLE_FILE);
        Vehicle::read(&path).map(Self::new).map_err(|error| ModelError::Vehicle(error.to_string()))
    }

    pub fn vehicle(&self) -> &Vehicle {
        &self.file
    }

    /// The variables; a value reference is a place among them.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    pub fn get(&self, reference: u32) -> Option<(&Variable, f64)> {
        let index = usize::try_from(reference).ok()?;
        self.variables.get(index).zip(self.values.get(index).copied())
    }

    /// Sets a variable. Whether it may be set now: inputs always, parameters until the first step.
    pub fn set(&mut self, reference: u32, value: f64) -> bool {
        let Ok(index) = usize::try_from(reference) else { return false };
        let may = match self.variables.get(index).map(|variable| variable.causality) {
            Some(Causality::Input) => true,
            Some(Causality::Parameter) => self.drive.is_none(),
            _ => false,
        };
        if may && let Some(place) = self.values.get_mut(index) {
            *place = value;
        }
        may
    }

    /// As before anything was set.
    pub fn reset(&mut self) {
        *self = Self::new(self.file.clone());
    }

    /// The tool has initialized or terminated it. Errors: it was terminated before.
    pub fn enter(&mut self, phase: Phase) -> Result<(), ModelError> {
        if self.phase == Phase::Terminated {
            return Err(ModelError::Order("or an initialization after the end"));
        }
        self.phase = phase;
        Ok(())
    }

    /// Takes the inputs as the sample at `time_s`; what can be read then is what is known after it. The first step begins the drive, and
    /// says how many samples a second to expect. Errors: a step before the initialization, after the end or of no length, a first one that
    /// is no time between two samples; a parameter that the estimator refuses.
    pub fn step(&mut self, time_s: f64, step_s: f64) -> Result<(), ModelError> {
        match self.phase {
            Phase::Made => return Err(ModelError::Order("before the initialization")),
            Phase::Initialized => {}
            Phase::Terminated => return Err(ModelError::Order("after the end")),
        }
        if !(step_s > 0.0 && step_s.is_finite() && time_s.is_finite()) {
            return Err(ModelError::Step(step_s, "a positive, finite length"));
        }
        let corners = self.measured();
        if self.drive.is_none() {
            let rate_hz = step_s.recip();
            if !corners.is_empty() && !SAMPLE_RATES_HZ.contains(&rate_hz) {
                return Err(ModelError::Step(step_s, "0.0005 to 0.01 s"));
            } else if rate_hz < WHEEL_SPEED_RATE_HZ {
                return Err(ModelError::Step(step_s, "at most 0.1 s"));
            }
            self.drive = Some(Box::new(self.begin(&corners, step_s.recip())?));
            self.struts = Some(Struts::new(&self.as_set()?, &corners, time_s, step_s, self.calibrate_s()));
        }
        let mut row = self.row(time_s, &corners);
        let Some(drive) = &mut self.drive else { return Ok(()) };
        let estimate = drive.update(&mut row);
        let verdict = self.struts.as_mut().and_then(|struts| struts.take(&row));
        self.write(time_s + step_s, &estimate, verdict.as_ref());
        Ok(())
    }

    fn value(&self, role: Role) -> f64 {
        let place = self.variables.iter().position(|variable| variable.role == role);
        place.and_then(|place| self.values.get(place)).copied().unwrap_or(f64::NAN)
    }

    fn measured(&self) -> Vec<Corner> {
        let is = |corner: &Corner| self.value(Role::Corner(*corner, OfCorner::IsMeasured)) > 0.5;
        Corner::ALL.into_iter().filter(is).collect()
    }

    fn begin(&self, corners: &[Corner], rate_hz: f64) -> Result<Drive, ModelError> {
        let vehicle = self.as_set()?;
        let wheel_speeds = match self.value(Role::Car(OfCar::UsesWheelSpeeds)) > 0.5 {
            false => WheelSpeedUse::None,
            true if corners.is_empty() => WheelSpeedUse::Alone,
            true => WheelSpeedUse::Beside,
        };
        if corners.is_empty() && wheel_speeds == WheelSpeedUse::None {
            let what = "no corner is measured and no wheel speeds are used".to_owned();
            return Err(DriveError::Mismatch(what).into());
        }
        let settings = Settings { calibrate_s: self.calibrate_s(), ..Settings::default() };
        let drive = Drive::new(&settings, &vehicle, corners, wheel_speeds, rate_hz)?;
        Ok(drive.with_road(&vehicle, corners, rate_hz)?)
    }

    fn calibrate_s(&self) -> Option<f64> {
        Some(self.value(Role::Car(OfCar::CalibrateS))).filter(|seconds| *seconds != 0.0)
    }

    fn as_set(&self) -> Result<Vehicle, ModelError> {
        let mut vehicle = self.file.clone();
        vehicle.wheelbase_m =
            Some(self.value(Role::Car(OfCar::Wheelbase))).filter(|length_m| *length_m != 0.0);
        for (corner, config) in Corner::ALL.into_iter().zip(&mut vehicle.corners) {
            if let Some(config) = config {
                self.apply(corner, config)?;
            }
        }
        Ok(vehicle)
    }

    fn apply(&self, corner: Corner, config: &mut CornerConfig<f64>) -> Result<(), ModelError> {
        let of = |of| self.value(Role::Corner(corner, of));
        let is_new = |what| Some(of(what)) != parameter(&self.file, corner, what);
        config.quarter_car = QuarterCar::new(
            of(OfCorner::SprungMass),
            of(OfCorner::UnsprungMass),
            of(OfCorner::Damping),
            of(OfCorner::Spring),
        )?;
        // Another line is one without the file's standard deviations of its coefficients.
        if is_new(OfCorner::StiffnessPerKpa) || is_new(OfCorner::StiffnessAtZero) {
            config.tire = PressureMap::new(of(OfCorner::StiffnessPerKpa), of(OfCorner::StiffnessAtZero))?;
        }
        let checked = CornerConfig::new(config.quarter_car, config.tire, of(OfCorner::Placard))?;
        config.placard_kpa = checked.placard_kpa;
        Ok(())
    }

    fn row(&self, time_s: f64, corners: &[Corner]) -> LogRow {
        let car = |of| self.value(Role::Car(of));
        let of_corner = |corner, of| self.value(Role::Corner(corner, of));
        let logged = |corner: Corner| {
            LogCorner::measured(
                of_corner(corner, OfCorner::BodyAccel),
                of_corner(corner, OfCorner::WheelAccel),
            )
        };
        LogRow {
            time_s,
            speed_m_s: car(OfCar::Speed),
            corners: Corner::ALL.map(|corner| corners.contains(&corner).then(|| logged(corner))),
            motion: LogMotion {
                wheel_speed_m_s: Corner::ALL.map(|corner| of_corner(corner, OfCorner::WheelSpeed)),
                yaw_rate_rad_s: car(OfCar::YawRate),
                accel_x_m_s2: car(OfCar::AccelX),
                accel_y_m_s2: car(OfCar::AccelY),
                brake: car(OfCar::Brake),
                air: Air {
                    ambient_temperature_c: car(OfCar::AmbientTemperature),
                    barometric_kpa: car(OfCar::Barometric),
                    altitude_m: car(OfCar::Altitude),
                },
                ..LogMotion::UNKNOWN
            },
        }
    }

    /// Writes the outputs after a sample; of dampers and load where they were worked out after it.
    fn write(&mut self, now_s: f64, estimate: &CarEstimate<f64>, verdict: Option<&SuspensionVerdict>) {
        let Some(drive) = &self.drive else { return };
        let report = drive.report();
        let (taught, radii) = (drive.learned(), drive.radii());
        let placards_kpa = Corner::ALL.map(|corner| self.value(Role::Corner(corner, OfCorner::Placard)));
        let flag = |holds: bool| f64::from(u8::from(holds));
        for (variable, value) in self.variables.iter().zip(&mut self.values) {
            let written = match variable.role {
                Role::Time => Some(now_s),
                Role::Car(of) => match of {
                    OfCar::AnyLow => Some(flag(report.alerts().any(|alert| alert.cause.is_low()))),
                    OfCar::AnyMalfunction => {
                        Some(flag(report.alerts().any(|alert| matches!(alert.cause, Cause::Malfunction(_)))))
                    }
                    OfCar::AllFine => Some(flag(all_fine(&self.file, report))),
                    OfCar::Alerts => Some(report.alerts().count() as f64),
                    OfCar::Calibrated => {
                        Some(flag(taught.corners.is_some() || taught.wheel_speeds.is_some()))
                    }
                    _ => verdict.and_then(|verdict| load(verdict, of)),
                },
                Role::Corner(corner, of) => {
                    let (found, wheel) = (estimate.corners[corner.index()], report.wheels[corner.index()]);
                    let number = |number: fn(&itpms_core::CornerEstimate<f64>) -> f64| {
                        Some(found.as_ref().map_or(f64::NAN, number))
                    };
                    let rolls = |number: fn(&itpms_core::wheel_speed::WheelRadius<f64>) -> f64| {
                        let wheel = radii.as_ref().map(|row| &row.radii.wheels[corner.index()]);
                        Some(wheel.map_or(f64::NAN, number))
                    };
                    match of {
                        OfCorner::Pressure => number(|e| e.pressure_kpa),
                        OfCorner::PressureSd => number(|e| e.pressure_sd_kpa),
                        OfCorner::Lost => number(|e| e.lost_kpa()[0]),
                        OfCorner::LostSd => number(|e| e.lost_kpa()[1]),
                        OfCorner::ColdPressure => number(|e| cold_pressure(e)[0]),
                        OfCorner::ColdPressureSd => number(|e| cold_pressure(e)[1]),
                        OfCorner::ColdAdd => Some(cold_add(found.as_ref(), placards_kpa[corner.index()])[0]),
                        OfCorner::ColdState => {
                            Some(cold_add(found.as_ref(), placards_kpa[corner.index()])[1])
                        }
                        OfCorner::LostShare => rolls(|wheel| wheel.lost_share),
                        OfCorner::LostShareSd => rolls(|wheel| wheel.lost_share_sd),
                        OfCorner::DetectableLoss => rolls(|wheel| wheel.detectable_loss_share),
                        OfCorner::Stiffness => number(|e| e.stiffness_n_per_m),
                        OfCorner::Road => number(|e| e.road_m),
                        OfCorner::RoadSd => number(|e| e.road_sd_m),
                        OfCorner::Valid => Some(flag(found.is_some_and(|e| e.validity.is_valid()))),
                        OfCorner::State => Some(wheel.map_or(0.0, |wheel| state(wheel.state))),
                        OfCorner::Warning => {
                            let warning = found.map(|e| e.warning).or(wheel.map(|wheel| wheel.warning));
                            Some(warning.map_or(0.0, code))
                        }
                        _ => verdict.and_then(|verdict| damper(&verdict.dampers[corner.index()], of)),
                    }
                }
            };
            *value = written.unwrap_or(*value);
        }
    }

    /// All of it as bytes, with its version and a checksum. Errors: it cannot be written, which a car of ours always can.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ModelError> {
        let body =
            postcard::to_stdvec(&(self.file.to_toml(), &self.values, &self.drive, &self.struts, self.phase))
                .map_err(|error| ModelError::State(format!("cannot be written: {error}")))?;
        let head = format!("{MAGIC}{:016x}\n", crc64(&[&body]));
        Ok([head.as_bytes(), &body].concat())
    }

    /// Goes on from such bytes. Errors: they are damaged, of another version, or of another vehicle file.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), ModelError> {
        let refuse = |what: &str| ModelError::State(what.to_owned());
        let known = bytes.strip_prefix(MAGIC.as_bytes()).and_then(|rest| rest.split_at_checked(17));
        let (seal, body) = known.ok_or_else(|| refuse("is none of this version of itpms"))?;
        if seal != format!("{:016x}\n", crc64(&[body])).as_bytes() {
            return Err(refuse("is damaged: its checksum does not fit"));
        }
        type Saved = (String, Vec<f64>, Option<Box<Drive>>, Option<Struts>, Phase);
        let (file, values, drive, struts, phase) = thread::scope(|scope| {
            let reading = thread::Builder::new().stack_size(STACK_BYTES);
            let reading = reading.spawn_scoped(scope, || postcard::from_bytes::<Saved>(body));
            reading.ok().and_then(|reading| reading.join().ok()?.ok())
        })
        .ok_or_else(|| refuse("cannot be read"))?;
        if file != self.file.to_toml() || values.len() != self.variables.len() {
            return Err(refuse("is of another vehicle file"));
        }
        (self.values, self.drive, self.struts, self.phase) = (values, drive, struts, phase);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
