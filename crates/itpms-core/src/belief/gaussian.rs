//! One Gaussian of the belief: what the car is if pressures change in one way. Knows how a change begins and ends in it, how what
//! is known wanders, and what no tire can be; nothing of the other ways.

use super::covariance::Covariance;
use super::state::{
    BAR, DAMPING, IN_COMMON, LEVEL, RATE, SIZE, SPECTRUM_BIAS, SPECTRUM_BIASES, SPRING, State, TIRE, end_sd,
    prior_sd, rear_bar_variance, return_rate, wander_sd,
};
use crate::memory::Blank;
use crate::model::Corner;
use crate::real::Real;

/// Seconds within which dampings and springs become what friction that is not known makes of them. Friction is constant in newtons; what it makes of
/// a strut changes with the road.
const FRICTION_S: f64 = 600.0;
/// Mean, and as large an sd, in 1/s of the rate at which a compliance begins to grow: 0.08/s is a tire that loses some 26 kPa/s.
const BEGINNING: f64 = 0.08;
/// Growth per square root of a second of the sd that all tires' compliances have in common: air warms up, cools down and seeps out of all of
/// them alike. A fifth of the pressure in an hour is two sds.
const IN_COMMON_SD: f64 = 1.2e-3;
/// Variance of a loss below which it is known better than single precision can tell, and no bound moves anything.
const LEAST_LOSS_VARIANCE: f64 = 1e-9;
/// The least that a tire's compliance can be, over that at placard pressure, less one: at more than twice that pressure.
const HARDEST: f64 = -0.5;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Hypothesis<T: Real> {
    pub(crate) mean: State<T>,
    pub(crate) covariance: Covariance<T>,
    pub(crate) weight: T,
}

/// A Gaussian as it is added to others: itself, but for its rate of change. A copy of a covariance is more than a controller's
/// stack has room for.
pub(crate) struct Part<'a, T: Real> {
    pub(super) mean: State<T>,
    covariance: &'a Covariance<T>,
    /// Whether the rate's covariances with all else are the Gaussian's, or none.
    rate_is_free: bool,
    rate_variance: T,
}

impl<T: Real> Part<'_, T> {
    /// A constant one as it is when a change begins, `at_a_rate` or any way.
    pub(crate) fn with_onset(mut self, at_a_rate: bool) -> Self {
        if at_a_rate {
            self.mean[RATE] = T::lit(BEGINNING);
            self.rate_variance = T::lit(BEGINNING * BEGINNING);
        }
        self
    }

    /// The same when its change is over.
    pub(crate) fn without_rate(mut self) -> Self {
        self.mean[RATE] = T::zero();
        (self.rate_is_free, self.rate_variance) = (false, T::zero());
        self
    }

    /// Its rate's covariance with a quantity.
    fn rate_covariance(&self, with: usize) -> T {
        match with {
            RATE => self.rate_variance,
            _ if self.rate_is_free => self.covariance[(with, RATE)],
            _ => T::zero(),
        }
    }

    /// Writes it where a Gaussian is to be.
    pub(crate) fn write(&self, weight: T, into: &mut Hypothesis<T>) {
        into.covariance.copy_from(self.covariance);
        (0..SIZE).for_each(|i| into.covariance[(i, RATE)] = self.rate_covariance(i));
        (into.mean, into.weight) = (self.mean, weight);
    }
}

/// What is known of the car, the present road and the driver's doings, on which it depends how far and how fast quantities wander.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Circumstances<T> {
    /// How far the unsprung masses may be from the vehicle file's, as a share of them.
    pub(crate) mass_sd: [T; 4],
    /// What friction that is not known makes of each corner.
    pub(crate) friction_error: [FrictionError<T>; 4],
    /// A calibration holds the tires at their placard pressures.
    pub(crate) tires_set: bool,
}

/// As what a corner's friction passes where it is not known exactly: variances relative to the vehicle file's values squared.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FrictionError<T> {
    /// Of damping and spring.
    pub(crate) damping: T,
    pub(crate) spring: T,
    /// What friction damps, over the damper of the vehicle file: so much of it may have been taken out too much.
    pub(crate) damped: T,
}

impl<T: Real> Circumstances<T> {
    /// Nothing is known of the road yet.
    pub(crate) fn of_a_car(mass_sd: [T; 4]) -> Self {
        Self { mass_sd, friction_error: [FrictionError::BLANK; 4], tires_set: false }
    }
}

/// How the quantities change by themselves over a time: by which share each stays, and the variance it gains.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Wandering<T: Real> {
    stays: State<T>,
    variance: State<T>,
    /// Standard deviation that all tires' compliances gain in common.
    in_common_sd: T,
}

