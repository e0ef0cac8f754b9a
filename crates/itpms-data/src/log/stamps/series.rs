//! The samples of one signal, or the rows of a table, in the order of the file: what shares a stamp is spread where it is sure that the
//! clock is coarser than the samples, and a clock that was set back a little is noticed.

use super::spread::Spread;
use super::{Fate, Stamped};

/// Samples that repeat a stamp are looked at for so long, in s, and at least and at most so many of them.
const LOOK_S: f64 = 1.0;
const FEWEST: usize = 32;
const MOST: usize = 16_384;
/// Share of samples with the stamp of the one before: a logger that now and then writes a sample twice stays below, a clock coarser
/// than the samples does not.
const COARSE_SHARE: f64 = 0.1;
/// Of them, with the values of the one before, too: all samples were written twice.
const TWICE_SHARE: f64 = 0.9;
/// A clock of longer steps, in s, tells too little of when a sample was taken.
const LONGEST_STEP_S: f64 = 0.25;
/// A step of the clock that is longer by this factor than its usual one is a gap.
const GAP_STEPS: f64 = 1.5;
/// A step forwards that is longer by this factor begins another stretch.
const LEAP_STEPS: f64 = 8.0;
/// Weight of a step in the usual one, of which it counts as four at most.
const FOLLOW: f64 = 1.0 / 64.0;
const LONGEST_STEPS: f64 = 4.0;
/// Samples one after the other that lie back: through a stretch that was passed before the clock was set back; before it, they are no
/// odd ones.
const MANY: usize = 16;
/// Share of spread samples whose stamps do not fit an even rate; beyond, nothing is sure.
const UNSURE_SHARE: f64 = 0.05;

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::log) struct Coarse {
    pub(in crate::log) step_s: f64,
    /// Samples a second under that step.
    pub(in crate::log) rate_hz: f64,
    pub(in crate::log) spread: u64,
    /// Samples of which it is not sure where they belong.
    unsure: u64,
    /// Samples under a clock of too long steps.
    unspread: u64,
}

impl Coarse {
    /// Whether some stamps are coarse and it is not sure where their samples belong.
    pub(in crate::log) fn is_unsure(&self) -> bool {
        self.unspread > 0 || self.unsure as f64 > UNSURE_SHARE * self.spread as f64
    }
}

#[derive(Debug)]
pub(in crate::log) struct Series<T> {
    /// The last sample in the file, and the last time that was given out.
    last: Option<T>,
    given_s: f64,
    /// The usual step from one stamp to the next other one in s; NaN before the first.
    usual_s: f64,
    /// The stretch that has been passed without a leap.
    began_s: f64,
    reached_s: f64,
    /// Samples that lie back, one after the other, until it is known what they are.
    back: Vec<T>,
    lies_back: Back,
    state: State<T>,
    coarse: Coarse,
}

/// What samples are that come after later ones.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Back {
    Unknown,
    /// A part of the log that was written late.
    Late,
    /// A stretch that was passed before.
    Again,
}

#[derive(Debug)]
enum State<T> {
    Fine,
    /// One stood still: what follows is looked at.
    Looking(Vec<T>),
    Spreading(Spread<T>),
}

impl<T: Stamped> Series<T> {
    pub(in crate::log) fn new() -> Self {
        Self {
            last: None,
            given_s: f64::NEG_INFINITY,
            usual_s: f64::NAN,
            began_s: f64::INFINITY,
            reached_s: f64::NEG_INFINITY,
            back: Vec::new(),
            lies_back: Back::Unknown,
            state: State::Fine,
            coarse: Coarse::default(),
        }
    }

    /// Finding on a clock coarser than the samples.
    pub(in crate::log) fn coarse(&self) -> Coarse {
        let mut coarse = self.coarse;
        if let State::Spreading(spread) = &self.state {
            coarse.spread += spread.spread;
            coarse.unsure += spread.unsure;
        }
        coarse
    }

