//! Faults of one sensor that show by themselves and from the same sensors at the other corners.

use crate::conditioning::pauses::MISSING_S;
use crate::diagnosis::debounce::{Debouncer, Evidence};
use crate::diagnosis::sensor_statistics::{SensorBlock, SensorWatch};
use crate::diagnosis::{Fault, Malfunction, Motion, Sensor, Tuning};
use crate::memory::Blank;
use crate::real::Real;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SingleSensorMonitor<T> {
    watch: SensorWatch<T>,
    stuck: Debouncer,
    dropout: Debouncer,
    spikes: Debouncer,
    noise: Debouncer,
    spike_count: f64,
    spike_s: f64,
    doubtful: Doubtful,
}

/// Whether the last block left a doubt that is not reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Doubtful {
    #[blank]
    No,
    Yes,
}

impl<T: Real> SingleSensorMonitor<T> {
    pub(crate) fn new(period_s: f64, tuning: &Tuning) -> Self {
        Self {
            watch: SensorWatch::new(period_s, tuning),
            stuck: Debouncer::new(),
            dropout: Debouncer::new(),
            spikes: Debouncer::new(),
            noise: Debouncer::new(),
            spike_count: 0.0,
            spike_s: f64::NEG_INFINITY,
            doubtful: Doubtful::No,
        }
    }

    /// Takes a value; gives it, or the last one in the place of a missing one.
    pub(crate) fn push(&mut self, time_s: f64, value: T, spike: [T; 2]) -> T {
        self.watch.push(time_s, value, spike)
    }

    /// Samples are not there: the next value does not follow the last one.
    pub(crate) fn interrupted(&mut self) {
        self.watch.interrupted();
    }

    pub(crate) fn changes(&self, time_s: f64, tuning: &Tuning) -> bool {
        self.watch.unchanged_s(time_s) < tuning.stuck_doubt_s
    }

    /// Ends a block and judges all but its noise.
    pub(crate) fn end_block(
        &mut self,
        time_s: f64,
        step_s: f64,
        motion: Motion,
        tuning: &Tuning,
    ) -> SensorBlock<T> {
        let block = self.watch.end_block(time_s);
        let unchanged_s = if block.complete { block.unchanged_s } else { 0.0 };
        let stuck = match motion {
            _ if !block.complete => Evidence::NoData,
            Motion::Moving if unchanged_s > MISSING_S => Evidence::Prefailed,
            _ if unchanged_s < tuning.stuck_doubt_s => Evidence::Prepassed,
            _ => Evidence::NoData,
        };
        self.stuck.update(time_s, step_s, stuck, tuning.stuck);
        let missing = block.missing.to_f64();
        let dropout = evidence(missing > tuning.many_missing, missing < tuning.few_missing);
        self.dropout.update(time_s, step_s, dropout, tuning.dropout);
        self.spike_count *= 1.0 - (step_s / tuning.spike_count_s).min(1.0);
        if block.spikes > 0 {
            self.spike_count += f64::from(block.spikes);
            self.spike_s = time_s;
        }
        let spikes = evidence(self.spike_count > tuning.many_spikes, block.spikes == 0);
        self.spikes.update(time_s, step_s, spikes, tuning.spikes);
        let still = motion == Motion::Moving && unchanged_s > tuning.stuck_doubt_s;
        let spiky = time_s - self.spike_s < tuning.spike_doubt_s;
        let doubtful = still || spiky || missing > tuning.many_missing;
        self.doubtful = if doubtful { Doubtful::Yes } else { Doubtful::No };
        block
    }

    /// Judges its noise against that of the same sensors at the other corners, both as powers; `None`: cannot be compared now.
    pub(crate) fn compare_noise(
        &mut self,
        time_s: f64,
        step_s: f64,
        powers: Option<[T; 2]>,
        tuning: &Tuning,
    ) {
        let noise = powers.map_or(Evidence::NoData, |[own, alike]| {
            let fine = tuning.hysteresis * tuning.noisy;
            evidence(own > T::lit(tuning.noisy) * alike, own < T::lit(fine) * alike)
        });
        self.noise.update(time_s, step_s, noise, tuning.compared);
    }

    /// Its fault, the most certain first.
    pub(crate) fn fault(&self, sensor: Sensor) -> Option<Fault<T>> {
        let latches = [
            (&self.dropout, Malfunction::Dropout(sensor)),
            (&self.stuck, Malfunction::Stuck(sensor)),
            (&self.spikes, Malfunction::Spikes(sensor)),
            (&self.noise, Malfunction::Noise(sensor)),
        ];
        let active = latches.into_iter().find(|(debouncer, _)| debouncer.is_active());
        active.map(|(debouncer, malfunction)| Fault::from_debouncer(debouncer, malfunction))
    }

    /// Whether it can be held against other sensors: it moves and its values come.
    pub(crate) fn is_alive(&self) -> bool {
        let latches = [&self.stuck, &self.dropout, &self.spikes];
        self.doubtful == Doubtful::No && !latches.iter().any(|debouncer| debouncer.is_suspected())
    }

    /// Whether its values may not be learned from, reported or not.
    pub(crate) fn is_suspected(&self) -> bool {
        let latches = [&self.stuck, &self.dropout, &self.spikes, &self.noise];
        self.doubtful == Doubtful::Yes || latches.iter().any(|debouncer| debouncer.is_suspected())
    }
}

/// What two conditions that exclude each other speak for.
pub(crate) fn evidence(for_it: bool, against_it: bool) -> Evidence {
    match (for_it, against_it) {
        (true, _) => Evidence::Prefailed,
        (false, true) => Evidence::Prepassed,
        (false, false) => Evidence::Undecided,
    }
}
