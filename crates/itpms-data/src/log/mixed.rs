//! Several recordings in one log, their rows in turns: two cars, a table beside the one that it replaced, a drive whose halves were sorted into
//! each other.
//!
//! Called by the reader with the rows of every source, in the order of their times. What a car's sensors show goes on from one sample to
//! the next. Where two recordings take turns, a row is unlike its neighbor, as unlike as any two, while it goes on from the one before that.
//! Up to four recordings are looked for, more than two in fixed turns. Measured is, over pairs of rows and all accelerations and wheel speeds, each over its variance: the mean square between the two of a pair,
//! over that to the next pair, its rows in the order in which they go on best. One recording shows .3 to 1.3, noise alone 1.2 to 1.6, two
//! 4 to 30.
//!
//! A wheel's own turning is no other recording. Its ring is out of round by up to half a hundredth, so its speed sways with every turn, and where a bus
//! samples two, three or four times a turn (50 Hz at 130 km/h) rows repeat themselves as recordings in turns do. Two wheels of one car go
//! together but for that; those of two cars are apart by what the cars are. So neighbors are unlike only where a wheel's speed is another by more than its
//! turning can make.

use super::row::{LogColumns, LogRow};
use super::slot::Slot;
use crate::error::Problem;

const ROWS: usize = 1024;
/// Every stretch is looked at up to here, then one of so many.
const FIRST: usize = 4;
const EVERY: usize = 8;
/// Rows that decide at least.
const FEWEST: usize = 128;
const MOST_RATIO: f64 = 2.5;
/// Recordings whose turns are looked for.
const MOST_RECORDINGS: usize = 4;
/// Mean square between neighbors over that of any two rows, as it is where they have nothing in common. Where two recordings differ in what
/// their sensors show at rest it is up to twice that; so it is of one with a buzz near half the rate, which no wheel of a moving car has.
const UNLIKE: std::ops::RangeInclusive<f64> = 0.4..=2.05;
const UNLIKE_AT_REST: f64 = 1.5;
/// Share of the columns in which neighbors are as unlike as that.
const MOST_COLUMNS: f64 = 0.75;
const UNLIKE_COLUMN: f64 = 0.3;
/// By which share of its speed a wheel may turn faster or slower from one row to the next because its ring is out of round: twice the hundredth that half a
/// hundredth either way makes, for the noise beside it.
const TURNING: f64 = 0.02;
/// Slowest speed in m/s of a car that moves: slower ones show nothing of their tires.
const MOVING_M_S: f64 = 2.8;

#[derive(Debug)]
pub(super) struct Mixed {
    slots: Vec<Slot>,
    stretches: usize,
    rows: usize,
    begin_s: f64,
    /// Row after row, what the slots have, and whether the car moves.
    values: Vec<f64>,
    moving: Vec<bool>,
}

impl Mixed {
    pub(super) fn new(columns: &LogColumns) -> Self {
        let slots: Vec<Slot> =
            columns.slots().filter(|slot| slot.is_acceleration() || slot.is_wheel_speed()).collect();
        let values = Vec::with_capacity(ROWS * slots.len());
        Self { slots, stretches: 0, rows: 0, begin_s: f64::NAN, values, moving: Vec::with_capacity(ROWS) }
    }

    pub(super) fn take(&mut self, row: &LogRow) -> Result<(), Problem> {
        if self.rows == 0 {
            self.begin_s = row.time_s;
        }
        self.rows += 1;
        if self.stretches < FIRST || self.stretches.is_multiple_of(EVERY) {
            self.values.extend(self.slots.iter().map(|slot| row.value(*slot)));
            let wheels = row.motion.wheel_speed_m_s;
            self.moving.push(row.speed_m_s > MOVING_M_S || wheels.iter().any(|speed| *speed > MOVING_M_S));
        }
        if self.rows < ROWS {
            return Ok(());
        }
        self.judge(row.time_s)
    }

    /// There are no more rows, or these are to be judged.
    pub(super) fn judge(&mut self, end_s: f64) -> Result<(), Problem> {
        let turning: Vec<bool> = self.slots.iter().map(|slot| slot.is_wheel_speed()).collect();
        let found = ratio(&self.values, &turning, &self.moving);
        self.values.clear();
        self.moving.clear();
        (self.rows, self.stretches) = (0, self.stretches + 1);
        match found.filter(|ratio| *ratio > MOST_RATIO) {
            Some(ratio) => Err(Problem::TwoRecordings {
                ratio,
                from_s: self.begin_s,
                to_s: end_s,
                way_out: "convert or export each recording for itself".to_owned(),
            }),
            None => Ok(()),
        }
    }
}

