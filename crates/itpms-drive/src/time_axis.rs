//! Whether a log's time axis, its speed and the wheelbase belong together: the rear wheel passes over what the front wheel met, a
//! wheelbase later, on its own side.
//!
//! Fed with every row of a drive by [`run`](crate::run), asked at its end. Where wheels are clearly alike at another distance, the times
//! or the speeds are wrong by a factor, and so is every frequency that the estimator looks at: no pressure is one. Knows nothing of tires;
//! it needs no calibration and no good road, and where it finds nothing it says nothing.

mod likeness;

use itpms_core::conditioning::SpeedHold;
use itpms_core::model::Corner;
use itpms_data::{LogRow, Vehicle};

use likeness::Likeness;

/// Cells to a wheelbase, wheelbases that are looked at, and cells of a stretch of road.
const CELLS: usize = 48;
const FURTHEST: usize = 5;
const LAGS: usize = FURTHEST * CELLS;
const STRETCH: usize = 4 * LAGS;
/// Slowest speed in m/s, and the longest step from one row to the next in cells.
const SLOWEST_M_S: f64 = 4.0;
const LONGEST_STEP_CELLS: f64 = 24.0;
/// Stretches that are looked at, and that are needed.
const MOST: usize = 24;
const LEAST: usize = 3;
/// Correlation from which on wheels are alike, and share of it that must not be reached at the wheelbase.
const ALIKE: f64 = 0.45;
const NOT_THERE: f64 = 0.6;
/// Largest error of a stated wheelbase, in its logarithm: a tenth and a little.
const OFF: f64 = 0.12;
/// From here on two wheels at one moment are one signal: the car's pitch makes of two sensors a tenth.
const SAME: f64 = 0.95;
/// A speed whose rms about a straight line over a second is more than this, in m/s and as a share, is no car's; in so many of the seconds.
const ROUGH_M_S: f64 = 1.5;
const ROUGH_SHARE: f64 = 0.1;
const ROUGH_SECONDS: f64 = 0.5;

#[derive(Debug)]
pub(crate) struct TimeAxis {
    wheelbase_m: Option<f64>,
    /// Whether that is no more than assumed.
    assumed: bool,
    speed: SpeedHold<f64>,
    last_s: f64,
    way_m: f64,
    cells: [Cells; 2],
    /// The rear wheel after the front one of its side; before it; after that of the other side.
    after: Likeness,
    before: Likeness,
    across: Likeness,
    stretches: usize,
    second: Second,
    rough: [u32; 2],
}

/// One side's road as its wheels felt it, a cell at a time.
#[derive(Debug, Default)]
struct Cells {
    front: Vec<f64>,
    rear: Vec<f64>,
    sum: [f64; 2],
    rows: f64,
}

/// Running sums of a second of speeds, over time since it began.
#[derive(Debug, Clone, Copy, Default)]
struct Second {
    began_s: f64,
    count: f64,
    t: f64,
    tt: f64,
    v: f64,
    vv: f64,
    tv: f64,
}

impl TimeAxis {
    pub(crate) fn of(vehicle: &Vehicle) -> Self {
        Self { assumed: vehicle.assumes_wheelbase(), ..Self::new(vehicle.wheelbase_m) }
    }

    pub(crate) fn new(wheelbase_m: Option<f64>) -> Self {
        Self {
            wheelbase_m,
            assumed: false,
            speed: SpeedHold::new(),
            last_s: f64::NAN,
            way_m: 0.0,
            cells: Default::default(),
            after: Likeness::new(),
            before: Likeness::new(),
            across: Likeness::new(),
            stretches: 0,
            second: Second::default(),
            rough: [0, 0],
        }
    }

