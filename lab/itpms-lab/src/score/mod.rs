//! The accuracy table, recomputed: an estimator drives the standard scenarios over many seeds and is held against the goals.
//!
//! Called by the binary's `score`. Deterministic: the same request gives the same figures on any number of processors.
//!
//! | module | idea |
//! |---|---|
//! | `case` | the drives |
//! | `track` | following a drop: the paper's scenarios, a wrong mass, the grid of roads; coverage |
//! | `constant` | efficiency against the Cramer-Rao bound |
//! | `record` | the road |
//! | `drive` | four wheels: a puncture, the sources one by one, disturbances, detection, cars that are not their files |
//! | `own` | an owner's whole path: file, learning, calibration, a later day |
//! | [`row`] | rows, cells, goals, verdicts |
//! | [`stats`] | percentiles, bias, coverage |
//! | `runner` | many drives at once |
//! | `table` | as text |

mod case;
mod constant;
mod drive;
mod own;
mod record;
pub mod row;
pub mod stats;
mod table;
mod track;

use itpms_paper::EstimatorKind;
use serde::Serialize;

use crate::runner::{Progress, Result, Runner, refused};
use row::Row;

itpms_core::labelled! {
    /// What can be asked for by itself, in the order of the table: cars with four wheels from `Drive` on, from `Ablation` on not in the usual one.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Part {
        PaperDrop = "paper-drop",
        /// The same down to 41.4 kPa.
        PaperDeepDrop = "paper-deep-drop",
        PaperDropRecover = "paper-drop-recover",
        /// A sprung mass 8 % off.
        Mass = "mass",
        BiasGrid = "bias-grid",
        /// Honesty of the 95 % interval over all of the above.
        Coverage = "coverage",
        /// The test bed, after a reset.
        Bench = "bench",
        /// Bound over variance at constant pressure.
        Efficiency = "efficiency",
        Road = "road",
        /// Four wheels, one of them punctured.
        Drive = "drive",
        /// The same with each source of information alone.
        Ablation = "ablation",
        /// The same while something differs from what the estimator is given.
        Disturbances = "disturbances",
        /// How soon a loss is warned of.
        Detection = "detection",
        /// How soon tires are named that lose air together, or did before the drive.
        Several = "several",
        /// Cars that are not their files.
        Car = "car",
        /// What ten minutes at known pressures teach of a car.
        Learn = "learn",
        Own = "own",
    }
}

impl Part {
    pub const PAPER: [Self; 3] = [Self::PaperDrop, Self::PaperDeepDrop, Self::PaperDropRecover];

    /// Whether it belongs to the table that is computed when nothing is asked for by name.
    pub fn is_usual(self) -> bool {
        self < Self::Ablation
    }

    /// Whether it is of cars with four wheels.
    fn is_of_cars(self) -> bool {
        self >= Self::Drive
    }

    /// The table's heading above the rows of a part.
    fn title(part: &str) -> Option<&'static str> {
        Some(match part {
            "paper" => {
                "Paper's scenarios, kPa: median RMSE over t > 3 s, bias before and after the drop, Cramer-Rao bound"
            }
            "mass" => {
                "paper-drop, sprung mass unknown to the estimator: change of the median RMSE, same seeds"
            }
            "bias-grid" => "paper-drop on other roads, kPa; bias over 5-20 s and 27-40 s",
            "coverage" => "Share of time within the 95 % interval, mean of all rows above",
            "bench" => {
                "Test bed, a road that repeats every 0.66 s, at placard pressure for the first 20 s (4 s), kPa"
            }
            "efficiency" => {
                "Constant pressure: bound (3-60 Hz) / mean square error, both with a prior of 30 kPa"
            }
            "road" => "Road record, class B, wavelengths 0.5-10 m, stiffness from the estimator",
            "drive" => {
                "drive-puncture, front left down, kPa: median RMSE over t > 3 s by wheel; * the three other wheels"
            }
            "drive-noise" => "The same with noise 0.3 m/s2",
            "disturbances" => {
                "drive-puncture while one thing differs from the vehicle file; columns as above"
            }
            "detection" => {
                "A loss of a fifth, 20-120 km/h, classes A-D, both cars: seconds from the complete loss to the warning"
            }
            "several" => {
                "Cars drawn as typical on journeys of their own: a fifth lost in 10 s, or a quarter before; s until all tires are named, errors in kPa"
            }
            "car" => {
                "Cars that are not their files, 80 km/h, classes A-C in turn, 2 min, kPa while valid; worst: mean of one wheel on one drive"
            }
            "car-calibrated" => "The same after a calibration of 40 s",
            "car-loss" => {
                "A loss of a fifth in 10 s after it: median seconds from the complete loss to the warning of that tire, worst of those warned"
            }
            "learn" => {
                "Learned in ten minutes, 80 km/h, classes A-C in turn: share within 1.96 sd, rms errors and sd in % (friction N)"
            }
            "learn-later" => {
                "A later drive, 60 km/h, the next class, kPa while valid; a loss of a fifth: found, s after it is complete, false warnings"
            }
            "own" => {
                "vehicle init, learn, calibration, another day (road, speed, load), kPa while valid; a loss of a fifth: s after it is complete; rise of another tire"
            }
            "own-changed" => {
                "The same later day of a car that has changed, learned and reference, no loss: what is reported of it, in cars"
            }
            "ablation" => "drive-puncture with each source of information alone, and both; columns as above",
            _ => return None,
        })
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Drives per row; of [`Part::Own`] the cars.
    pub seeds: usize,
    /// Seed of the first drive; the others follow.
    pub first_seed: u64,
    /// One estimator; several are compared in the paper's scenarios alone.
    pub estimators: Vec<EstimatorKind>,
    pub part: Option<Part>,
    /// Of the four-wheel parts, only rows whose names contain this.
    pub only: Option<String>,
    /// Whether cars with four wheels have wheel speeds beside their accelerations, in [`Part::Drive`], [`Part::Car`] and [`Part::Own`].
    pub wheel_speeds: bool,
}