/// What tells several recordings from one, of rows whose values are speeds of turning wheels or not, and for each whether the car moves; `None` of too
/// few, or where neighbors have too much in common.
fn ratio(values: &[f64], turning: &[bool], moving: &[bool]) -> Option<f64> {
    let width = turning.len();
    let weights: Vec<f64> = (0..width).map(|column| weight(values, width, column)).collect();
    let used = weights.iter().filter(|weight| **weight > 0.0).count();
    // A value that is missing counts as one that goes on.
    let squares = |one: &[f64], other: &[f64]| -> f64 {
        let square = |((a, b), weight): ((&f64, &f64), &f64)| {
            let off = a - b;
            if off.is_finite() && *weight > 0.0 { weight * off * off } else { 0.0 }
        };
        one.iter().zip(other).zip(&weights).map(square).sum()
    };
    // The same without what a wheel's turning makes.
    let square_beyond = |column: usize, a: f64, b: f64| {
        let off = (a - b).abs();
        let turns = turning[column] && off <= TURNING * a.abs().max(b.abs());
        if off.is_finite() && weights[column] > 0.0 && !turns { weights[column] * off * off } else { 0.0 }
    };
    let squares_beyond =
        |one: &[f64], other: &[f64]| (0..width).map(|i| square_beyond(i, one[i], other[i])).sum::<f64>();
    if used == 0 || values.len() / width < FEWEST {
        return None;
    }
    let rows: Vec<&[f64]> = values.chunks_exact(width).collect();
    // Beside a car that moves another one may stand.
    let one_moves = |recordings: usize| {
        let of_one = |phase: usize| moving.iter().skip(phase).step_by(recordings).all(|moves| *moves);
        (0..recordings).any(of_one)
    };
    let of = |recordings: usize, phase: usize| {
        let (mut within, mut onwards, mut pairs) = (0.0, 0.0, 0.0);
        for rows in rows[phase..].windows(2 * recordings).step_by(recordings) {
            let (now, next) = rows.split_at(recordings);
            let neighbors = || now.windows(2).map(|pair| squares_beyond(pair[0], pair[1]));
            let straight: f64 = now.iter().zip(next).map(|(one, other)| squares(one, other)).sum();
            let onward = match (now, next) {
                // A sort by stamps that are the same leaves two in any order.
                ([a, b], [c, d]) => straight.min(squares(a, d) + squares(b, c)),
                _ => straight,
            };
            within += neighbors().sum::<f64>() / (recordings - 1) as f64;
            onwards += onward / recordings as f64;
            pairs += 1.0;
        }
        let unlike = within / (2.0 * pairs * used as f64);
        let of_column = |column: usize| {
            let square = |pair: &[&[f64]]| square_beyond(column, pair[0][column], pair[1][column]);
            let pairs_of = rows[phase..].windows(2).step_by(recordings);
            pairs_of.map(square).sum::<f64>() / (2.0 * pairs)
        };
        let unlike_columns = (0..width).filter(|column| of_column(*column) > UNLIKE_COLUMN).count();
        let is_unlike = UNLIKE.contains(&unlike)
            && (unlike <= UNLIKE_AT_REST || one_moves(recordings))
            && unlike_columns as f64 >= MOST_COLUMNS * used as f64;
        (is_unlike && onwards > 0.0).then_some(within / onwards)
    };
    // A buzz at a third or a quarter of the rate looks like three or four, which the wheels of a moving car hardly have.
    let numbers = (2..=MOST_RECORDINGS).filter(|recordings| *recordings == 2 || one_moves(*recordings));
    let all = numbers.flat_map(|recordings| (0..recordings).map(move |phase| (recordings, phase)));
    all.filter_map(|(recordings, phase)| of(recordings, phase)).reduce(f64::max)
}

