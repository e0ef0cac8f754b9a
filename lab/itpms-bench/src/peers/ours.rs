//! The filters of this project, with their guards and their records.

use itpms_core::Real;
use itpms_core::model::{CornerSample, QuarterCar};
use itpms_paper::{AekfUi, AekfUiLean, StepStatus};

use crate::peers::corner::{STEP_S, setting};
use crate::peers::{Number, Peer};

/// [`AekfUi`].
#[derive(Debug, Clone)]
pub struct Dense<T: Real> {
    filter: AekfUi<T>,
    found: [T; 6],
}

/// [`AekfUiLean`].
#[derive(Debug, Clone)]
pub struct Lean<T: Real> {
    filter: AekfUiLean<T>,
    road: T,
}

fn sample<T: Real>([body_accel_m_s2, wheel_accel_m_s2]: [T; 2]) -> CornerSample<T> {
    CornerSample { body_accel_m_s2, wheel_accel_m_s2 }
}

impl<T: Number> Peer for Dense<T> {
    type Scalar = T;

    fn fresh() -> Self {
        let filter = AekfUi::new(QuarterCar::paper_table_2(), setting()).expect("the paper's parameters");
        Self { filter, found: [T::zero(); 6] }
    }

    #[inline]
    fn step(&mut self, measured: [T; 2]) {
        let record = self.filter.step(T::lit(STEP_S), &sample(measured));
        let [x_b, v_b, x_w, v_w, k_t] = record.state.into();
        self.found = match record.status {
            StepStatus::Updated => [x_b, v_b, x_w, v_w, k_t, record.road_m],
            _ => [T::lit(f64::NAN); 6],
        };
    }

    fn found(&self) -> [f64; 6] {
        self.found.map(Real::to_f64)
    }
}

impl<T: Number> Peer for Lean<T> {
    type Scalar = T;

    fn fresh() -> Self {
        let filter = AekfUiLean::new(QuarterCar::paper_table_2(), setting()).expect("the paper's parameters");
        Self { filter, road: T::zero() }
    }

    #[inline]
    fn step(&mut self, measured: [T; 2]) {
        let record = self.filter.step(T::lit(STEP_S), &sample(measured));
        self.road = if record.status == StepStatus::Updated { record.road_m } else { T::lit(f64::NAN) };
    }

    fn found(&self) -> [f64; 6] {
        let [x_b, v_b, x_w, v_w, k_t] = self.filter.state().into();
        [x_b, v_b, x_w, v_w, k_t, self.road].map(Real::to_f64)
    }
}
