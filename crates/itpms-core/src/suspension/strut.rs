//! One corner's strut: its friction force, sample by sample, and short spectra of all that appears in the body's equation of motion.

use super::coherence::Coherence;
use super::maxwell_slip::{ELEMENTS, MaxwellSlip};
use crate::conditioning::{GridSample, STANDING_M_S};
use crate::memory::{Placed, blank};
use crate::real::Real;
use crate::spectrum::butterworth::{QUALITY, Section};
use crate::spectrum::reconstruction::Channel;
use crate::spectrum::transfer::{FRICTION_BINS, FRICTION_SPACING_HZ};
use crate::spectrum::{Frame, FrameClock};

/// Bins of a frame: 2.5, 5, ... 25 Hz; nominal time between frames in s.
pub(super) const BINS: usize = FRICTION_BINS;
pub(super) const BIN_SPACING_HZ: f64 = FRICTION_SPACING_HZ;
const HOP_S: f64 = 0.5 / BIN_SPACING_HZ;
/// Corners in Hz of the filters before thinning, and the rate to which signals are thinned at least.
const SMOOTH_HZ: f64 = 35.0;
const LOWEST_HZ: f64 = 2.0;
const LEAST_RATE_HZ: f64 = 100.0;
/// Hops until the filters have forgotten that they began at rest.
const SETTLING_HOPS: u32 = 2;

/// Seconds of frames before the coherence is reported.
const ENOUGH_S: f64 = 4.0;

/// Signals of a frame: jerk of the body, relative acceleration and velocity, rates of the elements' forces, jerk of the wheel.
pub(super) const BODY: usize = 0;
pub(super) const ACCELERATION: usize = 1;
pub(super) const VELOCITY: usize = 2;
pub(super) const FRICTION: usize = 3;
pub(super) const WHEEL: usize = FRICTION + ELEMENTS;
const SIGNALS: usize = WHEEL + 1;

/// A frame of one corner.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StrutFrame<T: Real> {
    /// Time in s of its end.
    pub(crate) time_s: f64,
    pub(super) spectra: Frame<T, BINS, SIGNALS>,
}

impl<T: Real> StrutFrame<T> {
    /// Power of the deflection's rate, all bins together.
    pub(super) fn deflection_power(&self) -> T {
        (0..BINS).fold(T::zero(), |sum, bin| sum + self.spectra.at(bin, VELOCITY).norm_sqr())
    }
}

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Strut<T: Real> {
    /// Slip forces in N of the elements, as identified.
    slip_force_n: [T; ELEMENTS],
    slip: MaxwellSlip<T>,
    /// Body, wheel, elements.
    channels: [Channel<T>; 2 + ELEMENTS],
    dt: T,
    steps: u32,
    filters: [Section<T>; 4],
    states: [[[T; 2]; 4]; SIGNALS],
    every: u32,
    step: u32,
    clock: FrameClock<T, BINS, SIGNALS>,
    /// False until a step at which frames of all corners may begin.
    begun: bool,
    invalid_hops: u32,
    frame: Placed<StrutFrame<T>>,
    noise_density: T,
    coherence: Coherence<T>,
}

blank!(StrutFrame<T> { time_s, spectra });
blank!(Strut<T> {
    slip_force_n, slip, channels, dt, steps, filters, states, every, step, clock, begun, invalid_hops, frame,
    noise_density, coherence,
});

impl<T: Real> Strut<T> {
    /// For grid steps of this period and sensors of this noise density in (m/s²)²/Hz; whatever was there is forgotten.
    #[inline(never)]
    pub(crate) fn configure(&mut self, grid_period_s: f64, noise_density: T) {
        let rate_hz = 1.0 / grid_period_s;
        let every = ((rate_hz / LEAST_RATE_HZ + 1e-9) as u32).max(1);
        self.slip_force_n = [T::zero(); ELEMENTS];
        self.slip = MaxwellSlip::new();
        self.channels = [Channel::new(); 2 + ELEMENTS];
        self.dt = T::lit(grid_period_s);
        self.filters = [
            Section::low_pass(SMOOTH_HZ, rate_hz, QUALITY[0]),
            Section::low_pass(SMOOTH_HZ, rate_hz, QUALITY[1]),
            Section::high_pass(LOWEST_HZ, rate_hz, QUALITY[0]),
            Section::high_pass(LOWEST_HZ, rate_hz, QUALITY[1]),
        ];
        self.states = [[[T::zero(); 2]; 4]; SIGNALS];
        (self.every, self.steps, self.step) = (every, 0, 0);
        self.clock.configure(HOP_S, grid_period_s * f64::from(every));
        (self.begun, self.invalid_hops) = (false, SETTLING_HOPS);
        self.frame.clear();
        self.noise_density = noise_density;
        self.coherence = Coherence::new();
    }

