//! The road under one wheel, from a stream of samples in time: profile, spectrum, roughness. Bounded memory.
//!
//! Called by the report's collector. Heights are averaged over cells of 5 cm of road; everything else works on
//! cells. Below walking pace the estimate knows little of the road, so a stop ends one stretch and begins another.

use std::collections::VecDeque;

use super::track::{Keep, Track};
use super::{ProfileCurves, RoadReport, RoughnessCurves, SpectrumCurves};
use crate::roughness::{Cells, Enveloping, GoldenCar, undo_cells};
use crate::spectrum::{Psd, Welch, fit_power_law};

const CELL_M: f64 = 0.05;
/// Cells per segment of the spectrum: 51 m.
const SEGMENT: usize = 1024;
/// A longer step from sample to sample is a hole in the log.
const LONGEST_STEP_M: f64 = 1.0;
/// Half the length, in cells, of the moving average that is subtracted from the drawn profile.
const HALF_WINDOW: usize = 100;
/// Shortest stretch of road, in m, that roughness is given for.
const ROUGHNESS_M: f64 = 20.0;
/// Points of drawn curves: at most twice these.
const PROFILE_BUCKETS: usize = 2000;
const ROUGHNESS_BUCKETS: usize = 500;

/// Estimate and truth: in m, NaN where missing.
type Heights = [f64; 2];
const ESTIMATE: usize = 0;
const TRUTH: usize = 1;

/// Golden car, and where its next slope belongs.
#[derive(Debug)]
struct Roughness {
    car: GoldenCar,
    next_at_m: Option<f64>,
    sum: f64,
    count: f64,
    track: Track,
}

impl Roughness {
    fn new(enveloping: Enveloping) -> Option<Self> {
        let car = GoldenCar::new(CELL_M, enveloping).ok()?;
        let track = Track::new(1, ROUGHNESS_M, ROUGHNESS_BUCKETS);
        Some(Self { car, next_at_m: None, sum: 0.0, count: 0.0, track })
    }

    /// The height of the cell that begins at `at_m`; NaN ends a stretch.
    fn push(&mut self, at_m: f64, height_m: f64) {
        let Self { car, next_at_m, sum, count, track } = self;
        let mut next = next_at_m.unwrap_or(at_m);
        car.push(height_m, |slope| {
            *sum += slope;
            *count += 1.0;
            track.push(next, &[1000.0 * slope]);
            next += CELL_M;
        });
        *next_at_m = height_m.is_finite().then_some(next);
    }

    fn iri_m_per_km(&self) -> Option<f64> {
        (self.count * CELL_M >= ROUGHNESS_M).then(|| 1000.0 * self.sum / self.count)
    }
}

/// The cells about one, and the sums of their estimates and true heights: in step with the window, so that a cell costs the same whatever
/// the window's length.
#[derive(Debug)]
struct Window {
    cells: VecDeque<Heights>,
    sums: [Sum; 2],
    /// Cells since the sums were made anew: what is added and taken away again leaves its rounding.
    since: usize,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    of: f64,
    missing: usize,
}

impl Sum {
    fn add(&mut self, value: f64) {
        if value.is_finite() { self.of += value } else { self.missing += 1 }
    }

    fn take_away(&mut self, value: f64) {
        if value.is_finite() { self.of -= value } else { self.missing -= 1 }
    }
}

impl Window {
    const LENGTH: usize = 2 * HALF_WINDOW + 1;

    fn new() -> Self {
        Self { cells: VecDeque::with_capacity(Self::LENGTH), sums: [Sum::default(); 2], since: 0 }
    }

    fn clear(&mut self) {
        self.cells.clear();
        self.sums = [Sum::default(); 2];
    }

