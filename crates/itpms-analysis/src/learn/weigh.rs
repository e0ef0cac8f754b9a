//! One Gaussian over what four tires and their wheels' masses are, given by the file and by drives (docs/math/learn.md, section 2).

use itpms_core::model::{CarConfig, CornerConfig};
use nalgebra::{SMatrix, SVector};

use super::DriveReading;

/// Unknowns: logarithms of unsprung masses and of tire stiffnesses at placard pressure over the file's, the slope of stiffness over pressure less
/// one, and what the estimator reads too much on this car.
const MASS: usize = 0;
const TIRE: usize = 4;
const SLOPE: usize = 8;
const BIAS: usize = 9;
const SIZE: usize = 10;
/// Of a slope whose standard deviation the file does not say.
pub(super) const SLOPE_SD: f64 = 0.05;
/// What an estimate reads too much or too little on one car, whatever the road: what is no mass, spring or damper.
const BIAS_SD: f64 = 0.015;
/// The same on one road: of all wheels alike, and of each by itself with what a gauge is wrong by.
const ROAD_SD: f64 = 0.015;
const OWN_SD: f64 = 0.01;

type Unknowns = SVector<f64, SIZE>;
type Covariance = SMatrix<f64, SIZE, SIZE>;

/// Prior of masses and tires.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Belief {
    mean: Unknowns,
    covariance: Covariance,
}

impl Belief {
    /// Logarithm of an unsprung mass over the file's, with its standard deviation.
    pub(super) fn mass(&self, corner: usize) -> [f64; 2] {
        self.of(MASS + corner)
    }

    /// The same of a tire's stiffness at placard pressure.
    pub(super) fn tire(&self, corner: usize) -> [f64; 2] {
        self.of(TIRE + corner)
    }

    /// The slope of stiffness over pressure over the file's less one, with its standard deviation.
    pub(super) fn slope(&self) -> [f64; 2] {
        self.of(SLOPE)
    }

    /// Relative standard deviation of a tire's stiffness over its unsprung mass.
    pub(super) fn ratio_sd(&self, corner: usize) -> f64 {
        let (m, k, c) = (MASS + corner, TIRE + corner, &self.covariance);
        (c[(m, m)] + c[(k, k)] - 2.0 * c[(m, k)]).max(0.0).sqrt()
    }

    fn of(&self, i: usize) -> [f64; 2] {
        [self.mean[i], self.covariance[(i, i)].max(0.0).sqrt()]
    }

    /// Values `h x` with errors of this covariance were read.
    fn update<const N: usize>(
        &mut self,
        read: &SVector<f64, N>,
        h: &SMatrix<f64, N, SIZE>,
        errors: &SMatrix<f64, N, N>,
    ) {
        let expected = h * self.covariance * h.transpose() + errors;
        // A sum of covariances that no value can make singular: `errors` is positive definite.
        let Some(inverse) = expected.try_inverse() else { return };
        let gain = self.covariance * h.transpose() * inverse;
        self.mean += gain * (read - h * self.mean);
        // Joseph's form: it stays symmetric and positive.
        let keep = Covariance::identity() - gain * h;
        self.covariance = keep * self.covariance * keep.transpose() + gain * errors * gain.transpose();
    }
}

pub(super) fn weigh(file: &CarConfig<f64>, drives: &[DriveReading]) -> Belief {
    let mut belief = prior(file);
    know_ratios(file, &mut belief);
    for drive in drives {
        hear(file, drive, &mut belief);
    }
    belief
}

