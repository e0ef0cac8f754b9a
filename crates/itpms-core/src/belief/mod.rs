//! What is believed of the car: its tires' compliances and how masses, dampers, springs, sensors and wheelbase deviate from
//! the vehicle file, as a bank of Gaussians, one for every way in which pressures may be changing
//! (docs/math/shared-road.md, sections 3, 4 and 6).
//!
//! Entered by [`Belief::predict`] and its parts, [`Belief::begin_update`], [`Belief::compare`], [`Belief::teach`] and [`Belief::finish_update`] for a frame,
//! [`Belief::update_scalar`] for a number, [`Belief::checkpoint`] and [`Belief::restore`]; all
//! state is private. Called by [`crate::car`]; knows no signals, no frames and no samples.
//!
//! | module | idea |
//! |---|---|
//! | `state` | the vector of unknown quantities, its prior and its process noise |
//! | `measurement` | what a frame of one side looks like to the belief, and the record of an update |
//! | `covariance` | a symmetric matrix in half its memory |
//! | `gaussian` | one Gaussian, and two merged into one |
//! | `hypothesis_bank`, `transition` | eight of them, and how one hypothesis becomes another |
//! | `instruments` | what a side reads too much while its instruments are not learned |
//! | `update` | Bayes' rule for a frame with instruments |
//! | `checkpoint` | going back to what was believed before a sensor failed |
//! | `calibration` | tires set to their placard pressures, and what that teaches |
//! | `losses` | from when on the losses of this drive are counted |
//! | `floor` | that tires only lose air while they roll |
//! | `tire_scale` | compliances, stiffnesses and pressures of the car's tires |
//! | `tires` | what is believed of the tires, for the moments after |

mod calibration;
mod checkpoint;
mod covariance;
mod floor;
mod gaussian;
mod hypotheses;
mod hypothesis_bank;
mod instruments;
mod losses;
pub(crate) mod measurement;
pub(crate) mod state;
#[cfg(test)]
mod tests;
mod tire_scale;
mod tires;
mod transition;
mod update;

use self::calibration::CalibrationState;
use self::checkpoint::{Checkpoint, PreFaultEstimate};
use self::floor::Floor;
use self::gaussian::Circumstances;
pub(crate) use self::gaussian::FrictionError;
pub(crate) use self::gaussian::Hypothesis;
pub(crate) use self::hypotheses::HYPOTHESES;
use self::hypothesis_bank::HypothesisBank;
use self::losses::Losses;
use self::measurement::{AxleResidual, SideMeasurement, UpdateRecord};
use self::state::{SideReading, State, TIRE};
pub(crate) use self::tire_scale::{LEAST_COMPLIANCE, TireScale};
pub(crate) use self::tires::Tires;
pub(crate) use self::transition::PARTS as PREDICTION_PARTS;
use crate::cold_pressure::STANDING_S;
use crate::memory::{Blank, Placed};
use crate::model::{CarConfig, Corner, CornerConfig, Inflation, Learned, Level, Side};
use crate::real::Real;

/// Longest time in s over which a change is followed between pseudo-measurements where there are no frames; elsewhere it is a pause.
pub(crate) const LONGEST_SILENCE_S: f64 = 3.0;
/// Pauses count for so many seconds at most, and from [`FILLING_S`] on a tire may have been filled.
const LONGEST_PAUSE_S: f64 = 600.0;
const FILLING_S: f64 = 20.0;
/// Sd of the common change of all pressures while a car was parked for long, as a share of them: 20 K are 23 kPa.
const PARKED_SD: f64 = 0.06;
/// Sd to which unsprung masses are held until a calibration teaches them, as a share of them: mass and stiffness of a wheel are not known
/// apart, and what the vehicle file leaves open of both is considered outside.
const HELD_MASS_SD: f64 = 0.01;
/// The least that a strut damps, friction included, as a share of its damper in the vehicle file: dampers wear out, and none drives its
/// wheel.
pub(crate) const LEAST_DAMPING: f64 = 0.5;
/// Probability that no tire moves from which on losses may begin to be counted.
const SURELY_STILL: f64 = 0.9;
/// Sd of a tire's compliance, over that at placard pressure, after a time without samples.
const UNWATCHED_SD: f64 = 0.05;

/// How readily pressures are taken to begin to change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Onset<T> {
    /// Rates per second at which each tire begins that its own spectrum suggests.
    pub(crate) rates: [T; 4],
    /// Longest time in s that is a step; more is a gap.
    pub(crate) longest_step_s: f64,
}

#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Belief<T: Real> {
    bank: HypothesisBank<T>,
    scale: TireScale<T>,
    present: [bool; 4],
    start: [T; 4],
    /// How well the vehicle file knows the unsprung masses, each axle's for itself, as a share of them.
    mass_sd: [T; 4],
    /// Time to which the belief was predicted.
    time_s: f64,
    /// Seconds of shared road learned from.
    learned_s: f64,
    calibration: CalibrationState<T>,
    checkpoints: [Placed<Checkpoint<T>>; 2],
    pre_fault: [Option<PreFaultEstimate<T>>; 4],
    inflation: Inflation,
    losses: Losses,
}

