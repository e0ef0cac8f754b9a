//! A row of a drive log, and which columns it has.

use itpms_core::model::{Air, CarSample, Corner, CornerSample, WheelSpeedSample};

use super::around::{AirColumns, AirField, AxleField, PositionColumns, PositionField};
use super::slot::{Field, Motion, SLOTS, Slot};

/// Which columns a drive log has besides `time_s`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LogColumns {
    pub speed: bool,
    /// The corners with both accelerations, in the order of [`Corner::ALL`].
    pub corners: [Option<CornerColumns>; 4],
    pub motion: MotionColumns,
}

/// Which columns of the car's own measurements there are: for the wheel-speed methods, and its tire sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MotionColumns {
    /// Whether `{c}_wheel_speed_m_s` of all four wheels is there.
    pub wheel_speed: bool,
    /// Whether `{c}_wheel_speed_rad_s` of all four wheels is there.
    pub wheel_rotation: bool,
    pub yaw_rate: bool,
    pub accel_x: bool,
    pub accel_y: bool,
    pub brake: bool,
    /// Whether `{c}_tpms_kpa` is there, in the order of [`Corner::ALL`].
    pub tire_sensors: [bool; 4],
    /// Whether `{c}_tpms_c` is there.
    pub tire_temperatures: [bool; 4],
    /// Measurements of the air around the car.
    pub air: AirColumns,
    /// Whether `latitude_deg` and `longitude_deg` are there.
    pub position: PositionColumns,
    /// Whether `front_axle_kg` and `rear_axle_kg` are there.
    pub axles: [bool; 2],
}

impl MotionColumns {
    fn of(has: impl Fn(Slot) -> bool) -> Self {
        let all = |field| Corner::ALL.into_iter().all(|corner| has(Slot::Corner(corner, field)));
        let motion = |motion| has(Slot::Motion(motion));
        let each = |field| Corner::ALL.map(|corner| has(Slot::Corner(corner, field)));
        Self {
            wheel_speed: all(Field::WheelSpeed),
            wheel_rotation: all(Field::WheelRotation),
            yaw_rate: motion(Motion::YawRate),
            accel_x: motion(Motion::AccelX),
            accel_y: motion(Motion::AccelY),
            brake: motion(Motion::Brake),
            tire_sensors: each(Field::TireSensor),
            tire_temperatures: each(Field::TireTemperature),
            air: AirColumns::of(|field| has(Slot::Air(field))),
            position: match PositionField::ALL.map(|field| has(Slot::Position(field))) {
                [true, true] => PositionColumns::Private,
                _ => PositionColumns::Absent,
            },
            axles: AxleField::ALL.map(|field| has(Slot::Axle(field))),
        }
    }

    pub fn wheel_speeds(&self) -> bool {
        self.wheel_speed || self.wheel_rotation
    }

    fn has(&self, motion: Motion) -> bool {
        match motion {
            Motion::YawRate => self.yaw_rate,
            Motion::AccelX => self.accel_x,
            Motion::AccelY => self.accel_y,
            Motion::Brake => self.brake,
        }
    }
}

/// Which truth a corner has besides its two accelerations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CornerColumns {
    pub pressure: bool,
    pub road: bool,
}

impl LogColumns {
    /// Of these columns, what a drive log can have: a corner has both its accelerations or is not there, wheel speeds are those of all
    /// four wheels.
    pub fn of(slots: &[Slot]) -> Self {
        let has = |slot| slots.contains(&slot);
        let corners = Corner::ALL.map(|corner| {
            let slot = |field| Slot::Corner(corner, field);
            let both = has(slot(Field::BodyAccel)) && has(slot(Field::WheelAccel));
            both.then(|| CornerColumns { pressure: has(slot(Field::Pressure)), road: has(slot(Field::Road)) })
        });
        Self { speed: has(Slot::Speed), corners, motion: MotionColumns::of(has) }
    }

    /// Whether anything can be estimated: a corner with both accelerations, or the speeds of all four wheels.
    pub fn are_enough(&self) -> bool {
        self.motion.wheel_speeds() || self.corners.iter().any(Option::is_some)
    }

    pub fn present(&self) -> Vec<Corner> {
        Corner::ALL.into_iter().filter(|corner| self.corners[corner.index()].is_some()).collect()
    }

    pub(crate) fn has(&self, slot: Slot) -> bool {
        match slot {
            Slot::Time => true,
            Slot::Speed => self.speed,
            Slot::Corner(_, Field::WheelSpeed) => self.motion.wheel_speed,
            Slot::Corner(_, Field::WheelRotation) => self.motion.wheel_rotation,
            Slot::Corner(corner, Field::TireSensor) => self.motion.tire_sensors[corner.index()],
            Slot::Corner(corner, Field::TireTemperature) => self.motion.tire_temperatures[corner.index()],
            Slot::Corner(corner, field) => self.corners[corner.index()].is_some_and(|columns| match field {
                Field::Pressure => columns.pressure,
                Field::Road => columns.road,
                _ => true,
            }),
            Slot::Motion(motion) => self.motion.has(motion),
            Slot::Air(field) => self.motion.air.has(field),
            Slot::Position(_) => self.motion.position != PositionColumns::Absent,
            Slot::Axle(field) => self.motion.axles[field as usize],
        }
    }

