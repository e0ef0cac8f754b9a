//! The belief about the car: a mixture of eight Gaussians, one for every way in which pressures may be changing now
//! (docs/math/shared-road.md, section 6). Predicted over time; weighed by the residual of front and rear and by
//! pseudo-measurements of the corners' spectra.

use super::floor::Floor;
use super::gaussian::{Circumstances, Hypothesis, Wandering};
use super::hypotheses::{
    CONSTANT, HYPOTHESES, Hypotheses, RANDOM_WALK, SIDE, both, changing, has_rate, single,
};
use super::instruments::Instruments;
use super::measurement::{AxleResidual, SideMeasurement, UpdateRecord};
use super::state::{
    IN_COMMON, MASS, RATE, SIZE, SPECTRUM_BIAS_SD, SPECTRUM_BIASES, SideReading, State, TIRE,
};
use super::tires::Tires;
use super::transition::{NOTICED, Transition};
use super::update::{Lesson, Likelihood, own_covariance, score};
use crate::memory::{Blank, Placed};
use crate::model::{Corner, Learned, Side};
use crate::real::{Real, SMALLEST};

/// Log-likelihood of a hypothesis that cannot say how likely a frame is.
const IMPOSSIBLE: f64 = -1e6;
/// Growth of a compliance's sd per square root of a second of incoherence, as far as it is believed: as long as the car is known
/// from its file only, and once a calibration has taught what it is.
const FADING: f64 = 0.03;
const FADING_TAUGHT: f64 = 0.01;
/// Below this weight hypotheses of several wheels are updated every third frame only; below [`NOTICED`] those of the opposite side,
/// of which a frame shows hardly anything. An odd number of frames, as the sides take turns.
const RARE: f64 = 1e-5;
const RARE_FRAMES: usize = 3;
/// Chance that a tire was filled or let down during a stop, and the sd of its compliance then.
const FILLED: f64 = 1e-3;
const FILLED_SD: f64 = 0.15;
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct HypothesisBank<T: Real> {
    pub(super) hypotheses: Hypotheses<T>,
    /// What is under way between the parts of a prediction, and between those of an update.
    pub(super) transition: Transition<T>,
    pub(super) circumstances: Circumstances<T>,
    update: FrameUpdate<T>,
    instruments: Instruments<T>,
    /// Whether anything of the hypotheses has changed since what is believed of the tires was last asked for.
    has_changed: bool,
}

/// How likely a frame was by the hypotheses that were updated with it.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct FrameUpdate<T: Real> {
    log_weight: [T; HYPOTHESES],
    /// Of the most likely one, before the frame.
    record: Placed<UpdateRecord<T>>,
    /// What the frame teaches the one that it was compared with last.
    lesson: Placed<Lesson<T>>,
    best: usize,
    frames: u32,
}

impl<T: Real> FrameUpdate<T> {
    /// Whether a hypothesis of this weight is updated with a side's frame: never at weight zero; hypotheses of low weight in which
    /// several wheels change, or one of the other side, every third time.
    fn follows(&self, index: usize, weight: T, side: Side) -> bool {
        let always_from = match single(index) {
            Some(wheel) if wheel.side() != side => NOTICED,
            None if index >= SIDE => RARE,
            _ => 0.0,
        };
        let turn = (self.frames as usize + index).is_multiple_of(RARE_FRAMES);
        weight > T::zero() && (turn || !(weight < T::lit(always_from)))
    }
}

impl<T: Real> HypothesisBank<T> {
    /// What is believed at the start, the tires' compliances around `tires`.
    pub(super) fn start(&mut self, tires: &[T; 4]) {
        self.transition.clear();
        self.update = FrameUpdate::BLANK;
        self.instruments.restart();
        let [constant, others @ ..] = &mut self.hypotheses;
        constant.start(tires, &self.circumstances.mass_sd);
        for (index, hypothesis) in (1..).zip(others) {
            constant.part().with_onset(has_rate(index)).write(constant.weight, hypothesis);
        }
        self.collapse();
    }