impl Default for Request {
    /// Forty seeds from 1, the default estimator, everything.
    fn default() -> Self {
        Self {
            seeds: 40,
            first_seed: 1,
            estimators: vec![EstimatorKind::default()],
            part: None,
            only: None,
            wheel_speeds: false,
        }
    }
}

/// The result. JSON: `version`, `estimators`, `seeds`, `first_seed`, `rows` ([`Row`]).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    pub version: u32,
    #[serde(serialize_with = "labels")]
    pub estimators: Vec<EstimatorKind>,
    pub seeds: usize,
    pub first_seed: u64,
    pub rows: Vec<Row>,
}

fn labels<S: serde::Serializer>(kinds: &[EstimatorKind], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(kinds.iter().map(|kind| kind.label()))
}

pub fn score(request: &Request, progress: Progress<'_>) -> Result<Score> {
    let (Some(&kind), true) = (request.estimators.first(), request.seeds > 0) else {
        return refused("0 seeds or no estimator, expected at least one of each");
    };
    let several = request.estimators.len() > 1;
    if let Some(part) = request.part.filter(|part| several && !Part::PAPER.contains(part)) {
        let (part, papers) = (part.label(), Part::PAPER.map(Part::label).join(", "));
        return refused(format!(
            "{part} is scored for one estimator at a time; several are compared in {papers}"
        ));
    }
    let is_default = kind == EstimatorKind::default();
    if let Some(part) = request.part.filter(|part| !is_default && part.is_of_cars()) {
        let (part, default) = (part.label(), EstimatorKind::default().label());
        return refused(format!("{part} is scored for {default} alone: the paper's filters know one wheel"));
    }
    let wanted = |part: Part| match request.part {
        Some(only) => part == only,
        None if several => Part::PAPER.contains(&part),
        None => part.is_usual() && (is_default || !part.is_of_cars()),
    };
    let drives = |part: Part| if wanted(part) { request.seeds } else { 0 };
    let tracks = track::Plan::new(wanted, &request.estimators, request.seeds)?;
    let constant = constant::Plan::new(kind, drives(Part::Efficiency))?;
    let record = record::Plan::new(kind, drives(Part::Road))?;

    let cars = drive::Plan::new(wanted, request.seeds, request.only.as_deref(), request.wheel_speeds)?;
    let own = || own::Plan::new(request.seeds, request.only.as_deref(), request.wheel_speeds);
    let own = wanted(Part::Own).then(own).unwrap_or_default();
    if let Some(only) = request.only.as_ref().filter(|_| cars.drives() + own.drives() == 0) {
        return refused(format!(
            "no four-wheel row that was asked for has a name with `{only}` in it, such as `car, 80 km/h, reset`"
        ));
    }

    let total = tracks.drives() + constant.drives() + record.drives() + cars.drives() + own.drives();
    let runner = Runner::new(request.first_seed, total, progress);
    let mut rows = tracks.rows(&runner)?;
    if wanted(Part::Efficiency) {
        rows.extend(constant.rows(&runner)?);
    }
    if wanted(Part::Road) {
        rows.extend(record.rows(&runner)?);
    }
    rows.extend(cars.rows(&runner)?);
    rows.extend(own.rows(&runner)?);
    Ok(Score {
        version: 1,
        estimators: request.estimators.clone(),
        seeds: request.seeds,
        first_seed: request.first_seed,
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runner::UNWATCHED;

    #[test]
    fn requests_that_make_no_sense_are_refused() {
        let nothing = Request { seeds: 0, ..Request::default() };
        assert!(score(&nothing, UNWATCHED).unwrap_err().to_string().starts_with("0 seeds"));
        let unknown = Request { part: Some(Part::Drive), only: Some("zzz".to_owned()), ..Request::default() };
        assert!(score(&unknown, UNWATCHED).unwrap_err().to_string().starts_with("no four-wheel row"));
        let several = Request {
            estimators: EstimatorKind::ALL.to_vec(),
            part: Some(Part::Road),
            seeds: 1,
            ..Request::default()
        };
        assert!(score(&several, UNWATCHED).unwrap_err().to_string().starts_with("road is scored for one"));
        let estimators = vec![EstimatorKind::AekfUi];
        let of_cars = Request { estimators, part: Some(Part::Drive), seeds: 1, ..Request::default() };
        let refused = score(&of_cars, UNWATCHED).unwrap_err().to_string();
        assert!(refused.starts_with("drive is scored for informed alone"), "{refused}");
    }
}
