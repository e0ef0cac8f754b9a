//! What holds for the filters whatever they are fed.

use itpms_core::Real;
use itpms_core::model::{CornerConfig, CornerSample, QuarterCar};
use itpms_paper::{
    AekfUi, AekfUiInformed, CorrectionInput, FilterConfig, Forgetting, GradientDescent, InformedConfig,
    InformedRecord, InformedStatus, StepRecord, StepStatus,
};
use nalgebra::{Matrix6, SMatrix};
use proptest::prelude::*;

/// Largest asymmetry of a covariance, relative to the two standard deviations it belongs to.
fn asymmetry<const N: usize>(p: &SMatrix<f64, N, N>) -> f64 {
    let mut worst = 0.0f64;
    for i in 0..N {
        for j in 0..i {
            let scale = (p[(i, i)] * p[(j, j)]).abs().sqrt();
            let off = (p[(i, j)] - p[(j, i)]).abs();
            worst = worst.max(if off == 0.0 { 0.0 } else { off / scale });
        }
    }
    worst
}

/// Smallest eigenvalue of the covariance made a correlation. Components without variance, with which nothing may
/// correlate, and those beyond its size count as independent.
fn smallest_eigenvalue<const N: usize>(p: &SMatrix<f64, N, N>) -> f64 {
    let mut correlation = Matrix6::identity();
    for i in 0..N {
        if !(p[(i, i)] > 0.0) {
            assert!(p.row(i).amax() == 0.0, "no variance but covariance in row {i}");
            continue;
        }
        for j in (0..N).filter(|&j| p[(j, j)] > 0.0) {
            correlation[(i, j)] = 0.5 * (p[(i, j)] + p[(j, i)]) / (p[(i, i)].sqrt() * p[(j, j)].sqrt());
        }
    }
    correlation.symmetric_eigenvalues().min()
}

/// One thing that can happen to a filter.
#[derive(Debug, Clone, Copy)]
enum Event {
    Sample { dt: f64, body: f64, wheel: f64 },
    Stiffness { value: f64, sd: f64 },
}

/// Any number there is, mostly reasonable ones.
fn any_of(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![8 => low..high, 1 => any::<f64>(), 1 => prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::MAX)]]
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        6 => (any_of(1e-4, 0.03), any_of(-80.0, 80.0), any_of(-300.0, 300.0))
            .prop_map(|(dt, body, wheel)| Event::Sample { dt, body, wheel }),
        2 => (any_of(0.0, 5e5), any_of(1e3, 1e5)).prop_map(|(value, sd)| Event::Stiffness { value, sd }),
    ]
}

fn informed<T: Real>() -> (InformedConfig<T>, AekfUiInformed<T>) {
    let corner = CornerConfig::<T>::paper();
    let config = InformedConfig::for_corner(&corner);
    (config, AekfUiInformed::new(corner.quarter_car, config).unwrap())
}

fn feed<T: Real>(filter: &mut AekfUiInformed<T>, event: Event) -> InformedRecord<T> {
    match event {
        Event::Sample { dt, body, wheel } => {
            let sample = CornerSample { body_accel_m_s2: T::lit(body), wheel_accel_m_s2: T::lit(wheel) };
            return filter.step(T::lit(dt), &sample);
        }
        Event::Stiffness { value, sd } => filter.measure_stiffness(T::lit(value), T::lit(sd)),
    };
    filter.record(InformedStatus::Updated)
}

