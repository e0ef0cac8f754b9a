//! Whether front and rear really share a road now, frequency by frequency, and what that is worth: how far a frame's
//! residual can be believed, and the information in it (docs/math/shared-road.md, section 5).

use nalgebra::SVector;

use crate::belief::measurement::{BINS, Expectation, Gram, Products, UpdateRecord};
use crate::cholesky;
use crate::inter_axle::NEAR_HOP_BINS;
use crate::memory::Blank;
use crate::real::Real;
use crate::spectrum::{COHERENCE_S, LASTING_S, OVERLAP};

/// Incoherence assumed before anything was seen, and the least that is believed: a millisecond between a wheel's sensor and
/// its body's, or a damper that is not quite linear, is never seen as such and leads astray for as long as it is believed.
const START: f64 = 0.2;
const LEAST: f64 = 1e-3;
/// The most that is believed.
const MOST: f64 = 2.0;
/// Largest step of a frame's estimate, as a multiple of the believed one, and more: one pothole is not another road.
const LARGEST_STEP: f64 = 30.0;
const LARGEST_MORE: f64 = 0.01;
/// Frames that what is assumed counts for.
const COUNTED: f64 = 1.5;
/// Incoherence near wheel hop at which frames count half.
const DOUBTED: f64 = 0.4;
/// Time constant in s of the road's power.
pub(crate) const POWER_S: f64 = 1.0;
/// Where frames of both sides show so many times what is believed, roads are parting, as at the beginning of a bend: frames are
/// believed too much until this is seen, so it is seen with this time constant in s. (A tire that falls is on one side.)
const PARTING: f64 = 6.0;
const PARTING_S: f64 = 0.3;
/// The most that counts of lasting incoherence: two seconds of a bend, in which nothing is shared, would else count like 2 cm beside the
/// track for good.
pub(crate) const MOST_LASTING: f64 = 0.2;

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Coherence<T: Real> {
    /// Share of the power that is not common, per bin.
    incoherence: SVector<T, BINS>,
    /// Road power per bin; zero before the first frame.
    power: SVector<T, BINS>,
    frames: u32,
    /// Whether the last frame showed roads that part.
    parting: bool,
    /// Incoherence near wheel hop that has lasted.
    lasting: T,
}

impl<T: Real> Coherence<T> {
    pub(crate) fn new() -> Self {
        Self { incoherence: SVector::repeat(T::lit(START)), ..Self::BLANK }
    }

    /// The road is another one: what it shares is seen anew.
    pub(crate) fn restart(&mut self) {
        *self = Self::new();
    }

    pub(crate) fn incoherence(&self) -> SVector<T, BINS> {
        self.incoherence
    }

    /// The other side has found this incoherence meanwhile: what makes roads part, such as a bend, mostly does so on both sides.
    pub(crate) fn follow(&mut self, other: &SVector<T, BINS>) {
        self.incoherence = self.incoherence.sup(other);
    }

    /// Road power that is usual in every bin: in a first frame that of its bins together, as a single bin's is anything
    /// between nothing and five times its mean, and what the axles disagree by is held against it.
    fn usual(&self, now: &[T; BINS]) -> [T; BINS] {
        let together = now.iter().fold(T::zero(), |sum, &power| sum + power) / T::lit(BINS as f64);
        core::array::from_fn(|bin| if self.power[bin] > T::zero() { self.power[bin] } else { together })
    }

    /// Road power to be expected, half of it the frame's own.
    fn road(&self, now: &[T; BINS]) -> [T; BINS] {
        let usual = self.usual(now);
        core::array::from_fn(|bin| T::lit(0.5) * (usual[bin] + now[bin]))
    }

    /// What to expect of a frame with this road power, given the sensors' noise in the residual, and the
    /// derivatives' products on a road of unit power.
    #[inline(never)]
    pub(crate) fn expect(
        &self,
        road_power: &[T; BINS],
        noise: &[T; BINS],
        products: &[Products<T>; BINS],
    ) -> Expectation<T> {
        let mut power = [T::zero(); BINS];
        let mut information = Gram::zeros();
        for ((bin, road), products) in self.road(road_power).into_iter().enumerate().zip(products) {
            power[bin] = self.incoherence[bin] * road + noise[bin] + T::lit(1e-12);
            let worth = T::lit(2.0 * OVERLAP) * road / power[bin];
            // In place: matrices are the largest things on the stack.
            let sums =
                information.data.0.iter_mut().enumerate().flat_map(|(i, column)| column.iter_mut().skip(i));
            for (sum, &product) in sums.zip(products.iter()) {
                *sum += product * worth;
            }
        }
        cholesky::root(&mut information);
        Expectation { power, road_power: *road_power, information_root: information }
    }

