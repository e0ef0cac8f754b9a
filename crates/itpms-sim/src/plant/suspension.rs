//! The force in a strut: spring, damper on its mount and dry friction, each as crooked as the scenario wants it.
//!
//! Called by both plants, several times a step; without crookedness it is the linear law of eq. (1).

use itpms_core::model::QuarterCar;

use super::Deviations;
use super::friction::Friction;
use super::mount::Mount;

#[derive(Debug, Clone)]
pub(crate) struct Strut {
    spring_n_per_m: f64,
    progression_per_m: f64,
    rebound_n_s_per_m: f64,
    bump_n_s_per_m: f64,
    digression_s_per_m: f64,
    friction: Option<Friction>,
    mount: Option<Mount>,
}

impl Strut {
    /// `car` is the true one; `truth` gives what a quarter car has no parameters for.
    pub(crate) fn new(car: &QuarterCar<f64>, truth: &Deviations) -> Self {
        Self {
            spring_n_per_m: car.spring_n_per_m(),
            progression_per_m: truth.spring_progression_per_m,
            rebound_n_s_per_m: car.damping_n_s_per_m() * (1.0 + truth.damper_asymmetry),
            bump_n_s_per_m: car.damping_n_s_per_m() * (1.0 - truth.damper_asymmetry),
            digression_s_per_m: truth.damper_digression_s_per_m,
            friction: Friction::new(truth),
            mount: Mount::new(truth.damper_mount_n_per_m),
        }
    }

    /// Slope of the spring in N/m where the car stands unloaded.
    pub(crate) fn spring_n_per_m(&self) -> f64 {
        self.spring_n_per_m
    }

    /// Force in N that lifts the body, beyond its static share, at a compression in m and a rate of extension in m/s
    /// (positive when the strut gets longer: rebound), `since_s` after the last step's end.
    #[inline]
    pub(crate) fn force_n(&self, compression_m: f64, extension_m_s: f64, since_s: f64) -> f64 {
        let spring = if self.progression_per_m > 0.0 {
            let p = self.progression_per_m;
            self.spring_n_per_m * (p * compression_m).exp_m1() / p
        } else {
            self.spring_n_per_m * compression_m
        };
        let damper = match &self.mount {
            None => self.damper_n_s_per_m(extension_m_s) * extension_m_s,
            Some(mount) => mount.force_n(-compression_m, since_s, |m_s| self.damper_n_s_per_m(m_s)),
        };
        let mut force = spring - damper;
        if let Some(friction) = &self.friction {
            force -= friction.force_n(-compression_m, extension_m_s);
        }
        force
    }

    /// The damper's force over its speed of extension in m/s.
    #[inline]
    fn damper_n_s_per_m(&self, extension_m_s: f64) -> f64 {
        let damping = if extension_m_s > 0.0 { self.rebound_n_s_per_m } else { self.bump_n_s_per_m };
        if self.digression_s_per_m > 0.0 {
            damping / (1.0 + self.digression_s_per_m * extension_m_s.abs())
        } else {
            damping
        }
    }

    /// Goes on to the compression in m at the end of a step of `step_s`.
    #[inline]
    pub(crate) fn advance(&mut self, compression_m: f64, step_s: f64) {
        if let Some(friction) = &mut self.friction {
            friction.advance(-compression_m);
        }
        if let Some(mut mount) = self.mount {
            mount.advance(-compression_m, step_s, |m_s| self.damper_n_s_per_m(m_s));
            self.mount = Some(mount);
        }
    }

    /// Stands at a compression in m, as if it had always stood there.
    pub(crate) fn place(&mut self, compression_m: f64) {
        if let Some(friction) = &mut self.friction {
            friction.place(-compression_m);
        }
        if let Some(mount) = &mut self.mount {
            mount.place(-compression_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strut(truth: Deviations) -> Strut {
        Strut::new(&QuarterCar::paper_table_2(), &truth)
    }

    #[test]
    fn a_progressive_spring_has_the_slope_it_says() {
        let s = strut(Deviations { spring_progression_per_m: 4.0, ..Deviations::default() });
        assert_eq!(s.force_n(0.0, 0.0, 0.0), 0.0);
        for x in [-0.06f64, 0.0, 0.05] {
            let slope = (s.force_n(x + 1e-5, 0.0, 0.0) - s.force_n(x - 1e-5, 0.0, 0.0)) / 2e-5;
            // A central difference over 1e-5 m is off by (4e-5)²/6.
            assert!((slope / (29_114.0 * (4.0 * x).exp()) - 1.0).abs() < 1e-8, "{x}");
        }
    }

    #[test]
    fn a_digressive_damper_halves_its_slope_where_it_says() {
        let s = strut(Deviations {
            damper_digression_s_per_m: 2.0,
            damper_asymmetry: 0.3,
            ..Deviations::default()
        });
        // At 0.5 m/s the denominator is 2.
        assert!((s.force_n(0.0, 0.5, 0.0) + 925.8 * 1.3 * 0.25).abs() < 1e-9);
        assert!((s.force_n(0.0, -0.5, 0.0) - 925.8 * 0.7 * 0.25).abs() < 1e-9);
    }
}