/// Finite, symmetric, positive semi-definite to `tolerance`, stiffness in its range.
fn holds<T: Real>(
    config: &InformedConfig<T>,
    record: &InformedRecord<T>,
    tolerance: f64,
) -> Result<(), TestCaseError> {
    let p = record.motion_covariance.map(|v| v.to_f64());
    prop_assert!(record.state.iter().all(|v| v.is_finite()) && record.road_m.is_finite());
    prop_assert!(p.iter().all(|v| v.is_finite()));
    prop_assert!(p.diagonal().iter().all(|v| *v >= 0.0), "{}", p.diagonal());
    prop_assert_eq!(asymmetry(&p), 0.0);
    prop_assert!(smallest_eigenvalue(&p) > -tolerance, "{}", smallest_eigenvalue(&p));
    let k_t = record.stiffness_n_per_m();
    prop_assert!(k_t >= config.lowest_stiffness_n_per_m && k_t <= config.highest_stiffness_n_per_m);
    prop_assert!(record.stiffness_variance > T::zero() && record.stiffness_variance.is_finite());
    prop_assert!(record.road_variance_m2 >= T::zero() && record.road_variance_m2.is_finite());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(128) })]

    #[test]
    fn the_informed_filter_keeps_a_covariance_whatever_comes(events in prop::collection::vec(event(), 1..120)) {
        let (config, mut filter) = informed::<f64>();
        for event in events {
            // Correlations are sums of some ten products: rounding, with room.
            holds(&config, &feed(&mut filter, event), 1e-12)?;
        }
    }

    #[test]
    fn so_it_does_in_single_precision(events in prop::collection::vec(event(), 1..120)) {
        let (config, mut filter) = informed::<f32>();
        for event in events {
            holds(&config, &feed(&mut filter, event), 1e-4)?;
        }
    }

    /// The published form promises less. Whatever comes, its numbers are finite or it says that it diverged, and
    /// once it has, nothing changes until a reset.
    #[test]
    fn the_published_filter_is_finite_or_flagged(
        events in prop::collection::vec(event(), 1..120),
        reading in prop_oneof![Just(CorrectionInput::Current), Just(CorrectionInput::Previous)],
        forgetting in prop_oneof![
            Just(Forgetting::None),
            Just(Forgetting::OneStep),
            Just(Forgetting::Iterative(GradientDescent::default())),
        ],
    ) {
        let config = FilterConfig::paper_simulation().with_correction_input(reading).with_forgetting(forgetting);
        let mut filter = AekfUi::<f64>::new(QuarterCar::paper_table_2(), config).unwrap();
        let mut flagged: Option<StepRecord<f64>> = None;
        for event in events {
            let Event::Sample { dt, body, wheel } = event else { continue };
            let record = filter.step(dt, &CornerSample { body_accel_m_s2: body, wheel_accel_m_s2: wheel });
            prop_assert!(record.state.iter().chain(record.covariance.iter()).all(|v| v.is_finite()));
            prop_assert!(record.road_m.is_finite() && record.forgetting >= 1.0);
            prop_assert!(record.stiffness_n_per_m() > 0.0);
            prop_assert!(record.covariance.diagonal().iter().all(|v| *v >= 0.0));
            if let Some(first) = &flagged {
                prop_assert_eq!((record.status, record.state), (first.status, first.state));
            } else if record.is_diverged() {
                flagged = Some(record);
            }
        }
    }

    /// In its own configuration, at 1 kHz and on accelerations a wheel can have, the product form of (17) keeps its covariance symmetric
    /// and positive semi-definite to rounding for the first second; over a whole drive see `docs/math/ekf-ui.md`, section 3.
    #[test]
    fn the_published_covariance_holds_in_the_papers_own_setting(
        samples in prop::collection::vec((-5.0..5.0, -30.0..30.0), 1000),
    ) {
        let config = FilterConfig::paper_simulation().with_forgetting(Forgetting::None);
        let mut filter = AekfUi::<f64>::new(QuarterCar::paper_table_2(), config).unwrap();
        for (body, wheel) in samples {
            let record = filter.step(1e-3, &CornerSample { body_accel_m_s2: body, wheel_accel_m_s2: wheel });
            if record.status != StepStatus::Updated {
                return Ok(());
            }
            prop_assert!(asymmetry(&record.covariance) < 1e-6, "{}", asymmetry(&record.covariance));
            let smallest = smallest_eigenvalue(&record.covariance);
            prop_assert!(smallest > -1e-6, "{smallest}");
        }
    }
}
