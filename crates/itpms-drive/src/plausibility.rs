//! Plausibility of a log's units and ranges: a speed and wheel speeds that differ by a factor, wheel speeds in coarse steps,
//! accelerations that are too small for any road or beyond their sensor's range. Fed with every row by [`run`](crate::run), asked at the end; knows nothing of tires.

use itpms_core::model::Corner;
use itpms_data::LogRow;

/// Speed in m/s from which rows count.
const DRIVING_M_S: f64 = 5.0;
/// Rows that are needed for a statement.
const LEAST_ROWS: f64 = 1000.0;
/// Wheel speeds over the car's that no slip and no radius explain, as the logarithm of their ratio.
const OFF: f64 = 0.2;
/// A wheel's speed over the others' that no tire explains, as the logarithm of their ratio.
const ODD_WHEEL: f64 = 0.03;
/// Steps in m/s from which on wheel speeds show no radius: half a second of samples in steps of 0.1 km/h does, of 0.5 km/h does not.
const COARSE_M_S: f64 = 0.25 / 3.6;
/// Changes of a wheel speed that are needed to know its steps.
const LEAST_CHANGES: u64 = 200;
/// If they are exchanged, the body's swings are so many times as large as the wheel's; in g they are smaller.
const EXCHANGED: std::ops::Range<f64> = 3.0..15.0;
/// A wheel over a smooth motorway moves by more than this, in m/s² rms, from [`FAST_M_S`] on.
const LEAST_WHEEL_RMS_M_S2: f64 = 0.8;
const FAST_M_S: f64 = 10.0;
/// And every body by more than this share of its wheel: a damper of 0.15 of the critical one lets through 0.035 at wheel hop, and more below.
const LEAST_BODY_SHARE: f64 = 0.03;
/// Share of an acceleration's rows at the end of its range from which on it is reported. At a tenth pressures are still right; at a fifth
/// they read 10 kPa low, at two fifths 30 to 50 kPa.
const CLIPPED: f64 = 0.05;

#[derive(Debug, Default)]
pub(crate) struct Plausibility {
    /// Sum of the logarithm of wheel speeds over speed.
    ratio: f64,
    ratios: f64,
    /// Sums of the logarithm of each wheel's speed over the others' and of its square, where all turn fast; and number of such rows.
    of_one: [[f64; 2]; 4],
    rows_of_four: f64,
    wheel_speed: f64,
    changes: u64,
    least_step_m_s: Option<f64>,
    /// Number, sum and sum of squares of each corner's body and wheel accelerations while the car is fast.
    swings: [[[f64; 3]; 2]; 4],
    /// Of each corner's body and wheel.
    ranges: [[Range; 2]; 4],
}

/// An acceleration's extreme values while the car drives, and the rows that have exactly these.
#[derive(Debug)]
struct Range {
    lowest: f64,
    at_lowest: f64,
    highest: f64,
    at_highest: f64,
    rows: f64,
}

impl Default for Range {
    fn default() -> Self {
        Self { lowest: f64::INFINITY, at_lowest: 0.0, highest: f64::NEG_INFINITY, at_highest: 0.0, rows: 0.0 }
    }
}

impl Range {
    fn take(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.rows += 1.0;
        if value < self.lowest {
            (self.lowest, self.at_lowest) = (value, 0.0);
        }
        if value > self.highest {
            (self.highest, self.at_highest) = (value, 0.0);
        }
        self.at_lowest += f64::from(value == self.lowest);
        self.at_highest += f64::from(value == self.highest);
    }

    /// The share of its rows at either end, if it moves between two of them at all.
    fn clipped(&self) -> Option<f64> {
        let share = (self.at_lowest + self.at_highest) / self.rows;
        (self.rows >= LEAST_ROWS && share > CLIPPED && share < 1.0).then_some(share)
    }
}