    /// Unsprung masses may be this far from the vehicle file's from now on.
    pub(super) fn free_masses(&mut self, mass_sd: &[T; 4]) {
        self.has_changed = true;
        for (i, (held, &free)) in self.circumstances.mass_sd.iter_mut().zip(mass_sd).enumerate() {
            for hypothesis in &mut self.hypotheses {
                hypothesis.covariance[(MASS + i, MASS + i)] += (free * free - *held * *held).max(T::zero());
            }
            *held = free;
        }
    }

    /// Begins to move on by `seconds`; see [`Transition::begin`].
    pub(super) fn begin_prediction(&mut self, seconds: T, may: [bool; 3], onset_rates: &[T; 4]) {
        self.transition.begin(seconds, may, onset_rates);
    }

    pub(super) fn predict_part(&mut self, part: usize) {
        self.has_changed = true;
        self.transition.apply(part, &mut self.hypotheses, &self.circumstances);
    }

    /// Nothing is left to be done of a prediction.
    pub(super) fn end_prediction(&mut self) {
        self.transition.end();
    }

    /// All tires may have become warmer or colder together: their compliances have so much more sd in common.
    pub(super) fn change_temperature(&mut self, sd: &[T; 4]) {
        self.has_changed = true;
        self.hypotheses.iter_mut().for_each(|hypothesis| hypothesis.change_alike(sd));
    }

    /// Predicts over `seconds` without samples, after which no pressure is changing. `filled`: one may have been changed by hand.
    pub(super) fn predict_gap(&mut self, seconds: T, filled: bool) {
        self.collapse();
        let [constant, .., loose] = &mut self.hypotheses;
        constant.wander(&Wandering::over(seconds, &self.circumstances));
        if filled {
            let chance = T::lit(FILLED);
            loose.take_over(constant);
            for i in TIRE..TIRE + 4 {
                loose.covariance[(i, i)] += T::lit(FILLED_SD * FILLED_SD);
            }
            loose.weight = chance;
            constant.weight = T::one() - chance;
        }
    }

    /// Begins to update with a frame of a side that counts `weight`.
    pub(super) fn begin_update(&mut self, side: Side, weight: T) {
        self.instruments.learn(side, weight, &mut self.hypotheses);
        self.update.best = self.most_likely();
        self.update.record.clear();
        self.update.lesson.clear();
        self.update.frames = self.update.frames.wrapping_add(1);
    }

    /// How likely a frame of one side is by a hypothesis, and what it teaches that, which `linearize` linearizes at a state; false if it is
    /// left out for its low weight ([`FrameUpdate::follows`]).
    pub(super) fn compare(
        &mut self,
        index: usize,
        measurement: &SideMeasurement<T>,
        linearize: impl Fn(&State<T>) -> AxleResidual<T>,
    ) -> bool {
        let reading = &measurement.reading;
        let weight = self.hypotheses.get(index).map_or(T::ZERO, |hypothesis| hypothesis.weight);
        if !self.update.follows(index, weight, reading.side) {
            let usual = self.update.log_weight[CONSTANT];
            self.update.log_weight.get_mut(index).into_iter().for_each(|log_weight| *log_weight = usual);
            return false;
        }
        self.compare_followed(index, measurement, linearize);
        true
    }

    #[inline(never)]
    fn compare_followed(
        &mut self,
        index: usize,
        measurement: &SideMeasurement<T>,
        linearize: impl Fn(&State<T>) -> AxleResidual<T>,
    ) -> Option<()> {
        let SideMeasurement { reading, expected, instrument, weight, .. } = measurement;
        let FrameUpdate { log_weight, record, lesson, best, .. } = &mut self.update;
        let (hypothesis, log_weight) = self.hypotheses.get(index).zip(log_weight.get_mut(index))?;
        *log_weight = T::lit(IMPOSSIBLE);
        let prefit = linearize(&hypothesis.mean);
        let own = own_covariance(&hypothesis.covariance, reading);
        let likelihood = Likelihood::new(&own, &prefit, instrument, expected)?;
        *log_weight = *weight * likelihood.log;
        let score = score(&prefit, instrument, expected);
        let learn = |lesson: &mut Lesson<T>| {
            lesson.learn(&own, &score, &expected.information_root, &likelihood, *weight).ok_or(())
        };
        if index == *best {
            record.place(|record| {
                (record.road_power, record.power_ratio) = (prefit.road_power, likelihood.power_ratio());
                record.weight = *weight;
            });
        }
        lesson.try_place(learn).ok()
    }

