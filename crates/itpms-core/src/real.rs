//! The scalar the core computes with: `f32` on a controller, `f64` on a workstation.

use nalgebra::RealField;

/// A real scalar. Everything mathematical comes from [`RealField`]; this adds constants and the way back.
pub trait Real: RealField + Copy {
    /// Zero, where it has to be a constant.
    const ZERO: Self;
    /// The constant `value`, rounded to this type.
    fn lit(value: f64) -> Self;
    /// This value, widened (or kept) to `f64`.
    fn to_f64(self) -> f64;
    /// The largest relative spacing of this type around one.
    fn epsilon() -> Self;
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    fn lit(value: f64) -> Self {
        value as f32
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn epsilon() -> Self {
        f32::EPSILON
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    fn lit(value: f64) -> Self {
        value
    }
    fn to_f64(self) -> f64 {
        self
    }
    fn epsilon() -> Self {
        f64::EPSILON
    }
}
