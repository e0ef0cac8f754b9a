//! One track of road, segment by segment: IRI, level, slope and class, and on how much road and which waves they rest.
//!
//! Takes even heights as a stream; memory is one segment, as far as there is road in it, and a line per segment. Where
//! there is too little road for a number it says so instead. Knows nothing of where the heights come from.

use thiserror::Error;

use super::cells::undo_cells;
use super::golden_car::{Enveloping, GoldenCar, share_of_iri};
use crate::spectrum::{FitError, Psd, REFERENCE_FREQUENCY_PER_M, RoadFit, fit_power_law, welch};

/// Share of a segment that has to be known for its numbers to stand for it.
const LEAST_SHARE: f64 = 0.9;
/// Shortest segment in m: the golden car needs 11 m to settle.
const SHORTEST_SEGMENT_M: f64 = 2.5;
/// A spectrum's window is a third of the segment, but long enough to hold waves of 10 m: the lowest bin and a half.
const LEAST_WINDOW_M: f64 = 16.0;
/// Segments that are kept; what lies beyond (100 000 km at 100 m) is left out.
const MOST_SEGMENTS: f64 = 1e6;
/// Highest spatial frequency of ISO 8608 in cycles per metre.
const HIGHEST_PER_M: f64 = 2.83;
/// Below this share of the waves that make up an IRI, the number is marked as low.
const WHOLE_IRI: f64 = 0.99;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Heights at points, as surveyed.
    Points,
    /// Means over the distance to the next.
    CellMeans,
}

/// How a track is cut and read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurveyOptions {
    /// Where the first segment begins, in m.
    pub origin_m: f64,
    /// Length of a segment in m; a road that is shorter is one segment.
    pub segment_m: f64,
    pub spacing_m: f64,
    /// Whether a tire has smoothed the heights already.
    pub enveloping: Enveloping,
    pub sampling: Sampling,
}

/// Options no road can be read with.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum SurveyError {
    #[error("heights are {0} m apart, expected more than 0 and at most 1 m")]
    Spacing(f64),
    #[error("segments of {found} m, expected {least} m or more")]
    Segment { found: f64, least: f64 },
}

/// Why a segment has no number.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TooLittle {
    #[error("too little road: {known_m:.0} of {segment_m} m")]
    Road { known_m: f64, segment_m: f64 },
    #[error("waves of {shortest_m:.2} to {longest_m:.1} m only: Gd(n0) needs 10 m")]
    Waves { shortest_m: f64, longest_m: f64 },
    #[error("no spectrum: {0}")]
    Spectrum(FitError),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentRoughness {
    pub start_m: f64,
    /// Its length in m: as asked for, or that of a road that is shorter.
    pub length_m: f64,
    /// Length of road whose height is known, in m.
    pub known_m: f64,
    pub iri_m_per_km: Result<f64, TooLittle>,
    /// The share of its IRI that the waves in the data make up, 0 to 1; below 0.99 the number reads low by the rest.
    pub iri_share: f64,
    /// Level, slope and class, with the band they rest on.
    pub fit: Result<RoadFit, TooLittle>,
}

impl SegmentRoughness {
    pub fn end_m(&self) -> f64 {
        self.start_m + self.length_m
    }

