//! The files a drive leaves: pressures as they are known, road and report half a minute later, all of them renamed
//! to their names at the very end or none.

use itpms_core::model::{Corner, VehicleCalibration};
use itpms_core::warning::MonitorReport;
use itpms_data::out::{AtomicFile, EstimateWriter, RateGate, RoadPoint, RoadWriter};
use itpms_data::{LogReader, LogRow, Vehicle};
use itpms_study::report::{self, CornerRow, Provenance, ReportCollector, ReportData, ReportOptions};

use super::drive::{Estimates, QuarterCars};
use super::events::{Alerts, Events};
use super::reference::Saving;
use super::road::RoadTrack;
use crate::args::EstimateArgs;
use crate::commands::names;
use crate::exit::Failure;

/// Refuses an output that is one of the inputs, or two outputs of one name.
pub(super) fn check_names(args: &EstimateArgs) -> Result<(), Failure> {
    let [dbc, signals] = args.reading.inputs();
    let inputs = [
        (Some(args.log.as_path()), "the drive log"),
        (Some(&args.vehicle), "the vehicle file"),
        (args.reference.as_deref(), "the learned reference"),
        dbc,
        signals,
    ];
    let optional = [&args.road_out, &args.report, &args.save_reference, &args.events];
    let [road, report, reference, events] = optional.map(|path| path.as_deref());
    names::check(&inputs, &[Some(&args.output), road, report, reference, events])
}

/// The files in the making.
pub(super) struct Outputs {
    estimates: EstimateWriter,
    gate: RateGate,
    track: Option<RoadTrack>,
    road: Option<RoadWriter>,
    page: Option<AtomicFile>,
    reference: Option<Saving>,
    events: Events,
    collector: ReportCollector,
}

impl Outputs {
    /// Starts all files, so that one that cannot be written is known before the work begins.
    pub(super) fn create(
        args: &EstimateArgs,
        vehicle: &Vehicle,
        corners: &[Corner],
        sample_rate_hz: f64,
    ) -> Result<Self, Failure> {
        let road_wanted = args.road_out.is_some() || args.report.is_some();
        let mut configs = vehicle.corners;
        for corner in Corner::ALL {
            if !corners.contains(&corner) {
                configs[corner.index()] = None;
            }
        }
        Ok(Self {
            estimates: EstimateWriter::create(&args.output, corners)?,
            gate: RateGate::new(args.rate),
            road: args.road_out.as_ref().map(|path| RoadWriter::create(path, corners)).transpose()?,
            page: args.report.as_ref().map(|path| AtomicFile::create(path)).transpose()?,
            reference: Saving::create(args, vehicle)?,
            events: Events::create(args.events.as_deref())?,
            track: road_wanted.then(|| RoadTrack::new(vehicle, corners, sample_rate_hz)).transpose()?,
            collector: ReportCollector::new(&configs, ReportOptions::default()),
        })
    }

    /// Takes a row of the log and what was estimated after it.
    pub(super) fn take(
        &mut self,
        row: &LogRow,
        estimates: &Estimates,
        cars: &QuarterCars,
        report: &MonitorReport<f64>,
    ) -> Result<(), Failure> {
        self.events.take(report)?;
        self.collector.push_report(report);
        if self.gate.lets_through(row.time_s) {
            self.estimates.write(row.time_s, estimates)?;
        }
        match &mut self.track {
            None => self.collector.push(row.time_s, row.speed_m_s, &with_truth(row, estimates)),
            Some(track) => {
                track.push(row, estimates, cars);
                self.write_late()?;
            }
        }
        Ok(())
    }

    fn write_late(&mut self) -> Result<(), Failure> {
        let Some(track) = &mut self.track else { return Ok(()) };
        while let Some(late) = track.pop() {
            if let Some(road) = &mut self.road {
                let point = |e: &itpms_core::model::CornerEstimate<f64>| RoadPoint {
                    road_m: e.road_m,
                    road_sd_m: e.road_sd_m,
                };
                let points = late.estimates.map(|estimate| estimate.as_ref().map(point));
                road.write(late.row.time_s, late.distance_m, &points)?;
            }
            let rows = with_truth(&late.row, &late.estimates);
            self.collector.push(late.row.time_s, late.row.speed_m_s, &rows);
        }
        Ok(())
    }

    /// Completes all files and gives them their names.
    pub(super) fn complete(
        mut self,
        args: &EstimateArgs,
        vehicle: &Vehicle,
        log: &LogReader,
        learned: Option<VehicleCalibration<f64>>,
    ) -> Result<(ReportData, Alerts), Failure> {
        if let Some(track) = &mut self.track {
            track.finish();
        }
        self.write_late()?;
        let data = self.collector.finish(provenance(args, vehicle, log));
        let mut files = vec![self.estimates.finish()?];
        if let Some(road) = self.road {
            files.push(road.finish()?);
        }
        if let Some(mut page) = self.page {
            page.append(report::render_report(&data).map_err(Failure::Report)?.as_bytes())?;
            page.settle()?;
            files.push(page);
        }
        if let Some(reference) = self.reference {
            files.push(reference.complete(args, learned)?);
        }
        let (events, alerts) = self.events.complete()?;
        files.extend(events);
        for file in files {
            file.commit()?;
        }
        Ok((data, alerts))
    }
}

fn with_truth(row: &LogRow, estimates: &Estimates) -> [Option<CornerRow>; 4] {
    Corner::ALL.map(|corner| {
        let (estimate, logged) = (estimates[corner.index()]?, row.corners[corner.index()]?);
        Some(CornerRow { estimate, truth_kpa: logged.pressure_kpa, truth_road_m: logged.road_m })
    })
}

fn provenance(args: &EstimateArgs, vehicle: &Vehicle, log: &LogReader) -> Provenance {
    Provenance {
        program: format!("itpms {}", env!("CARGO_PKG_VERSION")),
        source: args.log.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        vehicle: vehicle.name.clone(),
        estimator: args.estimator.label().to_owned(),
        // The same input gives the same page, byte by byte: no date.
        created: String::new(),
        options: vec![("rate".to_owned(), format!("{} Hz", args.rate))],
        repairs: log.repairs().counts().into_iter().map(|(what, count)| (what.to_owned(), count)).collect(),
    }
}
