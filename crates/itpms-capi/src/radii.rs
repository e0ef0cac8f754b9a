//! What four wheel speeds alone say of the tires.

use itpms_core::model::Corner;
use itpms_core::monitor::MonitoredWheels;
use itpms_core::wheel_speed::WheelRadius;

use crate::alert::bits;
use crate::{estimate, itpms_real};

/// One wheel by its speed. NaN: not known.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_wheel_radius {
    /// An `itpms_state`: UNKNOWN, FINE (it does not differ from the others) or LOW.
    pub state: u32,
    /// An `itpms_doubt`.
    pub doubt: u32,
    /// 1 if a loss of 30 % of this tire alone would show.
    pub is_informed: u32,
    /// Probability that this tire is low.
    pub low_probability: itpms_real,
    /// Change of the rolling radius since the calibration, as a share of it.
    pub radius_change: itpms_real,
    /// Its standard deviation.
    pub radius_change_sd: itpms_real,
    /// Share of its pressure that the tire has lost since the calibration.
    pub lost_share: itpms_real,
    /// Its standard deviation.
    pub lost_share_sd: itpms_real,
    /// Smallest loss of this tire alone that would have shown since the calibration, as a share of its pressure.
    pub detectable_loss_share: itpms_real,
}

/// What four wheel speeds alone say: which tires differ from the others since the calibration. A loss of all four alike is not seen.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_radius_report {
    /// Time in s of the last sample; NaN before the first one.
    pub time_s: f64,
    /// Front left, front right, rear left, rear right.
    pub wheels: [itpms_wheel_radius; 4],
    /// Probability that any tire is low.
    pub any_low_probability: itpms_real,
    /// An `itpms_radius_state`.
    pub state: u32,
    /// Wheels of the states LOW and ONE_OF: bit 0 front left, 1 front right, 2 rear left, 3 rear right.
    pub low_wheels: u32,
    /// Wheels that turn like their neighbor under torque, low or not: the same bits.
    pub hidden_wheels: u32,
    /// 1 without a yaw rate that can be believed: of a front wheel and the rear wheel across only the pair may be known.
    pub is_diagonal_open: u32,
    /// 1 if the car stood since the calibration, so that loads may have changed: rear tires, and both of an axle, need a larger loss.
    pub loads_may_differ: u32,
}

pub(crate) fn report(wheels: &MonitoredWheels<itpms_real>) -> itpms_radius_report {
    let radii = wheels.radii();
    let (state, low_wheels) = estimate::radius_state(radii.state);
    let [fl, fr, rl, rr] = &radii.wheels;
    let wheel = |corner, radius: &WheelRadius<itpms_real>| {
        let (state, doubt) = estimate::state(Some(wheels.state_of(corner)));
        itpms_wheel_radius {
            state: state as u32,
            doubt: doubt as u32,
            is_informed: u32::from(radius.informed()),
            low_probability: radius.low_probability,
            radius_change: radius.change,
            radius_change_sd: radius.change_sd,
            lost_share: radius.lost_share,
            lost_share_sd: radius.lost_share_sd,
            detectable_loss_share: radius.detectable_loss_share,
        }
    };
    itpms_radius_report {
        time_s: radii.time_s,
        wheels: [
            wheel(Corner::FrontLeft, fl),
            wheel(Corner::FrontRight, fr),
            wheel(Corner::RearLeft, rl),
            wheel(Corner::RearRight, rr),
        ],
        any_low_probability: radii.any_low_probability,
        state,
        low_wheels,
        hidden_wheels: bits(radii.unseen.hidden_by_torque),
        is_diagonal_open: u32::from(radii.unseen.which_of_a_diagonal),
        loads_may_differ: u32::from(radii.unseen.loads),
    }
}
