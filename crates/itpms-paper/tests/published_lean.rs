//! The published filter in closed form against the dense one it is derived from (`docs/math/lean-aekf-ui.md`): step by step in `f64`, over
//! minutes in `f32`, and on input that no sensor should give. Against the numpy transcription: `tests/published_transcription.rs`.

use itpms_core::Real;
use itpms_core::model::{CornerSample, ParameterError, QuarterCar};
use itpms_paper::{
    AekfUi, AekfUiLean, CorrectionInput, FactorTiming, FilterConfig, Forgetting, GradientDescent, LeanError,
    LeanRecord, StepRecord, StepStatus,
};
use nalgebra::{Matrix5, Vector2, Vector5};

use crate::common::quarter_plant::{Drive, Random, drive, fig_6_kpa};

/// Uncertain of the stiffness, sure of the motion: the factor acts, the stiffness moves, and rounding grows little
/// (`tests/published_transcription.rs`).
fn tame<T: Real>() -> FilterConfig<T> {
    FilterConfig {
        initial_variance: Vector5::new(1e-4, 1e-2, 1e-4, 1e-2, 1e7).map(T::lit),
        measurement_variance: Vector2::repeat(T::lit(0.2)),
        ..FilterConfig::paper_simulation()
    }
}

fn lean<T: Real>(config: FilterConfig<T>) -> AekfUiLean<T> {
    AekfUiLean::new(QuarterCar::paper_table_2(), config).unwrap()
}

fn dense(config: FilterConfig<f64>) -> AekfUi<f64> {
    AekfUi::new(QuarterCar::paper_table_2(), config).unwrap()
}

/// Names of the compared quantities, in the order of [`of_dense`] and [`of_lean`].
const NAMES: [&str; 17] = [
    "x_b", "v_b", "x_w", "v_w", "k_t", "P_11", "P_22", "P_33", "P_44", "P_55", "road", "S", "z_b", "z_w",
    "tr C_0", "lambda", "nis",
];

fn listed<T: Real>(x: &Vector5<T>, p: &Vector5<T>, others: [T; 7]) -> [f64; 17] {
    let all: Vec<f64> = x.iter().chain(p).chain(&others).map(|value| value.to_f64()).collect();
    all.try_into().unwrap()
}

fn of_dense(r: &StepRecord<f64>) -> [f64; 17] {
    let (z, c_0) = (r.residual_m_s2, r.measured_covariance.trace());
    let others = [r.road_m, r.road_variance_m2, z[0], z[1], c_0, r.forgetting, r.nis];
    listed(&r.state, &r.covariance.diagonal(), others)
}

fn of_lean<T: Real>(filter: &AekfUiLean<T>, r: &LeanRecord<T>) -> [f64; 17] {
    let (x, p, z) = (filter.state(), filter.covariance().diagonal(), r.residual_m_s2);
    assert_eq!((r.stiffness_n_per_m, r.stiffness_variance_n2_per_m2), (x[4], p[4]));
    listed(&x, &p, [r.road_m, r.road_variance_m2, z[0], z[1], r.measured_trace, r.forgetting, r.nis()])
}

/// Largest difference of every quantity over a drive, relative to the largest value that it takes in the dense filter,
/// and the largest factor.
fn differences<T: Real>(
    config: FilterConfig<f64>,
    lean_config: FilterConfig<T>,
    drive: &Drive,
) -> ([f64; 17], f64) {
    let (mut reference, mut filter) = (dense(config), lean(lean_config));
    let (mut worst, mut size, mut factor) = ([0.0f64; 17], [f64::MIN_POSITIVE; 17], 1.0f64);
    for (k, sample) in drive.samples.iter().enumerate() {
        let expected = reference.step(drive.dt_s, sample);
        let found = filter.step(
            T::lit(drive.dt_s),
            &CornerSample {
                body_accel_m_s2: T::lit(sample.body_accel_m_s2),
                wheel_accel_m_s2: T::lit(sample.wheel_accel_m_s2),
            },
        );
        assert_eq!((expected.status, found.status), (StepStatus::Updated, StepStatus::Updated), "step {k}");
        let (expected, found) = (of_dense(&expected), of_lean(&filter, &found));
        for i in 0..17 {
            worst[i] = worst[i].max((found[i] - expected[i]).abs());
            size[i] = size[i].max(expected[i].abs());
        }
        factor = factor.max(expected[15]);
    }
    (std::array::from_fn(|i| worst[i] / size[i]), factor)
}

