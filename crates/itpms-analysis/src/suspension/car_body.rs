//! A car as its vehicle file has it: where every fit begins.

use itpms_data::reference::SuspensionReference;

const GRAVITY_M_S2: f64 = 9.80665;

/// A car as its vehicle file has it, corners in the order of [`Corner::ALL`](itpms_core::model::Corner::ALL).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CarBody {
    pub sprung_mass_kg: [f64; 4],
    pub unsprung_mass_kg: [f64; 4],
    pub damping_n_s_per_m: [f64; 4],
    pub spring_n_per_m: [f64; 4],
    /// By how much springs stiffen as they are compressed, in 1/m: their slope goes as `exp(p x)`.
    pub spring_stiffening_per_m: f64,
    /// Noise of the accelerometers in m/s² (rms per row).
    pub accel_noise_m_s2: [f64; 4],
    /// Tires at the pressures that they should have, in N/m, and what they damp, in N s/m.
    pub tire_n_per_m: [f64; 4],
    /// See [`tire_n_per_m`](Self::tire_n_per_m).
    pub tire_damping_n_s_per_m: [f64; 4],
}

impl CarBody {
    /// Sprung mass of the car in kg.
    pub(super) fn sprung_mass_kg(&self) -> f64 {
        self.sprung_mass_kg.iter().sum()
    }

    pub(super) fn rear_share(&self) -> f64 {
        (self.sprung_mass_kg[2] + self.sprung_mass_kg[3]) / self.sprung_mass_kg()
    }

    /// Mean of the springs of an axle in N/m.
    pub(super) fn axle_spring_n_per_m(&self, axle: usize) -> f64 {
        0.5 * (self.spring_n_per_m[2 * axle] + self.spring_n_per_m[2 * axle + 1])
    }

    /// Springs in N/m under the load that was found, from the reference's under its own (eq. 8).
    pub(super) fn stiffened(&self, reference: &SuspensionReference, found: &SuspensionReference) -> [f64; 4] {
        let on = |of: &SuspensionReference, i: usize| {
            0.5 * of.sprung_mass_kg * if i < 2 { 1.0 - of.rear_share } else { of.rear_share }
        };
        std::array::from_fn(|i| {
            let spring = reference.spring_n_per_m[i];
            // The way of a spring whose slope is k exp(p x), under what is added to it.
            let way =
                (on(found, i) - on(reference, i)) * GRAVITY_M_S2 / spring * self.spring_stiffening_per_m;
            spring * (1.0 + way).clamp(0.4, 2.5)
        })
    }
}
