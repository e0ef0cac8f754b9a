//! The bound of one side of a car: a front and a rear wheel that meet nearly the same road (`docs/math/bound.md`, eq. 9-10).
//!
//! Called by the score, beside the drives of four quarter cars. The four signals are those of one place on the road: the
//! delay between the wheels is known, and a known delay changes nothing.

use itpms_core::model::CornerConfig;
use nalgebra::{Complex, Matrix2, Matrix4, Vector2};

use super::fisher::{LEVEL_HZ, information, over_the_band, transfers};
use super::history::Known;
use super::{BoundError, BoundPrior, BoundSetting};

/// How alike two tracks of one road are, 0 to 1, at a spatial frequency in cycles per m, so many m beside each other, for a spectrum of
/// this slope: `itpms_sim::road::coherence` for an isotropic surface.
pub type TrackCoherence = fn(cycles_per_m: f64, distance_m: f64, slope: f64) -> f64;

/// The bound for the two wheels of a side on one kind of drive.
#[derive(Debug, Clone)]
pub struct SideBound {
    corners: [CornerConfig<f64>; 2],
    setting: BoundSetting,
    rear_offset_m: f64,
    coherence: TrackCoherence,
    prior: BoundPrior,
}

impl SideBound {
    /// The bound for a front and a rear corner, `[front, rear]`, whose rear wheel runs `rear_offset_m` beside the front
    /// one's track, as like it as `coherence` has it; the setting's noise counts, not the configurations'.
    pub fn new(
        corners: [CornerConfig<f64>; 2],
        setting: &BoundSetting,
        rear_offset_m: f64,
        coherence: TrackCoherence,
    ) -> Result<Self, BoundError> {
        setting.check()?;
        if !rear_offset_m.is_finite() {
            return Err(BoundError::Offset(rear_offset_m));
        }
        Ok(Self { corners, setting: *setting, rear_offset_m, coherence, prior: BoundPrior::default() })
    }

    /// Fisher information per second about (pressure in front, pressure at the rear in kPa, natural logarithm of the road's
    /// level at 10 Hz, slope `w`) at these gauge pressures in kPa.
    pub fn information_matrix_per_second(&self, pressures_kpa: [f64; 2]) -> Matrix4<f64> {
        over_the_band(self.setting.band_hz, |frequency_hz| {
            let (phi, derivatives) = self.model(frequency_hz, pressures_kpa);
            information(&phi, &derivatives)
        })
    }

    /// Spectral matrix of (body, wheel) acceleration in front and (body, wheel) at the rear, and its derivatives.
    fn model(
        &self,
        frequency_hz: f64,
        pressures_kpa: [f64; 2],
    ) -> (Matrix4<Complex<f64>>, [Matrix4<Complex<f64>>; 4]) {
        let setting = &self.setting;
        let cycles_per_m = frequency_hz / setting.speed_m_s;
        let road = setting.road.density_m3(cycles_per_m) / setting.speed_m_s;
        let shared = road * (self.coherence)(cycles_per_m, self.rear_offset_m, setting.road.waviness);
        let noise = 2.0 * setting.accel_noise_m_s2.powi(2) / setting.rate_hz;
        let [front, rear] =
            [0, 1].map(|axle| transfers(&self.corners[axle], frequency_hz, pressures_kpa[axle]));
        // Blocks of a hermitian matrix: front with front, rear with rear, and front with rear.
        let blocks = |ff: Matrix2<Complex<f64>>, rr: Matrix2<Complex<f64>>, fr: Matrix2<Complex<f64>>| {
            let mut whole = Matrix4::zeros();
            whole.fixed_view_mut::<2, 2>(0, 0).copy_from(&(ff * Complex::from(road)));
            whole.fixed_view_mut::<2, 2>(2, 2).copy_from(&(rr * Complex::from(road)));
            let across = fr * Complex::from(shared);
            whole.fixed_view_mut::<2, 2>(0, 2).copy_from(&across);
            whole.fixed_view_mut::<2, 2>(2, 0).copy_from(&across.adjoint());
            whole
        };
        let outer = |a: Vector2<Complex<f64>>, b: Vector2<Complex<f64>>| a * b.adjoint();
        let turned = |(g, slope)| outer(slope, g) + outer(g, slope);
        let signal = blocks(outer(front.0, front.0), outer(rear.0, rear.0), outer(front.0, rear.0));
        let derivatives = [
            blocks(turned(front), Matrix2::zeros(), outer(front.1, rear.0)),
            blocks(Matrix2::zeros(), turned(rear), outer(front.0, rear.1)),
            signal,
            signal * Complex::from(-(frequency_hz / LEVEL_HZ).ln()),
        ];
        (signal + Matrix4::identity() * Complex::from(noise), derivatives)
    }

