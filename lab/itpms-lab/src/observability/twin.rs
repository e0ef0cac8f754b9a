//! Two tires, two roads, one measurement: the proof of `docs/math/identifiability.md` (eq. 1-3) driven out.
//!
//! Called by the study. A quarter car drives a class A road; then others with another stiffness, constant or falling,
//! drive the road made for them. Each drive is integrated by itself, from its own road and its own stiffness.

use itpms_core::model::CornerConfig;
use itpms_paper::quarter_car::{self, state};
use nalgebra::Vector5;
use serde::Serialize;

use itpms_analysis::bound::BoundSetting;

/// Steps per second: wheel hop turns by 0.02 rad a step, which a fourth-order method follows to 1e-7.
const RATE_HZ: f64 = 4000.0;
const DURATION_S: f64 = 10.0;
/// Every how many steps a point is kept for the figure.
const KEEP: usize = 20;
/// The falling tire loses its pressure between these times in s.
const FALL_S: (f64, f64) = (4.0, 6.5);
/// A share of the placard's pressure: the paper's drop from 241.3 to 137.9 kPa.
const LOW: f64 = 0.5715;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Twin {
    pub label: String,
    #[serde(skip)]
    pub pressure_kpa: Vec<f64>,
    #[serde(skip)]
    pub road_m: Vec<f64>,
    #[serde(skip)]
    pub wheel_accel_m_s2: Vec<f64>,
    /// Root mean square of the difference to the first tire's road in m.
    pub road_difference_rms_m: f64,
    /// Largest difference of (body, wheel) acceleration to the first tire's at any step, over the largest acceleration.
    pub relative_difference: [f64; 2],
}

/// The first tire and those that cannot be distinguished from it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Twins {
    #[serde(skip)]
    pub time_s: Vec<f64>,
    /// The first drove an ISO 8608 road; the others the roads made for them.
    pub drives: Vec<Twin>,
}

impl Twins {
    /// Largest relative difference of any acceleration of any twin.
    pub fn worst(&self) -> f64 {
        self.drives.iter().flat_map(|twin| twin.relative_difference).fold(0.0, f64::max)
    }

    pub(super) fn drive(corner: &CornerConfig<f64>, setting: &BoundSetting) -> Self {
        let placard = corner.placard_kpa;
        let falling = move |t: f64| {
            let share = ((t - FALL_S.0) / (FALL_S.1 - FALL_S.0)).clamp(0.0, 1.0);
            placard * (1.0 - share * (1.0 - LOW))
        };
        let road = heights(setting);
        let first = integrate(corner, &road, |_| placard);
        let others: [(&str, &dyn Fn(f64) -> f64); 3] = [
            ("soft all the time", &|_| placard * LOW),
            ("hard all the time", &|_| placard * 1.2),
            ("losing pressure from 4.0 to 6.5 s", &falling),
        ];
        let mut drives = vec![kept("at placard pressure", &road, &first, &road, &first, &|_| placard)];
        for (label, pressure) in others {
            // x_r' = x_w + F / k'
            let made: Vec<f64> = first
                .iter()
                .enumerate()
                .map(|(i, step)| {
                    step.wheel_m + step.force_n / corner.tire.stiffness_n_per_m(pressure(time(i)))
                })
                .collect();
            let driven = integrate(corner, &made, pressure);
            drives.push(kept(label, &made, &driven, &road, &first, pressure));
        }
        Self { time_s: (0..first.len()).step_by(KEEP).map(time).collect(), drives }
    }
}

fn time(step: usize) -> f64 {
    step as f64 / RATE_HZ
}

#[derive(Debug, Clone, Copy)]
struct Step {
    wheel_m: f64,
    force_n: f64,
    accelerations: [f64; 2],
}

fn kept(
    label: &str,
    road: &[f64],
    driven: &[Step],
    first_road: &[f64],
    first: &[Step],
    pressure: &dyn Fn(f64) -> f64,
) -> Twin {
    let largest = |channel: usize| first.iter().map(|s| s.accelerations[channel].abs()).fold(0.0, f64::max);
    let difference = |channel: usize| {
        let pairs = driven.iter().zip(first);
        pairs.map(|(a, b)| (a.accelerations[channel] - b.accelerations[channel]).abs()).fold(0.0, f64::max)
    };
    let squares: f64 = road.iter().zip(first_road).map(|(a, b)| (a - b).powi(2)).sum();
    let indices = || (0..road.len()).step_by(KEEP);
    Twin {
        label: label.to_owned(),
        pressure_kpa: indices().map(|i| pressure(time(i))).collect(),
        road_m: indices().map(|i| road[i]).collect(),
        wheel_accel_m_s2: indices().map(|i| driven[i].accelerations[1]).collect(),
        road_difference_rms_m: (squares / road.len() as f64).sqrt(),
        relative_difference: [0, 1].map(|channel| difference(channel) / largest(channel)),
    }
}

