//! Report of radius analysis.

use super::config::WheelSpeedConfig;
use super::hypotheses::{Decision, Triangle};
use crate::decision;
use crate::memory::Blank;
use crate::model::{Corner, Wheels};
use crate::real::Real;
use crate::torsion::TorsionEvidence;
use crate::wheel_speed::Tuning;

/// Loss that would have shown where a tire is called fine, as a share of its pressure.
const SHOWN_LOSS: f64 = 0.3;

/// Which tires have lost air since the calibration, against the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RadiusState {
    /// Nothing was learned of this car: no radius is compared with anything.
    #[blank]
    Uncalibrated,
    /// A calibration goes on.
    Calibrating,
    /// For no tire would a loss of 30 % show: too little was driven, or loads may have changed.
    Uninformed,
    /// No loss was found; [`detectable_loss_share`](WheelRadius::detectable_loss_share) says which would have shown.
    NoneDiffers,
    /// These tires are low.
    Low(Wheels),
    /// One or more of these tires are low; which ones, is not known.
    OneOf(Wheels),
}

/// Which tires are low, by their places on the car.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Pattern {
    /// None.
    None,
    /// One wheel.
    Wheel(Corner),
    /// Both of the front or the rear axle.
    Axle,
    /// Both of the left or the right side.
    Side,
    /// Front left and rear right, or the other two.
    Diagonal,
    /// Three.
    Three,
    /// All four.
    All,
}

impl From<Wheels> for Pattern {
    fn from(wheels: Wheels) -> Self {
        let [fl, fr, rl, rr] = Corner::ALL.map(|corner| wheels.contains(corner));
        match wheels.iter().count() {
            0 => Pattern::None,
            1 => wheels.iter().next().map_or(Pattern::None, Pattern::Wheel),
            2 if fl == fr && rl == rr => Pattern::Axle,
            2 if fl == rl => Pattern::Side,
            2 => Pattern::Diagonal,
            3 => Pattern::Three,
            _ => Pattern::All,
        }
    }
}

/// Losses that cannot be detected at the moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Unseen {
    /// A loss of all four tires alike: there is nothing to compare them with, unless tooth pulses show it.
    pub all_alike: bool,
    /// No yaw rate: left and right of both axles move alike, so that of a front wheel and the rear wheel across only the pair may be known.
    pub which_of_a_diagonal: bool,
    /// The car stood since the calibration, so that loads may have changed: rear tires, and both of an axle, need a larger loss.
    pub loads: bool,
    /// Wheels that are coupled under torque, so that a low tire turns like its neighbor.
    pub hidden_by_torque: Wheels,
    /// The driven wheels slip more than on the road of the calibration, as on snow: nothing is reported before it has outlasted that.
    pub slippery: bool,
}

/// State of a wheel's radius.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelRadius<T> {
    /// Change of the rolling radius since the calibration, as a share of it. NaN: not known.
    pub change: T,
    /// Its standard deviation.
    pub change_sd: T,
    /// Share of its pressure that the tire has lost, from the former and the tire's radius over pressure; never below zero.
    pub lost_share: T,
    /// Its standard deviation, that of the radius over pressure included.
    pub lost_share_sd: T,
    /// Probability that this tire is low.
    pub low_probability: T,
    /// Smallest loss of this tire alone that would have shown since the calibration, as a share of its pressure. NaN: not known.
    pub detectable_loss_share: T,
}

impl<T: Real> WheelRadius<T> {
    /// Whether a loss of 30 % of this tire's pressure would have shown.
    #[must_use]
    pub fn informed(&self) -> bool {
        self.detectable_loss_share < T::lit(SHOWN_LOSS)
    }

    fn unknown() -> Self {
        let nan = T::lit(f64::NAN);
        let low_probability = T::zero();
        Self {
            change: nan,
            change_sd: nan,
            lost_share: nan,
            lost_share_sd: nan,
            low_probability,
            detectable_loss_share: nan,
        }
    }
}