impl<T: Real> Belief<T> {
    pub(crate) fn configure(&mut self, config: &CarConfig<T>) {
        let softer = |c: &CornerConfig<T>| {
            c.tire.stiffness_n_per_m(c.placard_kpa) / c.initial_stiffness_n_per_m() - T::one()
        };
        self.start = core::array::from_fn(|i| config.corners[i].as_ref().map_or(T::zero(), softer));
        let held = T::lit(HELD_MASS_SD);
        let mass_sd = |c: &CornerConfig<T>| c.uncertainty.axle_mass_relative_sd().max(held);
        self.mass_sd = core::array::from_fn(|i| config.corners[i].as_ref().map_or(held, mass_sd));
        self.bank.circumstances = Circumstances::of_a_car([held; 4]);
        self.bank.start(&self.start);
        self.scale = TireScale::new(config);
        self.present = config.corners.each_ref().map(Option::is_some);
        (self.time_s, self.learned_s) = (f64::NAN, 0.0);
        self.calibration = CalibrationState::new();
        self.drop_checkpoints();
        self.pre_fault = [None; 4];
        self.inflation = Inflation::AtStops;
        self.losses = Losses::none();
    }

    /// Predicts to a time. A longer step than the onset's longest is a gap: what changed then is over, and a tire may have been
    /// filled.
    pub(crate) fn predict(&mut self, time_s: f64, onset: &Onset<T>) {
        self.begin_prediction(time_s, onset);
        (0..PREDICTION_PARTS).for_each(|part| self.predict_part(part));
    }

    /// The same in parts: [`predict_part`](Self::predict_part) has to follow for each of [`PREDICTION_PARTS`].
    pub(crate) fn begin_prediction(&mut self, time_s: f64, onset: &Onset<T>) {
        self.bank.end_prediction();
        if !self.time_s.is_finite() {
            self.time_s = time_s;
        }
        let seconds = time_s - self.time_s;
        if !(seconds > 0.0) {
            return;
        }
        self.time_s = time_s;
        if seconds > onset.longest_step_s {
            self.drop_checkpoints();
            let filled = seconds > FILLING_S && !self.is_calibrating();
            self.bank.predict_gap(T::lit(seconds.min(LONGEST_PAUSE_S)), filled);
            if seconds > LONGEST_PAUSE_S && !self.is_calibrating() {
                self.losses.end(self.learned_s);
                let sd = T::lit(PARKED_SD) * (T::one() - T::lit(-seconds / STANDING_S).exp());
                self.bank.change_temperature(&Corner::ALL.map(|corner| sd * self.scale.share(corner)));
            }
            return;
        }
        let begins = self.expects_onsets();
        let rates = if begins { onset.rates } else { [T::zero(); 4] };
        // Tires that only lose air while they roll do not wander.
        // Of tires that were set one may be punctured; several together are a car that is not known yet.
        let together = begins && !self.is_calibrating();
        self.bank.begin_prediction(T::lit(seconds), [begins, together, begins && !self.only_lose()], &rates);
    }

    pub(crate) fn predict_part(&mut self, part: usize) {
        self.bank.predict_part(part);
    }

    /// Begins to update with a frame of one side. [`compare`](Self::compare) and [`teach`](Self::teach) have to follow for each of
    /// [`HYPOTHESES`], then [`finish_update`](Self::finish_update) and [`settle`](Self::settle).
    pub(crate) fn begin_update(&mut self, measurement: &SideMeasurement<T>) {
        let side = measurement.reading.side;
        for corner in [side.front(), side.rear()] {
            self.inflate_tire(corner, measurement.incoherent_s);
        }
        self.bank.begin_update(side, measurement.weight);
    }

    /// Compares one hypothesis with the frame, which `linearize` linearizes at a state; false if that one is left out.
    pub(crate) fn compare(
        &mut self,
        index: usize,
        measurement: &SideMeasurement<T>,
        linearize: impl Fn(&State<T>) -> AxleResidual<T>,
    ) -> bool {
        self.bank.compare(index, measurement, linearize)
    }

    /// Teaches it what the comparison showed; false if that is nothing.
    pub(crate) fn teach(&mut self, index: usize, reading: &SideReading<T>) -> bool {
        self.bank.teach(index, reading)
    }

    /// Weighs the hypotheses; gives the record of the most likely one.
    pub(crate) fn finish_update(&mut self) -> Option<&UpdateRecord<T>> {
        self.bank.finish_update()
    }

    /// Updates with one number of this variance: `linearize` gives, for a state, its derivatives and how much more it is than
    /// expected. Tells nothing about which hypothesis holds.
    pub(crate) fn update_scalar(&mut self, variance: T, linearize: impl Fn(&State<T>) -> (State<T>, T)) {
        self.bank.update(variance, linearize);
    }

    /// The same with a number of a side that also tells how likely each hypothesis is.
    pub(crate) fn update_reweighted(
        &mut self,
        side: Side,
        variance: T,
        linearize: impl Fn(&State<T>) -> (State<T>, T),
    ) {
        self.bank.update_reweighted(side, variance, linearize);
    }

