//! By how much the accelerations of a corner read too much, as the tooth pulses of its wheel tell (docs/math/two-witnesses.md, "One
//! corner and its pulses"). Asked by [`Estimator`](super::Estimator) alone: what moves fast is left to the accelerations.

use crate::conditioning::pauses::PAUSE_S;
use crate::memory::Blank;
use crate::model::OUTLIER_SD;
use crate::real::Real;
use crate::torsion::{TorsionChange, level_variance_kpa2};

/// Time in s over which the accelerations' reading is averaged: half a piece, so that both are of the same moment.
const RECENT_S: f64 = 15.0;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PulseLevel<T: Real> {
    /// The accelerations' reading lately, its variance, and for how long and until when it was averaged.
    recent_kpa: T,
    recent_kpa2: T,
    since_s: f64,
    last_s: f64,
    /// Sums over pieces: informations, and with them their deviations from what the accelerations read and their changes since the
    /// calibration.
    information: T,
    deviation: T,
    change: T,
}

impl<T: Real> PulseLevel<T> {
    /// Takes what the accelerations read at a time, and its variance without what the vehicle file leaves open.
    pub(super) fn read(&mut self, time_s: f64, kpa: T, variance_kpa2: T) {
        let step_s = time_s - self.last_s;
        self.last_s = time_s;
        let goes_on = (0.0..PAUSE_S).contains(&step_s) && self.since_s > 0.0;
        if !(goes_on && self.recent_kpa.is_finite() && self.recent_kpa2.is_finite()) {
            (self.recent_kpa, self.recent_kpa2, self.since_s) = (kpa, variance_kpa2, f64::MIN_POSITIVE);
            return;
        }
        self.since_s += step_s;
        let gain = T::lit(step_s / self.since_s.min(RECENT_S));
        self.recent_kpa += gain * (kpa - self.recent_kpa);
        self.recent_kpa2 += gain * (variance_kpa2 - self.recent_kpa2);
    }

    /// Takes what a piece tells of a tire that had `calibrated_kpa` when its pulses were calibrated, where the accelerations read `now_kpa`
    /// and their level is open by the variance `open_kpa2`.
    pub(super) fn take(&mut self, piece: &TorsionChange<T>, calibrated_kpa: T, now_kpa: T, open_kpa2: T) {
        let moved_kpa = now_kpa - self.recent_kpa;
        let noise = piece.change_sd_kpa * piece.change_sd_kpa + self.recent_kpa2 + moved_kpa * moved_kpa;
        let deviation = calibrated_kpa + piece.change_kpa - self.recent_kpa;
        let (expected, open) = self.excess(open_kpa2);
        let away = deviation - expected;
        let usual = away * away < T::lit(OUTLIER_SD * OUTLIER_SD) * (noise + open);
        if !(self.since_s >= RECENT_S && noise > T::zero() && usual) {
            return;
        }
        let information = T::one() / noise;
        self.information += information;
        self.deviation += information * deviation;
        self.change += information * piece.change_kpa;
    }

    /// Correction to the accelerations' reading in kPa, and the variance that their level still has then.
    pub(super) fn excess(&self, open_kpa2: T) -> (T, T) {
        if !(self.information > T::zero() && open_kpa2 > T::zero()) {
            return (T::zero(), open_kpa2);
        }
        let noise = level_variance_kpa2(self.change / self.information, self.information);
        let gain = open_kpa2 / (open_kpa2 + noise);
        (gain * self.deviation / self.information, gain * noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Two minutes of readings ten times a second, and a piece every half a minute.
    fn driven(read: impl Fn(f64) -> f64, piece: impl FnMut() -> f64, open_kpa2: f64) -> PulseLevel<f64> {
        let (mut level, mut piece) = (PulseLevel::BLANK, piece);
        for k in 0..=1200 {
            let time_s = 0.1 * f64::from(k);
            level.read(time_s, read(time_s), 36.0);
            if k > 0 && k % 300 == 0 {
                let change = TorsionChange { change_kpa: piece(), change_sd_kpa: 20.0 };
                level.take(&change, 240.0, read(time_s), open_kpa2);
            }
        }
        level
    }

    #[test]
    fn a_level_is_the_sum_of_informations() {
        // Sixteen kPa too high, which the file leaves open by 20 kPa.
        let (excess, left) = driven(|_| 256.0, || 0.0, 400.0).excess(400.0);
        let noise = (400.0 + 36.0) / 4.0 + 4.4 * 4.4 + 6.7 * 6.7;
        let variance: f64 = 1.0 / (1.0 / 400.0 + 1.0 / noise);
        assert!(
            (left - variance).abs() < 1e-9 && (excess + 16.0 * variance / noise).abs() < 1e-9,
            "{excess}"
        );
        // Where the file leaves nothing open, where there was no piece, and where no piece is that far away: nothing.
        assert_eq!(driven(|_| 256.0, || 0.0, 400.0).excess(0.0), (0.0, 0.0));
        assert_eq!(PulseLevel::<f64>::BLANK.excess(400.0), (0.0, 400.0));
        assert_eq!(driven(|_| 256.0, || -150.0, 400.0).excess(400.0), (0.0, 400.0));
        // A reading that is no number is forgotten.
        let broken = |time_s: f64| if (40.0..50.0).contains(&time_s) { f64::NAN } else { 256.0 };
        assert!(driven(broken, || 0.0, 400.0).excess(400.0).0 < -9.0);
    }

    #[test]
    fn a_pressure_that_moves_teaches_less_and_nothing_wrong() {
        // A fifth lost within 20 s, from 50 s on; pieces are of the mean of their half minute: a triangle of 10 s and 24 kPa in the second,
        // all but another one of it in the third.
        let pressure = |time_s: f64| 240.0 - 48.0 * ((time_s - 50.0) / 20.0).clamp(0.0, 1.0);
        let mut pieces = [0.0, -4.0, -44.0, -48.0].into_iter();
        let (excess, left) = driven(pressure, || pieces.next().unwrap(), 400.0).excess(400.0);
        // Two means of a fall that differ by some kPa, and count for less.
        assert!(excess.abs() < 2.0 && left > 90.0, "{excess} {left}");
    }

    /// Levels and pulses as they are believed to be: the sd is that of the errors.
    #[test]
    fn its_sd_is_that_of_its_errors() {
        let mut random = Random(3);
        let (mut within, mut square, mut stated) = (0, 0.0, 0.0);
        const DRAWS: usize = 2000;
        for _ in 0..DRAWS {
            let too_much = 20.0 * random.normal();
            // Of load, slip stiffness, road, rubber, and what the accelerations read too much in these minutes.
            let common = 4.4f64.hypot(6.7) * random.normal();
            let piece = || common + (20f64.powi(2) + 36.0).sqrt() * random.normal();
            let (excess, left) = driven(|_| 240.0 + too_much, piece, 400.0).excess(400.0);
            let off = excess + too_much;
            within += usize::from(off * off < 1.96f64.powi(2) * left);
            (square, stated) = (square + off * off, stated + left);
        }
        let share = within as f64 / DRAWS as f64;
        // 1 % is two of its standard deviations, and as much for changes that are read and not lost.
        assert!((0.93..=0.97).contains(&share), "{share}");
        assert!((square / stated - 1.0).abs() < 0.1, "{}", square / stated);
    }
}
