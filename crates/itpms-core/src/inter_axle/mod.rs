//! The second source of information: the rear wheel meets the road that the front wheel met a moment ago
//! (docs/math/shared-road.md).
//!
//! Both axles reconstruct the road velocity, each with the compliance of its tire; what they differ by, the residual, says
//! that a compliance is wrong. Because the axles carry different unsprung masses, it shows both pressures and not only their
//! difference. Called by [`crate::car`]; reads the belief's state and never writes it.
//!
//! | module | idea |
//! |---|---|
//! | `alignment` | where the rear wheel is now, what did the front wheel measure there? |
//! | `residual` | what front and rear differ by, how it depends on the state, and what is expected of it |

pub(crate) mod alignment;
pub(crate) mod residual;
#[cfg(test)]
mod tests;

use self::alignment::axle_pair::{AxlePair, PairingContext};
use self::alignment::channel::{Channel, Entry, JERK, RELATIVE};
use self::alignment::delay_search::Found;
use self::alignment::opposite_side::OppositeSide;
use self::alignment::travel::Travel;
use self::residual::model::{Axle, AxleFrame, Wheel};
use crate::belief::Belief;
use crate::belief::measurement::BINS;
use crate::belief::state::{SKEW, WHEELBASE};
use crate::conditioning::GridSample;
use crate::conditioning::pauses::PAUSE_S;
use crate::inter_axle::alignment::channel::BOTH;
use crate::memory::{Blank, Placed};
use crate::model::{CarConfig, Corner, QuarterCar, Side};
use crate::real::Real;
use crate::spectrum::SIGNALS as MOTION;
use crate::spectrum::front_end::band_delay_s;
use crate::spectrum::transfer::Body;

/// Time between frames in s, and so the distance of the bins in Hz: 5, 10, ... 25 Hz.
pub(crate) const HOP_S: f64 = 0.1;
pub(crate) const BIN_SPACING_HZ: f64 = 0.5 / HOP_S;
pub(crate) type Frame<T> = crate::spectrum::Frame<T, BINS, SIGNALS>;
/// Signals of both axles, and what they would be on the road both agree on.
pub(crate) const SIGNALS: usize = 2 * BOTH;
/// The bins around wheel hop: 10 and 15 Hz.
pub(crate) const NEAR_HOP_BINS: [usize; 2] = [1, 2];

pub(crate) fn bin_hz<T: Real>(bin: usize) -> T {
    T::lit((bin + 1) as f64 * BIN_SPACING_HZ)
}

/// Delay in sampling periods of the sensors' anti-alias filter, a Butterworth of order four at 0.3 of the rate.
const SENSOR_DELAY_PERIODS: f64 = 2.613 / (core::f64::consts::TAU * 0.3);
/// Entries of two corners within so many periods are of the same time.
const NEAR_PERIODS: f64 = 0.6;

/// What an entry of a rear corner leads to.
#[derive(Debug)]
pub(crate) enum Aligned<T: Real> {
    /// The delay was found for the first time.
    FirstDelay(Found<T>),
    /// Another delay was found than believed.
    OtherDelay(Found<T>),
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct InterAxle<T: Real> {
    wheelbase_m: T,
    wheels: [Placed<Wheel<T>>; 4],
    channels: [Channel; 4],
    pub(crate) pairs: [AxlePair<T>; 2],
    /// The newest two entries of the rear corners, newest first.
    rear: [[Placed<Entry<T>>; 2]; 2],
    /// Seconds from front to rear wheel, left and right.
    delay_s: [T; 2],
    /// Seconds by which the speed was found to be late, and by which filters delay the signals more than that.
    speed_latency_s: f64,
    delayed_s: T,
    travel: Travel<T>,
}

impl<T: Real> InterAxle<T> {
    /// The wheelbase in m of a car that has both corners of a side; `None`: nothing is to be aligned.
    pub(crate) fn wheelbase_m(config: &CarConfig<T>) -> Option<T> {
        let there = config.corners.each_ref().map(Option::is_some);
        let whole = |side: Side| there[side.front()] && there[side.rear()];
        config.wheelbase_m.filter(|_| Side::ALL.into_iter().any(whole))
    }

    /// For the sides that have both corners.
    pub(crate) fn configure(
        &mut self,
        config: &CarConfig<T>,
        wheelbase_m: T,
        sample_rate_hz: f64,
        grid_period_s: f64,
    ) {
        let wheel = |corner: Corner| {
            config.corners[corner].as_ref().map(|c| {
                let theta = T::one() / c.tire.stiffness_n_per_m(c.placard_kpa);
                let body = Body::from(&c.quarter_car);
                let axle = [Corner::RearLeft, Corner::RearRight];
                let may_be_coupled =
                    axle.contains(&corner) && axle.iter().all(|&corner| config.corners[corner].is_some());
                let coupled_kg = if may_be_coupled { body.unsprung_mass_kg } else { T::zero() };
                Wheel { body, friction_n_s_per_m: T::zero(), theta, coupled_kg, corner }
            })
        };
        self.wheelbase_m = wheelbase_m;
        Corner::ALL.into_iter().for_each(|corner| self.wheels[corner].set(wheel(corner)));
        for channel in &mut self.channels {
            *channel = Channel::new(grid_period_s);
        }
        let period_s = self.channels[0].period_s();
        let noise = |corner: Corner| {
            let sd = config.corners[corner].as_ref().map_or(T::zero(), |c| c.accel_noise_or_usual_m_s2());
            sd * sd * T::lit(2.0 / sample_rate_hz)
        };
        for side in Side::ALL {
            self.pairs[side].configure(side, period_s, [noise(side.front()), noise(side.rear())]);
        }
        self.rear.iter_mut().flatten().for_each(Placed::clear);
        self.delay_s = [T::zero(); 2];
        self.speed_latency_s = 0.0;
        self.delayed_s = T::lit(band_delay_s(grid_period_s) + SENSOR_DELAY_PERIODS / sample_rate_hz);
        self.travel = Travel::new();
    }