fn agree(name: &str, (worst, factor): ([f64; 17], f64), tolerance: f64) {
    let listed: Vec<String> =
        NAMES.iter().zip(worst).map(|(name, worst)| format!("{name} {worst:.0e}")).collect();
    println!("{name}, factor to {factor:.2}: {}", listed.join(", "));
    assert!(worst.iter().all(|worst| *worst <= tolerance), "{name}: {}", listed.join(", "));
}

#[test]
fn in_f64_every_step_is_the_dense_filters() {
    let drive = drive(3, 10.0, 500.0, 0.3, fig_6_kpa);
    for forgetting in [Forgetting::None, Forgetting::OneStep] {
        for timing in [FactorTiming::Previous, FactorTiming::Same] {
            let config = tame().with_forgetting(forgetting).with_factor_timing(timing);
            let found = differences(config, config, &drive);
            agree(&format!("{forgetting:?}, {timing:?}"), found, 1e-9);
        }
    }
}

#[test]
fn in_f32_it_follows_the_dense_f64_for_minutes() {
    let (quiet, noisy) = (drive(3, 180.0, 500.0, 0.05, fig_6_kpa), drive(3, 10.0, 500.0, 0.3, fig_6_kpa));
    for (name, config, lean_config, drive) in [
        ("simulation", FilterConfig::paper_simulation(), FilterConfig::<f32>::paper_simulation(), &quiet),
        ("test bed", FilterConfig::paper_bench(), FilterConfig::paper_bench(), &quiet),
        ("tame", tame(), tame(), &quiet),
        ("tame, noisy", tame(), tame(), &noisy),
    ] {
        let found = differences(config, lean_config, drive);
        // The residual of the body is k_s/m_b = 121/s² times a difference of displacements that have drifted to metres,
        // where f32 resolves a tenth of a micrometre at best: seen 6e-3 of the largest residual, elsewhere 2e-3.
        agree(name, found, 1e-2);
        assert!((0..12).chain([14, 15]).all(|i| found.0[i] <= 3e-3), "{name}");
        // Where the factor acts, it acts in both.
        assert_eq!(found.1 > 1.2, name == "tame, noisy", "factor {}", found.1);
    }
}

#[test]
fn where_the_published_filter_diverges_so_does_the_closed_form() {
    let drive = drive(3, 5.0, 1000.0, 1.0, fig_6_kpa);
    let (mut reference, mut filter) =
        (dense(FilterConfig::paper_simulation()), lean(FilterConfig::paper_simulation()));
    let mut held = None;
    for sample in &drive.samples {
        let before = filter.state();
        let (expected, found) = (reference.step(drive.dt_s, sample), filter.step(drive.dt_s, sample));
        assert_eq!(found.is_diverged(), expected.is_diverged());
        if found.is_diverged() {
            let held = *held.get_or_insert(before);
            assert_eq!((filter.state(), found.status), (held, filter.step(drive.dt_s, sample).status));
            assert!(found.residual_m_s2.iter().all(|z| z.is_nan()));
        }
    }
    assert!(held.is_some());
}

