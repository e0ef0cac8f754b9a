//! The clock of a table as it counts: over midnight, over the end of summer time, over the end of its counter, and packed as `hhmmss.sss`.
//!
//! Called with the stamp of every row in the order of the file, before rows are put into the order of their stamps. A step is taken for one of
//! these only where what is left of it is a usual step; a clock that begins again with its first stamp is another recording, and left as
//! it is.

/// Rows after which the usual step is known.
const FEWEST: u32 = 16;
/// The remainder of a step is at most so many usual ones, and at least so many s.
const USUAL_STEPS: f64 = 8.0;
const LEAST_S: f64 = 0.02;
/// Weight of a step in the usual one, of which it counts as four at most.
const FOLLOW: f64 = 1.0 / 64.0;
const LONGEST_STEPS: f64 = 4.0;
/// A stamp so near the first one is that of another recording.
const FIRST_S: f64 = 1.0;

const DAY_S: f64 = 86_400.0;
const HOUR_S: f64 = 3_600.0;

/// By how much clocks go back while time goes on, and where: to any value, or to zero.
const PERIODS: [(f64, bool, &str); 6] = [
    (DAY_S, false, "passes midnight"),
    (0.5 * DAY_S, false, "passes twelve"),
    (HOUR_S, false, "goes back by an hour, as at the end of summer time"),
    (4_294_967.296, true, "is a counter of milliseconds that begins anew at 2^32"),
    (4_294.967_296, true, "is a counter of microseconds that begins anew at 2^32"),
    (65.536, true, "is a counter of milliseconds that begins anew at 2^16"),
];

#[derive(Debug, Clone)]
pub(crate) struct Clock {
    first_s: f64,
    /// The last stamp as it is in the file, and as it was given out.
    last: f64,
    given_s: f64,
    rows: u32,
    usual_s: f64,
    is_packed: bool,
    offset_s: f64,
    /// How often each of [`PERIODS`] was passed, and an hour left out at the beginning of summer time.
    passed: [u32; PERIODS.len()],
    leapt: u32,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            first_s: f64::NAN,
            last: f64::NAN,
            given_s: f64::NAN,
            rows: 0,
            usual_s: f64::NAN,
            is_packed: false,
            offset_s: 0.0,
            passed: [0; PERIODS.len()],
            leapt: 0,
        }
    }
}

impl Clock {
    /// The time of the next row, of its stamp in the file in s.
    pub(crate) fn take(&mut self, stamp: f64) -> f64 {
        if !stamp.is_finite() {
            return stamp;
        }
        let mut time_s = self.unpacked(stamp) + self.offset_s;
        let step_s = time_s - self.given_s;
        if !(0.0..=self.longest_s()).contains(&step_s) && self.rows >= FEWEST {
            time_s += self.correction_s(stamp, step_s);
        }
        let step_s = time_s - self.given_s;
        if self.rows == 0 {
            self.first_s = stamp;
        } else if step_s > 0.0 {
            let usual_s = if self.usual_s.is_nan() { step_s } else { self.usual_s };
            self.usual_s = usual_s + FOLLOW * (step_s.min(LONGEST_STEPS * usual_s) - usual_s);
        }
        self.rows = self.rows.saturating_add(1);
        (self.last, self.given_s) = (stamp, time_s);
        time_s
    }

    /// The findings, a sentence each.
    pub(crate) fn remarks(&self) -> Vec<String> {
        let packed = self.is_packed.then(|| {
            "the clock is packed as hhmmss (093045.5 is 45.5 s after 9:30) and was taken apart".to_owned()
        });
        let passed = PERIODS.iter().zip(self.passed).filter(|(_, times)| *times > 0);
        let passed = passed.map(|((.., what), times)| match times {
            1 => format!("the clock {what}: counted on"),
            n => format!("the clock {what}, {n} times: counted on"),
        });
        let leapt = (self.leapt > 0).then(|| {
            "the clock goes forward by an hour, as at the beginning of summer time: taken back".to_owned()
        });
        packed.into_iter().chain(passed).chain(leapt).collect()
    }

    fn longest_s(&self) -> f64 {
        LEAST_S.max(USUAL_STEPS * self.usual_s)
    }

    fn unpacked(&self, stamp: f64) -> f64 {
        let seconds_s = if self.is_packed { seconds_of(stamp) } else { None };
        seconds_s.unwrap_or(stamp)
    }

