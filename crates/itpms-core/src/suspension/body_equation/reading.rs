//! Result of the fit of the struts (docs/math/learn.md, section 3). Called between
//! samples, not with each.

use super::{BodyEquation, DAMPER, ELEMENTS, FORCE_N, INERTIA, Parameters, SPRING, slip};
use crate::cholesky;
use crate::model::{Corner, StrutReading};
use crate::real::Real;

impl<T: Real> BodyEquation<T> {
    /// Identified strut of a corner; `None` as long as too little was seen, and for a corner that is not there.
    pub(crate) fn reading(&self, corner: Corner) -> Option<StrutReading<T>> {
        if !(self.known && self.body.has(corner)) {
            return None;
        }
        let root = self.root()?;
        let sd = |mut of: Parameters<T>| {
            cholesky::solve_packed(root.as_slice(), &mut of);
            of.norm()
        };
        // Of the difference of two logarithms: to the body's mass, which is given by nothing but the file.
        let over_mass_sd = |i: usize| {
            let mut difference = Parameters::zeros();
            (difference[i], difference[INERTIA]) = (T::one(), -T::one());
            sd(difference)
        };
        let over_mass = |i: usize| self.parameters[i] - self.parameters[INERTIA];
        let per_mass = (-self.parameters[INERTIA]).exp();
        let slips = |element| slip(element, corner);
        let (damper, spring) = (DAMPER + corner.index(), SPRING + corner.index());
        let mut all = Parameters::zeros();
        (0..ELEMENTS).map(slips).for_each(|i| all[i] = T::lit(FORCE_N));
        let friction_n = all.dot(&self.parameters);
        Some(StrutReading {
            ln_damping: over_mass(damper),
            ln_damping_sd: over_mass_sd(damper),
            ln_spring: over_mass(spring),
            ln_spring_sd: over_mass_sd(spring),
            friction_n: friction_n * per_mass,
            friction_sd_n: sd(all) * per_mass,
            ln_sprung_mass: self.parameters[INERTIA],
        })
    }
}
