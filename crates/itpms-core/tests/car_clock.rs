//! A car whose clock is set, or stamps a sample wrong: what was learned, a reset and what was reported go on as if it had not.

use std::sync::LazyLock;

use itpms_core::model::{CarEstimate, CarSample, Corner, VehicleCalibration};
use itpms_core::monitor::{MonitorConfig, MonitoredCar};
use itpms_core::warning::MonitorReport;

use crate::common::car_ride::{CarRide, RATE_HZ, config};

/// A reset is begun with the first sample and lasts so long.
const RESET_S: f64 = 12.0;

/// The front left tire loses 90 kPa in two seconds, after 30 s.
fn pressure_kpa(time_s: f64) -> [f64; 4] {
    [241.3 - 45.0 * (time_s - 30.0).clamp(0.0, 2.0), 241.3, 241.3, 241.3]
}

static ROWS: LazyLock<Vec<CarSample<f64>>> =
    LazyLock::new(|| CarRide { seconds: 50.0, pressure_kpa, ..CarRide::new(6) }.rows());

/// What is known and reported after every sample of a drive.
struct Driven {
    learned: VehicleCalibration<f64>,
    reported: Vec<(CarEstimate<f64>, MonitorReport<f64>)>,
}

impl Driven {
    fn with(stamp: impl Fn(usize, f64) -> f64) -> Self {
        let config = config::<f64>();
        let mut car = Box::new(MonitoredCar::new(&MonitorConfig::new(&config), RATE_HZ).unwrap());
        car.begin_calibration(RESET_S).unwrap();
        let reported = ROWS.iter().enumerate().map(|(k, row)| {
            let estimate = car.update(&CarSample { time_s: stamp(k, row.time_s), ..*row });
            (estimate, *car.report())
        });
        let reported = reported.collect();
        Self { learned: car.estimator().calibration().unwrap(), reported }
    }

    /// The sample after which the loss is warned of.
    fn warned(&self) -> usize {
        self.reported
            .iter()
            .position(|(_, report)| report.alerts_of(Corner::FrontLeft).next().is_some())
            .unwrap()
    }
}

fn at(time_s: f64) -> usize {
    (time_s * RATE_HZ) as usize
}

#[test]
fn a_clock_that_is_set_or_stamps_wrong_is_no_event() {
    let honest = Driven::with(|_, time_s| time_s);
    let set = |k: usize, from_s: f64, by_s: f64| if k < at(from_s) { 0.0 } else { by_s };
    let stray = |k: usize, from_s: f64, by_s: f64| if k == at(from_s) { by_s } else { 0.0 };
    type Stamp<'a> = &'a dyn Fn(usize) -> f64;
    let cases: [(&str, Stamp<'_>, [f64; 2]); 7] = [
        ("set back in the reset", &|k| set(k, 6.0, -1e6), [6.0, -1e6]),
        ("set back after it", &|k| set(k, 20.0, -20.0), [20.0, -20.0]),
        ("set back in the fall", &|k| set(k, 31.0, -3600.0), [31.0, -3600.0]),
        ("one stamp ahead in the reset", &|k| stray(k, 6.0, 1000.0), [6.0, 0.0]),
        ("one stamp ahead after it", &|k| stray(k, 20.0, 1000.0), [20.0, 0.0]),
        ("one stamp behind", &|k| stray(k, 20.0, -1000.0), [20.0, 0.0]),
        ("the first stamp ahead", &|k| stray(k, 0.0, 1e5), [0.0, 0.0]),
    ];
    for (name, by_s, [from_s, ends_by_s]) in cases {
        let drive = Driven::with(|k, time_s| time_s + by_s(k));
        // The reset ends and teaches the same, within what sixteen samples less can change.
        let (taught, learned) = (drive.learned, honest.learned);
        assert!(
            (taught.wheelbase.value - learned.wheelbase.value).abs() < 0.5 * learned.wheelbase.sd,
            "{name}: {taught:?} {learned:?}"
        );
        let mut worst = 0.0f64;
        for (k, ((estimate, _), (expected, _))) in
            drive.reported.iter().zip(&honest.reported).enumerate().skip(at(1.0))
        {
            assert_eq!(estimate.time_s, ROWS[k].time_s + by_s(k), "{name}");
            // Samples without a known time are lost, and lost samples are suspicious for a moment.
            let shortly_after = (at(from_s)..at(from_s + 4.0)).contains(&k);
            for (i, (one, other)) in estimate.corners.iter().zip(&expected.corners).enumerate() {
                let (Some(one), Some(other)) = (one, other) else { continue };
                // Frames that begin elsewhere end elsewhere: by less than a hop.
                let around = &honest.reported[k - at(0.06)..honest.reported.len().min(k + at(0.06))];
                let nearly = around
                    .iter()
                    .any(|(near, _)| near.corners[i].is_some_and(|near| near.validity == one.validity));
                let same = nearly || shortly_after && !one.validity.is_valid();
                assert!(one.time_s == estimate.time_s && same, "{name}: {one:?} {other:?}");
                // A frame earlier or later is much while a pressure falls.
                if !(at(30.0)..at(34.0)).contains(&k) {
                    worst = worst.max((one.pressure_kpa - other.pressure_kpa).abs() / other.pressure_sd_kpa);
                }
            }
        }
        let later = drive.warned() as f64 - honest.warned() as f64;
        println!("{name}: moved by {worst:.2} sd, warned {later} samples later");
        // A hole in the midst of the fall costs the frames around it: as long as a loss may take to be found.
        assert!(worst < 0.5 && later.abs() < 3.0 * RATE_HZ, "{name}: {worst} sd, {later}");
        // By the clock as it is now.
        let report = &drive.reported.last().unwrap().1;
        let alert = report.alerts_of(Corner::FrontLeft).next().unwrap();
        assert!((alert.since_s - ends_by_s - 31.0).abs() < 2.0, "{name}: {alert}");
        let wheel = report.wheels[0].unwrap();
        assert!((0.0..1.0).contains(&(report.time_s - wheel.informed_s)), "{name}: {}", wheel.informed_s);
    }
}

#[test]
fn a_warning_stands_while_the_clock_is_set() {
    let Driven { reported, .. } = Driven::with(|k, time_s| time_s - if k < at(42.0) { 0.0 } else { 500.0 });
    let standing = &reported[at(41.9)].1;
    assert!(standing.alerts_of(Corner::FrontLeft).next().is_some());
    let mut before = standing;
    for (_, report) in &reported[at(41.9)..] {
        assert!(report.changes_since(before).next().is_none(), "{report:?}");
        before = report;
    }
    let (old, new) = (standing.alerts().next().unwrap(), before.alerts().next().unwrap());
    assert!((old.since_s - 500.0 - new.since_s).abs() < 0.1, "{old} {new}");
}
