//! One road under observation: whether it is met again, and what its passes show of the compliance.
//!
//! Knows nothing of samples or pressures, nor how the period was found.

use itpms_core::Real;

use super::follow::{Follower, Verdict};
use super::given::{Belief, Corner, Held};
use super::pass::{PARTS, Pass, PassClock};

/// Residual power over the road's that a repeated road may have to be taken for one.
const CONFIRMED: f64 = 0.15;
/// Least number of harmonics of about equal power: a wheel out of balance has one or two.
const LEAST_BREADTH: f64 = 3.5;
/// Periods without the same road after which the road does not repeat any more.
const PATIENCE: u32 = 2;

/// The compliance that passes over a repeated road show.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PeriodicEstimate<T> {
    pub(crate) theta: T,
    pub(crate) relative_sd: T,
    /// Relative change of the compliance per second.
    pub(crate) rate_per_s: T,
    pub(crate) moving: T,
    /// Residual power over expected power: about 1 when the model holds.
    pub(crate) nis: T,
    pub(crate) seconds: T,
    pub(crate) whole_period: bool,
}

#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Lap<T: Real> {
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
    pub(super) confirmed: bool,
}

impl<T: Real> Lap<T> {
    /// For samples taken at `sample_rate_hz` that come on a grid, and a road of that period.
    pub(crate) fn new(sample_rate_hz: f64, grid_period_s: T, period_s: T) -> Self {
        Self {
            clock: PassClock::new(sample_rate_hz, grid_period_s, period_s),
            follower: None,
            held: Held::No,
            parts: 0,
            sound_parts: 0,
            strange_parts: 0,
            unused_parts: 0,
            hole_s: T::zero(),
            confirmed: false,
        }
    }

    /// Takes one grid step of `wheel + θ force`, with a sensor at its limit or not; gives an estimate when a part of a period on a
    /// confirmed road is complete.
    pub(crate) fn push(
        &mut self,
        wheel: T,
        force: T,
        is_invalid: bool,
        corner: &Corner<T>,
        belief: &Belief<T>,
    ) -> Option<PeriodicEstimate<T>> {
        if is_invalid {
            self.sound_parts = 0;
        }
        let pass = self.clock.push(wheel, force)?;
        self.take(&pass, corner, belief)
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
                let repeats = follower.strangeness < T::lit(CONFIRMED);
                self.confirmed |= repeats && follower.breadth() > T::lit(LEAST_BREADTH);
            }
        }
        let (theta, relative_sd, rate_per_s) = follower.compliance(&self.clock);
        let (moving, nis) = (follower.moving(), follower.excess);
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
    pub(crate) fn interrupted(&mut self, seconds: T) {
        self.clock.skip(seconds);
        self.hole_s += seconds;
        self.sound_parts = 0;
    }

    /// True when the road has stopped to repeat, or was none that does.
    pub(crate) fn is_over(&self) -> bool {
        let parts_per_period = PARTS as u32;
        let unconfirmed = !self.confirmed && self.parts > 3 * parts_per_period;
        unconfirmed || self.strange_parts > PATIENCE * parts_per_period
    }
}
