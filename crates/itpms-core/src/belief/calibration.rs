//! Calibration: all tires have just been set to their placard pressures and keep them for a while. What it teaches of the
//! car, on its way from the belief to a [`VehicleCalibration`] and back.

use super::Belief;
use super::state::{
    BAR, COUPLING, DAMPING, GAIN, MASS, ROAD_BIAS, SKEW, SKEW_UNIT_S, SPECTRUM_BIAS, SPRING, State, TIRE,
    WHEELBASE,
};
use crate::conditioning::pauses::ENOUGH_S;
use crate::memory::{Blank, Placed};
use crate::model::{CalibrationError, Corner, CornerCalibration, Learned, VehicleCalibration};
use crate::real::Real;

/// Sd of a tire's compliance, over that at placard pressure, when it may have been set anew.
const SET_ANEW_SD: f64 = 0.2;
/// Sd with which a calibration sets a tire, as a share of the placard pressure.
const CALIBRATION_SD: f64 = 0.004;
/// Seconds of shared road learned from in a calibration after which tires may change all the same.
const CALIBRATING_ENOUGH_S: f64 = 6.0;

/// Least sd that is loaded: unsprung mass (another rim), damping (warm oil; a damper that is not straight is another one on another road), spring, bar and coupling, gain, wheelbase over speed
/// (other tires), skew in s, the spectrum's bias as a share of the placard pressure, and the inter-axle residual's.
const LEAST_SD: [f64; 9] = [0.003, 0.2, 0.02, 0.01, 0.003, 0.003, 5e-4, 0.02, 0.01];

/// Where the car is with its calibration.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct CalibrationState<T: Real> {
    /// Whether one is under way, and the seconds of shared road learned from when it began.
    pub(super) active: bool,
    from_s: f64,
    /// Whether one was ever begun or loaded.
    pub(super) calibrated: bool,
    /// What the last one on this drive taught.
    stored: Placed<VehicleCalibration<T>>,
    /// What an earlier one had taught.
    loaded: Placed<VehicleCalibration<T>>,
}

impl<T: Real> CalibrationState<T> {
    pub(super) fn new() -> Self {
        Self { active: false, from_s: 0.0, calibrated: false, stored: Placed::BLANK, loaded: Placed::BLANK }
    }

    /// Whether the newest calibration is one of this drive, or under way.
    pub(super) fn is_of_this_drive(&self) -> bool {
        self.active || self.stored.as_ref().is_some()
    }
}

impl<T: Real> Belief<T> {
    /// A calibration begins: somebody has just set all tires to their placard pressures. What the one before has taught is
    /// what an earlier one has taught, from now on.
    pub(crate) fn begin_calibration(&mut self) {
        let calibration = &mut self.calibration;
        if calibration.stored.as_ref().is_some() {
            calibration.loaded = calibration.stored;
            calibration.stored.clear();
        }
        (calibration.calibrated, calibration.active) = (true, true);
        self.bank.free_masses(&self.mass_sd);
        self.set_tires();
    }

    /// Says that a calibration goes on, or that it is over or there was none.
    pub(crate) fn set_calibrating(&mut self, active: bool) {
        if self.calibration.active && !active {
            self.store_calibration();
        }
        self.calibration.active = active;
        self.bank.circumstances.tires_set = active;
    }

    pub(crate) fn is_calibrating(&self) -> bool {
        self.calibration.active
    }

    pub(crate) fn calibration(&self) -> Option<&VehicleCalibration<T>> {
        self.calibration.stored.as_ref()
    }

    /// What there is to begin with: the last calibration of this drive, or the loaded one.
    pub(super) fn newest_calibration(&self) -> Option<VehicleCalibration<T>> {
        self.calibration.stored.get().or(self.calibration.loaded.get())
    }

    /// The tires have their placard pressures now: their estimates and correlations with others are forgotten.
    pub(super) fn set_tires(&mut self) {
        self.calibration.from_s = self.learned_s;
        self.losses.end(self.learned_s);
        self.bank.collapse();
        self.drop_checkpoints();
        self.pre_fault = [None; 4];
        Corner::ALL.into_iter().for_each(|corner| self.set_tire(corner));
    }

    pub(super) fn set_tire(&mut self, corner: Corner) {
        let at = TIRE + corner.index();
        self.bank.inflate_tire(corner, T::lit(SET_ANEW_SD));
        let sd = T::lit(CALIBRATION_SD) * self.scale.share(corner);
        self.bank.update(sd * sd, |state| {
            let mut slope = State::zeros();
            slope[at] = T::one();
            (slope, -state[at])
        });
    }

