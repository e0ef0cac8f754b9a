//! A log before any vehicle is known: its signals over time, their spectra, how well the body of each corner follows its
//! wheel, and what looks wrong, on one page.
//!
//! Called by `itpms plot` row by row; knows no files and no vehicle. Memory is bounded, however long the log.
//!
//! | module | idea |
//! |---|---|
//! | `trace` | a signal over time and its statistics |
//! | `excerpt` | the two seconds in which a wheel moves most |
//! | `wheels` | the wheels' speeds and their ratios |
//! | `words` | what looks wrong |
//! | `page` | all of it as one HTML page |

mod excerpt;
mod page;
mod trace;
mod wheels;
mod words;

use excerpt::Excerpt;
pub use trace::Statistics;
use trace::Trace;
use wheels::Wheels;
pub use wheels::{FoundWheels, WheelSignals};

use crate::transfer::{CrossSpectra, Density, no_suspension_allows};

const GAP_STEPS: f64 = 1.5;
const HOP_HZ: (f64, f64) = (8.0, 20.0);

/// Names of the corners, in the order of their signals.
const CORNERS: [&str; 4] = ["fl", "fr", "rl", "rr"];

/// A log's values of one corner at one time; NaN where a value is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerSignals {
    pub body_accel_m_s2: f64,
    pub wheel_accel_m_s2: f64,
    /// Pressure in kPa, where the log knows it.
    pub pressure_kpa: f64,
    /// Height of the road in m, where the log knows it.
    pub road_m: f64,
}

#[derive(Debug, Default)]
pub struct Overview {
    step_s: f64,
    rows: u64,
    span_s: Option<(f64, f64)>,
    steps: Option<Trace>,
    speed: Option<Trace>,
    wheels: Option<Wheels>,
    corners: [Option<Corner>; 4],
}

#[derive(Debug)]
struct Corner {
    body: Trace,
    wheel: Trace,
    pressure: Trace,
    road: Trace,
    excerpt: Excerpt,
    spectra: CrossSpectra,
}

#[derive(Debug)]
pub struct Found {
    pub rows: u64,
    pub span_s: (f64, f64),
    /// Usual time between two rows in s.
    pub step_s: f64,
    /// Speed in m/s; `None` for a log without one.
    pub speed: Option<Statistics>,
    pub corners: Vec<FoundCorner>,
    /// The speeds of the wheels; `None` for a log without them.
    pub wheels: Option<FoundWheels>,
    steps: Vec<(f64, f64)>,
    speeds: Vec<(f64, f64)>,
}

#[derive(Debug)]
pub struct FoundCorner {
    /// `fl`, `fr`, `rl` or `rr`.
    pub label: &'static str,
    pub body: Statistics,
    pub wheel: Statistics,
    /// Of the pressure in kPa; `None` where the log does not know it.
    pub pressure: Option<Statistics>,
    /// Of the road's height in m; `None` where the log does not know it.
    pub road: Option<Statistics>,
    /// Mean coherence of body and wheel between 4 and 16 Hz.
    pub coherence: f64,
    /// Frequency in Hz between 8 and 20 Hz at which the wheel's spectrum is highest; `None` without a spectrum.
    pub hop_hz: Option<f64>,
    /// Segments of the spectra, of two seconds that overlap by half.
    pub segments: usize,
    /// Body and wheel move as no suspension lets them.
    against: bool,
    lines: Vec<Density>,
    tracks: Tracks,
    excerpt: Vec<(f64, f64, f64)>,
}

/// Courses over time: (s, lowest, highest) of both accelerations and (s, root mean square about the mean), (s, mean) of the rest.
#[derive(Debug)]
struct Tracks {
    body: Vec<(f64, f64, f64)>,
    wheel: Vec<(f64, f64, f64)>,
    body_rms: Vec<(f64, f64)>,
    wheel_rms: Vec<(f64, f64)>,
    pressure: Vec<(f64, f64)>,
    road: Vec<(f64, f64)>,
}

impl Overview {
    /// Empty, for rows that usually are `step_s` apart.
    pub fn new(step_s: f64) -> Self {
        Self { step_s, ..Self::default() }
    }