    /// The columns that are there, in the order in which they are written; where the car is only if that was [asked for](Self::with_position).
    pub fn slots(&self) -> impl Iterator<Item = Slot> + use<> {
        let columns = *self;
        let is_open = columns.motion.position == PositionColumns::Written;
        Slot::all().filter(move |slot| columns.has(*slot) && (is_open || !matches!(slot, Slot::Position(_))))
    }

    /// The same, where the car was being written, too.
    pub fn with_position(mut self) -> Self {
        if self.motion.position == PositionColumns::Private {
            self.motion.position = PositionColumns::Written;
        }
        self
    }
}

/// One corner's part of a row. NaN is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogCorner {
    pub body_accel_m_s2: f64,
    /// Unsprung mass acceleration in m/s², up.
    pub wheel_accel_m_s2: f64,
    /// True gauge pressure in kPa; NaN where the log does not know it.
    pub pressure_kpa: f64,
    /// True road height in m; NaN where the log does not know it.
    pub road_m: f64,
}

impl LogCorner {
    /// Accelerations, of which the truth is not known.
    pub const fn measured(body_accel_m_s2: f64, wheel_accel_m_s2: f64) -> Self {
        Self { body_accel_m_s2, wheel_accel_m_s2, pressure_kpa: f64::NAN, road_m: f64::NAN }
    }

    /// The accelerations, without the truth.
    pub fn sample(&self) -> CornerSample<f64> {
        CornerSample { body_accel_m_s2: self.body_accel_m_s2, wheel_accel_m_s2: self.wheel_accel_m_s2 }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogRow {
    pub time_s: f64,
    /// Vehicle speed in m/s; NaN is missing.
    pub speed_m_s: f64,
    /// The corners the log has, in the order of [`Corner::ALL`].
    pub corners: [Option<LogCorner>; 4],
    /// Wheel speeds, and how the car moves.
    pub motion: LogMotion,
}

/// The car's own measurements in one row: wheel speeds, how it moves, its tire sensors, the air around it. NaN is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogMotion {
    /// Speeds of the wheels in m/s, in the order of [`Corner::ALL`].
    pub wheel_speed_m_s: [f64; 4],
    pub wheel_speed_rad_s: [f64; 4],
    /// Yaw rate in rad/s, positive to the left.
    pub yaw_rate_rad_s: f64,
    /// Acceleration forward in m/s², gravity along a grade included.
    pub accel_x_m_s2: f64,
    pub accel_y_m_s2: f64,
    /// Whether the driver brakes: 0 or 1.
    pub brake: f64,
    /// Gauge pressures in kPa by the sensors in the tires, in the order of [`Corner::ALL`]; in a row where one has sent, or held.
    pub tire_sensor_kpa: [f64; 4],
    pub tire_sensor_c: [f64; 4],
    /// The air around the car, in a row where it was sent, or held.
    pub air: Air<f64>,
    /// Latitude and longitude in degrees, north and east positive, in a row where they were sent, or held.
    pub position_deg: [f64; 2],
    /// What front and rear axle carry in kg by the car's own sensors, in a row where that was sent, or held.
    pub axle_kg: [f64; 2],
}

impl LogMotion {
    pub const UNKNOWN: Self = Self {
        wheel_speed_m_s: [f64::NAN; 4],
        wheel_speed_rad_s: [f64::NAN; 4],
        yaw_rate_rad_s: f64::NAN,
        accel_x_m_s2: f64::NAN,
        accel_y_m_s2: f64::NAN,
        brake: f64::NAN,
        tire_sensor_kpa: [f64::NAN; 4],
        tire_sensor_c: [f64::NAN; 4],
        air: Air { ambient_temperature_c: f64::NAN, barometric_kpa: f64::NAN, altitude_m: f64::NAN },
        position_deg: [f64::NAN; 2],
        axle_kg: [f64::NAN; 2],
    };

    /// The row at `time_s` for radius analysis; speeds of rotation are those of wheels with this rolling radius in m.
    pub fn sample(&self, time_s: f64, rolling_radius_m: f64) -> WheelSpeedSample<f64> {
        let wheel_speed_m_s = Corner::ALL.map(|corner| {
            let [speed, rotation] =
                [self.wheel_speed_m_s, self.wheel_speed_rad_s].map(|of| of[corner.index()]);
            if speed.is_finite() { speed } else { rolling_radius_m * rotation }
        });
        WheelSpeedSample {
            time_s,
            wheel_speed_m_s,
            yaw_rate_rad_s: self.yaw_rate_rad_s,
            accel_x_m_s2: self.accel_x_m_s2,
            accel_y_m_s2: self.accel_y_m_s2,
            brake: self.brake.is_finite().then_some(self.brake > 0.5),
        }
    }

