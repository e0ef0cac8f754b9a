//! From the samples of a real sensor to a uniform grid: checks every value, counts what it refuses, bridges short
//! holes, and interpolates jittered or slow samples onto equal steps.
//!
//! Stands between the clock and every estimator, so that none of them ever sees a missing or absurd value. Knows nothing of cars
//! beyond the size an acceleration can have.

use crate::conditioning::clock::{CLOSEST, LONGEST_BRIDGE};
use crate::conditioning::pauses::MISSING_S;
use crate::memory::Blank;
use crate::model::ABSURD_M_S2;
use crate::real::Real;

/// Points of the Lagrange interpolation. Eight keep the error below 8 % at 0.3 of the sampling rate and below
/// 0.1 % at 0.15 of it, in the middle between samples.
const POINTS: usize = 8;
/// Sampling periods that are no distance.
const ON_SAMPLE: f64 = 1e-5;
/// Sampling periods by which a point of the grid may lie before a sample and still be taken for it, as stamps are rounded: else it would depend on
/// their last digit with which of two samples a step of the grid comes.
const ROUNDED: f64 = 0.01;
/// Mean distance of samples, in periods, from which on they do not come at the stated rate, and over how many it is taken.
const TOO_SELDOM: f64 = 1.75;
const MEAN_OF: f64 = 128.0;
/// Equal values in a row, at the largest magnitude seen, that count as saturation.
const FLAT_TOP: u32 = 3;
/// Equal values in a row, at any magnitude, that are no signal: their steps are marked like saturated ones.
const FLAT: u32 = 8;

/// Counts of the raw samples so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SampleCounts {
    /// Samples used.
    pub accepted: u64,
    /// Samples with a missing or non-finite acceleration.
    pub missing: u64,
    /// Samples beyond 1000 m/s².
    pub absurd: u64,
    /// Samples whose time was not finite or not clearly after the one before, or which the clock did not believe.
    pub out_of_order: u64,
    /// Interruptions too long to bridge.
    pub gaps: u64,
    /// Samples at a sensor's limit.
    pub saturated: u64,
    /// Samples of a sensor that has stopped moving for half a second; not used.
    pub stuck: u64,
}

/// One step of the uniform grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridSample<T> {
    /// Time in s.
    pub time_s: f64,
    /// Seconds since the step before; zero in the first one.
    pub step_s: T,
    /// Vehicle speed in m/s, NaN when unknown.
    pub speed_m_s: T,
    /// Sprung mass acceleration in m/s², finite.
    pub body_accel_m_s2: T,
    /// Unsprung mass acceleration in m/s², finite.
    pub wheel_accel_m_s2: T,
    /// True if the signal was interrupted before this step.
    pub after_gap: bool,
    /// True if the step and what is near it say nothing of the tire: a sensor was at its limit or did not move; for a
    /// spectrum also if the wheel was in the air of late.
    pub invalid: bool,
    /// True if the wheel may have been in the air just then.
    pub unloaded: bool,
}

/// Quality of a sensor's last values, the worst last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Flatness {
    Moving,
    Flat,
    AtLimit,
    Stuck,
}

/// Watches one sensor for a value that does not move.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct FlatWatch<T> {
    last: T,
    equal: u32,
    equal_since_s: f64,
    largest: T,
}

impl<T: Real> FlatWatch<T> {
    fn new() -> Self {
        Self { last: T::zero(), equal: 0, equal_since_s: f64::NEG_INFINITY, largest: T::zero() }
    }

