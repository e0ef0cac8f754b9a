//! Conclusion about the car whenever something was learned, and a hundred times a second: what the corners find and the road they share, fused into one estimate, and
//! how its errors go together. Called by the car's estimator; takes no samples.

use nalgebra::{SMatrix, SVector};

use super::fusion::{FusedEstimate, Fusion, SingleWheelEstimate};
use super::{CarEstimator, Sources};
use crate::estimator::{CornerConclusion, FusedStiffness};
use crate::memory::{Blank, Placed};
use crate::model::{AxleFit, CarSample, Corner, CornerEstimate, Level, Side, TrackState};
use crate::real::Real;

/// The last conclusions: about each corner, and about all together.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Concluded<T: Real> {
    pub(super) corners: [Placed<CornerConclusion<T>>; 4],
    pub(super) correlation: [[T; 4]; 4],
    pub(super) loss_correlation: [[T; 4]; 4],
    pub(super) tracks: [TrackState<T>; 2],
}

impl<T: Real> CarEstimator<T> {
    /// Concludes what is known of all corners that the sample has, with a corner's own measurement if it `has_room` for that.
    #[inline(never)]
    pub(super) fn conclude(&mut self, time_s: f64, has_room: bool, sample: &CarSample<T>) {
        let fused = self.fuse(time_s, has_room);
        for corner in Corner::ALL.into_iter().filter(|&corner| sample.corners[corner].is_some()) {
            self.conclude_corner(time_s, corner, fused.as_ref());
        }
        let fused = fused
            .map(|(fused, considered)| FusedEstimate { covariance: fused.covariance + considered, ..fused });
        self.compare(sample, fused.as_ref());
    }

    /// Concludes what is known of a corner, with the fused estimate and what the vehicle file leaves open of it.
    #[inline(never)]
    fn conclude_corner(
        &mut self,
        time_s: f64,
        corner: Corner,
        fused: Option<&(FusedEstimate<T>, SMatrix<T, 4, 4>)>,
    ) {
        let Some(estimator) = self.corners[corner].as_mut() else { return };
        let (i, fusion) = (corner.index(), self.fusion.as_ref());
        let fused = fused.zip(fusion.filter(|fusion| fusion.has_partner(corner)));
        let fused = fused.map(|((fused, considered), fusion)| {
            let learning = fusion.track(corner.side()).shared;
            FusedStiffness {
                stiffness_n_per_m: fused.stiffness_n_per_m[i],
                stiffness_sd_n_per_m: fused.covariance[(i, i)].sqrt(),
                considered_sd_n_per_m: considered[(i, i)].sqrt(),
                level: fusion.level(),
                changing: fused.changing,
                learned_s: fused.learned_s,
                learning,
                has_signal: fusion.has_signal(corner) && (learning || !fusion.is_slow()),
            }
        });
        let paired = fusion.filter(|fusion| fusion.has_partner(corner));
        let fit = paired.map_or(AxleFit::BLANK, |fusion| fusion.axle_fit(corner.side()));
        let concluded = estimator.conclude(time_s, fused.as_ref(), &fit);
        self.concluded.corners[corner].place(|place| *place = concluded);
    }

    /// A corner's estimate at a sample, if that has the corner.
    pub(super) fn estimate(
        &mut self,
        corner: Corner,
        now_s: f64,
        sample: &CarSample<T>,
    ) -> Option<CornerEstimate<T>> {
        self.corners[corner].as_ref().zip(sample.corners[corner].as_ref())?;
        if self.concluded.corners[corner].as_ref().is_none() {
            self.conclude_corner(now_s, corner, None);
        }
        Some(self.concluded.corners[corner].as_ref()?.at(sample.time_s))
    }

    #[inline(never)]
    fn compare(&mut self, sample: &CarSample<T>, fused: Option<&FusedEstimate<T>>) {
        let of_sample = |corner: Corner| sample.corners[corner].and(self.concluded.corners[corner].as_ref());
        let corners = Corner::ALL.map(of_sample);
        let (correlation, tracks) = (self.correlation(&corners, fused), self.tracks());
        let sds = corners.map(|corner| Some(corner?.pressure_sd_kpa));
        let losses = fused.and_then(|fused| Some(self.considered.losses(fused.losses.as_ref()?, &sds)));
        for wheel in Corner::ALL.into_iter().filter(|&wheel| sample.corners[wheel].is_some()) {
            let Some(corner) = self.concluded.corners[wheel].as_mut() else { continue };
            let (axle, correlation) =
                (sds[wheel].zip(sds[wheel.same_axle()]), correlation[wheel][wheel.same_axle()]);
            corner.axle_difference_sd_kpa =
                axle.map(|(a, b)| (a * a + b * b - T::lit(2.0) * correlation * a * b).max(T::zero()).sqrt());
            corner.loss = losses.as_ref().map(|(losses, _)| losses[wheel]);
        }
        (self.concluded.correlation, self.concluded.tracks) = (correlation, tracks);
        self.concluded.loss_correlation = losses.map_or(correlation, |(_, errors)| coefficients(&errors));
    }