    fn value(&self, motion: Motion) -> f64 {
        match motion {
            Motion::YawRate => self.yaw_rate_rad_s,
            Motion::AccelX => self.accel_x_m_s2,
            Motion::AccelY => self.accel_y_m_s2,
            Motion::Brake => self.brake,
        }
    }
}

impl LogRow {
    /// A row of accelerometers and speed alone.
    pub const fn without_motion(time_s: f64, speed_m_s: f64, corners: [Option<LogCorner>; 4]) -> Self {
        Self { time_s, speed_m_s, corners, motion: LogMotion::UNKNOWN }
    }

    /// The estimators' input: everything but the truth, and the wheel speeds.
    pub fn sample(&self) -> CarSample<f64> {
        CarSample {
            time_s: self.time_s,
            speed_m_s: self.speed_m_s,
            corners: self.corners.map(|corner| corner.map(|c| c.sample())),
            wheel_speeds: None,
        }
    }

    /// The row of these columns with these values, by [`Slot::index`]; NaN is missing.
    pub fn from_values(raw: &[f64; SLOTS], columns: &LogColumns) -> Self {
        let corners = Corner::ALL.map(|corner| {
            let value = |field| raw[Slot::Corner(corner, field).index()];
            columns.corners[corner.index()].map(|_| LogCorner {
                body_accel_m_s2: value(Field::BodyAccel),
                wheel_accel_m_s2: value(Field::WheelAccel),
                pressure_kpa: value(Field::Pressure),
                road_m: value(Field::Road),
            })
        });
        let of = |slot: Slot| if columns.has(slot) { raw[slot.index()] } else { f64::NAN };
        let wheels = |field| Corner::ALL.map(|corner| of(Slot::Corner(corner, field)));
        let motion = LogMotion {
            wheel_speed_m_s: wheels(Field::WheelSpeed),
            wheel_speed_rad_s: wheels(Field::WheelRotation),
            yaw_rate_rad_s: of(Slot::Motion(Motion::YawRate)),
            accel_x_m_s2: of(Slot::Motion(Motion::AccelX)),
            accel_y_m_s2: of(Slot::Motion(Motion::AccelY)),
            brake: of(Slot::Motion(Motion::Brake)),
            tire_sensor_kpa: wheels(Field::TireSensor),
            tire_sensor_c: wheels(Field::TireTemperature),
            air: Air {
                ambient_temperature_c: of(Slot::Air(AirField::Temperature)),
                barometric_kpa: of(Slot::Air(AirField::Pressure)),
                altitude_m: of(Slot::Air(AirField::Altitude)),
            },
            position_deg: PositionField::ALL.map(|field| of(Slot::Position(field))),
            axle_kg: AxleField::ALL.map(|field| of(Slot::Axle(field))),
        };
        Self { time_s: raw[Slot::Time.index()], speed_m_s: raw[Slot::Speed.index()], corners, motion }
    }

    /// Whether all values but the time are the same.
    pub(crate) fn has_values_of(&self, other: &Self) -> bool {
        let same = |slot: Slot| self.value(slot).to_bits() == other.value(slot).to_bits();
        Slot::all().skip(1).all(same)
    }

    /// One value of this row, NaN where it has none.
    pub fn value(&self, slot: Slot) -> f64 {
        match slot {
            Slot::Time => self.time_s,
            Slot::Speed => self.speed_m_s,
            Slot::Motion(motion) => self.motion.value(motion),
            Slot::Air(AirField::Temperature) => self.motion.air.ambient_temperature_c,
            Slot::Air(AirField::Pressure) => self.motion.air.barometric_kpa,
            Slot::Air(AirField::Altitude) => self.motion.air.altitude_m,
            Slot::Position(field) => self.motion.position_deg[field as usize],
            Slot::Axle(field) => self.motion.axle_kg[field as usize],
            Slot::Corner(corner, field) => {
                let of = |value: fn(&LogCorner) -> f64| {
                    self.corners[corner.index()].as_ref().map_or(f64::NAN, value)
                };
                match field {
                    Field::BodyAccel => of(|values| values.body_accel_m_s2),
                    Field::WheelAccel => of(|values| values.wheel_accel_m_s2),
                    Field::Pressure => of(|values| values.pressure_kpa),
                    Field::Road => of(|values| values.road_m),
                    Field::WheelSpeed => self.motion.wheel_speed_m_s[corner.index()],
                    Field::WheelRotation => self.motion.wheel_speed_rad_s[corner.index()],
                    Field::TireSensor => self.motion.tire_sensor_kpa[corner.index()],
                    Field::TireTemperature => self.motion.tire_sensor_c[corner.index()],
                }
            }
        }
    }
}