impl Plausibility {
    /// Takes a row of the log; `radius_m` is what makes speeds of wheels of their rotation.
    pub(crate) fn take(&mut self, row: &LogRow, radius_m: f64) {
        for ((sums, ranges), corner) in self.swings.iter_mut().zip(&mut self.ranges).zip(&row.corners) {
            let [body, wheel] =
                corner.map_or([f64::NAN; 2], |corner| [corner.body_accel_m_s2, corner.wheel_accel_m_s2]);
            if row.speed_m_s.is_nan() || row.speed_m_s > DRIVING_M_S {
                ranges[0].take(body);
                ranges[1].take(wheel);
            }
            if row.speed_m_s > FAST_M_S && body.is_finite() && wheel.is_finite() {
                for ([count, sum, squares], value) in sums.iter_mut().zip([body, wheel]) {
                    (*count, *sum, *squares) = (*count + 1.0, *sum + value, *squares + value * value);
                }
            }
        }
        let wheels = row.motion.sample(row.time_s, radius_m).wheel_speed_m_s;
        let mean_m_s = 0.25 * wheels.iter().sum::<f64>();
        if row.speed_m_s > DRIVING_M_S && mean_m_s > 0.0 {
            self.ratio += (mean_m_s / row.speed_m_s).ln();
            self.ratios += 1.0;
        }
        if wheels.iter().all(|wheel| *wheel > 1.0) && 0.25 * wheels.iter().sum::<f64>() > DRIVING_M_S {
            let logs = wheels.map(f64::ln);
            let sum = logs.iter().sum::<f64>();
            for ([first, second], log) in self.of_one.iter_mut().zip(logs) {
                let odd = log - (sum - log) / 3.0;
                (*first, *second) = (*first + odd, *second + odd * odd);
            }
            self.rows_of_four += 1.0;
        }
        let [first, ..] = wheels;
        let step_m_s = (first - std::mem::replace(&mut self.wheel_speed, first)).abs();
        if step_m_s > 1e-9 {
            self.changes += 1;
            self.least_step_m_s = Some(self.least_step_m_s.map_or(step_m_s, |least| least.min(step_m_s)));
        }
    }

    /// Faults that make all wheel speeds useless.
    pub(crate) fn contradiction(&self) -> Option<String> {
        self.odd_wheel().or_else(|| self.other_unit()).or_else(|| self.coarse_steps())
    }

    /// One wheel turns otherwise than the others, by the same factor all the while.
    fn odd_wheel(&self) -> Option<String> {
        let rows = self.rows_of_four;
        let off = self.of_one.map(|[first, second]| (first / rows, second / rows - (first / rows).powi(2)));
        let (corner, (off, variance)) =
            Corner::ALL.into_iter().zip(off).max_by(|a, b| a.1.0.abs().total_cmp(&b.1.0.abs()))?;
        (rows >= LEAST_ROWS && off.abs() > ODD_WHEEL && off * off > 9.0 * variance).then(|| {
            format!(
                "the wheel speed of {} is {:.3} times the others', expected 1: it has another unit or factor",
                corner.label(),
                off.exp()
            )
        })
    }

    fn other_unit(&self) -> Option<String> {
        let off = self.ratio / self.ratios;
        (self.ratios >= LEAST_ROWS && off.abs() > OFF).then(|| {
            let ratio = off.exp();
            let unit = if (ratio / 3.6).ln().abs() < 0.1 { " (in km/h?)" } else { "" };
            format!("the wheel speeds are {ratio:.2} times speed_m_s, expected 1: one of them has another unit or factor{unit}")
        })
    }

    fn coarse_steps(&self) -> Option<String> {
        let step_m_s = self.least_step_m_s.filter(|_| self.changes >= LEAST_CHANGES)?;
        (step_m_s > COARSE_M_S).then(|| {
            format!(
                "the wheel speeds come in steps of {:.2} km/h: too coarse to show a tire's radius, expected 0.1 km/h or finer",
                3.6 * step_m_s
            )
        })
    }

    /// Odd, but possible.
    pub(crate) fn concerns(&self) -> Vec<String> {
        self.in_g().into_iter().chain(self.clipped()).collect()
    }

    /// Of the sensor that is clipped most, and how many are.
    fn clipped(&self) -> Option<String> {
        let names =
            Corner::ALL.iter().flat_map(|corner| ["body", "wheel"].map(|part| (corner.label(), part)));
        let clipped = names.zip(self.ranges.iter().flatten());
        let mut clipped: Vec<_> =
            clipped.filter_map(|(name, range)| Some((range.clipped()?, name, range))).collect();
        clipped.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (share, (corner, part), Range { lowest, highest, .. }) = clipped.first()?;
        let others = match clipped.len() - 1 {
            0 => String::new(),
            count => format!(", {count} more less often"),
        };
        Some(format!(
            "{corner}_{part}_accel_m_s2 is at the end of its range ({lowest:.1} or {highest:.1}) in {:.0} % of its rows{others}: clipped, and above some 10 % pressures read too low; a wheel needs 100 m/s² or more",
            100.0 * share
        ))
    }

