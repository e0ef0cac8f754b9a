//! The paper's filters as estimators of a corner: calibrated, over holes, saved, and fed with what no sensor gives.

use itpms_core::model::{CornerConfig, CornerEstimate, Validity};
use itpms_paper::{EstimatorKind, PaperEstimator};

use crate::common::ride::{Ride, Row};

const PAPER: [EstimatorKind; 3] =
    [EstimatorKind::AekfUiInformed, EstimatorKind::AekfUi, EstimatorKind::EkfUi];
const PLACARD_KPA: f64 = 241.3;
const RESET_S: f64 = 10.0;

fn estimator(kind: EstimatorKind) -> PaperEstimator<f64> {
    PaperEstimator::new(kind, &CornerConfig::paper(), 500.0).unwrap().unwrap()
}

fn feed(estimator: &mut PaperEstimator<f64>, row: &Row) -> CornerEstimate<f64> {
    estimator.update(row.time_s, row.speed_m_s, row.body, row.wheel)
}

#[test]
fn the_default_estimator_is_none_of_the_papers() {
    let made = PaperEstimator::<f64>::new(EstimatorKind::Informed, &CornerConfig::paper(), 500.0);
    assert_eq!(made, Ok(None));
}

#[test]
fn a_calibration_holds_the_corrected_filter_at_placard_and_lets_go_afterwards() {
    let rows = Ride::new(7).rows();
    let mut tire = estimator(EstimatorKind::AekfUiInformed);
    tire.begin_calibration(RESET_S).unwrap();
    let mut free_sd: f64 = 0.0;
    for row in &rows {
        let e = feed(&mut tire, row);
        let driven_s = row.time_s - rows[0].time_s;
        if (1.0..RESET_S).contains(&driven_s) {
            // A calibration is good to 3 kPa, and one grid cell spans 8.
            assert!((e.pressure_kpa - PLACARD_KPA).abs() < 8.0, "{}", e.pressure_kpa);
            assert!(e.pressure_sd_kpa < 8.0, "{}", e.pressure_sd_kpa);
        } else if driven_s > RESET_S + 5.0 {
            free_sd = free_sd.max(e.pressure_sd_kpa);
        }
    }
    assert!(free_sd > 3.0, "{free_sd}");
}

/// The corrected filter knows how long a hole was: the stiffness may have walked meanwhile.
#[test]
fn over_a_hole_the_corrected_filter_becomes_less_sure() {
    let rows = Ride::new(7).rows();
    let sd_n_per_m = |hole_s: f64| {
        let mut tire = estimator(EstimatorKind::AekfUiInformed);
        let mut last = None;
        for (i, row) in rows.iter().take(10_100).enumerate() {
            let time_s = row.time_s + if i < 10_000 { 0.0 } else { hole_s };
            last = Some(feed(&mut tire, &Row { time_s, ..*row }));
        }
        last.unwrap().stiffness_sd_n_per_m
    };
    let (short, long) = (sd_n_per_m(0.0), sd_n_per_m(600.0));
    assert!(long > 1.2 * short, "{long} and {short} N/m");
}

/// The corrected filter finds the drop of the ride to within its interval; the filters as published are never valid.
#[test]
fn the_corrected_filter_follows_and_the_published_ones_are_never_valid() {
    let rows = Ride::new(9).rows();
    for kind in PAPER {
        let mut tire = estimator(kind);
        let (mut valid, mut inside) = (0, 0);
        for row in &rows {
            let e = feed(&mut tire, row);
            if e.validity == Validity::Valid {
                valid += 1;
                inside += usize::from((e.pressure_kpa - row.pressure_kpa).abs() < 3.0 * e.pressure_sd_kpa);
            }
        }
        match kind.is_as_published() {
            true => assert_eq!(valid, 0, "{kind:?}"),
            false => {
                assert!(valid > rows.len() / 2, "{kind:?}: {valid} of {}", rows.len());
                assert!(inside * 100 > valid * 95, "{kind:?}: {inside} of {valid}");
            }
        }
    }
}

#[test]
fn garbage_is_never_believed_as_a_number_that_is_none() {
    let rows = Ride { seconds: 8.0, ..Ride::new(3) }.rows();
    let garbage = [f64::NAN, f64::INFINITY, -1e300, 1e-320, 500.0];
    for kind in PAPER {
        let mut tire = estimator(kind);
        for (k, row) in rows.iter().enumerate() {
            let mut row = *row;
            if k % 40 == 7 {
                let bad = garbage[k / 40 % garbage.len()];
                match k / 200 % 3 {
                    0 => row.time_s = bad,
                    1 => row.body = bad,
                    _ => row.wheel = bad,
                }
            }
            let e = feed(&mut tire, &row);
            let sound = e.pressure_kpa.is_finite() && e.pressure_sd_kpa.is_finite();
            assert!(sound || e.validity != Validity::Valid, "{kind:?}: {e:?}");
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_saved_estimator_resumes_bit_identically() {
    let rows = Ride { seconds: 8.0, jitter: 0.1, ..Ride::new(21) }.rows();
    for kind in PAPER {
        let mut original = estimator(kind);
        for row in &rows[..1801] {
            feed(&mut original, row);
        }
        let saved = postcard::to_allocvec(&original).unwrap();
        let mut restored: PaperEstimator<f64> = postcard::from_bytes(&saved).unwrap();
        for row in &rows[1801..2300] {
            let (a, b) = (feed(&mut original, row), feed(&mut restored, row));
            // As bytes, so that equal NaN count as equal and unequal zeros do not.
            assert_eq!(postcard::to_allocvec(&a).unwrap(), postcard::to_allocvec(&b).unwrap(), "{kind:?}");
        }
        assert_eq!(postcard::to_allocvec(&original).unwrap(), postcard::to_allocvec(&restored).unwrap());
    }
}
