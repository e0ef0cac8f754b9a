//! A C program's configuration, checked: values of the core, or what is wrong.

use itpms_core::Real as _;
use itpms_core::car::EstimatorOptions;
use itpms_core::model::{
    CarConfig, Confidence, CornerConfig, Inflation, ParameterError, ParameterUncertainty, PressureMap,
    QuarterCar, standard_atmosphere_kpa,
};
use itpms_core::monitor::MonitorConfig;
use itpms_core::warning::{Limits, Regulation};
use itpms_core::wheel_speed::{DrivenAxle, WheelSpeedConfig};
use serde::{Deserialize, Serialize};

use crate::config::{
    itpms_confidence, itpms_config, itpms_corner_config, itpms_driven, itpms_regulation,
    itpms_wheel_speed_config,
};
use crate::itpms_real;
use crate::status::itpms_status;

/// What a car goes by.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Config {
    pub(crate) sample_rate_hz: f64,
    pub(crate) monitor: MonitorConfig<itpms_real>,
    /// Whether the roads under the wheels are estimated.
    pub(crate) wants_road: bool,
}

/// What is wrong with a configuration.
pub(crate) struct Refusal {
    pub(crate) status: itpms_status,
    pub(crate) error: Option<ParameterError>,
    /// The corner it is about; 4: none.
    pub(crate) corner: usize,
}