/// Report of radius analysis at a time.
#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RadiusReport<T> {
    /// Time of the last sample in s; NaN before the first one.
    pub time_s: f64,
    /// The finding.
    pub state: RadiusState,
    /// How much usable driving the state has lasted, in s.
    pub lasted_s: T,
    /// Probability that any tire is low.
    pub any_low_probability: T,
    /// Each wheel, in the order of [`Corner::ALL`].
    pub wheels: [WheelRadius<T>; 4],
    /// Losses that cannot be detected.
    pub unseen: Unseen,
    /// By how much the ratios of the radii have changed since the calibration: front left over right, rear left over right, front over
    /// rear; what is measured, before anything is concluded of single tires. NaN: not known.
    pub difference: [T; 3],
    /// Their standard deviations, with what loads may have done.
    pub difference_sd: [T; 3],
    /// Time in s of the last sample that counted.
    pub(crate) informed_s: f64,
    /// For how long the car has been driven since the ratio of each axle last counted, in s.
    pub(crate) unseen_s: [T; 2],
    probable: RadiusState,
    probable_s: T,
    /// Seconds for which the road is held to be slippery.
    slippery_s: T,
    /// For how long a loss has been more probable than none, in s.
    loss_s: T,
}

impl<T: Real> RadiusReport<T> {
    /// Nothing known.
    pub(super) fn forget(&mut self, state: RadiusState) {
        let (time_s, unseen) = (self.time_s, self.unseen);
        *self = Self {
            time_s,
            state,
            probable: state,
            unseen,
            wheels: [WheelRadius::unknown(); 4],
            difference: [T::lit(f64::NAN); 3],
            difference_sd: [T::lit(f64::NAN); 3],
            ..Self::BLANK
        };
    }

    /// The three differences in thousandths, with their covariance.
    pub(super) fn differ(&mut self, change: &[T; 3], [front, _, rear, _, _, axles]: &Triangle<T>) {
        let thousandth = T::lit(1e-3);
        self.difference = change.map(|change| thousandth * change);
        self.difference_sd =
            [front, rear, axles].map(|variance| thousandth * variance.at_least(T::zero()).sqrt());
    }

    /// `step_s` of usable driving later, on a road that is surely slippery, or may be.
    pub(super) fn drive_on(&mut self, [surely, maybe]: [bool; 2], step_s: T, tuning: &Tuning) {
        let left_s = (self.slippery_s - step_s).at_least(T::zero());
        let [_, _, slippery_s] = tuning.sure_for_s.map(T::lit);
        self.slippery_s = if surely { slippery_s } else { left_s };
        self.unseen.slippery = maybe || self.slippery_s > T::zero();
    }

    /// Prior of "no loss explains it" over that of one wheel's loss: such a place of the road is as frequent as a loss, and passes.
    pub(super) fn unexplained(&self, tuning: &Tuning) -> T {
        let [_, passes_s, _] = tuning.sure_for_s;
        (self.loss_s * T::lit(-1.0 / passes_s))
            .exp_fast()
            .at_least(T::lit(decision::Tuning::DEFAULT.unexplained))
    }

