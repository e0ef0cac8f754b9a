//! What a car says of its surroundings: the air around it, and where it is.

/// What a car says of the air around it; for cold pressures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AirField {
    Temperature,
    /// Absolute pressure in kPa.
    Pressure,
    /// Height above the sea in m, in the place of the pressure.
    Altitude,
}

impl AirField {
    pub(super) const ALL: [AirField; 3] = [AirField::Temperature, AirField::Pressure, AirField::Altitude];

    pub(super) fn name(self) -> &'static str {
        match self {
            AirField::Temperature => "ambient_temperature_c",
            AirField::Pressure => "barometric_kpa",
            AirField::Altitude => "altitude_m",
        }
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

/// Where the car is, in degrees; for the road's place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PositionField {
    /// North positive.
    Latitude,
    /// East positive.
    Longitude,
}

impl PositionField {
    pub(super) const ALL: [PositionField; 2] = [PositionField::Latitude, PositionField::Longitude];

    pub(super) fn name(self) -> &'static str {
        match self {
            PositionField::Latitude => "latitude_deg",
            PositionField::Longitude => "longitude_deg",
        }
    }
}

/// What the car's own axle load sensors say, with the unsprung masses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AxleField {
    Front,
    Rear,
}

impl AxleField {
    pub(crate) const ALL: [AxleField; 2] = [AxleField::Front, AxleField::Rear];

    pub(super) fn name(self) -> &'static str {
        match self {
            AxleField::Front => "front_axle_kg",
            AxleField::Rear => "rear_axle_kg",
        }
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
