//! A tire's rolling radius over load, pressure and speed, and its slip over force; `docs/math/simulation.md`, eq. 11-13.
//!
//! Called by the run, wheel by wheel.

/// Shape of the rolling radius over load, `D atan(B f) + F f`, as the Magic Formula has it; values as a passenger car's tire may
/// have them, of which only the shape counts.
const B: f64 = 8.4;
const D: f64 = 0.26;
const F: f64 = 0.074;
/// Growth of the radius by the belt's inertia at 30 m/s, as a share.
const GROWTH: f64 = 2e-3;
const GROWTH_M_S: f64 = 30.0;
/// Grip of a dry road.
pub(crate) const DRY_FRICTION: f64 = 0.9;
/// Share of its grip beyond which a tire is not driven here.
const MOST_GRIP: f64 = 0.9;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Tire {
    /// `ln R` at placard pressure, load 1 and standstill.
    pub(crate) ln_radius: f64,
    /// `d ln R / d ln p` and `-d ln R / d ln f` there.
    pub(crate) per_ln_pressure: f64,
    pub(crate) per_ln_load: f64,
    pub(crate) growth: f64,
    pub(crate) slip_stiffness_per_load: f64,
    /// The slip stiffness goes with the load to the power of 1 less this, and is as given at this load in N.
    pub(crate) slip_load_loss: f64,
    pub(crate) usual_n: f64,
    /// Vertical stiffness in N/m per kPa over that at the placard's pressure, and what remains without pressure.
    pub(crate) stiffness_per_kpa: f64,
    pub(crate) stiffness_at_zero: f64,
    pub(crate) placard_kpa: f64,
}

impl Tire {
    /// Vertical stiffness over that at the placard's pressure.
    fn stiffness(&self, pressure_kpa: f64) -> f64 {
        self.stiffness_at_zero + self.stiffness_per_kpa * pressure_kpa
    }

    /// `ln R` at a load over that of the unloaded car, a pressure and a speed: a deflection, which pressure carries, shrinks the
    /// radius in proportion to how far it flattens the belt, and the carcass gives beside that.
    pub(crate) fn ln_radius(&self, load: f64, pressure_kpa: f64, speed_m_s: f64) -> f64 {
        // What of ln k the pressure is at the placard's: 1 less the carcass's share.
        let carried = self.stiffness_per_kpa * self.placard_kpa;
        let flattened = self.per_ln_pressure / carried;
        let beside = self.per_ln_load - flattened * slope_at_one();
        let speed = speed_m_s / GROWTH_M_S;
        self.ln_radius
            - flattened * (shape(load) / self.stiffness(pressure_kpa) - 1.0)
            - beside * (shape(load) - 1.0) / slope_at_one()
            + GROWTH * self.growth * speed * speed
    }

    /// Slip stiffness in N at a load in N: a longer contact is stiffer, and its length goes with the root of the deflection.
    pub(crate) fn slip_stiffness_n(&self, load_n: f64, pressure_kpa: f64) -> f64 {
        let less =
            if self.slip_load_loss > 0.0 { (load_n / self.usual_n).powf(-self.slip_load_loss) } else { 1.0 };
        self.slip_stiffness_per_load * load_n * less / self.stiffness(pressure_kpa).sqrt()
    }
}

/// Slip at a force, both in the direction of travel: the brush model's `F = mu Fz (1 - (1 - C s / 3 mu Fz)^3)`.
pub(crate) fn slip(force_n: f64, load_n: f64, stiffness_n: f64, friction: f64) -> f64 {
    let grip_n = friction * load_n.max(1.0);
    let used = (force_n.abs() / grip_n).min(MOST_GRIP);
    (3.0 * grip_n / stiffness_n * (1.0 - (1.0 - used).cbrt())).copysign(force_n)
}

/// Shape of the radius over load, one at one.
fn shape(load: f64) -> f64 {
    (D * (B * load).atan() + F * load) / at_one()
}

fn at_one() -> f64 {
    D * B.atan() + F
}

