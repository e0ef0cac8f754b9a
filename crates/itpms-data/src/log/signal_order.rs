//! Readings of a file into the order of their stamps, and what is left out on the way.
//!
//! Between a feed and the aligner. Where a reading was left out because of its stamp, the rows of that moment are left out, too: they are
//! a gap of the log, and no sensor's silence.

use super::slot::{SLOTS, Slot};
use super::stamps::{Coarse, Fate, Series, Sorted, Stamped, TOLERATED_SHARE, WINDOW_S};
use crate::error::{Problem, coarse_clock};
use crate::signals::Reading;

/// Readings that wait at most for earlier ones: 12 MB, and ten seconds of four wheels at 2 kHz.
const MOST_READINGS: usize = 1 << 19;
/// Readings of a signal that may be left out of any log; beyond, [`TOLERATED_SHARE`] decides.
const TOLERATED_READINGS: u64 = 16;
/// Moments that are remembered at most.
const MOST_HOLES: usize = 4096;

impl Stamped for Reading {
    fn time_s(&self) -> f64 {
        self.time_s
    }

    fn at(self, time_s: f64) -> Self {
        Self { time_s, ..self }
    }

    fn has_values_of(&self, other: &Self) -> bool {
        self.slot == other.slot && self.value.to_bits() == other.value.to_bits()
    }
}

#[derive(Debug)]
pub(super) struct SignalOrder {
    series: [Series<Reading>; SLOTS],
    sorted: Sorted<Reading>,
    left_out: LeftOut,
}

#[derive(Debug)]
struct LeftOut {
    signals: [Signal; SLOTS],
    /// Slot, and the times between which it has no reading because of the reader.
    holes: Vec<(Slot, f64, f64)>,
    repeated: u64,
    rows: u64,
}

#[derive(Debug, Clone, Copy)]
struct Signal {
    kept: u64,
    left_out: u64,
    /// Time of the last reading that was kept, and that after which some were left out; NaN: none.
    last_s: f64,
    since_s: f64,
}

impl SignalOrder {
    pub(super) fn new() -> Self {
        let signal = Signal { kept: 0, left_out: 0, last_s: f64::NEG_INFINITY, since_s: f64::NAN };
        Self {
            series: std::array::from_fn(|_| Series::new()),
            sorted: Sorted::new(MOST_READINGS),
            left_out: LeftOut { signals: [signal; SLOTS], holes: Vec::new(), repeated: 0, rows: 0 },
        }
    }

    /// Takes what a feed says of its next reading.
    pub(super) fn take(&mut self, fate: Fate<Reading>) {
        let Self { series, sorted, left_out } = self;
        match fate {
            Fate::Kept(reading) => {
                series[reading.slot.index()].take(reading, &mut |fate| left_out.sort(fate, sorted));
            }
            other => left_out.sort(other, sorted),
        }
    }

    /// There are no more readings.
    pub(super) fn finish(&mut self) {
        let Self { series, sorted, left_out } = self;
        series.iter_mut().for_each(|series| series.settle(&mut |fate| left_out.sort(fate, sorted)));
        sorted.finish();
        left_out.finish();
    }

    /// The next reading that no earlier one can precede.
    pub(super) fn pop(&mut self) -> Option<Reading> {
        self.sorted.pop()
    }

    /// Whether a row of these values lacks one because it was left out here; then the row is to be, too.
    pub(super) fn is_hole(&mut self, values: &[f64; SLOTS]) -> bool {
        self.left_out.is_hole(values)
    }