impl<T: Real> Wandering<T> {
    /// Dampings and springs may besides be others by what friction makes of them, and become so within [`FRICTION_S`] (Ornstein-Uhlenbeck
    /// processes).
    pub(crate) fn over(seconds: T, circumstances: &Circumstances<T>) -> Self {
        let (sd, prior_sd) = (wander_sd::<T>(), prior_sd(&circumstances.mass_sd));
        let (end_sd, mut rate) = (end_sd(&prior_sd), return_rate(&prior_sd));
        let mut gained = sd.component_mul(&sd);
        for (i, error) in circumstances.friction_error.iter().enumerate() {
            for (at, besides) in [(DAMPING + i, error.damping), (SPRING + i, error.spring)] {
                gained[at] += besides * T::lit(2.0 / FRICTION_S);
                rate[at] = T::lit(0.5) * gained[at] / (end_sd[at] * end_sd[at] + besides);
            }
        }
        let mut in_common_sd = T::lit(IN_COMMON_SD);
        if circumstances.tires_set {
            gained.fixed_rows_mut::<4>(TIRE).fill(T::zero());
            in_common_sd = T::zero();
        }
        Self {
            stays: rate.map(|rate| (-rate * seconds).exp_fast()),
            variance: gained * seconds,
            in_common_sd: in_common_sd * seconds.sqrt(),
        }
    }
}

impl<T: Real> Hypothesis<T> {
    /// A car as its file has it, the tires' compliances around these.
    pub(crate) fn start(&mut self, tires: &[T; 4], mass_sd: &[T; 4]) {
        let sd = prior_sd(mass_sd);
        self.covariance.clear();
        self.covariance.set_variances(&sd.component_mul(&sd));
        let [rear, both] = rear_bar_variance(self.covariance[(BAR, BAR)]);
        (self.covariance[(BAR + 1, BAR + 1)], self.covariance[(BAR, BAR + 1)]) = (rear, both);
        let common = T::lit(IN_COMMON) * self.covariance[(SPECTRUM_BIAS, SPECTRUM_BIAS)];
        self.covariance.add_in_common(SPECTRUM_BIASES, common);
        self.mean.fill(T::zero());
        self.mean.fixed_rows_mut::<4>(TIRE).copy_from_slice(tires);
        self.weight = T::one();
    }

    /// Becomes a copy of the other one.
    pub(crate) fn take_over(&mut self, other: &Self) {
        self.mean.copy_from(&other.mean);
        self.covariance.copy_from(&other.covariance);
        self.weight = other.weight;
    }