    /// Bound on the standard deviations in kPa, `[front, rear]`, at each time (s, increasing) of a drive with these true pressures, as
    /// [`CornerBound::history`](super::CornerBound::history). Up to `calibrated_until_s` the pressures are given, as during a reset.
    pub fn history(
        &self,
        times_s: &[f64],
        pressures_kpa: &[[f64; 2]],
        prior_sd_kpa: f64,
        calibrated_until_s: Option<f64>,
    ) -> Vec<[f64; 2]> {
        let mut known = Known::<4>::new(self.setting.road_knowledge, self.prior, prior_sd_kpa);
        let mut last: Option<(f64, [f64; 2], Matrix4<f64>)> = None;
        let mut sds = vec![];
        for (&time, &pressures) in times_s.iter().zip(pressures_kpa) {
            let information = match last {
                // A pressure that holds says every time the same.
                Some((_, before, information)) if before == pressures => information,
                _ => self.information_matrix_per_second(pressures),
            };
            if let Some((time_before, before, _)) = last {
                let dt = time - time_before;
                let rates = [0, 1].map(|axle| (pressures[axle] - before[axle]) / dt);
                known.drive(dt, &rates, &information);
            }
            if calibrated_until_s.is_some_and(|until_s| time <= until_s) {
                known.fix_pressures();
            }
            sds.push([0, 1].map(|axle| known.variance_kpa2(axle).sqrt()));
            last = Some((time, pressures, information));
        }
        sds
    }
}

#[cfg(test)]
mod tests {
    use itpms_core::model::QuarterCar;
    use itpms_sim::road::coherence;

    use super::super::CornerBound;
    use super::*;

    const P: f64 = 241.3;

    fn corners() -> [CornerConfig<f64>; 2] {
        let front = CornerConfig::paper();
        let quarter_car = QuarterCar::new(216.0, 50.0, 925.8, 29_114.0).unwrap();
        [front, CornerConfig { quarter_car, ..front }]
    }

    fn side(km_h: f64, rear_offset_m: f64) -> SideBound {
        let setting = BoundSetting { speed_m_s: km_h / 3.6, ..BoundSetting::paper() };
        SideBound::new(corners(), &setting, rear_offset_m, coherence).unwrap()
    }

    /// sd in kPa √s of both pressures, level and slope unknown.
    fn sd_of_a_second(bound: &SideBound) -> [f64; 2] {
        let covariance = bound.information_matrix_per_second([P, P]).try_inverse().unwrap();
        [covariance[(0, 0)].sqrt(), covariance[(1, 1)].sqrt()]
    }

    #[test]
    fn roads_that_share_nothing_are_two_corners() {
        // A hundred meters apart; each corner then has its own level and slope, here both have the same: a little better.
        let side = side(20.0, 100.0);
        let information = side.information_matrix_per_second([P, P]);
        for (axle, corner) in corners().iter().enumerate() {
            let alone = CornerBound::new(corner, &side.setting).unwrap().information_matrix_per_second(P);
            assert!((information[(axle, axle)] / alone[(0, 0)] - 1.0).abs() < 1e-9);
            for road in 0..2 {
                let found = information[(axle, 2 + road)];
                assert!((found / alone[(0, 1 + road)] - 1.0).abs() < 1e-9, "{found}");
            }
            assert!(sd_of_a_second(&side)[axle] < (alone.try_inverse().unwrap())[(0, 0)].sqrt());
        }
        assert!(information[(0, 1)].abs() < 1e-9 * information[(0, 0)]);
    }