/// The setting's road as a sum of 400 cosines from 0.3 to 60 Hz, risen to within the first second, so that the car may
/// start at rest. Phases from the golden ratio: irregular, and no random numbers.
fn heights(setting: &BoundSetting) -> Vec<f64> {
    let waves: Vec<[f64; 3]> = (0..400u32)
        .map(|k| {
            let at = |k: f64| 0.3 * (60.0f64 / 0.3).powf(k / 400.0);
            let (low, high) = (at(f64::from(k)), at(f64::from(k) + 1.0));
            let f = (low * high).sqrt();
            let density = setting.road.density_m3(f / setting.speed_m_s) / setting.speed_m_s;
            let phase = (f64::from(k * k) * 0.618_033_988_749_895).fract();
            [(2.0 * density * (high - low)).sqrt(), std::f64::consts::TAU * f, std::f64::consts::TAU * phase]
        })
        .collect();
    let samples = (DURATION_S * RATE_HZ) as usize;
    (0..samples)
        .map(|i| {
            let t = time(i);
            let rise = if t < 1.0 { (0.5 - 0.5 * (std::f64::consts::PI * t).cos()).powi(2) } else { 1.0 };
            rise * waves.iter().map(|[a, w, phase]| a * (w * t + phase).cos()).sum::<f64>()
        })
        .collect()
}

/// The quarter car over a sampled road by the Adams-Bashforth rule of fourth order. It looks at the road at the
/// samples alone, so a road given there is all there is to know of it.
fn integrate(corner: &CornerConfig<f64>, road: &[f64], pressure_kpa: impl Fn(f64) -> f64) -> Vec<Step> {
    let car = &corner.quarter_car;
    let h = 1.0 / RATE_HZ;
    let mut x = Vector5::zeros();
    let mut past = [Vector5::zeros(); 3];
    let mut steps = Vec::with_capacity(road.len());
    for (i, &road_m) in road.iter().enumerate() {
        x[state::TIRE_STIFFNESS] = corner.tire.stiffness_n_per_m(pressure_kpa(time(i)));
        let now = quarter_car::derivative(car, &x, road_m);
        let wheel_m = x[state::WHEEL_POSITION];
        steps.push(Step {
            wheel_m,
            force_n: x[state::TIRE_STIFFNESS] * (road_m - wheel_m),
            accelerations: [now[state::BODY_VELOCITY], now[state::WHEEL_VELOCITY]],
        });
        x += (now * 55.0 - past[0] * 59.0 + past[1] * 37.0 - past[2] * 9.0) * (h / 24.0);
        past = [now, past[0], past[1]];
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_sim::plant::{Deviations, Plant, StepInput};

    #[test]
    fn the_twins_are_alike_to_rounding_and_their_roads_are_not() {
        let twins = Twins::drive(&CornerConfig::paper(), &BoundSetting::paper());
        // Rounding of 40 000 steps, damped by the suspension.
        assert!(twins.worst() < 1e-11, "{}", twins.worst());
        for twin in &twins.drives[1..] {
            assert!(twin.road_difference_rms_m > 1e-5, "{}: {}", twin.label, twin.road_difference_rms_m);
        }
        let largest = twins.drives[0].wheel_accel_m_s2.iter().fold(0.0f64, |m, a| m.max(a.abs()));
        assert!(largest > 1.0, "{largest}");
    }

    #[test]
    fn the_simulators_plant_cannot_tell_them_apart_either() {
        // Another program (Runge-Kutta, two samples a step, stiffness straight within a step) on the made road.
        let corner = CornerConfig::paper();
        let road = heights(&BoundSetting::paper());
        let first = integrate(&corner, &road, |_| 241.3);
        let k = corner.tire.stiffness_n_per_m(150.0);
        let made: Vec<f64> = first.iter().map(|step| step.wheel_m + step.force_n / k).collect();
        let mut plant = Plant::new(&corner.quarter_car, &Deviations::default(), made[0]).unwrap();
        let (mut worst, mut largest) = (0.0f64, 0.0f64);
        for i in (0..road.len() - 2).step_by(2) {
            let input = StepInput { road_m: [made[i], made[i + 1], made[i + 2]], stiffness_n_per_m: [k; 2] };
            plant.step(2.0 / RATE_HZ, &input);
            let a = first[i + 2].accelerations[1];
            worst = worst.max((plant.accelerations_m_s2()[1] - a).abs());
            largest = largest.max(a.abs());
        }
        // The two integrators' difference at 60 Hz: (ωh)^4 of some hundredths, over its own decay time.
        assert!(worst < 1e-3 * largest, "{worst} of {largest}");
    }
}