    /// Takes the next sample of the file; says what becomes of it and of those that waited for it.
    pub(in crate::log) fn take(&mut self, sample: T, sink: &mut impl FnMut(Fate<T>)) {
        let time_s = sample.time_s();
        let Some(last) = self.last.replace(sample) else {
            (self.began_s, self.reached_s) = (time_s, time_s);
            return self.keep(sample, sink);
        };
        let step_s = time_s - last.time_s();
        // What follows a sample that lies back goes on from where the others were.
        let was_back = last.time_s() < self.reached_s;
        let ahead_s = time_s - self.reached_s;
        let leaps = ahead_s > LEAP_STEPS * self.usual_s;
        if ahead_s > 0.0 && !was_back {
            let usual_s = if self.usual_s.is_nan() { ahead_s } else { self.usual_s };
            self.usual_s = usual_s + FOLLOW * (ahead_s.min(LONGEST_STEPS * usual_s) - usual_s);
        }
        if leaps
            || step_s < 0.0
            || (was_back && step_s > LEAP_STEPS * self.usual_s)
            || (was_back && ahead_s >= 0.0)
        {
            self.settle(sink);
        }
        if time_s < self.reached_s {
            return self.take_back(sample, sink);
        }
        if leaps {
            self.began_s = time_s;
        }
        self.reached_s = time_s;
        match &mut self.state {
            State::Fine if step_s != 0.0 => self.keep(sample, sink),
            State::Fine if sample.has_values_of(&last) => sink(Fate::Repeated(sample)),
            State::Fine => self.state = State::Looking(vec![sample]),
            State::Looking(samples) => {
                samples.push(sample);
                let lasts_s = time_s - samples.first().map_or(time_s, Stamped::time_s);
                if samples.len() >= MOST || (lasts_s >= LOOK_S && samples.len() >= FEWEST) {
                    self.judge(sink);
                }
            }
            State::Spreading(spread) if step_s > GAP_STEPS * spread.step_s => {
                self.settle(sink);
                self.keep(sample, sink);
            }
            State::Spreading(spread) => spread.push(sample, &mut |sample| sink(Fate::Kept(sample))),
        }
    }

    /// There are no more samples, or a stretch is over: what waits is handed out.
    pub(in crate::log) fn settle(&mut self, sink: &mut impl FnMut(Fate<T>)) {
        if let State::Looking(_) = self.state {
            self.judge(sink);
        }
        if let State::Spreading(spread) = &mut self.state {
            self.given_s = spread.finish(&mut |sample| sink(Fate::Kept(sample)));
            self.coarse.spread += spread.spread;
            self.coarse.unsure += spread.unsure;
            self.state = State::Fine;
        }
        let odd = self.back.last().is_some_and(|last| !self.adjoins(last.time_s()));
        self.lies_back = Back::Unknown;
        let fate = if odd { Fate::Stray } else { Fate::Kept };
        self.back.drain(..).for_each(|sample| sink(fate(sample)));
    }

    /// Whether a time lies in the stretch that was passed or hardly before it.
    fn adjoins(&self, time_s: f64) -> bool {
        time_s >= self.began_s - LEAP_STEPS * self.usual_s
    }

    fn keep(&mut self, sample: T, sink: &mut impl FnMut(Fate<T>)) {
        self.given_s = sample.time_s();
        sink(Fate::Kept(sample));
    }

    /// A sample after later ones: a few come late, many come from a writer of its own or from a clock that was set back; one or two
    /// that lie far from all others are odd.
    fn take_back(&mut self, sample: T, sink: &mut impl FnMut(Fate<T>)) {
        let inside = sample.time_s() >= self.began_s;
        match self.lies_back {
            Back::Again => return sink(Fate::Stray(sample)),
            Back::Late if !inside => return sink(Fate::Kept(sample)),
            Back::Late | Back::Unknown => self.back.push(sample),
        }
        let all_inside = self.back.first().is_some_and(|first| first.time_s() >= self.began_s);
        let many = self.back.len() >= MANY;
        if all_inside && many {
            self.lies_back = Back::Again;
            self.back.drain(..).for_each(|sample| sink(Fate::Stray(sample)));
        } else if !all_inside && (many || self.adjoins(sample.time_s())) {
            self.lies_back = Back::Late;
            self.back.drain(..).for_each(|sample| sink(Fate::Kept(sample)));
        }
    }

