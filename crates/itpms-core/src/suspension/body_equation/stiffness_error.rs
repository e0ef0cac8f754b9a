//! What friction that is not known exactly makes of the tires' stiffnesses (docs/math/unknown-car.md, section 5): at wheel hop a strut that
//! sticks is a spring beside the tire, so a newton of slip force too much is so much stiffness too little.

// Where another crate of the build brings `std`, numbers have this function by themselves.
#[allow(unused_imports)]
use nalgebra::ComplexField;

use super::{BINS, BodyEquation, ELEMENTS, FORCE_N, Parameters, slip};
use crate::cholesky;
use crate::model::{Corner, CornerConfig};
use crate::real::Real;
use crate::spectrum::transfer::FRICTION_SPACING_HZ;

/// How far the friction of a strut is from that of the model, as a share of its stiffness at wheel hop: which way a strut slips is decided
/// by slow motions, too, which accelerometers hardly tell.
const MODEL_ERROR: f64 = 0.2;

/// The bin nearest to a corner's wheel hop at placard pressure.
pub(super) fn hop_bin<T: Real>(corner: &CornerConfig<T>) -> usize {
    let car = &corner.quarter_car;
    let stiffness = corner.tire.stiffness_n_per_m(corner.placard_kpa) + car.spring_n_per_m();
    let hop_hz = (stiffness / car.unsprung_mass_kg()).sqrt() / T::two_pi();
    let place = (hop_hz / T::lit(FRICTION_SPACING_HZ) - T::lit(0.5)).to_whole().max(0);
    (place as usize).min(BINS - 1)
}

impl<T: Real> BodyEquation<T> {
    /// Equivalent damping of a corner's friction near wheel hop on the present road, in N s/m.
    pub(crate) fn friction_damping(&self, corner: Corner) -> T {
        let slip_n = self.slip_forces_n(corner).into_iter().enumerate();
        let damped = slip_n
            .fold(T::zero(), |sum, (element, slip_n)| sum + self.per_newton(corner, element, 1) * slip_n);
        damped / self.hop_rad_s(corner)
    }

    /// A corner's damper in N s/m, as the vehicle file has it.
    pub(crate) fn damper_n_s_per_m(&self, corner: Corner) -> T {
        self.damping[corner]
    }

    fn hop_rad_s(&self, corner: Corner) -> T {
        T::two_pi() * T::lit((self.hop_bin[corner] + 1) as f64 * FRICTION_SPACING_HZ)
    }

    /// Variance in (N/m)² of the stiffness beside a corner's tire at wheel hop that is due to friction on the present road.
    pub(crate) fn stiffness_variance(&self, corner: Corner) -> T {
        let [stiffness, _] = self.impedance_variance[corner];
        stiffness
    }

    /// What friction that is not known makes of a corner's damping and spring near wheel hop: variances over the squares of the file's.
    pub(crate) fn strut_variance(&self, corner: Corner) -> [T; 2] {
        let omega = self.hop_rad_s(corner);
        let [stiffness, damping] = self.impedance_variance[corner];
        let over = |variance: T, of: T| if of > T::zero() { variance / (of * of) } else { T::zero() };
        [over(damping, self.damping[corner] * omega), over(stiffness, self.spring[corner])]
    }

    #[inline(never)]
    pub(super) fn note_impedance_error(&mut self) {
        let Some(root) = self.root() else { return };
        for corner in Corner::ALL.into_iter().filter(|&corner| self.body.has(corner)) {
            for part in 0..2 {
                let (mut slope, mut sticking) = (Parameters::zeros(), T::zero());
                for (element, slip_n) in self.slip_forces_n(corner).into_iter().enumerate() {
                    let per_newton = self.per_newton(corner, element, part);
                    slope[slip(element, corner)] = per_newton * T::lit(FORCE_N);
                    sticking += per_newton * slip_n;
                }
                cholesky::solve_packed(root.as_slice(), &mut slope);
                let model = T::lit(MODEL_ERROR) * sticking;
                self.impedance_variance[corner][part.min(1)] = slope.norm_squared() + model * model;
            }
        }
    }

    /// Stiffness in N/m at wheel hop of an element of one newton, or what it damps: real or imaginary part of its describing function.
    fn per_newton(&self, corner: Corner, element: usize, part: usize) -> T {
        let (powers, bin) = (&self.powers[corner], self.hop_bin[corner].min(BINS - 1));
        let at = 2 * element.min(ELEMENTS - 1) + part.min(1);
        powers.elements[(bin, at)] / powers.velocity[bin].max(T::lit(1e-15))
    }
}