    /// Ends an update: counts the seconds of shared road learned from, and drops what no tire can be.
    pub(crate) fn settle(&mut self, learned_s: f64) {
        self.learned_s += learned_s;
        self.count_losses();
        self.hold_above_floor();
        let softest = self.scale.softest();
        self.bank.drop_impossible(&softest);
        if !self.bank.is_sound(&softest) {
            self.restart();
        }
    }

    /// Once tires have settled, what they are is their level, and what they lose from then on is counted.
    fn count_losses(&mut self) {
        let still = self.bank.constant_weight() > T::lit(SURELY_STILL);
        if still && !self.is_calibrating() && self.losses.have_settled(self.learned_s) {
            self.bank.begin_losses();
            self.losses.begin(self.time_s);
        }
    }

    /// Tires only lose air while they roll, unless somebody fills them at a stop or a pump does so on the way.
    fn hold_above_floor(&mut self) {
        if self.bank.is_random_walk() {
            self.losses.end(self.learned_s);
        }
        let filling = self.inflation == Inflation::WhileRolling;
        let shares = Corner::ALL.map(|corner| self.scale.share(corner));
        let since_s = self.losses.since_s().filter(|_| !filling);
        let floor = since_s
            .map(|since_s| Floor::after(T::lit(self.time_s - since_s), shares, self.present == [true; 4]));
        self.bank.hold_above(floor.as_ref(), filling);
    }

    /// Whether tires are known only to lose air from here on.
    fn only_lose(&self) -> bool {
        self.inflation == Inflation::AtStops && self.losses.since_s().is_some()
    }

    /// What friction that is not known exactly makes of a corner on the present road.
    pub(crate) fn set_friction_error(&mut self, corner: Corner, error: FrictionError<T>) {
        self.bank.circumstances.friction_error[corner] = error;
    }

    /// Whether tires may gain air while they roll.
    pub(crate) fn set_inflation(&mut self, inflation: Inflation) {
        self.inflation = inflation;
    }

    /// The belief has become impossible, or rests on something that was wrong: begins again with what calibrations taught.
    pub(crate) fn restart(&mut self) {
        self.bank.start(&self.start);
        self.learned_s = 0.0;
        self.losses.end(self.learned_s);
        self.drop_checkpoints();
        if let Some(calibration) = self.newest_calibration() {
            // It was learned for this car, or accepted before.
            let _ = self.load_calibration(&calibration);
        }
        if self.is_calibrating() {
            self.set_tires();
        }
    }

    /// The belief about a tire fades with seconds of incoherence.
    pub(crate) fn inflate_tire(&mut self, corner: Corner, incoherent_s: T) {
        self.bank.inflate(corner, incoherent_s, self.calibration.calibrated);
    }

    /// Sets a quantity to a value with its sd; `unit` is the state's in that quantity.
    pub(crate) fn set_quantity(&mut self, at: usize, learned: &Learned<T>, unit: T) {
        self.bank.set_quantity(at, learned, T::zero(), unit);
    }

    /// A corner's sensors were out of order: its tire may have changed meanwhile, and before it was noticed only seemed to.
    /// During a calibration it is the pressure that was set.
    pub(crate) fn restart_tire(&mut self, corner: Corner) {
        self.drop_checkpoints();
        let pre_fault = self.pre_fault[corner].take();
        if self.is_calibrating() {
            self.set_tire(corner);
            return;
        }
        if let Some(tire) = pre_fault {
            self.set_quantity(TIRE + corner.index(), &tire.compliance, T::one());
            self.bank.begin_loss(corner);
        }
        self.bank.inflate_tire(corner, T::lit(UNWATCHED_SD));
    }

    /// What a tire was before its sensors were suspected is of no use once later frames were learned from.
    pub(crate) fn drop_settled(&mut self, corner: Corner, time_s: f64) {
        self.pre_fault[corner].take_if(|tire| tire.is_settled(time_s));
    }

    /// The state of the most likely hypothesis.
    pub(crate) fn most_likely(&self) -> &Hypothesis<T> {
        self.bank.best()
    }

    /// Mean of one quantity, and its variance, over all hypotheses.
    pub(crate) fn quantity(&self, at: usize) -> (T, T) {
        self.bank.quantity(at)
    }

    /// Brings what is believed of the tires up to date.
    pub(crate) fn refresh(&mut self, tires: &mut Tires<T>) {
        self.bank.refresh(tires);
        tires.time_s = self.time_s;
        tires.count_losses = self.losses.since_s().is_some();
    }

    /// What the tires' level rests on.
    pub(crate) fn level(&self) -> Level {
        match &self.calibration {
            state if !state.calibrated => Level::VehicleFile,
            state if state.is_of_this_drive() => Level::Calibration,
            _ => Level::StoredCalibration,
        }
    }

    pub(crate) fn scale(&self) -> &TireScale<T> {
        &self.scale
    }

    /// Time in s to which the belief was predicted.
    pub(crate) fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Seconds of shared road learned from.
    pub(crate) fn learned_s(&self) -> f64 {
        self.learned_s
    }
}
