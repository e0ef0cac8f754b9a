//! Loads, forces and ways of the four wheels; `docs/math/simulation.md`, eq. 14-16.
//!
//! Called by the run. Knows no tire but by its slip stiffness.

use super::spec::DrivenWheels;
use crate::car::CarSpec;

pub(crate) const GRAVITY_M_S2: f64 = 9.81;
/// Share of the roll moment that the front axle carries.
const FRONT_ROLL_SHARE: f64 = 0.55;
/// Drag per squared air speed in N s²/m², rolling resistance over load.
const DRAG_N_S2_PER_M2: f64 = 0.4;
const ROLLING: f64 = 0.011;
/// Force of a wind across per product of speed and wind, in N s²/m²: a car's side at small angles, on its body's center.
const SIDE_N_S2_PER_M2: f64 = 3.2;
/// Where a trailer pulls: m behind the rear axle, and over the road.
const HITCH_BEHIND_M: f64 = 1.0;
const HITCH_HEIGHT_M: f64 = 0.4;
/// Deceleration by the engine without fuel in m/s²; more is braked.
const ENGINE_M_S2: f64 = 0.25;
/// Share of the brakes' force that is in front.
const FRONT_BRAKES: f64 = 0.7;
/// Slip angle in rad of the front axle per m/s² across.
const FRONT_SLIP_RAD_PER_M_S2: f64 = 0.0045;
/// Steps in which an axle's share is found.
const SHARING_STEPS: u32 = 5;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Chassis {
    pub(crate) wheelbase_m: f64,
    pub(crate) tracks_m: [f64; 2],
    pub(crate) height_m: f64,
    pub(crate) rear_slip_rad_per_m_s2: f64,
    pub(crate) driven: DrivenWheels,
    pub(crate) locking_n: f64,
    pub(crate) locking_share: f64,
    /// How far the front wheels are steered each about the turn's center.
    pub(crate) ackermann: f64,
    pub(crate) trailer: Trailer,
    /// Static loads in N of the unloaded car.
    pub(crate) static_n: [f64; 4],
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Trailer {
    /// Mass in kg on its own wheels, and on the hitch.
    pub(crate) rolling_kg: f64,
    pub(crate) tongue_kg: f64,
    pub(crate) drag_n_s2_per_m2: f64,
}

impl Trailer {
    /// Force in N with which the car pulls it.
    pub(crate) fn pull_n(&self, moving: &Moving) -> f64 {
        let air_m_s = moving.speed_m_s + moving.wind_m_s;
        let weight_n = GRAVITY_M_S2 * self.rolling_kg;
        self.rolling_kg * moving.accel_m_s2[0]
            + weight_n * (moving.grade + if moving.speed_m_s > 0.0 { ROLLING } else { 0.0 })
            + self.drag_n_s2_per_m2 * air_m_s * air_m_s.abs()
    }
}

/// How the car moves at an instant.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Moving {
    pub(crate) speed_m_s: f64,
    pub(crate) accel_m_s2: [f64; 2],
    pub(crate) grade: f64,
    /// The road falls to the right.
    pub(crate) cross_slope: f64,
    pub(crate) wind_m_s: f64,
    pub(crate) side_wind_m_s: f64,
    /// Rolling resistance over load under the wheels of each side, beside that of a dry road.
    pub(crate) rolling: [f64; 2],
}

impl Moving {
    /// At a speed on a flat road.
    #[cfg(test)]
    pub(crate) fn still(speed_m_s: f64) -> Self {
        Self { speed_m_s, ..Self::default() }
    }

    pub(crate) fn side_n(&self) -> f64 {
        SIDE_N_S2_PER_M2 * self.speed_m_s * self.side_wind_m_s
    }
}

/// Longitudinal forces of the wheels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Forces {
    pub(crate) engine_n: [f64; 2],
    /// Of each brake, in N, not above 0.
    pub(crate) brake_n: [f64; 4],
}

impl Chassis {
    pub(crate) fn new(
        spec: &super::WheelSpeedSpec,
        car: &CarSpec,
        wheelbase_m: f64,
        static_n: [f64; 4],
    ) -> Self {
        Self {
            wheelbase_m,
            tracks_m: [car.track_front_m, car.track_rear_m],
            height_m: car.cg_height_m,
            rear_slip_rad_per_m_s2: car.rear_slip_rad_per_m_s2,
            driven: spec.driven,
            locking_n: spec.locking_n,
            locking_share: spec.locking_share,
            ackermann: spec.conditions.ackermann,
            trailer: Trailer {
                rolling_kg: (1.0 - spec.conditions.tongue_share) * spec.conditions.trailer_kg,
                tongue_kg: spec.conditions.tongue_share * spec.conditions.trailer_kg,
                drag_n_s2_per_m2: spec.conditions.trailer_drag_n_s2_per_m2,
            },
            static_n,
        }
    }