    /// Reservations about the numbers, as text; empty if none.
    pub fn note(&self) -> String {
        let low = || format!("IRI from {:.0} % of its waves: reads low", 100.0 * self.iri_share);
        match (&self.iri_m_per_km, &self.fit) {
            (Err(why), _) => why.to_string(),
            (Ok(_), Err(why)) if self.iri_share < WHOLE_IRI => format!("{}; {why}", low()),
            (Ok(_), Err(why)) => why.to_string(),
            (Ok(_), Ok(_)) if self.iri_share < WHOLE_IRI => low(),
            (Ok(_), Ok(_)) => String::new(),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackRoughness {
    /// Its segments, in order, without a gap.
    pub segments: Vec<SegmentRoughness>,
    pub iri_m_per_km: Option<f64>,
    pub known_m: f64,
}

/// The sums of a segment. Slopes come later than heights: the golden car looks a moving average ahead.
#[derive(Debug, Clone, Copy)]
struct Sums {
    heights: f64,
    slopes: f64,
    count: f64,
    /// The band that all heights of the segment hold.
    waves_m: (f64, f64),
    fit: Option<Result<RoadFit, FitError>>,
}

impl Sums {
    const EMPTY: Self =
        Self { heights: 0.0, slopes: 0.0, count: 0.0, waves_m: (0.0, f64::INFINITY), fit: None };
}

#[derive(Debug)]
pub struct TrackSurvey {
    options: SurveyOptions,
    car: GoldenCar,
    /// Where the golden car's next slope belongs.
    slope_at_m: Option<f64>,
    last_m: f64,
    /// Segments that were taken away, all before the first of `segments`.
    taken: usize,
    segments: Vec<Sums>,
    /// Heights of the newest segment, for its spectrum; NaN parts those that do not join.
    heights_m: Vec<f64>,
}

impl TrackSurvey {
    pub fn new(options: SurveyOptions) -> Result<Self, SurveyError> {
        let segment_m = options.segment_m;
        if !(segment_m >= SHORTEST_SEGMENT_M && segment_m.is_finite()) {
            return Err(SurveyError::Segment { found: segment_m, least: SHORTEST_SEGMENT_M });
        }
        let spacing = |_| SurveyError::Spacing(options.spacing_m);
        let car = GoldenCar::new(options.spacing_m, options.enveloping).map_err(spacing)?;
        Ok(Self {
            options,
            car,
            slope_at_m: None,
            last_m: f64::NAN,
            taken: 0,
            segments: Vec::new(),
            heights_m: Vec::new(),
        })
    }

    /// The height at `at_m` (or the mean of the cell that begins there); NaN where it is unknown. Between two heights
    /// more than a spacing apart lies a gap. `waves_m` is the band (shortest, longest) of waves that the height holds.
    pub fn push(&mut self, at_m: f64, height_m: f64, waves_m: (f64, f64)) {
        let spacing_m = self.options.spacing_m;
        if at_m - self.last_m > 1.5 * spacing_m {
            self.interrupt();
        }
        self.last_m = at_m;
        let place = (at_m - self.options.origin_m) / self.options.segment_m + 1e-9;
        if !(0.0..MOST_SEGMENTS).contains(&place) {
            return;
        }
        // Segments that were taken away are over.
        let Some(place) = (place as usize).checked_sub(self.taken) else { return };
        if place >= self.segments.len() {
            self.end_spectrum(self.options.segment_m);
            self.segments.resize(place + 1, Sums::EMPTY);
        }
        if !height_m.is_finite() {
            self.interrupt();
            return;
        }
        let sums = &mut self.segments[place];
        // Between two points lies the road that they tell of; a cell tells of itself.
        let tells = self.options.sampling == Sampling::CellMeans || self.slope_at_m.is_some();
        sums.heights += f64::from(u8::from(tells));
        sums.waves_m = (sums.waves_m.0.max(waves_m.0), sums.waves_m.1.min(waves_m.1));
        self.heights_m.push(height_m);
        self.slope_at_m.get_or_insert(at_m);
        let mut slopes = Vec::new();
        self.car.push(height_m, |slope| slopes.push(slope));
        self.add(&slopes);
    }

    /// What follows does not join what was.
    fn interrupt(&mut self) {
        let mut slopes = Vec::new();
        self.car.push(f64::NAN, |slope| slopes.push(slope));
        self.add(&slopes);
        self.slope_at_m = None;
        if self.heights_m.last().is_some_and(|last| last.is_finite()) {
            self.heights_m.push(f64::NAN);
        }
    }

    fn add(&mut self, slopes: &[f64]) {
        let Some(mut at_m) = self.slope_at_m else { return };
        for slope in slopes {
            let place = (at_m - self.options.origin_m) / self.options.segment_m + 1e-9;
            let place = (place as usize).checked_sub(self.taken);
            if let Some(sums) = place.and_then(|place| self.segments.get_mut(place)) {
                sums.slopes += slope;
                sums.count += 1.0;
            }
            at_m += self.options.spacing_m;
        }
        self.slope_at_m = Some(at_m);
    }

    /// The newest segment, of this length, is complete.
    fn end_spectrum(&mut self, length_m: f64) {
        let psd = self.spectrum(length_m);
        self.heights_m.clear();
        let Some(sums) = self.segments.last_mut() else { return };
        let psd = match self.options.sampling {
            Sampling::Points => psd,
            Sampling::CellMeans => psd.map(|psd| undo_cells(psd, self.options.spacing_m)),
        };
        let highest = HIGHEST_PER_M.min(0.4 / self.options.spacing_m).min(1.0 / sums.waves_m.0);
        sums.fit = psd.map(|psd| fit_power_law(&psd, (1.0 / sums.waves_m.1).max(1e-3), highest));
    }

    /// The spectrum of a segment of this length, from what is known of it.
    fn spectrum(&self, length_m: f64) -> Option<Psd> {
        let spacing_m = self.options.spacing_m;
        let window_m = (length_m / 3.0).max(LEAST_WINDOW_M).min(length_m);
        // Even, and a little shorter than the segment that has to hold it.
        let samples = ((window_m / spacing_m) as usize / 2).saturating_sub(1) * 2;
        // A window is made for heights that can fill it: after a leap in distance there are few in a long segment.
        if samples > self.heights_m.len() {
            return None;
        }
        welch(&self.heights_m, samples, spacing_m).ok().flatten()
    }

    /// The newest segment that is complete, and nothing more of it and those before: for a track without an end, in the
    /// memory of a segment or two. Segments taken are not in the track's total.
    pub fn take_newest(&mut self) -> Option<SegmentRoughness> {
        let reached_m = self.slope_at_m.unwrap_or(self.last_m);
        let place = (reached_m - self.options.origin_m) / self.options.segment_m + 1e-9;
        // NaN before the first height becomes 0.
        let complete = (place as usize).saturating_sub(self.taken).min(self.segments.len().saturating_sub(1));
        let newest = self.segments.get(complete.checked_sub(1)?)?;
        let newest = self.segment(self.taken + complete - 1, self.options.segment_m, newest);
        self.segments.drain(..complete);
        self.taken += complete;
        Some(newest)
    }

    pub fn finish(mut self) -> TrackRoughness {
        self.interrupt();
        let length_m = self.length_m();
        self.end_spectrum(length_m);
        let spacing_m = self.options.spacing_m;
        // A last point on a border begins a segment of no length.
        if self.segments.last().is_some_and(|sums| sums.heights <= 1.0 && sums.count <= 0.0) {
            self.segments.pop();
        }
        let total = |of: fn(&Sums) -> f64| self.segments.iter().map(of).sum::<f64>();
        let (slopes, count) = (total(|s| s.slopes), total(|s| s.count));
        TrackRoughness {
            segments: (self.taken..)
                .zip(&self.segments)
                .map(|(i, sums)| self.segment(i, length_m, sums))
                .collect(),
            iri_m_per_km: (count > 0.0).then(|| 1000.0 * slopes / count),
            known_m: total(|s| s.heights) * spacing_m,
        }
    }

    /// Length of the segments of a track that is over: as asked for, but a road that is shorter is one segment.
    fn length_m(&self) -> f64 {
        let SurveyOptions { origin_m, segment_m, spacing_m, sampling, .. } = self.options;
        if self.taken + self.segments.len() > 1 {
            return segment_m;
        }
        let end_m = match sampling {
            Sampling::Points => self.last_m,
            Sampling::CellMeans => self.last_m + spacing_m,
        };
        (end_m - origin_m).max(SHORTEST_SEGMENT_M).min(segment_m)
    }

    /// `place` counts from the track's beginning.
    fn segment(&self, place: usize, length_m: f64, sums: &Sums) -> SegmentRoughness {
        let SurveyOptions { origin_m, segment_m, spacing_m, .. } = self.options;
        let known_m = sums.heights * spacing_m;
        let both_m = known_m.min(sums.count * spacing_m);
        let enough = both_m >= LEAST_SHARE * length_m;
        let too_little = TooLittle::Road { known_m: both_m, segment_m: length_m };
        let fit = match sums.fit {
            _ if !enough => Err(too_little),
            None => Err(too_little),
            Some(Err(why)) => Err(TooLittle::Spectrum(why)),
            Some(Ok(fit)) if fit.band_per_m.0 > REFERENCE_FREQUENCY_PER_M * 1.001 => {
                let (low, high) = fit.band_per_m;
                Err(TooLittle::Waves { shortest_m: 1.0 / high, longest_m: 1.0 / low })
            }
            Some(Ok(fit)) => Ok(fit),
        };
        let waviness = fit.map_or(2.0, |fit| fit.law.waviness.clamp(1.0, 4.0));
        SegmentRoughness {
            start_m: origin_m + place as f64 * segment_m,
            length_m,
            known_m,
            iri_m_per_km: if enough { Ok(1000.0 * sums.slopes / sums.count) } else { Err(too_little) },
            iri_share: share_of_iri(sums.waves_m.1, waviness),
            fit,
        }
    }
}