    /// Takes the next row. A corner that the first row does not have is not looked at.
    pub fn push(&mut self, time_s: f64, speed_m_s: f64, corners: &[Option<CornerSignals>; 4]) {
        let trace = || Trace::new(time_s, self.step_s);
        let before_s = match self.span_s {
            Some((_, last_s)) => last_s,
            None => {
                (self.steps, self.speed) = (Some(trace()), Some(trace()));
                self.corners =
                    corners.map(|corner| corner.is_some().then(|| Corner::new(time_s, self.step_s)));
                time_s
            }
        };
        self.span_s = Some((self.span_s.map_or(time_s, |(first_s, _)| first_s), time_s));
        self.rows += 1;
        if let Some(steps) = &mut self.steps
            && time_s > before_s
        {
            steps.push(time_s, time_s - before_s);
        }
        if let Some(speed) = &mut self.speed {
            speed.push(time_s, speed_m_s);
        }
        let lost = time_s - before_s > GAP_STEPS * self.step_s;
        for (corner, signals) in self.corners.iter_mut().zip(corners) {
            if let (Some(corner), Some(signals)) = (corner, signals) {
                corner.push(time_s, lost, signals);
            }
        }
    }

    /// Takes the wheels' speeds of the last row.
    pub fn push_wheels(&mut self, time_s: f64, signals: &WheelSignals) {
        self.wheels.get_or_insert_with(|| Wheels::new(time_s, self.step_s)).push(time_s, signals);
    }

    /// The findings; `None` without a row.
    pub fn finish(self) -> Option<Found> {
        let (span_s, steps, speed) = (self.span_s?, self.steps?, self.speed?);
        let named = CORNERS.into_iter().zip(self.corners);
        Some(Found {
            rows: self.rows,
            span_s,
            step_s: self.step_s,
            speed: known(&speed),
            wheels: self.wheels.and_then(Wheels::found),
            corners: named.filter_map(|(label, corner)| Some(corner?.found(label))).collect(),
            // A stretch within a gap has no row, and so no step.
            steps: steps
                .course()
                .map(|(s, stretch)| (s, if stretch.high > 0.0 { 1e3 * stretch.high } else { f64::NAN }))
                .collect(),
            speeds: means(&speed),
        })
    }
}

impl Corner {
    fn new(start_s: f64, step_s: f64) -> Self {
        let trace = || Trace::new(start_s, step_s);
        Self {
            body: trace(),
            wheel: trace(),
            pressure: trace(),
            road: trace(),
            excerpt: Excerpt::default(),
            spectra: CrossSpectra::new(step_s),
        }
    }

    fn push(&mut self, time_s: f64, lost: bool, signals: &CornerSignals) {
        let (body, wheel) = (signals.body_accel_m_s2, signals.wheel_accel_m_s2);
        self.body.push(time_s, body);
        self.wheel.push(time_s, wheel);
        self.pressure.push(time_s, signals.pressure_kpa);
        self.road.push(time_s, signals.road_m);
        self.excerpt.push(time_s, body, wheel);
        if lost {
            self.spectra.gap();
        }
        self.spectra.push(wheel, body);
    }

    fn found(self, label: &'static str) -> FoundCorner {
        let lines = self.spectra.densities();
        let hop = lines.iter().filter(|line| (HOP_HZ.0..=HOP_HZ.1).contains(&line.hz));
        FoundCorner {
            label,
            body: self.body.statistics(),
            wheel: self.wheel.statistics(),
            pressure: known(&self.pressure),
            road: known(&self.road),
            coherence: self.spectra.coherence(),
            hop_hz: hop.max_by(|a, b| a.wheel.total_cmp(&b.wheel)).map(|line| line.hz),
            segments: self.spectra.segments(),
            against: no_suspension_allows(&self.spectra),
            tracks: Tracks {
                body: extremes(&self.body),
                wheel: extremes(&self.wheel),
                body_rms: roots(&self.body),
                wheel_rms: roots(&self.wheel),
                pressure: means(&self.pressure),
                road: means(&self.road),
            },
            excerpt: self.excerpt.finish(),
            lines,
        }
    }
}

