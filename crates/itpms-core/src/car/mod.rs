//! The estimator of a whole car: up to four corners at once, each on its own road spectrum, and front and rear
//! together on the road they share.
//!
//! Called by the binary, the studies, the monitor and controllers. A corner without a partner on its side is estimated
//! as by [`Estimator`]; nothing else here knows how many wheels a car has.

use crate::belief::output::CarBelief;
use crate::belief::single_wheel_estimate::SingleWheelEstimate;
use crate::conditioning::SpeedHold;
use crate::conditioning::clock::SteadyClock;
use crate::estimator::{Estimator, EstimatorKind, FusedStiffness, RoadRepetition};
use crate::inter_axle::SharedRoad;
use crate::model::{
    CalibrationError, CarConfig, CarSample, Corner, CornerEstimate, ParameterError, QuarterCar,
    VehicleCalibration, positive,
};
use crate::real::Real;

/// From where the pressure may be learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Sources {
    /// From the road's spectrum, corner by corner, and from front and rear meeting the same road.
    #[default]
    SpectrumAndSharedRoad,
    /// From each corner's road spectrum alone.
    Spectrum,
    /// From the shared road alone.
    SharedRoad,
}

/// What is known of the car after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CarEstimate<T> {
    /// Time of the sample in s.
    pub time_s: f64,
    /// The corners, in the order of [`Corner::ALL`].
    pub corners: [Option<CornerEstimate<T>>; 4],
    /// Correlation coefficients of the pressures' errors, in the order of [`Corner::ALL`].
    pub correlation: [[T; 4]; 4],
    /// Left and right track: how the rear wheels follow the front ones.
    pub tracks: [TrackState<T>; 2],
}

/// How far front and rear of one side share a road now.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrackState<T> {
    /// Whether the shared road is being learned from.
    pub shared: bool,
    /// Share of the road's power near wheel hop that front and rear do not have in common, 0.001 to 2 (what two
    /// roads that have nothing in common differ by has twice the power of one); NaN when unknown.
    pub incoherence: T,
}

impl<T: Real> TrackState<T> {
    /// Nothing is shared, nothing is known.
    pub(crate) fn unknown() -> Self {
        Self { shared: false, incoherence: T::lit(f64::NAN) }
    }
}

/// A running estimator of a car. A value: clone it, save it, go on.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: Real + serde::Serialize",
        deserialize = "T: Real + serde::Deserialize<'de>"
    ))
)]
pub struct CarEstimator<T: Real> {
    kind: EstimatorKind,
    sources: Sources,
    clock: SteadyClock,
    speed: SpeedHold<T>,
    corners: [Option<Estimator<T>>; 4],
    shared_road: Option<SharedRoad<T>>,
    /// When the reset that is under way ends, and how long it lasts if it has not begun.
    calibration_s: Option<f64>,
    reset_ends_s: f64,
}

impl<T: Real> CarEstimator<T> {
    /// An estimator of `kind` for samples that come at about `sample_rate_hz`. Only [`EstimatorKind::Informed`] uses the
    /// shared road.
    ///
    /// # Errors
    /// The rate must be positive and finite; parameters of a corner that the filters refuse are named.
    pub fn new(
        kind: EstimatorKind,
        config: &CarConfig<T>,
        sample_rate_hz: f64,
    ) -> Result<Self, ParameterError> {
        let sample_rate_hz = positive("sample_rate_hz", sample_rate_hz)?;
        let mut corners = [const { None }; 4];
        for (corner, config) in corners.iter_mut().zip(&config.corners) {
            if let Some(config) = config {
                *corner = Some(Estimator::new(kind, config, sample_rate_hz)?);
            }
        }
        let grid_period_s = corners.iter().flatten().next().map_or(f64::NAN, Estimator::grid_period_s);
        let shared_road = match kind {
            EstimatorKind::Informed => SharedRoad::new(config, sample_rate_hz, grid_period_s),
            _ => None,
        };
        Ok(Self {
            kind,
            sources: Sources::default(),
            clock: SteadyClock::new(sample_rate_hz),
            speed: SpeedHold::new(),
            corners,
            shared_road,
            calibration_s: None,
            reset_ends_s: f64::NEG_INFINITY,
        })
    }

    /// The same with other sources of information; before the first sample.
    #[must_use]
    pub fn with_sources(self, sources: Sources) -> Self {
        Self { sources, ..self }
    }

