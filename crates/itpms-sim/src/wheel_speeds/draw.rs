//! Cars and days drawn from seeds: what a study of wheel speeds drives.
//!
//! Called by studies before a scenario is composed. A car keeps what its seed draws from day to day; a day has roads, weather, load and
//! distance of its own. `docs/math/simulation.md`, "Conditions".

use rand::RngExt;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use super::conditions::ConditionsSpec;
use super::disturbance::normal;
use super::spec::{DrivenWheels, WheelSpeedSpec};
use crate::scenario::JourneySpec;
use crate::streams::{Purpose, generator};

itpms_core::labelled! {
    /// Conditions of the later days of a study.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Condition {
        /// Dry and wet roads, some gravel.
        Ordinary = "ordinary",
        /// Snow with patches, and sides of other grip.
        Snow = "snow",
        Trailer = "trailer",
        /// A car whose driven wheels are coupled by a limited-slip differential with preload.
        LimitedSlip = "limited-slip",
        /// Each day one of the others: snow .15, a trailer .1; one car of seven with a limited slip.
        Mixed = "mixed",
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Day {
    pub car_seed: u64,
    pub seed: u64,
    /// Conditions of the later days.
    pub condition: Condition,
    /// The day of the calibration: on a dry or wet road, without a trailer, no distance driven before.
    pub calibrates: bool,
}

fn between(random: &mut Pcg64, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) * random.random::<f64>()
}

/// Between two positive numbers, each factor as likely.
fn about(random: &mut Pcg64, [low, high]: [f64; 2]) -> f64 {
    low * (high / low).powf(random.random())
}

fn chance(random: &mut Pcg64, of: f64) -> bool {
    random.random::<f64>() < of
}

impl Day {
    /// The drawn car: the wheels with their conditions; the journey's turns, warmth and haste are set.
    pub fn draw(&self, journey: &mut JourneySpec) -> WheelSpeedSpec {
        let mut spec = self.car();
        let random = &mut generator(self.seed, Purpose::DrawnConditions, [1, 0]);
        // Always as many numbers, so that a day is the same under another condition but for that.
        let kind: f64 = random.random();
        let [snow, trailer] = match self.condition {
            _ if self.calibrates => [false; 2],
            Condition::Ordinary | Condition::LimitedSlip => [false; 2],
            Condition::Snow => [true, false],
            Condition::Trailer => [false, true],
            Condition::Mixed => [kind < 0.15, (0.15..0.25).contains(&kind)],
        };
        spec.grade_sd = between(random, [0.01, 0.03]);
        let of = &mut spec.conditions;
        of.wet_share = random.random::<f64>().powi(2);
        of.gravel_share = 0.03 * (1.0 - of.wet_share);
        of.split_share = between(random, [0.0, 0.15]);
        of.surface_m = about(random, [300.0, 1500.0]);
        of.surface_spread = 0.1;
        of.slip_day_sd = 0.1;
        let snow_share = between(random, [0.5, 1.0]);
        if snow {
            [of.snow_share, of.wet_share, of.gravel_share] = [snow_share, 0.5 * (1.0 - snow_share), 0.0];
            // Patches, and wheels beside the cleared track.
            (of.surface_m, of.split_share) = (0.25 * of.surface_m, of.split_share + 0.1);
        }
        of.crown = 0.02;
        of.crown_spread = 0.012;
        of.bank = between(random, [0.0, 0.5]);
        of.side_wind_m_s = between(random, [0.0, 4.0]);
        of.passing_per_h = between(random, [0.0, 8.0]);
        of.passing_way = about(random, [2e-4, 1e-3]);
        of.yaw_drift_rad_s = between(random, [0.0, 2e-3]);
        let [kg, tongue, drag] =
            [[400.0, 1600.0], [0.04, 0.08], [0.4, 1.0]].map(|limits| between(random, limits));
        if trailer {
            (of.trailer_kg, of.tongue_share, of.trailer_drag_n_s2_per_m2) = (kg, tongue, drag);
        }
        let km = about(random, [20.0, 3000.0]);
        let air_k = (8.0 * normal(random)).clamp(-25.0, 25.0);
        if !self.calibrates {
            (of.odometer_km, journey.air_k) = (km, air_k);
        }
        journey.warms_by_k = between(random, [12.0, 25.0]);
        journey.junction_chance = between(random, [0.1, 0.5]);
        if snow {
            (journey.gentle, journey.lateral_m_s2) = (0.35, 0.8);
        }
        spec
    }

