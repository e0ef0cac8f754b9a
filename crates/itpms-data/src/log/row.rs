//! A row of a drive log and the columns it can have. Names live here and nowhere else.

use itpms_core::model::{CarSample, Corner, CornerSample, Sample};

/// One quantity of one corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// Sprung mass acceleration in m/s², up.
    BodyAccel,
    /// Unsprung mass acceleration in m/s², up.
    WheelAccel,
    /// True gauge pressure in kPa.
    Pressure,
    /// True road height in m.
    Road,
}

impl Field {
    const ALL: [Field; 4] = [Field::BodyAccel, Field::WheelAccel, Field::Pressure, Field::Road];

    fn suffix(self) -> &'static str {
        match self {
            Field::BodyAccel => "body_accel_m_s2",
            Field::WheelAccel => "wheel_accel_m_s2",
            Field::Pressure => "pressure_kpa",
            Field::Road => "road_m",
        }
    }
}

/// A column that means something to us.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Slot {
    /// `time_s`.
    Time,
    /// `speed_m_s`.
    Speed,
    /// `{c}_body_accel_m_s2` and the like.
    Corner(Corner, Field),
}

/// Number of columns that mean something.
pub const SLOTS: usize = 2 + 4 * 4;

/// The values of one row, by [`Slot::index`]; NaN where missing.
pub(crate) type RawRow = [f64; SLOTS];

impl Slot {
    /// All columns, in the order in which they are written.
    pub fn all() -> impl Iterator<Item = Slot> {
        let corners =
            Corner::ALL.into_iter().flat_map(|c| Field::ALL.into_iter().map(move |f| Slot::Corner(c, f)));
        [Slot::Time, Slot::Speed].into_iter().chain(corners)
    }

    /// Its place in [`Slot::all`].
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Slot::Time => 0,
            Slot::Speed => 1,
            Slot::Corner(corner, field) => 2 + 4 * corner.index() + field as usize,
        }
    }

    /// The column's name.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Slot::Time => "time_s".to_owned(),
            Slot::Speed => "speed_m_s".to_owned(),
            Slot::Corner(corner, field) => format!("{}_{}", corner.label(), field.suffix()),
        }
    }
}

/// Which columns a drive log has besides `time_s`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LogColumns {
    /// Whether `speed_m_s` is there.
    pub speed: bool,
    /// The corners with both accelerations, in the order of [`Corner::ALL`].
    pub corners: [Option<CornerColumns>; 4],
}

/// Which truth a corner has besides its two accelerations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CornerColumns {
    /// Whether `{c}_pressure_kpa` is there.
    pub pressure: bool,
    /// Whether `{c}_road_m` is there.
    pub road: bool,
}

impl LogColumns {
    /// Of these columns, what a drive log can have: a corner has both its accelerations or is not there.
    #[must_use]
    pub fn of(slots: &[Slot]) -> Self {
        let has = |slot| slots.contains(&slot);
        let corners = Corner::ALL.map(|corner| {
            let slot = |field| Slot::Corner(corner, field);
            let both = has(slot(Field::BodyAccel)) && has(slot(Field::WheelAccel));
            both.then(|| CornerColumns { pressure: has(slot(Field::Pressure)), road: has(slot(Field::Road)) })
        });
        Self { speed: has(Slot::Speed), corners }
    }

    /// The corners that are there.
    #[must_use]
    pub fn present(&self) -> Vec<Corner> {
        Corner::ALL.into_iter().filter(|corner| self.corners[corner.index()].is_some()).collect()
    }

    /// Whether this column is there.
    pub(crate) fn has(&self, slot: Slot) -> bool {
        match slot {
            Slot::Time => true,
            Slot::Speed => self.speed,
            Slot::Corner(corner, field) => self.corners[corner.index()].is_some_and(|columns| match field {
                Field::BodyAccel | Field::WheelAccel => true,
                Field::Pressure => columns.pressure,
                Field::Road => columns.road,
            }),
        }
    }

    /// The columns that are there, in the order in which they are written.
    pub(crate) fn slots(&self) -> impl Iterator<Item = Slot> {
        let columns = *self;
        Slot::all().filter(move |slot| columns.has(*slot))
    }
}

/// One corner's part of a row. NaN is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogCorner {
    /// Sprung mass acceleration in m/s², up.
    pub body_accel_m_s2: f64,
    /// Unsprung mass acceleration in m/s², up.
    pub wheel_accel_m_s2: f64,
    /// True gauge pressure in kPa; NaN where the log does not know it.
    pub pressure_kpa: f64,
    /// True road height in m; NaN where the log does not know it.
    pub road_m: f64,
}

impl LogCorner {
    /// The accelerations, without the truth.
    #[must_use]
    pub fn sample(&self) -> CornerSample<f64> {
        CornerSample { body_accel_m_s2: self.body_accel_m_s2, wheel_accel_m_s2: self.wheel_accel_m_s2 }
    }
}

/// One row of a drive log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogRow {
    /// Time in s.
    pub time_s: f64,
    /// Vehicle speed in m/s; NaN is missing.
    pub speed_m_s: f64,
    /// The corners the log has, in the order of [`Corner::ALL`].
    pub corners: [Option<LogCorner>; 4],
}

impl LogRow {
    /// What the estimators see of this row: everything but the truth.
    #[must_use]
    pub fn sample(&self) -> CarSample<f64> {
        Sample {
            time_s: self.time_s,
            speed_m_s: self.speed_m_s,
            corners: self.corners.map(|corner| corner.map(|c| c.sample())),
        }
    }

    /// The row of these columns with these values.
    pub(crate) fn from_values(raw: &RawRow, columns: &LogColumns) -> Self {
        let corners = Corner::ALL.map(|corner| {
            let value = |field| raw[Slot::Corner(corner, field).index()];
            columns.corners[corner.index()].map(|_| LogCorner {
                body_accel_m_s2: value(Field::BodyAccel),
                wheel_accel_m_s2: value(Field::WheelAccel),
                pressure_kpa: value(Field::Pressure),
                road_m: value(Field::Road),
            })
        });
        Self { time_s: raw[Slot::Time.index()], speed_m_s: raw[Slot::Speed.index()], corners }
    }

    /// Whether all values but the time are the same.
    pub(crate) fn has_values_of(&self, other: &Self) -> bool {
        let same = |slot: Slot| self.value(slot).to_bits() == other.value(slot).to_bits();
        Slot::all().skip(1).all(same)
    }

    /// One value of this row, NaN where it has none.
    pub(crate) fn value(&self, slot: Slot) -> f64 {
        match slot {
            Slot::Time => self.time_s,
            Slot::Speed => self.speed_m_s,
            Slot::Corner(corner, field) => {
                self.corners[corner.index()].map_or(f64::NAN, |values| match field {
                    Field::BodyAccel => values.body_accel_m_s2,
                    Field::WheelAccel => values.wheel_accel_m_s2,
                    Field::Pressure => values.pressure_kpa,
                    Field::Road => values.road_m,
                })
            }
        }
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
        assert_eq!(slots[17].name(), "rr_road_m");
    }
}
