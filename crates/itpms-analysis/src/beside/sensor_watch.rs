//! The tires' own sensors watched through a drive: a slow leak that they see, and a sensor whose pressure goes where its tire's does not.
//!
//! Since its first readings a sensor's reading has changed by `D`, the estimate by `E`, each less the median change of the other wheels with a
//! sensor, so that warmth cancels. `D - E` is nothing but noise while a sensor is right, however the tire fares; where it is not, the
//! sensor drifts, or has stuck while its tire went on; so does one that rises, since a tire gains no air while it rolls. A loss that the estimate does not deny is a leak: the pressure at 20 C, by the sensor's
//! own temperature, falls along a line. What levels say of each other is the report's ([`crate::report`]).

mod watched_sensor;

use itpms_core::model::Corner;
use itpms_core::wheel_speed::WheelRadius;
use itpms_data::LogRow;
use itpms_data::out::RadiusRow;

pub(super) use self::watched_sensor::sensors_json;
pub use self::watched_sensor::{SensorState, WatchedSensor};
use super::Estimates;

/// Readings of so many s count as one.
const BIN_S: f64 = 10.0;
/// Bins between two looks, and bins that are kept: a day.
const LOOK_BINS: usize = 6;
const MOST_BINS: usize = 8640;
/// Readings that a first value is the mean of.
const FIRST: usize = 3;
/// Readings by which something is known, and s that they span.
const FEWEST: usize = 8;
const LEAST_S: f64 = 300.0;
/// Standard deviations from which on a sensor is wrong or a tire leaks, and looks in a row for which they have to be.
const SDS: f64 = 4.0;
const LOOKS: u32 = 2;
/// A first estimate may have so many times the standard deviation of the last.
const AS_GOOD: f64 = 1.5;
/// Sd of the change that a working sensor reads, in kPa and as a share of its pressure.
const SENSOR_KPA: f64 = 1.5;
const SENSOR_SHARE: f64 = 0.005;
/// A loss is worth naming from this share of the absolute pressure on, and from so many steps of the sensor.
const LEAST_LOSS: f64 = 0.015;
const LEAST_STEPS: f64 = 2.0;
/// Share of the smallest loss that would have shown by wheel speeds that an unseen one has as its standard deviation: what would have shown is
/// `SDS` of it.
const UNSEEN_SD: f64 = 1.0 / SDS;
/// Whoever stands for so many s may have filled a tire; below this speed in m/s a car stands.
const FILLING_S: f64 = 60.0;
const STANDING_M_S: f64 = 1.0;
/// What warmth moves, in kPa and in steps of the sensor, where a pressure that does not move is none.
const STUCK_KPA: f64 = 8.0;
const STUCK_STEPS: f64 = 3.0;
/// Usual pressure of the air in kPa, and 20 and 0 degrees Celsius in K.
const AIR_KPA: f64 = 101.3;
const WARM_K: f64 = 293.15;
const ZERO_K: f64 = 273.15;

/// The mean of one wheel's readings in a bin.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum_kpa: f64,
    sum_c: f64,
    counts: [u32; 2],
}

/// One wheel in one bin.
#[derive(Debug, Clone, Copy)]
struct Reading {
    time_s: f64,
    kpa: f64,
    /// The same at 20 C where the sensor has a temperature.
    at_20_kpa: f64,
    /// The estimate of the pressure, or less what was lost, and its standard deviation; NaN: none.
    estimate_kpa: [f64; 2],
}

#[derive(Debug, Clone, Default)]
struct Wheel {
    placard_kpa: f64,
    mean: Mean,
    last_c: f64,
    /// Bounds of its readings, and their smallest step.
    step_kpa: f64,
    last_kpa: f64,
    readings: Vec<Reading>,
    /// State that has been seen in so many looks in a row, and what is reported.
    pending: (SensorState, u32),
    now: Option<WatchedSensor>,
}

#[derive(Debug, Clone)]
pub(super) struct SensorWatch {
    wheels: [Wheel; 4],
    bin: Option<f64>,
    bins: usize,
    air_kpa: f64,
    /// When it rolled last, and when it last stood for long.
    rolled_s: f64,
    stood_s: f64,
}