impl Refusal {
    pub(crate) fn choice(name: &'static str, value: u32, expected: &'static str) -> Self {
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
    pub(crate) fn read(stated: &itpms_config) -> Result<Self, Refusal> {
        let wheelbase_m = given(stated.wheelbase_m);
        let confidence = confidence(stated.confidence)?;
        let (mut corners, mut reference_kpa) = ([None; 4], [None; 4]);
        for (i, corner) in stated.corners.iter().enumerate() {
            if flag("is_measured", corner.is_measured).map_err(|refusal| refusal.at(i))? {
                corners[i] = Some(read_corner(corner, confidence).map_err(|refusal| refusal.at(i))?);
                reference_kpa[i] = given(corner.reference_kpa);
            }
        }
        let wants_road = flag("wants_road", stated.wants_road)?;
        let inflation =
            if flag("has_pumps", stated.has_pumps)? { Inflation::WhileRolling } else { Inflation::AtStops };
        let options = EstimatorOptions { inflation, ..EstimatorOptions::default() };
        let car = CarConfig { corners, wheelbase_m };
        let wheel_speeds = read_wheel_speeds(&stated.wheel_speeds, stated.wheelbase_m)?;
        let mut monitor = MonitorConfig {
            limits: limits(stated)?,
            wheel_speeds,
            reference_kpa,
            options,
            ..MonitorConfig::new(&car)
        };
        if let Some(home_m) = given(stated.home_altitude_m) {
            let holds = (-500.0..=6000.0).contains(&home_m);
            let home_m = expect("home_altitude_m", home_m, holds, "a height of -500 to 6000 m")?;
            monitor.home_kpa = standard_atmosphere_kpa(home_m);
        }
        if !car.has_corners() && wheel_speeds.is_none() {
            return Err(Refusal::choice("is_measured", 0, "1 at a corner, or wheel_speeds.is_used"));
        }
        Ok(Self { sample_rate_hz: stated.sample_rate_hz, monitor, wants_road })
    }
}

fn read_corner(
    stated: &itpms_corner_config,
    confidence: Confidence,
) -> Result<CornerConfig<itpms_real>, Refusal> {
    let car = QuarterCar::new(
        stated.sprung_mass_kg,
        stated.unsprung_mass_kg,
        stated.damping_n_s_per_m,
        stated.spring_n_per_m,
    )?;
    let or_zero = |value: itpms_real| given(value).unwrap_or(0.0);
    let tire = PressureMap::new(stated.stiffness_per_kpa, stated.stiffness_at_zero)?.with_uncertainty(
        or_zero(stated.stiffness_per_kpa_sd),
        or_zero(stated.stiffness_at_zero_sd),
        or_zero(stated.stiffness_correlation),
    )?;
    let mut corner = CornerConfig::new(car, tire, stated.placard_kpa)?;
    corner.uncertainty = uncertainty(stated, confidence)?;
    if let Some(noise_m_s2) = given(stated.accel_noise_m_s2) {
        corner = corner.with_accel_noise(noise_m_s2)?;
    }
    if let Some(initial_kpa) = given(stated.initial_kpa) {
        corner = corner.with_initial_pressure(initial_kpa)?;
    }
    Ok(corner)
}

/// What the parameters are known to, where something else is given than what is usual.
fn uncertainty(
    stated: &itpms_corner_config,
    confidence: Confidence,
) -> Result<ParameterUncertainty<itpms_real>, Refusal> {
    let usual = ParameterUncertainty::of(confidence);
    let or = |name, value: itpms_real, usual| match given(value) {
        None => Ok(usual),
        Some(value) => expect(name, value, value >= 0.0, "a finite number, zero or more"),
    };
    let over_mass = given(stated.stiffness_over_mass_relative_sd);
    Ok(ParameterUncertainty {
        sprung_mass_relative_sd: or(
            "sprung_mass_relative_sd",
            stated.sprung_mass_relative_sd,
            usual.sprung_mass_relative_sd,
        )?,
        unsprung_mass_relative_sd: or(
            "unsprung_mass_relative_sd",
            stated.unsprung_mass_relative_sd,
            usual.unsprung_mass_relative_sd,
        )?,
        spring_relative_sd: or("spring_relative_sd", stated.spring_relative_sd, usual.spring_relative_sd)?,
        damping_relative_sd: or(
            "damping_relative_sd",
            stated.damping_relative_sd,
            usual.damping_relative_sd,
        )?,
        stiffness_relative_sd: or(
            "stiffness_relative_sd",
            stated.stiffness_relative_sd,
            usual.stiffness_relative_sd,
        )?,
        stiffness_over_mass_relative_sd: match over_mass {
            None => None,
            Some(sd) => Some(or("stiffness_over_mass_relative_sd", sd, sd)?),
        },
        friction_n: or("friction_n", stated.friction_n, usual.friction_n)?,
        friction_sd_n: or("friction_sd_n", stated.friction_sd_n, usual.friction_sd_n)?,
        tire_damping_n_s_per_m: or(
            "tire_damping_n_s_per_m",
            stated.tire_damping_n_s_per_m,
            usual.tire_damping_n_s_per_m,
        )?,
        tire_damping_sd_n_s_per_m: or(
            "tire_damping_sd_n_s_per_m",
            stated.tire_damping_sd_n_s_per_m,
            usual.tire_damping_sd_n_s_per_m,
        )?,
    })
}

fn limits(stated: &itpms_config) -> Result<Limits<itpms_real>, Refusal> {
    let regulation = match stated.regulation {
        n if n == itpms_regulation::UnR141 as u32 => Regulation::UnR141,
        n if n == itpms_regulation::Fmvss138 as u32 => Regulation::Fmvss138,
        n => return Err(Refusal::choice("regulation", n, "an itpms_regulation, 0 or 1")),
    };
    match given(stated.loss_share) {
        None => Ok(regulation.into()),
        Some(loss_share) => Ok(Limits::for_loss(loss_share)?),
    }
}

fn confidence(stated: u32) -> Result<Confidence, Refusal> {
    match stated {
        n if n == itpms_confidence::Measured as u32 => Ok(Confidence::Measured),
        n if n == itpms_confidence::Typical as u32 => Ok(Confidence::Typical),
        n if n == itpms_confidence::Rough as u32 => Ok(Confidence::Rough),
        n => Err(Refusal::choice("confidence", n, "an itpms_confidence, 0 to 2")),
    }
}

pub(crate) fn read_wheel_speeds(
    stated: &itpms_wheel_speed_config,
    wheelbase_m: itpms_real,
) -> Result<Option<WheelSpeedConfig<itpms_real>>, Refusal> {
    if !flag("wheel_speeds.is_used", stated.is_used)? {
        return Ok(None);
    }
    let driven = match stated.driven {
        n if n == itpms_driven::Front as u32 => DrivenAxle::Front,
        n if n == itpms_driven::Rear as u32 => DrivenAxle::Rear,
        n if n == itpms_driven::All as u32 => DrivenAxle::Both,
        n => return Err(Refusal::choice("driven", n, "an itpms_driven, 0 to 2")),
    };
    let mut config = WheelSpeedConfig::new(wheelbase_m, stated.track_front_m, stated.track_rear_m, driven);
    config.limited_slip = flag("has_limited_slip", stated.has_limited_slip)?;
    let put = |place: &mut itpms_real, stated| *place = given(stated).unwrap_or(*place);
    put(&mut config.radius_per_ln_pressure, stated.radius_per_ln_pressure);
    put(&mut config.radius_per_ln_pressure_sd, stated.radius_per_ln_pressure_sd);
    put(&mut config.load.rear_axle, stated.load_rear_axle_sd);
    put(&mut config.load.rear_left_right, stated.load_rear_left_right_sd);
    put(&mut config.load.front_passengers, stated.load_front_passengers_sd);
    Ok(Some(config))
}

fn flag(name: &'static str, stated: u32) -> Result<bool, Refusal> {
    match stated {
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
