//! Whole drives, through the public face.

use std::f64::consts::TAU;

use itpms_core::model::{Corner, PressureMap};
use itpms_sim::road::{Pothole, RoadClass, RoadSpec, Tracks};
use itpms_sim::scenario::{CornerSpec, Scenario};
use itpms_sim::sensor::SensorSpec;
use itpms_sim::simulation::{CornerRow, SimRow, Simulation};
use itpms_sim::time_profile::{Pressure, Speed};

use crate::drive::drive;
use crate::road::welch;

fn paper_drop() -> Scenario {
    Scenario::builtin("paper-drop").unwrap()
}

fn short(duration_s: f64) -> Scenario {
    Scenario { duration_s, ..paper_drop() }
}

fn fl(row: &SimRow) -> CornerRow {
    row.corners[Corner::FrontLeft.index()].unwrap()
}

#[test]
fn the_paper_scenarios_are_those_of_the_contract() {
    let map = PressureMap::<f64>::paper_eq_5();
    for (name, times_and_pressures) in [
        ("paper-drop", [(0.0, 241.3), (20.0, 241.3), (21.25, 189.6), (22.5, 137.9), (39.9, 137.9)]),
        ("paper-deep-drop", [(0.0, 241.3), (20.0, 241.3), (21.25, 141.35), (22.5, 41.4), (39.9, 41.4)]),
        ("paper-drop-recover", [(15.0, 241.3), (17.5, 138.0), (22.5, 166.5), (27.5, 195.0), (39.9, 195.0)]),
    ] {
        let scenario = Scenario::builtin(name).unwrap();
        let rows = drive(&scenario, 1);
        assert_eq!(rows.len(), 20_000);
        for (t, kpa) in times_and_pressures {
            let row = rows[(t * 500.0f64).round() as usize];
            assert!((row.time_s - t).abs() < 1e-12 && (row.speed_m_s - 20.0 / 3.6).abs() < 1e-12);
            assert!((fl(&row).pressure_kpa - kpa).abs() < 1e-9, "{name} at {t} s");
            assert!((fl(&row).stiffness_n_per_m - map.stiffness_n_per_m(kpa)).abs() < 1e-6);
        }
        let configured = scenario.corner_config(Corner::FrontLeft).unwrap();
        assert!((configured.initial_stiffness_n_per_m() - 220_000.0).abs() < 1e-6);
        assert_eq!(configured.accel_noise_m_s2, Some(0.05));
        assert_eq!(configured.quarter_car, itpms_core::model::QuarterCar::paper_table_2());
        assert_eq!(configured.placard_kpa, 241.3);
    }
}

#[test]
fn a_seed_is_a_drive() {
    let scenario = short(2.0);
    let first = drive(&scenario, 7);
    assert_eq!(first, drive(&scenario, 7));
    assert!(first.iter().zip(drive(&scenario, 8)).all(|(a, b)| fl(a).road_m != fl(&b).road_m));
}

#[test]
fn road_noise_and_clock_do_not_disturb_each_other() {
    let base = short(2.0);
    let quiet = Scenario { sensor: SensorSpec::with_noise(0.0), ..base.clone() };
    let loud = Scenario { sensor: SensorSpec::with_noise(0.3), ..base.clone() };
    let (base, quiet, loud) = (drive(&base, 3), drive(&quiet, 3), drive(&loud, 3));
    for ((b, q), l) in base.iter().zip(&quiet).zip(&loud) {
        let (b, q, l) = (fl(b), fl(q), fl(l));
        assert_eq!(b.road_m, l.road_m);
        // The same noise, six times as loud.
        let (small, large) =
            (b.wheel_accel_m_s2 - q.wheel_accel_m_s2, l.wheel_accel_m_s2 - q.wheel_accel_m_s2);
        assert!((large - 6.0 * small).abs() < 1e-9);
    }
}

#[test]
fn the_log_does_not_depend_on_the_rate_it_is_taken_at() {
    // The anti-alias corner is a share of the rate; at the same absolute corner and without noise 250, 500 and
    // 1000 Hz agree where they coincide. The plant's grid is 4 or 8 kHz: the digital filters differ slightly.
    let at = |rate_hz: f64| {
        let mut s = Scenario { rate_hz, sensor: SensorSpec::with_noise(0.0), ..short(3.0) };
        s.antialias.corner = 75.0 / rate_hz;
        drive(&s, 5)
    };
    let (slow, usual, fast) = (at(250.0), at(500.0), at(1000.0));
    for (i, row) in slow.iter().enumerate() {
        let (a, b, c) = (fl(row), fl(&usual[2 * i]), fl(&fast[4 * i]));
        assert_eq!(a.road_m, b.road_m);
        assert!((a.wheel_accel_m_s2 - b.wheel_accel_m_s2).abs() < 1e-9);
        // Accelerations have an rms of about 1 m/s².
        assert!((a.wheel_accel_m_s2 - c.wheel_accel_m_s2).abs() < 0.01);
    }
}

