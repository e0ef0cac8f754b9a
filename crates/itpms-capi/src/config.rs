//! What a car is told, as a C program fills it in, and checked: values of the core, or what is wrong.

use itpms_core::Real as _;
use itpms_core::car::{EstimatorOptions, RoadHeights};
use itpms_core::model::{
    CarConfig, Confidence, CornerConfig, Inflation, ParameterError, ParameterUncertainty, PressureMap,
    QuarterCar,
};
use itpms_core::monitor::MonitorConfig;
use itpms_core::warning::{Limits, Regulation};
use itpms_core::wheel_speed::{DrivenAxle, WheelSpeedConfig};
use serde::{Deserialize, Serialize};

use crate::status::itpms_status;
use crate::{ITPMS_API_VERSION, itpms_real};

/// How far the parameters of a car are to be trusted: standard deviations of what has none of its own.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_confidence {
    /// Weighed and measured on this car.
    Measured = 0,
    /// A manufacturer's figures, or a car of the same model that was measured.
    Typical = 1,
    /// A guess.
    Rough = 2,
}

/// Which loss is warned of.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_regulation {
    /// UN R141 (5.3): 20 % below the warm reference.
    UnR141 = 0,
    /// FMVSS 138 (S4.2): 25 % below the placard.
    Fmvss138 = 1,
}

/// Which wheels the engine turns.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_driven {
    /// The front wheels.
    Front = 0,
    /// The rear wheels.
    Rear = 1,
    /// All four.
    All = 2,
}

/// One corner of the car: masses, spring, damper, tire. NaN where "NaN:" is said stands for what follows it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_corner_config {
    /// 1: this corner has both accelerometers; 0: it is left out, and nothing else here is read.
    pub is_measured: u32,
    /// Sprung mass in kg.
    pub sprung_mass_kg: itpms_real,
    /// Unsprung mass in kg.
    pub unsprung_mass_kg: itpms_real,
    /// Damping at the wheel in N s/m.
    pub damping_n_s_per_m: itpms_real,
    /// Spring rate at the wheel in N/m.
    pub spring_n_per_m: itpms_real,
    /// Tire stiffness over gauge pressure in N/m per kPa.
    pub stiffness_per_kpa: itpms_real,
    /// Tire stiffness at no gauge pressure in N/m.
    pub stiffness_at_zero: itpms_real,
    /// Standard deviation of `stiffness_per_kpa` in N/m per kPa; NaN: 0.
    pub stiffness_per_kpa_sd: itpms_real,
    /// Standard deviation of `stiffness_at_zero` in N/m; NaN: 0.
    pub stiffness_at_zero_sd: itpms_real,
    /// Correlation of the two, -1 to 1; NaN: 0.
    pub stiffness_correlation: itpms_real,
    /// Gauge pressure on the placard in kPa.
    pub placard_kpa: itpms_real,
    /// What the warm tire should have in kPa gauge; NaN: the placard's.
    pub reference_kpa: itpms_real,
    /// Gauge pressure to start from in kPa; NaN: the placard's.
    pub initial_kpa: itpms_real,
    /// Noise of both accelerometers in m/s^2, rms per sample; NaN: 0.05.
    pub accel_noise_m_s2: itpms_real,
    /// Relative standard deviation of the sprung mass (0.05 is 5 %); NaN: by `confidence`.
    pub sprung_mass_relative_sd: itpms_real,
    /// The same of the unsprung mass.
    pub unsprung_mass_relative_sd: itpms_real,
    /// The same of the spring.
    pub spring_relative_sd: itpms_real,
    /// The same of the damping.
    pub damping_relative_sd: itpms_real,
    /// The same of the tire's line of stiffness over pressure, as one scale.
    pub stiffness_relative_sd: itpms_real,
    /// The same of the tire's stiffness over the unsprung mass; NaN: from the two, each by itself.
    pub stiffness_over_mass_relative_sd: itpms_real,
    /// Coulomb friction of the strut in N; NaN: by `confidence`.
    pub friction_n: itpms_real,
    /// Its standard deviation in N; NaN: by `confidence`.
    pub friction_sd_n: itpms_real,
    /// Vertical damping of the tire in N s/m; NaN: by `confidence`.
    pub tire_damping_n_s_per_m: itpms_real,
    /// Its standard deviation in N s/m; NaN: by `confidence`.
    pub tire_damping_sd_n_s_per_m: itpms_real,
}

