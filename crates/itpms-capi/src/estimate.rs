//! What is known of the car after a sample.

use itpms_core::model::{CarEstimate, CornerEstimate, Level, Validity, Warning, Wheels};
use itpms_core::warning::{Doubt, MonitorReport, WheelReport, WheelState};
use itpms_core::wheel_speed::{RadiusReport, RadiusState};

use crate::itpms_real;

/// Whether, and if not why not, a pressure may be believed.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_validity {
    /// Not enough has been seen since the start.
    Starting = 0,
    /// The data says this.
    Valid = 1,
    /// Nothing to learn from for a while: standing still, too smooth, hidden in noise.
    NoInformation = 2,
    /// Samples are missing, stuck or absurd.
    BadSignal = 3,
    /// The computation left its range.
    Diverged = 4,
    /// Body and wheel do not move as the configuration says.
    Misfit = 5,
}

/// What is known of a wheel in one word. Unknown is never to be shown as "all good".
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_state {
    /// Unknown; `itpms_doubt` says why.
    Unknown = 0,
    /// Known to be neither low nor overfull.
    Fine = 1,
    /// Under-inflated, leaking fast, falling with all the others, or flat on its rim.
    Low = 2,
    /// Over-inflated.
    Over = 3,
    /// A sensor of this corner is not to be trusted.
    Malfunction = 4,
    /// There is a pressure, but it could be low as well as not.
    Uncertain = 5,
}

/// Why a wheel's state is unknown.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_doubt {
    /// It is known.
    None = 0,
    /// Not enough has been seen since the start, or since a malfunction ended.
    Starting = 1,
    /// Nothing to learn from, or learned too long ago.
    NoInformation = 2,
    /// There is a pressure, but it could be low as well as not.
    Uncertain = 3,
    /// A sensor looks wrong; not for long enough to say so.
    Suspicion = 4,
    /// The car does not move as its configuration says.
    Misfit = 5,
    /// The car stands.
    Standing = 6,
}

/// What the driver should know about one tire.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_warning {
    /// Nothing to say. No promise that all is well: see `itpms_state`.
    None = 0,
    /// Under-inflated.
    Low = 1,
    /// The sensors do not allow a statement.
    Malfunction = 2,
}

/// What the level of a pressure rests on; changes show by themselves.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_level {
    /// On masses and the tire's stiffness in the configuration.
    Config = 0,
    /// On a calibration of this drive.
    Calibration = 1,
    /// On a calibration that was loaded.
    StoredCalibration = 2,
    /// On nothing: what is known is how the tire differs from the others since a calibration.
    OtherTires = 3,
}

/// What wheel speeds say of the car.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_radius_state {
    /// No wheel speeds are used, or no calibration has taught how the tires differ.
    Uncalibrated = 0,
    /// A calibration goes on.
    Calibrating = 1,
    /// A loss of 30 % of any single tire would not show.
    Uninformed = 2,
    /// No tire differs from the others.
    NoneDiffers = 3,
    /// The tires of `low_wheels` are low.
    Low = 4,
    /// One of them is, or all of them; which, is not known.
    OneOf = 5,
}

