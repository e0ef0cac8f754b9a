//! Whether the numbers can be in m/s² and m/s: asked once, of the first rows in which the car may be driving.
//!
//! Called by the engine. A drive log is asked by its reader, which refuses it; of a car that drives it is reported.

use itpms_data::LogRow;
use itpms_data::log::{SURVEY_ROWS, UnitCheck, check_units};

/// Speed in m/s above which rows say something of units.
const DRIVES_M_S: f64 = 5.0;

/// The rows that are kept until there are enough.
#[derive(Debug)]
pub(crate) struct UnitWatch {
    rows: Option<Vec<LogRow>>,
}

impl UnitWatch {
    pub(crate) fn new(check: UnitCheck) -> Self {
        Self { rows: (check == UnitCheck::Suspicious).then(Vec::new) }
    }

    /// Takes a row; gives what is to be reported of units, once.
    pub(crate) fn take(&mut self, row: &LogRow) -> Option<String> {
        let rows = self.rows.as_mut().filter(|_| !(row.speed_m_s <= DRIVES_M_S))?;
        rows.push(*row);
        if rows.len() < SURVEY_ROWS {
            return None;
        }
        self.finish()
    }

    /// There will be no more rows.
    pub(crate) fn finish(&mut self) -> Option<String> {
        let rows = self.rows.take()?;
        let problem = check_units(rows.iter()).err()?;
        Some(format!(
            "{problem}: THE ESTIMATES ARE WORTH NOTHING if so; if the numbers are right: --trust-units"
        ))
    }
}
