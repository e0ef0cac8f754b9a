//! The bound along a drive with changing pressure: the posterior Cramer-Rao bound (Van Trees) in Tichavsky's
//! recursion (`docs/math/bound.md`, eq. 5-8).
//!
//! Called by [`CornerBound`](super::CornerBound) and [`SideBound`](super::SideBound). The state is (pressures, logarithm
//! of the road's level, slope).

use nalgebra::{Matrix3, SMatrix};

use super::RoadKnowledge;
use super::fisher::Fisher;

/// The bound's prior on how pressure and road change. The less it allows, the lower the bound.
///
/// A changing pressure is a Gaussian random walk whose strength is that of the change actually under way: the
/// bound is given when the pressure moves and how fast, though not where to. An estimator that has to find this out
/// first stays above the bound during and shortly after a change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundPrior {
    /// Creep of a sound tire in kPa per sqrt(s), always on.
    pub walk_kpa_per_sqrt_s: f64,
    /// How long a change keeps its rate, in s: a change at `r` kPa/s adds `r² · change_time_s` kPa² a second, so
    /// that one lasting this long is as wide beforehand as it turns out to be.
    pub change_time_s: f64,
    /// The sd in kPa that the walk tends to without data; a pressure has limits.
    pub range_sd_kpa: f64,
    /// The sd of the natural logarithm of the road's level beforehand.
    pub level_sd_ln: f64,
    pub level_walk_ln_per_sqrt_s: f64,
    /// The sd of the road's slope `w` beforehand.
    pub slope_sd: f64,
}

impl Default for BoundPrior {
    /// Creep 0.4 kPa/sqrt(s); changes over 2.5 s; a range as of a uniform density over 30 to 310 kPa; a road of
    /// unknown class (sd 3, a factor of 20), of slope 2 +- 0.3 and nearly constant level.
    fn default() -> Self {
        Self {
            walk_kpa_per_sqrt_s: 0.4,
            change_time_s: 2.5,
            range_sd_kpa: 81.0,
            level_sd_ln: 3.0,
            level_walk_ln_per_sqrt_s: 0.01,
            slope_sd: 0.3,
        }
    }
}

#[cfg(test)]
impl BoundPrior {
    /// Nothing moves and nothing is known beforehand.
    pub(super) fn vague() -> Self {
        Self {
            walk_kpa_per_sqrt_s: 0.0,
            change_time_s: 0.0,
            range_sd_kpa: 1e4,
            level_sd_ln: 1e3,
            level_walk_ln_per_sqrt_s: 0.0,
            slope_sd: 1e3,
        }
    }
}

/// Grid of pressures the information is tabulated on, 0 to 400 kPa; a straight line between its points is within half a per cent.
const TABLE_STEP_KPA: f64 = 5.0;
const TABLE_POINTS: usize = 81;
/// A sub-step changes the variance by at most this share, so that the result is that of continuous time.
const SUBSTEP: f64 = 0.2;

/// Information on `N - 2` pressures and, in the last two places, on the road's level and slope.
#[derive(Debug, Clone)]
pub(super) struct Known<const N: usize> {
    prior: BoundPrior,
    covariance: SMatrix<f64, N, N>,
}

impl<const N: usize> Known<N> {
    pub(super) fn new(knowledge: RoadKnowledge, prior: BoundPrior, prior_sd_kpa: f64) -> Self {
        let mut prior = prior;
        if knowledge == RoadKnowledge::Known {
            (prior.level_sd_ln, prior.level_walk_ln_per_sqrt_s, prior.slope_sd) = (0.0, 0.0, 0.0);
        }
        prior.range_sd_kpa = prior.range_sd_kpa.max(prior_sd_kpa);
        let mut covariance = SMatrix::from_diagonal_element(prior_sd_kpa.powi(2));
        covariance[(N - 2, N - 2)] = prior.level_sd_ln.powi(2);
        covariance[(N - 1, N - 1)] = prior.slope_sd.powi(2);
        Self { prior, covariance }
    }

    pub(super) fn variance_kpa2(&self, pressure: usize) -> f64 {
        self.covariance[(pressure, pressure)]
    }

    /// Drives on for `dt_s` seconds that give `information` each, while the pressures change at `rates_kpa_per_s`.
    pub(super) fn drive(&mut self, dt_s: f64, rates_kpa_per_s: &[f64], information: &SMatrix<f64, N, N>) {
        let change = |(i, &rate): (usize, &f64)| {
            let variance = self.covariance[(i, i)];
            (self.walk_kpa2_per_s(rate) / variance).max(variance * information[(i, i)]) * dt_s
        };
        let most = rates_kpa_per_s.iter().enumerate().map(change).fold(0.0, f64::max);
        let steps = (most / SUBSTEP).ceil().clamp(1.0, 1000.0);
        let step = dt_s / steps;
        for _ in 0..steps as usize {
            // Half the walk before and half after the data: exact to second order.
            self.predict(0.5 * step, rates_kpa_per_s);
            self.learn(&(*information * step));
            self.predict(0.5 * step, rates_kpa_per_s);
        }
    }

