//! The signals that a strut's force is made of, from the accelerations of its body and its wheel. Every one passes the same high pass, so that
//! relations between forces and accelerations hold for the filtered signals, too.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use itpms_data::reference::FRICTION_ELEMENTS;

/// Signals of a corner: accelerations of body and wheel, rate and way of the strut's deflection, size of the rate, rate times its size, forces
/// of the friction's elements for one newton each.
pub(super) const BODY: usize = 0;
pub(super) const WHEEL: usize = 1;
pub(super) const VELOCITY: usize = 2;
pub(super) const WAY: usize = 3;
pub(super) const SIZE: usize = 4;
pub(super) const SQUARE: usize = 5;
pub(super) const FRICTION: usize = 6;
pub(super) const SIGNALS: usize = FRICTION + FRICTION_ELEMENTS;

/// How far in m each element of the friction is moved before it slips.
const SLIP_M: [f64; FRICTION_ELEMENTS] = [1e-4, 4e-4, 1.5e-3];
/// Corner in rad/s of the high pass, of fourth order, and of the one, of second order, before which friction and dampers are judged: lower, as which way a
/// strut moves must not be shifted.
const HIGH_PASS_RAD_S: f64 = 0.25 * TAU;
const RATE_RAD_S: f64 = 0.05 * TAU;
/// What is left of an integral's drift is taken off as its mean over so many seconds, twice in turn and centered: no phase is shifted. All
/// signals are late by that.
const MEAN_S: f64 = 3.0;
/// Seconds until the filters have forgotten that they began at rest, and the first mean is full.
pub(super) const SETTLING_S: f64 = 12.0;

/// Gain of the high pass for a power.
pub(super) fn high_pass_power(hz: f64) -> f64 {
    let over = TAU * hz / HIGH_PASS_RAD_S;
    (over * over / (over * over + 1.0)).powi(4)
}

/// `s / (s + a)` and `1 / (s + a)`, by the bilinear transform.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
struct FirstOrder {
    half_step: f64,
    keep: f64,
    gain: f64,
}

impl FirstOrder {
    fn new(corner_rad_s: f64, step_s: f64) -> Self {
        let half_step = 0.5 * step_s;
        let g = corner_rad_s * half_step;
        Self { half_step, keep: (1.0 - g) / (1.0 + g), gain: 1.0 / (1.0 + g) }
    }

    fn high_pass(&self, [last_in, last_out]: &mut [f64; 2], value: f64) -> f64 {
        *last_out = self.keep * *last_out + self.gain * (value - *last_in);
        *last_in = value;
        *last_out
    }

    fn integral(&self, [last_in, last_out]: &mut [f64; 2], value: f64) -> f64 {
        *last_out = self.keep * *last_out + self.gain * self.half_step * (value + *last_in);
        *last_in = value;
        *last_out
    }
}

/// States of the filters.
type Stages<const N: usize> = [[f64; 2]; N];

/// A rate without its drift, and the other signals of the same moment.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct Drift {
    /// Samples of a mean: odd.
    samples: usize,
    rates: VecDeque<f64>,
    means: VecDeque<f64>,
    signals: VecDeque<[f64; SIGNALS]>,
    sums: [f64; 2],
}

impl Drift {
    fn new(step_s: f64) -> Self {
        let samples = (MEAN_S / step_s).round() as usize | 1;
        Self {
            samples,
            rates: VecDeque::with_capacity(samples + 1),
            means: VecDeque::with_capacity(samples + 1),
            signals: VecDeque::with_capacity(samples + 1),
            sums: [0.0; 2],
        }
    }

    /// Takes the newest; gives those of [`MEAN_S`] before, zero until they are there.
    fn take_off(&mut self, rate: f64, signals: [f64; SIGNALS]) -> (f64, [f64; SIGNALS]) {
        let length = self.samples as f64;
        let [of_rates, of_means] = &mut self.sums;
        *of_rates += rate;
        self.rates.push_back(rate);
        self.signals.push_back(signals);
        if self.rates.len() < self.samples {
            return (0.0, [0.0; SIGNALS]);
        }
        let mean = *of_rates / length;
        *of_means += mean;
        self.means.push_back(mean);
        let (oldest, then) = (self.rates.pop_front(), self.signals.pop_front());
        *of_rates -= oldest.unwrap_or(0.0);
        if self.means.len() < self.samples {
            return (0.0, [0.0; SIGNALS]);
        }
        let mean_of_means = *of_means / length;
        *of_means -= self.means.pop_front().unwrap_or(0.0);
        (oldest.unwrap_or(0.0) - mean_of_means, then.unwrap_or([0.0; SIGNALS]))
    }
}

#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct CornerSignals {
    filter: FirstOrder,
    rate_filter: FirstOrder,
    step_s: f64,
    accelerations: [Stages<4>; 2],
    velocity: Stages<4>,
    way: Stages<4>,
    rate: Stages<2>,
    drift: Drift,
    forces: [Stages<4>; SIGNALS - SIZE],
    friction: [f64; FRICTION_ELEMENTS],
    last_rate: f64,
}

impl CornerSignals {
    pub(super) fn new(step_s: f64) -> Self {
        Self {
            filter: FirstOrder::new(HIGH_PASS_RAD_S, step_s),
            rate_filter: FirstOrder::new(RATE_RAD_S, step_s),
            step_s,
            accelerations: Default::default(),
            velocity: Default::default(),
            way: Default::default(),
            rate: Default::default(),
            drift: Drift::new(step_s),
            forces: Default::default(),
            friction: [0.0; FRICTION_ELEMENTS],
            last_rate: 0.0,
        }
    }

