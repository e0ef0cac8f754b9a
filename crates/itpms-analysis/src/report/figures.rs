//! Headline figures of a drive and of each corner, summed sample by sample.
//!
//! Called by the report's collector. Exact: nothing here is decimated.

use itpms_core::model::{ColdPressure, CornerEstimate, Level, Warning};

use super::Z_95;

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DriveFigures {
    pub samples: u64,
    pub duration_s: f64,
    /// Rows per second: one over the mean step, holes left out.
    pub rate_hz: f64,
    /// Distance in m; NaN when the speed was never known.
    pub distance_m: f64,
    /// The log's time in s that the report's times count from: 0, or the first row's if that is more than a day.
    pub origin_s: f64,
}

/// One estimate, taken out of its series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    pub time_s: f64,
    pub pressure_kpa: f64,
    pub sd_kpa: f64,
}

/// The reference of the last valid reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grounds {
    pub level: Level,
    /// Sd in kPa of the pressure's change within minutes.
    pub change_sd_kpa: f64,
    /// Sd in kPa of its difference from the axle's other tire.
    pub axle_difference_sd_kpa: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthFigures {
    pub rmse_kpa: f64,
    /// Mean error in kPa, estimate less truth.
    pub bias_kpa: f64,
    /// Share of the samples whose 95 % interval holds the truth.
    pub coverage: f64,
    pub samples: u64,
    /// They begin this long after the first, in s.
    pub settle_s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerFigures {
    /// The first valid reading at least `settle_s` after the start.
    pub first: Option<Reading>,
    pub last: Option<Reading>,
    pub grounds: Option<Grounds>,
    /// The cold pressure then, where the temperature of the air was known.
    pub cold: Option<ColdPressure<f64>>,
    /// The valid reading with the lowest upper end of its 95 % interval: the lowest that is sure.
    pub lowest: Option<Reading>,
    /// When `low` was first warned of, in s.
    pub low_since_s: Option<f64>,
    /// When `low` was last warned of, in s.
    pub low_until_s: Option<f64>,
    /// When `malfunction` was first warned of, in s.
    pub malfunction_since_s: Option<f64>,
    pub warning: Warning,
    pub share_valid: f64,
    /// Mean of the normalised innovation squared over its expected value; NaN when never known.
    pub mean_nis: f64,
    pub truth: Option<TruthFigures>,
}

/// The running sums behind [`CornerFigures`].
#[derive(Debug, Clone)]
pub(super) struct FigureSums {
    settle_s: f64,
    start_s: f64,
    rows: u64,
    valid: u64,
    figures: CornerFigures,
    nis: (f64, f64),
    compared: u64,
    inside: u64,
    error: f64,
    square: f64,
}

impl FigureSums {
    pub(super) fn new(settle_s: f64) -> Self {
        let figures = CornerFigures {
            first: None,
            last: None,
            grounds: None,
            cold: None,
            lowest: None,
            low_since_s: None,
            low_until_s: None,
            malfunction_since_s: None,
            warning: Warning::None,
            share_valid: 0.0,
            mean_nis: f64::NAN,
            truth: None,
        };
        Self {
            settle_s,
            start_s: f64::NAN,
            rows: 0,
            valid: 0,
            figures,
            nis: (0.0, 0.0),
            compared: 0,
            inside: 0,
            error: 0.0,
            square: 0.0,
        }
    }

    pub(super) fn push(&mut self, time_s: f64, estimate: &CornerEstimate<f64>, truth_kpa: f64) {
        if self.rows == 0 {
            self.start_s = time_s;
        }
        self.rows += 1;
        let settled = time_s - self.start_s > self.settle_s;
        let reading =
            Reading { time_s, pressure_kpa: estimate.pressure_kpa, sd_kpa: estimate.pressure_sd_kpa };
        let known = reading.pressure_kpa.is_finite() && reading.sd_kpa.is_finite();
        if estimate.validity.is_valid() && known {
            self.valid += 1;
            self.take_valid(reading, settled);
            self.figures.cold = estimate.cold;
            self.figures.grounds = Some(Grounds {
                level: estimate.level,
                change_sd_kpa: estimate.change_sd_kpa,
                axle_difference_sd_kpa: estimate.axle_difference_sd_kpa,
            });
        }
        self.take_warning(time_s, estimate.warning);
        if estimate.diagnostics.nis.is_finite() {
            self.nis.0 += estimate.diagnostics.nis;
            self.nis.1 += 1.0;
        }
        if settled && known && truth_kpa.is_finite() {
            let error = reading.pressure_kpa - truth_kpa;
            self.compared += 1;
            self.error += error;
            self.square += error * error;
            self.inside += u64::from(error.abs() <= Z_95 * reading.sd_kpa);
        }
    }

    fn take_valid(&mut self, reading: Reading, settled: bool) {
        let upper = |r: &Reading| r.pressure_kpa + Z_95 * r.sd_kpa;
        let f = &mut self.figures;
        f.last = Some(reading);
        if settled && f.first.is_none() {
            f.first = Some(reading);
        }
        if f.lowest.is_none_or(|lowest| upper(&reading) < upper(&lowest)) {
            f.lowest = Some(reading);
        }
    }

    fn take_warning(&mut self, time_s: f64, warning: Warning) {
        let f = &mut self.figures;
        f.warning = warning;
        match warning {
            Warning::None => {}
            Warning::Low => {
                f.low_since_s.get_or_insert(time_s);
                f.low_until_s = Some(time_s);
            }
            Warning::Malfunction => {
                f.malfunction_since_s.get_or_insert(time_s);
            }
        }
    }

    pub(super) fn finish(&self) -> CornerFigures {
        let n = self.compared as f64;
        let truth = (self.compared > 0).then(|| TruthFigures {
            rmse_kpa: (self.square / n).sqrt(),
            bias_kpa: self.error / n,
            coverage: self.inside as f64 / n,
            samples: self.compared,
            settle_s: self.settle_s,
        });
        CornerFigures {
            share_valid: self.valid as f64 / self.rows.max(1) as f64,
            mean_nis: self.nis.0 / self.nis.1,
            truth,
            ..self.figures
        }
    }
}
