//! From a stream of estimates to the report's data, in bounded memory.
//!
//! Called by whoever runs an estimator over a log, once per sample. A few thousand buckets per curve, whether the
//! drive lasts a minute or a day.

use itpms_core::model::{Corner, CornerConfig, CornerEstimate, Level, PressureUnit, Validity, Warning};
use itpms_core::warning::MonitorReport;
use itpms_core::wheel_speed::RadiusReport;

use super::figures::{DriveFigures, FigureSums};
use super::road::RoadCollector;
use super::track::{Keep, Track};
use super::watch::WatchCollector;
use super::wheels::WheelSpeedCollector;
use super::witness::Witness;
use super::{CornerReport, NisCheck, Provenance, ReportData, TimeCurves, Z_95};
use crate::bound::{BoundSetting, CornerBound};
use crate::odometer::Odometer;
use crate::spectrum::PowerLaw;

/// Buckets of every curve over time; at most twice as many points are drawn.
const BUCKETS: usize = 2000;
const FINEST_S: f64 = 0.01;
/// Below this speed in m/s a car learns nothing.
const STANDING_M_S: f64 = 2.5;
/// A step in time longer than this many mean steps, and than this many seconds, is a hole in the log.
const HOLE: (f64, f64) = (20.0, 0.5);
/// Logs that begin later than this count from some epoch; their times are shown from the first row on.
const EPOCH_S: f64 = 86_400.0;
/// Accelerometer noise in m/s² assumed for the bound when it is not stated; 1 m/s² would change it by 6 %.
const ASSUMED_NOISE_M_S2: f64 = 0.05;