/// One over the variance of a column; zero where it hardly has values, or one alone.
fn weight(values: &[f64], width: usize, column: usize) -> f64 {
    let all = || values.iter().skip(column).step_by(width).copied().filter(|value| value.is_finite());
    let count = all().count() as f64;
    let mean = all().sum::<f64>() / count;
    let variance = all().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    let rows = (values.len() / width) as f64;
    if variance > 0.0 && 2.0 * count >= rows { 1.0 / variance } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 8;

    /// Uniform in -0.5 to 0.5, by two numbers.
    fn uniform(seed: u64, k: u64) -> f64 {
        let mut x = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ k.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 30)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }

    /// A wheel's hop of a random width, beside noise, at this rate: row `k` of a recording.
    fn drive(recording: u64, rate_hz: f64, noise: f64) -> impl Fn(usize) -> Vec<f64> {
        move |k| {
            let t = k as f64 / rate_hz;
            let sensor = |column: u64| {
                let seed = 100 * recording + column;
                let wave = |i: u64| {
                    let hz = 9.0 + 6.0 * (uniform(seed, i) + 0.5);
                    (std::f64::consts::TAU * (hz * t + uniform(seed, 50 + i))).sin()
                };
                (0..6).map(wave).sum::<f64>() + noise * uniform(seed, 1000 + k as u64)
            };
            (0..WIDTH as u64).map(sensor).collect()
        }
    }

    fn of(rows: impl Iterator<Item = Vec<f64>>, width: usize) -> f64 {
        let values: Vec<f64> = rows.take(ROWS).flat_map(|row| row[..width].to_vec()).collect();
        ratio(&values, &ACCELERATIONS[..width], &STANDS).unwrap_or(0.0)
    }

    const ACCELERATIONS: [bool; WIDTH] = [false; WIDTH];
    const STANDS: [bool; ROWS] = [false; ROWS];
    const MOVES: [bool; ROWS] = [true; ROWS];

    #[test]
    fn two_recordings_are_distinguished_from_one() {
        for rate_hz in [50.0, 100.0, 200.0, 1000.0] {
            for width in [2, WIDTH] {
                let (a, b) = (drive(1, rate_hz, 0.3), drive(2, rate_hz, 0.3));
                let one = of((0..).map(&a), width);
                assert!(one < 1.7, "{rate_hz} {width}: {one}");
                if rate_hz < 100.0 {
                    continue;
                }
                let in_turns = of((0..).flat_map(|k| [a(k), b(k)]), width);
                let any_order =
                    |k: usize| if uniform(7, k as u64) > 0.0 { [a(k), b(k)] } else { [b(k), a(k)] };
                let sorted = of((0..).flat_map(any_order), width);
                assert!(
                    in_turns > MOST_RATIO && sorted > MOST_RATIO,
                    "{rate_hz} {width}: {in_turns} {sorted}"
                );
                // One of the two a second later.
                let later = of((0..).flat_map(|k| [a(k), a(k + rate_hz as usize)]), width);
                assert!(later > MOST_RATIO, "{rate_hz} {width}: {later}");
            }
        }
    }

    #[test]
    fn sensors_that_show_something_else_at_rest_are_two_where_the_car_moves() {
        let (a, b) = (drive(1, 200.0, 0.3), drive(2, 200.0, 0.3));
        let with_gravity = |k| b(k).into_iter().map(|value| value + 9.81).collect();
        let values: Vec<f64> = (0..512).flat_map(|k| [a(k), with_gravity(k)]).flatten().collect();
        assert!(ratio(&values, &ACCELERATIONS, &MOVES).unwrap() > MOST_RATIO);
        assert_eq!(ratio(&values, &ACCELERATIONS, &STANDS), None);
    }

    #[test]
    fn three_and_four_recordings_are_distinguished_from_one_in_a_car_that_moves() {
        for rate_hz in [100.0, 200.0, 1000.0] {
            let all = [1, 2, 3, 4].map(|recording| drive(recording, rate_hz, 0.3));
            let one: Vec<f64> = (0..ROWS).flat_map(&all[0]).collect();
            assert!(ratio(&one, &ACCELERATIONS, &MOVES).unwrap_or(0.0) < 1.9, "{rate_hz}");
            for many in [3, 4] {
                let turns = (0..ROWS).flat_map(|k| all[k % many](k / many));
                let found = ratio(&turns.collect::<Vec<_>>(), &ACCELERATIONS, &MOVES).unwrap_or(0.0);
                assert!(found > MOST_RATIO, "{rate_hz} {many}: {found}");
            }
        }
    }

    #[test]
    fn cars_that_stand_beside_one_that_moves_are_recordings_of_their_own() {
        let quiet = |recording: u64, k: usize, rest: f64| -> Vec<f64> {
            (0..WIDTH as u64).map(|c| rest + 0.3 * uniform(100 * recording + c, k as u64)).collect()
        };
        let moves = drive(1, 200.0, 0.3);
        for many in 2..=MOST_RECORDINGS {
            let rows = (0..ROWS).flat_map(|k| match k % many {
                0 => moves(k / many),
                other => quiet(other as u64, k, 9.81),
            });
            let values: Vec<f64> = rows.collect();
            let moving: Vec<bool> = (0..ROWS).map(|k| k % many == 0).collect();
            let found = ratio(&values, &ACCELERATIONS, &moving).unwrap_or(0.0);
            assert!(found > MOST_RATIO, "{many}: {found}");
        }
    }

    #[test]
    fn noise_a_buzz_and_a_sensor_that_stands_still_are_one() {
        let noise = |k: usize| (0..WIDTH as u64).map(|c| uniform(c, k as u64)).collect::<Vec<_>>();
        for width in [1, 2, WIDTH] {
            let found = of((0..).map(noise), width);
            assert!(found < MOST_RATIO, "{width}: {found}");
        }
        // An engine's buzz at each share of the rate, above all else.
        for share in 1..50 {
            let buzz = |k: usize| {
                let phase =
                    |c: usize| std::f64::consts::TAU * (share as f64 / 100.0 * k as f64 + 0.1 * c as f64);
                (0..WIDTH).map(|c| phase(c).sin() + 0.1 * uniform(c as u64, k as u64)).collect::<Vec<_>>()
            };
            let found = of((0..).map(buzz), WIDTH);
            assert!(found < MOST_RATIO, "{share}: {found}");
        }
        assert_eq!(of((0..).map(|_| vec![1.0; WIDTH]), WIDTH), 0.0);
    }

    const WHEELS: [bool; 4] = [true; 4];

    /// Four wheels of a car at this speed in m/s, in steps of 0.01 m/s with as much noise. Each ring is out of round by this share, once and
    /// half as much twice a turn of a radius of 0.3 m. The car's speed sways by `sway` m/s, another way for every recording.
    fn wheels(
        recording: u64,
        speed: f64,
        rate_hz: f64,
        runout: f64,
        sway: f64,
    ) -> impl Fn(usize) -> Vec<f64> {
        move |k| {
            let t = k as f64 / rate_hz;
            let turn = std::f64::consts::TAU;
            let car = speed + sway * (turn * (0.05 * t + uniform(recording, 1))).sin();
            let wheel = |wheel: u64| {
                let seed = 100 * recording + wheel;
                let turned = speed * t / 0.3 + turn * uniform(seed, 1);
                let round = runout * (turned.sin() + 0.5 * (2.0 * turned + turn * uniform(seed, 2)).sin());
                let noise = 0.01 * uniform(seed, 1000 + k as u64);
                ((car * (1.0 + round) + noise) * 100.0).round() / 100.0
            };
            (0..4).map(wheel).collect()
        }
    }

    /// Half a hundredth at every speed, where a turn takes two, three or four rows, too.
    #[test]
    fn rings_out_of_round_are_one_at_every_speed_and_two_cars_are_two() {
        let in_turns = |one: &dyn Fn(usize) -> Vec<f64>| (0..ROWS).flat_map(one).collect::<Vec<_>>();
        for rate_hz in [10.0, 20.0, 25.0, 50.0, 100.0] {
            // Where a turn takes just two, three or four rows, and all speeds between.
            let just = [2.0, 3.0, 4.0, 6.0, 8.0].map(|rows| std::f64::consts::TAU * 0.3 * rate_hz / rows);
            let speeds = (12..90).map(|half| f64::from(half) / 2.0).chain(just);
            for speed in speeds.filter(|speed| *speed > 5.0 && *speed < 60.0) {
                // The two harmonics together are at most 3/2 of it, so half a hundredth at most.
                for runout in [0.0005, 0.0015, 0.005 / 1.5] {
                    let one = in_turns(&wheels(1, speed, rate_hz, runout, 0.02));
                    let found = ratio(&one, &WHEELS, &MOVES).unwrap_or(0.0);
                    assert!(found < MOST_RATIO, "{rate_hz} Hz, {speed} m/s, {runout}: {found}");
                }
                if rate_hz < 50.0 {
                    continue;
                }
                // Another car a twentieth faster or slower, or one that sways another way by a tenth.
                for (other, sway) in [(1.05 * speed, 0.02), (0.95 * speed, 0.02), (speed, 0.1 * speed)] {
                    let (a, b) = (
                        wheels(1, speed, rate_hz / 2.0, 0.003, sway),
                        wheels(7, other, rate_hz / 2.0, 0.003, sway),
                    );
                    let turns = in_turns(&|k| if k % 2 == 0 { a(k / 2) } else { b(k / 2) });
                    let found = ratio(&turns, &WHEELS, &MOVES).unwrap_or(0.0);
                    assert!(found > MOST_RATIO, "{rate_hz} Hz, {speed} and {other} m/s: {found}");
                }
            }
        }
    }
}