    pub(crate) fn part(&self) -> Part<'_, T> {
        let (mean, rate_variance) = (self.mean, self.covariance[(RATE, RATE)]);
        Part { mean, covariance: &self.covariance, rate_is_free: true, rate_variance }
    }

    /// Becomes the one Gaussian that has mean and covariance of itself and a part together, each with its weight: of parts that join one
    /// after the other it does not matter in which order.
    pub(crate) fn join(&mut self, weight: T, part: &Part<'_, T>) {
        let total = self.weight + weight;
        if !(total > T::zero()) {
            return;
        }
        let (stays, joins) = (self.weight / total, weight / total);
        self.weight = total;
        // So little is lost in the rounding of what is there.
        if joins < T::epsilon() {
            return;
        }
        let off = part.mean - self.mean;
        self.mean.axpy(joins, &off, T::one());
        // The rate, which comes last, has covariances of its own.
        let between = stays * joins;
        self.covariance.join(RATE, [stays, joins, between], part.covariance, &off);
        for i in 0..SIZE {
            let joined = joins * part.rate_covariance(i) + between * off[i] * off[RATE];
            self.covariance[(i, RATE)] = stays * self.covariance[(i, RATE)] + joined;
        }
    }

    /// What changes by itself does so: about the vehicle file, and never further than a car may be from it.
    pub(crate) fn wander(&mut self, wandering: &Wandering<T>) {
        let Wandering { stays, variance, in_common_sd } = wandering;
        self.mean.component_mul_assign(stays);
        self.covariance.shrink(stays);
        self.covariance.set_variances(&(self.covariance.variances() + variance));
        self.covariance.add_in_common(SPECTRUM_BIASES, T::lit(IN_COMMON) * variance[SPECTRUM_BIAS]);
        self.change_alike(&[*in_common_sd; 4]);
    }

    /// All tires' compliances may have changed together, each by so much for one sd of all.
    pub(crate) fn change_alike(&mut self, sd: &[T; 4]) {
        for (j, &of_one) in sd.iter().enumerate() {
            for (i, &of_other) in sd.iter().enumerate().take(j + 1) {
                self.covariance[(TIRE + i, TIRE + j)] += of_other * of_one;
            }
        }
    }

    pub(crate) fn is_possible(&self, softest: &[T; 4]) -> bool {
        softest.iter().enumerate().all(|(i, &softest)| {
            let tire = self.mean[TIRE + i];
            tire > T::lit(HARDEST) && tire <= softest
        })
    }

    /// A tire that is softer than flat is flat, give or take what it was more.
    pub(crate) fn stop_at(&mut self, softest: &[T; 4]) {
        for (i, &softest) in softest.iter().enumerate() {
            let at = TIRE + i;
            let more = self.mean[at] - softest;
            if more > T::zero() && more.is_finite() {
                self.mean[at] = softest;
                self.covariance[(at, at)] += more * more;
            }
        }
    }

    /// Projects the mean, if it lies below `least` of a quantity, onto that bound, weighted by the covariance: the likeliest state that the
    /// bound allows. The covariance stays, so that a bound which is met again and again adds no certainty. Gives the logarithm of the share
    /// of its belief that the bound allows, over the half of one that has it for its mean.
    pub(crate) fn hold_above(&mut self, at: usize, least: T) -> T {
        let at = at.min(SIZE - 1);
        let (below, variance) = (least - self.mean[at], self.covariance[(at, at)]);
        if !(below > T::zero() && variance > T::zero()) {
            return T::zero();
        }
        self.covariance.add_column(at, below / variance, &mut self.mean);
        log_twice_beyond(below / variance.sqrt())
    }

    /// The loss of a tire begins to be counted: what it is now is its level.
    pub(crate) fn begin_loss(&mut self, tire: Corner) {
        let (tire, level) = (TIRE + tire.index(), LEVEL + tire.index());
        self.mean[level] = self.mean[tire];
        for i in 0..SIZE {
            self.covariance[(i, level)] = self.covariance[(i, tire)];
        }
        self.covariance[(level, level)] = self.covariance[(tire, tire)];
    }

    /// What a tire has lost since then, as a compliance.
    pub(crate) fn loss(&self, tire: Corner) -> T {
        self.mean[TIRE + tire.index()] - self.mean[LEVEL + tire.index()]
    }

    pub(crate) fn loss_covariance(&self, a: Corner, b: Corner) -> T {
        let (a, b, p) = (a.index(), b.index(), &self.covariance);
        p[(TIRE + a, TIRE + b)] - p[(TIRE + a, LEVEL + b)] - p[(LEVEL + a, TIRE + b)]
            + p[(LEVEL + a, LEVEL + b)]
    }

    /// Covariance of a tire's loss with another tire's compliance now.
    pub(crate) fn loss_by_tire(&self, loss: Corner, tire: Corner) -> T {
        let (loss, tire, p) = (loss.index(), TIRE + tire.index(), &self.covariance);
        p[(TIRE + loss, tire)] - p[(LEVEL + loss, tire)]
    }

    /// As [`hold_above`](Self::hold_above), of a tire's loss.
    pub(crate) fn hold_loss_above(&mut self, tire: Corner, least: T) -> T {
        let (below, variance) = (least - self.loss(tire), self.loss_covariance(tire, tire));
        if !(below > T::zero() && variance > T::lit(LEAST_LOSS_VARIANCE)) {
            return T::zero();
        }
        self.covariance.add_column(TIRE + tire.index(), below / variance, &mut self.mean);
        self.covariance.add_column(LEVEL + tire.index(), -below / variance, &mut self.mean);
        log_twice_beyond(below / variance.sqrt())
    }

    /// Covariances of everything with a number of these derivatives.
    #[inline(never)]
    pub(crate) fn spread(&self, slope: &State<T>) -> State<T> {
        // Most numbers depend on few quantities.
        let mut spread = State::zeros();
        for (of, &by) in slope.iter().enumerate().filter(|(_, by)| **by != T::zero()) {
            self.covariance.add_column(of, by, &mut spread);
        }
        spread
    }

    /// Updates with a number of this variance and these derivatives that is by the innovation more than expected; gives the
    /// innovation's variance.
    pub(crate) fn update(&mut self, slope: &State<T>, innovation: T, variance: T) -> T {
        let spread = self.spread(slope);
        let total = slope.dot(&spread) + variance;
        if !(total > T::zero()) {
            return total;
        }
        let share = T::one() / total;
        self.mean.axpy(innovation * share, &spread, T::one());
        self.covariance.add_product(-share, &spread);
        self.covariance.hold_variances();
        total
    }
}

/// `√(2 π)`: without std, no number has its root.
const ROOT_OF_TWO_PI: f64 = 2.506_628_274_631_000_2;

/// Logarithm of twice the chance that a standard normal variable is more than this, which is not negative: Boyd's bound of Mills' ratio,
/// at most 1.2 % too small.
fn log_twice_beyond<T: Real>(deviations: T) -> T {
    let (pi, square) = (core::f64::consts::PI, deviations * deviations);
    let ratio = T::lit(ROOT_OF_TWO_PI) / (T::lit(pi - 1.0) * deviations + (square + T::lit(2.0 * pi)).sqrt());
    ratio.ln_fast() - T::lit(0.5) * square
}
