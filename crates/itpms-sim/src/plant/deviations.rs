//! How a true corner differs from what its estimator is given.
//!
//! Part of a scenario; the plants turn it into parameters.

use itpms_core::model::{ParameterError, QuarterCar};
use serde::{Deserialize, Serialize};

use crate::error::{InvalidValue, Result, not_negative, within};

/// How the true corner differs from what its estimator is given, as written in a scenario.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Deviations {
    pub sprung_mass_factor: f64,
    pub unsprung_mass_factor: f64,
    pub damping_factor: f64,
    /// True suspension spring over the file's.
    pub spring_factor: f64,
    /// True tire stiffness over what the file's pressure map gives: a worn tire is softer or harder than a new one.
    pub tire_stiffness_factor: f64,
    /// Damping of the tire in N s/m, which no estimator here models.
    pub tire_damping_n_s_per_m: f64,
    /// How fast the tire hardens in compression (and softens in extension), in 1/m: its slope is `k exp(p x)` about the unloaded car at
    /// rest. A 205/60R15 has 6 (Pacejka, *Tyre and Vehicle Dynamics*, 3rd ed., app. 3: `qFz1`, `qFz2` at 20 mm).
    pub tire_progression_per_m: f64,
    /// Share by which the damper is harder in rebound and softer in bump, -1 to 1.
    pub damper_asymmetry: f64,
    /// How fast the damper's slope falls with its speed, in s/m: its force is `c v / (1 + d |v|)`.
    pub damper_digression_s_per_m: f64,
    /// How fast the spring hardens in compression (and softens in extension), in 1/m: its slope is `k exp(p x)`.
    pub spring_progression_per_m: f64,
    pub friction_n: f64,
    /// Ways in m over which the friction's three elements begin to slide.
    pub friction_presliding_m: [f64; 3],
    /// Parts of the friction that the elements have, in any unit: only their ratios count.
    pub friction_shares: [f64; 3],
    /// Friction at standstill over friction when sliding.
    pub friction_breakaway_factor: f64,
    /// Speed in m/s over which friction falls from the one to the other.
    pub friction_stribeck_m_s: f64,
    /// Stiffness in N/m of the mount between damper and body; 0: none, the damper is bolted on.
    pub damper_mount_n_per_m: f64,
    /// Mass in kg of a wheel-hop damper, a tuned mass on the unsprung one; 0: none. Only the full car has them.
    pub hop_damper_kg: f64,
    /// Its frequency in Hz on a wheel that stands still.
    pub hop_damper_hz: f64,
    pub hop_damper_ratio: f64,
    /// Deflection of the tire in m at which the rim bears on the road; 0: never.
    pub rim_deflection_m: f64,
    pub rim_stiffness_n_per_m: f64,
    /// Mass times radius of the wheel's imbalance in kg m. Only the full car has turning wheels.
    pub imbalance_kg_m: f64,
    /// Distance in m per radian that the wheel turns.
    pub rolling_radius_m: f64,
}

impl Default for Deviations {
    fn default() -> Self {
        Self {
            sprung_mass_factor: 1.0,
            unsprung_mass_factor: 1.0,
            damping_factor: 1.0,
            spring_factor: 1.0,
            tire_stiffness_factor: 1.0,
            tire_damping_n_s_per_m: 0.0,
            tire_progression_per_m: 0.0,
            damper_asymmetry: 0.0,
            damper_digression_s_per_m: 0.0,
            spring_progression_per_m: 0.0,
            friction_n: 0.0,
            friction_presliding_m: [1e-4, 3e-4, 1e-3],
            friction_shares: [1.0; 3],
            friction_breakaway_factor: 1.0,
            friction_stribeck_m_s: 0.01,
            damper_mount_n_per_m: 0.0,
            hop_damper_kg: 0.0,
            hop_damper_hz: 11.0,
            hop_damper_ratio: 0.15,
            rim_deflection_m: 0.0,
            rim_stiffness_n_per_m: 400_000.0,
            imbalance_kg_m: 0.0,
            rolling_radius_m: 0.31,
        }
    }
}