#[test]
fn a_jittered_sample_is_taken_when_it_says() {
    let quiet = Scenario { sensor: SensorSpec::with_noise(0.0), ..short(4.0) };
    let mut jittered = quiet.clone();
    jittered.clock.jitter = 0.3;
    // A log at 4 kHz with the same filter tells what the signal was at any time.
    let mut fine = Scenario { rate_hz: 4000.0, ..quiet.clone() };
    fine.antialias.corner = 150.0 / 4000.0;
    let fine = drive(&fine, 2);
    let rows = drive(&jittered, 2);
    let (mut largest, mut square_if_ignored) = (0.0f64, 0.0);
    for (i, row) in rows.iter().enumerate().take(1990).skip(10) {
        let late = row.time_s * 500.0 - i as f64;
        largest = largest.max(late.abs());
        let at = |t: f64| {
            let place = t * 4000.0;
            let (j, f) = (place as usize, place.fract());
            fl(&fine[j]).wheel_accel_m_s2 * (1.0 - f) + fl(&fine[j + 1]).wheel_accel_m_s2 * f
        };
        // Linear interpolation at 4 kHz is off by (2π 150/4000)²/8 = 0.7 % of the highest waves that pass, and the
        // fine grid of the 4 kHz log is 32 kHz: its filter differs by as much.
        assert!((fl(row).wheel_accel_m_s2 - at(row.time_s)).abs() < 0.02, "row {i}");
        square_if_ignored += (fl(row).wheel_accel_m_s2 - at(i as f64 / 500.0)).powi(2) / 1980.0;
        assert!((row.distance_m - row.time_s * 20.0 / 3.6).abs() < 1e-9);
    }
    assert!(largest <= 0.3 && largest > 0.29);
    // Taken at the nominal times instead, the error would be much larger than any of the above.
    assert!(square_if_ignored.sqrt() > 0.02, "{}", square_if_ignored.sqrt());
    assert!(rows.windows(2).all(|w| w[1].time_s > w[0].time_s) && rows[0].time_s >= 0.0);
}

#[test]
fn a_log_starts_in_motion() {
    // Mean square over the first and the last ten seconds of constant pressure, 24 seeds: no start-up transient. The
    // accelerations' bandwidth of some 10 Hz gives 24 * 10 s * 10 Hz = 2400 degrees of freedom each: sd 3 %.
    let mut power = [[0.0; 2]; 2];
    for seed in 0..24 {
        for row in drive(&short(20.0), seed) {
            let part = usize::from(row.time_s >= 10.0);
            power[part][0] += fl(&row).body_accel_m_s2.powi(2);
            power[part][1] += fl(&row).wheel_accel_m_s2.powi(2);
        }
    }
    for (first, last) in power[0].iter().zip(power[1]) {
        assert!((first / last - 1.0).abs() < 0.12, "{power:?}");
    }
}

/// `|transfer|²` from road height to body and wheel acceleration at `f` Hz (eq. 1, Laplace transformed, solved by hand).
fn power_transfer(f: f64, k_t: f64) -> [f64; 2] {
    let (m_b, m_w, c_s, k_s) = (240.8, 56.9, 925.8, 29_114.0);
    let w = TAU * f;
    // With strut z = k_s + i w c_s: body (z - m_b w²) x_b = z x_w and wheel (z + k_t - m_w w²) x_w - z x_b = k_t x_r,
    // so x_w / x_r = k_t (z - m_b w²) / D and x_b / x_r = k_t z / D with
    // D = (z - m_b w²)(z + k_t - m_w w²) - z² = z (k_t - (m_b + m_w) w²) - m_b w² (k_t - m_w w²).
    let (z_re, z_im) = (k_s, w * c_s);
    let a = k_t - (m_b + m_w) * w * w;
    let determinant = (z_re * a - m_b * w * w * (k_t - m_w * w * w)).powi(2) + (z_im * a).powi(2);
    let gain = (w * w * k_t).powi(2) / determinant;
    [gain * (z_re * z_re + z_im * z_im), gain * ((z_re - m_b * w * w).powi(2) + z_im * z_im)]
}

/// Of both accelerations, in segments of `n` samples.
fn spectra(rows: &[SimRow], rate_hz: f64, n: usize) -> [Vec<f64>; 2] {
    [0, 1].map(|sensor| {
        let signal = |r: &SimRow| if sensor == 0 { fl(r).body_accel_m_s2 } else { fl(r).wheel_accel_m_s2 };
        welch(&rows.iter().map(signal).collect::<Vec<_>>(), n, 1.0 / rate_hz)
    })
}