    fn judge(&mut self, sink: &mut impl FnMut(Fate<T>)) {
        let State::Looking(samples) = std::mem::replace(&mut self.state, State::Fine) else { return };
        let mut steps: Vec<f64> =
            samples.windows(2).map(|pair| pair[1].time_s() - pair[0].time_s()).collect();
        // The first one repeats the stamp before it.
        let repeated = 1 + steps.iter().filter(|step| **step == 0.0).count();
        let is_twice = |one: &T, other: &T| one.time_s() == other.time_s() && one.has_values_of(other);
        let twice = samples.windows(2).filter(|pair| is_twice(&pair[0], &pair[1])).count();
        steps.retain(|step| *step > 0.0);
        steps.sort_by(f64::total_cmp);
        let step_s = steps.get(steps.len() / 2).copied();
        let is_coarse = repeated as f64 > COARSE_SHARE * samples.len() as f64
            && !(twice as f64 > TWICE_SHARE * repeated as f64)
            && samples.len() >= FEWEST;
        let Some(step_s) = step_s.filter(|_| is_coarse) else { return self.without_repeats(samples, sink) };
        let last_s = samples.last().map_or(f64::NAN, Stamped::time_s);
        // With the one before, from the first step of the clock to the last.
        let before_last = 1 + samples.iter().filter(|sample| sample.time_s() < last_s).count();
        let rate_hz = before_last as f64 / (last_s - self.given_s);
        if step_s > self.coarse.step_s {
            (self.coarse.step_s, self.coarse.rate_hz) = (step_s, rate_hz);
        }
        if step_s > LONGEST_STEP_S {
            self.coarse.unspread += samples.len() as u64;
            return self.without_repeats(samples, sink);
        }
        let mut spread = Spread::new(step_s, rate_hz, self.given_s);
        let mut keep = |sample| sink(Fate::Kept(sample));
        samples.into_iter().for_each(|sample| spread.push(sample, &mut keep));
        self.state = State::Spreading(spread);
    }

