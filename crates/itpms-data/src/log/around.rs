//! Measurements of the car's surroundings: the air around it, and its position.

itpms_core::labelled! {
    /// Measurements of the air around the car; for cold pressures.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum AirField {
        Temperature = "ambient_temperature_c",
        /// Absolute pressure in kPa.
        Pressure = "barometric_kpa",
        /// Height above the sea in m, in the place of the pressure.
        Altitude = "altitude_m",
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AirColumns {
    pub temperature: bool,
    pub pressure: bool,
    pub altitude: bool,
}

impl AirColumns {
    pub(super) fn has(self, field: AirField) -> bool {
        match field {
            AirField::Temperature => self.temperature,
            AirField::Pressure => self.pressure,
            AirField::Altitude => self.altitude,
        }
    }

    pub(super) fn of(has: impl Fn(AirField) -> bool) -> Self {
        Self {
            temperature: has(AirField::Temperature),
            pressure: has(AirField::Pressure),
            altitude: has(AirField::Altitude),
        }
    }
}

itpms_core::labelled! {
    /// Where the car is, in degrees; for the road's place.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum PositionField {
        /// North positive.
        Latitude = "latitude_deg",
        /// East positive.
        Longitude = "longitude_deg",
    }
}

itpms_core::labelled! {
    /// Loads of the car's own axle sensors, unsprung masses included.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum AxleField {
        Front = "front_axle_kg",
        Rear = "rear_axle_kg",
    }
}

/// Whether a log says where the car was, and whether what is written of the log may say it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PositionColumns {
    #[default]
    Absent,
    Private,
    Written,
}
