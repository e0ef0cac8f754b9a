//! What a reset does to what each tire should have.

use itpms_core::model::Corner;
use itpms_core::monitor::MonitorConfig;
use itpms_core::warning::{MonitorReport, Regulation};

use super::reported::{Drive, FINE, RATE_HZ, Reported, car, low};

/// What the rear left tire should have.
fn reference_kpa(report: &MonitorReport<f64>) -> f64 {
    report.wheels[Corner::RearLeft.index()].unwrap().reference_kpa
}

#[test]
fn after_a_reset_a_warm_tire_should_have_what_it_had() {
    let mut drive = Drive::new();
    drive.monitor.begin_calibration(1200.0).unwrap();
    let warm = Reported { kpa: [256.3; 4], ..FINE };
    let stands = Reported { gate: 0.0, speed_m_s: 0.0, ..warm };
    // Until the reset is over the placard counts, then the mean of its last five minutes.
    assert_eq!(reference_kpa(drive.on(1199.0, &warm)), 241.3);
    assert!((reference_kpa(drive.on(2.0, &warm)) - 256.3).abs() < 1e-6);
    // Cooling: warmth 1 - exp(-2) at the end, halved by 900 ln 2 s at a stop, over its mean from 900 to 1200 s. A tenth
    // of a kPa for steps of a tenth of a second.
    drive.on(900.0 * 2f64.ln(), &stands);
    let mean = 1.0 - 2.0 * ((-1.5f64).exp() - (-2f64).exp());
    let share = 0.5 * (1.0 - (-2f64).exp()) / mean;
    let cooled = reference_kpa(drive.monitor.report());
    assert!((cooled - (241.3 + 15.0 * share)).abs() < 0.1, "{cooled}");
    // The key out for an hour: cold. Driven for an hour: warm again, and not more than at the reset.
    drive.step += (3600.0 * RATE_HZ) as u32;
    assert!((reference_kpa(drive.on(0.1, &FINE)) - 241.3).abs() < 0.1);
    assert!((reference_kpa(drive.on(3600.0, &warm)) - 256.3).abs() < 1e-6);
    // A fifth off the warm pressure is reported now, and was not against the placard.
    let lost = Reported { sd: 4.0, ..low(0.8 * 268.0) };
    assert!(Drive::new().on(60.0, &lost).alerts().next().is_none());
    assert!(drive.on(10.0, &lost).alerts().next().is_some());
    // A new reset forgets the old one.
    drive.monitor.begin_calibration(300.0).unwrap();
    assert_eq!(reference_kpa(drive.on(1.0, &FINE)), 241.3);
}

#[test]
fn a_reset_that_ends_early_counts_as_far_as_it_went() {
    let warm = Reported { kpa: [256.3; 4], ..FINE };
    let after = |seconds: f64| {
        let mut drive = Drive::new();
        drive.monitor.begin_calibration(1200.0).unwrap();
        drive.on(seconds, &warm);
        drive.monitor.end_calibration();
        reference_kpa(drive.on(1.0, &warm))
    };
    // Within its last quarter, and before that.
    assert!((after(1000.0) - 256.3).abs() < 1e-6);
    assert_eq!(after(800.0), 241.3);
}

#[test]
fn a_reset_moves_the_reference_within_bounds_and_only_with_information() {
    let after = |config: MonitorConfig<f64>, said: Reported| {
        let mut drive = Drive::with(config);
        drive.monitor.begin_calibration(600.0).unwrap();
        reference_kpa(drive.on(601.0, &said))
    };
    let r141 = || MonitorConfig::new(&car());
    let at = |kpa: f64| Reported { kpa: [kpa; 4], ..FINE };
    assert!((after(r141(), at(290.0)) - 1.08 * 241.3).abs() < 1e-6);
    assert!((after(r141(), at(200.0)) - 0.97 * 241.3).abs() < 1e-6);
    assert_eq!(after(r141(), Reported { gate: 0.0, ..at(260.0) }), 241.3);
    assert_eq!(after(MonitorConfig { limits: Regulation::Fmvss138.into(), ..r141() }, at(260.0)), 241.3);
    // Read with a speed that is not known, the tire is taken for a cold one: no more than the placard's.
    assert_eq!(after(r141(), Reported { speed_m_s: f64::NAN, ..at(260.0) }), 241.3);
    for seconds in [0.0, -1.0, f64::NAN] {
        assert_eq!(Drive::new().monitor.begin_calibration(seconds).unwrap_err().name, "calibrate_s");
    }
}

#[test]
fn what_a_reset_changes_is_no_leak() {
    // A neighbor of a low tire, read too high until all are filled and a reset says so.
    let before = Reported { sd: 2.0, ..low(264.0) };
    let after = Reported { sd: 2.0, ..low(238.0) };
    let mut drive = Drive::new();
    drive.on(60.0, &before);
    drive.monitor.begin_calibration(60.0).unwrap();
    assert_eq!(drive.until(180.0, &after, |report| report.alerts().next().is_some()), None);
    // Without a reset it is unknown why it lost a tenth.
    let mut drive = Drive::new();
    drive.on(60.0, &before);
    assert!(drive.until(60.0, &after, |report| report.alerts().next().is_some()).is_some());
    // What comes down to what it should have was read too high.
    let mut drive = Drive::new();
    drive.on(60.0, &before);
    assert_eq!(
        drive.until(60.0, &Reported { sd: 2.0, ..low(242.0) }, |report| report.alerts().next().is_some()),
        None
    );
}