    /// Takes a cell. Once the window is full: the cell in its middle, and the means of estimate and truth over all; NaN where one is missing.
    fn push(&mut self, cell: Heights) -> Option<(Heights, [f64; 2])> {
        if self.cells.len() == Self::LENGTH
            && let Some(oldest) = self.cells.pop_front()
        {
            self.sums[0].take_away(oldest[ESTIMATE]);
            self.sums[1].take_away(oldest[TRUTH]);
        }
        self.cells.push_back(cell);
        self.since += 1;
        if self.since >= Self::LENGTH {
            self.since = 0;
            self.sums = [Sum::default(); 2];
            for cell in &self.cells {
                self.sums[0].add(cell[ESTIMATE]);
                self.sums[1].add(cell[TRUTH]);
            }
        } else {
            self.sums[0].add(cell[ESTIMATE]);
            self.sums[1].add(cell[TRUTH]);
        }
        let mean = |sum: Sum| if sum.missing == 0 { sum.of / Self::LENGTH as f64 } else { f64::NAN };
        (self.cells.len() == Self::LENGTH).then(|| (self.cells[HALF_WINDOW], self.sums.map(mean)))
    }
}

/// Everything known of the road under one wheel so far.
#[derive(Debug)]
pub(super) struct RoadCollector {
    cells: Cells<2>,
    start_m: f64,
    done: u64,
    window: Window,
    profile: Track,
    spectrum: [Welch; 3],
    roughness: [Roughness; 2],
    band_per_m: (f64, f64),
    seen_truth: bool,
}

impl RoadCollector {
    /// An empty road; `wavelengths_m` (shortest, longest) is where the estimate holds.
    pub(super) fn new(wavelengths_m: (f64, f64)) -> Option<Self> {
        let welch = || Welch::new(SEGMENT, CELL_M).ok();
        Some(Self {
            cells: Cells::new(CELL_M),
            start_m: 0.0,
            done: 0,
            window: Window::new(),
            profile: Track::new(2, CELL_M, PROFILE_BUCKETS),
            spectrum: [welch()?, welch()?, welch()?],
            // The tire and the estimate's band have smoothed the estimated road already; the true one is a profile as surveyed.
            roughness: [Roughness::new(Enveloping::Done)?, Roughness::new(Enveloping::MovingAverage)?],
            band_per_m: (1.0 / wavelengths_m.1, 1.0 / wavelengths_m.0),
            seen_truth: false,
        })
    }

    /// The next sample: distance driven, estimated and true height, all in m.
    pub(super) fn push(&mut self, distance_m: f64, estimate_m: f64, truth_m: f64) {
        let step = self.cells.last_m().map_or(0.0, |last| distance_m - last);
        if !(estimate_m.is_finite() && distance_m.is_finite() && (0.0..=LONGEST_STEP_M).contains(&step)) {
            self.interrupt();
            return;
        }
        if self.cells.last_m().is_none() {
            self.start_m = distance_m;
            self.done = 0;
        }
        let mut cells = std::mem::replace(&mut self.cells, Cells::new(CELL_M));
        cells.push(distance_m, [estimate_m, truth_m], |cell| self.take_cell(cell));
        self.cells = cells;
    }

    /// The stretch ends here: a stop, a hole in the log, a sensor fault.
    pub(super) fn interrupt(&mut self) {
        if self.cells.last_m().is_some() {
            self.cells.restart();
            self.window.clear();
            self.feed_cell([f64::NAN; 2]);
        }
    }

    fn take_cell(&mut self, cell: Heights) {
        self.feed_cell(cell);
        self.done += 1;
        let Some((here, [mean_estimate, mean_truth])) = self.window.push(cell) else { return };
        let (estimate, truth) = (here[ESTIMATE] - mean_estimate, here[TRUTH] - mean_truth);
        let at = self.start_m + (self.done as f64 - 0.5 - HALF_WINDOW as f64) * CELL_M;
        self.profile.push(at, &[estimate, truth]);
    }

