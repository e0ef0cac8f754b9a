//! The unit of the pressures that people read.

use itpms_console::options::one_of;
use itpms_core::model::PressureUnit;

/// See the [module](self).
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct UnitArgs {
    /// Unit of the pressures that people read: lines and pages. Files, JSON and frames are in kPa.
    #[arg(long, value_name = "UNIT", default_value = PressureUnit::Kpa.label(), value_parser = one_of(PressureUnit::ALL, PressureUnit::label))]
    pub(crate) pressure_unit: PressureUnit,
}