impl SensorWatch {
    pub(super) fn new(placards_kpa: [Option<f64>; 4]) -> Self {
        let wheel = |placard_kpa: Option<f64>| Wheel {
            placard_kpa: placard_kpa.unwrap_or(f64::NAN),
            last_c: f64::NAN,
            step_kpa: f64::INFINITY,
            last_kpa: f64::NAN,
            ..Wheel::default()
        };
        let (rolled_s, stood_s) = (f64::NAN, f64::NEG_INFINITY);
        Self { wheels: placards_kpa.map(wheel), bin: None, bins: 0, air_kpa: AIR_KPA, rolled_s, stood_s }
    }

    /// Takes a row and what was estimated after it; hands on what is newly found.
    pub(super) fn take(
        &mut self,
        row: &LogRow,
        estimates: &Estimates,
        radii: Option<&RadiusRow>,
        mut found: impl FnMut(Corner, &WatchedSensor),
    ) {
        let barometric_kpa = row.motion.air.plausible().barometric_kpa;
        if barometric_kpa.is_finite() {
            self.air_kpa = barometric_kpa;
        }
        self.roll(row);
        let sent = row.motion.tire_sensor_kpa.into_iter().zip(row.motion.tire_sensor_c);
        let mut any = false;
        for (wheel, (kpa, c)) in self.wheels.iter_mut().zip(sent) {
            any |= wheel.send(kpa, c);
        }
        if self.bin.is_none() && !any {
            return;
        }
        let begun_s = *self.bin.get_or_insert(row.time_s);
        if row.time_s - begun_s < BIN_S {
            return;
        }
        self.bin = Some(row.time_s);
        if self.bins >= MOST_BINS {
            return;
        }
        self.bins += 1;
        for (place, wheel) in self.wheels.iter_mut().enumerate() {
            let estimate_kpa = estimated(
                wheel.placard_kpa,
                estimates[place].as_ref(),
                radii.map(|row| &row.radii.wheels[place]),
            );
            wheel.close(begun_s + 0.5 * BIN_S, self.air_kpa, estimate_kpa);
        }
        if self.bins.is_multiple_of(LOOK_BINS) {
            self.look(row.time_s, &mut found);
        }
    }

    /// Whether the car rolls, by its speed or by a wheel's.
    fn roll(&mut self, row: &LogRow) {
        let [wheel_m_s, ..] = row.motion.wheel_speed_m_s;
        let speed_m_s = if row.speed_m_s.is_nan() { wheel_m_s } else { row.speed_m_s };
        if self.rolled_s.is_nan() || row.time_s - self.rolled_s > FILLING_S {
            self.stood_s = row.time_s;
        }
        if speed_m_s > STANDING_M_S {
            self.rolled_s = row.time_s;
        }
    }

    /// All that is known at the end.
    pub(super) fn conclude(&self) -> [WatchedSensor; 4] {
        self.wheels.each_ref().map(|wheel| {
            wheel.now.unwrap_or(WatchedSensor { pressure_kpa: wheel.last_kpa, ..WatchedSensor::NOTHING })
        })
    }

    fn look(&mut self, time_s: f64, found: &mut impl FnMut(Corner, &WatchedSensor)) {
        let judged = [0, 1, 2, 3].map(|place| self.judge(place));
        for ((corner, wheel), judged) in Corner::ALL.into_iter().zip(&mut self.wheels).zip(judged) {
            let Some(mut sensor) = judged else { continue };
            let bad = |state| !matches!(state, SensorState::Fine | SensorState::Learning);
            wheel.pending = if wheel.pending.0 == sensor.state {
                (sensor.state, wheel.pending.1 + 1)
            } else {
                (sensor.state, 1)
            };
            let before = wheel.now.map_or(SensorState::Learning, |now| now.state);
            // A finding stays, unless it turns out to be another one: tires do not heal during a drive.
            if bad(sensor.state) && wheel.pending.1 < LOOKS || bad(before) && !bad(sensor.state) {
                sensor.state = before;
            }
            sensor.since_s =
                wheel.now.filter(|now| now.state == sensor.state).map_or(time_s, |now| now.since_s);
            wheel.now = Some(sensor);
            if bad(sensor.state) && sensor.state != before {
                found(corner, &sensor);
            }
        }
    }