/// Radius analysis of four wheel speeds, beside the accelerations or alone.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_wheel_speed_config {
    /// 1: wheel speeds are used; 0: they are not, and nothing else here is read.
    pub is_used: u32,
    /// Which wheels the engine turns: an `itpms_driven`.
    pub driven: u32,
    /// 1: the wheels of a driven axle are coupled, so that they turn alike under torque.
    pub has_limited_slip: u32,
    /// Distance between the front wheels in m.
    pub track_front_m: itpms_real,
    /// Distance between the rear wheels in m.
    pub track_rear_m: itpms_real,
    /// `d ln R / d ln p` of the rolling radius R; NaN: 0.007.
    pub radius_per_ln_pressure: itpms_real,
    /// Its standard deviation as a share of it; NaN: 0.6.
    pub radius_per_ln_pressure_sd: itpms_real,
    /// Standard deviation of the rear axle's load from drive to drive, as a share of it; NaN: 0.2.
    pub load_rear_axle_sd: itpms_real,
    /// The same of one rear wheel's load against the other's; NaN: 0.03.
    pub load_rear_left_right_sd: itpms_real,
    /// Front passengers who get in or out, as a standard deviation; NaN: 1.
    pub load_front_passengers_sd: itpms_real,
}

/// All that a car is told. Filled with its defaults by `itpms_config_init`; four-element arrays are front left, front right,
/// rear left, rear right.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_config {
    /// `sizeof (itpms_config)`.
    pub struct_size: u32,
    /// `ITPMS_API_VERSION`.
    pub api_version: u32,
    /// Samples per second, about: 100 to 2000. The samples' own times count.
    pub sample_rate_hz: f64,
    /// Distance between the axles in m; NaN: the road that front and rear share is not used.
    pub wheelbase_m: itpms_real,
    /// How far the parameters are to be trusted: an `itpms_confidence`.
    pub confidence: u32,
    /// Which loss is warned of: an `itpms_regulation`.
    pub regulation: u32,
    /// Loss to be warned of as a share of the warm reference, up to 0.5; NaN: by `regulation`.
    pub loss_share: itpms_real,
    /// 1: the height of the road under each wheel is estimated with every sample, which costs time.
    pub wants_road: u32,
    /// 1: tires may gain air while they roll, as of a car with pumps.
    pub has_pumps: u32,
    /// The corners.
    pub corners: [itpms_corner_config; 4],
    /// Wheel speeds.
    pub wheel_speeds: itpms_wheel_speed_config,
}

const NAN: itpms_real = itpms_real::NAN;

impl itpms_config {
    /// The struct's size as it says it itself.
    pub(crate) const SIZE: usize = size_of::<Self>();

    /// What is not known: NaN. What is to be chosen: the default. No corner is measured, no wheel speed used.
    pub(crate) const fn unknown() -> Self {
        let corner = itpms_corner_config {
            is_measured: 0,
            sprung_mass_kg: NAN,
            unsprung_mass_kg: NAN,
            damping_n_s_per_m: NAN,
            spring_n_per_m: NAN,
            stiffness_per_kpa: NAN,
            stiffness_at_zero: NAN,
            stiffness_per_kpa_sd: NAN,
            stiffness_at_zero_sd: NAN,
            stiffness_correlation: NAN,
            placard_kpa: NAN,
            reference_kpa: NAN,
            initial_kpa: NAN,
            accel_noise_m_s2: NAN,
            sprung_mass_relative_sd: NAN,
            unsprung_mass_relative_sd: NAN,
            spring_relative_sd: NAN,
            damping_relative_sd: NAN,
            stiffness_relative_sd: NAN,
            stiffness_over_mass_relative_sd: NAN,
            friction_n: NAN,
            friction_sd_n: NAN,
            tire_damping_n_s_per_m: NAN,
            tire_damping_sd_n_s_per_m: NAN,
        };
        let wheel_speeds = itpms_wheel_speed_config {
            is_used: 0,
            driven: itpms_driven::Front as u32,
            has_limited_slip: 0,
            track_front_m: NAN,
            track_rear_m: NAN,
            radius_per_ln_pressure: NAN,
            radius_per_ln_pressure_sd: NAN,
            load_rear_axle_sd: NAN,
            load_rear_left_right_sd: NAN,
            load_front_passengers_sd: NAN,
        };
        Self {
            struct_size: Self::SIZE as u32,
            api_version: ITPMS_API_VERSION,
            sample_rate_hz: f64::NAN,
            wheelbase_m: NAN,
            confidence: itpms_confidence::Typical as u32,
            regulation: itpms_regulation::UnR141 as u32,
            loss_share: NAN,
            wants_road: 0,
            has_pumps: 0,
            corners: [corner; 4],
            wheel_speeds,
        }
    }
}

