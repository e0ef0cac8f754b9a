//! One side of the car: what the front met, read again where the rear is now, and cut into frames of both.

use super::acquire::{Acquisition, Found};
use super::channel::{Entry, KEPT};
use super::coherence::Coherence;
use super::constraint::{TrackFrame, Wheel, compare, sensor_noise};
use super::memory::{Memory, Read};
use super::modes::{Modes, moves};
use super::parameters::{DAMPING, MASS, SKEW_UNIT_S, SPRING, State, TIRE};
use super::{BINS, HOP_S};
use crate::frame::FrameClock;
use crate::real::Real;

/// Slowest speed in m/s at which a road is shared.
const SLOWEST_M_S: f64 = 2.8;
/// Seconds without a frame after which a side counts as not shared.
const STALE_S: f64 = 1.0;
/// Incoherence near wheel hop from which on a side counts as not shared.
const APART: f64 = 0.5;

/// What is believed of the car where the two axles meet.
pub(super) struct Meeting<'a, T: Real> {
    pub(super) wheelbase_m: T,
    pub(super) wheels: [Wheel<T>; 2],
    pub(super) wheelbase: T,
    pub(super) skew: T,
    pub(super) state: &'a State<T>,
}

/// See the [module](self).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub(super) struct Track<T: Real> {
    side: usize,
    period_s: f64,
    noise_density: [T; 2],
    memory: Memory<T>,
    acquisition: Acquisition<T>,
    aligned: bool,
    clock: FrameClock<T, BINS, { 2 * KEPT }>,
    coherence: Coherence<T>,
    /// Wheelbase and skew that the frame under way is aligned with.
    used: [T; 2],
    /// Hops to let pass because something spoiled the frames under way.
    spoiled_hops: u32,
    learned_until_s: f64,
}

impl<T: Real> Track<T> {
    pub(super) fn new(side: usize, period_s: f64, noise_density: [T; 2]) -> Self {
        Self {
            side,
            period_s,
            noise_density,
            memory: Memory::new(period_s),
            acquisition: Acquisition::new(),
            aligned: false,
            clock: FrameClock::new(HOP_S, period_s),
            coherence: Coherence::new(),
            used: [T::zero(); 2],
            spoiled_hops: 0,
            learned_until_s: f64::NEG_INFINITY,
        }
    }

    pub(super) fn is_aligned(&self) -> bool {
        self.aligned
    }

    /// Takes an entry of the front corner.
    pub(super) fn front(&mut self, entry: &Entry<T>) {
        if entry.way_m.is_finite() {
            self.memory.push(entry);
        } else {
            self.memory.clear();
        }
    }

    /// Looks for the first delay with an entry of the rear corner.
    pub(super) fn search(&mut self, entry: &Entry<T>, road: &Meeting<'_, T>) -> Option<Found<T>> {
        if !(entry.speed_m_s > T::lit(SLOWEST_M_S)) || entry.after_gap || entry.spoiled {
            return None;
        }
        let then_s = self.memory.time_at(entry.way_m - road.wheelbase_m.to_f64() * road.scale())?;
        let rear = reconstructed(&entry.signals, &road.wheels[1], road.state);
        let delay_s = T::lit(entry.time_s - then_s);
        let (memory, skew_s) = (&self.memory, road.skew_s());
        let found = self.acquisition.push(rear, delay_s, self.period_s, |later_s| {
            let read = memory.read(then_s - (skew_s + later_s).to_f64())?;
            Some(reconstructed(&read.signals, &road.wheels[0], road.state))
        });
        self.aligned = found.is_some();
        found
    }

    /// Meets the front's road with an entry of the rear corner; gives a frame when one is complete.
    pub(super) fn meet(&mut self, entry: &Entry<T>, road: &Meeting<'_, T>) -> Option<TrackFrame<T>> {
        let pair = self.pair(entry, road);
        let Some((read, delay_s)) = pair else {
            self.clock.restart();
            self.used = [road.wheelbase, road.skew];
            return None;
        };
        if entry.spoiled || read.spoiled {
            self.spoiled_hops = 2;
        }
        // The front met the same slope at another speed.
        let ratio = entry.speed_m_s / read.speed_m_s;
        let mut signals = [T::zero(); 2 * KEPT];
        for i in 0..KEPT {
            signals[i] = ratio * read.signals[i];
            signals[KEPT + i] = entry.signals[i];
        }
        let frame = self.clock.push(&signals)?;
        let [used_wheelbase, used_skew] = self.used;
        self.used = [road.wheelbase, road.skew];
        if self.spoiled_hops > 0 {
            self.spoiled_hops -= 1;
            return None;
        }
        let middle_s = entry.time_s - self.clock.hop_s();
        Some(TrackFrame { frame, middle_s, delay_s, used_wheelbase, used_skew })
    }

    /// What the front said of the place where the rear is, and how long ago.
    fn pair(&self, entry: &Entry<T>, road: &Meeting<'_, T>) -> Option<(Read<T>, T)> {
        if entry.after_gap || !(entry.speed_m_s > T::lit(SLOWEST_M_S)) {
            return None;
        }
        let [wheelbase, skew] = self.used;
        let scale = 1.0 + wheelbase.to_f64();
        let then_s = self.memory.time_at(entry.way_m - road.wheelbase_m.to_f64() * scale)?;
        let read = self.memory.read(then_s - SKEW_UNIT_S * skew.to_f64())?;
        (read.speed_m_s > T::lit(SLOWEST_M_S)).then(|| (read, T::lit(entry.time_s - then_s)))
    }

    /// Weighs the belief with a frame; true if it was believed.
    pub(super) fn weigh(
        &mut self,
        modes: &mut Modes<T>,
        wheels: &[Wheel<T>; 2],
        taken: &TrackFrame<T>,
    ) -> bool {
        let best = modes.most_likely();
        let state = modes.modes[best].mean;
        let road_power = compare(taken, wheels, self.side, &state, &moves(best)).road_power;
        let noise = sensor_noise(wheels, self.side, &state, &self.noise_density);
        let expected = self.coherence.expect(&road_power, &noise);
        let Some((found, ratio)) = modes.weigh(taken, wheels, self.side, &expected) else { return false };
        self.coherence.learn(&expected, &found, &ratio, &noise, T::lit(HOP_S));
        self.learned_until_s = taken.middle_s;
        expected.worth.is_some() && self.coherence.near_wheel_hop() < T::lit(APART)
    }

    /// Whether the side's road is being learned from at this time, and its incoherence.
    pub(super) fn state(&self, now_s: f64) -> (bool, T) {
        let incoherence = self.coherence.near_wheel_hop();
        let fresh = now_s - self.learned_until_s < STALE_S;
        (fresh && incoherence < T::lit(APART), if fresh { incoherence } else { T::lit(f64::NAN) })
    }
}

impl<T: Real> Meeting<'_, T> {
    fn scale(&self) -> f64 {
        1.0 + self.wheelbase.to_f64()
    }

    fn skew_s(&self) -> T {
        T::lit(SKEW_UNIT_S) * self.skew
    }
}

/// The road velocity that a corner's signals tell.
fn reconstructed<T: Real>(signals: &[T; KEPT], wheel: &Wheel<T>, state: &State<T>) -> T {
    let one = T::one();
    let at = |kind: usize| one + state[kind + wheel.corner];
    let body = &wheel.body;
    let force = body.unsprung_mass_kg * at(MASS) * signals[1]
        + body.damping_n_s_per_m * at(DAMPING) * signals[2]
        + body.spring_n_per_m * at(SPRING) * signals[3];
    signals[0] + wheel.theta * at(TIRE) * force
}
