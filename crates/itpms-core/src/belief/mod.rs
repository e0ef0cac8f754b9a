//! The belief about the car.

pub(crate) mod calibration;
pub(crate) mod checkpoint;
pub(crate) mod gaussian;
pub(crate) mod hypothesis_bank;
pub(crate) mod mixture;
pub(crate) mod output;
pub(crate) mod pseudo_measurement;
pub(crate) mod single_wheel_estimate;
pub(crate) mod state;
pub(crate) mod stored_calibration;
pub(crate) mod tire_scale;
pub(crate) mod update;
