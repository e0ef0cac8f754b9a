//! The results of a drive's wheels. Called by the fleet for its tables, and by the Python package for the same rows.

use itpms_analysis::report::{CornerReport, Reading};
use itpms_analysis::suspension::DamperHealth;
use itpms_core::model::{Corner, Misfit, Warning};
use itpms_core::warning::{Cause, WheelState};
use itpms_data::out::{RadiusRow, state_label};

use super::record::{DamperRecord, FitRecord, Loss, Pressure, WheelRecord};
use crate::alerts::Listed;
use crate::drive::Estimates;
use crate::run::{Done, Fit};

/// How often each wheel's warnings began, counted row by row.
#[derive(Debug, Clone)]
pub struct Begun {
    before: [Warning; 4],
    /// Of each corner: low, malfunction.
    begun: [[u32; 2]; 4],
}

impl Default for Begun {
    fn default() -> Self {
        Self { before: [Warning::None; 4], begun: [[0; 2]; 4] }
    }
}

impl Begun {
    /// Takes what was estimated after a row of the log.
    pub fn take(&mut self, estimates: &Estimates) {
        for i in Corner::ALL.map(Corner::index) {
            let Some(now) = estimates[i].as_ref().map(|estimate| estimate.warning) else { continue };
            if now != self.before[i] {
                match now {
                    Warning::None => {}
                    Warning::Low => self.begun[i][0] += 1,
                    Warning::Malfunction => self.begun[i][1] += 1,
                }
                self.before[i] = now;
            }
        }
    }
}

pub fn wheels(done: &Done, begun: &Begun) -> Vec<WheelRecord> {
    let of = |corner: &CornerReport| {
        let i = corner.corner.index();
        let damper = done.beside.suspension.as_ref().map(|verdict| &verdict.dampers[i]);
        wheel(corner, begun.begun[i], done.fits[i].as_ref(), damper)
    };
    match &done.radii {
        Some(radii) if done.data.corners.is_empty() => {
            Corner::ALL.into_iter().map(|corner| rolling(done, radii, corner)).collect()
        }
        _ => done.data.corners.iter().map(of).collect(),
    }
}

/// A wheel of which the speed alone is known: no pressure.
fn rolling(done: &Done, radii: &RadiusRow, corner: Corner) -> WheelRecord {
    let state = radii.states[corner.index()];
    let names = |listed: &&Listed| {
        listed.alert.wheels.contains(corner)
            && matches!(listed.alert.cause, Cause::Differs { is_known: true, .. } | Cause::SlowLeak(_))
    };
    let begun: Vec<&Listed> = done.alerts.listed().iter().filter(names).collect();
    let faults = |listed: &&Listed| {
        listed.alert.wheels.contains(corner) && matches!(listed.alert.cause, Cause::Malfunction(_))
    };
    let faults: Vec<&Listed> = done.alerts.listed().iter().filter(faults).collect();
    let warning = match state {
        Some(WheelState::Low) => Warning::Low,
        Some(WheelState::Malfunction) => Warning::Malfunction,
        _ => Warning::None,
    };
    let radius = &radii.radii.wheels[corner.index()];
    let lost = radius.lost_share.is_finite().then_some(Loss {
        share: radius.lost_share,
        sd: radius.lost_share_sd,
        detectable: radius.detectable_loss_share,
    });
    let origin_s = done.data.drive.origin_s;
    WheelRecord {
        wheel: corner.label().to_owned(),
        placard_kpa: done.placards_kpa[corner.index()].unwrap_or_default(),
        state: state_label(state).to_owned(),
        warning: warning.label().to_owned(),
        last: None,
        lowest: None,
        share_valid: f64::from(u8::from(radii.radii.wheels[corner.index()].informed())),
        warnings: u32::try_from(begun.len()).unwrap_or(u32::MAX),
        first_warning_s: begun.first().map(|listed| listed.alert.reported_s - origin_s),
        malfunctions: u32::try_from(faults.len()).unwrap_or(u32::MAX),
        first_malfunction_s: faults.first().map(|listed| listed.alert.reported_s - origin_s),
        lost,
        iri_m_per_km: None,
        fit: None,
        damper: None,
    }
}

fn wheel(
    corner: &CornerReport,
    [warnings, malfunctions]: [u32; 2],
    fit: Option<&Fit>,
    damper: Option<&DamperHealth>,
) -> WheelRecord {
    let figures = &corner.figures;
    let pressure = |r: Reading| Pressure { time_s: r.time_s, pressure_kpa: r.pressure_kpa, sd_kpa: r.sd_kpa };
    WheelRecord {
        wheel: corner.corner.label().to_owned(),
        placard_kpa: corner.placard_kpa,
        state: state_label(corner.state).to_owned(),
        warning: figures.warning.label().to_owned(),
        last: figures.last.map(pressure),
        lowest: figures.lowest.map(pressure),
        share_valid: figures.share_valid,
        warnings,
        first_warning_s: figures.low_since_s,
        malfunctions,
        first_malfunction_s: figures.malfunction_since_s,
        lost: None,
        iri_m_per_km: corner.road.as_ref().and_then(|road| road.iri_m_per_km),
        fit: fit.map(fitted),
        damper: damper.map(|damper| DamperRecord {
            state: damper.state.label().to_owned(),
            over_reference: damper.over_reference.map(|over| over.value),
            left_right: damper.left_right.map(|ratio| ratio.value),
            row: 0,
            reported: false,
        }),
    }
}

fn fitted((fit, misfit): &Fit) -> FitRecord {
    let word = |misfit: Misfit| match misfit {
        Misfit::Incoherent => "incoherent",
        Misfit::Unexplained => "unexplained",
        Misfit::PartlyUnexplained => "partly-unexplained",
        Misfit::Hop => "hop",
        Misfit::Response => "response",
        Misfit::Apart => "apart",
    };
    FitRecord {
        incoherence: fit.incoherence,
        unexplained: fit.unexplained,
        hop_excess: fit.hop_excess,
        friction_n: fit.friction_n,
        misfit: misfit.map(|misfit| word(misfit).to_owned()),
    }
}