#[test]
fn spectra_of_the_log_are_road_times_car_times_filter_plus_noise() {
    let mut s = short(400.0);
    s.corner.fl = Some(CornerSpec::paper(Pressure::ConstantKpa(200.0)));
    let (k_t, v, n) = (713.91 * 200.0 + 60_880.0, 20.0 / 3.6, 2048);
    let measured = spectra(&drive(&s, 21), 500.0, n);
    let expected = |sensor: usize, f: f64| {
        let road = 16e-6 * (f / v / 0.1f64).powf(-2.14) / v;
        let ratio = (TAU * f / 8000.0).tan() / (TAU * 150.0 / 8000.0).tan();
        road * power_transfer(f, k_t)[sensor] / (1.0 + ratio.powi(8)) + 2.0 * 0.05f64.powi(2) / 500.0
    };
    // Bands in Hz; a band of b Hz over 400 s has about 400 b degrees of freedom: the sprung mode's band 4 %, the
    // others under 2.5 %; four standard deviations.
    for (from, to, tolerance) in [
        (0.75, 2.5, 0.16),
        (2.5, 7.0, 0.1),
        (7.0, 9.0, 0.15),
        (9.0, 11.0, 0.15),
        (11.0, 20.0, 0.08),
        (20.0, 60.0, 0.04),
        (60.0, 240.0, 0.02),
    ] {
        for (sensor, spectrum) in measured.iter().enumerate() {
            let bins = || {
                (1..n / 2).map(|k| (k, k as f64 * 500.0 / n as f64)).filter(|(_, f)| (from..to).contains(f))
            };
            let ratio = bins().map(|(k, _)| spectrum[k]).sum::<f64>()
                / bins().map(|(_, f)| expected(sensor, f)).sum::<f64>();
            assert!((ratio - 1.0).abs() < tolerance, "sensor {sensor}, {from} to {to} Hz: {ratio}");
        }
    }
}

#[test]
fn a_deviation_moves_the_car_but_not_what_the_estimator_is_configured_with() {
    let configured = short(4.0);
    let (mut deviating, mut heavy) = (configured.clone(), configured.clone());
    deviating.corner.fl.as_mut().unwrap().truth.sprung_mass_factor = 1.08;
    heavy.corner.fl.as_mut().unwrap().sprung_mass_kg *= 1.08;
    let config = |s: &Scenario| s.corner_config(Corner::FrontLeft).unwrap();
    assert_eq!(config(&configured), config(&deviating));
    assert_ne!(config(&configured), config(&heavy));
    assert_eq!(drive(&deviating, 1), drive(&heavy, 1));
    assert_ne!(drive(&deviating, 1), drive(&configured, 1));
}

#[test]
fn a_stop_is_silent_and_its_distance_stands_still() {
    let mut s = short(12.0);
    s.speed = Speed::PointsSKmH(vec![[0.0, 36.0], [2.0, 36.0], [4.0, 0.0], [12.0, 0.0]]);
    s.sensor = SensorSpec::with_noise(0.0);
    let rows = drive(&s, 1);
    // 20 m at 10 m/s, then 10 m while braking.
    assert!((rows[5999].distance_m - 30.0).abs() < 1e-9 && rows[5999].speed_m_s == 0.0);
    // 8 s after the stop the body's swing has decayed by exp(-15) from some 0.5 m/s².
    assert!(fl(&rows[5999]).body_accel_m_s2.abs() < 1e-5 && fl(&rows[5999]).wheel_accel_m_s2.abs() < 1e-5);
}

#[test]
fn rear_wheels_follow_in_the_front_wheels_track() {
    let mut s = short(6.0);
    s.corner.rl = Some(CornerSpec::paper(Pressure::ConstantKpa(220.0)));
    s.corner.fr = Some(CornerSpec::paper(Pressure::ConstantKpa(230.0)));
    s.wheelbase_m = 2.5;
    s.speed = Speed::ConstantKmH(18.0);
    let rows = drive(&s, 1);
    for i in (0..2500).step_by(50) {
        // 2.5 m at 5 m/s is 0.5 s: 250 rows.
        let (front, rear) = (fl(&rows[i]), rows[i + 250].corners[Corner::RearLeft.index()].unwrap());
        assert!((front.road_m - rear.road_m).abs() < 1e-9);
        let right = rows[i].corners[Corner::FrontRight.index()].unwrap();
        assert!(right.road_m != front.road_m && right.pressure_kpa == 230.0);
        assert!(rows[i].corners[Corner::RearRight.index()].is_none());
    }
    // Adding corners leaves the first one as it was.
    let mut alone = s.clone();
    (alone.corner.rl, alone.corner.fr) = (None, None);
    assert!(rows.iter().zip(drive(&alone, 1)).all(|(a, b)| fl(a) == fl(&b)));
    let sample = rows[0].car_sample();
    assert_eq!(sample.corners[0].unwrap().body_accel_m_s2, fl(&rows[0]).body_accel_m_s2);
}