    /// Whether the car is known well enough for an unlikely residual to be a tire that changes; in a calibration, for one to
    /// be punctured.
    pub(super) fn expects_onsets(&self) -> bool {
        let calibration = &self.calibration;
        let enough_s = if calibration.active { calibration.from_s + CALIBRATING_ENOUGH_S } else { ENOUGH_S };
        self.learned_s >= enough_s
    }

    /// Keeps what is believed at the end of a calibration, if it saw enough.
    fn store_calibration(&mut self) {
        let seconds = self.learned_s - self.calibration.from_s;
        if seconds >= ENOUGH_S {
            let learned = self.to_calibration(T::lit(seconds));
            self.calibration.stored.set(Some(learned));
            self.losses.settle_soon(self.learned_s);
        }
    }

    fn to_calibration(&self, learned_s: T) -> VehicleCalibration<T> {
        let (mean, sd) = self.bank.constant();
        let of = |at: usize, unit: T| Learned { value: mean[at] * unit, sd: sd[at] * unit };
        let one = |at: usize| of(at, T::one());
        let corner = |i: usize| {
            self.present[i].then(|| {
                let placard = self.scale.placard_kpa[i];
                CornerCalibration {
                    placard_kpa: placard,
                    unsprung_mass: one(MASS + i),
                    damping: one(DAMPING + i),
                    spring: one(SPRING + i),
                    spectrum_bias_kpa: of(SPECTRUM_BIAS + i, placard),
                    shared_road_bias: one(ROAD_BIAS + i),
                }
            })
        };
        VehicleCalibration {
            corners: core::array::from_fn(corner),
            bar: [one(BAR), one(BAR + 1)],
            rear_axle_coupling: one(COUPLING),
            gain: [one(GAIN), one(GAIN + 1)],
            wheelbase: one(WHEELBASE),
            skew_s: [SKEW, SKEW + 1].map(|at| of(at, T::lit(SKEW_UNIT_S))),
            learned_s,
        }
    }

    /// Begins with what an earlier calibration taught.
    /// Errors: a calibration of other corners or other placard pressures.
    pub(crate) fn load_calibration(
        &mut self,
        calibration: &VehicleCalibration<T>,
    ) -> Result<(), CalibrationError> {
        let [mass, damping, spring, bar, gain, wheelbase, skew, bias, road_bias] = LEAST_SD.map(T::lit);
        // A tenth of a kPa is more than any file loses.
        let is_its = |(i, learned): (usize, &Option<CornerCalibration<T>>)| match learned {
            Some(learned) => {
                let apart_kpa = (learned.placard_kpa - self.scale.placard_kpa[i]).abs();
                self.present[i] && apart_kpa < T::lit(0.1)
            }
            None => !self.present[i],
        };
        if !calibration.corners.iter().enumerate().all(is_its) {
            return Err(CalibrationError::OtherCar);
        }
        let bank = &mut self.bank;
        bank.free_masses(&self.mass_sd);
        for (i, learned) in calibration.corners.iter().enumerate() {
            let Some(learned) = learned else { continue };
            let placard = self.scale.placard_kpa[i];
            bank.set_quantity(MASS + i, &learned.unsprung_mass, mass, T::one());
            bank.set_quantity(DAMPING + i, &learned.damping, damping, T::one());
            bank.set_quantity(SPRING + i, &learned.spring, spring, T::one());
            bank.set_quantity(SPECTRUM_BIAS + i, &learned.spectrum_bias_kpa, bias * placard, placard);
            bank.set_quantity(ROAD_BIAS + i, &learned.shared_road_bias, road_bias, T::one());
        }
        for i in 0..2 {
            bank.set_quantity(BAR + i, &calibration.bar[i], bar, T::one());
            bank.set_quantity(GAIN + i, &calibration.gain[i], gain, T::one());
            bank.set_quantity(SKEW + i, &calibration.skew_s[i], skew, T::lit(SKEW_UNIT_S));
        }
        bank.set_quantity(COUPLING, &calibration.rear_axle_coupling, bar, T::one());
        bank.set_quantity(WHEELBASE, &calibration.wheelbase, wheelbase, T::one());
        // On another day, roads are others.
        bank.free_common_bias();
        self.calibration.loaded.set(Some(*calibration));
        self.calibration.calibrated = true;
        Ok(())
    }
}
