//! Fisher information of stationary Gaussian signals (`docs/math/bound.md`, eq. 1-4).
//!
//! Called by the bounds of a corner and of a side; the transfers also by the sources of information (`observability`). A
//! corner's spectral matrix is `Phi(f) = S(f) g g^H + N I`: a road of density `S`, the transfers `g` from road to body and
//! wheel acceleration, white sensor noise of density `N`.

use itpms_core::model::CornerConfig;
use nalgebra::{Complex, Matrix2, Matrix3, SMatrix, Vector2};

use super::BoundSetting;

/// Frequency at which the road's level is the parameter, so that level and slope are nearly uncorrelated.
pub const LEVEL_HZ: f64 = 10.0;
/// The wheel hop is about 2.6 Hz wide: fifty points across it make the trapezoidal rule exact to 1e-4.
pub const STEP_HZ: f64 = 0.05;

type Spectral = Matrix2<Complex<f64>>;

/// Everything the information depends on but the pressure.
#[derive(Debug, Clone)]
pub(super) struct Fisher {
    corner: CornerConfig<f64>,
    setting: BoundSetting,
}

pub(super) struct SpectralModel {
    pub(super) phi: Spectral,
    /// By pressure (kPa), logarithm of the level, slope.
    pub(super) derivatives: [Spectral; 3],
}

impl Fisher {
    pub(super) fn new(corner: &CornerConfig<f64>, setting: &BoundSetting) -> Self {
        Self { corner: *corner, setting: *setting }
    }

    /// One-sided spectral matrix of (body, wheel) acceleration in m²/s⁴/Hz.
    pub(super) fn model(&self, frequency_hz: f64, pressure_kpa: f64) -> SpectralModel {
        let (g, g_p) = transfers(&self.corner, frequency_hz, pressure_kpa);

        // S(f) = Gd(f / V) / V
        let speed = self.setting.speed_m_s;
        let road = self.setting.road.density_m3(frequency_hz / speed) / speed;
        let rate = self.setting.rate_hz;
        let noise = 2.0 * self.setting.accel_noise_m_s2.powi(2) / rate;
        let signal = g * g.adjoint() * Complex::from(road);
        let by_pressure = (g_p * g.adjoint() + g * g_p.adjoint()) * Complex::from(road);
        let by_slope = signal * Complex::from(-(frequency_hz / LEVEL_HZ).ln());
        SpectralModel {
            phi: signal + Spectral::identity() * Complex::from(noise),
            derivatives: [by_pressure, signal, by_slope],
        }
    }

    /// Information per second (eq. 3).
    pub(super) fn per_second(&self, pressure_kpa: f64) -> Matrix3<f64> {
        over_the_band(self.setting.band_hz, |frequency_hz| {
            let model = self.model(frequency_hz, pressure_kpa);
            information(&model.phi, &model.derivatives)
        })
    }
}

/// Integral over a band in Hz.
pub(super) fn over_the_band<const N: usize>(
    (low, high): (f64, f64),
    at: impl Fn(f64) -> SMatrix<f64, N, N>,
) -> SMatrix<f64, N, N> {
    let steps = ((high - low) / STEP_HZ).ceil().max(1.0);
    let step = (high - low) / steps;
    let mut sum = SMatrix::zeros();
    for k in 0..=steps as usize {
        let at_end = k == 0 || k == steps as usize;
        let weight = if at_end { 0.5 * step } else { step };
        sum += at(low + k as f64 * step) * weight;
    }
    sum
}

/// Transfer from the road's height to (body, wheel) acceleration in 1/s² at a gauge pressure, and its derivative by the
/// pressure in 1/(s² kPa) (`docs/math/bound.md`, below eq. 1).
pub fn transfers(
    corner: &CornerConfig<f64>,
    frequency_hz: f64,
    pressure_kpa: f64,
) -> (Vector2<Complex<f64>>, Vector2<Complex<f64>>) {
    let car = &corner.quarter_car;
    let k_t = corner.tire.stiffness_n_per_m(pressure_kpa);
    let s = Complex::new(0.0, std::f64::consts::TAU * frequency_hz);
    let one = Complex::new(1.0, 0.0);
    // X_b = B X_w, then (m_w s² + Z (1 - B)) X_w = D X_w = k_t (X_r - X_w)
    let z = s * car.damping_n_s_per_m() + car.spring_n_per_m();
    let b = z / (s * s * car.sprung_mass_kg() + z);
    let d = s * s * car.unsprung_mass_kg() + z * (one - b);
    let h = Complex::from(k_t) / (d + k_t);
    // ∂h/∂k_t = D / (D + k_t)²
    let h_k = d / ((d + k_t) * (d + k_t));
    let shape = Vector2::new(b, one) * (s * s);
    (shape * h, shape * (h_k * corner.tire.stiffness_per_kpa()))
}