    /// Teaches a hypothesis what it was compared with last; false if that taught nothing. A sample of its own: with the comparison it would
    /// be the dearest.
    pub(super) fn teach(&mut self, index: usize, reading: &SideReading<T>) -> bool {
        let lesson = self.update.lesson.as_ref().zip(self.hypotheses.get_mut(index));
        let teaches = lesson.map(|(lesson, hypothesis)| lesson.teach(hypothesis, reading)).is_some();
        self.update.lesson.clear();
        teaches
    }

    /// With all of them updated, weighs them; gives the record of the one that was the most likely before.
    pub(super) fn finish_update(&mut self) -> Option<&UpdateRecord<T>> {
        let log_weight = self.update.log_weight;
        self.reweigh(&log_weight);
        self.update.record.as_ref()
    }

    /// A measured number with its variance: `linearize` gives, for a state, its derivatives and how much more it is than
    /// expected. The hypotheses' weights stay as they are.
    pub(super) fn update(&mut self, variance: T, linearize: impl Fn(&State<T>) -> (State<T>, T)) {
        self.has_changed = true;
        // A hypothesis of weight zero begins anew with the next prediction.
        for hypothesis in self.hypotheses.iter_mut().filter(|hypothesis| hypothesis.weight > T::zero()) {
            let (slope, innovation) = linearize(&hypothesis.mean);
            hypothesis.update(&slope, innovation, variance);
        }
    }

    /// The same of a number of a side that also weighs the hypotheses; those of low weight are skipped as for frames.
    pub(super) fn update_reweighted(
        &mut self,
        side: Side,
        variance: T,
        linearize: impl Fn(&State<T>) -> (State<T>, T),
    ) {
        let mut log_weight = [T::zero(); HYPOTHESES];
        self.update.frames = self.update.frames.wrapping_add(1);
        let mut usual = T::zero();
        for ((index, hypothesis), log) in self.hypotheses.iter_mut().enumerate().zip(&mut log_weight) {
            if !self.update.follows(index, hypothesis.weight, side) {
                *log = usual;
                continue;
            }
            let (slope, innovation) = linearize(&hypothesis.mean);
            let total = hypothesis.update(&slope, innovation, variance);
            *log = T::lit(-0.5) * (total.ln_fast() + innovation * innovation / total);
            if index == CONSTANT {
                usual = *log;
            }
        }
        self.reweigh(&log_weight);
    }

    fn reweigh(&mut self, log_weight: &[T; HYPOTHESES]) {
        self.has_changed = true;
        let mut largest = T::lit(f64::NEG_INFINITY);
        for (hypothesis, &log) in self.hypotheses.iter().zip(log_weight) {
            if hypothesis.weight > T::zero() {
                largest = largest.max(log);
            }
        }
        let mut total = T::zero();
        for (hypothesis, &log) in self.hypotheses.iter_mut().zip(log_weight) {
            hypothesis.weight *= (log - largest).exp_fast();
            total += hypothesis.weight;
        }
        // The others are weighed against it while they are not followed.
        let constant = &mut self.hypotheses[CONSTANT].weight;
        *constant = constant.max(T::lit(SMALLEST));
        if total > T::zero() && total.is_finite() {
            self.hypotheses.iter_mut().for_each(|hypothesis| hypothesis.weight /= total);
        }
    }

    pub(super) fn best(&self) -> &Hypothesis<T> {
        &self.hypotheses[self.most_likely()]
    }

    fn most_likely(&self) -> usize {
        (1..HYPOTHESES).fold(CONSTANT, |best, i| {
            if self.hypotheses[i].weight > self.hypotheses[best].weight { i } else { best }
        })
    }

