//! The wheelbase of a drive: how far behind the front wheels the rear ones meet the same road.
//!
//! Called by whoever learns of a car whose wheelbase was assumed, before its tires are listened to. Of short frames, in both tracks and
//! below wheel hop, the road under each wheel is found from its accelerations, and the phase from front to rear is held against a delay of
//! `wheelbase / speed`. Masses and tires of the file are enough for it: below hop the tire's deflection is the smaller part of the road.

use std::f64::consts::{PI, TAU};

use itpms_core::model::{CarConfig, CarSample, CornerConfig, CornerSample};

/// Length of a frame in s; frames overlap by half. Bins from the lowest to the highest in Hz: above the body's motion, below wheel hop.
const FRAME_S: f64 = 1.28;
const BINS_HZ: [f64; 2] = [2.5, 8.0];
/// Wheelbases that are tried, in m.
const SHORTEST_M: f64 = 1.2;
const LONGEST_M: f64 = 6.0;
const STEP_M: f64 = 0.02;
/// A bicycle's speed in m/s: below it nothing is reported of a car's wheelbase.
const SLOWEST_M_S: f64 = 4.0;
/// Least mean cosine of the residual phases, and fewest frames, for a wheelbase.
const LEAST_AGREEMENT: f64 = 0.3;
const FEWEST_FRAMES: u64 = 60;
/// Standard deviation in s of the wheels' delay without the road's. A wheel follows the road `2 zeta / omega` of the hop later, 5 to
/// 10 ms where dampers have a ratio of 0.2 to 0.4; masses and tires that are some 10 % off, and how the body rests on its axles, leave a fifth
/// of that. Of one side alone the body does not show the axle's force, which is worth more than half of it.
const SYSTEMATIC_S: f64 = 0.0015;
const SYSTEMATIC_SIDE_S: f64 = 0.005;

#[derive(Debug)]
pub struct WheelbaseListener {
    rate_hz: f64,
    /// By corner, unsprung and sprung mass over the tire's stiffness in s²; not a number where the file has no corner.
    over_stiffness: [[f64; 2]; 4],
    /// Whether all four corners are measured, so that axles are compared; else sides are.
    has_four: bool,
    last_s: f64,
    /// Accelerations of wheels and body, and speed, of the frame under way.
    rows: Vec<([[f64; 2]; 4], f64)>,
    /// By wheelbase, the sum of the cosines of the residual phases.
    sums: Vec<f64>,
    phases: u64,
    frames: u64,
    /// Sum of the frames' speeds in m/s.
    speeds: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundWheelbase {
    pub wheelbase_m: f64,
    pub sd_m: f64,
}

impl WheelbaseListener {
    pub fn new(config: &CarConfig<f64>, sample_rate_hz: f64) -> Self {
        let tried = ((LONGEST_M - SHORTEST_M) / STEP_M) as usize + 1;
        Self {
            rate_hz: sample_rate_hz,
            over_stiffness: config
                .corners
                .each_ref()
                .map(|c| c.as_ref().map_or([f64::NAN; 2], over_stiffness)),
            has_four: config.corners.iter().all(Option::is_some),
            last_s: f64::NAN,
            rows: vec![],
            sums: vec![0.0; tried],
            phases: 0,
            frames: 0,
            speeds: 0.0,
        }
    }

    /// Takes a sample. One that is late, lacks its speed or is slow ends the frame under way.
    pub fn take(&mut self, sample: &CarSample<f64>) {
        let step_s = sample.time_s - self.last_s;
        self.last_s = sample.time_s;
        if !(step_s > 0.0 && step_s * self.rate_hz < 1.5 && sample.speed_m_s > SLOWEST_M_S) {
            self.rows.clear();
            return;
        }
        let both = |corner: Option<_>| {
            corner.map_or([f64::NAN; 2], |c: CornerSample<f64>| [c.wheel_accel_m_s2, c.body_accel_m_s2])
        };
        self.rows.push((sample.corners.map(both), sample.speed_m_s));
        let length = (FRAME_S * self.rate_hz).round() as usize;
        if self.rows.len() >= length {
            self.frame();
            self.rows.drain(..length / 2);
        }
    }