    /// Takes over the slip forces in N that were identified.
    pub(crate) fn set_slip_forces(&mut self, slip_force_n: [T; ELEMENTS]) {
        self.slip_force_n = slip_force_n;
    }

    /// Takes a grid step; gives the friction force in N, by which the wheel is held back.
    pub(crate) fn push(&mut self, sample: &GridSample<T>) -> T {
        if sample.after_gap {
            self.begin_again(sample.time_s);
        }
        let (body, wheel) = (sample.body_accel_m_s2, sample.wheel_accel_m_s2);
        let unit = self.slip.push(wheel - body, self.dt);
        self.spectra(sample, [body, wheel], unit);
        unit.iter().zip(&self.slip_force_n).fold(T::zero(), |sum, (&unit, &force)| sum + unit * force)
    }

    #[inline(never)]
    fn begin_again(&mut self, time_s: f64) {
        self.slip.restart();
        self.channels.iter_mut().for_each(Channel::restart);
        self.states = [[[T::zero(); 2]; 4]; SIGNALS];
        self.clock.restart();
        (self.begun, self.invalid_hops) = (false, SETTLING_HOPS);
        self.step = self.step_of(time_s);
    }

    /// Steps since the last multiple of the thinned period: all corners are thinned at the same times.
    fn step_of(&self, time_s: f64) -> u32 {
        let dt = self.dt.to_f64();
        let steps = remainder(time_s + 0.5 * dt, dt * f64::from(self.every)) / dt;
        (steps as u32).min(self.every - 1)
    }

    fn spectra(&mut self, sample: &GridSample<T>, [body, wheel]: [T; 2], unit: [T; ELEMENTS]) {
        self.steps = self.steps.saturating_add(1);
        let [body_channel, wheel_channel, elements @ ..] = &mut self.channels;
        let (dt, steps) = (self.dt, self.steps);
        let (body_velocity, body_acceleration, body_jerk) = body_channel.step(body, steps, dt);
        let (wheel_velocity, wheel_acceleration, wheel_jerk) = wheel_channel.step(wheel, steps, dt);
        let mut signals = [T::zero(); SIGNALS];
        signals[BODY] = body_jerk;
        signals[ACCELERATION] = wheel_acceleration - body_acceleration;
        signals[VELOCITY] = wheel_velocity - body_velocity;
        signals[WHEEL] = wheel_jerk;
        for ((signal, channel), unit) in signals[FRICTION..].iter_mut().zip(elements).zip(unit) {
            *signal = channel.step(unit, steps, dt).2;
        }
        for (signal, states) in signals.iter_mut().zip(&mut self.states) {
            for (section, state) in self.filters.iter().zip(states) {
                *signal = section.push(state, *signal);
            }
        }
        // A wheel in the air still moves its body as the strut says.
        if sample.invalid || sample.speed_m_s <= T::lit(STANDING_M_S) {
            self.invalid_hops = self.invalid_hops.max(2);
        }
        self.step += 1;
        if self.step < self.every {
            return;
        }
        self.step = 0;
        // Frames of all corners begin at multiples of the hop, whenever each of them last began.
        if !self.begun {
            let thinned_s = self.dt.to_f64() * f64::from(self.every);
            self.begun = remainder(sample.time_s + 0.5 * thinned_s, HOP_S) < thinned_s;
            if !self.begun {
                return;
            }
        }
        if let Some(spectra) = self.clock.push(&signals) {
            if self.invalid_hops > 0 {
                self.invalid_hops -= 1;
            } else {
                let both = core::array::from_fn(|bin| [BODY, WHEEL].map(|signal| spectra.at(bin, signal)));
                let noise = core::array::from_fn(|bin| {
                    let omega = T::two_pi() * T::lit((bin + 1) as f64 * BIN_SPACING_HZ);
                    omega * omega * self.noise_density
                });
                self.coherence.learn(&both, &noise, T::lit(HOP_S));
                self.frame.place(|frame| *frame = StrutFrame { time_s: sample.time_s, spectra });
            }
        }
    }

    /// The newest frame, while there is one.
    pub(crate) fn frame(&self) -> Option<&StrutFrame<T>> {
        self.frame.as_ref()
    }

    /// The sensors were out of order: what they have shown of late is forgotten.
    pub(crate) fn restart(&mut self) {
        self.coherence = Coherence::new();
        self.frame.clear();
    }

    /// Share of the body's motion that does not go with the wheel's, once enough was seen.
    pub(crate) fn incoherence(&self) -> Option<T> {
        (self.coherence.learned_s() >= T::lit(ENOUGH_S)).then(|| self.coherence.incoherence())
    }

    /// Number of independent averages that it rests on.
    pub(crate) fn averages(&self) -> T {
        self.coherence.averages()
    }
}

/// What of a time is left after whole periods.
fn remainder(time_s: f64, period_s: f64) -> f64 {
    let periods = time_s / period_s;
    (periods - (periods as i64) as f64) * period_s
}
