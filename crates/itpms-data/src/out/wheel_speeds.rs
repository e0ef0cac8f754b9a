//! Results of wheel speeds as columns. Called by the writer of estimates and by the Python package; computes nothing.

use itpms_core::model::{Corner, Level, Warning};
use itpms_core::warning::WheelState;
use itpms_core::wheel_speed::{RadiusReport, SlowLeak, WheelRadius};

use super::cell::{Cell, Kind};
use super::state::{States, state_label};

/// Results of the wheel speeds after a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadiusRow {
    pub radii: RadiusReport<f64>,
    pub states: States,
    /// Evidence of a slow leak over the days since the calibration.
    pub slow_leak: SlowLeak<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WheelSpeedUse {
    /// It has none, or they are not used.
    #[default]
    None,
    Beside,
    /// It has nothing else.
    Alone,
}

impl WheelSpeedUse {
    /// Names and kinds of the columns: per corner `{c}_radius_change, {c}_radius_change_sd, {c}_lost_share, {c}_lost_share_sd,
    /// {c}_low_probability, {c}_detectable_loss` (the smallest loss that would have shown, as a share of the pressure), and `{c}_wheel_speed_state`, or `{c}_valid, {c}_warning, {c}_level, {c}_state` where there is nothing else;
    /// then `front_radius_difference` (left over right), `rear_radius_difference` and `axles_radius_difference` (front over rear), each
    /// with its `_sd`. All are relative changes since the calibration; empty where nothing is known.
    pub fn columns(self) -> Vec<(String, Kind)> {
        let mut columns = Vec::new();
        self.named(None, |of, name, cell| columns.push((format!("{of}_{name}"), cell.kind())));
        columns
    }

    /// The cells of a row, in the order of the columns.
    pub fn cells(self, row: Option<&RadiusRow>, cells: &mut Vec<Cell<'static>>) {
        self.named(row, |_, _, cell| cells.push(cell));
    }

    /// The cells, each with the names of its corner or pair and of its column.
    fn named(self, row: Option<&RadiusRow>, mut put: impl FnMut(&str, &str, Cell<'static>)) {
        if self == Self::None {
            return;
        }
        for (i, corner) in Corner::ALL.into_iter().enumerate() {
            let number = |of: fn(&WheelRadius<f64>) -> f64| {
                Cell::Number(row.map_or(f64::NAN, |row| of(&row.radii.wheels[i])))
            };
            let known = row.is_some_and(|row| row.radii.wheels[i].change.is_finite());
            let state = row.and_then(|row| row.states[corner.index()]);
            let low = number(|wheel| wheel.low_probability);
            let mut put = |column: &str, cell| put(corner.label(), column, cell);
            put("radius_change", number(|wheel| wheel.change));
            put("radius_change_sd", number(|wheel| wheel.change_sd));
            put("lost_share", number(|wheel| wheel.lost_share));
            put("lost_share_sd", number(|wheel| wheel.lost_share_sd));
            put("low_probability", if known { low } else { Cell::Number(f64::NAN) });
            put("detectable_loss", number(|wheel| wheel.detectable_loss_share));
            if self == Self::Alone {
                let warning = if state == Some(WheelState::Low) { Warning::Low } else { Warning::None };
                put("valid", Cell::Flag(row.is_some_and(|row| row.radii.wheels[i].informed())));
                put("warning", Cell::Label(warning.label()));
                put("level", Cell::Label(Level::OtherTires.label()));
                put("state", Cell::Label(state_label(state)));
            } else {
                put("wheel_speed_state", Cell::Label(state_label(state)));
            }
        }
        for (pair, name) in ["front", "rear", "axles"].into_iter().enumerate() {
            let of = |values: fn(&RadiusReport<f64>) -> &[f64; 3]| {
                Cell::Number(row.map_or(f64::NAN, |row| values(&row.radii)[pair]))
            };
            put(name, "radius_difference", of(|radii| &radii.difference));
            put(name, "radius_difference_sd", of(|radii| &radii.difference_sd));
        }
    }
}