    /// Takes the time and the speed of the samples that follow.
    pub(crate) fn drive(&mut self, time_s: f64, speed_m_s: T) {
        self.travel.drive(time_s, speed_m_s);
    }

    /// Takes a grid step of a corner and its signals of the band; gives an entry of a rear corner that is due to be aligned.
    pub(crate) fn take(
        &mut self,
        corner: Corner,
        sample: &GridSample<T>,
        signals: &[T; MOTION],
    ) -> Option<Entry<T>> {
        // The road that the signals tell lies as far back as filters delay them: at another speed, another distance.
        let (travel, delayed_s) = (&self.travel, self.delayed_s);
        let entry =
            self.channels[corner].push(sample, signals, || travel.way_before(sample.time_s, delayed_s))?;
        let side = corner.side();
        if corner.axle() == 0 {
            self.pairs[side].front(&entry);
            return None;
        }
        // One entry late, so that the other side's of the same time is there, too.
        let [newest, before] = &mut self.rear[side];
        *before = *newest;
        newest.set(Some(entry));
        before.get()
    }

    /// Aligns an entry of a rear corner with the road that the front met; gives `enqueue` a frame of both axles when one is complete.
    pub(crate) fn align(
        &mut self,
        side: Side,
        entry: &Entry<T>,
        belief: &Belief<T>,
        enqueue: impl FnOnce(AxleFrame<T>),
    ) -> Option<Aligned<T>> {
        let wheels = self.wheels(side)?;
        let opposite = self.opposite(side, entry);
        let road = PairingContext {
            wheelbase_m: self.wheelbase_m,
            wheels,
            wheelbase: belief.quantity(WHEELBASE).0,
            skew: belief.quantity(SKEW + side.index()).0,
            state: &belief.most_likely().mean,
        };
        if !self.pairs[side].is_aligned() {
            return self.pairs[side].search(entry, &road).map(Aligned::FirstDelay);
        }
        let [left, right] = &mut self.pairs;
        let (own, other) = if side == Side::Left { (left, right) } else { (right, left) };
        own.pair(entry, opposite, other, &road, enqueue);
        own.search_again(entry, &road).map(Aligned::OtherDelay)
    }

    /// How the suspension of the other rear corner moves at the same time.
    fn opposite(&self, side: Side, entry: &Entry<T>) -> OppositeSide<T> {
        let near_s = NEAR_PERIODS * self.channels[0].period_s();
        let apart_s = |other: &&Entry<T>| (other.time_s - entry.time_s).abs();
        let others = || self.rear[side.other()].iter().flatten();
        match others().find(|other| apart_s(other) < near_s && !other.invalid) {
            Some(other) => OppositeSide::Known([RELATIVE, JERK].map(|i| other.signals[i])),
            None if others().all(|other| apart_s(&other) > PAUSE_S) => OppositeSide::Silent,
            None => OppositeSide::Missed,
        }
    }

    /// Takes over the quarter car that a corner seems to be, and what the friction of its strut damps near wheel hop.
    pub(crate) fn set_strut(
        &mut self,
        corner: Corner,
        car: &QuarterCar<T>,
        friction_n_s_per_m: T,
        belief: &Belief<T>,
    ) {
        let Some(wheel) = self.wheels[corner].as_mut() else { return };
        wheel.friction_n_s_per_m = friction_n_s_per_m;
        // How the body follows its wheel depends on damping over mass.
        let believed = Axle::new(wheel, &belief.most_likely().mean).whole_damping;
        let found = car.damping_n_s_per_m() + friction_n_s_per_m;
        wheel.body.sprung_mass_kg = car.sprung_mass_kg() * believed / found;
    }

    /// Takes over whether the road under a corner is one line.
    pub(crate) fn set_on_line(&mut self, corner: Corner, on_line: bool) {
        self.pairs[corner.side()].set_on_line(corner.axle(), on_line);
    }

    /// Whether a corner has a partner on its side.
    pub(crate) fn has_partner(&self, corner: Corner) -> bool {
        self.wheels(corner.side()).is_some()
    }

    /// The two corners of a side that has both.
    pub(crate) fn wheels(&self, side: Side) -> Option<[Wheel<T>; 2]> {
        Some([self.wheels[side.front()].get()?, self.wheels[side.rear()].get()?])
    }

    /// Whether no side gives frames, and pseudo-measurements of the spectra are all there is.
    pub(crate) fn spectral_only(&self) -> bool {
        Side::ALL.into_iter().all(|side| !self.has_partner(side.front()) || self.pairs[side].spectral_only())
    }

    pub(crate) fn travel(&self) -> &Travel<T> {
        &self.travel
    }

    /// A frame was learned from.
    pub(crate) fn learned(&mut self) {
        self.travel.restart_unshared();
    }

    /// Notes the delay of a side's newest frame.
    pub(crate) fn set_delay(&mut self, side: Side, delay_s: T) {
        self.delay_s[side] = delay_s;
    }

    /// Seconds from front to rear wheel, left and right.
    pub(crate) fn delay_s(&self) -> [T; 2] {
        self.delay_s
    }

    /// Seconds by which the speed was found to be late, and is allowed for.
    pub(crate) fn speed_latency_s(&self) -> f64 {
        self.speed_latency_s
    }

    /// The speed is late by so many seconds more.
    pub(crate) fn add_speed_latency(&mut self, seconds: T) {
        self.speed_latency_s += seconds.to_f64();
        self.delayed_s -= seconds;
    }
}