fn known(trace: &Trace) -> Option<Statistics> {
    let statistics = trace.statistics();
    (statistics.samples > 0).then_some(statistics)
}

fn means(trace: &Trace) -> Vec<(f64, f64)> {
    trace.course().map(|(s, stretch)| (s, stretch.mean())).collect()
}

fn roots(trace: &Trace) -> Vec<(f64, f64)> {
    let mean = trace.statistics().mean;
    trace.course().map(|(s, stretch)| (s, stretch.rms_about(mean))).collect()
}

/// Infinite, and so not drawn, where there is no value.
fn extremes(trace: &Trace) -> Vec<(f64, f64, f64)> {
    trace.course().map(|(s, stretch)| (s, stretch.low, stretch.high)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Evenly drawn from -0.5 to 0.5.
    pub(super) fn noise(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 33) as f64 / f64::from(1u32 << 31) - 0.5
    }

    /// A minute at 200 Hz: the wheel hops at 12 Hz over a hum of 5 Hz and noise, the body follows `gain` times of it.
    pub(super) fn minute(gain: f64, change: impl Fn(usize, &mut CornerSignals)) -> Found {
        let (mut overview, mut state) = (Overview::new(0.005), 1);
        for i in 0..12_000 {
            let time_s = 10.0 + i as f64 * 0.005;
            let wheel = 3.0 * (TAU * 12.0 * time_s).sin() + (TAU * 5.0 * time_s).sin() + noise(&mut state);
            let mut signals = CornerSignals {
                body_accel_m_s2: gain * wheel + 0.01 * (TAU * 31.0 * time_s).sin(),
                wheel_accel_m_s2: wheel,
                pressure_kpa: f64::NAN,
                road_m: f64::NAN,
            };
            change(i, &mut signals);
            overview.push(time_s, 20.0, &[None, Some(signals), None, None]);
        }
        overview.finish().unwrap()
    }

    #[test]
    fn a_log_is_described_by_its_own_figures() {
        let found = minute(0.2, |_, _| {});
        assert_eq!((found.rows, found.corners.len(), found.corners[0].label), (12_000, 1, "fr"));
        assert!((found.span_s.1 - found.span_s.0 - 59.995).abs() < 1e-9);
        let corner = &found.corners[0];
        // Two sines, (9 + 1) / 2, and a twelfth; the noise of 12 000 values is known to 1 %.
        assert!((corner.wheel.sd - (5.0 + 1.0 / 12.0f64).sqrt()).abs() < 2e-3, "{:?}", corner.wheel);
        assert_eq!((corner.hop_hz, corner.pressure, corner.segments), (Some(12.0), None, 59));
        assert_eq!(found.speed.unwrap().mean, 20.0);
        assert!(found.page("drive.csv").contains("<h2>Front right (fr)</h2>"));
    }

    #[test]
    fn a_gap_ends_a_segment_and_shows_in_the_steps() {
        let mut overview = Overview::new(0.01);
        let signals =
            CornerSignals { body_accel_m_s2: 0.0, wheel_accel_m_s2: 0.0, pressure_kpa: 240.0, road_m: 0.0 };
        for i in 0..150 {
            overview.push(f64::from(i) * 0.01, f64::NAN, &[Some(signals), None, None, None]);
        }
        for i in 0..150 {
            overview.push(3.0 + f64::from(i) * 0.01, f64::NAN, &[Some(signals), None, None, None]);
        }
        let found = overview.finish().unwrap();
        assert_eq!((found.corners[0].segments, found.speed), (0, None));
        let longest = found.steps.iter().map(|step| step.1).fold(0.0, f64::max);
        let usual = |ms: f64| (ms - 10.0).abs() < 1e-6 || (ms - 1510.0).abs() < 1e-6 || ms.is_nan();
        assert!(found.steps.iter().all(|step| usual(step.1)), "{:?}", found.steps);
        assert!((longest - 1510.0).abs() < 1e-6, "{longest}");
        assert_eq!(found.corners[0].pressure.unwrap().mean, 240.0);
        assert!(Overview::new(0.01).finish().is_none());
    }
}
