//! The parameters that fit best, from the cross-spectral matrix alone: Gauss-Newton steps, each bin of each corner weighed by what the equation
//! leaves of it (docs/math/dampers.md, eq. 5 to 7).

use nalgebra::{Complex, DMatrix, DVector, SMatrix};

use super::car_body::CarBody;
use super::equation::{
    BAR, DAMPER, LATE, MASS, PITCH, Parameters, REAR, SLIP, SPRING, Sparse, Strut, UNKNOWNS, WARP, compliance,
};
use super::signals::{BODY, SIGNALS};
use super::spectra::{ALL, Sum};

/// Prior values with their standard deviations; zero holds a parameter.
#[derive(Debug, Clone)]
pub(super) struct Prior {
    pub(super) mean: Parameters,
    pub(super) sd: Parameters,
    /// Of the difference between left and right of an axle, where both are free: by the first of them. Zero: nothing is known of it.
    pub(super) alike_sd: Parameters,
}

#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub(super) parameters: Parameters,
    /// Of the fit alone: cars differ from the equation by more.
    pub(super) covariance: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    /// Share of the bodies' power that the equation leaves.
    pub(super) unexplained: f64,
}

const PASSES: usize = 15;
/// Step, in parameters, below which a fit has settled.
const SETTLED: f64 = 1e-4;
const LARGEST_STEP: f64 = 0.4;
/// Power that the equation is taken to leave at least, over the body's.
const MODEL_ERROR: f64 = 1e-3;
/// Share of a frame that is new, of one whose neighbors are half the same, and degrees of freedom of a complex number.
const PER_FRAME: f64 = 0.5 * 2.0;

type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Part of the bins, the quietest, in which what is left is nothing but noise, where anything is.
const NOISE_QUANTILE: f64 = 0.15;

/// Fits from `begin` on; then once more without the sensors' noise, which is the file's unless less than that is left.
pub(super) fn fit(car: &CarBody, sum: &Sum, prior: &Prior, begin: &Parameters) -> Option<Fit> {
    let first = fit_once(car, sum, prior, begin)?;
    let mut sum = sum.clone();
    let quietest = noise_left(car, &sum, &first.parameters);
    let noise = car.accel_noise_m_s2.map(|rms| (rms * rms).min(quietest).max(0.0));
    sum.bins.iter_mut().for_each(|bin| bin.take_off(&noise));
    fit_once(car, &sum, prior, &first.parameters)
}

/// The variance in (m/s²)² of the noise of a sensor that would explain what is left in the quietest bins.
fn noise_left(car: &CarBody, sum: &Sum, p: &Parameters) -> f64 {
    let (g, _) = compliance(car, p);
    let mut all = Vec::new();
    for bin in &sum.bins {
        let mut noise = bin.clone();
        noise.matrix.fill(Complex::new(0.0, 0.0));
        noise.take_off(&[-1.0; 4]);
        let terms = Terms::new(car, p, &[true; UNKNOWNS], std::f64::consts::TAU * bin.hz);
        let [seen, noise] = [&bin.matrix, &noise.matrix].map(|matrix| terms.powers(matrix));
        for row in 0..4 {
            let residual = residual(&g, row);
            let [seen, noise] = [&seen, &noise].map(|powers| dot(&residual, &times(powers, &residual)));
            all.push(seen / noise.max(1e-30));
        }
    }
    all.sort_by(f64::total_cmp);
    all.get((NOISE_QUANTILE * all.len() as f64) as usize).copied().unwrap_or(0.0)
}

