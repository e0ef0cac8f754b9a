//! Statistics of a log, row by row: how long and how fast the car drives, where it stands, and what each accelerometer reads then.

use itpms_core::model::Corner;
use itpms_data::LogRow;

use super::pressures::KnownStretch;

/// Speed in m/s from which the car drives: below, neither method reads a tire.
const DRIVING_M_S: f64 = 5.0;
/// Speed in m/s up to which it stands: GPS shows some tenths of a standing car, a bus nothing below 0.5.
const STANDING_M_S: f64 = 0.5;
/// Seconds of standing that are a stop, and of silence that are a pause of the logger: long enough to tell what sensors read at rest.
const STOP_S: f64 = 10.0;
/// Seconds over which a sensor's noise at rest is taken.
const BLOCK_S: f64 = 2.0;
/// Longest step in s that counts as driven.
const STEP_S: f64 = 0.5;

/// When the car stood, or the log was silent, in s since its first row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stop {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums([f64; 3]);

impl Sums {
    fn take(&mut self, value: f64) {
        if value.is_finite() {
            let Self([count, sum, squares]) = self;
            (*count, *sum, *squares) = (*count + 1.0, *sum + value, *squares + value * value);
        }
    }

    fn mean(&self) -> Option<f64> {
        let [count, sum, _] = self.0;
        (count > 0.0).then(|| sum / count)
    }

    fn rms(&self) -> Option<f64> {
        let [count, sum, squares] = self.0;
        (count > 1.0).then(|| ((squares - sum * sum / count) / count).max(0.0).sqrt())
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Sensor {
    driving: Sums,
    standing: Sums,
    block: Sums,
    quietest: Option<f64>,
}

/// An accelerometer's reading in m/s².
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    pub(super) rest_mean: f64,
    /// Rms in the quietest two seconds of standing.
    pub(super) rest_rms: f64,
    pub(super) driving_rms: f64,
}

#[derive(Debug)]
pub(super) struct LogWatch {
    stretches: Vec<KnownStretch>,
    pub(super) driven_s: Vec<f64>,
    /// Speed in m/s where each stretch begins.
    speed_at: Vec<f64>,
    /// Number and sum of the readings in kPa of each tire's own sensor in each stretch.
    sent: Vec<[Sums; 4]>,
    fastest_m_s: f64,
    distance_m: f64,
    first_s: Option<f64>,
    last_s: f64,
    standing_since: Option<f64>,
    block_since: f64,
    pub(super) stops: Vec<Stop>,
    sensors: [[Sensor; 2]; 4],
    pub(super) speed_known: bool,
}

impl LogWatch {
    pub(super) fn new(stretches: &[KnownStretch]) -> Self {
        let count = stretches.len().max(1);
        Self {
            stretches: stretches.to_vec(),
            driven_s: vec![0.0; count],
            speed_at: vec![f64::NAN; count],
            sent: vec![[Sums::default(); 4]; count],
            fastest_m_s: 0.0,
            distance_m: 0.0,
            first_s: None,
            last_s: 0.0,
            standing_since: None,
            block_since: 0.0,
            stops: Vec::new(),
            sensors: Default::default(),
            speed_known: false,
        }
    }

    pub(super) fn since_start_s(&mut self, row: &LogRow) -> f64 {
        row.time_s - *self.first_s.get_or_insert(row.time_s)
    }

    /// Takes a row; `radius_m` is what makes speeds of wheels of their rotation.
    pub(super) fn take(&mut self, row: &LogRow, radius_m: f64) {
        let now_s = self.since_start_s(row);
        let step_s = now_s - self.last_s;
        if step_s > STOP_S {
            self.end_stop();
            self.stops.push(Stop { from_s: self.last_s, to_s: now_s });
        }
        self.last_s = now_s;
        let wheels = row.motion.sample(row.time_s, radius_m).wheel_speed_m_s;
        let by_wheels = 0.25 * wheels.iter().sum::<f64>();
        let speed = if row.speed_m_s.is_finite() { row.speed_m_s } else { by_wheels };
        self.speed_known |= speed.is_finite();
        let stretch = self.stretches.iter().rposition(|stretch| stretch.from_s <= now_s).unwrap_or(0);
        if self.speed_at[stretch].is_nan() {
            self.speed_at[stretch] = speed;
        }
        for (sums, kpa) in self.sent[stretch].iter_mut().zip(row.motion.tire_sensor_kpa) {
            sums.take(kpa);
        }
        if speed > DRIVING_M_S {
            let step_s = step_s.min(STEP_S);
            self.driven_s[stretch] += step_s;
            self.distance_m += speed * step_s;
            self.fastest_m_s = self.fastest_m_s.max(speed);
        }
        if !(speed < STANDING_M_S) {
            self.end_stop();
        } else if self.standing_since.is_none() {
            (self.standing_since, self.block_since) = (Some(now_s), now_s);
        }
        self.take_accelerations(row, now_s, speed > DRIVING_M_S);
    }

    fn take_accelerations(&mut self, row: &LogRow, now_s: f64, drives: bool) {
        let standing = self.standing_since.is_some();
        let block_ends = standing && now_s - self.block_since >= BLOCK_S;
        for (sensors, corner) in self.sensors.iter_mut().zip(&row.corners) {
            let Some(corner) = corner else { continue };
            for (sensor, value) in sensors.iter_mut().zip([corner.body_accel_m_s2, corner.wheel_accel_m_s2]) {
                if drives {
                    sensor.driving.take(value);
                }
                if standing {
                    sensor.standing.take(value);
                    sensor.block.take(value);
                }
                if block_ends {
                    let rms = std::mem::take(&mut sensor.block).rms();
                    sensor.quietest = [sensor.quietest, rms].into_iter().flatten().reduce(f64::min);
                }
            }
        }
        if block_ends {
            self.block_since = now_s;
        }
    }

    fn end_stop(&mut self) {
        if let Some(from_s) = self.standing_since.take()
            && self.last_s - from_s >= STOP_S
        {
            self.stops.push(Stop { from_s, to_s: self.last_s });
        }
        for sensor in self.sensors.iter_mut().flatten() {
            sensor.block = Sums::default();
        }
    }

    pub(super) fn finish(&mut self) {
        self.end_stop();
    }

    pub(super) fn length_s(&self) -> f64 {
        self.last_s
    }

    /// Mean while driving, and the fastest, in m/s.
    pub(super) fn speeds_m_s(&self) -> [f64; 2] {
        [self.distance_m / self.driven_s.iter().sum::<f64>(), self.fastest_m_s]
    }

    /// Speed in m/s where a stretch begins; NaN where it is unknown or the log has ended before.
    pub(super) fn speed_at(&self, stretch: usize) -> f64 {
        self.speed_at[stretch]
    }

    /// Mean reading in kPa of a tire's own sensor in a stretch.
    pub(super) fn sent_kpa(&self, stretch: usize, corner: Corner) -> Option<f64> {
        self.sent[stretch][corner.index()].mean()
    }

    /// Body and wheel sensor of a corner, as far as the car has stood and driven.
    pub(super) fn reading(&self, corner: Corner) -> [Option<Reading>; 2] {
        self.sensors[corner.index()].map(|sensor| {
            Some(Reading {
                rest_mean: sensor.standing.mean()?,
                rest_rms: sensor.quietest?,
                driving_rms: sensor.driving.rms()?,
            })
        })
    }
}
