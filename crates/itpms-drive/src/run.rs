//! A log, row by row, through the estimator, the road recorders and the report's collector, into a sink.

use std::ops::ControlFlow;

use itpms_analysis::beside::{Beside, Findings, Identified};
use itpms_analysis::report::{CornerRow, Provenance, ReportCollector, ReportData, ReportOptions};
use itpms_core::model::{BodyFit, Corner, Misfit};
use itpms_core::torsion::TorsionChange;
use itpms_core::warning::{Cause, Change, MonitorReport};
use itpms_data::out::{EstimateRow, RadiusRow};
use itpms_data::{LogReader, LogRow};
use serde_json::{Map, Value};

use crate::air::AirCheck;
use crate::alerts::{Alerts, Events, Listed};
use crate::concerns;
use crate::drive::{Drive, Estimates, QuarterCars};
use crate::error::DriveError;
pub use crate::job::{Heights, Job};
use crate::plausibility::Plausibility;
use crate::provenance::provenance;
use crate::pulses::Pulses;
use crate::reference::{self, Taught};
use crate::road::{LateRow, RoadTrack};
use crate::time_axis::TimeAxis;
use crate::wheel_speeds::{YawFault, wheel_speed_use};

/// Rows between two looks at whoever may want to stop or to know how far it is.
pub(crate) const ROWS_PER_LOOK: u64 = 1024;

