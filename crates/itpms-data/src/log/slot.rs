//! The columns that a drive log can have. Their names live here and nowhere else.

use itpms_core::model::Corner;

use super::around::{AirField, AxleField, PositionField};

itpms_core::labelled! {
    /// One quantity of one corner.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Field {
        BodyAccel = "body_accel_m_s2",
        /// Unsprung mass acceleration in m/s², up.
        WheelAccel = "wheel_accel_m_s2",
        /// True gauge pressure in kPa.
        Pressure = "pressure_kpa",
        /// True road height in m.
        Road = "road_m",
        /// Speed of the wheel in m/s, as the car computes it.
        WheelSpeed = "wheel_speed_m_s",
        /// The same as the wheel's speed of rotation in rad/s.
        WheelRotation = "wheel_speed_rad_s",
        /// Gauge pressure in kPa as the car's own sensor in the tire has it: a witness beside the estimate, no truth.
        TireSensor = "tpms_kpa",
        /// Temperature of that sensor in degrees Celsius.
        TireTemperature = "tpms_c",
    }
}

itpms_core::labelled! {
    /// A car's own measurements of its motion besides its speed; for the wheel-speed methods.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Motion {
        /// Yaw rate in rad/s, positive to the left.
        YawRate = "yaw_rate_rad_s",
        /// Acceleration forward in m/s², gravity along a grade included.
        AccelX = "accel_x_m_s2",
        /// Acceleration to the left in m/s².
        AccelY = "accel_y_m_s2",
        /// Whether the driver brakes: 0 or 1.
        Brake = "brake",
    }
}

/// A column that means something to us.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Slot {
    Time,
    Speed,
    /// `{c}_body_accel_m_s2` and the like.
    Corner(Corner, Field),
    /// `yaw_rate_rad_s` and the like.
    Motion(Motion),
    /// `ambient_temperature_c` and the like.
    Air(AirField),
    /// `latitude_deg` and `longitude_deg`.
    Position(PositionField),
    /// `front_axle_kg` and `rear_axle_kg`.
    Axle(AxleField),
}

/// Number of columns that mean something.
pub const SLOTS: usize = OF_AXLES + AxleField::ALL.len();
const OF_MOTION: usize = 2 + 4 * Field::ALL.len();
const OF_AIR: usize = OF_MOTION + Motion::ALL.len();
const OF_POSITION: usize = OF_AIR + AirField::ALL.len();
const OF_AXLES: usize = OF_POSITION + PositionField::ALL.len();

/// The values of one row, by [`Slot::index`]; NaN where missing.
pub(crate) type RawRow = [f64; SLOTS];

impl Slot {
    /// All columns, in the order in which they are written.
    pub fn all() -> impl Iterator<Item = Slot> {
        let corners =
            Corner::ALL.into_iter().flat_map(|c| Field::ALL.into_iter().map(move |f| Slot::Corner(c, f)));
        let car = Motion::ALL.map(Slot::Motion).into_iter().chain(AirField::ALL.map(Slot::Air));
        let position = PositionField::ALL.map(Slot::Position);
        [Slot::Time, Slot::Speed]
            .into_iter()
            .chain(corners)
            .chain(car)
            .chain(position)
            .chain(AxleField::ALL.map(Slot::Axle))
    }

    pub fn index(self) -> usize {
        match self {
            Slot::Time => 0,
            Slot::Speed => 1,
            Slot::Corner(corner, field) => 2 + Field::ALL.len() * corner.index() + field as usize,
            Slot::Motion(motion) => OF_MOTION + motion as usize,
            Slot::Air(field) => OF_AIR + field as usize,
            Slot::Position(field) => OF_POSITION + field as usize,
            Slot::Axle(field) => OF_AXLES + field as usize,
        }
    }

    pub fn name(self) -> String {
        match self {
            Slot::Time => "time_s".to_owned(),
            Slot::Speed => "speed_m_s".to_owned(),
            Slot::Corner(corner, field) => format!("{}_{}", corner.label(), field.label()),
            Slot::Motion(motion) => motion.label().to_owned(),
            Slot::Air(field) => field.label().to_owned(),
            Slot::Position(field) => field.label().to_owned(),
            Slot::Axle(field) => field.label().to_owned(),
        }
    }

    pub(crate) fn is_acceleration(self) -> bool {
        matches!(self, Slot::Corner(_, Field::BodyAccel | Field::WheelAccel))
    }

    /// Whether it comes seldom, and when its sensor likes: of a tire's own sensor, with every minute or less, of the air, and of where
    /// the car is.
    pub(crate) fn is_sparse(self) -> bool {
        self.is_tire_sensor() || matches!(self, Slot::Air(_) | Slot::Position(_) | Slot::Axle(_))
    }

    pub(crate) fn is_tire_sensor(self) -> bool {
        matches!(self, Slot::Corner(_, Field::TireSensor | Field::TireTemperature))
    }

    /// Whether it is the speed of a wheel, in whichever unit.
    pub(crate) fn is_wheel_speed(self) -> bool {
        matches!(self, Slot::Corner(_, Field::WheelSpeed | Field::WheelRotation))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_has_its_own_place_and_name() {
        let slots: Vec<_> = Slot::all().collect();
        assert_eq!(slots.len(), SLOTS);
        for (i, slot) in slots.iter().enumerate() {
            assert_eq!(slot.index(), i);
        }
        assert_eq!(slots[3].name(), "fl_wheel_accel_m_s2");
        assert_eq!(slots[30].name(), "rr_wheel_speed_m_s");
        assert_eq!(slots[32].name(), "rr_tpms_kpa");
        assert_eq!(slots[37].name(), "brake");
        assert_eq!(slots[40].name(), "altitude_m");
        assert_eq!(slots[42].name(), "longitude_deg");
    }
}
