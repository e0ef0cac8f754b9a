//! Struts and body as a drive has shown them: by themselves, in the kilograms of the vehicle file, or against what the car was when it was healthy.

use itpms_data::reference::{FRICTION_ELEMENTS, SuspensionReference};
use nalgebra::SMatrix;

use super::because::Because;
use super::car_body::CarBody;
use super::equation::{
    ASYMMETRY, BAR, DAMPER, FORCE_N, KNEE, LATE, LATE_S, LEFT, MASS, PITCH, Parameters, REAR, ROLL, SLIP,
    SPRING, UNKNOWNS, WARP, slip,
};
use super::fit::{Fit, Prior, fit};
use super::spectra::{HOP_S, Sum, SuspensionSpectra, TooLittle};

/// What a drive has shown.
#[derive(Debug, Clone)]
pub struct SuspensionReading {
    /// Struts and body; in the file's kilograms.
    pub found: SuspensionReference,
    /// Covariance of the logarithms of the hydraulic damping of the four corners, of the fit alone.
    pub ln_damping_covariance: [[f64; 4]; 4],
    /// Share of the body's motion that is not explained.
    pub unexplained: f64,
    /// Whether rough frames had to be taken.
    pub is_rough: bool,
    /// Standard deviation of the logarithm of the mass, of the fit alone; zero where it is held.
    pub ln_mass_sd: f64,
}

/// Rate in m/s (rms) at which damping is compared, and mean of `|v|³` over that of `v²` at a rate of one (Gaussian).
const RATE_M_S: f64 = 0.1;
const CUBE: f64 = 1.596;
/// Equivalent damping of a newton of dry friction at a rate of one (rms, Gaussian): the root of two over pi.
const COULOMB: f64 = 0.797_9;
/// Share of the body's motion that may stay unexplained.
const MOST_UNEXPLAINED: f64 = 0.35;
/// Share of dry friction in what struts damp up to which a drive teaches a reference.
const MOST_FRICTION_TO_LEARN: f64 = 0.5;
/// Roll inertia over mass and half of the track squared, pitch inertia over that of masses at the axles: what is usual.
const USUAL_ROLL: f64 = 0.65;
const USUAL_PITCH: f64 = 0.95;
const USUAL_BAR: f64 = 0.3;
const USUAL_FRICTION: f64 = 0.3;
/// By how much, as a share, springs of an axle differ.
const ALIKE_SD: f64 = 0.02;
/// Least damping, over the file's, that a ratio is made of.
const LEAST_DAMPING: f64 = 0.02;
/// Fits of a loaded car whose springs stiffen: mass and springs go together.
const STIFFENING_PASSES: usize = 4;

impl SuspensionReading {
    /// By the drive alone, with the mass of the file.
    ///
    /// # Errors
    /// Too little was seen, or it does not fit.
    pub fn alone(car: &CarBody, spectra: &SuspensionSpectra) -> Result<Self, Because> {
        let sum = summed(spectra)?;
        let rear = car.rear_share();
        let mut mean = Parameters::zeros();
        mean[REAR] = rear;
        mean[PITCH] = (USUAL_PITCH * rear * (1.0 - rear)).ln();
        mean[ROLL] = USUAL_ROLL.ln();
        let mut sd = Parameters::repeat(0.0);
        (sd[REAR], sd[LEFT], sd[PITCH], sd[ROLL], sd[WARP]) = (0.03 * rear, 1e-3, 0.25, 0.25, 0.3);
        for i in 0..4 {
            mean[DAMPER + i] = 1.0;
            (sd[DAMPER + i], sd[SPRING + i], sd[LATE + i]) = (0.5, 0.3, 1.0);
            (sd[ASYMMETRY + i], sd[KNEE + i]) = (0.5, 1.5);
        }
        for axle in 0..2 {
            (mean[BAR + axle], sd[BAR + axle]) = (USUAL_BAR, 0.5);
        }
        for i in SLIP..UNKNOWNS {
            (mean[i], sd[i]) = (USUAL_FRICTION, 1.0);
        }
        let mut alike_sd = Parameters::zeros();
        for i in [SPRING, SPRING + 2] {
            alike_sd[i] = ALIKE_SD;
        }
        let prior = Prior { mean, sd, alike_sd };
        let found = fit(car, &sum, &prior, &mean).ok_or(Because::Unexplained)?;
        Self::of(car, &sum, &found)
    }

    /// Against a healthy one: springs and bars are the reference's, so that mass, center of gravity and dampers come out in its units.
    ///
    /// # Errors
    /// Too little was seen, or it does not fit.
    pub fn against(
        car: &CarBody,
        spectra: &SuspensionSpectra,
        reference: &SuspensionReference,
    ) -> Result<Self, Because> {
        let sum = summed(spectra)?;
        let mut mean = parameters(car, reference);
        let mut sd = Parameters::repeat(0.0);
        (sd[MASS], sd[REAR], sd[LEFT]) = (0.3, 0.15 * reference.rear_share, 0.04);
        (sd[PITCH], sd[ROLL], sd[WARP]) = (0.25, 0.25, 0.05);
        for i in 0..4 {
            let own = mean[DAMPER + i];
            (sd[DAMPER + i], sd[LATE + i]) = (0.6 * own, 0.3);
            (sd[ASYMMETRY + i], sd[KNEE + i]) = (0.2 * own, 0.15 * own);
        }
        for axle in 0..2 {
            sd[BAR + axle] = 0.05 * mean[BAR + axle].abs().max(0.05);
        }
        sd.fixed_rows_mut::<{ UNKNOWNS - SLIP }>(SLIP).fill(1.0);
        let mut begin = mean;
        let mut found = None;
        let passes = if car.spring_stiffening_per_m > 0.0 { STIFFENING_PASSES } else { 1 };
        for _ in 0..passes {
            let prior = Prior { mean, sd, alike_sd: Parameters::zeros() };
            let next = fit(car, &sum, &prior, &begin).ok_or(Because::Unexplained)?;
            begin = next.parameters;
            let springs = car.stiffened(reference, &of_parameters(car, &next.parameters, 0.0));
            for (i, spring) in springs.into_iter().enumerate() {
                mean[SPRING + i] = (spring / car.spring_n_per_m[i]).ln();
                begin[SPRING + i] = mean[SPRING + i];
            }
            found = Some(next);
        }
        Self::of(car, &sum, &found.ok_or(Because::Unexplained)?)
    }

