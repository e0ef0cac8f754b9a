//! What wanders about a mean and forgets itself, and what a rough road does to a wheel's load.
//!
//! Called by the run, message by message.

use std::f64::consts::TAU;

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::road::{AfterLast, RoadClass, RoadSpec, Roughness, Surface};

pub(crate) fn normal(random: &mut Pcg64) -> f64 {
    StandardNormal.sample(random)
}

/// An Ornstein-Uhlenbeck process over time or way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wander {
    pub(crate) value: f64,
    sd: f64,
    length: f64,
}

impl Wander {
    pub(crate) fn new(sd: f64, length: f64, random: &mut Pcg64) -> Self {
        Self { value: sd * normal(random), sd, length }
    }

    /// Goes on by a small part of its length.
    pub(crate) fn step(&mut self, by: f64, random: &mut Pcg64) -> f64 {
        if by > 0.0 && self.sd > 0.0 {
            let kept = (-by / self.length).exp();
            self.value = kept * self.value + self.sd * (1.0 - kept * kept).sqrt() * normal(random);
        }
        self.value
    }
}

/// The load of a wheel that a mass on a spring shakes, of unit variance: a damped oscillator in steps, differenced, for a slow
/// wave of the road lifts wheel and car alike.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shaken {
    first: f64,
    second: f64,
    gain: f64,
    before: [f64; 2],
}

impl Shaken {
    pub(crate) fn new(hz: f64, damping: f64, step_s: f64) -> Self {
        let omega = TAU * hz * step_s;
        let kept = (-damping * omega).exp();
        let (first, second) = (2.0 * kept * (omega * (1.0 - damping * damping).sqrt()).cos(), -kept * kept);
        // Yule and Walker: variance for white noise of one, and correlation of neighbors.
        let next = first / (1.0 - second);
        let variance = 1.0 / (1.0 - first * next - second * (first * next + second));
        Self { first, second, gain: 1.0 / (2.0 * variance * (1.0 - next)).sqrt(), before: [0.0; 2] }
    }

    pub(crate) fn step(&mut self, random: &mut Pcg64) -> f64 {
        let [last, before] = self.before;
        let now = self.first * last + self.second * before + normal(random);
        self.before = [now, last];
        self.gain * (now - last)
    }
}

/// How rough the road is along the way: its amplitude over that of class B.
#[derive(Debug, Clone)]
pub(crate) struct Rough {
    /// Where each stretch ends in m, and its amplitude.
    stretches: Vec<[f64; 2]>,
    repeats: bool,
}

impl Rough {
    pub(crate) fn new(road: &RoadSpec) -> Self {
        let over_b =
            |roughness: Roughness| (roughness.gd_n0_m3() / Roughness::from(RoadClass::B).gd_n0_m3()).sqrt();
        let constant = |amplitude: f64| (vec![[f64::INFINITY, amplitude]], false);
        let (stretches, repeats) = match &road.surface {
            Surface::Flat => constant(0.0),
            Surface::Iso8608(iso) => constant(over_b(iso.roughness)),
            Surface::Segments(segments) => {
                let mut end_m = 0.0;
                let stretch = |segment: &crate::road::Segment| {
                    end_m += segment.length_m;
                    [end_m, over_b(segment.roughness)]
                };
                (segments.list.iter().map(stretch).collect(), segments.after_last == AfterLast::Repeat)
            }
            // Of a surveyed or played one only that it is a road.
            Surface::Bench(_) | Surface::Profile(_) | Surface::Journey => constant(1.0),
        };
        Self { stretches, repeats }
    }

    pub(crate) fn amplitude(&self, distance_m: f64) -> f64 {
        let Some(&[length_m, last]) = self.stretches.last() else { return 0.0 };
        let at_m = if self.repeats { distance_m.rem_euclid(length_m) } else { distance_m };
        let next = self.stretches.partition_point(|[end_m, _]| *end_m <= at_m);
        self.stretches.get(next).map_or(last, |[_, amplitude]| *amplitude)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{Segment, Segments};
    use crate::streams::{Purpose, generator};

    #[test]
    fn what_wanders_has_its_spread_and_its_memory() {
        let mut random = generator(1, Purpose::WheelSpeeds, [0, 0]);
        let mut wander = Wander::new(2.0, 10.0, &mut random);
        let values: Vec<f64> = (0..200_000).map(|_| wander.step(1.0, &mut random)).collect();
        let mean_of = |of: &dyn Fn(usize) -> f64| (0..199_990).map(of).sum::<f64>() / 199_990.0;
        // 200000 / 20 independent values: 1.4 % of the variance (one sd).
        assert!((mean_of(&|i| values[i] * values[i]) / 4.0 - 1.0).abs() < 0.06);
        assert!((mean_of(&|i| values[i] * values[i + 10]) / 4.0 - (-1f64).exp()).abs() < 0.06);
    }

    #[test]
    fn a_shaken_load_has_unit_variance_its_frequency_and_no_mean() {
        let mut random = generator(2, Purpose::WheelSpeeds, [0, 0]);
        let mut shaken = Shaken::new(12.0, 0.2, 0.01);
        let values: Vec<f64> = (0..100_000).map(|_| shaken.step(&mut random)).collect();
        let power = |hz: f64| {
            let sum = |of: fn(f64) -> f64| -> f64 {
                values
                    .chunks(200)
                    .map(|chunk| {
                        let part: f64 =
                            chunk.iter().enumerate().map(|(i, x)| x * of(TAU * hz * 0.01 * i as f64)).sum();
                        part * part
                    })
                    .sum()
            };
            sum(f64::sin) + sum(f64::cos)
        };
        let variance = values.iter().map(|x| x * x).sum::<f64>() / 1e5;
        // Correlated over 1/(0.2 2 pi 12 0.01) = 7 steps: 1.2 %.
        assert!((variance - 1.0).abs() < 0.05, "{variance}");
        assert!(power(12.0) > 3.0 * power(24.0) && power(12.0) > 20.0 * power(1.0));
    }

    #[test]
    fn a_road_is_as_rough_as_its_stretch() {
        let segment = |length_m, class: RoadClass| Segment { length_m, roughness: class.into(), slope: 2.0 };
        let list = vec![segment(100.0, RoadClass::A), segment(50.0, RoadClass::C)];
        let spec = |after_last| RoadSpec {
            surface: Surface::Segments(Segments {
                list: list.clone(),
                after_last,
                amplitude: Default::default(),
            }),
            ..RoadSpec::default()
        };
        let held = Rough::new(&spec(AfterLast::Hold));
        // Each class is four times the one before in power.
        for (at_m, expected) in [(-5.0, 0.5), (99.0, 0.5), (101.0, 2.0), (1e6, 2.0)] {
            assert!((held.amplitude(at_m) - expected).abs() < 1e-12);
        }
        assert!((Rough::new(&spec(AfterLast::Repeat)).amplitude(160.0) - 0.5).abs() < 1e-12);
    }
}