    pub(crate) fn take(&mut self, row: &LogRow) {
        let step_s = row.time_s - std::mem::replace(&mut self.last_s, row.time_s);
        self.feel_speed(row);
        let Some(wheelbase_m) = self.wheelbase_m.filter(|_| self.stretches < MOST) else { return };
        let cell_m = wheelbase_m / CELLS as f64;
        // Sent now and then, a speed holds for half a second.
        let speed_m_s = self.speed.take(row.time_s, row.speed_m_s);
        let step_m = speed_m_s * step_s;
        if !(speed_m_s > SLOWEST_M_S && step_m < LONGEST_STEP_CELLS * cell_m) {
            self.cells = Default::default();
            self.way_m = 0.0;
            return;
        }
        self.way_m += step_m;
        let whole = (self.way_m / cell_m) as usize;
        self.way_m -= whole as f64 * cell_m;
        for ([front, rear], cells) in SIDES.iter().zip(&mut self.cells) {
            let wheel = |corner: &Corner| {
                row.corners[corner.index()].map_or(f64::NAN, |corner| corner.wheel_accel_m_s2)
            };
            cells.take([wheel(front), wheel(rear)], whole);
        }
        if self.cells.iter().any(|cells| cells.front.len() >= STRETCH) {
            let sides = std::mem::take(&mut self.cells).map(|cells| cells.centered());
            for (side, other) in [(0, 1), (1, 0)] {
                let Some([front, rear]) = &sides[side] else { continue };
                self.after.take(front, rear);
                self.before.take(rear, front);
                if let Some([_, rear]) = &sides[other] {
                    self.across.take(front, rear);
                }
            }
            self.stretches += 1;
        }
    }

    fn feel_speed(&mut self, row: &LogRow) {
        let (time_s, speed_m_s) = (row.time_s, row.speed_m_s);
        if !(time_s - self.second.began_s < 1.0) {
            if let Some(is_rough) = self.second.is_rough() {
                self.rough[usize::from(is_rough)] += 1;
            }
            self.second = Second { began_s: time_s, ..Second::default() };
        }
        if speed_m_s.is_finite() {
            self.second.take(time_s - self.second.began_s, speed_m_s);
        }
    }

    /// The contradiction, if there surely is one.
    pub(crate) fn contradiction(&self) -> Option<String> {
        let [smooth, rough] = self.rough.map(f64::from);
        if rough > ROUGH_SECONDS * (smooth + rough) {
            return Some(format!(
                "speed_m_s jumps from row to row by more than {ROUGH_M_S} m/s in {rough:.0} of {:.0} s, as no car's does: expected the car's speed (smooth it, or take another source)",
                smooth + rough
            ));
        }
        let wheelbase_m = self.wheelbase_m.filter(|_| self.stretches >= LEAST)?;
        if self.after.at(0) > SAME {
            return Some(
                "front and rear wheel have the same acceleration at the same moment: expected a sensor at each wheel (one signal taken for both, or copied?)"
                    .to_owned(),
            );
        }
        let [after, before, across] =
            [&self.after, &self.before, &self.across].map(Likeness::at_the_wheelbase);
        let instead = |other: f64| other >= ALIKE && after < NOT_THERE * other;
        if instead(before) {
            return Some(
                "the front wheels pass over the road a wheelbase after the rear ones: front and rear are exchanged, or the rows run backwards in time (give each column its wheel with --signals)"
                    .to_owned(),
            );
        }
        if instead(across) {
            return Some(
                "each rear wheel passes over the road of the other side's front wheel: left and right are exchanged on one axle (give each column its wheel with --signals)"
                    .to_owned(),
            );
        }
        let best = (1..LAGS - 1)
            .filter(|lag| self.after.at(*lag) >= ALIKE)
            .max_by(|a, b| self.after.at(*a).total_cmp(&self.after.at(*b)))?;
        let factor = best as f64 / CELLS as f64;
        (factor.ln().abs() > OFF && after < NOT_THERE * self.after.at(best)).then(|| {
            let assumed = if self.assumed { " (assumed; itpms vehicle learn finds it)" } else { "" };
            format!(
                "the rear wheels pass over the same road {:.2} m after the front ones by time_s and speed_m_s, but wheelbase_m is {wheelbase_m}{assumed}: the time, the speed or the wheelbase is wrong by a factor of {factor:.2}{}, and no pressure can be estimated",
                factor * wheelbase_m,
                likely_unit(factor),
            )
        })
    }
}

/// The unit in which a speed would be wrong by this factor.
fn likely_unit(factor: f64) -> &'static str {
    [
        (3.6, " (a speed in km/h?)"),
        (2.237, " (a speed in mph?)"),
        (1.0 / 3.6, " (a speed in m/s taken for km/h?)"),
    ]
    .into_iter()
    .find(|(of_unit, _)| (factor / of_unit).ln().abs() <= 0.5 * OFF)
    .map_or("", |(_, words)| words)
}