    /// Learns from a frame and what remained of it: power over what was expected, per bin. `beside`: the other side's roads
    /// seem to part.
    pub(crate) fn learn(
        &mut self,
        expected: &Expectation<T>,
        record: &UpdateRecord<T>,
        noise: &[T; BINS],
        seconds: T,
        beside: bool,
    ) {
        let UpdateRecord { road_power, power_ratio: ratio, .. } = record;
        let gain = |time_s: f64| T::one() - (-seconds / T::lit(time_s)).exp();
        self.frames = self.frames.saturating_add(1);
        let count = T::one() / T::lit(f64::from(self.frames) + COUNTED);
        let (power, usual) = (gain(POWER_S), gain(COHERENCE_S).max(count));
        let parting = gain(PARTING_S).max(count);
        self.parting = false;
        let (usual_power, road) = (self.usual(road_power), self.road(road_power));
        for (bin, &ratio) in ratio.iter().enumerate() {
            let now = road_power[bin];
            let believed = self.incoherence[bin];
            let most = believed * T::lit(LARGEST_STEP) + T::lit(LARGEST_MORE);
            let seen = ((expected.power[bin] * ratio - noise[bin]) / road[bin]).min(most);
            let parts = seen > T::lit(PARTING) * believed;
            self.parting |= parts;
            let gain = if parts && beside { parting } else { usual };
            self.incoherence[bin] = (believed + gain * (seen - believed)).clamp(T::lit(LEAST), T::lit(MOST));
            self.power[bin] = usual_power[bin] + power * (now - usual_power[bin]);
        }
        let now = self.near_wheel_hop();
        let counted = now.min(T::lit(MOST_LASTING));
        self.lasting = (self.lasting + gain(LASTING_S) * (counted - self.lasting)).min(now);
    }

    /// Whether the last frame showed roads that part.
    pub(crate) fn is_parting(&self) -> bool {
        self.parting
    }

    /// How far frames are believed: little, once front and rear hardly share a road.
    pub(crate) fn weight(&self) -> T {
        within(self.near_wheel_hop(), DOUBTED)
    }

    pub(crate) fn fading(&self) -> T {
        fading(self.near_wheel_hop())
    }

    /// Incoherence near wheel hop that has lasted: in a bend or at a kerb the axles part for seconds only.
    pub(crate) fn lasting(&self) -> T {
        self.lasting
    }

    pub(crate) fn near_wheel_hop(&self) -> T {
        let [low, high] = NEAR_HOP_BINS;
        T::lit(0.5) * (self.incoherence[low] + self.incoherence[high])
    }
}

/// How fast a belief fades at an incoherence: what the model leaves out differs from road to road and grows with what the axles
/// do not share, but leads astray only as far as frames are believed.
pub(crate) fn fading<T: Real>(incoherence: T) -> T {
    incoherence * within(incoherence, DOUBTED)
}

