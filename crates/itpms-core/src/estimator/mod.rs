//! One small interface before all estimators of a corner: samples in, [`CornerEstimate`]s out, whichever
//! [`EstimatorKind`] computes them.
//!
//! Called by the binary, the studies and controllers. Every sample passes the [`Resampler`], so no estimator behind it
//! ever sees a missing or absurd value.

mod engine;

use crate::conditioning::clock::SteadyClock;
use crate::conditioning::wheel_lift::ContactWatch;
use crate::conditioning::{GridSample, Resampler, SampleCounts, SpeedHold};
use crate::estimator::engine::{Engine, Reading};
use crate::model::{
    CornerConfig, CornerEstimate, CornerSample, Diagnostics, ParameterError, QuarterCar, Validity, Warning,
    positive,
};
use crate::real::Real;
use crate::road::{RoadConfig, RoadFilter};
use crate::single_wheel::StiffnessPseudoMeasurement;
pub use crate::single_wheel::{RoadPeriod, RoadRepetition};
use crate::warning::single_wheel::LowPressureWatch;

/// Grid rate in Hz that the spectral frames need; slower samples are interpolated up to it.
const FRAME_GRID_HZ: f64 = 400.0;

/// Seconds between two words to the road filter about the car, and to the estimator about a reset.
const TELL_ROAD_S: f64 = 0.1;

/// The estimators to choose from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EstimatorKind {
    /// Bayes filter that knows that a road looks like a road: [`crate::single_wheel`].
    #[default]
    Informed,
    /// The paper's recursion, mended and told the stiffness likelihood of the same frames.
    AekfUiInformed,
    /// As published, with the one-step forgetting factor. Cannot find the stiffness.
    AekfUi,
    /// As published, without forgetting. Cannot find the stiffness.
    EkfUi,
}

impl EstimatorKind {
    /// All kinds, the default first.
    pub const ALL: [Self; 4] = [Self::Informed, Self::AekfUiInformed, Self::AekfUi, Self::EkfUi];

    /// The name on the command line.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Informed => "informed",
            Self::AekfUiInformed => "aekf-ui-informed",
            Self::AekfUi => "aekf-ui",
            Self::EkfUi => "ekf-ui",
        }
    }

    /// The kind of that name.
    #[must_use]
    pub fn from_label(label: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.label() == label)
    }
}

/// A running estimator of one corner. A value: clone it, save it, go on.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub struct Estimator<T: Real> {
    kind: EstimatorKind,
    config: CornerConfig<T>,
    sample_rate_hz: f64,
    clock: SteadyClock,
    speed: SpeedHold<T>,
    intake: Resampler<T>,
    engine: Engine<T>,
    /// The road for the default estimator; the filters bring their own. `None`: nobody wants to know it.
    road: Option<RoadFilter<T>>,
    road_told_s: f64,
    watch: LowPressureWatch,
    /// Length in s of the reset drive at the start, and when it ends once that is known.
    calibration_s: f64,
    calibration_ends_s: Option<f64>,
    pinned_s: f64,
    restarts: u32,
    repetition: RoadRepetition,
    /// What the whole car says of this corner, while it says anything.
    fused: Option<FusedStiffness<T>>,
    contact: ContactWatch<T>,
}

/// What the whole car knows of a corner that the corner by itself does not.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FusedStiffness<T> {
    pub(crate) stiffness_n_per_m: T,
    pub(crate) stiffness_sd_n_per_m: T,
    /// Probability that the pressure is changing.
    pub(crate) changing: T,
    /// Seconds of full information that it rests on.
    pub(crate) learned_s: T,
    /// Whether the road that its axles share is being learned from.
    pub(crate) learning: bool,
    /// Whether anything is heard at all: frames, or words of the corner's spectrum.
    pub(crate) has_signal: bool,
}