    /// Takes the accelerations in m/s² of wheel and body.
    pub(super) fn push(&mut self, wheel: f64, body: f64) -> [f64; SIGNALS] {
        let (filter, rate_filter) = (self.filter, self.rate_filter);
        let relative = wheel - body;
        let mut out = [0.0; SIGNALS];
        for (value, (stages, signal)) in
            [body, wheel].into_iter().zip(self.accelerations.iter_mut().zip([BODY, WHEEL]))
        {
            out[signal] = stages.iter_mut().fold(value, |value, stage| filter.high_pass(stage, value));
        }
        let [first, second, third, last] = &mut self.velocity;
        let high =
            [first, second, third].into_iter().fold(relative, |value, stage| filter.high_pass(stage, value));
        out[VELOCITY] = filter.integral(last, high);
        let [first, second, third, last] = &mut self.way;
        let high = [first, second].into_iter().fold(relative, |value, stage| filter.high_pass(stage, value));
        out[WAY] = [third, last].into_iter().fold(high, |value, stage| filter.integral(stage, value));
        let [first, last] = &mut self.rate;
        let high = rate_filter.high_pass(first, relative);
        let (rate, mut out) = self.drift.take_off(rate_filter.integral(last, high), out);
        // The way since the last sample: a rate that turned meanwhile went back and forth.
        let before = std::mem::replace(&mut self.last_rate, rate);
        let mut slip = |way_m: f64| {
            for (force, slip_m) in self.friction.iter_mut().zip(SLIP_M) {
                let towards = way_m.signum();
                *force = towards + (*force - towards) * (-way_m.abs() / slip_m).exp();
            }
        };
        if before * rate < 0.0 {
            let turned = before / (before - rate);
            slip(0.5 * before * turned * self.step_s);
            slip(0.5 * rate * (1.0 - turned) * self.step_s);
        } else {
            slip(0.5 * (before + rate) * self.step_s);
        }
        out[SIZE] = rate.abs();
        out[SQUARE] = rate * rate.abs();
        out[FRICTION..].copy_from_slice(&self.friction);
        for (value, stages) in out[SIZE..].iter_mut().zip(&mut self.forces) {
            *value = stages.iter_mut().fold(*value, |value, stage| filter.high_pass(stage, value));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rate_and_way_are_integrals_of_what_passes_the_same_filter() {
        // A sine of 3 Hz at 200 Hz: amplitudes of acceleration, rate and way go as the bilinear transform's s.
        let (step_s, hz) = (0.005, 3.0);
        let mut corner = CornerSignals::new(step_s);
        let (mut most, mut offset) = ([0.0f64; SIGNALS], 0.0);
        for i in 0..8000 {
            let body = 0.5 + (TAU * hz * step_s * f64::from(i)).sin();
            let out = corner.push(0.2, body);
            if i > 6000 {
                most.iter_mut().zip(out).for_each(|(most, value)| *most = most.max(value.abs()));
                offset += out[VELOCITY] / 2000.0;
            }
        }
        let s = 2.0 / step_s * (0.5 * TAU * hz * step_s).tan();
        assert!((most[VELOCITY] * s / most[BODY] - 1.0).abs() < 3e-3, "{most:?}");
        assert!((most[WAY] * s * s / most[BODY] - 1.0).abs() < 3e-3, "{most:?}");
        // Offsets of the sensors are gone.
        assert!(offset.abs() < 1e-4 && most[WHEEL] < 1e-3, "{offset} {most:?}");
    }

    #[test]
    fn friction_slips_over_the_way_between_two_samples() {
        // A strut that moves to and fro at 8 Hz by 2 mm, at 200 Hz and forty times as finely.
        let (omega, step_s) = (8.0 * TAU, 0.005);
        let (mut coarse, mut fine) = (CornerSignals::new(step_s), CornerSignals::new(step_s / 40.0));
        let accel = |time_s: f64| -2e-3 * omega * omega * (omega * time_s + 0.3).sin();
        let (mut squares, mut count) = ([0.0f64; FRICTION_ELEMENTS], 0.0);
        for i in 0..6000 {
            let time_s = step_s * f64::from(i);
            coarse.push(accel(time_s), 0.0);
            for k in 1..=40 {
                fine.push(accel(time_s - step_s + step_s / 40.0 * f64::from(k)), 0.0);
            }
            if i > 4000 {
                let pairs = squares.iter_mut().zip(coarse.friction.iter().zip(&fine.friction));
                pairs.for_each(|(square, (a, b))| *square += (a - b) * (a - b));
                count += 1.0;
            }
        }
        // A friction that was half a sample ahead would be off by .2 and more.
        for (square, most) in squares.into_iter().zip([0.1, 0.06, 0.03]) {
            assert!((square / count).sqrt() < most, "{:?}", squares.map(|square| (square / count).sqrt()));
        }
    }

    #[test]
    fn which_way_a_strut_moves_is_not_shifted() {
        // Where bodies are on their springs, a rate times its size turns with the rate.
        let (step_s, hz) = (0.005, 1.2);
        let mut corner = CornerSignals::new(step_s);
        let mut sums = [[0.0f64; 2]; 2];
        for i in 0..12_000 {
            let phase = TAU * hz * step_s * f64::from(i);
            let out = corner.push(0.3 + phase.sin(), 0.0);
            if i >= 4000 {
                for (sum, signal) in sums.iter_mut().zip([VELOCITY, SQUARE]) {
                    *sum = [sum[0] + out[signal] * phase.cos(), sum[1] + out[signal] * phase.sin()];
                }
            }
        }
        let [rate, square] = sums.map(|[cosine, sine]| sine.atan2(cosine).to_degrees());
        // Two poles of 0.05 Hz lead by 2 atan(0.05 / 1.2) = 4.8 degrees; the mean adds nothing.
        assert!((square - rate).abs() < 5.5, "{rate} {square}");
    }
}