const SIDES: [[Corner; 2]; 2] =
    [[Corner::FrontLeft, Corner::RearLeft], [Corner::FrontRight, Corner::RearRight]];

impl Cells {
    /// Front and rear wheel over a stretch, each about its mean; `None` where it is not known.
    fn centered(&self) -> Option<[Vec<f64>; 2]> {
        let centered = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            values.iter().map(|value| value - mean).collect::<Vec<f64>>()
        };
        let both = [centered(self.front.get(..STRETCH)?), centered(self.rear.get(..STRETCH)?)];
        both.iter().flatten().all(|value| value.is_finite()).then_some(both)
    }

    /// Takes both wheels' accelerations; so many cells end with them.
    fn take(&mut self, wheels: [f64; 2], whole: usize) {
        self.sum = [self.sum[0] + wheels[0], self.sum[1] + wheels[1]];
        self.rows += 1.0;
        if whole == 0 {
            return;
        }
        let mean = self.sum.map(|sum| sum / self.rows);
        for (values, mean) in [&mut self.front, &mut self.rear].into_iter().zip(mean) {
            // Longer steps than a cell: on the line from the last one.
            let from = values.last().copied().unwrap_or(mean);
            values.extend((1..=whole).map(|cell| from + (mean - from) * cell as f64 / whole as f64));
        }
        (self.sum, self.rows) = ([0.0; 2], 0.0);
    }
}

impl Second {
    fn take(&mut self, time_s: f64, speed_m_s: f64) {
        self.count += 1.0;
        self.t += time_s;
        self.tt += time_s * time_s;
        self.v += speed_m_s;
        self.vv += speed_m_s * speed_m_s;
        self.tv += time_s * speed_m_s;
    }

    /// Whether what is left of the speeds about their line is more than a car's; `None` for too few.
    fn is_rough(&self) -> Option<bool> {
        let Self { count, t, tt, v, vv, tv, .. } = *self;
        if !(count >= 16.0) {
            return None;
        }
        let (t, v) = (t / count, v / count);
        let (of_t, of_v, both) = (tt / count - t * t, vv / count - v * v, tv / count - t * v);
        let left = (of_v - both * both / of_t.max(1e-12)).max(0.0).sqrt();
        Some(left > ROUGH_M_S && left > ROUGH_SHARE * v.abs())
    }
}

#[cfg(test)]
mod tests {
    use itpms_data::log::LogCorner;

    use super::*;

    /// A drive of two minutes at 200 Hz over a road of white noise through a wheel hop of 12 Hz: rows under a clock that runs `clock` times
    /// as fast, with a speed that is `noise_m_s` off in turns, and with the rear at one moment with the front where it is a copy.
    fn rows(clock: f64, noise_m_s: f64, is_copy: bool) -> Vec<LogRow> {
        let (rate_hz, speed_m_s, wheelbase_m) = (200.0, 20.0, 2.7);
        let mut seed = 7u64;
        let mut white = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        // Two poles at 12 Hz with a damping of a fifth.
        let angle = std::f64::consts::TAU * 12.0 / rate_hz;
        let radius = (-0.2 * angle).exp();
        let road: Vec<f64> = (0..24_200)
            .scan([0.0; 2], |[a, b], _| {
                let next = 2.0 * radius * angle.cos() * *a - radius * radius * *b + white();
                (*a, *b) = (next, *a);
                Some(next)
            })
            .collect();
        let delay = if is_copy { 0 } else { (wheelbase_m / speed_m_s * rate_hz).round() as usize };
        (100..24_000)
            .map(|k| {
                let mut corners = [None; 4];
                for [front, rear] in SIDES {
                    for (corner, at, noise) in
                        [(front, k, 0.2), (rear, k - delay, if is_copy { 0.0 } else { 0.2 })]
                    {
                        let noise = if is_copy {
                            0.0
                        } else {
                            noise * ((k * 7919 + corner.index() * 104_729) % 997) as f64 / 997.0
                        };
                        corners[corner.index()] = Some(LogCorner::measured(0.0, road[at] + noise));
                    }
                }
                let off_m_s = noise_m_s * (((k * 7919) % 1000) as f64 / 500.0 - 1.0);
                LogRow::without_motion(clock * k as f64 / rate_hz, speed_m_s + off_m_s, corners)
            })
            .collect()
    }