    /// Fuses what the corners find with the shared road; gives the fused estimate and what the vehicle file leaves open of it, if it
    /// counts: a shared road that was given up must not leave its last estimate behind.
    #[inline(never)]
    fn fuse(&mut self, time_s: f64, has_room: bool) -> Option<(FusedEstimate<T>, SMatrix<T, 4, 4>)> {
        let fusion = self.fusion.as_mut()?;
        if time_s.is_finite() {
            // With the next sample that has room for it, which is this one but for a frame that became complete with it.
            if let Some(seconds) = self.calibration_s.take_if(|_| has_room) {
                self.calibration_ends_s = time_s + seconds;
                fusion.begin_calibration();
            }
            fusion.set_calibrating(time_s < self.calibration_ends_s);
        }
        for corner in Corner::ALL {
            let Some(estimator) = self.corners[corner].as_ref() else { continue };
            fusion.set_on_line(corner, estimator.is_on_line());
        }
        if self.sources == Sources::SpectrumAndSharedRoad {
            let mut has_room = has_room;
            for corner in Corner::ALL {
                let Some(estimator) = self.corners[corner].as_mut() else { continue };
                let (stiffness_n_per_m, sd_n_per_m) = estimator.own_stiffness();
                let changing = estimator.change_probability();
                let found = SingleWheelEstimate { changing, stiffness_n_per_m, sd_n_per_m };
                fusion.set_single_wheel(corner, found);
                // Between frames, and one corner a sample: all of them at once are much work.
                if has_room
                    && let Some(spectral) = estimator.pseudo_measurement(|| fusion.expected_spectral(corner))
                {
                    fusion.update_spectral(corner, time_s, spectral.stiffness_n_per_m, spectral.sd_n_per_m);
                    has_room = false;
                }
            }
        }
        let trusted = self.sources != Sources::Spectrum && fusion.is_trusted();
        let mut fused = trusted.then(|| fusion.estimate());
        let level = fusion.level();
        self.considered.coupling = fusion.axle_coupling();
        let mut considered = fused.as_ref().map(|fused| match level {
            Level::Calibration => self.considered.calibrated(&fused.stiffness_n_per_m),
            Level::StoredCalibration => self.considered.stored(&fused.stiffness_n_per_m),
            Level::VehicleFile | Level::OtherTires => self.considered.uncalibrated(&fused.stiffness_n_per_m),
        });
        if let (Some(radii), Some(fused), Some(considered)) =
            (self.radii.as_ref(), fused.as_mut(), considered.as_mut())
        {
            self.considered.join_radii(radii, level, fused, considered);
        }
        fused.zip(considered)
    }

    /// Correlation coefficients of the pressures' errors: of the fused estimate, or of what the corners have in common by the vehicle file.
    fn correlation(
        &self,
        corners: &[Option<&CornerConclusion<T>>; 4],
        fused: Option<&FusedEstimate<T>>,
    ) -> [[T; 4]; 4] {
        let of = |value: fn(&CornerConclusion<T>) -> T| {
            SVector::<T, 4>::from_fn(|i, _| corners[i].map_or(T::zero(), value))
        };
        let covariance = match fused {
            Some(fused) => fused.covariance,
            None => {
                let sd = of(|corner| corner.stiffness_sd_n_per_m);
                let mut covariance = self.considered.uncalibrated(&of(CornerConclusion::stiffness_n_per_m));
                covariance.set_diagonal(&sd.component_mul(&sd));
                covariance
            }
        };
        coefficients(&covariance)
    }

    fn tracks(&self) -> [TrackState<T>; 2] {
        let of = |fusion: &Fusion<T>| Side::ALL.map(|side| fusion.track(side));
        self.fusion.as_ref().map_or([TrackState::unknown(); 2], of)
    }
}

fn coefficients<T: Real>(covariance: &SMatrix<T, 4, 4>) -> [[T; 4]; 4] {
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let variances = covariance[(i, i)] * covariance[(j, j)];
            match i == j {
                true => T::one(),
                false if variances > T::zero() => covariance[(i, j)] / variances.sqrt(),
                false => T::zero(),
            }
        })
    })
}
