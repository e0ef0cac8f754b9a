//! The tires at their placard pressures: between compliances, stiffnesses and pressures, and what a corner's spectrum should
//! say in a state (docs/math/shared-road.md, eq. 15). Knows nothing of beliefs.

use super::state::{SPECTRUM_BIAS, State, TIRE};
use crate::memory::Blank;
use crate::model::{CarConfig, Corner, CornerConfig};
use crate::real::Real;

/// Least compliance of a tire over that at placard pressure.
pub(crate) const LEAST_COMPLIANCE: f64 = 0.05;

/// What is taken for flat is the compliance at no pressure, within so many times that at placard pressure.
const FLAT: [f64; 2] = [4.0, 30.0];

/// The tires at their placard pressures, in the order of the corners.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct TireScale<T> {
    /// N/m per kPa.
    pub(crate) slope: [T; 4],
    pub(crate) placard_n_per_m: [T; 4],
    pub(crate) placard_kpa: [T; 4],
}

impl<T: Real> TireScale<T> {
    pub(super) fn new(config: &CarConfig<T>) -> Self {
        let of = |value: &dyn Fn(&CornerConfig<T>) -> T| {
            core::array::from_fn(|i| config.corners[i].as_ref().map_or(T::one(), value))
        };
        Self {
            slope: of(&|c| c.tire.stiffness_per_kpa()),
            placard_n_per_m: of(&|c| c.tire.stiffness_n_per_m(c.placard_kpa)),
            placard_kpa: of(&|c| c.placard_kpa),
        }
    }

    /// The placard pressure's share in a corner's stiffness.
    pub(crate) fn share(&self, corner: Corner) -> T {
        self.pressures_part_n_per_m(corner) / self.placard_n_per_m[corner]
    }

    /// The most that each tire's compliance can be, over that at placard pressure, less one: flat.
    pub(crate) fn softest(&self) -> [T; 4] {
        Corner::ALL.map(|corner| {
            let carcass = T::one() - self.share(corner);
            let [least, most] = FLAT;
            (T::one() / carcass.max(T::lit(1.0 / most))).max(T::lit(least)) - T::one()
        })
    }

    /// What of a corner's stiffness in N/m the placard pressure makes: the unit of the spectrum's biases.
    pub(crate) fn pressures_part_n_per_m(&self, corner: Corner) -> T {
        self.slope[corner] * self.placard_kpa[corner]
    }

    /// The stiffness in N/m that a corner's road spectrum should tell in a state, and its derivatives.
    pub(crate) fn spectral_stiffness(&self, corner: Corner, state: &State<T>) -> (T, State<T>) {
        let placard = self.placard_n_per_m[corner];
        // Biases are shares of the placard pressure; the spectrum's own unit is N/m.
        let unit = self.pressures_part_n_per_m(corner);
        let (tire, bias) = (TIRE + corner.index(), SPECTRUM_BIAS + corner.index());
        let factor = (T::one() + state[tire]).max(T::lit(LEAST_COMPLIANCE));
        let mut slope = State::zeros();
        slope[tire] = -placard / (factor * factor);
        slope[bias] = unit;
        (placard / factor + unit * state[bias], slope)
    }
}