    fn feed_cell(&mut self, cell: Heights) {
        let error = cell[ESTIMATE] - cell[TRUTH];
        self.seen_truth |= cell[TRUTH].is_finite();
        for (welch, value) in self.spectrum.iter_mut().zip([cell[ESTIMATE], cell[TRUTH], error]) {
            welch.push(value);
        }
        let at = self.start_m + self.done as f64 * CELL_M;
        for (roughness, value) in self.roughness.iter_mut().zip([cell[ESTIMATE], cell[TRUTH]]) {
            roughness.push(at, value);
        }
    }

    /// The panels; `None` without a metre of road.
    pub(super) fn finish(mut self) -> Option<RoadReport> {
        self.interrupt();
        if self.profile.is_empty() && self.roughness[0].track.is_empty() {
            return None;
        }
        let profile = ProfileCurves {
            distance_m: self.profile.x(),
            height_m: self.profile.curve(0, Keep::Extremes),
            truth_m: if self.seen_truth { self.profile.curve(1, Keep::Extremes) } else { Vec::new() },
        };
        let roughness = RoughnessCurves {
            distance_m: self.roughness[0].track.places(0).map(|(x, _)| x).collect(),
            iri_m_per_km: self.roughness[0].track.means(0).map(|(_, v)| v).collect(),
            truth_m_per_km: self.truth_roughness(),
            segment_m: self.roughness[0].track.width(),
        };
        let [estimate, truth, error] =
            self.spectrum.map(|welch| welch.psd().map(|psd| undo_cells(psd, CELL_M)));
        let (low, high) = self.band_per_m;
        let fit = estimate.as_ref().and_then(|psd| fit_power_law(psd, low, high).ok());
        let truth_fit = truth.as_ref().and_then(|psd| fit_power_law(psd, low, high).ok());
        let relative_error = error.as_ref().zip(truth.as_ref()).map(|(error, truth)| {
            (error.variance_between(low, high) / truth.variance_between(low, high)).sqrt()
        });
        Some(RoadReport {
            profile,
            roughness,
            spectrum: estimate.as_ref().map(|psd| spectrum_curves(psd, truth.as_ref())),
            fit,
            truth_fit,
            iri_m_per_km: self.roughness[0].iri_m_per_km(),
            truth_iri_m_per_km: self.roughness[1].iri_m_per_km(),
            relative_error,
        })
    }

    fn truth_roughness(&self) -> Vec<f64> {
        let same = self.roughness[0].track.len() == self.roughness[1].track.len();
        if !(self.seen_truth && same) {
            return Vec::new();
        }
        self.roughness[1].track.means(0).map(|(_, v)| v).collect()
    }
}

