//! Estimates over time, in the columns of `itpms estimate -o`.

use itpms_core::model::{Corner, Level, Warning};
use itpms_data::out::{
    COLD_COLUMNS, Cell, EstimateRow, Kind, RadiusRow, WheelSpeedUse, cold_values, state_label,
};

use crate::columns::{Columns, Words};

/// A corner's numbers and labels: the columns of `itpms estimate -o`.
const NUMBERS: [&str; 8] = [
    "pressure_kpa",
    "pressure_sd_kpa",
    "stiffness_n_per_m",
    "valid",
    "change_sd_kpa",
    "axle_difference_sd_kpa",
    "lost_kpa",
    "lost_sd_kpa",
];
const WORDS: [&str; 3] = ["warning", "level", "state"];

/// Estimates over time: numbers, and the words beside them.
pub(crate) struct Found {
    corners: Vec<Corner>,
    wheel_speeds: WheelSpeedUse,
    /// Numbers of a corner: with cold pressures where the temperature of the air is there.
    per_corner: usize,
    cells: Vec<Cell<'static>>,
    pub(crate) numbers: Columns,
    pub(crate) words: Words,
}

impl Found {
    pub(crate) fn new(
        corners: &[Corner],
        wheel_speeds: WheelSpeedUse,
        has_temperature: bool,
        rows: usize,
    ) -> Self {
        let cold = if has_temperature { &COLD_COLUMNS[..] } else { &[] };
        let suffixes: Vec<&str> = NUMBERS.iter().chain(cold).copied().collect();
        let of = |corner: &Corner| {
            let label = corner.label();
            let named = |suffix: &&str| (format!("{label}_{suffix}"), Vec::with_capacity(rows));
            suffixes.iter().map(named).collect::<Vec<_>>()
        };
        let mut numbers = vec![("time_s".to_owned(), Vec::with_capacity(rows))];
        numbers.extend(corners.iter().flat_map(of));
        let word = |corner: &Corner| {
            WORDS.map(|suffix| (format!("{}_{suffix}", corner.label()), Vec::with_capacity(rows)))
        };
        let mut words: Words = corners.iter().flat_map(word).collect();
        for (name, kind) in wheel_speeds.columns() {
            match kind {
                Kind::Label => words.push((name, Vec::with_capacity(rows))),
                Kind::Number | Kind::Flag => numbers.push((name, Vec::with_capacity(rows))),
            }
        }
        let (corners, per_corner) = (corners.to_vec(), suffixes.len());
        Self { corners, wheel_speeds, per_corner, cells: Vec::new(), numbers, words }
    }

    pub(crate) fn push(&mut self, row: &EstimateRow<'_>) {
        self.push_radii(row.radii);
        let (time, corners) = self.numbers.split_at_mut(1);
        time[0].1.push(row.time_s);
        for ((corner, words), numbers) in self
            .corners
            .iter()
            .zip(self.words.chunks_exact_mut(WORDS.len()))
            .zip(corners.chunks_exact_mut(self.per_corner))
        {
            let estimate = row.estimates[corner.index()].as_ref();
            const NAN: f64 = f64::NAN;
            let nothing = [NAN, NAN, NAN, 0.0, NAN, NAN, NAN, NAN];
            let values = estimate.map_or(nothing, |e| {
                let valid = if e.validity.is_valid() { 1.0 } else { 0.0 };
                let difference = e.axle_difference_sd_kpa.unwrap_or(NAN);
                let [lost, lost_sd] = e.lost_kpa();
                let (pressure, sd, stiffness) = (e.pressure_kpa, e.pressure_sd_kpa, e.stiffness_n_per_m);
                [pressure, sd, stiffness, valid, e.change_sd_kpa, difference, lost, lost_sd]
            });
            let cold = estimate.map_or([NAN; 2], cold_values);
            for ((_, column), value) in numbers.iter_mut().zip(values.into_iter().chain(cold)) {
                column.push(value);
            }
            words[0].1.push(estimate.map_or(Warning::None, |e| e.warning).label());
            words[1].1.push(estimate.map_or(Level::VehicleFile, |e| e.level).label());
            words[2].1.push(state_label(row.states[corner.index()]));
        }
    }

    /// What wheel speeds say, in the columns after those of the corners.
    fn push_radii(&mut self, radii: Option<&RadiusRow>) {
        self.cells.clear();
        self.wheel_speeds.cells(radii, &mut self.cells);
        let mut numbers = self.numbers.iter_mut().skip(1 + self.per_corner * self.corners.len());
        let mut words = self.words.iter_mut().skip(WORDS.len() * self.corners.len());
        for cell in &self.cells {
            let number = match cell {
                Cell::Number(number) => *number,
                Cell::Flag(flag) => f64::from(u8::from(*flag)),
                Cell::Label(word) => {
                    words.next().into_iter().for_each(|(_, column)| column.push(word));
                    continue;
                }
            };
            numbers.next().into_iter().for_each(|(_, column)| column.push(number));
        }
    }
}
