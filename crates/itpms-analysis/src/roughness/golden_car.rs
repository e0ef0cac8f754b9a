//! The golden car of ASTM E1926 on a stream of heights, and the roughness of whole profiles.
//!
//! Takes heights at any even spacing; knows nothing of the car that measured them.

use nalgebra::{Complex, Matrix4, Vector4};
use thiserror::Error;

/// Spring rate over sprung mass in 1/s².
const K2: f64 = 63.3;
/// Tire rate over sprung mass in 1/s².
const K1: f64 = 653.0;
/// Damping over sprung mass in 1/s.
const C: f64 = 6.0;
/// Unsprung over sprung mass.
const MU: f64 = 0.15;
const SPEED_M_S: f64 = 80.0 / 3.6;
/// Length of the moving average that stands for the tire's contact patch.
const AVERAGE_M: f64 = 0.25;
/// The golden car starts on the mean slope of this much road.
const START_M: f64 = 11.0;

/// Names of the golden car's states, all per metre of road travelled.
mod golden {
    pub(super) const BODY_SLOPE: usize = 0;
    pub(super) const WHEEL_SLOPE: usize = 2;
}

/// Whether the profile still needs the 250 mm moving average of the standard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Enveloping {
    /// A surveyed profile: average over 250 mm when it is sampled more closely than that.
    MovingAverage,
    /// Seen through a tire already, or smooth by construction: take it as it is.
    Done,
}

/// A spacing the golden car cannot drive over.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("profile spacing is {0} m, expected more than 0 and at most 1 m")]
pub struct SpacingError(f64);

/// The golden car on a stream of heights; memory is 11 m of profile.
#[derive(Debug, Clone)]
pub struct GoldenCar {
    transition: Matrix4<f64>,
    input: Vector4<f64>,
    spacing_m: f64,
    reach: usize,
    start: usize,
    heights: Vec<f64>,
    state: Option<Vector4<f64>>,
}

impl GoldenCar {
    /// A golden car about to drive over heights `spacing_m` apart. Above 0.3 m the standard calls a profile too
    /// coarse; up to 1 m is computed all the same. Errors: the spacing must be a number in (0, 1] m.
    pub fn new(spacing_m: f64, enveloping: Enveloping) -> Result<Self, SpacingError> {
        if !(spacing_m > 0.0 && spacing_m <= 1.0) {
            return Err(SpacingError(spacing_m));
        }
        let (transition, input) = step_matrices(spacing_m / SPEED_M_S);
        let reach = match enveloping {
            Enveloping::MovingAverage => ((AVERAGE_M / spacing_m).round() as usize).max(1),
            Enveloping::Done => 1,
        };
        let start = ((START_M / spacing_m).round() as usize).max(reach);
        Ok(Self { transition, input, spacing_m, reach, start, heights: Vec::new(), state: None })
    }

    /// Takes the next height in m and hands each rectified slope (m/m) that follows from it to `slope`. The first
    /// 11 m are held back for the start. A height that is not finite is a gap: the car starts anew after it.
    pub fn push(&mut self, height_m: f64, mut slope: impl FnMut(f64)) {
        if !height_m.is_finite() {
            self.flush(&mut slope);
            self.heights.clear();
            self.state = None;
            return;
        }
        self.heights.push(height_m);
        if self.state.is_some() {
            self.drive(&mut slope);
        } else if self.heights.len() > self.start {
            self.flush(&mut slope);
        }
    }

    /// Ends a profile: one shorter than 11 m starts on its mean slope.
    pub fn flush(&mut self, mut slope: impl FnMut(f64)) {
        if self.state.is_none() && self.heights.len() > self.reach {
            let steps = self.start.min(self.heights.len() - 1);
            let mean = (self.heights[steps] - self.heights[0]) / (steps as f64 * self.spacing_m);
            self.state = Some(Vector4::new(mean, 0.0, mean, 0.0));
            self.drive(&mut slope);
        }
    }

