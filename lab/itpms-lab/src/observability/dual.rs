//! Numbers that carry their derivatives by all unknowns: exact first derivatives of whatever is computed with them.
//!
//! Called by `rank`.

use std::ops::{Add, Mul, Sub};

use nalgebra::DVector;

#[derive(Debug, Clone)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) gradient: DVector<f64>,
}

impl Dual {
    /// A number that depends on none of `unknowns`.
    pub(super) fn constant(value: f64, unknowns: usize) -> Self {
        Self { value, gradient: DVector::zeros(unknowns) }
    }

    pub(super) fn unknown(value: f64, index: usize, unknowns: usize) -> Self {
        let mut dual = Self::constant(value, unknowns);
        dual.gradient[index] = 1.0;
        dual
    }
}

impl Add for &Dual {
    type Output = Dual;
    fn add(self, other: &Dual) -> Dual {
        Dual { value: self.value + other.value, gradient: &self.gradient + &other.gradient }
    }
}

impl Sub for &Dual {
    type Output = Dual;
    fn sub(self, other: &Dual) -> Dual {
        Dual { value: self.value - other.value, gradient: &self.gradient - &other.gradient }
    }
}

impl Mul for &Dual {
    type Output = Dual;
    fn mul(self, other: &Dual) -> Dual {
        let gradient = &self.gradient * other.value + &other.gradient * self.value;
        Dual { value: self.value * other.value, gradient }
    }
}

impl Mul<f64> for &Dual {
    type Output = Dual;
    fn mul(self, factor: f64) -> Dual {
        Dual { value: self.value * factor, gradient: &self.gradient * factor }
    }
}