    /// Offset of this row's time and of all that follow.
    fn correction_s(&mut self, stamp: f64, step_s: f64) -> f64 {
        let usual = 0.0..=self.longest_s();
        if !self.is_packed
            && let Some((before_s, now_s)) = seconds_of(self.last).zip(seconds_of(stamp))
            && usual.contains(&(now_s - before_s).rem_euclid(DAY_S))
        {
            self.is_packed = true;
            let midnight_s = if now_s < before_s { DAY_S } else { 0.0 };
            self.passed[0] += u32::from(now_s < before_s);
            let offset_s = self.given_s - before_s + midnight_s;
            let correction_s = now_s + offset_s - (stamp + self.offset_s);
            self.offset_s = offset_s;
            return correction_s;
        }
        let begins_again = (stamp - self.first_s).abs() < FIRST_S;
        for (place, (period_s, to_zero, _)) in PERIODS.into_iter().enumerate() {
            let fits = !begins_again || period_s == DAY_S;
            let there = !to_zero || (0.0..=self.longest_s()).contains(&stamp);
            if fits && there && usual.contains(&(step_s + period_s)) {
                self.passed[place] += 1;
                self.offset_s += period_s;
                return period_s;
            }
        }
        if usual.contains(&(step_s - HOUR_S)) {
            // Back to where it was before, or a clock that is set forward.
            self.leapt += u32::from(self.passed[2] == 0);
            self.offset_s -= HOUR_S;
            return -HOUR_S;
        }
        0.0
    }
}

/// The seconds of the day of `hhmmss.sss`.
fn seconds_of(packed: f64) -> Option<f64> {
    if !(0.0..240_000.0).contains(&packed) {
        return None;
    }
    let whole = packed.trunc() as u32;
    let (hours, minutes, seconds) = (whole / 10_000, whole / 100 % 100, whole % 100);
    let fraction = packed - f64::from(whole);
    (minutes < 60 && seconds < 60).then(|| f64::from(3600 * hours + 60 * minutes + seconds) + fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 30 s at 200 Hz under a clock that shows `stamp` of the time in s.
    fn through(stamp: impl Fn(f64) -> f64) -> (f64, Vec<String>) {
        let mut clock = Clock::default();
        let times = (0..6000).map(|k| f64::from(k) * 0.005);
        let out: Vec<(f64, f64)> = times.map(|t| (t, clock.take(stamp(t)))).collect();
        let first = out[0].1;
        let worst = out.iter().map(|(t, got)| (got - first - t).abs()).fold(0.0, f64::max);
        (worst, clock.remarks())
    }

    /// `hhmmss.sss` of the seconds of a day.
    fn packed(of_day_s: f64) -> f64 {
        let ms = (of_day_s.rem_euclid(DAY_S) * 1000.0).round() as u64;
        let (s, ms) = (ms / 1000, ms % 1000);
        (s / 3600 * 10_000 + s / 60 % 60 * 100 + s % 60) as f64 + ms as f64 / 1000.0
    }

    #[test]
    fn what_clocks_do_while_time_goes_on() {
        for (stamp, words) in [
            (Box::new(|t: f64| (86_385.0 + t) % DAY_S) as Box<dyn Fn(f64) -> f64>, "midnight"),
            (Box::new(|t| 1.8e9 + t - if t < 15.0 { 0.0 } else { HOUR_S }), "back by an hour"),
            (Box::new(|t| 1.8e9 + t + if t < 15.0 { 0.0 } else { HOUR_S }), "forward by an hour"),
            (Box::new(|t| (4_294_950.0 + t) % 4_294_967.296), "milliseconds"),
            (Box::new(|t| (4_280.0 + t) % 4_294.967_296), "microseconds"),
            (Box::new(|t| packed(34_245.0 + t)), "packed"),
            (Box::new(|t| packed(35_990.0 + t)), "packed"),
            (Box::new(|t| packed(86_385.0 + t)), "packed"),
            // Whole seconds: many rows share a stamp.
            (Box::new(|t: f64| ((86_385.0 + t) % DAY_S).floor()), "midnight"),
        ] {
            let (worst, remarks) = through(&stamp);
            let coarse = stamp(1.5) == stamp(1.505);
            assert!(worst < if coarse { 1.0 } else { 1e-3 }, "{words}: {worst}");
            assert!(remarks.iter().any(|remark| remark.contains(words)), "{words}: {remarks:?}");
        }
        assert_eq!(through(|t| t).1, Vec::<String>::new());
        // A drive in plain seconds, from a time that could be packed, with a pause.
        let (worst, remarks) = through(|t| 100.0 + t + if t < 15.0 { 0.0 } else { 40.0 });
        assert!((worst - 40.0).abs() < 1e-9 && remarks.is_empty(), "{worst} {remarks:?}");
    }

    #[test]
    fn a_clock_that_begins_again_is_left_alone() {
        for length_s in [15.0, HOUR_S, 4_294.967_296] {
            let mut clock = Clock::default();
            let rows = (length_s * 10.0_f64).ceil() as u32;
            let last = (0..rows).map(|k| clock.take(f64::from(k) * 0.1)).last().unwrap();
            assert!(clock.take(0.0) < last, "{length_s}");
        }
        // An hour ahead for some rows, and back.
        let (worst, _) = through(|t| 1.8e9 + t + if (9.0..10.0).contains(&t) { HOUR_S } else { 0.0 });
        assert!(worst < 1e-3);
    }
}
