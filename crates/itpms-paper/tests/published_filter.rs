//! The finding about the published filters, as tests: two accelerations and an arbitrary road fix the tire's force,
//! not its stiffness. See `docs/math/ekf-ui.md`, section 4.

use crate::common::quarter_plant::{MB, MW, Random, drive, fig_6_kpa, pressure, rms, stiffness};
use itpms_core::model::{CornerSample, QuarterCar};
use itpms_paper::quarter_car::{self, state};
use itpms_paper::{
    AekfUi, CorrectionInput, FilterConfig, Forgetting, GradientDescent, StepRecord, StepStatus,
};
use nalgebra::Vector5;

const FORGETTINGS: [Forgetting<f64>; 2] = [Forgetting::None, Forgetting::OneStep];

fn filter(config: FilterConfig<f64>) -> AekfUi<f64> {
    AekfUi::new(QuarterCar::paper_table_2(), config).unwrap()
}

/// Runs a filter over the Fig. 7 scenario without noise, on a plant discretised exactly as the filter believes
/// (Euler, eq. 7-8), and hands each record to `see` with the time and the measurement.
fn without_noise(
    filter: &mut AekfUi<f64>,
    dt: f64,
    mut see: impl FnMut(f64, &CornerSample<f64>, &StepRecord<f64>),
) {
    let car = QuarterCar::<f64>::paper_table_2();
    let mut random = Random::new(1);
    // Class A, slope -2, 20 km/h, as in `common::quarter_plant::drive`.
    let road_step = (3.5e-5 / 2.0 * dt).sqrt();
    let (mut x, mut road) = (Vector5::zeros(), 0.0);
    for k in 0..(40.0 / dt) as usize {
        let t = k as f64 * dt;
        x[state::TIRE_STIFFNESS] = stiffness(fig_6_kpa(t));
        let y = quarter_car::output(&car, &x, road);
        let sample = CornerSample { body_accel_m_s2: y[0], wheel_accel_m_s2: y[1] };
        see(t, &sample, &filter.step(dt, &sample));
        x += quarter_car::derivative(&car, &x, road) * dt;
        road += road_step * random.normal();
    }
}

/// RMSE in kPa over the scenario, and the last stiffness in N/m.
fn rmse_without_noise(config: FilterConfig<f64>, dt: f64) -> (f64, f64) {
    let (mut errors, mut last) = (vec![], 0.0);
    without_noise(&mut filter(config), dt, |t, _, record| {
        last = record.stiffness_n_per_m();
        errors.push(pressure(last) - fig_6_kpa(t));
    });
    (rms(errors), last)
}

/// RMSE of never changing one's mind about the initial 220 000 N/m.
fn rmse_of_the_constant() -> f64 {
    rms((0..40_000).map(|k| pressure(220_000.0) - fig_6_kpa(f64::from(k) * 1e-3)))
}

#[test]
fn the_filter_leaves_the_stiffness_where_it_started() {
    let constant = rmse_of_the_constant();
    assert!((constant - 58.77).abs() < 0.01, "{constant}");
    let iterative = Forgetting::Iterative(GradientDescent::default());
    for dt in [2e-4, 1e-3, 2e-3] {
        for forgetting in FORGETTINGS.into_iter().chain([iterative]) {
            let config = FilterConfig::paper_simulation().with_forgetting(forgetting);
            let (rmse, last) = rmse_without_noise(config, dt);
            println!("u*_k, {forgetting:?}, dt {dt}: RMSE {rmse:.2} kPa, last {last:.1} N/m");
            // 1 %: the claim. What is seen is below 0.01 %.
            assert!((last / 220_000.0 - 1.0).abs() < 0.01);
            assert!((rmse - constant).abs() < 0.1);
        }
    }
}

#[test]
fn the_printed_reading_of_eq_17_is_no_better() {
    // With u*_{k-1} the correction reacts to the road's change over one step, which the filter takes for an error of its state. At a very
    // short step that is small and k_t stays; at 1 and 2 ms it drives k_t away, and not to the truth.
    for (dt, stays) in [(2e-4, true), (1e-3, false), (2e-3, false)] {
        for forgetting in FORGETTINGS {
            let config = FilterConfig::paper_simulation()
                .with_forgetting(forgetting)
                .with_correction_input(CorrectionInput::Previous);
            let (rmse, last) = rmse_without_noise(config, dt);
            println!("u*_k-1, {forgetting:?}, dt {dt}: RMSE {rmse:.2} kPa, last {last:.1} N/m");
            // No better than knowing nothing, to within the few per cent the wandering may gain by luck.
            assert!(rmse > 0.95 * rmse_of_the_constant());
            // Seen at 0.2 ms: 1.0 %.
            assert_eq!(stays, (last / 220_000.0 - 1.0).abs() < 0.02);
        }
    }
}

