//! Bytes that an estimator occupies: `cargo run -p itpms-bench --example sizes`.

use itpms_core::Real;
use itpms_core::car::CarEstimator;
use itpms_core::conditioning::Resampler;
use itpms_core::estimator::Estimator;
use itpms_core::monitor::{Monitor, MonitoredCar};
use itpms_paper::{AekfUi, AekfUiInformed, AekfUiLean};
use itpms_road::RoadFilter;

fn report<T: Real>(scalar: &str) {
    let sizes = [
        ("MonitoredCar", size_of::<MonitoredCar<T>>()),
        ("CarEstimator", size_of::<CarEstimator<T>>()),
        ("Monitor", size_of::<Monitor<T>>()),
        ("Estimator", size_of::<Estimator<T>>()),
        ("Intake", size_of::<Resampler<T>>()),
        ("RoadFilter", size_of::<RoadFilter<T>>()),
        ("AekfUiInformed", size_of::<AekfUiInformed<T>>()),
        ("AekfUi", size_of::<AekfUi<T>>()),
        ("AekfUiLean", size_of::<AekfUiLean<T>>()),
    ];
    for (name, bytes) in sizes {
        println!("{name}<{scalar}>: {bytes} bytes");
    }
}

fn main() {
    report::<f32>("f32");
    report::<f64>("f64");
}
