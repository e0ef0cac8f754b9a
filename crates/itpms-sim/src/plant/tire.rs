//! A tire's vertical force: a spring that may harden, with a little damping, and the rim under it where it is flat.
//!
//! Part of both plants. Forces and deflections are deviations from the car at rest on the tire as it is now.

use super::Deviations;

/// A tire but for its stiffness, which changes with time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tire {
    pub(crate) damping_n_s_per_m: f64,
    /// Its load of the unloaded car at rest in N.
    pub(crate) static_n: f64,
    progression_per_m: f64,
    /// Deflection in m at which the rim bears on the road, and the stiffness in N/m it adds there.
    rim: Option<[f64; 2]>,
}

impl Tire {
    pub(crate) fn new(truth: &Deviations, static_n: f64) -> Self {
        let rim = [truth.rim_deflection_m, truth.rim_stiffness_n_per_m];
        Self {
            damping_n_s_per_m: truth.tire_damping_n_s_per_m,
            static_n,
            progression_per_m: truth.tire_progression_per_m,
            rim: (truth.rim_deflection_m > 0.0).then_some(rim),
        }
    }

    #[inline]
    pub(crate) fn force_n(&self, stiffness_n_per_m: f64, deflection_m: f64, rate_m_s: f64) -> f64 {
        let damping = self.damping_n_s_per_m * rate_m_s;
        match self.rim {
            None => stiffness_n_per_m * self.hardened_m(deflection_m) + damping,
            Some(rim) => self.on_rim_n(rim, stiffness_n_per_m, deflection_m) + damping,
        }
    }

    /// Deflection in m that a spring without progression would have at the same force.
    #[inline]
    fn hardened_m(&self, deflection_m: f64) -> f64 {
        let p = self.progression_per_m;
        if p > 0.0 { (p * deflection_m).exp_m1() / p } else { deflection_m }
    }

    fn on_rim_n(&self, [rim_m, rim_n_per_m]: [f64; 2], stiffness_n_per_m: f64, deflection_m: f64) -> f64 {
        let total_m = self.static_m([rim_m, rim_n_per_m], stiffness_n_per_m) + deflection_m;
        let spring_m = total_m - deflection_m + self.hardened_m(deflection_m);
        stiffness_n_per_m * spring_m + rim_n_per_m * (total_m - rim_m).max(0.0) - self.static_n
    }

    /// Deflection in m of the car at rest.
    fn static_m(&self, [rim_m, rim_n_per_m]: [f64; 2], stiffness_n_per_m: f64) -> f64 {
        let free_m = self.static_n / stiffness_n_per_m;
        if free_m > rim_m {
            (self.static_n + rim_n_per_m * rim_m) / (stiffness_n_per_m + rim_n_per_m)
        } else {
            free_m
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_progressive_tire_has_the_slope_it_says() {
        let tire = Tire::new(&Deviations { tire_progression_per_m: 6.0, ..Deviations::default() }, 3000.0);
        for x in [-0.01f64, 0.0, 0.02] {
            let force = |x: f64| tire.force_n(200_000.0, x, 0.0);
            let slope = (force(x + 1e-5) - force(x - 1e-5)) / 2e-5;
            // A central difference over 1e-5 m is off by (6e-5)²/6.
            assert!((slope / (200_000.0 * (6.0 * x).exp()) - 1.0).abs() < 1e-8, "{x}");
        }
    }

    #[test]
    fn a_flat_tire_rests_on_its_rim_and_a_full_one_does_not() {
        let truth =
            Deviations { rim_deflection_m: 0.04, rim_stiffness_n_per_m: 400_000.0, ..Deviations::default() };
        let tire = Tire::new(&truth, 3000.0);
        // 60 kN/m carry 2400 N at the rim; the other 600 N press it in by 600 N over both stiffnesses.
        let rest_m = tire.static_m([0.04, 400_000.0], 60_000.0);
        assert!((rest_m - (0.04 + 600.0 / 460_000.0)).abs() < 1e-12, "{rest_m}");
        // About there it is as stiff as both; higher up as the rubber alone; in the air it pulls no more than it weighs.
        let slope =
            |x: f64| (tire.force_n(60_000.0, x + 1e-6, 0.0) - tire.force_n(60_000.0, x - 1e-6, 0.0)) / 2e-6;
        assert!(tire.force_n(60_000.0, 0.0, 0.0).abs() < 1e-9);
        assert!((slope(0.0) / 460_000.0 - 1.0).abs() < 1e-6 && (slope(-0.01) / 60_000.0 - 1.0).abs() < 1e-6);
        assert!((tire.force_n(60_000.0, -rest_m, 0.0) + 3000.0).abs() < 1e-9);
        // 233 kN/m hold it off by 40 - 12.9 mm; a bump beyond that meets the rim.
        let [within, beyond] = [0.027, 0.028].map(|x| tire.force_n(233_000.0, x, 0.0));
        assert!((within - 233_000.0 * 0.027).abs() < 1e-9);
        let free_m = 0.04 - 3000.0 / 233_000.0;
        assert!((beyond - 233_000.0 * 0.028 - 400_000.0 * (0.028 - free_m)).abs() < 1e-6);
    }
}
