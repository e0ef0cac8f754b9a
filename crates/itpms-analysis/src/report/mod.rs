//! One self-contained HTML page about a drive: what was found, how sure it is, and on what grounds.
//!
//! A [`ReportCollector`] takes the estimates as they come and stays small however long the drive; its
//! [`finish`](ReportCollector::finish) gives the [`ReportData`] that [`render_report`] turns into a page. The page
//! needs no network and no other file. Knows nothing of log files, command lines or estimators.

mod alerts;
mod car;
mod cold;
mod collector;
mod digits;
mod figures;
mod figures_table;
mod html;
mod json;
mod parameters;
mod road;
mod roads;
mod suspension;
mod title;
mod track;
mod watch;
mod wheel_cards;
mod wheels;
mod witness;
mod words;

pub use cold::cold_text;
pub use collector::{CornerRow, ReportCollector, ReportOptions};
pub use figures::{CornerFigures, DriveFigures, Reading, TruthFigures};
pub use html::{PLOT_LICENSE, PLOT_SCRIPT, PLOT_STYLE, page as render_report};
pub use parameters::Parameter;
pub use title::title as headline;
pub use track::{Keep, Track};
pub use watch::{AlertSpan, WatchReport};
pub use wheels::{BandCurve, WheelSpeedReport, found, unseen, wheel_line};
pub use witness::TireSensor;

use itpms_core::model::{Corner, CornerConfig, Level, PressureUnit};
use itpms_core::warning::WheelState;

use crate::rotation::OncePerTurn;
use crate::spectrum::RoadFit;
use crate::suspension::SuspensionVerdict;

/// Half the width of a 95 % interval in standard deviations.
pub const Z_95: f64 = 1.959_963_985;

/// Where the numbers come from, shown at the end of the page as given.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Provenance {
    pub program: String,
    /// The day it was made on, as 2026-03-01 (UTC); empty: not shown.
    pub made: String,
    pub source: String,
    pub vehicle: String,
    pub estimator: String,
    /// The command that made it; empty: not shown.
    pub command: String,
    /// Names and values of the options in force.
    pub options: Vec<(String, String)>,
    /// Where the vehicle's parameters come from, in words.
    pub sources: Vec<(Parameter, String)>,
    /// Repairs of the log, with counts.
    pub repairs: Vec<(String, u64)>,
}

#[derive(Debug, Clone)]
pub struct ReportData {
    pub provenance: Provenance,
    pub drive: DriveFigures,
    /// Times in s after [`DriveFigures::origin_s`] of all curves over time, speed among them.
    pub time_s: Vec<f64>,
    /// Speed in m/s at those times; empty when never known.
    pub speed_m_s: Vec<f64>,
    pub corners: Vec<CornerReport>,
    /// The corners of the vehicle that were not.
    pub not_estimated: Vec<Corner>,
    /// The monitor's reports; `None` without a monitor.
    pub watch: Option<WatchReport>,
    pub concerns: Vec<String>,
    pub pressure_unit: PressureUnit,
    /// The report by wheel speeds; `None` where they were not used.
    pub wheel_speeds: Option<WheelSpeedReport>,
    /// Dampers and load; `None` where not all four corners are measured.
    pub suspension: Option<SuspensionVerdict>,
    /// Forces once per wheel turn, in the order of [`Corner::ALL`].
    pub once_per_turn: [Option<OncePerTurn>; 4],
}

#[derive(Debug, Clone)]
pub struct CornerReport {
    pub corner: Corner,
    pub placard_kpa: f64,
    pub config: CornerConfig<f64>,
    /// The final reference of the pressures' level; `None` where nothing was estimated.
    pub level: Option<Level>,
    /// The wheel's state at the end, if a monitor reported it.
    pub state: Option<WheelState>,
    pub figures: CornerFigures,
    /// The tire's own sensor, where the log has one.
    pub tire_sensor: Option<TireSensor>,
    pub curves: TimeCurves,
    /// The road; `None` when the speed is unknown.
    pub road: Option<RoadReport>,
}

/// Curves over time, each as long as [`ReportData::time_s`] or empty when there is nothing to show.
#[derive(Debug, Clone, Default)]
pub struct TimeCurves {
    /// Estimate in kPa, where it is valid.
    pub pressure_kpa: Vec<f64>,
    /// The same where it is not, and is not to be used: while it starts, without information, with a bad sensor.
    pub not_valid_kpa: Vec<f64>,
    /// Lower and upper edge of its 95 % band in kPa.
    pub band_kpa: [Vec<f64>; 2],
    pub truth_kpa: Vec<f64>,
    pub sd_kpa: Vec<f64>,
    pub error_kpa: Vec<f64>,
    pub bound_sd_kpa: Vec<f64>,
    /// Edges of the bound's 95 % band around the truth, or else around the estimate, in kPa.
    pub bound_band_kpa: [Vec<f64>; 2],
    pub forgetting: Vec<f64>,
    pub nis: Vec<f64>,
    /// Its mean over [`NisCheck::window_s`].
    pub nis_mean: Vec<f64>,
    /// How that mean should behave.
    pub nis_check: Option<NisCheck>,
    /// Information gate, 0 to 1.
    pub gate: Vec<f64>,
    pub change_probability: Vec<f64>,
    /// Stretches `(from s, to s, code)`: 0 valid, 1 starting, 2 no information, 3 bad signal, 4 diverged, 5 the car does not fit.
    pub validity: Vec<(f64, f64, f64)>,
    /// Stretches `(from s, to s, code)`: 0 none, 1 malfunction, 2 low.
    pub warning: Vec<(f64, f64, f64)>,
}

/// The band that the averaged innovations of a consistent estimator keep to 95 % of the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NisCheck {
    pub window_s: f64,
    pub lower: f64,
    pub upper: f64,
    pub share_inside: f64,
}

#[derive(Debug, Clone)]
pub struct RoadReport {
    pub profile: ProfileCurves,
    pub roughness: RoughnessCurves,
    /// Power spectral density; `None` on less than 51 m of road.
    pub spectrum: Option<SpectrumCurves>,
    /// Level, slope and class of the estimate, in the band where it holds.
    pub fit: Option<RoadFit>,
    pub truth_fit: Option<RoadFit>,
    pub iri_m_per_km: Option<f64>,
    pub truth_iri_m_per_km: Option<f64>,
    /// Rms of the estimate's error over the rms of the true road, both in the band where the estimate holds.
    pub relative_error: Option<f64>,
}

/// Road height in m over distance in m, its moving average over 10 m subtracted. Without a band: the estimate's standard deviation is that
/// of the height with its slow drift, which is not in these curves (docs/math/road.md, section 3).
#[derive(Debug, Clone, Default)]
pub struct ProfileCurves {
    pub distance_m: Vec<f64>,
    pub height_m: Vec<f64>,
    /// True height, likewise freed; empty when unknown.
    pub truth_m: Vec<f64>,
}

#[derive(Debug, Clone, Default)]
pub struct RoughnessCurves {
    pub distance_m: Vec<f64>,
    pub iri_m_per_km: Vec<f64>,
    /// IRI of the true road in m/km; empty when unknown.
    pub truth_m_per_km: Vec<f64>,
    pub segment_m: f64,
}

/// Power spectral density of the road.
#[derive(Debug, Clone, Default)]
pub struct SpectrumCurves {
    pub frequency_per_m: Vec<f64>,
    /// Density of the estimate in m³.
    pub density_m3: Vec<f64>,
    /// Density of the true road in m³; empty when unknown.
    pub truth_m3: Vec<f64>,
    pub segments: usize,
}
