//! Curves of bounded size from streams of any length.
//!
//! A [`Track`] holds at most a fixed number of buckets along `x` (time, or distance). When they are used up,
//! neighbours merge and every bucket becomes twice as wide. Of each bucket the extremes stay, with their order, and
//! the mean: a spike of one sample in ten hours is still drawn.

/// The statistic of a bucket that a curve shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// Smallest and largest value in the order they came.
    Extremes,
    /// The smallest value: for the lower edge of a band.
    Lowest,
    /// The largest value: for the upper edge of a band.
    Highest,
    Mean,
}

/// One channel's share of a bucket. Missing values (NaN) leave no trace in it.
#[derive(Debug, Clone, Copy)]
struct Extent {
    min: f64,
    min_at: f64,
    max: f64,
    max_at: f64,
    sum: f64,
    count: f64,
}

impl Extent {
    const EMPTY: Self = Self {
        min: f64::INFINITY,
        min_at: f64::NAN,
        max: f64::NEG_INFINITY,
        max_at: f64::NAN,
        sum: 0.0,
        count: 0.0,
    };

    fn take(&mut self, x: f64, value: f64) {
        if value.is_finite() {
            self.merge(&Self { min: value, min_at: x, max: value, max_at: x, sum: value, count: 1.0 });
        }
    }

    fn merge(&mut self, later: &Self) {
        if later.min < self.min {
            (self.min, self.min_at) = (later.min, later.min_at);
        }
        if later.max > self.max {
            (self.max, self.max_at) = (later.max, later.max_at);
        }
        self.sum += later.sum;
        self.count += later.count;
    }

    /// The two values drawn at a bucket's first and last `x`.
    fn pair(&self, keep: Keep) -> (f64, f64) {
        if !(self.count > 0.0) {
            return (f64::NAN, f64::NAN);
        }
        match keep {
            Keep::Extremes if self.min_at <= self.max_at => (self.min, self.max),
            Keep::Extremes => (self.max, self.min),
            Keep::Lowest => (self.min, self.min),
            Keep::Highest => (self.max, self.max),
            Keep::Mean => (self.sum / self.count, self.sum / self.count),
        }
    }
}

#[derive(Debug, Clone)]
struct Bucket {
    slot: u64,
    first_x: f64,
    last_x: f64,
    samples: u64,
    extents: Box<[Extent]>,
}

impl Bucket {
    fn merge(&mut self, later: &Self) {
        self.last_x = later.last_x;
        self.samples += later.samples;
        for (mine, other) in self.extents.iter_mut().zip(&later.extents) {
            mine.merge(other);
        }
    }
}

/// Some channels over a common, increasing `x`.
#[derive(Debug, Clone)]
pub struct Track {
    channels: usize,
    capacity: usize,
    width: f64,
    buckets: Vec<Bucket>,
}

impl Track {
    /// An empty track of `channels` values per `x`, at first in buckets of `width` (as fine as is of interest), never
    /// more than `capacity` of them (at least 2). Up to twice as many points are drawn.
    pub fn new(channels: usize, width: f64, capacity: usize) -> Self {
        let width = if width > 0.0 { width } else { f64::MIN_POSITIVE };
        Self { channels, capacity: capacity.max(2), width, buckets: Vec::new() }
    }

    /// Takes one value per channel at `x`; NaN is a missing value, channels left out are missing, an `x` before the
    /// last one counts as the last. Values at an `x` that is not finite are dropped.
    pub fn push(&mut self, x: f64, values: &[f64]) {
        if !x.is_finite() {
            return;
        }
        let (mut x, mut slot) = (x, 0);
        if let (Some(first), Some(last)) = (self.buckets.first(), self.buckets.last()) {
            x = x.max(last.last_x);
            slot = (((x - first.first_x) / self.width) as u64).max(last.slot);
        }
        if self.buckets.last().is_none_or(|last| last.slot != slot) {
            let extents = vec![Extent::EMPTY; self.channels].into();
            self.buckets.push(Bucket { slot, first_x: x, last_x: x, samples: 0, extents });
        }
        if let Some(bucket) = self.buckets.last_mut() {
            bucket.last_x = x;
            bucket.samples += 1;
            for (extent, value) in bucket.extents.iter_mut().zip(values) {
                extent.take(x, *value);
            }
        }
        while self.buckets.len() > self.capacity {
            self.coarsen();
        }
    }

