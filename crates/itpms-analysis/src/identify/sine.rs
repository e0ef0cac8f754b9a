//! Stretches of a steady sine in a record, and their frequency by least squares
//! (docs/math/identification.md, section 2.1). Called by the damper's identification.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::strokes::strokes;
use super::{IdentifyError, Result, guard};

/// Periods a stretch must have.
pub(super) const FEWEST_PERIODS: usize = 5;
/// Change of period or amplitude from which a stretch is another one.
const ANOTHER: (f64, f64) = (0.025, 0.1);
/// Difference of two periods, rms as a share of their height, up to which they are of one sine. A row too early or late at
/// the fewest rows per period makes a tenth of the height at its steepest, 5 % rms if it is half a row.
const SAME: f64 = 0.06;
/// A pause of so many sampling times begins a new stretch.
const PAUSE: f64 = 10.0;

/// One sine through the rows of a stretch: `mean + drift tau + cosine cos(omega tau) + sine sin(omega tau)`, where `tau`
/// is the time from `center_s`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sine {
    pub(super) center_s: f64,
    pub(super) omega: f64,
    pub(super) cosine: f64,
    pub(super) sine: f64,
    pub(super) residual_rms: f64,
}

impl Sine {
    pub(super) fn amplitude(&self) -> f64 {
        self.cosine.hypot(self.sine)
    }

    /// Whole turns since the sine last rose through its mean near the center.
    pub(super) fn turns(&self, time_s: f64) -> f64 {
        (self.omega * (time_s - self.center_s) + self.cosine.atan2(self.sine)) / TAU
    }
}

/// Stretches of one steady sine in a record, as rows, and the rows that belong to none.
pub(super) fn stretches(time_s: &[f64], x: &[f64]) -> Result<Vec<Range<usize>>> {
    let mut found = Vec::new();
    let mut longest = 0;
    for piece in pieces(time_s)? {
        let groups = groups(&time_s[piece.clone()], &x[piece.clone()]);
        let several = groups.len() > 1;
        for group in groups {
            // A joint between two sines is neither; a period on each side is left out.
            let (t, x) = (&time_s[piece.clone()], &x[piece.clone()]);
            let (start, end, periods) = if several { group.trimmed() } else { extended(group.whole(), t, x) };
            longest = longest.max(periods);
            if periods >= FEWEST_PERIODS {
                let first = t.partition_point(|t| *t < start);
                let last = t.partition_point(|t| *t <= end);
                found.push(piece.start + first..piece.start + last);
            }
        }
    }
    if found.is_empty() {
        return Err(IdentifyError::TooFewPeriods { found: longest, expected: FEWEST_PERIODS });
    }
    Ok(found)
}

