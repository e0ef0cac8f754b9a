//! Fisher information of wheels that pass over the same stretch of road (`docs/math/identifiability.md`, eq. 11-17).
//!
//! Called by `sources`, which says who passes where and how often. One formula holds for all: the spectral matrix of all passes is `Phi = G
//! G^H + I` after whitening, one road behind every signal, and its information falls into what the road's power says of the stiffness and
//! what the passes say about each other. It must not know which of the four sources it serves.

use itpms_core::model::CornerConfig;
use nalgebra::{Complex, DMatrix, DVector, Vector2};

use super::car;
use itpms_analysis::bound::{BoundSetting, LEVEL_HZ, STEP_HZ, transfers};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RoadModel {
    /// Nothing: another unknown power at every frequency.
    Free,
    /// A power law of unknown level and slope: the last two parameters.
    PowerLaw,
    /// Its height is known at every point.
    Surveyed,
}

#[derive(Debug, Clone)]
pub(super) struct Pass {
    pub(super) corner: CornerConfig<f64>,
    pub(super) pressure_kpa: f64,
    pub(super) parameter: usize,
    /// Where the parameters of its car begin; `None`: the car is known.
    pub(super) car: Option<usize>,
    /// How long it drove there, over all repetitions.
    pub(super) seconds: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Occurrence {
    /// Once by every pass, which then take the same time: a spectrum without gaps.
    Once,
    /// Again and again with this period in s: the harmonics of `1/period` alone, their amplitudes always the same.
    Repeated(f64),
}

/// A stretch of road and those who pass over it.
#[derive(Debug, Clone)]
pub(super) struct Stretch {
    pub(super) passes: Vec<Pass>,
    pub(super) occurrence: Occurrence,
    /// Share of the road's power that each pass has for itself: no two tracks are quite the same. 0 to less than 1.
    pub(super) incoherent: f64,
}

/// Adds a stretch's information about `(pressures and cars..., ln level at 10 Hz, slope)` to a square matrix of that order.
pub(super) fn add(sum: &mut DMatrix<f64>, stretch: &Stretch, model: RoadModel, setting: &BoundSetting) {
    let (low, high) = setting.band_hz;
    match stretch.occurrence {
        Occurrence::Once => {
            let Some(seconds) = stretch.passes.first().map(|pass| pass.seconds) else { return };
            let steps = ((high - low) / STEP_HZ).ceil().max(1.0);
            let step = (high - low) / steps;
            for k in 0..=steps as usize {
                let ends = if k == 0 || k == steps as usize { 0.5 } else { 1.0 };
                let bins = ends * step * seconds;
                *sum += at_frequency(stretch, model, setting, low + k as f64 * step, sum.nrows()) * bins;
            }
        }
        Occurrence::Repeated(period_s) => {
            let first = (low * period_s).ceil();
            let last = (high * period_s).floor();
            let mut k = first;
            while k <= last {
                *sum += at_frequency(stretch, model, setting, k / period_s, sum.nrows());
                k += 1.0;
            }
        }
    }
}

/// Information of one frequency bin (eq. 14).
fn at_frequency(
    stretch: &Stretch,
    model: RoadModel,
    setting: &BoundSetting,
    frequency_hz: f64,
    order: usize,
) -> DMatrix<f64> {
    let channels = 2 * stretch.passes.len();
    let others = order - 2;
    let mut g = DVector::<Complex<f64>>::zeros(channels);
    let mut slopes = DMatrix::<Complex<f64>>::zeros(channels, others);
    let road = setting.road.density_m3(frequency_hz / setting.speed_m_s) / setting.speed_m_s;
    let noise = 2.0 * setting.accel_noise_m_s2.powi(2) / setting.rate_hz;
    for (row, pass) in stretch.passes.iter().enumerate() {
        let (transfer, by_kpa) = transfers(&pass.corner, frequency_hz, pass.pressure_kpa);
        // Averaging over repetitions leaves the line and divides the noise.
        let repetitions = match stretch.occurrence {
            Occurrence::Once => 1.0,
            Occurrence::Repeated(period_s) => pass.seconds / period_s,
        };
        // The pass's own part is noise along its own transfer; both are whitened together (eq. 19).
        let own = road * stretch.incoherent / noise;
        let shrink = (1.0 - (1.0 + own * transfer.norm_squared()).sqrt().recip()) / transfer.norm_squared();
        let scale = Complex::from((road * (1.0 - stretch.incoherent) / noise * repetitions).sqrt());
        let whitened = |v: &Vector2<Complex<f64>>| (v - transfer * (transfer.dotc(v) * shrink)) * scale;
        g.fixed_rows_mut::<2>(2 * row).copy_from(&whitened(&transfer));
        slopes.fixed_view_mut::<2, 1>(2 * row, pass.parameter).copy_from(&whitened(&by_kpa));
        if let Some(start) = pass.car {
            let by_car = car::slopes(&pass.corner, frequency_hz, pass.pressure_kpa);
            for (i, slope) in by_car.iter().enumerate() {
                slopes.fixed_view_mut::<2, 1>(2 * row, start + i).copy_from(&whitened(slope));
            }
        }
    }
    let rho = g.norm_squared();
    if !(rho > 0.0) {
        return DMatrix::zeros(order, order);
    }
    let explained = rho / (1.0 + rho);
    // a_i: how much a parameter stretches g; d_i: how much it turns g (eq. 13).
    let stretching = g.adjoint() * &slopes / Complex::from(rho);
    let mut turning = &slopes - &g * &stretching;
    for (i, mut column) in turning.column_iter_mut().enumerate() {
        // One pass alone cannot turn: what rounding leaves of it is no information.
        if column.norm() < ROUNDING * slopes.column(i).norm() {
            column.fill(Complex::from(0.0));
        }
    }
    let mut information = DMatrix::zeros(order, order);
    let by_turning = match model {
        RoadModel::Surveyed => slopes.adjoint() * &slopes * Complex::from(2.0),
        RoadModel::Free | RoadModel::PowerLaw => {
            turning.adjoint() * &turning * Complex::from(2.0 * explained)
        }
    };
    information.view_mut((0, 0), (others, others)).copy_from(&by_turning.map(|value| value.re));
    if model == RoadModel::PowerLaw {
        let mut power = DVector::zeros(order);
        for i in 0..others {
            power[i] = 2.0 * stretching[i].re;
        }
        power[others] = 1.0;
        power[others + 1] = -(frequency_hz / LEVEL_HZ).ln();
        information += &power * power.transpose() * explained.powi(2);
    }
    information
}

/// A difference of vectors below this share of them is rounding.
const ROUNDING: f64 = 1e-12;

/// Below this share of the best-known direction nothing counts as known: rounding leaves some 1e-14.
const NOTHING: f64 = 1e-10;

/// Smallest variance of an unbiased estimate of `combination · parameters`, everything else unknown; infinite where the
/// information does not fix it.
pub(super) fn variance(information: &DMatrix<f64>, combination: &[f64]) -> f64 {
    // To unit diagonal, so that kPa and logarithms can be compared.
    let scale: Vec<f64> =
        information.diagonal().iter().map(|&d| if d > 0.0 { d.sqrt() } else { 0.0 }).collect();
    let seen: Vec<usize> = (0..scale.len()).filter(|&i| scale[i] > 0.0).collect();
    if seen.is_empty() || (0..combination.len()).any(|i| combination[i] != 0.0 && scale[i] == 0.0) {
        return f64::INFINITY;
    }
    let scaled = DMatrix::from_fn(seen.len(), seen.len(), |i, j| {
        information[(seen[i], seen[j])] / (scale[seen[i]] * scale[seen[j]])
    });
    let wanted = DVector::from_fn(seen.len(), |i, _| combination[seen[i]] / scale[seen[i]]);
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut sum = 0.0;
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let share = vector.dot(&wanted);
        if *value > NOTHING * largest {
            sum += share * share / value;
        } else if share.abs() > 1e-6 * wanted.norm() {
            return f64::INFINITY;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observability::rear;
    use itpms_analysis::bound::CornerBound;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    const P: f64 = 241.3;

    fn pass(corner: CornerConfig<f64>, pressure_kpa: f64, parameter: usize, seconds: f64) -> Pass {
        Pass { corner, pressure_kpa, parameter, car: None, seconds }
    }

    fn pair(seconds: f64) -> Stretch {
        let passes = vec![pass(CornerConfig::paper(), P, 0, seconds), pass(rear(), P, 1, seconds)];
        Stretch { passes, occurrence: Occurrence::Once, incoherent: 0.0 }
    }

    fn information(
        stretch: &Stretch,
        model: RoadModel,
        setting: &BoundSetting,
        pressures: usize,
    ) -> DMatrix<f64> {
        let mut sum = DMatrix::zeros(pressures + 2, pressures + 2);
        add(&mut sum, stretch, model, setting);
        sum
    }

    #[test]
    fn one_pass_over_a_power_law_is_the_bound_of_one_corner() {
        let setting = BoundSetting { accel_noise_m_s2: 2.0, ..BoundSetting::paper() };
        let passes = vec![pass(CornerConfig::paper(), P, 0, 5.0)];
        let stretch = Stretch { passes, occurrence: Occurrence::Once, incoherent: 0.0 };
        let found =
            variance(&information(&stretch, RoadModel::PowerLaw, &setting, 1), &[1.0, 0.0, 0.0]).sqrt();
        let expected = CornerBound::new(&CornerConfig::paper(), &setting).unwrap().sd_kpa(5.0, P);
        // The same integral on the same frequencies, by another formula.
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        // Nothing assumed of the road: nothing known.
        assert!(
            variance(&information(&stretch, RoadModel::Free, &setting, 1), &[1.0, 0.0, 0.0]).is_infinite()
        );
    }

    /// `tr(Phi⁻¹ ∂Phi_i Phi⁻¹ ∂Phi_j)` with a 4x4 matrix and its finite differences; the last parameter is ln S of the
    /// common road. What each pass has for itself stays.
    fn by_traces(f: f64, setting: &BoundSetting, incoherent: f64) -> DMatrix<f64> {
        let road = setting.road.density_m3(f / setting.speed_m_s) / setting.speed_m_s;
        let noise = 2.0 * setting.accel_noise_m_s2.powi(2) / setting.rate_hz;
        let (a, b) = (transfers(&CornerConfig::paper(), f, P).0, transfers(&rear(), f, P).0);
        let mut own = DMatrix::identity(4, 4) * Complex::from(noise);
        for (i, g) in [a, b].iter().enumerate() {
            let mut block = own.view_mut((2 * i, 2 * i), (2, 2));
            block += g * g.adjoint() * Complex::from(road * incoherent);
        }
        let phi = |front: f64, rear_kpa: f64, ln_level: f64| {
            let (a, b) = (transfers(&CornerConfig::paper(), f, front).0, transfers(&rear(), f, rear_kpa).0);
            let g = DVector::from_vec(vec![a[0], a[1], b[0], b[1]]);
            &g * g.adjoint() * Complex::from(road * (1.0 - incoherent) * ln_level.exp()) + &own
        };
        let inverse = phi(P, P, 0.0).try_inverse().unwrap();
        let e = 0.02;
        let half = Complex::from(0.5 / e);
        let kernels = [
            &inverse * (phi(P + e, P, 0.0) - phi(P - e, P, 0.0)) * half,
            &inverse * (phi(P, P + e, 0.0) - phi(P, P - e, 0.0)) * half,
            &inverse * (phi(P, P, e) - phi(P, P, -e)) * half,
        ];
        DMatrix::from_fn(3, 3, |i, j| (&kernels[i] * &kernels[j]).trace().re)
    }

    #[test]
    fn two_passes_are_the_general_formula_on_the_cross_spectrum() {
        for (noise, incoherent) in [(0.05, 0.0), (2.0, 0.0), (0.05, 0.01), (2.0, 0.1)] {
            let setting = BoundSetting { accel_noise_m_s2: noise, ..BoundSetting::paper() };
            let stretch = Stretch { incoherent, ..pair(1.0) };
            for f in [4.0, 9.5, 11.0, 30.0] {
                let traces = by_traces(f, &setting, incoherent);
                let law = at_frequency(&stretch, RoadModel::PowerLaw, &setting, f, 4);
                // A free spectrum: the level at this frequency profiled out (Schur complement).
                let free = at_frequency(&stretch, RoadModel::Free, &setting, f, 4);
                for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                    let size = (traces[(i, i)] * traces[(j, j)]).sqrt();
                    // Central differences over 20 Pa and 2 %: e²/6, and rounding against a strong road.
                    assert!((law[(i, j)] - traces[(i, j)]).abs() < 2e-4 * size, "{noise} {f} {i}{j}");
                    if i < 2 && j < 2 {
                        let profiled = traces[(i, j)] - traces[(i, 2)] * traces[(j, 2)] / traces[(2, 2)];
                        assert!((free[(i, j)] - profiled).abs() < 4e-4 * size, "{noise} {f} {i}{j}");
                    }
                }
            }
        }
    }

    #[test]
    fn corners_alike_tell_the_difference_only() {
        let setting = BoundSetting::paper();
        let alike = Stretch {
            passes: vec![pass(CornerConfig::paper(), P, 0, 8.0), pass(CornerConfig::paper(), P, 1, 8.0)],
            occurrence: Occurrence::Once,
            incoherent: 0.0,
        };
        let f = information(&alike, RoadModel::Free, &setting, 2);
        assert!(variance(&f, &[1.0, 0.0, 0.0, 0.0]).is_infinite());
        assert!(variance(&f, &[1.0, 1.0, 0.0, 0.0]).is_infinite());
        let difference = variance(&f, &[1.0, -1.0, 0.0, 0.0]).sqrt();
        assert!(difference > 0.0 && difference < 10.0, "{difference}");
        let f = information(&pair(8.0), RoadModel::Free, &setting, 2);
        assert!(variance(&f, &[1.0, 0.0, 0.0, 0.0]).is_finite());
    }

    #[test]
    fn a_partner_who_knows_everything_is_a_surveyed_road() {
        // The rear's pressure given and its sensors perfect (a million repetitions): what is left is the front against a known road.
        let setting = BoundSetting::paper();
        let period = 0.66;
        let passes = vec![pass(CornerConfig::paper(), P, 0, period), pass(rear(), P, 1, 1e9 * period)];
        let stretch = Stretch { passes, occurrence: Occurrence::Repeated(period), incoherent: 0.0 };
        let mut f = information(&stretch, RoadModel::Free, &setting, 2);
        f[(1, 1)] += 1e12;
        let found = variance(&f, &[1.0, 0.0, 0.0, 0.0]);
        let alone = Stretch {
            passes: vec![pass(CornerConfig::paper(), P, 0, period)],
            occurrence: Occurrence::Repeated(period),
            incoherent: 0.0,
        };
        let expected = variance(&information(&alone, RoadModel::Surveyed, &setting, 1), &[1.0, 0.0, 0.0]);
        // The bins' line between one and a billion repetitions: 1e-9; the prior on the rear leaves 1e-6.
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    }

    #[test]
    fn a_repeated_road_shows_its_spectrum_once() {
        // However long it is driven: every harmonic is one draw, and the information that of noiseless single draws,
        // the sum over harmonics of v v^T.
        let setting = BoundSetting::paper();
        let after = |seconds: f64| {
            let passes = vec![pass(CornerConfig::paper(), P, 0, seconds)];
            let stretch = Stretch { passes, occurrence: Occurrence::Repeated(0.66), incoherent: 0.0 };
            variance(&information(&stretch, RoadModel::PowerLaw, &setting, 1), &[1.0, 0.0, 0.0]).sqrt()
        };
        let mut limit = DMatrix::<f64>::zeros(3, 3);
        for k in 2..=39 {
            let f = f64::from(k) / 0.66;
            let ln_power = |p: f64| transfers(&CornerConfig::paper(), f, p).0.norm_squared().ln();
            let v = DVector::from_vec(vec![
                (ln_power(P + 0.01) - ln_power(P - 0.01)) / 0.02,
                1.0,
                -(f / 10.0).ln(),
            ]);
            limit += &v * v.transpose();
        }
        let expected = limit.try_inverse().unwrap()[(0, 0)].sqrt();
        assert!((after(3600.0) / expected - 1.0).abs() < 1e-3, "{} {expected}", after(3600.0));
        assert!(after(3600.0) > 0.99 * after(60.0));
    }

    /// `front`, `rear` that make the drawn signals most likely with nothing assumed of the road: the largest sum of
    /// `|g^H y|² / g^H g`, by Newton steps on a quadratic through nine points.
    fn most_likely(signals: &[(f64, DVector<Complex<f64>>)]) -> (f64, f64) {
        let fit = |front: f64, rear_kpa: f64| -> f64 {
            let one = |(f, y): &(f64, DVector<Complex<f64>>)| {
                let (a, b) =
                    (transfers(&CornerConfig::paper(), *f, front).0, transfers(&rear(), *f, rear_kpa).0);
                let g = DVector::from_vec(vec![a[0], a[1], b[0], b[1]]);
                (g.adjoint() * y)[(0, 0)].norm_sqr() / g.norm_squared()
            };
            signals.iter().map(one).sum()
        };
        let (mut p, mut q) = (P, P);
        for e in [4.0, 1.0, 1.0] {
            let (fp, fm) = (fit(p + e, q), fit(p - e, q));
            let (gp, gm, middle) = (fit(p, q + e), fit(p, q - e), fit(p, q));
            let cross = (fit(p + e, q + e) - fit(p + e, q - e) - fit(p - e, q + e) + fit(p - e, q - e)) / 4.0;
            let gradient = nalgebra::Vector2::new((fp - fm) / 2.0, (gp - gm) / 2.0);
            let (a, b) = (fp + fm - 2.0 * middle, gp + gm - 2.0 * middle);
            let step = nalgebra::Matrix2::new(a, cross, cross, b).try_inverse().unwrap() * gradient * e;
            (p, q) = (p - step[0], q - step[1]);
        }
        (p, q)
    }

    #[test]
    fn maximum_likelihood_over_many_draws_scatters_as_the_bound_says() {
        // Eight seconds of two unlike wheels on a road of which nothing is assumed.
        let setting = BoundSetting { accel_noise_m_s2: 0.5, ..BoundSetting::paper() };
        let f = information(&pair(8.0), RoadModel::Free, &setting, 2);
        let expected = [variance(&f, &[1.0, 0.0, 0.0, 0.0]), variance(&f, &[1.0, -1.0, 0.0, 0.0])];
        let mut rng = Pcg64::seed_from_u64(11);
        let mut normal = || <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
        let mut complex = move || Complex::new(normal(), normal()) * 0.5f64.sqrt();
        let noise = (2.0 * setting.accel_noise_m_s2.powi(2) / setting.rate_hz).sqrt();
        let draws = 300;
        let mut sums = [0.0; 2];
        for _ in 0..draws {
            let signals: Vec<_> = (0..456)
                .map(|k| {
                    let f = 3.0 + 0.125 * f64::from(k);
                    let road = (setting.road.density_m3(f / setting.speed_m_s) / setting.speed_m_s).sqrt();
                    let (a, b) = (transfers(&CornerConfig::paper(), f, P).0, transfers(&rear(), f, P).0);
                    let x = complex() * road;
                    let y = [a[0], a[1], b[0], b[1]].map(|g| g * x + complex() * noise);
                    (f, DVector::from_row_slice(&y))
                })
                .collect();
            let (front, rear_kpa) = most_likely(&signals);
            sums[0] += (front - P).powi(2);
            sums[1] += (front - rear_kpa).powi(2);
        }
        for (sum, expected) in sums.into_iter().zip(expected) {
            // The variance of 300 draws is known to 8 %.
            let ratio = sum / f64::from(draws) / expected;
            assert!((ratio - 1.0).abs() < 0.25, "{ratio}: sd {}", expected.sqrt());
        }
    }
}