    /// Accelerations that are too small by what g is in m/s²: a wheel's for any road, or all bodies' for their wheels.
    fn in_g(&self) -> Option<String> {
        let rms = self.swings.map(|corner| {
            corner.map(|[count, sum, squares]| {
                (count >= LEAST_ROWS).then(|| ((squares - sum * sum / count) / count).sqrt())
            })
        });
        let is_small = |[body, wheel]: &[Option<f64>; 2]| {
            wheel.is_some_and(|rms| {
                rms < LEAST_WHEEL_RMS_M_S2 && !body.is_some_and(|body| EXCHANGED.contains(&(body / rms)))
            })
        };
        let fast_km_h = 3.6 * FAST_M_S;
        if let Some(corner) = rms.iter().position(is_small) {
            return Some(format!(
                "{}_wheel_accel_m_s2 has less than {LEAST_WHEEL_RMS_M_S2} m/s² rms above {fast_km_h:.0} km/h, as on no road: accelerations in g? (factor = 9.80665 in a map)",
                Corner::ALL[corner].label(),
            ));
        }
        let shares = rms.iter().filter_map(|[body, wheel]| Some((*body)? / (*wheel)?));
        let largest = shares.reduce(f64::max)?;
        (largest < LEAST_BODY_SHARE).then(|| {
            format!(
                "every body moves less than {:.1} % of its wheel above {fast_km_h:.0} km/h, as no damper lets it: the bodies' accelerations in g? (factor = 9.80665 in a map)",
                100.0 * largest
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_data::log::{LogCorner, LogMotion};

    /// A row with wheel accelerations of so many m/s² about zero, each corner's its own.
    fn row(k: u64, wheel_m_s2: f64, wheel_speed_m_s: f64) -> LogRow {
        let wave = |corner: usize| (k as f64 * (0.7 + 0.1 * corner as f64)).sin();
        let corners = [0, 1, 2, 3].map(|corner| {
            let (body_accel_m_s2, wheel_accel_m_s2) = (wave(corner), wheel_m_s2 * wave(corner));
            Some(LogCorner::measured(body_accel_m_s2, wheel_accel_m_s2))
        });
        let motion = LogMotion { wheel_speed_m_s: [wheel_speed_m_s; 4], ..LogMotion::UNKNOWN };
        LogRow { time_s: k as f64 / 200.0, speed_m_s: 20.0, corners, motion }
    }

    fn after(rows: impl Fn(u64) -> LogRow) -> Plausibility {
        let mut log = Plausibility::default();
        (0..3000).for_each(|k| log.take(&rows(k), 0.3));
        log
    }

    #[test]
    fn a_log_in_order_is_plausible() {
        let log = after(|k| row(k, 5.0, 20.0 + 0.01 * (k as f64 * 0.01).sin()));
        assert_eq!(log.contradiction(), None);
        assert!(log.concerns().is_empty());
    }

    #[test]
    fn another_unit_is_named() {
        let log = after(|k| row(k, 5.0, 72.0));
        let why = log.contradiction();
        assert!(why.is_some_and(|why| why.contains("3.60 times") && why.contains("km/h")));
        let log = after(|k| row(k, 5.0 / 9.81 / 9.81, f64::NAN));
        assert!(log.concerns().iter().any(|why| why.contains("in g?")));
        // Bodies of a fifth of their wheels, in g: a fiftieth.
        let log = after(|k| row(k, 5.0 * 9.81, f64::NAN));
        assert!(log.concerns().iter().any(|why| why.contains("bodies' accelerations in g?")));
    }

    #[test]
    fn one_wheel_of_another_factor_is_named() {
        let odd = |factor: fn(u64) -> f64| {
            after(move |k| {
                let mut row = row(k, 5.0, 20.0 + 0.01 * (k as f64 * 0.01).sin());
                row.motion.wheel_speed_m_s[2] *= factor(k);
                row
            })
            .contradiction()
        };
        assert!(odd(|_| 1.0 / 3.6).is_some_and(|why| why.contains("speed of rl is 0.278 times the others'")));
        // A tone ring of 44 teeth in the place of 48; a small spare wheel turns less than 3 % faster.
        assert!(odd(|_| 44.0 / 48.0).is_some());
        assert_eq!(odd(|_| 1.025), None);
        // An intermittent mismatch is a faulty sensor, which the monitor finds.
        assert_eq!(odd(|k| if k % 4 == 0 { 0.6 } else { 1.0 }), None);
    }

    #[test]
    fn a_clipped_sensor_is_named() {
        let clipped = |limit_m_s2: f64| {
            after(|k| {
                let mut row = row(k, 5.0, f64::NAN);
                let wheel = &mut row.corners[2].as_mut().unwrap().wheel_accel_m_s2;
                *wheel = wheel.clamp(-limit_m_s2, limit_m_s2);
                row
            })
            .concerns()
        };
        // A sine of 5 m/s² is above 4 m/s² for 41 % of its time.
        let [why] = &clipped(4.0)[..] else { panic!("one concern") };
        assert!(
            why.starts_with("rl_wheel_accel_m_s2 is at the end of its range (-4.0 or 4.0) in 41 %"),
            "{why}"
        );
        assert!(clipped(5.0).is_empty());
    }

    #[test]
    fn coarse_wheel_speeds_are_named() {
        let steps = |step_m_s: f64| after(move |k| row(k, 5.0, 20.0 + step_m_s * (k % 7) as f64));
        let why = steps(0.5 / 3.6).contradiction();
        assert!(why.is_some_and(|why| why.contains("steps of 0.50 km/h")));
        assert_eq!(steps(0.1 / 3.6).contradiction(), None);
    }
}