    fn frame(&mut self) {
        let n = self.rows.len() as f64;
        let speed_m_s = self.rows.iter().map(|(_, speed)| speed).sum::<f64>() / n;
        let first = (BINS_HZ[0] * FRAME_S).ceil() as usize;
        let last = (BINS_HZ[1] * FRAME_S).floor() as usize;
        for bin in first..=last {
            let omega = TAU * bin as f64 * self.rate_hz / n;
            // The tire's force moves both masses, so the road lies their forces over its stiffness above the wheel.
            let shares =
                self.over_stiffness.map(|[wheel, body]| [1.0 - omega * omega * wheel, -omega * omega * body]);
            let mut words = [[0.0; 2]; 4];
            for (i, (corners, _)) in self.rows.iter().enumerate() {
                let (sin, cos) = (omega * i as f64 / self.rate_hz).sin_cos();
                let hann = (PI * (i as f64 + 0.5) / n).sin().powi(2);
                for ((word, [wheel, body]), share) in words.iter_mut().zip(corners).zip(&shares) {
                    let road = hann * (share[0] * wheel + share[1] * body);
                    word[0] += road * cos;
                    word[1] -= road * sin;
                }
            }
            // A rigid body spreads what one corner does over all four; both corners of an axle together it moves as their mass.
            let axle =
                |left: usize| [words[left][0] + words[left + 1][0], words[left][1] + words[left + 1][1]];
            let pairs = if self.has_four {
                [Some((axle(0), axle(2))), None]
            } else {
                [0, 1].map(|side| Some((words[side], words[side + 2])))
            };
            for ([fr, fi], [rr, ri]) in pairs.into_iter().flatten() {
                // Of rear times the conjugate of front: minus the delay times the frequency.
                let phase = (ri * fr - rr * fi).atan2(rr * fr + ri * fi);
                if !phase.is_finite() {
                    continue;
                }
                let per_m = omega / speed_m_s;
                for (i, sum) in self.sums.iter_mut().enumerate() {
                    *sum += (phase + per_m * (SHORTEST_M + STEP_M * i as f64)).cos();
                }
                self.phases += 1;
            }
        }
        self.frames += 1;
        self.speeds += speed_m_s;
    }