/// By the file's standard deviations; what wheels and tires have in common is as everywhere (docs/math/unknown-car.md, eq. 7).
fn prior(file: &CarConfig<f64>) -> Belief {
    let mut covariance = Covariance::zeros();
    let both = |i: usize, j: usize| {
        Some((file.corners[i].as_ref()?.uncertainty, file.corners[j].as_ref()?.uncertainty))
    };
    for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let Some((a, b)) = both(i, j) else { continue };
        let axle = if i / 2 == j / 2 { a.axle_mass_relative_sd() * b.axle_mass_relative_sd() } else { 0.0 };
        let own = if i == j { a.own_tire_relative_sd().powi(2) } else { 0.0 };
        covariance[(MASS + i, MASS + j)] = a.common_mass_relative_sd() * b.common_mass_relative_sd() + axle;
        covariance[(TIRE + i, TIRE + j)] = a.common_tire_relative_sd() * b.common_tire_relative_sd() + own;
    }
    let slope_sd_of =
        |corner: &CornerConfig<f64>| corner.tire.stiffness_per_kpa_sd() / corner.tire.stiffness_per_kpa();
    let slope_sd = file.corners.iter().flatten().map(slope_sd_of).fold(0.0, f64::max);
    covariance[(SLOPE, SLOPE)] = if slope_sd > 0.0 { slope_sd } else { SLOPE_SD }.powi(2);
    covariance[(BIAS, BIAS)] = BIAS_SD * BIAS_SD;
    Belief { mean: Unknowns::zeros(), covariance }
}

/// A file that knows stiffness over mass better than the two, as one that was learned: a reading without a drive, whose errors leave that much.
fn know_ratios(file: &CarConfig<f64>, belief: &mut Belief) {
    let mut h = SMatrix::<f64, 4, SIZE>::zeros();
    let mut share = SVector::<f64, 4>::zeros();
    for (i, corner) in file.corners.iter().enumerate() {
        let Some(stated_sd) = corner.as_ref().and_then(|c| c.uncertainty.stiffness_over_mass_relative_sd)
        else {
            continue;
        };
        let before = belief.ratio_sd(i);
        if stated_sd < before {
            (h[(i, MASS + i)], h[(i, TIRE + i)]) = (-1.0, 1.0);
            // Of variances: v r / (v + r) = stated_sd².
            share[i] = stated_sd.max(1e-4) / (before * before - stated_sd * stated_sd).sqrt();
        }
    }
    if share.iter().all(|share| *share == 0.0) {
        return;
    }
    let known = h * belief.covariance * h.transpose();
    let mut errors = SMatrix::<f64, 4, 4>::from_fn(|i, j| share[i] * share[j] * known[(i, j)]);
    for i in (0..4).filter(|&i| share[i] == 0.0) {
        errors[(i, i)] = 1.0;
    }
    belief.update(&SVector::zeros(), &h, &errors);
}

/// docs/math/learn.md, eq. 2, of all wheels that were read.
fn hear(file: &CarConfig<f64>, drive: &DriveReading, belief: &mut Belief) {
    let (mut read, mut h) = (SVector::<f64, 4>::zeros(), SMatrix::<f64, 4, SIZE>::zeros());
    let mut errors = SMatrix::<f64, 4, 4>::identity();
    for i in 0..4 {
        let (Some(wheel), Some(corner)) = (&drive.wheels[i], &file.corners[i]) else { continue };
        let (kpa, tire) = (drive.pressures_kpa[i], &corner.tire);
        let nominal = tire.stiffness_n_per_m(kpa) / corner.quarter_car.unsprung_mass_kg();
        read[i] = (wheel.stiffness_over_mass / nominal).ln();
        let change = tire.stiffness_per_kpa() * (kpa - corner.placard_kpa) / tire.stiffness_n_per_m(kpa);
        (h[(i, MASS + i)], h[(i, TIRE + i)], h[(i, SLOPE)], h[(i, BIAS)]) = (-1.0, 1.0, change, 1.0);
        errors[(i, i)] = ROAD_SD.powi(2) + OWN_SD.powi(2) + wheel.relative_sd.powi(2);
        for j in (0..i).filter(|&j| drive.wheels[j].is_some()) {
            (errors[(i, j)], errors[(j, i)]) = (ROAD_SD.powi(2), ROAD_SD.powi(2));
        }
    }
    belief.update(&read, &h, &errors);
}
