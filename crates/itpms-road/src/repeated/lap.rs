//! Information source of a test bed or a drum: a road that repeats itself is shared with the wheel's own past
//! (docs/math/repeated-road.md).
//!
//! Called by the estimator with every grid step. Finds the period by itself, or is told it; confirms it; follows the
//! stiffness while the road keeps repeating; and lets go when it does not. While the same road comes round again and again
//! its spectrum says nothing new, so the estimator's frames must not be believed meanwhile.

mod follow;
mod motion;
mod pass;
mod search;

use crate::memory::{Placed, blank};
use crate::model::ParameterError;
use crate::real::Real;
use crate::single_wheel::periodic_road::follow::{Follower, Verdict};
use crate::single_wheel::periodic_road::pass::{PARTS, Pass, PassClock};
use crate::single_wheel::periodic_road::search::PeriodSearch;
pub(crate) use crate::single_wheel::repetition::{Belief, Corner, Held, PeriodicEstimate, Step};

/// Residual power over the road's that a repeated road may have to be taken for one.
const CONFIRMED: f64 = 0.15;
/// Least number of harmonics of about equal power: a wheel out of balance has one or two.
const LEAST_BREADTH: f64 = 3.5;
/// Periods without the same road after which the road does not repeat any more.
const PATIENCE: u32 = 2;

/// Shortest and longest period in s that a road can be told to repeat with.
const SHORTEST_S: f64 = 0.1;
const LONGEST_S: f64 = 5.0;

/// The time in s after which a road repeats itself.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadPeriod(f64);

impl RoadPeriod {
    /// # Errors
    /// The period must be from 0.1 to 5 s: a shorter one has no harmonics near wheel hop, a longer one too many.
    pub fn new(seconds: f64) -> Result<Self, ParameterError> {
        if (SHORTEST_S..=LONGEST_S).contains(&seconds) {
            Ok(Self(seconds))
        } else {
            Err(ParameterError { name: "road_period_s", value: seconds, expected: "0.1 to 5 s" })
        }
    }
}

/// Whether the road repeats itself, as on a test bed or a drum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RoadRepetition {
    /// Looked for in the data: periods from 0.25 to 1.8 s.
    #[default]
    Detect,
    /// Known to repeat so often.
    Every(RoadPeriod),
    /// Never looked for.
    Never,
}

blank!(RoadRepetition::Detect);

/// A road under observation.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Loop<T: Real> {
    clock: PassClock<T>,
    follower: Option<Follower<T>>,
    held: Held,
    /// Parts of a period since the road was met, and since a pass was last invalid or strange.
    parts: u32,
    sound_parts: u32,
    strange_parts: u32,
    /// Parts since a pass was last weighed, and the s of interruptions among them.
    unused_parts: u32,
    hole_s: T,
    confirmed: bool,
}

blank!(Loop<T> { clock, follower, held, parts, sound_parts, strange_parts, unused_parts, hole_s, confirmed });

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RepeatedRoad<T: Real> {
    repetition: RoadRepetition,
    sample_rate_hz: f64,
    grid_period_s: f64,
    search: PeriodSearch<T>,
    lap: Placed<Loop<T>>,
}

blank!(RepeatedRoad<T> { repetition, sample_rate_hz, grid_period_s, search, lap });

impl<T: Real> RepeatedRoad<T> {
    pub(crate) fn configure(&mut self, repetition: RoadRepetition, sample_rate_hz: f64, grid_period_s: f64) {
        self.repetition = repetition;
        (self.sample_rate_hz, self.grid_period_s) = (sample_rate_hz, grid_period_s);
        self.search.configure(grid_period_s);
        self.lap.clear();
        self.start_if_told();
    }

    fn start(&mut self, period_s: T) {
        let (sample_rate_hz, grid_period_s) = (self.sample_rate_hz, T::lit(self.grid_period_s));
        self.lap.place(|lap| lap.configure(sample_rate_hz, grid_period_s, period_s));
    }

    /// True while the stiffness is followed on a road that repeats: then its spectrum says nothing new.
    pub(crate) fn is_following(&self) -> bool {
        self.lap.as_ref().is_some_and(|lap| lap.confirmed)
    }

    /// The signal was interrupted for this long.
    pub(crate) fn interrupted(&mut self, seconds: T) {
        self.search.restart();
        match self.lap.as_mut() {
            Some(lap) if lap.confirmed && seconds >= T::zero() => lap.interrupted(seconds),
            _ => self.lap.clear(),
        }
        self.start_if_told();
    }

