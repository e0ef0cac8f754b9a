//! One wheel for the benchmarks: a signal good enough to keep every branch busy, and each estimator warmed up until it has seen some
//! seconds of it.

use itpms_core::Real;
use itpms_core::model::{CornerConfig, CornerEstimate, CornerSample, QuarterCar};
use itpms_paper::{AekfUi, AekfUiLean, AnyEstimator, EstimatorKind, FilterConfig, Forgetting};
use itpms_road::{RoadConfig, RoadFilter};

pub const RATE_HZ: f64 = 500.0;
/// Speed in m/s on the sample signal's road.
pub const SPEED_M_S: f64 = 14.0;
/// Grid steps from one spectral frame to the next at [`RATE_HZ`].
pub const HOP: usize = 30;
/// Samples that warm an estimator up: ten seconds.
pub const WARM_UP: usize = 5000;

/// Sample `k` of a made-up drive: body and wheel swing at 1.4 Hz and 11 Hz with uneven strength, and hash noise.
pub fn sample<T: Real>(k: usize) -> CornerSample<T> {
    let t = k as f64 / RATE_HZ;
    let noise = |salt: u64| {
        let mut z = (k as u64 + salt).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let swell = 1.0 + 0.5 * (0.7 * t).sin();
    CornerSample {
        body_accel_m_s2: T::lit(swell * (8.8 * t).sin() + 0.2 * (69.0 * t).sin() + 0.3 * noise(1)),
        wheel_accel_m_s2: T::lit(4.0 * swell * (69.0 * t + 0.3 * (9.0 * t).sin()).sin() + 3.0 * noise(77)),
    }
}

/// Samples that warm the published filter up.
pub const PUBLISHED_WARM_UP: usize = 10;

/// An estimator behind its intake and how far it has come.
#[derive(Clone)]
pub struct Running<T: Real> {
    estimator: AnyEstimator<T>,
    /// Made beforehand, so that making them is not measured; used again and again.
    samples: Vec<CornerSample<T>>,
    next: usize,
}

impl<T: Real> Running<T> {
    /// Warmed up so that the next sample starts a new frame: the following `HOP - 1` complete none.
    pub fn new(kind: EstimatorKind) -> Self {
        let estimator = AnyEstimator::new(kind, &CornerConfig::paper(), RATE_HZ).expect("the paper's corner");
        let mut running = Self { estimator, samples: (0..WARM_UP).map(sample).collect(), next: 0 };
        // The intake holds back seven samples before its first grid step.
        for _ in 0..WARM_UP.next_multiple_of(HOP) + 7 {
            running.advance();
        }
        running
    }

    pub fn advance(&mut self) -> CornerEstimate<T> {
        let sample = self.samples[self.next % self.samples.len()];
        let time_s = self.next as f64 / RATE_HZ;
        self.next += 1;
        let (body, wheel) = (sample.body_accel_m_s2, sample.wheel_accel_m_s2);
        self.estimator.update(time_s, T::lit(SPEED_M_S), body, wheel)
    }

    pub fn advance_by(&mut self, count: usize) {
        for _ in 0..count {
            self.advance();
        }
    }
}

/// The published filter with one-step forgetting, warmed up for a few samples: later it diverges, and a filter that
/// only holds its last state is not what is measured. In `f64` alone: in `f32` it diverges at its first sample.
pub fn published() -> AekfUi<f64> {
    let config = FilterConfig::paper_simulation().with_forgetting(Forgetting::OneStep);
    let mut filter = AekfUi::new(QuarterCar::paper_table_2(), config).expect("the paper's parameters");
    for k in 0..PUBLISHED_WARM_UP {
        let record = filter.step(1.0 / RATE_HZ, &sample(k));
        assert!(!record.is_diverged(), "nothing to measure: diverged at step {k}");
    }
    filter
}

/// The same filter in closed form, warmed up by the same samples.
pub fn lean<T: Real>() -> AekfUiLean<T> {
    let config = FilterConfig::paper_simulation().with_forgetting(Forgetting::OneStep);
    let mut filter = AekfUiLean::new(QuarterCar::paper_table_2(), config).expect("the paper's parameters");
    for k in 0..PUBLISHED_WARM_UP {
        let record = filter.step(T::lit(1.0 / RATE_HZ), &sample(k));
        assert!(!record.is_diverged(), "nothing to measure: diverged at step {k}");
    }
    filter
}

/// The causal road filter, warmed up.
pub fn road<T: Real>() -> RoadFilter<T> {
    let corner = CornerConfig::<T>::paper();
    let stiffness = corner.initial_stiffness_n_per_m();
    let config = RoadConfig::new(corner.quarter_car, stiffness, T::lit(0.05)).expect("the paper's corner");
    let mut filter = RoadFilter::new(&config);
    for k in 0..WARM_UP {
        filter.update(k as f64 / RATE_HZ, &sample(k));
    }
    filter
}