/// Parts of a record without a pause.
fn pieces(time_s: &[f64]) -> Result<Vec<Range<usize>>> {
    let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
    if let Some(i) = steps.iter().position(|step| !(*step > 0.0)) {
        return Err(IdentifyError::time_order(i + 2, time_s[i], time_s[i + 1]));
    }
    let usual = median(&mut steps);
    let mut out = Vec::new();
    let mut start = 0;
    for i in 1..time_s.len() {
        if time_s[i] - time_s[i - 1] > PAUSE * usual {
            out.push(start..i);
            start = i;
        }
    }
    out.push(start..time_s.len());
    Ok(out)
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Strokes of equal period and amplitude: the times at which their middles are passed.
struct Group(Vec<f64>);

impl Group {
    fn whole(&self) -> (f64, f64, usize) {
        let times = &self.0;
        let periods = times.len().saturating_sub(1) / 2;
        let end = times.get(2 * periods).or(times.last()).copied().unwrap_or(f64::NAN);
        (times.first().copied().unwrap_or(f64::NAN), end, periods)
    }

    fn trimmed(&self) -> (f64, f64, usize) {
        match self.0.len() {
            n if n > 4 => Group(self.0[2..n - 2].to_vec()).whole(),
            _ => (f64::NAN, f64::NAN, 0),
        }
    }
}

/// The stretch with what lies before its first and behind its last whole stroke, as far as a period and where it looks like
/// the next or the last period.
fn extended((start, end, periods): (f64, f64, usize), time_s: &[f64], x: &[f64]) -> (f64, f64, usize) {
    let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else { return (start, end, periods) };
    if periods == 0 {
        return (start, end, periods);
    }
    let period = (end - start) / periods as f64;
    let rows =
        |from: f64, to: f64| time_s.partition_point(|t| *t < from)..time_s.partition_point(|t| *t <= to);
    let inside = rows(start, end);
    let shift = (inside.len() as f64 / periods as f64).round() as usize;
    let (low, high) = guard::range(&x[inside]);
    let alike = |extra: Range<usize>, partner: &dyn Fn(usize) -> Option<f64>| {
        let squares: f64 =
            extra.clone().map(|i| partner(i).map_or(f64::NAN, |other| (x[i] - other).powi(2))).sum();
        squares <= extra.len() as f64 * (SAME * (high - low)).powi(2)
    };
    let (earlier, later) = (first.max(start - period), last.min(end + period));
    let before = rows(earlier, start);
    let after = rows(end, later);
    let start = if alike(before, &|i| x.get(i + shift).copied()) { earlier } else { start };
    let end =
        if alike(after, &|i| i.checked_sub(shift).and_then(|i| x.get(i).copied())) { later } else { end };
    // A record of whole periods ends a row before the last is complete.
    (start, end, ((end - start) / period + 0.05).floor() as usize)
}

fn groups(time_s: &[f64], x: &[f64]) -> Vec<Group> {
    let (low, high) = guard::range(x);
    let mut bends: Vec<f64> = x.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).collect();
    // Noise of rms sigma has second differences of sqrt(6) sigma, and a median of 0.67 of that.
    let noise = if bends.is_empty() { 0.0 } else { median(&mut bends) / (0.6745 * 6f64.sqrt()) };
    let threshold = (8.0 * noise).clamp(0.02 * (high - low), 0.3 * (high - low));
    let found = strokes(x, threshold);
    // Strokes between two turning points: when their middle is passed, and how long they are.
    let inner = found.get(1..found.len().saturating_sub(1)).unwrap_or_default();
    let middles: Vec<(f64, f64)> = inner
        .iter()
        .map(|stroke| {
            let rows = stroke.start - 1..stroke.end;
            let (from, to) = (x[rows.start], x[rows.end - 1]);
            (passing(&time_s[rows.clone()], &x[rows], 0.5 * (from + to)), (to - from).abs())
        })
        .collect();
    let mut out = Vec::new();
    let mut start = 0;
    while start + 2 < middles.len() {
        let period = |i: usize| middles[i + 2].0 - middles[i].0;
        let same = |i: usize| {
            (period(i) / period(start) - 1.0).abs() < ANOTHER.0
                && (middles[i].1 / middles[start].1 - 1.0).abs() < ANOTHER.1
        };
        let mut end = start;
        while end + 2 < middles.len() && same(end) {
            end += 1;
        }
        let times: Vec<f64> = middles[start..=end + 1].iter().map(|m| m.0).collect();
        out.push(Group(times));
        start = end.max(start + 1);
    }
    out.retain(|group| group.0.len() >= 5);
    out
}

/// When a level is passed: the mean of the first and the last time, should noise pass it often.
fn passing(time_s: &[f64], x: &[f64], level: f64) -> f64 {
    let times = (1..x.len()).filter(|i| (x[i - 1] - level) * (x[*i] - level) <= 0.0).map(|i| {
        let step = x[i] - x[i - 1];
        let share = if step == 0.0 { 0.5 } else { (level - x[i - 1]) / step };
        time_s[i - 1] + share * (time_s[i] - time_s[i - 1])
    });
    let (first, last) = times.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
    0.5 * (first + last)
}

