//! The monitor goes by the numbers that are set, and refuses those that cannot be meant.

use itpms_core::conditioning::SampleClock;
use itpms_core::model::{CarSample, CornerSample};
use itpms_core::monitor::{Monitor, MonitorConfig, Tuning};
use itpms_core::warning::Cause;

use super::reported::{Drive, FINE, RATE_HZ, Reported, car, estimate, low};

fn configured(set: impl Fn(&mut Tuning)) -> MonitorConfig<f64> {
    let mut config = MonitorConfig::new(&car());
    set(&mut config.tuning);
    config
}

#[test]
fn a_low_tire_is_reported_by_the_numbers_that_are_set() {
    let reads = Reported { sd: 2.0, ..low(0.8 * 241.3) };
    let is_reported =
        |set: fn(&mut Tuning)| Drive::with(configured(set)).on(4.0, &reads).alerts().next().is_some();
    assert!(is_reported(|_| {}));
    assert!(!is_reported(|tuning| tuning.warning.low.set_s = 20.0));
    assert!(!is_reported(|tuning| tuning.decision.one_is_low = 1e-60));
}

/// When a fault of the front left wheel sensor, which begins after 10 s, is reported within a minute.
fn fault_reported_s(set: impl Fn(&mut Tuning), wheel_m_s2: fn(u32) -> f64) -> Option<f64> {
    let mut monitor = Monitor::new(&configured(set), RATE_HZ).unwrap();
    let mut clock = SampleClock::new(RATE_HZ).unwrap();
    (0..(70.0 * RATE_HZ) as u32).find_map(|step| {
        let (time_s, wiggle) = (f64::from(step) / RATE_HZ, 0.1 * f64::from(step % 7));
        let fine = CornerSample { body_accel_m_s2: wiggle, wheel_accel_m_s2: 2.0 * wiggle };
        let mut corners = [Some(fine); 4];
        if time_s >= 10.0 {
            corners[0] = Some(CornerSample { wheel_accel_m_s2: wheel_m_s2(step), ..fine });
        }
        let at = clock.take(time_s, 20.0);
        monitor.screen(&at, &CarSample { time_s, speed_m_s: 20.0, corners, wheel_speeds: None });
        monitor.judge(&at, &mut estimate(time_s, &FINE));
        let is_fault = monitor.report().alerts().any(|alert| matches!(alert.cause, Cause::Malfunction(_)));
        is_fault.then_some(time_s - 10.0)
    })
}

#[test]
fn a_fault_is_reported_by_the_numbers_that_are_set() {
    // Stuck: at once, and after ten seconds more.
    let at_once_s = fault_reported_s(|_| {}, |_| 0.3).unwrap();
    assert!(at_once_s < 2.0, "{at_once_s}");
    let later_s =
        fault_reported_s(|tuning| tuning.diagnosis.stuck.set_s = 10.0, |_| 0.3).unwrap() - at_once_s;
    assert!((9.0..10.1).contains(&later_s), "{later_s}");
    // A spike every two seconds: the third is too many, or the first, or none is.
    let spiky = |step: u32| 0.2 * f64::from(step % 7) + if step.is_multiple_of(40) { 60.0 } else { 0.0 };
    let spikes = |many| fault_reported_s(|tuning| tuning.diagnosis.many_spikes = many, spiky);
    let [first, third] = [spikes(0.5), fault_reported_s(|_| {}, spiky)].map(Option::unwrap);
    assert!(first < 2.0 && (4.0..8.0).contains(&third), "{first} {third}");
    assert_eq!(spikes(1e3), None);
}

#[test]
fn a_number_that_cannot_be_meant_is_refused() {
    let refused = |set: fn(&mut Tuning)| Monitor::new(&configured(set), RATE_HZ).unwrap_err().name;
    assert_eq!(refused(|tuning| tuning.decision.fine_sd = f64::NAN), "fine_sd");
    assert_eq!(refused(|tuning| tuning.diagnosis.cusum = -11.0), "cusum");
    assert_eq!(refused(|tuning| tuning.diagnosis.filled = f64::NAN), "filled");
    assert_eq!(refused(|tuning| tuning.diagnosis.crossed_ratio = 1.5), "crossed_ratio");
    assert_eq!(refused(|tuning| tuning.diagnosis.gain_usual_blocks = 0), "gain_usual_blocks");
    assert_eq!(refused(|tuning| tuning.diagnosis.swap.clear_s = f64::INFINITY), "swap");
}
