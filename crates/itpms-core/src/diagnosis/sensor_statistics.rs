//! One accelerometer by itself: does it move, does it come, does it jump, how loud is it between the road's waves.

use crate::diagnosis::Tuning;
use crate::memory::Blank;
use crate::model::ABSURD_M_S2;
use crate::real::Real;

/// Values around a spike that are looked at; the one in the middle is judged.
const WINDOW: usize = 9;
const MIDDLE: usize = WINDOW / 2;
/// Sum of squares of the fourth difference's weights 1, -4, 6, -4, 1.
const FOURTH_DIFFERENCE: f64 = 70.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SensorBlock<T> {
    /// Power in (m/s²)² per sample of white noise with the fourth differences of the block's quietest part; `None` when no part was whole.
    pub(crate) floor: Option<T>,
    pub(crate) missing: T,
    pub(crate) spikes: u32,
    /// For how long the value has not changed, in s.
    pub(crate) unchanged_s: f64,
    pub(crate) complete: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SensorWatch<T> {
    /// Newest last.
    window: [T; WINDOW],
    /// Values since the last missing one, up to the window's length.
    whole: u32,
    /// How far values of late were from what their neighbors say, in m/s², infinite before that is known; and those too new to count, newest
    /// last.
    usual: T,
    deviations: [T; MIDDLE + 1],
    missing: T,
    changed_s: f64,
    spikes: u32,
    lost: u32,
    /// Power of the fourth differences in the part that runs, its values, and the quietest part of the block.
    part: T,
    in_part: u32,
    part_of: u32,
    floor: Option<T>,
    /// Weight of a value in the usual level and in the share of missing ones.
    usual_share: T,
    missing_share: T,
}

impl<T: Real> SensorWatch<T> {
    pub(crate) fn new(period_s: f64, tuning: &Tuning) -> Self {
        Self {
            usual: T::lit(f64::INFINITY),
            deviations: [T::lit(f64::NAN); MIDDLE + 1],
            changed_s: f64::NAN,
            part_of: ((tuning.noise_part_s / period_s) as u32).max(5),
            usual_share: T::lit((period_s / tuning.spike_usual_s).min(1.0)),
            missing_share: T::lit((period_s / tuning.missing_s).min(1.0)),
            ..Self::BLANK
        }
    }

    /// Takes a value; gives it, or the last one in the place of a missing one. `spike`: the least deviation of one in m/s², and over the usual one.
    pub(crate) fn push(&mut self, time_s: f64, value: T, spike: [T; 2]) -> T {
        let here = value.abs() < T::lit(ABSURD_M_S2);
        let lost = if here { T::zero() } else { T::one() };
        self.missing += self.missing_share * (lost - self.missing);
        if !here {
            self.lost += 1;
            self.whole = 0;
            return self.window[WINDOW - 1];
        }
        if value != self.window[WINDOW - 1] || self.changed_s.is_nan() {
            self.changed_s = time_s;
        }
        let [_, a, b, c, d, e, f, g, h] = self.window;
        self.window = [a, b, c, d, e, f, g, h, value];
        self.whole = (self.whole + 1).min(WINDOW as u32);
        if self.whole == WINDOW as u32 {
            self.look_for_spike(spike);
            self.listen();
        }
        value
    }

    /// The next value does not follow the last one.
    pub(crate) fn interrupted(&mut self) {
        self.whole = 0;
    }

    /// Interpolates the middle of the window from its neighbors, sixth order.
    fn look_for_spike(&mut self, [least_m_s2, over_usual]: [T; 2]) {
        let [_, a, b, c, value, d, e, f, _] = self.window;
        let expected = (T::lit(15.0) * (c + d) - T::lit(6.0) * (b + e) + a + f) / T::lit(20.0);
        let deviation = (value - expected).abs();
        let over = (over_usual * self.usual).at_least(least_m_s2);
        // Where the neighbors themselves go so far within six samples, the wheel has met an edge.
        let neighbors = [b, c, d, e, f];
        let [least, most] =
            neighbors.iter().fold([a; 2], |[least, most], &of| [least.at_most(of), most.at_least(of)]);
        self.spikes += u32::from(deviation > over.at_least(most - least));
        let oldest = self.deviations[0];
        if self.usual.is_finite() {
            self.usual += self.usual_share * (oldest - self.usual);
        } else if oldest.is_finite() {
            self.usual = self.deviations.iter().copied().fold(T::zero(), T::at_least);
        }
        let [_, a, b, c, d] = self.deviations;
        self.deviations = [a, b, c, d, deviation];
    }

    /// Adds the newest fourth difference to the part that runs.
    fn listen(&mut self) {
        let fourth = fourth_difference(&self.window[WINDOW - 5..]);
        self.part += fourth * fourth / T::lit(FOURTH_DIFFERENCE);
        self.in_part += 1;
        if self.in_part == self.part_of {
            let power = self.part / T::whole(self.part_of);
            self.floor = Some(self.floor.map_or(power, |floor| floor.min(power)));
            (self.part, self.in_part) = (T::zero(), 0);
        }
    }

    /// For how long the value has not changed, in s; NaN before the first one.
    pub(crate) fn unchanged_s(&self, time_s: f64) -> f64 {
        time_s - self.changed_s
    }

    pub(crate) fn end_block(&mut self, time_s: f64) -> SensorBlock<T> {
        let block = SensorBlock {
            floor: self.floor,
            missing: self.missing,
            spikes: self.spikes,
            unchanged_s: self.unchanged_s(time_s),
            complete: self.lost == 0,
        };
        (self.spikes, self.lost, self.floor) = (0, 0, None);
        block
    }
}

fn fourth_difference<T: Real>(w: &[T]) -> T {
    w[0] + w[4] + T::lit(6.0) * w[2] - T::lit(4.0) * (w[1] + w[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPIKE: [f64; 2] = [Tuning::DEFAULT.spike_m_s2, Tuning::DEFAULT.spike_over_usual];
    const PERIOD_S: f64 = 0.005;

    /// A wheel on a road: waves of some frequencies up to 50 Hz, at 200 Hz.
    fn ride(i: u32) -> f64 {
        let t = f64::from(i) * PERIOD_S;
        [(1.3, 0.8), (7.7, 2.0), (12.3, 5.0), (31.0, 1.5), (49.0, 0.5)]
            .iter()
            .map(|(hz, size)| size * (core::f64::consts::TAU * hz * t + hz).sin())
            .sum()
    }

    fn watch(values: impl Iterator<Item = f64>) -> SensorBlock<f64> {
        let mut watch = SensorWatch::new(PERIOD_S, &Tuning::DEFAULT);
        let mut time_s = 0.0;
        for value in values {
            time_s += PERIOD_S;
            watch.push(time_s, value, SPIKE);
        }
        watch.end_block(time_s)
    }

    #[test]
    fn every_spike_is_seen_and_no_wave_is_one() {
        assert_eq!(watch((0..4000).map(ride)).spikes, 0);
        let spiky = |i: u32| ride(i) + if i % 100 == 50 { 30.0 } else { 0.0 };
        assert_eq!(watch((0..4000).map(spiky)).spikes, 40);
        // A step, as of a bias that jumps, is none.
        assert_eq!(watch((0..4000).map(|i| ride(i) + if i > 2000 { 20.0 } else { 0.0 })).spikes, 0);
    }

    /// A joint of slabs as a wheel of another simulation meets it at 25 m/s (250 Hz, smooth road), every half second.
    #[test]
    fn an_edge_is_no_spike() {
        const JOINT: [f64; 14] = [-0.7, 0.6, 0.9, 0.2, -1.0, -3.0, -8.8, 3.9, 9.1, 6.5, 3.1, 0.4, -1.0, -0.6];
        let joint = |i: u32| JOINT.get((i % 125) as usize).copied().unwrap_or(0.0);
        assert_eq!(watch((0..4000).map(|i| 0.05 * ride(i) + joint(i))).spikes, 0);
    }

    /// From the first value on.
    #[test]
    fn a_sensor_that_is_noisy_has_no_spikes() {
        for seed in 1..200_u32 {
            let mut state = seed;
            let mut uniform = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(state >> 8) / f64::from(1 << 24)
            };
            let mut noise = || 0.5 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0);
            assert!(watch((0..200).map(|i| 0.1 * ride(i) + noise())).spikes <= 1, "{seed}");
        }
    }

    /// A wheel that drops into a hole every two seconds, at 1 kHz, and the log has lost a sample of each flank, said or not; the next one is 0.4 ms late.
    #[test]
    fn a_flank_with_a_lost_sample_is_no_spike() {
        let hole = |i: u32| {
            let late = if i % 2000 == 1001 { 0.4 } else { 0.0 };
            -60.0 / (1.0 + ((f64::from(i % 2000) + late - 1000.0) / 2.0).exp())
        };
        let spikes = |interrupted: bool| {
            let mut watch = SensorWatch::new(1e-3, &Tuning::DEFAULT);
            for i in (0..20_000).filter(|i| i % 2000 != 1000) {
                if interrupted && i % 2000 == 1001 {
                    watch.interrupted();
                }
                watch.push(1e-3 * f64::from(i), hole(i) + 0.1 * ride(i), SPIKE);
            }
            watch.end_block(20.0).spikes
        };
        assert_eq!([spikes(false), spikes(true)], [0; 2]);
    }

    #[test]
    fn the_floor_is_the_noise_and_a_pothole_does_not_lift_it() {
        // Alternating 0.3 is a wave at half the rate: its fourth difference is 16 times as large, of power 256.
        let quiet = |i: u32| if i.is_multiple_of(2) { 0.3 } else { -0.3 };
        let expected = 0.09 * 256.0 / FOURTH_DIFFERENCE;
        let pothole = |i: u32| quiet(i) + if (40..46).contains(&i) { 80.0 } else { 0.0 };
        assert!((watch((0..100).map(pothole)).floor.unwrap() / expected - 1.0).abs() < 1e-9);
        assert_eq!(watch((0..3).map(quiet)).floor, None);
    }

    #[test]
    fn missing_and_unchanged_values_are_reported() {
        let torn = watch((0..2000u32).map(|i| if i.is_multiple_of(2) { f64::NAN } else { ride(i) }));
        assert!((torn.missing - 0.5).abs() < 0.01 && !torn.complete);
        let stuck = watch((0..2000).map(|i| ride(i.min(1799))));
        assert!((stuck.unchanged_s - 1.0).abs() < 1e-9 && stuck.complete);
        assert!(watch(core::iter::repeat_n(f64::INFINITY, 100)).missing > 0.3);
    }
}
