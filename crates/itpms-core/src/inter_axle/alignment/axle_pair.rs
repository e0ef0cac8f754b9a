//! One side of the car: what the front met, read again where the rear is now, and cut into frames of both. What such a frame is worth to
//! the belief stands in `measure`.

mod measure;

use nalgebra::{Complex, SVector};

use crate::belief::measurement::{BINS, SideMeasurement};
use crate::belief::state::{GAIN, SKEW_UNIT_S, State};
use crate::conditioning::STANDING_M_S;
use crate::conditioning::pauses::{MISSING_S, PAUSE_S};
use crate::inter_axle::alignment::channel::{BOTH, Entry, FRONT, JERK, KEPT, RELATIVE, SEEN};
use crate::inter_axle::alignment::delay_line::{DelayLine, Read};
use crate::inter_axle::alignment::delay_search::{AT_FIRST, DelaySearch, Found, LATER};
use crate::inter_axle::alignment::opposite_side::{OppositeSide, of_other_side, with_other};
use crate::inter_axle::alignment::way::Way;
use crate::inter_axle::residual::correction::FrfCorrection;
use crate::inter_axle::residual::expected_products::ExpectedProducts;
use crate::inter_axle::residual::hop_excess::HopExcess;
use crate::inter_axle::residual::imbalance::Imbalance;
use crate::inter_axle::residual::instrument::{Instrument, of_both_wheels};
use crate::inter_axle::residual::model::{Axle, AxleFrame, Mode, Wheel};
use crate::inter_axle::residual::noise::{Coherence, MOST_LASTING};
use crate::inter_axle::{HOP_S, SIGNALS};
use crate::memory::{Blank, Placed};
use crate::model::{Side, TrackState};
use crate::real::Real;
use crate::spectrum::FrameClock;

pub(crate) use self::measure::PRODUCT_PARTS;

/// Hops after a restart until the instruments have forgotten that they began at rest.
const SETTLING_HOPS: u32 = 5;
/// Longest distance in m between two entries that follow each other.
const LONGEST_WAY_M: f64 = 1.0;
/// Share of a frame in which both wheels touch the road, from which on it counts.
const LEAST_SEEN: f64 = 0.15;
/// Incoherence near wheel hop from which on a side counts as not shared.
const NOT_SHARED: f64 = 0.5;
/// And from which on it is looked whether the axles meet at another delay.
const REALIGN_ABOVE: f64 = 0.04;

/// A frame's measurement for the belief, and what the pair keeps of it.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Measured<T: Real> {
    pub(crate) measurement: SideMeasurement<T>,
    common: [Complex<T>; BINS],
    /// Sensor noise in the residual, per bin.
    noise: [T; BINS],
}

/// A correction and the time it was saved at.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct SavedCorrection<T: Real> {
    time_s: f64,
    frf_correction: FrfCorrection<T>,
}

/// The belief about the car where the two axles meet.
pub(crate) struct PairingContext<'a, T: Real> {
    pub(crate) wheelbase_m: T,
    pub(crate) wheels: [Wheel<T>; 2],
    pub(crate) wheelbase: T,
    pub(crate) skew: T,
    pub(crate) state: &'a State<T>,
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct AxlePair<T: Real> {
    side: Side,
    period_s: T,
    noise_density: [T; 2],
    delay_line: DelayLine<T>,
    delay_search: DelaySearch<T>,
    aligned: bool,
    clock: FrameClock<T, BINS, SIGNALS>,
    /// Of the front, and of the rear's wheels as they move together and against each other.
    instruments: [Instrument<T>; 3],
    /// What the newest common road makes of the latter two.
    rear_modes: [[T; KEPT]; 2],
    frf_correction: FrfCorrection<T>,
    /// As it was at the belief's checkpoints, the newest first.
    saved: [Placed<SavedCorrection<T>>; 2],
    imbalance: Imbalance<T>,
    /// Where the rear wheel was at its last entry.
    way: Option<Way>,
    coherence: Coherence<T>,
    products: ExpectedProducts<T>,
    /// Whether the road under front and rear is one line.
    on_line: [bool; 2],
    hop_excess: HopExcess<T>,
    /// Logarithm of the power near wheel hop over that of the sensors' noise, of late; `None` before the first frame.
    log_snr: Option<T>,
    /// Wheelbase and skew that the frame under way is aligned with, once there is one.
    used: Option<[T; 2]>,
    /// Hops to let pass because something was wrong with the frames under way.
    invalid_hops: u32,
    learned_until_s: f64,
    /// Pseudo-measurements of both corners' spectra since the last frame.
    spectral_updates: u32,
}