#[test]
fn rear_wheels_of_quarter_cars_run_beside_the_front_ones_track_where_told() {
    use itpms_sim::road::{Line, Road, Side};
    let mut s = short(4.0);
    s.corner.rl = Some(CornerSpec::paper(Pressure::ConstantKpa(220.0)));
    s.rear_offset_m = -0.02;
    s.speed = Speed::ConstantKmH(36.0);
    let (track, beside) = (Line::alone(Side::Left), Line::alone(Side::Left).beside(0.02));
    let [mut front, mut rear] = [track, beside].map(|line| Road::along(&s.road, line, 1, 0.005).unwrap());
    for row in drive(&s, 1) {
        let truth = row.corners[Corner::RearLeft.index()].unwrap();
        assert!((fl(&row).road_m - front.height_m(row.distance_m)).abs() < 1e-12);
        assert!((truth.road_m - rear.height_m(row.distance_m - s.wheelbase_m)).abs() < 1e-12);
    }
    s.rear_offset_m = 2.0;
    assert!(s.validate().unwrap_err().to_string().contains("rear_offset_m is 2, expected"));
    let car = Scenario { rear_offset_m: 0.02, ..Scenario::builtin("drive-puncture").unwrap() };
    let error = car.validate().unwrap_err().to_string();
    assert!(error.contains("rear_offset_m is 0.02 beside a [car], expected car.rear_offset_m"), "{error}");
}

#[test]
fn the_tire_feels_the_road_averaged_and_the_truth_says_both() {
    let mut s = short(6.0);
    let hole = Pothole { at_m: 15.0, length_m: 0.4, depth_m: 0.03, edge_m: 0.05, tracks: Tracks::Both };
    s.road = RoadSpec { pothole: vec![hole], ..RoadSpec::default() };
    s.sensor = SensorSpec::with_noise(0.0);
    let point = drive(&s, 1);
    assert!(point.iter().all(|r| fl(r).road_m == fl(r).contact_road_m));
    assert!(point.iter().any(|r| fl(r).road_m < -0.0299));
    assert!(point.iter().take_while(|r| r.distance_m < 14.9).all(|r| fl(r).wheel_accel_m_s2.abs() < 1e-9));
    s.road.contact_length_m = 0.2;
    let averaged = drive(&s, 1);
    assert!(averaged.iter().zip(&point).all(|(a, p)| fl(a).road_m == fl(p).road_m));
    let peak = |rows: &[SimRow]| rows.iter().map(|r| fl(r).wheel_accel_m_s2.abs()).fold(0.0, f64::max);
    assert!(peak(&averaged) < 0.8 * peak(&point), "{} {}", peak(&averaged), peak(&point));
}

#[test]
fn lost_samples_are_nan_and_nothing_else_is() {
    let mut s = short(4.0);
    s.corner.fl.as_mut().unwrap().wheel_sensor =
        Some(SensorSpec { dropout_fraction: 0.2, ..SensorSpec::default() });
    let rows = drive(&s, 1);
    let lost = rows.iter().filter(|r| fl(r).wheel_accel_m_s2.is_nan()).count();
    // 2000 samples, sd sqrt(2000 0.2 0.8) = 18.
    assert!((lost as f64 - 400.0).abs() < 80.0, "{lost}");
    assert!(rows.iter().all(|r| fl(r).body_accel_m_s2.is_finite() && fl(r).pressure_kpa == 241.3));
}

#[test]
fn rougher_roads_shake_in_proportion() {
    // A class is a factor of four in power: exactly twice the acceleration on the same seed, the plant being linear.
    let class = |class| {
        let mut s = short(2.0);
        s.road = RoadSpec::iso8608(class, 2.14);
        s.sensor = SensorSpec::with_noise(0.0);
        drive(&s, 1)
    };
    for (a, b) in class(RoadClass::A).iter().zip(class(RoadClass::B)) {
        assert!((2.0 * fl(a).wheel_accel_m_s2 - fl(&b).wheel_accel_m_s2).abs() < 1e-9);
    }
}

#[test]
fn every_rate_of_the_contract_runs() {
    for rate_hz in [100.0, 128.0, 333.0, 500.0, 1000.0, 2000.0] {
        let s = Scenario { rate_hz, ..short(1.0) };
        let simulation = Simulation::new(&s, 1).unwrap();
        assert_eq!(simulation.len(), rate_hz as usize);
        assert!(simulation.map(|r| fl(&r)).all(|c| c.body_accel_m_s2.is_finite() && c.road_m.is_finite()));
    }
}