    /// `step_s` of usable driving later.
    pub(super) fn decide(
        &mut self,
        decision: &Decision<T>,
        least_ln: &[T; 4],
        config: &WheelSpeedConfig<T>,
        torsion: &TorsionEvidence<T>,
        step_s: T,
    ) {
        for (i, wheel) in self.wheels.iter_mut().enumerate() {
            let thousandth = T::lit(1e-3);
            let (change, sd) = (decision.change[i] * thousandth, decision.change_sd[i] * thousandth);
            let beta = config.radius_per_ln_pressure;
            let ln_pressure = (change / beta).at_most(T::zero());
            let ln_sd = (sd / beta).hypot(ln_pressure * config.radius_per_ln_pressure_sd);
            let (ln_pressure, ln_sd) = match torsion.ln_pressure(i) {
                Some(pulses) => combined((ln_pressure, ln_sd * ln_sd), pulses),
                None => (ln_pressure, ln_sd),
            };
            let left = ln_pressure.exp_fast();
            *wheel = WheelRadius {
                change,
                change_sd: sd,
                lost_share: T::one() - left,
                lost_share_sd: left * ln_sd,
                low_probability: decision.sets.low(Corner::ALL[i]),
                detectable_loss_share: T::one() - (-least_ln[i]).exp_fast(),
            };
        }
        self.informed_s = self.time_s;
        self.any_low_probability = decision.sets.any_low();
        let is_probable = self.any_low_probability > decision.sets.none_low();
        self.loss_s = if is_probable { self.loss_s + step_s } else { T::zero() };
        let informed = self.wheels.iter().any(WheelRadius::informed);
        let probable = probable(decision, informed);
        if !self.contradicts(probable) {
            // As after a stop, when radii are learned anew: what was found before it is neither seen nor refuted.
            return;
        }
        self.probable_s = if probable == self.probable { self.probable_s + step_s } else { step_s };
        self.probable = probable;
        let [sure_s, passes_s, slippery_s] = config.tuning().sure_for_s;
        let after_s = match probable {
            RadiusState::Low(_) | RadiusState::OneOf(_) if self.unseen.slippery => slippery_s,
            // One tire of an axle and a side, or two across, are nothing else; without a yaw rate left and right of both axles move alike.
            RadiusState::Low(wheels) => match Pattern::from(wheels) {
                Pattern::Wheel(_) | Pattern::Diagonal if !self.unseen.which_of_a_diagonal => sure_s,
                _ => passes_s,
            },
            RadiusState::OneOf(_) => passes_s,
            _ => 0.0,
        };
        self.lasted_s += step_s;
        if self.state != probable && !(self.probable_s < T::lit(after_s)) {
            self.state = probable;
            self.lasted_s = self.probable_s;
        }
    }
}

impl<T: Real> RadiusReport<T> {
    /// Whether what is probable now says something of the tires that were found low: that none is says so only where a loss would show.
    fn contradicts(&self, probable: RadiusState) -> bool {
        let finds = |state: RadiusState| matches!(state, RadiusState::Low(_) | RadiusState::OneOf(_));
        let shows = |state: RadiusState| match state {
            RadiusState::Low(low) | RadiusState::OneOf(low) => {
                let wheels = Corner::ALL.into_iter().zip(&self.wheels);
                wheels.filter(|(corner, _)| low.contains(*corner)).all(|(_, wheel)| wheel.informed())
            }
            _ => true,
        };
        // One of some is less than is known if it is among them.
        let is_less = |state: RadiusState| match (state, probable) {
            (RadiusState::Low(low), RadiusState::OneOf(some)) => {
                low.iter().all(|corner| some.contains(corner))
            }
            _ => false,
        };
        !is_less(self.state) && (finds(probable) || shows(self.state) && shows(self.probable))
    }
}

/// Mean and sd of two independent readings, each with its variance (`docs/math/wheel-speed.md`, eq. 21); no tire gains air.
fn combined<T: Real>((a, a_variance): (T, T), (b, b_variance): (T, T)) -> (T, T) {
    let sum = a_variance + b_variance;
    if !(sum > T::zero()) {
        return (a, T::zero());
    }
    let mean = (a * b_variance + b * a_variance) / sum;
    (mean.at_most(T::zero()), (a_variance * b_variance / sum).at_least(T::zero()).sqrt())
}

/// What is more probable than [`surely_low`](decision::Tuning::surely_low), whatever was before.
fn probable<T: Real>(decision: &Decision<T>, informed: bool) -> RadiusState {
    let sure = T::lit(decision::Tuning::DEFAULT.surely_low);
    let low: Wheels = Corner::ALL.into_iter().filter(|corner| decision.sets.low(*corner) > sure).collect();
    if !low.is_empty() {
        return RadiusState::Low(low);
    }
    if decision.sets.any_low() > sure {
        // The likeliest two wheels, if it is certainly among them; else any.
        let mut best = (Wheels::NONE, T::zero());
        for (i, a) in Corner::ALL.into_iter().enumerate() {
            for b in Corner::ALL.into_iter().skip(i + 1) {
                let pair = Wheels::from(a) | Wheels::from(b);
                let among = decision.sets.among(pair);
                if among > best.1 {
                    best = (pair, among);
                }
            }
        }
        let all = || Corner::ALL.into_iter().collect();
        return RadiusState::OneOf(if best.1 > sure { best.0 } else { all() });
    }
    if informed { RadiusState::NoneDiffers } else { RadiusState::Uninformed }
}