    fn coarsen(&mut self) {
        self.width *= 2.0;
        let mut merged: Vec<Bucket> = Vec::with_capacity(self.buckets.len());
        for mut bucket in self.buckets.drain(..) {
            bucket.slot /= 2;
            match merged.last_mut() {
                Some(last) if last.slot == bucket.slot => last.merge(&bucket),
                _ => merged.push(bucket),
            }
        }
        self.buckets = merged;
    }

    pub fn len(&self) -> usize {
        self.buckets.len()
    }

    /// True before the first value.
    pub fn is_empty(&self) -> bool {
        self.buckets.is_empty()
    }

    /// Present width of a bucket.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The `x` of every drawn point: one for a bucket that holds one sample, two for any other, and one without
    /// values in every hole of the data.
    pub fn x(&self) -> Vec<f64> {
        self.draw(|bucket| (bucket.first_x, bucket.last_x), |hole| hole)
    }

    /// One channel's values at the points of [`x`](Self::x); NaN where there are none.
    pub fn curve(&self, channel: usize, keep: Keep) -> Vec<f64> {
        self.draw(|bucket| bucket.extents.get(channel).unwrap_or(&Extent::EMPTY).pair(keep), |_| f64::NAN)
    }

    /// One value per bucket, drawn at the points of [`x`](Self::x). As long as `values` has one for each.
    pub fn spread(&self, values: &[f64]) -> Vec<f64> {
        let mut next = values.iter();
        self.draw(
            |_| {
                let value = next.next().copied().unwrap_or(f64::NAN);
                (value, value)
            },
            |_| f64::NAN,
        )
    }

    fn draw(&self, mut pair: impl FnMut(&Bucket) -> (f64, f64), hole: impl Fn(f64) -> f64) -> Vec<f64> {
        let longest = self.longest_step();
        let mut points = Vec::with_capacity(2 * self.buckets.len());
        let mut last_x = f64::NAN;
        for bucket in &self.buckets {
            if bucket.first_x - last_x > longest {
                points.push(hole(0.5 * (last_x + bucket.first_x)));
            }
            let (first, last) = pair(bucket);
            points.push(first);
            if bucket.samples > 1 {
                points.push(last);
            }
            last_x = bucket.last_x;
        }
        points
    }

