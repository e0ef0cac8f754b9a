//! Pseudo-measurements: its tire's stiffness by the spectrum of the road under a corner (docs/math/shared-road.md, section 6).

use super::Fusion;
use crate::belief::LONGEST_SILENCE_S;
use crate::belief::state::SPECTRUM_BIAS;
use crate::conditioning::pauses::PAUSE_S;
use crate::model::Corner;
use crate::real::Real;
use crate::suspension::MEMORY_S;

/// Speed in m/s from which a spectrum counts.
const SLOWEST_M_S: f64 = 4.0;
/// Logarithm of the speed over its mean at which a pseudo-measurement counts half: a spectrum that changes while it is taken has little information.
const CHANGING: f64 = 0.15;
/// Seconds between two pseudo-measurements of a corner.
const EVERY_S: f64 = 0.72;
/// Front and rear of a side see the same road, so half of their spectra's information counts.
const SAME_ROAD: f64 = 2.0;

impl<T: Real> Fusion<T> {
    /// Whether the road under a corner stands out of its sensors' noise, as far as the axles tell.
    pub(in crate::car) fn has_signal(&self, corner: Corner) -> bool {
        self.inter_axle.pairs[corner.side()].snr_weight() > T::zero()
    }

    /// Whether the car is too slow for spectra; not where the speed is unknown.
    pub(in crate::car) fn is_slow(&self) -> bool {
        self.inter_axle.travel().speed_m_s() < T::lit(SLOWEST_M_S)
    }

    /// Updates with the stiffness and its sd in N/m by a corner's road spectrum at a time. Where the speed is unknown
    /// the corner has seen to it that nothing changes.
    #[inline(never)]
    pub(in crate::car) fn update_spectral(
        &mut self,
        corner: Corner,
        time_s: f64,
        stiffness_n_per_m: T,
        sd_n_per_m: T,
    ) {
        let travel = self.inter_axle.travel();
        let speed = Some(travel.speed_m_s()).filter(|speed| speed.is_finite());
        let changing =
            speed.map_or(T::zero(), |speed| (speed / travel.mean_speed_m_s()).ln() / T::lit(CHANGING));
        // Friction is wrong alike for as long as it is remembered: all pseudo-measurements of that time together tell no more than that.
        let alike = T::lit(MEMORY_S / EVERY_S) * self.friction_variance[corner];
        let variance = T::lit(SAME_ROAD) * sd_n_per_m * sd_n_per_m * (T::one() + changing * changing) + alike;
        if !self.has_signal(corner) || self.is_slow() {
            return;
        }
        self.inter_axle.pairs[corner.side()].note_spectral_update();
        if self.belief.is_calibrating() {
            let scale = self.belief.scale();
            let per_kpa = T::one() / scale.slope[corner];
            let excess_kpa = (stiffness_n_per_m - scale.placard_n_per_m[corner]) * per_kpa;
            self.calibration_reading.take(corner, excess_kpa, variance * per_kpa * per_kpa);
        }
        if self.inter_axle.spectral_only() || !(time_s - self.belief.time_s() < PAUSE_S) {
            let onset = self.onset();
            self.belief.predict(time_s, &onset);
        }
        let since_s = (time_s - self.pseudo_measured_s[corner]).clamp(0.0, LONGEST_SILENCE_S);
        self.pseudo_measured_s[corner] = time_s;
        let pair = &self.inter_axle.pairs[corner.side()];
        if pair.spectral_only() {
            self.belief.inflate_tire(corner, pair.fading() * T::lit(since_s));
        }
        if !variance.is_finite() {
            return;
        }
        let scale = self.belief.scale().clone();
        self.belief.update_reweighted(corner.side(), variance, |state| {
            let (expected, slope) = scale.spectral_stiffness(corner, state);
            (slope, stiffness_n_per_m - expected)
        });
    }

    /// How much too stiff a corner's road spectrum reads, in N/m, and the variance of that.
    pub(super) fn spectral_bias(&self, corner: Corner) -> (T, T) {
        let unit = self.belief.scale().pressures_part_n_per_m(corner);
        let (bias, variance) = self.belief.quantity(SPECTRUM_BIAS + corner.index());
        (unit * bias, unit * unit * variance)
    }

    /// Expected measurement by a corner's road spectrum: stiffness and sd in N/m.
    pub(in crate::car) fn expected_spectral(&self, corner: Corner) -> (T, T) {
        let hypothesis = self.belief.most_likely();
        let (expected, slope) = self.belief.scale().spectral_stiffness(corner, &hypothesis.mean);
        (expected, slope.dot(&hypothesis.spread(&slope)).max(T::zero()).sqrt())
    }
}