/// What a car goes by.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Config {
    pub(crate) sample_rate_hz: f64,
    pub(crate) monitor: MonitorConfig<itpms_real>,
    pub(crate) wheels: Option<WheelSpeedConfig<itpms_real>>,
}

/// What is wrong with a configuration.
pub(crate) struct Refusal {
    pub(crate) status: itpms_status,
    pub(crate) error: Option<ParameterError>,
    /// The corner it is about; 4: none.
    pub(crate) corner: usize,
}

impl Refusal {
    fn choice(name: &'static str, value: u32, expected: &'static str) -> Self {
        let error = Some(ParameterError { name, value: f64::from(value), expected });
        Self { status: itpms_status::BadChoice, error, corner: 4 }
    }

    fn at(self, corner: usize) -> Self {
        Self { corner, ..self }
    }
}

impl From<itpms_status> for Refusal {
    fn from(status: itpms_status) -> Self {
        Self { status, error: None, corner: 4 }
    }
}

impl From<ParameterError> for Refusal {
    fn from(error: ParameterError) -> Self {
        Self { status: itpms_status::BadParameter, error: Some(error), corner: 4 }
    }
}

impl Config {
    /// The configuration of a C program.
    pub(crate) fn read(told: &itpms_config) -> Result<Self, Refusal> {
        let wheelbase_m = given(told.wheelbase_m);
        if let Some(wheelbase_m) = wheelbase_m {
            expect("wheelbase_m", wheelbase_m, wheelbase_m > 0.0, "a positive, finite number")?;
        }
        let confidence = confidence(told.confidence)?;
        let (mut corners, mut reference_kpa) = ([None; 4], [None; 4]);
        for (i, corner) in told.corners.iter().enumerate() {
            if flag("is_measured", corner.is_measured).map_err(|refusal| refusal.at(i))? {
                corners[i] = Some(read_corner(corner, confidence).map_err(|refusal| refusal.at(i))?);
                reference_kpa[i] = given(corner.reference_kpa);
            }
        }
        let road_heights =
            if flag("wants_road", told.wants_road)? { RoadHeights::Estimated } else { RoadHeights::LeftOut };
        let inflation =
            if flag("has_pumps", told.has_pumps)? { Inflation::WhileRolling } else { Inflation::AtStops };
        let options = EstimatorOptions { road_heights, inflation, ..EstimatorOptions::default() };
        let monitor = MonitorConfig::new(&CarConfig { corners, wheelbase_m })
            .with_limits(limits(told)?)
            .with_options(options)
            .with_references(reference_kpa)?;
        let wheels = read_wheel_speeds(&told.wheel_speeds, told.wheelbase_m)?;
        if corners.iter().all(Option::is_none) && wheels.is_none() {
            return Err(Refusal::choice("is_measured", 0, "1 at a corner, or wheel_speeds.is_used"));
        }
        Ok(Self { sample_rate_hz: told.sample_rate_hz, monitor, wheels })
    }
}

fn read_corner(
    told: &itpms_corner_config,
    confidence: Confidence,
) -> Result<CornerConfig<itpms_real>, Refusal> {
    let car = QuarterCar::new(
        told.sprung_mass_kg,
        told.unsprung_mass_kg,
        told.damping_n_s_per_m,
        told.spring_n_per_m,
    )?;
    let or_zero = |value: itpms_real| given(value).unwrap_or(0.0);
    let tire = PressureMap::new(told.stiffness_per_kpa, told.stiffness_at_zero)?.with_uncertainty(
        or_zero(told.stiffness_per_kpa_sd),
        or_zero(told.stiffness_at_zero_sd),
        or_zero(told.stiffness_correlation),
    )?;
    let mut corner =
        CornerConfig::new(car, tire, told.placard_kpa)?.with_uncertainty(uncertainty(told, confidence)?);
    if let Some(noise_m_s2) = given(told.accel_noise_m_s2) {
        corner = corner.with_accel_noise(noise_m_s2)?;
    }
    if let Some(initial_kpa) = given(told.initial_kpa) {
        corner = corner.with_initial_pressure(initial_kpa)?;
    }
    Ok(corner)
}

