//! The unit of the pressures that people read.

use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use itpms_core::model::PressureUnit;

/// See the [module](self).
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct UnitArgs {
    /// Unit of the pressures that people read: lines and pages. Files, JSON and frames are in kPa.
    #[arg(long, value_name = "UNIT", default_value = PressureUnit::Kpa.label(), value_parser = units())]
    pub(crate) pressure_unit: PressureUnit,
}

fn units() -> impl clap::builder::TypedValueParser<Value = PressureUnit> {
    PossibleValuesParser::new(PressureUnit::ALL.map(PressureUnit::label))
        .map(|label| PressureUnit::from_label(&label).unwrap_or_default())
}