/// Receiver of a drive's results as they come.
pub trait Sink {
    /// A row of the log, and what is known after it. Errors: the sink's own; they end the drive.
    fn row(&mut self, row: &LogRow, known: &EstimateRow<'_>) -> Result<(), DriveError>;

    /// The same half a minute later, when its road is there; only where the road is wanted. Errors: the sink's own; they end the drive.
    fn road(&mut self, _late: &LateRow) -> Result<(), DriveError> {
        Ok(())
    }

    /// An alert that began or ended, with its time in s. Errors: the sink's own; they end the drive.
    fn transition(&mut self, _time_s: f64, _change: &Change<f64>) -> Result<(), DriveError> {
        Ok(())
    }

    /// A finding beside the monitor's, as a line of `events.jsonl`.
    ///
    /// # Errors
    /// The sink's own; they end the drive.
    fn notice(&mut self, _event: &Map<String, Value>) -> Result<(), DriveError> {
        Ok(())
    }
}

/// Asked every thousand rows with the share of the log that is done; a break ends the drive.
pub type Watch<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// How well body and wheel of a corner go together, and what does not.
pub type Fit = (BodyFit<f64>, Option<Misfit>);

/// A drive that was estimated.
#[derive(Debug)]
pub struct Done {
    pub data: ReportData,
    pub alerts: Alerts,
    pub concerns: Vec<String>,
    /// The corners of the vehicle file that the log does not have, each with the reason, as the end of "it is".
    pub not_estimated: Vec<(Corner, String)>,
    /// How well body and wheel of every corner go together, in the order of [`Corner::ALL`](itpms_core::model::Corner::ALL).
    pub fits: [Option<Fit>; 4],
    /// The result of a calibration, once it was over.
    pub learned: Taught,
    /// Placard pressures in kPa, in the order of [`Corner::ALL`](itpms_core::model::Corner::ALL); of tires without one `None`.
    pub placards_kpa: [Option<f64>; 4],
    /// The last report by wheel speeds, where they are used.
    pub radii: Option<RadiusRow>,
    /// Each tire's change since the calibration by its tooth pulses at the end, where they are read, in the order of
    /// [`Corner::ALL`](itpms_core::model::Corner::ALL).
    pub torsion: Option<[Option<TorsionChange<f64>>; 4]>,
    /// Whether the log has a temperature of the air, for cold pressures.
    pub has_temperature: bool,
    /// Dampers and load, the tires' own sensors, what turns with the wheels.
    pub beside: Findings,
}

impl Done {
    /// Why nothing of the drive's calibration of corners is to be kept: a sensor that was reported to the end, or a corner that does not fit.
    pub fn calibration_doubt(&self) -> Option<String> {
        self.learned.corners?;
        let stands = |listed: &&Listed| {
            listed.ended_s.is_none() && matches!(listed.alert.cause, Cause::Malfunction(_))
        };
        let broken = self.alerts.listed().iter().find(stands).map(|listed| listed.alert.to_string());
        let misfit = || {
            let fits = Corner::ALL.into_iter().zip(&self.fits);
            fits.filter_map(|(corner, fit)| Some((corner, fit.as_ref()?.1?)))
                .next()
                .map(|(corner, misfit)| format!("corner {}: {misfit}", corner.label()))
        };
        let why = broken.or_else(misfit)?;
        Some(format!("the calibration is not kept: {why}"))
    }
}

/// Estimates a drive. Errors: the log cannot be read on; a setting is refused; the sink's; [`DriveError::Stopped`].
pub fn estimate(
    log: &mut LogReader,
    job: &Job<'_>,
    sink: &mut dyn Sink,
    watch: Watch<'_>,
) -> Result<Done, DriveError> {
    let (mut drive, mut record) = begin(log, job)?;
    let mut pulses = Pulses::open(job.settings.pulses.as_deref())?;
    let mut count = 0u64;
    while let Some(mut row) = log.next_row()? {
        if count.is_multiple_of(ROWS_PER_LOOK) && watch(log.progress()).is_break() {
            return Err(DriveError::Stopped);
        }
        count += 1;
        pulses.up_to(row.time_s, &mut drive)?;
        let estimate = drive.update(&mut row);
        let cars = (job.road == Heights::Smoothed).then(|| drive.quarter_cars());
        let radii = drive.radii();
        record.take(&row, &estimate.corners, drive.report(), radii.as_ref(), cars.as_ref(), sink)?;
    }
    conclude(log, job, (drive, &pulses), record, sink, watch)
}

/// The estimator of a log, and what becomes of its rows.
pub(crate) fn begin(log: &LogReader, job: &Job<'_>) -> Result<(Drive, Record), DriveError> {
    let rate_hz = log.survey().estimator_rate_hz();
    let wheel_speeds = wheel_speed_use(log.columns(), job.vehicle, job.corners).unwrap_or_default();
    let mut drive = Drive::new(job.settings, job.vehicle, job.corners, wheel_speeds, rate_hz)?;
    drive.clock_began(log.start_ns() as f64 * 1e-9);
    let track = match job.road {
        // Wheel speeds show no road.
        _ if job.corners.is_empty() => None,
        Heights::None => None,
        Heights::Causal => {
            drive = drive.with_road(job.vehicle, job.corners, rate_hz)?;
            None
        }
        Heights::Smoothed => Some(RoadTrack::new(job.vehicle, job.corners, rate_hz)?),
    };
    let axis = TimeAxis::of(job.vehicle);
    let before = reference::read(job.settings, job.vehicle)?.and_then(|(_, stored)| stored.suspension);
    let beside = Beside::new(job.vehicle, job.corners, rate_hz.recip(), before);
    Ok((
        drive,
        Record {
            track,
            collector: collector(job),
            events: Events::default(),
            axis,
            plausibility: Plausibility::default(),
            rolling_radius_m: job.vehicle.rolling_radius_m().unwrap_or(f64::NAN),
            air: AirCheck::default(),
            beside,
        },
    ))
}

pub(crate) fn conclude(
    log: &LogReader,
    job: &Job<'_>,
    (mut drive, pulses): (Drive, &Pulses),
    record: Record,
    sink: &mut dyn Sink,
    watch: Watch<'_>,
) -> Result<Done, DriveError> {
    if watch(1.0).is_break() {
        return Err(DriveError::Stopped);
    }
    drive.finish(job.settings.calibrate_s);
    let of_wheel_speeds = drive.radii().and_then(|_| record.plausibility.contradiction());
    // With it each bend would be a loss; one that does not go with the wheels at all was left out.
    let of_yaw = drive.yaw_fault().filter(|fault| matches!(fault, YawFault::Scaled(_)));
    let of_yaw = of_yaw.map(|fault| format!("yaw_rate_rad_s {fault}"));
    if let Some(contradiction) = record.axis.contradiction().or(of_wheel_speeds).or(of_yaw) {
        return Err(DriveError::Log(format!("{}: {contradiction}", log.path().display())));
    }
    let implausible = record.plausibility.concerns();
    let has_temperature = log.columns().motion.air.temperature && !job.corners.is_empty();
    let of_air: Vec<String> = record.air.concerns(has_temperature).collect();
    let of_pulses = pulses.finish(log.path(), log.last_time_s().unwrap_or(f64::NAN))?;
    let beside = record.beside.conclude(&Identified::by(drive.estimator()));
    let struts = beside.suspension.as_ref().and_then(|verdict| verdict.learned);
    let provenance = provenance(job, log, &beside.sensors_kpa);
    let (mut data, alerts) = record.complete(provenance, sink)?;
    let mut concerns = concerns::of(job, log, &drive);
    concerns.extend(implausible);
    concerns.extend(of_air);
    concerns.extend(of_pulses);
    concerns.extend(concerns::of_tire_sensors(&data));
    concerns.extend(beside.concerns(data.drive.origin_s, data.pressure_unit));
    concerns.extend(concerns::of_level(&data));
    data.concerns.clone_from(&concerns);
    data.suspension.clone_from(&beside.suspension);
    data.once_per_turn = beside.once_per_turn;
    let not_estimated = concerns::not_estimated(job, log);
    data.not_estimated = not_estimated.iter().map(|(corner, _)| *corner).collect();
    let fits = Corner::ALL.map(|corner| drive.fit(corner));
    let placards_kpa = Corner::ALL.map(|corner| job.vehicle.placard_kpa(corner));
    Ok(Done {
        data,
        alerts,
        concerns,
        not_estimated,
        fits,
        learned: Taught { suspension: struts, ..drive.learned() },
        placards_kpa,
        radii: drive.radii(),
        torsion: drive.torsion(),
        has_temperature,
        beside,
    })
}

/// Where the rows go.
pub(crate) struct Record {
    track: Option<RoadTrack>,
    collector: ReportCollector,
    events: Events,
    axis: TimeAxis,
    plausibility: Plausibility,
    rolling_radius_m: f64,
    air: AirCheck,
    beside: Beside,
}

impl Record {
    /// Takes a row of the log, what was estimated after it and what the monitor reported; the cars as they seem to be where the road is wanted.
    pub(crate) fn take(
        &mut self,
        row: &LogRow,
        estimates: &Estimates,
        report: &MonitorReport<f64>,
        radii: Option<&RadiusRow>,
        cars: Option<&QuarterCars>,
        sink: &mut dyn Sink,
    ) -> Result<(), DriveError> {
        self.events.take(report, &mut |time_s, change| sink.transition(time_s, change))?;
        self.collector.push_report(report);
        self.axis.take(row);
        self.plausibility.take(row, self.rolling_radius_m);
        self.air.take(&row.motion.air);
        let mut noticed = Vec::new();
        self.beside.take(row, estimates, radii, |event| noticed.push(event));
        noticed.iter().try_for_each(|event| sink.notice(event))?;
        if let Some(radii) = radii {
            self.collector.push_radii(row.time_s, &radii.radii);
        }
        let states = &report.wheels.map(|wheel| wheel.map(|wheel| wheel.state));
        sink.row(row, &EstimateRow { time_s: row.time_s, estimates, states, radii })?;
        match (&mut self.track, cars) {
            (Some(track), Some(cars)) => {
                track.push(row, estimates, cars);
                self.take_late(sink)?;
            }
            _ => self.collector.push(row.time_s, row.speed_m_s, &with_truth(row, estimates)),
        }
        Ok(())
    }