    /// The median of the other wheels' changes until a time; nothing where fewer than two are known.
    fn others(&self, place: usize, time_s: f64, change: Change<'_>) -> f64 {
        let changed = |wheel: &Wheel| {
            let after = wheel.readings.partition_point(|reading| reading.time_s <= time_s + 3.0 * BIN_S);
            let last = wheel.readings[..after].last().filter(|_| wheel.readings.len() >= FEWEST)?;
            Some(change(&wheel.readings, last)).filter(|change| change.is_finite())
        };
        let others = self.wheels.iter().enumerate().filter(|(other, _)| *other != place);
        let mut changes: Vec<f64> = others.filter_map(|(_, wheel)| changed(wheel)).collect();
        changes.sort_by(f64::total_cmp);
        let middle = changes.len() / 2;
        match changes.len() {
            0 | 1 => 0.0,
            n if n % 2 == 1 => changes[middle],
            _ => 0.5 * (changes[middle - 1] + changes[middle]),
        }
    }

    /// From when on estimates are compared: from where all wheels' are as good, nearly, as they are now.
    fn compared_from_s(&self) -> f64 {
        let good = |wheel: &Wheel| {
            let last_sd = wheel.readings.last()?.estimate_kpa[1];
            wheel
                .readings
                .iter()
                .find(|reading| reading.estimate_kpa[1] <= AS_GOOD * last_sd)
                .map(|reading| reading.time_s)
        };
        self.wheels.iter().filter_map(good).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The smallest step of the sensors; they are of one make.
    fn step_kpa(&self) -> f64 {
        let step_kpa = self.wheels.iter().map(|wheel| wheel.step_kpa).fold(f64::INFINITY, f64::min);
        if step_kpa.is_finite() { step_kpa } else { 1.0 }
    }

    fn judge(&self, place: usize) -> Option<WatchedSensor> {
        let wheel = &self.wheels[place];
        let (first, last) = (wheel.readings.first()?, wheel.readings.last()?);
        let span_s = last.time_s - first.time_s;
        if wheel.readings.len() < FEWEST || !(span_s >= LEAST_S) {
            return None;
        }
        let step_kpa = self.step_kpa();
        let own_sd_kpa = SENSOR_KPA.hypot(SENSOR_SHARE * last.kpa).hypot(0.3 * step_kpa);
        let recent = &wheel.readings[wheel.readings.len() - FIRST..];
        let from_s = self.compared_from_s();
        let against = |readings: &[Reading], reading: &Reading| {
            let of = |reading: &Reading| reading.kpa - reading.estimate_kpa[0];
            of(reading)
                - first_mean(&readings[readings.partition_point(|reading| reading.time_s < from_s)..], of)
        };
        let each = |reading: &Reading| {
            against(&wheel.readings, reading) - self.others(place, reading.time_s, &against)
        };
        let value = recent.iter().map(each).sum::<f64>() / FIRST as f64;
        let before = wheel.readings.iter().find(|reading| reading.time_s >= from_s)?.estimate_kpa[1];
        let against_estimate_kpa = [value, before.max(last.estimate_kpa[1]).hypot(own_sd_kpa)];
        // A line through the pressure at 20 C; what a line does not explain is correlated, and its sd is no better than the sensor's own.
        let points: Vec<[f64; 2]> = wheel
            .readings
            .iter()
            .map(|reading| {
                [
                    reading.time_s - first.time_s,
                    at_20(&wheel.readings, reading) - self.others(place, reading.time_s, &at_20),
                ]
            })
            .collect();
        let (slope, slope_sd) = line(&points, own_sd_kpa)?;
        let lost_kpa = [-slope * span_s, slope_sd * span_s];
        // Since it was last filled, perhaps; a brake warms a tire, which only temperatures tell.
        let rolling = &points[wheel.readings.partition_point(|reading| reading.time_s < self.stood_s)..];
        let rolled_s = rolling.first().map_or(0.0, |begun| span_s - begun[0]);
        let warmth_known =
            self.wheels.iter().all(|wheel| wheel.readings.is_empty() || wheel.last_c.is_finite());
        let long = rolling.len() >= FEWEST && rolled_s >= LEAST_S;
        let rise = line(rolling, own_sd_kpa).filter(|_| long && warmth_known);
        let rise_kpa = rise.map_or([f64::NAN; 2], |(slope, sd)| [slope * rolled_s, sd * rolled_s]);
        let [value, sd] = against_estimate_kpa;
        let is_wrong = value.abs() > SDS * sd;
        // Warmer air in a tire moves the pressure, unless a leak takes as much at every moment.
        let is_same = |reading: &Reading| (reading.kpa - last.kpa).abs() < 0.05;
        let late = wheel.readings.iter().filter(|reading| reading.time_s - first.time_s >= 0.5 * span_s);
        let still = late.clone().all(is_same);
        let warmth = |reading: &Reading| {
            let own = reading.kpa - reading.at_20_kpa - (first.kpa - first.at_20_kpa);
            if own == 0.0 { self.others(place, reading.time_s, &raw) } else { own }
        };
        let warmed_kpa = wheel.readings.iter().map(|reading| warmth(reading).abs()).fold(0.0, f64::max);
        let never_moved = wheel.readings.iter().all(is_same);
        let stuck = never_moved && warmed_kpa > STUCK_KPA.max(STUCK_STEPS * step_kpa);
        let least_kpa = (LEAST_LOSS * (last.kpa + self.air_kpa)).max(LEAST_STEPS * step_kpa);
        let state = match (is_wrong, still) {
            _ if stuck => SensorState::Stuck,
            (true, true) => SensorState::Stuck,
            (true, false) => SensorState::Drift,
            _ if rise_kpa[0] > least_kpa && rise_kpa[0] > SDS * rise_kpa[1] => SensorState::Drift,
            _ if !never_moved && lost_kpa[0] > least_kpa && lost_kpa[0] > SDS * lost_kpa[1] => {
                SensorState::Leak
            }
            _ => SensorState::Fine,
        };
        let lost_kpa_per_h = lost_kpa.map(|kpa| kpa * 3600.0 / span_s);
        Some(WatchedSensor {
            state,
            pressure_kpa: wheel.last_kpa,
            lost_kpa,
            lost_kpa_per_h,
            against_estimate_kpa,
            since_s: f64::NAN,
        })
    }
}

impl Wheel {
    /// Takes what was sent in a row; whether anything was.
    fn send(&mut self, kpa: f64, c: f64) -> bool {
        if c.is_finite() {
            self.mean.sum_c += c;
            self.mean.counts[1] += 1;
        }
        // A sleeping sensor sends zero, or the end of its range.
        if !(kpa > 0.3 * self.placard_kpa && kpa < 2.0 * self.placard_kpa) {
            return false;
        }
        let step = (kpa - self.last_kpa).abs();
        if step > 0.05 && step < self.step_kpa {
            self.step_kpa = step;
        }
        self.last_kpa = kpa;
        self.mean.sum_kpa += kpa;
        self.mean.counts[0] += 1;
        true
    }