impl<T: Real> AxlePair<T> {
    pub(crate) fn configure(&mut self, side: Side, period_s: f64, noise_density: [T; 2]) {
        (self.side, self.period_s, self.noise_density) = (side, T::lit(period_s), noise_density);
        self.delay_line.configure(period_s);
        self.delay_search = DelaySearch::new(AT_FIRST);
        self.aligned = false;
        self.clock.configure(HOP_S, period_s);
        self.instruments = [Instrument::new(), Instrument::new(), Instrument::new()];
        self.frf_correction = FrfCorrection::BLANK;
        self.saved.iter_mut().for_each(Placed::clear);
        self.imbalance = Imbalance::BLANK;
        self.way = None;
        self.coherence = Coherence::new();
        self.products.restart();
        self.on_line = [false; 2];
        self.hop_excess = HopExcess::BLANK;
        (self.log_snr, self.used) = (None, None);
        (self.invalid_hops, self.spectral_updates) = (0, 0);
        self.learned_until_s = f64::NEG_INFINITY;
    }

    pub(crate) fn is_aligned(&self) -> bool {
        self.aligned
    }

    /// Takes over whether the road under the front or the rear is one line.
    pub(crate) fn set_on_line(&mut self, axle: usize, on_line: bool) {
        if let Some(place) = self.on_line.get_mut(axle) {
            *place = on_line;
        }
    }

    /// Takes an entry of the front corner.
    pub(crate) fn front(&mut self, entry: &Entry<T>) {
        match entry.way {
            Some(way) => self.delay_line.push(entry, way),
            None => self.delay_line.clear(),
        }
    }

    /// Looks for the first delay with an entry of the rear corner.
    pub(crate) fn search(&mut self, entry: &Entry<T>, road: &PairingContext<'_, T>) -> Option<Found<T>> {
        let found = self.look_for_delay(entry, road)?;
        self.aligned = true;
        self.delay_search = DelaySearch::new(LATER);
        Some(found)
    }

    /// Looks for it anew, as long as front and rear are less alike than on a road they share: in a bend, beside each other's
    /// track, or as the speed is no longer what it was.
    pub(crate) fn search_again(
        &mut self,
        entry: &Entry<T>,
        road: &PairingContext<'_, T>,
    ) -> Option<Found<T>> {
        // A line is alike at every delay that differs by a wave.
        if self.on_line.contains(&true) || !(self.incoherence() > T::lit(REALIGN_ABOVE)) {
            self.delay_search.restart();
            return None;
        }
        self.look_for_delay(entry, road)
    }

    #[inline(never)]
    fn look_for_delay(&mut self, entry: &Entry<T>, road: &PairingContext<'_, T>) -> Option<Found<T>> {
        if !(entry.speed_m_s > T::lit(STANDING_M_S)) || entry.after_gap || entry.invalid || entry.unloaded {
            return None;
        }
        let [wheelbase, skew] = self.delay_search.count_from([road.wheelbase, road.skew]);
        let delay_line = &self.delay_line;
        let steps = delay_line.steps_back_at(entry.way?.ahead(-road.length_m(wheelbase)))?;
        let axles = road.axles();
        let rear = axles[1].road_velocity(&with_other(entry.signals, None, None));
        let delay_s = self.delay_s(entry, steps);
        let skew_s = T::lit(SKEW_UNIT_S) * skew;
        let stretch =
            delay_line.read_back(steps).map_or(T::zero(), |read| (entry.speed_m_s / read.speed_m_s).ln());
        self.delay_search.push(rear, [delay_s, stretch], self.period_s.to_f64(), |later_s| {
            let read = delay_line.read_back(steps + (skew_s + later_s) * delay_line.rate_hz())?;
            Some(axles[0].road_velocity(&with_other(read.signals, None, None)))
        })
    }

    /// Ways are counted otherwise from here on: those of before do not go with them.
    pub(crate) fn forget_ways(&mut self) {
        self.delay_line.clear();
        self.restart_alignment();
    }

    /// The axles meet at another delay than they were thought to: what they share is seen anew.
    pub(crate) fn restart_alignment(&mut self) {
        self.used = None;
        self.coherence.restart();
        self.delay_search.restart();
    }