    fn car(&self) -> WheelSpeedSpec {
        let random = &mut generator(self.car_seed, Purpose::DrawnConditions, [0, 0]);
        let usual = WheelSpeedSpec::default();
        let driven: f64 = random.random();
        let mut spec = WheelSpeedSpec {
            alone: true,
            car_seed: Some(self.car_seed),
            driven: if driven < 0.55 {
                DrivenWheels::Front
            } else if driven < 0.8 {
                DrivenWheels::Rear
            } else {
                DrivenWheels::All
            },
            period_ms: if chance(random, 0.3) { 10.0 } else { 20.0 },
            latency_ms: between(random, [5.0, 30.0]),
            resolution_km_h: if chance(random, 0.5) { 0.03 } else { about(random, [0.01, 0.06]) },
            yaw_rate: chance(random, 0.85),
            accel_x: chance(random, 0.8),
            accel_y: chance(random, 0.8),
            brake: chance(random, 0.8),
            // Where tires have been measured, and models put them.
            radius_per_ln_pressure: about(random, [0.0045, 0.012]),
            radius_per_ln_load: usual.radius_per_ln_load * between(random, [0.8, 1.2]),
            wear_per_km: about(random, [5e-8, 2e-7]),
            // Slips of 3e-3 to 7e-3 per m/s² on two wheels.
            slip_stiffness_per_load: about(random, [29.0, 67.0]),
            ..usual
        };
        spec.conditions = ConditionsSpec {
            slip_load_loss: between(random, [0.0, 0.3]),
            ackermann: between(random, [0.3, 1.0]),
            wear_spread: 0.3,
            yaw_scale: (0.01 * normal(random)).clamp(-0.03, 0.03),
            ..ConditionsSpec::OFF
        };
        let locks = chance(random, 1.0 / 7.0);
        let (locking_n, locking_share) = (between(random, [300.0, 900.0]), between(random, [0.0, 0.3]));
        let coupled = match self.condition {
            Condition::LimitedSlip => true,
            Condition::Mixed => locks,
            Condition::Ordinary | Condition::Snow | Condition::Trailer => false,
        };
        if coupled {
            (spec.locking_n, spec.locking_share) = (locking_n, locking_share);
        }
        spec
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(
        condition: Condition,
        car_seed: u64,
        seed: u64,
        calibrates: bool,
    ) -> (WheelSpeedSpec, JourneySpec) {
        let mut journey = JourneySpec::default();
        let spec = Day { car_seed, seed, condition, calibrates }.draw(&mut journey);
        spec.validate().unwrap();
        journey.validate().unwrap();
        (spec, journey)
    }

    #[test]
    fn a_car_stays_the_same_from_day_to_day() {
        let [(monday, _), (friday, warm)] = [1, 2].map(|seed| drawn(Condition::Ordinary, 7, seed, false));
        assert_ne!(monday.conditions, friday.conditions);
        assert_eq!(
            WheelSpeedSpec { conditions: monday.conditions, grade_sd: monday.grade_sd, ..friday },
            monday
        );
        assert_eq!(monday.conditions.ackermann, friday.conditions.ackermann);
        let (calibration, cold) = drawn(Condition::Snow, 7, 2, true);
        assert_eq!((calibration.conditions.snow_share, calibration.conditions.odometer_km), (0.0, 0.0));
        assert_eq!(cold.air_k, 0.0);
        // The same day under another condition.
        let (snow, slow) = drawn(Condition::Snow, 7, 2, false);
        assert_eq!(snow.conditions.odometer_km, friday.conditions.odometer_km);
        assert!(snow.conditions.snow_share >= 0.5 && slow.gentle < 1.0 && slow.air_k == warm.air_k);
    }

    #[test]
    fn conditions_have_their_shares() {
        let count = |of: &dyn Fn(&WheelSpeedSpec) -> bool| {
            (0..2000).filter(|seed| of(&drawn(Condition::Mixed, *seed, 9000 + seed, false).0)).count() as f64
        };
        // sd of 2000 draws: 16, 13, 16.
        assert!((count(&|spec| spec.conditions.snow_share > 0.0) - 300.0).abs() < 50.0);
        assert!((count(&|spec| spec.conditions.trailer_kg > 0.0) - 200.0).abs() < 45.0);
        assert!((count(&|spec| spec.locking_n > 0.0) - 286.0).abs() < 50.0);
        let all = |condition, of: &dyn Fn(&WheelSpeedSpec) -> bool| {
            (0..100).all(|seed| of(&drawn(condition, seed, 9000 + seed, false).0))
        };
        assert!(all(Condition::LimitedSlip, &|spec| spec.locking_n >= 300.0));
        assert!(all(Condition::Trailer, &|spec| spec.conditions.trailer_kg >= 400.0 && spec.locking_n == 0.0));
        assert!(all(Condition::Ordinary, &|spec| spec.conditions.snow_share == 0.0));
    }
}
