//! The measurement that a frame of both axles gives the belief, and what the pair learns from it (docs/math/shared-road.md).

use nalgebra::SVector;

use super::{AxlePair, Measured, NOT_SHARED};
use crate::belief::measurement::{BINS, SideMeasurement, UpdateRecord};
use crate::belief::state::{SideReading, State, read_compliance};
use crate::inter_axle::residual::model::{AxleFrame, UnitRoad, Wheel, common_road, instrument_slope};
use crate::inter_axle::residual::noise::{MOST_LASTING, POWER_S, fading};
use crate::inter_axle::{HOP_S, NEAR_HOP_BINS, bin_hz};
use crate::memory::Blank;
use crate::real::Real;
use crate::spectrum::COHERENCE_S;
use crate::spectrum::transfer::{DescribingFunction, response};

/// Parts in which the expected products are computed where none is known: a bin each.
pub(crate) const PRODUCT_PARTS: usize = BINS;
/// Pseudo-measurements of a side's spectra without a frame between them, after which the side is left to pseudo-measurements: some five seconds of both
/// corners, nine of one.
const MOST_SPECTRAL_UPDATES: u32 = 12;
/// Power near wheel hop over that of the sensors' noise there at which frames begin to count; at twice this they count
/// fully. Two axles whose sensors show nothing but noise agree on a road, too. The smoothest road there is has some hundred.
const SNR_FULL: f64 = 25.0;

impl<T: Real> AxlePair<T> {
    /// Computes the expected products of a bin where they are not known, and in the first of a frame's parts in any case; that forgets all of them
    /// if the last frame was long ago. False if there was nothing to compute.
    #[inline(never)]
    pub(crate) fn prepare(
        &mut self,
        frame: &AxleFrame<T>,
        wheels: &[Wheel<T>; 2],
        state: &State<T>,
        part: usize,
    ) -> bool {
        if part == 0 && !(frame.middle_s - self.learned_until_s < COHERENCE_S) {
            self.products.forget();
            self.coherence.restart();
        }
        let is_due = part == 0 || self.products.missing > 0;
        if is_due {
            let frf_ratios = self.frf_correction.frf_ratios();
            let road = UnitRoad::new(wheels, self.side, state, &frf_ratios);
            self.products.advance(|bin| road.expected_products(bin));
        }
        is_due
    }

    /// What a frame is worth to a belief whose most likely state this is, into `out`; `None` if the road does not stand out of the sensors'
    /// noise. `meanwhile`: the other side's incoherence, if only that side had frames of late.
    #[inline(never)]
    pub(crate) fn measure(
        &mut self,
        frame: &AxleFrame<T>,
        wheels: &[Wheel<T>; 2],
        state: &State<T>,
        meanwhile: Option<SVector<T, BINS>>,
        out: &mut Measured<T>,
    ) -> Option<()> {
        if let Some(other) = meanwhile {
            self.coherence.follow(&other);
        }
        self.spectral_updates = 0;
        let side = self.side;
        let (common, road_power) = common_road(frame, wheels, side, state);
        let noise = self.noise(wheels, state);
        self.track_snr(&road_power, &noise);
        if !(self.snr_weight() > T::zero()) {
            return None;
        }
        let frf_ratios = self.frf_correction.frf_ratios();
        (out.common, out.noise) = (common, noise);
        let SideMeasurement { reading, expected, instrument, weight, incoherent_s } = &mut out.measurement;
        *reading = SideReading { side, delay_s: frame.delay_s };
        *expected = self.coherence.expect(&road_power, &noise, self.products.of_all_bins());
        *instrument = instrument_slope(frame, &frf_ratios, wheels, side, state);
        let counted = if self.on_line.contains(&true) { T::zero() } else { self.snr_weight() };
        *weight = self.coherence.weight() * frame.frame.seen * counted;
        *incoherent_s = self.fading() * T::lit(HOP_S);
        Some(())
    }

    /// Learns from what the belief made of a frame; true if the road was shared. `opposite_parts`: the other side's roads seem
    /// to part.
    pub(crate) fn learn(
        &mut self,
        frame: &AxleFrame<T>,
        measured: &Measured<T>,
        record: &UpdateRecord<T>,
        opposite_parts: bool,
    ) -> bool {
        self.frf_correction.learn(&frame.frame, &measured.common, record.weight);
        let Measured { measurement, noise, .. } = measured;
        self.coherence.learn(&measurement.expected, record, noise, T::lit(HOP_S), opposite_parts);
        self.hop_excess.take(&self.coherence.incoherence(), T::lit(HOP_S));
        self.learned_until_s = frame.middle_s;
        self.coherence.near_wheel_hop() < T::lit(NOT_SHARED)
    }

    /// Takes a frame's road power and the sensors' noise in the axles' residual, per bin.
    fn track_snr(&mut self, road_power: &[T; BINS], noise: &[T; BINS]) {
        let [low, high] = NEAR_HOP_BINS;
        let ratio = (T::lit(0.5) * (road_power[low] / noise[low] + road_power[high] / noise[high])).ln();
        let gain = T::one() - (T::lit(-HOP_S / POWER_S)).exp();
        let before = self.log_snr.filter(|before| before.is_finite()).unwrap_or(ratio);
        self.log_snr = Some(before + gain * (ratio - before));
    }

    /// How far the road stands out of the sensors' noise, 0 to 1; fully where no frame says so.
    pub(crate) fn snr_weight(&self) -> T {
        let over = |log_snr: T| (log_snr.exp_fast() / T::lit(SNR_FULL) - T::one()).clamp(T::zero(), T::one());
        self.log_snr.filter(|_| !self.spectral_only()).map_or(T::one(), over)
    }

    /// Notes a pseudo-measurement of a corner's spectrum.
    pub(crate) fn note_spectral_update(&mut self) {
        self.spectral_updates = self.spectral_updates.saturating_add(1);
    }

    /// Whether pseudo-measurements come and frames do not, as without an axle's sensors, or the speed.
    pub(crate) fn spectral_only(&self) -> bool {
        self.spectral_updates > MOST_SPECTRAL_UPDATES
    }

    /// How fast the belief fades; left to pseudo-measurements, as where the axles share least for long.
    pub(crate) fn fading(&self) -> T {
        if self.spectral_only() { fading(T::lit(MOST_LASTING)) } else { self.coherence.fading() }
    }

    /// Sensor noise in the axles' residual, per bin.
    fn noise(&self, wheels: &[Wheel<T>; 2], state: &State<T>) -> [T; BINS] {
        core::array::from_fn(|bin| {
            let mut sum = T::zero();
            for (wheel, &density) in wheels.iter().zip(&self.noise_density) {
                let theta = wheel.theta * read_compliance(state, wheel.corner);
                let [(_, noise)] = response(&wheel.body, &DescribingFunction::BLANK, [theta], bin_hz(bin));
                sum += density * noise;
            }
            sum
        })
    }
}