#[test]
fn every_stiffness_explains_the_accelerations_equally_well() {
    for start in [120_000.0, 220_000.0, 330_000.0] {
        let car = QuarterCar::<f64>::paper_table_2();
        let config =
            FilterConfig::paper_simulation().with_forgetting(Forgetting::None).with_initial_stiffness(start);
        let (mut unexplained, mut force_error, mut force) = (vec![], vec![], vec![]);
        without_noise(&mut filter(config), 1e-3, |t, y, record| {
            if t > 3.0 {
                let fit = quarter_car::output(&car, &record.state, record.road_m);
                unexplained.push((fit[0] - y.body_accel_m_s2).hypot(fit[1] - y.wheel_accel_m_s2));
                // Eq. (1) added up: the tire's force needs no stiffness.
                let tire_force = MB * y.body_accel_m_s2 + MW * y.wheel_accel_m_s2;
                let believed =
                    record.stiffness_n_per_m() * (record.road_m - record.state[state::WHEEL_POSITION]);
                force.push(tire_force);
                force_error.push(believed - tire_force);
            }
        });
        println!("start {start}: unexplained {:.1e} m/s²", rms(unexplained.iter().copied()));
        // Sensor noise would be 0.05 m/s²; the misfit left is the start's transient, a thousandth of that.
        assert!(rms(unexplained) < 1e-4);
        assert!(rms(force_error) < 1e-4 * rms(force));
    }
}

#[test]
fn with_sensor_noise_the_road_drifts_and_the_claimed_precision_is_wrong() {
    let drive = drive(3, 40.0, 1000.0, 0.05, fig_6_kpa);
    let mut filter = filter(FilterConfig::paper_simulation());
    let (mut errors, mut worst, mut largest_factor) = (vec![], 0.0f64, 0.0f64);
    for (sample, (p, road)) in drive.samples.iter().zip(drive.pressure_kpa.iter().zip(&drive.road_m)) {
        let record = filter.step(drive.dt_s, sample);
        assert_eq!(record.status, StepStatus::Updated);
        errors.push(pressure(record.stiffness_n_per_m()) - p);
        worst = worst.max((record.road_m - road).abs() / record.road_variance_m2.sqrt());
        largest_factor = largest_factor.max(record.forgetting);
    }
    println!(
        "RMSE {:.2} kPa, road off by {worst:.0} sd, largest factor {largest_factor}",
        rms(errors.iter().copied())
    );
    assert!((rms(errors) - rmse_of_the_constant()).abs() < 0.5);
    assert!(worst > 100.0);
    // The paper's R = 0.5 (m/s²)² is far above the residual: its factor never leaves 1.
    assert_eq!(largest_factor, 1.0);
}

#[test]
fn with_much_noise_forgetting_makes_it_diverge_and_it_says_so() {
    let drive = drive(3, 5.0, 1000.0, 1.0, fig_6_kpa);
    let mut filter = filter(FilterConfig::paper_simulation());
    let records: Vec<_> = drive.samples.iter().map(|sample| filter.step(drive.dt_s, sample)).collect();
    let first = records.iter().position(StepRecord::is_diverged).expect("diverges within 5 s");
    println!("diverged at {:.2} s: {:?}", first as f64 * drive.dt_s, records[first].status);
    // It holds the last good state, finite and unchanged, and keeps saying so.
    let held = records[first - 1].state;
    for record in &records[first..] {
        assert_eq!(record.status, records[first].status);
        assert_eq!(record.state, held);
    }
    // A reset is the way back, and is counted.
    filter.reset();
    assert_eq!(filter.resets(), 1);
    let record = filter.step(drive.dt_s, &drive.samples[0]);
    assert_eq!(record.status, StepStatus::Updated);
    assert!((record.stiffness_n_per_m() / 220_000.0 - 1.0).abs() < 0.01);
}

#[test]
fn without_forgetting_the_same_noise_leaves_the_stiffness_alone() {
    let drive = drive(3, 40.0, 1000.0, 1.0, fig_6_kpa);
    let mut filter = filter(FilterConfig::paper_simulation().with_forgetting(Forgetting::None));
    for sample in &drive.samples {
        let record = filter.step(drive.dt_s, sample);
        assert_eq!(record.status, StepStatus::Updated);
        assert!((record.stiffness_n_per_m() / 220_000.0 - 1.0).abs() < 0.01);
    }
}

#[test]
fn a_missing_sample_is_predicted_over_and_a_bad_time_step_ignored() {
    let mut filter = filter(FilterConfig::paper_simulation());
    let good = CornerSample { body_accel_m_s2: 0.1, wheel_accel_m_s2: -0.4 };
    let before = filter.step(1e-3, &good);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let record = filter.step(bad, &good);
        assert_eq!((record.status, record.state), (StepStatus::Ignored, before.state));
    }
    let missing = CornerSample { wheel_accel_m_s2: f64::NAN, ..good };
    let record = filter.step(1e-3, &missing);
    assert_eq!(record.status, StepStatus::PredictedOnly);
    assert!(record.residual_m_s2.iter().all(|z| z.is_nan()));
    // Euler: the wheel has moved by its own velocity.
    let moved = before.state[state::WHEEL_POSITION] + 1e-3 * before.state[state::WHEEL_VELOCITY];
    assert!((record.state[state::WHEEL_POSITION] - moved).abs() < 1e-15);
    assert_eq!(filter.step(1e-3, &good).status, StepStatus::Updated);
}