    /// Meets the front's road with an entry of the rear corner; gives `enqueue` a frame when one is complete: returned, it would be moved
    /// about with every entry. The other side is asked for how its suspension moved: `beside` at the rear.
    #[inline(never)]
    pub(crate) fn pair(
        &mut self,
        entry: &Entry<T>,
        beside: OppositeSide<T>,
        other: &Self,
        road: &PairingContext<'_, T>,
        enqueue: impl FnOnce(AxleFrame<T>),
    ) {
        let front = self.read_front(entry, road);
        let Some((read, steps, delay_s)) = front else {
            self.clock.restart();
            self.instruments.iter_mut().for_each(Instrument::restart);
            self.rear_modes = [[T::zero(); KEPT]; 2];
            self.tune(road);
            // The first frames count all the same: while nothing is known yet, they bring more than they can spoil.
            self.invalid_hops = if self.used.is_some() { SETTLING_HOPS } else { 0 };
            self.used = Some([road.wheelbase, road.skew]);
            return;
        };
        if entry.invalid || read.invalid {
            self.invalid_hops = self.invalid_hops.max(2);
        }
        // The front met the same slope at another speed.
        let ratio = entry.speed_m_s / read.speed_m_s;
        let steps = steps + other.delay_line.steps_back(self.delay_line.newest_s());
        let at_front = other.delay_line.read_back(steps).map(|read| read.signals[RELATIVE]);
        let others = of_other_side(at_front, beside, ratio);
        let jerk_beside = match beside {
            OppositeSide::Known([_, jerk]) => Some(jerk),
            OppositeSide::Missed | OppositeSide::Silent => None,
        };
        let ahead = with_other(read.signals, others[0], None).map(|signal| ratio * signal);
        let mut both = of_both(&ahead, &with_other(entry.signals, others[1], jerk_beside));
        self.clear(&mut both, entry, road);
        let [ahead, behind] = road.velocities(&both, self.side);
        let common = T::lit(0.5) * (ahead + behind);
        let mut signals = [T::zero(); SIGNALS];
        signals[..BOTH].copy_from_slice(&both);
        let [front, rear_modes @ ..] = self.instruments.each_mut().map(|instrument| instrument.push(common));
        self.rear_modes = rear_modes;
        let [rear, beside] = of_both_wheels(&self.rear_modes);
        // The other side's jerk as the roads make it, and not as measured: that moves with what of the rear's road is this side's own.
        let [other_rear, _] = of_both_wheels(&other.rear_modes);
        let front = with_other(front, others[0].map(|other| ratio * other), None);
        let rear = with_other(rear, others[1], jerk_beside.map(|_| beside[JERK] + other_rear[JERK]));
        signals[BOTH..].copy_from_slice(&of_both(&front, &rear));
        if let Some(frame) = self.clock.push_if(!(entry.unloaded || read.unloaded), &signals) {
            self.tune(road);
            let used = self.used.replace([road.wheelbase, road.skew]);
            if self.invalid_hops > 0 {
                self.invalid_hops -= 1;
            } else if let (Some([used_wheelbase, used_skew]), true) = (used, frame.seen > T::lit(LEAST_SEEN))
            {
                let middle_s = entry.time_s - self.clock.hop_s();
                enqueue(AxleFrame { frame, middle_s, delay_s, used_wheelbase, used_skew });
            }
        }
    }

    /// Takes off what the wheels' imbalance makes of both axles' signals.
    fn clear(&mut self, both: &mut [T; BOTH], entry: &Entry<T>, road: &PairingContext<'_, T>) {
        let (Some(way), Some(before)) = (entry.way, core::mem::replace(&mut self.way, entry.way)) else {
            return;
        };
        let distance_m = way.beyond(before);
        if distance_m >= T::zero() && distance_m < T::lit(LONGEST_WAY_M) {
            let [ahead, behind] = road.velocities(both, self.side);
            self.imbalance.look(ahead - behind, distance_m, entry.speed_m_s);
            self.imbalance.clear(both, distance_m, entry.speed_m_s);
        }
    }

    /// Brings the instruments up to date with what is believed.
    fn tune(&mut self, road: &PairingContext<'_, T>) {
        let [front, together, against] = &mut self.instruments;
        let ([ahead, behind], [front_body, rear_body]) = (road.axles(), road.wheels.map(|wheel| wheel.body));
        front.tune(&ahead, Mode::Together, front_body.sprung_mass_kg, self.period_s);
        together.tune(&behind, Mode::Together, rear_body.sprung_mass_kg, self.period_s);
        against.tune(&behind, Mode::Against, rear_body.sprung_mass_kg, self.period_s);
    }

    /// What the front reported of the place where the rear is, how many steps before its newest entry, and how long ago.
    fn read_front(&self, entry: &Entry<T>, road: &PairingContext<'_, T>) -> Option<(Read<T>, T, T)> {
        if entry.after_gap || !(entry.speed_m_s > T::lit(STANDING_M_S)) {
            return None;
        }
        let [wheelbase, skew] = self.used?;
        let there = self.delay_line.steps_back_at(entry.way?.ahead(-road.length_m(wheelbase)))?;
        let steps = there + T::lit(SKEW_UNIT_S) * self.delay_line.rate_hz() * skew;
        let read = self.delay_line.read_back(steps)?;
        (read.speed_m_s > T::lit(STANDING_M_S)).then(|| (read, steps, self.delay_s(entry, there)))
    }

