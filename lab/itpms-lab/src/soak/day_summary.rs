//! Days added up: false warnings by condition, losses by how far they move a radius, yaw rates.

use std::collections::BTreeMap;

use itpms_sim::wheel_speeds::YawFault;
use serde::Serialize;

use super::hour::{DayHour, Hour, LossHour};

/// Limits of the classes of `-beta ln p`; below the second hardly any loss shows across the days.
const CLASSES: [f64; 4] = [0.0, 1.8e-3, 2.4e-3, f64::INFINITY];

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DaySummary {
    /// Drives for which no calibration taught anything.
    pub uncalibrated: usize,
    pub conditions: BTreeMap<&'static str, OfCondition>,
    /// Losses by change of the radius, each class with its limits.
    pub losses: Vec<OfLosses>,
    pub kinds: BTreeMap<String, OfLosses>,
    /// Good yaw rates, and those of them that were left out.
    pub good_yaw: [usize; 2],
    /// Yaw rates with each fault, and those of them that were left out.
    pub bad_yaw: BTreeMap<String, [usize; 2]>,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct OfCondition {
    pub hours: f64,
    pub false_warnings: usize,
    pub seeds: Vec<u64>,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct OfLosses {
    /// Smallest and largest change of `ln` of the radius.
    pub radius_change: [f64; 2],
    pub drives: usize,
    /// Those in which a warning named one of the tires.
    pub found: usize,
    /// Those in which one named just the right ones.
    pub exact: usize,
    /// Those in which one named a tire that had not lost air.
    pub wrong: usize,
    /// Median of the times in s from the loss to the first warning.
    pub median_s: Option<f64>,
}

impl DaySummary {
    /// Of hours in the order of their seeds; `None` where none has a day.
    pub(super) fn of(hours: &[&Hour]) -> Option<Self> {
        let days = || hours.iter().filter_map(|hour| hour.day.as_ref().map(|day| (*hour, day)));
        days().next()?;
        let mut conditions: BTreeMap<&'static str, OfCondition> = BTreeMap::new();
        let (mut good_yaw, mut bad_yaw) = ([0; 2], BTreeMap::new());
        for (hour, day) in days() {
            let of = conditions.entry(day.condition.label()).or_default();
            of.hours += hour.driven_s / 3600.0;
            let reported = hour.said.iter().filter(|said| said.cause != super::hour::NO_INFORMATION).count();
            of.false_warnings += reported;
            if reported > 0 {
                of.seeds.push(hour.seed);
            }
            if let Some(yaw) = &day.yaw {
                let [all, left_out] = match yaw.fault {
                    YawFault::None => &mut good_yaw,
                    fault => bad_yaw.entry(fault.label().to_owned()).or_insert([0; 2]),
                };
                *all += 1;
                *left_out += usize::from(yaw.left_out);
            }
        }
        let losses: Vec<&LossHour> = days().filter_map(|(_, day): (_, &DayHour)| day.loss.as_ref()).collect();
        let class = |pair: &[f64]| {
            let within = |loss: &&&LossHour| loss.radius_change >= pair[0] && loss.radius_change < pair[1];
            OfLosses::of(&losses.iter().filter(within).copied().collect::<Vec<_>>())
        };
        let mut kinds: BTreeMap<String, Vec<&LossHour>> = BTreeMap::new();
        for loss in &losses {
            kinds.entry(loss.kind.clone()).or_default().push(loss);
        }
        Some(Self {
            uncalibrated: days().filter(|(_, day)| !day.calibrated).count(),
            conditions,
            losses: CLASSES.windows(2).map(class).filter(|class| class.drives > 0).collect(),
            kinds: kinds.into_iter().map(|(kind, losses)| (kind, OfLosses::of(&losses))).collect(),
            good_yaw,
            bad_yaw,
        })
    }

    pub(super) fn text(&self) -> String {
        let mut text = format!("no calibration taught anything: {} drives\n", self.uncalibrated);
        for (label, of) in &self.conditions {
            text += &format!("{label}: {:.1} h, false warnings {}", of.hours, of.false_warnings);
            text += &if of.seeds.is_empty() { "\n".to_owned() } else { format!(" (seeds {:?})\n", of.seeds) };
        }
        for of in &self.losses {
            let [least, most] = of.radius_change.map(|change| 1e3 * change);
            text += &format!("radius changed by {least:.2} to {most:.2} thousandths: {}\n", of.text());
        }
        for (kind, of) in &self.kinds {
            text += &format!("{kind}: {}\n", of.text());
        }
        let [all, left_out] = self.good_yaw;
        text += &format!("good yaw rates left out: {left_out} of {all}\n");
        for (fault, [all, found]) in &self.bad_yaw {
            text += &format!("{fault} yaw rates left out: {found} of {all}\n");
        }
        text
    }
}

impl OfLosses {
    fn of(losses: &[&LossHour]) -> Self {
        let mut times: Vec<f64> = losses.iter().filter_map(|loss| loss.found_s).collect();
        times.sort_by(f64::total_cmp);
        let count = |of: &dyn Fn(&LossHour) -> bool| losses.iter().filter(|loss| of(loss)).count();
        let changes = || losses.iter().map(|loss| loss.radius_change);
        Self {
            radius_change: [changes().fold(f64::INFINITY, f64::min), changes().fold(0.0, f64::max)],
            drives: losses.len(),
            found: times.len(),
            exact: count(&|loss| loss.exact),
            wrong: count(&|loss| loss.wrong),
            median_s: times.get(times.len() / 2).copied(),
        }
    }

    fn text(&self) -> String {
        let Self { drives, found, exact, wrong, .. } = self;
        let median = self.median_s.map_or_else(String::new, |s| format!(", median {s:.0} s"));
        format!("{found} of {drives} found, {exact} exactly named, {wrong} wrong{median}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loss(radius_change: f64, found_s: Option<f64>) -> LossHour {
        let wheels = vec!["fl".to_owned()];
        let exact = found_s.is_some();
        LossHour { kind: "one".to_owned(), wheels, radius_change, found_s, exact, wrong: false }
    }

    #[test]
    fn losses_are_counted_and_their_times_have_a_median() {
        let losses =
            [loss(1e-3, None), loss(2e-3, Some(90.0)), loss(2e-3, Some(30.0)), loss(3e-3, Some(60.0))];
        let of = OfLosses::of(&losses.iter().collect::<Vec<_>>());
        assert_eq!((of.drives, of.found, of.exact, of.wrong), (4, 3, 3, 0));
        assert_eq!((of.median_s, of.radius_change), (Some(60.0), [1e-3, 3e-3]));
        assert_eq!(OfLosses::of(&[]).median_s, None);
    }
}
