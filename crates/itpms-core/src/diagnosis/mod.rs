//! The health of the sensors, from their raw values alone: each by itself, and all against the car that they sit on.
//!
//! Called by the monitor with every sample, before the estimator. Knows nothing of pressures. What can be found, how soon
//! and what cannot: docs/math/monitor.md, sections 2 to 4.
//!
//! | module | idea |
//! |---|---|
//! | `malfunction` | what can be wrong |
//! | `sensor_statistics` | running figures of one sensor |
//! | `single_sensor` | stuck, losing samples, spiking, noisy |
//! | `filters`, `signals`, `moments` | bands and their second moments |
//! | `matching` | which sensors follow which; whether the bodies are one plane |
//! | `cross_sensor`, `fault_latch` | swapped sensors, a body sensor's wrong gain |
//! | `wheel_gain` | a wheel sensor's wrong gain |
//! | `standstill` | a speed of zero while wheels roll |
//! | `decorrelation` | roads that front and rear have just stopped sharing |
//! | `debounce` | debouncing and hysteresis |
//! | `tuning` | thresholds, times and lengths of averages |

pub(crate) mod cross_sensor;
pub(crate) mod debounce;
pub(crate) mod decorrelation;
mod fault_latch;
mod filters;
pub(crate) mod malfunction;
mod matching;
mod moments;
mod sensor_statistics;
mod signals;
mod single_sensor;
pub(crate) mod standstill;
mod tuning;
mod wheel_gain;

pub use self::debounce::DebounceTimes;
pub use self::malfunction::{Malfunction, Place, Sensor};
pub use self::tuning::Tuning;
use crate::conditioning::pauses::PAUSE_S;
use crate::diagnosis::cross_sensor::CrossSensorPlausibility;
use crate::diagnosis::debounce::Debouncer;
use crate::diagnosis::matching::{gathered, median, over_others};
use crate::diagnosis::sensor_statistics::SensorBlock;
use crate::diagnosis::signals::{Block, Signals, width_hz};
use crate::diagnosis::single_sensor::SingleSensorMonitor;
use crate::memory::Blank;
use crate::model::{CarConfig, Corner, CornerConfig, CornerSample, HOP_BAND_HZ, Wheels};
use crate::real::Real;

/// Seconds between two looks at what the sensors did: accelerations, or wheel speeds.
pub(crate) const BLOCK_S: f64 = 0.5;

#[derive(Debug, Clone, Copy, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Fault<T> {
    pub(crate) malfunction: Malfunction<T>,
    pub(crate) since_s: f64,
    pub(crate) reported_s: f64,
}

impl<T> Fault<T> {
    fn from_debouncer(debouncer: &Debouncer, malfunction: Malfunction<T>) -> Self {
        Self { malfunction, since_s: debouncer.since_s(), reported_s: debouncer.reported_s() }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Motion {
    Standing,
    Moving,
}

/// The sensors of a car under watch.
#[derive(Debug, Clone, PartialEq, Blank)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Diagnosis<T: Real> {
    period_s: f64,
    noise_power: [T; 4],
    present: [bool; 4],
    /// Of the bodies, then of the wheels.
    sensors: [[SingleSensorMonitor<T>; 4]; 2],
    signals: Signals<T>,
    cross_sensor: CrossSensorPlausibility<T>,
    slowest_m_s: T,
    last_s: f64,
    block_from_s: f64,
    /// From when on a sample ends the block.
    block_ends_s: f64,
    /// Blocks since something was wrong with a sensor by itself.
    calm_blocks: u32,
    /// Blocks of which something was wrong with a sensor by itself, in a row.
    rough_blocks: u32,
    /// Whether a block has ended since it was last asked.
    news: bool,
}

impl<T: Real> Diagnosis<T> {
    pub(crate) fn configure(&mut self, car: &CarConfig<T>, rate_hz: f64, tuning: &Tuning) {
        let noise = |corner: &Option<CornerConfig<T>>| {
            let noise = corner.as_ref().map_or(T::zero(), CornerConfig::accel_noise_or_usual_m_s2);
            noise * noise
        };
        let noise_power = car.corners.each_ref().map(noise);
        (self.period_s, self.noise_power) = (1.0 / rate_hz, noise_power);
        self.present = car.corners.each_ref().map(Option::is_some);
        let sensor = SingleSensorMonitor::new(1.0 / rate_hz, tuning);
        self.sensors.iter_mut().for_each(|sensors| sensors.fill(sensor));
        self.signals.configure(car, rate_hz);
        self.cross_sensor.configure(noise_power, rate_hz);
        self.slowest_m_s = T::lit(f64::NAN);
        self.last_s = f64::NEG_INFINITY;
        self.begin_block(f64::NAN);
        (self.calm_blocks, self.rough_blocks) = (0, 0);
        self.news = false;
    }