    /// Seconds from so many steps before the front's newest entry to an entry of the rear.
    fn delay_s(&self, entry: &Entry<T>, steps: T) -> T {
        T::lit(entry.time_s - self.delay_line.newest_s()) + steps * self.period_s
    }

    /// The other side's incoherence in every bin, if there were frames of it while this side had none before a time in s.
    pub(crate) fn found_meanwhile(&self, other: &Self, time_s: f64) -> Option<SVector<T, BINS>> {
        let missed = other.learned_until_s - self.learned_until_s > MISSING_S;
        (missed && time_s - other.learned_until_s < MISSING_S).then(|| other.coherence.incoherence())
    }

    /// Saves the correction together with the belief's checkpoint of this time.
    pub(crate) fn checkpoint(&mut self, time_s: f64) {
        // The older one's place is the new one's.
        self.saved.swap(0, 1);
        let [newest, _] = &mut self.saved;
        newest.place(|saved| {
            saved.time_s = time_s;
            saved.frf_correction.clone_from(&self.frf_correction);
        });
    }

    /// Restores the correction that was saved at this time.
    pub(crate) fn restore(&mut self, time_s: f64) {
        if let Some(saved) = self.saved.iter().flatten().find(|saved| saved.time_s == time_s) {
            self.frf_correction.clone_from(&saved.frf_correction);
        }
    }

    /// Whether the last frame showed roads that part.
    pub(crate) fn is_parting(&self) -> bool {
        self.coherence.is_parting()
    }

    /// How much more front and rear disagree near wheel hop than beside it, once enough was seen.
    pub(crate) fn hop_excess(&self) -> Option<T> {
        self.hop_excess.value()
    }

    /// How far the wheels' answers to the shared road are from the quarter car's, once enough was seen.
    pub(crate) fn response_error(&self) -> Option<T> {
        self.frf_correction.response_error()
    }

    pub(crate) fn incoherence(&self) -> T {
        self.coherence.near_wheel_hop()
    }

    /// The same as far as it has lasted; the most there is, where the side is left to pseudo-measurements.
    pub(crate) fn lasting_incoherence(&self) -> T {
        if self.spectral_only() { T::lit(MOST_LASTING) } else { self.coherence.lasting() }
    }

    /// Whether the side's road is being learned from at this time, and its incoherence.
    pub(crate) fn track(&self, now_s: f64) -> TrackState<T> {
        let incoherence = self.coherence.near_wheel_hop();
        let fresh = now_s - self.learned_until_s < PAUSE_S;
        let shared = fresh && incoherence < T::lit(NOT_SHARED);
        TrackState { shared, incoherence: if fresh { incoherence } else { T::lit(f64::NAN) } }
    }
}

impl<T: Real> PairingContext<'_, T> {
    /// Distance in m from the rear wheel to the front one, with this relative deviation of wheelbase over speed.
    fn length_m(&self, wheelbase: T) -> T {
        self.wheelbase_m * (T::one() + wheelbase)
    }

    fn axles(&self) -> [Axle<T>; 2] {
        [Axle::new(&self.wheels[0], self.state), Axle::new(&self.wheels[1], self.state)]
    }

    /// Road velocities that both axles' signals tell, the front's times its gain.
    fn velocities(&self, both: &[T; BOTH], side: Side) -> [T; 2] {
        let axles = self.axles();
        let (front, rear) = both.split_at(FRONT);
        let gain = T::one() + self.state[GAIN + side.index()];
        [gain * axles[0].road_velocity(front), axles[1].road_velocity(rear)]
    }
}

/// The signals of both axles, in their places.
fn of_both<T: Real>(front: &[T; SEEN], rear: &[T; SEEN]) -> [T; BOTH] {
    core::array::from_fn(|at| match at.checked_sub(FRONT) {
        Some(at) => rear.get(at).copied().unwrap_or(T::zero()),
        None => front.get(at).copied().unwrap_or(T::zero()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::configured;

    #[test]
    fn the_other_side_counts_where_it_had_frames_and_this_one_had_none() {
        let track = |learned_until_s: f64| {
            configured(|pair: &mut AxlePair<f64>| {
                pair.configure(Side::Left, 0.01, [0.0; 2]);
                pair.learned_until_s = learned_until_s;
            })
        };
        let counts = |own_s: f64, other_s: f64| track(own_s).found_meanwhile(&track(other_s), 10.0).is_some();
        assert!(counts(8.7, 9.9) && counts(f64::NEG_INFINITY, 9.9));
        // It has just had frames itself; both were silent; the other one longer.
        assert!(!counts(9.8, 9.9) && !counts(3.0, 4.0) && !counts(9.8, 8.0));
        assert!(!counts(f64::NEG_INFINITY, f64::NEG_INFINITY));
    }
}