    /// Steps between buckets above this are holes in the data: eight times the median, and two buckets.
    fn longest_step(&self) -> f64 {
        let mut steps: Vec<f64> =
            self.buckets.windows(2).map(|pair| pair[1].first_x - pair[0].first_x).collect();
        steps.sort_by(f64::total_cmp);
        let median = steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY);
        (8.0 * median).max(2.0 * self.width)
    }

    /// One channel's mean in each bucket, beside the bucket's middle `x`.
    pub fn means(&self, channel: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.buckets.iter().map(move |bucket| {
            let extent = bucket.extents.get(channel).unwrap_or(&Extent::EMPTY);
            (0.5 * (bucket.first_x + bucket.last_x), extent.sum / extent.count)
        })
    }

    /// One channel's mean in each bucket, beside the middle of the bucket's place, whether data fills it or not.
    pub fn places(&self, channel: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let start = self.buckets.first().map_or(f64::NAN, |bucket| bucket.first_x);
        let middle = move |bucket: &Bucket| start + (bucket.slot as f64 + 0.5) * self.width;
        self.buckets.iter().map(middle).zip(self.means(channel).map(|(_, mean)| mean))
    }

    /// Stretches of constant value, `(from, to, value)`, of a channel that holds codes; the largest code in a bucket stands for all of it.
    pub fn runs(&self, channel: usize) -> Vec<(f64, f64, f64)> {
        let longest = self.longest_step();
        let mut runs: Vec<(f64, f64, f64)> = Vec::new();
        for (i, bucket) in self.buckets.iter().enumerate() {
            let code = bucket.extents.get(channel).unwrap_or(&Extent::EMPTY).max;
            if !code.is_finite() {
                continue;
            }
            let next = self.buckets.get(i + 1).map_or(bucket.last_x, |next| next.first_x);
            let end = if next - bucket.last_x > longest { bucket.last_x } else { next };
            match runs.last_mut() {
                Some(run) if run.2 == code && run.1 == bucket.first_x => run.1 = end,
                _ => runs.push((bucket.first_x, end, code)),
            }
        }
        runs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_record_is_kept_as_it_is() {
        let mut track = Track::new(1, 0.001, 100);
        for i in 0..50 {
            track.push(f64::from(i) * 0.1, &[f64::from(i * i)]);
        }
        assert_eq!(track.x(), (0..50).map(|i| f64::from(i) * 0.1).collect::<Vec<_>>());
        assert_eq!(track.curve(0, Keep::Extremes), (0..50).map(|i| f64::from(i * i)).collect::<Vec<_>>());
    }

    #[test]
    fn a_long_record_stays_small_and_keeps_its_extremes() {
        // Ten hours at 100 Hz with one sample up and one down, as far apart as a bucket at its end is wide.
        let mut track = Track::new(2, 0.01, 2000);
        let n = 3_600_000;
        for i in 0..n {
            let spike = if i == 1_234_567 {
                9.0
            } else if i == 1_234_570 {
                -7.0
            } else {
                0.5
            };
            track.push(f64::from(i) * 0.01, &[spike, f64::from(i)]);
        }
        assert!(track.len() <= 2000 && track.len() > 900);
        let (x, y) = (track.x(), track.curve(0, Keep::Extremes));
        assert!(x.len() <= 4000 && x.len() == y.len());
        assert!(x.is_sorted());
        let up = y.iter().position(|v| *v == 9.0).unwrap();
        assert_eq!(y[up + 1], -7.0, "in the order they came");
        assert!((x[up] - 12_345.67).abs() <= track.width());
        assert_eq!(track.curve(0, Keep::Highest).iter().copied().fold(0.0, f64::max), 9.0);
        assert_eq!(track.curve(0, Keep::Lowest).iter().copied().fold(0.0, f64::min), -7.0);
        // Means weigh each sample once: a straight line's mean is its value in the bucket's middle.
        for (x, mean) in track.means(1) {
            assert!((mean - x / 0.01).abs() < 1e-3);
        }
    }

    #[test]
    fn missing_values_are_missing_and_holes_stay_open() {
        let mut track = Track::new(1, 0.1, 1000);
        for i in 0..20 {
            track.push(f64::from(i), &[if i < 5 { f64::NAN } else { 1.0 }]);
        }
        track.push(f64::NAN, &[99.0]);
        for i in 100..120 {
            track.push(f64::from(i), &[1.0]);
        }
        let (x, y) = (track.x(), track.curve(0, Keep::Mean));
        assert_eq!(x.len(), 41);
        assert!(y[4].is_nan() && y[5] == 1.0);
        assert!(x[20] > 19.0 && x[20] < 100.0 && y[20].is_nan());
        assert!(!y.contains(&99.0));
    }

    #[test]
    fn time_never_runs_backwards() {
        let mut track = Track::new(1, 0.1, 10);
        for x in [0.0, 5.0, 3.0, 6.0] {
            track.push(x, &[x]);
        }
        assert!(track.x().is_sorted());
        track.push(1e300, &[0.0]);
        assert!(track.x().iter().all(|x| x.is_finite()));
    }

    #[test]
    fn runs_join_equal_codes_and_show_the_worst() {
        let mut track = Track::new(1, 0.1, 1000);
        for i in 0..30 {
            track.push(f64::from(i), &[if (10..20).contains(&i) { 2.0 } else { 0.0 }]);
        }
        assert_eq!(track.runs(0), [(0.0, 10.0, 0.0), (10.0, 20.0, 2.0), (20.0, 29.0, 0.0)]);
        let mut coarse = Track::new(1, 10.0, 1000);
        for i in 0..30 {
            coarse.push(f64::from(i), &[f64::from(u8::from(i == 15))]);
        }
        assert_eq!(coarse.runs(0), [(0.0, 10.0, 0.0), (10.0, 20.0, 1.0), (20.0, 29.0, 0.0)]);
    }

    #[test]
    fn one_value_per_bucket_is_spread_over_its_points() {
        let mut track = Track::new(1, 1.0, 100);
        [0.0, 0.5, 1.0, 2.0, 2.5].into_iter().for_each(|x| track.push(x, &[0.0]));
        assert_eq!(track.spread(&[7.0, 8.0, 9.0]), [7.0, 7.0, 8.0, 9.0, 9.0]);
    }
}
