//! The wheel speeds of a drive, beside accelerations or alone: what earlier drives taught of them, samples made of rows, and whether the
//! yaw rate goes with them.

use itpms_core::model::Corner;
use itpms_core::monitor::MonitoredWheels;
use itpms_core::torsion::CarTorsion;
use itpms_core::wheel_speed::{RadiusDays, WheelSpeedSample};
use itpms_data::log::LogColumns;
use itpms_data::out::WheelSpeedUse;
use itpms_data::reference::StoredReference;
use itpms_data::{LogRow, Vehicle};

use crate::car::AnyCar;
use crate::error::DriveError;
use crate::settings::Settings;

/// Whether the wheel speeds of a log are used with this vehicle and these corners, or the key that its file lacks for that.
/// Errors: the key, where the log has wheel speeds.
pub fn wheel_speed_use(
    columns: &LogColumns,
    vehicle: &Vehicle,
    corners: &[Corner],
) -> Result<WheelSpeedUse, &'static str> {
    if !columns.motion.wheel_speeds() {
        return Ok(WheelSpeedUse::None);
    }
    vehicle.wheel_speed_config()?;
    if !columns.motion.wheel_speed {
        vehicle.rolling_radius_m().ok_or("[tire] rolling_radius_m")?;
    }
    Ok(if corners.is_empty() { WheelSpeedUse::Alone } else { WheelSpeedUse::Beside })
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WheelSpeeds {
    rolling_radius_m: f64,
    alone: bool,
    track_rear_m: f64,
    turns: Turns,
    /// When the stored calibration was learned, in s since 1970, before the first row gives its age.
    learned_unix_s: Option<f64>,
    /// From where the rows' times count, in s since 1970, and the last one's.
    began_unix_s: f64,
    unix_s: f64,
}

impl WheelSpeeds {
    /// This vehicle's, whose monitor and analysis of tooth pulses begin with what was stored.
    /// Errors: a stored reference with wheel speeds that no car has, or without any where there is nothing else.
    pub(crate) fn new(
        settings: &Settings,
        vehicle: &Vehicle,
        alone: bool,
        stored: Option<&StoredReference>,
        car: &mut AnyCar,
    ) -> Result<Self, DriveError> {
        let radii = stored.and_then(|stored| stored.wheel_speeds.as_ref());
        let monitor = car.wheels_mut();
        let loaded = monitor.zip(radii).map(|(monitor, radii)| monitor.load_calibration(radii));
        let problem = match loaded {
            Some(false) => Some("wheel speeds that no car has"),
            None if alone => Some("nothing of wheel speeds, and the log nothing else"),
            _ => None,
        };
        if let (Some(path), Some(problem)) = (&settings.reference, problem) {
            let path = path.display();
            return Err(DriveError::Mismatch(format!("{path}: the learned reference has {problem}")));
        }
        let loaded = loaded.is_some();
        let learned_unix_s = stored.filter(|_| loaded).map(|stored| stored.learned_unix_s as f64);
        if let (Some(monitor), Some(stored)) = (car.wheels_mut(), stored.filter(|_| loaded)) {
            let _ = monitor.load_days(&stored.days);
        }
        if let (Some(torsion), Some(stored)) = (car.torsion_mut(), stored) {
            let _ = torsion.load_calibration(&stored.torsion);
        }
        let rolling_radius_m = vehicle.rolling_radius_m().unwrap_or(f64::NAN);
        let track_rear_m = vehicle.wheel_speed_config().map_err(|key| lacks(vehicle, key))?.track_rear_m;
        let (began_unix_s, unix_s) = (0.0, 0.0);
        Ok(Self {
            rolling_radius_m,
            alone,
            track_rear_m,
            turns: Turns::default(),
            learned_unix_s,
            began_unix_s,
            unix_s,
        })
    }

    pub(crate) fn clock_began(&mut self, unix_s: f64) {
        self.began_unix_s = unix_s;
    }

    /// The radii of the days since the calibration, with this one, or why it does not count; `None` without a calibration.
    pub(crate) fn days(
        &self,
        wheels: &MonitoredWheels<f64>,
    ) -> Option<Result<RadiusDays<f64>, &'static str>> {
        let (days, calibrated) = (wheels.days(), wheels.calibration().is_some());
        let problem = if !(self.unix_s > DATES_S) {
            Some("the drive has no date, expected times in s since 1970 or a log with its start")
        } else if !(self.unix_s >= days.calibrated_unix_s && days.calibrated_unix_s > DATES_S) {
            Some(
                "the drive is of before the calibration, or that has no date, expected a calibration drive with dates",
            )
        } else {
            None
        };
        calibrated.then(|| problem.map_or(Ok(*days), Err))
    }

    /// A row's wheel speeds, for the car that is about to take them.
    pub(crate) fn sample(&mut self, row: &LogRow, car: &mut AnyCar) -> WheelSpeedSample<f64> {
        self.unix_s = self.began_unix_s + row.time_s;
        if let (Some(learned_s), Some(wheels)) = (self.learned_unix_s.take(), car.wheels_mut()) {
            wheels.age_calibration(KM_PER_S * age_s(learned_s, self.unix_s));
        }
        row.motion.sample(row.time_s, self.rolling_radius_m)
    }

    /// Looks at the yaw rate of a row that the car has taken. The speed of a car of which nothing else is known is that of its wheels.
    pub(crate) fn look(&mut self, row: &mut LogRow, sample: &WheelSpeedSample<f64>) {
        if self.alone && row.speed_m_s.is_nan() {
            row.speed_m_s = 0.25 * sample.wheel_speed_m_s.iter().sum::<f64>();
        }
        let [_, _, left, right] = sample.wheel_speed_m_s;
        self.turns.push(sample.yaw_rate_rad_s, left, (right - left) / self.track_rear_m);
    }

    /// The yaw rate's fault, by the wheels' speeds in bends.
    pub(crate) fn yaw_fault(&self, wheels: &MonitoredWheels<f64>) -> Option<YawFault> {
        self.turns.fault().or_else(|| wheels.doubts_yaw_rate().then_some(YawFault::LeftOut))
    }
}