fn fit_once(car: &CarBody, sum: &Sum, prior: &Prior, begin: &Parameters) -> Option<Fit> {
    let mut p = *begin;
    for i in (0..UNKNOWNS).filter(|i| !(prior.sd[*i] > 0.0)) {
        p[i] = prior.mean[i];
    }
    let mut held: [bool; UNKNOWNS] = std::array::from_fn(|i| !(prior.sd[i] > 0.0));
    let mut unexplained = 1.0;
    let mut covariance = Square::zeros();
    for pass in 0..PASSES {
        let (mut information, mut score) = (Square::zeros(), Parameters::zeros());
        unexplained = accumulate(car, sum, &p, &held, &mut information, &mut score);
        for i in (0..UNKNOWNS).filter(|i| prior.sd[*i] > 0.0) {
            let weight = prior.sd[i].powi(-2);
            information[(i, i)] += weight;
            score[i] += weight * (prior.mean[i] - p[i]);
        }
        for i in (0..UNKNOWNS).filter(|i| prior.alike_sd[*i] > 0.0) {
            let (j, weight) = (i + 1, prior.alike_sd[i].powi(-2));
            let apart = p[i] - p[j];
            (information[(i, i)], information[(j, j)]) =
                (information[(i, i)] + weight, information[(j, j)] + weight);
            (information[(i, j)], information[(j, i)]) =
                (information[(i, j)] - weight, information[(j, i)] - weight);
            (score[i], score[j]) = (score[i] - weight * apart, score[j] + weight * apart);
        }
        let (step, inverse) = solve(&information, &score, &p, &mut held, prior)?;
        covariance = inverse;
        let mut largest = 0.0f64;
        for i in 0..UNKNOWNS {
            let step = step[i].clamp(-LARGEST_STEP, LARGEST_STEP);
            let [least, most] = bounds(i);
            let next = (p[i] + step).clamp(least, most);
            largest = largest.max((next - p[i]).abs());
            p[i] = next;
        }
        if largest < SETTLED && pass > 2 {
            break;
        }
        // A slip force that was held at zero may come back.
        for (held, sd) in held.iter_mut().zip(&prior.sd).skip(SLIP) {
            *held = !(*sd > 0.0);
        }
    }
    p.iter().all(|value| value.is_finite()).then_some(Fit { parameters: p, covariance, unexplained })
}

/// Between which a parameter is believed.
fn bounds(i: usize) -> [f64; 2] {
    match i {
        REAR => [0.1, 0.9],
        PITCH..WARP => [-6.0, 3.0],
        WARP => [0.0, 1.5],
        DAMPER..SPRING => [-0.5, 6.0],
        MASS | SPRING..BAR => [-1.5, 1.5],
        LATE..20 => [-6.0, 6.0],
        SLIP.. => [0.0, 20.0],
        _ => [-30.0, 30.0],
    }
}

/// The step, and the covariance; slip forces that would become negative are held at zero.
fn solve(
    information: &Square,
    score: &Parameters,
    p: &Parameters,
    held: &mut [bool; UNKNOWNS],
    prior: &Prior,
) -> Option<(Parameters, Square)> {
    loop {
        let (mut equations, mut target) = (*information, *score);
        for i in (0..UNKNOWNS).filter(|i| held[*i]) {
            // A slip force that is held goes to zero.
            let way = if i >= SLIP && prior.sd[i] > 0.0 { -p[i] } else { 0.0 };
            for j in 0..UNKNOWNS {
                target[j] -= equations[(j, i)] * way;
            }
            for j in 0..UNKNOWNS {
                (equations[(i, j)], equations[(j, i)]) = (0.0, 0.0);
            }
            (equations[(i, i)], target[i]) = (1.0, way);
        }
        let cholesky = equations.cholesky()?;
        let step = cholesky.solve(&target);
        let negative = (SLIP..UNKNOWNS).find(|i| !held[*i] && p[*i] + step[*i] < 0.0);
        match negative {
            Some(i) => held[i] = true,
            None => {
                let mut inverse = cholesky.inverse();
                (0..UNKNOWNS).filter(|i| held[*i]).for_each(|i| inverse[(i, i)] = 0.0);
                return Some((step, inverse));
            }
        }
    }
}

/// Adds what all bins say; gives the share of the bodies' power that is left.
fn accumulate(
    car: &CarBody,
    sum: &Sum,
    p: &Parameters,
    held: &[bool; UNKNOWNS],
    information: &mut Square,
    score: &mut Parameters,
) -> f64 {
    let (mut left, mut all) = (0.0, 0.0);
    let (g, g_slopes) = compliance(car, p);
    for bin in &sum.bins {
        let terms = Terms::new(car, p, held, std::f64::consts::TAU * bin.hz);
        let powers = terms.powers(&bin.matrix);
        for row in 0..4 {
            let residual = residual(&g, row);
            let with_residual = times(&powers, &residual);
            let power = dot(&residual, &with_residual);
            let body = powers[(row, row)];
            left += power / body.max(1e-30);
            all += 1.0;
            let weight = PER_FRAME * sum.frames / power.max(MODEL_ERROR * body).max(1e-30);
            let slopes = terms.slopes(&g, &g_slopes, held, row);
            let products: Vec<_> = slopes.iter().map(|(_, slope)| times(&powers, slope)).collect();
            for (at, (i, slope)) in slopes.iter().enumerate() {
                score[*i] -= weight * dot(slope, &with_residual);
                for ((j, _), product) in slopes.iter().zip(&products).take(at + 1) {
                    let value = weight * dot(slope, product);
                    information[(*i, *j)] += value;
                    if i != j {
                        information[(*j, *i)] += value;
                    }
                }
            }
        }
    }
    left / all
}

