//! Holes and bumps of a track: what stands out of the road around it (docs/math/road.md, section 9).
//!
//! Takes even heights as a stream; memory is a block of 100 m. Knows nothing of where the heights come from.

use std::collections::VecDeque;

/// Length of road in m whose median a height is compared with.
const AROUND_M: f64 = 4.0;
/// Every so many metres a height counts for that median.
const STEP_M: f64 = 0.2;
/// What stands out by less, in m, is no hole of a road.
const LEAST_M: f64 = 6e-3;
/// And by so many robust standard deviations of the block it lies in.
const CERTAIN: f64 = 10.0;
const BLOCK_M: f64 = 100.0;
/// A median absolute deviation over a normal distribution's standard deviation, inverted.
const MAD_TO_SD: f64 = 1.4826;
/// Parts less than this apart in m are one hole.
const BRIDGED_M: f64 = 0.3;
/// Sd of a height where the tire spans a short hole, or does not follow a deep one: in m, and as a share of the height.
const SPANNED_SD_M: f64 = 3e-3;
const SPANNED_SD_SHARE: f64 = 0.2;

/// A hole or a bump that a wheel went over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anomaly {
    /// Where its deepest or highest place is, in m of distance.
    pub at_m: f64,
    pub time_s: f64,
    /// Height of that place over the road around it, in m; negative: a hole. A tire spans what is short, so that a short hole reads shallow.
    pub height_m: f64,
    pub height_sd_m: f64,
    /// Its length in m, as far as it stands out.
    pub length_m: f64,
}

impl Anomaly {
    /// `hole` or `bump`.
    pub fn kind(&self) -> &'static str {
        if self.height_m < 0.0 { "hole" } else { "bump" }
    }
}

#[derive(Debug, Clone, Copy)]
struct Place {
    at_m: f64,
    time_s: f64,
    /// Height in m; over the road around, once that is known.
    height_m: f64,
}

/// Looks for the anomalies of a track.
#[derive(Debug)]
pub struct AnomalySearch {
    spacing_m: f64,
    /// Heights of which what is around is not known yet, the first half of them for those that follow.
    around: VecDeque<Place>,
    /// Places of the block, over the road around each.
    block: Vec<Place>,
    found: Vec<Anomaly>,
}

impl AnomalySearch {
    /// A track of heights `spacing_m` apart.
    pub fn new(spacing_m: f64) -> Self {
        Self { spacing_m, around: VecDeque::new(), block: Vec::new(), found: Vec::new() }
    }

    fn places(&self, length_m: f64) -> usize {
        (length_m / self.spacing_m).round() as usize
    }

    /// The height at `at_m`, passed at `time_s`; NaN, or a distance that does not follow, ends a stretch.
    pub fn push(&mut self, at_m: f64, time_s: f64, height_m: f64) {
        let last_m = self.around.back().map_or(at_m, |last| last.at_m);
        if !height_m.is_finite() || (at_m - last_m).abs() > 1.5 * self.spacing_m {
            self.end_stretch();
        }
        if !height_m.is_finite() {
            return;
        }
        self.around.push_back(Place { at_m, time_s, height_m });
        let half = self.places(0.5 * AROUND_M);
        if self.around.len() > 2 * half {
            self.note(half);
            self.around.pop_front();
        }
        if self.block.len() >= self.places(BLOCK_M) {
            self.end_block(false);
        }
    }

    /// A place that has road on both sides, as it stands over that.
    fn note(&mut self, middle: usize) {
        let step = self.places(STEP_M).max(1);
        let mut heights: Vec<f64> = self.around.iter().step_by(step).map(|place| place.height_m).collect();
        let median = heights.len() / 2;
        let (_, median_m, _) = heights.select_nth_unstable_by(median, f64::total_cmp);
        let median_m = *median_m;
        if let Some(place) = self.around.get(middle) {
            self.block.push(Place { height_m: place.height_m - median_m, ..*place });
        }
    }

    /// Finds what stands out of a block; what may go on in the next one waits for it.
    fn end_block(&mut self, is_last: bool) {
        let mut sizes: Vec<f64> = self.block.iter().map(|place| place.height_m.abs()).collect();
        if sizes.is_empty() {
            return;
        }
        let median = sizes.len() / 2;
        let sd_m = MAD_TO_SD * *sizes.select_nth_unstable_by(median, f64::total_cmp).1;
        let least_m = LEAST_M.max(CERTAIN * sd_m);
        let bridged = self.places(BRIDGED_M).max(1);
        let stands_out = |place: &Place| place.height_m.abs() > least_m;
        let (mut i, mut kept) = (0, self.block.len());
        while let Some(from) = (i..self.block.len()).find(|&i| stands_out(&self.block[i])) {
            let mut to = from;
            while let Some(next) =
                (to + 1..self.block.len().min(to + 1 + bridged)).rev().find(|&i| stands_out(&self.block[i]))
            {
                to = next;
            }
            if !is_last && to + bridged >= self.block.len() && from > 0 {
                kept = from;
                break;
            }
            let deepest =
                self.block[from..=to].iter().max_by(|a, b| a.height_m.abs().total_cmp(&b.height_m.abs()));
            if let Some(&Place { at_m, time_s, height_m }) = deepest {
                let length_m = self.block[to].at_m - self.block[from].at_m + self.spacing_m;
                let height_sd_m = sd_m.hypot(SPANNED_SD_M).hypot(SPANNED_SD_SHARE * height_m);
                self.found.push(Anomaly { at_m, time_s, height_m, height_sd_m, length_m });
            }
            i = to + 1;
        }
        self.block.drain(..kept);
    }