    /// The reference of later drives.
    ///
    /// # Errors
    /// Friction held the struts: what it hides in this drive shows in another.
    pub fn as_reference(&self) -> Result<SuspensionReference, Because> {
        match self.found.friction_share < MOST_FRICTION_TO_LEARN {
            true => Ok(self.found),
            false => Err(Because::Smooth),
        }
    }

    fn of(car: &CarBody, sum: &Sum, fit: &Fit) -> Result<Self, Because> {
        if !(fit.unexplained < MOST_UNEXPLAINED) {
            return Err(Because::Unexplained);
        }
        let mut found = of_parameters(car, &fit.parameters, HOP_S * sum.frames);
        let share = |i: usize| {
            let friction = COULOMB * found.friction_n[i].iter().sum::<f64>() / sum.rate_rms_m_s[i];
            friction / (friction + found.hydraulic_n_s_per_m[i])
        };
        found.friction_share = (0..4).map(share).fold(0.0, f64::max);
        // Of c + 1.6 v e, over itself.
        let mut slopes = SMatrix::<f64, 4, UNKNOWNS>::zeros();
        for i in 0..4 {
            let over = car.damping_n_s_per_m[i] / found.hydraulic_n_s_per_m[i];
            (slopes[(i, DAMPER + i)], slopes[(i, KNEE + i)]) = (over, CUBE * RATE_M_S * over);
        }
        let covariance = slopes * fit.covariance * slopes.transpose();
        Ok(Self {
            found,
            ln_damping_covariance: std::array::from_fn(|i| std::array::from_fn(|j| covariance[(i, j)])),
            unexplained: fit.unexplained,
            is_rough: sum.is_rough,
            ln_mass_sd: fit.covariance[(MASS, MASS)].max(0.0).sqrt(),
        })
    }
}

fn summed(spectra: &SuspensionSpectra) -> Result<Sum, Because> {
    spectra.sum().map_err(|why| match why {
        TooLittle::Short => Because::Short,
        TooLittle::Smooth => Because::Smooth,
        TooLittle::Rough => Because::Rough,
    })
}

/// The parameters of the equation as quantities.
fn of_parameters(car: &CarBody, p: &Parameters, driving_s: f64) -> SuspensionReference {
    let of_file = |at: usize| std::array::from_fn(|i| car.damping_n_s_per_m[i] * p[at + i]);
    let hydraulic = |i: usize| {
        car.damping_n_s_per_m[i] * (p[DAMPER + i] + CUBE * RATE_M_S * p[KNEE + i]).max(LEAST_DAMPING)
    };
    SuspensionReference {
        sprung_mass_kg: car.sprung_mass_kg() * p[MASS].exp(),
        rear_share: p[REAR],
        left_offset: p[LEFT],
        pitch: p[PITCH].exp(),
        roll: p[ROLL].exp(),
        warp: p[WARP],
        damping_n_s_per_m: of_file(DAMPER),
        asymmetry_n_s_per_m: of_file(ASYMMETRY),
        knee_n_s2_per_m2: of_file(KNEE),
        spring_n_per_m: std::array::from_fn(|i| car.spring_n_per_m[i] * p[SPRING + i].exp()),
        bar_n_per_m: std::array::from_fn(|axle| p[BAR + axle] * car.axle_spring_n_per_m(axle)),
        friction_n: std::array::from_fn(|i| std::array::from_fn(|element| FORCE_N * p[slip(i, element)])),
        lateness_s: std::array::from_fn(|i| LATE_S * p[LATE + i]),
        hydraulic_n_s_per_m: std::array::from_fn(hydraulic),
        friction_share: f64::NAN,
        driving_s,
    }
}

/// The same back.
fn parameters(car: &CarBody, of: &SuspensionReference) -> Parameters {
    let mut p = Parameters::zeros();
    p[MASS] = (of.sprung_mass_kg / car.sprung_mass_kg()).ln();
    (p[REAR], p[LEFT], p[PITCH], p[ROLL], p[WARP]) =
        (of.rear_share, of.left_offset, of.pitch.ln(), of.roll.ln(), of.warp);
    for i in 0..4 {
        let file = car.damping_n_s_per_m[i];
        p[DAMPER + i] = of.damping_n_s_per_m[i] / file;
        p[ASYMMETRY + i] = of.asymmetry_n_s_per_m[i] / file;
        p[KNEE + i] = of.knee_n_s2_per_m2[i] / file;
        p[SPRING + i] = (of.spring_n_per_m[i] / car.spring_n_per_m[i]).ln();
        p[LATE + i] = of.lateness_s[i] / LATE_S;
        for element in 0..FRICTION_ELEMENTS {
            p[slip(i, element)] = of.friction_n[i][element] / FORCE_N;
        }
    }
    for axle in 0..2 {
        p[BAR + axle] = of.bar_n_per_m[axle] / car.axle_spring_n_per_m(axle);
    }
    p
}