fn slope_at_one() -> f64 {
    (D * B / (1.0 + B * B) + F) / at_one()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn tire() -> Tire {
        Tire {
            ln_radius: 0.0,
            per_ln_pressure: 0.007,
            per_ln_load: 0.0064,
            growth: 0.0,
            slip_stiffness_per_load: 50.0,
            slip_load_loss: 0.0,
            usual_n: 4000.0,
            stiffness_per_kpa: 0.74 / 240.0,
            stiffness_at_zero: 0.26,
            placard_kpa: 240.0,
        }
    }

    #[test]
    fn the_radius_has_the_slopes_that_it_is_given() {
        let (tire, h) = (tire(), 1e-4f64);
        assert!(tire.ln_radius(1.0, 240.0, 20.0).abs() < 1e-15);
        let slope = |of: &dyn Fn(f64) -> f64| (of(h.exp()) - of((-h).exp())) / (2.0 * h);
        let pressure = slope(&|factor| tire.ln_radius(1.0, 240.0 * factor, 20.0));
        let load = slope(&|factor| tire.ln_radius(factor, 240.0, 20.0));
        // A central difference is off by h²/6 of the third derivative.
        assert!((pressure - 0.007).abs() < 1e-9 && (load + 0.0064).abs() < 1e-9, "{pressure} {load}");
        // A quarter less: .007 / .74 times (1/(.26 + .74 .75) - 1); by .007 ln .75 it would be a sixth less.
        let loss = tire.ln_radius(1.0, 180.0, 20.0);
        assert!((loss + 0.007 / 0.74 * (1.0 / 0.815 - 1.0)).abs() < 1e-12, "{loss}");
        assert!((loss / (0.007 * 0.75f64.ln()) - 1.0657).abs() < 1e-3, "{loss}");
        // At less pressure a load does more.
        let heavier = |kpa: f64| tire.ln_radius(1.3, kpa, 20.0) - tire.ln_radius(1.0, kpa, 20.0);
        assert!(heavier(180.0) < heavier(240.0) && heavier(240.0) < 0.0);
    }

    #[test]
    fn slip_is_force_over_stiffness_and_grows_towards_the_grip() {
        let stiffness_n = tire().slip_stiffness_n(4000.0, 240.0);
        assert!((stiffness_n - 200_000.0).abs() < 1e-6);
        for force_n in [10.0, -10.0] {
            // Of the next term a third of the grip's share: 10/(3 3600).
            assert!(
                (slip(force_n, 4000.0, stiffness_n, DRY_FRICTION) * stiffness_n / force_n - 1.0).abs() < 1e-3
            );
        }
        // At seven eighths of the grip half of the contact's cube is left: 1 - 1/2.
        let half = slip(0.875 * 3600.0, 4000.0, stiffness_n, DRY_FRICTION);
        assert!((half - 3.0 * 3600.0 / stiffness_n * 0.5).abs() < 1e-12);
        // A quarter less pressure: stiffer by the root of 1/.815, 10.8 %.
        assert!((tire().slip_stiffness_n(4000.0, 180.0) / stiffness_n - 0.815f64.powf(-0.5)).abs() < 1e-12);
        // A quarter more load: the same slip for the same share of it, or 1.25^.2, 4.6 %, more where the stiffness lags.
        let slip_of = |tire: &Tire| slip(50.0, 5000.0, tire.slip_stiffness_n(5000.0, 240.0), DRY_FRICTION);
        let lags = Tire { slip_load_loss: 0.2, ..tire() };
        assert!((slip_of(&lags) / slip_of(&tire()) - 1.25f64.powf(0.2)).abs() < 1e-9);
        assert!((lags.slip_stiffness_n(4000.0, 240.0) / stiffness_n - 1.0).abs() < 1e-12);
        // On snow near its grip slip goes on where a dry road has hardly any: half of the contact slides at seven eighths.
        let snow = slip(0.875 * 1000.0, 4000.0, 0.4 * stiffness_n, 0.25);
        assert!((snow - 3.0 * 1000.0 / (0.4 * stiffness_n) * 0.5).abs() < 1e-12);
    }
}
