//! The monitor of a single corner, in front of a real estimator: sensors that go wrong and come back.

use itpms_core::diagnosis::Malfunction;
use itpms_core::model::{CarConfig, CarSample, CornerConfig, CornerEstimate, CornerSample, Warning};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_core::warning::{Cause, MonitorReport};

use crate::common::ride::{Ride, Row};

fn watched(rows: &[Row], rate_hz: f64) -> Vec<(CornerEstimate<f64>, MonitorReport<f64>)> {
    let corners = [Some(CornerConfig::paper()), None, None, None];
    let config = CarConfig { corners, wheelbase_m: Some(2.7) };
    let mut car = MonitoredCar::new(&MonitorConfig::new(&config), rate_hz).unwrap();
    let feed = |row: &Row| {
        let corner = CornerSample { body_accel_m_s2: row.body, wheel_accel_m_s2: row.wheel };
        let corners = [Some(corner), None, None, None];
        let estimate = car.update(&CarSample {
            time_s: row.time_s,
            speed_m_s: row.speed_m_s,
            corners,
            wheel_speeds: None,
        });
        (estimate.corners[0].unwrap(), *car.report())
    };
    rows.iter().map(feed).collect()
}

#[test]
fn a_corner_by_itself_can_be_stuck_lost_spiky_and_swapped_and_comes_back() {
    type Spoil = fn(&mut Row, &Row, usize);
    let cases: [(&str, f64, Spoil); 4] = [
        ("stuck", 1.1, |row, first, _| row.wheel = first.wheel),
        ("dropout", 2.1, |row, _, _| row.body = f64::NAN),
        // One a second; the third within the count's ten seconds is too many.
        ("spikes", 4.1, |row, _, i| row.wheel += if i.is_multiple_of(500) { 60.0 } else { 0.0 }),
        ("swapped", 7.0, |row, _, _| core::mem::swap(&mut row.body, &mut row.wheel)),
    ];
    let ride = Ride { seconds: 60.0, ..Ride::new(5) };
    let per_s = ride.rate_hz as usize;
    let clean = ride.rows();
    assert!(watched(&clean, ride.rate_hz).iter().all(|(_, report)| report.alerts().next().is_none()));
    for (label, stated_s, spoil) in cases {
        let mut rows = clean.clone();
        let (from, to) = (15 * per_s, 25 * per_s);
        let first = rows[from];
        for (i, row) in rows[from..to].iter_mut().enumerate() {
            spoil(row, &first, i);
        }
        let out = watched(&rows, ride.rate_hz);
        let reported = |report: &MonitorReport<f64>| {
            report.alerts().any(
                |alert| matches!(&alert.cause, Cause::Malfunction::<f64>(malfunction) if malfunction.label() == label),
            )
        };
        let first_report = out.iter().position(|(_, report)| reported(report)).unwrap_or(usize::MAX);
        assert!(
            first_report >= from && rows[first_report].time_s <= 15.0 + stated_s,
            "{label} at {first_report}"
        );
        let shown = out[first_report..to].iter().filter(|(estimate, _)| estimate.validity.is_valid()).count();
        assert_eq!(shown, 0, "{label}");
        assert!(out[first_report..to].iter().all(|(estimate, _)| estimate.warning == Warning::Malfunction));
        let (last, report) = out.last().unwrap();
        assert!(last.validity.is_valid() && report.alerts().next().is_none(), "{label}: {last:?}");
        assert!((last.pressure_kpa - 230.0).abs() < 3.0 * last.pressure_sd_kpa, "{label}: {last:?}");
    }
}

#[test]
fn a_swap_is_called_what_it_is() {
    let ride = Ride { seconds: 30.0, ..Ride::new(6) };
    let mut rows = ride.rows();
    for row in &mut rows {
        core::mem::swap(&mut row.body, &mut row.wheel);
    }
    let (_, report) = watched(&rows, ride.rate_hz).pop().unwrap();
    let alert = report.alerts().next().unwrap();
    assert!(matches!(alert.cause, Cause::Malfunction(Malfunction::Swapped(..))), "{alert}");
    assert!(alert.to_string().contains("fl body sensor and fl wheel sensor are swapped"), "{alert}");
}
