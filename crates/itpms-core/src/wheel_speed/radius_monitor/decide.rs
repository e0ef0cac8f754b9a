//! Losses by the radii: while the car drives, since the calibration, and over days (`docs/math/wheel-speed.md`, sections 4 and 5).

use super::RadiusMonitor;
use crate::decision::Since;
use crate::memory::Blank;
use crate::model::{Corner, Wheels};
use crate::real::Real;
use crate::torsion::TorsionEvidence;
use crate::wheel_speed::block::{BLOCK_S, Block};
use crate::wheel_speed::calibration::RadiusCalibration;
use crate::wheel_speed::days::{DAY_S, RadiusDay, RadiusDays, SlowLeak};
use crate::wheel_speed::hypotheses::{
    Decision, PLACES, Triangle, add_load, add_radii, all_would_be_found, least_found,
};
use crate::wheel_speed::report::{RadiusState, Unseen};
use crate::wheel_speed::state::{CHANGE, OFFSET};

impl<T: Real> RadiusMonitor<T> {
    /// Goes on with what the days since the calibration have shown.
    pub(crate) fn load_days(&mut self, days: &RadiusDays<T>) {
        self.days = *days;
        self.slow_leak = match self.calibration.as_ref() {
            Some(calibration) => days.verdict(&self.usual(calibration), self.config.tuning()),
            None => SlowLeak::BLANK,
        };
    }

    /// Takes in what another day has shown; whether it counts.
    pub(crate) fn add_day(&mut self, day: &RadiusDay<T>) -> bool {
        let unix_s = self.days.calibrated_unix_s + DAY_S * day.day.to_f64();
        let counts = self.days.see(unix_s, &day.change_1e3, &day.covariance_1e6);
        if let Some(calibration) = self.calibration.as_ref().filter(|_| counts) {
            self.slow_leak = self.days.verdict(&self.usual(calibration), self.config.tuning());
        }
        counts
    }

    /// Prior covariance of the usual load's effect since the calibration, the calibration's included: half of a load's variance is the car's
    /// usual one, half the day's.
    fn usual(&self, calibration: &RadiusCalibration<T>) -> Triangle<T> {
        let mut usual = PLACES.map(|(i, j)| calibration.covariance_1e6[i][j]);
        add_load(&mut usual, &self.config, 0.5);
        usual
    }

    /// Results of the days since the calibration, with this one.
    #[must_use]
    pub(crate) fn days(&self) -> &RadiusDays<T> {
        &self.days
    }

    /// Their evidence of a slow leak.
    #[must_use]
    pub(crate) fn slow_leak(&self) -> &SlowLeak<T> {
        &self.slow_leak
    }

    /// By how much the three ratios have changed while the car drove, in thousandths, with their covariance, and that of the offsets from which
    /// they are counted.
    pub(super) fn driving(&self) -> ([T; 3], [Triangle<T>; 2]) {
        let belief = self.filter.belief();
        let change = core::array::from_fn(|i| belief.mean[CHANGE + i]);
        let covariance = PLACES.map(|(i, j)| belief.get(CHANGE + i, CHANGE + j));
        (change, [covariance, PLACES.map(|(i, j)| belief.get(OFFSET + i, OFFSET + j))])
    }

    /// The same since the calibration, with what loads may have done; `None` before the car has stood since then: so long it is what has
    /// changed while it drove.
    pub(super) fn since_calibration(&self) -> Option<([T; 3], Triangle<T>)> {
        let calibration = self.calibration.as_ref().filter(|_| self.began_anew)?;
        let (change, mut covariance) = self.now(calibration);
        covariance.iter_mut().zip(PLACES).for_each(|(sum, (i, j))| *sum += calibration.covariance_1e6[i][j]);
        if self.loads_may_differ {
            add_load(&mut covariance, &self.config, 1.0);
        }
        Some((change, covariance))
    }