    /// Loads of the wheels in N with these masses `[kg, m behind the front axle, m to the left]` in the car.
    pub(crate) fn loads_n(&self, moving: &Moving, payload: impl Iterator<Item = [f64; 3]>) -> [f64; 4] {
        let mut loads_n = self.static_n;
        for [kg, behind_m, left_m] in payload {
            let rear = behind_m / self.wheelbase_m;
            for (i, load_n) in loads_n.iter_mut().enumerate() {
                let axle = if i < 2 { 1.0 - rear } else { rear };
                let side = left_m / self.tracks_m[i / 2];
                *load_n += kg * GRAVITY_M_S2 * axle * (if i % 2 == 0 { 0.5 + side } else { 0.5 - side });
            }
        }
        let mass_kg = loads_n.iter().sum::<f64>() / GRAVITY_M_S2;
        let [along, across] = moving.accel_m_s2;
        let [hitched_front_n, hitched_rear_n] = self.hitched_n(moving);
        let pitch_n =
            0.5 * mass_kg * self.height_m * (along + GRAVITY_M_S2 * moving.grade) / self.wheelbase_m;
        // A wind to the left acts where the body's inertia does and presses on the left wheels.
        let roll_n_m = mass_kg * self.height_m * (across + GRAVITY_M_S2 * moving.cross_slope)
            - self.height_m * moving.side_n();
        for (i, load_n) in loads_n.iter_mut().enumerate() {
            let (share, to_rear) =
                if i < 2 { (FRONT_ROLL_SHARE, -1.0) } else { (1.0 - FRONT_ROLL_SHARE, 1.0) };
            let to_right = if i % 2 == 0 { -1.0 } else { 1.0 };
            *load_n += 0.5 * if i < 2 { hitched_front_n } else { hitched_rear_n };
            *load_n += to_rear * pitch_n + to_right * share * roll_n_m / self.tracks_m[i / 2];
            // A wheel that nearly lifts still rolls.
            *load_n = load_n.max(0.05 * self.static_n[i]);
        }
        loads_n
    }

    /// A trailer's load on the front and the rear axle in N: its tongue behind the rear axle, its pull above the road.
    fn hitched_n(&self, moving: &Moving) -> [f64; 2] {
        let tongue_n = GRAVITY_M_S2 * self.trailer.tongue_kg;
        let moved_n =
            (tongue_n * HITCH_BEHIND_M + self.trailer.pull_n(moving) * HITCH_HEIGHT_M) / self.wheelbase_m;
        [-moved_n, tongue_n + moved_n]
    }

    /// Forces that move the car so; `brakes`: each brake's share of half its axle's braking.
    pub(crate) fn forces_n(&self, moving: &Moving, loads_n: &[f64; 4], brakes: &[f64; 4]) -> Forces {
        let mass_kg = loads_n.iter().sum::<f64>() / GRAVITY_M_S2;
        let air_m_s = moving.speed_m_s + moving.wind_m_s;
        let front = match self.driven {
            DrivenWheels::Front => 1.0,
            DrivenWheels::Rear => 0.0,
            DrivenWheels::All => 0.5,
        };
        // Wheels that nothing turns are pushed over the road by the others.
        let [fl, fr, rl, rr] = loads_n;
        let pushed_n = if self.driven == DrivenWheels::All {
            0.0
        } else {
            (fl + fr) * (1.0 - front) + (rl + rr) * front
        };
        let wanted_n = mass_kg * (moving.accel_m_s2[0] + GRAVITY_M_S2 * moving.grade)
            + DRAG_N_S2_PER_M2 * air_m_s * air_m_s.abs()
            + ROLLING * pushed_n
            + moving.rolling[0] * (fl + rl)
            + moving.rolling[1] * (fr + rr)
            + self.trailer.pull_n(moving);
        let engine_n = wanted_n.max(-ENGINE_M_S2 * mass_kg);
        let braked_n = wanted_n - engine_n;
        let brake = |i: usize| {
            let axle = if i < 2 { FRONT_BRAKES } else { 1.0 - FRONT_BRAKES };
            0.5 * axle * brakes[i] * braked_n
        };
        Forces {
            engine_n: [front * engine_n, (1.0 - front) * engine_n],
            brake_n: [brake(0), brake(1), brake(2), brake(3)],
        }
    }

