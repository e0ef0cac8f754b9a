//! Physical quantity and unit of a drive log's column.

use super::around::AirField;
use super::slot::{Field, Motion, Slot};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Acceleration,
    Speed,
    Pressure,
    Length,
    Time,
    Rotation,
    Temperature,
    Angle,
    /// In kg.
    Mass,
    /// 0 or 1.
    Switch,
}

impl Quantity {
    pub(crate) fn of(slot: Slot) -> Self {
        match slot {
            Slot::Time => Quantity::Time,
            Slot::Speed => Quantity::Speed,
            Slot::Corner(_, Field::BodyAccel | Field::WheelAccel) => Quantity::Acceleration,
            Slot::Corner(_, Field::Pressure | Field::TireSensor) => Quantity::Pressure,
            Slot::Corner(_, Field::TireTemperature) => Quantity::Temperature,
            Slot::Corner(_, Field::Road) => Quantity::Length,
            Slot::Corner(_, Field::WheelSpeed) => Quantity::Speed,
            Slot::Corner(_, Field::WheelRotation) | Slot::Motion(Motion::YawRate) => Quantity::Rotation,
            Slot::Motion(Motion::AccelX | Motion::AccelY) => Quantity::Acceleration,
            Slot::Motion(Motion::Brake) => Quantity::Switch,
            Slot::Air(AirField::Temperature) => Quantity::Temperature,
            Slot::Air(AirField::Pressure) => Quantity::Pressure,
            Slot::Air(AirField::Altitude) => Quantity::Length,
            Slot::Position(_) => Quantity::Angle,
            Slot::Axle(_) => Quantity::Mass,
        }
    }

    /// Its unit; itself with its article, and spellings of units that a person may want to use, for messages.
    fn texts(self) -> [&'static str; 3] {
        match self {
            Quantity::Acceleration => ["m/s^2", "an acceleration", "m/s^2, g, mg, cm/s^2, mm/s^2 or ft/s^2"],
            Quantity::Speed => ["m/s", "a speed", "m/s, km/h, mph, kn, cm/s, mm/s or ft/s"],
            Quantity::Pressure => ["kPa", "a pressure", "kPa, Pa, hPa, mbar, bar, MPa or psi"],
            Quantity::Length => ["m", "a length", "m, mm, cm, um, in or ft"],
            Quantity::Time => ["s", "a time", "s, ms, us, ns, min or d (days)"],
            Quantity::Rotation => ["rad/s", "a speed of rotation", "rad/s, deg/s or rpm"],
            Quantity::Temperature => ["degC", "a temperature", "degC, K or degF"],
            Quantity::Angle => ["deg", "an angle", "deg or rad"],
            Quantity::Mass => ["kg", "a mass", "kg, t or lb"],
            Quantity::Switch => ["1", "0 or 1", "1"],
        }
    }

    pub(crate) fn unit(self) -> &'static str {
        self.texts()[0]
    }

    pub(crate) fn words(self) -> &'static str {
        self.texts()[1]
    }

    pub(crate) fn known_units(self) -> &'static str {
        self.texts()[2]
    }
}

impl Slot {
    pub fn unit(self) -> &'static str {
        Quantity::of(self).unit()
    }
}
