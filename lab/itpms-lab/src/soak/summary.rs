//! Many drives added up: hours, kilometers, what was reported, how near it came, and what that says of the rate.

use std::collections::BTreeMap;

use itpms_core::model::Corner;
use serde::Serialize;

use super::Hour;
use super::day_summary::DaySummary;
use super::hour::NO_INFORMATION;

/// Drives added up. JSON as the fields stand here.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    pub drives: usize,
    pub hours: f64,
    pub km: f64,
    pub drive_wall_h: f64,
    /// Warnings though nothing was wrong, of pressures and of sensors.
    pub false_warnings: usize,
    /// Largest rate of false warnings per hour that agrees with their number at 95 % (Poisson, one-sided): 3/hours for none.
    pub rate_limit_per_h: f64,
    /// Reports by cause; `no-information` is no false warning.
    pub said: BTreeMap<String, usize>,
    /// Share of the time in which a wheel's pressure was valid.
    pub valid: f64,
    /// Share of that in which the truth was inside the 95 % interval.
    pub covered: f64,
    /// Root of the mean square error in kPa.
    pub rmse_kpa: f64,
    /// Largest error in standard deviations.
    pub worst_z: Extreme,
    /// Smallest distance in kPa of the 95 % upper limit from the limit of a warning.
    pub low_margin_kpa: Extreme,
    /// Smallest 95 % lower limit in kPa.
    pub lowest_kpa: Extreme,
    /// Of wheel speeds, where the drives are of cars that have nothing else.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radii: Option<RadiusSummary>,
    /// Of calibrations and later days, where that was driven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub days: Option<DaySummary>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RadiusSummary {
    /// Share of the time after a calibration in which a loss of 30 % of any single tire would have been found.
    pub informed: f64,
    /// Shares of it in which the true change of each ratio of radii was within its 95 % interval.
    pub covered: [f64; 3],
    /// Largest probability of any low tire, and the seed of that drive.
    pub most_probable: f64,
    pub most_probable_seed: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extreme {
    /// The value; null if there is none.
    pub value: f64,
    pub seed: u64,
    pub wheel: &'static str,
}

impl Summary {
    pub fn of(hours: &[Hour]) -> Self {
        let mut hours: Vec<&Hour> = hours.iter().collect();
        hours.sort_by_key(|hour| hour.seed);
        let mut said = BTreeMap::new();
        for words in hours.iter().flat_map(|hour| &hour.said) {
            *said.entry(words.cause.clone()).or_insert(0) += 1;
        }
        let false_warnings = said.iter().filter(|(cause, _)| *cause != NO_INFORMATION).map(|(_, n)| n).sum();
        let driven_h = hours.iter().map(|hour| hour.driven_s).sum::<f64>() / 3600.0;
        // Weights: seconds of valid pressure.
        let (mut whole, mut valid, mut covered, mut squares) = (0.0, 0.0, 0.0, 0.0);
        for (hour, wheel) in hours.iter().flat_map(|hour| hour.wheels.iter().map(move |wheel| (hour, wheel)))
        {
            let seconds = wheel.valid * hour.driven_s;
            whole += hour.driven_s;
            valid += seconds;
            covered += seconds * wheel.covered.unwrap_or(0.0);
            squares += seconds * wheel.rmse_kpa.unwrap_or(0.0).powi(2);
        }
        Self {
            drives: hours.len(),
            hours: driven_h,
            km: hours.iter().map(|hour| hour.km).sum(),
            drive_wall_h: hours.iter().map(|hour| hour.wall_s).sum::<f64>() / 3600.0,
            false_warnings,
            rate_limit_per_h: poisson_limit(false_warnings) / driven_h,
            said,
            valid: valid / whole,
            covered: covered / valid,
            rmse_kpa: (squares / valid).sqrt(),
            worst_z: extreme(&hours, |wheel| wheel.worst_z.map(|z| -z.abs())).negated(),
            low_margin_kpa: extreme(&hours, |wheel| wheel.low_margin_kpa),
            lowest_kpa: extreme(&hours, |wheel| wheel.lowest_kpa),
            radii: RadiusSummary::of(&hours),
            days: DaySummary::of(&hours),
        }
    }

    pub fn text(&self) -> String {
        let mut text = format!(
            "{:.1} h, {:.0} km in {} drives; {:.2} h of one thread\n",
            self.hours, self.km, self.drives, self.drive_wall_h
        );
        text += &format!(
            "false warnings: {}; rate below {:.2e} per hour (95 %)\n",
            self.false_warnings, self.rate_limit_per_h
        );
        for (cause, count) in &self.said {
            text += &format!("  {cause}: {count}\n");
        }
        if let Some(radii) = &self.radii {
            return text + &radii.text() + &self.days.as_ref().map_or_else(String::new, DaySummary::text);
        }
        text += &format!(
            "valid {:.1} % of the time; truth inside the 95 % interval {:.1} %; RMSE {:.1} kPa\n",
            100.0 * self.valid,
            100.0 * self.covered,
            self.rmse_kpa
        );
        for (name, extreme) in [
            ("largest error in sd", &self.worst_z),
            ("least distance of p + 1.645 sd from a warning, kPa", &self.low_margin_kpa),
            ("smallest p - 1.645 sd, kPa", &self.lowest_kpa),
        ] {
            text += &format!("{name}: {:.1} ({}, seed {})\n", extreme.value, extreme.wheel, extreme.seed);
        }
        text
    }
}

