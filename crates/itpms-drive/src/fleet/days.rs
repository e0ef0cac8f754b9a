//! Slow leaks: what each drive has shown of its day, put together for each car, after all of its drives are estimated. So drives stay
//! independent of each other, and of the order in which they were.

use std::collections::BTreeMap;
use std::path::PathBuf;

use itpms_core::model::{PressureUnit, Warning};
use itpms_core::monitor::MonitoredWheels;
use itpms_core::warning::{Cause, WheelState};
use itpms_core::wheel_speed::RadiusDay;
use itpms_data::Vehicle;
use itpms_data::out::state_label;
use itpms_data::reference::StoredReference;

use super::record::{DayRecord, DriveRecord};

/// A car's wheel speeds since one calibration.
type Known = (PathBuf, Box<MonitoredWheels<f64>>);

/// Adds to each drive, in the order of a car's drives, the slow leak that the days up to it show. `begun`: vehicle and reference of a drive.
pub(super) fn judge<'a>(
    drives: &mut [DriveRecord],
    unit: PressureUnit,
    begun: impl Fn(&DriveRecord) -> Option<(&'a Vehicle, PathBuf)>,
) {
    let mut cars: BTreeMap<String, Known> = BTreeMap::new();
    for drive in drives {
        let Some(day) = drive.day.clone() else { continue };
        let Some((vehicle, reference)) = begun(drive) else { continue };
        if cars.get(&drive.car).is_none_or(|(before, _)| *before != reference) {
            let Some(wheels) = begin(vehicle, &reference) else { continue };
            cars.insert(drive.car.clone(), (reference, wheels));
        }
        let Some((_, wheels)) = cars.get_mut(&drive.car) else { continue };
        let DayRecord { day, change_1e3, covariance_1e6 } = day;
        wheels.add_day(&RadiusDay { day, change_1e3, covariance_1e6 });
        let Some(mut alert) = wheels.alert().filter(|alert| matches!(alert.cause, Cause::SlowLeak(_))) else {
            continue;
        };
        if drive.alerts.iter().any(|sentence| sentence.contains("slow leak")) {
            continue;
        }
        (alert.since_s, alert.reported_s) = (drive.duration_s, drive.duration_s);
        drive.alerts.push(alert.shown_in(unit).to_string());
        for wheel in &mut drive.wheels {
            if alert.wheels.iter().any(|corner| corner.label() == wheel.wheel) && wheel.last.is_none() {
                wheel.state = state_label(Some(WheelState::Low)).to_owned();
                wheel.warning = Warning::Low.label().to_owned();
                wheel.warnings = wheel.warnings.max(1);
                wheel.first_warning_s = wheel.first_warning_s.or(Some(drive.duration_s));
            }
        }
    }
}

fn begin(vehicle: &Vehicle, reference: &std::path::Path) -> Option<Box<MonitoredWheels<f64>>> {
    let stored = StoredReference::read(reference).ok()?;
    let mut wheels = Box::new(MonitoredWheels::unconfigured());
    wheels.configure(&vehicle.wheel_speed_config().ok()?).ok()?;
    let loaded = wheels.load_calibration(stored.wheel_speeds.as_ref()?) && wheels.load_days(&stored.days);
    loaded.then_some(wheels)
}
