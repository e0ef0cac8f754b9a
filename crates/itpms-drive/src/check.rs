//! A vehicle file held against a drive: whether the suspension in the drive is the file's, and where the estimator says that body and wheel
//! do not go together.

use itpms_analysis::beside::{SuspensionWatch, dampers_json, left_right_lines};
use itpms_analysis::suspension::SuspensionVerdict;
use itpms_analysis::transfer::{CornerCheck, CrossSpectra, Suspension, Verdict, page};
use itpms_core::model::Corner;
use itpms_data::out::WheelSpeedUse;
use itpms_data::{LogReader, Vehicle};
use serde_json::{Map, Value, json};

use crate::alerts::{Alerts, Events};
use crate::concerns::common_corners;
use crate::drive::Drive;
use crate::error::DriveError;
use crate::run::{Fit, ROWS_PER_LOOK, Watch};
use crate::settings::Settings;
use crate::summary::fit_json;
use crate::time_axis::TimeAxis;

const GAP_STEPS: f64 = 1.5;

#[derive(Debug, Clone)]
pub struct CheckedVehicle {
    /// Corner by corner, those that the log has measured and the file describes.
    pub corners: Vec<CornerCheck>,
    /// Left against right of each axle, where all four corners are measured.
    pub suspension: Option<SuspensionVerdict>,
    /// Contradictions and repairs of the log, a sentence each.
    pub concerns: Vec<String>,
    vehicle: String,
    log: String,
}

/// Holds a vehicle file against a drive. Errors: no corner in common; the log cannot be read on; [`DriveError::Stopped`].
pub fn check(vehicle: &Vehicle, log: &mut LogReader, watch: Watch<'_>) -> Result<CheckedVehicle, DriveError> {
    let corners = common_corners(log, vehicle)?;
    if corners.is_empty() {
        let path = log.path().display();
        return Err(DriveError::Log(format!(
            "{path}: has wheel speeds alone, expected accelerations: there is no suspension to check"
        )));
    }
    let mut axis = TimeAxis::of(vehicle);
    let (spectra, fits, alerts, struts) = listen(vehicle, log, &corners, &mut axis, watch)?;
    let checked = corners.iter().zip(&spectra).filter_map(|(corner, spectra)| {
        let mut check = CornerCheck::of(corner.label(), spectra, suspension(vehicle, *corner)?);
        check.fit = fits[corner.index()];
        check.broken = alerts.broken(*corner).map(ToString::to_string);
        Some(check)
    });
    let name = log.path().file_name().unwrap_or(log.path().as_os_str());
    Ok(CheckedVehicle {
        corners: checked.collect(),
        suspension: struts,
        concerns: axis.contradiction().into_iter().chain(log.repairs().warnings()).collect(),
        vehicle: vehicle.name.clone(),
        log: name.to_string_lossy().into_owned(),
    })
}

type Checked = (Vec<CrossSpectra>, [Option<Fit>; 4], Alerts, Option<SuspensionVerdict>);

/// The spectra of all rows, corner by corner, and what an estimator that is given no more than the file says at their end of how body and
/// wheel go together, in the order of [`Corner::ALL`], and what its monitor reports. `axis` takes the rows, too.
fn listen(
    vehicle: &Vehicle,
    log: &mut LogReader,
    corners: &[Corner],
    axis: &mut TimeAxis,
    watch: Watch<'_>,
) -> Result<Checked, DriveError> {
    let survey = *log.survey();
    let mut drive =
        Drive::new(&Settings::default(), vehicle, corners, WheelSpeedUse::None, survey.estimator_rate_hz())?;
    let mut spectra: Vec<CrossSpectra> =
        corners.iter().map(|_| CrossSpectra::new(survey.sample_period_s)).collect();
    let mut struts = SuspensionWatch::new(vehicle, corners, survey.sample_period_s, None);
    let (mut rows, mut before_s, mut events) = (0u64, f64::NAN, Events::default());
    while let Some(mut row) = log.next_row()? {
        if rows.is_multiple_of(ROWS_PER_LOOK) && watch(log.progress()).is_break() {
            return Err(DriveError::Stopped);
        }
        rows += 1;
        let lost = row.time_s - before_s > GAP_STEPS * survey.sample_period_s;
        before_s = row.time_s;
        for (corner, spectra) in corners.iter().zip(&mut spectra) {
            if lost {
                spectra.gap();
            }
            match &row.corners[corner.index()] {
                Some(signals) => spectra.push(signals.wheel_accel_m_s2, signals.body_accel_m_s2),
                None => spectra.gap(),
            }
        }
        axis.take(&row);
        if let Some(struts) = &mut struts {
            struts.take(&row);
        }
        drive.update(&mut row);
        events.take(drive.report(), &mut |_, _| Ok(()))?;
    }
    let suspension = struts.as_ref().map(SuspensionWatch::conclude);
    Ok((spectra, Corner::ALL.map(|corner| drive.fit(corner)), events.complete(), suspension))
}

fn suspension(vehicle: &Vehicle, corner: Corner) -> Option<Suspension> {
    let (car, sd) = (vehicle.corner(corner)?.quarter_car, vehicle.uncertainty(corner));
    Some(Suspension {
        sprung_mass_kg: car.sprung_mass_kg(),
        damping_n_s_per_m: car.damping_n_s_per_m(),
        spring_n_per_m: car.spring_n_per_m(),
        sprung_mass_relative_sd: sd.sprung_mass_relative_sd,
        damping_relative_sd: sd.damping_relative_sd,
        spring_relative_sd: sd.spring_relative_sd,
    })
}

impl CheckedVehicle {
    /// Corner by corner: what `itpms vehicle check --json` prints.
    pub fn document(&self) -> Value {
        let corner = |check: &CornerCheck| {
            let (damping, spring) = match &check.verdict {
                Verdict::Compared { damping, spring } => (Some(*damping), Some(*spring)),
                Verdict::TooShort | Verdict::Incoherent(_) => (None, None),
            };
            let value = json!({
                "coherence": check.coherence,
                "damping_over_file": damping.map(|(ratio, _)| ratio),
                "damping_over_file_se": damping.map(|(_, error)| error),
                "spring_over_file": spring.map(|(ratio, _)| ratio),
                "spring_over_file_se": spring.map(|(_, error)| error),
                "fit": check.fit.as_ref().map(fit_json),
            "asks_for_change": check.asks_for_change(),
                "sentence": check.sentence(),
            });
            (check.label.clone(), value)
        };
        json!({
            "corners": self.corners.iter().map(corner).collect::<Map<String, Value>>(),
            "dampers": dampers_json(self.suspension.as_ref()),
        })
    }

    /// Left against right of each axle, a line each; none where corners are missing.
    pub fn damper_lines(&self) -> Vec<String> {
        self.suspension.as_ref().map_or_else(Vec::new, left_right_lines)
    }

    /// The page with a picture of each corner (HTML, complete in itself).
    pub fn page(&self) -> String {
        page(&self.vehicle, &self.log, &self.corners)
    }
}
