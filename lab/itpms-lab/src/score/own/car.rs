//! Cars that are drawn about those on the road, and what their owners know of them.
//!
//! Called by the days. The owner knows mass, front share, tire size and placard, each as papers and sidewalls round them; the
//! car is drawn by what published cars scatter by and not by the standard deviations of the file that is made of it.

use itpms_core::model::{Corner, QuarterCar};
use itpms_data::Vehicle;
use itpms_data::vehicle::typical::{CarClass, FrontRear, TireSize, TypicalCar};
use itpms_sim::scenario::{CornerSpec, TireSpec};
use itpms_sim::sensor::SensorSpec;
use itpms_sim::time_profile::Pressure;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::runner::{Result, StudyError};

/// A car on the road: kerb mass in kg, front share, wheelbase in m, tire and placard in kPa (makers' data sheets, rounded).
struct OnTheRoad(f64, f64, f64, [f64; 3], f64);

const CARS: [OnTheRoad; 4] = [
    OnTheRoad(1_270.0, 0.60, 2.64, [205.0, 55.0, 16.0], 230.0), // VW Golf VII 1.4
    OnTheRoad(1_370.0, 0.60, 2.70, [205.0, 55.0, 16.0], 240.0), // Toyota Corolla XII
    OnTheRoad(1_505.0, 0.50, 2.81, [225.0, 50.0, 17.0], 230.0), // BMW 320i F30
    OnTheRoad(1_620.0, 0.58, 2.69, [225.0, 65.0, 17.0], 230.0), // Toyota RAV4 XA50
];

/// Uniform distributions, from the least to the most. Shares of unsprung mass, bounce, damping and friction: the scatter of published
/// cars (docs/vehicle.md, table 1) and struts.
const MASS_OVER_PAPERS: [f64; 2] = [0.97, 1.06];
const FRONT_SHARE_OFF: [f64; 2] = [-0.015, 0.015];
const UNSPRUNG_SHARE: [f64; 2] = [0.105, 0.14];
const UNSPRUNG_FRONT_OVER_REAR: [f64; 2] = [0.92, 1.12];
const BOUNCE_HZ: [f64; 2] = [1.2, 1.5];
const REAR_OVER_FRONT_HZ: [f64; 2] = [1.0, 1.2];
const HIGHEST_BOUNCE_HZ: f64 = 1.7;
const DAMPING_RATIO: [f64; 2] = [0.2, 0.4];
const TIRES: [f64; 2] = [0.92, 1.08];
const TIRE_OF_ITS_OWN: [f64; 2] = [0.985, 1.015];
/// Pressure in kPa whose share the tire's structure has: the measured tires have 85 to 90.
const STRUCTURE_KPA: [f64; 2] = [70.0, 105.0];
const TIRE_DAMPING_N_S_PER_M: [f64; 2] = [20.0, 80.0];
const FRICTION_N: [f64; 2] = [15.0, 80.0];
const FRICTION_OF_ITS_OWN: [f64; 2] = [0.8, 1.2];
const TILT_DEG: [f64; 2] = [-2.0, 2.0];
/// Mild: a spring that is 6 % stiffer 2 cm down, a tire as Pacejka's, a damper twice as hard out as in that halves at 0.5 m/s, all at most.
const SPRING_PROGRESSION_PER_M: [f64; 2] = [0.0, 3.0];
const TIRE_PROGRESSION_PER_M: [f64; 2] = [2.0, 6.0];
const DAMPER_ASYMMETRY: [f64; 2] = [0.0, 0.33];
const DAMPER_DIGRESSION_S_PER_M: [f64; 2] = [0.0, 2.0];
const REAR_OFFSET_M: [f64; 2] = [-0.02, 0.02];
const SENSOR_NOISE_M_S2: f64 = 0.05;

#[derive(Debug, Clone)]
pub(super) struct OwnCar {
    pub(super) file: Vehicle,
    pub(super) corners: [CornerSpec; 4],
    pub(super) wheelbase_m: f64,
    pub(super) rear_offset_m: f64,
    pub(super) placard_kpa: f64,
}

pub(super) struct Source(Pcg64);

impl Source {
    pub(super) fn new(seed: u64) -> Self {
        Self(Pcg64::seed_from_u64(seed))
    }

    pub(super) fn within(&mut self, [least, most]: [f64; 2]) -> f64 {
        least + (most - least) * self.0.random::<f64>()
    }
}