    #[test]
    fn figures_of_an_independent_computation() {
        // From a separate script, kPa √s: 2 cm off the track.
        for (km_h, expected) in [(80.0, [9.09, 9.57]), (20.0, [20.41, 21.30])] {
            let found = sd_of_a_second(&side(km_h, 0.02));
            for (found, expected) in found.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 0.005, "{km_h} km/h: {found} for {expected}");
            }
        }
    }

    #[test]
    fn information_is_the_curvature_of_the_relative_entropy() {
        // KL(p, p + e) = tr(Phi_e^-1 Phi) - 4 - ln det(Phi_e^-1 Phi): no derivative is used. Both signs of e cancel the odd term.
        let side = side(80.0, 0.02);
        let divergence = |f: f64, e: [f64; 2]| {
            let (phi, _) = side.model(f, [P, P]);
            let (other, _) = side.model(f, [P + e[0], P + e[1]]);
            let ratio = other.try_inverse().unwrap() * phi;
            ratio.trace().re - 4.0 - ratio.determinant().re.ln()
        };
        let both = |f: f64, e: [f64; 2]| divergence(f, e) + divergence(f, e.map(|e| -e));
        for f in [6.0, 10.0, 11.5, 14.0, 25.0] {
            let (phi, derivatives) = side.model(f, [P, P]);
            let found = information(&phi, &derivatives);
            let [front, rear, sum] = [[0.2, 0.0], [0.0, 0.2], [0.2, 0.2]].map(|e| both(f, e) / 0.04);
            assert!((found[(0, 0)] / front - 1.0).abs() < 1e-3, "{f} Hz: {} for {front}", found[(0, 0)]);
            assert!((found[(1, 1)] / rear - 1.0).abs() < 1e-3, "{f} Hz: {} for {rear}", found[(1, 1)]);
            let across = 0.5 * (sum - front - rear);
            assert!((found[(0, 1)] - across).abs() < 1e-3 * (front * rear).sqrt(), "{f} Hz: {across}");
        }
    }

    #[test]
    fn a_history_is_the_closed_form_and_a_reset_leaves_what_came_later() {
        let mut side = side(20.0, 0.02);
        side.prior = BoundPrior::vague();
        let times: Vec<f64> = (0..=300).map(|k| 0.1 * f64::from(k)).collect();
        let held = vec![[P, P]; times.len()];
        let found = side.history(&times, &held, 1e4, None);
        let closed = sd_of_a_second(&side);
        for axle in 0..2 {
            assert!((found[200][axle] * 20f64.sqrt() / closed[axle] - 1.0).abs() < 1e-3);
        }
        // A pressure that cannot change stays known.
        let history = side.history(&times, &held, 1e4, Some(10.0));
        assert!(history.iter().all(|sd| *sd == [0.0, 0.0]));
        // One that changes has to be found out, the other not.
        side.prior = BoundPrior { walk_kpa_per_sqrt_s: 0.0, ..BoundPrior::default() };
        let falls: Vec<[f64; 2]> = times.iter().map(|t| [P - 40.0 * (t - 20.0).clamp(0.0, 2.5), P]).collect();
        let history = side.history(&times, &falls, 36.0, Some(10.0));
        assert!(history[200][0] < 1e-6 && history[225][0] > 10.0 && history[300][0] < history[225][0]);
        assert!(history.iter().all(|sd| sd[1] < 1e-6));
    }

    #[test]
    fn an_offset_is_a_number() {
        let refused = SideBound::new(corners(), &BoundSetting::paper(), f64::NAN, coherence).unwrap_err();
        assert!(refused.to_string().contains("NaN"));
    }
}
