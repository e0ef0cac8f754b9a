//! What a drive's wheel speeds and tooth pulses begin with.

use itpms_core::monitor::MonitoredCar;
use itpms_core::torsion::CarTorsion;
use itpms_data::Vehicle;

use crate::error::LiveError;
use crate::options::DriveOptions;

/// A car whose tooth pulses may be read.
pub(crate) type Car = MonitoredCar<f64, Option<Box<CarTorsion<f64>>>>;

/// Gives a car about to begin what was learned, before it is calibrated.
pub(crate) fn begin(car: &mut Car, vehicle: &Vehicle, options: &DriveOptions) -> Result<(), LiveError> {
    let Some(monitor) = car.wheels_mut() else { return Ok(()) };
    if let Some(calibration) = &options.wheel_reference
        && !monitor.load_calibration(calibration)
    {
        let what = "the learned reference has wheel speeds that no car has";
        return Err(LiveError::Refused(what.to_owned()));
    }
    if let Some(days) = &options.days_reference {
        let _ = monitor.load_days(days);
    }
    if options.pulses {
        let (of_wheels, placard_kpa) = vehicle.torsion_config().map_err(lacks)?;
        let mut torsion = Box::new(CarTorsion::unconfigured());
        let configured = torsion.configure(&of_wheels, &placard_kpa);
        configured.map_err(|error| LiveError::Refused(error.to_string()))?;
        let _ = torsion.load_calibration(&options.torsion_reference);
        car.read_pulses(torsion);
    }
    Ok(())
}

/// A key that the vehicle file lacks for what the source sends.
pub(crate) fn lacks(key: &str) -> LiveError {
    LiveError::Refused(format!("the vehicle file has no {key}"))
}
