//! A strut's damper, spring and friction: what the body's motion shows of them, against the file (docs/math/learn.md, section 3).

use itpms_core::model::CornerConfig;

use super::parameter::Parameter;
use super::{DriveReading, StrutMean};

/// Sd of the error of the body motion's fit on cars that are not their file: damper and spring as shares, friction in N.
const DAMPING_SD: f64 = 0.05;
const SPRING_SD: f64 = 0.07;
const FRICTION_SD_N: f64 = 6.0;

/// Damping, spring and friction of a corner.
pub(super) fn strut(corner: &CornerConfig<f64>, at: usize, drives: &[DriveReading]) -> [Parameter; 3] {
    let (car, known) = (&corner.quarter_car, &corner.uncertainty);
    let read: Vec<&StrutMean> = drives.iter().filter_map(|drive| drive.struts[at].as_ref()).collect();
    let mean = |of: &dyn Fn(&StrutMean) -> f64| {
        (!read.is_empty()).then(|| read.iter().map(|strut| of(strut)).sum::<f64>() / read.len() as f64)
    };
    // Forces are read for the file's sprung mass, and are as wrong as that.
    let mass_sd = known.sprung_mass_relative_sd;
    let share = |before: f64, sd: f64, read: Option<f64>, fit_sd: f64| {
        let read = read.map(|value| [(value / before).ln(), fit_sd.hypot(mass_sd)]);
        Parameter::share(before, sd, weighed([0.0, sd], read))
    };
    let damping = mean(&|strut| strut.damping_n_s_per_m);
    let spring = mean(&|strut| strut.spring_n_per_m);
    let friction = mean(&|strut| strut.friction_n).map(|n| [n, FRICTION_SD_N.hypot(n * mass_sd)]);
    let [friction_n, friction_sd_n] = weighed([known.friction_n, known.friction_sd_n], friction);
    [
        share(car.damping_n_s_per_m(), known.damping_relative_sd, damping, DAMPING_SD),
        share(car.spring_n_per_m(), known.spring_relative_sd, spring, SPRING_SD),
        Parameter {
            before: known.friction_n,
            before_sd: known.friction_sd_n,
            after: friction_n.max(0.0),
            after_sd: friction_sd_n,
        },
    ]
}

/// Mean and standard deviation of two independent sources together.
fn weighed(file: [f64; 2], read: Option<[f64; 2]>) -> [f64; 2] {
    let Some(read) = read else { return file };
    let [weight, read_weight] = [file, read].map(|[_, sd]| 1.0 / (sd * sd).max(1e-12));
    let mean = (weight * file[0] + read_weight * read[0]) / (weight + read_weight);
    [mean, (weight + read_weight).sqrt().recip()]
}