/// What residuals and their derivatives are sums of, with real factors, at one frequency: the bodies' accelerations, the struts' forces, and
/// the forces' derivatives by the parameters that are free.
struct Terms {
    weights: Vec<Sparse>,
    /// Parameter and corner of each derivative.
    of: Vec<(usize, usize)>,
}

const FORCES: usize = 4;
const DERIVATIVES: usize = 8;

/// A sum of terms: the place of each, and its factor.
type Factors = Vec<(usize, f64)>;

impl Terms {
    fn new(car: &CarBody, p: &Parameters, held: &[bool; UNKNOWNS], omega: f64) -> Self {
        let body = |corner| vec![(corner * SIGNALS + BODY, Complex::new(1.0, 0.0))];
        let mut new = Self { weights: (0..4).map(body).collect(), of: Vec::new() };
        let mut derivatives = Vec::new();
        for corner in 0..4 {
            let strut = Strut::new(car, p, corner, omega);
            new.weights.push(strut.force);
            for (i, slope) in strut.slopes.into_iter().filter(|(i, _)| !held[*i]) {
                new.of.push((i, corner));
                derivatives.push(slope);
            }
        }
        new.weights.extend(derivatives);
        new
    }

    /// `Re(u C v*)` of any two of them: of the mean of `z z*`, what they have in common.
    fn powers(&self, matrix: &DMatrix<Complex<f64>>) -> DMatrix<f64> {
        let mut powers = DMatrix::zeros(self.weights.len(), self.weights.len());
        for (j, v) in self.weights.iter().enumerate() {
            let mut product = [Complex::new(0.0, 0.0); ALL];
            for (k, weight) in v {
                let weight = weight.conj();
                product.iter_mut().zip(matrix.column(*k)).for_each(|(sum, value)| *sum += value * weight);
            }
            for (i, u) in self.weights.iter().enumerate().take(j + 1) {
                let power = u.iter().map(|(k, w)| w.re * product[*k].re - w.im * product[*k].im).sum();
                (powers[(i, j)], powers[(j, i)]) = (power, power);
            }
        }
        powers
    }

    /// The derivatives of a corner's residual by the parameters that are free.
    fn slopes(
        &self,
        g: &SMatrix<f64, 4, 4>,
        g_slopes: &[SMatrix<f64, 4, 4>; DAMPER],
        held: &[bool; UNKNOWNS],
        row: usize,
    ) -> Vec<(usize, Factors)> {
        let mut slopes: Vec<(usize, Factors)> =
            (0..DAMPER).filter(|i| !held[*i]).map(|i| (i, forces(&g_slopes[i], row))).collect();
        for (at, (i, corner)) in self.of.iter().enumerate() {
            let factor = (DERIVATIVES + at, -g[(row, *corner)]);
            match slopes.iter_mut().find(|(known, _)| known == i) {
                Some((_, factors)) => factors.push(factor),
                None => slopes.push((*i, vec![factor])),
            }
        }
        slopes
    }
}

fn forces(g: &SMatrix<f64, 4, 4>, row: usize) -> Factors {
    (0..4).map(|corner| (FORCES + corner, -g[(row, corner)])).collect()
}

/// Residual of a corner's acceleration (eq. 4).
fn residual(g: &SMatrix<f64, 4, 4>, row: usize) -> Factors {
    [vec![(row, 1.0)], forces(g, row)].concat()
}

fn times(powers: &DMatrix<f64>, factors: &Factors) -> DVector<f64> {
    let mut product = DVector::zeros(powers.nrows());
    factors.iter().for_each(|(k, factor)| product.axpy(*factor, &powers.column(*k), 1.0));
    product
}

fn dot(factors: &Factors, product: &DVector<f64>) -> f64 {
    factors.iter().map(|(k, factor)| factor * product[*k]).sum()
}