    /// One step for each height that has its partner a moving average ahead.
    fn drive(&mut self, slope: &mut impl FnMut(f64)) {
        let Some(mut state) = self.state else { return };
        let steps = self.heights.len().saturating_sub(self.reach);
        for i in 0..steps {
            // The slope of the averaged profile is the mean slope across the average's length.
            let rise = self.heights[i + self.reach] - self.heights[i];
            state = self.transition * state + self.input * (rise / (self.reach as f64 * self.spacing_m));
            slope((state[golden::BODY_SLOPE] - state[golden::WHEEL_SLOPE]).abs());
        }
        self.heights.drain(..steps);
        self.state = Some(state);
    }
}

/// Exact step over `dt` seconds for an input held constant: `S = e^(A dt)`, `P = A^-1 (S - I) B`, both read from
/// the exponential of the system augmented by its input.
fn step_matrices(dt: f64) -> (Matrix4<f64>, Vector4<f64>) {
    let mut augmented = nalgebra::Matrix5::<f64>::zeros();
    augmented[(0, 1)] = 1.0;
    augmented[(2, 3)] = 1.0;
    let body = [-K2, -C, K2, C, 0.0];
    let wheel = [K2 / MU, C / MU, -(K1 + K2) / MU, -C / MU, K1 / MU];
    for column in 0..5 {
        augmented[(1, column)] = body[column];
        augmented[(3, column)] = wheel[column];
    }
    let step = (augmented * dt).exp();
    (step.fixed_view::<4, 4>(0, 0).into_owned(), step.fixed_view::<4, 1>(0, 4).into_owned())
}

/// IRI of a whole profile in m/km (the same as mm/m); `None` for a profile too short for one step or not finite.
pub fn iri_m_per_km(
    heights_m: &[f64],
    spacing_m: f64,
    enveloping: Enveloping,
) -> Result<Option<f64>, SpacingError> {
    let slopes = rectified_slopes(heights_m, spacing_m, enveloping)?;
    Ok(mean_m_per_km(&slopes))
}

/// IRI in m/km of each whole segment of `segment_m` metres; the car drives through without a new start, and a rest
/// shorter than a segment is left out.
pub fn segment_iri_m_per_km(
    heights_m: &[f64],
    spacing_m: f64,
    enveloping: Enveloping,
    segment_m: f64,
) -> Result<Vec<f64>, SpacingError> {
    let slopes = rectified_slopes(heights_m, spacing_m, enveloping)?;
    let steps = ((segment_m / spacing_m).round() as usize).max(1);
    Ok(slopes.chunks_exact(steps).filter_map(mean_m_per_km).collect())
}

/// The share of a road's IRI that is left when waves longer than `longest_m` are missing from it, for a road of slope
/// `waviness`: a Gaussian road's mean rectified slope goes with its rms, which is an integral over the golden car's
/// response. With all waves from 0.25 to 1000 m it is 1; up to 10 m it is 0.95 (slope 2), up to 20 m 0.99.
pub fn share_of_iri(longest_m: f64, waviness: f64) -> f64 {
    const STEPS: i32 = 400;
    let power = |wavelength_m: f64| {
        let n = 1.0 / wavelength_m;
        let s = Complex::new(0.0, std::f64::consts::TAU * SPEED_M_S * n);
        let link = s * C + K2;
        let body = link / (s * s + link);
        let wheel = Complex::from(K1) / (s * s * MU + K1 + link * (Complex::from(1.0) - body));
        // Slope density n^(2 - w), times n for even steps of its logarithm.
        ((body - 1.0) * wheel).norm_sqr() * n.powf(3.0 - waviness)
    };
    let (mut seen, mut all) = (0.0, 0.0);
    for step in 0..STEPS {
        let wavelength_m = 0.25 * 4000f64.powf((f64::from(step) + 0.5) / f64::from(STEPS));
        all += power(wavelength_m);
        if wavelength_m <= longest_m {
            seen += power(wavelength_m);
        }
    }
    (seen / all).sqrt()
}