    /// How the engine's force on an axle is shared by its wheels. `free`: `ln` of the left over the right wheel's speed without
    /// force; `slips`: those of the left and the right tire under a force in N, with stiffnesses near zero in N. A differential
    /// that locks keeps both turning alike as far as it can.
    pub(crate) fn shared_n(
        &self,
        engine_n: f64,
        free: f64,
        stiffness_n: [f64; 2],
        slips: impl Fn([f64; 2]) -> [f64; 2],
    ) -> [f64; 2] {
        let half = 0.5 * engine_n;
        let can_n = 0.5 * (self.locking_n + self.locking_share * engine_n.abs());
        let split = |moved_n: f64| [half - moved_n, half + moved_n];
        let mut moved_n = 0.0;
        if can_n > 0.0 {
            // Newton's steps with the slope at zero force, which slips leave by some percent.
            let per_n = 1.0 / stiffness_n[0] + 1.0 / stiffness_n[1];
            for _ in 0..SHARING_STEPS {
                let [left, right] = slips(split(moved_n));
                let apart = free + left.ln_1p() - right.ln_1p();
                moved_n = (moved_n + apart / per_n).clamp(-can_n, can_n);
            }
        }
        split(moved_n)
    }

    /// Speeds of the wheels' centers along their planes, over the car's, at a yaw rate over the speed.
    ///
    /// The car's speed is that of the rear axle's middle along the car. Axles drift outwards, and the front wheels point
    /// their slip angle further in than they go. `lateral_m_s2`: the tires' force across over the mass.
    pub(crate) fn ways(&self, curvature_per_m: f64, lateral_m_s2: f64) -> [f64; 4] {
        let drift = -self.rear_slip_rad_per_m_s2 * lateral_m_s2;
        let across = drift + self.wheelbase_m * curvature_per_m;
        // Direction of the front axle's middle, and of its wheels.
        let middle = across.atan();
        let steered = middle + FRONT_SLIP_RAD_PER_M_S2 * lateral_m_s2;
        let along = |i: usize| {
            let left_m = 0.5 * self.tracks_m[i / 2] * (if i.is_multiple_of(2) { 1.0 } else { -1.0 });
            1.0 - left_m * curvature_per_m
        };
        let front = |i: usize| {
            // Fully steered about the turn's center a wheel points where its hub goes, but for its slip angle.
            let own = if self.ackermann > 0.0 { across.atan2(along(i)) - middle } else { 0.0 };
            let (sin, cos) = (steered + self.ackermann * own).sin_cos();
            along(i) * cos + across * sin
        };
        [front(0), front(1), along(2), along(3)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::tire::{DRY_FRICTION, slip};
    use super::*;

    fn chassis() -> Chassis {
        Chassis {
            wheelbase_m: 2.7,
            tracks_m: [1.56, 1.5],
            height_m: 0.55,
            rear_slip_rad_per_m_s2: 0.004,
            driven: DrivenWheels::Front,
            locking_n: 0.0,
            locking_share: 0.0,
            ackermann: 0.0,
            trailer: Trailer { rolling_kg: 0.0, tongue_kg: 0.0, drag_n_s2_per_m2: 0.0 },
            static_n: [3000.0, 3000.0, 2500.0, 2500.0],
        }
    }

    fn coasting(speed_m_s: f64) -> Moving {
        Moving::still(speed_m_s)
    }

    #[test]
    fn wheels_go_round_a_bend_on_their_circles() {
        let car = chassis();
        assert_eq!(car.ways(0.0, 0.0), [1.0; 4]);
        // Slowly, without slip angles: rear wheels on R -+ t/2, front ones on the hypotenuse with L.
        let radius = 40.0;
        let [fl, fr, rl, rr] = car.ways(1.0 / radius, 0.0);
        assert!((rl - (1.0 - 0.75 / radius)).abs() < 1e-12 && (rr - (1.0 + 0.75 / radius)).abs() < 1e-12);
        let exact = |side: f64| ((radius - side * 0.78).hypot(2.7)) / radius;
        // Both front wheels are steered like the middle one: second order in t L / R².
        assert!((fl - exact(1.0)).abs() < 5e-5 && (fr - exact(-1.0)).abs() < 5e-5, "{fl} {fr}");
        // Fast the axles drift: the front axle's way over the rear one's is not (L/R)²/2 any more.
        let (curvature, lateral) = (2.0 / 900.0, 2.0);
        let [fl, fr, rl, rr] = car.ways(curvature, lateral);
        let across: f64 = 2.7 * curvature - 0.008;
        let expected = 0.5 * across * across - 0.5 * 0.009f64.powi(2);
        assert!((0.5 * (fl + fr) - 0.5 * (rl + rr) - expected).abs() < 1e-6);
    }

    #[test]
    fn loads_carry_the_car_and_hold_its_moments() {
        let car = chassis();
        let moving = Moving { accel_m_s2: [1.0, 2.0], grade: 0.03, cross_slope: -0.02, ..coasting(20.0) };
        let [fl, fr, rl, rr] = car.loads_n(&moving, [[100.0, 2.0, 0.3]].into_iter());
        let mass_kg = 11_000.0 / GRAVITY_M_S2 + 100.0;
        assert!((fl + fr + rl + rr - mass_kg * GRAVITY_M_S2).abs() < 1e-9);
        // About the front axle; and about the middle, to the left.
        let pitch = 5000.0 * 2.7 + 981.0 * 2.0 + 0.55 * mass_kg * (1.0 + 0.03 * GRAVITY_M_S2);
        assert!(((rl + rr) * 2.7 - pitch).abs() < 1e-9);
        let roll = 981.0 * 0.3 - 0.55 * mass_kg * (2.0 - 0.02 * GRAVITY_M_S2);
        assert!(((fl - fr) * 0.78 + (rl - rr) * 0.75 - roll).abs() < 1e-9);
    }

    #[test]
    fn forces_move_the_car() {
        let car = chassis();
        let loads_n = car.static_n;
        let uphill = Moving { accel_m_s2: [0.5, 0.0], grade: 0.02, wind_m_s: 3.0, ..coasting(22.0) };
        let forces = car.forces_n(&uphill, &loads_n, &[1.0; 4]);
        let needed = 11_000.0 / 9.81 * (0.5 + 9.81 * 0.02) + 0.4 * 625.0 + 0.011 * 5000.0;
        assert!((forces.engine_n[0] - needed).abs() < 1e-9 && forces.engine_n[1] == 0.0);
        assert!(forces.brake_n == [0.0; 4]);
        let braking = Moving { accel_m_s2: [-3.0, 0.0], ..coasting(22.0) };
        let forces = car.forces_n(&braking, &loads_n, &[1.1, 0.9, 1.0, 1.0]);
        let all = forces.engine_n[0] + forces.brake_n.iter().sum::<f64>();
        let needed = -3.0 * 11_000.0 / 9.81 + 0.4 * 484.0 + 0.011 * 5000.0;
        assert!((all - needed).abs() < 1e-9 && (forces.engine_n[0] + 0.25 * 11_000.0 / 9.81).abs() < 1e-9);
        assert!((forces.brake_n[0] / forces.brake_n[1] - 1.1 / 0.9).abs() < 1e-12);
    }

    #[test]
    fn an_open_differential_halves_and_a_locked_one_turns_both_alike() {
        let stiffness_n = [150_000.0, 170_000.0];
        let slips =
            |forces_n: [f64; 2]| [0, 1].map(|i| slip(forces_n[i], 3000.0, stiffness_n[i], DRY_FRICTION));
        let shared = |car: Chassis| car.shared_n(800.0, 2e-3, stiffness_n, slips);
        assert_eq!(shared(chassis()), [400.0, 400.0]);
        // The left wheel would run ahead by 2e-3: slips make up for it, and the sum stays.
        let forces_n = shared(Chassis { locking_n: 1e5, ..chassis() });
        let [left, right] = slips(forces_n);
        assert!((2e-3 + left.ln_1p() - right.ln_1p()).abs() < 1e-6, "{left} {right}");
        assert!((forces_n[0] + forces_n[1] - 800.0).abs() < 1e-9);
        assert_eq!(shared(Chassis { locking_share: 0.1, ..chassis() }), [360.0, 440.0]);
    }

    #[test]
    fn a_junction_is_driven_on_circles_about_one_center() {
        // 12 m, at 6 m/s 3 m/s²: with each front wheel steered about the center, and no slip angles, all four speeds are as the
        // wheels' distances from it.
        let car = Chassis { ackermann: 1.0, rear_slip_rad_per_m_s2: 0.0, ..chassis() };
        let radius = 12.0f64;
        let ways = car.ways(1.0 / radius, 0.0);
        let from_center =
            [(radius - 0.78).hypot(2.7), (radius + 0.78).hypot(2.7), radius - 0.75, radius + 0.75];
        for (way, distance) in ways.iter().zip(from_center) {
            assert!((way - distance / radius).abs() < 1e-12, "{ways:?}");
        }
        // With slip angles a wheel rolls by their cosine less.
        let lateral = 3.0;
        let slipping = car.ways(1.0 / radius, lateral);
        let cos = (FRONT_SLIP_RAD_PER_M_S2 * lateral).cos();
        assert!((slipping[0] / ways[0] - cos).abs() < 1e-12 && (slipping[1] / ways[1] - cos).abs() < 1e-12);
        // Parallel wheels lose the cosine of the angle between wheel and path: some 1e-3.
        let parallel = Chassis { ackermann: 0.0, ..car }.ways(1.0 / radius, 0.0);
        assert!((1e-4..3e-3).contains(&(1.0 - parallel[0] / ways[0])), "{}", parallel[0] / ways[0]);
    }

    #[test]
    fn banks_and_wind_move_loads_without_a_bend() {
        let car = chassis();
        let loads = |moving: &Moving| car.loads_n(moving, std::iter::empty());
        let moment = |[fl, fr, rl, rr]: [f64; 4]| (fr - fl) * 0.78 + (rr - rl) * 0.75;
        // m g chi h, 55 % of it in front.
        let banked = loads(&Moving { cross_slope: 0.04, ..coasting(20.0) });
        assert!((moment(banked) - 0.55 * 11_000.0 * 0.04).abs() < 1e-9);
        assert!(((banked[1] - banked[0]) - 0.55 * 0.55 * 11_000.0 * 0.04 / 0.78 / 2.0 * 2.0).abs() < 1e-9);
        // A bank of a_y / g leaves nothing of a bend.
        let bend = Moving { accel_m_s2: [0.0, 0.5], cross_slope: -0.5 / GRAVITY_M_S2, ..coasting(20.0) };
        assert!(moment(loads(&bend)).abs() < 1e-9);
        // 6 m/s to the left at 30 m/s: 3.2 x 180 N at .55 m.
        let windy = loads(&Moving { side_wind_m_s: 6.0, ..coasting(30.0) });
        assert!((moment(windy) + 0.55 * 3.2 * 180.0).abs() < 1e-9);
    }

    #[test]
    fn a_trailer_is_pulled_and_rests_on_the_rear_axle() {
        let trailer = Trailer { rolling_kg: 940.0, tongue_kg: 60.0, drag_n_s2_per_m2: 0.6 };
        let (car, alone) = (Chassis { trailer, ..chassis() }, chassis());
        let moving = Moving { accel_m_s2: [0.4, 0.0], grade: 0.03, ..coasting(25.0) };
        let pull_n = 940.0 * (0.4 + GRAVITY_M_S2 * (0.03 + 0.011)) + 0.6 * 625.0;
        assert!((car.trailer.pull_n(&moving) - pull_n).abs() < 1e-9);
        let (with, without) =
            (car.loads_n(&moving, std::iter::empty()), alone.loads_n(&moving, std::iter::empty()));
        // The tongue's weight in all, and moments about the rear axle.
        let tongue_n = 60.0 * GRAVITY_M_S2;
        assert!((with.iter().sum::<f64>() - without.iter().sum::<f64>() - tongue_n).abs() < 1e-9);
        let front = with[0] + with[1] - without[0] - without[1];
        assert!((front * 2.7 + tongue_n + 0.4 * pull_n).abs() < 1e-9);
        // The engine pulls it, and the tongue's mass with the car's.
        let (with, without) = [(&car, with), (&alone, without)]
            .map(|(car, loads)| car.forces_n(&moving, &loads, &[1.0; 4]))
            .into();
        let more_n = with.engine_n[0] - without.engine_n[0];
        let expected = pull_n + 60.0 * (0.4 + GRAVITY_M_S2 * 0.03) + 0.011 * (tongue_n - front);
        assert!((more_n - expected).abs() < 1e-9, "{more_n} {expected}");
    }

    #[test]
    fn a_preload_turns_both_wheels_alike_down_to_a_radius() {
        // Wheels of 150 kN slip apart by dX/C each: t/R = locking / C, so R = t C / locking = 400 m for 581 N.
        let stiffness_n = [150_000.0; 2];
        let slips = |forces_n: [f64; 2]| forces_n.map(|n| n / 150_000.0);
        let car = Chassis { locking_n: 1.55 * 150_000.0 / 400.0, ..chassis() };
        let apart = |radius_m: f64| {
            let free = ((radius_m - 0.775) / (radius_m + 0.775)).ln();
            let [left, right] = slips(car.shared_n(0.0, free, stiffness_n, slips));
            free + left.ln_1p() - right.ln_1p()
        };
        assert!(apart(410.0).abs() < 1e-6 && apart(-450.0).abs() < 1e-6);
        // Tighter the rest is left: 1.55 (1/200 - 1/400).
        assert!((apart(200.0) + 1.55 / 400.0).abs() < 2e-5, "{}", apart(200.0));
    }
}