    /// Change of the three ratios since the calibration, and the covariance of their present values.
    fn now(&self, calibration: &RadiusCalibration<T>) -> ([T; 3], Triangle<T>) {
        let belief = self.filter.belief();
        let now = |i: usize| belief.mean[OFFSET + i] + belief.mean[CHANGE + i];
        let covariance = PLACES.map(|(i, j)| {
            let both = belief.get(OFFSET + i, CHANGE + j) + belief.get(CHANGE + i, OFFSET + j);
            belief.get(OFFSET + i, OFFSET + j) + belief.get(CHANGE + i, CHANGE + j) + both
        });
        (core::array::from_fn(|i| now(i) - calibration.mean_1e3[i]), covariance)
    }

    /// Takes in what is known of this day, and decides anew of a slow leak where that is more.
    fn note_day(&mut self) {
        let Some(calibration) = self.calibration.as_ref().filter(|_| self.began_anew) else { return };
        let (change, mut covariance) = self.now(calibration);
        let usual = self.usual(calibration);
        let tuning = self.config.tuning();
        let [fine_driving_sd, _] = tuning.fine_sd;
        add_load(&mut covariance, &self.config, 0.5);
        add_radii(&mut covariance, fine_driving_sd);
        if self.days.see(self.clock_began_unix_s + self.report.time_s, &change, &covariance) {
            self.slow_leak = self.days.verdict(&usual, tuning);
        }
    }

    /// Loads move at a stop only, so a loss while the car drove is separable from them: of the changes in this drive and since the calibration
    /// the one with more evidence for a loss counts.
    pub(super) fn decide(&mut self, block: &Block<T>) {
        let tuning = self.config.tuning();
        let (change, [covariance, offsets]) = self.driving();
        let since = self.since_calibration();
        let nothing = TorsionEvidence::BLANK;
        let torsion = if since.is_some() { &nothing } else { &self.torsion };
        let unexplained = self.report.unexplained(tuning);
        let mut decision =
            Decision::of(&change, &covariance, Since::Beginning, torsion, unexplained, &self.config);
        let mut differ = (change, covariance);
        let least: [T; 4];
        if let Some((change, covariance)) = since {
            let across =
                Decision::of(&change, &covariance, Since::Ever, &self.torsion, unexplained, &self.config);
            if !(decision.sets.any_low() > across.sets.any_low()) {
                decision = across;
            }
            differ = (change, covariance);
            least = core::array::from_fn(|i| {
                least_found(i, &covariance, Since::Ever, &self.torsion, &self.config)
            });
        } else {
            // That radii have not moved is believed without any sample; what moves one stands out from how well its offset is known.
            let noise = core::array::from_fn(|i| covariance[i] + offsets[i]);
            least = core::array::from_fn(|i| {
                T::lit(tuning.driving_margin)
                    * least_found(i, &noise, Since::Beginning, &self.torsion, &self.config)
            });
        }
        self.report.unseen = Unseen {
            all_alike: !all_would_be_found(&self.torsion),
            which_of_a_diagonal: !self.filter.yaw_known,
            loads: self.loads_may_differ,
            hidden_by_torque: hidden(block),
            slippery: false,
        };
        self.report.drive_on(self.filter.is_slippery(), T::lit(BLOCK_S), tuning);
        self.report.differ(&differ.0, &differ.1);
        if !self.report.unseen.slippery {
            self.note_day();
        }
        if self.following.is_doubtful(tuning) {
            // Nothing is reported of a loss that may be none; nor is any tire known to be fine.
            self.report.forget(RadiusState::Uninformed);
            return;
        }
        self.report.decide(&decision, &least, &self.config, &self.torsion, T::lit(BLOCK_S));
    }
}

fn hidden<T: Real>(block: &Block<T>) -> Wheels {
    Corner::ALL.into_iter().filter(|corner| block.hidden[corner.axle()]).collect()
}