    /// The same for a drive whose first seconds are known to be at placard pressure: a reset.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn with_calibration_drive(mut self, seconds: f64) -> Result<Self, ParameterError> {
        for corner in &mut self.corners {
            *corner = corner.take().map(|estimator| estimator.with_calibration_drive(seconds)).transpose()?;
        }
        self.calibration_s = Some(seconds);
        Ok(self)
    }

    /// The same with what is known of the road repeating itself, as on a test bed.
    #[must_use]
    pub fn with_road_repetition(mut self, repetition: RoadRepetition) -> Self {
        for corner in &mut self.corners {
            *corner = corner.take().map(|estimator| estimator.with_road_repetition(repetition));
        }
        self
    }

    /// The same for callers who do not read the roads: see [`Estimator::without_road`].
    #[must_use]
    pub fn without_road(mut self) -> Self {
        for corner in &mut self.corners {
            *corner = corner.take().map(Estimator::without_road);
        }
        self
    }

    /// Says that all tires have their placard pressures from the next sample on, for `seconds`, in which the car should be
    /// driven: the driver's reset. Whatever an earlier one had set is set anew, also while that lasts.
    ///
    /// # Errors
    /// The length must be positive and finite.
    pub fn begin_calibration(&mut self, seconds: f64) -> Result<(), ParameterError> {
        for corner in self.corners.iter_mut().flatten() {
            corner.begin_calibration(seconds)?;
        }
        self.calibration_s = Some(seconds);
        Ok(())
    }

    /// Seconds by which the speed was found to come late against the accelerations, and which are allowed for since; below zero where it
    /// comes early, zero as long as nothing was found.
    pub fn speed_latency_s(&self) -> f64 {
        self.shared_road.as_ref().map_or(0.0, SharedRoad::speed_latency_s)
    }

    /// What the last reset taught; `None` before it is over, or when it saw too little shared road.
    pub fn learned(&self) -> Option<VehicleCalibration<T>> {
        let shared = self.shared_road.as_ref().filter(|_| self.calibration_s.is_none())?;
        shared.learned()
    }

    /// The same for a car that was reset on an earlier drive; before the first sample.
    ///
    /// # Errors
    /// An implausible reference, or one learned for other corners or other placard pressures.
    pub fn with_calibration(mut self, reference: &VehicleCalibration<T>) -> Result<Self, CalibrationError> {
        reference.check()?;
        if let Some(shared) = &mut self.shared_road {
            shared.load_calibration(reference)?;
        }
        Ok(self)
    }

    /// Starts one corner again, as after its sensors were out of order; the others go on.
    pub fn restart_corner(&mut self, corner: Corner) {
        if let Some(estimator) = &mut self.corners[corner.index()] {
            estimator.restart();
        }
        if let Some(shared) = &mut self.shared_road {
            shared.restart(corner.index());
        }
    }

    /// For some seconds sensors of the `suspected` corners (in the order of [`Corner::ALL`]) may have told wrong: that a gain
    /// has changed, or that a sensor carries another one's name, shows only later. What the axles have taught in the last six
    /// to twelve seconds is unlearned, if it contradicts what was known before of anything but those corners' own tires.
    pub fn rollback(&mut self, onset_rates: [bool; 4]) {
        if let Some(shared) = &mut self.shared_road {
            shared.rollback(onset_rates);
        }
    }

    /// Takes one sample, gives the estimate after it. A missing speed is the last one, for half a second ([`SpeedHold`]).
    pub fn update(&mut self, sample: &CarSample<T>) -> CarEstimate<T> {
        match self.clock.take(sample.time_s) {
            Some(time_s) => self.take(time_s, sample),
            // Counted corner by corner.
            None => self.corners.iter_mut().flatten().for_each(Estimator::refuse),
        }
        let belief = self.fuse(self.clock.now_s());
        let mut corners = [None; 4];
        for ((estimate, estimator), corner) in corners.iter_mut().zip(&mut self.corners).zip(&sample.corners)
        {
            if let (Some(estimator), Some(corner)) = (estimator, corner) {
                let concluded = estimator.conclude(self.clock.now_s(), corner);
                *estimate = Some(CornerEstimate { time_s: sample.time_s, ..concluded });
            }
        }
        let (correlation, tracks) = (correlation(belief.as_ref()), self.tracks());
        CarEstimate { time_s: sample.time_s, corners, correlation, tracks }
    }

    /// Gives a sample's values to the corners and to the road they share.
    fn take(&mut self, time_s: f64, sample: &CarSample<T>) {
        let speed = self.speed.take(time_s, sample.speed_m_s);
        if let Some(shared) = &mut self.shared_road {
            shared.drive(time_s, speed);
        }
        let both = self.corners.iter_mut().zip(&sample.corners);
        for (i, (estimator, corner)) in both.enumerate() {
            let (Some(estimator), Some(corner)) = (estimator, corner) else { continue };
            match &mut self.shared_road {
                Some(shared) => estimator.take(time_s, speed, corner, |step| shared.push(i, step)),
                None => estimator.take(time_s, speed, corner, |_| {}),
            }
        }
    }

    /// Brings the corners' words and the shared road together; gives what the shared road believes, if that counts.
    fn fuse(&mut self, time_s: f64) -> Option<CarBelief<T>> {
        let shared = self.shared_road.as_mut()?;
        if time_s.is_finite() {
            if let Some(seconds) = self.calibration_s.take() {
                self.reset_ends_s = time_s + seconds;
                shared.begin_calibration();
            }
            shared.hold(time_s < self.reset_ends_s);
        }
        for (i, estimator) in self.corners.iter().enumerate() {
            let Some(estimator) = estimator else { continue };
            shared.look_at(i, &estimator.quarter_car());
        }
        if self.sources == Sources::SpectrumAndSharedRoad {
            for (i, estimator) in self.corners.iter_mut().enumerate() {
                let Some(estimator) = estimator else { continue };
                let (stiffness_n_per_m, sd_n_per_m) = estimator.own_stiffness();
                shared.watch(
                    i,
                    SingleWheelEstimate {
                        changing: estimator.change_probability(),
                        stiffness_n_per_m,
                        sd_n_per_m,
                    },
                );
                if let Some(word) = estimator.pseudo_measurement(|| shared.expected_pseudo_measurement(i)) {
                    shared.update_reweighted(i, time_s, word.stiffness_n_per_m, word.sd_n_per_m);
                }
            }
        }
        let trusted = self.sources != Sources::Spectrum && shared.is_trusted();
        let belief = trusted.then(|| shared.belief());
        for (i, estimator) in self.corners.iter_mut().enumerate() {
            let Some(estimator) = estimator else { continue };
            // A shared road that was given up must not leave its last word behind.
            let belief = belief.as_ref().filter(|_| shared.has_partner(i));
            let learning = shared.side(i % 2).0;
            estimator.set_fused(belief.map(|belief| FusedStiffness {
                stiffness_n_per_m: belief.stiffness_n_per_m[i],
                stiffness_sd_n_per_m: belief.covariance[(i, i)].sqrt(),
                changing: belief.changing,
                learned_s: belief.learned_s,
                learning,
                hears: shared.hears(i) && (learning || !shared.is_slow()),
            }));
        }
        belief
    }

    fn tracks(&self) -> [TrackState<T>; 2] {
        core::array::from_fn(|side| match &self.shared_road {
            Some(road) => {
                let (shared, incoherence) = road.side(side);
                TrackState { shared, incoherence }
            }
            None => TrackState::unknown(),
        })
    }

    /// Which estimator this is.
    pub fn kind(&self) -> EstimatorKind {
        self.kind
    }

    /// What it learns from.
    pub fn sources(&self) -> Sources {
        self.sources
    }

    /// The estimator of one corner, if the car has it.
    pub fn corner(&self, corner: Corner) -> Option<&Estimator<T>> {
        self.corners[corner.index()].as_ref()
    }

    /// The cars as they seem to be now, in the order of [`Corner::ALL`].
    pub fn quarter_cars(&self) -> [Option<QuarterCar<T>>; 4] {
        self.corners.each_ref().map(|estimator| estimator.as_ref().map(Estimator::quarter_car))
    }
}

/// Correlation coefficients of a belief's errors; corners alone have none.
fn correlation<T: Real>(belief: Option<&CarBelief<T>>) -> [[T; 4]; 4] {
    core::array::from_fn(|i| {
        core::array::from_fn(|j| match belief {
            _ if i == j => T::one(),
            Some(CarBelief { covariance: p, .. }) if p[(i, i)] * p[(j, j)] > T::zero() => {
                p[(i, j)] / (p[(i, i)] * p[(j, j)]).sqrt()
            }
            _ => T::zero(),
        })
    })
}