/// Information of one complex Gaussian vector of `C` signals about `N` parameters, `tr(Phi⁻¹ ∂Phi/∂i Phi⁻¹ ∂Phi/∂j)` (eq. 2).
pub(super) fn information<const C: usize, const N: usize>(
    phi: &SMatrix<Complex<f64>, C, C>,
    derivatives: &[SMatrix<Complex<f64>, C, C>; N],
) -> SMatrix<f64, N, N> {
    let Some(inverse) = phi.try_inverse() else { return SMatrix::repeat(f64::NAN) };
    let whitened = derivatives.map(|derivative| inverse * derivative);
    SMatrix::from_fn(|i, j| (whitened[i] * whitened[j]).trace().re)
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::QuarterCar;
    use itpms_paper::quarter_car::{self, state};
    use nalgebra::{Matrix4, Vector4, Vector5};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    fn paper() -> Fisher {
        Fisher::new(&CornerConfig::paper(), &BoundSetting::paper())
    }

    /// The same spectral matrix from the state-space model: `g = C (sI - A)^-1 B + D` with the Jacobians of `itpms-paper`.
    fn spectral_matrix_by_state_space(f: f64, k_t: f64) -> Spectral {
        let car = QuarterCar::<f64>::paper_table_2();
        let mut x = Vector5::zeros();
        x[state::TIRE_STIFFNESS] = k_t;
        let complex = |v: f64| Complex::new(v, 0.0);
        let a: Matrix4<_> =
            quarter_car::derivative_jacobian(&car, &x, 0.0).fixed_view::<4, 4>(0, 0).map(complex);
        let h = quarter_car::output_jacobian(&car, &x, 0.0).fixed_view::<2, 4>(0, 0).map(complex);
        let d = quarter_car::input_jacobian(&car, &x).map(complex);
        let b = Vector4::new(complex(0.0), complex(0.0), complex(0.0), d[1]);
        let s = Complex::new(0.0, std::f64::consts::TAU * f);
        let g = h * (Matrix4::identity() * s - a).try_inverse().unwrap() * b + d;
        let speed = 20.0 / 3.6;
        let road = 16e-6 * (f / speed / 0.1).powf(-2.14) / speed;
        g * g.adjoint() * complex(road) + Spectral::identity() * complex(2.0 * 0.05 * 0.05 / 500.0)
    }

    #[test]
    fn pressure_information_is_the_curvature_of_the_relative_entropy() {
        // KL(p, p + e) = tr(Phi_e^-1 Phi) - 2 + ln det Phi_e - ln det Phi = J e²/2 + O(e³); both signs cancel the odd
        // term. A second implementation throughout: state space instead of transfer functions, no derivative.
        let divergence = |f: f64, e: f64| {
            let phi = spectral_matrix_by_state_space(f, 713.91 * 241.3 + 60_880.0);
            let other = spectral_matrix_by_state_space(f, 713.91 * (241.3 + e) + 60_880.0);
            let ratio = other.try_inverse().unwrap() * phi;
            ratio.trace().re - 2.0 - ratio.determinant().re.ln()
        };
        let steps = 2000;
        let width = 57.0 / f64::from(steps);
        let information: f64 = (0..steps)
            .map(|k| 3.0 + (f64::from(k) + 0.5) * width)
            .map(|f| (divergence(f, 1.0) + divergence(f, -1.0)) * width)
            .sum();
        let found = paper().per_second(241.3)[(0, 0)];
        // e = 1 kPa in 241: the fourth-order term is (1/241)² of the second at most times the resonance's sharpness.
        assert!((found / information - 1.0).abs() < 2e-3, "{found} for {information}");
    }

    #[test]
    fn derivatives_agree_with_finite_differences() {
        let fisher = paper();
        for f in [4.0, 10.5, 12.0, 47.0] {
            let found = fisher.model(f, 200.0).derivatives;
            let by_pressure = (fisher.model(f, 200.1).phi - fisher.model(f, 199.9).phi) / Complex::from(0.2);
            assert!((found[0] - by_pressure).norm() < 1e-5 * by_pressure.norm());
            let tilted = |e: f64| {
                let mut setting = BoundSetting::paper();
                let speed = setting.speed_m_s;
                // Level held at 10 Hz while the slope turns.
                setting.road.gd_n0_m3 *= (LEVEL_HZ / speed / 0.1).powf(e);
                setting.road.waviness += e;
                Fisher::new(&CornerConfig::paper(), &setting).model(f, 200.0).phi
            };
            let by_slope = (tilted(1e-4) - tilted(-1e-4)) / Complex::from(2e-4);
            assert!((found[2] - by_slope).norm() < 1e-5 * (by_slope.norm() + found[1].norm()));
        }
    }

    #[test]
    fn a_road_without_noise_tells_its_level_once_per_bin() {
        // 2 B T real values of unknown variance carry B T of information about its logarithm: B per second.
        let setting = BoundSetting { accel_noise_m_s2: 1e-6, ..BoundSetting::paper() };
        let f = Fisher::new(&CornerConfig::paper(), &setting).per_second(241.3);
        assert!((f[(1, 1)] / 57.0 - 1.0).abs() < 1e-3, "{}", f[(1, 1)]);
        // And the slope: the integral of ln²(f / 10 Hz) over 3..60 Hz, by its antiderivative.
        let antiderivative = |f: f64| f * ((f / 10.0).ln().powi(2) - 2.0 * (f / 10.0).ln() + 2.0);
        let slope = antiderivative(60.0) - antiderivative(3.0);
        assert!((f[(2, 2)] / slope - 1.0).abs() < 1e-3, "{} for {slope}", f[(2, 2)]);
    }

    #[test]
    fn information_is_the_variance_of_the_score() {
        // Two seconds: 115 bins half a hertz apart, each a complex Gaussian pair drawn from Phi. The score by pressure
        // is sum(y^H Phi^-1 dPhi Phi^-1 y - tr Phi^-1 dPhi).
        let fisher = paper();
        let bins: Vec<SpectralModel> =
            (0..115).map(|k| fisher.model(3.0 + 0.5 * f64::from(k), 241.3)).collect();
        let parts: Vec<(Spectral, Spectral, f64)> = bins
            .iter()
            .map(|bin| {
                let inverse = bin.phi.try_inverse().unwrap();
                let slope = inverse * bin.derivatives[0];
                (bin.phi.cholesky().unwrap().l(), slope * inverse, slope.trace().re)
            })
            .collect();
        let mut rng = Pcg64::seed_from_u64(7);
        let mut normal =
            || <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng) * 0.5f64.sqrt();
        let draws = 4000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..draws {
            let score: f64 = parts
                .iter()
                .map(|(root, kernel, mean)| {
                    let y = root * Vector2::from_fn(|_, _| Complex::new(normal(), normal()));
                    (y.adjoint() * kernel * y)[(0, 0)].re - mean
                })
                .sum();
            sum += score;
            squares += score * score;
        }
        let (mean, variance) = (sum / f64::from(draws), squares / f64::from(draws));
        let expected: f64 = bins.iter().map(|bin| information(&bin.phi, &bin.derivatives)[(0, 0)]).sum();
        // The variance of 4000 draws is known to 2.3 % (a little more: the score is not quite Gaussian).
        assert!((variance / expected - 1.0).abs() < 0.12, "{variance} for {expected}");
        assert!(mean.abs() < 5.0 * (expected / f64::from(draws)).sqrt());
        // Bins half a hertz apart are the integral over two seconds.
        assert!((expected / (2.0 * fisher.per_second(241.3)[(0, 0)]) - 1.0).abs() < 0.02);
    }
}