#[test]
fn a_missing_sample_is_predicted_over_and_a_bad_time_step_ignored_as_by_the_dense_filter() {
    let (mut reference, mut filter) = (dense(tame()), lean(tame()));
    let good = CornerSample { body_accel_m_s2: 0.1, wheel_accel_m_s2: -0.4 };
    let no_body = CornerSample { body_accel_m_s2: f64::NEG_INFINITY, ..good };
    let no_wheel = CornerSample { wheel_accel_m_s2: f64::NAN, ..good };
    let steps = [
        (1e-3, good, StepStatus::Updated),
        (0.0, good, StepStatus::Ignored),
        (-1.0, good, StepStatus::Ignored),
        (f64::NAN, good, StepStatus::Ignored),
        (f64::INFINITY, good, StepStatus::Ignored),
        (1e-3, no_wheel, StepStatus::PredictedOnly),
        (1e-3, no_body, StepStatus::PredictedOnly),
        (1e-3, good, StepStatus::Updated),
    ];
    for (dt_s, sample, status) in steps {
        let (expected, found) = (reference.step(dt_s, &sample), filter.step(dt_s, &sample));
        assert_eq!((expected.status, found.status), (status, status));
        assert_eq!(found.residual_m_s2.x.is_nan(), status != StepStatus::Updated);
        // A few steps from a diagonal covariance: both carry some 1e-13.
        let scale: Vector5<f64> = expected.covariance.diagonal().map(f64::sqrt);
        for i in 0..5 {
            assert!((filter.state()[i] - expected.state[i]).abs() < 1e-9 * scale[i], "{status:?}, state {i}");
        }
        let relative = Matrix5::from_fn(|i, j| {
            (filter.covariance()[(i, j)] - expected.covariance[(i, j)]) / (scale[i] * scale[j])
        });
        assert!(relative.amax() < 1e-9, "{status:?}: {relative}");
        assert!((found.road_m - expected.road_m).abs() < 1e-12);
    }
}

/// Any bits, or a sensible number, or a number too large for its square.
fn absurd(random: &mut Random) -> f64 {
    match (random.uniform() * 8.0) as u32 {
        0 => f64::from_bits((random.uniform() * 2f64.powi(64)) as u64),
        1 => 1e30 * random.normal(),
        2 => f64::NAN,
        3 => f64::INFINITY,
        _ => random.normal(),
    }
}

fn holds_under_absurd_input<T: Real>() {
    let mut random = Random::new(17);
    let (mut updated, mut diverged) = (0, 0);
    for _ in 0..300 {
        let mut filter = lean(FilterConfig::<T>::paper_simulation());
        for _ in 0..100 {
            let dt_s = T::lit(if random.uniform() < 0.9 { 2e-3 } else { absurd(&mut random) });
            let sample = CornerSample {
                body_accel_m_s2: T::lit(absurd(&mut random)),
                wheel_accel_m_s2: T::lit(absurd(&mut random)),
            };
            let record = filter.step(dt_s, &sample);
            updated += usize::from(record.status == StepStatus::Updated);
            diverged += usize::from(record.is_diverged());
            // What it holds is finite and still a car, whatever came in.
            assert!(filter.state().iter().chain(filter.covariance().iter()).all(|value| value.is_finite()));
            assert!(filter.covariance().diagonal().iter().all(|variance| *variance >= T::zero()));
            assert!(record.stiffness_n_per_m > T::zero() && record.stiffness_n_per_m < T::lit(3e7));
            assert!(record.road_m.abs() < T::lit(1e3) && record.forgetting >= T::one());
            // Whatever it measured is finite, whatever it did not is not a number.
            let z = record.residual_m_s2;
            assert!(z.iter().all(|z| z.is_finite() == (record.status == StepStatus::Updated)));
        }
    }
    assert!(updated > 300 && diverged > 300, "{updated} updated, {diverged} diverged");
}

#[test]
fn absurd_input_is_never_believed() {
    holds_under_absurd_input::<f64>();
    holds_under_absurd_input::<f32>();
}

#[test]
fn readings_without_a_closed_form_are_refused() {
    let build = |config: FilterConfig<f64>| AekfUiLean::new(QuarterCar::paper_table_2(), config).map(|_| ());
    assert_eq!(build(tame()), Ok(()));
    assert_eq!(build(tame().with_correction_input(CorrectionInput::Previous)), Err(LeanError::PreviousInput));
    let iterative = Forgetting::Iterative(GradientDescent::default());
    assert_eq!(build(tame().with_forgetting(iterative)), Err(LeanError::IterativeForgetting));
    let error = build(tame().with_initial_stiffness(-1.0));
    assert!(matches!(
        error,
        Err(LeanError::Parameter(ParameterError { name: "initial stiffness in N/m", .. }))
    ));
}