    fn begin_block(&mut self, time_s: f64) {
        (self.block_from_s, self.block_ends_s) = (time_s, time_s + BLOCK_S - 0.5 * self.period_s);
    }

    /// Takes a sample of a clock that does not go back.
    #[inline(never)]
    pub(crate) fn push(
        &mut self,
        time_s: f64,
        speed_m_s: T,
        corners: &[Option<CornerSample<T>>; 4],
        tuning: &Tuning,
    ) {
        let step_s = time_s - self.last_s;
        if step_s <= 0.0 {
            return; // The same sample again; the intake counts it.
        }
        self.last_s = time_s;
        if !(step_s < PAUSE_S) {
            // Blocks end a sample after pressures are weighed: both are much work.
            self.begin_block(time_s + self.period_s);
            self.calm_blocks = 0;
            self.slowest_m_s = speed_m_s;
        }
        if step_s > tuning.longest_step * self.period_s {
            self.sensors.iter_mut().flatten().for_each(SingleSensorMonitor::interrupted);
        }
        let nothing = [T::lit(f64::NAN); 2];
        let spike = [tuning.spike_m_s2, tuning.spike_over_usual].map(T::lit);
        let mut values = [T::zero(); 8];
        let [bodies, wheels] = &mut self.sensors;
        for (i, corner) in corners.iter().enumerate().filter(|(i, _)| self.present[*i]) {
            let [body, wheel] = corner.map_or(nothing, |c| [c.body_accel_m_s2, c.wheel_accel_m_s2]);
            values[i] = bodies[i].push(time_s, body, spike);
            values[4 + i] = wheels[i].push(time_s, wheel, spike);
        }
        self.signals.push(&values);
        if !(self.slowest_m_s <= speed_m_s) {
            self.slowest_m_s = speed_m_s;
        }
        if time_s >= self.block_ends_s {
            self.end_block(time_s, time_s - self.block_from_s, tuning);
            self.begin_block(time_s);
            self.slowest_m_s = speed_m_s;
        }
    }

    /// True once after every block: then faults and suspects may be others.
    pub(crate) fn take_news(&mut self) -> bool {
        core::mem::take(&mut self.news)
    }

    fn end_block(&mut self, time_s: f64, step_s: f64, tuning: &Tuning) {
        self.news = true;
        let motion = self.motion(time_s, tuning);
        let present = self.present;
        let blocks = self.sensors.each_mut().map(|sensors| {
            Corner::ALL.map(|i| present[i].then(|| sensors[i].end_block(time_s, step_s, motion, tuning)))
        });
        let Some(block) = self.signals.end_block() else { return };
        let alive = Corner::ALL.map(|i| present[i] && self.sensors.iter().all(|of| of[i].is_alive()));
        // An unknown speed passes: there is power in the bands, or nothing is concluded.
        let driving = !(self.slowest_m_s < T::lit(tuning.driving_m_s));
        let alive = if driving { alive } else { [false; 4] };
        self.cross_sensor.compare_wheel_and_body([time_s, step_s], &block, alive, tuning);
        self.judge_noise([time_s, step_s], &blocks, &block, tuning);
        let few =
            |block: &Option<SensorBlock<T>>| block.is_none_or(|b| b.missing < T::lit(tuning.few_missing));
        let calm =
            present == [true; 4] && !self.sensors.iter().flatten().any(SingleSensorMonitor::is_suspected);
        let calm = calm && blocks.iter().flatten().all(few);
        if calm {
            (self.calm_blocks, self.rough_blocks) =
                (self.calm_blocks.min(tuning.settling_blocks).saturating_add(1), 0);
        } else {
            (self.calm_blocks, self.rough_blocks) = (0, self.rough_blocks.saturating_add(1));
        }
        if self.rough_blocks == tuning.dropping_blocks {
            self.cross_sensor.drop_suspicions();
        }
        if driving && self.calm_blocks > tuning.settling_blocks {
            self.cross_sensor.take([time_s, step_s], &block, tuning);
        }
        if self.slowest_m_s < T::lit(tuning.standing_m_s) {
            self.cross_sensor.stand(time_s);
        }
        if calm {
            let settled = driving && self.calm_blocks > tuning.settling_blocks;
            self.cross_sensor.judge_wheel_gains([time_s, step_s], &block, settled, tuning);
        }
    }