    fn push(&mut self, time_s: f64, value: T) -> Flatness {
        if value == self.last && self.equal > 0 {
            self.equal += 1;
        } else {
            self.last = value;
            self.equal = 1;
            self.equal_since_s = time_s;
        }
        let magnitude = value.abs();
        let at_limit = magnitude >= self.largest && magnitude > T::zero();
        self.largest = self.largest.at_least(magnitude);
        if self.equal > 1 && time_s - self.equal_since_s > MISSING_S {
            Flatness::Stuck
        } else if at_limit && self.equal >= FLAT_TOP {
            Flatness::AtLimit
        } else if self.equal >= FLAT {
            Flatness::Flat
        } else {
            Flatness::Moving
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Periods<T> {
    sample_s: f64,
    grid_s: f64,
    /// The grid's; least and longest distance of two samples, and distances that are none.
    step_s: T,
    closest_s: T,
    longest_s: T,
    on_sample_s: T,
    rounded_s: T,
}

/// Checks and regrids the samples of one corner.
///
/// Times between samples are short, and single precision where a controller has no more: only stamps are double.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Resampler<T> {
    periods: Periods<T>,
    /// The newest samples, oldest first: how many s before the newest one, accelerations of body and wheel; the last `filled` of them
    /// count.
    before_s: [T; POINTS],
    body: [T; POINTS],
    wheel: [T; POINTS],
    filled: usize,
    /// Samples since one whose sensor did not move.
    signal_steps: usize,
    /// The next step of the grid, in s before the newest sample.
    next_before_s: T,
    last_grid_s: f64,
    after_gap: bool,
    body_watch: FlatWatch<T>,
    wheel_watch: FlatWatch<T>,
    last_raw_s: f64,
    last_accepted_s: f64,
    /// Whether these two are the same sample's.
    last_was_accepted: bool,
    refused: u32,
    stuck_now: bool,
    /// Mean distance of the samples in s.
    apart_s: T,
    counts: SampleCounts,
}

impl<T: Real> Resampler<T> {
    /// An intake for samples that come at about `sample_rate_hz`, which must be positive and finite (estimators check it); its grid runs at
    /// the smallest multiple of that rate which reaches `least_grid_rate_hz`, but never at more than 64 times it.
    #[must_use]
    pub fn new(sample_rate_hz: f64, least_grid_rate_hz: f64) -> Self {
        let mut multiple = 1.0;
        while multiple * sample_rate_hz < least_grid_rate_hz && multiple < 64.0 {
            multiple += 1.0;
        }
        let sample_s = 1.0 / sample_rate_hz;
        Self {
            periods: Periods {
                sample_s,
                grid_s: 1.0 / (multiple * sample_rate_hz),
                step_s: T::lit(1.0 / (multiple * sample_rate_hz)),
                closest_s: T::lit(CLOSEST * sample_s),
                longest_s: T::lit(LONGEST_BRIDGE * sample_s),
                on_sample_s: T::lit(ON_SAMPLE * sample_s),
                rounded_s: T::lit(ROUNDED * sample_s),
            },
            last_grid_s: f64::NAN,
            after_gap: true,
            body_watch: FlatWatch::new(),
            wheel_watch: FlatWatch::new(),
            last_raw_s: f64::NEG_INFINITY,
            last_accepted_s: f64::NEG_INFINITY,
            before_s: [T::zero(); POINTS],
            body: [T::zero(); POINTS],
            wheel: [T::zero(); POINTS],
            filled: 0,
            signal_steps: 0,
            next_before_s: T::zero(),
            last_was_accepted: false,
            refused: 0,
            stuck_now: false,
            counts: SampleCounts::default(),
            apart_s: T::zero(),
        }
    }

    /// Step of the grid in s.
    #[must_use]
    pub fn grid_period_s(&self) -> f64 {
        self.periods.grid_s
    }

    /// The findings so far.
    #[must_use]
    pub fn counts(&self) -> SampleCounts {
        self.counts
    }

    /// Ends the record so far: the next step comes after a gap.
    pub(crate) fn interrupt(&mut self) {
        self.filled = 0;
    }

    /// True while the signal cannot be used: nothing accepted for half a second, a sensor or the clock is stuck, or samples do not come at
    /// the stated rate.
    #[must_use]
    pub fn is_bad(&self) -> bool {
        let clock_stuck = self.refused > 0 && f64::from(self.refused) * self.periods.sample_s > MISSING_S;
        let seldom = self.apart_s.to_f64() > TOO_SELDOM * self.periods.sample_s;
        self.stuck_now || clock_stuck || seldom || !(self.last_raw_s - self.last_accepted_s <= MISSING_S)
    }

    /// Takes one raw sample (NaN: missing) and hands every grid step it completes to `sink`. A step comes four samples
    /// after its time, when both sides of the interpolation are there. `time_s`: of a [`SampleClock`](super::SampleClock),
    /// which only goes forwards; NaN for a stamp that it did not believe.
    pub fn push(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        body_accel_m_s2: T,
        wheel_accel_m_s2: T,
        mut sink: impl FnMut(GridSample<T>),
    ) {
        // Closer ones blow up the interpolation.
        let since_raw_s = T::lit(time_s - self.last_raw_s);
        if !(time_s.is_finite() && since_raw_s >= self.periods.closest_s) {
            self.counts.out_of_order += 1;
            self.refused = self.refused.saturating_add(1);
            return;
        }
        self.refused = 0;
        if !since_raw_s.is_finite() {
            self.last_accepted_s = time_s;
        }
        self.last_raw_s = time_s;
        self.apart_s += (since_raw_s.min(self.periods.longest_s) - self.apart_s) * T::lit(1.0 / MEAN_OF);
        let follows = core::mem::replace(&mut self.last_was_accepted, false);
        if !(body_accel_m_s2.is_finite() && wheel_accel_m_s2.is_finite()) {
            self.counts.missing += 1;
            return;
        }
        if !(body_accel_m_s2.abs() < T::lit(ABSURD_M_S2) && wheel_accel_m_s2.abs() < T::lit(ABSURD_M_S2)) {
            self.counts.absurd += 1;
            return;
        }
        let body_flatness = self.body_watch.push(time_s, body_accel_m_s2);
        let flatness = body_flatness.max(self.wheel_watch.push(time_s, wheel_accel_m_s2));
        self.stuck_now = flatness == Flatness::Stuck;
        if self.stuck_now {
            self.counts.stuck += 1;
            return;
        }
        self.counts.saturated += u64::from(flatness == Flatness::AtLimit);
        self.counts.accepted += 1;

        let step_s = if follows { since_raw_s } else { T::lit(time_s - self.last_accepted_s) };
        if self.filled > 0 && step_s > self.periods.longest_s {
            self.counts.gaps += 1;
            self.filled = 0;
        }
        (self.last_accepted_s, self.last_was_accepted) = (time_s, true);
        self.append(step_s, body_accel_m_s2, wheel_accel_m_s2, flatness >= Flatness::Flat);
        self.emit(speed_m_s, &mut sink);
    }

    fn append(&mut self, step_s: T, body: T, wheel: T, no_signal: bool) {
        if self.filled == 0 {
            (self.after_gap, self.before_s) = (true, [T::zero(); POINTS]);
        } else {
            self.next_before_s += step_s;
            self.before_s.iter_mut().for_each(|before_s| *before_s += step_s);
        }
        self.filled = (self.filled + 1).min(POINTS);
        shift_in(&mut self.before_s, T::zero());
        shift_in(&mut self.body, body);
        shift_in(&mut self.wheel, wheel);
        self.signal_steps = if no_signal { 0 } else { self.signal_steps.saturating_add(1) };
    }

    fn emit(&mut self, speed_m_s: T, sink: &mut impl FnMut(GridSample<T>)) {
        if self.filled < POINTS {
            return;
        }
        // Interpolate between the two middle points only, where the error is smallest.
        let [from_s, to_s] = [self.before_s[POINTS / 2 - 1], self.before_s[POINTS / 2]];
        // From then on it lies less than a step of the grid after what was the later of the two with the last sample, or hardly before that.
        if self.after_gap {
            self.next_before_s = from_s;
        }
        let invalid = self.signal_steps < POINTS;
        while self.next_before_s > to_s + self.periods.rounded_s {
            let (body_accel_m_s2, wheel_accel_m_s2) = self.at_next();
            let time_s = self.last_accepted_s - self.next_before_s.to_f64();
            let step_s = match (self.after_gap, self.last_grid_s.is_finite()) {
                (false, _) => self.periods.step_s,
                (true, true) => T::lit(time_s - self.last_grid_s),
                (true, false) => T::zero(),
            };
            let after_gap = core::mem::replace(&mut self.after_gap, false);
            self.last_grid_s = time_s;
            sink(GridSample {
                time_s,
                step_s,
                speed_m_s,
                body_accel_m_s2,
                wheel_accel_m_s2,
                after_gap,
                invalid,
                unloaded: false,
            });
            self.next_before_s -= self.periods.step_s;
        }
    }

    /// Body and wheel at the next step of the grid.
    fn at_next(&mut self) -> (T, T) {
        // A point of the grid that is a sample is that sample, and stays so however often it is rounded.
        for middle in [POINTS / 2 - 1, POINTS / 2] {
            if (self.next_before_s - self.before_s[middle]).abs() < self.periods.on_sample_s {
                self.next_before_s = self.before_s[middle];
                return (self.body[middle], self.wheel[middle]);
            }
        }
        let (mut body, mut wheel) = (T::zero(), T::zero());
        for (i, &weight) in self.lagrange_weights().iter().enumerate() {
            body += weight * self.body[i];
            wheel += weight * self.wheel[i];
        }
        (body, wheel)
    }

    /// Weights of the polynomial through all points, at the next step of the grid.
    fn lagrange_weights(&self) -> [T; POINTS] {
        // Distances in sampling periods, so that f32 keeps its digits.
        let per_s = T::lit(1.0 / self.periods.sample_s);
        let distance = self.before_s.map(|before_s| (before_s - self.next_before_s) * per_s);
        core::array::from_fn(|i| {
            let mut weight = T::one();
            for j in 0..POINTS {
                if j != i {
                    weight *= distance[j] / (distance[j] - distance[i]);
                }
            }
            weight
        })
    }
}

/// The oldest one goes, a new one comes.
fn shift_in<T: Real>(kept: &mut [T; POINTS], newest: T) {
    let [_, a, b, c, d, e, f, g] = *kept;
    *kept = [a, b, c, d, e, f, g, newest];
}
