//! What a reset taught about the car, on its way from the belief to a stored reference and back into a belief.

use crate::belief::state::{
    BAR, COMMON_BIAS, DAMPING, GAIN, MASS, OWN_BIAS, ROAD_BIAS, SKEW, SKEW_UNIT_S, SPRING, State, WHEELBASE,
};
use crate::inter_axle::{ENOUGH_S, SharedRoad};
use crate::model::{CalibrationError, CornerCalibration, Learned, VehicleCalibration};
use crate::real::Real;

/// Least sd that is recalled: unsprung mass (another rim), damping (warm oil), spring, bar, gain, wheelbase over speed
/// (other tires), skew in s, the spectrum's bias as a share of the placard pressure, and the shared road's.
const LEAST_SD: [f64; 9] = [0.003, 0.05, 0.02, 0.01, 0.003, 0.003, 5e-4, 0.02, 0.01];

/// Mean and sd of every quantity when a reset was over, and the seconds of shared road it saw.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(crate) struct CalibrationResult<T: Real> {
    mean: State<T>,
    sd: State<T>,
    seconds: T,
}

impl<T: Real> SharedRoad<T> {
    /// Keeps what is believed at the end of a reset, if it saw enough.
    pub(crate) fn store_calibration(&mut self) {
        let seconds = self.learned_s - self.calibrating_from_s;
        if seconds >= ENOUGH_S {
            let (mean, sd) = self.bank.constant();
            self.calibration_result = Some(CalibrationResult { mean, sd, seconds: T::lit(seconds) });
        }
    }

    /// What the last reset taught.
    pub(crate) fn learned(&self) -> Option<VehicleCalibration<T>> {
        let CalibrationResult { mean, sd, seconds } = self.calibration_result.as_ref()?;
        let of = |at: usize, unit: T| Learned { value: mean[at] * unit, sd: sd[at] * unit };
        let one = |at: usize| of(at, T::one());
        let corner = |i: usize| {
            self.wheels[i].map(|_| {
                let placard = self.scale.placard_kpa[i];
                let (common, own) = (of(COMMON_BIAS, placard), of(OWN_BIAS + i, placard));
                let bias_sd = (common.sd * common.sd + own.sd * own.sd).sqrt();
                CornerCalibration {
                    placard_kpa: placard,
                    unsprung_mass: one(MASS + i),
                    damping: one(DAMPING + i),
                    spring: one(SPRING + i),
                    spectrum_bias_kpa: Learned { value: common.value + own.value, sd: bias_sd },
                    shared_road_bias: one(ROAD_BIAS + i),
                }
            })
        };
        Some(VehicleCalibration {
            corners: core::array::from_fn(corner),
            bar: [one(BAR), one(BAR + 1)],
            gain: [one(GAIN), one(GAIN + 1)],
            wheelbase: one(WHEELBASE),
            skew_s: [SKEW, SKEW + 1].map(|at| of(at, T::lit(SKEW_UNIT_S))),
            learned_s: *seconds,
        })
    }

    /// Begins with what an earlier reset taught.
    ///
    /// # Errors
    /// A reference for other corners or other placard pressures.
    pub(crate) fn load_calibration(
        &mut self,
        reference: &VehicleCalibration<T>,
    ) -> Result<(), CalibrationError> {
        let [mass, damping, spring, bar, gain, wheelbase, skew, bias, road_bias] = LEAST_SD.map(T::lit);
        for (i, learned) in reference.corners.iter().enumerate() {
            match (learned, &self.wheels[i]) {
                (Some(learned), Some(_)) => {
                    let placard = self.scale.placard_kpa[i];
                    // A tenth of a kPa is more than any file loses.
                    if !((learned.placard_kpa - placard).abs() < T::lit(0.1)) {
                        return Err(CalibrationError::OtherCar);
                    }
                    self.bank.begin_with(MASS + i, &learned.unsprung_mass, mass, T::one());
                    self.bank.begin_with(DAMPING + i, &learned.damping, damping, T::one());
                    self.bank.begin_with(SPRING + i, &learned.spring, spring, T::one());
                    self.bank.begin_with(OWN_BIAS + i, &learned.spectrum_bias_kpa, bias * placard, placard);
                    self.bank.begin_with(ROAD_BIAS + i, &learned.shared_road_bias, road_bias, T::one());
                }
                (None, None) => {}
                _ => return Err(CalibrationError::OtherCar),
            }
        }
        for i in 0..2 {
            self.bank.begin_with(BAR + i, &reference.bar[i], bar, T::one());
            self.bank.begin_with(GAIN + i, &reference.gain[i], gain, T::one());
            self.bank.begin_with(SKEW + i, &reference.skew_s[i], skew, T::lit(SKEW_UNIT_S));
        }
        self.bank.begin_with(WHEELBASE, &reference.wheelbase, wheelbase, T::one());
        self.loaded = Some(*reference);
        self.calibrated = true;
        Ok(())
    }
}
