//! One corner's strut: its friction force, sample by sample, and short spectra of all that appears in the body's equation of motion.

use super::coherence::Coherence;
use super::maxwell_slip::MaxwellSlip;
use crate::conditioning::{GridSample, STANDING_M_S, THINNED_HZ};
use crate::memory::{Blank, Placed};
use crate::real::Real;
use crate::spectrum::front_end::{ELEMENTS, FrontEnd, Signals};
use crate::spectrum::reconstruction::{
    BODY_JERK, RELATIVE_ACCELERATION, RELATIVE_VELOCITY, SIGNALS as MOTION, WHEEL_JERK,
};
use crate::spectrum::transfer::{FRICTION_BINS, FRICTION_SPACING_HZ};
use crate::spectrum::{Frame, FrameClock};

/// Bins of a frame: 2.5, 5, ... 25 Hz; nominal time between frames in s.
pub(super) const BINS: usize = FRICTION_BINS;
pub(super) const HOP_S: f64 = 0.5 / FRICTION_SPACING_HZ;
/// Hops until the filters have forgotten that they began at rest.
const SETTLING_HOPS: u32 = 2;

/// Seconds of frames before coherence and friction are reported: ten independent ones.
pub(super) const ENOUGH_S: f64 = 4.0;

/// Signals of a frame: jerk of the body, relative acceleration and velocity, rates of the elements' forces, jerk of the wheel.
pub(super) const BODY: usize = 0;
pub(super) const ACCELERATION: usize = 1;
pub(super) const VELOCITY: usize = 2;
pub(super) const FRICTION: usize = 3;
pub(super) const WHEEL: usize = FRICTION + ELEMENTS;
const SIGNALS: usize = WHEEL + 1;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StrutFrame<T: Real> {
    pub(crate) time_s: f64,
    pub(super) spectra: Frame<T, BINS, SIGNALS>,
}

impl<T: Real> StrutFrame<T> {
    /// Power of the deflection's rate, all bins together.
    pub(super) fn deflection_power(&self) -> T {
        (0..BINS).fold(T::zero(), |sum, bin| sum + self.spectra.at(bin, VELOCITY).norm_sqr())
    }
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Strut<T: Real> {
    /// Slip forces in N of the elements, as identified.
    slip_force_n: [T; ELEMENTS],
    slip: MaxwellSlip<T>,
    front_end: FrontEnd<T>,
    /// Unsprung and sprung mass in kg.
    masses_kg: [T; 2],
    dt: T,
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

impl<T: Real> Strut<T> {
    /// For grid steps of this period, unsprung and sprung mass in kg, and sensors of this noise density in (m/s²)²/Hz; whatever was there is
    /// forgotten.
    #[inline(never)]
    pub(crate) fn configure(&mut self, grid_period_s: f64, masses_kg: [T; 2], noise_density: T) {
        let every = ((1.0 / grid_period_s / THINNED_HZ + 1e-9) as u32).max(1);
        self.slip_force_n = [T::zero(); ELEMENTS];
        self.slip = MaxwellSlip::BLANK;
        self.front_end = FrontEnd::new(grid_period_s);
        (self.masses_kg, self.dt) = (masses_kg, T::lit(grid_period_s));
        (self.every, self.step) = (every, 0);
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

    /// Takes a grid step; gives the corner's signals without the friction that was identified, as they are and of the band.
    pub(crate) fn push(&mut self, sample: &GridSample<T>) -> [[T; MOTION]; 2] {
        if sample.after_gap {
            self.begin_again(sample.time_s);
        }
        let (slip, dt) = (&mut self.slip, self.dt);
        let [all, band] = self.front_end.push(sample, |relative_accel| slip.push(relative_accel, dt));
        self.spectra(sample, &band);
        [all, band].map(|signals| signals.without_friction(&self.slip_force_n, self.masses_kg))
    }

    #[inline(never)]
    fn begin_again(&mut self, time_s: f64) {
        self.slip = MaxwellSlip::BLANK;
        self.front_end.restart();
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

    fn spectra(&mut self, sample: &GridSample<T>, band: &Signals<T>) {
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
        let mut signals = [T::zero(); SIGNALS];
        for (at, motion) in [
            (BODY, BODY_JERK),
            (ACCELERATION, RELATIVE_ACCELERATION),
            (VELOCITY, RELATIVE_VELOCITY),
            (WHEEL, WHEEL_JERK),
        ] {
            signals[at] = band.motion[motion];
        }
        signals[FRICTION..WHEEL].copy_from_slice(&band.friction);
        if let Some(spectra) = self.clock.push(&signals) {
            if self.invalid_hops > 0 {
                self.invalid_hops -= 1;
            } else {
                let both = core::array::from_fn(|bin| [BODY, WHEEL].map(|signal| spectra.at(bin, signal)));
                let noise = core::array::from_fn(|bin| {
                    let omega = T::two_pi() * T::lit((bin + 1) as f64 * FRICTION_SPACING_HZ);
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

    /// The sensors were out of order: what they have shown is forgotten, their offsets included.
    pub(crate) fn restart(&mut self) {
        self.front_end = FrontEnd::new(self.dt.to_f64());
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

/// Remainder of a time after whole periods.
fn remainder(time_s: f64, period_s: f64) -> f64 {
    let periods = time_s / period_s;
    (periods - (periods as i64) as f64) * period_s
}