fn rectified_slopes(
    heights_m: &[f64],
    spacing_m: f64,
    enveloping: Enveloping,
) -> Result<Vec<f64>, SpacingError> {
    let mut car = GoldenCar::new(spacing_m, enveloping)?;
    let mut slopes = Vec::with_capacity(heights_m.len());
    heights_m.iter().for_each(|&height| car.push(height, |slope| slopes.push(slope)));
    car.flush(|slope| slopes.push(slope));
    Ok(slopes)
}

fn mean_m_per_km(slopes: &[f64]) -> Option<f64> {
    (!slopes.is_empty()).then(|| 1000.0 * slopes.iter().sum::<f64>() / slopes.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roughness::tests::surveyed_road;

    /// World Bank Technical Paper 46, dx = 0.25 m.
    const S: [[f64; 4]; 4] = [
        [0.9966071, 0.01091514, -0.002083274, 0.0003190145],
        [-0.5563044, 0.9438768, -0.8324718, 0.05064701],
        [0.02153176, 0.002126763, 0.7508714, 0.008221888],
        [3.335013, 0.3376467, -39.12762, 0.4347564],
    ];
    const P: [f64; 4] = [0.005476107, 1.388776, 0.2275968, 35.79262];

    #[test]
    fn matrices_are_the_published_ones() {
        let (transition, input) = step_matrices(0.25 / SPEED_M_S);
        for i in 0..4 {
            // Printed with seven digits; the report summed its series by hand and lost two of them in P[0].
            let digits = if i == 0 { 3e-5 } else { 2e-6 };
            assert!((input[i] / P[i] - 1.0).abs() < digits);
            for j in 0..4 {
                assert!((transition[(i, j)] / S[i][j] - 1.0).abs() < 2e-6, "{i} {j}");
            }
        }
    }

    #[test]
    fn world_bank_triangle() {
        let heights: Vec<f64> = (0..=120)
            .map(|i| {
                let x = f64::from(i) * 0.25;
                if x < 1.0 {
                    0.0
                } else if x < 3.0 {
                    0.01 * (x - 1.0)
                } else {
                    (0.02 - 0.01 * (x - 3.0)).max(0.0)
                }
            })
            .collect();
        // Published, cumulative from the start, with the printed matrices' seven digits behind them.
        for (end, iri) in
            [(5, 7.82931), (10, 5.08670), (15, 3.71304), (20, 2.95143), (25, 2.41392), (30, 2.04955)]
        {
            let slopes = rectified_slopes(&heights, 0.25, Enveloping::MovingAverage).unwrap();
            let found = mean_m_per_km(&slopes[..end * 4]).unwrap();
            assert!((found - iri).abs() < 2e-5, "{end} m: {found}");
        }
    }

    #[test]
    fn a_sine_agrees_with_the_golden_cars_frequency_response() {
        // Independent of the time steps: |x_b' - x_w'| / |slope| from the equations of motion at s = 2 pi i n V.
        let response = |wavelength: f64| {
            let s = Complex::new(0.0, std::f64::consts::TAU * SPEED_M_S / wavelength);
            let link = s * C + K2;
            let body = link / (s * s + link);
            let wheel = Complex::from(K1) / (s * s * MU + K1 + link * (Complex::from(1.0) - body));
            ((body - 1.0) * wheel).norm()
        };
        for (wavelength, published) in [(2.4, 2.7698), (15.4, 0.3985), (5.0, 0.9356)] {
            let heights: Vec<f64> = (0..40_000)
                .map(|i| 0.001 * (std::f64::consts::TAU * f64::from(i) * 0.05 / wavelength).sin())
                .collect();
            let iri = iri_m_per_km(&heights, 0.05, Enveloping::Done).unwrap().unwrap();
            // Slope amplitude 2 pi/L mm/m; a rectified sine's mean is 2/pi of its amplitude. The start costs up to
            // 0.3 % of 2 km, the held input (5 cm of 2.4 m) 0.1 %.
            let expected =
                response(wavelength) * std::f64::consts::TAU / wavelength * 2.0 / std::f64::consts::PI;
            assert!((iri / expected - 1.0).abs() < 5e-3, "{wavelength} m: {iri} for {expected}");
            assert!((iri / published - 1.0).abs() < 5e-3, "{wavelength} m: {iri} for {published}");
        }
    }

    #[test]
    fn long_waves_missing_make_the_road_read_low() {
        // From another program (numpy, 20 000 points, with the 250 mm average): four digits.
        for (longest, waviness, share) in
            [(10.0, 2.0, 0.951), (20.0, 2.0, 0.994), (10.0, 2.5, 0.897), (11.0, 1.8, 0.969), (45.0, 2.2, 1.0)]
        {
            let found = share_of_iri(longest, waviness);
            // Steps of 2 % in wavelength, and the average.
            assert!((found - share).abs() < 0.004, "{longest} {waviness}: {found}");
        }
    }

    #[test]
    fn the_spacing_hardly_matters() {
        let profile = |spacing: f64| -> Vec<f64> {
            let wave = |x: f64, l: f64| (std::f64::consts::TAU * x / l).sin();
            (0..(400.0 / spacing) as usize)
                .map(|i| i as f64 * spacing)
                .map(|x| 0.004 * wave(x, 17.0) + 0.002 * wave(x, 6.1) + 0.001 * wave(x, 2.9))
                .collect()
        };
        let fine = iri_m_per_km(&profile(0.05), 0.05, Enveloping::MovingAverage).unwrap().unwrap();
        for spacing in [0.01, 0.1, 0.125, 0.25] {
            let iri = iri_m_per_km(&profile(spacing), spacing, Enveloping::MovingAverage).unwrap().unwrap();
            // The average is 0.2 to 0.25 m long at these spacings: 1 % at 2.9 m.
            assert!((iri / fine - 1.0).abs() < 0.02, "{spacing}: {iri} for {fine}");
        }
    }

    #[test]
    fn a_surveyed_road() {
        let Some((_, heights)) = surveyed_road() else { return };
        assert_eq!(heights.len(), 2177);
        // From an independent script, four digits.
        let whole = iri_m_per_km(&heights, 0.25, Enveloping::MovingAverage).unwrap().unwrap();
        assert!((whole - 3.3355).abs() < 1e-4, "{whole}");
        let segments = segment_iri_m_per_km(&heights, 0.25, Enveloping::MovingAverage, 100.0).unwrap();
        let expected = [3.2985, 2.4421, 3.5551, 4.0855, 2.7079];
        assert_eq!(segments.len(), 5);
        for (found, expected) in segments.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-4, "{segments:?}");
        }
    }

    #[test]
    fn a_slope_alone_is_not_rough_and_a_gap_starts_anew() {
        let slope: Vec<f64> = (0..200).map(|i| 5.0 + 0.02 * f64::from(i)).collect();
        assert!(iri_m_per_km(&slope, 0.1, Enveloping::Done).unwrap().unwrap() < 1e-9);
        let mut broken = slope.clone();
        broken[100] = f64::NAN;
        // A height step across the gap must not shake the car.
        broken[101..].iter_mut().for_each(|h| *h += 1.0);
        assert!(iri_m_per_km(&broken, 0.1, Enveloping::Done).unwrap().unwrap() < 1e-9);
    }

    #[test]
    fn short_profiles_and_absurd_spacings() {
        assert_eq!(iri_m_per_km(&[], 0.25, Enveloping::Done).unwrap(), None);
        assert_eq!(iri_m_per_km(&[1.0], 0.25, Enveloping::Done).unwrap(), None);
        assert!(iri_m_per_km(&[0.0, 0.001, 0.0], 0.25, Enveloping::Done).unwrap().is_some());
        for spacing in [0.0, -1.0, 1.5, f64::NAN] {
            assert!(GoldenCar::new(spacing, Enveloping::Done).is_err());
        }
    }
}
