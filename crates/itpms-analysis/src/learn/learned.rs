//! The car that comes out, parameter by parameter: what the file states, what is believed now.

use itpms_core::model::{CarConfig, CornerConfig, PressureMap, QuarterCar};

use super::parameter::Parameter;
use super::weigh::Belief;
use super::{DriveReading, LearnError, strut};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnedCorner {
    pub unsprung_mass_kg: Parameter,
    pub tire_n_per_m: Parameter,
    /// Stiffness over unsprung mass in 1/s², the level of every uncalibrated pressure.
    pub stiffness_over_mass: Parameter,
    pub damping_n_s_per_m: Parameter,
    pub spring_n_per_m: Parameter,
    pub friction_n: Parameter,
}

/// The result of the drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Learned {
    pub corners: [Option<LearnedCorner>; 4],
    /// Slope of stiffness over pressure over the file's, of all tires alike.
    pub slope: Parameter,
    pub car: CarConfig<f64>,
}

pub(super) fn learned(
    file: &CarConfig<f64>,
    belief: &Belief,
    drives: &[DriveReading],
) -> Result<Learned, LearnError> {
    let [u, u_sd] = belief.slope();
    let file_slope_sd = |c: &CornerConfig<f64>| c.tire.stiffness_per_kpa_sd() / c.tire.stiffness_per_kpa();
    let before_sd = file.corners.iter().flatten().map(file_slope_sd).fold(0.0, f64::max);
    let slope = Parameter {
        before: 1.0,
        before_sd: if before_sd > 0.0 { before_sd } else { super::weigh::SLOPE_SD },
        after: 1.0 + u,
        after_sd: u_sd,
    };
    let (mut corners, mut car) = ([None; 4], *file);
    for (i, stated) in file.corners.iter().enumerate() {
        let Some(stated) = stated else { continue };
        let corner = corner(stated, i, belief, drives);
        car.corners[i] = Some(config(stated, &corner, &slope)?);
        corners[i] = Some(corner);
    }
    Ok(Learned { corners, slope, car })
}

fn corner(stated: &CornerConfig<f64>, i: usize, belief: &Belief, drives: &[DriveReading]) -> LearnedCorner {
    let (mass_kg, known) = (stated.quarter_car.unsprung_mass_kg(), &stated.uncertainty);
    let tire_n_per_m = stated.tire.stiffness_n_per_m(stated.placard_kpa);
    let [mass, tire] = [belief.mass(i), belief.tire(i)];
    let [damping_n_s_per_m, spring_n_per_m, friction_n] = strut::strut(stated, i, drives);
    LearnedCorner {
        unsprung_mass_kg: Parameter::share(mass_kg, known.unsprung_mass_relative_sd, mass),
        tire_n_per_m: Parameter::share(tire_n_per_m, known.stiffness_relative_sd, tire),
        stiffness_over_mass: Parameter::share(
            tire_n_per_m / mass_kg,
            known.tire_relative_sd(),
            [tire[0] - mass[0], belief.ratio_sd(i)],
        ),
        damping_n_s_per_m,
        spring_n_per_m,
        friction_n,
    }
}

fn config(
    stated: &CornerConfig<f64>,
    corner: &LearnedCorner,
    slope: &Parameter,
) -> Result<CornerConfig<f64>, LearnError> {
    let relative = |parameter: &Parameter| parameter.after_sd / parameter.after;
    let quarter_car = QuarterCar::new(
        stated.quarter_car.sprung_mass_kg(),
        corner.unsprung_mass_kg.after,
        corner.damping_n_s_per_m.after,
        corner.spring_n_per_m.after,
    )?;
    // The line turns about its point at placard pressure, where stiffness over mass was read.
    let scale = corner.tire_n_per_m.after / corner.tire_n_per_m.before;
    let per_kpa = scale * slope.after * stated.tire.stiffness_per_kpa();
    let at_zero = corner.tire_n_per_m.after - per_kpa * stated.placard_kpa;
    let per_kpa_sd = per_kpa * slope.after_sd / slope.after;
    let tire = PressureMap::new(per_kpa, at_zero.max(0.0))?.with_uncertainty(
        per_kpa_sd,
        per_kpa_sd * stated.placard_kpa,
        -1.0,
    )?;
    let mut uncertainty = stated.uncertainty;
    uncertainty.unsprung_mass_relative_sd = relative(&corner.unsprung_mass_kg);
    uncertainty.stiffness_relative_sd = relative(&corner.tire_n_per_m);
    uncertainty.stiffness_over_mass_relative_sd = Some(relative(&corner.stiffness_over_mass));
    uncertainty.damping_relative_sd = relative(&corner.damping_n_s_per_m);
    uncertainty.spring_relative_sd = relative(&corner.spring_n_per_m);
    (uncertainty.friction_n, uncertainty.friction_sd_n) =
        (corner.friction_n.after, corner.friction_n.after_sd);
    Ok(CornerConfig { quarter_car, tire, uncertainty, ..*stated })
}