/// From 1 to 0 as an incoherence exceeds another one, where it is a half.
pub(crate) fn within<T: Real>(incoherence: T, half: f64) -> T {
    let ratio = incoherence / T::lit(half);
    T::one() / (T::one() + ratio * ratio)
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::belief::measurement::Products;
    use crate::belief::state::SIDE_SIZE;
    use crate::cholesky::packed;

    /// Frames of `seconds` on a road of unit power of which this share is not common; gives what of it counts as lasting.
    fn drive(coherence: &mut Coherence<f64>, seconds: f64, share: f64) -> f64 {
        drive_beside(coherence, seconds, share, true)
    }

    /// The same, the other side's roads parting or not.
    fn drive_beside(coherence: &mut Coherence<f64>, seconds: f64, share: f64, beside: bool) -> f64 {
        for _ in 0..(10.0 * seconds) as u32 {
            let expected =
                Expectation { power: [1.0; BINS], road_power: [1.0; BINS], information_root: Gram::zeros() };
            let record = UpdateRecord { road_power: [1.0; BINS], power_ratio: [share; BINS], weight: 1.0 };
            coherence.learn(&expected, &record, &[0.0; BINS], 0.1, beside);
        }
        coherence.lasting()
    }

    #[test]
    fn roads_that_part_are_seen_at_once_and_a_pothole_is_none() {
        let mut coherence = Coherence::new();
        drive(&mut coherence, 60.0, 0.002);
        let before = coherence.near_wheel_hop();
        assert!(before < 0.0021, "{before}");
        let mut pothole = coherence.clone();
        drive(&mut pothole, 0.1, 1.0);
        // A step of 1 - exp(-0.1 s/0.3 s) towards thirty times as much and a hundredth.
        let closed_form = before + (1.0 - (-1.0 / 3.0_f64).exp()) * (29.0 * before + 0.01);
        assert!((pothole.near_wheel_hop() - closed_form).abs() < 1e-12);
        assert!(pothole.weight() > 0.99);
        // A change on one side is a tire that falls, or one wheel's hole: seen with the usual 2 s.
        let mut one_side = coherence.clone();
        drive_beside(&mut one_side, 0.1, 1.0, false);
        let closed_form = before + (1.0 - (-0.05_f64).exp()) * (29.0 * before + 0.01);
        assert!(one_side.is_parting() && (one_side.near_wheel_hop() - closed_form).abs() < 1e-12);
        // A bend, roads that have nothing in common: a sixth of that is seen in half a second, and within a second frames count
        // less than half. With the usual 2 s, and a quarter more from frame to frame at most, it would have been 2.4 s.
        drive(&mut coherence, 0.5, 1.0);
        assert!(coherence.near_wheel_hop() > 1.0 / PARTING, "{}", coherence.near_wheel_hop());
        drive(&mut coherence, 0.5, 1.0);
        assert!(coherence.weight() < 0.5, "{}", coherence.near_wheel_hop());
    }

    #[test]
    fn a_first_frame_that_hardly_hears_a_frequency_is_not_believed_more_there() {
        let mut road = [1.0; BINS];
        road[1] = 1e-6;
        let mut products = Products::zeros();
        (0..SIDE_SIZE).for_each(|i| products[packed::<SIDE_SIZE>(i, i)] = 1.0);
        let expected = Coherence::<f64>::new().expect(&road, &[0.0; BINS], &[products; BINS]);
        // Half the mean of all five, of which a fifth need not be common: not a millionth of what the others have.
        assert!((expected.power[1] - START * 0.5 * 0.8).abs() < 1e-6, "{}", expected.power[1]);
        assert!((expected.power[0] - START * 0.5 * 1.8).abs() < 1e-6, "{}", expected.power[0]);
    }

    #[test]
    fn a_side_that_was_silent_shares_no_more_than_the_other_one_found() {
        let (mut silent, mut other) = (Coherence::new(), Coherence::new());
        drive(&mut silent, 60.0, 0.02);
        drive(&mut other, 60.0, 0.02);
        drive(&mut other, 1.5, 1.0);
        let mut informed = silent.clone();
        informed.follow(&other.incoherence());
        assert_eq!(informed.near_wheel_hop(), other.near_wheel_hop());
        assert!(silent.weight() > 0.99 && informed.weight() < 0.5, "{}", informed.weight());
        // What it has found worse by itself stays.
        let lasting = other.lasting();
        other.follow(&silent.incoherence());
        assert!(other.near_wheel_hop() == informed.near_wheel_hop() && other.lasting() == lasting);
    }

    #[test]
    fn what_is_not_believed_does_not_make_beliefs_fade() {
        let mut coherence = Coherence::new();
        // Half the incoherence at which frames count half: 0.8 of it. Where nothing is shared, less than at either.
        drive(&mut coherence, 60.0, 0.2);
        assert!((coherence.fading() - 0.16).abs() < 2e-3, "{}", coherence.fading());
        drive(&mut coherence, 60.0, 2.0);
        assert!((coherence.fading() - 2.0 / 26.0).abs() < 2e-3, "{}", coherence.fading());
    }

    #[test]
    fn incoherence_lasts_only_after_a_while_and_ends_at_once() {
        let mut coherence = Coherence::new();
        assert!(drive(&mut coherence, 60.0, 0.002) < 0.01);
        // A bend: nearly all of the road is another one, for some seconds; it is seen at once, and lasts with 20 s, as far as it
        // counts: on the way from 0.002 to 0.2 at most.
        let bend = drive(&mut coherence, 4.0, 0.9);
        assert!(coherence.near_wheel_hop() > 0.5 && bend > 0.02, "{bend}");
        assert!(bend < 0.2 - 0.198 * (-4.0_f64 / 20.0).exp() + 1e-9, "{bend}");
        assert!(drive(&mut coherence, 20.0, 0.002) < 0.01);
        // Beside the track for good.
        let residual = drive(&mut coherence, 20.0, 0.15);
        let closed_form = 0.15 * (1.0 - 20.0 / 18.0 * (-1.0_f64).exp());
        assert!((residual - closed_form).abs() < 0.01, "{residual}, expected {closed_form}");
    }
}