/// The sine of free frequency through a stretch, by Gauss and Newton from the frequency of its turns.
pub(super) fn fit(time_s: &[f64], x: &[f64]) -> Option<Sine> {
    let found = groups(time_s, x);
    let (start, end, periods) = found.iter().map(Group::whole).max_by_key(|(_, _, periods)| *periods)?;
    let mut omega = TAU * periods as f64 / (end - start);
    let mut sine = at(omega, time_s, x)?;
    for _ in 0..20 {
        let step = correction(&sine, time_s, x)?;
        omega += step;
        sine = at(omega, time_s, x)?;
        if step.abs() < 1e-12 * omega {
            break;
        }
    }
    (omega > 0.0).then_some(sine)
}

/// Sum over rows of the outer product of `columns(tau)` and its product with a target, solved.
fn linear<const N: usize>(
    center_s: f64,
    time_s: &[f64],
    target: &[f64],
    columns: impl Fn(f64) -> SVector<f64, N>,
) -> Option<SVector<f64, N>> {
    let (mut xx, mut xy) = (SMatrix::<f64, N, N>::zeros(), SVector::<f64, N>::zeros());
    for (t, y) in time_s.iter().zip(target) {
        let row = columns(t - center_s);
        xx += row * row.transpose();
        xy += row * *y;
    }
    Some(xx.cholesky()?.solve(&xy))
}

/// The sine of a given frequency through a signal.
pub(super) fn at(omega: f64, time_s: &[f64], x: &[f64]) -> Option<Sine> {
    let (first, last) = (*time_s.first()?, *time_s.last()?);
    let (center_s, span) = (0.5 * (first + last), last - first);
    let columns = |tau: f64| {
        let (s, c) = (omega * tau).sin_cos();
        SVector::<f64, 4>::new(1.0, tau / span, c, s)
    };
    let q = linear(center_s, time_s, x, columns)?;
    let squares: f64 = time_s.iter().zip(x).map(|(t, x)| (x - q.dot(&columns(t - center_s))).powi(2)).sum();
    let residual_rms = (squares / x.len() as f64).sqrt();
    Some(Sine { center_s, omega, cosine: q[2], sine: q[3], residual_rms })
}

/// Gauss and Newton's step of the angular frequency.
fn correction(sine: &Sine, time_s: &[f64], x: &[f64]) -> Option<f64> {
    let span = time_s.last()? - time_s.first()?;
    let q = linear(sine.center_s, time_s, x, |tau| {
        let (s, c) = (sine.omega * tau).sin_cos();
        let slope = tau / span * (sine.sine * c - sine.cosine * s) / sine.amplitude();
        SVector::<f64, 5>::new(1.0, tau / span, c, s, slope)
    })?;
    Some(q[4] / (span * sine.amplitude()))
}

