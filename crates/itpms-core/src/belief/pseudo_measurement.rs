//! Words: what the spectrum of the road under a corner says of its tire (docs/math/shared-road.md, section 6).

use crate::belief::state::{COMMON_BIAS, OWN_BIAS};
use crate::inter_axle::{LONGEST_SILENCE_S, LONGEST_STEP_S, SharedRoad};
use crate::real::Real;

/// Speed in m/s from which a word of the spectrum is heard.
const SLOWEST_WORD_M_S: f64 = 4.0;
/// Logarithm of the speed over that of late at which a word counts half: a spectrum that changes while it is looked at says little.
const CHANGING: f64 = 0.15;
/// Front and rear of a side see the same road, so their spectra say half of what they seem to.
const SAME_ROAD: f64 = 2.0;

impl<T: Real> SharedRoad<T> {
    /// Whether the road under a corner is heard over its sensors' noise, as far as the axles tell.
    pub(crate) fn hears(&self, corner: usize) -> bool {
        self.pairs[corner % 2].snr_weight() > T::zero()
    }

    /// Whether the car is too slow for words of the spectrum; not where nobody knows.
    pub(crate) fn is_slow(&self) -> bool {
        self.speed_m_s < T::lit(SLOWEST_WORD_M_S)
    }

    /// A word of a corner's road spectrum: its stiffness and sd in N/m, at a time. Where the speed is unknown the corner has
    /// seen to it that nothing changes.
    pub(crate) fn update_reweighted(
        &mut self,
        corner: usize,
        time_s: f64,
        stiffness_n_per_m: T,
        sd_n_per_m: T,
    ) {
        let speed = Some(self.speed_m_s).filter(|speed| speed.is_finite());
        let changing = speed.map_or(T::zero(), |speed| (speed / self.mean_speed_m_s).ln() / T::lit(CHANGING));
        let variance = T::lit(SAME_ROAD) * sd_n_per_m * sd_n_per_m * (T::one() + changing * changing);
        if !self.hears(corner) || self.is_slow() {
            return;
        }
        self.pairs[corner % 2].update_reweighted();
        if self.spectral_only() || !(time_s - self.believed_s < LONGEST_STEP_S) {
            self.predict_to(time_s);
        }
        let since_s = (time_s - self.word_s[corner]).clamp(0.0, LONGEST_SILENCE_S);
        self.word_s[corner] = time_s;
        let track = &self.pairs[corner % 2];
        if track.spectral_only() {
            self.bank.inflate(corner, track.fading() * T::lit(since_s), self.calibrated);
        }
        if !variance.is_finite() {
            return;
        }
        self.bank.update_reweighted(variance, |state| {
            let (expected, slope) = self.scale.word(corner, state);
            (slope, stiffness_n_per_m - expected)
        });
    }

    /// How much too stiff a corner's road spectrum reads, in N/m, and the variance of that.
    pub(crate) fn pseudo_measurement_bias(&self, corner: usize) -> (T, T) {
        let unit = self.scale.pressures_part_n_per_m(corner);
        let (common, own) = (self.bank.quantity(COMMON_BIAS), self.bank.quantity(OWN_BIAS + corner));
        (unit * (common.0 + own.0), unit * unit * (common.1 + own.1))
    }

    /// What a corner's road spectrum is expected to say: stiffness and sd in N/m.
    pub(crate) fn expected_pseudo_measurement(&self, corner: usize) -> (T, T) {
        let hypothesis = &self.bank.bank[self.bank.most_likely()];
        let (expected, slope) = self.scale.word(corner, &hypothesis.mean);
        (expected, slope.dot(&(hypothesis.covariance * slope)).max(T::zero()).sqrt())
    }
}
