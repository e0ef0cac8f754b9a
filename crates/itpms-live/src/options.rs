//! How a drive is estimated and published.

use itpms_data::log::UnitCheck;
use itpms_data::reference::StoredReference;
use itpms_drive::Settings;
use itpms_road::RoadRepetition;

/// How a drive is estimated and how often it is published.
#[derive(Debug, Clone)]
pub struct DriveOptions {
    /// Of the reference only the name counts, in messages; tooth pulses come with the rows if their table is named.
    pub settings: Settings,
    /// The result of an earlier calibration of this car.
    pub reference: Option<StoredReference>,
    /// Whether numbers that do not look like m/s² and m/s are reported.
    pub units: UnitCheck,
}

impl Default for DriveOptions {
    /// A road in the open does not repeat itself.
    fn default() -> Self {
        let settings = Settings { road_repeats: RoadRepetition::Never, ..Settings::default() };
        Self { settings, reference: None, units: UnitCheck::default() }
    }
}