    fn end_stretch(&mut self) {
        self.end_block(true);
        self.around.clear();
    }

    /// The track is over: its anomalies in order.
    pub fn finish(mut self) -> Vec<Anomaly> {
        self.end_stretch();
        self.found
    }
}

/// One hole as the front and the rear wheel of a side found it, and how often.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideAnomaly {
    /// The mean of the wheels' findings, at the distance of the first.
    pub anomaly: Anomaly,
    /// How many wheels went over it and found it.
    pub passes: usize,
}

/// Puts together what the wheels of a side found, each list in order and by the distance of the road: within `within_m` it is the same hole.
pub fn of_a_side(wheels: &[Vec<Anomaly>], within_m: f64) -> Vec<SideAnomaly> {
    let mut all: Vec<Anomaly> = wheels.iter().flatten().copied().collect();
    all.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
    let mut found: Vec<SideAnomaly> = Vec::new();
    for anomaly in all {
        let same = |last: &&mut SideAnomaly| {
            last.passes < wheels.len()
                && anomaly.at_m - last.anomaly.at_m <= within_m
                && anomaly.kind() == last.anomaly.kind()
        };
        match found.last_mut().filter(same) {
            None => found.push(SideAnomaly { anomaly, passes: 1 }),
            Some(last) => {
                let share = 1.0 / (last.passes + 1) as f64;
                let mean = |a: f64, b: f64| a + share * (b - a);
                let one = last.anomaly;
                last.anomaly = Anomaly {
                    at_m: one.at_m,
                    time_s: one.time_s.min(anomaly.time_s),
                    height_m: mean(one.height_m, anomaly.height_m),
                    // A hole that one tire spans, both span.
                    height_sd_m: one.height_sd_m.min(anomaly.height_sd_m),
                    length_m: mean(one.length_m, anomaly.length_m),
                };
                last.passes += 1;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACING_M: f64 = 0.05;

    /// A road of even small waves with these holes: where, how long, how high.
    fn search(length_m: f64, holes: &[(f64, f64, f64)], rough_m: f64) -> Vec<Anomaly> {
        let mut search = AnomalySearch::new(SPACING_M);
        for i in 0..(length_m / SPACING_M) as u32 {
            let at_m = f64::from(i) * SPACING_M;
            let waves = rough_m * ((at_m * 1.3).sin() + (at_m * 0.71).cos());
            let hole = holes.iter().find(|(from, length, _)| (*from..from + length).contains(&at_m));
            search.push(at_m, at_m / 20.0, waves + hole.map_or(0.0, |(.., height)| *height));
        }
        search.finish()
    }

    #[test]
    fn holes_and_bumps_are_found_with_height_and_place() {
        // One of them across the border of two blocks, one barely above the threshold.
        let holes = [(30.0, 0.6, -0.03), (101.8, 0.8, 0.04), (240.0, 0.5, -0.02)];
        let found = search(300.0, &holes, 3e-4);
        assert_eq!(found.len(), 3, "{found:?}");
        for (anomaly, (from, length, height)) in found.iter().zip(holes) {
            assert!((anomaly.at_m - from - 0.5 * length).abs() <= 0.5 * length + 1e-9);
            assert!((anomaly.height_m - height).abs() < 1.5e-3 && (anomaly.length_m - length).abs() < 0.11);
            assert!((anomaly.time_s - anomaly.at_m / 20.0).abs() < 1e-9);
            assert_eq!(anomaly.kind(), if height < 0.0 { "hole" } else { "bump" });
        }
        // The same in a road that is as rough by itself, and nothing but waves.
        assert!(search(300.0, &holes, 0.01).is_empty());
        assert!(search(300.0, &[], 2e-3).is_empty());
    }

    #[test]
    fn a_stretch_that_ends_hides_nothing_and_makes_nothing() {
        let mut search = AnomalySearch::new(SPACING_M);
        for i in 0..2000u32 {
            let at_m = f64::from(i) * SPACING_M;
            // A step at a gap of the road is none.
            let level = if i < 1000 { 0.0 } else { 0.5 };
            let hole = if (400..410).contains(&i) { -0.03 } else { 0.0 };
            let height_m = if (1000..1010).contains(&i) { f64::NAN } else { level + hole };
            search.push(at_m, f64::NAN, height_m);
        }
        let found = search.finish();
        assert_eq!(found.len(), 1);
        assert!((found[0].at_m - 20.2).abs() < 0.3);
    }

    #[test]
    fn both_wheels_of_a_side_go_over_one_hole() {
        let hole = |at_m: f64, height_m: f64| Anomaly {
            at_m,
            time_s: at_m,
            height_m,
            height_sd_m: 7e-3,
            length_m: 0.5,
        };
        let front = vec![hole(10.0, -0.03), hole(50.0, 0.02)];
        let rear = vec![hole(10.3, -0.02), hole(80.0, -0.04)];
        let found = of_a_side(&[front, rear], 1.0);
        let passes: Vec<_> = found.iter().map(|side| (side.anomaly.at_m, side.passes)).collect();
        assert_eq!(passes, [(10.0, 2), (50.0, 1), (80.0, 1)]);
        assert!((found[0].anomaly.height_m + 0.025).abs() < 1e-12);
    }
}