    /// The belief about a tire fades with seconds of incoherence; less so if a calibration has `taught` what the car is.
    pub(super) fn inflate(&mut self, corner: Corner, incoherent_s: T, calibrated: bool) {
        self.has_changed = true;
        if self.circumstances.tires_set {
            return;
        }
        let sd = if calibrated { FADING_TAUGHT } else { FADING };
        let at = TIRE + corner.index();
        for hypothesis in &mut self.hypotheses {
            hypothesis.covariance[(at, at)] += T::lit(sd * sd) * incoherent_s;
        }
    }

    /// Mean and sd of every quantity while nothing moves.
    pub(super) fn constant(&self) -> (State<T>, State<T>) {
        let hypothesis = &self.hypotheses[CONSTANT];
        (hypothesis.mean, hypothesis.covariance.variances().map(|variance| variance.max(T::zero()).sqrt()))
    }

    /// Begins with a quantity as it was learned before, its sd at least `least`; `unit` is the state's in that quantity.
    pub(super) fn set_quantity(&mut self, at: usize, learned: &Learned<T>, least: T, unit: T) {
        self.has_changed = true;
        let (at, sd) = (at.min(SIZE - 1), learned.sd.max(least) / unit);
        for hypothesis in &mut self.hypotheses {
            hypothesis.mean[at] = learned.value / unit;
            hypothesis.covariance.isolate(at, sd * sd);
        }
    }

    /// What the spectra of all corners read too much alike is another thing, and as unknown as at first.
    pub(super) fn free_common_bias(&mut self) {
        let common = T::lit(IN_COMMON * SPECTRUM_BIAS_SD * SPECTRUM_BIAS_SD);
        for hypothesis in &mut self.hypotheses {
            SPECTRUM_BIASES.for_each(|i| hypothesis.covariance[(i, i)] += common);
            hypothesis.covariance.add_in_common(SPECTRUM_BIASES, common);
        }
    }

    /// A tire may have been changed: its compliance has this much more sd.
    pub(super) fn inflate_tire(&mut self, corner: Corner, sd: T) {
        self.has_changed = true;
        let at = TIRE + corner.index();
        for hypothesis in &mut self.hypotheses {
            hypothesis.covariance[(at, at)] += sd * sd;
        }
    }

    /// All hypotheses as one Gaussian, in which nothing moves.
    pub(super) fn as_one(&self, into: &mut Hypothesis<T>) {
        let [constant, changing @ ..] = &self.hypotheses;
        constant.part().without_rate().write(constant.weight, into);
        for hypothesis in changing {
            into.join(hypothesis.weight, &hypothesis.part().without_rate());
        }
    }

    /// Believes this and nothing else.
    pub(super) fn set(&mut self, belief: &Hypothesis<T>) {
        self.hypotheses[CONSTANT].take_over(belief);
        self.collapse();
    }

    /// Hypotheses in which a tire is what no tire can be are not followed. A tire of the constant one is never softer than flat; what
    /// else is wrong with that one is left for [`HypothesisBank::is_sound`]. `softest`: each tire's compliance when flat.
    pub(super) fn drop_impossible(&mut self, softest: &[T; 4]) {
        self.has_changed = true;
        self.hypotheses[CONSTANT].stop_at(softest);
        let mut total = T::zero();
        for (index, hypothesis) in self.hypotheses.iter_mut().enumerate() {
            // Several are not filled at once while they roll.
            let filling = (SIDE..RANDOM_WALK).contains(&index) && !(hypothesis.mean[RATE] >= T::zero());
            if filling || !hypothesis.is_possible(softest) {
                hypothesis.weight = T::zero();
            }
            total += hypothesis.weight;
        }
        if total > T::zero() {
            self.hypotheses.iter_mut().for_each(|hypothesis| hypothesis.weight /= total);
        }
    }

    /// Whether the likeliest is that tires wander either way, as after they were filled.
    pub(super) fn is_random_walk(&self) -> bool {
        self.most_likely() == RANDOM_WALK
    }

