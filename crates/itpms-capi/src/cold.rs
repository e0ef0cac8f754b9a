//! What tires would have cold (docs/cold-pressure.md).

use itpms_core::model::{Air, CarConfig, CarEstimate, CornerEstimate};

use crate::itpms_real;

/// The air around the car. NaN: not sent.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_air {
    /// Temperature in degrees Celsius.
    pub ambient_temperature_c: itpms_real,
    /// Absolute pressure in kPa.
    pub barometric_kpa: itpms_real,
    /// Height above the sea in m, used where there is no barometer.
    pub altitude_m: itpms_real,
}

impl itpms_air {
    pub(crate) fn read(&self) -> Air<itpms_real> {
        let Self { ambient_temperature_c, barometric_kpa, altitude_m } = *self;
        Air { ambient_temperature_c, barometric_kpa, altitude_m }
    }
}

/// Whether a cold tire would have the air that it should have.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_cold_state {
    /// Its pressure is not valid, or the temperature of the air is not known.
    Unknown = 0,
    /// It lacks no more than its standard deviation, or less than 5 kPa.
    Fine = 1,
    /// It lacks `add_kpa`.
    Add = 2,
}

/// What a tire would have cold. NaN: not known.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_cold_wheel {
    /// An `itpms_cold_state`.
    pub state: u32,
    /// Gauge pressure in kPa at the temperature of the air, where tires are filled.
    pub pressure_kpa: itpms_real,
    /// Its standard deviation in kPa.
    pub pressure_sd_kpa: itpms_real,
    /// What is to be added in kPa, cold, up to the placard's pressure; NaN: nothing.
    pub add_kpa: itpms_real,
}

/// What the tires would have cold.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_cold_report {
    /// Temperature of the air in degrees Celsius that it was computed with; NaN: not known.
    pub ambient_temperature_c: itpms_real,
    /// Front left, front right, rear left, rear right.
    pub wheels: [itpms_cold_wheel; 4],
}

const NAN: itpms_real = itpms_real::NAN;
const UNKNOWN: itpms_cold_wheel = itpms_cold_wheel {
    state: itpms_cold_state::Unknown as u32,
    pressure_kpa: NAN,
    pressure_sd_kpa: NAN,
    add_kpa: NAN,
};

/// After a sample of a car of this configuration.
pub(crate) fn report(
    config: Option<&CarConfig<itpms_real>>,
    car: Option<&CarEstimate<itpms_real>>,
) -> itpms_cold_report {
    let mut out = itpms_cold_report { ambient_temperature_c: NAN, wheels: [UNKNOWN; 4] };
    let (Some(config), Some(car)) = (config, car) else { return out };
    for ((place, config), corner) in out.wheels.iter_mut().zip(&config.corners).zip(&car.corners) {
        if let (Some(config), Some(corner)) = (config, corner) {
            *place = wheel(corner, config.placard_kpa);
            out.ambient_temperature_c =
                corner.cold.map_or(out.ambient_temperature_c, |cold| cold.ambient_temperature_c);
        }
    }
    out
}

fn wheel(corner: &CornerEstimate<itpms_real>, placard_kpa: itpms_real) -> itpms_cold_wheel {
    let Some(cold) = corner.cold.filter(|_| corner.validity.is_valid()) else { return UNKNOWN };
    let lacks = cold.air_to_add_kpa(placard_kpa);
    let (state, add_kpa) = lacks.map_or((itpms_cold_state::Fine, NAN), |kpa| (itpms_cold_state::Add, kpa));
    itpms_cold_wheel {
        state: state as u32,
        pressure_kpa: cold.pressure_kpa,
        pressure_sd_kpa: cold.sd_kpa,
        add_kpa,
    }
}