    /// Whether what was left out is still a repair, and where readings under a coarse clock belong is sure.
    pub(super) fn check(&self) -> Result<(), Problem> {
        for slot in Slot::all().filter(|slot| slot.is_acceleration() || slot.is_wheel_speed()) {
            let coarse = self.series[slot.index()].coarse();
            if coarse.is_unsure() {
                let Coarse { step_s, rate_hz, .. } = coarse;
                return Err(coarse_clock(&slot.name(), step_s, rate_hz));
            }
            let Signal { kept, left_out, .. } = self.left_out.signals[slot.index()];
            let readings = kept + left_out;
            if left_out > TOLERATED_READINGS && left_out as f64 > TOLERATED_SHARE * readings as f64 {
                return Err(format!(
                    "{left_out} of the {readings} readings of {} have stamps that contradict those of the others by more than ten seconds or \
                     go through the same seconds again, expected 1 % at most (was a clock set? then cut the log there)",
                    slot.name()
                )
                .into());
            }
        }
        Ok(())
    }

    pub(super) fn warnings(&self) -> Vec<String> {
        let LeftOut { signals, repeated, rows, .. } = &self.left_out;
        let strays: u64 = signals.iter().map(|signal| signal.left_out).sum();
        let rows = if *rows == 1 { "1 row".to_owned() } else { format!("{rows} rows") };
        let strays = (strays > 0).then(|| {
            format!("{strays} readings have stamps that contradict the others and were left out, with them {rows} of that time")
        });
        let repeated = (*repeated > 0)
            .then(|| format!("{repeated} readings repeat the time of the one before and were left out"));
        strays.into_iter().chain(repeated).collect()
    }

    /// Corrections that left nothing out, a sentence each.
    pub(super) fn remarks(&self) -> Vec<String> {
        let coarse = self.series.iter().map(Series::coarse);
        let (spread, step_s) =
            coarse.fold((0, 0.0f64), |(spread, step_s), of| (spread + of.spread, step_s.max(of.step_s)));
        let step_ms = (step_s * 1e6).round() / 1e3;
        let spread = (spread > 0).then(|| {
            format!(
                "{spread} readings under a clock of {step_ms} ms a step were spread evenly between its steps"
            )
        });
        // Those that were spread wait for their times, and come later than others for that alone.
        let moved = if spread.is_some() { 0 } else { self.sorted.moved };
        let moved = (moved > 0).then(|| {
            format!("{moved} readings came after later ones and were put into the order of their stamps")
        });
        spread.into_iter().chain(moved).collect()
    }
}

impl LeftOut {
    fn sort(&mut self, fate: Fate<Reading>, sorted: &mut Sorted<Reading>) {
        match fate {
            Fate::Kept(reading) if sorted.push(reading) => self.keep(&reading),
            Fate::Kept(reading) | Fate::Stray(reading) => {
                let signal = &mut self.signals[reading.slot.index()];
                signal.left_out += 1;
                if signal.since_s.is_nan() {
                    signal.since_s = signal.last_s;
                }
            }
            Fate::Repeated(_) => self.repeated += 1,
        }
    }

    fn keep(&mut self, reading: &Reading) {
        let signal = &mut self.signals[reading.slot.index()];
        signal.kept += 1;
        let since_s = std::mem::replace(&mut signal.since_s, f64::NAN);
        signal.last_s = reading.time_s;
        if !since_s.is_nan() && self.holes.len() < MOST_HOLES {
            self.holes.push((reading.slot, since_s.max(reading.time_s - WINDOW_S), reading.time_s));
        }
    }

    fn finish(&mut self) {
        for slot in Slot::all() {
            let Signal { since_s, .. } = self.signals[slot.index()];
            if !since_s.is_nan() {
                self.holes.push((slot, since_s, since_s + WINDOW_S));
            }
        }
    }

    fn is_hole(&mut self, values: &[f64; SLOTS]) -> bool {
        if self.holes.is_empty() {
            return false;
        }
        let time_s = values[Slot::Time.index()];
        self.holes.retain(|(_, _, to_s)| *to_s > time_s - WINDOW_S);
        let inside = |(slot, from_s, to_s): &(Slot, f64, f64)| {
            (*from_s..*to_s).contains(&time_s) && values[slot.index()].is_nan()
        };
        let is_hole = self.holes.iter().any(inside);
        self.rows += u64::from(is_hole);
        is_hole
    }
}