    /// Whether the car moves. Where its speed is unknown most sensors say so: coarsely rounded, those of a parked car hardly
    /// change, and are not stuck.
    fn motion(&self, time_s: f64, tuning: &Tuning) -> Motion {
        let moving = if self.slowest_m_s.is_finite() {
            self.slowest_m_s >= T::lit(tuning.moving_m_s)
        } else {
            let sensors = self.sensors.iter().flat_map(|sensors| sensors.iter().zip(self.present));
            let present = sensors.filter(|(_, present)| *present);
            2 * present.clone().filter(|(sensor, _)| sensor.changes(time_s, tuning)).count() > present.count()
        };
        if moving { Motion::Moving } else { Motion::Standing }
    }

    /// Noise against that of the same sensors at the other corners; not where body and wheel may be swapped, as each would then be compared
    /// with sensors of the other kind. A sensor that reads more of everything has a wrong gain: noise is what is more than wheel hop is
    /// more. Where its noise is all there is in the hop band, as on a smooth road, that band says nothing of either.
    fn judge_noise(
        &mut self,
        [time_s, step_s]: [f64; 2],
        blocks: &[[Option<SensorBlock<T>>; 4]; 2],
        block: &Block<T>,
        tuning: &Tuning,
    ) {
        let hop = [[0, 1, 2, 3].map(|i| block.hop[(i, i)]), block.wheel_hop];
        let white = T::lit(tuning.white_at_most * width_hz(HOP_BAND_HZ) * 2.0 * self.period_s);
        for ((sensors, blocks), hop) in self.sensors.iter_mut().zip(blocks).zip(&hop) {
            for corner in Corner::ALL.into_iter().filter(|&corner| self.present[corner]) {
                let noise = noise_powers(blocks, corner, self.noise_power[corner]);
                let powers = noise.and_then(|[own, alike]| match !(hop[corner] < own * white) {
                    false => Some([own, alike]),
                    true if self.cross_sensor.is_odd(corner, tuning) => None,
                    true => Some([own, alike * over_others(hop, corner).max(T::one())]),
                });
                sensors[corner].compare_noise(time_s, step_s, powers, tuning);
            }
        }
    }

    /// Faults by the corner they are reported at: the worst of each.
    pub(crate) fn faults(&self) -> [Option<Fault<T>>; 4] {
        let cross_sensor = self.cross_sensor.faults();
        let [bodies, wheels] = &self.sensors;
        Corner::ALL.map(|corner| {
            let sensor = |place| Sensor { corner, place };
            let wheel = wheels[corner].fault(sensor(Place::Wheel));
            wheel.or_else(|| bodies[corner].fault(sensor(Place::Body))).or(cross_sensor[corner])
        })
    }

    /// The corners among them that were learned from for seconds before that showed.
    pub(crate) fn late_detection(&self) -> Wheels {
        self.cross_sensor.late_detection()
    }

    /// The corners not to be learned from now.
    pub(crate) fn suspects(&self, tuning: &Tuning) -> Wheels {
        let alone = Corner::ALL.into_iter().filter(|&corner| {
            self.present[corner] && self.sensors.iter().any(|sensors| sensors[corner].is_suspected())
        });
        alone.collect::<Wheels>() | self.cross_sensor.suspects(tuning)
    }

    /// The corners that may be among these in a moment.
    pub(crate) fn pending_fault(&self) -> Wheels {
        self.cross_sensor.pending_fault()
    }
}

/// A sensor's noise power, and the median of the same sensors at the other corners plus the noise of the vehicle file.
fn noise_powers<T: Real>(blocks: &[Option<SensorBlock<T>>; 4], corner: Corner, of_file: T) -> Option<[T; 2]> {
    let own = blocks[corner]?.floor?;
    let mut alike = [T::zero(); 4];
    let alike = gathered(corner.others().into_iter().filter_map(|other| blocks[other]?.floor), &mut alike);
    (alike.len() >= 2).then(|| [own, median(alike) + of_file])
}
