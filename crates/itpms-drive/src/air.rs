//! Values of the air in a log that are impossible: counted and reported.

use itpms_core::model::Air;
use itpms_data::log::{AirField, Slot};

/// Values of one column that cannot be, how many and the first.
#[derive(Debug, Clone, Copy, Default)]
struct Odd {
    count: u64,
    first: f64,
}

/// The columns of the air, in the order of [`FIELDS`].
#[derive(Debug, Clone, Default)]
pub(crate) struct AirCheck {
    odd: [Odd; 3],
    known: bool,
}

const FIELDS: [(AirField, &str); 3] = [
    (AirField::Temperature, "no air on a road has (-60 to 65 C)"),
    (AirField::Pressure, "no place with roads has (45 to 110 kPa: absolute, in kPa?)"),
    (AirField::Altitude, "no road has (-500 to 6000 m)"),
];

impl AirCheck {
    pub(crate) fn take(&mut self, air: &Air<f64>) {
        let values = |air: &Air<f64>| [air.ambient_temperature_c, air.barometric_kpa, air.altitude_m];
        let plausible = values(&air.plausible());
        self.known |= plausible[0].is_finite();
        for ((odd, value), plausible) in self.odd.iter_mut().zip(values(air)).zip(plausible) {
            if value.is_finite() && plausible.is_nan() {
                if odd.count == 0 {
                    odd.first = value;
                }
                odd.count += 1;
            }
        }
    }

    /// A sentence for each column with such values, and one where a temperature that the log has a column for is never there.
    pub(crate) fn concerns(&self, has_temperature: bool) -> impl Iterator<Item = String> + '_ {
        let odd = self.odd.iter().zip(FIELDS).filter(|(odd, _)| odd.count > 0).map(|(odd, (field, what))| {
            let (column, Odd { count, first }) = (Slot::Air(field).name(), odd);
            format!("{count} values of {column} are such as {what}, the first {first}; they count as missing")
        });
        let never = (has_temperature && !self.known)
            .then(|| "ambient_temperature_c has no value that can be: no cold pressure is known".to_owned());
        odd.chain(never)
    }
}
