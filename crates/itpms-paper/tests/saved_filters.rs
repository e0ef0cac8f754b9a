//! A filter saved in the middle of a drive and restored goes on as if nothing had happened, bit by bit.
#![cfg(feature = "serde")]

use itpms_core::model::{CornerConfig, QuarterCar};
use itpms_paper::{
    AekfUi, AekfUiInformed, AekfUiLean, FilterConfig, Forgetting, GradientDescent, InformedConfig,
};

use crate::common::quarter_plant::{drive, fig_6_kpa};

#[test]
fn the_published_filter_resumes_bit_identically() {
    let drive = drive(11, 4.0, 1000.0, 0.05, fig_6_kpa);
    let iterative = Forgetting::Iterative(GradientDescent::default());
    for forgetting in [Forgetting::None, Forgetting::OneStep, iterative] {
        let config = FilterConfig::paper_simulation().with_forgetting(forgetting);
        let mut original = AekfUi::<f64>::new(QuarterCar::paper_table_2(), config).unwrap();
        for sample in &drive.samples[..2000] {
            original.step(drive.dt_s, sample);
        }
        let saved = postcard::to_allocvec(&original).unwrap();
        let mut restored: AekfUi<f64> = postcard::from_bytes(&saved).unwrap();
        assert_eq!(restored, original);
        for sample in &drive.samples[2000..] {
            let (a, b) = (original.step(drive.dt_s, sample), restored.step(drive.dt_s, sample));
            // As bytes, so that equal NaN count as equal and unequal zeros do not.
            assert_eq!(postcard::to_allocvec(&a).unwrap(), postcard::to_allocvec(&b).unwrap());
        }
    }
}

#[test]
fn the_lean_filter_resumes_bit_identically() {
    let drive = drive(11, 4.0, 1000.0, 0.3, fig_6_kpa);
    let mut original =
        AekfUiLean::<f64>::new(QuarterCar::paper_table_2(), FilterConfig::paper_bench()).unwrap();
    for sample in &drive.samples[..2000] {
        original.step(drive.dt_s, sample);
    }
    let saved = postcard::to_allocvec(&original).unwrap();
    let mut restored: AekfUiLean<f64> = postcard::from_bytes(&saved).unwrap();
    assert_eq!(restored, original);
    for sample in &drive.samples[2000..] {
        assert_eq!(original.step(drive.dt_s, sample), restored.step(drive.dt_s, sample));
        assert_eq!(postcard::to_allocvec(&original).unwrap(), postcard::to_allocvec(&restored).unwrap());
    }
}

#[test]
fn the_informed_filter_resumes_bit_identically() {
    let drive = drive(12, 4.0, 500.0, 0.05, fig_6_kpa);
    let corner = CornerConfig::<f64>::paper();
    let mut original = AekfUiInformed::new(corner.quarter_car, InformedConfig::for_corner(&corner)).unwrap();
    let advance = |filter: &mut AekfUiInformed<f64>, k: usize| {
        if k.is_multiple_of(50) {
            filter.measure_stiffness(200_000.0 + 50.0 * k as f64, 30_000.0);
        }
        filter.step(drive.dt_s, &drive.samples[k])
    };
    for k in 0..1000 {
        advance(&mut original, k);
    }
    let saved = postcard::to_allocvec(&original).unwrap();
    println!("{} bytes", saved.len());
    let mut restored: AekfUiInformed<f64> = postcard::from_bytes(&saved).unwrap();
    for k in 1000..2000 {
        let (a, b) = (advance(&mut original, k), advance(&mut restored, k));
        assert_eq!(postcard::to_allocvec(&a).unwrap(), postcard::to_allocvec(&b).unwrap());
    }
}