    fn start_if_told(&mut self) {
        if let (None, RoadRepetition::Every(RoadPeriod(period_s))) = (self.lap.as_ref(), self.repetition) {
            self.start(T::lit(period_s));
        }
    }

    /// Takes one grid step; gives an estimate when a part of a period on a confirmed road is complete. `belief` is asked for
    /// when a road is met.
    pub(crate) fn push(
        &mut self,
        step: &Step<T>,
        corner: &Corner<T>,
        belief: impl Fn() -> Belief<T>,
    ) -> Option<PeriodicEstimate<T>> {
        if self.repetition == RoadRepetition::Never {
            return None;
        }
        let Some(lap) = self.lap.as_mut() else {
            if let Some(period_s) = self.search.push(step.wheel, step.force, || belief().theta) {
                self.search.restart();
                self.start(period_s);
            }
            return None;
        };
        if step.invalid {
            lap.sound_parts = 0;
        }
        let pass = lap.clock.push(step.wheel, step.force)?;
        let estimate = lap.take(&pass, corner, &belief());
        if lap.is_over() {
            self.lap.clear();
            self.start_if_told();
        }
        estimate
    }
}

impl<T: Real> Loop<T> {
    fn configure(&mut self, sample_rate_hz: f64, grid_period_s: T, period_s: T) {
        self.clock.configure(sample_rate_hz, grid_period_s, period_s);
        (self.follower, self.held, self.confirmed) = (None, Held::No, false);
        (self.parts, self.sound_parts, self.strange_parts, self.unused_parts) = (0, 0, 0, 0);
        self.hole_s = T::zero();
    }

    /// Takes the last period; gives an estimate if it was one more pass over a confirmed road.
    fn take(
        &mut self,
        pass: &Pass<T>,
        corner: &Corner<T>,
        belief: &Belief<T>,
    ) -> Option<PeriodicEstimate<T>> {
        let parts_per_period = PARTS as u32;
        self.sound_parts = self.sound_parts.saturating_add(1);
        self.unused_parts = self.unused_parts.saturating_add(1);
        if self.sound_parts <= parts_per_period {
            return None;
        }
        let newly_held = belief.held == Held::Yes && self.held == Held::No;
        self.held = belief.held;
        let follower = match &mut self.follower {
            Some(follower) if !newly_held => follower,
            empty => {
                *empty = Some(Follower::meet(pass, &self.clock, corner, belief));
                (self.parts, self.unused_parts, self.hole_s) = (0, 0, T::zero());
                return None;
            }
        };
        self.parts = self.parts.saturating_add(1);
        // A pass that overlaps with the one the road was met in knows nothing new.
        if self.parts < parts_per_period {
            return None;
        }
        let part_s = self.clock.period_s() * PassClock::<T>::share();
        let seconds = part_s * T::lit(f64::from(self.unused_parts));
        let passed_s = seconds + self.hole_s;
        (self.unused_parts, self.hole_s) = (0, T::zero());
        match follower.follow(pass, &self.clock, corner, self.held, passed_s) {
            // The belief has moved on without it, and grown wider.
            Verdict::Strange => self.strange_parts += 1,
            Verdict::Same => {
                self.strange_parts = 0;
                let slip = follower.take_slip(&self.clock);
                self.clock.follow_slip(slip);
                let repeats = follower.strangeness() < T::lit(CONFIRMED);
                self.confirmed |= repeats && follower.breadth() > T::lit(LEAST_BREADTH);
            }
        }
        let (theta, relative_sd, rate_per_s) = follower.compliance(&self.clock);
        let (moving, nis) = (follower.moving(), follower.excess());
        let whole_period = self.parts.is_multiple_of(parts_per_period);
        self.confirmed.then_some(PeriodicEstimate {
            theta,
            relative_sd,
            rate_per_s,
            moving,
            nis,
            seconds,
            whole_period,
        })
    }

    /// The signal was interrupted for this long: the period under way is lost.
    fn interrupted(&mut self, seconds: T) {
        self.clock.skip(seconds);
        self.hole_s += seconds;
        self.sound_parts = 0;
    }

    /// True when the road has stopped to repeat, or was none that does.
    fn is_over(&self) -> bool {
        let parts_per_period = PARTS as u32;
        let unconfirmed = !self.confirmed && self.parts > 3 * parts_per_period;
        unconfirmed || self.strange_parts > PATIENCE * parts_per_period
    }
}
