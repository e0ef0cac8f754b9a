//! How far the tires' own sensors are believed in a calibration: the median of the possible pressures of a tire at its placard, as far as nothing contradicts
//! it. A sensor that sleeps sends 0 or the end of its range.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use itpms_core::model::Corner;
use itpms_data::{LogReader, Vehicle};

use crate::error::DriveError;
use crate::run::ROWS_PER_LOOK;

/// Shares of the placard pressure that a tire may have where it teaches something.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.4..=1.5;
/// Share by which a reading may differ from the median, and that from a pressure that is given: warming up and a coarse sensor are less.
const APART: f64 = 0.1;
/// Share of the readings that may differ by more.
const STRAY: f64 = 0.1;
/// Ratio of two tires' shares of their placard pressures from which on they contradict each other.
const UNLIKE: f64 = 1.2;
/// Steps of the readings that are distinguished, per kPa.
const PER_KPA: f64 = 10.0;

pub struct SentPressures {
    /// Medians in kPa, in the order of [`Corner::ALL`]; `None` of one that sends nothing plausible.
    pub kpa: [Option<f64>; 4],
    /// Omissions, a sentence for each sensor.
    pub remarks: Vec<String>,
}

/// How often a sensor sends which pressure.
#[derive(Default)]
struct Readings {
    steps: BTreeMap<i64, u64>,
    count: u64,
    implausible: u64,
    example_kpa: f64,
}

impl Readings {
    fn take(&mut self, kpa: f64, placard_kpa: f64) {
        if kpa.is_nan() {
        } else if PLAUSIBLE.contains(&(kpa / placard_kpa)) {
            *self.steps.entry((kpa * PER_KPA).round() as i64).or_default() += 1;
            self.count += 1;
        } else {
            (self.implausible, self.example_kpa) = (self.implausible + 1, kpa);
        }
    }

    /// The reading below which this share of them lies.
    fn quantile_kpa(&self, share: f64) -> Option<f64> {
        let rank = (share * self.count as f64) as u64;
        let mut below = 0;
        let step = self.steps.iter().find(|(_, count)| {
            below += **count;
            below > rank
        })?;
        Some(*step.0 as f64 / PER_KPA)
    }
}

/// The sensors' readings in the first `seconds` of a log of this vehicle; `given_kpa`: pressures that are known otherwise, NaN of others.
/// Errors: readings that contradict each other, another wheel's or what is given; the log cannot be read on; [`DriveError::Stopped`].
pub fn sent_pressures(
    log: &mut LogReader,
    vehicle: &Vehicle,
    given_kpa: [f64; 4],
    seconds: f64,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<SentPressures, DriveError> {
    let placards_kpa = Corner::ALL.map(|corner| vehicle.placard_kpa(corner).unwrap_or(f64::NAN));
    let (mut wheels, mut count, mut begin_s) = ([(); 4].map(|()| Readings::default()), 0u64, None);
    while let Some(row) = log.next_row()? {
        if count.is_multiple_of(ROWS_PER_LOOK) && watch(log.progress()).is_break() {
            return Err(DriveError::Stopped);
        }
        count += 1;
        if row.time_s - *begin_s.get_or_insert(row.time_s) > seconds {
            break;
        }
        for ((wheel, kpa), placard_kpa) in wheels.iter_mut().zip(row.motion.tire_sensor_kpa).zip(placards_kpa)
        {
            wheel.take(kpa, placard_kpa);
        }
    }
    let kpa = wheels.each_ref().map(|wheel| wheel.quantile_kpa(0.5));
    if let Some(why) = contradiction(&wheels, &kpa, given_kpa, placards_kpa) {
        return Err(DriveError::Log(format!("{}: {why}", log.path().display())));
    }
    let remark = |(corner, wheel): (Corner, &Readings)| {
        let (label, left_out, all) = (corner.label(), wheel.implausible, wheel.implausible + wheel.count);
        (left_out > 0).then(|| {
            format!(
                "{}: {left_out} of {all} readings of {label}_tpms_kpa are no pressure of this tire ({} kPa, placard {} kPa) and count as missing",
                log.path().display(),
                wheel.example_kpa,
                placards_kpa[corner.index()]
            )
        })
    };
    let has_placard = |(corner, _): &(Corner, &Readings)| placards_kpa[corner.index()].is_finite();
    let remarks = Corner::ALL.into_iter().zip(&wheels).filter(has_placard).filter_map(remark).collect();
    Ok(SentPressures { kpa, remarks })
}

/// The readings' contradiction as a sentence: in time, with given pressures, or with each other.
fn contradiction(
    wheels: &[Readings; 4],
    kpa: &[Option<f64>; 4],
    given_kpa: [f64; 4],
    placards_kpa: [f64; 4],
) -> Option<String> {
    let mut shares = vec![];
    for (corner, (wheel, kpa)) in Corner::ALL.into_iter().zip(wheels.iter().zip(kpa)) {
        let (Some(kpa), label, given) = (*kpa, corner.label(), given_kpa[corner.index()]) else { continue };
        let near = |step: &i64| (*step as f64 / PER_KPA - kpa).abs() <= APART * kpa;
        let stray: u64 = wheel.steps.iter().filter(|(step, _)| !near(step)).map(|(_, count)| count).sum();
        if stray as f64 > STRAY * wheel.count as f64 {
            let [from, to] =
                [0.5 * STRAY, 1.0 - 0.5 * STRAY].map(|share| wheel.quantile_kpa(share).unwrap_or(kpa));
            return Some(format!(
                "{label}_tpms_kpa goes from {from} to {to} kPa, expected a pressure that stays within {:.0} % while the car is learned: take a part of the drive in which it does, or leave the column out and give --pressure-kpa if the sensor is wrong",
                100.0 * APART
            ));
        }
        if (kpa - given).abs() > APART * given {
            return Some(format!(
                "{label}_tpms_kpa says {kpa} kPa and --pressure-kpa {given}, expected the same within {:.0} %: give the pressure while driving, or leave the column out if its sensor is wrong",
                100.0 * APART
            ));
        }
        if given.is_nan() {
            shares.push((kpa / placards_kpa[corner.index()], kpa, label));
        }
    }
    shares.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (low, high) = (shares.first()?, shares.last()?);
    (high.0 > UNLIKE * low.0).then(|| {
        format!(
            "the tires' own sensors contradict each other: {}_tpms_kpa says {} kPa, {}_tpms_kpa {}, expected like shares of their placard pressures: measure, and give --pressure-kpa for every wheel",
            low.2, low.1, high.2, high.1
        )
    })
}
