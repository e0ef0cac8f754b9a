//! The files a drive leaves: pressures as they are known, road and report half a minute later, all of them renamed
//! to their names at the very end or none.

use std::path::PathBuf;

use itpms_analysis::report;
use itpms_core::model::Corner;
use itpms_core::warning::Change;
#[cfg(feature = "mcap")]
use itpms_data::out::mcap::McapResults;
use itpms_data::out::{
    AtomicFile, EstimateRow, EstimateWriter, RateGate, RoadPoint, RoadWriter, WheelSpeedUse,
    transition_object,
};
use itpms_data::{LogReader, LogRow, Vehicle};
use serde_json::{Map, Value};

use crate::error::DriveError;
use crate::reference::Saving;
use crate::road::LateRow;
use crate::run::{Done, Heights, Sink};
use crate::settings::Settings;

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FilePaths {
    /// Pressures: .csv or .parquet.
    pub estimates: Option<PathBuf>,
    /// The road under each wheel: .csv or .parquet.
    pub road: Option<PathBuf>,
    pub report: Option<PathBuf>,
    /// Warnings and malfunctions as they come and go.
    pub events: Option<PathBuf>,
    /// The drive itself and all that was found in it, on one time axis.
    #[cfg(feature = "mcap")]
    pub mcap: Option<PathBuf>,
    /// The result of the calibration drive.
    pub reference: Option<PathBuf>,
}

impl FilePaths {
    /// The heights of the road that they need.
    pub fn heights(&self) -> Heights {
        #[cfg(feature = "mcap")]
        let mcap = self.mcap.is_some();
        #[cfg(not(feature = "mcap"))]
        let mcap = false;
        if self.road.is_some() || self.report.is_some() || mcap { Heights::Smoothed } else { Heights::None }
    }
}

#[derive(Debug)]
pub struct Files {
    estimates: Option<EstimateWriter>,
    gate: RateGate,
    road: Option<RoadWriter>,
    page: Option<AtomicFile>,
    events: Option<AtomicFile>,
    #[cfg(feature = "mcap")]
    mcap: Option<McapResults>,
    reference: Option<Saving>,
    calibrate_s: Option<f64>,
}

impl Files {
    /// Starts all files, so that one that cannot be written is known before the work begins.
    pub fn create(
        paths: &FilePaths,
        settings: &Settings,
        vehicle: &Vehicle,
        log: &LogReader,
        corners: &[Corner],
        wheel_speeds: WheelSpeedUse,
    ) -> Result<Self, DriveError> {
        if let Some(path) = paths.road.as_ref().filter(|_| corners.is_empty()) {
            let what = "wheel speeds alone show no road; expected accelerations of a corner";
            return Err(DriveError::Mismatch(format!("{}: {what}", path.display())));
        }
        let saving = |path: &PathBuf| Saving::create(path, settings, vehicle);
        let estimates = paths.estimates.as_ref();
        Ok(Self {
            estimates: estimates
                .map(|path| EstimateWriter::create(path, corners, wheel_speeds, log.columns().motion.air))
                .transpose()?,
            gate: RateGate::new(settings.rate_hz),
            road: paths.road.as_ref().map(|path| RoadWriter::create(path, corners)).transpose()?,
            page: paths.report.as_ref().map(|path| AtomicFile::create(path)).transpose()?,
            events: paths.events.as_ref().map(|path| AtomicFile::create(path)).transpose()?,
            #[cfg(feature = "mcap")]
            mcap: paths
                .mcap
                .as_ref()
                .map(|path| McapResults::create(path, log, corners, wheel_speeds))
                .transpose()?,
            reference: paths.reference.as_ref().map(saving).transpose()?,
            calibrate_s: settings.calibrate_s,
        })
    }

    /// Completes all files and gives them their names.
    /// Errors: a file cannot be written; a calibration drive taught nothing: then all files but the reference are there.
    pub fn complete(self, done: &Done) -> Result<(), DriveError> {
        let mut files = Vec::new();
        if let Some(estimates) = self.estimates {
            files.push(estimates.finish()?);
        }
        if let Some(road) = self.road {
            files.push(road.finish()?);
        }
        if let Some(mut page) = self.page {
            page.append(report::render_report(&done.data).map_err(DriveError::Report)?.as_bytes())?;
            page.settle()?;
            files.push(page);
        }
        if let Some(mut events) = self.events {
            events.settle()?;
            files.push(events);
        }
        #[cfg(feature = "mcap")]
        if let Some(mcap) = self.mcap {
            files.push(mcap.finish()?);
        }
        files.into_iter().try_for_each(AtomicFile::commit)?;
        let driven_s = done.data.drive.duration_s;
        let taught = self.reference.as_ref().filter(|saving| !saving.adds_a_day());
        if let Some((saving, why)) = taught.zip(done.calibration_doubt()) {
            return Err(saving.refused(why));
        }
        let reference =
            self.reference.map(|saving| saving.complete(self.calibrate_s, driven_s, done.learned));
        reference.transpose()?.map(AtomicFile::commit).transpose()?;
        Ok(())
    }
}

impl Sink for Files {
    fn row(&mut self, row: &LogRow, known: &EstimateRow<'_>) -> Result<(), DriveError> {
        #[cfg(feature = "mcap")]
        if let Some(mcap) = &mut self.mcap {
            mcap.write_signals(row)?;
        }
        if !self.gate.lets_through(row.time_s) {
            return Ok(());
        }
        if let Some(writer) = &mut self.estimates {
            writer.write(known)?;
        }
        #[cfg(feature = "mcap")]
        if let Some(mcap) = &mut self.mcap {
            mcap.write_estimate(known)?;
        }
        Ok(())
    }

    fn road(&mut self, late: &LateRow) -> Result<(), DriveError> {
        let point = |e: &itpms_core::model::CornerEstimate<f64>| RoadPoint {
            road_m: e.road_m,
            road_sd_m: e.road_sd_m,
        };
        let points = late.estimates.map(|estimate| estimate.as_ref().map(point));
        if let Some(road) = &mut self.road {
            road.write(late.row.time_s, late.distance_m, &points)?;
        }
        #[cfg(feature = "mcap")]
        if let Some(mcap) = &mut self.mcap {
            mcap.write_road(late.row.time_s, late.distance_m, &points)?;
        }
        Ok(())
    }

    fn transition(&mut self, time_s: f64, change: &Change<f64>) -> Result<(), DriveError> {
        if let Some(file) = &mut self.events {
            let line = Value::Object(transition_object(time_s, change));
            file.append(format!("{line}\n").as_bytes())?;
        }
        #[cfg(feature = "mcap")]
        if let Some(mcap) = &mut self.mcap {
            mcap.write_transition(time_s, change)?;
        }
        Ok(())
    }

    fn notice(&mut self, event: &Map<String, Value>) -> Result<(), DriveError> {
        let line = |event| format!("{}\n", Value::Object(event));
        Ok(self.events.as_mut().map_or(Ok(()), |file| file.append(line(event.clone()).as_bytes()))?)
    }
}