/// Means over a twenty-fourth of an octave: dense enough to look like the spectrum, a hundred points.
fn spectrum_curves(psd: &Psd, truth: Option<&Psd>) -> SpectrumCurves {
    let mut curves = SpectrumCurves {
        frequency_per_m: Vec::new(),
        density_m3: Vec::new(),
        truth_m3: Vec::new(),
        segments: psd.segments,
    };
    let ratio = (1.0f64 / 24.0).exp2();
    let mut from = 1;
    while from < psd.frequencies.len() {
        let end = psd.frequencies.partition_point(|n| *n < psd.frequencies[from] * ratio).max(from + 1);
        let mean = |values: &[f64]| values[from..end].iter().sum::<f64>() / (end - from) as f64;
        curves.frequency_per_m.push((psd.frequencies[from] * psd.frequencies[end - 1]).sqrt());
        curves.density_m3.push(mean(&psd.densities));
        if let Some(truth) = truth {
            curves.truth_m3.push(mean(&truth.densities));
        }
        from = end;
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine_road(step: f64, metres: f64, scale: f64) -> RoadReport {
        let mut road = RoadCollector::new((0.5, 10.0)).unwrap();
        for i in 0..(metres / step) as usize {
            let x = i as f64 * step;
            let truth = 0.01 * (std::f64::consts::TAU * x / 4.0).sin();
            road.push(x, scale * truth, truth);
        }
        road.finish().unwrap()
    }

    #[test]
    fn a_sine_comes_back_whatever_the_rate() {
        for step in [0.011, 0.13] {
            let report = sine_road(step, 300.0, 0.9);
            // Estimate 10 % small: the error is 10 % of the truth, whatever the window does.
            assert!((report.relative_error.unwrap() - 0.1).abs() < 1e-6);
            // A linear system: IRI is in proportion, and that of a 4 m wave is not zero. Means over five cells leave so much of it.
            let (iri, truth) = (report.iri_m_per_km.unwrap(), report.truth_iri_m_per_km.unwrap());
            let turn = std::f64::consts::PI * CELL_M / 4.0;
            let left = (5.0 * turn).sin() / (5.0 * turn.sin());
            assert!((iri / truth * left - 0.9).abs() < 1e-3 && truth > 5.0, "{iri} {truth} {left}");
            // The moving average of 10 m leaves a 4 m wave between 0.87 and 1.13 of its height.
            let top = report.profile.height_m.iter().copied().fold(0.0, f64::max);
            assert!((0.0078..0.0102).contains(&top), "{top}");
            assert_eq!(report.roughness.distance_m.len(), report.roughness.truth_m_per_km.len());
        }
    }

    #[test]
    fn means_in_step_are_those_of_the_window() {
        let (mut window, mut all) = (Window::new(), Vec::new());
        for i in 0..2000 {
            let height = 1e3 + (0.37 * f64::from(i)).sin();
            // Some true heights are missing, and for longer than the window none is.
            let truth = if i % 7 == 0 && i < 1000 { f64::NAN } else { -height };
            let cell = [height, truth];
            all.push(cell);
            let found = window.push(cell);
            let Some(expected) = all.len().checked_sub(Window::LENGTH).map(|from| &all[from..]) else {
                assert!(found.is_none());
                continue;
            };
            let (here, means) = found.unwrap();
            assert_eq!(here[ESTIMATE], expected[HALF_WINDOW][ESTIMATE]);
            for (mean, place) in means.into_iter().zip([ESTIMATE, TRUTH]) {
                let of = expected.iter().map(|cell| cell[place]).sum::<f64>() / Window::LENGTH as f64;
                // Some hundred roundings of 2e5, spread over as many.
                assert!((mean - of).abs() < 1e-9 || mean.is_nan() && of.is_nan(), "{i}: {mean} {of}");
            }
        }
    }

    #[test]
    fn a_stop_or_a_hole_does_not_become_a_bump() {
        let mut road = RoadCollector::new((0.5, 10.0)).unwrap();
        for i in 0..4000 {
            road.push(f64::from(i) * 0.02, 0.0, f64::NAN);
        }
        road.interrupt();
        for i in 0..4000 {
            road.push(80.0 + f64::from(i) * 0.02, 0.5, f64::NAN);
        }
        // A hole of 20 m, and a missing estimate.
        for i in 0..4000 {
            let height = if i == 2000 {
                f64::NAN
            } else if i < 2000 {
                0.0
            } else {
                -0.3
            };
            road.push(180.0 + f64::from(i) * 0.02, height, f64::NAN);
        }
        let report = road.finish().unwrap();
        assert!(report.iri_m_per_km.unwrap() < 1e-6);
        assert!(report.profile.height_m.iter().all(|z| z.is_nan() || z.abs() < 1e-9));
        assert!(report.truth_iri_m_per_km.is_none() && report.profile.truth_m.is_empty());
    }

    #[test]
    fn a_few_metres_have_no_roughness() {
        for (metres, some) in [(3.0, false), (35.0, true)] {
            let report = sine_road(0.02, metres, 1.0);
            assert_eq!([report.iri_m_per_km, report.truth_iri_m_per_km].map(|iri| iri.is_some()), [some; 2]);
        }
    }

    #[test]
    fn no_road_no_report() {
        assert!(RoadCollector::new((0.5, 10.0)).unwrap().finish().is_none());
    }
}