/// The analysis of a vehicle's tooth pulses.
/// Errors: a key that its file lacks, or one that no wheel has.
pub(crate) fn torsion(vehicle: &Vehicle) -> Result<Box<CarTorsion<f64>>, DriveError> {
    let (of_wheels, placard_kpa) = vehicle.torsion_config().map_err(|key| lacks(vehicle, key))?;
    let mut torsion = Box::new(CarTorsion::unconfigured());
    torsion.configure(&of_wheels, &placard_kpa)?;
    Ok(torsion)
}

/// Mean of a car's driving, 13 000 km a year, in km/s.
const KM_PER_S: f64 = 13_000.0 / (365.25 * 86_400.0);
/// Stamps from here on are dates, in s since 1970.
const DATES_S: f64 = 1e8;

/// For how long a calibration has been stored, in s; of a log whose clock tells no date, zero.
fn age_s(learned_unix_s: f64, unix_s: f64) -> f64 {
    let dated = unix_s > DATES_S && learned_unix_s > DATES_S;
    if dated { (unix_s - learned_unix_s).max(0.0) } else { 0.0 }
}

/// Speed in m/s above which rear wheels show how a car turns.
const TURNING_M_S: f64 = 5.0;
/// The yaw rate of the rear wheels over the sensor's is 1, or -1 where its sign is the other one: surely below this it is. Of a sensor in
/// degrees per second it is a 57th.
const REVERSED: f64 = -0.3;
const IN_DEGREES: std::ops::Range<f64> = 0.005..0.05;
/// Of one that goes with the wheels; the load that a bend moves to its outer wheels makes it 1.5 at 30 m/s.
const IN_ORDER: std::ops::Range<f64> = 0.6..1.8;
/// The fastest turn that counts, in rad/s and in deg/s.
const FASTEST_RAD_S: f64 = 2.0;
const FASTEST_DEG_S: f64 = 115.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum YawFault {
    Reversed,
    InDegrees,
    /// It is so many times what the wheels show.
    Scaled(f64),
    /// It does not go with the wheels at all, and was left out.
    LeftOut,
}

impl std::fmt::Display for YawFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Reversed => f.write_str("turns against the wheels, expected positive to the left: turn it round in a map (factor = -1.0)"),
            Self::InDegrees => f.write_str("is some 57 times what the wheels show, expected rad/s: convert it in a map (factor = 0.01745)"),
            Self::Scaled(share) => write!(f, "is {share:.2} times what the wheels show, expected 1: it has another unit or factor"),
            Self::LeftOut => f.write_str("does not go with the wheels in bends (a sensor that is dead, or another signal?) and was left out"),
        }
    }
}

/// Sums of the sensor's yaw rate and the rear wheels', whose slope is to be one.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Turns {
    count: f64,
    sensor: f64,
    wheels: f64,
    sensor_square: f64,
    wheels_square: f64,
    product: f64,
}

impl Turns {
    fn push(&mut self, sensor_rad_s: f64, speed_m_s: f64, wheels_rad_s: f64) {
        let turns = sensor_rad_s.abs() < FASTEST_DEG_S && wheels_rad_s.abs() < FASTEST_RAD_S;
        if !(speed_m_s > TURNING_M_S && turns) {
            return;
        }
        self.count += 1.0;
        self.sensor += sensor_rad_s;
        self.wheels += wheels_rad_s;
        self.sensor_square += sensor_rad_s * sensor_rad_s;
        self.wheels_square += wheels_rad_s * wheels_rad_s;
        self.product += sensor_rad_s * wheels_rad_s;
    }

    /// By the regression's slope and four of its standard deviations.
    fn fault(&self) -> Option<YawFault> {
        let of = |square: f64, a: f64, b: f64| square - a * b / self.count;
        let sensor = of(self.sensor_square, self.sensor, self.sensor);
        let wheels = of(self.wheels_square, self.wheels, self.wheels);
        let slope = of(self.product, self.sensor, self.wheels) / sensor;
        let rest = (wheels - slope * slope * sensor).max(0.0) / self.count;
        let (least, most) = (slope - 4.0 * (rest / sensor).sqrt(), slope + 4.0 * (rest / sensor).sqrt());
        match () {
            () if most < REVERSED => Some(YawFault::Reversed),
            () if IN_DEGREES.contains(&least) && IN_DEGREES.contains(&most) => Some(YawFault::InDegrees),
            // Nothing goes with a sensor that is dead or another one.
            () if least > 0.1 && (most < IN_ORDER.start || least > IN_ORDER.end) => {
                Some(YawFault::Scaled(slope.recip()))
            }
            () => None,
        }
    }
}

/// Why wheel speeds are of no use with this file.
pub(crate) fn lacking(vehicle: &Vehicle, key: &str) -> String {
    format!(
        "the vehicle {:?} has no {key}; wheel speeds need wheelbase_m, track_front_m, track_rear_m and driven (itpms vehicle init --wheelbase-m and --driven write them), and speeds of rotation and tooth pulses [tire] rolling_radius_m",
        vehicle.name
    )
}

/// The same, where they are needed.
pub(crate) fn lacks(vehicle: &Vehicle, key: &str) -> DriveError {
    DriveError::Mismatch(lacking(vehicle, key))
}
