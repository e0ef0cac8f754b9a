//! Sensors that go wrong for a while: stuck, losing samples, spiking, swapped, with a wrong gain, noisy, offset.
//!
//! Called by the simulation after the sensors were read, and by studies that put faults into a drive that was recorded whole ([`Faults`]).
//! A fault's random numbers have a generator of their own: a drive with a fault is the same drive without it, but for the fault.

mod spec;

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

pub use spec::{CornerName, FaultKind, FaultPlace, FaultSpec, SensorName};

use crate::streams::{Purpose, generator};

/// Body and wheel accelerations of the corners, in the order of `Corner::ALL`.
pub type Readings = [[f64; 2]; 4];

#[derive(Debug, Clone)]
struct Fault {
    spec: FaultSpec,
    random: Pcg64,
    stuck_at: Option<f64>,
    last_s: Option<f64>,
}

/// The faults of a drive, in the order of its scenario: a later one meets what the earlier ones have left.
#[derive(Debug, Clone)]
pub struct Faults(Vec<Fault>);

impl Faults {
    pub fn new(specs: &[FaultSpec], seed: u64) -> Self {
        let fault = |(index, spec): (usize, &FaultSpec)| Fault {
            spec: *spec,
            random: generator(seed, Purpose::Fault, [index as u64, 0]),
            stuck_at: None,
            last_s: None,
        };
        Self(specs.iter().enumerate().map(fault).collect())
    }

    /// Spoils a row's readings. Rows come in the order of time.
    pub fn spoil(&mut self, time_s: f64, readings: &mut Readings) {
        for fault in &mut self.0 {
            fault.spoil(time_s, readings);
        }
    }
}

impl Fault {
    fn spoil(&mut self, time_s: f64, readings: &mut Readings) {
        let since_last_s = self.last_s.map_or(0.0, |last_s| time_s - last_s);
        self.last_s = Some(time_s);
        let [corner, place] = self.spec.at().index();
        let lasts = time_s >= self.spec.from_s && self.spec.to_s.is_none_or(|to_s| time_s < to_s);
        if !lasts {
            self.stuck_at = None;
            return;
        }
        let reading = readings[corner][place];
        readings[corner][place] = match self.spec.kind {
            // A sample that was lost is nothing to be stuck at.
            FaultKind::Stuck if self.stuck_at.is_none() && reading.is_nan() => reading,
            FaultKind::Stuck => *self.stuck_at.get_or_insert(reading),
            FaultKind::Dropout { share } => self.lost_or(share, reading),
            FaultKind::Spikes { per_s, size_m_s2 } => reading + self.spike(per_s * since_last_s, size_m_s2),
            FaultKind::Gain { factor } => factor * reading,
            FaultKind::Noise { rms_m_s2 } => {
                let white: f64 = StandardNormal.sample(&mut self.random);
                reading + rms_m_s2 * white
            }
            FaultKind::Bias { offset_m_s2 } => reading + offset_m_s2,
            FaultKind::Swap { with } => {
                let [other_corner, other_place] = with.index();
                std::mem::replace(&mut readings[other_corner][other_place], reading)
            }
        };
    }

    fn lost_or(&mut self, share: f64, reading: f64) -> f64 {
        if self.random.random::<f64>() < share { f64::NAN } else { reading }
    }