impl Deviations {
    pub(crate) fn validate(&self) -> Result<()> {
        for (name, factor) in [
            ("sprung_mass_factor", self.sprung_mass_factor),
            ("unsprung_mass_factor", self.unsprung_mass_factor),
            ("damping_factor", self.damping_factor),
            ("spring_factor", self.spring_factor),
            ("tire_stiffness_factor", self.tire_stiffness_factor),
        ] {
            within(name, factor, 0.1, 10.0, "a factor from 0.1 to 10")?;
        }
        let damping = self.tire_damping_n_s_per_m;
        within("tire_damping_n_s_per_m", damping, 0.0, 5000.0, "a damping from 0 to 5000 N s/m")?;
        within("damper_asymmetry", self.damper_asymmetry, -1.0, 1.0, "a share from -1 to 1")?;
        within("damper_digression_s_per_m", self.damper_digression_s_per_m, 0.0, 50.0, "from 0 to 50 s/m")?;
        within("spring_progression_per_m", self.spring_progression_per_m, 0.0, 20.0, "from 0 to 20 per m")?;
        within("tire_progression_per_m", self.tire_progression_per_m, 0.0, 30.0, "from 0 to 30 per m")?;
        self.validate_friction()?;
        self.validate_parts()?;
        within("imbalance_kg_m", self.imbalance_kg_m, 0.0, 1.0, "from 0 to 1 kg m")?;
        within("rolling_radius_m", self.rolling_radius_m, 0.1, 1.0, "a radius from 0.1 to 1 m")
    }

    fn validate_parts(&self) -> Result<()> {
        let mount_n_per_m = self.damper_mount_n_per_m;
        if mount_n_per_m != 0.0 {
            within("damper_mount_n_per_m", mount_n_per_m, 1e4, 1e8, "0, or from 10000 to 100000000 N/m")?;
        }
        within("hop_damper_kg", self.hop_damper_kg, 0.0, 50.0, "a mass from 0 to 50 kg")?;
        within("hop_damper_hz", self.hop_damper_hz, 1.0, 100.0, "a frequency from 1 to 100 Hz")?;
        within("hop_damper_ratio", self.hop_damper_ratio, 0.0, 2.0, "a ratio from 0 to 2")?;
        within("rim_deflection_m", self.rim_deflection_m, 0.0, 0.5, "a deflection from 0 to 0.5 m")?;
        let rim = "a stiffness from 10000 to 5000000 N/m";
        within("rim_stiffness_n_per_m", self.rim_stiffness_n_per_m, 1e4, 5e6, rim)
    }

    fn validate_friction(&self) -> Result<()> {
        not_negative("friction_n", self.friction_n)?;
        for distance_m in self.friction_presliding_m {
            within("friction_presliding_m", distance_m, 1e-5, 0.05, "distances from 0.00001 to 0.05 m")?;
        }
        for share in self.friction_shares {
            within("friction_shares", share, 0.0, 1e6, "parts from 0 to 1000000")?;
        }
        if !(self.friction_shares.iter().sum::<f64>() > 0.0) {
            return Err(InvalidValue::new("friction_shares", "0 throughout", "at least one part above 0"));
        }
        let factor = "a factor from 1 to 5";
        within("friction_breakaway_factor", self.friction_breakaway_factor, 1.0, 5.0, factor)?;
        within("friction_stribeck_m_s", self.friction_stribeck_m_s, 1e-3, 1.0, "a speed from 0.001 to 1 m/s")
    }

    pub(crate) fn applied_to(&self, nominal: &QuarterCar<f64>) -> Result<QuarterCar<f64>, ParameterError> {
        QuarterCar::new(
            nominal.sprung_mass_kg() * self.sprung_mass_factor,
            nominal.unsprung_mass_kg() * self.unsprung_mass_factor,
            nominal.damping_n_s_per_m() * self.damping_factor,
            nominal.spring_n_per_m() * self.spring_factor,
        )
    }
}