/// What the parameters are known to, where something else is said than what is usual.
fn uncertainty(
    told: &itpms_corner_config,
    confidence: Confidence,
) -> Result<ParameterUncertainty<itpms_real>, Refusal> {
    let usual = ParameterUncertainty::of(confidence);
    let or = |name, value: itpms_real, usual| match given(value) {
        None => Ok(usual),
        Some(value) => expect(name, value, value >= 0.0, "a finite number, zero or more"),
    };
    let over_mass = given(told.stiffness_over_mass_relative_sd);
    Ok(ParameterUncertainty {
        sprung_mass_relative_sd: or(
            "sprung_mass_relative_sd",
            told.sprung_mass_relative_sd,
            usual.sprung_mass_relative_sd,
        )?,
        unsprung_mass_relative_sd: or(
            "unsprung_mass_relative_sd",
            told.unsprung_mass_relative_sd,
            usual.unsprung_mass_relative_sd,
        )?,
        spring_relative_sd: or("spring_relative_sd", told.spring_relative_sd, usual.spring_relative_sd)?,
        damping_relative_sd: or("damping_relative_sd", told.damping_relative_sd, usual.damping_relative_sd)?,
        stiffness_relative_sd: or(
            "stiffness_relative_sd",
            told.stiffness_relative_sd,
            usual.stiffness_relative_sd,
        )?,
        stiffness_over_mass_relative_sd: match over_mass {
            None => None,
            Some(sd) => Some(or("stiffness_over_mass_relative_sd", sd, sd)?),
        },
        friction_n: or("friction_n", told.friction_n, usual.friction_n)?,
        friction_sd_n: or("friction_sd_n", told.friction_sd_n, usual.friction_sd_n)?,
        tire_damping_n_s_per_m: or(
            "tire_damping_n_s_per_m",
            told.tire_damping_n_s_per_m,
            usual.tire_damping_n_s_per_m,
        )?,
        tire_damping_sd_n_s_per_m: or(
            "tire_damping_sd_n_s_per_m",
            told.tire_damping_sd_n_s_per_m,
            usual.tire_damping_sd_n_s_per_m,
        )?,
    })
}

fn limits(told: &itpms_config) -> Result<Limits<itpms_real>, Refusal> {
    let regulation = match told.regulation {
        n if n == itpms_regulation::UnR141 as u32 => Regulation::UnR141,
        n if n == itpms_regulation::Fmvss138 as u32 => Regulation::Fmvss138,
        n => return Err(Refusal::choice("regulation", n, "an itpms_regulation, 0 or 1")),
    };
    match given(told.loss_share) {
        None => Ok(regulation.into()),
        Some(loss_share) => Ok(Limits::for_loss(loss_share)?),
    }
}

fn confidence(told: u32) -> Result<Confidence, Refusal> {
    match told {
        n if n == itpms_confidence::Measured as u32 => Ok(Confidence::Measured),
        n if n == itpms_confidence::Typical as u32 => Ok(Confidence::Typical),
        n if n == itpms_confidence::Rough as u32 => Ok(Confidence::Rough),
        n => Err(Refusal::choice("confidence", n, "an itpms_confidence, 0 to 2")),
    }
}

fn read_wheel_speeds(
    told: &itpms_wheel_speed_config,
    wheelbase_m: itpms_real,
) -> Result<Option<WheelSpeedConfig<itpms_real>>, Refusal> {
    if !flag("wheel_speeds.is_used", told.is_used)? {
        return Ok(None);
    }
    let driven = match told.driven {
        n if n == itpms_driven::Front as u32 => DrivenAxle::Front,
        n if n == itpms_driven::Rear as u32 => DrivenAxle::Rear,
        n if n == itpms_driven::All as u32 => DrivenAxle::Both,
        n => return Err(Refusal::choice("driven", n, "an itpms_driven, 0 to 2")),
    };
    let mut config = WheelSpeedConfig::new(wheelbase_m, told.track_front_m, told.track_rear_m, driven);
    config.limited_slip = flag("has_limited_slip", told.has_limited_slip)?;
    let put = |place: &mut itpms_real, told| *place = given(told).unwrap_or(*place);
    put(&mut config.radius_per_ln_pressure, told.radius_per_ln_pressure);
    put(&mut config.radius_per_ln_pressure_sd, told.radius_per_ln_pressure_sd);
    put(&mut config.load.rear_axle, told.load_rear_axle_sd);
    put(&mut config.load.rear_left_right, told.load_rear_left_right_sd);
    put(&mut config.load.front_passengers, told.load_front_passengers_sd);
    Ok(Some(config))
}

fn flag(name: &'static str, told: u32) -> Result<bool, Refusal> {
    match told {
        0 => Ok(false),
        1 => Ok(true),
        n => Err(Refusal::choice(name, n, "0 or 1")),
    }
}

/// A value that was given: NaN is none.
fn given(value: itpms_real) -> Option<itpms_real> {
    (!value.is_nan()).then_some(value)
}

fn expect(
    name: &'static str,
    value: itpms_real,
    holds: bool,
    expected: &'static str,
) -> Result<itpms_real, ParameterError> {
    if holds && value.is_finite() {
        Ok(value)
    } else {
        Err(ParameterError { name, value: value.to_f64(), expected })
    }
}