impl OwnCar {
    /// The car of a turn: the four of the list one after the other, each time another one of its kind.
    pub(super) fn draw(index: usize, seed: u64) -> Result<Self> {
        let mut draw = Source::new(seed);
        let OnTheRoad(mass_kg, front_share, wheelbase_m, size, placard_kpa) = CARS[index % CARS.len()];
        let size = TireSize { width_mm: size[0], aspect_percent: size[1], rim_inch: size[2] };
        let known = TypicalCar {
            name: None,
            mass_kg,
            front_share,
            tire: FrontRear::both(size),
            class: CarClass::default(),
            placard_kpa: FrontRear::both(placard_kpa),
            wheelbase_m: None,
            wheels: None,
        };
        let (_, file) = known.vehicle_file()?;
        let mass_kg = mass_kg * draw.within(MASS_OVER_PAPERS);
        let front_share = front_share + draw.within(FRONT_SHARE_OFF);
        let unsprung_kg = 0.25 * mass_kg * draw.within(UNSPRUNG_SHARE);
        let uneven = draw.within(UNSPRUNG_FRONT_OVER_REAR);
        let front_hz = draw.within(BOUNCE_HZ);
        let rear_hz = (front_hz * draw.within(REAR_OVER_FRONT_HZ)).min(HIGHEST_BOUNCE_HZ);
        let tires = draw.within(TIRES);
        let structure_kpa = draw.within(STRUCTURE_KPA);
        let at_placard = size.stiffness_at_zero() + size.stiffness_per_kpa() * placard_kpa;
        let mut axle = |share: f64, unsprung_kg: f64, bounce_hz: f64| {
            let sprung_kg = 0.5 * share * mass_kg - unsprung_kg;
            let w = std::f64::consts::TAU * bounce_hz;
            let ratio = draw.within(DAMPING_RATIO);
            let quarter =
                QuarterCar::new(sprung_kg, unsprung_kg, 2.0 * ratio * w * sprung_kg, w * w * sprung_kg)?;
            let friction_n = draw.within(FRICTION_N);
            let axle = Axle {
                quarter,
                friction_n,
                per_kpa: tires * at_placard / (placard_kpa + structure_kpa),
                structure_kpa,
                placard_kpa,
                spring_progression_per_m: draw.within(SPRING_PROGRESSION_PER_M),
                damper: [draw.within(DAMPER_ASYMMETRY), draw.within(DAMPER_DIGRESSION_S_PER_M)],
            };
            Ok::<_, StudyError>([axle.corner(&mut draw), axle.corner(&mut draw)])
        };
        // Twice the mean, parted as one to the other.
        let rear_kg = 2.0 * unsprung_kg / (1.0 + uneven);
        let [fl, fr] = axle(front_share, uneven * rear_kg, front_hz)?;
        let [rl, rr] = axle(1.0 - front_share, rear_kg, rear_hz)?;
        let rear_offset_m = draw.within(REAR_OFFSET_M);
        Ok(Self { file, corners: [fl, fr, rl, rr], wheelbase_m, rear_offset_m, placard_kpa })
    }

    pub(super) fn corner(&self, corner: Corner) -> &CornerSpec {
        &self.corners[corner.index()]
    }
}

struct Axle {
    quarter: QuarterCar<f64>,
    friction_n: f64,
    per_kpa: f64,
    structure_kpa: f64,
    placard_kpa: f64,
    spring_progression_per_m: f64,
    damper: [f64; 2],
}

impl Axle {
    fn corner(&self, draw: &mut Source) -> CornerSpec {
        let mut spec = CornerSpec::paper(Pressure::ConstantKpa(self.placard_kpa));
        spec.sprung_mass_kg = self.quarter.sprung_mass_kg();
        spec.unsprung_mass_kg = self.quarter.unsprung_mass_kg();
        spec.damping_n_s_per_m = self.quarter.damping_n_s_per_m();
        spec.spring_n_per_m = self.quarter.spring_n_per_m();
        spec.placard_kpa = self.placard_kpa;
        spec.tire = TireSpec {
            stiffness_per_kpa: self.per_kpa,
            stiffness_at_zero: self.per_kpa * self.structure_kpa,
        };
        let truth = &mut spec.truth;
        truth.tire_stiffness_factor = draw.within(TIRE_OF_ITS_OWN);
        truth.friction_n = self.friction_n * draw.within(FRICTION_OF_ITS_OWN);
        truth.tire_damping_n_s_per_m = draw.within(TIRE_DAMPING_N_S_PER_M);
        truth.tire_progression_per_m = draw.within(TIRE_PROGRESSION_PER_M);
        truth.spring_progression_per_m = self.spring_progression_per_m;
        [truth.damper_asymmetry, truth.damper_digression_s_per_m] = self.damper;
        let mut tilted = || {
            Some(SensorSpec { tilt_deg: draw.within(TILT_DEG), ..SensorSpec::with_noise(SENSOR_NOISE_M_S2) })
        };
        (spec.body_sensor, spec.wheel_sensor) = (tilted(), tilted());
        spec
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cars_are_within_what_they_are_drawn_from() {
        for seed in 0..200 {
            let car = OwnCar::draw(seed as usize, seed).unwrap();
            let configured = car.file.car_config(&Corner::ALL);
            let mut unsprung = 0.0;
            let mut whole = 0.0;
            for corner in Corner::ALL {
                let spec = car.corner(corner);
                unsprung += spec.unsprung_mass_kg;
                whole += spec.sprung_mass_kg + spec.unsprung_mass_kg;
                let w = (spec.spring_n_per_m / spec.sprung_mass_kg).sqrt();
                let (hz, ratio) =
                    (w / std::f64::consts::TAU, spec.damping_n_s_per_m / (2.0 * w * spec.sprung_mass_kg));
                assert!(
                    (1.2 - 1e-9..=1.7 + 1e-9).contains(&hz) && (0.2 - 1e-9..=0.4 + 1e-9).contains(&ratio)
                );
                assert!((15.0 * 0.8..=80.0 * 1.2).contains(&spec.truth.friction_n));
                // 8 % of the make and 1.5 of its own about what the size says, which is what the file says.
                let tire = spec.tire.map().unwrap().stiffness_n_per_m(car.placard_kpa)
                    * spec.truth.tire_stiffness_factor;
                let file = &configured.corners[corner.index()].as_ref().unwrap().tire;
                let off = tire / file.stiffness_n_per_m(car.placard_kpa);
                assert!((0.92 * 0.985 - 1e-3..=1.08 * 1.015 + 1e-3).contains(&off), "{off}");
            }
            assert!((0.105 - 1e-9..=0.14 + 1e-9).contains(&(unsprung / whole)), "{}", unsprung / whole);
        }
    }
}