    fn without_repeats(&mut self, samples: Vec<T>, sink: &mut impl FnMut(Fate<T>)) {
        for sample in samples {
            if sample.time_s() > self.given_s {
                self.keep(sample, sink);
            } else {
                sink(Fate::Repeated(sample));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Sample;
    use super::*;

    #[derive(Default)]
    struct Found {
        kept: Vec<Sample>,
        strays: usize,
        repeated: usize,
        coarse: Coarse,
    }

    fn through(samples: impl IntoIterator<Item = Sample>) -> Found {
        let mut found = Found::default();
        let mut series = Series::new();
        let mut sink = |fate: Fate<Sample>| match fate {
            Fate::Kept(sample) => found.kept.push(sample),
            Fate::Stray(_) => found.strays += 1,
            Fate::Repeated(_) => found.repeated += 1,
        };
        samples.into_iter().for_each(|sample| series.take(sample, &mut sink));
        series.settle(&mut sink);
        found.coarse = series.coarse();
        found
    }

    /// Sample `k` of `rate_hz`, its stamp cut off or rounded to a step.
    fn stepped(rate_hz: f64, step_s: f64, rounding: f64, k: u32) -> Sample {
        (((f64::from(k) / rate_hz + 1e-9) / step_s + rounding).floor() * step_s, k)
    }

    #[test]
    fn samples_under_a_coarse_clock_get_their_own_times() {
        for (rate_hz, step_s) in
            [(500.0, 0.01), (500.0, 0.015_625), (100.0, 0.015_625), (2000.0, 0.01), (500.0, 0.1)]
        {
            for rounding in [0.0, 0.5] {
                let samples = (0..8000).map(|k| stepped(rate_hz, step_s, rounding, k));
                let found = through(samples);
                assert_eq!(
                    (found.kept.len(), found.repeated, found.strays),
                    (8000, 0, 0),
                    "{rate_hz} {step_s}"
                );
                assert!(!found.coarse.is_unsure());
                // Even, but for where on the step all of them lie.
                let off: Vec<f64> =
                    found.kept.iter().map(|(time_s, k)| time_s - f64::from(*k) / rate_hz).collect();
                let mean = off.iter().sum::<f64>() / 8000.0;
                assert!(mean.abs() <= 0.5 * step_s + 1.0 / rate_hz, "{rate_hz} {step_s}: {mean}");
                let worst = off.iter().skip(100).fold(0.0f64, |worst, off| worst.max((off - mean).abs()));
                // A sixteenth of the steps under the mean may be cut: half a step over sixteen.
                assert!(worst <= step_s / 16.0, "{rate_hz} {step_s} {rounding}: {worst}");
            }
        }
    }

    #[test]
    fn six_digits_pass_from_fine_to_coarse() {
        let digits = |k: u32| {
            let time_s = 990.0 + f64::from(k) * 0.002;
            let text = if time_s < 1000.0 { format!("{time_s:.3}") } else { format!("{time_s:.2}") };
            (text.parse().unwrap(), k)
        };
        let found = through((0..10_000).map(digits));
        assert_eq!((found.kept.len(), found.coarse.is_unsure()), (10_000, false));
        for (time_s, k) in found.kept {
            assert!((time_s - 990.0 - f64::from(k) * 0.002).abs() < 0.0025, "{k} {time_s}");
        }
    }

    #[test]
    fn what_is_uneven_under_a_coarse_clock_is_not_sure() {
        // Every few seconds the rate changes by a factor of three.
        let mut time_s = 0.0f64;
        let uneven = (0..20_000).map(|k: u32| {
            time_s += if (k / 97).is_multiple_of(2) { 0.001 } else { 0.006 };
            (((time_s + 1e-9) / 0.02).floor() * 0.02, k)
        });
        assert!(through(uneven).coarse.is_unsure());
        // Whole seconds.
        assert!(through((0..20_000).map(|k| stepped(500.0, 1.0, 0.0, k))).coarse.is_unsure());
    }

    #[test]
    fn a_sample_written_twice_is_left_out_and_the_others_stay() {
        let every = |many: u32| {
            (0..4000).flat_map(move |k: u32| {
                vec![(f64::from(k) * 0.002, k); if k.is_multiple_of(many) { 2 } else { 1 }]
            })
        };
        for many in [1, 50] {
            let found = through(every(many));
            assert_eq!(
                (found.kept.len(), found.repeated, found.coarse.spread),
                (4000, 4000 / many as usize, 0)
            );
        }
        // With other values it is not known which is right: the first stays.
        let odd = (0..4000).map(|k: u32| (f64::from(if k == 2000 { 1999 } else { k }) * 0.002, k));
        let found = through(odd);
        assert_eq!((found.kept.len(), found.repeated, found.coarse.spread), (3999, 1, 0));
    }

    #[test]
    fn late_samples_stay_and_a_stretch_again_does_not() {
        // Three samples 20 ms late.
        let late =
            |k: u32| if (1000..1003).contains(&(k % 2000)) { f64::from(k) + 10.5 } else { f64::from(k) };
        let mut file: Vec<u32> = (0..6000).collect();
        file.sort_by(|a, b| late(*a).total_cmp(&late(*b)));
        let found = through(file.into_iter().map(|k| (f64::from(k) * 0.002, k)));
        assert_eq!((found.kept.len(), found.strays), (6000, 0));
        // Blocks of a second in another order.
        let found = through((0..6000).map(|k: u32| (f64::from(((k / 500) ^ 1) * 500 + k % 500) * 0.002, k)));
        assert_eq!((found.kept.len(), found.strays), (6000, 0));
        // Set back by three seconds: 1500 samples until it is where it was.
        let found =
            through((0..6000).map(|k: u32| (f64::from(k) * 0.002 - if k < 3000 { 0.0 } else { 3.0003 }, k)));
        assert!((1499..=1501).contains(&found.strays) && found.kept.len() + found.strays == 6000);
    }
}