    /// `P <- (P^-1 + F)^-1`, written so that a `P` without full rank is welcome.
    fn learn(&mut self, information: &SMatrix<f64, N, N>) {
        if let Some(inverse) = (SMatrix::identity() + self.covariance * information).try_inverse() {
            let updated = inverse * self.covariance;
            self.covariance = (updated + updated.transpose()) * 0.5;
        }
    }

    /// The pressures are given: their variance is zero.
    pub(super) fn fix_pressures(&mut self) {
        for i in 0..N - 2 {
            self.covariance.row_mut(i).fill(0.0);
            self.covariance.column_mut(i).fill(0.0);
        }
    }

    /// Strength `q` of the walk at a rate of change; an unknown rate is none.
    fn walk_kpa2_per_s(&self, rate_kpa_per_s: f64) -> f64 {
        let rate = if rate_kpa_per_s.is_finite() { rate_kpa_per_s } else { 0.0 };
        self.prior.walk_kpa_per_sqrt_s.powi(2) + rate * rate * self.prior.change_time_s
    }

    /// Prediction of Ornstein-Uhlenbeck processes: `V' = V + (V_range - V)(1 - e^(-q dt / V_range))`, random walks
    /// of `q` kPa²/s as long as `V` is small.
    pub(super) fn predict(&mut self, dt_s: f64, rates_kpa_per_s: &[f64]) {
        let range = self.prior.range_sd_kpa.powi(2);
        for (i, &rate) in rates_kpa_per_s.iter().enumerate() {
            let keep = (-0.5 * self.walk_kpa2_per_s(rate) * dt_s / range).exp();
            self.covariance.row_mut(i).scale_mut(keep);
            self.covariance.column_mut(i).scale_mut(keep);
            self.covariance[(i, i)] += (1.0 - keep * keep) * range;
        }
        self.covariance[(N - 2, N - 2)] += self.prior.level_walk_ln_per_sqrt_s.powi(2) * dt_s;
    }
}

/// The running bound. Cheap: the information per second is read from a table, of which a drive fills the part that its pressures reach.
#[derive(Debug, Clone)]
pub struct BoundRecursion {
    fisher: Fisher,
    table: [Option<Matrix3<f64>>; TABLE_POINTS],
    known: Known<3>,
    pressure_kpa: f64,
}

impl BoundRecursion {
    pub(super) fn new(
        fisher: &Fisher,
        knowledge: RoadKnowledge,
        prior: BoundPrior,
        prior_sd_kpa: f64,
    ) -> Self {
        let known = Known::new(knowledge, prior, prior_sd_kpa);
        Self { fisher: fisher.clone(), table: [None; TABLE_POINTS], known, pressure_kpa: f64::NAN }
    }

    pub fn sd_kpa(&self) -> f64 {
        self.known.variance_kpa2(0).sqrt()
    }