impl RadiusSummary {
    fn of(hours: &[&Hour]) -> Option<Self> {
        let drives = || hours.iter().filter_map(|hour| hour.radii.as_ref().map(|radii| (hour.seed, radii)));
        let known_s: f64 = drives().map(|(_, radii)| radii.known_s).sum();
        let (seed, most) = drives().max_by(|a, b| a.1.most_probable.total_cmp(&b.1.most_probable))?;
        let covered =
            |i: usize| drives().map(|(_, radii)| radii.known_s * radii.covered[i]).sum::<f64>() / known_s;
        Some(Self {
            informed: drives().map(|(_, radii)| radii.informed_s).sum::<f64>() / known_s,
            covered: [covered(0), covered(1), covered(2)],
            most_probable: most.most_probable,
            most_probable_seed: seed,
        })
    }

    fn text(&self) -> String {
        let [front, rear, axles] = self.covered.map(|share| 100.0 * share);
        format!(
            "after the calibration: a loss of 30 % of any one tire would have been found {:.1} % of the time\n\
             true change of the radii inside the 95 % interval: front {front:.1} %, rear {rear:.1} %, front over rear {axles:.1} %\n\
             largest probability of a low tire: {:.3} (seed {})\n",
            100.0 * self.informed,
            self.most_probable,
            self.most_probable_seed
        )
    }
}

impl Extreme {
    fn negated(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

/// The smallest figure of all wheels of all drives.
fn extreme(hours: &[&Hour], of: impl Fn(&super::WheelHour) -> Option<f64>) -> Extreme {
    let mut least = Extreme { value: f64::INFINITY, seed: 0, wheel: "" };
    for hour in hours {
        for (corner, wheel) in Corner::ALL.into_iter().zip(&hour.wheels) {
            if let Some(value) = of(wheel).filter(|value| *value < least.value) {
                least = Extreme { value, seed: hour.seed, wheel: corner.label() };
            }
        }
    }
    least
}

/// Largest mean of a Poisson variable that still shows no more than `count` with a probability of 5 %.
fn poisson_limit(count: usize) -> f64 {
    let probability = |mean: f64| {
        // As logarithms: exp(-mean) alone is nothing for many.
        let mut log_term = -mean;
        let mut sum = log_term.exp();
        for k in 1..=count {
            log_term += (mean / k as f64).ln();
            sum += log_term.exp();
        }
        sum
    };
    // The mean lies between the count and a generous bound; the probability falls with it.
    let (mut low, mut high) = (0.0, 10.0 + 3.0 * count as f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if probability(middle) > 0.05 { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::super::{Said, WheelHour};
    use super::*;

    fn wheel(valid: f64, rmse_kpa: f64, worst_z: f64) -> WheelHour {
        WheelHour {
            valid,
            covered: Some(0.9),
            rmse_kpa: Some(rmse_kpa),
            worst_z: Some(worst_z),
            low_margin_kpa: Some(20.0 - worst_z),
            low_margin_s: Some(7.0),
            lowest_kpa: Some(200.0),
        }
    }

    fn hour(seed: u64, said: &[&str], wheels: [WheelHour; 4]) -> Hour {
        let words = |cause: &&str| Said {
            time_s: 1.0,
            wheels: vec!["fl".to_owned()],
            cause: (*cause).to_owned(),
            text: String::new(),
        };
        Hour {
            seed,
            driven_s: 3600.0,
            km: 50.0,
            said: said.iter().map(words).collect(),
            wheels,
            wall_s: 36.0,
            ..Hour::default()
        }
    }

    #[test]
    fn hours_are_added_up() {
        let never = WheelHour::default();
        let quiet = hour(1, &[], [wheel(1.0, 3.0, 1.0), wheel(1.0, 3.0, -4.5), never, never]);
        let loud =
            hour(2, &["no-information", "under-inflated"], [wheel(0.5, 6.0, 2.0), never, never, never]);
        let summary = Summary::of(&[loud.clone(), quiet.clone()]);
        assert_eq!(summary, Summary::of(&[quiet, loud]));
        assert_eq!((summary.hours, summary.km, summary.false_warnings), (2.0, 100.0, 1));
        assert!((summary.drive_wall_h - 0.02).abs() < 1e-12);
        assert!((summary.valid - 2.5 / 8.0).abs() < 1e-12 && (summary.covered - 0.9).abs() < 1e-12);
        assert!((summary.rmse_kpa - ((9.0 + 9.0 + 18.0) / 2.5f64).sqrt()).abs() < 1e-12);
        assert_eq!(summary.worst_z, Extreme { value: 4.5, seed: 1, wheel: "fr" });
        assert_eq!(summary.low_margin_kpa, Extreme { value: 18.0, seed: 2, wheel: "fl" });
        assert_eq!((summary.said["no-information"], summary.said["under-inflated"]), (1, 1));
    }

    #[test]
    fn limits_are_the_published_ones() {
        // One-sided 95 % limits of a Poisson mean (Garwood 1936; tables of the Particle Data Group).
        for (count, limit) in [(0, 3.00), (1, 4.74), (2, 6.30), (5, 10.51), (10, 16.96)] {
            assert!((poisson_limit(count) - limit).abs() < 0.006, "{count}: {}", poisson_limit(count));
        }
        // Many are nearly normal: count + 1.645 sqrt(count) + (1.645² + 2)/3 + ...
        for count in [800, 5000] {
            let normal = count as f64 + 1.645 * (count as f64).sqrt() + 1.57;
            assert!((poisson_limit(count) - normal).abs() < 0.2, "{count}: {}", poisson_limit(count));
        }
    }
}