    fn exchanged(rows: &[LogRow], wheels: [usize; 4]) -> Vec<LogRow> {
        rows.iter().map(|row| LogRow { corners: wheels.map(|wheel| row.corners[wheel]), ..*row }).collect()
    }

    #[test]
    fn exchanged_wheels_and_a_drive_run_backwards_are_found() {
        let right = rows(1.0, 0.0, false);
        assert!(
            verdict(&exchanged(&right, [2, 3, 0, 1]))
                .is_some_and(|text| text.contains("front and rear are exchanged"))
        );
        let mut backwards = right.clone();
        for (row, other) in backwards.iter_mut().zip(right.iter().rev()) {
            row.corners = other.corners;
        }
        assert!(verdict(&backwards).is_some_and(|text| text.contains("backwards in time")));
        // The same road under both sides: whoever exchanges them changes nothing.
        assert_eq!(verdict(&exchanged(&right, [1, 0, 2, 3])), None);
        // A road of its own under each: the right side as it was a minute before.
        let mut apart = right.clone();
        for (row, earlier) in apart[6000..].iter_mut().zip(&right) {
            (row.corners[1], row.corners[3]) = (earlier.corners[1], earlier.corners[3]);
        }
        let apart = &apart[6000..];
        assert_eq!(verdict(apart), None);
        for wheels in [[1, 0, 2, 3], [0, 1, 3, 2]] {
            assert!(verdict(&exchanged(apart, wheels)).is_some_and(|text| text.contains("left and right")));
        }
        assert_eq!(verdict(&exchanged(apart, [1, 0, 3, 2])), None);
    }

    #[test]
    fn a_speed_in_another_unit_is_named() {
        for (times, unit) in
            [(3.6, "(a speed in km/h?)"), (2.237, "(a speed in mph?)"), (1.0 / 3.6, "taken for km/h?)")]
        {
            let wrong: Vec<LogRow> = rows(1.0, 0.0, false)
                .into_iter()
                .map(|row| LogRow { speed_m_s: row.speed_m_s * times, ..row })
                .collect();
            assert!(verdict(&wrong).is_some_and(|text| text.contains(unit)), "{unit}: {:?}", verdict(&wrong));
        }
    }

    fn verdict(rows: &[LogRow]) -> Option<String> {
        let mut axis = TimeAxis::new(Some(2.7));
        rows.iter().for_each(|row| axis.take(row));
        axis.contradiction()
    }

    #[test]
    fn a_clock_that_runs_wrong_is_found_and_a_right_one_is_not() {
        for clock in [1.0, 0.95, 1.05] {
            assert_eq!(verdict(&rows(clock, 0.0, false)), None, "{clock}");
        }
        for clock in [2.0, 1.0 / 1.2, 0.5, 3.6, 1.3] {
            let text = verdict(&rows(clock, 0.0, false)).unwrap_or_default();
            let factor = text
                .split("factor of ")
                .nth(1)
                .and_then(|rest| rest.split([',', ' ']).next()?.parse::<f64>().ok());
            // To a cell and the last row's rounding.
            assert!(factor.is_some_and(|factor| (factor / clock - 1.0).abs() < 0.04), "{clock}: {text}");
            assert_eq!(text.contains("km/h"), clock == 3.6, "{text}");
            assert!(!text.contains("mph"), "{text}");
        }
    }

    #[test]
    fn one_signal_at_both_wheels_and_a_speed_that_jumps_are_found() {
        assert!(verdict(&rows(1.0, 0.0, true)).is_some_and(|text| text.contains("same moment")));
        assert!(verdict(&rows(1.0, 17.0, false)).is_some_and(|text| text.starts_with("speed_m_s jumps")));
        assert_eq!(verdict(&rows(1.0, 0.5, false)), None);
    }

    #[test]
    fn without_a_wheelbase_or_on_roads_of_their_own_nothing_is_reported() {
        let mut axis = TimeAxis::new(None);
        rows(2.0, 0.0, false).iter().for_each(|row| axis.take(row));
        assert_eq!(axis.contradiction(), None);
        let mut apart = rows(2.0, 0.0, false);
        let other: Vec<LogRow> = apart.iter().rev().copied().collect();
        for (row, other) in apart.iter_mut().zip(other) {
            (row.corners[2], row.corners[3]) = (other.corners[2], other.corners[3]);
        }
        assert_eq!(verdict(&apart), None);
    }
}
