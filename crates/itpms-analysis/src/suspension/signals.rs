//! The signals that a strut's force is made of, from the accelerations of its body and its wheel. Every one passes the same high pass, so that
//! what is true of forces and accelerations is true of what comes out.

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
/// Corner in rad/s of the high pass, of fourth order, and of the one before which friction and dampers are judged: lower, as which way a strut
/// moves must not be shifted.
const HIGH_PASS_RAD_S: f64 = 0.25 * TAU;
const RATE_RAD_S: f64 = 0.1 * TAU;
/// Seconds until the filters have forgotten that they began at rest.
pub(super) const SETTLING_S: f64 = 8.0;

/// What the high pass leaves of a power.
pub(super) fn high_pass_power(hz: f64) -> f64 {
    let over = TAU * hz / HIGH_PASS_RAD_S;
    (over * over / (over * over + 1.0)).powi(4)
}

/// `s / (s + a)` and `1 / (s + a)`, by the bilinear transform.
#[derive(Debug, Clone, Copy)]
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

/// What filters remember.
type Stages<const N: usize> = [[f64; 2]; N];

#[derive(Debug, Clone)]
pub(super) struct CornerSignals {
    filter: FirstOrder,
    rate_filter: FirstOrder,
    step_s: f64,
    accelerations: [Stages<4>; 2],
    velocity: Stages<4>,
    way: Stages<4>,
    rate: Stages<3>,
    forces: [Stages<4>; SIGNALS - SIZE],
    friction: [f64; FRICTION_ELEMENTS],
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
            forces: Default::default(),
            friction: [0.0; FRICTION_ELEMENTS],
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
        let [first, second, last] = &mut self.rate;
        let high =
            [first, second].into_iter().fold(relative, |value, stage| rate_filter.high_pass(stage, value));
        let rate = rate_filter.integral(last, high);
        let way_m = rate.abs() * self.step_s;
        for (force, slip_m) in self.friction.iter_mut().zip(SLIP_M) {
            let towards = rate.signum();
            *force = towards + (*force - towards) * (-way_m / slip_m).exp();
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
}
