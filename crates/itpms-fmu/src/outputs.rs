//! Values of the outputs. Called by the model after each step.

use itpms_core::CornerEstimate;
use itpms_core::model::Warning;
use itpms_core::warning::{Doubt, MonitorReport, WheelState};
use itpms_data::Vehicle;

/// Cold pressure and its standard deviation in kPa.
pub(crate) fn cold_pressure(estimate: &CornerEstimate<f64>) -> [f64; 2] {
    estimate.cold.map_or([f64::NAN; 2], |cold| [cold.pressure_kpa, cold.sd_kpa])
}

/// The air to be added in kPa, and its state: 0 nothing known, 1 fine, 2 add.
pub(crate) fn cold_add(estimate: Option<&CornerEstimate<f64>>, placard_kpa: f64) -> [f64; 2] {
    let cold = estimate.filter(|estimate| estimate.validity.is_valid()).and_then(|estimate| estimate.cold);
    let Some(cold) = cold else { return [f64::NAN, 0.0] };
    cold.air_to_add_kpa(placard_kpa).map_or([f64::NAN, 1.0], |kpa| [kpa, 2.0])
}

pub(crate) fn state(state: WheelState) -> f64 {
    match state {
        WheelState::Unknown(Doubt::Uncertain) => 5.0,
        WheelState::Unknown(_) => 0.0,
        WheelState::Fine => 1.0,
        WheelState::Low => 2.0,
        WheelState::Over => 3.0,
        WheelState::Malfunction => 4.0,
    }
}

pub(crate) fn code(warning: Warning) -> f64 {
    match warning {
        Warning::None => 0.0,
        Warning::Low => 1.0,
        Warning::Malfunction => 2.0,
    }
}

/// Whether every tire is known to be fine: one of the vehicle file that is not measured may be the one that is low.
pub(crate) fn all_fine(file: &Vehicle, report: &MonitorReport<f64>) -> bool {
    let mut corners = file.corners.iter().zip(&report.wheels);
    report.is_all_fine() && corners.all(|(corner, wheel)| corner.is_none() || wheel.is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use itpms_core::model::Validity;
    use itpms_core::warning::WheelReport;

    #[test]
    fn a_tire_of_the_car_that_is_not_measured_is_not_fine() {
        let fine = WheelReport {
            state: WheelState::Fine,
            validity: Validity::Valid,
            warning: Warning::None,
            pressure_kpa: 240.0,
            pressure_sd_kpa: 2.0,
            reference_kpa: 240.0,
            informed_s: 10.0,
        };
        let mut file = Vehicle::paper();
        assert!(file.corners.iter().all(Option::is_some));
        let mut report = MonitorReport::empty();
        report.wheels = [Some(fine); 4];
        assert!(all_fine(&file, &report));
        report.wheels[3] = None;
        assert!(report.is_all_fine() && !all_fine(&file, &report));
        // Unless the car has no such corner.
        file.corners[3] = None;
        assert!(all_fine(&file, &report));
    }
}
