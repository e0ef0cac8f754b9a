//! Dry friction that sticks before it slips: elements in parallel, each a spring until it slides.
//!
//! Part of a strut. An element's share `u` of its full force follows the strut's displacement `x`,
//! `du/dx = (sgn(dx) - u) / δ`: the Maxwell-slip model (Lampaert, Swevers and Al-Bender 2002) with the smooth onset of
//! Dahl (1968). It knows displacements and no rates, so a loop of force over displacement is the same at any frequency.

use super::Deviations;

pub(crate) const ELEMENTS: usize = 3;

/// A strut's friction and where it is in its loop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Friction {
    sliding_n: [f64; ELEMENTS],
    per_presliding_m: [f64; ELEMENTS],
    /// Static over sliding friction, the excess as a share.
    surplus: f64,
    per_stribeck_m_s: f64,
    /// Share of its sliding force that each element has, -1 to 1, at the extension reached.
    share: [f64; ELEMENTS],
    extension_m: f64,
}

impl Friction {
    /// At rest and without force; `None` where nothing rubs.
    pub(crate) fn new(truth: &Deviations) -> Option<Self> {
        let whole: f64 = truth.friction_shares.iter().sum();
        (truth.friction_n > 0.0).then(|| Self {
            sliding_n: truth.friction_shares.map(|share| truth.friction_n * share / whole),
            per_presliding_m: truth.friction_presliding_m.map(f64::recip),
            surplus: truth.friction_breakaway_factor - 1.0,
            per_stribeck_m_s: truth.friction_stribeck_m_s.recip(),
            share: [0.0; ELEMENTS],
            extension_m: 0.0,
        })
    }

    /// Force in N against the extension, at an extension in m that is reached on a straight way from the last one, and a
    /// rate of extension in m/s.
    #[inline]
    pub(crate) fn force_n(&self, extension_m: f64, extension_m_s: f64) -> f64 {
        let displacement_m = extension_m - self.extension_m;
        let mut force = 0.0;
        for i in 0..ELEMENTS {
            force += self.sliding_n[i] * self.share_after(i, displacement_m);
        }
        if self.surplus > 0.0 {
            let speed = extension_m_s * self.per_stribeck_m_s;
            force *= 1.0 + self.surplus * (-speed * speed).exp();
        }
        force
    }

    pub(crate) fn advance(&mut self, extension_m: f64) {
        let displacement_m = extension_m - self.extension_m;
        self.share = std::array::from_fn(|i| self.share_after(i, displacement_m));
        self.extension_m = extension_m;
    }

    /// Takes an extension in m for the one reached, without having moved.
    pub(crate) fn place(&mut self, extension_m: f64) {
        self.extension_m = extension_m;
    }

