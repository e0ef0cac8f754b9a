//! Surfaces under the wheels of each side: surfaces one after the other, strips at the road's edge; `docs/math/simulation.md`, eq. 16a-16c.
//!
//! Called by the run, message by message. Draws from a generator of its own.

use rand::RngExt;
use rand_pcg::Pcg64;

use super::conditions::ConditionsSpec;
use super::disturbance::normal;
use super::tire::DRY_FRICTION;
use crate::streams::{Purpose, generator};

/// A kind of surface: slip stiffness over that on a dry road, friction, rolling resistance beside that of a dry road over load.
struct Kind {
    stiffness: f64,
    friction: f64,
    rolling: f64,
}

// Frictions are those of textbooks; stiffnesses and resistances are guessed between what is published for summer and winter tires.
const DRY: Kind = Kind { stiffness: 1.0, friction: DRY_FRICTION, rolling: 0.0 };
const WET: Kind = Kind { stiffness: 0.85, friction: 0.6, rolling: 0.001 };
const SNOW: Kind = Kind { stiffness: 0.4, friction: 0.25, rolling: 0.015 };
const GRAVEL: Kind = Kind { stiffness: 0.6, friction: 0.5, rolling: 0.01 };
/// Shortest and longest time in s on a strip at the edge; its slip stiffness over the lane's, its rolling resistance beside.
const STRIP_S: [f64; 2] = [5.0, 30.0];
const STRIP_STIFFNESS: f64 = 0.7;
const STRIP_ROLLING: f64 = 0.01;

/// Surface under the wheels of a side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ground {
    /// Slip stiffness over that on a dry road.
    pub(crate) stiffness: f64,
    pub(crate) friction: f64,
    /// Rolling resistance over load, beside that of a dry road.
    pub(crate) rolling: f64,
    /// By what share a wheel's way is longer than the car's.
    pub(crate) way: f64,
}

impl Ground {
    pub(crate) const DRY: Self =
        Self { stiffness: DRY.stiffness, friction: DRY.friction, rolling: DRY.rolling, way: 0.0 };
}

/// The ground along a drive.
#[derive(Debug, Clone)]
pub(crate) struct Surfaces {
    spec: ConditionsSpec,
    random: Pcg64,
    /// Slip stiffness of the day over the usual one.
    day: f64,
    ends_m: f64,
    sides: [Ground; 2],
    crown: f64,
    /// The side that is on a strip, what this adds to its way, and for how long.
    strip: (usize, f64, f64),
}

impl Surfaces {
    pub(crate) fn new(spec: &ConditionsSpec, seed: u64) -> Self {
        let mut random = generator(seed, Purpose::WheelConditions, [0, 0]);
        let day = (spec.slip_day_sd * normal(&mut random)).exp();
        Self {
            spec: *spec,
            random,
            day,
            ends_m: f64::NEG_INFINITY,
            sides: [Ground::DRY; 2],
            crown: 0.0,
            strip: (0, 0.0, 0.0),
        }
    }

    /// The ground under the left and the right wheels, and the fall to the right, at a way that goes forward.
    pub(crate) fn step(&mut self, distance_m: f64, step_s: f64, speed_m_s: f64) -> ([Ground; 2], f64) {
        if !(distance_m < self.ends_m) {
            self.stretch(distance_m);
        }
        self.edge(step_s, speed_m_s);
        let mut sides = self.sides;
        let (side, way, left_s) = self.strip;
        if left_s > 0.0 {
            sides[side].stiffness *= STRIP_STIFFNESS;
            sides[side].rolling += STRIP_ROLLING;
            sides[side].way += way;
        }
        (sides, self.crown)
    }

    /// Draws the next stretch; lengths without memory.
    fn stretch(&mut self, from_m: f64) {
        let spec = self.spec;
        let share: f64 = self.random.random();
        self.ends_m = from_m - spec.surface_m * (1.0 - share).ln();
        let left = self.ground();
        let right = if self.random.random::<f64>() < spec.split_share { self.ground() } else { left };
        self.sides = [left, right];
        self.crown = spec.crown + spec.crown_spread * normal(&mut self.random);
    }

    fn ground(&mut self) -> Ground {
        let spec = &self.spec;
        let mut left: f64 = self.random.random();
        let mut kind = DRY;
        for (other, share) in [(WET, spec.wet_share), (SNOW, spec.snow_share), (GRAVEL, spec.gravel_share)] {
            left -= share;
            if left < 0.0 {
                kind = other;
                break;
            }
        }
        let spread = (spec.surface_spread * normal(&mut self.random)).exp();
        Ground {
            stiffness: kind.stiffness * self.day * spread,
            friction: kind.friction,
            rolling: kind.rolling,
            way: 0.0,
        }
    }