impl<T: Real> Estimator<T> {
    /// An estimator of `kind` for a corner whose samples come at about `sample_rate_hz`.
    ///
    /// # Errors
    /// The rate must be positive and finite; parameters of the corner that the filters refuse are named.
    pub fn new(
        kind: EstimatorKind,
        config: &CornerConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<Self, ParameterError> {
        let sample_rate_hz = positive("sample_rate_hz", sample_rate_hz)?;
        let frames = matches!(kind, EstimatorKind::Informed | EstimatorKind::AekfUiInformed);
        let intake = Resampler::new(sample_rate_hz, if frames { FRAME_GRID_HZ } else { sample_rate_hz });
        let engine = Engine::new(kind, config, sample_rate_hz, intake.grid_period_s())?;
        let noise = config.accel_noise_or_usual_m_s2();
        let road = RoadConfig::new(config.quarter_car, config.initial_stiffness_n_per_m(), noise)?;
        Ok(Self {
            kind,
            config: *config,
            sample_rate_hz,
            clock: SteadyClock::new(sample_rate_hz),
            speed: SpeedHold::new(),
            intake,
            engine,
            road: Some(RoadFilter::new(&road)),
            road_told_s: f64::NEG_INFINITY,
            watch: LowPressureWatch::new(),
            calibration_s: 0.0,
            calibration_ends_s: None,
            pinned_s: f64::NEG_INFINITY,
            restarts: 0,
            repetition: RoadRepetition::Detect,
            fused: None,
            contact: ContactWatch::new(&config.quarter_car),
        })
    }

    /// The same for a drive whose first seconds are known to be at placard pressure: a reset. While it lasts the estimate
    /// stays there and learns load, damping and road.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn with_calibration_drive(mut self, seconds: f64) -> Result<Self, ParameterError> {
        self.begin_calibration(seconds)?;
        Ok(self)
    }