/// Names of the track's channels: the speed, then this many per corner.
mod channel {
    pub(super) const SPEED: usize = 0;
    pub(super) const FIRST_CORNER: usize = 1;
    pub(super) const PRESSURE: usize = 0;
    pub(super) const LOWER: usize = 1;
    pub(super) const UPPER: usize = 2;
    pub(super) const TRUTH: usize = 3;
    pub(super) const SD: usize = 4;
    pub(super) const ERROR: usize = 5;
    pub(super) const FORGETTING: usize = 6;
    pub(super) const NIS: usize = 7;
    pub(super) const GATE: usize = 8;
    pub(super) const CHANGE: usize = 9;
    pub(super) const VALIDITY: usize = 10;
    pub(super) const WARNING: usize = 11;
    /// The pressure where it is not valid: it is not to be used.
    pub(super) const NOT_VALID: usize = 12;
    pub(super) const PER_CORNER: usize = 13;
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportOptions {
    /// Comparisons with the truth begin this long after the first row, in s.
    pub settle_s: f64,
    /// Shortest and longest wavelength in m that the road estimate holds for.
    pub road_wavelengths_m: (f64, f64),
    /// Degrees of freedom that the innovations add per second: two per complex value, one per real value, less what overlaps. A filter with
    /// two outputs has `2 * rate`; 12 bins each 0.1 s from half-overlapping frames have 120.
    pub nis_dof_per_s: f64,
    /// Whether curves over time are kept, the bound's among them; figures are there without.
    pub curves: bool,
    /// Band of the Cramer-Rao bound in Hz; cut at 0.4 of the rate.
    pub bound_band_hz: (f64, f64),
    pub bound_prior_sd_kpa: f64,
    pub pressure_unit: PressureUnit,
}

impl Default for ReportOptions {
    /// 3 s, 0.5 to 10 m, 120 per second, curves, 3 to 60 Hz, 30 kPa, shown in kPa.
    fn default() -> Self {
        Self {
            settle_s: 3.0,
            road_wavelengths_m: (0.5, 10.0),
            nis_dof_per_s: 120.0,
            curves: true,
            bound_band_hz: (3.0, 60.0),
            bound_prior_sd_kpa: 30.0,
            pressure_unit: PressureUnit::Kpa,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerRow {
    pub estimate: CornerEstimate<f64>,
    /// True pressure in kPa; NaN when unknown.
    pub truth_kpa: f64,
    /// True road height in m; NaN when unknown.
    pub truth_road_m: f64,
    /// Reading of the tire's own sensor in kPa; NaN when none.
    pub sensor_kpa: f64,
}

struct CornerCollector {
    corner: Corner,
    config: CornerConfig<f64>,
    figures: FigureSums,
    road: Option<RoadCollector>,
    level: Option<Level>,
    witness: Witness,
}

/// Collects a drive's estimates, sample by sample.
pub struct ReportCollector {
    options: ReportOptions,
    corners: Vec<CornerCollector>,
    track: Track,
    values: Vec<f64>,
    samples: u64,
    origin_s: f64,
    first_s: f64,
    last_s: f64,
    steps: (f64, f64),
    odometer: Odometer,
    watch: WatchCollector,
    wheels: WheelSpeedCollector,
}

impl ReportCollector {
    /// A collector for the corners that have a configuration, in the order of [`Corner::ALL`].
    pub fn new(corners: &[Option<CornerConfig<f64>>; 4], options: ReportOptions) -> Self {
        let corners: Vec<CornerCollector> = Corner::ALL
            .into_iter()
            .zip(corners)
            .filter_map(|(corner, config)| {
                Some(CornerCollector {
                    corner,
                    config: (*config)?,
                    figures: FigureSums::new(options.settle_s),
                    road: RoadCollector::new(options.road_wavelengths_m),
                    level: None,
                    witness: Witness::default(),
                })
            })
            .collect();
        let channels = channel::FIRST_CORNER + corners.len() * channel::PER_CORNER;
        Self {
            options,
            corners,
            track: Track::new(channels, FINEST_S, BUCKETS),
            values: vec![f64::NAN; channels],
            samples: 0,
            origin_s: 0.0,
            first_s: f64::NAN,
            last_s: f64::NAN,
            steps: (0.0, 0.0),
            odometer: Odometer::new(),
            watch: WatchCollector::new(),
            wheels: WheelSpeedCollector::new(),
        }
    }

    /// Takes the next sample of the log, every one of them: the road is lost at lower rates. Time in s, increasing;
    /// speed in m/s, NaN when unknown; rows of corners without a configuration are ignored.
    pub fn push(&mut self, time_s: f64, speed_m_s: f64, rows: &[Option<CornerRow>; 4]) {
        if !time_s.is_finite() {
            return;
        }
        if self.samples == 0 && time_s.abs() > EPOCH_S {
            self.origin_s = time_s;
        }
        let time_s = time_s - self.origin_s;
        let speed_m_s = self.odometer.push(time_s, speed_m_s);
        let hole = self.advance(time_s);
        let driving = speed_m_s > STANDING_M_S && !hole;
        self.values.fill(f64::NAN);
        self.values[channel::SPEED] = speed_m_s;
        for (corner, values) in self
            .corners
            .iter_mut()
            .zip(self.values[channel::FIRST_CORNER..].chunks_exact_mut(channel::PER_CORNER))
        {
            let row = rows[corner.corner.index()].as_ref();
            if let Some(row) = row {
                corner.level = Some(row.estimate.level);
                corner.figures.push(time_s, &row.estimate, row.truth_kpa);
                corner.witness.push(time_s, &row.estimate, row.sensor_kpa);
                if self.options.curves {
                    fill(values, row);
                }
            }
            if let Some(road) = &mut corner.road {
                match row.filter(|row| driving && road_is_estimated(row.estimate.validity)) {
                    Some(row) => {
                        let e = &row.estimate;
                        road.push(self.odometer.distance_m(), e.road_m, row.truth_road_m);
                    }
                    None => road.interrupt(),
                }
            }
        }
        if self.options.curves {
            self.track.push(time_s, &self.values);
        }
    }

    /// Takes what the monitor says after a sample, as soon as it says so; rows may come later.
    pub fn push_report(&mut self, report: &MonitorReport<f64>) {
        self.watch.push(report);
    }

    /// Takes what the wheel speeds say after a sample at this time in s.
    pub fn push_radii(&mut self, time_s: f64, radii: &RadiusReport<f64>) {
        if time_s.is_finite() {
            self.wheels.push(time_s, radii);
        }
    }

    /// Time and rate; true across a hole in the log.
    fn advance(&mut self, time_s: f64) -> bool {
        self.samples += 1;
        if self.samples == 1 {
            self.first_s = time_s;
        }
        let dt = time_s - self.last_s;
        let hole = dt > HOLE.1 && dt > HOLE.0 * self.steps.0 / self.steps.1;
        if dt > 0.0 && !hole {
            self.steps.0 += dt;
            self.steps.1 += 1.0;
        }
        self.last_s = time_s;
        hole
    }

    pub fn finish(self, provenance: Provenance) -> ReportData {
        let drive = DriveFigures {
            samples: self.samples,
            duration_s: self.last_s - self.first_s,
            rate_hz: self.steps.1 / self.steps.0,
            distance_m: self.odometer.distance_m(),
            origin_s: self.origin_s,
        };
        let (track, options) = (self.track, self.options);
        let watch = self.watch.finish(drive.origin_s);
        let state = |corner: Corner| watch.as_ref().and_then(|watch| watch.last[corner.index()]);
        let corners = self
            .corners
            .into_iter()
            .enumerate()
            .map(|(i, collector)| {
                let base = channel::FIRST_CORNER + i * channel::PER_CORNER;
                let road = collector.road.and_then(RoadCollector::finish);
                let law = road.as_ref().and_then(|road| road.truth_fit.or(road.fit)).map(|fit| fit.law);
                let mut curves = time_curves(&track, base, &options);
                let bound = bound_sd(&track, base, &collector.config, law, drive.rate_hz, &options);
                add_bound(&mut curves, bound);
                CornerReport {
                    corner: collector.corner,
                    placard_kpa: collector.config.placard_kpa,
                    config: collector.config,
                    level: collector.level,
                    state: state(collector.corner),
                    figures: collector.figures.finish(),
                    tire_sensor: collector.witness.finish(),
                    curves,
                    road,
                }
            })
            .collect();
        let speed_m_s = known(track.curve(channel::SPEED, Keep::Extremes));
        let wheel_speeds = self.wheels.finish(drive.origin_s);
        ReportData {
            provenance,
            drive,
            time_s: track.x(),
            speed_m_s,
            corners,
            watch,
            wheel_speeds,
            suspension: None,
            once_per_turn: [None; 4],
            not_estimated: Vec::new(),
            concerns: Vec::new(),
            pressure_unit: options.pressure_unit,
        }
    }
}

fn road_is_estimated(validity: Validity) -> bool {
    !matches!(validity, Validity::BadSignal | Validity::Diverged)
}

/// One row's values, in the order of [`channel`].
fn fill(values: &mut [f64], row: &CornerRow) {
    let e = &row.estimate;
    let half = Z_95 * e.pressure_sd_kpa;
    let (valid, not_valid) =
        if e.validity.is_valid() { (e.pressure_kpa, f64::NAN) } else { (f64::NAN, e.pressure_kpa) };
    values.copy_from_slice(&[
        valid,
        valid - half,
        valid + half,
        row.truth_kpa,
        e.pressure_sd_kpa,
        (e.pressure_kpa - row.truth_kpa).abs(),
        e.diagnostics.forgetting,
        e.diagnostics.nis,
        e.diagnostics.gate,
        e.diagnostics.change_probability,
        match e.validity {
            Validity::Valid => 0.0,
            Validity::Starting => 1.0,
            Validity::NoInformation => 2.0,
            Validity::BadSignal => 3.0,
            Validity::Diverged => 4.0,
            Validity::Misfit => 5.0,
        },
        match e.warning {
            Warning::None => 0.0,
            Warning::Malfunction => 1.0,
            Warning::Low => 2.0,
        },
        not_valid,
    ]);
}

/// A curve, or nothing if it never has a value.
fn known(curve: Vec<f64>) -> Vec<f64> {
    if curve.iter().any(|v| v.is_finite()) { curve } else { Vec::new() }
}

fn time_curves(track: &Track, base: usize, options: &ReportOptions) -> TimeCurves {
    let curve = |channel: usize, keep: Keep| known(track.curve(base + channel, keep));
    let (nis_mean, nis_check) = averaged_nis(track, base + channel::NIS, options.nis_dof_per_s);
    TimeCurves {
        pressure_kpa: curve(channel::PRESSURE, Keep::Extremes),
        not_valid_kpa: curve(channel::NOT_VALID, Keep::Extremes),
        band_kpa: [curve(channel::LOWER, Keep::Lowest), curve(channel::UPPER, Keep::Highest)],
        truth_kpa: curve(channel::TRUTH, Keep::Extremes),
        sd_kpa: curve(channel::SD, Keep::Extremes),
        error_kpa: curve(channel::ERROR, Keep::Extremes),
        forgetting: curve(channel::FORGETTING, Keep::Extremes),
        nis: curve(channel::NIS, Keep::Extremes),
        nis_mean,
        nis_check,
        gate: curve(channel::GATE, Keep::Extremes),
        change_probability: curve(channel::CHANGE, Keep::Extremes),
        validity: track.runs(base + channel::VALIDITY),
        warning: track.runs(base + channel::WARNING),
        ..TimeCurves::default()
    }
}

/// The innovations' mean over a sliding window, and the band it should keep to: `chi²_k / k` for the window's `k`
/// degrees of freedom, by Wilson and Hilferty.
fn averaged_nis(track: &Track, channel: usize, dof_per_s: f64) -> (Vec<f64>, Option<NisCheck>) {
    let window_s = (4.0 * track.width()).max(2.0);
    let points: Vec<(f64, f64)> = track.means(channel).collect();
    let mut means = Vec::with_capacity(points.len());
    let (mut from, mut to, mut sum, mut count) = (0, 0, 0.0, 0.0);
    for &(x, _) in &points {
        while to < points.len() && points[to].0 <= x + 0.5 * window_s {
            if points[to].1.is_finite() {
                sum += points[to].1;
                count += 1.0;
            }
            to += 1;
        }
        while points[from].0 < x - 0.5 * window_s {
            if points[from].1.is_finite() {
                sum -= points[from].1;
                count -= 1.0;
            }
            from += 1;
        }
        means.push(if count > 0.0 { sum / count } else { f64::NAN });
    }
    let k = dof_per_s * window_s;
    let edge = |z: f64| (1.0 - 2.0 / (9.0 * k) + z * (2.0 / (9.0 * k)).sqrt()).powi(3);
    let (lower, upper) = (edge(-Z_95), edge(Z_95));
    let finite: Vec<f64> = means.iter().copied().filter(|m| m.is_finite()).collect();
    if finite.is_empty() || !(k > 0.0) {
        return (Vec::new(), None);
    }
    let inside = finite.iter().filter(|m| (lower..=upper).contains(*m)).count();
    let share_inside = inside as f64 / finite.len() as f64;
    (track.spread(&means), Some(NisCheck { window_s, lower, upper, share_inside }))
}

/// The bound's sd in every bucket; empty when it cannot be computed.
fn bound_sd(
    track: &Track,
    base: usize,
    config: &CornerConfig<f64>,
    road: Option<PowerLaw>,
    rate_hz: f64,
    options: &ReportOptions,
) -> Vec<f64> {
    if !options.curves {
        return Vec::new();
    }
    let speeds: Vec<f64> = track.means(channel::SPEED).map(|(_, v)| v).collect();
    let driven: Vec<f64> = speeds.iter().copied().filter(|v| *v > STANDING_M_S).collect();
    let paper = BoundSetting::paper();
    let setting = BoundSetting {
        // Level and speed hardly matter (docs/math/bound.md), so a missing one may be the paper's.
        road: road.unwrap_or(paper.road),
        speed_m_s: if driven.is_empty() {
            paper.speed_m_s
        } else {
            driven.iter().sum::<f64>() / driven.len() as f64
        },
        rate_hz,
        accel_noise_m_s2: config.accel_noise_m_s2.unwrap_or(ASSUMED_NOISE_M_S2),
        band_hz: (options.bound_band_hz.0, options.bound_band_hz.1.min(0.4 * rate_hz)),
        ..paper
    };
    let Ok(bound) = CornerBound::new(config, &setting) else { return Vec::new() };
    let mut recursion = bound.recursion(options.bound_prior_sd_kpa);
    let means = |channel: usize| track.means(base + channel).map(|(_, v)| v).collect::<Vec<f64>>();
    let (truths, not_valid) = (means(channel::TRUTH), means(channel::NOT_VALID));
    let (mut last_x, mut last_truth) = (f64::NAN, f64::NAN);
    let mut sd = Vec::with_capacity(speeds.len());
    for (i, (x, estimate)) in track.means(base + channel::PRESSURE).enumerate() {
        let dt = x - last_x;
        if speeds[i] <= STANDING_M_S {
            recursion.stand(dt);
        } else {
            let best = [truths[i], estimate, not_valid[i]];
            let pressure = best.into_iter().find(|pressure| pressure.is_finite()).unwrap_or(f64::NAN);
            recursion.drive(dt, pressure, (truths[i] - last_truth) / dt);
        }
        (last_x, last_truth) = (x, truths[i]);
        sd.push(recursion.sd_kpa());
    }
    track.spread(&sd)
}

fn add_bound(curves: &mut TimeCurves, bound_sd_kpa: Vec<f64>) {
    let center = if curves.truth_kpa.is_empty() { &curves.pressure_kpa } else { &curves.truth_kpa };
    if !bound_sd_kpa.is_empty() {
        let edge = |z: f64| center.iter().zip(&bound_sd_kpa).map(|(p, sd)| p + z * sd).collect();
        curves.bound_band_kpa = [edge(-Z_95), edge(Z_95)];
    }
    curves.bound_sd_kpa = bound_sd_kpa;
}