    /// The wheelbase; `None` if front and rear were not found to follow each other.
    pub fn finish(self) -> Option<FoundWheelbase> {
        let (best, most) = self.sums.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let agreement = most / self.phases as f64;
        if !(self.frames >= FEWEST_FRAMES && agreement > LEAST_AGREEMENT) {
            return None;
        }
        // The peak of a parabola through the best and its neighbors; one at an end of what was tried is none.
        let (before, after) = (*self.sums.get(best.checked_sub(1)?)?, *self.sums.get(best + 1)?);
        let bent = before - 2.0 * most + after;
        let place = best as f64 + 0.5 * (before - after) / bent;
        let wheelbase_m = SHORTEST_M + STEP_M * place;
        let systematic_s = if self.has_four { SYSTEMATIC_S } else { SYSTEMATIC_SIDE_S };
        // The noise of the sum's slope, a root of half the sum of squares of frequencies, over its curvature, which is that sum times the
        // agreement.
        let scatter_m = STEP_M * (0.5 / (agreement * -bent)).sqrt();
        Some(FoundWheelbase {
            wheelbase_m,
            sd_m: scatter_m.hypot(systematic_s * self.speeds / self.frames as f64),
        })
    }
}

fn over_stiffness(corner: &CornerConfig<f64>) -> [f64; 2] {
    let stiffness = corner.tire.stiffness_n_per_m(corner.placard_kpa);
    [corner.quarter_car.unsprung_mass_kg(), corner.quarter_car.sprung_mass_kg()].map(|mass| mass / stiffness)
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::Corner;
    use itpms_data::Vehicle;
    use itpms_sim::scenario::Scenario;
    use itpms_sim::simulation::Simulation;
    use itpms_sim::time_profile::Pressure;

    /// A rigid body on four wheels, the rear dampers half the front ones' and then the other way round: the wheels alone would be off by
    /// some 10 cm, once too long and once too short.
    #[test]
    fn dampers_that_differ_between_the_axles_do_not_change_the_wheelbase() {
        for damping in [[2_600.0, 1_100.0], [1_300.0, 2_200.0]] {
            let mut scenario = Scenario::builtin("drive-puncture").unwrap();
            (scenario.duration_s, scenario.rate_hz) = (120.0, 200.0);
            for (corner, spec) in scenario.corner.iter_mut() {
                spec.damping_n_s_per_m = damping[corner.index() / 2];
                spec.pressure = Pressure::ConstantKpa(spec.placard_kpa);
            }
            let file = CarConfig { wheelbase_m: None, ..scenario.car_config().unwrap() };
            let simulation = Simulation::new(&scenario, 1).unwrap();
            let mut listener = WheelbaseListener::new(&file, scenario.rate_hz);
            simulation.for_each(|row| listener.take(&row.car_sample()));
            let found = listener.finish().unwrap();
            let off_m = (found.wheelbase_m - scenario.wheelbase_m).abs();
            assert!(off_m < 0.05 && off_m < 2.0 * found.sd_m, "{found:?}, {}", scenario.wheelbase_m);
        }
    }

    /// White acceleration over the road's length, which the rear wheels meet a wheelbase later, under a speed that goes up and down.
    fn found(wheelbase_m: f64, noise: f64) -> Option<FoundWheelbase> {
        let (rate_hz, mut at_m) = (200.0, 0.0);
        // Waves of the road with 0.1 to 0.5 cycles per m, 2 to 10 Hz at 20 m/s; their phases grow with the square, so that they make no pulse.
        let waves: Vec<[f64; 3]> = (0..160)
            .map(|i| {
                [0.1 + 0.0025 * f64::from(i), (f64::from(i * i) * 0.7).sin(), (f64::from(i * i) * 0.7).cos()]
            })
            .collect();
        let road = |m: f64| {
            waves.iter().map(|[n, a, b]| a * (TAU * n * m).cos() + b * (TAU * n * m).sin()).sum::<f64>()
        };
        let mut listener = WheelbaseListener::new(&Vehicle::paper().car_config(&Corner::ALL), rate_hz);
        for i in 0..24_000 {
            let time_s = f64::from(i) / rate_hz;
            let speed_m_s = 20.0 + 3.0 * (0.1 * time_s).sin();
            at_m += speed_m_s / rate_hz;
            let disturbed = |k: f64| noise * (1e4 * (f64::from(i) * 12.9898 + k).sin()).sin();
            let wheel = |m: f64, k: f64| {
                let wheel_accel_m_s2 = road(m) + disturbed(k);
                Some(CornerSample { body_accel_m_s2: 0.0, wheel_accel_m_s2 })
            };
            let (front, rear) = (at_m, at_m - wheelbase_m);
            let corners =
                [wheel(front, 1.0), wheel(front + 77.0, 2.0), wheel(rear, 3.0), wheel(rear + 77.0, 4.0)];
            listener.take(&CarSample { time_s, speed_m_s, corners, wheel_speeds: None });
        }
        listener.finish()
    }

    #[test]
    fn rear_wheels_that_follow_the_front_ones_give_the_wheelbase_away() {
        for wheelbase_m in [2.0, 2.55, 2.9, 4.0] {
            let found = found(wheelbase_m, 3.0).unwrap();
            // Without hop the phases are the delay's alone.
            assert!((found.wheelbase_m - wheelbase_m).abs() < 0.02, "{found:?}, {wheelbase_m}");
            assert!(found.sd_m > 0.029 && found.sd_m < 0.04, "{found:?}");
        }
    }

    #[test]
    fn wheels_that_go_by_themselves_give_nothing_away() {
        assert_eq!(found(2.7, 1e3), None);
    }
}