    /// Says that the tire has its placard pressure from the next sample on, for `seconds`: the driver's reset.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        self.calibration_s = positive("calibrate_s", seconds)?;
        self.calibration_ends_s = None;
        Ok(())
    }

    /// The same with what is known of the road repeating itself, as on a test bed; else that is looked for in the data.
    #[must_use]
    pub fn with_road_repetition(mut self, repetition: RoadRepetition) -> Self {
        self.repetition = repetition;
        self.engine.set_repetition(repetition);
        self
    }

    /// The same for callers who do not read the road: `road_m` and its sd stay NaN where they come from a filter of their
    /// own, and that filter's time is saved. The pressure is the same to the last digit.
    #[must_use]
    pub fn without_road(self) -> Self {
        Self { road: None, ..self }
    }

    /// Probability that the pressure moves, as the corner by itself sees it.
    pub(crate) fn change_probability(&self) -> T {
        self.engine.reading().change_probability
    }

    /// Stiffness and its sd in N/m, as the corner by itself sees them.
    pub(crate) fn own_stiffness(&self) -> (T, T) {
        let reading = self.engine.reading();
        (reading.stiffness_n_per_m, reading.stiffness_sd_n_per_m)
    }

    /// The car as it seems to be now: sprung mass and damping as identified on the way, where the estimator does.
    pub fn quarter_car(&self) -> QuarterCar<T> {
        self.engine.quarter_car()
    }

    /// Takes one sample: time in s, speed in m/s, body and wheel acceleration in m/s²; NaN is a missing value. Gives
    /// the estimate after it. A missing speed is the last one, for half a second ([`SpeedHold`]). A sample that cannot be
    /// used is counted, and the estimate says so when it matters.
    pub fn update(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        body_accel_m_s2: T,
        wheel_accel_m_s2: T,
    ) -> CornerEstimate<T> {
        let corner = CornerSample { body_accel_m_s2, wheel_accel_m_s2 };
        match self.clock.take(time_s) {
            Some(steady_s) => {
                let speed_m_s = self.speed.take(steady_s, speed_m_s);
                self.take(steady_s, speed_m_s, &corner, |_| {});
            }
            None => self.refuse(),
        }
        CornerEstimate { time_s, ..self.conclude(self.clock.now_s(), &corner) }
    }

    /// Counts a sample whose time nobody should go by.
    pub(crate) fn refuse(&mut self) {
        let lost = T::lit(f64::NAN);
        self.intake.push(f64::NAN, lost, lost, lost, |_| {});
    }

    /// The first half of [`Estimator::update`]: takes the sample with the speed to go by, and shows every grid step to `tap`.
    pub(crate) fn take(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        corner: &CornerSample<T>,
        mut tap: impl FnMut(&GridSample<T>),
    ) {
        let (engine, contact) = (&mut self.engine, &mut self.contact);
        let (body, wheel) = (corner.body_accel_m_s2, corner.wheel_accel_m_s2);
        self.intake.push(time_s, speed_m_s, body, wheel, |sample| {
            let contact = contact.look(&sample);
            let sample = GridSample { unloaded: contact.unloaded, ..sample };
            engine.step(&GridSample { invalid: sample.invalid || contact.hopping, ..sample });
            tap(&sample);
        });
        self.hold_calibration(time_s);
    }

    /// What the last frames said of the stiffness to somebody who believed in this one with that sd, in N/m, when there is
    /// something new.
    pub(crate) fn pseudo_measurement(
        &mut self,
        believed: impl FnOnce() -> (T, T),
    ) -> Option<StiffnessPseudoMeasurement<T>> {
        self.engine.pseudo_measurement(believed)
    }

    /// Tells what the whole car says of this corner; `None`: nothing now.
    pub(crate) fn set_fused(&mut self, word: Option<FusedStiffness<T>>) {
        self.fused = word;
    }

    /// Time between grid steps in s.
    pub(crate) fn grid_period_s(&self) -> f64 {
        self.intake.grid_period_s()
    }

    /// The second half of [`Estimator::update`]: what is known after the sample.
    pub(crate) fn conclude(&mut self, time_s: f64, corner: &CornerSample<T>) -> CornerEstimate<T> {
        let mut reading = self.engine.reading_at(time_s);
        if !(reading.stiffness_n_per_m.is_finite() && reading.stiffness_sd_n_per_m.is_finite())
            && self.kind == EstimatorKind::Informed
        {
            self.restart();
        }
        if let Some(word) = &self.fused {
            self.engine.apply_fused(&mut reading, word);
        }
        if self.kind == EstimatorKind::Informed {
            (reading.road_m, reading.road_sd_m) = self.follow_road(time_s, corner, &reading);
        }
        self.estimate(time_s, &reading)
    }

    /// While the reset drive lasts, says so to the estimator ten times a second.
    fn hold_calibration(&mut self, time_s: f64) {
        if !(self.calibration_s > 0.0 && time_s.is_finite()) {
            return;
        }
        let ends_s = *self.calibration_ends_s.get_or_insert(time_s + self.calibration_s);
        if time_s < ends_s && !(time_s - self.pinned_s < TELL_ROAD_S) {
            self.pinned_s = time_s;
            self.engine.set_to_placard();
        }
    }

    /// Causal road height in m and its sd, for the stiffness believed now.
    fn follow_road(&mut self, time_s: f64, corner: &CornerSample<T>, reading: &Reading<T>) -> (T, T) {
        let unknown = (T::lit(f64::NAN), T::lit(f64::NAN));
        let Some(filter) = &mut self.road else { return unknown };
        if !(time_s - self.road_told_s < TELL_ROAD_S) {
            self.road_told_s = time_s;
            // Refused only outside its range, and then the road keeps what it was told before.
            let _ = filter.set_stiffness(reading.stiffness_n_per_m, reading.stiffness_sd_n_per_m);
            filter.set_quarter_car(self.engine.quarter_car());
        }
        let road = filter.update(time_s, corner);
        if road.validity.is_valid() { (road.road_m, road.road_sd_m) } else { unknown }
    }

    /// Starts again from the corner's initial pressure, as after a tire change. Counted.
    pub fn restart(&mut self) {
        self.engine.restart(self.kind, self.repetition);
        self.watch = LowPressureWatch::new();
        self.restarts = self.restarts.saturating_add(1);
    }

    /// Which estimator this is.
    pub fn kind(&self) -> EstimatorKind {
        self.kind
    }

    /// What was found in the samples so far.
    pub fn counts(&self) -> SampleCounts {
        self.intake.counts()
    }

    /// How often the estimator started again.
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    fn estimate(&mut self, time_s: f64, reading: &Reading<T>) -> CornerEstimate<T> {
        let tire = &self.config.tire;
        let pressure_kpa = tire.pressure_kpa(reading.stiffness_n_per_m);
        let pressure_sd_kpa = tire.pressure_sd_kpa(pressure_kpa, reading.stiffness_sd_n_per_m);
        let validity = if self.intake.is_bad() { Validity::BadSignal } else { reading.validity };
        let placard = self.config.placard_kpa;
        let warning = match self.kind {
            // A filter that cannot find the stiffness has nothing to warn of.
            EstimatorKind::AekfUi | EstimatorKind::EkfUi => Warning::None,
            _ => self.watch.update(time_s, validity, pressure_kpa, pressure_sd_kpa, placard),
        };
        let slope = tire.stiffness_per_kpa();
        let reading_sd = reading.stiffness_sd_n_per_m / slope;
        CornerEstimate {
            time_s,
            stiffness_n_per_m: reading.stiffness_n_per_m,
            stiffness_sd_n_per_m: reading.stiffness_sd_n_per_m,
            pressure_kpa,
            pressure_sd_kpa,
            road_m: reading.road_m,
            road_sd_m: reading.road_sd_m,
            validity,
            warning,
            diagnostics: Diagnostics {
                forgetting: reading.forgetting,
                nis: reading.nis,
                gate: reading.gate,
                change_probability: reading.change_probability,
                pressure_variance_kpa2: reading_sd * reading_sd,
            },
        }
    }
}