/// One wheel. NaN: not known.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_wheel {
    /// 1 if the car was configured with this corner, or with wheel speeds alone; else the rest says nothing.
    pub is_monitored: u32,
    /// An `itpms_validity`: whether the pressure may be shown.
    pub validity: u32,
    /// An `itpms_state`.
    pub state: u32,
    /// An `itpms_doubt`.
    pub doubt: u32,
    /// An `itpms_warning`.
    pub warning: u32,
    /// An `itpms_level`.
    pub level: u32,
    /// Gauge pressure in kPa.
    pub pressure_kpa: itpms_real,
    /// Its standard deviation in kPa, with what the configuration leaves open.
    pub pressure_sd_kpa: itpms_real,
    /// Standard deviation in kPa of a change within minutes.
    pub change_sd_kpa: itpms_real,
    /// Standard deviation in kPa of its difference from the axle's other tire.
    pub axle_difference_sd_kpa: itpms_real,
    /// What the tire has lost in this drive in kPa; NaN as long as that is not counted, and where it was low before that.
    pub lost_kpa: itpms_real,
    /// Its standard deviation in kPa.
    pub lost_sd_kpa: itpms_real,
    /// Tire stiffness in N/m.
    pub stiffness_n_per_m: itpms_real,
    /// Its standard deviation in N/m.
    pub stiffness_sd_n_per_m: itpms_real,
    /// What the pressure is held against, in kPa.
    pub reference_kpa: itpms_real,
    /// Height of the road under the wheel in m, causal and without drift; only with `wants_road`.
    pub road_m: itpms_real,
    /// Its standard deviation in m.
    pub road_sd_m: itpms_real,
    /// By wheel speeds: share of its pressure that the tire has lost since the calibration.
    pub radius_lost_share: itpms_real,
    /// Its standard deviation.
    pub radius_lost_share_sd: itpms_real,
}

/// What is known of the car after a sample.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_estimate {
    /// Time in s of the last sample; NaN before the first one.
    pub time_s: f64,
    /// Front left, front right, rear left, rear right.
    pub wheels: [itpms_wheel; 4],
    /// Correlation coefficients of the pressures' errors.
    pub correlation: [[itpms_real; 4]; 4],
    /// 1 where front and rear of the left and of the right side are found to meet the same road.
    pub shares_road: [u32; 2],
    /// An `itpms_radius_state`: what wheel speeds say.
    pub radius_state: u32,
    /// Wheels that differ from the others by the wheel speeds: bit 0 front left, 1 front right, 2 rear left, 3 rear right.
    pub low_wheels: u32,
}

const NAN: itpms_real = itpms_real::NAN;

/// Writes what is known: of the accelerations where there are any, of the wheel speeds where there are any.
pub(crate) fn estimate(
    car: Option<&CarEstimate<itpms_real>>,
    report: &MonitorReport<itpms_real>,
    radii: Option<&RadiusReport<itpms_real>>,
) -> itpms_estimate {
    let mut estimate_out = itpms_estimate {
        time_s: car.map_or(radii.map_or(f64::NAN, |radii| radii.time_s), |car| car.time_s),
        wheels: [wheel(None, None); 4],
        correlation: car.map_or([[NAN; 4]; 4], |car| car.correlation),
        shares_road: car.map_or([0; 2], |car| car.tracks.map(|track| u32::from(track.shared))),
        radius_state: itpms_radius_state::Uncalibrated as u32,
        low_wheels: 0,
    };
    let corners = car.map_or([None; 4], |car| car.corners);
    for ((place, corner), report) in estimate_out.wheels.iter_mut().zip(&corners).zip(&report.wheels) {
        *place = wheel(corner.as_ref(), report.as_ref());
    }
    if let Some(radii) = radii {
        (estimate_out.radius_state, estimate_out.low_wheels) = radius_state(radii.state);
        for (place, radius) in estimate_out.wheels.iter_mut().zip(&radii.wheels) {
            place.radius_lost_share = radius.lost_share;
            place.radius_lost_share_sd = radius.lost_share_sd;
        }
    }
    estimate_out
}

/// An `itpms_radius_state`, and the wheels it is about as bits.
pub(crate) fn radius_state(state: RadiusState) -> (u32, u32) {
    let (state, wheels) = match state {
        RadiusState::Uncalibrated => (itpms_radius_state::Uncalibrated, Wheels::NONE),
        RadiusState::Calibrating => (itpms_radius_state::Calibrating, Wheels::NONE),
        RadiusState::Uninformed => (itpms_radius_state::Uninformed, Wheels::NONE),
        RadiusState::NoneDiffers => (itpms_radius_state::NoneDiffers, Wheels::NONE),
        RadiusState::Low(wheels) => (itpms_radius_state::Low, wheels),
        RadiusState::OneOf(wheels) => (itpms_radius_state::OneOf, wheels),
    };
    (state as u32, crate::alert::bits(wheels))
}

