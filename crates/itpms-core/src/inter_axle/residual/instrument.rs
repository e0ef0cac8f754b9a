//! A wheel's motion on the road that both axles agree on: the mean of both, sent forward through one axle's
//! quarter car. Derivatives of the residual taken from it are free of the axles' differences, so they do not
//! bias what is learned (docs/math/shared-road.md, section 4). Knows nothing of beliefs or frames.

use nalgebra::{SMatrix, SVector};

use crate::inter_axle::alignment::channel::KEPT;
use crate::inter_axle::residual::model::{Axle, Mode};
use crate::memory::Blank;
use crate::real::Real;

/// Wheel velocity, body velocity, deflection of the spring, force of the tire.
const STATES: usize = 4;

/// A quarter car on a road of given velocity, by the bilinear rule.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Instrument<T: Real> {
    transition: SMatrix<T, STATES, STATES>,
    input: SVector<T, STATES>,
    state: SVector<T, STATES>,
    last_road: T,
    /// Mass of the mode, sprung mass, damping with friction's, spring, tire.
    car: [T; 5],
    /// Damping without friction's.
    damper: T,
}

impl<T: Real> Instrument<T> {
    pub(crate) fn new() -> Self {
        Self { car: [T::one(); 5], damper: T::one(), ..Self::BLANK }
    }

    pub(crate) fn restart(&mut self) {
        (self.state, self.last_road) = (SVector::zeros(), T::zero());
    }

    /// Takes over an axle's parameters, for steps of `period_s`.
    pub(crate) fn tune(&mut self, axle: &Axle<T>, mode: Mode, sprung_mass_kg: T, period_s: T) {
        let [_, damper, spring, ..] = axle.factors;
        let (damping, tire) = (axle.whole_damping, T::one() / axle.theta.max(T::lit(1e-8)));
        let wheel = axle.mode_mass_kg(mode);
        self.car = [wheel, sprung_mass_kg, damping, spring, tire];
        self.damper = damper;
        let (zero, one) = (T::zero(), T::one());
        #[rustfmt::skip]
        let rates = SMatrix::<T, STATES, STATES>::new(
            -damping / wheel,          damping / wheel,           -spring / wheel,          one / wheel,
            damping / sprung_mass_kg,  -damping / sprung_mass_kg, spring / sprung_mass_kg,  zero,
            one,                       -one,                      zero,                     zero,
            -tire,                     zero,                      zero,                     zero,
        );
        let half = rates * T::lit(0.5) * period_s;
        let Some(inverse) = (SMatrix::identity() - half).try_inverse() else { return };
        self.transition = inverse * (SMatrix::identity() + half);
        self.input = inverse * SVector::<T, STATES>::new(zero, zero, zero, tire) * T::lit(0.5) * period_s;
    }

    /// Takes the road's velocity; gives wheel velocity, wheel jerk with friction's part taken out, relative acceleration, relative velocity.
    pub(crate) fn push(&mut self, road: T) -> [T; KEPT] {
        self.state = self.transition * self.state + self.input * (road + self.last_road);
        self.last_road = road;
        let [wheel_kg, sprung_kg, damping, spring, tire] = self.car;
        let (wheel, relative) = (self.state[0], self.state[0] - self.state[1]);
        let suspension = damping * relative + spring * self.state[2];
        let relative_acceleration = (self.state[3] - suspension) / wheel_kg - suspension / sprung_kg;
        let jerk =
            (tire * (road - wheel) - self.damper * relative_acceleration - spring * relative) / wheel_kg;
        [wheel, jerk, relative_acceleration, relative]
    }
}

/// Signals of the wheel on whose side a road is, and of the other one, given how the axle answers that road in both modes: half of each, the
/// other wheel's with the opposite sign where they move against each other.
pub(crate) fn of_both_wheels<T: Real>([together, against]: &[[T; KEPT]; 2]) -> [[T; KEPT]; 2] {
    let half = T::lit(0.5);
    [T::one(), -T::one()].map(|sign| core::array::from_fn(|i| half * (together[i] + sign * against[i])))
}