    /// Drives on for `dt_s` seconds at a true pressure in kPa that changes by `rate_kpa_per_s`. An unknown pressure
    /// (NaN) stays what it was, an unknown rate is none; a step that is not forward in time is none.
    pub fn drive(&mut self, dt_s: f64, pressure_kpa: f64, rate_kpa_per_s: f64) {
        if pressure_kpa.is_finite() {
            self.pressure_kpa = pressure_kpa;
        }
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            return;
        }
        if !self.pressure_kpa.is_finite() {
            self.known.predict(dt_s, &[rate_kpa_per_s]);
            return;
        }
        let information = self.per_second(self.pressure_kpa);
        self.known.drive(dt_s, &[rate_kpa_per_s], &information);
    }

    /// Information per second, on the line between two points of the table.
    fn per_second(&mut self, pressure_kpa: f64) -> Matrix3<f64> {
        let place = (pressure_kpa / TABLE_STEP_KPA).clamp(0.0, (TABLE_POINTS - 1) as f64);
        let below = (place as usize).min(TABLE_POINTS - 2);
        let [from, to] = [below, below + 1].map(|point| {
            *self.table[point].get_or_insert_with(|| self.fisher.per_second(point as f64 * TABLE_STEP_KPA))
        });
        let share = place - below as f64;
        from * (1.0 - share) + to * share
    }

    /// Stands for `dt_s` seconds: the pressure may creep, nothing is learned.
    pub fn stand(&mut self, dt_s: f64) {
        if dt_s > 0.0 && dt_s.is_finite() {
            self.known.predict(dt_s, &[0.0]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BoundSetting, CornerBound};
    use super::*;
    use itpms_core::model::CornerConfig;

    fn bound(road_knowledge: RoadKnowledge) -> CornerBound {
        let setting = BoundSetting { road_knowledge, ..BoundSetting::paper() };
        CornerBound::new(&CornerConfig::paper(), &setting).unwrap()
    }

    #[test]
    fn a_constant_pressure_gives_the_closed_form() {
        for knowledge in [RoadKnowledge::Known, RoadKnowledge::Unknown] {
            let b = bound(knowledge).with_prior(BoundPrior::vague());
            let times: Vec<f64> = (0..=400).map(|k| f64::from(k) * 0.1).collect();
            let history = b.history(&times, &vec![240.0; 401], 1e4);
            for second in [1usize, 8, 16, 39] {
                // 240 kPa is a grid point, so the table adds nothing; the priors are 1e-4 of what is left.
                let closed = b.sd_kpa(second as f64, 240.0);
                assert!((history[10 * second] / closed - 1.0).abs() < 1e-3, "{second} s, {knowledge:?}");
            }
        }
    }

    #[test]
    fn the_table_is_fine_enough() {
        let b = bound(RoadKnowledge::Unknown).with_prior(BoundPrior::vague());
        for p in [35.0, 138.5, 244.0, 305.0] {
            let history = b.history(&[0.0, 10.0], &[p, p], 1e4);
            assert!((history[1] / b.sd_kpa(10.0, p) - 1.0).abs() < 0.01, "{p} kPa: {history:?}");
        }
    }

    #[test]
    fn a_scalar_walk_settles_at_the_kalman_limit() {
        // Road known: V + q dt - V' = V V' J dt in the steady state; for small steps V = sqrt(q / J).
        let prior = BoundPrior { walk_kpa_per_sqrt_s: 0.5, ..BoundPrior::vague() };
        let b = bound(RoadKnowledge::Known).with_prior(prior);
        let times: Vec<f64> = (0..6000).map(|k| f64::from(k) * 0.1).collect();
        let history = b.history(&times, &vec![240.0; 6000], 50.0);
        let limit = (0.5 / b.information_per_second_kpa2(240.0).sqrt()).sqrt();
        // The step of 0.1 s is of second order.
        assert!((history[5999] / limit - 1.0).abs() < 1e-3, "{} for {limit}", history[5999]);
    }

    #[test]
    fn a_drop_raises_the_bound_and_the_log_rate_hardly_matters() {
        let pressure = |t: f64| 241.3 - 103.4 * ((t - 20.0) / 2.5).clamp(0.0, 1.0);
        let run = |rate: usize| {
            let times: Vec<f64> = (0..=40 * rate).map(|k| k as f64 / rate as f64).collect();
            let pressures: Vec<f64> = times.iter().map(|t| pressure(*t)).collect();
            let sd = bound(RoadKnowledge::Unknown).history(&times, &pressures, 30.0);
            [19.9, 22.5, 26.0, 40.0].map(|t: f64| sd[(t * rate as f64).round() as usize])
        };
        let slow = run(10);
        let fast = run(100);
        assert!(slow[1] > 2.0 * slow[0] && slow[1] > slow[2] && slow[2] > slow[3], "{slow:?}");
        for (a, b) in slow.iter().zip(fast) {
            assert!((a / b - 1.0).abs() < 0.02, "{slow:?} {fast:?}");
        }
    }

    #[test]
    fn standing_lets_the_sd_grow_to_the_range_and_no_further() {
        let mut recursion = bound(RoadKnowledge::Unknown).recursion(30.0);
        recursion.drive(60.0, 241.3, 0.0);
        let moving = recursion.sd_kpa();
        recursion.stand(100.0);
        // 0.4 kPa/sqrt(s) for 100 s is 4 kPa.
        assert!((recursion.sd_kpa() - moving.hypot(4.0)).abs() < 0.05);
        recursion.stand(1e9);
        assert!((recursion.sd_kpa() - 81.0).abs() < 1e-6);
    }

    #[test]
    fn missing_values_and_time_steps_backwards_change_nothing() {
        let mut recursion = bound(RoadKnowledge::Unknown).recursion(30.0);
        recursion.drive(1.0, f64::NAN, f64::NAN);
        assert!((recursion.sd_kpa() - 30.0).abs() < 0.01);
        recursion.drive(-1.0, 240.0, 0.0);
        recursion.drive(f64::NAN, 240.0, 0.0);
        assert!((recursion.sd_kpa() - 30.0).abs() < 0.01);
        recursion.drive(1.0, 240.0, 0.0);
        assert!(recursion.sd_kpa() < 29.0);
    }
}