fn wheel(
    corner: Option<&CornerEstimate<itpms_real>>,
    report: Option<&WheelReport<itpms_real>>,
) -> itpms_wheel {
    let of = |value: fn(&CornerEstimate<itpms_real>) -> itpms_real| corner.map_or(NAN, value);
    let validity = corner.map(|corner| corner.validity).or(report.map(|report| report.validity));
    let warning = corner.map(|corner| corner.warning).or(report.map(|report| report.warning));
    let (state, doubt) = state(report.map(|report| report.state));
    itpms_wheel {
        is_monitored: u32::from(corner.is_some() || report.is_some()),
        validity: validity.map_or(itpms_validity::Starting, validity_of) as u32,
        state: state as u32,
        doubt: doubt as u32,
        warning: warning.map_or(itpms_warning::None, warning_of) as u32,
        level: corner.map_or(itpms_level::Config, |corner| level_of(corner.level)) as u32,
        pressure_kpa: of(|c| c.pressure_kpa),
        pressure_sd_kpa: of(|c| c.pressure_sd_kpa),
        change_sd_kpa: of(|c| c.change_sd_kpa),
        axle_difference_sd_kpa: of(|c| c.axle_difference_sd_kpa.unwrap_or(NAN)),
        lost_kpa: of(|c| c.lost_kpa()[0]),
        lost_sd_kpa: of(|c| c.lost_kpa()[1]),
        stiffness_n_per_m: of(|c| c.stiffness_n_per_m),
        stiffness_sd_n_per_m: of(|c| c.stiffness_sd_n_per_m),
        reference_kpa: report.map_or(NAN, |report| report.reference_kpa),
        road_m: of(|c| c.road_m),
        road_sd_m: of(|c| c.road_sd_m),
        radius_lost_share: NAN,
        radius_lost_share_sd: NAN,
    }
}

fn validity_of(validity: Validity) -> itpms_validity {
    match validity {
        Validity::Starting => itpms_validity::Starting,
        Validity::Valid => itpms_validity::Valid,
        Validity::NoInformation => itpms_validity::NoInformation,
        Validity::BadSignal => itpms_validity::BadSignal,
        Validity::Diverged => itpms_validity::Diverged,
        Validity::Misfit => itpms_validity::Misfit,
    }
}

fn warning_of(warning: Warning) -> itpms_warning {
    match warning {
        Warning::None => itpms_warning::None,
        Warning::Low => itpms_warning::Low,
        Warning::Malfunction => itpms_warning::Malfunction,
    }
}

fn level_of(level: Level) -> itpms_level {
    match level {
        Level::VehicleFile => itpms_level::Config,
        Level::Calibration => itpms_level::Calibration,
        Level::StoredCalibration => itpms_level::StoredCalibration,
        Level::OtherTires => itpms_level::OtherTires,
    }
}

pub(crate) fn state(state: Option<WheelState>) -> (itpms_state, itpms_doubt) {
    let doubt = match state {
        None => return (itpms_state::Unknown, itpms_doubt::Starting),
        Some(WheelState::Fine) => return (itpms_state::Fine, itpms_doubt::None),
        Some(WheelState::Low) => return (itpms_state::Low, itpms_doubt::None),
        Some(WheelState::Over) => return (itpms_state::Over, itpms_doubt::None),
        Some(WheelState::Malfunction) => return (itpms_state::Malfunction, itpms_doubt::None),
        Some(WheelState::Unknown(doubt)) => doubt,
    };
    let doubt = match doubt {
        Doubt::Starting => itpms_doubt::Starting,
        Doubt::NoInformation => itpms_doubt::NoInformation,
        Doubt::Uncertain => itpms_doubt::Uncertain,
        Doubt::Suspicion => itpms_doubt::Suspicion,
        Doubt::Misfit => itpms_doubt::Misfit,
        Doubt::Standing => itpms_doubt::Standing,
    };
    let state =
        if matches!(doubt, itpms_doubt::Uncertain) { itpms_state::Uncertain } else { itpms_state::Unknown };
    (state, doubt)
}