    fn take_late(&mut self, sink: &mut dyn Sink) -> Result<(), DriveError> {
        let Some(track) = &mut self.track else { return Ok(()) };
        while let Some(late) = track.pop() {
            sink.road(&late)?;
            let rows = with_truth(&late.row, &late.estimates);
            self.collector.push(late.row.time_s, late.row.speed_m_s, &rows);
        }
        Ok(())
    }

    fn complete(
        mut self,
        provenance: Provenance,
        sink: &mut dyn Sink,
    ) -> Result<(ReportData, Alerts), DriveError> {
        if let Some(track) = &mut self.track {
            track.finish();
        }
        self.take_late(sink)?;
        Ok((self.collector.finish(provenance), self.events.complete()))
    }
}

fn collector(job: &Job<'_>) -> ReportCollector {
    let mut configs = job.vehicle.corners;
    for corner in Corner::ALL {
        if !job.corners.contains(&corner) {
            configs[corner.index()] = None;
        }
    }
    let options = ReportOptions {
        pressure_unit: job.settings.pressure_unit,
        curves: job.report,
        ..ReportOptions::default()
    };
    ReportCollector::new(&configs, options)
}

fn with_truth(row: &LogRow, estimates: &Estimates) -> [Option<CornerRow>; 4] {
    Corner::ALL.map(|corner| {
        let (estimate, logged) = (estimates[corner.index()]?, row.corners[corner.index()]?);
        let sensor_kpa = row.motion.tire_sensor_kpa[corner.index()];
        Some(CornerRow { estimate, truth_kpa: logged.pressure_kpa, truth_road_m: logged.road_m, sensor_kpa })
    })
}