    fn spike(&mut self, chance: f64, size_m_s2: f64) -> f64 {
        let draw: f64 = self.random.random();
        let sign = if self.random.random::<bool>() { 1.0 } else { -1.0 };
        if draw < chance { sign * size_m_s2 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::Corner;

    const CLEAN: Readings = [[0.1, 1.0], [0.2, 2.0], [0.3, 3.0], [0.4, 4.0]];

    fn fault(kind: FaultKind) -> FaultSpec {
        let lasting = FaultSpec::lasting(Corner::FrontRight, FaultPlace::Wheel, 1.0, kind);
        FaultSpec { to_s: Some(101.0), ..lasting }
    }

    /// Readings of the faulty sensor over 102 s at 100 Hz; all others are checked to be as they were.
    fn run(kind: FaultKind) -> Vec<f64> {
        let mut faults = Faults::new(&[fault(kind)], 7);
        let spoil = |i: u32| {
            let mut readings = CLEAN;
            // The sensor itself moves, so that stuck is something else than clean.
            readings[1][1] += f64::from(i) * 1e-3;
            faults.spoil(f64::from(i) * 0.01, &mut readings);
            let before_or_after = !(100..10_100).contains(&i);
            if before_or_after {
                assert_eq!(readings[1][1], 2.0 + f64::from(i) * 1e-3);
            }
            let value = std::mem::replace(&mut readings[1][1], CLEAN[1][1]);
            assert_eq!(readings, CLEAN);
            value - f64::from(i) * 1e-3
        };
        (0..10_200).map(spoil).collect::<Vec<f64>>()[100..10_100].to_vec()
    }

    #[test]
    fn a_stuck_sensor_repeats_its_first_value() {
        let readings = run(FaultKind::Stuck);
        assert!(readings.iter().enumerate().all(|(i, x)| (x + i as f64 * 1e-3 - 2.0).abs() < 1e-9));
    }

    #[test]
    fn a_sample_that_is_lost_is_nothing_to_be_stuck_at() {
        let mut faults = Faults::new(&[fault(FaultKind::Stuck)], 7);
        let readings = [f64::NAN, 2.5, 3.0, f64::NAN].map(|reading| {
            let mut readings = CLEAN;
            readings[1][1] = reading;
            faults.spoil(2.0, &mut readings);
            readings[1][1]
        });
        assert!(readings[0].is_nan() && readings[1..] == [2.5; 3], "{readings:?}");
    }

    #[test]
    fn losses_and_spikes_are_as_frequent_as_asked_for() {
        let lost = run(FaultKind::Dropout { share: 0.3 }).iter().filter(|x| x.is_nan()).count();
        // Binomial, 10 000 of 0.3: sd 46.
        assert!((2800..3200).contains(&lost), "{lost}");
        let spikes = run(FaultKind::Spikes { per_s: 2.0, size_m_s2: 50.0 });
        let high = spikes.iter().filter(|x| (**x - 52.0).abs() < 1e-9).count();
        let low = spikes.iter().filter(|x| (**x + 48.0).abs() < 1e-9).count();
        // Poisson, 200 in 100 s: sd 14; half of them up: sd 10.
        assert!((145..255).contains(&(high + low)) && (60..140).contains(&high), "{high} {low}");
        assert!(spikes.iter().filter(|x| (**x - 2.0).abs() < 1e-9).count() == 10_000 - high - low);
    }

    #[test]
    fn gain_bias_and_noise_do_what_they_say() {
        let gained = run(FaultKind::Gain { factor: 0.5 });
        assert!((gained[0] - (0.5 * 2.1 - 0.1)).abs() < 1e-9, "{}", gained[0]);
        assert!(run(FaultKind::Bias { offset_m_s2: 3.0 }).iter().all(|x| (x - 5.0).abs() < 1e-9));
        let noisy = run(FaultKind::Noise { rms_m_s2: 0.5 });
        let variance = noisy.iter().map(|x| (x - 2.0).powi(2)).sum::<f64>() / noisy.len() as f64;
        // Four sd of the variance of 10 000 normal numbers: 4 sqrt(2/n) = 6 %.
        assert!((variance / 0.25 - 1.0).abs() < 0.06, "{variance}");
    }

    #[test]
    fn swapped_sensors_carry_each_others_values() {
        let with = SensorName::new(Corner::RearLeft, FaultPlace::Body);
        let mut faults = Faults::new(&[fault(FaultKind::Swap { with })], 1);
        let mut readings = CLEAN;
        faults.spoil(0.5, &mut readings);
        assert_eq!(readings, CLEAN);
        faults.spoil(1.5, &mut readings);
        assert_eq!(readings, [[0.1, 1.0], [0.2, 0.3], [2.0, 3.0], [0.4, 4.0]]);
    }
}