    /// The equation's solution along a way in one direction: stable and between -1 and 1 for any step.
    #[inline]
    fn share_after(&self, i: usize, displacement_m: f64) -> f64 {
        let (share, slid) = (self.share[i], -(-displacement_m.abs() * self.per_presliding_m[i]).exp_m1());
        share + (1f64.copysign(displacement_m) - share) * slid
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const FORCE_N: f64 = 60.0;

    fn rubbing(presliding_m: [f64; 3], shares: [f64; 3]) -> Friction {
        Friction::new(&Deviations {
            friction_n: FORCE_N,
            friction_presliding_m: presliding_m,
            friction_shares: shares,
            ..Deviations::default()
        })
        .unwrap()
    }

    /// Energy in J that a cycle of a sine of this amplitude takes once it repeats, and the force at the largest extension.
    fn loop_of(mut friction: Friction, amplitude_m: f64, hz: f64, step_s: f64) -> [f64; 2] {
        let steps = (1.0 / (hz * step_s)).round() as usize;
        let place = |i: usize| amplitude_m * (TAU * i as f64 / steps as f64).sin();
        let (mut energy, mut highest) = (0.0, 0.0f64);
        for cycle in 0..3 {
            for i in 0..steps {
                let (from, to) = (place(i), place(i + 1));
                let before = friction.force_n(from, 0.0);
                let after = friction.force_n(to, 0.0);
                friction.advance(to);
                if cycle == 2 {
                    energy += 0.5 * (before + after) * (to - from);
                    highest = highest.max(after);
                }
            }
        }
        [energy, highest]
    }

    /// From one end to the other and back each element takes `4 F (A - δ tanh(A/δ))`, and turns round at `F tanh(A/δ)`.
    #[test]
    fn a_loop_takes_the_energy_of_the_closed_form() {
        for (presliding_m, shares) in [
            ([1e-4, 3e-4, 1e-3], [1.0, 1.0, 1.0]),
            ([3e-4; 3], [1.0, 0.0, 0.0]),
            ([1e-4, 3e-4, 1e-3], [0.5, 0.3, 0.2]),
        ] {
            let whole: f64 = shares.iter().sum();
            for amplitude_m in [5e-5, 3e-4, 2e-3, 2e-2] {
                let exact =
                    presliding_m.iter().zip(shares).fold([0.0, 0.0], |[energy, force], (&d, share)| {
                        let (n, u) = (FORCE_N * share / whole, f64::tanh(amplitude_m / d));
                        [energy + 4.0 * n * (amplitude_m - d * u), force + n * u]
                    });
                let got = loop_of(rubbing(presliding_m, shares), amplitude_m, 1.0, 1e-5);
                // Trapezoids of 2 π A 1e-5 against δ = 0.1 mm: below 2e-5; three cycles forget the start by exp(-4A/δ)
                // each, 2e-2 of a loop that is hardly open at a twentieth of the longest presliding.
                let forgotten = (-8.0 * amplitude_m / 1e-3).exp() * amplitude_m / 1e-3;
                assert!(
                    (got[0] / exact[0] - 1.0).abs() < 1e-3 + forgotten,
                    "{amplitude_m}: {got:?} {exact:?}"
                );
                assert!(
                    (got[1] / exact[1] - 1.0).abs() < 1e-3 + forgotten,
                    "{amplitude_m}: {got:?} {exact:?}"
                );
            }
        }
    }

    #[test]
    fn before_it_slips_it_is_a_spring() {
        let (presliding_m, shares) = ([1e-4, 3e-4, 1e-3], [0.5, 0.25, 0.25]);
        let friction = rubbing(presliding_m, shares);
        let stiffness: f64 = presliding_m.iter().zip(shares).map(|(d, share)| FORCE_N * share / d).sum();
        for x in [1e-8, -1e-8] {
            // The next term is x/2δ = 5e-5.
            assert!((friction.force_n(x, 0.0) / (stiffness * x) - 1.0).abs() < 1e-4, "{x}");
        }
        // Far beyond it is all there; turned round it is twice as stiff (from +1 towards -1).
        let mut slid = friction;
        slid.advance(0.05);
        assert!((slid.force_n(0.05, 0.0) - FORCE_N).abs() < 1e-9);
        let back = (slid.force_n(0.05, 0.0) - slid.force_n(0.05 - 1e-8, 0.0)) / 1e-8;
        assert!((back / (2.0 * stiffness) - 1.0).abs() < 1e-4, "{back}");
    }

    #[test]
    fn a_loop_is_the_same_at_any_frequency_and_step() {
        let friction = rubbing([1e-4, 3e-4, 1e-3], [1.0; 3]);
        let slow = loop_of(friction, 2e-3, 1.0, 2.5e-4);
        // The same places at a tenth of the time: the same numbers.
        assert_eq!(slow, loop_of(friction, 2e-3, 10.0, 2.5e-5));
        // 160 steps to a cycle, as a plant has at 10 Hz: the loop's chords cut some of its corners.
        let coarse = loop_of(friction, 2e-3, 10.0, 6.25e-4);
        assert!(
            (coarse[0] / slow[0] - 1.0).abs() < 0.02 && (coarse[1] / slow[1] - 1.0).abs() < 1e-3,
            "{coarse:?}"
        );
    }

    #[test]
    fn breaking_away_takes_more_than_sliding() {
        let truth = Deviations {
            friction_n: FORCE_N,
            friction_breakaway_factor: 1.4,
            friction_stribeck_m_s: 0.02,
            ..Deviations::default()
        };
        let mut friction = Friction::new(&truth).unwrap();
        friction.advance(0.1);
        // Stribeck's curve: F (1 + 0.4 exp(-(v/v_s)²)).
        for (m_s, expected) in [(0.0, 1.4), (0.02, 1.0 + 0.4 / std::f64::consts::E), (0.2, 1.0)] {
            assert!((friction.force_n(0.1, m_s) / FORCE_N - expected).abs() < 1e-12, "{m_s}");
        }
        assert!(Friction::new(&Deviations::default()).is_none());
    }
}
