//! How one car differs from another: its tires, brakes and sensors, drawn from a seed.
//!
//! Called when a run begins.

use std::f64::consts::TAU;

use rand::RngExt;

use super::disturbance::normal;
use super::spec::WheelSpeedSpec;
use super::tire::Tire;
use crate::scenario::CornerSpec;
use crate::streams::{Purpose, generator};

/// Spreads among the tires of a car, as shares: radius over pressure and load, growth, slip stiffness.
const TIRE_SPREAD: f64 = 0.1;
const GROWTH_SPREAD: f64 = 0.05;
const SLIP_SPREAD: f64 = 0.1;
/// Speed that swings with each turn of a wheel, as a share: it is not quite round, nor its teeth evenly spaced.
const OUT_OF_ROUND: f64 = 2e-4;
/// Offsets of the sensors: yaw rate in rad/s, accelerations in m/s².
const YAW_OFFSET_RAD_S: f64 = 5e-3;
const ACCEL_OFFSET_M_S2: f64 = 0.05;

/// Parameters of a seed's car.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drawn {
    pub(crate) tires: [Tire; 4],
    /// Force of each brake over what it should be.
    pub(crate) brakes: [f64; 4],
    /// Amplitude and phase of the line that turns with each wheel.
    pub(crate) out_of_round: [[f64; 2]; 4],
    pub(crate) yaw_offset_rad_s: f64,
    pub(crate) accel_offset_m_s2: [f64; 2],
    /// What each tread loses over what it should.
    pub(crate) wear: [f64; 4],
}

impl Drawn {
    pub(crate) fn new(
        spec: &WheelSpeedSpec,
        corners: [&CornerSpec; 4],
        static_n: [f64; 4],
        seed: u64,
    ) -> Self {
        let mut random = generator(spec.car_seed.unwrap_or(seed), Purpose::WheelCar, [0, 0]);
        let slip = 1.0 + SLIP_SPREAD * normal(&mut random);
        let mut number = 0;
        let near_one = |spread: f64, random: &mut _| (1.0 + spread * normal(random)).clamp(0.5, 1.5);
        let tires = corners.map(|corner| {
            let at_placard =
                corner.tire.stiffness_at_zero + corner.tire.stiffness_per_kpa * corner.placard_kpa;
            let tire = Tire {
                ln_radius: spec.radius_sd * normal(&mut random) + spec.radius_offsets[number].ln_1p(),
                per_ln_pressure: spec.radius_per_ln_pressure * near_one(TIRE_SPREAD, &mut random),
                per_ln_load: spec.radius_per_ln_load * near_one(TIRE_SPREAD, &mut random),
                growth: near_one(GROWTH_SPREAD, &mut random),
                slip_stiffness_per_load: spec.slip_stiffness_per_load
                    * slip.clamp(0.5, 1.5)
                    * near_one(0.3 * SLIP_SPREAD, &mut random),
                slip_load_loss: spec.conditions.slip_load_loss,
                usual_n: static_n[number],
                stiffness_per_kpa: corner.tire.stiffness_per_kpa / at_placard,
                stiffness_at_zero: corner.tire.stiffness_at_zero / at_placard,
                placard_kpa: corner.placard_kpa,
            };
            number += 1;
            tire
        });
        let brakes = [(); 4].map(|()| near_one(spec.brake_imbalance, &mut random));
        let out_of_round =
            [(); 4].map(|()| [OUT_OF_ROUND * normal(&mut random), TAU * random.random::<f64>()]);
        let offsets = (
            YAW_OFFSET_RAD_S * normal(&mut random),
            [(); 2].map(|()| ACCEL_OFFSET_M_S2 * normal(&mut random)),
        );
        Self {
            tires,
            brakes,
            out_of_round,
            yaw_offset_rad_s: offsets.0,
            accel_offset_m_s2: offsets.1,
            // After all that was drawn before there was wear.
            wear: [(); 4].map(|()| near_one(spec.conditions.wear_spread, &mut random)),
        }
    }
}