    /// Strips are met while driving, as often in every second.
    fn edge(&mut self, step_s: f64, speed_m_s: f64) {
        self.strip.2 -= step_s;
        let spec = &self.spec;
        if !(spec.passing_per_h > 0.0 && speed_m_s > 3.0) || self.strip.2 > 0.0 {
            return;
        }
        if self.random.random::<f64>() < spec.passing_per_h * step_s / 3600.0 {
            // To the right there is an edge, to the left what others drive on: two of three are on the right.
            let side = usize::from(self.random.random::<f64>() < 0.67);
            // Exponential about its mean.
            let way = -spec.passing_way * (1.0 - self.random.random::<f64>()).ln();
            let [least_s, most_s] = STRIP_S;
            self.strip = (side, way, least_s + (most_s - least_s) * self.random.random::<f64>());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(spec: &ConditionsSpec, seed: u64) -> Vec<([Ground; 2], f64)> {
        let mut surfaces = Surfaces::new(spec, seed);
        (0..200_000).map(|i| surfaces.step(20.0 * f64::from(i), 1.0, 20.0)).collect()
    }

    #[test]
    fn without_conditions_the_road_is_dry() {
        assert!(drive(&ConditionsSpec::OFF, 1).iter().all(|step| *step == ([Ground::DRY; 2], 0.0)));
    }

    #[test]
    fn surfaces_have_their_shares_and_lengths() {
        let spec = ConditionsSpec {
            snow_share: 0.3,
            split_share: 0.5,
            crown: 0.02,
            crown_spread: 0.01,
            ..ConditionsSpec::OFF
        };
        let steps = drive(&spec, 2);
        let share = |of: &dyn Fn(&[Ground; 2]) -> bool| {
            steps.iter().filter(|(sides, _)| of(sides)).count() as f64 / steps.len() as f64
        };
        // 5000 stretches, of weights that differ as exponentials: sd sqrt(2 p (1 - p) / 5000), .9 %.
        let snow = share(&|sides| sides[1].stiffness == SNOW.stiffness);
        assert!((snow - 0.3).abs() < 0.03, "{snow}");
        // Half drawn anew, of these 2 x .3 x .7 differ.
        let split = share(&|sides| sides[0] != sides[1]);
        assert!((split - 0.5 * 0.42).abs() < 0.025, "{split}");
        let changes = steps.windows(2).filter(|pair| pair[0].1 != pair[1].1).count();
        // 4000 km in stretches of 800 m, each rounded up to a step of 20 m by 10 in the mean.
        assert!((changes as f64 - 4e6 / 810.0).abs() < 250.0, "{changes}");
        let crown = steps.iter().map(|(_, crown)| crown).sum::<f64>() / steps.len() as f64;
        assert!((crown - 0.02).abs() < 6e-4, "{crown}");
    }

    #[test]
    fn a_day_is_one_number_for_all_of_a_drive() {
        let spec = ConditionsSpec { slip_day_sd: 0.2, ..ConditionsSpec::OFF };
        let days: Vec<f64> = (0..400)
            .map(|seed| {
                let mut surfaces = Surfaces::new(&spec, seed);
                let [left, right] = surfaces.step(0.0, 1.0, 20.0).0;
                assert_eq!((left.stiffness, right), (surfaces.step(5e4, 1.0, 20.0).0[0].stiffness, left));
                left.stiffness.ln()
            })
            .collect();
        let sd = (days.iter().map(|ln| ln * ln).sum::<f64>() / 400.0).sqrt();
        // Of 400: 3.5 % (one sd).
        assert!((sd / 0.2 - 1.0).abs() < 0.12, "{sd}");
    }

    #[test]
    fn strips_come_as_often_and_last_as_long_as_they_should() {
        let spec = ConditionsSpec { passing_per_h: 12.0, passing_way: 1e-3, ..ConditionsSpec::OFF };
        let steps = drive(&spec, 3);
        let on = |([left, right], _): &([Ground; 2], f64)| left.way + right.way;
        let strips: Vec<f64> = steps
            .windows(2)
            .filter(|pair| on(&pair[0]) == 0.0 && on(&pair[1]) > 0.0)
            .map(|pair| on(&pair[1]))
            .collect();
        // 55.6 h; 17.5 of every 317.5 s none can begin: 630, sd 25.
        assert!((strips.len() as f64 - 630.0).abs() < 80.0, "{}", strips.len());
        let mean = strips.iter().sum::<f64>() / strips.len() as f64;
        assert!((mean / 1e-3 - 1.0).abs() < 0.15, "{mean}");
        let time_s = steps.iter().filter(|step| on(step) > 0.0).count() as f64 / strips.len() as f64;
        assert!((time_s - 17.5).abs() < 1.5, "{time_s}");
        // One side at a time.
        assert!(steps.iter().all(|([left, right], _)| left.way == 0.0 || right.way == 0.0));
    }
}