    /// Holds every hypothesis above the `floor` of the tires' losses, and no single tire gains air unless pumps are `filling` it. What
    /// lies beyond a bound is not believed, so who believes in it loses weight. Wandering tires may have been filled and have no bound.
    pub(super) fn hold_above(&mut self, floor: Option<&Floor<T>>, filling: bool) {
        let mut log_weight = [T::zero(); HYPOTHESES];
        let bounded = self.hypotheses[..RANDOM_WALK].iter_mut().zip(&mut log_weight);
        for (index, (hypothesis, log)) in bounded.enumerate() {
            if (1..SIDE).contains(&index) && !filling {
                *log += hypothesis.hold_above(RATE, T::zero());
            }
            let Some(floor) = floor else { continue };
            for tire in Corner::ALL {
                let least = floor.of(tire, Corner::ALL.map(|tire| hypothesis.loss(tire)));
                *log += hypothesis.hold_loss_above(tire, least);
            }
        }
        self.reweigh(&log_weight);
    }

    /// The losses of all tires begin to be counted, and nothing moves.
    pub(super) fn begin_losses(&mut self) {
        Corner::ALL.into_iter().for_each(|tire| self.hypotheses[CONSTANT].begin_loss(tire));
        self.collapse();
    }

    /// That of one tire begins anew.
    pub(super) fn begin_loss(&mut self, tire: Corner) {
        self.has_changed = true;
        self.hypotheses.iter_mut().for_each(|hypothesis| hypothesis.begin_loss(tire));
    }

    /// Probability that nothing moves.
    pub(super) fn constant_weight(&self) -> T {
        self.hypotheses[CONSTANT].weight
    }

    /// Only the constant hypothesis is left: somebody knows that nothing moves.
    pub(super) fn collapse(&mut self) {
        self.has_changed = true;
        self.update.lesson.clear();
        for hypothesis in &mut self.hypotheses[1..] {
            hypothesis.weight = T::zero();
        }
        self.hypotheses[CONSTANT].weight = T::one();
    }

    /// Brings what is believed of the tires, over all hypotheses, up to date.
    pub(super) fn refresh(&mut self, tires: &mut Tires<T>) {
        if !core::mem::take(&mut self.has_changed) {
            return;
        }
        let total = self.hypotheses.iter().fold(T::zero(), |sum, hypothesis| sum + hypothesis.weight);
        tires.clear();
        for (index, hypothesis) in self.hypotheses.iter().enumerate() {
            if hypothesis.weight > T::zero() {
                tires.add(hypothesis, hypothesis.weight / total, &changing(index));
            }
        }
        tires.changing = self.changing_tires();
        tires.any_changes = self.changing();
    }

    /// Mean and variance of one quantity, over all hypotheses.
    pub(super) fn quantity(&self, at: usize) -> (T, T) {
        let at = at.min(SIZE - 1);
        // Between the parts of a prediction weights do not add up to one.
        let (mut mean, mut square, mut total) = (T::zero(), T::zero(), T::zero());
        for hypothesis in &self.hypotheses {
            total += hypothesis.weight;
            mean += hypothesis.weight * hypothesis.mean[at];
            square += hypothesis.weight
                * (hypothesis.covariance[(at, at)] + hypothesis.mean[at] * hypothesis.mean[at]);
        }
        let (mean, square) = (mean / total, square / total);
        (mean, square - mean * mean)
    }

    /// Probability that each tire moves.
    pub(super) fn changing_tires(&self) -> [T; 4] {
        let several = self.hypotheses[RANDOM_WALK].weight;
        Corner::ALL.map(|corner| {
            self.hypotheses[corner.index() + 1].weight + self.hypotheses[both(corner)].weight + several
        })
    }

    /// Probability that anything moves.
    pub(super) fn changing(&self) -> T {
        self.hypotheses[1..].iter().fold(T::zero(), |sum, hypothesis| sum + hypothesis.weight)
    }

    pub(super) fn is_sound(&self, softest: &[T; 4]) -> bool {
        let finite = |hypothesis: &Hypothesis<T>| {
            hypothesis.weight >= T::zero()
                && hypothesis.mean.iter().all(|x| x.is_finite())
                && hypothesis.covariance.variances().iter().all(|x| x.is_finite())
        };
        self.hypotheses.iter().all(finite) && self.hypotheses[CONSTANT].is_possible(softest)
    }
}