/// Displacement with its first three harmonics through the rows of a block, free of the sensor's noise: displacement and
/// velocity of every row.
pub(super) fn smooth(sine: &Sine, time_s: &[f64], x: &[f64]) -> Option<Vec<(f64, f64)>> {
    let (first, last) = (*time_s.first()?, *time_s.last()?);
    let (center_s, span) = (0.5 * (first + last), last - first);
    let omega = sine.omega;
    let columns = |tau: f64| {
        let mut row = SVector::<f64, 8>::zeros();
        row[0] = 1.0;
        row[1] = tau / span;
        for h in 1..=3 {
            let (s, c) = (h as f64 * omega * tau).sin_cos();
            row[2 * h] = c;
            row[2 * h + 1] = s;
        }
        row
    };
    let q = linear(center_s, time_s, x, columns)?;
    let velocity = |row: &SVector<f64, 8>| {
        (1..=3).fold(q[1] / span, |sum, h| {
            sum + h as f64 * omega * (q[2 * h + 1] * row[2 * h] - q[2 * h] * row[2 * h + 1])
        })
    };
    Some(
        time_s
            .iter()
            .map(|t| {
                let row = columns(t - center_s);
                (q.dot(&row), velocity(&row))
            })
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(rate: f64, seconds: f64, of: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let t: Vec<f64> = (0..(rate * seconds) as usize).map(|i| i as f64 / rate).collect();
        let x = t.iter().map(|t| of(*t)).collect();
        (t, x)
    }

    #[test]
    fn a_frequency_between_the_bins_of_a_spectrum_is_found() {
        // 7.3 periods of 1.2345 Hz with an offset: bins of a transform are 0.17 Hz apart.
        let (t, x) = wave(200.0, 7.3 / 1.2345, |t| 0.3 + 0.02 * (TAU * 1.2345 * t + 0.7).sin());
        let sine = fit(&t, &x).unwrap();
        assert!((sine.omega / TAU - 1.2345).abs() < 1e-9, "{}", sine.omega / TAU);
        assert!((sine.amplitude() - 0.02).abs() < 1e-11);
        // It rises through its mean where 1.2345 t + 0.7 / tau is whole.
        let rise = (1.0 - 0.7 / TAU) / 1.2345;
        let turns = sine.turns(rise);
        assert!((turns - turns.round()).abs() < 1e-9);
    }

    #[test]
    fn several_frequencies_in_a_row_are_distinguished() {
        // 8 periods of 1 Hz, then 20 of 3 Hz with a third of the amplitude, then a pause, then 10 of 1.5 Hz.
        let (mut t, mut x) = wave(300.0, 8.0 + 20.0 / 3.0 + 10.0 / 1.5, |t| {
            let second = 8.0 + 20.0 / 3.0;
            if t < 8.0 {
                0.03 * (TAU * t).sin()
            } else if t < second {
                0.01 * (TAU * 3.0 * (t - 8.0)).sin()
            } else {
                0.02 * (TAU * 1.5 * (t - second)).sin()
            }
        });
        for (i, t) in t.iter_mut().enumerate() {
            if i as f64 / 300.0 >= 8.0 + 20.0 / 3.0 {
                *t += 2.0;
            }
        }
        // Resolution of the sensor.
        for x in &mut x {
            *x = (*x / 2e-5).round() * 2e-5;
        }
        let found = stretches(&t, &x).unwrap();
        let frequencies: Vec<f64> =
            found.iter().map(|r| fit(&t[r.clone()], &x[r.clone()]).unwrap().omega / TAU).collect();
        assert_eq!(found.len(), 3, "{found:?}");
        for (found, expected) in frequencies.iter().zip([1.0, 3.0, 1.5]) {
            assert!((found / expected - 1.0).abs() < 1e-3, "{frequencies:?}");
        }
    }

    #[test]
    fn a_sweep_and_a_short_record_have_no_steady_sine() {
        let (t, x) = wave(500.0, 20.0, |t| 0.02 * (TAU * (0.5 * t + 0.2 * t * t)).sin());
        assert!(matches!(stretches(&t, &x), Err(IdentifyError::TooFewPeriods { .. })));
        let (t, x) = wave(500.0, 3.9, |t| 0.02 * (TAU * t).sin());
        assert!(matches!(stretches(&t, &x), Err(IdentifyError::TooFewPeriods { found: 0..=3, .. })));
    }

    #[test]
    fn velocity_is_the_slope_of_the_displacement() {
        let (t, x) =
            wave(400.0, 3.0, |t| 0.02 * (TAU * 2.0 * t).sin() + 0.001 * (TAU * 4.0 * t).cos() + 0.001 * t);
        let sine = at(TAU * 2.0, &t, &x).unwrap();
        for (t, (_, v)) in t.iter().zip(smooth(&sine, &t, &x).unwrap()) {
            let expected =
                0.02 * TAU * 2.0 * (TAU * 2.0 * t).cos() - 0.001 * TAU * 4.0 * (TAU * 4.0 * t).sin() + 0.001;
            assert!((v - expected).abs() < 1e-9, "{v} {expected}");
        }
    }
}