    fn close(&mut self, time_s: f64, air_kpa: f64, estimate_kpa: [f64; 2]) {
        let Mean { sum_kpa, sum_c, counts: [of_kpa, of_c] } = std::mem::take(&mut self.mean);
        if of_c > 0 {
            self.last_c = sum_c / f64::from(of_c);
        }
        if of_kpa == 0 {
            return;
        }
        let kpa = sum_kpa / f64::from(of_kpa);
        let warm = self.last_c + ZERO_K;
        let at_20_kpa = if warm.is_finite() { (kpa + air_kpa) * WARM_K / warm - air_kpa } else { kpa };
        self.readings.push(Reading { time_s, kpa, at_20_kpa, estimate_kpa });
    }
}

/// By how much a wheel changed from its first readings to this one.
type Change<'a> = &'a dyn Fn(&[Reading], &Reading) -> f64;

/// The mean of a wheel's first readings.
fn first_mean(readings: &[Reading], of: impl Fn(&Reading) -> f64) -> f64 {
    let known = readings.iter().map(of).filter(|value| value.is_finite()).take(FIRST);
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// By how much what a sensor sends changed.
fn raw(readings: &[Reading], reading: &Reading) -> f64 {
    reading.kpa - first_mean(readings, |reading| reading.kpa)
}

/// By how much a sensor changed at 20 C.
fn at_20(readings: &[Reading], reading: &Reading) -> f64 {
    reading.at_20_kpa - first_mean(readings, |reading| reading.at_20_kpa)
}

/// Slope of a line through points, and its standard deviation: of independent noise, and no less than one sd at either end.
fn line(points: &[[f64; 2]], own_sd: f64) -> Option<(f64, f64)> {
    let n = points.len() as f64;
    let mean = [0, 1].map(|of| points.iter().map(|point| point[of]).sum::<f64>() / n);
    let sum = |f: fn(f64, f64) -> f64| points.iter().map(|[x, y]| f(x - mean[0], y - mean[1])).sum::<f64>();
    let (xx, xy) = (sum(|x, _| x * x), sum(|x, y| x * y));
    let slope = xy / xx;
    let rest =
        points.iter().map(|[x, y]| (y - mean[1] - slope * (x - mean[0])).powi(2)).sum::<f64>() / (n - 2.0);
    let span = points.last()?[0] - points.first()?[0];
    let sd = (rest / xx).sqrt().hypot(own_sd / span);
    (slope.is_finite() && sd.is_finite()).then_some((slope, sd))
}

/// The estimate compared with a sensor: the pressure with the sd of its change, else less the loss by wheel speeds.
fn estimated(
    placard_kpa: f64,
    corner: Option<&itpms_core::model::CornerEstimate<f64>>,
    radius: Option<&WheelRadius<f64>>,
) -> [f64; 2] {
    let unknown = [f64::NAN; 2];
    if let Some(corner) = corner.filter(|corner| corner.validity.is_valid()) {
        return [corner.pressure_kpa, corner.change_sd_kpa];
    }
    radius.filter(|_| corner.is_none()).map_or(unknown, |radius| {
        let sd = radius.lost_share_sd.max(UNSEEN_SD * radius.detectable_loss_share);
        [-radius.lost_share * placard_kpa, sd * placard_kpa]
    })
}

#[cfg(test)]
mod tests {
    use itpms_data::log::LogMotion;

    use super::*;

    /// The states at the end, and what was found on the way, of a drive of half an hour in which tires warm up by 20 K and stand for so many
    /// seconds in its middle; the front left sensor sends what `sent` makes of time and truth, the others send the truth.
    fn watched(standing_s: f64, sent: impl Fn(f64, f64) -> f64) -> ([SensorState; 4], Vec<SensorState>) {
        let mut watch = SensorWatch::new([Some(240.0); 4]);
        let mut found = Vec::new();
        for k in 0..1800 {
            let time_s = f64::from(k);
            let stands = (900.0..900.0 + standing_s).contains(&time_s);
            let warm_k = 20.0 * (1.0 - (-time_s / 600.0).exp());
            let truth = (240.0 + AIR_KPA) * (WARM_K + warm_k) / WARM_K - AIR_KPA;
            let mut motion = LogMotion::UNKNOWN;
            // One of the four every two seconds, in steps of 2.5 kPa.
            if k % 2 == 0 {
                let place = (k / 2 % 4) as usize;
                let kpa = if place == 0 { sent(time_s, truth) } else { truth };
                motion.tire_sensor_kpa[place] = (kpa / 2.5).round() * 2.5;
                motion.tire_sensor_c[place] = (20.0 + warm_k).round();
            }
            let row =
                LogRow { time_s, speed_m_s: if stands { 0.0 } else { 25.0 }, corners: [None; 4], motion };
            watch.take(&row, &[None; 4], None, |_, sensor| found.push(sensor.state));
        }
        (watch.conclude().map(|sensor| sensor.state), found)
    }

    #[test]
    fn a_sensor_that_rises_while_it_rolls_drifts_and_a_tire_that_is_filled_at_a_stop_is_fine() {
        use SensorState::{Drift, Fine, Leak};
        assert_eq!(watched(120.0, |_, truth| truth), ([Fine; 4], vec![]));
        let (states, found) = watched(120.0, |time_s, truth| truth + 30.0 * time_s / 1800.0);
        assert_eq!((states, found), ([Drift, Fine, Fine, Fine], vec![Drift]));
        let filled = |time_s: f64, truth: f64| if time_s > 950.0 { truth + 30.0 } else { truth };
        assert_eq!(watched(120.0, filled), ([Fine; 4], vec![]));
        // A tire is not filled at 90 km/h.
        assert_eq!(watched(0.0, filled).0[0], Drift);
        assert_eq!(
            watched(120.0, |time_s, truth| truth - 30.0 * time_s / 1800.0).0,
            [Leak, Fine, Fine, Fine]
        );
    }
}
