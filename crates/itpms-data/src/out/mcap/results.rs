//! A drive and what was found in it, in one file: `/signals`, `/estimate`, `/road`, each with a topic per wheel, and `/alerts`.

use std::path::Path;

use itpms_core::model::Corner;
use itpms_core::warning::Change;

use super::log::McapLog;
use super::{RowTopics, Topic, alert_fields};
use crate::LogReader;
use crate::error::DataError;
use crate::log::LogRow;
use crate::out::cell::Cell;
use crate::out::results::{EstimateColumns, RoadColumns};
use crate::out::{AtomicFile, EstimateRow, RoadPoint, WheelSpeedUse, transition_object};

/// Writes the log's own columns and those of [`EstimateWriter`](crate::out::EstimateWriter) and [`RoadWriter`](crate::out::RoadWriter), with
/// the same names and units, and the alerts as they come and go.
#[derive(Debug)]
pub struct McapResults {
    log: McapLog,
    estimates: (EstimateColumns, RowTopics),
    /// Wheel speeds show no road.
    road: Option<(RoadColumns, RowTopics)>,
    alerts: Topic,
    cells: Vec<Cell<'static>>,
}

impl McapResults {
    /// Starts the file for the drive of this log.
    pub fn create(
        path: &Path,
        log: &LogReader,
        corners: &[Corner],
        wheel_speeds: WheelSpeedUse,
    ) -> Result<Self, DataError> {
        let mut file = McapLog::create(path, *log.columns())?;
        file.set_start_ns(log.start_ns());
        let columns = EstimateColumns::new(corners, wheel_speeds, log.columns().motion.air);
        let topics = file.add(|writer| RowTopics::create(writer, "/estimate", &columns.table()))?;
        let estimates = (columns, topics);
        let road = (!corners.is_empty()).then(|| RoadColumns::new(corners));
        let road = road.map(|columns| {
            let topics = file.add(|writer| RowTopics::create(writer, "/road", &columns.table()))?;
            Ok::<_, DataError>((columns, topics))
        });
        let road = road.transpose()?;
        let alerts = file.add(|writer| writer.add_topic("/alerts", alert_fields()))?;
        Ok(Self { log: file, estimates, road, alerts, cells: Vec::new() })
    }

    /// Adds a row of the log.
    pub fn write_signals(&mut self, row: &LogRow) -> Result<(), DataError> {
        self.log.write(row)
    }

    /// Adds what [`EstimateWriter::write`](crate::out::EstimateWriter::write) writes.
    pub fn write_estimate(&mut self, row: &EstimateRow<'_>) -> Result<(), DataError> {
        let (columns, topics) = &mut self.estimates;
        columns.cells(row, &mut self.cells);
        self.log.add(|writer| topics.write(writer, row.time_s, &self.cells))
    }

    /// Adds what [`RoadWriter::write`](crate::out::RoadWriter::write) writes, half a minute later than the rest.
    pub fn write_road(
        &mut self,
        time_s: f64,
        distance_m: f64,
        points: &[Option<RoadPoint>; 4],
    ) -> Result<(), DataError> {
        let Some((columns, topics)) = &mut self.road else { return Ok(()) };
        columns.cells(time_s, distance_m, points, &mut self.cells);
        self.log.add(|writer| topics.write(writer, time_s, &self.cells))
    }

    /// Adds an alert that began or ended.
    pub fn write_transition(&mut self, time_s: f64, change: &Change<f64>) -> Result<(), DataError> {
        let alerts = &mut self.alerts;
        self.log.add(|writer| writer.write(alerts, time_s, transition_object(time_s, change)))
    }

    /// Everything onto the disk; [`AtomicFile::commit`] then gives the file its name.
    pub fn finish(self) -> Result<AtomicFile, DataError> {
        self.log.finish()
    }
}
