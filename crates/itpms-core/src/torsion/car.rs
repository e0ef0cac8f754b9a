//! The four wheels of a car: edges in, by how much the pressures have changed out. It calibrates and stands still with the wheel speeds' monitor, which asks it
//! ([`MonitoredWheels::update_with_pulses`](crate::monitor::MonitoredWheels::update_with_pulses)).

use core::ops::DerefMut;

use super::{TorsionCalibration, TorsionChange, TorsionConfig, TorsionEvidence, TorsionPiece, TorsionWheel};
use crate::memory::Blank;
use crate::model::{Corner, ParameterError, positive};
use crate::real::Real;

/// The torsional analysis of a car's four wheels; less than 10 kB in `f32`.
#[derive(Debug, Clone, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CarTorsion<T: Real> {
    wheels: [TorsionWheel<T>; 4],
    /// Reference pressures, and the excess of those at the calibration, in kPa.
    reference_kpa: [T; 4],
    above_kpa: [T; 4],
}

/// Which of its wheels' sensors a car reads beside its accelerometers: `()` is wheel speeds, [`NoWheelSpeeds`] none of them,
/// `Option<Box<CarTorsion<T>>>` on a host and `Option<&'static mut CarTorsion<T>>` on a controller wheel speeds and a place for the analysis
/// of tooth pulses, empty until they are read.
pub trait WheelSensors<T: Real> {
    /// Whether wheel speeds are read; what is known at compile time leaves the code out.
    const SPEEDS: bool = true;

    /// The analysis of the tooth pulses, where they are read.
    fn torsion(&self) -> Option<&CarTorsion<T>> {
        None
    }

    /// The same, to take edges in.
    fn torsion_mut(&mut self) -> Option<&mut CarTorsion<T>> {
        None
    }
}

impl<T: Real> WheelSensors<T> for () {}

/// The sensors of a car whose program has no code for wheel speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NoWheelSpeeds;

impl<T: Real> WheelSensors<T> for NoWheelSpeeds {
    const SPEEDS: bool = false;
}

impl<T: Real, P: DerefMut<Target = CarTorsion<T>>> WheelSensors<T> for Option<P> {
    fn torsion(&self) -> Option<&CarTorsion<T>> {
        self.as_deref()
    }

    fn torsion_mut(&mut self) -> Option<&mut CarTorsion<T>> {
        self.as_deref_mut()
    }
}

impl<T: Real> CarTorsion<T> {
    /// Memory for a car, as a constant of zeros; [`configure`](Self::configure) fills it where it lies.
    #[must_use]
    pub const fn unconfigured() -> Self {
        Self::BLANK
    }

    /// Begins anew with wheels of these sensors and tires, in the order of [`Corner::ALL`], and the pressures they should have in kPa;
    /// uncalibrated.
    ///
    /// # Errors
    /// A number that no wheel has.
    pub fn configure(
        &mut self,
        wheels: &[TorsionConfig<T>; 4],
        placard_kpa: &[T; 4],
    ) -> Result<(), ParameterError> {
        for (wheel, config) in self.wheels.iter_mut().zip(wheels) {
            wheel.configure(config)?;
        }
        for kpa in placard_kpa {
            positive("placard_kpa", *kpa)?;
        }
        (self.reference_kpa, self.above_kpa) = (*placard_kpa, [T::zero(); 4]);
        Ok(())
    }

    /// Takes in an edge of a wheel at a time in s; what a piece has shown that ends with it.
    pub fn push(&mut self, corner: Corner, time_s: f64) -> Option<TorsionPiece<T>> {
        self.wheels.get_mut(corner.index())?.push(time_s)
    }

    /// The pressures are as they should be from here on.
    pub fn begin_calibration(&mut self) {
        self.begin_calibration_at(&[T::one(); 4]);
    }

    /// The pressures are known from here on: each is this share of its reference (0.2 to 5; anything else counts as 1).
    pub fn begin_calibration_at(&mut self, pressure_share: &[T; 4]) {
        let above = self.above_kpa.iter_mut().zip(&self.reference_kpa).zip(pressure_share);
        for ((above, reference_kpa), share) in above {
            let known = *share >= T::lit(0.2) && *share <= T::lit(5.0);
            *above = if known { (*share - T::one()) * *reference_kpa } else { T::zero() };
        }
        self.wheels.iter_mut().for_each(TorsionWheel::begin_calibration);
    }

    /// Ends the calibration; for how many wheels a piece was seen in it.
    pub fn end_calibration(&mut self) -> usize {
        self.wheels.iter_mut().map(TorsionWheel::end_calibration).filter(|learned| *learned).count()
    }

    /// Result of the last calibration of each wheel, and by how much the pressure was above what it should be then, in kPa.
    #[must_use]
    pub fn calibration(&self) -> [Option<(TorsionCalibration<T>, T)>; 4] {
        let mut learned = [None; 4];
        for ((place, wheel), above_kpa) in learned.iter_mut().zip(&self.wheels).zip(&self.above_kpa) {
            *place = wheel.calibration().map(|calibration| (calibration, *above_kpa));
        }
        learned
    }

    /// Begins a drive with what a calibration on an earlier one taught; whether a car can have it. What it cannot have changes nothing.
    #[must_use]
    pub fn load_calibration(&mut self, learned: &[Option<(TorsionCalibration<T>, T)>; 4]) -> bool {
        let sane = |(calibration, above_kpa): &(TorsionCalibration<T>, T)| {
            calibration.is_sane() && above_kpa.abs() < T::lit(1e4)
        };
        if !learned.iter().flatten().all(sane) {
            return false;
        }
        for ((wheel, above), learned) in self.wheels.iter_mut().zip(&mut self.above_kpa).zip(learned) {
            if let Some((calibration, above_kpa)) = learned {
                *above = *above_kpa;
                let _ = wheel.load_calibration(calibration);
            }
        }
        true
    }

    /// By how much each pressure differs from what it should be; `None` before the end of a calibration that saw a piece of that wheel.
    #[must_use]
    pub fn changes(&self) -> [Option<TorsionChange<T>>; 4] {
        let mut changes = [None; 4];
        for ((place, wheel), above_kpa) in changes.iter_mut().zip(&self.wheels).zip(&self.above_kpa) {
            *place = wheel
                .change()
                .map(|change| TorsionChange { change_kpa: change.change_kpa + *above_kpa, ..change });
        }
        changes
    }

    /// Estimate of the pressures from the pieces since the calibration.
    #[must_use]
    pub(crate) fn evidence(&self) -> TorsionEvidence<T> {
        let mut evidence = TorsionEvidence { reference_kpa: self.reference_kpa, ..TorsionEvidence::BLANK };
        let places = evidence.change_kpa.iter_mut().zip(&mut evidence.information);
        for ((change, information), (wheel, above)) in places.zip(self.wheels.iter().zip(&self.above_kpa)) {
            (*change, *information) = wheel.seen();
            *change += *above;
        }
        evidence
    }
}
